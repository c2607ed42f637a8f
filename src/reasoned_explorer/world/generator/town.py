"""The town: arterial streets, and in each of their meshes a district."""

import math

import numpy as np
import shapely
from numpy.random import Generator
from shapely import Polygon

from reasoned_explorer.world.generator import planar
from reasoned_explorer.world.generator.campus import fill_campus
from reasoned_explorer.world.generator.park import fill_park
from reasoned_explorer.world.generator.residential import fill_residential
from reasoned_explorer.world.generator.sketch import Sketch, Zone
from reasoned_explorer.world.generator.streets import add_street, even_ticks, grid_nodes
from reasoned_explorer.world.generator.urban import fill_downtown, fill_plaza, fill_waterfront

FILLS = {
    "downtown": fill_downtown,
    "plaza": fill_plaza,
    "park": fill_park,
    "campus": fill_campus,
    "residential": fill_residential,
    "waterfront": fill_waterfront,
}


def fill_district(sketch: Sketch, zone: Zone) -> None:
    """Fill the whole world with one district."""
    sketch.zones.append((zone, sketch.box))
    FILLS[zone](sketch, sketch.rng(zone), sketch.box, sketch.box, framed=False)


def fill_town(sketch: Sketch) -> None:
    """Fill the world with a shore in the south, an old town in the middle and districts around it."""
    rng = sketch.rng("town")
    min_x, min_y, max_x, _ = sketch.box.bounds
    size = max_x - min_x
    count = max(2, round(size / 260.0))
    shore = size >= 380.0
    deep = float(rng.uniform(0.24, 0.3)) * size if shore else 0.0
    us = even_ticks(rng, size, size / count)
    vs = even_ticks(rng, size - deep, (size - deep) / max(1, count - 1 if shore else count))
    nodes = grid_nodes(rng, us, vs + deep, lambda points: points + np.array([min_x, min_y]), size * 0.022, frame=True)
    # The frame lies on the border of the world: only the lines inside are streets.
    first = len(sketch.streets)
    for row in range(0 if shore else 1, len(vs) - 1):
        add_street(sketch, rng, nodes[:, row], "secondary", trees=10.0)
    for column in range(1, len(us) - 1):
        add_street(sketch, rng, nodes[column], "primary" if column == len(us) // 2 else "secondary", trees=10.0)
    beds = sketch.beds(sketch.streets[first:])
    cells = [
        (i, j, Polygon([nodes[i, j], nodes[i + 1, j], nodes[i + 1, j + 1], nodes[i, j + 1]]))
        for i in range(len(us) - 1)
        for j in range(len(vs) - 1)
    ]
    zones = _assign(rng, cells, sketch.box)
    for (i, j, cell), zone in zip(cells, zones, strict=True):
        area = max(shapely.get_parts(planar.difference(cell, beds)), key=lambda part: part.area)
        sketch.zones.append((zone, cell))
        FILLS[zone](sketch, sketch.rng("town", i, j), cell, area, framed=True)
    if shore:
        strip = planar.intersection(
            Polygon([(min_x, min_y), (max_x, min_y), *[tuple(point) for point in nodes[::-1, 0]]]), sketch.box
        )
        area = max(shapely.get_parts(planar.difference(strip, beds)), key=lambda part: part.area)
        sketch.zones.append(("waterfront", strip))
        FILLS["waterfront"](sketch, sketch.rng("town", "shore"), strip, area, framed=True)


def _assign(rng: Generator, cells: list[tuple[int, int, Polygon]], box: Polygon) -> list[Zone]:
    """Give the middle to the plaza and downtown, the rest to what a town needs, houses outermost."""
    centre = np.array(box.centroid.coords[0])
    far = [float(math.hypot(*(np.array(cell.centroid.coords[0]) - centre))) for _, _, cell in cells]
    order = np.argsort(np.array(far) + rng.uniform(0, 20, len(far)), kind="stable")
    core: list[Zone] = ["plaza", "downtown", "park", "downtown"]
    rest: list[Zone] = ["campus", "residential", "residential", "downtown", "residential", "park"]
    wanted = core[: max(2, len(cells) // 2)] + [rest[index % len(rest)] for index in range(len(cells))]
    zones: list[Zone] = ["residential"] * len(cells)
    for place, index in enumerate(order.tolist()):
        zones[index] = wanted[place]
    return zones
