"""GPX 1.1: the track of a mission, for whatever shows tracks of receivers."""

import re
from datetime import UTC, datetime, timedelta

from reasoned_explorer.model import MissingDependencyError
from reasoned_explorer.viewer.exports.earth import Earth
from reasoned_explorer.viewer.exports.mission import ExportedMission
from reasoned_explorer.viewer.exports.moments import path_points, poses
from reasoned_explorer.viewer.exports.told import about

#: When missions begin in files that must have a date: their records know none, so that they are the same every day.
EPOCH = datetime(1970, 1, 1, tzinfo=UTC)
#: What XML 1.0 has no way to write.
_NOT_IN_XML = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def gpx_bytes(mission: ExportedMission) -> bytes:
    """Return a mission as a track with times, with a route (the reference way) and waypoints.

    Heights are left out: they are above the ground, and the format means those above the sea.

    Raises:
        NotOnEarthError: If the place is not on earth.
        MissingDependencyError: Without gpxpy.
    """
    earth = Earth(mission, ".gpx")
    try:
        from gpxpy import gpx
    except ImportError as error:
        raise MissingDependencyError("export to GPX", "gpxpy", "pip install 'reasoned-explorer[gpx]'") from error
    record = mission.record
    header, track = record.header, poses(record)
    document = gpx.GPX()
    document.creator = "reasoned-explorer"
    document.name = _plain(header.goal)
    document.description = _described(about(mission))
    document.time = EPOCH
    if header.attribution:
        document.copyright_author = _plain(header.attribution)

    def waypoint(x_m: float, y_m: float, name: str, kind: str, t_s: float | None = None) -> None:
        lon_deg, lat_deg = earth.lon_lat_deg(x_m, y_m)
        document.waypoints.append(gpx.GPXWaypoint(lat_deg, lon_deg, time=_time(t_s), name=_plain(name), type=kind))

    waypoint(track[0].x_m, track[0].y_m, "start", "start", track[0].t_s)
    for t_s, number, (x_m, y_m, _) in path_points(record):
        waypoint(x_m, y_m, f"path point {number}", "path point", t_s)
    for _, class_name, x_m, y_m, grade in header.goal_objects:
        noun = class_name.replace("_", " ")
        waypoint(x_m, y_m, f"goal: {noun}" + ("" if grade > 1 else " (would do)"), "goal object")
    waypoint(track[-1].x_m, track[-1].y_m, "end", "end", track[-1].t_s)
    if header.reference_way:
        route = gpx.GPXRoute(name="reference way")
        for x_m, y_m in header.reference_way:
            lon_deg, lat_deg = earth.lon_lat_deg(x_m, y_m)
            route.points.append(gpx.GPXRoutePoint(lat_deg, lon_deg))
        document.routes.append(route)
    segment = gpx.GPXTrackSegment()
    for point in track:
        lon_deg, lat_deg = earth.lon_lat_deg(point.x_m, point.y_m)
        segment.points.append(gpx.GPXTrackPoint(lat_deg, lon_deg, time=_time(point.t_s)))
    way = gpx.GPXTrack(name=_plain(header.goal))
    way.segments.append(segment)
    document.tracks.append(way)
    return str(document.to_xml(version="1.1")).encode()


def _time(t_s: float | None) -> datetime | None:
    return None if t_s is None else EPOCH + timedelta(milliseconds=round(t_s * 1000.0))


def _described(facts: dict[str, str]) -> str:
    dated = f"times are mission time, counted from {EPOCH:%Y-%m-%d}: the mission knows no date"
    return _plain("\n".join([*(f"{name}: {text}" for name, text in facts.items()), dated]))


def _plain(text: str) -> str:
    return _NOT_IN_XML.sub("\ufffd", text)
