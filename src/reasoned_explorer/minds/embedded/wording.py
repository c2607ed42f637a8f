"""The words of captions that are no things: how far, on which side, how related, denied, in the way.

Distances follow the contract with captions: foreground and the like mean up to about 10 m, "a little further on" up to
about 25 m, "in the distance" and "background" what lies beyond.
"""

from enum import IntEnum
from functools import cache
from itertools import product
from typing import Any

from reasoned_explorer.minds.embedded.lexicon import PhraseTable, word_table

NEAR, MIDDLE, FAR, BACKGROUND = 0, 1, 2, 3
LEFT, AHEAD, RIGHT = -1, 0, 1


class Part(IntEnum):
    """What a phrase of a caption does."""

    THING = 0
    DISTANCE = 1
    SIDE = 2
    PLACE = 3
    NEGATION = 4
    DENIAL = 5
    RELATION = 6
    COUNT = 7
    VERB = 8
    AND = 9
    BREAK = 10
    PRONOUN = 11
    BLOCKED = 12
    OTHER = 13


Meaning = tuple[Part, Any]

_DISTANCES = {
    NEAR: "in the foreground|in the near foreground|foreground|close to the viewer|close to the camera|close to you|"
    "near the viewer|near the camera|near you|close by|close|closest|nearby|nearest|right here|here|at hand|within "
    "reach|"
    "a few steps away|a few metres away|a few meters away|at your feet|beside you|next to you|right beside you|"
    "right next to you|next to the viewer|beside the viewer|underfoot|immediately|at close range|up close",
    MIDDLE: "a little further on|a little farther on|a little further|a little farther|further on|farther on|"
    "a little further away|further away|farther away|further along|farther along|a bit further|a bit farther|"
    "a bit further on|some way ahead|some way off|midway|halfway|in the middle distance|in the midground|midground|"
    "in the middle ground|middle ground|a short way ahead|a short way off|not far away|not far off|"
    "a short distance away|a little way off|a little way ahead|beyond|beyond that|beyond it|further|farther|"
    "further ahead|further down|further back|at some distance|some distance away",
    FAR: "in the distance|in the far distance|far away|far off|far ahead|distant|on the horizon|at the far end|"
    "at the end of the street|at the end of the road|at the end of the path|down the street|down the road|far back|"
    "a long way off|a long way ahead|off in the distance|much further away",
    BACKGROUND: "in the background|background|in the back|at the back|in the far background",
}
_PLACES = {
    (NEAR, AHEAD): "right in front of you|in front of you|in front of the viewer|in front of the camera|just ahead|"
    "right ahead|immediately ahead|close ahead|directly in front|right in front of the viewer|just in front|"
    "directly in front of you|directly in front of the viewer",
    (MIDDLE, AHEAD): "a little ahead|a bit ahead|further straight ahead|a little further ahead",
}
_WHOLE = ("image", "picture", "view", "scene", "photo", "frame", "viewer", "camera")
_NEAR_RELATIONS = (
    "next to|right next to|beside|right beside|near|near to|by|right by|alongside|along|close to|adjacent to|around|"
    "against|opposite|across from|at|to the left of|to the right of|left of|right of|at the foot of|at the edge of|"
    "outside|outside of|past|lined with|lined by|flanked by|not far from|just outside|on the side of|at the side of|"
    "to the side of|accompanied by|in the vicinity of"
)
_RELATIONS = {
    "near": _NEAR_RELATIONS,
    "under": "under|underneath|beneath|below|in the shade of|in the shadow of|shaded by|covered by|sheltered by",
    "in_front": "in front of|right in front of|directly in front of",
    "behind": "behind|right behind|at the back of|in back of",
    "on": "on|on top of|atop|upon|onto",
    "in": "in|inside|inside of|within|in the middle of|in the center of|in the centre of|surrounded by|amid|among|"
    "amidst|in the corner of",
    "with": "with|along with|together with|featuring|containing",
    "between": "between|in between",
}
_COUNTS = {
    1: "a|an|the|one|another|its|this|that|each|a single|single|any|a pair of",
    2: "two|both|a couple of|some|several|a few|these|those|a number of|various",
    3: "three|four|five|six|seven|eight|nine|ten|many|a row of|rows of|a group of|a line of|lots of|a lot of|"
    "numerous|multiple|dozens of|a series of|a cluster of",
}
_VERBS = (
    "is|are|was|were|be|been|being|can|could|may|might|must|will|would|stands|stand|standing|sits|sit|sitting|lies|lie|"
    "lying|leads|lead|leading|runs|run|running|stretches|stretch|stretching|extends|extend|extending|continues|"
    "continue|"
    "continuing|goes|go|going|appears|appear|seen|see|visible|shows|show|showing|shown|has|have|having|features|"
    "feature|"
    "includes|include|contains|contain|parked|located|placed|situated|grows|grow|growing|hangs|hang|rises|rise|rising|"
    "towers|crosses|crossing the|crossing a|walking|walks|walk|riding|rides|playing|plays|waiting|looking|looks|covers|"
    "cover|covered|passes|passing|turns|turn|opens|open|ends|end|comes|come|surrounds|follows|curves|winds|winding|"
    "borders|bordering|lines|flanks|makes|gives|offers|leans|leaning|resting|rests|enjoying|carrying|wearing|talking|"
    "mounted|attached|built|set|chained|locked|continues|remains|remain|waits|begins|starts|widens|narrows|faces"
)
_NEGATIONS = (
    "no|not|without|neither|nor|none of|never|lacks|lacking|lack|devoid of|free of|absence of|instead of|rather than|"
    "hardly any|not any|not a single|nothing|there is no|there are no|isn't|aren't|except"
)
_DENIALS = (
    "cannot be seen|can not be seen|can't be seen|could not be seen|is not visible|are not visible|not visible|"
    "not in sight|is missing|are missing|missing|is absent|are absent|absent|nowhere|nowhere to be seen|"
    "nowhere in sight|not there|is not there|are not there|not present|is not present|are not present|is gone|are gone|"
    "has been removed|have been removed|out of sight|not to be seen|is not here|are not here"
)
_BREAKS = ";|while|whereas|but|however|though|although|only|just|instead|where|there|then"
_OTHER = (
    "image of|picture of|photo of|view of|scene of|field of view|an image of|a picture of|a photo of|a view of|"
    "the view|most of|all of|part of|parts of|rest of|lot|kind of|no one|nobody|day|area|color|colour|both sides|"
    "on both sides|on either side|either side|left and right|to the left and right|on all sides|not only|as well as|"
    "as well|also|very|other|others|shape of|in shape|in color|of|to|for|from|as|so|too|you|your|viewer|camera|"
    "image|picture|photo|photograph|scene|view|frame|ground|way|side|sides|distance|middle|center|centre|top|front|"
    "in total|in color|in daylight|at night|in the sun|in the sunlight|on it|at the same time|in use|on foot|what|"
    "over|up|down|into|through|off|out|toward|towards|across|behind it all"
)
_BLOCKED = (
    "fills most of the view|fills the view|fills the whole view|fills the entire view|fills the picture|fills the "
    "frame|"
    "fill most of the view|fill the view|dead end|no way through|no way ahead|no way forward|no way on|no passage|"
    "impassable|"
    "blocked|is blocked|are blocked|cannot go further|no way past|cannot be passed|takes up most of the view|"
    "takes up the whole view|covers most of the view|bars the way|ends at a wall|closed off"
)
_NOT_BLOCKED = "not blocked|is not blocked|unblocked|not a dead end|nothing blocks|way is free|way is clear|way is open"
_NO_SIGNS = "no parking sign|no entry sign|no parking|no entry|no smoking sign|no swimming sign|no dogs sign"


