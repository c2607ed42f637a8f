"""The driver over real sockets, against the served robot."""

import asyncio
import math
from dataclasses import replace

import numpy as np
import pytest

from reasoned_explorer.clock import RealClock, VirtualClock
from reasoned_explorer.geometry import Pose, bearing_between_rad
from reasoned_explorer.model import LegOutcome, PartError, SettingsError
from reasoned_explorer.vehicles import PROFILES
from reasoned_explorer.vehicles.positioning import PositionLimits
from reasoned_explorer.vehicles.unitree import HighCommand, Mode
from reasoned_explorer.vehicles.unitree.settings import WalkSettings
from reasoned_explorer.vehicles.unitree.vehicle import Go1Vehicle
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.world import Building
from tests.vehicles.unitree.served_go1 import GO1, HOME, LOST_S, SLOW, served, walked
from tests.world.worlds import box, field


@pytest.fixture(scope="module")
def atlas():
    """A meadow with a house in the north."""
    return Atlas(field(("tree", 70.0, 50.0), buildings=[Building(box(40.0, 70.0, 60.0, 80.0), 8.0)]))


def body_of(server):
    return server.walker.body.true_pose


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


def test_a_receiver_says_where_it_is(atlas):
    with served(atlas, dialect="gpsd", noise="rtk-fixed", seed=3) as server:
        leg, pose = walked(server, one_leg, by_receiver=True)
        true = body_of(server)
    assert leg.outcome is LegOutcome.ARRIVED
    assert pose.distance_to_m(true.x_m, true.y_m) < 0.2


def test_it_looks_with_its_body_in_each_heading_beginning_at_the_nearer_end(atlas):
    seen = []

    def content(pose, camera):
        seen.append(pose.heading_rad)
        return "a meadow"

    async def look(vehicle):
        return await vehicle.look([2.0, 1.0]), await vehicle.look([1.0])

    clock = VirtualClock()
    with served(atlas) as server:
        (first, last), (again,) = walked(server, look, clock=clock, content=content)
        true = body_of(server)
    assert seen == pytest.approx([1.0, 2.0, 1.0], abs=math.radians(4.0))
    assert [view.key for view in (first, last, again)] == [(0, 0, 0), (0, 0, 1), (0, 1, 0)]
    assert first.pose.heading_rad == pytest.approx(2.0, abs=math.radians(4.0))
    assert first.pose.z_m == GO1.camera_height_m
    assert first.content == "a meadow"
    assert true.distance_to_m(HOME.x_m, HOME.y_m) < 0.05
    assert clock.now_s() > 2 * GO1.look_s


def test_pictures_are_those_of_the_camera_that_is_given(atlas):
    picture = np.full((4, 6, 3), 7, np.uint8)

    async def look(vehicle):
        return await vehicle.look([0.0])

    with served(atlas) as server:
        (view,) = walked(server, look, camera=lambda: picture)
    assert view.image is picture


def test_what_stands_in_the_way_ends_the_leg_and_it_steps_back(atlas):
    async def script(vehicle):
        first = await vehicle.go_to(Pose(50.0, 75.0))
        hit = body_of(server)
        return first, hit, await vehicle.go_to(Pose(50.0, 60.0))

    with served(atlas) as server:
        first, hit, second = walked(server, script)
    assert (first.outcome, first.detail) == (LegOutcome.COLLISION, "something held it up")
    assert 69.0 < hit.y_m < 70.0 - GO1.radius_m - 0.05
    assert second.outcome is LegOutcome.ARRIVED


def test_mission_time_is_the_robots_time_while_the_agent_thinks_it_stands(atlas):
    clock = VirtualClock()

    async def script(vehicle):
        begun_s = clock.now_s()
        leg = await vehicle.go_to(Pose(52.0, 50.0))
        assert clock.now_s() - begun_s == pytest.approx(leg.duration_s)
        await clock.think(20.0)
        await vehicle.look([0.0])
        return clock.now_s(), server.walker.time_s

    with served(atlas) as server:
        mission_s, robot_s = walked(server, script, clock=clock)
    assert robot_s == pytest.approx(mission_s, abs=0.11)


def test_the_same_seed_walks_the_same_way(atlas):
    def way():
        with served(atlas, noise="rtk-fixed", dialect="gpsd", seed=5) as server:
            leg, pose = walked(server, one_leg, by_receiver=True)
        return leg, pose

    assert way() == way()


def test_a_cancelled_leg_leaves_it_standing_and_says_what_was_walked(atlas):
    clock = VirtualClock()

    async def script(vehicle):
        with pytest.raises(TimeoutError):
            async with asyncio.timeout(6.0):
                await vehicle.go_to(Pose(50.0, 65.0))
        return vehicle.last_leg, body_of(server)

    with served(atlas) as server:
        leg, there = walked(server, script, clock=clock)
        assert server.walker.body.true_pose == there
    assert (leg.outcome, leg.detail) == (LegOutcome.STOPPED, "cancelled")
    assert 1.0 < leg.length_m < 6.0


def test_battery_and_motors_are_told(atlas):
    async def script(vehicle):
        server.walker.health.charge_percent = 17
        server.walker.health.motor_c = 71
        await vehicle.look([0.0])
        return vehicle.battery_percent, vehicle.hottest_motor_c

    with served(atlas) as server:
        assert walked(server, script) == (17.0, 71.0)


def test_without_a_receiver_it_says_so_and_does_not_walk_far(atlas):
    async def script(vehicle):
        note = vehicle.position_note
        first = await vehicle.go_to(Pose(50.0, 54.0))
        return note, first, await vehicle.go_to(Pose(50.0, 60.0))

    settings = WalkSettings(reckon_m=3.0, position_patience_s=0.5)
    with served(atlas) as server:
        note, first, second = walked(server, script, settings=settings)
    assert "no receiver" in note
    assert first.outcome is second.outcome is LegOutcome.STOPPED
    assert "without a receiver" in first.detail
    assert second.length_m == 0.0


