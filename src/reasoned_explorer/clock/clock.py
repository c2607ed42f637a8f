"""Mission time.

The agent awaits its parts and asks a `Clock` for the time; what a second is depends on the clock. *Acting* (`act`) is
what a simulated body does; *thinking* (`think`) is what a modelled mind needs; *live* calls (`live`) are real. On a
real clock all are lived through, on a virtual one acting and thinking jump and nothing is live, on a mixed one acting
and thinking jump and live calls take the seconds that they take.
"""

import asyncio
import time
from collections.abc import Callable, Coroutine
from typing import Any, Protocol, TypeVar, cast

from reasoned_explorer.clock.live_thread import Stopwatch, begin_live
from reasoned_explorer.clock.mixed_loop import MixedEventLoop
from reasoned_explorer.clock.virtual_loop import VirtualEventLoop
from reasoned_explorer.model.errors import Fault, SettingsError
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

    async def live(self, call: Callable[[], Coroutine[Any, Any, T]]) -> tuple[T, float]:
        """Run a real call and let its seconds pass, be it alone or among others that run at the same time.

        Args:
            call: Makes the coroutine; it runs in the process's one live loop (`clock.live_thread`), whatever the clock,
                so that a client made there can be used by all missions. Cancelling the task that awaits cancels it.

        Returns:
            What the call returns, and the seconds that it is charged, more than 0; its errors come out as they are.

        Raises:
            SettingsError: If nothing real can happen on this clock.
        """

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

    async def live(self, call: Callable[[], Coroutine[Any, Any, T]]) -> tuple[T, float]:  # noqa: ARG002 - the protocol's
        """Refuse: how long a real call takes cannot be jumped over.

        Raises:
            SettingsError: Always.
        """
        fault = Fault(
            "a model is to be called while the clock is virtual",
            "a mixed or a real clock",
            "choose --clock mixed, or replay the calls from a tape",
        )
        raise SettingsError("clock", [fault])

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

    async def live(self, call: Callable[[], Coroutine[Any, Any, T]]) -> tuple[T, float]:
        """Wait for a real call."""
        watch = Stopwatch()
        return await asyncio.wrap_future(begin_live(call, watch)), watch.took_s

    def run(self, mission: Coroutine[Any, Any, T]) -> T:
        """Run a mission in real time."""
        self._start_s = time.monotonic()
        with asyncio.Runner() as runner:
            return _run(runner, mission)


class MixedClock:
    """Live calls take the real seconds that they take; what is simulated, modelled or replayed jumps.

    Nothing else that is real counts: neither this program's own computing nor waiting for anything but live calls. Time
    is therefore decided by what is charged alone, and a mission whose live calls are replayed with the same seconds
    (`think`) is the same mission. Things happen in the order of their times, whether they jump or are live.
    """

    name = "mixed"

    def __init__(self) -> None:
        self._start_s = 0.0
        self._loop: MixedEventLoop | None = None

    def now_s(self) -> float:
        """Return the mission time, seconds: when the last thing that happened was due."""
        return 0.0 if self._loop is None else self._loop.time() - self._start_s

    async def act(self, duration_s: float) -> None:
        """Jump over the seconds that a simulated body needs."""
        await asyncio.sleep(max(0.0, duration_s))

    async def think(self, duration_s: float) -> None:
        """Jump over the seconds that a call is charged."""
        await asyncio.sleep(max(0.0, duration_s))

    async def live(self, call: Callable[[], Coroutine[Any, Any, T]]) -> tuple[T, float]:
        """Let as many seconds pass as a real call takes."""
        if self._loop is None:
            raise AssertionError
        return await self._loop.live(call)

    def run(self, mission: Coroutine[Any, Any, T]) -> T:
        """Run a mission in mixed time."""
        with asyncio.Runner(loop_factory=MixedEventLoop) as runner:
            self._loop = cast("MixedEventLoop", runner.get_loop())
            self._start_s = self._loop.time()
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
