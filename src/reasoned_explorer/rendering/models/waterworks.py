"""What water comes out of: fire hydrants, fountains, drinking fountains."""

import math
from functools import lru_cache

import numpy as np

from reasoned_explorer.rendering.lettering import Plane, write
from reasoned_explorer.rendering.mesh import Model
from reasoned_explorer.rendering.mesh_builder import FAR, MeshBuilder, Surface
from reasoned_explorer.rendering.models.maker import Maker
from reasoned_explorer.rendering.models.palette import (
    BRONZE,
    CHROME,
    GRANITE,
    IRON,
    LIMESTONE,
    SIGN_WHITE,
    SPRAY,
    STEEL,
    WATER,
    plain,
)
from reasoned_explorer.rendering.shelf import kept_model

_RED = plain(0.83, 0.08, 0.07)
_YELLOW = plain(0.97, 0.76, 0.08)
_HYDRANT_LOOKS = ((_RED, _YELLOW), (_YELLOW, STEEL), (_RED, SIGN_WHITE))


def _fire_hydrant(builder: MeshBuilder, variant: int) -> None:
    """A hydrant with a domed bonnet, two side outlets, one in front, and flanges with bolts."""
    body, caps = _HYDRANT_LOOKS[variant]
    if builder.detail == FAR:
        builder.cylinder(body, (0, 0, 0), (0, 0, 0.62), 0.12, 0.11, sides=13, capped=False)
        builder.cylinder(body, (0, 0, 0.62), (0, 0, 0.8), 0.13, 0.0, sides=13, capped=False)
        builder.sheet(caps, [(-0.175, 0.02, 0.42), (0.175, 0.02, 0.42), (0.175, 0.02, 0.58), (-0.175, 0.02, 0.58)])
        builder.sheet(caps, [(0, -0.175, 0.42), (0, 0.175, 0.42), (0, 0.175, 0.56), (0, -0.175, 0.56)])
        return
    profile = [(0.165, 0.0), (0.165, 0.045), (0.115, 0.06), (0.105, 0.1), (0.105, 0.3), (0.1, 0.58)]
    if builder.detail == 2:
        _small_hydrant(builder, body, caps)
        return
    builder.lathe(body, profile, sides=18)
    if builder.detail <= 1:
        builder.lathe(body, [(0.138, 0.29), (0.138, 0.33)], sides=18)
    builder.lathe(body, [(0.14, 0.575), (0.14, 0.61), (0.12, 0.625)], sides=18)
    builder.lathe(body, [(0.122, 0.62), (0.112, 0.675), (0.082, 0.72), (0.035, 0.745), (0.0, 0.75)], sides=16)
    builder.cylinder(caps, (0, 0, 0.74), (0, 0, 0.8), 0.035, 0.028, sides=5, smooth=False)
    for x in (-1.0, 1.0):
        builder.cylinder(body, (0.08 * x, 0, 0.47), (0.135 * x, 0, 0.47), 0.055, sides=12)
        builder.cylinder(caps, (0.13 * x, 0, 0.47), (0.165 * x, 0, 0.47), 0.062, 0.055, sides=12)
        if builder.detail <= 1:
            builder.cylinder(caps, (0.16 * x, 0, 0.47), (0.18 * x, 0, 0.47), 0.022, sides=5, smooth=False)
    builder.cylinder(body, (0, 0.08, 0.44), (0, 0.14, 0.44), 0.075, sides=14)
    builder.cylinder(caps, (0, 0.135, 0.44), (0, 0.175, 0.44), 0.085, 0.078, sides=14)
    builder.box(body.shaded(0.8), (-0.06, -0.175, 0.4), (0.06, -0.08, 0.48))
    if builder.detail == 0:
        builder.cylinder(caps, (0, 0.17, 0.44), (0, 0.195, 0.44), 0.028, sides=5, smooth=False)
        for turn in range(8):
            angle = math.radians(45 * turn + 22)
            east, north = math.sin(angle), math.cos(angle)
            for reach, low, high in ((0.142, 0.04, 0.065), (0.122, 0.325, 0.345)):
                at = (reach * east, reach * north)
                builder.cylinder(IRON, (*at, low), (*at, high), 0.013, sides=5)


def _small_hydrant(builder: MeshBuilder, body: Surface, caps: Surface) -> None:
    """A hydrant for some way off, in about eighty triangles."""
    profile = [(0.165, 0.0), (0.11, 0.06), (0.1, 0.57), (0.14, 0.59), (0.11, 0.68), (0.0, 0.76)]
    builder.lathe(body, profile, sides=13)
    builder.cylinder(caps, (0, 0, 0.74), (0, 0, 0.8), 0.032, sides=8, capped=False)
    builder.cylinder(caps, (-0.175, 0, 0.47), (0.175, 0, 0.47), 0.06, sides=13)
    builder.cylinder(caps, (0, -0.175, 0.44), (0, 0.175, 0.44), 0.08, sides=13)


