"""Rerun's recordings, read by Rerun's reader and checked by its command line."""

import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from reasoned_explorer.model import MissingDependencyError
from reasoned_explorer.viewer.exports.formats import export_mission
from reasoned_explorer.viewer.exports.mission import ExportedMission, find_mission
from reasoned_explorer.viewer.exports.rerun_recording import rrd_bytes
from tests.viewer.exports.missions import CUT_OFF, NOWHERE, RECORD, png

pytest.importorskip("rerun")
chunks = pytest.importorskip("rerun.chunk")


def _tables(path: Path) -> dict[tuple[str, bool], Any]:
    """Every entity's table, by its path and whether it holds at all times."""
    return {(each.entity_path, each.is_static): each.to_record_batch() for each in chunks.RrdReader(path).stream()}


def _rerun(home: Path, *arguments: str) -> "subprocess.CompletedProcess[str]":
    # It keeps its settings at home.
    env = {"HOME": str(home), "PATH": "/usr/bin:/bin"}
    # As the command `rerun` begins; `python -m rerun_cli` forgets the exit code.
    script = "import sys; from rerun_cli.__main__ import main; sys.exit(main())"
    return subprocess.run(
        [sys.executable, "-c", script, "rrd", *arguments], env=env, capture_output=True, text=True, check=False
    )


@pytest.fixture
def written(by_hand: Path, tmp_path: Path) -> Path:
    export_mission(find_mission(by_hand), tmp_path / "mission.rrd")
    return tmp_path / "mission.rrd"


def _seconds(table: Any) -> list[float]:
    return [value.value / 1e9 for value in table.column("mission_time")]


def test_everything_has_its_place_and_its_time(written: Path) -> None:
    tables = _tables(written)
    paths = {path for path, _ in tables}
    assert {
        "/about",
        "/judge/goal_objects",
        "/judge/reference_way",
        "/vehicle",
        "/track/0000-0",
        "/track/0000-1",
        "/agent/path_points",
        "/agent/frontiers",
        "/agent/choice",
        "/views/0",
        "/views/1",
        "/imagined",
        "/figures/ct_s",
        "/figures/tt_s",
        "/log/caption",
        "/log/checker",
        "/log/guard",
        "/log/leg",
        "/log/end",
    } <= paths
    vehicle = tables["/vehicle", False]
    assert _seconds(vehicle) == [0.0, 8.0, 12.0, 15.0, 20.0]
    assert vehicle.column("Transform3D:translation").to_pylist()[-1] == [[3.0, 12.0, 1.5]]
    turned = vehicle.column("Transform3D:quaternion").to_pylist()[-1][0]
    assert turned == pytest.approx([0.0, 0.0, 0.5**0.5, 0.5**0.5])
    # There is no other time line: neither when it was exported nor in which order.
    assert {name for each in chunks.RrdReader(written).stream() for name in each.timeline_names} == {"mission_time"}


def test_frontiers_tell_their_score(written: Path) -> None:
    frontiers = _tables(written)["/agent/frontiers", False]
    assert _seconds(frontiers) == [8.0, 20.0]
    assert frontiers.column("Points3D:labels").to_pylist()[-1] == ["0: Q 3.25, visited", "1: no score"]
    assert len(set(frontiers.column("Points3D:colors").to_pylist()[-1])) == 2


def test_pictures_words_and_figures_are_those_of_the_record(written: Path) -> None:
    tables = _tables(written)
    picture = tables["/views/0", False]
    assert _seconds(picture) == [1.0]
    assert bytes(picture.column("EncodedImage:blob").to_pylist()[0][0]) == png("red")
    said = tables["/log/caption", False].column("TextLog:text").to_pylist()
    assert said[0] == ["step 0, heading 0°: A path leads on."]
    assert "A bench under trees." in tables["/imagined", False].column("TextDocument:text").to_pylist()[0][0]
    assert tables["/figures/ct_s", False].column("Scalars:scalars").to_pylist() == [[0.0], [8.0], [18.0]]
    about = tables["/about", True].column("TextDocument:text").to_pylist()[0][0]
    assert RECORD.header.goal in about
    assert "simulated seconds" in about


def test_a_generated_place_brings_its_ground(run_mission: Path, tmp_path: Path) -> None:
    export_mission(find_mission(run_mission), tmp_path / "run.rrd")
    tables = _tables(tmp_path / "run.rrd")
    assert {"/world/ground/plaza", "/world/buildings/roofs", "/world/things/furniture"} <= {path for path, _ in tables}
    labels = tables["/world/things/furniture", True].column("Boxes3D:labels").to_pylist()[0]
    assert "bench" in labels


def test_reruns_own_command_line_finds_nothing_wrong_and_no_difference(written: Path, tmp_path: Path) -> None:
    checked = _rerun(tmp_path, "verify", str(written))
    assert checked.returncode == 0, checked.stderr
    assert "verified without error" in checked.stdout + checked.stderr
    again = tmp_path / "again.rrd"
    export_mission(find_mission(tmp_path / "by-hand"), again)
    assert _rerun(tmp_path, "compare", "--unordered", str(written), str(again)).returncode == 0
    other = tmp_path / "other.rrd"
    other.write_bytes(rrd_bytes(ExportedMission(CUT_OFF, "by-hand")))
    assert _rerun(tmp_path, "compare", "--unordered", str(written), str(other)).returncode != 0


def test_the_same_mission_is_the_same_recording(written: Path, by_hand: Path, tmp_path: Path) -> None:
    export_mission(find_mission(by_hand), tmp_path / "again.rrd")
    (tmp_path / "other.rrd").write_bytes(rrd_bytes(ExportedMission(CUT_OFF, "by-hand")))
    ids = [
        chunks.RrdReader(tmp_path / name).recordings()[0].recording_id
        for name in ("mission.rrd", "again.rrd", "other.rrd")
    ]
    assert ids[0] == ids[1] != ids[2]


@pytest.mark.parametrize("record", [CUT_OFF, NOWHERE], ids=["cut off", "world none"])
def test_missions_without_an_end_or_a_world_are_written(record: Any, tmp_path: Path) -> None:
    (tmp_path / "x.rrd").write_bytes(rrd_bytes(ExportedMission(record, "x")))
    paths = {path for path, _ in _tables(tmp_path / "x.rrd")}
    assert "/vehicle" in paths
    assert not any(path.startswith("/world") for path in paths)
    assert ("/judge/goal_objects" in paths) == (record is CUT_OFF)


def test_a_missing_library_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "rerun", None)
    with pytest.raises(MissingDependencyError, match=r"pip install 'reasoned-explorer\[rerun\]'"):
        rrd_bytes(ExportedMission(RECORD, "x"))
