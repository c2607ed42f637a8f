"""Downtown, the plaza and the waterfront: districts made of streets and blocks."""

import math

import numpy as np
import shapely
from numpy.random import Generator
from shapely import LineString, Polygon

from reasoned_explorer.world.generator import planar
from reasoned_explorer.world.generator.blocks import Fabric, blocks_between, fill_blocks, perimeter_block
from reasoned_explorer.world.generator.shapes import Points, along, blob, polygons_of, smooth
from reasoned_explorer.world.generator.sketch import Footprint, Sketch, Street
from reasoned_explorer.world.generator.streets import (
    Warp,
    add_street,
    avenue_across,
    draw_grid,
    even_ticks,
    grid_nodes,
    quad_warp,
    rotation,
    ticks,
)
from reasoned_explorer.world.taxonomy import Ground


def town_grid(
    sketch: Sketch, rng: Generator, cell: Polygon, *, framed: bool, spacing_m: tuple[float, float], angle: float = 0.35
) -> tuple[list[Street], Warp, Points, Points]:
    """Draw an irregular street grid and return its streets, its warp and its columns and rows."""
    min_x, min_y, max_x, max_y = cell.bounds
    width, height = max_x - min_x, max_y - min_y
    if framed:
        us, vs = even_ticks(rng, width, spacing_m[0] * 1.15), even_ticks(rng, height, spacing_m[0])
        warp = quad_warp(cell, width, height)
    else:
        reach = 0.75 * max(width, height)
        us, vs = ticks(rng, -reach, reach, spacing_m), ticks(rng, -reach, reach, spacing_m)
        us, vs = us + rng.uniform(-40, 0), vs + rng.uniform(-40, 0)
        warp = rotation(((min_x + max_x) / 2, (min_y + max_y) / 2), rng.uniform(-angle, angle))
    nodes = grid_nodes(rng, us, vs, warp, 5.0, frame=framed)
    every = int(rng.integers(3, 5))
    walking = {0: int(rng.integers(0, len(vs))), 1: int(rng.integers(0, len(us)))}

    def kind_of(axis: int, index: int) -> str:
        if index == walking[axis] and not framed:
            return "pedestrian"
        return "secondary" if not framed and index % every == 1 else "residential"

    streets = draw_grid(sketch, rng, nodes, within=cell, kind_of=kind_of, missing=0.16, frame=framed)
    return streets, warp, us, vs


def fill_downtown(sketch: Sketch, rng: Generator, cell: Polygon, area: Polygon, *, framed: bool) -> None:
    """Fill a cell with dense blocks on an irregular grid, often with a diagonal avenue.

    Args:
        sketch: Where to draw.
        rng: Draws.
        cell: Out to the centre lines of the streets around it.
        area: The part of it that is not yet taken by streets.
        framed: Whether there are streets around it.
    """
    business = rng.random() < 0.45
    streets, *_ = town_grid(sketch, rng, cell, framed=framed, spacing_m=(72.0, 118.0) if business else (58.0, 100.0))
    if not framed and rng.random() < 0.75:
        streets += avenue_across(sketch, rng, cell)
    fabric = (
        Fabric("downtown", (5, 11), towers=0.32, squares=0.06, carparks=0.05, frontage_m=(16.0, 34.0))
        if business
        else Fabric("downtown", (3, 6), towers=0.02, squares=0.05, landmarks=0.05, frontage_m=(9.0, 19.0))
    )
    fill_blocks(sketch, rng, blocks_between(area, sketch.beds(streets)), fabric)


def fill_plaza(sketch: Sketch, rng: Generator, cell: Polygon, area: Polygon, *, framed: bool) -> None:
    """Fill a cell with an old town around a great square; see `fill_downtown` for the arguments."""
    square, streets = _square_in_grid(sketch, rng, cell, framed=framed)
    sketch.lay(Ground.PLAZA, square, "plaza", name="Market Square")
    beds = sketch.beds(streets)
    blocks = blocks_between(area, planar.union_all([beds, square]))
    fabric = Fabric("plaza", (3, 5), squares=0.02, gardens=0.05, carparks=0.03, landmarks=0.08, frontage_m=(9.0, 17.0))
    facing = [block for block in blocks if block.distance(square) < 3.0 and block.area > 300.0]
    fill_blocks(sketch, rng, [block for block in blocks if block not in facing], fabric)
    for block in facing:
        perimeter_block(sketch, rng, block, Fabric("plaza", (4, 5), gaps=0.0, frontage_m=(10.0, 18.0)))
    _arcades(sketch, rng, square)
    _furnish_square(sketch, rng, square)


