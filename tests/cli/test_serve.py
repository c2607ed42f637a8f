"""`rex serve` in a process of its own, and `rex run` against it."""

import json
import re
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from typer.testing import CliRunner

from reasoned_explorer.cli.app import app
from reasoned_explorer.cli.serve import free_spot
from reasoned_explorer.simulation.vehicle import check_start
from reasoned_explorer.vehicles.registry import vehicle_profile
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.opening import open_world

pytest.importorskip("msgpack", reason="what AirSim's wire is spoken with is not installed")

WORLD = ["--world", "plaza:3@200"]
MISSION = ["Find me a fire hydrant", *WORLD, "--seed", "5", "--max-steps", "3", "--no-map"]


@pytest.fixture(autouse=True)
def _in_an_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def _rex(*arguments: str) -> tuple[int, str]:
    result = CliRunner().invoke(app, list(arguments))
    return result.exit_code, result.output + (result.stderr if result.stderr_bytes else "")


@contextmanager
def _serving(*options: str) -> Iterator[tuple["subprocess.Popen[str]", str]]:
    """Serve on a free port until the block ends; gives the process and the address."""
    wire = () if "--as" in options else ("--as", "airsim")
    command = [sys.executable, "-m", "reasoned_explorer", "serve", *wire, "--port", "0", *options]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as process:
        assert process.stdout is not None
        try:
            for line in process.stdout:
                if found := re.search(r" at (127\.0\.0\.1:\d+);", line):
                    yield process, f"mavlink:udpout:{found[1]}" if "mavlink" in options else f"airsim://{found[1]}"
                    break
            else:
                pytest.fail("it does not serve")
        finally:
            if process.poll() is None:
                process.send_signal(signal.SIGINT)
            process.communicate(timeout=60)


def _steps(folder: str) -> list[dict[str, object]]:
    lines = [json.loads(line) for line in (Path(folder) / "record.jsonl").read_text().splitlines()]
    return [line["step"] for line in lines if "step" in line]


def test_a_mission_over_the_wire_is_the_mission_in_process() -> None:
    with _serving(*WORLD, "--seed", "5", "--speed", "max") as (process, address):
        code, shown = _rex("run", *MISSION, "--vehicle", address, "--out", "wire")
        assert code == 1, shown
        assert f"vehicle at {address}" in (Path("wire") / "record.jsonl").read_text()
        process.send_signal(signal.SIGINT)
        assert process.wait(60) == 130
    header = json.loads((Path("wire") / "record.jsonl").read_text().splitlines()[0])["header"]
    x_m, y_m = header["start"][:2]
    code, shown = _rex("run", *MISSION, "--start", f"{x_m},{y_m},0", "--out", "here")
    assert code == 1, shown
    wire, here = _steps("wire"), _steps("here")
    assert len(wire) == 3
    assert [step["choice"] for step in wire] == [step["choice"] for step in here]


def test_so_it_is_by_mavlink_once_a_person_says_that_it_may_move() -> None:
    pytest.importorskip("pymavlink", reason="what MAVLink is spoken with is not installed")
    mission = [*MISSION, "--start", "0,0,0", "--clock", "virtual"]
    with _serving(*WORLD, "--as", "mavlink", "--seed", "5", "--speed", "max", "--start", "0,0,0") as (_, address):
        code, shown = _rex("run", *mission, "--vehicle", address, "--out", "refused")
        assert code == 2, shown
        assert "a real machine may be at" in shown
        code, shown = _rex("run", *mission, "--vehicle", address, "--move", "--images", "--out", "refused")
        assert code == 2, shown
        assert "no pictures come from" in shown
        code, shown = _rex("vehicle", "check", address, "--fence", "50")
        assert code == 3, shown
        assert re.search(r"ok +battery", shown)
        code, shown = _rex("run", *mission, "--vehicle", address, "--dry-run", "--out", "dry")
        assert code == 1, shown
        assert "0 m travelled" in shown
    with _serving(*WORLD, "--as", "mavlink", "--seed", "5", "--speed", "max", "--start", "0,0,0") as (_, address):
        code, shown = _rex("run", *mission, "--vehicle", address, "--move", "--out", "wire")
        assert code == 1, shown
    assert _rex("run", *mission, "--out", "here")[0] == 1
    assert [step["choice"] for step in _steps("wire")] == [step["choice"] for step in _steps("here")]


def test_a_vehicle_in_another_world_is_refused() -> None:
    with _serving(*WORLD, "--speed", "max") as (_, address):
        code, shown = _rex("run", "Find me a bench", "--world", "plaza:4@200", "--vehicle", address)
    assert code == 2, shown
    assert "another world, plaza:3@200" in shown
    assert not list(Path().iterdir())


def test_a_vehicle_that_is_not_there_is_a_part_that_failed() -> None:
    with socket.socket() as unused:
        unused.bind(("127.0.0.1", 0))
        port = unused.getsockname()[1]
        code, shown = _rex("run", "Find me a bench", *WORLD, "--vehicle", f"airsim://127.0.0.1:{port}")
    assert code == 3, shown
    assert "no link to" in shown


def test_all_that_is_wrong_is_told_at_once() -> None:
    wrong = ["--as", "foo", "--world", "nowhere", "--port", "99999", "--speed", "x", "--noise", "y", "--vehicle", "z"]
    code, shown = _rex("serve", *wrong)
    assert code == 2, shown
    assert "6 faults" in shown
    assert all(f"'{name}'" in shown for name in ("foo", "nowhere", "x", "y", "z"))
    assert "99999" in shown
    code, shown = _rex("serve", "--as", "mavlink", "--flavour", "kite", "--station", "here")
    assert code == 2, shown
    assert "2 faults" in shown
    assert "'kite'" in shown
    assert "'here'" in shown


