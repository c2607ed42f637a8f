"""What distance costs a frontier (paper, section IV-A)."""

import math


def distance_penalty(distance_m: float, *, sharpness_per_m: float = 0.5, half_distance_m: float = 60.0) -> float:
    """Return σ(d) = 1 / (1 + exp(-k (d - d0))), in [0, 1]; safe for every finite distance.

    Args:
        distance_m: d, metres.
        sharpness_per_m: k; 0.5 in the authors' code.
        half_distance_m: d0, where the penalty is one half; 60 m in the authors' code.
    """
    exponent = sharpness_per_m * (distance_m - half_distance_m)
    # exp() of a large positive number overflows, so that each half line gets the form that only takes negative ones.
    if exponent >= 0.0:
        return 1.0 / (1.0 + math.exp(-exponent))
    grown = math.exp(exponent)
    return grown / (1.0 + grown)
