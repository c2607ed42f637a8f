"""Count, in real places, what stands near what: writes `src/reasoned_explorer/knowledge/cooccurrence.json`.

    python scripts/compute_cooccurrence.py helsinki-centre.osm.pbf munich-centre.osm.pbf

Only these two are meant to go in: other places judge what was learnt from them.

How. In every place, points are drawn evenly over the bounds (seeded); those not in a building are its *open ground*.
Everything is compared with them:

- ``class_given_class[a][b]``: the number of other b within 20 m of an a, summed over all a, over the number that one
  would expect there: the mean number of b within 20 m of a land point, times the land that lies within 20 m of the a
  (an a by a wall has less of it), over the land within 20 m of a land point on average. Observed and expected are added
  up over the places before they are divided, so each place is compared with itself. ``..._ahead``: the same, 10-30 m.
- ``class_near_ground[g][c]``: the share of the c with ground g within 20 m over the share of the open points.
- ``class_on_ground[g][c]``: the share of the c that stand on g over the share of the open points that do.
- Shrinking: every lift is (observed + 4) / (expected + 4), as if 4 more had been seen and expected; a pair of which
  neither 4 were seen nor 4 expected is left out, which reads as 1.

Lawns, playgrounds and pitches count as the areas that they are, places (cafes, shops …) as their doors.
"""

import argparse
import json
import math
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from reasoned_explorer.model.draws import key_of
from reasoned_explorer.world.osm.buildings import WALK_UNDER_M
from reasoned_explorer.world.osm.importer import ATTRIBUTION, import_osm_with_report
from reasoned_explorer.world.taxonomy import CLASS_NAMES, Ground
from reasoned_explorer.world.world import World, WorldObject

RADIUS_M = 20.0
AHEAD_M = (10.0, 30.0)
POINTS_PER_KM2 = 40_000
PSEUDO_COUNT = 4.0
SEED = 0
#: Where the two extracts are whole (lon0, lat0, lon1, lat1); a file of another name is taken as a whole.
BBOXES = {
    "helsinki-centre": (24.9352, 60.1642, 24.9534, 60.1791),
    "munich-centre": (11.5657, 48.1314, 11.5861, 48.1434),
}
_TARGET = Path(__file__).resolve().parents[1] / "src" / "reasoned_explorer" / "knowledge" / "cooccurrence.json"
_FOOT = frozenset({Ground.PAVEMENT, Ground.PLAZA, Ground.PATH, Ground.CYCLEWAY, Ground.STEPS})

Ints = NDArray[np.intp]
Floats = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Place:
    """A world made ready for counting.

    Attributes:
        world: The world.
        shapes: Shapely point or polygon of each object.
        codes: Class code of each object.
        points: Points on open ground.
        all_points: All of them, those in buildings too.
        ground: Ground code of all points.
        object_ground: Ground code below each object.
        open_km2: Area of the open ground.
    """

    world: World
    shapes: NDArray[np.object_]
    codes: Ints
    points: NDArray[np.object_]
    all_points: NDArray[np.object_]
    ground: Ints
    object_ground: Ints
    open_km2: float


def prepare(world: World) -> Place:
    """Draw points over a world and find the ground below them and below its objects."""
    bounds = world.bounds
    random = np.random.Generator(np.random.PCG64(key_of(SEED, "co-occurrence", world.name)))
    count = round(POINTS_PER_KM2 * bounds.area_km2)
    x_m = bounds.min_x_m + bounds.width_m * random.random(count)
    y_m = bounds.min_y_m + bounds.height_m * random.random(count)
    all_points = shapely.points(x_m, y_m)
    layers = _layers(world)
    ground = _ground_at(all_points, layers)
    is_open = ground != Ground.BUILDING
    shapes = np.empty(len(world.objects), dtype=object)
    shapes[:] = [_shape(item) for item in world.objects]
    places = shapely.points([(item.x_m, item.y_m) for item in world.objects])
    codes = np.array([CLASS_NAMES.index(item.class_name) for item in world.objects], dtype=np.intp)
    return Place(
        world=world,
        shapes=shapes,
        codes=codes,
        points=all_points[is_open],
        all_points=all_points,
        ground=ground,
        object_ground=_ground_at(places, layers),
        open_km2=bounds.area_km2 * float(is_open.mean()),
    )


def _shape(item: WorldObject) -> Any:
    if item.object_class.kind == "area" and item.outline is not None:
        return shapely.make_valid(shapely.Polygon(item.outline))
    return shapely.Point(item.x_m, item.y_m)


def _layers(world: World) -> tuple[Any, Ints]:
    """Return everything that makes ground, from below, as a tree of polygons, and their ground codes."""
    shapes = [shapely.Polygon(region.outer, list(region.holes)) for region in world.regions]
    grounds = [int(region.ground) for region in world.regions]
    for way in world.ways:
        if way.level == 0:
            shapes.append(shapely.buffer(shapely.LineString(way.line), way.width_m / 2.0))
            grounds.append(int(way.ground))
    for building in world.buildings:
        if building.min_height_m <= WALK_UNDER_M:
            shapes.append(shapely.Polygon(building.outer, list(building.holes)))
            grounds.append(int(Ground.BUILDING))
    return shapely.STRtree(shapes), np.array(grounds, dtype=np.intp)


