"""`rex worlds`, `rex names`, `rex doctor`."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

from reasoned_explorer.cli import doctor
from reasoned_explorer.cli.app import app


def _rex(*arguments: str) -> tuple[int, str]:
    result = CliRunner().invoke(app, list(arguments))
    return result.exit_code, result.output


@pytest.fixture(autouse=True)
def _in_an_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_a_generated_world_is_kept_and_opened_again() -> None:
    code, shown = _rex("worlds", "generate", "park:3@200", "--out", "park.rexworld")
    assert code == 0, shown
    code, again = _rex("worlds", "inspect", "park.rexworld")
    assert code == 0
    assert "bench" in again


def test_a_real_place_is_imported_and_says_what_is_unknown(osm_folder: Path) -> None:
    code, shown = _rex("worlds", "import", str(osm_folder / "uvic-campus.osm.pbf"), "--out", "uvic.rexworld")
    assert code == 0, shown
    assert "unknown" in shown
    assert "OpenStreetMap" in shown
    assert Path("uvic.rexworld").exists()


def test_a_world_is_drawn() -> None:
    assert _rex("worlds", "draw", "plaza:1@150", "plaza.png", "--width", "600")[0] == 0
    assert Path("plaza.png").read_bytes().startswith(b"\x89PNG")


def test_districts_and_names_are_listed() -> None:
    assert "waterfront" in _rex("worlds", "list")[1]
    shown = _rex("names")[1]
    for name in ("llm-rrt", "follow-paths", "embedded", "oracle", "noisy", "go1-authors", "gpt-2023"):
        assert name in shown


def test_the_doctor_says_what_is_there_and_how_to_get_the_rest(monkeypatch: pytest.MonkeyPatch) -> None:
    code, shown = _rex("doctor")
    assert code == 0
    assert "numba" in shown
    monkeypatch.setattr(doctor, "installed_version", lambda package: None)
    shown = _rex("doctor")[1]
    assert "MISSING" in shown
    assert "pip install" in shown


def test_the_version_is_said() -> None:
    assert _rex("--version")[1].startswith("rex 0.")
