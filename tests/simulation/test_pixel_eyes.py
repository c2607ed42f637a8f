"""What has pixels is seen: counted in depth and ids of a view, in small worlds whose answer one knows."""

import math
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Camera, SettingsError
from reasoned_explorer.simulation.eyes import Eyes
from reasoned_explorer.simulation.painter import Painter
from reasoned_explorer.simulation.pixel_eyes import PixelEyes
from reasoned_explorer.simulation.renderers import renderer_of
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.opening import open_world
from reasoned_explorer.world.taxonomy import OBJECT_CLASSES, Ground
from reasoned_explorer.world.world import Bounds, Building, Region, World, WorldObject

CAMERA = Camera()
NORTH, EAST, SOUTH = 0.0, math.pi / 2, math.pi
FREE_STANDING = ("bench", "fire_hydrant", "kiosk", "person", "car", "post_box", "telephone", "shrub", "monument")


def box(x, y, width, depth):
    return np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], float) * (width / 2, depth / 2) + (x, y)


def eyes_on(*objects, buildings=(), regions=(), kind=PixelEyes, **options):
    placed = []
    for place, (name, x, y, *more) in enumerate(objects):
        fields = {"size_m": OBJECT_CLASSES[name].size_m, **(more[0] if more else {})}
        placed.append(WorldObject(place, name, x, y, **fields))
    world = World("test", Bounds(-100, -100, 100, 100), tuple(regions), (), tuple(buildings), tuple(placed))
    return kind(Atlas(world), **options)


def look(*objects, x=0.0, y=0.0, z=1.5, heading=NORTH, **world):
    return eyes_on(*objects, **world).look(Pose(x, y, z, heading), CAMERA)


def pixels(*objects, x=0.0, y=0.0, z=1.5, heading=NORTH, **world):
    return eyes_on(*objects, **world).pixels(Pose(x, y, z, heading), CAMERA)


def test_a_hydrant_at_fifteen_metres():
    (seen,) = look(("fire_hydrant", 0, 15.175)).sightings
    assert (seen.class_name, seen.distance_m, seen.visible_share) == ("fire_hydrant", pytest.approx(15.0, abs=0.2), 1.0)
    assert (seen.width_px, seen.height_px) == (pytest.approx(2.6, abs=0.1), pytest.approx(6.0, abs=0.1))
    assert seen.bearing_rad == pytest.approx(0.0, abs=0.01)


def poses_in(atlas, count, seed=5):
    draw = np.random.default_rng(seed)
    found = []
    while len(found) < count:
        x, y = draw.uniform(-90, 90, 2)
        if atlas.ground.at(float(x), float(y)) != Ground.BUILDING:
            found.append(Pose(float(x), float(y), 1.5, float(draw.uniform(0, 2 * math.pi))))
    return found


def test_what_is_seen_is_what_has_pixels_in_the_cameras_own_picture():
    # That picture has four times as many pixels as the one that is drawn.
    atlas = Atlas(open_world("downtown:3@200"))
    eyes, first = PixelEyes(atlas), 2 + len(atlas.world.buildings)
    ratios, few, none = [], [], 0
    for pose in poses_in(atlas, 60):
        told, picture = eyes.pixels(pose, CAMERA), renderer_of(atlas).ids(pose, CAMERA)
        true = np.bincount(picture.instances.ravel(), minlength=first + len(atlas.world.objects))[first:]
        for item in atlas.world.objects:
            near = math.hypot(item.x_m - pose.x_m, item.y_m - pose.y_m) < 50.0
            if item.object_class.kind in {"area", "place"} or not near:  # places show their front only
                continue
            if true[item.id] >= 10:
                ratios.append(told.get(item.id, 0.0) / true[item.id])
            elif true[item.id] >= 3:
                few.append(item.id in told)
            none += true[item.id] == 0 and told.get(item.id, 0.0) > 3.0
    assert len(ratios) > 150
    assert np.mean(np.array(ratios) > 0.0) > 0.98
    assert np.median(ratios) == pytest.approx(1.0, abs=0.05)
    assert np.mean(few) > 0.9
    assert none <= 0.02 * len(ratios)


@settings(deadline=None, max_examples=25)
@given(st.sampled_from(FREE_STANDING), st.floats(4, 30), st.floats(0.5, 0.9))
def test_nearer_is_never_much_smaller(name, distance, times):
    far, near = (pixels((name, 0, d)).get(0, 0.0) for d in (distance, times * distance))
    assert near >= 0.8 * far - 6


@settings(deadline=None, max_examples=25)
@given(st.sampled_from(FREE_STANDING), st.floats(-4, 4), st.floats(13, 40))
def test_behind_a_wall_nothing_has_pixels(name, aside, distance):
    wall = Building(box(0, 10, 60, 2), height_m=12.0)
    view = look((name, aside, distance), buildings=[wall])
    assert view.sightings == ()
    assert view.stretches[1].ends_at == "building"


