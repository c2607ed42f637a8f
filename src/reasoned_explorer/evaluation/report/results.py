"""The tables of the report: what each method scored, and by how much it differs from the first."""

from collections.abc import Callable, Sequence
from dataclasses import replace

from reasoned_explorer.evaluation.bench.results import (
    BASELINE,
    BOUND,
    DIFFERENCES,
    HEADROOM,
    corrected,
    p_of,
    what_of,
)
from reasoned_explorer.evaluation.bench.tables import differences_note
from reasoned_explorer.evaluation.metrics import Metric, mean_of
from reasoned_explorer.evaluation.paper import PAPER_TABLES
from reasoned_explorer.evaluation.report.links import link
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
from reasoned_explorer.evaluation.wording import NONE, amount, level_name, money, share, signed

#: With more cities than this their table is left out of the page.
MOST_CITIES = 8

_SHARES = ("SR", "OSR", "OSR-seen", "SPL", "soft-SPL", "CASR", "CASR per mission", "CASR paper-style")
_AMOUNTS = {"nDTW": "nDTW", "distance to goal": "to goal m", "path length": "path m", "CT": "CT s", "TT": "TT s"}
_OUTCOME = {"SR": "success", "OSR": "oracle", "OSR-seen": "seen"}

_COSTS: tuple[tuple[str, Callable[[Entry], float]], ...] = (
    ("calls", lambda entry: float(entry.row.calls)),
    ("tokens", lambda entry: float(entry.row.tokens_in + entry.row.tokens_out)),
    ("USD", lambda entry: entry.row.usd),
)


def costs_of(study: Study, entries: Sequence[Entry]) -> dict[str, Metric]:
    """Return mean calls, tokens and dollars a mission."""
    return {name: _mean(study, entries, name, value) for name, value in _COSTS}


def _mean(study: Study, entries: Sequence[Entry], name: str, value: Callable[[Entry], float]) -> Metric:
    values = {entry.row.mission_id: value(entry) for entry in entries}
    return mean_of(name, values, places=study.place_of, seed=study.about.seed)


def overall_table(study: Study) -> Table:
    """Return the main table: what every method scored over all levels; its file has every metric."""
    lines = []
    for method in study.methods:
        label = "".join(what_of([entry.row for entry in study.of(method)]))
        cells = (_count(study, method, None), *(_metric(study, method, None, name, share) for name in _SHARES))
        lines.append(Line(method, cells, method, label))
    return Table(
        key="main",
        caption="What each method scored, all levels together, with 95 % intervals",
        columns=("method", "missions", *_SHARES),
        groups=(Group("", tuple(lines)),),
        note=_SHARES_NOTE,
        head=("method", "level", *METRIC_HEAD),
        records=_full_records(study, [None]),
    )


def spent_table(study: Study) -> Table:
    """Return how far every method went and what it spent over all levels."""
    lines = []
    for method in study.methods:
        cells = (*_amounts(study, method, None), *_costs(study, method, None))
        lines.append(Line(method, cells, method))
    shown = {*_AMOUNTS, *(name for name, _ in _COSTS)}
    return Table(
        key="spent",
        caption="How far each method went and what it spent, all levels together: means a mission with 95 % intervals",
        columns=("method", *_SPENT),
        groups=(Group("", tuple(lines)),),
        note=_AMOUNTS_NOTE,
        head=("method", "level", *METRIC_HEAD),
        records=tuple(record for record in _full_records(study, [None]) if record[2] in shown),
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
        note=f"{_SHARES_NOTE} {_AMOUNTS_NOTE}",
        head=("method", "level", *METRIC_HEAD),
        records=_full_records(study, list(study.levels)),
    )


def differences_table(study: Study) -> Table | None:
    """Return paired differences to the first method; None with a single method."""
    if not study.differences:
        return None
    tables = {item.method: item.table for item in study.differences}
    holm = {name: corrected(tables, name) for name in DIFFERENCES}
    lines, records = [], []
    for item in study.differences:
        cells = [Cell(f"{item.table.count}", "", link(method=item.method, versus=item.base, by="any"))]
        for name in DIFFERENCES:
            href = link(method=item.method, versus=item.base, by=_OUTCOME.get(name, "any"))
            about = f"missions behind the difference of {name}"
            cells.append(metric_cell(item.table[name], signed, href=href, about=about))
            tests = (p_of(item.table, name), holm[name][item.method])
            records += [(*record, *tests) for record in metric_record([item.method, item.base], item.table[name])]
        cells += [Cell(share(p_of(item.table, "SR"), 3)), Cell(share(holm["SR"][item.method], 3))]
        lines.append(Line(f"{item.method} − {item.base}", tuple(cells), item.method))
    return Table(
        key="differences",
        caption="Paired differences to the first method, on the same missions",
        columns=("methods", "pairs", *DIFFERENCES, "p (SR)", "p, corrected"),
        groups=(Group("", tuple(lines)),),
        note=f"{differences_note(tables.values())} The numbers of SR and OSR lead to the missions in which the two "
        "differ. The file has p of the other figures, too, each corrected among the lines of its own figure.",
        head=("method", "minus", *METRIC_HEAD, "p", "p_corrected"),
        records=tuple(records),
    )


