"""What stands on a post: lamps, bollards, flags, clocks, meters, chargers."""

import math

import numpy as np

from reasoned_explorer.rendering.lettering import (
    disc,
    facing_back,
    facing_front,
    facing_side,
    line,
    rectangle,
    write,
)
from reasoned_explorer.rendering.mesh_builder import FAR, MeshBuilder
from reasoned_explorer.rendering.models.maker import Maker
from reasoned_explorer.rendering.models.palette import (
    BLACK,
    BRASS,
    DARK_STEEL,
    IRON,
    LIGHT,
    SIGN_BLUE,
    SIGN_GREEN,
    SIGN_RED,
    SIGN_WHITE,
    SIGN_YELLOW,
    STEEL,
    fabric,
    plain,
)


def _street_lamp(builder: MeshBuilder, variant: int) -> None:
    (_lamp_with_arm, _lantern, _lamp_with_globes)[variant](builder)


def _lamp_with_arm(builder: MeshBuilder) -> None:
    """A tapered mast whose arm bends forward over the street, with a flat lamp at its end."""
    if builder.detail == FAR:
        builder.cylinder(STEEL, (0, 0, 0), (0, 0, 5.9), 0.12, 0.06, sides=10, capped=False)
        builder.beam(STEEL, (0, 0, 5.85), (0, 1.78, 5.94), 0.28, 0.12)
        return
    builder.cylinder(DARK_STEEL, (0, 0, 0), (0, 0, 0.9), 0.125, 0.11, sides=10)
    builder.cylinder(STEEL, (0, 0, 0.85), (0, 0, 5.3), 0.085, 0.055, sides=10)
    bend = [(0, 0.0, 5.25), (0, 0.06, 5.6), (0, 0.28, 5.82), (0, 0.7, 5.9), (0, 1.15, 5.92)]
    builder.tube(STEEL, bend[:: 1 if builder.detail == 0 else 2], 0.045, sides=8)
    outline = [(1.05, 5.88), (1.7, 5.89), (1.78, 5.93), (1.6, 6.0), (1.1, 5.98)]
    builder.extrude(DARK_STEEL, outline, "x", -0.14, 0.14)
    builder.decal(LIGHT, [(-0.11, 1.15, 5.872), (-0.11, 1.66, 5.878), (0.11, 1.66, 5.878), (0.11, 1.15, 5.872)])
    if builder.detail <= 1:
        builder.box(STEEL, (-0.04, -0.124, 0.4), (0.04, -0.09, 0.8))


def _lantern(builder: MeshBuilder) -> None:
    """A post of cast iron with a lantern of four panes under a pointed roof."""
    if builder.detail == FAR:
        builder.cylinder(IRON, (0, 0, 0), (0, 0, 5.1), 0.09, 0.05, sides=10, capped=False)
        builder.box(LIGHT.shaded(0.9), (-0.2, -0.2, 5.05), (0.2, 0.2, 5.65))
        builder.cylinder(IRON, (0, 0, 5.6), (0, 0, 6.0), 0.36, 0.0, sides=13, capped=False)
        return
    profile = [(0.125, 0.0), (0.125, 0.12), (0.1, 0.18), (0.11, 0.7), (0.075, 0.85), (0.05, 3.4), (0.045, 5.0)]
    builder.lathe(IRON, profile, sides=10)
    if builder.detail <= 1:
        for z in (0.95, 3.3, 4.75):
            builder.lathe(IRON, [(0.05, z - 0.06), (0.095, z), (0.05, z + 0.06)], sides=8)
        builder.beam(IRON, (-0.35, 0, 4.55), (0.35, 0, 4.55), 0.035, 0.035)
    builder.lathe(IRON, [(0.05, 4.98), (0.17, 5.06), (0.17, 5.09)], sides=4, smooth=False)
    builder.cylinder(LIGHT, (0, 0, 5.08), (0, 0, 5.6), 0.17, 0.28, sides=4 if builder.detail == 0 else 10, smooth=False)
    if builder.detail <= 1:
        for turn in range(4):
            x, y = math.cos(math.pi * (turn + 0.5) / 2), math.sin(math.pi * (turn + 0.5) / 2)
            builder.beam(IRON, (0.172 * x, 0.172 * y, 5.06), (0.285 * x, 0.285 * y, 5.62), 0.03, 0.03, up=(x, y, 0))
    builder.cylinder(IRON, (0, 0, 5.59), (0, 0, 5.63), 0.33, sides=4 if builder.detail == 0 else 10, smooth=False)
    builder.cylinder(IRON, (0, 0, 5.62), (0, 0, 5.88), 0.31, 0.07, sides=4 if builder.detail == 0 else 10, smooth=False)
    builder.cylinder(IRON, (0, 0, 5.87), (0, 0, 6.0), 0.05, 0.01, sides=6)


