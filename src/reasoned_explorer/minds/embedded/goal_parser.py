"""Reads a goal sentence: what is sought, what it must be near, which ground is wanted and which is shunned."""

import re
import unicodedata
from dataclasses import dataclass
from enum import StrEnum
from functools import lru_cache, partial

from reasoned_explorer.minds.embedded.affordances import affordances_in, cues_in, plain
from reasoned_explorer.minds.embedded.goal_sense import Denied, breaks_off, is_not_sought, takes_back
from reasoned_explorer.minds.embedded.goal_words import (
    ADJECTIVE_TAIL,
    CLAUSE_STARTS,
    CONTRACTIONS,
    FRAMES,
    GENERIC_HEADS,
    GROUND_PATTERNS,
    HERE,
    INTANGIBLE,
    NEAR_PATTERN,
    NEGATION_PATTERN,
    NP_END,
    PURPOSE,
    RELATION_OF,
    SMALL_TALK,
    STOP_WORDS,
    is_wordlike,
)
from reasoned_explorer.minds.embedded.lexicon import concepts, ground_words, mended_word, thing_phrases
from reasoned_explorer.model.errors import Fault, GoalError

#: Longer goals are no sentence.
MAX_GOAL_CHARACTERS = 500
_EXPECTED = 'a thing or a place that can be found outdoors, e.g. "Find me a bench near a tree"'


_PLACE_STARTS = frozenset(
    {"a", "the", "some", "any", "somewhere", "someplace", "anywhere", "where", "place", "something"}
)


class GoalKind(StrEnum):
    """What sort of thing a goal asks for."""

    OBJECT = "object"
    PLACE = "place"
    AFFORDANCE = "affordance"


@dataclass(frozen=True, slots=True)
class Phrase:
    """A noun phrase of a goal.

    Attributes:
        words: Its words without articles: ``"red mailbox"``.
        concept: Of its head in the lexicon, or None where the lexicon lacks it.
        adjectives: Words before the head.
    """

    words: str
    concept: str | None = None
    adjectives: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class NearClause:
    """What the sought thing must stand by.

    Attributes:
        relation: ``near``, ``under``, ``on``, ``in``, ``in_front`` or ``behind``.
        target: The other thing.
    """

    relation: str
    target: Phrase


@dataclass(frozen=True, slots=True)
class ParsedGoal:
    """What a goal sentence means.

    Attributes:
        text: The sentence as it was given.
        kind: Whether an object, a kind of place, or a place to do something is sought.
        sought: What is sought; any of the alternatives will do. Empty for an affordance alone.
        affordances: What one wants to do there, the main one first.
        activity: For an affordance, the words that ask for it.
        near: What the sought thing must stand by; all of them.
        wanted_ground: Names of the ground to stay on (of `world.taxonomy.Ground`), sorted.
        shunned_ground: Names of the ground to keep off, sorted.
        excluded: What is not meant ("not a trash can").
        absent: What must not be there ("without a roof", "no people").
    """

    text: str
    kind: GoalKind
    sought: tuple[Phrase, ...] = ()
    affordances: tuple[str, ...] = ()
    activity: str = ""
    near: tuple[NearClause, ...] = ()
    wanted_ground: tuple[str, ...] = ()
    shunned_ground: tuple[str, ...] = ()
    excluded: tuple[Phrase, ...] = ()
    absent: tuple[Phrase, ...] = ()


@lru_cache(maxsize=4096)
def parse_goal(text: str) -> ParsedGoal:
    """Return what a goal sentence means.

    Raises:
        GoalError: If it is empty, too long, breaks off, takes back what it says, or asks for nothing that can be found.
    """
    if not text.strip():
        raise GoalError("goal", [Fault("the goal is empty", _EXPECTED)])
    if len(text) > MAX_GOAL_CHARACTERS:
        what = f"the goal has {len(text)} characters"
        raise GoalError("goal", [Fault(what, f"one sentence of at most {MAX_GOAL_CHARACTERS} characters")])
    return _Parser(text).parse()


def _name(phrase: Phrase) -> str:
    return phrase.concept or phrase.words


def _denied_relation(said: str) -> str:
    """Return the relation that words like "not under" deny."""
    if re.search(r"\bnot (?:\w+ )?under\b", said):
        return "under"
    return "near" if re.search(r"\b(?:away from|far from|not (?:\w+ )?(?:near|close to|next to))\b", said) else "with"


