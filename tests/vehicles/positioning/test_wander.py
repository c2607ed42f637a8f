import numpy as np
import pytest

from reasoned_explorer.geometry import Pose
from reasoned_explorer.vehicles.control import kernels
from reasoned_explorer.vehicles.control.localization import FilterSettings, PoseFilter
from reasoned_explorer.vehicles.positioning import wander
from reasoned_explorer.vehicles.positioning.fix import Fix, FixQuality
from reasoned_explorer.vehicles.positioning.receivers import RECEIVERS, ReceiverModel

FIXED, SINGLE = RECEIVERS[FixQuality.FIXED], RECEIVERS[FixQuality.SINGLE]


def filter_of(position_sigma_m: float) -> PoseFilter:
    return PoseFilter(FilterSettings(), Pose(0.0, 0.0), position_sigma_m=position_sigma_m, heading_sigma_rad=0.1)


def fix(x_m: float, y_m: float) -> Fix:
    return Fix(0.0, FixQuality.SINGLE, 0.0, 0.0, x_m, y_m)


def is_sound(filter_: PoseFilter) -> bool:
    cov = filter_.covariance
    return bool(np.allclose(cov, cov.T, atol=1e-12) and np.linalg.eigvalsh(cov).min() > -1e-12)


def test_a_worse_fix_than_the_place_is_known_tells_only_its_own_error():
    filter_ = filter_of(0.02)
    assert wander.change(filter_, fix(1.0, -2.0), SINGLE) == (True, pytest.approx(5.0**0.5))
    assert (filter_.pose.x_m, filter_.pose.y_m) == (0.0, 0.0)
    assert filter_.estimate.position_sigma_m == pytest.approx(0.02)
    assert list(filter_.state[list(wander.WANDERS)]) == [1.0, -2.0]
    assert wander.off_m(filter_, fix(1.0, -2.0)) == 0.0
    assert is_sound(filter_)


def test_a_better_fix_tells_the_place():
    filter_ = filter_of(2.0)
    believed, _ = wander.change(filter_, fix(1.0, -2.0), FIXED)
    assert believed
    assert (filter_.pose.x_m, filter_.pose.y_m) == pytest.approx((1.0, -2.0), abs=0.01)
    assert filter_.estimate.position_sigma_m < 0.02
    assert is_sound(filter_)


def test_one_that_is_far_off_is_refused():
    filter_ = filter_of(0.02)
    believed, away_m = wander.change(filter_, fix(30.0, 0.0), SINGLE)
    assert (believed, away_m) == (False, 30.0)
    assert filter_.pose.x_m == 0.0


def test_a_receiver_that_is_told_to_be_worse_has_the_old_error_and_some_more():
    filter_ = filter_of(0.02)
    old, new = ReceiverModel(0.01, 0.01, 100.0), ReceiverModel(0.2, 0.3, 200.0)
    before = filter_.covariance[kernels.EKF_WANDER_X, kernels.EKF_WANDER_X]
    wander.retune(filter_, old, new)
    assert filter_.covariance[kernels.EKF_WANDER_X, kernels.EKF_WANDER_X] == pytest.approx(before + 0.09 - 0.0001)
    wander.retune(filter_, new, old)
    assert filter_.covariance[kernels.EKF_WANDER_X, kernels.EKF_WANDER_X] == pytest.approx(before + 0.09 - 0.0001)
    assert filter_.settings_array[kernels.SET_WANDER_TAU] == 100.0
