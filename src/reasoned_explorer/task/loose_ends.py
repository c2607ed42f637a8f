"""What a sentence leaves open: denials that wait for what they deny, and words that nothing follows."""

from collections.abc import Collection, Sequence

from reasoned_explorer.model import Fault
from reasoned_explorer.task import words
from reasoned_explorer.task.lexer import Kind, Token

#: What is sought, or asks for it.
SOUGHT = frozenset({Kind.LEAD, Kind.NOUN, Kind.AFFORDANCE})


def missing(text: str) -> Fault:
    """Return the fault of words that nothing follows."""
    return Fault(f"{text!r} what? nothing follows", "a thing or a ground behind it", "say what, or leave it out")


def hanging(tokens: Sequence[Token]) -> str | None:
    """Return the word behind a thing with which a sentence breaks off, or None: "a bench and", "a bench behind the"."""
    rest = [token for token in tokens if token.kind is not Kind.BREAK]
    while rest and rest[-1].text in words.DETERMINERS:
        rest.pop()
    if len(rest) < 2:
        return None
    is_open = rest[-1].text in words.HANGING and rest[-2].kind is Kind.NOUN
    return rest[-1].text if is_open or rest[-1].kind in {Kind.AND, Kind.OR} else None


class Denial:
    """A "don't", a "not" or an "anything but" that has been read, and waits for what it denies.

    Attributes:
        text: Its words; empty where none waits.
        at: Place of the token behind it.
    """

    def __init__(self) -> None:
        self.text, self.at = "", 0

    def begin(self, text: str, at: int) -> None:
        """Wait for what these words deny."""
        self.text, self.at = text, at

    def take(self) -> bool:
        """Return whether what is read now is denied; the denial is done with."""
        denied, self.text = bool(self.text), ""
        return denied

    def meet(self, token: Token, between: Collection[str], *, is_late: bool) -> Fault | None:
        """Look at the next token; return what is wrong, if anything.

        Relations, qualities and path clauses are for the reader to turn round (`take`).

        Args:
            token: What comes.
            between: The words from the denial to the token.
            is_late: What is sought has been said already.
        """
        if not self.text:
            return None
        text = self.text
        if token.kind in SOUGHT and words.QUESTION_WORDS.isdisjoint(between):
            self.text = ""
            what = f"it says what is not to be found: {text} … {token.text}"
            return Fault(what, "what is to be found, e.g. 'Find me a bench'")
        if token.kind is Kind.PATH:
            return self._meet_path(token, between)
        if token.kind in {Kind.BREAK, Kind.AND, Kind.OR}:
            self.text = ""
            # "No, find me a bench" takes back what somebody else said.
            return missing(text) if is_late else None
        # "I don't know …" denies nothing that is read here; "I don't want a red …" still waits.
        passes = token.kind is Kind.WORD and words.DETERMINERS.isdisjoint(between)
        if passes or token.kind in {Kind.CLOSER, *SOUGHT}:
            self.text = ""
        return None

    def _meet_path(self, token: Token, between: Collection[str]) -> Fault | None:
        if token.value[0] and {"just", "only"}.isdisjoint(between):
            return None  # "I don't want to walk on the grass"
        text, self.text = self.text, ""
        return Fault(f"what {text!r} does to {token.text!r} is not understood", "'stay on …' or 'avoid …'")