def _normalised(text: str) -> str:
    text = unicodedata.normalize("NFKC", text).lower().replace("’", "'").replace("`", "'")
    for short, long in CONTRACTIONS:
        text = text.replace(short, long)
    text = re.sub(r"[.!?;:()\[\]\"“”/]+", " , ", text)
    text = re.sub(r"\s+(?:-|–|—)+\s+", " , ", text)
    text = re.sub(r"[^\w\s,'&-]", " ", text)
    text = re.sub(r"\s*,[\s,]*", " , ", text)
    return re.sub(r"\s+", " ", text).strip(" ,")


class _Parser:
    """Takes clause by clause out of a sentence until what is sought is left."""

    def __init__(self, text: str) -> None:
        self._text = text
        self._wanted: set[str] = set()
        self._shunned: set[str] = set()
        self._near: list[NearClause] = []
        self._excluded: list[Phrase] = []
        self._absent: list[Phrase] = []
        self._denied: list[Denied] = []

    def parse(self) -> ParsedGoal:
        whole = _normalised(self._text)
        clauses = [clause.strip() for clause in CLAUSE_STARTS.sub(" , ", whole).split(" , ") if clause.strip()]
        rest = " , ".join(clause for clause in map(self._without_ground, clauses) if clause)
        denial = is_not_sought(rest) or is_not_sought(whole)
        faults = [denial] if denial is not None else list(breaks_off(HERE.sub(" ", f" {whole} ").strip()))
        if faults:
            raise GoalError("goal", faults)
        rest = HERE.sub(" ", f" {rest} ").strip()
        rest = NEGATION_PATTERN.sub(self._take_negation, f" {rest} ").strip(" ,")
        frame, sought_text = _unframed(rest)
        sought, affordances, activity = self._sought(sought_text, frame)
        if not sought and not affordances and not activity:
            raise GoalError("goal", [Fault(f"{self._text!r} asks for nothing that can be found", self._expected())])
        faults = self._contradictions(sought)
        if faults:
            raise GoalError("goal", faults)
        kind = GoalKind.AFFORDANCE if not sought else GoalKind.OBJECT
        if sought and all(phrase.concept in _place_concepts() for phrase in sought):
            kind = GoalKind.PLACE
        return ParsedGoal(
            text=self._text,
            kind=kind,
            sought=sought,
            affordances=affordances,
            activity=activity,
            near=tuple(dict.fromkeys(self._near)),
            wanted_ground=tuple(sorted(self._wanted)),
            shunned_ground=tuple(sorted(self._shunned - self._wanted)),
            excluded=tuple(self._excluded),
            absent=tuple(self._absent),
        )

    def _expected(self) -> str:
        if self._wanted or self._shunned or self._near or self._excluded or self._absent:
            return f"what is to be found beside the conditions, {_EXPECTED}"
        return _EXPECTED

    def _contradictions(self, sought: tuple[Phrase, ...]) -> list[Fault]:
        near = [(clause.relation, _name(clause.target)) for clause in self._near if not clause.target.adjectives]
        faults = list(takes_back([_name(phrase) for phrase in sought], near, self._denied, text=self._text))
        if self._wanted and self._wanted <= self._shunned:
            names = ", ".join(sorted(self._wanted)).lower()
            faults.append(Fault(f"{names} is both to be kept to and to be avoided", "one of the two"))
        return faults

    # Conditions

    def _without_ground(self, clause: str) -> str:
        """Take the clauses about ground out of a clause."""
        for wanted, pattern in GROUND_PATTERNS:
            clause = pattern.sub(partial(self._take_ground, wanted=wanted), f" {clause} ")
        return " ".join(clause.split())

    def _take_ground(self, match: re.Match[str], *, wanted: bool) -> str:
        grounds, things, rest = _grounds_and_things(match["ground"])
        if not grounds and (wanted or not things):
            return match.group()
        if wanted:
            self._wanted |= grounds
        else:
            self._shunned |= grounds
            self._absent += things
        return f" {rest}" if rest else " "

    def _take_negation(self, match: re.Match[str]) -> str:
        phrases = _alternatives(match["what"])
        if not phrases:
            return " "
        plain = tuple(_name(phrase) for phrase in phrases if not phrase.adjectives)
        said = match.group().strip(" ,")
        relation = "" if match["not_that"] else _denied_relation(said)
        self._denied.append(Denied(said, plain, relation))
        if match["not_that"]:
            self._excluded += phrases
        else:
            self._absent += phrases
        return " "

    # What is sought

    def _sought(self, text: str, frame: str) -> tuple[tuple[Phrase, ...], tuple[str, ...], str]:
        """Return what is sought, or what one wants to do there and the words for it; all empty where it is nothing."""
        main, conditions = _split_near(text)
        wish = _WISH.search(frame) is not None
        names_thing = not _asks_to_do(main)
        noun = PURPOSE.split(main, maxsplit=1)[0] if names_thing else ""
        known = tuple(phrase for phrase in _alternatives(noun) if phrase.concept is not None)
        wanted = affordances_in(main)
        if known and not any(_is_part_of_a_cue(phrase, main) for phrase in known):
            self._near += conditions  # "a bench to sit on" is a bench; what one does there adds nothing
            return known, (), ""
        if not wanted and (wish or not names_thing):
            wanted = affordances_in(text)  # "look at a map": what looks like a condition belongs to the wish
            conditions = [] if wanted else conditions
        self._near += conditions
        if wanted:
            return (), wanted, _activity(main)
        place = self._place_by_its_things(main, framed=bool(frame))
        if place is not None:
            return (place,), (), ""
        if not wish:
            unfamiliar = _unfamiliar(noun)
            if unfamiliar and (frame or _short_noun(main)):
                return unfamiliar, (), ""
        activity = _activity(main)
        may_be_wish = wish or (not names_thing and (bool(frame) or main.split()[0] in _PLACE_STARTS))
        return ((), (), activity) if may_be_wish and _is_activity(activity) else ((), (), "")

    def _place_by_its_things(self, main: str, *, framed: bool) -> Phrase | None:
        """Return the thing of "a place with a fountain" or "somewhere near a fountain": that is what is sought."""
        if not self._near or not all(word in STOP_WORDS or word in GENERIC_HEADS for word in main.split()):
            return None
        clause = next((clause for clause in self._near if clause.relation == "with"), None)
        if clause is None and framed:
            clause = self._near[0]
        if clause is None:
            return None
        self._near.remove(clause)
        return clause.target


