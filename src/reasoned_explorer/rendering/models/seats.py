"""What one sits on and at: benches, picnic tables, tables under an umbrella."""

import math
from itertools import pairwise

import numpy as np

from reasoned_explorer.rendering.mesh_builder import FAR, MeshBuilder, Surface
from reasoned_explorer.rendering.models.maker import Maker
from reasoned_explorer.rendering.models.palette import (
    CONCRETE,
    DARK_WOOD,
    IRON,
    OAK,
    PAINT,
    PALE_WOOD,
    SIGN_WHITE,
    STEEL,
)

_GREEN_WOOD = Surface(OAK.material, (0.16, 0.36, 0.22))
_BENCH_LOOKS = ((OAK, IRON), (_GREEN_WOOD, IRON), (PALE_WOOD, CONCRETE), (DARK_WOOD, STEEL))


def _bench(builder: MeshBuilder, variant: int) -> None:
    """A bench with a back, of slats on two frames; one sits on it looking ahead."""
    slats, frame = _BENCH_LOOKS[variant]
    if builder.detail == FAR:
        builder.box(slats, (-0.9, -0.2, 0.38), (0.9, 0.3, 0.46))
        builder.sheet(slats, [(-0.9, -0.2, 0.42), (0.9, -0.2, 0.42), (0.9, -0.3, 0.85), (-0.9, -0.3, 0.85)])
        for x in (-0.72, 0.72):
            builder.sheet(frame, [(x, -0.25, 0), (x, 0.25, 0), (x, 0.25, 0.4), (x, -0.25, 0.4)])
        return
    fine = builder.detail <= 1
    for y in (-0.13, 0.0, 0.13, 0.26) if fine else ():
        builder.box(slats, (-0.9, y - 0.05, 0.43), (0.9, y + 0.05, 0.465), bevel=0.008)
    for z in (0.54, 0.67, 0.80) if fine else ():
        y = -0.19 - 0.22 * (z - 0.45)
        builder.beam(slats, (-0.9, y, z), (0.9, y, z), 0.035, 0.1, up=(0, -0.22, 1))
    if not fine:
        builder.box(slats, (-0.9, -0.18, 0.42), (0.9, 0.3, 0.465))
        builder.beam(slats, (-0.9, -0.23, 0.64), (0.9, -0.23, 0.64), 0.035, 0.42, up=(0, -0.22, 1))
    wide = 0.14 if frame is CONCRETE else 0.06
    for x in (-0.72, 0.72):
        builder.beam(frame, (x, 0.24, 0), (x, 0.24, 0.43), wide, 0.07, up=(0, 1, 0))
        builder.beam(frame, (x, -0.2, 0), (x, -0.2, 0.43), wide, 0.07, up=(0, 1, 0))
        builder.box(frame, (x - wide / 2, -0.24, 0.37), (x + wide / 2, 0.28, 0.43))
        if fine:
            builder.beam(frame, (x, -0.2, 0.4), (x, -0.3, 0.84), wide, 0.05, up=(0, 1, 0))
            _arm_rest(builder, frame, x)


def _arm_rest(builder: MeshBuilder, frame: Surface, x: float) -> None:
    builder.beam(frame, (x, -0.24, 0.64), (x, 0.27, 0.66), 0.055, 0.035)
    builder.beam(frame, (x, 0.25, 0.4), (x, 0.25, 0.66), 0.04, 0.04, up=(0, 1, 0))


def _picnic_table(builder: MeshBuilder, variant: int) -> None:
    """A table and two benches in one, of planks on two frames of crossed legs."""
    wood = (OAK, PALE_WOOD)[variant]
    if builder.detail == FAR:
        builder.box(wood, (-0.9, -0.37, 0.66), (0.9, 0.37, 0.75))
        for side in (-1, 1):
            y = 0.6 * side
            builder.sheet(
                wood, [(-0.9, y - 0.15, 0.44), (0.9, y - 0.15, 0.44), (0.9, y + 0.15, 0.44), (-0.9, y + 0.15, 0.44)]
            )
            x = 0.62 * side
            builder.sheet(wood, [(x, -0.7, 0), (x, 0.7, 0), (x, 0.25, 0.7)])
        return
    if builder.detail <= 1:
        for y in (-0.305, -0.155, -0.005, 0.145, 0.295):
            builder.box(wood, (-0.9, y - 0.068, 0.705), (0.9, y + 0.072, 0.75), bevel=0.008)
    else:
        builder.box(wood, (-0.9, -0.37, 0.705), (0.9, 0.37, 0.75))
    for side in (-1, 1):
        for y in (0.53, 0.68) if builder.detail <= 1 else ():
            builder.box(wood, (-0.9, side * y - 0.065, 0.42), (0.9, side * y + 0.065, 0.46), bevel=0.008)
        if builder.detail == 2:
            builder.box(wood, (-0.9, side * 0.605 - 0.145, 0.42), (0.9, side * 0.605 + 0.145, 0.46))
        x = 0.62 * side
        builder.beam(wood.shaded(0.85), (x, -0.66, 0.39), (x, 0.66, 0.39), 0.05, 0.1)
        builder.beam(wood.shaded(0.85), (x, -0.32, 0.67), (x, 0.32, 0.67), 0.05, 0.09)
        for turn in (-1, 1):
            builder.beam(wood.shaded(0.85), (x, turn * 0.62, 0.0), (x, turn * 0.22, 0.7), 0.05, 0.1, up=(0, 1, 0))


