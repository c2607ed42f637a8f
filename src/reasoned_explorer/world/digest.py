"""A fingerprint of what a world contains."""

from hashlib import sha256

import numpy as np

from reasoned_explorer.world.world import Ring, World


def world_digest(world: World) -> str:
    """Return the SHA-256, hexadecimal, of all that stands in a world.

    Coordinates count to the millimetre; name, source and attribution do not count.
    """
    digest = sha256()

    def take(*parts: object) -> None:
        digest.update(repr(parts).encode())

    def take_ring(ring: Ring) -> None:
        digest.update(np.rint(np.asarray(ring, dtype=np.float64) * 1000.0).astype("<i8").tobytes())
        digest.update(b"|")

    bounds = world.bounds
    take(*(round(edge, 3) for edge in (bounds.min_x_m, bounds.min_y_m, bounds.max_x_m, bounds.max_y_m)))
    for region in world.regions:
        take("region", int(region.ground), region.name)
        for ring in (region.outer, *region.holes):
            take_ring(ring)
    for way in world.ways:
        take("way", way.kind, int(way.ground), round(way.width_m, 3), way.name, way.level)
        take_ring(way.line)
    for building in world.buildings:
        take("building", building.kind, building.name, round(building.height_m, 3), round(building.min_height_m, 3))
        for ring in (building.outer, *building.holes, building.entrances):
            take_ring(ring)
    for thing in world.objects:
        size = tuple(round(length, 3) for length in thing.size_m)
        place = tuple(round(value, 3) for value in (thing.x_m, thing.y_m, thing.heading_rad))
        take(thing.id, thing.class_name, place, size, sorted(thing.attributes.items()), thing.building)
        if thing.outline is not None:
            take_ring(thing.outline)
    return digest.hexdigest()
