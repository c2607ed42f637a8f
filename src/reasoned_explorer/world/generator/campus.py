"""The campus: buildings around green quads, winding paths between their doors, car parks at the edge."""

import math

import numpy as np
import shapely
from numpy.random import Generator
from shapely import Polygon

from reasoned_explorer.world.generator import planar
from reasoned_explorer.world.generator.blocks import carpark_block, height_of
from reasoned_explorer.world.generator.park import lay_mesh, neighbours
from reasoned_explorer.world.generator.shapes import (
    Points,
    blob,
    bows,
    footprint,
    inner_circle,
    placed,
    polygons_of,
    smooth,
    spread,
    thin,
)
from reasoned_explorer.world.generator.sketch import Footprint, Sketch
from reasoned_explorer.world.generator.streets import add_street
from reasoned_explorer.world.taxonomy import Ground

_NAMES = ("Science Hall", "Engineering Building", "Student Centre", "Arts Building", "Law School", "Physics Building",
          "Chemistry Building", "Main Hall", "Sports Hall", "Institute", "Lecture Hall", "Dining Hall")  # fmt: skip


def fill_campus(sketch: Sketch, rng: Generator, cell: Polygon, area: Polygon, *, framed: bool) -> None:
    """Fill a cell with a campus.

    Args:
        sketch: Where to draw.
        rng: Draws.
        cell: Out to the centre lines of the streets around it.
        area: The part of it that is not yet taken by streets.
        framed: Whether there are streets around it.
    """
    min_x, min_y, max_x, max_y = cell.bounds
    size = min(max_x - min_x, max_y - min_y)
    ground = area
    before = len(sketch.streets)
    if not framed:
        ring = _ring_road(rng, cell)
        add_street(sketch, rng, ring, "residential", within=cell, trees=10.0)
        for corner in rng.permutation(4)[:3].tolist():
            start = ring[int((corner + 0.5) / 4 * len(ring))]
            away = start - np.array(cell.centroid.coords[0])
            line = np.array([start, start + away / np.hypot(*away) * size])
            add_street(sketch, rng, line, "residential", within=cell, trees=0.0)
    ground = planar.difference(area, sketch.beds(sketch.streets[before:])) if not framed else area
    parts = polygons_of(ground)
    inner = max(parts, key=lambda part: (part.contains(cell.centroid), part.area))
    sketch.lay(Ground.GRASS, ground, "campus")
    first = len(sketch.footprints)
    bottom = len(sketch.patches)
    quads = _quads(sketch, rng, inner)
    features = _features(sketch, rng, inner, quads, first)
    _free_buildings(sketch, rng, ground, [*quads, *features], first)
    taken = planar.buffer(planar.union_all([item.area for item in sketch.footprints[first:]]), 10.0, quad_segs=2)
    _outside(sketch, rng, [part for part in parts if part is not inner], taken)
    _paths(sketch, rng, inner, (quads, features), (first, bottom))


def _ring_road(rng: Generator, cell: Polygon) -> Points:
    min_x, min_y, max_x, max_y = cell.bounds
    centre = np.array([(min_x + max_x) / 2, (min_y + max_y) / 2])
    half = min(max_x - min_x, max_y - min_y) / 2
    angles = np.arange(12) / 12 * 2 * math.pi + rng.uniform(0, 0.5)
    # A squarish ring that reaches nearly to the border.
    squareness = 1 / np.maximum(np.abs(np.cos(angles)), np.abs(np.sin(angles)))
    radii = half * 0.8 * (0.45 + 0.55 * squareness) * rng.uniform(0.92, 1.04, 12)
    knots = centre + np.column_stack([np.cos(angles), np.sin(angles)]) * radii[:, None]
    ring = smooth(knots, closed=True)
    return np.vstack([ring, ring[:1]])


