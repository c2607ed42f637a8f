"""Bicycles, the racks they stand in and the stations where they are hired."""

import math
from itertools import pairwise

import numpy as np

from reasoned_explorer.rendering.lettering import disc, facing_back, facing_front, line, rectangle, write
from reasoned_explorer.rendering.mesh_builder import FAR, Colour, MeshBuilder, Surface
from reasoned_explorer.rendering.models.maker import Maker
from reasoned_explorer.rendering.models.palette import (
    BLACK,
    CHROME,
    DARK_STEEL,
    PAINT,
    RUBBER,
    SIGN_BLUE,
    SIGN_WHITE,
    SIGN_YELLOW,
    STEEL,
    plain,
)

_WHEEL_M = 0.345
_REAR_Y, _FRONT_Y = -0.535, 0.535
#: With the spokes that are left out.
_FAR_TYRE = plain(0.27, 0.27, 0.28)
_SADDLE = plain(0.12, 0.10, 0.09)
_FRAME_COLOURS: tuple[Colour, ...] = (
    (0.78, 0.10, 0.10),
    (0.10, 0.28, 0.62),
    (0.12, 0.13, 0.14),
    (0.85, 0.86, 0.86),
    (0.12, 0.45, 0.30),
    (0.90, 0.52, 0.10),
    (0.30, 0.62, 0.74),
)


def add_bicycle(builder: MeshBuilder, frame: Surface, *, low_step: bool = False, basket: bool = False) -> None:
    """Add a bicycle about the origin, 1.76 m long, that heads for +y.

    Args:
        builder: Where to; its level of detail decides how fine.
        frame: Of the tubes.
        low_step: Whether the upper tube is low.
        basket: Whether there is a basket before the handlebar.
    """
    r = _WHEEL_M
    for y in (_REAR_Y, _FRONT_Y):
        _wheel(builder, y)
    crank, seat, head = (0, -0.1, 0.28), (0, -0.25, 0.82), (0, 0.36, 0.86)
    rear, front = (0, _REAR_Y, r), (0, _FRONT_Y, r)
    stem_top = (0, 0.3, 1.02)
    thick = 0.02 if builder.detail <= 1 else 0.028
    low_head = (0, 0.39, 0.72)
    tubes = [(crank, seat), (crank, low_head), (rear, crank), (rear, (0, -0.23, 0.74)), (head, front), (head, stem_top)]
    tubes.append(((0, -0.17, 0.5), low_head) if low_step else ((0, -0.235, 0.76), head))
    for start, end in tubes:
        builder.cylinder(frame, start, end, thick, sides=6 if builder.detail == 0 else 9, capped=False)
    builder.beam(_SADDLE, (0, -0.39, 0.87), (0, -0.12, 0.885), 0.13, 0.055)
    builder.beam(CHROME, (-0.25, 0.24, 1.08), (0.25, 0.24, 1.08), 0.025, 0.025)
    builder.cylinder(CHROME, (0, 0.3, 1.0), (0, 0.24, 1.09), 0.015, sides=9, capped=False)
    if builder.detail <= 1:
        builder.cylinder(DARK_STEEL, (0.02, -0.1, 0.28), (0.045, -0.1, 0.28), 0.1, sides=12)
        for side in (-1, 1):
            builder.beam(RUBBER, (side * 0.25, 0.16, 1.085), (side * 0.25, 0.26, 1.08), 0.03, 0.03)
            builder.beam(
                BLACK, (side * 0.03, -0.1 + side * 0.14, 0.28), (side * 0.14, -0.1 + side * 0.14, 0.28), 0.09, 0.025
            )
            builder.beam(DARK_STEEL, (side * 0.05, -0.1, 0.28), (side * 0.05, -0.1 + side * 0.14, 0.28), 0.025, 0.025)
    if builder.detail == 0:
        for y, low, high in ((_REAR_Y, 1.2, 3.6), (_FRONT_Y, 0.5, 2.2)):
            angles = np.linspace(low, high, 7)
            guard = np.column_stack([0 * angles, y + 0.385 * np.cos(angles), r + 0.385 * np.sin(angles)])
            for first, last in pairwise(guard):
                wide = np.array([0.028, 0, 0])
                builder.sheet(frame, [first - wide, first + wide, last + wide, last - wide])
        builder.box(SIGN_YELLOW, (-0.03, 0.42, 0.86), (0.03, 0.48, 0.93))
        builder.box(plain(0.75, 0.05, 0.05), (-0.03, -0.9, 0.62), (0.03, -0.86, 0.67))
        builder.beam(DARK_STEEL, (0, -0.88, 0.7), (0, -0.3, 0.72), 0.12, 0.02)
        builder.beam(DARK_STEEL, (0.05, -0.87, 0.7), (0.03, _REAR_Y, r), 0.015, 0.015, up=(1, 0, 0))
    if basket:
        builder.box(plain(0.30, 0.31, 0.32), (-0.17, 0.36, 0.9), (0.17, 0.62, 1.1))


