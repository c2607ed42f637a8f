"""Objects of a map: where they stand, how large they are, which way they face, which door leads to them."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import shapely

from reasoned_explorer.geometry import heading_towards_rad, normalise_heading_rad
from reasoned_explorer.model.draws import uniform
from reasoned_explorer.world.osm.buildings import BuildingSet, is_building
from reasoned_explorer.world.osm.features import NODE, Feature
from reasoned_explorer.world.osm.paths import PathIndex
from reasoned_explorer.world.osm.shapes import clip, lines_of, polygons_of, ring_of
from reasoned_explorer.world.osm.tags import (
    CLASS_KEYS,
    Tags,
    attributes_of,
    class_of,
    is_below_ground,
    is_set,
    parse_count,
    parse_direction_rad,
    parse_length_m,
)
from reasoned_explorer.world.taxonomy import OBJECT_CLASSES
from reasoned_explorer.world.world import Bounds, Ring, WorldObject

_TREE_ROW_SPACING_M = 8.0
_MIN_AREA_M2 = {"lawn": 25.0, "playground": 10.0, "pitch": 20.0}
# A point of a place that stands this close to a building belongs to it (drawn on the door, or just before it).
_AT_THE_WALL_M = 2.0
# One stands this far before the door that one has come to.
_DOORSTEP_M = 0.5
# It keeps this clear of every wall, so that it is open ground in a picture with cells of half a metre, too.
_CLEAR_M = 0.36
_FARTHEST_OUT_M = 80.0
# A mapped door counts as a place's own where it is at most this much farther off than the nearest wall to a street.
_DOOR_DETOUR_M = 20.0
_MOST_HOUSES_DEEP = 6
# What stands at most this far inside a wall on the map hangs on it; its middle goes this far before it.
_INSIDE_THE_WALL_M = 1.0
_WALL_GAP_M = 0.3
_KERB_GAP_M = 0.6
_MIN_SIZE_M, _MAX_SIZE_M = 0.05, 80.0
_ON_THE_ROAD = frozenset({"traffic_signals", "traffic_sign", "bus_stop"})
_SEAT_M, _STAND_M = 0.6, 0.6


@dataclass(slots=True)
class _Draft:
    """An object while it is being made."""

    feature: Feature
    class_name: str
    x_m: float
    y_m: float
    size_m: tuple[float, float, float]
    heading_rad: float | None = None
    outline: Ring | None = None
    building: int = -1


@dataclass(frozen=True, slots=True, eq=False)
class ObjectSet:
    """Objects, and counts for the report."""

    objects: tuple[WorldObject, ...]
    counts: dict[str, int] = field(default_factory=dict)


def objects_of(
    points: Sequence[Feature],
    lines: Sequence[Feature],
    areas: Sequence[Feature],
    *,
    buildings: BuildingSet,
    paths: PathIndex,
    bounds: Bounds,
    seed: int,
) -> ObjectSet:
    """Make the objects of a map; their order is nodes, ways, multipolygons, each by id, then the trees of rows."""
    counts = {"underground or indoor objects dropped": 0, "objects inside buildings dropped": 0,
              "objects moved out of walls": 0}  # fmt: skip
    drafts: list[_Draft] = []
    for feature in (*points, *_cut(lines, bounds), *_cut(areas, bounds)):
        drafts += _draft(feature, seed, counts) or ()
    drafts.sort(key=lambda draft: (draft.feature.tags.get("natural") == "tree_row", draft.feature.kind))
    _set_beside_the_road(drafts, paths)
    drafts = _settle(drafts, buildings, counts)
    _go_to_the_doors(drafts, buildings, paths)
    _face(drafts, paths, seed)
    kept = [draft for draft in drafts if bounds.contains(draft.x_m, draft.y_m)]
    objects = tuple(_finished(at, draft) for at, draft in enumerate(kept))
    return ObjectSet(objects, {**counts, "objects": len(objects)})


def _cut(features: Sequence[Feature], bounds: Bounds) -> list[Feature]:
    """Return what can be objects, cut off at the bounds, so that their middles are inside."""
    candidates = [one for one in features if not CLASS_KEYS.isdisjoint(one.tags)]
    if not candidates:
        return []
    shapes = clip([one.shape for one in candidates], bounds)
    return [
        one if shape is one.shape else replace(one, shape=shape)
        for one, shape in zip(candidates, shapes, strict=True)
        if not shape.is_empty
    ]


def _draft(feature: Feature, seed: int, counts: dict[str, int]) -> list[_Draft] | None:
    tags = feature.tags
    if tags.get("natural") == "tree_row" and feature.kind != NODE:
        return _row_of_trees(feature, seed)
    name = class_of(tags, is_node=feature.kind == NODE)
    if name is None or (name == "lawn" and feature.kind == NODE):
        return None  # a park's name on a point says nothing about where its lawn is
    kind = OBJECT_CLASSES[name].kind
    if kind != "place" and (is_below_ground(tags) or is_set(tags, "indoor")):
        counts["underground or indoor objects dropped"] += 1
        return None
    size_m = _size_m(name, tags, seed, feature.osm_id)
    if feature.kind == NODE:
        x_m, y_m = feature.shape.x, feature.shape.y
        return [_Draft(feature, name, x_m, y_m, size_m, parse_direction_rad(tags.get("direction")))]
    if feature.shape.area == 0.0:
        is_line = kind != "area" and feature.shape.length > 0.0
        return [_from_line(feature, name, size_m)] if is_line else None
    return _from_area(feature, name, size_m)


def _from_line(feature: Feature, name: str, size_m: tuple[float, float, float]) -> _Draft:
    """Make an object that is drawn as a line: as long as the line, in its middle, its front to the right of it."""
    line = max(lines_of(feature.shape), key=lambda part: (part.length, part.bounds))
    middle = line.interpolate(0.5, normalized=True)
    start, end = shapely.get_coordinates(line)[[0, -1]]
    length_m = min(max(float(line.length), _MIN_SIZE_M), _MAX_SIZE_M)
    heading_rad = parse_direction_rad(feature.tags.get("direction"))
    if heading_rad is None and not np.array_equal(start, end):
        along_rad = heading_towards_rad(start[0], start[1], end[0], end[1])
        heading_rad = normalise_heading_rad(along_rad + math.pi / 2.0)
    strip = next(polygons_of(shapely.buffer(line, size_m[1] / 2.0, cap_style="flat", join_style="mitre")), None)
    outline = None if strip is None else ring_of(strip.exterior)
    return _Draft(feature, name, middle.x, middle.y, (length_m, size_m[1], size_m[2]), heading_rad, outline)


def _from_area(feature: Feature, name: str, size_m: tuple[float, float, float]) -> list[_Draft]:
    drafts = []
    for polygon in polygons_of(feature.shape, min_area_m2=_MIN_AREA_M2.get(name, 0.0)):
        centre = polygon.centroid
        if not polygon.contains(centre):
            centre = polygon.representative_point()
        length_m, width_m, front_rad = _rectangle(polygon)
        tagged_rad = parse_direction_rad(feature.tags.get("direction"))
        drafts.append(
            _Draft(feature, name, centre.x, centre.y, (length_m, width_m, size_m[2]),
                   front_rad if tagged_rad is None else tagged_rad, ring_of(polygon.exterior))
        )  # fmt: skip
    # Several stretches of lawn are several lawns; of anything else, the largest stands for all.
    if name != "lawn" and len(drafts) > 1:
        drafts = [max(drafts, key=lambda draft: (draft.size_m[0] * draft.size_m[1], draft.x_m, draft.y_m))]
    return drafts


def _rectangle(polygon: Any) -> tuple[float, float, float]:
    """Return the long side, the short side and the heading across the long side of the smallest rectangle around."""
    corners = shapely.get_coordinates(shapely.minimum_rotated_rectangle(polygon))
    if len(corners) < 4:
        return _MIN_SIZE_M, _MIN_SIZE_M, 0.0
    first, second = corners[1] - corners[0], corners[2] - corners[1]
    sides = [float(np.hypot(*first)), float(np.hypot(*second))]
    along = first if sides[0] >= sides[1] else second
    heading_rad = normalise_heading_rad(math.atan2(along[0], along[1]) + math.pi / 2.0)
    long_m, short_m = max(sides), min(sides)
    return max(long_m, _MIN_SIZE_M), max(short_m, _MIN_SIZE_M), heading_rad


def _row_of_trees(feature: Feature, seed: int) -> list[_Draft]:
    drafts = []
    for line in lines_of(shapely.boundary(feature.shape) if feature.shape.area > 0 else feature.shape):
        count = max(1, round(line.length / _TREE_ROW_SPACING_M))
        for step in range(count + 1):
            point = line.interpolate(step / count, normalized=True)
            size_m = _size_m("tree", feature.tags, seed, feature.osm_id * 4096 + step)
            drafts.append(_Draft(feature, "tree", point.x, point.y, size_m))
    return drafts


def _size_m(name: str, tags: Tags, seed: int, key: int) -> tuple[float, float, float]:
    """Return an object's size: its tags where they make sense, else its class's; trees vary, by seed."""
    length_m, width_m, height_m = OBJECT_CLASSES[name].size_m
    if name == "tree":
        height_m = _ranged(tags.get("height"), height_m * (0.7 + 0.7 * uniform(seed, "tree height", key)), 1.0, 60.0)
        # Crowns of town trees spread over about two thirds of their height (assumed).
        usual_m = height_m * (0.5 + 0.3 * uniform(seed, "tree crown", key))
        crown_m = _ranged(tags.get("diameter_crown"), min(usual_m, 14.0), 0.5, 40.0)
        return crown_m, crown_m, height_m
    if OBJECT_CLASSES[name].kind == "furniture":
        height_m = _ranged(tags.get("height"), height_m, 0.1, 60.0)
        if name == "fire_hydrant" and tags.get("fire_hydrant:type") == "underground":
            height_m = _MIN_SIZE_M  # a lid in the ground
        if name == "bench" and (seats := parse_count(tags.get("seats"))) is not None and 1.0 <= seats <= 60.0:
            length_m = seats * _SEAT_M
        if name == "bicycle_parking" and (stands := parse_count(tags.get("capacity"))) is not None:
            length_m = min(max(stands * _STAND_M, 1.0), 30.0)
        length_m = _ranged(tags.get("length"), length_m, _MIN_SIZE_M, _MAX_SIZE_M)
        width_m = _ranged(tags.get("width"), width_m, _MIN_SIZE_M, _MAX_SIZE_M)
        diameter_m = parse_length_m(tags.get("diameter"))
        if diameter_m is not None and _MIN_SIZE_M <= diameter_m <= _MAX_SIZE_M:
            length_m = width_m = diameter_m
    return length_m, width_m, height_m


def _ranged(text: str | None, default_m: float, low_m: float, high_m: float) -> float:
    value_m = parse_length_m(text)
    return value_m if value_m is not None and low_m <= value_m <= high_m else default_m


def _set_beside_the_road(drafts: Sequence[_Draft], paths: PathIndex) -> None:
    """Move signals, signs and stops that are drawn on a road's centre line to its kerb, facing the traffic."""
    on_road = [draft for draft in drafts if draft.class_name in _ON_THE_ROAD and draft.feature.kind == NODE]
    for draft, road in zip(on_road, paths.roads_at([(draft.x_m, draft.y_m) for draft in on_road]), strict=True):
        if road is None:
            continue
        backward = "backward" in {draft.feature.tags.get("direction"),
                                  draft.feature.tags.get("traffic_signals:direction")}  # fmt: skip
        along_rad = normalise_heading_rad(road.heading_rad + (math.pi if backward else 0.0))
        aside_m = road.width_m / 2.0 + _KERB_GAP_M
        draft.x_m += aside_m * math.cos(along_rad)
        draft.y_m -= aside_m * math.sin(along_rad)
        if draft.heading_rad is None:
            draft.heading_rad = normalise_heading_rad(along_rad + math.pi)


