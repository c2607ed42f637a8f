"""GPX, read by others."""

import sys
from dataclasses import replace
from datetime import UTC, datetime
from xml.etree import ElementTree as ET

import pytest

from reasoned_explorer.model import MissingDependencyError
from reasoned_explorer.viewer.exports.earth import NotOnEarthError
from reasoned_explorer.viewer.exports.gpx import gpx_bytes
from reasoned_explorer.viewer.exports.mission import ExportedMission
from tests.viewer.exports.missions import CUT_OFF, HEADER, NOWHERE, ORIGIN_DEG, RECORD

gpxpy = pytest.importorskip("gpxpy")
_NS = "{http://www.topografix.com/GPX/1/1}"
#: The order of elements that the schema of GPX 1.1 asks for, of those that are written here.
_ORDER = {
    "gpx": ["metadata", "wpt", "rte", "trk"],
    "metadata": ["name", "desc", "copyright", "time"],
    "wpt": ["time", "name", "type"],
    "rte": ["name", "rtept"],
    "rtept": [],
    "trk": ["name", "trkseg"],
    "trkseg": ["trkpt"],
    "trkpt": ["time"],
}


def test_the_track_has_its_times_and_places() -> None:
    read = gpxpy.parse(gpx_bytes(ExportedMission(RECORD, "x")).decode())
    (track,) = read.tracks
    (segment,) = track.segments
    assert [(point.time - datetime(1970, 1, 1, tzinfo=UTC)).total_seconds() for point in segment.points] == [
        0.0,
        8.0,
        12.0,
        15.0,
        20.0,
    ]
    assert (segment.points[0].latitude, segment.points[0].longitude) == pytest.approx(ORIGIN_DEG, abs=1e-7)
    # gpxpy's own measure of it, on a sphere: ten metres, and from there three and two.
    assert segment.length_2d() == pytest.approx(10.0 + 13.0**0.5, rel=0.01)
    assert all(point.elevation is None for point in segment.points)


def test_waypoints_and_the_reference_way_are_there_with_words_as_they_were() -> None:
    read = gpxpy.parse(gpx_bytes(ExportedMission(RECORD, "x")).decode())
    assert [each.name for each in read.waypoints] == ["start", "path point 0", "path point 1", "goal: bench", "end"]
    assert len(read.routes[0].points) == 2
    assert read.name == RECORD.header.goal
    assert "counted from 1970-01-01" in read.description
    assert "OpenStreetMap" in read.copyright_author


def test_elements_stand_in_the_order_of_the_schema() -> None:
    data = gpx_bytes(ExportedMission(RECORD, "x"))
    root = ET.fromstring(data)  # noqa: S314 - our own
    assert (root.tag, root.get("version"), root.get("creator")) == (f"{_NS}gpx", "1.1", "reasoned-explorer")
    for element in root.iter():
        name = element.tag.removeprefix(_NS)
        if name in _ORDER:
            places = [_ORDER[name].index(child.tag.removeprefix(_NS)) for child in element]
            assert places == sorted(places), name
    assert all(-90.0 <= float(point.get("lat", "nan")) <= 90.0 for point in root.iter(f"{_NS}trkpt"))


def test_what_xml_cannot_hold_does_not_break_the_file() -> None:
    record = replace(RECORD, header=replace(HEADER, goal="Find \x00 me ]]> a \x1b[1m bench \ufffe"))
    read = gpxpy.parse(gpx_bytes(ExportedMission(record, "x")).decode())
    assert read.name == "Find \ufffd me ]]> a \ufffd[1m bench \ufffd"


def test_the_same_mission_gives_the_same_bytes_and_a_cut_off_one_a_shorter_track() -> None:
    whole = gpx_bytes(ExportedMission(RECORD, "x"))
    assert whole == gpx_bytes(ExportedMission(RECORD, "x"))
    assert len(gpxpy.parse(gpx_bytes(ExportedMission(CUT_OFF, "x")).decode()).waypoints) == 4


def test_a_place_that_is_not_on_earth_is_refused_and_a_missing_library_named(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(NotOnEarthError):
        gpx_bytes(ExportedMission(NOWHERE, "x"))
    monkeypatch.setitem(sys.modules, "gpxpy", None)
    with pytest.raises(MissingDependencyError, match=r"pip install 'reasoned-explorer\[gpx\]'"):
        gpx_bytes(ExportedMission(RECORD, "x"))
