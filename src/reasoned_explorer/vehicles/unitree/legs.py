"""One leg as the tracker walks it: what it kept of the way."""

import math
from dataclasses import dataclass, field

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Leg, LegOutcome, TrackPoint

#: A point of the track is kept after so many metres, or after so many seconds and a little way.
_KEEP_M, _KEEP_S, _KEEP_LEAST_M = 1.0, 0.5, 0.02


@dataclass(slots=True)
class LegLog:
    """Keeps the way of a leg. The robot knows no truth: all is what it believes.

    Attributes:
        target: Where to.
        started_s: The mission's time at the start.
        height_m: Of the camera.
    """

    target: Pose
    started_s: float
    height_m: float
    elapsed_s: float = 0.0
    _track: list[TrackPoint] = field(default_factory=list)
    _last: Pose | None = None
    _length_m: float = 0.0
    _kept_m: float = 0.0
    _across_square_m2: float = 0.0
    _driven: int = 0

    def see(self, elapsed_s: float, pose: Pose, *, across_m: float | None = None) -> None:
        """Take in where it is so many seconds after the start.

        Args:
            elapsed_s: Seconds since the start.
            pose: Where it believes to be.
            across_m: Distance from the straight line, where it is walking along it.
        """
        self.elapsed_s = elapsed_s
        if self._last is not None:
            self._length_m += pose.distance_to_m(self._last.x_m, self._last.y_m)
        self._last = pose
        if across_m is not None:
            self._across_square_m2 += across_m * across_m
            self._driven += 1
        moved_m = self._length_m - self._kept_m
        waited_s = self.started_s + elapsed_s - self._track[-1].t_s if self._track else math.inf
        if moved_m >= _KEEP_M or (waited_s >= _KEEP_S and (moved_m >= _KEEP_LEAST_M or not self._track)):
            self._keep(pose)

    def _keep(self, pose: Pose) -> None:
        self._kept_m = self._length_m
        t_s = self.started_s + self.elapsed_s
        self._track.append(TrackPoint(t_s, pose.x_m, pose.y_m, self.height_m, pose.heading_rad))

    def leg(self, outcome: LegOutcome, detail: str) -> Leg:
        """Return what came of it."""
        if self._last is not None and self._track[-1].t_s < self.started_s + self.elapsed_s:
            self._keep(self._last)
        return Leg(
            target_x_m=self.target.x_m,
            target_y_m=self.target.y_m,
            outcome=outcome,
            duration_s=self.elapsed_s,
            length_m=self._length_m,
            track=tuple(self._track),
            detail=detail,
            cross_track_rms_m=math.sqrt(self._across_square_m2 / self._driven) if self._driven else 0.0,
        )