def _settle(drafts: list[_Draft], buildings: BuildingSet, counts: dict[str, int]) -> list[_Draft]:
    """Find out what is in which building; drop the furniture that is, unless it is the building itself."""
    points = shapely.points([(draft.x_m, draft.y_m) for draft in drafts]) if drafts else []
    inside = buildings.containing(points)
    near = buildings.nearest(points, reach_m=_AT_THE_WALL_M)
    kept = []
    for draft, within, beside in zip(drafts, inside.tolist(), near.tolist(), strict=True):
        itself = draft.feature.kind != NODE and is_building(draft.feature.tags)
        if draft.class_name == "kiosk" and within >= 0 and not itself:
            draft.class_name = "shop"  # a kiosk in a house is a small shop
            draft.size_m = OBJECT_CLASSES["shop"].size_m
        kind = OBJECT_CLASSES[draft.class_name].kind
        if kind == "place":
            draft.building = within if within >= 0 else beside
        elif itself:
            draft.building = within
        elif within >= 0 and kind != "area":
            if not _hang_on_the_wall(draft, buildings.footprints[within]):
                counts["objects inside buildings dropped"] += 1
                continue
            counts["objects moved out of walls"] += 1
        kept.append(draft)
    return kept


def _hang_on_the_wall(draft: _Draft, footprint: Any) -> bool:
    """Move what is drawn just inside a wall (a mailbox, a sign) to its outer side; return whether it was that close."""
    here = shapely.Point(draft.x_m, draft.y_m)
    if draft.outline is not None or here.distance(footprint.boundary) > _INSIDE_THE_WALL_M:
        return False
    wall = footprint.boundary.interpolate(footprint.boundary.project(here))
    outward_rad = _outward_rad(wall, footprint)
    if outward_rad is None:
        return False
    draft.x_m = wall.x + _WALL_GAP_M * math.sin(outward_rad)
    draft.y_m = wall.y + _WALL_GAP_M * math.cos(outward_rad)
    draft.heading_rad = outward_rad
    return True


