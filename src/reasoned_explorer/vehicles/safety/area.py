"""Pieces of ground in the world's frame: a machine is to stay inside of some and outside of others."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Protocol

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Fault, SettingsError
from reasoned_explorer.model.checks import is_within
from reasoned_explorer.vehicles.safety.cause import Cause

#: A way is followed in steps of at least this, metres.
_STEP_M = 0.02
#: Ground that only answers yes or no is asked every so many metres.
_SAMPLE_M = 0.25


class Area(Protocol):
    """A piece of ground that knows how far its edge is."""

    def inside_by_m(self, x_m: float, y_m: float) -> float:
        """Return how far a point is from the edge, metres: positive inside, negative outside."""


@dataclass(frozen=True, slots=True)
class Circle:
    """A disc.

    Attributes:
        x_m: East of the world's origin, of its middle.
        y_m: North.
        radius_m: Greater than 0.

    Raises:
        SettingsError: If a value is out of range.
    """

    x_m: float
    y_m: float
    radius_m: float

    def __post_init__(self) -> None:
        if not (is_within(self.x_m) and is_within(self.y_m) and is_within(self.radius_m, 0.0) and self.radius_m > 0.0):
            raise SettingsError("circle", [Fault(f"{self}", "finite metres and a radius > 0")])

    def inside_by_m(self, x_m: float, y_m: float) -> float:
        """Return how far a point is inside, metres."""
        return self.radius_m - math.hypot(x_m - self.x_m, y_m - self.y_m)


@dataclass(frozen=True, slots=True)
class Polygon:
    """What a ring of straight edges encloses (even-odd rule).

    Attributes:
        points: x, y of the corners, metres; at least three that enclose ground; the last joins the first.

    Raises:
        SettingsError: If they enclose nothing or a value is not finite.
    """

    points: tuple[tuple[float, float], ...]
    _edges: tuple[tuple[float, float, float, float], ...] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "points", tuple((x, y) for x, y in self.points))
        flat = [value for point in self.points for value in point]
        if len(self.points) < 3 or not all(map(is_within, flat)):
            fault = Fault(f"{len(self.points)} corners: {self.points!r:.60}", "at least three corners of finite metres")
            raise SettingsError("polygon", [fault])
        ring = (*self.points, self.points[0])
        object.__setattr__(self, "_edges", tuple((x0, y0, x1, y1) for (x0, y0), (x1, y1) in pairwise(ring)))
        if abs(sum(x0 * y1 - x1 * y0 for x0, y0, x1, y1 in self._edges)) < 1e-9:
            raise SettingsError("polygon", [Fault(f"{self.points!r:.60} encloses no ground", "corners around ground")])

    def inside_by_m(self, x_m: float, y_m: float) -> float:
        """Return how far a point is inside, metres."""
        inside, nearest_m = False, math.inf
        for x0, y0, x1, y1 in self._edges:
            if (y0 > y_m) != (y1 > y_m) and x_m < x0 + (y_m - y0) * (x1 - x0) / (y1 - y0):
                inside = not inside
            dx, dy = x1 - x0, y1 - y0
            square = dx * dx + dy * dy
            share = 0.0 if square == 0.0 else max(0.0, min(1.0, ((x_m - x0) * dx + (y_m - y0) * dy) / square))
            nearest_m = min(nearest_m, math.hypot(x0 + share * dx - x_m, y0 + share * dy - y_m))
        return nearest_m if inside else -nearest_m


@dataclass(frozen=True, slots=True)
class Reach:
    """How far a straight way may be followed.

    Attributes:
        x_m: The last allowed point.
        y_m: Likewise.
        length_m: From the start to there.
        cause: What ends it there; None where all of it is allowed.
        reason: In words.
    """

    x_m: float
    y_m: float
    length_m: float
    cause: Cause | None = None
    reason: str = ""


@dataclass(frozen=True, slots=True)
class AllowedGround:
    """Where a machine may be.

    Attributes:
        fence: It stays inside; None for anywhere.
        keep_out: It stays out of these.
        keep_out_at: Says of a point (x, y) whether it must not be gone to; None for none.
        margin_m: How far it stays from any edge.
    """

    fence: Area | None = None
    keep_out: Sequence[Area] = ()
    keep_out_at: Callable[[float, float], bool] | None = None
    margin_m: float = 0.0

    def clearance(self, x_m: float, y_m: float) -> tuple[float, Cause]:
        """Return how far the nearest edge is from a point, metres (negative where it must not be), and which."""
        found: list[tuple[float, Cause]] = [(math.inf, Cause.FENCE)]
        if self.fence is not None:
            found.append((self.fence.inside_by_m(x_m, y_m), Cause.FENCE))
        found += [(-area.inside_by_m(x_m, y_m), Cause.KEEP_OUT) for area in self.keep_out]
        if self.keep_out_at is not None and self.keep_out_at(x_m, y_m):
            found.append((-math.inf, Cause.KEEP_OUT))
        return min(found)

    def trouble(self, x_m: float, y_m: float, *, margin_m: float = 0.0) -> tuple[Cause, str] | None:
        """Return what is wrong with being at a point; None where it is allowed."""
        clear_m, cause = self.clearance(x_m, y_m)
        return None if clear_m >= margin_m else (cause, in_words(cause, clear_m))

    def reach(self, here: Pose, x_m: float, y_m: float) -> Reach:
        """Return how far one may go from a pose straight towards a point.

        From where it is too near an edge, or beyond it, one may only go further in, and all the way.
        """
        whole_m = here.distance_to_m(x_m, y_m)
        at_m, before_m = 0.0, 0.0
        start_m, _ = self.clearance(here.x_m, here.y_m)
        least_m = min(self.margin_m, start_m)
        while True:
            at_x, at_y = _between(here, x_m, y_m, at_m, whole_m)
            clear_m, cause = self.clearance(at_x, at_y)
            if not clear_m >= least_m or (at_m >= whole_m and clear_m < 0.0):
                if start_m < 0.0:
                    before_m = 0.0
                return Reach(*_between(here, x_m, y_m, before_m, whole_m), before_m, cause, in_words(cause, clear_m))
            if at_m >= whole_m:
                return Reach(x_m, y_m, whole_m)
            least_m = min(self.margin_m, max(least_m, clear_m))
            # The edge is no nearer than this: nothing in between can be forbidden.
            step_m = max(_STEP_M, clear_m - self.margin_m)
            if self.keep_out_at is not None:
                step_m = min(step_m, _SAMPLE_M)
            before_m, at_m = at_m, min(whole_m, at_m + step_m)


def _between(here: Pose, x_m: float, y_m: float, at_m: float, whole_m: float) -> tuple[float, float]:
    if at_m >= whole_m:
        return x_m, y_m
    share = at_m / whole_m
    return here.x_m + share * (x_m - here.x_m), here.y_m + share * (y_m - here.y_m)


def in_words(cause: Cause, clear_m: float) -> str:
    """Return what is wrong where an edge is so near, for people."""
    what = "the geofence" if cause is Cause.FENCE else "ground to keep out of"
    if clear_m == -math.inf:
        return f"on {what}"
    beyond = "outside" if cause is Cause.FENCE else "in"
    return f"{-clear_m:.1f} m {beyond} {what}" if clear_m < 0.0 else f"{clear_m:.1f} m from the edge of {what}"
