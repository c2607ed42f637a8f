"""`rex look`, as a person types it."""

import json
import shlex
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image
from typer.testing import CliRunner

from reasoned_explorer.cli import look as look_module
from reasoned_explorer.cli.app import app
from reasoned_explorer.cli.look_files import write_together
from reasoned_explorer.cli.parsing import check_view_form, parse_size, parse_view
from reasoned_explorer.geometry import GeoOrigin
from reasoned_explorer.model import PartError, ReasonedExplorerError, SettingsError, StartError
from reasoned_explorer.rendering.scene import PICTURE_CLASSES
from tests.cli.test_parsing import HERE, MUNICH

WORLD = ["--world", "plaza:3@150"]
SMALL = [*WORLD, "--at", "0,0,1.6,40", "--size", "64x48"]


def _rex(*arguments: str) -> tuple[int, str]:
    result = CliRunner().invoke(app, ["look", *arguments])
    return result.exit_code, result.output + (result.stderr if result.stderr_bytes else "")


@pytest.fixture(autouse=True)
def _in_an_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def _picture(name: str = "look.png") -> np.ndarray:
    with Image.open(name) as picture:
        return np.asarray(picture)


def test_a_view_is_drawn_and_nothing_else_is_written(tmp_path: Path) -> None:
    code, shown = _rex(*SMALL)
    assert code == 0, shown
    assert "drawn to look.png" in shown
    assert [path.name for path in tmp_path.iterdir()] == ["look.png"]
    picture = _picture()
    assert picture.shape == (48, 64, 3)
    assert picture.std() > 10


def test_the_same_command_gives_the_same_bytes() -> None:
    _rex(*SMALL, "--out", "a.png")
    _rex(*SMALL, "--out", "b.png")
    assert Path("a.png").read_bytes() == Path("b.png").read_bytes()


def test_depth_and_ids_come_with_it() -> None:
    code, shown = _rex(*SMALL, "--depth", "--ids")
    assert code == 0, shown
    depth_m, millimetres = np.load("look.depth.npy"), _picture("look.depth.png")
    near = depth_m < 60.0
    assert near.any()
    assert np.abs(depth_m[near] - millimetres[near] / 1000.0).max() < 0.001
    assert (millimetres[np.isinf(depth_m)] == 0).all()
    instances, classes = np.load("look.ids.npy"), np.load("look.classes.npy")
    assert instances.shape == classes.shape == (48, 64)
    assert ((instances == 0) == np.isinf(depth_m)).all()
    legend = json.loads(Path("look.classes.json").read_text())
    assert sum(entry["share"] for entry in legend.values()) == pytest.approx(1.0, abs=1e-4)
    coloured = _picture("look.classes.png")
    for code_text, entry in legend.items():
        assert entry["name"] == PICTURE_CLASSES[int(code_text)]
        assert (coloured[classes == int(code_text)] == entry["colour"]).all()


def test_the_field_of_view_and_the_pitch_count() -> None:
    _rex(*SMALL, "--ids", "--out", "level.png")
    _rex(*SMALL, "--ids", "--pitch", "60", "--out", "up.png")
    _rex(*SMALL, "--ids", "--fov", "20", "--out", "near.png")
    level, up, near = (np.load(f"{name}.ids.npy") for name in ("level", "up", "near"))
    assert (up == 0).mean() > (level == 0).mean()
    assert (near != level).any()


def test_all_around_is_one_strip() -> None:
    code, shown = _rex(*WORLD, "--at", "0,0", "--panorama", "--size", "128x32")
    assert code == 0, shown
    assert _picture().shape == (32, 128, 3)


def test_from_above_the_whole_world_is_shown() -> None:
    code, shown = _rex(*WORLD, "--top-down", "--width", "96", "--height", "96", "--depth")
    assert code == 0, shown
    heights_m = np.load("look.height.npy")
    assert heights_m.shape == (96, 96)
    assert heights_m.min() == pytest.approx(0.0, abs=0.01)
    assert 3.0 < heights_m.max() < 100.0
    assert not Path("look.depth.npy").exists()


