"""MCAP files with Foxglove's own schemas: a mission for the Foxglove app, and for whatever reads MCAP.

Topics: ``/tf`` (``world`` → ``vehicle``), ``/world`` and ``/mission`` (scenes), ``/fix`` (real places), ``/views/N``,
``/log``, ``/imagined`` and ``/figures``. Times are nanoseconds since the mission began, as if that had been 1970.
"""

import io
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from types import ModuleType
from typing import TYPE_CHECKING, Any

from reasoned_explorer.evaluation.mission_marks import score_colour
from reasoned_explorer.geometry import GeoOrigin
from reasoned_explorer.model import MissingDependencyError
from reasoned_explorer.viewer.exports.mission import ExportedMission
from reasoned_explorer.viewer.exports.moments import (
    choice_moments,
    decided_s,
    figures,
    frontier_moments,
    looks,
    path_points,
    poses,
)
from reasoned_explorer.viewer.exports.scenery import Scenery, scenery_of
from reasoned_explorer.viewer.exports.told import about, frontier_label, lines, tree_of

if TYPE_CHECKING:
    import foxglove

WORLD_FRAME, VEHICLE_FRAME = "world", "vehicle"
_TRACK, _CHOICE, _REFERENCE, _GOAL = "#22272e", "#c42f1a", "#0b757d", "#c42f1a"
_Place = tuple[float, float, float]
_FIGURES = {
    "type": "object",
    "properties": {
        "ct_s": {"type": "number", "description": "seconds of waiting for decisions since the mission began"},
        "tt_s": {"type": "number", "description": "seconds of travelling and looking since the mission began"},
    },
}
_IMAGINED = {
    "type": "object",
    "properties": {"step": {"type": "integer"}, "tree": {"type": "string", "description": "what was imagined"}},
}


def mcap_bytes(mission: ExportedMission) -> bytes:
    """Return a mission as an MCAP file; the same mission gives the same bytes.

    Raises:
        MissingDependencyError: Without foxglove-sdk.
    """
    try:
        import foxglove
        from foxglove import channels, mcap, messages
    except ImportError as error:
        command = "pip install 'reasoned-explorer[mcap]'"
        raise MissingDependencyError("export to MCAP", "foxglove-sdk", command) from error
    file = io.BytesIO()
    context = foxglove.Context()
    # In one thread: what compresses in parallel may cut its blocks anywhere.
    options = mcap.MCAPWriteOptions(compression_threads=0)
    with foxglove.open_mcap(file, context=context, writer_options=options) as writer:
        facts = {**about(mission), "epoch": "the mission began at 0 ns; it knows no date"}
        writer.write_metadata("mission", dict(sorted(facts.items())))
        _Log(foxglove, channels, messages, context, mission).write()
    return file.getvalue()


@dataclass(frozen=True, slots=True)
class _Mark:
    """A ball with a label above it."""

    place: _Place
    label: str
    colour: str
    size_m: float


