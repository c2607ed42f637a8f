"""Which spots are taken: turned rectangles in a hash grid, none of which may overlap another."""

import math
from collections.abc import Iterable

_CELL_M = 6.0
_Rect = tuple[float, float, float, float, float, float, float]


class Occupancy:
    """The rectangles that stand already."""

    def __init__(self) -> None:
        self._cells: dict[tuple[int, int], list[_Rect]] = {}

    def take(self, x: float, y: float, heading_rad: float, length_m: float, depth_m: float) -> None:
        """Take a spot without asking."""
        rect = _rect(x, y, heading_rad, length_m, depth_m)
        for cell in _cells_of(rect):
            self._cells.setdefault(cell, []).append(rect)

    def free(
        self, x: float, y: float, heading_rad: float, length_m: float, depth_m: float, *, gap_m: float = 0.25
    ) -> bool:
        """Return whether a spot, grown by a gap on all sides, is free."""
        rect = _rect(x, y, heading_rad, length_m + 2 * gap_m, depth_m + 2 * gap_m)
        for cell in _cells_of(rect):
            for other in self._cells.get(cell, ()):
                if _overlap(rect, other):
                    return False
        return True


def _rect(x: float, y: float, heading: float, length: float, depth: float) -> _Rect:
    # Centre, unit vector of the front, half extents, radius.
    return (x, y, math.sin(heading), math.cos(heading), length / 2, depth / 2, math.hypot(length, depth) / 2)


def _cells_of(rect: _Rect) -> Iterable[tuple[int, int]]:
    x, y, radius = rect[0], rect[1], rect[6]
    for column in range(math.floor((x - radius) / _CELL_M), math.floor((x + radius) / _CELL_M) + 1):
        for row in range(math.floor((y - radius) / _CELL_M), math.floor((y + radius) / _CELL_M) + 1):
            yield column, row


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
