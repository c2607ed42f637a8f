"""Generated worlds are places: known ground, things where they can stand, ways to everywhere."""

import dataclasses
import math
from functools import cache

import numpy as np
import pytest
import shapely

from reasoned_explorer.world.generator import DISTRICTS, generate_world
from reasoned_explorer.world.generator.shapes import along, left_of
from reasoned_explorer.world.taxonomy import IMPASSABLE_ON_FOOT, OBJECT_CLASSES, Ground
from reasoned_explorer.world.validation import check_world
from reasoned_explorer.world.world import World, WorldObject

SIZE_M = 300.0
every_district = pytest.mark.parametrize("district", DISTRICTS)


@cache
def world_of(district: str, seed: int = 1) -> World:
    return generate_world(district, seed=seed, size_m=SIZE_M)


@cache
def layers_of(world: World) -> tuple[shapely.STRtree, np.ndarray]:
    shapes = [shapely.Polygon(item.outer, item.holes) for item in world.regions]
    shapes += [shapely.LineString(item.line).buffer(item.width_m / 2, cap_style="flat") for item in world.ways]
    shapes += [shapely.Polygon(item.outer, item.holes) for item in world.buildings]
    codes = [item.ground for item in (*world.regions, *world.ways)] + [Ground.BUILDING] * len(world.buildings)
    return shapely.STRtree(shapes), np.array(codes)


def ground_at(world: World, points: np.ndarray) -> np.ndarray:
    tree, codes = layers_of(world)
    point, layer = tree.query(shapely.points(points), predicate="intersects")
    top = np.full(len(points), -1)
    np.maximum.at(top, point, layer)
    return np.where(top >= 0, codes[top], Ground.UNKNOWN)


def cells(world: World, step_m: float) -> np.ndarray:
    ticks = np.arange(world.bounds.min_x_m + step_m / 2, world.bounds.max_x_m, step_m)
    grid = np.stack(np.meshgrid(ticks, ticks), axis=-1)
    return ground_at(world, grid.reshape(-1, 2)).reshape(grid.shape[:2])


def standing(world: World) -> list[WorldObject]:
    return [item for item in world.objects if item.object_class.kind not in ("place", "area")]


def stand_of(item: WorldObject) -> shapely.Polygon:
    """The ground that an object takes; of a tree, its trunk."""
    length, depth = (0.5, 0.5) if item.class_name == "tree" else item.size_m[:2]
    front = np.array([math.sin(item.heading_rad), math.cos(item.heading_rad)])
    right = np.array([front[1], -front[0]])
    corners = ((-1, -1), (1, -1), (1, 1), (-1, 1))
    return shapely.Polygon([(item.x_m, item.y_m) + right * length / 2 * a + front * depth / 2 * b for a, b in corners])


@every_district
def test_a_world_says_where_it_comes_from(district: str) -> None:
    world = world_of(district)
    assert (world.name, world.seed) == (f"{district}:1@300", 1)
    assert world.source == f"generated {district} seed=1 size=300"
    assert world.origin is None
    assert (world.bounds.width_m, world.bounds.height_m) == (SIZE_M, SIZE_M)


@every_district
def test_all_ground_is_known_and_of_many_kinds(district: str) -> None:
    grounds = cells(world_of(district), 3.0)
    assert not (grounds == Ground.UNKNOWN).any()
    assert len(np.unique(grounds)) >= 6
    assert {Ground.ROAD, Ground.PAVEMENT, Ground.BUILDING} <= set(np.unique(grounds).tolist())


@every_district
def test_walkable_ground_hangs_together(district: str) -> None:
    for seed in (1, 2):
        walkable = ~np.isin(cells(world_of(district, seed), 2.0), list(IMPASSABLE_ON_FOOT))
        todo, largest = walkable.copy(), 0
        while todo.any() and largest < todo.sum():
            reached = np.zeros_like(todo)
            reached[np.unravel_index(int(np.argmax(todo)), todo.shape)] = True
            size = 0
            while size < (size := int(reached.sum())):
                for _ in range(20):
                    grown = reached.copy()
                    grown[1:] |= reached[:-1]
                    grown[:-1] |= reached[1:]
                    grown[:, 1:] |= reached[:, :-1]
                    grown[:, :-1] |= reached[:, 1:]
                    reached = grown & walkable
            largest = max(largest, size)
            todo &= ~reached
        assert largest >= 0.95 * walkable.sum()


