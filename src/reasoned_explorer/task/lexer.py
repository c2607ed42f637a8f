"""From a goal's sentence to tokens: the longest known phrase at each place."""

import re
import unicodedata
from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum, auto
from functools import cache
from typing import Any

from reasoned_explorer.task import words
from reasoned_explorer.task.goal_spec import AttributeTest, Relation
from reasoned_explorer.task.grades import affordances

_WORD = re.compile(r"[^\W_]+(?:['’\-.][^\W_]+)*|[,;.!?:()]", re.UNICODE)
_DISTANCE = re.compile(r"(\d+(?:\.\d+)?)(m|metres|meters|metre|meter)?")
_METRES = {"m", "metres", "meters", "metre", "meter"}


class Kind(Enum):
    """What a token is to the grammar."""

    LEAD = auto()
    DENIAL = auto()
    NOUN = auto()
    AFFORDANCE = auto()
    RELATION = auto()
    QUALITY = auto()
    ATTRIBUTE = auto()
    PATH = auto()
    CLOSER = auto()
    AND = auto()
    OR = auto()
    BREAK = auto()
    SMALL = auto()
    WORD = auto()


@dataclass(frozen=True, slots=True)
class Token:
    """A phrase of a sentence.

    Attributes:
        kind: What it is to the grammar.
        text: Its words.
        value: What it stands for; its type depends on the kind.
    """

    kind: Kind
    text: str
    value: Any = None


def fold(text: str) -> str:
    """Return a text in the form in which phrases are compared: NFKC, lower case, straight apostrophes."""
    return unicodedata.normalize("NFKC", text).casefold().replace("’", "'")


def tokens_of(text: str) -> list[Token]:
    """Return the tokens of a sentence."""
    parts = _WORD.findall(fold(text))
    table, longest = _table()
    found: list[Token] = []
    place = 0
    while place < len(parts):
        special = _named(parts, place) or _within(parts, place)
        if special is not None:
            token, place = special
            found.append(token)
            continue
        for size in range(min(longest, len(parts) - place), 0, -1):
            token_or_none = table.get(tuple(parts[place : place + size]))
            if token_or_none is not None:
                found.append(token_or_none)
                place += size
                break
        else:
            part = parts[place]
            found.append(Token(Kind.BREAK if part in ",;.!?:()" else Kind.WORD, part))
            place += 1
    return found


def known_words() -> tuple[str, ...]:
    """Return all nouns and affordances that the judge knows, for near misses."""
    phrases = [" ".join(item) for item in words.nouns()]
    phrases += [" ".join(item) for one in affordances().values() for item in one.phrases]
    return tuple(sorted(phrases))


def _named(parts: list[str], place: int) -> tuple[Token, int] | None:
    """Return "called X" or "named X Y", up to the next mark or relation, as a test of the name."""
    if parts[place] not in {"called", "named"}:
        return None
    table, _ = _table()
    end = place + 1
    while end < len(parts) and parts[end] not in ",;.!?:()":
        token = table.get((parts[end],))
        if end > place + 1 and token is not None and token.kind in {Kind.RELATION, Kind.PATH, Kind.BREAK, Kind.AND}:
            break
        end += 1
    name = " ".join(parts[place + 1 : end])
    return (Token(Kind.ATTRIBUTE, f"called {name}", AttributeTest("name", (name,))), end) if name else None


def _within(parts: list[str], place: int) -> tuple[Token, int] | None:
    """Return "within 10 m of" or "less than 10 metres from" as a relation."""
    start = place
    if parts[place] == "not":
        place += 1
    for head in (("within",), ("less", "than"), ("at", "most"), ("more", "than"), ("at", "least")):
        if tuple(parts[place : place + len(head)]) == head:
            break
    else:
        return None
    place += len(head)
    match = _DISTANCE.fullmatch(parts[place]) if place < len(parts) else None
    if match is None:
        return None
    place += 1
    if match[2] is None:
        if place >= len(parts) or parts[place] not in _METRES:
            return None
        place += 1
    while place < len(parts) and parts[place] in {"of", "from", "away"}:
        place += 1
    negated = (parts[start] == "not") != (head in {("more", "than"), ("at", "least")})
    return Token(Kind.RELATION, " ".join(parts[start:place]), (Relation.NEAR, negated, float(match[1]))), place


@cache
def _table() -> tuple[dict[tuple[str, ...], Token], int]:
    paths = words.path_markers().items()
    # Later entries win over earlier ones of the same words.
    listed: list[tuple[Kind, Iterable[tuple[tuple[str, ...], Any]]]] = [
        (Kind.SMALL, (((word,), None) for word in sorted(words.SMALL_WORDS))),
        (Kind.NOUN, words.nouns().items()),
        (Kind.RELATION, words.relations().items()),
        (Kind.PATH, ((p, marker) for p, marker in paths if p not in words.relations() or not marker[0])),
        (Kind.QUALITY, words.qualities().items()),
        (Kind.ATTRIBUTE, words.attributes().items()),
        (Kind.AFFORDANCE, ((phrase, item) for item in affordances().values() for phrase in item.phrases)),
        (Kind.LEAD, ((phrase, None) for phrase in words.LEADS)),
        (Kind.DENIAL, ((phrase, None) for phrase in words.DENIALS)),
        (Kind.CLOSER, ((phrase, None) for phrase in words.CLOSERS)),
        (Kind.BREAK, (((word,), None) for word in ("but", "then", "while"))),
        (Kind.AND, (((word,), None) for word in ("and", "nor"))),
        (Kind.OR, ((("or",), None),)),
    ]
    table = {phrase: Token(kind, " ".join(phrase), value) for kind, entries in listed for phrase, value in entries}
    return table, max(len(phrase) for phrase in table)
