"""How a caption is worded: objects by nearness and side, relations, the ground, the background.

The order and wording follow what vision-language models answer when they are asked to describe the objects, their
spatial relations and the background. Nearness has fixed words, since readers of captions (people and minds) go by them:
"in the foreground", "close" up to 10 m; "a little further on", "further away" up to 25 m; "in the distance" beyond.
"""

import math
import re
from collections.abc import Sequence
from functools import lru_cache
from typing import NamedTuple

from reasoned_explorer.model.draws import key_of
from reasoned_explorer.simulation.sighting import GroundStretch, ViewContent
from reasoned_explorer.world.taxonomy import OBJECT_CLASSES, Ground

#: Up to these distances things are near and further on; beyond the second they are in the distance, metres.
NEAR_M, MIDDLE_M = 10.0, 25.0
#: A wall or large thing straight ahead within this distance blocks the way, metres.
BLOCKED_M = 4.0
#: Steps of nearness and sides.
NEAR, MIDDLE, FAR = 0, 1, 2
LEFT, AHEAD, RIGHT = 0, 1, 2

_NEXT_TO_M = 2.5
_SAME_LINE_RAD = 0.12
_BEHIND_M = 7.0
_LONGEST_NAME = 32

_LEADS = ("The image shows", "The image features", "The picture shows", "The scene shows", "This is a view of")
_ZONES = (
    ("In the foreground", "In the foreground, close to the viewer", "Close to the viewer"),
    ("A little further on", "Further away", "A bit further on"),
    ("In the distance", "Far off in the distance", "In the distance"),
)
_SIDES = (
    ("on the left", "to the left", "on the left side"),
    ("straight ahead", "straight ahead", "directly ahead"),
    ("on the right", "to the right", "on the right side"),
)
_COUNTS = ("no", "one", "two", "three", "four", "five")
_RELATIONS = ("next to", "in front of", "behind")

_SETTINGS = {
    Ground.UNKNOWN: ("an open outdoor area", "an outdoor area"),
    Ground.ROAD: ("a street", "a paved road"),
    Ground.PAVEMENT: ("a paved walkway", "a sidewalk"),
    Ground.PLAZA: ("an open plaza", "a paved square"),
    Ground.CYCLEWAY: ("a cycle path", "a bike path"),
    Ground.PATH: ("a footpath", "a walking path"),
    Ground.STEPS: ("a flight of steps", "some steps"),
    Ground.GRASS: ("a grassy area", "a green space with grass"),
    Ground.WOOD: ("a wooded area", "a small wood"),
    Ground.GARDEN: ("a garden", "a planted garden area"),
    Ground.SAND: ("a sandy area", "a stretch of sand"),
    Ground.WATER: ("a waterside", "the edge of the water"),
    Ground.PARKING: ("a parking lot", "a car park"),
    Ground.PITCH: ("a sports field", "a playing field"),
    Ground.PLAYGROUND: ("a play area", "the ground of a playground"),
    Ground.RAILWAY: ("railway tracks", "a stretch of railway"),
    Ground.CONSTRUCTION: ("a building site", "a construction site"),
    Ground.YARD: ("a yard", "a courtyard"),
    Ground.BUILDING: ("the side of a building", "a building from close up"),
}
_GROUNDS = {
    Ground.UNKNOWN: "open ground",
    Ground.ROAD: "a road",
    Ground.PAVEMENT: "a pavement",
    Ground.PLAZA: "a paved plaza",
    Ground.CYCLEWAY: "a cycle path",
    Ground.PATH: "a footpath",
    Ground.STEPS: "a flight of steps",
    Ground.GRASS: "grass",
    Ground.WOOD: "woodland",
    Ground.GARDEN: "a garden",
    Ground.SAND: "sand",
    Ground.WATER: "water",
    Ground.PARKING: "a parking lot",
    Ground.PITCH: "a sports field",
    Ground.PLAYGROUND: "playground surface",
    Ground.RAILWAY: "railway tracks",
    Ground.CONSTRUCTION: "a fenced building site",
    Ground.YARD: "a yard",
    Ground.BUILDING: "a building",
}
_WAYS = frozenset({Ground.ROAD, Ground.PAVEMENT, Ground.CYCLEWAY, Ground.PATH, Ground.STEPS})
_BARRIERS = {
    Ground.WATER: (
        "Water lies directly ahead and there is no way across on foot.",
        "A little further ahead the ground ends at the water.",
    ),
    Ground.RAILWAY: ("Railway tracks lie directly ahead.", "Railway tracks cross the view a little further ahead."),
    Ground.CONSTRUCTION: (
        "A fenced building site lies directly ahead.",
        "A fenced building site lies a little further ahead.",
    ),
}
_BUILDINGS = {
    "apartments": "apartment buildings",
    "residential": "residential buildings",
    "house": "houses",
    "detached": "houses",
    "terrace": "terraced houses",
    "church": "a large church building",
    "cathedral": "a large church building",
    "chapel": "a small chapel building",
    "commercial": "commercial buildings",
    "retail": "commercial buildings",
    "office": "office buildings",
    "university": "campus buildings",
    "school": "school buildings",
    "college": "campus buildings",
    "hotel": "large buildings",
    "industrial": "industrial buildings",
    "garage": "garages",
    "garages": "garages",
    "roof": "a roofed structure",
}


