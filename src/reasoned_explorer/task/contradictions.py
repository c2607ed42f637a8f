"""What a goal says and takes back: conditions that nothing in any world can meet together."""

from collections.abc import Sequence
from itertools import combinations

from reasoned_explorer.model import Fault
from reasoned_explorer.task.goal_spec import AttributeTest, Condition, Relation

_REMEDY = "one of the two"


def contradictions(conditions: Sequence[Condition], attributes: Sequence[AttributeTest]) -> list[Fault]:
    """Return a fault for each two conditions, or two attributes, that exclude each other whatever the world."""
    faults = []
    for one, other in combinations(dict.fromkeys(conditions), 2):
        for said, denied in ((one, other), (other, one)):
            if not said.negated and denied.negated and _exclude(said, denied):
                faults.append(Fault(f"it wants {said} and {denied}", _REMEDY))
    for first, second in combinations(dict.fromkeys(attributes), 2):
        if first.key == second.key and first.key != "name" and _differ(first, second):
            faults.append(Fault(f"it wants {first.key} {_said(first)} and {_said(second)}", _REMEDY))
    return faults


def _exclude(said: Condition, denied: Condition) -> bool:
    """Tell whether whatever meets a condition breaks the negated other one."""
    covered = set(said.classes) <= set(denied.classes) and set(said.grounds) <= set(denied.grounds)
    if not covered or (said.buildings and not denied.buildings):
        return False
    if said.relation is denied.relation:
        return said.relation is not Relation.NEAR or said.distance_m <= denied.distance_m
    # What is under or on a thing is near it.
    return denied.relation is Relation.NEAR


def _differ(first: AttributeTest, second: AttributeTest) -> bool:
    if first.negated != second.negated:
        wanted, refused = (second, first) if first.negated else (first, second)
        return set(wanted.values) <= set(refused.values)
    return not first.negated and not set(first.values) & set(second.values)


def _said(test: AttributeTest) -> str:
    return f"{'not ' if test.negated else ''}{'/'.join(test.values)}"
