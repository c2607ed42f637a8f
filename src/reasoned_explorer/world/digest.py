"""A fingerprint of what a world contains."""

from collections.abc import Sequence
from hashlib import sha256

import numpy as np

from reasoned_explorer.world.rounding import rounded
from reasoned_explorer.world.world import Ring, World


def world_digest(world: World) -> str:
    """Return the SHA-256, hexadecimal, of all that stands in a world.

    It covers just what a file keeps of it (`rounded`); name, source and attribution do not count.
    """
    world = rounded(world)
    digest = sha256()

    def take(*parts: object) -> None:
        digest.update(repr(parts).encode())

    def take_lengths(lengths_m: Ring | Sequence[float]) -> None:
        digest.update(np.rint(np.asarray(lengths_m, dtype=np.float64) * 1000.0).astype("<i8").tobytes())
        digest.update(b"|")

    bounds = world.bounds
    take_lengths((bounds.min_x_m, bounds.min_y_m, bounds.max_x_m, bounds.max_y_m))
    for region in world.regions:
        take("region", int(region.ground), region.name)
        for ring in (region.outer, *region.holes):
            take_lengths(ring)
    for way in world.ways:
        take("way", way.kind, int(way.ground), way.name, way.level)
        take_lengths((way.width_m,))
        take_lengths(way.line)
    for building in world.buildings:
        take("building", building.kind, building.name, building.height_source)
        take_lengths((building.height_m, building.min_height_m))
        for ring in (building.outer, *building.holes, building.entrances):
            take_lengths(ring)
    take_lengths([length for item in world.objects for length in (item.x_m, item.y_m, *item.size_m)])
    for item in world.objects:
        microradians = round(item.heading_rad * 1e6)
        take(item.id, item.class_name, microradians, list(item.attributes.items()), item.building)
        if item.outline is not None:
            take_lengths(item.outline)
    return digest.hexdigest()
