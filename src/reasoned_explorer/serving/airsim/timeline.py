"""The served simulator's own time: real time times a speed, or as fast as asked, and held where a client holds it."""

import asyncio
import heapq
import math
from collections.abc import Callable
from dataclasses import dataclass

from reasoned_explorer.model import Fault, SettingsError
from reasoned_explorer.model.checks import is_within

#: Times nearer than this are one, seconds: sums of ticks are not exact.
_SAME_S = 1e-9


@dataclass(slots=True, eq=False)
class Alarm:
    """What is to happen at a moment.

    Attributes:
        ring: Called then.
        is_off: Whether it will not.
    """

    ring: Callable[[], None]
    is_off: bool = False


class Timeline:
    """Time in seconds, from 0 on.

    With a finite speed it passes as real time does, so many times faster. "As fast as asked" it passes only where
    somebody waits for a moment: then it jumps there. Held, it does not pass but by `go_on_for`.

    Args:
        speed: Simulated seconds in a real one, or infinite for as fast as asked.

    Raises:
        SettingsError: If the speed is not positive.
    """

    def __init__(self, speed: float = 1.0) -> None:
        if speed != math.inf and not is_within(speed, 1e-3, 1e4):
            what = f"the clock's speed is {speed!r:.40}"
            raise SettingsError("served simulator", [Fault(what, "0.001 to 10,000, or infinity for as fast as asked")])
        self.speed = float(speed)
        self._loop = asyncio.get_running_loop()
        self._base_s, self._base_real_s = 0.0, self._loop.time()
        self._limit_s = math.inf  # time does not pass beyond
        self._waiting: list[tuple[float, int, Alarm]] = []
        self._count = 0
        self._alarm: asyncio.Handle | None = None
        self._going_on: asyncio.Future[None] | None = None

    @property
    def now_s(self) -> float:
        """The time, seconds."""
        if self.speed == math.inf:
            return self._base_s
        passed_s = (self._loop.time() - self._base_real_s) * self.speed
        return max(self._base_s, min(self._limit_s, self._base_s + passed_s))

    @property
    def is_stepped(self) -> bool:
        """Whether somebody holds time, or has it pass a little and then holds it."""
        return self._limit_s < math.inf

    @property
    def is_held(self) -> bool:
        """Whether time does not pass now."""
        return self._limit_s <= self.now_s + _SAME_S

    def at(self, due_s: float, ring: Callable[[], None]) -> Alarm:
        """Have something happen when a moment has come; what is due at one moment in the order of asking.

        It happens before anybody hears of that moment: before the future of `go_on_for` is done.
        """
        alarm = Alarm(ring)
        self._count += 1
        heapq.heappush(self._waiting, (due_s, self._count, alarm))
        self._arm()
        return alarm

    def cancel(self, alarm: Alarm) -> None:
        """Have it not happen."""
        alarm.is_off = True
        self._arm()

    def hold(self) -> None:
        """Let no time pass."""
        self._set(self.now_s, self.now_s)

    def let_go(self) -> None:
        """Let time pass."""
        self._set(self.now_s, math.inf)

    def go_on_for(self, seconds: float) -> "asyncio.Future[None]":
        """Let some seconds pass, then hold; return a future that is done when they have passed."""
        now_s = self.now_s
        self._set(now_s, now_s + seconds)
        going_on = self._going_on = self._loop.create_future()
        if self.speed == math.inf:
            self._jump()
        return going_on

    def _set(self, now_s: float, limit_s: float) -> None:
        self._base_s, self._base_real_s, self._limit_s = now_s, self._loop.time(), limit_s
        going_on, self._going_on = self._going_on, None
        if going_on is not None and not going_on.done():
            going_on.set_result(None)
        self._arm()

    def _arm(self) -> None:
        if self._alarm is not None:
            self._alarm.cancel()
            self._alarm = None
        next_s = self._next_s()
        due_s = min(next_s, self._limit_s)
        if due_s == math.inf or (self.is_held and next_s > self.now_s + _SAME_S):
            return
        if self.speed == math.inf:
            self._alarm = self._loop.call_soon(self._jump)
        else:
            self._alarm = self._loop.call_later(max(0.0, due_s - self.now_s) / self.speed, self._ring)

    def _next_s(self) -> float:
        while self._waiting and self._waiting[0][2].is_off:
            heapq.heappop(self._waiting)
        return self._waiting[0][0] if self._waiting else math.inf

    def _jump(self) -> None:
        """Go to the moments that are waited for, one after the other, as far as time may pass."""
        while (due_s := self._next_s()) <= self._limit_s + _SAME_S and due_s < math.inf:
            self._base_s = max(self._base_s, min(due_s, self._limit_s))
            heapq.heappop(self._waiting)[2].ring()
        if self._limit_s < math.inf:
            self._base_s = max(self._base_s, self._limit_s)
        self._tell()

    def _ring(self) -> None:
        now_s = self.now_s
        while self._next_s() <= now_s + _SAME_S:
            heapq.heappop(self._waiting)[2].ring()
        if now_s >= self._limit_s - _SAME_S:
            self._tell()
        self._arm()

    def _tell(self) -> None:
        """Tell whoever let time go on for a while that it has."""
        going_on, self._going_on = self._going_on, None
        if going_on is not None and not going_on.done():
            going_on.set_result(None)
