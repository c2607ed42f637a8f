"""Parts of the fronts of places: a panel on the wall with a door, windows, an awning and a sign.

A front's wall is at y = 0 and its door in the middle.
"""

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from reasoned_explorer.rendering.lettering import Plane, disc, facing_front, facing_side, line, rectangle, write
from reasoned_explorer.rendering.mesh_builder import FAR, MeshBuilder, Surface
from reasoned_explorer.rendering.models.palette import BRASS, DARK_STEEL, GLASS, SIGN_WHITE, plain

_PANEL_M = 0.07
_INSIDE = plain(0.20, 0.17, 0.14)


@dataclass(frozen=True, slots=True)
class Front:
    """The looks of a front.

    Attributes:
        width_m: Across.
        height_m: From the ground.
        wall: The panel.
        trim: Frames of windows and door.
        sign: The sign board.
        ink: The letters on it.
        word: What it says.
        letter_m: Height of the letters.
        awning: Two colours of its stripes, or none.
        pane: What windows and doors look like from afar.
    """

    width_m: float
    height_m: float
    wall: Surface
    trim: Surface
    sign: Surface
    ink: Surface
    word: str
    letter_m: float
    awning: tuple[Surface, Surface] | None = None
    pane: Surface = GLASS

    @property
    def sign_m(self) -> float:
        """Height of the sign board, metres."""
        return self.letter_m + 0.16


def add_front(builder: MeshBuilder, front: Front) -> None:
    """Add panel, door, two windows, sign and awning; at `FAR`, all of it in at most 24 triangles."""
    half, high = front.width_m / 2.0, front.height_m
    if builder.detail == FAR:
        add_far_front(builder, front)
        return
    builder.box(front.wall, (-half, 0.0, 0.0), (half, _PANEL_M, high))
    add_sign(builder, front)
    add_door(builder, front.trim, width=1.2, height=2.12)
    inner, outer = 0.85, half - 0.25
    for side in (-1, 1):
        low, top = sorted((side * inner, side * outer))
        add_window(builder, front.trim, (low, 0.5), (top, 2.15))
    if front.awning:
        add_awning(builder, front.awning, half, high - front.sign_m)


def add_far_front(builder: MeshBuilder, front: Front) -> None:
    """Add a front for afar: panel, sign, dark windows, awning."""
    half, high = front.width_m / 2.0, front.height_m
    builder.box(front.wall, (-half, 0.0, 0.0), (half, _PANEL_M if front.awning else 0.3, high))
    y = _PANEL_M + 0.05 if front.awning else 0.35
    ink = 0.12
    mixed = tuple((1 - ink) * a + ink * b for a, b in zip(front.sign.colour, front.ink.colour, strict=True))
    board = Surface(front.sign.material, (mixed[0], mixed[1], mixed[2]))
    plane = facing_front(y)
    builder.decal(board, plane.points(rectangle(0, high - front.sign_m / 2, 1.9 * half, front.sign_m)))
    builder.decal(front.pane, plane.points(rectangle(0, 1.2, 1.7 * half, 1.7)))
    if front.awning:
        first, second = front.awning
        mean = tuple(0.5 * a + 0.5 * b for a, b in zip(first.colour, second.colour, strict=True))
        drop = high - front.sign_m
        surface = Surface(first.material, (mean[0], mean[1], mean[2]))
        corners = [(-half, 0.08, drop), (half, 0.08, drop), (half, 0.5, drop - 0.45), (-half, 0.5, drop - 0.45)]
        builder.sheet(surface, corners)
    else:
        builder.sheet(front.trim, [(-0.6, 0.12, 2.2), (0.6, 0.12, 2.2), (0.6, 0.5, 2.2), (-0.6, 0.5, 2.2)])


def add_sign(builder: MeshBuilder, front: Front) -> None:
    """Add the board along the top with its word."""
    half, top = 0.97 * front.width_m / 2.0, front.height_m - 0.02
    builder.box(front.sign, (-half, 0.04, top - front.sign_m), (half, 0.16, top), bevel=0.02)
    plane = facing_front(0.172)
    write(builder, front.ink, front.word, plane, centre=(0.0, top - front.sign_m / 2), height_m=front.letter_m)


