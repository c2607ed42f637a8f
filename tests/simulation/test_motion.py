import hashlib
import math
import subprocess
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reasoned_explorer.geometry import Pose, bearing_between_rad
from reasoned_explorer.simulation import kernels
from reasoned_explorer.simulation.motion import Body, End, Ground
from reasoned_explorer.simulation.sensors import SENSOR_NOISE, SensorNoise
from reasoned_explorer.vehicles.profile import PROFILES
from reasoned_explorer.world.world import Bounds

WIDE = Bounds(-500.0, -500.0, 500.0, 500.0)


def body(name: str = "drone", *, noise: str | SensorNoise = "rtk-fixed", seed: int = 1, **more) -> Body:
    start, bounds = more.pop("start", Pose(0.0, 0.0)), more.pop("bounds", WIDE)
    chosen = SENSOR_NOISE[noise] if isinstance(noise, str) else noise
    return Body(PROFILES[name], chosen, start, seed=seed, bounds=bounds, **more)


def walls(*rows: tuple[float, float, float, float]) -> np.ndarray:
    return np.array(rows, dtype=np.float64)


def path_of(points: np.ndarray) -> float:
    return float(np.hypot(*np.diff(points[:, 1:3], axis=0).T).sum())


@pytest.mark.parametrize("name", sorted(PROFILES))
@pytest.mark.parametrize("noise", ["none", "rtk-fixed"])
def test_legs_arrive_and_the_track_tells_how(name, noise):
    machine = body(name, noise=noise)
    for leg, target in enumerate([Pose(0.0, 12.0, 0.0, 1.0), Pose(9.0, 3.0, 0.0, 4.0), Pose(9.0, 3.0, 0.0, 0.0)]):
        before = machine.true_pose
        motion = machine.drive(target, leg=leg)
        after = machine.true_pose
        assert motion.end is End.ARRIVED
        assert after.distance_to_m(target.x_m, target.y_m) < 0.25
        assert abs(bearing_between_rad(after.heading_rad, target.heading_rad)) < math.radians(8.0)
        times, xs, ys = motion.points[:, 0], motion.points[:, 1], motion.points[:, 2]
        assert (times[0], xs[0], ys[0]) == (0.0, before.x_m, before.y_m)
        assert (times[-1], xs[-1], ys[-1]) == pytest.approx((motion.duration_s, after.x_m, after.y_m))
        assert (np.diff(times) > 0.0).all()
        assert np.hypot(np.diff(xs), np.diff(ys)).max(initial=0.0) < 1.3
        assert path_of(motion.points) == pytest.approx(motion.length_m, abs=0.15)
        assert 0.0 <= motion.points[:, 3].min() <= motion.points[:, 3].max() < 2.0 * math.pi


def test_with_perfect_sensors_the_estimate_is_the_truth():
    machine = body("go1", noise="none")
    machine.drive(Pose(5.0, -4.0, 0.0, 2.0), leg=0)
    assert machine.pose.distance_to_m(machine.true_pose.x_m, machine.true_pose.y_m) < 1e-3
    assert abs(bearing_between_rad(machine.pose.heading_rad, machine.true_pose.heading_rad)) < 1e-3


def test_the_authors_leg_takes_about_as_long_as_theirs():
    """Seven metres at 1 m/s and five seconds of waiting: 13.2 s in their log."""
    motion = body("drone-authors").drive(Pose(0.0, 7.0), leg=0)
    assert motion.duration_s == pytest.approx(13.2, abs=0.4)
    assert motion.points[-1, 0] == pytest.approx(motion.duration_s)
    # The track shows it standing while it settles, not creeping.
    at_rest = motion.points[motion.points[:, 0] > motion.duration_s - 4.5]
    before = motion.points[motion.points[:, 0] <= motion.duration_s - 4.5][-1]
    assert np.hypot(at_rest[:, 1] - before[1], at_rest[:, 2] - before[2]).max() < 0.1


