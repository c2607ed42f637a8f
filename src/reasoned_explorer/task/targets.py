"""Which things of a world satisfy a goal: the grades of its objects, and where exactly they hold.

A thing is graded as a whole. A stretch of ground (a lawn) is large: a condition such as "under a tree" holds for some
spots of it and not for others, so it is graded spot by spot, on a grid of 2 m or more and at every tree that stands on
it, and what satisfies is the set of those spots.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from reasoned_explorer.task.goal_spec import Condition, GoalSpec, Relation, Sought
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.raster import ROOF_CLEARANCE_M
from reasoned_explorer.world.taxonomy import OBJECT_CLASSES
from reasoned_explorer.world.world import WorldObject

#: Two footprints this near to each other touch, metres.
CONTACT_M = 0.3
_SPOT_SPACING_M = 2.0
_MAX_SPOTS = 4000

Geometries = NDArray[Any]
Ids = NDArray[np.int64]
Flags = NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class Target:
    """A thing and its grade.

    Attributes:
        object_id: Place in the world's list of objects.
        grade: 0 to 2.
        shape: Where it satisfies (shapely): its footprint, the point of its entrance, or spots of it.
        slack_m: Spots stand for what is this near to them, metres; 0 for footprints.
        why: The reason for the grade, for people.
    """

    object_id: int
    grade: int
    shape: Any
    slack_m: float = 0.0
    why: str = ""

    def distance_m(self, x_m: float, y_m: float) -> float:
        """Return the distance from a point to where it satisfies, metres, to the micrometre."""
        return max(0.0, round(float(shapely.distance(self.shape, shapely.Point(x_m, y_m))) - self.slack_m, 6))

    def distances_m(self, xs_m: NDArray[np.float64], ys_m: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the distance from each of many points, likewise."""
        apart_m = shapely.distance(self.shape, shapely.points(xs_m, ys_m)) - self.slack_m
        distances_m: NDArray[np.float64] = np.maximum(np.round(apart_m, 6), 0.0)
        return distances_m


