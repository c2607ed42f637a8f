"""From the log-probabilities of an answer's tokens to probabilities of what it could have said instead."""

import math
import re
from collections.abc import Callable, Hashable, Sequence
from typing import TypeVar

from reasoned_explorer.calls.chat import TokenChoice
from reasoned_explorer.minds.prompted.values import LEVEL_WORDS, latin_digits
from reasoned_explorer.model import likert_from_score

T = TypeVar("T", bound=Hashable)
Levels = tuple[float, float, float, float, float]

_WRAPPING = " \t\r\n*_`\"'()[]{}:=,.;▁ĠĊ"
_LEVEL_AT = re.compile(r"(?:level|score|rating)[\"'*_`)\s]*[:=][\"'*_`\s]*(\w)", re.IGNORECASE)
_FOUND_AT = re.compile(r"found[\"'*_`)\s]*[:=][\"'*_`\s]*(\w)", re.IGNORECASE)
_FIRST = re.compile(r"[\s*_#>\"'`(]*(\w)")
_SHORTEST_WORD = 3
#: Logarithms of probabilities may be told a little above 0.
_ROUNDING = 1e-3
_YES, _NO = ("yes", "true"), ("no", "false")


def level_chances(level: float, tokens: Sequence[TokenChoice]) -> Levels:
    """Return probabilities of the five levels.

    Args:
        level: That the answer says, in [1, 5].
        tokens: The answer's places; without alternatives, or where the level that was said is not among them, or where
            it lies between two levels, all probability is with what was said.
    """
    said = likert_from_score(level)
    if level != int(level):
        return said
    chances = _chances(_place(tokens, _LEVEL_AT), int(level), _level_of)
    if chances is None:
        return said
    one, two, three, four, five = (chances.get(number, 0.0) for number in range(1, 6))
    return one, two, three, four, five


def yes_chance(found: bool, tokens: Sequence[TokenChoice]) -> float | None:  # noqa: FBT001 - it is what was said
    """Return the probability of "found" among yes and no; None where the tokens do not tell it."""
    chances = _chances(_place(tokens, _FOUND_AT), found, _yes_or_no_of)
    return None if chances is None else chances.get(True, 0.0)


def _place(tokens: Sequence[TokenChoice], label: re.Pattern[str]) -> TokenChoice | None:
    """Return the token that holds what was said after a label; where no label is, the first."""
    text = "".join(token.token for token in tokens)
    labelled = list(label.finditer(text))
    if len(labelled) > 1:
        return None
    match = labelled[0] if labelled else _FIRST.match(text)
    if match is None:
        return None
    end = 0
    for token in tokens:
        end += len(token.token)
        if end > match.start(1):
            return token
    return None


def _chances(place: TokenChoice | None, said: T, value_of: Callable[[str], T | None]) -> dict[T, float] | None:
    """Return the probabilities of values among the alternatives that are one; None where what was said is not there."""
    if place is None or value_of(place.token) != said:
        return None
    masses: dict[T, float] = {}
    for token, logarithm in place.alternatives:
        value = value_of(token)
        if value is not None and logarithm < _ROUNDING:  # NaN and what is no probability are left out
            masses[value] = masses.get(value, 0.0) + math.exp(min(0.0, logarithm))
    total = sum(masses.values())
    return {value: mass / total for value, mass in masses.items()} if masses.get(said, 0.0) > 0.0 else None


def _bare(token: str) -> str:
    return latin_digits(token).casefold().strip(_WRAPPING)


def _level_of(token: str) -> int | None:
    bare = _bare(token)
    if bare.isdecimal() and len(bare) == 1:
        return int(bare) if 1 <= int(bare) <= 5 else None
    return LEVEL_WORDS.get(bare)


def _yes_or_no_of(token: str) -> bool | None:
    bare = _bare(token)
    if not bare:
        return None
    for words, value in ((_YES, True), (_NO, False)):
        if any(bare == word or (len(bare) >= _SHORTEST_WORD and word.startswith(bare)) for word in words):
            return value
    return None
