"""What identifies a request in a store, and what an answer is in JSON; the cache and the tape share both."""

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import cached_property
from hashlib import sha256
from typing import Any

from pydantic import TypeAdapter, ValidationError

from reasoned_explorer.calls.chat import ChatAnswer, ChatRequest

_ANSWER = TypeAdapter(ChatAnswer)


def _hash(content: bytes) -> str:
    return sha256(content).hexdigest()


def _canonical(value: Any) -> str:
    # Not every mapping is a dict; what else JSON cannot say is a fault of the program.
    return json.dumps(value, sort_keys=True, separators=(",", ":"), default=dict)


@dataclass(frozen=True)
class RequestParts:
    """All that decides the answer to a request: texts and pictures as SHA-256, the rest as it is.

    Attributes:
        model: Fingerprint of what is asked.
        prompt: Name and version of the prompt.
        system: Of the instructions.
        question: Of the question.
        pictures: Of each picture.
        schema: Of the schema, or of questions with typed answers; empty where there is neither.
        max_tokens: As in the request.
        temperature: Likewise.
        seed: Likewise.
        top_logprobs: Likewise.
    """

    model: str
    prompt: str
    system: str
    question: str
    pictures: tuple[str, ...]
    schema: str
    max_tokens: int
    temperature: float
    seed: int
    top_logprobs: int

    @cached_property
    def digest(self) -> str:
        """SHA-256 of all parts, hexadecimal."""
        return _hash(_canonical(asdict(self)).encode())


def _form_of(request: ChatRequest) -> Any:
    """Return the form that an answer is to have: a schema, or questions with typed answers."""
    return [asdict(each) for each in request.questions] if request.questions else request.schema


def parts_of(fingerprint: str, request: ChatRequest) -> RequestParts:
    """Return what identifies a request to a model: everything but its role and its key."""
    return RequestParts(
        model=fingerprint,
        prompt=request.prompt,
        system=_hash(request.system.encode(errors="surrogatepass")),
        question=_hash(request.user.encode(errors="surrogatepass")),
        pictures=tuple(map(_hash, request.images)),
        schema=_hash(_canonical(form).encode()) if (form := _form_of(request)) is not None else "",
        max_tokens=request.max_tokens,
        temperature=float(request.temperature),
        seed=request.seed,
        top_logprobs=request.top_logprobs,
    )


def answer_as_json(answer: ChatAnswer) -> dict[str, Any]:
    """Return an answer as JSON values; what is as by default is left out."""
    default = asdict(ChatAnswer())
    return {name: value for name, value in asdict(answer).items() if value != default[name]}


def answer_from_json(value: Mapping[str, Any]) -> ChatAnswer:
    """Return the answer that `answer_as_json` made a value of.

    Raises:
        ValueError: If it is none.
    """
    try:
        return _ANSWER.validate_python(value)
    except ValidationError as error:
        raise ValueError(str(error)) from error
