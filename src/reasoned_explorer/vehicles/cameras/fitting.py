"""A real camera's pictures as those of the camera that a profile says the machine has."""

import asyncio
import math

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from reasoned_explorer.model import Camera, PartError
from reasoned_explorer.vehicles.cameras.live import LiveCamera

#: A camera that looks ahead is asked for nothing that is farther from there, radians.
_AHEAD_RAD = math.radians(15.0)


def fitted(
    image: NDArray[np.uint8], camera: Camera, *, fov_rad: float | None = None, least_px: int = 0
) -> NDArray[np.uint8]:
    """Return the middle of a picture, cut to the shape of a camera and, where it sees more, to its field of view.

    Where it sees less than the camera of the profile, nothing is made up: the picture spans less than is said.

    Args:
        image: RGB, shape (height, width, 3).
        camera: The camera of the profile.
        fov_rad: Horizontal field of view of the whole picture, radians; None where it is not known: nothing is then cut
            off for it.
        least_px: Width of what is returned, where that is more than the camera's, pixels.
    """
    height, width = image.shape[:2]
    cut_px = float(width)
    if fov_rad is not None and fov_rad > camera.horizontal_fov_rad:
        cut_px *= math.tan(0.5 * camera.horizontal_fov_rad) / math.tan(0.5 * fov_rad)
    shape = camera.height_px / camera.width_px
    cut_px = min(cut_px, height / shape)
    left, top = 0.5 * (width - cut_px), 0.5 * (height - cut_px * shape)
    wide_px = max(camera.width_px, least_px)
    size = wide_px, max(1, round(wide_px * shape))
    box = (left, top, left + cut_px, top + cut_px * shape)
    cut = Image.fromarray(image).resize(size, Image.Resampling.BICUBIC, box=box, reducing_gap=3.0)
    return np.asarray(cut, dtype=np.uint8)


class FittedCamera:
    """A camera that looks ahead of a machine, as its drivers want one.

    Args:
        camera: The camera.
        model: What the machine's profile says of it.
        fov_rad: See `fitted`.
        least_px: Likewise.
    """

    def __init__(self, camera: LiveCamera, model: Camera, *, fov_rad: float | None = None, least_px: int = 0) -> None:
        self._camera, self._model, self._fov_rad, self._least_px = camera, model, fov_rad, least_px

    @property
    def age_s(self) -> float:
        """Seconds since its newest frame."""
        return self._camera.age_s

    def open(self) -> None:
        """Begin to read it. Safe to call twice."""
        self._camera.open()

    def close(self) -> None:
        """Let it go. Safe to call twice."""
        self._camera.close()

    def __call__(self) -> NDArray[np.uint8]:
        """Return what it shows now; may wait.

        Raises:
            PartError: If it shows nothing new.
        """
        return fitted(self._camera.picture(), self._model, fov_rad=self._fov_rad, least_px=self._least_px)

    async def take(self, bearing_rad: float) -> NDArray[np.uint8]:
        """Return what it shows now, which must be wanted of what lies ahead.

        Raises:
            PartError: If it shows nothing new, or something else is wanted.
        """
        if abs(bearing_rad) > _AHEAD_RAD:
            raise PartError("camera", f"it looks ahead, and {math.degrees(bearing_rad):.0f}° from there is wanted")
        return await asyncio.to_thread(self)
