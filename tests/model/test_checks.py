import math

import numpy as np
import pytest

from reasoned_explorer.model.checks import is_within, positive_faults


@pytest.mark.parametrize("value", [0, 1.5, np.float64(2.0), np.int64(3)])
def test_numbers_of_any_kind_are_numbers(value: object) -> None:
    assert is_within(value, 0.0, 3.0)


@pytest.mark.parametrize("value", [math.nan, math.inf, "1", None, True, 3.1, -0.1])
def test_what_is_no_number_in_the_range_is_outside(value: object) -> None:
    assert not is_within(value, 0.0, 3.0)


def test_each_figure_that_must_be_above_zero_and_is_not_has_a_fault() -> None:
    given = {"speed_mps": 1.0, "radius_m": 0.0, "wait_s": -1.0, "limit_m": math.inf, "mass_kg": math.nan, "name": "x"}
    faults = positive_faults(given.items())
    assert [fault.what.split()[0] for fault in faults] == ["radius_m", "wait_s", "limit_m", "mass_kg", "name"]
    assert {fault.expected for fault in faults} == {"a finite number > 0"}
