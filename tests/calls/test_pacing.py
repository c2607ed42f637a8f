"""Pacing in virtual time, against servers that are a few lines each: hours of traffic, no second waited."""

import asyncio
import math

import pytest

from reasoned_explorer.calls.pacing import Limits, NoTurnError, Pacer, Sign
from reasoned_explorer.clock import VirtualClock

LATENCY_S = 0.5


class Bucket:
    """Lets so many requests a second in, and tells what its headers are to tell."""

    def __init__(self, per_s: float, burst: float, *, tells: bool = False, retry_after: str | None = "ms") -> None:
        self.per_s, self.burst, self.tells, self.retry_after = per_s, burst, tells, retry_after
        self.level, self.at_s = burst, 0.0
        self.admitted: list[float] = []
        self.turned_away = 0

    def ask(self, now_s: float) -> tuple[bool, dict[str, str]]:
        self.level = min(self.burst, self.level + self.per_s * (now_s - self.at_s))
        self.at_s = now_s
        is_in = self.level >= 1.0 - 1e-9
        self.level -= is_in
        headers = {}
        if self.tells:
            remaining = math.floor(self.level + 1e-9)
            headers = {
                "x-ratelimit-limit-requests": f"{self.burst:.0f}",
                "x-ratelimit-remaining-requests": f"{remaining}",
                "x-ratelimit-reset-requests": f"{1e3 * (self.burst - remaining) / self.per_s:.0f}ms",
            }
        if is_in:
            self.admitted.append(now_s)
        else:
            self.turned_away += 1
            wait_s = (1.0 - self.level) / self.per_s
            if self.retry_after == "ms":
                headers["retry-after-ms"] = f"{math.ceil(1e3 * wait_s)}"
            elif self.retry_after == "seconds":
                headers["retry-after"] = f"{math.ceil(wait_s)}"
        return is_in, headers


class Window(Bucket):
    """Lets so many requests in within any stretch of ten seconds."""

    def ask(self, now_s: float) -> tuple[bool, dict[str, str]]:
        recent = [at_s for at_s in self.admitted if at_s > now_s - 10.0]
        if len(recent) < 10.0 * self.per_s:
            self.admitted.append(now_s)
            return True, {}
        self.turned_away += 1
        return False, {"retry-after": f"{math.ceil(recent[0] + 10.0 - now_s)}"}


async def call(pacer: Pacer, server: Bucket, *, tokens: float = 0.0, line: "Line | None" = None) -> None:
    loop = asyncio.get_running_loop()
    again = False
    while True:
        ticket = await pacer.turn(tokens=tokens, patience_s=1e6, again=again)
        if line is not None:
            await line.send()
        is_in, headers = server.ask(loop.time())
        if is_in:
            await asyncio.sleep(LATENCY_S)
            pacer.done(ticket, Sign.ANSWERED, tokens=tokens, headers=headers)
            return
        await asyncio.sleep(0.01)
        pacer.done(ticket, Sign.LIMITED, headers=headers)
        again = True


class Line:
    """Sends one call after the other, each of which takes a moment of the processor."""

    def __init__(self, seconds: float) -> None:
        self._seconds, self._lock = seconds, asyncio.Lock()

    async def send(self) -> None:
        async with self._lock:
            await asyncio.sleep(self._seconds)


def share_of_limit(limits: Limits, server: Bucket, calls: int = 6000, *, send_s: float = 0.0) -> float:
    """Return what went through over what might have gone through until all were done."""

    async def traffic() -> float:
        pacer, loop = Pacer(limits), asyncio.get_running_loop()
        line = Line(send_s) if send_s else None
        began_s = server.at_s = loop.time()
        await asyncio.gather(*(call(pacer, server, line=line) for _ in range(calls)))
        return calls / (server.burst + server.per_s * (loop.time() - LATENCY_S - began_s))

    return VirtualClock().run(traffic())


@pytest.mark.parametrize(
    ("limits", "server"),
    [
        pytest.param(Limits(requests_per_minute=600), Bucket(10, 60), id="told by a person"),
        pytest.param(Limits(), Bucket(10, 600, tells=True), id="told by headers"),
    ],
)
def test_a_known_limit_is_used_up_and_never_exceeded(limits: Limits, server: Bucket) -> None:
    assert share_of_limit(limits, server) >= 0.98
    assert server.turned_away == 0


@pytest.mark.parametrize(
    ("limits", "server"),
    [
        pytest.param(Limits(), Bucket(10, 5, tells=True), id="a small bucket, told by headers"),
        pytest.param(Limits(), Bucket(10, 10), id="only Retry-After, in milliseconds"),
        pytest.param(Limits(), Bucket(10, 10, retry_after="seconds"), id="only Retry-After, in whole seconds"),
        pytest.param(Limits(), Bucket(10, 10, retry_after=None), id="nothing but 429"),
        pytest.param(Limits(), Bucket(50, 50, retry_after="seconds"), id="the same where much is lost in a second"),
        pytest.param(Limits(), Window(10, 100), id="a window of ten seconds"),
        pytest.param(Limits(requests_per_minute=1200), Bucket(10, 10), id="a person says twice what there is"),
    ],
)
def test_an_unknown_limit_is_found(limits: Limits, server: Bucket) -> None:
    assert share_of_limit(limits, server) >= 0.95
    assert server.turned_away <= 0.10 * len(server.admitted)


