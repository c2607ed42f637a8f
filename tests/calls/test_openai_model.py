"""The client against a real server on this machine that misbehaves as it is told."""

import asyncio
import gc
import json
import logging
import subprocess
import sys
from collections.abc import Coroutine
from dataclasses import replace
from typing import Any

import pytest

pytest.importorskip("openai")
pytest.importorskip("aiohttp")

from reasoned_explorer.calls.chat import ChatAnswer, ChatRequest
from reasoned_explorer.calls.endpoint import AskingSettings, Endpoint
from reasoned_explorer.calls.openai_model import OpenAIModel, openai_model
from reasoned_explorer.calls.pacing import Limits
from reasoned_explorer.calls.prices import Price
from reasoned_explorer.model import MissingDependencyError, SettingsError
from tests.calls.stub_server import FAULTS, Behaviour, BucketLimit, StubServer

KEY = "planted-key-0123456789"
SCHEMA = {
    "type": "object",
    "properties": {"level": {"type": "integer", "minimum": 1, "maximum": 5}, "is_blocked": {"type": "boolean"}},
    "required": ["level", "is_blocked"],
    "additionalProperties": False,
}
QUICK = AskingSettings(back_off_s=0.001)


def settings_for(word: str, **options: Any) -> AskingSettings:
    """Wait for what hangs only: a busy machine must not time out what would have been answered."""
    return AskingSettings(try_s=1.0 if word == "hang" else 60.0, back_off_s=0.001, **options)


def question(number: int = 0, **options: Any) -> ChatRequest:
    return ChatRequest("evaluator", (number,), "You judge scenes.", f"Scene {number}.", "evaluator/1", **options)


def model_at(server: StubServer, settings: AskingSettings = QUICK) -> OpenAIModel:
    return openai_model("openai:tiny", base_url=server.base_url, settings=settings)


def ask(server: StubServer, request: ChatRequest | None = None, settings: AskingSettings = QUICK) -> ChatAnswer:
    return asyncio.run(model_at(server, settings).ask(request or question()))


def test_an_answer_comes_with_its_tokens_and_its_model() -> None:
    with StubServer(Behaviour(answer=lambda body: "A fountain.")) as server:
        answer = ask(server)
    assert answer == ChatAnswer("A fountain.", tokens_in=7, tokens_out=3, usd=0.0, model="tiny-stub")


def test_what_is_sent() -> None:
    with StubServer() as server:
        ask(server, question(3, images=(b"\x89PNG...", b"\xff\xd8\xff..."), schema=SCHEMA, seed=7, max_tokens=50))
    body = server.received[0].body
    assert (body["model"], body["seed"], body["temperature"], body["max_tokens"]) == ("tiny", 7, 0.0, 50)
    system, user = body["messages"]
    assert system == {"role": "system", "content": "You judge scenes."}
    assert user["content"][0] == {"type": "text", "text": "Scene 3."}
    assert [each["image_url"]["url"].split(",")[0] for each in user["content"][1:]] == [
        "data:image/png;base64",
        "data:image/jpeg;base64",
    ]
    assert body["response_format"]["json_schema"] == {"name": "evaluator", "strict": True, "schema": SCHEMA}


def test_the_form_can_be_asked_for_in_other_ways() -> None:
    async def forms(model: OpenAIModel) -> None:
        await model.asking("json_object").ask(question(schema=SCHEMA))
        await model.asking("none").ask(question(schema=SCHEMA))

    with StubServer() as server:
        model = model_at(server)
        asyncio.run(forms(model))
    assert [each.body.get("response_format") for each in server.received] == [{"type": "json_object"}, None]
    assert model.asking("none").fingerprint != model.fingerprint


def test_structured_answers_and_log_probabilities() -> None:
    with StubServer() as server:
        answer = ask(server, question(schema=SCHEMA, top_logprobs=3))
    assert json.loads(answer.text)["level"] in range(1, 6)
    first = answer.tokens[0]
    assert first.token == answer.text.split()[0]
    assert [logprob for _, logprob in first.alternatives] == pytest.approx([-0.1, -1.1, -2.1])


