"""City blocks: what lies between streets, cut into lots and built up."""

import math
from bisect import bisect
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import shapely
from numpy.random import Generator
from numpy.typing import NDArray
from shapely import LineString, Polygon

from reasoned_explorer.world.generator import planar
from reasoned_explorer.world.generator.shapes import Points, blob, footprint, inner_circle, left_of, placed, polygons_of
from reasoned_explorer.world.generator.sketch import Footprint, Sketch, Zone
from reasoned_explorer.world.taxonomy import Ground


@dataclass(frozen=True, slots=True)
class Fabric:
    """How densely and how high blocks of a district are built.

    Attributes:
        zone: District.
        levels: Lowest and highest usual number of storeys.
        depth_m: Depth of the buildings around a block.
        frontage_m: Shortest and longest street front.
        towers: Share of blocks with a tower.
        squares: Share of blocks that are a small square.
        gardens: Share of blocks that are a pocket park.
        carparks: Share of blocks that are a car park.
        landmarks: Share of blocks with a church or a museum on a square of its own.
        gaps: Share of lots that stay open.
    """

    zone: Zone
    levels: tuple[int, int] = (4, 7)
    depth_m: tuple[float, float] = (11.0, 15.0)
    frontage_m: tuple[float, float] = (11.0, 24.0)
    towers: float = 0.0
    squares: float = 0.04
    gardens: float = 0.05
    carparks: float = 0.04
    landmarks: float = 0.04
    gaps: float = 0.04


_STOREY_M = 3.3


def height_of(rng: Generator, levels: tuple[int, int]) -> float:
    """Return the height of a building with a number of storeys in a range, metres."""
    return round(float(rng.integers(levels[0], levels[1] + 1)) * _STOREY_M + float(rng.uniform(0.5, 3.0)), 1)


def blocks_between(area: Polygon, beds: shapely.Geometry) -> list[Polygon]:
    """Return the blocks that streets leave of an area, from the south-west on; slivers are left out."""
    left = planar.difference(area, beds)
    found = [polygon for polygon in polygons_of(planar.simplify(left, 0.25)) if polygon.area > 60.0]
    found.sort(key=lambda polygon: (round(polygon.centroid.y, 3), round(polygon.centroid.x, 3)))
    return found


def _corner_free(ring: Points, clear_m: float, rng: Generator, frontage_m: tuple[float, float]) -> NDArray[np.object_]:
    """Return cuts across a block's rim, none of them near a sharp corner."""
    steps = np.diff(ring, axis=0)
    lengths = np.hypot(steps[:, 0], steps[:, 1])
    directions = steps / lengths[:, None]
    before = np.roll(directions, 1, axis=0)
    turn = np.arccos(np.clip((directions * before).sum(1), -1, 1))
    starts = np.concatenate([[0.0], np.cumsum(lengths)])
    total = starts[-1]
    corners = starts[:-1][turn > 0.4].tolist() or [-math.inf, math.inf]
    # The ring closes: before its beginning comes its last corner.
    around = [corners[-1] - total, *corners, corners[0] + total]
    places: list[float] = []
    where = float(rng.uniform(0, frontage_m[0]))
    while where < total - 0.5 * frontage_m[0]:
        place = bisect(around, where)
        if where - around[place - 1] >= clear_m and around[place] - where >= clear_m:
            places.append(where)
            where += float(rng.uniform(*frontage_m))
        else:
            where += 2.0
    if not places:
        return np.empty(0, dtype=object)
    at = np.array(places)
    edge = np.minimum(np.searchsorted(starts, at, side="right") - 1, len(lengths) - 1)
    foot = ring[edge] + directions[edge] * (at - starts[edge])[:, None]
    inward = left_of(directions[edge])
    cuts: NDArray[np.object_] = shapely.linestrings(np.stack([foot - inward, foot + (clear_m + 0.5) * inward], axis=1))
    return cuts


