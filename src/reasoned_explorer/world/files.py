"""Worlds in files: one gzip-compressed JSON document, ``*.rexworld``.

The document is ``{"format": "rexworld", "version": 1, "world": {...}}``. Lengths are whole millimetres; of a ring or
line the first point is given by its coordinates and every other by its step from the one before, all in one flat list.
Headings are radians, rounded to 1e-6 (`rounding`). Ground is called by its lower-case name. What has its default value
is left out.
"""

import gzip
import os
import tempfile
import zlib
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, FiniteFloat, ValidationError
from pydantic_core import from_json, to_json

from reasoned_explorer.geometry import GeoOrigin
from reasoned_explorer.model import Fault, WorldError
from reasoned_explorer.model.checks import kind_faults, path_of
from reasoned_explorer.model.disk import disk_error
from reasoned_explorer.world.rounding import rounded
from reasoned_explorer.world.taxonomy import OBJECT_CLASSES, Ground
from reasoned_explorer.world.validation import check_world, near_misses
from reasoned_explorer.world.world import Bounds, Building, Region, Ring, Way, World, WorldObject

#: Name ending of world files.
SUFFIX = ".rexworld"
FORMAT = "rexworld"
VERSION = 1
_MOST_BYTES = 1_000_000_000
_GROUNDS = {ground.name.lower(): ground for ground in Ground}

_Flat = list[int]
_Millimetres = Annotated[int, Field(ge=-(10**9), le=10**9)]


class _Part(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True)


class _RegionPart(_Part):
    ground: str
    outer: _Flat
    holes: list[_Flat] = []
    name: str = ""


class _WayPart(_Part):
    kind: str
    ground: str
    line: _Flat
    width: _Millimetres
    name: str = ""
    level: int = 0


class _BuildingPart(_Part):
    outer: _Flat
    height: _Millimetres
    holes: list[_Flat] = []
    kind: str = "yes"
    name: str = ""
    entrances: _Flat = []
    min_height: _Millimetres = 0
    height_source: Literal["height", "levels", "default"] = "default"


class _ObjectPart(_Part):
    cls: str
    at: Annotated[list[_Millimetres], Field(min_length=2, max_length=2)]
    size: Annotated[list[_Millimetres], Field(min_length=3, max_length=3)]
    heading: FiniteFloat = 0.0
    attributes: dict[str, str] = {}
    outline: _Flat | None = None
    building: int = -1


class _WorldPart(_Part):
    name: str
    bounds: Annotated[list[_Millimetres], Field(min_length=4, max_length=4)]
    regions: list[_RegionPart]
    ways: list[_WayPart]
    buildings: list[_BuildingPart]
    objects: list[_ObjectPart]
    origin: Annotated[list[FiniteFloat], Field(min_length=2, max_length=2)] | None = None
    source: str = ""
    attribution: str = ""
    seed: int = 0


def save_world(world: World, path: str | Path) -> None:
    """Write a world to a file; the same world gives the same bytes.

    The file appears whole or not at all. What is kept is the world as `rounded` returns it, exactly: a world that was
    made here, or opened, is so already and comes back as it was.

    Args:
        world: The world.
        path: Ends in ``.rexworld``; a file that is there is replaced.

    Raises:
        WorldError: If the world has faults, the name has another ending, or the folder cannot be written to.
        PartError: If the disk fails, e.g. because it is full.
    """
    target = path_of(path, "world file", WorldError)
    if faults := kind_faults("the world", world, World, "a World"):
        raise WorldError("world file", faults)
    if target.suffix != SUFFIX:
        raise WorldError("world file", [Fault(f"the name {target.name!r}", f"one that ends in {SUFFIX}")])
    world = rounded(world)
    check_world(world)
    document = {"format": FORMAT, "version": VERSION, "world": _part_of(world).model_dump(exclude_defaults=True)}
    data = gzip.compress(to_json(document), compresslevel=6, mtime=0)
    try:
        _replace(target, data)
    except OSError as error:
        raise disk_error("world file", target, error, kind=WorldError) from error


