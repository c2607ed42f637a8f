"""How fast an endpoint may be asked: limits a minute, waits that it asks for, and how many calls it bears at once.

Three things hold a call back. *Buckets* of requests and of tokens fill at the rate that a person or the server's
``x-ratelimit-*`` headers tell. A *gate* closes for everybody when the server says 429, until the time that it names.
While more is wanted than a server of unknown limits gives (a *jam*), the rate is what it was measured to grant, and is
raised a little with each grant. A *window* of calls at once grows with answers and halves when many fail at the
same time (AIMD). What waits is served in order.
"""

import asyncio
import math
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum, auto

from reasoned_explorer.calls.rate_headers import rate_state, retry_after_s

_BURST_SHARE = 0.1  # of a minute's worth may go at once where nobody tells how much may
_MARGIN = 0.99  # of a limit that is told: calls do not arrive as evenly as they are sent
_CREEP = 0.005  # the measured rate is raised by this share with each grant, to find out whether more is granted
_CREEP_AFTER = 30.0  # grants since the last refusal until it is raised by all of it
_RAMP_OF_GATE = 2.0  # or this many times the grants that a closed gate costs, where that is more
# A gate that is closed for about a second has been closed in whole seconds, and longer than need be. Of what it saves
# up a little less goes at once: a bucket that holds no more than that is full and saves nothing while it is sent.
_ABOUT_A_SECOND_S = 0.5, 1.5
_SAVED = 0.9
_MOST_FOUND = 8  # such refusals, after which the next one is not looked for any more slowly
_LONGEST_BACK_OFF_S = 30.0
_FIRST_BACK_OFF_S = 0.5
_JAM_MEMORY_S = 30.0
_RECENT, _FEWEST_SIGNS, _SHARE_OF_SIGNS = 20, 3, 0.3


class Sign(Enum):
    """What the end of a call says about how fast the endpoint may be asked."""

    ANSWERED = auto()
    LIMITED = auto()
    """It said 429."""
    OVERLOADED = auto()
    """It did not answer in time, or said that it is overloaded."""
    NEUTRAL = auto()
    """Cancelled, or failed for a reason of its own."""


@dataclass(frozen=True, slots=True)
class Limits:
    """What is known of an endpoint's limits before it is asked; its headers tell more.

    Attributes:
        requests_per_minute: As a person says, or None.
        tokens_per_minute: Sent and received together, as a person says, or None.
        first_at_once: Calls at once to begin with.
        most_at_once: Never more calls at once.
    """

    requests_per_minute: float | None = None
    tokens_per_minute: float | None = None
    first_at_once: int = 64
    most_at_once: int = 512


class NoTurnError(Exception):
    """A call whose turn does not come within the patience of its caller.

    Args:
        wait_s: How long it has waited or would have to, seconds.
    """

    def __init__(self, wait_s: float) -> None:
        self.wait_s = wait_s
        super().__init__(f"no turn within {wait_s:.0f} s")


@dataclass(eq=False, slots=True)
class Ticket:
    """The right to make one call; hand it back with `Pacer.done`."""

    number: int
    sent_s: float
    tokens: float
    jam: int
    requests_spent: float
    tokens_spent: float


@dataclass(eq=False, slots=True)
class _Bucket:
    told_per_s: float
    capacity: float
    level: float
    at_s: float = -math.inf
    spent: float = 0.0
    measured_per_s: float = math.inf
    saved: float = 1.0

    @classmethod
    def of(cls, per_minute: float | None) -> "_Bucket":
        capacity = math.inf if per_minute is None else max(1.0, per_minute * _BURST_SHARE)
        return cls(math.inf if per_minute is None else per_minute / 60.0, capacity, capacity)

    @property
    def rate_per_s(self) -> float:
        return min(_MARGIN * self.told_per_s, self.measured_per_s)

    @property
    def _most(self) -> float:
        return min(self.capacity, self.saved) if self.measured_per_s < self.told_per_s else self.capacity

    def _fill(self, now_s: float) -> None:
        if now_s > self.at_s:
            if not math.isinf(self.level):
                self.level = min(self._most, self.level + self.rate_per_s * (now_s - self.at_s))
            self.at_s = now_s

    def wait_s(self, amount: float, now_s: float) -> float:
        """Return how long until so much may be spent; what exceeds the bucket goes when it is full."""
        self._fill(now_s)
        lacking = min(amount, self._most) - self.level
        return lacking / self.rate_per_s if lacking > 1e-9 else 0.0

    def spend(self, amount: float, now_s: float) -> None:
        self._fill(now_s)
        self.level -= amount
        self.spent += amount

    def measured(self, per_s: float, from_s: float, *, after_s: float = 0.0) -> None:
        """Go on at a measured rate from some moment on, at first with what a closed gate has saved up."""
        self.measured_per_s = per_s
        if not math.isinf(per_s):
            self.saved = max(1.0, per_s * after_s)
            self.level, self.at_s = self.saved, from_s

    def told(self, headers: Mapping[str, str], what: str, sent_s: float, spent_then: float, now_s: float) -> None:
        """Believe the headers of an answer, which show the server's count when it took that request."""
        state = rate_state(headers, what)
        if state is None:
            return
        if state.refill_per_s is not None:
            self.told_per_s = state.refill_per_s
        if not math.isinf(self.told_per_s):
            self.capacity = state.limit
            since = self.told_per_s * (now_s - sent_s) - (self.spent - spent_then)
            self.level, self.at_s = min(self._most, state.remaining + since), now_s