def _lamp_with_globes(builder: MeshBuilder) -> None:
    """A dark post that carries two white globes on a crossbar."""
    post = plain(0.10, 0.20, 0.17)
    if builder.detail == FAR:
        builder.cylinder(post, (0, 0, 0), (0, 0, 5.6), 0.09, 0.05, sides=10, capped=False)
        for x in (-0.5, 0.5):
            builder.cylinder(LIGHT, (x, 0, 5.58), (x, 0, 6.0), 0.2, 0.14, sides=10, capped=False)
        builder.card(post, (0, 0, 5.5), 1.0, 0.1)
        return
    builder.lathe(post, [(0.125, 0.0), (0.12, 0.5), (0.07, 0.62), (0.05, 5.5), (0.02, 5.75)], sides=10)
    arch = [(-0.5, 0, 5.6), (-0.45, 0, 5.45), (-0.2, 0, 5.4), (0.0, 0, 5.35)]
    for side in (1, -1):
        builder.tube(post, [(side * x, y, z) for x, y, z in arch], 0.03, sides=6)
        builder.cylinder(post, (side * 0.5, 0, 5.57), (side * 0.5, 0, 5.63), 0.1, sides=8)
        builder.sphere(LIGHT, (side * 0.5, 0, 5.8), 0.2, sides=12, rings=8)


def _bollard(builder: MeshBuilder, variant: int) -> None:
    """A post with a rounded head and bright bands, of iron or painted red and white."""
    body, band = ((IRON, SIGN_WHITE), (SIGN_WHITE, SIGN_RED), (STEEL, SIGN_YELLOW))[variant]
    if builder.detail == FAR:
        builder.cylinder(body, (0, 0, 0), (0, 0, 0.9), 0.08, 0.08, sides=13)
        builder.cylinder(band, (0, 0, 0.6), (0, 0, 0.74), 0.082, sides=13, capped=False)
        return
    builder.lathe(body, [(0.1, 0.0), (0.1, 0.08), (0.075, 0.12), (0.072, 0.56)], sides=14)
    builder.lathe(band, [(0.073, 0.56), (0.073, 0.72)], sides=14)
    builder.lathe(
        body, [(0.072, 0.72), (0.072, 0.78), (0.095, 0.8), (0.085, 0.86), (0.045, 0.892), (0.0, 0.9)], sides=14
    )
    if variant == 1:
        builder.lathe(band, [(0.075, 0.24), (0.075, 0.4)], sides=14)


_FLAGS = (
    (plain(0.07, 0.07, 0.08), plain(0.80, 0.06, 0.10), plain(0.98, 0.80, 0.08)),
    (fabric(0.06, 0.24, 0.60), fabric(0.94, 0.94, 0.94), fabric(0.80, 0.08, 0.12)),
    (fabric(0.05, 0.45, 0.22), fabric(0.95, 0.95, 0.93), fabric(0.05, 0.45, 0.22)),
)


def _flagpole(builder: MeshBuilder, variant: int) -> None:
    """A white pole with a golden knob and a flag of three bands that waves to one side."""
    pole = plain(0.90, 0.90, 0.89)
    bands = _FLAGS[variant]
    sides = 10
    builder.cylinder(pole, (0, 0, 0), (0, 0, 7.9), 0.06, 0.035, sides=sides, capped=builder.detail < FAR)
    steps = (9, 6, 3, 2)[builder.detail]
    x = np.linspace(0.0, 1.9, steps)
    wave = 0.14 * np.sin(x * 4.0) * np.minimum(x, 1.0)
    for place, surface in enumerate(bands):
        top, low = 7.75 - 0.4 * place, 7.35 - 0.4 * place
        for k in range(steps - 1):
            droop = 0.10 * x[k : k + 2]
            (a, b), (ya, yb) = x[k : k + 2], wave[k : k + 2]
            corners = [(a, ya, low - droop[0]), (b, yb, low - droop[1]), (b, yb, top - droop[1])]
            builder.sheet(surface, [*corners, (a, ya, top - droop[0])])
    if builder.detail < FAR:
        builder.cylinder(DARK_STEEL, (0, 0, 0), (0, 0, 0.25), 0.1, 0.09, sides=12)
        builder.sphere(BRASS, (0, 0, 7.93), 0.07, sides=8, rings=6)


