"""The client, the abilities and whole missions against a server that is not ours: ``transformers serve``.

The models have random weights, so that what they say is nonsense; everything else is as with any model.
"""

import asyncio
import io
import json
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from typer.testing import CliRunner

from reasoned_explorer.calls.chat import ChatAnswer, ChatRequest
from reasoned_explorer.calls.endpoint import AskingSettings
from reasoned_explorer.calls.local import load_local
from reasoned_explorer.calls.openai_model import OpenAIModel, openai_model
from reasoned_explorer.cli.app import app
from reasoned_explorer.evaluation.record_file import read_record
from reasoned_explorer.minds.prompted.reading import Unreadable, read_judgement
from reasoned_explorer.model.record import MissionEnd
from tests.calls.genuine_server import INSTALL, PACKAGES, TransformersServe
from tests.calls.local import tiny

SCHEMA = {"type": "object", "properties": {"level": {"type": "integer"}}, "required": ["level"]}


@pytest.fixture(scope="session")
def models(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of tiny models."""
    missing = [package for package in PACKAGES if find_spec(package) is None]
    if missing:
        pytest.skip(f"transformers serve needs {', '.join(missing)}: {INSTALL}")
    folder = tmp_path_factory.mktemp("served")
    tiny.make_text_model(folder / "talks")
    tiny.make_text_model(folder / "knows-no-system", template=tiny.USERS_ONLY)
    tiny.make_smolvlm(folder / "sees", newer=False)
    return folder


@pytest.fixture(scope="session")
def server(models: Path) -> Iterator[TransformersServe]:
    with TransformersServe(models) as running:
        yield running


@pytest.fixture(autouse=True)
def _in_an_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("OPENAI_BASE_URL", raising=False)


def model_at(server: TransformersServe, name: str, **settings: Any) -> OpenAIModel:
    return openai_model(f"openai:{name}", base_url=server.base_url, settings=AskingSettings(**settings))


def question(number: int = 0, **options: Any) -> ChatRequest:
    filled = {"max_tokens": 24, **options}
    return ChatRequest(
        "evaluator", (number,), "You judge scenes.", f"Is there a bench in scene {number}?", "t/1", **filled
    )


def picture(number: int) -> bytes:
    pixels = np.random.default_rng(number).integers(0, 256, (20, 20, 3), dtype=np.uint8)
    file = io.BytesIO()
    Image.fromarray(pixels).save(file, "PNG")
    return file.getvalue()


def asked(model: Any, *requests: ChatRequest) -> list[ChatAnswer]:
    async def together() -> list[ChatAnswer]:
        return await asyncio.gather(*(model.ask(request) for request in requests))

    return asyncio.run(together())


def test_its_answers_are_the_models_and_its_tokens_are_counted(server: TransformersServe, models: Path) -> None:
    # The same weights without a server between: word for word the same, as are the counts.
    requests = [question(number) for number in range(3)]
    served = asked(model_at(server, "talks"), *requests)
    here = [asked(load_local(f"hf:{models / 'talks'}"), request)[0] for request in requests]
    assert [answer.fault for answer in served] == [None] * 3
    assert [answer.text for answer in served] == [answer.text for answer in here]
    assert [answer.tokens_in for answer in served] == [answer.tokens_in for answer in here]
    assert [answer.tokens_out for answer in served] == [24] * 3
    assert {(answer.model, answer.retries, answer.usd) for answer in served} == {("talks", 0, 0.0)}


def test_a_form_that_it_does_not_know_is_no_answer_in_that_form(server: TransformersServe) -> None:
    # It takes response_format and logprobs and does nothing with them.
    (by_schema,) = asked(model_at(server, "talks"), question(schema=SCHEMA, top_logprobs=5))
    assert by_schema.fault is not None
    assert by_schema.fault.startswith("cut off")
    (plain,) = asked(model_at(server, "talks", structure="none"), question(schema=SCHEMA, top_logprobs=5))
    assert (plain.fault, plain.tokens) == (None, ())


def test_pictures_are_seen_by_who_sees(server: TransformersServe) -> None:
    sees, talks = model_at(server, "sees"), model_at(server, "talks")
    text, one, other = asked(sees, question(), question(images=(picture(1),)), question(images=(picture(2),)))
    assert [answer.fault for answer in (text, one, other)] == [None] * 3
    assert one.tokens_in == other.tokens_in > text.tokens_in
    assert len({text.text, one.text, other.text}) == 3
    # A model of text is not shown them, and nothing says so: why sight is found out by what is answered.
    without, blind = asked(talks, question(), question(images=(picture(1),)))
    assert (blind.fault, blind.text, blind.tokens_in) == (None, without.text, without.tokens_in)


def test_a_model_whose_template_knows_no_system_is_told_by_the_user(server: TransformersServe, models: Path) -> None:
    model = model_at(server, "knows-no-system", tries=1, back_off_s=0.1)
    (first,) = asked(model, question(0))
    (second,) = asked(model, question(1))
    assert (first.fault, first.retries, second.fault, second.retries) == (None, 1, None, 0)
    (here,) = asked(load_local(f"hf:{models / 'knows-no-system'}"), question(1))
    assert (second.text, second.tokens_in) == (here.text, here.tokens_in)


def test_a_model_that_is_not_there_is_a_fault(server: TransformersServe) -> None:
    (answer,) = asked(model_at(server, "nobody", tries=2, back_off_s=0.1), question())
    assert answer.fault == "server error: status 500: Internal Server Error (asked 3 times)"


def test_what_it_does_not_take_is_a_fault_in_its_own_words(
    server: TransformersServe,
) -> None:
    model = model_at(server, "talks")
    model._length_name = "most_tokens"
    (answer,) = asked(model, question())
    assert answer.fault is not None
    assert answer.fault.startswith("rejected: status 422: Unexpected fields in the request: {'most_tokens'}")


def test_a_cancelled_call_costs_the_next_nothing(server: TransformersServe) -> None:
    async def cancel_one(model: OpenAIModel) -> ChatAnswer:
        long = asyncio.ensure_future(model.ask(question(max_tokens=500)))
        await asyncio.sleep(0.2)
        long.cancel()
        await asyncio.wait([long])
        return await model.ask(question(1))

    model = model_at(server, "talks")
    assert asyncio.run(cancel_one(model)) == asked(model, question(1))[0]


def test_what_it_can_do_is_told_as_it_is(server: TransformersServe) -> None:
    result = CliRunner().invoke(app, ["minds", "check", "openai:talks", "--base-url", server.base_url])
    assert result.exit_code == 0, result.output
    for words in (
        "openai:talks: answers as talks",
        "on this machine      yes",
        "structured output    no: plain text is read",
        "log-probabilities    no",
        "pictures             no",
        "15 calls",
    ):
        assert words in result.output


@pytest.mark.parametrize(("setting", "role"), [("children=1", "visionary"), ("depth=0", "evaluator")])
def test_a_mission_ends_with_nothing_made_up_and_is_replayed_without_the_server(
    server: TransformersServe, tmp_path: Path, setting: str, role: str
) -> None:
    mission = ["run", "Find me a bench", "--world", "plaza:3@200", "--seed", "1", "--no-map", "--t-max", "0.3"]
    mission += ["--set", setting]
    model = ["--minds", "openai:talks", "--base-url", server.base_url]
    result = CliRunner().invoke(app, [*mission, *model, "--record", "calls.tape", "--out", "run"])
    assert result.exit_code in {0, 1}, result.output
    record = read_record(tmp_path / "run")
    assert record.summary is not None
    assert record.summary.end in {MissionEnd.TIME_OVER, MissionEnd.NOTHING_LEFT}
    assert not record.summary.declared

    calls = [call for step in record.steps for call in step.calls if call.model == "openai:talks"]
    assert {call.role for call in calls} == {"checker", role}
    assert [call.fault for call in calls if call.fault is not None] == []
    assert all(call.tokens_in > 0 and call.tokens_out > 0 for call in calls)
    views = [view for step in record.steps for view in step.views]
    assert all(view.check_fault is not None and view.plan_fault is not None for view in views if view.q is None)
    scores = [view.q for view in views] + [node.score for step in record.steps for node in step.tree]
    taped = [json.loads(line)["call"] for line in Path("calls.tape").read_text().splitlines() if '{"call"' in line[:8]]
    judged = [read_judgement(call["answer"]["text"], []) for call in taped if call["role"] == "evaluator"]
    said = sum(not isinstance(each, Unreadable) for each in judged)
    assert sum(score is not None for score in scores) <= 2 * said  # a view's and its own node's

    # Where the server was, nobody is asked: its address is part of what is replayed, and what it says is on the tape.
    told = server.said
    again = CliRunner().invoke(app, [*mission, *model, "--replay", "calls.tape", "--out", "again"])
    assert again.exit_code == result.exit_code, again.output
    assert server.said == told
    assert (tmp_path / "again" / "record.jsonl").read_bytes() == (tmp_path / "run" / "record.jsonl").read_bytes()
