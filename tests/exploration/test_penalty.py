import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.exploration.penalty import distance_penalty


@given(st.floats(0, 1e9), st.floats(0, 100), st.floats(0, 1e6))
def test_the_penalty_is_a_share_for_every_distance(distance_m: float, k: float, d0_m: float) -> None:
    assert 0.0 <= distance_penalty(distance_m, sharpness_per_m=k, half_distance_m=d0_m) <= 1.0


@given(st.floats(0, 1e4), st.floats(0, 1e4))
def test_the_farther_the_dearer(near_m: float, far_m: float) -> None:
    near_m, far_m = sorted((near_m, far_m))
    assert distance_penalty(near_m) <= distance_penalty(far_m)


def test_half_of_it_is_due_at_d0() -> None:
    assert distance_penalty(60.0) == 0.5


def test_it_is_the_papers_formula() -> None:
    # By hand: 1 / (1 + e^(-0.5 · (66 - 60))) = 1 / (1 + e^-3).
    assert distance_penalty(66.0) == pytest.approx(1.0 / (1.0 + math.exp(-3.0)))
