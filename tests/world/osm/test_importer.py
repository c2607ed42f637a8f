"""From a file to a world: what is on the map is in the world, and bad files get one clear error."""

import bz2
import gzip
import math
from collections import Counter
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from reasoned_explorer.model import WorldError
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.osm.importer import ATTRIBUTION, import_osm, import_osm_with_report
from reasoned_explorer.world.taxonomy import Ground
from reasoned_explorer.world.world import World
from tests.world.osm.maps import BBOX, REAL_BBOXES, Map, degrees


def _one(world: World, class_name: str):
    (found,) = [item for item in world.objects if item.class_name == class_name]
    return found


def _region_at(world: World, x_m: float, y_m: float) -> Ground:
    top = Ground.UNKNOWN
    for region in world.regions:
        if shapely.Polygon(region.outer, list(region.holes)).contains(shapely.Point(x_m, y_m)):
            top = region.ground
    return top


def test_a_thing_stands_where_the_map_has_it(tmp_path: Path) -> None:
    town = Map()
    town.node(30.0, -20.0, {"amenity": "bench", "direction": "E", "backrest": "yes", "note": "x"})
    world = import_osm(town.write(tmp_path), bbox=BBOX)
    bench = _one(world, "bench")
    assert (bench.x_m, bench.y_m) == (pytest.approx(30.0, abs=0.2), pytest.approx(-20.0, abs=0.2))
    assert bench.heading_rad == pytest.approx(math.pi / 2)
    assert bench.attributes == {"backrest": "yes"}
    assert world.attribution == ATTRIBUTION
    assert world.origin is not None
    assert world.origin.lat_deg == pytest.approx(48.0)
    assert world.bounds.width_m == pytest.approx(400.0, abs=1.0)
    assert world.name == "map"


def test_furniture_without_a_direction_faces_the_nearest_way(tmp_path: Path) -> None:
    town = Map()
    town.way([(-100, 0), (100, 0)], {"highway": "footway"})
    town.node(10.0, 5.0, {"amenity": "bench"})
    town.way([(20, -6), (22, -6)], {"amenity": "bench"})
    north, drawn_as_line = (
        item for item in import_osm(town.write(tmp_path), bbox=BBOX).objects if item.class_name == "bench"
    )
    assert north.heading_rad == pytest.approx(math.pi, abs=0.01)
    assert math.cos(drawn_as_line.heading_rad) == pytest.approx(1.0, abs=0.01)
    assert drawn_as_line.size_m[0] == pytest.approx(2.0, abs=0.05)
    assert drawn_as_line.outline is not None


def test_a_shop_is_reached_by_its_door(tmp_path: Path) -> None:
    town = Map()
    corners = [town.node(x, y) for x, y in [(0, 0), (20, 0), (20, 10), (0, 10)]]
    door = town.node(5, 0, {"entrance": "main"})
    town.way_of([corners[0], door, *corners[1:], corners[0]], {"building": "retail"})
    town.node(8, 5, {"shop": "bakery", "name": "Brot"})
    town.box(60, 0, 70, 10, {"building": "yes", "amenity": "cafe"})
    town.way([(-50, -8), (120, -8)], {"highway": "residential", "sidewalk": "both"})
    world = import_osm(town.write(tmp_path), bbox=BBOX)
    shop, cafe = _one(world, "shop"), _one(world, "cafe")
    assert (shop.x_m, shop.y_m) == (pytest.approx(5.0, abs=0.1), pytest.approx(-0.5, abs=0.1))
    assert shop.heading_rad == pytest.approx(math.pi, abs=0.02)
    assert world.buildings[shop.building].entrances.shape == (1, 2)
    assert (cafe.x_m, cafe.y_m) == (pytest.approx(65.0, abs=0.2), pytest.approx(-0.5, abs=0.1))
    assert cafe.building != shop.building


