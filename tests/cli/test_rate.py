"""`rex rate` in a process of its own: rated over HTTP, killed, started again, reported."""

import http.client
import json
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

pytest.importorskip("fastapi", reason="the extra view is not installed")
pytest.importorskip("uvicorn", reason="the extra view is not installed")

from reasoned_explorer.cli.app import app
from reasoned_explorer.evaluation.bench.store import RunStore
from reasoned_explorer.evaluation.ratings import ratings_of
from tests.viewer.page_runs import bench_run
from tests.viewer.rating_runs import copied, without_records


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return bench_run(tmp_path_factory.mktemp("rate") / "run")


@contextmanager
def serving(run: Path, *options: str) -> Iterator[tuple[subprocess.Popen[str], int]]:
    """Start the command, wait until it says where it listens, and end it."""
    command = [sys.executable, "-m", "reasoned_explorer", "rate", str(run), "--port", "0", *options]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            said = process.stdout.readline()
            found = re.search(r"http://127\.0\.0\.1:(\d+)/", said)
            assert found, said
            yield process, int(found[1])
        finally:
            if process.poll() is None:
                process.send_signal(signal.SIGINT)
            process.wait(60)


def ask(port: int, method: str, path: str, body: dict[str, Any] | None = None) -> Any:
    connection = http.client.HTTPConnection("127.0.0.1", port, timeout=60)
    headers = {"Content-Type": "application/json", "Sec-Fetch-Site": "same-origin"}
    if body is not None:
        headers["X-Rex-CSRF"] = ask(port, "GET", "/api/csrf")["token"]
    connection.request(method, path, None if body is None else json.dumps(body), headers)
    answer = connection.getresponse()
    assert answer.status == 200
    found = json.loads(answer.read())
    connection.close()
    return found


def test_what_was_saved_survives_a_kill_and_stands_in_the_report(run: Path) -> None:
    with serving(run, "--rater", "Ann") as (process, port):
        items = ask(port, "GET", "/api/rate/items?rater=Ann")["items"]
        for item in items[:3]:
            said = {"rater": "Ann", "answer": "yes", "how_well": 5, "comment": "there it is"}
            assert ask(port, "PUT", f"/api/rate/items/{item}", said)["saved"]
        process.kill()
        assert process.wait(60) == -signal.SIGKILL
    with serving(run, "--rater", "Ann") as (process, port):
        found = ask(port, "GET", "/api/rate/items?rater=Ann")
        assert found["items"] == items
        assert found["rated"] == [1, 1, 1, *[0] * (len(items) - 3)]
        process.send_signal(signal.SIGINT)
        assert process.wait(60) == 130
    with RunStore.read(run) as store:
        assert len(ratings_of(store)) == 3
    assert [path.name for path in run.glob("run.sqlite*")] == ["run.sqlite"]
    reported = CliRunner().invoke(app, ["report", str(run)])
    assert reported.exit_code == 0
    assert "What people say (1 rater)" in reported.output
    assert "not defined: one rater only" in reported.output
    assert 'id="people"' in (run / "report" / "index.html").read_text(encoding="utf-8")


def test_all_that_is_wrong_is_said_at_once(run: Path) -> None:
    wrong = ["--methods", "llm-rrt,nobody", "--levels", "5", "--count", "0", "--rater", " ", "--port", "70000"]
    answered = CliRunner().invoke(app, ["rate", str(run), *wrong])
    assert answered.exit_code == 2
    for part in ("nobody", "level '5'", "--count", "rater", "--port"):
        assert part in answered.output


def test_what_is_no_run_is_refused(tmp_path: Path) -> None:
    answered = CliRunner().invoke(app, ["rate", str(tmp_path)])
    assert answered.exit_code == 2
    assert "holds no run.sqlite" in answered.output


def test_nothing_to_rate_is_said(run: Path, tmp_path: Path) -> None:
    bare = copied(run, tmp_path / "bare")
    without_records(bare, "llm-rrt")
    answered = CliRunner().invoke(app, ["rate", str(bare), "--methods", "llm-rrt"])
    assert answered.exit_code == 2
    assert "missions has a record" in answered.output
