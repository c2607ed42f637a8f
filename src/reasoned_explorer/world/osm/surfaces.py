"""The ground of a map: regions from areas, ways from lines."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import shapely

from reasoned_explorer.world.osm.coastline import sea_of
from reasoned_explorer.world.osm.features import Feature
from reasoned_explorer.world.osm.ground import (
    BASE_LAYER,
    FOOT_ORDER,
    PAVEMENT_ORDER,
    ROAD_ORDER,
    SEA_LAYER,
    WATER_ORDER,
    LineGround,
    ground_of_area,
    ground_of_line,
)
from reasoned_explorer.world.osm.shapes import clip, lines_of, polygons_of, rings_of
from reasoned_explorer.world.osm.tags import clean_text, is_passage, is_set
from reasoned_explorer.world.taxonomy import Ground
from reasoned_explorer.world.world import Bounds, Region, Way

_MIN_AREA_M2 = 1.0
_MIN_LENGTH_M = 0.2
_ON_THE_LINE_M = 0.5
# A zebra is 3 to 4 m wide (German R-FGÜ: 4 m, at least 3 m).
_CROSSING_WIDTH_M = 3.0
# A passage through a house is at least as wide as a gate for people.
_LEAST_PASSAGE_M = 2.5
#: The kind of the pavements that a road's ``sidewalk`` tag stands for.
SIDEWALK_KIND = "sidewalk"


def regions_of(
    areas: Sequence[Feature], lines: Sequence[Feature], courtyards: Sequence[Any], bounds: Bounds
) -> tuple[tuple[Region, ...], dict[str, int]]:
    """Return the ground of a map's areas in drawing order, and counts for the report."""
    coast = [line.shape for line in lines if line.tags.get("natural") == "coastline"]
    sea = sea_of(coast, bounds)
    drawn: list[tuple[int, float, int, int, Ground, str, Any]] = []
    drawn += [(SEA_LAYER, -shape.area, -1, at, Ground.WATER, "", shape) for at, shape in enumerate(sea.polygons)]
    drawn += [(BASE_LAYER, -yard.area, -1, at, Ground.YARD, "", yard) for at, yard in enumerate(courtyards)]
    for area in areas:
        meaning = ground_of_area(area.tags, area_m2=area.shape.area)
        if meaning is not None:
            layer, ground = meaning
            name = clean_text(area.tags.get("name", ""))
            drawn.append((layer, -area.shape.area, area.kind, area.osm_id, ground, name, area.shape))
    drawn.sort(key=lambda item: item[:4])
    regions: list[Region] = []
    if drawn:
        for item, shape in zip(drawn, clip([item[6] for item in drawn], bounds), strict=True):
            for polygon in polygons_of(shape, min_area_m2=_MIN_AREA_M2):
                outer, holes = rings_of(polygon)
                regions.append(Region(item[4], outer, holes, item[5]))
    counts = {"regions": len(regions), "coastlines": len(coast), "loose ends of coastline": sea.loose_ends,
              "stretches of unclear coast": sea.unclear}  # fmt: skip
    return tuple(regions), counts


def passages_of(lines: Sequence[Feature]) -> list[Any]:
    """Return the corridors of ways that lead through buildings at street level, as polygons."""
    found = [line for line in lines if is_passage(line.tags)]
    meant = [(line.shape, meaning) for line in found if (meaning := ground_of_line(line.tags)) is not None]
    return [
        shapely.buffer(shape, max(meaning.width_m, _LEAST_PASSAGE_M) / 2.0, cap_style="square", join_style="mitre")
        for shape, meaning in meant
    ]


def ways_of(lines: Sequence[Feature], points: Sequence[Feature], bounds: Bounds) -> tuple[Way, ...]:
    """Return the ways of a map's lines in drawing order; each road's pavements lie below the roads.

    Crossings lie above the roads: those drawn as ways, and those drawn as points on a road that no such way meets. A
    bridge makes the ground where nothing that one could walk or drive on passes below it (over water, mostly).
    """
    meant = [(line, meaning) for line in lines if (meaning := ground_of_line(line.tags)) is not None]
    drawn: list[tuple[LineGround, Feature, Any]] = []
    below = _Below([(line.shape, meaning) for line, meaning in meant])
    for line, meaning in meant:
        if meaning.level > 0 and is_set(line.tags, "bridge"):
            over, free = below.split(line.shape, meaning)
            drawn.append((meaning, line, over))
            drawn.append((replace(meaning, level=0), line, free))
            continue
        drawn.append((meaning, line, line.shape))
        if meaning.left_m or meaning.right_m:
            pavement, shape = _pavement(meaning, line.shape)
            drawn.append((pavement, line, shape))
    drawn += _crossings(points, meant)
    drawn.sort(key=lambda item: (item[0].order, item[0].width_m, item[1].osm_id))
    ways: list[Way] = []
    if drawn:
        for (meaning, line, _), shape in zip(drawn, clip([item[2] for item in drawn], bounds), strict=True):
            kind = SIDEWALK_KIND if meaning.order == PAVEMENT_ORDER else _kind(line)
            for piece in lines_of(_merged(shape), min_length_m=_MIN_LENGTH_M):
                path = np.ascontiguousarray(shapely.get_coordinates(piece))
                name = clean_text(line.tags.get("name", ""))
                ways.append(Way(kind, meaning.ground, path, meaning.width_m, name, meaning.level))
    return tuple(ways)


