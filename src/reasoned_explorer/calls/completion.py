"""The wire form of a chat completion: what is sent, and what can be read out of what comes back."""

import base64
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel, ConfigDict, ValidationError

from reasoned_explorer.calls.chat import ANY_OBJECT, ChatRequest, TokenChoice
from reasoned_explorer.calls.endpoint import Structure

_SHOWN = 160  # characters of a server's text in a fault
_ERROR_NAMES = ("message", "detail", "error")


class _Wire(BaseModel):
    # What a server sends beside this is its own affair; what stands here must have the right type.
    model_config = ConfigDict(extra="ignore", strict=True)


class _Alternative(_Wire):
    token: str
    logprob: float


class _Place(_Wire):
    token: str
    top_logprobs: list[_Alternative] | None = None


class _Places(_Wire):
    content: list[_Place] | None = None


class _Message(_Wire):
    content: str | None = None
    refusal: str | None = None


class _Choice(_Wire):
    message: _Message
    finish_reason: str | None = None
    logprobs: Any = None  # read on its own: an answer does not get worse by probabilities that cannot be read


class _Usage(_Wire):
    prompt_tokens: int = 0
    completion_tokens: int = 0


class _Completion(_Wire):
    choices: list[_Choice]
    model: Any = None


class _UsageOnly(_Wire):
    usage: _Usage | None = None


@dataclass(frozen=True, slots=True)
class Reading:
    """What an answer of status 200 says.

    Attributes:
        text: The answer, empty where there is none; kept where it was cut off.
        fault: Why there is none, or None.
        again: Whether asking again may help.
        tokens_in: As the server counts; 0 where it does not tell.
        tokens_out: Likewise.
        counted: Whether it told.
        model: What the server says that it is.
        tokens: The places of the answer, where told.
    """

    text: str = ""
    fault: str | None = None
    again: bool = False
    tokens_in: int = 0
    tokens_out: int = 0
    counted: bool = False
    model: str = ""
    tokens: tuple[TokenChoice, ...] = ()


def shortened(text: str) -> str:
    """Return a text on one line, cut for a fault."""
    line = " ".join(text.split())
    return line if len(line) <= _SHOWN else line[: _SHOWN - 1] + "…"


def fault_of_body(error: ValidationError, body: bytes) -> str:
    """Return why the body of an answer cannot be read: it is ``malformed``, or of ``wrong types``."""
    first = error.errors(include_url=False)[0]
    if first["type"] == "json_invalid":
        start = shortened(body[:200].decode("utf-8", "replace"))
        return f"malformed: the answer is no JSON: {start!r}"
    where = ".".join(map(str, first["loc"])) or "the whole"
    return f"wrong types: {where}: {first['msg']}"


def words_of_error(body: object) -> str:
    """Return what a server says of an error, or nothing where it says nothing.

    OpenAI, vLLM and llama.cpp say it under ``error.message``; servers made with FastAPI, such as ``transformers
    serve``, under ``detail``, as a text or as a list of places and what is wrong there; Ollama as ``error``.

    Args:
        body: As it came: text, or what JSON made of it, with what stood under ``error`` taken out or not.

    >>> words_of_error({"detail": [{"loc": ["body", "seed"], "msg": "not permitted", "input": {"model": "x"}}]})
    "'seed': not permitted"
    """
    if isinstance(body, Mapping):
        return next(filter(None, (words_of_error(body[name]) for name in _ERROR_NAMES if name in body)), "")
    if isinstance(body, list):
        # Where it is wrong and how; not the input, which holds the names of all that was sent.
        told = [each for each in body if isinstance(each, Mapping) and isinstance(each.get("msg"), str)]
        places = [each["loc"][-1] if isinstance(each.get("loc"), list) and each["loc"] else "" for each in told]
        return "; ".join(f"'{place}': {each['msg']}" for place, each in zip(places, told, strict=True))
    return body.strip() if isinstance(body, str) else ""


def data_url(picture: bytes) -> str:
    """Return a picture as a data URL, PNG or JPEG by its first bytes."""
    kind = "jpeg" if picture.startswith(b"\xff\xd8\xff") else "png"
    return f"data:image/{kind};base64,{base64.b64encode(picture).decode('ascii')}"


