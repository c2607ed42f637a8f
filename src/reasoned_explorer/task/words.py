"""The judge's words: what people call classes, grounds and relations.

Written for the judge alone, from everyday English; the minds have their own. What a word means for *judging* is fixed
here, e.g. that "road" as ground to stay on takes in cycle lanes and car parks.
"""

from dataclasses import dataclass
from functools import cache

from reasoned_explorer.task.goal_spec import AWAY_M, NEAR_M, AttributeTest, Condition, Relation
from reasoned_explorer.world.taxonomy import OBJECT_CLASSES, Ground


@dataclass(frozen=True, slots=True)
class Noun:
    """What a noun can mean; its place in the sentence decides which.

    Attributes:
        classes: Object classes that it can be.
        grounds: Grounds that it can be.
        wanted: Grounds that "stay on …" takes in; wider than ``grounds`` where people mean it so.
        buildings: Whether it can be a building.
        attributes: What the noun itself says, e.g. the sport of a tennis court.
    """

    classes: tuple[str, ...] = ()
    grounds: tuple[Ground, ...] = ()
    wanted: tuple[Ground, ...] = ()
    buildings: bool = False
    attributes: tuple[AttributeTest, ...] = ()


# What people call a class, beside its own noun and plural.
_CLASS_WORDS: dict[str, str] = {
    "bench": "park bench, wooden bench, street bench",
    "picnic_table": "picnic bench, picnic spot",
    "outdoor_seating": "outdoor table, cafe table, terrace table, table with an umbrella, table with umbrella, "
    "outdoor seat, patio table, table outside",
    "waste_basket": "trash bin, garbage can, garbage bin, rubbish bin, litter bin, waste bin, waste basket, dustbin, "
    "trashcan, trash basket, refuse bin, bin",
    "recycling": "recycling container, recycling point, recycling station, recycling can, bottle bank",
    "fire_hydrant": "hydrant, fireplug, fire plug",
    "street_lamp": "streetlamp, street light, streetlight, lamp post, lamppost, lamp, street lantern",
    "bollard": "traffic bollard, traffic post",
    "bicycle_parking": "bike rack, bike stand, bicycle stand, bike parking, bicycle parking, cycle rack, cycle stand",
    "bicycle_rental": "bicycle rental station, bike share station, bike sharing station, bike share, bike rental, "
    "bicycle rental, bike hire, bikeshare station, bike dock",
    "fountain": "water fountain, ornamental fountain",
    "drinking_water": "drinking water fountain, water tap, drinking water tap, water dispenser, water refill station, "
    "bubbler, drinking tap",
    "artwork": "artwork, work of art, art installation, installation, mural, public artwork",
    "monument": "memorial, war memorial, obelisk, historic monument",
    "information": "information sign, info board, info sign, information panel, notice board, noticeboard, map board, "
    "tourist map, information stand",
    "advertising": "advertising pillar, billboard, poster column, advertisement column, advertising board, "
    "morris column",
    "bus_stop": "bus stand, tram stop, stop for the bus",
    "shelter": "bus shelter, rain shelter, weather shelter, pavilion, gazebo, picnic shelter",
    "post_box": "post box, postbox, letter box, letterbox, mail box, pillar box",
    "telephone": "phone booth, telephone box, phone box, payphone, pay phone, public telephone, public phone, "
    "telephone, call box",
    "vending_machine": "snack machine, ticket machine, vending automat",
    "parking_meter": "parking ticket machine, parking machine",
    "charging_station": "charger, ev charger, charging point, car charger, electric car charger, charging post",
    "traffic_signals": "traffic signal, stoplight, stop light",
    "traffic_sign": "traffic sign, street sign, stop sign, yield sign",
    "flagpole": "flag pole, flagstaff, flag",
    "clock": "clock, public clock, town clock, outdoor clock",
    "planter": "planter, flower pot, flowerpot, flower box, plant pot, tub of flowers",
    "swing": "swing set, swingset",
    "slide": "playground slide",
    "kiosk": "news stand, newsstand, newspaper stand, newspaper kiosk, food stand, snack stand",
    "tree": "shade tree, oak, oak tree",
    "shrub": "shrub, hedge",
    "car": "car, automobile, vehicle, parked vehicle, truck, van",
    "bicycle": "bike, parked bicycle, parked bike, pushbike, cycle",
    "person": "pedestrian, somebody, someone, man, woman, passer-by, passerby",
    "cafe": "café, coffee shop, coffee house, coffeehouse, tea room, ice cream parlour, ice cream parlor",
    "restaurant": "eatery, diner, fast food restaurant, beer garden, biergarten, pizzeria, food court",
    "bar": "pub, tavern, cocktail bar, wine bar",
    "shop": "store, supermarket, grocery store, grocery, boutique, bakery, bookshop, bookstore, convenience store",
    "toilets": "toilet, restroom, bathroom, public restroom, public bathroom, lavatory, washroom, wc, loo, "
    "public convenience",
    "pharmacy": "drugstore, chemist, drug store",
    "atm": "atm, bank, bank machine, cashpoint, cash point, cash dispenser",
    "hotel": "hostel, guest house, guesthouse, inn",
    "museum": "gallery, art gallery, exhibition",
    "library": "public library",
    "church": "place of worship, chapel, cathedral, mosque, synagogue, temple",
    "lawn": "patch of grass, stretch of grass, grassy area, grassy patch, patch of lawn, piece of lawn, green space, "
    "meadow, patch of green",
}

