"""`rex view` and `rex run --view`, in processes of their own, asked over HTTP."""

import json
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from typer.testing import CliRunner

from reasoned_explorer.cli.app import app
from reasoned_explorer.evaluation.bench.store import RunStore
from tests.viewer.small_runs import small_plan

pytest.importorskip("fastapi", reason="the extra view is not installed")
pytest.importorskip("uvicorn", reason="the extra view is not installed")

MISSION = ["run", "Find me a bench", "--world", "plaza:3@200", "--planner", "nearest-frontier", "--no-map"]
STRANGER = urllib.request.build_opener(urllib.request.HTTPCookieProcessor())


@pytest.fixture(autouse=True)
def _in_an_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def _rex(*arguments: str) -> tuple[int, str]:
    result = CliRunner().invoke(app, list(arguments))
    return result.exit_code, result.output + (result.stderr if result.stderr_bytes else "")


def _get(url: str, path: str = "") -> bytes:
    with urllib.request.urlopen(url + path, timeout=60) as answer:  # noqa: S310 - of this machine
        body: bytes = answer.read()
        return body


@contextmanager
def _showing(*command: str, **environment: str) -> Iterator[tuple["subprocess.Popen[str]", str, list[str]]]:
    """Run a command until the block ends; gives the process, the address that it says, and what it said before."""
    line = [sys.executable, "-m", "reasoned_explorer", *command]
    with subprocess.Popen(
        line, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env={**os.environ, **environment}
    ) as process:
        assert process.stdout is not None
        said: list[str] = []
        try:
            for text in process.stdout:
                said.append(text)
                if found := re.search(r"(http://\S+?/)(\?token=\S+?)?(;|$)", text.strip()):
                    yield process, found[1] + (found[2] or ""), said
                    break
            else:
                pytest.fail(f"it shows nothing: {''.join(said)}")
        finally:
            if process.poll() is None:
                process.send_signal(signal.SIGINT)
            process.communicate(timeout=60)


@pytest.fixture(scope="module")
def kept(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("kept") / "one"
    code, said = _rex(*MISSION, "--t-max", "0.5", "--out", str(folder), "-q")
    assert code in {0, 1}, said
    return folder


@pytest.fixture
def mission(tmp_path: Path, kept: Path) -> Path:
    """The folder of a mission in ``runs``."""
    shutil.copytree(kept, tmp_path / "runs" / "one")
    return tmp_path / "runs" / "one"


@pytest.mark.usefixtures("mission")
def test_what_lies_in_runs_is_shown_until_somebody_ends_it() -> None:
    with _showing("view", "--port", "0") as (process, url, said):
        assert url.startswith("http://127.0.0.1:")
        assert "runs is shown at" in said[-1]
        assert "Ctrl-C ends it" in said[-1]
        assert b"<html" in _get(url)
        (run,) = json.loads(_get(url, "api/runs"))
        listing = json.loads(_get(url, f"api/runs/{run['id']}"))
        assert len(listing["rows"]) == 1
        process.send_signal(signal.SIGINT)
        rest, _ = process.communicate(timeout=30)
    assert process.returncode == 130
    assert "Traceback" not in rest
    assert "ERROR" not in rest


def test_beyond_this_machine_the_printed_token_lets_in_and_nothing_else_does(mission: Path) -> None:
    with _showing("view", str(mission), "--host", "0.0.0.0", "--port", "0") as (_, url, _said):  # noqa: S104
        address, token = url.split("?token=")
        with pytest.raises(urllib.error.HTTPError) as refused:
            _get(address, "api/runs")
        assert refused.value.code == 401
        refused.value.close()
        with STRANGER.open(url, timeout=30) as page:  # as a browser: the cookie is kept, the redirect followed
            assert page.url == address
        with STRANGER.open(address + "api/runs", timeout=30) as answer:
            assert len(json.loads(answer.read())) == 1
        assert len(token) >= 32


def test_the_token_may_be_chosen(mission: Path) -> None:
    chosen = "chosen-by-a-person"
    with _showing("view", str(mission), "--host", "0.0.0.0", "--port", "0", REX_VIEW_TOKEN=chosen) as (_, url, _said):  # noqa: S104
        assert url.endswith(f"?token={chosen}")


def test_what_cannot_be_shown_is_told_in_a_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "empty").mkdir()
    (tmp_path / "file").write_text("x")
    for arguments, expected in (
        (["nowhere"], "nowhere is no folder"),
        ([], "runs is no folder"),
        (["file"], "file is no folder"),
        (["empty"], "holds no run"),
        (["empty", "--port", "70000"], "a port, 0 to 65535"),
        (["empty", "--port", "-1"], "a port, 0 to 65535"),
        (["empty", "--host", "a b"], "an address of this machine"),
    ):
        code, said = _rex("view", *arguments)
        assert code == 2, said
        assert expected in said
        assert "Traceback" not in said
        assert len(set(said.strip().splitlines())) == 1
    monkeypatch.setenv("REX_VIEW_TOKEN", "short")
    code, said = _rex("view", "empty", "--host", "0.0.0.0", "--port", "70000")  # noqa: S104
    assert code == 2
    assert "2 faults" in said  # both at once
    assert "REX_VIEW_TOKEN" in said


