"""What one throws things into: trash cans, recycling bins, mailboxes."""

import math

import numpy as np

from reasoned_explorer.rendering.lettering import (
    Plane,
    disc,
    facing_back,
    facing_front,
    facing_side,
    line,
    rectangle,
    write,
)
from reasoned_explorer.rendering.mesh_builder import FAR, MeshBuilder, Surface
from reasoned_explorer.rendering.models.maker import Maker
from reasoned_explorer.rendering.models.palette import BLACK, DARK_STEEL, IRON, SIGN_WHITE, STEEL, plain

_CAN_GREEN = plain(0.10, 0.36, 0.20)
_CAN_ORANGE = plain(0.93, 0.42, 0.07)
_CAN_GREY = Surface(STEEL.material, (0.46, 0.48, 0.49))


def _waste_basket(builder: MeshBuilder, variant: int) -> None:
    (_domed_can, _square_can, _hanging_can)[variant](builder)


def _domed_can(builder: MeshBuilder) -> None:
    """A round can with a domed lid and an opening in it."""
    if builder.detail == FAR:
        builder.cylinder(_CAN_GREEN, (0, 0, 0), (0, 0, 0.74), 0.22, 0.25, sides=13, capped=False)
        builder.cylinder(IRON, (0, 0, 0.74), (0, 0, 1.0), 0.25, 0.0, sides=13, capped=False)
        return
    builder.lathe(_CAN_GREEN, [(0.19, 0.0), (0.21, 0.03), (0.24, 0.72), (0.225, 0.74)], sides=18)
    if builder.detail == 0:
        for z in (0.1, 0.64):
            builder.torus(_CAN_GREEN.shaded(0.7), (0, 0, z), 0.205 + 0.04 * z, 0.014, around=18, sides=4)
        for turn in range(12):
            angle = math.radians(30 * turn)
            foot, top = 0.212, 0.239
            builder.beam(
                _CAN_GREEN.shaded(0.8),
                (foot * math.sin(angle), foot * math.cos(angle), 0.12),
                (top * math.sin(angle), top * math.cos(angle), 0.62),
                0.02,
                0.012,
                up=(math.sin(angle), math.cos(angle), 0),
            )
    builder.lathe(IRON, [(0.25, 0.73), (0.25, 0.78), (0.215, 0.9), (0.13, 0.975), (0.0, 1.0)], sides=18)
    if builder.detail <= 1:
        for side in (facing_front(0.232), facing_back(-0.232)):
            builder.box(DARK_STEEL, (-0.13, side.origin[1] - 0.03, 0.78), (0.13, side.origin[1] + 0.03, 0.93))
            opening = Plane((0, side.origin[1] + 0.035 * math.copysign(1, side.origin[1]), 0), side.right)
            builder.decal(BLACK, opening.points(rectangle(0, 0.855, 0.2, 0.1)))


def _square_can(builder: MeshBuilder) -> None:
    """A square housing of steel with a slot under its roof and a pictogram of somebody who throws something in."""
    if builder.detail == FAR:
        builder.box(_CAN_GREY, (-0.23, -0.23, 0), (0.23, 0.23, 0.94))
        builder.box(BLACK, (-0.25, -0.25, 0.78), (0.25, 0.25, 1.0))
        return
    builder.box(DARK_STEEL, (-0.2, -0.2, 0), (0.2, 0.2, 0.05))
    builder.box(_CAN_GREY, (-0.23, -0.23, 0.05), (0.23, 0.23, 0.76), bevel=0.02)
    builder.box(BLACK, (-0.2, -0.2, 0.76), (0.2, 0.2, 0.93))
    for x in (-0.21, 0.21):
        for y in (-0.21, 0.21):
            builder.box(_CAN_GREY, (x - 0.02, y - 0.02, 0.76), (x + 0.02, y + 0.02, 0.94))
    builder.box(_CAN_GREY.shaded(0.8), (-0.25, -0.25, 0.93), (0.25, 0.25, 1.0), bevel=0.025)
    if builder.detail <= 1:
        for plane in (facing_front(0.24), facing_back(-0.24)):
            _thrower(builder, plane, (0.0, 0.42), 0.36)


