"""Virtual time in pieces."""

import asyncio

import pytest

from reasoned_explorer.clock import SteppedClock
from reasoned_explorer.model import SettingsError


async def _act(clock: SteppedClock, *seconds: float) -> float:
    for duration_s in seconds:
        await clock.act(duration_s)
    return clock.now_s()


def test_time_goes_on_from_one_run_to_the_next() -> None:
    clock = SteppedClock()
    assert clock.now_s() == 0.0
    assert clock.run(_act(clock, 1.5, 2.0)) == 3.5
    assert clock.run(_act(clock, 1.0)) == 4.5
    clock.run(clock.think(0.5))
    assert clock.now_s() == 5.0


def test_it_works_where_an_event_loop_runs_already() -> None:
    """As in a notebook."""

    async def cell() -> float:
        clock = SteppedClock()
        return clock.run(_act(clock, 2.0))

    assert asyncio.run(cell()) == 2.0


def test_what_is_real_is_refused() -> None:
    clock = SteppedClock()
    with pytest.raises(SettingsError, match="something real is waited for"):
        clock.run(asyncio.sleep(0))

    async def call() -> int:
        return 1

    with pytest.raises(SettingsError, match="a model is to be called"):
        clock.run(clock.live(call))


def test_errors_come_out_as_they_are() -> None:
    clock = SteppedClock()

    async def fail() -> None:
        await clock.act(1.0)
        raise ValueError("broken")

    with pytest.raises(ValueError, match="broken"):
        clock.run(fail())
    assert clock.now_s() == 1.0
