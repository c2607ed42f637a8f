"""An extract in the world's own frame: areas put together, everything in ENU metres."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from reasoned_explorer.geometry import GeoOrigin
from reasoned_explorer.world.osm.ground import is_area
from reasoned_explorer.world.osm.reading import Extract, NodeRecord
from reasoned_explorer.world.osm.shapes import box_of
from reasoned_explorer.world.osm.tags import Tags
from reasoned_explorer.world.world import Bounds

#: Ids in `Feature` and in draws: nodes, ways and relations have ids of their own, so the type belongs to the key.
NODE, WAY, RELATION = range(3)


@dataclass(frozen=True, slots=True, eq=False)
class Feature:
    """Something with tags and a shape.

    Attributes:
        kind: `NODE`, `WAY` or `RELATION`.
        osm_id: Its id within its kind.
        tags: Its tags.
        shape: A shapely point, line, or (multi)polygon; ENU metres.
    """

    kind: int
    osm_id: int
    tags: Tags
    shape: Any


@dataclass(frozen=True, slots=True, eq=False)
class FeatureSet:
    """What is on the map within and around some bounds.

    Attributes:
        points: Nodes with tags, inside the bounds.
        lines: Ways that are lines, touching the bounds.
        areas: Ways and multipolygons that are areas, touching the bounds, by kind and id.
        lost: Counts of what could not be used, by what it was.
    """

    points: tuple[Feature, ...]
    lines: tuple[Feature, ...]
    areas: tuple[Feature, ...]
    lost: dict[str, int] = field(default_factory=dict)


def features_of(extract: Extract, origin: GeoOrigin, bounds: Bounds) -> FeatureSet:
    """Bring an extract into the frame of a world and put its areas together."""
    lost = dict(extract.lost)
    points = _points(extract.nodes, origin, bounds)
    lines = _to_enu(extract.way_lines, origin)
    touching = shapely.intersects(lines, box_of(bounds)) if len(lines) else np.empty(0, dtype=bool)
    open_ways: list[Feature] = []
    areas: list[Feature] = []
    for at, way in enumerate(extract.ways):
        if not way.tags:
            continue
        if way.closed and is_area(way.tags):
            areas.append(Feature(WAY, way.osm_id, way.tags, _polygon(lines[at])))
        elif touching[at]:
            open_ways.append(Feature(WAY, way.osm_id, way.tags, lines[at]))
    areas += _multipolygons(extract, lines, lost)
    shapes = np.array([area.shape for area in areas], dtype=object)
    overlapping = shapely.intersects(shapes, box_of(bounds)) if areas else np.empty(0, dtype=bool)
    kept = tuple(area for area, is_there in zip(areas, overlapping, strict=True) if is_there)
    return FeatureSet(points, tuple(open_ways), kept, {what: count for what, count in lost.items() if count})


def _points(nodes: tuple[NodeRecord, ...], origin: GeoOrigin, bounds: Bounds) -> tuple[Feature, ...]:
    x_m, y_m = origin.enu_from_geodetic_m([node.lat_deg for node in nodes], [node.lon_deg for node in nodes])
    shapes = shapely.points(x_m, y_m)
    return tuple(
        Feature(NODE, node.osm_id, node.tags, shapes[at])
        for at, node in enumerate(nodes)
        if bounds.contains(float(x_m[at]), float(y_m[at]))
    )


def _to_enu(lines: NDArray[np.object_], origin: GeoOrigin) -> NDArray[np.object_]:
    if not len(lines):
        return lines
    transformed: Any = shapely.transform(lines, _enu_of(origin))
    return np.asarray(transformed, dtype=object)


def _enu_of(origin: GeoOrigin) -> Callable[[NDArray[np.float64]], NDArray[np.float64]]:
    def transform(lon_lat_deg: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.column_stack(origin.enu_from_geodetic_m(lon_lat_deg[:, 1], lon_lat_deg[:, 0]))

    return transform


def _polygon(ring: Any) -> Any:
    polygon = shapely.Polygon(ring)
    return polygon if polygon.is_valid else shapely.make_valid(polygon)


def _multipolygons(extract: Extract, lines: NDArray[np.object_], lost: dict[str, int]) -> list[Feature]:
    """Put multipolygons together from whatever of their members is there.

    Rings count by nesting, as in libosmium: what lies in an odd number of rings is inside, roles are not needed.
    """
    places: dict[int, list[int]] = {}
    for at, way in enumerate(extract.ways):
        places.setdefault(way.osm_id, []).append(at)
    found: list[Feature] = []
    lost["multipolygons with lost members"] = lost["multipolygons without any ring"] = 0
    for relation in extract.relations:
        members = sorted(set(relation.way_ids))
        known = [at for way_id in members for at in places.get(way_id, ())]
        lost["multipolygons with lost members"] += any(way_id not in places for way_id in members)
        area = _assembled(lines[np.array(known, dtype=np.intp)]) if known else None
        if area is None or area.is_empty:
            lost["multipolygons without any ring"] += 1
            continue
        found.append(Feature(RELATION, relation.osm_id, relation.tags, area))
    return found


def _assembled(lines: NDArray[np.object_]) -> Any:
    area = shapely.build_area(shapely.multilinestrings(lines))
    if area.is_empty or not area.is_valid:
        # Members that cross each other, or meet where neither has a node: cut them where they do.
        area = shapely.build_area(shapely.node(shapely.multilinestrings(lines)))
    return area if area.is_valid else shapely.make_valid(area)
