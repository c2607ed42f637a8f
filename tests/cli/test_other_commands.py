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


def test_rows_groups_and_forms_of_worlds_are_listed() -> None:
    shown = _rex("names")[1]
    for said in ("oracle", "foresight-60m", "X+perfect-halt", "halts", "planners + bounds", "X~permuted:1", ".osm.pbf"):
        assert said in shown, said


def test_a_row_of_the_benchmark_is_told_from_an_unknown_planner() -> None:
    for name in ("oracle", "llm-rrt+perfect-halt"):
        code, shown = _rex("run", "Find me a bench", "--planner", name)
        assert code == 2
        assert "rex bench --planners" in shown


def test_a_world_that_is_none_is_told_what_may_be_named() -> None:
    for spec in ("park:7~permuted", "park~permuted:x", "town.osm~permute:1"):
        code, shown = _rex("worlds", "inspect", spec)
        assert code == 2
        assert "park:7~permuted:1" in shown
    assert ".osm.pbf" in _rex("worlds", "inspect", "nope")[1]


def test_what_an_option_needs_is_not_taken_for_markup() -> None:
    words = " ".join(_rex("bench", "--help")[1].replace("│", " ").split())
    assert "reasoned-explorer[ray]" in words
    assert "1 for --world" in words
