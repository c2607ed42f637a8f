"""How far it is to what stands ahead, by depth pictures that are worked out by hand."""

import math

import numpy as np
import pytest

from reasoned_explorer.vehicles.airsim.conventions import Attitude
from reasoned_explorer.vehicles.airsim.corridor import Corridor

SIDE, FOV_RAD, HEIGHT_M = 101, math.radians(90.0), 1.5
LEVEL = Attitude(0.0, 0.0, 0.0)


def plane_of_ground(pitch_rad=0.0):
    """Depths of bare ground, for a camera whose nose is up by an angle."""
    down = (np.arange(SIDE) + 0.5 - 0.5 * SIDE) / (0.5 * SIDE)
    sinks = down * math.cos(pitch_rad) - math.sin(pitch_rad)
    depth = np.where(sinks > 1e-6, HEIGHT_M / np.maximum(sinks, 1e-6), np.inf)
    return np.repeat(depth[:, None], SIDE, axis=1).astype(np.float32)


def free_m(depth_m, camera=LEVEL, *, heading_rad=0.0):
    return Corridor().free_m(depth_m, fov_rad=FOV_RAD, camera=camera, heading_rad=heading_rad, height_m=HEIGHT_M)


def with_post(depth_m, *, column, at_m):
    held = depth_m.copy()
    held[: SIDE // 2 + 5, column] = np.minimum(held[: SIDE // 2 + 5, column], at_m)
    return held


def test_bare_ground_is_no_obstacle_also_where_the_nose_dips():
    assert free_m(plane_of_ground()) == math.inf
    assert free_m(plane_of_ground(-0.2), Attitude(0.0, -0.2, 0.0)) == math.inf
    assert free_m(plane_of_ground(-0.2)) < 10.0  # what a dip that is not told would make of it


def test_what_stands_ahead_is_at_its_depth_and_what_stands_aside_is_passed():
    assert free_m(with_post(plane_of_ground(), column=SIDE // 2, at_m=6.0)) == pytest.approx(6.0)
    # At 6 m a column at a quarter of the picture's width is 3 m aside.
    assert free_m(with_post(plane_of_ground(), column=SIDE // 4, at_m=6.0)) == math.inf


def test_it_looks_where_the_body_goes_not_where_the_camera_does():
    aside = Attitude(0.0, 0.0, math.radians(45.0))
    # The left edge of a camera that looks 45 degrees to the right is straight ahead.
    assert free_m(with_post(plane_of_ground(), column=0, at_m=5.0), aside) == pytest.approx(
        5.0 * math.sqrt(2), rel=0.02
    )
    assert free_m(with_post(plane_of_ground(), column=SIDE // 2, at_m=5.0), aside) == math.inf


def test_nothing_in_sight_is_free():
    assert free_m(np.full((SIDE, SIDE), np.inf, np.float32)) == math.inf
