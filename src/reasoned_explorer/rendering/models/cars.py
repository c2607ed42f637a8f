"""Parked cars: saloon, hatchback, estate, van."""

import math
from dataclasses import dataclass

import numpy as np

from reasoned_explorer.rendering.lettering import Plane, disc, facing_back, facing_front, facing_side, rectangle
from reasoned_explorer.rendering.mesh_builder import FAR, MeshBuilder
from reasoned_explorer.rendering.models.maker import Maker
from reasoned_explorer.rendering.models.palette import BLACK, GLASS, PAINT, RUBBER, SIGN_RED, SIGN_WHITE, STEEL, plain

_PLASTIC = plain(0.13, 0.13, 0.14)
_LAMP = plain(0.93, 0.95, 0.96)
_COLOURS = (
    (0.92, 0.92, 0.92),
    (0.66, 0.68, 0.70),
    (0.14, 0.15, 0.17),
    (0.38, 0.40, 0.43),
    (0.10, 0.22, 0.50),
    (0.72, 0.08, 0.09),
    (0.14, 0.33, 0.24),
    (0.78, 0.72, 0.58),
    (0.20, 0.45, 0.68),
)
_WHEEL_M = 0.325
_AXLES_M = (-1.33, 1.36)


@dataclass(frozen=True, slots=True)
class _Body:
    """The shape of a car from the side; y runs from the tail (-2.2 m) to the nose (2.2 m).

    Attributes:
        belt: Height of bonnet, doors and boot at places along y: ``(y, z)``.
        base: Where the windows begin and end along y, at the height of the belt.
        roof: Where the roof begins and ends.
        closed_m: Behind this place the sides are sheet metal, not glass.
        post: Where the post between the doors stands.
    """

    belt: tuple[tuple[float, float], ...]
    base: tuple[float, float]
    roof: tuple[float, float]
    closed_m: float
    post: float


_BODIES = (
    _Body(
        ((-2.2, 0.60), (-2.12, 0.90), (-1.5, 0.97), (0.0, 0.93), (1.0, 0.90), (1.85, 0.76), (2.12, 0.66), (2.2, 0.5)),
        (-1.72, 1.08), (-1.0, 0.22), -9.0, -0.28,
    ),
    _Body(
        ((-2.2, 0.55), (-2.16, 0.92), (-1.5, 0.97), (0.0, 0.93), (1.1, 0.92), (1.85, 0.80), (2.12, 0.70), (2.2, 0.5)),
        (-2.13, 1.16), (-1.7, 0.3), -9.0, -0.3,
    ),
    _Body(
        ((-2.2, 0.55), (-2.17, 0.95), (-1.5, 0.99), (0.0, 0.96), (0.95, 0.95), (1.85, 0.88), (2.12, 0.78), (2.2, 0.5)),
        (-2.15, 1.0), (-1.95, 0.2), -9.0, -0.35,
    ),
    _Body(
        ((-2.2, 0.45), (-2.19, 0.85), (-1.5, 0.85), (0.0, 0.85), (1.5, 0.84), (1.95, 0.74), (2.15, 0.62), (2.2, 0.45)),
        (-2.18, 1.72), (-2.14, 0.78), -0.1, 0.05,
    ),
)  # fmt: skip


def _car(builder: MeshBuilder, variant: int) -> None:
    body = _BODIES[variant]
    if builder.detail == FAR:
        _far(builder, body)
        return
    _lower(builder, body)
    _upper(builder, body)
    for y in _AXLES_M:
        for side in (-1, 1):
            _wheel(builder, side, y)
    _ends(builder, body)
    if builder.detail <= 1:
        _trim(builder, body)


def _far(builder: MeshBuilder, body: _Body) -> None:
    belt = float(np.mean([z for _, z in body.belt[1:6]]))
    low = [(-0.9, -2.2, 0.2), (0.9, -2.2, 0.2), (0.9, 2.2, 0.2), (-0.9, 2.2, 0.2)]
    top = [(x, y, belt - 0.12 if y > 0 else belt) for x, y, _ in low]
    builder.loft(PAINT.shaded(0.92), [low, top], smooth=False, capped=False)
    builder.decal(PAINT, top)
    side = PAINT.shaded(0.85) if body.closed_m > -1 else GLASS
    base = [
        (-0.8, body.base[0], belt),
        (0.8, body.base[0], belt),
        (0.8, body.base[1], belt),
        (-0.8, body.base[1], belt),
    ]
    roof = [
        (-0.62, body.roof[0], 1.5),
        (0.62, body.roof[0], 1.5),
        (0.62, body.roof[1], 1.5),
        (-0.62, body.roof[1], 1.5),
    ]
    builder.loft(side, [base, roof], smooth=False, capped=False)
    builder.decal(PAINT, roof)
    for x in (-0.8, 0.8):
        corners = facing_side(x).points(rectangle(0.0, 0.1, 3.4, 0.2))
        builder.decal(RUBBER, corners)


