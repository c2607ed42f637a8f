"""The ground as it is drawn: every kind has a look, roads run on below crossings, buildings leave no trace."""

import numpy as np

from reasoned_explorer.rendering.ground_map import (
    GROUND_LOOKS,
    GUESSED_GREEN,
    GUESSED_PAVED,
    LOOKS,
    ground_colours,
    ground_map_of,
    ground_materials,
)
from reasoned_explorer.rendering.material import Material
from reasoned_explorer.world.generator import generate_world
from reasoned_explorer.world.raster import GroundRaster
from reasoned_explorer.world.taxonomy import Ground
from reasoned_explorer.world.world import Bounds, Building, Way, World
from tests.world.worlds import box, field

ROAD = Way("residential", Ground.ROAD, np.array([(0.0, 50.0), (100.0, 50.0)]), 8.0)
WALK = Way("footway", Ground.PAVEMENT, np.array([(40.0, 0.0), (40.0, 100.0)]), 3.0)


def test_every_kind_of_ground_has_a_look() -> None:
    assert set(GROUND_LOOKS) == set(Ground)
    assert ground_materials().shape == (len(LOOKS),)
    assert ground_colours().shape == (len(LOOKS), 3)
    assert ground_colours().min() > 0.0
    assert ground_colours().max() <= 1.0
    assert ground_materials()[Ground.WATER] == Material.WATER
    assert ground_materials()[Ground.ROAD] == Material.ASPHALT


def test_grounds_that_matter_to_a_walker_can_be_told_apart() -> None:
    kinds = (Ground.ROAD, Ground.PAVEMENT, Ground.PLAZA, Ground.CYCLEWAY, Ground.PATH, Ground.GRASS, Ground.SAND,
             Ground.WATER, Ground.RAILWAY)  # fmt: skip
    looks = {(GROUND_LOOKS[kind].material, GROUND_LOOKS[kind].colour) for kind in kinds}
    assert len(looks) == len(kinds)


def test_it_is_as_the_world_is_but_finer() -> None:
    world = generate_world("park", seed=3, size_m=200.0)
    drawn, walked = ground_map_of(world), GroundRaster.of(world)
    assert drawn.cell_m == 0.25
    assert drawn.codes.shape == (800, 800)
    rng = np.random.default_rng(1)
    x, y = rng.uniform(-100.0, 100.0, (2, 4000))
    same = drawn.at_many(x, y) == walked.at_many(x, y)
    free = walked.at_many(x, y) != Ground.BUILDING
    assert same[free].mean() > 0.95


def test_a_road_runs_on_below_a_crossing_that_is_painted_later() -> None:
    drawn = ground_map_of(field(ways=[ROAD, WALK]))
    assert drawn.at(40.0, 50.0) == Ground.ROAD
    assert drawn.at(38.7, 53.6) == Ground.ROAD
    assert drawn.at(40.0, 55.0) == Ground.PAVEMENT


def test_a_slanting_crossing_leaves_no_corners_behind() -> None:
    slant = Way("footway", Ground.PAVEMENT, np.array([(20.0, 20.0), (80.0, 80.0)]), 3.0)
    drawn = ground_map_of(field(ways=[ROAD, slant]))
    x, y = np.meshgrid(np.linspace(40.0, 60.0, 90), np.linspace(46.2, 53.8, 60))
    assert (drawn.at_many(x, y) == Ground.ROAD).all()


def test_a_road_that_is_painted_later_is_on_top_anyway_and_a_pavement_along_it_stays() -> None:
    along = Way("footway", Ground.PAVEMENT, np.array([(0.0, 53.0), (100.0, 53.0)]), 3.0)
    drawn = ground_map_of(field(ways=[WALK, ROAD, along]))
    assert drawn.at(40.0, 50.0) == Ground.ROAD
    assert drawn.at(70.0, 53.0) == Ground.PAVEMENT


def test_buildings_stand_on_the_ground_and_are_none() -> None:
    drawn = ground_map_of(field(buildings=[Building(outer=box(10, 10, 30, 30), height_m=9.0)]))
    assert drawn.at(20.0, 20.0) == Ground.GRASS
    assert drawn.at(500.0, 20.0) == Ground.UNKNOWN


def test_large_worlds_get_larger_cells() -> None:
    drawn = ground_map_of(field(size_m=4000.0))
    assert 0.25 < drawn.cell_m < 0.5


def test_unknown_ground_is_paved_among_houses_and_green_elsewhere() -> None:
    houses = tuple(
        Building(outer=box(x, y, x + 16, y + 16), height_m=9.0) for x in range(0, 80, 20) for y in range(0, 80, 20)
    )
    world = World("test", Bounds(0, 0, 300, 80), (), (), houses, ())
    codes = ground_map_of(world).codes
    assert set(np.unique(codes)) == {GUESSED_PAVED, GUESSED_GREEN}
    assert (codes[:, : 4 * 50] == GUESSED_PAVED).all()
    assert (codes[:, 4 * 150 :] == GUESSED_GREEN).all()
    # One border, and it does not go back and forth.
    assert (np.diff((codes == GUESSED_GREEN).astype(int), axis=1) >= 0).all()
