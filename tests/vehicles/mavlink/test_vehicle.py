"""The driver over real sockets, against the served autopilot and against links and autopilots that leave."""

import asyncio
import math
import socket
from dataclasses import replace

import pytest

from reasoned_explorer.clock import RealClock, VirtualClock
from reasoned_explorer.geometry import GeoOrigin, Pose
from reasoned_explorer.model import LegOutcome, PartError, SettingsError
from reasoned_explorer.serving.background import BackgroundServer
from reasoned_explorer.serving.mavlink.server import AS_FAST_AS_ASKED, MavlinkServer
from reasoned_explorer.vehicles import PROFILES
from reasoned_explorer.vehicles.mavlink.settings import DriverSettings
from reasoned_explorer.vehicles.mavlink.vehicle import MavlinkVehicle
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.world import Building
from tests.world.worlds import box, field

pytest.importorskip("pymavlink")

HOME = Pose(50.0, 50.0)
#: Patient: a busy machine is no lost link.
SETTINGS = DriverSettings(arms=True, lost_s=300.0, reply_s=100.0)
FLAVOURS = ("arducopter", "px4", "ardurover", "px4-rover")


@pytest.fixture(scope="module")
def atlas():
    """A meadow with a house in the north."""
    return Atlas(field(("tree", 70.0, 50.0), buildings=[Building(box(40.0, 70.0, 60.0, 80.0), 8.0)]))


def profile_of(flavour):
    return PROFILES["go1" if "rover" in flavour else "drone"]


def serve(atlas, flavour="arducopter", **more):
    return BackgroundServer(lambda: MavlinkServer(atlas, HOME, flavour=flavour, **more))


def flown(served, script, *, clock=None, settings=SETTINGS, flavour="arducopter", wire="udpout", **more):
    """Run a script with a vehicle that has started, and close it."""
    clock = clock or VirtualClock()

    async def run():
        vehicle = MavlinkVehicle(
            profile_of(flavour),
            clock=clock,
            address=f"{wire}:127.0.0.1:{served.port}",
            home=HOME,
            settings=settings,
            **more,
        )
        async with vehicle:
            return await script(vehicle)

    return clock.run(run())


def within(served, act):
    """Do something in the server's own thread."""

    async def inside():
        return act(served.server)

    return asyncio.run_coroutine_threadsafe(inside(), served._loop).result()


# On a clock that jumps: the simulator is held and stepped.


@pytest.mark.parametrize("flavour", FLAVOURS)
@pytest.mark.parametrize("wire", ["udp", "tcp"])
def test_it_starts_goes_looks_and_ends_safe(atlas, flavour, wire):
    async def script(vehicle):
        leg = await vehicle.go_to(Pose(58.0, 50.0, 0.0, math.pi))
        views = await vehicle.look([math.pi, 0.0])
        return leg, views, vehicle.pose, (vehicle.battery, vehicle.position_quality, vehicle.mode)

    with serve(atlas, flavour, wire=wire, speed=AS_FAST_AS_ASKED) as served:
        to = "udpout" if wire == "udp" else "tcp"
        leg, views, pose, (battery, quality, mode) = flown(served, script, flavour=flavour, wire=to)
        pilot = served.server.pilot
        assert pilot.is_landed
        assert not pilot.is_armed
        assert not pilot.timeline.is_held
    assert (leg.outcome, leg.detail) == (LegOutcome.ARRIVED, "")
    assert leg.length_m == pytest.approx(8.0, abs=0.5)
    assert leg.duration_s > 8.0 / profile_of(flavour).speed_mps
    assert (pose.x_m, pose.y_m) == pytest.approx((58.0, 50.0), abs=0.6)
    assert [view.key for view in views] == [(1, 0, 0), (1, 0, 1)]
    assert [view.pose.heading_rad for view in views] == pytest.approx([math.pi, 0.0], abs=0.15)
    assert mode in {"GUIDED", "OFFBOARD"}
    assert 0.0 < battery.remaining <= 1.0
    assert battery.voltage_v > 10.0
    assert quality.fix_type == 6
    assert quality.filter_is_good


def test_mission_time_is_the_simulators_time(atlas):
    clock = VirtualClock()

    async def script(vehicle):
        begun_s = clock.now_s()
        leg = await vehicle.go_to(Pose(54.0, 50.0))
        flown_s = clock.now_s() - begun_s
        await clock.think(25.0)
        await vehicle.look([0.0])
        return flown_s, leg.duration_s, clock.now_s(), served.server.pilot.now_s

    with serve(atlas, speed=AS_FAST_AS_ASKED) as served:
        flown_s, duration_s, mission_s, server_s = flown(served, script, clock=clock)
    assert flown_s == pytest.approx(duration_s)
    assert server_s == pytest.approx(mission_s, abs=1e-6)


