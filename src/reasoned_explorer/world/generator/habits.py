"""Where each class of object likes to stand, and how common it is in each district.

How common classes are and what they stand near comes from real places (`reasoned_explorer.knowledge`). What a map does
not say is here, and is assumed: on which spots a thing may stand at all, how districts differ from a city centre, and
the densities of what maps seldom hold.
"""

from collections.abc import Mapping

from reasoned_explorer.world.generator.sites import Role
from reasoned_explorer.world.generator.sketch import Zone

_K, _F, _V, _O, _G = Role.KERB, Role.FRONT, Role.VERGE, Role.OPEN, Role.GREEN
_P, _L, _C, _D = Role.PLAY, Role.LOT, Role.CORNER, Role.DOOR

#: Relative liking of a class for sites of a role; roles that are not named are never taken. Assumed.
ROLE_LIKING: Mapping[str, Mapping[Role, float]] = {
    "bench": {_V: 3.0, _O: 1.0, _K: 0.25, _F: 0.5, _P: 0.05},
    "picnic_table": {_G: 2.0, _V: 1.0, _P: 1.0},
    "outdoor_seating": {_O: 1.0, _F: 0.5},
    "waste_basket": {_V: 1.5, _K: 0.8, _O: 0.8, _F: 0.3, _P: 1.0},
    "recycling": {_K: 0.6, _L: 2.0, _F: 0.3, _V: 0.3},
    "fire_hydrant": {_K: 1.0, _F: 0.3, _L: 0.5},
    "street_lamp": {_K: 1.0, _V: 0.7, _O: 0.4, _L: 1.0},
    "bollard": {_K: 0.5, _C: 1.5, _O: 0.5},
    "bicycle_parking": {_K: 0.8, _F: 0.8, _O: 0.8, _L: 0.5},
    "bicycle_rental": {_K: 1.0, _L: 1.0, _O: 0.4},
    "fountain": {_O: 1.0, _G: 0.05},
    "drinking_water": {_V: 0.8, _O: 1.0, _P: 1.0, _K: 0.1},
    "artwork": {_O: 1.0, _G: 0.5, _V: 0.5, _F: 0.2},
    "monument": {_O: 1.0, _G: 0.2, _V: 0.4, _F: 0.2},
    "information": {_V: 1.2, _O: 1.0, _K: 0.4, _F: 0.3, _C: 0.6},
    "advertising": {_K: 1.0, _C: 1.0, _O: 0.5},
    "bus_stop": {_K: 1.0},
    "shelter": {_K: 1.0, _V: 0.3},
    "post_box": {_K: 1.0, _F: 1.0, _C: 0.5},
    "telephone": {_K: 1.0, _F: 0.6, _O: 0.5},
    "vending_machine": {_F: 1.0, _K: 0.4, _O: 0.2},
    "parking_meter": {_K: 1.0, _L: 1.5},
    "charging_station": {_K: 0.6, _L: 3.0},
    "traffic_signals": {_C: 1.0},
    "traffic_sign": {_K: 0.3, _C: 1.0},
    "flagpole": {_O: 1.0, _F: 0.3, _G: 0.3},
    "clock": {_O: 1.0, _K: 0.5, _C: 0.7},
    "planter": {_F: 1.0, _O: 1.0, _K: 0.3},
    "kiosk": {_O: 1.0, _V: 0.25, _K: 0.1},
    "swing": {_P: 1.0},
    "slide": {_P: 1.0},
    "person": {_K: 0.6, _F: 1.0, _V: 1.2, _O: 1.6, _P: 3.0, _G: 0.3, _C: 1.0},
    "bicycle": {_F: 1.0, _K: 0.8, _O: 0.4, _V: 0.2},
    "cafe": {_D: 1.0},
    "restaurant": {_D: 1.0},
    "bar": {_D: 1.0},
    "shop": {_D: 1.0},
    "toilets": {_D: 1.0},
    "pharmacy": {_D: 1.0},
    "atm": {_D: 1.0},
    "hotel": {_D: 1.0},
    "museum": {_D: 1.0},
    "library": {_D: 1.0},
    "church": {_D: 0.2},
}