def _hanging_can(builder: MeshBuilder) -> None:
    """An orange litter bin on a post."""
    builder.cylinder(DARK_STEEL, (0, -0.2, 0), (0, -0.2, 1.0 if builder.detail < FAR else 0.9), 0.045, sides=8)
    if builder.detail == FAR:
        builder.box(_CAN_ORANGE, (-0.25, -0.15, 0.35), (0.25, 0.25, 1.0))
        return
    section = [(-0.25, 0.1), (-0.19, 0.25), (0.19, 0.25), (0.25, 0.1), (0.25, -0.15), (-0.25, -0.15)]
    rings = [[(x * k, y * k, z) for x, y in section] for k, z in ((0.82, 0.35), (1.0, 0.9))]
    builder.loft(_CAN_ORANGE, rings, smooth=False)
    builder.box(BLACK, (-0.2, -0.13, 0.9), (0.2, 0.2, 0.96))
    builder.box(_CAN_ORANGE.shaded(0.85), (-0.25, -0.17, 0.955), (0.25, 0.23, 1.0), bevel=0.02)
    if builder.detail <= 1:
        _thrower(builder, facing_front(0.256), (0.0, 0.68), 0.3)


def _thrower(builder: MeshBuilder, plane: Plane, centre: tuple[float, float], height: float) -> None:
    """The pictogram of a person beside a bin, white."""
    u, v, k = centre[0] - 0.1 * height, centre[1] - height / 2, height
    builder.decal(SIGN_WHITE, plane.points(disc(u, v + 0.9 * k, 0.1 * k, sides=8)))
    strokes = (
        ([(u, v + 0.78 * k), (u - 0.02 * k, v + 0.4 * k), (u - 0.12 * k, v)], 0.14 * k),
        ([(u, v + 0.42 * k), (u + 0.1 * k, v)], 0.11 * k),
        ([(u, v + 0.72 * k), (u + 0.25 * k, v + 0.55 * k)], 0.08 * k),
    )
    for points, width in strokes:
        for bar in line(points, width):
            builder.decal(SIGN_WHITE, plane.points(bar))
    builder.decal(SIGN_WHITE, plane.points(rectangle(u + 0.42 * k, v + 0.2 * k, 0.22 * k, 0.4 * k)))


_CONTAINERS = (plain(0.08, 0.45, 0.22), plain(0.08, 0.33, 0.66), plain(0.95, 0.75, 0.10))


def _recycling(builder: MeshBuilder, variant: int) -> None:
    """Three bins in a row, green, blue and yellow, with round openings and the mark of three arrows."""
    order = ((0, 1, 2), (1, 0, 1))[variant]
    for place, kind in enumerate(order):
        surface, x = _CONTAINERS[kind], -0.8 + place * 1.6 / 3
        outline = [
            (-0.6, 0.06),
            (0.6, 0.06),
            (0.6, 1.0),
            (0.42, 1.36),
            (0.2, 1.5),
            (-0.2, 1.5),
            (-0.42, 1.36),
            (-0.6, 1.0),
        ]
        if builder.detail == FAR:
            # Only what is seen: the front, the roof and the back of each, and the two ends.
            faces = [[(-0.6, 0.0), (-0.5, 1.5)], [(-0.5, 1.5), (0.5, 1.5)], [(0.5, 1.5), (0.6, 0.0)]]
            for (y0, z0), (y1, z1) in faces:
                builder.decal(surface, [(x, y0, z0), (x + 0.5334, y0, z0), (x + 0.5334, y1, z1), (x, y1, z1)])
            if place != 1:
                end = x if place == 0 else x + 0.5334
                corners = [(end, -0.6, 0), (end, -0.5, 1.5), (end, 0.5, 1.5), (end, 0.6, 0)]
                builder.decal(surface, corners[::-1] if place == 0 else corners)
            continue
        builder.extrude(surface, outline, "x", x + 0.012, x + 0.521)
        builder.box(DARK_STEEL, (x + 0.02, -0.5, 0), (x + 0.51, 0.5, 0.07))
        for face in (1, -1):
            plane = facing_front(0.61, x=x + 0.267) if face > 0 else facing_back(-0.61, x=x + 0.267)
            _three_arrows(builder, plane, (0.0, 0.55), 0.19)
            _opening(builder, x + 0.267, face)


