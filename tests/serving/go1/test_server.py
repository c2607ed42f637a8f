"""The served Go1 on real sockets, and what it makes of packets that are none."""

import asyncio
import math
import socket
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reasoned_explorer.clock import RealClock
from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import SettingsError, StartError
from reasoned_explorer.serving.go1.server import Go1Server
from reasoned_explorer.serving.go1.walker import Walker
from reasoned_explorer.simulation.motion import TICK_S
from reasoned_explorer.vehicles import PROFILES
from reasoned_explorer.vehicles.unitree import (
    Gait,
    Go1Link,
    HighCommand,
    LinkSettings,
    Mode,
    decode_state,
    encode_command,
    encode_state,
)
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.world import Building
from tests.world.worlds import box, field

HOME = Pose(50.0, 50.0)
ATLAS = Atlas(field(buildings=[Building(box(40.0, 70.0, 60.0, 80.0), 8.0)]))
NOBODY = ("127.0.0.1", 9)


def walker(**more: Any) -> Walker:
    return Walker(ATLAS, PROFILES["go1"], HOME, **more)


def told(robot: Walker, command: HighCommand, ticks: int) -> None:
    robot.obey(command)
    for _ in range(ticks):
        robot.tick()


def test_it_walks_and_turns_as_it_is_told_and_says_so():
    robot = walker()
    told(robot, HighCommand.walking(forward_mps=0.5), 60)
    assert robot.body.true_pose.y_m > 50.9
    state = robot.state()
    assert (state.mode, state.gait) == (Mode.WALK, Gait.TROT)
    assert state.forward_mps == pytest.approx(0.5, abs=0.1)
    told(robot, HighCommand.walking(forward_mps=0.0, turn_radps=0.5), 40)
    state = robot.state()
    assert state.turn_radps == pytest.approx(0.5, abs=0.01)
    assert state.yaw_rate_left_radps == pytest.approx(-0.5, abs=0.01)
    assert state.imu.rpy_rad[2] == pytest.approx(-robot.body.true_pose.heading_rad, abs=1e-6)


def test_told_to_stand_it_comes_to_rest():
    robot = walker()
    told(robot, HighCommand.walking(forward_mps=0.5), 40)
    told(robot, HighCommand.standing(), 10)
    there = robot.body.true_pose
    told(robot, HighCommand.standing(), 10)
    assert robot.body.true_pose == there
    assert robot.state().mode == Mode.STAND


def test_its_legs_know_where_it_is():
    robot = walker()
    for command in (
        HighCommand.walking(forward_mps=0.6, turn_radps=0.3),
        HighCommand.walking(forward_mps=0.4, right_mps=0.1, turn_radps=-0.5),
        HighCommand.standing(),
    ):
        told(robot, command, 50)
    true, state = robot.body.true_pose, robot.state()
    # Facing north at the start: ahead is north, left is west.
    assert (true.y_m - 50.0, 50.0 - true.x_m) == pytest.approx(state.odometry_m[:2], abs=1e-3)


def test_lying_or_soft_it_does_not_walk_until_it_has_got_up():
    robot = walker()
    for mode in (Mode.LIE_DOWN, Mode.DAMPING):
        told(robot, HighCommand(mode), 60)
        assert robot.state().mode == mode
        told(robot, HighCommand.walking(forward_mps=0.5), 40)
        assert (robot.body.true_pose.x_m, robot.body.true_pose.y_m) == (50.0, 50.0)
        told(robot, HighCommand(Mode.GET_UP), 60)
        assert robot.is_upright


def test_a_wall_stops_it():
    robot = walker()
    told(robot, HighCommand.walking(forward_mps=1.0), 800)
    assert robot.body.true_pose.y_m == pytest.approx(70.0 - PROFILES["go1"].radius_m, abs=0.1)
    assert robot.body.touched is not None or robot.state().forward_mps < 0.1


def test_it_does_not_start_where_it_cannot_stand():
    with pytest.raises(StartError, match="inside a building"):
        Walker(ATLAS, PROFILES["go1"], Pose(50.0, 75.0))


@given(packets=st.lists(st.binary(max_size=200), min_size=1, max_size=8))
@settings(max_examples=40, deadline=None)
def test_what_is_no_command_is_counted_and_moves_nothing(packets):
    for lockstep in (True, False):
        server = Go1Server(walker(), lockstep=lockstep)
        for packet in packets:
            server.datagram_received(packet, NOBODY)
        assert (server.malformed, server.commands, server.walker.ticks) == (len(packets), 0, 0)


