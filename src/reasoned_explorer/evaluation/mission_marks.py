"""What a mission leaves on a map: track, decisions, ways on with their scores, goals, the start and the end."""

import math
from collections.abc import Sequence

import numpy as np
import shapely
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PathCollection, PolyCollection
from matplotlib.colors import LinearSegmentedColormap, to_hex
from matplotlib.path import Path as MarkPath
from matplotlib.transforms import IdentityTransform
from numpy.typing import NDArray

from reasoned_explorer.evaluation.mission_signs import (
    HALT_PT,
    START_PT,
    STEP_PT,
    halt_place,
    is_on_the_way,
    stands_on_a_step,
)
from reasoned_explorer.evaluation.mission_trace import MapFrontier, MapGoal, MissionTrace
from reasoned_explorer.geometry import Pose
from reasoned_explorer.world.drawing_style import mix, printable, shortened, width_pt
from reasoned_explorer.world.lettering import Room
from reasoned_explorer.world.painting import Board
from reasoned_explorer.world.sheet import put_text
from reasoned_explorer.world.symbols import compound_path
from reasoned_explorer.world.textures import lines_of, polygon_of

FloatArray = NDArray[np.float64]

#: Where else a name may stand when there is no room beside its mark, in widths and heights of it.
_FARTHER = ((0, -1.8), (0, 1.8), (0.7, -1.6), (-0.7, -1.6), (0.7, 1.6), (-0.7, 1.6))
#: The marks' colours; those of the verdict are told apart by their sign as well.
PINK = "#d6287a"
TRACK_FROM, TRACK_TO = "#4f82ea", "#101c4a"
GOLD, GOLD_EDGE = "#f2b01e", "#8a5a00"
SHORTEST = "#1d1d1d"
RIGHT, WRONG, NEUTRAL = "#00785a", "#c04a00", "#5b6068"
GRAPH = "#7d8794"
Q_RANGE = (1.0, 5.0)

#: Viridis without its palest end, which would be lost on light ground.
_SCORES = LinearSegmentedColormap.from_list("scores", colormaps["viridis"](np.linspace(0.0, 0.94, 64)))


def score_colour(q: float | None) -> str:
    """Return the colour of a score from 1 to 5; grey for none."""
    if q is None:
        return "#b9bdc2"
    low, high = Q_RANGE
    return str(to_hex(_SCORES(min(max((q - low) / (high - low), 0.0), 1.0))))


def regular(corners: int, *, turn_deg: float = 0.0, waist: float = 1.0) -> MarkPath:
    """Return a regular polygon of radius 1, or a star where ``waist`` is less than 1; a corner points north."""
    count = corners * (2 if waist < 1.0 else 1)
    angles = np.pi / 2 + math.radians(turn_deg) + np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    radii = np.where(np.arange(count) % 2 == 0, 1.0, waist) if waist < 1.0 else np.ones(count)
    return compound_path([np.column_stack([radii * np.cos(angles), radii * np.sin(angles)])])


DISC = regular(40)
DIAMOND = regular(4)
STAR = regular(5, waist=0.45)
OCTAGON = regular(8, turn_deg=22.5)
CHEVRON = MarkPath([(-0.75, -0.55), (0.0, 0.35), (0.75, -0.55)], [MarkPath.MOVETO, MarkPath.LINETO, MarkPath.LINETO])
ARROW = compound_path([np.array([(0.0, 1.15), (0.8, -0.85), (0.0, -0.4), (-0.8, -0.85)])])
CROSS = MarkPath([(-1, -1), (1, 1), (-1, 1), (1, -1)], [MarkPath.MOVETO, MarkPath.LINETO] * 2)
TICK = MarkPath([(-0.9, 0.05), (-0.25, -0.65), (0.95, 0.75)], [MarkPath.MOVETO, MarkPath.LINETO, MarkPath.LINETO])


def turned(path: MarkPath, heading_rad: float) -> MarkPath:
    """Return a mark that points north turned to a compass heading."""
    sine, cosine = math.sin(heading_rad), math.cos(heading_rad)
    vertices = np.asarray(path.vertices, dtype=np.float64)
    x, y = vertices[:, 0], vertices[:, 1]
    return MarkPath(np.column_stack([x * cosine + y * sine, -x * sine + y * cosine]), path.codes)


def arc_path(share: float) -> MarkPath:
    """Return the arc of a dial of radius 1 that starts at the top and runs clockwise over a share of the circle."""
    angles = np.pi / 2 - np.linspace(0.0, 2.0 * np.pi * min(max(share, 0.0), 1.0), 40)
    return MarkPath(np.column_stack([np.cos(angles), np.sin(angles)]))


