"""``rex export``: results, and missions, for other programs."""

from dataclasses import dataclass
from pathlib import Path

from reasoned_explorer.cli.console import Output
from reasoned_explorer.cli.parsing import parse_bbox
from reasoned_explorer.evaluation.bench.export import FORMATS as TABLES
from reasoned_explorer.evaluation.bench.export import export
from reasoned_explorer.evaluation.bench.store import RunStore
from reasoned_explorer.model import Fault, InputError
from reasoned_explorer.viewer.exports.formats import FORMATS, export_mission
from reasoned_explorer.viewer.exports.mission import Choice, find_mission


@dataclass(frozen=True, slots=True)
class ExportOptions:
    """What a person asked for; see `reasoned_explorer.cli.export_app`."""

    run: Path
    path: Path
    mission: str | None = None
    planner: str | None = None
    vehicle: str | None = None
    world: str | None = None
    bbox: str | None = None

    @property
    def of_a_mission(self) -> list[str]:
        """The options that were given and say something of one mission."""
        given = {
            "--mission": self.mission,
            "--planner": self.planner,
            "--vehicle": self.vehicle,
            "--world": self.world,
            "--bbox": self.bbox,
        }
        return [name for name, value in given.items() if value is not None]


def export_from_options(options: ExportOptions) -> None:
    """Write what is asked for, and say what was written.

    Raises:
        InputError: If the suffix is none that is known, or anything else is wrong with what was asked for.
        MissingDependencyError: If the library of a format is not installed.
        PartError: If the disk fails.
    """
    if options.path.suffix in TABLES:
        _export_results(options)
    elif options.path.suffix.lower() in FORMATS:
        _export_mission(options)
    else:
        expected = f"a name that ends in {' or '.join(TABLES)} (results), or in {' or '.join(FORMATS)} (one mission)"
        raise InputError("export", [Fault(f"{options.path}", expected)])


def _export_results(options: ExportOptions) -> None:
    if options.of_a_mission:
        what = f"{' and '.join(options.of_a_mission)} for {options.path.name}, which holds all missions"
        raise InputError("export", [Fault(what, f"a name that ends in {' or '.join(FORMATS)}, for one mission")])
    with RunStore.read(options.run) as store:
        count = export(store, options.path)
    _say(f"{count} missions in {options.path}")


def _export_mission(options: ExportOptions) -> None:
    if options.bbox is not None and options.world is None:
        raise InputError("export", [Fault("--bbox without --world", "both, or neither")])
    choice = Choice(options.mission, options.planner, options.vehicle)
    found = find_mission(options.run, choice, world=options.world, bbox=parse_bbox(options.bbox))
    size_bytes = export_mission(found, options.path)
    _say(f"{found.name}, {len(found.record.steps)} steps, in {options.path} ({size_bytes / 1000.0:,.0f} kB)")
    if found.record.header.is_judged and found.world is None and options.path.suffix.lower() in {".rrd", ".mcap"}:
        _say("without its ground: the world of the mission was not found; name it with --world")


def _say(line: str) -> None:
    Output().print(line, markup=False, soft_wrap=True)
