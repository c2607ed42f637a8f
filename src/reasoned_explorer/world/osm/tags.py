"""What OpenStreetMap's tags mean: numbers, directions, classes of objects.

Tags are written by thousands of people, so every reader here takes any text and answers None where it makes no sense.
The meanings are those of the OpenStreetMap wiki (Key:height, Key:direction, Key:building:levels, Map features).
"""

import math
import re
from collections.abc import Mapping

from reasoned_explorer.geometry import normalise_heading_rad
from reasoned_explorer.world.taxonomy import OBJECT_CLASSES

Tags = Mapping[str, str]

_FOOT_M = 0.3048
_NUMBER = r"([0-9]{1,9}(?:[.,][0-9]{1,9})?)"
_LENGTH = re.compile(rf"\s*[~≈]?\s*{_NUMBER}\s*([a-z]*)\s*\Z", re.IGNORECASE)
_FEET_INCHES = re.compile(rf"\s*{_NUMBER}\s*['′](?:\s*{_NUMBER}\s*(?:\"|''|″))?\s*\Z")
_UNITS_M = {"": 1.0, "m": 1.0, "metre": 1.0, "metres": 1.0, "meter": 1.0, "meters": 1.0, "cm": 0.01, "mm": 0.001,
            "km": 1000.0, "ft": _FOOT_M, "feet": _FOOT_M, "foot": _FOOT_M}  # fmt: skip
_COUNT = re.compile(rf"\s*{_NUMBER}(?:\s*[;,/-].*)?\Z", re.DOTALL)
_DEGREES = re.compile(r"\s*([0-9]{1,3}(?:\.[0-9]{1,6})?)\s*°?\s*\Z")
_COMPASS = ("N", "NNE", "NE", "ENE", "E", "ESE", "SE", "SSE", "S", "SSW", "SW", "WSW", "W", "WNW", "NW", "NNW")
_COMPASS_WORDS = {"NORTH": "N", "EAST": "E", "SOUTH": "S", "WEST": "W", "NORTHEAST": "NE", "SOUTHEAST": "SE",
                  "SOUTHWEST": "SW", "NORTHWEST": "NW"}  # fmt: skip

#: Attributes of objects that are kept; everything else on the map is left out.
KEPT_ATTRIBUTES = ("name", "material", "backrest", "colour", "species", "covered", "lit", "access", "fee", "cuisine",
                   "sport", "denotation", "wheelchair")  # fmt: skip
_ATTRIBUTE_LENGTH = 80

# Where a feature has several tags that mean something, the earlier key decides: the more special one first.
_CLASS_KEYS = ("emergency", "vending", "highway", "amenity", "leisure", "tourism", "historic", "advertising", "barrier",
               "man_made", "natural", "playground", "shop", "landuse", "traffic_sign")  # fmt: skip
_GONE = frozenset({"disused", "abandoned", "demolished", "razed", "removed", "proposed"})
_NOT_A_SHOP = frozenset({"no", "none", "vacant", "disused"})
# A plate in a wall or in the ground is no monument that one could see from afar.
_PLATES = frozenset({"plaque", "blue_plaque", "stolperstein", "stolperschwelle", "plate", "ghost_bike"})


def _tables() -> tuple[dict[tuple[str, str], str], dict[str, str]]:
    exact: dict[tuple[str, str], str] = {}
    wildcard: dict[str, str] = {}
    for item in OBJECT_CLASSES.values():
        if item.kind in {"vehicle", "person"}:
            continue  # maps show none; "vehicle" is a key about access
        for tag in item.tags:
            key, _, value = tag.partition("=")
            if value == "*":
                wildcard.setdefault(key, item.name)
            else:
                exact.setdefault((key, value), item.name)
    return exact, wildcard


_EXACT, _WILDCARD = _tables()
#: Keys that can make a feature an object.
CLASS_KEYS = frozenset(key for key, _ in _EXACT) | frozenset(_WILDCARD)


def parse_length_m(text: str | None) -> float | None:
    """Return a length in metres: ``12``, ``12 m``, ``12,5``, ``40'``, ``5'10"``, ``30 ft``; else None.

    The length is finite and at least 0.
    """
    if text is None:
        return None
    if match := _LENGTH.match(text):
        unit = _UNITS_M.get(match[2].lower())
        return None if unit is None else float(match[1].replace(",", ".")) * unit
    if match := _FEET_INCHES.match(text):
        inches = float(match[2].replace(",", ".")) if match[2] else 0.0
        return (float(match[1].replace(",", ".")) + inches / 12.0) * _FOOT_M
    return None


