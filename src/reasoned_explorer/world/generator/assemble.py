"""From the drawing board to the immutable world."""

import numpy as np
import shapely
from shapely import Polygon

from reasoned_explorer.world.generator.sketch import Footprint, Sketch
from reasoned_explorer.world.taxonomy import Ground
from reasoned_explorer.world.world import Building, Region, Ring, Way


def rings_of(area: Polygon) -> tuple[Ring, tuple[Ring, ...]]:
    """Return the outer ring and the holes of a polygon, none with its closing point."""
    outer = np.array(area.exterior.coords, float)[:-1, :2]
    return outer, tuple(np.array(hole.coords, float)[:-1, :2] for hole in area.interiors)


def regions_of(sketch: Sketch) -> tuple[Region, ...]:
    """Return the ground, cut at the border of the world; what nothing was drawn on is pavement."""
    outer, holes = rings_of(sketch.box)
    made = [Region(Ground.PAVEMENT, outer, holes)]
    areas = np.array([patch.area for patch in sketch.patches])
    cut = shapely.intersection(areas, sketch.box) if len(areas) else areas
    for patch, area in zip(sketch.patches, cut, strict=True):
        for part in shapely.get_parts(area):
            if isinstance(part, Polygon) and part.area > 0.5:
                outer, holes = rings_of(part)
                made.append(Region(patch.ground, outer, holes, patch.name))
    return tuple(made)


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


def building_of(footprint: Footprint, entrances: Ring) -> Building:
    """Return a building with its entrances."""
    outer, holes = rings_of(footprint.area)
    return Building(
        outer=outer,
        height_m=footprint.height_m,
        holes=holes,
        kind=footprint.kind,
        name=footprint.name,
        entrances=entrances,
        min_height_m=footprint.min_height_m,
        height_source="height",
    )
