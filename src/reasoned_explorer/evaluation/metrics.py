"""Tables of many scores, with intervals: pure functions, the same scores give the same table, to the last digit.

- **SR**, **OSR**, **OSR-seen**: shares of successes, oracle successes, and oracle successes that could be noticed.
- **SPL**, **soft-SPL**: means over all missions.
- **CASR**, computationally adjusted success rate (paper, section V-A): SR · mean(1 − (CT + TT)/T_max), the mean taken
  over all missions; a mission over time is a failure and has 0 in the mean.
- **CASR per mission**: mean(S · (1 − (CT + TT)/T_max)). The product of means above rewards a fast false halt: a failure
  that ends at once raises its second factor. This one does not; both stand in every table.
- **CASR paper-style**: the formula of the paper with only the planner's seconds as CT, as the authors' log counts them.
- **SR at R m**: SR at other success radii.
- **nDTW**: mean over the level-3 missions that have a reference way.
- **CT**, **TT**, **path length**: means over all missions; **distance to goal**: over those that have one.

What one mission scores stands in `scoring`, how intervals and tests work in `statistics`, both in ``docs/metrics.md``.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.evaluation.scoring import MissionScore
from reasoned_explorer.evaluation.statistics import (
    bootstrap_means,
    drawn_groups,
    group_sums,
    percentile_interval,
    sign_flip_test,
    wilson_interval,
)
from reasoned_explorer.model import Fault, InputError

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Places = Mapping[str, str]
# A bound that is less than this above the baseline leaves no headroom: sums differ by rounding.
_NO_ROOM = 1e-9

Column = Callable[[MissionScore], float]


def _success(item: MissionScore) -> float:
    return float(item.success)


def _success_at(radius_m: float) -> Column:
    return lambda item: float(dict(item.success_at)[radius_m])


def _finite(value: float | None) -> float:
    """Return a value, or NaN where a mission has none."""
    return value if value is not None and math.isfinite(value) else math.nan


#: A figure is the mean of a column over the missions that have it, or the product of the means of two.
_FIGURES: Mapping[str, tuple[Column, ...]] = {
    "SR": (_success,),
    "OSR": (lambda item: float(item.oracle_success),),
    "OSR-seen": (lambda item: float(item.oracle_seen),),
    "SPL": (lambda item: item.spl,),
    "soft-SPL": (lambda item: item.soft_spl,),
    "CASR": (_success, lambda item: item.time_factor),
    "CASR per mission": (lambda item: item.casr,),
    "CASR paper-style": (_success, lambda item: item.planner_time_factor),
    "nDTW": (lambda item: _finite(item.ndtw),),
    "CT": (lambda item: item.computing_s,),
    "TT": (lambda item: item.travelling_s,),
    "path length": (lambda item: item.path_length_m,),
    "distance to goal": (lambda item: _finite(item.distance_to_goal_m),),
}
_SHARES = ("SR", "OSR", "OSR-seen")
#: What `compare`, `headroom_closed` and `paired_differences` know: figures that every mission has, more is better.
COMPARED = ("SR", "OSR", "OSR-seen", "SPL", "soft-SPL", "CASR", "CASR per mission", "CASR paper-style")


@dataclass(frozen=True, slots=True)
class Metric:
    """One figure of a table.

    Attributes:
        name: E.g. ``"SR"``.
        value: NaN where no mission has it.
        low: Lower end of the interval.
        high: Upper end.
        count: Missions behind it.
        interval: How the interval was made: ``"Wilson"``, ``"bootstrap"`` (over missions), ``"clustered bootstrap"``
            (over places), or ``"none"`` where there is no value.
        p: Of a difference, by a paired permutation test; else None. It is not yet corrected for many comparisons.
    """

    name: str
    value: float
    low: float
    high: float
    count: int
    interval: str
    p: float | None = None


@dataclass(frozen=True, slots=True)
class MetricTable:
    """The figures of a set of missions.

    Attributes:
        vehicle: Name of the vehicle profile of all of them.
        count: Missions.
        metrics: In a fixed order.
        unreachable: Missions without a reference way; in SPL they count 0.
        confidence: Of the intervals, e.g. 0.95.
    """

    vehicle: str
    count: int
    metrics: tuple[Metric, ...]
    unreachable: int
    confidence: float

    def __getitem__(self, name: str) -> Metric:
        for metric in self.metrics:
            if metric.name == name:
                return metric
        raise KeyError(name)


def aggregate(
    scores: Sequence[MissionScore], *, places: Places | None = None, seed: int = 0, confidence: float = 0.95
) -> MetricTable:
    """Return the table of a set of missions.

    Intervals: with the places of the missions given, and at least two of them, a percentile bootstrap that draws places
    as a whole. Else missions are drawn, and shares (SR, OSR, OSR-seen, SR at other radii) have Wilson's interval.
    Shares have it, too, where all resamples are the same, as with no success at all: a bootstrap of what never varies
    would claim certainty. Both factors of CASR are drawn together.

    Args:
        scores: At least one; the order does not matter, ids must differ unless missions were repeated.
        places: Where each mission took place, by its id; None where missions are independent.
        seed: Of the bootstrap.
        confidence: Of the intervals, in (0, 1).

    Raises:
        InputError: If there is no mission, one has no place, or vehicles or time limits differ: these are never pooled.
    """
    listed = _checked(scores, confidence)
    radii = sorted(set.intersection(*({radius_m for radius_m, _ in item.success_at} for item in listed)))
    at_radius = {f"SR at {radius_m:g} m": (_success_at(radius_m),) for radius_m in radii}
    names = list(_FIGURES)
    before = names.index("nDTW")
    figures = {name: _FIGURES[name] for name in names[:before]}
    figures |= at_radius | {name: _FIGURES[name] for name in names[before:]}
    shares = {*_SHARES, *at_radius}
    return MetricTable(
        vehicle=listed[0].vehicle,
        count=len(listed),
        metrics=tuple(
            _metric(name, columns, listed, places=places, seed=seed, confidence=confidence, is_share=name in shares)
            for name, columns in figures.items()
        ),
        unreachable=sum(math.isinf(item.reference_length_m) for item in listed),
        confidence=confidence,
    )


def by_level(
    scores: Sequence[MissionScore], *, places: Places | None = None, seed: int = 0, confidence: float = 0.95
) -> dict[int | None, MetricTable]:
    """Return a table for each level that there is, and one for all missions under None.

    Raises:
        InputError: As `aggregate`.
    """
    levels: list[int | None] = [*sorted({item.level for item in scores}), None]
    return {
        level: aggregate(
            [item for item in scores if level is None or item.level == level],
            places=places,
            seed=seed,
            confidence=confidence,
        )
        for level in levels
    }


def compare(
    first: Sequence[MissionScore],
    second: Sequence[MissionScore],
    *,
    places: Places | None = None,
    seed: int = 0,
    confidence: float = 0.95,
) -> MetricTable:
    """Return by how much the first method is better than the second on the same missions.

    Paired: missions with the same id are drawn together, so that what they have in common (an easy world, a far goal)
    does not blur the difference. Differences of `COMPARED`, with bootstrap intervals as in `aggregate`, and with the p
    of a permutation test in which the two methods are swapped, place by place (mission by mission without places). An
    interval of no width says that all missions differ alike, not that the difference is certain: read p.

    Raises:
        InputError: If the ids of the two sets differ or stand twice, or as `aggregate`.
    """
    ours, theirs = _paired({"first": first, "second": second}, confidence)
    groups, interval = drawn_groups(_ids(ours), places)
    metrics = []
    for name in COMPARED:
        mine, other = (_values(listed, _FIGURES[name]) for listed in (ours, theirs))
        whole, drawn = bootstrap_means(np.concatenate((mine, other), axis=1), groups, seed=seed)
        width = mine.shape[1]
        ahead = _product(drawn[:, :width]) - _product(drawn[:, width:])
        low, high = percentile_interval(ahead, confidence=confidence)
        value = float(_product(whole[:width]) - _product(whole[width:]))
        p = sign_flip_test(group_sums(_differences(mine, other)[:, None], groups)[:, 0], seed=seed)
        metrics.append(Metric(name, value, low, high, len(ours), interval, p))
    return MetricTable(
        vehicle=ours[0].vehicle,
        count=len(ours),
        metrics=tuple(metrics),
        unreachable=sum(math.isinf(item.reference_length_m) for item in ours),
        confidence=confidence,
    )


def headroom_closed(
    method: Sequence[MissionScore],
    baseline: Sequence[MissionScore],
    bound: Sequence[MissionScore],
    *,
    name: str = "SR",
    places: Places | None = None,
    seed: int = 0,
    confidence: float = 0.95,
) -> Metric | None:
    """Return which share of the way from a baseline to a bound a method has come: (m − b) / (B − b).

    Below 0 it is worse than the baseline, above 1 better than the bound. All three are drawn together, on the same
    missions. A resample in which the bound is not above the baseline has no share: it counts as −∞ at the lower end and
    as +∞ at the upper one, so that the interval is open on a side where there are too many of them.

    Args:
        method: Whose share it is.
        baseline: What it starts from.
        bound: What can be reached, e.g. perfect foresight.
        name: Of the figure, one of `COMPARED`.
        places: As in `aggregate`.
        seed: Of the bootstrap.
        confidence: Of the interval.

    Returns:
        None where the bound is not above the baseline: there is no headroom.

    Raises:
        InputError: If there is no such figure, or as `compare`.
    """
    columns = _columns(name)
    sets = _paired({"method": method, "baseline": baseline, "bound": bound}, confidence)
    groups, interval = drawn_groups(_ids(sets[0]), places)
    whole, drawn = bootstrap_means(
        np.concatenate([_values(listed, columns) for listed in sets], axis=1), groups, seed=seed
    )

    def share(means: Floats) -> Floats:
        reached, low, high = (_product(part) for part in np.split(means, 3, axis=-1))
        room = high - low
        return np.where(room > _NO_ROOM, (reached - low) / np.where(room > _NO_ROOM, room, 1.0), np.nan)

    value = float(share(whole))
    if math.isnan(value):
        return None
    low, high = percentile_interval(share(drawn), confidence=confidence)
    return Metric(f"headroom closed ({name})", value, low, high, len(sets[0]), interval)


def mean_of(
    name: str, values: Mapping[str, float], *, places: Places | None = None, seed: int = 0, confidence: float = 0.95
) -> Metric:
    """Return the mean of what missions have beside their scores, e.g. calls.

    Args:
        name: Of the figure.
        values: By mission id, at least one.
        places: As in `aggregate`.
        seed: Of the bootstrap.
        confidence: Of the interval.

    Raises:
        InputError: If there is no value, or a mission has no place.
    """
    if not values:
        raise InputError("values to average", [Fault("there is no mission", "at least one")])
    ids = sorted(values)  # one order whatever order they come in
    groups, interval = drawn_groups(ids, places)
    means, drawn = bootstrap_means(np.asarray([[values[name]] for name in ids]), groups, seed=seed)
    low, high = percentile_interval(drawn[:, 0], confidence=confidence)
    return Metric(name, float(means[0]), low, high, len(ids), interval)


def paired_differences(
    first: Sequence[MissionScore], second: Sequence[MissionScore], *, name: str = "SR"
) -> dict[str, float]:
    """Return what each mission, by its id, adds to the difference of two methods; their mean is the difference.

    For CASR, a product of means, a mission's part is s̄ · Δt + t̄ · Δs, with s̄ and t̄ the means of both methods: exact in
    sum. For `statistics.missions_needed`.

    Raises:
        InputError: If there is no such figure, or as `compare`.
    """
    columns = _columns(name)
    ours, theirs = _paired({"first": first, "second": second}, 0.95)
    parts = _differences(_values(ours, columns), _values(theirs, columns))
    return {item.mission_id: float(part) for item, part in zip(ours, parts, strict=True)}


def _columns(name: str) -> tuple[Column, ...]:
    if name not in COMPARED:
        raise InputError("comparison", [Fault(f"there is no figure {name!r} to compare", ", ".join(COMPARED))])
    return _FIGURES[name]


def _values(listed: Sequence[MissionScore], columns: Sequence[Column]) -> Floats:
    """Return the columns of missions, shape (missions, columns)."""
    return np.asarray([[of(item) for of in columns] for item in listed], dtype=np.float64)


def _product(means: Floats) -> Floats:
    return np.asarray(np.prod(means, axis=-1))


def _differences(mine: Floats, other: Floats) -> Floats:
    """Return what each mission adds to the difference of two figures, shape (n,), so that their mean is the difference.

    Swapping the two methods in a mission flips the sign of its part and leaves the others' parts as they are, for a
    product of two means, too: with s̄ = (s + s')/2 and t̄ likewise, s t − s' t' = s̄ (t − t') + t̄ (s − s').
    """
    apart = mine - other
    if mine.shape[1] == 1:
        return apart[:, 0]
    middle = (mine + other).mean(axis=0) / 2.0
    return np.asarray(middle[1] * apart[:, 0] + middle[0] * apart[:, 1])


def _ids(listed: Sequence[MissionScore]) -> list[str]:
    return [item.mission_id for item in listed]


def _metric(
    name: str,
    columns: Sequence[Column],
    listed: Sequence[MissionScore],
    *,
    places: Places | None,
    seed: int,
    confidence: float,
    is_share: bool,
) -> Metric:
    """Return a figure: the product of its columns' means over the missions that have it."""
    having = [item for item in listed if not any(math.isnan(of(item)) for of in columns)]
    if not having:
        return Metric(name, math.nan, math.nan, math.nan, 0, "none")
    values, count = _values(having, columns), len(having)
    groups, interval = drawn_groups(_ids(having), places)
    if is_share and interval == "bootstrap":
        return _wilson(name, values, confidence)
    means, drawn = bootstrap_means(values, groups, seed=seed)
    products = _product(drawn)
    if is_share and float(products.min()) == float(products.max()):
        return _wilson(name, values, confidence)
    low, high = percentile_interval(products, confidence=confidence)
    return Metric(name, float(_product(means)), low, high, count, interval)


def _wilson(name: str, values: Floats, confidence: float) -> Metric:
    hits, count = int(values.sum()), len(values)
    low, high = wilson_interval(hits, count, confidence=confidence)
    return Metric(name, hits / count, low, high, count, "Wilson")


def _checked(scores: Iterable[MissionScore], confidence: float) -> list[MissionScore]:
    # One order whatever order they come in: sums of floats depend on it.
    listed = sorted(scores, key=lambda item: (item.mission_id, item.path_length_m, item.computing_s, item.travelling_s))
    faults = []
    if not listed:
        faults.append(Fault("there is no mission", "at least one"))
    if not 0.0 < confidence < 1.0:
        faults.append(Fault(f"confidence is {confidence}", "a number in (0, 1)"))
    vehicles = sorted({item.vehicle for item in listed})
    if len(vehicles) > 1:
        faults.append(
            Fault(f"vehicles {', '.join(vehicles)} in one set", "one vehicle profile", "make a table for each")
        )
    limits = sorted({item.time_limit_s for item in listed})
    if len(limits) > 1:
        faults.append(Fault(f"time limits {limits} in one set", "one T_max", "make a table for each"))
    if faults:
        raise InputError("missions to aggregate", faults)
    return listed


def _paired(sets: Mapping[str, Sequence[MissionScore]], confidence: float) -> list[list[MissionScore]]:
    """Return sets of the same missions, each in the order of ids."""
    listed = {name: _checked(scores, confidence) for name, scores in sets.items()}
    ids = {name: {item.mission_id for item in scores} for name, scores in listed.items()}
    faults = [
        Fault(f"the {name} set holds a mission twice", "each mission once")
        for name, scores in listed.items()
        if len(ids[name]) < len(scores)
    ]
    everything = set[str]().union(*ids.values())
    odd = sorted(everything - everything.intersection(*ids.values()))
    if odd:
        faults.append(Fault(f"{len(odd)} missions are not in every set, {odd[0]!r} first", "the same missions in all"))
    if len({(scores[0].vehicle, scores[0].time_limit_s) for scores in listed.values()}) > 1:
        faults.append(Fault("vehicles or time limits of the sets differ", "the same vehicle and time limit"))
    if faults:
        raise InputError("comparison", faults)
    return list(listed.values())
