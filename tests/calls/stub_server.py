"""A server on this machine that speaks OpenAI's chat completions and misbehaves as it is told.

In tests it runs in a thread (``with StubServer(...) as server``) and shows what it was asked. Run as a program it
serves in a process of its own until its standard input closes, for benchmarks::

    python -m tests.calls.stub_server --latency 1.0 --rate 50 --burst 50

What goes wrong comes from a script (one word for each request, in order) or from a share of all requests, drawn from
what is asked and how often it was asked before, so that it does not depend on order.
"""

import argparse
import asyncio
import hashlib
import json
import math
import sys
import threading
import time
from collections import Counter, deque
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, Self

from aiohttp import web

FAULTS = (
    "hang",
    "429",
    "500",
    "503",
    "drop",
    "half body",
    "truncated json",
    "html",
    "wrong types",
    "empty",
    "no choices",
    "refusal",
    "filtered",
    "cut off",
)
"""Words of a script; ``ok`` is a sound answer, and ``401``, ``quota`` and ``redirect`` are answered as they say."""


class BucketLimit:
    """So many requests a second, and so many at once after a pause.

    Args:
        per_s: That are let in, on average.
        burst: At most at once.
    """

    def __init__(self, per_s: float, burst: float) -> None:
        self.per_s, self.burst = per_s, burst
        self._level, self._at_s = burst, time.monotonic()

    def admit(self) -> float | None:
        """Return None where one more is let in, else the seconds after which it would be."""
        now_s = time.monotonic()
        self._level = min(self.burst, self._level + self.per_s * (now_s - self._at_s))
        self._at_s = now_s
        if self._level >= 1.0:
            self._level -= 1.0
            return None
        return (1.0 - self._level) / self.per_s

    def headers(self) -> dict[str, str]:
        """Return the state as OpenAI tells it."""
        return {
            "x-ratelimit-limit-requests": f"{self.burst:.0f}",
            "x-ratelimit-remaining-requests": f"{max(0, math.floor(self._level))}",
            "x-ratelimit-reset-requests": f"{1e3 * (self.burst - math.floor(self._level)) / self.per_s:.0f}ms",
        }


class WindowLimit:
    """At most so many requests in any stretch of so many seconds."""

    def __init__(self, count: int, window_s: float) -> None:
        self.count, self.window_s = count, window_s
        self._times: deque[float] = deque()

    def admit(self) -> float | None:
        """Return None where one more is let in, else the seconds after which it would be."""
        now_s = time.monotonic()
        while self._times and self._times[0] <= now_s - self.window_s:
            self._times.popleft()
        if len(self._times) < self.count:
            self._times.append(now_s)
            return None
        return self._times[0] + self.window_s - now_s

    def headers(self) -> dict[str, str]:
        """Tell nothing: most servers with windows do not."""
        return {}


Answerer = Callable[[Mapping[str, Any]], str]


@dataclass(frozen=True, slots=True)
class Behaviour:
    """How the server behaves.

    Attributes:
        latency_s: From a request to its answer, however many there are.
        script: A word for each request, in order; sound answers after its end.
        fault_share: Of the requests that go wrong beside the script, in [0, 1].
        faults: What may happen to these.
        seed: Of the draws.
        answer: The text for a request; None for a made-up one that satisfies the schema that it asks for.
        limit: Turns away what is too much.
        retry_after: How a 429 says when to come back: ``ms``, ``seconds``, ``date`` or ``none``.
        tells_limit: Whether answers carry ``x-ratelimit-*``.
        ignores_format: Answers 200 and plain text whatever form is asked for.
        on_schema: Status of the answer to a request with a JSON schema; 200 for a sound one.
        refused_parameters: Answered with 400 where a request has one.
        on_system: Status of the answer to a request with a system; 200 for a sound one.
        tells_logprobs: Whether log-probabilities are told where they are wanted.
        tells_usage: Whether tokens are counted.
        at_once: At most so many are worked on, the others wait; None for all.
        together: Nobody is answered before so many are under way at the same time.
        decides: It answers typed questions at ``/v1/decisions``, as `sober` would.
    """

    latency_s: float = 0.0
    script: tuple[str, ...] = ()
    fault_share: float = 0.0
    faults: tuple[str, ...] = FAULTS
    seed: int = 0
    answer: Answerer | None = None
    limit: BucketLimit | WindowLimit | None = None
    retry_after: str = "ms"
    tells_limit: bool = False
    ignores_format: bool = False
    on_schema: int = 200
    refused_parameters: frozenset[str] = frozenset()
    on_system: int = 200
    tells_logprobs: bool = True
    tells_usage: bool = True
    at_once: int | None = None
    together: int = 0
    decides: bool = False


