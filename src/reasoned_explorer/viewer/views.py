"""The pictures of a mission's views: those that were kept, or drawn anew from where the vehicle really stood."""

import io
import math
from collections import OrderedDict
from contextlib import suppress
from pathlib import Path
from threading import Lock
from typing import Literal

from PIL import Image

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Camera, Fault, InputError, PartError
from reasoned_explorer.model.checks import is_within
from reasoned_explorer.model.record import EpisodeRecord, MissionHeader, ViewRecord
from reasoned_explorer.vehicles.registry import vehicle_profile
from reasoned_explorer.viewer.runs import MissionFiles, UnknownIdError
from reasoned_explorer.viewer.security import within
from reasoned_explorer.viewer.worlds import Worlds

#: Pixels across a picture that is asked for.
WIDTH_RANGE_PX = (224, 640)
_PNG = b"\x89PNG\r\n\x1a\n"
_MOST_KEPT = 256
#: What pictures are written as.
Encoding = Literal["PNG", "WEBP"]


class Views:
    """Pictures of views; safe to use from several threads.

    Args:
        worlds: Where pictures are drawn.
    """

    def __init__(self, worlds: Worlds) -> None:
        self._worlds = worlds
        self._drawn: OrderedDict[tuple[object, ...], bytes] = OrderedDict()
        self._lock = Lock()

    def state(self, files: MissionFiles, header: MissionHeader) -> str:
        """Return ``kept`` where pictures lie beside a record, ``drawn`` where they can be drawn, else ``none``."""
        if files.pictures is not None and next(files.pictures.glob("*.png"), None) is not None:
            return "kept"
        return "drawn" if self._worlds.may_have(files, header) else "none"

    def picture(
        self,
        files: MissionFiles,
        record: EpisodeRecord,
        step: int,
        index: int,
        *,
        width_px: int | None = None,
        encoding: Encoding = "PNG",
    ) -> bytes | None:
        """Return the picture of a view, or None where there is none and none can be drawn.

        Args:
            files: Of the mission.
            record: Its record.
            step: Place of the step.
            index: Place of the view in the step.
            width_px: How wide it is to be, at most, in `WIDTH_RANGE_PX`; None for as it is, or was to be.
            encoding: ``"PNG"`` for every pixel as it is; ``"WEBP"`` for an eighth of the bytes, on slow links.

        Raises:
            UnknownIdError: If there is no such view.
        """
        if not (0 <= step < len(record.steps) and 0 <= index < len(record.steps[step].views)):
            raise UnknownIdError("view", [Fault("there is no such view in this mission", "one of its record")])
        kept = self._kept(files, record, step, index, width_px=width_px, encoding=encoding)
        if kept is not None:
            return kept
        return self._draw(files, record, step, index, width_px=width_px, encoding=encoding)

    def _kept(
        self,
        files: MissionFiles,
        record: EpisodeRecord,
        step: int,
        index: int,
        *,
        width_px: int | None,
        encoding: Encoding,
    ) -> bytes | None:
        path = kept_path(files, record, step, index)
        if path is None:
            return None
        try:
            data = path.read_bytes()
            if not data.startswith(_PNG):
                return None
            with Image.open(io.BytesIO(data)) as image:
                small = width_px is None or image.width <= width_px
                if small and encoding == "PNG":
                    return data
                width = image.width if small or width_px is None else width_px
                height = max(1, round(image.height * width / image.width))
                return _encoded(image.convert("RGB").resize((width, height), Image.Resampling.LANCZOS), encoding)
        except (OSError, ValueError, Image.DecompressionBombError):
            return None

    def _draw(
        self,
        files: MissionFiles,
        record: EpisodeRecord,
        step: int,
        index: int,
        *,
        width_px: int | None,
        encoding: Encoding,
    ) -> bytes | None:
        header = record.header
        pose = viewpoint(record, step, record.steps[step].views[index])
        side_px = width_px or min(WIDTH_RANGE_PX[1], max(WIDTH_RANGE_PX[0], _side_px(header)))
        conditions = str(header.settings.get("conditions", "clear"))
        camera = camera_of(header)
        key = (header.world_digest, pose, camera, side_px, conditions, encoding)
        with self._lock:
            if key in self._drawn:
                self._drawn.move_to_end(key)
                return self._drawn[key]
        atlas = self._worlds.of(files, header)
        if atlas is None or not atlas.world.bounds.contains(pose.x_m, pose.y_m):
            return None
        # The renderer is loaded when a picture is drawn, not when a page is opened.
        from reasoned_explorer.simulation.painter import Painter

        try:
            pixels = Painter(atlas, side_px=side_px, conditions=conditions).paint(pose, camera)
        except (InputError, PartError):
            return None  # conditions that this version does not know, say
        data = _encoded(Image.fromarray(pixels), encoding)
        with self._lock:
            self._drawn[key] = data
            while len(self._drawn) > _MOST_KEPT:
                self._drawn.popitem(last=False)
        return data


def viewpoint(record: EpisodeRecord, step: int, view: ViewRecord) -> Pose:
    """Return from where a view was really seen.

    That is where the last leg before ended; a record's poses are where the vehicle believed to be. The heading is the
    one that it believed in, within a degree or two of the true one.
    """
    for earlier in reversed(record.steps[:step]):
        for leg in reversed(earlier.legs):
            if leg.track:
                end = leg.track[-1]
                return Pose(end.x_m, end.y_m, end.z_m, view.heading_rad)
    x_m, y_m, z_m, _ = record.header.start
    return Pose(x_m, y_m, z_m, view.heading_rad)


def camera_of(header: MissionHeader) -> Camera:
    """Return the camera of a mission's vehicle; the usual one where its profile is not known here."""
    with suppress(InputError):
        return vehicle_profile(header.vehicle).camera
    return Camera()


def kept_path(files: MissionFiles, record: EpisodeRecord, step: int, index: int) -> Path | None:
    """Return where the picture of a view was kept, or None.

    Pictures are named by the vehicle's own count of legs and looks, which a record does not hold; but the looks of both
    come in one order.
    """
    if files.pictures is None:
        return None
    looks = sorted({path.name.rpartition("-")[0] for path in files.pictures.glob("*-*-*.png")})
    keys = [view.key[:2] for view in record.steps[step].views]
    before = sum(len({view.key[:2] for view in earlier.views}) for earlier in record.steps[:step])
    place = before + list(dict.fromkeys(keys)).index(keys[index])
    if place >= len(looks):
        return None
    path = files.pictures / f"{looks[place]}-{record.steps[step].views[index].key[2]:04d}.png"
    return within(files.pictures, path)


def _side_px(header: MissionHeader) -> int:
    side_px = header.settings.get("picture_px", 448)
    return int(side_px) if is_within(side_px, 16, 4096, whole=True) and math.isfinite(side_px) else 448


def _encoded(image: Image.Image, encoding: Encoding) -> bytes:
    file = io.BytesIO()
    if encoding == "WEBP":
        image.save(file, "WEBP", quality=80, method=2)
    else:
        image.save(file, "PNG", compress_level=3)
    return file.getvalue()
