"""What each frontier was worth when a step chose one: worked out again from a record.

A record says what was chosen and what that was worth. Why the others were left is not in it, but follows from it: the
same topological graph is made again from the poses and frontiers that the record holds. Where the two do not agree (a
record of another version, a vehicle whose estimate strayed on the way) nothing is said instead of something wrong.
"""

import math
from contextlib import suppress
from dataclasses import fields

from reasoned_explorer.exploration.graph import FrontierState, TopologicalGraph
from reasoned_explorer.exploration.penalty import distance_penalty
from reasoned_explorer.exploration.settings import ExplorerSettings
from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import InputError, LegOutcome
from reasoned_explorer.model.record import EpisodeRecord, FrontierRecord, MissionHeader, StepRecord

#: Points of the curve of σ.
_SAMPLES = 100
#: Recorded poses are rounded; a distance that is worked out again may differ from the recorded one by this, metres.
_AGREES_M = 0.25
#: A leg that came less far than this ended where it began, as the explorer holds it, metres.
_NOWHERE_M = 1.0

#: Frontier, Q, d in metres, σ, and what it was worth.
Worth = tuple[int, float | None, float | None, float | None, float | None]


def explorer_settings(header: MissionHeader) -> ExplorerSettings:
    """Return how a mission's agent explored; defaults where its header does not say."""
    given = header.settings.get("explorer")
    known = {item.name for item in fields(ExplorerSettings)}
    with suppress(InputError, TypeError, AttributeError):
        return ExplorerSettings(**{name: value for name, value in (given or {}).items() if name in known})
    return ExplorerSettings()


def penalty_curve(settings: ExplorerSettings) -> list[tuple[float, float]]:
    """Return the distance penalty σ(d) of a mission: d in metres from 0 to twice d0 (at least 100 m), and σ."""
    reach_m = min(max(100.0, 2.0 * settings.half_distance_m), 10_000.0)
    distances_m = [reach_m * place / (_SAMPLES - 1) for place in range(_SAMPLES)]
    return [
        (
            round(distance_m, 2),
            round(
                distance_penalty(
                    distance_m,
                    sharpness_per_m=settings.sharpness_per_m,
                    half_distance_m=settings.half_distance_m,
                ),
                4,
            ),
        )
        for distance_m in distances_m
    ]


def worths_of(record: EpisodeRecord) -> list[list[Worth]]:
    """Return for each step what its frontiers were worth when it chose one of them, that one included, oldest first.

    Where the step chose nothing, it is what the frontiers that are open at its end are worth from where it began. Parts
    that are not known are None.
    """
    memory = _Memory(explorer_settings(record.header))
    worths = []
    for place, step in enumerate(record.steps):
        after = record.steps[place + 1] if place + 1 < len(record.steps) else None
        worths.append(memory.live_through(step, after))
    return worths


class _Memory:
    """The agent's graph, made again step by step."""

    def __init__(self, settings: ExplorerSettings) -> None:
        self._graph = TopologicalGraph(
            settings.merge_radius_m,
            settings.sharpness_per_m,
            settings.half_distance_m,
            settings.known_radius_m,
            settings.straight_distance or settings.straight_legs,
        )
        #: Frontiers by the record's numbers; those of the graph made again are the same while all goes well.
        self._open: dict[int, FrontierRecord] = {}
        self._is_sound = True

    def live_through(self, step: StepRecord, after: StepRecord | None) -> list[Worth]:
        if not self._graph.points:
            self._graph.add_point(_pose(step))
        chosen = step.choice.frontier if step.choice is not None else None
        self._notice(step, chosen)
        worths = self._worths(step)
        if step.choice is not None:
            told = next((worth for worth in worths if worth[0] == chosen), None)
            if told is None or told[2] is None or abs(told[2] - step.choice.distance_m) > _AGREES_M:
                self._is_sound = False
                worths = self._unsound()
            # What the record says of the chosen one holds in any case.
            choice = step.choice
            said: Worth = (choice.frontier, choice.q, choice.distance_m, choice.penalty, choice.value)
            worths = [said if worth[0] == chosen else worth for worth in worths]
            self._open.pop(choice.frontier, None)
            if self._is_sound:
                self._graph.take(self._graph.frontiers[choice.frontier])
        self._travel(step, after)
        return worths

    def _notice(self, step: StepRecord, chosen: int | None) -> None:
        """Take in the frontiers that a step made or changed, as they were before it set out."""
        for each in step.frontiers:
            was_open = each.state == FrontierState.OPEN.value or each.id == chosen
            if was_open:
                self._open[each.id] = each
            else:
                self._open.pop(each.id, None)
            if not self._is_sound or each.id < len(self._graph.frontiers):
                continue
            if each.id > len(self._graph.frontiers) or each.parent >= len(self._graph.points):
                self._is_sound = False
                continue
            made = self._graph.add_frontier(
                each.parent, Pose(each.x_m, each.y_m, 0.0, each.heading_rad), each.q, forbidden=each.forbidden
            )
            if not was_open:
                self._graph.give_up(made, each.reason)

    def _worths(self, step: StepRecord) -> list[Worth]:
        if not self._is_sound or step.point >= len(self._graph.points):
            self._is_sound = False
            return self._unsound()
        return [
            (
                choice.frontier.id,
                choice.frontier.q,
                round(choice.distance_m, 2),
                round(choice.penalty, 4),
                choice.value,
            )
            for choice in self._graph.choices(step.point)
        ]

    def _unsound(self) -> list[Worth]:
        return [(each.id, each.q, None, None, None) for each in self._open.values()]

    def _travel(self, step: StepRecord, after: StepRecord | None) -> None:
        """Join the path points that a step's legs lead to."""
        if not self._is_sound:
            return
        point = step.point
        for place, leg in enumerate(step.legs):
            if leg.outcome is not LegOutcome.ARRIVED and leg.length_m < _NOWHERE_M:
                continue
            is_last = place == len(step.legs) - 1
            if is_last and after is not None and after.point < len(self._graph.points):
                pose = self._graph.points[after.point]  # it came to a point that it knew, and took it for that
            elif is_last and after is not None:
                pose = _pose(after)
            else:
                # What the agent took this place for was not kept; where it was is nearly that.
                end = leg.track[-1] if leg.track else None
                pose = Pose(end.x_m, end.y_m, end.z_m, end.heading_rad) if end else Pose(*leg.target)
            point = self._graph.add_point(pose, previous=point)
        if after is not None and after.point != point:
            self._is_sound = False


def _pose(step: StepRecord) -> Pose:
    x_m, y_m, z_m, heading_rad = step.pose
    return Pose(x_m, y_m, z_m, heading_rad if math.isfinite(heading_rad) else 0.0)