def _quads(sketch: Sketch, rng: Generator, inner: Polygon) -> list[Polygon]:
    """Lay out quads, each with academic buildings around three or four of its sides."""
    count = max(1, round(inner.area / 24_000.0))
    spots = spread(rng, planar.buffer(inner, -52.0), 22.0, jitter=0.5)
    if not len(spots):
        spots = np.array([inner_circle(inner)[:2]])
    order = rng.permutation(len(spots))
    # The first quad lies in the middle of the campus.
    order = np.append(order[np.argmin(np.hypot(*(spots[order] - inner.centroid.coords[0]).T))], order)
    grain = rng.uniform(0, math.pi)
    quads: list[Polygon] = []
    taken: list[Polygon] = []
    middles: list[tuple[float, float]] = []
    wide = planar.buffer(inner, 3.0)
    shapely.prepare(wide)
    for index in order.tolist():
        if len(quads) >= count:
            break
        x, y = spots[index].tolist()
        # So near to another quad there is no room for one, however it is turned.
        if any(math.hypot(x - other_x, y - other_y) < 80.0 for other_x, other_y in middles):
            continue
        width, depth = float(rng.uniform(48, 76)), float(rng.uniform(36, 52))
        heading = grain + float(rng.normal(0, 0.08)) + (math.pi / 2 if rng.random() < 0.4 else 0.0)
        room = placed(footprint("rect", width + 50, depth + 50, 1.0), x, y, heading)
        if not shapely.contains(wide, room) or any(room.intersects(other) for other in taken):
            continue
        middles.append((x, y))
        quad = placed(footprint("rect", width, depth, 1.0), x, y, heading)
        taken.append(planar.buffer(room, 6.0))
        quads.append(quad)
        sketch.lay(Ground.GRASS, quad, "lawn", name="Quad")
        _around(sketch, rng, (x, y, heading), (width, depth), first=len(quads) == 1)
    return quads


def _around(
    sketch: Sketch, rng: Generator, pose: tuple[float, float, float], size: tuple[float, float], *, first: bool
) -> None:
    """Build around a quad."""
    x, y, heading = pose
    width, depth = size
    open_side = int(rng.integers(5))
    for side in range(4):
        if side == open_side:
            continue
        toward = heading + side * math.pi / 2
        length, reach = (width, depth / 2) if side % 2 == 0 else (depth, width / 2)
        deep = float(rng.uniform(14.0, 20.0))
        kind = str(rng.choice(["rect", "rect", "u", "l", "t", "h"])) if length > 40 else "rect"
        centre = reach + 4.5 + deep / 2
        bx, by = x + math.sin(toward) * centre, y + math.cos(toward) * centre
        # The front looks back at the quad.
        ring = footprint(kind, length * float(rng.uniform(0.78, 0.96)), deep, 8.0)
        door = (x + math.sin(toward) * (reach + 4.5), y + math.cos(toward) * (reach + 4.5))
        hosts = ("library",) if first and side == 0 else ("cafe",) if first and side == 2 else ()
        name = "Library" if "library" in hosts else _NAMES[int(rng.integers(len(_NAMES)))]
        area = placed(ring, bx, by, toward + math.pi)
        height = height_of(rng, (2, 5))
        sketch.build(Footprint(area, height, "campus", "university", door, name=name, hosts=hosts))