def parse_count(text: str | None) -> float | None:
    """Return a count, e.g. of levels, lanes or seats: the first number of ``"4"``, ``"4.5"``, ``"3;4"``; else None."""
    if text is None:
        return None
    match = _COUNT.match(text)
    return None if match is None else float(match[1].replace(",", "."))


def parse_direction_rad(text: str | None) -> float | None:
    """Return a heading in [0, 2π): ``"45"``, ``"NE"``, ``"north-east"``, ``"40-80"`` (its middle); else None."""
    if text is None:
        return None
    first = text.split(";")[0]
    if (single := _one_direction_deg(first)) is not None:
        return normalise_heading_rad(math.radians(single))
    start_text, dash, end_text = first.partition("-")
    start, end = _one_direction_deg(start_text), _one_direction_deg(end_text)
    if not dash or start is None or end is None:
        return None
    # A range turns clockwise from its start to its end.
    return normalise_heading_rad(math.radians(start + ((end - start) % 360.0) / 2.0))


def _one_direction_deg(text: str) -> float | None:
    if match := _DEGREES.match(text):
        degrees = float(match[1])
        return degrees if degrees <= 360.0 else None
    word = text.strip().upper().replace("-", "").replace("_", "").replace(" ", "")
    word = _COMPASS_WORDS.get(word, word)
    return _COMPASS.index(word) * 22.5 if word in _COMPASS else None


def layer_of(tags: Tags) -> int:
    """Return the layer of a feature: its tag, clipped to [-10, 10], or 0 where there is none that makes sense."""
    text = tags.get("layer")
    if text is None:
        return 0
    try:
        return max(-10, min(10, int(float(text))))
    except (ValueError, OverflowError):
        return 0


def is_set(tags: Tags, key: str) -> bool:
    """Return whether a tag is there and says anything but no."""
    return tags.get(key, "no") not in {"no", "none", "false", "0"}


def is_passage(tags: Tags) -> bool:
    """Return whether a way leads through a building at the level of the street."""
    return tags.get("tunnel") == "building_passage" and "highway" in tags


def is_gone(tags: Tags) -> bool:
    """Return whether a feature is said to be out of use, gone or only planned."""
    return not _GONE.isdisjoint(tags) and any(tags.get(key) in {"yes", "true"} for key in _GONE)


def is_below_ground(tags: Tags) -> bool:
    """Return whether a feature lies below the ground, where nobody outdoors sees it."""
    return layer_of(tags) < 0 or tags.get("location") == "underground" or tags.get("parking") == "underground"


def class_of(tags: Tags, *, is_node: bool) -> str | None:
    """Return the class of object that a feature is, or None where it is none.

    Args:
        tags: Its tags.
        is_node: Whether it is a single point; on lines and areas ``traffic_sign`` states a rule and no sign.
    """
    if CLASS_KEYS.isdisjoint(tags) or is_gone(tags):
        return None
    for key in _CLASS_KEYS:
        value = tags.get(key)
        if value is None:
            continue
        name = _EXACT.get((key, value))
        if name is None and key in _WILDCARD and value not in _NOT_A_SHOP and (is_node or key != "traffic_sign"):
            name = _WILDCARD[key]
        if name == "monument" and tags.get("memorial", tags.get("memorial:type")) in _PLATES:
            continue
        if name is not None:
            return name
    return None


def attributes_of(tags: Tags) -> dict[str, str]:
    """Return the attributes that are kept: text as data, printable, at most 80 characters each.

    A hydrant's ``fire_hydrant:type`` is kept as ``type``: ``underground`` ones are lids in the ground.
    """
    kept = {key: clean_text(tags[key]) for key in KEPT_ATTRIBUTES if key in tags}
    kept["type"] = clean_text(tags.get("fire_hydrant:type", ""))
    return {key: value for key, value in kept.items() if value}


def clean_text(text: str) -> str:
    """Return a text from the map without control characters, at most 80 characters long."""
    if not text.isprintable():
        text = "".join(sign if sign.isprintable() else " " for sign in text)
    return text.strip()[:_ATTRIBUTE_LENGTH].strip()
