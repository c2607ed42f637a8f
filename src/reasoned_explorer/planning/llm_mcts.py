"""LLM-MCTS (paper, section V, the second baseline, after Hao et al., 2023): Monte Carlo tree search in imagination.

The described scenes are the root's children; one evaluator call gives each its value V. Then come ``iterations``
rounds, each of which has to wait for the one before:

- *selection*: from the root down, the child with the highest Q + η·V/(1 + n^γ) (the authors' published code), until a
  node that can grow. Q is the mean of the rewards that came through a node and n their number; a node that no reward
  came through yet has its V for Q (ours: with zero, as in their code, the first scene that was tried would always win);
- *expansion*: the visionary imagines one more child of that node;
- *simulation*: it imagines one step beyond the child, and one evaluator call scores both. The child's score is its V,
  the mean of the two the reward;
- *backup*: the reward goes into the mean of every node on the path.

A frontier's Q is that of its root child. An iteration takes three calls one after the other, a plan 3 × iterations + 1
calls, whatever the number of scenes.

The paper gives ten iterations and the scores, no more; that three calls an iteration agree with its table is derived
here (ours). CASR/SR is the share of time that successful missions have left: .10/.47 = .21 for LLM-MCTS, .42/.51 = .82
for LLM-RRT, so that they took .79 and .18 of 1800 s, about 1416 s and 317 s. With 9 to 13.5 s of planning and 13.2 s of
acting a step (the authors' log of LLM-RRT), 317 s are about 13 steps. As many steps in 1416 s leave
1416/13 - 13.2 = 96 s of planning a step, or 9.6 s an iteration. In the profile ``gpt-2023`` two visionary calls and one
evaluator call have medians of 2 × 2.85 + 3.55 = 9.25 s; their means, the evaluator's that of the slower of two answers,
are 2 × 3.04 + 4.55 = 10.6 s.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

from reasoned_explorer.minds.context import Minds
from reasoned_explorer.model import Assessment, Fault, Goal, Scene, SettingsError
from reasoned_explorer.planning.llm_rrt import frontier_score, is_number, worth
from reasoned_explorer.planning.planner import FrontierScore, ImaginedNode, Plan


@dataclass(frozen=True, slots=True)
class LlmMctsSettings:
    """How the tree is searched; (P) is the paper's, (C) the authors' code's, (O) ours.

    Attributes:
        iterations: Rounds of selection, expansion, simulation and backup, 0 to 1000 (P: 10); with 0 a frontier's Q is
            its own V. The search ends earlier where every node has all its children.
        children: Most imagined children of a node, 1 to 32 (C: 3).
        depth: Depth below which no node grows, 1 to 16; simulations look one step beyond it (O: 3).
        exploration: η, the weight of a node's own value, 0 to 100 (C: 1).
        visit_power: γ, how fast that weight fades with visits, 0 to 10 (C: 3).
    """

    iterations: int = 10
    children: int = 3
    depth: int = 3
    exploration: float = 1.0
    visit_power: float = 3.0

    def __post_init__(self) -> None:
        whole = (
            ("iterations", self.iterations, 0, 1000),
            ("children", self.children, 1, 32),
            ("depth", self.depth, 1, 16),
        )
        faults = [
            Fault(f"{name} is {value!r}", f"a whole number from {low} to {high}")
            for name, value, low, high in whole
            if not is_number(value, int) or not low <= value <= high
        ]
        faults += [
            Fault(f"{name} is {value!r}", f"a number from 0 to {high}")
            for name, value, high in (("exploration", self.exploration, 100), ("visit_power", self.visit_power, 10))
            if not is_number(value, int | float) or not 0.0 <= value <= high  # NaN is refused, too
        ]
        if faults:
            raise SettingsError("LLM-MCTS settings", faults)


@dataclass(slots=True, eq=False)
class _Node:
    """A node of the tree while it grows.

    Attributes:
        scene: What is seen or imagined there.
        assessment: What the evaluator said of it, or None where it was not asked.
        depth: 0 for a described scene.
        tried: How often a child was asked for; failed ones take a place, so that none is asked for without end.
        children: Those that could be imagined.
        rewards: Sum of the rewards that came through it.
        n: How many.
    """

    scene: Scene
    assessment: Assessment | None
    depth: int = 0
    tried: int = 0
    children: list["_Node"] = field(default_factory=list)
    rewards: float = 0.0
    n: int = 0

    @property
    def q(self) -> float | None:
        """The mean reward; the node's own value where there is none; None where that is missing, too."""
        return self.rewards / self.n if self.n else worth(self.assessment)


