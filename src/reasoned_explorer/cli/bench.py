"""``rex bench``: many missions, and the tables that come of them."""

import os
import shlex
import sys
from collections.abc import Iterable, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field, replace
from functools import partial
from importlib.metadata import version
from pathlib import Path

import typer
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from reasoned_explorer.cli.answers import ExitCode, complain
from reasoned_explorer.cli.bench_models import ReadyModels, models_ready, tidy
from reasoned_explorer.cli.console import Output
from reasoned_explorer.cli.model_lines import lines_of_forecast
from reasoned_explorer.cli.models import ModelOptions
from reasoned_explorer.cli.parsing import parse_bbox, parse_levels, parse_planners, parse_seeds
from reasoned_explorer.cli.sheets import print_sheet
from reasoned_explorer.evaluation.bench.notes import Notes, notes_of
from reasoned_explorer.evaluation.bench.plan import BenchPlan, longer
from reasoned_explorer.evaluation.bench.ray_pool import check_address, joined, require_ray
from reasoned_explorer.evaluation.bench.results import Results
from reasoned_explorer.evaluation.bench.runner import BenchProgress, Workers, run_bench, split_of
from reasoned_explorer.evaluation.bench.store import NOTHING_FINISHED, RunStore
from reasoned_explorer.evaluation.bench.tables import (
    Sheet,
    city_sheet,
    difference_sheet,
    headroom_sheet,
    main_sheet,
    more_sheet,
    paper_sheets,
    vehicles_sheet,
)
from reasoned_explorer.evaluation.methods import methods, models_called, sound_methods
from reasoned_explorer.evaluation.mission_settings import MissionSettings
from reasoned_explorer.evaluation.model_access import ModelAccess
from reasoned_explorer.evaluation.model_desk import LOCAL_PREFIX
from reasoned_explorer.exploration.settings import ExplorerSettings
from reasoned_explorer.model import Fault, Gathering, InputError, RecordWriteError, SettingsError
from reasoned_explorer.model.checks import is_there
from reasoned_explorer.task.split import Place, Split
from reasoned_explorer.task.splitting import (
    SPLIT_NAMES,
    Dealing,
    Share,
    built_in_split,
    ceiling_casr,
    places_of_worlds,
)
from reasoned_explorer.vehicles.registry import vehicle_profile
from reasoned_explorer.world.opening import check_world_name

#: What a split of worlds that a person names is dealt from, unless another seed is given.
OWN_SPLIT_SEED = 1
#: What is run where a person names neither a split nor worlds.
SPLIT = "mini"


@dataclass(frozen=True, slots=True)
class BenchOptions:
    """What a person typed; see ``rex bench --help``."""

    split: str | None = None
    planners: str = "default"
    worlds: tuple[str, ...] = ()
    bbox: str | None = None
    per_cell: int | None = None
    split_seed: int | None = None
    levels: str = ""
    seeds: str = "0"
    minds: str = "embedded"
    visionary: str | None = None
    evaluator: str | None = None
    checker: str | None = None
    captioner: str = "noisy"
    picture_px: int = 448
    conditions: str = "clear"
    eyes: str = "pixels"
    vehicle: str = "drone"
    latency: str = "gpt-2023"
    clock: str | None = None
    t_max_min: float = 30.0
    radius_m: float = 15.0
    workers: int | None = None
    ray: str | None = None
    out: Path | None = None
    resume: Path | None = None
    add: str = ""
    traces: bool = True
    quiet: bool = False
    models: ModelOptions = field(default_factory=ModelOptions)

    @property
    def who(self) -> Workers:
        """Who runs the missions: as many processes as this process may use processors, unless told otherwise.

        Raises:
            SettingsError: If that is no number of processes.
        """
        if self.workers is not None and not 1 <= self.workers <= 1024:
            raise SettingsError("--workers", [Fault(f"{self.workers}", "1 to 1,024")])
        return Workers(len(os.sched_getaffinity(0)) if self.workers is None else self.workers, self.ray)

    def who_with(self, models: Sequence[str]) -> Workers:
        """Return who runs missions that call models: one process where one is on this machine, unless told otherwise.

        Raises:
            SettingsError: As `who`.
        """
        own = any(name.startswith(LOCAL_PREFIX) for name in models)
        return replace(self.who, count=1) if own and self.workers is None else self.who


