"""What can stand in a world and what the ground can be: names, sizes and how OpenStreetMap calls them.

Sizes are typical ones (street-furniture catalogues and everyday experience; assumed, not measured), used where a map
gives none. Names are OpenStreetMap's where it has one.
"""

from dataclasses import dataclass
from enum import IntEnum


class Ground(IntEnum):
    """What one stands on. The order is the order of the codes in rasters and files; append, never insert."""

    UNKNOWN = 0
    ROAD = 1
    PAVEMENT = 2
    PLAZA = 3
    CYCLEWAY = 4
    PATH = 5
    STEPS = 6
    GRASS = 7
    WOOD = 8
    GARDEN = 9
    SAND = 10
    WATER = 11
    PARKING = 12
    PITCH = 13
    PLAYGROUND = 14
    RAILWAY = 15
    CONSTRUCTION = 16
    YARD = 17
    BUILDING = 18

    @property
    def noun(self) -> str:
        """The word for people: ``"pavement"``, ``"building site"``."""
        return {Ground.CONSTRUCTION: "building site", Ground.PARKING: "car park", Ground.UNKNOWN: "unknown ground"}.get(
            self, self.name.lower()
        )


#: Ground that a walker cannot stand on.
IMPASSABLE_ON_FOOT = frozenset({Ground.WATER, Ground.BUILDING, Ground.RAILWAY, Ground.CONSTRUCTION})
#: Ground that a flyer low above it cannot be in.
IMPASSABLE_IN_FLIGHT = frozenset({Ground.BUILDING})


@dataclass(frozen=True, slots=True)
class ObjectClass:
    """One class of objects.

    Attributes:
        name: Identifier, OpenStreetMap's value where there is one.
        noun: Singular, for captions and people.
        plural: Plural.
        kind: ``furniture``, ``plant``, ``vehicle``, ``person``, ``place`` (inside a building, reached by its
            entrance) or ``area`` (a stretch of ground one can stand on).
        size_m: Typical length (across its front), width (depth) and height, metres.
        solid: Whether a vehicle close to the ground collides with it.
        tags: OpenStreetMap tags that mean this class, as ``key=value``; the first is the one that is written out.
    """

    name: str
    noun: str
    plural: str
    kind: str
    size_m: tuple[float, float, float]
    solid: bool
    tags: tuple[str, ...]


def _c(  # noqa: PLR0917 - a table's row
    name: str, noun: str, plural: str, kind: str, size_m: tuple[float, float, float], tags: str, *, solid: bool = True
) -> ObjectClass:
    return ObjectClass(name, noun, plural, kind, size_m, solid, tuple(tags.split()))