# Words that stand for several classes.
_MIXED_WORDS: tuple[tuple[str, tuple[str, ...]], ...] = (
    ("statue", ("artwork", "monument")),
    ("table", ("outdoor_seating", "picnic_table")),
    ("seat", ("bench", "outdoor_seating", "picnic_table")),
    ("playground equipment", ("slide", "swing")),
    ("place that serves food", ("cafe", "restaurant")),
)

_G = Ground
_SOFT = (_G.GRASS, _G.WOOD, _G.GARDEN)
_PAVED = (_G.ROAD, _G.PAVEMENT, _G.PLAZA, _G.CYCLEWAY, _G.STEPS, _G.PARKING)
# Ground nouns: the words, the ground that is meant when it is shunned or when something stands on it, and the ground
# that "stay on …" takes in. Who is told to stay on the road may use its cycle lanes and its parking places; who is told
# to stay on the pavement may use squares, stairs and footpaths (maps draw many a pavement as a footway); who is told to
# follow the paths may use all that is made for walking, and cycleways. A marked crossing is walking ground on the map;
# on the road it is narrow enough to be tolerated.
_GROUND_WORDS: tuple[tuple[str, tuple[Ground, ...], tuple[Ground, ...]], ...] = (
    (
        "road, street, roadway, carriageway, lane, driveway, traffic lane",
        (_G.ROAD,),
        (_G.ROAD, _G.CYCLEWAY, _G.PARKING),
    ),
    ("pavement, sidewalk, footway, walkway, side walk", (_G.PAVEMENT,), (_G.PAVEMENT, _G.PATH, _G.PLAZA, _G.STEPS)),
    ("plaza, square, piazza, pedestrian zone, pedestrian area, town square", (_G.PLAZA,), (_G.PLAZA,)),
    (
        "cycleway, bike lane, bike path, cycle lane, cycle path, cycle track, bicycle lane, bicycle path",
        (_G.CYCLEWAY,),
        (_G.CYCLEWAY,),
    ),
    (
        "path, footpath, foot path, trail, walking path, gravel path, park path, track",
        (_G.PATH,),
        (_G.PATH, _G.PAVEMENT, _G.PLAZA, _G.STEPS, _G.CYCLEWAY),
    ),
    ("step, stair, staircase, stairway, flight of stairs, flight of steps", (_G.STEPS,), (_G.STEPS,)),
    ("grass, turf, grassland", (_G.GRASS,), (_G.GRASS,)),
    ("wood, woods, woodland, forest, grove", (_G.WOOD,), (_G.WOOD,)),
    ("flower bed, flowerbed, flower border, flower", (_G.GARDEN,), (_G.GARDEN,)),
    ("sand, beach", (_G.SAND,), (_G.SAND,)),
    (
        "water, pond, lake, river, stream, canal, waterfront, waterside, shore, harbour, harbor, sea",
        (_G.WATER,),
        (_G.WATER,),
    ),
    ("car park, parking lot, parking area, parking space, parking place", (_G.PARKING,), (_G.PARKING,)),
    ("railway, railway track, railway line, rail, train track, tram track, railroad", (_G.RAILWAY,), (_G.RAILWAY,)),
    ("building site, construction site, construction area", (_G.CONSTRUCTION,), (_G.CONSTRUCTION,)),
    ("yard, courtyard, back yard, backyard", (_G.YARD,), (_G.YARD,)),
    ("paved ground, paved surface, paved way, hard ground, hard surface, paved area", _PAVED, _PAVED),
    ("greenery, green area, vegetation, plants", _SOFT, _SOFT),
    (
        "walking area, footpaths and squares",
        (_G.PAVEMENT, _G.PATH, _G.PLAZA, _G.STEPS),
        (_G.PAVEMENT, _G.PATH, _G.PLAZA, _G.STEPS),
    ),
)

