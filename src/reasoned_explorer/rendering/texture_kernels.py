"""Colours of textures, as blurred as a pixel sees them."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.rendering.kernel_types import Floats, Ints, Packed, Rgb
from reasoned_explorer.world.compiling import part

#: A texel's channels: so many bits each, in lanes that are wide enough for a channel times a weight of up to 256.
TEXEL_BITS, LANE = 13, 21
_FULL = (1 << TEXEL_BITS) - 1
_LANES = _FULL | _FULL << LANE | _FULL << 2 * LANE
_HALVES = 128 | 128 << LANE | 128 << 2 * LANE
_PER_FULL = 1.0 / _FULL


class Textures(NamedTuple):
    """A stack of tileable textures with their mip maps.

    Attributes:
        texels: Linear light, all levels one after the other, in each all materials, shape (n,), int64: in each red,
            green and blue as `TEXEL_BITS` bits, `LANE` bits apart, so that one product weighs all three.
        starts: First texel of each level, int64.
        side: Texels along the side of the finest level, a power of two.
        per_metre: Repetitions a metre of each material, float64.
    """

    texels: NDArray[np.int64]
    starts: NDArray[np.int64]
    side: int
    per_metre: NDArray[np.float64]


@part
def halvings(square: float, most: int) -> tuple[int, float]:
    """How often a size can be halved until it is below 2, at most ``most`` times, and what is left, at least 1.

    Sizes are given and returned by their squares: what they come from needs no roots then.
    """
    count = 0
    while square >= 4.0 and count < most:
        square *= 0.25
        count += 1
    return count, min(max(square, 1.0), 4.0)


@part
def _between(a: int, b: int, share: int) -> int:
    """A packed colour between two, ``share`` of 256 parts from the first to the second."""
    return (a * (256 - share) + b * share + _HALVES >> 8) & _LANES


@part
def _level_texel(t: Packed, starts: Ints, size: int, material: int, u: float, v: float, level: int) -> int:
    """A texture's packed colour, bilinear in one level; u and v count repetitions."""
    side = size >> level
    x = math.floor(u * (side << 8)) - 128
    y = math.floor(-v * (side << 8)) - 128
    left, top = x >> 8, y >> 8
    fx = x & 255
    mask = side - 1
    start = starts[level] + material * side * side
    row0, row1 = start + (top & mask) * side, start + ((top + 1) & mask) * side
    column0, column1 = left & mask, (left + 1) & mask
    above = _between(t[row0 + column0], t[row0 + column1], fx)
    return _between(above, _between(t[row1 + column0], t[row1 + column1], fx), y & 255)


@part
def texel_at(
    texels: Packed,
    starts: Ints,
    per_metre: Floats,
    size: int,
    material: int,
    u_m: float,
    v_m: float,
    footprint_m2: float,
) -> Rgb:
    """A texture's colour at a place on a surface, blurred to the pixel's footprint there, given by its square."""
    scale = per_metre[material]
    last = starts.shape[0] - 1
    fineness = scale * size
    level, wide = halvings(footprint_m2 * fineness * fineness, last)
    u, v = u_m * scale, v_m * scale
    colour = _level_texel(texels, starts, size, material, u, v, level)
    # Two levels are mixed in the middle of the way from one to the next: elsewhere one is near enough.
    part = int(213.0 * wide - 360.0)
    if part > 0 and level < last:
        colour = _between(colour, _level_texel(texels, starts, size, material, u, v, level + 1), min(part, 256))
    red, green, blue = colour & _FULL, (colour >> LANE) & _FULL, colour >> 2 * LANE
    return red * _PER_FULL, green * _PER_FULL, blue * _PER_FULL
