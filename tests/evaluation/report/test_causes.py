"""What became of a mission: each mission has one cause, and every cause can be had."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.evaluation.report.causes import Cause, cause_of
from reasoned_explorer.evaluation.report.looks import CAUSE_LOOKS
from reasoned_explorer.model import InputError
from reasoned_explorer.model.record import MissionEnd
from tests.evaluation.report.rows import made_row


@pytest.mark.parametrize(
    ("what", "cause"),
    [
        ({}, Cause.FOUND),
        ({"in_place": False, "been_there": True}, Cause.FALSE_HALT_BEEN),
        ({"in_place": False}, Cause.FALSE_HALT_NEVER),
        ({"in_place": False, "compliant": False}, Cause.SHUNNED_GROUND),
        ({"in_place": False, "been_there": True, "compliant": False}, Cause.SHUNNED_GROUND),
        ({"declared": False, "in_place": False, "been_there": True}, Cause.TIME_OVER_BEEN),
        ({"declared": False, "in_place": False}, Cause.TIME_OVER_NEVER),
        ({"declared": False, "in_place": False, "compliant": False}, Cause.TIME_OVER_NEVER),
        ({"declared": False, "end": "budget spent"}, Cause.BUDGET),
        ({"declared": False, "end": "nothing left", "been_there": True}, Cause.NOTHING_LEFT),
        ({"declared": False, "end": "fault"}, Cause.FAULT),
        ({"declared": False, "end": "interrupted"}, Cause.INTERRUPTED),
        # Declared in place, but after T_max: time was over, and it had been there.
        ({"ct_s": 1500.0, "tt_s": 400.0, "been_there": True}, Cause.TIME_OVER_BEEN),
    ],
)
def test_every_cause_has_its_mission(what: dict[str, object], cause: Cause) -> None:
    assert cause_of(made_row(**what)) is cause  # type: ignore[arg-type]


@given(
    declared=st.booleans(),
    in_place=st.booleans(),
    been_there=st.booleans(),
    late=st.booleans(),
    compliant=st.sampled_from([None, True, False]),
    end=st.sampled_from(list(MissionEnd)),
)
def test_no_mission_is_without_a_cause_and_found_means_success(
    declared: bool, in_place: bool, been_there: bool, late: bool, compliant: bool | None, end: MissionEnd
) -> None:
    row = made_row(
        declared=declared,
        in_place=in_place,
        been_there=been_there,
        ct_s=1700.0 if late else 100.0,
        compliant=compliant,
        end=end.value,
    )
    cause = cause_of(row)
    assert (cause is Cause.FOUND) == row.score.success
    if cause in {Cause.FALSE_HALT_BEEN, Cause.TIME_OVER_BEEN}:
        assert row.score.oracle_success
    if cause in {Cause.FALSE_HALT_NEVER, Cause.TIME_OVER_NEVER}:
        assert not row.score.oracle_success


def test_an_end_that_no_mission_has_is_refused() -> None:
    with pytest.raises(InputError, match="'lost'"):
        cause_of(replace(made_row(declared=False), end="lost"))


def test_causes_can_be_told_apart_and_are_explained() -> None:
    assert len({cause.key for cause in Cause}) == len(Cause)
    assert all(cause.meaning for cause in Cause)
    assert len({(look.colour, look.hatch) for look in CAUSE_LOOKS.values()}) == len(Cause) == len(CAUSE_LOOKS)
