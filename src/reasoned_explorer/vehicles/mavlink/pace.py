"""How a driver's time and the autopilot's time go together.

A real autopilot lives in real time, and so must the mission's clock. The embedded simulator, served as an autopilot,
can be held and stepped (`lockstep`): then a clock whose seconds jump will do, and a mission over the wire is timed as
one in the embedded simulator is, whatever the wire, the pictures and the computing took.
"""

import asyncio
import math
from collections.abc import Callable, Coroutine
from dataclasses import dataclass
from typing import Any, Protocol, TypeVar

from reasoned_explorer.clock import Clock
from reasoned_explorer.clock.live_thread import Stopwatch, begin_live
from reasoned_explorer.geometry import Pose
from reasoned_explorer.vehicles.airsim.conventions import HomeFrame
from reasoned_explorer.vehicles.mavlink.autopilot import Autopilot
from reasoned_explorer.vehicles.mavlink.lockstep import Ask, Report

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Moment:
    """Where the vehicle is at a moment.

    Attributes:
        t_s: The pace's time, seconds.
        believed: Where the autopilot's filter takes it to be.
        true: Where it really is, as far as anybody knows.
        speed_mps: Of its body.
        yaw_rate_radps: Positive clockwise; None where nobody says.
        is_busy: Whether it is on its way to somewhere; None where nobody says.
        hits: How often it has run into something that was told.
        hit: What that was.
    """

    t_s: float
    believed: Pose
    true: Pose
    speed_mps: float
    yaw_rate_radps: float | None = None
    is_busy: bool | None = None
    hits: int = 0
    hit: str = ""


class Pace(Protocol):
    """How time passes for a driver."""

    #: Whether the autopilot's time passes by itself.
    is_lived: bool

    async def talk(self, call: Callable[[], Coroutine[Any, Any, T]]) -> T:
        """Talk to the autopilot, in the process's live loop, and return what comes of it."""

    async def begin(self) -> None:
        """Take the autopilot's time in hand."""

    async def end(self) -> None:
        """Let it go."""

    async def catch_up(self, *, looks: bool = False) -> None:
        """Have as much time passed for the autopilot as on the mission's clock."""

    async def until_idle(self, seconds: float) -> None:
        """Let some seconds pass, or less where a motion is known to end before."""

    async def wait(self, seconds: float) -> None:
        """Let some seconds pass."""

    def moment(self) -> Moment:
        """Return where the vehicle is."""

    async def charge(self, elapsed_s: float) -> None:
        """Have passed on the mission's clock what has passed for the autopilot since this was last told."""


class LivedPace:
    """Every second is lived through.

    Args:
        clock: The mission's, a real one.
        autopilot: Whom to talk to.
        home: Where positions on the wire count from.
    """

    is_lived = True

    def __init__(self, clock: Clock, autopilot: Autopilot, home: HomeFrame) -> None:
        self._clock, self._autopilot, self._home = clock, autopilot, home

    async def talk(self, call: Callable[[], Coroutine[Any, Any, T]]) -> T:
        """Talk, while other things go on here."""
        return await asyncio.wrap_future(begin_live(call, Stopwatch()))

    async def begin(self) -> None:
        """Nothing: nobody's time is held."""

    async def end(self) -> None:
        """Likewise."""

    async def catch_up(self, *, looks: bool = False) -> None:
        """Nothing: time has passed."""
        del looks

    async def until_idle(self, seconds: float) -> None:
        """Wait."""
        await self._clock.act(seconds)

    async def wait(self, seconds: float) -> None:
        """Wait."""
        await self._clock.act(seconds)

    def moment(self) -> Moment:
        """Return what the autopilot last told."""
        told, origin, home = self._autopilot.telemetry, self._autopilot.settings.origin, self._home
        yaw_rad = told.yaw_rad or 0.0
        local, globe = told.local, told.globe
        if origin is not None and globe is not None:
            east_m, north_m = origin.enu_from_geodetic_m(globe.lat_deg, globe.lon_deg)
            place = float(east_m), float(north_m), globe.above_home_m
            speed = math.hypot(globe.north_mps, globe.east_mps)
        elif local is not None:
            place = home.enu_m(local.north_m, local.east_m, local.down_m)
            speed = math.hypot(local.north_mps, local.east_mps, local.down_mps)
        else:
            raise AssertionError
        believed = Pose(*place, yaw_rad)
        return Moment(self._clock.now_s(), believed, believed, speed, told.yaw_rate_radps)

    async def charge(self, elapsed_s: float) -> None:
        """Nothing: it was lived through."""
        del elapsed_s


class SteppedPace:
    """The simulator is held but where the mission's clock, which jumps, says that time has passed.

    Talking stops everything else here: no time passes while it does.

    Args:
        clock: The mission's, a virtual or a mixed one.
        autopilot: Whom to talk to.
        home: Where positions on the wire count from; reports are in the world's frame already.
    """

    is_lived = False

    def __init__(self, clock: Clock, autopilot: Autopilot, home: HomeFrame) -> None:
        self._clock, self._autopilot, self._home = clock, autopilot, home
        self._known_s = 0.0
        self._report: Report | None = None

    async def talk(self, call: Callable[[], Coroutine[Any, Any, T]]) -> T:
        """Talk, while nothing else goes on here."""
        # A request to stop cancels the mission where it next lets time pass; an answer has its deadline.
        return begin_live(call, Stopwatch()).result()

    async def begin(self) -> None:
        """Hold the simulator's time.

        Raises:
            PartError: If what is there cannot be held: only a real clock will do.
        """
        self._known_s = self._clock.now_s()
        await self._ask(Ask.HOLD)

    async def end(self) -> None:
        """Let the simulator's time go."""
        await self._ask(Ask.RELEASE)

    async def catch_up(self, *, looks: bool = False) -> None:
        """Let the simulator's time go on for what the agent has thought."""
        idle_s = self._clock.now_s() - self._known_s
        if idle_s > 0.0:
            await self._ask(Ask.STEP, idle_s)
        await self._ask(Ask.LOOK if looks else Ask.STATE)
        self._known_s = max(self._known_s, self._clock.now_s())

    async def until_idle(self, seconds: float) -> None:
        """Let the simulator's time go on, at most to the end of what moves."""
        await self._ask(Ask.STEP, seconds, until_idle=True)

    async def wait(self, seconds: float) -> None:
        """Let the simulator's time go on."""
        await self._ask(Ask.STEP, seconds)

    def moment(self) -> Moment:
        """Return what the simulator last reported."""
        told = self._report
        if told is None:
            raise AssertionError
        rate = told.yaw_rate_radps
        return Moment(told.t_s, told.believed, told.true, told.speed_mps, rate, told.is_busy, told.hits, told.hit)

    async def charge(self, elapsed_s: float) -> None:
        """Have the mission's clock jump."""
        # Whoever cancels this finds the simulator ahead: what it has lived through is not to pass for it again.
        self._known_s = self._clock.now_s() + elapsed_s
        await self._clock.act(elapsed_s)

    async def _ask(self, ask: Ask, seconds: float = 0.0, *, until_idle: bool = False) -> None:
        self._report = await self.talk(lambda: self._autopilot.step(ask, seconds, until_idle=until_idle))


def pace_of(clock: Clock, autopilot: Autopilot, home: HomeFrame) -> Pace:
    """Return the pace that fits a clock."""
    kind = LivedPace if clock.name == "real" else SteppedPace
    return kind(clock, autopilot, home)
