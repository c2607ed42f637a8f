"""The charts of the report, each from the same figures as the table that stands under it."""

from collections.abc import Sequence
from functools import partial

from matplotlib.axes import Axes

from reasoned_explorer.evaluation.metrics import Metric
from reasoned_explorer.evaluation.report.charts import Chart, Panel
from reasoned_explorer.evaluation.report.curves import Curve
from reasoned_explorer.evaluation.report.looks import CAUSE_LOOKS, INKS, Look
from reasoned_explorer.evaluation.report.results import collisions_of
from reasoned_explorer.evaluation.report.study import Study
from reasoned_explorer.evaluation.wording import amount, level_name, share
from reasoned_explorer.world.drawing_style import printable, shortened

_INK, _SOFT, _GHOST, _PAPER = (INKS[name][0] for name in ("ink", "soft", "ghost", "paper"))
Looks = dict[str, Look]


def levels_chart(study: Study, looks: Looks) -> Chart:
    """Return SR against OSR by level (the paper's Fig. 6), one panel a method."""
    levels: list[int | None] = [*study.levels, None]
    told = []
    for method in study.methods:
        pairs = [
            f"{level_name(level)} {share(success.value)}/{share(oracle.value)}"
            for level in levels
            if (success := study.metric(method, level, "SR")) and (oracle := study.metric(method, level, "OSR"))
        ]
        told.append(f"{method} {', '.join(pairs)}")
    return Chart(
        key="sr-osr",
        caption="SR against OSR by level, as the paper’s Fig. 6. Solid: SR. Pale, behind it: OSR; what is pale alone "
        "was reached and not declared. Whiskers: 95 % intervals of SR (dark) and OSR (grey).",
        alt="Bars, one panel a method. SR/OSR: " + "; ".join(told) + ".",
        panels=tuple(
            Panel(method, partial(_draw_levels, study, looks[method], method, levels)) for method in study.methods
        ),
    )


def _draw_levels(study: Study, look: Look, method: str, levels: Sequence[int | None], axes: Axes) -> None:
    for place, level in enumerate(levels):
        x = place + (0.35 if level is None else 0.0)
        success, oracle = study.metric(method, level, "SR"), study.metric(method, level, "OSR")
        if success is None or oracle is None:
            continue
        axes.bar(x, oracle.value, width=0.78, color=look.colour, alpha=0.28, linewidth=0)
        axes.bar(x, success.value, width=0.44, color=look.colour, linewidth=0)
        _whisker(axes, x + 0.31, oracle, _SOFT, 0.8)
        _whisker(axes, x, success, _INK, 1.0)
    axes.set_xticks([place + (0.35 if level is None else 0.0) for place, level in enumerate(levels)])
    axes.set_xticklabels([level_name(level) for level in levels])
    axes.set_ylim(0.0, 1.0)
    axes.set_yticks([0.0, 0.5, 1.0], ["0", ".5", "1"])


def _whisker(axes: Axes, x: float, metric: Metric, colour: str, width: float) -> None:
    axes.plot([x, x], [metric.low, metric.high], color=colour, lw=width, solid_capstyle="butt")


def differences_chart(study: Study, looks: Looks) -> Chart | None:
    """Return paired differences with their intervals; None with a single method."""
    if not study.differences:
        return None
    names = ("SR", "SPL", "CASR per mission")
    told = [
        f"{item.method} minus {item.base}: "
        + ", ".join(
            f"{name} {share(item.table[name].value)} [{share(item.table[name].low)}, {share(item.table[name].high)}]"
            for name in names
        )
        for item in study.differences
    ]
    return Chart(
        key="differences",
        caption="Paired differences to the first method on the same missions, with 95 % intervals. What lies right of "
        "the line is better than the first method.",
        alt="Points with whiskers. " + "; ".join(told) + ".",
        panels=tuple(Panel(name, partial(_draw_differences, study, looks, name)) for name in names),
        size_in=(3.5, 0.75 + 0.2 * len(study.differences)),
        columns=3,
    )


