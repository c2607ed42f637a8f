"""A body that is driven by velocities, compiled: one tick of motion and contact, and one fix of its receiver.

Motion, contact and draws are those of `kernels.run_leg`; what steers is not here but at the other end of a wire.
"""

import math

import numpy as np
from numba import njit

from reasoned_explorer.simulation.kernels import (
    _FATE,
    _FIX,
    _GOLDEN,
    _TAU,
    END_NONE,
    NOISE_GAP_S,
    NOISE_GAP_SHARE,
    NOISE_OUTLIER_M,
    NOISE_OUTLIER_SHARE,
    NOISE_POSITION,
    TRUE_FORWARD,
    TRUE_GAP_S,
    TRUE_RIGHT,
    TRUE_SWAY_X,
    TRUE_SWAY_Y,
    TRUE_VX,
    TRUE_VY,
    TRUE_WANDER_X,
    TRUE_WANDER_Y,
    TRUE_X,
    TRUE_Y,
    Codes,
    Floats,
    _first_contact,
    _move,
    chain,
    mix,
    normals,
    unit,
)


@njit(cache=True, error_model="numpy")
def walk_tick(
    base: np.uint64,
    tick: int,
    true: Floats,
    body: Floats,
    walls: Floats,
    discs: Floats,
    codes: Codes,
    blocked: Codes,
    ground: Floats,
    bounds: Floats,
    forward_mps: float,
    right_mps: float,
    rate_radps: float,
    dt_s: float,
) -> tuple[int, int]:
    """Carry the body over a tick; return how a contact ended it and what was touched, as `run_leg` tells it."""
    x0, y0 = true[TRUE_X], true[TRUE_Y]
    _move(true, body, chain(base, tick), forward_mps, right_mps, rate_radps, dt_s)
    dx, dy = true[TRUE_X] - x0, true[TRUE_Y] - y0
    if dx == 0.0 and dy == 0.0:
        return END_NONE, -1
    share, how, what = _first_contact(
        x0, y0, true[TRUE_X], true[TRUE_Y], body, walls, discs, codes, blocked, ground, bounds, True
    )
    if how != END_NONE:
        true[TRUE_X], true[TRUE_Y] = x0 + share * dx, y0 + share * dy
        true[TRUE_VX] = true[TRUE_VY] = true[TRUE_FORWARD] = true[TRUE_RIGHT] = 0.0
        true[TRUE_SWAY_X] = true[TRUE_SWAY_Y] = 0.0
    return how, what


@njit(cache=True, error_model="numpy")
def satellite_fix(true: Floats, noise: Floats, key: np.uint64, since_s: float) -> tuple[bool, float, float]:
    """Return whether the receiver has a fix, and where it takes itself to be; the draws are those of `run_leg`."""
    fate_key = chain(key, _FATE)
    fate, fate_more = unit(fate_key), unit(mix(fate_key + _GOLDEN))
    if true[TRUE_GAP_S] > 0.0:
        true[TRUE_GAP_S] -= since_s
        return False, 0.0, 0.0
    if fate < noise[NOISE_GAP_SHARE]:
        true[TRUE_GAP_S] = -noise[NOISE_GAP_S] * math.log(1.0 - fate_more)
        return False, 0.0, 0.0
    east, north = normals(chain(key, _FIX))
    x = true[TRUE_X] + true[TRUE_WANDER_X] + noise[NOISE_POSITION] * east
    y = true[TRUE_Y] + true[TRUE_WANDER_Y] + noise[NOISE_POSITION] * north
    if fate > 1.0 - noise[NOISE_OUTLIER_SHARE]:
        x += noise[NOISE_OUTLIER_M] * math.sin(_TAU * fate_more)
        y += noise[NOISE_OUTLIER_M] * math.cos(_TAU * fate_more)
    return True, x, y
