"""People: women, men and children, who stand or walk."""

from dataclasses import dataclass

import numpy as np

from reasoned_explorer.rendering.mesh_builder import FAR, Colour, MeshBuilder, Surface
from reasoned_explorer.rendering.models.maker import Maker
from reasoned_explorer.rendering.models.palette import PAINT, fabric, plain

_SKINS = (plain(0.88, 0.68, 0.56), plain(0.76, 0.55, 0.42), plain(0.50, 0.34, 0.25), plain(0.93, 0.75, 0.65))
_HAIRS = (plain(0.20, 0.14, 0.10), plain(0.09, 0.08, 0.08), plain(0.62, 0.46, 0.26), plain(0.62, 0.62, 0.62))
_JEANS = fabric(0.16, 0.23, 0.38)
_DARK = fabric(0.12, 0.12, 0.14)
_BEIGE = fabric(0.62, 0.54, 0.42)
_GREY = fabric(0.38, 0.39, 0.42)
_SHOE = plain(0.12, 0.10, 0.09)
_TRAINER = plain(0.88, 0.88, 0.88)
_CLOTHES: tuple[Colour, ...] = (
    (0.78, 0.16, 0.16),
    (0.16, 0.34, 0.62),
    (0.90, 0.90, 0.88),
    (0.20, 0.22, 0.25),
    (0.92, 0.72, 0.18),
    (0.22, 0.48, 0.32),
    (0.55, 0.36, 0.58),
    (0.72, 0.56, 0.40),
    (0.42, 0.62, 0.78),
)


@dataclass(frozen=True, slots=True)
class _Person:
    """Somebody.

    Attributes:
        height_m: From sole to crown.
        build: ``"man"``, ``"woman"`` or ``"child"``.
        stride_m: How far the feet are apart along the way; 0 for somebody who stands.
        legs: Trousers, or skirt.
        skirt: Whether it is a skirt.
        looks: Which skin and hair.
        long_hair: Whether the hair falls to the shoulders.
        bag: Whether there is a rucksack.
    """

    height_m: float
    build: str
    stride_m: float
    legs: Surface
    looks: int
    skirt: bool = False
    long_hair: bool = False
    bag: bool = False


_PEOPLE = (
    _Person(1.78, "man", 0.0, _JEANS, 0),
    _Person(1.68, "woman", 0.0, _DARK, 2, long_hair=True),
    _Person(1.80, "man", 0.52, _DARK, 1, bag=True),
    _Person(1.66, "woman", 0.46, _JEANS, 3, long_hair=True),
    _Person(1.22, "child", 0.0, _JEANS, 0, bag=True),
    _Person(1.70, "woman", 0.0, _GREY, 1, skirt=True, long_hair=True),
    _Person(1.74, "man", 0.0, _BEIGE, 3),
    _Person(1.76, "man", 0.48, _GREY, 2),
    _Person(1.64, "woman", 0.4, _DARK, 0, skirt=True),
    _Person(1.05, "child", 0.3, _BEIGE, 1),
)
_NATURAL_M = 1.75


def _person(builder: MeshBuilder, variant: int) -> None:
    """A person who looks ahead, made 1.75 m tall and then brought to their own height."""
    who = _PEOPLE[variant]
    body = MeshBuilder(detail=builder.detail)
    if builder.detail == FAR:
        _far(body, who)
    else:
        stride = who.stride_m * _NATURAL_M / who.height_m
        _legs(body, who, stride)
        _trunk(body, who)
        _arms(body, who, stride)
        _head(body, who)
    size = who.height_m / _NATURAL_M
    wide = size * (1.12 if who.build == "child" else 1.0)
    builder.add(body, scale=(wide, wide, size))


def _far(builder: MeshBuilder, who: _Person) -> None:
    skin, hair = _SKINS[who.looks], _HAIRS[who.looks]
    deep = 0.16 + 0.5 * who.stride_m
    builder.lathe(who.legs, [(1.0, 0.0), (0.95, 0.9)], sides=13, stretch=(0.2, deep), capped=False)
    builder.lathe(PAINT, [(0.92, 0.85), (1.0, 1.46)], sides=13, stretch=(0.25, 0.14), capped=False)
    mixed = plain(*(0.6 * a + 0.4 * b for a, b in zip(skin.colour, hair.colour, strict=True)))
    builder.cylinder(mixed, (0, 0.01, 1.44), (0, 0.01, 1.75), 0.12, 0.11, sides=13, capped=False)


def _legs(builder: MeshBuilder, who: _Person, stride: float) -> None:
    hip = 0.9
    feet = ((-0.09, stride / 2), (0.09, -stride / 2))
    shoe = _TRAINER if who.build != "woman" and who.looks % 2 == 0 else _SHOE
    for x, y in feet:
        back = y < -0.01
        ankle = np.array([x, y - (0.02 if not back else 0.06), 0.09 if not back else 0.16])
        knee = np.array([x * 0.98, 0.45 * y + (0.05 if stride else 0.01), 0.49])
        top = np.array([x * 0.92, 0.0, hip])
        lower = _SKINS[who.looks] if who.skirt else who.legs
        sides = 8 if builder.detail == 0 else 6
        if builder.detail == 2:
            builder.cylinder(lower, ankle * (1, 1, 0), top, 0.06, 0.1, sides=8, capped=False)
            continue
        builder.tube(lower, [ankle, knee, top], [0.052, 0.066, 0.092], sides=sides)
        toe = (0, 0.13, -0.045) if not back else (0, 0.1, -0.105)
        builder.beam(shoe, ankle + np.array([0, -0.06, -0.045]), ankle + np.array(toe), 0.09, 0.09)
    if who.skirt:
        reach = 0.19 + 0.25 * stride
        builder.lathe(who.legs, [(reach, 0.5), (0.17, 0.92), (0.14, 1.02)], sides=12, stretch=(1.0, 0.85))


