"""From a sentence to what it truly asks for: the judge's own reading.

A small grammar over known phrases: what is sought (nouns or something that one may want to do), how it must stand to
other things (near, under, on, and their negations), and what ground the way shall keep to or keep off. What the judge
cannot grade but what cannot change the meaning (an adjective) is listed in `GoalSpec.unread`; what could change it (a
relation or a kind of ground that it does not know) is refused.
"""

from collections.abc import Sequence
from dataclasses import replace

from reasoned_explorer.model import Fault, GoalError
from reasoned_explorer.task import words
from reasoned_explorer.task.contradictions import contradictions
from reasoned_explorer.task.goal_spec import PASS_GRADE, AttributeTest, Condition, GoalSpec, Relation, Sought
from reasoned_explorer.task.grades import Affordance
from reasoned_explorer.task.lexer import Kind, Token, tokens_of
from reasoned_explorer.task.loose_ends import SOUGHT, Denial, hanging, missing
from reasoned_explorer.task.near_misses import SOME_THINGS, did_you_mean, near_misses, near_misses_among
from reasoned_explorer.world.taxonomy import OBJECT_CLASSES, Ground

_MAX_LENGTH = 300
_RELATIONS_HELP = "near, by, under, on, in, away from, within … m of"
# Relations that may end in what cannot be graded ("with armrests").
_LOOSE = frozenset({"with", "that has"})
_LACKING = frozenset({"without", "with no"})
# Path phrases that need no ground: "a bench that I can use".
_USES = frozenset({"use", "using", "take", "taking", "only"})


def read_goal(text: str) -> GoalSpec:
    """Return what a goal sentence asks for.

    Args:
        text: A sentence in English, at most 300 characters, e.g. ``"Find me a bench under a tree, avoid the grass"``.

    Raises:
        GoalError: With everything that is wrong: the sentence is empty or too long, it asks for nothing that the judge
            knows (with the near misses), for several things at once, for a relation or a ground that the judge does
            not know, for what contradicts itself or is not to be found, or a part of it is missing ("a bench near").
    """
    subject = f"goal {text!r:.80}"
    if not isinstance(text, str):
        raise GoalError(subject, [Fault(f"it is {type(text).__name__}", "a sentence")])
    if not text.strip():
        raise GoalError("goal", [Fault("the sentence is empty", "a sentence such as 'Find me a fountain'")])
    if len(text) > _MAX_LENGTH:
        raise GoalError(subject, [Fault(f"it has {len(text)} characters", f"at most {_MAX_LENGTH}")])
    tokens = tokens_of(text)
    reader = _Reader(tokens)
    reader.read()
    faults = reader.faults
    both = sorted(reader.wanted & reader.shunned)
    if both and (not reader.exceptions or reader.named <= reader.shunned):
        names = ", ".join(ground.noun for ground in both)
        faults.append(Fault(f"{names} is both to be kept to and to be avoided", "one of the two"))
    faults += contradictions(reader.conditions, reader.attributes)
    rows, level = reader.rows()
    if not rows and not faults:
        faults.append(_nothing(tokens))
    if faults:
        raise GoalError(subject, faults)
    return GoalSpec(
        text=" ".join(text.split()),
        level=level,
        sought=rows,
        wanted=frozenset(reader.wanted - reader.shunned),
        shunned=frozenset(reader.shunned),
        affordance=reader.affordance.name if level == 4 and reader.affordance else "",
        unread=tuple(reader.unread),
    )


def _nothing(tokens: Sequence[Token]) -> Fault:
    what = "it asks for nothing that the judge can recognise in a world"
    expected = f"a thing such as {SOME_THINGS}, or something to do, such as 'somewhere to take a nap'"
    return Fault(what, expected, did_you_mean(near_misses_among(tokens)))