def perimeter_block(sketch: Sketch, rng: Generator, block: Polygon, fabric: Fabric) -> None:
    """Build a block up around its rim, with a courtyard that a passage leads into."""
    depth = float(rng.uniform(*fabric.depth_m))
    block = shapely.orient_polygons(planar.simplify(block, 0.3))
    court = planar.buffer(block, -depth, join_style="mitre")
    base = height_of(rng, fabric.levels)
    if court.is_empty or court.area < 150.0:
        _solid_block(sketch, rng, block, fabric)
        return
    rim = planar.difference(block, court)
    ring = np.asarray(block.exterior.coords)
    cuts = _corner_free(ring, depth, rng, fabric.frontage_m)
    pieces = polygons_of(planar.polygonize([planar.union_all([rim.boundary, *cuts])]))
    pieces = [piece for piece in pieces if piece.area > 20.0]
    shapely.prepare(rim)
    own = shapely.contains(rim, shapely.point_on_surface(np.array(pieces, dtype=object)))
    lots = [piece for piece, is_own in zip(pieces, own.tolist(), strict=True) if is_own]
    # A passage as wide as a lorry into every courtyard, so that no ground is closed off.
    passage = _passage(rng, court, ring, sketch.box)
    sketch.lay(Ground.YARD, court, "courtyard")
    sketch.lay(Ground.PAVEMENT, rim)
    choice = rng.random()
    inner = polygons_of(planar.buffer(court, -4.0)) if choice < 0.75 else []
    for part in inner:
        if choice < 0.45 and part.area > 120.0:
            sketch.lay(Ground.GARDEN, planar.buffer(planar.buffer(part, -3.0), 3.0), "garden")
        elif choice < 0.65 and part.area > 500.0:
            sketch.lay(Ground.PARKING, part, "carpark")
        elif choice < 0.75 and part.area > 300.0:
            sketch.lay(Ground.GRASS, planar.buffer(planar.buffer(part, -3.0), 3.0), "garden")
    shapely.prepare(passage)
    cut = shapely.intersects(passage, np.array(lots, dtype=object)).tolist()
    for lot, is_cut in zip(lots, cut, strict=True):
        if rng.random() < fabric.gaps:
            sketch.lay(Ground.GARDEN if rng.random() < 0.4 else Ground.YARD, lot, "gap")
            continue
        height = base + _STOREY_M * float(rng.integers(-1, 2)) + float(rng.uniform(-0.6, 0.6))
        for part in polygons_of(planar.difference(lot, passage)) if is_cut else (lot,):
            if part.area > 25.0:
                sketch.build(Footprint(part, round(max(height, 4.0), 1), fabric.zone, _use(rng, fabric)))


def _passage(rng: Generator, court: shapely.Geometry, ring: Points, box: Polygon) -> shapely.Geometry:
    """Return strips that join each courtyard to the street."""
    strips = []
    outer = LineString(ring)
    for part in polygons_of(court):
        corners = np.asarray(part.exterior.coords)
        middles = (corners[1:] + corners[:-1]) / 2
        lengths = np.hypot(*np.diff(corners, axis=0).T)
        feet = shapely.get_coordinates(
            shapely.line_interpolate_point(outer, shapely.line_locate_point(outer, shapely.points(middles)))
        )
        # From one of its longest sides, but never to where the world ends.
        open_side = shapely.distance(box.exterior, shapely.points(feet)) > 3.0
        order = np.lexsort((-lengths, ~open_side))
        side = int(order[int(rng.integers(min(2, max(1, int(open_side.sum())))))])
        way = feet[side] - middles[side]
        step = way / max(float(np.hypot(*way)), 1e-6) * 2.0
        line = LineString([middles[side] - step, feet[side] + step])
        strips.append(planar.buffer(line, 2.6, cap_style="flat"))
    return planar.union_all(strips)


def _use(rng: Generator, fabric: Fabric) -> str:
    if fabric.zone in ("downtown", "plaza"):
        return str(rng.choice(["commercial", "apartments", "office", "retail", "yes"]))
    if fabric.zone == "waterfront":
        return str(rng.choice(["apartments", "warehouse", "hotel", "commercial"]))
    return "apartments"


