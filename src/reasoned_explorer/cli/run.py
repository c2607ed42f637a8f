"""``rex run``."""

import asyncio
import math
import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import typer

from reasoned_explorer.cli.answers import ExitCode, complain
from reasoned_explorer.cli.console import Output
from reasoned_explorer.cli.models import ModelOptions
from reasoned_explorer.cli.parsing import BoxDeg, check_start_form, parse_bbox, parse_start
from reasoned_explorer.cli.progress import Progress, header_lines, summary_lines
from reasoned_explorer.cli.vehicles import VehicleOptions
from reasoned_explorer.cli.view import PageOptions, page_beside
from reasoned_explorer.evaluation.field_mission import (
    NO_WORLD,
    FieldMission,
    FieldResult,
    faults_without_world,
    whereabouts,
)
from reasoned_explorer.evaluation.methods import BOUND_METHODS
from reasoned_explorer.evaluation.mission import Mission, MissionResult
from reasoned_explorer.evaluation.mission_course import MissionCourse
from reasoned_explorer.evaluation.mission_settings import MissionSettings, errors_of, models_of
from reasoned_explorer.evaluation.model_desk import ModelDesk
from reasoned_explorer.evaluation.picture_folder import PICTURES_NAME
from reasoned_explorer.evaluation.vehicle_address import VehicleAddress, check_place
from reasoned_explorer.exploration.settings import ExplorerSettings
from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Fault, Gathering, InputError, RecordError, SettingsError
from reasoned_explorer.model.checks import is_there
from reasoned_explorer.model.record import MissionEnd, StepRecord
from reasoned_explorer.model.stopping import stop_if_asked
from reasoned_explorer.planning.setting_pairs import parse_planner_settings
from reasoned_explorer.task.reading import read_goal
from reasoned_explorer.viewer.serving import import_web
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.files import save_world
from reasoned_explorer.world.opening import KEPT_SUFFIX, check_world_name, open_world_with_notes

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
    vehicle: VehicleOptions
    latency: str
    clock: str | None
    views: int
    sweep_deg: float
    t_max_min: float
    max_steps: int
    looks: int
    radius_m: float
    out: Path | None
    draw: bool
    images: bool
    picture_px: int
    conditions: str
    eyes: str
    quiet: bool
    models: ModelOptions
    page: PageOptions | None = None

    @property
    def profile(self) -> str:
        """Name of the vehicle's profile, also where the vehicle is named by its address."""
        with suppress(InputError):
            address = self.vehicle.address
            return self.vehicle.vehicle if address is None else address.profile
        return MissionSettings().vehicle  # what is wrong with the address is told by itself

    def settings(self, found: Gathering) -> MissionSettings:
        """Return the mission's settings; what is wrong with them is kept in ``found``, defaults in its stead."""
        explorer = found.take(self._explorer, ExplorerSettings())
        found.check(lambda: parse_planner_settings(self.planner_settings))
        sound: dict[str, Any] = {}
        for pair in self.planner_settings:
            with suppress(SettingsError):
                sound |= parse_planner_settings([pair])
        settings = MissionSettings(
            planner=self.planner,
            planner_settings=sound,
            minds=self.minds,
            visionary=self.visionary,
            evaluator=self.evaluator,
            checker=self.checker,
            captioner=self.captioner,
            vehicle=self.profile,
            latency=self.latency,
            explorer=explorer,
            success_radius_m=self.radius_m,
            seed=self.seed,
            picture_px=self.picture_px,
            conditions=self.conditions,
            eyes=self.eyes,
        )
        # Models that are called take real seconds.
        settings = replace(settings, clock=self.clock or self._usual_clock(models_of(settings)))
        found.add(*errors_of(settings))
        if self.is_afield:
            found.check(lambda: self._check_afield(settings))
        self.models.check(settings, found)
        if self.planner in BOUND_METHODS or "+" in self.planner or ":" in self.planner or "@" in self.planner:
            fault = Fault(f"{self.planner!r}", "a planner by its name alone", "it may be a row of rex bench --planners")
            found.add(SettingsError("--planner", [fault]))
        return settings

    @property
    def is_afield(self) -> bool:
        """Whether no world is known, as outdoors."""
        return self.world.strip().lower() == NO_WORLD

    def _check_afield(self, settings: MissionSettings) -> None:
        """Check what a mission without a world must and must not be given.

        Raises:
            SettingsError: With everything that is wrong.
        """
        address = None
        with suppress(InputError):  # what is wrong with the address is told by itself
            address = self.vehicle.address
        faults = faults_without_world(settings, address, vehicle=self.vehicle.vehicle)
        if address is None and ":" in self.vehicle.vehicle:
            del faults[0]
        given = {"--bbox": self.bbox, "--start": self.start}
        here = "it begins where the vehicle says that it stands"
        faults += [Fault(f"{name} without a world", "none", here) for name, value in given.items() if value is not None]
        taped = {"--resume": self.models.resume, "--replay": self.models.replay}
        again = "a mission in a world, which shows the same again"
        faults += [Fault(f"{name} without a world", again) for name, value in taped.items() if value is not None]
        if faults:
            raise SettingsError(f"--world {NO_WORLD}", faults)

    def _usual_clock(self, models: Sequence[str]) -> str:
        if self.is_afield:
            return "real"
        with suppress(InputError):
            address = self.vehicle.address
            if address is not None and address.may_be_real:
                return "real"
        return "mixed" if models else "virtual"

    def _explorer(self) -> ExplorerSettings:
        return ExplorerSettings(
            views=self.views,
            sweep_rad=math.radians(self.sweep_deg),
            t_max_s=self.t_max_min * 60.0,
            max_steps=self.max_steps,
            looks_to_confirm=self.looks,
        )

    def checked(self) -> tuple[MissionSettings, BoxDeg | None, Path]:
        """Return settings, bounding box and folder, once all that was typed has been checked.

        Nothing has been made or read then. Where a start lies is checked when its world is there.

        Raises:
            InputError: With everything that is wrong.
        """
        found = Gathering()
        found.check(lambda: read_goal(self.goal))
        bbox = found.take(lambda: parse_bbox(self.bbox), None)
        seed = max(self.seed, 0)  # a wrong one is told once, as the mission's
        if not self.is_afield:
            found.check(lambda: check_world_name(self.world, seed=seed, bbox=bbox))
        found.check(lambda: check_start_form(self.start))
        settings = self.settings(found)
        self.vehicle.check(found)
        if self.page is not None:
            found.check(self.page.guard)
        folder = found.take(lambda: _folder(self), Path())
        found.finish("mission")
        return settings, bbox, folder