def run_bench_from_options(options: BenchOptions) -> None:
    """Run a benchmark, show how far it is, and print its tables."""
    folder = run_from_options(options)
    with RunStore.read(folder) as store:
        # Where not even one mission is over the budget was too small for it.
        show_sheets(sheets_of(store) if store.finished() else (), store)


def show_sheets(sheets: Iterable[Sheet], store: RunStore) -> None:
    """Print tables of a run, and end with what became of its missions.

    Raises:
        typer.Exit: If a part failed in missions, or missions are left since the budget is spent.
    """
    console = Output()
    for sheet in sheets:
        print_sheet(console, sheet)
    folder, failed = store.folder, store.failed()
    console.print(f"kept in {folder}: rex report {folder} makes a page of it", markup=False, soft_wrap=True)
    if failed:
        complain(f"a part failed in {failed} missions: they count as failures; see the column reason of rex export")
        raise typer.Exit(ExitCode.PART_FAILED)
    if len(store.finished()) < store.plan.count:
        raise typer.Exit(ExitCode.BUDGET_SPENT)


def run_from_options(
    options: BenchOptions, *, names: Sequence[str] | None = None, wrong: Sequence[InputError] = ()
) -> Path:
    """Run a benchmark and return the folder of its run.

    Args:
        options: What was typed.
        names: Methods, where the options' planners do not say them.
        wrong: What else is wrong with what was typed, to be told beside it.

    Raises:
        InputError: If something typed cannot be used.
        MissingDependencyError: If it needs what is not installed.
        RecordWriteError: If the disk is full.
    """
    console = Output(stderr=True)
    if options.ray is not None:
        require_ray()
    with ExitStack() as stack:
        store, ready = _store_of(options, names, wrong, stack)
        folder, plan = store.folder, store.plan
        who = options.who_with(plan.models)
        if not options.quiet:
            lines = about_split(plan.split, plan.vehicles)
            for line in [*lines, *lines_of_forecast(plan, ready.known, workers=who.count)]:
                console.print(line, markup=False, soft_wrap=True)
        access = ready.access(store, options.models, workers=who.count, here=options.ray is None)
        try:
            denied = _run(store, who, access, console, quiet=options.quiet)
        except (KeyboardInterrupt, RecordWriteError):
            complain(f"what is finished is kept: go on with --resume {folder}")
            raise
        if denied is None:
            tidy(folder)
        else:
            complain(f"{denied}: what is finished is kept, and so are the calls of missions that were under way")
            complain(f"go on with --resume {folder}, and another budget if it was spent")
    return folder


def _store_of(
    options: BenchOptions, names: Sequence[str] | None, wrong: Sequence[InputError], stack: ExitStack
) -> tuple[RunStore, ReadyModels]:
    """Return the store of the run that is to be run, and its models; what has to be ended afterwards is put on a stack.

    A cluster is joined before anything is made on disk.
    """
    if options.resume is not None:
        who = options.who
        if options.ray is not None:
            check_address(options.ray)
        more = [item.name for item in methods(parse_planners(options.add))] if options.add else []
        if options.ray is not None:
            stack.enter_context(joined(options.ray, who.count))
        store = stack.enter_context(RunStore.open(options.resume))
        plan = store.plan
        if more:
            plan = longer(plan, more)
        if faults := options.models.faults(plan.models) + _ray_faults(options):
            raise SettingsError("models", faults)
        known = models_ready(options.models, plan, store.models)
        if more:
            store.extend(more)
    else:
        plan = _plan(options, parse_planners(options.planners) if names is None else names, wrong)
        # Asked before anything is made on disk: they may not answer.
        known = models_ready(options.models, plan, {})
        if options.ray is not None:
            stack.enter_context(joined(options.ray, options.who.count))
        store = stack.enter_context(RunStore.create(options.out or _free_folder(plan), plan, _about()))
    return store, known


def about_split(split: Split, vehicles: Sequence[str]) -> list[str]:
    """Return in words what is in a split, and what the oracle could reach in it."""
    lines = split.lines()
    for name in vehicles:
        ceiling = ceiling_casr(split, speed_mps=vehicle_profile(name).speed_mps)
        lines.append(f"CASR ceiling of the oracle, {name}: {ceiling:.2f} (no thinking, cruising speed, shortest way)")
    return [*lines, *split.attributions]


