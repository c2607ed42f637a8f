"""What every call of a mind cost: seconds, tokens and money."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from reasoned_explorer.calls.chat import is_model_name
from reasoned_explorer.model.record import CallRecord

__all__ = ["CallRecord", "Ledger", "RoleTotals", "lost_calls"]


@dataclass(frozen=True, slots=True)
class RoleTotals:
    """What the calls of one role add up to.

    Attributes:
        calls: How many.
        faults: How many of them were not answered.
        cached: How many came from a store.
        retries: How often calls were asked again.
        latency_s: Sum of the calls' seconds, more than the time waited where calls ran at the same time.
        tokens_in: Tokens sent.
        tokens_out: Tokens received.
        usd: US dollars of all calls whose price is known.
        unpriced: How many calls have no known price.
    """

    calls: int = 0
    faults: int = 0
    cached: int = 0
    retries: int = 0
    latency_s: float = 0.0
    tokens_in: int = 0
    tokens_out: int = 0
    usd: float = 0.0
    unpriced: int = 0


def lost_calls(calls: Iterable[CallRecord]) -> list[CallRecord]:
    """Return those calls of real models that have no answer, in order."""
    return [call for call in calls if call.fault is not None and is_model_name(call.model)]


class Ledger:
    """All calls of one mission, in the order in which they were written down.

    Modelled calls are written down when they are asked, real ones when they end, by the mission's clock.

    Attributes:
        on_call: Told each call that is written down by itself, as real ones are; None for nobody.
    """

    def __init__(self) -> None:
        self._calls: list[CallRecord] = []
        self.on_call: Callable[[CallRecord], None] | None = None

    def add(self, call: CallRecord) -> None:
        """Write a call down."""
        self._calls.append(call)
        if self.on_call is not None:
            self.on_call(call)

    def add_all(self, calls: Iterable[CallRecord]) -> None:
        """Write several calls down, in order."""
        self._calls.extend(calls)

    @property
    def calls(self) -> tuple[CallRecord, ...]:
        """Every call so far."""
        return tuple(self._calls)

    def since(self, count: int) -> tuple[CallRecord, ...]:
        """Return the calls after the first ``count``: what a step added, for whoever writes as it happens."""
        return tuple(self._calls[count:])

    def __len__(self) -> int:
        return len(self._calls)

    def totals(self) -> dict[str, RoleTotals]:
        """Return the totals of each role that was asked, sorted by role."""
        return {role: self._total(role) for role in sorted({call.role for call in self._calls})}

    def _total(self, role: str) -> RoleTotals:
        calls = [call for call in self._calls if call.role == role]
        return RoleTotals(
            calls=len(calls),
            faults=sum(call.fault is not None for call in calls),
            cached=sum(call.cached for call in calls),
            retries=sum(call.retries for call in calls),
            latency_s=sum(call.latency_s for call in calls),
            tokens_in=sum(call.tokens_in for call in calls),
            tokens_out=sum(call.tokens_out for call in calls),
            usd=sum(call.usd for call in calls if call.usd is not None),
            unpriced=sum(call.usd is None for call in calls),
        )
