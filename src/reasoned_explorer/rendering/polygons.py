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
    arms = points - points[0]
    flat = np.column_stack([arms @ first, arms @ second / np.linalg.norm(second)])
    # The same figure comes again and again, in other places.
    return _remembered(np.round(flat, 7).tobytes())


@lru_cache(maxsize=512)
def _remembered(flat: bytes) -> IntArray:
    return _clipped(np.frombuffer(flat, np.float64).reshape(-1, 2))


def _turning(points: list[list[float]]) -> tuple[list[float], bool]:
    """Return a polygon's normal (of any length) and whether it turns one way at all its corners."""
    # In plain Python: polygons have few corners, and there are thousands of them.
    x0, y0, z0 = points[0]
    arms = [(x - x0, y - y0, z - z0) for x, y, z in points]
    nx = ny = nz = 0.0
    turns = []
    ax, ay, az = arms[-2]
    bx, by, bz = arms[-1]
    for cx, cy, cz in arms:
        nx, ny, nz = nx + by * cz - bz * cy, ny + bz * cx - bx * cz, nz + bx * cy - by * cx
        ux, uy, uz, vx, vy, vz = bx - ax, by - ay, bz - az, cx - bx, cy - by, cz - bz
        turns.append((uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx))
        ax, ay, az, bx, by, bz = bx, by, bz, cx, cy, cz
    return [nx, ny, nz], all(tx * nx + ty * ny + tz * nz >= -1e-12 for tx, ty, tz in turns)


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