@pytest.mark.parametrize(
    "word", ["hang", "429", "500", "503", "drop", "half body", "truncated json", "html", "wrong types", "no choices"]
)
def test_what_passes_is_tried_again(word: str) -> None:
    with StubServer(Behaviour(script=(word, word))) as server:
        answer = ask(server, settings=settings_for(word))
    assert answer.fault is None
    assert answer.text
    assert answer.retries == 2


@pytest.mark.parametrize(
    ("word", "fault", "asked"),
    [
        ("hang", "timeout: no answer within", 3),
        ("500", "server error: status 500: The server had an error", 4),  # once without a system
        ("503", "server error: status 503", 3),
        ("drop", "connection: ServerDisconnectedError", 3),
        ("half body", "connection: ", 3),
        ("truncated json", "malformed: the answer is no JSON", 3),
        ("html", "malformed: the answer is no JSON: '<html>", 3),
        ("wrong types", "wrong types: choices.0.message.content", 3),
        ("no choices", "wrong types: choices: there is none", 3),
        ("empty", "empty: no text", 2),
        ("refusal", "refused: I cannot help with that.", 1),
        ("filtered", "filtered: ", 1),
        ("404", "rejected: status 404: The model does not exist", 1),
        ("quota", "quota: status 429: You exceeded", 1),
        ("redirect", "redirected: status 307", 1),
        ("429 for an hour", "rate limit: no turn within 3600 s", 1),
    ],
)
def test_what_stays_is_a_fault_of_its_own_kind(word: str, fault: str, asked: int) -> None:
    with StubServer(Behaviour(script=(word,) * 6)) as server:
        answer = ask(server, settings=settings_for(word, tries=3))
    assert answer.fault is not None
    assert answer.fault.startswith(fault)
    assert answer.text == ""
    assert len(server.received) == asked
    assert answer.retries == asked - 1


def test_an_address_without_v1_that_is_not_found_is_asked_about() -> None:
    async def refused(base_url: str) -> str | None:
        return (await OpenAIModel("tiny", Endpoint(base_url), settings=QUICK).ask(question())).fault

    with StubServer(Behaviour(script=("404",))) as server:
        root = server.base_url.removesuffix("/v1")
        faults = [asyncio.run(refused(url)) for url in (root, f"{root}/api", server.base_url)]
    assert str(faults[0]).endswith(f"; did you mean {root}/v1?")
    assert str(faults[1]).endswith(f"; did you mean {root}/api/v1?")
    # What is not found where it is usually served is another matter, a model say.
    assert faults[2] == "rejected: status 404: The model does not exist"


def test_a_server_that_always_turns_away_is_given_up_in_the_end() -> None:
    settings = AskingSettings(patience_s=0.3)
    with StubServer(Behaviour(script=("429 at once",) * 100_000)) as server:
        answer = ask(server, settings=settings)
    assert answer.fault is not None
    assert answer.fault.startswith("rate limit: ")
    assert answer.retries > 0


def test_half_an_answer_is_kept_but_is_none_where_structure_was_wanted() -> None:
    with StubServer(Behaviour(script=("cut off", "cut off"))) as server:
        structured, caption = ask(server, question(schema=SCHEMA)), ask(server, question())
    assert structured.fault is not None
    assert structured.fault.startswith("cut off")
    assert structured.text == '{"lev'
    assert (caption.text, caption.fault) == ("A ben", None)


def test_a_server_that_is_not_there_is_a_fault() -> None:
    model = OpenAIModel("tiny", Endpoint("http://127.0.0.1:9/v1"), settings=QUICK)
    answer = asyncio.run(model.ask(question()))
    assert answer.fault is not None
    assert answer.fault.startswith("connection: ")
    assert answer.retries == QUICK.tries - 1


