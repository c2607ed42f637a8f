"""Parked cars: along kerbs and in the rows of car parks."""

import math

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely import Polygon

from reasoned_explorer.world.generator import planar
from reasoned_explorer.world.generator.ground import GroundPlan
from reasoned_explorer.world.generator.shapes import Points, along, heading_of, left_of, polygons_of, turned
from reasoned_explorer.world.generator.sketch import Sketch
from reasoned_explorer.world.generator.streets import Crossing
from reasoned_explorer.world.taxonomy import Ground

_KERB_PITCH_M = 5.9
_BAY_M = (2.6, 5.2)


def park_cars(sketch: Sketch, plan: GroundPlan, crossings: list[Crossing]) -> tuple[Points, NDArray[np.float64]]:
    """Return where cars stand, shape (n, 2), and where they head, compass radians."""
    spots, ways = [], []
    for index, street in enumerate(sketch.streets):
        if not street.parking:
            continue
        rng = sketch.rng("kerb cars", index)
        busy = float(rng.uniform(0.25, 0.65))
        at, tangents = along(street.line, _KERB_PITCH_M, start_m=3.0, end_m=3.0)
        normals = left_of(tangents)
        # Traffic keeps to the right: cars on the right of a line head along it.
        sides = (-1.0,) if street.road_m < 8.0 else (1.0, -1.0)
        for side in sides:
            keep = rng.random(len(at)) < busy
            spots.append((at + side * (street.road_m / 2 - 1.15) * normals)[keep])
            ways.append(heading_of(-side * tangents)[keep])
    kerb = np.vstack(spots) if spots else np.empty((0, 2))
    heading = np.concatenate(ways) if ways else np.empty(0)
    good = _clear_kerb(sketch, kerb, crossings)
    kerb, heading = kerb[good], heading[good]
    bays, bay_heading = _bays(sketch)
    points, headings = np.vstack([kerb, bays]), np.concatenate([heading, bay_heading])
    wanted = np.repeat([Ground.ROAD, Ground.PARKING], [len(kerb), len(bays)])
    fits = np.ones(len(points), bool)
    front = np.column_stack([np.sin(headings), np.cos(headings)])
    right = np.column_stack([front[:, 1], -front[:, 0]])
    for ahead, aside in ((2.3, 0.95), (2.3, -0.95), (-2.3, 0.95), (-2.3, -0.95), (0.0, 0.0)):
        fits &= plan.at(points + ahead * front + aside * right) == wanted
    return points[fits], headings[fits]


def _clear_kerb(sketch: Sketch, points: Points, crossings: list[Crossing]) -> NDArray[np.bool_]:
    """Return which cars keep clear of crossings, drives and other carriageways."""
    good = np.ones(len(points), bool)
    if not len(points):
        return good
    made = shapely.points(points)
    if crossings:
        middles = shapely.points(np.array([middle for middle, _, _ in crossings]))
        close, _ = shapely.STRtree(middles).query(made, predicate="dwithin", distance=8.5)
        good[close] = False
    drives = [shapely.LineString(trail.line) for trail in sketch.trails if trail.ground == Ground.PARKING]
    if drives:
        close, _ = shapely.STRtree(drives).query(made, predicate="dwithin", distance=4.6)
        good[close] = False
    # Near a car only its own street may run: two carriageways within reach mean a junction.
    beds = [
        planar.buffer(shapely.LineString(street.line), street.road_m / 2)
        for street in sketch.streets
        if street.road_m > 0
    ]
    near, _ = shapely.STRtree(beds).query(made, predicate="dwithin", distance=4.0)
    good &= np.bincount(near, minlength=len(points)) <= 1
    return good


def _bays(sketch: Sketch) -> tuple[Points, NDArray[np.float64]]:
    """Return the cars in the rows of car parks: two rows nose to nose, then an aisle."""
    spots, ways = [], []
    for index, patch in enumerate(sketch.patches):
        if patch.role != "carpark":
            continue
        rng = sketch.rng("bays", index)
        busy = float(rng.uniform(0.35, 0.75))
        for lot in polygons_of(patch.area):
            at, heading = _rows(lot)
            keep = rng.random(len(at)) < busy
            turn = np.where(rng.random(len(at)) < 0.25, math.pi, 0.0)
            spots.append(at[keep])
            ways.append((heading + turn)[keep] % (2 * math.pi))
    if not spots:
        return np.empty((0, 2)), np.empty(0)
    return np.vstack(spots), np.concatenate(ways)


def _rows(lot: Polygon) -> tuple[Points, NDArray[np.float64]]:
    box = np.asarray(shapely.minimum_rotated_rectangle(lot).exterior.coords)
    step = box[1] - box[0] if np.hypot(*(box[1] - box[0])) >= np.hypot(*(box[2] - box[1])) else box[2] - box[1]
    angle = math.atan2(step[1], step[0])
    centre = box[:4].mean(axis=0)
    local = turned(np.asarray(lot.exterior.coords) - centre, -angle)
    (min_x, min_y), (max_x, max_y) = local.min(axis=0), local.max(axis=0)
    rows: list[tuple[float, float]] = []
    y = min_y + 0.4 + _BAY_M[1] / 2
    looking = 0.0
    while y < max_y - _BAY_M[1] / 2 - 0.2:
        rows.append((y, looking))
        # Row, aisle, two rows nose to nose, aisle …
        y += _BAY_M[1] + (6.2 if looking == 0.0 else 0.3)
        looking = math.pi if looking == 0.0 else 0.0
    xs = np.arange(min_x + 0.4 + _BAY_M[0] / 2, max_x - _BAY_M[0] / 2, _BAY_M[0])
    if not rows or not len(xs):
        return np.empty((0, 2)), np.empty(0)
    grid = np.array([(x, row) for row, _ in rows for x in xs])
    at = turned(grid, angle) + centre
    heading = np.repeat([(-angle + turn) % (2 * math.pi) for _, turn in rows], len(xs))
    inside = shapely.contains_xy(planar.buffer(lot, -0.8), at)
    return at[inside], heading[inside]
