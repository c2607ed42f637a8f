import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.geometry import (
    bearing_between_rad,
    heading_towards_rad,
    normalise_bearing_rad,
    normalise_heading_rad,
)

angles = st.floats(-1e6, 1e6, allow_nan=False)


@given(angles)
def test_headings_lie_in_their_range_and_point_the_same_way(angle_rad: float) -> None:
    heading_rad = normalise_heading_rad(angle_rad)
    assert 0.0 <= heading_rad < 2 * math.pi
    assert math.sin(heading_rad) == pytest.approx(math.sin(angle_rad), abs=1e-6)
    assert math.cos(heading_rad) == pytest.approx(math.cos(angle_rad), abs=1e-6)


@given(angles)
def test_bearings_lie_in_their_range_and_mean_the_same_turn(angle_rad: float) -> None:
    bearing_rad = normalise_bearing_rad(angle_rad)
    assert -math.pi <= bearing_rad < math.pi
    assert math.sin(bearing_rad) == pytest.approx(math.sin(angle_rad), abs=1e-6)


@pytest.mark.parametrize(
    ("to_x_m", "to_y_m", "degrees"), [(0, 1, 0), (1, 0, 90), (0, -1, 180), (-1, 0, 270), (1, 1, 45)]
)
def test_headings_are_compass_headings(to_x_m: float, to_y_m: float, degrees: float) -> None:
    assert math.degrees(heading_towards_rad(0, 0, to_x_m, to_y_m)) == pytest.approx(degrees)


def test_a_tiny_negative_angle_is_north_and_not_a_full_turn() -> None:
    assert normalise_heading_rad(-1e-20) == 0.0


@given(angles, angles)
def test_the_bearing_between_two_headings_leads_from_one_to_the_other(first_rad: float, second_rad: float) -> None:
    turned_rad = first_rad + bearing_between_rad(first_rad, second_rad)
    assert math.cos(turned_rad - second_rad) == pytest.approx(1.0, abs=1e-6)
