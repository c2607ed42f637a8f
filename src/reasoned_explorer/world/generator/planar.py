"""Shapes cut, joined, widened and narrowed, with every corner on a grid of about a millimetre.

What such work gives differs in the last digits from one version of GEOS to the next, and so may the corner that a ring
begins with and the order of the parts. Where a generator asks whether something fits, or deals numbers out in the order
of the parts, these would decide what world comes out. On a grid and in normal order they do not.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely import LineString

#: Distance of the grid's lines, metres; a power of two, so that few of the lengths that people choose lie just between
#: two lines.
GRID_M = 2.0**-10

Points = NDArray[np.float64]
#: A geometry or an array of geometries; what is given as an array comes back as one.
Shapes = Any


def on_grid(shapes: Shapes) -> Shapes:
    """Return shapes with their corners on the grid, valid, in normal order; slivers thinner than the grid vanish."""
    # Without their precision afterwards: with it later work would take another, slower way through GEOS.
    return shapely.normalize(shapely.set_precision(shapely.set_precision(shapes, GRID_M), 0.0))


def buffer(shapes: Shapes, distance_m: float | NDArray[np.float64], **options: Any) -> Shapes:
    """Return shapes that are wider by a distance, or narrower by a negative one; options as `shapely.buffer` has."""
    return on_grid(shapely.buffer(shapes, distance_m, **options))


def difference(shapes: Shapes, other: Shapes) -> Shapes:
    """Return what of shapes does not lie in others."""
    return on_grid(shapely.difference(shapes, other))


def intersection(shapes: Shapes, other: Shapes) -> Shapes:
    """Return what of shapes lies in others."""
    return on_grid(shapely.intersection(shapes, other))


def union(shape: shapely.Geometry, other: shapely.Geometry) -> Any:
    """Return two shapes as one."""
    return on_grid(shapely.union(shape, other))


def union_all(shapes: Sequence[shapely.Geometry] | NDArray[np.object_]) -> Any:
    """Return many shapes as one."""
    return on_grid(shapely.union_all(shapes))


def simplify(shapes: Shapes, tolerance_m: float) -> Shapes:
    """Return shapes without the corners that matter less than a tolerance (Douglas and Peucker)."""
    return on_grid(shapely.simplify(shapes, tolerance_m))


def polygonize(lines: Sequence[shapely.Geometry]) -> Any:
    """Return the faces between lines, a collection of polygons."""
    return on_grid(shapely.polygonize(lines))


def lines_within(line: Points, area: shapely.Geometry) -> list[Points]:
    """Return the pieces of a line in an area, in the line's order and direction, each longer than a metre.

    Args:
        line: Shape (n, 2); one that ends where it begins may be cut into pieces there only if the area cuts it.
        area: What it is cut at.

    Returns:
        Each of shape (m, 2).
    """
    whole = LineString(line)
    pieces = []
    for part in shapely.get_parts(shapely.line_merge(shapely.intersection(whole, area))):
        if not isinstance(part, LineString) or part.length <= 1.0:
            continue
        corners = np.round(np.asarray(part.coords, float)[:, :2] / GRID_M) * GRID_M
        corners = corners[np.append(True, np.any(np.diff(corners, axis=0), axis=1))]
        # Where a line crosses itself only a stretch of it tells in which direction a piece goes.
        longest = int(np.argmax(np.hypot(*np.diff(corners, axis=0).T)))
        begins_m, ends_m = shapely.line_locate_point(whole, shapely.points(corners[longest : longest + 2])).tolist()
        pieces.append((round(min(begins_m, ends_m), 3), corners if begins_m <= ends_m else corners[::-1]))
    pieces.sort(key=lambda piece: piece[0])
    return [corners for _, corners in pieces]