def test_no_faster_and_no_sooner_than_the_profile_allows():
    profile = PROFILES["drone"]
    motion = body("drone", noise="none").drive(Pose(0.0, 30.0), leg=0)
    ramp_s = profile.speed_mps / profile.acceleration_mps2
    assert motion.duration_s > 30.0 / profile.speed_mps + ramp_s / 2 + profile.settle_s
    speeds = np.hypot(*np.diff(motion.points[:, 1:3], axis=0).T) / np.diff(motion.points[:, 0])
    assert speeds.max() < profile.speed_mps + 4.0 * profile.sway_mps


@pytest.mark.parametrize("name", ["drone", "go1", "go1-authors", "drone-authors"])
def test_tracking_and_localization_are_as_good_as_promised(name):
    cross, error = [], []
    for seed in range(20):
        machine, pose = body(name, seed=seed), Pose(0.0, 0.0)
        for leg in range(3):
            pose = pose.facing(1.1 * seed + 0.9 * leg).ahead(12.0)
            motion = machine.drive(pose, leg=leg)
            cross.append(motion.cross_track_rms_m)
            error.append(motion.localization_rms_m)
    assert max(cross) <= 0.25
    assert np.sqrt(np.mean(np.square(error))) <= 0.05


@pytest.mark.parametrize("noise", ["rtk-fixed", "rtk-float", "single"])
@pytest.mark.parametrize("name", ["drone", "go1"])
def test_the_filter_is_as_sure_as_it_may_be(name, noise):
    """NEES of position and heading: 3 on average if errors are as large as the filter says (chi-square, 3 d.o.f.)."""
    nees = []
    for seed in range(100):
        machine = body(name, noise=noise, seed=seed, start=Pose(0.0, 0.0, 0.0, 0.9 * (seed % 7)))
        machine.drive(Pose(0.0, 0.0).facing(1.3 * seed).ahead(12.0), leg=0)
        machine.wait(20.0)
        machine.drive(Pose(0.0, 0.0).facing(1.3 * seed).ahead(4.0), leg=1)
        nees.append(machine.nees())
    # Four standard deviations of a mean of 100 such values: 3 ± 4 · √(6/100).
    assert np.mean(nees) == pytest.approx(3.0, abs=0.98)
    assert np.mean(np.array(nees) > 16.27) <= 0.03  # the quantile 0.999


def test_a_gap_without_fixes_is_bridged_and_known():
    """Half the mission without a single fix: the error grows, and the filter says so."""
    patchy = SensorNoise("patchy", gap_share=0.05, gap_s=20.0)
    machine = body("go1", noise=patchy, seed=3)
    sigmas = []
    for leg in range(6):
        motion = machine.drive(Pose(0.0, 12.0 * (leg + 1)), leg=leg)
        assert motion.end is End.ARRIVED
        sigmas.append(machine.filter.estimate.position_sigma_m)
        assert machine.pose.distance_to_m(machine.true_pose.x_m, machine.true_pose.y_m) < 5.0 * sigmas[-1]
    assert max(sigmas) > 3.0 * min(sigmas)


def test_outliers_are_refused_and_do_no_harm():
    wild = SensorNoise("wild", outlier_share=0.1, outlier_m=5.0)
    motion = body("drone", noise=wild).drive(Pose(0.0, 40.0), leg=0)
    assert motion.refused >= 3
    assert motion.localization_rms_m < 0.06


@pytest.mark.parametrize("name", ["drone", "go1"])
def test_a_wall_stops_it_before_it_touches(name):
    machine = body(name)
    motion = machine.drive(Pose(0.0, 12.0), leg=0, walls=walls((-9.0, 20.0, 9.0, 20.0), (-5.0, 6.0, 5.0, 7.0)))
    assert motion.end is End.WALL
    assert motion.hit == 1
    nearest = min(kernels.wall_distance(walls((-5.0, 6.0, 5.0, 7.0)), 0, x, y) for _, x, y, _ in motion.points.tolist())
    radius = PROFILES[name].radius_m
    assert radius < nearest < radius + 0.02
    # It backed off and can go on along the wall.
    assert machine.drive(Pose(0.0, 0.0), leg=1).end is End.ARRIVED


