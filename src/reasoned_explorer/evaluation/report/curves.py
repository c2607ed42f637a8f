"""What is shown over something: CASR over T_max, success over R, CASR against CT; and the tables of these."""

from dataclasses import dataclass

from reasoned_explorer.evaluation.metrics import Metric, aggregate
from reasoned_explorer.evaluation.report.links import link
from reasoned_explorer.evaluation.report.scores import (
    LEAST_METHODS,
    STEADY_WITHIN,
    Correlation,
    at_limit,
    casr_at,
    rank_correlation,
)
from reasoned_explorer.evaluation.report.study import Study
from reasoned_explorer.evaluation.report.tables import (
    METRIC_HEAD,
    Cell,
    Group,
    Line,
    Table,
    metric_cell,
    metric_record,
)
from reasoned_explorer.evaluation.wording import NONE, level_name, minutes, share

#: The limits that CASR is shown for, minutes; those above a run's own T_max are left out: nothing is known there.
LIMITS_MIN = (5.0, 10.0, 15.0, 20.0, 25.0, 30.0)
_AT_RADIUS = "SR at "


@dataclass(frozen=True, slots=True)
class Curve:
    """A figure of one method over something.

    Attributes:
        method: Its name.
        line: (where, value), close together.
        points: (where, figure with interval), far apart.
    """

    method: str
    line: tuple[tuple[float, float], ...]
    points: tuple[tuple[float, Metric], ...]


def casr_curves(study: Study) -> tuple[Curve, ...]:
    """Return CASR over T_max, minutes, recomputed from each mission's CT, TT and success."""
    curves = []
    for method in study.methods:
        scores = study.scores(method)
        own_min = scores[0].time_limit_s / 60.0
        limits = [limit for limit in LIMITS_MIN if limit < own_min - 1e-9]
        limits += [own_min] if own_min <= LIMITS_MIN[-1] + 1e-9 or not limits else []
        fine = [float(limit) for limit in range(int(limits[0]), int(limits[-1]) + 1)]
        where = sorted({*limits, *(limit for limit in fine if limit >= limits[0])})
        points = []
        for limit in limits:
            table = aggregate(
                [at_limit(item, 60.0 * limit) for item in scores], places=study.place_of, seed=study.about.seed
            )
            points.append((limit, table["CASR"]))
        curves.append(
            Curve(method, tuple((limit, casr_at(scores, 60.0 * limit)) for limit in where), tuple(points)),
        )
    return tuple(curves)


def casr_table(curves: tuple[Curve, ...]) -> Table:
    """Return CASR over T_max."""
    limits = sorted({limit for curve in curves for limit, _ in curve.points})
    lines, records = [], []
    for curve in curves:
        known = dict(curve.points)
        cells = [
            metric_cell(
                known.get(limit),
                share,
                href=link(method=curve.method, within=f"{60.0 * limit:g}"),
                about=f"missions of {curve.method} that succeeded within {limit:g} min",
            )
            for limit in limits
        ]
        lines.append(Line(curve.method, tuple(cells), curve.method))
        for limit in limits:
            records += metric_record([curve.method, limit], known.get(limit))
    return Table(
        key="casr-over-tmax",
        caption="CASR over T_max, all levels",
        columns=("method", *(f"{limit:g} min" for limit in limits)),
        groups=(Group("", tuple(lines)),),
        note="Recomputed from each mission’s CT and TT: what took longer is a failure. The methods knew the run’s own "
        "T_max only; none was run again to hurry under a shorter one.",
        head=("method", "t_max_min", *METRIC_HEAD),
        records=tuple(records),
    )


def radius_curves(study: Study) -> tuple[Curve, ...]:
    """Return success over R, metres."""
    curves = []
    for method in study.methods:
        metrics = study.table(method).metrics
        points = [
            (float(metric.name.removeprefix(_AT_RADIUS).removesuffix(" m")), metric)
            for metric in metrics
            if metric.name.startswith(_AT_RADIUS)
        ]
        points.sort(key=lambda point: point[0])
        curves.append(Curve(method, tuple((radius_m, metric.value) for radius_m, metric in points), tuple(points)))
    return tuple(curves)


def radius_table(curves: tuple[Curve, ...]) -> Table | None:
    """Return success over R; None where no mission was judged at other radii."""
    radii = sorted({radius_m for curve in curves for radius_m, _ in curve.points})
    if not radii:
        return None
    lines, records = [], []
    for curve in curves:
        known = dict(curve.points)
        cells = []
        for radius_m in radii:
            target = link(method=curve.method, radius=f"{radius_m:g}")
            about = f"missions of {curve.method} that succeed at {radius_m:g} m"
            cells.append(metric_cell(known.get(radius_m), share, href=target, about=about))
            records += metric_record([curve.method, radius_m], known.get(radius_m))
        lines.append(Line(curve.method, tuple(cells), curve.method))
    return Table(
        key="success-over-radius",
        caption="Success over R, all levels",
        columns=("method", *(f"{radius_m:g} m" for radius_m in radii)),
        groups=(Group("", tuple(lines)),),
        note="The same declarations, judged at other radii.",
        head=("method", "radius_m", *METRIC_HEAD),
        records=tuple(records),
    )


