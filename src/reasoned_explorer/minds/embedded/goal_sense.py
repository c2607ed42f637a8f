"""Whether a goal sentence makes sense: it says what is to be found, takes nothing back, and does not break off."""

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from reasoned_explorer.minds.embedded.goal_words import HANGING, NOT_SOUGHT, PURPOSE
from reasoned_explorer.minds.embedded.lexicon import ancestors, concepts
from reasoned_explorer.model.errors import Fault

#: Said without what they relate to: "is there a bench around?"
_ADVERBS = frozenset({"around", "along", "outside", "nearby", "past"})
#: May end a wish: "something to sit on".
_STRANDED = frozenset({"on", "in", "at", "by", "with", "under", "inside", "within", "upon", "to", "from", "for"})
#: May close another relation: "a bench with a tree near".
_CLOSING = frozenset({"near", "beside", "alongside"})
_COPULAS = frozenset({"is", "are", "be", "was", "stands", "stand", "sits", "lies", "located", "standing", "situated"})
_OTHERS = re.compile(r"\b(?:others?|another|second|this|these|those|else)\b")
_NEARBY = re.compile(r"\b(?:nearby|near by|close by|around)\b")


@dataclass(frozen=True, slots=True)
class Denied:
    """Something that is said not to be there, or not to be meant.

    Attributes:
        words: The whole clause.
        concepts: What it is of; concepts of the lexicon, or words that it lacks.
        relation: The relation that is denied; ``"with"`` for what shall not be there at all, ``""`` for what is not
            meant.
    """

    words: str
    concepts: tuple[str, ...]
    relation: str


def is_not_sought(text: str) -> Fault | None:
    """Return the fault of a sentence that says what is *not* to be found, or None."""
    match = NOT_SOUGHT.search(text)
    if match is None:
        return None
    return Fault(
        f"it says what is not to be found: {match.group().strip(' ,')!r}", "what is to be found, e.g. 'Find me a bench'"
    )


def breaks_off(text: str) -> Iterator[Fault]:
    """Yield the faults of clauses that end in a word that nothing follows: "a bench near the"."""
    clauses = re.split(r" , | (?:but|while|then) ", text)
    for place, clause in enumerate(clauses):
        match = HANGING.search(clause.strip())
        if match is None or match["word"] in _ADVERBS:
            continue
        before = clause[: match.start()].split()
        may_end = match["word"] in _STRANDED and PURPOSE.search(f" {clause[: match.start()]} ")
        if may_end and before[-1] not in _COPULAS:
            continue
        if match["word"] in _CLOSING and {"with", "has", "without"} & set(before) and before[-1] not in _COPULAS:
            continue
        if before or match["word"] not in {"and", "or", "no", "not"} or place == len(clauses) - 1 > 0:
            yield Fault(f"{match['word']!r} what? nothing follows", "a thing behind it", "say what, or leave it out")


def takes_back(
    sought: Sequence[str], near: Iterable[tuple[str, str]], denied: Iterable[Denied], *, text: str
) -> Iterator[Fault]:
    """Yield the faults of a goal that denies what it seeks, or wants a thing near and not near.

    Args:
        sought: Concepts, or words, of the alternatives that are sought.
        near: Relation and concept of what the sought thing must stand by.
        denied: What is denied.
        text: The sentence; distances in it are beyond this reading, and make no contradiction.
    """
    near = list(near)
    for item in denied:
        if _OTHERS.search(item.words):
            continue
        is_same = bool(sought) and all(_covers(item.concepts, one) for one in sought)
        # "a bench without a bench nearby" stands alone.
        if is_same and (not item.relation or (item.relation == "with" and not _NEARBY.search(text.lower()))):
            yield Fault(f"it seeks what it denies: {item.words!r}", "one of the two")
        for relation, concept in near if not re.search(r"\d", text) else ():
            if item.relation in {"with", "near", relation} and _covers(item.concepts, concept):
                yield Fault(f"it wants a thing {relation} and denies it: {item.words!r}", "one of the two")


def _covers(denied: Sequence[str], one: str) -> bool:
    return any(one == name or (one in concepts() and name in ancestors(one)) for name in denied)
