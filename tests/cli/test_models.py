"""`rex run --minds openai:…` and `rex minds check`, against a server of this machine that is no model (a fake)."""

import json
from collections.abc import Iterator
from pathlib import Path

import pytest
from typer.testing import CliRunner

from reasoned_explorer.cli.app import app
from reasoned_explorer.evaluation.record_file import read_record
from reasoned_explorer.model.record import MissionEnd

pytest.importorskip("openai")
pytest.importorskip("aiohttp")

from tests.calls.stub_server import FAULTS, Behaviour, StubServer, sober

KEY = "sk-planted-0123456789abcdef"
FAST = ["--world", "plaza:3@200", "--seed", "1", "--no-map", "--t-max", "2"]


@pytest.fixture(autouse=True)
def _in_an_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("OPENAI_API_KEY", KEY)
    monkeypatch.delenv("OPENAI_BASE_URL", raising=False)


@pytest.fixture
def server() -> Iterator[StubServer]:
    with StubServer(Behaviour(answer=sober)) as running:
        yield running


def _rex(*arguments: str) -> tuple[int, str]:
    result = CliRunner().invoke(app, list(arguments))
    return result.exit_code, result.output + (result.stderr if result.stderr_bytes else "")


def _run(*arguments: str, out: str = "run") -> tuple[int, str]:
    return _rex("run", "Find me a bench", *FAST, "--minds", "openai:fake", "--out", out, *arguments)


def test_a_mission_with_a_model_is_measured_and_replayed_without_it_bit_for_bit(tmp_path: Path) -> None:
    with StubServer(Behaviour(answer=sober)) as server:
        code, shown = _run("--base-url", server.base_url, "--record", "calls.tape")
        assert code == 1, shown
        assert "[openai:fake]" in shown
        assert "measured" in shown
        assert "tokens sent" in shown
        assert "have no answer" not in shown
        url = server.base_url
    # The server is gone; so is the key.
    again_code, again = _run("--base-url", url, "--replay", "calls.tape", out="again")
    assert again_code == 1, again
    assert (tmp_path / "again" / "record.jsonl").read_bytes() == (tmp_path / "run" / "record.jsonl").read_bytes()


def test_another_mission_is_not_on_the_tape(server: StubServer) -> None:
    assert _run("--base-url", server.base_url, "--record", "calls.tape", "--t-max", "1")[0] == 1
    told = len(server.received)
    code, shown = _rex(
        "run", "Find me a tree", *FAST, "--t-max", "1", "--minds", "openai:fake", "--replay", "calls.tape", "--out", "x"
    )
    assert code == 2
    assert "goal is 'Find me a tree'" in shown
    assert not Path("x").exists()
    code, shown = _run("--minds", "openai:other", "--replay", "calls.tape", out="y")
    assert code == 2
    assert "no calls of openai:other on the tape" in shown
    assert len(server.received) == told


def test_one_role_may_be_a_models_and_the_others_embedded(server: StubServer) -> None:
    code, shown = _rex(
        "run", "Find me a bench", *FAST, "--evaluator", "openai:fake", "--base-url", server.base_url, "--out", "run"
    )
    assert code in {0, 1}, shown
    record = read_record(Path("run"))
    assert {call.model for step in record.steps for call in step.calls if call.role == "evaluator"} == {"openai:fake"}
    assert "openai:fake" in record.header.minds
    assert "embedded" in record.header.minds


def test_typed_decisions_are_used_where_an_endpoint_offers_them() -> None:
    with StubServer(Behaviour(answer=sober, decides=True)) as server:
        code, checked = _rex("minds", "check", "openai:fake", "--base-url", server.base_url)
        assert code == 0, checked
        assert "typed decisions      yes" in checked
        code, shown = _run("--base-url", server.base_url)
        assert code == 1, shown
        asked = [each.body for each in server.received if "questions" in each.body]
    record = read_record(Path("run"))
    scores = [node for step in record.steps for node in step.tree if node.score is not None]
    assert {name for each in asked[2:] for name in [question["name"] for question in each["questions"]]} == {
        *("blocked", "forbidden", "level", "found")
    }
    # All five levels have a probability; one alone would be what is said in words.
    assert scores
    assert all(node.levels is not None and sum(chance > 0.0 for chance in node.levels) == 5 for node in scores)
    code, shown = _run("--base-url", server.base_url, "--replay", "run/calls.tape", out="again")
    assert Path("again/record.jsonl").read_bytes() == Path("run/record.jsonl").read_bytes()


