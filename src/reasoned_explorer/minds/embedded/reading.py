"""Reads a caption: what is said to be where.

Text is data: a sentence that holds orders to a reader holds no things, and so says nothing.
"""

import re
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache, lru_cache
from typing import Any

from reasoned_explorer.minds.embedded.lexicon import concepts, plurals
from reasoned_explorer.minds.embedded.wording import (
    AHEAD,
    BACKGROUND,
    FAR,
    LEFT,
    MIDDLE,
    NEAR,
    RIGHT,
    Meaning,
    caption_phrases,
)

__all__ = ["AHEAD", "BACKGROUND", "FAR", "LEFT", "MIDDLE", "NEAR", "RIGHT", "Mention", "SceneReading", "read_scene"]


@dataclass(frozen=True, slots=True)
class Mention:
    """One thing that a caption speaks of.

    Attributes:
        concept: Its name in the lexicon, or None where the words are unknown.
        words: What it is called, adjectives included: ``"tall white lighthouse"``.
        distance: `NEAR` (up to about 10 m), `MIDDLE` (about 25 m), `FAR`, `BACKGROUND`, or None where nothing is said.
        side: `LEFT`, `AHEAD`, `RIGHT`, or None where nothing is said.
        negated: It is said not to be there.
        count: 1, 2 for two or some, 3 for many.
        relations: Pairs of a relation (``near``, ``under``, ``over``, ``in_front``, ``behind``, ``on``, ``in``,
        ``has``,
            ``with``) and the concept, or the words, of the other thing.
    """

    concept: str | None
    words: str
    distance: int | None = None
    side: int | None = None
    negated: bool = False
    count: int = 1
    relations: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True, slots=True)
class SceneReading:
    """What a caption says.

    Attributes:
        mentions: Things in the order of the text.
        ground_ahead: Name of the ground straight ahead (of `world.taxonomy.Ground`), or None.
        ground_left: To the left.
        ground_right: To the right.
        ground_here: What the scene is said to be on or of, where no direction is given.
        blocked: The way ahead is said to be blocked.
    """

    mentions: tuple[Mention, ...] = ()
    ground_ahead: str | None = None
    ground_left: str | None = None
    ground_right: str | None = None
    ground_here: str | None = None
    blocked: bool = False


_SENTENCES = re.compile(r"[.!?\n]+(?:\s+|$)")
#: A sentence that speaks to whoever reads it describes nothing.
_TO_THE_READER = re.compile(
    r"\b(?:ignore|instructions?|answer|reply|respond|prompt|your goal|the goal|score|assistant)\b"
)
_QUOTED = re.compile(r"\"[^\"]*\"|“[^”]*”")
_TOKENS = re.compile(r"[0-9]+(?:\.[0-9]+)?|[^\W\d_]+(?:['’-][^\W\d_]+)*|[,;]")
_METRES = frozenset({"m", "metre", "metres", "meter", "meters"})
_NEAR_M, _MIDDLE_M = 10.0, 25.0
_SYMMETRIC = {"under": "over", "on": "has", "in": "has"}
_NUMBER_WORDS = {"two": 2.0, "three": 3.0, "five": 5.0, "ten": 10.0, "fifteen": 15.0, "twenty": 20.0, "thirty": 30.0,
                 "forty": 40.0, "fifty": 50.0}  # fmt: skip


@cache
def _grounds() -> dict[str, str]:
    return {name: concept.ground for name, concept in concepts().items() if concept.ground is not None}


@dataclass(slots=True)
class _Draft:
    """A mention that is still being read."""

    concept: str | None
    words: str
    distance: int | None
    side: int | None
    negated: bool
    count: int
    relations: list[tuple[str, str]] = field(default_factory=list)

    @property
    def name(self) -> str:
        return self.concept or self.words

    def finish(self) -> Mention:
        return Mention(
            self.concept, self.words, self.distance, self.side, self.negated, self.count, tuple(self.relations)
        )