def test_a_disc_stops_it_from_every_side():
    for k in range(12):
        heading = k * math.pi / 6
        machine = body("drone", start=Pose(0.0, 0.0).ahead(6.0, bearing_rad=heading))
        motion = machine.drive(Pose(0.0, 0.0), leg=k, discs=np.array([[0.0, 0.0, 0.25]]))
        assert motion.end is End.DISC
        nearest = np.hypot(motion.points[:, 1], motion.points[:, 2]).min()
        assert 0.25 + 0.3 < nearest < 0.25 + 0.3 + 0.02


def test_what_it_touches_at_the_start_does_not_hold_it():
    """Put down right beside a wall it may leave, but not go through."""
    beside = walls((-5.0, 0.1, 5.0, 0.1))
    assert body("go1").drive(Pose(0.0, -5.0), leg=0, walls=beside).end is End.ARRIVED
    assert body("go1").drive(Pose(0.0, 5.0), leg=0, walls=beside).end is End.WALL


def test_the_authors_drone_does_not_collide():
    motion = body("drone-authors").drive(Pose(0.0, 7.0), leg=0, walls=walls((-5.0, 3.0, 5.0, 3.0)))
    assert motion.end is End.ARRIVED


@settings(max_examples=60)
@given(
    st.lists(
        st.tuples(st.floats(-10.0, 10.0), st.floats(-10.0, 10.0), st.floats(-3.0, 3.0), st.floats(-3.0, 3.0)),
        min_size=1,
        max_size=12,
    ),
    st.integers(0, 1000),
)
def test_nothing_is_ever_gone_through(rows, seed):
    obstacles = walls(*((x, y, x + dx, y + dy) for x, y, dx, dy in rows))
    machine = body("drone", seed=seed, start=Pose(0.0, 0.0, 0.0, seed * 0.1))
    radius = PROFILES["drone"].radius_m
    if kernels.clearance(obstacles, np.empty((0, 3)), 0.0, 0.0) < radius:
        return
    for leg in range(2):
        motion = machine.drive(Pose(0.0, 0.0).facing(seed + leg).ahead(9.0), leg=leg, walls=obstacles)
        for _, x, y, _ in motion.points.tolist():
            assert kernels.clearance(obstacles, np.empty((0, 3)), x, y) >= radius - 0.02


def test_a_walker_stops_before_water():
    codes = np.zeros((40, 40), np.uint8)
    codes[28:, :] = 11  # from y = 4 on
    blocked = np.zeros(256, np.bool_)
    blocked[11] = True
    pond = Ground(codes, -10.0, -10.0, 0.5, blocked)
    machine = body("go1", ground=pond)
    motion = machine.drive(Pose(1.0, 5.0), leg=0)
    assert motion.end is End.GROUND
    assert motion.hit == 11
    assert 3.5 < motion.points[:, 2].max() < 4.0 - 0.9 * PROFILES["go1"].radius_m
    # One that stands in it already may leave it.
    assert body("go1", ground=pond, start=Pose(0.0, 6.0)).drive(Pose(0.0, 0.0), leg=0).end is End.ARRIVED


def test_the_edge_of_the_world_stops_everything():
    for name in ("drone-authors", "go1"):
        machine = body(name, bounds=Bounds(-5.0, -5.0, 5.0, 5.0))
        motion = machine.drive(Pose(0.0, 12.0), leg=0)
        assert motion.end is End.EDGE
        assert motion.points[:, 2].max() <= 5.0


