"""Whether a world makes sense: all its faults at once."""

import difflib
import math
from collections.abc import Iterator

import numpy as np

from reasoned_explorer.model import Fault, WorldError
from reasoned_explorer.world.taxonomy import CLASS_NAMES, OBJECT_CLASSES, Ground
from reasoned_explorer.world.world import Building, Ring, World, WorldObject

#: No world is larger, square kilometres.
MAX_AREA_KM2 = 25.0
#: Nothing has a smaller width or size, metres: files keep millimetres.
MIN_SIZE_M = 0.001
HEIGHT_SOURCES = ("height", "levels", "default")
_MOST_FAULTS = 50


def check_world(world: World) -> None:
    """Check that a world can be used.

    Raises:
        WorldError: With every fault there is (of more than 50, the first 50 and the number of the rest).
    """
    faults = [*_bounds(world), *_ground(world), *_buildings(world), *_objects(world)]
    if len(faults) > _MOST_FAULTS:
        rest = len(faults) - _MOST_FAULTS
        faults = [*faults[:_MOST_FAULTS], Fault(f"and {rest} more faults", "", "mend these first")]
    if faults:
        raise WorldError(f"world {world.name!r}", faults)


def near_misses(name: str) -> str:
    """Return a remedy that names the object classes that a misspelt name may mean, or nothing."""
    near = difflib.get_close_matches(name, CLASS_NAMES, n=3, cutoff=0.5)
    return f"did you mean {' or '.join(near)}?" if near else ""


def _bounds(world: World) -> Iterator[Fault]:
    bounds = world.bounds
    corners = (bounds.min_x_m, bounds.min_y_m, bounds.max_x_m, bounds.max_y_m)
    if not all(math.isfinite(value) for value in corners):
        yield Fault(f"bounds {corners}", "finite numbers")
    elif bounds.width_m <= 0.0 or bounds.height_m <= 0.0:
        yield Fault(f"bounds {corners} are empty", "min_x_m < max_x_m and min_y_m < max_y_m")
    elif bounds.area_km2 > MAX_AREA_KM2:
        yield Fault(f"an area of {bounds.area_km2:.1f} km²", f"at most {MAX_AREA_KM2:g} km²", "crop it")
    if world.origin is not None:
        lat_deg, lon_deg = world.origin.lat_deg, world.origin.lon_deg
        if not (-90.0 <= lat_deg <= 90.0 and -180.0 <= lon_deg <= 180.0):
            yield Fault(f"origin at latitude {lat_deg}, longitude {lon_deg}", "[-90, 90] and [-180, 180] degrees")


def _ground(world: World) -> Iterator[Fault]:
    for i, region in enumerate(world.regions):
        yield from _kind_of_ground(f"region {i}", region.ground)
        yield from _rings(f"region {i}", region.outer, region.holes)
    for i, way in enumerate(world.ways):
        yield from _kind_of_ground(f"way {i}", way.ground)
        yield from _points(f"way {i}: line", way.line, 2)
        yield from _positive(f"way {i}: width", way.width_m)


def _buildings(world: World) -> Iterator[Fault]:
    for i, building in enumerate(world.buildings):
        yield from _rings(f"building {i}", building.outer, building.holes)
        yield from _points(f"building {i}: entrances", building.entrances, 0)
        yield from _positive(f"building {i}: height", building.height_m)
        yield from _storeys(f"building {i}", building)


def _storeys(what: str, building: Building) -> Iterator[Fault]:
    if not math.isfinite(building.min_height_m) or not building.min_height_m >= 0.0:
        yield Fault(f"{what}: min_height_m = {building.min_height_m}", "0 m or more")
    elif building.min_height_m >= building.height_m:
        yield Fault(
            f"{what}: min_height_m = {building.min_height_m} with height_m = {building.height_m}",
            "an underside below the roof",
        )
    if building.height_source not in HEIGHT_SOURCES:
        yield Fault(f"{what}: height_source = {building.height_source!r}", f"one of {', '.join(HEIGHT_SOURCES)}")


def _objects(world: World) -> Iterator[Fault]:
    for place, item in enumerate(world.objects):
        what = f"object {place}"
        if item.id != place:
            yield Fault(f"{what} has the id {item.id}", f"{place}, its place in the list")
        if item.class_name not in OBJECT_CLASSES:
            yield Fault(f"{what}: unknown class {item.class_name!r}", "a known class", near_misses(item.class_name))
        yield from _whereabouts(what, item, world)
        if len(item.size_m) != 3:
            yield Fault(f"{what}: size_m = {item.size_m}", "length, width and height")
        for name, value in zip(("length", "width", "height"), item.size_m, strict=False):
            yield from _positive(f"{what}: {name}", value)
        if item.outline is not None:
            yield from _points(f"{what}: outline", item.outline, 3)
        if not -1 <= item.building < len(world.buildings):
            yield Fault(f"{what}: building = {item.building}", f"-1 or one of the {len(world.buildings)} buildings")


def _whereabouts(what: str, item: WorldObject, world: World) -> Iterator[Fault]:
    if not (math.isfinite(item.x_m) and math.isfinite(item.y_m)):
        yield Fault(f"{what} at ({item.x_m}, {item.y_m})", "finite numbers")
    elif not world.bounds.contains(item.x_m, item.y_m):
        yield Fault(f"{what} at ({item.x_m:g}, {item.y_m:g}) is outside the bounds", "a place inside the bounds")
    if not math.isfinite(item.heading_rad):
        yield Fault(f"{what}: heading_rad = {item.heading_rad}", "a finite number")


def _kind_of_ground(what: str, ground: object) -> Iterator[Fault]:
    if not isinstance(ground, Ground):
        yield Fault(f"{what}: ground = {ground!r}", "a Ground")


def _rings(what: str, outer: Ring, holes: tuple[Ring, ...]) -> Iterator[Fault]:
    yield from _points(f"{what}: outline", outer, 3)
    for k, hole in enumerate(holes):
        yield from _points(f"{what}: hole {k}", hole, 3)


def _points(what: str, points: Ring, least: int) -> Iterator[Fault]:
    array = np.asarray(points)
    if array.ndim != 2 or array.shape[1] != 2:
        yield Fault(f"{what} of shape {array.shape}", "shape (n, 2)")
    elif len(array) < least:
        yield Fault(f"{what} of {len(array)} points", f"at least {least}")
    elif not np.isfinite(array).all():
        yield Fault(f"{what} with coordinates that are not finite", "finite numbers")


def _positive(what: str, value: float) -> Iterator[Fault]:
    if not (math.isfinite(value) and value >= MIN_SIZE_M):
        yield Fault(f"{what} of {value} m", f"a finite number of at least {MIN_SIZE_M} m")
