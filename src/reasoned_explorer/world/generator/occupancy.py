"""Which spots are taken: turned rectangles in a hash grid, none of which may overlap another."""

import math

_CELL_M = 6.0
_Rect = tuple[float, float, float, float, float, float, float]
_Cells = dict[tuple[int, int], list[_Rect]]


class Occupancy:
    """The rectangles that stand already, and those that are kept open for passers-by."""

    def __init__(self) -> None:
        self._cells: _Cells = {}
        self._open: _Cells = {}

    def take(self, x: float, y: float, heading_rad: float, length_m: float, depth_m: float) -> None:
        """Take a spot without asking."""
        _enter(self._cells, _rect(x, y, heading_rad, length_m, depth_m))

    def keep_open(self, x: float, y: float, heading_rad: float, length_m: float, depth_m: float) -> None:
        """Keep a spot open: nothing may stand there, but other spots kept open may overlap it."""
        _enter(self._open, _rect(x, y, heading_rad, length_m, depth_m))

    def free(
        self, x: float, y: float, heading_rad: float, length_m: float, depth_m: float, *, gap_m: float = 0.25
    ) -> bool:
        """Return whether a spot may be taken: grown by a gap on all sides it is free, and itself not kept open."""
        grown = _rect(x, y, heading_rad, length_m + 2 * gap_m, depth_m + 2 * gap_m)
        if _met(self._cells, grown):
            return False
        return not self._open or not _met(self._open, _rect(x, y, heading_rad, length_m, depth_m))

    def passable(self, x: float, y: float, heading_rad: float, length_m: float, depth_m: float) -> bool:
        """Return whether nothing stands on a spot."""
        return not _met(self._cells, _rect(x, y, heading_rad, length_m, depth_m))


def _enter(cells: _Cells, rect: _Rect) -> None:
    for cell in _cells_of(rect):
        if cell in cells:
            cells[cell].append(rect)
        else:
            cells[cell] = [rect]


def _met(cells: _Cells, rect: _Rect) -> bool:
    x, y, radius = rect[0], rect[1], rect[6]
    for cell in _cells_of(rect):
        for other in cells.get(cell, ()):
            reach = radius + other[6]
            # Most are far apart: asked here, since a call costs more.
            if abs(x - other[0]) < reach and abs(y - other[1]) < reach and _overlap(rect, other):
                return True
    return False


def _rect(x: float, y: float, heading: float, length: float, depth: float) -> _Rect:
    # Centre, unit vector of the front, half extents, radius.
    return (x, y, math.sin(heading), math.cos(heading), length / 2, depth / 2, math.hypot(length, depth) / 2)


def _cells_of(rect: _Rect) -> list[tuple[int, int]]:
    x, y, radius = rect[0], rect[1], rect[6]
    left, right = int((x - radius) // _CELL_M), int((x + radius) // _CELL_M)
    low, high = int((y - radius) // _CELL_M), int((y + radius) // _CELL_M)
    if left == right and low == high:
        return [(left, low)]
    return [(column, row) for column in range(left, right + 1) for row in range(low, high + 1)]


def _overlap(a: _Rect, b: _Rect) -> bool:
    """Return whether two turned rectangles overlap (separating axes)."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    if dx * dx + dy * dy >= (a[6] + b[6]) ** 2:
        return False
    # |cos| and |sin| of the angle between the two.
    along = abs(a[2] * b[2] + a[3] * b[3])
    across = abs(a[2] * b[3] - a[3] * b[2])
    return not (
        abs(dx * a[2] + dy * a[3]) >= a[5] + b[5] * along + b[4] * across
        or abs(dx * a[3] - dy * a[2]) >= a[4] + b[4] * along + b[5] * across
        or abs(dx * b[2] + dy * b[3]) >= b[5] + a[5] * along + a[4] * across
        or abs(dx * b[3] - dy * b[2]) >= b[4] + a[4] * along + a[5] * across
    )