def _draw_differences(study: Study, looks: Looks, name: str, axes: Axes) -> None:
    axes.axvline(0.0, color=_SOFT, lw=0.9)
    for place, item in enumerate(study.differences):
        metric, look = item.table[name], looks[item.method]
        axes.plot([metric.low, metric.high], [place, place], color=look.colour, lw=1.3, solid_capstyle="butt")
        _mark(axes, metric.value, place, look, 4.5)
    axes.set_yticks(range(len(study.differences)), [_short(item.method) for item in study.differences])
    axes.set_ylim(len(study.differences) - 0.5, -0.5)
    axes.tick_params(axis="y", length=0)
    axes.grid(visible=False, axis="y")
    axes.grid(visible=True, axis="x", color=INKS["rule"][0], linewidth=0.5)
    axes.xaxis.set_major_formatter(lambda value, _: _tick(value))
    axes.margins(x=0.08)


def curves_chart(
    study: Study, looks: Looks, curves: Sequence[Curve], *, key: str, caption: str, axis: str, what: str
) -> Chart:
    """Return a figure over something, one panel a method, the others of its kind in grey behind it."""
    # The scale is that of the methods; what goes beyond it, as bounds do, has the whole scale.
    own = [curve for curve in curves if curve.method not in study.bounds] or list(curves)
    usual = min(1.0, 1.08 * max((metric.high for curve in own for _, metric in curve.points), default=1.0)) or 1.0
    panels, beyond = [], []
    for curve in curves:
        fits = max((metric.high for _, metric in curve.points), default=0.0) <= usual
        others = [other for other in curves if other.method != curve.method]
        draw = partial(
            _draw_curve, look=looks[curve.method], curve=curve, others=others, top=usual if fits else 1.0, axis=axis
        )
        panels.append(Panel(curve.method, draw))
        beyond += [] if fits else [curve.method]
    told = [
        f"{curve.method} from {share(curve.line[0][1])} at {curve.line[0][0]:g} to {share(curve.line[-1][1])} at "
        f"{curve.line[-1][0]:g}"
        for curve in curves
        if curve.line
    ]
    scales = f" On a scale of their own: {', '.join(beyond)}." if beyond else ""
    return Chart(
        key=key,
        caption=f"{caption} In colour: the method of the panel, with 95 % intervals; in grey: the others.{scales}",
        alt=f"Lines of {what} over {axis}, one panel a method: " + "; ".join(told) + ".",
        panels=tuple(panels),
    )


def _draw_curve(axes: Axes, *, look: Look, curve: Curve, others: Sequence[Curve], top: float, axis: str) -> None:
    for other in others:
        axes.plot(*_columns(other.line), color=_GHOST, lw=0.9)
    axes.plot(*_columns(curve.line), color=look.colour, lw=1.7, ls=look.dashes)
    for x, metric in curve.points:
        axes.plot([x, x], [metric.low, metric.high], color=look.colour, lw=1.0, alpha=0.75)
        _mark(axes, x, metric.value, look, 4.0)
    axes.set_ylim(0.0, top)
    _write_shares(axes, top)
    axes.set_xticks([x for x, _ in curve.points])
    axes.set_xlabel(axis)


def _columns(points: Sequence[tuple[float, float]]) -> tuple[list[float], list[float]]:
    return [x for x, _ in points], [y for _, y in points]


def ct_casr_chart(study: Study, looks: Looks) -> Chart:
    """Return CT against CASR: one point a method, over all levels and at each."""
    levels: list[int | None] = [None, *study.levels]
    told = [
        f"{method} CT {amount(ct.value)} s, CASR {share(casr.value)}"
        for method in study.methods
        if (ct := study.metric(method, None, "CT")) and (casr := study.metric(method, None, "CASR"))
    ]
    panels = [
        Panel("All levels" if level is None else f"Level {level}", partial(_draw_ct_casr, study, looks, level))
        for level in levels
    ]
    return Chart(
        key="ct-casr",
        caption="CT against CASR: one point a method, with 95 % intervals of both. Arrows: bounds that lie above the "
        "panel, with their CASR.",
        alt="Points, one panel for all levels and for each. Over all levels: " + "; ".join(told) + ".",
        panels=(*panels, Panel("", partial(_draw_legend, study.methods, looks))),
        columns=3,
    )


