"""What makes ground recognisable on a map: lines along the shore, crowns in a wood, the markings of a pitch."""

from collections.abc import Iterable, Sequence

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely.geometry.base import BaseGeometry

from reasoned_explorer.world.world import Bounds, Region

FloatArray = NDArray[np.float64]


def polygon_of(outer: FloatArray, holes: Iterable[FloatArray] = ()) -> BaseGeometry:
    """Return a valid polygon for a ring and its holes, mended where it crosses itself; it may be empty."""
    if len(outer) < 3:
        return shapely.Polygon()
    polygon = shapely.Polygon(outer, [hole for hole in holes if len(hole) >= 3])
    return polygon if polygon.is_valid else polygon.buffer(0.0)


def lines_of(shape: BaseGeometry) -> list[FloatArray]:
    """Return the lines of a geometry, each of shape (n, 2); nothing for points and emptiness."""
    parts = shapely.get_parts(shape)
    return [
        np.asarray(part.coords)[:, :2]
        for part in parts
        if part.geom_type in {"LineString", "LinearRing"} and len(part.coords) >= 2
    ]


def shore_lines(regions: Sequence[Region], inset_m: float, bounds: Bounds) -> list[FloatArray]:
    """Return the outline of all water together, drawn inwards by ``inset_m``, without what follows the world's edge."""
    if not regions:
        return []
    water = shapely.union_all([polygon_of(region.outer, region.holes) for region in regions])
    if inset_m > 0.0:
        water = water.buffer(-inset_m, quad_segs=4)
    frame = shapely.box(bounds.min_x_m, bounds.min_y_m, bounds.max_x_m, bounds.max_y_m)
    shore = water.boundary.intersection(frame.buffer(-inset_m - 0.5)) if not water.is_empty else water
    return lines_of(shapely.line_merge(shore) if shore.geom_type == "MultiLineString" else shore)


def wood_crowns(regions: Sequence[Region], spacing_m: float, bounds: Bounds, *, shift: float) -> FloatArray:
    """Return crowns on a jittered grid inside woods, shape (n, 12, 2).

    They are a pattern, not trees that stand there. The same place has the same crown whatever the map shows.

    Args:
        regions: The woods.
        spacing_m: Of the grid.
        bounds: Nothing outside is needed.
        shift: Moves every crown towards the light, in spacings, and shrinks it: for its bright side.
    """
    if not regions:
        return np.empty((0, 12, 2))
    wood = shapely.union_all([polygon_of(region.outer, region.holes) for region in regions])
    frame = shapely.box(bounds.min_x_m, bounds.min_y_m, bounds.max_x_m, bounds.max_y_m)
    wood = wood.intersection(frame.buffer(spacing_m))
    if wood.is_empty:
        return np.empty((0, 12, 2))
    west, south, east, north = wood.bounds
    columns = np.arange(np.floor(west / spacing_m), np.ceil(east / spacing_m) + 1)
    rows = np.arange(np.floor(south / spacing_m), np.ceil(north / spacing_m) + 1)
    column, row = (grid.ravel() for grid in np.meshgrid(columns, rows))
    jitter_x, jitter_y, size = (_hashed(column, row, salt) for salt in (12.9898, 39.3461, 73.1562))
    x = (column + 0.5 * (row % 2) + 0.55 * (jitter_x - 0.5)) * spacing_m
    y = (row + 0.55 * (jitter_y - 0.5)) * spacing_m
    radius = (0.36 + 0.16 * size) * spacing_m
    shapely.prepare(wood)
    inside = shapely.contains_xy(wood, x, y)
    x, y, radius = x[inside], y[inside], radius[inside]
    x, y = x + shift * spacing_m, y - shift * spacing_m
    radius = radius * (1.0 - 3.0 * abs(shift))
    angles = np.linspace(0.0, 2.0 * np.pi, 12, endpoint=False)
    ring = np.column_stack([np.cos(angles), np.sin(angles)])
    return np.asarray(np.column_stack([x, y])[:, None, :] + radius[:, None, None] * ring[None, :, :])


def _hashed(column: FloatArray, row: FloatArray, salt: float) -> FloatArray:
    """Return a number in [0, 1) for each cell (integers mixed, so that it is the same on every machine)."""
    mixed = column.astype(np.int64).astype(np.uint64) * np.uint64(0x9E3779B97F4A7C15)
    mixed ^= row.astype(np.int64).astype(np.uint64) * np.uint64(0xC2B2AE3D27D4EB4F)
    mixed += np.uint64(int(salt * 1e9))
    mixed = (mixed ^ (mixed >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    mixed = (mixed ^ (mixed >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return np.asarray((mixed ^ (mixed >> np.uint64(31))) >> np.uint64(11), dtype=np.float64) / float(1 << 53)


def pitch_lines(outer: FloatArray) -> list[FloatArray]:
    """Return the markings of a pitch: touch lines, the halfway line and the centre circle, if it is a rectangle."""
    polygon = polygon_of(outer)
    if polygon.is_empty or polygon.area < 60.0:
        return []
    rectangle = polygon.minimum_rotated_rectangle
    if rectangle.geom_type != "Polygon" or polygon.area < 0.85 * rectangle.area:
        return []
    corners = np.asarray(rectangle.exterior.coords)[:4, :2]
    if np.hypot(*(corners[1] - corners[0])) < np.hypot(*(corners[2] - corners[1])):
        corners = np.roll(corners, -1, axis=0)
    long_side, short_side = corners[1] - corners[0], corners[3] - corners[0]
    length, width = float(np.hypot(*long_side)), float(np.hypot(*short_side))
    along, across = long_side / length, short_side / width
    centre = corners[0] + 0.5 * (long_side + short_side)
    inset = min(1.5, 0.06 * width)
    half_length, half_width = 0.5 * length - inset, 0.5 * width - inset

    def at(*places: tuple[float, float]) -> FloatArray:
        return np.array([centre + u * along + v * across for u, v in places])

    frame = at(
        (-half_length, -half_width),
        (half_length, -half_width),
        (half_length, half_width),
        (-half_length, half_width),
        (-half_length, -half_width),
    )
    lines = [frame, at((0.0, -half_width), (0.0, half_width))]
    angles = np.linspace(0.0, 2.0 * np.pi, 40)
    radius = min(9.15, 0.22 * width)
    lines.append(centre + radius * (np.cos(angles)[:, None] * along + np.sin(angles)[:, None] * across))
    box_depth, box_half = 0.14 * length, 0.28 * width
    for end in (-1.0, 1.0):
        goal = end * half_length
        lines.append(
            at(
                (goal, -box_half),
                (goal - end * box_depth, -box_half),
                (goal - end * box_depth, box_half),
                (goal, box_half),
            )
        )
    return lines