# Nouns that are an object or a ground, by their place in the sentence.
_BOTH: tuple[tuple[str, Noun], ...] = (
    ("lawn", Noun(("lawn",), (_G.GRASS,), (_G.GRASS,))),
    ("garden", Noun(("lawn",), (_G.GARDEN,), (_G.GARDEN,))),
    ("park", Noun(("lawn",), _SOFT, (*_SOFT, _G.PATH))),
    (
        "playground, kids playground, children's playground, play area, play park",
        Noun(("playground",), (_G.PLAYGROUND,), (_G.PLAYGROUND,)),
    ),
    (
        "pitch, sports pitch, sports field, sports ground, playing field, sports court, athletic field",
        Noun(("pitch",), (_G.PITCH,), (_G.PITCH,)),
    ),
    ("building", Noun(buildings=True)),
    ("house", Noun(buildings=True)),
    ("wall", Noun(buildings=True)),
    ("roof", Noun(("shelter",), buildings=True)),
    ("canopy", Noun(("shelter",), buildings=True)),
    # A wood stands for its trees where a map does not draw each.
    ("tree", Noun(("tree",), (_G.WOOD,))),
)

_SPORTS = (
    ("football pitch, soccer pitch, football field, soccer field", ("soccer", "football")),
    ("basketball court", ("basketball",)),
    ("tennis court", ("tennis",)),
    ("volleyball court", ("volleyball", "beachvolleyball")),
)

_IRREGULAR = {"person": ("people",), "man": ("men",), "woman": ("women",), "grass": (), "water": (), "sand": ()}

# Relations: words, relation, negated, metres.
_RELATION_WORDS: tuple[tuple[str, Relation, bool, float], ...] = (
    (
        (
            "near, near to, close to, by, beside, next to, alongside, adjacent to, right by, right next to, "
            "in front of, "
            "at, outside, outside of, around, along, close by, not far from, with, that has, that is near, "
            "in the vicinity of, "
            "at the edge of, on the edge of, on the bank of, on the shore of, at the foot of"
        ),
        Relation.NEAR,
        False,
        NEAR_M,
    ),
    ("not near, not next to, not close to, not beside, without, with no, not by, not at", Relation.NEAR, True, NEAR_M),
    (
        "away from, far from, far away from, well away from, not within sight of, at a distance from",
        Relation.NEAR,
        True,
        AWAY_M,
    ),
    (
        "under, beneath, underneath, below, in the shade of, in the shadow of, shaded by, covered by, sheltered by",
        Relation.UNDER,
        False,
        NEAR_M,
    ),
    ("not under, not beneath, not covered by, not in the shade of", Relation.UNDER, True, NEAR_M),
    ("on, in, inside, within, upon, standing on, standing in, in the middle of", Relation.ON, False, NEAR_M),
    ("not on, not in, off, outside the", Relation.ON, True, NEAR_M),
)

_ROADSIDE = Condition(Relation.NEAR, grounds=(_G.ROAD,), distance_m=AWAY_M, negated=True)
_SHADE = Condition(Relation.UNDER, classes=("shelter", "tree"), grounds=(_G.WOOD,), buildings=True)
_COVER = Condition(Relation.UNDER, classes=("shelter",), buildings=True)
_OPEN = Condition(Relation.UNDER, classes=("shelter", "tree"), grounds=(_G.WOOD,), buildings=True, negated=True)
_ALONE = Condition(Relation.NEAR, classes=("person",), distance_m=AWAY_M, negated=True)

# Words that are a whole condition.
_QUALITIES: tuple[tuple[str, Condition], ...] = (
    ("quiet, calm, peaceful, quietly, in peace, away from traffic, away from the traffic", _ROADSIDE),
    ("shady, shaded, in the shade, in shade, in the shadow", _SHADE),
    ("covered, sheltered, roofed, out of the rain", _COVER),
    ("sunny, in the sun, in the sunshine, unshaded", _OPEN),
    ("secluded, lonely, private, away from people, away from other people", _ALONE),
)

_ATTRIBUTES: tuple[tuple[str, AttributeTest], ...] = (
    (
        "with a backrest, with backrest, with a back, with a back rest, with backrests",
        AttributeTest("backrest", ("yes",)),
    ),
    ("without a backrest, without backrest, with no backrest, backless", AttributeTest("backrest", ("no",))),
)


def split_words(text: str) -> tuple[str, ...]:
    """Return the words of a phrase of this module's tables."""
    return tuple(text.split())


