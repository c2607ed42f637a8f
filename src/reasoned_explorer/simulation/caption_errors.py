"""What a simulated captioner gets wrong, and how often.

Where the rates come from. Published: of captions by large vision-language models up to 32.7 % name an object that is
not in the picture (CHAIR_S on MSCOCO, LLaVA; Li et al., "Evaluating object hallucination in large vision-language
models", EMNLP 2023, arXiv 2305.10355), and what they make up are frequent words and things that often go with what is
there (the same). Of statements about spatial relations the best models of 2022 judge about 70 % rightly where people
judge over 95 % (Liu, Emerson, Collier, "Visual spatial reasoning", TACL 2023, arXiv 2205.00363). The paper that this
package follows says of its captioner, without figures, that it overlooks goals that have been reached and makes up
positions (section V, "Current limitations of VLM"). Nobody has measured Kosmos-2 outdoors at street level: every rate
of `NOISY` is **assumed** within what these sources allow, and says so below.
"""

import math
from dataclasses import dataclass, fields, replace

from reasoned_explorer.model import Fault, SettingsError
from reasoned_explorer.model.draws import key_of
from reasoned_explorer.world.taxonomy import Ground

_UNIT = 1.0 / 65536.0


@dataclass(frozen=True, slots=True)
class CaptionErrors:
    """How well a captioner sees and how it errs. Probabilities are in [0, 1].

    Attributes:
        half_seen_px: Side of a square, pixels of the picture, of the visible size at which a thing of ordinary
            salience is noticed half as often as a huge one; 0 for a captioner that overlooks nothing. In [0, 1000].
        steepness: How quickly notice grows with that size: p = ceiling / (1 + (half_seen_px / size)^steepness). In
            [0.1, 20].
        ceiling: Probability that a thing is noticed that fills the picture.
        least_width_px: What is narrower than this and lower than ``least_height_px`` is never named. In [0, 1000].
        least_height_px: Likewise.
        same_object_share: Share of objects of which it depends on the object alone, the same at every look of a
            mission, how large they must be to be noticed; of the others it is drawn anew at each look.
        imagine_rate: Probability that a caption names one thing that is not in the view (CHAIR_S).
        companion_share: Of imagined things, the share that go with something in the view; the rest are frequent words.
        depth_error: Probability that a thing is put one step too near or too far (near, further on, in the distance).
        side_error: Probability that a thing is put on a wrong side (left, ahead, right).
        relation_error: Probability that the relation between two things, or a cover, is told wrongly.
        confuse_rate: Probability that a thing is taken for one that looks alike.
        ground_error: Probability that the ground ahead is taken for another kind.
        sign_rate: Probability that a sign near by is read.
        max_groups: Most groups of things that a caption names, the most prominent first; None for no limit, else in
            [1, 100].
    """

    half_seen_px: float = 0.0
    steepness: float = 2.5
    ceiling: float = 1.0
    least_width_px: float = 3.0
    least_height_px: float = 4.0
    same_object_share: float = 0.0
    imagine_rate: float = 0.0
    companion_share: float = 0.7
    depth_error: float = 0.0
    side_error: float = 0.0
    relation_error: float = 0.0
    confuse_rate: float = 0.0
    ground_error: float = 0.0
    sign_rate: float = 1.0
    max_groups: int | None = None

    def __post_init__(self) -> None:
        """Refuse what is out of range.

        Raises:
            SettingsError: With all faults.
        """
        ranges = {"half_seen_px": (0.0, 1000.0), "steepness": (0.1, 20.0), "max_groups": (1, 100)}
        ranges |= {"least_width_px": (0.0, 1000.0), "least_height_px": (0.0, 1000.0)}
        faults = []
        for field in fields(self):
            value, (low, high) = getattr(self, field.name), ranges.get(field.name, (0.0, 1.0))
            if value is None and field.name == "max_groups":
                continue
            if not isinstance(value, int | float) or not low <= value <= high:
                faults.append(Fault(f"{field.name} = {value!r}", f"a number in [{low:g}, {high:g}]"))
        if faults:
            raise SettingsError("caption errors", faults)

    def times(self, factor: float) -> "CaptionErrors":
        """Return errors so many times as frequent.

        Rates grow with the factor up to certainty, and so does the size at which things are noticed; of what a perfect
        captioner has (the ceiling, signs read) so much more is lost.

        Raises:
            SettingsError: If the factor is no finite number, 0 or more.
        """
        if not (math.isfinite(factor) and factor >= 0.0):
            raise SettingsError("caption errors", [Fault(f"factor {factor}", "a finite number, 0 or more")])
        rates = ("imagine_rate", "depth_error", "side_error", "relation_error", "confuse_rate", "ground_error")
        return replace(
            self,
            half_seen_px=self.half_seen_px * factor,
            ceiling=max(0.0, 1.0 - (1.0 - self.ceiling) * factor),
            sign_rate=max(0.0, 1.0 - (1.0 - self.sign_rate) * factor),
            **{name: min(1.0, getattr(self, name) * factor) for name in rates},
        )

    def notice_probability(self, size_px: float, class_name: str) -> float:
        """Return how likely a thing is noticed whose visible part covers ``size_px`` squared pixels."""
        if self.half_seen_px == 0.0:
            return self.ceiling
        felt_px = size_px * SALIENCE.get(class_name, 1.0)
        if felt_px <= 0.0:
            return 0.0
        return self.ceiling / (1.0 + math.pow(self.half_seen_px / felt_px, self.steepness))


