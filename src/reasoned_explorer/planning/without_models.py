"""Planners that ask no model: what a method that claims to reason must beat.

They read of a scene only what a robot without a language model could know: whether the way ahead is blocked, what kind
of ground leads ahead, and how many things stand where.
"""

from collections import Counter
from collections.abc import Sequence

from reasoned_explorer.minds.context import Minds
from reasoned_explorer.minds.embedded.lexicon import concepts
from reasoned_explorer.minds.embedded.reading import BACKGROUND, Mention, read_scene
from reasoned_explorer.model import Goal, Scene
from reasoned_explorer.model.draws import uniform
from reasoned_explorer.planning.planner import FrontierScore, Plan

EVEN_SCORE = 3.0

#: How gladly `FollowPaths` follows each ground: made for walking first, then open hard ground, then the rest. All are
#: near `EVEN_SCORE`, since a step's length depends on the score and these say nothing about how near the goal is; the
#: smallest gap, 0.1, outweighs σ(d) up to 55 m.
_PATH_SCORES = {
    "PAVEMENT": 3.4,
    "PATH": 3.4,
    "PLAZA": 3.3,
    "CYCLEWAY": 3.2,
    "STEPS": 3.2,
    "ROAD": 3.1,
    "PARKING": 3.0,
}
_NO_PATH_SCORE = 2.8

#: `ObjectDensity`: the score where nothing stands, what each thing in the fullest place adds, and at most how many
#: count. The same band as `FollowPaths`' scores, and for the same reasons.
_EMPTY_SCORE, _THING_SCORE, _MOST_THINGS = 2.8, 0.1, 6
_NO_THINGS = frozenset({"area", "background", "building", "generic", "ground", "quality", "scene", "structure"})

#: `RandomFrontier`: scores are drawn from so far below to so far above `EVEN_SCORE`, so that its mean step is that of
#: `NearestFrontier`.
_RANDOM_SPREAD = 0.3


class NearestFrontier:
    """Every frontier is as good as any other, so that the nearest is taken (Yamauchi, 1997)."""

    name = "nearest-frontier"
    label = "nearest-frontier [no model]"

    async def plan(self, goal: Goal, scenes: Sequence[Scene]) -> Plan:  # noqa: ARG002 - the protocol's
        """Return the same score for each scene."""
        return Plan(tuple(_score(scene, EVEN_SCORE) for scene in scenes))


class FollowPaths:
    """Prefer frontiers to which a way leads: pavement, path, plaza, then road."""

    name = "follow-paths"
    label = "follow-paths [no model]"

    async def plan(self, goal: Goal, scenes: Sequence[Scene]) -> Plan:  # noqa: ARG002 - the protocol's
        """Return a score by the ground that leads ahead."""
        return Plan(tuple(_score(scene, path_score(scene.text)) for scene in scenes))


class ObjectDensity:
    """Prefer frontiers where most things are mentioned close together, whatever they are and whatever is sought.

    Two things stand close together where a caption names them at the same distance and on the same side. Each mention
    counts once, "five trees" like "a tree"; ground, buildings and the background are no things.
    """

    name = "object-density"
    label = "object-density [no model]"

    async def plan(self, goal: Goal, scenes: Sequence[Scene]) -> Plan:  # noqa: ARG002 - the protocol's
        """Return a score by the number of things in each scene's fullest place."""
        return Plan(tuple(_score(scene, _density_score(scene.text)) for scene in scenes))


class RandomFrontier:
    """Every frontier's score is drawn, keyed by the mission's seed and the scene's key.

    Args:
        minds: Their seed is taken; they are not asked.
    """

    name = "random"
    label = "random [no model]"

    def __init__(self, minds: Minds) -> None:
        self._seed = minds.seed

    async def plan(self, goal: Goal, scenes: Sequence[Scene]) -> Plan:  # noqa: ARG002 - the protocol's
        """Return a random score for each scene, near that of `NearestFrontier`."""
        return Plan(tuple(_score(scene, self._draw(scene)) for scene in scenes))

    def _draw(self, scene: Scene) -> float:
        return EVEN_SCORE + _RANDOM_SPREAD * (2.0 * uniform(self._seed, "random planner", *scene.key) - 1.0)


def _density_score(text: str) -> float:
    places = Counter((m.distance, m.side) for m in read_scene(text).mentions if _is_thing(m))
    return _EMPTY_SCORE + _THING_SCORE * min(_MOST_THINGS, max(places.values(), default=0))


def _is_thing(mention: Mention) -> bool:
    if mention.negated or mention.distance == BACKGROUND:
        return False
    return mention.concept is None or concepts()[mention.concept].kind not in _NO_THINGS


def path_score(text: str) -> float:
    """Return how gladly a scene's text is followed, by the ground that it says leads ahead."""
    ground = read_scene(text).ground_ahead
    return _NO_PATH_SCORE if ground is None else _PATH_SCORES.get(ground, _NO_PATH_SCORE)


def _score(scene: Scene, q: float) -> FrontierScore:
    if scene.fault is not None:
        return FrontierScore(None, fault=scene.fault)
    return FrontierScore(q, blocked=read_scene(scene.text).blocked)
