"""What a goal truly asks for: the judge's side of a sentence.

OUTDOOR's four levels (paper, section II-A): 1 an object; 2 an object conditioned on another; 3 an object conditioned on
the path; 4 an underspecified abstraction. A sentence that has several of these has the highest of their levels, and all
of its conditions count.
"""

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from enum import StrEnum

from reasoned_explorer.model import Fault, Goal, GoalError
from reasoned_explorer.world.taxonomy import OBJECT_CLASSES, Ground

#: "Near" without a number: footprints at most this far apart, metres.
NEAR_M = 5.0
#: "Away from", "far from" and "quiet": footprints farther apart than this, metres.
AWAY_M = 15.0
#: The grade that passes.
PASS_GRADE = 2
_GRADES = (0, 1, 2)


class Relation(StrEnum):
    """How a thing must stand to another."""

    NEAR = "near"
    UNDER = "under"
    ON = "on"


@dataclass(frozen=True, slots=True)
class Condition:
    """How a thing must stand to something else; it holds where it holds for one of the alternatives.

    Attributes:
        relation: NEAR: footprints within ``distance_m``; UNDER: covered by a crown, shelter or roof; ON: in contact.
        classes: Object classes that it may stand so to, sorted.
        grounds: Grounds that it may stand so to, sorted; UNDER a ground (a wood) means standing on it.
        buildings: Whether buildings count too; UNDER a building means under a roof that one can walk under.
        distance_m: For NEAR, metres, in (0, 100].
        negated: It must *not* stand so.
    """

    relation: Relation
    classes: tuple[str, ...] = ()
    grounds: tuple[Ground, ...] = ()
    buildings: bool = False
    distance_m: float = NEAR_M
    negated: bool = False

    def __post_init__(self) -> None:
        """Check the values.

        Raises:
            GoalError: If the condition names nothing, an unknown class, or a distance out of range.
        """
        faults = [Fault(f"unknown class {name!r}", "a class of the taxonomy") for name in _unknown(self.classes)]
        if not (self.classes or self.grounds or self.buildings):
            faults.append(Fault(f"{self.relation} what?", "at least one class, ground or buildings"))
        if not (math.isfinite(self.distance_m) and 0.0 < self.distance_m <= 100.0):
            faults.append(Fault(f"distance_m is {self.distance_m}", "a distance above 0 and up to 100 m"))
        if faults:
            raise GoalError("condition of a goal", faults)

    def __str__(self) -> str:
        what = [OBJECT_CLASSES[name].noun for name in self.classes]
        what += [ground.noun for ground in self.grounds]
        what += ["building"] if self.buildings else []
        within = f" ({self.distance_m:g} m)" if self.relation is Relation.NEAR else ""
        return f"{'not ' if self.negated else ''}{self.relation} {' or '.join(what)}{within}"


@dataclass(frozen=True, slots=True)
class AttributeTest:
    """What a thing's attribute must say; where the world does not say it, the test fails, negated or not.

    Attributes:
        key: Of the world object's attributes, e.g. ``"backrest"``.
        values: One of these, case-folded; for ``"name"`` it is enough that the name holds one of them.
        negated: None of them, but the attribute must be there.
    """

    key: str
    values: tuple[str, ...]
    negated: bool = False

    def holds(self, attributes: Mapping[str, str]) -> bool:
        """Return whether the attributes pass."""
        given = attributes.get(self.key)
        if given is None:
            return False
        folded = given.casefold()
        hit = any(value in folded if self.key == "name" else value == folded for value in self.values)
        return hit != self.negated