def test_a_port_that_is_taken_is_told_and_the_usual_one_is_stepped_aside_from(mission: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        code, said = _rex("view", str(mission), "--port", str(port))
        assert code == 2
        assert "cannot be listened on" in said
        assert "--port 0" in said
    with _showing("view", str(mission)) as (_, one, _said), _showing("view", str(mission)) as (_, other, _more):
        assert one != other
        assert _get(one, "api/runs") == _get(other, "api/runs")


def test_without_the_extra_it_says_how_to_get_it(mission: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("fastapi", "uvicorn"):
        with monkeypatch.context() as without:
            without.setitem(sys.modules, name, None)
            for command in (["view", str(mission)], [*MISSION, "--view", "--out", "another"]):
                code, said = _rex(*command)
                assert code == 2, said
                assert "pip install 'reasoned-explorer[view]'" in said
            assert not Path("another").exists()


def test_a_store_without_missions_is_shown(tmp_path: Path) -> None:
    RunStore.create(tmp_path / "bench", small_plan(), {}).close()
    with _showing("view", "bench", "--port", "0") as (_, url, _said):
        (run,) = json.loads(_get(url, "api/runs"))
        assert (run["missions"], json.loads(_get(url, f"api/runs/{run['id']}"))["rows"]) == (0, [])


def test_a_mission_is_watched_while_it_runs_and_shown_when_it_is_over() -> None:
    with _showing(*MISSION, "--t-max", "0.5", "--out", "out", "--view", "--view-port", "0") as (process, url, said):
        assert "watch it at" in said[-1]
        live = json.loads(_get(url, "api/about"))["live_mission"]
        kinds = []
        with urllib.request.urlopen(url + "api/live", timeout=120) as events:  # noqa: S310
            for raw in events:
                if raw.startswith(b"event: ") and b"alive" not in raw:
                    kinds.append(raw.split()[1].decode())
                if kinds and kinds[-1] == "summary":
                    break
        assert kinds[0] == "header"
        assert kinds[1:-1] == ["step"] * (len(kinds) - 2)
        assert process.stdout is not None
        rest = []
        for line in process.stdout:
            rest.append(line)
            if "still shown at" in line:
                break
        assert "Ctrl-C ends it" in rest[-1]
        # Over, and still there, from the same ids.
        replay = json.loads(_get(url, f"api/runs/{live['run']}/missions/{live['mission']}"))
        assert replay["complete"] is True
        assert len(replay["steps"]) == len(kinds) - 2
        process.send_signal(signal.SIGINT)
        end, _ = process.communicate(timeout=60)
        assert "Traceback" not in end
    # What the mission's own exit code would have been.
    assert process.returncode == (0 if replay["summary"]["success"] else 1)
    assert process.returncode == 1


def test_a_mission_that_is_stopped_ends_its_page_too() -> None:
    slow = ("--clock", "real", "--latency", "1s")
    with _showing(*MISSION, *slow, "--out", "out", "--view", "--view-port", "0") as (process, url, _said):
        until = time.monotonic() + 60.0
        while not Path("out/record.jsonl").exists() and time.monotonic() < until:
            time.sleep(0.1)
        _get(url, "api/about")
        process.send_signal(signal.SIGINT)
        rest, _ = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "still shown" not in rest
    with pytest.raises(urllib.error.URLError):
        _get(url, "api/about")


def test_a_bad_address_of_the_page_is_told_before_the_mission_begins() -> None:
    code, said = _rex(*MISSION, "--view", "--view-port", "70000", "--out", "out", "--radius", "-1")
    assert code == 2
    assert "70000" in said
    assert "radius" in said.lower()
    assert not Path("out").exists()
    with socket.create_server(("127.0.0.1", 0)) as taken:
        code, said = _rex(*MISSION, "--view", "--view-port", str(taken.getsockname()[1]), "--out", "out")
    assert code == 2
    assert "cannot be listened on" in said
    assert not Path("out").exists()