def test_furniture_in_a_house_is_dropped_and_under_a_roof_is_not(tmp_path: Path) -> None:
    town = Map()
    town.box(0, 0, 20, 20, {"building": "yes"})
    town.box(40, 0, 60, 20, {"building": "roof", "height": "5"})
    for x_m in (10, 50):
        town.node(x_m, 10, {"amenity": "bench"})
    town.node(0.3, 10, {"amenity": "post_box"})
    town.box(80, 0, 84, 3, {"building": "yes", "amenity": "shelter"})
    world, report = import_osm_with_report(town.write(tmp_path), bbox=BBOX)
    assert _one(world, "bench").x_m == pytest.approx(50, abs=0.2)
    assert report.counts["objects inside buildings dropped"] == 1
    assert "1 objects inside buildings dropped" in report.warnings
    # A mailbox drawn just inside a wall hangs on it.
    assert _one(world, "post_box").x_m == pytest.approx(-0.3, abs=0.1)
    assert _one(world, "shelter").building >= 0
    assert [one.min_height_m > 2.0 for one in world.buildings] == [False, True, False]


def test_a_passage_leads_through_a_house_into_its_courtyard(tmp_path: Path) -> None:
    town = Map()
    outer, inner = town.box(0, 0, 40, 40), town.box(10, 10, 30, 30)
    town.relation([(outer, "outer"), (inner, "inner")], {"building": "apartments", "building:levels": "5"})
    town.way([(20, 0), (20, 10)], {"highway": "service", "tunnel": "building_passage", "layer": "-1"})
    town.way([(20, -30), (20, 0)], {"highway": "service"})
    world = import_osm(town.write(tmp_path), bbox=BBOX)
    ground = Atlas(world).ground
    assert [ground.at(20.0, y_m) for y_m in (-5.0, 5.0, 20.0)] == [Ground.ROAD, Ground.ROAD, Ground.YARD]
    assert ground.at(5.0, 5.0) == Ground.BUILDING
    arch = [one for one in world.buildings if one.min_height_m > 2.0]
    assert [(one.min_height_m, one.height_m) for one in arch] == [(3.5, 15.0)]
    assert {one.height_m for one in world.buildings} == {15.0}


@pytest.mark.parametrize("drawn", ["as a way", "as a point", "as both"])
def test_crossings_are_pavement_over_the_road(tmp_path: Path, drawn: str) -> None:
    town = Map()
    middle = town.node(0, 0, {} if drawn == "as a way" else {"highway": "crossing", "crossing": "zebra"})
    town.way_of([town.node(-60, 0), middle, town.node(60, 0)], {"highway": "secondary", "width": "10"})
    if drawn != "as a point":
        town.way_of([town.node(0, -6), middle, town.node(0, 6)], {"highway": "footway", "footway": "crossing"})
    world = import_osm(town.write(tmp_path), bbox=BBOX)
    ground = Atlas(world).ground
    assert {ground.at(0.0, y_m) for y_m in (-4.0, -2.0, 0.0, 2.0, 4.0)} == {Ground.PAVEMENT}
    assert ground.at(8.0, 0.0) == Ground.ROAD
    assert sum(way.ground == Ground.PAVEMENT for way in world.ways) == 1


def test_a_shop_deep_in_a_house_whose_ways_are_indoors_comes_out_into_the_open(tmp_path: Path) -> None:
    town = Map()
    town.box(-40, -40, 40, 40, {"building": "retail"})
    town.way([(-10, 0), (10, 0)], {"highway": "footway"})
    town.node(2, 3, {"shop": "shoes"})
    world = import_osm(town.write(tmp_path), bbox=BBOX)
    shop = _one(world, "shop")
    assert Atlas(world).ground.at(shop.x_m, shop.y_m) != Ground.BUILDING


def test_courtyards_are_holes_with_yard_ground(tmp_path: Path) -> None:
    town = Map()
    outer, inner = town.box(0, 0, 40, 40), town.box(10, 10, 30, 30)
    town.relation([(outer, "outer"), (inner, "inner")], {"building": "apartments", "building:levels": "5"})
    world = import_osm(town.write(tmp_path), bbox=BBOX)
    (house,) = world.buildings
    assert len(house.holes) == 1
    assert house.height_m == 15.0
    assert house.height_source == "levels"
    assert _region_at(world, 20, 20) == Ground.YARD


def test_parts_stand_in_for_their_outline(tmp_path: Path) -> None:
    town = Map()
    town.box(0, 0, 40, 10, {"building": "church", "height": "60", "name": "St"})
    town.box(0, 0, 10, 10, {"building:part": "yes", "height": "60"})
    town.box(10, 0, 40, 10, {"building:part": "yes", "height": "15"})
    world = import_osm(town.write(tmp_path), bbox=BBOX)
    assert sorted(one.height_m for one in world.buildings) == [15.0, 60.0]


