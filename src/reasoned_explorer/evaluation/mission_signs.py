"""Where the signs of a mission's map stand, so that they hide nothing of the way that was travelled."""

import math
from itertools import product

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.evaluation.mission_trace import MapGoal, MissionTrace
from reasoned_explorer.world.painting import Board

FloatArray = NDArray[np.float64]

#: Radii on the sheet, points, white rims included.
HALT_PT, START_PT, STEP_PT, TRACK_PT, FRONTIER_PT, GOAL_PT = 10.6, 9.3, 5.6, 3.8, 7.2, 10.0
#: What happened keeps so far from the frame of the map, points: as far as its largest mark reaches.
RIM_PT = 16.0
#: The pole of the halt: its lengths, points, and directions, degrees from north, the best first.
_POLES_PT = (25.0, 34.0, 45.0, 60.0, 80.0, 105.0, 135.0)
_DIRECTIONS_DEG = (0, 45, -45, 90, -90, 135, -135, 180, 22, -22, 67, -67, 112, -112, 157, -157)
#: How bad it is to hide one of these.
_START_COST, _STEP_COST, _TRACK_COST, _GOAL_COST, _FRONTIER_COST = 60.0, 40.0, 8.0, 4.0, 1.0


def halt_place(board: Board, trace: MissionTrace) -> tuple[float, float]:
    """Return where the sign of the halt stands, ENU metres: beside the end, where it hides least, on the map."""
    end = np.array([trace.end.x_m, trace.end.y_m])
    hidden = _hidden(board, trace)
    best, least = end, math.inf
    for length_pt, direction_deg in product(_POLES_PT, _DIRECTIONS_DEG):
        angle = math.radians(direction_deg)
        towards = np.array([math.sin(angle), math.cos(angle)])
        place = end + towards * length_pt * board.metres_per_point
        if not board.shows_point(*place, margin_m=-(HALT_PT + 2.0) * board.metres_per_point):
            continue
        pole = end + towards * np.arange(8.0, length_pt, 3.0)[:, None] * board.metres_per_point
        cost = 0.02 * length_pt + _cost(board, hidden, place[None, :], HALT_PT) + 0.3 * _cost(board, hidden, pole, 0.0)
        if cost < least:
            best, least = place, cost
    return float(best[0]), float(best[1])


def is_on_the_way(board: Board, trace: MissionTrace, goal: MapGoal) -> bool:
    """Return whether the mark of a goal would hide a decision, the start or a piece of the track."""
    place = np.array([[goal.x_m, goal.y_m]])
    way = [item for item in _hidden(board, trace) if item[2] >= _TRACK_COST]
    return _cost(board, way, place, GOAL_PT) > 0.0


def stands_on_a_step(board: Board, trace: MissionTrace) -> bool:
    """Return whether the mission ended where a decision is marked."""
    reach_m = STEP_PT * board.metres_per_point
    end = trace.end
    return any(math.dist((end.x_m, end.y_m), point) <= reach_m for point in trace.path_points)


def _hidden(board: Board, trace: MissionTrace) -> list[tuple[FloatArray, float, float]]:
    """Return what a sign could hide: places, radius on the sheet, and how bad that is."""
    end = np.array([trace.end.x_m, trace.end.y_m])
    steps = _array(trace.path_points)
    # What lies right under the end is pointed at, not hidden.
    steps = steps[np.hypot(*(steps - end).T) > STEP_PT * board.metres_per_point]
    return [
        (np.array([[trace.start.x_m, trace.start.y_m]]), START_PT, _START_COST),
        (steps, STEP_PT, _STEP_COST),
        (_dense(trace.track, 4.0 * board.metres_per_point), TRACK_PT, _TRACK_COST),
        (_array([(goal.x_m, goal.y_m) for goal in trace.goals]), GOAL_PT, _GOAL_COST),
        (_array([(item.x_m, item.y_m) for item in trace.frontiers]), FRONTIER_PT, _FRONTIER_COST),
    ]


def _array(points: object) -> FloatArray:
    return np.array(points, dtype=np.float64).reshape(-1, 2)


def _dense(line: FloatArray, step_m: float) -> FloatArray:
    """Return points on a line, at most so far apart."""
    line = np.asarray(line, dtype=np.float64).reshape(-1, 2)
    if len(line) < 2:
        return line
    at_m = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
    marks = np.linspace(0.0, at_m[-1], int(min(at_m[-1] / step_m, 4000)) + 2)
    return np.column_stack([np.interp(marks, at_m, line[:, axis]) for axis in (0, 1)])


def _cost(board: Board, hidden: list[tuple[FloatArray, float, float]], places: FloatArray, radius_pt: float) -> float:
    """Return how bad it is to cover discs around places."""
    total = 0.0
    for points, own_pt, each in hidden:
        reach_m = (radius_pt + own_pt) * board.metres_per_point
        apart = np.hypot(*(points[:, None, :] - places[None, :, :]).transpose(2, 0, 1))
        total += each * float((apart < reach_m).any(axis=1).sum())
    return total