def test_the_authors_rig_has_three_cameras() -> None:
    code, shown = _rex(*WORLD, "--at", "0,0", "--rig", "authors")
    assert code == 0, shown
    rig = _picture()
    assert rig.shape == (224, 672, 3)
    _rex(*WORLD, "--at", "0,0,1,45", "--size", "224x224", "--out", "right.png")
    assert (rig[:, 448:] == _picture("right.png")).all()


def test_a_sweep_spans_120_degrees() -> None:
    _rex(*WORLD, "--at", "0,0,90", "--sweep", "3", "--size", "48x48")
    _rex(*WORLD, "--at", "0,0,30", "--size", "48x48", "--out", "left.png")
    assert _picture().shape == (48, 144, 3)
    assert (_picture()[:, :48] == _picture("left.png")).all()


def test_the_contact_sheet_needs_no_world(monkeypatch: pytest.MonkeyPatch) -> None:
    import reasoned_explorer.rendering.contact_sheet as sheets

    monkeypatch.setattr(sheets, "contact_sheet", lambda **_: np.zeros((8, 8, 3), np.uint8))
    code, shown = _rex("--contact-sheet", "--out", "sheet.png")
    assert code == 0, shown
    assert _picture("sheet.png").shape == (8, 8, 3)


def test_a_real_place_takes_latitude_and_longitude_and_thanks_its_mappers(osm_folder: Path) -> None:
    town = ["--world", str(osm_folder / "munich-centre.osm.pbf"), "--bbox", "11.5745,48.1365,11.5765,48.1375"]
    code, shown = _rex(*town, "--at", "48.2,11.5755")
    assert code == 2
    assert "expected latitude 48.1" in shown
    assert "--start" not in shown
    code, shown = _rex(*town, "--at", "48.1370,11.5755,1.6,90", "--size", "64x48")
    assert code == 0, shown
    assert "OpenStreetMap contributors" in shown
    with Image.open("look.png") as picture:
        assert "OpenStreetMap contributors" in picture.info["Copyright"]


