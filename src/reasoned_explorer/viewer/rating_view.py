"""What a rater is shown of a mission, and what not.

Shown: the goal sentence; the way that was gone, on a map of ground, buildings and trees; where it ended; and what the
vehicle's camera sees from there, all round, so that nobody is bound to the directions in which it happened to look.

Not shown, since each would tell the rater what to say, or whose mission it is:

- the method, its minds, its settings, how long it thought and drove, how often it looked, where its path points lay;
- frontiers, scores, imagined scenes, and captions: they are the words of one method's parts, right or wrong;
- what the judge says, the objects that it accepts, its radius, its shortest way, and the objects and names on the map:
  people would repeat the judge's rule with the judge's data instead of looking;
- whether the robot said that it had found something, and how the mission ended: a claim is readily believed. It need
  not be asked of people; the report counts a success where it said so in time *and* people say yes.

Only where no picture can be had, captions of the last look are shown instead, marked as the words of a captioner.
"""

import math
from dataclasses import dataclass
from typing import Any

from pydantic_core import from_json
from shapely import LineString

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Camera
from reasoned_explorer.model.record import EpisodeRecord
from reasoned_explorer.viewer.world_map import MARGIN_M, map_json
from reasoned_explorer.world.world import Bounds, World

#: The way is drawn with points that are left out where it stays within this of it, metres: their pace tells of methods.
_THINNED_M = 0.3
#: Pictures all round overlap by this share of their width.
_OVERLAP = 0.1


@dataclass(frozen=True, slots=True)
class Outlook:
    """One of the pictures all round the place where a mission ended.

    Attributes:
        pose: Of the camera.
        label: Where it looks, e.g. ``"ahead"`` or ``"72° right"``, seen from the heading that it ended with.
    """

    pose: Pose
    label: str


def way_of(record: EpisodeRecord) -> list[tuple[float, float]]:
    """Return the way that was gone, metres, from the start to the end, without what tells of its pace."""
    places = [record.header.start[:2]]
    places += [(point.x_m, point.y_m) for step in record.steps for leg in step.legs for point in leg.track]
    kept = [place for at, place in enumerate(places) if at == 0 or place != places[at - 1]]
    if len(kept) > 2:
        kept = list(LineString(kept).simplify(_THINNED_M, preserve_topology=False).coords)
    return [(round(x_m, 1), round(y_m, 1)) for x_m, y_m in kept]


def end_of(record: EpisodeRecord) -> Pose:
    """Return where the vehicle really stood when the mission ended."""
    for step in reversed(record.steps):
        for leg in reversed(step.legs):
            if leg.track:
                last = leg.track[-1]
                return Pose(last.x_m, last.y_m, last.z_m, last.heading_rad)
    return Pose(*record.header.start)


def outlooks(record: EpisodeRecord, camera: Camera) -> list[Outlook]:
    """Return from where pictures show all that is round the end: from behind on the left to behind on the right."""
    end = end_of(record)
    count = max(3, math.ceil(math.tau / (camera.horizontal_fov_rad * (1.0 - _OVERLAP)) - 1e-9))
    found = []
    for place in range(count):
        turn_rad = (place - (count - 1) // 2) * math.tau / count
        heading_rad = math.remainder(end.heading_rad + turn_rad, math.tau)
        found.append(Outlook(Pose(end.x_m, end.y_m, end.z_m, heading_rad), _label(turn_rad)))
    return found


def last_captions(record: EpisodeRecord) -> list[str]:
    """Return what the captioner said of the last look; nothing where it was never asked."""
    for step in reversed(record.steps):
        if step.views:
            look = step.views[-1].key[:2]
            return [view.caption for view in step.views if view.key[:2] == look and view.caption]
    return []


def blind_view(record: EpisodeRecord) -> dict[str, Any]:
    """Return what may be known of a mission by who rates it, as the page reads it."""
    end = end_of(record)
    return {
        "goal": record.header.goal,
        "way": way_of(record),
        "end": {"x": round(end.x_m, 1), "y": round(end.y_m, 1), "heading_rad": round(end.heading_rad, 3)},
        "attribution": record.header.attribution,
    }


def blind_map(record: EpisodeRecord, world: World) -> dict[str, Any]:
    """Return the map round the way that was gone, without names and without objects other than trees."""
    shown: dict[str, Any] = from_json(map_json(world, _box(record, world.bounds)))
    for building in shown["buildings"]:
        building["name"] = ""
    return {**shown, "objects": []}


def _box(record: EpisodeRecord, bounds: Bounds) -> Bounds:
    """Return what is near the way; not, as a replay's map, near the judge's way and frontiers, too."""
    x_m, y_m = zip(*way_of(record), strict=True)
    return Bounds(
        max(bounds.min_x_m, min(x_m) - MARGIN_M),
        max(bounds.min_y_m, min(y_m) - MARGIN_M),
        min(bounds.max_x_m, max(x_m) + MARGIN_M),
        min(bounds.max_y_m, max(y_m) + MARGIN_M),
    )


def _label(turn_rad: float) -> str:
    turn_deg = round(math.degrees(math.remainder(turn_rad, math.tau)))
    if abs(turn_deg) == 180:
        return "behind"
    return f"{abs(turn_deg)}° {'right' if turn_deg > 0 else 'left'}" if turn_deg else "ahead"
