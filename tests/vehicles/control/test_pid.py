import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.model import SettingsError
from reasoned_explorer.vehicles.control.pid import Pid, PidGains

finite = st.floats(-100.0, 100.0)


def test_proportional_and_derivative_parts_add_up():
    pid = Pid(PidGains(2.0, derivative=0.5))
    assert pid.step(3.0, rate=1.0, dt_s=0.1) == pytest.approx(2.0 * 3.0 - 0.5 * 1.0)


def test_a_jump_of_the_set_point_gives_no_derivative_kick():
    pid = Pid(PidGains(1.0, derivative=10.0))
    pid.step(0.0, rate=0.0, dt_s=0.05)
    assert pid.step(1.0, rate=0.0, dt_s=0.05) == pytest.approx(1.0)


def test_the_integral_removes_a_constant_disturbance():
    pid, value = Pid(PidGains(1.0, integral=0.8)), 0.0
    for _ in range(2000):
        rate = pid.step(1.0 - value, rate=0.0, dt_s=0.02) - 0.3
        value += rate * 0.02
    assert value == pytest.approx(1.0, abs=1e-3)
    assert pid.integral == pytest.approx(0.3, abs=1e-3)


def test_the_integral_does_not_wind_up_while_the_output_is_saturated():
    pid = Pid(PidGains(1.0, integral=1.0, limit=0.5))
    for _ in range(1000):
        assert pid.step(10.0, rate=0.0, dt_s=0.1) == 0.5
    # As soon as the error turns, the output leaves its limit: nothing has to be unwound first.
    assert pid.step(-0.2, rate=0.0, dt_s=0.1) < 0.0


def test_reset_forgets_the_integral():
    pid = Pid(PidGains(0.0, integral=1.0))
    pid.step(1.0, rate=0.0, dt_s=1.0)
    pid.reset()
    assert pid.integral == 0.0


@given(st.lists(st.tuples(finite, finite), min_size=1, max_size=30))
def test_output_and_integral_keep_their_limits(steps):
    pid = Pid(PidGains(3.0, integral=2.0, derivative=0.4, limit=1.5, integral_limit=0.7))
    for error, rate in steps:
        assert abs(pid.step(error, rate=rate, dt_s=0.05)) <= 1.5
        assert abs(pid.integral) <= 0.7


def test_bad_gains_are_all_named_at_once():
    with pytest.raises(SettingsError) as caught:
        PidGains(-1.0, integral=math.nan, limit=0.0)
    assert len(caught.value.faults) == 3
