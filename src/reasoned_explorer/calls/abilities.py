"""What an endpoint can do, found by looking at what it answers and not at the status that it answers with.

Servers were seen to accept ``response_format`` and to ignore it, to fail on a JSON schema only, and to take
``logprobs`` and to tell none. So each ability is tried on a question whose answer shows whether it was there.
"""

import asyncio
import io
import json
import math
import statistics
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

from PIL import Image

from reasoned_explorer.calls.chat import ANY_OBJECT, ChatAnswer, ChatModel, ChatRequest, DecisionQuestion

#: So many alternatives are asked for at each place: the five levels, each with and without a space before it.
TOP_LOGPROBS = 10

_PROMPT = "abilities/1"
_COLOURS = {"red": (220, 20, 20), "green": (20, 170, 40)}
_NEIGHBOURS = ("blue", "yellow", "black", "white")
_SIDE_PX = 64
_TOGETHER = 8


@dataclass(frozen=True, slots=True)
class Abilities:
    """What an endpoint can do. The defaults are plain text and nothing else, which every endpoint can.

    Attributes:
        json_schema: Answers keep to a JSON schema that the question does not mention.
        json_object: Answers are JSON objects where any is asked for.
        top_logprobs: So many alternatives it tells at each place, 0 for none.
        decisions: It answers typed questions with probabilities (`calls.decisions`).
        vision: It names the colour of pictures.
        parallel: How many calls went on at once, as far as could be seen; 1.0 is one after the other.
        latency_s: Median seconds of a short call, alone, or None where none was answered.
        calls: How many calls it took to find out.
        tokens: That were sent and came back.
        usd: What it cost, or None where a price is not known.
        model: What the server says that it is.
        faults: What calls were answered with instead of an answer, each once.
    """

    json_schema: bool = False
    json_object: bool = False
    top_logprobs: int = 0
    decisions: bool = False
    vision: bool = False
    parallel: float = 1.0
    latency_s: float | None = None
    calls: int = 0
    tokens: int = 0
    usd: float | None = 0.0
    model: str = ""
    faults: tuple[str, ...] = ()

    @property
    def answers(self) -> bool:
        """Whether it answered at all."""
        return self.latency_s is not None

    @property
    def structure(self) -> Literal["json_schema", "json_object", "none"]:
        """How the form of an answer is best asked for."""
        return "json_schema" if self.json_schema else "json_object" if self.json_object else "none"


def abilities_from_json(said: Mapping[str, Any]) -> Abilities:
    """Return the abilities that `dataclasses.asdict` and JSON made a mapping of.

    Raises:
        TypeError: If they are none.
    """
    return Abilities(**{**said, "faults": tuple(said.get("faults", ()))})


class _Probe:
    """Asks one after the other and keeps what it took."""

    def __init__(self, model: ChatModel, now_s: Callable[[], float]) -> None:
        self._model = model
        self._now_s = now_s
        self.answers: list[ChatAnswer] = []
        self.latencies_s: list[float] = []

    async def decides(self, request: ChatRequest) -> bool:
        """Return whether typed questions get typed answers; that most endpoints know none is no fault of theirs."""
        answer = await self._model.ask(request)
        self.answers.append(answer if answer.fault is None else replace(answer, fault=None))
        said = _json(answer.text)
        return answer.fault is None and isinstance(said, dict) and set(said) == {each.name for each in _DECISIONS}

    async def ask(self, request: ChatRequest) -> ChatAnswer:
        started_s = self._now_s()
        answer = await self._model.ask(request)
        self.answers.append(answer)
        if answer.fault is None:
            self.latencies_s.append(self._now_s() - started_s)
        return answer

    async def ask_together(self, requests: list[ChatRequest]) -> float:
        """Return how many calls went on at once: their seconds alone by the seconds for all; 0 where one failed."""
        alone_s = len(self.latencies_s)
        started_s = self._now_s()
        answers = await asyncio.gather(*(self.ask(request) for request in requests))
        together_s = self._now_s() - started_s
        del self.latencies_s[alone_s:]
        if any(answer.fault is not None for answer in answers) or not self.latencies_s or together_s <= 0.0:
            return 0.0
        return len(requests) * statistics.median(self.latencies_s) / together_s


async def probe(model: ChatModel, *, together: int = _TOGETHER, now_s: Callable[[], float] | None = None) -> Abilities:
    """Return what a model can do, in ``7 + together`` short calls at most.

    One that only describes pictures is shown ``2 + together`` of them.

    Args:
        model: Asked directly: nothing of this is cached or recorded.
        together: How many calls are made at once to see how many go on at once, at least 1.
        now_s: Tells seconds; the running loop's time where None.
    """
    asking = _Probe(model, now_s or asyncio.get_running_loop().time)
    if getattr(model, "only_describes", False):
        return await _of_one_that_only_describes(asking, together)
    plain = [await asking.ask(_request("Answer with the one word: ready", key)) for key in (0, 1)]
    if all(answer.fault is not None for answer in plain):
        return _abilities(asking)
    by_schema = await asking.ask(_request("Say in a few words what a bridge is.", 2, schema=_SCHEMA))
    any_object = await asking.ask(
        _request(
            "Say in a few words what a bridge is. Answer as a JSON object with the key text.", 3, schema=ANY_OBJECT
        )
    )
    chosen = await asking.ask(_request("Answer with one digit from 1 to 5 and nothing else.", 4, top=TOP_LOGPROBS))
    at_once = await asking.ask_together([_request("Answer with the one word: ready", 10 + n) for n in range(together)])
    return _abilities(
        asking,
        json_schema=_keeps_to_schema(by_schema),
        json_object=isinstance(_json(any_object.text), dict),
        top_logprobs=_alternatives(chosen),
        decisions=getattr(model, "family", None) is None
        and await asking.decides(_request(_ABOUT, 7, questions=_DECISIONS)),
        vision=await _sees(asking),
        parallel=max(1.0, min(float(together), at_once)),
    )


