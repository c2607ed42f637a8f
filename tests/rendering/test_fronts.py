"""Fronts of places lie on walls, beside each other, within the corners; those without a wall get a booth."""

import math

import numpy as np
import pytest
import shapely

from reasoned_explorer.rendering.fronts import Front, clear_of, fronts_of, walls_taken
from reasoned_explorer.rendering.models import model_of
from reasoned_explorer.world.generator import generate_world
from reasoned_explorer.world.taxonomy import OBJECT_CLASSES
from reasoned_explorer.world.world import Bounds, Building, World, WorldObject
from tests.rendering.meshes import floating, parts, welded
from tests.world.worlds import box

HOUSE = Building(outer=box(0, 0, 30, 10), height_m=12.0)


def fronts(*places: tuple[str, float, float], buildings: tuple[Building, ...] = (HOUSE,)) -> list[Front]:
    """The fronts of places that look south."""
    things = tuple(
        WorldObject(at, name, x, y, math.pi, OBJECT_CLASSES[name].size_m) for at, (name, x, y) in enumerate(places)
    )
    world = World("test", Bounds(-50, -50, 50, 50), (), (), buildings, things)
    found = fronts_of(world)
    return [found[thing.id] for thing in things]


def test_a_front_is_as_wide_as_its_class_and_on_the_wall() -> None:
    (front,) = fronts(("cafe", 12.0, -0.5))
    assert (front.x_m, front.y_m, front.width_m) == pytest.approx((12.0, 0.0, 6.0))
    assert not front.free
    assert front.heading_rad == pytest.approx(math.pi)
    assert front.scale == (1.0, 1.0, 1.0)


def test_near_a_corner_it_gets_narrower_and_then_moves() -> None:
    (front,) = fronts(("cafe", 0.4, 0.0))
    assert front.width_m == pytest.approx(0.62 * 6.0)
    assert front.x_m == pytest.approx(0.06 + front.width_m / 2.0)
    (near,) = fronts(("cafe", 2.5, 0.0))
    assert near.x_m == pytest.approx(2.5)
    assert near.x_m - near.width_m / 2.0 == pytest.approx(0.06)


def test_neighbours_share_the_wall() -> None:
    one, other, third = fronts(("cafe", 15.0, 0.0), ("shop", 15.0, 0.0), ("bar", 17.4, 0.0))
    ends = [(each.x_m - each.width_m / 2.0, each.x_m + each.width_m / 2.0) for each in (one, other, third)]
    for (_, right), (left, _) in zip(sorted(ends), sorted(ends)[1:], strict=False):
        assert left >= right - 1e-9


def test_many_places_on_a_short_wall_all_have_room() -> None:
    short = Building(outer=box(0, 0, 5, 10), height_m=12.0)
    found = fronts(*[("shop", 2.5, -0.5)] * 4, buildings=(short,))
    assert sum(each.width_m for each in found) <= 5.0
    assert min(each.x_m - each.width_m / 2.0 for each in found) >= 0.0


def test_what_stands_in_the_open_has_a_booth_behind_it() -> None:
    (front,) = fronts(("toilets", 12.0, -20.0))
    assert front.free
    model = front.dressed(model_of("toilets"))
    assert model is front.dressed(model_of("toilets"))
    for mesh in model.levels:
        assert mesh.vertices[:, 1].min() < -2.0
        assert not len(floating(mesh, parts(welded(mesh)), 0.05))


def test_low_buildings_have_low_fronts_and_the_size_of_premises_is_none_of_a_front() -> None:
    hut = Building(outer=box(0, 0, 30, 10), height_m=2.8)
    (front,) = fronts(("cafe", 12.0, 0.0), buildings=(hut,))
    assert front.scale[2] * 3.0 < 2.8
    mall = WorldObject(0, "shop", 12.0, -0.5, math.pi, (72.0, 47.0, 3.0))
    world = World("test", Bounds(-50, -50, 50, 50), (), (), (HOUSE,), (mall,))
    assert fronts_of(world)[0].width_m == pytest.approx(6.0)


def test_no_front_of_a_generated_world_reaches_beyond_its_wall() -> None:
    world = generate_world("town", seed=4, size_m=300.0)
    found = fronts_of(world)
    taken = walls_taken(list(found.values()))
    assert len(found) > 20
    plans = [shapely.Polygon(building.outer, building.holes) for building in world.buildings]
    for front in found.values():
        along = np.array([math.cos(front.heading_rad), -math.sin(front.heading_rad)])
        out = np.array([math.sin(front.heading_rad), math.cos(front.heading_rad)])
        for share in (-0.5, -0.25, 0.0, 0.25, 0.5):
            foot = np.array([front.x_m, front.y_m]) + share * front.width_m * along
            assert min(plan.distance(shapely.Point(foot)) for plan in plans) < 0.01
            assert not any(plan.contains(shapely.Point(foot + 0.7 * out)) for plan in plans)
    assert not clear_of(taken[:, :2], taken, 0.0).any()
    assert clear_of(np.array([(999.0, 0.0)]), taken, 1.0).all()
