"""Fronts of large houses: hotel, museum, library, church."""

import numpy as np

from reasoned_explorer.rendering.lettering import disc, facing_front, rectangle, write
from reasoned_explorer.rendering.material import Material
from reasoned_explorer.rendering.mesh_builder import FAR, MeshBuilder, Surface
from reasoned_explorer.rendering.models.maker import Maker
from reasoned_explorer.rendering.models.palette import (
    BRASS,
    DARK_STEEL,
    DARK_WOOD,
    GLASS,
    LIGHT,
    LIMESTONE,
    SIGN_BLUE,
    SIGN_RED,
    SIGN_WHITE,
    plain,
)
from reasoned_explorer.rendering.models.shopfronts import add_door, add_window, draw_arch

_SANDSTONE = Surface(Material.STONE, (0.80, 0.72, 0.58))
_PLASTER = Surface(Material.PLASTER, (0.86, 0.80, 0.68))
_BRICKS = Surface(Material.BRICK, (0.62, 0.36, 0.28))
_CARPET = plain(0.60, 0.06, 0.10)
_STAINED = (
    plain(0.20, 0.35, 0.70), plain(0.75, 0.15, 0.20), plain(0.90, 0.70, 0.20), plain(0.25, 0.55, 0.35),
)  # fmt: skip


def _hotel(builder: MeshBuilder, variant: int) -> None:
    """HOTEL in letters of light with stars, a canopy over glass doors, a carpet, lit windows, flags."""
    tone = (_CARPET, plain(0.10, 0.20, 0.38))[variant]
    if builder.detail == FAR:
        builder.box(_PLASTER, (-4, 0, 0), (4, 0.08, 4))
        builder.decal(tone, facing_front(0.12).points(rectangle(0, 3.55, 7.6, 0.85)))
        builder.decal(GLASS, facing_front(0.12).points(rectangle(0, 1.4, 5.4, 1.7)))
        builder.sheet(tone, [(-1.6, 0.08, 2.75), (1.6, 0.08, 2.75), (1.6, 0.5, 2.6), (-1.6, 0.5, 2.6)])
        return
    builder.box(_PLASTER, (-4, 0, 0), (4, 0.07, 4))
    builder.box(tone, (-3.8, 0.04, 3.12), (3.8, 0.16, 3.98), bevel=0.02)
    glow = Surface(Material.GLOW, (1.0, 0.93, 0.75))
    write(builder, glow, "HOTEL", facing_front(0.172), centre=(0, 3.5), height_m=0.66)
    for place in range(4):
        u = (-3.3, -2.75, 2.75, 3.3)[place]
        builder.decal(BRASS, facing_front(0.172).points(_star(u, 3.52, 0.24)))
    for x in (-0.62, 0.62):
        add_door(builder, BRASS, width=1.2, height=2.35, x=x)
    builder.box(tone, (-1.6, 0.05, 2.55), (1.6, 0.5, 2.8), bevel=0.02)
    for x in (-1.5, 1.5):
        builder.cylinder(BRASS, (x, 0.44, 0), (x, 0.44, 2.6), 0.04, sides=8)
    builder.box(tone, (-1.1, 0.05, 0.0), (1.1, 0.5, 0.03))
    for side in (-1, 1):
        low, high = sorted((side * 1.85, side * 3.7))
        add_window(builder, SIGN_WHITE, (low, 0.8), (high, 2.45), panes=3, pane=plain(0.93, 0.80, 0.52))
        _flag(builder, side * 1.72, side)
        if builder.detail <= 1:
            builder.cylinder(
                plain(0.30, 0.32, 0.34), (side * 1.35, 0.3, 0), (side * 1.35, 0.3, 0.4), 0.13, 0.16, sides=8
            )
            builder.sphere(plain(0.16, 0.36, 0.15), (side * 1.35, 0.3, 0.62), (0.17, 0.17, 0.26), sides=8, rings=6)


def _star(u: float, v: float, size: float) -> list[tuple[float, float]]:
    outer, inner = disc(u, v, size, sides=5), disc(u, v, 0.42 * size, sides=5, turn_rad=np.pi / 5)
    return [(float(a), float(b)) for pair in zip(outer, inner, strict=True) for a, b in pair]