def _trunk(builder: MeshBuilder, who: _Person) -> None:
    """Jacket or shirt: from the hips over the waist to the shoulders, oval."""
    waist, chest, shoulder, hips = {
        "man": (0.165, 0.195, 0.21, 0.172),
        "woman": (0.138, 0.172, 0.178, 0.176),
        "child": (0.15, 0.158, 0.165, 0.155),
    }[who.build]
    profile = [
        (hips, 0.86),
        (hips * 0.99, 0.95),
        (waist, 1.08),
        (chest, 1.27),
        (shoulder, 1.38),
        (0.12, 1.47),
        (0.055, 1.5),
    ]
    if builder.detail == 2:
        profile = profile[::2]
    builder.lathe(PAINT, profile, sides=14, stretch=(1.0, 0.62))
    if who.bag and builder.detail <= 1:
        strap = fabric(0.15, 0.30, 0.26) if who.build == "man" else fabric(0.85, 0.25, 0.35)
        builder.box(strap, (-0.14, -0.26, 1.02), (0.14, -0.1, 1.42), bevel=0.04)
        if builder.detail == 0:
            builder.box(strap.shaded(0.8), (-0.1, -0.3, 1.06), (0.1, -0.25, 1.22), bevel=0.02)
            for x in (-0.11, 0.11):
                builder.beam(strap, (x, 0.122, 1.2), (x * 0.9, 0.085, 1.45), 0.03, 0.02, up=(0, 1, 0))


def _arms(builder: MeshBuilder, who: _Person, stride: float) -> None:
    wide = {"man": 0.225, "woman": 0.19, "child": 0.18}[who.build]
    skin = _SKINS[who.looks]
    for side in (-1, 1):
        swing = side * stride * 0.42
        shoulder = np.array([side * wide * 0.74, 0.0, 1.42])
        elbow = np.array([side * (wide + 0.035), swing * 0.35 - 0.03, 1.13])
        wrist = np.array([side * (wide + 0.02), swing + 0.05, 0.88 + 0.35 * max(0.0, swing)])
        sides = 7 if builder.detail == 0 else 5
        if builder.detail == 2:
            builder.cylinder(PAINT, shoulder, wrist, 0.06, 0.04, sides=8, capped=False)
            continue
        builder.tube(PAINT, [shoulder, elbow, wrist], [0.062, 0.047, 0.036], sides=sides)
        hand = wrist + 0.06 * (wrist - elbow) / np.linalg.norm(wrist - elbow)
        if builder.detail <= 1:
            builder.sphere(skin, hand, (0.03, 0.042, 0.055), sides=6, rings=4)


def _head(builder: MeshBuilder, who: _Person) -> None:
    skin, hair = _SKINS[who.looks], _HAIRS[who.looks]
    big = 1.14 if who.build == "child" else 1.0
    if builder.detail == 2:
        builder.sphere(skin, (0, 0.03, 1.6), (0.07 * big, 0.085 * big, 0.14), sides=12, rings=6)
        builder.sphere(hair, (0, -0.02, 1.66), (0.085 * big, 0.09 * big, 0.09), sides=12, rings=5)
        return
    builder.cylinder(skin, (0, 0.0, 1.44), (0, 0.015, 1.57), 0.052, sides=8, capped=False)
    builder.sphere(skin, (0, 0.025, 1.62), (0.075 * big, 0.092 * big, 0.112), sides=12, rings=8)
    builder.sphere(hair, (0, -0.005, 1.66), (0.086 * big, 0.1 * big, 0.09), sides=12, rings=6)
    if who.long_hair:
        fall = [
            [(x * w, y, z) for x, y in ((-1, 0.01), (-1, -0.07), (0, -0.11), (1, -0.07), (1, 0.01))]
            for w, z in ((0.085, 1.66), (0.092, 1.55), (0.08, 1.42))
        ]
        builder.loft(hair, fall)
    if builder.detail == 0:
        builder.box(skin.shaded(0.93), (-0.012, 0.105, 1.6), (0.012, 0.135, 1.635))
        for x in (-0.032, 0.032):
            builder.box(plain(0.12, 0.09, 0.08), (x - 0.012, 0.1, 1.637), (x + 0.012, 0.113, 1.65))
        builder.box(plain(0.62, 0.30, 0.28), (-0.022, 0.098, 1.572), (0.022, 0.113, 1.581))


MAKERS = {"person": Maker(_person, variants=len(_PEOPLE), tints=_CLOTHES, scaling="uniform", fits="none")}