def _fountain(builder: MeshBuilder, variant: int) -> None:
    """A basin of stone with water in it; in its middle bowls on a column, or jets, and water that leaps in arcs."""
    stone = (LIMESTONE, GRANITE)[variant % 2]
    sides = (28, 8)[variant % 2]
    if builder.detail == FAR:
        builder.cylinder(stone, (0, 0, 0), (0, 0, 0.62), 2.5, sides=17, capped=False)
        ring = [(2.4 * math.cos(a), 2.4 * math.sin(a), 0.56) for a in (np.arange(5) + 0.5) * 2 * math.pi / 5]
        builder.decal(WATER, ring)
        builder.cylinder(stone.shaded(1.1), (0, 0, 0.45), (0, 0, 2.5), 0.4, 0.1, sides=10, capped=False)
        builder.card(SPRAY, (0, 0, 0.5), 2.2, 1.3, 0.7)
        return
    count = max(8, builder.sides(sides)) if sides > 8 else 8
    profile = [(2.5, 0.0), (2.5, 0.08), (2.38, 0.12), (2.38, 0.48), (2.5, 0.54), (2.5, 0.62), (2.12, 0.62), (2.12, 0.1)]
    if builder.detail == 2:
        profile = [(2.5, 0.0), (2.45, 0.62), (2.12, 0.62), (2.12, 0.1)]
    _ring_of(builder, stone, profile, count)
    builder.lathe(WATER, [(2.13, 0.3), (2.13, 0.46)], sides=sides)
    if variant < 2:
        _bowls(builder, stone)
    else:
        _statue_column(builder, stone)
    jets = (12, 8, 4)[builder.detail]
    for turn in range(jets):
        _jet(builder, 2 * math.pi * (turn + 0.5) / jets, start=(0.42, 1.62), peak=2.02, end=1.6)


def _ring_of(builder: MeshBuilder, surface: Surface, profile: list[tuple[float, float]], count: int) -> None:
    """A wall around the axis: a closed profile turned about it."""
    angles = (np.arange(count) + 0.5) * 2 * math.pi / count
    rings = [[(r * math.cos(a), r * math.sin(a), z) for r, z in profile] for a in angles]
    builder.loft(surface, rings, smooth=False, closed=True)


def _bowls(builder: MeshBuilder, stone: Surface) -> None:
    builder.lathe(stone, [(0.5, 0.1), (0.5, 0.55), (0.3, 0.65), (0.2, 0.9), (0.24, 1.15), (0.34, 1.28)], sides=12)
    builder.lathe(stone, [(0.2, 1.24), (0.62, 1.36), (0.95, 1.55), (0.98, 1.6), (0.9, 1.6), (0.6, 1.5)], sides=18)
    builder.lathe(WATER, [(0.9, 1.54), (0.9, 1.575)], sides=18)
    builder.lathe(stone, [(0.16, 1.55), (0.1, 1.75), (0.14, 1.95)], sides=10)
    builder.lathe(stone, [(0.08, 1.93), (0.3, 2.0), (0.42, 2.1), (0.38, 2.12)], sides=14)
    builder.lathe(stone, [(0.08, 2.1), (0.12, 2.24), (0.05, 2.34)], sides=8)
    builder.cylinder(SPRAY, (0, 0, 2.3), (0, 0, 2.5), 0.035, 0.0, sides=6)
    if builder.detail <= 1:
        for turn in range(8):
            angle = math.radians(45 * turn)
            x, y = math.cos(angle), math.sin(angle)
            builder.cylinder(SPRAY, (0.97 * x, 0.97 * y, 1.58), (1.06 * x, 1.06 * y, 0.45), 0.018, 0.035, sides=4)


def _statue_column(builder: MeshBuilder, stone: Surface) -> None:
    """A column with a bronze ball on it and a basin half way up."""
    builder.lathe(stone, [(0.55, 0.1), (0.55, 0.6), (0.42, 0.66), (0.36, 1.3)], sides=8, smooth=False)
    builder.lathe(stone, [(0.36, 1.3), (0.75, 1.5), (0.8, 1.6), (0.7, 1.6)], sides=16)
    builder.lathe(stone, [(0.26, 1.58), (0.2, 1.7), (0.2, 1.95), (0.3, 2.02)], sides=10)
    builder.sphere(BRONZE, (0, 0, 2.25), 0.25, sides=14, rings=8)