@settings(deadline=None, max_examples=15)
@given(st.floats(-6.28, 6.28), st.floats(-math.pi, math.pi), st.floats(5, 40))
def test_in_view_is_what_lies_within_the_field_of_view(heading, bearing, distance):
    way = heading + bearing
    seen = pixels(("kiosk", distance * math.sin(way), distance * math.cos(way)), heading=heading)
    if abs(bearing) < math.pi / 4:
        assert seen
    elif abs(bearing) > math.pi / 4 + 2.5 / distance:
        assert not seen


def test_left_is_negative_and_right_is_positive():
    view = look(("bench", -5, 10), ("bench", 5, 10))
    assert sorted((s.object_id, s.bearing_rad < 0) for s in view.sightings) == [(0, True), (1, False)]
    east = look(("bench", 10, 5), ("bench", 10, -5), heading=EAST)
    assert sorted((s.object_id, s.bearing_rad < 0) for s in east.sightings) == [(0, True), (1, False)]


def test_nearest_first_and_nothing_beyond_the_range():
    view = look(*[("monument", 4.0 * k - 6.0, float(y)) for k, y in enumerate((50, 30, 90, 10))])
    assert [seen.object_id for seen in view.sightings] == [3, 1, 0]


def test_a_small_thing_is_hidden_by_what_is_nearer_and_not_by_what_is_behind_it():
    assert [s.class_name for s in look(("waste_basket", 0, 12), ("kiosk", 0, 8)).sightings] == ["kiosk"]
    assert {s.class_name for s in look(("waste_basket", 0, 25), ("kiosk", 0, 30)).sightings} == {
        "waste_basket",
        "kiosk",
    }


def test_a_house_half_hides():
    (seen,) = look(("fountain", 0, 20), buildings=[Building(box(-10, 12, 20, 4), height_m=9.0)]).sightings
    assert 0.3 < seen.visible_share < 0.7
    assert seen.bearing_rad > 0.02  # of what is seen of it


def test_a_place_shows_its_front_only():
    house = Building(box(0, 15, 10, 10), height_m=9.0)
    cafe = ("cafe", 0.0, 10.0, {"building": 0, "heading_rad": SOUTH, "attributes": {"name": "Blau"}})
    (seen,) = look(cafe, buildings=[house]).sightings
    assert seen.name == "Blau"
    assert 8.0 < seen.distance_m < 10.0  # its awning is before the wall
    assert look(cafe, buildings=[house], y=40, heading=SOUTH).sightings == ()


def test_areas_are_the_ground_inside_their_outline():
    lawn = ("lawn", 0, 30, {"outline": box(0, 30, 30, 20)})
    outside, inside = look(lawn).sightings[0], look(lawn, y=30).sightings[0]
    assert outside.distance_m == pytest.approx(20.0, abs=1.5)
    assert (outside.visible_share, inside.visible_share) == (1.0, 1.0)
    assert (inside.distance_m, inside.width_px) == (0.0, pytest.approx(224.0))
    assert look(lawn, heading=SOUTH).sightings == ()


def test_of_an_area_behind_a_wall_only_the_open_half_is_seen():
    lawn = ("lawn", 0, 30, {"outline": box(0, 30, 30, 20)})
    (seen,) = look(lawn, buildings=[Building(box(-20, 12, 40, 2), height_m=9.0)]).sightings
    assert 0.4 < seen.visible_share < 0.6
    assert look(lawn, buildings=[Building(box(0, 12, 60, 2), height_m=9.0)]).sightings == ()


def test_an_area_has_the_pixels_that_it_covers():
    square = ("lawn", 0, 10, {"outline": box(0, 10, 10, 10)})
    focal, height = 112.0, 1.5
    # The trapezium between the rows at 15 and 5 m: the integral of its width over its rows.
    low, high = focal * height / 15.0, focal * height / 5.0
    expected = 10.0 / height * (high**2 - low**2) / 2.0
    assert pixels(square)[0] == pytest.approx(expected, rel=0.05)


def test_under_a_tree():
    view = look(("bench", 0, 10), ("tree", 1, 10.5), ("bench", 8, 10))
    assert {s.object_id: s.under for s in view.sightings} == {0: "tree", 1: None, 2: None}


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


def test_ground_behind_a_thing_is_not_known_but_the_ground_before_it():
    regions = [Region(Ground.PAVEMENT, box(0, 0, 200, 200)), Region(Ground.WATER, box(0, 20, 200, 12))]
    seen = look(("kiosk", 0, 8, {"size_m": (9.0, 2.5, 2.8)}), regions=regions).stretches[1]
    assert (seen.far, seen.ends_at) == (Ground.PAVEMENT, "kiosk")


