"""What one would see about ten metres further on: L(S_t) → S_{t+1}.

Far things come to the middle, things in the middle come close, close ones are reached or passed, the ground goes on;
and something new comes into view, drawn from what stands near such things in real places. True to what is seen, and
blind to the goal, as the paper's visionary is.
"""

from bisect import bisect_right
from dataclasses import dataclass
from functools import cache, lru_cache

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.minds.embedded.lexicon import concepts
from reasoned_explorer.minds.embedded.reading import (
    AHEAD,
    BACKGROUND,
    FAR,
    LEFT,
    MIDDLE,
    NEAR,
    RIGHT,
    Mention,
    SceneReading,
    read_scene,
)
from reasoned_explorer.minds.embedded.relevance import Senses
from reasoned_explorer.model.draws import further, key_of

#: About how many words an imagined scene has (the authors' prompt asks for 50).
WORDS = 50
# How things move up in ten metres; assumed: the bands are about 10, 25 and 60 m wide.
_STAYS_CLOSE_AHEAD, _STAYS_CLOSE_ASIDE = 0.5, 0.25
_COMES_TO_MIDDLE, _COMES_OUT_OF_BACKGROUND = 0.85, 0.25
_UNSAID_NEAR, _UNSAID_MIDDLE = 0.6, 0.25
_GROUND_GOES_ON = 0.85
_SECOND_NEW_THING = 0.5
#: Without place statistics: what stands about, all equally likely.
_COMMON = (
    *("bench", "tree", "street_lamp", "waste_basket", "car", "bicycle_parking", "shop", "cafe", "restaurant", "lawn"),
    *("traffic_sign", "person", "fountain", "playground", "bus_stop", "post_box", "artwork", "shrub"),
)
#: A neighbour's lift counts for this power of itself, and only the first few neighbours count.
_LIFT_POWER, _WITNESSES = 0.4, 4
_LEADS = {NEAR: "Close by", MIDDLE: "A little further on", FAR: "In the distance", BACKGROUND: "In the background"}
_AT = {LEFT: " on the left", AHEAD: " straight ahead", RIGHT: " on the right", None: ""}
_WITH_RELATION = {
    "near": "next to",
    "under": "under",
    "on": "on",
    "in": "in",
    "in_front": "in front of",
    "behind": "behind",
}
_ORDER = {MIDDLE: 0, NEAR: 1, None: 2, FAR: 3}
_SIDES = (LEFT, AHEAD, RIGHT)
_UNREMARKABLE = frozenset({"background", "generic", "structure", "quality"})
_BLOCKED = "The wall of a building fills most of the view and blocks the way ahead."


@dataclass(frozen=True, slots=True)
class _Thing:
    """Something that may be seen again further on.

    Attributes:
        name: What it is called, with an article.
        many: Whether it is more than one.
        distance: As in `Mention`.
        side: Likewise.
        relation: Relation and name of the other thing, or empty.
    """

    name: str
    many: bool
    distance: int | None
    side: int | None
    relation: str


@dataclass(frozen=True, slots=True, eq=False)
class _Outlook:
    """What a caption leaves to be seen further on, whatever the draw."""

    opening: tuple[str, ...]
    room: int
    things: tuple[_Thing, ...]
    grounds: tuple[str | None, str | None, str | None]
    background: tuple[_Thing, ...]
    chances: tuple[float, ...]
    names: tuple[str, ...]


@cache
def _ground_nouns() -> dict[str, str]:
    nouns: dict[str, str] = {}
    for concept in concepts().values():
        if concept.ground is not None and concept.kind != "scene":
            nouns.setdefault(concept.ground, concept.noun)
    return nouns | {"GRASS": "grass", "PARKING": "car park", "WATER": "water", "SAND": "sand", "WOOD": "wood"}


def _with_article(noun: str, *, many: bool) -> str:
    if many or noun in {"grass", "water", "sand", "steps", "shade", "sky", "snow", "greenery"}:
        return noun
    return f"an {noun}" if noun[0] in "aeiou" and not noun.startswith("uni") else f"a {noun}"


