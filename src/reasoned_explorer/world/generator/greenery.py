"""Trees and bushes: rows along streets, promenades and quays, woods, groves, hedges, gardens."""

from collections.abc import Iterator

import numpy as np
import shapely
from numpy.typing import NDArray

from reasoned_explorer.world.generator import planar
from reasoned_explorer.world.generator.ground import GroundPlan
from reasoned_explorer.world.generator.shapes import Points, along, left_of, spread, thin
from reasoned_explorer.world.generator.sketch import Sketch
from reasoned_explorer.world.taxonomy import Ground

#: Spacing of trees by what a patch is for, metres, and the share of the sites that are planted. Assumed.
_PLANTING: dict[str, tuple[float, float]] = {
    "wood": (8.5, 0.85),
    "grove": (13.0, 0.5),
    "park": (26.0, 0.35),
    "meadow": (32.0, 0.3),
    "picnic": (18.0, 0.45),
    "campus": (25.0, 0.35),
    "lawn": (20.0, 0.3),
    "garden": (14.0, 0.35),
    "gardens": (19.0, 0.45),
    "courtyard": (16.0, 0.2),
    "strip": (12.0, 0.5),
    "verge": (10.0, 0.45),
    "corner": (9.0, 0.5),
    "plaza": (22.0, 0.15),
    "forecourt": (18.0, 0.2),
    "gap": (10.0, 0.35),
}
_BUSHES: dict[str, tuple[float, float]] = {
    "garden": (7.0, 0.35),
    "gardens": (10.0, 0.3),
    "wood": (14.0, 0.4),
    "park": (30.0, 0.3),
    "verge": (6.0, 0.3),
    "campus": (26.0, 0.3),
    "courtyard": (12.0, 0.2),
}
#: Points, diameters of crowns, margin to paths.
_Stand = tuple[Points, NDArray[np.float64], float]
_TREE_GROUND = (Ground.GRASS, Ground.WOOD, Ground.GARDEN, Ground.YARD, Ground.PLAZA, Ground.PAVEMENT)


def plant_trees(sketch: Sketch, plan: GroundPlan) -> tuple[Points, NDArray[np.float64]]:
    """Return where trees stand, shape (n, 2), and the diameters of their crowns, metres."""
    stands = [*_street_trees(sketch), *_alleys(sketch), *_patch_trees(sketch)]
    if not stands:
        return np.empty((0, 2)), np.empty(0)
    points = np.vstack([at for at, _, _ in stands])
    crowns = np.concatenate([crown for _, crown, _ in stands])
    clear = np.concatenate([np.full(len(at), margin) for at, _, margin in stands])
    good = np.isin(plan.at(points), _TREE_GROUND) & shapely.contains_xy(planar.buffer(sketch.box, -0.6), points)
    good &= _clear_of_paths(sketch, points, clear)
    good &= ~plan.by_a_wall(points, 2.2)
    points, crowns = points[good], crowns[good]
    kept = thin(points, 3.4)
    diameters: NDArray[np.float64] = np.round(np.clip(crowns[kept], 2.5, 13.0), 1)
    return points[kept], diameters


def _street_trees(sketch: Sketch) -> Iterator[_Stand]:
    for index, street in enumerate(sketch.streets):
        if street.trees <= 0:
            continue
        rng = sketch.rng("street trees", index)
        at, tangents = along(street.line, street.trees, start_m=6.0, end_m=6.0)
        # Close to the kerb, so that beside the trunk there is room to walk.
        offset = (street.road_m / 2 + 0.6 if street.road_m > 0 else 2.6) * left_of(tangents)
        for side in (1.0, -1.0):
            keep = rng.random(len(at)) < 0.8
            yield (at + side * offset)[keep], rng.uniform(3.6, 6.0, int(keep.sum())), 0.5


def _alleys(sketch: Sketch) -> Iterator[_Stand]:
    for index, trail in enumerate(sketch.trails):
        if trail.width_m >= 4.4 and trail.ground == Ground.PATH:
            rng = sketch.rng("alley", index)
            at, tangents = along(trail.line, 8.5, start_m=5.0, end_m=5.0)
            offset = left_of(tangents) * (trail.width_m / 2 + 2.2)
            for side in (1.0, -1.0):
                yield at + side * offset, rng.uniform(5.5, 7.5, len(at)), 0.5


def _patch_trees(sketch: Sketch) -> Iterator[_Stand]:
    for index, patch in enumerate(sketch.patches):
        if patch.role in _PLANTING:
            rng = sketch.rng("patch trees", index)
            spacing, share = _PLANTING[patch.role]
            at = spread(rng, planar.buffer(patch.area, -1.5), spacing)
            at = at[rng.random(len(at)) < share]
            yield at, rng.gamma(9.0, 0.62, len(at)) + 1.2, 0.6 if patch.role == "wood" else 1.0


def plant_bushes(sketch: Sketch, plan: GroundPlan) -> tuple[Points, NDArray[np.float64]]:
    """Return where bushes stand, shape (n, 2), and their diameters, metres."""
    spots, sizes = [], []
    for index, patch in enumerate(sketch.patches):
        if patch.role in _BUSHES:
            rng = sketch.rng("bushes", index)
            spacing, share = _BUSHES[patch.role]
            at = spread(rng, planar.buffer(patch.area, -1.0), spacing)
            at = at[rng.random(len(at)) < share]
            spots.append(at)
            sizes.append(rng.uniform(0.8, 2.0, len(at)))
    if not spots:
        return np.empty((0, 2)), np.empty(0)
    points = np.vstack(spots)
    width: NDArray[np.float64] = np.round(np.concatenate(sizes).astype(float), 1)
    good = np.isin(plan.at(points), (Ground.GRASS, Ground.WOOD, Ground.GARDEN, Ground.YARD))
    good &= shapely.contains_xy(planar.buffer(sketch.box, -1.2), points)
    good &= _clear_of_paths(sketch, points, np.full(len(points), 1.3))
    good &= ~plan.by_a_wall(points, 1.3)
    return points[good], width[good]


def _clear_of_paths(sketch: Sketch, points: Points, margins: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return which points keep a margin from trails, crossings and carriageways."""
    clear = np.ones(len(points), bool)
    lines = [(trail.line, trail.width_m) for trail in [*sketch.trails, *sketch.crossings]]
    lines += [(street.line, street.road_m) for street in sketch.streets if street.road_m > 0]
    if not lines or not len(points):
        return clear
    beds = planar.buffer(
        [shapely.LineString(line) for line, _ in lines],
        np.array([width / 2 for _, width in lines]) + 0.5,
        quad_segs=2,
        cap_style="flat",
    )
    point, _ = shapely.STRtree(beds).query(shapely.points(points), predicate="intersects")
    clear[point] = False
    wide = np.flatnonzero(clear & (margins > 0.8))
    point, _ = shapely.STRtree(beds).query(shapely.points(points[wide]), predicate="dwithin", distance=0.3)
    clear[wide[point]] = False
    return clear
