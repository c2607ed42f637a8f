"""What stands for each object: one model, a row, pieces with room around them, a lid in the ground."""

import math

import numpy as np
import pytest
import shapely

from reasoned_explorer.rendering.fronts import fronts_of
from reasoned_explorer.rendering.models import model_of
from reasoned_explorer.rendering.standing import Stand, stands_of
from reasoned_explorer.world.generator import generate_world
from reasoned_explorer.world.taxonomy import OBJECT_CLASSES
from reasoned_explorer.world.world import Bounds, World, WorldObject
from tests.rendering.meshes import fighting, floating, parts, welded


def stands(*things: WorldObject, seed: int = 0) -> list[Stand]:
    world = World("test", Bounds(-90, -90, 90, 90), (), (), (), things)
    return list(stands_of(world, fronts_of(world), seed=seed))


def test_most_things_are_one_model_at_their_place_and_size() -> None:
    (bench,) = stands(WorldObject(0, "bench", 3.0, 4.0, 1.0, (2.7, 0.6, 0.85)))
    assert (bench.x_m, bench.y_m, bench.heading_rad) == (3.0, 4.0, 1.0)
    assert bench.scale == pytest.approx((1.5, 1.0, 1.0))
    (car,) = stands(WorldObject(0, "car", 0.0, 0.0, 0.0, (4.4, 1.8, 1.5)))
    assert car.scale == pytest.approx((1.0, 1.0, 1.0), abs=0.05)


def test_a_long_line_of_bollards_is_many_bollards_of_usual_size() -> None:
    found = stands(WorldObject(0, "bollard", 10.0, 0.0, 0.0, (16.2, 0.2, 0.9)))
    xs = np.array([one.x_m for one in found])
    assert len(found) == 10
    assert {one.item for one in found} == {0}
    assert xs.min() == pytest.approx(2.0)
    assert xs.max() == pytest.approx(18.0)
    assert all(one.scale == pytest.approx((1.0, 1.0, 1.0)) for one in found)


def test_racks_stand_side_by_side_along_their_length_whichever_way_they_face() -> None:
    found = stands(WorldObject(0, "bicycle_parking", 0.0, 0.0, math.pi / 2, (12.0, 1.8, 0.9)))
    ys = sorted(one.y_m for one in found)
    assert len(found) == 4
    np.testing.assert_allclose(np.diff(ys), 3.0)
    assert max(abs(one.x_m) for one in found) < 1e-9


def test_a_hydrant_below_the_ground_is_a_lid() -> None:
    lid, post = stands(
        WorldObject(0, "fire_hydrant", 0.0, 0.0, 0.0, (0.35, 0.35, 0.05)),
        WorldObject(1, "fire_hydrant", 9.0, 0.0, 0.0, (0.35, 0.35, 0.8)),
    )
    assert lid.model.size_m[2] < 0.06
    assert lid.scale == (1.0, 1.0, 1.0)
    assert post.model.size_m[2] == pytest.approx(0.8)
    for mesh in lid.model.levels:
        assert 0.5 < np.ptp(mesh.vertices[:, 0]) < 0.8
        assert mesh.vertices[:, 2].min() == 0.0


def test_a_large_pitch_has_goals_of_usual_size_at_its_ends_that_face_each_other() -> None:
    ends = stands(WorldObject(0, "pitch", 0.0, 0.0, 0.0, (100.0, 60.0, 0.1)))
    assert sorted(one.x_m for one in ends) == pytest.approx([-49.7, 49.7])
    for one in ends:
        back = one.x_m * math.sin(one.heading_rad) + one.y_m * math.cos(one.heading_rad)
        assert back == pytest.approx(49.7)
        high = one.model.levels[0].vertices[:, 2].max()
        assert 1.9 < high < 4.2
    (whole,) = stands(WorldObject(0, "pitch", 0.0, 0.0, 0.0, (30.0, 20.0, 0.1)))
    assert len(whole.model.levels[0].triangles) > 0


@pytest.mark.parametrize("seed", range(4))
def test_what_stands_on_a_playground_keeps_apart_and_within_its_outline(seed: int) -> None:
    outline = np.array([(0, 0), (26, 2), (24, 16), (12, 11), (1, 14)], float)
    swing = OBJECT_CLASSES["swing"].size_m
    play = WorldObject(0, "playground", 13.0, 7.0, 0.0, (26.0, 16.0, 0.1), outline=outline)
    found = stands(play, WorldObject(1, "swing", 6.0, 6.0, 0.0, swing), seed=seed)
    pieces = [one for one in found if one.item == 0]
    assert len(pieces) >= 3
    plans = [hull_of(one) for one in found]
    for at, one in enumerate(plans[:-1]):
        assert shapely.Polygon(outline).buffer(0.6).contains(one)
        assert not any(one.intersects(other) for other in plans[at + 1 :])


def hull_of(one: Stand) -> shapely.Geometry:
    """What ground it covers."""
    flat = one.model.levels[0].vertices[:, :2].astype(float) * one.scale[:2]
    sine, cosine = math.sin(one.heading_rad), math.cos(one.heading_rad)
    turned = flat @ np.array([(cosine, -sine), (sine, cosine)]) + (one.x_m, one.y_m)
    return shapely.convex_hull(shapely.MultiPoint(turned))


def test_pieces_are_sound() -> None:
    for play in (WorldObject(0, "playground", 0.0, 0.0, 0.0, (40.0, 40.0, 0.1)),):
        for seed in range(3):
            for one in stands(play, seed=seed):
                for level, mesh in enumerate(one.model.levels):
                    assert mesh.vertices[:, 2].min() >= -1e-6
                    assert not len(floating(mesh, parts(welded(mesh)), 0.12))
                    assert level > 1 or not len(fighting(mesh, least_m2=0.01))


def test_the_same_seed_gives_the_same_stands() -> None:
    world = generate_world("park", seed=3, size_m=150.0)
    one, other = (
        [(each.item, each.x_m, each.y_m, each.scale, each.tint) for each in stands_of(world, fronts_of(world), seed=5)]
        for _ in range(2)
    )
    assert one == other
    assert {item for item, *_ in one} >= {item.id for item in world.objects if item.class_name == "tree"}
    assert model_of("tree") is model_of("tree")
