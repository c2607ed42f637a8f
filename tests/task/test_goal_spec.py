import math

import pytest

from reasoned_explorer.model import GoalError
from reasoned_explorer.task.goal_spec import AttributeTest, Condition, GoalSpec, Relation, Sought
from reasoned_explorer.world.taxonomy import Ground

BENCH = (Sought("bench"),)


def test_wanted_ground_forbids_all_other_known_ground():
    spec = GoalSpec("x", 3, BENCH, wanted=frozenset({Ground.ROAD}))
    assert Ground.GRASS in spec.forbidden
    assert Ground.BUILDING in spec.forbidden
    assert Ground.ROAD not in spec.forbidden
    assert Ground.UNKNOWN not in spec.forbidden


def test_without_a_path_condition_nothing_is_forbidden():
    assert GoalSpec("x", 1, BENCH).forbidden == frozenset()


def test_wanted_and_shunned_ground_add_up():
    spec = GoalSpec("x", 3, BENCH, wanted=frozenset({Ground.PATH}), shunned=frozenset({Ground.STEPS}))
    assert Ground.STEPS in spec.forbidden
    assert Ground.PATH not in spec.forbidden


def test_all_faults_of_a_spec_are_told_at_once():
    with pytest.raises(GoalError) as caught:
        GoalSpec(" ", 5, (Sought("bench", 1),), frozenset({Ground.ROAD}), frozenset({Ground.ROAD, Ground.UNKNOWN}))
    assert len(caught.value.faults) == 5


@pytest.mark.parametrize("distance_m", [0.0, -1.0, 101.0, math.nan, math.inf])
def test_a_distance_out_of_range_is_refused(distance_m):
    with pytest.raises(GoalError, match="distance_m"):
        Condition(Relation.NEAR, ("tree",), distance_m=distance_m)


def test_a_condition_needs_something_that_exists():
    with pytest.raises(GoalError, match="near what"):
        Condition(Relation.NEAR)
    with pytest.raises(GoalError, match="unknown class 'yeti'"):
        Condition(Relation.NEAR, ("yeti",))


def test_a_grade_is_0_1_or_2():
    with pytest.raises(GoalError, match="grade is 3"):
        Sought("bench", 3)


def test_what_the_world_does_not_say_fails_a_test_and_its_negation():
    assert AttributeTest("backrest", ("yes",)).holds({"backrest": "Yes"})
    assert AttributeTest("backrest", ("yes",), negated=True).holds({"backrest": "no"})
    assert not AttributeTest("backrest", ("yes",)).holds({})
    assert not AttributeTest("backrest", ("yes",), negated=True).holds({})


def test_a_name_may_be_said_in_part():
    assert AttributeTest("name", ("fischbrunnen",)).holds({"name": "Der Fischbrunnen"})


def test_the_description_says_what_is_graded_and_what_is_not():
    spec = GoalSpec(
        "x",
        3,
        (Sought("bench", 2, (Condition(Relation.UNDER, ("tree",)),)),),
        frozenset({Ground.PATH}),
        unread=("red",),
    )
    assert list(spec.describe()) == ["bench (under tree): grade 2", "stay on path", "not graded: red"]