class _Reader:
    """Reads one sentence, word by word.

    A cue of distance or side counts for what comes after it ("on the left, there is a bench") unless things that have
    none stand before it ("a bench stands on the left").
    """

    def __init__(self) -> None:
        self.drafts: list[_Draft] = []
        self.blocked = False
        self._just_blocked = self._blocked_before = False
        self._denied_from = 0
        self._verb_seen = False
        self._after_break = True
        self._negating = False
        self._negated_any = False
        self._lead: dict[str, int | None] = {"distance": None, "side": None}
        self._open: dict[str, list[_Draft]] = {"distance": [], "side": []}
        self._held: dict[str, list[_Draft]] = {"distance": [], "side": []}
        self._clause_side: int | None = None
        self._relation: str | None = None
        self._leading: tuple[str, _Draft] | None = None
        self._head: _Draft | None = None
        self._last: _Draft | None = None
        self._before: _Draft | None = None
        self._count = 0
        self._run: list[str] = []
        self._bare = False
        self._between: _Draft | None = None
        self._tokens: list[str] = []
        self._place_now, self._width = 0, 1
        self._handlers: tuple[Callable[[Any], None], ...] = (
            self._thing, self._distance, self._side, self._place, self._negation, self._denial, self._relate,
            self._counted, self._verb, self._and, self._break, self._pronoun, self._block, self._other,
        )  # fmt: skip

    def read(self, tokens: list[str]) -> None:
        table = caption_phrases()
        single, multi = table.single, table.multi
        place, total = 0, len(tokens)
        self._tokens = tokens
        while place < total:
            token = tokens[place]
            found: tuple[int, Meaning] | None
            if token in multi:
                found = table.at(tokens, place)
            else:
                meaning = single.get(token)
                found = None if meaning is None else (1, meaning)
            if found is None:
                place += self._unknown(tokens, place)
                continue
            count, (part, payload) = found
            self._place_now, self._width = place, count
            self._handlers[part](payload)
            place += count
        self._end_run()
        self._settle()

    # One handler for each kind of phrase.

    def _thing(self, concept: str) -> None:
        noun = " ".join(self._tokens[self._place_now : self._place_now + self._width])
        words = " ".join([*self._run, noun]) if self._run else noun
        many = self._count or (2 if noun in plurals() else 1)
        self._run = []
        self._add(concept, words, many)

    def _add(self, concept: str | None, words: str, many: int) -> None:
        self._just_blocked = False
        draft = _Draft(concept, words, self._lead["distance"], self._lead["side"], self._negating, many)
        self._negated_any = self._negating
        self.drafts.append(draft)
        for cue, open_drafts in self._open.items():
            self._held[cue] = []
            if self._lead[cue] is None:
                open_drafts.append(draft)
        self._connect(draft)
        self._count, self._after_break, self._bare = 0, False, False

    def _connect(self, draft: _Draft) -> None:
        if draft.negated:  # "a bench without a roof on the grass": what is not there relates to nothing
            self._relation = None
            return
        if self._relation is not None:
            relation, self._relation = self._relation, None
            if self._last is None:
                self._leading = (relation, draft)
                self._before = draft
                return
            _link(self._last, relation, draft)
            if self._head is not None and self._head is not self._last:
                _link(self._head, relation, draft)
            if relation == "between":
                self._leading = ("near", draft) if self._head is None else None
                self._between = self._head
        else:
            if self._leading is not None:
                _link(draft, *self._leading)
            elif self._between is not None and not self._verb_seen:
                _link(self._between, "near", draft)
                self._between = None
            self._head = draft
        self._last = draft
        self._before = self._head or draft

    def _cue(self, cue: str, value: int) -> None:
        self._end_run()
        open_drafts = self._open[cue]
        if open_drafts and not self._after_break:
            for draft in open_drafts:
                setattr(draft, cue, value)
            self._open[cue] = []
        else:
            self._held[cue], self._open[cue] = open_drafts, []
            self._lead[cue] = value
        self._relation = None

    def _distance(self, value: int) -> None:
        self._cue("distance", value)

    def _side(self, value: int) -> None:
        self._cue("side", value)
        self._clause_side = value
        if self._just_blocked and value != AHEAD:  # "a wall blocks the way to the left"
            self.blocked = self._blocked_before

    def _place(self, value: tuple[int, int]) -> None:
        self._cue("distance", value[0])
        self._cue("side", value[1])
        self._clause_side = value[1]

    def _negation(self, _: None) -> None:
        self._end_run()
        self._negating, self._negated_any = True, False
        self._count, self._relation = 0, None

    def _denial(self, _: None) -> None:
        self._end_run()
        for draft in self.drafts[self._denied_from :]:
            draft.negated = True

    def _relate(self, relation: str) -> None:
        self._end_run()
        self._relation, self._after_break = relation, False
        self._bare = relation == "with"

    def _counted(self, many: int) -> None:
        self._end_run()
        if self._negating and self._negated_any and self._tokens[self._place_now - 1] not in {"or", "nor"}:
            self._negating = False
        self._count = many

    def _verb(self, _: None) -> None:
        self._end_run()
        # "There is a bench, a tree and a lamp" goes on; "a bench stands here, and ..." has said what it had to say.
        self._verb_seen = self._verb_seen or len(self.drafts) > self._denied_from
        self._after_break, self._count, self._bare = False, 0, True
        if self._negated_any:
            self._negating = False

    def _and(self, _: None) -> None:
        self._end_run()
        if self._verb_seen and self._tokens[self._place_now] != "or" and not self._negating:
            self._new_clause()
        self._after_break, self._count, self._bare = True, 0, True

    def _break(self, _: None) -> None:
        self._end_run()
        word = self._tokens[self._place_now]
        if word != "there":
            self._new_clause()
            self._lead["side"] = None
        if self._negated_any or word != "there":
            self._negating = False
        self._after_break, self._count, self._bare = True, 0, True

    def _new_clause(self) -> None:
        """Things of a finished clause take no cue of the next one."""
        self._settle()
        self._open = {"distance": [], "side": []}
        if self._verb_seen and self.drafts[self._denied_from :]:
            self._lead["side"] = None
        self._verb_seen = False
        self._denied_from = len(self.drafts)
        if self._relation is None:
            self._head = self._last = self._leading = None

    def _settle(self) -> None:
        """A cue that stood apart and had nothing after it belongs to what stood before it."""
        for cue, held in self._held.items():
            for draft in held:
                setattr(draft, cue, self._lead[cue])
            self._held[cue] = []

    def _pronoun(self, _: None) -> None:
        self._end_run()
        relation, self._relation = self._relation, None
        if relation is None or self._before is None:
            return
        if self._last is not None and self._head is not None and self._last is not self._head:
            _link(self._last, relation, self._head)  # "a tree with a bench under it"
        else:
            self._leading = (relation, self._before)  # "... and next to it a tree"

    def _block(self, _: None) -> None:
        self._end_run()
        before = self._tokens[self._place_now - 1] if self._place_now else ""
        if self._negating or before in {"not", "nothing", "never", "hardly"}:
            return
        if self._clause_side in {None, AHEAD} or "ahead" in self._tokens[self._place_now :]:
            self._just_blocked, self._blocked_before = True, self.blocked
            self.blocked = True

    def _other(self, _: None) -> None:
        self._end_run()

    def _unknown(self, tokens: list[str], place: int) -> int:
        """Take an unknown word, or a distance in metres; return how many words were taken."""
        word = tokens[place]
        is_number = word[0] in "0123456789"
        metres = float(word) if is_number else _NUMBER_WORDS.get(word)
        if metres is not None and place + 1 < len(tokens) and tokens[place + 1] in _METRES:
            self._cue("distance", NEAR if metres <= _NEAR_M else MIDDLE if metres <= _MIDDLE_M else FAR)
            return 2
        if is_number:
            self._end_run()
            self._count = 3 if float(word) > 2 else int(float(word))
        elif word != "away":
            self._run.append(word)
        return 1

    def _end_run(self) -> None:
        """Unknown words behind an article, or an unknown plural in a list, are a thing that the lexicon lacks."""
        if self._run:
            run, self._run = self._run[-4:], []
            if self._count or (self._bare and len(run) == 1 and run[0].endswith("s") and len(run[0]) > 3):
                self._add(None, " ".join(run), self._count or 2)
        self._count = 0