def _square_in_grid(sketch: Sketch, rng: Generator, cell: Polygon, *, framed: bool) -> tuple[Polygon, list[Street]]:
    """Draw an old town's crooked grid with a few of its middle blocks left free for a square."""
    min_x, min_y, max_x, max_y = cell.bounds
    width, height = max_x - min_x, max_y - min_y
    if framed:
        us, vs = even_ticks(rng, width, 66.0), even_ticks(rng, height, 60.0)
        warp = quad_warp(cell, width, height)
    else:
        reach = 0.75 * max(width, height)
        us, vs = ticks(rng, -reach, reach, (52.0, 84.0)), ticks(rng, -reach, reach, (48.0, 78.0))
        warp = rotation(((min_x + max_x) / 2, (min_y + max_y) / 2), rng.uniform(-0.5, 0.5))
    nodes = grid_nodes(rng, us, vs, warp, 8.0, frame=framed)
    centre = np.array(cell.centroid.coords[0])
    # The first corner such that the square's middle lies in the middle of the cell.
    across, up = min(2, len(us) - 1), 1 if rng.random() < 0.4 or len(vs) < 4 else 2
    if width < 260.0:
        across = 1
    middles = (nodes[:-across, :-up] + nodes[across:, up:]) / 2
    found = np.unravel_index(int(np.argmin(np.hypot(*(middles - centre).transpose(2, 0, 1)))), middles.shape[:2])
    i, j = int(found[0]), int(found[1])
    south, north = nodes[i : i + across + 1, j], nodes[i : i + across + 1, j + up][::-1]
    east, west = nodes[i + across, j + 1 : j + up], nodes[i, j + 1 : j + up][::-1]
    square = planar.buffer(Polygon(np.vstack([south, east, north, west])), 3.5, join_style="mitre")
    square = planar.intersection(square, cell)
    walking = (int(rng.integers(i, i + across + 1)), int(rng.integers(j, j + up + 1)))

    def kind_of(axis: int, index: int) -> str:
        return "pedestrian" if index == walking[1 - axis] else "residential" if index % 2 else "living_street"

    room = planar.difference(cell, planar.buffer(square, -1.0))
    return square, draw_grid(sketch, rng, nodes, within=room, kind_of=kind_of, missing=0.1, frame=framed)


def _arcades(sketch: Sketch, rng: Generator, square: Polygon) -> None:
    """Roof the edge of a square over along one or two of its sides, where buildings stand behind."""
    ring = np.asarray(square.exterior.coords)
    built = planar.union_all([item.area for item in sketch.footprints if item.area.distance(square) < 2.0])
    for side in rng.permutation(len(ring) - 1)[: int(rng.integers(2, 4))].tolist():
        a, b = ring[side], ring[side + 1]
        inward = np.array(square.centroid.coords[0]) - (a + b) / 2
        normal = np.array([a[1] - b[1], b[0] - a[0]])
        normal = normal / np.hypot(*normal) * np.sign(normal @ inward)
        strip = Polygon([a, b, b + 4.2 * normal, a + 4.2 * normal])
        behind = planar.intersection(planar.buffer(strip, 1.5), planar.buffer(built, 1.5))
        covered = planar.intersection(strip, planar.buffer(behind, 3.0))
        for part in polygons_of(covered):
            if part.area > 60.0:
                sketch.build(Footprint(part, 5.2, "plaza", "roof", min_height_m=4.2))


def _furnish_square(sketch: Sketch, rng: Generator, square: Polygon) -> None:
    """Give a great square its fountain, its monument, a few market stalls and trees in a row."""
    inner = planar.buffer(square, -12.0)
    centre = np.array(square.centroid.coords[0])
    points = [centre + rng.uniform(-4, 4, 2), *(centre + rng.uniform(-0.35, 0.35, 2) * 90 for _ in range(3))]
    for name, point in zip(("fountain", "monument", "kiosk", "artwork"), points, strict=True):
        if inner.contains(shapely.points(point)):
            sketch.put(name, float(point[0]), float(point[1]), float(rng.uniform(0, 6.28)))
    ring = LineString(np.asarray(planar.buffer(square, -9.0, join_style="mitre").exterior.coords)[:3])
    at, _ = along(np.asarray(ring.coords), float(rng.uniform(7.5, 10.0)))
    for x, y in at:
        sketch.put("tree", x, y)