@every_district
def test_objects_are_sound(district: str) -> None:
    world = world_of(district)
    assert [item.id for item in world.objects] == list(range(len(world.objects)))
    for item in world.objects:
        assert item.class_name in OBJECT_CLASSES
        assert world.bounds.contains(item.x_m, item.y_m)
        assert 0.0 <= item.heading_rad < 2 * math.pi
        assert min(item.size_m) > 0


@every_district
def test_nothing_stands_in_a_building_in_water_or_in_something_else(district: str) -> None:
    world = world_of(district)
    things = standing(world)
    stands = np.array([stand_of(item) for item in things])
    middle = np.array([(item.x_m, item.y_m) for item in things])
    ground = ground_at(world, middle)
    assert not np.isin(ground, [Ground.BUILDING, Ground.WATER]).any()
    first, second = shapely.STRtree(stands).query(stands, predicate="intersects")
    overlap = shapely.area(shapely.intersection(stands[first], stands[second]))[first < second]
    assert not (overlap > 1e-3).any()
    walls = [shapely.Polygon(item.outer, item.holes) for item in world.buildings]
    at, wall = shapely.STRtree(walls).query(stands, predicate="intersects")
    reach = shapely.area(shapely.intersection(stands[at], np.array(walls)[wall]))
    assert not (reach > 0.3).any()


@every_district
def test_only_cars_and_bicycles_are_on_the_carriageway_and_leave_it_passable(district: str) -> None:
    world = world_of(district)
    things = [item for item in standing(world) if item.class_name != "car"]
    ground = ground_at(world, np.array([(item.x_m, item.y_m) for item in things]))
    assert not (ground == Ground.ROAD).any()
    lanes = [
        shapely.LineString(way.line).buffer(1.3, cap_style="flat") for way in world.ways if way.ground == Ground.ROAD
    ]
    stands = [stand_of(item) for item in standing(world)]
    blocked, _ = shapely.STRtree(stands).query(np.array(lanes), predicate="intersects")
    assert not len(blocked)


@every_district
def test_a_world_is_sound(district: str) -> None:
    check_world(world_of(district))


@every_district
def test_one_can_walk_on_along_the_pavements(district: str) -> None:
    """Across nearly every pavement, away from its ends, there are 1.45 m between what stands on it and the walls."""
    world = world_of(district)
    solid = [stand_of(item) for item in standing(world)]
    solid += [shapely.Polygon(item.outer, item.holes) for item in world.buildings if item.min_height_m == 0]
    tree, free = shapely.STRtree(solid), []
    roads = [way for way in world.ways if way.ground == Ground.ROAD]
    beds = shapely.union_all([shapely.LineString(way.line).buffer(way.width_m / 2, cap_style="flat") for way in roads])
    pavements = {way.line.tobytes(): way.width_m for way in world.ways if way.ground == Ground.PAVEMENT}
    for way in roads:
        half_m = pavements[way.line.tobytes()] / 2
        assert half_m - way.width_m / 2 >= 2.5
        at, tangents = along(way.line, 4.0, start_m=14.0, end_m=14.0)
        for foot, normal in zip(at, left_of(tangents), strict=True):
            for side in (1.0, -1.0):
                across = shapely.LineString(
                    [foot + side * normal * reach for reach in (way.width_m / 2 + 0.01, half_m)]
                )
                if np.abs(shapely.get_coordinates(across)).max() < SIZE_M / 2 and not beds.intersects(across):
                    near = [solid[index] for index in tree.query(across, predicate="intersects")]
                    rest = shapely.get_parts(across.difference(shapely.union_all(near)))
                    free.append(max(shapely.length(rest), default=0.0))
    assert len(free) > 50
    assert np.mean(np.array(free) >= 1.45) >= 0.97


