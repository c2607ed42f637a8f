"""Textures of what things are built of: walls, roofs, facades with windows, and what furniture is made of."""

import numpy as np
from numpy.random import Generator

from reasoned_explorer.rendering.texture_patterns import (
    SIZE,
    Field,
    Sheet,
    clouds,
    courses,
    generator_of,
    grain,
    grey,
    grid,
    joint,
    mixed,
)

Colour = tuple[float, float, float]
_PANE_LOW, _PANE_HIGH = (0.13, 0.17, 0.22), (0.36, 0.45, 0.55)
_CURTAIN, _BLIND, _LAMPLIT = (0.78, 0.76, 0.72), (0.66, 0.64, 0.6), (0.85, 0.74, 0.52)


def plain() -> Field:
    """Return white."""
    return np.ones((SIZE, SIZE, 3))


def paint() -> Field:
    """Return paint: all but white; 1 m."""
    return grey(0.97 + 0.03 * clouds(generator_of("paint"), 3, 6))


def metal() -> Field:
    """Return brushed metal, its streaks along u; 1 m."""
    rng = generator_of("metal")
    streaks = np.repeat(rng.random((SIZE, 1)), SIZE, axis=1)
    return grey(0.88 + 0.07 * streaks + 0.06 * clouds(rng, 3, 6))


def wood() -> Field:
    """Return grain along u, with a knot here and there; 1 m."""
    rng = generator_of("wood")
    _, v = grid()
    rings = 0.5 + 0.5 * np.sin(2.0 * np.pi * (9.0 * v + 1.4 * clouds(rng, 2, 3)))
    return mixed((0.78, 0.74, 0.7), (1.0, 1.0, 1.0), 0.65 * rings + 0.35 * grain(rng))


def stone() -> Field:
    """Return dressed stone: faint blocks, finely mottled; 4 m, 5 blocks by 10 courses."""
    rng = generator_of("stone")
    along, up, own = courses(rng, 5, 10)
    gap = joint(along, up, width_u=0.03, width_v=0.06)
    mottled = 0.06 * (clouds(rng, 5, 11, 23) - 0.5) + 0.07 * (grain(rng) - 0.5)
    return grey(0.89 + 0.06 * own + mottled - 0.1 * gap)


def concrete() -> Field:
    """Return concrete with faint stains and pores; 4 m."""
    rng = generator_of("concrete")
    pores = np.where(grain(rng) > 0.985, 0.15, 0.0)
    return grey(0.86 + 0.13 * clouds(rng, 2, 5, 11) + 0.03 * (grain(rng) - 0.5) - pores)


def _bricks(rng: Generator, columns: int, rows: int) -> tuple[Field, Field]:
    """Return the shade of bricks in [0, 1], and their joints."""
    along, up, own = courses(rng, columns, rows)
    gap = joint(along, up, width_u=0.05, width_v=0.13)
    return np.clip(0.75 * own + 0.25 * grain(rng), 0.0, 1.0), gap


def brick() -> Field:
    """Return bricks with light joints, to be coloured; 1.25 m, 5 bricks by 16 courses."""
    shade, gap = _bricks(generator_of("brick"), 5, 16)
    picture: Field = grey(0.74 + 0.2 * shade) * (1.0 - gap[..., None]) + 1.0 * gap[..., None]
    return picture


def plaster() -> Field:
    """Return plaster: fine grain, faint stains; 2 m."""
    rng = generator_of("plaster")
    return grey(0.91 + 0.05 * clouds(rng, 2, 4, 8) + 0.04 * (grain(rng) - 0.5))


def glass() -> Field:
    """Return glass: faint slanting reflections; 2 m."""
    u, v = grid()
    sheen = 0.5 + 0.5 * np.sin(2.0 * np.pi * (u + v) + 1.2 * clouds(generator_of("glass"), 2, 4))
    return mixed((0.86, 0.9, 0.94), (1.0, 1.0, 1.0), sheen)


def bark() -> Field:
    """Return upright furrows; 1 m."""
    rng = generator_of("bark")
    ridge = np.abs(clouds(rng, 3, 6, 12, across=4) - 0.5) * 2.0
    return grey(0.62 + 0.36 * np.sqrt(ridge) + 0.1 * (grain(rng) - 0.5))


