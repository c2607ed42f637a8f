"""Chat models that behave as real endpoints were seen to behave, and what they are asked through."""

import asyncio
import json
import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

from reasoned_explorer.calls.chat import ChatAnswer, ChatRequest, TokenChoice

_BLOCK = re.compile(r"^<<<([A-Z]+) ([0-9a-f]{8})\n(.*?)\n\1 \2>>>$", re.MULTILINE | re.DOTALL)


def inside(user: str) -> dict[str, str]:
    """What stands within the fences of a question, by label in small letters."""
    return {match[1].lower(): match[3] for match in _BLOCK.finditer(user)}


def outside(user: str) -> str:
    """A question without what stands within its fences."""
    return _BLOCK.sub("[data]", user)


@dataclass
class Fake:
    """Answers with what its `says` makes of a request; keeps what it was asked."""

    says: Callable[[ChatRequest], ChatAnswer | str]
    name: str = "fake"
    fingerprint: str = "fake"
    is_local: bool = True
    seconds: float = 0.0
    asked: list[ChatRequest] = field(default_factory=list)

    async def ask(self, request: ChatRequest) -> ChatAnswer:
        self.asked.append(request)
        if self.seconds:
            await asyncio.sleep(self.seconds)
        said = self.says(request)
        return ChatAnswer(said) if isinstance(said, str) else said


def fair(request: ChatRequest) -> dict[str, Any]:
    """What a fair model would answer, from what stands within the fences alone."""
    data = inside(request.user)
    if request.role == "visionary":
        return {"scene": "A footpath leads on between trees, and a small square comes into view."}
    sought = data["goal"].rstrip(".").split()[-1].casefold()
    seen = sought in data["scene"].casefold()
    if request.role == "checker":
        near = seen and "close" in data["scene"]
        return {"evidence": f"close by, a {sought}" if near else "", "found": near, "confidence": 0.9}
    return {"blocked": "wall" in data["scene"], "forbidden": False, "level": 5 if seen else 2}


def lines(said: dict[str, Any]) -> str:
    words = {True: "yes", False: "no"}
    if "scene" in said:
        return str(said["scene"])
    return "\n".join(f"{k.upper()}: {words[v] if isinstance(v, bool) else v}" for k, v in said.items())


def fair_json() -> Fake:
    return Fake(lambda request: json.dumps(fair(request)))


def fair_lines() -> Fake:
    return Fake(lambda request: lines(fair(request)))


def _prose(request: ChatRequest) -> str:
    said = fair(request)
    if "scene" in said:
        return f"Sure! Here is what comes next:\n\n{said['scene']}"
    if "found" in said:
        return "Yes, that is what I see close by." if said["found"] else "No. Nothing of that kind is close by."
    return f"Looking at the surroundings, I would rate this scene a {said['level']} out of 5."


def _commented(request: ChatRequest) -> str:
    return f"Certainly, here you go:\n{json.dumps(fair(request))}\nLet me know if you need 3 more of these!"


def _other_digits(request: ChatRequest) -> str:
    return json.dumps(fair(request)).translate(str.maketrans("0123456789", "٠١٢٣٤٥٦٧٨٩"))


def _in_words(request: ChatRequest) -> str:
    said = fair(request)
    said |= {"level": {2: "unlikely", 5: "Very likely"}[said["level"]]} if "level" in said else {}
    return json.dumps(said)


def _strings(request: ChatRequest) -> str:
    return json.dumps({name: str(value) for name, value in fair(request).items()})


#: They answer in a form of their own, and what they say is clear.
UNDERSTOOD: dict[str, Callable[[ChatRequest], ChatAnswer | str]] = {
    "keeps to the schema": lambda request: json.dumps(fair(request)),
    "answers in lines": lambda request: lines(fair(request)),
    "ignores the schema and answers in prose": _prose,
    "wraps JSON in a code fence": lambda request: f"```json\n{json.dumps(fair(request), indent=1)}\n```",
    "adds commentary": _commented,
    "says the level as a word": _in_words,
    "writes another language's digits": _other_digits,
    "adds keys": lambda request: json.dumps({"id": 7, "thoughts": ["level 1?"], **fair(request), "model": {"n": 1}}),
    "writes everything as strings": _strings,
    "writes as Python does": lambda request: str(fair(request)),
    "leaves a comma behind": lambda request: json.dumps(fair(request))[:-1] + ",}",
    "nests its answer": lambda request: json.dumps({"answer": [fair(request)]}),
    "thinks aloud before": lambda request: f"<think>Level 1? found: no? {{</think>\n\n{json.dumps(fair(request))}",
    "writes in bold": lambda request: "\n".join(
        line.replace(": ", ":** ", 1) if "scene" in fair(request) else "**" + line.replace(":", ":**", 1)
        for line in lines(fair(request)).splitlines()
    ),
    "shouts its keys": lambda request: json.dumps({name.upper(): value for name, value in fair(request).items()}),
}

#: Nothing that they say may count.
NOT_UNDERSTOOD: dict[str, Callable[[ChatRequest], ChatAnswer | str]] = {
    "is cut off": lambda request: json.dumps(fair(request))[:-3],
    "is cut off while it thinks": lambda request: "<think>The level could be 4, since found: yes",
    "declines": lambda request: "I'm sorry, but I can't help with that.",
    "says nothing": lambda request: " \n",
    "says several things": lambda request: (
        '{"level": 1, "found": false, "scene": "A wide road leads on."}\n'
        'Or: {"level": 4, "found": true, "scene": "A narrow path leads on."}'
    ),
    "says a thing twice in one object": lambda request: '{"level": 1, "level": 5, "found": true, "found": false}',
    "is off the scale": lambda request: '{"level": 7, "found": "perhaps", "scene": 5}',
    "uses another scale": lambda request: '{"level": "8/10", "found": 0.7, "scene": null}',
    "has wrong types": lambda request: '{"level": [4], "found": {"value": true}, "scene": ["a", "b"]}',
    "says true for a level": lambda request: '{"level": true, "found": "true or false", "scene": ""}',
    "says that it is no number": lambda request: '{"level": NaN, "found": NaN, "scene": NaN}',
    "repeats the form": lambda request: '{"level": "1-5", "found": "yes/no", "scene": "..."}',
    "lists things": lambda request: "1. a tree\n2. a road",
    "counts below the scale": lambda request: "-1",
    "answers with braces only": lambda request: "{" * 5000,
}


def with_logprobs(*places: tuple[str, dict[str, float]]) -> ChatAnswer:
    """An answer whose places were told with the probabilities of their alternatives."""
    tokens = tuple(
        TokenChoice(token, tuple((other, math.log(chance) if chance else -9999.0) for other, chance in others.items()))
        for token, others in places
    )
    return ChatAnswer("".join(place.token for place in tokens).strip(), tokens=tokens)


def in_turn(answers: Sequence[ChatAnswer | str]) -> Callable[[ChatRequest], ChatAnswer | str]:
    """Answers one after the other."""
    left = iter(answers)
    return lambda request: next(left)
