"""Everything that is kept of a mission, so that it can be checked and shown again without anything else."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

from reasoned_explorer.model.track import LegOutcome, TrackPoint

RECORD_SCHEMA = 1


class MissionEnd(StrEnum):
    """Every way a mission can end."""

    FOUND = "found"
    TIME_OVER = "time over"
    BUDGET_SPENT = "budget spent"
    NOTHING_LEFT = "nothing left"
    FAULT = "fault"
    INTERRUPTED = "interrupted"


@dataclass(frozen=True, slots=True)
class MissionHeader:
    """What a mission was started with; the first line of a record.

    Attributes:
        goal: The goal sentence.
        level: OUTDOOR's level, or None.
        world: Name of the world; ``"none"`` where none is known, as outdoors: nobody judges then.
        world_digest: SHA-256 of what the world contains, hexadecimal; empty where none is known.
        attribution: Of the world's data.
        start: x_m, y_m, z_m, heading_rad.
        planner: Its label.
        minds: Their label.
        captioner: Its label.
        vehicle: Its profile's name.
        clock: ``"virtual"``, ``"real"`` or ``"mixed"``.
        ct_label: How CT came about, e.g. ``"modelled (gpt-2023)"``.
        settings: All settings.
        seed: Of the mission.
        versions: Of this package and of those that decide results.
        goal_objects: What satisfies the goal: id, class, x_m, y_m, grade.
        reference_length_m: Of the shortest (compliant) way into the success region; None where there is none.
        reference_way: Its points.
        success_radius_m: R.
        understood: What the judge reads in the goal, in words.
        origin_deg: Latitude and longitude of the world's ENU origin, degrees; None for a world that is not on earth.
        notes: What a person should know of how it was set up.
        schema: Version of this format.
    """

    goal: str
    level: int | None
    world: str
    world_digest: str
    attribution: str
    start: tuple[float, float, float, float]
    planner: str
    minds: str
    captioner: str
    vehicle: str
    clock: str
    ct_label: str
    settings: Mapping[str, Any]
    seed: int
    versions: Mapping[str, str]
    goal_objects: tuple[tuple[int, str, float, float, int], ...] = ()
    reference_length_m: float | None = None
    reference_way: tuple[tuple[float, float], ...] = ()
    success_radius_m: float = 15.0
    understood: tuple[str, ...] = ()
    origin_deg: tuple[float, float] | None = None
    notes: tuple[str, ...] = ()
    schema: int = RECORD_SCHEMA

    @property
    def is_judged(self) -> bool:
        """Whether there is a world, and so a judge."""
        return bool(self.world_digest)


@dataclass(frozen=True, slots=True)
class ViewRecord:
    """One view of a step: where it looked, what was said of it, what was decided about it."""

    key: tuple[int, ...]
    heading_rad: float
    caption: str
    caption_fault: str | None = None
    q: float | None = None
    blocked: bool = False
    forbidden: bool = False
    plan_fault: str | None = None
    found: bool = False
    confidence: float = 0.0
    evidence: str = ""
    check_fault: str | None = None
    frontier: int | None = None


@dataclass(frozen=True, slots=True)
class NodeRecord:
    """One node of the imagined tree."""

    key: tuple[int, ...]
    depth: int
    text: str
    score: float | None = None
    levels: tuple[float, ...] | None = None
    blocked: bool = False
    forbidden: bool = False
    fault: str | None = None


@dataclass(frozen=True, slots=True)
class FrontierRecord:
    """A frontier when the step ended."""

    id: int
    parent: int
    x_m: float
    y_m: float
    heading_rad: float
    q: float | None
    forbidden: bool
    state: str
    reason: str = ""


@dataclass(frozen=True, slots=True)
class ChoiceRecord:
    """The frontier that was chosen, and what it was worth."""

    frontier: int
    q: float | None
    distance_m: float
    penalty: float
    value: float | None


@dataclass(frozen=True, slots=True)
class LegRecord:
    """One leg of the travel of a step."""

    target: tuple[float, float]
    outcome: LegOutcome
    duration_s: float
    length_m: float
    detail: str
    cross_track_rms_m: float
    localization_rms_m: float | None
    track: tuple[TrackPoint, ...]


@dataclass(frozen=True, slots=True)
class InterventionRecord:
    """Once that a vehicle's guard stopped it, cut a command short or refused one.

    Attributes:
        t_s: Mission time, seconds.
        cause: Of what kind the reason is (`vehicles.safety.cause`).
        detail: The reason in words.
        done: What was done about it.
    """

    t_s: float
    cause: str
    detail: str
    done: str


@dataclass(frozen=True, slots=True)
class CallRecord:
    """One call of a model.

    Attributes:
        role: ``caption``, ``visionary``, ``evaluator`` or ``checker``.
        model: What answered.
        key: Of the scene that it was about: (step, look, view, ...).
        started_s: Mission time when it was asked, seconds.
        latency_s: Seconds that it is charged.
        tokens_in: Tokens that were sent; 0 for minds that have none.
        tokens_out: Tokens that came back, likewise.
        usd: US dollars, or None where the price is not known.
        cached: Whether the answer came from a store and not from the model; its seconds are the original ones.
        retries: How often it was asked again before it was answered or given up.
        fault: Why there is no answer, or None.
    """

    role: str
    model: str
    key: tuple[int, ...]
    started_s: float
    latency_s: float
    tokens_in: int = 0
    tokens_out: int = 0
    usd: float | None = 0.0
    cached: bool = False
    retries: int = 0
    fault: str | None = None

    def rounded(self) -> "CallRecord":
        """Return it with its seconds in whole microseconds, as records keep them."""
        started_s, latency_s = round(self.started_s, 6), round(self.latency_s, 6)
        if started_s == self.started_s and latency_s == self.latency_s:
            return self
        return CallRecord(
            self.role,
            self.model,
            self.key,
            started_s,
            latency_s,
            self.tokens_in,
            self.tokens_out,
            self.usd,
            self.cached,
            self.retries,
            self.fault,
        )


@dataclass(frozen=True, slots=True)
class StepRecord:
    """One step of a mission; one line of a record.

    Attributes:
        step: From 0.
        started_s: Mission time at its start.
        ended_s: Mission time at its end.
        pose: Estimated x_m, y_m, z_m, heading_rad where it began.
        point: The path point where it began.
        views: The views of all looks of the step, in order.
        tree: The imagined nodes.
        choice: What was chosen; None where the mission ended here.
        legs: The travel.
        frontiers: Frontiers that were made or changed in this step.
        calls: Model calls of the step.
        look_s: Seconds of looking (part of TT).
        think_s: Seconds of waiting for a decision (CT): captions, checks and plans.
        plan_s: Seconds of the planner alone (the authors' log counts only these).
        travel_s: Seconds of travelling (part of TT).
        ct_s: CT since the mission's start.
        tt_s: TT since the mission's start, looking included.
        notes: What else happened, for people.
        interventions: What the vehicle's guard did, if it has one.
    """

    step: int
    started_s: float
    ended_s: float
    pose: tuple[float, float, float, float]
    point: int
    views: tuple[ViewRecord, ...] = ()
    tree: tuple[NodeRecord, ...] = ()
    choice: ChoiceRecord | None = None
    legs: tuple[LegRecord, ...] = ()
    frontiers: tuple[FrontierRecord, ...] = ()
    calls: tuple[CallRecord, ...] = ()
    look_s: float = 0.0
    think_s: float = 0.0
    plan_s: float = 0.0
    travel_s: float = 0.0
    ct_s: float = 0.0
    tt_s: float = 0.0
    notes: tuple[str, ...] = ()
    interventions: tuple[InterventionRecord, ...] = ()


@dataclass(frozen=True, slots=True)
class MissionSummary:
    """How a mission ended and what it scored; the last line of a record.

    Attributes:
        end: How it ended.
        reason: In words.
        declared: Whether "Found Goal" was said.
        success: Judged; None where nobody judges, since no world is known.
        oracle_success: Judged at any moment of the track; likewise.
        compliant: Whether shunned ground was kept off (level 3); None where the goal says nothing of ground.
        spl: Success weighted by path length; None where nobody judges.
        casr: Of this mission: S · (1 − (CT + TT) / T_max); likewise.
        path_length_m: Travelled.
        reference_length_m: Of the shortest compliant way; None where there is none.
        distance_to_goal_m: From the end to the nearest satisfying footprint; None where there is none.
        ct_s: Every second of waiting for a decision.
        tt_s: Every second of travelling and looking.
        plan_s: The planner's share of CT.
        steps: Number of steps.
        calls: Number of calls by role.
        radii: Success at other radii, by radius in metres.
        judge: What the judge says in words.
        collisions: What was run into, in order.
    """

    end: MissionEnd
    reason: str
    declared: bool
    success: bool | None
    oracle_success: bool | None
    compliant: bool | None
    spl: float | None
    casr: float | None
    path_length_m: float
    reference_length_m: float | None
    distance_to_goal_m: float | None
    ct_s: float
    tt_s: float
    plan_s: float
    steps: int
    calls: Mapping[str, int] = field(default_factory=dict)
    radii: Mapping[str, bool] = field(default_factory=dict)
    judge: str = ""
    collisions: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class EpisodeRecord:
    """A whole mission. ``summary`` is None where it was cut off: the record then ends at its last whole step."""

    header: MissionHeader
    steps: tuple[StepRecord, ...]
    summary: MissionSummary | None = None

    @property
    def complete(self) -> bool:
        """Whether the mission came to an end of its own."""
        return self.summary is not None and self.summary.end is not MissionEnd.INTERRUPTED
