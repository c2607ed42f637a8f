"""Polygons with holes as triangles."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.rendering.triangulation_kernels import tidy, triangulate
from reasoned_explorer.world.compiling import interpreted
from reasoned_explorer.world.rounding import millimetres

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

#: So many corners to tidy, and so many pairs of corners of one polygon to triangulate, are done before compiled code is
#: even read from disk, let alone compiled; seconds of a first picture.
_FEW_CORNERS, _FEW_PAIRS = 2_000, 20_000


def triangles_of(outer: Floats, holes: Sequence[Floats] = ()) -> Floats:
    """Return triangles that cover a polygon exactly, as it is to the millimetre.

    Rings may run either way; corners that shape nothing are left out. A polygon without area has no triangles.

    Args:
        outer: Shape (n, 2), metres.
        holes: Likewise.

    Returns:
        Corners of counter-clockwise triangles, shape (m, 3, 2), metres.
    """
    rings = [np.asarray(ring, dtype=np.float64).reshape(-1, 2) for ring in (outer, *holes)]
    points = np.concatenate(rings)
    if not len(points):
        return np.empty((0, 3, 2))
    # About the middle: whole numbers stay small enough to be multiplied.
    middle = np.floor((points.min(axis=0) + points.max(axis=0)) / 2.0)
    whole = millimetres(points - middle).astype(np.int64)
    is_hole = np.arange(len(rings)) > 0
    kept, starts = tidy_rings(whole, starts_of([len(ring) for ring in rings]), is_hole, 0, 1)
    if starts[1] == 0:
        return np.empty((0, 3, 2))
    used = np.append(starts[:-1][np.diff(starts) > 0], starts[-1])
    corners = whole[kept]
    triangles = triangulate_all(corners, used, np.array([0, len(used) - 1]))
    found: Floats = (corners[triangles] + (middle * 1000.0).astype(np.int64)) / 1000.0
    return found


def tidy_rings(points: Ints, ring_starts: Ints, is_hole: Bools, slack: int, least_area: int) -> tuple[Ints, Ints]:
    """Return rings without corners that shape nothing, outlines counter-clockwise and holes clockwise.

    Args:
        points: Shape (n, 2), whole numbers.
        ring_starts: Where each ring begins in ``points``, and where the last ends.
        is_hole: Of each ring.
        slack: How far a corner may be off the line and still go.
        least_area: Rings of less than this lose all their corners.

    Returns:
        Places in ``points`` of the corners that stay, and where each ring begins in them, and the last ends.
    """
    found, starts = np.empty(len(points), np.int64), np.empty(len(ring_starts), np.int64)
    tidied = interpreted(tidy) if len(points) <= _FEW_CORNERS else tidy
    tidied(points, ring_starts, is_hole, slack, least_area, found, starts)
    return found[: starts[-1]], starts


def triangulate_all(points: Ints, ring_starts: Ints, polygon_starts: Ints) -> Ints:
    """Cut polygons into triangles.

    Args:
        points: Corners of all rings, shape (n, 2), whole numbers of less than 2^30; outlines counter-clockwise, holes
            clockwise.
        ring_starts: Where each ring begins in ``points``, and where the last ends.
        polygon_starts: Where each polygon's rings begin, its outline first, and where the last ends.

    Returns:
        Triangles, counter-clockwise, as places in ``points``, shape (m, 3).
    """
    rings = np.diff(polygon_starts)
    corners = np.diff(ring_starts[polygon_starts])
    room = int((corners + 2 * rings).max(initial=0))
    corner, after, before = np.empty((3, room), np.int64)
    merged, tried = np.empty((2, room), np.bool_)
    triangles = np.empty((len(points) + 2 * len(ring_starts), 3), np.int64)
    cut = interpreted(triangulate) if int(np.sum(corners**2)) <= _FEW_PAIRS else triangulate
    made = cut(points, ring_starts, polygon_starts, corner, after, before, merged, tried, triangles)
    return triangles[:made]


def starts_of(sizes: Sequence[int] | Ints) -> Ints:
    """Return where each of several runs begins, and where the last ends."""
    starts: Ints = np.concatenate([[0], np.cumsum(np.asarray(sizes, dtype=np.int64))]).astype(np.int64)
    return starts