def _split(text: str) -> list[str]:
    return text.split("|")


def _side_phrases() -> list[tuple[str, Meaning]]:
    found: list[tuple[str, Meaning]] = []
    for word, side in (("left", LEFT), ("right", RIGHT)):
        bare = [word, f"far {word}", f"{word} side", f"{word}-hand side", f"{word} hand side"]
        leads = ("on the", "to the", "at the", "on your", "to your", "towards the", "off to the")
        forms = [*bare, *(f"{lead} {form}" for lead, form in product(leads, bare))]
        found += [(form, (Part.SIDE, side)) for form in forms]
        found += [
            (f"{form} of {article} {whole}", (Part.SIDE, side))
            for form, article, whole in product(forms, ("the", "this"), _WHOLE)
        ]
        found += [(f"{form} of you", (Part.SIDE, side)) for form in forms]
    middles = ["in the middle", "in the center", "in the centre", "at the center", "at the centre"]
    ahead = ["straight ahead", "ahead", "directly ahead", "in front", "straight on", "forward", "ahead of you",
             "straight in front"]  # fmt: skip
    found += [(form, (Part.SIDE, AHEAD)) for form in (*middles, *ahead)]
    found += [(f"{form} of the {whole}", (Part.SIDE, AHEAD)) for form, whole in product(middles, _WHOLE)]
    return found


@cache
def caption_phrases() -> PhraseTable[Meaning]:
    """Return the table of all that a caption's words can mean, things included."""
    found: list[tuple[str, Meaning]] = [
        (phrase, (Part.PLACE, place)) for place, t in _PLACES.items() for phrase in _split(t)
    ]
    found += _side_phrases()
    found += [(phrase, (Part.DISTANCE, code)) for code, text in _DISTANCES.items() for phrase in _split(text)]
    found += [(phrase, (Part.OTHER, None)) for phrase in _split(_NOT_BLOCKED)]
    found += [(phrase, (Part.BLOCKED, None)) for phrase in _split(_BLOCKED)]
    verbs = ("blocks", "block", "blocking", "obstructs", "obstruct", "obstructing")
    found += [
        (f"{verb} {article} {way}", (Part.BLOCKED, None))
        for verb, article, way in product(
            verbs, ("the", "your", "any"), ("way", "path ahead", "passage", "view", "route")
        )
    ]
    found += [(phrase, (Part.DENIAL, None)) for phrase in _split(_DENIALS)]
    found += [(phrase, (Part.THING, "traffic_sign")) for phrase in _split(_NO_SIGNS)]
    found += [(phrase, (Part.NEGATION, None)) for phrase in _split(_NEGATIONS)]
    found += [(phrase, (Part.RELATION, name)) for name, text in _RELATIONS.items() for phrase in _split(text)]
    found += [(phrase, (Part.COUNT, count)) for count, text in _COUNTS.items() for phrase in _split(text)]
    found += [(phrase, (Part.VERB, None)) for phrase in _split(_VERBS)]
    found += [(phrase, (Part.AND, None)) for phrase in ("and", ",", "or", "plus")]
    found += [(phrase, (Part.BREAK, None)) for phrase in _split(_BREAKS)]
    found += [(phrase, (Part.PRONOUN, None)) for phrase in ("it", "them", "which")]
    found += [(phrase, (Part.OTHER, None)) for phrase in _split(_OTHER)]
    found += [(word, (Part.THING, concept)) for word, concept in word_table().items()]
    return PhraseTable(found)
