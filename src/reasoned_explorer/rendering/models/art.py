"""Sculptures and monuments."""

import math

import numpy as np

from reasoned_explorer.rendering.lettering import Plane, facing_back, facing_front, rectangle
from reasoned_explorer.rendering.mesh_builder import FAR, MeshBuilder, Surface
from reasoned_explorer.rendering.models.maker import Maker
from reasoned_explorer.rendering.models.palette import BRASS, BRONZE, GRANITE, IRON, LIMESTONE, STEEL, plain

_RUST = Surface(IRON.material, (0.48, 0.25, 0.14))
_RED = plain(0.80, 0.10, 0.08)


def _artwork(builder: MeshBuilder, variant: int) -> None:
    (_loops, _pierced_stone, _discs)[variant](builder)


def _plinth(builder: MeshBuilder, surface: Surface, half: float, height: float) -> None:
    builder.box(surface, (-half, -half, 0), (half, half, height), bevel=0.03)


def _loops(builder: MeshBuilder) -> None:
    """A band of steel, painted red, that winds in a knot over a plinth."""
    if builder.detail == FAR:
        _plinth(builder, GRANITE, 0.45, 0.5)
        builder.sheet(_RED, [(0, -0.75, 1.5), (0, 0, 0.5), (0, 0.75, 1.5), (0, 0, 2.5)])
        builder.sheet(_RED, [(-0.75, 0, 1.5), (0, 0, 0.5), (0.75, 0, 1.5), (0, 0, 2.5)])
        return
    _plinth(builder, GRANITE, 0.45, 0.5)
    steps = (44, 24, 14)[builder.detail]
    t = np.arange(steps) * 2 * math.pi / steps
    # A trefoil knot, upright.
    x = 0.235 * (np.sin(t) + 2 * np.sin(2 * t))
    z = 1.52 + 0.3 * (np.cos(t) - 2 * np.cos(2 * t))
    y = 0.58 * -np.sin(3 * t)
    builder.tube(_RED, np.column_stack([x, y, z]), 0.13, sides=8, closed=True)


def _pierced_stone(builder: MeshBuilder) -> None:
    """A rounded stone with a hole, as a lying figure is seen by modern sculptors, on a low plinth."""
    if builder.detail == FAR:
        _plinth(builder, GRANITE, 0.75, 0.3)
        builder.cylinder(LIMESTONE, (0, 0, 0.3), (0, 0, 2.5), 0.6, 0.3, sides=13, capped=False)
        return
    _plinth(builder, GRANITE, 0.75, 0.3)
    steps = (26, 14, 9)[builder.detail]
    t = np.arange(steps) * 2 * math.pi / steps
    thick = 0.26 + 0.12 * np.cos(t + 2.2)
    path = np.column_stack([0.42 * np.sin(t), 0.06 * np.sin(2 * t), 1.22 - 0.72 * np.cos(t)])
    builder.tube(LIMESTONE, path, thick, sides=12, closed=True)
    builder.sphere(LIMESTONE, (0.16, 0.0, 2.2), (0.22, 0.2, 0.25), sides=12, rings=8)


def _discs(builder: MeshBuilder) -> None:
    """Plates of rusty and of bright steel, fitted into each other."""
    if builder.detail == FAR:
        builder.sheet(_RUST, [(-0.5, 0, 0), (0.75, 0, 0), (0.5, 0, 2.1), (-0.75, 0, 2.5)])
        builder.sheet(STEEL, [(0, -0.75, 0), (0, 0.75, 0), (0.2, 0.5, 1.9), (0.1, -0.4, 2.2)])
        return
    builder.cylinder(GRANITE, (0, 0, 0), (0, 0, 0.12), 0.75, 0.72, sides=20)
    builder.extrude(
        _RUST, [(-0.5, 0.1), (0.45, 0.1), (0.7, 1.2), (0.35, 2.0), (-0.3, 2.5), (-0.7, 1.3)], "y", -0.05, 0.05
    )
    builder.extrude(STEEL, [(-0.6, 0.1), (0.6, 0.1), (0.72, 0.9), (0.2, 1.9), (-0.35, 1.4)], "x", -0.04, 0.04)
    builder.torus(BRASS, (0.1, 0.0, 1.6), 0.42, 0.06, (0.5, 1, 0.2), around=24, sides=8)
    if builder.detail <= 1:
        builder.sphere(STEEL, (-0.3, 0.3, 1.1), 0.17, sides=12, rings=8)
        builder.beam(STEEL, (-0.3, 0.3, 1.1), (-0.15, 0.0, 1.0), 0.04, 0.04)


def _monument(builder: MeshBuilder, variant: int) -> None:
    (_rider, _obelisk, _column)[variant](builder)


def _steps(builder: MeshBuilder, stone: Surface) -> None:
    for half, low, high in ((1.5, 0.0, 0.2), (1.25, 0.2, 0.4), (1.0, 0.4, 0.6)):
        builder.box(stone, (-half, -half, low), (half, half, high))


def _pedestal(builder: MeshBuilder, stone: Surface, top: float) -> None:
    _steps(builder, stone)
    builder.box(stone, (-0.8, -0.8, 0.6), (0.8, 0.8, 0.85), bevel=0.04)
    builder.box(stone, (-0.66, -0.66, 0.85), (0.66, 0.66, top - 0.2))
    builder.box(stone, (-0.8, -0.8, top - 0.2), (0.8, 0.8, top), bevel=0.05)
    middle = (0.85 + top - 0.2) / 2
    for plane in (facing_front(0.67), facing_back(-0.67)):
        builder.decal(BRONZE, plane.points(rectangle(0, middle, 0.9, 0.6)))
        if builder.detail <= 1:
            near = Plane((0.0, plane.origin[1] * 1.015, 0.0), plane.right)
            for row in range(4):
                builder.decal(
                    BRASS, near.points(rectangle(0, middle + 0.19 - 0.12 * row, (0.7, 0.6, 0.66, 0.4)[row], 0.04))
                )


