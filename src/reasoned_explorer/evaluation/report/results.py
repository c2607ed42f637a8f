"""The tables of the report: what each method scored, and by how much it differs from the first."""

from collections.abc import Callable, Sequence
from dataclasses import replace

from reasoned_explorer.evaluation.paper import PAPER_TABLES
from reasoned_explorer.evaluation.report.scores import Metric, aggregate, mean_of
from reasoned_explorer.evaluation.report.study import Entry, Study
from reasoned_explorer.evaluation.report.tables import (
    METRIC_HEAD,
    Cell,
    Group,
    Line,
    Table,
    metric_cell,
    metric_record,
)
from reasoned_explorer.evaluation.report.wording import NONE, amount, level_name, link, money, share, signed

#: With more cities than this their table is left out of the page.
MOST_CITIES = 8

_SHARES = ("SR", "OSR", "SPL", "CASR", "CASR per mission", "CASR paper-style")
_SECONDS = ("CT", "TT")
_OUTCOME = {"SR": "success", "OSR": "oracle"}
_DIFFERENCES = ("SR", "OSR", "SPL", "CASR", "CASR per mission")

_COSTS: tuple[tuple[str, str, Callable[[Entry], float]], ...] = (
    ("calls", "calls", lambda entry: float(entry.row.calls)),
    ("tokens", "tokens", lambda entry: float(entry.row.tokens_in + entry.row.tokens_out)),
    ("USD", "USD", lambda entry: entry.row.usd),
)


def costs_of(entries: list[Entry], *, seed: int) -> dict[str, Metric]:
    """Return mean calls, tokens and dollars a mission."""
    return {name: mean_of(name, [value(entry) for entry in entries], seed=seed) for name, _, value in _COSTS}


def overall_table(study: Study) -> Table:
    """Return the main table: every metric of every method over all levels."""
    lines = tuple(_full_line(study, method, None) for method in study.methods)
    return Table(
        key="main",
        caption="What each method scored, all levels together: means a mission with 95 % intervals",
        columns=_FULL_COLUMNS,
        groups=(Group("", lines),),
        note=_FULL_NOTE,
        head=("method", "level", *METRIC_HEAD),
        records=_full_records(study, [None]),
    )


def levels_table(study: Study) -> Table:
    """Return the paper's Table I of this run: four metrics by level."""
    levels: list[int | None] = [*study.levels, None]
    shown = ("SR", "OSR", "SPL", "CASR")
    lines = []
    for method in study.methods:
        cells = [_narrow(_metric(study, method, level, name, share)) for name in shown for level in levels]
        lines.append(Line(method, tuple(cells), method))
    return Table(
        key="levels",
        caption="The four metrics of the paper by level, in the form of its Table I, with 95 % intervals",
        columns=("method", *(level_name(level) for _ in shown for level in levels)),
        groups=(Group("", tuple(lines)),),
        spans=tuple((name, len(levels)) for name in shown),
        note="“all” weighs missions, not levels, alike.",
        head=("method", "level", *METRIC_HEAD),
        records=tuple(
            record
            for method in study.methods
            for level in levels
            for name in shown
            for record in metric_record([method, level_name(level)], study.metric(method, level, name))
        ),
    )


def every_level_table(study: Study) -> Table:
    """Return every metric of every method at every level."""
    groups = tuple(
        Group(f"Level {level}", tuple(_full_line(study, method, level) for method in study.methods))
        for level in study.levels
    )
    return Table(
        key="every-level",
        caption="Every metric at each level",
        columns=_FULL_COLUMNS,
        groups=groups,
        note=_FULL_NOTE,
        head=("method", "level", *METRIC_HEAD),
        records=_full_records(study, list(study.levels)),
    )


