"""Levels, yes or no, and shares, as models write them: as numbers, words, other scripts' digits. None where unclear."""

import re
import unicodedata

_NUMBER = re.compile(r"([-+]?\d{1,6}(?:[.,]\d{1,12})?)(.*)", re.DOTALL)
_OUT_OF = re.compile(r"\s*(?:/|out of\b|of\b)\s*(\d+(?:\.\d+)?)(?!\d)(.*)", re.DOTALL | re.IGNORECASE)
_RANGE = re.compile(r"\s*(?:-|–|—|~|to\b|or\b|and\b|/|\|)\s*[\d*_]", re.IGNORECASE)
_TOP = 5
#: Names of the five levels: those that the prompt gives, and those that scales go by.
LEVEL_WORDS = {
    "very unlikely": 1, "very low": 1, "one": 1,
    "unlikely": 2, "low": 2, "two": 2,
    "possible": 3, "medium": 3, "moderate": 3, "neutral": 3, "three": 3,
    "likely": 4, "high": 4, "four": 4,
    "very likely": 5, "very high": 5, "five": 5,
}  # fmt: skip
_LEVEL_WORD = re.compile(rf"({'|'.join(sorted(LEVEL_WORDS, key=len, reverse=True))})(?![-\w])(.*)", re.DOTALL)
_EITHER = re.compile(r"\s*(?:/|\||,|or\b|and\b|to\b|-)\s*(?:very\s+)?(?:yes|no|true|false|low|high|likely|unlikely)\b")
_YES_NO = {"yes": True, "true": True, "y": True, "1": True, "no": False, "false": False, "n": False, "0": False}
_YES_NO_WORD = re.compile(r"(yes|true|no|false|y|n|1|0)(?![-\w.]\w|\w)(.*)", re.DOTALL)
_WRAPPING = " \t\r\n*_`\"'()[]"


def latin_digits(text: str) -> str:
    """Return a text with the digits of every script as 0 to 9, and compatible forms of signs made one (NFKC).

    Examples:
        >>> latin_digits("LEVEL: ٤")
        'LEVEL: 4'
    """
    return "".join(
        str(unicodedata.digit(sign)) if sign.isdecimal() else sign for sign in unicodedata.normalize("NFKC", text)
    )


def level_in(value: object) -> float | None:
    """Return the level that a value says, in [1, 5]; None where it says none, another scale's, or several.

    Examples:
        >>> level_in("4 out of 5"), level_in("very likely"), level_in(8), level_in("3 to 4")
        (4.0, 5.0, None, None)
    """
    if isinstance(value, bool):
        return None
    if isinstance(value, int | float):
        return float(value) if 1 <= value <= _TOP else None  # NaN is outside, too
    return _level_in_words(latin_digits(value).casefold().lstrip(_WRAPPING)) if isinstance(value, str) else None


def _level_in_words(text: str) -> float | None:
    number = _NUMBER.match(text)
    if number is None:
        word = _LEVEL_WORD.match(text)
        return float(LEVEL_WORDS[word[1]]) if word and not _EITHER.match(word[2]) else None
    level, rest = float(number[1].replace(",", ".")), number[2]
    out_of = _OUT_OF.match(rest)
    if out_of is not None:
        if float(out_of[1]) != _TOP:
            return None
        rest = out_of[2]
    if not 1 <= level <= _TOP or _RANGE.match(rest) or re.match(r"\s*%|\w|[.,]\d", rest):
        return None
    return level


def yes_or_no(value: object) -> bool | None:
    """Return what a value says; None where it says neither or both.

    Examples:
        >>> yes_or_no(True), yes_or_no("No, only a tree"), yes_or_no("yes/no"), yes_or_no("maybe"), yes_or_no(2)
        (True, False, None, None, None)
    """
    if isinstance(value, bool):
        return value
    if isinstance(value, int | float):
        return bool(value) if value in {0, 1} else None
    if not isinstance(value, str):
        return None
    word = _YES_NO_WORD.match(latin_digits(value).casefold().lstrip(_WRAPPING))
    return _YES_NO[word[1]] if word and not _EITHER.match(word[2]) else None


def share_in(value: object) -> float | None:
    """Return the share that a value says, in [0, 1]: up to 1 as it is, above that as a percentage.

    Examples:
        >>> share_in(0.8), share_in("85 %"), share_in(1), share_in("sure"), share_in(250)
        (0.8, 0.85, 1.0, None, None)
    """
    percent = False
    if isinstance(value, str):
        number = _NUMBER.match(latin_digits(value).lstrip(_WRAPPING))
        if number is None or _RANGE.match(number[2]):
            return None
        value, percent = float(number[1].replace(",", ".")), number[2].lstrip().startswith("%")
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0 <= value <= 100:  # NaN is outside, too
        return None
    return value / 100 if percent or value > 1 else float(value)