def _belt_at(body: _Body, y: float) -> float:
    return float(np.interp(y, [at for at, _ in body.belt], [z for _, z in body.belt]))


def _lower(builder: MeshBuilder, body: _Body) -> None:
    """The body up to the windows: rounded sections from tail to nose."""
    stations = body.belt if builder.detail <= 1 else [body.belt[k] for k in (1, 2, 5, 6)]
    rings = []
    for y, z in stations:
        end = abs(y) / 2.2
        wide = 0.885 - 0.1 * max(0.0, end - 0.8) / 0.2 - (0.06 if abs(y) == 2.2 else 0.0)
        floor = 0.22 + 0.12 * max(0.0, end - 0.85) / 0.15
        half = [(0.9 * wide, floor), (wide, floor + 0.12), (wide, z - 0.16), (wide - 0.05, z - 0.04), (wide - 0.15, z)]
        if builder.detail == 2:
            half = [*half[:3], half[4]]
        rings.append([(x, y, h) for x, h in half] + [(-x, y, h) for x, h in reversed(half)])
    builder.loft(PAINT, rings)
    builder.box(_PLASTIC, (-0.8, -1.95, 0.15), (0.8, 1.95, 0.3))


def _upper(builder: MeshBuilder, body: _Body) -> None:
    """Windows all around under a painted roof, and the posts that carry it."""
    belt = {y: _belt_at(body, y) - 0.03 for y in body.base}
    low, high = 0.775, 0.60
    eave, crest = 1.43, 1.5

    def at(share: float, height: float) -> float:
        """Return the place along y at a share from the rear post to the windscreen, at a share of the height."""
        rear = body.base[0] + (body.roof[0] - body.base[0]) * height
        front = body.base[1] + (body.roof[1] - body.base[1]) * height
        return rear + (front - rear) * share

    def ring(height: float, grow: float = 0.0) -> list[tuple[float, float, float]]:
        half = low + (high - low) * height + grow
        y0, y1 = at(0, height) - grow, at(1, height) + grow
        z = [belt[body.base[0]], belt[body.base[1]]]
        z0, z1 = (z[k] + (eave - z[k]) * height for k in (0, 1))
        return [(-half, y0, z0), (half, y0, z0), (half, y1, z1), (-half, y1, z1)]

    builder.loft(GLASS, [ring(0.0), ring(1.0)], smooth=False)
    roof = [
        [(x * k, (y - ym) * k + ym, z) for x, y, _ in ring(1.0, 0.03)]
        for k, z, ym in (
            (1.0, eave - 0.02, sum(body.roof) / 2),
            (0.98, eave + 0.03, sum(body.roof) / 2),
            (0.8, crest, sum(body.roof) / 2),
        )
    ]
    builder.loft(PAINT, roof if builder.detail <= 1 else [roof[0], roof[2]], smooth=builder.detail == 0)
    if body.closed_m > -3.0:
        _panels(builder, ring(0.0, 0.012), ring(1.0, 0.012), body)
    if builder.detail <= 1:
        _posts(builder, body, ring(0.0), ring(1.0))


def _posts(
    builder: MeshBuilder, body: _Body, low: list[tuple[float, float, float]], high: list[tuple[float, float, float]]
) -> None:
    """The posts at the corners of the windows and between the doors, and the roof's edge."""
    for corner in range(4):
        builder.beam(PAINT, low[corner], high[corner], 0.07, 0.07, up=(1, 0, 0))
    for side in (-1, 1):
        foot = (side * abs(low[0][0]), body.post, _belt_at(body, body.post) - 0.03)
        builder.beam(PAINT, foot, (side * abs(high[0][0]), body.post, high[0][2]), 0.09, 0.05, up=(side, 0, 0.3))
        for ring in (low, high) if builder.detail == 0 else ():
            start, end = ring[1 if side > 0 else 0], ring[2 if side > 0 else 3]
            builder.beam(PAINT, start, end, 0.05, 0.06, up=(side, 0, 0.3))


def _panels(
    builder: MeshBuilder,
    low: list[tuple[float, float, float]],
    high: list[tuple[float, float, float]],
    body: _Body,
) -> None:
    """The closed sides and the tail doors of a van."""
    for rear, front in ((1, 2), (0, 3)):
        corners = []
        for ring in (low, high):
            (x0, y0, z0), (x1, y1, z1) = ring[rear], ring[front]
            share = (body.closed_m - y0) / (y1 - y0)
            corners.append([(x0, y0, z0), (x0 + (x1 - x0) * share, body.closed_m, z0 + (z1 - z0) * share)])
        outline = [corners[0][0], corners[0][1], corners[1][1], corners[1][0]]
        builder.decal(PAINT, outline if rear == 1 else outline[::-1])
    for side in (-1, 1):
        inner, outer = 0.06 * side, 1.0 * side
        outline = [
            (low[1][0] * inner, low[0][1], low[0][2]),
            (low[1][0] * outer, low[0][1], low[0][2]),
            (low[1][0] * outer, low[0][1] + 0.4 * (high[0][1] - low[0][1]), low[0][2] + 0.4 * (high[0][2] - low[0][2])),
            (low[1][0] * inner, low[0][1] + 0.4 * (high[0][1] - low[0][1]), low[0][2] + 0.4 * (high[0][2] - low[0][2])),
        ]
        builder.decal(PAINT, outline if side > 0 else outline[::-1])