def _phrases(listed: str) -> list[tuple[str, ...]]:
    return [split_words(item) for item in listed.split(",")]


def _words(listed: str) -> frozenset[str]:
    return frozenset(listed.split())


def _plurals(words: tuple[str, ...]) -> list[tuple[str, ...]]:
    last = words[-1]
    # "work of art", "table with an umbrella": the noun that takes the plural is the first one.
    if len(words) > 2 and words[1] in {"of", "with", "for", "that"}:
        return [(*_plurals(words[:1])[0], *words[1:])]
    if last in _IRREGULAR:
        return [(*words[:-1], form) for form in _IRREGULAR[last]]
    if last.endswith(("s", "x", "ch", "sh")):
        return [(*words[:-1], f"{last}es")]
    if last.endswith("y") and last[-2:-1] not in "aeiou":
        return [(*words[:-1], f"{last[:-1]}ies")]
    return [(*words[:-1], f"{last}s")]


@cache
def nouns() -> dict[tuple[str, ...], Noun]:
    """Return every noun that the judge knows, as words, with its plurals."""
    table: dict[tuple[str, ...], Noun] = {}

    def add(phrases: list[tuple[str, ...]], noun: Noun) -> None:
        for words in phrases:
            for form in (words, *_plurals(words)):
                table[form] = noun

    for listed, grounds, wanted in _GROUND_WORDS:
        add(_phrases(listed), Noun(grounds=grounds, wanted=wanted))
    for name, item in OBJECT_CLASSES.items():
        noun = Noun((name,))
        own = [split_words(item.noun), split_words(item.plural), (name,), tuple(name.split("_"))]
        for words in own:
            table[words] = noun
        add(_phrases(_CLASS_WORDS.get(name, item.noun)), noun)
    for listed, names in _MIXED_WORDS:
        add(_phrases(listed), Noun(names))
    for listed, sports in _SPORTS:
        add(_phrases(listed), Noun(("pitch",), (_G.PITCH,), (_G.PITCH,), attributes=(AttributeTest("sport", sports),)))
    for listed, noun in _BOTH:
        add(_phrases(listed), noun)
    return table


@cache
def relations() -> dict[tuple[str, ...], tuple[Relation, bool, float]]:
    """Return relation phrases: relation, whether negated, metres."""
    return {words: (rel, neg, dist) for listed, rel, neg, dist in _RELATION_WORDS for words in _phrases(listed)}


@cache
def qualities() -> dict[tuple[str, ...], Condition]:
    """Return words that are a whole condition, e.g. "quiet"."""
    return {words: condition for listed, condition in _QUALITIES for words in _phrases(listed)}


@cache
def attributes() -> dict[tuple[str, ...], AttributeTest]:
    """Return phrases that ask for an attribute, e.g. "with a backrest"."""
    return {words: test for listed, test in _ATTRIBUTES for words in _phrases(listed)}


def _joined(*slots: str) -> list[tuple[str, ...]]:
    """Return all phrases that take one word group of each slot; "-" stands for none."""
    phrases: list[tuple[str, ...]] = [()]
    for slot in slots:
        groups = [() if group.strip() == "-" else split_words(group) for group in slot.split(",")]
        phrases = [(*head, *tail) for head in phrases for tail in groups]
    return phrases


_MOTIONS = (
    "walk, walking, go, going, step, stepping, drive, driving, fly, flying, travel, travelling, traveling, "
    "move, moving, "
    "tread, treading, run, running, pass, passing, get, getting, stay, staying"
)
_NEGATIONS = "do not, don't, never, not, without, must not, may not, should not"
_KEEPING = "stay, staying, keep, keeping, remain, remaining, stick, sticking"
_ADVERBS = "-, only, strictly, always, just, entirely"
_ACROSS = (
    "-, walking on, stepping on, going on, walking over, crossing, going over, entering, going through, going across, "
    "walking across, going into, walking through, using, taking, touching, all"
)