def _flag(builder: MeshBuilder, x: float, side: int) -> None:
    """A flag on a slanting pole."""
    builder.beam(SIGN_WHITE, (x, 0.06, 2.65), (x + 0.1 * side, 0.46, 3.1), 0.03, 0.03)
    surface = SIGN_BLUE if side < 0 else SIGN_RED
    builder.sheet(surface, [(x, 0.14, 2.72), (x + 0.1 * side, 0.44, 3.06), (x + 0.1 * side, 0.44, 2.5), (x, 0.14, 2.2)])


def _museum(builder: MeshBuilder, variant: int) -> None:
    """A temple front: steps, columns, MUSEUM on the beam, a gable; banners hang between the columns."""
    stone = (LIMESTONE, _SANDSTONE)[variant]
    dark = stone.shaded(0.72)
    if builder.detail == FAR:
        builder.box(stone, (-4, 0, 0), (4, 0.5, 0.3))
        builder.sheet(dark, facing_front(0.35).points(rectangle(0, 1.75, 7.4, 2.9)))
        builder.decal(_CARPET, facing_front(0.4).points(rectangle(0, 1.8, 1.6, 2.4)))
        builder.sheet(stone, facing_front(0.45).points([(-4, 3.2), (4, 3.2), (4, 3.8), (0, 5.0), (-4, 3.8)]))
        return
    builder.box(dark, (-3.9, 0, 0), (3.9, 0.07, 3.3))
    for step, deep in enumerate((0.5, 0.42, 0.34)):
        builder.box(stone.shaded(0.95), (-4 + 0.08 * step, 0, 0.1 * step), (4 - 0.08 * step, deep, 0.1 * (step + 1)))
    for x in (-3.4, -1.7, 1.7, 3.4):
        builder.cylinder(stone, (x, 0.27, 0.3), (x, 0.27, 3.1), 0.2, 0.165, sides=14)
        builder.box(stone, (x - 0.25, 0.05, 0.28), (x + 0.25, 0.5, 0.42))
        builder.box(stone, (x - 0.26, 0.05, 3.0), (x + 0.26, 0.5, 3.18))
    builder.box(stone, (-4, 0, 3.15), (4, 0.46, 3.8))
    write(builder, plain(0.20, 0.17, 0.13), "MUSEUM", facing_front(0.472), centre=(0, 3.47), height_m=0.48)
    builder.extrude(stone, [(-4, 3.78), (4, 3.78), (0, 5.0)], "y", 0.0, 0.42)
    builder.decal(dark, facing_front(0.432).points([(-3.2, 3.88), (3.2, 3.88), (0, 4.85)]))
    builder.beam(stone, (-4.0, 0.25, 3.82), (0, 0.25, 4.97), 0.5, 0.1)
    builder.beam(stone, (4.0, 0.25, 3.82), (0, 0.25, 4.97), 0.5, 0.1)
    if builder.detail <= 1:
        builder.decal(stone, facing_front(0.444).points(disc(0, 4.22, 0.28, sides=12)))
    add_door(builder, DARK_WOOD, width=1.5, height=2.6, leaf=plain(0.16, 0.13, 0.11))
    for place, x in enumerate((-2.55, 2.55)):
        banner = (_CARPET, SIGN_BLUE)[(place + variant) % 2]
        builder.box(banner, (x - 0.42, 0.2, 1.0), (x + 0.42, 0.23, 2.95))
        builder.box(DARK_STEEL, (x - 0.46, 0.02, 2.93), (x + 0.46, 0.26, 2.99))
        builder.decal(SIGN_WHITE, facing_front(0.242, x=x).points(disc(0, 2.2, 0.26, sides=builder.sides(14))))
        if builder.detail <= 1:
            write(builder, SIGN_WHITE, "ART", facing_front(0.242, x=x), centre=(0, 1.5), height_m=0.26)