def _features(sketch: Sketch, rng: Generator, inner: Polygon, quads: list[Polygon], first: int) -> list[Polygon]:
    """Lay out a pitch, a pond, a grove, a plaza and car parks where quads leave room."""
    built = [planar.buffer(item.area, 9.0, quad_segs=2) for item in sketch.footprints[first:]]
    taken: list[Polygon] = [planar.buffer(quad, 10.0, quad_segs=2) for quad in quads] + built
    features: list[Polygon] = []
    rooms = (("plaza", 15.0), ("carpark", 21.0), ("pitch", 24.0), ("pond", 19.0), ("carpark", 18.0), ("wood", 17.0))
    scale = max(1, round(inner.area / 110_000.0))
    insides = {radius: planar.buffer(inner, -radius - 2.0) for _, radius in rooms}
    for use, radius in rooms * scale:
        spots = spread(rng, insides[radius], 17.0, jitter=0.5)
        if not len(spots):
            continue
        free = np.ones(len(spots), bool)
        free[shapely.STRtree(taken).query(shapely.points(spots), predicate="dwithin", distance=radius)[0]] = False
        if not free.any():
            continue
        # Car parks lie by the road, the plaza in the middle.
        towards_edge = {"carpark": 1.0, "plaza": -1.0}.get(use)
        if towards_edge is None:
            order = np.argsort(rng.random(len(spots)))
        else:
            order = np.argsort(towards_edge * shapely.distance(shapely.points(spots), inner.exterior))
        index = next(index for index in order.tolist() if free[index])
        x, y = (float(value) for value in spots[index])
        mesh = planar.buffer(shapely.points(x, y), radius, quad_segs=6)
        taken.append(mesh)
        if use == "carpark":
            lot = placed(footprint("rect", radius * 1.55, radius * 1.1, 1.0), x, y, rng.uniform(0, math.pi))
            way = np.asarray(shapely.shortest_line(shapely.points(x, y), inner.exterior).coords)
            carpark_block(sketch, lot)
            sketch.pave(np.vstack([way[0], way[1] + (way[1] - way[0]) * 0.12]), 5.0, Ground.PARKING, "service")
            features.append(lot)
        elif use == "plaza":
            spot = blob(rng, x, y, radius * 0.8, roughness=0.1)
            sketch.lay(Ground.PLAZA, spot, "plaza", name="Campus Square")
            sketch.put(str(rng.choice(["fountain", "artwork", "clock"])), x, y)
            features.append(spot)
        else:
            lay_mesh(sketch, rng, mesh, use)
            features.append(planar.buffer(mesh, -4.0))
    return features


def _free_buildings(
    sketch: Sketch, rng: Generator, ground: shapely.Geometry, taken_areas: list[Polygon], first: int
) -> None:
    """Build halls and institutes wherever there is room, fronts to the middle of the campus or the road."""
    solid = [planar.buffer(area, 8.0, quad_segs=2) for area in taken_areas]
    solid += [planar.buffer(item.area, 13.0, quad_segs=2) for item in sketch.footprints[first:]]
    room = planar.difference(planar.buffer(ground, -6.0), planar.union_all(solid))
    shapely.prepare(room)
    spots = spread(rng, planar.buffer(ground, -15.0), 22.0, jitter=0.5)
    number = len(spots)
    grain = rng.uniform(0, math.pi)
    kinds = np.array(["rect", "rect", "l", "u", "t"])[rng.integers(5, size=number)].tolist()
    widths, depths = rng.uniform(22, 44, number).tolist(), rng.uniform(14, 28, number).tolist()
    turns = (grain + math.pi / 2 * rng.integers(4, size=number) + rng.normal(0, 0.05, number)).tolist()
    open_spots = shapely.contains_xy(room, spots).tolist() if number else []
    built: list[Polygon] = []
    middles = np.full((number, 2), np.inf)
    for index, (x, y) in enumerate(spots.tolist()):
        if len(built) > ground.area / 6000.0:
            break
        if not open_spots[index]:
            continue
        gaps = np.hypot(*(middles[: len(built)] - (x, y)).T)
        # In the least of buildings the middle is 7 m from any wall; 13 m lie between two.
        if gaps.min(initial=math.inf) < 20.0:
            continue
        width, depth, heading = widths[index], depths[index], turns[index]
        area = placed(footprint(kinds[index], width, depth, 11.0), x, y, heading)
        near = [built[place] for place in np.flatnonzero(gaps < 70.0).tolist()]
        if not shapely.contains(room, area) or any(area.intersects(other) for other in near):
            continue
        middles[len(built)] = x, y
        built.append(planar.buffer(area, 13.0, quad_segs=2))
        door = (x + math.sin(heading) * depth / 2, y + math.cos(heading) * depth / 2)
        kind_name, name = ("dormitory", "") if rng.random() < 0.3 else ("university", _NAMES[int(rng.integers(12))])
        sketch.build(Footprint(area, height_of(rng, (2, 6)), "campus", kind_name, door, name=name))


def _outside(sketch: Sketch, rng: Generator, parts: list[Polygon], taken: shapely.Geometry) -> None:
    """Plant woods and lay car parks beyond the ring road."""
    for part in parts:
        for rest in polygons_of(planar.difference(planar.buffer(part, -3.0), taken)):
            smoothed = planar.buffer(planar.buffer(rest, -5.0), 5.0)
            if rest.area > 500.0 and rng.random() < 0.65:
                sketch.lay(Ground.WOOD, smoothed, "wood")


