"""The picture of a mission: where it was looked for, what was thought of each way on, and where it ended."""

import math
from pathlib import Path

import numpy as np
import shapely
from matplotlib.collections import LineCollection, PathCollection
from numpy.typing import NDArray

from reasoned_explorer.evaluation.mission_marks import paint_mission, places_of
from reasoned_explorer.evaluation.mission_panel import MARGIN_PT, OUTSIDE, footnotes, write_headline, write_panel
from reasoned_explorer.evaluation.mission_signs import RIM_PT
from reasoned_explorer.evaluation.mission_trace import MapFrontier, MapGoal, MissionTrace
from reasoned_explorer.model.errors import RecordError
from reasoned_explorer.model.stopping import stop_if_asked
from reasoned_explorer.world.drawing import fitted_bounds
from reasoned_explorer.world.drawing_style import Palette, wrapped
from reasoned_explorer.world.lettering import Room, letter_streets, place_badges
from reasoned_explorer.world.painting import Board, paint_world
from reasoned_explorer.world.sheet import (
    WIDTH_PT,
    Sheet,
    card,
    check_target,
    draw_north_arrow,
    draw_scale_bar,
    plain_settings,
    save,
    scale_bar_width_pt,
)
from reasoned_explorer.world.symbols import compound_path
from reasoned_explorer.world.textures import lines_of, polygon_of
from reasoned_explorer.world.world import Bounds, World

__all__ = ["LEAST_EXTENT_M", "MapFrontier", "MapGoal", "MissionTrace", "draw_mission"]

#: However little happened, the map shows at least so many metres.
LEAST_EXTENT_M = 150.0
#: Height of the sheet: that of the A series lying on its side.
_HEIGHT_PT = WIDTH_PT / 2.0**0.5
_PANEL_PT = 208.0
_GAP_PT = 18.0
#: How far the world steps back behind the mission, 0 (not at all) to 1 (gone).
_MUTED = 0.34


def draw_mission(world: World, trace: MissionTrace, path: Path | str, *, width_px: int = 2800) -> None:
    """Draw a mission into a file: a map of everything that happened and a panel with what came of it.

    The sheet has the shape of the A series; the same mission always gives the same bytes (with the same version of
    matplotlib).

    Args:
        world: Where it happened.
        trace: What happened.
        path: PNG, SVG or PDF by its suffix; the folder must exist. A file that is there is replaced, but only by a
            whole one.
        width_px: Width of a PNG, 300 to 12000; an SVG or PDF is 12 inches wide.

    Raises:
        RecordError: If the trace has numbers that are not finite or states that are unknown, if the width is no good
            or if the file cannot be written there; with all the reasons.
        PartError: If the disk fails, e.g. because it is full.
    """
    target = Path(path)
    faults = [*check_target(target, width_px), *trace.faults()]
    if faults:
        raise RecordError("mission picture", faults)
    with plain_settings():
        sheet = compose_mission(world, trace)
        save(sheet, target, width_px=width_px, title=trace.title, thanks=world.attribution, error=RecordError)


def compose_mission(world: World, trace: MissionTrace) -> Sheet:
    """Return the sheet with everything on it; to be called with plain settings of matplotlib."""
    room_pt = WIDTH_PT - 2 * MARGIN_PT
    headline = wrapped(trace.title, "serif-bold", 26.0, room_pt, 2) or ["Mission without a goal sentence"]
    small = footnotes(trace, world.attribution, room_pt)
    head = 27.0 + 27.0 * len(headline) + 25.0
    foot = 16.0 + 11.0 * max(len(small), 1) + 8.0
    sheet = Sheet(_HEIGHT_PT, Palette())
    map_width, map_height = room_pt - _PANEL_PT - _GAP_PT, _HEIGHT_PT - head - foot
    shape = map_height / map_width
    happened, _ = _extent(trace)
    shown = fitted_bounds(happened_in(trace), shapes=(shape, shape), least_m=LEAST_EXTENT_M)
    shown = moved_into(shown, world.bounds, kept=happened, rim_m=RIM_PT * shown.width_m / map_width)
    axes = sheet.map_axes(MARGIN_PT, foot, map_width, map_height, shown)
    board = Board(axes, shown, shown.width_m / map_width, sheet.palette.muted(_MUTED))
    paint_world(board, world)
    _paint_outside(board, world.bounds)
    stop_if_asked()
    room = Room(board)
    near = board.metres_per_point < 0.7
    classes = place_badges(board, world.objects, Room(board), share=0.86, alpha=0.62 if near else 0.45, dots=near)
    _write_scale(sheet, board, room, trace, (MARGIN_PT, foot))
    stop_if_asked()
    paint_mission(board, trace, room)
    stop_if_asked()
    letter_streets(board, world.ways, room, colour="#7b8088", limit=30)
    write_headline(sheet, headline, trace.subtitle)
    write_panel(
        sheet,
        trace,
        classes,
        left_pt=MARGIN_PT + map_width + _GAP_PT,
        top_pt=foot + map_height,
        bottom_pt=foot,
    )
    for place, (line, face) in enumerate(small):
        sheet.write(MARGIN_PT, foot - 14.0 - 11.0 * place, line, size_pt=8.0, face=face, colour=sheet.palette.soft_ink)
    return sheet


