"""What one steps up to or under: shelters, telephone booths, vending machines, kiosks."""

import math
from itertools import pairwise

import numpy as np

from reasoned_explorer.rendering.lettering import Plane, facing_back, facing_front, facing_side, rectangle, write
from reasoned_explorer.rendering.mesh_builder import FAR, MeshBuilder, Surface
from reasoned_explorer.rendering.models.maker import Maker
from reasoned_explorer.rendering.models.palette import (
    BLACK,
    CONCRETE,
    DARK_STEEL,
    DARK_WOOD,
    GLASS,
    LIGHT,
    OAK,
    PAINT,
    PALE_GLASS,
    PALE_WOOD,
    SIGN_RED,
    SIGN_WHITE,
    SIGN_YELLOW,
    STEEL,
    plain,
)

_BOOTH_RED = plain(0.74, 0.05, 0.07)
_MAGENTA = plain(0.86, 0.05, 0.45)


def _shelter(builder: MeshBuilder, variant: int) -> None:
    """A roof on posts over a bench, with walls of glass at its back and sides; or a wooden one."""
    post, roof = ((DARK_STEEL, plain(0.24, 0.27, 0.30)), (PALE_WOOD, DARK_WOOD))[variant]
    wall = (PALE_GLASS, PALE_WOOD)[variant]
    if builder.detail == FAR:
        builder.box(roof, (-2.0, -1.0, 2.42), (2.0, 1.0, 2.6))
        builder.sheet(wall, [(-1.9, -0.8, 0), (1.9, -0.8, 0), (1.9, -0.8, 2.45), (-1.9, -0.8, 2.45)])
        for x in (-1.9, 1.9):
            builder.sheet(wall, [(x, -0.8, 0), (x, 0.5, 0), (x, 0.5, 2.45), (x, -0.8, 2.45)])
        return
    for x in (-1.85, 0.0, 1.85):
        builder.box(post, (x - 0.05, -0.85, 0), (x + 0.05, -0.75, 2.46))
        if x:
            builder.box(post, (x - 0.05, 0.55, 0), (x + 0.05, 0.65, 2.46))
    if variant == 0:
        builder.box(roof, (-2.0, -1.0, 2.42), (2.0, 1.0, 2.6), bevel=0.05)
    else:
        builder.extrude(roof, [(-1.0, 2.36), (1.0, 2.36), (1.0, 2.42), (0.0, 2.6), (-1.0, 2.42)], "x", -2.0, 2.0)
    for low, high in ((-1.8, -0.05), (0.05, 1.8)):
        builder.box(wall, (low, -0.815, 0.3 if variant == 0 else 0.0), (high, -0.785, 2.2))
    for x in (-1.85, 1.85):
        builder.box(wall, (x - 0.015, -0.75, 0.3 if variant == 0 else 0.0), (x + 0.015, 0.55, 2.2))
    bench = PALE_WOOD if variant == 0 else OAK
    builder.box(bench, (-1.5, -0.7, 0.43), (1.3, -0.32, 0.48))
    for x in (-1.3, 0.0, 1.1):
        builder.box(post, (x - 0.04, -0.62, 0), (x + 0.04, -0.4, 0.44))
    if builder.detail <= 1 and variant == 0:
        _timetable(builder)


def _timetable(builder: MeshBuilder) -> None:
    """A notice on the glass, read from both sides, and a bright line along the roof."""
    for plane in (facing_front(-0.775, x=0.9), facing_back(-0.825, x=0.9)):
        builder.decal(SIGN_WHITE, plane.points(rectangle(0, 1.45, 0.7, 0.9)))
        near = Plane((0.9, plane.origin[1] - math.copysign(0.01, plane.right[0]), 0.0), plane.right)
        builder.decal(plain(0.30, 0.55, 0.75), near.points(rectangle(0, 1.72, 0.6, 0.25)))
        builder.decal(DARK_STEEL, near.points(rectangle(0, 1.38, 0.6, 0.05)))
        builder.decal(DARK_STEEL, near.points(rectangle(0, 1.25, 0.6, 0.05)))
    builder.decal(SIGN_YELLOW, facing_front(1.012).points(rectangle(0, 2.51, 3.6, 0.05)))


def _telephone(builder: MeshBuilder, variant: int) -> None:
    """A booth with panes on all sides and the word TELEPHONE over them: red, or of glass and magenta."""
    body = (_BOOTH_RED, _MAGENTA)[variant]
    if builder.detail == FAR:
        pane = plain(*(0.5 * a + 0.5 * b for a, b in zip(body.colour, (0.40, 0.50, 0.55), strict=True)))
        builder.box(pane, (-0.48, -0.48, 0), (0.48, 0.48, 1.9))
        builder.box(body, (-0.5, -0.5, 1.88), (0.5, 0.5, 2.3))
        return
    _booth_body(builder, body, domed=variant == 0)
    for plane in _around(0.51):
        builder.decal(SIGN_WHITE, plane.points(rectangle(0, 2.02, 0.84, 0.15)))
        write(builder, BLACK, "TELEPHONE", _nearer(plane), centre=(0, 2.02), height_m=0.1)
    for number, plane in enumerate(_around(0.442)):
        if builder.detail <= 1 and variant == 0:
            _bars(builder, body, plane)
        builder.decal(body, plane.points(rectangle(0, 0.24, 0.86, 0.24)))
        if number > 0 and variant == 1:
            _handset(builder, plane)