#: Names everything that is four pixels high or three wide, where it is.
PERFECT = CaptionErrors()

#: Every rate assumed (see the module's docstring for what is published). The size at which half is noticed: COCO calls
#: objects below 32 px of a 640 px picture small, the size at which detectors lose about half of their precision; that
#: is 11 px of Kosmos-2's 224.
NOISY = CaptionErrors(
    half_seen_px=11.0,
    steepness=2.5,
    ceiling=0.92,
    same_object_share=0.5,
    imagine_rate=0.2,
    depth_error=0.12,
    side_error=0.06,
    relation_error=0.2,
    confuse_rate=0.05,
    ground_error=0.05,
    sign_rate=0.5,
    max_groups=8,
)

#: How much larger (or smaller) than it is a class feels to who describes a picture; 1 where not named. Assumed: people,
#: vehicles and centrepieces are told first, clutter last.
SALIENCE = {
    "person": 1.6,
    "fountain": 1.5,
    "monument": 1.4,
    "car": 1.3,
    "bicycle": 1.3,
    "bench": 1.2,
    "outdoor_seating": 1.2,
    "fire_hydrant": 1.2,
    "artwork": 1.2,
    "church": 1.2,
    "playground": 1.1,
    "tree": 0.9,
    "lawn": 0.6,
    "pitch": 0.8,
    "shrub": 0.7,
    "street_lamp": 0.7,
    "bollard": 0.6,
    "traffic_sign": 0.8,
    "parking_meter": 0.7,
    "atm": 0.7,
    "charging_station": 0.7,
}

#: What looks alike at a glance. Assumed.
LOOKALIKES = {
    "bench": ("picnic_table", "outdoor_seating"),
    "picnic_table": ("bench", "outdoor_seating"),
    "outdoor_seating": ("picnic_table", "kiosk"),
    "waste_basket": ("post_box", "recycling", "bollard"),
    "recycling": ("waste_basket", "vending_machine"),
    "fire_hydrant": ("bollard", "waste_basket"),
    "bollard": ("fire_hydrant", "parking_meter"),
    "post_box": ("waste_basket", "vending_machine", "telephone"),
    "telephone": ("vending_machine", "kiosk"),
    "vending_machine": ("telephone", "charging_station"),
    "parking_meter": ("post_box", "charging_station"),
    "charging_station": ("parking_meter", "vending_machine"),
    "street_lamp": ("traffic_signals", "flagpole"),
    "traffic_signals": ("street_lamp", "traffic_sign"),
    "flagpole": ("street_lamp",),
    "traffic_sign": ("bus_stop", "information"),
    "bus_stop": ("traffic_sign", "information"),
    "information": ("advertising", "traffic_sign"),
    "advertising": ("information", "monument"),
    "clock": ("street_lamp",),
    "artwork": ("monument", "person"),
    "monument": ("artwork", "fountain"),
    "fountain": ("monument", "drinking_water"),
    "drinking_water": ("fire_hydrant", "post_box"),
    "kiosk": ("shelter", "vending_machine"),
    "shelter": ("kiosk", "bus_stop"),
    "bicycle_parking": ("bicycle", "bicycle_rental"),
    "bicycle_rental": ("bicycle_parking",),
    "bicycle": ("bicycle_parking",),
    "tree": ("shrub",),
    "shrub": ("tree", "planter"),
    "planter": ("shrub", "waste_basket"),
    "swing": ("slide",),
    "slide": ("swing",),
    "cafe": ("restaurant", "shop"),
    "restaurant": ("cafe", "bar"),
    "bar": ("restaurant", "cafe"),
    "shop": ("cafe", "pharmacy"),
    "pharmacy": ("shop",),
    "hotel": ("museum",),
    "museum": ("church", "library"),
    "library": ("museum",),
    "church": ("museum",),
}

