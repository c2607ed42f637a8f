"""GeoJSON, read by others."""

import json
import math
from pathlib import Path

import pytest
from shapely.geometry import shape

from reasoned_explorer.viewer.exports.earth import NotOnEarthError
from reasoned_explorer.viewer.exports.geojson import geojson_bytes
from reasoned_explorer.viewer.exports.mission import ExportedMission, find_mission
from tests.viewer.exports.missions import CUT_OFF, NOWHERE, ORIGIN_DEG, RECORD


def _features(data: bytes) -> dict[str, list[dict[str, object]]]:
    found: dict[str, list[dict[str, object]]] = {}
    for feature in json.loads(data)["features"]:
        found.setdefault(feature["properties"]["what"], []).append(feature)
    return found


def _metres(lon_deg: float, lat_deg: float) -> tuple[float, float]:
    """East and north of the origin, by the radii of curvature of the WGS 84 ellipsoid; to centimetres nearby."""
    a_m, e2, lat_rad = 6_378_137.0, 6.694_379_990_14e-3, math.radians(ORIGIN_DEG[0])
    across_m = a_m / math.sqrt(1.0 - e2 * math.sin(lat_rad) ** 2)
    along_m = a_m * (1.0 - e2) / (1.0 - e2 * math.sin(lat_rad) ** 2) ** 1.5
    east_m = math.radians(lon_deg - ORIGIN_DEG[1]) * across_m * math.cos(lat_rad)
    return east_m, math.radians(lat_deg - ORIGIN_DEG[0]) * along_m


def test_everything_is_where_it_was_longitude_first() -> None:
    found = _features(geojson_bytes(ExportedMission(RECORD, "x")))
    assert {what: len(features) for what, features in found.items()} == {
        "reference way": 1,
        "track": 1,
        "path point": 2,
        "frontier": 2,
        "goal object": 1,
        "start": 1,
        "end": 1,
    }
    goal = shape(found["goal object"][0]["geometry"])
    assert _metres(goal.x, goal.y) == pytest.approx((30.0, 40.0), abs=0.01)
    track = shape(found["track"][0]["geometry"])
    for place, metres in zip(track.coords, [(0, 0), (0, 0), (0, 5), (0, 10), (3, 12)], strict=True):
        assert _metres(*place) == pytest.approx(metres, abs=0.01)
    assert all(shape(feature["geometry"]).is_valid for features in found.values() for feature in features)


def test_properties_are_plain_and_say_what_a_map_needs() -> None:
    data = geojson_bytes(ExportedMission(RECORD, "x"))
    found = _features(data)
    assert [each["properties"] for each in found["frontier"]] == [
        {"what": "frontier", "number": 0, "q": 3.25, "state": "visited", "forbidden": False, "reason": ""},
        {"what": "frontier", "number": 1, "q": None, "state": "open", "forbidden": True, "reason": ""},
    ]
    track = found["track"][0]["properties"]
    assert isinstance(track, dict)
    assert track["times_s"] == [0.0, 8.0, 12.0, 15.0, 20.0]
    mission = json.loads(data)["mission"]
    assert mission["goal"] == RECORD.header.goal
    assert "OpenStreetMap" in mission["data"]
    assert "simulated" in mission["time"]
    # RFC 7946, section 4: the frame is WGS 84 and is not named.
    assert "crs" not in json.loads(data)


def test_a_mission_that_was_cut_off_is_shown_as_far_as_it_went() -> None:
    found = _features(geojson_bytes(ExportedMission(CUT_OFF, "x")))
    assert len(found["path point"]) == 1
    assert shape(found["track"][0]["geometry"]).length > 0.0


def test_the_same_mission_gives_the_same_bytes() -> None:
    assert geojson_bytes(ExportedMission(RECORD, "x")) == geojson_bytes(ExportedMission(RECORD, "x"))


def test_places_that_are_not_on_earth_are_refused(run_mission: Path) -> None:
    with pytest.raises(NotOnEarthError, match=r"'plaza:3@200' is not a place on earth.*\.rrd or \.mcap"):
        geojson_bytes(find_mission(run_mission))
    with pytest.raises(NotOnEarthError, match="no place on earth is known"):
        geojson_bytes(ExportedMission(NOWHERE, "x"))
