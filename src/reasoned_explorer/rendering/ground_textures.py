"""Textures of what one stands on, and of water and greenery."""

import numpy as np

from reasoned_explorer.rendering.texture_patterns import (
    SIZE,
    Field,
    clouds,
    courses,
    generator_of,
    grain,
    grey,
    grid,
    joint,
    leaves,
    mixed,
    stones,
)


def asphalt() -> Field:
    """Return dark grain with lighter chips, worn patches and a crack or two; 4 m."""
    rng = generator_of("asphalt")
    chips = np.where(grain(rng) > 0.93, 0.16, 0.0)
    worn = clouds(rng, 3, 6, 12)
    crack = np.clip(1.0 - np.abs(clouds(rng, 2, 5, 11) - 0.5) / 0.006, 0.0, 1.0) * np.clip(
        clouds(rng, 2, 3) * 4.0 - 2.4, 0.0, 1.0
    )
    return grey(0.78 + 0.12 * worn + 0.14 * (grain(rng) - 0.5) + chips - 0.25 * crack)


def paving() -> Field:
    """Return slabs of half a metre in running bond, each of its own grey; 2 m."""
    rng = generator_of("paving")
    along, up, own = courses(rng, 4, 4)
    gap = joint(along, up, width_u=0.05, width_v=0.05)
    slab = 0.84 + 0.13 * own + 0.05 * (grain(rng) - 0.5) + 0.05 * (clouds(rng, 4, 9) - 0.5)
    return mixed((1.0, 0.99, 0.97), (0.97, 1.0, 1.0), own) * (slab - 0.3 * gap)[..., None]


def cobbles() -> Field:
    """Return setts of about 12 cm, lighter in their middles; 2 m."""
    rng = generator_of("cobbles")
    inside, own = stones(rng, 16, jitter=0.45)
    crown = np.clip(inside / 0.16, 0.0, 1.0)
    shade = 0.5 + 0.36 * crown + 0.16 * (own - 0.5) * crown + 0.05 * (grain(rng) - 0.5)
    return mixed((1.0, 0.98, 0.94), (0.95, 0.98, 1.0), own) * shade[..., None]


def grass() -> Field:
    """Return blades in tufts, mottled from yellowish to dark; 4 m."""
    rng = generator_of("grass")
    blades = clouds(rng, 24, 48, across=2, fall=0.9)
    tufts = clouds(rng, 4, 9, 18)
    lit = 0.62 + 0.24 * blades + 0.16 * tufts + 0.2 * (grain(rng) - 0.5)
    return mixed((0.93, 1.0, 0.92), (1.0, 0.98, 0.84), clouds(rng, 3, 7)) * lit[..., None]


def earth() -> Field:
    """Return clods and small stones; 3 m."""
    rng = generator_of("earth")
    stone = np.where(stones(rng, 22, jitter=0.9)[1] > 0.93, 0.15, 0.0)
    return grey(0.74 + 0.2 * (clouds(rng, 4, 9, 18, 36) - 0.3) + 0.14 * (grain(rng) - 0.5) + stone)


def sand() -> Field:
    """Return fine grain with faint ripples; 3 m."""
    rng = generator_of("sand")
    u, v = grid()
    bent = v + 0.03 * (clouds(rng, 3, 6) - 0.5)
    ripples = 0.5 + 0.5 * np.sin(2.0 * np.pi * (9.0 * bent + u))
    return grey(0.86 + 0.06 * ripples + 0.1 * (grain(rng) - 0.5) + 0.05 * (clouds(rng, 4, 8) - 0.5))


def gravel() -> Field:
    """Return small stones of many greys; 2 m."""
    rng = generator_of("gravel")
    inside, own = stones(rng, 52, jitter=0.9)
    shade = 0.72 + 0.14 * np.clip(inside / 0.2, 0.0, 1.0) + 0.16 * (own - 0.5) + 0.1 * (clouds(rng, 3, 7) - 0.5)
    return mixed((1.0, 0.97, 0.92), (0.94, 0.97, 1.0), own) * shade[..., None]


def planks() -> Field:
    """Return boards that run along u, with gaps and grain; 1.2 m, eight boards."""
    rng = generator_of("planks")
    along, up, own = courses(rng, 1, 8, shift=0.37)
    gap = joint(along, up, width_u=0.012, width_v=0.09)
    streaks = clouds(rng, 2, 4, fall=0.8)
    fibre = np.repeat(rng.random((SIZE, 1)), SIZE, axis=1)
    return grey(0.72 + 0.16 * own + 0.08 * streaks + 0.08 * fibre - 0.45 * gap)


def water() -> Field:
    """Return ripples of several lengths that cross; 8 m."""
    rng = generator_of("water")
    u, v = grid()
    bend = 0.05 * (clouds(rng, 3, 6) - 0.5)
    waves = [((2, 5), 1.0), ((-3, 7), 0.8), ((6, 9), 0.6), ((-8, 13), 0.5), ((5, -17), 0.3)]
    height = sum(
        strength * np.sin(2.0 * np.pi * (across * (u + bend) + up * (v + bend) + phase))
        for ((across, up), strength), phase in zip(waves, rng.random(len(waves)), strict=True)
    )
    crest = np.clip(0.5 + height / 5.0, 0.0, 1.0)
    return mixed((0.68, 0.74, 0.78), (1.0, 1.0, 1.0), crest**1.6)


def foliage() -> Field:
    """Return leaves before dark gaps; 1.5 m."""
    rng = generator_of("foliage")
    light, own = leaves(rng, 1500, 0.085)
    depth = clouds(rng, 4, 8)
    shade = 0.28 + 0.66 * light + 0.2 * depth
    return mixed((0.88, 1.0, 0.82), (1.0, 1.0, 0.72), own) * shade[..., None]


def flowers() -> Field:
    """Return a bed in bloom: dark green with heads of several colours; 1.5 m."""
    rng = generator_of("flowers")
    inside, own = stones(rng, 16, jitter=0.9)
    head = np.clip((inside - 0.1) / 0.08, 0.0, 1.0) * (own > 0.42)
    colours = np.array([(0.93, 0.2, 0.25), (0.98, 0.8, 0.2), (0.95, 0.93, 0.95), (0.78, 0.3, 0.75), (0.97, 0.5, 0.2)])
    petal = colours[np.clip(((own - 0.42) / 0.58 * len(colours)).astype(int), 0, len(colours) - 1)]
    green = mixed((0.2, 0.36, 0.12), (0.38, 0.55, 0.2), 0.6 * clouds(rng, 6, 12, 24) + 0.4 * grain(rng))
    picture: Field = green * (1.0 - head[..., None]) + petal * head[..., None]
    return picture
