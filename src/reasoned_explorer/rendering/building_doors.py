"""Doors at the entrances of many buildings."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from reasoned_explorer.rendering.building_roofs import Roofs
from reasoned_explorer.rendering.building_styles import Family, Styles
from reasoned_explorer.rendering.footprints import Bools, Floats, Footprints, Ints
from reasoned_explorer.rendering.material import Material
from reasoned_explorer.rendering.patches import Patch, boxes
from reasoned_explorer.rendering.wall_spots import Finish, Spots, panels, runs
from reasoned_explorer.world.world import Building

#: An entrance farther than this from its building's walls is none of theirs, metres.
_FAR_M = 1.5
_STEP = np.array((0.66, 0.65, 0.62))
_PANE, _HANDLE = np.array((0.24, 0.30, 0.36)), np.array((0.80, 0.77, 0.70))


@dataclass(frozen=True, slots=True, eq=False)
class _Doors:
    """Doors: where, how large, and whether they are of a house that many people enter."""

    spots: Spots
    wide_m: Floats
    high_m: Floats
    wall_m: Floats
    grand: Bools
    sheltered: Bools


def doors(
    buildings: Sequence[Building], prints: Footprints, styles: Styles, roofs: Roofs, *, fine: bool
) -> list[Patch]:
    """Return a door at every entrance, and one where none is known; ``fine``: with frames, panes and a step."""
    found = _doors_of(buildings, prints, styles, roofs)
    leaf = Finish(styles.door_colour[found.spots.owners], int(Material.WOOD))
    leaves = panels(found.spots.moved(out_m=0.07), leaf, wide_m=found.wide_m, low_m=0.0, high_m=found.high_m)
    return [leaves, *_frames(found, styles), *_fittings(found)] if fine else [leaves]


def _doors_of(buildings: Sequence[Building], prints: Footprints, styles: Styles, roofs: Roofs) -> _Doors:
    edges, distances = _door_places(buildings, prints)
    spots = Spots.on(prints, edges, distances)
    wall = (roofs.eaves_m - styles.base_m)[spots.owners]
    stands = (styles.base_m[spots.owners] < 0.5) & (wall > 2.1) & (styles.family[spots.owners] != Family.CANOPY)
    spots, wall, edges = spots.where(stands), wall[stands], edges[stands]
    family = styles.family[spots.owners]
    grand = np.isin(family, [Family.OFFICE, Family.CHURCH, Family.SHOP, Family.HALL])
    wide = np.minimum(np.where(grand, 1.9, 1.15), 0.85 * prints.lengths[edges])
    high = np.minimum(np.select([family == Family.CHURCH, grand], [3.1, 2.5], 2.15), wall - 0.1)
    sheltered = (~grand | (family == Family.OFFICE)) & (high + 0.5 < wall)
    return _Doors(spots, wide, high, wall, grand, sheltered)


def _frames(found: _Doors, styles: Styles) -> list[Patch]:
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


def _fittings(found: _Doors) -> list[Patch]:
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


def _door_places(buildings: Sequence[Building], prints: Footprints) -> tuple[Ints, Floats]:
    """Return the edges in which doors are, and how far from where the edge begins."""
    counts = np.array([len(one.entrances) for one in buildings], dtype=np.int64)
    points = np.concatenate([np.empty((0, 2)), *(one.entrances for one in buildings if len(one.entrances))])
    edges, distances = _nearest_edges(prints, points, np.repeat(np.arange(len(buildings)), counts))
    # A building with no known entrance gets one in the middle of its longest wall.
    outer = np.where(prints.in_court, -1.0, prints.lengths)
    order = np.lexsort((outer, prints.owners))
    longest = order[_last_of_runs(prints.owners[order])]
    longest = longest[(counts[prints.owners[longest]] == 0) & (prints.lengths[longest] > 2.0)]
    return np.concatenate([edges, longest]), np.concatenate([distances, prints.lengths[longest] / 2.0])


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


def _last_of_runs(values: Ints) -> Bools:
    """Return which of sorted values are the last of their kind."""
    return np.append(values[1:] != values[:-1], True)[: len(values)]
