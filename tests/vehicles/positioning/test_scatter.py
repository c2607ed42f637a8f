import numpy as np
import pytest

from reasoned_explorer.geometry import Pose
from reasoned_explorer.vehicles.control.localization import FilterSettings, PoseFilter
from reasoned_explorer.vehicles.positioning.fix import Fix, FixQuality
from reasoned_explorer.vehicles.positioning.receivers import RECEIVERS
from reasoned_explorer.vehicles.positioning.scatter import WINDOW, Scatter

FLOAT = RECEIVERS[FixQuality.FLOAT]


def noted(scatter: Scatter, offs_m: np.ndarray) -> float:
    """Return what is learnt from fixes that are so far off, by a filter that knows where it is."""
    filter_ = PoseFilter(FilterSettings(), Pose(0.0, 0.0), position_sigma_m=0.001, heading_sigma_rad=0.1)
    for x_m, y_m in offs_m:
        scatter.note(filter_, Fix(0.0, FixQuality.FLOAT, 0.0, 0.0, float(x_m), float(y_m)), FLOAT)
    return scatter.factor


def noise(factor: float, count: int, seed: int = 1) -> np.ndarray:
    rng = np.random.Generator(np.random.PCG64(seed))
    return rng.normal(size=(count, 2)) * FLOAT.white_m * factor


@pytest.mark.parametrize("factor", [1.6, 2.4, 3.5])
def test_what_scatters_more_than_its_model_is_taken_to_be_as_much_worse(factor):
    scatter = Scatter(4.0)
    assert noted(scatter, noise(factor, WINDOW)) == pytest.approx(factor, rel=0.25)
    worse = scatter.applied_to(FLOAT)
    assert worse.white_m == pytest.approx(FLOAT.white_m * scatter.factor)
    assert worse.wander_m == pytest.approx(FLOAT.wander_m * scatter.factor)
    assert worse.wander_tau_s == FLOAT.wander_tau_s


def test_nothing_is_learnt_before_there_is_enough_to_learn_from():
    assert noted(Scatter(4.0), noise(3.0, WINDOW - 1)) == 1.0


@pytest.mark.parametrize("factor", [0.3, 1.0])
def test_one_that_is_as_good_as_its_model_or_better_is_left_at_it(factor):
    scatter = Scatter(4.0)
    assert noted(scatter, noise(factor, 20 * WINDOW)) == 1.0
    assert scatter.applied_to(FLOAT) is FLOAT


def test_one_that_gets_better_again_is_believed_again():
    scatter = Scatter(4.0)
    noted(scatter, noise(3.0, WINDOW))
    assert noted(scatter, noise(1.0, 3 * WINDOW)) == 1.0


def test_jumps_that_are_fewer_than_half_of_the_fixes_make_no_noise():
    offs_m = noise(1.0, WINDOW)
    offs_m[20:40] += 30.0
    assert noted(Scatter(4.0), offs_m) <= 1.3


def test_no_factor_is_larger_than_the_worst_and_none_is_learnt_where_that_is_one():
    assert noted(Scatter(4.0), noise(50.0, WINDOW)) == 4.0
    assert noted(Scatter(1.0), noise(50.0, WINDOW)) == 1.0


def test_another_quality_begins_anew():
    scatter = Scatter(4.0)
    noted(scatter, noise(3.0, WINDOW))
    scatter.forget()
    assert scatter.factor == 1.0


def test_a_copy_goes_on_by_itself():
    scatter = Scatter(4.0)
    noted(scatter, noise(3.0, WINDOW - 1))
    other = scatter.copy()
    noted(other, noise(3.0, 1))
    assert (scatter.factor, other.factor > 2.0) == (1.0, True)