def happened_in(trace: MissionTrace) -> Bounds:
    """Return what a map of the mission must show: everything that happened and the goals close by, with a margin."""
    _, with_goals = _extent(trace)
    margin_m = max(15.0, 0.07 * max(with_goals.width_m, with_goals.height_m))
    return Bounds(
        with_goals.min_x_m - margin_m,
        with_goals.min_y_m - margin_m,
        with_goals.max_x_m + margin_m,
        with_goals.max_y_m + margin_m,
    )


def _extent(trace: MissionTrace) -> tuple[Bounds, Bounds]:
    """Return the bounds of everything that happened, and of that and the goals close by with their halos."""
    places = [(trace.start.x_m, trace.start.y_m), (trace.end.x_m, trace.end.y_m), *trace.path_points]
    places += [(frontier.x_m, frontier.y_m) for frontier in trace.frontiers]
    places += [point for edge in trace.edges for point in edge]
    lines = [np.array(places, dtype=np.float64), np.asarray(trace.track, dtype=np.float64).reshape(-1, 2)]
    if trace.shortest_way is not None:
        lines.append(trace.shortest_way)
    points = np.concatenate(lines)
    reach_m = trace.success_radius_m
    for goal in trace.goals:
        near = float(np.hypot(points[:, 0] - goal.x_m, points[:, 1] - goal.y_m).min()) <= 2.0 * reach_m + 10.0
        if goal.reached or near:
            lines.append(np.array([(goal.x_m - reach_m, goal.y_m - reach_m), (goal.x_m + reach_m, goal.y_m + reach_m)]))
    return _bounds_of(points), _bounds_of(np.concatenate(lines))


def _bounds_of(points: NDArray[np.float64]) -> Bounds:
    (west, south), (east, north) = points.min(axis=0), points.max(axis=0)
    return Bounds(float(west), float(south), float(east), float(north))


def moved_into(shown: Bounds, world: Bounds, *, kept: Bounds, rim_m: float) -> Bounds:
    """Return the bounds moved so that they show as little as can be of what lies outside the world.

    What happened stays clear of the frame, at the world's very edge too: there the map shows a strip of hatching.

    Args:
        shown: What a map shows; it holds what happened.
        world: The world's bounds.
        kept: What happened.
        rim_m: How clear of the frame, metres, as far as there is room for it.
    """
    shift_x = _shift(
        (shown.min_x_m, shown.max_x_m), (world.min_x_m, world.max_x_m), (kept.min_x_m, kept.max_x_m), rim_m
    )
    shift_y = _shift(
        (shown.min_y_m, shown.max_y_m), (world.min_y_m, world.max_y_m), (kept.min_y_m, kept.max_y_m), rim_m
    )
    return Bounds(shown.min_x_m + shift_x, shown.min_y_m + shift_y, shown.max_x_m + shift_x, shown.max_y_m + shift_y)


