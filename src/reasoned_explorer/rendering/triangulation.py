"""A polygon with holes as triangles."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.rendering.triangulation_kernels import tidy_rings, triangulate_all
from reasoned_explorer.world.rounding import millimetres

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


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
    triangles, _ = triangulate_all(corners, used, np.array([0, len(used) - 1]))
    found: Floats = (corners[triangles] + (middle * 1000.0).astype(np.int64)) / 1000.0
    return found


def starts_of(sizes: Sequence[int] | Ints) -> Ints:
    """Return where each of several runs begins, and where the last ends."""
    starts: Ints = np.concatenate([[0], np.cumsum(np.asarray(sizes, dtype=np.int64))]).astype(np.int64)
    return starts