class Mention(NamedTuple):
    """One thing that a caption names.

    Attributes:
        class_name: What it is said to be.
        zone: `NEAR`, `MIDDLE` or `FAR`, as it is said to be.
        side: `LEFT`, `AHEAD` or `RIGHT`, likewise.
        ahead_m: Where it is: metres along the view's axis.
        right_m: Likewise, to the right.
        prominence: What is told first is largest.
        under: Class of what it is said to stand under, or None.
        sign: What a sign of it reads, already made harmless, or empty.
        twisted: Its relation to others is told wrongly.
        imagined: It is not there.
    """

    class_name: str
    zone: int
    side: int
    ahead_m: float
    right_m: float
    prominence: float
    under: str | None = None
    sign: str = ""
    twisted: bool = False
    imagined: bool = False


class _Group(NamedTuple):
    """Things of one class, nearness and side, told together."""

    first: Mention
    number: int
    prominence: float


def harmless_name(name: str) -> str:
    """Return a name as it may be quoted from a sign: letters, digits and plain marks, at most 32 characters.

    Names come from maps that anybody may edit; quotation marks, brackets, line ends and control characters in them
    could pass for the caption's own words.
    """
    plain = re.sub(r"[^\w .,&'’\-]|_", " ", name)
    plain = " ".join(plain.split()).strip(" .,&-")
    if len(plain) <= _LONGEST_NAME:
        return plain
    cut = plain[:_LONGEST_NAME]
    return (cut.rsplit(" ", 1)[0] if " " in cut else cut).rstrip(" .,&-")


def write_caption(
    mentions: Sequence[Mention],
    content: ViewContent,
    *,
    key: int,
    ground_ahead: Ground,
    blocked_by: str | None,
    max_groups: int | None = None,
) -> str:
    """Return a caption.

    Args:
        mentions: What is named, in any order.
        content: For the ground and the background.
        key: Of the draws that choose among wordings.
        ground_ahead: What the ground straight ahead is said to be.
        blocked_by: ``"building"`` or the class of what blocks the way straight ahead, or None.
        max_groups: Most groups that are named, the most prominent first; None for no limit.
    """
    groups = _grouped(mentions)
    if max_groups is not None and len(groups) > max_groups:
        # Whoever imagines a thing tells it.
        imagined = [group for group in groups[max_groups:] if group.first.imagined][:max_groups]
        groups = groups[: max_groups - len(imagined)] + imagined
    sentences = [f"{_pick(_LEADS, key, 0)} {_setting(content, ground_ahead, key)}."]
    if blocked_by is not None:
        sentences.append(_blocked(blocked_by, key))
    for zone in (NEAR, MIDDLE, FAR):
        here = [group for group in groups if group.first.zone == zone]
        if here:
            sentences.append(_zone_sentence(zone, here, key))
    if blocked_by is None:
        sentences.append(_ground_sentence(content.stretches, ground_ahead))
    sentences.append(_background(content, key))
    return " ".join(sentence for sentence in sentences if sentence)


def _pick(options: Sequence[str], key: int, slot: int) -> str:
    return options[key_of(key, slot) % len(options)]


def _grouped(mentions: Sequence[Mention]) -> list[_Group]:
    gathered: dict[tuple[str, int, int], list[Mention]] = {}
    for mention in mentions:
        # What has a sign of its own is told on its own.
        kind = mention.sign or mention.class_name
        gathered.setdefault((kind, mention.zone, mention.side), []).append(mention)
    groups = []
    for alike in gathered.values():
        first = max(alike, key=lambda mention: mention.prominence)
        groups.append(_Group(first, len(alike), math.fsum(mention.prominence for mention in alike)))
    groups.sort(key=lambda group: (-group.prominence, group.first))
    return groups


@lru_cache(maxsize=512)
def _noun(class_name: str, count: int) -> str:
    item = OBJECT_CLASSES[class_name]
    if count == 1:
        return f"{'an' if item.noun[0] in 'aeiou' else 'a'} {item.noun}"
    return f"{_COUNTS[count] if count < len(_COUNTS) else 'several'} {item.plural}"


def _relation(one: Mention, other: Mention) -> str | None:
    if "area" in {OBJECT_CLASSES[one.class_name].kind, OBJECT_CLASSES[other.class_name].kind}:
        return None
    gap_ahead, gap_right = other.ahead_m - one.ahead_m, other.right_m - one.right_m
    if gap_ahead * gap_ahead + gap_right * gap_right <= _NEXT_TO_M * _NEXT_TO_M:
        relation = 0
    elif abs(gap_ahead) <= _BEHIND_M and abs(gap_right) <= _SAME_LINE_RAD * (abs(one.ahead_m) + abs(other.ahead_m)):
        relation = 1 if gap_ahead > 0.0 else 2
    else:
        return None
    return _RELATIONS[(relation + 1) % 3 if one.twisted else relation]