def test_the_smaller_area_lies_on_the_larger_and_water_on_both(tmp_path: Path) -> None:
    town = Map()
    town.box(-20, -20, 20, 20, {"leisure": "playground"})
    town.box(-100, -100, 100, 100, {"leisure": "park"})
    town.box(-150, -5, 150, 5, {"natural": "water"})
    world = import_osm(town.write(tmp_path), bbox=BBOX)
    assert _region_at(world, 0, 10) == Ground.PLAYGROUND
    assert _region_at(world, 50, 50) == Ground.GRASS
    assert _region_at(world, 0, 0) == Ground.WATER
    assert {"playground", "lawn"} <= {item.class_name for item in world.objects}


def test_the_sea_lies_right_of_the_coastline(tmp_path: Path) -> None:
    town = Map()
    town.way([(-300, 0), (300, 0)], {"natural": "coastline"})
    town.way([(-100, 20), (100, 20)], {"highway": "footway"})
    world = import_osm(town.write(tmp_path), bbox=BBOX)
    assert _region_at(world, 0, -50) == Ground.WATER
    assert _region_at(world, 0, 50) == Ground.UNKNOWN


def test_ways_have_widths_levels_and_pavements(tmp_path: Path) -> None:
    town = Map()
    town.way([(-300, 0), (300, 0)], {"highway": "residential", "sidewalk": "right", "name": "Gasse"})
    town.way([(-50, 50), (50, 50)], {"highway": "footway", "tunnel": "yes"})
    world = import_osm(town.write(tmp_path), bbox=BBOX)
    pavement, road, tunnel = world.ways
    assert (pavement.kind, pavement.ground, pavement.width_m) == ("sidewalk", Ground.PAVEMENT, 8.0)
    assert np.allclose(pavement.line[:, 1], -1.0, atol=0.05)
    assert (road.kind, road.name, road.width_m, road.level) == ("residential", "Gasse", 6.0, 0)
    assert np.abs(road.line[:, 0]).max() == pytest.approx(200.0, abs=0.5)
    assert tunnel.level == -1


def test_a_bridge_makes_ground_over_water_but_not_over_a_street(tmp_path: Path) -> None:
    town = Map()
    town.box(-20, -150, 20, 150, {"natural": "water"})
    town.way([(-60, 0), (60, 0)], {"highway": "footway", "bridge": "yes"})
    town.way([(50, -100), (50, 100)], {"highway": "residential"})
    world = import_osm(town.write(tmp_path), bbox=BBOX)
    on_ground = [way for way in world.ways if way.kind == "footway" and way.level == 0]
    above = [way for way in world.ways if way.level > 0]
    assert any(shapely.LineString(way.line).distance(shapely.Point(0, 0)) < 0.1 for way in on_ground)
    assert all(shapely.LineString(way.line).distance(shapely.Point(50, 0)) > 3.0 for way in on_ground)
    assert any(shapely.LineString(way.line).distance(shapely.Point(50, 0)) < 0.1 for way in above)


def test_trees_of_rows_stand_about_eight_metres_apart(tmp_path: Path) -> None:
    town = Map()
    town.way([(0, 0), (40, 0)], {"natural": "tree_row"})
    town.node(0, 50, {"natural": "tree", "height": "20", "diameter_crown": "7"})
    world = import_osm(town.write(tmp_path), bbox=BBOX)
    trees = [item for item in world.objects if item.class_name == "tree"]
    assert len(trees) == 7
    assert (7.0, 7.0, 20.0) in [tree.size_m for tree in trees]
    assert len({tree.size_m for tree in trees}) == 7


def test_a_traffic_light_on_the_road_stands_at_its_kerb(tmp_path: Path) -> None:
    town = Map()
    first, light, last = town.node(0, -50), town.node(0, 0, {"highway": "traffic_signals"}), town.node(0, 50)
    town.way_of([first, light, last], {"highway": "residential"})
    signal = _one(import_osm(town.write(tmp_path), bbox=BBOX), "traffic_signals")
    assert signal.x_m == pytest.approx(3.6, abs=0.1)
    assert signal.heading_rad == pytest.approx(math.pi, abs=0.05)