def _bars(builder: MeshBuilder, body: Surface, plane: Plane) -> None:
    """The bars that part a wall into many panes."""
    rows = 6 if builder.detail == 0 else 3
    for row in range(rows + 1):
        builder.decal(body, plane.points(rectangle(0, 0.35 + 1.5 * row / rows, 0.86, 0.035)))
    for u in (-0.26, 0.26):
        builder.decal(body, _nearer(plane).points(rectangle(u, 1.1, 0.03, 1.55)))


def _booth_body(builder: MeshBuilder, body: Surface, *, domed: bool) -> None:
    half = 0.46
    builder.box(body.shaded(0.7), (-0.48, -0.48, 0), (0.48, 0.48, 0.12))
    for x in (-half, half):
        for y in (-half, half):
            builder.box(body, (x - 0.04, y - 0.04, 0.1), (x + 0.04, y + 0.04, 2.0))
    builder.box(GLASS.shaded(1.4), (-0.43, -0.43, 0.12), (0.43, 0.43, 1.9))
    builder.box(body, (-0.5, -0.5, 1.88), (0.5, 0.5, 2.16), bevel=0.02)
    if domed:
        dome = [[(x * k, y * k, z) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))] for k, z in _DOME]
        builder.loft(body, dome, smooth=False)
    else:
        builder.box(body, (-0.46, -0.46, 2.16), (0.46, 0.46, 2.3), bevel=0.06)


_DOME = ((0.48, 2.16), (0.42, 2.23), (0.2, 2.29), (0.06, 2.3))


def _handset(builder: MeshBuilder, plane: Plane) -> None:
    """The mark of a telephone: a receiver, white."""
    k, v = 0.2, 1.25
    outline = [
        (-1, 0.4),
        (-0.6, 0.8),
        (0.6, 0.8),
        (1, 0.4),
        (0.9, 0.0),
        (0.5, 0.0),
        (0.4, 0.35),
        (-0.4, 0.35),
        (-0.5, 0),
        (-0.9, 0),
    ]
    builder.decal(SIGN_WHITE, _nearer(plane).points([(u * k, v + w * k) for u, w in reversed(outline)]))
    builder.decal(SIGN_WHITE, _nearer(plane).points(rectangle(0, v - 0.12, 0.24, 0.2)))


def _around(distance: float) -> tuple[Plane, Plane, Plane, Plane]:
    """Return the four upright planes at a distance from the axis: front, back, right, left."""
    return facing_front(distance), facing_back(-distance), facing_side(distance), facing_side(-distance)


def _nearer(plane: Plane) -> Plane:
    """Return a plane a centimetre nearer to its reader."""
    x, y, z = plane.origin
    reach = math.hypot(x, y)
    return Plane((x + 0.01 * x / reach, y + 0.01 * y / reach, z), plane.right, plane.up)


_CANS = (
    plain(0.85, 0.10, 0.12),
    plain(0.10, 0.45, 0.75),
    plain(0.98, 0.65, 0.10),
    plain(0.12, 0.55, 0.28),
    plain(0.92, 0.92, 0.90),
    plain(0.45, 0.20, 0.50),
)


