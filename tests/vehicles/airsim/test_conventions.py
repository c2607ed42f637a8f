import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.geometry import Pose
from reasoned_explorer.vehicles.airsim.conventions import (
    HomeFrame,
    attitude,
    heading_of_yaw_rad,
    quaternion,
    triple,
    vector,
    yaw_deg,
)

ANGLES = st.floats(-math.pi, math.pi, allow_nan=False)


def turned(q, x, y, z):
    """Carry a vector from the body's frame into the world's: q v q*."""
    w, u = q["w_val"], np.array([q["x_val"], q["y_val"], q["z_val"]])
    v = np.array([x, y, z])
    return v + 2.0 * np.cross(u, np.cross(u, v) + w * v)


def test_north_east_down_counts_from_home():
    home = HomeFrame(100.0, 200.0, 0.0)
    assert home.ned_m(110.0, 205.0, 3.0) == (5.0, 10.0, -3.0)
    assert home.enu_m(5.0, 10.0, -3.0) == (110.0, 205.0, 3.0)


def test_forward_of_a_heading_is_where_the_heading_points():
    # Facing east: forward is east, right is south, in north, east, down.
    facing_east = quaternion(0.0, 0.0, math.pi / 2)
    assert turned(facing_east, 1.0, 0.0, 0.0) == pytest.approx([0.0, 1.0, 0.0], abs=1e-12)
    assert turned(facing_east, 0.0, 1.0, 0.0) == pytest.approx([-1.0, 0.0, 0.0], abs=1e-12)


def test_a_positive_pitch_looks_up_and_a_positive_roll_sinks_the_right_side():
    assert turned(quaternion(0.0, 0.5, 0.0), 1.0, 0.0, 0.0)[2] < 0.0
    assert turned(quaternion(0.5, 0.0, 0.0), 0.0, 1.0, 0.0)[2] > 0.0


def test_pitch_is_applied_after_yaw():
    # Facing east and looking up: still to the east.
    assert turned(quaternion(0.0, 0.5, math.pi / 2), 1.0, 0.0, 0.0) == pytest.approx(
        [0.0, math.cos(0.5), -math.sin(0.5)], abs=1e-12
    )


@given(ANGLES, st.floats(-1.5, 1.5), ANGLES)
def test_orientations_come_back(roll_rad, pitch_rad, yaw_rad):
    back = attitude(quaternion(roll_rad, pitch_rad, yaw_rad))
    again, first = quaternion(*back), quaternion(roll_rad, pitch_rad, yaw_rad)
    same = sum(again[key] * first[key] for key in first)
    assert abs(same) == pytest.approx(1.0, abs=1e-9)
    assert 0.0 <= back.yaw_rad < 2.0 * math.pi


@given(st.floats(-500.0, 500.0), st.floats(-500.0, 500.0), st.floats(0.0, 6.28))
def test_poses_come_back(x_m, y_m, heading_rad):
    home = HomeFrame(12.5, -7.25)
    wire = home.wire_pose(Pose(x_m, y_m, 1.5, heading_rad))
    back = home.pose(wire["position"], wire["orientation"])
    assert (back.x_m, back.y_m, back.z_m) == pytest.approx((x_m, y_m, 1.5), abs=1e-9)
    assert math.cos(back.heading_rad - heading_rad) == pytest.approx(1.0)


def test_a_west_heading_is_a_negative_yaw():
    assert yaw_deg(1.5 * math.pi) == pytest.approx(-90.0)
    assert heading_of_yaw_rad(-90.0) == pytest.approx(1.5 * math.pi)
    assert quaternion(0.0, 0.0, 1.5 * math.pi)["z_val"] < 0.0


@pytest.mark.parametrize("value", [None, 3, {}, {"x_val": 1.0, "y_val": 2.0}, vector(math.nan, 0.0, 0.0)])
def test_what_is_no_position_is_refused(value):
    with pytest.raises(ValueError, match="expected"):
        triple(value)


def test_what_is_no_orientation_is_refused():
    with pytest.raises(ValueError, match="length 0"):
        attitude({"w_val": 0.0, "x_val": 0.0, "y_val": 0.0, "z_val": 0.0})
