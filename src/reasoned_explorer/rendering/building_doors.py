"""Doors at the entrances of many buildings."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely

from reasoned_explorer.rendering.building_roofs import Roofs
from reasoned_explorer.rendering.building_styles import Family, Styles
from reasoned_explorer.rendering.crossings import segments_of
from reasoned_explorer.rendering.footprints import Bools, Floats, Footprints, Ints
from reasoned_explorer.rendering.fronts import NO_FRONTS, clear_of
from reasoned_explorer.rendering.material import Material
from reasoned_explorer.rendering.patches import Patch, boxes
from reasoned_explorer.rendering.wall_spots import Finish, Spots, panels, runs
from reasoned_explorer.world.world import Building, Way

#: An entrance farther than this from its building's walls is none of theirs, metres.
_FAR_M = 1.5
#: Doors nearer to each other than this would overlap; this clear of a place's front, metres.
_APART_M, _BESIDE_FRONT_M = 2.6, 0.8
#: Of a building without known entrances: how many of its longest walls may have the door, at least how long, and how
#: much of what lies before them must be open, metres.
_WALLS_TRIED, _LEAST_WALL_M, _OPEN_M = 6, 2.0, 0.9
#: A way farther off than this draws no door, metres.
_FARTHEST_WAY_M = 60.0
_STEP = np.array((0.66, 0.65, 0.62))
_PANE, _HANDLE = np.array((0.24, 0.30, 0.36)), np.array((0.80, 0.77, 0.70))


@dataclass(frozen=True, slots=True, eq=False)
class Surroundings:
    """What stands and runs around buildings.

    Attributes:
        fronts: Stretches of walls with fronts of places (`reasoned_explorer.rendering.fronts.walls_taken`), shape
            (n, 3). Nothing else is drawn there.
        ways: Doors that no map knows lead out to them.
    """

    fronts: Floats
    ways: Sequence[Way]


#: Of a building that stands alone.
NOTHING_AROUND = Surroundings(NO_FRONTS, ())


@dataclass(frozen=True, slots=True, eq=False)
class Doors:
    """Doors: where, how large, and whether they are of a house that many people enter."""

    spots: Spots
    wide_m: Floats
    high_m: Floats
    wall_m: Floats
    grand: Bools
    sheltered: Bools


def doors_of(
    buildings: Sequence[Building], prints: Footprints, styles: Styles, roofs: Roofs, around: Surroundings
) -> Doors:
    """Find the doors of buildings: one at every entrance that no place's front takes, and one where none is known."""
    edges, distances = _door_places(buildings, prints, around)
    spots = Spots.on(prints, edges, distances)
    wall = (roofs.eaves_m - styles.base_m)[spots.owners]
    stands = (styles.base_m[spots.owners] < 0.5) & (wall > 2.1) & (styles.family[spots.owners] != Family.CANOPY)
    stands &= clear_of(spots.places, around.fronts, _BESIDE_FRONT_M)
    spots, wall, edges = spots.where(stands), wall[stands], edges[stands]
    family = styles.family[spots.owners]
    grand = np.isin(family, [Family.OFFICE, Family.CHURCH, Family.SHOP, Family.HALL])
    wide = np.minimum(np.where(grand, 1.9, 1.15), 0.85 * prints.lengths[edges])
    high = np.minimum(np.select([family == Family.CHURCH, grand], [3.1, 2.5], 2.15), wall - 0.1)
    sheltered = (~grand | (family == Family.OFFICE)) & (high + 0.5 < wall)
    return Doors(spots, wide, high, wall, grand, sheltered)


def doors(found: Doors, styles: Styles, *, fine: bool) -> list[Patch]:
    """Return what doors look like; ``fine``: with frames, panes and a step."""
    leaf = Finish(styles.door_colour[found.spots.owners], int(Material.WOOD))
    leaves = panels(found.spots.moved(out_m=0.07), leaf, wide_m=found.wide_m, low_m=0.0, high_m=found.high_m)
    return [leaves, *_frames(found, styles), *_fittings(found)] if fine else [leaves]


def _frames(found: Doors, styles: Styles) -> list[Patch]:
    """Return jambs and a lintel around each door, and a small roof above some."""
    trim = styles.trim_colour[found.spots.owners]
    top = np.minimum(found.high_m + 0.16, found.wall_m)
    parts = [
        _blocks(
            found.spots.moved(aside_m=side * (found.wide_m / 2.0 + 0.08), out_m=0.06),
            Finish(trim, int(Material.PLASTER)),
            size_m=(0.16, 0.2),
            low_m=0.0,
            high_m=top,
        )
        for side in (-1.0, 1.0)
    ]
    parts.append(
        _blocks(
            found.spots.moved(out_m=0.06),
            Finish(trim, int(Material.PLASTER)),
            size_m=(found.wide_m, 0.2),
            low_m=found.high_m,
            high_m=top,
            bottom=True,
        )
    )
    under = found.sheltered
    parts.append(
        _blocks(
            found.spots.moved(out_m=0.45).where(under),
            Finish(trim[under] * 0.8, int(Material.METAL)),
            size_m=(found.wide_m[under] + 0.7, 0.9),
            low_m=found.high_m[under] + 0.3,
            high_m=found.high_m[under] + 0.42,
            bottom=True,
        )
    )
    return parts