@pytest.mark.parametrize("flavour", ["arducopter", "ardurover"])
def test_an_ardupilot_gives_up_velocities_soon_while_it_is_driven(atlas, flavour):
    async def script(vehicle):
        return served.server.pilot.parameters["GUID_TIMEOUT"].value

    with serve(atlas, flavour, speed=AS_FAST_AS_ASKED) as served:
        assert flown(served, script, flavour=flavour) == 0.5
        assert served.server.pilot.parameters["GUID_TIMEOUT"].value == 3.0


def test_one_that_has_no_such_parameter_is_told_positions(atlas):
    def older():
        server = MavlinkServer(atlas, HOME, flavour="ardurover", speed=AS_FAST_AS_ASKED)
        parameters = server.pilot.parameters
        parameters.names = tuple(name for name in parameters.names if name != "GUID_TIMEOUT")
        del parameters._all["GUID_TIMEOUT"]
        return server

    async def script(vehicle):
        return await vehicle.go_to(Pose(53.0, 50.0))

    with BackgroundServer(older) as served:
        leg = flown(served, script, flavour="ardurover", settings=replace(SETTINGS, reply_s=1.0))
    assert leg.outcome is LegOutcome.ARRIVED


def test_what_stands_in_the_way_ends_the_leg_and_the_next_one_goes_on(atlas):
    async def script(vehicle):
        return await vehicle.go_to(Pose(50.0, 75.0)), await vehicle.go_to(Pose(50.0, 60.0)), vehicle.pose

    with serve(atlas, speed=AS_FAST_AS_ASKED) as served:
        hit, back, pose = flown(served, script)
    assert (hit.outcome, hit.detail) == (LegOutcome.COLLISION, "building_0")
    assert hit.length_m == pytest.approx(19.6, abs=0.6)
    assert back.outcome is LegOutcome.ARRIVED
    assert pose.y_m == pytest.approx(60.0, abs=0.6)


def test_content_is_of_where_the_camera_really_is(atlas):
    async def script(vehicle):
        return await vehicle.look([0.0, math.pi / 2])

    with serve(atlas, speed=AS_FAST_AS_ASKED) as served:
        views = flown(served, script, content=lambda pose, camera: (pose, camera))
    assert [view.content[0].heading_rad for view in views] == pytest.approx([0.0, math.pi / 2])
    assert all(view.content[1] == PROFILES["drone"].camera for view in views)


def test_positions_and_targets_may_be_on_earth(atlas):
    origin = GeoOrigin(48.0, 11.0)
    somewhere = Atlas(replace(atlas.world, origin=origin))

    async def script(vehicle):
        leg = await vehicle.go_to(Pose(56.0, 53.0))
        return leg, vehicle.pose

    with serve(somewhere, speed=AS_FAST_AS_ASKED) as served:
        leg, pose = flown(served, script, settings=replace(SETTINGS, origin=origin))
    assert leg.outcome is LegOutcome.ARRIVED
    assert (pose.x_m, pose.y_m) == pytest.approx((56.0, 53.0), abs=0.5)


def test_it_listens_as_a_ground_station_does(atlas):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]

    async def run():
        vehicle = MavlinkVehicle(
            PROFILES["drone"], clock=clock, address=f"udpin:127.0.0.1:{port}", home=HOME, settings=SETTINGS
        )
        async with vehicle:
            return await vehicle.go_to(Pose(53.0, 50.0))

    clock = VirtualClock()
    with serve(atlas, station=("127.0.0.1", port), speed=AS_FAST_AS_ASKED):
        assert clock.run(run()).outcome is LegOutcome.ARRIVED


# On a real clock.


@pytest.mark.parametrize("flavour", ["arducopter", "px4", "ardurover"])
def test_on_a_real_clock_everything_is_lived_through(atlas, flavour):
    async def script(vehicle):
        leg = await vehicle.go_to(Pose(53.0, 50.0, 0.0, math.pi / 2))
        return leg, vehicle.pose

    with serve(atlas, flavour, speed=10.0) as served:
        within(served, lambda server: server.warm_up())
        leg, pose = flown(
            served, script, clock=RealClock(), flavour=flavour, settings=replace(SETTINGS, poll_s=0.05, rate_hz=40.0)
        )
    assert leg.outcome is LegOutcome.ARRIVED
    assert (pose.x_m, pose.y_m) == pytest.approx((53.0, 50.0), abs=0.6)


LIVED = replace(SETTINGS, poll_s=0.05, rate_hz=40.0, lands=False)