@pytest.mark.parametrize(
    "said",
    [
        b"what is this\r\n\r\n",
        b"HTTP/1.1 999999 OK\r\n\r\n",
        b"HTTP/1.1 200 OK\r\ntransfer-encoding: chunked\r\n\r\nzzz\r\n",
        b"HTTP/1.1 200 OK\r\ncontent-length: 5\r\ncontent-encoding: gzip\r\n\r\nhello",
        b"HTTP/1.1 200 OK\r\ncontent-length: 2\r\n\r\n\xff\xfe",
        b"HTTP/1.1 200 OK\r\ncontent-length: nine\r\n\r\n",
        b"HTTP/1.1 200 OK\r\nx: " + b"y" * 100_000 + b"\r\n\r\n",
        b"",
    ],
)
def test_what_is_not_even_http_is_a_fault(said: bytes) -> None:
    async def talk() -> ChatAnswer:
        async def answer(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
            await reader.readuntil(b"}")
            writer.write(said)
            await writer.drain()
            writer.close()

        server = await asyncio.start_server(answer, "127.0.0.1", 0)
        async with server:
            port = server.sockets[0].getsockname()[1]
            settings = AskingSettings(try_s=5.0, tries=2, back_off_s=0.001)
            return await OpenAIModel("tiny", Endpoint(f"http://127.0.0.1:{port}/v1"), settings=settings).ask(question())

    answer = asyncio.run(talk())
    assert answer.fault is not None
    assert answer.fault.split(":")[0] in {"connection", "malformed"}
    assert answer.retries == 1


def test_tries_do_not_outlast_the_deadline() -> None:
    settings = AskingSettings(deadline_s=0.5, try_s=0.2, tries=1000, back_off_s=0.001)
    with StubServer(Behaviour(script=("hang",) * 1000)) as server:
        answer = ask(server, settings=settings)
        assert answer.fault is not None
        assert len(server.received) <= 4


def test_tokens_of_tries_in_vain_are_counted_and_paid() -> None:
    price = Price(1.0, 2.0, None, "a test")
    with StubServer(Behaviour(script=("wrong types", "empty"), answer=lambda body: "A fountain.")) as server:
        model = OpenAIModel("tiny", Endpoint(server.base_url), settings=QUICK, price=price)
        answer = asyncio.run(model.ask(question()))
    assert (answer.tokens_in, answer.tokens_out, answer.retries) == (21, 9, 2)
    assert answer.usd == pytest.approx(39e-6)


@pytest.mark.parametrize(("price", "usd"), [(None, None), (Price(1.0, 1.0, None, ""), None)])
def test_what_is_not_known_is_not_free(price: Price | None, usd: float | None) -> None:
    with StubServer(Behaviour(tells_usage=False)) as server:
        model = OpenAIModel("tiny", Endpoint(server.base_url), settings=QUICK, price=price)
        assert asyncio.run(model.ask(question())).usd == usd


@pytest.mark.parametrize("names", [{"seed"}, {"temperature", "seed"}, {"logprobs", "top_logprobs"}, {"max_tokens"}])
def test_parameters_that_a_server_does_not_want_are_left_out_from_then_on(names: set[str]) -> None:
    async def twice(model: OpenAIModel) -> list[ChatAnswer]:
        return [await model.ask(question(0, top_logprobs=2)), await model.ask(question(1, top_logprobs=2))]

    with StubServer(Behaviour(refused_parameters=frozenset(names))) as server:
        model = model_at(server)
        answers = asyncio.run(twice(model))
    assert [answer.fault for answer in answers] == [None, None]
    assert answers[1].retries == 0
    assert not names & set(server.received[-1].body)
    assert model.left_out == model.asking("none").left_out == names - {"max_tokens"}
    assert ("max_completion_tokens" in server.received[-1].body) == ("max_tokens" in names)


def test_a_server_that_fails_on_schemas_fails_only_there() -> None:
    async def both(model: OpenAIModel) -> list[ChatAnswer]:
        return [await each.ask(question(schema=SCHEMA)) for each in (model, model.asking("json_object"))]

    with StubServer(Behaviour(on_schema=500)) as server:
        by_schema, by_object = asyncio.run(both(model_at(server)))
    assert by_schema.fault is not None
    assert by_schema.fault.startswith("server error")
    assert json.loads(by_object.text)


@pytest.mark.parametrize("status", [400, 500])
def test_a_model_that_knows_no_system_is_told_by_the_user(status: int) -> None:
    async def thrice(model: OpenAIModel) -> list[ChatAnswer]:
        first, second = await model.ask(question(0)), await model.ask(question(1))
        # What was learned of the model holds for other ways of asking it.
        return [first, second, await model.asking("none").ask(question(2))]

    with StubServer(Behaviour(on_system=status)) as server:
        model = model_at(server, replace(QUICK, tries=2))
        answers = asyncio.run(thrice(model))
    assert [answer.fault for answer in answers] == [None] * 3
    assert [answer.retries for answer in answers] == [2 if status == 500 else 1, 0, 0]
    assert server.received[-1].body["messages"] == [{"role": "user", "content": "You judge scenes.\n\nScene 2."}]


def test_a_server_that_stumbles_later_is_not_taken_for_one_without_a_system() -> None:
    async def twice(model: OpenAIModel) -> None:
        await model.ask(question(0))
        await model.ask(question(1))

    with StubServer(Behaviour(script=("ok", *("500",) * 9))) as server:
        asyncio.run(twice(model_at(server, replace(QUICK, tries=2))))
    assert [each.body["messages"][0]["role"] for each in server.received] == ["system"] * 3


def gathered(model: OpenAIModel, count: int) -> list[ChatAnswer]:
    async def all_at_once() -> list[ChatAnswer]:
        return await asyncio.gather(*(model.ask(question(number)) for number in range(count)))

    return asyncio.run(all_at_once())


def test_calls_go_at_the_same_time() -> None:
    with StubServer(Behaviour(together=40)) as server:
        answers = gathered(model_at(server), 40)
    assert all(answer.fault is None and answer.retries == 0 for answer in answers)


def test_models_of_an_endpoint_share_a_connection_that_is_kept() -> None:
    async def one_by_one(server: StubServer) -> None:
        for number in range(6):
            await openai_model(f"openai:model-{number % 2}", base_url=server.base_url).ask(question(number))

    with StubServer() as server:
        asyncio.run(one_by_one(server))
    assert len({each.port for each in server.received}) == 1


def test_everybody_who_asks_a_model_waits_in_the_same_line() -> None:
    settings = AskingSettings(limits=Limits(first_at_once=1, most_at_once=1))

    async def four(server: StubServer) -> None:
        await asyncio.gather(*(model_at(server, settings).ask(question(number)) for number in range(4)))

    with StubServer(Behaviour(latency_s=0.05)) as server:
        asyncio.run(four(server))
    assert server.most_at_once == 1


def test_a_known_limit_is_met_without_being_turned_away() -> None:
    settings = AskingSettings(limits=Limits(requests_per_minute=1200))
    with StubServer(Behaviour(limit=BucketLimit(20, 130))) as server:
        answers = gathered(model_at(server, settings), 130)
    assert all(answer.fault is None and answer.retries == 0 for answer in answers)


@pytest.mark.parametrize("retry_after", ["ms", "none"])
def test_who_is_turned_away_comes_back_until_it_is_served(retry_after: str) -> None:
    with StubServer(Behaviour(limit=BucketLimit(50, 5), retry_after=retry_after)) as server:
        answers = gathered(model_at(server), 15)
    assert all(answer.fault is None for answer in answers)
    assert server.told["turned away"] > 0


def test_one_call_in_five_goes_wrong_and_few_are_lost() -> None:
    with StubServer(Behaviour(fault_share=0.2)) as server:
        answers = gathered(model_at(server, settings_for("hang")), 300)
        faults = {answer.fault.split(":")[0] for answer in answers if answer.fault is not None}
        lost = sum(answer.fault is not None for answer in answers)
        assert set(server.told) == {"ok", *FAULTS}
    # A refusal, a filter and an answer that is empty twice are not asked for again and again.
    assert faults <= {"refused", "filtered", "empty"}
    assert lost < 0.06 * 300
    assert all(bool(answer.text) == (answer.fault is None) for answer in answers)


def test_a_cancelled_call_ends_and_gives_its_place_back() -> None:
    settings = AskingSettings(limits=Limits(first_at_once=1, most_at_once=1))

    async def cancel_one(model: OpenAIModel, server: StubServer) -> ChatAnswer:
        hanging = asyncio.create_task(model.ask(question(0)))
        while not server.received:
            await asyncio.sleep(0.01)
        hanging.cancel()
        with pytest.raises(asyncio.CancelledError):
            await hanging
        return await model.ask(question(1))

    with StubServer(Behaviour(script=("hang",))) as server:
        assert asyncio.run(cancel_one(model_at(server, settings), server)).fault is None


def run_with_warnings_as_errors(work: Coroutine[Any, Any, ChatAnswer]) -> ChatAnswer:
    try:
        return asyncio.run(work)
    finally:
        gc.collect()  # what was not closed complains when it is collected


@pytest.mark.filterwarnings("error")
def test_clients_end_with_their_event_loop(caplog: pytest.LogCaptureFixture) -> None:
    with StubServer() as server:
        model = model_at(server)
        for _ in range(3):
            assert run_with_warnings_as_errors(model.ask(question())).fault is None
    assert "Unclosed" not in caplog.text


def test_a_program_that_ends_says_nothing_of_what_it_leaves_open() -> None:
    program = """
import asyncio, sys, threading
from reasoned_explorer.calls.chat import ChatRequest
from reasoned_explorer.calls.openai_model import openai_model
loop = asyncio.new_event_loop()
threading.Thread(target=loop.run_forever, daemon=True).start()
asked = openai_model("openai:tiny", base_url=sys.argv[1]).ask(ChatRequest("caption", (), "", "What is there?", ""))
print(asyncio.run_coroutine_threadsafe(asked, loop).result(60.0).fault)
"""
    with StubServer() as server:
        command = [sys.executable, "-c", program, server.base_url]
        ended = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    assert (ended.returncode, ended.stdout.strip(), ended.stderr) == (0, "None", "")


def test_the_key_is_sent_and_stands_nowhere_else(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setenv("STUB_KEY", KEY)
    caplog.set_level(logging.DEBUG)
    with StubServer(Behaviour(script=("ok", "401", "500", "drop", "html", "404"))) as server:
        model = openai_model("openai:tiny", base_url=server.base_url, key_variable="STUB_KEY", settings=QUICK)
        answers = [asyncio.run(model.ask(question(number))) for number in range(4)]
    assert server.received[0].headers["authorization"] == f"Bearer {KEY}"
    assert answers[1].fault is not None
    assert answers[1].fault.startswith("no access: status 401: Incorrect API key provided: ***")
    shown = [repr(answers), repr(model), repr(vars(model)), model.fingerprint, caplog.text]
    assert not [text for text in shown if KEY in text]


def test_without_a_key_none_of_this_machine_is_sent(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("OPENAI_API_KEY", raising=False)
    monkeypatch.setenv("OPENAI_ORG_ID", "org-of-somebody")
    with StubServer() as server:
        ask(server)
    assert server.received[0].headers["authorization"] == "Bearer none"
    assert "openai-organization" not in server.received[0].headers


def test_a_proxy_is_not_asked_for_this_machine(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("HTTP_PROXY", "http_proxy", "ALL_PROXY"):
        monkeypatch.setenv(name, "http://127.0.0.1:9")
    monkeypatch.delenv("NO_PROXY", raising=False)
    monkeypatch.delenv("no_proxy", raising=False)
    with StubServer() as server:
        assert ask(server).fault is None


@pytest.mark.parametrize("name", ["openai:", "gpt-4", "hf:gpt2"])
def test_a_name_that_is_none_is_refused(name: str) -> None:
    with pytest.raises(SettingsError, match="openai:MODEL"):
        openai_model(name)


def test_a_missing_sdk_is_told_with_the_command_that_installs_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "openai", None)
    with pytest.raises(MissingDependencyError, match="reasoned-explorer\\[openai\\]"):
        openai_model("openai:tiny", base_url="http://localhost:1/v1")
