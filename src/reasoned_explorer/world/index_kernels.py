"""Distances to footprints and a uniform grid of them, at machine speed."""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Flags = NDArray[np.bool_]

#: Columns of the table of footprints.
X, Y, SIN, COS, HALF_LENGTH, HALF_WIDTH, MIN_X, MIN_Y, MAX_X, MAX_Y = range(10)
#: An id fits below this in a sort key, the distance in millimetres stands above it.
KEY_UNIT = 1 << 32


@njit(cache=True)
def _segment_distance_squared(ax: float, ay: float, bx: float, by: float, x: float, y: float) -> float:
    dx, dy = bx - ax, by - ay
    squared = dx * dx + dy * dy
    t = 0.0
    if squared > 0.0:
        t = min(1.0, max(0.0, ((x - ax) * dx + (y - ay) * dy) / squared))
    ex, ey = x - ax - t * dx, y - ay - t * dy
    return ex * ex + ey * ey


@njit(cache=True)
def ring_distance(points: Floats, start: int, end: int, x: float, y: float) -> float:
    """Return the distance from a point to the area inside the ring ``points[start:end]``; 0 inside."""
    inside = False
    best = math.inf
    previous = end - 1
    for k in range(start, end):
        ax, ay, bx, by = points[previous, 0], points[previous, 1], points[k, 0], points[k, 1]
        if (ay > y) != (by > y) and x < ax + (y - ay) * (bx - ax) / (by - ay):
            inside = not inside
        best = min(best, _segment_distance_squared(ax, ay, bx, by, x, y))
        previous = k
    return 0.0 if inside else math.sqrt(best)


@njit(cache=True)
def footprint_distance(table: Floats, spans: Ints, outlines: Floats, item: int, x: float, y: float) -> float:
    """Return the distance from a point to an object's footprint; 0 inside.

    Args:
        table: One row for each object, columns as named at the top of this module.
        spans: Start and end of each object's outline in ``outlines``, shape (n, 2); equal where it has none.
        outlines: Vertices of all outlines, shape (m, 2).
        item: The object.
        x: East, metres.
        y: North, metres.
    """
    if spans[item, 1] > spans[item, 0]:
        return ring_distance(outlines, spans[item, 0], spans[item, 1], x, y)
    row = table[item]
    dx, dy = x - row[X], y - row[Y]
    # Heading is clockwise from north: the front looks along (sin, cos), the length runs along (cos, -sin).
    across = max(0.0, abs(dx * row[COS] - dy * row[SIN]) - row[HALF_LENGTH])
    deep = max(0.0, abs(dx * row[SIN] + dy * row[COS]) - row[HALF_WIDTH])
    return math.sqrt(across * across + deep * deep)


@njit(cache=True)
def _bucket(position: float, origin: float, size: float, count: int) -> int:
    # Clipped before it becomes an integer: the position may be infinite.
    return int(min(count - 1.0, max(0.0, (position - origin) / size)))


@njit(cache=True)
def build_grid(table: Floats, rows: int, cols: int, frame: Floats) -> tuple[Ints, Ints, Ints]:
    """Return where each bucket's ids start, the ids, and the first bucket (row, col) of each object.

    Args:
        table: Footprints.
        rows: Buckets from south to north.
        cols: Buckets from west to east.
        frame: West edge, south edge and edge of a bucket, metres.
    """
    count = table.shape[0]
    corners = np.empty((count, 4), np.int64)
    starts = np.zeros(rows * cols + 1, np.int64)
    for i in range(count):
        corners[i, 0] = _bucket(table[i, MIN_Y], frame[1], frame[2], rows)
        corners[i, 1] = _bucket(table[i, MIN_X], frame[0], frame[2], cols)
        corners[i, 2] = _bucket(table[i, MAX_Y], frame[1], frame[2], rows)
        corners[i, 3] = _bucket(table[i, MAX_X], frame[0], frame[2], cols)
        for r in range(corners[i, 0], corners[i, 2] + 1):
            for c in range(corners[i, 1], corners[i, 3] + 1):
                starts[r * cols + c + 1] += 1
    for k in range(rows * cols):
        starts[k + 1] += starts[k]
    slots = starts[:-1].copy()
    ids = np.empty(starts[-1], np.int64)
    for i in range(count):
        for r in range(corners[i, 0], corners[i, 2] + 1):
            for c in range(corners[i, 1], corners[i, 3] + 1):
                ids[slots[r * cols + c]] = i
                slots[r * cols + c] += 1
    return starts, ids, corners[:, :2].copy()


@njit(cache=True)
def _box_distance_squared(row: Floats, x: float, y: float) -> float:
    dx = max(0.0, row[MIN_X] - x, x - row[MAX_X])
    dy = max(0.0, row[MIN_Y] - y, y - row[MAX_Y])
    return dx * dx + dy * dy


@njit(cache=True)
def search_grid(
    table: Floats,
    spans: Ints,
    outlines: Floats,
    starts: Ints,
    ids: Ints,
    firsts: Ints,
    shape: tuple[int, int],
    frame: Floats,
    codes: Ints,
    wanted: Flags,
    x: float,
    y: float,
    radius: float,
) -> Ints:
    """Return sort keys (millimetres · `KEY_UNIT` + id) of the objects within a radius of a point, rising.

    Args:
        table: Footprints.
        spans: Outlines' starts and ends.
        outlines: Outlines' vertices.
        starts: Where each bucket's ids start.
        ids: Ids by bucket.
        firsts: First bucket (row, col) of each object.
        shape: Rows and columns of buckets.
        frame: West edge, south edge and edge of a bucket, metres.
        codes: Class code of each object.
        wanted: Whether a class code is asked for; empty for all.
        x: East, metres.
        y: North, metres.
        radius: Metres.
    """
    rows, cols = shape
    row_low, row_high = _bucket(y - radius, frame[1], frame[2], rows), _bucket(y + radius, frame[1], frame[2], rows)
    col_low, col_high = _bucket(x - radius, frame[0], frame[2], cols), _bucket(x + radius, frame[0], frame[2], cols)
    room = 0
    for r in range(row_low, row_high + 1):
        room += starts[r * cols + col_high + 1] - starts[r * cols + col_low]
    keys = np.empty(room, np.int64)
    found = 0
    for r in range(row_low, row_high + 1):
        for c in range(col_low, col_high + 1):
            for k in range(starts[r * cols + c], starts[r * cols + c + 1]):
                i = ids[k]
                # An object stands in every bucket that it touches; the first of them in this window reports it.
                if max(firsts[i, 0], row_low) != r or max(firsts[i, 1], col_low) != c:
                    continue
                if wanted.size > 0 and not wanted[codes[i]]:
                    continue
                if _box_distance_squared(table[i], x, y) > radius * radius:
                    continue
                distance = footprint_distance(table, spans, outlines, i, x, y)
                if distance <= radius:
                    keys[found] = math.floor(distance * 1000.0 + 0.5) * KEY_UNIT + i
                    found += 1
    keys = keys[:found]
    keys.sort()
    return keys
