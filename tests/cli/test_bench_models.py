"""`rex bench` and `rex ablate` with models, against a server of this machine that is no model (a fake)."""

import json
import sqlite3
from collections.abc import Iterator
from pathlib import Path

import pytest
from typer.testing import CliRunner

from reasoned_explorer.calls import local
from reasoned_explorer.cli.app import app
from reasoned_explorer.evaluation.bench.store import RunStore

pytest.importorskip("openai")
pytest.importorskip("aiohttp")

from tests.calls.stub_server import Behaviour, StubServer, sober

TINY = ["--world", "park:5@300", "--per-cell", "1", "--levels", "1", "--t-max", "1", "--planners", "llm-as-eval"]
ALONE = ["--workers", "1"]


def _rex(*arguments: str) -> tuple[int, str]:
    result = CliRunner().invoke(app, list(arguments), env={"COLUMNS": "400"})
    return result.exit_code, result.output + (result.stderr if result.stderr_bytes else "")


@pytest.fixture(autouse=True)
def _in_an_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("OPENAI_API_KEY", "sk-planted-0123456789abcdef")
    monkeypatch.delenv("OPENAI_BASE_URL", raising=False)


@pytest.fixture
def server() -> Iterator[StubServer]:
    with StubServer(Behaviour(answer=sober, latency_s=0.02)) as running:
        yield running


def _calls(folder: str) -> int:
    with RunStore.read(Path(folder)) as store:
        return sum(row.calls for row in store.rows())


def _captions(folder: str) -> int:
    with RunStore.read(Path(folder)) as store:
        records = [store.record(row) for row in store.rows()]
    return sum(call.role == "caption" for record in records if record for step in record.steps for call in step.calls)


def test_models_run_in_mixed_time_and_what_they_take_is_told_before(server: StubServer) -> None:
    code, shown = _rex("bench", *TINY, *ALONE, "--minds", "openai:fake", "--base-url", server.base_url, "--out", "run")
    assert code == 0, shown
    assert "forecast: llm-as-eval: about " in shown
    assert "llm-as-eval [openai:fake], CT measured, modelled where embedded" in shown
    with RunStore.read(Path("run")) as store:
        assert store.plan.base.clock == "mixed"
        assert store.models["base_url"] == server.base_url
        assert store.models["abilities"]["openai:fake"]["latency_s"] > 0.0
        rows = list(store.rows())
    assert len(rows) == 3
    assert all(row.tokens_in > 0 and row.unpriced == row.lost_calls == 0 for row in rows)
    assert {path.name for path in Path("run").iterdir()} <= {"run.sqlite", "traces"}


_PRICES = """
[[price]]
host = "127.0.0.1"
model = "fake"
usd_per_million_in = 1.0
usd_per_million_out = 10.0
as_of = 2026-01-01
source = "made up, for a test"
"""


@pytest.mark.parametrize("workers", ["1", "2"])
def test_a_spent_budget_stops_a_run_and_nothing_is_paid_twice(server: StubServer, workers: str) -> None:
    Path("prices.toml").write_text(_PRICES)
    limited = ("--budget-usd", "0.1", "--prices", "prices.toml", "--workers", workers, "-q")
    code, shown = _rex(
        "bench", *TINY, "--minds", "openai:fake", "--base-url", server.base_url, "--out", "run", *limited
    )
    sittings = 1
    while code == 4 and sittings < 20:
        assert "the budget of 0.1 US dollars is spent" in shown
        assert "--resume run" in shown
        code, shown = _rex("bench", "--resume", "run", *limited)
        sittings += 1
    assert code == 0, shown
    assert sittings > 1
    asked = sum("You answer short questions" not in json.dumps(each.body) for each in server.received)
    # The simulated captioner's calls are in the rows, too; they are nobody's.
    assert asked == _calls("run") - _captions("run")
    with RunStore.read(Path("run")) as store:
        assert 0.1 * (sittings - 1) * 0.5 < sum(row.usd for row in store.rows()) <= 0.1 * sittings
    assert {path.name for path in Path("run").iterdir()} <= {"run.sqlite", "traces"}


def test_a_run_goes_on_asking_as_it_began(server: StubServer) -> None:
    arguments = ("--minds", "openai:fake", "--base-url", server.base_url, "--out", "run", "-q", *ALONE)
    assert _rex("bench", *TINY, *arguments)[0] == 0
    with sqlite3.connect("run/run.sqlite") as connection:
        connection.execute("DELETE FROM missions WHERE mission_id LIKE '%/near/%'")
    connection.close()
    asked = len(server.received)
    assert _rex("bench", "--resume", "run", "-q", *ALONE)[0] == 0
    # Where the models are and what they can do is remembered: nothing is tried again.
    assert not any("You answer short questions" in json.dumps(each.body) for each in server.received[asked:])
    assert len(server.received) > asked