def test_what_reaches_over_the_border_is_cut_there(tmp_path: Path) -> None:
    town = Map()
    town.box(150, 150, 300, 300, {"building": "yes"})
    town.box(-300, -300, -150, 300, {"leisure": "park"})
    town.node(250, 0, {"amenity": "bench"})
    world = import_osm(town.write(tmp_path), bbox=BBOX)
    for ring in [one.outer for one in world.buildings] + [region.outer for region in world.regions]:
        assert np.abs(ring).max() <= 200.5
    assert not [item for item in world.objects if item.class_name == "bench"]
    assert all(world.bounds.contains(item.x_m, item.y_m) for item in world.objects)


def test_ways_may_come_before_their_nodes_and_ids_may_be_negative(tmp_path: Path) -> None:
    (lat0, lon0), (lat1, lon1) = degrees(-20, 0), degrees(20, 0)
    path = tmp_path / "draft.osm"
    path.write_text(
        f'<osm version="0.6"><way id="-9"><nd ref="-1"/><nd ref="7"/><tag k="highway" v="path"/></way>'
        f'<node id="7" lat="{lat1}" lon="{lon1}"/><node id="-1" lat="{lat0}" lon="{lon0}"/></osm>'
    )
    (way,) = import_osm(path, bbox=BBOX).ways
    assert shapely.LineString(way.line).length == pytest.approx(40.0, abs=0.2)


def test_lost_nodes_and_members_are_counted_and_the_rest_is_used(tmp_path: Path) -> None:
    town = Map()
    ids = [town.node(x, 0) for x in (0, 10, 20)]
    town.way_of([*ids, 999_999], {"highway": "footway"})
    outer = town.box(50, 50, 90, 90)
    town.relation([(outer, "outer"), (888_888, "outer")], {"leisure": "park"})
    world, report = import_osm_with_report(town.write(tmp_path), bbox=BBOX)
    assert report.counts["ways that lost nodes"] == 1
    assert report.counts["multipolygons with lost members"] == 1
    assert shapely.LineString(world.ways[0].line).length == pytest.approx(20.0, abs=0.2)
    assert _region_at(world, 70, 70) == Ground.GRASS


@pytest.mark.parametrize(("suffix", "pack"), [(".osm.gz", gzip.compress), (".osm.bz2", bz2.compress)])
def test_packed_files_are_read(tmp_path: Path, suffix: str, pack) -> None:
    town = Map()
    town.node(0, 0, {"amenity": "bench"})
    path = tmp_path / f"map{suffix}"
    path.write_bytes(pack(town.xml().encode()))
    assert len(import_osm(path, bbox=BBOX).objects) == 1


def test_without_a_bbox_the_extent_of_the_contents_counts(tmp_path: Path) -> None:
    town = Map()
    town.node(-100, -50, {"amenity": "bench"})
    town.node(100, 50, {"amenity": "bench"})
    world = import_osm(town.write(tmp_path))
    assert world.bounds.width_m == pytest.approx(200.0, abs=20.0)
    assert len(world.objects) == 2


def test_same_file_same_world_and_seeds_differ(tmp_path: Path) -> None:
    town = Map()
    town.box(0, 0, 20, 20, {"building": "yes"})
    town.node(50, 0, {"natural": "tree"})
    path = town.write(tmp_path)
    worlds = [import_osm(path, bbox=BBOX, seed=seed) for seed in (1, 1, 2)]
    heights = [(world.buildings[0].height_m, world.objects[0].size_m) for world in worlds]
    assert heights[0] == heights[1] != heights[2]


def _fails(path: Path, words: str, **options: object) -> None:
    with pytest.raises(WorldError, match=words) as caught:
        import_osm(path, **options)  # type: ignore[arg-type]
    assert all(fault.expected for fault in caught.value.faults)