def _run(store: RunStore, who: Workers, access: ModelAccess, console: Console, *, quiet: bool) -> str | None:
    """Run what is left; return why not all of it was run, or None."""
    columns = (
        BarColumn(bar_width=30),
        TextColumn("{task.completed}/{task.total} missions"),
        TextColumn("{task.fields[pace]}", markup=False),
        TimeElapsedColumn(),
    )
    with Progress(*columns, console=console, disable=quiet, refresh_per_second=4) as bar:
        shown = bar.add_task("missions", total=None, pace="starting")

        def on_done(progress: BenchProgress) -> None:
            bar.update(shown, total=progress.total, completed=progress.finished, pace=_pace(progress))

        return run_bench(store, who, on_done, access=access)


def _pace(progress: BenchProgress) -> str:
    if progress.left_s is None:
        return "starting"
    minutes, seconds = divmod(round(progress.left_s), 60)
    return f"{progress.a_second:.1f}/s, {minutes}:{seconds:02d} left, {progress.failed} failed, ${progress.usd:.2f}"


def _plan(options: BenchOptions, names: Sequence[str], wrong: Sequence[InputError]) -> BenchPlan:
    """Return what is to be run; nothing is made on disk before all of it is known to be right.

    Raises:
        SettingsError: With everything that is wrong with what was typed.
        InputError: If no split can be made of it.
    """
    found = Gathering()
    found.add(*wrong)
    if options.add:
        fault = Fault(f"{options.add} without --resume", "a run to add to", "--resume RUN")
        found.add(SettingsError("--add", [fault]))
    if names or not wrong:
        found.check(lambda: methods(names))
    sound = tuple(item.name for item in sound_methods(names)) or ("random",)
    explorer = found.take(lambda: ExplorerSettings(t_max_s=options.t_max_min * 60.0), ExplorerSettings())
    nothing: tuple[int, ...] = ()
    seeds = found.take(lambda: parse_seeds(options.seeds), nothing) or (0,)
    levels = found.take(lambda: parse_levels(options.levels), nothing)
    base = MissionSettings(
        clock=options.clock or "virtual",
        minds=options.minds,
        visionary=options.visionary,
        evaluator=options.evaluator,
        checker=options.checker,
        captioner=options.captioner,
        picture_px=options.picture_px,
        conditions=options.conditions,
        eyes=options.eyes,
        latency=options.latency,
        explorer=explorer,
        success_radius_m=options.radius_m,
    )
    called = models_called(sound, base)
    if called and options.clock is None:
        base = replace(base, clock="mixed")  # real calls take real seconds
    if faults := options.models.faults(called) + _ray_faults(options):
        found.add(SettingsError("models", faults))
    unmade = found.take(
        lambda: BenchPlan(
            split=Split("unmade", 0, (), (), {}),
            methods=sound,
            vehicles=tuple(name.strip() for name in options.vehicle.split(",") if name.strip()),
            base=base,
            seeds=seeds,
            keep_traces=options.traces,
        ),
        None,
    )
    workers = found.take(lambda: options.who, None)
    if options.per_cell is not None and not 1 <= options.per_cell <= 1000:
        found.add(SettingsError("--per-cell", [Fault(f"{options.per_cell}", "1 to 1,000")]))
    if options.split_seed is not None and not 0 <= options.split_seed < 1 << 63:
        found.add(SettingsError("--split-seed", [Fault(f"{options.split_seed}", "a whole number from 0 to 2^63 - 1")]))
    if options.ray is not None:
        address = options.ray
        found.check(lambda: check_address(address))
    if options.out is not None and is_there(options.out) and not _is_empty(options.out):
        fault = Fault(f"{options.out} is there", "a new or empty folder", "or go on with it: --resume")
        found.add(SettingsError("--out", [fault]))
    places = _places(options, found)
    found.finish("benchmark")
    if unmade is None or workers is None or places is None:  # their errors were raised
        raise AssertionError
    return replace(unmade, split=_split(options, *places, levels=levels, workers=workers.count))


def _ray_faults(options: BenchOptions) -> list[Fault]:
    """Return what cannot be had on a cluster: what is kept in files of one machine."""
    given = {"--budget-usd": options.models.budget_usd, "--budget-minutes": options.models.budget_minutes}
    expected = "workers of this machine"
    return [
        Fault(f"{name} beside --ray", expected, "or no budget")
        for name, value in given.items()
        if value is not None and options.ray is not None
    ]


def _is_empty(folder: Path) -> bool:
    return folder.is_dir() and not any(folder.iterdir())


