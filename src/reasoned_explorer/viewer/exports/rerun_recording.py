"""Rerun's recordings (.rrd): a mission in space and time, for the Rerun viewer.

Entities: ``world/…`` (ground, buildings, things), ``judge/…`` (goal objects, reference way), ``agent/…`` (path points,
frontiers, choice), ``vehicle`` with ``track/…``, ``views/N``, ``imagined``, ``figures/…``, ``log/…`` and ``about``.
The time line ``mission_time`` is the mission's own.
"""

import hashlib
import math
from types import ModuleType
from typing import TYPE_CHECKING, Any

import numpy as np

from reasoned_explorer.evaluation.mission_marks import score_colour
from reasoned_explorer.evaluation.record_file import record_bytes
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
from reasoned_explorer.viewer.exports.scenery import Scenery, Thing, scenery_of
from reasoned_explorer.viewer.exports.told import about, frontier_label, lines, tree_of

if TYPE_CHECKING:
    import rerun

TIMELINE = "mission_time"
_APPLICATION = "reasoned-explorer"
_TRACK, _CHOICE, _REFERENCE, _GOAL = "#22272e", "#c42f1a", "#0b757d", "#c42f1a"
#: So many names of things are shown at once; of more they are shown where one points.
_MOST_LABELS = 40


def rrd_bytes(mission: ExportedMission) -> bytes:
    """Return a mission as a recording.

    Raises:
        MissingDependencyError: Without rerun-sdk.
    """
    try:
        import rerun as rr
        import rerun.blueprint as rrb
    except ImportError as error:
        raise MissingDependencyError(
            "export to Rerun", "rerun-sdk", "pip install 'reasoned-explorer[rerun]'"
        ) from error
    return _Recording(rr, mission).encoded(_blueprint(rrb))


def _blueprint(rrb: ModuleType) -> Any:
    """Return how the viewer lays it out at first: the place on the left, views, tree, figures and log on the right."""
    return rrb.Blueprint(
        rrb.Horizontal(
            rrb.Spatial3DView(
                origin="/", contents=["/world/**", "/judge/**", "/agent/**", "/vehicle/**", "/track/**"], name="Place"
            ),
            rrb.Vertical(
                rrb.Spatial2DView(origin="/views", name="Views"),
                rrb.Tabs(
                    rrb.TextLogView(origin="/log", name="Log"),
                    rrb.TextDocumentView(origin="/imagined", name="Imagined"),
                    rrb.TextDocumentView(origin="/about", name="About"),
                ),
                rrb.TimeSeriesView(origin="/figures", name="CT and TT"),
            ),
            column_shares=[3, 2],
        ),
        rrb.TimePanel(timeline=TIMELINE),
        collapse_panels=True,
    )


