"""Whether a track keeps to the ground that a level-3 goal asks for.

The rule: forbidden ground within 2 m of other ground is tolerated (to the metre: the cells are those of the shortest
ways, so that the shortest compliant way complies). What goes deeper counts with the border that it
crosses on its way in and out (2 m each, less where there is less); more than 5 m in one such stretch is a violation.
So walking along the edge never counts, a corner cut by a step does not, crossing a road of more than 5 m does. Unknown
ground is never forbidden, and neither is what lies beyond the world.

A mission that starts on forbidden ground may leave it: of its first stretch as many metres are excused as twice the
straight distance to the nearest other ground, and 2 m.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reasoned_explorer.world.freespace import SHUNNED_TOLERANCE_M
from reasoned_explorer.world.taxonomy import Ground

#: More than this in one stretch is a violation, metres.
STRETCH_M = 5.0
_STEP_M = 0.25
_SEARCH_M = 200.0

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]


class GroundCodes(Protocol):
    """What is asked about ground; a `GroundRaster` answers it."""

    def at_many(self, xs_m: ArrayLike, ys_m: ArrayLike) -> NDArray[np.uint8]:
        """Return the codes of the ground at points."""


@dataclass(frozen=True, slots=True)
class ComplianceReport:
    """Whether a track complied.

    Attributes:
        compliant: No stretch is a violation.
        longest_stretch_m: The longest that counts, metres; 0 where none does.
        forbidden_m: Metres on forbidden ground in all, tolerated ones included.
        violation_at_m: Metres along the track at which the first violation became one, or infinity.
    """

    compliant: bool
    longest_stretch_m: float = 0.0
    forbidden_m: float = 0.0
    violation_at_m: float = math.inf


def compliance_of(
    points: Sequence[tuple[float, float]],
    ground: GroundCodes,
    forbidden: frozenset[Ground],
    *,
    tolerated: Callable[[Floats, Floats], Flags],
    excuse_start: bool = True,
) -> ComplianceReport:
    """Return whether a track complied.

    Args:
        points: ENU metres, oldest first; straight in between.
        ground: Of the world.
        forbidden: Ground to keep off (`GoalSpec.forbidden`).
        tolerated: Says of points, east and north, whether they are that near to ground that is not forbidden.
        excuse_start: Whether the way off forbidden ground that the track starts on is excused; False for a part of a
            track.
    """
    if not forbidden or not points:
        return ComplianceReport(compliant=True)
    places, along = _resampled(np.asarray(points, dtype=np.float64))
    codes = np.zeros(256, dtype=np.bool_)
    codes[[int(item) for item in forbidden]] = True
    on = codes[ground.at_many(places[:, 0], places[:, 1])]
    if not on.any():
        return ComplianceReport(compliant=True)
    deep = on.copy()
    deep[on] = ~tolerated(places[on, 0], places[on, 1])
    steps = np.diff(along, prepend=along[0])
    excused_m = 2.0 * _way_off_m(places[0], ground, codes) + SHUNNED_TOLERANCE_M if on[0] and excuse_start else 0.0
    longest_m, violation_at_m = 0.0, math.inf
    for first, last in _runs(on):
        for start_m, end_m in _counted(along, deep, first, last):
            length_m = end_m - start_m - (excused_m if first == 0 else 0.0)
            longest_m = max(longest_m, length_m)
            if length_m > STRETCH_M:
                violation_at_m = min(violation_at_m, end_m - length_m + STRETCH_M)
    forbidden_m = float(steps[on].sum())
    return ComplianceReport(math.isinf(violation_at_m), float(longest_m), forbidden_m, float(violation_at_m))


def _resampled(points: Floats) -> tuple[Floats, Floats]:
    """Return places at most 0.25 m apart along a track, and how far along it they lie."""
    lengths = np.hypot(*np.diff(points, axis=0).T) if len(points) > 1 else np.empty(0)
    at = np.concatenate(([0.0], np.cumsum(lengths)))
    ticks = np.unique(np.concatenate((at, np.arange(0.0, at[-1], _STEP_M))))
    return np.stack((np.interp(ticks, at, points[:, 0]), np.interp(ticks, at, points[:, 1])), axis=1), ticks


def _runs(flags: Flags) -> list[tuple[int, int]]:
    """Return first and last place of every run of flags."""
    padded = np.concatenate(([False], flags, [False]))
    changes = np.flatnonzero(padded[1:] != padded[:-1])
    return [(int(a), int(b) - 1) for a, b in zip(changes[::2], changes[1::2], strict=True)]


def _counted(along: Floats, deep: Flags, first: int, last: int) -> list[tuple[float, float]]:
    """Return the stretches of one run that count: deep parts with their borders, joined where these meet."""
    found: list[tuple[float, float]] = []
    for a, b in _runs(deep[first : last + 1]):
        # A sample stands for half a step to either side of it.
        start_m = max(float(along[first]), float(along[first + a]) - SHUNNED_TOLERANCE_M) - _STEP_M / 2.0
        end_m = min(float(along[last]), float(along[first + b]) + SHUNNED_TOLERANCE_M) + _STEP_M / 2.0
        start_m, end_m = max(0.0, start_m), min(float(along[-1]), end_m)
        if found and start_m <= found[-1][1]:
            start_m = found.pop()[0]
        found.append((start_m, end_m))
    return found


def _way_off_m(place: Floats, ground: GroundCodes, codes: Flags) -> float:
    """Return the straight distance from a place to the nearest ground that is not forbidden, at most 200 m."""
    angles = np.linspace(0.0, 2.0 * math.pi, 64, endpoint=False)
    for radius_m in np.arange(0.5, _SEARCH_M, 0.5):
        around = ground.at_many(place[0] + radius_m * np.sin(angles), place[1] + radius_m * np.cos(angles))
        if not codes[around].all():
            return float(radius_m)
    return _SEARCH_M
