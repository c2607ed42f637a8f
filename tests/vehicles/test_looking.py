"""In which order a vehicle turns to look around."""

from reasoned_explorer.vehicles.looking import turning_order

SWEEP = {"left": 5.2, "ahead": 0.0, "right": 1.0}


def test_it_begins_at_the_end_that_is_nearer() -> None:
    assert turning_order(5.0, SWEEP) == ["left", "ahead", "right"]
    assert turning_order(1.1, SWEEP) == ["right", "ahead", "left"]


def test_a_little_nearer_is_not_enough_to_turn_the_sweep_round() -> None:
    assert turning_order(0.1, {"left": 5.3, "right": 1.0}) == ["left", "right"]


def test_nothing_to_look_at_is_no_order() -> None:
    assert turning_order(0.0, {}) == []