def _clock(builder: MeshBuilder, variant: int) -> None:
    """A post with a round clock, read from ahead and from behind, hands at ten past ten."""
    body = (IRON, plain(0.09, 0.26, 0.19))[variant]
    if builder.detail == FAR:
        builder.cylinder(body, (0, 0, 0), (0, 0, 3.0), 0.07, 0.06, sides=10, capped=False)
        builder.box(body, (-0.25, -0.15, 3.0), (0.25, 0.15, 3.5))
        for plane in (facing_front(0.16), facing_back(-0.16)):
            builder.decal(SIGN_WHITE, plane.points(rectangle(0, 3.25, 0.36, 0.36)))
        return
    builder.lathe(body, [(0.15, 0.0), (0.15, 0.1), (0.08, 0.2), (0.08, 0.7), (0.05, 0.8), (0.05, 3.02)], sides=12)
    if builder.detail <= 1:
        builder.lathe(body, [(0.05, 2.1), (0.09, 2.15), (0.05, 2.2)], sides=10)
    builder.cylinder(body, (0, -0.15, 3.25), (0, 0.15, 3.25), 0.25, sides=20)
    for plane in (facing_front(0.16), facing_back(-0.16)):
        builder.decal(SIGN_WHITE, plane.points(disc(0, 3.25, 0.22, sides=builder.sides(20))))
        if builder.detail > 1:
            continue
        face = plane.points([(0, 0)])[0]
        raised = type(plane)((0.0, float(face[1]) * 1.07, 0.0), plane.right)
        for hour in range(12):
            a = hour * math.pi / 6
            tick = [(0.17 * math.sin(a), 3.25 + 0.17 * math.cos(a)), (0.2 * math.sin(a), 3.25 + 0.2 * math.cos(a))]
            builder.decal(BLACK, raised.points(line(tick, 0.024)[0]))
        for turn, length, width in ((-55, 0.11, 0.03), (60, 0.165, 0.022)):
            a = math.radians(turn)
            hand = [(0, 3.25), (length * math.sin(a), 3.25 + length * math.cos(a))]
            builder.decal(BLACK, raised.points(line(hand, width)[0]))


def _parking_meter(builder: MeshBuilder, variant: int) -> None:
    """A ticket machine with a blue P, a screen and buttons; or a meter with a domed head on a post."""
    if variant == 1:
        _coin_meter(builder)
        return
    body = plain(0.22, 0.26, 0.30)
    if builder.detail == FAR:
        builder.box(body, (-0.2, -0.15, 0), (0.2, 0.15, 1.25))
        builder.box(SIGN_BLUE, (-0.2, -0.15, 1.25), (0.2, 0.15, 1.6))
        return
    builder.box(DARK_STEEL, (-0.17, -0.12, 0), (0.17, 0.12, 0.06))
    builder.extrude(body, [(-0.12, 0.06), (0.12, 0.06), (0.15, 0.75), (0.09, 1.26), (-0.12, 1.26)], "x", -0.17, 0.17)
    builder.box(SIGN_BLUE, (-0.2, -0.15, 1.22), (0.2, 0.15, 1.6), bevel=0.025)
    for plane in (facing_front(0.16), facing_back(-0.16)):
        write(builder, SIGN_WHITE, "P", plane, centre=(0, 1.41), height_m=0.27)
    builder.decal(SIGN_WHITE, facing_front(0.156).points(rectangle(0, 0.52, 0.2, 0.22)))
    if builder.detail <= 1:
        panel = type(facing_front(0))((0.0, 0.156, 0.75), (-1, 0, 0), (0, -0.1168, 0.9932))
        builder.decal(plain(0.55, 0.70, 0.62), panel.points(rectangle(0.0, 0.38, 0.2, 0.12)))
        builder.decal(SIGN_GREEN, panel.points(rectangle(0.09, 0.22, 0.06, 0.06)))
        builder.decal(SIGN_RED, panel.points(rectangle(0.09, 0.12, 0.06, 0.06)))
        builder.decal(BLACK, panel.points(rectangle(-0.07, 0.17, 0.09, 0.14)))