def parameters(
    request: ChatRequest,
    model: str,
    *,
    structure: Structure,
    length_name: str,
    without: frozenset[str] = frozenset(),
    knows_system: bool = True,
) -> dict[str, Any]:
    """Return what is sent for a request.

    Args:
        request: What is asked.
        model: By the server's name.
        structure: How the form of the answer is asked for.
        length_name: ``max_tokens``, or ``max_completion_tokens`` where the server wants that.
        without: Parameters that the server refuses.
        knows_system: Whether the model takes a system beside the user; where not, the user says that, too.
    """
    system = request.system if knows_system else ""
    user = request.user if knows_system else f"{request.system}\n\n{request.user}".lstrip()
    content: str | list[dict[str, Any]] = user
    if request.images:
        pictures = [{"type": "image_url", "image_url": {"url": data_url(each)}} for each in request.images]
        content = [{"type": "text", "text": user}, *pictures]
    sent: dict[str, Any] = {
        "model": model,
        # Some models know no system, and are told about it by leaving it empty.
        "messages": [
            *([{"role": "system", "content": system}] if system else []),
            {"role": "user", "content": content},
        ],
        length_name: request.max_tokens,
        "temperature": request.temperature,
        "seed": request.seed % 2**31,  # what every server takes
    }
    if request.top_logprobs:
        sent |= {"logprobs": True, "top_logprobs": request.top_logprobs}
    if request.schema is not None and structure != "none":
        sent["response_format"] = _response_format(request.schema, structure, request.role)
    return {name: value for name, value in sent.items() if name not in without}


def _response_format(schema: Mapping[str, Any], structure: Structure, role: str) -> dict[str, Any]:
    if structure == "json_object" or schema == ANY_OBJECT:
        return {"type": "json_object"}
    return {"type": "json_schema", "json_schema": {"name": role or "answer", "strict": True, "schema": dict(schema)}}


def read_completion(body: bytes, *, wants_structure: bool = False) -> Reading:
    """Return what the body of an answer says; whatever is wrong with it is a fault with the kind in front.

    Kinds: ``malformed`` (no JSON), ``wrong types``, ``empty``, ``refused``, ``filtered``, ``cut off``.

    Args:
        body: Of an answer of status 200.
        wants_structure: Whether the answer should be JSON, so that half of it is none.
    """
    try:
        usage = _UsageOnly.model_validate_json(body).usage
    except ValidationError:
        usage = None  # what was spent is not known; whether the answer is sound is asked below
    tokens_in, tokens_out = (max(0, usage.prompt_tokens), max(0, usage.completion_tokens)) if usage else (0, 0)

    def spent(**found: Any) -> Reading:
        return Reading(tokens_in=tokens_in, tokens_out=tokens_out, counted=usage is not None, **found)

    try:
        completion = _Completion.model_validate_json(body)
    except ValidationError as error:
        return spent(fault=fault_of_body(error, body), again=True)
    name = completion.model if isinstance(completion.model, str) else ""
    if not completion.choices:
        return spent(fault="wrong types: choices: there is none", again=True, model=name)
    choice = completion.choices[0]
    text = (choice.message.content or "").strip()
    fault = _without_answer(choice, text, wants_structure=wants_structure)
    if fault is not None and fault.startswith(("refused", "filtered", "empty")):
        return spent(fault=fault, again=fault.startswith("empty"), model=name)
    return spent(fault=fault, text=text, model=name, tokens=_places(choice.logprobs))


def _without_answer(choice: _Choice, text: str, *, wants_structure: bool) -> str | None:
    if choice.message.refusal:
        return f"refused: {shortened(choice.message.refusal)}"
    if choice.finish_reason == "content_filter":
        return "filtered: the server holds the answer back"
    if choice.finish_reason == "length" and (wants_structure or not text):
        return "cut off: the tokens that were allowed did not do"
    return None if text else "empty: no text"


def _places(told: object) -> tuple[TokenChoice, ...]:
    try:
        content = _Places.model_validate(told).content if told is not None else None
    except ValidationError:
        return ()
    return tuple(
        TokenChoice(place.token, tuple((each.token, each.logprob) for each in place.top_logprobs or ()))
        for place in content or ()
    )
