"""Settings of a captioner's errors and the draws they need."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.model import SettingsError
from reasoned_explorer.model.draws import key_of
from reasoned_explorer.simulation.caption_errors import (
    COMPANIONS,
    FREQUENT,
    LOOKALIKES,
    NOISY,
    SALIENCE,
    CaptionErrors,
    imagined_class,
    parts_of,
)
from reasoned_explorer.world.taxonomy import OBJECT_CLASSES


def test_all_faults_at_once():
    with pytest.raises(SettingsError) as error:
        CaptionErrors(ceiling=1.2, imagine_rate=-0.1, side_error=math.nan, max_groups=0, steepness=0.0)
    assert [fault.what.split(" ")[0] for fault in error.value.faults] == [
        "steepness",
        "ceiling",
        "imagine_rate",
        "side_error",
        "max_groups",
    ]


@given(st.floats(0.5, 200), st.floats(1.01, 3))
def test_larger_is_noticed_more(size, times):
    assert NOISY.notice_probability(size, "bench") < NOISY.notice_probability(times * size, "bench") <= NOISY.ceiling


def test_half_at_the_size_that_the_setting_says():
    assert NOISY.notice_probability(NOISY.half_seen_px, "kiosk") == pytest.approx(NOISY.ceiling / 2)
    assert NOISY.notice_probability(0.0, "kiosk") == 0.0


def test_tables_name_real_classes():
    names = set(SALIENCE) | set(FREQUENT) | set(LOOKALIKES) | set(COMPANIONS)
    names |= {name for options in (*LOOKALIKES.values(), *COMPANIONS.values()) for name in options}
    assert names <= set(OBJECT_CLASSES)
    assert all(name not in options for name, options in (LOOKALIKES | COMPANIONS).items())


def test_what_is_imagined_is_not_there_and_goes_with_what_is():
    seen = frozenset({"cafe", "bench"})
    drawn = [imagined_class(seen, 0.7, key_of(0, k)) for k in range(2000)]
    assert not seen & set(drawn)
    companions = {*COMPANIONS["cafe"], *COMPANIONS["bench"]}
    assert sum(name in companions for name in drawn) / len(drawn) > 0.7
    assert imagined_class(frozenset(OBJECT_CLASSES), 0.7, 1) is None


def test_parts_are_even():
    columns = zip(*(parts_of(key_of(3, k)) for k in range(4000)), strict=True)
    for column in columns:
        assert 0.0 <= min(column) <= max(column) < 1.0
        assert sum(column) / len(column) == pytest.approx(0.5, abs=0.02)


@given(st.floats(0.0, 10.0))
def test_more_errors_are_never_better(factor: float) -> None:
    few, many = NOISY.times(factor), NOISY.times(factor + 0.5)
    assert many.imagine_rate >= few.imagine_rate
    assert many.notice_probability(20.0, "bench") <= few.notice_probability(20.0, "bench")
    assert many.sign_rate <= few.sign_rate


def test_errors_can_be_multiplied() -> None:
    assert NOISY.times(1.0) == NOISY
    assert NOISY.times(2.0).imagine_rate == pytest.approx(0.4)
    assert NOISY.times(0.0).notice_probability(5.0, "bench") == 1.0
    for factor in (-1.0, float("nan"), float("inf")):
        with pytest.raises(SettingsError, match="0 or more"):
            NOISY.times(factor)
