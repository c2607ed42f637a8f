"""The words beside and around the picture of a mission: headline, verdict, facts, scales, legend, footnotes."""

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.patches import FancyBboxPatch, Rectangle

from reasoned_explorer.evaluation import mission_marks as marks
from reasoned_explorer.evaluation.mission_trace import MapFrontier, MissionTrace
from reasoned_explorer.world.drawing_style import mix, wrapped
from reasoned_explorer.world.sheet import WIDTH_PT, Sheet, swatch
from reasoned_explorer.world.symbols import symbol_of
from reasoned_explorer.world.taxonomy import OBJECT_CLASSES

MARGIN_PT = 30.0
#: The slanting lines beyond the edge of the world.
OUTSIDE = "#d3cec3"
_FACT_ROW_PT = 15.5
_LEGEND_ROW_PT = 15.0


def write_headline(sheet: Sheet, lines: Sequence[str], subtitle: str) -> None:
    """Write the goal sentence and the line under it at the top of the sheet."""
    y = sheet.height_pt - 27.0
    for place, line in enumerate(lines):
        y -= 20.0 if place == 0 else 27.0
        sheet.write(MARGIN_PT - 1.0, y, line, size_pt=26.0, face="serif-bold")
    sheet.write(
        MARGIN_PT, y - 17.0, subtitle, size_pt=9.5, colour=sheet.palette.soft_ink, room_pt=WIDTH_PT - 2 * MARGIN_PT
    )


def write_panel(
    sheet: Sheet, trace: MissionTrace, classes: set[str], *, left_pt: float, top_pt: float, bottom_pt: float
) -> None:
    """Write the side panel from the top down; what finds no room at the bottom is left out.

    Args:
        sheet: The sheet.
        trace: What happened.
        classes: The classes of objects that the map marks.
        left_pt: Left edge of the panel; it ends at the sheet's margin.
        top_pt: Top edge.
        bottom_pt: Bottom edge.
    """
    width = WIDTH_PT - MARGIN_PT - left_pt
    y = _write_verdict(sheet, trace, left_pt, top_pt, width)
    y = _write_facts(sheet, trace, left_pt, y, width, floor_pt=bottom_pt + 225.0)
    y = _write_scores(sheet, left_pt, y, width)
    y = _write_legend(sheet, trace, left_pt, y, bottom_pt)
    _write_symbols(sheet, classes, left_pt, y, bottom_pt)


def _write_verdict(sheet: Sheet, trace: MissionTrace, x: float, y: float, width: float) -> float:
    text, colour = marks.verdict(trace)
    sheet.page.add_patch(
        FancyBboxPatch(
            (x + 3.0, y - 25.0),
            width - 6.0,
            22.0,
            boxstyle="round,pad=3,rounding_size=5",
            facecolor=colour,
            edgecolor="none",
        )
    )
    marks.draw_halt(sheet.page, (x + 17.0, y - 14.0), trace)
    sheet.write(x + 33.0, y - 18.0, text, size_pt=11.5, face="sans-bold", colour="#ffffff", room_pt=width - 42.0)
    return y - 36.0


def _write_facts(sheet: Sheet, trace: MissionTrace, x: float, y: float, width: float, *, floor_pt: float) -> float:
    for place, (name, value) in enumerate(trace.facts):
        if y - _FACT_ROW_PT < floor_pt:
            sheet.write(
                x,
                y - 10.0,
                f"and {len(trace.facts) - place} more in the record",
                size_pt=8.0,
                colour=sheet.palette.soft_ink,
            )
            return y - 18.0
        y -= _FACT_ROW_PT
        if place:
            sheet.rule(x, x + width, y + 11.2, width=0.4)
        used = sheet.write(x, y, name, size_pt=9.0, colour=sheet.palette.soft_ink, room_pt=0.55 * width)
        sheet.write(x + width, y, value, size_pt=9.6, face="sans-bold", align="right", room_pt=width - used - 8.0)
    return y - 10.0


def _write_scores(sheet: Sheet, x: float, y: float, width: float) -> float:
    """The scale of Q: colour from 1 to 5."""
    _heading(sheet, x, y - 10.0, "Promise of a way on, Q")
    bar = width - 2.0
    steps = 120
    for step in range(steps):
        colour = marks.score_colour(1.0 + 4.0 * step / (steps - 1))
        sheet.page.add_patch(
            Rectangle((x + bar * step / steps, y - 26.0), bar / steps + 0.4, 9.0, facecolor=colour, edgecolor="none")
        )
    for score in range(1, 6):
        place = x + bar * (score - 1) / 4.0
        align = "left" if score == 1 else "right" if score == 5 else "center"
        sheet.write(place, y - 36.0, str(score), size_pt=8.0, colour=sheet.palette.soft_ink, align=align)
    return y - 44.0


def _heading(sheet: Sheet, x: float, y: float, text: str) -> None:
    sheet.write(x, y, text, size_pt=9.0, face="sans-bold")


