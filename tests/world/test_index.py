"""Which objects are near, checked against looking at all of them."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from reasoned_explorer.model import InputError, UnknownNameError
from reasoned_explorer.world.index import ObjectIndex
from reasoned_explorer.world.taxonomy import CLASS_NAMES
from reasoned_explorer.world.world import Bounds, World
from tests.world.worlds import box, courtyard, thing


@pytest.fixture(scope="module")
def index():
    return ObjectIndex.of(courtyard())


def footprint(item):
    if item.object_class.kind == "place":
        return shapely.Point(item.x_m, item.y_m)
    if item.outline is not None:
        return shapely.Polygon(item.outline)
    front = np.asarray([math.sin(item.heading_rad), math.cos(item.heading_rad)])
    right = np.asarray([math.cos(item.heading_rad), -math.sin(item.heading_rad)])
    half = item.size_m[0] / 2 * right, item.size_m[1] / 2 * front
    return shapely.Polygon(
        [(item.x_m, item.y_m) + a * half[0] + b * half[1] for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    )


def test_columns(index):
    assert len(index) == 8
    assert CLASS_NAMES[index.class_code[2]] == "fire_hydrant"
    assert (index.x_m[2], index.y_m[2]) == (40.0, 42.5)
    assert index.height_m[1] == 9.0


def test_length_runs_across_the_front(index):
    # Bench 0 faces north: 1.8 m from west to east; bench 7 faces east: 1.8 m from south to north.
    assert index.footprint_distance_m(0, 51.9, 28.0) == pytest.approx(1.0)
    assert index.footprint_distance_m(0, 50.0, 29.3) == pytest.approx(1.0)
    assert index.footprint_distance_m(7, 75.0, 48.9) == pytest.approx(1.0)
    assert index.footprint_distance_m(0, 50.5, 28.1) == 0.0


def test_outlines_and_entrances(index):
    assert index.footprint_distance_m(6, 47.0, 12.0) == 0.0
    assert index.footprint_distance_m(6, 58.0, 24.0) == pytest.approx(5.0)
    assert index.footprint_distance_m(4, 30.0, 15.0) == pytest.approx(3.0)


def test_nearest(index):
    assert index.nearest(72.0, 40.0, class_names=["bench"])[0] == 7
    assert index.nearest(72.0, 40.0, class_names=["slide"]) is None
    assert index.nearest(0.0, 80.0, class_names=["bench"], max_m=20.0) is None
    assert index.nearest(1e6, 1e6, class_names=["tree"])[0] == 1
    assert index.nearest(50.0, 28.0) == (0, 0.0)


def test_of_class(index):
    assert index.of_class("bench").tolist() == [0, 7]
    assert index.of_class("slide").size == 0


def test_one_name_is_not_its_letters(index):
    assert index.within(50.0, 30.0, 100.0, class_names="bench").tolist() == [0, 7]
    assert index.within(50.0, 30.0, 100.0, class_names=()).size == 0


def test_an_empty_world_has_nothing_near():
    index = ObjectIndex.of(World("empty", Bounds(0, 0, 10, 10), (), (), (), ()))
    assert index.within(5.0, 5.0, math.inf).size == 0
    assert index.nearest(5.0, 5.0) is None


def test_bad_input(index):
    with pytest.raises(UnknownNameError, match="fountain"):
        index.within(0.0, 0.0, 1.0, class_names=["fontain"])
    with pytest.raises(InputError, match="2 faults"):
        index.within(math.nan, 0.0, -1.0)
    with pytest.raises(InputError, match="0 or more"):
        index.nearest(0.0, 0.0, max_m=math.nan)
    with pytest.raises(InputError, match="object 8"):
        index.footprint_distance_m(8, 0.0, 0.0)


@st.composite
def crowds(draw):
    spot = st.tuples(st.floats(0.0, 300.0), st.floats(0.0, 300.0))
    items = []
    for i, (x, y) in enumerate(draw(st.lists(spot, max_size=25))):
        name = draw(st.sampled_from(("bench", "tree", "car", "cafe", "pitch", "fountain")))
        more = {"heading_rad": draw(st.floats(0.0, 6.28))}
        if draw(st.booleans()):
            more["outline"] = box(x - 40.0, y - 3.0, x + 1.0, y + 70.0)
        items.append(thing(i, name, x, y, **more))
    return World("crowd", Bounds(0, 0, 300, 300), (), (), (), tuple(items))


@settings(deadline=None, max_examples=60)
@given(world=crowds(), x=st.floats(-50.0, 350.0), y=st.floats(-50.0, 350.0), radius=st.floats(0.0, 150.0))
def test_within_finds_what_looking_at_all_finds(world, x, y, radius):
    index = ObjectIndex.of(world)
    truth = [footprint(item).distance(shapely.Point(x, y)) for item in world.objects]
    for i, distance in enumerate(truth):
        assert index.footprint_distance_m(i, x, y) == pytest.approx(distance, abs=1e-9)
    ids = index.within(x, y, radius)
    assert {i for i, d in enumerate(truth) if d <= radius - 1e-9} <= set(ids.tolist())
    assert set(ids.tolist()) <= {i for i, d in enumerate(truth) if d <= radius + 1e-9}
    keys = [(math.floor(index.footprint_distance_m(i, x, y) * 1000 + 0.5), i) for i in ids.tolist()]
    assert keys == sorted(set(keys))
    cars = index.within(x, y, radius, class_names=["car", "tree"])
    assert cars.tolist() == [i for i in ids if world.objects[i].class_name in {"car", "tree"}]
    if truth:
        assert index.nearest(x, y)[1] == pytest.approx(min(truth), abs=1.1e-3)
