"""The served autopilot itself: what it obeys and refuses, its failsafes, and whatever else may come over the wire."""

import asyncio
import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import SettingsError, UnknownNameError
from reasoned_explorer.serving.mavlink.pilot import ACCEPTED, DENIED, FAILED, REJECTED_NOW, Target
from reasoned_explorer.serving.mavlink.server import AS_FAST_AS_ASKED, MavlinkServer
from reasoned_explorer.vehicles import PROFILES
from reasoned_explorer.vehicles.mavlink.approach import Approach
from reasoned_explorer.vehicles.mavlink.dialect import Packer, Parser, dialect
from reasoned_explorer.world.atlas import Atlas
from tests.vehicles.mavlink.test_wire import framed
from tests.world.worlds import field

pytest.importorskip("pymavlink")

HOME = Pose(50.0, 50.0)


@pytest.fixture(scope="module")
def atlas():
    return Atlas(field(("tree", 70.0, 50.0)))


def with_pilot(atlas, script, flavour="arducopter", **more):
    """Run a script with an autopilot whose links are judged by a clock of ours."""

    async def run():
        server = MavlinkServer(atlas, HOME, flavour=flavour, **more)
        pilot = server.pilot
        now = [100.0]
        said = []
        pilot._real_s = lambda: now[0]
        pilot._say = lambda severity, text: said.append(text)
        pilot.timeline.hold()
        return await script(pilot, now, said)

    return asyncio.run(run())


async def airborne(pilot):
    pilot.change_mode("GUIDED")
    pilot.arm()
    pilot.take_off(2.0)
    await pilot.timeline.go_on_for(10.0)


def test_it_takes_off_only_armed_and_guided(atlas):
    async def script(pilot, now, said):
        answers = [pilot.take_off(2.0)]
        pilot.change_mode("GUIDED")
        answers.append(pilot.take_off(2.0))
        pilot.arm()
        answers += [pilot.take_off(-1.0), pilot.take_off(2.0)]
        await pilot.timeline.go_on_for(10.0)
        return answers, pilot.belief().z_m, pilot.disarm()

    answers, z_m, disarmed = with_pilot(atlas, script, speed=AS_FAST_AS_ASKED)
    assert answers == [FAILED, FAILED, DENIED, ACCEPTED]
    assert z_m == 2.0
    assert disarmed == FAILED  # it flies


def test_setpoints_count_only_in_the_guided_mode(atlas):
    async def script(pilot, now, said):
        await airborne(pilot)
        pilot.change_mode("LOITER")
        heeded = [pilot.go(Target(60.0, 50.0, 2.0))]
        pilot.change_mode("GUIDED")
        heeded.append(pilot.go(Target(60.0, 50.0, 2.0)))
        return heeded

    assert with_pilot(atlas, script, speed=AS_FAST_AS_ASKED) == [False, True]


def test_a_velocity_that_is_not_said_anew_is_given_up(atlas):
    async def script(pilot, now, said):
        await airborne(pilot)
        assert pilot.parameters["GUID_TIMEOUT"].value == 3.0
        pilot.parameters.set("GUID_TIMEOUT", 0.5)
        heeded, begun_s = [], pilot.now_s
        for _ in range(10):
            heeded.append(pilot.go_at(3.0, 0.0, 0.0))
            await pilot.timeline.go_on_for(0.1)
        going = pilot.is_busy
        await pilot.timeline.go_on_for(2.0)
        return heeded, going, pilot.is_busy, pilot.rests_since_s - begun_s, pilot.belief()

    heeded, going, later, stood_s, here = with_pilot(atlas, script, speed=AS_FAST_AS_ASKED)
    assert all(heeded)
    assert (going, later) == (True, False)
    assert stood_s == pytest.approx(0.9 + 0.5)
    assert here.x_m > 51.0
    assert here.y_m == pytest.approx(50.0, abs=0.5)  # it sways


def placed(pilot):
    here = pilot.belief()
    return Pose(here.x_m, here.y_m, here.z_m, here.heading_rad)