def _wheel(builder: MeshBuilder, y: float) -> None:
    r = _WHEEL_M
    around, thick = ((22, 0.022), (22, 0.026), (20, 0.034))[builder.detail]
    builder.torus(
        RUBBER if builder.detail < 2 else _FAR_TYRE,
        (0, y, r),
        r - thick,
        thick,
        (1, 0, 0),
        around=around,
        sides=5 if builder.detail == 0 else 3,
    )
    if builder.detail <= 1:
        builder.cylinder(CHROME, (-0.04, y, r), (0.04, y, r), 0.03, sides=6)
        for turn in range(7 if builder.detail == 0 else 4):
            angle = math.pi * (turn + 0.5) / (7 if builder.detail == 0 else 4)
            ends = np.array(
                [[y + k * (r - 0.03) * math.cos(angle), r + k * (r - 0.03) * math.sin(angle)] for k in (-1, 1)]
            )
            side = 0.005 * np.array([-math.sin(angle), math.cos(angle)])
            corners = [ends[0] - side, ends[1] - side, ends[1] + side, ends[0] + side]
            builder.sheet(STEEL, [(0.0, *corner) for corner in corners])


def _far_bicycle(builder: MeshBuilder, frame: Surface, x: float = 0.0, *, size: float = 1.0) -> None:
    """A bicycle for afar: twelve triangles or so, seen from both sides."""
    r = _WHEEL_M
    grey = plain(0.36, 0.36, 0.37)
    for y in (_REAR_Y, _FRONT_Y):
        corners = [(y, 0.0), (y + r, r), (y, 2 * r), (y - r, r)]
        builder.sheet(grey, [(x, v * size, w * size) for v, w in corners])
    builder.sheet(frame, [(x, v * size, w * size) for v, w in [(-0.5, 0.32), (0.05, 0.4), (0.38, 0.9), (-0.25, 0.78)]])


def _bicycle(builder: MeshBuilder, variant: int) -> None:
    """A bicycle on its stand; one has a low step, one a basket."""
    if builder.detail == FAR:
        _far_bicycle(builder, PAINT)
        handle = [(-0.25, 0.2, 1.04), (0.25, 0.2, 1.04), (0.25, 0.28, 1.1), (-0.25, 0.28, 1.1)]
        builder.sheet(DARK_STEEL, handle)
        builder.sheet(DARK_STEEL, [(0, 0.24, 0.9), (0, 0.34, 0.9), (0, 0.28, 1.08)])
        return
    add_bicycle(builder, PAINT, low_step=variant == 1, basket=variant == 2)
    if builder.detail == 0:
        builder.beam(DARK_STEEL, (0.02, -0.22, 0.3), (0.16, -0.3, 0.0), 0.02, 0.02)


def _bicycle_parking(builder: MeshBuilder, variant: int) -> None:
    """A row of hoops, with bicycles in them."""
    frames = (plain(0.75, 0.12, 0.10), plain(0.12, 0.30, 0.62), plain(0.14, 0.42, 0.28), plain(0.2, 0.2, 0.22))
    places = ((-0.78, 0.18, 0.88), (-0.95, -0.3), (-0.55, 0.05, 0.62, 1.15))[variant]
    scale = 0.9 / 1.1
    if builder.detail == FAR:
        for x in (-1.45, 1.45):
            builder.sheet(STEEL, [(x, -0.4, 0), (x, 0.4, 0), (x, 0.3, 0.8), (x, -0.3, 0.8)])
        for place, x in enumerate((places[0], places[-1])):
            grey = plain(0.35, 0.35, 0.36)
            y = 0.9
            builder.sheet(grey, [(x, -y, 0.3), (x, -0.4, 0), (x, 0.4, 0), (x, y, 0.3)])
            builder.sheet(frames[place], [(x, -0.7, 0.4), (x, 0.7, 0.4), (x, 0.3, 0.9), (x, -0.3, 0.75)])
        return
    hoops = np.linspace(-1.45, 1.45, 5)
    for x in hoops:
        _hoop(builder, x)
    if builder.detail == 0:
        for y in (-0.34, 0.34):
            builder.box(DARK_STEEL, (-1.5, y - 0.03, 0), (1.5, y + 0.03, 0.03))
    for place, x in enumerate(places):
        bicycle = MeshBuilder(detail=min(2, builder.detail + (len(places) > 2)))
        if builder.detail < 2:
            add_bicycle(bicycle, frames[place], low_step=place % 2 == 1, basket=place == 2)
        else:
            _far_bicycle(bicycle, frames[place])
        builder.add(bicycle, (x, 0.12 * (-1) ** place, 0), heading_rad=math.pi * (place % 2), scale=scale)