def _fittings(found: Doors) -> list[Patch]:
    """Return a step before each door, a pane in it and a handle on it."""
    step = _blocks(
        found.spots.moved(out_m=0.2),
        Finish(_STEP, int(Material.STONE)),
        size_m=(found.wide_m + 0.5, 0.5),
        low_m=0.0,
        high_m=0.12,
    )
    pane = panels(
        found.spots.moved(out_m=0.09),
        Finish(_PANE, int(Material.GLASS)),
        wide_m=found.wide_m * np.where(found.grand, 0.8, 0.5),
        low_m=found.high_m * np.where(found.grand, 0.14, 0.47),
        high_m=found.high_m * 0.92,
    )
    handle = panels(
        found.spots.moved(aside_m=0.36 * found.wide_m, out_m=0.11),
        Finish(_HANDLE, int(Material.METAL)),
        wide_m=0.06,
        low_m=0.95,
        high_m=1.2,
    )
    return [step, pane, handle]


def _blocks(
    spots: Spots,
    finish: Finish,
    *,
    size_m: tuple[Floats | float, Floats | float],
    low_m: Floats | float,
    high_m: Floats | float,
    bottom: bool = False,
) -> Patch:
    """Return boxes along walls: their length and width, metres."""
    return boxes(
        spots.places,
        spots.along,
        length_m=size_m[0],
        width_m=size_m[1],
        low_m=low_m,
        high_m=high_m,
        colours=finish.colours,
        materials=finish.materials,
        owners=spots.owners,
        bottom=bottom,
    )


def _door_places(buildings: Sequence[Building], prints: Footprints, around: Surroundings) -> tuple[Ints, Floats]:
    """Return the edges in which doors are, and how far from where the edge begins."""
    counts = np.array([len(one.entrances) for one in buildings], dtype=np.int64)
    points = np.concatenate([np.empty((0, 2)), *(one.entrances for one in buildings if len(one.entrances))])
    edges, distances = _nearest_edges(prints, points, np.repeat(np.arange(len(buildings)), counts))
    chosen = _likely_walls(prints, counts == 0, around)
    edges = np.concatenate([edges, chosen])
    distances = np.concatenate([distances, prints.lengths[chosen] / 2.0])
    order = np.lexsort((distances, edges))
    edges, distances = edges[order], distances[order]
    near = np.append(False, (np.diff(edges) == 0) & (np.diff(distances) < _APART_M))[: len(edges)]
    return edges[~near], distances[~near]


def _likely_walls(prints: Footprints, wanted: Bools, around: Surroundings) -> Ints:
    """Return for each wanted building the wall in whose middle a door is likely.

    It is one of the longest, no other building stands right before it, and the nearer to a way the better.
    """
    fits = wanted[prints.owners] & ~prints.in_court & (prints.lengths > _LEAST_WALL_M)
    edges = np.flatnonzero(fits)
    if not len(edges):
        return edges
    order = np.lexsort((edges, -prints.lengths[edges], prints.owners[edges]))
    edges = edges[order]
    first = np.searchsorted(prints.owners[edges], prints.owners[edges])
    edges = edges[np.arange(len(edges)) - first < _WALLS_TRIED]
    middles = (prints.corners[edges] + prints.corners[prints.after[edges]]) / 2.0
    before = middles + _OPEN_M * prints.outwards[edges]
    cost = 1000.0 * prints.cover(before) + _way_off(before, around.ways) - 0.5 * np.minimum(prints.lengths[edges], 12.0)
    order = np.lexsort((edges, cost, prints.owners[edges]))
    best: Ints = edges[order[np.unique(prints.owners[edges][order], return_index=True)[1]]]
    return best


def _way_off(points: Floats, ways: Sequence[Way]) -> Floats:
    """Return how far the nearest way on the ground is from points, at most `_FARTHEST_WAY_M`."""
    off = np.full(len(points), _FARTHEST_WAY_M)
    level = [way for way in ways if way.level == 0]
    if level:
        begins, ends, _ = segments_of(level)
        tree = shapely.STRtree(shapely.linestrings(np.stack([begins, ends], axis=1)))
        (at, _), gap = tree.query_nearest(
            shapely.points(points), max_distance=_FARTHEST_WAY_M, return_distance=True, all_matches=False
        )
        off[at] = gap
    return off


def _nearest_edges(prints: Footprints, points: Floats, owner: Ints) -> tuple[Ints, Floats]:
    """Return for each point that is near its building the nearest edge, and where on it, clear of its ends."""
    row, place = runs(prints.sizes[owner])
    edge = (np.cumsum(prints.sizes) - prints.sizes)[owner][row] + place
    length, away = prints.lengths[edge], points[row] - prints.corners[edge]
    distance = np.sum(away * prints.along[edge], axis=1)
    on = np.clip(distance, 0.0, length)
    gap = np.hypot(*(away - on[:, None] * prints.along[edge]).T)
    order = np.lexsort((edge, gap, row))
    best = order[np.unique(row[order], return_index=True)[1]]
    best = best[gap[best] < _FAR_M]
    clear = np.minimum(0.75, length[best] / 2.0)
    return edge[best], np.clip(distance[best], clear, length[best] - clear)