def test_led_by_velocities_it_flies_as_if_it_had_been_told_its_target(atlas):
    target = Target(64.0, 50.0, 2.0)

    async def told(pilot, now, said):
        await airborne(pilot)
        pilot.go(target)
        await pilot.timeline.go_on_for(20.0)
        return pilot.rests_since_s, pilot.belief()

    async def led(pilot, now, said):
        await airborne(pilot)
        pilot.parameters.set("GUID_TIMEOUT", 0.5)
        approach = Approach(placed(pilot), Pose(*target[:3]), PROFILES["drone"])
        while (setpoint := approach.setpoint(placed(pilot))) is not None:
            north_mps, east_mps, down_mps = setpoint.velocity_mps
            pilot.go_at(east_mps, north_mps, -down_mps)
            await pilot.timeline.go_on_for(0.1)
        pilot.go(target)
        await pilot.timeline.go_on_for(20.0)
        return pilot.rests_since_s, pilot.belief()

    more = {"speed": AS_FAST_AS_ASKED, "noise": "rtk-fixed", "seed": 3}
    (told_s, there), (led_s, here) = with_pilot(atlas, told, **more), with_pilot(atlas, led, **more)
    assert led_s == pytest.approx(told_s)
    assert here == pytest.approx(there)


def test_px4_is_not_served_velocities(atlas):
    async def script(pilot, now, said):
        return pilot.go_at(1.0, 0.0, 0.0)

    assert not with_pilot(atlas, script, flavour="px4", speed=AS_FAST_AS_ASKED)


def test_the_same_setpoint_again_changes_nothing(atlas):
    async def script(pilot, now, said):
        await airborne(pilot)
        pilot.go(Target(60.0, 50.0, 2.0))
        ends_s = pilot.motion_ends_s
        await pilot.timeline.go_on_for(1.0)
        pilot.go(Target(60.0, 50.0, 2.0))
        assert pilot.motion_ends_s == ends_s
        pilot.go(Target())
        return pilot.is_busy, pilot.belief().x_m

    is_busy, x_m = with_pilot(atlas, script, speed=AS_FAST_AS_ASKED)
    assert not is_busy
    assert 50.0 < x_m < 58.0


def test_it_comes_home_and_lands_where_the_ground_station_is_lost(atlas):
    async def script(pilot, now, said):
        await airborne(pilot)
        pilot.go(Target(60.0, 50.0, 2.0))
        await pilot.timeline.go_on_for(30.0)
        pilot.timeline.let_go()
        pilot.hear_station()
        now[0] += 4.0
        pilot.watch_links()
        before = pilot.mode
        now[0] += 2.0
        pilot.watch_links()
        pilot.timeline.hold()
        after = pilot.mode
        await pilot.timeline.go_on_for(60.0)
        return before, after, said, pilot.belief(), pilot.is_armed

    before, after, said, here, is_armed = with_pilot(atlas, script, speed=1000.0)
    assert (before, after) == ("GUIDED", "RTL")
    assert "GCS Failsafe" in said
    assert (here.x_m, here.y_m, here.z_m) == pytest.approx((50.0, 50.0, 0.0), abs=0.6)
    assert not is_armed


def test_px4_takes_offboard_only_with_setpoints_and_leaves_it_without(atlas):
    async def script(pilot, now, said):
        pilot.arm()
        answers = [pilot.change_mode("OFFBOARD")]
        pilot.go(Target())
        answers.append(pilot.change_mode("OFFBOARD"))
        pilot.timeline.let_go()
        now[0] += 0.9
        pilot.watch_links()
        modes = [pilot.mode]
        now[0] += 0.2
        pilot.watch_links()
        return answers, [*modes, pilot.mode]

    answers, modes = with_pilot(atlas, script, "px4")
    assert answers == [REJECTED_NOW, ACCEPTED]
    assert modes == ["OFFBOARD", "LOITER"]


