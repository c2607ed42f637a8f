"""Cameras as the kernels see them: where the eye is, which way its axes point, how long its focal length is."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Camera, Fault, SettingsError

#: Nothing nearer than this (along the view's axis) is drawn, metres.
NEAR_M = 0.05
#: Pictures have at most this many samples along a side.
MAX_SIDE = 8192


class Projection(NamedTuple):
    """A pinhole camera in the world.

    Attributes:
        eye: Where it is, ENU metres, shape (3,).
        axes: Its right, down and forward axes as rows, ENU, shape (3, 3).
        focal: Focal length, samples.
        centre_x: Where its axis meets the picture, samples from the left edge.
        centre_y: Likewise, from the upper edge.
        width: Samples across.
        height: Samples down.
        samples: Samples along the side of a pixel: 1 or 2.
    """

    eye: NDArray[np.float64]
    axes: NDArray[np.float64]
    focal: float
    centre_x: float
    centre_y: float
    width: int
    height: int
    samples: int


def projection_of(pose: Pose, camera: Camera, *, pitch_rad: float = 0.0, antialias: int = 1) -> Projection:
    """Return the projection of a camera.

    Args:
        pose: Where the camera is and its compass heading.
        camera: Its picture and field of view; pixels are square.
        pitch_rad: How far it looks up (positive) or down, radians, in [-π/2, π/2].
        antialias: Samples along the side of a pixel: 1 or 2.

    Raises:
        SettingsError: If any of them is out of range.
    """
    faults = list(_faults(pose, camera, pitch_rad, antialias))
    if faults:
        raise SettingsError("view", faults)
    sin_h, cos_h = math.sin(pose.heading_rad), math.cos(pose.heading_rad)
    sin_p, cos_p = math.sin(pitch_rad), math.cos(pitch_rad)
    axes = np.array(
        [
            [cos_h, -sin_h, 0.0],
            [sin_h * sin_p, cos_h * sin_p, -cos_p],
            [sin_h * cos_p, cos_h * cos_p, sin_p],
        ]
    )
    return _through(camera, np.array([pose.x_m, pose.y_m, pose.z_m], np.float64), axes, antialias)


def resized(view: Projection, camera: Camera) -> Projection:
    """Return the projection of another camera that stands and looks as a view does, one sample to a pixel.

    Args:
        view: Where it is.
        camera: Its picture and field of view, in the ranges of `projection_of`: they are not looked at again.
    """
    return _through(camera, view.eye, view.axes, 1)


def _through(camera: Camera, eye: NDArray[np.float64], axes: NDArray[np.float64], antialias: int) -> Projection:
    width, height = camera.width_px * antialias, camera.height_px * antialias
    focal = 0.5 * width / math.tan(0.5 * camera.horizontal_fov_rad)
    return Projection(eye, axes, focal, 0.5 * width, 0.5 * height, width, height, antialias)


def _faults(pose: Pose, camera: Camera, pitch_rad: float, antialias: int) -> list[Fault]:
    found = []
    if antialias not in {1, 2}:
        found.append(Fault(f"antialias = {antialias}", "1 or 2 samples along the side of a pixel"))
    for name, side in (("width_px", camera.width_px), ("height_px", camera.height_px)):
        if not 1 <= side * max(1, antialias) <= MAX_SIDE:
            found.append(Fault(f"{name} = {side}", f"1 to {MAX_SIDE} samples"))
    if not 0.0 < camera.horizontal_fov_rad < math.pi:
        found.append(Fault(f"horizontal_fov_rad = {camera.horizontal_fov_rad}", "an angle in (0, π)"))
    if not abs(pitch_rad) <= 0.5 * math.pi:
        found.append(Fault(f"pitch_rad = {pitch_rad}", "an angle in [-π/2, π/2]"))
    if not all(map(math.isfinite, (pose.x_m, pose.y_m, pose.z_m, pose.heading_rad))):
        found.append(Fault(f"a pose at {pose}", "finite numbers"))
    return found