def _rider(builder: MeshBuilder) -> None:
    """Somebody of bronze who stands on a high pedestal and points ahead."""
    stone, metal = GRANITE, Surface(BRONZE.material, (0.30, 0.42, 0.36))
    if builder.detail == FAR:
        builder.cylinder(stone, (0, 0, 0), (0, 0, 0.7), 2.12, 1.1, sides=13, capped=False)
        builder.cylinder(stone, (0, 0, 0.4), (0, 0, 3.2), 1.0, 0.9, sides=13, capped=False)
        builder.cylinder(metal, (0, 0, 3.2), (0, 0, 6.0), 0.5, 0.2, sides=10, capped=False)
        return
    _pedestal(builder, stone, 3.2)
    k, foot = 1.6, 3.2
    figure = MeshBuilder(detail=builder.detail)
    for side in (-1, 1):
        figure.tube(
            metal,
            [(side * 0.1, 0.05 * side, 0), (side * 0.1, 0.04 * side, 0.45), (side * 0.07, 0, 0.9)],
            [0.08, 0.08, 0.11],
            sides=8,
        )
        figure.box(metal, (side * 0.1 - 0.06, -0.1 + 0.05 * side, 0), (side * 0.1 + 0.06, 0.16 + 0.05 * side, 0.09))
    coat = [(0.26, 0.55), (0.2, 0.95), (0.19, 1.1), (0.24, 1.35), (0.2, 1.45), (0.07, 1.52)]
    figure.lathe(metal, coat, sides=14, stretch=(1.0, 0.7))
    figure.sphere(metal, (0, 0.02, 1.63), (0.09, 0.105, 0.13), sides=12, rings=8)
    figure.tube(metal, [(0.2, 0, 1.42), (0.3, 0.2, 1.25), (0.26, 0.55, 1.42)], [0.075, 0.06, 0.045], sides=7)
    figure.tube(metal, [(-0.2, 0, 1.42), (-0.3, -0.05, 1.12), (-0.12, 0.12, 1.02)], [0.075, 0.06, 0.05], sides=7)
    builder.add(figure, (0, 0, foot), scale=k)


def _obelisk(builder: MeshBuilder) -> None:
    """A tall four-sided stone that tapers to a point."""
    if builder.detail == FAR:
        builder.box(GRANITE, (-1.5, -1.5, 0), (1.5, 1.5, 0.5))
        builder.cylinder(GRANITE, (0, 0, 0.5), (0, 0, 6.0), 0.75, 0.2, sides=13, capped=False)
        return
    _steps(builder, GRANITE)
    builder.box(GRANITE, (-0.75, -0.75, 0.6), (0.75, 0.75, 1.6), bevel=0.05)
    shaft = [[(x * h, y * h, z) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))] for h, z in _SHAFT]
    builder.loft(LIMESTONE, shaft, smooth=False)
    for plane in (facing_front(0.76), facing_back(-0.76)):
        builder.decal(BRONZE, plane.points(rectangle(0, 1.1, 0.9, 0.6)))
    if builder.detail == 0:
        for x in (-1.3, 1.3):
            for y in (-1.3, 1.3):
                builder.cylinder(IRON, (x, y, 0.2), (x, y, 0.75), 0.06, sides=8)
                builder.sphere(IRON, (x, y, 0.78), 0.09, sides=8, rings=6)


_SHAFT = ((0.52, 1.6), (0.36, 5.4), (0.0, 6.0))


def _column(builder: MeshBuilder) -> None:
    """A column with a golden figure with wings on its top."""
    if builder.detail == FAR:
        builder.box(LIMESTONE, (-1.5, -1.5, 0), (1.5, 1.5, 0.5))
        builder.cylinder(LIMESTONE, (0, 0, 0.5), (0, 0, 4.7), 0.6, 0.4, sides=10, capped=False)
        builder.sheet(BRASS, [(-0.6, 0, 5.5), (0, 0, 4.6), (0.6, 0, 5.5), (0, 0, 6.0)])
        return
    _steps(builder, LIMESTONE)
    builder.box(LIMESTONE, (-0.7, -0.7, 0.6), (0.7, 0.7, 1.3), bevel=0.05)
    builder.lathe(LIMESTONE, [(0.5, 1.3), (0.5, 1.42), (0.36, 1.5), (0.3, 4.2), (0.42, 4.35)], sides=16)
    builder.box(LIMESTONE, (-0.45, -0.45, 4.33), (0.45, 0.45, 4.5))
    builder.lathe(BRASS, [(0.2, 4.5), (0.22, 4.6), (0.12, 5.1), (0.15, 5.35), (0.05, 5.5)], sides=12)
    builder.sphere(BRASS, (0, 0.02, 5.6), 0.1, sides=10, rings=6)
    for side in (-1, 1):
        wing = [
            (side * 0.05, -0.08, 5.1),
            (side * 0.55, -0.2, 5.5),
            (side * 0.6, -0.25, 5.95),
            (side * 0.08, -0.08, 5.45),
        ]
        builder.sheet(BRASS, wing)
        builder.tube(BRASS, [(side * 0.12, 0, 5.35), (side * 0.2, 0.25, 5.5), (side * 0.1, 0.35, 5.8)], 0.04, sides=5)
    builder.torus(BRASS, (0, 0.36, 5.86), 0.12, 0.025, (0, 1, 0.3), around=14, sides=5)


MAKERS = {
    "artwork": Maker(_artwork, variants=3),
    "monument": Maker(_monument, variants=3),
}
