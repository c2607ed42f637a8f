"""Questions about the ways that people take: which point of one is nearest."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from reasoned_explorer.geometry import heading_towards_rad
from reasoned_explorer.world.taxonomy import Ground
from reasoned_explorer.world.world import Way

_FOOT = frozenset({Ground.PAVEMENT, Ground.PLAZA, Ground.PATH, Ground.CYCLEWAY, Ground.STEPS})
_REACH_M = 60.0
# A footway is what things face even where a road is somewhat nearer.
_FOOT_ADVANTAGE = 1.5
_ON_THE_LINE_M = 0.5


@dataclass(frozen=True, slots=True)
class RoadAt:
    """A road at a point of it: the heading in which it is drawn, and its width."""

    heading_rad: float
    width_m: float


class PathIndex:
    """The ways on the ground, for questions.

    Args:
        ways: Of a world; those not on the ground are left out.
    """

    def __init__(self, ways: Sequence[Way]) -> None:
        level = [way for way in ways if way.level == 0]
        self._roads = [way for way in level if way.ground == Ground.ROAD and way.kind not in {"footway", "path"}]
        self._road_lines, self._road_tree = _tree_of(self._roads)
        self._foot_lines, self._foot_tree = _tree_of([way for way in level if way.ground in _FOOT])

    def nearest_points(self, places: Sequence[tuple[float, float]]) -> list[tuple[float, float] | None]:
        """Return for each place the nearest point of a footway, or of a road that is much nearer; None if none is."""
        if not places:
            return []
        points = shapely.points(np.asarray(places, dtype=np.float64))
        foot_m, foot = _nearest(points, self._foot_lines, self._foot_tree)
        road_m, road = _nearest(points, self._road_lines, self._road_tree)
        takes_road = road_m * _FOOT_ADVANTAGE < foot_m
        gap_m = np.where(takes_road, road_m, foot_m)
        best = np.where(takes_road[:, None], road, foot)
        return [
            (float(point[0]), float(point[1])) if np.isfinite(gap) else None
            for gap, point in zip(gap_m, best, strict=True)
        ]

    def roads_at(self, places: Sequence[tuple[float, float]]) -> list[RoadAt | None]:
        """Return for each place the road on whose centre line it lies, or None."""
        if not places or not self._roads:
            return [None] * len(places)
        points = shapely.points(np.asarray(places, dtype=np.float64))
        found: list[RoadAt | None] = [None] * len(places)
        point_at, road_at = self._road_tree.query_nearest(points, max_distance=_ON_THE_LINE_M)
        # Of several roads that meet here, the widest.
        for at, road in sorted(
            zip(point_at.tolist(), road_at.tolist(), strict=True), key=lambda pair: (self._roads[pair[1]].width_m, pair)
        ):
            line = self._road_lines[road]
            along = line.project(points[at])
            back, front = line.interpolate(max(along - 1.0, 0.0)), line.interpolate(min(along + 1.0, line.length))
            found[at] = RoadAt(heading_towards_rad(back.x, back.y, front.x, front.y), self._roads[road].width_m)
        return found


def _tree_of(ways: Sequence[Way]) -> tuple[Any, Any]:
    lines = np.empty(len(ways), dtype=object)
    lines[:] = [shapely.LineString(way.line) for way in ways]
    return lines, shapely.STRtree(lines)


def _nearest(points: Any, lines: Any, tree: Any) -> tuple[Any, Any]:
    """Return distances (infinite where nothing is within reach) and points, shape (n, 2), on the nearest lines."""
    gap_m = np.full(len(points), np.inf)
    best = np.zeros((len(points), 2))
    if len(lines):
        chosen = np.full(len(points), len(lines), dtype=np.intp)
        at, line = tree.query_nearest(points, max_distance=_REACH_M)
        np.minimum.at(chosen, at, line)
        found = np.flatnonzero(chosen < len(lines))
        near = lines[chosen[found]]
        on_line = shapely.line_interpolate_point(near, shapely.line_locate_point(near, points[found]))
        gap_m[found] = shapely.distance(points[found], on_line)
        best[found] = shapely.get_coordinates(on_line)
    return gap_m, best
