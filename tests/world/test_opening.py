from pathlib import Path

import pytest

from reasoned_explorer.model import InputError, SettingsError, UnknownNameError, WorldError
from reasoned_explorer.world.digest import world_digest
from reasoned_explorer.world.files import save_world
from reasoned_explorer.world.opening import check_world_name, open_world, open_world_with_notes
from tests.world.worlds import courtyard


@pytest.mark.parametrize(
    ("spec", "name"), [("plaza@150", "plaza:0@150"), ("plaza:4@150", "plaza:4@150"), ("plaza:4@150.0", "plaza:4@150")]
)
def test_a_district_is_named_with_its_seed_and_its_size(spec: str, name: str) -> None:
    assert open_world(spec).name == name


def test_what_the_spec_says_wins_over_the_arguments() -> None:
    assert open_world("plaza:4@150", seed=9, size_m=300.0).name == "plaza:4@150"
    assert open_world("plaza", seed=9, size_m=150.0).name == "plaza:9@150"


def test_a_kept_world_is_the_same_world(tmp_path: Path) -> None:
    world = courtyard()
    save_world(world, tmp_path / "court.rexworld")
    assert world_digest(open_world(str(tmp_path / "court.rexworld"))) == world_digest(world)


@pytest.mark.parametrize(
    ("spec", "error"),
    [
        ("", WorldError),
        ("park:seven", WorldError),
        ("park@", WorldError),
        ("../park", WorldError),
        ("parc", UnknownNameError),
        ("park@5000", SettingsError),
        ("nowhere.osm", WorldError),
        ("nowhere.rexworld", WorldError),
    ],
)
def test_what_is_no_world_is_refused(spec: str, error: type[Exception]) -> None:
    with pytest.raises(error):
        open_world(spec)


def test_only_maps_are_cropped(tmp_path: Path) -> None:
    save_world(courtyard(), tmp_path / "court.rexworld")
    for spec in ("park:7", str(tmp_path / "court.rexworld")):
        with pytest.raises(WorldError, match="only for OpenStreetMap"):
            open_world(spec, bbox=(1.0, 2.0, 3.0, 4.0))


def test_the_fingerprint_tells_worlds_apart() -> None:
    assert world_digest(open_world("plaza:4@150")) == world_digest(open_world("plaza:4@150"))
    assert world_digest(open_world("plaza:4@150")) != world_digest(open_world("plaza:5@150"))


def test_a_world_is_named_with_the_permutation_of_its_labels(tmp_path: Path) -> None:
    world = open_world("plaza:4@150~permuted:1")
    assert world.name == "plaza:4@150~permuted:1"
    assert world_digest(world) == world_digest(open_world("plaza@150~permuted:1", seed=4))
    assert world_digest(world) != world_digest(open_world("plaza:4@150"))
    assert world_digest(world) != world_digest(open_world("plaza:4@150~permuted:2"))
    save_world(courtyard(), tmp_path / "court.rexworld")
    assert open_world(str(tmp_path / "court.rexworld~permuted:3")).name == "courtyard~permuted:3"


def test_a_real_place_is_permuted_within_its_bounding_box(osm_folder: Path) -> None:
    box = (-123.3125, 48.4630, -123.3100, 48.4650)
    world = open_world(f"{osm_folder / 'uvic-campus.osm.pbf'}~permuted:1", bbox=box)
    assert world.name == "uvic-campus~permuted:1"
    assert world.attribution


@pytest.mark.parametrize("spec", ["plaza:4@150~permuted", "plaza:4@150~permuted:x", "~permuted:1"])
def test_what_is_no_permutation_is_refused(spec: str) -> None:
    with pytest.raises(WorldError):
        open_world(spec)


@pytest.mark.parametrize(
    "spec", ["prak:7", "park:7@5000", "nowhere.osm", "nowhere.rexworld", "nowhere.osm~permuted:1", "?"]
)
def test_a_name_is_checked_without_making_the_world(spec: str, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(InputError) as refused:
        check_world_name(spec)
    with pytest.raises(InputError) as opened:
        open_world(spec)
    assert str(refused.value) == str(opened.value)
    monkeypatch.setattr("reasoned_explorer.world.generator.generate_world", None)
    check_world_name("park:7@400~permuted:1")


def test_a_name_and_its_box_are_wrong_at_once() -> None:
    with pytest.raises(InputError) as raised:
        check_world_name("prak:7", bbox=(1.0, 2.0, 3.0, 4.0))
    assert len(raised.value.faults) == 2
    with pytest.raises(WorldError) as raised:
        check_world_name("nowhere.osm", bbox=(3.0, 2.0, 1.0, 1.0))
    assert len(raised.value.faults) == 3


@pytest.mark.parametrize(
    ("spec", "told"),
    [
        ("park:-1", "has the seed '-1'; expected a whole number"),
        ("park:x", "has the seed 'x'"),
        ("park:7@nan", "has the size 'nan'; expected metres"),
        ("park:x@-5", "has the size '-5'"),
        ("park:", "lacks a seed or a size"),
        ("?", ".osm, .osm.gz, .osm.bz2, .osm.pbf or .rexworld"),
    ],
)
def test_what_is_wrong_with_a_name_is_said(spec: str, told: str) -> None:
    with pytest.raises(WorldError) as raised:
        open_world(spec)
    assert told in str(raised.value)


def test_all_that_is_wrong_with_a_name_is_said_at_once() -> None:
    with pytest.raises(WorldError) as raised:
        open_world("prak:x@nan")
    assert len(raised.value.faults) == 3
    assert "did you mean park" in str(raised.value)


def test_a_map_that_was_cropped_without_being_asked_says_so(tmp_path: Path) -> None:
    path = tmp_path / "wide.osm"
    ways = "".join(f"<node id='{k}' lat='{48.1 + k % 2 / 500}' lon='{11.5 + k / 500}'/>" for k in range(1, 5))
    path.write_text(
        f"<osm version='0.6'><bounds minlat='48' minlon='11' maxlat='49' maxlon='12'/>{ways}"
        "<way id='9'><nd ref='1'/><nd ref='2'/><nd ref='3'/><nd ref='4'/><tag k='highway' v='footway'/></way></osm>"
    )
    world, notes = open_world_with_notes(str(path))
    assert len(notes) == 1
    assert "too large; imported what is built up" in notes[0]
    assert world.bounds.width_m < 1000.0
    assert open_world_with_notes("plaza:4@150")[1] == ()
