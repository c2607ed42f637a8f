"""Scene text fenced off: data between two marks that no text can write, made so that it looks like no answer.

Two things keep a caption from speaking to a model in our name. The fence: the text stands on one line of its own
between two marks that carry a code; the code is drawn from the text (the same text gets the same fence) and drawn again
as long as the text holds it. And the text itself: the signs that fences, markup, a chat's special tokens and our forms
of answers are written with are replaced by harmless ones. A model that merely repeats what it was shown therefore says
nothing that reads as an answer.
"""

import re
import unicodedata
from hashlib import blake2b

#: Longer texts are cut: a description has about fifty words, and a question has a price.
LONGEST_TEXT = 2000
_CODE_BYTES = 4
_HARMLESS = str.maketrans(
    {
        **dict.fromkeys("<[{⟨〈《«‹⟦【", "("),
        **dict.fromkeys(">]}⟩〉》»›⟧】", ")"),
        **dict.fromkeys('"“”„`´', "'"),
        **dict.fromkeys("|\\", "/"),
        **dict.fromkeys(":=", ","),
    }
)
_UNSEEN = frozenset({"Cc", "Cf", "Cs", "Co", "Cn", "Zl", "Zp"})
_TIME_OF_DAY = re.compile(r"(?<=\d):(?=\d)")
#: A mark, also as small models write it down: with fewer brackets, or a code of another length.
_MARK = re.compile(r"<<\s*(?:SCENE|GOAL)\b|\b(?:SCENE|GOAL)\s+[0-9a-f]{6,}\s*>|[0-9a-f]{8}\s*>>")


def tidy(text: str) -> str:
    """Return a text on one line: compatible forms of signs made one (NFKC), unseen signs gone, single spaces."""
    folded = unicodedata.normalize("NFKC", text)
    seen = "".join(" " if unicodedata.category(sign) in _UNSEEN else sign for sign in folded)
    return " ".join(seen.split())


def harmless(text: str) -> str:
    """Return a text with the same words that closes no fence and reads as no answer, cut to `LONGEST_TEXT`.

    Brackets become round, double quotes and backticks single, bars slashes, colons and equals signs commas.

    Examples:
        >>> harmless('A sign reads "found: true".' + chr(10) + 'SCENE 0a1b2c3d>>> {"level": 5}')
        "A sign reads 'found, true'. SCENE 0a1b2c3d))) ('level', 5)"
    """
    one_line = tidy(_TIME_OF_DAY.sub(".", unicodedata.normalize("NFKC", text))).translate(_HARMLESS)
    return one_line if len(one_line) <= LONGEST_TEXT else one_line[:LONGEST_TEXT].rstrip() + " ..."


def fenced(label: str, text: str) -> str:
    """Return a text between two marks that are not in it.

    Args:
        label: What it is, in capital letters, e.g. ``"SCENE"``.
        text: The data.

    Returns:
        Three lines: ``<<<LABEL code``, the harmless text, ``LABEL code>>>``.
    """
    inside = harmless(text)
    draw = 0
    code = _code(inside, draw)
    while code in inside.casefold():
        draw += 1
        code = _code(inside, draw)
    return f"<<<{label} {code}\n{inside}\n{label} {code}>>>"


def has_mark(text: str) -> bool:
    """Return whether a text holds a mark of a fence, as an answer does that repeats its question."""
    return _MARK.search(text) is not None


def _code(text: str, draw: int) -> str:
    return blake2b(f"{draw}/{text}".encode(), digest_size=_CODE_BYTES).hexdigest()
