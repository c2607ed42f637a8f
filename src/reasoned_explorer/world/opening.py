"""Worlds by what people type: a district to generate, or a file.

``park``, ``park:7`` (seed 7), ``park:7@600`` (600 m across), ``town.osm.pbf``, ``town.osm``, ``kept.rexworld``, or a
name that another package registered under the entry-point group ``reasoned_explorer.worlds``, whose factory is called
as ``factory(seed=…, size_m=…)`` and returns a `World`. With ``~permuted:1`` behind any of these the labels of its
things are permuted in place by that seed (`reasoned_explorer.world.permuted`).
"""

import re
from collections.abc import Callable
from pathlib import Path

from reasoned_explorer.model import Fault, Gathering, SettingsError, UnknownNameError, WorldError
from reasoned_explorer.model.checks import kind_faults, seed_faults
from reasoned_explorer.registry import Registry
from reasoned_explorer.world.rounding import rounded
from reasoned_explorer.world.world import World

WORLDS = Registry("world", "worlds", ())

DEFAULT_SIZE_M = 400.0
KEPT_SUFFIX = ".rexworld"
_OSM_SUFFIXES = (".osm", ".pbf", ".osm.gz", ".osm.bz2", ".xml")
_NAME = re.compile(r"(?P<name>[A-Za-z][\w-]*)(?::(?P<seed>\d{1,18}))?(?:@(?P<size>\d+(?:\.\d+)?))?")
_LOOSE_NAME = re.compile(r"(?P<name>[A-Za-z][\w-]*)(?::(?P<seed>[^@~]*))?(?:@(?P<size>[^~]*))?")
_SEED, _SIZE = re.compile(r"\d{1,18}"), re.compile(r"\d+(?:\.\d+)?")
#: A world, and what a person must know of it.
_Made = tuple[World, tuple[str, ...]]
_Maker = Callable[[], _Made]
_PERMUTED = re.compile(r"(?P<spec>.+)~permuted:(?P<seed>\d{1,18})")
_FORMS = (
    f"a district like park:7@400, or a file that ends in .osm, .osm.gz, .osm.bz2, .osm.pbf or {KEPT_SUFFIX}; "
    "~permuted:SEED may stand behind either"
)


def open_world(
    spec: str,
    *,
    seed: int = 0,
    size_m: float = DEFAULT_SIZE_M,
    bbox: tuple[float, float, float, float] | None = None,
) -> World:
    """Return the world that a person means.

    Args:
        spec: See the module's docstring.
        seed: For what is generated and for the seeded defaults of what is imported; a seed in the spec wins.
        size_m: Of a generated world, metres across; a size in the spec wins.
        bbox: lon0, lat0, lon1, lat1 in degrees; crops an OpenStreetMap file.

    Raises:
        WorldError: If the file cannot be used, or a bounding box is given for what is no OpenStreetMap file.
        UnknownNameError: If there is no such district or registered world.
        SettingsError: If seed or size are out of range.
    """
    return _maker_of(spec, seed=seed, size_m=size_m, bbox=bbox)()[0]


def open_world_with_notes(
    spec: str,
    *,
    seed: int = 0,
    bbox: tuple[float, float, float, float] | None = None,
) -> tuple[World, tuple[str, ...]]:
    """Return the world as `open_world` does, and what a person must know of it: that a map was cropped, say.

    Raises:
        InputError: As `open_world`.
    """
    return _maker_of(spec, seed=seed, size_m=DEFAULT_SIZE_M, bbox=bbox)()


def check_world_name(
    spec: str,
    *,
    seed: int = 0,
    size_m: float = DEFAULT_SIZE_M,
    bbox: tuple[float, float, float, float] | None = None,
) -> None:
    """Check all that can be known of a world before it is made or read: name, numbers, whether there is such a file.

    Raises:
        InputError: As `open_world`.
    """
    _maker_of(spec, seed=seed, size_m=size_m, bbox=bbox)