def test_files_that_are_none(tmp_path: Path) -> None:
    _fails(tmp_path / "nowhere.osm", "there is no file")
    _fails(tmp_path, "is a directory")
    for name, content, words in [
        ("empty.osm.pbf", b"", "is empty"),
        ("notes.txt", b"hello", "none of an OpenStreetMap file"),
        ("prose.osm", b"hello", "cannot be read"),
        ("broken.osm", b'<osm version="0.6"><node id="1"', "cannot be read"),
        ("other.osm", b"<html></html>", "cannot be read"),
        ("noise.osm.pbf", bytes(range(256)) * 10, "cannot be read"),
        ("noise.osm.gz", b"not gzip at all", "cannot be read"),
        ("nothing.osm", b'<osm version="0.6"></osm>', "there is nothing in"),
        (
            "swapped.osm",
            b'<osm version="0.6"><node id="1" lat="148.1" lon="11.5"><tag k="amenity" v="bench"/></node></osm>',
            "lies on earth: 1 nodes that lie nowhere on earth; expected latitudes from -90 to 90",
        ),
        (
            "adrift.osm",
            b'<osm version="0.6"><node id="1"><tag k="amenity" v="bench"/></node></osm>',
            "that has a place: 1 nodes without a place",
        ),
    ]:
        path = tmp_path / name
        path.write_bytes(content)
        _fails(path, words)


@pytest.mark.parametrize(
    ("bbox", "words"),
    [
        ((11.0, 48.0, 11.01), "3 numbers"),
        (("a", 48.0, 11.01, 48.01), "not four numbers"),
        (None.__class__, "not four numbers"),
        ((math.nan, 48.0, 11.01, 48.01), "not finite"),
        ((11.01, 48.0, 11.0, 48.01), "not west"),
        ((11.0, 48.01, 11.01, 48.0), "not south"),
        ((11.0, 48.0, 11.0, 48.0), "not west"),
        ((200.0, 48.0, 201.0, 48.01), "lon0 is 200"),
        ((11.0, 91.0, 11.01, 92.0), "lat0 is 91"),
        ((11.0, 48.0, 11.5, 48.5), "km²"),
        ((11.0, 48.0, 11.00001, 48.00001), "m by"),
    ],
)
def test_boxes_that_are_none(tmp_path: Path, bbox: object, words: str) -> None:
    _fails(Map().write(tmp_path), words, bbox=bbox)


def test_all_faults_of_a_box_are_told_at_once(tmp_path: Path) -> None:
    with pytest.raises(WorldError) as caught:
        import_osm(Map().write(tmp_path), bbox=(300.0, 95.0, 200.0, 94.0))
    assert len(caught.value.faults) == 6


def test_nothing_within_the_box(tmp_path: Path) -> None:
    town = Map()
    town.node(0, 0, {"amenity": "bench"})
    _fails(town.write(tmp_path), "nothing in map.osm lies within", bbox=(12.0, 48.0, 12.01, 48.01))


def test_too_large_as_a_whole_says_how_to_crop(tmp_path: Path) -> None:
    town = Map()
    for x_m in (-9000, 9000):
        town.node(x_m, x_m, {"amenity": "bench"})
    with pytest.raises(WorldError, match="pass a smaller bbox"):
        import_osm(town.write(tmp_path))


_NUMBERS = st.one_of(st.floats(-250, 250), st.sampled_from([0.0, 1e-7, -200.0, 200.0]))
_VALUES = st.sampled_from(
    ["yes", "no", "nan", "-3", "1e400", "40'", "12,5", "9" * 30, "\u0663", "multipolygon", "a\nb", "both", "0"]
)
_TAG_SETS = st.dictionaries(
    st.sampled_from(["height", "width", "building:levels", "min_height", "layer", "direction", "name", "sidewalk",
                     "bridge", "area", "capacity", "lanes", "entrance", "building:part"]),
    _VALUES, max_size=4,
)  # fmt: skip
_KINDS = st.sampled_from(
    [{"building": "yes"}, {"building": "roof"}, {"landuse": "grass"}, {"natural": "water"}, {"natural": "coastline"},
     {"highway": "footway"}, {"highway": "primary"}, {"amenity": "bench"}, {"natural": "tree_row"}, {"shop": "x"},
     {"leisure": "playground"}, {"amenity": "fountain"}, {"highway": "traffic_signals"}, {}]
)  # fmt: skip


