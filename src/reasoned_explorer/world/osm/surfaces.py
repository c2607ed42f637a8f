"""The ground of a map: regions from areas, ways from lines."""

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely

from reasoned_explorer.world.osm.coastline import sea_of
from reasoned_explorer.world.osm.features import Feature
from reasoned_explorer.world.osm.ground import (
    BASE_LAYER,
    PAVEMENT_ORDER,
    SEA_LAYER,
    LineGround,
    ground_of_area,
    ground_of_line,
)
from reasoned_explorer.world.osm.shapes import clip, lines_of, polygons_of, rings_of
from reasoned_explorer.world.osm.tags import clean_text
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
        meaning = ground_of_area(area.tags)
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
    counts = {"regions": len(regions), "coastlines": len(coast), "stretches of unclear coast": sea.unclear}
    return tuple(regions), counts


def ways_of(lines: Sequence[Feature], bounds: Bounds) -> tuple[Way, ...]:
    """Return the ways of a map's lines in drawing order; each road's pavements lie below the roads."""
    drawn: list[tuple[int, float, int, int, LineGround, Feature, Any]] = []
    for line in lines:
        meaning = ground_of_line(line.tags)
        if meaning is None:
            continue
        drawn.append((meaning.order, meaning.width_m, line.osm_id, len(drawn), meaning, line, line.shape))
        if meaning.left_m or meaning.right_m:
            pavement, shape = _pavement(meaning, line.shape)
            drawn.append((pavement.order, pavement.width_m, line.osm_id, len(drawn), pavement, line, shape))
    drawn.sort(key=lambda item: item[:4])
    ways: list[Way] = []
    if drawn:
        for (*_, meaning, line, _), shape in zip(drawn, clip([item[6] for item in drawn], bounds), strict=True):
            kind = SIDEWALK_KIND if meaning.order == PAVEMENT_ORDER else _kind(line)
            for piece in lines_of(_merged(shape), min_length_m=_MIN_LENGTH_M):
                points = np.ascontiguousarray(shapely.get_coordinates(piece))
                name = clean_text(line.tags.get("name", ""))
                ways.append(Way(kind, meaning.ground, points, meaning.width_m, name, meaning.level))
    return tuple(ways)


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
