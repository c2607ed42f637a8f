"""What the report computes beyond the metrics of `evaluation.metrics`, and its one door to them.

All other modules of the report import metrics from here.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.evaluation.metrics import Metric, MetricTable, aggregate, by_level, compare
from reasoned_explorer.evaluation.scoring import MissionScore
from reasoned_explorer.evaluation.statistics import RESAMPLES
from reasoned_explorer.model.draws import key_of

__all__ = [
    "Correlation",
    "Metric",
    "MetricTable",
    "MissionScore",
    "aggregate",
    "at_limit",
    "by_level",
    "casr_at",
    "compare",
    "elapsed_s",
    "mean_of",
    "rank_correlation",
]

Floats = NDArray[np.float64]

#: As in `evaluation.metrics`: what rounding may add to a sum of seconds.
_TIME_SLACK_S = 1e-6
CONFIDENCE = 0.95


def elapsed_s(score: MissionScore) -> float:
    """Return CT + TT, seconds."""
    return score.computing_s + score.travelling_s


def at_limit(score: MissionScore, limit_s: float) -> MissionScore:
    """Return the score with a shorter T_max: what took longer is a failure.

    The mission itself is not run again: a planner that would hurry under a shorter limit does not do so here.
    ``planner_time_factor`` is not recomputed and must not be used.
    """
    spent_s = elapsed_s(score)
    over_time = spent_s > limit_s + _TIME_SLACK_S
    success = score.success and not over_time
    time_factor = 0.0 if over_time else min(1.0, max(0.0, 1.0 - spent_s / limit_s))
    return replace(
        score,
        success=success,
        success_at=tuple((radius_m, hit and not over_time) for radius_m, hit in score.success_at),
        over_time=over_time,
        spl=score.spl if success else 0.0,
        time_factor=time_factor,
        casr=time_factor if success else 0.0,
        time_limit_s=limit_s,
    )


def casr_at(scores: Sequence[MissionScore], limit_s: float) -> float:
    """Return CASR = SR · mean(1 − (CT + TT)/T) at the limit T, the mean over all missions."""
    cut = [at_limit(item, limit_s) for item in scores]
    return float(np.mean([item.success for item in cut]) * np.mean([item.time_factor for item in cut]))


def mean_of(name: str, values: Sequence[float], *, seed: int) -> Metric:
    """Return the mean of values, one a mission, with a bootstrap interval over missions."""
    column = np.sort(np.asarray(values, dtype=np.float64))  # one order whatever order they come in
    means = np.mean(column[_draws(len(column), seed)], axis=1)
    low, high = _ends(means)
    return Metric(name, float(np.mean(column)), low, high, len(column), "bootstrap")


class Correlation(Metric):
    """Spearman's rank correlation between methods; ``count`` is the number of methods."""

    __slots__ = ()

    @property
    def reading(self) -> str:
        """What the interval allows to say: positive, negative, steady, or undecided.

        Steady needs more than an interval that holds 0: it must lie within ±`STEADY_WITHIN` altogether.
        """
        if self.low > 0.0:
            return "positive"
        if self.high < 0.0:
            return "negative"
        if self.low >= -STEADY_WITHIN and self.high <= STEADY_WITHIN:
            return "steady"
        return "undecided"


#: How near to 0 a whole interval must lie for two things to be called unrelated.
STEADY_WITHIN = 0.3
#: With fewer methods than this, ranks say nothing.
LEAST_METHODS = 4


def rank_correlation(methods: Sequence[Sequence[MissionScore]], of: str, *, seed: int) -> Correlation | None:
    """Return Spearman's rank correlation of mean CT with CASR or with mean TT over methods.

    The interval is of missions, not of methods: the missions are drawn anew, the same for all methods, and the ranks
    of the methods are taken again (percentile bootstrap). A draw in which all methods tie counts as 0.

    Args:
        methods: For each method its scores, the same missions in the same order.
        of: ``"CASR"`` or ``"TT"``.
        seed: Of the bootstrap.

    Returns:
        None with fewer than `LEAST_METHODS` methods, without missions, or where all methods tie.
    """
    if len(methods) < LEAST_METHODS or not methods[0]:
        return None
    draws = np.vstack([np.arange(len(methods[0])), _draws(len(methods[0]), seed)])
    first, second = [], []
    for scores in methods:
        ct_s = np.asarray([item.computing_s for item in scores])
        first.append(np.mean(ct_s[draws], axis=1))
        if of == "TT":
            tt_s = np.asarray([item.travelling_s for item in scores])
            second.append(np.mean(tt_s[draws], axis=1))
            continue
        success = np.asarray([item.success for item in scores], dtype=np.float64)
        factor = np.asarray([item.time_factor for item in scores])
        second.append(np.mean(success[draws], axis=1) * np.mean(factor[draws], axis=1))
    drawn = _spearman(np.asarray(first), np.asarray(second))
    if np.isnan(drawn[0]):
        return None
    low, high = _ends(np.nan_to_num(drawn[1:], nan=0.0))
    return Correlation(f"ρ(CT, {of})", float(drawn[0]), low, high, len(methods), "bootstrap")


def _spearman(first: Floats, second: Floats) -> Floats:
    """Return the rank correlation of each column of two arrays (methods, draws); NaN where one is all ties."""
    ranks = []
    for values in (first, second):
        below = (values[None, :, :] < values[:, None, :] - 1e-12).sum(axis=1)
        tied = (np.abs(values[None, :, :] - values[:, None, :]) <= 1e-12).sum(axis=1)
        ranks.append(below + 0.5 * (tied + 1))
    centred = [rank - rank.mean(axis=0) for rank in ranks]
    scale = np.sqrt((centred[0] ** 2).sum(axis=0) * (centred[1] ** 2).sum(axis=0))
    with np.errstate(invalid="ignore", divide="ignore"):
        return np.asarray(np.where(scale > 0.0, (centred[0] * centred[1]).sum(axis=0) / scale, np.nan))


def _draws(count: int, seed: int) -> NDArray[np.int64]:
    bulk = np.random.Generator(np.random.PCG64(key_of(seed, "report", count)))
    return bulk.integers(0, count, size=(RESAMPLES, count))


def _ends(resampled: Floats) -> tuple[float, float]:
    tail = 50.0 * (1.0 - CONFIDENCE)
    low, high = (float(value) for value in np.percentile(resampled, [tail, 100.0 - tail]))
    return low, high
