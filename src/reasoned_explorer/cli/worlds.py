"""``rex worlds …``."""

from pathlib import Path

from reasoned_explorer.cli.console import Output
from reasoned_explorer.cli.parsing import parse_bbox
from reasoned_explorer.model.stopping import stop_if_asked
from reasoned_explorer.world.files import save_world
from reasoned_explorer.world.generator import DISTRICTS
from reasoned_explorer.world.opening import WORLDS, open_world
from reasoned_explorer.world.summary import summarise
from reasoned_explorer.world.world import World


def _say(line: str) -> None:
    Output().print(line, markup=False, soft_wrap=True)


def list_worlds() -> None:
    """Print the districts and the registered worlds."""
    for name, summary in DISTRICTS.items():
        _say(f"{name:14s} {summary}")
    for entry in WORLDS.entries():
        _say(f"{entry.name:14s} {entry.summary}")
    _say("and any .osm, .osm.gz, .osm.bz2, .osm.pbf or .rexworld file")


def generate_and_keep(district: str, *, seed: int, size_m: float, out: Path | None) -> None:
    """Generate a world, say what is in it, and keep it where a path is given."""
    _report(open_world(district, seed=seed, size_m=size_m), out)


def import_and_keep(osm_file: Path, *, bbox: str | None, seed: int, out: Path | None) -> None:
    """Import a real place, say what is in it and what was lost, and keep it where a path is given."""
    from reasoned_explorer.world.osm.importer import import_osm_with_report

    world, report = import_osm_with_report(osm_file, bbox=parse_bbox(bbox), seed=seed)
    _report(world, out)
    if report.newest_edit:
        _say(f"newest edit on the map: {report.newest_edit}")
    for warning in report.warnings:
        _say(f"note: {warning}")


def inspect_world(spec: str, *, bbox: str | None, seed: int) -> None:
    """Say what is in a world."""
    _report(open_world(spec, seed=seed, bbox=parse_bbox(bbox)), None)


def draw_map(spec: str, out: Path, *, bbox: str | None, seed: int, width_px: int, labels: bool) -> None:
    """Draw a world."""
    from reasoned_explorer.world.drawing import draw_world

    world = open_world(spec, seed=seed, bbox=parse_bbox(bbox))
    stop_if_asked()
    draw_world(world, out, width_px=width_px, labels=labels)
    _say(f"drawn to {out}")


def _report(world: World, out: Path | None) -> None:
    stop_if_asked()
    for line in summarise(world).lines():
        _say(line)
    if out is not None:
        save_world(world, out)
        _say(f"kept as {out}")
