import asyncio
import io
import json
from collections.abc import Callable

import pytest
from PIL import Image

from reasoned_explorer.calls.abilities import Abilities, probe
from reasoned_explorer.calls.chat import ANY_OBJECT, ChatAnswer, ChatRequest, TokenChoice
from reasoned_explorer.clock import VirtualClock


class Server:
    """An endpoint that can do some things, answers 200 to all, and takes one second a call, so many at a time."""

    name = fingerprint = "server"
    is_local = True

    def __init__(self, *able: str, at_once: int = 100) -> None:
        self.able = able
        self.asked: list[ChatRequest] = []
        self._places = asyncio.Semaphore(at_once)

    async def ask(self, request: ChatRequest) -> ChatAnswer:
        self.asked.append(request)
        async with self._places:
            await asyncio.sleep(1.0)
        tokens: tuple[TokenChoice, ...] = ()
        if request.images:
            text = self._colour(request.images[0]) if "vision" in self.able else "A red or a green picture, I think."
        elif request.schema == ANY_OBJECT:
            text = json.dumps({"text": "a way over"}) if "json_object" in self.able else "A way over."
        elif request.schema is not None:
            text = '{"kind_of_thing": "building", "level": 3}' if "json_schema" in self.able else "A way over a river."
        elif "digit" in request.user:
            text = "3"
            if "logprobs" in self.able and request.top_logprobs:
                tokens = (TokenChoice("3", (("3", -0.2), ("4", -2.0), (" 3", -4.0))),)
            elif "logprobs of one" in self.able:
                tokens = (TokenChoice("3", (("3", 0.0),)),)
        else:
            text = "ready"
        return ChatAnswer(text, tokens_in=20, tokens_out=2, usd=0.001, model="served-model", tokens=tokens)

    @staticmethod
    def _colour(picture: bytes) -> str:
        red, green, _ = Image.open(io.BytesIO(picture)).getpixel((5, 5))
        return "Red." if red > green else "green"


def probed(model: Server | Callable[[ChatRequest], ChatAnswer], **options: int) -> Abilities:
    clock = VirtualClock()
    return clock.run(probe(model, **options))  # type: ignore[arg-type]


def test_what_a_server_can_do_is_found_by_what_it_answers():
    found = probed(Server("json_schema", "json_object", "logprobs", "vision"))
    assert (found.json_schema, found.json_object, found.top_logprobs, found.vision) == (True, True, 3, True)
    assert (found.calls, found.tokens, found.model, found.faults) == (16, 352, "served-model", ())
    assert found.usd == pytest.approx(0.016)
    assert found.latency_s == pytest.approx(1.0)
    assert found.answers


def test_a_server_that_answers_and_ignores_what_it_is_asked_for_can_do_nothing_of_it():
    found = probed(Server())
    assert (found.json_schema, found.json_object, found.top_logprobs, found.vision) == (False, False, 0, False)
    assert found.answers
    assert probed(Server("logprobs of one")).top_logprobs == 0


def test_each_ability_is_found_alone():
    assert [probed(Server(*able)).structure for able in (("json_schema",), ("json_object",), ())] == [
        "json_schema", "json_object", "none",
    ]  # fmt: skip
    assert probed(Server("json_object")).json_object
    assert not probed(Server("json_object")).json_schema
    assert probed(Server("logprobs")).top_logprobs == 3
    assert probed(Server("vision")).vision


@pytest.mark.parametrize(
    "text",
    [
        '{"level": 3}',
        '{"kind_of_thing": "bridge", "level": 3}',
        '{"kind_of_thing": ["building"], "level": 3}',
        '{"kind_of_thing": "building", "level": "3"}',
        '{"kind_of_thing": "building", "level": true}',
        '{"kind_of_thing": "building", "level": 3, "more": 1}',
        '```json\n{"kind_of_thing": "building", "level": 3}\n```',
        "[" * 100_000,
    ],
)
def test_an_answer_that_does_not_fit_the_schema_whole_is_no_keeping_to_it(text: str):
    class Nearly(Server):
        async def ask(self, request: ChatRequest) -> ChatAnswer:
            return ChatAnswer(text) if request.schema not in (None, ANY_OBJECT) else await super().ask(request)

    assert not probed(Nearly()).json_schema


def test_a_server_that_fails_on_a_schema_only_is_told_apart_from_one_that_is_away():
    class Fails(Server):
        async def ask(self, request: ChatRequest) -> ChatAnswer:
            if request.schema not in (None, ANY_OBJECT):
                return ChatAnswer(fault="status 500", usd=None)
            return await super().ask(request)

    found = probed(Fails("json_object", "vision"))
    assert (found.json_schema, found.json_object, found.vision, found.faults) == (False, True, True, ("status 500",))
    assert found.usd is None

    class Away(Server):
        async def ask(self, request: ChatRequest) -> ChatAnswer:
            self.asked.append(request)
            return ChatAnswer(fault="no connection")

    away = Away()
    found = probed(away)
    assert not found.answers
    assert (found.latency_s, found.faults, len(away.asked)) == (None, ("no connection",), 2)


@pytest.mark.parametrize(("at_once", "seen"), [(1, 1.0), (4, 4.0), (100, 8.0)])
def test_parallelism_is_seconds_alone_by_seconds_together(at_once: int, seen: float):
    assert probed(Server(at_once=at_once)).parallel == pytest.approx(seen)
    assert probed(Server(at_once=at_once), together=1).parallel == pytest.approx(1.0)


def test_one_picture_that_is_guessed_right_is_no_seeing():
    class Guesses(Server):
        async def ask(self, request: ChatRequest) -> ChatAnswer:
            return ChatAnswer("red") if request.images else await super().ask(request)

    assert not probed(Guesses()).vision


def test_one_that_only_describes_pictures_is_shown_some_and_asked_nothing_else():
    class Describer(Server):
        only_describes = True

    server = Describer("vision")
    found = probed(server, together=4)
    assert all(request.images for request in server.asked)
    assert (found.vision, found.json_object, found.top_logprobs) == (True, False, 0)
    assert (found.calls, found.latency_s, found.parallel) == (6, 1.0, 4.0)