def load_world(path: str | Path) -> World:
    """Read a world from a file.

    Raises:
        WorldError: If there is no such file, or it is broken, cut short, of another version, or holds a world with
            faults; with all faults that can be told.
    """
    source = path_of(path, "world file", WorldError)
    subject = f"world file {source}"
    document = _document(source, subject)
    if not isinstance(document, dict) or document.get("format") != FORMAT:
        raise WorldError(subject, [Fault("it holds something else", f'a JSON object with "format": "{FORMAT}"')])
    version = document.get("version")
    if version != VERSION:
        remedy = "a newer release reads it" if isinstance(version, int) and version > VERSION else ""
        raise WorldError(subject, [Fault(f"version {version!r}", f"version {VERSION}", remedy)])
    try:
        part = _WorldPart.model_validate(document.get("world"))
    except ValidationError as error:
        faults = [
            Fault(f"{'.'.join(str(step) for step in fault['loc']) or 'world'}: {fault['msg']}")
            for fault in error.errors(include_url=False, include_context=False, include_input=False)
        ]
        raise WorldError(subject, faults) from error
    if faults := _name_faults(part):
        raise WorldError(subject, faults)
    world = rounded(_world_of(part))
    check_world(world)
    return world


def _document(source: Path, subject: str) -> Any:
    try:
        with gzip.open(source) as file:
            data = file.read(_MOST_BYTES + 1)
    except FileNotFoundError as error:
        raise WorldError(subject, [Fault("there is no such file", "the path of a world file")]) from error
    except EOFError as error:
        raise WorldError(subject, [Fault("it is cut short", "a whole file", "save or copy it again")]) from error
    except (gzip.BadGzipFile, zlib.error) as error:
        raise WorldError(subject, [Fault(f"it is broken: {error}", f"a file that ends in {SUFFIX}")]) from error
    except OSError as error:
        raise WorldError(
            subject, [Fault(f"it cannot be read: {error.strerror or error}", "the path of a world file")]
        ) from error
    if len(data) > _MOST_BYTES:
        raise WorldError(subject, [Fault("it holds over 1 GB", "a world of at most 25 km²")])
    try:
        return from_json(data, allow_inf_nan=False)
    except ValueError as error:
        raise WorldError(subject, [Fault(f"it is not JSON: {error}", "a whole, finite JSON document")]) from error


def _replace(target: Path, data: bytes) -> None:
    handle, name = tempfile.mkstemp(prefix=f".{target.name[:40]}.", dir=target.parent)
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        Path(name).chmod(0o644)
        Path(name).replace(target)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


def _name_faults(part: _WorldPart) -> list[Fault]:
    faults = []
    grounds = [(f"regions.{i}", region.ground) for i, region in enumerate(part.regions)]
    grounds += [(f"ways.{i}", way.ground) for i, way in enumerate(part.ways)]
    for where, ground in grounds:
        if ground not in _GROUNDS:
            faults.append(Fault(f"{where}: unknown ground {ground!r}", f"one of {', '.join(_GROUNDS)}"))
    for i, item in enumerate(part.objects):
        if item.cls not in OBJECT_CLASSES:
            faults.append(Fault(f"objects.{i}: unknown class {item.cls!r}", "a known class", near_misses(item.cls)))
    for where, flat in _flats(part):
        if len(flat) % 2:
            faults.append(Fault(f"{where}: {len(flat)} numbers", "an even number: x and y of each point"))
        elif flat and max(map(abs, flat)) > 10**9:
            faults.append(Fault(f"{where}: a number beyond 10^9 mm", "millimetres"))
    return faults


def _flats(part: _WorldPart) -> Iterable[tuple[str, _Flat]]:
    for i, region in enumerate(part.regions):
        yield from ((f"regions.{i}", flat) for flat in (region.outer, *region.holes))
    for i, way in enumerate(part.ways):
        yield f"ways.{i}", way.line
    for i, building in enumerate(part.buildings):
        yield from ((f"buildings.{i}", flat) for flat in (building.outer, *building.holes, building.entrances))
    for i, item in enumerate(part.objects):
        yield f"objects.{i}", item.outline or []


