"""``rex bench``, ``rex compare``, ``rex export``: many missions, and what comes of them."""

import os
import shlex
import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace
from importlib.metadata import version
from pathlib import Path

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn

from reasoned_explorer.cli.answers import complain
from reasoned_explorer.cli.parsing import parse_bbox
from reasoned_explorer.cli.sheets import print_sheet
from reasoned_explorer.evaluation.bench.export import export
from reasoned_explorer.evaluation.bench.notes import notes_of
from reasoned_explorer.evaluation.bench.plan import BenchPlan
from reasoned_explorer.evaluation.bench.runner import BenchProgress, Workers, run_bench, split_of
from reasoned_explorer.evaluation.bench.store import RunStore
from reasoned_explorer.evaluation.bench.tables import (
    Results,
    Sheet,
    city_sheet,
    compared_sheet,
    difference_sheet,
    main_sheet,
    more_sheet,
    paper_sheets,
)
from reasoned_explorer.evaluation.methods import methods
from reasoned_explorer.evaluation.mission_settings import MissionSettings
from reasoned_explorer.exploration.settings import ExplorerSettings
from reasoned_explorer.model import Fault, InputError, SettingsError
from reasoned_explorer.task.split import Split
from reasoned_explorer.task.splitting import Dealing, ceiling_casr, generated_places, places_of_worlds
from reasoned_explorer.vehicles.registry import vehicle_profile

#: What a split of worlds that a person names is dealt from, unless another seed is given.
OWN_SPLIT_SEED = 1


@dataclass(frozen=True, slots=True)
class BenchOptions:
    """What a person typed; see ``rex bench --help``."""

    split: str = "mini"
    planners: str = "default"
    worlds: tuple[str, ...] = ()
    bbox: str | None = None
    per_cell: int | None = None
    split_seed: int | None = None
    levels: tuple[int, ...] = ()
    seeds: str = "0"
    minds: str = "embedded"
    visionary: str | None = None
    evaluator: str | None = None
    checker: str | None = None
    captioner: str = "noisy"
    vehicle: str = "drone"
    latency: str = "gpt-2023"
    clock: str = "virtual"
    t_max_min: float = 30.0
    radius_m: float = 15.0
    workers: int | None = None
    ray: str | None = None
    out: Path | None = None
    resume: Path | None = None
    traces: bool = True
    quiet: bool = False

    @property
    def who(self) -> Workers:
        """Who runs the missions: as many processes as this process may use processors, unless told otherwise."""
        return Workers(self.workers or len(os.sched_getaffinity(0)), self.ray)


def run_bench_from_options(options: BenchOptions) -> None:
    """Run a benchmark, show how far it is, and print its tables."""
    folder = run_from_options(options)
    console = Console(highlight=False)
    with RunStore.open(folder) as store:
        for sheet in sheets_of(store):
            print_sheet(console, sheet)
    console.print(f"kept in {folder}: rex report {folder} makes a page of it", markup=False, soft_wrap=True)


def run_from_options(options: BenchOptions, *, names: Sequence[str] | None = None) -> Path:
    """Run a benchmark and return the folder of its run.

    Args:
        options: What was typed.
        names: Methods, where the options' planners do not say them.

    Raises:
        InputError: If something typed cannot be used.
        RecordWriteError: If the disk is full.
    """
    console = Console(highlight=False, stderr=True)
    if options.resume is not None:
        folder, store = options.resume, RunStore.open(options.resume)
    else:
        plan = _plan(options, names or [name.strip() for name in options.planners.split(",") if name.strip()])
        folder = options.out or _free_folder(plan)
        store = RunStore.create(folder, plan, _about())
    with store:
        if not options.quiet:
            for line in about_split(store.plan.split, store.plan.vehicles):
                console.print(line, markup=False, soft_wrap=True)
        try:
            _run(store, options, console)
        except KeyboardInterrupt:
            complain(f"stopped; what is finished is kept: rex bench --resume {folder}")
            raise
    return folder


def about_split(split: Split, vehicles: Sequence[str]) -> list[str]:
    """Return in words what is in a split, and what the oracle could reach in it."""
    lines = split.lines()
    for name in vehicles:
        ceiling = ceiling_casr(split, speed_mps=vehicle_profile(name).speed_mps)
        lines.append(f"CASR ceiling of the oracle, {name}: {ceiling:.2f} (no thinking, cruising speed, shortest way)")
    return [*lines, *split.attributions]


def _run(store: RunStore, options: BenchOptions, console: Console) -> None:
    columns = (
        BarColumn(bar_width=30),
        TextColumn("{task.completed}/{task.total} missions"),
        TextColumn("{task.fields[pace]}", markup=False),
        TimeElapsedColumn(),
    )
    with Progress(*columns, console=console, disable=options.quiet, refresh_per_second=4) as bar:
        shown = bar.add_task("missions", total=None, pace="starting")

        def on_done(progress: BenchProgress) -> None:
            bar.update(shown, total=progress.total, completed=progress.finished, pace=_pace(progress))

        run_bench(store, options.who, on_done)


