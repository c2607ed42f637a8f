"""Tables of a run: plain data, then text, Markdown or CSV."""

import csv
import io
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from reasoned_explorer.evaluation.methods import BOUND_METHODS, PERFECT_HALT
from reasoned_explorer.evaluation.metrics import Metric, MetricTable, aggregate, compare
from reasoned_explorer.evaluation.paper import PAPER_NOTE, PAPER_TABLES
from reasoned_explorer.evaluation.row import MissionRow
from reasoned_explorer.evaluation.statistics import holm
from reasoned_explorer.model import Fault, InputError

#: The figures of the main table, by their names in `MetricTable`.
SHOWN = ("SR", "OSR", "SPL", "CASR", "CASR per mission")
DIFFERENCES = ("SR", "OSR", "SPL", "CASR", "CASR per mission")
LEVELS: tuple[int | None, ...] = (1, 2, 3, 4, None)


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

    def csv(self) -> str:
        """Return it as comma-separated values."""
        out = io.StringIO()
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(self.head)
        writer.writerows(self.lines)
        return out.getvalue()


def figure(metric: Metric, *, interval: bool = True, digits: int = 2) -> str:
    """Return a figure as tables show it: ``.25 [.15, .39]``; a dash where there is none."""
    if math.isnan(metric.value):
        return "–"
    value = short(metric.value, digits)
    return f"{value} [{short(metric.low, digits)}, {short(metric.high, digits)}]" if interval else value


def short(value: float, digits: int = 2) -> str:
    """Return a number without its leading zero: ``.25``, ``-.03``, ``1.00``."""
    text = f"{value:.{digits}f}"
    if float(text) == 0.0:
        text = text.removeprefix("-")
    return text.replace("0.", ".", 1) if abs(float(text)) < 1.0 and "." in text else text


@dataclass(frozen=True)
class Results:
    """The rows of one vehicle in a run, by method.

    Attributes:
        rows: Each method's rows, in the order of the table.
        seed: Of the intervals' resampling.
    """

    rows: Mapping[str, Sequence[MissionRow]]
    seed: int = 0

    @classmethod
    def of(cls, rows: Iterable[MissionRow], methods: Sequence[str]) -> "Results":
        """Return the results of rows; methods without a row are left out."""
        by_method: dict[str, list[MissionRow]] = {name: [] for name in methods}
        for row in rows:
            by_method.setdefault(row.method, []).append(row)
        return cls({name: tuple(mine) for name, mine in by_method.items() if mine})

    @property
    def methods(self) -> tuple[str, ...]:
        """Names of the methods, in order."""
        return tuple(self.rows)

    def table(self, method: str, level: int | None = None, city: str | None = None) -> MetricTable | None:
        """Return a method's figures at a level (None for all) in a city (None for all); None without missions."""
        mine = [row for row in self.rows[method] if level in {None, row.level} and city in {None, row.city}]
        if not mine:
            return None
        return aggregate([row.score for row in mine], places=_places(mine), seed=self.seed)

    def difference(
        self, method: str, other: str, *, level: int | None = None, theirs: "Results | None" = None
    ) -> MetricTable | None:
        """Return by how much a method is better than another on the missions that both have; None where none is.

        Args:
            method: Of these results.
            other: Of the other results.
            level: OUTDOOR's level, or None for all.
            theirs: The other results; these by default.
        """
        ours = {row.mission_id: row for row in self.rows[method] if level in {None, row.level}}
        others = {row.mission_id: row for row in (theirs or self).rows[other] if level in {None, row.level}}
        common = sorted(set(ours) & set(others))
        if not common:
            return None
        mine = [ours[name] for name in common]
        return compare(
            [row.score for row in mine],
            [others[name].score for name in common],
            places=_places(mine),
            seed=self.seed,
        )

    def cities(self) -> tuple[str, ...]:
        """Return the cities that there are rows of, sorted."""
        return tuple(sorted({row.city for mine in self.rows.values() for row in mine}))


def _places(rows: Sequence[MissionRow]) -> dict[str, str]:
    return {row.mission_id: row.place for row in rows}


def main_sheet(results: Results, *, title: str, notes: Sequence[str] = ()) -> Sheet:
    """Return planners × (SR, OSR, SPL, CASR both ways, times, calls, tokens, money) × (L1, L2, L3, L4, all)."""
    lines = []
    for level in LEVELS:
        for name in results.methods:
            table = results.table(name, level)
            if table is None:
                continue
            rows = [row for row in results.rows[name] if level in {None, row.level}]
            cells = [figure(table[shown]) for shown in SHOWN]
            times = [figure(table[shown], digits=0) for shown in ("CT", "TT")]
            costs = [
                f"{_mean(getattr(row, what) for row in rows):.0f}" for what in ("calls", "tokens_in", "tokens_out")
            ]
            usd = math.fsum(row.usd for row in rows)
            which = "all" if level is None else f"L{level}"
            lines.append((which, label_of(rows[0]), f"{table.count}", *cells, *times, *costs, f"{usd:.2f}"))
    head = ("level", "planner", "missions", *SHOWN, "CT s", "TT s", "calls", "tokens in", "tokens out", "USD")
    return Sheet(title, head, tuple(lines), tuple(notes))


