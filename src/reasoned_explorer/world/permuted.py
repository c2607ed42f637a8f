"""Worlds whose labels are permuted in place: the same things at the same spots, but which is which says nothing.

A control. What stands near what, on what ground and by what building is here a matter of chance, so knowing what
stands near what in real places can be worth nothing, and an advantage of it that is measured all the same is none.

What is permuted:

- *Things* (all that is no area, doors of cafes and shops among them) trade class, size and attributes with one another,
  all with all: were doors to trade among doors only, knowing that cafes are where shops are would still pay. A spot
  keeps its place and its heading. What lands at a door and is no place stands before it, by half its depth and at most
  1.2 m, so that nothing stands in a wall; what is a place and lands in the open stands by itself, as a pavilion.
- *Areas* trade class and attributes with one another. Their outlines and sizes stay, and where the class changes the
  ground goes with it: a lawn is of grass. They do not trade with things: no fire hydrant is the size of a pitch.

What stays: buildings, ways, all other ground, and where things stand at all. *That* something stands somewhere can
still be told from ground and neighbours (paths, squares, clusters); *what* it is cannot. Things in a building's walls
by the map are left as they are.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import shapely

from reasoned_explorer.model import Fault, SettingsError
from reasoned_explorer.model.draws import key_of
from reasoned_explorer.world.raster import ROOF_CLEARANCE_M
from reasoned_explorer.world.taxonomy import Ground
from reasoned_explorer.world.world import Region, World, WorldObject

#: Between the name of a world and the seed of its permutation.
INFIX = "~permuted:"
_LARGEST_SEED = 10**18 - 1
#: What stands before a door is this far off the wall, metres, and half its depth further, but not more than the second.
_GAP_M, _HALF_DEPTH_M = 0.2, 1.0
_GROUND_OF = {"lawn": Ground.GRASS, "playground": Ground.PLAYGROUND, "pitch": Ground.PITCH}


def permute_labels(world: World, *, seed: int) -> World:
    """Return a world with its labels permuted in place (see the module's docstring).

    The number of objects of each class stays. The name gets ``~permuted:SEED`` behind it, which `open_world` reads.

    Args:
        world: The world; it is not changed.
        seed: Of the permutation, in [0, 10^18).

    Raises:
        SettingsError: If the seed is out of range.
    """
    if not 0 <= seed <= _LARGEST_SEED:
        raise SettingsError("permuted labels", [Fault(f"seed is {seed}", "a whole number in [0, 10^18)")])
    walls = _Walls(world)
    things = [item for item in world.objects if item.object_class.kind != "area" and walls.is_spot(item)]
    areas = [item for item in world.objects if item.object_class.kind == "area"]
    objects = list(world.objects)
    for spot, label in zip(things, _shuffled(things, seed), strict=True):
        objects[spot.id] = _thing(spot, label)
    laid: list[Region] = []
    for spot, label in zip(areas, _shuffled(areas, seed), strict=True):
        objects[spot.id] = replace(spot, class_name=label.class_name, attributes=label.attributes)
        if label.class_name != spot.class_name and spot.outline is not None:
            laid.append(Region(_GROUND_OF[label.class_name], spot.outline))
    return replace(
        world,
        name=f"{world.name}{INFIX}{seed}",
        regions=(*world.regions, *laid),
        objects=tuple(objects),
        source=f"{world.source}, labels permuted seed={seed}",
    )


def _shuffled(items: Sequence[WorldObject], seed: int) -> list[WorldObject]:
    return sorted(items, key=lambda item: (key_of(seed, "permuted labels", item.id), item.id))


def _is_door(item: WorldObject) -> bool:
    return item.object_class.kind == "place" and item.building >= 0


def _thing(spot: WorldObject, label: WorldObject) -> WorldObject:
    """Return what stands at a spot once it has the label of another."""
    if label is spot:
        return spot
    here = replace(spot, class_name=label.class_name, size_m=label.size_m, attributes=label.attributes, outline=None)
    if not _is_door(spot):
        # An outline on the map is of the thing that was there; here stands the box of its size.
        return replace(here, building=-1)
    if label.object_class.kind == "place":
        return here
    x_m, y_m = _before(spot, _GAP_M + min(_HALF_DEPTH_M, label.size_m[1] / 2.0))
    return replace(here, x_m=x_m, y_m=y_m, building=-1)


def _before(door: WorldObject, ahead_m: float) -> tuple[float, float]:
    return door.x_m + ahead_m * math.sin(door.heading_rad), door.y_m + ahead_m * math.cos(door.heading_rad)


class _Walls:
    """The buildings that stand on the ground."""

    def __init__(self, world: World) -> None:
        self._bounds = world.bounds
        low = [item for item in world.buildings if item.min_height_m <= ROOF_CLEARANCE_M]
        self._tree: Any = shapely.STRtree([shapely.make_valid(shapely.Polygon(b.outer, b.holes)) for b in low])

    def is_spot(self, item: WorldObject) -> bool:
        """Return whether anything could stand where a thing stands."""
        if not _is_door(item):
            return self._is_open(item.x_m, item.y_m)
        return all(self._is_open(*_before(item, ahead_m)) for ahead_m in np.linspace(_GAP_M, _GAP_M + _HALF_DEPTH_M, 5))

    def _is_open(self, x_m: float, y_m: float) -> bool:
        inside = self._tree.query(shapely.Point(x_m, y_m), predicate="intersects")
        return self._bounds.contains(x_m, y_m) and not len(inside)