def test_a_spent_budget_ends_a_mission_cleanly(server: StubServer) -> None:
    code, shown = _run("--base-url", server.base_url, "--budget-minutes", "0.0001")
    assert code == 1, shown
    summary = read_record(Path("run")).summary
    assert summary is not None
    assert summary.end is MissionEnd.BUDGET_SPENT


def test_a_mission_that_the_budget_ended_goes_on_without_paying_twice(server: StubServer) -> None:
    Path("prices.toml").write_text(
        '[[price]]\nhost = "127.0.0.1"\nmodel = "fake"\nusd_per_million_in = 1\nusd_per_million_out = 1\n'
        'as_of = 2026-01-01\nsource = "made up"\n'
    )
    there = ("--base-url", server.base_url, "--prices", "prices.toml")
    code, shown = _run(*there, "--budget-usd", "0.005")
    assert code == 1, shown
    assert "--resume run/calls.tape" in shown
    paid = len(server.received)
    code, shown = _run(*there, "--resume", "run/calls.tape", out="on")
    assert code in {0, 1}, shown
    first, whole = read_record(Path("run")), read_record(Path("on"))
    assert whole.summary is not None
    assert whole.summary.end is not MissionEnd.BUDGET_SPENT
    assert whole.steps[: len(first.steps) - 1] == first.steps[:-1]
    calls = [call for step in whole.steps for call in step.calls if call.model == "openai:fake"]
    assert paid + len(server.received) > len(calls)
    # Only what was denied then, and what came after it, was asked; nothing was tried out again.
    assert len(server.received) - paid < len(calls)
    # The tape is now of the whole mission.
    code, shown = _run(*there, "--replay", "run/calls.tape", out="again")
    assert Path("again/record.jsonl").read_bytes() == Path("on/record.jsonl").read_bytes()


def test_another_mission_does_not_go_on_from_a_tape(server: StubServer) -> None:
    assert _run("--base-url", server.base_url, "--budget-minutes", "0.0001")[0] == 1
    before = Path("run/calls.tape").read_bytes()
    code, shown = _rex(
        *("run", "Find me a tree", *FAST, "--minds", "openai:fake", "--base-url", server.base_url),
        *("--resume", "run/calls.tape", "--out", "x"),
    )
    assert code == 2, shown
    assert "goal is 'Find me a tree'" in shown
    assert Path("run/calls.tape").read_bytes() == before
    code, shown = _run("--resume", "nothing", "--record", "new", out="y")
    assert code == 2
    assert "there is no file nothing" in shown
    assert "--record beside --resume" in shown


def test_answers_are_taken_from_the_cache(server: StubServer) -> None:
    arguments = ("--base-url", server.base_url, "--cache", "answers.sqlite", "--set", "depth=0")
    assert _run(*arguments)[0] == 1
    asked = len(server.received)
    assert _run(*arguments, out="again")[0] == 1
    first, again = (read_record(Path(name)) for name in ("run", "again"))
    assert all(call.cached for step in again.steps for call in step.calls if call.model == "openai:fake")
    assert len(server.received) - asked < 20  # what is asked to find out what it can do
    assert [step.pose for step in again.steps] == [step.pose for step in first.steps]


def test_a_model_that_fails_costs_answers_and_never_a_mission() -> None:
    behaviour = Behaviour(answer=sober, fault_share=0.2, faults=tuple(sorted(set(FAULTS) - {"hang"})))
    with StubServer(behaviour) as server:
        code, shown = _run("--base-url", server.base_url, "--t-max", "1")
    assert code in {0, 1}, shown
    record = read_record(Path("run"))
    assert record.summary is not None
    for step in record.steps:
        for call in step.calls:
            assert KEY not in (call.fault or "")


