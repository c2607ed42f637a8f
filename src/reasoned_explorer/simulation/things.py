"""What eyes need to know of a world's objects beyond where they stand: worked out once for each world."""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import numpy as np

from reasoned_explorer.world.sight import make_grid

if TYPE_CHECKING:
    from reasoned_explorer.world.atlas import Atlas
    from reasoned_explorer.world.sight import SightLines
    from reasoned_explorer.world.sight_kernels import Grid
    from reasoned_explorer.world.world import World

_SEAT_CELL_M = 12.0
_COVERS = frozenset({"tree", "shelter", "outdoor_seating"})
_UNCOVERED_KINDS = frozenset({"plant", "place", "area"})


@dataclass(frozen=True, slots=True, eq=False)
class Things:
    """What eyes need to know of a world's objects, in their order.

    Attributes:
        seats: A grid over the squares that enclose their footprints.
        classes: Their classes.
        names: Their names; empty where they have none.
        under: The class of what stands over each, or None.
    """

    seats: "Grid"
    classes: tuple[str, ...]
    names: tuple[str, ...]
    under: tuple[str | None, ...]


#: Worked out once for each world (its sight lines stand for it), since many missions share one.
_THINGS: "WeakKeyDictionary[SightLines, Things]" = WeakKeyDictionary()


def things_of(atlas: "Atlas") -> Things:
    """Return what eyes need to know of a world's objects."""
    if atlas.sight not in _THINGS:
        world = atlas.world
        classes = tuple(item.class_name for item in world.objects)
        names = tuple(str(item.attributes.get("name", "")) for item in world.objects)
        _THINGS[atlas.sight] = Things(_seats(world), classes, names, tuple(_cover_classes(world)))
    return _THINGS[atlas.sight]


def _seats(world: "World") -> "Grid":
    """A grid over the squares that enclose the objects' footprints."""
    items = np.zeros((len(world.objects), 8))
    items[:, 0] = 2.0
    for item in world.objects:
        x_m, y_m = item.x_m, item.y_m
        # A place's front is moved onto its wall, at most a little.
        reach_m = 0.5 * math.hypot(item.size_m[0], item.size_m[1]) + 1.0
        if item.outline is not None and len(item.outline) >= 3 and item.object_class.kind == "area":
            (west, south), (east, north) = item.outline.min(axis=0), item.outline.max(axis=0)
            x_m, y_m = 0.5 * (west + east), 0.5 * (south + north)
            reach_m = 0.5 * math.hypot(east - west, north - south) + 0.1
        items[item.id, 1:4] = x_m, y_m, reach_m
    return make_grid(items, np.zeros((len(items), 3), dtype=np.int64), cell_m=_SEAT_CELL_M)


def _cover_classes(world: "World") -> list[str | None]:
    """For each object the class of what stands over it, or None."""
    from reasoned_explorer.simulation.eyes_kernels import covered_by

    covers = [item for item in world.objects if item.class_name in _COVERS]
    under: list[str | None] = [None] * len(world.objects)
    if not covers:
        return under
    items = np.zeros((len(covers), 8))
    items[:, 0] = 1.0
    for row, item in zip(items, covers, strict=True):
        row[1:7] = item.x_m, item.y_m, 0.25 * (item.size_m[0] + item.size_m[1]), 0.0, 0.0, item.size_m[2]
    grid = make_grid(items, np.zeros((len(items), 3), dtype=np.int64), cell_m=_SEAT_CELL_M)
    below = [item for item in world.objects if item.object_class.kind not in _UNCOVERED_KINDS]
    columns = np.array([(item.x_m, item.y_m, item.size_m[2]) for item in below]).reshape(-1, 3).T.copy()
    for item, row in zip(below, covered_by(grid, *columns).tolist(), strict=True):
        if row >= 0 and covers[row].id != item.id:
            under[item.id] = covers[row].class_name
    return under