def differences_table(study: Study) -> Table | None:
    """Return paired differences to the first method; None with a single method."""
    if not study.differences:
        return None
    lines, records = [], []
    for difference in study.differences:
        cells = [
            Cell(f"{difference.table.count}", "", link(method=difference.method, versus=difference.base, by="any"))
        ]
        for name in _DIFFERENCES:
            href = link(method=difference.method, versus=difference.base, by=_OUTCOME.get(name, "any"))
            about = f"missions behind the difference of {name}"
            cells.append(metric_cell(difference.table[name], signed, href=href, about=about))
            records += metric_record([difference.method, difference.base], difference.table[name])
        lines.append(Line(f"{difference.method} − {difference.base}", tuple(cells), difference.method))
    return Table(
        key="differences",
        caption="Paired differences to the first method, on the same missions",
        columns=("methods", "pairs", *_DIFFERENCES),
        groups=(Group("", tuple(lines)),),
        note="Missions are drawn in pairs, so that what they have in common does not blur the difference. The numbers "
        "of SR and OSR lead to the missions in which the two differ. Not corrected for the number of comparisons.",
        head=("method", "minus", *METRIC_HEAD),
        records=tuple(records),
    )


def cities_table(study: Study) -> Table | None:
    """Return SR, OSR and CASR per mission by city; None where there is one city only, or too many to read."""
    if not 2 <= len(study.cities) <= MOST_CITIES:
        return None
    shown = ("SR", "OSR", "CASR per mission")
    lines: list[Line] = []
    records = []
    for method in study.methods:
        cells = []
        tables = {}
        for city in study.cities:
            entries = study.of(method, city=city)
            tables[city] = aggregate([entry.score for entry in entries], seed=study.about.seed) if entries else None
        for name in shown:
            for city in study.cities:
                table = tables[city]
                metric = table[name] if table else None
                target = link(method=method, city=city, outcome=_OUTCOME.get(name))
                cells.append(metric_cell(metric, share, href=target, about=f"{name} of {method} in {city}"))
                records += metric_record([method, city], metric)
        lines.append(Line(method, tuple(cells), method))
    return Table(
        key="cities",
        caption="By city",
        columns=("method", *(city or "no city" for _ in shown for city in study.cities)),
        groups=(Group("", tuple(lines)),),
        spans=tuple((name, len(study.cities)) for name in shown),
        head=("method", "city", *METRIC_HEAD),
        records=tuple(records),
    )


def causes_table(study: Study) -> Table:
    """Return how many missions of each method ended for each cause."""
    lines, records = [], []
    for method in study.methods:
        total = len(study.of(method))
        cells = [Cell(f"{total}", "", link(method=method))]
        for cause in study.causes:
            count = len(study.of(method, cause=cause))
            href = link(method=method, outcome=cause.key)
            cells.append(Cell(f"{count}", f"{100.0 * count / total:.0f} %", href, f"{method}: {cause.value}"))
            records.append((method, cause.value, count, total))
        lines.append(Line(method, tuple(cells), method))
    meanings = "; ".join(f"{cause.value}: {cause.meaning}" for cause in study.causes)
    return Table(
        key="causes",
        caption="What became of the missions: counts, and shares of the method’s missions",
        columns=("method", "missions", *(cause.value for cause in study.causes)),
        groups=(Group("", tuple(lines)),),
        note=f"Each mission has one cause. {meanings}.",
        head=("method", "cause", "missions", "of"),
        records=tuple(records),
    )


def collisions_of(study: Study, method: str) -> tuple[Metric, Metric]:
    """Return mean collisions a mission with small and with large things."""
    entries = study.of(method)
    return (
        mean_of("small", [float(entry.row.small_collisions) for entry in entries], seed=study.about.seed),
        mean_of("large", [float(entry.row.large_collisions) for entry in entries], seed=study.about.seed),
    )


def collisions_table(study: Study) -> Table:
    """Return collisions by the size of what was run into."""
    lines, records = [], []
    for method in study.methods:
        entries = study.of(method)
        small, large = collisions_of(study, method)
        travelled_km = sum(entry.score.path_length_m for entry in entries) / 1000.0
        rates = [
            Cell(amount(metric.value * metric.count / travelled_km) if travelled_km else NONE)
            for metric in (small, large)
        ]
        targets = [link(method=method, outcome=size) for size in ("small", "large")]
        cells = (
            metric_cell(small, amount, href=targets[0], about=f"{method}: missions with small collisions"),
            metric_cell(large, amount, href=targets[1], about=f"{method}: missions with large collisions"),
            Cell(rates[0].text, "", targets[0]),
            Cell(rates[1].text, "", targets[1]),
        )
        lines.append(Line(method, cells, method))
        records += [record for metric in (small, large) for record in metric_record([method], metric)]
    return Table(
        key="collisions",
        caption="Collisions by the size of the obstacle",
        columns=("method", "small", "large", "small", "large"),
        groups=(Group("", tuple(lines)),),
        spans=(("a mission", 2), ("a kilometre travelled", 2)),
        note="Small: less than 3 m long (benches, trunks, people). Large: walls, vehicles and the like. The paper says "
        "that its method goes round large obstacles well and is limited with small ones.",
        head=("method", *METRIC_HEAD),
        records=tuple(records),
    )


