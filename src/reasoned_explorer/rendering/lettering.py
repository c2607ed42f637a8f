"""What stands on signs: words in block letters and flat figures, laid on a plane as geometry.

Letters are strokes on a grid four units wide and six high, each stroke a flat bar.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reasoned_explorer.rendering.mesh_builder import MeshBuilder, Surface

FloatArray = NDArray[np.float64]

_GRID_WIDTH = 4.0
_GRID_HEIGHT = 6.0
_GAP = 1.7
_STROKE = 1.05
_SPACE = 2.2
#: From this level of detail a word is one bar; a single letter stays one for a level more.
_BAR_DETAIL = 2

_STROKES: dict[str, str] = {
    "A": "00 04 26 44 40|02 42",
    "B": "00 06 36 45 44 33 03|33 42 41 30 00",
    "C": "45 36 16 05 01 10 30 41",
    "D": "00 06 26 45 41 20 00",
    "E": "46 06 00 40|03 33",
    "F": "46 06 00|03 33",
    "G": "45 36 16 05 01 10 40 43 23",
    "H": "00 06|40 46|03 43",
    "I": "00 06",
    "J": "46 41 30 10 01",
    "K": "00 06|46 03|13 40",
    "L": "06 00 40",
    "M": "00 06 23 46 40",
    "N": "00 06 40 46",
    "O": "10 01 05 16 36 45 41 30 10",
    "P": "00 06 36 45 44 33 03",
    "Q": "10 01 05 16 36 45 41 30 10|22 40",
    "R": "00 06 36 45 44 33 03|23 40",
    "S": "45 36 16 05 04 13 33 42 41 30 10 01",
    "T": "06 46|26 20",
    "U": "06 01 10 30 41 46",
    "V": "06 20 46",
    "W": "06 10 24 30 46",
    "X": "00 46|06 40",
    "Y": "06 23 46|23 20",
    "Z": "06 46 00 40",
    "0": "10 01 05 16 36 45 41 30 10",
    "1": "14 26 20",
    "2": "05 16 36 45 44 00 40",
    "3": "06 46 23 33 42 41 30 10 01",
    "4": "30 36 02 42",
    "5": "46 06 03 33 42 41 30 00",
    "6": "46 16 04 01 10 30 41 42 33 03",
    "7": "06 46 10",
    "8": "13 04 05 16 36 45 44 33 13 02 01 10 30 41 42 33",
    "9": "43 13 04 05 16 36 45 42 30 00",
    "!": "06 02|01 00",
}


@dataclass(frozen=True, slots=True)
class Plane:
    """A plane to write on, as its reader sees it.

    Attributes:
        origin: Where u = v = 0.
        right: Unit vector to the reader's right: u.
        up: Unit vector upward: v.
    """

    origin: tuple[float, float, float]
    right: tuple[float, float, float]
    up: tuple[float, float, float] = (0.0, 0.0, 1.0)

    def points(self, flat: ArrayLike) -> FloatArray:
        """Return places in space of places on the plane, shape (n, 2) to (n, 3), metres."""
        places = np.asarray(flat, np.float64)
        return np.asarray(np.asarray(self.origin) + places @ np.array([self.right, self.up]))

    def nearer(self, by_m: float) -> "Plane":
        """Return the plane moved towards its reader: what is drawn there lies on what is drawn here."""
        x, y, z = (np.asarray(self.origin) + by_m * np.cross(self.right, self.up)).tolist()
        return Plane((x, y, z), self.right, self.up)


def facing_front(y: float, *, x: float = 0.0) -> Plane:
    """Return the upright plane at a depth that is read from ahead (+y); u = 0 at x, v is the height."""
    return Plane((x, y, 0.0), (-1.0, 0.0, 0.0))


def facing_back(y: float, *, x: float = 0.0) -> Plane:
    """Return the upright plane that is read from behind (-y)."""
    return Plane((x, y, 0.0), (1.0, 0.0, 0.0))


def facing_side(x: float, *, y: float = 0.0) -> Plane:
    """Return the upright plane that is read from the side that it lies on: from +x for x ≥ 0, else from -x."""
    return Plane((x, y, 0.0), (0.0, 1.0 if x >= 0.0 else -1.0, 0.0))


def width_m(text: str, height_m: float) -> float:
    """Return how wide a word is in letters of a height, metres."""
    advances = [_advance(letter) for letter in text]
    return (sum(advances) - _GAP + _STROKE) * height_m / (_GRID_HEIGHT + _STROKE)


def write(
    builder: MeshBuilder, surface: Surface, text: str, plane: Plane, *, centre: tuple[float, float], height_m: float
) -> None:
    """Write a word on a plane.

    Args:
        builder: Where to.
        surface: Of the letters.
        text: Capital letters, digits, spaces and ``!``; what has no letter is left blank.
        plane: Lies a centimetre before the face of the board.
        centre: Middle of the word on the plane, metres.
        height_m: Of the letters.
    """
    unit = height_m / (_GRID_HEIGHT + _STROKE)
    if builder.detail >= _BAR_DETAIL + (len(text) == 1):
        half_u, half_v = width_m(text, height_m) / 2.0, 0.24 * height_m
        builder.decal(surface, plane.points(rectangle(centre[0], centre[1], 2.0 * half_u, 2.0 * half_v)))
        return
    bars: list[FloatArray] = []
    at = 0.0
    for letter in text:
        bars.extend(bar + np.array([at, 0.0]) for bar in _bars(letter))
        at += _advance(letter)
    if not bars:
        return
    middle = np.array([(at - _GAP) / 2.0, _GRID_HEIGHT / 2.0])
    corners = (np.concatenate(bars) - middle) * unit + np.asarray(centre)
    firsts = 4 * np.arange(len(bars))[:, None]
    triangles = np.concatenate([firsts + np.array([[0, 1, 2]]), firsts + np.array([[0, 2, 3]])])
    builder.part(surface, plane.points(corners), triangles)


def _advance(letter: str) -> float:
    if letter == " ":
        return _SPACE + _GAP
    return (0.0 if letter in "I!" else _GRID_WIDTH) + _GAP


def _bars(letter: str) -> list[FloatArray]:
    """Return the strokes of a letter as rectangles on the grid, each shape (4, 2), counter-clockwise."""
    found = []
    for line in _STROKES.get(letter, "").split("|"):
        points = [np.array([float(pair[0]), float(pair[1])]) for pair in line.split()]
        for start, end in pairwise(points):
            along = (end - start) / math.hypot(*(end - start)) * _STROKE / 2.0
            left = np.array([-along[1], along[0]])
            found.append(np.array([start - along - left, end + along - left, end + along + left, start - along + left]))
    return found


def rectangle(u: float, v: float, width: float, height: float) -> FloatArray:
    """Return the corners of a rectangle about its middle, shape (4, 2)."""
    corners = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    return np.asarray(np.array([u, v]) + corners * np.array([width, height]) / 2.0)


def disc(u: float, v: float, radius: float, *, sides: int = 16, turn_rad: float = 0.0) -> FloatArray:
    """Return the corners of a regular polygon, the first above its middle unless turned, shape (sides, 2)."""
    angles = math.pi / 2.0 + turn_rad + np.arange(sides) * 2.0 * math.pi / sides
    return np.column_stack([u + radius * np.cos(angles), v + radius * np.sin(angles)])


def cross(u: float, v: float, size: float, *, arm: float = 0.33) -> FloatArray:
    """Return the corners of a cross with equal arms; ``arm`` is their width as a share of its size, shape (12, 2)."""
    far, near = size / 2.0, arm * size / 2.0
    quarter = [(far, -near), (far, near), (near, near)]
    turned = [(x * c - y * s, x * s + y * c) for c, s in ((1, 0), (0, 1), (-1, 0), (0, -1)) for x, y in quarter]
    return np.asarray(np.array([u, v]) + np.array(turned))


def line(points: Sequence[tuple[float, float]], width: float) -> list[FloatArray]:
    """Return the rectangles of a line of a width, one for each piece, each shape (4, 2)."""
    found = []
    for first, last in pairwise(points):
        start, end = np.array(first), np.array(last)
        along = (end - start) / math.hypot(*(end - start))
        left = np.array([-along[1], along[0]]) * width / 2.0
        found.append(np.array([start - left, end - left, end + left, start + left]))
    return found
