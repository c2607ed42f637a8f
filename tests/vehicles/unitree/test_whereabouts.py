import math
from dataclasses import replace

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reasoned_explorer.geometry import Pose, bearing_between_rad
from reasoned_explorer.model import LegOutcome, SettingsError
from reasoned_explorer.vehicles.positioning import Fix, FixQuality, Grade
from reasoned_explorer.vehicles.unitree import BatteryReading, HighState, ImuReading, Mode, MotorReading
from reasoned_explorer.vehicles.unitree.legs import LegLog
from reasoned_explorer.vehicles.unitree.robot import BodyReading
from reasoned_explorer.vehicles.unitree.settings import WalkSettings
from reasoned_explorer.vehicles.unitree.whereabouts import Reckoned, Surveyed

STILL = BodyReading(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


def test_what_a_state_says_is_turned_to_the_right():
    state = HighState(
        imu=ImuReading(gyroscope_radps=(0.0, 0.0, 0.5), rpy_rad=(0.0, 0.0, 0.25)),
        motors=(MotorReading(temperature_c=40),) * 11 + (MotorReading(temperature_c=55),) + (MotorReading(),) * 8,
        battery=BatteryReading(charge_percent=77),
        mode=Mode.LIE_DOWN,
        odometry_m=(3.0, 4.0, 0.3),
        velocity_mps=(0.5, 0.125, 0.0),
    )
    reading = BodyReading.of(state, 9.0)
    assert (reading.turn_radps, reading.forward_mps, reading.right_mps) == (-0.5, 0.5, -0.125)
    assert reading.yaw_rad == pytest.approx(2.0 * math.pi - 0.25)
    assert (reading.ahead_m, reading.aside_m) == (3.0, -4.0)
    assert (reading.lies, reading.battery_percent, reading.hottest_motor_c) == (True, 77.0, 55.0)


@given(
    home_rad=st.floats(0.0, 6.28),
    first_yaw_rad=st.floats(0.0, 6.28),
    turned_rad=st.floats(-3.0, 3.0),
    way_m=st.floats(0.0, 20.0),
)
@settings(max_examples=60, deadline=None)
def test_reckoning_goes_where_the_legs_go_whatever_the_yaw_was_at_the_start(home_rad, first_yaw_rad, turned_rad, way_m):
    """It turns, then walks straight ahead; its own frame is turned against the world's by anything."""
    here = Reckoned(Pose(10.0, 20.0, 0.0, home_rad), reckon_m=100.0)
    first = replace(STILL, yaw_rad=first_yaw_rad, ahead_m=-3.0, aside_m=7.0)
    yaw_rad = first_yaw_rad + turned_rad
    last = replace(
        first,
        yaw_rad=yaw_rad,
        ahead_m=first.ahead_m + way_m * math.cos(yaw_rad),
        aside_m=first.aside_m + way_m * math.sin(yaw_rad),
    )
    here.take(first)
    here.take(last)
    pose = here.at(1.0).pose
    heading_rad = home_rad + turned_rad
    assert abs(bearing_between_rad(heading_rad, pose.heading_rad)) < 1e-9
    expected = 10.0 + way_m * math.sin(heading_rad), 20.0 + way_m * math.cos(heading_rad)
    assert (pose.x_m, pose.y_m) == pytest.approx(expected, abs=1e-9)


def test_reckoning_is_good_from_the_first_word_to_the_end_of_its_way():
    here = Reckoned(Pose(0.0, 0.0), reckon_m=5.0)
    assert here.at(0.0).verdict.grade is Grade.STALE
    here.take(STILL)
    assert here.at(0.0).verdict.is_good
    here.take(replace(STILL, ahead_m=3.0))
    here.take(replace(STILL, ahead_m=0.0))
    assert here.at(0.0).verdict.grade is Grade.POOR


def test_walking_corrects_a_heading_that_a_person_gave_wrongly():
    wrong_rad = math.radians(8.0)
    here = Surveyed(Pose(0.0, 0.0, 0.0, math.pi / 2 + wrong_rad), settings=WalkSettings().localizer)
    for tick in range(600):  # to the east, half a minute
        t_s = 0.05 * tick
        here.take(replace(STILL, time_s=t_s, forward_mps=0.5, yaw_rad=1.0))
        if tick % 4 == 0:
            here.take_fix(Fix(t_s, FixQuality.FIXED, x_m=0.5 * t_s, y_m=0.0))
    there = here.at(0.05 * 599)
    assert there.verdict.is_good, there.verdict
    assert abs(bearing_between_rad(math.pi / 2, there.pose.heading_rad)) < math.radians(1.5)
    assert (there.pose.x_m, there.pose.y_m) == pytest.approx((0.5 * 0.05 * 599, 0.0), abs=0.1)


def test_before_the_first_fix_it_turns_by_its_yaw_and_says_what_is_missing():
    here = Surveyed(Pose(3.0, 4.0, 0.0, 1.0), settings=WalkSettings().localizer)
    here.take(replace(STILL, yaw_rad=0.5))
    here.take(replace(STILL, time_s=0.05, yaw_rad=0.75))
    there = here.at(0.05)
    assert there.pose == Pose(3.0, 4.0, 0.0, 1.25)
    assert "no fix has come in" in there.verdict.reason


def test_a_leg_keeps_both_ends_of_its_way():
    log = LegLog(Pose(10.0, 0.0), 100.0, 0.45)
    for step in range(31):
        log.see(0.1 * step, Pose(0.08 * step, 0.0), across_m=0.1)
    leg = log.leg(LegOutcome.STOPPED, "why")
    assert (leg.track[0].t_s, leg.track[-1].t_s) == pytest.approx((100.0, 103.0))
    assert (leg.track[0].x_m, leg.track[-1].x_m) == pytest.approx((0.0, 2.4))
    assert leg.length_m == pytest.approx(2.4)
    assert leg.cross_track_rms_m == pytest.approx(0.1)
    assert len(leg.track) < 12


def test_all_bad_settings_are_told_at_once():
    with pytest.raises(SettingsError) as caught:
        WalkSettings(reckon_m=0.0, poll_s=0.0, position_patience_s=-1.0, lost_patience_s=math.nan)
    assert len(caught.value.faults) == 4