def _wheel(builder: MeshBuilder, side: int, y: float) -> None:
    """A tyre with a rim of five spokes, in a dark arch."""
    r = _WHEEL_M
    arch = [
        (r * 1.2 * math.cos(a), r + r * 1.2 * math.sin(a))
        for a in np.linspace(-0.35, math.pi + 0.35, builder.sides(13) + 2)
    ]
    plane = facing_side(side * 0.892, y=y)
    builder.decal(BLACK, plane.points(arch))
    if builder.detail == 2:
        plane = facing_side(side * 0.9, y=y)
        builder.decal(RUBBER, plane.points(disc(0, r, r, sides=7)))
        builder.decal(STEEL, facing_side(side * 0.91, y=y).points(disc(0, r, 0.6 * r, sides=4)))
        return
    builder.cylinder(RUBBER, (side * 0.69, y, r), (side * 0.9, y, r), r, sides=14)
    rim = Plane((side * 0.91, y, r), plane.right)
    builder.decal(STEEL, rim.points(disc(0, 0, 0.66 * r, sides=max(6, builder.sides(14)))))
    if builder.detail == 0:
        hub = Plane((side * 0.916, y, r), plane.right)
        for spoke in range(5):
            turn = 2 * math.pi * (spoke + 0.5) / 5 + math.pi / 2
            centre = (0.42 * r * math.cos(turn), 0.42 * r * math.sin(turn))
            builder.decal(_PLASTIC, hub.points(disc(*centre, 0.17 * r, sides=3, turn_rad=turn + math.pi / 2)))


def _ends(builder: MeshBuilder, body: _Body) -> None:
    """Lamps, plates, grille and bumpers."""
    nose, tail = body.belt[-2][1], body.belt[1][1]
    for side in (-1, 1):
        if builder.detail == 2:
            lamp = facing_front(body.belt[-2][0] + 0.012).points(rectangle(side * 0.6, nose - 0.1, 0.32, 0.13))
            builder.decal(_LAMP, lamp)
            builder.decal(
                SIGN_RED, facing_back(body.belt[1][0] - 0.012).points(rectangle(side * 0.62, tail - 0.17, 0.26, 0.22))
            )
            continue
        builder.box(_LAMP, _low(side * 0.62, 0.16, 2.0, nose - 0.16), _high(side * 0.62, 0.16, 2.17, nose - 0.03))
        builder.box(
            SIGN_RED, _low(side * 0.66, 0.13, -2.185, tail - 0.28), _high(side * 0.66, 0.13, -2.05, tail - 0.06)
        )
    if builder.detail == 2:
        return
    builder.box(_PLASTIC, (-0.42, 2.1, nose - 0.2), (0.42, 2.19, nose - 0.06))
    builder.box(_PLASTIC, (-0.76, 2.0, 0.26), (0.76, 2.23, 0.42), bevel=0.03)
    builder.box(_PLASTIC, (-0.76, -2.23, 0.28), (0.76, -2.0, 0.46), bevel=0.03)
    builder.decal(SIGN_WHITE, facing_front(2.242).points(rectangle(0, 0.36, 0.5, 0.11)))
    builder.box(SIGN_WHITE, (-0.26, -2.205, 0.55), (0.26, -2.1, 0.67))


def _low(x: float, half: float, y: float, z: float) -> tuple[float, float, float]:
    return (x - half, y, z)


def _high(x: float, half: float, y: float, z: float) -> tuple[float, float, float]:
    return (x + half, y, z)


def _trim(builder: MeshBuilder, body: _Body) -> None:
    """Mirrors, the gaps around the doors, handles."""
    front = body.base[1] - 0.35
    for side in (-1, 1):
        belt = _belt_at(body, front)
        builder.box(
            PAINT,
            (side * 0.84 - 0.075, front - 0.08, belt - 0.02),
            (side * 0.84 + 0.06, front + 0.06, belt + 0.11),
            bevel=0.03,
        )
        plane = facing_side(side * 0.8875)
        direction = 1.0 if side > 0 else -1.0
        for y in (body.post, body.base[1] - 0.15, max(-1.25, body.base[0] + 0.5)):
            builder.decal(_PLASTIC, plane.points(rectangle(direction * y, 0.56, 0.014, 0.5)))
        if builder.detail == 0:
            for y in (body.post + 0.16, max(-1.05, body.base[0] + 0.7)):
                height = _belt_at(body, y) - 0.2
                builder.box(
                    _PLASTIC, (side * 0.885 - 0.012, y - 0.09, height), (side * 0.885 + 0.012, y + 0.09, height + 0.03)
                )


MAKERS = {"car": Maker(_car, variants=4, tints=_COLOURS)}
