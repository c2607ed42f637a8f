"""The driver over real sockets, against the served robot."""

import math

import pytest

from reasoned_explorer.clock import RealClock, VirtualClock
from reasoned_explorer.geometry import Pose, bearing_between_rad
from reasoned_explorer.model import LegOutcome, PartError, SettingsError
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.world import Building
from tests.vehicles.unitree.served_go1 import GO1, HOME, receiver, served, walked
from tests.world.worlds import box, field


@pytest.fixture(scope="module")
def atlas():
    """A meadow with a house in the north."""
    return Atlas(field(("tree", 70.0, 50.0), buildings=[Building(box(40.0, 70.0, 60.0, 80.0), 8.0)]))


def body_of(server):
    return server.server.walker.body.true_pose


async def one_leg(vehicle):
    leg = await vehicle.go_to(Pose(55.0, 53.0, 0.0, math.pi))
    return leg, vehicle.pose


def test_a_leg_says_what_was_walked(atlas):
    with served(atlas) as server:
        leg, pose = walked(server, one_leg)
        true = body_of(server)
    assert (leg.outcome, leg.detail) == (LegOutcome.ARRIVED, "")
    assert leg.length_m == pytest.approx(math.hypot(5.0, 3.0), abs=0.4)
    assert leg.duration_s > leg.length_m / GO1.speed_mps
    assert (leg.track[0].x_m, leg.track[0].y_m) == (50.0, 50.0)
    assert leg.track[-1].t_s - leg.track[0].t_s == pytest.approx(leg.duration_s)
    assert (true.x_m, true.y_m) == pytest.approx((55.0, 53.0), abs=0.4)
    assert pose.distance_to_m(true.x_m, true.y_m) < 0.01
    assert abs(bearing_between_rad(pose.heading_rad, math.pi)) < 0.1


@pytest.mark.parametrize("dialect", ["gpsd"])
def test_a_receiver_says_where_it_is(atlas, dialect):
    with served(atlas, dialect=dialect, noise="rtk-fixed", seed=3) as server:
        leg, pose = walked(server, one_leg, by_receiver=True)
        true = body_of(server)
    assert leg.outcome is LegOutcome.ARRIVED
    assert pose.distance_to_m(true.x_m, true.y_m) < 0.2
