"""The slow error of a receiver in the filter, when the kind of its fixes changes."""

import math

from reasoned_explorer.vehicles.control import kernels
from reasoned_explorer.vehicles.control.localization import PoseFilter
from reasoned_explorer.vehicles.positioning.fix import Fix
from reasoned_explorer.vehicles.positioning.receivers import ReceiverModel

#: Where the filter's state has the place, and the slow error of fixes of it, east and north.
PLACES = (kernels.EKF_X, kernels.EKF_Y)
WANDERS = (kernels.EKF_WANDER_X, kernels.EKF_WANDER_Y)
# A fix of another quality is news if its slow error is smaller than so much of what the place is uncertain by.
_NEWS = 0.7


def off_m(filter_: PoseFilter, fix: Fix) -> float:
    """Return how far a fix is from where the filter expects it."""
    expected = [float(filter_.state[place] + filter_.state[slow]) for place, slow in zip(PLACES, WANDERS, strict=True)]
    return math.hypot(fix.x_m - expected[0], fix.y_m - expected[1])


def retune(filter_: PoseFilter, before: ReceiverModel, now: ReceiverModel) -> None:
    """Make a filter expect errors of another size; one that is told to be larger is the old error and some more."""
    for slow in WANDERS:
        filter_.covariance[slow, slow] += max(0.0, now.wander_m**2 - before.wander_m**2)
    filter_.settings_array[kernels.SET_WANDER_SIGMA] = now.wander_m
    filter_.settings_array[kernels.SET_WANDER_TAU] = now.wander_tau_s


def doubt(filter_: PoseFilter, before: ReceiverModel, now: ReceiverModel) -> None:
    """Have a filter take its fixes to have been of another size of error all the time.

    What it knows of the place it knows from them: the place may be as much further off, the other way than the error.
    """
    more = now.wander_m**2 - before.wander_m**2
    for place, slow in zip(PLACES, WANDERS, strict=True):
        cov = filter_.covariance
        cov[place, place] += more
        cov[slow, slow] += more
        cov[place, slow] -= more
        cov[slow, place] -= more
    filter_.settings_array[kernels.SET_WANDER_SIGMA] = now.wander_m
    filter_.settings_array[kernels.SET_WANDER_TAU] = now.wander_tau_s


def change(filter_: PoseFilter, fix: Fix, receiver: ReceiverModel) -> tuple[bool, float]:
    """Take in the first fix of another quality than the last, and return whether it was believed and how far it is off.

    Its error has nothing to do with that of the last one. Where a receiver goes to and fro between two qualities their
    errors are not new each time, though; as news they would make the filter sure of a place that is wrong. Hence a fix
    that tells no more of the place than is known only tells what its error is.
    """
    state, cov = filter_.state, filter_.covariance
    for slow in WANDERS:
        state[slow] = 0.0
        cov[slow, :] = cov[:, slow] = 0.0
        cov[slow, slow] = receiver.wander_m**2
    away_m, known_m = off_m(filter_, fix), filter_.estimate.position_sigma_m
    is_news = receiver.wander_m < _NEWS * known_m
    is_far = away_m * away_m > filter_.settings.gate_2 * (known_m * known_m + receiver.sigma_m**2)
    if is_news or is_far:
        return filter_.position(fix.x_m, fix.y_m, sigma_m=receiver.white_m), away_m
    for place, slow, value in zip(PLACES, WANDERS, (fix.x_m, fix.y_m), strict=True):
        state[slow] = value - state[place]
        # Its error is that of the place, the other way.
        row = -cov[place, :]
        cov[slow, :] = row
        cov[:, slow] = row
        cov[slow, slow] = cov[place, place] + receiver.white_m**2
    return True, away_m
