"""A person at a real terminal: `--confirm` before each leg, and a key that stops the vehicle."""

import json
import os
import pty
import select
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.cli.test_serve import MISSION, WORLD, _serving

pytest.importorskip("msgpack", reason="what AirSim's wire is spoken with is not installed")


@pytest.fixture(autouse=True)
def _in_an_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def _typed(arguments: list[str], answers: dict[str, str], *, within_s: float = 240.0) -> tuple[int, str]:
    """Run `rex` on a terminal of its own and type each answer whenever its question is shown anew."""
    us, them = pty.openpty()
    command = [sys.executable, "-m", "reasoned_explorer", *arguments]
    process = subprocess.Popen(command, stdin=them, stdout=them, stderr=them)
    os.close(them)
    shown, answered = "", 0
    ends_s = time.monotonic() + within_s
    while time.monotonic() < ends_s:
        ready, _, _ = select.select([us], [], [], 0.2)
        if ready:
            try:
                shown += os.read(us, 4096).decode("utf-8", "replace")
            except OSError:  # nobody holds the other end any more
                break
        for question, answer in answers.items():
            if question in shown[answered:]:
                answered = len(shown)
                os.write(us, answer.encode())
        if process.poll() is not None and not ready:
            break
    os.close(us)
    try:
        return process.wait(10), shown
    finally:
        process.kill()


def _events() -> list[dict[str, str]]:
    lines = [json.loads(line) for line in (Path("run") / "record.jsonl").read_text().splitlines()]
    return [event for line in lines if "step" in line for event in line["step"].get("interventions", [])]


def test_each_leg_is_asked_about_and_a_no_is_kept_to() -> None:
    with _serving(*WORLD, "--speed", "max") as (_, address):
        code, shown = _typed(["run", *MISSION, "--vehicle", address, "--confirm", "--out", "run"], {"y or n:": "n"})
    assert code == 1, shown
    assert "0 m travelled" in shown
    assert {event["cause"] for event in _events()} == {"declined"}


def test_a_key_stops_the_vehicle_and_the_mission_says_so() -> None:
    with _serving(*WORLD, "--speed", "max") as (_, address):
        code, shown = _typed(["run", *MISSION, "--vehicle", address, "--confirm", "--out", "run"], {"y or n:": "q"})
    assert code == 1, shown
    assert "stopped by the operator" in shown
    summary = json.loads((Path("run") / "record.jsonl").read_text().splitlines()[-1])["summary"]
    assert (summary["end"], summary["path_length_m"]) == ("interrupted", 0.0)
