"""The driver over a real socket, against the served simulator and against links that break."""

import asyncio
import math
import signal
from dataclasses import replace

import numpy as np
import pytest

from reasoned_explorer.clock import RealClock, SteppedClock, VirtualClock
from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import LegOutcome, PartError, SettingsError
from reasoned_explorer.model.stopping import listening
from reasoned_explorer.serving.airsim.server import AS_FAST_AS_ASKED, AirSimServer
from reasoned_explorer.serving.background import BackgroundServer
from reasoned_explorer.vehicles import PROFILES
from reasoned_explorer.vehicles.airsim.settings import DriverSettings
from reasoned_explorer.vehicles.airsim.vehicle import AirSimVehicle
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.world import Building
from tests.world.worlds import box, field

pytest.importorskip("msgpack")

HOME = Pose(50.0, 50.0)
DRONE = PROFILES["drone"]
#: Without pictures, and patient: a busy machine is no lost link.
BLIND = DriverSettings(pictures=False, deadline_s=60.0)


@pytest.fixture(scope="module")
def atlas():
    """A meadow with a house in the north."""
    return Atlas(field(("tree", 70.0, 50.0), buildings=[Building(box(40.0, 70.0, 60.0, 80.0), 8.0)]))


@pytest.fixture
def served(atlas):
    with BackgroundServer(lambda: AirSimServer(atlas, HOME, speed=AS_FAST_AS_ASKED)) as server:
        yield server


def flown(served, script, *, clock=None, settings=BLIND, profile=DRONE, **more):
    """Run a script with a vehicle that has taken off, and land it."""
    clock = clock or VirtualClock()

    async def run():
        vehicle = AirSimVehicle(profile, clock=clock, port=served.port, home=HOME, settings=settings, **more)
        async with vehicle:
            return await script(vehicle)

    return clock.run(run())


def drone_of(served):
    simulator = served.server.simulator
    return simulator.drone, simulator.now_s


def test_it_rises_to_its_cameras_height_and_lands_in_the_end(served):
    async def script(vehicle):
        return vehicle.pose

    pose = flown(served, script)
    assert (pose.x_m, pose.y_m, pose.z_m) == pytest.approx((50.0, 50.0, 1.5), abs=0.01)
    drone, now_s = drone_of(served)
    assert drone.is_landed(now_s)
    assert not served.server.simulator.is_armed
    assert not served.server.simulator.timeline.is_held


def test_a_leg_says_what_was_really_flown(served):
    async def script(vehicle):
        return await vehicle.go_to(Pose(58.0, 50.0, 0.0, math.pi)), vehicle.pose

    leg, pose = flown(served, script)
    assert leg.outcome is LegOutcome.ARRIVED
    assert leg.length_m == pytest.approx(8.0, abs=0.4)
    assert (leg.track[0].x_m, leg.track[-1].x_m) == pytest.approx((50.0, 58.0), abs=0.3)
    assert leg.track[-1].t_s - leg.track[0].t_s == pytest.approx(leg.duration_s)
    assert leg.duration_s > 8.0 / DRONE.speed_mps
    assert pose.heading_rad == pytest.approx(math.pi, abs=0.1)
    assert all(point.z_m == pytest.approx(1.5) for point in leg.track)


def test_mission_time_is_the_simulators_time(served):
    clock = VirtualClock()

    async def script(vehicle):
        begun_s = clock.now_s()
        leg = await vehicle.go_to(Pose(54.0, 50.0))
        flown_s = clock.now_s() - begun_s
        await clock.think(25.0)
        await vehicle.look([0.0])
        return flown_s, leg.duration_s, clock.now_s(), drone_of(served)[1]

    flown_s, duration_s, mission_s, server_s = flown(served, script, clock=clock)
    assert flown_s == pytest.approx(duration_s)
    assert server_s == pytest.approx(mission_s, abs=1e-6)


def test_what_stands_in_the_way_ends_the_leg(served):
    async def script(vehicle):
        return await vehicle.go_to(Pose(50.0, 75.0)), vehicle.pose

    leg, pose = flown(served, script)
    assert (leg.outcome, leg.detail) == (LegOutcome.COLLISION, "building_0")
    assert pose.y_m < 70.0
    assert leg.length_m == pytest.approx(19.6, abs=0.6)