_CLOTH = ((0.82, 0.13, 0.12), (0.10, 0.42, 0.28), (0.13, 0.32, 0.62), (0.93, 0.68, 0.15))


_CHAIRS = (OAK, IRON, PALE_WOOD)


def _outdoor_seating(builder: MeshBuilder, variant: int) -> None:
    """A round table with four chairs under a parasol of striped cloth."""
    if builder.detail == FAR:
        rim = [(1.1 * math.cos(a), 1.1 * math.sin(a), 1.9) for a in np.radians([45, 135, 225, 315])]
        for index in range(4):
            surface = PAINT if index % 2 else SIGN_WHITE
            builder.sheet(surface, [rim[index], rim[(index + 1) % 4], (0, 0, 2.4)])
        builder.card(STEEL, (0, 0, 0), 0.08, 2.0, 0.6)
        builder.sheet(SIGN_WHITE, [(-0.4, -0.4, 0.75), (0.4, -0.4, 0.75), (0.4, 0.4, 0.75), (-0.4, 0.4, 0.75)])
        for x in (-0.75, 0.75):
            builder.card(_CHAIRS[variant % 3], (x, 0, 0), 0.6, 0.7, math.pi / 2 - x)
        return
    _parasol(builder)
    builder.cylinder(IRON, (0, 0, 0), (0, 0, 0.07), 0.28, 0.25, sides=12)
    builder.cylinder(STEEL, (0, 0, 0.05), (0, 0, 2.3), 0.028, sides=8)
    builder.cylinder(SIGN_WHITE if variant != 1 else PALE_WOOD, (0, 0, 0.71), (0, 0, 0.75), 0.45, sides=16)
    seat = _CHAIRS[variant % 3]
    chair = MeshBuilder(detail=builder.detail)
    _chair(chair, seat, IRON if seat is not IRON else STEEL)
    for turn in range(4):
        angle = math.radians(90 * turn + 20)
        builder.add(chair, (0.78 * math.sin(angle), 0.78 * math.cos(angle), 0), heading_rad=angle + math.pi)


def _parasol(builder: MeshBuilder) -> None:
    """The cloth: eight panels in two colours, domed, with a valance, seen from above and below."""
    panels = 8
    angles = (np.arange(panels + 1) + 0.5) * 2 * math.pi / panels
    circle = np.column_stack([np.cos(angles), np.sin(angles)])
    radius = 1.1 / math.cos(math.pi / panels)
    bands = ((0.0, 2.36), (0.55, 2.2), (1.0, 1.93)) if builder.detail == 0 else ((0.0, 2.36), (1.0, 1.93))
    for index in range(panels):
        surface = PAINT if index % 2 else SIGN_WHITE
        pair = circle[index : index + 2] * radius
        for (inner, top), (outer, low) in pairwise(bands):
            upper = [(x * inner, y * inner, top) for x, y in pair]
            lower = [(x * outer, y * outer, low) for x, y in pair]
            builder.sheet(surface, [*lower, *upper[::-1]] if inner else [*lower, upper[0]])
        if builder.detail <= 1:
            (x0, y0), (x1, y1) = pair
            builder.sheet(surface, [(x0, y0, 1.93), (x1, y1, 1.93), (x1, y1, 1.78), (x0, y0, 1.78)])
    builder.cylinder(STEEL, (0, 0, 2.34), (0, 0, 2.4), 0.05, 0.02, sides=6)


def _chair(builder: MeshBuilder, seat: Surface, frame: Surface) -> None:
    """A chair with its front ahead, about the origin."""
    builder.box(seat, (-0.2, -0.2, 0.43), (0.2, 0.2, 0.46))
    if builder.detail == 2:
        builder.sheet(seat, [(-0.2, -0.19, 0.44), (0.2, -0.19, 0.44), (0.2, -0.24, 0.86), (-0.2, -0.24, 0.86)])
        builder.sheet(frame, [(-0.18, 0.1, 0), (0.18, -0.1, 0), (0.18, -0.1, 0.44), (-0.18, 0.1, 0.44)])
        return
    for z in (0.60, 0.72, 0.84):
        builder.box(seat, (-0.2, -0.225, z - 0.04), (0.2, -0.2, z + 0.03))
    for x in (-0.18, 0.18):
        builder.beam(frame, (x, 0.18, 0), (x, 0.17, 0.44), 0.03, 0.03, up=(0, 1, 0))
        builder.beam(frame, (x, -0.2, 0), (x, -0.19, 0.87), 0.03, 0.03, up=(0, 1, 0))


MAKERS = {
    "bench": Maker(_bench, variants=4),
    "picnic_table": Maker(_picnic_table, variants=2),
    "outdoor_seating": Maker(_outdoor_seating, variants=3, tints=_CLOTH, scaling="uniform"),
}