# Phrases that open a path clause, slot by slot: wanted rather than shunned, whether they are one whatever follows.
_PATH_PHRASES: tuple[tuple[bool, bool, tuple[str, ...]], ...] = (
    (True, True, (_KEEPING, _ADVERBS, "on, to, along, within, in, inside")),
    (
        True,
        True,
        (
            "walk, walking, drive, driving, fly, flying, travel, travelling, traveling, move, moving, run, running",
            _ADVERBS,
            "on, along, within, over",
        ),
    ),
    (
        True,
        True,
        (
            _NEGATIONS,
            (
                "leave, leaving, step off, stepping off, stray from, straying from, go off, going off, "
                "walk off, walking off, wander off, wandering off, depart from, departing from"
            ),
        ),
    ),
    (True, False, ("follow, following, use, using, take, taking", "-, only")),
    (True, False, ("go, going, only", "along, via, by way of, on")),
    (True, False, ("via, by way of",)),
    (False, True, ("avoid, avoiding, shun, shunning", _ACROSS)),
    (False, True, (_NEGATIONS, _MOTIONS, "on, onto, over, into, across, through, in, near, along")),
    (False, True, (_NEGATIONS, "cross, crossing, enter, entering, touch, touching")),
    (False, False, (_NEGATIONS, "use, using, take, taking")),
    (False, True, (_KEEPING, "off, off of, away from, well away from, clear of, out of")),
    (False, False, ("rather than, instead of, and not, but not, not, never, no", "-, on, over, across, through")),
)


@cache
def path_markers() -> dict[tuple[str, ...], tuple[bool, bool]]:
    """Return phrases that open a path clause: (wanted rather than shunned, whether it is one whatever follows).

    A phrase that is not one whatever follows ("take …") is one only if ground follows.
    """
    return {
        phrase: (is_wanted, whatever_follows)
        for is_wanted, whatever_follows, slots in _PATH_PHRASES
        for phrase in _joined(*slots)
    }


LEADS = tuple(
    _phrases(
        "find, find me, find us, help me find, look for, search for, seek, locate, take me to, bring me to, "
        "lead me to, "
        "guide me to, go to, go and find, navigate to, get to, get me to, walk to, drive to, fly to, head to, "
        "head for, "
        "show me, show me to, where is, where are, where can i find, where could i find, where's, i need, i want, "
        "i would like, i'd like, i am looking for, i'm looking for, we need, can you find, could you find, "
        "reach, to find, "
        "to reach, discover, get, spot me, point me to, i want to find, i need to find, until you find, "
        "until you reach, "
        "and find, give me, is there, are there, i have to find"
    )
)
DETERMINERS = _words(
    "a an the some any one my your this that these those all its nearest closest another our every each of"
)
PLACEHOLDERS = _words("somewhere something anywhere anything place spot location area where things thing corner")
#: Words that carry nothing to be graded.
SMALL_WORDS = (
    DETERMINERS
    | PLACEHOLDERS
    | _words(
        "me us i we it you he she they am is are be been to for please can could would should will let lets there here "
        "and or but then while as so which who whose when how with at by from into onto do does did has have had "
        "having "
        "need want wants like hello hi hey thanks thank robot now also too just only really very bit little nice good "
        "great way our their them on in near nearby up out about if possible possibly must may not no "
        "someone's one's "
        "again right directly straight i'm i'd i've we're it's that's what what's tells next close around "
        "vicinity along standing located situated placed parked kind sort type"
    )
)
#: Words after a relation that change it in ways that the judge does not know.
STRANGE_WORDS = _words(
    "behind across opposite between beyond past side left north south east west above over through view after before "
    "towards toward"
)
#: Denials: what is sought, found or wished for behind one of them is not what is asked for.
DENIALS = tuple(
    _phrases("don't, dont, do not, anything but, everything but, except, except for, excluding, other than")
)
#: Denials that are path phrases where ground follows.
DENYING_PATHS = frozenset({"not", "never", "no", "but not", "and not", "rather than", "instead of"})
#: After these a denial is of something else: "I don't know where the bench is".
QUESTION_WORDS = _words("where how what who which when")
#: Where one is: "near me" narrows nothing.
HERE_WORDS = _words("me us here there it him her them you")
#: Relations that may be said without what they relate to: "is there a bench around?"
ADVERBS = _words("around along outside")
#: Relations that may end a wish: "something to sit on".
STRANDED = _words("on in at by with under inside within upon")
#: Relations that may close another one: "a bench with a tree near".
CLOSING = frozenset({"near", "close by", "beside", "alongside"})
#: Words that ask for more, and are no relation of the judge's.
HANGING = STRANGE_WORDS - _words("left side north south east west view") | _words("of from for to into onto via")
#: Phrases that only close a relation that was said already ("with a tree next to it").
CLOSERS = tuple(
    _phrases(
        "next to it, near it, beside it, close to it, by it, around it, nearby, close by, in the vicinity, on it, "
        "next to them, near by, in it, right next to it, over it, above it, there"
    )
)


@cache
def relation_texts() -> frozenset[str]:
    """Return all relation phrases as text."""
    return frozenset(" ".join(phrase) for phrase in relations())
