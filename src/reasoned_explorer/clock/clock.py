"""Mission time.

The agent awaits its parts and asks a `Clock` for the time; what a second is depends on the clock. *Acting* (`act`) is
what a simulated body does; *thinking* (`think`) is what a modelled mind needs. On a real clock both are lived through,
on a virtual one both jump, on a mixed one acting jumps and real model calls take the seconds that they take.
"""

import asyncio
import time
from collections.abc import Coroutine
from typing import Any, Protocol, TypeVar

from reasoned_explorer.clock.virtual_loop import VirtualEventLoop
from reasoned_explorer.model.stopping import on_stop, stop_if_asked

T = TypeVar("T")


class Clock(Protocol):
    """Mission time in seconds, from 0 at the start of `run`."""

    name: str

    def now_s(self) -> float:
        """Return the mission time, seconds."""

    async def act(self, duration_s: float) -> None:
        """Let the seconds pass that a simulated body needs to do something."""

    async def think(self, duration_s: float) -> None:
        """Let the seconds pass that a modelled, cached or replayed call is charged."""

    def run(self, mission: Coroutine[Any, Any, T]) -> T:
        """Run a mission from its start to its end on this clock and return what it returns.

        Raises:
            KeyboardInterrupt: If a person asks to stop; the mission is cancelled where it waits.
        """


class VirtualClock:
    """The clock jumps to the next thing that happens; nothing waits and nothing real may be awaited.

    Two calls that start together and take 3 and 5 seconds end at 3 and 5: the event loop's own time is virtual, so
    time-outs and cancellation work as on a real clock.
    """

    name = "virtual"

    def __init__(self) -> None:
        self._start_s = 0.0
        self._loop: asyncio.AbstractEventLoop | None = None

    def now_s(self) -> float:
        """Return the mission time, seconds."""
        return 0.0 if self._loop is None else self._loop.time() - self._start_s

    async def act(self, duration_s: float) -> None:
        """Jump over the seconds that a simulated body needs."""
        await asyncio.sleep(max(0.0, duration_s))

    async def think(self, duration_s: float) -> None:
        """Jump over the seconds that a modelled call takes."""
        await asyncio.sleep(max(0.0, duration_s))

    def run(self, mission: Coroutine[Any, Any, T]) -> T:
        """Run a mission in virtual time."""
        with asyncio.Runner(loop_factory=VirtualEventLoop) as runner:
            self._loop = runner.get_loop()
            self._start_s = self._loop.time()
            return _run(runner, mission)


class RealClock:
    """Every second is lived through."""

    name = "real"

    def __init__(self) -> None:
        self._start_s = time.monotonic()

    def now_s(self) -> float:
        """Return the mission time, seconds."""
        return time.monotonic() - self._start_s

    async def act(self, duration_s: float) -> None:
        """Wait while a simulated body acts."""
        await asyncio.sleep(max(0.0, duration_s))

    async def think(self, duration_s: float) -> None:
        """Wait as long as a modelled call takes."""
        await asyncio.sleep(max(0.0, duration_s))

    def run(self, mission: Coroutine[Any, Any, T]) -> T:
        """Run a mission in real time."""
        self._start_s = time.monotonic()
        with asyncio.Runner() as runner:
            return _run(runner, mission)


class MixedClock:
    """Real calls take their real seconds; what is simulated, modelled or replayed jumps.

    Jumps that start together end with the longest, not with their sum: each sets the time to no less than its own end.
    """

    name = "mixed"

    def __init__(self) -> None:
        self._start_s = time.monotonic()
        self._jumped_s = 0.0

    def now_s(self) -> float:
        """Return the mission time, seconds: real seconds since the start and all that was jumped over."""
        return time.monotonic() - self._start_s + self._jumped_s

    async def act(self, duration_s: float) -> None:
        """Jump over the seconds that a simulated body needs."""
        await self._jump(duration_s)

    async def think(self, duration_s: float) -> None:
        """Jump over the seconds that a call is charged."""
        await self._jump(duration_s)

    async def _jump(self, duration_s: float) -> None:
        end_s = self.now_s() + max(0.0, duration_s)
        await asyncio.sleep(0)  # what started together reads the clock before it jumps
        self._jumped_s += max(0.0, end_s - self.now_s())

    def run(self, mission: Coroutine[Any, Any, T]) -> T:
        """Run a mission in mixed time."""
        self._start_s, self._jumped_s = time.monotonic(), 0.0
        with asyncio.Runner() as runner:
            return _run(runner, mission)


def _run(runner: asyncio.Runner, mission: Coroutine[Any, Any, T]) -> T:
    """Run a mission; a request to stop cancels it, which is safe since it takes effect where the mission awaits."""

    async def stoppable() -> T:
        task, loop = asyncio.current_task(), asyncio.get_running_loop()
        if task is None:
            raise AssertionError
        with on_stop(lambda: loop.call_soon_threadsafe(task.cancel)):
            return await mission

    try:
        return runner.run(stoppable())
    except asyncio.CancelledError:
        stop_if_asked()
        raise
