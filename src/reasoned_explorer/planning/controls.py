"""Controls: planners that spend what `LLM-RRT` spends and know less, to tell what a difference is owed to.

Where LLM-RRT beats LLM-as-Eval it may be since it imagines, or only since it asks more often, waits longer or sees more
text. Each control takes one of these away and leaves the rest as it is. They wrap whatever minds are given.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from reasoned_explorer.minds.context import Minds
from reasoned_explorer.minds.mind import Visionary
from reasoned_explorer.model import Goal, Scene
from reasoned_explorer.model.draws import uniform
from reasoned_explorer.planning.llm_rrt import LlmRrtSettings, frontier_score, worth
from reasoned_explorer.planning.planner import FrontierScore, ImaginedNode, Plan


@dataclass(frozen=True, slots=True)
class EchoVisionary:
    """Asks the real visionary and hands back what it was shown.

    The call is made, so that time, tokens and money are spent alike, and an answer that is missing stays missing; every
    imagined text is replaced by its parent's.

    Attributes:
        visionary: The real one.
    """

    visionary: Visionary

    async def imagine(self, goal: Goal, scenes: Sequence[Scene], *, count: int) -> Sequence[Sequence[Scene]]:
        """Return ``count`` times each scene's own text, with the keys and depths of imagined scenes."""
        grown = await self.visionary.imagine(goal, scenes, count=count)
        return [
            [child if child.fault is not None else replace(child, text=scene.text) for child in children]
            for scene, children in zip(scenes, grown, strict=True)
        ]


@dataclass(frozen=True, slots=True)
class ShuffledVisionary:
    """Asks the real visionary and deals its answers out among the views of a look.

    Every imagined scene keeps its place in the tree (key, depth, waypoint) and carries the text, or the fault, that was
    imagined from another view. Which view gets whose is drawn anew for each look: a random cycle through all views
    (Sattolo, 1986), in which none keeps its own. Only children of described scenes are dealt out; what is deeper is
    imagined from the dealt text and so belongs to the other view already (dealt out again, it could come home).

    With one view there is no other: nothing can be shuffled, and the control is LLM-RRT itself.

    Attributes:
        visionary: The real one.
        seed: Of the mission.
    """

    visionary: Visionary
    seed: int

    async def imagine(self, goal: Goal, scenes: Sequence[Scene], *, count: int) -> Sequence[Sequence[Scene]]:
        """Return ``count`` imagined scenes for each scene, those beyond described scenes from another view."""
        grown = [list(children) for children in await self.visionary.imagine(goal, scenes, count=count)]
        # In the order of keys, so that the deal does not hang on the views' order.
        views = sorted((place for place, scene in enumerate(scenes) if scene.depth == 0), key=lambda i: scenes[i].key)
        dealt = list(views)
        for last in range(len(views) - 1, 0, -1):
            other = int(uniform(self.seed, "shuffled views", *scenes[views[0]].key[:2], last) * last)
            dealt[last], dealt[other] = dealt[other], dealt[last]
        shuffled = list(grown)
        for to, source in zip(views, dealt, strict=True):
            shuffled[to] = [
                replace(own, text=given.text, fault=given.fault)
                for own, given in zip(grown[to], grown[source], strict=True)
            ]
        return shuffled


class LlmAsEvalMatched:
    """LLM-as-Eval with as many evaluator calls as LLM-RRT has: each described scene is asked several times.

    Each time has a key of its own, so that a model that draws may answer otherwise; Q is the mean. Minds that answer
    the same text the same way give LLM-as-Eval's scores, in the time that the slowest of more calls takes.

    Args:
        minds: Who scores.
        settings: LLM-RRT's; each scene is asked as often as it imagines nodes beyond it, at least once.
        name: As registered.
    """

    def __init__(
        self, minds: Minds, settings: LlmRrtSettings | None = None, *, name: str = "llm-as-eval-matched"
    ) -> None:
        self._minds = minds
        self.settings = settings or LlmRrtSettings()
        self.times = max(1, self.settings.children * self.settings.depth)
        self.name = name
        self.label = f"{name} [{minds.label}]"

    async def plan(self, goal: Goal, scenes: Sequence[Scene]) -> Plan:
        """Return the mean of each scene's scores; every question is a node of the tree."""
        described = [scene for scene in scenes if scene.fault is None]
        asked = [replace(scene, key=(*scene.key, time)) for scene in described for time in range(self.times)]
        answers = await self._minds.evaluator.evaluate(goal, asked) if asked else ()
        tree = [ImaginedNode(scene, answer) for scene, answer in zip(asked, answers, strict=True)]
        return Plan(tuple(_mean(scene, tree) for scene in scenes), tuple(tree))


def _mean(scene: Scene, tree: Sequence[ImaginedNode]) -> FrontierScore:
    if scene.fault is not None:
        return FrontierScore(None, fault=scene.fault)
    branch = [node for node in tree if node.scene.key[:-1] == scene.key]
    scores = [score for score in (worth(node.assessment) for node in branch) if score is not None]
    return frontier_score(sum(scores) / len(scores) if scores else None, branch)


def echoing(minds: Minds) -> Minds:
    """Return minds whose visionary echoes."""
    return replace(minds, visionary=EchoVisionary(minds.visionary))


def shuffling(minds: Minds) -> Minds:
    """Return minds whose visionary's answers are dealt out among the views."""
    return replace(minds, visionary=ShuffledVisionary(minds.visionary, minds.seed))
