"""What the report computes beyond the figures of `evaluation.metrics`: other limits, and ranks of methods."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.evaluation.metrics import Metric, Places
from reasoned_explorer.evaluation.scoring import MissionScore
from reasoned_explorer.evaluation.statistics import bootstrap_means, drawn_groups, percentile_interval

Floats = NDArray[np.float64]

#: As in `evaluation.metrics`: what rounding may add to a sum of seconds.
_TIME_SLACK_S = 1e-6


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


def rank_correlation(
    methods: Sequence[Sequence[MissionScore]], of: str, *, places: Places | None = None, seed: int
) -> Correlation | None:
    """Return Spearman's rank correlation of mean CT with CASR or with mean TT over methods.

    The interval is of missions, not of methods: places are drawn anew, each with all its missions and the same for all
    methods, and the ranks of the methods are taken again (percentile bootstrap). A draw in which all methods tie counts
    as 0.

    Args:
        methods: For each method its scores, the same missions in the same order.
        of: ``"CASR"`` or ``"TT"``.
        places: Where each mission took place, by its id; None where missions are independent.
        seed: Of the bootstrap.

    Returns:
        None with fewer than `LEAST_METHODS` methods, without missions, or where all methods tie.
    """
    if len(methods) < LEAST_METHODS or not methods[0]:
        return None
    groups, interval = drawn_groups([item.mission_id for item in methods[0]], places)
    first, second = [], []
    for scores in methods:
        columns = np.asarray(
            [[item.computing_s, item.travelling_s, float(item.success), item.time_factor] for item in scores]
        )
        whole, drawn = bootstrap_means(columns, groups, seed=seed)
        ct_s, tt_s, success, factor = np.vstack([whole, drawn]).T
        first.append(ct_s)
        second.append(tt_s if of == "TT" else success * factor)
    ranked = _spearman(np.asarray(first), np.asarray(second))
    if np.isnan(ranked[0]):
        return None
    low, high = percentile_interval(np.nan_to_num(ranked[1:], nan=0.0))
    return Correlation(f"ρ(CT, {of})", float(ranked[0]), low, high, len(methods), interval)


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