def _paths(
    sketch: Sketch,
    rng: Generator,
    inner: Polygon,
    areas: tuple[list[Polygon], list[Polygon]],
    start: tuple[int, int],
) -> None:
    """Pave the quads' walks, and winding paths between doors, quads, features and the road."""
    (quads, features), (first, bottom) = areas, start
    nodes: list[Points] = []
    for quad in quads:
        ring = np.asarray(planar.buffer(quad, 2.0, join_style="mitre").exterior.coords)
        sketch.pave(ring, 3.0, Ground.PATH)
        corners = np.asarray(quad.exterior.coords)[:4]
        middle = corners.mean(axis=0)
        for corner in corners:
            sketch.pave(np.vstack([middle, corner]), 2.4, Ground.PATH)
        sketch.lay(Ground.PLAZA, planar.buffer(shapely.points(middle), 5.0), "rondel")
        sketch.put(str(rng.choice(["artwork", "flagpole", "fountain", "artwork"])), *middle.tolist())
        nodes.extend(ring[:4])
    for item in sketch.footprints[first:]:
        if item.entrance is not None:
            door = np.array(item.entrance)
            away = door - np.array(item.area.centroid.coords[0])
            step = door + away / max(float(np.hypot(*away)), 0.1) * 4.0
            sketch.pave(np.vstack([door, step]), 2.6, Ground.PATH)
            nodes.append(step)
    nodes.extend(np.array(feature.centroid.coords[0]) for feature in features if feature.area > 1500.0)
    outline = inner.exterior
    count = max(5, round(outline.length / 90.0))
    shares = (np.arange(count) + rng.uniform(-0.3, 0.3, count)) / count
    nodes.extend(np.array(outline.interpolate(float(share) % 1.0, normalized=True).coords[0]) for share in shares)
    points = np.array(nodes)
    points = points[thin(points, 7.0)]
    walls = [planar.buffer(item.area, 2.2, quad_segs=1) for item in sketch.footprints[first:]]
    spared = [item.area for item in sketch.patches[bottom:] if item.role in ("pond", "pitch")]
    wet = planar.buffer(np.array(spared, dtype=object), 2.5, quad_segs=2)
    blocked = planar.union_all([*walls, *wet, *(planar.buffer(quad, -1.0) for quad in quads)])
    shapely.prepare(blocked)
    found = [*neighbours(points, longest_m=150.0), *_nearest(points, 6)]
    pairs = np.array(list(dict.fromkeys((min(pair), max(pair)) for pair in found)))
    room = planar.buffer(inner, 3.0)
    shapely.prepare(room)
    sags = rng.normal(0, 0.1, len(pairs))
    left = np.arange(len(pairs))
    for sag in (sags, np.zeros(len(pairs)), np.full(len(pairs), 0.2), np.full(len(pairs), -0.2)):
        if not len(left):
            return
        ends = points[pairs[left]]
        curves = bows(ends[:, 0], ends[:, 1], sag[left])
        lines = shapely.linestrings(curves)
        inside = shapely.contains(room, lines)
        inside[~inside] = shapely.length(planar.intersection(lines[~inside], room)) > 0.9 * shapely.length(
            lines[~inside]
        )
        # Where a path begins and ends there is a wall near, the one with the door.
        doors = planar.buffer(shapely.multipoints(ends[inside]), 4.2, quad_segs=4)
        good = inside.copy()
        good[inside] = ~shapely.intersects(blocked, planar.difference(lines[inside], doors))
        for curve in curves[good]:
            sketch.pave(curve, 2.4, Ground.PATH)
        left = left[~good]


def _nearest(points: Points, count: int) -> list[tuple[int, int]]:
    """Return each point with its nearest others, so that no door stays without a path."""
    distance = np.hypot(points[:, None, 0] - points[None, :, 0], points[:, None, 1] - points[None, :, 1])
    np.fill_diagonal(distance, math.inf)
    nearest = np.argsort(distance, axis=1, kind="stable")[:, :count]
    return [(index, other) for index, row in enumerate(nearest.tolist()) for other in row]
