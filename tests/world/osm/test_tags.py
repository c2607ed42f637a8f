"""Tags become numbers, headings and classes, or None: never an exception, never nonsense."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reasoned_explorer.world.osm.ground import ground_of_area, ground_of_line, is_area
from reasoned_explorer.world.osm.tags import (
    attributes_of,
    class_of,
    clean_text,
    layer_of,
    parse_count,
    parse_direction_rad,
    parse_length_m,
)
from reasoned_explorer.world.taxonomy import OBJECT_CLASSES, Ground

_KEYS = st.sampled_from(
    ["highway", "building", "building:part", "landuse", "natural", "leisure", "amenity", "width", "lanes", "layer",
     "bridge", "tunnel", "area", "sidewalk", "sidewalk:left", "sidewalk:width", "waterway", "railway", "shop",
     "tourism", "level", "footway", "service", "place", "man_made", "traffic_sign", "memorial", "historic"]
)  # fmt: skip
_VALUES = st.one_of(
    st.text(max_size=12),
    st.sampled_from(["yes", "no", "both", "separate", "nan", "-1", "1e999", "footway", "primary", "grass", "bench",
                     "water", "pedestrian", "crossing", "1", "2;3", "٣"]),
)  # fmt: skip
_TAGS = st.dictionaries(_KEYS, _VALUES, max_size=8)


@pytest.mark.parametrize(
    ("text", "metres"),
    [("12", 12.0), ("12 m", 12.0), ("12m", 12.0), ("12,5", 12.5), ("40'", 12.192), ("5'10\"", 1.778), ("30 ft", 9.144),
     ("~8", 8.0), ("80 cm", 0.8), ("0", 0.0)],
)  # fmt: skip
def test_lengths_with_and_without_units(text: str, metres: float) -> None:
    assert parse_length_m(text) == pytest.approx(metres)


@pytest.mark.parametrize("text", [None, "", "tall", "-3", "nan", "inf", "1e9", "12 parsecs", "3-4", "٣", "1" * 400])
def test_what_is_no_length_is_none(text: str | None) -> None:
    assert parse_length_m(text) is None


@pytest.mark.parametrize(
    ("text", "degrees"),
    [("45", 45.0), ("0", 0.0), ("360", 0.0), ("NE", 45.0), ("north-east", 45.0), ("ssw", 202.5), ("40-80", 60.0),
     ("350-10", 0.0), ("90;270", 90.0), ("N-E", 45.0)],
)  # fmt: skip
def test_directions_turn_clockwise_from_north(text: str, degrees: float) -> None:
    heading = parse_direction_rad(text)
    assert heading is not None
    assert math.cos(heading - math.radians(degrees)) == pytest.approx(1.0)


@pytest.mark.parametrize("text", [None, "", "forward", "both", "400", "-5", "nan", "up"])
def test_what_is_no_direction_is_none(text: str | None) -> None:
    assert parse_direction_rad(text) is None


@pytest.mark.parametrize(("text", "count"), [("4", 4.0), ("4.5", 4.5), ("3;4", 3.0), ("x", None), (None, None)])
def test_counts(text: str | None, count: float | None) -> None:
    assert parse_count(text) == count


@settings(deadline=None, max_examples=100)
@given(st.text(max_size=30))
def test_any_text_gives_a_number_in_range_or_none(text: str) -> None:
    for value in (parse_length_m(text), parse_count(text)):
        assert value is None or (math.isfinite(value) and value >= 0.0)
    heading = parse_direction_rad(text)
    assert heading is None or 0.0 <= heading < 2.0 * math.pi
    assert -10 <= layer_of({"layer": text}) <= 10


@settings(deadline=None, max_examples=100)
@given(_TAGS)
def test_any_tags_have_a_meaning_or_none(tags: dict[str, str]) -> None:
    name = class_of(tags, is_node=True)
    assert name is None or name in OBJECT_CLASSES
    line = ground_of_line(tags)
    assert line is None or (0.0 < line.width_m <= 60.0 and 0.0 <= line.left_m <= 20.0)
    ground_of_area(tags)
    is_area(tags)


@pytest.mark.parametrize(
    ("tags", "name"),
    [
        ({"amenity": "bench"}, "bench"),
        ({"amenity": "fountain", "tourism": "artwork"}, "fountain"),
        ({"amenity": "vending_machine", "vending": "parking_tickets"}, "parking_meter"),
        ({"shop": "kiosk"}, "kiosk"),
        ({"shop": "bakery"}, "shop"),
        ({"shop": "bakery", "amenity": "cafe"}, "cafe"),
        ({"shop": "vacant"}, None),
        ({"amenity": "bench", "disused": "yes"}, None),
        ({"historic": "memorial", "memorial": "statue"}, "monument"),
        ({"historic": "memorial", "memorial": "plaque"}, None),
        ({"vehicle": "car"}, None),
        ({"person": "yes"}, None),
    ],
)
def test_the_more_special_tag_decides(tags: dict[str, str], name: str | None) -> None:
    assert class_of(tags, is_node=True) == name


def test_a_traffic_sign_on_a_way_states_a_rule_and_is_no_sign() -> None:
    assert class_of({"traffic_sign": "DE:239"}, is_node=True) == "traffic_sign"
    assert class_of({"traffic_sign": "DE:239"}, is_node=False) is None


@pytest.mark.parametrize(
    ("tags", "ground", "width_m", "level"),
    [
        ({"highway": "residential"}, Ground.ROAD, 6.0, 0),
        ({"highway": "primary", "lanes": "4"}, Ground.ROAD, 12.8, 0),
        ({"highway": "primary", "width": "7,5 m"}, Ground.ROAD, 7.5, 0),
        ({"highway": "primary", "width": "900"}, Ground.ROAD, 9.0, 0),
        ({"highway": "footway", "footway": "sidewalk"}, Ground.PAVEMENT, 2.0, 0),
        ({"highway": "footway", "footway": "crossing"}, Ground.PAVEMENT, 2.0, 0),
        ({"highway": "footway"}, Ground.PATH, 2.0, 0),
        ({"highway": "pedestrian"}, Ground.PLAZA, 6.0, 0),
        ({"highway": "steps", "bridge": "yes"}, Ground.STEPS, 2.0, 1),
        ({"highway": "footway", "tunnel": "yes", "layer": "-2"}, Ground.PATH, 2.0, -2),
        ({"highway": "footway", "indoor": "yes"}, Ground.PATH, 2.0, 1),
        ({"highway": "service", "tunnel": "building_passage", "layer": "-1"}, Ground.ROAD, 3.5, 0),
        ({"railway": "rail"}, Ground.RAILWAY, 3.2, 0),
        ({"waterway": "stream", "tunnel": "culvert"}, Ground.WATER, 1.5, -1),
    ],
)
def test_lines_make_ground(tags: dict[str, str], ground: Ground, width_m: float, level: int) -> None:
    line = ground_of_line(tags)
    assert line is not None
    assert (line.ground, line.width_m, line.level) == (ground, pytest.approx(width_m), level)


@pytest.mark.parametrize("tags", [{"railway": "tram"}, {"highway": "proposed"}, {"highway": "elevator"}, {}])
def test_some_lines_make_none(tags: dict[str, str]) -> None:
    assert ground_of_line(tags) is None


@pytest.mark.parametrize(
    ("tags", "ground"),
    [
        ({"leisure": "park"}, Ground.GRASS),
        ({"natural": "water"}, Ground.WATER),
        ({"highway": "pedestrian", "area": "yes"}, Ground.PLAZA),
        ({"amenity": "parking"}, Ground.PARKING),
        ({"amenity": "parking", "parking": "underground"}, None),
        ({"landuse": "residential"}, None),
        ({"building": "yes", "leisure": "pitch"}, None),
        ({"natural": "water", "layer": "-1"}, None),
        ({"man_made": "pier"}, Ground.PAVEMENT),
    ],
)
def test_areas_make_ground(tags: dict[str, str], ground: Ground | None) -> None:
    meaning = ground_of_area(tags)
    assert (None if meaning is None else meaning[1]) == ground


def test_attributes_are_few_short_and_printable() -> None:
    kept = attributes_of({"name": "A\x00B\n" + "c" * 200, "backrest": "yes", "note": "ignore me", "colour": " "})
    assert set(kept) == {"name", "backrest"}
    assert len(kept["name"]) <= 80
    assert kept["name"].isprintable()


@settings(deadline=None, max_examples=50)
@given(st.text(max_size=200))
def test_clean_text_is_clean(text: str) -> None:
    assert len(clean_text(text)) <= 80
    assert clean_text(text).isprintable()
