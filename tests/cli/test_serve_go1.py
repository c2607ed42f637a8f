"""`rex serve --as go1` in a process of its own, and `rex run` and `rex vehicle check` against it."""

import json
import re
import shlex
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from typer.testing import CliRunner

from reasoned_explorer.cli.app import app
from reasoned_explorer.evaluation.mission import Mission, MissionSettings
from reasoned_explorer.exploration.settings import ExplorerSettings
from reasoned_explorer.geometry import Pose
from reasoned_explorer.serving.go1.server import Go1Server
from reasoned_explorer.serving.go1.walker import Walker
from reasoned_explorer.simulation.pixel_eyes import PixelEyes
from reasoned_explorer.simulation.vehicle import SimulatedVehicle
from reasoned_explorer.simulation.walking import SatelliteFix
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.opening import open_world
from tests.vehicles.cameras.served import RED, served_camera

PLACE = ["--world", "plaza:3@200", "--seed", "5", "--start", "0,0,0"]
GOAL = "Find me a fire hydrant"
SHORT = ["--max-steps", "1", "--no-map"]
NOWHERE = ["--vehicle", "go1://127.0.0.1:9", "--gps", "gpsd://127.0.0.1:9"]


@pytest.fixture(autouse=True)
def _in_an_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def _rex(*arguments: str) -> tuple[int, str]:
    result = CliRunner().invoke(app, list(arguments))
    return result.exit_code, result.output + (result.stderr if result.stderr_bytes else "")


@contextmanager
def _serving(*options: str) -> Iterator[list[str]]:
    """Serve on free ports until the block ends; gives what it says to type, without `rex run` and the goal."""
    command = [sys.executable, "-m", "reasoned_explorer", "serve", "--as", "go1", *PLACE, "--port", "0", *options]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as process:
        assert process.stdout is not None
        try:
            for line in process.stdout:
                if found := re.search(r"try: rex run (.*)", line):
                    yield shlex.split(found[1])[1:]
                    break
            else:
                pytest.fail("it does not serve")
        finally:
            if process.poll() is None:
                process.send_signal(signal.SIGINT)
            process.communicate(timeout=60)


def _steps(folder: str) -> list[dict[str, Any]]:
    lines = [json.loads(line) for line in (Path(folder) / "record.jsonl").read_text().splitlines()]
    return [line["step"] for line in lines if "step" in line]


def _here(steps: int) -> list[Any]:
    """Return the same mission in-process, of the same noise: none."""
    atlas, explorer = Atlas(open_world("plaza:3@200")), ExplorerSettings(max_steps=steps)
    settings = MissionSettings(seed=5, vehicle="go1", explorer=explorer)
    mission = Mission(GOAL, atlas, settings, start=Pose(0.0, 0.0))
    eyes = PixelEyes(atlas)
    vehicle = SimulatedVehicle(
        atlas, mission.profile, mission.start, clock=mission.clock, eyes=eyes, seed=5, noise="none"
    )
    mission.explorer.parts = replace(mission.explorer.parts, vehicle=vehicle)
    return list(mission.run().record.steps)


def test_a_mission_over_the_wire_is_the_mission_in_process() -> None:
    with _serving("--noise", "none", "--speed", "max") as typed:
        code, shown = _rex("run", GOAL, *typed, "--max-steps", "3", "--no-map", "--out", "wire")
    assert code == 1, shown
    assert "vehicle at go1://127.0.0.1" in (Path("wire") / "record.jsonl").read_text()
    wire, here = _steps("wire"), _here(3)
    assert len(wire) == len(here) == 3
    for step, expected in zip(wire, here, strict=True):
        assert step["choice"]["frontier"] == expected.choice.frontier
        assert [view["caption"] for view in step["views"]] == [view.caption for view in expected.views]
        assert [leg["outcome"] for leg in step["legs"]] == [leg.outcome for leg in expected.legs]


def test_pictures_come_from_the_camera_that_is_named() -> None:
    with served_camera() as camera, _serving("--speed", "max") as typed:
        camera.show(RED)
        code, shown = _rex("run", GOAL, *typed, *SHORT, "--images", "--out", "blind")
        assert code == 2, shown
        assert re.search(r"no pictures come from go1://.*--camera", shown)
        code, shown = _rex("run", GOAL, *typed, *SHORT, "--images", "--camera", camera.address, "--out", "seen")
        assert code == 1, shown
    pictures = sorted(Path("seen").rglob("*.png"))
    assert len(pictures) == 3
    picture = np.asarray(Image.open(pictures[0]).convert("RGB"))
    assert picture.shape == (448, 448, 3)
    assert np.abs(picture.mean(axis=(0, 1)) - RED).max() < 40.0