def stamp(
    axes: Axes,
    place: tuple[float, float],
    path: MarkPath,
    size_pt: float,
    *,
    face: str = "none",
    edge: str = "none",
    width: float = 0.8,
    alpha: float = 1.0,
    zorder: float = 10.0,
) -> None:
    """Put a mark of radius ``size_pt`` points at a place of the axes."""
    axes.add_collection(
        PathCollection(
            [path],
            sizes=[size_pt * size_pt],
            offsets=[place],
            offset_transform=axes.transData,
            transform=IdentityTransform(),
            facecolors=face,
            edgecolors=edge,
            linewidths=width,
            alpha=alpha,
            zorder=zorder,
            capstyle="round",
            joinstyle="round",
        ),
        autolim=False,
    )


def paint_mission(board: Board, trace: MissionTrace, room: Room) -> None:
    """Paint all that happened, from the success region at the bottom to the halt at the top.

    Args:
        board: The map, with its world painted.
        trace: What happened.
        room: What is free for names; the marks take theirs from it.
    """
    _paint_success_region(board, trace)
    _paint_graph(board, trace)
    _paint_shortest(board, trace.shortest_way)
    _paint_track(board, np.asarray(trace.track, dtype=np.float64).reshape(-1, 2))
    pace = pace_pt(board, trace.path_points)
    _paint_frontiers(board, trace.frontiers, pace)
    _paint_path_points(board, trace, pace)
    _paint_goals(board, trace)
    _paint_start(board, trace.start)
    halt = halt_place(board, trace)
    _paint_end(board, trace, halt)
    room.block(np.array([halt]), HALT_PT)
    room.block(places_of(trace), 8.0)
    if len(trace.track):
        room.block(np.asarray(trace.track), 3.0)
    _label(board, trace, room, halt)


def places_of(trace: MissionTrace) -> FloatArray:
    """Return where marks stand: start, end, decisions, ways on and goals, shape (n, 2), n ≥ 2."""
    marks = [(trace.start.x_m, trace.start.y_m), (trace.end.x_m, trace.end.y_m), *trace.path_points]
    marks += [(frontier.x_m, frontier.y_m) for frontier in trace.frontiers]
    marks += [(goal.x_m, goal.y_m) for goal in trace.goals]
    return np.array(marks, dtype=np.float64)


def _paint_success_region(board: Board, trace: MissionTrace) -> None:
    """Where a halt counts: within R of the footprints; weaker goals get a fainter halo of their own."""
    for grades, alpha, width in (((0, 1), 0.06, 0.6), ((2,), 0.17, 1.0)):
        footprints = [_footprint(goal) for goal in trace.goals if goal.grade in grades and _near(board, goal, trace)]
        if not footprints:
            continue
        halo = shapely.union_all([shape.buffer(trace.success_radius_m) for shape in footprints])
        outlines = [np.asarray(part.exterior.coords)[:, :2] for part in shapely.get_parts(halo) if not part.is_empty]
        board.axes.add_collection(
            PolyCollection(outlines, facecolors=GOLD, edgecolors="none", alpha=alpha, zorder=5.5), autolim=False
        )
        board.axes.add_collection(
            LineCollection(
                lines_of(halo.boundary), colors=GOLD_EDGE, linewidths=width, linestyles=(0, (4.0, 2.2)), zorder=5.6
            ),
            autolim=False,
        )
        areas = [goal.outline for goal in trace.goals if goal.grade in grades and goal.outline is not None]
        board.axes.add_collection(
            PolyCollection(areas, facecolors=GOLD, edgecolors=GOLD_EDGE, linewidths=0.9, alpha=alpha, zorder=5.7),
            autolim=False,
        )


def _footprint(goal: MapGoal) -> shapely.geometry.base.BaseGeometry:
    if goal.outline is not None:
        shape = polygon_of(np.asarray(goal.outline, dtype=np.float64))
        if not shape.is_empty:
            return shape
    return shapely.Point(goal.x_m, goal.y_m)


def _near(board: Board, goal: MapGoal, trace: MissionTrace) -> bool:
    if goal.outline is not None:
        return board.shows(goal.outline, margin_m=trace.success_radius_m)
    return board.shows_point(goal.x_m, goal.y_m, margin_m=trace.success_radius_m)