def test_a_collision_before_the_leg_does_not_count(served):
    async def script(vehicle):
        await vehicle.go_to(Pose(50.0, 75.0))
        return await vehicle.go_to(Pose(50.0, 60.0))

    assert flown(served, script).outcome is LegOutcome.ARRIVED


def test_views_come_from_the_cameras_that_look_there(served):
    seen = []

    async def script(vehicle):
        ahead = vehicle.pose.heading_rad
        return await vehicle.look([ahead - math.pi / 4, ahead, ahead + math.pi / 4])

    views = flown(served, script, content=lambda pose, camera: seen.append((pose, camera)) or len(seen))
    assert [view.key for view in views] == [(0, 0, 0), (0, 0, 1), (0, 0, 2)]
    assert [view.pose.heading_rad for view in views] == pytest.approx([1.75 * math.pi, 0.0, 0.25 * math.pi], abs=0.01)
    assert [view.content for view in views] == [1, 2, 3]
    assert [pose.heading_rad for pose, _ in seen] == pytest.approx([1.75 * math.pi, 0.0, 0.25 * math.pi], abs=0.01)
    assert all(camera == DRONE.camera for _, camera in seen)


def test_where_no_camera_looks_the_vehicle_turns(served):
    async def script(vehicle):
        views = await vehicle.look([math.pi])
        return views[0].pose, vehicle.pose

    view, body = flown(served, script)
    assert view.heading_rad == pytest.approx(math.pi, abs=0.1)
    assert body.heading_rad == pytest.approx(math.pi, abs=0.1)


def test_or_a_camera_is_aimed_there(served):
    async def script(vehicle):
        views = await vehicle.look([math.pi, 0.0])
        return views, vehicle.pose

    views, body = flown(served, script, settings=replace(BLIND, aims=True), content=lambda pose, _: pose)
    assert [view.content.heading_rad for view in views] == pytest.approx([math.pi, 0.0], abs=0.01)
    assert body.heading_rad == pytest.approx(0.0, abs=0.1)


def test_pictures_are_taken_where_they_are_wanted(served):
    async def script(vehicle):
        return await vehicle.look([0.0, math.pi / 4])

    views = flown(served, script, settings=DriverSettings(deadline_s=300.0))
    assert [view.image.shape for view in views] == [(224, 224, 3)] * 2
    assert not np.array_equal(views[0].image, views[1].image)


def test_it_waits_as_long_as_its_profile_settles(served):
    async def there(vehicle):
        return await vehicle.go_to(Pose(52.0, 50.0))

    async def back(vehicle):
        return await vehicle.go_to(HOME)

    short = flown(served, there, settings=replace(BLIND, settle_s=0.0))
    long = flown(served, back, settings=replace(BLIND, settle_s=7.0))
    assert long.duration_s - short.duration_s == pytest.approx(7.0, abs=1.0)


def test_it_also_flies_where_no_loop_runs(served):
    async def script(vehicle):
        return await vehicle.go_to(Pose(52.0, 50.0))

    assert flown(served, script, clock=SteppedClock()).outcome is LegOutcome.ARRIVED


def test_on_a_real_clock_everything_is_lived_through(atlas):
    async def script(vehicle):
        return await vehicle.go_to(Pose(55.0, 50.0))

    with BackgroundServer(lambda: AirSimServer(atlas, HOME, speed=20.0)) as served:
        leg = flown(served, script, clock=RealClock(), settings=replace(BLIND, poll_s=0.05))
    assert leg.outcome is LegOutcome.ARRIVED


def test_cancelled_on_the_way_it_hovers(served):
    clock = VirtualClock()

    async def script(vehicle):
        going = asyncio.ensure_future(vehicle.go_to(Pose(30.0, 50.0)))
        await clock.think(3.0)
        going.cancel()
        with pytest.raises(asyncio.CancelledError):
            await going
        here = vehicle.pose
        await clock.think(10.0)
        await vehicle.look([0.0])
        return vehicle.last_leg, here, vehicle.pose

    leg, here, later = flown(served, script, clock=clock)
    assert (leg.outcome, leg.detail) == (LegOutcome.STOPPED, "cancelled")
    assert 1.0 < leg.length_m < 15.0
    assert (later.x_m, later.y_m) == pytest.approx((here.x_m, here.y_m), abs=0.1)