@pytest.mark.parametrize("mode", ["RTL", "LAND", "LOITER"])
def test_a_pilot_or_a_failsafe_that_takes_over_is_not_fought(atlas, mode):
    async def script(vehicle):
        going = asyncio.ensure_future(vehicle.go_to(Pose(20.0, 50.0)))
        await asyncio.sleep(0.5)
        within(served, lambda server: server.pilot.change_mode(mode))
        leg = await going
        with pytest.raises(PartError, match=f"changed to {mode}"):
            await vehicle.go_to(HOME)
        with pytest.raises(PartError, match=f"changed to {mode}"):
            await vehicle.look([0.0])
        await asyncio.sleep(1.5)  # more than a second: the time of a setpoint
        return leg, vehicle.mode

    with serve(atlas, speed=1.0) as served:
        within(served, lambda server: server.warm_up())
        leg, now = flown(served, script, clock=RealClock(), settings=LIVED)
    assert leg.outcome is LegOutcome.STOPPED
    assert mode in leg.detail
    assert now == mode


def test_motors_that_somebody_switches_off_end_the_leg(atlas):
    async def script(vehicle):
        going = asyncio.ensure_future(vehicle.go_to(Pose(20.0, 50.0)))
        await asyncio.sleep(0.5)
        within(served, lambda server: server.pilot.disarm(forced=True))
        return await going

    with serve(atlas, speed=1.0) as served:
        within(served, lambda server: server.warm_up())
        leg = flown(served, script, clock=RealClock(), settings=LIVED)
    assert (leg.outcome, leg.detail) == (LegOutcome.STOPPED, "the motors were switched off")


def test_a_lost_link_ends_the_leg_and_setpoints(atlas):
    kept = []

    async def script(vehicle):
        kept.append(vehicle)
        going = asyncio.ensure_future(vehicle.go_to(Pose(20.0, 50.0)))
        await asyncio.sleep(0.5)
        await asyncio.to_thread(served.stop)
        with pytest.raises(PartError, match="is lost"):
            await going
        with pytest.raises(PartError, match="is lost"):
            await vehicle.look([0.0])

    with serve(atlas, speed=1.0) as served:
        within(served, lambda server: server.warm_up())
        with pytest.raises(PartError, match="is lost"):  # so is closing: it may still fly
            flown(served, script, clock=RealClock(), settings=replace(LIVED, lost_s=3.0))
    assert kept[0].last_leg.outcome is LegOutcome.STOPPED
    assert "no heartbeat" in kept[0].last_leg.detail


def test_cancelled_on_the_way_it_stands(atlas):
    async def script(vehicle):
        going = asyncio.ensure_future(vehicle.go_to(Pose(20.0, 50.0)))
        await asyncio.sleep(1.0)
        going.cancel()
        with pytest.raises(asyncio.CancelledError):
            await going
        await asyncio.sleep(0.3)
        return vehicle.last_leg, served.server.pilot.is_busy

    with serve(atlas, speed=2.0) as served:
        within(served, lambda server: server.warm_up())
        leg, is_busy = flown(served, script, clock=RealClock(), settings=LIVED)
    assert (leg.outcome, leg.detail) == (LegOutcome.STOPPED, "cancelled")
    assert 0.5 < leg.length_m < 20.0
    assert not is_busy


# What does not come about.


def test_motors_are_not_switched_on_unasked(atlas):
    async def script(vehicle):
        raise AssertionError(vehicle)

    with serve(atlas) as served:
        with pytest.raises(PartError, match="nobody switches the motors on"):
            flown(served, script, clock=RealClock(), settings=DriverSettings(ready_s=1.5))
        assert not served.server.pilot.is_armed


def test_nobody_there_is_a_fault_of_the_part():
    clock = RealClock()
    settings = DriverSettings(arms=True, ready_s=0.5)
    for address, match in (("udpout:127.0.0.1:9", "no autopilot is heard"), ("tcp:127.0.0.1:9", "no link to tcp")):
        vehicle = MavlinkVehicle(PROFILES["drone"], clock=clock, address=address, settings=settings)
        with pytest.raises(PartError, match=match):
            clock.run(vehicle.start())
        clock.run(vehicle.close())


def test_a_walkers_profile_does_not_fly(atlas):
    async def run():
        vehicle = MavlinkVehicle(
            PROFILES["go1"], clock=RealClock(), address=f"udpout:127.0.0.1:{served.port}", settings=SETTINGS
        )
        with pytest.raises(PartError, match="machine flies"):
            await vehicle.start()
        await vehicle.close()

    with serve(atlas) as served:
        asyncio.run(run())


def test_commands_before_the_start_are_refused():
    vehicle = MavlinkVehicle(PROFILES["drone"], clock=RealClock())
    with pytest.raises(PartError, match="not started"):
        asyncio.run(vehicle.go_to(HOME))
    with pytest.raises(SettingsError, match="finite"):
        asyncio.run(vehicle.go_to(Pose(math.nan, 0.0)))


def test_settings_that_are_out_of_range_are_told_at_once():
    with pytest.raises(SettingsError, match="5 faults"):
        DriverSettings(system=0, poll_s=0.0, settle_s=-1.0, lost_s=math.nan, stream_hz=0.0)
