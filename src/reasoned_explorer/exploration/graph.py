"""The topological graph: path points, the edges between them, and the buffer of frontiers (paper, section IV-A)."""

import heapq
import math
from dataclasses import dataclass, field
from enum import StrEnum

from reasoned_explorer.exploration.penalty import distance_penalty
from reasoned_explorer.geometry import Pose

#: σ(d0): what a frontier costs at least where the robot has already passed close by.
_KNOWN_PENALTY = 0.5


class FrontierState(StrEnum):
    """What has become of a frontier."""

    OPEN = "open"
    VISITED = "visited"
    GIVEN_UP = "given up"
    BLOCKED = "blocked"


@dataclass(slots=True)
class Frontier:
    """A place one step beyond a path point that was scored and can be gone to.

    Attributes:
        id: Rising in the order of discovery.
        parent: The path point that it was seen from.
        pose: Where it is, facing away from its parent.
        q: Its score, or None where no answer could be had (such a frontier is gone to last).
        forbidden: Its ground is shunned by the goal; gone to only when nothing else is left.
        known: The robot has passed close by, on another way than through its parent.
        state: What has become of it.
        reason: Why it was given up or is blocked.
    """

    id: int
    parent: int
    pose: Pose
    q: float | None
    forbidden: bool = False
    known: bool = False
    state: FrontierState = FrontierState.OPEN
    reason: str = ""


@dataclass(frozen=True, slots=True)
class Choice:
    """The frontier with the highest Q − σ(d).

    Attributes:
        frontier: The frontier.
        distance_m: d, along the way to it, metres.
        penalty: σ(d), and at least one half where the robot has passed close by.
        value: Q − σ(d), rounded to 1e-4; None where Q is missing.
    """

    frontier: Frontier
    distance_m: float
    penalty: float
    value: float | None