def _library(builder: MeshBuilder, variant: int) -> None:
    """LIBRARY over arched windows with shelves of books behind them, an open book on either side of the word."""
    wall = (_BRICKS, _PLASTER)[variant]
    trim = LIMESTONE
    if builder.detail == FAR:
        builder.box(wall, (-4, 0, 0), (4, 0.3, 4))
        builder.decal(trim, facing_front(0.35).points(rectangle(0, 3.5, 7.8, 0.85)))
        for u in (-2.5, 2.5):
            builder.decal(plain(0.38, 0.28, 0.22), facing_front(0.35).points(rectangle(u, 1.75, 2.1, 2.2)))
        builder.decal(GLASS, facing_front(0.35).points(rectangle(0, 1.2, 1.3, 2.3)))
        builder.sheet(trim, [(-0.8, 0.1, 2.6), (0.8, 0.1, 2.6), (0.8, 0.5, 2.6), (-0.8, 0.5, 2.6)])
        return
    builder.box(wall, (-3.98, 0, 0), (3.98, 0.07, 4))
    builder.box(trim, (-4, 0.0, 0.0), (4, 0.14, 0.35))
    builder.box(trim, (-3.96, 0.03, 3.05), (3.96, 0.18, 3.95), bevel=0.03)
    write(builder, plain(0.13, 0.22, 0.36), "LIBRARY", facing_front(0.192), centre=(0, 3.5), height_m=0.58)
    for u in (-3.2, 3.2):
        _open_book(builder, u, 3.5)
    for x in (-3.1, -1.75, 1.75, 3.1):
        _arched_window(builder, trim, x)
    builder.box(trim, (-0.95, 0.03, 0), (0.95, 0.1, 2.75))
    add_door(builder, DARK_WOOD, width=1.3, height=2.3)
    builder.box(trim, (-1.1, 0.03, 2.6), (1.1, 0.4, 2.78), bevel=0.03)
    for step, deep in enumerate((0.5, 0.38)):
        builder.box(trim.shaded(0.9), (-1.3, 0, 0.08 * step), (1.3, deep, 0.08 * (step + 1)))
    if builder.detail <= 1:
        for x in (-0.85, 0.85):
            builder.box(LIGHT, (x - 0.08, 0.12, 1.85), (x + 0.08, 0.26, 2.15))


def _arched_window(builder: MeshBuilder, trim: Surface, x: float) -> None:
    steps = max(2, builder.sides(6))
    frame = [(u, v + 0.6) for u, v in draw_arch(x, 0.55, 1.45, 2.0, steps)]
    builder.extrude(trim, frame, "y", 0.03, 0.12)
    pane = [(-u, v + 0.68) for u, v in draw_arch(0, 0.44, 1.3, 1.74, steps)]
    builder.decal(plain(0.24, 0.17, 0.12), facing_front(0.132, x=x).points(pane[::-1]))
    if builder.detail > 1:
        return
    spines = [plain(0.62, 0.16, 0.14), plain(0.16, 0.30, 0.52), plain(0.80, 0.66, 0.36), plain(0.20, 0.42, 0.30)]
    count = 7 if builder.detail == 0 else 4
    for row in range(4):
        z = 0.78 + 0.38 * row
        builder.decal(plain(0.55, 0.38, 0.22), facing_front(0.144, x=x).points(rectangle(0, z - 0.03, 0.86, 0.04)))
        for place in range(count):
            u = -0.4 + 0.8 * (place + 0.5) / count
            high = (0.28, 0.24, 0.3, 0.26)[(place + row) % 4]
            surface = spines[(place * 3 + row) % 4]
            builder.decal(surface, facing_front(0.144, x=x).points(rectangle(u, z + high / 2, 0.62 / count, high)))


def _open_book(builder: MeshBuilder, u: float, v: float) -> None:
    if builder.detail > 1:
        return
    ink, plane = plain(0.13, 0.22, 0.36), facing_front(0.192)
    for side in (-1.0, 1.0):
        page = [(0.02, -0.22), (0.42, -0.14), (0.42, 0.24), (0.02, 0.16)]
        points = [(u + side * a, v + b) for a, b in page]
        builder.decal(ink, plane.points(points if side > 0 else points[::-1]))


