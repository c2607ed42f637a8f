import math

import pytest

from reasoned_explorer.geometry import Pose
from reasoned_explorer.vehicles import PROFILES
from reasoned_explorer.vehicles.control.follower import FollowerSettings
from reasoned_explorer.vehicles.mavlink.approach import LAPSE_S, Approach

START, TARGET = Pose(50.0, 50.0, 1.5, 0.0), Pose(50.0, 80.0, 1.5, 1.0)


def speed_mps(left_m, profile):
    """Return how fast it is told to go so far south of its target."""
    setpoint = Approach(START, TARGET, profile).setpoint(Pose(50.0, 80.0 - left_m, 1.5))
    assert setpoint is not None
    assert math.isnan(setpoint.north_m)
    assert setpoint.velocity_mps is not None
    north_mps, east_mps, down_mps = setpoint.velocity_mps
    assert (east_mps, down_mps) == (0.0, 0.0)
    return north_mps


@pytest.mark.parametrize("name", ["drone", "go1"])
def test_far_away_it_goes_as_fast_as_it_may(name):
    assert speed_mps(20.0, PROFILES[name]) == pytest.approx(PROFILES[name].speed_mps)


@pytest.mark.parametrize("name", ["drone", "go1"])
@pytest.mark.parametrize("left_m", [0.3, 1.0, 3.0, 6.0])
def test_hearing_nothing_more_it_stops_before_the_target(name, left_m):
    profile = PROFILES[name]
    told_mps = speed_mps(left_m, profile)
    goes_on_m = told_mps * LAPSE_S + told_mps**2 / (2.0 * FollowerSettings.of(profile).braking_mps2)
    assert goes_on_m <= left_m + 1e-9


def test_near_the_target_it_is_told_the_target():
    approach = Approach(START, TARGET, PROFILES["drone"])
    assert approach.setpoint(Pose(50.0, 79.9, 1.5)) is None
    assert approach.is_over


def test_a_drone_takes_its_heading_on_the_way_and_rises_to_its_height():
    setpoint = Approach(START, TARGET, PROFILES["drone"]).setpoint(Pose(50.0, 60.0, 1.3))
    assert setpoint is not None
    assert setpoint.yaw_rad == 1.0
    assert setpoint.velocity_mps is not None
    assert setpoint.velocity_mps[2] == pytest.approx(-0.4)
    setpoint = Approach(START, TARGET, PROFILES["go1"]).setpoint(Pose(50.0, 60.0))
    assert setpoint is not None
    assert math.isnan(setpoint.yaw_rad)


def test_aside_of_its_line_it_comes_back_to_it():
    approach, profile = Approach(START, TARGET, PROFILES["go1"]), PROFILES["go1"]
    setpoint = approach.setpoint(Pose(50.3, 60.0))
    assert setpoint is not None
    assert setpoint.velocity_mps is not None
    north_mps, east_mps, _ = setpoint.velocity_mps
    assert math.hypot(north_mps, east_mps) == pytest.approx(profile.speed_mps)
    assert east_mps < 0.0 < north_mps
    goes_on_s = LAPSE_S + profile.speed_mps / (2.0 * FollowerSettings.of(profile).braking_mps2)
    assert 50.3 + east_mps * goes_on_s == pytest.approx(50.0)
