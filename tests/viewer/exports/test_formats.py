"""A file is written whole or not at all."""

import errno
import os
from pathlib import Path

import pytest

from reasoned_explorer.model import InputError, PartError
from reasoned_explorer.viewer.exports.formats import FORMATS, export_mission
from reasoned_explorer.viewer.exports.mission import ExportedMission
from tests.viewer.exports.missions import RECORD

MISSION = ExportedMission(RECORD, "x")


def test_a_file_is_replaced_and_nothing_is_left_beside_it(tmp_path: Path) -> None:
    path = tmp_path / "mission.GeoJSON"
    path.write_text("old")
    assert export_mission(MISSION, path) == path.stat().st_size
    assert path.read_bytes().startswith(b"{")
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("name", ["mission.kml", "mission", ".rrd"])
def test_an_unknown_suffix_is_told_which_there_are(name: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=" or ".join(FORMATS)):
        export_mission(MISSION, tmp_path / name)


def test_a_folder_that_is_not_there_or_a_name_too_long_is_bad_input(tmp_path: Path) -> None:
    for path in (tmp_path / "nowhere" / "x.geojson", tmp_path / f"{'n' * 300}.geojson"):
        with pytest.raises(InputError, match="choose another place"):
            export_mission(MISSION, path)
    assert list(tmp_path.iterdir()) == []


def test_a_folder_in_the_way_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "x.geojson").mkdir()
    with pytest.raises(InputError, match="cannot be written"):
        export_mission(MISSION, tmp_path / "x.geojson")
    assert [path.name for path in tmp_path.iterdir()] == ["x.geojson"]


def test_a_disk_that_gets_full_leaves_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "x.geojson"
    path.write_text("old")

    def full(self: Path, data: bytes) -> int:
        with self.open("wb") as file:
            file.write(data[:10])
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(PartError, match="make room"):
        export_mission(MISSION, path)
    monkeypatch.undo()
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]
