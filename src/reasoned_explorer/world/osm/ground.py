"""What OpenStreetMap's tags say about the ground: areas, and lines with a width.

The order in which areas are stacked follows what maps made from this data do (openstreetmap-carto): within a layer the
smaller area lies on the larger one, so that a lawn on a square is a lawn, whichever was drawn first.
"""

from dataclasses import dataclass

from reasoned_explorer.world.osm.tags import (
    Tags,
    is_below_ground,
    is_gone,
    is_passage,
    is_set,
    layer_of,
    parse_count,
    parse_length_m,
)
from reasoned_explorer.world.taxonomy import Ground

# Layers of areas, from below.
BASE_LAYER, SEA_LAYER, LAND_LAYER, WATER_LAYER, DECK_LAYER = range(5)

# What land is used for (residential, commercial, industrial …) does not say what one stands on: between the walls and
# the roads of a residential area there may be pavement as well as yards. Such ground stays unknown.
_BASE = {
    ("landuse", "garages"): Ground.YARD,
    ("landuse", "depot"): Ground.YARD,
    ("landuse", "farmyard"): Ground.YARD,
    ("amenity", "school"): Ground.YARD,
    ("amenity", "kindergarten"): Ground.YARD,
}
_LAND = {
    **dict.fromkeys(
        [("landuse", value) for value in ("grass", "meadow", "village_green", "recreation_ground", "greenfield",
                                          "cemetery", "farmland", "greenery")]
        + [("leisure", value) for value in ("park", "golf_course", "dog_park", "common")]
        + [("natural", value) for value in ("grassland", "heath", "fell")]
        + [("landcover", "grass"), ("amenity", "grave_yard")], Ground.GRASS),
    **dict.fromkeys([("landuse", "forest"), ("natural", "wood"), ("natural", "scrub"), ("landcover", "trees")],
                    Ground.WOOD),
    **dict.fromkeys([("landuse", value) for value in ("flowerbed", "orchard", "vineyard", "allotments",
                                                      "plant_nursery")]
                    + [("leisure", "garden"), ("natural", "shrubbery")], Ground.GARDEN),
    **dict.fromkeys([("natural", value) for value in ("beach", "sand", "shingle", "bare_rock", "scree")], Ground.SAND),
    ("landuse", "construction"): Ground.CONSTRUCTION,
    ("landuse", "brownfield"): Ground.CONSTRUCTION,
    ("landuse", "railway"): Ground.RAILWAY,
    ("amenity", "parking"): Ground.PARKING,
    ("amenity", "parking_space"): Ground.PARKING,
    ("amenity", "motorcycle_parking"): Ground.PARKING,
    ("amenity", "marketplace"): Ground.PLAZA,
    ("place", "square"): Ground.PLAZA,
    ("leisure", "schoolyard"): Ground.YARD,
    ("leisure", "playground"): Ground.PLAYGROUND,
    **dict.fromkeys([("leisure", "pitch"), ("leisure", "track"), ("leisure", "ice_rink")], Ground.PITCH),
}  # fmt: skip
_WATER = frozenset({("natural", "water"), ("landuse", "basin"), ("landuse", "reservoir"), ("waterway", "riverbank"),
                    ("waterway", "dock"), ("leisure", "swimming_pool")})  # fmt: skip
_DECK = frozenset({("man_made", "pier"), ("man_made", "breakwater"), ("man_made", "quay"),
                   ("railway", "platform"), ("public_transport", "platform")})  # fmt: skip
_AREA_HIGHWAYS = {"pedestrian": Ground.PLAZA, "footway": Ground.PAVEMENT, "platform": Ground.PAVEMENT,
                  "path": Ground.PATH, "cycleway": Ground.CYCLEWAY, "steps": Ground.STEPS, "track": Ground.PATH,
                  "rest_area": Ground.PARKING, "services": Ground.PARKING,
                  "traffic_island": Ground.PAVEMENT}  # fmt: skip
_ROADS = frozenset({"motorway", "motorway_link", "trunk", "trunk_link", "primary", "primary_link", "secondary",
                    "secondary_link", "tertiary", "tertiary_link", "unclassified", "residential", "living_street",
                    "service", "road", "busway", "bus_guideway", "raceway"})  # fmt: skip
_AREA_HIGHWAYS |= dict.fromkeys(_ROADS, Ground.ROAD)
# Of several keys the earlier one counts.
_AREA_KEYS = ("man_made", "railway", "public_transport", "amenity", "leisure", "natural", "waterway", "landcover",
              "landuse", "place")  # fmt: skip
