"""What a view shows: pinhole geometry, occlusion, ground."""

import math
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Camera, SettingsError
from reasoned_explorer.simulation import eyes_kernels
from reasoned_explorer.simulation.eyes import Eyes
from reasoned_explorer.simulation.eyes_kernels import _window, in_view, see_objects
from reasoned_explorer.world.raster import GroundRaster
from reasoned_explorer.world.sight import SightLines
from reasoned_explorer.world.taxonomy import OBJECT_CLASSES, Ground
from reasoned_explorer.world.world import Bounds, Building, Region, World, WorldObject

CAMERA = Camera()
NORTH, EAST, SOUTH = 0.0, math.pi / 2, math.pi


def box(x, y, width, depth):
    return np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], float) * (width / 2, depth / 2) + (x, y)


def eyes_on(*objects, buildings=(), regions=(), **options):
    placed = []
    for place, (name, x, y, *more) in enumerate(objects):
        fields = {"size_m": OBJECT_CLASSES[name].size_m, **(more[0] if more else {})}
        placed.append(WorldObject(place, name, x, y, **fields))
    world = World("test", Bounds(-100, -100, 100, 100), tuple(regions), (), tuple(buildings), tuple(placed))
    atlas = SimpleNamespace(world=world, sight=SightLines.of(world), ground=GroundRaster.of(world))
    return Eyes(atlas, **options)


def look(*objects, x=0.0, y=0.0, z=1.5, heading=NORTH, **world):
    return eyes_on(*objects, **world).look(Pose(x, y, z, heading), CAMERA)


def test_a_hydrant_at_fifteen_metres():
    (seen,) = look(("fire_hydrant", 0, 15.175)).sightings
    assert (seen.class_name, seen.distance_m, seen.visible_share) == ("fire_hydrant", pytest.approx(15.0), 1.0)
    assert seen.width_px == pytest.approx(2.6, abs=0.1)
    assert seen.height_px == pytest.approx(6.0, abs=0.1)
    assert seen.bearing_rad == pytest.approx(0.0)


def test_left_is_negative_and_right_is_positive():
    view = look(("bench", -5, 10), ("bench", 5, 10))
    assert sorted((s.object_id, s.bearing_rad < 0) for s in view.sightings) == [(0, True), (1, False)]
    east = look(("bench", 10, 5), ("bench", 10, -5), heading=EAST)
    assert sorted((s.object_id, s.bearing_rad < 0) for s in east.sightings) == [(0, True), (1, False)]


@settings(deadline=None, max_examples=100)
@given(st.floats(0, 6.28), st.floats(-3.1, 3.1), st.floats(3, 55))
def test_in_view_is_what_lies_within_the_field_of_view(heading, bearing, distance):
    way = heading + bearing
    view = look(("bollard", distance * math.sin(way), distance * math.cos(way)), heading=heading, min_px=0.0)
    if abs(bearing) < math.pi / 4 - 1e-6:
        (seen,) = view.sightings
        assert seen.bearing_rad == pytest.approx(bearing, abs=1e-6)
        assert seen.distance_m == pytest.approx(distance - 0.1)
    elif abs(bearing) > math.pi / 4 + 0.1 / distance + 1e-3:
        assert view.sightings == ()


@settings(deadline=None, max_examples=50)
@given(st.floats(2, 25), st.floats(1.2, 2.4))
def test_farther_is_smaller(distance, times):
    near, far = (look(("kiosk", 0, d)).sightings[0] for d in (distance, times * distance))
    assert far.width_px < near.width_px
    assert far.height_px <= near.height_px


@settings(deadline=None, max_examples=300)
@given(st.floats(-500, 500), st.floats(-500, 500), st.floats(0, 6.28))
def test_a_view_reaches_into_cells_of_the_grid_only(x, y, heading):
    columns, rows = 3, 2
    header = np.array([-20.0, -10.0, 12.0, columns, rows])
    first_column, last_column, first_row, last_row = _window(header, x, y, heading, math.pi / 4, 60.0)
    for row in range(first_row, last_row + 1):
        assert 0 <= row < rows
        assert 0 <= first_column <= last_column < columns


@pytest.mark.parametrize("heading", np.linspace(0.0, 2.0 * math.pi, 8, endpoint=False))
@pytest.mark.parametrize(("x", "y"), [(95, 0), (-95, 0), (0, 95), (0, -95), (95, 95), (-95, -95)])
def test_looking_from_outside_of_all_that_stands_reads_nothing_that_is_not_there(x, y, heading, monkeypatch):
    # As plain Python, where an index that is out of range is an error.
    monkeypatch.setattr("reasoned_explorer.simulation.eyes_kernels.in_view", in_view.py_func)
    monkeypatch.setattr("reasoned_explorer.simulation.eyes_kernels.see_objects", see_objects.py_func)
    view = look(("bench", -2, 0), ("bench", 2, 0), x=x, y=y, heading=heading, max_range_m=60.0)
    assert view.sightings == ()


def test_what_stands_alone_is_seen_from_afar():
    for way in np.linspace(0.0, 2.0 * math.pi, 24, endpoint=False):
        x, y = -40.0 * math.sin(way), -40.0 * math.cos(way)
        assert [s.class_name for s in look(("kiosk", 0, 0), x=x, y=y, heading=way).sightings] == ["kiosk"]


def test_sizes_stay_in_the_picture():
    view = look(("kiosk", 0, 4.0), ("lawn", 0, 0, {"outline": box(0, 0, 50, 50)}), ("tree", 1, 1))
    assert len(view.sightings) == 3
    for seen in view.sightings:
        assert 0 < seen.width_px <= 224.0001
        assert 0 < seen.height_px <= 224.0001
        assert abs(seen.bearing_rad) <= math.pi / 4