def _draw_ct_casr(study: Study, looks: Looks, level: int | None, axes: Axes) -> None:
    points = {
        method: (ct, casr)
        for method in study.methods
        if (ct := study.metric(method, level, "CT")) and (casr := study.metric(method, level, "CASR"))
    }
    own = [pair for method, pair in points.items() if method not in study.bounds] or list(points.values())
    top = min(1.0, 1.12 * max((casr.high for _, casr in own), default=1.0)) or 1.0
    above = 0
    for method, (ct, casr) in points.items():
        look = looks[method]
        if casr.value > top:  # a bound, far above the others: told at the edge
            above += 1
            y = top * (1.0 - 0.1 * (above - 0.4))
            _mark(axes, ct.value, y, look, 5.0)
            axes.annotate(
                f"{_short(method, 20)} {share(casr.value)} ↑",
                (ct.value, y),
                xytext=(6.0, 0.0),
                textcoords="offset points",
                va="center",
                fontsize=7.0,
                color=_SOFT,
            )
            continue
        axes.plot([ct.low, ct.high], [casr.value, casr.value], color=look.colour, lw=0.8, alpha=0.7)
        axes.plot([ct.value, ct.value], [casr.low, casr.high], color=look.colour, lw=0.8, alpha=0.7)
        _mark(axes, ct.value, casr.value, look, 5.0)
    axes.set_ylim(0.0, top)
    axes.set_xlim(0.0, 1.05 * max((ct.high for ct, _ in points.values()), default=1.0) or 1.0)
    _write_shares(axes, top)
    axes.grid(visible=True, axis="x", color=INKS["rule"][0], linewidth=0.5)
    axes.set_xlabel("mean CT, s")
    axes.set_ylabel("CASR")


def _write_shares(axes: Axes, top: float) -> None:
    """Write the ticks of a vertical axis without leading zeros."""
    ticks = [tick for tick in axes.get_yticks() if 0.0 <= tick <= top + 1e-9]
    axes.set_yticks(ticks, [_tick(tick) for tick in ticks])


def _tick(value: float) -> str:
    text = share(value, 3).rstrip("0").rstrip(".")
    return text if text.lstrip("−") else "0"