def headroom_table(study: Study) -> Table | None:
    """Return which share of the headroom each method closes; None where baseline or bound were not run."""
    lines, records = [], []
    for method in study.methods:
        baseline, bound = study.fellow(method, BASELINE), study.fellow(method, BOUND)
        if baseline is None or bound is None or method in {baseline, bound}:
            continue
        if len({study.of(name)[0].score.time_limit_s for name in (method, baseline, bound)}) > 1:
            continue
        cells = []
        for name in HEADROOM:
            metric = study.results.headroom(method, name, baseline=baseline, bound=bound)
            cells.append(metric_cell(metric, share, href=link(method=method, versus=baseline, by="any")))
            records += metric_record([method], replace(metric, name=name) if metric else None)
        lines.append(Line(method, tuple(cells), method))
    if not lines:
        return None
    return Table(
        key="headroom",
        caption=f"Share of headroom closed, from {BASELINE} to {BOUND}",
        columns=("method", *HEADROOM),
        groups=(Group("", tuple(lines)),),
        note=f"(m − b) / (B − b), on the missions that all three have: 0 is {BASELINE}, 1 is {BOUND}, which knows the "
        f"way within 60 m beyond each frontier. {NONE}: the bound is no better than the baseline. An end of ∞: in too "
        "many resamples it is not.",
        head=("method", *METRIC_HEAD),
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
        for name in shown:
            for city in study.cities:
                table = study.results.table(method, city=city)
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
        _mean(study, entries, "small", lambda entry: float(entry.row.small_collisions)),
        _mean(study, entries, "large", lambda entry: float(entry.row.large_collisions)),
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
                    tuple(Line(name, tuple(Cell(text) for text in table.written(name))) for name, _ in table.rows),
                ),
            ),
            spans=tuple((metric, 5) for metric in ("SR", "OSR", "SPL", "CASR")) if table.number == "I" else (),
            head=table.columns,
            records=tuple((name, *values) for name, values in table.rows),
        )
        for table in PAPER_TABLES
    )


_SPENT = (*_AMOUNTS.values(), *(name for name, _ in _COSTS))
_FULL_COLUMNS = ("method", "missions", *_SHARES, *_SPENT)
_SHARES_NOTE = (
    "SR: declared in place and in time. OSR: at some moment declaring would have been right; seen: and what it takes "
    "was looked at (the oracle looks at nothing). soft-SPL: how far the way to the goal was covered, declared or not. "
    "CASR: the paper’s SR · mean(1 − (CT + TT)/T_max); “per mission” is mean(S · (1 − (CT + TT)/T_max)), which a fast "
    "false halt cannot raise; “paper-style” counts the planner’s CT only. Each number leads to its missions."
)
_AMOUNTS_NOTE = (
    "nDTW: how near the way was to the reference way, of level-3 missions only. To goal: straight, at the end. CT: "
    "thinking; TT: travelling."
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


def _count(study: Study, method: str, level: int | None) -> Cell:
    href, about = _target(method, level, "missions")
    return Cell(f"{len(study.of(method, level=level))}", "", href, about)


def _amounts(study: Study, method: str, level: int | None) -> list[Cell]:
    return [
        _metric(study, method, level, name, share if name == "nDTW" else amount)  # a share of 1, the others have units
        for name in _AMOUNTS
    ]


def _costs(study: Study, method: str, level: int | None) -> list[Cell]:
    href, about = _target(method, level, "missions")
    costs = costs_of(study, study.of(method, level=level))
    return [
        metric_cell(metric, money if name == "USD" else amount, href=href, about=about)
        for name, metric in costs.items()
    ]


def _full_line(study: Study, method: str, level: int | None) -> Line:
    if not study.of(method, level=level):
        return Line(method, tuple(Cell(NONE) for _ in _FULL_COLUMNS[1:]), method)
    shares = [_metric(study, method, level, name, share) for name in _SHARES]
    cells = (_count(study, method, level), *shares, *_amounts(study, method, level), *_costs(study, method, level))
    return Line(method, cells, method)


def _full_records(study: Study, levels: Sequence[int | None]) -> tuple[tuple[str | int | float | None, ...], ...]:
    records = []
    for method in study.methods:
        for level in levels:
            entries = study.of(method, level=level)
            if not entries:
                continue
            first = [method, level_name(level)]
            table = study.results.table(method, level)
            for metric in (*(table.metrics if table else ()), *costs_of(study, entries).values()):
                records += metric_record(first, metric)
    return tuple(records)
