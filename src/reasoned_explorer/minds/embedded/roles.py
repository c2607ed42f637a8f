"""The embedded minds as the three roles: thin, asynchronous, charging their modelled seconds."""

from collections.abc import Sequence

from reasoned_explorer.minds.charging import charge_calls
from reasoned_explorer.minds.context import MindContext
from reasoned_explorer.minds.embedded.checker import verdict_on
from reasoned_explorer.minds.embedded.evaluator import assess
from reasoned_explorer.minds.embedded.relevance import Senses
from reasoned_explorer.minds.embedded.visionary import imagine_texts
from reasoned_explorer.model import Assessment, Goal, Scene, Verdict

#: So many entries of a scene's key say which view it belongs to: step, look, index.
_VIEW_KEY = 3


class EmbeddedMinds:
    """Evaluator, visionary and goal checker without a language model. They read a scene's text and key, nothing else.

    Args:
        context: Clock, latency profile, ledger and seed.
        senses: What is known of words and places.
    """

    def __init__(self, context: MindContext, senses: Senses) -> None:
        self._context = context
        self._senses = senses

    async def evaluate(self, goal: Goal, scenes: Sequence[Scene]) -> Sequence[Assessment]:
        """Return one assessment per scene, in order.

        Raises:
            GoalError: If the goal asks for nothing that can be found.
        """
        answers = [
            Assessment(None, fault=scene.fault)
            if scene.fault is not None
            else assess(goal.text, scene.text, self._senses)
            for scene in scenes
        ]
        faults = [answer.fault for answer in answers]
        await charge_calls(self._context, "evaluator", "embedded", [scene.key for scene in scenes], faults)
        return answers

    async def imagine(
        self,
        goal: Goal,  # noqa: ARG002 - the paper's visionary does not know it
        scenes: Sequence[Scene],
        *,
        count: int,
    ) -> Sequence[Sequence[Scene]]:
        """Return ``count`` imagined scenes for each scene, in order, whatever the goal is."""
        imagined = [self._children(scene, count) for scene in scenes]
        made = [child for children in imagined for child in children]
        await charge_calls(
            self._context, "visionary", "embedded", [child.key for child in made], [child.fault for child in made]
        )
        return imagined

    async def check(self, goal: Goal, scenes: Sequence[Scene]) -> Sequence[Verdict]:
        """Return one verdict per scene, in order.

        Raises:
            GoalError: If the goal asks for nothing that can be found.
        """
        answers = [
            Verdict(found=False, confidence=0.0, fault=scene.fault)
            if scene.fault is not None
            else verdict_on(goal.text, scene.text, self._senses)
            for scene in scenes
        ]
        faults = [answer.fault for answer in answers]
        await charge_calls(self._context, "checker", "embedded", [scene.key for scene in scenes], faults)
        return answers

    def _children(self, scene: Scene, count: int) -> list[Scene]:
        fault = (
            scene.fault if scene.fault is not None else None if scene.text.strip() else "the scene has no description"
        )
        depth = scene.depth + 1
        if fault is not None:
            return [Scene("", (*scene.key, child), scene.waypoint, depth, fault) for child in range(count)]
        # All views of a mission are imagined on with the same draws: their scores then differ by what is seen in them,
        # not by luck (common random numbers).
        draws = (scene.depth, *scene.key[_VIEW_KEY:])
        texts = imagine_texts(scene.text, seed=self._context.seed, key=draws, count=count, senses=self._senses)
        return [Scene(text, (*scene.key, child), scene.waypoint, depth) for child, text in enumerate(texts)]