def run_from_options(options: RunOptions) -> None:
    """Run a mission, show it while it runs, keep its record and its map, and exit with what came of it."""
    console = Output()
    settings, bbox, folder = options.checked()
    if options.page is not None:
        import_web("uvicorn")  # before anything is made: whoever lacks it is to know now
    if not options.quiet and not _kernels_are_compiled():
        console.print("compiling the kernels, which takes up to a minute (the first time only) …", markup=False)
    stop_if_asked()
    if options.is_afield:
        _run_afield(options, settings, folder, console)
        return
    world, notes = open_world_with_notes(options.world, seed=options.seed, bbox=bbox)
    for note in notes:
        complain(f"note: {note}; choose a part with --bbox")
    stop_if_asked()
    desk = options.models.desk()
    options.models.agree(desk, settings.captioner, [world.name] if world.origin is not None else [])
    atlas = Atlas(world)
    start, home = _start(options, atlas, options.vehicle.address)
    with options.vehicle.guarding(is_real=settings.clock == "real") as guarding:
        mission = Mission(
            options.goal,
            atlas,
            settings,
            start=start,
            desk=desk,
            pictures=folder / PICTURES_NAME if options.images else None,
            guarding=guarding and replace(guarding, home=home),
        )
        with _page(options, folder) as wait:
            with _shown(options, mission, folder, desk, console) as on_step:
                result = mission.run(folder=folder, on_step=on_step)
            code = _finish(options, result, folder, desk, console)
            wait()
    raise typer.Exit(code)


