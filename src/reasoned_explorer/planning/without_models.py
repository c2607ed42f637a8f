"""Planners that ask no model: what a method that claims to reason must beat.

They read of a scene only what a robot without a language model could know: whether the way ahead is blocked, and what
kind of ground leads ahead.
"""

from collections.abc import Sequence

from reasoned_explorer.minds.embedded.reading import read_scene
from reasoned_explorer.model import Goal, Scene
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


def path_score(text: str) -> float:
    """Return how gladly a scene's text is followed, by the ground that it says leads ahead."""
    ground = read_scene(text).ground_ahead
    return _NO_PATH_SCORE if ground is None else _PATH_SCORES.get(ground, _NO_PATH_SCORE)


def _score(scene: Scene, q: float) -> FrontierScore:
    if scene.fault is not None:
        return FrontierScore(None, fault=scene.fault)
    return FrontierScore(q, blocked=read_scene(scene.text).blocked)
