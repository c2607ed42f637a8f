"""The map of a mission's world: the very world, and as much of it as the mission came near."""

import json
from dataclasses import replace
from pathlib import Path

from reasoned_explorer.evaluation.record_file import record_bytes
from reasoned_explorer.model.record import EpisodeRecord
from reasoned_explorer.task.split import Place
from reasoned_explorer.viewer.runs import MissionFiles
from reasoned_explorer.viewer.world_map import box_of, map_json, map_tag
from reasoned_explorer.viewer.worlds import Worlds
from reasoned_explorer.world.files import save_world
from reasoned_explorer.world.opening import open_world


def _files(record: EpisodeRecord, **places: object) -> MissionFiles:
    return MissionFiles("a", "A", record_bytes(record), **places)  # type: ignore[arg-type]


def test_what_stands_there_is_on_the_map(record: EpisodeRecord) -> None:
    atlas = Worlds().of(_files(record), record.header)
    assert atlas is not None
    world = atlas.world
    shown = json.loads(map_json(world, box_of(record, world)))
    low_x, low_y, high_x, high_y = shown["bounds"]
    assert low_x <= record.header.start[0] <= high_x
    assert low_y <= record.header.start[1] <= high_y
    assert len(shown["buildings"]) == len(world.buildings)  # of a small world all is near
    assert len(shown["ways"]) == len(world.ways)
    benches = [thing for thing in shown["objects"] if thing["class"] == "bench"]
    assert {thing["id"] for thing in benches} == {number for number, *_ in record.header.goal_objects}
    assert shown["trees"]
    assert all(len(tree) == 3 for tree in shown["trees"])
    for thing in benches:
        assert (thing["x"], thing["y"]) == (
            round(world.objects[thing["id"]].x_m, 2),
            round(world.objects[thing["id"]].y_m, 2),
        )


def test_what_is_far_away_is_left_out(record: EpisodeRecord) -> None:
    world = open_world("town:3@900")
    x_m, y_m = world.bounds.min_x_m + 20.0, world.bounds.min_y_m + 20.0
    header = replace(record.header, start=(x_m, y_m, 1.5, 0.0), reference_way=())
    box = box_of(replace(record, header=header, steps=()), world)
    assert box.width_m < 250.0
    shown = json.loads(map_json(world, box))
    assert 0 < len(shown["objects"]) + len(shown["trees"]) < len(world.objects) / 4
    assert 0 < len(shown["ways"]) < len(world.ways)
    assert map_tag("a", box) != map_tag("b", box)
    assert map_tag("a", box) != map_tag("a", world.bounds)


def test_another_world_by_the_same_name_is_not_shown(tmp_path: Path, record: EpisodeRecord) -> None:
    other = open_world("park:5@200")
    save_world(other, tmp_path / "world.rexworld")
    # Beside the record lies another world; the name still leads to the right one.
    assert Worlds().of(_files(record, world=tmp_path / "world.rexworld"), record.header) is not None
    changed = replace(record.header, world_digest="0" * 64)
    assert Worlds().of(_files(record, world=tmp_path / "world.rexworld"), changed) is None
    (tmp_path / "world.rexworld").write_bytes(b"broken")
    assert Worlds().of(_files(record, world=tmp_path / "world.rexworld"), changed) is None


def test_a_world_comes_from_where_the_benchmark_had_it(record: EpisodeRecord) -> None:
    renamed = replace(record.header, world="a name that generates nothing")
    assert Worlds().of(_files(record), renamed) is None
    assert Worlds().of(_files(record, place=Place("somewhere", "plaza:3@200")), renamed) is not None
    assert Worlds().of(_files(record, place=Place("somewhere", "gone.osm.pbf")), renamed) is None


def test_no_file_that_a_record_names_is_opened(tmp_path: Path, record: EpisodeRecord) -> None:
    """Whoever wrote the record may have named any file of this machine."""
    world = open_world("plaza:3@200")
    save_world(world, tmp_path / "secret.rexworld")
    named = replace(record.header, world=str(tmp_path / "secret.rexworld"))
    assert not Worlds().may_have(_files(record), named)
    assert Worlds().of(_files(record), named) is None


def test_a_mission_without_a_world_has_none(record: EpisodeRecord) -> None:
    afield = replace(record.header, world="none", world_digest="")
    assert not Worlds().may_have(_files(record), afield)
    assert Worlds().of(_files(record), afield) is None


def test_a_world_is_made_once(record: EpisodeRecord) -> None:
    worlds = Worlds()
    assert worlds.of(_files(record), record.header) is worlds.of(_files(record), record.header)
