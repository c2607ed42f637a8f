"""One leg as a driver sees it: where the vehicle has been, whether it has arrived, and whether it is stuck."""

import math
from dataclasses import dataclass, field
from typing import Protocol

from reasoned_explorer.geometry import Pose, bearing_between_rad
from reasoned_explorer.model import Leg, LegOutcome, TrackPoint

#: Slower than this it stands, metres a second.
_STANDING_MPS = 0.2
#: A machine that stands at its target for so long more than it settles is there, whatever else is said.
_PATIENCE_S = 1.0


class Moment(Protocol):
    """Where a vehicle takes itself to be at a moment."""

    @property
    def t_s(self) -> float:
        """When, seconds of the vehicle's time."""

    @property
    def believed(self) -> Pose:
        """Where."""

    @property
    def speed_mps(self) -> float:
        """How fast its body moves."""


class LegLimits(Protocol):
    """What counts as arrived and as stuck."""

    @property
    def arrival_m(self) -> float:
        """So near the target, or past the line across the way through it, the vehicle has arrived."""

    @property
    def facing_rad(self) -> float:
        """How well the final heading is met."""

    @property
    def stuck_s(self) -> float:
        """Seconds without progress that mean "stuck"."""

    @property
    def stuck_m(self) -> float:
        """What counts as progress, metres."""


@dataclass(slots=True)
class LegWatch:
    """Watches a leg. Times are the vehicle's seconds.

    Attributes:
        target: Where to.
        settings: What counts as arrived and as stuck.
        settle_s: How long the vehicle may stand after arriving without being told off.
        started_s: The mission's time at the start.
        first: The first moment.
    """

    target: Pose
    settings: LegLimits
    settle_s: float
    started_s: float
    first: Moment
    _track: list[TrackPoint] = field(default_factory=list)
    _errors_square_m2: float = 0.0
    _across_square_m2: float = 0.0
    _length_m: float = 0.0
    _last: Moment | None = None
    _progress_s: float = 0.0
    _progress: Pose = field(default_factory=lambda: Pose(0.0, 0.0))
    _there_since_s: float | None = None

    def __post_init__(self) -> None:
        self._progress_s, self._progress = self.first.t_s, self.first.believed

    def see(self, moment: Moment, true: Pose) -> None:
        """Take in where the vehicle is, by its own belief and in truth."""
        point = TrackPoint(self._mission_s(moment.t_s), true.x_m, true.y_m, true.z_m, true.heading_rad)
        if self._track:
            before = self._track[-1]
            self._length_m += math.hypot(point.x_m - before.x_m, point.y_m - before.y_m)
        self._track.append(point)
        believed = moment.believed
        self._errors_square_m2 += believed.distance_to_m(true.x_m, true.y_m) ** 2
        self._across_square_m2 += self._across_m(true) ** 2
        moved_m = believed.distance_to_m(self._progress.x_m, self._progress.y_m)
        turned_rad = abs(bearing_between_rad(self._progress.heading_rad, believed.heading_rad))
        if moved_m > self.settings.stuck_m or turned_rad > self.settings.facing_rad:
            self._progress_s, self._progress = moment.t_s, believed
        stands = moment.speed_mps < _STANDING_MPS and self.is_there(moment) and self._faces(moment)
        if not stands:
            self._there_since_s = None
        elif self._there_since_s is None:
            self._there_since_s = moment.t_s
        self._last = moment

    def is_there(self, moment: Moment) -> bool:
        """Whether the vehicle is at the target: near it, or past the line across the way through it, not far aside."""
        here, target = moment.believed, self.target
        left_m = here.distance_to_m(target.x_m, target.y_m)
        if left_m <= self.settings.arrival_m:
            return True
        beyond_m = -self._left_along_m(here)
        return beyond_m >= 0.0 and left_m <= max(4.0 * self.settings.arrival_m, 2.0)

    @property
    def has_stood_there(self) -> bool:
        """Whether the vehicle has stood at its target for longer than it settles."""
        if self._there_since_s is None or self._last is None:
            return False
        return self._last.t_s - self._there_since_s >= self.settle_s + _PATIENCE_S

    @property
    def is_stuck(self) -> bool:
        """Whether the vehicle has made no progress for long, though it is not there."""
        if self._last is None or self._there_since_s is not None:
            return False
        return self._last.t_s - self._progress_s >= self.settings.stuck_s

    @property
    def left_m(self) -> float:
        """How far it still is to the target, metres."""
        here = (self._last or self.first).believed
        return here.distance_to_m(self.target.x_m, self.target.y_m)

    @property
    def elapsed_s(self) -> float:
        """Seconds since the start."""
        return (self._last or self.first).t_s - self.first.t_s

    def leg(self, outcome: LegOutcome, detail: str) -> Leg:
        """Return what came of it."""
        count = max(1, len(self._track))
        return Leg(
            target_x_m=self.target.x_m,
            target_y_m=self.target.y_m,
            outcome=outcome,
            duration_s=self.elapsed_s,
            length_m=self._length_m,
            track=tuple(self._track),
            detail=detail,
            cross_track_rms_m=math.sqrt(self._across_square_m2 / count),
            localization_rms_m=math.sqrt(self._errors_square_m2 / count),
        )

    def _mission_s(self, t_s: float) -> float:
        return self.started_s + t_s - self.first.t_s

    def _faces(self, moment: Moment) -> bool:
        off_rad = abs(bearing_between_rad(moment.believed.heading_rad, self.target.heading_rad))
        return off_rad <= self.settings.facing_rad

    def _left_along_m(self, here: Pose) -> float:
        """How far it still is along the straight way; negative beyond the target."""
        dx, dy, length_m = self._way()
        if length_m == 0.0:
            return here.distance_to_m(self.target.x_m, self.target.y_m)
        return ((self.target.x_m - here.x_m) * dx + (self.target.y_m - here.y_m) * dy) / length_m

    def _across_m(self, here: Pose) -> float:
        dx, dy, length_m = self._way()
        if length_m == 0.0:
            return 0.0
        return ((here.x_m - self.target.x_m) * dy - (here.y_m - self.target.y_m) * dx) / length_m

    def _way(self) -> tuple[float, float, float]:
        start = self.first.believed
        dx, dy = self.target.x_m - start.x_m, self.target.y_m - start.y_m
        return dx, dy, math.hypot(dx, dy)