class _Recording:
    """A mission that is being written, in the memory."""

    def __init__(self, rr: ModuleType, mission: ExportedMission) -> None:
        self._rr, self._mission, self._record = rr, mission, mission.record
        # The same record is the same recording: opened twice, the viewer shows it once.
        digest = hashlib.sha256(mission.name.encode() + b"\0" + record_bytes(mission.record)).hexdigest()
        self._stream: rerun.RecordingStream = rr.RecordingStream(
            _APPLICATION,
            recording_id=digest[:32],
            send_properties=False,
            # What makes a block must not hang on how fast it is written: one block for each entity.
            batcher_config=rr.ChunkBatcherConfig.NEVER(),
        )
        self._memory = self._stream.memory_recording()
        # Only mission time: when it was exported says nothing.
        self._stream.set_log_time_enabled(False)
        self._stream.set_log_tick_enabled(False)

    def encoded(self, blueprint: Any) -> bytes:
        """Return the bytes of the recording."""
        self._stream.send_recording_name(self._record.header.goal)
        self._stream.send_blueprint(blueprint)
        self._about()
        self._scenery(scenery_of(self._mission))
        self._judge()
        self._vehicle()
        self._agent()
        self._views()
        self._words()
        data = bytes(self._memory.drain_as_bytes() or b"")
        self._stream.disconnect()
        return data

    def _always(self, path: str, *what: Any) -> None:
        self._stream.log(path, *what, static=True)

    def _at(self, t_s: float, path: str, *what: Any) -> None:
        self._stream.set_time(TIMELINE, duration=np.timedelta64(round(t_s * 1e9), "ns"))
        self._stream.log(path, *what)

    def _about(self) -> None:
        said = "\n".join(f"{name}: {text}" for name, text in about(self._mission).items())
        self._always("about", self._rr.TextDocument(said, media_type="text/plain"))
        self._always("/", self._rr.ViewCoordinates.RIGHT_HAND_Z_UP)

    def _scenery(self, scenery: Scenery) -> None:
        rr = self._rr
        for mesh in scenery.meshes:
            solid = rr.Mesh3D(
                vertex_positions=mesh.vertices, triangle_indices=mesh.triangles, albedo_factor=_rgb(mesh.colour)
            )
            self._always(f"world/{mesh.name.replace(' ', '_')}", solid)
        kinds: dict[str, list[Thing]] = {}
        for thing in scenery.things:
            kinds.setdefault(thing.kind, []).append(thing)
        for kind, things in kinds.items():
            boxes = rr.Boxes3D(
                centers=[thing.centre for thing in things],
                sizes=[thing.size for thing in things],
                quaternions=[_turned(thing.yaw_rad) for thing in things],
                colors=[_rgb(thing.colour) for thing in things],
                labels=[thing.label for thing in things],
                show_labels=len(things) <= _MOST_LABELS,
            )
            self._always(f"world/things/{kind}", boxes)
        if scenery.names:
            labels, places = zip(*scenery.names, strict=True)
            self._always("world/names", rr.Points3D(places, labels=labels, radii=0.1, colors=_rgb(_TRACK)))

    def _judge(self) -> None:
        header = self._record.header
        if header.goal_objects:
            goals = self._rr.Points3D(
                [(x_m, y_m, 1.0) for _, _, x_m, y_m, _ in header.goal_objects],
                radii=[0.5 + 0.3 * grade for *_, grade in header.goal_objects],
                colors=_rgb(_GOAL),
                labels=[f"goal: {name.replace('_', ' ')}" for _, name, *_ in header.goal_objects],
            )
            self._always("judge/goal_objects", goals)
        if len(header.reference_way) > 1:
            way = [(x_m, y_m, 0.1) for x_m, y_m in header.reference_way]
            self._always("judge/reference_way", self._rr.LineStrips3D([way], radii=0.15, colors=_rgb(_REFERENCE)))

    def _vehicle(self) -> None:
        rr = self._rr
        nose = rr.Arrows3D(vectors=[(2.0, 0.0, 0.0)], radii=0.25, colors=_rgb(_TRACK), labels=["vehicle"])
        self._always("vehicle", nose)
        for pose in poses(self._record):
            turn = rr.Quaternion(xyzw=_turned(math.pi / 2.0 - pose.heading_rad))
            self._at(pose.t_s, "vehicle", rr.Transform3D(translation=(pose.x_m, pose.y_m, pose.z_m), quaternion=turn))
        for step in self._record.steps:
            for number, leg in enumerate(step.legs):
                way = [(point.x_m, point.y_m, point.z_m) for point in leg.track]
                for count, point in enumerate(leg.track[1:], start=2):
                    strip = rr.LineStrips3D([way[:count]], radii=0.12, colors=_rgb(_TRACK))
                    self._at(point.t_s, f"track/{step.step:04d}-{number}", strip)

    def _agent(self) -> None:
        rr = self._rr
        places: list[tuple[float, float, float]] = []
        labels: list[str] = []
        for t_s, number, place in path_points(self._record):
            places.append(place)
            labels.append(f"{number}")
            self._at(t_s, "agent/path_points", rr.Points3D(places, labels=labels, radii=0.4, colors=_rgb(_TRACK)))
        for moment in frontier_moments(self._record):
            marks = rr.Points3D(
                [(each.x_m, each.y_m, 0.5) for each in moment.frontiers],
                radii=[0.9 if each.state == "open" else 0.35 for each in moment.frontiers],
                colors=[_rgb(score_colour(each.q)) for each in moment.frontiers],
                labels=[frontier_label(each) for each in moment.frontiers],
            )
            self._at(moment.t_s, "agent/frontiers", marks)
        for chosen in choice_moments(self._record):
            line = rr.LineStrips3D(
                [[(*chosen.here, 0.3), (*chosen.there, 0.3)]], radii=0.1, colors=_rgb(_CHOICE), labels=["chosen"]
            )
            self._at(chosen.t_s, "agent/choice", line)
            if chosen.until_s > chosen.t_s:
                self._at(chosen.until_s, "agent/choice", rr.Clear(recursive=False))

    def _views(self) -> None:
        for step in self._record.steps:
            for look in looks(step):
                for view in look.views:
                    picture = self._mission.picture(view)
                    if picture is not None:
                        image = self._rr.EncodedImage(contents=picture, media_type="image/png")
                        self._at(look.seen_s, f"views/{view.key[-1]}", image)

    def _words(self) -> None:
        rr = self._rr
        for line in lines(self._record):
            text = rr.TextLog(line.text, level="WARN" if line.warns else "INFO")
            self._at(line.t_s, f"log/{line.topic}", text)
        for step in self._record.steps:
            if step.views:
                tree = rr.TextDocument(tree_of(step), media_type="text/plain")
                self._at(decided_s(step), "imagined", tree)
        for figure in figures(self._record):
            self._at(figure.t_s, "figures/ct_s", rr.Scalars(figure.ct_s))
            self._at(figure.t_s, "figures/tt_s", rr.Scalars(figure.tt_s))


def _rgb(colour: str) -> tuple[int, int, int]:
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)


def _turned(yaw_rad: float) -> tuple[float, float, float, float]:
    """Return the quaternion x, y, z, w of a turn about the vertical."""
    return 0.0, 0.0, math.sin(yaw_rad / 2.0), math.cos(yaw_rad / 2.0)
