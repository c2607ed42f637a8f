"""What captioners are made with."""

from collections.abc import Awaitable, Callable
from dataclasses import dataclass

from reasoned_explorer.clock import Clock


async def charge_nothing(role: str, key: tuple[int, ...], count: int) -> None:
    """Let no time pass and write nothing down."""


@dataclass(frozen=True, slots=True)
class CaptionerContext:
    """What a captioner's factory is called with.

    Attributes:
        clock: Of the mission.
        seed: Of the mission; draws are keyed by it and by the views' keys.
        charge: For captioners whose calls are modelled: awaited once for each batch with the role (``"captioner"``),
            the first view's key and the number of calls; it lets the seconds pass that a latency profile says and
            writes the calls to the ledger. Captioners that call a real model measure and write for themselves.
    """

    clock: Clock
    seed: int = 0
    charge: Callable[[str, tuple[int, ...], int], Awaitable[None]] = charge_nothing
