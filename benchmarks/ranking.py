"""How far rankings of planners can be trusted: does one run rank them as another does, and how many missions tell?

Run::

    python benchmarks/ranking.py FULL MINI [MORE ...]    # runs of rex bench

Prints Kendall's tau-b between the first run and each other, over the planners that both have (bounds left out), for
three metrics; and, from the first run, how many missions and places a paired difference of .02 in CASR per mission
needs between every planner and the best.
"""

import argparse
import itertools
from pathlib import Path

from reasoned_explorer.evaluation.bench.results import Results
from reasoned_explorer.evaluation.bench.store import RunStore
from reasoned_explorer.evaluation.bench.tables import Sheet
from reasoned_explorer.evaluation.methods import method
from reasoned_explorer.evaluation.metrics import paired_differences
from reasoned_explorer.evaluation.statistics import kendall_tau_b, missions_needed

METRICS = ("SR", "SPL", "CASR per mission")


def results_of(folder: Path) -> Results:
    """Return the results of a run's first vehicle, bounds left out."""
    with RunStore.read(folder) as store:
        plan = store.plan
        names = [name for name in plan.methods if not method(name).is_bound]
        rows = [row for row in store.rows(vehicle=plan.vehicles[0]) if row.method in names]
    return Results.of(rows, names)


def values_of(results: Results, metric: str) -> dict[str, float]:
    """Return a metric of each planner."""
    tables = {name: results.table(name) for name in results.methods}
    return {name: table[metric].value for name, table in tables.items() if table is not None}


def tau_sheet(runs: dict[str, Results]) -> Sheet:
    """Return Kendall's tau between the first run and each other."""
    (first, base), *others = runs.items()
    lines = []
    for other, results in others:
        cells = []
        for metric in METRICS:
            ours, theirs = values_of(base, metric), values_of(results, metric)
            common = [name for name in ours if name in theirs]
            tau = kendall_tau_b([ours[name] for name in common], [theirs[name] for name in common])
            cells.append("–" if tau is None else f"{tau:.2f}")
        lines.append((other, f"{len(common)}", *cells))
    return Sheet(f"Kendall's tau-b with the ranking of {first}", ("run", "planners", *METRICS), tuple(lines))


def needed_sheet(results: Results, *, effect: float) -> Sheet:
    """Return how many missions a difference needs, for the pairs of planners in turn with the best one."""
    best = max(results.methods, key=lambda name: (values_of(results, "CASR per mission")[name], name))
    lines = []
    for name, metric in itertools.product(results.methods, ("SR", "CASR per mission")):
        if name == best:
            continue
        mine, its = results.rows[best], results.rows[name]
        differences = paired_differences([row.score for row in mine], [row.score for row in its], name=metric)
        needed = missions_needed(differences, places={row.mission_id: row.place for row in mine}, effect=effect)
        if needed is None:
            continue
        lines.append((f"{best} − {name}", metric, f"{needed.missions}", f"{needed.design_effect:.2f}"))
    title = f"Missions that a paired difference of {effect:g} needs (two-sided 5 %, power .8)"
    return Sheet(title, ("planners", "metric", "missions", "design effect"), tuple(lines))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("runs", nargs="+", type=Path)
    parser.add_argument("--effect", type=float, default=0.02)
    options = parser.parse_args()
    runs = {str(folder): results_of(folder) for folder in options.runs}
    if len(runs) > 1:
        print(tau_sheet(runs).markdown(), end="\n\n")
    print(needed_sheet(next(iter(runs.values())), effect=options.effect).markdown())


if __name__ == "__main__":
    main()
