"""Fresh-Ground (ours): go for what is seen; where nothing is, walk far, and rather where nobody was yet.

LLM-as-Eval with three changes against what was measured of how the paper's methods lose missions: they seldom come
near the goal at all. What each change is worth with the embedded minds stands in docs/log.md; ``hint`` and
``step_max_m`` were shown to help, ``views`` is a trade, and that ``known_radius_m`` helps was not shown.

- *Hints count little* (``hint``). An evaluator that has not seen the thing itself guesses from the surroundings, and
  since distance costs nothing up to 50 m, one level between two guesses is enough to go back for. Scores below 4 are
  drawn together; from 4 on, where the thing is in sight, they stand. The same guesses then no longer outweigh that
  ground is known (``known_radius_m``): the paper's Q - σ(d) does not know where the robot was, and fills a yard with
  legs 10 m apart. What lies near an earlier leg costs 0.5.
- *Walk where nothing is in sight* (``step_max_m``). To stop, describe and score takes as long as 20 to 30 m of way, and
  captions tell of things farther off than the next stop. Steps towards what is in sight stay short.
- *Look nearly all round* (``views``): the way out of a yard, and what one has just passed, is as often behind as ahead.

Nothing is imagined: the embedded visionary's scenes only dilute what is seen, and a step waits for it. A step makes 5
captions, 5 evaluator and 5 checker calls, against LLM-RRT's 3, 18, 3 and 18 of the visionary.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

from reasoned_explorer.minds.context import Minds
from reasoned_explorer.model import Fault, Goal, Scene, SettingsError
from reasoned_explorer.planning.llm_rrt import frontier_score, is_number, worth
from reasoned_explorer.planning.planner import FrontierScore, ImaginedNode, Plan

#: Up to here a score is a guess from the surroundings, from there on the thing itself is in sight.
_GUESSED, _SEEN = 3.0, 4.0
#: Where guesses are drawn to.
_MIDDLE_GUESS = 2.0
_VIEW_GAP_RAD = math.radians(60.0)


@dataclass(frozen=True, slots=True)
class FreshGroundSettings:
    """What the planner changes, each to be switched off on its own.

    Attributes:
        hint: What one level of difference between guesses counts for, 0 to 1; 1 leaves scores as they are. Below 0.5,
            which is what known ground costs, no guess outweighs it.
        known_radius_m: How near to an earlier leg ground is known, metres, 0 to 50; 0 leaves the paper's Q - σ(d).
        step_max_m: Longest step, metres, 10 to 200; 20 is the paper's for levels 1, 2 and 4.
        views: Of a look, 60° apart, 1 to 6; 3 are the paper's.
    """

    hint: float = 0.4
    known_radius_m: float = 25.0
    step_max_m: float = 30.0
    views: int = 5

    def __post_init__(self) -> None:
        ranges = (
            ("hint", self.hint, 0, 1),
            ("known_radius_m", self.known_radius_m, 0, 50),
            ("step_max_m", self.step_max_m, 10, 200),
        )
        faults = [
            Fault(f"{name} is {value!r}", f"a number from {low} to {high}")
            for name, value, low, high in ranges
            if not is_number(value, int | float) or not low <= value <= high  # NaN is refused, too
        ]
        if not is_number(self.views, int) or not 1 <= self.views <= 6:
            faults.append(Fault(f"views is {self.views!r}", "a whole number from 1 to 6"))
        if faults:
            raise SettingsError("Fresh-Ground settings", faults)

    def weighed(self, score: float) -> float:
        """Return what a score counts for: guesses drawn together, what is seen as it is, in between a straight line."""
        if score >= _SEEN:
            return score
        guess = _MIDDLE_GUESS + self.hint * (score - _MIDDLE_GUESS)
        top = _MIDDLE_GUESS + self.hint * (_GUESSED - _MIDDLE_GUESS)
        return max(guess, _SEEN - (_SEEN - top) * (_SEEN - score) / (_SEEN - _GUESSED))


class FreshGround:
    """The planner.

    Args:
        minds: Who scores; the visionary is not asked.
        settings: What is changed.
        name: As registered.
    """

    def __init__(
        self, minds: Minds, settings: FreshGroundSettings | None = None, *, name: str = "fresh-ground"
    ) -> None:
        self._minds = minds
        self.settings = settings or FreshGroundSettings()
        self.name = name
        self.label = f"{name} [{minds.label}]"
        self.explorer = {
            "known_radius_m": self.settings.known_radius_m,
            "step_max_m": self.settings.step_max_m,
            "views": self.settings.views,
            "sweep_rad": _VIEW_GAP_RAD * (self.settings.views - 1),
        }

    async def plan(self, goal: Goal, scenes: Sequence[Scene]) -> Plan:
        """Return the weighed score of each scene; the tree holds the evaluator's own answers."""
        described = [scene for scene in scenes if scene.fault is None]
        answers = await self._minds.evaluator.evaluate(goal, described) if described else ()
        tree = tuple(ImaginedNode(scene, answer) for scene, answer in zip(described, answers, strict=True))
        by_key = {node.scene.key: node for node in tree}
        return Plan(tuple(self._score(scene, by_key.get(scene.key)) for scene in scenes), tree)

    def _score(self, scene: Scene, node: ImaginedNode | None) -> FrontierScore:
        if node is None:
            return FrontierScore(None, fault=scene.fault)
        score = worth(node.assessment)
        return frontier_score(None if score is None else self.settings.weighed(score), [node])