def test_calls_that_are_lost_are_told_with_what_the_others_took() -> None:
    with StubServer(Behaviour(answer=sober, script=("ok",) * 20 + ("filtered",) * 40)) as server:
        code, shown = _run("--base-url", server.base_url, "--t-max", "1")
    assert code in {0, 1}, shown
    assert "lost     " in shown
    assert "calls have no answer: " in shown
    assert "filtered" in shown


@pytest.mark.parametrize("mission", ["null", "7", '"x"', "[]"])
def test_a_tape_that_says_of_no_mission_is_refused_in_words(mission: str, server: StubServer) -> None:
    assert _run("--base-url", server.base_url, "--t-max", "1")[0] == 1
    tape = Path("run/calls.tape")
    head, _, rest = tape.read_text().partition("\n")
    header = json.loads(head)
    header["about"]["mission"] = json.loads(mission)
    tape.write_text(json.dumps(header) + "\n" + rest)
    code, shown = _run("--base-url", server.base_url, "--replay", "run/calls.tape", out="again")
    assert code == 2, shown
    assert "says of no mission" in shown


def test_an_empty_address_is_not_taken_for_openais_own() -> None:
    code, shown = _run("--base-url", "")
    assert code == 2, shown
    assert "the base URL is empty" in shown


def test_address_prices_and_budget_are_all_told_at_once() -> None:
    code, shown = _run("--base-url", "notaurl", "--prices", "no.toml", "--budget-usd", "-3")
    assert code == 2, shown
    assert all(wrong in shown for wrong in ("notaurl", "no.toml", "-3.0"))


def test_a_key_is_written_nowhere(tmp_path: Path) -> None:
    behaviour = Behaviour(answer=sober, script=("ok",) * 20 + ("401",) * 400)
    with StubServer(behaviour) as server:
        _, shown = _run("--base-url", server.base_url, "--record", "calls.tape", "--cache", "answers.sqlite")
        _, checked = _rex("minds", "check", "openai:fake", "--base-url", server.base_url)
    assert KEY not in shown + checked
    for path in tmp_path.rglob("*"):
        assert not path.is_file() or KEY.encode() not in path.read_bytes(), path


@pytest.mark.parametrize("usd", ["inf", "nan", "-1", "0"])
def test_a_budget_that_is_none_is_told_once_with_what_is_expected(usd: str, server: StubServer) -> None:
    code, shown = _run("--base-url", server.base_url, "--budget-usd", usd)
    assert code == 2, shown
    said = f"the budget is {float(usd)} US dollars; expected a finite number above 0; leave it out for no limit"
    assert set(shown.splitlines()) == {f"rex: models: {said}"}
    assert not server.received


def test_an_address_without_v1_is_asked_about(server: StubServer) -> None:
    root = server.base_url.removesuffix("/v1")
    code, shown = _rex("minds", "check", "openai:fake", "--base-url", root)
    assert code == 3, shown
    assert f"did you mean {root}/v1?" in shown


def test_what_a_model_can_do_is_told_with_what_a_mission_takes(server: StubServer) -> None:
    code, shown = _rex("minds", "check", "openai:fake", "--base-url", server.base_url)
    assert code == 0, shown
    for words in ("structured output    JSON schema", "log-probabilities", "median latency", "a mission of llm-rrt"):
        assert words in shown
    code, shown = _rex("minds", "check", "embedded")
    assert code == 2
    assert "expected openai:MODEL or hf:NAME" in shown


def test_what_cannot_be_is_told_at_once_and_leaves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, server: StubServer
) -> None:
    code, shown = _run("--clock", "virtual", "--record", "a", "--replay", "b", "--budget-usd", "-1")
    assert code == 2
    for words in ("a real call takes real seconds", "--record beside --replay", "there is no file b", "-1"):
        assert words in shown
    code, shown = _rex("run", "Find me a bench", *FAST, "--record", "a", "--out", "x")
    assert code == 2
    assert "--record without a model" in shown
    assert _run("--minds", "openai:", "--base-url", server.base_url)[0] == 2
    monkeypatch.delenv("OPENAI_API_KEY")
    code, shown = _run()
    assert code == 2
    assert "OPENAI_API_KEY" in shown
    # Nobody listens there.
    code, shown = _run("--base-url", "http://127.0.0.1:9/v1")
    assert code == 3
    assert "does not answer" in shown
    assert list(tmp_path.iterdir()) == []