@dataclass(frozen=True, slots=True)
class Received:
    """A request as it came.

    Attributes:
        body: The parsed JSON.
        headers: With names in lower case.
        at_s: Monotonic seconds.
        told: What was done with it.
        port: Of the connection that it came over.
    """

    body: Mapping[str, Any]
    headers: Mapping[str, str]
    at_s: float
    told: str
    port: int


@dataclass(eq=False)
class StubServer:
    """The server, in a thread of its own.

    Attributes:
        behaviour: May be replaced while it runs.
        received: All requests so far, in order.
        most_at_once: The most that were under way at the same time.
    """

    behaviour: Behaviour = field(default_factory=Behaviour)
    received: list[Received] = field(default_factory=list)
    most_at_once: int = 0

    def __post_init__(self) -> None:
        self._script = deque(self.behaviour.script)
        self._asked: Counter[str] = Counter()
        self._under_way = 0
        self._ready = threading.Event()
        self._loop = asyncio.new_event_loop()
        self._port = 0
        self._thread = threading.Thread(target=self._serve, name="stub server", daemon=True)

    @property
    def base_url(self) -> str:
        return f"http://127.0.0.1:{self._port}/v1"

    @property
    def told(self) -> Counter[str]:
        """What was done, counted."""
        return Counter(each.told for each in self.received)

    def says(self, words: Iterable[str]) -> None:
        """Add to the script."""
        self._script.extend(words)

    def __enter__(self) -> Self:
        self._thread.start()
        if not self._ready.wait(30.0):
            raise RuntimeError("the stub server did not start")
        return self

    def __exit__(self, *_: object) -> None:
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()

    def _serve(self) -> None:
        asyncio.set_event_loop(self._loop)
        runner = self._loop.run_until_complete(self._start())
        self._ready.set()
        try:
            self._loop.run_forever()
        finally:
            self._loop.run_until_complete(runner.cleanup())
            left = asyncio.all_tasks(self._loop)  # what hangs
            for task in left:
                task.cancel()
            self._loop.run_until_complete(asyncio.gather(*left, return_exceptions=True))
            self._loop.run_until_complete(self._loop.shutdown_asyncgens())
            self._loop.close()

    async def _start(self) -> web.AppRunner:
        app = web.Application(client_max_size=64 * 2**20)
        app.router.add_post("/v1/chat/completions", self._complete)
        app.router.add_post("/v1/decisions", self._complete)
        # what hangs must not keep the server from ending
        runner = web.AppRunner(app, handle_signals=False, access_log=None, shutdown_timeout=0.01)
        await runner.setup()
        site = web.TCPSite(runner, "127.0.0.1", 0, backlog=1024)
        await site.start()
        self._port = runner.addresses[0][1]
        at_once = self.behaviour.at_once
        self._all_here = asyncio.Event()
        self._places = None if at_once is None else asyncio.Semaphore(at_once)
        return runner

    async def _complete(self, request: web.Request) -> web.StreamResponse:
        at_s = time.monotonic()
        body = await request.json()
        headers = {name.lower(): value for name, value in request.headers.items()}
        word = self._word(body)
        limit = self.behaviour.limit
        wait_s = limit.admit() if limit is not None else None
        if wait_s is not None:
            word = "turned away"
        port = request.transport.get_extra_info("peername")[1] if request.transport is not None else 0
        self.received.append(Received(body, headers, at_s, word, port))
        told = limit.headers() if limit is not None and self.behaviour.tells_limit else {}
        if wait_s is not None:
            return self._turned_away(wait_s, told)
        self._under_way += 1
        self.most_at_once = max(self.most_at_once, self._under_way)
        try:
            if self._under_way >= self.behaviour.together:
                self._all_here.set()
            await self._all_here.wait()
            if self._places is None:
                await asyncio.sleep(self.behaviour.latency_s)
            else:
                async with self._places:
                    await asyncio.sleep(self.behaviour.latency_s)
            response = await self._respond(request, body, word)
        finally:
            self._under_way -= 1
        if not response.prepared:
            response.headers.update(told)
        return response

    def _word(self, body: Mapping[str, Any]) -> str:
        if self._script:
            return self._script.popleft()
        behaviour = self.behaviour
        if behaviour.fault_share <= 0.0:
            return "ok"
        text = json.dumps(body, sort_keys=True)
        self._asked[text] += 1
        drawn = hashlib.sha256(f"{behaviour.seed}|{self._asked[text]}|{text}".encode()).digest()
        if int.from_bytes(drawn[:8], "big") >= behaviour.fault_share * 2**64:
            return "ok"
        return behaviour.faults[drawn[8] % len(behaviour.faults)]

    def _turned_away(self, wait_s: float, told: Mapping[str, str]) -> web.Response:
        way = self.behaviour.retry_after
        headers = dict(told)
        if way == "ms":
            headers["retry-after-ms"] = f"{math.ceil(1e3 * wait_s)}"
        elif way == "seconds":
            headers["retry-after"] = f"{math.ceil(wait_s)}"
        elif way == "date":
            at = time.time() + math.ceil(wait_s) + 1
            headers["retry-after"] = time.strftime("%a, %d %b %Y %H:%M:%S GMT", time.gmtime(at))
        return _error(429, "Rate limit reached", code="rate_limit_exceeded", headers=headers)

    async def _respond(self, request: web.Request, body: Mapping[str, Any], word: str) -> web.StreamResponse:
        behaviour = self.behaviour
        if "questions" in body and not behaviour.decides:
            return _error(404, "Not Found")
        refusal = None if "questions" in body else _refusal(behaviour, body)
        if refusal is not None:
            return refusal
        if word in _ERRORS:
            return _ERRORS[word](request)
        if word == "hang":
            await asyncio.sleep(3600.0)
        if word == "drop":
            if request.transport is not None:
                request.transport.abort()
            return web.Response()
        if word == "half body":
            return await self._half(request, json.dumps(self._completion(body)).encode())
        if word == "html":
            return web.Response(text="<html><body>Bad gateway</body></html>", content_type="text/html")
        completion = self._completion(body)
        if word == "truncated json":
            return web.Response(text=json.dumps(completion)[:-40], content_type="application/json")
        (_mar_decision if "questions" in body else _mar_completion)(completion, word)
        return web.json_response(completion)

    async def _half(self, request: web.Request, whole: bytes) -> web.StreamResponse:
        response = web.StreamResponse(headers={"content-type": "application/json"})
        response.content_length = len(whole)
        await response.prepare(request)
        await response.write(whole[: len(whole) // 2])
        if request.transport is not None:
            request.transport.abort()
        return response

    def _completion(self, body: Mapping[str, Any]) -> dict[str, Any]:
        if "questions" in body:
            return decided(body)
        behaviour = self.behaviour
        text = behaviour.answer(body) if behaviour.answer is not None else self._made_up(body)
        choice: dict[str, Any] = {
            "index": 0,
            "message": {"role": "assistant", "content": text, "refusal": None},
            "finish_reason": "stop",
            "logprobs": None,
        }
        if body.get("logprobs") and behaviour.tells_logprobs:
            choice["logprobs"] = {"content": [_place(word, body.get("top_logprobs", 0)) for word in text.split()]}
        completion = {
            "id": "chatcmpl-stub",
            "object": "chat.completion",
            "created": 0,
            "model": f"{body.get('model')}-stub",
            "choices": [choice],
        }
        if behaviour.tells_usage:
            asked = sum(len(json.dumps(each["content"])) for each in body["messages"]) // 4
            completion["usage"] = {
                "prompt_tokens": asked,
                "completion_tokens": len(text) // 4 + 1,
                "total_tokens": asked + len(text) // 4 + 1,
            }
        return completion

    def _made_up(self, body: Mapping[str, Any]) -> str:
        form = body.get("response_format") or {}
        drawn = hashlib.sha256(json.dumps(body["messages"], sort_keys=True).encode()).digest()
        if self.behaviour.ignores_format or not form:
            return f"A bench stands beside a path; number {drawn[0]} is on a tree."
        if form.get("type") == "json_schema":
            return json.dumps(_instance(form["json_schema"]["schema"], drawn[0]))
        return json.dumps({"answer": drawn[0]})


def _instance(schema: Mapping[str, Any], number: int) -> Any:
    """Return something that satisfies a schema; which, depends on a number from 0 to 255."""
    if "enum" in schema:
        return schema["enum"][number % len(schema["enum"])]
    kind = schema.get("type")
    low, high = schema.get("minimum", 0), schema.get("maximum", 1)
    match kind:
        case "object":
            properties = schema.get("properties", {})
            return {name: _instance(each, number + place) for place, (name, each) in enumerate(properties.items())}
        case "array":
            return [_instance(schema["items"], number + place) for place in range(schema.get("minItems", 1))]
        case "integer":
            return int(low) + number % (int(high) - int(low) + 1)
        case "number":
            return low + (high - low) * (number % 256) / 255.0
        case "boolean":
            return number % 2 == 1
        case _:
            return f"word {number}"


def _mar_completion(completion: dict[str, Any], word: str) -> None:
    _MARS.get(word, _unspoiled)(completion)


def _mar_decision(decision: dict[str, Any], word: str) -> None:
    if word in {"refusal", "filtered"}:
        decision["answers"] = [{"type": "refusal", "name": each["name"]} for each in decision["answers"]]
    elif word in {"empty", "no choices", "cut off"}:
        decision["answers"] = []
    elif word == "wrong types":
        decision["answers"] = "yes"


def decided(body: Mapping[str, Any]) -> dict[str, Any]:
    """Answer typed questions: no statement is true, and levels follow from what is asked about."""
    drawn = hashlib.sha256(json.dumps(body["input"], sort_keys=True).encode()).digest()
    answers: list[dict[str, Any]] = []
    for question in body["questions"]:
        if question["type"] == "predicate":
            answers.append({"type": "predicate", "name": question.get("name"), "probability": drawn[0] / 1024.0})
            continue
        labels = [level["label"] for level in question["levels"]]
        weights = [1.0 + 8.0 * (place == drawn[1] % len(labels)) for place in range(len(labels))]
        chances = [
            {"label": label, "probability": weight / sum(weights), "value": value}
            for value, (label, weight) in enumerate(zip(labels, weights, strict=True))
        ]
        score = sum(each["value"] * each["probability"] for each in chances)
        answers.append(
            {"type": "score", "name": question.get("name"), "score": score, "confidence": 0.5, "probabilities": chances}
        )
    asked = len(json.dumps(body)) // 4
    details = {"input_tokens_details": {"cache_write_tokens": 0, "cached_tokens": 0}}
    usage = {"input_tokens": asked, "output_tokens": 3, "total_tokens": asked + 3, **details}
    return {"answers": answers, "model": f"{body['model']}-stub", "usage": usage}


def sober(body: Mapping[str, Any]) -> str:
    """Answer each form that is asked for: levels that follow from the question, and nothing is ever found."""
    drawn = hashlib.sha256(json.dumps(body["messages"], sort_keys=True).encode()).digest()[0]
    schema = (body.get("response_format") or {}).get("json_schema", {}).get("schema")
    if schema is None:
        return f"A path leads on between trees, {drawn} steps long."
    answer: dict[str, Any] = {}
    for name, each in schema["properties"].items():
        if "enum" in each:
            answer[name] = each["enum"][drawn % len(each["enum"])]
        elif each["type"] == "boolean":
            answer[name] = False
        elif each["type"] in {"integer", "number"}:
            low, high = each.get("minimum", 0), each.get("maximum", 1)
            answer[name] = low + drawn % (high - low + 1) if each["type"] == "integer" else 0.5
        else:
            answer[name] = f"a path that leads on, {drawn} steps long"
    return json.dumps(answer)


def _place(word: str, count: int) -> dict[str, Any]:
    told = [{"token": f"{word}{rank if rank else ''}", "logprob": -0.1 - rank} for rank in range(count)]
    return {"token": word, "logprob": -0.1, "bytes": None, "top_logprobs": told}


def _refusal(behaviour: Behaviour, body: Mapping[str, Any]) -> web.Response | None:
    refused = sorted(behaviour.refused_parameters & set(body))
    if refused:
        message = f"Unsupported parameter: '{refused[0]}' is not supported with this model."
        return _error(400, message, code="unsupported_parameter", param=refused[0])
    if behaviour.on_system != 200 and body["messages"][0]["role"] == "system":
        return _error(behaviour.on_system, "System role not supported")
    asks_schema = body.get("response_format", {}).get("type") == "json_schema"
    if asks_schema and behaviour.on_schema != 200:
        return _error(behaviour.on_schema, "response_format json_schema")
    return None


def _error(
    status: int,
    message: str,
    *,
    code: str | None = None,
    param: str | None = None,
    headers: Mapping[str, str] | None = None,
) -> web.Response:
    error = {"message": message, "type": "stub", "param": param, "code": code}
    return web.json_response({"error": error}, status=status, headers=dict(headers or {}))


def _wrong_key(request: web.Request) -> web.Response:
    # As OpenAI does, it says the key back.
    return _error(401, f"Incorrect API key provided: {request.headers.get('authorization')}", code="invalid_api_key")


_ERRORS: dict[str, Callable[[web.Request], web.Response]] = {
    "429": lambda _: _error(429, "Rate limit reached", headers={"retry-after-ms": "30"}),
    "429 at once": lambda _: _error(429, "Rate limit reached", headers={"retry-after": "0"}),
    "429 for an hour": lambda _: _error(429, "Rate limit reached", headers={"retry-after": "3600"}),
    "quota": lambda _: _error(429, "You exceeded your current quota", code="insufficient_quota"),
    "500": lambda _: _error(500, "The server had an error"),
    "503": lambda _: _error(503, "Overloaded"),
    "401": _wrong_key,
    "404": lambda _: _error(404, "The model does not exist", code="model_not_found"),
    "redirect": lambda request: web.Response(status=307, headers={"location": str(request.url.with_host("localhost"))}),
}


def _unspoiled(_completion: dict[str, Any]) -> None:
    pass


def _mar(**message: Any) -> Callable[[dict[str, Any]], None]:
    def change(completion: dict[str, Any]) -> None:
        completion["choices"][0]["message"].update(message)

    return change


def _cut(completion: dict[str, Any]) -> None:
    choice = completion["choices"][0]
    choice["message"]["content"] = choice["message"]["content"][:5]
    choice["finish_reason"] = "length"


_MARS: dict[str, Callable[[dict[str, Any]], None]] = {
    "wrong types": _mar(content=7),
    "empty": _mar(content=""),
    "no choices": lambda completion: completion.update(choices=[]),
    "refusal": _mar(content=None, refusal="I cannot help with that."),
    "filtered": lambda completion: completion["choices"][0].update(finish_reason="content_filter"),
    "cut off": _cut,
}


def main() -> None:
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--latency", type=float, default=0.0)
    options.add_argument("--rate", type=float, help="requests a second")
    options.add_argument("--burst", type=float, default=1.0)
    options.add_argument("--window", type=float, help="seconds; the rate is then kept over each stretch of so many")
    options.add_argument("--retry-after", default="ms", choices=["ms", "seconds", "date", "none"])
    options.add_argument("--tells-limit", action="store_true")
    options.add_argument("--fault-share", type=float, default=0.0)
    given = options.parse_args()
    limit: BucketLimit | WindowLimit | None = None
    if given.rate and given.window:
        limit = WindowLimit(round(given.rate * given.window), given.window)
    elif given.rate:
        limit = BucketLimit(given.rate, given.burst)
    behaviour = Behaviour(
        latency_s=given.latency,
        limit=limit,
        retry_after=given.retry_after,
        tells_limit=given.tells_limit,
        fault_share=given.fault_share,
    )
    with StubServer(behaviour) as server:
        print(server.base_url, flush=True)
        sys.stdin.read()
        print(json.dumps(server.told), flush=True)


if __name__ == "__main__":
    main()
