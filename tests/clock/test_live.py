"""Live calls: tiny but real waits, and what mission time makes of them."""

import asyncio
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Awaitable, Callable, Coroutine

import pytest

from reasoned_explorer.clock import Clock, MixedClock, RealClock, VirtualClock
from reasoned_explorer.clock.live_thread import run_live
from reasoned_explorer.model import PartError, SettingsError
from reasoned_explorer.model.stopping import listening

BOTH = pytest.mark.parametrize("clock", [MixedClock(), RealClock()], ids=["mixed", "real"])


def _waiting(real_s: float, answer: str = "") -> Callable[[], Coroutine[None, None, str]]:
    async def call() -> str:
        await asyncio.sleep(real_s)
        return answer

    return call


@BOTH
def test_a_live_call_returns_its_answer_and_the_seconds_that_it_took(clock: Clock) -> None:
    async def mission() -> tuple[str, float, float]:
        answer, seconds = await clock.live(_waiting(0.02, "a tree"))
        return answer, seconds, clock.now_s()

    answer, seconds, ended_s = clock.run(mission())
    assert answer == "a tree"
    assert seconds >= 0.019
    assert ended_s >= seconds if clock.name == "real" else ended_s == pytest.approx(seconds, abs=1e-12)


def test_calls_at_the_same_time_overlap_and_end_in_the_order_of_their_seconds() -> None:
    clock = MixedClock()
    ended: list[tuple[str, float, float]] = []

    async def one(name: str, real_s: float) -> None:
        _, seconds = await clock.live(_waiting(real_s))
        ended.append((name, seconds, clock.now_s()))

    async def mission() -> float:
        await clock.act(100.0)
        await asyncio.gather(one("long", 0.06), one("short", 0.01), one("middle", 0.03))
        return clock.now_s()

    ended_s = clock.run(mission())
    assert {name for name, _, _ in ended} == {"short", "middle", "long"}
    assert [seconds for _, seconds, _ in ended] == sorted(seconds for _, seconds, _ in ended)
    for _, seconds, at_s in ended:
        assert at_s == pytest.approx(100.0 + seconds, abs=1e-9)
    assert ended_s == pytest.approx(100.0 + max(seconds for _, seconds, _ in ended), abs=1e-9)


def test_what_this_program_computes_meanwhile_does_not_count() -> None:
    clock = MixedClock()

    async def mission() -> tuple[float, float]:
        began_s = time.monotonic()
        _, seconds = await clock.live(_waiting(0.01))
        sum(index for index in range(3_000_000))
        await clock.act(5.0)
        sum(index for index in range(3_000_000))
        assert time.monotonic() - began_s > seconds
        return seconds, clock.now_s()

    seconds, ended_s = clock.run(mission())
    assert ended_s == pytest.approx(seconds + 5.0, abs=1e-9)


def test_what_is_due_while_a_call_is_out_happens_in_the_order_of_its_time() -> None:
    clock = MixedClock()
    happened: list[str] = []

    async def jump(seconds: float) -> None:
        await clock.act(seconds)
        happened.append(f"{seconds:g} s jumped")

    async def call() -> None:
        await clock.live(_waiting(0.05))
        happened.append("called")

    async def mission() -> None:
        await asyncio.gather(jump(1000.0), call(), jump(0.002), jump(0.04))

    clock.run(mission())
    assert happened == ["0.002 s jumped", "0.04 s jumped", "called", "1000 s jumped"]


def _times(clock: Clock, ask: Callable[[int, float], Awaitable[float]]) -> list[tuple[int, float]]:
    """Run chains of calls with jumps between them and among them; return what ended when."""
    seen: list[tuple[int, float]] = []

    async def chain(number: int) -> None:
        for turn in range(4):
            await ask(number * 10 + turn, 0.001 + 0.003 * ((number * 7 + turn * 5) % 4))
            seen.append((number * 10 + turn, clock.now_s()))
            await clock.act(0.002 * ((number + turn) % 3))
            seen.append((-number * 10 - turn, clock.now_s()))

    async def mission() -> None:
        await asyncio.gather(*(chain(number) for number in range(8)))

    clock.run(mission())
    return seen


@pytest.mark.parametrize("again", [MixedClock, VirtualClock])
def test_the_same_seconds_replayed_make_the_same_times_in_the_same_order_bit_for_bit(
    again: Callable[[], Clock],
) -> None:
    took: dict[int, float] = {}
    clock, replay = MixedClock(), again()

    async def live(number: int, real_s: float) -> float:
        _, took[number] = await clock.live(_waiting(real_s))
        return took[number]

    async def replayed(number: int, _: float) -> float:
        await replay.think(took[number])
        return took[number]

    first = _times(clock, live)
    assert len(took) == 32
    assert _times(replay, replayed) == first


