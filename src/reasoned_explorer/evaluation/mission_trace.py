"""What the picture of a mission is made from, free of how missions are run and recorded."""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model.errors import Fault
from reasoned_explorer.world.world import Bounds

FloatArray = NDArray[np.float64]

#: What can become of a frontier.
FRONTIER_STATES = ("open", "visited", "given up", "blocked")


@dataclass(frozen=True, slots=True)
class MapFrontier:
    """A way on that was seen.

    Attributes:
        x_m: Where it is, ENU.
        y_m: Likewise.
        heading_rad: Compass heading in which it was seen.
        q: Its score, 1 to 5; None if it never had one.
        penalty: σ(d) when it was last weighed, 0 to 1; None if it never was.
        state: One of `FRONTIER_STATES`.
    """

    x_m: float
    y_m: float
    heading_rad: float
    q: float | None
    penalty: float | None
    state: str = "open"


@dataclass(frozen=True, slots=True, eq=False)
class MapGoal:
    """A thing that satisfies the goal.

    Attributes:
        x_m: Where it is, ENU.
        y_m: Likewise.
        outline: Its ring, shape (n, 2), for things that are areas; else None.
        label: What it is, or its name.
        grade: 2 for what the goal asks for, 1 for what would do at a pinch.
        reached: Whether the mission ended at it.
    """

    x_m: float
    y_m: float
    outline: FloatArray | None
    label: str
    grade: int
    reached: bool


@dataclass(frozen=True, slots=True, eq=False)
class MissionTrace:
    """All that the picture of a mission shows.

    Attributes:
        title: The goal sentence.
        subtitle: Planner, minds, vehicle, outcome.
        track: Where the vehicle went, shape (n, 2), ENU metres, oldest first; may be empty.
        path_points: Where decisions were made, oldest first.
        edges: Of the topological graph, as pairs of points.
        frontiers: Every way on that was seen.
        goals: Everything that satisfies the goal.
        success_radius_m: R.
        start: Where and which way it began.
        end: Where and which way it ended.
        shortest_way: Shortest compliant way to the edge of the success region, shape (n, 2); None if there is none.
        declared: Whether the agent said that it had found the goal.
        success: Whether that was true; None if nobody judged it.
        facts: Names and values for the side panel.
        notes: Honest footnotes, e.g. ``"embedded minds, no language model"``.
        left_out: How many ways on are not among the frontiers, since they lie outside the world.
    """

    title: str
    subtitle: str
    track: FloatArray
    path_points: tuple[tuple[float, float], ...]
    edges: tuple[tuple[tuple[float, float], tuple[float, float]], ...]
    frontiers: tuple[MapFrontier, ...]
    goals: tuple[MapGoal, ...]
    success_radius_m: float
    start: Pose
    end: Pose
    shortest_way: FloatArray | None = None
    declared: bool = False
    success: bool | None = None
    facts: tuple[tuple[str, str], ...] = ()
    notes: tuple[str, ...] = ()
    left_out: int = 0

    def within(self, bounds: Bounds) -> "MissionTrace":
        """Return the trace without the ways on that lie outside of a world's bounds, where a map shows nothing."""
        inside = tuple(each for each in self.frontiers if bounds.contains(each.x_m, each.y_m))
        return replace(self, frontiers=inside, left_out=self.left_out + len(self.frontiers) - len(inside))

    def faults(self) -> list[Fault]:
        """Return everything that makes it impossible to draw."""
        found: list[Fault] = []
        lines = {"track": (self.track, 0), "shortest_way": (self.shortest_way, 1)}
        lines.update({f"goals[{i}].outline": (goal.outline, 3) for i, goal in enumerate(self.goals)})
        for name, (line, least) in lines.items():
            if line is not None and not _is_line(line, least):
                shape = getattr(line, "shape", type(line).__name__)
                found.append(Fault(f"{name} of shape {shape}", f"finite metres of shape (n, 2), n at least {least}"))
        places = {
            "start": (self.start.x_m, self.start.y_m, self.start.heading_rad),
            "end": (self.end.x_m, self.end.y_m, self.end.heading_rad),
            "success_radius_m": (self.success_radius_m,),
        }
        places.update({f"path_points[{i}]": tuple(point) for i, point in enumerate(self.path_points)})
        places.update({f"edges[{i}]": (*edge[0], *edge[1]) for i, edge in enumerate(self.edges)})
        places.update({f"goals[{i}]": (goal.x_m, goal.y_m) for i, goal in enumerate(self.goals)})
        for i, frontier in enumerate(self.frontiers):
            scores = [value for value in (frontier.q, frontier.penalty) if value is not None]
            places[f"frontiers[{i}]"] = (frontier.x_m, frontier.y_m, frontier.heading_rad, *scores)
            if frontier.state not in FRONTIER_STATES:
                found.append(Fault(f"frontiers[{i}].state {frontier.state!r}", f"one of {', '.join(FRONTIER_STATES)}"))
        for name, values in places.items():
            if not all(math.isfinite(value) for value in values):
                found.append(Fault(f"{name} {values}", "finite numbers"))
        if self.success_radius_m < 0.0:
            found.append(Fault(f"success_radius_m {self.success_radius_m:g}", "0 m or more"))
        return found


def _is_line(line: object, least: int) -> bool:
    array = np.asarray(line, dtype=np.float64) if isinstance(line, np.ndarray) else np.empty(0)
    if least == 0 and array.size == 0 and isinstance(line, np.ndarray):
        return True
    return array.ndim == 2 and array.shape[1] == 2 and len(array) >= least and bool(np.isfinite(array).all())
