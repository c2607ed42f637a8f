"""A world that was kept is the world that ran, to the last bit."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings

from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.digest import world_digest
from reasoned_explorer.world.files import load_world, save_world
from reasoned_explorer.world.generator import DISTRICTS, generate_world
from reasoned_explorer.world.opening import open_world
from reasoned_explorer.world.osm.importer import import_osm
from reasoned_explorer.world.rounding import rounded
from reasoned_explorer.world.world import World
from tests.world.osm.maps import BBOX, Map
from tests.world.test_files import assert_same, worlds
from tests.world.worlds import field


def kept(world: World, folder) -> World:
    save_world(world, folder / "kept.rexworld")
    return load_world(folder / "kept.rexworld")


def assert_comes_back(world: World, folder) -> None:
    again = kept(world, folder)
    assert_same(world, again, within=0.0)
    assert [list(item.attributes) for item in world.objects] == [list(item.attributes) for item in again.objects]
    assert world_digest(world) == world_digest(again)
    assert rounded(world) is world
    assert rounded(again) is again


@settings(deadline=None, max_examples=100)
@given(world=worlds())
def test_whatever_world_comes_back_as_it_was_asked_about(world, tmp_path_factory):
    folder = tmp_path_factory.mktemp("worlds")
    assert world_digest(kept(world, folder)) == world_digest(world)
    asked = Atlas(world).world
    assert_same(world, asked, within=0.0005001)
    assert_comes_back(asked, folder)


@pytest.mark.parametrize("district", DISTRICTS)
@pytest.mark.parametrize("seed", [3, 5])
def test_a_generated_world_comes_back_as_it_was(district, seed, tmp_path):
    assert_comes_back(generate_world(district, seed=seed, size_m=250.0), tmp_path)


def test_a_world_with_labels_permuted_comes_back_as_it_was(tmp_path):
    assert_comes_back(open_world("plaza:3@200~permuted:1"), tmp_path)


def test_an_imported_world_comes_back_as_it_was(tmp_path):
    plan = Map()
    plan.box(-60.03, -55.017, -20.0109, -30.4321, {"building": "retail", "building:levels": "3"})
    plan.box(10.07, 10.019, 60.0203, 70.1112, {"leisure": "park"})
    plan.way([(-150.0, 3.33), (0.137, 1.119), (151.01, -17.7)], {"highway": "residential", "name": "Long Street"})
    for number in range(12):
        tags = {"amenity": "bench", "material": "wood", "backrest": "yes", "direction": str(31 * number)}
        plan.node(11.03 * number - 60.0, 7.07, tags)
    assert_comes_back(import_osm(plan.write(tmp_path), bbox=BBOX), tmp_path)


@pytest.mark.parametrize("name", ["munich-centre", "uvic-campus"])
def test_a_real_place_comes_back_as_it_was(name, osm_folder, tmp_path):
    assert_comes_back(import_osm(osm_folder / f"{name}.osm.pbf"), tmp_path)


def test_the_fingerprint_tells_a_millimetre_and_a_microradian_but_no_less():
    world = field(("bench", 50.0, 50.0))
    (bench,) = world.objects

    def digest(**changes):
        return world_digest(replace(world, objects=(replace(bench, **changes),)))

    assert digest(x_m=50.0004) == digest(heading_rad=4e-7) == world_digest(world)
    others = [digest(x_m=50.001), digest(y_m=50.001), digest(heading_rad=1e-6), digest(size_m=(1.0, 1.0, 1.001))]
    assert len({*others, world_digest(world)}) == 5


def test_zero_has_no_sign_and_what_is_no_number_stays_none():
    (bench,) = rounded(field(("bench", -0.0, -0.0002))).objects
    assert (str(bench.x_m), str(bench.y_m)) == ("0.0", "0.0")
    (lost,) = rounded(field(("bench", float("nan"), 1.0))).objects
    assert np.isnan(lost.x_m)
    assert np.isinf(rounded(field(("bench", float("inf"), 1.0))).objects[0].x_m)


def test_a_world_is_never_changed():
    world = field(("bench", 50.00049, 50.0))
    assert rounded(world).objects[0].x_m == 50.0
    assert world.objects[0].x_m == 50.00049
