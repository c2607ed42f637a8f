"""Bounds on one role: minds that read the truth in it and leave the others to whoever fills them.

- *Foresight*: an evaluator with a perfect imagination of so many metres beyond each frontier, and footpaths where
  these show nothing: how much a planner that imagines could win at most.
  It answers in no time, and is asked by `llm-as-eval`.
- *Perfect halt*: a checker that says "found" exactly where the judge would agree, and takes as long as an ordinary one,
  so that a mission with it differs by its halt alone. Where a mission has walked on ground that its goal shuns, it
  fails with a perfect halt, too: that was travel's fault.

Each fills one role only; asked in another it answers with a fault.
"""

from collections.abc import Sequence
from dataclasses import replace

from reasoned_explorer.evaluation.truth import FrontierSight, OracleTruth, truth_of
from reasoned_explorer.minds.charging import charge_calls
from reasoned_explorer.minds.context import MindContext, Minds
from reasoned_explorer.minds.embedded.reading import read_scene
from reasoned_explorer.model import Assessment, Goal, Scene, Verdict, likert_from_score
from reasoned_explorer.planning.without_models import path_score

#: What is foreseen is worth this at the horizon and more the nearer it is: all grounds of `follow-paths` come after it.
_LEAST, _MOST = 4.0, 5.0


class _OneRole:
    """Answers with a fault; a mind that fills one role overrides that one."""

    def __init__(self, name: str, role: str) -> None:
        self._fault = f"{name} is a bound on the {role} alone"

    async def evaluate(self, goal: Goal, scenes: Sequence[Scene]) -> Sequence[Assessment]:  # noqa: ARG002 - the protocol's
        """Return a fault for each scene."""
        return [Assessment(None, fault=self._fault) for _ in scenes]

    async def imagine(
        self,
        goal: Goal,  # noqa: ARG002 - the protocol's
        scenes: Sequence[Scene],
        *,
        count: int,
    ) -> Sequence[Sequence[Scene]]:
        """Return ``count`` scenes with a fault for each scene."""
        return [
            [
                replace(scene, text="", key=(*scene.key, child), depth=scene.depth + 1, fault=self._fault)
                for child in range(count)
            ]
            for scene in scenes
        ]

    async def check(self, goal: Goal, scenes: Sequence[Scene]) -> Sequence[Verdict]:  # noqa: ARG002
        """Return a fault for each scene, never "found"."""
        return [Verdict(found=False, confidence=0.0, fault=self._fault) for _ in scenes]


class Foresight(_OneRole):
    """Scores each frontier by the way that remains from it where that is short, else as `follow-paths` does.

    Args:
        truth: Of the mission.
        horizon_m: How far beyond a frontier is foreseen, metres, 0 or more; with 0 it is `follow-paths`.
        name: For people.
    """

    def __init__(self, truth: OracleTruth, horizon_m: float, *, name: str = "foresight") -> None:
        super().__init__(name, "evaluator")
        self._sight = FrontierSight(truth)
        self._horizon_m = horizon_m

    async def evaluate(self, goal: Goal, scenes: Sequence[Scene]) -> Sequence[Assessment]:  # noqa: ARG002
        """Return 4 to 5, rising with nearness, where what remains on compliant ground is within the horizon."""
        return [self._assess(scene) for scene in scenes]

    def _assess(self, scene: Scene) -> Assessment:
        if scene.fault is not None:
            return Assessment(None, fault=scene.fault)
        by_path, here = path_score(scene.text), scene.viewpoint or scene.waypoint

        def score_of(remaining_m: float) -> float:
            return self._foreseen(remaining_m) if remaining_m < self._horizon_m else by_path

        there, remaining_m = self._sight.ahead(here, score_of)
        # What is foreseen is known, the way there included; of what is not, only the text can tell.
        foreseen = remaining_m < self._horizon_m
        blocked = not self._sight.is_open(here, there, remaining_m) if foreseen else read_scene(scene.text).blocked
        return Assessment(likert_from_score(score_of(remaining_m)), blocked=blocked)

    def _foreseen(self, remaining_m: float) -> float:
        return _LEAST + (_MOST - _LEAST) * (1.0 - remaining_m / self._horizon_m)


class PerfectHalt(_OneRole):
    """Says "found" exactly where the judge would agree, charged like any checker.

    Args:
        context: Clock, latency profile, ledger and seed.
        truth: Of the mission.
    """

    def __init__(self, context: MindContext, truth: OracleTruth) -> None:
        super().__init__("perfect-halt", "checker")
        self._context, self._truth = context, truth

    async def check(self, goal: Goal, scenes: Sequence[Scene]) -> Sequence[Verdict]:  # noqa: ARG002 - the protocol's
        """Return the judge's answer to where each view was taken; a scene's fault stays one, as for any checker."""
        answers = [
            Verdict(found=False, confidence=0.0, fault=scene.fault)
            if scene.fault is not None
            else self._truth.verdict(scene.viewpoint or scene.waypoint)
            for scene in scenes
        ]
        faults = [answer.fault for answer in answers]
        await charge_calls(self._context, "checker", "perfect-halt", [scene.key for scene in scenes], faults)
        return answers


def _foresight(context: MindContext, horizon_m: float) -> Minds:
    name = f"foresight-{horizon_m:g}m"
    mind = Foresight(truth_of(context, f"the mind {name}"), horizon_m, name=name)
    label = f"{name} (knows the way within {horizon_m:g} m of each frontier, else footpaths; a bound)"
    return Minds(label=label, evaluator=mind, visionary=mind, checker=mind)


def make_foresight_30m(context: MindContext) -> Minds:
    """Return the evaluator that foresees 30 m; its other roles answer with a fault.

    Raises:
        SettingsError: If there is no truth to read, as on a real vehicle.
    """
    return _foresight(context, 30.0)


def make_foresight_60m(context: MindContext) -> Minds:
    """Return the evaluator that foresees 60 m; its other roles answer with a fault.

    Raises:
        SettingsError: If there is no truth to read, as on a real vehicle.
    """
    return _foresight(context, 60.0)


def make_perfect_halt(context: MindContext) -> Minds:
    """Return the perfect checker; its other roles answer with a fault.

    Raises:
        SettingsError: If there is no truth to read, as on a real vehicle.
    """
    mind = PerfectHalt(context, truth_of(context, "the mind perfect-halt"))
    return Minds(label="perfect halt (knows the world; a bound)", evaluator=mind, visionary=mind, checker=mind)
