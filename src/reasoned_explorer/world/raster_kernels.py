"""Painting polygons and thick lines into grids at machine speed.

All coordinates are in cells of the grid: x grows with the column, y with the row, and the centre of cell (row, col) is
at (col + 0.5, row + 0.5). A cell is painted when its centre lies in the shape; of two shapes that share an edge exactly
one paints a centre on it.
"""

import math

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.world.compiling import kernel, part

Codes = NDArray[np.uint8]
Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@part
def _first_index(position: float) -> int:
    """Return the index of the first cell whose centre is at or beyond a position."""
    return math.ceil(position - 0.5)


@part
def _rows_of_edge(points: Floats, a: int, b: int, rows: int) -> tuple[int, int]:
    """Return the half-open range of rows whose centre lines an edge crosses."""
    low = min(points[a, 1], points[b, 1])
    high = max(points[a, 1], points[b, 1])
    return max(0, _first_index(low)), min(rows, _first_index(high))


@part
def _count_crossings(points: Floats, start: int, end: int, counts: Ints) -> None:
    previous = end - 1
    for k in range(start, end):
        first, beyond = _rows_of_edge(points, previous, k, counts.size)
        for row in range(first, beyond):
            counts[row] += 1
        previous = k


@part
def _collect_crossings(points: Floats, start: int, end: int, slots: Ints, crossings: Floats) -> None:
    previous = end - 1
    for k in range(start, end):
        first, beyond = _rows_of_edge(points, previous, k, slots.size)
        if beyond > first:
            slope = (points[k, 0] - points[previous, 0]) / (points[k, 1] - points[previous, 1])
            for row in range(first, beyond):
                crossings[slots[row]] = points[previous, 0] + (row + 0.5 - points[previous, 1]) * slope
                slots[row] += 1
        previous = k


@part
def _paint_row(codes: Codes, row: int, crossings: Floats, begin: int, end: int, value: int) -> None:
    """Paint between every odd one of a row's crossings and the next one; they are sorted on the way."""
    for i in range(begin + 1, end):
        x = crossings[i]
        j = i - 1
        while j >= begin and crossings[j] > x:
            crossings[j + 1] = crossings[j]
            j -= 1
        crossings[j + 1] = x
    for i in range(begin, end - 1, 2):
        first = max(0, _first_index(crossings[i]))
        beyond = min(codes.shape[1], _first_index(crossings[i + 1]))
        for col in range(first, beyond):
            codes[row, col] = value


@kernel
def fill_polygons(
    codes: Codes, points: Floats, ring_ends: Ints, polygon_ends: Ints, values: Codes, counts: Ints, crossings: Floats
) -> None:
    """Fill polygons one after the other, even-odd over all rings of each.

    Args:
        codes: Grid that is painted in place, shape (rows, cols).
        points: Vertices of all rings, shape (n, 2), in cells.
        ring_ends: Where in ``points`` each ring ends.
        polygon_ends: Where in ``ring_ends`` each polygon ends.
        values: What each polygon paints.
        counts: Room, zeros, shape (rows,).
        crossings: Room for all crossings of a polygon's edges with the middles of rows.
    """
    rows = codes.shape[0]
    first_ring = 0
    for polygon in range(polygon_ends.size):
        start = 0 if first_ring == 0 else ring_ends[first_ring - 1]
        low, high = math.inf, -math.inf
        begin = start
        for ring in range(first_ring, polygon_ends[polygon]):
            for k in range(begin, ring_ends[ring]):
                low, high = min(low, points[k, 1]), max(high, points[k, 1])
            _count_crossings(points, begin, ring_ends[ring], counts)
            begin = ring_ends[ring]
        if low < rows and high > 0.0:
            first, beyond = max(0, _first_index(low)), min(rows, _first_index(high))
            total = 0
            for row in range(first, beyond):
                count = counts[row]
                counts[row] = total
                total += count
            begin = start
            for ring in range(first_ring, polygon_ends[polygon]):
                _collect_crossings(points, begin, ring_ends[ring], counts, crossings)
                begin = ring_ends[ring]
            begin = 0
            for row in range(first, beyond):
                _paint_row(codes, row, crossings, begin, counts[row], values[polygon])
                begin = counts[row]
                counts[row] = 0
        first_ring = polygon_ends[polygon]


@part
def _disc_span(x: float, y: float, radius: float, line_y: float) -> tuple[float, float]:
    rest = radius * radius - (line_y - y) * (line_y - y)
    if rest < 0.0:
        return math.inf, -math.inf
    half = math.sqrt(rest)
    return x - half, x + half


@part
def _strip_span(factor: float, offset: float, low: float, high: float) -> tuple[float, float]:
    """Return the interval of t in which low ≤ factor·t + offset ≤ high."""
    if abs(factor) < 1e-12:
        if low <= offset <= high:
            return -math.inf, math.inf
        return math.inf, -math.inf
    a, b = (low - offset) / factor, (high - offset) / factor
    return min(a, b), max(a, b)


@part
def _paint_capsule(codes: Codes, ax: float, ay: float, bx: float, by: float, radius: float, value: int) -> None:
    length = math.hypot(bx - ax, by - ay)
    ux, uy = (0.0, 0.0) if length == 0.0 else ((bx - ax) / length, (by - ay) / length)
    first = max(0, _first_index(min(ay, by) - radius))
    beyond = min(codes.shape[0], _first_index(max(ay, by) + radius))
    for row in range(first, beyond):
        y = row + 0.5
        low, high = _disc_span(ax, ay, radius, y)
        low_b, high_b = _disc_span(bx, by, radius, y)
        low, high = min(low, low_b), max(high, high_b)
        if length > 0.0:
            # The rectangle between the two discs, cut by this row's centre line, with t = x - ax.
            along_low, along_high = _strip_span(ux, (y - ay) * uy, 0.0, length)
            across_low, across_high = _strip_span(uy, -(y - ay) * ux, -radius, radius)
            mid_low, mid_high = max(along_low, across_low), min(along_high, across_high)
            if mid_low <= mid_high:
                low, high = min(low, ax + mid_low), max(high, ax + mid_high)
        if low <= high:
            for col in range(max(0, _first_index(low)), min(codes.shape[1], _first_index(high))):
                codes[row, col] = value


@kernel
def paint_lines(codes: Codes, points: Floats, line_ends: Ints, radii: Floats, values: Codes) -> None:
    """Paint lines of a width one after the other, with round ends and joins.

    Args:
        codes: Grid that is painted in place, shape (rows, cols).
        points: Vertices of all lines, shape (n, 2), in cells.
        line_ends: Where in ``points`` each line ends.
        radii: Half the width of each line, in cells.
        values: What each line paints.
    """
    start = 0
    for line in range(line_ends.size):
        for k in range(start, max(start, line_ends[line] - 1)):
            _paint_capsule(
                codes, points[k, 0], points[k, 1], points[k + 1, 0], points[k + 1, 1], radii[line], values[line]
            )
        start = line_ends[line]
