"""The park: a web of curved paths, and in its meshes lawns, ponds, woods, play and sport."""

import math

import numpy as np
import shapely
from numpy.random import Generator
from shapely import LineString, Polygon

from reasoned_explorer.world.generator import planar
from reasoned_explorer.world.generator.blocks import Fabric, blocks_between, fill_blocks
from reasoned_explorer.world.generator.shapes import (
    Points,
    along,
    blob,
    bow,
    footprint,
    inner_circle,
    placed,
    polygons_of,
    smooth,
    spread,
    thin,
)
from reasoned_explorer.world.generator.sketch import Footprint, Sketch, Street
from reasoned_explorer.world.generator.streets import add_street
from reasoned_explorer.world.taxonomy import Ground


def neighbours(points: Points, *, longest_m: float) -> list[tuple[int, int]]:
    """Return the Gabriel graph of points: pairs whose diametral circle holds no other point.

    Such graphs have no needless near-parallel paths and stay connected where no edge is too long.
    """
    first, second = np.triu_indices(len(points), 1)
    middle = (points[first] + points[second]) / 2
    reach = np.hypot(*(points[first] - points[second]).T)
    short = reach < longest_m
    first, second, middle, reach = first[short], second[short], middle[short], reach[short]
    squared = (middle[:, None, 0] - points[None, :, 0]) ** 2 + (middle[:, None, 1] - points[None, :, 1]) ** 2
    rows = np.arange(len(first))
    squared[rows, first] = squared[rows, second] = math.inf
    keep = squared.min(axis=1, initial=math.inf) > (reach / 2) ** 2 if len(first) else np.zeros(0, bool)
    return list(zip(first[keep].tolist(), second[keep].tolist(), strict=True))


def fill_park(sketch: Sketch, rng: Generator, cell: Polygon, area: Polygon, *, framed: bool) -> None:
    """Fill a cell with a park; unframed, streets and a fringe of blocks run around it.

    Args:
        sketch: Where to draw.
        rng: Draws.
        cell: Out to the centre lines of the streets around it.
        area: The part of it that is not yet taken by streets.
        framed: Whether there are streets around it.
    """
    park = area if framed else _fringe(sketch, rng, cell)
    bottom = (len(sketch.patches), len(sketch.footprints))
    sketch.lay(Ground.GRASS, park, "park")
    lines = path_web(rng, park)
    for line, width in lines:
        sketch.pave(line, width, Ground.PATH, "footway")
    web = planar.union_all([planar.buffer(LineString(line), width / 2 + 0.3, quad_segs=2) for line, width in lines])
    meshes = [mesh for mesh in polygons_of(planar.difference(park, web)) if mesh.area > 120.0]
    meshes.sort(key=lambda mesh: (round(-mesh.area, 2), round(mesh.centroid.x, 2)))
    _fill_meshes(sketch, rng, meshes)
    _junction_squares(sketch, rng, park, lines, bottom)


def _fringe(sketch: Sketch, rng: Generator, cell: Polygon) -> Polygon:
    """Draw the streets around a park and the blocks beyond them; return what is left for the park."""
    min_x, min_y, max_x, max_y = cell.bounds
    size = max_x - min_x
    inset = rng.uniform(0.07, 0.14, (4, 2)) * min(size, 500.0)
    signs = np.array([(1, 1), (-1, 1), (-1, -1), (1, -1)])
    corners = np.array([(min_x, min_y), (max_x, min_y), (max_x, max_y), (min_x, max_y)]) + signs * inset
    streets: list[Street] = []
    for index in range(4):
        a, b = corners[index], corners[(index + 1) % 4]
        step = (b - a) / np.hypot(*(b - a))
        kind = "secondary" if index == 0 else "residential"
        trees = float(rng.uniform(8.0, 11.0))
        streets += add_street(sketch, rng, np.array([a - step * size, b + step * size]), kind, within=cell, trees=trees)
    beds = sketch.beds(streets)
    blocks = blocks_between(cell, beds)
    middle = cell.centroid
    park = next(block for block in blocks if block.contains(middle))
    fabric = Fabric("park", (4, 6), squares=0.05, gardens=0.08, carparks=0.1, landmarks=0.05)
    fill_blocks(sketch, rng, [block for block in blocks if block is not park], fabric)
    return park


