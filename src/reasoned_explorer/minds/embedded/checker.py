"""Is the goal in a scene, within reach? Asks for evidence of the thing itself; being alike is not enough."""

from functools import lru_cache

from reasoned_explorer.minds.embedded.affordances import SERVES
from reasoned_explorer.minds.embedded.lexicon import ground_words, word_set
from reasoned_explorer.minds.embedded.reading import BACKGROUND, FAR, MIDDLE, NEAR, Mention, SceneReading, read_scene
from reasoned_explorer.minds.embedded.relevance import Relevance, Senses, relevance_of
from reasoned_explorer.minds.embedded.support import conditions_support
from reasoned_explorer.model import Verdict

#: From this confidence on the goal counts as found.
FOUND_FROM = 0.5
#: How sure one is that a thing is within reach, by how far away it is said to be. Captions that say nothing of distance
#: are about what fills the picture, more often than not.
_WITHIN_REACH = {NEAR: 0.95, None: 0.65, MIDDLE: 0.3, FAR: 0.08, BACKGROUND: 0.04}
#: What a picture is of ("a grassy area", "grass lies ahead") is ground, and not yet the lawn that one would stop at:
#: that is said to be close by, like any other thing.
_UNDERFOOT = 0.5
_SIDES = {-1: "to the left", 0: "ahead", 1: "to the right"}
_DISTANCES = {NEAR: "close by", MIDDLE: "further on", FAR: "in the distance", BACKGROUND: "in the background"}
_COLOURS = word_set("colours")
_MATERIALS = word_set("materials")


def _adjectives_share(mention: Mention, relevance: Relevance) -> float:
    """Return what the adjectives of the goal leave: said otherwise is worse than not said."""
    share = 1.0
    said = set(mention.words.split())
    for phrase in relevance.goal.sought:
        if phrase.concept is None:
            continue
        for adjective in phrase.adjectives:
            if adjective in said:
                continue
            family = _COLOURS if adjective in _COLOURS else _MATERIALS if adjective in _MATERIALS else frozenset()
            share = min(share, 0.45 if family & said else 0.85)
    return share


def _on_shunned(mention: Mention, relevance: Relevance) -> bool:
    return any(
        relation in {"on", "in"} and ground_words().get(other.replace("_", " "), frozenset()) & relevance.shunned
        for relation, other in mention.relations
    )


def _is_ground(mention: Mention) -> bool:
    return mention.concept is not None and mention.concept.replace("_", " ") in ground_words()


def confidence_in(mention: Mention, reading: SceneReading, relevance: Relevance) -> float:
    """Return how sure one is that a mentioned thing is the goal and within reach, in [0, 1]."""
    degree = relevance.degree(mention)
    if mention.negated or degree < SERVES:
        return 0.0
    confidence = _WITHIN_REACH[mention.distance] * degree * _adjectives_share(mention, relevance)
    if relevance.targets or relevance.absent:
        support = conditions_support(mention, reading, relevance)
        confidence *= 0.25 + 0.75 * min(1.0, support / 0.9)
    if mention.distance is None and _is_ground(mention):
        confidence *= _UNDERFOOT
    if relevance.shunned and _on_shunned(mention, relevance):
        confidence *= 0.5
    return confidence


def _evidence(mention: Mention) -> str:
    parts = [mention.words]
    parts += [_DISTANCES[mention.distance]] if mention.distance is not None else []
    parts += [_SIDES[mention.side]] if mention.side is not None else []
    parts += [f"{relation.replace('_', ' ')} {other.replace('_', ' ')}" for relation, other in mention.relations]
    return ", ".join(parts)


@lru_cache(maxsize=65536)
def verdict_on(goal_text: str, scene_text: str, senses: Senses) -> Verdict:
    """Return whether the goal is in a scene's text, within reach.

    Raises:
        GoalError: If the goal asks for nothing that can be found.
    """
    relevance = relevance_of(goal_text, senses)
    if not scene_text.strip():
        return Verdict(found=False, confidence=0.0, fault="the scene has no description")
    reading = read_scene(scene_text)
    best, evidence = 0.0, ""
    for mention in reading.mentions:
        confidence = confidence_in(mention, reading, relevance)
        if confidence > best:
            best, evidence = confidence, _evidence(mention)
    return Verdict(found=best >= FOUND_FROM, confidence=round(best, 4), evidence=evidence)