def _name(mention: Mention) -> str:
    many = mention.count > 1
    if mention.concept is None:
        return mention.words if many else _with_article(mention.words, many=False)
    concept = concepts()[mention.concept]
    if many:
        return f"{'many' if mention.count > 2 else 'some'} {concept.plural}"
    return _with_article(concept.noun, many=False)


def _relation_of(mention: Mention) -> str:
    for relation, other in mention.relations:
        words = _WITH_RELATION.get(relation)
        concept = concepts().get(other)
        if words is not None and concept is not None and concept.kind != "scene":
            return f" {words} {_with_article(concept.noun, many=False)}"
    return ""


@dataclass(frozen=True, slots=True, eq=False)
class _News:
    """What can come into view: names, how often each stands about, and how much likelier each seen thing makes it."""

    names: tuple[str, ...]
    base: NDArray[np.float64]
    rows: dict[str, NDArray[np.float64]]


@cache
def _news(senses: Senses) -> _News:
    statistics = senses.statistics
    if statistics is None:
        return _News(_COMMON, np.ones(len(_COMMON)), {})
    names = tuple(name for name in sorted(statistics.density_per_km2) if name in concepts())
    # The square root: one speaks of what is striking, not of the fortieth tree.
    base = np.array([statistics.density_per_km2[name] ** 0.5 for name in names])
    rows = {
        given: np.array([min(8.0, max(0.125, statistics.lift_ahead(given, name))) ** _LIFT_POWER for name in names])
        for given in names
    }
    return _News(names, base, rows)


def _chances(reading: SceneReading, news: _News) -> tuple[float, ...]:
    """Return the running sum of how likely each new thing is."""
    chances = news.base
    witnesses = 0
    for concept in dict.fromkeys(m.concept for m in reading.mentions if not m.negated and m.distance != BACKGROUND):
        row = news.rows.get(concept) if concept is not None else None
        if row is not None:
            chances = chances * row
            witnesses += 1
            if witnesses == _WITNESSES:
                break
    return tuple(np.cumsum(chances).tolist())


@lru_cache(maxsize=16384)
def _outlook(text: str, senses: Senses) -> _Outlook:
    reading = read_scene(text)
    intro = ""
    things: list[_Thing] = []
    background: list[_Thing] = []
    for mention in reading.mentions:
        if mention.negated:
            continue
        concept = concepts()[mention.concept] if mention.concept is not None else None
        if concept is not None and concept.kind == "scene" and mention.distance is None:
            intro = intro or f"The image shows {_with_article(concept.noun, many=False)}."
            continue
        if concept is not None and (concept.kind in _UNREMARKABLE or (reading.blocked and concept.kind == "building")):
            continue
        if concept is not None and concept.ground is not None and mention.distance is None:
            continue  # said again as ground
        thing = _Thing(_name(mention), mention.count > 1, mention.distance, mention.side, _relation_of(mention))
        (background if mention.distance == BACKGROUND else things).append(thing)
    # What comes close next matters most, then what is close now.
    things.sort(key=lambda thing: _ORDER[thing.distance])
    news = _news(senses)
    grounds = (reading.ground_left, reading.ground_ahead or reading.ground_here, reading.ground_right)
    opening = tuple(sentence for sentence in (intro, _BLOCKED if reading.blocked else "") if sentence)
    room = WORDS - sum(_words_of(sentence) for sentence in opening)
    return _Outlook(
        opening, room, tuple(things[:7]), grounds, tuple(background[:2]), _chances(reading, news), news.names
    )


def _words_of(sentence: str) -> int:
    return sentence.count(" ") + 1


def _sentence(thing: _Thing, distance: int) -> str:
    verb = "there are" if thing.many else "there is"
    comma = "," if distance == MIDDLE and thing.side is not None else ""
    return f"{_LEADS[distance]}{comma}{_AT[thing.side]}, {verb} {thing.name}{thing.relation}."


@lru_cache(maxsize=4096)
def _new_thing(name: str, side: int) -> _Thing:
    return _Thing(_with_article(concepts()[name].noun, many=False), many=False, distance=None, side=side, relation="")