#: Ground that is taken for other ground. Assumed.
GROUND_LOOKALIKES = {
    Ground.ROAD: (Ground.PAVEMENT, Ground.PARKING),
    Ground.PAVEMENT: (Ground.ROAD, Ground.PLAZA),
    Ground.PLAZA: (Ground.PAVEMENT, Ground.PARKING),
    Ground.CYCLEWAY: (Ground.PATH, Ground.PAVEMENT),
    Ground.PATH: (Ground.CYCLEWAY, Ground.PAVEMENT),
    Ground.GRASS: (Ground.GARDEN, Ground.PITCH),
    Ground.GARDEN: (Ground.GRASS,),
    Ground.WOOD: (Ground.GARDEN,),
    Ground.SAND: (Ground.PATH,),
    Ground.PARKING: (Ground.ROAD, Ground.PLAZA),
    Ground.PITCH: (Ground.GRASS,),
    Ground.YARD: (Ground.PARKING, Ground.PLAZA),
}

#: Words that often go together in descriptions of streets and parks; what is imagined is taken from here. Assumed: it
#: is about words, not about real places, of which the captioner knows nothing.
COMPANIONS = {
    "bench": ("tree", "waste_basket", "street_lamp", "person"),
    "tree": ("bench", "shrub", "lawn"),
    "car": ("traffic_signals", "parking_meter", "fire_hydrant", "traffic_sign"),
    "person": ("bicycle", "bench", "car"),
    "bicycle": ("bicycle_parking", "person"),
    "bicycle_parking": ("bicycle", "person"),
    "cafe": ("outdoor_seating", "person", "planter"),
    "restaurant": ("outdoor_seating", "person", "planter"),
    "shop": ("person", "advertising", "bicycle"),
    "fountain": ("bench", "person", "artwork"),
    "monument": ("planter", "bench", "flagpole"),
    "playground": ("swing", "slide", "bench"),
    "swing": ("slide", "bench"),
    "slide": ("swing", "bench"),
    "traffic_signals": ("car", "traffic_sign", "person"),
    "traffic_sign": ("car", "traffic_signals"),
    "bus_stop": ("shelter", "person", "bench"),
    "shelter": ("bus_stop", "bench"),
    "street_lamp": ("bench", "car", "tree"),
    "lawn": ("tree", "bench", "person"),
    "picnic_table": ("bench", "tree", "waste_basket"),
    "waste_basket": ("bench", "bicycle"),
}

#: Frequent words of captions of outdoor pictures, the most frequent first. Assumed.
FREQUENT = (
    "person",
    "car",
    "tree",
    "bench",
    "street_lamp",
    "bicycle",
    "traffic_sign",
    "fire_hydrant",
    "traffic_signals",
)


def parts_of(key: int) -> tuple[float, float, float, float]:
    """Split a 64-bit key into four independent numbers in [0, 1), of 16 bits each."""
    return (
        (key & 0xFFFF) * _UNIT,
        ((key >> 16) & 0xFFFF) * _UNIT,
        ((key >> 32) & 0xFFFF) * _UNIT,
        ((key >> 48) & 0xFFFF) * _UNIT,
    )


def imagined_class(seen: frozenset[str], companion_share: float, key: int) -> str | None:
    """Return the class of a thing that is imagined beside those that are in the view, or None if no word is left.

    Args:
        seen: The classes in the view, noticed or not: what is named wrongly must not be there by luck.
        companion_share: The share of imagined things that go with something seen.
        key: Of the draw.
    """
    which, goes_with, _, _ = parts_of(key)
    hosts = sorted(name for name in seen if name in COMPANIONS)
    words: tuple[str, ...] = FREQUENT
    if hosts and goes_with < companion_share:
        words = COMPANIONS[hosts[key_of(key, "host") % len(hosts)]]
    for options in (words, FREQUENT):
        absent = [name for name in options if name not in seen]
        if absent:
            # Earlier words are likelier: the square of an even draw.
            return absent[int(which * which * len(absent))]
    return None