def add_door(
    builder: MeshBuilder, frame: Surface, *, width: float, height: float, leaf: Surface = GLASS, x: float = 0.0
) -> None:
    """Add a door with a frame, a pane (or a leaf), a handle and a step."""
    half, y = width / 2.0, 0.12
    builder.box(frame, (x - half, 0.03, 0.0), (x + half, y, height))
    plane = facing_front(y + 0.012, x=x)
    builder.decal(leaf, plane.points(rectangle(0.0, height / 2 + 0.12, width - 0.2, height - 0.4)))
    if builder.detail <= 1:
        builder.box(DARK_STEEL, (x - half - 0.1, 0.0, 0.0), (x + half + 0.1, 0.3, 0.05))
        builder.box(BRASS, (x - half + 0.14, y, 0.95), (x - half + 0.18, y + 0.06, 1.3))


def add_window(
    builder: MeshBuilder,
    frame: Surface,
    low: tuple[float, float],
    high: tuple[float, float],
    *,
    panes: int = 2,
    pane: Surface = GLASS,
) -> None:
    """Add a window between two corners (x, z) with a frame and bars."""
    (x0, z0), (x1, z1) = low, high
    builder.box(frame, (x0 - 0.07, 0.03, z0 - 0.07), (x1 + 0.07, 0.11, z1 + 0.07))
    x, width = (x0 + x1) / 2, x1 - x0
    plane = facing_front(0.122, x=x)
    builder.decal(pane, plane.points(rectangle(0, (z0 + z1) / 2, width, z1 - z0)))
    if builder.detail <= 1:
        for bar in range(1, panes):
            at = -width / 2 + width * bar / panes
            builder.decal(frame, facing_front(0.134, x=x).points(rectangle(at, (z0 + z1) / 2, 0.06, z1 - z0)))
        builder.box(frame, (x0 - 0.1, 0.03, z0 - 0.13), (x1 + 0.1, 0.2, z0 - 0.06))


def add_awning(builder: MeshBuilder, surfaces: tuple[Surface, Surface], half: float, top: float) -> None:
    """Add a striped awning with a scalloped edge, from the wall out to 0.5 m."""
    stripes = (max(6, round(half * 4)), max(4, round(half * 2)), 4)[builder.detail]
    edges = np.linspace(-half, half, stripes + 1).tolist()
    for place, (a, b) in enumerate(pairwise(edges)):
        surface, low = surfaces[place % 2], top - 0.42
        builder.sheet(surface, [(a, 0.08, top), (b, 0.08, top), (b, 0.5, low), (a, 0.5, low)])
        if builder.detail == 0:
            tip = [(a, 0.5, low - 0.1), ((a + b) / 2, 0.5, low - 0.2), (b, 0.5, low - 0.1)]
            builder.sheet(surface, [(a, 0.5, low), *tip, (b, 0.5, low)])
        else:
            builder.sheet(surface, [(a, 0.5, low), (a, 0.5, low - 0.15), (b, 0.5, low - 0.15), (b, 0.5, low)])


def add_display(builder: MeshBuilder, colours: list[Surface], half: float) -> None:
    """Add goods behind the two windows: boxes of bright colours on a shelf."""
    if builder.detail > 1:
        return
    inner, outer = 0.95, half - 0.35
    count = 5 if builder.detail == 0 else 3
    for side in (-1, 1):
        for row, z in enumerate((0.6, 1.25)):
            for place in range(count):
                surface = colours[(place + 2 * row + (side > 0)) % len(colours)]
                x = side * (inner + (outer - inner) * (place + 0.5) / count)
                wide = (outer - inner) / count * 0.7
                high = (0.32, 0.42, 0.26)[(place + row) % 3]
                builder.decal(surface, facing_front(0.13, x=x).points(rectangle(0, z + high / 2, wide, high)))


def add_blade(builder: MeshBuilder, board: Surface, *, x: float, z: float, size: float = 0.42) -> tuple[Plane, Plane]:
    """Add a sign that stands out from the wall; returns the planes on its two faces, v = 0 at its middle."""
    builder.box(board, (x - 0.03, 0.08, z - size / 2), (x + 0.03, 0.48, z + size / 2))
    right, left = facing_side(1.0), facing_side(-1.0)
    return (
        Plane((x + 0.042, 0.28, z), right.right, right.up),
        Plane((x - 0.042, 0.28, z), left.right, left.up),
    )


