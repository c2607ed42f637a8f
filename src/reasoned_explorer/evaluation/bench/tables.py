"""The tables of a run as text."""

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from statistics import fmean

from reasoned_explorer.evaluation.bench.results import (
    BASELINE,
    BOUND,
    DIFFERENCES,
    HEADROOM,
    Results,
    corrected,
    label_of,
    p_of,
)
from reasoned_explorer.evaluation.metrics import MetricTable
from reasoned_explorer.evaluation.paper import PAPER_NOTE, PAPER_TABLES, PaperTable
from reasoned_explorer.evaluation.wording import NONE, figure, level_name, share, whole
from reasoned_explorer.model import Fault, InputError

#: The figures of the main table, by their names in `MetricTable`.
SHOWN = ("SR", "OSR", "SPL", "CASR", "CASR per mission")
_MORE: tuple[tuple[str, Callable[[float], str]], ...] = (
    ("OSR-seen", share),
    ("soft-SPL", share),
    ("nDTW", share),
    ("CASR paper-style", share),
    ("path length", whole),
    ("distance to goal", whole),
)
_AT_RADIUS = "SR at "
#: What `MetricTable` calls an interval that was made by drawing places.
_BY_PLACE = "clustered bootstrap"


@dataclass(frozen=True, slots=True)
class Sheet:
    """A table of text.

    Attributes:
        title: What it shows.
        head: Names of the columns.
        lines: Cells, as many in each line as the head has.
        notes: What has to be said under it.
    """

    title: str
    head: tuple[str, ...]
    lines: tuple[tuple[str, ...], ...]
    notes: tuple[str, ...] = ()

    def markdown(self) -> str:
        """Return it in Markdown."""
        rows = [self.head, ("---",) * len(self.head), *self.lines]
        table = "\n".join("| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in rows)
        return "\n\n".join([f"**{self.title}**", table, *self.notes])


def main_sheet(results: Results, *, title: str, notes: Sequence[str] = ()) -> Sheet:
    """Return planners × (SR, OSR, SPL, CASR both ways, times, calls, tokens, money) × (L1, L2, L3, L4, all)."""
    lines = []
    for level in (*results.levels, None):
        for name in results.methods:
            table, rows = results.table(name, level), results.of_level(name, level)
            if table is None:
                continue
            cells = [figure(table[shown]) for shown in SHOWN]
            times = [figure(table[shown], whole) for shown in ("CT", "TT")]
            costs = [whole(fmean(getattr(row, what) for row in rows)) for what in ("calls", "tokens_in", "tokens_out")]
            least = "≥ " if any(row.unpriced for row in rows) else ""
            usd = f"{least}{math.fsum(row.usd for row in rows):.2f}"
            lines.append(
                (level_name(level), label_of(results.rows[name]), f"{table.count}", *cells, *times, *costs, usd)
            )
    head = ("level", "planner", "missions", *SHOWN, "CT s", "TT s", "calls", "tokens in", "tokens out", "USD in all")
    return Sheet(title, head, tuple(lines), tuple(notes))


def more_sheet(results: Results, *, notes: Sequence[str] = ()) -> Sheet:
    """Return the other metrics over all missions, and success at other radii."""
    tables = {name: table for name in results.methods if (table := results.table(name)) is not None}
    radii = sorted(
        {metric.name for table in tables.values() for metric in table.metrics if metric.name.startswith(_AT_RADIUS)},
        key=lambda name: float(name.removeprefix(_AT_RADIUS).removesuffix(" m")),
    )
    lines = []
    for name, table in tables.items():
        have = {metric.name: metric for metric in table.metrics}
        cells = [figure(have.get(shown), write) for shown, write in _MORE]
        lines.append((name, *cells, *(figure(have.get(radius), interval=False) for radius in radii)))
    head = ("planner", *(f"{shown}, m" if write is whole else shown for shown, write in _MORE), *radii)
    return Sheet("Other metrics, all levels", head, tuple(lines), tuple(notes))


def headroom_sheet(results: Results, *, notes: Sequence[str] = ()) -> Sheet | None:
    """Return which share of the headroom each planner closes; None where baseline or bound were not run."""
    if not {BASELINE, BOUND} <= set(results.methods):
        return None
    lines = tuple(
        (name, *(figure(results.headroom(name, shown)) for shown in HEADROOM))
        for name in results.methods
        if name not in {BASELINE, BOUND}
    )
    said = (
        f"(m − b) / (B − b): 0 is {BASELINE}, 1 is {BOUND}; {NONE} where that is no better. An end of ∞: the bound is "
        "not above the baseline in too many resamples."
    )
    title = f"Share of headroom closed, from {BASELINE} to {BOUND}"
    return Sheet(title, ("planner", *HEADROOM), lines, (said, *notes)) if lines else None


def difference_sheet(results: Results, other: str, *, notes: Sequence[str] = ()) -> Sheet:
    """Return paired differences of every method to one of them, with p-values corrected for their number."""
    found = {
        f"{name} − {other}": table
        for name in results.methods
        if name != other and (table := results.difference(name, other)) is not None
    }
    return _differences(f"Paired differences to {other}", found, notes)


def compared_sheet(
    ours: Results,
    theirs: Results,
    *,
    names: tuple[str, str],
    methods: tuple[str | None, str | None],
    title: str = "",
    notes: Sequence[str] = (),
) -> Sheet:
    """Return paired differences between two runs on the missions that both have.

    Args:
        ours: Of the first run.
        theirs: Of the second run.
        names: What the runs are called.
        methods: A method of each, or None for all methods that both have.
        title: Of what, e.g. a vehicle; may be empty.
        notes: What has to be said under it.

    Raises:
        InputError: If a method has no missions in its run, or the two have no mission in common.
    """
    first, second = methods
    named = first or second
    pairs = [(first or second or "", second or first or "")] if named else _same(ours, theirs)
    faults = [
        Fault(f"{name} has no missions of {method!r}", f"one of {', '.join(results.methods) or 'none'}")
        for one, other in pairs
        for name, results, method in ((names[0], ours, one), (names[1], theirs, other))
        if method not in results.methods
    ]
    if faults or not pairs:
        raise InputError("comparison", faults or [Fault("the runs have no planner in common", "RUN::PLANNER for each")])
    found = {
        one if one == other else f"{one} − {other}": table
        for one, other in pairs
        if (table := ours.difference(one, other, theirs=theirs)) is not None
    }
    if not found:
        raise InputError(
            "comparison", [Fault("the runs have no mission in common", "runs of the same split and seeds")]
        )
    of = f", {title}" if title else ""
    return _differences(f"{names[0]} − {names[1]}{of}, on the same missions", found, notes)


def _same(ours: Results, theirs: Results) -> list[tuple[str, str]]:
    return [(name, name) for name in ours.methods if name in theirs.methods]


def _differences(title: str, tables: dict[str, MetricTable], notes: Sequence[str]) -> Sheet:
    holm = corrected(tables, "SR")
    lines = []
    for name, table in tables.items():
        cells = [figure(table[shown]) for shown in DIFFERENCES]
        lines.append((name, f"{table.count}", *cells, share(p_of(table, "SR"), 3), share(holm[name], 3)))
    head = ("planners", "missions", *DIFFERENCES, "p (SR)", "p, corrected")
    return Sheet(title, head, tuple(lines), (differences_note(tables.values()), *notes))


def differences_note(tables: Iterable[MetricTable]) -> str:
    """Return what must be known to read paired differences: how their intervals and p-values were made."""
    # Where nothing differs between places, SR still says how it was resampled.
    by_place = {table["SR"].interval == _BY_PLACE for table in tables}
    drawn = " or ".join(
        [*(["place"] if True in by_place else []), *(["mission (of one place)"] if False in by_place else [])]
    )
    note = (
        f"Intervals are 95 %, paired by mission, resampled by {drawn}. p: sign-flip test on SR by {drawn}, then Holm's "
        "correction for the number of lines"
    )
    return f"{note}; with K places that differ p is at least 2^(1 − K)." if True in by_place else f"{note}."


def city_sheet(results: Results, *, notes: Sequence[str] = ()) -> Sheet:
    """Return SR / OSR / SPL by city."""
    lines = []
    for name in results.methods:
        cells = []
        for city in results.cities:
            table = results.table(name, city=city)
            shown = [figure(table[each], interval=False) for each in ("SR", "OSR", "SPL")] if table else [NONE]
            cells.append(" / ".join(shown))
        lines.append((name, *cells))
    return Sheet("SR / OSR / SPL by city", ("planner", *results.cities), tuple(lines), tuple(notes))


def vehicles_sheet(by_vehicle: dict[str, Results], *, notes: Sequence[str] = ()) -> Sheet:
    """Return the form of the paper's Table II: each planner's SR, OSR and CASR with each vehicle."""
    shown = ("SR", "OSR", "CASR")
    methods = dict.fromkeys(name for results in by_vehicle.values() for name in results.methods)
    lines = []
    for name in methods:
        tables = [results.table(name) if name in results.methods else None for results in by_vehicle.values()]
        lines.append((name, *(figure(table[each] if table else None) for table in tables for each in shown)))
    head = ("planner", *(f"{each} {vehicle}" for vehicle in by_vehicle for each in shown))
    return Sheet("By vehicle, all levels", head, tuple(lines), tuple(notes))


def paper_sheets(numbers: Sequence[str] = ("I",)) -> list[Sheet]:
    """Return tables of the paper, as tables of their own; the main one by level."""
    return [_paper_sheet(table) for table in PAPER_TABLES if table.number in numbers]


def _paper_sheet(table: PaperTable) -> Sheet:
    title = f"The paper's Table {table.number}: {table.title}"
    if table.number != "I":
        return Sheet(title, table.columns, tuple((name, *table.written(name)) for name, _ in table.rows), (PAPER_NOTE,))
    lines = [
        (level, name, *table.written(name)[start::5])
        for start, level in enumerate(("L1", "L2", "L3", "L4", "all"))
        for name, _ in table.rows
    ]
    return Sheet(title, ("level", "method", "SR", "OSR", "SPL", "CASR"), tuple(lines), (PAPER_NOTE,))