@dataclass(frozen=True, slots=True)
class Sought:
    """One way to satisfy a goal; a thing's grade is the highest of the ways that it meets.

    Attributes:
        class_name: Of the thing.
        grade: 0 does not serve, 1 serves in a pinch, 2 is what was asked for.
        conditions: All must hold.
        attributes: All must hold.
        why: The reason for the grade, for people.
    """

    class_name: str
    grade: int = PASS_GRADE
    conditions: tuple[Condition, ...] = ()
    attributes: tuple[AttributeTest, ...] = ()
    why: str = ""

    def __post_init__(self) -> None:
        """Check the values.

        Raises:
            GoalError: If the class is unknown or the grade is not 0, 1 or 2.
        """
        faults = [Fault(f"unknown class {name!r}", "a class of the taxonomy") for name in _unknown((self.class_name,))]
        if self.grade not in _GRADES:
            faults.append(Fault(f"grade is {self.grade}", "0, 1 or 2"))
        if faults:
            raise GoalError("what a goal seeks", faults)


@dataclass(frozen=True, slots=True)
class GoalSpec:
    """What a goal truly asks for.

    Attributes:
        text: The sentence.
        level: 1 to 4.
        sought: The ways to satisfy it; at least one has the passing grade.
        wanted: Grounds to stay on; empty where the goal does not say.
        shunned: Grounds to keep off.
        affordance: Name of the level-4 table that the grades come from, or empty.
        unread: Words of the sentence that the judge does not grade, for people to know.
    """

    text: str
    level: int
    sought: tuple[Sought, ...]
    wanted: frozenset[Ground] = frozenset()
    shunned: frozenset[Ground] = frozenset()
    affordance: str = ""
    unread: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        """Check the values.

        Raises:
            GoalError: With everything that is wrong.
        """
        faults = []
        if not self.text.strip():
            faults.append(Fault("the text is empty", "a sentence"))
        if self.level not in {1, 2, 3, 4}:
            faults.append(Fault(f"level is {self.level}", "1, 2, 3 or 4"))
        if all(item.grade < PASS_GRADE for item in self.sought):
            faults.append(Fault("nothing would pass", f"a way to satisfy the goal with grade {PASS_GRADE}"))
        both = sorted(self.wanted & self.shunned)
        if both:
            faults.append(Fault(f"{', '.join(g.noun for g in both)} is both wanted and shunned", "one of the two"))
        if Ground.UNKNOWN in self.wanted | self.shunned:
            faults.append(Fault("unknown ground is wanted or shunned", "grounds that are known"))
        if faults:
            raise GoalError(f"goal {self.text!r}", faults)

    @property
    def goal(self) -> Goal:
        """The sentence, as the robot gets it."""
        return Goal(self.text, self.level)

    @property
    def class_names(self) -> tuple[str, ...]:
        """Classes of which something may pass, sorted."""
        return tuple(sorted({item.class_name for item in self.sought if item.grade >= PASS_GRADE}))

    @property
    def forbidden(self) -> frozenset[Ground]:
        """Grounds that break the path condition; empty where there is none.

        Where ground is wanted, everything that is known and not wanted is forbidden, buildings included. Unknown ground
        is neither wanted nor shunned.
        """
        if not self.wanted:
            return self.shunned
        return frozenset(Ground) - self.wanted - {Ground.UNKNOWN} | self.shunned

    def describe(self) -> Iterator[str]:
        """Yield lines that say, for people, what the judge understood."""
        for item in self.sought:
            terms = [str(condition) for condition in item.conditions]
            terms += [f"{'not ' if t.negated else ''}{t.key} {'/'.join(t.values)}" for t in item.attributes]
            terms_text = f" ({', '.join(terms)})" if terms else ""
            yield f"{OBJECT_CLASSES[item.class_name].noun}{terms_text}: grade {item.grade}"
        for verb, grounds in (("stay on", self.wanted), ("keep off", self.shunned)):
            if grounds:
                yield f"{verb} {', '.join(ground.noun for ground in sorted(grounds))}"
        if self.unread:
            yield f"not graded: {', '.join(self.unread)}"


def _unknown(names: Iterable[str]) -> list[str]:
    return [name for name in names if name not in OBJECT_CLASSES]