def _link(subject: _Draft, relation: str, other: _Draft) -> None:
    if subject.negated or other.negated or subject is other:
        return
    relation = "near" if relation == "between" else relation
    if relation == "with" and subject.concept is not None and concepts()[subject.concept].kind in {"area", "scene"}:
        subject, other, relation = other, subject, "in"  # "a park with a bench"
    subject.relations.append((relation, other.name))
    other.relations.append((_SYMMETRIC.get(relation, "near"), subject.name))


@lru_cache(maxsize=65536)
def _read_sentence(sentence: str) -> tuple[tuple[Mention, ...], bool]:
    if _TO_THE_READER.search(sentence):
        return (), False
    reader = _Reader()
    reader.read(_TOKENS.findall(sentence))
    return tuple(draft.finish() for draft in reader.drafts), reader.blocked


@lru_cache(maxsize=16384)
def read_scene(text: str) -> SceneReading:
    """Return what a caption says.

    Sentences are read one by one and kept, so that a sentence that was seen before costs a look-up.

    Args:
        text: English, as captioners write it.
    """
    if '"' in text or "“" in text:
        text = _QUOTED.sub(" ", text)  # what a sign says is not there
    mentions: tuple[Mention, ...] = ()
    blocked = False
    for sentence in _SENTENCES.split(text.lower()):
        if sentence:
            found, blocks = _read_sentence(sentence)
            mentions += found
            blocked = blocked or blocks
    grounds = _grounds()
    by_side: dict[int | None, str] = {}
    near_first = [m for m in mentions if m.concept in grounds and not m.negated]
    for mention in (*(m for m in near_first if not m.distance), *(m for m in near_first if m.distance == MIDDLE)):
        if mention.concept is not None:
            by_side.setdefault(mention.side, grounds[mention.concept])
    return SceneReading(mentions, by_side.get(AHEAD), by_side.get(LEFT), by_side.get(RIGHT), by_side.get(None), blocked)