def _solid_block(sketch: Sketch, rng: Generator, block: Polygon, fabric: Fabric) -> None:
    """Build a narrow block up in slices, or lay it out as a green corner where it is too small."""
    if block.area < 220.0 or inner_circle(block)[2] < 5.0:
        sketch.lay(Ground.GRASS if rng.random() < 0.5 else Ground.PAVEMENT, block, "corner")
        return
    sketch.lay(Ground.PAVEMENT, block)
    box = np.asarray(shapely.minimum_rotated_rectangle(block).exterior.coords)
    sides = np.hypot(*np.diff(box, axis=0).T)[:2]
    long_side = int(np.argmax(sides))
    a, b = box[long_side], box[long_side + 1]
    across = box[long_side + 2] - b
    count = max(1, round(float(sides[long_side]) / float(rng.uniform(*fabric.frontage_m)) * 0.8))
    shares = np.linspace(0.0, 1.0, count + 1)
    shares[1:-1] += rng.uniform(-0.2, 0.2, count - 1) / count
    base = height_of(rng, fabric.levels)
    open_slice = int(rng.integers(1, count - 1)) if count > 3 and rng.random() < 0.5 else -1
    for index, (start, end) in enumerate(pairwise(shares.tolist())):
        if index == open_slice:
            continue
        corners = [a + (b - a) * start, a + (b - a) * end, a + (b - a) * end + across, a + (b - a) * start + across]
        height = base + _STOREY_M * float(rng.integers(-1, 2))
        for part in polygons_of(planar.intersection(Polygon(corners), block)):
            if part.area > 25.0:
                sketch.build(Footprint(part, round(max(height, 4.0), 1), fabric.zone, _use(rng, fabric)))


def _tower_block(sketch: Sketch, rng: Generator, block: Polygon, fabric: Fabric) -> None:
    """Build one or two towers on a paved forecourt."""
    x, y, radius = inner_circle(block)
    if radius < 14.0:
        perimeter_block(sketch, rng, block, fabric)
        return
    sketch.lay(Ground.PLAZA, block, "forecourt")
    angle = _long_heading(block)
    size = radius * float(rng.uniform(0.95, 1.15))
    kind = str(rng.choice(["rect", "rect", "l", "u", "h"]))
    ring = footprint(kind, size * 1.25, size, size * 0.42)
    tower = planar.intersection(placed(ring, x, y, angle), planar.buffer(block, -3.0))
    for part in polygons_of(tower)[:1]:
        sketch.build(Footprint(part, round(float(rng.uniform(12, 28)) * _STOREY_M, 1), fabric.zone, "office"))
    rest = planar.difference(planar.buffer(block, -3.0), planar.buffer(placed(ring, x, y, angle), 9.0))
    for part in polygons_of(rest):
        if part.area > 260.0 and rng.random() < 0.6:
            sketch.lay(Ground.GRASS, planar.buffer(planar.buffer(part, -4.0), 2.5), "lawn")


def _long_heading(block: Polygon) -> float:
    """Return the compass heading square to the longest side of a block's bounding rectangle."""
    box = np.asarray(shapely.minimum_rotated_rectangle(block).exterior.coords)
    steps = np.diff(box, axis=0)[:2]
    longest = steps[int(np.argmax(np.hypot(steps[:, 0], steps[:, 1])))]
    return float(math.atan2(longest[0], longest[1]) + math.pi / 2)


def square_block(sketch: Sketch, rng: Generator, block: Polygon, zone: Zone) -> None:
    """Lay a block out as a small square with a fountain or a monument."""
    sketch.lay(Ground.PLAZA, block, "plaza")
    x, y, radius = inner_circle(block)
    if radius > 12.0:
        ring = planar.difference(planar.buffer(block, -5.0), planar.buffer(shapely.points(x, y), 9.0))
        bed = planar.difference(ring, planar.buffer(LineString([(x - 200, y), (x + 200, y)]), 3.0))
        bed = planar.difference(bed, planar.buffer(LineString([(x, y - 200), (x, y + 200)]), 3.0))
        if rng.random() < 0.6:
            sketch.lay(Ground.GRASS, bed, "lawn")
        sketch.put(str(rng.choice(["fountain", "monument", "artwork"])), x, y, rng.uniform(0, 6.28))
    if zone == "downtown" and radius > 9.0 and rng.random() < 0.6:
        sketch.put("kiosk", x + radius * 0.72, y, rng.uniform(0, 6.28))