def _jet(builder: MeshBuilder, angle: float, *, start: tuple[float, float], peak: float, end: float) -> None:
    """Water that leaps outward in an arc into the basin."""
    share = np.linspace(0.0, 1.0, (7, 5, 4)[builder.detail])
    reach = start[0] + (end - start[0]) * share
    rise, drop = peak - start[1], start[1] - 0.44
    # A parabola through the start, with its peak where the rise says, to the water.
    at_peak = math.sqrt(rise) / (math.sqrt(rise) + math.sqrt(rise + drop))
    height = peak - rise * ((share - at_peak) / at_peak) ** 2
    points = np.column_stack([reach * math.cos(angle), reach * math.sin(angle), height])
    builder.tube(SPRAY, points, np.linspace(0.018, 0.045, len(share)), sides=4)


def _drinking_water(builder: MeshBuilder, variant: int) -> None:
    """A pedestal with a bowl and an arc of water; or a post of cast iron with a tap over a basin."""
    stone = (GRANITE, plain(0.09, 0.32, 0.24))[variant]
    if builder.detail == FAR:
        builder.cylinder(stone, (0, 0, 0), (0, 0, 0.8), 0.2, 0.13, sides=13, capped=False)
        builder.cylinder(STEEL, (0, 0, 0.78), (0, 0, 0.9), 0.14, 0.25, sides=13)
        builder.card(SPRAY, (0, 0.05, 0.88), 0.06, 0.12)
        return
    if variant == 0:
        builder.lathe(stone, [(0.2, 0.0), (0.2, 0.06), (0.13, 0.1), (0.11, 0.5), (0.16, 0.78)], sides=16)
        builder.lathe(STEEL, [(0.13, 0.74), (0.24, 0.84), (0.25, 0.9), (0.225, 0.9), (0.12, 0.84)], sides=18)
        builder.lathe(WATER, [(0.19, 0.865), (0.19, 0.875)], sides=16)
        builder.tube(CHROME, [(0, -0.17, 0.86), (0, -0.17, 0.97), (0, -0.12, 1.0), (0, -0.07, 0.97)], 0.018)
        arc = [(0, -0.06 + 0.05 * k, 0.97 + 0.03 * math.sin(math.pi * k / 4) - 0.025 * k) for k in range(5)]
        builder.tube(SPRAY, arc, 0.014, sides=5)
        builder.cylinder(CHROME, (0.16, 0.1, 0.86), (0.16, 0.1, 0.91), 0.03, sides=8)
        return
    builder.lathe(stone, [(0.15, 0.0), (0.15, 0.05), (0.1, 0.08), (0.08, 0.8), (0.11, 0.84), (0.1, 0.9)], (0, -0.1, 0))
    builder.sphere(stone, (0, -0.1, 0.92), 0.08, sides=12, rings=6)
    builder.lathe(stone, [(0.1, 0.0), (0.07, 0.1), (0.1, 0.36), (0.24, 0.46), (0.25, 0.5), (0.22, 0.5)], (0, 0.03, 0))
    builder.lathe(WATER, [(0.22, 0.47), (0.22, 0.485)], (0, 0.03, 0))
    builder.tube(CHROME, [(0, -0.05, 0.76), (0, 0.04, 0.78), (0, 0.08, 0.72)], 0.022)
    builder.cylinder(SPRAY, (0, 0.08, 0.74), (0, 0.08, 0.47), 0.012, 0.018, sides=5)


@lru_cache(maxsize=1)
def hydrant_lid() -> Model:
    """Return the lid of a hydrant below the ground: an oval iron lid with an H, in a ring of red paint."""

    def make(builder: MeshBuilder, variant: int) -> None:
        del variant
        builder.lathe(_RED, [(0.36, 0.0), (0.35, 0.016)], sides=20, stretch=(1.0, 0.8))
        builder.lathe(IRON, [(0.26, 0.0), (0.24, 0.035)], sides=16, stretch=(1.0, 0.72))
        if builder.detail < FAR:
            flat = Plane((0.0, 0.0, 0.046), (-1.0, 0.0, 0.0), (0.0, -1.0, 0.0))
            write(builder, _YELLOW, "H", flat, centre=(0.0, 0.0), height_m=0.2)

    lid = Maker(make, scaling="none", fits="none")
    return kept_model("hydrant-lid", lambda: lid.model(0, (0.7, 0.6, 0.05)))


MAKERS = {
    "fire_hydrant": Maker(_fire_hydrant, variants=3, scaling="uniform"),
    "fountain": Maker(_fountain, variants=3),
    "drinking_water": Maker(_drinking_water, variants=2, scaling="uniform"),
}
