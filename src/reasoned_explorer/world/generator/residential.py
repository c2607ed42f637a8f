"""The residential district: curved streets, dead ends, houses in their gardens."""

import math

import numpy as np
import shapely
from numpy.random import Generator
from numpy.typing import NDArray
from shapely import LineString, Polygon

from reasoned_explorer.world.generator import planar
from reasoned_explorer.world.generator.blocks import Fabric, blocks_between, garden_block, height_of, landmark_block
from reasoned_explorer.world.generator.shapes import Points, along, bow, footprint, heading_of, left_of, placed
from reasoned_explorer.world.generator.sketch import Footprint, Sketch, Street
from reasoned_explorer.world.generator.streets import Warp, add_street, draw_grid, even_ticks, grid_nodes, quad_warp
from reasoned_explorer.world.taxonomy import Ground


def fill_residential(sketch: Sketch, rng: Generator, cell: Polygon, area: Polygon, *, framed: bool) -> None:
    """Fill a cell with houses along curved streets and dead ends.

    Args:
        sketch: Where to draw.
        rng: Draws.
        cell: Out to the centre lines of the streets around it.
        area: The part of it that is not yet taken by streets.
        framed: Whether there are streets around it.
    """
    min_x, min_y, max_x, max_y = cell.bounds
    width, height = max_x - min_x, max_y - min_y
    us, vs = even_ticks(rng, width, 125.0, jitter=0.08), even_ticks(rng, height, 78.0, jitter=0.08)
    if not framed:
        us = np.concatenate([[-60.0], us[1:-1] + rng.uniform(-12, 12), [width + 60.0]])
        vs = np.concatenate([[-50.0], vs[1:-1] + rng.uniform(-10, 10), [height + 50.0]])
    base = quad_warp(cell if framed else shapely.box(min_x, min_y, max_x, max_y), width, height)
    warp = _wavy(rng, base, width, height, amount=0.0 if framed else 1.0)
    nodes = grid_nodes(rng, us, vs, warp, 6.0, frame=True)

    def kind_of(axis: int, index: int) -> str:
        return "residential" if axis == 0 or index % 2 == 0 else "living_street"

    streets = draw_grid(sketch, rng, nodes, within=cell, kind_of=kind_of, missing=0.22, curved=True, frame=True)
    blocks = blocks_between(area, sketch.beds(streets))
    stubs = _dead_ends(sketch, rng, blocks)
    for street in stubs:
        bulb = planar.buffer(shapely.points(street.line[-1]), 9.5)
        sketch.lay(Ground.PAVEMENT, planar.buffer(bulb, 1.8))
        sketch.lay(Ground.ROAD, bulb)
    beds = planar.union_all(
        [sketch.beds([*streets, *stubs]), *(planar.buffer(shapely.points(s.line[-1]), 11.3) for s in stubs)]
    )
    blocks = blocks_between(area, beds)
    houses: list[Polygon] = []
    for block in blocks:
        roll = rng.random()
        if block.area < 500.0:
            sketch.lay(Ground.GRASS, block, "corner")
        elif roll < 0.06 and block.area < 9000.0:
            garden_block(sketch, rng, block)
        elif roll < 0.1 and block.area < 9000.0:
            landmark_block(sketch, rng, block, Fabric("residential"))
        elif roll < 0.17 and block.area > 5000.0:
            _flats(sketch, rng, block)
        else:
            sketch.lay(Ground.YARD if rng.random() < 0.15 else Ground.GARDEN, block, "gardens")
            _houses(sketch, rng, block, houses)


def _wavy(rng: Generator, base: Warp, width: float, height: float, *, amount: float) -> Warp:
    """Return a warp that bends a grid smoothly, all the same at its borders where the amount is 0."""
    phases, waves = rng.uniform(0, 6.28, 4), rng.uniform(0.7, 1.5, 4)
    swing = 15.0

    def warp(points: Points) -> Points:
        u, v = points[:, 0] / width, points[:, 1] / height
        window = np.clip(np.minimum(np.minimum(u, 1 - u), np.minimum(v, 1 - v)) * 5, amount, 1.0)
        du = swing * window * np.sin(2 * math.pi * waves[0] * v + phases[0] + waves[1] * u)
        dv = swing * 1.3 * window * np.sin(2 * math.pi * waves[2] * u + phases[1] + waves[3] * v)
        return base(np.column_stack([points[:, 0] + du, points[:, 1] + dv]))

    return warp


def _dead_ends(sketch: Sketch, rng: Generator, blocks: list[Polygon]) -> list[Street]:
    """Draw a dead end into some of the larger blocks."""
    made: list[Street] = []
    for block in blocks:
        if block.area < 9000.0 or rng.random() < 0.35:
            continue
        box = np.asarray(shapely.minimum_rotated_rectangle(block).exterior.coords)
        sides = np.diff(box, axis=0)[:2]
        lengths = np.hypot(sides[:, 0], sides[:, 1])
        short = int(np.argmin(lengths))
        if lengths[short] < 62.0:
            continue
        middle = (box[short] + box[short + 1]) / 2
        inward = sides[1 - short] / lengths[1 - short] * (1 if short == 0 else -1)
        centre = np.array(block.centroid.coords[0])
        inward = inward if (centre - middle) @ inward > 0 else -inward
        reach = lengths[1 - short] * float(rng.uniform(0.38, 0.6))
        start = middle - inward * 14.0
        end = middle + inward * reach
        line = bow(start, end, float(rng.uniform(-0.08, 0.08)))
        if planar.buffer(shapely.points(end), 30.0).within(planar.buffer(block, 6.0)):
            before = len(sketch.streets)
            add_street(sketch, rng, line, "living_street", trees=0.0)
            made += sketch.streets[before : before + 1]
    return made


