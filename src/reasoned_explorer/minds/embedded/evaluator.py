"""How promising a described scene is for a goal: V(G, S)."""

import math
from functools import lru_cache

from reasoned_explorer.minds.embedded.reading import AHEAD, BACKGROUND, FAR, MIDDLE, NEAR, SceneReading, read_scene
from reasoned_explorer.minds.embedded.relevance import Relevance, Senses, relevance_of
from reasoned_explorer.minds.embedded.support import conditions_support
from reasoned_explorer.model import Assessment, likert_from_score

#: How sure one gets of having the thing a step further on, by how far away it is said to be.
_SEEN = {NEAR: 1.0, None: 0.85, MIDDLE: 0.85, FAR: 0.6, BACKGROUND: 0.45}
#: Of a score, what not knowing whether a condition holds leaves.
_UNCONFIRMED = 0.45
#: Surroundings alone reach from 1 to this level; only evidence of the thing itself reaches further.
_CONTEXT_TOP = 3.2


def evidence_of(reading: SceneReading, relevance: Relevance) -> float:
    """Return how far a caption shows what is sought itself, in [0, 1]."""
    best = second = 0.0
    degree_of = relevance.degree
    for mention in reading.mentions:
        if mention.negated:
            continue
        degree = degree_of(mention)
        if degree <= 0.0:
            continue
        value = degree * _SEEN[mention.distance]
        if mention.side is not None and mention.side != AHEAD:
            value *= 0.95
        if relevance.targets or relevance.absent:
            value *= _UNCONFIRMED + (1.0 - _UNCONFIRMED) * conditions_support(mention, reading, relevance)
        if value > best:
            best, second = value, best
        elif value > second:
            second = value
    # A second chance in view helps a little.
    return best + (1.0 - best) * 0.15 * second


def level_of(reading: SceneReading, relevance: Relevance) -> float:
    """Return the expected level of a caption for a goal, in [1, 5]."""
    context = 1.0 / (1.0 + math.exp(-1.2 * relevance.standard_context(reading)))
    level = 1.0 + (_CONTEXT_TOP - 1.0) * context
    level += (5.0 - level) * evidence_of(reading, relevance)
    share = _ground_share(reading, relevance)
    if reading.blocked:
        share *= 0.4
    return 1.0 + (level - 1.0) * share


def _ground_share(reading: SceneReading, relevance: Relevance) -> float:
    """Return what the ground ahead leaves of a score, in (0, 1]."""
    ahead = reading.ground_ahead
    if relevance.shunned:
        if ahead in relevance.shunned:
            return 0.4
        if ahead is None and reading.ground_here in relevance.shunned:
            return 0.7
    if relevance.wanted:
        if ahead is not None:
            return 1.0 if ahead in relevance.wanted else 0.6
        sides = {reading.ground_left, reading.ground_right, reading.ground_here}
        return 0.9 if sides & relevance.wanted else 0.75
    return 1.0


def _likert(level: float) -> tuple[float, float, float, float, float]:
    """Return the answer on the scale: the nearest level, half a level up.

    Answers finer than the scale would be false precision. They matter: the agent compares Q − σ(d), so that a hundredth
    of a level, which here means nothing, would send it 50 m back.
    """
    return likert_from_score(math.floor(level + 0.5))


@lru_cache(maxsize=65536)
def assess(goal_text: str, scene_text: str, senses: Senses) -> Assessment:
    """Return the assessment of a scene's text for a goal.

    Raises:
        GoalError: If the goal asks for nothing that can be found.
    """
    relevance = relevance_of(goal_text, senses)
    if not scene_text.strip():
        return Assessment(None, fault="the scene has no description")
    reading = read_scene(scene_text)
    return Assessment(
        _likert(level_of(reading, relevance)),
        blocked=reading.blocked,
        forbidden=reading.ground_ahead is not None and reading.ground_ahead in relevance.shunned,
    )
