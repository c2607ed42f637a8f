"""The map picture of a record."""

import math
from pathlib import Path

import numpy as np

from reasoned_explorer.evaluation.mission_map import MapFrontier, MapGoal, MissionTrace, draw_mission
from reasoned_explorer.exploration.penalty import distance_penalty
from reasoned_explorer.geometry import Pose
from reasoned_explorer.model.record import EpisodeRecord, FrontierRecord, MissionSummary
from reasoned_explorer.world.world import World


def draw_record(world: World, record: EpisodeRecord, path: Path) -> None:
    """Draw a record on the map of its world; the suffix of the path decides the format.

    Raises:
        RecordError: If the picture cannot be written there.
        PartError: If the disk fails, e.g. because it is full.
    """
    draw_mission(world, trace_of(record, world), path)


def trace_of(record: EpisodeRecord, world: World) -> MissionTrace:
    """Return what a record shows on a map of its world."""
    header, summary = record.header, record.summary
    start = Pose(*header.start)
    points, edges = _points_and_edges(record)
    track = [(start.x_m, start.y_m)]
    track += [(point.x_m, point.y_m) for step in record.steps for leg in step.legs for point in leg.track]
    end = _end_pose(record, start)
    return MissionTrace(
        title=header.goal,
        subtitle=f"{header.planner} · {header.captioner} · {header.vehicle} · {header.world}",
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
        notes=(f"{header.minds}; CT {header.ct_label}", f"judged by rule: R = {header.success_radius_m:g} m"),
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


def _facts(summary: MissionSummary) -> tuple[tuple[str, str], ...]:
    reference = "none" if summary.reference_length_m is None else f"{summary.reference_length_m:.0f} m"
    return (
        ("ended", summary.end.value),
        ("success", "yes" if summary.success else "no"),
        ("oracle success", "yes" if summary.oracle_success else "no"),
        ("SPL", f"{summary.spl:.2f}"),
        ("CASR", f"{summary.casr:.2f}"),
        ("path", f"{summary.path_length_m:.0f} m"),
        ("shortest", reference),
        ("CT", f"{summary.ct_s:.0f} s"),
        ("TT", f"{summary.tt_s:.0f} s"),
        ("steps", str(summary.steps)),
    )
