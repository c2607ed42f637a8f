"""From an OpenStreetMap file to a world."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path

import numpy as np
import shapely

from reasoned_explorer.geometry import GeoOrigin
from reasoned_explorer.model import Fault, Gathering, WorldError
from reasoned_explorer.model.checks import kind_faults, path_of, seed_faults
from reasoned_explorer.model.stopping import stop_if_asked
from reasoned_explorer.world.osm.buildings import buildings_of
from reasoned_explorer.world.osm.features import features_of
from reasoned_explorer.world.osm.furniture import objects_of
from reasoned_explorer.world.osm.paths import PathIndex
from reasoned_explorer.world.osm.reading import OFF_EARTH, BoxDeg, Extract, check_file, read_extract
from reasoned_explorer.world.osm.surfaces import passages_of, regions_of, ways_of
from reasoned_explorer.world.osm.tags import class_of
from reasoned_explorer.world.rounding import rounded
from reasoned_explorer.world.world import Bounds, World

#: Whom to thank wherever a picture or a figure of an imported world is shown.
ATTRIBUTION = "© OpenStreetMap contributors, ODbL 1.0"
#: Nothing larger than this is imported, km².
MAX_AREA_KM2 = 25.0
_MIN_SIDE_M = 10.0
_RIM_DEG = 1e-4
_M_PER_DEG = 111_195.0
_CROP = "pass a smaller bbox=(lon0, lat0, lon1, lat1)"
_BBOX = "(lon0, lat0, lon1, lat1) in degrees, west before east and south before north"


@dataclass(frozen=True, slots=True)
class ImportReport:
    """What an import made of a file.

    Attributes:
        bbox_deg: What was imported (lon0, lat0, lon1, lat1).
        newest_edit: Day of the newest edit, ``YYYY-MM-DD``, or empty.
        counts: How much of what there is, and how much of what was lost or dropped.
        warnings: What a person should know, one sentence each.
        cropped: What a person must know: that only a part was imported, which nobody asked for; empty otherwise.
    """

    bbox_deg: BoxDeg
    newest_edit: str
    counts: Mapping[str, int] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    cropped: str = ""


def import_osm(
    path: str | PathLike[str], *, bbox: BoxDeg | None = None, seed: int = 0, name: str | None = None
) -> World:
    """Import a world from an OpenStreetMap file (.osm, .osm.gz, .osm.bz2 or .osm.pbf).

    Args:
        path: The file.
        bbox: What to import (lon0, lat0, lon1, lat1), degrees. Without it: what the file says that it covers, else the
            extent of its contents.
        seed: Of what the map does not say and is filled in: heights of buildings and trees.
        name: Of the world; the file's name where none is given.

    Raises:
        WorldError: The file or the bbox cannot be used, or the area is larger than 25 km².
        KeyboardInterrupt: A person asked to stop.
    """
    return import_osm_with_report(path, bbox=bbox, seed=seed, name=name)[0]


def import_osm_with_report(
    path: str | PathLike[str], *, bbox: BoxDeg | None = None, seed: int = 0, name: str | None = None
) -> tuple[World, ImportReport]:
    """Import a world as `import_osm` does, and say what was made of the file and what was lost."""
    file = path_of(path, "OpenStreetMap file", WorldError)
    faults = seed_faults(seed) + kind_faults("name", name, (str, type(None)), "text, or None")
    if faults:
        raise WorldError("import", faults)
    bbox = check_source(file, bbox=bbox)
    extract = read_extract(file, box_deg=bbox)
    stop_if_asked()
    cropped = ""
    if bbox is None:
        bbox, cropped = _whole(extract, file)
    warnings = [cropped] if cropped else []
    origin, bounds = frame_of(bbox)
    features = features_of(extract, origin, bounds)
    if not (features.points or features.lines or features.areas):
        raise WorldError(
            "OpenStreetMap file",
            [Fault(f"nothing in {file.name} lies within {_show(bbox)}", "a bbox that the file covers",
                   f"the file covers {_show(extract.header_box_deg)}" if extract.header_box_deg else "check the bbox")],
        )  # fmt: skip
    stop_if_asked()
    buildings = buildings_of(features.areas, features.points, passages_of(features.lines), bounds, seed=seed)
    stop_if_asked()
    ways = ways_of(features.lines, features.points, bounds)
    regions, region_counts = regions_of(features.areas, features.lines, buildings.courtyards, bounds)
    stop_if_asked()
    placed = objects_of(
        features.points, features.lines, features.areas,
        buildings=buildings, paths=PathIndex(ways), bounds=bounds, seed=seed,
    )  # fmt: skip
    stem = name if name is not None else file.name.split(".")[0]
    world = World(
        name=stem,
        bounds=bounds,
        regions=regions,
        ways=ways,
        buildings=buildings.buildings,
        objects=placed.objects,
        origin=origin,
        source=f"OpenStreetMap {file.name} bbox={','.join(f'{side:.7g}' for side in bbox)} seed={seed}",
        attribution=ATTRIBUTION,
        seed=seed,
    )
    counts = {**buildings.counts, **region_counts, "ways": len(ways), **placed.counts, **features.lost}
    warnings += [f"{count} {what}" for what, count in features.lost.items()]
    if placed.counts["objects inside buildings dropped"]:
        warnings.append(f"{placed.counts['objects inside buildings dropped']} objects inside buildings dropped")
    if region_counts["loose ends of coastline"]:
        warnings.append(f"{region_counts['loose ends of coastline']} loose ends of coastline led to the nearest edge")
    if region_counts["stretches of unclear coast"]:
        warnings.append("the coastline is broken; check where the sea is")
    return rounded(world), ImportReport(bbox, extract.newest_edit, counts, tuple(warnings), cropped)


def check_source(path: Path, *, bbox: BoxDeg | None = None) -> BoxDeg | None:
    """Check all that can be known of an import before the file is read, and return the bbox as floats.

    Raises:
        WorldError: There is no such file, or the bbox cannot be used.
    """
    found = Gathering()
    found.check(lambda: check_file(path))
    checked = found.take(lambda: None if bbox is None else _checked(bbox), None)
    found.finish("OpenStreetMap file")
    return checked


def _checked(bbox: BoxDeg) -> BoxDeg:
    """Return a bbox as floats.

    Raises:
        WorldError: It is malformed, degenerate, off the globe or too large.
    """
    try:
        values = tuple(float(side) for side in bbox)
    except (TypeError, ValueError) as error:
        raise WorldError("bbox", [Fault(f"{bbox!r} is not four numbers", _BBOX)]) from error
    if len(values) != 4:
        raise WorldError("bbox", [Fault(f"{bbox!r} has {len(values)} numbers", _BBOX)])
    lon0, lat0, lon1, lat1 = values
    if not all(math.isfinite(side) for side in values):
        raise WorldError("bbox", [Fault(f"{bbox!r} has a number that is not finite", _BBOX)])
    faults = [
        Fault(f"{label} is {side:g}", f"a number in [-{limit}, {limit}]", "the order is lon0, lat0, lon1, lat1")
        for label, side, limit in (("lon0", lon0, 180), ("lat0", lat0, 89), ("lon1", lon1, 180), ("lat1", lat1, 89))
        if abs(side) > limit
    ]
    if lon0 >= lon1:
        faults.append(Fault(f"lon0 = {lon0:g} is not west of lon1 = {lon1:g}", _BBOX))
    if lat0 >= lat1:
        faults.append(Fault(f"lat0 = {lat0:g} is not south of lat1 = {lat1:g}", _BBOX))
    if not faults:
        faults = _size_faults((lon0, lat0, lon1, lat1), _CROP)
    if faults:
        raise WorldError("bbox", faults)
    return lon0, lat0, lon1, lat1


def _size_faults(box: BoxDeg, remedy: str) -> list[Fault]:
    width_m, height_m = _sides_m(box)
    area_km2 = width_m * height_m / 1e6
    if area_km2 > MAX_AREA_KM2:
        return [Fault(f"{_show(box)} is {area_km2:.1f} km²", f"at most {MAX_AREA_KM2:g} km²", remedy)]
    if min(width_m, height_m) < _MIN_SIDE_M:
        return [Fault(f"{_show(box)} is {width_m:.1f} m by {height_m:.1f} m", f"at least {_MIN_SIDE_M:g} m each way")]
    return []


def _sides_m(box: BoxDeg) -> tuple[float, float]:
    lon0, lat0, lon1, lat1 = box
    return (
        (lon1 - lon0) * _M_PER_DEG * math.cos(math.radians((lat0 + lat1) / 2.0)),
        (lat1 - lat0) * _M_PER_DEG,
    )


def _show(box: BoxDeg) -> str:
    return ",".join(f"{side:.6g}" for side in box)


def _whole(extract: Extract, file: Path) -> tuple[BoxDeg, str]:
    """Return what to import of a file when nobody said: what it covers, or, where that is too much, what is built up.

    The second value says so, in words.

    Raises:
        WorldError: There is nothing in it, or even that is too large.
    """
    extent = _extent(extract)
    if extent is None:
        lost = ", ".join(f"{count} {what}" for what, count in extract.lost.items())
        if OFF_EARTH in extract.lost:
            expected = "latitudes from -90 to 90 and longitudes from -180 to 180"
            fault = Fault(f"nothing in {file.name} lies on earth: {lost}", expected, "are they the wrong way round?")
        else:
            what = f"there is nothing in {file.name}" + (f" that has a place: {lost}" if lost else "")
            fault = Fault(what, "nodes and ways with tags", "check what was extracted")
        raise WorldError("OpenStreetMap file", [fault])
    first = extent if extract.header_box_deg is None else extract.header_box_deg
    if not _size_faults(first, ""):
        return first, ""
    for box in (extent, _built_up(extract)):
        if box is not None and not _size_faults(box, ""):
            return box, f"{_show(first)} is too large; imported what is built up: {_show(box)}"
    raise WorldError("OpenStreetMap file", _size_faults(first, _CROP))


def _extent(extract: Extract) -> BoxDeg | None:
    points = [(node.lon_deg, node.lat_deg) for node in extract.nodes]
    box = _box_around(points, extract.way_lines)
    if box is None:
        return None
    # What lies on the very edge shall be inside.
    return box[0] - _RIM_DEG, box[1] - _RIM_DEG, box[2] + _RIM_DEG, box[3] + _RIM_DEG


def _built_up(extract: Extract) -> BoxDeg | None:
    """Return the extent of streets, buildings and objects: what a file covers less the ferries and the open sea."""
    points = [(node.lon_deg, node.lat_deg) for node in extract.nodes if class_of(node.tags, is_node=True)]
    chosen = [bool({"highway", "building"} & way.tags.keys()) for way in extract.ways]
    box = _box_around(points, extract.way_lines[np.array(chosen, dtype=bool)])
    header = extract.header_box_deg
    if box is None or header is None:
        return box
    return max(box[0], header[0]), max(box[1], header[1]), min(box[2], header[2]), min(box[3], header[3])


def _box_around(points: list[tuple[float, float]], lines: object) -> BoxDeg | None:
    parts = []
    if points:
        spread = np.asarray(points)
        parts.append([*spread.min(axis=0), *spread.max(axis=0)])
    if len(lines):  # type: ignore[arg-type]
        parts.append(list(shapely.total_bounds(lines)))
    if not parts:
        return None
    table = np.asarray(parts)
    low, high = table[:, :2].min(axis=0), table[:, 2:].max(axis=0)
    return float(low[0]), float(low[1]), float(high[0]), float(high[1])


def frame_of(box: BoxDeg) -> tuple[GeoOrigin, Bounds]:
    """Return the origin in the middle of a bbox, and the bounds: the rectangle that is as wide as its middle."""
    lon0, lat0, lon1, lat1 = box
    origin = GeoOrigin(lat_deg=(lat0 + lat1) / 2.0, lon_deg=(lon0 + lon1) / 2.0)
    east_m, _ = origin.enu_from_geodetic_m([origin.lat_deg] * 2, [lon0, lon1])
    _, north_m = origin.enu_from_geodetic_m([lat0, lat1], [origin.lon_deg] * 2)
    return origin, Bounds(float(east_m[0]), float(north_m[0]), float(east_m[1]), float(north_m[1]))
