"""The paper's ablations (section V-D), with whatever minds are given: how far to think ahead, and who thinks."""

import math
import statistics
from collections.abc import Sequence
from itertools import product

from reasoned_explorer.evaluation.bench.results import Results
from reasoned_explorer.evaluation.bench.tables import Sheet
from reasoned_explorer.evaluation.paper import PAPER_TABLES, PaperTable
from reasoned_explorer.evaluation.row import MissionRow
from reasoned_explorer.evaluation.wording import NONE, figure, share, whole
from reasoned_explorer.model import Fault, SettingsError

#: The paper's conditions: level 1 only, T_max of 15 minutes, no caption error.
LEVELS, T_MAX_MIN, CAPTIONER = (1,), 15.0, "perfect"
DEPTHS = (0, 1, 2, 3, 4)
#: What the methods' names begin with: before the depth, and before the minds.
DEPTH_METHOD, MINDS_METHOD = "llm-rrt:depth=", "llm-rrt@"
_NOTE = (
    "σ is the standard deviation of CASR over missions; the paper does not say what its σ is taken over. Its figures "
    "are of another simulator and of GPT-3.5 and GPT-4."
)


def depth_methods(depths: Sequence[int] = DEPTHS) -> tuple[str, ...]:
    """Return the methods of Table III: LLM-RRT with each depth L.

    Raises:
        SettingsError: If a depth is out of range or stands twice, or there is none.
    """
    if not depths or len(set(depths)) < len(depths) or any(not 0 <= depth <= 16 for depth in depths):
        shown = ", ".join(map(str, depths)) or "none"
        raise SettingsError("depths", [Fault(shown, "whole numbers from 0 to 16, each once")])
    return tuple(f"{DEPTH_METHOD}{depth}" for depth in depths)


def minds_methods(visionaries: Sequence[str], evaluators: Sequence[str]) -> tuple[str, ...]:
    """Return the methods of Table IV: LLM-RRT with each visionary and each evaluator.

    Raises:
        SettingsError: If there is none of one of them.
    """
    if not visionaries or not evaluators:
        raise SettingsError("minds", [Fault("no visionary or no evaluator", "at least one of each")])
    return tuple(f"{MINDS_METHOD}{visionary}/{evaluator}" for visionary, evaluator in product(visionaries, evaluators))


def depth_sheet(results: Results, *, title: str, notes: Sequence[str] = ()) -> Sheet:
    """Return CASR by depth, the paper's Table III beside it."""
    paper = _paper("III")
    lines = []
    for name in results.methods:
        table, rows = results.table(name), results.rows[name]
        if table is None:
            continue
        depth = f"L = {name.removeprefix(DEPTH_METHOD)}"
        theirs = paper.written(depth) if depth in dict(paper.rows) else ()
        lines.append(
            (
                depth,
                f"{table.count}",
                figure(table["CASR"]),
                figure(table["CASR per mission"]),
                share(_spread([row.score.casr for row in rows])),
                figure(table["SR"]),
                figure(table["CT"], whole),
                f"{theirs[0]} ({theirs[1]})" if theirs else NONE,
            )
        )
    head = ("depth", "missions", "CASR", "CASR per mission", "σ", "SR", "CT s", "the paper's CASR (σ)")
    return Sheet(title, head, tuple(lines), (_NOTE, *notes))


def minds_sheet(results: Results, *, title: str, notes: Sequence[str] = ()) -> Sheet:
    """Return CASR by visionary and evaluator and each evaluator's mean score; below them the paper's Table IV."""
    lines = []
    for name in results.methods:
        table, rows = results.table(name), results.rows[name]
        if table is None:
            continue
        visionary, _, evaluator = name.removeprefix(MINDS_METHOD).partition("/")
        figures = (figure(table["CASR"]), figure(table["CASR per mission"]), figure(table["SR"]))
        lines.append((visionary, evaluator, f"{table.count}", *figures, share(_mean_score(rows))))
    paper = _paper("IV")
    for minds, (casr,) in paper.rows:
        visionary, _, evaluator = minds.partition(" + ")
        shown = f"{NONE} (left out)" if casr is None else paper.written(minds)[0]
        lines.append((f"the paper's {visionary}", f"the paper's {evaluator}", NONE, shown, NONE, NONE, NONE))
    head = ("visionary", "evaluator", "missions", "CASR", "CASR per mission", "SR", "mean score")
    said = "Mean score: of all answers of the evaluator, 1 to 5. In the paper GPT-3.5 was 1.86 points above GPT-4."
    return Sheet(title, head, tuple(lines), (said, *notes))


def _paper(number: str) -> PaperTable:
    return next(table for table in PAPER_TABLES if table.number == number)


def _mean_score(rows: Sequence[MissionRow]) -> float:
    count = sum(row.evaluator_count for row in rows)
    return math.fsum(row.evaluator_sum for row in rows) / count if count else math.nan


def _spread(values: Sequence[float]) -> float:
    return statistics.stdev(values) if len(values) > 1 else 0.0
