import math

import pytest

from reasoned_explorer.vehicles.positioning.fix import FixQuality, Report
from tests.vehicles.positioning.sentences import ORIGIN


def test_a_report_becomes_a_fix_in_the_world_s_frame():
    lat_deg, lon_deg = ORIGIN.geodetic_from_enu_deg(100.0, -50.0)
    fix = Report(FixQuality.FIXED, lat_deg, lon_deg, course_deg=360.0, speed_mps=1.0).as_fix(7.0, ORIGIN)
    assert (fix.x_m, fix.y_m) == pytest.approx((100.0, -50.0), abs=1e-3)
    assert (fix.time_s, fix.course_rad) == (7.0, 0.0)


@pytest.mark.parametrize(("lat_deg", "lon_deg"), [(91.0, 0.0), (0.0, 181.0), (math.nan, 0.0), (None, 0.0), (0.0, None)])
def test_an_impossible_place_is_no_fix(lat_deg, lon_deg):
    fix = Report(FixQuality.FIXED, lat_deg, lon_deg).as_fix(0.0, ORIGIN)
    assert fix.quality is FixQuality.NONE
    assert math.isnan(fix.x_m)


@pytest.mark.parametrize("name", ["sigma_m", "hdop", "speed_mps", "course_deg"])
@pytest.mark.parametrize("value", [-1.0, math.nan, math.inf, 1e9])
def test_an_impossible_figure_is_left_out(name, value):
    fix = Report(FixQuality.FIXED, 1.0, 2.0, **{name: value}).as_fix(0.0, ORIGIN)
    assert fix.quality is FixQuality.FIXED
    assert getattr(fix, name.replace("_deg", "_rad")) is None


def test_qualities_are_in_order_and_have_words():
    assert FixQuality.FIXED > FixQuality.FLOAT > FixQuality.DGPS > FixQuality.SINGLE > FixQuality.NONE
    assert [quality.as_text for quality in FixQuality] == ["no fix", "single", "DGPS", "RTK float", "RTK fixed"]
