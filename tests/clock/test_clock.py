import asyncio
import os
import signal

import pytest

from reasoned_explorer.clock import Clock, MixedClock, RealClock, VirtualClock
from reasoned_explorer.model.stopping import listening


async def _two_calls_at_once(clock: Clock) -> float:
    await asyncio.gather(clock.think(300.0), clock.think(500.0))
    return clock.now_s()


@pytest.mark.parametrize("clock", [VirtualClock(), MixedClock()], ids=["virtual", "mixed"])
def test_calls_that_start_together_end_with_the_slowest(clock: Clock) -> None:
    assert clock.run(_two_calls_at_once(clock)) == pytest.approx(500.0, abs=0.5)


def test_virtual_time_is_exact_and_starts_at_zero() -> None:
    clock = VirtualClock()

    async def mission() -> list[float]:
        times = [clock.now_s()]
        await clock.act(12.5)
        times.append(clock.now_s())
        await clock.think(1700.25)
        return [*times, clock.now_s()]

    assert clock.run(mission()) == [0.0, 12.5, 1712.75]


def test_things_happen_in_the_order_of_their_times() -> None:
    clock = VirtualClock()
    happened: list[str] = []

    async def after(seconds: float, name: str) -> None:
        await clock.think(seconds)
        happened.append(name)

    async def mission() -> None:
        await asyncio.gather(after(3.0, "c"), after(1.0, "a"), after(2.0, "b"))

    clock.run(mission())
    assert happened == ["a", "b", "c"]


def test_time_outs_work_in_virtual_time() -> None:
    clock = VirtualClock()

    async def mission() -> float:
        with pytest.raises(TimeoutError):
            async with asyncio.timeout(10.0):
                await clock.think(1000.0)
        return clock.now_s()

    assert clock.run(mission()) == pytest.approx(10.0)


def test_mixed_time_jumps_over_what_is_simulated_or_modelled_exactly() -> None:
    clock = MixedClock()

    async def mission() -> list[float]:
        await clock.act(600.0)
        times = [clock.now_s()]
        await clock.think(0.25)
        return [*times, clock.now_s()]

    assert clock.run(mission()) == [600.0, 600.25]


def test_real_time_is_lived_through() -> None:
    clock = RealClock()

    async def mission() -> float:
        await clock.act(0.03)
        return clock.now_s()

    assert clock.run(mission()) >= 0.029


@pytest.mark.parametrize("clock", [VirtualClock(), MixedClock(), RealClock()], ids=["virtual", "mixed", "real"])
def test_a_mission_that_is_to_stop_is_cancelled_where_it_waits(clock: Clock) -> None:
    done: list[str] = []

    async def mission() -> None:
        try:
            os.kill(os.getpid(), signal.SIGINT)
            done.append("what it was at")
            await clock.act(3600.0)
            await clock.think(3600.0)
            await asyncio.sleep(0.0)
            done.append("more")
        finally:
            done.append("tidied up")

    with listening(), pytest.raises(KeyboardInterrupt):
        clock.run(mission())
    assert done == ["what it was at", "tidied up"]


def test_a_request_that_came_before_the_mission_stops_it_as_well() -> None:
    clock = VirtualClock()
    with listening():
        os.kill(os.getpid(), signal.SIGINT)
        with pytest.raises(KeyboardInterrupt):
            clock.run(clock.act(1.0))