#: Frames after which a verb follows: "I want to …".
_WISH = re.compile(r"\b(?:want|like|love|need|have|wanted|require|must|trying) to$")


def _is_part_of_a_cue(phrase: Phrase, text: str) -> bool:
    """Tell whether a known thing is named only for what one wants to do with it: "hire a bike"."""
    head = plain(" ".join(phrase.words.split()[len(phrase.adjectives) :]))
    return any(cue.endswith(f" {head}") for cue in cues_in(text))


def _unfamiliar(noun: str) -> tuple[Phrase, ...]:
    """Return the things of a noun phrase that the lexicon lacks, or has under a spelling that is one slip away."""
    phrases = [
        phrase if phrase.concept is not None else _mended_phrase(phrase.words.split()) or phrase
        for phrase in _alternatives(noun)
    ]
    return tuple(phrase for phrase in phrases if phrase.concept is not None or _findable(phrase.words))


@lru_cache(maxsize=1)
def _place_concepts() -> frozenset[str]:
    return frozenset(n for n, c in concepts().items() if c.kind in {"place", "area", "scene", "building", "quality"})


def _unframed(text: str) -> tuple[str, str]:
    """Cut "could you please find me" and the like off; return what says that something is sought, and the rest."""
    frame = ""
    text = text.strip(" ,")
    while True:
        match = FRAMES.match(text)
        if match is None or match.end() == 0:
            return frame, text.strip(" ,")
        frame = (match["frame"] or frame).strip()
        text = text[match.end() :].strip(" ,")


def _split_near(text: str) -> tuple[str, list[NearClause]]:
    """Part what is sought from what it must stand by."""
    matches = list(NEAR_PATTERN.finditer(text))
    conditions = []
    if not matches:
        return text, []
    main = text[: matches[0].start()].strip(" ,")
    if not main:  # "near the fountain there is a bench, find it": too unusual to guess
        return text, []
    ends = [match.start() for match in matches[1:]] + [len(text)]
    for match, end in zip(matches, ends, strict=True):
        target_text = text[match.end() : end].partition(" , ")[0]
        relation = RELATION_OF[match["relation"]]
        parts = re.split(r"\s+and\s+", target_text) if relation in {"near", "with"} else [target_text]
        for part in parts:
            found = _unfamiliar(part)[:1]
            conditions += [
                NearClause(relation, phrase) for phrase in found if phrase.concept or _findable(phrase.words)
            ]
        if not conditions and relation in {"on", "in", "with"}:
            main = f"{main} {text[match.start() : end]}".strip()
    return main, conditions


def _alternatives(text: str) -> list[Phrase]:
    found = []
    for part in re.split(r"\s+(?:or|nor)\s+|\s+,\s+(?:or\s+)?", text):
        phrase = _phrase(part)
        if phrase is not None:
            found.append(phrase)
    return list(dict.fromkeys(found))


def _phrase(text: str) -> Phrase | None:
    """Return the noun phrase that a text starts with; its head is the last known thing before a preposition."""
    words = [word for word in text.split() if word != ","]
    while words and words[0] in STOP_WORDS:
        words.pop(0)
    if not words:
        return None
    return _known_phrase(words) or _unknown_phrase(words)