@BOTH
def test_cancelling_who_waits_cancels_the_call_itself(clock: Clock) -> None:
    told = threading.Event()

    async def endless() -> None:
        try:
            await asyncio.sleep(3600.0)
        except asyncio.CancelledError:
            told.set()
            raise

    async def mission() -> float:
        waiting = asyncio.ensure_future(clock.live(endless))
        await clock.live(_waiting(0.01))
        waiting.cancel()
        with pytest.raises(asyncio.CancelledError):
            await waiting
        ended_s = clock.now_s()
        await clock.act(0.001)
        return ended_s

    assert 0.009 <= clock.run(mission()) < 60.0
    assert told.wait(10.0)


def test_a_time_out_on_the_mission_s_clock_ends_a_call() -> None:
    clock = MixedClock()

    async def mission() -> float:
        with pytest.raises(TimeoutError):
            async with asyncio.timeout(0.02):
                await clock.live(_waiting(3600.0))
        return clock.now_s()

    assert clock.run(mission()) == pytest.approx(0.02, abs=1e-9)


@BOTH
def test_the_error_of_a_call_comes_out_as_it_is_and_when_the_call_ended(clock: Clock) -> None:
    async def broken() -> None:
        await asyncio.sleep(0.01)
        raise ConnectionResetError("gone")

    async def mission() -> float:
        with pytest.raises(ConnectionResetError, match="gone"):
            await clock.live(broken)
        return clock.now_s()

    assert clock.run(mission()) >= 0.009


@BOTH
def test_a_call_that_cancels_itself_does_not_look_like_the_end_of_the_mission(clock: Clock) -> None:
    async def confused() -> None:
        raise asyncio.CancelledError

    async def mission() -> str:
        with pytest.raises(PartError, match="cancelled from inside"):
            await clock.live(confused)
        return "goes on"

    assert clock.run(mission()) == "goes on"


def test_all_calls_of_the_process_run_in_one_loop_that_lives_on() -> None:
    async def which() -> int:
        return id(asyncio.get_running_loop())

    async def ask(clock: Clock) -> int:
        return (await clock.live(which))[0]

    clocks: list[Clock] = [MixedClock(), RealClock(), MixedClock()]
    assert len({clock.run(ask(clock)) for clock in clocks} | {run_live(which)}) == 1


def test_nothing_real_can_be_asked_on_a_virtual_clock() -> None:
    clock = VirtualClock()
    with pytest.raises(SettingsError, match="mixed or a real clock"):
        clock.run(clock.live(_waiting(0.0)))


@BOTH
def test_a_person_stops_a_mission_that_waits_for_a_call(clock: Clock) -> None:
    stopper = threading.Timer(0.05, os.kill, (os.getpid(), signal.SIGINT))

    async def mission() -> None:
        stopper.start()
        await clock.live(_waiting(3600.0))

    with listening(), pytest.raises(KeyboardInterrupt):
        clock.run(mission())
    stopper.join()


def test_a_person_stops_what_is_tried_outside_a_mission() -> None:
    stopper = threading.Timer(0.05, os.kill, (os.getpid(), signal.SIGINT))

    async def endless() -> None:
        stopper.start()
        await asyncio.sleep(3600.0)

    with listening(), pytest.raises(KeyboardInterrupt):
        run_live(endless)
    stopper.join()


def _python(*arguments: str) -> "subprocess.CompletedProcess[str]":
    return subprocess.run([sys.executable, *arguments], check=False, capture_output=True, text=True, timeout=60)


def test_a_process_ends_though_a_call_is_still_out() -> None:
    program = """
import asyncio, sys
from reasoned_explorer.clock.live_thread import Stopwatch, begin_live
async def endless():
    try:
        await asyncio.sleep(3600)
    finally:
        print("tidied up", flush=True)
async def now():
    return 1
begin_live(endless, Stopwatch())
begin_live(now, Stopwatch()).result()
"""
    done = _python("-X", "dev", "-c", program)
    assert (done.returncode, done.stdout, done.stderr) == (0, "tidied up\n", "")


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork")
def test_a_forked_process_has_a_live_loop_of_its_own() -> None:
    program = """
import os, sys
from reasoned_explorer.clock.live_thread import run_live
async def pid():
    return os.getpid()
assert run_live(pid) == os.getpid()
child = os.fork()
if child == 0:
    os._exit(0 if run_live(pid) == os.getpid() else 1)
sys.exit(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
"""
    done = _python("-c", program)
    assert done.returncode == 0, done.stderr
