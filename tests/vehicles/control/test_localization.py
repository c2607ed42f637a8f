import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reasoned_explorer.geometry import Pose, bearing_between_rad
from reasoned_explorer.model import SettingsError
from reasoned_explorer.vehicles.control import kernels
from reasoned_explorer.vehicles.control.localization import FilterSettings, PoseFilter

DT_S = 0.05
ORIGIN = Pose(0.0, 0.0)


def make(pose: Pose = ORIGIN, *, heading_sigma_rad: float = 0.05, **more: float) -> PoseFilter:
    return PoseFilter(FilterSettings(**more), pose, position_sigma_m=0.02, heading_sigma_rad=heading_sigma_rad)


def symmetric_and_positive(filter_: PoseFilter) -> bool:
    cov = filter_.covariance
    return bool(np.allclose(cov, cov.T, atol=1e-9) and np.linalg.eigvalsh(cov).min() > -1e-9)


def test_it_dead_reckons_along_its_velocity_in_all_directions():
    for heading_deg in (0.0, 90.0, 200.0):
        heading = math.radians(heading_deg)
        filter_ = make(Pose(1.0, 2.0, 0.0, heading), heading_sigma_rad=1e-3)
        for _ in range(20):  # one second at 1 m/s², then two at 1 m/s
            filter_.predict(DT_S, yaw_rate_radps=0.0, forward_mps2=1.0)
        for _ in range(40):
            filter_.predict(DT_S, yaw_rate_radps=0.0)
        assert filter_.pose.x_m == pytest.approx(1.0 + 2.5 * math.sin(heading), abs=1e-6)
        assert filter_.pose.y_m == pytest.approx(2.0 + 2.5 * math.cos(heading), abs=1e-6)
        assert filter_.estimate.speed_mps == pytest.approx(1.0)


def test_a_clockwise_yaw_rate_turns_the_heading_clockwise():
    filter_ = make()
    for _ in range(20):
        filter_.predict(DT_S, yaw_rate_radps=math.pi / 2)
    assert filter_.pose.heading_rad == pytest.approx(math.pi / 2)


def test_through_a_drop_out_the_uncertainty_grows_and_a_fix_shrinks_it():
    filter_ = make()
    sigmas = [filter_.estimate.position_sigma_m]
    for _ in range(5):
        for _ in range(20):
            filter_.predict(DT_S, yaw_rate_radps=0.0)
        sigmas.append(filter_.estimate.position_sigma_m)
    assert sigmas == sorted(sigmas)
    assert sigmas[-1] > 3.0 * sigmas[0]
    pose = filter_.pose
    assert filter_.position(pose.x_m, pose.y_m, sigma_m=0.014)
    assert filter_.estimate.position_sigma_m < 0.03


def test_averaging_does_not_remove_what_wanders():
    """A thousand fixes in a row have nearly the same slow error: the filter must not believe itself below it."""
    filter_ = make(wander_sigma_m=0.5, wander_tau_s=1000.0)
    _loosened(filter_)
    for _ in range(1000):
        filter_.predict(0.01, yaw_rate_radps=0.0)
        filter_.odometry(0.0, 0.0, sigma_mps=0.01)
        filter_.position(0.0, 0.0, sigma_m=0.02)
    assert filter_.estimate.position_sigma_m > 0.4


def _loosened(filter_: PoseFilter) -> None:
    filter_.covariance[0, 0] = filter_.covariance[1, 1] = 25.0


def test_a_single_wrong_fix_is_refused_and_changes_nothing():
    filter_ = make()
    filter_.predict(DT_S, yaw_rate_radps=0.0)
    before = filter_.state.copy(), filter_.covariance.copy()
    assert not filter_.position(3.0, -2.0, sigma_m=0.014)
    assert (filter_.state == before[0]).all()
    assert (filter_.covariance == before[1]).all()


def test_other_measurements_are_gated_too():
    filter_ = make()
    assert not filter_.velocity(5.0, 0.0, sigma_mps=0.05)
    assert not filter_.odometry(5.0, sigma_mps=0.05)
    assert not filter_.compass(1.5, sigma_rad=0.02)


@pytest.mark.parametrize("kind", ["position", "velocity", "odometry", "compass"])
def test_a_filter_that_refuses_everything_starts_over(kind):
    """Twenty refusals in a row: it is the filter that is wrong."""
    filter_ = make()
    ask = {
        "position": lambda: filter_.position(30.0, -20.0, sigma_m=0.014),
        "velocity": lambda: filter_.velocity(5.0, 1.0, sigma_mps=0.05),
        "odometry": lambda: filter_.odometry(5.0, sigma_mps=0.05),
        "compass": lambda: filter_.compass(2.0, sigma_rad=0.02),
    }[kind]
    answers = [ask() for _ in range(20)]
    assert answers == [False] * 19 + [True]
    assert symmetric_and_positive(filter_)
    if kind == "position":
        assert filter_.pose.distance_to_m(30.0, -20.0) < 0.5


