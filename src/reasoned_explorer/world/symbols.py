"""The pictograms of the map: one for each class of objects, drawn from strokes, discs and boxes.

A pictogram lies in the square from -1 to 1. It is white on a disc in the colour of its family (what quenches, what one
rests on, what has wheels …); how large the disc is tells how much the thing matters to somebody who looks for a place.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from matplotlib.path import Path as MarkPath
from numpy.typing import NDArray
from shapely import LineString, Point, Polygon, box, unary_union
from shapely.geometry.base import BaseGeometry as _Shape

from reasoned_explorer.world.drawing_style import FAMILY_COLOURS


def _s(*points: tuple[float, float], w: float = 0.24) -> _Shape:
    """A stroke."""
    return LineString(points).buffer(w / 2, quad_segs=4)


def _d(x: float, y: float, r: float) -> _Shape:
    """A disc."""
    return Point(x, y).buffer(r, quad_segs=8)


def _b(x0: float, y0: float, x1: float, y1: float) -> _Shape:
    """A box."""
    return box(x0, y0, x1, y1)


def _p(*points: tuple[float, float]) -> _Shape:
    """A polygon."""
    return Polygon(points)


def _a(x: float, y: float, r: float, start_deg: float, end_deg: float, *, w: float = 0.22) -> _Shape:
    """An arc, counter-clockwise from east."""
    angles = np.radians(np.linspace(start_deg, end_deg, 25))
    return LineString(np.column_stack([x + r * np.cos(angles), y + r * np.sin(angles)])).buffer(w / 2, quad_segs=4)


def _u(*shapes: _Shape, cut: tuple[_Shape, ...] = ()) -> _Shape:
    """Shapes together, less the cuts."""
    whole = unary_union(shapes)
    return whole.difference(unary_union(cut)) if cut else whole


def _turned(shape: Callable[[float], _Shape]) -> _Shape:
    return _u(*(shape(turn) for turn in (0.0, 120.0, 240.0)))


def _cycle_arrow(turn: float) -> _Shape:
    end = math.radians(turn + 90.0)
    tip = math.radians(turn + 128.0)
    head = _p(
        (0.3 * math.cos(end), 0.3 * math.sin(end)),
        (1.02 * math.cos(end), 1.02 * math.sin(end)),
        (0.66 * math.cos(tip), 0.66 * math.sin(tip)),
    )
    return _u(_a(0, 0, 0.66, turn + 15, turn + 92, w=0.28), head)


def _bicycle() -> _Shape:
    return _u(
        _a(-0.56, -0.3, 0.38, 0, 360, w=0.17),
        _a(0.56, -0.3, 0.38, 0, 360, w=0.17),
        _s((-0.56, -0.3), (-0.22, 0.3), (0.38, 0.3), (0.56, -0.3), w=0.17),
        _s((-0.22, 0.3), (0.05, -0.3), (0.38, 0.3), w=0.17),
        _s((0.38, 0.3), (0.3, 0.62), (0.6, 0.66), w=0.17),
        _s((-0.22, 0.3), (-0.28, 0.52), w=0.17),
        _s((-0.46, 0.55), (-0.08, 0.55), w=0.19),
    )


def _football() -> _Shape:
    corners = [(0.36 * math.sin(math.radians(a)), 0.36 * math.cos(math.radians(a))) for a in range(0, 360, 72)]
    seams = [_s(corner, (corner[0] * 2.3, corner[1] * 2.3), w=0.16) for corner in corners]
    return _u(_a(0, 0, 0.84, 0, 360, w=0.18), _p(*corners), *seams)


def _standing(x: float, *, skirt: bool) -> _Shape:
    head = _d(x, 0.72, 0.2)
    legs = _u(_b(x - 0.17, -0.95, x - 0.02, 0.0), _b(x + 0.02, -0.95, x + 0.17, 0.0))
    body = _p((x, 0.5), (x - 0.38, -0.4), (x + 0.38, -0.4)) if skirt else _b(x - 0.28, -0.2, x + 0.28, 0.46)
    return _u(head, legs, body)


_GLYPHS: dict[str, Callable[[], _Shape]] = {
    "bench": lambda: _u(
        _s((-0.85, -0.05), (0.85, -0.05)),
        _s((-0.85, 0.5), (0.85, 0.5), w=0.3),
        _s((-0.6, 0.5), (-0.6, -0.75)),
        _s((0.6, 0.5), (0.6, -0.75)),
    ),
    "picnic_table": lambda: _u(
        _s((-0.65, 0.5), (0.65, 0.5)),
        _s((-0.95, -0.1), (0.95, -0.1)),
        _s((-0.3, 0.5), (-0.7, -0.8)),
        _s((0.3, 0.5), (0.7, -0.8)),
    ),
    "outdoor_seating": lambda: _u(
        _p((-0.95, 0.2), (-0.6, 0.68), (0, 0.92), (0.6, 0.68), (0.95, 0.2)),
        _s((0, 0.2), (0, -0.85), w=0.2),
        _s((-0.45, -0.88), (0.45, -0.88)),
    ),
    "waste_basket": lambda: _u(
        _p((-0.6, 0.38), (0.6, 0.38), (0.42, -0.95), (-0.42, -0.95)),
        _s((-0.72, 0.62), (0.72, 0.62)),
        _s((-0.2, 0.82), (0.2, 0.82)),
        cut=(_s((-0.2, 0.1), (-0.16, -0.65), w=0.13), _s((0.2, 0.1), (0.16, -0.65), w=0.13)),
    ),
    "recycling": lambda: _turned(_cycle_arrow),
    "fire_hydrant": lambda: _u(
        _b(-0.38, -0.8, 0.38, 0.35),
        _d(0, 0.35, 0.38),
        _b(-0.75, -0.2, 0.75, 0.18),
        _b(-0.58, -0.97, 0.58, -0.72),
        _d(0, 0.82, 0.15),
        cut=(_d(0, 0, 0.17),),
    ),
    "street_lamp": lambda: _u(
        _s((-0.35, -0.95), (-0.35, 0.55), (-0.15, 0.85), (0.3, 0.85), w=0.22),
        _p((0.0, 0.9), (0.85, 0.9), (0.68, 0.45), (0.18, 0.45)),
        _s((-0.6, -0.9), (-0.1, -0.9)),
    ),
    "bollard": lambda: _u(_b(-0.3, -0.9, 0.3, 0.6), _d(0, 0.6, 0.3), cut=(_b(-0.4, 0.1, 0.4, 0.32),)),
    "bicycle_parking": lambda: _u(
        _s((-0.85, -0.85), (-0.85, 0.3), (-0.6, 0.65), (-0.3, 0.65), (-0.08, 0.3), (-0.08, -0.85), w=0.2),
        _s((0.1, 0.65), (0.45, 0.65), (0.75, 0.3), (0.75, -0.85), w=0.2),
        _s((-0.95, -0.85), (0.95, -0.85), w=0.2),
    ),
    "bicycle_rental": _bicycle,
    "bicycle": _bicycle,
    "fountain": lambda: _u(
        _p((-0.92, -0.3), (0.92, -0.3), (0.55, -0.92), (-0.55, -0.92)),
        _a(-0.36, 0.22, 0.36, 0, 180, w=0.19),
        _a(0.36, 0.22, 0.36, 0, 180, w=0.19),
        _s((-0.72, 0.22), (-0.72, -0.1), w=0.19),
        _s((0.72, 0.22), (0.72, -0.1), w=0.19),
        _s((0, 0.85), (0, -0.3), w=0.2),
    ),
    "drinking_water": lambda: _u(
        _s((-0.85, 0.4), (0.2, 0.4), (0.45, 0.2), (0.45, 0.0), w=0.32),
        _s((-0.3, 0.4), (-0.3, 0.8), w=0.2),
        _s((-0.6, 0.8), (0.0, 0.8), w=0.2),
        _d(0.45, -0.66, 0.24),
        _p((0.23, -0.58), (0.67, -0.58), (0.45, -0.18)),
    ),
    "artwork": lambda: _u(
        _d(0, 0.52, 0.36),
        _p((-0.62, -0.35), (0.62, -0.35), (0.5, 0.0), (0.2, 0.2), (-0.2, 0.2), (-0.5, 0.0)),
        _b(-0.5, -0.95, 0.5, -0.5),
    ),
    "monument": lambda: _u(
        _p((-0.26, -0.5), (0.26, -0.5), (0.15, 0.62), (0, 0.95), (-0.15, 0.62)),
        _b(-0.5, -0.74, 0.5, -0.5),
        _b(-0.8, -0.97, 0.8, -0.74),
    ),
    "information": lambda: _u(
        _d(0, 0.66, 0.24), _s((-0.2, 0.2), (0.02, 0.2), (0.02, -0.8), w=0.34), _s((-0.35, -0.8), (0.4, -0.8))
    ),
    "advertising": lambda: _u(
        _b(-0.42, -0.75, 0.42, 0.5),
        _p((-0.58, 0.5), (0.58, 0.5), (0, 0.95)),
        _b(-0.58, -0.95, 0.58, -0.75),
        cut=(_b(-0.22, -0.4, 0.22, 0.25),),
    ),
    "bus_stop": lambda: _u(
        _b(-0.72, -0.62, 0.72, 0.85),
        _b(-0.6, -0.92, -0.28, -0.6),
        _b(0.28, -0.92, 0.6, -0.6),
        cut=(_b(-0.52, 0.05, 0.52, 0.62), _d(-0.42, -0.28, 0.14), _d(0.42, -0.28, 0.14)),
    ),
    "shelter": lambda: _u(
        _p((-0.98, 0.4), (-0.98, 0.62), (0, 0.95), (0.98, 0.62), (0.98, 0.4)),
        _s((-0.7, 0.4), (-0.7, -0.9), w=0.2),
        _s((0.7, 0.4), (0.7, -0.9), w=0.2),
        _s((-0.45, -0.35), (0.45, -0.35), w=0.22),
    ),
    "post_box": lambda: _u(_b(-0.92, -0.62, 0.92, 0.62), cut=(_s((-0.95, 0.6), (0, -0.12), (0.95, 0.6), w=0.17),)),
    "telephone": lambda: _u(_a(0, -0.4, 0.8, 25, 155, w=0.3), _b(-0.95, -0.4, -0.45, 0.05), _b(0.45, -0.4, 0.95, 0.05)),
    "vending_machine": lambda: _u(
        _b(-0.62, -0.95, 0.62, 0.95),
        cut=(_b(-0.42, -0.2, 0.16, 0.75), _b(0.3, 0.25, 0.46, 0.7), _b(-0.42, -0.72, 0.3, -0.45)),
    ),
    "parking_meter": lambda: _u(
        _d(0, 0.42, 0.52),
        _b(-0.14, -0.95, 0.14, 0.1),
        _s((-0.35, -0.9), (0.35, -0.9)),
        cut=(_b(-0.26, 0.38, 0.26, 0.66),),
    ),
    "charging_station": lambda: _p(
        (0.2, 0.98), (-0.6, -0.12), (-0.08, -0.12), (-0.2, -0.98), (0.6, 0.18), (0.08, 0.18)
    ),
    "traffic_signals": lambda: _u(
        _b(-0.42, -0.98, 0.42, 0.98), cut=(_d(0, 0.6, 0.23), _d(0, 0, 0.23), _d(0, -0.6, 0.23))
    ),
    "traffic_sign": lambda: _u(
        _p((0, 0.98), (-0.82, -0.38), (0.82, -0.38)),
        _b(-0.12, -0.98, 0.12, -0.3),
        cut=(_p((0, 0.5), (-0.4, -0.16), (0.4, -0.16)),),
    ),
    "flagpole": lambda: _u(
        _s((-0.5, -0.9), (-0.5, 0.85), w=0.2), _p((-0.5, 0.92), (0.8, 0.7), (0.5, 0.4), (0.8, 0.1), (-0.5, 0.1))
    ),
    "clock": lambda: _u(_a(0, 0, 0.8, 0, 360, w=0.22), _s((0, 0), (0, 0.5), w=0.2), _s((0, 0), (0.36, -0.18), w=0.2)),
    "planter": lambda: _u(
        _p((-0.62, -0.2), (0.62, -0.2), (0.42, -0.95), (-0.42, -0.95)),
        _d(0, 0.55, 0.3),
        _d(-0.46, 0.22, 0.27),
        _d(0.46, 0.22, 0.27),
        _s((0, 0.5), (0, -0.3), w=0.18),
    ),
    "swing": lambda: _u(
        _s((-0.9, -0.9), (-0.55, 0.8), (0.55, 0.8), (0.9, -0.9), w=0.2),
        _s((-0.24, 0.8), (-0.24, -0.3), w=0.12),
        _s((0.24, 0.8), (0.24, -0.3), w=0.12),
        _s((-0.38, -0.32), (0.38, -0.32), w=0.24),
    ),
    "slide": lambda: _u(
        _s((-0.8, -0.9), (-0.5, 0.8), w=0.18),
        _s((-0.3, -0.9), (-0.3, 0.5), w=0.18),
        _s((-0.72, -0.35), (-0.3, -0.35), w=0.15),
        _s((-0.6, 0.2), (-0.3, 0.2), w=0.15),
        _s((-0.5, 0.55), (-0.2, 0.5), (0.45, -0.65), (0.9, -0.78), w=0.26),
    ),
    "kiosk": lambda: _u(
        _p((-0.95, 0.3), (-0.7, 0.9), (0.7, 0.9), (0.95, 0.3)),
        _b(-0.7, -0.92, 0.7, 0.3),
        cut=(_b(-0.46, -0.35, 0.46, 0.12),),
    ),
    "cafe": lambda: _u(
        _p((-0.75, 0.28), (0.42, 0.28), (0.3, -0.45), (0.1, -0.6), (-0.43, -0.6), (-0.63, -0.45)),
        _a(0.42, 0.0, 0.27, -90, 90, w=0.17),
        _s((-0.8, -0.84), (0.5, -0.84), w=0.18),
        _s((-0.4, 0.5), (-0.4, 0.88), w=0.15),
        _s((0.06, 0.5), (0.06, 0.88), w=0.15),
    ),
    "restaurant": lambda: _u(
        _s((-0.45, -0.9), (-0.45, 0.9), w=0.2),
        _s((-0.78, 0.9), (-0.78, 0.4), (-0.45, 0.12), (-0.12, 0.4), (-0.12, 0.9), w=0.17),
        _s((0.5, -0.9), (0.5, 0.2), w=0.22),
        _p((0.39, -0.1), (0.39, 0.98), (0.62, 0.85), (0.82, 0.5), (0.82, -0.1)),
    ),
    "bar": lambda: _u(
        _p((-0.88, 0.82), (0.88, 0.82), (0, -0.15)),
        _s((0, 0), (0, -0.85), w=0.2),
        _s((-0.42, -0.86), (0.42, -0.86), w=0.2),
    ),
    "shop": lambda: _u(_p((-0.62, 0.3), (0.62, 0.3), (0.78, -0.92), (-0.78, -0.92)), _a(0, 0.3, 0.36, 0, 180, w=0.18)),
    "toilets": lambda: _u(_standing(-0.52, skirt=False), _standing(0.52, skirt=True), _b(-0.05, -0.95, 0.05, 0.95)),
    "pharmacy": lambda: _u(_b(-0.28, -0.85, 0.28, 0.85), _b(-0.85, -0.28, 0.85, 0.28)),
    "atm": lambda: _u(_b(-0.95, -0.55, 0.95, 0.55), cut=(_d(0, 0, 0.32), _d(-0.7, 0, 0.12), _d(0.7, 0, 0.12))),
    "hotel": lambda: _u(
        _s((-0.88, 0.6), (-0.88, -0.7), w=0.2),
        _b(-0.9, -0.45, 0.95, -0.1),
        _d(-0.5, 0.18, 0.22),
        _p((-0.2, -0.1), (-0.2, 0.38), (0.6, 0.38), (0.95, 0.1), (0.95, -0.1)),
        _s((0.86, -0.1), (0.86, -0.7), w=0.2),
    ),
    "museum": lambda: _u(
        _p((-0.98, 0.35), (0, 0.95), (0.98, 0.35)),
        _b(-0.95, -0.95, 0.95, -0.7),
        _b(-0.78, -0.7, -0.5, 0.35),
        _b(-0.14, -0.7, 0.14, 0.35),
        _b(0.5, -0.7, 0.78, 0.35),
    ),
    "library": lambda: _u(
        _p((-0.98, 0.6), (-0.5, 0.66), (-0.08, 0.42), (-0.08, -0.75), (-0.5, -0.5), (-0.98, -0.55)),
        _p((0.98, 0.6), (0.5, 0.66), (0.08, 0.42), (0.08, -0.75), (0.5, -0.5), (0.98, -0.55)),
    ),
    "church": lambda: _u(
        _s((0, 0.9), (0, 0.2), w=0.2),
        _s((-0.28, 0.66), (0.28, 0.66), w=0.2),
        _p((-0.66, -0.95), (-0.66, -0.2), (0, 0.32), (0.66, -0.2), (0.66, -0.95)),
        cut=(_b(-0.16, -0.98, 0.16, -0.45),),
    ),
    "playground": lambda: _u(
        _s((-0.9, 0.25), (0.9, -0.3), w=0.22),
        _p((-0.34, -0.88), (0.34, -0.88), (0, -0.02)),
        _d(-0.72, 0.66, 0.24),
        _d(0.72, 0.14, 0.24),
    ),
    "pitch": _football,
    "lawn": lambda: _u(
        _p((-0.5, -0.7), (-0.1, -0.7), (-0.75, 0.4)),
        _p((-0.2, -0.7), (0.2, -0.7), (0.02, 0.8)),
        _p((0.1, -0.7), (0.5, -0.7), (0.78, 0.4)),
        _s((-0.8, -0.75), (0.8, -0.75), w=0.2),
    ),
    "tree": lambda: _u(_d(0, 0.3, 0.55), _d(-0.35, 0.05, 0.4), _d(0.35, 0.05, 0.4), _b(-0.12, -0.95, 0.12, 0.0)),
    "shrub": lambda: _u(_d(0, 0.0, 0.5), _d(-0.45, -0.25, 0.38), _d(0.45, -0.25, 0.38), _b(-0.7, -0.62, 0.7, -0.3)),
    "car": lambda: _u(
        _p(
            (-0.95, -0.4),
            (-0.95, 0.05),
            (-0.6, 0.12),
            (-0.35, 0.55),
            (0.4, 0.55),
            (0.68, 0.12),
            (0.95, 0.02),
            (0.95, -0.4),
        ),
        _d(-0.52, -0.42, 0.24),
        _d(0.52, -0.42, 0.24),
        cut=(_p((-0.4, 0.12), (-0.24, 0.4), (0.3, 0.4), (0.46, 0.12)),),
    ),
    "person": lambda: _u(
        _d(0, 0.58, 0.34), _p((-0.55, -0.9), (-0.5, -0.1), (-0.2, 0.16), (0.2, 0.16), (0.5, -0.1), (0.55, -0.9))
    ),
}

#: What a thing belongs to, and how much it matters (3 a place, 2 a thing one looks for, 1 a thing by the way).
_FAMILIES: dict[str, tuple[str, int]] = {
    "bench": ("rest", 2), "picnic_table": ("rest", 2), "outdoor_seating": ("rest", 2), "shelter": ("rest", 2),
    "fountain": ("water", 3), "drinking_water": ("water", 2),
    "fire_hydrant": ("safety", 2),
    "waste_basket": ("tidy", 1), "recycling": ("tidy", 2),
    "street_lamp": ("street", 1), "bollard": ("street", 1), "flagpole": ("street", 1), "advertising": ("street", 1),
    "traffic_signals": ("street", 1), "traffic_sign": ("street", 1), "clock": ("street", 2),
    "bicycle_parking": ("wheels", 2), "bicycle_rental": ("wheels", 2), "bus_stop": ("wheels", 2),
    "parking_meter": ("wheels", 1), "charging_station": ("wheels", 1), "car": ("wheels", 1), "bicycle": ("wheels", 1),
    "artwork": ("culture", 2), "monument": ("culture", 3), "museum": ("culture", 3), "library": ("culture", 3),
    "church": ("culture", 3),
    "cafe": ("food", 3), "restaurant": ("food", 3), "bar": ("food", 3), "kiosk": ("food", 2),
    "information": ("service", 2), "post_box": ("service", 2), "telephone": ("service", 2),
    "vending_machine": ("service", 2), "toilets": ("service", 3), "pharmacy": ("service", 3), "atm": ("service", 2),
    "hotel": ("service", 3), "shop": ("service", 2),
    "playground": ("play", 3), "pitch": ("play", 2), "swing": ("play", 2), "slide": ("play", 2),
    "planter": ("green", 1), "lawn": ("green", 1), "tree": ("green", 1), "shrub": ("green", 1),
    "person": ("people", 1),
}  # fmt: skip

#: The order of the families in a legend.
FAMILY_ORDER: tuple[str, ...] = tuple(FAMILY_COLOURS)


@dataclass(frozen=True, slots=True, eq=False)
class Symbol:
    """How a class of objects is marked on a map.

    Attributes:
        glyph: Its pictogram in the square from -1 to 1.
        family: What it belongs to.
        colour: Its family's colour.
        rank: 3 for a place, 2 for a thing that one looks for, 1 for a thing by the way.
    """

    glyph: MarkPath
    family: str
    colour: str
    rank: int


@lru_cache(maxsize=256)
def symbol_of(class_name: str) -> Symbol:
    """Return how a class is marked; a class without a pictogram of its own gets a plain dot."""
    family, rank = _FAMILIES.get(class_name, ("street", 1))
    shape = _GLYPHS.get(class_name, lambda: _d(0, 0, 0.45))()
    return Symbol(path_of(shape), family, FAMILY_COLOURS[family], rank)


def compound_path(rings: list[NDArray[np.float64]]) -> MarkPath:
    """Return one path of closed rings, each of shape (n, 2), n ≥ 3, without its first point repeated."""
    vertices: list[NDArray[np.float64]] = []
    codes: list[NDArray[np.uint8]] = []
    for ring in rings:
        vertices.append(np.vstack([ring, ring[:1]]))
        code = np.full(len(ring) + 1, MarkPath.LINETO, dtype=np.uint8)
        code[0], code[-1] = MarkPath.MOVETO, MarkPath.CLOSEPOLY
        codes.append(code)
    if not vertices:
        return MarkPath(np.empty((0, 2)))
    return MarkPath(np.concatenate(vertices), np.concatenate(codes))


def path_of(shape: _Shape) -> MarkPath:
    """Return a path for a shapely polygon or a collection with polygons in it; holes run against their outlines."""
    rings: list[NDArray[np.float64]] = []
    for part in getattr(shape, "geoms", [shape]):
        if isinstance(part, Polygon) and not part.is_empty:
            rings.append(oriented(np.asarray(part.exterior.coords)[:-1, :2], anticlockwise=True))
            rings.extend(oriented(np.asarray(hole.coords)[:-1, :2], anticlockwise=False) for hole in part.interiors)
    return compound_path(rings)


def oriented(ring: NDArray[np.float64], *, anticlockwise: bool) -> NDArray[np.float64]:
    """Return the ring in the asked sense of turning; shape (n, 2)."""
    x, y = ring[:, 0] - ring[0, 0], ring[:, 1] - ring[0, 1]
    twice_area = float(x[:-1] @ y[1:] - y[:-1] @ x[1:])
    return ring if (twice_area >= 0.0) == anticlockwise else ring[::-1]