def test_without_its_receiver_it_does_not_begin_and_without_its_camera_it_stands() -> None:
    pytest.importorskip("av", reason="PyAV is not installed (the extra `cameras`)")
    with socket.socket() as unused, _serving("--speed", "max") as typed:
        unused.bind(("127.0.0.1", 0))
        port = unused.getsockname()[1]
        gps = typed.index("--gps") + 1
        code, shown = _rex("run", GOAL, *typed[:gps], f"gpsd://127.0.0.1:{port}", *typed[gps + 1 :], *SHORT)
        assert code == 3, shown
        assert f"gpsd at 127.0.0.1:{port} cannot be reached" in shown
        assert "0 m travelled" in shown
        camera = f"rtsp://127.0.0.1:{port}/ahead"
        code, shown = _rex("run", GOAL, *typed, *SHORT, "--images", "--camera", camera)
        assert code == 1, shown
        assert re.search(rf"guard: camera: no new picture from {camera} .*refused \(camera\)", shown)
        assert "0 m travelled" in shown


def test_a_start_that_is_not_where_its_receiver_is_is_refused() -> None:
    with _serving("--speed", "max") as typed:
        start = typed.index("--start") + 1
        code, shown = _rex("run", GOAL, *typed[:start], "80,60,0", *typed[start + 1 :], *SHORT)
    assert code == 3, shown
    assert "100 m from the start" in shown


def test_the_list_before_moving_looks_at_a_go1_too() -> None:
    with _serving() as typed:
        where = typed.index("--vehicle") + 1
        code, shown = _rex("vehicle", "check", typed[where], "--gps", typed[where + 2], "--fence", "50")
    assert code == 3, shown
    assert re.search(r"NO +stop switch", shown)  # no terminal: nobody can press a key


@pytest.mark.parametrize(
    ("arguments", "what"),
    [
        (["run", GOAL, "--vehicle", "go1://127.0.0.1", "--move"], ["--gps gpsd://HOST:PORT"]),
        (["run", GOAL, *NOWHERE], ["a real machine may be at go1://127.0.0.1:9"]),
        (["run", GOAL, "--gps", "gpsd://here"], ["--gps with 'drone'"]),
        (
            [
                *("run", GOAL, "--vehicle", "go1://127.0.0.1", "--gps", "serial:/dev/ttyNONE3:1"),
                "--ntrip",
                "ntrip://caster",
            ],
            ["'1' bits a second", "the mountpoint is ''", "a real machine may be"],
        ),
        (
            ["run", GOAL, *NOWHERE, "--move", "--camera", "/dev/video93", "--camera-fov", "1"],
            ["there is no /dev/video93", "degrees in [10, 170]"],
        ),
        (["vehicle", "check", "go1://127.0.0.1"], ["no receiver for go1://127.0.0.1:8082"]),
        (["vehicle", "check", "go1://127.0.0.1:x"], ["go1://HOST:PORT"]),
        (
            ["vehicle", "check", "airsim://127.0.0.1", "--camera", "rtsp://camera"],
            ["its pictures come over its own wire"],
        ),
        (["serve", "--as", "go1", "--speed", "4", "--gps-port", "70000"], ["4 as go1", "70000"]),
        (["serve", "--as", "go1", "--world", "plaza:3@200", "--vehicle", "drone"], ["'drone' does not walk"]),
    ],
)
def test_what_is_wrong_is_told_at_once(arguments: list[str], what: list[str]) -> None:
    code, shown = _rex(*arguments)
    assert code == 2, shown
    assert all(part in shown for part in what), shown
    assert not list(Path().iterdir())


def test_the_list_says_that_it_is_the_receiver_that_is_not_there() -> None:
    code, shown = _rex("vehicle", "check", *NOWHERE[1:])
    assert code == 3, shown
    assert re.search(r"NO +link +positioning: gpsd at 127.0.0.1:9 cannot be reached", shown)


def test_a_port_of_its_receiver_that_is_taken_is_told() -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        code, shown = _rex("serve", "--as", "go1", *PLACE, "--port", "0", "--gps-port", str(port))
    assert code == 2, shown
    assert f"127.0.0.1:{port} cannot be listened on" in shown
    assert "--gps-port 0" in shown


def test_its_receiver_has_spoken_for_nothing_before_anybody_listens(monkeypatch: pytest.MonkeyPatch) -> None:
    """What a fix needs is compiled then: later it would hold the robot up for a second."""
    done: list[str] = []
    tick = Walker.tick

    def noted(walker: Walker) -> SatelliteFix | None:
        fix = tick(walker)
        if fix is not None:
            done.append("says where it is")
        return fix

    async def start(*_: object) -> int:
        done.append("listens")
        raise KeyboardInterrupt

    monkeypatch.setattr(Walker, "tick", noted)
    monkeypatch.setattr(Go1Server, "start", start)
    CliRunner().invoke(app, ["serve", "--as", "go1", "--world", "park:1@150", "--port", "0", "--gps-port", "0"])
    assert done[0] == "says where it is"
    assert done[-1] == "listens"
