"""Pictures from straight above, as a map shows a place."""

import math
from dataclasses import replace

import numpy as np

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Camera, Fault, SettingsError
from reasoned_explorer.rendering.conditions import Conditions
from reasoned_explorer.rendering.renderer import Picture, Renderer
from reasoned_explorer.rendering.scene import Scene

#: What is so high leans outward by no more than this, pixels; higher things by as many times more.
_HIGH_M, _MOST_LEAN_PX = 12.0, 0.5
#: The camera hangs at most so high, metres: the ground is drawn up to 10 km away.
_CEILING_M = 9_000.0
#: It hangs at least so high, metres.
_FLOOR_M = 200.0
#: No air in between: what is seen is a map, whatever the weather.
_NO_HAZE_M = 1e9


def overhead(
    scene: Scene,
    x_m: float,
    y_m: float,
    *,
    span_m: float,
    width_px: int = 1024,
    height_px: int = 1024,
    heading_rad: float = 0.0,
    conditions: Conditions | None = None,
    antialias: int = 2,
) -> Picture:
    """Return a place seen from straight above, almost without perspective.

    It is one picture through a very long lens from very high up, so that there is nothing to be stitched: walls lean
    outward by less than can be seen on most of it.

    Args:
        scene: What there is.
        x_m: Middle of the picture, east, metres.
        y_m: Likewise, north.
        span_m: Metres across the picture, from 1 to 20,000.
        width_px: Pixels across.
        height_px: Pixels down.
        heading_rad: What lies in this direction is at the top; 0 for north.
        conditions: The light. There is no haze, and no shadow is cast: the renderer draws those near the eye only.
        antialias: See `Renderer.picture`.

    Returns:
        The picture; its depth is how high above the ground what is seen stands, metres.

    Raises:
        SettingsError: If anything is out of range.
    """
    if not 1.0 <= span_m <= _CEILING_M:
        raise SettingsError("view from above", [Fault(f"span_m = {span_m}", f"1 to {_CEILING_M:,g} metres")])
    renderer = Renderer(scene, replace(conditions or Conditions(), haze_m=_NO_HAZE_M))
    reach_px = 0.5 * math.hypot(width_px, height_px)
    altitude_m = min(max(_HIGH_M * reach_px / _MOST_LEAN_PX, _FLOOR_M, span_m), _CEILING_M)
    camera = Camera(width_px, height_px, 2.0 * math.atan(0.5 * span_m / altitude_m))
    above = Pose(x_m, y_m, altitude_m, heading_rad)
    picture = renderer.picture(above, camera, pitch_rad=-0.5 * math.pi, antialias=antialias)
    return replace(picture, depth_m=np.float32(altitude_m) - picture.depth_m)
