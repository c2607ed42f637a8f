"""How far it is to what a body would meet that goes straight on, in a depth picture."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.vehicles.airsim.conventions import Attitude

#: What is lower than this above the ground is the ground, or is flown over, metres.
_GROUND_M = 0.3


@dataclass(frozen=True, slots=True)
class Corridor:
    """The room that a body goes through.

    Attributes:
        half_width_m: To each side of the body's middle, metres.
        above_m: Over it.
        below_m: Under it; not so far down that the ground is in it.
    """

    half_width_m: float = 0.5
    above_m: float = 0.5
    below_m: float = 1.0

    def free_m(
        self, depth_m: NDArray[np.float32], *, fov_rad: float, camera: Attitude, heading_rad: float, height_m: float
    ) -> float:
        """Return how far ahead of a camera the first thing in the corridor is, metres; infinite where it is free.

        Args:
            depth_m: Along the camera's axis, shape (height, width); infinite where there is nothing.
            fov_rad: The camera's horizontal field of view, radians.
            camera: How the camera is turned.
            heading_rad: Where the corridor leads.
            height_m: Of the camera above the ground, metres.
        """
        rows, columns = depth_m.shape
        focal = 0.5 * columns / math.tan(0.5 * fov_rad)
        # The ray through each pixel for a depth of 1: ahead, to the right and down, turned level and to the heading.
        right = (np.arange(columns, dtype=np.float32)[None, :] + 0.5 - 0.5 * columns) / focal
        down = (np.arange(rows, dtype=np.float32)[:, None] + 0.5 - 0.5 * rows) / focal
        sin_r, cos_r = math.sin(camera.roll_rad), math.cos(camera.roll_rad)
        right, down = right * cos_r - down * sin_r, right * sin_r + down * cos_r
        sin_p, cos_p = math.sin(camera.pitch_rad), math.cos(camera.pitch_rad)
        ahead, down = cos_p + down * sin_p, down * cos_p - sin_p
        off_rad = camera.yaw_rad - heading_rad
        sin_y, cos_y = math.sin(off_rad), math.cos(off_rad)
        ahead, right = ahead * cos_y - right * sin_y, ahead * sin_y + right * cos_y
        with np.errstate(invalid="ignore"):  # nothing there, straight ahead: infinity times 0
            lowest_m = min(self.below_m, height_m - _GROUND_M)
            is_in = (np.abs(right * depth_m) <= self.half_width_m) & (down * depth_m <= lowest_m)
            is_in &= (down * depth_m >= -self.above_m) & np.isfinite(depth_m) & (ahead > 0.0)
            within_m = (ahead * depth_m)[is_in]
        return float(within_m.min()) if within_m.size else math.inf