def _run_afield(options: RunOptions, settings: MissionSettings, folder: Path, console: Output) -> None:
    """Run a mission of which no world is known."""
    desk = options.models.desk()
    options.models.agree(desk, settings.captioner, [f"what {options.vehicle.vehicle} sees"])
    with options.vehicle.guarding(is_real=settings.clock == "real") as guarding:
        if guarding is None:  # what was typed has been checked
            raise AssertionError
        mission = FieldMission(
            options.goal,
            settings,
            guarding,
            there=asyncio.run(whereabouts(guarding)),
            desk=desk,
            pictures=folder / PICTURES_NAME if options.images else None,
        )
        with _page(options, folder) as wait:
            with _shown(options, mission, folder, desk, console) as on_step:
                result = mission.run(folder=folder, on_step=on_step)
            code = _finish(options, result, folder, desk, console)
            wait()
    raise typer.Exit(code)


def _finish(
    options: RunOptions, result: MissionResult | FieldResult, folder: Path, desk: ModelDesk, console: Output
) -> ExitCode:
    """Say what came of a mission, keep its map, and return what to exit with."""
    for line in summary_lines(result.record):
        console.print(line, markup=False, soft_wrap=True)
    _keep(result, folder, draw=options.draw)
    console.print(f"kept in {folder}", markup=False, soft_wrap=True)
    if isinstance(result, MissionResult):
        options.models.say_how_to_go_on(desk, folder)
    return _exit_code(result)


@contextmanager
def _page(options: RunOptions, folder: Path) -> Iterator[Callable[[], None]]:
    """Show a mission on a page, if that was asked for; gives what waits until a person has seen enough of it."""
    if options.page is None:
        yield lambda: None
        return
    with page_beside(folder, options.page) as wait:
        yield wait


@contextmanager
def _shown(
    options: RunOptions, mission: MissionCourse, folder: Path, desk: ModelDesk, console: Output
) -> Iterator[Callable[[StepRecord], None]]:
    """Show a mission while it runs, and keep its calls; gives what is told each step."""
    stop_if_asked()
    if not options.quiet:
        for line in header_lines(mission.header):
            console.print(line, markup=False, soft_wrap=True)
    else:
        for note in mission.header.notes:
            complain(f"note: {note}")

    progress = Progress()

    def on_step(step: StepRecord) -> None:
        if not options.quiet:
            for line in progress.lines(step):
                console.print(line, markup=False, soft_wrap=True)

    with options.models.taping(desk, mission, folder):
        yield on_step


def _start(options: RunOptions, atlas: Atlas, address: VehicleAddress | None) -> tuple[Pose | None, Pose | None]:
    """Return where the mission begins, and where the vehicle's own frame does.

    As typed, or where the vehicle at an address stands; None for a random start, and for a frame that begins there.
    """
    start = parse_start(options.start, atlas.world)
    if address is None:
        return start, None
    place = asyncio.run(address.place())
    if place is None and start is not None:
        return start, None
    place = check_place(place, atlas.digest, address)
    return start or place.start, place.home


def _kernels_are_compiled() -> bool:
    """Return whether the kernel that takes longest to compile is in numba's store on disk."""
    from reasoned_explorer.simulation.kernels import run_leg

    return any(Path(run_leg.stats.cache_path).glob("kernels.run_leg-*.nbi"))


def _keep(result: MissionResult | FieldResult, folder: Path, *, draw: bool) -> None:
    stop_if_asked()
    if isinstance(result, MissionResult):
        save_world(result.world, folder / WORLD_NAME)
    if draw:
        stop_if_asked()
        result.draw_map(folder / MAP_NAME)


def _exit_code(result: MissionResult | FieldResult) -> ExitCode:
    summary = result.summary
    if summary.end is MissionEnd.FAULT:
        return ExitCode.PART_FAILED
    # Where nobody judges, the agent's word is all that there is.
    found = summary.declared if summary.success is None else summary.success
    return ExitCode.FOUND if found else ExitCode.NOT_FOUND


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