def _paint_graph(board: Board, trace: MissionTrace) -> None:
    edges = [np.array(edge, dtype=np.float64) for edge in trace.edges]
    for colour, width, zorder in ((board.palette.paper, 2.2, 6.60), (GRAPH, 0.9, 6.61)):
        board.axes.add_collection(
            LineCollection(edges, colors=colour, linewidths=width, zorder=zorder, capstyle="round"), autolim=False
        )


def _paint_shortest(board: Board, way: FloatArray | None) -> None:
    if way is None or len(way) < 2:
        return
    for colour, width, style, zorder in (
        (board.palette.paper, 3.6, "solid", 6.70),
        (SHORTEST, 1.5, (0, (4.2, 2.6)), 6.71),
    ):
        board.axes.add_collection(
            LineCollection([way], colors=colour, linewidths=width, linestyles=[style], zorder=zorder), autolim=False
        )


def _paint_track(board: Board, track: FloatArray) -> None:
    """A broad line that darkens with time, with chevrons that say which way."""
    if len(track) < 2:
        return
    steps = np.hypot(*np.diff(track, axis=0).T)
    at_m = np.concatenate([[0.0], np.cumsum(steps)])
    if at_m[-1] <= 0.0:
        return
    count = int(min(max(board.points(float(at_m[-1])) / 3.0, 8), 2500))
    marks = np.linspace(0.0, at_m[-1], count)
    line = np.column_stack([np.interp(marks, at_m, track[:, 0]), np.interp(marks, at_m, track[:, 1])])
    shares = 0.5 * (marks[1:] + marks[:-1]) / at_m[-1]
    board.axes.add_collection(
        LineCollection([track], colors=board.palette.paper, linewidths=7.6, zorder=7.0, joinstyle="round"),
        autolim=False,
    )
    board.axes.add_collection(
        LineCollection(
            list(np.stack([line[:-1], line[1:]], axis=1)),
            colors=[mix(TRACK_FROM, TRACK_TO, float(share)) for share in shares],
            linewidths=4.6,
            zorder=7.1,
            capstyle="round",
        ),
        autolim=False,
    )
    spacing_m = 34.0 * board.metres_per_point
    for place in np.arange(0.5 * spacing_m, at_m[-1], spacing_m)[:400]:
        behind, ahead = max(place - 3 * board.metres_per_point, 0.0), min(place + 3 * board.metres_per_point, at_m[-1])
        x, y = (np.interp([behind, place, ahead], at_m, track[:, axis]) for axis in (0, 1))
        heading_rad = math.atan2(x[2] - x[0], y[2] - y[0])
        stamp(board.axes, (x[1], y[1]), turned(CHEVRON, heading_rad), 2.0, edge="#ffffff", width=0.95, zorder=7.2)


def pace_pt(board: Board, points: Sequence[tuple[float, float]]) -> float:
    """Return the usual distance between one decision and the next, points on the sheet; large where there are few."""
    if len(points) < 3:
        return 60.0
    steps = np.hypot(*np.diff(np.array(points, dtype=np.float64), axis=0).T)
    return board.points(float(np.median(steps)))


def _paint_frontiers(board: Board, frontiers: Sequence[MapFrontier], pace: float) -> None:
    size_pt = min(max(0.24 * pace, 2.4), 5.6)
    order = {"visited": 0, "given up": 1, "blocked": 2, "open": 3}
    for frontier in sorted(frontiers, key=lambda f: (order[f.state], f.q or 0.0, f.x_m, f.y_m)):
        draw_frontier(board.axes, (frontier.x_m, frontier.y_m), frontier, size_pt)


