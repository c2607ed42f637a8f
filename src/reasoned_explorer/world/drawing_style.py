"""Colours and lettering of the map pictures.

The palette is a light one: the ground recedes, what one could look for stands out. Colours that carry a meaning of
their own differ in lightness too, so that they can be told apart without seeing hue, and every symbol has its shape.
"""

import unicodedata
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.font_manager import FontProperties, get_font
from matplotlib.textpath import TextPath

from reasoned_explorer.world.taxonomy import Ground

_GROUND = {
    Ground.UNKNOWN: "#f3f0e9",
    Ground.ROAD: "#d3d5d8",
    Ground.PAVEMENT: "#e9e7e4",
    Ground.PLAZA: "#f4ead6",
    Ground.CYCLEWAY: "#d5d9ee",
    Ground.PATH: "#f0dfb9",
    Ground.STEPS: "#e8d6c1",
    Ground.GRASS: "#d2e4b6",
    Ground.WOOD: "#b2d199",
    Ground.GARDEN: "#dfe9b9",
    Ground.SAND: "#f7e9b4",
    Ground.WATER: "#a8d0e8",
    Ground.PARKING: "#dcdde6",
    Ground.PITCH: "#a9d8b9",
    Ground.PLAYGROUND: "#f3dcd3",
    Ground.RAILWAY: "#d9d2cf",
    Ground.CONSTRUCTION: "#e8d3ad",
    Ground.YARD: "#e9e1d2",
    Ground.BUILDING: "#d9c9b8",
}

#: The family that a symbol belongs to and its colour.
FAMILY_COLOURS: dict[str, str] = {
    "rest": "#7d4f24",
    "water": "#1a6fad",
    "safety": "#c42f1a",
    "tidy": "#56662f",
    "street": "#5b6068",
    "wheels": "#37489a",
    "culture": "#74378a",
    "food": "#c9620a",
    "service": "#0b757d",
    "play": "#ad3f73",
    "green": "#4d7d3a",
    "people": "#8b7d8f",
}


def mix(first: str, second: str, share: float) -> str:
    """Return the colour ``share`` (0 to 1) of the way from the first to the second, all as ``"#rrggbb"``."""
    pairs = zip(_channels(first), _channels(second), strict=True)
    return "#" + "".join(f"{round(a + (b - a) * share):02x}" for a, b in pairs)


def _channels(colour: str) -> tuple[int, int, int]:
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)


@dataclass(frozen=True, slots=True)
class Palette:
    """The colours of a map.

    Attributes:
        paper: The page.
        ink: Headlines and figures.
        soft_ink: Everything that is said quietly.
        rule: Thin lines of the layout.
        ground: Colour of each ground.
        hatch: The fine lines over unknown ground.
        roof: Roofs, from the lowest to the highest buildings.
        roof_edge: Their outline.
        shadow: Cast by buildings and trees.
        crowns: Tree crowns; one is drawn by lot for each tree.
        lane: Markings on roads and pitches.
        shore: Lines along the water.
    """

    paper: str = "#fdfcf9"
    ink: str = "#22272e"
    soft_ink: str = "#646b74"
    rule: str = "#cfcabf"
    ground: Mapping[Ground, str] = field(default_factory=lambda: dict(_GROUND))
    hatch: str = "#dcd6c8"
    roof: tuple[str, str] = ("#dccdbd", "#efe5da")
    roof_edge: str = "#ab9985"
    shadow: str = "#4a4038"
    crowns: tuple[str, ...] = ("#86b06c", "#7aa662", "#92ba72", "#739e63", "#9ac07f")
    lane: str = "#ffffff"
    shore: str = "#6fa9cf"

    def muted(self, share: float) -> "Palette":
        """Return the palette that has gone ``share`` (0 to 1) of the way to the page's colour."""

        def pale(colour: str) -> str:
            return mix(colour, self.paper, share)

        return replace(
            self,
            ground={ground: pale(colour) for ground, colour in self.ground.items()},
            hatch=pale(self.hatch),
            roof=(pale(self.roof[0]), pale(self.roof[1])),
            roof_edge=pale(self.roof_edge),
            shadow=pale(self.shadow),
            crowns=tuple(pale(colour) for colour in self.crowns),
            shore=pale(self.shore),
        )


