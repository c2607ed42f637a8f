"""What a person may have meant: known words spelt nearly like what was typed, and examples of what is known."""

import difflib
from collections.abc import Sequence

from reasoned_explorer.task import words
from reasoned_explorer.task.lexer import Kind, Token, known_words
from reasoned_explorer.world.taxonomy import OBJECT_CLASSES

_EXAMPLES = ("bench", "fountain", "fire_hydrant", "bus_stop", "waste_basket", "cafe", "playground")
#: A few things that can be asked for, of all that there are.
SOME_THINGS = (
    f"{', '.join(OBJECT_CLASSES[name].noun for name in _EXAMPLES)} and the like ({len(OBJECT_CLASSES)} in all)"
)
#: Alike enough to have been meant, as `difflib` measures it: one slip in a word of five letters.
_ALIKE = 0.75
_LONGEST = 3


def near_misses(phrase: str, *, most: int = 3) -> list[str]:
    """Return the known words that a phrase may be a slip of, the likeliest first; of one thing only one word."""
    found: dict[object, str] = {}
    for near in difflib.get_close_matches(phrase, known_words(), n=3 * most, cutoff=_ALIKE):
        noun = words.nouns().get(words.split_words(near))
        found.setdefault(near if noun is None else noun, near)
    return list(found.values())[:most]


def near_misses_among(tokens: Sequence[Token], *, most: int = 3) -> list[str]:
    """Return the same for all phrases of a sentence that hold a word that is not known."""
    found: dict[str, None] = {}
    for size in range(_LONGEST, 0, -1):
        for start in range(len(tokens) - size + 1):
            window = tokens[start : start + size]
            whole = all(token.kind in {Kind.WORD, Kind.SMALL, Kind.NOUN} for token in window)
            if whole and any(token.kind is Kind.WORD for token in window):
                found.update(dict.fromkeys(near_misses(" ".join(token.text for token in window), most=most)))
    return list(found)[:most]


def did_you_mean(near: Sequence[str]) -> str:
    """Return the question, or nothing where nothing is near."""
    return f"did you mean {' or '.join(near)}?" if near else ""
