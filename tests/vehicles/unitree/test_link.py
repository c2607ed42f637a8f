import asyncio
import math
from collections.abc import Awaitable, Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.clock import RealClock
from reasoned_explorer.model import PartError, SettingsError
from reasoned_explorer.vehicles.unitree import (
    Go1Link,
    HighCommand,
    HighState,
    LinkSettings,
    Mode,
    encode_state,
)
from tests.vehicles.unitree.fake_go1 import FakeGo1

QUICK = LinkSettings(rate_hz=200.0, local_port=0)


def with_robot(test: Callable[[Go1Link, FakeGo1], Awaitable[None]], settings: LinkSettings = QUICK) -> None:
    clock = RealClock()

    async def run() -> None:
        async with FakeGo1() as robot, Go1Link("127.0.0.1", robot.port, now_s=clock.now_s, settings=settings) as link:
            await test(link, robot)

    clock.run(run())


async def until(holds: Callable[[], bool]) -> None:
    async with asyncio.timeout(10.0):
        while not holds():
            await asyncio.sleep(0.005)


def test_it_begins_by_standing_and_hears_the_robot():
    async def test(link: Go1Link, robot: FakeGo1) -> None:
        state = await link.wait_for_state(10.0)
        assert state.mode == Mode.STAND
        assert {command.mode for command in robot.commands} == {Mode.STAND}
        assert link.fresh_state(max_age_s=10.0) == state

    with_robot(test)


def test_the_robot_walks_as_it_is_told_for_as_long_as_it_is_told():
    async def test(link: Go1Link, robot: FakeGo1) -> None:
        await link.wait_for_state(10.0)
        for _ in range(20):
            sent = link.command(HighCommand.walking(forward_mps=0.5, turn_radps=0.4))
            await link.wait_for_state(10.0)
        assert sent.forward_mps == 0.5
        assert link.state is not None
        assert link.state.forward_mps == pytest.approx(0.5)
        assert link.state.turn_radps == pytest.approx(0.4)

    with_robot(test, LinkSettings(rate_hz=200.0, local_port=0, command_lifetime_s=60.0, lost_after_s=60.0))


def test_a_command_comes_back_as_it_is_really_sent():
    async def test(link: Go1Link, robot: FakeGo1) -> None:
        await link.wait_for_state(10.0)
        sent = link.command(HighCommand.walking(forward_mps=50.0))
        assert sent.forward_mps == link.limits.forward_mps
        await until(lambda: robot.commands[-1].mode == Mode.WALK)
        assert robot.commands[-1].forward_mps == pytest.approx(sent.forward_mps)

    with_robot(test, LinkSettings(rate_hz=200.0, local_port=0, command_lifetime_s=60.0, lost_after_s=60.0))


def test_an_owner_that_falls_silent_leaves_a_robot_that_stands():
    async def test(link: Go1Link, robot: FakeGo1) -> None:
        await link.wait_for_state(10.0)
        link.command(HighCommand.walking(forward_mps=0.5))
        await until(lambda: link.counts.expired == 1)
        told = len(robot.commands)
        await until(lambda: len(robot.commands) > told + 3)
        assert robot.commands[-1].mode == Mode.STAND

    with_robot(test, LinkSettings(rate_hz=200.0, local_port=0, command_lifetime_s=0.05, lost_after_s=60.0))


def test_a_robot_that_is_not_heard_is_not_kept_walking():
    async def test(link: Go1Link, robot: FakeGo1) -> None:
        await link.wait_for_state(10.0)
        robot.is_dumb = True

        def walk_on() -> bool:
            link.command(HighCommand.walking(forward_mps=0.5))
            return link.counts.silenced > 0 and robot.commands[-1].mode == Mode.STAND

        await until(walk_on)
        with pytest.raises(PartError, match="nothing was heard for"):
            link.fresh_state(max_age_s=0.01)

    with_robot(test, LinkSettings(rate_hz=200.0, local_port=0, command_lifetime_s=60.0, lost_after_s=0.05))


