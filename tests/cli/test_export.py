"""`rex export` of missions, as a person types it; that of results is in test_bench."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

from reasoned_explorer.cli.app import app
from tests.cli.full_disk import rex_with_files_up_to
from tests.viewer.exports.missions import NOWHERE, RECORD, keep


def _rex(*arguments: str) -> tuple[int, str]:
    result = CliRunner().invoke(app, list(arguments), env={"COLUMNS": "400"})
    return result.exit_code, result.output + (result.stderr if result.stderr_bytes else "")


@pytest.fixture
def mission(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    return keep(tmp_path / "mission", RECORD, pictures=True)


@pytest.mark.parametrize(
    ("suffix", "package", "begins"),
    [
        (".rrd", "rerun", b"RRF2"),
        (".mcap", "foxglove", b"\x89MCAP0\r\n"),
        (".geojson", "json", b"{"),
        (".gpx", "gpxpy", b"<?xml"),
    ],
)
def test_a_mission_is_exported_by_the_suffix(suffix: str, package: str, begins: bytes, mission: Path) -> None:
    pytest.importorskip(package)
    code, shown = _rex("export", str(mission), f"out{suffix}")
    assert code == 0, shown
    assert f"mission, 2 steps, in out{suffix}" in shown
    assert Path(f"out{suffix}").read_bytes().startswith(begins)
    # A map of the earth has its own ground.
    assert ("without its ground" in shown) == (suffix in {".rrd", ".mcap"})


def test_a_world_may_be_named_and_must_be_the_right_one(mission: Path) -> None:
    pytest.importorskip("foxglove")
    code, shown = _rex("export", str(mission), "out.mcap", "--world", "plaza:3@200")
    assert code == 2
    assert "not the world of the mission" in shown
    assert _rex("export", str(mission), "out.mcap", "--bbox", "1,2,3,4")[0] == 2
    assert not Path("out.mcap").exists()


BAD = {
    "a place that is not on earth": (["NOWHERE", "out.gpx"], "no place on earth is known"),
    "an unknown suffix": (
        ["MISSION", "out.kml"],
        ".csv or .parquet (results), or in .rrd or .mcap or .geojson or .gpx",
    ),
    "no folder to export to": (["MISSION", "nowhere/out.geojson"], "a folder that exists"),
    "no mission": (["nothing", "out.geojson"], "the folder of a run"),
    "a choice where there is none": (["MISSION", "out.geojson", "--planner", "random"], "a run of rex bench"),
    "a choice for all missions": (["MISSION", "out.csv", "--mission", "x"], "which holds all missions"),
    "results of a mission": (["MISSION", "out.csv"], "holds no run.sqlite"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_input_is_answered_in_words_with_code_two_and_leaves_nothing(
    case: str, mission: Path, tmp_path: Path
) -> None:
    arguments, said = BAD[case]
    places = {"MISSION": str(mission), "NOWHERE": str(keep(tmp_path / "nowhere", NOWHERE))}
    code, shown = _rex("export", *(places.get(part, part) for part in arguments))
    assert code == 2, shown
    assert said in shown
    assert "Traceback" not in shown
    assert list(Path().iterdir()) == []


def test_a_full_disk_is_said_and_leaves_the_old_file(mission: Path, tmp_path: Path) -> None:
    path = tmp_path / "out.geojson"
    path.write_text("old")
    ended = rex_with_files_up_to(1024, "export", str(mission), str(path))
    assert ended.returncode == 3, ended.stderr
    assert "out.geojson cannot be written" in ended.stderr
    assert path.read_text() == "old"
    assert sorted(each.name for each in tmp_path.iterdir()) == ["here", "mission", "out.geojson"]
    assert _rex("export", str(mission), str(path))[0] == 0
    assert json.loads(path.read_text())["type"] == "FeatureCollection"
