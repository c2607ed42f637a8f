"""MCAP, read by the reader of its makers and by the schemas that the file itself brings."""

import sys
from io import BytesIO
from pathlib import Path
from typing import Any

import pytest

from reasoned_explorer.model import MissingDependencyError
from reasoned_explorer.viewer.exports.foxglove_log import mcap_bytes
from reasoned_explorer.viewer.exports.mission import ExportedMission, find_mission
from tests.viewer.exports.missions import CUT_OFF, NOWHERE, ORIGIN_DEG, RECORD, png

pytest.importorskip("foxglove")
reading = pytest.importorskip("mcap.reader")
decoding = pytest.importorskip("mcap_protobuf.decoder")
from mcap.decoder import DecoderFactory as AnyDecoderFactory  # noqa: E402


class _Json(AnyDecoderFactory):  # type: ignore[misc]
    def decoder_for(self, message_encoding: str, schema: Any) -> Any:
        import json

        return json.loads if message_encoding == "json" else None


def _read(data: bytes) -> Any:
    return reading.make_reader(
        BytesIO(data), validate_crcs=True, decoder_factories=[decoding.DecoderFactory(), _Json()]
    )


def _messages(data: bytes) -> dict[str, list[tuple[float, Any]]]:
    found: dict[str, list[tuple[float, Any]]] = {}
    for _, channel, message, decoded in _read(data).iter_decoded_messages(log_time_order=False):
        found.setdefault(channel.topic, []).append((message.log_time / 1e9, decoded))
    return found


def test_topics_have_foxgloves_own_schemas() -> None:
    summary = _read(mcap_bytes(ExportedMission(RECORD, "x"))).get_summary()
    names = {channel.topic: summary.schemas[channel.schema_id].name for channel in summary.channels.values()}
    assert {topic: name for topic, name in names.items() if name.startswith("foxglove.")} == {
        "/tf": "foxglove.FrameTransform",
        "/fix": "foxglove.LocationFix",
        "/mission": "foxglove.SceneUpdate",
        "/log": "foxglove.Log",
    }
    assert {"/figures", "/imagined"} <= set(names)


def test_the_vehicle_is_where_it_was_and_looks_where_it_looked() -> None:
    found = _messages(mcap_bytes(ExportedMission(RECORD, "x")))
    assert [t_s for t_s, _ in found["/tf"]] == [0.0, 8.0, 12.0, 15.0, 20.0]
    _, last = found["/tf"][-1]
    assert (last.parent_frame_id, last.child_frame_id, last.timestamp.seconds) == ("world", "vehicle", 20)
    assert (last.translation.x, last.translation.y, last.translation.z) == (3.0, 12.0, 1.5)
    # Heading north, x of the vehicle points along y of the world: a quarter turn.
    assert (last.rotation.z, last.rotation.w) == pytest.approx((0.5**0.5, 0.5**0.5))
    _, fix = found["/fix"][0]
    assert (fix.latitude, fix.longitude) == pytest.approx(ORIGIN_DEG)


def test_frontiers_have_colours_and_labels_and_choices_go_again() -> None:
    found = _messages(mcap_bytes(ExportedMission(RECORD, "x")))["/mission"]
    frontiers = [(t_s, each) for t_s, update in found for each in update.entities if each.id == "frontiers"]
    assert [t_s for t_s, _ in frontiers] == [8.0, 20.0]
    assert [text.text for text in frontiers[-1][1].texts] == ["0: Q 3.25, visited", "1: no score"]
    colours = [(ball.color.r, ball.color.g, ball.color.b) for ball in frontiers[-1][1].spheres]
    assert colours[0] != colours[1]
    assert [t_s for t_s, update in found for each in update.entities if each.id == "choice"] == [8.0]
    assert [(t_s, each.id) for t_s, update in found for each in update.deletions] == [(20.0, "choice")]
    ways = {each.id: each for _, update in found for each in update.entities if each.lines}
    assert [(point.x, point.y) for point in ways["track/0000-1"].lines[0].points] == [(0.0, 10.0), (3.0, 12.0)]
    assert "reference way" in ways


def test_words_figures_and_what_was_imagined_stand_at_their_times() -> None:
    found = _messages(mcap_bytes(ExportedMission(RECORD, "x")))
    said = {line.name: (t_s, line) for t_s, line in found["/log"]}
    assert {"caption", "checker", "choice", "leg", "guard", "note", "end"} == set(said)
    assert said["leg"][1].level == 3
    assert found["/figures"][-1] == (30.0, {"ct_s": 18.0, "tt_s": 12.0})
    assert "A bench under trees." in found["/imagined"][0][1]["tree"]


def test_pictures_that_were_kept_are_there(by_hand: Path) -> None:
    found = _messages(mcap_bytes(find_mission(by_hand)))
    assert [(t_s, image.format, image.data) for t_s, image in found["/views/0"]] == [(1.0, "png", png("red"))]
    assert found["/views/1"][0][1].data == png("green")


def test_a_generated_place_brings_its_ground(run_mission: Path) -> None:
    found = _messages(mcap_bytes(find_mission(run_mission)))
    ((t_s, world),) = found["/world"]
    entities = {each.id: each for each in world.entities}
    assert t_s == 0.0
    assert entities["ground/plaza"].triangles[0].indices
    assert entities["things/furniture"].cubes
    assert "bench" in {text.text for text in entities["labels/furniture"].texts}
    assert "/fix" not in found


def test_the_file_says_what_it_is_and_what_its_times_mean() -> None:
    (metadata,) = _read(mcap_bytes(ExportedMission(RECORD, "x"))).iter_metadata()
    assert metadata.name == "mission"
    assert metadata.metadata["goal"] == RECORD.header.goal
    assert "knows no date" in metadata.metadata["epoch"]
    assert "simulated seconds" in metadata.metadata["time"]
    assert "could not be found" in metadata.metadata["ground"]


@pytest.mark.parametrize("record", [CUT_OFF, NOWHERE], ids=["cut off", "world none"])
def test_missions_without_an_end_or_a_world_are_written(record: Any) -> None:
    found = _messages(mcap_bytes(ExportedMission(record, "x")))
    assert found["/tf"]
    assert "/world" not in found


def test_the_same_mission_gives_the_same_bytes(by_hand: Path) -> None:
    assert mcap_bytes(find_mission(by_hand)) == mcap_bytes(find_mission(by_hand))


def test_a_missing_library_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "foxglove", None)
    with pytest.raises(MissingDependencyError, match=r"pip install 'reasoned-explorer\[mcap\]'"):
        mcap_bytes(ExportedMission(RECORD, "x"))