#: Things per square kilometre of what maps hold too seldom to be counted from them. Assumed.
ASSUMED_PER_KM2: Mapping[str, float] = {"person": 450.0, "bicycle": 220.0}
#: A class that data lack altogether, or nearly, still stands here and there, per square kilometre. Assumed.
LEAST_PER_KM2: Mapping[str, float] = {
    "fire_hydrant": 25.0, "street_lamp": 250.0, "traffic_sign": 60.0, "traffic_signals": 30.0,
    "planter": 40.0, "flagpole": 12.0, "picnic_table": 12.0, "outdoor_seating": 15.0, "shelter": 10.0,
    "telephone": 4.0, "charging_station": 8.0, "parking_meter": 18.0, "post_box": 12.0, "recycling": 8.0,
    "vending_machine": 10.0, "advertising": 8.0, "bicycle_rental": 6.0, "drinking_water": 3.0,
    "bus_stop": 16.0, "information": 20.0, "toilets": 3.0, "library": 1.5, "museum": 2.0,
}  # fmt: skip
#: More than this per square kilometre would leave no room to walk.
MOST_PER_KM2: Mapping[str, float] = {"street_lamp": 700.0, "bollard": 500.0, "shop": 600.0}

_TRADE = ("cafe", "restaurant", "bar", "shop", "atm", "hotel", "pharmacy", "advertising", "outdoor_seating")
_TRAFFIC = ("traffic_signals", "traffic_sign", "parking_meter", "bus_stop", "shelter", "charging_station", "bollard")
_REST = ("bench", "waste_basket", "picnic_table", "drinking_water", "artwork", "monument", "information", "fountain")


def _factors(common: float, trade: float, traffic: float, rest: float, **more: float) -> dict[str, float]:
    factors = dict.fromkeys(ROLE_LIKING, common)
    factors |= dict.fromkeys(_TRADE, trade) | dict.fromkeys(_TRAFFIC, traffic) | dict.fromkeys(_REST, rest)
    return factors | more


#: How common a class is in a district against the centres that the data are from. Assumed.
ZONE_FACTORS: Mapping[Zone, Mapping[str, float]] = {
    "downtown": _factors(1.0, 1.0, 1.2, 0.9, person=1.0, picnic_table=0.2),
    "plaza": _factors(
        1.0, 1.25, 0.8, 1.2, fountain=0.9, monument=0.9, person=2.2, outdoor_seating=2.0, planter=2.0, picnic_table=0.2
    ),
    "park": _factors(
        0.8,
        0.3,
        0.5,
        2.2,
        person=0.8,
        fountain=1.0,
        monument=1.0,
        picnic_table=5.0,
        street_lamp=0.8,
        kiosk=1.5,
        bicycle=0.5,
    ),
    "campus": _factors(
        0.8,
        0.2,
        0.5,
        1.3,
        fountain=0.6,
        monument=0.7,
        hotel=0.05,
        person=1.0,
        bicycle=2.0,
        bicycle_parking=1.2,
        picnic_table=2.0,
    ),
    "residential": _factors(
        0.5,
        0.14,
        0.5,
        0.4,
        fountain=0.1,
        monument=0.15,
        person=0.25,
        bicycle=0.4,
        street_lamp=0.8,
        recycling=1.0,
        church=0.4,
    ),
    "waterfront": _factors(0.8, 0.6, 0.7, 1.4, person=1.2, flagpole=2.0, outdoor_seating=1.5),
}

#: Landmarks keep at least this distance from the next of their kind, metres. Assumed.
SPACING_M: Mapping[str, float] = {
    "fountain": 25.0, "monument": 30.0, "kiosk": 30.0, "artwork": 12.0, "clock": 80.0, "telephone": 30.0,
    "post_box": 30.0, "bicycle_rental": 40.0, "recycling": 20.0, "advertising": 25.0, "street_lamp": 7.0,
    "fire_hydrant": 12.0, "bus_stop": 10.0, "drinking_water": 30.0,
}  # fmt: skip
#: Usual variation of size about the typical one, as a share. Assumed.
SIZE_SPREAD: Mapping[str, float] = {
    "bench": 0.1, "fountain": 0.25, "artwork": 0.3, "monument": 0.3, "planter": 0.2, "kiosk": 0.15, "car": 0.06,
    "person": 0.06, "shrub": 0.3, "bicycle_parking": 0.2, "outdoor_seating": 0.1,
}  # fmt: skip
