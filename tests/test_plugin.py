"""Another package adds its parts through entry points: installed for real, found by name, used in a mission."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

PLUGIN = Path(__file__).resolve().parents[1] / "examples" / "plugin"


@pytest.fixture(scope="module")
def with_plugin(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """Install the example package into a folder of its own and return an environment that sees it."""
    pytest.importorskip("hatchling", reason="the build backend of the example is not installed")
    target = tmp_path_factory.mktemp("plugin")
    command = [sys.executable, "-m", "pip", "install", "--quiet", "--no-index", "--no-deps", "--no-build-isolation"]
    subprocess.run([*command, "--target", str(target), str(PLUGIN)], check=True, capture_output=True)
    return {**os.environ, "PYTHONPATH": str(target)}


def _rex(environment: dict[str, str], folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "reasoned_explorer", *arguments]
    return subprocess.run(command, env=environment, cwd=folder, capture_output=True, text=True, check=False)


def test_its_names_are_listed_with_where_they_come_from(with_plugin: dict[str, str], tmp_path: Path) -> None:
    shown = _rex(with_plugin, tmp_path, "names").stdout
    for name in ("due-north", "easily-pleased", "terse", "tortoise", "meadow"):
        assert name in shown
    assert "rex-compass" in shown


def test_its_parts_run_a_mission_together(with_plugin: dict[str, str], tmp_path: Path) -> None:
    chosen = ["--world", "meadow@200", "--planner", "due-north", "--minds", "easily-pleased", "--captioner", "terse"]
    run = _rex(with_plugin, tmp_path, "run", "Find me a bench", *chosen, "--start", "0,-40,0", "--out", "run")
    assert run.returncode == 0, run.stdout + run.stderr
    assert "due-north" in run.stdout
    assert (tmp_path / "run" / "record.jsonl").exists()


def test_its_vehicle_is_as_slow_as_it_says(with_plugin: dict[str, str], tmp_path: Path) -> None:
    chosen = ["--world", "meadow@200", "--vehicle", "tortoise", "--t-max", "2", "--out", "run"]
    run = _rex(with_plugin, tmp_path, "run", "Find me a bench", *chosen, "--start", "0,-40,0")
    assert run.returncode == 1, run.stdout + run.stderr
    assert "time over" in run.stdout
