"""What the headers of an answer say about limits: ``Retry-After`` (RFC 9110, 10.2.3) and OpenAI's ``x-ratelimit-*``."""

import math
import re
import time
from collections.abc import Mapping
from dataclasses import dataclass
from email.utils import parsedate_to_datetime

_PART = re.compile(r"(\d+(?:\.\d+)?)(ms|s|m|h|d)")
_SECONDS = {"ms": 1e-3, "s": 1.0, "m": 60.0, "h": 3600.0, "d": 86400.0}


@dataclass(frozen=True, slots=True)
class RateState:
    """The state of one limit at the server.

    Attributes:
        limit: When nothing is spent.
        remaining: What may still be spent.
        refill_per_s: How much comes back a second, or None where it does not show.
    """

    limit: float
    remaining: float
    refill_per_s: float | None


def retry_after_s(headers: Mapping[str, str]) -> float | None:
    """Return the seconds after which the server wants to be asked again, or None where it does not say.

    ``retry-after-ms`` goes before ``retry-after``, which may be seconds or a date.
    """
    for name, scale in (("retry-after-ms", 1e-3), ("retry-after", 1.0)):
        seconds = _number(headers.get(name))
        if seconds is not None and seconds >= 0.0:
            return seconds * scale
    text = headers.get("retry-after")
    if not text:
        return None
    try:
        return max(0.0, parsedate_to_datetime(text).timestamp() - time.time())
    except (TypeError, ValueError, OverflowError, OSError):
        return None


def rate_state(headers: Mapping[str, str], what: str) -> RateState | None:
    """Return the state of a limit, or None where the headers do not tell it or tell nonsense (Azure sends -1).

    The reset time is that until nothing is spent any more, so that what is spent over it is the refill.

    Args:
        headers: Of the answer.
        what: ``requests`` or ``tokens``.
    """
    limit = _number(headers.get(f"x-ratelimit-limit-{what}"))
    remaining = _number(headers.get(f"x-ratelimit-remaining-{what}"))
    if limit is None or remaining is None or limit <= 0.0 or remaining < 0.0:
        return None
    reset_s = _duration_s(headers.get(f"x-ratelimit-reset-{what}"))
    spent = limit - remaining
    refill_per_s = spent / reset_s if spent > 0.0 and reset_s is not None and reset_s > 0.0 else None
    return RateState(limit, remaining, refill_per_s)


def _number(text: str | None) -> float | None:
    try:
        number = float(text) if text else math.nan
    except ValueError:
        return None
    return number if math.isfinite(number) else None


def _duration_s(text: str | None) -> float | None:
    """Read ``6m0s``, ``1h2m``, ``20ms``, ``8.64s`` or bare seconds."""
    bare = _number(text)
    if bare is not None or not text:
        return bare
    parts = _PART.findall(text)
    if not parts or "".join(number + unit for number, unit in parts) != text.strip():
        return None
    return sum(float(number) * _SECONDS[unit] for number, unit in parts)
