import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.model import SettingsError, UnknownNameError, draws
from reasoned_explorer.simulation import kernels
from reasoned_explorer.simulation.sensors import SENSOR_NOISE, SensorNoise, sensor_noise

keys = st.integers(0, 2**40)


def chain(key: int, part: int) -> np.uint64:
    """A compiled function hands out plain integers; what goes in must say that it is unsigned."""
    return np.uint64(kernels.chain(np.uint64(key), part))


@given(st.integers(0, 2**63), keys, keys)
def test_compiled_draws_are_those_of_the_model(seed, first, second):
    key = np.uint64(draws.key_of(seed, "somewhere", first))
    assert int(kernels.chain(key, second)) == draws.key_of(seed, "somewhere", first, second)
    chained = chain(key, second)
    assert kernels.unit(chained) == draws.uniform(seed, "somewhere", first, second)
    assert kernels.normals(chained)[0] == pytest.approx(
        draws.normal(seed, "somewhere", first, second), rel=1e-14, abs=1e-14
    )


def test_both_normal_numbers_of_a_key_are_standard_and_independent():
    pairs = np.array([kernels.normals(chain(7, i)) for i in range(20_000)])
    assert np.abs(pairs.mean(axis=0)).max() < 0.03
    assert np.allclose(pairs.std(axis=0), 1.0, atol=0.02)
    assert abs(np.corrcoef(pairs.T)[0, 1]) < 0.03


@pytest.mark.parametrize("step_s", [0.2, 30.0, 600.0])
def test_the_slow_error_keeps_its_size_whatever_the_time_step(step_s):
    noise = sensor_noise("single")
    true, array = np.zeros(kernels.TRUE_SIZE), noise.as_array()
    values = []
    for i in range(20_000):
        kernels.wander(true, array, chain(11, i), step_s)
        values.append(true[kernels.TRUE_WANDER_X])
    independent = max(1.0, 20_000 * min(1.0, step_s / noise.wander_tau_s))
    assert np.std(values) == pytest.approx(noise.wander_sigma_m, rel=4.0 / math.sqrt(independent))
    lag = np.corrcoef(values[:-1], values[1:])[0, 1]
    assert lag == pytest.approx(math.exp(-step_s / noise.wander_tau_s), abs=0.05)


def test_presets_grow_worse_from_none_to_single():
    sigmas = [SENSOR_NOISE[name].position_sigma_m for name in ("none", "rtk-fixed", "rtk-float", "single")]
    assert sigmas == sorted(sigmas)
    assert sensor_noise("rtk-fixed").position_sigma_m == 0.014


def test_a_filter_never_takes_a_sensor_to_be_perfect():
    array = sensor_noise("none").as_array()
    assert (array[kernels.TOLD_POSITION :] > 0.0).all()
    assert sensor_noise("none").filter_settings().acceleration_density_mps2 > 0.0


def test_an_unknown_preset_answers_with_the_near_misses():
    with pytest.raises(UnknownNameError, match="rtk-fixed"):
        sensor_noise("rtk-fixd")


def test_bad_figures_are_all_named_at_once():
    with pytest.raises(SettingsError) as caught:
        SensorNoise("mine", position_sigma_m=-1.0, fix_hz=7, outlier_share=2.0, wander_tau_s=0.0, gap_s=math.nan)
    assert len(caught.value.faults) == 5
