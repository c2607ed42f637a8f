import math

import pytest

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import StartError
from reasoned_explorer.serving.airsim.drifting import Drift, Yaw
from reasoned_explorer.serving.airsim.drone import Drone
from reasoned_explorer.vehicles import PROFILES
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.world import Building
from tests.world.worlds import box, field

START = Pose(50.0, 50.0, 0.0, 0.0)


@pytest.fixture(scope="module")
def atlas():
    """A meadow with a house in the north and a tree in the east."""
    return Atlas(field(("tree", 62.0, 50.0), buildings=[Building(box(40.0, 70.0, 60.0, 80.0), 8.0)]))


def drone(atlas, **more):
    made = Drone(atlas, PROFILES["drone"], START, **more)
    made.climb(0.0, 1.5)
    return made


def test_it_rises_evenly_and_stays_up(atlas):
    made = Drone(atlas, PROFILES["drone"], START)
    assert made.is_landed(0.0)
    flight = made.climb(0.0, 3.0, speed_mps=1.5)
    assert flight.answer_s == 2.0
    assert made.state(1.0).z_m == pytest.approx(1.5)
    assert made.state(1.0).vz_mps == pytest.approx(1.5)
    assert (made.state(9.0).z_m, made.is_landed(9.0)) == (3.0, False)


def test_it_flies_to_a_point_and_faces_as_told(atlas):
    made = drone(atlas)
    flight = made.fly(2.0, [Pose(50.0, 60.0, 2.5, math.pi / 2)], speed_mps=3.0, face=True)
    assert flight.succeeded
    half = made.state(2.0 + 0.5 * flight.answer_s)
    assert 52.0 < half.y_m < 60.0
    assert 1.5 < half.z_m < 2.5
    end = made.state(2.0 + flight.answer_s)
    assert (end.x_m, end.y_m, end.z_m) == pytest.approx((50.0, 60.0, 2.5), abs=0.3)
    assert end.heading_rad == pytest.approx(math.pi / 2, abs=0.1)


def test_the_same_commands_at_the_same_times_end_in_the_same_place(atlas):
    def flown():
        made = drone(atlas, noise="rtk-fixed", seed=3)
        made.fly(2.0, [Pose(50.0, 60.0, 1.5)], speed_mps=3.0, face=False)
        made.fly(30.0, [Pose(45.0, 60.0, 1.5)], speed_mps=3.0, face=True)
        return made.state(60.0), made.belief(60.0)

    assert flown() == flown()
    assert flown()[0] != flown()[1]  # what it believes is off by what its sensors err


def test_a_wall_stops_it_and_is_told_when_it_is_reached(atlas):
    made = drone(atlas)
    flight = made.fly(2.0, [Pose(50.0, 78.0, 1.5)], speed_mps=3.0, face=False)
    assert not flight.succeeded
    made.state(3.0)
    assert made.last_hit is None
    assert 69.5 < made.state(60.0).y_m < 69.7  # its radius before the wall, and a little
    at_s, hit = made.last_hit
    assert (hit.name, at_s) == ("building_0", pytest.approx(2.0 + flight.answer_s))
    assert math.cos(hit.heading_rad) > 0.99


def test_above_the_roof_nothing_is_in_the_way(atlas):
    made = drone(atlas)
    made.climb(2.0, 20.0, speed_mps=5.0)
    assert made.fly(10.0, [Pose(50.0, 78.0, 20.0)], speed_mps=3.0, face=False).succeeded


def test_stopped_on_the_way_it_stands_where_it_was(atlas):
    made = drone(atlas)
    made.fly(2.0, [Pose(50.0, 65.0, 1.5)], speed_mps=3.0, face=False)
    before = made.state(4.0)
    made.stop(4.0)
    after = made.state(50.0)
    assert (after.x_m, after.y_m) == pytest.approx((before.x_m, before.y_m), abs=0.05)
    assert after.vy_mps == 0.0