def test_a_person_who_stops_it_on_the_way_has_it_land(served):
    clock = VirtualClock()

    async def script(vehicle):
        asyncio.get_running_loop().call_later(2.0, signal.raise_signal, signal.SIGINT)
        await vehicle.go_to(Pose(30.0, 50.0))

    with listening(), pytest.raises(KeyboardInterrupt):
        flown(served, script, clock=clock)
    drone, now_s = drone_of(served)
    assert 35.0 < drone.state(now_s).x_m < 49.0
    assert drone.is_landed(now_s)


def test_targets_and_headings_that_are_none_are_refused(served):
    async def script(vehicle):
        with pytest.raises(SettingsError, match="finite"):
            await vehicle.go_to(Pose(math.nan, 0.0))
        with pytest.raises(SettingsError, match="finite"):
            await vehicle.look([math.inf])

    flown(served, script)


def test_a_lost_link_is_a_fault_of_the_part(served):
    async def script(vehicle):
        served.stop()
        with pytest.raises(PartError, match="link"):
            await vehicle.look([0.0])
        with pytest.raises(PartError, match="link"):
            await vehicle.go_to(Pose(55.0, 50.0))

    with pytest.raises(PartError, match="link"):  # and so is landing: the vehicle may still fly
        flown(served, script)


def test_nobody_there_is_a_fault_of_the_part(atlas):
    vehicle = AirSimVehicle(DRONE, clock=VirtualClock(), port=9, settings=replace(BLIND, deadline_s=1.0))
    with pytest.raises(PartError, match=r"no link to 127\.0\.0\.1:9"):
        VirtualClock().run(vehicle.start())


class FakeStill:
    """A simulator whose flights never come to their end, and whose drone does not move."""

    def __init__(self, served):
        table = served.server._rpc._methods
        self.asked = []

        def never(*arguments):
            self.asked.append(arguments)
            return asyncio.get_running_loop().create_future()

        table["moveToPosition"] = never


def test_a_vehicle_that_does_not_move_is_stuck(served):
    still = FakeStill(served)

    async def script(vehicle):
        return await vehicle.go_to(Pose(60.0, 50.0))

    leg = flown(served, script)
    assert (leg.outcome, leg.detail) == (LegOutcome.STUCK, "no progress")
    assert leg.duration_s == pytest.approx(BLIND.stuck_s, abs=0.5)
    assert still.asked[0][:3] == pytest.approx((0.0, 10.0, -1.5))


def test_a_vehicle_that_is_there_has_arrived_whatever_the_simulator_says(served):
    FakeStill(served)

    async def script(vehicle):
        return await vehicle.go_to(Pose(50.3, 50.0))

    leg = flown(served, script)
    assert leg.outcome is LegOutcome.ARRIVED


def test_settings_that_are_out_of_range_are_told_at_once():
    with pytest.raises(SettingsError, match="4 faults"):
        DriverSettings(cameras=(), poll_s=0.0, settle_s=-1.0, deadline_s=math.nan)


def test_a_server_that_answers_steps_at_once_is_waited_for(served):
    table = served.server._rpc._methods
    table["simContinueForTime"] = lambda seconds: table["kept"](seconds) and None
    table["kept"] = served.server.simulator.timeline.go_on_for
    held, asked = served.server.simulator.timeline, []

    def is_held():
        asked.append(held.is_held)
        return len(asked) % 3 == 0  # only the third time

    table["simIsPaused"] = is_held

    async def script(vehicle):
        return await vehicle.go_to(Pose(51.0, 50.0))

    assert flown(served, script).outcome is LegOutcome.ARRIVED
    assert len(asked) > 30


def test_a_thought_that_was_longer_than_landing_may_take_is_not_counted_as_landing(atlas):
    async def think_for_minutes(vehicle):
        await asyncio.sleep(0.5)

    with BackgroundServer(lambda: AirSimServer(atlas, HOME, speed=200.0)) as served:
        flown(served, think_for_minutes, clock=RealClock(), settings=replace(BLIND, poll_s=0.05))
        drone, now_s = drone_of(served)
        assert drone.is_landed(now_s)
