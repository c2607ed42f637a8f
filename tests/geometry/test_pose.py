import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.geometry import Pose

places = st.floats(-5000, 5000)
headings = st.floats(0, 2 * math.pi, exclude_max=True)


@given(places, places, headings, st.floats(0.1, 500), st.floats(-math.pi, math.pi))
def test_what_lies_ahead_is_seen_in_its_bearing_at_its_distance(
    x_m: float, y_m: float, heading_rad: float, distance_m: float, bearing_rad: float
) -> None:
    pose = Pose(x_m, y_m, 0.0, heading_rad)
    there = pose.ahead(distance_m, bearing_rad=bearing_rad)
    assert pose.distance_to_m(there.x_m, there.y_m) == pytest.approx(distance_m, abs=1e-6)
    seen_rad = pose.bearing_to_rad(there.x_m, there.y_m)
    assert math.cos(seen_rad - bearing_rad) == pytest.approx(1.0, abs=1e-6)


def test_east_is_a_quarter_turn_to_the_right_of_north() -> None:
    there = Pose(0.0, 0.0).ahead(10.0, bearing_rad=math.pi / 2)
    assert (there.x_m, there.y_m) == pytest.approx((10.0, 0.0))
    assert math.degrees(there.heading_rad) == pytest.approx(90.0)