def test_damping_does_not_run_out():
    async def test(link: Go1Link, robot: FakeGo1) -> None:
        await link.wait_for_state(10.0)
        link.command(HighCommand.damping())
        await until(lambda: robot.commands[-1].mode == Mode.DAMPING)
        told = len(robot.commands)
        await until(lambda: len(robot.commands) > told + 30)
        assert robot.commands[-1].mode == Mode.DAMPING

    with_robot(test, LinkSettings(rate_hz=200.0, local_port=0, command_lifetime_s=0.01, lost_after_s=60.0))


def test_packets_that_are_none_are_counted_and_passed_over():
    good = encode_state(HighState(velocity_mps=(0.25, 0.0, 0.0)))
    spoilt = bytes([good[0], good[1], good[2], good[3] ^ 1, *good[4:]])

    async def test(link: Go1Link, robot: FakeGo1) -> None:
        robot.answers_with = [b"", b"hello", good[:-1], spoilt, good]
        await until(lambda: link.counts.malformed >= 4 and "checksum" in link.last_fault)
        await until(lambda: link.state is not None and link.state.forward_mps == 0.25)

    with_robot(test)


GOOD = encode_state(HighState(mode=Mode.STAND))


@st.composite
def spoilt(draw: st.DrawFn) -> bytes:
    """Return a state with some bytes changed, cut off or put on."""
    packet = bytearray(GOOD)
    for place in draw(st.lists(st.integers(0, len(GOOD) - 1), max_size=6)):
        packet[place] ^= draw(st.integers(1, 255))
    return bytes(packet[: draw(st.integers(0, len(GOOD)))]) + draw(st.binary(max_size=8))


@given(st.lists(st.one_of(st.binary(max_size=1200), spoilt()), max_size=20))
def test_whatever_comes_in_nothing_breaks_and_nothing_walks(packets: list[bytes]):
    link = Go1Link("127.0.0.1", 9, now_s=lambda: 0.0)
    for packet in packets:
        link.datagram_received(packet, None)
    assert link.counts.received + link.counts.malformed == len(packets)
    assert link.counts.received == packets.count(GOOD)
    assert link.state is None or link.state.mode == Mode.STAND
    assert not link._command.moves


def test_nobody_there_is_told_in_words():
    clock = RealClock()

    async def run() -> None:
        robot = FakeGo1()
        await robot.start()
        port = robot.port
        robot.close()
        await asyncio.sleep(0)
        async with Go1Link("127.0.0.1", port, now_s=clock.now_s, settings=QUICK) as link:
            assert link.state_age_s == math.inf
            with pytest.raises(PartError, match="no state from"):
                await link.wait_for_state(0.1)
            with pytest.raises(PartError, match="nothing was ever heard"):
                link.fresh_state(max_age_s=1.0)

    clock.run(run())


def test_closing_says_that_the_robot_is_to_stand_and_may_be_done_twice():
    async def test(link: Go1Link, robot: FakeGo1) -> None:
        await link.wait_for_state(10.0)
        link.command(HighCommand.walking(forward_mps=0.5))
        await until(lambda: robot.commands[-1].mode == Mode.WALK)
        await link.close()
        await link.close()
        await until(lambda: robot.commands[-1].mode == Mode.STAND)

    with_robot(test, LinkSettings(rate_hz=200.0, local_port=0, command_lifetime_s=60.0, lost_after_s=60.0))


def test_an_address_that_cannot_be_used_is_a_fault_of_the_link():
    clock = RealClock()

    async def run() -> None:
        with pytest.raises(PartError, match="no link to"):
            await Go1Link("not an address", 1, now_s=clock.now_s, settings=QUICK).start()

    clock.run(run())


def test_all_bad_settings_are_told_at_once():
    with pytest.raises(SettingsError) as caught:
        LinkSettings(rate_hz=5.0, command_lifetime_s=0.0, lost_after_s=math.nan, local_port=-1)
    assert len(caught.value.faults) == 4
