"""The things of the outdoors, their words, and how alike they are.

The data lies in ``data/concepts.txt``, ``data/kin.txt`` and ``data/grounds.txt``: written for this package from common
sense, and graded by it. Nothing here was measured.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Generic, TypeVar

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class Concept:
    """One kind of thing.

    Attributes:
        name: Identifier; a class of worlds has the same name here.
        kind: ``furniture``, ``plant``, ``vehicle``, ``person``, ``animal``, ``place``, ``area``, ``building``,
            ``structure``, ``scene`` (a kind of surroundings), ``quality``, ``generic`` (only asked for, or a family),
            ``ground`` or ``background``.
        noun: Singular, for imagined scenes.
        plural: Plural.
        words: Every word for it, singular and plural.
        parents: What it is a kind of.
        ground: The ground that it is a stretch of, or None.
    """

    name: str
    kind: str
    noun: str
    plural: str
    words: tuple[str, ...]
    parents: tuple[str, ...]
    ground: str | None


def data_lines(name: str) -> list[str]:
    """Return the lines of a data file of this package, without comments and blank ones."""
    text = (files(__package__) / "data" / f"{name}.txt").read_text(encoding="utf-8")
    return [line for line in text.splitlines() if line.strip() and not line.startswith("#")]


@cache
def word_set(name: str) -> frozenset[str]:
    """Return a set of words of ``data/word_sets.txt``."""
    sets = dict(line.split("|") for line in data_lines("word_sets"))
    return frozenset(sets[name].split())


_OVES = {"half": "halves", "shelf": "shelves", "bookshelf": "bookshelves"}


def plural_of(noun: str) -> str:
    """Return the regular plural of a noun phrase; of ``"flight of x"`` the head is inflected."""
    head, of, rest = noun.partition(" of ")
    words = head.split(" ")
    last = words[-1]
    if last in _OVES:
        plural = _OVES[last]
    elif last.endswith(("s", "x", "z", "ch", "sh")):
        plural = last + "es"
    elif last.endswith("y") and last[-2:-1] not in tuple("aeiou"):
        plural = last[:-1] + "ies"
    else:
        plural = last + "s"
    return " ".join([*words[:-1], plural]) + of + rest


def _concept(line: str) -> Concept:
    name, kind, nouns, parents, ground = line.split("|")
    pairs = []
    for noun in nouns.split(","):
        singular, _, plural = noun.partition("/")
        pairs.append((singular, plural or plural_of(singular)))
    words = tuple(dict.fromkeys(word for pair in pairs for word in pair))
    return Concept(
        name, kind, *pairs[0], words, tuple(parent for parent in parents.split(",") if parent), ground.strip() or None
    )


@cache
def concepts() -> dict[str, Concept]:
    """Return all concepts by name, in the order of the data file."""
    return {concept.name: concept for concept in map(_concept, data_lines("concepts"))}


@cache
def word_table() -> dict[str, str]:
    """Return the concept of every word; a word that stands in two entries belongs to the first."""
    table: dict[str, str] = {}
    for concept in concepts().values():
        for word in concept.words:
            table.setdefault(word, concept.name)
    return table


@cache
def plurals() -> frozenset[str]:
    """Return the words that name more than one."""
    table = word_table()
    singular = {plural_of(word) for word in table}
    return frozenset(word for word in table if word in singular) | {c.plural for c in concepts().values()}


@cache
def ancestors(name: str) -> frozenset[str]:
    """Return everything that a concept is a kind of, at any remove."""
    found: set[str] = set()
    todo = list(concepts()[name].parents)
    while todo:
        parent = todo.pop()
        if parent not in found:
            found.add(parent)
            todo.extend(concepts()[parent].parents)
    return frozenset(found - {name})


@cache
def _kin() -> dict[tuple[str, str], float]:
    table = {}
    for line in data_lines("kin"):
        sought, seen, degree = line.split()
        table[sought, seen] = float(degree)
    return table


#: How much seeing a thing of the wider kind speaks for the narrower one: a tree, where a palm is sought.
WIDER_KIND = 0.45


@cache
def likeness(sought: str, seen: str) -> float:
    """Return how far one concept, where it is seen, is the one that is sought: 0 not at all, 1 it is."""
    if sought == seen or sought in ancestors(seen):
        return 1.0
    kin = _kin().get((sought, seen), 0.0)
    if kin == 0.0:
        # What holds for the family holds for its members: a statue is kin of a monument, so is a bust.
        kin = max((_kin().get((sought, parent), 0.0) for parent in ancestors(seen)), default=0.0)
    if seen in ancestors(sought) and concepts()[seen].kind != "generic":
        return max(kin, WIDER_KIND)
    return kin


@cache
def ground_words() -> dict[str, frozenset[str]]:
    """Return the grounds (names of `world.taxonomy.Ground`) that a word for ground means."""
    table: dict[str, frozenset[str]] = {}
    for line in data_lines("grounds"):
        _, words, grounds = line.split("|")
        for word in words.split(","):
            table.setdefault(word, frozenset(grounds.split()))
    return table


class PhraseTable(Generic[T]):
    """Finds the longest known phrase at a place in a list of words.

    Args:
        phrases: Each phrase, words parted by spaces, with what it means; of two equal ones the first counts.
    """

    def __init__(self, phrases: Iterable[tuple[str, T]]) -> None:
        self.single: dict[str, T] = {}
        # By the first two words: which lengths there are, longest first, and the phrases.
        self.multi: dict[str, dict[str, tuple[list[int], dict[str, T]]]] = {}
        for phrase, value in phrases:
            words = phrase.split(" ")
            if len(words) == 1:
                self.single.setdefault(phrase, value)
                continue
            lengths, found = self.multi.setdefault(words[0], {}).setdefault(words[1], ([], {}))
            found.setdefault(phrase, value)
            if len(words) not in lengths:
                lengths.append(len(words))
                lengths.sort(reverse=True)

    def at(self, words: list[str], start: int) -> tuple[int, T] | None:
        """Return how many words the longest phrase at ``start`` has and what it means, or None."""
        word = words[start]
        seconds = self.multi.get(word)
        if seconds is not None and start + 1 < len(words):
            rows = seconds.get(words[start + 1])
            if rows is not None:
                for count in rows[0]:
                    value = rows[1].get(" ".join(words[start : start + count]))
                    if value is not None:
                        return count, value
        value_or_none = self.single.get(word)
        return None if value_or_none is None else (1, value_or_none)


@cache
def thing_phrases() -> PhraseTable[str]:
    """Return the table that finds concepts in words."""
    return PhraseTable(word_table().items())


@cache
def mended_word(word: str) -> str | None:
    """Return the known word that a misspelt one probably means, or None.

    Only words of five and more letters, and only one slip: a letter too many, one missing, or two swapped.
    """
    if len(word) < 5 or not word.isalpha():
        return None
    if word in thing_phrases().single:
        return word
    known = {part for phrase in word_table() for part in phrase.split(" ") if len(part) >= 5}
    candidates = {word[:i] + word[i + 1 :] for i in range(len(word))}
    candidates |= {word[:i] + word[i + 1] + word[i] + word[i + 2 :] for i in range(len(word) - 1)}
    candidates |= {
        word[:i] + letter + word[i:] for i in range(1, len(word) + 1) for letter in "abcdefghijklmnopqrstuvwxyz"
    }
    hits = sorted(candidates & known)
    return hits[0] if hits else None
