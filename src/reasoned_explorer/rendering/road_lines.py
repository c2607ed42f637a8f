"""Stretches along many lines at once, and where on roads nothing is painted: junctions and crossings."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from reasoned_explorer.rendering.crossings import Crossings
from reasoned_explorer.world.world import Way

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

#: Ends of lines this near a place meet there, metres.
_MEETING_M = 0.15


class Lines:
    """Lines by the distance along them.

    Args:
        lines: Each of shape (n, 2), n ≥ 2, metres.
    """

    def __init__(self, lines: Sequence[Floats]) -> None:
        steps = [np.hypot(*np.diff(line, axis=0).T) for line in lines]
        self.lengths: Floats = np.array([float(step.sum()) for step in steps])
        # All lines one after the other on one measuring tape, with a gap between any two.
        self._starts: Floats = np.cumsum(self.lengths + 1.0) - (self.lengths + 1.0)
        marks = [
            start + np.concatenate([[0.0], np.cumsum(step)]) for start, step in zip(self._starts, steps, strict=True)
        ]
        self._marks: Floats = np.concatenate([np.empty(0), *marks])
        self._points: Floats = np.concatenate([np.empty((0, 2)), *lines])

    def at(self, which: Ints, distances: Floats) -> Floats:
        """Return points on lines, shape (n, 2); distances beyond an end give that end."""
        if not len(which):
            return np.empty((0, 2))
        mark = self._starts[which] + np.clip(distances, 0.0, self.lengths[which])
        return np.column_stack([np.interp(mark, self._marks, self._points[:, axis]) for axis in (0, 1)])

    def stretches(self, chosen: Ints, *, every_m: float, long_m: float) -> tuple[Ints, Floats, Floats]:
        """Return stretches of one length at even spacing along some lines.

        Returns:
            The line of each stretch, shape (n,); its begin and its end, shape (n, 2).
        """
        count = np.floor((self.lengths[chosen] - long_m) / every_m + 1.0).clip(min=0.0).astype(np.int64)
        which = np.repeat(chosen, count)
        place = np.arange(len(which)) - np.repeat(np.cumsum(count) - count, count)
        slack = (self.lengths[chosen] - long_m - (count - 1) * every_m) / 2.0
        begin = np.repeat(slack, count) + place * every_m
        return which, self.at(which, begin), self.at(which, begin + long_m)


@dataclass(frozen=True, slots=True, eq=False)
class Clearings:
    """Discs on which nothing is painted.

    Attributes:
        middles: Shape (n, 2), metres.
        radii: Shape (n,), metres.
    """

    middles: Floats
    radii: Floats

    def clear_of(self, points: Floats, reach_m: float) -> Bools:
        """Return which points are farther than ``reach_m`` from all discs, shape (n,)."""
        good = np.ones(len(points), np.bool_)
        if len(points) and len(self.middles):
            tree = shapely.STRtree(shapely.points(self.middles))
            found = shapely.points(points)
            at, disc = tree.query(found, predicate="dwithin", distance=float(self.radii.max()) + reach_m)
            gap = np.hypot(*(points[at] - self.middles[disc]).T)
            good[at[gap < self.radii[disc] + reach_m]] = False
        return good


def clearings_of(roads: Sequence[Way], crossings: Crossings) -> Clearings:
    """Return where roads meet (three ways lead away, or more) and where they are crossed."""
    middles, radii = _junctions(roads)
    return Clearings(
        np.concatenate([middles, crossings.middles]), np.concatenate([radii, crossings.walk_m / 2.0 + 0.8])
    )


def _junctions(roads: Sequence[Way]) -> tuple[Floats, Floats]:
    if len(roads) < 2:
        return np.empty((0, 2)), np.empty(0)
    lines = np.array([shapely.LineString(road.line) for road in roads], dtype=object)
    first, second = shapely.STRtree(lines).query(lines, predicate="dwithin", distance=_MEETING_M)
    pairs = first < second
    first, second = first[pairs], second[pairs]
    meeting = shapely.intersection(lines[first], lines[second])
    touching = shapely.get_point(shapely.shortest_line(lines[first], lines[second]), 0)
    meeting = np.where(shapely.is_empty(meeting), touching, meeting)
    points = np.unique(np.round(shapely.get_coordinates(meeting), 2), axis=0)
    places = shapely.points(points)
    at, road = shapely.STRtree(lines).query(places, predicate="dwithin", distance=_MEETING_M)
    ends = np.array([(road.line[0], road.line[-1]) for road in roads])
    gaps = np.hypot(*np.moveaxis(ends[road] - points[at][:, None, :], -1, 0))
    arms = np.where((gaps < _MEETING_M).any(axis=1), 1, 2)
    degree = np.bincount(at, weights=arms, minlength=len(points))
    widths = np.array([road.width_m for road in roads])
    widest = np.zeros(len(points))
    np.maximum.at(widest, at, widths[road])
    real = degree > 2
    return points[real], widest[real] / 2.0 + 0.5