def _church(builder: MeshBuilder, variant: int) -> None:
    """A gable of stone with a cross on it, a pointed portal, a round window of coloured glass."""
    stone = (_SANDSTONE, LIMESTONE)[variant]
    gable = [(-2.9, 0.0), (2.9, 0.0), (2.9, 4.0), (0.0, 6.9), (-2.9, 4.0)]
    if builder.detail == FAR:
        builder.extrude(stone, gable, "y", 0.0, 0.5)
        builder.decal(DARK_WOOD, facing_front(0.52).points([(-0.9, 0), (0.9, 0), (0, 3.3)]))
        builder.sheet(stone.shaded(0.6), [(-0.15, 0.25, 6.8), (0.15, 0.25, 6.8), (0, 0.25, 8.0)])
        return
    builder.extrude(stone, gable, "y", 0.0, 0.2)
    for side in (-1, 1):
        builder.beam(stone.shaded(0.8), (side * 2.98, 0.2, 3.98), (0, 0.2, 6.96), 0.4, 0.16)
        builder.box(stone.shaded(0.92), (side * 2.72 - 0.28, 0, 0), (side * 2.72 + 0.28, 0.5, 3.1))
        foot = [(side * 2.72 + a, b, 3.1) for a, b in ((-0.28, 0.0), (0.28, 0.0), (0.28, 0.5), (-0.28, 0.5))]
        builder.loft(stone.shaded(0.92), [foot, [(x, 0.1 if y else 0.0, 3.7) for x, y, _ in foot]], smooth=False)
    steps = (8, 5, 3)[builder.detail]
    for grow, y, surface in ((0.0, 0.3, stone.shaded(0.85)), (-0.22, 0.34, stone.shaded(0.65))):
        arch = draw_arch(0, 1.15 + grow, 1.7, 3.35 + grow, steps)
        builder.extrude(surface, arch, "y", 0.15, y)
    leaf = [(-u, v) for u, v in draw_arch(0, 0.78, 1.6, 2.9, steps)]
    builder.decal(DARK_WOOD, facing_front(0.352).points(leaf[::-1]))
    if builder.detail <= 1:
        builder.decal(plain(0.12, 0.08, 0.05), facing_front(0.364).points(rectangle(0, 1.25, 0.04, 2.5)))
        for u in (-0.12, 0.12):
            builder.decal(BRASS, facing_front(0.364).points(disc(u, 1.1, 0.05, sides=6)))
        for z in (0.5, 1.7):
            for u in (-0.42, 0.42):
                builder.decal(DARK_STEEL, facing_front(0.364).points(rectangle(u, z, 0.6, 0.06)))
    _rose(builder, stone)
    _windows_of_glass(builder, stone)
    _cross_on(builder, stone.shaded(0.75))
    for step, deep in enumerate((0.5, 0.42)):
        builder.box(stone.shaded(0.8), (-1.6, 0, 0.09 * step), (1.6, deep, 0.09 * (step + 1)))


def _rose(builder: MeshBuilder, stone: Surface) -> None:
    """The round window over the portal."""
    builder.cylinder(stone.shaded(0.85), (0, 0.15, 4.65), (0, 0.28, 4.65), 0.8, sides=20)
    petals = (12, 8, 6)[builder.detail]
    for petal in range(petals):
        a, b = (2 * np.pi * (petal + k) / petals for k in (0.06, 0.94))
        wedge = [(0.15 * np.cos(a), 0.15 * np.sin(a)), (0.62 * np.cos(a), 0.62 * np.sin(a)),
                 (0.62 * np.cos(b), 0.62 * np.sin(b)), (0.15 * np.cos(b), 0.15 * np.sin(b))]  # fmt: skip
        surface = _STAINED[petal % len(_STAINED)]
        builder.decal(surface, facing_front(0.292).points([(u, v + 4.65) for u, v in wedge]))


def _windows_of_glass(builder: MeshBuilder, stone: Surface) -> None:
    """A narrow pointed window on either side of the portal."""
    steps = (5, 3, 2)[builder.detail]
    for x in (-1.85, 1.85):
        frame = [(u, v + 1.0) for u, v in draw_arch(x, 0.34, 1.5, 2.2, steps)]
        builder.extrude(stone.shaded(0.85), frame, "y", 0.15, 0.25)
        pane = [(-u, v + 1.08) for u, v in draw_arch(0, 0.24, 1.4, 1.95, steps)]
        builder.decal(_STAINED[0], facing_front(0.262, x=x).points(pane[::-1]))
        if builder.detail <= 1:
            for row, z in enumerate((1.35, 1.8, 2.25)):
                surface = _STAINED[1 + row % 3]
                builder.decal(surface, facing_front(0.274, x=x).points(disc(0, z, 0.17, sides=4)))


def _cross_on(builder: MeshBuilder, surface: Surface) -> None:
    """The cross on the tip of the gable."""
    builder.box(surface, (-0.3, 0.0, 6.75), (0.3, 0.44, 7.02))
    builder.box(surface, (-0.08, 0.12, 7.0), (0.08, 0.28, 8.0))
    builder.box(surface, (-0.36, 0.12, 7.5), (0.36, 0.28, 7.66))


MAKERS = {
    "hotel": Maker(_hotel, variants=2, relief_m=0.142),
    "museum": Maker(_museum, variants=2, relief_m=0.148),
    "library": Maker(_library, variants=2, relief_m=0.154),
    "church": Maker(_church, variants=2, relief_m=0.160),
}