class _Reader:
    """Reads tokens from left to right; what it found and what was wrong stand in its attributes."""

    def __init__(self, tokens: Sequence[Token]) -> None:
        self._tokens = tokens
        self._at = 0
        self._joint: Kind | None = None
        self._since_head: list[str] = []
        self._last: Kind | None = None
        self._modifier = ""
        self.nouns: list[words.Noun] = []
        self.affordance: Affordance | None = None
        self._alternatives: list[Affordance] = []
        self.conditions: list[Condition] = []
        self.attributes: list[AttributeTest] = []
        self._denial = Denial()
        self._closes = False
        #: Grounds to stay on as they were named; `wanted` takes in what people mean, too.
        self.named: set[Ground] = set()
        self.wanted: set[Ground] = set()
        self.shunned: set[Ground] = set()
        self.exceptions = False
        self.unread: list[str] = []
        self.faults: list[Fault] = []

    def read(self) -> None:
        """Read all tokens."""
        handlers = {
            Kind.PATH: self._path,
            Kind.RELATION: self._relation,
            Kind.QUALITY: self._quality,
            Kind.ATTRIBUTE: self._attribute,
            Kind.AFFORDANCE: self._do,
            Kind.NOUN: self._noun,
            Kind.WORD: self._word,
        }
        while self._at < len(self._tokens):
            token = self._tokens[self._at]
            self._at += 1
            if self._is_denied(token):
                continue
            if token.kind in handlers:
                handlers[token.kind](token)
            elif token.kind in {Kind.AND, Kind.OR, Kind.LEAD}:
                self._joint = token.kind
            elif token.kind is Kind.BREAK and self._joint not in {Kind.AND, Kind.OR}:
                # ", and": the stronger of the two decides.
                self._joint = token.kind
            if token.kind not in {Kind.SMALL, Kind.WORD}:
                self._last = token.kind
        open_word = self._denial.text or hanging(self._tokens)
        if open_word and self._is_late():
            self._missing(open_word)

    def _is_denied(self, token: Token) -> bool:
        """Follow a denial to what it denies; return whether the token is done with: that is what is sought."""
        if token.kind is Kind.DENIAL:
            self._denial.begin(token.text, self._at)
            return True
        between = [item.text for item in self._tokens[self._denial.at : self._at]]
        fault = self._denial.meet(token, between, is_late=self._is_late())
        if fault is not None:
            self.faults.append(fault)
        return fault is not None and token.kind in SOUGHT

    def _is_late(self) -> bool:
        """Return whether what is sought has been said."""
        return bool(self.nouns or self.affordance)

    def _missing(self, text: str) -> None:
        self.faults.append(missing(text))

    def rows(self) -> tuple[tuple[Sought, ...], int]:
        """Return the ways to satisfy the goal, and its level."""
        conditions, attributes = tuple(self.conditions), tuple(self.attributes)
        level = 3 if self.wanted or self.shunned else 2 if conditions else 1
        served: list[Sought] = []
        for item in self._alternatives:
            served += [replace(row, conditions=row.conditions + conditions, attributes=attributes) for row in item.rows]
        if not self.nouns:
            return tuple(served), 4 if served else level
        named = {name for noun in self.nouns for name in noun.classes}
        kept = tuple(row for row in served if row.class_name in named)
        if any(row.grade >= PASS_GRADE for row in kept):
            return kept, 4
        if self.affordance is not None:
            self.unread.append(self.affordance.asks)
        return tuple(
            Sought(name, PASS_GRADE, conditions, attributes + noun.attributes)
            for noun in self.nouns
            for name in noun.classes
        ), level

    def _peek(self) -> Token | None:
        return self._tokens[self._at] if self._at < len(self._tokens) else None

    def _word(self, token: Token) -> None:
        self.unread.append(token.text)
        self._since_head.append(token.text)

    def _quality(self, token: Token) -> None:
        condition: Condition = token.value
        if self._denial.take():  # "not in the shade", "not very quiet"
            condition = replace(condition, negated=not condition.negated)
        self.conditions.append(condition)

    def _attribute(self, token: Token) -> None:
        test: AttributeTest = token.value
        self.attributes.append(replace(test, negated=not test.negated) if self._denial.take() else test)

    def _do(self, token: Token) -> None:
        item: Affordance = token.value
        if self.affordance is not None and item.name != self.affordance.name:
            if self._joint is Kind.OR:
                self._alternatives.append(item)
                self._joint = None
                return
            if self._joint is Kind.AND and self._last in {Kind.AFFORDANCE, Kind.AND}:
                what = f"it asks for two things, {self.affordance.asks} and {item.asks}"
                self.faults.append(Fault(what, "one thing at a time", "say 'or', or ask for one of them"))
                return
            self.unread.append(self.affordance.asks)
            self._alternatives.clear()
        self.affordance = item
        if item not in self._alternatives:
            self._alternatives.append(item)
        self._joint = None

    def _noun(self, token: Token) -> None:
        following = self._peek()
        if following is not None and following.kind is Kind.NOUN:
            # "plaza fountain": the last noun is what is meant.
            self.unread.append(token.text)
            return
        noun: words.Noun = token.value
        if not noun.classes:
            self._groundless(token, noun)
        elif not self.nouns or self._joint is Kind.OR:
            self._head(noun)
        elif self._joint in {Kind.AND, Kind.LEAD}:
            what = f"it asks for several things, {token.text!r} among them"
            self.faults.append(Fault(what, "one thing at a time", "say 'or', or ask for one of them"))
        else:
            between = " ".join(self._since_head)
            what = f"how {token.text!r} belongs to what is sought is not understood" + (
                f" ({between!r})" if between else ""
            )
            self.faults.append(Fault(what, f"a relation that the judge knows: {_RELATIONS_HELP}"))

    def _head(self, noun: words.Noun) -> None:
        self.nouns.append(noun)
        self._since_head.clear()
        self._joint = None

    def _groundless(self, token: Token, noun: words.Noun) -> None:
        if self.nouns or self.affordance:
            what = f"how {token.text!r} belongs to what is sought is not understood"
            self.faults.append(Fault(what, f"a relation ({_RELATIONS_HELP}) or 'stay on …', 'avoid …'"))
        else:
            kind = "a building" if noun.buildings else "ground"
            what = f"{token.text!r} is {kind}, and the judge grades only things as goals"
            remedy = f"ask for something that is on or near the {token.text}"
            self.faults.append(Fault(what, f"a thing such as {SOME_THINGS}", remedy))

    def _relation(self, token: Token) -> None:
        relation, negated, distance_m = token.value
        negated = negated != self._denial.take()
        listed = self._listed()
        if not listed:
            self._dangling(token)
            return
        if not 0.0 < distance_m <= 100.0:
            self.faults.append(Fault(f"{token.text!r}", "a distance above 0 and up to 100 m"))
            return
        self._closes = token.text in _LOOSE | _LACKING
        others = {"other", "others", "another", "second"} & {t.text for t in self._tokens[: self._at]}
        if token.text in _LACKING and not others and not self._closed():
            self._check_lack(token, [noun for alternatives in listed for noun in alternatives])
        for alternatives in listed:
            self._condition(
                token, Condition(relation, buildings=True, distance_m=distance_m, negated=negated), alternatives
            )
        self._joint = None
        self._since_head.clear()

    def _closed(self) -> bool:
        """Return whether the relation that was read is closed by another one: "without a bench nearby"."""
        following = self._peek()
        return following is not None and (following.kind is Kind.CLOSER or following.text in words.CLOSING)

    def _check_lack(self, token: Token, lacking: Sequence[words.Noun]) -> None:
        """Refuse "a bench without a bench"."""
        sought = {name for noun in self.nouns for name in noun.classes}
        lacked = {name for noun in lacking for name in noun.classes}
        if sought and sought <= lacked:
            noun = OBJECT_CLASSES[min(sought)].noun
            self.faults.append(Fault(f"it wants a {noun} and says {token.text!r} of the same", "one of the two"))

    def _condition(self, token: Token, frame: Condition, alternatives: Sequence[words.Noun]) -> None:
        """Add a condition: the relation of a frame to any of the nouns."""
        classes = tuple(sorted({name for noun in alternatives for name in noun.classes}))
        grounds = tuple(sorted({ground for noun in alternatives for ground in noun.grounds}))
        buildings = any(noun.buildings for noun in alternatives)
        relation = frame.relation
        if relation is Relation.ON and not grounds and all(OBJECT_CLASSES[n].kind == "place" for n in classes):
            # One is "in a cafe" or "at" it: what is judged is being beside its entrance.
            relation = Relation.NEAR
        if relation is Relation.UNDER and set(grounds) - {Ground.WOOD}:
            self.faults.append(Fault(f"nothing is {token.text} ground", "under a tree, a shelter or a roof"))
            return
        self.conditions.append(replace(frame, relation=relation, classes=classes, grounds=grounds, buildings=buildings))

    def _dangling(self, token: Token) -> None:
        start = self._at
        while start < len(self._tokens) and self._tokens[start].kind is Kind.SMALL:
            start += 1
        small = {item.text for item in self._tokens[self._at : start]}
        kind = self._tokens[start].kind if start < len(self._tokens) else None
        if kind is not Kind.WORD:
            # "in a quiet place", "near me", "to sit on"
            is_said = kind in {Kind.QUALITY, Kind.ATTRIBUTE, Kind.AFFORDANCE} or small & words.HERE_WORDS
            if not is_said and not self._may_end(token):
                self._missing(token.text)
            return
        if token.text in _LOOSE:
            return
        following = self._tokens[start].text
        hint = did_you_mean(near_misses(following) or near_misses_among(self._tokens[start : start + 3]))
        self.faults.append(
            Fault(f"{token.text!r} what? {following!r} is not known", "a thing or a ground that is known", hint)
        )

    def _may_end(self, token: Token) -> bool:
        """Return whether a relation may be said without what it relates to."""
        before = self._tokens[self._at - 2].kind if self._at >= 2 else None
        if token.text in words.ADVERBS:
            return True
        if token.text in words.STRANDED and before in {Kind.AFFORDANCE, Kind.WORD}:
            return self._is_late()
        return token.text in words.CLOSING and self._closes and before is Kind.NOUN

    def _listed(self) -> list[list[words.Noun]]:
        """Read "a tree and a bench or a lamp" from here on: all of (any of)."""
        found: list[list[words.Noun]] = []
        join: Kind | None = None
        while True:
            place, strange = self._at, False
            while place < len(self._tokens) and self._tokens[place].kind in {Kind.SMALL, Kind.WORD}:
                strange |= self._tokens[place].text in words.STRANGE_WORDS
                place += 1
            if strange or place >= len(self._tokens) or self._tokens[place].kind is not Kind.NOUN:
                return found
            while place + 1 < len(self._tokens) and self._tokens[place + 1].kind is Kind.NOUN:
                self.unread.append(self._tokens[place].text)
                place += 1
            self.unread += [t.text for t in self._tokens[self._at : place] if t.kind is Kind.WORD]
            noun: words.Noun = self._tokens[place].value
            if join is Kind.OR:
                found[-1].append(noun)
            else:
                found.append([noun])
            self._at = place + 1
            join = self._conjunction()
            if join is None:
                return found

    def _conjunction(self) -> Kind | None:
        """Step over "and", "or", "," before another noun of a list; None if the list ends here."""
        place, join = self._at, None
        while place < len(self._tokens) and self._tokens[place].kind in {Kind.AND, Kind.OR, Kind.BREAK}:
            if self._tokens[place].text in {".", "!", "?", ";", "but", "then", "while"}:
                return None
            if self._tokens[place].kind is not Kind.BREAK:
                join = self._tokens[place].kind
            place += 1
        if join is None:
            return None
        after = place
        while after < len(self._tokens) and self._tokens[after].kind is Kind.SMALL:
            after += 1
        if after < len(self._tokens) and self._tokens[after].kind is Kind.NOUN:
            self._at = place
            return join
        return None

    def _path(self, token: Token) -> None:
        is_wanted, whatever_follows = token.value
        is_wanted = is_wanted and not self._denial.take()  # "I don't want to walk on the grass"
        if token.text in words.relation_texts() and self._last in {
            Kind.NOUN,
            Kind.QUALITY,
            Kind.ATTRIBUTE,
            Kind.AFFORDANCE,
        }:
            # "a bench not on the grass" says where the bench is; ", not on the grass" says where to walk.
            self._relation(Token(Kind.RELATION, token.text, words.relations()[tuple(token.text.split())]))
            return
        start, unread = self._at, len(self.unread)
        listed = self._listed()
        nouns = [noun for alternatives in listed for noun in alternatives]
        if nouns and all(noun.grounds for noun in nouns):
            for noun in nouns:
                if is_wanted:
                    self.named.update(noun.grounds)
                    self.wanted.update(noun.wanted or noun.grounds)
                else:
                    self.shunned.update(noun.grounds)
            # "stay on the paths, but not on the steps": the narrower word takes away from the wider one.
            self.exceptions |= not is_wanted and token.text.split()[0] in {
                "but",
                "and",
                "not",
                "never",
                "rather",
                "instead",
            }
            self._joint = None
            return
        self._at = start
        del self.unread[unread:]
        self._no_path(token, nouns, is_wanted=is_wanted, whatever_follows=whatever_follows)

    def _no_path(self, token: Token, nouns: Sequence[words.Noun], *, is_wanted: bool, whatever_follows: bool) -> None:
        """Answer a phrase of a path clause that is followed by no ground."""
        if not whatever_follows and (is_wanted or not nouns):
            if tuple(token.text.split()) in words.relations():
                self._relation(Token(Kind.RELATION, token.text, words.relations()[tuple(token.text.split())]))
            elif token.text in words.DENYING_PATHS:
                self._denial.begin(token.text, self._at)
            elif is_wanted and not nouns and token.text.split()[-1] not in _USES and self._at_end_of_clause():
                self._missing(token.text)
            return
        if token.text in words.DENYING_PATHS:
            named = " or ".join(OBJECT_CLASSES[name].noun for noun in nouns for name in noun.classes[:1])
            what = f"it says what is not to be found: {token.text} … {named}"
            self.faults.append(Fault(what, "what is to be found, or how it must stand to other things"))
            self._skip_nouns()
            return
        following = " ".join(t.text for t in self._tokens[self._at : self._at + 4] if t.kind is not Kind.BREAK)
        grounds = ", ".join(ground.noun for ground in Ground if ground not in {Ground.UNKNOWN, Ground.BUILDING})
        what = f"{token.text!r} what? {following!r} is no ground" if following else f"{token.text!r} what?"
        self.faults.append(Fault(what, f"ground that the judge knows: {grounds}"))
        self._skip_nouns()

    def _at_end_of_clause(self) -> bool:
        following = self._peek()
        return following is None or following.kind is Kind.BREAK

    def _skip_nouns(self) -> None:
        """Step over what was meant as ground: it must not be taken for what is sought."""
        while self._at < len(self._tokens) and self._tokens[self._at].kind in {Kind.SMALL, Kind.WORD, Kind.NOUN}:
            self._at += 1