def fabric() -> Field:
    """Return a plain weave; 0.5 m."""
    u, v = grid()
    weave = np.sin(2.0 * np.pi * 32 * u) * np.sin(2.0 * np.pi * 32 * v)
    return grey(0.93 + 0.04 * weave + 0.03 * clouds(generator_of("fabric"), 3, 6))


def roof_tiles() -> Field:
    """Return courses of tiles that overlap downwards; 2 m, 8 tiles by 6 courses."""
    rng = generator_of("roof tiles")
    along, up, own = courses(rng, 8, 6)
    round_off = np.abs(along - 0.5) * 2.0
    lip = np.clip(1.0 - up / (0.16 + 0.1 * round_off), 0.0, 1.0)
    shade = 0.76 + 0.2 * own + 0.08 * (1.0 - up) - 0.1 * round_off**4 - 0.38 * lip
    return grey(shade + 0.05 * (clouds(rng, 3, 7) - 0.5))


def roof_flat() -> Field:
    """Return roofing felt with seams and dust; 4 m."""
    rng = generator_of("roof flat")
    u, _ = grid()
    seam = np.clip(1.0 - np.abs((u * 4.0) % 1.0 - 0.5) / 0.02, 0.0, 1.0)
    return grey(0.82 + 0.14 * clouds(rng, 3, 6, 12) + 0.06 * (grain(rng) - 0.5) - 0.14 * seam)


def _window(
    sheet: Sheet,
    middle: float,
    low: float,
    size: tuple[float, float],
    *,
    frame: Colour,
    surround: Colour,
    inside: str,
    transom: float = 0.7,
) -> None:
    """Paint a window, metres: surround, frame, two casements under a transom, and what shows behind the pane."""
    wide, high = size
    left, right, top = middle - wide / 2.0, middle + wide / 2.0, low + high
    sheet.fill(left - 0.14, low, right + 0.14, top + 0.14, surround)
    sheet.fill(left, low, right, top, frame)
    sheet.fill(left - 0.2, low - 0.12, right + 0.2, low, frame)
    sheet.fill(left - 0.2, low - 0.21, right + 0.2, low - 0.12, surround, cover=0.0)
    sheet.fill(left - 0.2, low - 0.2, right + 0.2, low - 0.12, (0.5, 0.49, 0.48), cover=0.5)
    split = low + transom * high
    panes = [(left + 0.08, middle - 0.05), (middle + 0.05, right - 0.08)]
    for one, other in panes:
        for below, above in ((low + 0.08, split - 0.05), (split + 0.05, top - 0.08)):
            sheet.fill(one, below, other, above, _PANE_LOW, top=_PANE_HIGH)
    if inside == "curtains":
        for one, other in ((panes[0][0], panes[0][0] + 0.18), (panes[1][1] - 0.18, panes[1][1])):
            sheet.fill(one, low + 0.08, other, split - 0.05, _CURTAIN, cover=0.75)
    elif inside == "blind":
        for one, other in panes:
            sheet.fill(one, low + 0.45 * high, other, split - 0.05, _BLIND, cover=0.8)
    elif inside == "lamp":
        for one, other in panes:
            sheet.fill(one, low + 0.08, other, split - 0.05, _LAMPLIT, top=_CURTAIN, cover=0.45)
    # The lintel throws a shadow on the pane.
    sheet.fill(left, top - 0.14, right, top, (0.08, 0.09, 0.1), cover=0.55)


#: What shows in the four windows of a facade: by bay, then by storey.
_BEHIND = (("curtains", ""), ("blind", "curtains"))


def facade() -> Field:
    """Return plaster with windows; 6 m: two bays by two storeys, each 3 m."""
    rng = generator_of("facade")
    picture = grey(0.88 + 0.05 * clouds(rng, 2, 4, 8) + 0.03 * (grain(rng) - 0.5))
    sheet = Sheet(picture, 6.0)
    for bay in (0, 1):
        for storey in (0, 1):
            _window(
                sheet,
                1.5 + 3.0 * bay,
                0.8 + 3.0 * storey,
                (1.4, 1.75),
                frame=(0.97, 0.97, 0.96),
                surround=(0.97, 0.97, 0.96),
                inside=_BEHIND[bay][storey],
            )
    return picture