def draw_frontier(axes: Axes, place: tuple[float, float], frontier: MapFrontier, size_pt: float) -> None:
    """Draw one way on: a diamond in its score's colour, a tick the way it looks, a dial that shows σ(d).

    All of it lies under the track. One that is blocked is a small cross: there are many of them along every wall.
    """
    if frontier.state == "blocked":
        stamp(axes, place, CROSS, size_pt * 0.55, edge="#ffffff", width=2.6, zorder=6.8)
        stamp(axes, place, CROSS, size_pt * 0.55, edge=WRONG, width=1.2, zorder=6.81)
        return
    faded = frontier.state in {"visited", "given up"}
    alpha = 0.45 if frontier.state == "given up" else 0.85 if faded else 1.0
    size = size_pt * (0.66 if faded else 1.0)
    zorder = 6.82 if faded else 6.85
    # Small marks have thin lines, so that many of them are not black.
    thin = min(max(size_pt / 5.6, 0.6), 1.0)
    tick = turned(MarkPath([(0.0, 0.0), (0.0, 1.9)]), frontier.heading_rad)
    stamp(axes, place, tick, size, edge="#ffffff", width=2.4 * thin, alpha=alpha, zorder=zorder)
    stamp(axes, place, tick, size, edge="#2b3036", width=1.0 * thin, alpha=alpha, zorder=zorder)
    if frontier.penalty is not None and not faded:
        stamp(axes, place, arc_path(1.0), size * 1.25, edge="#ffffff", width=1.8 * thin, alpha=0.9, zorder=zorder)
        stamp(
            axes, place, arc_path(frontier.penalty), size * 1.25, edge="#2b3036", width=1.2 * thin, zorder=zorder + 0.01
        )
    colour = score_colour(frontier.q)
    stamp(axes, place, DIAMOND, size, face=colour, edge="#ffffff", width=0.9 * thin, alpha=alpha, zorder=zorder + 0.02)


def _paint_path_points(board: Board, trace: MissionTrace, pace: float) -> None:
    """Where decisions were made: dots on the track, of which as many have their number as leave it in sight."""
    numbers = Room(board)
    numbers.block(np.array([(trace.start.x_m, trace.start.y_m)]), START_PT)
    every = 1 if pace >= 22.0 else 5 if pace >= 4.0 else 10
    size_pt = min(max(0.2 * pace, 1.6), 2.6)
    last = len(trace.path_points)
    for step, (x, y) in reversed(list(enumerate(trace.path_points, start=1))):
        wanted = step % every == 0 or step == last
        if wanted and numbers.take(np.array([[x, y]]), 7.0, whole=False):
            draw_path_point(board.axes, (x, y), str(step))
        else:
            stamp(board.axes, (x, y), DISC, size_pt, face=PINK, edge="#ffffff", width=0.6, zorder=8.6)


def draw_path_point(axes: Axes, place: tuple[float, float], text: str) -> None:
    """Draw one decision: a pink disc with its number."""
    stamp(axes, place, DISC, STEP_PT - 0.7, face=PINK, edge="#ffffff", width=0.9, zorder=8.7)
    size = 6.4 if len(text) < 2 else 5.6 if len(text) < 3 else 4.2
    put_text(
        axes,
        *place,
        text,
        size_pt=size,
        face="sans-bold",
        colour="#ffffff",
        align="center",
        valign="center_baseline",
        zorder=8.8,
    )


def _paint_goals(board: Board, trace: MissionTrace) -> None:
    shown = [goal for goal in trace.goals if board.shows_point(goal.x_m, goal.y_m)]
    size_pt = min(
        8.5 if len(shown) <= 20 else 6.0 if len(shown) <= 80 else 4.5, 8.5 / math.sqrt(board.metres_per_point)
    )
    for goal in sorted(shown, key=lambda g: (g.reached, g.grade, g.x_m, g.y_m)):
        size = max(size_pt, 8.5) if goal.reached else size_pt
        # Where the way leads past a goal the star lies under it, large enough for its points to be seen.
        if is_on_the_way(board, trace, goal):
            draw_goal(board.axes, (goal.x_m, goal.y_m), goal.grade, max(size, 11.0), zorder=6.9)
        else:
            draw_goal(board.axes, (goal.x_m, goal.y_m), goal.grade, size)


def draw_goal(axes: Axes, place: tuple[float, float], grade: int, size_pt: float, *, zorder: float = 8.9) -> None:
    """Draw one goal: a golden star, hollow where it would only do at a pinch."""
    size = size_pt if grade >= 2 else 0.75 * size_pt
    face = GOLD if grade >= 2 else "#fdf3d6"
    stamp(axes, place, STAR, size, edge="#ffffff", width=3.0, zorder=zorder)
    stamp(axes, place, STAR, size, face=face, edge=GOLD_EDGE, width=1.0, zorder=zorder + 0.01)


def _paint_start(board: Board, start: Pose) -> None:
    draw_start(board.axes, (start.x_m, start.y_m), start.heading_rad)


def draw_start(axes: Axes, place: tuple[float, float], heading_rad: float) -> None:
    """Draw the start: an arrow on a white disc."""
    stamp(axes, place, DISC, 8.6, face="#ffffff", edge=TRACK_TO, width=1.2, zorder=9.0)
    stamp(axes, place, turned(ARROW, heading_rad), 5.0, face=TRACK_TO, zorder=9.1)