def test_methods_may_have_models_of_their_own(server: StubServer) -> None:
    code, shown = _rex(
        *("bench", *TINY[:-1], "llm-as-eval@embedded/openai:org/fake,nearest-frontier", *ALONE),
        *("--base-url", server.base_url, "--out", "run"),
    )
    assert code == 0, shown
    with RunStore.read(Path("run")) as store:
        rows = {row.method: row for row in store.rows()}
    assert rows["llm-as-eval@embedded/openai:org/fake"].tokens_in > 0
    assert rows["nearest-frontier"].tokens_in == 0
    assert "forecast: llm-as-eval@embedded" in shown
    assert "forecast: nearest-frontier" not in shown


def test_one_model_behind_the_at_sign_may_be_added_to_a_run(server: StubServer) -> None:
    first = ("--minds", "openai:fake", "--base-url", server.base_url, "--out", "run", "-q", *ALONE)
    assert _rex("bench", *TINY, *first)[0] == 0
    asked = len(server.received)
    code, shown = _rex("bench", "--resume", "run", "--add", "llm-as-eval@openai:org/other", "-q", *ALONE)
    assert code == 0, shown
    # The method asks no visionary; who checks is as before.
    assert {each.body["model"] for each in server.received[asked:]} == {"org/other", "fake"}
    with RunStore.read(Path("run")) as store:
        rows = [row for row in store.rows() if row.method == "llm-as-eval@openai:org/other"]
    assert len(rows) == 3
    assert all(row.tokens_in > 0 for row in rows)


def test_what_only_describes_is_refused_as_a_mind_before_anything_is_loaded_or_made(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(local, "only_describes", lambda name: "kosmos" in name)
    monkeypatch.setattr(local, "load_local", lambda name: pytest.fail(f"{name} was loaded"))
    code, shown = _rex("bench", *TINY, *ALONE, "--minds", "hf:org/kosmos-2", "--out", "run")
    assert code == 2, shown
    assert "hf:org/kosmos-2 describes pictures only" in shown
    assert not Path("run").exists()


def test_table_iv_may_be_of_models(server: StubServer) -> None:
    code, shown = _rex(
        *("ablate", "minds", "--world", "park:5@300", "--per-cell", "1", *ALONE, "--out", "run", "-q"),
        *("--visionaries", "openai:small", "--evaluators", "embedded,openai:large", "--base-url", server.base_url),
    )
    assert code == 0, shown
    assert "openai:small" in shown
    assert "openai:large" in shown


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--budget-usd", "1"], "--budget-usd without a model that is called"),
        (["--cache", "x"], "--cache without a model that is called"),
        (["--minds", "openai:fake", "--budget-usd", "0"], "the budget is 0.0 US dollars"),
        (["--minds", "openai:fake", "--clock", "virtual"], "the clock virtual with openai:fake"),
        (["--minds", "openai:"], "a model's name behind the colon"),
        (["--minds", "openai:fake", "--base-url", "localhost"], "localhost"),
    ],
)
def test_what_cannot_be_is_told_before_anything_is_made(arguments: list[str], said: str) -> None:
    code, shown = _rex("bench", *TINY, *ALONE, "--out", "run", *arguments)
    assert code == 2, shown
    assert said in shown
    assert not Path("run").exists()


def test_a_model_that_does_not_answer_leaves_no_run_behind() -> None:
    with StubServer(Behaviour(script=("401",) * 400)) as server:
        code, shown = _rex(
            "bench", *TINY, *ALONE, "--minds", "openai:fake", "--base-url", server.base_url, "--out", "r"
        )
    assert code == 3, shown
    assert "does not answer" in shown
    assert not Path("r").exists()


def test_a_budget_is_not_for_a_cluster() -> None:
    pytest.importorskip("ray")
    code, shown = _rex("bench", *TINY, "--minds", "openai:fake", "--ray", "auto", "--budget-minutes", "1")
    assert code == 2, shown
    assert "--budget-minutes beside --ray" in shown


def test_a_server_that_goes_away_stops_a_run_which_goes_on_when_it_is_back() -> None:
    behaviour = Behaviour(answer=sober, script=("ok",) * 60 + ("401",) * 400)
    with StubServer(behaviour) as server:
        arguments = ("--minds", "openai:fake", "--base-url", server.base_url, "--out", "run", "-q", *ALONE)
        code, shown = _rex("bench", *TINY, *arguments)
        assert code == 4, shown
        assert "openai:fake does not answer any more: no access" in shown
        assert "--resume run" in shown
        server._script.clear()  # it lets one in again
        code, shown = _rex("bench", "--resume", "run", "-q", *ALONE)
        assert code == 0, shown
    with RunStore.read(Path("run")) as store:
        rows = list(store.rows())
        records = [store.record(row) for row in rows]
    assert len(rows) == 3
    calls = [call for record in records if record for step in record.steps for call in step.calls]
    # A mission that was about to end then may have lost its last few.
    lost = sum(call.fault is not None and call.model == "openai:fake" for call in calls)
    assert sum(row.lost_calls or 0 for row in rows) == lost < 20
