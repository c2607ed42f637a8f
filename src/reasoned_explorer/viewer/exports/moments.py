"""When what happened in a mission: what every format with a time line is written from.

All times are mission time, in seconds. A record keeps them of steps, calls and the track; what it does not time is put
where it must have been: views where their captions were asked for, captions where the last of their look had come,
a decision at the moment when the vehicle set out, what became of frontiers at the end of their step.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

from reasoned_explorer.model.record import ChoiceRecord, EpisodeRecord, FrontierRecord, StepRecord, ViewRecord
from reasoned_explorer.model.track import TrackPoint


@dataclass(frozen=True, slots=True)
class Look:
    """The views of one look.

    Attributes:
        seen_s: When its pictures were taken.
        said_s: When all of them were described.
        views: In order.
    """

    seen_s: float
    said_s: float
    views: tuple[ViewRecord, ...]


@dataclass(frozen=True, slots=True)
class FrontierMoment:
    """All ways on that are known, from a moment on; by id."""

    t_s: float
    frontiers: tuple[FrontierRecord, ...]


@dataclass(frozen=True, slots=True)
class ChoiceMoment:
    """A decision, from the moment when the vehicle set out until its step ended.

    Attributes:
        t_s: When it set out.
        until_s: When the step ended.
        here: Where it decided, x and y, ENU metres.
        there: Where the frontier is, likewise.
        choice: What was chosen, and what it was worth.
    """

    t_s: float
    until_s: float
    here: tuple[float, float]
    there: tuple[float, float]
    choice: ChoiceRecord


@dataclass(frozen=True, slots=True)
class Figures:
    """What a mission has cost up to a moment: CT and TT, seconds."""

    t_s: float
    ct_s: float
    tt_s: float


def decided_s(step: StepRecord) -> float:
    """Return when a step was decided: when the vehicle set out, or the end of a step without travel."""
    first = next((leg.track[0].t_s for leg in step.legs if leg.track), step.ended_s)
    return min(max(first, step.started_s), step.ended_s)


def ended_s(record: EpisodeRecord) -> float:
    """Return when the last thing of a record happened."""
    return max((step.ended_s for step in record.steps), default=0.0)


def poses(record: EpisodeRecord) -> list[TrackPoint]:
    """Return where the vehicle truly was, in the order of time; one pose a moment."""
    x_m, y_m, z_m, heading_rad = record.header.start
    found = {0.0: TrackPoint(0.0, x_m, y_m, z_m, heading_rad)}
    for step in record.steps:
        for leg in step.legs:
            found.update((point.t_s, point) for point in leg.track)
    return [found[t_s] for t_s in sorted(found)]


def looks(step: StepRecord) -> list[Look]:
    """Return the looks of a step, in order."""
    groups: dict[tuple[int, ...], list[ViewRecord]] = {}
    for view in step.views:
        groups.setdefault(view.key[:2], []).append(view)
    return [_look(step, key, views) for key, views in groups.items()]


def _look(step: StepRecord, key: tuple[int, ...], views: Iterable[ViewRecord]) -> Look:
    calls = [call for call in step.calls if call.role == "caption" and call.key[:2] == key]
    seen_s = min((call.started_s for call in calls), default=step.started_s)
    said_s = max((call.started_s + call.latency_s for call in calls), default=seen_s)
    return Look(_within(step, seen_s), _within(step, said_s), tuple(views))


def checked_s(step: StepRecord, look: Look, view: ViewRecord) -> float:
    """Return when the checker had answered about a view."""
    calls = [call for call in step.calls if call.role == "checker" and call.key == view.key]
    return _within(step, max((call.started_s + call.latency_s for call in calls), default=look.said_s))


def _within(step: StepRecord, t_s: float) -> float:
    return min(max(t_s, step.started_s), step.ended_s)


def frontier_moments(record: EpisodeRecord) -> Iterator[FrontierMoment]:
    """Yield all known ways on whenever they change: those of a step are there, open, when it is decided."""
    known: dict[int, FrontierRecord] = {}
    for step in record.steps:
        if not step.frontiers:
            continue
        fresh = [each for each in step.frontiers if each.id not in known]
        decided = decided_s(step)
        if fresh and decided < step.ended_s:
            known.update((each.id, _as_found(each)) for each in fresh)
            yield _moment(decided, known)
        known.update((each.id, each) for each in step.frontiers)
        yield _moment(step.ended_s, known)


def last_frontiers(record: EpisodeRecord) -> tuple[FrontierRecord, ...]:
    """Return all ways on that were ever known, as they were in the end; by id."""
    last = {each.id: each for step in record.steps for each in step.frontiers}
    return tuple(last[key] for key in sorted(last))


def _as_found(frontier: FrontierRecord) -> FrontierRecord:
    return frontier if frontier.state == "blocked" else replace(frontier, state="open", reason="")


def _moment(t_s: float, known: dict[int, FrontierRecord]) -> FrontierMoment:
    return FrontierMoment(t_s, tuple(known[key] for key in sorted(known)))


def choice_moments(record: EpisodeRecord) -> Iterator[ChoiceMoment]:
    """Yield the decisions whose frontier is known."""
    places: dict[int, tuple[float, float]] = {}
    for step in record.steps:
        places.update((each.id, (each.x_m, each.y_m)) for each in step.frontiers)
        if step.choice is not None and step.choice.frontier in places:
            here = (step.pose[0], step.pose[1])
            there = places[step.choice.frontier]
            yield ChoiceMoment(decided_s(step), step.ended_s, here, there, step.choice)


def figures(record: EpisodeRecord) -> Iterator[Figures]:
    """Yield CT and TT at the start and at the end of each step."""
    yield Figures(0.0, 0.0, 0.0)
    for step in record.steps:
        yield Figures(step.ended_s, step.ct_s, step.tt_s)


def path_points(record: EpisodeRecord) -> list[tuple[float, int, tuple[float, float, float]]]:
    """Return the path points in order: when each was first stood on, its number, and x, y and z, ENU metres."""
    found: dict[int, tuple[float, tuple[float, float, float]]] = {}
    for step in record.steps:
        found.setdefault(step.point, (step.started_s, step.pose[:3]))
    return [(t_s, number, place) for number, (t_s, place) in found.items()]
