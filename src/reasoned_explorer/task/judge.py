"""The judge of success: looks at the world's truth, never at what a mind or a captioner said."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Fault, InputError, SettingsError, TrackPoint
from reasoned_explorer.task.compliance import ComplianceReport, compliance_of
from reasoned_explorer.task.goal_spec import PASS_GRADE, GoalSpec
from reasoned_explorer.task.seeing import marks_of, sees_many
from reasoned_explorer.task.targets import Grader, Target
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.geodesic import DistanceField, Traveller

#: Success is reported at these radii, metres; the main one is 15 (others of the field: 20 m in UAV-ON).
RADII_M = (5.0, 10.0, 15.0, 20.0)
_TRACK_STEP_M = 1.0
# Stopped by nothing but what the goal forbids.
_GHOST = Traveller(flies=True, radius_m=0.0, collides=False)
# A first search for the reference way goes this far, each next one three times as far.
_FIRST_REACH_M = 120.0
# Cells of the coarse picture of what is near.
_NEARNESS_M = 5.0


@dataclass(frozen=True, slots=True)
class SuccessReport:
    """What the judge says to a declaration.

    Attributes:
        success: Within the success radius of something that satisfies the goal, with a line of sight to it.
        at_radius: The same at each of `RADII_M`.
        object_id: The nearest thing that satisfies and is in sight within the largest radius, or -1.
        distance_m: To it, or infinity.
        nearest_m: To the nearest thing that satisfies, in sight or not, anywhere; infinity where there is none.
        grade: Of what was found; 0 where nothing is in sight within the success radius.
    """

    success: bool
    at_radius: tuple[tuple[float, bool], ...]
    object_id: int
    distance_m: float
    nearest_m: float
    grade: int


@dataclass(frozen=True, slots=True)
class TrackReport:
    """What the judge says to a whole track.

    Attributes:
        end: Of its last point, wherever it is, compliant or not.
        oracle_success: At some moment of the track, and compliant up to then, a declaration would have succeeded.
        oracle_at_m: Metres along the track of the first such moment, or infinity.
        compliance: Whether the whole track complied.
        length_m: Of the track.
    """

    end: SuccessReport
    oracle_success: bool
    oracle_at_m: float
    compliance: ComplianceReport
    length_m: float

    @property
    def success(self) -> bool:
        """A declaration at the end of the track succeeds: in place, and compliant all the way."""
        return self.end.success and self.compliance.compliant

    def success_at(self, radius_m: float) -> bool:
        """Return the same at one of `RADII_M`."""
        return dict(self.end.at_radius)[radius_m] and self.compliance.compliant


def faults_of_radius(success_radius_m: float) -> list[Fault]:
    """Return what is wrong with a success radius, metres; none if it is in [1, 50]."""
    if 1.0 <= success_radius_m <= 50.0:
        return []
    return [Fault(f"success_radius_m is {success_radius_m}", "metres in [1, 50]")]


class Judge:
    """Judges missions with one goal in one world.

    Args:
        atlas: The world.
        spec: What the goal truly asks for.
        traveller: Who goes; decides what is reachable.
        success_radius_m: Metres, in [1, 50].
        camera_height_m: Of the eye that must have a line of sight, metres, in [0, 100].
        grader: A grader of the same atlas to share work with, or None.

    Raises:
        SettingsError: If a number is out of range.
    """

    def __init__(
        self,
        atlas: Atlas,
        spec: GoalSpec,
        *,
        traveller: Traveller,
        success_radius_m: float = 15.0,
        camera_height_m: float = 1.0,
        grader: Grader | None = None,
    ) -> None:
        faults = faults_of_radius(success_radius_m)
        if not 0.0 <= camera_height_m <= 100.0:
            faults.append(Fault(f"camera_height_m is {camera_height_m}", "metres in [0, 100]"))
        if faults:
            raise SettingsError("judge", faults)
        self.atlas = atlas
        self.spec = spec
        self.traveller = traveller
        self.success_radius_m = success_radius_m
        self.camera_height_m = camera_height_m
        self.grader = grader or Grader(atlas)
        self._cells: dict[int, NDArray[np.int64]] = {}
        self._ends: dict[tuple[float, float], tuple[float, tuple[float, float]] | None] = {}

    @cached_property
    def graded(self) -> tuple[Target, ...]:
        """Every object with a grade above 0, in the order of ids."""
        return self.grader.grade(self.spec)

    @cached_property
    def targets(self) -> tuple[Target, ...]:
        """The objects that pass, in the order of ids."""
        return tuple(target for target in self.graded if target.grade >= PASS_GRADE)

    @property
    def satisfying(self) -> tuple[tuple[int, int], ...]:
        """The objects that pass: (object id, grade)."""
        return tuple((target.object_id, target.grade) for target in self.targets)

    def success(self, x_m: float, y_m: float, z_m: float | None = None) -> SuccessReport:
        """Return what a declaration at a point would get.

        Args:
            x_m: East, metres.
            y_m: North, metres.
            z_m: Height of the eye, metres, or None for the camera's.

        Raises:
            InputError: If a number is not finite.
        """
        eye_m = self.camera_height_m if z_m is None else z_m
        _check_finite(x_m=x_m, y_m=y_m, z_m=eye_m)
        reach_m = max(*RADII_M, self.success_radius_m)
        at = shapely.Point(x_m, y_m)
        near = [] if not self.targets else self._index.query(at, predicate="dwithin", distance=reach_m + self._slack_m)
        nearest_m, found_m, found = math.inf, math.inf, None
        order = sorted((self.targets[i].distance_m(x_m, y_m), self.targets[i].object_id, int(i)) for i in near)
        for distance_m, _, place in order:
            nearest_m = min(nearest_m, distance_m)
            if distance_m <= reach_m and self._sees((x_m, y_m, eye_m), self.targets[place]):
                found_m, found = distance_m, self.targets[place]
                break
        if math.isinf(nearest_m) and self.targets:
            nearest_m = self.targets[int(self._index.nearest(at))].distance_m(x_m, y_m)
        success = found_m <= self.success_radius_m
        return SuccessReport(
            success=success,
            at_radius=tuple((radius_m, found_m <= radius_m) for radius_m in RADII_M),
            object_id=-1 if found is None else found.object_id,
            distance_m=found_m,
            nearest_m=nearest_m,
            grade=found.grade if found is not None and success else 0,
        )

    def in_view(self, x_m: float, y_m: float, headings_rad: Sequence[float], fov_rad: float) -> bool:
        """Return whether a declaration succeeds at a point for a thing that is in one of some views from there.

        A thing is in a view where a part of it that is within the success radius and in sight lies in the view's
        horizontal field.

        Args:
            x_m: East, metres.
            y_m: North, metres.
            headings_rad: Where the views look, compass.
            fov_rad: Horizontal field of view of each, radians, in (0, π).

        Raises:
            InputError: If a number is not finite or the field of view is out of range.
        """
        _check_finite(x_m=x_m, y_m=y_m, **{f"heading {i}": heading for i, heading in enumerate(headings_rad)})
        if not 0.0 < fov_rad < math.pi:
            raise InputError("view", [Fault(f"fov_rad is {fov_rad}", "radians in (0, π)")])
        reach_m, at = self.success_radius_m + self._slack_m, shapely.Point(x_m, y_m)
        places = self._index.query(at, predicate="dwithin", distance=reach_m) if self.targets else ()
        near = [self.targets[int(place)] for place in np.sort(places)]
        near = [target for target in near if target.distance_m(x_m, y_m) <= self.success_radius_m]
        if not near:
            return False
        field, eye = _field_of(x_m, y_m, headings_rad, fov_rad, self.success_radius_m), (x_m, y_m, self.camera_height_m)
        # Spots stand for what is near to them.
        return any(self._sees(eye, item, field.buffer(item.slack_m) if item.slack_m else field) for item in near)

    def review(self, track: Sequence[TrackPoint]) -> TrackReport:
        """Return what the judge says to a track of true positions, with at least one point.

        Raises:
            InputError: If the track is empty or a number in it is not finite.
        """
        if not track:
            raise InputError("track", [Fault("it is empty", "at least the start")])
        points = [(point.x_m, point.y_m) for point in track]
        flat = np.asarray(points, dtype=np.float64)
        bad = np.flatnonzero(~np.isfinite(flat).all(axis=1))
        if bad.size:
            raise InputError("track", [Fault(f"point {i} is {points[i]}", "finite metres") for i in bad[:10]])
        compliance = self.compliance(points)
        steps = np.hypot(*np.diff(flat, axis=0).T) if len(flat) > 1 else np.empty(0)
        at = np.concatenate(([0.0], np.cumsum(steps)))
        ticks = np.unique(np.concatenate((at, np.arange(0.0, at[-1], _TRACK_STEP_M))))
        in_time = ticks < compliance.violation_at_m
        xs, ys = np.interp(ticks, at, flat[:, 0])[in_time], np.interp(ticks, at, flat[:, 1])[in_time]
        oracle_at_m = math.inf
        for place in self._near_a_target(xs, ys):
            if self.success(float(xs[place]), float(ys[place])).success:
                oracle_at_m = float(ticks[place])
                break
        return TrackReport(
            end=self.success(*points[-1]),
            oracle_success=math.isfinite(oracle_at_m),
            oracle_at_m=oracle_at_m,
            compliance=compliance,
            length_m=float(at[-1]),
        )

    def compliance(self, points: Sequence[tuple[float, float]], *, excuse_start: bool = True) -> ComplianceReport:
        """Return whether a way, ENU metres, straight in between, keeps to the ground that the goal allows.

        A start on forbidden ground is excused (`compliance_of`), unless the way is only a part of one.
        """
        return compliance_of(
            points,
            self.atlas.ground,
            self.spec.forbidden,
            tolerated=self._is_tolerated,
            excuse_start=excuse_start,
        )

    def reference_length_m(self, start: Pose | tuple[float, float], *, max_m: float = math.inf) -> float:
        """Return the length of the shortest compliant way from a start to where a declaration succeeds, metres.

        0 where it succeeds at the start; infinity where there is no way, or none up to ``max_m``. A start on forbidden
        ground leaves it by the shortest way first, and that counts.

        Raises:
            InputError: If a number is not finite.
        """
        end = self._end(start, max_m)
        return math.inf if end is None else end[0]

    def reference_path(self, start: Pose | tuple[float, float]) -> NDArray[np.float64] | None:
        """Return the corners of that way, shape (n, 2), both ends included, or None where there is none."""
        x_m, y_m = _xy(start)
        end = self._end(start, math.inf)
        if end is None:
            return None
        if end[0] == 0.0:
            return np.asarray([[x_m, y_m], [x_m, y_m]])
        ways = self.atlas.geodesics
        moved_m, (from_x_m, from_y_m) = self._way_out(x_m, y_m)
        way = ways.path((from_x_m, from_y_m), end[1], traveller=self.traveller, shunned=self.spec.forbidden)
        if way is None or moved_m == 0.0:
            return way
        out = ways.path((x_m, y_m), (from_x_m, from_y_m), traveller=self.traveller)
        return way if out is None else np.concatenate((out[:-1], way))

    def success_mask(self) -> NDArray[np.bool_]:
        """Return the cells of the atlas's geodesic grid at whose centre a declaration succeeds, shape (rows, cols)."""
        grid = self.atlas.geodesics.grid
        mask = np.zeros(grid.rows * grid.cols, dtype=np.bool_)
        near = [self._cells_near(place) for place in range(len(self.targets))]
        cells = np.unique(np.concatenate(near)) if near else np.empty(0, dtype=np.int64)
        rows, cols = np.divmod(cells, grid.cols)
        xs_m, ys_m = grid.min_x_m + (cols + 0.5) * grid.cell_m, grid.min_y_m + (rows + 0.5) * grid.cell_m
        for target in self.targets:
            reach_m = self.success_radius_m + target.slack_m
            west, south, east, north = target.shape.bounds
            around = (xs_m >= west - reach_m) & (xs_m <= east + reach_m) & ~mask[cells]
            left = np.flatnonzero(around & (ys_m >= south - reach_m) & (ys_m <= north + reach_m))
            left = left[target.distances_m(xs_m[left], ys_m[left]) <= self.success_radius_m]
            seen = sees_many(self.atlas, target, xs_m[left], ys_m[left], eye_m=self.camera_height_m)
            mask[cells[left[seen]]] = True
        return mask.reshape(grid.rows, grid.cols)

    def blind_success_rate(self, places: Iterable[tuple[float, float]]) -> float:
        """Return the share of places at which a declaration would succeed, in [0, 1]; 0 where there are no places."""
        answers = [self.success(x_m, y_m).success for x_m, y_m in places]
        return sum(answers) / len(answers) if answers else 0.0

    @cached_property
    def _index(self) -> Any:
        return shapely.STRtree([target.shape for target in self.targets])

    @cached_property
    def _slack_m(self) -> float:
        return max((target.slack_m for target in self.targets), default=0.0)

    def _is_tolerated(self, xs_m: NDArray[np.float64], ys_m: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return which points the ground alone would let a compliant way pass through."""
        space = self.atlas.geodesics.space(_GHOST, shunned=self.spec.forbidden)
        grid = space.grid
        cols = np.clip((xs_m - grid.min_x_m) / grid.cell_m, 0, grid.cols - 1).astype(np.int64)
        rows = np.clip((ys_m - grid.min_y_m) / grid.cell_m, 0, grid.rows - 1).astype(np.int64)
        return np.asarray(space.clearance[rows, cols] > 0)

    def _near_a_target(self, xs_m: NDArray[np.float64], ys_m: NDArray[np.float64]) -> list[int]:
        """Return which points are within the success radius of something that passes, rising; sight is not asked."""
        if not self.targets:
            return []
        # Most of a track is far from everything: a coarse picture tells, at a thousandth of the cost of a query.
        near = np.flatnonzero(self._near.at(xs_m, ys_m))
        reach_m = self.success_radius_m + self._slack_m
        pairs = self._index.query(shapely.points(xs_m[near], ys_m[near]), predicate="dwithin", distance=reach_m)
        return [int(place) for place in near[np.unique(pairs[0])]]

    @cached_property
    def _near(self) -> "_Nearness":
        shapes = np.asarray([target.shape for target in self.targets], dtype=object)
        return _Nearness.of(shapely.bounds(shapes), self.success_radius_m + self._slack_m)

    @cached_property
    def remaining(self) -> DistanceField:
        """How far it is from everywhere to success, on compliant ground."""
        return self.atlas.geodesics.field_m(self.success_mask(), traveller=self.traveller, shunned=self.spec.forbidden)

    def _sees(self, eye: tuple[float, float, float], target: Target, field: Any = None) -> bool:
        """Return whether there is a line of sight to the thing: to its nearest point, its middle or its corners.

        With a field (shapely) only the part of it that lies in there is looked at.
        """
        shape = target.shape if field is None else shapely.intersection(target.shape, field)
        if shape.is_empty:
            return False
        at = shapely.Point(eye[0], eye[1])
        nearest = shapely.get_coordinates(shapely.shortest_line(at, shape))[1]
        fixed, heights = marks_of(self.atlas.world, target, shape, field)
        points = [(float(nearest[0]), float(nearest[1])), *fixed]
        clear = self.atlas.sight.clear
        return any(clear(*eye, x, y, z, ignore_object=target.object_id) for x, y in points for z in heights)

    def _end(self, start: Pose | tuple[float, float], max_m: float) -> tuple[float, tuple[float, float]] | None:
        """Return length and end of the reference way, or None."""
        x_m, y_m = _xy(start)
        _check_finite(x_m=x_m, y_m=y_m)
        if not self.targets:
            return None
        if self.success(x_m, y_m).success:
            return 0.0, (x_m, y_m)
        if (x_m, y_m) in self._ends:
            known = self._ends[x_m, y_m]
            return known if known is None or known[0] <= max_m else None
        moved_m, origin = self._way_out(x_m, y_m)
        if math.isinf(moved_m):
            return None
        reach_m = min(_FIRST_REACH_M, max_m)
        bounds = self.atlas.world.bounds
        # No way is needed that is longer than this: beyond it the search looks at everything.
        enough_m = 4.0 * math.hypot(bounds.width_m, bounds.height_m)
        while True:
            end = self._nearest_end(origin, reach_m)
            if end is not None or reach_m >= max_m or math.isinf(reach_m):
                break
            reach_m = min(max_m, 3.0 * reach_m if reach_m < enough_m else math.inf)
        if end is None:
            if math.isinf(max_m):
                self._ends[x_m, y_m] = None
            return None
        found = end[0] + moved_m, end[1]
        self._ends[x_m, y_m] = found
        return found if found[0] <= max_m else None

    def _nearest_end(self, origin: tuple[float, float], reach_m: float) -> tuple[float, tuple[float, float]] | None:
        """Return the nearest cell by way of the traveller, up to a length, where a declaration succeeds."""
        ways = self.atlas.geodesics
        field = ways.field_m(origin, traveller=self.traveller, shunned=self.spec.forbidden, max_m=reach_m)
        grid = ways.grid
        near = (
            range(len(self.targets))
            if math.isinf(reach_m)
            else self._index.query(
                shapely.Point(origin), predicate="dwithin", distance=reach_m + self.success_radius_m + self._slack_m
            )
        )
        cells = [self._cells_near(int(place)) for place in near]
        candidates = np.unique(np.concatenate(cells)) if cells else np.empty(0, dtype=np.int64)
        candidates = candidates[field.links[candidates] != 0]
        lengths_m = field.lengths[candidates].astype(np.float64) * grid.cell_m
        for place in np.lexsort((candidates, np.round(lengths_m, 4))):
            row, col = divmod(int(candidates[place]), grid.cols)
            x_m, y_m = grid.min_x_m + (col + 0.5) * grid.cell_m, grid.min_y_m + (row + 0.5) * grid.cell_m
            if lengths_m[place] <= reach_m and self.success(x_m, y_m).success:
                return float(lengths_m[place]), (x_m, y_m)
        return None

    def _cells_near(self, place: int) -> NDArray[np.int64]:
        """Return the flat indices of the cells whose centre is within the success radius of a target."""
        if place not in self._cells:
            target, grid = self.targets[place], self.atlas.geodesics.grid
            zone = shapely.buffer(target.shape, self.success_radius_m + target.slack_m, quad_segs=16)
            shapely.prepare(zone)
            west, south, east, north = zone.bounds
            cols = np.arange(
                max(0, math.floor((west - grid.min_x_m) / grid.cell_m)),
                min(grid.cols, math.ceil((east - grid.min_x_m) / grid.cell_m)),
            )
            rows = np.arange(
                max(0, math.floor((south - grid.min_y_m) / grid.cell_m)),
                min(grid.rows, math.ceil((north - grid.min_y_m) / grid.cell_m)),
            )
            all_cols, all_rows = (axis.ravel() for axis in np.meshgrid(cols, rows))
            inside = shapely.contains_xy(
                zone, grid.min_x_m + (all_cols + 0.5) * grid.cell_m, grid.min_y_m + (all_rows + 0.5) * grid.cell_m
            )
            self._cells[place] = (all_rows * grid.cols + all_cols)[inside].astype(np.int64)
        return self._cells[place]

    def _way_out(self, x_m: float, y_m: float) -> tuple[float, tuple[float, float]]:
        """Return how far compliant ground is from a start, and where; 0 m and the start itself if it is there."""
        forbidden = self.spec.forbidden
        ways = self.atlas.geodesics
        if not forbidden:
            return 0.0, (x_m, y_m)
        space = ways.space(self.traveller, shunned=forbidden)
        if space.places_near(x_m, y_m):
            return 0.0, (x_m, y_m)
        way = ways.path((x_m, y_m), space.free, traveller=self.traveller)
        if way is None:
            return math.inf, (x_m, y_m)
        return float(np.hypot(*np.diff(way, axis=0).T).sum()), (float(way[-1][0]), float(way[-1][1]))


def _field_of(x_m: float, y_m: float, headings_rad: Sequence[float], fov_rad: float, radius_m: float) -> Any:
    """Return the union of the sectors that views from a point cover, as a shapely geometry."""
    turns = np.linspace(-fov_rad / 2.0, fov_rad / 2.0, 17)
    # The corners lie a little outside of the arc, so that the chords between them do not cut it.
    reach_m = radius_m / math.cos(fov_rad / 32.0)
    sectors = [
        shapely.Polygon(
            [(x_m, y_m), *zip(x_m + reach_m * np.sin(h + turns), y_m + reach_m * np.cos(h + turns), strict=True)]
        )
        for h in headings_rad
    ]
    return shapely.union_all(sectors)


@dataclass(frozen=True, slots=True, eq=False)
class _Nearness:
    """A coarse picture of what may be near to some boxes: wrong only in saying so too often."""

    mask: NDArray[np.bool_]
    min_x_m: float
    min_y_m: float

    @classmethod
    def of(cls, boxes: NDArray[np.float64], reach_m: float) -> "_Nearness":
        """Return the picture for boxes of shape (n, 4): west, south, east, north, metres."""
        grown = boxes + np.array([-reach_m, -reach_m, reach_m, reach_m])
        min_x_m, min_y_m = grown[:, :2].min(axis=0)
        low = ((grown[:, :2] - (min_x_m, min_y_m)) / _NEARNESS_M).astype(np.int64)
        high = ((grown[:, 2:] - (min_x_m, min_y_m)) / _NEARNESS_M).astype(np.int64) + 1
        cols, rows = high.max(axis=0)
        mask = np.zeros((rows, cols), dtype=np.bool_)
        for (col, row), (col_end, row_end) in zip(low.tolist(), high.tolist(), strict=True):
            mask[row:row_end, col:col_end] = True
        return cls(mask, float(min_x_m), float(min_y_m))

    def at(self, xs_m: NDArray[np.float64], ys_m: NDArray[np.float64]) -> NDArray[np.bool_]:
        """Return which points may be near."""
        cols = np.floor((xs_m - self.min_x_m) / _NEARNESS_M).astype(np.int64)
        rows = np.floor((ys_m - self.min_y_m) / _NEARNESS_M).astype(np.int64)
        inside = (cols >= 0) & (rows >= 0) & (cols < self.mask.shape[1]) & (rows < self.mask.shape[0])
        found = np.zeros(len(xs_m), dtype=np.bool_)
        found[inside] = self.mask[rows[inside], cols[inside]]
        return found


def _xy(start: Pose | tuple[float, float]) -> tuple[float, float]:
    return (start.x_m, start.y_m) if isinstance(start, Pose) else start


def _check_finite(**values: float) -> None:
    faults = [
        Fault(f"{name} is {value}", "a finite number") for name, value in values.items() if not math.isfinite(value)
    ]
    if faults:
        raise InputError("place to judge", faults)