def _write_legend(sheet: Sheet, trace: MissionTrace, x: float, y: float, bottom_pt: float) -> float:
    for text, draw in legend_entries(sheet, trace):
        if y - _LEGEND_ROW_PT < bottom_pt:
            return y
        y -= _LEGEND_ROW_PT
        draw(x + 13.0, y + 3.2)
        sheet.write(x + 32.0, y, text, size_pt=8.6, room_pt=WIDTH_PT - MARGIN_PT - x - 32.0)
    return y - 6.0


def legend_entries(sheet: Sheet, trace: MissionTrace) -> list[tuple[str, Callable[[float, float], None]]]:
    """Return the legend, each entry with who draws its mark: only what the picture really has in it."""
    page = sheet.page
    states = {frontier.state for frontier in trace.frontiers}

    def frontier(state: str, penalty: float | None) -> Callable[[float, float], None]:
        mark = MapFrontier(0.0, 0.0, 1.2, 3.6, penalty, state)
        return lambda x, y: marks.draw_frontier(page, (x, y), mark, 4.6)

    def line(colours: Sequence[str], width: float, style: object) -> Callable[[float, float], None]:
        def draw(x: float, y: float) -> None:
            places = np.linspace(x - 12.0, x + 12.0, len(colours) + 1)
            pieces = [[(a, y), (b, y)] for a, b in pairwise(places)]
            page.add_collection(
                LineCollection(pieces, colors=list(colours), linewidths=width, linestyles=[style]), autolim=False
            )

        return draw

    ramp = [mix(marks.TRACK_FROM, marks.TRACK_TO, step / 15) for step in range(16)]
    entries: list[tuple[str, Callable[[float, float], None], bool]] = [
        ("start and heading", lambda x, y: marks.draw_start(page, (x, y), 0.7), True),
        ("track, darker with time", line(ramp, 4.0, "solid"), len(trace.track) > 1),
        (
            "place of a decision, in order",
            lambda x, y: marks.draw_path_point(page, (x, y), "3"),
            bool(trace.path_points),
        ),
        ("way on; dial: penalty σ(d)", frontier("open", 0.65), "open" in states),
        ("way on that was taken", frontier("visited", None), "visited" in states),
        ("given up", frontier("given up", None), "given up" in states),
        ("blocked", frontier("blocked", None), "blocked" in states),
        ("known connection", line([marks.GRAPH], 0.9, "solid"), bool(trace.edges)),
        ("shortest permitted way", line([marks.SHORTEST], 1.5, (0, (4.2, 2.6))), trace.shortest_way is not None),
        (
            f"goal, halo R = {trace.success_radius_m:g} m",
            lambda x, y: _goal_swatch(sheet, x, y, 2),
            any(goal.grade >= 2 for goal in trace.goals),
        ),
        (
            "would do at a pinch",
            lambda x, y: _goal_swatch(sheet, x, y, 1),
            any(goal.grade < 2 for goal in trace.goals),
        ),
        (
            f"no world; {trace.left_out} ways on left out",
            lambda x, y: swatch(sheet, x - 7.5, y - 4.5, sheet.palette.paper, hatch=OUTSIDE),
            trace.left_out > 0,
        ),
    ]
    return [(text, draw) for text, draw, occurs in entries if occurs]


def _goal_swatch(sheet: Sheet, x: float, y: float, grade: int) -> None:
    shade = 0.3 if grade >= 2 else 0.14
    face = mix(sheet.palette.paper, marks.GOLD, shade)
    marks.stamp(sheet.page, (x, y), marks.DISC, 7.0, face=face, edge=marks.GOLD_EDGE, width=0.5, zorder=2.0)
    marks.draw_goal(sheet.page, (x, y), grade, 5.2)


def _write_symbols(sheet: Sheet, classes: set[str], x: float, y: float, bottom_pt: float) -> None:
    """What the small symbols on the map mean, as many as fit, in two columns."""
    width = WIDTH_PT - MARGIN_PT - x
    order = sorted(classes, key=lambda name: (-symbol_of(name).rank, symbol_of(name).family, name))
    rows = int((y - 12.0 - bottom_pt) // 12.5)
    if rows < 1 or not order:
        return
    chosen = order[: 2 * rows]
    rows = (len(chosen) + 1) // 2
    for place, name in enumerate(chosen):
        column, row = divmod(place, rows)
        left, base = x + column * width / 2.0, y - 10.0 - 12.5 * row
        sheet.badge(left + 6.0, base + 2.8, symbol_of(name), 4.8)
        sheet.write(
            left + 15.0,
            base,
            OBJECT_CLASSES[name].noun,
            size_pt=7.6,
            colour=sheet.palette.soft_ink,
            room_pt=width / 2.0 - 18.0,
        )


def footnotes(trace: MissionTrace, attribution: str, width: float) -> list[tuple[str, str]]:
    """Return the lines at the foot of the sheet, each with its face: notes, then whom to thank."""
    lines: list[tuple[str, str]] = []
    if trace.notes:
        lines += [(line, "sans") for line in wrapped(" · ".join(trace.notes), "sans", 8.0, width, 3)]
    lines += [(line, "sans-bold") for line in wrapped(attribution, "sans-bold", 8.0, width, 2)]
    return lines
