"""``rex ablate``: the paper's ablations."""

from collections.abc import Callable
from dataclasses import replace

from rich.console import Console

from reasoned_explorer.cli.bench import BenchOptions, notes_on, results_of, run_from_options
from reasoned_explorer.cli.sheets import print_sheet
from reasoned_explorer.evaluation.bench.ablations import (
    CAPTIONER,
    DEPTH_METHOD,
    LEVELS,
    MINDS_METHOD,
    T_MAX_MIN,
    depth_methods,
    depth_sheet,
    minds_methods,
    minds_sheet,
)
from reasoned_explorer.evaluation.bench.store import NOTHING_FINISHED, RunStore
from reasoned_explorer.evaluation.bench.tables import Sheet
from reasoned_explorer.model import Fault, InputError, RecordError, SettingsError


def ablate_depth(options: BenchOptions, depths: str) -> None:
    """Run LLM-RRT with each depth, and print Table III's form."""
    parts = [part.strip() for part in depths.split(",") if part.strip()]
    faults = [Fault(f"{part!r}", "whole numbers with commas between them") for part in parts if not part.isdecimal()]
    if faults:
        raise SettingsError("--depths", faults)
    _run(options, depth_methods([int(part) for part in parts]), DEPTH_METHOD, "Depth of imagination", depth_sheet)


def ablate_minds(options: BenchOptions, visionaries: str, evaluators: str) -> None:
    """Run LLM-RRT with each visionary and evaluator, and print Table IV's form."""
    listed = [[part.strip() for part in text.split(",") if part.strip()] for text in (visionaries, evaluators)]
    _run(options, minds_methods(*listed), MINDS_METHOD, "Whose minds", minds_sheet)


def _run(
    options: BenchOptions, names: tuple[str, ...], method: str, title: str, sheet_of: Callable[..., Sheet]
) -> None:
    """Run under the paper's conditions and print.

    Args:
        options: What was typed.
        names: Methods.
        method: What the name of each method begins with.
        title: Of the table.
        sheet_of: Makes the table.
    """
    if options.resume is not None:
        _check_resumed(options, method)
    levels = ",".join(map(str, LEVELS))
    options = replace(options, levels=levels, t_max_min=T_MAX_MIN, captioner=CAPTIONER)
    folder = run_from_options(options, names=names)
    sheets = []
    with RunStore.read(folder) as store:
        plan = store.plan
        for vehicle in plan.vehicles:
            results = results_of(store, plan, vehicle)
            about = f"{plan.split.label}, {vehicle}, T_max {T_MAX_MIN:g} min, captions without error"
            if results.methods:
                sheets.append(sheet_of(results, title=f"{title}: {about}", notes=notes_on(results, plan).lines))
    if not sheets:
        raise InputError("run", [NOTHING_FINISHED])
    console = Console(highlight=False)
    for sheet in sheets:
        print_sheet(console, sheet)
    console.print(f"kept in {folder}: rex report {folder} makes a page of it", markup=False, soft_wrap=True)


def _check_resumed(options: BenchOptions, method: str) -> None:
    """Refuse to go on with a run as an ablation that it is not.

    Raises:
        RecordError: If there is no run, or its methods are others.
    """
    if options.resume is None:
        return
    with RunStore.read(options.resume) as store:
        others = [name for name in store.plan.methods if not name.startswith(method)]
    if others:
        fault = Fault(f"{options.resume} runs {', '.join(others)}", f"a run of this ablation ({method}…)", "rex bench")
        raise RecordError("--resume", [fault])