async def _of_one_that_only_describes(asking: _Probe, together: int) -> Abilities:
    """Return what a model can do that describes pictures and answers nothing else; that it sees need not be tried."""
    shown = [_picture(rgb) for rgb in _COLOURS.values()]
    plain = [await asking.ask(_request("Describe this image in detail:", key, image=shown[key])) for key in (0, 1)]
    if all(answer.fault is not None for answer in plain):
        return _abilities(asking)
    requests = [_request("Describe this image in detail:", 10 + n, image=shown[n % 2]) for n in range(together)]
    at_once = await asking.ask_together(requests)
    return _abilities(asking, vision=True, parallel=max(1.0, min(float(together), at_once)))


#: A shape that nobody answers in by himself.
_SCHEMA: dict[str, object] = {
    "type": "object",
    "additionalProperties": False,
    "required": ["kind_of_thing", "level"],
    "properties": {
        "kind_of_thing": {"type": "string", "enum": ["building", "animal", "plant"]},
        "level": {"type": "integer", "enum": [1, 2, 3, 4, 5]},
    },
}


_ABOUT = "A bridge leads over a river."
_DECISIONS = (
    DecisionQuestion("about_a_bridge", "The text is about a bridge."),
    DecisionQuestion("length", "How long is the text?", ("short", "middling", "long")),
)


def _request(
    user: str,
    key: int,
    *,
    schema: Mapping[str, Any] | None = None,
    top: int = 0,
    image: bytes | None = None,
    questions: tuple[DecisionQuestion, ...] = (),
) -> ChatRequest:
    return ChatRequest(
        role="probe",
        key=(key,),
        system="You answer short questions exactly as you are asked to.",
        user=user,
        prompt=_PROMPT,
        images=() if image is None else (image,),
        schema=schema,
        max_tokens=64,
        seed=key,
        top_logprobs=top,
        questions=questions,
    )


def _abilities(
    asking: _Probe,
    *,
    json_schema: bool = False,
    json_object: bool = False,
    top_logprobs: int = 0,
    decisions: bool = False,
    vision: bool = False,
    parallel: float = 1.0,
) -> Abilities:
    prices = [answer.usd for answer in asking.answers]
    return Abilities(
        json_schema=json_schema,
        json_object=json_object or json_schema,
        top_logprobs=top_logprobs,
        decisions=decisions,
        vision=vision,
        parallel=parallel,
        latency_s=statistics.median(asking.latencies_s) if asking.latencies_s else None,
        calls=len(asking.answers),
        tokens=sum(answer.tokens_in + answer.tokens_out for answer in asking.answers),
        usd=None if None in prices else math.fsum(price for price in prices if price is not None),
        model=next((answer.model for answer in asking.answers if answer.model), ""),
        faults=tuple(dict.fromkeys(answer.fault for answer in asking.answers if answer.fault is not None)),
    )


def _json(text: str) -> object:
    try:
        return json.loads(text)
    except (ValueError, RecursionError):
        return None


def _keeps_to_schema(answer: ChatAnswer) -> bool:
    said = _json(answer.text)
    if not isinstance(said, dict) or set(said) != {"kind_of_thing", "level"}:
        return False
    kind, level = said["kind_of_thing"], said["level"]
    return (
        isinstance(kind, str)
        and kind in {"building", "animal", "plant"}
        and isinstance(level, int)
        and not isinstance(level, bool)
        and 1 <= level <= 5
    )


def _alternatives(answer: ChatAnswer) -> int:
    """Return how many alternatives are told where the digit is; 0 where there is no digit or nothing to choose from."""
    for place in answer.tokens:
        if any(sign.isdecimal() for sign in place.token):
            told = [logarithm for _, logarithm in place.alternatives if math.isfinite(logarithm)]
            return len(told) if len(told) > 1 and any(logarithm < 0.0 for logarithm in told) else 0
    return 0


async def _sees(asking: _Probe) -> bool:
    for key, (name, rgb) in enumerate(_COLOURS.items(), 5):
        others = ", ".join((*_COLOURS, *_NEIGHBOURS))
        question = f"Which colour fills this picture? Answer with one word, one of: {others}."
        answer = await asking.ask(_request(question, key, image=_picture(rgb)))
        said = {word.strip(".,!*'\"`") for word in answer.text.casefold().split()}
        if name not in said or said & ({*_COLOURS, *_NEIGHBOURS} - {name}):
            return False
    return True


def _picture(rgb: tuple[int, int, int]) -> bytes:
    kept = io.BytesIO()
    Image.new("RGB", (_SIDE_PX, _SIDE_PX), rgb).save(kept, "PNG")
    return kept.getvalue()