def _listed(groups: Sequence[_Group]) -> str:
    """Groups as a list of noun phrases, with relations between single things."""
    phrases = []
    told = [False] * len(groups)
    for place, group in enumerate(groups):
        if told[place]:
            continue
        first = group.first
        phrase, under = _noun(first.class_name, group.number), first.under
        if first.sign:
            phrase += f' with a sign reading "{first.sign}"'
        if group.number == 1:
            for later in range(place + 1, len(groups)):
                other = groups[later]
                if told[later] or other.number != 1 or other.first.imagined or first.imagined or other.first.sign:
                    continue
                relation = _relation(first, other.first)
                if relation is not None:
                    told[later] = True
                    under = None if under == other.first.class_name else under
                    phrase += f" {relation} {_noun(other.first.class_name, 1)}"
                    break
        if under is not None:
            phrase += f" {'next to' if first.twisted else 'under'} {_noun(under, 1)}"
        phrases.append(phrase)
    return phrases[0] if len(phrases) == 1 else f"{', '.join(phrases[:-1])} and {phrases[-1]}"


def _zone_sentence(zone: int, groups: Sequence[_Group], key: int) -> str:
    clauses = []
    for side in (LEFT, AHEAD, RIGHT):
        here = [group for group in groups if group.first.side == side]
        if here:
            clauses.append((_pick(_SIDES[side], key, 10 + 3 * zone + side), _listed(here), here[0].number))
    zone_words = _pick(_ZONES[zone], key, 1 + zone)
    place, listed, count = clauses[0]
    if len(clauses) == 1 and key_of(key, 4 + zone) & 1:
        return f"{zone_words}, {listed} can be seen {place}."
    rest = "".join(f"; {place}, {listed}" for place, listed, _ in clauses[1:])
    return f"{zone_words}, {place}, there {'is' if count == 1 else 'are'} {listed}{rest}."


def _setting(content: ViewContent, ground: Ground, key: int) -> str:
    if content.building_share >= 0.3 and ground in {Ground.PAVEMENT, Ground.PLAZA} and key_of(key, 20) & 1:
        return "a paved pedestrian street" if ground == Ground.PAVEMENT else "a paved square between buildings"
    return _pick(_SETTINGS[ground], key, 21)


def _blocked(by: str, key: int) -> str:
    if by == "building":
        options = (
            "The wall of a building fills most of the view and blocks the way ahead.",
            "A building wall stands directly in front and blocks the way ahead.",
        )
        return _pick(options, key, 22)
    noun = _noun(by, 1)
    return f"{noun[0].upper()}{noun[1:]} stands directly in front, very close, and blocks the way ahead."


def _ground_sentence(stretches: Sequence[GroundStretch], ahead: Ground) -> str:
    left, middle, right = stretches[0], stretches[len(stretches) // 2], stretches[-1]
    for place, ground in enumerate((middle.near, middle.middle)):
        if ground in _BARRIERS:
            return _BARRIERS[ground][place]
    first = _GROUNDS[ahead]
    text = f"{first[0].upper()}{first[1:]} {'leads' if ahead in _WAYS else 'lies'} straight ahead"
    if middle.middle == Ground.BUILDING:
        text += " and ends at a building"
    elif middle.middle not in {middle.near, ahead, Ground.UNKNOWN}:
        text += f", then {_GROUNDS[middle.middle]}"
    on_left, on_right = _side_ground(left), _side_ground(right)
    if on_left == on_right:
        return f"{text}; there is {_GROUNDS[on_left]} on both sides." if on_left != ahead else f"{text}."
    sides = [f"{_GROUNDS[on_left]} to the left"] if on_left != ahead else []
    sides += [f"{_GROUNDS[on_right]} to the right"] if on_right != ahead else []
    return f"{text}; there is {' and '.join(sides)}."


def _side_ground(stretch: GroundStretch) -> Ground:
    """What one notices to a side: where the ray soon meets a wall the building, else the ground some steps away."""
    return Ground.BUILDING if stretch.ends_at == "building" and stretch.free_m < 6.0 else stretch.middle


def _background(content: ViewContent, key: int) -> str:
    things = list(dict.fromkeys(_BUILDINGS.get(kind, "buildings") for kind in content.building_kinds))[:2]
    if content.building_share < 0.15:
        things = things[:1]
    if any(stretch.far == Ground.WATER for stretch in content.stretches):
        things.append("water")
    if any(stretch.far == Ground.WOOD for stretch in content.stretches):
        things.append("woodland")
    if content.building_share < 0.8:
        things.append(("the sky", "the open sky")[content.building_share < 0.15])
    if not things:
        return ""
    listed = things[0] if len(things) == 1 else f"{', '.join(things[:-1])} and {things[-1]}"
    verb = "are" if things[0].endswith("s") else "is"
    return _pick((f"In the background there {verb} {listed}.", f"The background shows {listed}."), key, 23)