def path_web(rng: Generator, park: Polygon) -> list[tuple[Points, float]]:
    """Return the lines and widths of a park's paths: gates, a promenade, a loop and a web between."""
    outline = park.exterior
    gate_count = max(4, round(outline.length / 150.0))
    offsets = (np.arange(gate_count) + rng.uniform(-0.25, 0.25, gate_count)) / gate_count
    gates = np.array([outline.interpolate(float(share) % 1.0, normalized=True).coords[0] for share in offsets])
    inner = planar.buffer(park, -26.0)
    if inner.is_empty:
        inner = planar.buffer(park, -inner_circle(park)[2] * 0.5)
    nodes = spread(rng, max(polygons_of(inner), key=lambda part: part.area), 66.0, jitter=0.3)
    nodes = nodes[thin(nodes, 40.0)]
    points = np.vstack([gates, nodes]) if len(nodes) else np.vstack([gates, [park.centroid.coords[0]]])
    lines: list[tuple[Points, float]] = []
    for one, other in neighbours(points, longest_m=170.0):
        if one < gate_count and other < gate_count:
            continue
        sag = float(rng.normal(0.0, 0.09))
        lines.append((bow(points[one], points[other], sag), float(rng.choice([2.2, 2.6, 3.0]))))
    # A straight promenade joins two gates that lie opposite, with trees on both sides (see greenery).
    start = int(rng.integers(gate_count))
    end = (start + gate_count // 2) % gate_count
    lines.append((np.vstack([gates[start], gates[end]]), 4.5))
    loop = planar.buffer(planar.buffer(park, -24.0), 9.0)
    for part in polygons_of(loop):
        knots, _ = along(np.asarray(part.exterior.coords), part.exterior.length / max(6, part.exterior.length // 42))
        knots = knots + rng.uniform(-4.0, 4.0, knots.shape)
        ring = smooth(knots, closed=True)
        lines.append((np.vstack([ring, ring[:1]]), 3.0))
    # Wherever a web's edge left the park through a bent border it is cut off.
    room = planar.buffer(park, 4.0)
    return [(part, width) for line, width in lines for part in planar.lines_within(line, room)]


def _rounded(mesh: Polygon, margin_m: float, radius_m: float) -> list[Polygon]:
    return polygons_of(planar.buffer(planar.buffer(mesh, -margin_m - radius_m), radius_m))


def _fill_meshes(sketch: Sketch, rng: Generator, meshes: list[Polygon]) -> None:
    """Give each mesh of the web of paths its use, the largest first."""
    total = sum(mesh.area for mesh in meshes)
    wanted = ["pond", "wood", "pitch", "meadow", "playground", "cafe", "wood", "garden", "grove", "wood"]
    wanted += [*rng.permutation(["wood", "meadow", "garden", "picnic", "grove", "lawn"]).tolist()] * 8
    ponds = 0
    for mesh in meshes:
        if not wanted:
            break
        radius = inner_circle(mesh)[2]
        needs = {"pond": 13.0, "pitch": 21.0, "playground": 11.0, "cafe": 13.0, "wood": 8.0, "garden": 9.0}
        use = next((name for name in wanted if needs.get(name, 5.0) <= radius), "lawn")
        if use in wanted:
            wanted.remove(use)
        if use == "pond":
            ponds += 1
            if total > 250_000.0 and ponds < 3:
                wanted.insert(4, "pond")
        lay_mesh(sketch, rng, mesh, use)


def lay_mesh(sketch: Sketch, rng: Generator, mesh: Polygon, use: str) -> None:
    """Lay one mesh out.

    Args:
        sketch: Where to draw.
        rng: Draws.
        mesh: What lies between paths.
        use: ``pond``, ``meadow``, ``pitch``, ``wood``, ``playground``, ``cafe``, ``garden``, ``picnic``, ``grove`` or
            ``lawn``.
    """
    x, y, radius = inner_circle(mesh)
    if use == "pond":
        shape = planar.intersection(
            planar.union_all(_rounded(mesh, 7.0, 5.0)), blob(rng, x, y, radius * 1.25, roughness=0.3)
        )
        sketch.lay(Ground.WATER, planar.buffer(planar.buffer(shape, -2.0), 2.0), "pond", name="Pond")
    elif use == "pitch":
        _pitch(sketch, rng, mesh)
    elif use == "playground":
        sketch.lay(Ground.PLAYGROUND, blob(rng, x, y, min(radius * 0.8, 15.0), roughness=0.14), "playground")
    elif use == "cafe":
        _pavilion(sketch, rng, mesh)
    else:
        ground = {"wood": Ground.WOOD, "garden": Ground.GARDEN}.get(use, Ground.GRASS)
        margin, radius = {"wood": (1.0, 4.0), "garden": (4.0, 3.0)}.get(use, (0.5, 1.5))
        sketch.lay(ground, planar.union_all(_rounded(mesh, margin, radius)), use)


def _pavilion(sketch: Sketch, rng: Generator, mesh: Polygon) -> None:
    """Build a cafe with toilets on a terrace, its door to the nearest path."""
    x, y, radius = inner_circle(mesh)
    sketch.lay(Ground.PLAZA, blob(rng, x, y, min(radius * 0.85, 16.0), roughness=0.1), "terrace")
    nearest = np.asarray(shapely.shortest_line(shapely.points(x, y), mesh.exterior).coords)
    sketch.pave(np.vstack([nearest[0], nearest[1] + (nearest[1] - nearest[0]) * 0.3]), 3.0, Ground.PATH)
    heading = float(math.atan2(*(nearest[1] - nearest[0])))
    hut = placed(footprint("rect", 9.0, 5.5, 3.0), x, y, heading)
    door = (x + 2.75 * math.sin(heading), y + 2.75 * math.cos(heading))
    sketch.build(Footprint(hut, 4.2, "park", "pavilion", door, hosts=("cafe", "toilets")))


def _pitch(sketch: Sketch, rng: Generator, mesh: Polygon) -> None:
    """Lay the largest sports pitch that fits, turned with the mesh."""
    x, y, radius = inner_circle(mesh)
    box = np.asarray(shapely.minimum_rotated_rectangle(mesh).exterior.coords)
    angle = float(math.atan2(*(box[1] - box[0])))
    for scale in (1.5, 1.2, 1.0, 0.8):
        for heading in (angle, angle + math.pi / 2, float(rng.uniform(0, math.pi))):
            ring = placed(footprint("rect", radius * scale, radius * scale * 0.62, 1.0), x, y, heading)
            if ring.within(planar.buffer(mesh, -2.0)):
                sketch.lay(Ground.PITCH, ring, "pitch")
                return


def _junction_squares(
    sketch: Sketch, rng: Generator, park: Polygon, lines: list[tuple[Points, float]], start: tuple[int, int]
) -> None:
    """Widen a few places where paths meet into small round squares with something in the middle."""
    ends = np.vstack([line[[0, -1]] for line, _ in lines])
    inside = ends[shapely.contains_xy(planar.buffer(park, -20.0), ends)]
    if not len(inside):
        return
    points, counts = np.unique(np.round(inside, 2), axis=0, return_counts=True)
    order = np.argsort(-counts, kind="stable")
    taken: list[Points] = []
    centres = ["fountain", "artwork", "planter", "monument", "planter"]
    solid = (Ground.WATER, Ground.PITCH, Ground.PLAYGROUND)
    blocked = planar.union_all(
        [patch.area for patch in sketch.patches[start[0] :] if patch.ground in solid]
        + [item.area for item in sketch.footprints[start[1] :]]
    )
    for index in order.tolist():
        point = points[index]
        if len(taken) >= max(2, round(park.area / 26_000.0)):
            break
        disc = planar.buffer(shapely.points(point), float(rng.uniform(6.0, 9.0)))
        if any(np.hypot(*(point - other)) < 60.0 for other in taken) or disc.intersects(blocked):
            continue
        sketch.lay(Ground.PLAZA, disc, "rondel")
        # Fixtures stand on a rondel that lies over the paths.
        sketch.put(centres[len(taken) % len(centres)], float(point[0]), float(point[1]), float(rng.uniform(0, 6.28)))
        taken.append(point)
