"""The one scorer: what a mission scores, a pure function of its track and of what was asked.

For one mission (S success, p the way travelled, l the shortest compliant way to success, T = CT + TT):

- **success**: declared in place and in time, with the goal's conditions kept.
- **oracle success**: at some moment of the track a declaration would have succeeded.
- **oracle success, seen**: at one of the mission's looks a declaration would have succeeded, and what makes it succeed
  was in one of that look's views. The agent could have noticed; between this and success lie captions and checks,
  between this and oracle success lies where the agent looked.
- **SPL** S · l / max(p, l) (Anderson et al., "On evaluation of embodied navigation agents", 2018, arXiv 1807.06757).
- **soft-SPL** (1 − d_end / d_start) · l / max(p, l), the first factor clipped to [0, 1] (Habitat-Lab's ``SoftSPL``),
  with d the length of the shortest compliant way that is still to go to the edge of the success region: d_start = l.
  It asks neither for a declaration nor for time; where the goal's conditions were broken it is 0, as success is.
- **CASR** S · (1 − T / T_max): one mission's term of CASR per mission (paper, section V-A).
- **nDTW** exp(−DTW(R, Q) / (|R| · d_th)), for level 3 only (Ilharco et al., "General evaluation for instruction
  conditioned navigation using dynamic time warping", 2019, arXiv 1907.05446): how closely the track Q follows the
  shortest compliant way R. Both are resampled at even distances of at most 1 m; d_th is the success radius.

Times: CT, every second that the robot waits for a decision, captions and checks included; TT, travelling. What each
figure is where its formula says nothing stands with the functions, and in ``docs/metrics.md``.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reasoned_explorer.model import Fault, InputError, TrackPoint

if TYPE_CHECKING:
    # Reading a table must not load the world.
    from reasoned_explorer.task.judge import Judge, TrackReport

_TIME_SLACK_S = 1e-6
#: Ways are compared at points at most this far apart, metres.
_WAY_STEP_M = 1.0
# A way on a grid may come out shorter than the straight line by less than this, metres.
_LOOSE_M = 2.0

Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Look:
    """One look of a mission.

    Attributes:
        point: Place in the track of the point where the robot stood.
        headings_rad: Of its views, compass.
    """

    point: int
    headings_rad: tuple[float, ...]


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
        oracle_seen: At a look in place, what satisfies was in one of its views.
        compliant: The goal's conditions on the way were kept.
        path_length_m: Travelled, metres.
        reference_length_m: The shortest compliant way to success, metres; infinity where there is none.
        computing_s: CT, seconds.
        planner_computing_s: The planner's share of CT, seconds.
        travelling_s: TT, seconds.
        time_limit_s: T_max, seconds.
        distance_to_goal_m: From the end to the nearest thing that satisfies, straight, metres; infinity where there is
            none.
        remaining_m: From the end to the edge of the success region, by the shortest compliant way, metres; infinity
            where there is none, where it is longer than the reference way, and where the track did not comply.
        ndtw: How closely the reference way was followed, in [0, 1]; None for other levels than 3 and where there is no
            reference way.
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
    oracle_seen: bool = False
    compliant: bool = True
    remaining_m: float = math.inf
    ndtw: float | None = None

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
        for name in ("reference_length_m", "distance_to_goal_m", "remaining_m"):
            value = getattr(self, name)
            if not value >= 0.0:
                faults.append(Fault(f"{name} is {value}", "0 or more; infinity where there is none"))
        if not (math.isfinite(self.time_limit_s) and self.time_limit_s > 0.0):
            faults.append(Fault(f"time_limit_s is {self.time_limit_s}", "a finite number above 0"))
        if faults := [*faults, *self._contradictions()]:
            raise InputError(f"outcome of mission {self.mission_id!r}", faults)

    def _contradictions(self) -> list[Fault]:
        faults = []
        if self.planner_computing_s > self.computing_s + _TIME_SLACK_S:
            what = f"planner_computing_s is {self.planner_computing_s}, computing_s {self.computing_s}"
            faults.append(Fault(what, "a share of computing_s"))
        if self.in_place and not self.compliant:
            faults.append(Fault("in_place, but not compliant", "in_place only where the way there complied"))
        if self.ndtw is not None and not (self.level == 3 and 0.0 <= self.ndtw <= 1.0):
            faults.append(Fault(f"ndtw is {self.ndtw} at level {self.level}", "in [0, 1] at level 3, else None"))
        return faults


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
        oracle_seen: At one of the looks it would have, and what satisfies was in view.
        over_time: CT + TT exceeded T_max.
        spl: S · l / max(p, l), in [0, 1].
        soft_spl: (1 − d_end / d_start) · l / max(p, l), in [0, 1]; never below ``spl``.
        time_factor: 1 − (CT + TT)/T_max, in [0, 1]; 0 when over time.
        planner_time_factor: The same with the planner's CT only.
        casr: S · time_factor: this mission's term of CASR per mission.
        path_length_m: Travelled, metres.
        reference_length_m: The shortest compliant way, metres; may be infinite.
        computing_s: CT.
        travelling_s: TT.
        time_limit_s: T_max.
        distance_to_goal_m: At the end, straight, metres; may be infinite.
        ndtw: How closely the reference way was followed, in [0, 1]; None for other levels than 3 and where there is no
            reference way.
    """

    mission_id: str
    level: int
    vehicle: str
    success: bool
    success_at: tuple[tuple[float, bool], ...]
    oracle_success: bool
    oracle_seen: bool
    over_time: bool
    spl: float
    soft_spl: float
    time_factor: float
    planner_time_factor: float
    casr: float
    path_length_m: float
    reference_length_m: float
    computing_s: float
    travelling_s: float
    time_limit_s: float
    distance_to_goal_m: float
    ndtw: float | None


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
    looks: Sequence[Look] = (),
    fov_rad: float = math.pi / 2.0,
    report: "TrackReport | None" = None,
    reference_length_m: float | None = None,
    reference_way: ArrayLike | None = None,
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
        looks: Where the agent looked; without any, nothing was seen.
        fov_rad: Horizontal field of view of each view, radians, in (0, π).
        report: What the judge says to the track, where it is known already; else the judge is asked.
        reference_length_m: Likewise.
        reference_way: Likewise, its corners, shape (n, 2); empty where there is none. Read for level 3 only.

    Raises:
        InputError: If a number is out of range, the track is empty, or a look is from no point of it.
    """
    judged = judge.review(track) if report is None else report
    start = (track[0].x_m, track[0].y_m)
    if reference_length_m is None:
        reference_length_m = judge.reference_length_m(start)
    followed = None
    if judge.spec.level == 3:
        way = judge.reference_path(start) if reference_way is None else np.asarray(reference_way, dtype=np.float64)
        points = [(point.x_m, point.y_m) for point in track]
        followed = ndtw_of(points, () if way is None else way, threshold_m=judge.success_radius_m)
    return MissionOutcome(
        mission_id=mission_id,
        level=judge.spec.level,
        vehicle=vehicle,
        declared=declared,
        in_place=judged.success,
        in_place_at=tuple((radius_m, judged.success_at(radius_m)) for radius_m, _ in judged.end.at_radius),
        oracle_success=judged.oracle_success,
        oracle_seen=_was_in_view(track, judge, judged, looks, fov_rad),
        compliant=judged.compliance.compliant,
        path_length_m=judged.length_m,
        reference_length_m=reference_length_m,
        remaining_m=_remaining_m(track[-1], judge, judged, reference_length_m),
        computing_s=computing_s,
        travelling_s=travelling_s,
        planner_computing_s=planner_computing_s,
        time_limit_s=time_limit_s,
        distance_to_goal_m=judged.end.nearest_m,
        ndtw=followed,
    )


def spl_of(*, success: bool, path_length_m: float, reference_length_m: float) -> float:
    """Return S · l / max(p, l), in [0, 1].

    Where the formula says nothing: 0/0 (started in place, declared without a step) is 1; a success without a reference
    way (l infinite: the judge knows no way, the robot found one) is 0, the lower bound, and is counted in the table.
    """
    return _efficiency(path_length_m, reference_length_m) if success else 0.0


def soft_spl_of(*, remaining_m: float, path_length_m: float, reference_length_m: float) -> float:
    """Return (1 − d_end / d_start) clipped to [0, 1], times l / max(p, l), with d_start = l; in [0, 1].

    Where the formula says nothing: a mission that started in place (l = 0) has made all its way where it ends in place
    (then 1 without a step, else 0, as SPL), and none where it does not; without a reference way it is 0; an end from
    which there is no compliant way (d_end infinite) is no progress, 0.
    """
    if math.isinf(reference_length_m) or math.isinf(remaining_m):
        return 0.0
    if reference_length_m == 0.0:
        progress = 1.0 if remaining_m == 0.0 else 0.0
    else:
        progress = max(0.0, 1.0 - remaining_m / reference_length_m)
    return progress * _efficiency(path_length_m, reference_length_m)


def ndtw_of(track: ArrayLike, reference: ArrayLike, *, threshold_m: float) -> float | None:
    """Return exp(−DTW(R, Q) / (|R| · d_th)), in [0, 1]: how closely a track follows a reference way.

    Both are resampled at even distances of at most 1 m, ends included; |R| is the number of points of the reference
    then. A way of no length is one point. Without a reference way there is nothing to follow: None.

    Args:
        track: Q, ENU metres, shape (n, 2), n ≥ 1.
        reference: R, likewise; empty where there is none.
        threshold_m: d_th, metres, above 0.

    Raises:
        InputError: If the track is empty, a number is not finite or the threshold is not above 0.
    """
    from reasoned_explorer.evaluation.scoring_kernels import dtw

    gone, wanted = (np.asarray(way, dtype=np.float64).reshape(-1, 2) for way in (track, reference))
    faults = []
    if not len(gone):
        faults.append(Fault("the track is empty", "at least the start"))
    if not (np.isfinite(gone).all() and np.isfinite(wanted).all()):
        faults.append(Fault("a point that is not finite", "ENU metres"))
    if not (math.isfinite(threshold_m) and threshold_m > 0.0):
        faults.append(Fault(f"threshold_m is {threshold_m}", "metres above 0"))
    if faults:
        raise InputError("nDTW", faults)
    if not len(wanted):
        return None
    wanted = _resampled(wanted)
    return math.exp(-dtw(wanted, _resampled(gone)) / (len(wanted) * threshold_m))


def score(outcome: MissionOutcome) -> MissionScore:
    """Return what a mission scores. Exactly T_max is still in time, and its time factor is 0."""
    elapsed_s = outcome.computing_s + outcome.travelling_s
    over_time = elapsed_s > outcome.time_limit_s + _TIME_SLACK_S
    counts = outcome.declared and not over_time
    success = counts and outcome.in_place
    time_factor = _time_factor(elapsed_s, outcome.time_limit_s, over_time=over_time)
    planner_s = outcome.planner_computing_s + outcome.travelling_s
    soft_spl = soft_spl_of(
        # Who is in place has no way left.
        remaining_m=0.0 if outcome.in_place else outcome.remaining_m,
        path_length_m=outcome.path_length_m,
        reference_length_m=outcome.reference_length_m,
    )
    return MissionScore(
        mission_id=outcome.mission_id,
        level=outcome.level,
        vehicle=outcome.vehicle,
        success=success,
        success_at=tuple((radius_m, counts and answer) for radius_m, answer in outcome.in_place_at),
        # Who succeeded was in place at the last moment of the track, and who saw it in place was in place.
        oracle_success=outcome.oracle_success or success or outcome.oracle_seen,
        oracle_seen=outcome.oracle_seen,
        over_time=over_time,
        spl=spl_of(success=success, path_length_m=outcome.path_length_m, reference_length_m=outcome.reference_length_m),
        soft_spl=soft_spl if outcome.compliant else 0.0,
        time_factor=time_factor,
        planner_time_factor=_time_factor(planner_s, outcome.time_limit_s, over_time=over_time),
        casr=time_factor if success else 0.0,
        path_length_m=outcome.path_length_m,
        reference_length_m=outcome.reference_length_m,
        computing_s=outcome.computing_s,
        travelling_s=outcome.travelling_s,
        time_limit_s=outcome.time_limit_s,
        distance_to_goal_m=outcome.distance_to_goal_m,
        ndtw=outcome.ndtw,
    )


def _efficiency(path_length_m: float, reference_length_m: float) -> float:
    """Return l / max(p, l); 1 for 0/0, 0 without a reference way."""
    if math.isinf(reference_length_m):
        return 0.0
    longest_m = max(path_length_m, reference_length_m)
    return 1.0 if longest_m == 0.0 else reference_length_m / longest_m


def _time_factor(elapsed_s: float, time_limit_s: float, *, over_time: bool) -> float:
    return 0.0 if over_time else min(1.0, max(0.0, 1.0 - elapsed_s / time_limit_s))


def _remaining_m(end: TrackPoint, judge: "Judge", judged: "TrackReport", reference_length_m: float) -> float:
    """Return how far it is from the end to success, or infinity where that is further than from the start.

    Nobody asks how much further: soft-SPL is 0 then, and looking far takes time.
    """
    least_m = judged.end.nearest_m - judge.success_radius_m - _LOOSE_M
    if not judged.compliance.compliant or math.isinf(reference_length_m) or least_m > reference_length_m:
        return math.inf
    return judge.reference_length_m((end.x_m, end.y_m), max_m=reference_length_m)


def _was_in_view(
    track: Sequence[TrackPoint], judge: "Judge", judged: "TrackReport", looks: Sequence[Look], fov_rad: float
) -> bool:
    """Return whether at a look, on a track compliant up to there, what satisfies was in place and in view."""
    faults = [
        Fault(f"a look is from point {look.point}", f"0 to {len(track) - 1}")
        for look in looks
        if not 0 <= look.point < len(track)
    ]
    if faults:
        raise InputError("looks", faults[:10])
    if not judged.oracle_success:
        return False
    along = _along(np.asarray([(point.x_m, point.y_m) for point in track], dtype=np.float64))
    return any(
        judge.in_view(track[look.point].x_m, track[look.point].y_m, look.headings_rad, fov_rad)
        for look in looks
        if along[look.point] < judged.compliance.violation_at_m
    )


def _along(points: Floats) -> Floats:
    """Return how far along a way each of its points lies, metres."""
    return np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T)))) if len(points) > 1 else np.zeros(1)


def _resampled(points: Floats) -> Floats:
    """Return points at even distances of at most 1 m along a way, both ends included; one point if it has no length."""
    along = _along(points)
    ticks = np.linspace(0.0, along[-1], math.ceil(along[-1] / _WAY_STEP_M) + 1)
    return np.stack([np.interp(ticks, along, points[:, axis]) for axis in (0, 1)], axis=1)
