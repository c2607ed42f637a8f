"""What everything that a caption can speak of means for one goal: worked out once, then looked up.

Three sources: likeness (is this what is sought?), place statistics and scene knowledge (does it stand where such things
stand?), and, where installed, sentence embeddings for words that the lexicon lacks.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cache, lru_cache

from reasoned_explorer.knowledge.cooccurrence import Cooccurrence
from reasoned_explorer.minds.embedded.affordances import affordances
from reasoned_explorer.minds.embedded.embedding import PhraseEmbedder
from reasoned_explorer.minds.embedded.goal_parser import ParsedGoal, Phrase, parse_goal
from reasoned_explorer.minds.embedded.lexicon import ancestors, concepts, data_lines, likeness
from reasoned_explorer.minds.embedded.reading import BACKGROUND, FAR, MIDDLE, NEAR, Mention, SceneReading, read_scene
from reasoned_explorer.minds.embedded.scene_types import expectations

#: Log lifts count for this share of themselves and at most this much: neighbours are no independent witnesses.
_SHRINK, _LOG_LIFT_CAP = 0.6, 1.5
#: What scene knowledge counts beside statistics: it is assumed.
_ASSUMED_SHARE = 0.7
#: Spread of the context over the bank below which differences mean nothing.
_LEAST_SPREAD = 0.25
#: How much a thing says about what lies ahead, by its distance.
_CONTEXT_WEIGHT = {NEAR: 0.7, MIDDLE: 1.0, None: 0.8, FAR: 0.7, BACKGROUND: 0.35}
#: Grass may be a lawn or a verge; of what a lawn is good for, this much is left where a caption only says "grass".
_VERGE = 0.7
#: Cosines of phrases: from here on something, up to here something more.
_LIKE_FROM, _LIKE_TO = 0.40, 0.80
_ACTIVITY_FROM, _ACTIVITY_TO = 0.20, 0.50


@dataclass(frozen=True, slots=True, eq=False)
class Senses:
    """What the embedded minds know and can; compared by identity.

    Attributes:
        statistics: Of real places; None for minds that know none.
        embedder: Where MiniLM is installed; None for words and lexicon only.
        scene_knowledge: Whether scene types tell what to expect.
    """

    statistics: Cooccurrence | None = None
    embedder: PhraseEmbedder | None = None
    scene_knowledge: bool = True


@dataclass(frozen=True, slots=True, eq=False)
class Target:
    """What the sought thing must stand by.

    Attributes:
        relation: As in `NearClause`; ``with`` for a quality of the place ("in the shade").
        words: What it is called.
        degrees: Concepts and how far each is it.
    """

    relation: str
    words: str
    degrees: Mapping[str, float]


@dataclass(frozen=True, slots=True, eq=False)
class Relevance:
    """What is worth what for one goal.

    Attributes:
        goal: What was parsed.
        senses: What it was worked out with.
        degrees: Concepts and how far each is what is sought, in (0, 1].
        unknown: Sought phrases that the lexicon lacks.
        context: Concepts and the shrunk log lift of what is sought near them.
        ground: Names of ground likewise.
        targets: What the sought thing must stand by; all of them.
        absent: Concepts that must not be there, and how far each is one.
        wanted: Names of ground to stay on.
        shunned: Names of ground to keep off.
        mean: Of the context over the bank of background scenes.
        spread: Its standard deviation there.
    """

    goal: ParsedGoal
    senses: Senses
    degrees: Mapping[str, float]
    unknown: tuple[Phrase, ...]
    context: Mapping[str, float]
    ground: Mapping[str, float]
    targets: tuple[Target, ...]
    absent: Mapping[str, float]
    wanted: frozenset[str]
    shunned: frozenset[str]
    mean: float = 0.0
    spread: float = 1.0
    _by_words: dict[str, float] = field(default_factory=dict, init=False)

    def degree(self, mention: Mention) -> float:
        """Return how far a mentioned thing is what is sought, in [0, 1]."""
        if mention.concept is not None:
            known = self.degrees.get(mention.concept, 0.0)
            if mention.words == "grass" and not self.goal.sought:
                return known * _VERGE
            if known or not self.unknown:
                return known
        elif not self.unknown and self.senses.embedder is None:
            return 0.0
        known_words = self._by_words.get(mention.words)
        if known_words is None:
            known_words = self._by_words[mention.words] = self._degree_of_words(mention)
        return known_words

    def _degree_of_words(self, mention: Mention) -> float:
        sought = self.unknown or tuple(phrase for phrase in self.goal.sought)
        best = max((_word_overlap(phrase.words, mention.words) for phrase in sought), default=0.0)
        embedder = self.senses.embedder
        if embedder is None or best >= 1.0:
            return best
        noun = mention.words if mention.concept is None else concepts()[mention.concept].noun
        for phrase in sought:
            share = (embedder.likeness(phrase.words, noun) - _LIKE_FROM) / (_LIKE_TO - _LIKE_FROM)
            best = max(best, min(1.0, max(0.0, share)) * 0.9)
        return best

    def context_of(self, reading: SceneReading) -> float:
        """Return what the surroundings speak for finding the goal a bit further on: log odds, more is better."""
        total, seen = 0.0, set()
        context = self.context
        for mention in reading.mentions:
            concept = mention.concept
            if mention.negated or concept is None or concept in seen:
                continue
            seen.add(concept)
            lift = context.get(concept)
            if lift is not None:
                total += lift * _CONTEXT_WEIGHT[mention.distance]
        # Neighbours of neighbours tell the same thing again and again.
        total /= 1.0 + 0.2 * len(seen)
        ground = reading.ground_ahead or reading.ground_here
        if ground is not None:
            total += self.ground.get(ground, 0.0)
        for target in self.targets:
            total += 0.8 * max((target.degrees.get(concept, 0.0) for concept in seen), default=0.0)
        return total

    def standard_context(self, reading: SceneReading) -> float:
        """Return the context in standard deviations of the bank, so that goals can be compared."""
        return (self.context_of(reading) - self.mean) / self.spread


def _word_overlap(sought: str, seen: str) -> float:
    """Return 1 where the heads are the same word and the sought adjectives are there, less for less."""
    ours, theirs = [_stem(word) for word in sought.split()], [_stem(word) for word in seen.split()]
    common = len(set(ours) & set(theirs))
    if not common:
        return 0.0
    share = common / len(set(ours))
    return 0.6 + 0.4 * share if ours[-1] == theirs[-1] else 0.4 * share


def _stem(word: str) -> str:
    for ending, instead in (("ies", "y"), ("ches", "ch"), ("shes", "sh"), ("sses", "ss"), ("xes", "x")):
        if word.endswith(ending) and len(word) > len(ending) + 2:
            return word[: -len(ending)] + instead
    return word[:-1] if word.endswith("s") and not word.endswith("ss") and len(word) > 3 else word


@cache
def _alike(concept: str) -> dict[str, float]:
    """Return every concept that is, or is partly, a given one."""
    return {name: degree for name in concepts() if (degree := likeness(concept, name)) > 0.0}


@cache
def _serving(affordance: str) -> dict[str, float]:
    """Return every concept that serves an affordance; what serves for a family serves for its members."""
    listed = dict(affordances()[affordance].strengths)
    found = {}
    for name in concepts():
        inherited = max((listed.get(parent, 0.0) for parent in ancestors(name)), default=0.0)
        degree = listed.get(name, inherited)
        if degree > 0.0:
            found[name] = degree
    return found


def _activity_degrees(activity: str, embedder: PhraseEmbedder | None) -> dict[str, float]:
    """Return what serves an activity that no cue names: that of the affordance whose words are most like it."""
    if embedder is None or not activity:
        return {}
    graded = sorted(
        (
            (-max(embedder.likeness(activity, cue) for cue in affordance.cues[:3]), name)
            for name, affordance in affordances().items()
        ),
    )
    best, name = graded[0]
    trust = min(1.0, max(0.0, (-best - _ACTIVITY_FROM) / (_ACTIVITY_TO - _ACTIVITY_FROM)))
    return {concept: degree * trust for concept, degree in _serving(name).items()} if trust > 0.0 else {}


def _phrase_degrees(phrase: Phrase) -> dict[str, float]:
    return dict(_alike(phrase.concept)) if phrase.concept is not None else {}


def _degrees(goal: ParsedGoal, senses: Senses) -> dict[str, float]:
    found: dict[str, float] = {}
    for phrase in goal.sought:
        for concept, degree in _phrase_degrees(phrase).items():
            found[concept] = max(found.get(concept, 0.0), degree)
    if not goal.sought and goal.affordances:
        found = dict(_serving(goal.affordances[0]))
    elif not goal.sought:
        found = _activity_degrees(goal.activity, senses.embedder)
    for phrase in goal.excluded:
        if phrase.concept is not None:
            for concept in [name for name, degree in _alike(phrase.concept).items() if degree == 1.0]:
                found.pop(concept, None)
    return found


def _log_lift(lift: float) -> float:
    return max(-_LOG_LIFT_CAP, min(_LOG_LIFT_CAP, math.log(max(lift, 1e-6)) * _SHRINK))


def _pair_lift(given: str, wanted: str, senses: Senses) -> float | None:
    """Return the shrunk log lift of one concept given another, from statistics where there are any."""
    if senses.statistics is not None:
        near, ahead = senses.statistics.lift(given, wanted), senses.statistics.lift_ahead(given, wanted)
        if near != 1.0 or ahead != 1.0:
            return 0.5 * (_log_lift(near) + _log_lift(ahead))
    if senses.scene_knowledge:
        odds = expectations().get(given, {}).get(wanted)
        if odds is not None:
            return max(-_LOG_LIFT_CAP, min(_LOG_LIFT_CAP, odds * _ASSUMED_SHARE))
    return None


def _context(degrees: Mapping[str, float], senses: Senses) -> tuple[dict[str, float], dict[str, float]]:
    """Return shrunk log lifts of what is sought given each concept and each ground."""
    density = senses.statistics.density_per_km2 if senses.statistics is not None else {}
    # What serves better and what stands more often is more of what one will find.
    weights = {
        name: degree * degree * math.sqrt(density.get(name, 10.0)) for name, degree in degrees.items() if degree >= 0.5
    }
    total = math.fsum(weights.values())
    context: dict[str, float] = {}
    ground: dict[str, float] = {}
    if total == 0.0:
        return context, ground
    for given in concepts():
        lifts = [(weight, _pair_lift(given, wanted, senses)) for wanted, weight in weights.items()]
        value = math.fsum(weight * lift for weight, lift in lifts if lift is not None) / total
        if value != 0.0:
            context[given] = value
    if senses.statistics is not None:
        from_names = {concept.ground for concept in concepts().values() if concept.ground is not None}
        for name in sorted(from_names):
            # 1 is also the answer for a class that was never counted.
            lifts_here = [(w, senses.statistics.ground_lift(name.lower(), wanted)) for wanted, w in weights.items()]
            ground[name] = 0.5 * math.fsum(weight * _log_lift(lift) for weight, lift in lifts_here) / total
    return context, ground


def _targets(goal: ParsedGoal) -> tuple[Target, ...]:
    found = [Target(clause.relation, clause.target.words, _phrase_degrees(clause.target)) for clause in goal.near]
    if not goal.sought:
        found += [Target("with", name, _serving(name)) for name in goal.affordances[1:]]
    return tuple(found)


@cache
def _bank() -> tuple[SceneReading, ...]:
    return tuple(read_scene(line) for line in data_lines("background_scenes"))


@lru_cache(maxsize=512)
def relevance_of(goal_text: str, senses: Senses) -> Relevance:
    """Return what everything means for a goal, standardised against the bank of background scenes.

    Raises:
        GoalError: If the goal asks for nothing that can be found.
    """
    goal = parse_goal(goal_text)
    degrees = _degrees(goal, senses)
    context, ground = _context(degrees, senses)
    absent: dict[str, float] = {}
    for phrase in goal.absent:
        for concept, degree in _phrase_degrees(phrase).items():
            absent[concept] = max(absent.get(concept, 0.0), degree)
    raw = Relevance(
        goal=goal,
        senses=senses,
        degrees=degrees,
        unknown=tuple(phrase for phrase in goal.sought if phrase.concept is None),
        context=context,
        ground=ground,
        targets=_targets(goal),
        absent=absent,
        wanted=frozenset(goal.wanted_ground),
        shunned=frozenset(goal.shunned_ground),
    )
    values = [raw.context_of(reading) for reading in _bank()]
    mean = math.fsum(values) / len(values)
    spread = math.sqrt(math.fsum((value - mean) ** 2 for value in values) / len(values))
    return replace(raw, mean=mean, spread=max(spread, _LEAST_SPREAD))
