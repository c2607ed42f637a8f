"""``rex ablate``: the paper's ablations."""

from collections.abc import Callable
from dataclasses import replace

from reasoned_explorer.cli.bench import BenchOptions, notes_on, results_of, run_from_options, show_sheets
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
from reasoned_explorer.evaluation.bench.results import Results
from reasoned_explorer.evaluation.bench.store import RunStore
from reasoned_explorer.evaluation.bench.tables import Sheet
from reasoned_explorer.model import Fault, Gathering, RecordError, SettingsError

#: The split of an ablation where a person names neither a split nor worlds.
SPLIT = "full"


def ablate_depth(options: BenchOptions, depths: str) -> None:
    """Run LLM-RRT with each depth, and print Table III's form."""
    parts = [part.strip() for part in depths.split(",") if part.strip()]
    wrong = [part for part in parts if not (part.isascii() and part.isdecimal() and len(part) < 10)]
    found = Gathering()
    if wrong:
        expected = "whole numbers with commas between them"
        found.add(SettingsError("--depths", [Fault(f"{part!r}", expected) for part in wrong]))
    numbers = [int(part) for part in parts if part not in wrong]
    nothing: tuple[str, ...] = ()
    names = nothing if wrong and not numbers else found.take(lambda: depth_methods(numbers), nothing)
    _run(options, names, found, method=DEPTH_METHOD, title="Depth of imagination", sheet_of=depth_sheet)


def ablate_minds(options: BenchOptions, visionaries: str, evaluators: str) -> None:
    """Run LLM-RRT with each visionary and evaluator, and print Table IV's form."""
    listed = [[part.strip() for part in text.split(",") if part.strip()] for text in (visionaries, evaluators)]
    found = Gathering()
    found.check(lambda: minds_methods(*listed))
    # Where a role has none, the minds of the other are still looked up.
    names = minds_methods(*(names or ["embedded"] for names in listed))
    _run(options, names, found, method=MINDS_METHOD, title="Whose minds", sheet_of=minds_sheet)


def _run(
    options: BenchOptions,
    names: tuple[str, ...],
    found: Gathering,
    *,
    method: str,
    title: str,
    sheet_of: Callable[..., Sheet],
) -> None:
    """Run under the paper's conditions and print.

    Args:
        options: What was typed.
        names: Methods.
        found: What is wrong with what was typed.
        method: What the name of each method begins with.
        title: Of the table.
        sheet_of: Makes the table.
    """
    if options.resume is not None:
        _check_resumed(options, method)
    levels = ",".join(map(str, LEVELS))
    split = options.split or (None if options.worlds else SPLIT)
    options = replace(options, split=split, levels=levels, t_max_min=T_MAX_MIN, captioner=CAPTIONER)
    folder = run_from_options(options, names=names, wrong=found.errors)
    sheets = []
    with RunStore.read(folder) as store:
        plan = store.plan
        for vehicle in plan.vehicles:
            # More planners may have been added to the run: they are none of this table's.
            of_all = results_of(store, plan, vehicle)
            results = Results({name: rows for name, rows in of_all.rows.items() if name.startswith(method)})
            about = f"{plan.split.label}, {vehicle}, T_max {T_MAX_MIN:g} min, captions without error"
            if results.methods:
                sheets.append(sheet_of(results, title=f"{title}: {about}", notes=notes_on(of_all, plan).lines))
        show_sheets(sheets, store)


def _check_resumed(options: BenchOptions, method: str) -> None:
    """Refuse to go on with a run as an ablation that it is not; planners that were added to it do no harm.

    Raises:
        RecordError: If there is no run, its methods are others, or it was run under other conditions.
    """
    if options.resume is None:
        return
    with RunStore.read(options.resume) as store:
        plan = store.plan
    levels = {item.episode.spec.level for item in plan.split.episodes}
    t_max_min, captioner = plan.base.explorer.t_max_s / 60.0, plan.base.captioner
    if not any(name.startswith(method) for name in plan.methods):
        said = f"{options.resume} runs {', '.join(plan.methods)}"
    elif (levels, t_max_min, captioner) != (set(LEVELS), T_MAX_MIN, CAPTIONER):
        listed = ", ".join(map(str, sorted(levels)))
        said = f"{options.resume} runs levels {listed}, T_max {t_max_min:g} min, captioner {captioner}"
    else:
        return
    conditions = f"level 1, T_max {T_MAX_MIN:g} min, captioner {CAPTIONER}"
    raise RecordError("--resume", [Fault(said, f"a run of this ablation ({method}…; {conditions})", "rex bench")])
