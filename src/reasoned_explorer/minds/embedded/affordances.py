"""What people want to do outdoors, and what serves it (``data/affordances.txt``; common sense, not measured)."""

import re
from dataclasses import dataclass
from functools import cache

from reasoned_explorer.minds.embedded.lexicon import data_lines

#: From this strength on a thing serves an affordance well enough to end a search.
SERVES = 0.8


#: What only says how a place should be, where something else is wanted there: "to sit in the shade".
QUALITIES = frozenset(
    {"shade", "sun", "shelter", "quiet", "view", "light", "water_fun", "flowers_smell", "people", "sit", "hide"}
)


@dataclass(frozen=True, slots=True)
class Affordance:
    """Something that one can do somewhere.

    Attributes:
        name: Identifier.
        cues: Words and phrases that ask for it.
        strengths: Concept names and how well each serves it, in (0, 1].
    """

    name: str
    cues: tuple[str, ...]
    strengths: tuple[tuple[str, float], ...]


@cache
def affordances() -> dict[str, Affordance]:
    """Return all affordances by name, in the order of the data file."""
    table = {}
    for line in data_lines("affordances"):
        name, cues, graded = line.split("|")
        parts = graded.split()
        strengths = tuple((concept, float(value)) for concept, value in zip(parts[::2], parts[1::2], strict=True))
        table[name] = Affordance(name, tuple(cues.split(",")), strengths)
    return table


#: Wishes that give way to a more particular one: "buy medicine" is about medicine.
_GENERAL = frozenset({"buy", "hide"})
_DETERMINERS = re.compile(r"\b(?:a|an|the|my|our|your|some|any|this|these|me|us)\s+(?=\w)")
_BIKES = re.compile(r"\b(?:bicycles?|bikes|cycle)\b")


def plain(text: str) -> str:
    """Return a (lower-case) text without the words that make no difference to what is wanted."""
    return _BIKES.sub("bike", _DETERMINERS.sub("", text))


@cache
def _cue_pattern() -> tuple[re.Pattern[str], dict[str, tuple[str, ...]]]:
    owners: dict[str, list[str]] = {}
    for affordance in affordances().values():
        for cue in dict.fromkeys(map(plain, affordance.cues)):
            owners.setdefault(cue, []).append(affordance.name)
    longest_first = sorted(owners, key=lambda cue: (-len(cue), cue))
    pattern = re.compile(r"(?<![\w'-])(?:" + "|".join(map(re.escape, longest_first)) + r")(?![\w'-])")
    return pattern, {cue: tuple(names) for cue, names in owners.items()}


def cues_in(text: str) -> tuple[str, ...]:
    """Return the cues in a (lower-case) text, the longest first; one inside of another does not count."""
    text = plain(text)
    found = {match.group() for match in _cue_pattern()[0].finditer(text)}
    return tuple(sorted(found, key=lambda cue: (-len(cue.split()), text.find(cue))))


def affordances_in(text: str) -> tuple[str, ...]:
    """Return the names of the affordances that a (lower-case) text asks for: the main one, then qualities of the place.

    A shorter cue inside of a longer one does not count: "play soccer" is not "play".
    """
    owners = _cue_pattern()[1]
    names = list(dict.fromkeys(name for cue in cues_in(text) for name in owners[cue]))
    # "Sit" is wanted for itself and, in "sit in the shade", the main thing; any other wish comes before it.
    wishes = [name for name in names if name not in QUALITIES]
    wishes.sort(key=lambda name: name in _GENERAL)
    main = wishes[0] if wishes else "sit" if "sit" in names else ""
    if not main:
        return tuple(names)
    return (main, *(name for name in names if name in QUALITIES and name not in {main, "sit"}))