@dataclass(slots=True)
class TopologicalGraph:
    """Where the robot has been, and where it could go.

    Attributes:
        merge_radius_m: A path point this near to an older one is that one.
        sharpness_per_m: k of σ(d).
        half_distance_m: d0 of σ(d).
        known_radius_m: What lies this near to a leg has been passed close by, and costs at least one half; 0 for never.
        straight: Whether d is the straight distance instead of the length of the way along known edges.
    """

    merge_radius_m: float = 1.5
    sharpness_per_m: float = 0.5
    half_distance_m: float = 60.0
    known_radius_m: float = 0.0
    straight: bool = False
    points: list[Pose] = field(default_factory=list)
    edges: dict[int, dict[int, float]] = field(default_factory=dict)
    frontiers: list[Frontier] = field(default_factory=list)
    _open: dict[int, Frontier] = field(default_factory=dict)

    def add_point(self, pose: Pose, *, previous: int | None = None) -> int:
        """Return the path point at a pose, made or (within the merge radius) found, joined to the previous one."""
        index = self.nearest_point(pose.x_m, pose.y_m, self.merge_radius_m)
        if index is None:
            index = len(self.points)
            self.points.append(pose)
            self.edges[index] = {}
        if previous is not None and previous != index:
            length_m = self.points[previous].distance_to_m(self.points[index].x_m, self.points[index].y_m)
            if index not in self.edges[previous]:
                self._pass_by(previous, index)
            self.edges[previous][index] = self.edges[index][previous] = length_m
        return index

    def nearest_point(self, x_m: float, y_m: float, radius_m: float) -> int | None:
        """Return the path point nearest to a place and no farther than a radius, or None."""
        best, best_m = None, radius_m
        for index, point in enumerate(self.points):
            distance_m = math.hypot(point.x_m - x_m, point.y_m - y_m)
            if distance_m <= best_m and (best is None or distance_m < best_m):
                best, best_m = index, distance_m
        return best

    def add_frontier(
        self, parent: int, pose: Pose, q: float | None, *, forbidden: bool = False, blocked_by: str = ""
    ) -> Frontier:
        """Put a frontier into the buffer; with ``blocked_by`` it is only remembered as blocked."""
        frontier = Frontier(len(self.frontiers), parent, pose, q, forbidden)
        self.frontiers.append(frontier)
        if blocked_by:
            frontier.state, frontier.reason = FrontierState.BLOCKED, blocked_by
        else:
            self._open[frontier.id] = frontier
            frontier.known = self.known_radius_m > 0.0 and any(
                self._lies_by(frontier, one, other)
                for one, others in self.edges.items()
                for other in others
                if one < other
            )
        return frontier

    def _pass_by(self, one: int, other: int) -> None:
        """Note which open frontiers a new leg passes."""
        for frontier in self._open.values() if self.known_radius_m > 0.0 else ():
            frontier.known = frontier.known or self._lies_by(frontier, one, other)

    def _lies_by(self, frontier: Frontier, one: int, other: int) -> bool:
        """Return whether a frontier lies by the leg between two path points; legs from its parent do not count."""
        if frontier.parent in {one, other}:
            return False
        at, start, end = frontier.pose, self.points[one], self.points[other]
        return _off_leg_m(at.x_m, at.y_m, start, end) < self.known_radius_m

    def open_frontiers(self) -> list[Frontier]:
        """Return what is in the buffer, oldest first."""
        return list(self._open.values())

    def choose(self, start: int) -> Choice | None:
        """Return the best open frontier as seen from a path point, or None where the buffer is empty.

        argmax of Q − σ(d) (paper, section IV-A), rounded to 1e-4; ties go to the nearer, then the older frontier. d is
        how far the robot has to travel: the authors fly straight, this agent goes along known edges, and a frontier
        that is 10 m away behind a wall may be 200 m away on the way that it knows. With a known radius, what the robot
        has passed close by costs no less than a frontier at the half distance d0 (O). Frontiers on shunned ground come
        after all others, frontiers without a score after those with one.

        Args:
            start: The path point that the robot is at.
        """
        return min(self.choices(start), key=_rank, default=None)

    def choices(self, start: int) -> list[Choice]:
        """Return what each open frontier is worth as seen from a path point, oldest first; see `choose`."""
        length_m = {} if self.straight else self._search(start, None)[1]
        choices = []
        for frontier in self._open.values():
            distance_m = self._distance_m(start, frontier, length_m)
            penalty = distance_penalty(
                distance_m, sharpness_per_m=self.sharpness_per_m, half_distance_m=self.half_distance_m
            )
            if frontier.known:
                penalty = max(penalty, _KNOWN_PENALTY)
            value = None if frontier.q is None else round(frontier.q - penalty, 4)
            choices.append(Choice(frontier, distance_m, penalty, value))
        return choices

    def _distance_m(self, start: int, frontier: Frontier, length_m: dict[int, float]) -> float:
        """Return d, given how far it is along known edges to each path point."""
        if frontier.parent not in length_m:  # asked for straight, or joined by no edge
            return self.points[start].distance_to_m(frontier.pose.x_m, frontier.pose.y_m)
        parent = self.points[frontier.parent]
        return length_m[frontier.parent] + parent.distance_to_m(frontier.pose.x_m, frontier.pose.y_m)

    def take(self, frontier: Frontier) -> None:
        """Take a chosen frontier out of the buffer: it becomes a path point when it is reached."""
        self._open.pop(frontier.id, None)
        frontier.state = FrontierState.VISITED

    def give_up(self, frontier: Frontier, reason: str) -> None:
        """Take a frontier out of the buffer for good."""
        self._open.pop(frontier.id, None)
        frontier.state, frontier.reason = FrontierState.GIVEN_UP, reason

    def route(self, start: int, frontier: Frontier) -> list[Pose]:
        """Return the waypoints from a path point to a frontier along known edges, the start left out.

        Between path points that are not joined (which does not happen on one machine's way) the route is straight.
        """
        return [*self.way(start, frontier.parent), frontier.pose]

    def way(self, start: int, goal: int) -> list[Pose]:
        """Return the path points on the shortest known way to another one, the start left out."""
        came_from, _ = self._search(start, goal)
        way = [goal]
        while way[-1] in came_from:
            way.append(came_from[way[-1]])
        return [self.points[index] for index in way[::-1] if index != start]

    def by_distance(self, start: int) -> list[int]:
        """Return all path points that can be reached along known edges, nearest first, the start itself included."""
        _, length_m = self._search(start, None)
        return sorted(length_m, key=lambda point: (round(length_m[point], 3), point))

    def _search(self, start: int, goal: int | None) -> tuple[dict[int, int], dict[int, float]]:
        """Dijkstra's search: return where each path point is come to from, and how far it is, metres."""
        queue = [(0.0, start)]
        length_m = {start: 0.0}
        came_from: dict[int, int] = {}
        while queue:
            so_far_m, point = heapq.heappop(queue)
            if point == goal:
                break
            if so_far_m > length_m[point]:
                continue
            for other, edge_m in self.edges[point].items():
                longer_m = so_far_m + edge_m
                if longer_m < length_m.get(other, math.inf):
                    length_m[other], came_from[other] = longer_m, point
                    heapq.heappush(queue, (longer_m, other))
        return came_from, length_m


def _rank(choice: Choice) -> tuple[bool, bool, float, float, int]:
    """Return what choices are sorted by, the best first."""
    frontier, value = choice.frontier, choice.value
    # Distances are compared to the millimetre: what lies equally far must not be told apart by rounding.
    return frontier.forbidden, value is None, -(value or 0.0), round(choice.distance_m, 3), frontier.id


def _off_leg_m(x_m: float, y_m: float, start: Pose, end: Pose) -> float:
    """Return the distance of a place from the straight leg between two poses, metres."""
    east_m, north_m = end.x_m - start.x_m, end.y_m - start.y_m
    squared = east_m * east_m + north_m * north_m
    share = ((x_m - start.x_m) * east_m + (y_m - start.y_m) * north_m) / squared if squared > 0.0 else 0.0
    share = min(1.0, max(0.0, share))
    return math.hypot(x_m - start.x_m - share * east_m, y_m - start.y_m - share * north_m)
