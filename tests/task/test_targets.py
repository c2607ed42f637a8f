import math

import numpy as np
import pytest

from reasoned_explorer.task.reading import read_goal
from reasoned_explorer.task.targets import Grader, footprint_of
from reasoned_explorer.world.taxonomy import Ground
from reasoned_explorer.world.world import WorldObject
from tests.task.scenes import box, house, passing, patch, world_of

LAWN = {"outline": box(10.0, 10.0, 40.0, 40.0)}


def test_near_is_measured_between_footprints():
    # A bench is 1.8 m across its front, a trash can 0.5 m: from centre to centre 6.1 m are 4.95 m between them.
    atlas = world_of(("bench", 50, 50), ("waste_basket", 56.1, 50), ("bench", 20, 20), ("waste_basket", 26.2, 20))
    assert passing(atlas, "a bench near a trash can") == [0]
    assert passing(atlas, "a bench without a trash can nearby") == [2]


def test_under_a_tree_is_within_its_crown():
    atlas = world_of(("tree", 50, 50), ("bench", 52.9, 50), ("bench", 50, 53.1))
    assert passing(atlas, "a bench under a tree") == [1]
    assert passing(atlas, "a bench near a tree") == [1, 2]


def test_under_a_roof_is_under_a_building_that_one_can_walk_under():
    roofs = [house(40, 40, 60, 60, min_height_m=3.0), house(70, 70, 90, 90)]
    atlas = world_of(("bench", 50, 50), ("bench", 20, 20), ("shelter", 20, 20), ("bench", 30, 80), buildings=roofs)
    assert passing(atlas, "a bench under a roof") == [0, 1]


def test_a_thing_is_not_near_itself():
    atlas = world_of(("tree", 20, 20), ("tree", 60, 60), ("tree", 61, 66))
    assert passing(atlas, "a tree near a tree") == [1, 2]


def test_on_ground_is_where_its_middle_stands():
    atlas = world_of(("bench", 20, 20), ("bench", 70, 70), regions=[patch(Ground.GRASS, 10, 10, 30, 30)])
    assert passing(atlas, "a bench on the grass") == [0]
    assert passing(atlas, "a bench not on the grass") == [1]


def test_in_an_area_is_touching_it():
    atlas = world_of(("lawn", 25, 25, LAWN), ("bench", 20, 20), ("bench", 60, 60), ("bench", 39, 42))
    assert passing(atlas, "a bench in a garden") == [1]


def test_near_ground_reaches_as_far_as_it_says():
    road = patch(Ground.ROAD, 0, 0, 100, 10)
    # Benches are 0.6 m deep: 24.0 m north of the road's edge less 0.3 m, and 15.5 m less 0.3 m.
    atlas = world_of(("bench", 50, 34.0), ("bench", 50, 25.5), ("bench", 50, 24.0), regions=[road])
    assert passing(atlas, "a quiet bench") == [0, 1]
    assert passing(atlas, "a bench within 20 m of the road") == [1, 2]


def test_near_a_building():
    atlas = world_of(("bench", 20, 16), ("bench", 20, 40), buildings=[house(10, 0, 30, 12)])
    assert passing(atlas, "a bench next to a wall") == [0]


def test_at_a_cafe_is_beside_its_entrance():
    atlas = world_of(("cafe", 20, 12), ("bench", 22, 15), ("bench", 60, 60), buildings=[house(10, 0, 30, 12)])
    assert passing(atlas, "a bench at a cafe") == [1]


def test_a_lawn_satisfies_only_where_it_is_shady():
    atlas = world_of(("lawn", 25, 25, LAWN), ("tree", 15, 15))
    (target,) = Grader(atlas).grade(read_goal("somewhere to have a picnic"))
    assert (target.object_id, target.grade) == (0, 2)
    assert target.distance_m(15, 15) == 0.0
    # The far corner of the lawn is 35.4 m from the tree, whose crown reaches 3 m.
    assert target.distance_m(40, 40) == pytest.approx(math.hypot(25, 25) - 3.0, abs=1.5)


def test_a_lawn_without_a_tree_is_grade_1_and_does_not_pass():
    atlas = world_of(("lawn", 25, 25, LAWN))
    assert [t.grade for t in Grader(atlas).grade(read_goal("somewhere to have a picnic"))] == [1]
    assert passing(atlas, "somewhere to have a picnic") == []


def test_the_highest_grade_counts_whatever_the_order():
    atlas = world_of(("lawn", 25, 25, LAWN), ("tree", 25, 25))
    spec = read_goal("somewhere to have a picnic")
    for sought in (spec.sought, spec.sought[::-1]):
        changed = type(spec)(spec.text, spec.level, sought)
        assert [t.grade for t in Grader(atlas).grade(changed)] == [2]


def test_attributes_are_asked_of_the_world():
    atlas = world_of(("bench", 10, 10, {"attributes": {"backrest": "yes"}}), ("bench", 50, 50))
    assert passing(atlas, "a bench with a backrest") == [0]


def test_a_world_without_things_satisfies_nothing():
    assert passing(world_of(), "somewhere to take a nap") == []


def test_a_footprint_turns_with_its_heading():
    # Facing east, a bench lies along north-south.
    west, south, east, north = footprint_of(WorldObject(0, "bench", 0, 0, math.pi / 2, (1.8, 0.6, 0.8))).bounds
    assert np.allclose((west, south, east, north), (-0.3, -0.9, 0.3, 0.9))


def test_a_footprint_agrees_with_the_index():
    atlas = world_of(("bench", 50, 50, {"heading_rad": 0.7}), ("lawn", 25, 25, LAWN), ("cafe", 70, 70))
    for item in atlas.world.objects:
        shape = footprint_of(item)
        for x, y in [(50, 53), (3, 8), (71, 64), (25, 25)]:
            from_index = atlas.index.footprint_distance_m(item.id, x, y)
            assert shape.distance(type(shape.centroid)(x, y)) == pytest.approx(from_index, abs=1e-6)