@dataclass(frozen=True, slots=True)
class Relation:
    """How CT goes with CASR, and with TT, over the methods of one level.

    Attributes:
        level: None for all.
        missions: That all these methods have.
        casr: Rank correlation of mean CT and CASR; None where it cannot be had.
        travel: Of mean CT and mean TT.
    """

    level: int | None
    missions: int
    casr: Correlation | None
    travel: Correlation | None


def relations(study: Study) -> tuple[Relation, ...]:
    """Return the relation over all levels first, then at each level; bounds, which know the truth, are left out."""
    methods = [method for method in study.methods if method not in study.bounds]
    common = study.common(methods)
    found = []
    for level in (None, *study.levels):
        scores = [
            [item for item in study.scores(method, level=level) if item.mission_id in common] for method in methods
        ]
        casr, travel = (
            rank_correlation(scores, of, places=study.place_of, seed=study.about.seed) for of in ("CASR", "TT")
        )
        found.append(Relation(level, len(scores[0]) if scores else 0, casr, travel))
    return tuple(found)


def relations_table(found: tuple[Relation, ...]) -> Table:
    """Return the rank correlations."""
    lines, records = [], []
    for relation in found:
        cells = [Cell(f"{relation.missions}", "", link(level=relation.level))]
        for metric in (relation.casr, relation.travel):
            cells += [metric_cell(metric, share), Cell(metric.reading if metric else NONE)]
            records += metric_record([level_name(relation.level)], metric)
        lines.append(Line(level_name(relation.level), tuple(cells)))
    return Table(
        key="ct-casr",
        caption="Rank correlation over methods of mean CT with CASR and with mean TT",
        columns=("level", "missions", "ρ(CT, CASR)", "reading", "ρ(CT, TT)", "reading"),
        groups=(Group("", tuple(lines)),),
        note=f"Spearman’s ρ over methods, bounds left out; at least {LEAST_METHODS} methods. The interval says what "
        "other missions would change, not what other methods would. Positive or negative: the interval lies on one "
        f"side of 0. Steady: it lies within ±{STEADY_WITHIN:g}. Undecided: none of these.",
        head=("level", *METRIC_HEAD),
        records=tuple(records),
    )


@dataclass(frozen=True, slots=True)
class Observation:
    """One of the paper's three observations, and what the run shows of it.

    Attributes:
        name: As the paper calls it.
        claim: What it claims.
        seen: What the run shows.
    """

    name: str
    claim: str
    seen: str


_CLAIMS = (
    (
        "positive",
        "Positive correlation with CT",
        "An increase in CT leading to a higher CASR suggests that more computation can reduce TT.",
    ),
    (
        "negative",
        "Negative correlation with CT",
        "A drop in CASR with increased CT indicates diminishing returns from additional computation.",
    ),
    (
        "steady",
        "Steady CASR despite CT variation",
        "A consistent CASR, despite varying CT, indicates that other factors, such as motion planning, dominate.",
    ),
)


def observations(found: tuple[Relation, ...]) -> tuple[Observation, ...]:
    """Return the paper's three observations with what the rank correlations, and nothing else, say of each."""
    return tuple(Observation(name, claim, _seen(reading, found)) for reading, name, claim in _CLAIMS)


def _seen(reading: str, found: tuple[Relation, ...]) -> str:
    known = [relation for relation in found if relation.casr is not None]
    if not known:
        return f"Nothing can be said: it takes {LEAST_METHODS} methods on the same missions that differ in CT and CASR."
    shown = [relation for relation in known if relation.casr and relation.casr.reading == reading]
    if not shown:
        levels = ", ".join(_told(relation) for relation in known[:1])
        return f"Not shown by this run, over all levels or at any one ({levels})."
    text = "Shown: " + "; ".join(_told(relation) for relation in shown) + "."
    if reading == "positive":
        text += " With TT: " + "; ".join(_travel(relation) for relation in shown) + "."
    return text


def _told(relation: Relation) -> str:
    metric = relation.casr
    where = "over all levels" if relation.level is None else f"at level {relation.level}"
    if metric is None:
        return where
    return f"{where} ρ = {share(metric.value)} [{share(metric.low)}, {share(metric.high)}], {metric.count} methods"


def _travel(relation: Relation) -> str:
    metric = relation.travel
    where = "over all levels" if relation.level is None else f"at level {relation.level}"
    if metric is None:
        return f"{where} not known"
    return f"{where} ρ = {share(metric.value)} [{share(metric.low)}, {share(metric.high)}], {metric.reading}"


def limit_text(study: Study) -> str:
    """Return T_max of the run in words."""
    limits = sorted({entry.score.time_limit_s for entry in study.entries})
    return " and ".join(f"{minutes(limit)} min" for limit in limits)