def _places(options: BenchOptions, found: Gathering) -> tuple[tuple[Place, ...], Share, int] | None:
    """Return where the episodes take place, what each place is asked for, and the seed; keep what is wrong."""
    bbox = found.take(lambda: parse_bbox(options.bbox), None)
    if not options.worlds:
        if options.bbox is not None:
            fault = Fault(f"{options.bbox} without --world", "an OpenStreetMap file to crop")
            found.add(SettingsError("--bbox", [fault]))
        built_in = found.take(lambda: built_in_split(options.split or SPLIT), None)
        return None if built_in is None else (built_in.places, built_in.share, built_in.seed)
    if options.split is not None:
        fault = Fault(f"{options.split} beside --world", "one of the two", "worlds make a split of their own")
        found.add(SettingsError("--split", [fault]))
    for world in options.worlds:
        found.check(partial(check_world_name, world, bbox=bbox))
    if found.errors:
        return None  # reading worlds takes long, and something is wrong already
    places = found.take(lambda: places_of_worlds(options.worlds, bbox=bbox), None)
    return None if places is None else (places, Share(2), OWN_SPLIT_SEED)


def _split(
    options: BenchOptions, places: tuple[Place, ...], share: Share, seed: int, *, levels: tuple[int, ...], workers: int
) -> Split:
    name = "own" if options.worlds else options.split or SPLIT
    if options.split_seed is not None or (not options.worlds and options.per_cell is not None):
        name = f"{name}-own"
    dealing = Dealing(
        seed if options.split_seed is None else options.split_seed,
        time_limit_s=options.t_max_min * 60.0,
        radius_m=options.radius_m,
    )
    asked = share if options.per_cell is None else replace(share, per_cell=options.per_cell)
    split = split_of(name, places, share=asked, dealing=dealing, workers=workers)
    return split.only(levels=levels) if levels else split


def _about() -> dict[str, object]:
    packages = ("reasoned-explorer", "numpy", "numba", "shapely")
    command = shlex.join(["rex", *sys.argv[1:]])
    return {"command": command, "versions": {name: version(name) for name in packages}}


def _free_folder(plan: BenchPlan) -> Path:
    stem = f"bench-{plan.split.name.replace('/', '-')}-{'-'.join(plan.vehicles)}"
    folder, number = Path("runs") / stem, 1
    while folder.exists():
        number += 1
        folder = Path("runs") / f"{stem}-{number}"
    return folder


def results_of(store: RunStore, plan: BenchPlan, vehicle: str) -> Results:
    """Return the results of one vehicle of a run."""
    return Results.of(store.rows(vehicle=vehicle), plan.methods)


def notes_on(results: Results, plan: BenchPlan) -> Notes:
    """Return what has to be said of one vehicle of a run."""
    rows = [row for mine in results.rows.values() for row in mine]
    notes = notes_of(rows, total=plan.count // len(plan.vehicles))
    if plan.split.name.split("/")[0] in SPLIT_NAMES:
        return notes
    places = [place.name for place in plan.split.places]
    shown = ", ".join(places[:8]) + (f" and {len(places) - 8} more" if len(places) > 8 else "")
    return replace(notes, once=(*notes.once, f"Places: {shown}."))


def sheets_of(store: RunStore) -> list[Sheet]:
    """Return all tables of a run, vehicle by vehicle.

    Raises:
        InputError: If no mission of the run is finished.
    """
    plan, sheets = store.plan, []
    by_vehicle = {vehicle: results_of(store, plan, vehicle) for vehicle in plan.vehicles}
    by_vehicle = {vehicle: results for vehicle, results in by_vehicle.items() if results.methods}
    if not by_vehicle:
        raise InputError("run", [NOTHING_FINISHED])
    for vehicle, results in by_vehicle.items():
        notes = notes_on(results, plan)
        sheets.append(main_sheet(results, title=f"{plan.split.label}, {vehicle}", notes=notes.lines))
        sheets.append(more_sheet(results, notes=notes.always))
        if len(results.methods) > 1:
            sheets.append(difference_sheet(results, results.methods[0], notes=notes.always))
        headroom = headroom_sheet(results, notes=notes.always)
        if headroom is not None:
            sheets.append(headroom)
        if len(results.cities) > 1:
            sheets.append(city_sheet(results, notes=notes.always))
    if len(by_vehicle) > 1:
        always = dict.fromkeys(line for results in by_vehicle.values() for line in notes_on(results, plan).always)
        sheets.append(vehicles_sheet(by_vehicle, notes=tuple(always)))
    return [*sheets, *paper_sheets(("I", "II") if len(by_vehicle) > 1 else ("I",))]