def test_a_new_command_ends_the_old_one(atlas):
    made = drone(atlas)
    made.fly(2.0, [Pose(50.0, 65.0, 1.5)], speed_mps=3.0, face=False)
    made.fly(4.0, [Pose(40.0, 50.0, 1.5)], speed_mps=3.0, face=False)
    assert made.state(60.0).x_m == pytest.approx(40.0, abs=0.5)


def test_it_flies_by_velocity_within_its_acceleration_and_brakes(atlas):
    made = drone(atlas)
    flight = made.drift(2.0, Drift(-2.0, 0.0, 0.0, 4.0, Yaw()))
    assert flight.answer_s == 4.0
    early = made.state(2.5)
    assert -1.2 < early.vx_mps < -0.8  # 2 m/s²
    assert made.state(5.0).vx_mps == pytest.approx(-2.0)
    end = made.state(30.0)
    assert end.x_m == pytest.approx(50.0 - 2.0 * 4.0, abs=0.2)
    assert end.vx_mps == 0.0


def test_streamed_velocities_keep_it_going(atlas):
    made = drone(atlas)
    for tick in range(40):
        made.drift(2.0 + 0.1 * tick, Drift(-2.0, 0.0, 0.0, 1.0, Yaw()))
    assert made.state(6.0).vx_mps == pytest.approx(-2.0)


@pytest.mark.parametrize("speed", [1.0, 20.0])
def test_a_tree_stops_it_however_fast_it_is(atlas, speed):
    made = drone(atlas)
    flight = made.drift(2.0, Drift(speed, 0.0, 0.0, 20.0, Yaw()))
    assert not flight.succeeded
    assert flight.answer_s == 20.0
    end = made.state(60.0)
    assert 60.0 < end.x_m < 62.0
    assert made.last_hit[1].name == "tree_0"


def test_the_edge_of_the_world_and_the_ground_stop_it(atlas):
    made = drone(atlas)
    made.drift(2.0, Drift(0.0, -10.0, -1.0, 20.0, Yaw()))
    end = made.state(60.0)
    assert 0.0 <= end.y_m < 1.0
    assert end.z_m == 0.0


@pytest.mark.parametrize(
    ("yaw", "expected_rad"),
    [(Yaw(0.5), 1.0), (Yaw(heading_rad=math.pi), math.pi), (Yaw(along=True), 1.5 * math.pi)],
)
def test_it_faces_as_told_while_it_flies_by_velocity(atlas, yaw, expected_rad):
    made = drone(atlas)
    duration_s = 2.0 if yaw.rate_radps else 6.0
    made.drift(2.0, Drift(-1.0, 0.0, 0.0, duration_s, yaw))
    assert made.state(60.0).heading_rad == pytest.approx(expected_rad, abs=0.05)


def test_it_turns_in_place_and_half_way_if_stopped(atlas):
    made = drone(atlas)
    made.turn(2.0, 3.0)
    made.stop(3.0)
    assert 0.5 < made.state(60.0).heading_rad < 2.5
    made.turn(60.0, 3.0)
    assert made.state(90.0).heading_rad == pytest.approx(3.0, abs=0.1)


def test_it_can_be_put_elsewhere_and_back_at_the_start(atlas):
    made = drone(atlas)
    made.place(5.0, Pose(20.0, 20.0, 4.0, 1.0))
    assert made.state(5.0)[:4] == (20.0, 20.0, 4.0, 1.0)
    assert made.belief(5.0)[:2] == pytest.approx((20.0, 20.0), abs=1e-3)
    made.reset()
    assert made.state(6.0)[:4] == (50.0, 50.0, 0.0, 0.0)


def test_it_does_not_start_in_a_house(atlas):
    with pytest.raises(StartError, match="inside a building"):
        Drone(atlas, PROFILES["drone"], Pose(50.0, 75.0))
