"""Permuted labels: what is left of a world when only which is which has changed."""

import math
from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from reasoned_explorer.model import SettingsError
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.digest import world_digest
from reasoned_explorer.world.generator import generate_world
from reasoned_explorer.world.permuted import permute_labels
from reasoned_explorer.world.taxonomy import Ground
from reasoned_explorer.world.validation import check_world
from reasoned_explorer.world.world import World
from tests.world.worlds import courtyard

RADIUS_M = 20.0


@pytest.fixture(scope="module")
def downtown() -> World:
    return generate_world("downtown", seed=3, size_m=300.0)


@settings(max_examples=15)
@given(seed=st.integers(0, 10**18 - 1), district=st.sampled_from(["downtown", "park"]))
def test_the_same_things_at_the_same_spots(seed: int, district: str) -> None:
    world = generate_world(district, seed=5, size_m=160.0)
    permuted = permute_labels(world, seed=seed)
    check_world(permuted)
    assert permuted.name == f"{world.name}~permuted:{seed}"
    # Class, size and attributes travel together, and nothing is lost.
    assert _labels(permuted) == _labels(world)
    for here, there in zip(world.objects, permuted.objects, strict=True):
        assert (there.id, there.heading_rad) == (here.id, here.heading_rad)
        moved_m = math.hypot(there.x_m - here.x_m, there.y_m - here.y_m)
        stands_before_a_door = here.building >= 0 and there.object_class.kind != "place"
        assert moved_m <= (1.2 + 1e-9 if stands_before_a_door else 0.0)
        assert (there.object_class.kind == "area") == (here.object_class.kind == "area")
    assert world_digest(permuted) == world_digest(permute_labels(world, seed=seed))


def _labels(world: World) -> Counter[tuple[object, ...]]:
    return Counter(
        (item.class_name, *(() if item.object_class.kind == "area" else item.size_m), *sorted(item.attributes.items()))
        for item in world.objects
    )


def test_seeds_decide(downtown: World) -> None:
    digests = {world_digest(permute_labels(downtown, seed=seed)) for seed in range(4)} | {world_digest(downtown)}
    assert len(digests) == 5


@pytest.mark.parametrize("seed", [-1, 10**18])
def test_a_seed_that_no_name_could_hold_is_refused(seed: int) -> None:
    with pytest.raises(SettingsError):
        permute_labels(courtyard(), seed=seed)


def test_nothing_stands_in_a_wall(downtown: World) -> None:
    houses = shapely.STRtree([shapely.Polygon(b.outer, b.holes).buffer(-0.05) for b in downtown.buildings])
    for seed in range(3):
        things = [item for item in permute_labels(downtown, seed=seed).objects if item.object_class.kind != "area"]
        inside = houses.query(shapely.points([(item.x_m, item.y_m) for item in things]), predicate="intersects")[0]
        # But for what the map itself puts there, which is left as it is.
        assert all(things[place] is downtown.objects[things[place].id] for place in inside)


def test_a_place_at_a_door_stays_in_its_building_and_one_in_the_open_is_in_none(downtown: World) -> None:
    permuted = permute_labels(downtown, seed=1)
    for here, there in zip(downtown.objects, permuted.objects, strict=True):
        at_a_door = here.building >= 0 and there.object_class.kind == "place"
        assert there.building == (here.building if at_a_door else -1)


def test_the_ground_of_an_area_goes_with_its_class() -> None:
    world = generate_world("park", seed=3, size_m=300.0)
    swapped = 0
    for seed in range(6):
        permuted = permute_labels(world, seed=seed)
        ground = Atlas(permuted).ground
        for here, there in zip(world.objects, permuted.objects, strict=True):
            if there.class_name != here.class_name and there.class_name in {"pitch", "playground"}:
                middle = shapely.Polygon(there.outline).representative_point()
                wanted = Ground.PITCH if there.class_name == "pitch" else Ground.PLAYGROUND
                codes = ground.at_many(*np.array([(middle.x, middle.y)]).T)
                on_a_way = any(
                    shapely.LineString(way.line).distance(middle) <= way.width_m / 2 for way in permuted.ways
                )
                assert on_a_way or codes[0] == wanted
                swapped += 1
    assert swapped


def test_what_stands_near_what_is_chance(downtown: World) -> None:
    """Lifts of classes within 20 m: far from 1 in the world, 1 within noise over permutations of it."""
    movable = [item.object_class.kind != "area" for item in downtown.objects]
    points = shapely.points([(item.x_m, item.y_m) for item in downtown.objects])
    one, other = shapely.STRtree(points).query(points, predicate="dwithin", distance=RADIUS_M)
    kept = (one != other) & np.array(movable)[one] & np.array(movable)[other]
    one, other = one[kept], other[kept]

    common = [name for name, count in Counter(item.class_name for item in downtown.objects).items() if count >= 12]
    common = [name for name in common if name != "lawn"]

    def pair_lifts(world: World) -> np.ndarray:
        """Pairs of classes that were seen, over those expected were classes independent of spots."""
        names = np.array([item.class_name for item in world.objects])
        codes = np.array([common.index(name) if name in common else len(common) for name in names])
        seen = np.zeros((len(common) + 1, len(common) + 1))
        np.add.at(seen, (codes[one], codes[other]), 1.0)
        number = np.bincount(codes[movable], minlength=len(common) + 1).astype(float)
        expected = len(one) * (np.outer(number, number) - np.diag(number)) / (sum(movable) * (sum(movable) - 1))
        return (seen / expected)[:-1, :-1]

    assert np.abs(np.log2(pair_lifts(downtown) + 0.01)).max() > 2.0
    drawn = np.array([pair_lifts(permute_labels(downtown, seed=seed)) for seed in range(40)])
    mean, error = drawn.mean(axis=0), drawn.std(axis=0, ddof=1) / math.sqrt(len(drawn))
    assert (np.abs(mean - 1.0) < 4.5 * error).all()
    assert np.median(np.abs(mean - 1.0)) < 0.05


def test_outlines_of_the_map_stay_with_areas_only() -> None:
    world = courtyard()
    basin = replace(world.objects[3], outline=world.objects[6].outline)
    world = replace(world, objects=(*world.objects[:3], basin, *world.objects[4:]))
    for item in permute_labels(world, seed=2).objects:
        if item.object_class.kind == "area":
            assert item.outline is not None
        elif item is not basin:
            assert item.outline is None