def fill_waterfront(sketch: Sketch, rng: Generator, cell: Polygon, area: Polygon, *, framed: bool) -> None:
    """Fill a cell with a bending shore, a promenade, piers and blocks behind; see `fill_downtown`."""
    min_x, min_y, max_x, max_y = cell.bounds
    width, height = max_x - min_x, max_y - min_y
    wave = rng.uniform(0.6, 1.6)
    phase, swing = rng.uniform(0, 6.28), rng.uniform(0.03, 0.075) * min(width, 500.0)
    base = (0.3 if not framed else 0.36) * height * float(rng.uniform(0.85, 1.1))

    def shore(u: Points) -> Points:
        result: Points = base + swing * (
            np.sin(wave * 2 * math.pi * u / width + phase) + 0.35 * np.sin(5.1 * u / width * 2 + 2 * phase)
        )
        return result

    def warp(points: Points) -> Points:
        u, v = points[:, 0], points[:, 1]
        return np.column_stack([min_x + u, min_y + v + shore(u)])

    def line_at(v: float) -> Points:
        u = np.linspace(-30.0, width + 30.0, 60)
        return warp(np.column_stack([u, np.full_like(u, v)]))

    def band(low: float, high: float) -> Polygon:
        return planar.intersection(Polygon(np.vstack([line_at(low), line_at(high)[::-1]])), cell)

    walk = float(rng.uniform(9.0, 14.0))
    green = float(rng.uniform(9.0, 16.0))
    quay = walk + green + 9.0
    sketch.lay(Ground.WATER, band(-height * 2, 0.0), "sea")
    sketch.lay(Ground.PLAZA, band(0.0, walk), "promenade", name="Promenade")
    sketch.lay(Ground.GRASS, band(walk, walk + green), "strip")
    streets = add_street(sketch, rng, line_at(quay), "secondary", within=cell, trees=10.0)
    us = even_ticks(rng, width, 88.0)
    vs = np.arange(quay, height - base + swing * 2 + 90.0, float(rng.uniform(62, 85)))
    if framed:
        vs = vs[vs < height - base - swing - 45.0]
    vs = vs if len(vs) else np.array([quay])
    nodes = grid_nodes(rng, us, vs, warp, 3.5)
    nodes[:, 0] = warp(np.column_stack([us, np.full_like(us, quay)]))
    for row in range(1, len(vs)):
        streets += add_street(sketch, rng, smooth(nodes[:, row]), "residential", within=cell)
    for column in range(1, len(us) - 1):
        tail = nodes[column, -1:] + (0.0, 120.0)
        streets += add_street(sketch, rng, np.vstack([nodes[column], tail]), "residential", within=cell)
        foot = warp(np.array([[us[column], walk - 1.0]]))[0]
        sketch.pave(np.array([foot, nodes[column, 0] - (0.0, 6.0)]), 4.0, Ground.PAVEMENT)
    inland = planar.difference(area, band(-height * 2, quay))
    fabric = Fabric("waterfront", (4, 8), squares=0.06, gardens=0.1, carparks=0.05, landmarks=0.05, towers=0.06)
    fill_blocks(sketch, rng, blocks_between(inland, sketch.beds(streets)), fabric)
    _piers(sketch, rng, cell, warp, width)
    _shore_features(sketch, rng, warp, (width, walk, green))


def _piers(sketch: Sketch, rng: Generator, cell: Polygon, warp: Warp, width: float) -> None:
    count = max(1, round(width / 170.0))
    for index in range(count):
        u = (index + rng.uniform(0.25, 0.75)) * width / count
        foot = warp(np.array([[u, 3.0]]))[0]
        length = float(rng.uniform(35.0, 70.0))
        end = foot - (rng.uniform(-0.15, 0.15) * length, length)
        deck = planar.buffer(LineString([foot, end]), float(rng.uniform(2.6, 3.6)), cap_style="flat")
        if rng.random() < 0.6:
            across = np.array([(end[0] - 12.0, end[1] + 2.0), (end[0] + 12.0, end[1] + 2.0)])
            deck = planar.union(deck, planar.buffer(LineString(across), 3.5, cap_style="flat"))
        sketch.lay(Ground.PAVEMENT, planar.intersection(deck, cell), "pier")


def _shore_features(sketch: Sketch, rng: Generator, warp: Warp, sizes: tuple[float, float, float]) -> None:
    """Put a beach, a pavilion with a terrace and flagpoles at the shore."""
    width, walk, green = sizes
    u = float(rng.uniform(0.2, 0.8)) * width
    beach = Polygon(
        smooth(warp(np.array([(u - 55, 0.5), (u - 20, -13), (u + 22, -14), (u + 58, 0.5), (u, 2.0)])), closed=True)
    )
    water = planar.union_all([patch.area for patch in sketch.patches if patch.role == "sea"])
    piers = planar.union_all([planar.buffer(patch.area, 1.0) for patch in sketch.patches if patch.role == "pier"])
    sketch.lay(Ground.SAND, planar.difference(planar.intersection(beach, planar.buffer(water, 0.6)), piers), "beach")
    u = (u + width * float(rng.uniform(0.3, 0.6))) % width
    x, y = warp(np.array([[u, walk + green / 2]]))[0]
    sketch.lay(Ground.PLAZA, blob(rng, x, y, min(12.0, green)), "terrace")
    hut = shapely.box(x - 5.0, y - 3.0, x + 5.0, y + 3.0)
    sketch.build(Footprint(hut, 4.5, "waterfront", "pavilion", (x, y - 3.0), hosts=("cafe",)))
    for offset in (-9.0, -6.0, 6.0, 9.0):
        fx, fy = warp(np.array([[u + offset, walk - 1.2]]))[0]
        sketch.put("flagpole", fx, fy)