def _vending_machine(builder: MeshBuilder, variant: int) -> None:
    """A machine with rows of bright cans behind glass, a panel with a slot, and a flap below."""
    body = (plain(0.78, 0.08, 0.10), plain(0.10, 0.30, 0.60))[variant]
    if builder.detail == FAR:
        builder.box(body, (-0.45, -0.4, 0), (0.45, 0.4, 1.9))
        builder.decal(plain(0.55, 0.48, 0.45), facing_front(0.41).points(rectangle(-0.12, 1.15, 0.58, 1.0)))
        return
    builder.box(BLACK, (-0.42, -0.38, 0), (0.42, 0.36, 0.08))
    builder.box(body, (-0.45, -0.4, 0.08), (0.45, 0.38, 1.9), bevel=0.025)
    front = facing_front(0.392)
    builder.decal(plain(0.10, 0.13, 0.16), front.points(rectangle(-0.12, 1.12, 0.58, 1.0)))
    builder.decal(LIGHT, front.points(rectangle(0, 1.76, 0.8, 0.2)))
    write(builder, body, "DRINKS" if variant == 0 else "SNACKS", _nearer(front), centre=(0, 1.76), height_m=0.13)
    for row in range(4):
        height = 0.70 + 0.25 * row
        builder.decal(STEEL, _nearer(front).points(rectangle(-0.12, height - 0.02, 0.56, 0.02)))
        columns = (6, 6, 2)[builder.detail]
        for column in range(columns):
            colour = _CANS[(row * 2 + column) % len(_CANS)]
            wide = 0.5 / columns
            at = -0.12 - 0.25 + wide * (column + 0.5)
            builder.decal(colour, _nearer(front).points(rectangle(at, height + 0.075, 0.75 * wide, 0.15)))
    if builder.detail <= 1:
        builder.decal(plain(0.15, 0.16, 0.18), front.points(rectangle(0.31, 1.15, 0.2, 0.62)))
        builder.decal(plain(0.40, 0.75, 0.85), _nearer(front).points(rectangle(0.31, 1.36, 0.14, 0.09)))
        for key in range(6):
            u, v = 0.28 + 0.06 * (key % 2), 1.22 - 0.06 * (key // 2)
            builder.decal(SIGN_WHITE, _nearer(front).points(rectangle(u, v, 0.04, 0.04)))
        builder.box(STEEL, (-0.36, 0.36, 0.9), (-0.26, 0.4, 1.0))
    builder.decal(BLACK, front.points(rectangle(-0.08, 0.36, 0.6, 0.2)))


def _kiosk(builder: MeshBuilder, variant: int) -> None:
    """A hut with a counter under a striped awning, papers and bottles, and a sign on its roof."""
    wall = (plain(0.20, 0.38, 0.32), plain(0.88, 0.84, 0.74))[variant]
    if builder.detail == FAR:
        builder.box(wall, (-1.4, -1.25, 0), (1.4, 0.75, 2.5))
        builder.sheet(PAINT, [(-1.5, 0.75, 2.45), (1.5, 0.75, 2.45), (1.5, 1.25, 2.1), (-1.5, 1.25, 2.1)])
        builder.sheet(SIGN_WHITE, [(-1.2, 0.6, 2.4), (1.2, 0.6, 2.4), (1.2, 0.6, 2.8), (-1.2, 0.6, 2.8)])
        return
    builder.box(CONCRETE, (-1.42, -1.25, 0), (1.42, 0.76, 0.1))
    builder.box(wall, (-1.4, -1.23, 0.08), (1.4, 0.7, 2.4))
    builder.box(wall.shaded(0.6), (-1.5, -1.25, 2.36), (1.5, 0.85, 2.48), bevel=0.03)
    front = facing_front(0.712)
    builder.decal(plain(0.10, 0.11, 0.13), front.points(rectangle(0, 1.55, 2.3, 1.0)))
    builder.box(PALE_WOOD, (-1.25, 0.66, 0.98), (1.25, 1.0, 1.05))
    _awning(builder, -1.45, 1.45)
    builder.box(SIGN_WHITE, (-1.2, 0.55, 2.48), (1.2, 0.65, 2.8))
    for plane in (facing_front(0.66), facing_back(0.54)):
        write(builder, SIGN_RED, "KIOSK", plane, centre=(0, 2.64), height_m=0.24)
    if builder.detail <= 1:
        _goods(builder, _nearer(front))
        for side in (1.41, -1.41):
            for place, colour in enumerate(_CANS[:4]):
                builder.decal(colour, facing_side(side, y=-0.2).points(rectangle(-0.6 + 0.42 * place, 1.4, 0.34, 0.5)))
        builder.box(DARK_STEEL, (-1.2, 0.7, 0.2), (-0.3, 0.85, 0.85))
        for place in range(4):
            colour = _CANS[(place + 2) % 6]
            builder.decal(colour, facing_front(0.862).points(rectangle(0.42 + 0.22 * place, 0.55, 0.17, 0.5)))


def _goods(builder: MeshBuilder, plane: Plane) -> None:
    """Shelves behind the counter."""
    for row in range(2):
        builder.decal(OAK, plane.points(rectangle(0, 1.35 + 0.34 * row, 2.1, 0.03)))
        count = 10 if builder.detail == 0 else 5
        for place in range(count):
            colour = _CANS[(3 * row + place) % len(_CANS)]
            u = -0.95 + 1.9 * (place + 0.5) / count
            builder.decal(colour, plane.points(rectangle(u, 1.47 + 0.34 * row, 1.9 / count * 0.7, 0.2)))


def _awning(builder: MeshBuilder, low: float, high: float) -> None:
    stripes = (10, 6, 4)[builder.detail]
    edges = np.linspace(low, high, stripes + 1)
    for place, (a, b) in enumerate(pairwise(edges)):
        surface: Surface = PAINT if place % 2 else SIGN_WHITE
        builder.sheet(surface, [(a, 0.7, 2.42), (b, 0.7, 2.42), (b, 1.25, 2.12), (a, 1.25, 2.12)])
        builder.sheet(surface, [(a, 1.25, 2.12), (b, 1.25, 2.12), (b, 1.25, 1.98), (a, 1.25, 1.98)])


MAKERS = {
    "shelter": Maker(_shelter, variants=2),
    "telephone": Maker(_telephone, variants=2),
    "vending_machine": Maker(_vending_machine, variants=2),
    "kiosk": Maker(_kiosk, variants=2, tints=((0.80, 0.14, 0.14), (0.12, 0.36, 0.62), (0.12, 0.46, 0.30))),
}