def facade_brick() -> Field:
    """Return red brick, already coloured, with windows under light lintels; 6 m: two bays by two storeys."""
    rng = generator_of("facade brick")
    shade, gap = _bricks(rng, 24, 76)
    bricks = mixed((0.6, 0.33, 0.25), (0.76, 0.45, 0.35), shade)
    picture: Field = bricks * (1.0 - 0.45 * gap[..., None]) + 0.45 * gap[..., None] * np.asarray((0.8, 0.72, 0.66))
    sheet = Sheet(picture, 6.0)
    for bay in (0, 1):
        for storey in (0, 1):
            middle, low = 1.5 + 3.0 * bay, 0.75 + 3.0 * storey
            sheet.fill(middle - 0.85, low + 1.7, middle + 0.85, low + 1.95, (0.9, 0.87, 0.8))
            _window(
                sheet,
                middle,
                low,
                (1.3, 1.7),
                frame=(0.95, 0.94, 0.91),
                surround=(0.62, 0.38, 0.3),
                inside=_BEHIND[1 - bay][storey],
                transom=0.5,
            )
    return picture


def facade_glass() -> Field:
    """Return a curtain wall: panes 1.5 m wide between mullions, spandrels at the floors; 6 m, two storeys."""
    rng = generator_of("facade glass")
    picture = np.empty((SIZE, SIZE, 3))
    sheet = Sheet(picture, 6.0)
    tones = rng.random((2, 4))
    for storey in (0, 1):
        low = 3.0 * storey
        sheet.fill(0.0, low, 6.0, low + 0.75, (0.46, 0.54, 0.6))
        for pane in range(4):
            tone = 0.82 + 0.18 * tones[storey, pane]
            bottom = (0.5 * tone, 0.62 * tone, 0.72 * tone)
            sheet.fill(1.5 * pane, low + 0.75, 1.5 * (pane + 1), low + 3.0, bottom, top=(0.72 * tone, 0.85, 0.95))
        sheet.fill(0.0, low + 0.7, 6.0, low + 0.8, (0.3, 0.33, 0.36))
        sheet.fill(0.0, low, 6.0, low + 0.1, (0.3, 0.33, 0.36))
    for pane in range(4):
        sheet.fill(1.5 * pane - 0.02, 0.0, 1.5 * pane + 0.1, 6.0, (0.34, 0.37, 0.4))
    return picture


def facade_shop() -> Field:
    """Return a shop front between pilasters: plinth, window, sign board; 4 m: one bay, one storey."""
    picture = grey(0.86 + 0.05 * clouds(generator_of("facade shop"), 2, 4, 8))
    sheet = Sheet(picture, 4.0)
    sheet.fill(0.0, 0.0, 4.0, 0.18, (0.5, 0.49, 0.48))
    sheet.fill(0.3, 0.18, 3.7, 0.55, (0.66, 0.66, 0.66))
    sheet.fill(0.3, 0.55, 3.7, 2.85, (0.3, 0.3, 0.31))
    sheet.fill(0.38, 0.62, 3.62, 2.78, (0.26, 0.29, 0.32), top=(0.42, 0.5, 0.57))
    # Goods on display before a lit back wall.
    sheet.fill(0.5, 0.9, 3.5, 2.1, (0.72, 0.66, 0.54), top=(0.6, 0.58, 0.55), cover=0.5)
    goods = [(0.62, 0.5, (0.75, 0.3, 0.25)), (1.15, 0.8, (0.25, 0.4, 0.6)), (1.75, 0.35, (0.85, 0.75, 0.3)),
             (2.25, 0.95, (0.85, 0.85, 0.82)), (2.8, 0.6, (0.3, 0.5, 0.35)), (3.15, 0.8, (0.6, 0.35, 0.5))]  # fmt: skip
    for left, high, colour in goods:
        sheet.fill(left, 0.62, left + 0.32, 0.62 + high, colour, cover=0.75)
    for post in (1.35, 2.6):
        sheet.fill(post, 0.55, post + 0.07, 2.85, (0.3, 0.3, 0.31))
    sheet.fill(0.15, 2.95, 3.85, 3.6, (1.0, 1.0, 1.0))
    for stroke in np.arange(1.0, 3.0, 0.25):
        sheet.fill(stroke, 3.12, stroke + 0.14, 3.42, (0.35, 0.34, 0.33))
    sheet.fill(0.0, 3.7, 4.0, 3.85, (1.0, 1.0, 1.0))
    sheet.fill(0.0, 3.62, 4.0, 3.7, (0.6, 0.6, 0.6))
    return picture