def _draw_legend(methods: Sequence[str], looks: Looks, axes: Axes) -> None:
    axes.set_axis_off()
    rows = max(9, (len(methods) + 1) // 2)
    for place, method in enumerate(methods):
        column, row = divmod(place, rows)
        y = 1.0 - (row + 0.5) / rows
        _mark(axes, 0.03 + 0.52 * column, y, looks[method], 5.0)
        axes.text(
            0.09 + 0.52 * column,
            y,
            _short(method, 21 if len(methods) > rows else 34),
            fontsize=7.5,
            va="center",
            color=_INK,
        )
    axes.set_xlim(0.0, 1.0)
    axes.set_ylim(0.0, 1.0)


def causes_chart(study: Study) -> Chart:
    """Return what became of the missions: one bar a method, cut by cause."""
    told = []
    for method in study.methods:
        total = len(study.of(method))
        parts = [
            f"{cause.value} {100.0 * count / total:.0f} %"
            for cause in study.causes
            if (count := len(study.of(method, cause=cause)))
        ]
        told.append(f"{method}: {', '.join(parts)}")
    legend_rows = (len(study.causes) + 2) // 3
    return Chart(
        key="causes",
        caption="What became of the missions, by cause; numbers are missions.",
        alt="Bars cut by cause. " + "; ".join(told) + ".",
        panels=(Panel("", partial(_draw_causes, study)),),
        size_in=(8.0, 0.7 + 0.27 * len(study.methods) + 0.2 * legend_rows),
    )


def _draw_causes(study: Study, axes: Axes) -> None:
    for place, method in enumerate(study.methods):
        total, left = len(study.of(method)), 0.0
        for cause in study.causes:
            count = len(study.of(method, cause=cause))
            wide, look = count / total, CAUSE_LOOKS[cause]
            axes.barh(
                place,
                wide,
                left=left,
                height=0.72,
                color=look.colour,
                hatch=look.hatch,
                edgecolor=_PAPER,
                linewidth=0.6,
            )
            if wide >= 0.035:
                letters = axes.text(
                    left + wide / 2.0, place, str(count), ha="center", va="center", fontsize=7.0, color=look.letters
                )
                if look.hatch:
                    letters.set_bbox({"facecolor": look.colour, "edgecolor": "none", "pad": 1.2, "hatch": ""})
            left += wide
    for cause in study.causes:
        look = CAUSE_LOOKS[cause]
        axes.barh(0, 0, color=look.colour, hatch=look.hatch, edgecolor=_PAPER, linewidth=0.6, label=cause.value)
    axes.set_yticks(range(len(study.methods)), [_short(method) for method in study.methods])
    axes.set_ylim(len(study.methods) - 0.5, -0.5)
    axes.set_xlim(0.0, 1.0)
    axes.set_xticks([0.0, 0.25, 0.5, 0.75, 1.0], ["0", "25 %", "50 %", "75 %", "100 %"])
    axes.grid(visible=False)
    axes.tick_params(axis="y", length=0)
    axes.legend(
        loc="upper center",
        bbox_to_anchor=(0.45, -0.35 / (0.27 * len(study.methods) + 0.2)),
        ncols=3,
        frameon=False,
        fontsize=7.5,
        labelcolor=_INK,
        handlelength=1.6,
        handleheight=0.9,
    )


def collisions_chart(study: Study, looks: Looks) -> Chart:
    """Return collisions a mission with small and with large things."""
    found = {method: collisions_of(study, method) for method in study.methods}
    told = [
        f"{name} small {amount(small.value)}, large {amount(large.value)}" for name, (small, large) in found.items()
    ]
    top = max((metric.high for pair in found.values() for metric in pair), default=1.0) or 1.0
    return Chart(
        key="collisions",
        caption="Collisions a mission by the size of the obstacle, with 95 % intervals. Small: less than 3 m long.",
        alt="Points with whiskers. Collisions a mission: " + "; ".join(told) + ".",
        panels=tuple(
            Panel(title, partial(_draw_collisions, {name: pair[at] for name, pair in found.items()}, looks, top))
            for at, title in enumerate(("Small obstacles", "Large obstacles"))
        ),
        size_in=(4.4, 0.75 + 0.2 * len(study.methods)),
        columns=2,
    )


def _draw_collisions(found: dict[str, Metric], looks: Looks, top: float, axes: Axes) -> None:
    for place, (method, metric) in enumerate(found.items()):
        look = looks[method]
        axes.plot([0.0, metric.value], [place, place], color=_GHOST, lw=0.9)
        axes.plot([metric.low, metric.high], [place, place], color=look.colour, lw=1.3, solid_capstyle="butt")
        _mark(axes, metric.value, place, look, 4.5)
    axes.set_yticks(range(len(found)), [_short(method) for method in found])
    axes.set_ylim(len(found) - 0.5, -0.5)
    axes.set_xlim(0.0, 1.05 * top)
    axes.grid(visible=False, axis="y")
    axes.grid(visible=True, axis="x", color=INKS["rule"][0], linewidth=0.5)
    axes.tick_params(axis="y", length=0)
    axes.set_xlabel("collisions a mission")


def _mark(axes: Axes, x: float, y: float, look: Look, size: float) -> None:
    axes.plot(
        [x],
        [y],
        ls="none",
        marker=look.marker,
        ms=size * (1.4 if look.marker == "*" else 1.0),
        fillstyle="full" if look.fill == "none" else look.fill,
        mfc=_PAPER if look.fill == "none" else look.colour,
        mfcalt=_PAPER,
        mec=look.colour,
        mew=1.0,
        zorder=5,
        clip_on=False,
    )


def _short(method: str, limit: int = 26) -> str:
    return shortened(printable(method), limit)