class LlmMcts:
    """The paper's second baseline.

    Args:
        minds: Who imagines and who scores.
        settings: How.
        name: As registered.
    """

    def __init__(self, minds: Minds, settings: LlmMctsSettings | None = None, *, name: str = "llm-mcts") -> None:
        self._minds = minds
        self.settings = settings or LlmMctsSettings()
        self.name = name
        self.label = f"{name} [{minds.label}]"

    async def plan(self, goal: Goal, scenes: Sequence[Scene]) -> Plan:
        """Return Q for each scene and the tree that it comes from, simulated nodes included.

        The critical path is 3 × ``iterations`` + 1 calls. An answer that is missing is left out of its iteration's
        reward; an iteration without any answer changes no Q.
        """
        described = [scene for scene in scenes if scene.fault is None]
        answers = await self._minds.evaluator.evaluate(goal, described) if described else ()
        roots = [_Node(scene, answer) for scene, answer in zip(described, answers, strict=True)]
        tree = [ImaginedNode(root.scene, root.assessment) for root in roots]
        for _ in range(self.settings.iterations):
            path = self._select(roots)
            if not path:
                break
            tree += await self._grow(goal, path)
        by_key = {root.scene.key: root for root in roots}
        return Plan(tuple(_score(scene, by_key.get(scene.key), tree) for scene in scenes), tuple(tree))

    def _select(self, roots: Sequence[_Node]) -> list[_Node]:
        """Return the path from a root child to the node that grows next; empty where none can."""
        path: list[_Node] = []
        level = roots
        while not path or path[-1].tried == self.settings.children:
            growing = [node for node in level if self._can_grow(node)]
            if not growing:
                return []
            # Ties go to the smallest key and not to the first in line, so that no answer hangs on the views' order.
            path.append(min(growing, key=lambda node: (-self._promise(node), node.scene.key)))
            level = path[-1].children
        return path

    def _can_grow(self, node: _Node) -> bool:
        """Return whether a node, or one that grew from it, lacks a child."""
        if node.depth >= self.settings.depth:
            return False
        return node.tried < self.settings.children or any(self._can_grow(child) for child in node.children)

    def _promise(self, node: _Node) -> float:
        """Return Q + η·V/(1 + n^γ).

        Of a node without any answer nothing is known: it is tried once before all others, then after them. Where V
        alone is missing its term is left out.
        """
        q, v = node.q, worth(node.assessment)
        if q is None:
            return -math.inf if node.tried else math.inf
        return q + (0.0 if v is None else self.settings.exploration * v / (1.0 + node.n**self.settings.visit_power))

    async def _grow(self, goal: Goal, path: list[_Node]) -> list[ImaginedNode]:
        """Make one iteration from the last node of a path on; return what was imagined in it."""
        parent = path[-1]
        scene = await self._imagine(goal, parent.scene, parent.tried)
        parent.tried += 1
        if scene.fault is not None:
            return [ImaginedNode(scene, None)]
        # The simulated node is numbered after all children that this one may get.
        beyond = await self._imagine(goal, scene, self.settings.children)
        asked = [scene] if beyond.fault is not None else [scene, beyond]
        answers = await self._minds.evaluator.evaluate(goal, asked)
        node = _Node(scene, answers[0], parent.depth + 1)
        parent.children.append(node)
        scores = [score for score in map(worth, answers) if score is not None]
        if scores:
            reward = sum(scores) / len(scores)
            for each in (*path, node):
                each.rewards, each.n = each.rewards + reward, each.n + 1
        return [ImaginedNode(scene, answers[0]), ImaginedNode(beyond, answers[1] if len(answers) > 1 else None)]

    async def _imagine(self, goal: Goal, parent: Scene, child: int) -> Scene:
        """Return one imagined scene with the key that it has in the tree: its parent's and its number.

        A visionary numbers the children of each call from 0, and its draws hang on its parent's key: asked under the
        parent's own key, it would say the same each time.
        """
        key = (*parent.key, child)
        grown = await self._minds.visionary.imagine(goal, [replace(parent, key=key)], count=1)
        return replace(grown[0][0], key=key)


def _score(scene: Scene, root: _Node | None, tree: Sequence[ImaginedNode]) -> FrontierScore:
    if root is None:
        return FrontierScore(None, fault=scene.fault)
    own = len(scene.key)
    return frontier_score(root.q, [node for node in tree if node.scene.key[:own] == scene.key])