def _hoop(builder: MeshBuilder, x: float) -> None:
    """A tube bent to an upside-down U, across the row."""
    steps = (5, 3, 2)[builder.detail]
    corner = [(0.38 - 0.14 * (1 - math.sin(a)), 0.68 + 0.14 * math.cos(a)) for a in np.linspace(math.pi / 2, 0, steps)]
    half = [(0.38, 0.0), *corner]
    points = [(x, y, z) for y, z in half] + [(x, -y, z) for y, z in reversed(half)]
    builder.tube(STEEL, points, 0.026, sides=6 if builder.detail == 0 else 5)


def _bicycle_rental(builder: MeshBuilder, variant: int) -> None:
    """A station: a row of docks with bicycles of one colour, and a terminal with the mark of a bicycle."""
    livery = (plain(0.86, 0.10, 0.12), plain(0.10, 0.55, 0.75))[variant]
    docks = np.linspace(-2.9, 3.7, 7)
    if builder.detail == FAR:
        builder.sheet(livery, [(-3.85, 0.0, 0), (-3.25, 0.0, 0), (-3.25, 0.0, 1.4), (-3.85, 0.0, 1.4)])
        builder.decal(DARK_STEEL, [(-4.0, -1.0, 0.05), (4.0, -1.0, 0.05), (4.0, 1.0, 0.05), (-4.0, 1.0, 0.05)])
        builder.sheet(livery.shaded(0.6), [(-3, -0.84, 0.0), (3.8, -0.84, 0.0), (3.8, -0.84, 0.35), (-3, -0.84, 0.35)])
        for x in docks[[0, 1, 3]]:
            builder.sheet(livery.shaded(0.7), [(x, -0.75, 0.1), (x, 0.85, 0.1), (x, 0.5, 0.8), (x, -0.6, 0.7)])
        return
    builder.box(DARK_STEEL, (-4.0, -1.0, 0), (4.0, -0.55, 0.05))
    builder.box(DARK_STEEL, (-4.0, -0.55, 0), (-3.2, 1.0, 0.05))
    bicycle = MeshBuilder(detail=min(2, builder.detail + 1))
    if builder.detail < 2:
        add_bicycle(bicycle, livery, low_step=True, basket=True)
    else:
        _far_bicycle(bicycle, livery)
    for place, x in enumerate(docks.tolist()):
        builder.box(
            livery if builder.detail < 2 else DARK_STEEL, (x - 0.09, -0.95, 0.03), (x + 0.09, -0.72, 0.8), bevel=0.03
        )
        if place not in (2, 4, 5):
            builder.add(bicycle, (x, 0.05, 0), heading_rad=math.pi)
    _terminal(builder, -3.55, livery)


def _terminal(builder: MeshBuilder, x: float, livery: Surface) -> None:
    builder.box(DARK_STEEL, (x - 0.3, -0.16, 0.03), (x + 0.3, 0.16, 0.1))
    builder.box(livery, (x - 0.28, -0.13, 0.1), (x + 0.28, 0.13, 1.4), bevel=0.03)
    for plane in (facing_front(0.14, x=x), facing_back(-0.14, x=x)):
        builder.decal(SIGN_WHITE, plane.points(rectangle(0, 1.14, 0.46, 0.36)))
        near = type(plane)((x, plane.origin[1] * 1.1, 0.0), plane.right)
        if builder.detail <= 1:
            for wheel in (-0.11, 0.11):
                rim = disc(wheel, 1.09, 0.075, sides=10)
                for bar in line([tuple(p) for p in [*rim, rim[0]]], 0.018):
                    builder.decal(SIGN_BLUE, near.points(bar))
            for bar in line([(-0.11, 1.09), (-0.04, 1.2), (0.08, 1.2), (0.0, 1.09), (-0.04, 1.2)], 0.018):
                builder.decal(SIGN_BLUE, near.points(bar))
            for bar in line([(0.11, 1.09), (0.07, 1.25), (0.11, 1.26)], 0.018):
                builder.decal(SIGN_BLUE, near.points(bar))
            builder.decal(plain(0.62, 0.78, 0.80), plane.points(rectangle(0, 0.78, 0.3, 0.22)))
        write(builder, SIGN_WHITE, "BIKE", plane, centre=(0, 0.45), height_m=0.14)


MAKERS = {
    "bicycle": Maker(_bicycle, variants=3, tints=_FRAME_COLOURS),
    "bicycle_parking": Maker(_bicycle_parking, variants=3),
    "bicycle_rental": Maker(_bicycle_rental, variants=2),
}
