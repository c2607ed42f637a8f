"""The generator's front door: the same for the same seed, clear words for bad input, furniture as in real places."""

import math
import subprocess
import sys
from collections import Counter

import numpy as np
import pytest
import shapely

from reasoned_explorer.knowledge.cooccurrence import load_cooccurrence
from reasoned_explorer.model.errors import SettingsError, UnknownNameError
from reasoned_explorer.world.generator import DISTRICTS, generate_world
from reasoned_explorer.world.taxonomy import CLASS_NAMES, OBJECT_CLASSES, Ground
from reasoned_explorer.world.world import World

_DIGEST = """
import hashlib, sys
from reasoned_explorer.world.generator import generate_world
world = generate_world(sys.argv[1], seed=int(sys.argv[2]), size_m=200.0)
digest = hashlib.sha256()
for item in (*world.regions, *world.buildings):
    digest.update(item.outer.tobytes())
for item in world.buildings:
    digest.update(item.entrances.tobytes() + repr((item.height_m, item.kind, item.name)).encode())
for item in world.ways:
    digest.update(item.line.tobytes() + repr((item.kind, item.ground, item.width_m, item.name)).encode())
for item in world.objects:
    digest.update(repr((item.id, item.class_name, item.x_m, item.y_m, item.heading_rad, item.size_m,
                        sorted(item.attributes.items()), item.building)).encode())
print(digest.hexdigest())
"""


def digest_in_a_process_of_its_own(district: str, seed: int, hash_seed: str) -> str:
    command = [sys.executable, "-c", _DIGEST, district, str(seed)]
    done = subprocess.run(command, capture_output=True, text=True, check=True, env={"PYTHONHASHSEED": hash_seed})
    return done.stdout.strip()


@pytest.mark.parametrize("district", ["park", "town"])
def test_the_same_seed_gives_the_same_bytes_in_two_processes(district: str) -> None:
    first = digest_in_a_process_of_its_own(district, 3, "1")
    assert first == digest_in_a_process_of_its_own(district, 3, "2")
    assert first != digest_in_a_process_of_its_own(district, 4, "1")


@pytest.mark.parametrize("district", DISTRICTS)
def test_another_seed_gives_another_place(district: str) -> None:
    one, other = (generate_world(district, seed=seed, size_m=200.0) for seed in (5, 6))
    rings = [{item.outer.tobytes() for item in world.buildings} for world in (one, other)]
    assert len(rings[0] & rings[1]) < 0.1 * len(rings[0])


@pytest.mark.parametrize("district", DISTRICTS)
def test_small_worlds_work_too(district: str) -> None:
    assert generate_world(district, seed=12, size_m=137.5).name == f"{district}:12@137.5"
    world = generate_world(district, seed=11, size_m=100)
    assert world.name == f"{district}:11@100"
    assert len(world.objects) > 20


def test_a_misspelt_district_is_answered_with_the_near_misses() -> None:
    with pytest.raises(UnknownNameError, match="did you mean downtown"):
        generate_world("downtwn")


@pytest.mark.parametrize("size_m", [99.9, 1000.1, math.nan, math.inf, -5.0, "big", True])
def test_a_size_out_of_range_is_refused(size_m: float) -> None:
    with pytest.raises(SettingsError, match="100 to 1000"):
        generate_world("park", size_m=size_m)


@pytest.mark.parametrize("seed", [-1, 0.5, math.nan, True, "x"])
def test_a_seed_that_is_none_is_refused(seed: int) -> None:
    with pytest.raises(SettingsError, match="whole number"):
        generate_world("park", seed=seed)


def test_all_faults_are_told_at_once() -> None:
    with pytest.raises(SettingsError) as caught:
        generate_world("prak", seed=-1, size_m=math.nan)
    assert len(caught.value.faults) == 3
    assert "park" in str(caught.value)


def test_listing_districts_loads_nothing_heavy() -> None:
    code = "import sys, reasoned_explorer.world.generator; print('numpy' in sys.modules, 'shapely' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["False", "False"]


