"""The oracle mind: it knows the world, and shows what the rest of the agent can do.

It answers the same questions as any mind and is registered like any other, but it reads the truth instead of the text:
how far it is, on compliant ground, from each frontier to where the goal would be reached. Its results are an upper
bound and are called that.
"""

import math
from collections.abc import Sequence
from dataclasses import replace

from reasoned_explorer.evaluation.truth import FrontierSight, OracleTruth, truth_of
from reasoned_explorer.geometry import Pose
from reasoned_explorer.minds.context import MindContext, Minds
from reasoned_explorer.model import Assessment, Goal, Scene, Verdict, likert_from_score

__all__ = ["Oracle", "OracleTruth", "make_minds"]

#: Distance over which the oracle's score falls from 5 towards 1 by a factor of e, metres.
_SCALE_M = 200.0


class Oracle:
    """All three roles, answered from the truth."""

    def __init__(self, truth: OracleTruth) -> None:
        self._truth = truth
        self._sight = FrontierSight(truth)
        # All that is imagined from one view has the same answer: the last one is kept.
        self._answers: dict[Pose, Assessment] = {}

    async def evaluate(self, goal: Goal, scenes: Sequence[Scene]) -> Sequence[Assessment]:  # noqa: ARG002 - the protocol's
        """Score each scene by the remaining way from its waypoint."""
        return [self._assess(scene) for scene in scenes]

    async def imagine(
        self,
        goal: Goal,  # noqa: ARG002 - the protocol's
        scenes: Sequence[Scene],
        *,
        count: int,
    ) -> Sequence[Sequence[Scene]]:
        """Return each scene again: what lies beyond is in the score of its waypoint already."""
        return [
            [replace(scene, key=(*scene.key, child), depth=scene.depth + 1) for child in range(count)]
            for scene in scenes
        ]

    async def check(self, goal: Goal, scenes: Sequence[Scene]) -> Sequence[Verdict]:  # noqa: ARG002
        """Say "found" where the judge would agree."""
        return [self._truth.verdict(scene.viewpoint or scene.waypoint) for scene in scenes]

    def _assess(self, scene: Scene) -> Assessment:
        here = scene.viewpoint or scene.waypoint
        if here not in self._answers:
            there, remaining_m = self._sight.ahead(here, _score)
            # The oracle knows what shunned ground costs: to it, such a way is none.
            blocked = not self._sight.is_open(here, there, remaining_m)
            self._answers = {here: Assessment(likert_from_score(_score(remaining_m)), blocked=blocked)}
        return self._answers[here]


def _score(remaining_m: float) -> float:
    return 1.0 + 4.0 * math.exp(-remaining_m / _SCALE_M) if math.isfinite(remaining_m) else 1.0


def make_minds(context: MindContext) -> Minds:
    """Return the oracle in all three roles.

    Raises:
        SettingsError: If there is no truth to read, as on a real vehicle.
    """
    oracle = Oracle(truth_of(context, "the oracle mind"))
    return Minds(label="oracle (knows the world; an upper bound)", evaluator=oracle, visionary=oracle, checker=oracle)