def test_a_burst_that_takes_a_moment_to_send_costs_little() -> None:
    # A bucket of one second's worth is full when Retry-After, in whole seconds, lets the next call go.
    server = Bucket(50, 50, retry_after="seconds")
    assert share_of_limit(Limits(), server, calls=1550, send_s=0.002) >= 0.97


def test_of_many_that_may_go_the_first_is_sent_before_the_last_has_its_turn() -> None:
    async def traffic() -> list[str]:
        pacer, events = Pacer(Limits()), list[str]()

        async def one() -> None:
            ticket = await pacer.turn(tokens=0.0, patience_s=9.0)
            events.append("turn")
            for _ in range(10):  # a request is put together in some turns of the loop
                await asyncio.sleep(0)
            events.append("sent")
            pacer.done(ticket, Sign.ANSWERED)

        await asyncio.gather(*(one() for _ in range(50)))
        return events

    events = VirtualClock().run(traffic())
    assert events[: events.index("sent")].count("turn") <= 12
    assert events.count("sent") == 50


def test_tokens_a_minute_hold_back_too() -> None:
    async def traffic() -> float:
        pacer, loop = Pacer(Limits(tokens_per_minute=6000)), asyncio.get_running_loop()
        began_s = loop.time()
        await asyncio.gather(*(call(pacer, Bucket(1e6, 1e6), tokens=300.0) for _ in range(42)))
        return loop.time() - LATENCY_S - began_s

    # 600 tokens may go at once, the other 12,000 at 99 a second
    assert VirtualClock().run(traffic()) == pytest.approx(12_000 / 99)


def test_tokens_that_were_guessed_wrong_are_set_right() -> None:
    async def traffic() -> float:
        pacer, loop = Pacer(Limits(tokens_per_minute=6000)), asyncio.get_running_loop()
        ticket = await pacer.turn(tokens=10.0, patience_s=100.0)
        pacer.done(ticket, Sign.ANSWERED, tokens=1600)
        asked_s = loop.time()
        await pacer.turn(tokens=100.0, patience_s=100.0)
        return loop.time() - asked_s

    assert VirtualClock().run(traffic()) == pytest.approx(1100 / 99)  # 1000 too many, and 100 for the next


def test_retry_after_holds_for_everybody() -> None:
    async def traffic() -> list[float]:
        pacer, loop = Pacer(Limits()), asyncio.get_running_loop()
        ticket = await pacer.turn(tokens=0.0, patience_s=100.0)
        began_s = loop.time()
        pacer.done(ticket, Sign.LIMITED, headers={"retry-after": "7"})

        async def one() -> float:
            pacer.done(await pacer.turn(tokens=0.0, patience_s=100.0), Sign.ANSWERED)
            return loop.time() - began_s

        return await asyncio.gather(one(), one(), one())

    assert VirtualClock().run(traffic()) == pytest.approx([7.0, 7.0, 7.0])


def test_who_has_no_patience_is_told_how_long_it_takes() -> None:
    async def traffic() -> None:
        pacer = Pacer(Limits())
        pacer.done(await pacer.turn(tokens=0.0, patience_s=9.0), Sign.LIMITED, headers={"retry-after": "3600"})
        await pacer.turn(tokens=0.0, patience_s=9.0)

    with pytest.raises(NoTurnError, match="3600 s"):
        VirtualClock().run(traffic())


def test_who_waits_in_vain_leaves_the_line() -> None:
    async def traffic() -> float:
        pacer = Pacer(Limits(first_at_once=1))
        first = await pacer.turn(tokens=0.0, patience_s=9.0)
        with pytest.raises(NoTurnError):
            await pacer.turn(tokens=0.0, patience_s=9.0)
        waiting = asyncio.create_task(pacer.turn(tokens=0.0, patience_s=9.0))
        await asyncio.sleep(1.0)
        waiting.cancel()
        pacer.done(first, Sign.ANSWERED)
        asked_s = asyncio.get_running_loop().time()
        await pacer.turn(tokens=0.0, patience_s=9.0)
        return asyncio.get_running_loop().time() - asked_s

    assert VirtualClock().run(traffic()) == 0.0


def crowd(share_overloaded: float) -> int:
    """Return the calls at once after five hundred, of which some find the server overloaded."""

    async def traffic() -> int:
        pacer = Pacer(Limits(first_at_once=64))

        async def one(number: int) -> None:
            ticket = await pacer.turn(tokens=0.0, patience_s=1e6)
            await asyncio.sleep(1.0)
            is_bad = (number * 37) % 100 < 100 * share_overloaded
            pacer.done(ticket, Sign.OVERLOADED if is_bad else Sign.ANSWERED)

        await asyncio.gather(*(one(number) for number in range(500)))
        return pacer.at_once

    return VirtualClock().run(traffic())


def test_calls_at_once_grow_while_all_is_well() -> None:
    assert crowd(0.0) > 64


def test_single_failures_do_not_slow_anybody_down() -> None:
    assert crowd(0.1) >= 64


def test_calls_at_once_shrink_where_failures_come_together() -> None:
    assert crowd(0.8) < 16