def _moved(thing: _Thing, draw: float) -> int | None:
    """Return where a thing is ten metres further on, or None where it has been passed."""
    if thing.distance == NEAR:
        stays = _STAYS_CLOSE_AHEAD if thing.side in {None, AHEAD} else _STAYS_CLOSE_ASIDE
        return NEAR if draw < stays else None
    if thing.distance == MIDDLE:
        return NEAR
    if thing.distance == FAR:
        return MIDDLE if draw < _COMES_TO_MIDDLE else FAR
    return NEAR if draw < _UNSAID_NEAR else MIDDLE if draw < _UNSAID_NEAR + _UNSAID_MIDDLE else None


@lru_cache(maxsize=4096)
def _ground_sentence(ahead: str | None, left: str | None, right: str | None) -> str:
    nouns = _ground_nouns()
    parts = []
    if ahead in nouns:
        parts.append(f"{_with_article(nouns[ahead], many=False)} leads straight ahead")
    for ground, side in ((left, "left"), (right, "right")):
        if ground in nouns:
            parts.append(f"{_with_article(nouns[ground], many=False)} lies to the {side}")
    text = "; ".join(parts)
    return f"{text[0].upper()}{text[1:]}." if text else ""


class _Draws:
    """The draws of one child, one after the other: a linear congruential sequence from a key of its own.

    Multiplier and increment are those of Knuth's MMIX; only the upper bits are used.
    """

    def __init__(self, key: int) -> None:
        self._state = key

    def next(self) -> float:
        self._state = (self._state * 6364136223846793005 + 1442695040888963407) & 0xFFFFFFFFFFFFFFFF
        return (self._state >> 11) * (1.0 / (1 << 53))


def imagine_texts(text: str, *, seed: int, key: tuple[int, ...], count: int, senses: Senses) -> tuple[str, ...]:
    """Return what one might see ten metres further on, in ``count`` different ways.

    Args:
        text: What is seen.
        seed: Of the mission.
        key: Of the scene; with it, the draws are its own.
        count: How many.
        senses: What is known of places.
    """
    outlook = _outlook(text, senses)
    scene_key = key_of(seed, *key)
    made: list[str] = []
    for child in range(count):
        draws = _Draws(further(scene_key, child))
        imagined = _child(outlook, draws, child / count)
        for _ in range(8):
            if imagined not in made:
                break
            imagined = _child(outlook, draws, draws.next())
        made.append(imagined)
    return tuple(made)


def _child(outlook: _Outlook, draws: _Draws, offset: float) -> str:
    """Compose one imagined scene: what is seen moved up, then one new thing, then whatever has room in the words."""
    first, second = _news_of(outlook, draws, offset)
    new = _sentence(first, MIDDLE if draws.next() < 0.5 else FAR)
    another = draws.next() < _SECOND_NEW_THING
    left, ahead, right = outlook.grounds
    if draws.next() > _GROUND_GOES_ON and (left or right):
        ahead = left or right
    ground = _ground_sentence(ahead, None, None)
    said = ""
    sentences = list(outlook.opening)
    room = outlook.room - _words_of(new) - _words_of(ground)
    for thing in outlook.things:
        moved = _moved(thing, draws.next())
        if moved is None or thing.name in said:
            continue
        sentence = _sentence(thing, moved)
        room -= _words_of(sentence)
        if room < 0:
            break
        sentences.append(sentence)
        said = f"{said}{thing.relation}|"
    sentences.append(new)
    if another and room >= 9:
        sentences.append(_sentence(second, FAR))
        room -= 9
    wide = _ground_sentence(ahead, left, right)
    if wide:
        sentences.append(wide if room >= 8 else ground)
    for thing in outlook.background:
        if room >= 8:
            room -= 8
            sentences.append(_sentence(thing, FAR if draws.next() < _COMES_OUT_OF_BACKGROUND else BACKGROUND))
    return " ".join([sentence for sentence in sentences if sentence])


def _news_of(outlook: _Outlook, draws: _Draws, offset: float) -> tuple[_Thing, _Thing]:
    """Draw two new things; children are spread over what is likely (stratified), so that they differ."""
    total = outlook.chances[-1]
    drawn = []
    for share in (((draws.next() + offset) % 1.0), draws.next()):
        place = bisect_right(outlook.chances, share * total)
        name = outlook.names[min(place, len(outlook.names) - 1)]
        drawn.append(_new_thing(name, _SIDES[int(draws.next() * 3.0)]))
    return drawn[0], drawn[1]
