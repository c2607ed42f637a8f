"""What a world is measured in: whole millimetres, and headings in whole microradians.

A world that was kept must be the world that ran. Files keep this much and no more, so whatever makes a world ends with
`rounded`; what is asked of a world, its fingerprint included, is asked of that.
"""

from collections.abc import Callable, Iterator, Mapping
from typing import cast

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.world.world import Bounds, Building, Region, Ring, Way, World, WorldObject

Floats = NDArray[np.float64]


def rounded(world: World) -> World:
    """Return the world as a file keeps it; the world itself where it is so already.

    Attributes of objects come in the order of their names. Nothing is checked: what is no number stays none.
    """
    rings = _millimetres(np.concatenate([np.empty(0), *(np.ravel(ring) for ring in _rings(world))], dtype=np.float64))
    sizes = _millimetres(np.array(_lengths(world), dtype=np.float64))
    headings = _microradians(np.array([item.heading_rad for item in world.objects], dtype=np.float64))
    if rings is None and sizes is None and headings is None and all(map(_in_order, world.objects)):
        return world
    return _world_of(world, _Numbers(world, rings, sizes, headings))


def millimetres(values_m: Floats) -> Floats:
    """Return lengths in whole millimetres, halves up; as floats, since what is no number stays none."""
    whole: Floats = np.floor(values_m * 1000.0 + 0.5)
    return whole


def _millimetres(values_m: Floats) -> Floats | None:
    return _unless_same(values_m, millimetres(values_m) / 1000.0)


def _microradians(values_rad: Floats) -> Floats | None:
    # Zero has no sign.
    return _unless_same(values_rad, np.rint(values_rad * 1e6) / 1e6 + 0.0)


def _unless_same(before: Floats, after: Floats) -> Floats | None:
    """Return the new numbers, or None where they are the old ones to the bit."""
    return None if np.array_equal(before.view(np.int64), after.view(np.int64)) else after


def _rings(world: World) -> Iterator[Ring]:
    for region in world.regions:
        yield region.outer
        yield from region.holes
    for way in world.ways:
        yield way.line
    for building in world.buildings:
        yield building.outer
        yield from building.holes
        yield building.entrances
    for item in world.objects:
        if item.outline is not None:
            yield item.outline


def _lengths(world: World) -> list[float]:
    bounds = world.bounds
    lengths = [bounds.min_x_m, bounds.min_y_m, bounds.max_x_m, bounds.max_y_m]
    lengths += [way.width_m for way in world.ways]
    for building in world.buildings:
        lengths += (building.height_m, building.min_height_m)
    for item in world.objects:
        lengths += (item.x_m, item.y_m, *item.size_m)
    return lengths


def _in_order(item: WorldObject) -> bool:
    return len(item.attributes) < 2 or list(item.attributes) == sorted(item.attributes)


class _Numbers:
    """Hands out rounded numbers in the order in which they were collected; the old ones where none changed."""

    def __init__(self, world: World, rings: Floats | None, lengths: Floats | None, headings: Floats | None) -> None:
        self.ring: Callable[[Ring], Ring] = (lambda ring: ring) if rings is None else _RingReader(rings)
        values = _lengths(world) if lengths is None else lengths.tolist()
        self.length = iter(values).__next__
        turns = [item.heading_rad for item in world.objects] if headings is None else headings.tolist()
        self.heading = iter(turns).__next__


class _RingReader:
    def __init__(self, numbers: Floats) -> None:
        self._numbers, self._at = numbers, 0

    def __call__(self, before: Ring) -> Ring:
        start, self._at = self._at, self._at + np.size(before)
        return self._numbers[start : self._at].reshape(np.shape(before))


def _world_of(world: World, new: _Numbers) -> World:
    # The order is that of `_rings` and of `_lengths`.
    bounds = Bounds(new.length(), new.length(), new.length(), new.length())
    regions = tuple(Region(r.ground, new.ring(r.outer), tuple(map(new.ring, r.holes)), r.name) for r in world.regions)
    ways = tuple(Way(w.kind, w.ground, new.ring(w.line), new.length(), w.name, w.level) for w in world.ways)
    buildings = tuple(_building_of(building, new) for building in world.buildings)
    objects = tuple(_object_of(item, new) for item in world.objects)
    return World(
        world.name, bounds, regions, ways, buildings, objects, world.origin, world.source, world.attribution, world.seed
    )


def _building_of(before: Building, new: _Numbers) -> Building:
    return Building(
        outer=new.ring(before.outer),
        height_m=new.length(),
        holes=tuple(map(new.ring, before.holes)),
        kind=before.kind,
        name=before.name,
        entrances=new.ring(before.entrances),
        min_height_m=new.length(),
        height_source=before.height_source,
    )


def _object_of(before: WorldObject, new: _Numbers) -> WorldObject:
    x_m, y_m = new.length(), new.length()
    # Three of them, but that is `check_world`'s to say.
    size_m = tuple(new.length() for _ in before.size_m)
    attributes: Mapping[str, str] = before.attributes
    return WorldObject(
        id=before.id,
        class_name=before.class_name,
        x_m=x_m,
        y_m=y_m,
        heading_rad=new.heading(),
        size_m=cast("tuple[float, float, float]", size_m),
        attributes=attributes if _in_order(before) else dict(sorted(attributes.items())),
        outline=None if before.outline is None else new.ring(before.outline),
        building=before.building,
    )
