"""Ids and depths as pictures that people and other programs can read."""

import numpy as np
from numpy.typing import NDArray

#: Depth pictures hold whole millimetres; this is the farthest that they can, metres.
DEEPEST_M = 65.535
#: What is no thing: black, and the grey of the ground.
_SKY_COLOUR, _GROUND_COLOUR = (0, 0, 0), (70, 70, 70)


# Multiples of the golden section spread evenly over the circle of hues, however many there are; those of the plastic
# number's powers do so in two dimensions more (M. Roberts, "The unreasonable effectiveness of quasirandom sequences").
_HUE_STEP, _SATURATION_STEP, _VALUE_STEP = 0.6180339887498949, 0.7548776662466927, 0.5698402909980532
_LEAST_SATURATION, _LEAST_VALUE = 0.45, 0.62


def coded_colours(codes: NDArray[np.integer]) -> NDArray[np.uint8]:
    """Return a colour for each instance id or class code, far from those of the codes next to it.

    Args:
        codes: Any shape; 0 is the sky, 1 the ground, as in pictures.

    Returns:
        sRGB, the shape of ``codes`` and 3.
    """
    known, places = np.unique(codes, return_inverse=True)
    number = known.astype(np.float64)
    hue = number * _HUE_STEP % 1.0
    saturation = _LEAST_SATURATION + (1.0 - _LEAST_SATURATION) * (number * _SATURATION_STEP % 1.0)
    value = _LEAST_VALUE + (1.0 - _LEAST_VALUE) * (number * _VALUE_STEP % 1.0)
    table = np.round(255.0 * _rgb(hue, saturation, value)).astype(np.uint8)
    table[known == 0], table[known == 1] = _SKY_COLOUR, _GROUND_COLOUR
    coloured: NDArray[np.uint8] = table[places.reshape(codes.shape)]
    return coloured


def millimetres(depth_m: NDArray[np.float32]) -> NDArray[np.uint16]:
    """Return depths in whole millimetres, at most `DEEPEST_M`; 0 where nothing is seen, which is how cameras put it."""
    seen = np.isfinite(depth_m)
    held = np.clip(np.where(seen, depth_m, 0.0), 0.0, DEEPEST_M)
    return np.round(held.astype(np.float64) * 1000.0).astype(np.uint16)


def _rgb(hue: NDArray[np.float64], saturation: NDArray[np.float64], value: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return red, green and blue in [0, 1] of hues in turns (the hexcone of A. R. Smith, 1978)."""
    channels = []
    for shift in (5.0, 3.0, 1.0):
        sector = (shift + 6.0 * hue) % 6.0
        channels.append(value * (1.0 - saturation * np.clip(np.minimum(sector, 4.0 - sector), 0.0, 1.0)))
    return np.stack(channels, axis=-1)