def test_a_robot_that_lies_gets_up_and_lies_again_where_that_is_wanted(atlas):
    async def nothing(vehicle):
        return server.walker.is_upright

    with served(atlas) as server:
        walked(server, nothing, settings=WalkSettings(lies=True))
        assert not server.walker.is_upright
        with pytest.raises(PartError, match="lies on the ground"):
            walked(server, nothing, settings=WalkSettings(gets_up=False))
        assert walked(server, nothing)
        assert server.walker.is_upright


def test_nobody_there_is_a_fault(atlas):
    with served(atlas) as server:
        pass
    clock = RealClock()
    with pytest.raises(PartError, match="no state from"):
        walked(server, one_leg, clock=clock)


def test_a_profile_that_flies_or_a_target_that_is_none_is_refused(atlas):
    with pytest.raises(SettingsError, match="walks and turns"):
        Go1Vehicle(PROFILES["drone"], clock=VirtualClock())
    with pytest.raises(SettingsError, match="reckon_m"):
        WalkSettings(reckon_m=-1.0)

    async def script(vehicle):
        with pytest.raises(SettingsError):
            await vehicle.go_to(Pose(math.nan, 0.0))
        with pytest.raises(SettingsError):
            await vehicle.look([math.inf])

    with served(atlas) as server:
        walked(server, script)


# On real time, as a real robot is driven.

PATIENT = WalkSettings(
    localizer=replace(
        WalkSettings().localizer,
        limits=PositionLimits(poor_after_s=2.5, stale_after_s=5.0, imu_silence_s=5.0, refused_s=5.0),
    ),
    lost_patience_s=0.5,
)
EAST = Pose(50.0, 50.0, 0.0, math.pi / 2)


def on_real_time(server, script, **more):
    return walked(server, script, clock=RealClock(), home=EAST, profile=SLOW, settings=PATIENT, **more)


def test_on_real_time_it_walks_by_its_receiver(atlas):
    async def script(vehicle):
        leg = await vehicle.go_to(Pose(50.6, 50.0, 0.0, math.pi / 2))
        return leg, vehicle.pose, body_of(server)

    with served(atlas, lockstep=False, silence_s=LOST_S, dialect="gpsd", start=EAST) as server:
        leg, pose, true = on_real_time(server, script, by_receiver=True)
    assert leg.outcome is LegOutcome.ARRIVED, leg
    assert pose.distance_to_m(true.x_m, true.y_m) < 0.3
    assert true.x_m == pytest.approx(50.6, abs=0.3)


def test_a_receiver_that_falls_silent_stops_the_leg(atlas):
    async def script(vehicle):
        async def silence():
            await asyncio.sleep(1.5)
            server.server.gnss.is_silent = True

        silencing = asyncio.create_task(silence())
        leg = await vehicle.go_to(Pose(80.0, 50.0))
        await silencing
        async with asyncio.timeout(60.0):
            while server.walker.mode is not Mode.STAND:
                await asyncio.sleep(0.02)
        return leg

    with served(atlas, lockstep=False, silence_s=LOST_S, dialect="gpsd", start=EAST) as server:
        leg = on_real_time(server, script, by_receiver=True)
    assert leg.outcome is LegOutcome.STOPPED
    assert "no believable fix" in leg.detail


def test_a_link_that_is_lost_stops_the_leg_and_the_next_is_walked_when_it_is_back(atlas):
    async def script(vehicle):
        async def lose():
            await asyncio.sleep(1.0)
            server.server.is_dumb = True

        losing = asyncio.create_task(lose())
        lost = await vehicle.go_to(Pose(80.0, 50.0))
        await losing
        async with asyncio.timeout(60.0):
            while server.walker.mode is not Mode.STAND:
                await asyncio.sleep(0.02)
        with pytest.raises(PartError, match="nothing was heard"):
            await vehicle.go_to(Pose(80.0, 50.0))
        server.server.is_dumb = False
        return lost, await vehicle.go_to(Pose(vehicle.pose.x_m, vehicle.pose.y_m, 0.0, 1.0))

    with served(atlas, lockstep=False, silence_s=1.0, start=EAST) as server:
        lost, later = on_real_time(server, script, lost_s=1.0)
    assert lost.outcome is LegOutcome.STOPPED
    assert "the link is lost" in lost.detail
    assert later.outcome is LegOutcome.ARRIVED


def test_only_connected_it_looks_as_it_lies_and_does_not_walk(atlas):
    """For a dry run: whatever it is asked, it stays as it is; `start` then has it get up."""
    with served(atlas) as server:
        clock, walker = VirtualClock(), server.walker
        for _ in range(60):
            walker.obey(HighCommand(Mode.LIE_DOWN))
            walker.tick()
        vehicle = Go1Vehicle(GO1, clock=clock, host="127.0.0.1", port=server.port, home=HOME)

        async def script():
            await vehicle.connect()
            (view,) = await vehicle.look([math.pi])
            with pytest.raises(PartError, match="not started"):
                await vehicle.go_to(Pose(55.0, 50.0))
            was_up = walker.is_upright
            await vehicle.start()
            stands = walker.is_upright
            await vehicle.close()
            return view, was_up, stands

        view, was_up, stands = clock.run(script())
        assert (was_up, stands) == (False, True)
        assert view.pose.heading_rad == pytest.approx(HOME.heading_rad)
        assert walker.body.true_pose.distance_to_m(HOME.x_m, HOME.y_m) < 0.01
