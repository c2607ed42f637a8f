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
    PAVEMENT_ORDER,
    SEA_LAYER,
    WATER_ORDER,
    LineGround,
    ground_of_area,
    ground_of_line,
)
from reasoned_explorer.world.osm.shapes import clip, lines_of, polygons_of, rings_of
from reasoned_explorer.world.osm.tags import clean_text, is_set
from reasoned_explorer.world.taxonomy import Ground
from reasoned_explorer.world.world import Bounds, Region, Way

_MIN_AREA_M2 = 1.0
_MIN_LENGTH_M = 0.2
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


def ways_of(lines: Sequence[Feature], bounds: Bounds) -> tuple[Way, ...]:
    """Return the ways of a map's lines in drawing order; each road's pavements lie below the roads.

    A bridge makes the ground where nothing that one could walk or drive on passes below it (over water, mostly).
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
    drawn.sort(key=lambda item: (item[0].order, item[0].width_m, item[1].osm_id))
    ways: list[Way] = []
    if drawn:
        for (meaning, line, _), shape in zip(drawn, clip([item[2] for item in drawn], bounds), strict=True):
            kind = SIDEWALK_KIND if meaning.order == PAVEMENT_ORDER else _kind(line)
            for piece in lines_of(_merged(shape), min_length_m=_MIN_LENGTH_M):
                points = np.ascontiguousarray(shapely.get_coordinates(piece))
                name = clean_text(line.tags.get("name", ""))
                ways.append(Way(kind, meaning.ground, points, meaning.width_m, name, meaning.level))
    return tuple(ways)


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
