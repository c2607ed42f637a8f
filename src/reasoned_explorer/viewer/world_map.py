"""What stood where a mission took place, as a page draws it."""

import math
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pydantic_core import to_json

from reasoned_explorer.model.record import EpisodeRecord
from reasoned_explorer.viewer.listing import opaque_id
from reasoned_explorer.world.world import Bounds, Ring, World, WorldObject

#: So far round what happened a world is shown, metres.
MARGIN_M = 150.0
#: Changes whenever the same world would be written differently.
_VERSION = "1"
_PLANTS = frozenset({"tree", "shrub"})


def box_of(record: EpisodeRecord, world: World) -> Bounds:
    """Return the part of a world that a mission came near: whole tens of metres, so that it grows seldom."""
    places = [record.header.start[:2], *record.header.reference_way]
    for step in record.steps:
        places.append(step.pose[:2])
        places += [(point.x_m, point.y_m) for leg in step.legs for point in leg.track]
        places += [(frontier.x_m, frontier.y_m) for frontier in step.frontiers]
    xy = np.array([place for place in places if all(map(math.isfinite, place))])
    low, high = np.floor((xy.min(axis=0) - MARGIN_M) / 10) * 10, np.ceil((xy.max(axis=0) + MARGIN_M) / 10) * 10
    return Bounds(
        max(world.bounds.min_x_m, float(low[0])),
        max(world.bounds.min_y_m, float(low[1])),
        min(world.bounds.max_x_m, float(high[0])),
        min(world.bounds.max_y_m, float(high[1])),
    )


def map_tag(digest: str, box: Bounds) -> str:
    """Return a name of a map that changes when the map does."""
    return opaque_id("map", _VERSION, digest, f"{box.min_x_m} {box.min_y_m} {box.max_x_m} {box.max_y_m}")


def map_json(world: World, box: Bounds) -> bytes:
    """Return what of a world reaches into a box. Lengths are metres, to the centimetre; later shapes lie on top."""
    objects = [thing for thing in world.objects if box.contains(thing.x_m, thing.y_m)]
    return to_json(
        {
            "bounds": [box.min_x_m, box.min_y_m, box.max_x_m, box.max_y_m],
            "attribution": world.attribution,
            "ground": [
                {"kind": region.ground.name.lower(), "rings": _rings(region.outer, region.holes)}
                for region in world.regions
                if _reaches_into(region.outer, box)
            ],
            "ways": [
                {
                    "kind": way.kind,
                    "ground": way.ground.name.lower(),
                    "points": _points(way.line),
                    "width_m": round(way.width_m, 2),
                    "level": way.level,
                }
                for way in world.ways
                if _reaches_into(way.line, box)
            ],
            "buildings": [
                {
                    "rings": _rings(building.outer, building.holes),
                    "height_m": round(building.height_m, 2),
                    "name": building.name,
                }
                for building in world.buildings
                if _reaches_into(building.outer, box)
            ],
            "objects": [_thing(thing) for thing in objects if thing.class_name not in _PLANTS],
            # East, north and radius of the crown.
            "trees": list(_trees(objects)),
        }
    )


def _thing(thing: WorldObject) -> dict[str, Any]:
    return {
        "id": thing.id,
        "class": thing.class_name,
        "x": round(thing.x_m, 2),
        "y": round(thing.y_m, 2),
        "name": thing.attributes.get("name", ""),
    }


def _trees(objects: Iterable[WorldObject]) -> Iterator[list[float]]:
    for thing in objects:
        if thing.class_name in _PLANTS:
            yield [round(thing.x_m, 2), round(thing.y_m, 2), round(0.5 * thing.size_m[0], 2)]


def _reaches_into(points: Ring, box: Bounds) -> bool:
    (low_x, low_y), (high_x, high_y) = points.min(axis=0), points.max(axis=0)
    return bool(low_x <= box.max_x_m and high_x >= box.min_x_m and low_y <= box.max_y_m and high_y >= box.min_y_m)


def _rings(outer: Ring, holes: Iterable[Ring]) -> list[list[list[float]]]:
    return [_points(outer), *(_points(hole) for hole in holes)]


def _points(line: NDArray[np.float64]) -> list[list[float]]:
    points: list[list[float]] = np.round(line, 2).tolist()
    return points
