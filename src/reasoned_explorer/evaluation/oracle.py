"""The oracle mind: it knows the world, and shows what the rest of the agent can do.

It answers the same questions as any mind and is registered like any other, but it reads the truth instead of the text:
how far it is, on compliant ground, from each frontier to where the goal would be reached. Its results are an upper
bound and are called that.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from reasoned_explorer.geometry import Pose
from reasoned_explorer.minds.context import MindContext, Minds
from reasoned_explorer.model import Assessment, Fault, Goal, Scene, SettingsError, Verdict, likert_from_score
from reasoned_explorer.task.judge import Judge
from reasoned_explorer.vehicles import VehicleProfile
from reasoned_explorer.world.atlas import Atlas

#: Distance over which the oracle's score falls from 5 towards 1 by a factor of e.
_SCALE_M = 150.0
#: How far one imagined scene lies beyond the other.
_STRIDE_M = 10.0
#: Declared a little inside the radius: the vehicle knows its position only to centimetres.
_INSIDE_M = 0.5


@dataclass(frozen=True, slots=True)
class OracleTruth:
    """What the oracle reads.

    Attributes:
        atlas: The world.
        judge: Of the mission.
        profile: Of the vehicle.
    """

    atlas: Atlas
    judge: Judge
    profile: VehicleProfile


class Oracle:
    """All three roles, answered from the truth."""

    def __init__(self, truth: OracleTruth) -> None:
        self._truth = truth
        self._field = truth.judge.distance_field()

    async def evaluate(self, goal: Goal, scenes: Sequence[Scene]) -> Sequence[Assessment]:  # noqa: ARG002
        """Score each scene by the remaining way from its waypoint."""
        return [self._assess(scene) for scene in scenes]

    async def imagine(
        self,
        goal: Goal,  # noqa: ARG002 - the protocol's
        scenes: Sequence[Scene],
        *,
        count: int,
    ) -> Sequence[Sequence[Scene]]:
        """Return each scene moved on along the shortest way."""
        return [[self._beyond(scene, child) for child in range(count)] for scene in scenes]

    async def check(self, goal: Goal, scenes: Sequence[Scene]) -> Sequence[Verdict]:  # noqa: ARG002
        """Say "found" exactly where the judge would agree."""
        return [self._verdict(scene.viewpoint or scene.waypoint) for scene in scenes]

    def _assess(self, scene: Scene) -> Assessment:
        remaining_m = self._field.at(scene.waypoint.x_m, scene.waypoint.y_m) + _STRIDE_M * scene.depth
        score = 1.0 + 4.0 * math.exp(-remaining_m / _SCALE_M) if math.isfinite(remaining_m) else 1.0
        blocked = forbidden = False
        if scene.viewpoint is not None:
            here, there = scene.viewpoint, scene.viewpoint.ahead(self._leg_m(scene))
            blocked = not self._is_free(here, there) or not math.isfinite(remaining_m)
            forbidden = not self._truth.judge.leg_is_compliant((here.x_m, here.y_m), (there.x_m, there.y_m))
        return Assessment(likert_from_score(score), blocked=blocked, forbidden=forbidden)

    def _leg_m(self, scene: Scene) -> float:
        viewpoint = scene.viewpoint or scene.waypoint
        return max(1.0, viewpoint.distance_to_m(scene.waypoint.x_m, scene.waypoint.y_m))

    def _is_free(self, here: Pose, there: Pose) -> bool:
        if not self._truth.profile.collides:
            return True
        return self._truth.judge.leg_is_free((here.x_m, here.y_m), (there.x_m, there.y_m))

    def _beyond(self, scene: Scene, child: int) -> Scene:
        # The waypoint stays: what lies beyond it is counted by the depth, so that a branch keeps its order.
        return replace(scene, key=(*scene.key, child), depth=scene.depth + 1)

    def _verdict(self, pose: Pose) -> Verdict:
        report = self._truth.judge.success(pose, radius_m=self._truth.judge.success_radius_m - _INSIDE_M)
        return Verdict(report.success, 1.0 if report.success else 0.0, "the judge agrees" if report.success else "")


def make_minds(context: MindContext) -> Minds:
    """Return the oracle in all three roles.

    Raises:
        SettingsError: If there is no truth to read, as on a real vehicle.
    """
    if not isinstance(context.truth, OracleTruth):
        fault = Fault("the oracle mind was asked for where no truth is known", "a simulated world and a goal it can judge")
        raise SettingsError("minds", [fault])
    oracle = Oracle(context.truth)
    return Minds(label="oracle (knows the world; an upper bound)", evaluator=oracle, visionary=oracle, checker=oracle)