def _opening(builder: MeshBuilder, x: float, face: int) -> None:
    """A round hole with a collar in the sloping lid."""
    middle, out = np.array([x, face * 0.51, 1.18]), np.array([0, face * 0.894, 0.447])
    if builder.detail <= 1:
        builder.cylinder(DARK_STEEL, middle - 0.03 * out, middle + 0.025 * out, 0.16, sides=14)
    plane = Plane(tuple(middle + 0.035 * out), (-face, 0, 0), (0, -face * 0.447, 0.894))
    builder.decal(BLACK, plane.points(disc(0, 0, 0.13, sides=builder.sides(14))))


def _three_arrows(builder: MeshBuilder, plane: Plane, centre: tuple[float, float], radius: float) -> None:
    if builder.detail > 1:
        builder.decal(SIGN_WHITE, plane.points(disc(*centre, 0.8 * radius, sides=3)))
        return
    for turn in range(3):
        start, end, tip = (math.radians(90 + 120 * turn + step) for step in (15, 78, 112))
        inner, outer = 0.66 * radius, 1.0 * radius
        bend = [(math.cos(a), math.sin(a)) for a in (start, (start + end) / 2, end)]
        ring = [(outer * c, outer * s) for c, s in bend]
        ring += [(1.22 * radius * bend[2][0], 1.22 * radius * bend[2][1])]
        ring += [(0.83 * radius * math.cos(tip), 0.83 * radius * math.sin(tip))]
        ring += [(0.44 * radius * bend[2][0], 0.44 * radius * bend[2][1])]
        ring += [(inner * c, inner * s) for c, s in reversed(bend)]
        builder.decal(SIGN_WHITE, plane.points(np.array(ring) + np.array(centre)))


_POST_YELLOW = plain(0.99, 0.80, 0.04)
_POST_RED = plain(0.76, 0.06, 0.08)
_POST_BLUE = plain(0.08, 0.22, 0.50)


def _post_box(builder: MeshBuilder, variant: int) -> None:
    (_post_box_yellow, _post_box_pillar, _post_box_blue)[variant](builder)


def _post_box_yellow(builder: MeshBuilder) -> None:
    """A yellow box on a foot, with slots, a black horn and a white notice."""
    if builder.detail == FAR:
        builder.box(_POST_YELLOW, (-0.25, -0.25, 0.38), (0.25, 0.25, 1.2))
        builder.box(DARK_STEEL, (-0.1, -0.1, 0), (0.1, 0.1, 0.4))
        return
    builder.box(DARK_STEEL, (-0.2, -0.2, 0), (0.2, 0.2, 0.04))
    builder.box(DARK_STEEL, (-0.09, -0.09, 0.04), (0.09, 0.09, 0.4))
    outline = [(-0.23, 0.38), (0.23, 0.38), (0.23, 1.06), (0.16, 1.16), (-0.16, 1.16), (-0.23, 1.06)]
    builder.extrude(_POST_YELLOW, outline, "x", -0.235, 0.235)
    builder.extrude(
        _POST_YELLOW.shaded(0.9), [(-0.25, 1.08), (0.25, 1.08), (0.17, 1.2), (-0.17, 1.2)], "x", -0.25, 0.25
    )
    for plane in (facing_front(0.242), facing_back(-0.242)):
        builder.decal(BLACK, plane.points(rectangle(0, 1.0, 0.34, 0.06)))
        if builder.detail <= 1:
            builder.decal(SIGN_WHITE, plane.points(rectangle(0.15, 0.52, 0.12, 0.18)))
            _horn(builder, plane, (0.0, 0.80))
            write(builder, BLACK, "POST", plane.nearer(0.01), centre=(-0.08, 0.52), height_m=0.09)