def _ground_at(points: Any, layers: tuple[Any, Ints]) -> Ints:
    tree, grounds = layers
    top = np.full(len(points), -1, dtype=np.intp)
    at, layer = tree.query(points, predicate="intersects")
    np.maximum.at(top, at, layer)
    return np.where(top >= 0, grounds[top], int(Ground.UNKNOWN))


def _counts(of: Any, near: Any, codes: Ints, low_m: float, high_m: float, *, same: bool = False) -> Floats:
    """Return, shape (n, classes), how many objects of each class lie between two distances of each of n shapes."""
    at, other = shapely.STRtree(near).query(of, predicate="dwithin", distance=high_m)
    if same:
        kept = at != other
        at, other = at[kept], other[kept]
    if low_m > 0.0:
        kept = shapely.distance(of[at], near[other]) > low_m
        at, other = at[kept], other[kept]
    table = np.zeros((len(of), len(CLASS_NAMES)))
    np.add.at(table, (at, codes[other]), 1.0)
    return table


def _open_around(of: Any, points: Any, low_m: float, high_m: float) -> Floats:
    """Return how many open points lie between two distances of each shape."""
    at, other = shapely.STRtree(points).query(of, predicate="dwithin", distance=high_m)
    if low_m > 0.0:
        at = at[shapely.distance(of[at], points[other]) > low_m]
    return np.bincount(at, minlength=len(of)).astype(np.float64)


def pair_counts(place: Place, low_m: float, high_m: float) -> tuple[Floats, Floats]:
    """Return observed and expected numbers, shape (classes, classes): row a, column b."""
    seen = _counts(place.shapes, place.shapes, place.codes, low_m, high_m, same=True)
    anywhere = _counts(place.points, place.shapes, place.codes, low_m, high_m).mean(axis=0)
    own = _open_around(place.shapes, place.points, low_m, high_m)
    usual = float(_open_around(place.points, place.points, low_m, high_m).mean())
    observed = np.zeros((len(CLASS_NAMES), len(CLASS_NAMES)))
    np.add.at(observed, place.codes, seen)
    around = np.bincount(place.codes, weights=own, minlength=len(CLASS_NAMES)) / usual
    return observed, around[:, None] * anywhere[None, :]


def ground_counts(place: Place) -> tuple[Floats, Floats, Floats, Floats]:
    """Return observed and expected, shape (grounds, classes), of ground near and of ground below."""
    shape = (len(Ground), len(CLASS_NAMES))
    number = np.bincount(place.codes, minlength=len(CLASS_NAMES)).astype(np.float64)
    near, near_expected, on, on_expected = (np.zeros(shape) for _ in range(4))
    is_open = place.ground != Ground.BUILDING
    outside = place.object_ground != Ground.BUILDING
    np.add.at(on, (place.object_ground[outside], place.codes[outside]), 1.0)
    for ground in Ground:
        chosen = place.all_points[place.ground == ground]
        if not len(chosen):
            continue
        tree = shapely.STRtree(chosen)
        hit = np.unique(tree.query(place.shapes, predicate="dwithin", distance=RADIUS_M)[0])
        np.add.at(near[ground], place.codes[hit], 1.0)
        any_hit = np.unique(tree.query(place.points, predicate="dwithin", distance=RADIUS_M)[0])
        near_expected[ground] = number * len(any_hit) / len(place.points)
        on_expected[ground] = on.sum(axis=0) * float((place.ground[is_open] == ground).mean())
    return near, near_expected, on, on_expected


def lifts(observed: Floats, expected: Floats, rows: list[str]) -> dict[str, dict[str, float]]:
    """Return the shrunk lifts that there is evidence for."""
    table: dict[str, dict[str, float]] = {}
    for row, name in enumerate(rows):
        known = {
            other: rounded((observed[row, at] + PSEUDO_COUNT) / (expected[row, at] + PSEUDO_COUNT))
            for at, other in enumerate(CLASS_NAMES)
            if max(observed[row, at], expected[row, at]) >= PSEUDO_COUNT
        }
        if known:
            table[name] = known
    return table


def spacing(places: list[Place]) -> dict[str, float]:
    """Return the median distance to the next object of the same class."""
    found: dict[str, float] = {}
    for code, name in enumerate(CLASS_NAMES):
        gaps: list[float] = []
        for place in places:
            own = place.shapes[place.codes == code]
            if len(own) > 1:
                _, gap = shapely.STRtree(own).query_nearest(
                    own, exclusive=True, return_distance=True, all_matches=False
                )
                gaps += gap.tolist()
        if len(gaps) >= PSEUDO_COUNT:
            found[name] = rounded(float(np.median(gaps)))
    return found


