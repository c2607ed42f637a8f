"""The dynamic time warping of two ways, compiled: its work is the product of their lengths."""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@njit(cache=True)
def dtw(first: Floats, second: Floats) -> float:
    """Return the least sum of distances over all warpings that pair two ways from end to end, metres.

    Both ways only go forward, and each point of either is paired at least once (Sakoe, Chiba, "Dynamic programming
    algorithm optimization for spoken word recognition", 1978, without a window).

    Args:
        first: Shape (n, 2), n ≥ 1, metres.
        second: Shape (m, 2), m ≥ 1, metres.
    """
    sums = np.full(second.shape[0] + 1, np.inf)
    sums[0] = 0.0
    for i in range(first.shape[0]):
        # ``before`` is what stood to the left in the row above, ``left`` what stands there now.
        before, left, sums[0] = sums[0], np.inf, np.inf
        for j in range(second.shape[0]):
            dx, dy = first[i, 0] - second[j, 0], first[i, 1] - second[j, 1]
            above = sums[j + 1]
            least = before if before < above else above
            left = (left if left < least else least) + math.sqrt(dx * dx + dy * dy)
            before, sums[j + 1] = above, left
    return float(sums[second.shape[0]])
