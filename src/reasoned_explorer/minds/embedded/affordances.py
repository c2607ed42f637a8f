"""What people want to do outdoors, and what serves it (``data/affordances.txt``; common sense, not measured)."""

import re
from dataclasses import dataclass
from functools import cache

from reasoned_explorer.minds.embedded.lexicon import data_lines

#: From this strength on a thing serves an affordance well enough to end a search.
SERVES = 0.8


#: What only says how a place should be, where something else is wanted there: "to sit in the shade".
QUALITIES = frozenset(
    {"shade", "sun", "shelter", "quiet", "view", "light", "water_fun", "flowers_smell", "people", "sit"}
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


@cache
def _cue_pattern() -> tuple[re.Pattern[str], dict[str, tuple[str, ...]]]:
    owners: dict[str, list[str]] = {}
    for affordance in affordances().values():
        for cue in affordance.cues:
            owners.setdefault(cue, []).append(affordance.name)
    longest_first = sorted(owners, key=lambda cue: (-len(cue), cue))
    pattern = re.compile(r"(?<![\w'])(?:" + "|".join(map(re.escape, longest_first)) + r")(?![\w'])")
    return pattern, {cue: tuple(names) for cue, names in owners.items()}


def affordances_in(text: str) -> tuple[str, ...]:
    """Return the names of the affordances that a (lower-case) text asks for: the main one, then qualities of the place.

    A shorter cue inside of a longer one does not count: "play soccer" is not "play".
    """
    pattern, owners = _cue_pattern()
    cues = sorted(
        {match.group() for match in pattern.finditer(text)}, key=lambda cue: (-len(cue.split()), text.find(cue))
    )
    names = list(dict.fromkeys(name for cue in cues for name in owners[cue]))
    # "Sit" is wanted for itself and, in "sit in the shade", the main thing; any other wish comes before it.
    main = next((name for name in names if name not in QUALITIES), "sit" if "sit" in names else "")
    if not main:
        return tuple(names)
    return (main, *(name for name in names if name in QUALITIES and name not in {main, "sit"}))