def test_a_port_that_is_taken_is_told() -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        code, shown = _rex("serve", "--as", "airsim", *WORLD, "--port", str(port))
    assert code == 2, shown
    assert f"127.0.0.1:{port} cannot be listened on" in shown


def test_without_a_start_it_stands_at_a_free_spot_near_the_middle() -> None:
    atlas, profile = Atlas(open_world("downtown:7@300")), vehicle_profile("drone")
    spot = free_spot(atlas, profile)
    check_start(atlas, profile, spot)
    assert abs(spot.x_m) + abs(spot.y_m) < 300.0


def test_a_dry_run_looks_and_says_where_it_would_go() -> None:
    with _serving(*WORLD, "--speed", "max") as (_, address):
        code, shown = _rex("run", *MISSION, "--seed", "0", "--vehicle", address, "--dry-run", "--out", "dry")
    assert code == 1, shown
    assert "guard: would go" in shown
    assert "0 m travelled" in shown
    events = [event for step in _steps("dry") for event in step["interventions"]]  # type: ignore[attr-defined]
    assert {event["cause"] for event in events} == {"dry run"}


def test_a_fence_keeps_it_near_the_start() -> None:
    with _serving(*WORLD, "--speed", "max") as (_, address):
        code, shown = _rex("run", *MISSION, "--seed", "0", "--vehicle", address, "--fence", "6", "--out", "fenced")
    assert code in {1, 3}, shown
    steps = _steps("fenced")
    header = json.loads((Path("fenced") / "record.jsonl").read_text().splitlines()[0])["header"]
    x_m, y_m = header["start"][:2]
    track = [point for step in steps for leg in step["legs"] for point in leg["track"]]  # type: ignore[attr-defined]
    assert all((point["x_m"] - x_m) ** 2 + (point["y_m"] - y_m) ** 2 <= 36.0 for point in track)
    assert "fence" in (Path("fenced") / "record.jsonl").read_text()


def test_the_next_mission_begins_where_the_last_one_ended() -> None:
    with _serving(*WORLD, "--seed", "5", "--speed", "max") as (_, address):
        assert _rex("run", *MISSION, "--vehicle", address, "--out", "first")[0] == 1
        last = _steps("first")[-1]["legs"][-1]["track"][-1]  # type: ignore[index]
        code, shown = _rex("run", *MISSION, "--vehicle", address, "--dry-run", "--out", "second")
        assert code == 1, shown
        header = json.loads((Path("second") / "record.jsonl").read_text().splitlines()[0])["header"]
        assert header["start"][:2] == pytest.approx([last["x_m"], last["y_m"]], abs=1.0)
        assert _steps("second")[0]["pose"][:2] == pytest.approx(header["start"][:2], abs=1.0)  # type: ignore[index]
        far = "70,70" if last["x_m"] + last["y_m"] < 70.0 else "-80,0"
        code, shown = _rex("run", *MISSION, "--vehicle", address, "--start", far, "--out", "elsewhere")
        assert code == 3, shown
        assert re.search("the machine stands [0-9]+ m from the start", shown)


def test_the_list_before_moving_tells_what_is_wrong() -> None:
    with _serving(*WORLD, "--speed", "max") as (_, address):
        code, shown = _rex("vehicle", "check", address, "--fence", "50")
    assert code == 3, shown
    assert re.search(r"ok +link", shown)
    assert re.search(r"ok +camera +224 × 224 pixels", shown)
    assert re.search(r"NO +stop switch", shown)  # no terminal: nobody can press a key
    code, shown = _rex("vehicle", "check", "airsim://127.0.0.1:1")
    assert code == 3, shown
    assert re.search(r"NO +link", shown)


@pytest.mark.parametrize(
    ("arguments", "what"),
    [
        (["vehicle", "check", "drone"], "is a profile"),
        (["run", "Find me a bench", "--dry-run", "--fence", "9"], "--fence, --dry-run with 'drone'"),
        (["run", "Find me a bench", "--vehicle", "airsim://x", "--fence", "1"], "a fence of 1.0"),
        (["run", "Find me a bench", "--vehicle", "airsim://x", "--max-speed", "-1"], "speed_mps = -1.0"),
        (["run", "Find me a bench", "--vehicle", "airsim://x", "--confirm"], "nobody can be asked"),
    ],
)
def test_what_cannot_be_asked_of_a_vehicle_is_told(arguments: list[str], what: str) -> None:
    code, shown = _rex(*arguments)
    assert code == 2, shown
    assert what in shown
    assert not list(Path().iterdir())


@pytest.mark.parametrize(
    ("as_", "server"),
    [
        ("mavlink", "reasoned_explorer.serving.mavlink.server.MavlinkServer"),
        ("airsim", "reasoned_explorer.serving.airsim.server.AirSimServer"),
    ],
)
def test_nobody_is_answered_before_all_is_compiled(as_: str, server: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is compiled while a driver waits would seem to it a lost link."""
    done: list[str] = []

    async def start(*_: object) -> int:
        done.append("listens")
        raise KeyboardInterrupt

    monkeypatch.setattr(f"{server}.warm_up", lambda _: done.append("is ready"))
    monkeypatch.setattr(f"{server}.start", start)
    CliRunner().invoke(app, ["serve", "--as", as_, "--world", "park:1@150", "--port", "0"])
    assert done == ["is ready", "listens"]
