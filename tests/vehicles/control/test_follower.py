import math
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reasoned_explorer.geometry import Pose, bearing_between_rad, normalise_heading_rad
from reasoned_explorer.model import SettingsError
from reasoned_explorer.vehicles.control.follower import Command, FollowerSettings, Phase, PidFollower
from reasoned_explorer.vehicles.profile import PROFILES

DT_S = 0.05


def ideal(pose: Pose, command: Command) -> Pose:
    """A machine that does at once what it is told."""
    heading = normalise_heading_rad(pose.heading_rad + command.yaw_rate_radps * DT_S)
    forward, right = command.forward_mps * DT_S, command.right_mps * DT_S
    x_m = pose.x_m + forward * math.sin(heading) + right * math.cos(heading)
    y_m = pose.y_m + forward * math.cos(heading) - right * math.sin(heading)
    return Pose(x_m, y_m, 0.0, heading)


def follow(name: str, start: Pose, target: Pose, *, machine=ideal, seconds: float = 200.0):
    follower = PidFollower(FollowerSettings.of(PROFILES[name]))
    follower.start(start, target)
    pose, commands, poses, rate = start, [], [start], 0.0
    for _ in range(int(seconds / DT_S)):
        command = follower.step(pose, yaw_rate_radps=rate, dt_s=DT_S)
        commands.append(command)
        if command.phase in {Phase.ARRIVED, Phase.STUCK}:
            break
        pose, rate = machine(pose, command), command.yaw_rate_radps
        poses.append(pose)
    return commands, poses


@pytest.mark.parametrize("name", sorted(PROFILES))
@settings(max_examples=25)
@given(
    distance_m=st.floats(0.0, 30.0),
    heading_rad=st.floats(0.0, 6.28),
    facing_rad=st.floats(0.0, 6.28),
    start_rad=st.floats(0.0, 6.28),
)
def test_every_target_is_reached_and_faced_within_the_limits(name, distance_m, heading_rad, facing_rad, start_rad):
    profile = PROFILES[name]
    start = Pose(5.0, -3.0, 0.0, start_rad)
    target = Pose(5.0 + distance_m * math.sin(heading_rad), -3.0 + distance_m * math.cos(heading_rad), 0.0, facing_rad)
    commands, poses = follow(name, start, target)
    assert commands[-1].phase is Phase.ARRIVED
    assert poses[-1].distance_to_m(target.x_m, target.y_m) < 0.3
    assert abs(bearing_between_rad(poses[-1].heading_rad, facing_rad)) < math.radians(4.0)
    for command in commands:
        assert math.hypot(command.forward_mps, command.right_mps) <= profile.speed_mps + 1e-9
        assert abs(command.yaw_rate_radps) <= profile.turn_rate_radps + 1e-9


@pytest.mark.parametrize("name", ["go1", "go1-authors"])
def test_the_commanded_acceleration_keeps_the_limit(name):
    commands, _ = follow(name, Pose(0.0, 0.0), Pose(0.0, 6.0))
    speeds = [command.forward_mps for command in commands[:-1]]
    steps = [abs(after - before) for before, after in pairwise(speeds)]
    assert max(steps) <= PROFILES[name].acceleration_mps2 * DT_S + 1e-9
    assert max(speeds) == pytest.approx(PROFILES[name].speed_mps)


def test_a_quadruped_turns_in_place_before_it_walks_somewhere_behind():
    commands, poses = follow("go1", Pose(0.0, 0.0, 0.0, 0.0), Pose(0.0, -5.0, 0.0, math.pi))
    assert commands[0].phase is Phase.TURN
    assert max(abs(pose.x_m) for pose in poses) < 0.2
    first_move = next(i for i, command in enumerate(commands) if command.forward_mps > 0.0)
    assert abs(bearing_between_rad(poses[first_move].heading_rad, math.pi)) < math.radians(10.0)


def test_a_drone_flies_straight_while_it_turns():
    commands, poses = follow("drone", Pose(0.0, 0.0, 0.0, 0.0), Pose(12.0, 0.0, 0.0, math.pi / 2))
    assert Phase.TURN not in {command.phase for command in commands}
    assert commands[3].right_mps > 0.2
    assert max(abs(pose.y_m) for pose in poses) < 0.15


def test_it_slows_down_before_the_target():
    commands, poses = follow("drone", Pose(0.0, 0.0), Pose(0.0, 12.0))
    for command, pose in zip(commands, poses, strict=False):
        if command.phase is Phase.DRIVE and pose.distance_to_m(0.0, 12.0) < 0.5:
            assert command.forward_mps < 1.5


def test_passing_the_target_ends_the_leg():
    """An estimate that jumps past the target must not make the machine turn back and forth."""
    follower = PidFollower(FollowerSettings.of(PROFILES["go1"]))
    follower.start(Pose(0.0, 0.0), Pose(0.0, 5.0))
    follower.step(Pose(0.0, 1.0), yaw_rate_radps=0.0, dt_s=DT_S)
    assert follower.step(Pose(0.9, 5.2), yaw_rate_radps=0.0, dt_s=DT_S).phase in {Phase.BRAKE, Phase.FACE}


@pytest.mark.parametrize("target", [Pose(0.0, 8.0), Pose(-8.0, 0.0)])
def test_a_machine_that_does_not_move_is_stuck_and_told_to_stand(target):
    commands, _ = follow("go1", Pose(0.0, 0.0), target, machine=lambda pose, command: pose)
    assert commands[-1] == Command(0.0, 0.0, 0.0, Phase.STUCK)
    assert len(commands) * DT_S == pytest.approx(4.0, abs=0.5)


def test_a_slow_machine_is_not_taken_for_stuck():
    commands, _ = follow("go1-authors", Pose(0.0, 0.0), Pose(0.0, 3.0))
    assert commands[-1].phase is Phase.ARRIVED


def test_the_cross_track_distance_is_positive_to_the_right():
    follower = PidFollower(FollowerSettings.of(PROFILES["drone"]))
    follower.start(Pose(0.0, 0.0), Pose(0.0, 10.0))
    follower.step(Pose(0.5, 2.0), yaw_rate_radps=0.0, dt_s=DT_S)
    assert follower.cross_track_m == pytest.approx(0.5)


def test_not_a_number_is_refused():
    follower = PidFollower(FollowerSettings.of(PROFILES["drone"]))
    with pytest.raises(SettingsError, match="target"):
        follower.start(Pose(0.0, 0.0), Pose(math.nan, 0.0))


def test_bad_settings_are_all_named_at_once():
    with pytest.raises(SettingsError) as caught:
        FollowerSettings(
            speed_mps=-1.0,
            acceleration_mps2=1.0,
            braking_mps2=2.0,
            turn_rate_radps=math.inf,
            turn_acceleration_radps2=1.0,
        )
    assert len(caught.value.faults) == 3


def test_turning_in_place_stays_where_it_is():
    settings = FollowerSettings.of(PROFILES["go1"])
    follower, pose = PidFollower(settings), Pose(3.0, 4.0, 0.0, 0.5)
    follower.face(pose, 1.5)
    for _ in range(400):
        command = follower.step(pose, yaw_rate_radps=0.0, dt_s=0.05)
        assert (command.forward_mps, command.right_mps) == (0.0, 0.0)
        pose = pose.facing(pose.heading_rad + 0.05 * command.yaw_rate_radps)
        if command.phase is Phase.ARRIVED:
            break
    assert command.phase is Phase.ARRIVED
    assert pose.heading_rad == pytest.approx(1.5, abs=settings.facing_rad)
