"""How fast questions about a world are answered, warm, on one core.

    python benchmarks/bench_world.py [--repeats 5] [--quick]

Prints a table of what was measured, the median of repeated runs in processor seconds of this process, the aim, and
their ratio (below 1 is better than the aim). The worlds are built here: blocks of houses with yards, streets with
pavements, lamps and trees, a river.
"""

import argparse
import math
import statistics
import time
from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from reasoned_explorer.world.geodesic import Geodesics, Traveller
from reasoned_explorer.world.index import ObjectIndex
from reasoned_explorer.world.raster import GroundRaster
from reasoned_explorer.world.taxonomy import OBJECT_CLASSES, Ground
from reasoned_explorer.world.world import Bounds, Building, Region, Ring, Way, World, WorldObject

_BLOCK_M = 90.0
_WALKER = Traveller(flies=False, radius_m=0.35)


def main() -> None:
    arguments = _arguments()
    lines = [
        line
        for measure in (_raster, _index, _paths, _field, _files)
        for line in measure(arguments.repeats, quick=arguments.quick)
    ]
    print(f"{'what':<64}{'median':>12}{'aim':>12}{'ratio':>8}")
    for what, value, aim, unit in lines:
        print(f"{what:<64}{value:>9.3g} {unit:<2}{aim:>9.3g} {unit:<2}{value / aim:>8.2f}")