def _known_phrase(words: list[str]) -> Phrase | None:
    table = thing_phrases()
    place, head = 0, None
    while place < len(words):
        found = table.at(words, place)
        if found is not None:
            head = (place, *found)
            place += found[0]
        elif words[place] in NP_END:
            break
        else:
            place += 1
    if head is None:
        return None
    start, count, concept = head
    # A word behind the head makes another head of it: "tree house", "fountain pen".
    follower = words[start + count] if start + count < len(words) else None
    if (
        follower is not None
        and follower not in NP_END
        and follower not in STOP_WORDS
        and follower not in ADJECTIVE_TAIL
    ):
        return None
    adjectives = tuple(word for word in words[:start] if word not in STOP_WORDS)
    if any(word in SMALL_TALK for word in adjectives):
        adjectives = ()
    noun = " ".join(words[start : start + count])
    return Phrase(" ".join([*adjectives, noun]), concept, adjectives)


def _mended_phrase(words: list[str]) -> Phrase | None:
    mended = [mended_word(word) or word for word in words]
    return _known_phrase(mended) if mended != words else None


def _unknown_phrase(words: list[str]) -> Phrase | None:
    kept: list[str] = []
    for word in words:
        if word in NP_END:
            break
        kept.append(word)
    kept = [word for word in kept if word not in STOP_WORDS]
    if not kept or kept[-1] in GENERIC_HEADS:
        return None
    return Phrase(" ".join(kept[:6]), None, tuple(kept[:-1][:5]))


def _findable(words: str) -> bool:
    content = [word for word in words.split() if word not in STOP_WORDS and word not in GENERIC_HEADS]
    return (
        bool(content)
        and all(is_wordlike(word) for word in content)
        and not any(word in INTANGIBLE or word in SMALL_TALK for word in content)
    )


def _is_activity(words: str) -> bool:
    """Tell whether the content words of a wish could be something that one does somewhere."""
    content = words.split()
    return any(is_wordlike(word) and word not in SMALL_TALK and word not in INTANGIBLE for word in content) and not any(
        not is_wordlike(word) and len(word) > 3 for word in content
    )


def _short_noun(text: str) -> bool:
    words = text.split()
    return 0 < len(words) <= 3 and not any(word in SMALL_TALK for word in words) and len(words[-1]) > 3


def _asks_to_do(text: str) -> bool:
    """Tell whether a text names no thing but what one wants to do: "somewhere to …", "where can i …"."""
    return bool(re.match(r"(?:(?:a|an|the|some|any|good|nice|quiet|safe|shady|sunny|dry|cool|warm|close|next|[\w-]+ly|"
                         r"comfortable|cosy|cozy|pretty|beautiful|calm|peaceful|suitable|great|proper|decent) )*"
                         r"(?:somewhere|someplace|anywhere|where|place|places|spot|spots|area|location|something|"
                         r"anything|"
                         r"thing|way|to|i|we|my|our|me|us)\b", text))  # fmt: skip


def _activity(text: str) -> str:
    words = [word for word in text.split() if word not in STOP_WORDS and word not in GENERIC_HEADS and word != ","]
    return " ".join(words[:12])


def _grounds_and_things(text: str) -> tuple[set[str], list[Phrase], str]:
    """Read a list of grounds, e.g. "the grass and any road"; return them, what is no ground, and what comes after."""
    grounds: set[str] = set()
    things: list[Phrase] = []
    table = ground_words()
    words = text.split()
    place = 0
    while place < len(words):
        if words[place] in {
            "and",
            "or",
            "nor",
            "the",
            "a",
            "an",
            "any",
            "all",
            "this",
            "that",
            "of",
            "on",
            "onto",
            "its",
        }:
            place += 1
            continue
        for count in (3, 2, 1):
            hit = table.get(" ".join(words[place : place + count])) if place + count <= len(words) else None
            compound = thing_phrases().at(words, place) if hit is not None else None
            if compound is not None and compound[0] > count:
                hit = None  # a street sign is no street
            if hit is not None:
                grounds |= hit
                place += count
                break
        else:
            if place + 1 < len(words) and words[place + 1] in table and words[place] not in NP_END:
                place += 1  # an adjective: "wet grass"
                continue
            break
    rest = words[place:]
    if not grounds:
        things = [p for p in _alternatives(" ".join(rest).replace(" and ", " or ")) if p.concept]
        return grounds, things, ""
    while rest and rest[0] in {"only", "please", "there", "always", "itself", "instead", "though", "all", "at", "time"}:
        rest.pop(0)
    return grounds, things, " ".join(rest)
