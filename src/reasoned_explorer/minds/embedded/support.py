"""Does a caption support what a goal says about where the sought thing stands?"""

from reasoned_explorer.minds.embedded.reading import Mention, SceneReading
from reasoned_explorer.minds.embedded.relevance import Relevance, Target

#: What a caption may say for what a goal says.
_MEANS = {
    "near": frozenset({"near", "under", "over", "in_front", "behind", "on", "in", "has", "with"}),
    "with": frozenset({"near", "under", "over", "in_front", "behind", "on", "in", "has", "with"}),
    "under": frozenset({"under", "in"}),
    "on": frozenset({"on", "in"}),
    "in": frozenset({"in", "on", "near", "with"}),
    "in_front": frozenset({"in_front", "near"}),
    "behind": frozenset({"behind"}),
}
_LOOSE = frozenset({"near", "with"})


def target_support(mention: Mention, reading: SceneReading, target: Target) -> float:
    """Return how far a caption supports one condition on a mentioned thing, in [0, 1].

    Stated outright it is 1. A target that stands about as far away makes "near" likely and "under" possible; one that
    is somewhere else in the picture makes little likely.
    """
    means = _MEANS[target.relation]
    # An umbrella table is shady by itself; nothing stands next to itself.
    best = target.degrees.get(mention.concept or "", 0.0) if target.relation == "with" else 0.0
    for relation, other in mention.relations:
        degree = target.degrees.get(other, 1.0 if other == target.words else 0.0)
        if degree >= 0.4:
            best = max(best, degree if relation in means else 0.3 * degree)
    if best >= 1.0:
        return best
    loose = target.relation in _LOOSE
    for other_mention in reading.mentions:
        if other_mention is mention or other_mention.negated:
            continue
        degree = _target_degree(other_mention, target)
        if degree < 0.4:
            continue
        if other_mention.distance == mention.distance:
            same_side = other_mention.side is None or mention.side is None or other_mention.side == mention.side
            share = (0.7 if loose else 0.4) if same_side else (0.5 if loose else 0.25)
        else:
            share = 0.2
        best = max(best, degree * share)
    return best


def _target_degree(mention: Mention, target: Target) -> float:
    if mention.concept is not None and mention.concept in target.degrees:
        return target.degrees[mention.concept]
    return 1.0 if mention.words == target.words else 0.0


def conditions_support(mention: Mention, reading: SceneReading, relevance: Relevance) -> float:
    """Return how far a caption supports all conditions on a mentioned thing: the weakest decides."""
    support = 1.0
    for target in relevance.targets:
        support = min(support, target_support(mention, reading, target))
    if relevance.absent:
        for other in reading.mentions:
            if other is mention or other.negated or other.concept is None or other.distance != mention.distance:
                continue
            support = min(support, 1.0 - 0.8 * relevance.absent.get(other.concept, 0.0))
    return support