def _houses(sketch: Sketch, rng: Generator, block: Polygon, houses: list[Polygon]) -> None:
    """Put houses around a block, fronts to the street, with a drive, a front path and a hedge here and there."""
    ring = np.asarray(shapely.orient_polygons(block).exterior.coords)
    terraced = rng.random() < 0.2
    pitch = float(rng.uniform(8.5, 10.5)) if terraced else float(rng.uniform(17.0, 22.0))
    setback = float(rng.uniform(3.5, 6.5))
    at, tangents = along(ring, pitch)
    normals = left_of(tangents)
    shapely.prepare(block)
    mine: list[Polygon] = []
    room = planar.buffer(block, -2.5)
    shapely.prepare(room)
    for index in np.flatnonzero(_off_border(sketch, at)).tolist():
        kind = "rect" if terraced else str(rng.choice(["rect", "rect", "l", "l", "t"]))
        width = pitch + 0.1 if terraced else float(rng.uniform(9.0, min(14.0, pitch - 4.0)))
        depth = float(rng.uniform(8.5, 11.0))
        back = setback + (0.0 if terraced else float(rng.uniform(-1.2, 1.5))) + depth / 2
        x, y = at[index] + normals[index] * back
        heading = float(heading_of(-normals[index : index + 1])[0])
        area = placed(footprint(kind, width, depth, 5.5), float(x), float(y), heading)
        if not room.contains(area):
            continue
        core = planar.buffer(area, -0.4) if terraced else planar.buffer(area, 2.4, quad_segs=2)
        if mine and shapely.intersects(core, mine).any():
            continue
        mine.append(area)
        doorstep = at[index] + normals[index] * (back - depth / 2)
        door = (float(doorstep[0]), float(doorstep[1]))
        height = height_of(rng, (1, 2)) if not terraced else round(8.0 + float(rng.uniform(0, 1)), 1)
        sketch.build(Footprint(area, height, "residential", "terrace" if terraced else "detached", door))
        sketch.pave(np.vstack([at[index] - normals[index] * 0.4, doorstep]), 1.3, Ground.PATH)
        if not terraced and rng.random() < 0.75:
            _drive(sketch, rng, (at[index], tangents[index], normals[index]), width, back)
    houses.extend(mine)


def _off_border(sketch: Sketch, points: Points) -> NDArray[np.bool_]:
    """Return which points lie in the world, 1.5 m or more from its border."""
    low, high = np.reshape(sketch.box.bounds, (2, 2))
    inside: NDArray[np.bool_] = np.all((points - low >= 1.5) & (high - points >= 1.5), axis=1)
    return inside


def _drive(sketch: Sketch, rng: Generator, frame: tuple[Points, Points, Points], width: float, back: float) -> None:
    """Pave a drive beside a house and leave a car on it now and then."""
    at, tangent, normal = frame
    foot = at + tangent * (width / 2 + 2.0)
    head = foot + normal * (back + 1.0)
    line = LineString([foot - normal * 0.4, head])
    if any(item.area.distance(line) < 1.4 for item in sketch.footprints[-6:]):
        return
    sketch.pave(np.asarray(line.coords), 2.8, Ground.PARKING, "service")
    if rng.random() < 0.55:
        spot = foot + normal * min(back - 1.5, 5.0)
        sketch.put("car", float(spot[0]), float(spot[1]), float(heading_of(normal[None])[0]), where="drive")


def _flats(sketch: Sketch, rng: Generator, block: Polygon) -> None:
    """Build slabs of flats on green ground, with a playground and a car park between them."""
    sketch.lay(Ground.GRASS, block, "lawn")
    box = np.asarray(shapely.minimum_rotated_rectangle(block).exterior.coords)
    step = box[1] - box[0] if np.hypot(*(box[1] - box[0])) > np.hypot(*(box[2] - box[1])) else box[2] - box[1]
    long_m = float(np.hypot(*step))
    heading = float(math.atan2(*step)) + math.pi / 2
    centre = np.array(block.centroid.coords[0])
    room = planar.buffer(block, -5.0)
    count = max(1, int(long_m // 44.0))
    for index in range(count):
        x, y = centre + step / long_m * ((index + 0.5) / count - 0.5) * long_m
        if index % 3 == 2 or (index == 1 and count < 4):
            spot = planar.buffer(shapely.points(x, y), 9.0)
            if spot.within(room):
                sketch.lay(Ground.PLAYGROUND, spot, "playground")
            continue
        slab = placed(footprint(str(rng.choice(["rect", "l", "u"])), 32.0, 13.0, 6.0), float(x), float(y), heading)
        if slab.within(room):
            door = np.array([x, y]) + np.array([math.sin(heading), math.cos(heading)]) * 6.5
            sketch.build(Footprint(slab, height_of(rng, (3, 6)), "residential", "apartments", (door[0], door[1])))
            way = np.asarray(shapely.shortest_line(shapely.points(door), block.exterior).coords)
            if not LineString(way).crosses(planar.buffer(slab, -0.2)):
                sketch.pave(np.vstack([way[0], way[1] + (way[1] - way[0]) * 0.08]), 2.2, Ground.PATH)