def verdict(trace: MissionTrace) -> tuple[str, str]:
    """Return what came of the mission in few words, and its colour."""
    if trace.success:
        return "Found", RIGHT
    if trace.declared and trace.success is False:
        return "Declared, but not there", WRONG
    if trace.declared:
        return "Declared, not judged", NEUTRAL
    return "Ended without finding it", WRONG if trace.success is False else NEUTRAL


def _paint_end(board: Board, trace: MissionTrace, halt: tuple[float, float]) -> None:
    """The halt: a sign on a pole, so that it does not hide what it stands on."""
    x, y = trace.end.x_m, trace.end.y_m
    on_step = stands_on_a_step(board, trace)
    share = STEP_PT * board.metres_per_point / max(math.dist((x, y), halt), 1e-9) if on_step else 0.0
    foot = (x + share * (halt[0] - x), y + share * (halt[1] - y))
    for colour, width in (("#ffffff", 3.2), (verdict(trace)[1], 1.7)):
        board.axes.add_collection(
            LineCollection([[foot, halt]], colors=colour, linewidths=width, zorder=9.2), autolim=False
        )
    if not on_step:
        stamp(board.axes, (x, y), DISC, 2.6, face=verdict(trace)[1], edge="#ffffff", width=0.9, zorder=9.25)
    draw_halt(board.axes, halt, trace)


def draw_halt(axes: Axes, place: tuple[float, float], trace: MissionTrace) -> None:
    """Draw the sign that marks the halt: a tick for found, a cross for a wrong declaration, a bar for none."""
    stamp(axes, place, OCTAGON, 9.8, face=verdict(trace)[1], edge="#ffffff", width=1.4, zorder=9.3)
    bar = MarkPath([(-0.8, 0.0), (0.8, 0.0)])
    sign = TICK if trace.success else CROSS if trace.declared and trace.success is False else bar
    stamp(axes, place, sign, 4.4, edge="#ffffff", width=1.9, zorder=9.4)


def _label(board: Board, trace: MissionTrace, room: Room, halt: tuple[float, float]) -> None:
    """Name the start, the halt, the goal that was reached and the ones nearest to the track, where there is room."""
    scale = board.metres_per_point
    wanted = [
        ("Start", trace.start.x_m, trace.start.y_m, 11.0, TRACK_TO, "sans-bold", 8.2),
        ("Halt", *halt, 11.5, verdict(trace)[1], "sans-bold", 8.2),
    ]
    track = np.asarray(trace.track, dtype=np.float64).reshape(-1, 2)
    near = np.vstack([track, [[trace.end.x_m, trace.end.y_m]]])
    ranked = sorted(
        (goal for goal in trace.goals if board.shows_point(goal.x_m, goal.y_m) and goal.label),
        key=lambda goal: (
            not goal.reached,
            -goal.grade,
            float(np.hypot(*(near - (goal.x_m, goal.y_m)).T).min()),
            goal.x_m,
        ),
    )
    # A label that says the same as two others says nothing new.
    told = [goal.label for goal in ranked]
    ranked = [goal for place, goal in enumerate(ranked) if told[:place].count(goal.label) < 2]
    stars = [(goal.label, goal.x_m, goal.y_m, 9.5, GOLD_EDGE, "sans-bold", 7.4) for goal in ranked[:6]]
    wanted = [*stars[:1], *wanted, *stars[1:]]
    for name, x, y, beside_pt, colour, face, size_pt in wanted:
        text = shortened(printable(name), 34)
        wide = width_pt(text, face, size_pt)
        for side_x, side_y in (
            (1, 0),
            (-1, 0),
            (0, -1),
            (0, 1),
            (0.8, 0.8),
            (-0.8, 0.8),
            (0.8, -0.8),
            (-0.8, -0.8),
            *_FARTHER,
        ):
            middle_x = x + side_x * (beside_pt + wide / 2) * scale
            middle_y = y + side_y * (beside_pt + size_pt / 2) * scale
            reach = np.linspace(-wide / 2, wide / 2, max(2, int(wide / 4))) * scale
            if room.take(np.column_stack([middle_x + reach, np.full(len(reach), middle_y)]), size_pt * 0.55):
                put_text(
                    board.axes,
                    middle_x,
                    middle_y - 0.36 * size_pt * scale,
                    text,
                    size_pt=size_pt,
                    face=face,
                    colour=colour,
                    align="center",
                    halo="#ffffff",
                    zorder=9.6,
                )
                break
