"""Flat polygons in space, cut into triangles."""

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
    count = len(points)
    if count == 3:
        return np.array([[0, 1, 2]])
    turned = np.roll(points, -1, axis=0)
    normal = np.cross(points - points[0], turned - points[0]).sum(axis=0)
    turns = np.cross(points - np.roll(points, 1, axis=0), turned - points) @ normal
    if (turns >= -1e-12).all():
        return _strip(count)
    first = points[1] - points[0]
    first = first / np.linalg.norm(first)
    second = np.cross(normal, first)
    return _clipped(np.column_stack([points @ first, points @ second / np.linalg.norm(second)]))


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
