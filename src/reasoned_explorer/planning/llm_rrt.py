"""LLM-RRT (paper, section IV-B, Algorithm 1): imagine what lies beyond each frontier, score it, take the mean.

Each described scene is expanded into ``children`` imagined scenes; each child is continued as a chain to depth
``depth``; every imagined node is scored, and Q of the frontier is the unweighted mean of its nodes' scores. With
``depth`` 0 the scene itself is scored, which is LLM-as-Eval. The paper's other readings are settings.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import UnionType

from reasoned_explorer.minds.context import Minds
from reasoned_explorer.model import Assessment, Fault, Goal, Scene, SettingsError
from reasoned_explorer.planning.planner import FrontierScore, ImaginedNode, Plan

LOWEST_SCORE = 1.0


@dataclass(frozen=True, slots=True)
class LlmRrtSettings:
    """How the imagined tree grows and is summed up.

    Attributes:
        children: Imagined scenes per described scene (C, 3 in the authors' code), at least 1.
        depth: Length of each chain (L, 2 is the paper's best), at least 0.
        include_own_score: Whether the described scene's own score takes part in the mean.
        depth_weight: Weight of a node at depth d is ``depth_weight ** (d - 1)``; 1 is the paper's unweighted mean.
        restart: Begin every rollout at the imagined child (the authors' code: ``simulation_async`` of ``src/RRT.py``)
            instead of continuing a chain; up to depth 2 there is one rollout for each child, and no difference.
    """

    children: int = 3
    depth: int = 2
    include_own_score: bool = False
    depth_weight: float = 1.0
    restart: bool = False

    def __post_init__(self) -> None:
        faults = []
        if not is_number(self.children, int) or not 1 <= self.children <= 32:
            faults.append(Fault(f"children is {self.children!r}", "a whole number from 1 to 32"))
        if not is_number(self.depth, int) or not 0 <= self.depth <= 16:
            faults.append(Fault(f"depth is {self.depth!r}", "a whole number from 0 to 16"))
        if not is_number(self.depth_weight, int | float) or not 0.0 < self.depth_weight <= 10.0:  # NaN is refused, too
            faults.append(Fault(f"depth_weight is {self.depth_weight!r}", "a number above 0 and at most 10"))
        switches = {"include_own_score": self.include_own_score, "restart": self.restart}
        faults += [Fault(f"{k} is {v!r}", "true or false") for k, v in switches.items() if not isinstance(v, bool)]
        if faults:
            raise SettingsError("LLM-RRT settings", faults)


class LlmRrt:
    """The paper's planner.

    Args:
        minds: Who imagines and who scores.
        settings: How.
        name: As registered.
        explorer: Settings of the agent that go with it; see `Planner`.
    """

    def __init__(
        self,
        minds: Minds,
        settings: LlmRrtSettings | None = None,
        *,
        name: str = "llm-rrt",
        explorer: Mapping[str, bool] | None = None,
    ) -> None:
        self._minds = minds
        self.settings = settings or LlmRrtSettings()
        self.name = name
        self.label = f"{name} [{minds.label}]"
        self.explorer = dict(explorer or {})

    async def plan(self, goal: Goal, scenes: Sequence[Scene]) -> Plan:
        """Return Q for each scene and the tree that it comes from.

        One batched visionary call per depth, then one batched evaluator call: the critical path is ``depth`` visionary
        calls and one evaluator call, whatever the number of scenes.
        """
        described = [scene for scene in scenes if scene.fault is None]
        nodes = list(await self._imagine(goal, described))
        if self.settings.include_own_score or self.settings.depth == 0:
            nodes = [*described, *nodes]
        asked = [node for node in nodes if node.fault is None]
        answers = iter(await self._minds.evaluator.evaluate(goal, asked) if asked else ())
        tree = [ImaginedNode(node, next(answers) if node.fault is None else None) for node in nodes]
        scores = tuple(self._back_propagate(scene, tree) for scene in scenes)
        return Plan(scores, tuple(tree))

    async def _imagine(self, goal: Goal, described: list[Scene]) -> list[Scene]:
        nodes: list[Scene] = []
        parents = described
        for depth in range(1, self.settings.depth + 1):
            if not parents:
                break
            grown = await self._minds.visionary.imagine(
                goal, parents, count=self.settings.children if depth == 1 else 1
            )
            level = [child for children in grown for child in children]
            nodes += level
            if depth == 1 or not self.settings.restart:
                parents = starts = [child for child in level if child.fault is None]
            else:
                # A later rollout from the same child needs a key of its own, or its draws would repeat the first's.
                parents = [replace(child, key=(*child.key, depth)) for child in starts]
        return nodes

    def _back_propagate(self, scene: Scene, tree: list[ImaginedNode]) -> FrontierScore:
        """Sum up the nodes that grew from a scene (paper, Algorithm 1, line 4)."""
        if scene.fault is not None:
            return FrontierScore(None, fault=scene.fault)
        own = len(scene.key)
        branch = [node for node in tree if node.scene.key[:own] == scene.key]
        total = weights = 0.0
        for node in branch:
            score = worth(node.assessment)
            if score is not None:
                weight = self.settings.depth_weight ** max(0, node.scene.depth - 1)
                total, weights = total + weight * score, weights + weight
        return frontier_score(total / weights if weights else None, branch)


def worth(assessment: Assessment | None) -> float | None:
    """Return what an answer counts for, in [1, 5]; None where it is missing. What is blocked counts as the lowest."""
    if assessment is None:
        return None
    return LOWEST_SCORE if assessment.blocked else assessment.score


def frontier_score(q: float | None, branch: Sequence[ImaginedNode]) -> FrontierScore:
    """Return what a branch says of its frontier.

    The frontier is blocked, or its ground forbidden, where the evaluator says so of every one of the nearest nodes that
    it was asked about: only what lies right ahead bars the way, and a missing answer bars nothing.

    Args:
        q: What the branch is worth; None takes the first fault in it for the reason.
        branch: The nodes that were scored for the frontier.
    """
    if q is None:
        faults = (node.scene.fault or (node.assessment and node.assessment.fault) for node in branch)
        return FrontierScore(None, fault=next((fault for fault in faults if fault), "no answer"))
    answered = [(node.scene.depth, node.assessment) for node in branch if node.assessment is not None]
    first = min(depth for depth, _ in answered)
    nearest = [assessment for depth, assessment in answered if depth == first]
    return FrontierScore(q, blocked=_all(nearest, "blocked"), forbidden=_all(nearest, "forbidden"))


def is_number(value: object, kind: type | UnionType) -> bool:
    """Return whether a setting is a number of a kind; true and false are none."""
    return isinstance(value, kind) and not isinstance(value, bool)


def _all(assessments: list[Assessment], answer: str) -> bool:
    return bool(assessments) and all(getattr(assessment, answer) for assessment in assessments)
