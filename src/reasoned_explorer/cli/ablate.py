"""``rex ablate``: the paper's ablations."""

from dataclasses import replace

from rich.console import Console

from reasoned_explorer.cli.bench import BenchOptions, results_of, run_from_options
from reasoned_explorer.cli.sheets import print_sheet
from reasoned_explorer.evaluation.bench.ablations import (
    CAPTIONER,
    LEVELS,
    T_MAX_MIN,
    depth_methods,
    depth_sheet,
    minds_methods,
    minds_sheet,
)
from reasoned_explorer.evaluation.bench.notes import notes_of
from reasoned_explorer.evaluation.bench.store import RunStore
from reasoned_explorer.model import Fault, SettingsError


def ablate_depth(options: BenchOptions, depths: str) -> None:
    """Run LLM-RRT with each depth, and print Table III's form."""
    parts = [part.strip() for part in depths.split(",") if part.strip()]
    faults = [Fault(f"{part!r}", "whole numbers with commas between them") for part in parts if not part.isdecimal()]
    if faults:
        raise SettingsError("--depths", faults)
    _run(options, depth_methods([int(part) for part in parts]), by_depth=True)


def ablate_minds(options: BenchOptions, visionaries: str, evaluators: str) -> None:
    """Run LLM-RRT with each visionary and evaluator, and print Table IV's form."""
    listed = [[part.strip() for part in text.split(",") if part.strip()] for text in (visionaries, evaluators)]
    _run(options, minds_methods(*listed), by_depth=False)


def _run(options: BenchOptions, names: tuple[str, ...], *, by_depth: bool) -> None:
    """Run under the paper's conditions and print."""
    options = replace(options, levels=LEVELS, t_max_min=T_MAX_MIN, captioner=CAPTIONER)
    folder = run_from_options(options, names=names)
    console = Console(highlight=False)
    with RunStore.open(folder) as store:
        plan = store.plan
        for vehicle in plan.vehicles:
            results = results_of(store, vehicle)
            notes = notes_of(results, plan, finished=sum(len(mine) for mine in results.rows.values()))
            about = f"{plan.split.label}, {vehicle}, T_max {T_MAX_MIN:g} min, captions without error"
            if by_depth:
                sheet = depth_sheet(results, title=f"Depth of imagination: {about}", notes=notes)
            else:
                sheet = minds_sheet(results, title=f"Whose minds: {about}", notes=notes)
            print_sheet(console, sheet)
    console.print(f"kept in {folder}", markup=False, soft_wrap=True)
