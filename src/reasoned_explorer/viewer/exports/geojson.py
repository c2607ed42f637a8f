"""GeoJSON (RFC 7946): what happened on a map of the earth, for QGIS, geojson.io, Leaflet and whatever reads JSON."""

import json
from collections.abc import Iterator, Sequence
from typing import Any

from reasoned_explorer.viewer.exports.earth import Earth
from reasoned_explorer.viewer.exports.mission import ExportedMission
from reasoned_explorer.viewer.exports.moments import last_frontiers, path_points, poses
from reasoned_explorer.viewer.exports.told import about

Feature = dict[str, Any]


def geojson_bytes(mission: ExportedMission) -> bytes:
    """Return a mission as a collection of features; each says in its property ``what`` what it is.

    ``start``, ``end``, ``track``, ``path point``, ``frontier``, ``goal object`` and ``reference way``. Heights are
    above the ground and not above the ellipsoid that the format means: they stand among the properties.

    Raises:
        NotOnEarthError: If the place is not on earth.
    """
    earth = Earth(mission, ".geojson")
    collection = {"type": "FeatureCollection", "mission": about(mission), "features": list(_features(mission, earth))}
    return (json.dumps(collection, ensure_ascii=False, allow_nan=False, indent=1) + "\n").encode()


def _features(mission: ExportedMission, earth: Earth) -> Iterator[Feature]:
    record = mission.record
    header, track = record.header, poses(record)
    if len(header.reference_way) > 1:
        length_m = header.reference_length_m
        yield _line(earth, header.reference_way, what="reference way", length_m=length_m)
    if len(track) > 1:
        yield _line(
            earth,
            [(point.x_m, point.y_m) for point in track],
            what="track",
            times_s=[round(point.t_s, 3) for point in track],
            heights_m=[round(point.z_m, 3) for point in track],
        )
    for t_s, number, (x_m, y_m, z_m) in path_points(record):
        yield _point(earth, x_m, y_m, what="path point", number=number, time_s=round(t_s, 3), height_m=z_m)
    for each in last_frontiers(record):
        yield _point(
            earth,
            each.x_m,
            each.y_m,
            what="frontier",
            number=each.id,
            q=each.q,
            state=each.state,
            forbidden=each.forbidden,
            reason=each.reason,
        )
    for number, class_name, x_m, y_m, grade in header.goal_objects:
        yield _point(earth, x_m, y_m, what="goal object", number=number, object_class=class_name, grade=grade)
    for what, point in (("start", track[0]), ("end", track[-1])):
        yield _point(earth, point.x_m, point.y_m, what=what, time_s=round(point.t_s, 3), height_m=round(point.z_m, 3))


def _line(earth: Earth, points: Sequence[tuple[float, float]], **properties: object) -> Feature:
    places = [earth.lon_lat_deg(x_m, y_m) for x_m, y_m in points]
    return {"type": "Feature", "geometry": {"type": "LineString", "coordinates": places}, "properties": properties}


def _point(earth: Earth, x_m: float, y_m: float, **properties: object) -> Feature:
    place = earth.lon_lat_deg(x_m, y_m)
    return {"type": "Feature", "geometry": {"type": "Point", "coordinates": place}, "properties": properties}