class _Log:
    """A mission that is being written; messages of all topics, in the order of time."""

    def __init__(
        self,
        fox: ModuleType,
        channels: ModuleType,
        messages: ModuleType,
        context: "foxglove.Context",
        mission: ExportedMission,
    ) -> None:
        self._fox, self._channels, self._msg, self._context = fox, channels, messages, context
        self._mission, self._record = mission, mission.record
        self._queue: list[tuple[int, Callable[[], None]]] = []
        self._open: dict[str, Any] = {}

    def write(self) -> None:
        """Write all messages."""
        self._scenes()
        self._vehicle()
        self._agent()
        self._views()
        self._words()
        for _, send in sorted(self._queue, key=lambda entry: entry[0]):
            send()

    def _put(self, t_s: float, topic: str, message: Any, *, schema: dict[str, Any] | None = None) -> None:
        time_ns = round(t_s * 1e9)
        channel = self._channel(topic, message, schema)
        self._queue.append((time_ns, lambda: channel.log(message, log_time=time_ns)))

    def _channel(self, topic: str, message: Any, schema: dict[str, Any] | None) -> Any:
        if topic not in self._open:
            if schema is not None:
                made = self._fox.Channel(topic, schema=schema, context=self._context)
            else:
                made = getattr(self._channels, f"{type(message).__name__}Channel")(topic, context=self._context)
            self._open[topic] = made
        return self._open[topic]

    def _scenes(self) -> None:
        msg = self._msg
        scenery = scenery_of(self._mission)
        if scenery.meshes or scenery.things:
            self._put(0.0, "/world", msg.SceneUpdate(entities=self._scenery(scenery)))
        header = self._record.header
        entities = []
        if header.goal_objects:
            places = [(x_m, y_m, 1.0) for _, _, x_m, y_m, _ in header.goal_objects]
            names = [f"goal: {name.replace('_', ' ')}" for _, name, *_ in header.goal_objects]
            entities.append(
                self._marks(0.0, "goal objects", [_Mark(*each, _GOAL, 1.2) for each in zip(places, names, strict=True)])
            )
        if len(header.reference_way) > 1:
            way = [(x_m, y_m, 0.1) for x_m, y_m in header.reference_way]
            entities.append(self._line(0.0, "reference way", way, _REFERENCE, 0.3))
        if entities:
            self._put(0.0, "/mission", msg.SceneUpdate(entities=entities))

    def _scenery(self, scenery: Scenery) -> list[Any]:
        msg = self._msg
        made = [
            self._entity(
                0.0,
                mesh.name,
                triangles=[
                    msg.TriangleListPrimitive(
                        pose=self._pose((0.0, 0.0, 0.0)),
                        points=[msg.Point3(x=x, y=y, z=z) for x, y, z in mesh.vertices.tolist()],
                        indices=mesh.triangles.ravel().tolist(),
                        color=self._colour(mesh.colour),
                    )
                ],
            )
            for mesh in scenery.meshes
        ]
        for kind in sorted({thing.kind for thing in scenery.things}):
            things = [thing for thing in scenery.things if thing.kind == kind]
            made.append(
                self._entity(
                    0.0,
                    f"things/{kind}",
                    cubes=[
                        msg.CubePrimitive(
                            pose=self._pose(thing.centre, thing.yaw_rad),
                            size=msg.Vector3(x=thing.size[0], y=thing.size[1], z=thing.size[2]),
                            color=self._colour(thing.colour),
                        )
                        for thing in things
                    ],
                )
            )
            texts = [self._text(thing.label, (*thing.centre[:2], thing.size[2] + 0.5), size_m=0.5) for thing in things]
            made.append(self._entity(0.0, f"labels/{kind}", texts=texts))
        if scenery.names:
            made.append(self._entity(0.0, "names", texts=[self._text(*name, size_m=2.0) for name in scenery.names]))
        return made

    def _vehicle(self) -> None:
        msg, origin_deg = self._msg, self._record.header.origin_deg
        origin = None if origin_deg is None else GeoOrigin(*origin_deg)
        for pose in poses(self._record):
            transform = msg.FrameTransform(
                timestamp=self._time(pose.t_s),
                parent_frame_id=WORLD_FRAME,
                child_frame_id=VEHICLE_FRAME,
                translation=msg.Vector3(x=pose.x_m, y=pose.y_m, z=pose.z_m),
                rotation=self._turned(math.pi / 2.0 - pose.heading_rad),
            )
            self._put(pose.t_s, "/tf", transform)
            if origin is not None:
                lat_deg, lon_deg = origin.geodetic_from_enu_deg(pose.x_m, pose.y_m)
                fix = msg.LocationFix(
                    timestamp=self._time(pose.t_s), frame_id=VEHICLE_FRAME, latitude=lat_deg, longitude=lon_deg
                )
                self._put(pose.t_s, "/fix", fix)
        for step in self._record.steps:
            for number, leg in enumerate(step.legs):
                way = [(point.x_m, point.y_m, point.z_m) for point in leg.track]
                for count, point in enumerate(leg.track[1:], start=2):
                    name = f"track/{step.step:04d}-{number}"
                    self._scene(point.t_s, self._line(point.t_s, name, way[:count], _TRACK, 0.25))

    def _agent(self) -> None:
        for t_s, number, place in path_points(self._record):
            name = f"path point {number:04d}"
            self._scene(t_s, self._marks(t_s, name, [_Mark(place, f"{number}", _TRACK, 0.8)]))
        for moment in frontier_moments(self._record):
            marks = [
                _Mark(
                    (each.x_m, each.y_m, 0.5),
                    frontier_label(each),
                    score_colour(each.q),
                    1.8 if each.state == "open" else 0.7,
                )
                for each in moment.frontiers
            ]
            self._scene(moment.t_s, self._marks(moment.t_s, "frontiers", marks))
        for chosen in choice_moments(self._record):
            way = [(*chosen.here, 0.3), (*chosen.there, 0.3)]
            self._scene(chosen.t_s, self._line(chosen.t_s, "choice", way, _CHOICE, 0.2))
            if chosen.until_s > chosen.t_s:
                gone = self._msg.SceneEntityDeletion(timestamp=self._time(chosen.until_s), id="choice")
                self._put(chosen.until_s, "/mission", self._msg.SceneUpdate(deletions=[gone]))

    def _views(self) -> None:
        for step in self._record.steps:
            for look in looks(step):
                for view in look.views:
                    picture = self._mission.picture(view)
                    if picture is not None:
                        image = self._msg.CompressedImage(
                            timestamp=self._time(look.seen_s), frame_id=VEHICLE_FRAME, data=picture, format="png"
                        )
                        self._put(look.seen_s, f"/views/{view.key[-1]}", image)

    def _words(self) -> None:
        level = self._msg.LogLevel
        for line in lines(self._record):
            said = self._msg.Log(
                timestamp=self._time(line.t_s),
                level=level.Warning if line.warns else level.Info,
                message=line.text,
                name=line.topic,
            )
            self._put(line.t_s, "/log", said)
        for step in self._record.steps:
            if step.views:
                tree = {"step": step.step, "tree": tree_of(step)}
                self._put(decided_s(step), "/imagined", tree, schema=_IMAGINED)
        for figure in figures(self._record):
            self._put(figure.t_s, "/figures", {"ct_s": figure.ct_s, "tt_s": figure.tt_s}, schema=_FIGURES)

    def _scene(self, t_s: float, entity: Any) -> None:
        self._put(t_s, "/mission", self._msg.SceneUpdate(entities=[entity]))

    def _line(self, t_s: float, name: str, way: Sequence[_Place], colour: str, width_m: float) -> Any:
        msg = self._msg
        line = msg.LinePrimitive(
            pose=self._pose((0.0, 0.0, 0.0)),
            thickness=width_m,
            points=[msg.Point3(x=x, y=y, z=z) for x, y, z in way],
            color=self._colour(colour),
        )
        return self._entity(t_s, name, lines=[line])

    def _marks(self, t_s: float, name: str, marks: Sequence[_Mark]) -> Any:
        vector = self._msg.Vector3
        balls = [
            self._msg.SpherePrimitive(
                pose=self._pose(mark.place),
                size=vector(x=mark.size_m, y=mark.size_m, z=mark.size_m),
                color=self._colour(mark.colour),
            )
            for mark in marks
        ]
        texts = [self._text(mark.label, (*mark.place[:2], mark.place[2] + mark.size_m), size_m=0.8) for mark in marks]
        return self._entity(t_s, name, spheres=balls, texts=texts)

    def _entity(self, t_s: float, name: str, **what: Any) -> Any:
        return self._msg.SceneEntity(timestamp=self._time(t_s), frame_id=WORLD_FRAME, id=name, **what)

    def _text(self, text: str, place: _Place, *, size_m: float) -> Any:
        return self._msg.TextPrimitive(
            pose=self._pose(place), billboard=True, font_size=size_m, color=self._colour(_TRACK), text=text
        )

    def _pose(self, place: _Place, yaw_rad: float = 0.0) -> Any:
        x, y, z = place
        return self._msg.Pose(position=self._msg.Vector3(x=x, y=y, z=z), orientation=self._turned(yaw_rad))

    def _turned(self, yaw_rad: float) -> Any:
        return self._msg.Quaternion(x=0.0, y=0.0, z=math.sin(yaw_rad / 2.0), w=math.cos(yaw_rad / 2.0))

    def _colour(self, colour: str) -> Any:
        red, green, blue = (int(colour[place : place + 2], 16) / 255.0 for place in (1, 3, 5))
        return self._msg.Color(r=red, g=green, b=blue, a=1.0)

    def _time(self, t_s: float) -> Any:
        seconds, nanoseconds = divmod(round(t_s * 1e9), 1_000_000_000)
        return self._msg.Timestamp(seconds, nanoseconds)
