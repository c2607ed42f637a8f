"""Sun, sky and air: what light there is, and what becomes of it on the way to the eye."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.rendering.kernel_types import Floats, Rgb, Texels
from reasoned_explorer.world.compiling import part


class Light(NamedTuple):
    """Sun, sky and air.

    Attributes:
        tones: Linear-light colours and a direction, shape (8, 3), float64; the rows are this module's constants.
        clouds: How dense clouds are, tileable, shape (n, n), n a power of two, float32, in [0, 1].
        haze_m: Distance at which haze takes the share 1 - 1/e.
        shadow: How much of the sunlight shadows take, in [0, 1].
        soft: Whether shadows are drawn from coarse tiles alone.
        wetness: How wet level ground is, in [0, 1].
        lamps: How bright glowing things are.
    """

    tones: NDArray[np.float64]
    clouds: NDArray[np.float32]
    haze_m: float
    shadow: float
    soft: bool
    wetness: float
    lamps: float


#: Rows of `Light.tones`: the direction to the sun (ENU, of length 1); what a surface gets of the sun that faces it, of
#: the sky above, of the ground below; the sky above and at the horizon; what is added around the sun; clouds.
SUN, SUNLIGHT, SKYLIGHT, BOUNCE, ZENITH, HORIZON, GLOW, CLOUD = range(8)


@part
def sky_light(tones: Floats, clouds: Texels, x: float, y: float, z: float) -> Rgb:
    """The sky in a direction of length 1."""
    up = max(z, 0.0)
    low = (1.0 - up) * (1.0 - up)
    low *= low
    red = tones[ZENITH, 0] + low * (tones[HORIZON, 0] - tones[ZENITH, 0])
    green = tones[ZENITH, 1] + low * (tones[HORIZON, 1] - tones[ZENITH, 1])
    blue = tones[ZENITH, 2] + low * (tones[HORIZON, 2] - tones[ZENITH, 2])
    near = max(0.0, x * tones[SUN, 0] + y * tones[SUN, 1] + z * tones[SUN, 2])
    glow = near * near
    glow *= glow
    glow = 0.35 * glow + 0.65 * glow * glow * glow * glow
    red += glow * tones[GLOW, 0]
    green += glow * tones[GLOW, 1]
    blue += glow * tones[GLOW, 2]
    if z > 0.01:
        side = clouds.shape[0]
        mask = side - 1
        spread = 0.35 * side / (z + 0.12)
        u, v = x * spread, y * spread
        left, top = math.floor(u), math.floor(v)
        fu, fv = u - left, v - top
        i0, i1, j0, j1 = left & mask, (left + 1) & mask, top & mask, (top + 1) & mask
        c = clouds
        cover = (1.0 - fv) * ((1.0 - fu) * c[j0, i0] + fu * c[j0, i1]) + fv * ((1.0 - fu) * c[j1, i0] + fu * c[j1, i1])
        cover *= min(1.0, (z - 0.01) * 6.0)
        red += cover * (tones[CLOUD, 0] - red)
        green += cover * (tones[CLOUD, 1] - green)
        blue += cover * (tones[CLOUD, 2] - blue)
    return red, green, blue


@part
def haze_of(thick: float) -> float:
    """The share of what is seen that is haze, after air so thick that it lets through 1 / e for each 1."""
    # The first terms of an exponential: the same to the last bit on every processor.
    return 1.0 - 1.0 / (1.0 + thick * (1.0 + thick * (0.5 + thick * (1.0 / 6.0 + thick * (1.0 / 24.0)))))


@part
def hazed(tones: Floats, haze: float, colour: Rgb, x: float, y: float, z: float) -> Rgb:
    """A colour with its share of haze before it; the direction is of length 1."""
    near = max(0.0, x * tones[SUN, 0] + y * tones[SUN, 1] + z * tones[SUN, 2])
    glow = 0.5 * near * near * near * near
    return (
        colour[0] + haze * (tones[HORIZON, 0] + glow * tones[GLOW, 0] - colour[0]),
        colour[1] + haze * (tones[HORIZON, 1] + glow * tones[GLOW, 1] - colour[1]),
        colour[2] + haze * (tones[HORIZON, 2] + glow * tones[GLOW, 2] - colour[2]),
    )


@part
def mirrored(tones: Floats, clouds: Texels, colour: Rgb, share: float, x: float, y: float, z: float) -> Rgb:
    """A colour with a share of what is seen of the surroundings in a mirrored direction."""
    seen = sky_light(tones, clouds, x, y, abs(z))
    if z < 0.0:
        dim = 0.35
        seen = (seen[0] * dim, seen[1] * dim, seen[2] * dim)
    return (
        colour[0] + share * (seen[0] - colour[0]),
        colour[1] + share * (seen[1] - colour[1]),
        colour[2] + share * (seen[2] - colour[2]),
    )
