"""How a driver's time and the simulator's time go together.

On a real clock both are lived through. On a clock whose seconds jump, the simulator's time is held while the agent
thinks, and let go for as many seconds as passed on the mission's clock; what a flight takes on the simulator's time is
then charged to the mission's. So a mission over the wire is timed as one in the embedded simulator is, whatever the
wire, the pictures and the computing took.
"""

import asyncio
from collections.abc import Callable, Coroutine
from typing import Any, Protocol, TypeVar

from reasoned_explorer.clock import Clock
from reasoned_explorer.clock.live_thread import Stopwatch, begin_live
from reasoned_explorer.vehicles.airsim.api import AirSimApi
from reasoned_explorer.vehicles.airsim.rpc import Pending

T = TypeVar("T")
#: Stepped time goes on so far at once while something flies, seconds: flights end on such a tick.
_TICK_S = 0.05


class Pace(Protocol):
    """How time passes for a driver."""

    async def talk(self, call: Callable[[], Coroutine[Any, Any, T]]) -> T:
        """Talk to the simulator, in the process's live loop, and return what comes of it."""

    async def begin(self) -> None:
        """Take the simulator's time in hand."""

    async def end(self) -> None:
        """Let it go."""

    async def catch_up(self) -> None:
        """Have as much time passed in the simulator as on the mission's clock."""

    async def until(self, pending: Pending | None, seconds: float) -> None:
        """Let some seconds pass in the simulator, or less where a call is answered."""

    async def charge(self, elapsed_s: float) -> None:
        """Have passed on the mission's clock what has passed in the simulator since it was last told."""


class LivedPace:
    """Every second is lived through by both.

    Args:
        clock: The mission's, a real one.
        api: Of the simulator.
    """

    def __init__(self, clock: Clock, api: AirSimApi) -> None:
        self._clock, self._api = clock, api

    async def talk(self, call: Callable[[], Coroutine[Any, Any, T]]) -> T:
        """Talk, while other things go on here."""
        return await asyncio.wrap_future(begin_live(call, Stopwatch()))

    async def begin(self) -> None:
        """See that time is not held."""
        await self.talk(lambda: self._api.pause(paused=False))

    async def end(self) -> None:
        """Leave it as it is."""

    async def catch_up(self) -> None:
        """Nothing: time has passed."""

    async def until(self, pending: Pending | None, seconds: float) -> None:
        """Wait, at most until an answer comes."""
        if pending is None:
            await self._clock.act(seconds)
            return
        answer = pending.answer

        async def wait() -> None:
            await asyncio.wait({answer}, timeout=seconds)

        await self.talk(wait)

    async def charge(self, elapsed_s: float) -> None:
        """Nothing: it was lived through."""
        del elapsed_s


class SteppedPace:
    """The simulator is held but where the mission's clock, which jumps, says that time has passed.

    Talking stops everything else here: no time passes while it does.

    Args:
        clock: The mission's, a virtual or a mixed one.
        api: Of the simulator.
    """

    def __init__(self, clock: Clock, api: AirSimApi) -> None:
        self._clock, self._api = clock, api
        self._known_s = 0.0

    async def talk(self, call: Callable[[], Coroutine[Any, Any, T]]) -> T:
        """Talk, while nothing else goes on here."""
        # A request to stop cancels the mission where it next lets time pass; an answer has its deadline.
        return begin_live(call, Stopwatch()).result()

    async def begin(self) -> None:
        """Hold the simulator's time."""
        self._known_s = self._clock.now_s()
        await self.talk(lambda: self._api.pause(paused=True))

    async def end(self) -> None:
        """Let the simulator's time go."""
        await self.talk(lambda: self._api.pause(paused=False))

    async def catch_up(self) -> None:
        """Let the simulator's time go on for what the agent has thought."""
        idle_s = self._clock.now_s() - self._known_s
        if idle_s > 0.0:
            await self.talk(lambda: self._api.go_on_for(idle_s))
        self._known_s = self._clock.now_s()

    async def until(self, pending: Pending | None, seconds: float) -> None:
        """Let the simulator's time go on, tick by tick where an answer may come in between."""
        if pending is None:
            await self.talk(lambda: self._api.go_on_for(seconds))
            return

        async def ticks() -> None:
            for _ in range(max(1, round(seconds / _TICK_S))):
                if pending.answered:
                    return
                await self._api.go_on_for(_TICK_S)

        await self.talk(ticks)

    async def charge(self, elapsed_s: float) -> None:
        """Have the mission's clock jump."""
        await self._clock.act(elapsed_s)
        self._known_s = self._clock.now_s()


def pace_of(clock: Clock, api: AirSimApi) -> Pace:
    """Return the pace that fits a clock."""
    return LivedPace(clock, api) if clock.name == "real" else SteppedPace(clock, api)