@dataclass(eq=False, slots=True)
class _Jam:
    number: int = 0
    since_s: float | None = None
    granted: float = 0.0
    refused: float = 0.0
    smooth: int = 0
    found: int = 0
    ramp: float = _CREEP_AFTER


@dataclass(eq=False, slots=True)
class _Window:
    at_once: float
    most: int
    slow_from: float = math.inf
    recent: deque[bool] = field(default_factory=lambda: deque(maxlen=_RECENT))
    shrunk_before: int = 0

    def answered(self, in_flight: int) -> None:
        self.recent.append(False)
        if in_flight >= self.at_once / 2.0:
            self.at_once = min(self.most, self.at_once + (1.0 if self.at_once < self.slow_from else 1 / self.at_once))

    def failed(self, number: int, next_number: int) -> None:
        """Halve where failures come together; single ones are no sign of load, nor are those sent before a halving."""
        if number < self.shrunk_before:
            return
        self.recent.append(True)
        signs = sum(self.recent)
        if signs >= _FEWEST_SIGNS and signs >= _SHARE_OF_SIGNS * len(self.recent):
            self.at_once = max(1.0, self.at_once / 2.0)
            self.slow_from, self.shrunk_before = self.at_once, next_number
            self.recent.clear()


class Pacer:
    """Gives out the right to call one model of one endpoint. It belongs to one event loop.

    Args:
        limits: What is known before.
    """

    def __init__(self, limits: Limits) -> None:
        self._requests = _Bucket.of(limits.requests_per_minute)
        self._tokens = _Bucket.of(limits.tokens_per_minute)
        self._window = _Window(min(limits.first_at_once, limits.most_at_once), limits.most_at_once)
        self._queue: deque[tuple[asyncio.Future[Ticket], float]] = deque()
        self._in_flight = 0
        self._number = 0
        self._newest_told = -1
        self._closed_until_s = -math.inf
        self._closed_at_s = -math.inf
        self._refusals_in_a_row = 0
        self._jam = _Jam()
        self._timer: asyncio.TimerHandle | None = None
        self._soon: asyncio.Handle | None = None

    @property
    def at_once(self) -> int:
        """How many calls may be under way at the same time just now."""
        return int(self._window.at_once)

    async def turn(self, *, tokens: float, patience_s: float, again: bool = False) -> Ticket:
        """Wait until a call may be made.

        Args:
            tokens: That it is likely to take, sent and received.
            patience_s: At most so long, seconds.
            again: It was turned away before and is served before those that come for the first time.

        Raises:
            NoTurnError: If it would take longer.
        """
        loop = asyncio.get_running_loop()
        began_s = loop.time()
        if self._closed_until_s - began_s > patience_s:
            raise NoTurnError(self._closed_until_s - began_s)
        place: asyncio.Future[Ticket] = loop.create_future()
        (self._queue.appendleft if again else self._queue.append)((place, tokens))
        self._serve()
        try:
            if place.done():
                return place.result()
            async with asyncio.timeout(patience_s):
                return await asyncio.shield(place)
        except BaseException as error:
            if place.done() and not place.cancelled():
                self.done(place.result(), Sign.NEUTRAL)
            else:
                place.cancel()
                self._serve()
            if isinstance(error, TimeoutError):
                raise NoTurnError(loop.time() - began_s) from None
            raise

    def done(
        self, ticket: Ticket, sign: Sign, *, tokens: float | None = None, headers: Mapping[str, str] | None = None
    ) -> None:
        """Say how a call ended.

        Args:
            ticket: Of the call.
            sign: What its end says.
            tokens: That it really took, where that is known.
            headers: Of the answer, with names in lower case or a mapping that does not mind.
        """
        now_s = asyncio.get_running_loop().time()
        headers = headers or {}
        self._in_flight -= 1
        if tokens is not None and tokens > 0:
            self._tokens.spend(tokens - ticket.tokens, now_s)
        if ticket.number > self._newest_told and headers:
            self._newest_told = ticket.number
            self._requests.told(headers, "requests", ticket.sent_s, ticket.requests_spent, now_s)
            self._tokens.told(headers, "tokens", ticket.sent_s, ticket.tokens_spent, now_s)
        if sign is Sign.ANSWERED:
            self._refusals_in_a_row = 0
            about_to_go = len(self._queue) if self._soon is not None else 0
            self._window.answered(self._in_flight + 1 + about_to_go)
        elif sign is Sign.OVERLOADED:
            self._window.failed(ticket.number, self._number)
        elif sign is Sign.LIMITED:
            self._limited(ticket, headers, now_s)
        self._serve()

    def _limited(self, ticket: Ticket, headers: Mapping[str, str], now_s: float) -> None:
        is_first = ticket.sent_s >= self._closed_at_s  # and not one more of those that went out together
        if is_first:
            self._refusals_in_a_row += 1
            self._closed_at_s = now_s
        wait_s = retry_after_s(headers)
        if wait_s is None:
            wait_s = min(_LONGEST_BACK_OFF_S, _FIRST_BACK_OFF_S * 2.0 ** min(10, self._refusals_in_a_row - 1))
        self._closed_until_s = max(self._closed_until_s, now_s + wait_s)
        jam = self._jam
        if jam.since_s is None:
            self._jam = _Jam(jam.number + 1, now_s)
        elif ticket.jam == jam.number:
            jam.refused += 1.0
            # Nothing was left when the jam began and nothing is now: what came through is what was granted meanwhile.
            span_s = max(1e-3, now_s - jam.since_s)
            per_s = max(1.0, jam.granted - jam.refused + 1.0) / span_s
            jam.smooth = 0
            gate_s = self._closed_until_s - self._closed_at_s
            # The more a closed gate costs, and the oftener the rate was found, the more slowly the next refusal is
            # looked for.
            is_rounded = _ABOUT_A_SECOND_S[0] <= gate_s <= _ABOUT_A_SECOND_S[1]
            jam.found += is_first and is_rounded
            jam.ramp = max(_CREEP_AFTER, _RAMP_OF_GATE * per_s * gate_s * max(1, min(jam.found, _MOST_FOUND)))
            self._requests.measured(per_s, self._closed_until_s, after_s=(_SAVED if is_rounded else 1.0) * gate_s)
            if span_s > _JAM_MEMORY_S:
                jam.since_s, jam.granted, jam.refused = (
                    jam.since_s + span_s / 2.0,
                    jam.granted / 2.0,
                    jam.refused / 2.0,
                )

    def _serve(self) -> None:
        """Let one go if it is its turn, and come back when it will be the next one's.

        No more than one goes in each turn of the event loop. A call takes several of them until it is sent: many that
        go together are sent together too, all of them as late as the last.
        """
        if self._soon is not None:
            return
        loop = asyncio.get_running_loop()
        now_s = loop.time()
        wait_s: float | None = None
        while self._queue:
            place, tokens = self._queue[0]
            if place.done():
                self._queue.popleft()
                continue
            if self._in_flight >= int(self._window.at_once):
                break  # whoever is done comes by here
            wait_s = max(
                self._closed_until_s - now_s, self._requests.wait_s(1.0, now_s), self._tokens.wait_s(tokens, now_s)
            )
            if wait_s > 0.0:
                break
            self._queue.popleft()
            place.set_result(self._ticket(tokens, now_s))
            self._soon = loop.call_soon(self._serve_next)
            return
        if not self._queue and self._jam.since_s is not None:
            self._jam.since_s = None
            self._requests.measured(math.inf, now_s)
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None
        if wait_s is not None and wait_s > 0.0:
            self._timer = loop.call_later(wait_s, self._serve)

    def _serve_next(self) -> None:
        self._soon = None
        self._serve()

    def _ticket(self, tokens: float, now_s: float) -> Ticket:
        self._requests.spend(1.0, now_s)
        self._tokens.spend(tokens, now_s)
        self._in_flight += 1
        self._number += 1
        jam = 0
        if self._jam.since_s is not None:
            jam = self._jam.number
            self._jam.granted += 1.0
            self._jam.smooth += 1
            self._requests.measured_per_s *= 1.0 + _CREEP * min(1.0, self._jam.smooth / self._jam.ramp)
        return Ticket(self._number, now_s, tokens, jam, self._requests.spent, self._tokens.spent)
