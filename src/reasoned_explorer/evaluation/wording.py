"""How figures are written, on the screen and on a page."""

import math
from collections.abc import Callable

from reasoned_explorer.evaluation.metrics import Metric

#: What stands where there is no figure.
NONE = "–"


def share(value: float, digits: int = 2) -> str:
    """Return a number without its leading zero, and with a true minus: ``.25``, ``−.03``, ``1.00``."""
    if math.isnan(value):
        return NONE
    text = f"{abs(value):.{digits}f}" if math.isfinite(value) else "∞"
    sign = "−" if value < 0.0 and text.strip("0.") else ""
    return sign + (text.removeprefix("0") if text.startswith("0.") else text)


def whole(value: float) -> str:
    """Return a number without a fraction."""
    return share(value, 0)


def signed(value: float) -> str:
    """Return a difference of such figures with its sign: ``+.10``, ``−.07``; ``.00`` has none."""
    text = share(value)
    return f"+{text}" if value > 0.0 and text != ".00" else text


def amount(value: float) -> str:
    """Return a mean of seconds, calls or tokens with three digits that count."""
    if math.isnan(value):
        return NONE
    if value >= 99_500.0:
        return f"{value / 1000.0:,.0f}k"
    if value >= 9_950.0:
        return f"{value / 1000.0:.1f}k"
    if value >= 99.5 or value == 0.0:
        return f"{value:,.0f}"
    return f"{value:.1f}" if value >= 9.95 else f"{value:.2f}"


def money(value: float) -> str:
    """Return US dollars; fractions of a cent are not lost."""
    if math.isnan(value):
        return NONE
    return f"{value:.2f}" if value >= 0.1 or value == 0.0 else f"{value:.4f}"


def level_name(level: int | None) -> str:
    """Return what a level is called; None is all of them."""
    return "all" if level is None else f"L{level}"


def minutes(seconds: float) -> str:
    """Return seconds as minutes, without a fraction where there is none."""
    return f"{seconds / 60.0:g}"


def figure(metric: Metric | None, write: Callable[[float], str] = share, *, interval: bool = True) -> str:
    """Return a figure with its interval: ``.25 [.15, .39]``; a dash where there is none."""
    if metric is None or metric.count == 0:
        return NONE
    return f"{write(metric.value)} {ends(metric, write)}" if interval else write(metric.value)


def ends(metric: Metric, write: Callable[[float], str] = share) -> str:
    """Return the interval of a figure: ``[.15, .39]``."""
    return f"[{write(metric.low)}, {write(metric.high)}]"