def test_walls_end_the_ground():
    view = look(buildings=[Building(box(0, 15, 100, 20), height_m=9.0, kind="church")])
    ahead = view.stretches[1]
    assert (ahead.near, ahead.middle) == (Ground.UNKNOWN, Ground.BUILDING)
    assert (ahead.free_m, ahead.ends_at) == (pytest.approx(5.0, abs=0.4), "building")
    assert view.building_share == 1.0
    assert view.nearest_building_m == pytest.approx(5.0, abs=0.6)
    assert view.building_kinds == ("church",)


def test_what_stands_in_the_way_depends_on_the_height():
    assert look(("bench", 0, 5), z=0.4).stretches[1].ends_at == "bench"
    assert look(("bench", 0, 5), z=1.5).stretches[1].ends_at == ""


def test_an_empty_world():
    view = look()
    assert (view.sightings, view.building_share, view.nearest_building_m) == ((), 0.0, math.inf)


def test_sizes_stay_in_the_picture():
    view = look(("kiosk", 0, 4.0), ("lawn", 0, 0, {"outline": box(0, 0, 50, 50)}), ("tree", 1, 3))
    assert len(view.sightings) >= 2
    for seen in view.sightings:
        assert 0 < seen.width_px <= 224.0001
        assert 0 < seen.height_px <= 224.0001
        assert 0 < seen.visible_share <= 1.0
        assert abs(seen.bearing_rad) <= math.pi / 4


@pytest.mark.parametrize(("objects", "expected_m"), [((("kiosk", 0, 8.0),), 6.75), ((("kiosk", 3, 8.0),), 60.0)])
def test_the_range_ahead_is_that_of_the_bodys_corridor(objects, expected_m):
    eyes = eyes_on(*objects)
    assert eyes.range_ahead_m(Pose(0, 0, 1.5, NORTH)) == pytest.approx(expected_m, abs=0.4)


def test_the_range_ahead_leaves_out_what_is_passed_under_or_over():
    crown = eyes_on(("tree", 0, 12.0, {"size_m": (6.0, 6.0, 14.0)}))
    assert crown.range_ahead_m(Pose(3.0, 0, 1.5, NORTH), half_width_m=0.3) == 60.0  # beside the trunk, under the crown
    bench = eyes_on(("bench", 0, 6.0))
    here = Pose(0, 0, 1.5, NORTH)
    assert bench.range_ahead_m(here) == pytest.approx(5.7, abs=0.4)
    assert bench.range_ahead_m(here, lowest_m=1.0, max_range_m=20.0) == 20.0


def test_the_range_ahead_meets_walls_and_not_the_ground():
    eyes = eyes_on(buildings=[Building(box(0, 15, 100, 20), height_m=9.0)])
    assert eyes.range_ahead_m(Pose(0, 0, 1.5, NORTH)) == pytest.approx(5.0, abs=0.6)
    assert eyes.range_ahead_m(Pose(0, 0, 1.5, SOUTH)) == 60.0


def test_it_agrees_with_sight_lines_about_a_world():
    atlas = Atlas(open_world("park:3@200"))
    lines, seeing = Eyes(atlas), PixelEyes(atlas)
    both = either = 0
    for pose in poses_in(atlas, 40):
        one, other = ({s.object_id for s in eyes.look(pose, CAMERA).sightings} for eyes in (lines, seeing))
        both, either = both + len(one & other), either + len(one | other)
    assert both > 0.75 * either


def test_the_scene_is_shared_with_those_who_take_pictures():
    atlas = Atlas(open_world("park:3@200"))
    eyes = PixelEyes(atlas)
    Painter(atlas, side_px=32, conditions="dusk").paint(Pose(0, 0, 1.5, 0), CAMERA)
    assert renderer_of(atlas, "dusk").scene is eyes._renderer.scene


def views(eyes, order):
    poses = [Pose(7.0 * k - 60.0, 5.0 * k - 40.0, 1.5, 0.7 * k) for k in range(16)]
    found = {k: repr(eyes.look(poses[k], CAMERA if k % 3 else Camera(128, 96))) for k in order}
    return "\n".join(found[k] for k in range(16))


def test_the_same_view_whatever_was_seen_before_and_in_every_thread():
    eyes = PixelEyes(Atlas(open_world("downtown:3@200")))
    forth = views(eyes, range(16))
    assert views(eyes, reversed(range(16))) == forth
    with ThreadPoolExecutor(3) as pool:
        assert set(pool.map(lambda _: views(eyes, range(16)), range(3))) == {forth}


def test_the_same_view_in_another_process():
    code = (
        "from tests.simulation.test_pixel_eyes import *\n"
        "print(views(PixelEyes(Atlas(open_world('downtown:3@200'))), range(16)))"
    )
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.strip()
    assert told == views(PixelEyes(Atlas(open_world("downtown:3@200"))), range(16))


def test_settings_out_of_range_are_refused_together():
    with pytest.raises(SettingsError) as error:
        eyes_on(max_range_m=math.nan, min_px=-1.0, coarseness=0.5)
    assert len(error.value.faults) == 3
