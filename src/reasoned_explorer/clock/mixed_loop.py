"""An asyncio event loop in virtual time whose live calls take the real seconds that they take.

Where nothing is ready, the virtual loop jumps to the next thing that is due. Here it first waits, in real time, until
every live call that is still out is known to end later than that: a call that began at the virtual time t0 and has run
for e seconds ends after t0 + e. A call that ends is due at t0 plus its seconds. So things happen in the order of the
times that are charged, and a loop that is told the same seconds beforehand does the same things at the same times.
"""

import asyncio
import selectors
from collections.abc import Callable, Coroutine
from concurrent.futures import Future
from typing import Any, TypeVar

from reasoned_explorer.clock.live_thread import Stopwatch, begin_live
from reasoned_explorer.clock.virtual_loop import NeverWaiting, VirtualEventLoop

T = TypeVar("T")

#: A live call must be known to end so much later than a virtual thing is due before that may happen, seconds: asyncio
#: runs what is due within a nanosecond together.
_MARGIN_S = 1e-6


class _LiveCall:
    def __init__(self, started_s: float) -> None:
        self.started_s = started_s
        self.watch = Stopwatch()


class _WaitingForCalls(NeverWaiting):
    def __init__(self) -> None:
        super().__init__()
        self.out: set[_LiveCall] = set()

    def select(self, timeout: float | None = None) -> list[tuple[selectors.SelectorKey, int]]:
        if timeout is None or timeout <= 0.0:
            return super().select(timeout)
        due_s = self.now_s + timeout
        while self.out:
            early_s = max(due_s + _MARGIN_S - call.started_s - call.watch.at_least_s() for call in self.out)
            if early_s <= 0.0:
                break
            ready = self.wait(early_s)
            if ready:
                return ready  # the end of a call, perhaps: it may be due earlier
        return super().select(timeout)


class MixedEventLoop(VirtualEventLoop):
    """The virtual loop with live calls. Real sockets and threads are awaited in live calls only."""

    def __init__(self) -> None:
        self._calls = _WaitingForCalls()
        super().__init__(self._calls)

    async def live(self, call: Callable[[], Coroutine[Any, Any, T]]) -> tuple[T, float]:
        """Run a call in the live loop; return what it returns and its seconds, both at the virtual time of its end."""
        out: _LiveCall = _LiveCall(self.time())
        answered: asyncio.Future[T] = self.create_future()
        due: list[asyncio.TimerHandle] = []

        def end(outcome: "Future[T]") -> None:
            self._calls.out.discard(out)
            if not answered.done():
                due.append(self.call_at(out.started_s + out.watch.took_s, _hand_over, outcome, answered))

        outcome = begin_live(call, out.watch)
        self._calls.out.add(out)
        outcome.add_done_callback(lambda done: self.call_soon_threadsafe(end, done))
        try:
            return await answered, out.watch.took_s
        finally:
            outcome.cancel()
            self._calls.out.discard(out)
            # A call that was cancelled must leave nothing behind that the loop would stop at.
            for handle in due:
                handle.cancel()


def _hand_over(outcome: "Future[T]", answered: "asyncio.Future[T]") -> None:
    if answered.done():
        return
    error = outcome.exception()
    if error is None:
        answered.set_result(outcome.result())
    else:
        answered.set_exception(error)