def paper_tables() -> tuple[Table, ...]:
    """Return the paper's own tables."""
    return tuple(
        Table(
            key=f"paper-{table.number.lower()}",
            caption=f"The paper’s Table {table.number}: {table.title}",
            columns=table.columns if table.number != "I" else ("method", *("L1", "L2", "L3", "L4", "avg") * 4),
            groups=(
                Group(
                    "",
                    tuple(Line(name, _paper_cells(values, table.digits)) for name, values in table.rows),
                ),
            ),
            spans=tuple((metric, 5) for metric in ("SR", "OSR", "SPL", "CASR")) if table.number == "I" else (),
            head=table.columns,
            records=tuple((name, *values) for name, values in table.rows),
        )
        for table in PAPER_TABLES
    )


def _paper_cells(values: Sequence[float | None], digits: Sequence[int]) -> tuple[Cell, ...]:
    """With as many digits as the paper gives."""
    written = zip(values, digits, strict=True)
    return tuple(Cell(NONE if value is None else f"{value:.{count}f}".removeprefix("0")) for value, count in written)


_FULL_COLUMNS = ("method", "missions", *_SHARES, "CT s", "TT s", *(head for _, head, _ in _COSTS))
_FULL_NOTE = (
    "SR: declared in place and in time. OSR: at some moment declaring would have been right. CASR: the paper’s "
    "SR · mean(1 − (CT + TT)/T_max); “per mission” is mean(S · (1 − (CT + TT)/T_max)), which a fast false halt cannot "
    "raise; “paper-style” counts the planner’s CT only. Each number leads to its missions."
)


def _target(method: str, level: int | None, name: str) -> tuple[str, str]:
    """Return the address of the missions behind a figure, and what it leads to."""
    where = "all levels" if level is None else f"level {level}"
    return link(method=method, level=level, outcome=_OUTCOME.get(name)), f"missions behind {name} of {method}, {where}"


def _metric(study: Study, method: str, level: int | None, name: str, write: Callable[[float], str]) -> Cell:
    href, about = _target(method, level, name)
    return metric_cell(study.metric(method, level, name), write, href=href, about=about)


def _narrow(cell: Cell) -> Cell:
    """Return the cell with its interval, of shares, as briefly as it can be written: twenty stand side by side."""
    return replace(cell, interval=cell.interval.strip("[]").replace(", ", "–"))


def _full_line(study: Study, method: str, level: int | None) -> Line:
    entries = study.of(method, level=level)
    if not entries:
        return Line(method, tuple(Cell(NONE) for _ in _FULL_COLUMNS[1:]), method)
    href, about = _target(method, level, "missions")
    cells = [Cell(f"{len(entries)}", "", href, about)]
    cells += [_metric(study, method, level, name, share) for name in _SHARES]
    cells += [_metric(study, method, level, name, amount) for name in _SECONDS]
    for name, metric in costs_of(entries, seed=study.about.seed).items():
        cells.append(metric_cell(metric, money if name == "USD" else amount, href=href, about=about))
    return Line(method, tuple(cells), method)


def _full_records(study: Study, levels: Sequence[int | None]) -> tuple[tuple[str | int | float | None, ...], ...]:
    records = []
    for method in study.methods:
        for level in levels:
            entries = study.of(method, level=level)
            if not entries:
                continue
            first = [method, level_name(level)]
            table = study.tables[method][level]
            for metric in (*table.metrics, *costs_of(entries, seed=study.about.seed).values()):
                records += metric_record(first, metric)
    return tuple(records)