def test_nearest_first_and_nothing_beyond_the_range():
    view = look(*[("car", 0.0, float(y), {"heading_rad": EAST}) for y in (50, 30, 90, 10)])
    assert view.sightings[0].object_id == 3
    assert 2 not in [seen.object_id for seen in view.sightings]


def test_specks_are_dropped():
    assert look(("bollard", 0, 58)).sightings == ()
    assert len(look(("bollard", 0, 58), min_px=0.0).sightings) == 1


def test_a_house_hides_and_half_hides():
    house = Building(box(0, 12, 12, 4), height_m=9.0)
    assert look(("bench", 0, 20), buildings=[house]).sightings == ()
    (seen,) = look(("fountain", 0, 20), buildings=[Building(box(-10, 12, 20, 4), height_m=9.0)]).sightings
    assert 0.2 < seen.visible_share < 0.8


def test_a_kiosk_hides_a_bin_behind_it():
    assert [s.class_name for s in look(("waste_basket", 0, 12), ("kiosk", 0, 8)).sightings] == ["kiosk"]


def test_a_place_shows_its_front_only():
    house = Building(box(0, 15, 10, 10), height_m=9.0)
    cafe = ("cafe", 0.0, 10.0, {"building": 0, "heading_rad": SOUTH, "attributes": {"name": "Blau"}})
    (seen,) = look(cafe, buildings=[house]).sightings
    assert (seen.name, seen.distance_m) == ("Blau", pytest.approx(9.9))
    assert look(cafe, buildings=[house], y=40, heading=SOUTH).sightings == ()


def test_areas_are_seen_from_within_and_from_without():
    lawn = ("lawn", 0, 30, {"outline": box(0, 30, 30, 20)})
    outside, inside = look(lawn).sightings[0], look(lawn, y=30).sightings[0]
    assert outside.distance_m == pytest.approx(20.0)
    assert (inside.distance_m, inside.width_px) == (0.0, pytest.approx(224.0))
    assert look(lawn, heading=SOUTH).sightings == ()


def test_a_large_area_is_listed_once():
    lawn = ("lawn", 0, 30, {"outline": box(0, 0, 150, 150)})
    for heading in np.linspace(0, 6, 13):
        assert len(look(lawn, heading=float(heading)).sightings) == 1


def test_under_a_tree():
    view = look(("bench", 0, 10), ("tree", 1, 10.5), ("bench", 8, 10))
    assert {s.object_id: s.under for s in view.sightings} == {0: "tree", 1: None, 2: None}
    assert look(("flagpole", 0, 10), ("tree", 1, 10, {"size_m": (6, 6, 5)})).sightings[0].under is None


def test_ground_ahead_and_to_the_sides():
    regions = [
        Region(Ground.PAVEMENT, box(0, 0, 200, 200)),
        Region(Ground.GRASS, box(-50, 0, 98, 200)),
        Region(Ground.WATER, box(0, 20, 200, 10)),
    ]
    left, ahead, right = look(regions=regions).stretches
    assert (ahead.near, ahead.middle, ahead.far) == (Ground.PAVEMENT, Ground.PAVEMENT, Ground.WATER)
    assert (left.middle, right.middle) == (Ground.GRASS, Ground.PAVEMENT)
    assert (ahead.free_m, ahead.ends_at) == (60.0, "")


def test_walls_end_the_ground():
    view = look(buildings=[Building(box(0, 15, 100, 20), height_m=9.0, kind="church")])
    ahead = view.stretches[1]
    assert (ahead.near, ahead.middle) == (Ground.UNKNOWN, Ground.BUILDING)
    assert (ahead.free_m, ahead.ends_at) == (pytest.approx(5.0), "building")
    assert view.building_share == 1.0
    assert view.nearest_building_m == pytest.approx(5.0)
    assert view.building_kinds == ("church",)


def test_what_stands_in_the_way_depends_on_the_height():
    assert look(("bench", 0, 5), z=0.4).stretches[1].ends_at == "bench"
    assert look(("bench", 0, 5), z=1.5).stretches[1].ends_at == ""


def test_an_empty_world():
    view = look()
    assert (view.sightings, view.building_share, view.nearest_building_m) == ((), 0.0, math.inf)


def test_the_order_of_the_worlds_objects_changes_nothing():
    things = [("bench", -3, 12), ("tree", 4, 18), ("car", 0, 25)]
    forth, back = look(*things), look(*reversed(things))
    strip = [[seen[1:] for seen in view.sightings] for view in (forth, back)]
    assert strip[0] == strip[1]


def test_settings_out_of_range_are_refused_together():
    with pytest.raises(SettingsError) as error:
        eyes_on(max_range_m=math.nan, min_px=-1.0)
    assert len(error.value.faults) == 2


@pytest.mark.parametrize(("x", "y", "heading"), [(90, 0, EAST), (-90, 0, -EAST), (0, 90, NORTH), (0, -90, SOUTH)])
def test_who_looks_away_from_all_there_is_sees_nothing(x, y, heading, monkeypatch):
    # As plain Python, which refuses what compiled code reads from beyond the grid.
    monkeypatch.setattr(eyes_kernels, "in_view", eyes_kernels.in_view.py_func)
    monkeypatch.setattr(eyes_kernels, "see_objects", eyes_kernels.see_objects.py_func)
    assert look(("bench", 0, 0), ("bench", 5, 5), x=x, y=y, heading=heading).sightings == ()
