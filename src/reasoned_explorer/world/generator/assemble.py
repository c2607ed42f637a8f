"""From the drawing board to the immutable world."""

from collections.abc import Sequence

import numpy as np
import shapely
from shapely import Polygon

from reasoned_explorer.world.generator import planar
from reasoned_explorer.world.generator.sketch import Footprint, Patch, Sketch
from reasoned_explorer.world.taxonomy import Ground
from reasoned_explorer.world.world import Building, Region, Ring, Way


def rings_of(area: Polygon) -> tuple[Ring, tuple[Ring, ...]]:
    """Return the outer ring and the holes of a polygon, none with its closing point."""
    return rings_of_all([area])[0]


def rings_of_all(areas: Sequence[Polygon]) -> list[tuple[Ring, tuple[Ring, ...]]]:
    """Return the outer ring and the holes of each of many polygons, none with its closing point."""
    if not areas:
        return []
    rings, owner = shapely.get_rings(np.array(areas, dtype=object), return_index=True)
    corners, ring = shapely.get_coordinates(rings, return_index=True)
    parts = np.split(corners, np.searchsorted(ring, np.arange(1, len(rings))))
    found: list[list[Ring]] = [[] for _ in areas]
    for place, part in zip(owner.tolist(), parts, strict=True):
        found[place].append(np.ascontiguousarray(part[:-1]))
    return [(outer, tuple(holes)) for outer, *holes in found]


def ground_of(sketch: Sketch) -> list[Patch]:
    """Return the ground, cut at the border of the world; what nothing was drawn on is pavement."""
    made = [Patch(Ground.PAVEMENT, sketch.box)]
    if sketch.patches:
        areas = np.array([patch.area for patch in sketch.patches])
        inside = shapely.contains_properly(sketch.box, areas)
        cut = areas.copy()
        cut[~inside] = planar.intersection(areas[~inside], sketch.box)
        for patch, area, whole in zip(sketch.patches, cut, inside.tolist(), strict=True):
            parts = (area,) if whole else shapely.get_parts(area)
            made.extend(
                Patch(patch.ground, part, name=patch.name)
                for part in parts
                if isinstance(part, Polygon) and part.area > 0.5
            )
    return made


def regions_of(ground: Sequence[Patch]) -> tuple[Region, ...]:
    """Return patches as regions."""
    rings = rings_of_all([patch.area for patch in ground])
    return tuple(
        Region(patch.ground, outer, holes, patch.name) for patch, (outer, holes) in zip(ground, rings, strict=True)
    )


def ways_of(sketch: Sketch) -> tuple[Way, ...]:
    """Return pavements, then trails, then carriageways, then crossings: so that junctions merge."""
    made: list[Way] = []
    for street in sketch.streets:
        ground = Ground.PAVEMENT if street.road_m > 0 else Ground.PLAZA
        kind = "footway" if street.road_m > 0 else "pedestrian"
        made.append(Way(kind, ground, street.line, 2 * street.half_m, "" if street.road_m > 0 else street.name))
    made.extend(Way(trail.kind, trail.ground, trail.line, trail.width_m) for trail in sketch.trails)
    made.extend(
        Way(street.kind, Ground.ROAD, street.line, street.road_m, street.name)
        for street in sketch.streets
        if street.road_m > 0
    )
    made.extend(Way(trail.kind, trail.ground, trail.line, trail.width_m) for trail in sketch.crossings)
    return tuple(made)


def buildings_of(footprints: Sequence[Footprint], entrances: Sequence[Ring]) -> tuple[Building, ...]:
    """Return buildings with their entrances."""
    rings = rings_of_all([item.area for item in footprints])
    return tuple(
        Building(
            outer=outer,
            height_m=item.height_m,
            holes=holes,
            kind=item.kind,
            name=item.name,
            entrances=doors,
            min_height_m=item.min_height_m,
            height_source="height",
        )
        for item, (outer, holes), doors in zip(footprints, rings, entrances, strict=True)
    )