_CLASSES = (
    _c("bench", "bench", "benches", "furniture", (1.8, 0.6, 0.85), "amenity=bench"),
    _c("picnic_table", "picnic table", "picnic tables", "furniture", (1.8, 1.5, 0.75), "leisure=picnic_table"),
    _c("outdoor_seating", "umbrella table", "umbrella tables", "furniture", (2.2, 2.2, 2.4), "leisure=outdoor_seating"),
    _c("waste_basket", "trash can", "trash cans", "furniture", (0.5, 0.5, 1.0), "amenity=waste_basket"),
    _c("recycling", "recycling bin", "recycling bins", "furniture", (1.6, 1.2, 1.5), "amenity=recycling"),
    _c("fire_hydrant", "fire hydrant", "fire hydrants", "furniture", (0.35, 0.35, 0.8), "emergency=fire_hydrant"),
    _c("street_lamp", "street lamp", "street lamps", "furniture", (0.25, 0.25, 6.0), "highway=street_lamp"),
    _c("bollard", "bollard", "bollards", "furniture", (0.2, 0.2, 0.9), "barrier=bollard"),
    _c("bicycle_parking", "bicycle rack", "bicycle racks", "furniture", (3.0, 1.8, 0.9), "amenity=bicycle_parking"),
    _c(
        "bicycle_rental",
        "bike rental station",
        "bike rental stations",
        "furniture",
        (8.0, 2.0, 1.4),
        "amenity=bicycle_rental",
    ),
    _c("fountain", "fountain", "fountains", "furniture", (5.0, 5.0, 2.5), "amenity=fountain"),
    _c(
        "drinking_water",
        "drinking fountain",
        "drinking fountains",
        "furniture",
        (0.5, 0.5, 1.0),
        "amenity=drinking_water",
    ),
    _c("artwork", "sculpture", "sculptures", "furniture", (1.5, 1.5, 2.5), "tourism=artwork"),
    _c("monument", "monument", "monuments", "furniture", (3.0, 3.0, 6.0), "historic=monument historic=memorial"),
    _c("information", "information board", "information boards", "furniture", (1.2, 0.2, 2.0), "tourism=information"),
    _c(
        "advertising",
        "advertising column",
        "advertising columns",
        "furniture",
        (1.4, 1.4, 3.5),
        "advertising=column advertising=billboard",
    ),
    _c("bus_stop", "bus stop", "bus stops", "furniture", (0.4, 0.2, 2.8), "highway=bus_stop"),
    _c("shelter", "shelter", "shelters", "furniture", (4.0, 2.0, 2.6), "amenity=shelter"),
    _c("post_box", "mailbox", "mailboxes", "furniture", (0.5, 0.5, 1.2), "amenity=post_box"),
    _c("telephone", "telephone booth", "telephone booths", "furniture", (1.0, 1.0, 2.3), "amenity=telephone"),
    _c(
        "vending_machine",
        "vending machine",
        "vending machines",
        "furniture",
        (0.9, 0.8, 1.9),
        "amenity=vending_machine",
    ),
    _c(
        "parking_meter",
        "parking meter",
        "parking meters",
        "furniture",
        (0.4, 0.3, 1.6),
        "vending=parking_tickets amenity=parking_meter",
    ),
    _c(
        "charging_station",
        "charging station",
        "charging stations",
        "furniture",
        (0.5, 0.4, 1.7),
        "amenity=charging_station",
    ),
    _c("traffic_signals", "traffic light", "traffic lights", "furniture", (0.35, 0.35, 3.2), "highway=traffic_signals"),
    _c(
        "traffic_sign",
        "road sign",
        "road signs",
        "furniture",
        (0.6, 0.1, 2.5),
        "highway=stop highway=give_way traffic_sign=*",
    ),
    _c("flagpole", "flagpole", "flagpoles", "furniture", (0.2, 0.2, 8.0), "man_made=flagpole"),
    _c("clock", "street clock", "street clocks", "furniture", (0.5, 0.3, 3.5), "amenity=clock"),
    _c(
        "planter", "flower planter", "flower planters", "furniture", (1.0, 1.0, 0.9), "man_made=planter barrier=planter"
    ),
    _c("swing", "swing", "swings", "furniture", (3.0, 1.5, 2.3), "playground=swing"),
    _c("slide", "slide", "slides", "furniture", (3.5, 0.8, 2.2), "playground=slide"),
    _c("kiosk", "kiosk", "kiosks", "furniture", (3.0, 2.5, 2.8), "shop=kiosk"),
    _c("tree", "tree", "trees", "plant", (6.0, 6.0, 9.0), "natural=tree"),
    _c("shrub", "bush", "bushes", "plant", (1.5, 1.5, 1.3), "natural=shrub"),
    _c("car", "parked car", "parked cars", "vehicle", (4.4, 1.8, 1.5), "vehicle=car"),
    _c("bicycle", "bicycle", "bicycles", "vehicle", (1.8, 0.5, 1.1), "vehicle=bicycle"),
    _c("person", "person", "people", "person", (0.5, 0.35, 1.75), "person=yes"),
    _c("cafe", "cafe", "cafes", "place", (6.0, 0.5, 3.0), "amenity=cafe amenity=ice_cream", solid=False),
    _c(
        "restaurant",
        "restaurant",
        "restaurants",
        "place",
        (8.0, 0.5, 3.0),
        "amenity=restaurant amenity=fast_food amenity=food_court amenity=biergarten",
        solid=False,
    ),
    _c("bar", "bar", "bars", "place", (6.0, 0.5, 3.0), "amenity=bar amenity=pub", solid=False),
    _c("shop", "shop", "shops", "place", (6.0, 0.5, 3.0), "shop=*", solid=False),
    _c("toilets", "public toilet", "public toilets", "place", (3.0, 0.5, 2.6), "amenity=toilets", solid=False),
    _c("pharmacy", "pharmacy", "pharmacies", "place", (6.0, 0.5, 3.0), "amenity=pharmacy", solid=False),
    _c("atm", "cash machine", "cash machines", "place", (1.0, 0.3, 1.8), "amenity=atm amenity=bank", solid=False),
    _c(
        "hotel",
        "hotel",
        "hotels",
        "place",
        (8.0, 0.5, 4.0),
        "tourism=hotel tourism=hostel tourism=guest_house",
        solid=False,
    ),
    _c("museum", "museum", "museums", "place", (8.0, 0.5, 5.0), "tourism=museum tourism=gallery", solid=False),
    _c("library", "library", "libraries", "place", (8.0, 0.5, 4.0), "amenity=library", solid=False),
    _c("church", "church", "churches", "place", (6.0, 0.5, 8.0), "amenity=place_of_worship", solid=False),
    _c("playground", "playground", "playgrounds", "area", (15.0, 12.0, 0.1), "leisure=playground", solid=False),
    _c("pitch", "sports pitch", "sports pitches", "area", (30.0, 20.0, 0.1), "leisure=pitch", solid=False),
    _c("lawn", "lawn", "lawns", "area", (20.0, 20.0, 0.1), "leisure=garden landuse=grass leisure=park", solid=False),
)

#: All classes by name, in a fixed order; an object's class code is its place in it.
OBJECT_CLASSES: dict[str, ObjectClass] = {item.name: item for item in _CLASSES}
#: Class names in the order of their codes.
CLASS_NAMES: tuple[str, ...] = tuple(OBJECT_CLASSES)
