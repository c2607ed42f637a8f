"""Playgrounds and pitches, and what stands on them by itself: swings, slides."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise

import numpy as np

from reasoned_explorer.rendering.lettering import Plane, disc, line, rectangle
from reasoned_explorer.rendering.material import Material
from reasoned_explorer.rendering.mesh import Model
from reasoned_explorer.rendering.mesh_builder import FAR, MeshBuilder, Surface
from reasoned_explorer.rendering.models.maker import Maker
from reasoned_explorer.rendering.models.palette import (
    DARK_STEEL,
    PALE_WOOD,
    RUBBER,
    SIGN_BLUE,
    SIGN_RED,
    SIGN_WHITE,
    SIGN_YELLOW,
    STEEL,
    plain,
)
from reasoned_explorer.rendering.shelf import kept_model

_SAND = Surface(Material.SAND, (0.86, 0.76, 0.55))
_TOY_GREEN = plain(0.20, 0.62, 0.25)
_MAT = plain(0.30, 0.24, 0.22)
_LINE = Surface(Material.PLAIN, (0.93, 0.93, 0.91))
#: Lines lie this high above the ground, metres.
_LINE_Z_M = 0.015
_GROUND = Plane((0.0, 0.0, _LINE_Z_M), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))


def _swing(builder: MeshBuilder, variant: int) -> None:
    """Two seats on chains under a bar between two pairs of legs."""
    frame = (SIGN_RED, PALE_WOOD)[variant]
    thick = (0.045, 0.065)[variant]
    if builder.detail == FAR:
        for x in (-1.45, 1.45):
            builder.sheet(frame, [(x, -0.75, 0), (x, -0.62, 0), (x, 0, 2.2), (x, 0.62, 0), (x, 0.75, 0), (x, 0, 2.3)])
        builder.sheet(frame, [(-1.5, 0, 2.2), (1.5, 0, 2.2), (1.5, 0, 2.3), (-1.5, 0, 2.3)])
        for x in (-0.7, 0.7):
            builder.sheet(STEEL, [(x - 0.22, 0, 0.48), (x + 0.22, 0, 0.48), (x, 0, 2.22)])
        return
    for x in (-1.42, 1.42):
        for y in (-0.7, 0.7):
            builder.cylinder(frame, (x, y, 0), (x, 0.03 * y, 2.25), thick, sides=10)
        builder.beam(frame, (x, -0.36, 1.1), (x, 0.36, 1.1), 0.05, 0.05)
    builder.cylinder(frame, (-1.5, 0, 2.25), (1.5, 0, 2.25), thick, sides=10)
    for place, x in enumerate((-0.7, 0.7)):
        out = 0.12 if place else -0.05
        seat = SIGN_BLUE if place else SIGN_YELLOW
        builder.box(seat, (x - 0.24, out - 0.11, 0.48), (x + 0.24, out + 0.11, 0.53), bevel=0.012)
        for side in (-0.21, 0.21):
            builder.cylinder(STEEL, (x + side, out, 0.5), (x + side, 0, 2.22), 0.014, sides=5, capped=False)
        if builder.detail <= 2:
            builder.decal(_MAT, _GROUND.points(rectangle(x, 0, 0.9, 1.4)))


def _slide(builder: MeshBuilder, variant: int) -> None:
    """A ladder, a platform with rails and a chute that ends level; it goes down to +x."""
    chute, frame = ((SIGN_YELLOW, SIGN_RED), (STEEL, SIGN_BLUE))[variant]
    path = [(-0.75, 1.45), (0.9, 0.42), (1.35, 0.27), (1.75, 0.25)]
    if builder.detail == 2:
        path = [path[0], path[1], path[3]]
    if builder.detail == FAR:
        for (x0, z0), (x1, z1) in ((path[0], path[1]), (path[1], path[-1])):
            builder.sheet(chute, [(x0, -0.3, z0), (x1, -0.3, z1), (x1, 0.3, z1), (x0, 0.3, z0)])
        builder.sheet(frame, [(-1.75, -0.4, 0), (-1.75, 0.4, 0), (-1.3, 0.4, 2.2), (-1.3, -0.4, 2.2)])
        builder.card(frame, (-0.75, 0, 0), 0.7, 1.45, math.pi / 2)
        builder.sheet(frame, [(-1.45, 0.4, 1.4), (-0.75, 0.4, 1.4), (-0.75, 0.4, 1.9), (-1.4, 0.4, 1.9)])
        return
    for side in (-1, 1):
        y = 0.32 * side
        for (x0, z0), (x1, z1) in pairwise(path):
            builder.beam(chute.shaded(0.9), (x0, y, z0 + 0.08), (x1, y, z1 + 0.08), 0.05, 0.2)
        builder.beam(frame, (-1.72, y, 0), (-1.38, y, 1.48), 0.06, 0.06)
        builder.beam(frame, (-1.38, y, 1.4), (-1.38, y, 2.15), 0.06, 0.06, up=(1, 0, 0))
        builder.beam(frame, (-0.78, y, 0), (-0.78, y, 2.15), 0.06, 0.06, up=(1, 0, 0))
        builder.beam(frame, (-1.42, y * 1.1, 2.16), (-0.74, y * 1.1, 2.16), 0.08, 0.08)
        if builder.detail == 0:
            builder.beam(frame, (-1.38, y, 1.8), (-0.78, y, 1.8), 0.04, 0.04)
            builder.beam(frame, (1.2, y, 0), (1.2, y, 0.3), 0.05, 0.03, up=(0, 1, 0))
    for (x0, z0), (x1, z1) in pairwise(path):
        builder.beam(chute, (x0, 0, z0), (x1, 0, z1), 0.62, 0.04)
    builder.box(PALE_WOOD, (-1.42, -0.34, 1.41), (-0.72, 0.34, 1.47))
    rungs = (5, 4, 1)[builder.detail]
    for rung in range(rungs):
        share = (rung + 1) / (rungs + 0.6)
        x, z = -1.72 + 0.34 * share, 1.48 * share
        builder.beam(STEEL, (x, -0.32, z), (x, 0.32, z), 0.05, 0.04)
    builder.box(frame, (-0.81, -0.4, 0), (-0.75, 0.4, 0.05))


def _playground(builder: MeshBuilder, variant: int) -> None:
    """A frame to climb on, a sandpit, a seesaw, rocking animals."""
    if builder.detail == FAR:
        builder.decal(_SAND, Plane((0, 0, 0.06), (1, 0, 0), (0, 1, 0)).points(rectangle(-4.9, -3.8, 4.6, 3.6)))
        for x in (3.6, 6.4):
            builder.card(SIGN_RED, (x, 3.6, 0), 0.7, 2.3, math.pi / 2)
        for y in (2.5, 4.7):
            builder.card(SIGN_BLUE, (5, y, 0), 1.2, 2.3)
        builder.sheet(SIGN_YELLOW, [(-6.5, 4.3, 0.0), (-3.4, 4.3, 0.75), (-5.0, 4.3, 0.0)])
        return
    _sandpit(builder)
    _climbing_frame(builder, variant)
    _seesaw(builder)
    for x, y, surface in ((4.2, -3.6, _TOY_GREEN), (5.9, -4.4, SIGN_BLUE)):
        _rocker(builder, x, y, surface)


def _sandpit(builder: MeshBuilder) -> None:
    low, high = (-7.3, -5.7), (-2.5, -1.9)
    builder.decal(
        _SAND, [(low[0], low[1], 0.06), (high[0], low[1], 0.06), (high[0], high[1], 0.06), (low[0], high[1], 0.06)]
    )
    for y in (low[1], high[1]):
        builder.beam(PALE_WOOD, (low[0] - 0.1, y, 0.14), (high[0] + 0.1, y, 0.14), 0.24, 0.28)
    for x in (low[0], high[0]):
        builder.beam(PALE_WOOD, (x, low[1], 0.13), (x, high[1], 0.13), 0.24, 0.26)
    if builder.detail <= 1:
        builder.cylinder(SIGN_RED, (-4.6, -3.6, 0.05), (-4.6, -3.6, 0.25), 0.1, 0.14, sides=10)
        builder.lathe(_SAND.shaded(0.95), [(0.7, 0.05), (0.45, 0.2), (0.0, 0.32)], (-5.7, -3.4, 0), sides=9)


def _climbing_frame(builder: MeshBuilder, variant: int) -> None:
    """A lattice of bright bars, or a tower with a roof, a net of ropes and a chute."""
    if variant == 1:
        _tower(builder)
        return
    xs: tuple[float, ...] = (3.6, 5.0, 6.4)
    ys: tuple[float, ...] = (2.5, 3.6, 4.7)
    zs: tuple[float, ...] = (0.8, 1.6, 2.3)
    if builder.detail == 2:
        xs, zs = (3.6, 6.4), (1.2, 2.3)
    sides = 8 if builder.detail == 0 else 5
    for x in xs:
        for y in ys:
            builder.cylinder(SIGN_RED, (x, y, 0), (x, y, zs[-1]), 0.04, sides=sides)
    for z in zs:
        for y in ys:
            builder.cylinder(SIGN_BLUE, (xs[0], y, z), (xs[-1], y, z), 0.035, sides=sides)
        for x in xs:
            builder.cylinder(SIGN_YELLOW, (x, ys[0], z - 0.05), (x, ys[-1], z - 0.05), 0.035, sides=sides)


def _tower(builder: MeshBuilder) -> None:
    wood = PALE_WOOD
    for x in (4.3, 5.7):
        for y in (2.9, 4.3):
            builder.box(wood, (x - 0.07, y - 0.07, 0), (x + 0.07, y + 0.07, 2.6))
    builder.box(wood, (4.2, 2.8, 1.2), (5.8, 4.4, 1.3))
    roof = [[(4.1, 2.7, 2.5), (5.9, 2.7, 2.5), (5.9, 4.5, 2.5), (4.1, 4.5, 2.5)], [(5.0, 3.6, 3.3)] * 4]
    builder.loft(SIGN_RED, roof, smooth=False)
    for x in (4.25, 5.75):
        builder.box(SIGN_YELLOW, (x - 0.03, 2.9, 1.3), (x + 0.03, 4.3, 1.9))
    builder.beam(SIGN_BLUE, (5.0, 2.8, 1.28), (5.0, 0.6, 0.2), 0.6, 0.06)
    for side in (-0.32, 0.32):
        builder.beam(SIGN_BLUE, (5.0 + side, 2.8, 1.38), (5.0 + side, 0.6, 0.3), 0.05, 0.22)
    builder.box(SIGN_BLUE, (4.7, 0.5, 0), (5.3, 0.7, 0.22))
    if builder.detail <= 1:
        for rung in range(5):
            builder.beam(
                STEEL,
                (4.4, 4.55 + 0.08 * (4 - rung), 0.25 * (rung + 0.6)),
                (5.6, 4.55 + 0.08 * (4 - rung), 0.25 * (rung + 0.6)),
                0.05,
                0.05,
            )
        for x in (4.4, 5.6):
            builder.beam(STEEL, (x, 4.97, 0.03), (x, 4.4, 1.3), 0.06, 0.06)


def _seesaw(builder: MeshBuilder) -> None:
    builder.beam(SIGN_YELLOW, (-6.6, 4.3, 0.32), (-3.3, 4.3, 0.78), 0.2, 0.06)
    builder.extrude(SIGN_RED, [(-5.25, 0.0), (-4.65, 0.0), (-4.95, 0.52)], "y", 4.15, 4.45)
    if builder.detail <= 1:
        for x, z in ((-6.2, 0.36), (-3.7, 0.72)):
            builder.beam(DARK_STEEL, (x, 4.3, z), (x, 4.3, z + 0.3), 0.04, 0.04, up=(1, 0, 0))
            builder.beam(DARK_STEEL, (x, 4.1, z + 0.3), (x, 4.5, z + 0.3), 0.04, 0.04)
        builder.cylinder(RUBBER, (-6.5, 4.2, 0.15), (-6.5, 4.4, 0.15), 0.15, sides=8)


def _rocker(builder: MeshBuilder, x: float, y: float, surface: Surface) -> None:
    """A wooden animal on a spring."""
    builder.cylinder(DARK_STEEL, (x, y, 0), (x, y, 0.42), 0.11, sides=8)
    outline = [
        (-0.45, 0.42),
        (0.35, 0.42),
        (0.5, 0.75),
        (0.62, 0.78),
        (0.55, 1.0),
        (0.3, 0.95),
        (0.15, 0.68),
        (-0.3, 0.68),
        (-0.55, 0.85),
    ]
    builder.extrude(surface, [(x + u, v) for u, v in outline], "y", y - 0.06, y + 0.06)
    if builder.detail <= 1:
        builder.beam(STEEL, (x + 0.28, y - 0.2, 0.78), (x + 0.28, y + 0.2, 0.78), 0.035, 0.035)
        builder.box(SIGN_YELLOW, (x - 0.25, y - 0.13, 0.66), (x + 0.1, y + 0.13, 0.71))


def _pitch(builder: MeshBuilder, variant: int) -> None:
    """A football pitch with goals, or a court for basketball; 30 × 20 m."""
    if variant == 1:
        _court(builder)
        return
    _lines(builder, [[(-15, -10), (15, -10), (15, 10), (-15, 10), (-15, -10)], [(0, -10), (0, 10)]], 0.14)
    if builder.detail < FAR:
        box = [[(side * 15, -5), (side * 10.5, -5), (side * 10.5, 5), (side * 15, 5)] for side in (-1, 1)]
        _lines(builder, box, 0.14)
        _circle_line(builder, 3.0, 0.14)
        builder.decal(_LINE, _GROUND.points(disc(0, 0, 0.18, sides=8)))
    for side in (-1, 1):
        _goal(builder, side)


def _lines(builder: MeshBuilder, lines: Sequence[Sequence[tuple[float, float]]], width: float) -> None:
    for points in lines:
        for bar in line(points, width):
            # Within the area, also where a line is its border.
            inside = np.clip(bar, (-15.0, -10.0), (15.0, 10.0))
            builder.decal(_LINE, _GROUND.points(inside))


def _circle_line(builder: MeshBuilder, radius: float, width: float) -> None:
    rim = disc(0, 0, radius, sides=(28, 18, 10)[min(2, builder.detail)])
    for bar in line([(float(u), float(v)) for u, v in [*rim, rim[0]]], width):
        builder.decal(_LINE, _GROUND.points(bar))


def _goal(builder: MeshBuilder, side: int) -> None:
    x, half, high = side * 14.9, 1.9, 2.1
    if builder.detail == FAR:
        net = plain(0.70, 0.72, 0.72)
        builder.sheet(net, [(x, -half, 0), (x, half, 0), (x, half, high), (x, -half, high)])
        return
    post = 0.06
    for y in (-half, half):
        builder.cylinder(SIGN_WHITE, (x, y, 0), (x, y, high), post, sides=10)
        builder.beam(STEEL, (x, y, high - 0.05), (x + side * 0.05, y, high - 0.05), 0.05, 0.05)
    builder.cylinder(SIGN_WHITE, (x, -half - post, high), (x, half + post, high), post, sides=10)
    if builder.detail == 2:
        return
    # The net: cords down the back and across it.
    net, back = plain(0.80, 0.82, 0.84), x + 0.08 * side
    count = 9 if builder.detail == 0 else 5
    for y in np.linspace(-half, half, count).tolist():
        builder.sheet(net, [(back, y - 0.02, 0), (back, y + 0.02, 0), (back, y + 0.02, high), (back, y - 0.02, high)])
    for z in np.linspace(0.3, high - 0.3, 4 if builder.detail == 0 else 2).tolist():
        builder.sheet(
            net, [(back, -half, z - 0.02), (back, half, z - 0.02), (back, half, z + 0.02), (back, -half, z + 0.02)]
        )


def _court(builder: MeshBuilder) -> None:
    _lines(builder, [[(-15, -10), (15, -10), (15, 10), (-15, 10), (-15, -10)], [(0, -10), (0, 10)]], 0.12)
    if builder.detail < FAR:
        _circle_line(builder, 2.0, 0.1)
        keys = [[(side * 15, -2.6), (side * 9.2, -2.6), (side * 9.2, 2.6), (side * 15, 2.6)] for side in (-1, 1)]
        _lines(builder, keys, 0.1)
    for side in (-1, 1):
        _hoop(builder, side)


def _hoop(builder: MeshBuilder, side: int) -> None:
    x = side * 14.6
    if builder.detail == FAR:
        builder.sheet(SIGN_WHITE, [(x, -0.9, 2.9), (x, 0.9, 2.9), (x, 0.9, 4.0), (x, -0.9, 4.0)])
        builder.sheet(DARK_STEEL, [(x, -0.12, 0), (x, 0.12, 0), (x, 0, 3.1)])
        return
    builder.cylinder(DARK_STEEL, (x, 0, 0), (x, 0, 3.3), 0.09, sides=10)
    board = x - side * 0.7
    builder.beam(DARK_STEEL, (x, 0, 3.2), (board, 0, 3.4), 0.1, 0.1)
    builder.box(SIGN_WHITE, (board - 0.03, -0.9, 2.95), (board + 0.03, 0.9, 4.0))
    for face in (-1, 1):
        for bar in line([(-0.3, 3.1), (-0.3, 3.55), (0.3, 3.55), (0.3, 3.1), (-0.3, 3.1)], 0.06):
            plane = Plane((board + face * 0.042, 0, 0), (0, float(face), 0))
            builder.decal(SIGN_RED, plane.points(bar))
    builder.torus(plain(0.95, 0.42, 0.08), (board - side * 0.3, 0, 3.05), 0.24, 0.025, around=14, sides=5)
    builder.beam(plain(0.95, 0.42, 0.08), (board, 0, 3.05), (board - side * 0.08, 0, 3.05), 0.1, 0.04)


def _lawn(builder: MeshBuilder, variant: int) -> None:
    """Nothing: grass is ground."""
    del builder, variant


@dataclass(frozen=True, slots=True, eq=False)
class Piece:
    """A piece of a playground, about its own middle.

    Attributes:
        model: What it looks like.
        radius_m: Of the room that it needs.
    """

    model: Model
    radius_m: float


@lru_cache(maxsize=4)
def playground_pieces(variant: int) -> tuple[Piece, ...]:
    """Return what the playgrounds of a variant are made of, the most important first."""

    def frame(builder: MeshBuilder, chosen: int) -> None:
        _climbing_frame(builder, chosen)

    def pit(builder: MeshBuilder, chosen: int) -> None:
        del chosen
        _sandpit(builder)

    def seesaw(builder: MeshBuilder, chosen: int) -> None:
        del chosen
        _seesaw(builder)

    def rocker(builder: MeshBuilder, chosen: int) -> None:
        _rocker(builder, 0.0, 0.0, (_TOY_GREEN, SIGN_BLUE)[chosen])

    return (
        Piece(_piece(frame, variant, (5.0, 3.6 if variant == 0 else 2.8)), 2.3),
        Piece(_piece(pit, 0, (-4.9, -3.8)), 3.1),
        Piece(_piece(rocker, 0, (0.0, 0.0)), 0.9),
        Piece(_piece(seesaw, 0, (-4.95, 4.3)), 1.9),
        Piece(_piece(rocker, 1, (0.0, 0.0)), 0.9),
    )


@lru_cache(maxsize=2)
def pitch_end(variant: int) -> Model:
    """Return a goal (of even variants) or a hoop; the pitch lies behind it."""

    def end(builder: MeshBuilder, chosen: int) -> None:
        turned = MeshBuilder(detail=builder.detail)
        (_goal, _hoop)[chosen](turned, 1)
        builder.add(turned, heading_rad=-math.pi / 2.0)

    return _piece(end, variant % 2, (0.0, 14.75))


def _piece(make: Callable[[MeshBuilder, int], None], variant: int, middle: tuple[float, float]) -> Model:
    """Return a part of a playground or pitch, moved from where it is there to the origin."""

    def moved(builder: MeshBuilder, chosen: int) -> None:
        # The coarsest level of the whole is no level of its parts.
        own = MeshBuilder(detail=min(builder.detail, 2))
        make(own, chosen)
        builder.add(own, (-middle[0], -middle[1], 0.0))

    whole = Maker(moved, variants=2, fits="none", scaling="none")
    name = f"piece-{make.__name__}-{variant % whole.variants}-{middle[0]:g}-{middle[1]:g}"
    return kept_model(name, lambda: whole.model(variant, (1.0, 1.0, 1.0)))


MAKERS = {
    "swing": Maker(_swing, variants=2),
    "slide": Maker(_slide, variants=2),
    "playground": Maker(_playground, variants=2, fits="none"),
    "pitch": Maker(_pitch, variants=2, fits="none"),
    "lawn": Maker(_lawn, fits="none"),
}