def garden_block(sketch: Sketch, rng: Generator, block: Polygon) -> None:
    """Lay a block out as a pocket park: lawn, a winding path through it, perhaps a playground."""
    sketch.lay(Ground.GRASS, block, "lawn")
    x, y, radius = inner_circle(block)
    if radius > 14.0 and rng.random() < 0.55:
        play = blob(rng, x, y, min(9.0, radius * 0.5), roughness=0.12)
        sketch.lay(Ground.PLAYGROUND, play, "playground")
    elif radius > 14.0:
        sketch.lay(Ground.PLAZA, planar.buffer(shapely.points(x, y), min(7.0, radius * 0.35)), "rondel")
        sketch.put(str(rng.choice(["fountain", "artwork", "planter", "monument"])), x, y)
    box = np.asarray(shapely.minimum_rotated_rectangle(block).exterior.coords)[:4]
    middle = np.array([x, y])
    for corner in box:
        end = middle + (corner - middle) * 1.05
        bend = middle + (corner - middle) * 0.5 + rng.uniform(-4, 4, 2)
        paths = planar.lines_within(np.array([middle, bend, end]), planar.buffer(block, 0.5))
        if len(paths) == 1:
            sketch.pave(paths[0], 2.6, Ground.PATH, "footway")


def carpark_block(sketch: Sketch, block: Polygon) -> None:
    """Lay a block out as a car park behind a green edge."""
    sketch.lay(Ground.GRASS, block, "verge")
    inner = planar.buffer(block, -2.0, join_style="mitre")
    sketch.lay(Ground.PARKING, inner, "carpark")
    for part in polygons_of(inner):
        x, y, _ = inner_circle(part)
        nearest = shapely.shortest_line(shapely.points(x, y), block.exterior)
        ends = np.asarray(nearest.coords)
        ends[1] += (ends[1] - ends[0]) / max(float(np.hypot(*(ends[1] - ends[0]))), 1e-6) * 1.0
        sketch.pave(ends, 5.0, Ground.PARKING, "service")


def landmark_block(sketch: Sketch, rng: Generator, block: Polygon, fabric: Fabric) -> None:
    """Put a church or a museum on a paved or green block."""
    x, y, radius = inner_circle(block)
    if radius < 15.0:
        perimeter_block(sketch, rng, block, fabric)
        return
    church = rng.random() < 0.5
    sketch.lay(Ground.GRASS if church and rng.random() < 0.5 else Ground.PLAZA, block, "forecourt")
    heading = _long_heading(block)
    size = min(radius * 0.75, 19.0)
    if church:
        nave = placed(footprint("rect", size * 0.8, size * 2.0, 5.0), x, y, heading)
        cross = placed(footprint("rect", size * 1.5, size * 0.6, 5.0), x, y, heading)
        outline, host, height, kind = planar.union(nave, cross), "church", float(rng.uniform(16, 30)), "church"
    else:
        outline = placed(footprint("u", size * 1.9, size * 1.3, size * 0.45), x, y, heading)
        host, height, kind = str(rng.choice(["museum", "library"])), float(rng.uniform(12, 20)), "public"
    front = np.array([math.sin(heading), math.cos(heading)]) * (size if church else size * 0.65)
    door = (x + float(front[0]), y + float(front[1]))
    sketch.pave(np.array([door, (x + float(front[0]) * 2.6, y + float(front[1]) * 2.6)]), 5.0, Ground.PLAZA)
    sketch.build(Footprint(outline, round(height, 1), fabric.zone, kind, door, hosts=(host,)))


def fill_blocks(sketch: Sketch, rng: Generator, blocks: list[Polygon], fabric: Fabric) -> None:
    """Give each block a use and build it up."""
    uses = ("tower", "square", "garden", "carpark", "landmark", "perimeter")
    shares = np.array([fabric.towers, fabric.squares, fabric.gardens, fabric.carparks, fabric.landmarks])
    weights = np.append(shares, max(0.0, 1.0 - shares.sum()))
    for block in blocks:
        if block.area < 900.0:
            _solid_block(sketch, rng, block, fabric)
            continue
        use = uses[int(rng.choice(len(uses), p=weights / weights.sum()))]
        if use == "square" and block.area < 6000.0:
            square_block(sketch, rng, block, fabric.zone)
        elif use == "garden" and block.area < 8000.0:
            garden_block(sketch, rng, block)
        elif use == "carpark" and block.area < 6000.0:
            carpark_block(sketch, block)
        elif use == "landmark":
            landmark_block(sketch, rng, block, fabric)
        elif use == "tower":
            _tower_block(sketch, rng, block, fabric)
        else:
            perimeter_block(sketch, rng, block, fabric)
