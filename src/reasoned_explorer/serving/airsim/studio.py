"""The served drone's cameras and the pictures that they take."""

import asyncio
import io
import math
import os
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache, partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.geometry import Pose, normalise_heading_rad
from reasoned_explorer.model import Camera
from reasoned_explorer.serving.airsim.flight import State
from reasoned_explorer.serving.airsim.scenery import Scenery
from reasoned_explorer.serving.airsim.settings import AirSimSettings, CameraSettings, camera_name_of
from reasoned_explorer.serving.msgpack_rpc import MethodError
from reasoned_explorer.simulation.renderers import renderer_of
from reasoned_explorer.vehicles.airsim.pictures import NOTHING_M, ImageType

if TYPE_CHECKING:
    from reasoned_explorer.rendering.renderer import Renderer, Sighted
    from reasoned_explorer.world.atlas import Atlas

#: Depths beyond this are white in the kind of picture that shows depths to people, metres.
_VISIBLE_M = 100.0
#: Small pictures are sent at once rather than small.
_PNG_LEVEL = 1


@dataclass(frozen=True, slots=True)
class Aim:
    """Where a camera sits and looks, in its body's frame.

    Attributes:
        forward_m: Of the body's middle.
        right_m: Likewise.
        down_m: Likewise.
        yaw_rad: Positive to the right.
        pitch_rad: Positive up.
    """

    forward_m: float
    right_m: float
    down_m: float
    yaw_rad: float
    pitch_rad: float

    def pose(self, body: State) -> Pose:
        """Return where the camera is for a body."""
        sine, cosine = math.sin(body.heading_rad), math.cos(body.heading_rad)
        return Pose(
            body.x_m + self.forward_m * sine + self.right_m * cosine,
            body.y_m + self.forward_m * cosine - self.right_m * sine,
            body.z_m - self.down_m,
            normalise_heading_rad(body.heading_rad + self.yaw_rad),
        )


@dataclass(frozen=True, slots=True)
class Wanted:
    """A picture that is asked for.

    Attributes:
        camera: Its name, one of the studio's.
        kind: What it shows.
        as_float: Whether numbers are wanted instead of bytes.
        compress: Whether as a PNG.
    """

    camera: str
    kind: ImageType
    as_float: bool
    compress: bool