_AREA_GROUND: dict[tuple[str, str], tuple[int, Ground]] = {
    **{pair: (BASE_LAYER, ground) for pair, ground in _BASE.items()},
    **{pair: (LAND_LAYER, ground) for pair, ground in _LAND.items()},
    **dict.fromkeys(_WATER, (WATER_LAYER, Ground.WATER)),
    **dict.fromkeys(_DECK, (DECK_LAYER, Ground.PAVEMENT)),
}
_LARGEST_BASIN_M2 = 400.0
_LINE_KEYS = ("highway", "railway", "barrier", "waterway")

# Widths where the map gives none, metres: typical ones, assumed.
_ROAD_WIDTH_M = {"motorway": 10.5, "trunk": 9.0, "primary": 9.0, "secondary": 8.0, "tertiary": 7.0,
                 "unclassified": 6.0, "residential": 6.0, "living_street": 5.5, "service": 3.5, "road": 6.0,
                 "busway": 6.4, "bus_guideway": 6.4, "raceway": 10.0}  # fmt: skip
_LINK_WIDTH_M = 4.5
_LANE_WIDTH_M = 3.2
_FOOT_WIDTH_M = {"footway": 2.0, "pedestrian": 6.0, "path": 1.5, "bridleway": 2.0, "track": 3.0, "cycleway": 2.0,
                 "steps": 2.0, "platform": 3.0, "corridor": 2.0}  # fmt: skip
_FOOT_GROUND = {"footway": Ground.PATH, "pedestrian": Ground.PLAZA, "path": Ground.PATH, "bridleway": Ground.PATH,
                "track": Ground.PATH, "cycleway": Ground.CYCLEWAY, "steps": Ground.STEPS,
                "platform": Ground.PAVEMENT, "corridor": Ground.PAVEMENT}  # fmt: skip
_WATER_WIDTH_M = {"river": 6.0, "canal": 5.0, "stream": 1.5, "drain": 1.0, "ditch": 1.0}
_RAIL_WIDTH_M = {"rail": 3.2, "light_rail": 3.0, "narrow_gauge": 2.6, "funicular": 2.6, "subway": 3.0, "monorail": 1.0}
_SIDEWALK_WIDTH_M = 2.0
_MIN_WIDTH_M, _MAX_WIDTH_M = 0.3, 60.0


@dataclass(frozen=True, slots=True)
class LineGround:
    """What a line on the map is on the ground.

    Attributes:
        order: Drawing order, from below: water, rails, pavements, roads, footways.
        ground: What one stands on.
        width_m: Full width.
        level: 0 on the ground.
        left_m: Width of the pavement on its left as it runs, or 0.
        right_m: Likewise on its right.
    """

    order: int
    ground: Ground
    width_m: float
    level: int
    left_m: float = 0.0
    right_m: float = 0.0


WATER_ORDER, RAIL_ORDER, PAVEMENT_ORDER, ROAD_ORDER, FOOT_ORDER = range(5)


def is_area(tags: Tags) -> bool:
    """Return whether a closed way with these tags is an area rather than a line that ends where it began."""
    area = tags.get("area")
    if area in {"yes", "no"}:
        return area == "yes"
    if "building" in tags or "building:part" in tags:
        return True
    if tags.get("railway") == "platform" or tags.get("waterway") in {"riverbank", "dock"}:
        return True
    if any(key in tags for key in _LINE_KEYS):
        return any((key, tags.get(key)) in _LAND for key in ("leisure", "landuse", "amenity", "place"))
    return tags.get("natural") not in {"coastline", "tree_row"}


def ground_of_area(tags: Tags, *, area_m2: float = 0.0) -> tuple[int, Ground] | None:
    """Return the layer and the ground of an area, or None where it says nothing about the ground.

    The size tells a fountain's basin from a square that is named a fountain after what stands on it.
    """
    if _is_elsewhere(tags):
        return None
    highway = tags.get("area:highway") or tags.get("highway")
    if highway in _AREA_HIGHWAYS:
        return LAND_LAYER, _AREA_HIGHWAYS[highway]
    if tags.get("amenity") == "fountain" and area_m2 <= _LARGEST_BASIN_M2:
        return DECK_LAYER, Ground.WATER
    pairs = [(key, tags[key]) for key in _AREA_KEYS if key in tags]
    meanings = [_AREA_GROUND[pair] for pair in pairs if pair in _AREA_GROUND]
    # What merely encloses is of interest only where nothing else is said.
    return max(meanings, key=lambda meaning: meaning[0] > BASE_LAYER, default=None)


