"""AirSim's conventions, and the way to this package's and back.

AirSim measures north, east and down from where the vehicle started; its body and camera frames are forward, right and
down; orientations are unit quaternions that carry the body frame into that frame. Yaw is the compass heading, pitch is
positive where the nose rises, roll where the right side sinks. Maps on the wire are dicts whose keys end in ``_val``.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from reasoned_explorer.geometry import Pose, enu_from_ned, ned_from_enu, normalise_bearing_rad, normalise_heading_rad

Wire = dict[str, Any]


class Attitude(NamedTuple):
    """An orientation, radians: applied as yaw, then pitch, then roll."""

    roll_rad: float
    pitch_rad: float
    yaw_rad: float


@dataclass(frozen=True, slots=True)
class HomeFrame:
    """The frame in which a vehicle's positions are told: north, east, down of where it started.

    Attributes:
        x_m: East of the world's origin, metres: where the vehicle started.
        y_m: North of it.
        z_m: Above the ground.
    """

    x_m: float = 0.0
    y_m: float = 0.0
    z_m: float = 0.0

    def ned_m(self, x_m: float, y_m: float, z_m: float) -> tuple[float, float, float]:
        """Return north, east, down of home for a point of the world."""
        return ned_from_enu(x_m - self.x_m, y_m - self.y_m, z_m - self.z_m)

    def enu_m(self, north_m: float, east_m: float, down_m: float) -> tuple[float, float, float]:
        """Return a point of the world for north, east, down of home."""
        x_m, y_m, z_m = enu_from_ned(north_m, east_m, down_m)
        return x_m + self.x_m, y_m + self.y_m, z_m + self.z_m

    def pose(self, position: Mapping[str, Any], orientation: Mapping[str, Any]) -> Pose:
        """Return where something is and its heading.

        Raises:
            ValueError: If it is no position or no orientation.
        """
        return Pose(*self.enu_m(*triple(position)), attitude(orientation).yaw_rad)

    def wire_pose(self, pose: Pose, *, pitch_rad: float = 0.0) -> Wire:
        """Return a pose as it travels."""
        ned = self.ned_m(pose.x_m, pose.y_m, pose.z_m)
        return {"position": vector(*ned), "orientation": quaternion(0.0, pitch_rad, pose.heading_rad)}


def vector(x: float, y: float, z: float) -> Wire:
    """Return three numbers as they travel."""
    return {"x_val": float(x), "y_val": float(y), "z_val": float(z)}


def triple(value: object) -> tuple[float, float, float]:
    """Return three numbers that came.

    Raises:
        ValueError: If they are not three finite numbers.
    """
    x, y, z = _numbers(value, "x_val", "y_val", "z_val")
    return x, y, z


def quaternion(roll_rad: float, pitch_rad: float, yaw_rad: float) -> Wire:
    """Return an orientation as it travels; of the two quaternions that say the same the one whose w is not negative."""
    sin_r, cos_r = math.sin(0.5 * roll_rad), math.cos(0.5 * roll_rad)
    sin_p, cos_p = math.sin(0.5 * pitch_rad), math.cos(0.5 * pitch_rad)
    sin_y, cos_y = math.sin(0.5 * yaw_rad), math.cos(0.5 * yaw_rad)
    w = cos_r * cos_p * cos_y + sin_r * sin_p * sin_y
    x = sin_r * cos_p * cos_y - cos_r * sin_p * sin_y
    y = cos_r * sin_p * cos_y + sin_r * cos_p * sin_y
    z = cos_r * cos_p * sin_y - sin_r * sin_p * cos_y
    sign = -1.0 if w < 0.0 else 1.0
    return {"w_val": sign * w, "x_val": sign * x, "y_val": sign * y, "z_val": sign * z}


def attitude(value: object) -> Attitude:
    """Return an orientation that came; the yaw in [0, 2π).

    Raises:
        ValueError: If it is no quaternion.
    """
    w, x, y, z = _numbers(value, "w_val", "x_val", "y_val", "z_val")
    square = w * w + x * x + y * y + z * z
    if square < 1e-12:
        raise ValueError("a quaternion of length 0")
    sine = max(-1.0, min(1.0, 2.0 * (w * y - z * x) / square))
    return Attitude(
        math.atan2(2.0 * (w * x + y * z), square - 2.0 * (x * x + y * y)),
        math.asin(sine),
        normalise_heading_rad(math.atan2(2.0 * (w * z + x * y), square - 2.0 * (y * y + z * z))),
    )


def yaw_deg(heading_rad: float) -> float:
    """Return a heading as AirSim's commands take it: degrees in [-180, 180)."""
    return math.degrees(normalise_bearing_rad(heading_rad))


def heading_of_yaw_rad(angle_deg: float) -> float:
    """Return the heading, in [0, 2π), of a yaw in degrees."""
    return normalise_heading_rad(math.radians(angle_deg))


def _numbers(value: object, *names: str) -> list[float]:
    if not isinstance(value, Mapping):
        raise ValueError(f"expected a map with {', '.join(names)}, not {type(value).__name__}")  # noqa: TRY004 - of the wire
    found = [value.get(name) for name in names]
    if not all(isinstance(one, int | float) and not isinstance(one, bool) and math.isfinite(one) for one in found):
        raise ValueError(f"expected finite numbers {', '.join(names)}, not {found!r:.80}")
    return [float(one) for one in found if one is not None]