@every_district
def test_no_courtyard_is_closed(district: str) -> None:
    """What walls leave open hangs together even for a body that needs 3 m, but for small corners.

    A street that cuts a corner of the world may be cut off by its border.
    """
    world = world_of(district)
    walls = [shapely.Polygon(item.outer, item.holes) for item in world.buildings if item.min_height_m == 0]
    half = SIZE_M / 2
    box = shapely.box(-half, -half, half, half)
    rooms = shapely.get_parts(shapely.buffer(shapely.difference(box, shapely.union_all(walls)), -1.5, quad_segs=3))
    closed = rooms[shapely.distance(rooms, box.exterior) > 2.0]
    assert (shapely.area(closed) < 150.0).all()
    assert shapely.area(rooms).max() > 0.97 * shapely.area(rooms).sum()


@every_district
def test_benches_look_at_a_place_to_walk(district: str) -> None:
    world = world_of(district)
    benches = [item for item in world.objects if item.class_name == "bench"]
    assert benches
    ahead = np.array([(math.sin(item.heading_rad), math.cos(item.heading_rad)) for item in benches])
    at = np.array([(item.x_m, item.y_m) for item in benches])
    fit = [Ground.PATH, Ground.PAVEMENT, Ground.PLAZA, Ground.PLAYGROUND, Ground.SAND]
    seen = np.zeros(len(benches), bool)
    for distance in (0.8, 1.5, 2.2):
        seen |= np.isin(ground_at(world, at + distance * ahead), fit)
    assert seen.mean() >= 0.9


@every_district
def test_places_are_at_entrances_of_their_buildings(district: str) -> None:
    world = world_of(district)
    places = [item for item in world.objects if item.object_class.kind == "place"]
    assert places
    for item in places:
        building = world.buildings[item.building]
        assert item.building >= 0
        assert np.hypot(*(building.entrances - (item.x_m, item.y_m)).T).min() < 0.6


@every_district
def test_most_buildings_have_an_entrance_on_their_outline(district: str) -> None:
    world = world_of(district)
    houses = [item for item in world.buildings if item.min_height_m == 0]
    assert np.mean([len(item.entrances) > 0 for item in houses]) > 0.8
    for item in houses:
        ring = shapely.LinearRing(item.outer)
        assert all(ring.distance(shapely.points(point)) < 0.01 for point in item.entrances)


def test_every_class_stands_somewhere() -> None:
    seen = {item.class_name for district in DISTRICTS for seed in (1, 2) for item in world_of(district, seed).objects}
    assert set(OBJECT_CLASSES) - seen <= {"telephone", "clock"}, set(OBJECT_CLASSES) - seen


def test_districts_have_what_makes_them() -> None:
    def share(district: str, ground: Ground) -> float:
        return float((cells(world_of(district), 3.0) == ground).mean())

    green = (Ground.GRASS, Ground.WOOD, Ground.GARDEN)
    assert sum(share("park", ground) for ground in green) > 0.35
    assert share("waterfront", Ground.WATER) > 0.15
    assert share("downtown", Ground.BUILDING) > 0.25
    assert share("residential", Ground.GARDEN) > 0.25
    assert share("plaza", Ground.PLAZA) > 0.05
    park = {item.class_name for item in world_of("park").objects}
    assert {"playground", "lawn", "tree", "bench", "cafe"} <= park


def test_arrays_are_finite() -> None:
    for district in DISTRICTS:
        world = world_of(district)
        for item in (*world.regions, *world.buildings):
            assert np.isfinite(item.outer).all()
            assert len(item.outer) >= 3
        for way in world.ways:
            assert np.isfinite(way.line).all()
            assert len(way.line) >= 2
        assert dataclasses.is_dataclass(world)