def _is_elsewhere(tags: Tags) -> bool:
    """Return whether an area is not there, or not on the ground."""
    return (
        is_gone(tags)
        or is_below_ground(tags)
        or any(is_set(tags, key) for key in ("building", "building:part", "tunnel", "bridge", "indoor"))
        or tags.get("parking") in {"multi-storey", "rooftop", "carports"}
        or tags.get("level", "0").startswith("-")
    )


def ground_of_line(tags: Tags) -> LineGround | None:
    """Return what a line is on the ground, or None where it is no way, water or railway."""
    if is_gone(tags):
        return None
    if "highway" in tags:
        return _highway(tags)
    if tags.get("man_made") in {"pier", "quay"}:
        return LineGround(FOOT_ORDER, Ground.PAVEMENT, _width_m(tags, 3.0), 0)
    if (width_m := _WATER_WIDTH_M.get(tags.get("waterway", ""))) is not None:
        return LineGround(WATER_ORDER, Ground.WATER, _width_m(tags, width_m), level_of(tags))
    # A tram in a street is crossed like the street: it makes no ground of its own.
    if (width_m := _RAIL_WIDTH_M.get(tags.get("railway", ""))) is not None:
        return LineGround(RAIL_ORDER, Ground.RAILWAY, width_m, level_of(tags))
    return None


def level_of(tags: Tags) -> int:
    """Return the level of a way: 0 on the ground, above for bridges, below for tunnels, other than 0 indoors."""
    if is_passage(tags):
        return 0  # the buildings are cut, see `buildings_of`
    layer = layer_of(tags)
    if is_set(tags, "bridge"):
        return max(layer, 1)
    if is_set(tags, "tunnel"):
        return min(layer, -1)
    if is_set(tags, "indoor") or tags.get("highway") == "corridor" or is_set(tags, "covered"):
        return layer or 1
    return layer if layer < 0 else 0


def _highway(tags: Tags) -> LineGround | None:
    kind = tags["highway"]
    if kind in _FOOT_WIDTH_M:
        ground, width_m = _FOOT_GROUND[kind], _FOOT_WIDTH_M[kind]
        if kind in {"footway", "path", "cycleway"}:
            if "crossing" in {tags.get("footway"), tags.get("path")}:
                # Where walkers cross, the road is theirs: painted over it, as zebras are.
                ground = Ground.PAVEMENT
            elif tags.get("footway") in {"sidewalk", "traffic_island", "access_aisle", "link"}:
                ground = Ground.PAVEMENT
        return LineGround(FOOT_ORDER, ground, _width_m(tags, width_m), level_of(tags))
    if kind not in _ROADS:
        return None
    base = kind.removesuffix("_link")
    default_m = _LINK_WIDTH_M if kind != base else _ROAD_WIDTH_M.get(base, 6.0)
    if kind == "service":
        default_m = {"parking_aisle": 5.0, "driveway": 3.0, "alley": 3.0}.get(tags.get("service", ""), default_m)
    lanes = parse_count(tags.get("lanes"))
    if lanes is not None and 1.0 <= lanes <= 12.0:
        default_m = max(lanes * _LANE_WIDTH_M, 3.0)
    level = level_of(tags)
    left_m, right_m = (0.0, 0.0) if level else _sidewalks(tags)
    return LineGround(ROAD_ORDER, Ground.ROAD, _width_m(tags, default_m), level, left_m, right_m)


def _width_m(tags: Tags, default_m: float) -> float:
    for key in ("width", "est_width"):
        width_m = parse_length_m(tags.get(key))
        if width_m is not None and _MIN_WIDTH_M <= width_m <= _MAX_WIDTH_M:
            return width_m
    return default_m


def _sidewalks(tags: Tags) -> tuple[float, float]:
    both = tags.get("sidewalk", "no")
    widths = []
    for side in ("left", "right"):
        mapped = tags.get(f"sidewalk:{side}", tags.get("sidewalk:both", "yes" if both in {"both", "yes", side} else ""))
        if mapped != "yes":
            widths.append(0.0)
            continue
        width_m = None
        for key in (f"sidewalk:{side}:width", "sidewalk:both:width", "sidewalk:width"):
            width_m = width_m if width_m is not None else parse_length_m(tags.get(key))
        in_range = width_m is not None and _MIN_WIDTH_M <= width_m <= 20.0
        widths.append(width_m if in_range and width_m is not None else _SIDEWALK_WIDTH_M)
    return widths[0], widths[1]
