"""The nouns of a call: what is asked of a model, what it answers, and who answers."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Protocol


@dataclass(frozen=True, slots=True)
class DecisionQuestion:
    """A question whose answer has a type, for endpoints that answer such questions with probabilities.

    Attributes:
        name: The answer's key.
        instructions: A statement that is true or not of what the request says; or, with levels, what to rate.
        levels: Labels of ordered levels, the lowest first; empty for a statement.
    """

    name: str
    instructions: str
    levels: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class ChatRequest:
    """One question to a model.

    Everything but ``role`` and ``key`` decides the answer; these two say what it is for.

    Attributes:
        role: ``caption``, ``visionary``, ``evaluator`` or ``checker``.
        key: Of the scene or view that it is about.
        system: Who the model is to be and how it is to answer.
        user: The question, with all data fenced off.
        prompt: Name and version of the prompt, e.g. ``"evaluator/3"``.
        images: Pictures that go with the question, PNG or JPEG.
        schema: JSON schema that the answer should satisfy, or None where plain text is wanted.
        max_tokens: At most so long an answer, tokens.
        temperature: Of sampling, 0 or more.
        seed: Of sampling, where the model takes one.
        top_logprobs: So many likeliest tokens are wanted at each place; 0 for none.
        questions: Typed decisions about what the request says, in the stead of an answer in words; only for a model
            that was found to offer them.
    """

    role: str
    key: tuple[int, ...]
    system: str
    user: str
    prompt: str
    images: tuple[bytes, ...] = ()
    schema: Mapping[str, Any] | None = None
    max_tokens: int = 256
    temperature: float = 0.0
    seed: int = 0
    top_logprobs: int = 0
    questions: tuple[DecisionQuestion, ...] = ()


@dataclass(frozen=True, slots=True)
class TokenChoice:
    """One place of an answer: the likeliest tokens there, with their natural logarithms of probability.

    Attributes:
        token: The one that was taken.
        alternatives: (token, log-probability), likeliest first; empty where the model tells none.
    """

    token: str
    alternatives: tuple[tuple[str, float], ...] = ()


@dataclass(frozen=True, slots=True)
class ChatAnswer:
    """What came back.

    Attributes:
        text: The answer; empty where there is none.
        fault: Why there is no answer, or None: an expected event, not an exception. It never holds a key.
        tokens_in: Tokens that were sent, as the server counts; summed over tries.
        tokens_out: Tokens that came back, likewise.
        usd: US dollars, or None where the price is not known.
        retries: How often it was asked again.
        model: What the server says that it is.
        tokens: The places of the answer, where log-probabilities were wanted and told.
    """

    text: str = ""
    fault: str | None = None
    tokens_in: int = 0
    tokens_out: int = 0
    usd: float | None = 0.0
    retries: int = 0
    model: str = ""
    tokens: tuple[TokenChoice, ...] = field(default=())


class ChatModel(Protocol):
    """Answers questions: an endpoint, a model on this machine, a scripted one in tests.

    Attributes:
        name: As typed, e.g. ``"openai:gpt-4o-mini"``.
        fingerprint: What decides its answers beside the request: the model, where it is, how it is asked. No key.
        is_local: Its pictures and texts stay on this machine.
    """

    name: str
    fingerprint: str
    is_local: bool

    async def ask(self, request: ChatRequest) -> ChatAnswer:
        """Return the answer. Whatever goes wrong at the other end is a fault in it.

        It runs in a real event loop of its own, many at a time; cancelling it ends the call.
        """
        ...


#: As a request's schema it asks for any JSON object, not for one of a certain shape.
ANY_OBJECT: Mapping[str, Any] = {"type": "object"}
#: What the name of a model begins with; what follows is its name where it is served, or on a hub, or a folder.
MODEL_PREFIXES = ("openai:", "hf:")
#: The forms of such names, for people.
MODEL_FORMS = "openai:MODEL or hf:NAME"


def is_model_name(name: str) -> bool:
    """Return whether a name means a model that is called, such as ``openai:gpt-4o-mini``, and nothing registered."""
    return name.startswith(MODEL_PREFIXES)