def draw_cup(builder: MeshBuilder, plane: Plane, centre: tuple[float, float], size: float, ink: Surface) -> None:
    """Draw a cup of coffee with steam."""
    if builder.detail > 1:
        return
    (u, v), k = centre, size
    bowl = [(-0.38, 0.1), (-0.28, -0.3), (0.18, -0.3), (0.28, 0.1)]
    builder.decal(ink, plane.points([(u + a * k, v + b * k) for a, b in bowl]))
    for bar in line([(0.25, 0.02), (0.46, 0.0), (0.44, -0.18), (0.2, -0.2)], 0.09):
        builder.decal(ink, plane.points(np.array([u, v]) + k * bar))
    builder.decal(ink, plane.points(rectangle(u - 0.05 * k, v - 0.4 * k, 0.9 * k, 0.08 * k)))
    for at in (-0.22, -0.02, 0.18):
        for bar in line([(at, 0.18), (at + 0.06, 0.3), (at - 0.02, 0.42)], 0.06):
            builder.decal(ink, plane.points(np.array([u, v]) + k * bar))


def draw_cutlery(builder: MeshBuilder, plane: Plane, centre: tuple[float, float], size: float, ink: Surface) -> None:
    """Draw a fork and a knife."""
    if builder.detail > 1:
        return
    (u, v), k = centre, size
    for bar in ((-0.2, -0.15, 0.08, 0.6), (-0.2, 0.1, 0.3, 0.08), (0.2, -0.15, 0.09, 0.6)):
        builder.decal(ink, plane.points(rectangle(u + bar[0] * k, v + bar[1] * k, bar[2] * k, bar[3] * k)))
    for tine in (-0.32, -0.2, -0.08):
        builder.decal(ink, plane.points(rectangle(u + tine * k, v + 0.28 * k, 0.06 * k, 0.36 * k)))
    blade = [(0.15, 0.1), (0.26, 0.1), (0.3, 0.3), (0.24, 0.46), (0.15, 0.46)]
    builder.decal(ink, plane.points([(u + a * k, v + b * k) for a, b in blade]))


def draw_mug(builder: MeshBuilder, plane: Plane, centre: tuple[float, float], size: float, ink: Surface) -> None:
    """Draw a mug of beer with foam."""
    if builder.detail > 1:
        return
    (u, v), k = centre, size
    builder.decal(ink, plane.points(rectangle(u - 0.05 * k, v - 0.08 * k, 0.5 * k, 0.66 * k)))
    for bar in line([(0.18, 0.16), (0.42, 0.12), (0.42, -0.2), (0.18, -0.26)], 0.09):
        builder.decal(ink, plane.points(np.array([u, v]) + k * bar))
    for at in (-0.24, -0.05, 0.14):
        builder.decal(SIGN_WHITE, plane.nearer(0.01).points(disc(u + at * k, v + 0.28 * k, 0.15 * k, sides=8)))


def draw_person(
    builder: MeshBuilder, plane: Plane, foot: tuple[float, float], height: float, ink: Surface, *, skirt: bool
) -> None:
    """Draw the figure of a man or of a woman, as on the door of a toilet."""
    (u, v), k = foot, height
    builder.decal(ink, plane.points(disc(u, v + 0.9 * k, 0.1 * k, sides=8 if builder.detail <= 1 else 4)))
    if skirt:
        shape = [(-0.1, 0.76), (-0.28, 0.28), (0.28, 0.28), (0.1, 0.76)]
    else:
        shape = [(-0.19, 0.76), (-0.19, 0.36), (0.19, 0.36), (0.19, 0.76)]
    builder.decal(ink, plane.points([(u + a * k, v + b * k) for a, b in shape]))
    for leg in (-0.08, 0.08):
        builder.decal(ink, plane.points(rectangle(u + leg * k, v + 0.18 * k, 0.11 * k, 0.38 * k)))


def draw_arch(x: float, half: float, spring: float, top: float, steps: int) -> list[tuple[float, float]]:
    """Return the outline of an arched opening, (x, z) counter-clockwise, from its lower corners at z = 0.

    Args:
        x: Its middle.
        half: Half its width.
        spring: Where the arch begins.
        top: Its highest point; a pointed arch where that is more than half the width above the spring.
        steps: Pieces of each side of the arch.
    """
    rise = top - spring
    # Two arcs that meet in the middle: a half circle when rise = half.
    radius = (half**2 + rise**2) / (2.0 * half)
    reach = math.atan2(rise, radius - half) if rise > half else math.pi / 2.0
    angles = np.linspace(0.0, reach, steps + 1)
    if rise > half:
        right = [(x + half - radius + radius * math.cos(a), spring + radius * math.sin(a)) for a in angles]
    else:
        right = [(x + half * math.cos(a), spring + rise * math.sin(a)) for a in angles]
    left = [(2 * x - u, v) for u, v in reversed(right[:-1])]
    return [(x - half, 0.0), (x + half, 0.0), *right, *left]