def city(side_m: float, seed: int = 1) -> World:
    """Return a square town of city blocks."""
    rng = np.random.Generator(np.random.PCG64(seed))
    blocks = int(side_m // _BLOCK_M)
    lines = [i * _BLOCK_M for i in range(blocks + 1)]
    ways: list[Way] = []
    for kind, ground, width_m in (("footway", Ground.PAVEMENT, 14.0), ("residential", Ground.ROAD, 8.0)):
        for at_m in lines:
            ways.append(Way(kind, ground, np.asarray([(0.0, at_m), (side_m, at_m)]), width_m))
            ways.append(Way(kind, ground, np.asarray([(at_m, 0.0), (at_m, side_m)]), width_m))
    buildings = [b for x_m in lines[:-1] for y_m in lines[:-1] for b in _houses(rng, x_m, y_m)]
    names = [name for name, item in OBJECT_CLASSES.items() if item.kind in {"furniture", "plant"}]
    spots = _street_spots(rng, side_m, lines, count=int(side_m * side_m / 1e6 * 2500))
    objects = [
        WorldObject(
            i,
            name := names[int(rng.integers(len(names)))],
            x_m,
            y_m,
            float(rng.uniform(0, 6.28)),
            OBJECT_CLASSES[name].size_m,
        )
        for i, (x_m, y_m) in enumerate(spots)
    ]
    wave = np.linspace(0.0, side_m, 200)
    bank = side_m * 0.62 + 12.0 * np.sin(wave / 70.0)
    river = np.concatenate((np.stack((wave, bank), 1), np.stack((wave, bank + 25.0), 1)[::-1]))
    keep = tuple(b for b in buildings if not (side_m * 0.62 - 30 < b.outer[:, 1].mean() < side_m * 0.62 + 55))
    return World(
        name=f"bench:{side_m:g}",
        bounds=Bounds(0.0, 0.0, side_m, side_m),
        regions=(
            Region(Ground.GRASS, np.asarray([(0.0, 0.0), (side_m, 0.0), (side_m, side_m), (0.0, side_m)])),
            Region(Ground.WATER, river),
        ),
        ways=tuple(ways),
        buildings=keep,
        objects=tuple(objects),
    )


def _houses(rng: np.random.Generator, x_m: float, y_m: float) -> Iterator[Building]:
    """Yield the houses around a block: four wings with gaps between them, slightly turned."""
    inner = _BLOCK_M - 18.0
    middle = np.asarray([x_m + _BLOCK_M / 2, y_m + _BLOCK_M / 2])
    angle = float(rng.uniform(-0.06, 0.06))
    turn = np.asarray([(math.cos(angle), -math.sin(angle)), (math.sin(angle), math.cos(angle))])
    half, deep = inner / 2 - 3.0, 13.0
    for k in range(4):
        gap = float(rng.uniform(3.0, 12.0))
        wing: Ring = np.asarray(
            [(-half + gap, half), (-half + gap, half - deep), (half - deep - 4, half - deep), (half - deep - 4, half)]
        )
        quarter = np.asarray(
            [
                (math.cos(k * math.pi / 2), -math.sin(k * math.pi / 2)),
                (math.sin(k * math.pi / 2), math.cos(k * math.pi / 2)),
            ]
        )
        yield Building(middle + wing @ quarter.T @ turn.T, 15.0)


def _street_spots(
    rng: np.random.Generator, side_m: float, lines: list[float], *, count: int
) -> Iterator[tuple[float, float]]:
    for _ in range(count):
        along, line = float(rng.uniform(1.0, side_m - 1.0)), lines[int(rng.integers(1, len(lines) - 1))]
        across = line + float(rng.choice((-1.0, 1.0))) * float(rng.uniform(5.0, 7.0))
        yield (along, across) if rng.random() < 0.5 else (across, along)


Line = tuple[str, float, float, str]


def _raster(repeats: int, *, quick: bool) -> Iterator[Line]:
    for side_m, aim_ms in ((1000.0, 60.0),) if quick else ((1000.0, 60.0), (3162.0, 600.0)):
        world = city(side_m)
        yield (
            f"ground raster, {world.bounds.area_km2:.0f} km² at 0.5 m, {len(world.buildings)} buildings",
            _median_s(partial(GroundRaster.of, world), repeats) * 1e3,
            aim_ms,
            "ms",
        )


def _index(repeats: int, *, quick: bool) -> Iterator[Line]:
    world = city(1000.0 if quick else 3162.0)
    index = ObjectIndex.of(world)
    rng = np.random.Generator(np.random.PCG64(2))
    spots = [(float(x), float(y)) for x, y in rng.uniform(200.0, world.bounds.max_x_m - 200.0, (200, 2))]
    for radius_m, aim_us in ((80.0, 20.0), (15.0, 20.0)):
        hits = statistics.mean(len(index.within(x, y, radius_m)) for x, y in spots)
        run = _median_s(partial(_ask, index, spots, radius_m), repeats)
        yield f"objects within {radius_m:g} m ({hits:.0f} hits of {len(index)})", run / len(spots) * 1e6, aim_us, "µs"
    run = _median_s(lambda: [index.nearest(x, y, class_names=("bench",)) for x, y in spots], repeats)
    yield "nearest bench", run / len(spots) * 1e6, 40.0, "µs"
    yield (
        f"building the index of {len(index)} objects",
        _median_s(lambda: ObjectIndex.of(world), repeats) * 1e3,
        200.0,
        "ms",
    )


def _ask(index: ObjectIndex, spots: list[tuple[float, float]], radius_m: float) -> None:
    for x_m, y_m in spots:
        index.within(x_m, y_m, radius_m)


def _paths(repeats: int, *, quick: bool) -> Iterator[Line]:
    world = city(1000.0 if quick else 3162.0)
    geodesics = Geodesics.of(world, GroundRaster.of(world))
    for what, shunned in (("any ground", frozenset[Ground]()), ("off the grass", frozenset({Ground.GRASS}))):
        start = time.process_time()
        space = geodesics.space(_WALKER, shunned=shunned)
        _ = space.stretches
        yield (
            f"free space, {world.bounds.area_km2:.0f} km², {what} (once)",
            (time.process_time() - start) * 1e3,
            1000.0,
            "ms",
        )
        pairs = _pairs(geodesics, shunned, 400.0, 40)
        times = sorted(
            _median_s(partial(geodesics.path, a, b, traveller=_WALKER, shunned=shunned), repeats) * 1e3
            for a, b in pairs
        )
        yield (
            f"way of 400 m in {world.bounds.area_km2:.0f} km², {what}: median of 40",
            statistics.median(times),
            15.0,
            "ms",
        )
        yield f"way of 400 m in {world.bounds.area_km2:.0f} km², {what}: slowest of 40", times[-1], 15.0, "ms"


def _pairs(
    geodesics: Geodesics, shunned: frozenset[Ground], distance_m: float, count: int
) -> list[tuple[tuple[float, float], tuple[float, float]]]:
    """Return connected pairs of points whose way is about so long."""
    rng = np.random.Generator(np.random.PCG64(3))
    side_m = geodesics.grid.cols * geodesics.grid.cell_m
    pairs: list[tuple[tuple[float, float], tuple[float, float]]] = []
    while len(pairs) < count:
        a = (float(rng.uniform(0.0, side_m)), float(rng.uniform(0.0, side_m)))
        angle = float(rng.uniform(0.0, 2.0 * math.pi))
        b = (a[0] + 0.88 * distance_m * math.cos(angle), a[1] + 0.88 * distance_m * math.sin(angle))
        length_m = geodesics.distance_m(a, b, traveller=_WALKER, shunned=shunned)
        if 0.85 * distance_m < length_m < 1.15 * distance_m:
            pairs.append((a, b))
    return pairs


def _field(repeats: int, *, quick: bool) -> Iterator[Line]:
    world = city(1000.0 if quick else 1414.0)
    geodesics = Geodesics.of(world, GroundRaster.of(world))
    side_m = world.bounds.max_x_m
    rng = np.random.Generator(np.random.PCG64(4))
    aim_s = 0.3 * world.bounds.area_km2
    geodesics.field_m((side_m / 2, side_m / 2), traveller=_WALKER)
    for what, targets in (
        ("one target", [(side_m / 2, side_m / 2)]),
        ("30 targets", [(float(x), float(y)) for x, y in rng.uniform(0.0, side_m, (30, 2))]),
    ):
        run = _median_s(partial(geodesics.field_m, targets, traveller=_WALKER), repeats)
        yield f"field of the whole world, {world.bounds.area_km2:.0f} km², {what}", run, aim_s, "s"
        walk = Traveller(flies=False, radius_m=0.35, collides=False)
        run = _median_s(partial(geodesics.field_m, targets, traveller=walk), repeats)
        yield f"the same with nothing in the way, {what}", run, aim_s, "s"


def _files(repeats: int, *, quick: bool) -> Iterator[Line]:  # noqa: ARG001 - one size only
    import tempfile
    from pathlib import Path

    from reasoned_explorer.world.files import load_world, save_world

    world = city(1000.0)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "city.rexworld"
        yield "saving 1 km²", _median_s(lambda: save_world(world, path), repeats) * 1e3, 500.0, "ms"
        yield "loading 1 km²", _median_s(lambda: load_world(path), repeats) * 1e3, 500.0, "ms"


def _median_s(run: Callable[[], object], repeats: int) -> float:
    run()
    times = []
    for _ in range(repeats):
        start = time.process_time()
        run()
        times.append(time.process_time() - start)
    return statistics.median(times)


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeats", type=int, default=5, help="runs of which the median is taken")
    parser.add_argument("--quick", action="store_true", help="small worlds only")
    return parser.parse_args()


if __name__ == "__main__":
    main()
