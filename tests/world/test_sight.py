"""Sight lines, checked against brute force with shapely."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from reasoned_explorer.model import WorldError
from reasoned_explorer.world.sight import HitKind, SightLines
from reasoned_explorer.world.taxonomy import OBJECT_CLASSES
from reasoned_explorer.world.world import Bounds, Building, World, WorldObject


def box(x, y, width, depth, *, turn=0.0):
    corners = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], float) * (width / 2, depth / 2)
    c, s = math.cos(turn), math.sin(turn)
    return corners @ np.array([[c, s], [-s, c]]) + (x, y)


def make_world(objects=(), buildings=()):
    """Objects are (class, x, y) or (class, x, y, {further fields})."""
    placed = []
    for place, (name, x, y, *more) in enumerate(objects):
        fields = {"size_m": OBJECT_CLASSES[name].size_m, **(more[0] if more else {})}
        placed.append(WorldObject(place, name, x, y, **fields))
    return World("test", Bounds(-200, -200, 200, 200), (), (), tuple(buildings), tuple(placed))


def seen_from(x, y, *objects, buildings=(), z=1.5):
    return SightLines.of(make_world(objects, buildings)).visible_share(x, y, z, 0)


def random_city(seed, count=25):
    draw = np.random.Generator(np.random.PCG64(seed))
    return [
        Building(
            box(*draw.uniform(-80, 80, 2), *draw.uniform(2, 25, 2), turn=draw.uniform(0, 3)),
            height_m=draw.uniform(2, 15),
            min_height_m=float(draw.choice([0.0, 0.0, 3.0])) if place % 3 else 0.0,
        )
        for place in range(count)
    ]


def crossings(buildings, x0, y0, x1, y1):
    """Of a ray with all walls: (share of the way, building), nearest first."""
    found = []
    for place, building in enumerate(buildings):
        ring = building.outer
        for a, b in zip(ring, np.roll(ring, -1, axis=0), strict=True):
            cut = shapely.LineString([(x0, y0), (x1, y1)]).intersection(shapely.LineString([a, b]))
            if not cut.is_empty:
                t = math.hypot(cut.x - x0, cut.y - y0) / math.hypot(x1 - x0, y1 - y0)
                found.append((t, place))
    return sorted(found)


points = st.tuples(st.floats(-110, 110), st.floats(-110, 110))


@settings(deadline=None, max_examples=100)
@given(st.integers(0, 5), points, points, st.floats(0.2, 12), st.floats(0.2, 12))
def test_clear_agrees_with_brute_force(seed, a, b, z0, z1):
    buildings = random_city(seed)
    sight = SightLines.of(make_world(buildings=buildings))
    length = math.dist(a, b)
    blocked, close_call = False, length < 0.3
    for t, place in crossings(buildings, *a, *b) if length > 0.3 else ():
        z = z0 + t * (z1 - z0)
        band = buildings[place]
        close_call |= min(abs(z - band.min_height_m), abs(z - band.height_m), abs((1 - t) * length - 0.25)) < 1e-6
        blocked |= band.min_height_m <= z <= band.height_m and (1 - t) * length > 0.25
    if not close_call:
        assert sight.clear(*a, z0, *b, z1) is not blocked


@settings(deadline=None, max_examples=100)
@given(st.integers(0, 5), points, st.floats(0, 6.2), st.floats(5, 150))
def test_cast_agrees_with_brute_force(seed, start, heading, reach):
    buildings = random_city(seed)
    end = start[0] + reach * math.sin(heading), start[1] + reach * math.cos(heading)
    standing = [(t, p) for t, p in crossings(buildings, *start, *end) if buildings[p].min_height_m <= 1.5]
    distance, kind, place = SightLines.of(make_world(buildings=buildings)).cast(*start, 1.5, heading, reach)
    if standing:
        assert distance == pytest.approx(standing[0][0] * reach, abs=1e-6)
        assert (kind, place) == (HitKind.BUILDING, standing[0][1])
    else:
        assert (distance, kind, place) == (reach, HitKind.NOTHING, -1)


@settings(deadline=None, max_examples=60)
@given(points, points, st.floats(0.1, 3), st.floats(0.01, 5))
def test_obstacles_near_are_those_of_the_rectangle(a, b, z, margin):
    buildings = random_city(1)
    objects = [("bollard", x, y) for x in range(-90, 91, 30) for y in range(-90, 91, 30)]
    near = SightLines.of(make_world(objects, buildings)).obstacles_near(*a, *b, z_m=z, margin_m=margin)
    rectangle = shapely.box(*(np.minimum(a, b) - margin), *(np.maximum(a, b) + margin))
    expected = [
        place
        for place, building in enumerate(buildings)
        for wall in zip(building.outer, np.roll(building.outer, -1, axis=0), strict=True)
        if building.min_height_m <= z <= building.height_m and shapely.LineString(wall).intersects(rectangle)
    ]
    assert sorted(near.wall_building) == expected
    discs = [shapely.Point(x, y).buffer(0.1, quad_segs=64).intersects(rectangle) for _, x, y in objects]
    assert list(near.disc_object) == ([k for k, inside in enumerate(discs) if inside] if z <= 0.9 else [])


def test_a_wall_hides_and_a_gap_does_not():
    wall = Building(box(0, 10, 20, 1), height_m=8.0)
    assert seen_from(0, 0, ("bench", 0, 20), buildings=[wall]) == 0.0
    assert seen_from(30, 0, ("bench", 40, 20), buildings=[wall]) == 1.0


def test_half_hidden_by_a_corner():
    wall = Building(box(-50, 5, 100, 0.2), height_m=8.0)
    assert 0.2 <= seen_from(0, 0, ("fountain", 0, 10), buildings=[wall]) <= 0.8


def test_a_tall_lamp_is_seen_over_a_low_wall():
    low = Building(box(0, 10, 20, 1), height_m=2.0)
    assert 0.0 < seen_from(0, 0, ("street_lamp", 0, 20), buildings=[low]) < 1.0


def test_one_sees_under_a_roof_on_posts():
    roof = Building(box(0, 10, 20, 4), height_m=5.0, min_height_m=3.0, kind="roof")
    assert seen_from(0, 0, ("bench", 0, 20), buildings=[roof]) == 1.0


def test_crowns_hide_partly_and_only_at_their_height():
    tree = ("tree", 0, 10, {"size_m": (6.0, 6.0, 4.0)})
    assert 0.2 < seen_from(0, 0, ("flagpole", 0, 20), tree) < 1.0
    assert seen_from(2, 0, ("bench", 2, 20), ("tree", 2.0, 10)) >= 0.3  # between the trunk and its edges
    assert SightLines.of(make_world([("flagpole", 0, 20), tree])).clear(0, 0, 1.5, 0, 20, 3.0)


def test_a_large_thing_blocks_and_ignores_itself():
    sight = SightLines.of(make_world([("kiosk", 0, 10), ("bench", 0, 20)]))
    assert not sight.clear(0, 0, 1.5, 0, 20, 0.5)
    assert not sight.clear(0, 0, 1.5, 0, 10, 1.0)
    assert sight.clear(0, 0, 1.5, 0, 10, 1.0, ignore_object=0)
    assert sight.clear(0, 0, 1.5, 0, 9, 1.0) == (9 < 10 - 1.375 + 0.25)


def test_a_place_is_seen_from_its_front_only():
    house = Building(box(0, 10, 10, 10), height_m=9.0)
    cafe = ("cafe", 0.0, 5.0, {"building": 0, "heading_rad": math.pi})
    assert seen_from(0, -10, cafe, buildings=[house]) == 1.0
    assert seen_from(0, 30, cafe, buildings=[house]) == 0.0
    assert seen_from(-20, 10, cafe, buildings=[house]) == 0.0


@settings(deadline=None, max_examples=30)
@given(st.floats(0, 6.28))
def test_a_place_faces_outwards_whatever_its_heading_says(heading):
    house = Building(box(0, 10, 10, 10), height_m=9.0)
    cafe = ("cafe", 0.0, 5.1, {"building": 0, "heading_rad": heading})
    assert seen_from(0, -10, cafe, buildings=[house]) == 1.0


def test_a_place_in_a_courtyard_faces_the_courtyard():
    house = Building(box(0, 0, 40, 40), height_m=9.0, holes=(box(0, 0, 20, 20),))
    cafe = ("cafe", 0.0, 10.0, {"building": 0})
    assert seen_from(0, 0, cafe, buildings=[house]) == 1.0
    assert seen_from(0, 40, cafe, buildings=[house]) == 0.0


def test_areas_are_seen_by_their_outline():
    lawn = ("lawn", 0.0, 30.0, {"outline": box(0, 30, 30, 20)})
    assert seen_from(0, 0, lawn) == 1.0
    assert seen_from(0, 30, lawn) == 1.0
    half = Building(box(-25, 15, 50, 1), height_m=9.0)
    assert 0.2 < seen_from(0, 0, lawn, buildings=[half]) < 0.8


def test_what_is_solid():
    world = make_world(
        [
            ("bench", 0, 5),
            ("fire_hydrant", 10, 5),
            ("tree", 20, 5),
            ("cafe", 30, 5),
            ("lawn", 40, 5),
            ("fountain", 50, 5, {"outline": box(50, 5, 6, 2)}),
        ]
    )
    sight = SightLines.of(world)
    low = sight.obstacles_near(0, 5, 60, 5, z_m=0.3, margin_m=1.0)
    assert sorted(set(low.wall_object)) == [0, 5]
    assert set(low.wall_building) == {-1}
    assert list(low.disc_object) == [1, 2]
    assert low.discs[1] == pytest.approx([20, 5, 0.3])
    high = sight.obstacles_near(0, 5, 60, 5, z_m=1.5, margin_m=1.0)
    assert (sorted(set(high.wall_object)), list(high.disc_object)) == ([5], [2])
    assert sight.cast(-10, 5, 0.3, math.pi / 2, 60) == (pytest.approx(9.1), HitKind.OBJECT, 0)
    assert sight.cast(-10, 5, 1.5, math.pi / 2, 60)[1:] == (HitKind.OBJECT, 2)
    assert sight.cast(20, 5, 1.5, 0.0, 60)[0] == 0.0


def test_a_ray_from_far_outside_the_grid():
    sight = SightLines.of(make_world(buildings=[Building(box(0, 0, 10, 10), height_m=5.0)]))
    assert sight.cast(-5000, 0, 1, math.pi / 2, 10_000)[0] == pytest.approx(4995)
    assert sight.cast(-5000, 100, 1, math.pi / 2, 10_000)[0] == 10_000
    assert not sight.clear(-5000, 0, 1, 5000, 0, 1)


def test_an_empty_world():
    sight = SightLines.of(make_world())
    assert sight.clear(0, 0, 1, 50, 50, 1)
    assert sight.cast(0, 0, 1, 1.0, 30) == (30.0, HitKind.NOTHING, -1)
    assert len(sight.obstacles_near(0, 0, 9, 9, z_m=1, margin_m=2).walls) == 0
    with pytest.raises(IndexError):
        sight.visible_share(0, 0, 1, 0)


def test_all_numbers_that_are_none_are_named():
    bad = [("bench", math.nan, 0), ("tree", 0, 0, {"size_m": (1, 1, math.inf)}), ("bollard", 3, 3)]
    with pytest.raises(WorldError) as error:
        SightLines.of(make_world(bad, [Building(box(0, 0, 9, 9), height_m=math.nan)]))
    assert [fault.what.split(" (")[0] for fault in error.value.faults] == [
        "building 0 has a coordinate or height that is no number",
        "object 0",
        "object 1",
    ]
