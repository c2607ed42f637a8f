"""Pictures all around and of several cameras side by side."""

import math
from collections.abc import Sequence

import numpy as np

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Camera, Fault, SettingsError
from reasoned_explorer.model.stopping import stop_if_asked
from reasoned_explorer.rendering.renderer import Picture, Renderer

#: Within a strip nothing lies further from its place on the cylinder than this, pixels.
_MOST_ASTRAY_PX = 0.05
#: A panorama is at least this wide, so that a strip of one column is narrow, pixels.
_LEAST_WIDTH_PX = 16


def panorama(
    renderer: Renderer, pose: Pose, *, width_px: int = 2048, height_px: int = 512, antialias: int = 2
) -> Picture:
    """Return a picture of everything around a place, on a cylinder: each column is one heading.

    It is put together from strips so narrow that a pinhole camera's picture and the cylinder's are the same to a
    twentieth of a pixel; no strip is stretched or blended, so that depth and ids are as true as in a single view.

    Args:
        renderer: Draws.
        pose: Where the camera is; its heading is the picture's middle, the seam lies behind.
        width_px: Of the whole turn, pixels; the pixels are square at the horizon.
        height_px: Half as much above the horizon as below it, pixels.
        antialias: See `Renderer.picture`.

    Returns:
        The picture; its depth is how far things are along the ground, not along an axis.

    Raises:
        SettingsError: If a size or the pose is out of range.
    """
    if width_px < _LEAST_WIDTH_PX:
        raise SettingsError("panorama", [Fault(f"width_px = {width_px}", f"at least {_LEAST_WIDTH_PX} pixels")])
    focal_px = width_px / (2.0 * math.pi)
    strips = []
    for first, count in _strips(width_px, height_px, focal_px):
        stop_if_asked()
        turn_rad = ((first + 0.5 * count) / width_px - 0.5) * 2.0 * math.pi
        camera = Camera(count, height_px, 2.0 * math.atan(0.5 * count / focal_px))
        strips.append(renderer.picture(pose.facing(pose.heading_rad + turn_rad), camera, antialias=antialias))
    return _joined(strips)


def side_by_side(
    renderer: Renderer,
    pose: Pose,
    camera: Camera,
    bearings_rad: Sequence[float],
    *,
    pitch_rad: float = 0.0,
    antialias: int = 2,
) -> Picture:
    """Return the pictures of one camera in several directions, from left to right.

    Args:
        renderer: Draws.
        pose: Where the camera is, and what the bearings are counted from.
        camera: Of each picture.
        bearings_rad: At least one, clockwise.
        pitch_rad: See `Renderer.picture`.
        antialias: Likewise.

    Raises:
        SettingsError: If there is no bearing or anything is out of range.
    """
    if not bearings_rad:
        raise SettingsError("views", [Fault("no bearings", "at least one")])
    views = []
    for bearing_rad in bearings_rad:
        stop_if_asked()
        facing = pose.facing(pose.heading_rad + bearing_rad)
        views.append(renderer.picture(facing, camera, pitch_rad=pitch_rad, antialias=antialias))
    return _joined(views)


def _strips(width_px: int, height_px: int, focal_px: float) -> list[tuple[int, int]]:
    """Return the first column and the number of columns of each strip.

    At an angle a from a strip's middle what should be at height v is drawn at v / cos a, off by about v · a² / 2; and
    what should be focal · a from its middle at focal · tan a, off by about focal · a³ / 3.
    """
    by_height_rad = math.sqrt(4.0 * _MOST_ASTRAY_PX / height_px)
    by_width_rad = (3.0 * _MOST_ASTRAY_PX / focal_px) ** (1.0 / 3.0)
    columns = max(1, int(2.0 * focal_px * min(by_height_rad, by_width_rad)))
    return [(first, min(columns, width_px - first)) for first in range(0, width_px, columns)]


def _joined(pictures: Sequence[Picture]) -> Picture:
    return Picture(
        depth_m=np.concatenate([picture.depth_m for picture in pictures], axis=1),
        instances=np.concatenate([picture.instances for picture in pictures], axis=1),
        colour=np.concatenate([picture.colour for picture in pictures], axis=1),
    )