def test_time_in_one_piece_is_time_in_two():
    """A leg that is cut off and one that is not are the same up to the cut."""
    whole, cut = body("drone", seed=9), body("drone", seed=9)
    saved = cut.save()
    complete = whole.drive(Pose(0.0, 12.0), leg=4)
    cut.drive(Pose(0.0, 12.0), leg=4)
    cut.restore(saved)
    part = cut.drive(Pose(0.0, 12.0), leg=4, limit_s=3.0)
    assert part.end is End.CUT
    assert part.duration_s == pytest.approx(3.0)
    shared = complete.points[complete.points[:, 0] <= part.points[-2, 0]]
    assert (part.points[: len(shared)] == shared).all()


def test_draws_depend_on_the_leg_and_not_on_what_went_before():
    first, second = body(seed=5), body(seed=5)
    assert (first.drive(Pose(0.0, 5.0), leg=7).points == second.drive(Pose(0.0, 5.0), leg=7).points).all()
    other = body(seed=5)
    assert (other.drive(Pose(0.0, 5.0), leg=8).points != body(seed=5).drive(Pose(0.0, 5.0), leg=7).points[-1]).any()


DIGEST = """
import hashlib
from reasoned_explorer.geometry import Pose
from reasoned_explorer.simulation.motion import Body
from reasoned_explorer.simulation.sensors import SENSOR_NOISE
from reasoned_explorer.vehicles.profile import PROFILES
from reasoned_explorer.world.world import Bounds
machine = Body(PROFILES["go1"], SENSOR_NOISE["rtk-fixed"], Pose(0.0, 0.0), seed=42, bounds=Bounds(-99, -99, 99, 99))
digest = hashlib.sha256()
for leg, target in enumerate([Pose(0.0, 12.0, 0.0, 1.0), Pose(9.0, 3.0, 0.0, 4.0)]):
    digest.update(machine.drive(target, leg=leg).points.tobytes())
    machine.wait(11.5)
digest.update(machine.filter.state.tobytes())
print(digest.hexdigest())
"""


def test_two_processes_move_alike_to_the_last_bit(capsys):
    other = subprocess.run([sys.executable, "-c", DIGEST], capture_output=True, text=True, check=True)
    exec(DIGEST, {})  # noqa: S102 - the same text, in this process
    here = capsys.readouterr().out.strip()
    assert len(here) == hashlib.sha256().digest_size * 2
    assert other.stdout.strip() == here


def test_it_can_be_put_elsewhere_and_drives_on_from_there():
    made = body()
    made.drive(Pose(50.0, 60.0), leg=0)
    made.place(Pose(20.0, 30.0, 0.0, 1.0))
    assert made.true_pose == Pose(20.0, 30.0, 0.0, 1.0)
    assert made.pose.distance_to_m(20.0, 30.0) < 0.1
    motion = made.drive(Pose(25.0, 30.0), leg=1)
    assert motion.end is End.ARRIVED
    assert made.true_pose.distance_to_m(25.0, 30.0) < 0.5


def test_its_cruise_speed_can_be_changed():
    slow, fast = body(), body()
    fast.cruise_at(6.0)
    target = Pose(50.0, 80.0)
    slow_s, fast_s = slow.drive(target, leg=0).duration_s, fast.drive(target, leg=0).duration_s
    assert fast.profile.speed_mps == 6.0
    assert fast_s < 0.75 * slow_s


@pytest.mark.parametrize("name", sorted(PROFILES))
def test_after_a_sudden_stop_it_knows_that_it_stands(name):
    machine = body(name)
    machine.drive(Pose(0.0, 30.0), leg=0, limit_s=4.0)
    machine.drive(Pose(machine.pose.x_m + 9.0, machine.pose.y_m), leg=1, limit_s=2.0)
    believed, there = machine.pose, machine.true_pose
    assert believed.distance_to_m(there.x_m, there.y_m) < 0.3
    assert not machine.filter.rejects[:2].any()