def label_of(row: MissionRow) -> str:
    """Return what a table's row is called: method, whose minds, and how its thinking time came about."""
    if row.method in BOUND_METHODS:
        return f"{row.method} [a bound: knows the world], CT {row.ct_label}"
    _, bracket, minds = row.planner.partition("[")
    halt = "; the judge halts, a bound" if row.method.endswith(f"+{PERFECT_HALT}") else ""
    who = f" [{minds.rstrip(']')}{halt}]" if bracket else ""
    return f"{row.method}{who}, CT {row.ct_label}"


def more_sheet(results: Results) -> Sheet:
    """Return the other metrics over all missions, and success at other radii."""
    radii = ("SR at 5 m", "SR at 10 m", "SR at 15 m", "SR at 20 m")
    lines = []
    for name in results.methods:
        table = results.table(name)
        if table is not None:
            have = {metric.name: metric for metric in table.metrics}
            cells = [figure(have[shown], digits=2 if shown not in _METRES else 0) if shown in have else "–"
                     for shown in _MORE_SHOWN]  # fmt: skip
            lines.append((name, *cells, *(figure(have[r], interval=False) if r in have else "–" for r in radii)))
    return Sheet("Other metrics, all levels", ("planner", *_MORE_SHOWN, *radii), tuple(lines))


_METRES = ("path length", "distance to goal")
_MORE_SHOWN = ("OSR-seen", "soft-SPL", "nDTW", "CASR paper-style", "path length", "distance to goal")


def difference_sheet(results: Results, other: str) -> Sheet:
    """Return paired differences of every method to one of them, with p-values corrected for their number."""
    tables = [(f"{name} − {other}", results.difference(name, other)) for name in results.methods if name != other]
    return _differences(
        f"Paired differences to {other}", [(name, table) for name, table in tables if table is not None]
    )


def compared_sheet(
    ours: Results, theirs: Results, *, names: tuple[str, str], methods: tuple[str | None, str | None]
) -> Sheet:
    """Return paired differences between two runs on the missions that both have.

    Args:
        ours: Of the first run.
        theirs: Of the second run.
        names: What the runs are called.
        methods: A method of each, or None for all methods that both have.

    Raises:
        InputError: If a method has no missions in its run, or the two have no mission in common.
    """
    first, second = methods
    pairs = [(first or second, second or first)] if first or second else _common(ours, theirs)
    faults = [
        Fault(f"{name} has no missions of {method!r}", f"one of {', '.join(results.methods)}")
        for one, other in pairs
        for name, results, method in ((names[0], ours, one), (names[1], theirs, other))
        if method not in results.methods
    ]
    if faults or not pairs:
        raise InputError("comparison", faults or [Fault("the runs have no planner in common", "RUN::PLANNER for each")])
    found = []
    for one, other in pairs:
        mine, its = str(one), str(other)
        table = ours.difference(mine, its, theirs=theirs)
        if table is not None:
            found.append((mine if mine == its else f"{mine} − {its}", table))
    if not found:
        raise InputError(
            "comparison", [Fault("the runs have no mission in common", "runs of the same split and seeds")]
        )
    return _differences(f"{names[0]} − {names[1]}, on the same missions", found)


def _common(ours: Results, theirs: Results) -> list[tuple[str | None, str | None]]:
    return [(name, name) for name in ours.methods if name in theirs.methods]


def _differences(title: str, tables: Sequence[tuple[str, MetricTable]]) -> Sheet:
    corrected = holm({name: _p(table["SR"]) for name, table in tables})
    lines = [
        (
            name,
            f"{table.count}",
            *(figure(table[shown]) for shown in DIFFERENCES),
            f"{_p(table['SR']):.3f}",
            f"{corrected[name]:.3f}",
        )
        for name, table in tables
    ]
    note = (
        "Intervals are 95 %, paired by mission, resampled by place where there are several. p: sign-flip test on SR by "
        "place, then Holm's correction for the number of lines."
    )
    head = ("planners", "missions", *DIFFERENCES, "p (SR)", "p, corrected")
    return Sheet(title, head, tuple(lines), (note,))


def _p(metric: Metric) -> float:
    return 1.0 if metric.p is None else metric.p


def city_sheet(results: Results) -> Sheet:
    """Return SR / OSR / SPL by city."""
    cities = results.cities()
    lines = []
    for name in results.methods:
        cells = []
        for city in cities:
            table = results.table(name, city=city)
            figures = (
                "–" if table is None else " / ".join(figure(table[s], interval=False) for s in ("SR", "OSR", "SPL"))
            )
            cells.append(figures)
        lines.append((name, *cells))
    return Sheet("SR / OSR / SPL by city", ("planner", *cities), tuple(lines))


def paper_sheets() -> list[Sheet]:
    """Return the paper's main table, by level, as a table of its own."""
    table = PAPER_TABLES[0]
    lines = []
    for name, values in table.rows:
        for start, level in enumerate(("L1", "L2", "L3", "L4", "all")):
            cells = ["–" if value is None else short(value) for value in values[start::5]]
            lines.append((level, name, *cells))
    lines.sort(key=lambda line: line[0])
    title = f"The paper's table {table.number}: {table.title}"
    return [Sheet(title, ("level", "method", "SR", "OSR", "SPL", "CASR"), tuple(lines), (PAPER_NOTE,))]


def _mean(values: Iterable[float]) -> float:
    listed = list(values)
    return math.fsum(listed) / len(listed)