def _horn(builder: MeshBuilder, plane: Plane, centre: tuple[float, float]) -> None:
    """The black post horn: a loop, a bell to the left, a mouthpiece to the right."""
    u, v = centre
    loop = [(u + 0.07 * math.cos(a), v + 0.07 * math.sin(a)) for a in np.linspace(0, 2 * math.pi, 11)]
    for bar in line(loop, 0.022):
        builder.decal(BLACK, plane.points(bar))
    builder.decal(BLACK, plane.points([(u, v + 0.08), (u - 0.15, v + 0.11), (u - 0.15, v), (u, v + 0.06)]))
    builder.decal(BLACK, plane.points(rectangle(u + 0.09, v + 0.07, 0.16, 0.022)))


def _post_box_pillar(builder: MeshBuilder) -> None:
    """A round red pillar with a black foot and a cap."""
    if builder.detail == FAR:
        builder.cylinder(BLACK, (0, 0, 0), (0, 0, 0.15), 0.23, sides=13, capped=False)
        builder.cylinder(_POST_RED, (0, 0, 0.15), (0, 0, 1.2), 0.23, sides=13)
        return
    builder.lathe(BLACK, [(0.23, 0.0), (0.23, 0.12), (0.2, 0.15)], sides=20)
    builder.lathe(
        _POST_RED, [(0.205, 0.14), (0.205, 1.02), (0.245, 1.05), (0.25, 1.09), (0.18, 1.16), (0, 1.2)], sides=20
    )
    builder.box(BLACK, (-0.12, 0.15, 0.9), (0.12, 0.216, 0.94))
    builder.box(SIGN_WHITE, (-0.09, 0.15, 0.6), (0.09, 0.218, 0.8))
    if builder.detail <= 1:
        write(builder, BLACK, "POST", facing_front(0.23), centre=(0, 0.7), height_m=0.06)
        builder.torus(_POST_RED, (0, 0, 0.86), 0.205, 0.012, around=20, sides=4)


def _post_box_blue(builder: MeshBuilder) -> None:
    """A blue box with a rounded top on four legs and a white label."""
    if builder.detail == FAR:
        builder.box(_POST_BLUE, (-0.25, -0.25, 0.15), (0.25, 0.25, 1.2))
        builder.box(_POST_BLUE, (-0.25, -0.25, 0), (0.25, 0.25, 0.16))
        return
    steps = builder.sides(9)
    arch = [(0.25 * math.cos(a), 0.95 + 0.25 * math.sin(a)) for a in np.linspace(0, math.pi, steps + 1)]
    builder.extrude(_POST_BLUE, [(-0.25, 0.2), (0.25, 0.2), *arch], "x", -0.25, 0.25)
    for x in (-0.2, 0.2):
        for y in (-0.2, 0.2):
            builder.box(_POST_BLUE.shaded(0.8), (x - 0.04, y - 0.04, 0), (x + 0.04, y + 0.04, 0.22))
    builder.box(_POST_BLUE.shaded(1.3), (-0.2, 0.2, 0.86), (0.2, 0.27, 0.98), bevel=0.015)
    builder.decal(SIGN_WHITE, facing_front(0.262).points(rectangle(0, 0.62, 0.36, 0.18)))
    for x in (0.262, -0.262):
        builder.decal(SIGN_WHITE, facing_side(x).points(rectangle(0, 0.66, 0.36, 0.16)))
        write(builder, _POST_BLUE, "MAIL", facing_side(x * 1.04), centre=(0, 0.66), height_m=0.11)
    write(builder, _POST_BLUE, "MAIL", facing_front(0.272), centre=(0, 0.62), height_m=0.11)


MAKERS = {
    "waste_basket": Maker(_waste_basket, variants=3),
    "recycling": Maker(_recycling, variants=2),
    "post_box": Maker(_post_box, variants=3),
}