@given(place=st.integers(0, 128), bit=st.integers(0, 7))
@settings(max_examples=60, deadline=None)
def test_a_command_with_a_wrong_bit_moves_nothing(place, bit):
    packet = bytearray(encode_command(HighCommand.walking(forward_mps=0.5)))
    packet[place] ^= 1 << bit
    if place == 124:
        return  # the one byte that the checksum does not cover is reserved
    server = Go1Server(walker(), lockstep=True)
    server.datagram_received(bytes(packet), NOBODY)
    assert (server.malformed, server.walker.ticks) == (1, 0)


@given(
    steps=st.lists(
        st.tuples(
            st.sampled_from(list(Mode)),
            st.floats(-1e6, 1e6, width=32),
            st.floats(-1e6, 1e6, width=32),
            st.floats(-1e6, 1e6, width=32),
        ),
        max_size=12,
    )
)
@settings(max_examples=30, deadline=None)
def test_whatever_is_commanded_it_stays_in_its_world_and_can_say_where_it_is(steps):
    robot = walker(noise="rtk-fixed")
    bounds = ATLAS.world.bounds
    for mode, forward, left, turn in steps:
        told(robot, HighCommand(mode, forward_mps=forward, left_mps=left, yaw_rate_left_radps=turn), 3)
        state = decode_state(encode_state(robot.state()))
        assert state.mode in set(Mode)
        assert bounds.contains(robot.body.true_pose.x_m, robot.body.true_pose.y_m)


def test_in_lockstep_a_command_that_is_said_again_is_not_carried_out_again():
    async def run():
        server = Go1Server(walker(), lockstep=True)
        port = await server.start()
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as ours:
            ours.setblocking(False)
            ours.connect(("127.0.0.1", port))
            loop = asyncio.get_running_loop()
            answers = []
            for number in (1, 1, 2):
                ours.send(encode_command(HighCommand(Mode.WALK, Gait.TROT, forward_mps=0.5, reserve=number)))
                answers.append(await asyncio.wait_for(loop.sock_recv(ours, 4096), 60.0))
        await server.close()
        await server.close()
        return answers, server.walker.ticks

    answers, ticks = asyncio.run(run())
    assert answers[0] == answers[1] != answers[2]
    assert [decode_state(answer).reserve for answer in answers] == [1, 1, 2]
    assert ticks == 2


def test_on_real_time_it_stands_when_commands_stop_coming():
    clock = RealClock()

    async def run():
        server = Go1Server(walker(), silence_s=0.3)
        port = await server.start()
        link = Go1Link("127.0.0.1", port, now_s=clock.now_s, settings=LinkSettings(local_port=0, lost_after_s=30.0))
        async with link, asyncio.timeout(60.0):
            await link.wait_for_state(30.0)
            while link.state is None or link.state.forward_mps < 0.2:
                link.command(HighCommand.walking(forward_mps=0.5))
                await asyncio.sleep(0.02)
            # The program dies: it says nothing any more, not even that it leaves.
            link._sender.cancel()
            while link.state is None or link.state.mode != Mode.STAND:
                await asyncio.sleep(0.02)
        await server.close()

    clock.run(run())


def test_bad_settings_are_told_at_once():
    with pytest.raises(SettingsError) as caught:
        Go1Server(walker(), rate_hz=0.0, silence_s=math.nan)
    assert len(caught.value.faults) == 2


def test_the_vendors_library_walks_it():
    pytest.importorskip("unitree_legged_sdk", reason="the vendor's library unitree_legged_sdk is not installed")
    try:
        from unitree_legged_sdk import robot_interface as sdk
    except ImportError as error:  # another processor or Python
        pytest.skip(f"the vendor's library does not load here: {error}")

    async def run():
        server = Go1Server(walker(), lockstep=True)
        port = await server.start()
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
            free.bind(("127.0.0.1", 0))
            local_port = free.getsockname()[1]
        udp = sdk.UDP(0xEE, local_port, "127.0.0.1", port)
        command, state = sdk.HighCmd(), sdk.HighState()
        udp.InitCmdData(command)
        command.mode, command.gaitType, command.velocity, command.yawSpeed = 2, 1, [0.5, 0.0], 0.0
        for number in range(1, 41):
            command.reserve = number
            udp.SetSend(command)
            udp.Send()
            async with asyncio.timeout(60.0):
                while server.commands < number:
                    await asyncio.sleep(0.001)
        await asyncio.sleep(0.05)
        udp.Recv()
        udp.GetRecv(state)
        await server.close()
        return list(state.velocity), state.mode, server.walker

    velocity, mode, robot = asyncio.run(run())
    assert robot.time_s == pytest.approx(40 * TICK_S)
    assert robot.body.true_pose.y_m > 50.5
    assert mode == Mode.WALK
    assert velocity[0] == pytest.approx(0.5, abs=0.1)