class Studio:
    """Takes pictures in threads, one for each core.

    Args:
        atlas: Of the world.
        scenery: Gives things their segmentation numbers.
        settings: Which cameras there are.
        conditions: Time of day and weather, a name of `rendering.conditions.PRESETS`.
    """

    def __init__(self, atlas: "Atlas", scenery: Scenery, settings: AirSimSettings, conditions: str) -> None:
        self._atlas, self._scenery, self._settings, self._conditions = atlas, scenery, settings, conditions
        self._cameras = settings.cameras()
        self._aims: dict[str, Aim] = {}
        self._fovs_rad: dict[str, float] = {}
        self._pool: ThreadPoolExecutor | None = None
        self.reset()

    def reset(self) -> None:
        """Have all cameras look where the settings say."""
        self._aims = {name: _aim_of(camera) for name, camera in self._cameras.items()}
        self._fovs_rad = {}

    def close(self) -> None:
        """Let the threads go."""
        pool, self._pool = self._pool, None
        if pool is not None:
            pool.shutdown(cancel_futures=True)

    def warm_up(self) -> None:
        """Make the scene and compile what draws it, so that the first picture does not wait for that."""
        _ = self._renderer

    def known(self, name: str) -> str:
        """Return which camera a name, or an old number, means.

        Raises:
            MethodError: If there is none.
        """
        found = camera_name_of(name, self._cameras)
        if found is None:
            raise MethodError(f"there is no camera {name!r:.60}; there are {', '.join(self._cameras)}")
        return found

    def aim_of(self, name: str) -> Aim:
        """Return where a camera sits and looks."""
        return self._aims[name]

    def aim(self, name: str, aim: Aim) -> None:
        """Have a camera sit and look elsewhere."""
        self._aims[name] = aim

    def zoom(self, name: str, fov_rad: float) -> None:
        """Give a camera another field of view."""
        self._fovs_rad[name] = fov_rad

    def camera(self, name: str, kind: int) -> Camera:
        """Return the pinhole camera of a kind of picture."""
        made = self._settings.capture(self._cameras[name], kind).camera()
        fov_rad = self._fovs_rad.get(name, made.horizontal_fov_rad)
        return Camera(made.width_px, made.height_px, fov_rad)

    def take(self, body: State, wanted: Sequence[Wanted]) -> "list[asyncio.Future[dict[str, Any]]]":
        """Begin to take pictures for a body; return futures of their data (see `_packed`), in order."""
        loop = asyncio.get_running_loop()
        # Made here, by one thread: several that load and compile at once have been seen to wait for each other.
        renderer = self._renderer
        if self._pool is None:
            self._pool = ThreadPoolExecutor(os.cpu_count() or 1, thread_name_prefix="pictures")
        made = []
        for one in wanted:
            aim = self._aims[one.camera]
            camera = self.camera(one.camera, one.kind)
            pose, pitch_rad = aim.pose(body), aim.pitch_rad
            job = partial(self._taken, renderer, one, pose=pose, pitch_rad=pitch_rad, camera=camera)
            made.append(loop.run_in_executor(self._pool, job))
        return made

    def _taken(
        self, renderer: "Renderer", wanted: Wanted, *, pose: Pose, pitch_rad: float, camera: Camera
    ) -> dict[str, Any]:
        """Take one picture and return what of an answer depends on it."""
        sighted: Sighted
        pixels: NDArray[np.uint8]
        if wanted.kind is ImageType.SCENE:
            picture = renderer.picture(pose, camera, pitch_rad=pitch_rad)
            sighted, pixels = picture, picture.colour
        else:
            sighted = renderer.ids(pose, camera, pitch_rad=pitch_rad)
            pixels = np.empty(0, np.uint8)
        size = {"width": camera.width_px, "height": camera.height_px}
        if wanted.as_float or wanted.kind not in {ImageType.SCENE, ImageType.SEGMENTATION}:
            depths = _depths(sighted.depth_m, camera, wanted.kind)
            if wanted.as_float:
                return {"image_data_uint8": b"", "image_data_float": depths.ravel().tolist(), **size}
            top = 1.0 if wanted.kind is ImageType.DEPTH_VIS else 255.0
            grey = np.round(np.clip(depths / top, 0.0, 1.0) * 255.0).astype(np.uint8)
            pixels = np.repeat(grey[:, :, None], 3, axis=2)
        elif wanted.kind is ImageType.SEGMENTATION:
            pixels = segmentation_colours()[self._scenery.numbered(sighted.instances)]
        return {"image_data_uint8": _packed(pixels, compress=wanted.compress), "image_data_float": [], **size}

    @property
    def _renderer(self) -> "Renderer":
        return renderer_of(self._atlas, self._conditions)


def _aim_of(camera: CameraSettings) -> Aim:
    return Aim(camera.X, camera.Y, camera.Z, math.radians(camera.Yaw), math.radians(camera.Pitch))


def _depths(depth_m: NDArray[np.float32], camera: Camera, kind: ImageType) -> NDArray[np.float32]:
    """Return depths as AirSim gives them: along the axis, along the ray, or as shares of what people are shown."""
    seen = np.where(np.isfinite(depth_m), depth_m, np.float32(NOTHING_M))
    if kind is ImageType.DEPTH_PERSPECTIVE:
        focal = 0.5 * camera.width_px / math.tan(0.5 * camera.horizontal_fov_rad)
        across = (np.arange(camera.width_px) + 0.5 - 0.5 * camera.width_px) / focal
        down = (np.arange(camera.height_px) + 0.5 - 0.5 * camera.height_px) / focal
        stretch = np.sqrt(1.0 + across[None, :] ** 2 + down[:, None] ** 2)
        seen = np.minimum(seen * stretch, NOTHING_M)
    elif kind is ImageType.DEPTH_VIS:
        seen = np.minimum(seen / _VISIBLE_M, 1.0)
    return seen.astype(np.float32)


@cache
def segmentation_colours() -> NDArray[np.uint8]:
    """Return the colour of each segmentation number, RGB, shape (256, 3); 0 is black."""
    from reasoned_explorer.rendering.codes import coded_colours

    return coded_colours(np.arange(256))


def _packed(pixels: NDArray[np.uint8], *, compress: bool) -> bytes:
    """Return a picture as a PNG, or as rows of blue, green, red."""
    if not compress:
        return np.ascontiguousarray(pixels[:, :, ::-1]).tobytes()
    from PIL import Image

    held = io.BytesIO()
    Image.fromarray(pixels).save(held, "PNG", compress_level=_PNG_LEVEL)
    return held.getvalue()