def _shift(shown: tuple[float, float], world: tuple[float, float], kept: tuple[float, float], rim_m: float) -> float:
    (low, high), (least, most) = shown, world
    if high - low > most - least:
        # Too little world to fill the map: it stands in the middle, as far as what happened lets it.
        shift = 0.5 * (least + most - low - high)
        return min(max(shift, min(kept[1] + rim_m - high, 0.0)), max(kept[0] - rim_m - low, 0.0))
    shift = max(least - low, 0.0) + min(most - high, 0.0)
    # It goes no farther than until what happened comes near to the frame.
    if shift > 0.0:
        return max(min(shift, kept[0] - rim_m - low), 0.0)
    return min(max(shift, kept[1] + rim_m - high), 0.0)


def _paint_outside(board: Board, world: Bounds) -> None:
    """Lay fine slanting lines over what lies beyond the edge of the world, where shadows and streets would reach."""
    shown = board.bounds
    if min(world.width_m, world.height_m) <= 0.0 or all(world.contains(x, y) for x, y in _corners(shown)):
        return
    hole = _corners(world)
    board.axes.add_collection(
        PathCollection(
            [compound_path([_corners(shown), hole[::-1]])],
            facecolors=board.palette.paper,
            edgecolors="none",
            zorder=6.4,
        ),
        autolim=False,
    )
    outside = polygon_of(_corners(shown)).difference(polygon_of(hole))
    # Lines x - y = c from edge to edge of the map, cut to what is outside.
    step_m = 5.0 * board.metres_per_point
    low, high = shown.min_x_m - shown.max_y_m, shown.max_x_m - shown.min_y_m
    offsets = np.arange(math.floor(low / step_m), math.ceil(high / step_m) + 1) * step_m
    ends = np.array([shown.min_y_m, shown.max_y_m])
    slants = shapely.linestrings(offsets[:, None] + ends, np.broadcast_to(ends, (len(offsets), 2)))
    hatch = lines_of(shapely.union_all(shapely.intersection(slants, outside)))
    rim = np.vstack([hole, hole[:1]])
    for lines, colour, width in ((hatch, OUTSIDE, 0.6), ([rim], board.palette.soft_ink, 0.7)):
        board.axes.add_collection(LineCollection(lines, colors=colour, linewidths=width, zorder=6.41), autolim=False)


def _corners(bounds: Bounds) -> NDArray[np.float64]:
    west, south, east, north = bounds.min_x_m, bounds.min_y_m, bounds.max_x_m, bounds.max_y_m
    return np.array([(west, south), (east, south), (east, north), (west, north)])


def _write_scale(
    sheet: Sheet, board: Board, room: Room, trace: MissionTrace, map_corner_pt: tuple[float, float]
) -> None:
    """Lay scale and north arrow into the corner of the map where least happened."""
    wide, high, inset = scale_bar_width_pt(board.metres_per_point, room_pt=112.0) + 70.0, 45.0, 6.0
    map_width, map_height = board.points(board.bounds.width_m), board.points(board.bounds.height_m)
    lefts, bottoms = (inset, map_width - wide - inset), (inset, map_height - high - inset)
    corner_m = np.array([board.bounds.min_x_m, board.bounds.min_y_m])
    marks = (np.vstack([places_of(trace), trace.track.reshape(-1, 2)]) - corner_m) / board.metres_per_point

    reach = np.array([wide + 24.0, high + 24.0])

    def crowd(corner: tuple[float, float]) -> int:
        low = np.array(corner) - 12.0
        return int(((marks > low) & (marks < low + reach)).all(axis=1).sum())

    # Of equally quiet corners the first: lower left, lower right, upper left, upper right.
    left, bottom = min(((x, y) for y in bottoms for x in lefts), key=crowd)
    columns, rows = np.meshgrid(np.arange(left, left + wide, 4.0), np.arange(bottom, bottom + high, 4.0))
    room.block(np.column_stack([columns.ravel(), rows.ravel()]) * board.metres_per_point + corner_m, 3.0)
    left, bottom = left + map_corner_pt[0], bottom + map_corner_pt[1]
    # Opaque: what shimmers through looks like a sign.
    card(sheet, left, bottom, wide, high, alpha=1.0)
    draw_north_arrow(sheet, left + 18.0, bottom + 18.0, size_pt=22.0)
    draw_scale_bar(sheet, left + 42.0, bottom + 11.0, board.metres_per_point, room_pt=112.0)
