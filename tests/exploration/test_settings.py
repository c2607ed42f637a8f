import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.exploration.settings import ExplorerSettings
from reasoned_explorer.model import SettingsError


def test_the_default_look_spans_the_authors_range_of_motion() -> None:
    bearings = ExplorerSettings().bearings_rad()
    assert [round(math.degrees(bearing)) for bearing in bearings] == [-60, 0, 60]


@given(st.integers(1, 24), st.floats(0, 2 * math.pi))
def test_there_is_one_bearing_per_view_and_none_twice(views: int, sweep_rad: float) -> None:
    bearings = ExplorerSettings(views=views, sweep_rad=sweep_rad).bearings_rad()
    assert len(bearings) == views
    if sweep_rad > 0.01:
        assert len({round(bearing % (2 * math.pi), 6) for bearing in bearings}) == views


@pytest.mark.parametrize(("q", "level", "step_m"), [(5.0, 3, 10.0), (0.0, 3, 15.0), (5.0, 1, 5.0), (2.5, 4, 12.5)])
def test_promising_frontiers_stand_nearer(q: float, level: int, step_m: float) -> None:
    assert ExplorerSettings().step_m(q, level) == pytest.approx(step_m)


def test_a_missing_score_takes_the_longest_step() -> None:
    assert ExplorerSettings().step_m(None, 3) == 15.0


def test_all_faults_are_told_at_once_and_nan_is_one() -> None:
    with pytest.raises(SettingsError) as raised:
        ExplorerSettings(views=0, t_max_s=math.nan, step_min_m=20.0, step_max_m=10.0, straight_legs=None)  # type: ignore[arg-type]
    assert len(raised.value.faults) == 4


def test_faults_are_in_the_units_that_people_type() -> None:
    with pytest.raises(SettingsError) as raised:
        ExplorerSettings(sweep_rad=math.radians(-3.0), t_max_s=-60.0)
    assert "sweep is -3°" in str(raised.value)
    assert "t_max is -60 s (-1 minutes)" in str(raised.value)
