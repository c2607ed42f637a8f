from collections import Counter
from pathlib import Path

import pytest

from reasoned_explorer.model import InputError, SettingsError, StartError, UnknownNameError, WorldError
from reasoned_explorer.task.split import BANDS_M, LEVELS, Place
from reasoned_explorer.task.splitting import Dealing, Share, built_in_split, make_split, open_place, places_of_worlds
from reasoned_explorer.world.files import save_world
from reasoned_explorer.world.generator import generate_world

SHARED = Path(__file__).parents[2] / ".." / "shared" / "osm"
PLAZA = Place("plaza:4@400", "plaza:4@400", district="plaza")
PARK = Place("park:6@400", "park:6@400", district="park")
#: A street and a bench: hardly anything to look for.
BARE = Place("residential:1@100", "residential:1@100", district="residential")


def test_a_cell_deals_the_same_whatever_else_is_asked_for() -> None:
    dealing = Dealing(9)
    everything = {(level, band): 1 for level in LEVELS for band in BANDS_M}
    alone = dealing.deal(PLAZA, {(2, "middle"): 1}).episodes
    among = [item for item in dealing.deal(PLAZA, everything).episodes if item.episode.spec.level == 2]
    assert alone == tuple(item for item in among if item.band == "middle")


def test_a_split_is_balanced_over_levels_and_distances() -> None:
    split = make_split("two", [PLAZA, PARK], share=Share(), dealing=Dealing(2))
    counts = Counter((item.episode.spec.level, item.band) for item in split.episodes)
    assert set(counts.values()) == {2}
    assert len({item.episode.id for item in split.episodes}) == len(split.episodes)


def test_where_a_place_is_asked_for_some_distances_these_go_round() -> None:
    cells = [set(Share(distances=2).cells(place)) for place in range(3)]
    assert {len(asked) for asked in cells} == {2 * len(LEVELS)}
    counts = Counter(cell for asked in cells for cell in asked)
    assert len(counts) == len(LEVELS) * len(BANDS_M)
    assert set(counts.values()) == {2}


def test_what_one_place_lacks_is_dealt_by_another() -> None:
    split = make_split("lacking", [BARE, PLAZA], share=Share(), dealing=Dealing(2))
    counts = Counter((item.episode.spec.level, item.band) for item in split.episodes)
    from_plaza = Counter((item.episode.spec.level, item.band) for item in split.episodes if item.place == PLAZA.name)
    assert max(from_plaza.values()) == 2
    assert all(counts[cell] == 2 for cell in from_plaza)


def test_the_order_in_which_places_are_dealt_changes_nothing() -> None:
    def backwards(deal, places, cells):  # type: ignore[no-untyped-def]
        made = [deal(place, wanted) for place, wanted in reversed(list(zip(places, cells, strict=True)))]
        return made[::-1]

    one = make_split("s", [PLAZA, PARK], share=Share(), dealing=Dealing(2))
    other = make_split("s", [PLAZA, PARK], share=Share(), dealing=Dealing(2), map_places=backwards)
    assert one == other


def test_starts_are_fit_for_every_body() -> None:
    from reasoned_explorer.simulation.vehicle import check_start
    from reasoned_explorer.vehicles.registry import VEHICLES, vehicle_profile

    split = make_split("s", [PLAZA], share=Share(), dealing=Dealing(2))
    atlas = open_place(PLAZA)
    for item in split.episodes:
        for name in VEHICLES.names():
            check_start(atlas, vehicle_profile(name), item.episode.start)


@pytest.mark.skipif(not SHARED.is_dir(), reason="no real places beside the checkout")
def test_a_real_place_is_cut_into_neighbourhoods() -> None:
    places = places_of_worlds([str(SHARED / "helsinki-centre.osm.pbf")])
    assert [place.name for place in places] == ["helsinki-centre#0", "helsinki-centre#1"]
    assert {place.city for place in places} == {"helsinki-centre"}
    for place in places:
        world = open_place(place).world
        assert world.bounds.width_m * world.bounds.height_m == pytest.approx(0.85e6, rel=0.1)


@pytest.mark.skipif(not SHARED.is_dir(), reason="no real places beside the checkout")
def test_a_neighbourhood_without_anything_deals_nothing() -> None:
    sea = Place("sea", str(SHARED / "monaco-2025.osm.pbf"), (7.4329, 43.7232, 7.4447, 43.7331), "monaco")
    assert Dealing(1).deal(sea, {(1, "near"): 1}).episodes == ()
    with pytest.raises(StartError, match="no episode can be posed in sea"):
        make_split("s", [sea], share=Share(), dealing=Dealing(1))


def test_what_cannot_be_made_is_refused() -> None:
    with pytest.raises(UnknownNameError, match="one of full, mini"):
        built_in_split("huge")
    with pytest.raises(SettingsError, match="each world once"):
        places_of_worlds(["park:1@200", "park:1@200"])
    with pytest.raises(WorldError):
        places_of_worlds(["nowhere.osm.pbf"])
    with pytest.raises(InputError, match="0 episodes a cell"):
        make_split("s", [PLAZA], share=Share(0), dealing=Dealing(1))


def test_two_maps_of_one_name_are_two_cities(tmp_path: Path) -> None:
    for folder, seed in (("x", 1), ("y", 2)):
        (tmp_path / folder).mkdir()
        save_world(generate_world("park", seed=seed, size_m=150), tmp_path / folder / "map.rexworld")
    places = places_of_worlds([str(tmp_path / folder / "map.rexworld") for folder in ("x", "y")])
    assert [place.name for place in places] == ["map", "map-2"]
    assert len({place.source for place in places}) == 2


def test_a_file_is_known_by_its_whole_path(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    save_world(generate_world("park", seed=1, size_m=150), tmp_path / "map.rexworld")
    monkeypatch.chdir(tmp_path)
    (place,) = places_of_worlds(["map.rexworld"])
    assert place.source == str(tmp_path / "map.rexworld")
    with pytest.raises(SettingsError, match="each world once"):
        places_of_worlds(["map.rexworld", "./map.rexworld"])