class Grader:
    """Grades the objects of one world; keeps footprints, so that many goals of a world share the work.

    Args:
        atlas: The world.
    """

    def __init__(self, atlas: Atlas) -> None:
        self._atlas = atlas
        self._footprints: dict[str, tuple[Ids, Geometries]] = {}
        self._indices: dict[str, Any] = {}

    def grade(self, spec: GoalSpec) -> tuple[Target, ...]:
        """Return every object that has a grade above 0, with its highest grade, in the order of ids."""
        best: dict[int, Target] = {}
        # Highest grades first, so that the first row that holds decides; rows of equal grade as they stand.
        for row in sorted(spec.sought, key=lambda item: -item.grade):
            if row.grade > 0:
                for target in self._meeting(row):
                    best.setdefault(target.object_id, target)
        return tuple(best[object_id] for object_id in sorted(best))

    def _meeting(self, row: Sought) -> list[Target]:
        ids, shapes = self._of_class(row.class_name)
        objects = self._atlas.world.objects
        if row.attributes:
            passing = [all(test.holds(objects[i].attributes) for test in row.attributes) for i in ids]
            chosen = np.asarray(passing, dtype=np.bool_).reshape(-1)
            ids, shapes = ids[chosen], shapes[chosen]
        if row.conditions and OBJECT_CLASSES[row.class_name].kind == "area":
            return [target for i, shape in zip(ids, shapes, strict=True) for target in self._spots(int(i), shape, row)]
        holds = self._hold(row.conditions, ids, shapes)
        return [
            Target(int(i), row.grade, shape, why=row.why) for i, shape in zip(ids[holds], shapes[holds], strict=True)
        ]

    def _spots(self, object_id: int, shape: Any, row: Sought) -> list[Target]:
        """Return the part of an area that meets all conditions, if there is one."""
        spacing_m = max(_SPOT_SPACING_M, math.sqrt(shape.area / _MAX_SPOTS))
        west, south, east, north = shape.bounds
        xs = np.arange(west + spacing_m / 2.0, east, spacing_m)
        ys = np.arange(south + spacing_m / 2.0, north, spacing_m)
        grid_x, grid_y = (axis.ravel() for axis in np.meshgrid(xs, ys))
        inside = shapely.contains_xy(shape, grid_x, grid_y)
        spots = [
            shapely.points(grid_x[inside], grid_y[inside]),
            shapely.points([shape.representative_point().coords[0]]),
        ]
        for condition in row.conditions:
            if condition.negated or condition.relation is Relation.ON:
                continue
            for name in condition.classes:
                others, anchors = self._of_class(name)
                near = self._index_of(name).query(shape, predicate="intersects")
                # Where an anchor's middle is outside, its crown still covers the rim; the grid finds that or not.
                middles = shapely.centroid(anchors[near[others[near] != object_id]])
                spots.append(middles[shapely.intersects(shape, middles)])
        pieces = np.concatenate(spots)
        holds = self._hold(row.conditions, np.full(len(pieces), object_id, dtype=np.int64), pieces)
        if not holds.any():
            return []
        return [Target(object_id, row.grade, shapely.union_all(pieces[holds]), spacing_m / 2.0, row.why)]

    def _hold(self, conditions: Sequence[Condition], ids: Ids, shapes: Geometries) -> Flags:
        holds = np.ones(len(ids), dtype=np.bool_)
        for condition in conditions:
            left = np.flatnonzero(holds)
            if left.size:
                holds[left] = self._stands(condition, ids[left], shapes[left]) != condition.negated
        return holds

    def _stands(self, condition: Condition, ids: Ids, shapes: Geometries) -> Flags:
        """Return which things stand so, before negation."""
        stands = np.zeros(len(ids), dtype=np.bool_)
        middles = shapely.centroid(shapes)
        for name in condition.classes:
            others, index = self._of_class(name)[0], self._index_of(name)
            if condition.relation is Relation.UNDER:
                pairs = index.query(middles, predicate="intersects")
            else:
                reach_m = condition.distance_m if condition.relation is Relation.NEAR else CONTACT_M
                pairs = index.query(shapes, predicate="dwithin", distance=reach_m)
            stands[pairs[0][others[pairs[1]] != ids[pairs[0]]]] = True
        if condition.buildings:
            stands |= self._by_building(condition, shapes, middles)
        if condition.grounds:
            stands |= self._by_ground(condition, shapes, middles)
        return stands

    def _by_building(self, condition: Condition, shapes: Geometries, middles: Geometries) -> Flags:
        near = np.zeros(len(shapes), dtype=np.bool_)
        if condition.relation is Relation.UNDER:
            pairs = self._roofs.query(middles, predicate="intersects")
        else:
            reach_m = condition.distance_m if condition.relation is Relation.NEAR else CONTACT_M
            pairs = self._buildings.query(shapes, predicate="dwithin", distance=reach_m)
        near[pairs[0]] = True
        return near

    def _by_ground(self, condition: Condition, shapes: Geometries, middles: Geometries) -> Flags:
        codes = np.zeros(256, dtype=np.bool_)
        codes[[int(ground) for ground in condition.grounds]] = True
        near = np.zeros(len(shapes), dtype=np.bool_)
        if condition.relation is not Relation.NEAR:
            near[:] = codes[self._atlas.ground.at_many(shapely.get_x(middles), shapely.get_y(middles))]
            return near
        corners, owners = shapely.get_coordinates(np.concatenate((shapes, middles)), return_index=True)
        owners = owners % len(shapes)
        for dx, dy in _offsets(condition.distance_m):
            left = ~near[owners]
            corners, owners = corners[left], owners[left]
            if not owners.size:
                break
            near[owners[codes[self._atlas.ground.at_many(corners[:, 0] + dx, corners[:, 1] + dy)]]] = True
        return near

    def _of_class(self, name: str) -> tuple[Ids, Geometries]:
        if name not in self._footprints:
            ids = np.asarray(self._atlas.index.of_class(name), dtype=np.int64)
            shapes = [footprint_of(self._atlas.world.objects[i]) for i in ids]
            array = np.empty(len(shapes), dtype=object)
            array[:] = shapes
            self._footprints[name] = ids, array
        return self._footprints[name]

    def _index_of(self, name: str) -> Any:
        if name not in self._indices:
            self._indices[name] = shapely.STRtree(self._of_class(name)[1])
        return self._indices[name]

    @cached_property
    def _buildings(self) -> Any:
        return shapely.STRtree([_polygon(b.outer, b.holes) for b in self._atlas.world.buildings])

    @cached_property
    def _roofs(self) -> Any:
        roofs = [b for b in self._atlas.world.buildings if b.min_height_m > ROOF_CLEARANCE_M]
        return shapely.STRtree([_polygon(b.outer, b.holes) for b in roofs])


def footprint_of(item: WorldObject) -> Any:
    """Return an object's footprint as a shapely geometry.

    A place is the point of its entrance, a tree the disc of its crown, what has an outline on the map is that outline,
    and everything else the rectangle of its length and width, turned to its heading.
    """
    if item.object_class.kind == "place":
        return shapely.Point(item.x_m, item.y_m)
    if item.outline is not None and len(item.outline) >= 3:
        return _polygon(item.outline, ())
    length_m, width_m, _ = item.size_m
    if item.class_name == "tree":
        return shapely.Point(item.x_m, item.y_m).buffer((length_m + width_m) / 4.0, quad_segs=4)
    sin, cos = math.sin(item.heading_rad), math.cos(item.heading_rad)
    half_l, half_w = max(length_m, 0.01) / 2.0, max(width_m, 0.01) / 2.0
    # Its front faces (sin, cos); its length lies across, along (cos, -sin).
    return shapely.Polygon(
        [
            (item.x_m + a * half_l * cos + b * half_w * sin, item.y_m - a * half_l * sin + b * half_w * cos)
            for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))
        ]
    )


def _polygon(outer: Any, holes: Sequence[Any]) -> Any:
    polygon = shapely.Polygon(outer, list(holes))
    return polygon if polygon.is_valid else shapely.make_valid(polygon)


def _offsets(radius_m: float) -> list[tuple[float, float]]:
    """Return steps within a radius, 1 m apart or less, the nearest first."""
    step_m = min(1.0, radius_m / 4.0)
    count = math.floor(radius_m / step_m + 1e-9)
    ticks = [k * step_m for k in range(-count, count + 1)]
    steps = [(dx, dy) for dx in ticks for dy in ticks if dx * dx + dy * dy <= radius_m * radius_m + 1e-9]
    return sorted(steps, key=lambda step: (round(math.hypot(*step), 6), step))