def _crossings(
    points: Sequence[Feature], meant: Sequence[tuple[Feature, LineGround]]
) -> list[tuple[LineGround, Feature, Any]]:
    """Return strips straight across roads where points on them are crossings."""
    nodes = [
        point for point in points if point.tags.get("highway") == "crossing" and point.tags.get("crossing") != "no"
    ]
    level = [(line, meaning) for line, meaning in meant if meaning.level == 0]
    roads = [(line.shape, meaning.width_m) for line, meaning in level if meaning.order == ROAD_ORDER]
    if not nodes or not roads:
        return []
    places = np.array([node.shape for node in nodes], dtype=object)
    drawn = [line.shape for line, meaning in level if meaning.order == FOOT_ORDER and meaning.ground == Ground.PAVEMENT]
    known = np.zeros(len(nodes), dtype=bool)
    if drawn:
        known[shapely.STRtree(drawn).query(places, predicate="dwithin", distance=_ON_THE_LINE_M)[0]] = True
    at, road = shapely.STRtree([shape for shape, _ in roads]).query(
        places, predicate="dwithin", distance=_ON_THE_LINE_M
    )
    pairs = sorted(zip(at.tolist(), road.tolist(), strict=True), key=lambda pair: (roads[pair[1]][1], pair))
    on_road = dict(pairs)  # of several, the widest
    made: list[tuple[LineGround, Feature, Any]] = []
    for node, line in sorted(on_road.items()):
        if known[node]:
            continue
        shape, width_m = roads[line]
        where = shape.project(places[node])
        back, ahead = shape.interpolate(max(where - 1.0, 0.0)), shape.interpolate(min(where + 1.0, shape.length))
        along = np.array([ahead.x - back.x, ahead.y - back.y])
        middle = shapely.get_coordinates(places[node])[0]
        across = np.array([-along[1], along[0]]) / max(float(np.hypot(*along)), 1e-9) * width_m / 2.0
        strip = LineGround(FOOT_ORDER, Ground.PAVEMENT, _CROSSING_WIDTH_M, 0)
        made.append((strip, nodes[node], shapely.linestrings(np.array([middle - across, middle + across]))))
    return made


class _Below:
    """What passes below bridges: the ways on the ground, water not counted."""

    def __init__(self, lines: Sequence[tuple[Any, LineGround]]) -> None:
        level = [(shape, meaning) for shape, meaning in lines if meaning.level == 0 and meaning.order != WATER_ORDER]
        self._widths_m = np.array([meaning.width_m for _, meaning in level])
        self._lines = np.empty(len(level), dtype=object)
        self._lines[:] = [shape for shape, _ in level]
        self._tree = shapely.STRtree(self._lines)

    def split(self, bridge: Any, meaning: LineGround) -> tuple[Any, Any]:
        """Return the part of a bridge that leads over other ways, and the rest."""
        crossing = np.sort(self._tree.query(bridge, predicate="intersects"))
        ends = shapely.MultiPoint(shapely.get_coordinates(bridge)[[0, -1]])
        # Where the bridge begins and ends it meets ways that lead on, not ways below.
        apart = [at for at in crossing if _farthest_m(shapely.intersection(bridge, self._lines[at]), ends) > 1.0]
        if not apart:
            return shapely.LineString(), bridge
        shadow = shapely.union_all(
            shapely.buffer(self._lines[apart], (self._widths_m[apart] + meaning.width_m) / 2.0, cap_style="flat")
        )
        return shapely.intersection(bridge, shadow), shapely.difference(bridge, shadow)


def _farthest_m(shape: Any, ends: Any) -> float:
    points = shapely.get_coordinates(shape)
    return float(shapely.distance(shapely.points(points), ends).max()) if len(points) else 0.0


def _merged(shape: Any) -> Any:
    return shapely.line_merge(shape) if shape.geom_type == "MultiLineString" else shape


def _kind(line: Feature) -> str:
    for key in ("highway", "railway", "waterway", "man_made"):
        if key in line.tags:
            return clean_text(line.tags[key])
    return ""


def _pavement(meaning: LineGround, line: Any) -> tuple[LineGround, Any]:
    """Return the strip that, drawn below its road, shows as the pavements on its sides.

    With pavements of different widths the strip is moved sideways, so that it reaches out as far as each of them.
    """
    width_m = meaning.left_m + meaning.width_m + meaning.right_m
    aside_m = (meaning.left_m - meaning.right_m) / 2.0
    strip = LineGround(PAVEMENT_ORDER, Ground.PAVEMENT, width_m, meaning.level)
    return strip, line if aside_m == 0.0 else shapely.offset_curve(line, aside_m)