def test_moving_tells_the_heading_that_a_bad_compass_does_not():
    """Course (Doppler velocity) against odometry: a start heading off by 20 degrees is found while driving."""
    filter_ = make(Pose(0.0, 0.0, 0.0, math.radians(20.0)), heading_sigma_rad=math.radians(20.0))
    y_m = 0.0
    for tick in range(200):
        forward = 1.0 if tick < 20 else 0.0
        y_m += min(tick, 20) * DT_S * DT_S
        filter_.predict(DT_S, yaw_rate_radps=0.0, forward_mps2=forward)
        speed = min(tick + 1, 20) * DT_S
        filter_.odometry(speed, sigma_mps=0.05)
        filter_.course(0.0, speed, sigma_mps=0.05)
        filter_.position(0.0, y_m, sigma_m=0.05)
    assert abs(bearing_between_rad(0.0, filter_.pose.heading_rad)) < math.radians(2.0)


def test_standing_learns_the_gyro_bias_from_the_compass():
    filter_ = make(compass_wander_sigma_rad=0.0)
    bias = math.radians(0.4)
    for _ in range(1200):
        filter_.predict(DT_S, yaw_rate_radps=bias)
        filter_.compass(0.0, sigma_rad=math.radians(1.0))
    assert filter_.estimate.gyro_bias_radps == pytest.approx(bias, rel=0.1)


def test_standing_still_keeps_position_and_its_uncertainty():
    filter_ = make(Pose(3.0, 4.0, 0.0, 1.0))
    filter_.predict(DT_S, yaw_rate_radps=0.0, forward_mps2=2.0)
    before = filter_.estimate
    filter_.stand(600.0)
    after = filter_.estimate
    assert after.pose == before.pose
    assert after.speed_mps == 0.0
    assert after.position_sigma_m == pytest.approx(before.position_sigma_m)
    assert symmetric_and_positive(filter_)


def test_headings_wrap_at_north():
    filter_ = make(Pose(0.0, 0.0, 0.0, math.radians(359.0)))
    assert filter_.compass(math.radians(1.0), sigma_rad=math.radians(1.0))
    assert abs(bearing_between_rad(0.0, filter_.pose.heading_rad)) < math.radians(1.0)


@settings(max_examples=50)
@given(
    st.lists(
        st.tuples(st.floats(-2.0, 2.0), st.floats(-3.0, 3.0), st.sampled_from("pvocs"), st.floats(-0.3, 0.3)),
        max_size=60,
    )
)
def test_the_covariance_stays_a_covariance(steps):
    filter_ = make()
    for rate, push, kind, off in steps:
        filter_.predict(DT_S, yaw_rate_radps=rate, forward_mps2=push, right_mps2=-push)
        state = filter_.state
        if kind == "p":
            filter_.position(state[0] + off, state[1] - off, sigma_m=0.02)
        elif kind == "v":
            filter_.velocity(state[2] + off, state[3], sigma_mps=0.05)
        elif kind == "o":
            filter_.odometry(off, 0.0, sigma_mps=0.05)
        elif kind == "c":
            filter_.compass(state[4] + off, sigma_rad=0.05)
        else:
            filter_.stand(1.0)
        assert np.isfinite(state).all()
        assert symmetric_and_positive(filter_)
        assert 0.0 <= filter_.pose.heading_rad < 2.0 * math.pi


def test_the_prediction_is_linearised_rightly():
    """The covariance carried over a step agrees with that of perturbed states carried over it one by one."""
    filter_ = make(Pose(0.0, 0.0, 0.0, 0.7), heading_sigma_rad=0.01)
    filter_.state[2:4] = 1.0, -0.5
    rng = np.random.Generator(np.random.PCG64(5))
    root = rng.normal(size=(9, 9)) * 1e-4
    filter_.covariance[...] = root @ root.T
    quiet = kernels.SET_GYRO_DENSITY, kernels.SET_ACCELERATION_DENSITY, kernels.SET_BIAS_WALK
    filter_.settings_array[list(quiet)] = 0.0
    filter_.settings_array[[kernels.SET_WANDER_SIGMA, kernels.SET_COMPASS_WANDER_SIGMA]] = 0.0
    start, moved = filter_.state.copy(), []
    covariance = filter_.covariance.copy()
    for column in range(9):
        ends = []
        for sign in (1.0, -1.0):
            state = start + sign * root[:, column]
            kernels.filter_predict(filter_.settings_array, state, np.zeros((9, 9)), DT_S, 0.5, 0.8, -0.3)
            ends.append(state)
        moved.append((ends[0] - ends[1]) / 2.0)
    expected = np.array(moved).T @ np.array(moved)
    kernels.filter_predict(filter_.settings_array, start, covariance, DT_S, 0.5, 0.8, -0.3)
    assert np.allclose(covariance, expected, rtol=2e-2, atol=1e-11)


def test_bad_settings_are_all_named_at_once():
    with pytest.raises(SettingsError) as caught:
        FilterSettings(gyro_density_radps=0.0, wander_tau_s=-1.0, wander_sigma_m=math.nan)
    assert len(caught.value.faults) == 3