def _go_to_the_doors(drafts: Sequence[_Draft], buildings: BuildingSet, paths: PathIndex) -> None:
    """Move places in buildings to the step before their door, facing out."""
    indoor = [draft for draft in drafts if draft.building >= 0 and OBJECT_CLASSES[draft.class_name].kind == "place"]
    targets = paths.nearest_points([(draft.x_m, draft.y_m) for draft in indoor])
    for draft, target in zip(indoor, targets, strict=True):
        door = _door(draft, buildings, target)
        if door is None:
            continue
        draft.x_m, draft.y_m, draft.heading_rad = door


def _door(
    draft: _Draft, buildings: BuildingSet, target: tuple[float, float] | None
) -> tuple[float, float, float] | None:
    """Return the step before a place's door and the heading out of it, or None where no way leads out.

    Where the wall that one comes to is shared with another building (or part of the same), the way leads on through it.
    """
    building, here = draft.building, shapely.Point(draft.x_m, draft.y_m)
    for _ in range(_MOST_HOUSES_DEEP):
        footprint = buildings.footprints[building]
        wall = _wall_towards(here, footprint, target)
        doors = buildings.buildings[building].entrances
        steps = [_step_before(wall, footprint)]
        if len(doors):
            away_m = np.hypot(doors[:, 0] - here.x, doors[:, 1] - here.y)
            nearest = int(np.argmin(away_m))
            if away_m[nearest] <= here.distance(wall) + _DOOR_DETOUR_M:
                steps.insert(0, _step_before(shapely.Point(doors[nearest]), footprint))
        outside = [step for step in steps if step is not None]
        if not outside:
            break
        points = shapely.points([step[:2] for step in outside])
        # A step between two walls that nearly touch is none.
        for step, near in zip(outside, buildings.nearest(points, reach_m=_CLEAR_M).tolist(), strict=True):
            if near < 0:
                return step
        others = buildings.containing(points).tolist()
        if others[-1] < 0:
            break
        building, here = others[-1], shapely.Point(outside[-1][:2])
    if target is None:
        return None
    # The nearest way leads through the house itself: take the nearest wall instead.
    return _out_towards(draft, buildings, target) or _door(draft, buildings, None) or _out_anywhere(draft, buildings)


