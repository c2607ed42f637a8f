from pathlib import Path

import pytest

import reasoned_explorer.task.grades as module
from reasoned_explorer.model import GoalError
from reasoned_explorer.task.goal_spec import PASS_GRADE, Relation
from reasoned_explorer.task.grades import affordances, read_table
from reasoned_explorer.world.taxonomy import Ground

ENTRY = '[[affordance]]\nname = "nap"\nasks = "a nap"\nphrases = ["nap"]\nrows = [{rows}]\n'


def test_a_nap_can_be_had_on_a_bench_and_on_a_lawn_but_hardly_in_a_shelter():
    grades = {row.class_name: row.grade for row in affordances()["nap"].rows}
    assert grades == {"bench": PASS_GRADE, "lawn": PASS_GRADE, "shelter": 1}


def test_a_picnic_is_better_in_the_shade():
    rows = affordances()["picnic"].rows
    grades = {(row.class_name, bool(row.conditions)): row.grade for row in rows}
    assert grades["lawn", False] == 1
    assert grades["lawn", True] == PASS_GRADE


def test_every_grade_has_a_reason():
    assert all(row.why for item in affordances().values() for row in item.rows)


def test_no_phrase_belongs_to_two_affordances():
    phrases = [phrase for item in affordances().values() for phrase in item.phrases]
    assert len(phrases) == len(set(phrases))


def test_the_table_says_where_it_comes_from():
    text = (Path(module.__file__).parent / "grades.toml").read_text(encoding="utf-8")
    assert "SOURCE." in text
    assert "RUBRIC." in text


def test_conditions_are_read():
    (item,) = read_table(ENTRY.format(rows='"bench: 2 | not near ground.road, building@12; under tree | quiet"'))
    far, under = item.rows[0].conditions
    assert (far.relation, far.grounds, far.buildings, far.distance_m, far.negated) == (
        Relation.NEAR,
        (Ground.ROAD,),
        True,
        12.0,
        True,
    )
    assert under.classes == ("tree",)
    assert item.rows[0].why == "quiet"


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "empty"),
        ("= 3", "TOML"),
        ('[[affordance]]\nname = "nap"', "name, asks"),
        (ENTRY.format(rows='"bench: 1 ||"'), "no row has grade 2"),
        (ENTRY.format(rows='"yeti: 2 ||"'), "unknown class 'yeti'"),
        (ENTRY.format(rows='"bench: 7 ||"'), "grade '7'"),
        (ENTRY.format(rows='"bench: 2 | above tree |"'), "condition 'above tree'"),
        (ENTRY.format(rows='"bench: 2 | near ground.lava |"'), "unknown ground"),
        (ENTRY.format(rows='"bench: 2 ||"') * 2, "stands twice"),
    ],
)
def test_a_faulty_table_is_refused(text, told):
    with pytest.raises(GoalError, match=told):
        read_table(text)