def _pace(progress: BenchProgress) -> str:
    if progress.left_s is None:
        return "starting"
    minutes, seconds = divmod(round(progress.left_s), 60)
    return f"{progress.a_second:.1f}/s, {minutes}:{seconds:02d} left, {progress.failed} failed, ${progress.usd:.2f}"


def _plan(options: BenchOptions, names: Sequence[str]) -> BenchPlan:
    chosen = methods(names)
    base = MissionSettings(
        minds=options.minds,
        visionary=options.visionary,
        evaluator=options.evaluator,
        checker=options.checker,
        captioner=options.captioner,
        latency=options.latency,
        clock=options.clock,
        explorer=ExplorerSettings(t_max_s=options.t_max_min * 60.0),
        success_radius_m=options.radius_m,
    )
    # Names and numbers are checked before worlds are made, which takes seconds.
    unmade = BenchPlan(
        split=Split("unmade", 0, (), (), {}),
        methods=tuple(item.name for item in chosen),
        vehicles=tuple(name.strip() for name in options.vehicle.split(",") if name.strip()),
        base=base,
        seeds=_seeds(options.seeds),
        keep_traces=options.traces,
    )
    return replace(unmade, split=_split(options))


def _split(options: BenchOptions) -> Split:
    faults = []
    if options.per_cell is not None and not 1 <= options.per_cell <= 1000:
        faults.append(Fault(f"--per-cell {options.per_cell}", "1 to 1,000"))
    if options.workers is not None and not 1 <= options.workers <= 1024:
        faults.append(Fault(f"--workers {options.workers}", "1 to 1,024"))
    if faults:
        raise SettingsError("benchmark", faults)
    if options.worlds:
        places = places_of_worlds(options.worlds, bbox=parse_bbox(options.bbox))
        name, per_cell, seed = "own", options.per_cell or 2, OWN_SPLIT_SEED
    else:
        places, per_cell, seed = generated_places(options.split)
        name, per_cell = options.split, options.per_cell or per_cell
    if options.split_seed is not None or (not options.worlds and options.per_cell):
        name, seed = f"{name}-own", options.split_seed if options.split_seed is not None else seed
    dealing = Dealing(seed, radius_m=options.radius_m)
    split = split_of(name, places, per_cell=per_cell, dealing=dealing, workers=options.who.count)
    return split.only(levels=options.levels) if options.levels else split


def _seeds(text: str) -> tuple[int, ...]:
    faults, seeds = [], []
    for part in text.split(","):
        if part.strip().isdecimal():
            seeds.append(int(part))
        else:
            faults.append(Fault(f"{part.strip()!r}", "whole numbers from 0 with commas between them"))
    if faults:
        raise SettingsError("--seeds", faults)
    return tuple(seeds)


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


def results_of(store: RunStore, vehicle: str) -> Results:
    """Return the results of one vehicle of a run."""
    return Results.of(store.rows(vehicle=vehicle), store.plan.methods)


def sheets_of(store: RunStore) -> list[Sheet]:
    """Return all tables of a run, vehicle by vehicle.

    Raises:
        InputError: If no mission of the run is finished.
    """
    plan, sheets = store.plan, []
    for vehicle in plan.vehicles:
        results = results_of(store, vehicle)
        if not results.methods:
            continue
        notes = notes_of(results, plan, finished=sum(len(mine) for mine in results.rows.values()))
        sheets.append(main_sheet(results, title=f"{plan.split.label}, {vehicle}", notes=notes))
        sheets.append(more_sheet(results))
        if len(results.methods) > 1:
            sheets.append(difference_sheet(results, results.methods[0]))
        if len(results.cities()) > 1:
            sheets.append(city_sheet(results))
    if not sheets:
        raise InputError("run", [Fault("no mission is finished", "at least one", "go on with rex bench --resume")])
    return [*sheets, *paper_sheets()]


def compare_runs(first: str, second: str) -> None:
    """Print paired differences between two runs, or two methods of runs, on the missions that both have."""
    console = Console(highlight=False)
    (one, one_method), (other, other_method) = _run_and_method(first), _run_and_method(second)
    with RunStore.open(one) as ours, RunStore.open(other) as theirs:
        for vehicle in ours.plan.vehicles:
            mine, its = results_of(ours, vehicle), results_of(theirs, vehicle)
            sheet = compared_sheet(mine, its, names=(first, second), methods=(one_method, other_method))
            print_sheet(console, sheet)


def _run_and_method(text: str) -> tuple[Path, str | None]:
    """Return the run and the method that ``RUN`` or ``RUN::METHOD`` means."""
    folder, _, name = text.partition("::")
    return Path(folder), name or None


def export_run(run: Path, path: Path) -> None:
    """Write a run's results into a CSV or Parquet file."""
    with RunStore.open(run) as store:
        count = export(store, path)
    Console(highlight=False).print(f"{count} missions in {path}", markup=False, soft_wrap=True)
