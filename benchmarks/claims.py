"""What a run says of the paper's claims: the tables of docs/results.md, in Markdown, from runs of rex bench.

Run::

    python benchmarks/claims.py RUN              # a run with the planners, controls and bounds
    python benchmarks/claims.py RUN --only all   # or levels, pairs, headroom, causes

The pairs are those that a claim needs: imagining against the same minds without it, against the same calls spent
otherwise, against what was imagined for another view, against baselines without a model; and ours. Differences are
paired by mission, intervals are resampled by place, p-values are of SR and corrected for the number of pairs (Holm).
"""

import argparse
from collections import Counter
from collections.abc import Callable
from pathlib import Path

from reasoned_explorer.evaluation.bench.results import Results, corrected, p_of
from reasoned_explorer.evaluation.bench.store import RunStore
from reasoned_explorer.evaluation.bench.tables import Sheet, headroom_sheet
from reasoned_explorer.evaluation.report.causes import Cause, cause_of
from reasoned_explorer.evaluation.wording import figure, level_name, whole

UNKNOWING = "@embedded-unknowing/embedded-unknowing"
#: What is asked, the two methods whose difference answers.
PAIRS = (
    ("imagining, the checks and travel as they are", "llm-rrt", "llm-as-eval"),
    ("imagining against echoing what is seen", "llm-rrt", "llm-rrt-echo"),
    ("imagined for this view or for another", "llm-rrt", "llm-rrt-shuffled"),
    ("as many evaluator calls, none imagined", "llm-rrt", "llm-as-eval-matched"),
    ("all at once against one after the other", "llm-rrt", "llm-mcts"),
    ("the paper's text against the authors' code", "llm-rrt", "llm-rrt-authors"),
    ("a mind against none", "llm-rrt", "nearest-frontier"),
    ("a mind against paths", "llm-rrt", "follow-paths"),
    ("a mind against density", "llm-rrt", "object-density"),
    ("a mind against chance", "llm-rrt", "random"),
    ("the evaluator alone against none", "llm-as-eval", "nearest-frontier"),
    ("the evaluator alone against density", "llm-as-eval", "object-density"),
    ("knowledge of places, imagining", "llm-rrt", f"llm-rrt{UNKNOWING}"),
    ("knowledge of places, the evaluator alone", "llm-as-eval", f"llm-as-eval{UNKNOWING}"),
    ("ours", "fresh-ground", "llm-rrt"),
    ("ours", "fresh-ground", "llm-as-eval"),
    ("ours", "fresh-ground", "object-density"),
    ("halting, imagining", "llm-rrt+perfect-halt", "llm-rrt"),
    ("halting, the evaluator alone", "llm-as-eval+perfect-halt", "llm-as-eval"),
    ("halting, ours", "fresh-ground+perfect-halt", "fresh-ground"),
    ("foresight of 30 m", "foresight-30m", "follow-paths"),
    ("foresight of 60 m", "foresight-60m", "follow-paths"),
)
SHOWN = ("SR", "OSR", "SPL", "CASR", "CASR per mission")


def all_sheet(results: Results) -> Sheet:
    """Return each method over all levels."""
    lines = []
    for name in results.methods:
        table, rows = results.table(name), results.rows[name]
        if table is not None:
            calls = whole(sum(row.calls for row in rows) / len(rows))
            cells = [figure(table[shown]) for shown in SHOWN]
            lines.append((name, *cells, whole(table["CT"].value), whole(table["TT"].value), calls))
    return Sheet("All levels", ("planner", *SHOWN, "CT s", "TT s", "calls"), tuple(lines))


def levels_sheet(results: Results) -> Sheet:
    """Return SR / OSR of each method at each level."""
    lines = []
    for name in results.methods:
        cells = []
        for level in results.levels:
            table = results.table(name, level)
            shown = [] if table is None else [figure(table[what], interval=False) for what in ("SR", "OSR")]
            cells.append(" / ".join(shown))
        lines.append((name, *cells))
    return Sheet("SR / OSR by level", ("planner", *map(level_name, results.levels)), tuple(lines))


def pairs_sheet(results: Results) -> Sheet:
    """Return the differences that the claims need."""
    found = {
        (asked, one, other): table
        for asked, one, other in PAIRS
        if {one, other} <= set(results.methods) and (table := results.difference(one, other)) is not None
    }
    p_values = corrected({f"{one} − {other}": table for (_, one, other), table in found.items()}, "SR")
    lines = [
        (
            asked,
            f"{one} − {other}".replace(UNKNOWING, " (unknowing)"),
            *(figure(table[shown]) for shown in SHOWN),
            f"{p_of(table, 'SR'):.3f}",
            f"{p_values[f'{one} − {other}']:.3f}",
        )
        for (asked, one, other), table in found.items()
    ]
    return Sheet("Paired differences", ("what", "planners", *SHOWN, "p (SR)", "corrected"), tuple(lines))


def causes_sheet(results: Results) -> Sheet:
    """Return how missions ended."""
    causes = [cause for cause in Cause if any(cause_of(row) is cause for mine in results.rows.values() for row in mine)]
    lines = []
    for name, mine in results.rows.items():
        count = Counter(cause_of(row) for row in mine)
        hits = [
            sum(getattr(row, size) for row in mine) / len(mine) for size in ("small_collisions", "large_collisions")
        ]
        lines.append((name, *(f"{count[cause]}" for cause in causes), *(f"{hit:.1f}" for hit in hits)))
    head = ("planner", *(cause.value for cause in causes), "small things hit", "large things hit")
    return Sheet("How missions ended (counts); collisions a mission", head, tuple(lines))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", type=Path)
    parser.add_argument("--only", nargs="+", choices=("all", "levels", "pairs", "headroom", "causes"))
    options = parser.parse_args()
    with RunStore.read(options.run) as store:
        plan = store.plan
        results = Results.of(store.rows(vehicle=plan.vehicles[0]), plan.methods)
        print("\n".join(plan.split.lines()), end="\n\n")
    sheets: dict[str, Callable[[Results], Sheet | None]] = {
        "all": all_sheet,
        "levels": levels_sheet,
        "pairs": pairs_sheet,
        "headroom": headroom_sheet,
        "causes": causes_sheet,
    }
    for name, make in sheets.items():
        sheet = make(results) if options.only is None or name in options.only else None
        if sheet is not None:
            print(sheet.markdown(), end="\n\n")


if __name__ == "__main__":
    main()