def _mm(value_m: float) -> int:
    return round(value_m * 1000.0)


def _flat(points: Ring) -> _Flat:
    whole = np.rint(np.asarray(points, dtype=np.float64) * 1000.0).astype(np.int64)
    whole[1:] -= whole[:-1].copy()
    steps: _Flat = whole.ravel().tolist()
    return steps


def _ring(flat: Sequence[int]) -> Ring:
    whole = np.asarray(flat, dtype=np.int64).reshape(-1, 2)
    return np.cumsum(whole, axis=0) / 1000.0


def _part_of(world: World) -> _WorldPart:
    bounds = world.bounds
    return _WorldPart(
        name=world.name,
        bounds=[_mm(v) for v in (bounds.min_x_m, bounds.min_y_m, bounds.max_x_m, bounds.max_y_m)],
        regions=[
            _RegionPart(
                ground=r.ground.name.lower(), outer=_flat(r.outer), holes=[_flat(h) for h in r.holes], name=r.name
            )
            for r in world.regions
        ],
        ways=[
            _WayPart(
                kind=w.kind,
                ground=w.ground.name.lower(),
                line=_flat(w.line),
                width=_mm(w.width_m),
                name=w.name,
                level=w.level,
            )
            for w in world.ways
        ],
        buildings=[_building_part(building) for building in world.buildings],
        objects=[_object_part(item) for item in world.objects],
        origin=None if world.origin is None else [world.origin.lat_deg, world.origin.lon_deg],
        source=world.source,
        attribution=world.attribution,
        seed=world.seed,
    )


def _building_part(building: Building) -> _BuildingPart:
    return _BuildingPart.model_validate(
        {
            "outer": _flat(building.outer),
            "height": _mm(building.height_m),
            "holes": [_flat(hole) for hole in building.holes],
            "kind": building.kind,
            "name": building.name,
            "entrances": _flat(building.entrances),
            "min_height": _mm(building.min_height_m),
            "height_source": building.height_source,
        }
    )


def _object_part(item: WorldObject) -> _ObjectPart:
    return _ObjectPart(
        cls=item.class_name,
        at=[_mm(item.x_m), _mm(item.y_m)],
        size=[_mm(value) for value in item.size_m],
        heading=float(item.heading_rad),
        attributes=dict(item.attributes),
        outline=None if item.outline is None else _flat(item.outline),
        building=item.building,
    )


def _world_of(part: _WorldPart) -> World:
    min_x, min_y, max_x, max_y = (value / 1000.0 for value in part.bounds)
    return World(
        name=part.name,
        bounds=Bounds(min_x, min_y, max_x, max_y),
        regions=tuple(
            Region(_GROUNDS[r.ground], _ring(r.outer), tuple(_ring(h) for h in r.holes), r.name) for r in part.regions
        ),
        ways=tuple(
            Way(w.kind, _GROUNDS[w.ground], _ring(w.line), w.width / 1000.0, w.name, w.level) for w in part.ways
        ),
        buildings=tuple(
            Building(
                _ring(b.outer),
                b.height / 1000.0,
                tuple(_ring(h) for h in b.holes),
                b.kind,
                b.name,
                _ring(b.entrances),
                b.min_height / 1000.0,
                b.height_source,
            )
            for b in part.buildings
        ),
        objects=tuple(_object_of(i, item) for i, item in enumerate(part.objects)),
        origin=None if part.origin is None else GeoOrigin(*part.origin),
        source=part.source,
        attribution=part.attribution,
        seed=part.seed,
    )


def _object_of(place: int, item: _ObjectPart) -> WorldObject:
    length_m, width_m, height_m = (value / 1000.0 for value in item.size)
    return WorldObject(
        id=place,
        class_name=item.cls,
        x_m=item.at[0] / 1000.0,
        y_m=item.at[1] / 1000.0,
        heading_rad=item.heading,
        size_m=(length_m, width_m, height_m),
        attributes=item.attributes,
        outline=None if item.outline is None else _ring(item.outline),
        building=item.building,
    )
