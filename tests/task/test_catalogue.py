import pytest

from reasoned_explorer.model import InputError
from reasoned_explorer.task.catalogue import LEVELS, goals
from reasoned_explorer.task.grades import affordances
from reasoned_explorer.world.taxonomy import OBJECT_CLASSES

SAID = [
    pytest.param(goal, place, id=f"L{goal.level}-{goal.name}-{place}")
    for goal in goals()
    for place in range(len(goal.sentences))
]


@pytest.mark.parametrize(("level", "at_least"), [(1, 40), (2, 25), (3, 25), (4, 25)])
def test_there_are_enough_goals_of_each_level(level, at_least):
    assert len(goals(level)) >= at_least
    assert all(len(goal.sentences) >= 2 for goal in goals(level))


@pytest.mark.parametrize(("goal", "paraphrase"), SAID)
def test_every_paraphrase_means_the_same(goal, paraphrase):
    spec, first = goal.spec(paraphrase), goal.spec()
    assert spec.level == goal.level
    assert (spec.sought, spec.wanted, spec.shunned) == (first.sought, first.wanted, first.shunned)


def test_every_class_and_every_affordance_is_asked_for():
    assert {name for goal in goals(1) for name in goal.spec().class_names} == set(OBJECT_CLASSES)
    assert {goal.spec().affordance for goal in goals(4)} == set(affordances())


def test_no_sentence_stands_twice():
    sentences = [sentence for goal in goals() for sentence in goal.sentences]
    assert len(sentences) == len(set(sentences))


def test_all_levels_together_are_the_levels_one_by_one():
    assert goals() == tuple(goal for level in LEVELS for goal in goals(level))


def test_an_unknown_level_is_refused():
    with pytest.raises(InputError, match="level 5"):
        goals(5)