def _maker_of(spec: str, *, seed: int, size_m: float, bbox: tuple[float, float, float, float] | None) -> _Maker:
    """Return what makes a world, once all is checked that costs nothing."""
    if faults := kind_faults("the name", spec, str, "text such as park:7 or town.osm.pbf"):
        raise WorldError("world", faults)
    if faults := seed_faults(seed):
        raise SettingsError("world", faults)
    permuted = _PERMUTED.fullmatch(spec)
    if permuted is not None:
        make = _maker_of(permuted["spec"], seed=seed, size_m=size_m, bbox=bbox)
        return lambda: _permuted(*make(), int(permuted["seed"]))
    is_file = spec.lower().endswith((KEPT_SUFFIX, *_OSM_SUFFIXES))
    if "~" in Path(spec).name and not is_file:
        what = f"{spec!r} has {spec[spec.rindex('~') :]!r} behind its name"
        raise WorldError("world", [Fault(what, "~permuted:SEED, as in park:7~permuted:1")])
    if is_file or "/" in spec:
        return _reader_of(Path(spec), seed=seed, bbox=bbox)
    match = _NAME.fullmatch(spec)
    if match is None:
        raise WorldError("world", _name_faults(spec))
    found = Gathering()
    if bbox is not None:
        found.add(_no_bbox(spec))
    given_seed = int(match["seed"]) if match["seed"] else seed
    given_size_m = float(match["size"]) if match["size"] else size_m
    make = found.take(lambda: _generator_of(match["name"], given_seed, given_size_m), _nothing)
    found.finish("world")
    return make


def _name_faults(spec: str) -> list[Fault]:
    """Return what is wrong with what is neither a name nor a file."""
    loose = _LOOSE_NAME.fullmatch(spec)
    if loose is None:
        return [Fault(f"{spec!r} is neither a name nor a file", _FORMS)]
    from reasoned_explorer.world.generator import DISTRICTS

    known = (*DISTRICTS, *WORLDS.names())
    faults: list[Fault] = []
    if loose["name"] not in known:
        faults += _unknown(loose["name"], known).faults
    if not _SEED.fullmatch(loose["seed"] or "0"):
        faults.append(Fault(f"{spec!r} has the seed {loose['seed']!r}", "a whole number from 0 on, as in park:7"))
    if not _SIZE.fullmatch(loose["size"] or "1"):
        faults.append(Fault(f"{spec!r} has the size {loose['size']!r}", "metres, as in park:7@400"))
    return faults or [
        Fault(f"{spec!r} lacks a seed or a size behind its mark", "a name like park, park:7 or park:7@400")
    ]


def _unknown(name: str, known: tuple[str, ...]) -> UnknownNameError:
    return UnknownNameError("world", name, known, beside=f"a file (.osm, .osm.gz, .osm.bz2, .osm.pbf, {KEPT_SUFFIX})")


def _nothing() -> _Made:
    raise AssertionError  # stands for what was refused; the refusal is raised


def _no_bbox(spec: str) -> WorldError:
    return WorldError("world", [Fault(f"a bounding box for {spec!r}", "one only for OpenStreetMap files")])


def _permuted(world: World, notes: tuple[str, ...], seed: int) -> _Made:
    from reasoned_explorer.world.permuted import permute_labels

    return rounded(permute_labels(world, seed=seed)), notes


def _reader_of(path: Path, *, seed: int, bbox: tuple[float, float, float, float] | None) -> _Maker:
    if path.name.lower().endswith(KEPT_SUFFIX):
        from reasoned_explorer.world.files import load_world

        if bbox is not None:
            raise _no_bbox(str(path))
        if not path.is_file():
            load_world(path)  # says why it cannot
        return lambda: (load_world(path), ())
    from reasoned_explorer.world.osm.importer import check_source

    check_source(path, bbox=bbox)
    return lambda: _imported(path, seed, bbox)


def _imported(path: Path, seed: int, bbox: tuple[float, float, float, float] | None) -> _Made:
    from reasoned_explorer.world.osm.importer import import_osm_with_report

    world, report = import_osm_with_report(path, bbox=bbox, seed=seed)
    return world, (report.cropped,) if report.cropped else ()


def _generator_of(name: str, seed: int, size_m: float) -> _Maker:
    from reasoned_explorer.world.generator import DISTRICTS, check_request, generate_world

    if name in DISTRICTS:
        check_request(name, seed=seed, size_m=size_m)
        return lambda: (generate_world(name, seed=seed, size_m=size_m), ())
    if name not in WORLDS.names():
        raise _unknown(name, (*DISTRICTS, *WORLDS.names()))
    return lambda: (_registered(name, seed, size_m), ())


def _registered(name: str, seed: int, size_m: float) -> World:
    world = WORLDS.load(name)(seed=seed, size_m=size_m)
    if not isinstance(world, World):
        raise WorldError(f"world {name}", [Fault(f"its factory returned {type(world).__name__}", "a World")])
    return rounded(world)