@settings(max_examples=60)
@given(
    points=st.lists(st.tuples(_NUMBERS, _NUMBERS), min_size=1, max_size=8),
    things=st.lists(
        st.tuples(_KINDS, _TAG_SETS, st.lists(st.integers(0, 10), max_size=7), st.booleans(), st.integers(0, 2)),
        max_size=6,
    ),
    data=st.data(),
)
def test_any_map_imports_or_says_why_not(points, things, data) -> None:
    """Unsorted ids, missing nodes, rings that cross themselves, numbers that are none."""
    ids = data.draw(st.permutations([*range(-3, 0), *range(1, 9)]))[: len(points)]
    parts = []
    for at, (x_m, y_m) in zip(ids, points, strict=True):
        lat, lon = degrees(x_m, y_m)
        parts.append(f'<node id="{at}" version="1" lat="{lat:.7f}" lon="{lon:.7f}"/>')
    town = Map()
    town._next = 100
    for kind, tags, refs, closed, what in things:
        chosen = [ids[ref] if ref < len(ids) else 1000 + ref for ref in refs]
        if what == 0:
            x_m, y_m = points[len(refs) % len(points)]
            town.node(x_m, y_m, {**kind, **tags})
        else:
            way = town.way_of(
                [*chosen, chosen[0]] if closed and chosen else chosen, {**kind, **tags} if what == 1 else {}
            )
            if what == 2:
                town.relation([(way, "outer"), (way + 7, "inner")], {**kind, **tags})
    shuffled = data.draw(st.permutations([*parts, *town.parts]))
    with TemporaryDirectory() as folder:
        path = Path(folder) / "any.osm"
        path.write_text(f'<osm version="0.6">{"".join(shuffled)}</osm>', encoding="utf-8")
        try:
            world = import_osm(path, bbox=BBOX)
        except WorldError:
            return
    assert [item.id for item in world.objects] == list(range(len(world.objects)))
    limits = np.array([world.bounds.max_x_m, world.bounds.max_y_m]) + 1e-6
    for ring in [*(one.outer for one in world.buildings), *(region.outer for region in world.regions)]:
        assert ring.shape[0] >= 3
        assert (np.abs(ring) <= limits).all()
    for way in world.ways:
        assert way.line.shape[0] >= 2
        assert np.isfinite(way.line).all()
        assert 0.0 < way.width_m < 120.0
    for item in world.objects:
        assert world.bounds.contains(item.x_m, item.y_m)
        assert 0.0 <= item.heading_rad < 2.0 * math.pi
        assert all(0.0 < side < 500.0 for side in item.size_m)
    for one in world.buildings:
        assert 0.0 <= one.min_height_m < one.height_m


@pytest.mark.parametrize(
    ("place", "class_name", "number"),
    [("uvic-campus", "bench", 262), ("uvic-campus", "tree", 264), ("uvic-campus", "picnic_table", 39),
     ("uvic-campus", "fire_hydrant", 7)],
)  # fmt: skip
def test_a_real_place_has_what_was_counted_there(osm_folder: Path, place: str, class_name: str, number: int) -> None:
    world = import_osm(osm_folder / f"{place}.osm.pbf", bbox=REAL_BBOXES[place])
    found = Counter(item.class_name for item in world.objects)[class_name]
    # Those inside houses are dropped.
    assert 0.97 * number <= found <= number


def test_a_cut_off_file_is_told(osm_folder: Path, tmp_path: Path) -> None:
    whole = (osm_folder / "uvic-campus.osm.pbf").read_bytes()
    path = tmp_path / "cut.osm.pbf"
    for length in (3, 50, len(whole) // 2, len(whole) - 5):
        path.write_bytes(whole[:length])
        _fails(path, "cannot be read")


def test_the_sea_off_monaco(osm_folder: Path) -> None:
    world, report = import_osm_with_report(osm_folder / "monaco-2025.osm.pbf")
    assert world.bounds.area_km2 < 25.0
    assert any("too large" in warning for warning in report.warnings)
    assert world.origin is not None
    for lat, lon, is_sea in [(43.7280, 7.4380, True), (43.7350, 7.4245, True), (43.7312, 7.4197, False)]:
        x_m, y_m = world.origin.enu_from_geodetic_m(lat, lon)
        assert (_region_at(world, float(x_m), float(y_m)) == Ground.WATER) is is_sea