def _out_towards(
    draft: _Draft, buildings: BuildingSet, target: tuple[float, float]
) -> tuple[float, float, float] | None:
    """Return the first open spot on the straight line to the nearest way, facing on along it."""
    gap_m = math.hypot(target[0] - draft.x_m, target[1] - draft.y_m)
    share = np.linspace(0.0, 1.0, max(2, math.ceil(gap_m / _DOORSTEP_M) + 1))
    spots = np.column_stack([draft.x_m + share * (target[0] - draft.x_m), draft.y_m + share * (target[1] - draft.y_m)])
    return _first_open(draft, buildings, spots)


def _out_anywhere(draft: _Draft, buildings: BuildingSet) -> tuple[float, float, float] | None:
    """Return about the nearest open spot, for places deep in large buildings whose ways are indoors."""
    turns = np.arange(24) * (math.pi / 12.0)
    reach_m = np.repeat(np.arange(1.0, _FARTHEST_OUT_M, 1.0), len(turns))
    turns = np.tile(turns, len(reach_m) // len(turns))
    around = np.column_stack([np.sin(turns), np.cos(turns)]) * reach_m[:, None]
    return _first_open(draft, buildings, np.array([draft.x_m, draft.y_m]) + around)


def _first_open(draft: _Draft, buildings: BuildingSet, spots: Any) -> tuple[float, float, float] | None:
    """Return the first of some spots that keeps clear of all walls, facing away from where the place is drawn."""
    points = shapely.points(spots)
    free = np.flatnonzero(buildings.nearest(points, reach_m=_CLEAR_M) < 0)
    if not len(free):
        return None
    x_m, y_m = (float(value) for value in spots[free[0]])
    return x_m, y_m, heading_towards_rad(draft.x_m, draft.y_m, x_m, y_m)


def _step_before(wall: Any, footprint: Any) -> tuple[float, float, float] | None:
    outward_rad = _outward_rad(wall, footprint)
    if outward_rad is None:
        return None
    return (
        wall.x + _DOORSTEP_M * math.sin(outward_rad),
        wall.y + _DOORSTEP_M * math.cos(outward_rad),
        outward_rad,
    )


def _wall_towards(here: Any, footprint: Any, target: tuple[float, float] | None) -> Any:
    """Return the point of the wall where one comes out on the straight line to the nearest way."""
    if target is not None:
        crossing = shapely.intersection(shapely.LineString([(here.x, here.y), target]), footprint.exterior)
        points = shapely.get_coordinates(crossing)
        if len(points):
            away = np.hypot(points[:, 0] - here.x, points[:, 1] - here.y)
            return shapely.Point(points[int(np.argmax(away))])
    ring = footprint.exterior
    return ring.interpolate(ring.project(here))


def _outward_rad(wall: Any, footprint: Any) -> float | None:
    """Return the heading that leads straight out of a footprint at a point of its outline."""
    for ring in (footprint.exterior, *footprint.interiors):
        points = shapely.get_coordinates(ring)
        start, end = points[:-1], points[1:]
        along = end - start
        length = np.hypot(along[:, 0], along[:, 1])
        length[length == 0.0] = np.inf
        to = np.array([wall.x, wall.y]) - start
        share = np.clip((to * along).sum(axis=1) / length**2, 0.0, 1.0)
        gap = np.hypot(*(to - share[:, None] * np.where(np.isfinite(length)[:, None], along, 0.0)).T)
        # A door at a corner is on either wall; the longer one is the front.
        close = np.flatnonzero(gap <= gap.min() + 0.05)
        if gap.min() > 1.0:
            continue
        best = int(close[np.argmax(np.where(np.isfinite(length[close]), length[close], 0.0))])
        across_rad = math.atan2(along[best, 0], along[best, 1]) + math.pi / 2.0
        for heading_rad in (across_rad, across_rad + math.pi):
            probe_x_m, probe_y_m = wall.x + 0.2 * math.sin(heading_rad), wall.y + 0.2 * math.cos(heading_rad)
            if not shapely.intersects_xy(footprint, probe_x_m, probe_y_m):
                return normalise_heading_rad(heading_rad)
    return None


def _face(drafts: Sequence[_Draft], paths: PathIndex, seed: int) -> None:
    """Have what faces nowhere yet face the nearest way; what is drawn as a line or area picks the side of it."""
    targets = paths.nearest_points([(draft.x_m, draft.y_m) for draft in drafts])
    for draft, target in zip(drafts, targets, strict=True):
        tagged = parse_direction_rad(draft.feature.tags.get("direction")) is not None
        if draft.class_name == "tree":
            draft.heading_rad = uniform(seed, "tree turn", draft.feature.osm_id) * 2.0 * math.pi
            continue
        if tagged or draft.building >= 0 or target is None:
            continue
        gap_m = math.hypot(target[0] - draft.x_m, target[1] - draft.y_m)
        towards_rad = heading_towards_rad(draft.x_m, draft.y_m, target[0], target[1])
        if draft.heading_rad is None:
            draft.heading_rad = towards_rad if gap_m > 0.05 else 0.0
        elif draft.outline is not None and math.cos(towards_rad - draft.heading_rad) < 0.0:
            draft.heading_rad = normalise_heading_rad(draft.heading_rad + math.pi)


def _finished(at: int, draft: _Draft) -> WorldObject:
    return WorldObject(
        id=at,
        class_name=draft.class_name,
        x_m=float(draft.x_m),
        y_m=float(draft.y_m),
        heading_rad=float(draft.heading_rad or 0.0),
        size_m=(float(draft.size_m[0]), float(draft.size_m[1]), float(draft.size_m[2])),
        attributes=attributes_of(draft.feature.tags),
        outline=draft.outline,
        building=draft.building,
    )