def _coin_meter(builder: MeshBuilder) -> None:
    grey = plain(0.45, 0.47, 0.50)
    if builder.detail == FAR:
        builder.cylinder(DARK_STEEL, (0, 0, 0), (0, 0, 1.15), 0.05, sides=10, capped=False)
        builder.box(grey, (-0.2, -0.15, 1.1), (0.2, 0.15, 1.6))
        return
    builder.cylinder(DARK_STEEL, (0, 0, 0), (0, 0, 0.03), 0.14, sides=12)
    builder.cylinder(DARK_STEEL, (0, 0, 0), (0, 0, 1.15), 0.04, sides=10)
    arch = [(0.2 * math.cos(a), 1.38 + 0.22 * math.sin(a)) for a in np.linspace(0, math.pi, builder.sides(9) + 1)]
    builder.extrude(grey, [(-0.13, 1.12), (0.13, 1.12), *arch], "y", -0.12, 0.12)
    builder.box(grey.shaded(0.85), (-0.12, -0.15, 1.16), (0.12, 0.15, 1.36), bevel=0.015)
    for plane in (facing_front(0.131), facing_back(-0.131)):
        window = [(0.14 * math.cos(a), 1.42 + 0.12 * math.sin(a)) for a in np.linspace(0, math.pi, 8)]
        builder.decal(plain(0.80, 0.85, 0.82), plane.points(window))
        if builder.detail <= 1:
            needle = type(plane)((0.0, plane.origin[1] * 1.08, 0.0), plane.right)
            builder.decal(SIGN_RED, needle.points([(-0.1, 1.43), (-0.01, 1.43), (-0.1, 1.49)]))
            label = type(plane)((0.0, plane.origin[1] * 1.23, 0.0), plane.right)
            builder.decal(SIGN_BLUE, label.points(rectangle(0, 1.26, 0.15, 0.15)))
            raised = type(plane)((0.0, plane.origin[1] * 1.31, 0.0), plane.right)
            write(builder, SIGN_WHITE, "P", raised, centre=(0, 1.26), height_m=0.12)


def _charging_station(builder: MeshBuilder, variant: int) -> None:
    """A white pillar with a lit band, a bolt of lightning and a cable that hangs in a loop."""
    body = (SIGN_WHITE, plain(0.20, 0.22, 0.24))[variant]
    accent = (SIGN_GREEN, plain(0.15, 0.75, 0.35))[variant]
    if builder.detail == FAR:
        builder.box(body, (-0.22, -0.18, 0), (0.22, 0.18, 1.45))
        builder.box(accent, (-0.22, -0.18, 1.45), (0.22, 0.18, 1.7))
        return
    builder.box(DARK_STEEL, (-0.2, -0.16, 0), (0.2, 0.14, 0.06))
    builder.box(body, (-0.2, -0.2, 0.06), (0.2, 0.14, 1.46), bevel=0.03)
    builder.box(accent, (-0.2, -0.2, 1.46), (0.2, 0.14, 1.56), bevel=0.01)
    builder.box(body, (-0.2, -0.2, 1.56), (0.2, 0.14, 1.7), bevel=0.03)
    front = facing_front(0.15)
    builder.decal(BLACK, front.points(rectangle(0, 1.28, 0.28, 0.2)))
    bolt = [(0.05, 0.44), (-0.13, 0.13), (0.0, 0.13), (-0.06, -0.16), (0.14, 0.2), (0.01, 0.2)]
    scale = 0.8
    builder.decal(accent, front.points([(u * scale, 0.62 + v * scale) for u, v in bolt]))
    builder.decal(accent, facing_back(-0.21).points([(u * scale, 0.75 + v * scale) for u, v in bolt]))
    builder.box(BLACK, (-0.25, 0.0, 0.92), (-0.18, 0.2, 1.1), bevel=0.02)
    loop = [(-0.22, 0.18, 0.94), (-0.24, 0.19, 0.5), (-0.2, 0.18, 0.24), (-0.06, 0.17, 0.2), (0.08, 0.16, 0.36)]
    if builder.detail <= 1:
        builder.tube(BLACK, [*loop, (0.12, 0.13, 0.5)], 0.017, sides=6)
        builder.decal(SIGN_BLUE, facing_side(0.21, y=-0.03).points(rectangle(0, 1.2, 0.24, 0.24)))
        write(builder, SIGN_WHITE, "EV", facing_side(0.22, y=-0.03), centre=(0, 1.2), height_m=0.15)


MAKERS = {
    "street_lamp": Maker(_street_lamp, variants=3, fits="height"),
    "bollard": Maker(_bollard, variants=3),
    "flagpole": Maker(_flagpole, variants=3, fits="height"),
    "clock": Maker(_clock, variants=2),
    "parking_meter": Maker(_parking_meter, variants=2),
    "charging_station": Maker(_charging_station, variants=2),
}
