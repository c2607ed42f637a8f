import time
from email.utils import formatdate

import pytest

from reasoned_explorer.calls.rate_headers import RateState, rate_state, retry_after_s


@pytest.mark.parametrize(
    ("headers", "seconds"),
    [
        ({"retry-after": "20"}, 20.0),
        ({"retry-after-ms": "250", "retry-after": "1"}, 0.25),
        ({"retry-after": "0"}, 0.0),
        ({}, None),
        ({"retry-after": "soon"}, None),
        ({"retry-after": "-3"}, None),
        ({"retry-after": "nan"}, None),
    ],
)
def test_retry_after(headers: dict[str, str], seconds: float | None) -> None:
    assert retry_after_s(headers) == seconds


def test_retry_after_may_be_a_date() -> None:
    seconds = retry_after_s({"retry-after": formatdate(time.time() + 3600.0, usegmt=True)})
    assert seconds is not None
    assert 3500.0 < seconds <= 3601.0


def told(limit: str, remaining: str, reset: str) -> dict[str, str]:
    return {
        "x-ratelimit-limit-requests": limit,
        "x-ratelimit-remaining-requests": remaining,
        "x-ratelimit-reset-requests": reset,
    }


@pytest.mark.parametrize(
    ("headers", "state"),
    [
        (told("5000", "4999", "12ms"), RateState(5000.0, 4999.0, pytest.approx(83.3, abs=0.1))),
        (told("60", "0", "1m0s"), RateState(60.0, 0.0, 1.0)),
        (told("10000", "9990", "1m26.4s"), RateState(10000.0, 9990.0, pytest.approx(10 / 86.4))),
        (told("60", "60", "0s"), RateState(60.0, 60.0, None)),
        (told("60", "30", "2026-01-01T00:00:00Z"), RateState(60.0, 30.0, None)),
        (told("-1", "-1", "0"), None),
        ({}, None),
    ],
)
def test_the_state_of_a_limit(headers: dict[str, str], state: RateState | None) -> None:
    assert rate_state(headers, "requests") == state
    assert rate_state(headers, "tokens") is None
