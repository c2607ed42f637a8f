"""What the report computes itself: CASR at other limits, and how CT goes with CASR."""

import pytest

from reasoned_explorer.evaluation.metrics import aggregate
from reasoned_explorer.evaluation.report.scores import (
    Correlation,
    at_limit,
    casr_at,
    rank_correlation,
)
from tests.evaluation.report.rows import made_row, many_rows


def test_casr_at_the_runs_own_limit_is_the_tables() -> None:
    scores = [row.score for row in many_rows(40, ("llm-rrt",))]
    assert casr_at(scores, 1800.0) == pytest.approx(aggregate(scores)["CASR"].value, abs=1e-12)


def test_what_took_longer_than_a_shorter_limit_is_a_failure() -> None:
    quick, slow = made_row(ct_s=200.0, tt_s=100.0).score, made_row(ct_s=500.0, tt_s=100.0).score
    # By hand, T = 400 s: SR = 1/2, time factors 1/4 and 0.
    assert casr_at([quick, slow], 400.0) == pytest.approx(0.5 * 0.125)
    assert not at_limit(slow, 400.0).success
    assert at_limit(slow, 400.0).casr == 0.0
    assert at_limit(slow, 600.0).success, "exactly T_max is in time"
    assert at_limit(quick, 400.0).success_at == quick.success_at
    assert not any(hit for _, hit in at_limit(slow, 400.0).success_at)


def test_casr_never_falls_when_there_is_more_time() -> None:
    scores = [row.score for row in many_rows(40, ("llm-rrt",))]
    values = [casr_at(scores, 60.0 * limit) for limit in range(5, 31)]
    assert values == sorted(values)
    assert values[0] < values[-1]


def _method(ct_s: float, successes: int) -> list:
    return [made_row("m", at, ct_s=ct_s + at, tt_s=100.0, in_place=at < successes).score for at in range(40)]


def test_more_thinking_that_finds_more_is_positive_and_the_other_way_round_negative() -> None:
    rising = [_method(100.0 * place, 8 * place) for place in range(1, 6)]
    falling = [_method(100.0 * place, 45 - 8 * place) for place in range(1, 6)]
    positive, negative = (rank_correlation(methods, "CASR", seed=0) for methods in (rising, falling))
    assert positive is not None
    assert negative is not None
    assert (positive.value, positive.reading, positive.count) == (pytest.approx(1.0), "positive", 5)
    assert (negative.value, negative.reading) == (pytest.approx(-1.0), "negative")


def test_an_interval_that_holds_everything_is_undecided_and_not_steady() -> None:
    assert Correlation("ρ", 0.1, -0.6, 0.7, 5, "bootstrap").reading == "undecided"
    assert Correlation("ρ", 0.1, -0.2, 0.25, 5, "bootstrap").reading == "steady"


def test_three_methods_or_all_the_same_are_too_little_for_ranks() -> None:
    assert rank_correlation([_method(100.0 * place, 8) for place in range(1, 4)], "CASR", seed=0) is None
    assert rank_correlation([_method(100.0, 0) for _ in range(5)], "CASR", seed=0) is None
    assert rank_correlation([[], [], [], []], "CASR", seed=0) is None