def distances(places: list[Place]) -> dict[str, dict[str, float]]:
    """Return the median distance from the objects of a class to the next building, road and footway, to their edge."""
    gaps: dict[str, list[Floats]] = {"building": [], "road": [], "footway": []}
    for place in places:
        world = place.world
        level = [way for way in world.ways if way.level == 0]
        targets = {
            "building": [shapely.Polygon(one.outer, list(one.holes)) for one in world.buildings],
            "road": [_strip(way.line, way.width_m) for way in level if way.ground == Ground.ROAD],
            "footway": [_strip(way.line, way.width_m) for way in level if way.ground in _FOOT],
        }
        for name, shapes in targets.items():
            found = np.full(len(place.shapes), np.nan)
            if shapes:
                pair, gap = shapely.STRtree(shapes).query_nearest(place.shapes, return_distance=True, all_matches=False)
                found[pair[0]] = gap
            gaps[name].append(found)
    codes = np.concatenate([place.codes for place in places])
    table: dict[str, dict[str, float]] = {}
    for code, name in enumerate(CLASS_NAMES):
        if (codes == code).sum() >= PSEUDO_COUNT:
            table[name] = {
                target: rounded(float(np.nanmedian(np.concatenate(parts)[codes == code])))
                for target, parts in gaps.items()
            }
    return table


def _strip(line: Any, width_m: float) -> Any:
    return shapely.buffer(shapely.LineString(line), width_m / 2.0)


def rounded(value: float) -> float:
    """Return a number with three significant digits."""
    if value == 0.0 or not math.isfinite(value):
        return 0.0
    return round(value, 2 - math.floor(math.log10(abs(value))))


def compute(places: list[Place], sources: list[dict[str, str | int | float]]) -> dict[str, Any]:
    """Return the statistics of some places as what is written to the file."""
    near = [sum(parts) for parts in zip(*(pair_counts(place, 0.0, RADIUS_M) for place in places), strict=True)]
    ahead = [sum(parts) for parts in zip(*(pair_counts(place, *AHEAD_M) for place in places), strict=True)]
    grounds = [sum(parts) for parts in zip(*(ground_counts(place) for place in places), strict=True)]
    names, ground_names = list(CLASS_NAMES), [ground.name.lower() for ground in Ground]
    codes = np.concatenate([place.codes for place in places])
    open_km2 = sum(place.open_km2 for place in places)
    open_ground = np.concatenate([place.ground[place.ground != Ground.BUILDING] for place in places])
    shares = {name: float((open_ground == code).mean()) for code, name in enumerate(ground_names)}
    return {
        "schema": 1,
        "attribution": ATTRIBUTION,
        "sources": sources,
        "radius_m": RADIUS_M,
        "ahead_m": list(AHEAD_M),
        "density_per_km2": {
            name: rounded(float((codes == code).sum()) / open_km2)
            for code, name in enumerate(names)
            if (codes == code).any()
        },
        "class_given_class": lifts(np.asarray(near[0]), np.asarray(near[1]), names),
        "class_given_class_ahead": lifts(np.asarray(ahead[0]), np.asarray(ahead[1]), names),
        "class_near_ground": lifts(np.asarray(grounds[0]), np.asarray(grounds[1]), ground_names),
        "class_on_ground": lifts(np.asarray(grounds[2]), np.asarray(grounds[3]), ground_names),
        "ground_share": {name: rounded(share) for name, share in shares.items() if share > 0.0},
        "same_class_spacing_m": spacing(places),
        "distance_to": distances(places),
    }


def written(data: Mapping[str, Any]) -> str:
    """Return the statistics as the text of the file: one class a line, so that changes can be read."""
    lines = []
    for key, value in data.items():
        if isinstance(value, dict) and value and all(isinstance(row, dict) for row in value.values()):
            rows = ",\n".join(f"  {json.dumps(name)}: {json.dumps(row)}" for name, row in value.items())
            lines.append(f" {json.dumps(key)}: {{\n{rows}\n }}")
        else:
            lines.append(f" {json.dumps(key)}: {json.dumps(value, ensure_ascii=False)}")
    return "{\n" + ",\n".join(lines) + "\n}\n"


def main() -> int:
    parser = argparse.ArgumentParser(description="Count what stands near what on the map.")
    parser.add_argument("files", nargs="+", type=Path, metavar="FILE")
    parser.add_argument("--output", type=Path, default=_TARGET)
    arguments = parser.parse_args()
    places, sources = [], []
    for file in arguments.files:
        stem = file.name.split(".")[0]
        world, report = import_osm_with_report(file, bbox=BBOXES.get(stem), seed=SEED, name=stem)
        places.append(prepare(world))
        source: dict[str, str | int | float] = {
            "file": file.name,
            "objects": len(world.objects),
            "area_km2": rounded(world.bounds.area_km2),
            "newest_edit": report.newest_edit,
        }
        sources.append(source)
        print(f"{file.name}: {source['objects']} objects, {places[-1].open_km2:.3f} km² open", file=sys.stderr)
    text = written(compute(places, sources))
    arguments.output.write_text(text, encoding="utf-8")
    print(f"{arguments.output}: {len(text)} characters", file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