def pair_counts(world: World) -> tuple[np.ndarray, np.ndarray]:
    """Observed and expected numbers of pairs within 20 m, by class, as `scripts/compute_cooccurrence.py` counts."""
    shapes = np.array(
        [
            shapely.make_valid(shapely.Polygon(item.outline)) if item.outline is not None else None
            for item in world.objects
        ],
        dtype=object,
    )
    points = shapely.points([(item.x_m, item.y_m) for item in world.objects])
    shapes = np.where(shapely.is_missing(shapes), points, shapes)
    codes = np.array([CLASS_NAMES.index(item.class_name) for item in world.objects])
    rng = np.random.default_rng(0)
    half = world.bounds.width_m / 2
    land = shapely.points(rng.uniform(-half, half, (round(20_000 * world.bounds.area_km2), 2)))
    shut = [shapely.Polygon(item.outer, item.holes) for item in world.buildings]
    shut += [shapely.Polygon(item.outer, item.holes) for item in world.regions if item.ground == Ground.WATER]
    hit, _ = shapely.STRtree(shut).query(land, predicate="intersects")
    land = np.delete(land, np.unique(hit))

    def counts(of: np.ndarray, *, same: bool) -> np.ndarray:
        at, other = shapely.STRtree(shapes).query(of, predicate="dwithin", distance=20.0)
        kept = at != other if same else np.ones(len(at), bool)
        table = np.zeros((len(of), len(CLASS_NAMES)))
        np.add.at(table, (at[kept], codes[other[kept]]), 1.0)
        return table

    observed = np.zeros((len(CLASS_NAMES), len(CLASS_NAMES)))
    np.add.at(observed, codes, counts(shapes, same=True))
    tree = shapely.STRtree(land)
    own = np.bincount(tree.query(shapes, predicate="dwithin", distance=20.0)[0], minlength=len(shapes))
    usual = np.bincount(tree.query(land, predicate="dwithin", distance=20.0)[0]).mean()
    reach = np.bincount(codes, weights=own, minlength=len(CLASS_NAMES)) / usual
    return observed, reach[:, None] * counts(land, same=False).mean(axis=0)[None, :]


def ranks(values: np.ndarray) -> np.ndarray:
    _, place, number = np.unique(values, return_inverse=True, return_counts=True)
    return (np.cumsum(number) - (number - 1) / 2)[place]


def test_what_stands_near_what_is_as_in_real_places() -> None:
    statistics = load_cooccurrence()
    worlds = [generate_world(district, seed=seed, size_m=300.0) for district in DISTRICTS for seed in (21, 22)]
    observed, expected = (np.sum(parts, axis=0) for parts in zip(*map(pair_counts, worlds), strict=True))
    made, real = [], []
    for row, given in enumerate(CLASS_NAMES):
        for column, wanted in enumerate(CLASS_NAMES):
            known = wanted in statistics.neighbours(given)
            if known and max(observed[row, column], expected[row, column]) >= 4:
                made.append(math.log((observed[row, column] + 4) / (expected[row, column] + 4)))
                real.append(math.log(statistics.lift(given, wanted)))
    made_, real_ = np.array(made), np.array(real)
    assert len(made) > 300
    assert np.corrcoef(ranks(made_), ranks(real_))[0, 1] >= 0.6
    strong = real_ > math.log(3)
    assert (made_[strong] > 0).mean() >= 0.8


def test_common_things_are_about_as_common_as_in_real_places() -> None:
    density = load_cooccurrence().density_per_km2
    worlds = [
        generate_world(district, seed=seed, size_m=300.0) for district in ("downtown", "plaza") for seed in (1, 2)
    ]
    area = sum(world.bounds.area_km2 for world in worlds)
    number = Counter(item.class_name for world in worlds for item in world.objects)
    for name, item in OBJECT_CLASSES.items():
        if item.kind in ("furniture", "place") and density.get(name, 0.0) >= 40.0:
            assert 1 / 2.5 < number[name] / area / density[name] < 2.5, name