def test_settings_that_make_no_sense_are_told(atlas):
    async def script():
        with pytest.raises(UnknownNameError, match="arducopter"):
            MavlinkServer(atlas, HOME, flavour="arducoptre")
        with pytest.raises(SettingsError, match="2 faults"):
            MavlinkServer(atlas, HOME, profile=PROFILES["go1"], system=0)

    asyncio.run(script())


# Whatever comes.

TAKEN = [
    "HEARTBEAT",
    "COMMAND_LONG",
    "COMMAND_INT",
    "SET_MODE",
    "SET_POSITION_TARGET_LOCAL_NED",
    "SET_POSITION_TARGET_GLOBAL_INT",
    "PARAM_REQUEST_LIST",
    "PARAM_REQUEST_READ",
    "PARAM_SET",
    "MISSION_REQUEST_LIST",
    "MISSION_CLEAR_ALL",
    "REQUEST_DATA_STREAM",
    "PING",
    "TIMESYNC",
    "TUNNEL",
]


@given(st.data())
@settings(max_examples=60, deadline=None)
def test_no_message_breaks_it_and_what_it_says_can_be_sent(atlas, data):
    mavlink = dialect()

    async def run():
        server = MavlinkServer(atlas, HOME, speed=AS_FAST_AS_ASKED)
        sent = []
        server._send = lambda key, peer, packed: sent.append(packed)
        server.pilot.change_mode("GUIDED")
        if data.draw(st.booleans()):
            server.pilot.arm()
        for _ in range(data.draw(st.integers(1, 4))):
            kind = getattr(mavlink, f"MAVLink_{data.draw(st.sampled_from(TAKEN)).lower()}_message")
            size = kind.unpacker.size
            server.take("somebody", framed(mavlink, kind, data.draw(st.binary(min_size=size, max_size=size))))
        for name in server.teller._makers:
            server._tell_all(server.teller.make(name))
        parser = Parser(datagrams=True)
        for packed in sent:
            assert len(parser.feed(packed)) == 1
        here = server.pilot.belief()
        assert all(math.isfinite(one) for one in here)
        await server.close()

    asyncio.run(run())


@given(st.lists(st.binary(max_size=300), max_size=5))
@settings(max_examples=60, deadline=None)
def test_bytes_that_are_no_messages_do_not_move_it(atlas, chunks):
    async def run():
        server = MavlinkServer(atlas, HOME)
        for chunk in chunks:
            server.take("somebody", chunk)
        assert not server.pilot.is_armed
        assert not server.pilot.is_busy
        here = server.pilot.belief()
        assert (here.x_m, here.y_m, here.z_m) == (50.0, 50.0, 0.0)

    asyncio.run(run())


def command(number, *parameters):
    mavlink = dialect()
    seven = (*parameters, *(0.0,) * (7 - len(parameters)))
    return Packer(255, 190).pack(mavlink.MAVLink_command_long_message(1, 1, number, 0, *seven))


@pytest.mark.parametrize(
    ("number", "parameters", "result"),
    [
        (400, (1.0,), ACCEPTED),
        (400, (7.0,), DENIED),
        (176, (1.0, 4.0), ACCEPTED),
        (176, (1.0, 99.0), DENIED),
        (176, (1.0, math.nan), DENIED),
        (178, (1.0, math.nan), DENIED),
        (22, (0.0,) * 6 + (math.nan,), FAILED),
        (511, (30.0, 20_000.0), ACCEPTED),
        (512, (242.0,), ACCEPTED),
        (31_000, (), 3),
    ],
)
def test_commands_are_answered(atlas, number, parameters, result):
    async def run():
        server = MavlinkServer(atlas, HOME)
        sent = []
        server._send = lambda key, peer, packed: sent.append(packed)
        server.take("somebody", command(number, *parameters))
        found = [one for packed in sent for one in Parser(datagrams=True).feed(packed)]
        return [one.result for one in found if one.get_type() == "COMMAND_ACK"]

    assert asyncio.run(run()) == [result]
