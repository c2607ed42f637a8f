"""Flat polygons in space, cut into triangles."""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


def triangulated(points: FloatArray) -> IntArray:
    """Return triangles that cover a flat simple polygon, turning the way that it turns.

    Args:
        points: Corners in order, shape (n, 3), n ≥ 3, all in one plane.

    Returns:
        Places of corners, shape (n - 2, 3).
    """
    normal, convex = _turning(points.tolist())
    if convex:
        return _strip(len(points))
    first = points[1] - points[0]
    first = first / np.linalg.norm(first)
    second = np.array(_cross_of(normal, first.tolist()))
    return _clipped(np.column_stack([points @ first, points @ second / np.linalg.norm(second)]))


def _turning(points: list[list[float]]) -> tuple[list[float], bool]:
    """Return a polygon's normal (of any length) and whether it turns one way at all its corners."""
    # In plain Python: polygons have few corners, and there are thousands of them.
    edges = [[b - a for a, b in zip(points[k - 1], points[k], strict=True)] for k in range(len(points))]
    turns = [_cross_of(edges[k - 1], edges[k]) for k in range(len(edges))]
    start = points[0]
    arms = [[b - a for a, b in zip(start, point, strict=True)] for point in points]
    swept = [_cross_of(arms[k - 1], arms[k]) for k in range(2, len(arms))]
    normal = [sum(part[axis] for part in swept) for axis in range(3)]
    return normal, all(sum(a * b for a, b in zip(turn, normal, strict=True)) >= -1e-12 for turn in turns)


def _cross_of(one: list[float], other: list[float]) -> list[float]:
    (a, b, c), (d, e, f) = one, other
    return [b * f - c * e, c * d - a * f, a * e - b * d]


@lru_cache(maxsize=256)
def _strip(count: int) -> IntArray:
    """Return a convex polygon's triangles as a zigzag, which has fewer slivers than a fan."""
    low, high, found = 0, count - 1, []
    while high - low > 1:
        found.append((low, low + 1, high))
        low += 1
        if high - low > 1:
            found.append((low, high - 1, high))
            high -= 1
    return np.array(found)


def _clipped(flat: FloatArray) -> IntArray:
    """Return the triangles of a polygon that turns left as a whole, shape (n, 2), by clipping ears."""
    left = list(range(len(flat)))
    found: list[tuple[int, int, int]] = []
    while len(left) > 3:
        ears = [place for place in range(len(left)) if _is_ear(flat, left, place)]
        # Rounding can hide the last ears of a nearly flat rest: clip any corner then.
        place = max(ears, key=lambda at: _least_height(flat, left, at), default=0)
        found.append((left[place - 1], left[place], left[(place + 1) % len(left)]))
        del left[place]
    return np.array([*found, tuple(left)])


def _corner(flat: FloatArray, left: list[int], place: int) -> FloatArray:
    return flat[[left[place - 1], left[place], left[(place + 1) % len(left)]]]


def _is_ear(flat: FloatArray, left: list[int], place: int) -> bool:
    a, b, c = _corner(flat, left, place)
    if _cross(b - a, c - b) <= 1e-14:
        return False
    beside = {place, (place - 1) % len(left), (place + 1) % len(left)}
    others = flat[[corner for at, corner in enumerate(left) if at not in beside]]
    inside = (
        (_cross(b - a, others - a) >= -1e-14)
        & (_cross(c - b, others - b) >= -1e-14)
        & (_cross(a - c, others - c) >= -1e-14)
    )
    return not bool(inside.any())


def _least_height(flat: FloatArray, left: list[int], place: int) -> float:
    """Return how far the corner's triangle is from being a sliver, metres."""
    a, b, c = _corner(flat, left, place)
    longest = max(float(np.hypot(*(b - a))), float(np.hypot(*(c - b))), float(np.hypot(*(a - c))))
    return float(_cross(b - a, c - a)) / longest


def _cross(one: FloatArray, other: FloatArray) -> FloatArray:
    return np.asarray(one[..., 0] * other[..., 1] - one[..., 1] * other[..., 0])