#: The faces that matplotlib brings along; a picture then looks the same on every machine.
_FACES = {
    "sans": "DejaVuSans.ttf",
    "sans-bold": "DejaVuSans-Bold.ttf",
    "sans-italic": "DejaVuSans-Oblique.ttf",
    "serif": "STIXGeneral.ttf",
    "serif-bold": "STIXGeneralBol.ttf",
    "serif-italic": "STIXGeneralItalic.ttf",
}
_FALLBACK = {"serif": "sans", "serif-bold": "sans-bold", "serif-italic": "sans-italic"}
_MISSING = "\u25a1"


@lru_cache(maxsize=len(_FACES))
def _face_file(face: str) -> str:
    return str(Path(mpl.get_data_path()) / "fonts" / "ttf" / _FACES[face])


def font(face: str) -> FontProperties:
    """Return a face: ``sans`` or ``serif``, alone or with ``-bold`` or ``-italic``."""
    return FontProperties(fname=_face_file(face))


@lru_cache(maxsize=4096)
def _has_glyph(face: str, character: str) -> bool:
    return bool(get_font(_face_file(face)).get_char_index(ord(character)))


def printable(text: str, *, limit: int = 400) -> str:
    """Return text from outside as one line that is safe to print.

    Control and formatting characters go, white space becomes single spaces, lone surrogates go, and what is longer
    than ``limit`` ends in an ellipsis.
    """
    kept = "".join(
        " " if character.isspace() else character
        for character in unicodedata.normalize("NFC", text)
        if character.isspace() or unicodedata.category(character)[0] != "C"
    )
    return shortened(" ".join(kept.split()), limit)


def shortened(text: str, limit: int) -> str:
    """Return the text, cut to ``limit`` characters with an ellipsis where it is longer."""
    return text if len(text) <= limit else text[: max(limit - 1, 1)].rstrip() + "\u2026"


@lru_cache(maxsize=8192)
def set_in(face: str, text: str) -> tuple[str, str]:
    """Return the face that can print a line of text, and the text that it prints.

    A serif face gives way to its sans sister where it lacks a character; what neither has becomes a small box.
    """
    text = printable(text)
    for candidate in (face, _FALLBACK.get(face, face)):
        if all(_has_glyph(candidate, character) for character in text):
            return candidate, text
    last = _FALLBACK.get(face, face)
    return last, "".join(character if _has_glyph(last, character) else _MISSING for character in text)


def width_pt(text: str, face: str, size_pt: float) -> float:
    """Return how wide a line of text is, points; the sum of its letters, so that kerning only makes it narrower."""
    face, text = set_in(face, text)
    return sum(_advance(face, character) for character in text) * size_pt


@lru_cache(maxsize=8192)
def _advance(face: str, character: str) -> float:
    """Return how far a letter moves the pen at a size of 1: how far it pushes a bar that follows it."""
    pushed, alone = (
        float(np.asarray(TextPath((0.0, 0.0), text, size=100.0, prop=font(face)).vertices)[:, 0].max())
        for text in (character + "|", "|")
    )
    return max(pushed - alone, 0.0) / 100.0


def wrapped(text: str, face: str, size_pt: float, room_pt: float, max_lines: int) -> list[str]:
    """Return a text as at most ``max_lines`` lines that fit into ``room_pt`` points; what is left over is cut off.

    Words that are wider than a line are broken.
    """
    lines: list[str] = []
    line = ""
    words = printable(text).split(" ")
    while words:
        word = words.pop(0)
        longer = f"{line} {word}".strip()
        if width_pt(longer, face, size_pt) <= room_pt:
            line = longer
        elif line:
            lines.append(line)
            line = ""
            words.insert(0, word)
        else:
            fitting = _fitting(word, face, size_pt, room_pt)
            lines.append(word[:fitting])
            if word[fitting:]:
                words.insert(0, word[fitting:])
        if len(lines) >= max_lines and (words or line):
            cut = lines[max_lines - 1]
            while cut and width_pt(cut + "\u2026", face, size_pt) > room_pt:
                cut = cut[:-1]
            return [*lines[: max_lines - 1], cut.rstrip() + "\u2026"]
    return [*lines, line] if line else lines


def _fitting(word: str, face: str, size_pt: float, room_pt: float) -> int:
    low, high = 1, len(word)
    while low < high:
        middle = (low + high + 1) // 2
        if width_pt(word[:middle], face, size_pt) <= room_pt:
            low = middle
        else:
            high = middle - 1
    return low
