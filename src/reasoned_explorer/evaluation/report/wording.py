"""How figures are written, and how a number is linked to its missions."""

import math
from urllib.parse import urlencode

#: What stands where there is no figure.
NONE = "–"


def share(value: float) -> str:
    """Return a figure in [0, 1] with two digits and no leading zero: ``.25``."""
    if math.isnan(value):
        return NONE
    text = f"{abs(value):.2f}"
    text = text.removeprefix("0") if text.startswith("0.") else text
    return f"−{text}" if value < 0 and text != ".00" else text


def signed(value: float) -> str:
    """Return a difference of such figures with its sign: ``+.10``, ``−.07``; ``.00`` has none."""
    text = share(value)
    return text if text in {".00", NONE} or text.startswith("−") else f"+{text}"


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


def link(**filters: object) -> str:
    """Return the address, inside the page, of the missions that a filter leaves; None is left out.

    Filters that the page understands: ``method``, ``level``, ``city``, ``place``, ``outcome`` (``success``, ``oracle``,
    ``small``, ``large`` or the key of a cause), ``radius`` (metres: success at this R), ``within`` (seconds: success
    with CT + TT up to it), ``versus`` with ``by`` (missions in which two methods differ in success or oracle success,
    or, with ``by=any``, all that both have).
    """
    return "#" + urlencode([(name, str(value)) for name, value in filters.items() if value is not None])