def test_it_says_that_it_compiles_where_nothing_is_compiled_yet(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(look_module, "is_ready", lambda: False)
    _, shown = _rex(*SMALL)
    assert "the first time only" in shown
    told = ("the world …", "what things look like …", "buildings …", "light and shadow …")
    assert [shown.index(line) for line in told] == sorted(shown.index(line) for line in told)


def test_it_says_how_far_compiling_is(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(look_module, "is_ready", lambda: False)
    monkeypatch.setattr(look_module, "make_ready", lambda stage: stage("about 40 %"))
    _, shown = _rex(*SMALL)
    assert shown.index("things …") < shown.index("about 40 % …") < shown.index("light and shadow …")


def _documented() -> list[str]:
    text = (Path(__file__).resolve().parents[2] / "docs" / "look.md").read_text(encoding="utf-8")
    commands = [line.split("#")[0].strip() for line in text.splitlines() if line.startswith("rex look ")]
    return [command for command in commands if "map.osm" not in command and "--contact-sheet" not in command]


def test_there_are_commands_in_the_documentation() -> None:
    assert len(_documented()) == 5


@pytest.mark.parametrize("command", _documented())
def test_what_the_documentation_tells_people_to_type_works(command: str) -> None:
    code, shown = _rex(*shlex.split(command.replace("downtown:7", WORLD[1]))[2:])
    assert code == 0, shown
    assert Path("look.png").stat().st_size > 10_000


BAD = {
    "nowhere to look from": [],
    "a place that is none": ["--at", "here"],
    "a place of NaN": ["--at", "nan,0,1.6,0"],
    "a place of five numbers": ["--at", "0,0,1.6,0,0"],
    "a place off the map": ["--at", "900,0,1.6,0"],
    "a camera under ground": ["--at", "0,0,-1,0"],
    "a heading of two turns": ["--at", "0,0,1.6,720"],
    "no size": ["--at", "0,0", "--size", "0x0"],
    "a size in words": ["--at", "0,0", "--size", "large"],
    "a picture too wide": ["--at", "0,0", "--width", "99999"],
    "two sizes": ["--at", "0,0", "--size", "64x48", "--width", "64"],
    "a field of view of a half turn": ["--at", "0,0", "--fov", "180"],
    "a field of view of NaN": ["--at", "0,0", "--fov", "nan"],
    "a pitch over the head": ["--at", "0,0", "--pitch", "91"],
    "unknown conditions": ["--at", "0,0", "--conditions", "clera"],
    "an unknown rig": ["--at", "0,0", "--rig", "author"],
    "no view at all": ["--at", "0,0", "--sweep", "0"],
    "two kinds of pictures": ["--at", "0,0", "--panorama", "--top-down"],
    "a pitch all around": ["--at", "0,0", "--panorama", "--pitch", "3"],
    "a span of a view": ["--at", "0,0", "--span", "30"],
    "a span of nothing": ["--top-down", "--span", "0"],
    "a place for a sheet": ["--contact-sheet", "--at", "0,0"],
    "a picture of another kind": ["--at", "0,0", "--out", "look.jpg"],
    "a folder that is not there": ["--at", "0,0", "--out", "nowhere/look.png"],
    "an unknown world": ["--at", "0,0", "--world", "prak"],
    "a negative seed": ["--at", "0,0", "--seed", "-1"],
    "a bounding box of a district": ["--at", "0,0", "--bbox", "1,2,3,4"],
}


@pytest.mark.parametrize("case", BAD)
def test_bad_input_is_answered_in_words_with_code_two_and_leaves_nothing(case: str, tmp_path: Path) -> None:
    world = [] if "--world" in BAD[case] else WORLD
    code, shown = _rex(*world, *BAD[case])
    assert code == 2, shown
    assert "expected" in shown
    assert "Traceback" not in shown
    assert list(tmp_path.iterdir()) == []


def test_all_faults_are_told_at_once() -> None:
    _, shown = _rex("--at", "here,0", "--fov", "500", "--size", "1x1", "--conditions", "hail", "--world", "prak")
    for part in ("'here'", "--fov is 500", "the width is 1", "the height is 1", "'hail'", "'prak'"):
        assert part in shown


def test_where_one_file_cannot_be_written_none_is(tmp_path: Path) -> None:
    kept = tmp_path / "look.png"
    kept.write_bytes(b"as it was")
    with pytest.raises(SettingsError):
        write_together({kept: b"new", tmp_path / "nowhere" / "look.depth.npy": b"new"})
    assert kept.read_bytes() == b"as it was"
    assert list(tmp_path.iterdir()) == [kept]


def test_a_full_disk_is_a_part_that_fails(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("reasoned_explorer.cli.look_files.os.fdopen", full)
    with pytest.raises(PartError, match="make room"):
        write_together({tmp_path / "look.png": b"new"})
    assert list(tmp_path.iterdir()) == []


def test_a_viewpoint_may_leave_height_and_heading_out() -> None:
    assert parse_view("1,2", HERE, height_m=1.5).z_m == 1.5
    assert parse_view("1,2,90", HERE, height_m=1.5).heading_rad == pytest.approx(np.pi / 2)
    high = parse_view("1,2,30,90", HERE, height_m=1.5)
    assert (high.z_m, high.heading_rad) == (30.0, pytest.approx(np.pi / 2))


def test_a_viewpoint_on_earth_is_latitude_and_longitude() -> None:
    assert MUNICH.origin == GeoOrigin(48.1374, 11.5755)
    view = parse_view("48.1380,11.5756,1.6,-90", MUNICH, height_m=1.5)
    assert view.x_m == pytest.approx(7.4, abs=0.1)
    assert view.z_m == 1.6


@given(st.text(alphabet="0123456789.,-+einaf x×", max_size=24))
def test_whatever_is_typed_is_understood_or_refused(text: str) -> None:
    for parse in (lambda: parse_view(text, HERE, height_m=1.5), lambda: parse_size(text)):
        with suppress(ReasonedExplorerError):
            parse()


def test_all_faults_of_a_viewpoint_are_told_at_once() -> None:
    with pytest.raises(StartError) as raised:
        check_view_form("nan,north,-3,900")
    assert len(raised.value.faults) == 3


@pytest.mark.parametrize("text", ["", "x", "12", "12x", "1x2x3", "-4x5", "4.5x6", "1e3x10"])
def test_a_size_is_two_whole_numbers(text: str) -> None:
    with pytest.raises(SettingsError, match="1024x768"):
        parse_size(text)


def test_a_size_is_read_with_either_cross() -> None:
    assert parse_size("640x480") == parse_size("640 × 480") == (640, 480)
