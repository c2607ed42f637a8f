"""A machine that stops or sets off within a moment, at a wall say: more than its filter takes for possible.

The filter knows accelerations as white noise, and for that a stop from 0.8 m/s between two readings of the legs cannot
be. It took the legs for liars, carried its old speed on past where the machine stood, and then refused the fixes, too.
"""

import math

import numpy as np

from reasoned_explorer.vehicles.control import kernels
from reasoned_explorer.vehicles.control.localization import PoseFilter
from reasoned_explorer.vehicles.positioning.measurements import OdometryReading

#: Readings that differ by no more than so many standard deviations of their difference say the same.
_AGREE = 4.0
#: Readings further apart than this are not in a row, seconds; a speed that was not believed for longer says nothing.
_ROW_S = 0.5
#: No machine here changes its speed by more at once, metres a second; who says so is not believed so soon.
_MOST_MPS = 10.0
_X = [kernels.EKF_X, kernels.EKF_Y]
_V = [kernels.EKF_VX, kernels.EKF_VY]


def agree(one: OdometryReading, next_: OdometryReading, sigma_mps: float) -> bool:
    """Return whether two readings in a row say the same, and that can be."""
    if math.hypot(next_.forward_mps, next_.right_mps) > _MOST_MPS:
        return False
    apart_mps = math.hypot(next_.forward_mps - one.forward_mps, next_.right_mps - one.right_mps)
    return next_.time_s - one.time_s <= _ROW_S and apart_mps <= _AGREE * math.sqrt(2.0) * sigma_mps


def allow(filter_: PoseFilter, reading: OdometryReading, ago_s: float) -> None:
    """Have a filter take it for possible that its velocity changed at once to about what a reading says.

    The change may have come at any time since a velocity was last believed; the position is as uncertain as that.

    Args:
        filter_: The filter; its covariance is changed.
        reading: What is said of the velocity now.
        ago_s: When a velocity was last believed, seconds before now.
    """
    heading_rad = float(filter_.state[kernels.EKF_HEADING])
    sine, cosine = math.sin(heading_rad), math.cos(heading_rad)
    told = np.array(
        (
            reading.forward_mps * sine + reading.right_mps * cosine,
            reading.forward_mps * cosine - reading.right_mps * sine,
        )
    )
    change = told - filter_.state[_V]
    within_s = min(max(ago_s, 0.0), _ROW_S)
    spread = np.outer(change, change)
    cov = filter_.covariance
    cov[np.ix_(_V, _V)] += spread
    cov[np.ix_(_X, _V)] += 0.5 * within_s * spread
    cov[np.ix_(_V, _X)] += 0.5 * within_s * spread
    # A change at an even chance of any moment: the mean of the square of the time since.
    cov[np.ix_(_X, _X)] += within_s**2 / 3.0 * spread
