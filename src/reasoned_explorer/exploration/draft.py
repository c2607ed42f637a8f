"""A step while it happens; frozen into a `StepRecord` when it is over."""

from collections.abc import Sequence
from dataclasses import dataclass, field

from reasoned_explorer.exploration.graph import Choice, Frontier
from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Leg, Scene, Verdict
from reasoned_explorer.model.record import (
    CallRecord,
    ChoiceRecord,
    FrontierRecord,
    InterventionRecord,
    LegRecord,
    NodeRecord,
    StepRecord,
    ViewRecord,
)
from reasoned_explorer.planning import FrontierScore, ImaginedNode, Plan


@dataclass(slots=True)
class LookDraft:
    """One look: its scenes from left to right, and what was said of them."""

    scenes: Sequence[Scene]
    verdicts: Sequence[Verdict] = ()
    scores: Sequence[FrontierScore] = ()
    frontiers: dict[int, int] = field(default_factory=dict)

    def from_the_middle(self) -> list[int]:
        """Return the places of the scenes, the one in the middle first, of two equally far the left one first.

        Frontiers are made in this order, so that of equal ones the one ahead is the older.
        """
        middle = (len(self.scenes) - 1) / 2.0
        return sorted(range(len(self.scenes)), key=lambda index: (abs(index - middle), index))

    def freeze(self) -> list[ViewRecord]:
        """Return one record per view."""
        views = []
        for index, scene in enumerate(self.scenes):
            verdict = self.verdicts[index] if index < len(self.verdicts) else Verdict(found=False, confidence=0.0)
            score = self.scores[index] if index < len(self.scores) else FrontierScore(None)
            pose = scene.viewpoint or scene.waypoint
            views.append(
                ViewRecord(
                    key=scene.key,
                    heading_rad=round(pose.heading_rad, 6),
                    caption=scene.text,
                    caption_fault=scene.fault,
                    q=_rounded(score.q),
                    blocked=score.blocked,
                    forbidden=score.forbidden,
                    plan_fault=score.fault,
                    found=verdict.found,
                    confidence=round(verdict.confidence, 4),
                    evidence=verdict.evidence,
                    check_fault=verdict.fault,
                    frontier=self.frontiers.get(index),
                )
            )
        return views


@dataclass(slots=True)
class StepDraft:
    """What is known of a step so far."""

    step: int
    started_s: float
    pose: Pose
    point: int
    looks: list[LookDraft] = field(default_factory=list)
    plan: Plan | None = None
    choice: Choice | None = None
    legs: list[Leg] = field(default_factory=list)
    touched: dict[int, Frontier] = field(default_factory=dict)
    look_s: float = 0.0
    think_s: float = 0.0
    plan_s: float = 0.0
    travel_s: float = 0.0
    notes: list[str] = field(default_factory=list)
    faults: int = 0

    def freeze(
        self,
        *,
        ended_s: float,
        ct_s: float,
        tt_s: float,
        calls: Sequence[CallRecord],
        interventions: Sequence[InterventionRecord] = (),
    ) -> StepRecord:
        """Return the record of the step. Numbers are rounded to what is meaningful, so that records stay small."""
        return StepRecord(
            step=self.step,
            started_s=round(self.started_s, 6),
            ended_s=round(ended_s, 6),
            pose=_pose(self.pose),
            point=self.point,
            views=tuple(view for look in self.looks for view in look.freeze()),
            tree=tuple(_node(node) for node in self.plan.tree) if self.plan else (),
            choice=_choice(self.choice),
            legs=tuple(_leg(leg) for leg in self.legs),
            frontiers=tuple(_frontier(self.touched[key]) for key in sorted(self.touched)),
            calls=tuple(calls),
            look_s=round(self.look_s, 6),
            think_s=round(self.think_s, 6),
            plan_s=round(self.plan_s, 6),
            travel_s=round(self.travel_s, 6),
            ct_s=round(ct_s, 6),
            tt_s=round(tt_s, 6),
            notes=tuple(self.notes),
            interventions=tuple(interventions),
        )


def _rounded(value: float | None, digits: int = 4) -> float | None:
    return None if value is None else round(value, digits)


def _pose(pose: Pose) -> tuple[float, float, float, float]:
    return round(pose.x_m, 3), round(pose.y_m, 3), round(pose.z_m, 3), round(pose.heading_rad, 6)


def _choice(choice: Choice | None) -> ChoiceRecord | None:
    if choice is None:
        return None
    return ChoiceRecord(
        frontier=choice.frontier.id,
        q=_rounded(choice.frontier.q),
        distance_m=round(choice.distance_m, 3),
        penalty=round(choice.penalty, 4),
        value=choice.value,
    )


def _node(node: ImaginedNode) -> NodeRecord:
    answer = node.assessment
    levels = answer.level_probabilities if answer else None
    return NodeRecord(
        key=node.scene.key,
        depth=node.scene.depth,
        text=node.scene.text,
        score=_rounded(answer.score) if answer else None,
        levels=tuple([round(level, 4) for level in levels]) if levels else None,
        blocked=bool(answer and answer.blocked),
        forbidden=bool(answer and answer.forbidden),
        fault=node.scene.fault or (answer.fault if answer else None),
    )


def _leg(leg: Leg) -> LegRecord:
    return LegRecord(
        target=(round(leg.target_x_m, 3), round(leg.target_y_m, 3)),
        outcome=leg.outcome,
        duration_s=round(leg.duration_s, 6),
        length_m=round(leg.length_m, 3),
        detail=leg.detail,
        cross_track_rms_m=round(leg.cross_track_rms_m, 4),
        localization_rms_m=_rounded(leg.localization_rms_m),
        track=leg.track,
    )


def _frontier(frontier: Frontier) -> FrontierRecord:
    pose = frontier.pose
    return FrontierRecord(
        id=frontier.id,
        parent=frontier.parent,
        x_m=round(pose.x_m, 3),
        y_m=round(pose.y_m, 3),
        heading_rad=round(pose.heading_rad, 6),
        q=_rounded(frontier.q),
        forbidden=frontier.forbidden,
        state=frontier.state.value,
        reason=frontier.reason,
    )
