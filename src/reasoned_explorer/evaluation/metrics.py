"""What missions score. Pure functions: the same outcomes give the same table, to the last digit.

- **SR**, success rate: declared in place and in time, with the goal's conditions kept.
- **OSR**, oracle success rate: at some moment of the track a declaration would have succeeded.
- **SPL**, success weighted by path length (Anderson et al., "On evaluation of embodied navigation agents", 2018,
  arXiv 1807.06757): mean of S · l / max(p, l), l the shortest compliant way to success, p the way that was travelled.
- **CASR**, computationally adjusted success rate (paper, section V-A): SR · mean(1 − (CT + TT)/T_max), the mean taken
  over all missions; a mission over time is a failure and has 0 in the mean.
- **CASR per mission**: mean(S · (1 − (CT + TT)/T_max)). The product of means above rewards a fast false halt: a failure
  that ends at once raises its second factor. This one does not; both stand in every table.
- **CASR paper-style**: the formula of the paper with only the planner's seconds as CT, as the authors' log counts them.

Times: CT, every second that the robot waits for a decision, captions and checks included; TT, travelling.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from statistics import NormalDist
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.model import Fault, InputError, TrackPoint
from reasoned_explorer.model.draws import key_of

if TYPE_CHECKING:
    # Reading a table must not load the world.
    from reasoned_explorer.task.judge import Judge

#: Resamples of a bootstrap.
RESAMPLES = 2000
_TIME_SLACK_S = 1e-6

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class MissionOutcome:
    """What came of one mission.

    Attributes:
        mission_id: Of its episode.
        level: Of its goal, 1 to 4.
        vehicle: Name of the vehicle profile; profiles are never pooled in one number.
        declared: The agent said "Found Goal".
        in_place: The judge's answer to where the mission ended, declared or not, the way there included.
        in_place_at: The same at other radii: (metres, answer).
        oracle_success: The judge's answer to the whole track.
        path_length_m: Travelled, metres.
        reference_length_m: The shortest compliant way to success, metres; infinity where there is none.
        computing_s: CT, seconds.
        planner_computing_s: The planner's share of CT, seconds.
        travelling_s: TT, seconds.
        time_limit_s: T_max, seconds.
        distance_to_goal_m: From the end to the nearest thing that satisfies, metres; infinity where there is none.
    """

    mission_id: str
    level: int
    vehicle: str
    declared: bool
    in_place: bool
    oracle_success: bool
    path_length_m: float
    reference_length_m: float
    computing_s: float
    travelling_s: float
    planner_computing_s: float = 0.0
    time_limit_s: float = 1800.0
    distance_to_goal_m: float = math.inf
    in_place_at: tuple[tuple[float, bool], ...] = ()

    def __post_init__(self) -> None:
        """Check the values.

        Raises:
            InputError: With everything that is wrong.
        """
        faults = []
        if self.level not in {1, 2, 3, 4}:
            faults.append(Fault(f"level is {self.level}", "1, 2, 3 or 4"))
        for name in ("path_length_m", "computing_s", "travelling_s", "planner_computing_s"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value >= 0.0):
                faults.append(Fault(f"{name} is {value}", "a finite number, 0 or more"))
        for name in ("reference_length_m", "distance_to_goal_m"):
            value = getattr(self, name)
            if not value >= 0.0:
                faults.append(Fault(f"{name} is {value}", "0 or more; infinity where there is none"))
        if not (math.isfinite(self.time_limit_s) and self.time_limit_s > 0.0):
            faults.append(Fault(f"time_limit_s is {self.time_limit_s}", "a finite number above 0"))
        if self.planner_computing_s > self.computing_s + _TIME_SLACK_S:
            what = f"planner_computing_s is {self.planner_computing_s}, computing_s {self.computing_s}"
            faults.append(Fault(what, "a share of computing_s"))
        if faults:
            raise InputError(f"outcome of mission {self.mission_id!r}", faults)


@dataclass(frozen=True, slots=True)
class MissionScore:
    """What one mission scores.

    Attributes:
        mission_id: Of its episode.
        level: Of its goal.
        vehicle: Name of the vehicle profile.
        success: Declared, in place, and in time.
        success_at: The same at other radii: (metres, success).
        oracle_success: At some moment a declaration would have succeeded.
        over_time: CT + TT exceeded T_max.
        spl: S · l / max(p, l), in [0, 1].
        time_factor: 1 − (CT + TT)/T_max, in [0, 1]; 0 when over time.
        planner_time_factor: The same with the planner's CT only.
        casr: S · time_factor: this mission's term of CASR per mission.
        path_length_m: Travelled, metres.
        reference_length_m: The shortest compliant way, metres; may be infinite.
        computing_s: CT.
        travelling_s: TT.
        time_limit_s: T_max.
        distance_to_goal_m: At the end, metres; may be infinite.
    """

    mission_id: str
    level: int
    vehicle: str
    success: bool
    success_at: tuple[tuple[float, bool], ...]
    oracle_success: bool
    over_time: bool
    spl: float
    time_factor: float
    planner_time_factor: float
    casr: float
    path_length_m: float
    reference_length_m: float
    computing_s: float
    travelling_s: float
    time_limit_s: float
    distance_to_goal_m: float


@dataclass(frozen=True, slots=True)
class Metric:
    """One figure of a table.

    Attributes:
        name: E.g. ``"SR"``.
        value: NaN where no mission has it.
        low: Lower end of the interval.
        high: Upper end.
        count: Missions behind it.
        interval: How the interval was made: ``"Wilson"`` or ``"bootstrap"``.
    """

    name: str
    value: float
    low: float
    high: float
    count: int
    interval: str


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


def outcome_of(
    track: Sequence[TrackPoint],
    judge: "Judge",
    *,
    mission_id: str,
    vehicle: str,
    declared: bool,
    computing_s: float,
    travelling_s: float,
    planner_computing_s: float = 0.0,
    time_limit_s: float = 1800.0,
    reference_length_m: float | None = None,
) -> MissionOutcome:
    """Return what came of a mission, from its track of true positions and the judge of its goal.

    Args:
        track: Oldest first, at least the start.
        judge: Of the mission's goal and world.
        mission_id: Of its episode.
        vehicle: Name of the vehicle profile.
        declared: The agent said "Found Goal".
        computing_s: CT, seconds.
        travelling_s: TT, seconds.
        planner_computing_s: The planner's share of CT, seconds.
        time_limit_s: T_max, seconds.
        reference_length_m: Where it is known already; else the judge measures it.

    Raises:
        InputError: If a number is out of range or the track is empty.
    """
    report = judge.review(track)
    if reference_length_m is None:
        reference_length_m = judge.reference_length_m((track[0].x_m, track[0].y_m))
    return MissionOutcome(
        mission_id=mission_id,
        level=judge.spec.level,
        vehicle=vehicle,
        declared=declared,
        in_place=report.success,
        in_place_at=tuple((radius_m, report.success_at(radius_m)) for radius_m, _ in report.end.at_radius),
        oracle_success=report.oracle_success,
        path_length_m=report.length_m,
        reference_length_m=reference_length_m,
        computing_s=computing_s,
        travelling_s=travelling_s,
        planner_computing_s=planner_computing_s,
        time_limit_s=time_limit_s,
        distance_to_goal_m=report.end.nearest_m,
    )


def spl_of(*, success: bool, path_length_m: float, reference_length_m: float) -> float:
    """Return S · l / max(p, l), in [0, 1].

    Where the formula says nothing: 0/0 (started in place, declared without a step) is 1; a success without a reference
    way (l infinite: the judge knows no way, the robot found one) is 0, the lower bound, and is counted in the table.
    """
    if not success or math.isinf(reference_length_m):
        return 0.0
    longest_m = max(path_length_m, reference_length_m)
    return 1.0 if longest_m == 0.0 else reference_length_m / longest_m


def score(outcome: MissionOutcome) -> MissionScore:
    """Return what a mission scores. Exactly T_max is still in time, and its time factor is 0."""
    elapsed_s = outcome.computing_s + outcome.travelling_s
    over_time = elapsed_s > outcome.time_limit_s + _TIME_SLACK_S
    counts = outcome.declared and not over_time
    success = counts and outcome.in_place
    time_factor = _time_factor(elapsed_s, outcome.time_limit_s, over_time=over_time)
    planner_s = outcome.planner_computing_s + outcome.travelling_s
    return MissionScore(
        mission_id=outcome.mission_id,
        level=outcome.level,
        vehicle=outcome.vehicle,
        success=success,
        success_at=tuple((radius_m, counts and answer) for radius_m, answer in outcome.in_place_at),
        # Who succeeded was in place at the last moment of the track.
        oracle_success=outcome.oracle_success or success,
        over_time=over_time,
        spl=spl_of(success=success, path_length_m=outcome.path_length_m, reference_length_m=outcome.reference_length_m),
        time_factor=time_factor,
        planner_time_factor=_time_factor(planner_s, outcome.time_limit_s, over_time=over_time),
        casr=time_factor if success else 0.0,
        path_length_m=outcome.path_length_m,
        reference_length_m=outcome.reference_length_m,
        computing_s=outcome.computing_s,
        travelling_s=outcome.travelling_s,
        time_limit_s=outcome.time_limit_s,
        distance_to_goal_m=outcome.distance_to_goal_m,
    )


def aggregate(scores: Sequence[MissionScore], *, seed: int = 0, confidence: float = 0.95) -> MetricTable:
    """Return the table of a set of missions.

    Intervals: Wilson's for SR and OSR (Wilson 1927; right for few missions and near 0 and 1), percentile bootstrap over
    missions for the others (Efron 1979; both factors of CASR are drawn together).

    Args:
        scores: At least one; the order does not matter, ids must differ unless missions were repeated.
        seed: Of the bootstrap.
        confidence: Of the intervals, in (0, 1).

    Raises:
        InputError: If there is no mission, or vehicles or time limits differ: these are never pooled.
    """
    listed = _checked(scores, confidence)
    success = np.asarray([item.success for item in listed], dtype=np.float64)
    columns = {
        "SPL": np.asarray([item.spl for item in listed]),
        "CASR per mission": np.asarray([item.casr for item in listed]),
        "CT": np.asarray([item.computing_s for item in listed]),
        "TT": np.asarray([item.travelling_s for item in listed]),
        "path length": np.asarray([item.path_length_m for item in listed]),
    }
    draws = _draws(len(listed), seed)
    rate_metrics = [
        _share("SR", [item.success for item in listed], confidence),
        _share("OSR", [item.oracle_success for item in listed], confidence),
    ]
    mean_metrics = [
        _metric(name, float(np.mean(values)), np.mean(values[draws], axis=1), len(listed), confidence)
        for name, values in columns.items()
    ]
    products = [
        ("CASR", np.asarray([item.time_factor for item in listed])),
        ("CASR paper-style", np.asarray([item.planner_time_factor for item in listed])),
    ]
    casr_metrics = [
        _metric(
            name,
            float(np.mean(success) * np.mean(factor)),
            np.mean(success[draws], axis=1) * np.mean(factor[draws], axis=1),
            len(listed),
            confidence,
        )
        for name, factor in products
    ]
    radii = sorted({radius_m for item in listed for radius_m, _ in item.success_at})
    at_radius = [
        _share(f"SR at {radius_m:g} m", [dict(item.success_at)[radius_m] for item in listed], confidence)
        for radius_m in radii
        if all(radius_m in dict(item.success_at) for item in listed)
    ]
    spl, casr_each, *rest = mean_metrics
    return MetricTable(
        vehicle=listed[0].vehicle,
        count=len(listed),
        metrics=(
            *rate_metrics,
            spl,
            casr_metrics[0],
            casr_each,
            casr_metrics[1],
            *at_radius,
            *rest,
            _distance(listed, seed, confidence),
        ),
        unreachable=sum(math.isinf(item.reference_length_m) for item in listed),
        confidence=confidence,
    )


def by_level(
    scores: Sequence[MissionScore], *, seed: int = 0, confidence: float = 0.95
) -> dict[int | None, MetricTable]:
    """Return a table for each level that there is, and one for all missions under None.

    Raises:
        InputError: As `aggregate`.
    """
    levels: list[int | None] = [*sorted({item.level for item in scores}), None]
    return {
        level: aggregate(
            [item for item in scores if level is None or item.level == level], seed=seed, confidence=confidence
        )
        for level in levels
    }


def compare(
    first: Sequence[MissionScore], second: Sequence[MissionScore], *, seed: int = 0, confidence: float = 0.95
) -> MetricTable:
    """Return by how much the first method is better than the second on the same missions.

    Paired: missions with the same id are drawn together, so that what they have in common (an easy world, a far goal)
    does not blur the difference. Differences of SR, OSR, SPL, CASR and CASR per mission, with bootstrap intervals.

    Raises:
        InputError: If the ids of the two sets differ or stand twice, or as `aggregate`.
    """
    ours, theirs = _checked(first, confidence), _checked(second, confidence)
    faults = []
    for name, listed in (("first", ours), ("second", theirs)):
        ids = [item.mission_id for item in listed]
        if len(set(ids)) < len(ids):
            faults.append(Fault(f"the {name} set holds a mission twice", "each mission once"))
    odd = sorted({item.mission_id for item in ours} ^ {item.mission_id for item in theirs})
    if odd:
        faults.append(Fault(f"{len(odd)} missions are in one set only, {odd[0]!r} first", "the same missions in both"))
    if ours[0].vehicle != theirs[0].vehicle or ours[0].time_limit_s != theirs[0].time_limit_s:
        faults.append(Fault("vehicles or time limits of the two sets differ", "the same vehicle and time limit"))
    if faults:
        raise InputError("comparison", faults)
    draws = _draws(len(ours), seed)

    def figures(listed: Sequence[MissionScore], picked: NDArray[np.int64]) -> dict[str, Floats]:
        columns = {
            "SR": np.asarray([item.success for item in listed], dtype=np.float64),
            "OSR": np.asarray([item.oracle_success for item in listed], dtype=np.float64),
            "SPL": np.asarray([item.spl for item in listed]),
            "time": np.asarray([item.time_factor for item in listed]),
            "CASR per mission": np.asarray([item.casr for item in listed]),
        }
        means = {name: np.asarray(np.mean(values[picked], axis=-1)) for name, values in columns.items()}
        means["CASR"] = means["SR"] * means.pop("time")
        return means

    everything = np.arange(len(ours), dtype=np.int64)
    mine, other = figures(ours, everything), figures(theirs, everything)
    mine_drawn, other_drawn = figures(ours, draws), figures(theirs, draws)
    return MetricTable(
        vehicle=ours[0].vehicle,
        count=len(ours),
        metrics=tuple(
            _metric(name, float(mine[name] - other[name]), mine_drawn[name] - other_drawn[name], len(ours), confidence)
            for name in ("SR", "OSR", "SPL", "CASR", "CASR per mission")
        ),
        unreachable=sum(math.isinf(item.reference_length_m) for item in ours),
        confidence=confidence,
    )


def wilson_interval(successes: int, count: int, *, confidence: float = 0.95) -> tuple[float, float]:
    """Return Wilson's score interval for a share (E. B. Wilson, "Probable inference", 1927), inside [0, 1].

    Raises:
        InputError: If there is no trial, more successes than trials, or the confidence is not in (0, 1).
    """
    faults = []
    if not (count >= 1 and 0 <= successes <= count):
        faults.append(Fault(f"{successes} successes of {count}", "0 ≤ successes ≤ count, count ≥ 1"))
    if not 0.0 < confidence < 1.0:
        faults.append(Fault(f"confidence is {confidence}", "a number in (0, 1)"))
    if faults:
        raise InputError("Wilson interval", faults)
    z = NormalDist().inv_cdf(0.5 + confidence / 2.0)
    share = successes / count
    middle = share + z * z / (2.0 * count)
    half = z * math.sqrt(share * (1.0 - share) / count + z * z / (4.0 * count * count))
    scale = 1.0 + z * z / count
    low = 0.0 if successes == 0 else max(0.0, (middle - half) / scale)
    high = 1.0 if successes == count else min(1.0, (middle + half) / scale)
    return low, high


def _time_factor(elapsed_s: float, time_limit_s: float, *, over_time: bool) -> float:
    return 0.0 if over_time else min(1.0, max(0.0, 1.0 - elapsed_s / time_limit_s))


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


def _draws(count: int, seed: int) -> NDArray[np.int64]:
    bulk = np.random.Generator(np.random.PCG64(key_of(seed, "bootstrap", count)))
    return bulk.integers(0, count, size=(RESAMPLES, count))


def _share(name: str, answers: Sequence[bool], confidence: float) -> Metric:
    low, high = wilson_interval(sum(answers), len(answers), confidence=confidence)
    return Metric(name, sum(answers) / len(answers), low, high, len(answers), "Wilson")


def _metric(name: str, value: float, resampled: Floats, count: int, confidence: float) -> Metric:
    tail = 50.0 * (1.0 - confidence)
    low, high = (float(v) for v in np.percentile(resampled, [tail, 100.0 - tail]))
    return Metric(name, value, low, high, count, "bootstrap")


def _distance(listed: Sequence[MissionScore], seed: int, confidence: float) -> Metric:
    """Return the mean distance to the goal at the end, of the missions that have one."""
    name = "distance to goal"
    finite = np.asarray([d.distance_to_goal_m for d in listed if math.isfinite(d.distance_to_goal_m)])
    if not finite.size:
        return Metric(name, math.nan, math.nan, math.nan, 0, "bootstrap")
    means = np.mean(finite[_draws(finite.size, seed)], axis=1)
    return _metric(name, float(np.mean(finite)), means, int(finite.size), confidence)
