"""The map picture of a record."""

import math
from pathlib import Path

import numpy as np

from reasoned_explorer.evaluation.mission_map import MapFrontier, MapGoal, MissionTrace, draw_mission
from reasoned_explorer.exploration.penalty import distance_penalty
from reasoned_explorer.geometry import Pose
from reasoned_explorer.model.record import EpisodeRecord, FrontierRecord, MissionHeader, MissionSummary
from reasoned_explorer.world.world import Bounds, World

#: So far around what happened blank ground goes on, metres: further than a map shows.
_BLANK_M = 500.0


def draw_record(world: World | None, record: EpisodeRecord, path: Path) -> None:
    """Draw a record on the map of its world, on blank ground where none is known; the path's suffix says the format.

    Raises:
        RecordError: If the picture cannot be written there.
        PartError: If the disk fails, e.g. because it is full.
    """
    world = _blank(record) if world is None else world
    draw_mission(world, trace_of(record, world), path)


def _blank(record: EpisodeRecord) -> World:
    """Return a world of nothing but room for what happened."""
    places = [record.header.start[:2]]
    for step in record.steps:
        places += [(point.x_m, point.y_m) for leg in step.legs for point in leg.track]
        places += [(frontier.x_m, frontier.y_m) for frontier in step.frontiers]
    low, high = np.min(places, axis=0) - _BLANK_M, np.max(places, axis=0) + _BLANK_M
    bounds = Bounds(float(low[0]), float(low[1]), float(high[0]), float(high[1]))
    return World(record.header.world, bounds, (), (), (), ())


def trace_of(record: EpisodeRecord, world: World) -> MissionTrace:
    """Return what a record shows on a map of its world."""
    header, summary = record.header, record.summary
    start = Pose(*header.start)
    points, edges = _points_and_edges(record)
    track = [(start.x_m, start.y_m)]
    track += [(point.x_m, point.y_m) for step in record.steps for leg in step.legs for point in leg.track]
    end = _end_pose(record, start)
    place = header.world if header.is_judged else "no world known"
    return MissionTrace(
        title=header.goal,
        subtitle=f"{header.planner} · {header.captioner} · {header.vehicle} · {place}",
        track=np.array(track, dtype=np.float64),
        path_points=tuple(points),
        edges=tuple(edges),
        frontiers=tuple(_map_frontier(frontier, end) for frontier in _last_states(record)),
        goals=tuple(
            MapGoal(x_m, y_m, world.objects[index].outline, class_name.replace("_", " "), grade, reached=False)
            for index, class_name, x_m, y_m, grade in header.goal_objects
        ),
        success_radius_m=header.success_radius_m,
        start=start,
        end=end,
        shortest_way=np.array(header.reference_way) if header.reference_way else None,
        declared=bool(summary and summary.declared),
        success=summary.success if summary else None,
        facts=_facts(summary) if summary else (("incomplete", "cut off"),),
        notes=(f"{header.minds}; CT {header.ct_label}", _judge_in_words(header)),
    ).within(world.bounds)


def _points_and_edges(
    record: EpisodeRecord,
) -> tuple[list[tuple[float, float]], list[tuple[tuple[float, float], tuple[float, float]]]]:
    """Return the path points in the order of their steps, and the way between them."""
    points: list[tuple[float, float]] = []
    edges = []
    for step in record.steps:
        here = (step.pose[0], step.pose[1])
        if points and math.dist(points[-1], here) < 0.5:
            continue
        if points:
            edges.append((points[-1], here))
        points.append(here)
    return points, edges


def _last_states(record: EpisodeRecord) -> list[FrontierRecord]:
    last = {frontier.id: frontier for step in record.steps for frontier in step.frontiers}
    return [last[key] for key in sorted(last)]


def _map_frontier(frontier: FrontierRecord, end: Pose) -> MapFrontier:
    distance_m = math.hypot(frontier.x_m - end.x_m, frontier.y_m - end.y_m)
    penalty = distance_penalty(distance_m) if frontier.state == "open" else None
    return MapFrontier(frontier.x_m, frontier.y_m, frontier.heading_rad, frontier.q, penalty, frontier.state)


def _end_pose(record: EpisodeRecord, start: Pose) -> Pose:
    for step in reversed(record.steps):
        for leg in reversed(step.legs):
            if leg.track:
                last = leg.track[-1]
                return Pose(last.x_m, last.y_m, last.z_m, last.heading_rad)
    return start


def _judge_in_words(header: MissionHeader) -> str:
    if not header.is_judged:
        return "nobody judged: no world is known"
    return f"judged by rule: R = {header.success_radius_m:g} m"


def _facts(summary: MissionSummary) -> tuple[tuple[str, str], ...]:
    reference = "none" if summary.reference_length_m is None else f"{summary.reference_length_m:.0f} m"
    scores = tuple(
        (name, "not judged" if value is None else f"{value:.2f}")
        for name, value in (("SPL", summary.spl), ("CASR", summary.casr))
    )
    answers = {None: "not judged", True: "yes", False: "no"}
    return (
        ("ended", summary.end.value),
        ("success", answers[summary.success]),
        ("oracle success", answers[summary.oracle_success]),
        *scores,
        ("path", f"{summary.path_length_m:.0f} m"),
        ("shortest", "not known" if summary.success is None else reference),
        ("CT", f"{summary.ct_s:.0f} s"),
        ("TT", f"{summary.tt_s:.0f} s"),
        ("steps", str(summary.steps)),
    )
