"""``rex run``."""

import math
import re
from dataclasses import dataclass
from pathlib import Path

import typer
from rich.console import Console

from reasoned_explorer.cli.answers import ExitCode
from reasoned_explorer.cli.parsing import parse_bbox, parse_start
from reasoned_explorer.cli.progress import Progress, header_lines, summary_lines
from reasoned_explorer.evaluation.mission import Mission, MissionResult, MissionSettings
from reasoned_explorer.exploration.settings import ExplorerSettings
from reasoned_explorer.model import Fault, RecordError
from reasoned_explorer.model.checks import is_there
from reasoned_explorer.model.record import MissionEnd, StepRecord
from reasoned_explorer.model.stopping import stop_if_asked
from reasoned_explorer.planning.setting_pairs import parse_planner_settings
from reasoned_explorer.world.files import save_world
from reasoned_explorer.world.opening import KEPT_SUFFIX, open_world

MAP_NAME = "map.png"
WORLD_NAME = f"world{KEPT_SUFFIX}"


@dataclass(frozen=True, slots=True)
class RunOptions:
    """What a person typed; see ``rex run --help``."""

    goal: str
    world: str
    bbox: str | None
    start: str | None
    seed: int
    planner: str
    planner_settings: tuple[str, ...]
    minds: str
    visionary: str | None
    evaluator: str | None
    checker: str | None
    captioner: str
    vehicle: str
    latency: str
    clock: str
    views: int
    sweep_deg: float
    t_max_min: float
    max_steps: int
    looks: int
    radius_m: float
    out: Path | None
    draw: bool
    quiet: bool

    def settings(self) -> MissionSettings:
        """Return the mission's settings.

        Raises:
            SettingsError: If some are out of range.
        """
        return MissionSettings(
            planner=self.planner,
            planner_settings=parse_planner_settings(self.planner_settings),
            minds=self.minds,
            visionary=self.visionary,
            evaluator=self.evaluator,
            checker=self.checker,
            captioner=self.captioner,
            vehicle=self.vehicle,
            latency=self.latency,
            clock=self.clock,
            explorer=ExplorerSettings(
                views=self.views,
                sweep_rad=math.radians(self.sweep_deg),
                t_max_s=self.t_max_min * 60.0,
                max_steps=self.max_steps,
                looks_to_confirm=self.looks,
            ),
            success_radius_m=self.radius_m,
            seed=self.seed,
        )


def run_from_options(options: RunOptions) -> None:
    """Run a mission, show it while it runs, keep its record and its map, and exit with what came of it."""
    console = Console(highlight=False)
    settings = options.settings()
    if not options.quiet and not _kernels_are_compiled():
        console.print("compiling the kernels, which takes up to a minute (the first time only) …", markup=False)
    stop_if_asked()
    world = open_world(options.world, seed=options.seed, bbox=parse_bbox(options.bbox))
    stop_if_asked()
    mission = Mission(options.goal, world, settings, start=parse_start(options.start, world))
    stop_if_asked()
    folder = _folder(options)
    if not options.quiet:
        for line in header_lines(mission.header):
            console.print(line, markup=False, soft_wrap=True)

    progress = Progress()

    def on_step(step: StepRecord) -> None:
        if not options.quiet:
            for line in progress.lines(step):
                console.print(line, markup=False, soft_wrap=True)

    result = mission.run(folder=folder, on_step=on_step)
    for line in summary_lines(result.record):
        console.print(line, markup=False, soft_wrap=True)
    _keep(result, folder, draw=options.draw)
    console.print(f"kept in {folder}", markup=False, soft_wrap=True)
    raise typer.Exit(_exit_code(result))


def _kernels_are_compiled() -> bool:
    """Return whether the kernel that takes longest to compile is in numba's store on disk."""
    from reasoned_explorer.simulation.kernels import run_leg

    return any(Path(run_leg.stats.cache_path).glob("kernels.run_leg-*.nbi"))


def _keep(result: MissionResult, folder: Path, *, draw: bool) -> None:
    stop_if_asked()
    save_world(result.world, folder / WORLD_NAME)
    if draw:
        stop_if_asked()
        result.draw_map(folder / MAP_NAME)


def _exit_code(result: MissionResult) -> ExitCode:
    if result.summary.end is MissionEnd.FAULT:
        return ExitCode.PART_FAILED
    return ExitCode.FOUND if result.summary.success else ExitCode.NOT_FOUND


def _folder(options: RunOptions) -> Path:
    """Return where the run is kept: as given, or the first free name under ``runs/``."""
    if options.out is not None:
        if is_there(options.out) and (not options.out.is_dir() or any(options.out.iterdir())):
            fault = Fault(
                f"{options.out} is there and not an empty folder", "a new or empty folder", "give another --out"
            )
            raise RecordError("--out", [fault])
        return options.out
    world = Path(options.world).name.split(".")[0]
    words = re.sub(r"[^a-z0-9]+", "-", f"{world} {options.goal}".lower()).strip("-")[:60].strip("-")
    stem = f"{words}-{options.planner}-seed{options.seed}"
    folder, number = Path("runs") / stem, 1
    while folder.exists():
        number += 1
        folder = Path("runs") / f"{stem}-{number}"
    return folder
