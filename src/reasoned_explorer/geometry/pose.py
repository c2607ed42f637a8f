"""Where something is and which way it faces."""

import math
from dataclasses import dataclass

from reasoned_explorer.geometry.angles import heading_towards_rad, normalise_bearing_rad, normalise_heading_rad


@dataclass(frozen=True, slots=True)
class Pose:
    """A position in the world's ENU frame and a heading.

    Attributes:
        x_m: East of the world's origin, metres.
        y_m: North of the world's origin, metres.
        z_m: Above the ground, metres.
        heading_rad: Compass heading, clockwise from north, in [0, 2π).
    """

    x_m: float
    y_m: float
    z_m: float = 0.0
    heading_rad: float = 0.0

    def distance_to_m(self, x_m: float, y_m: float) -> float:
        """Return the horizontal distance to a point, metres."""
        return math.hypot(x_m - self.x_m, y_m - self.y_m)

    def bearing_to_rad(self, x_m: float, y_m: float) -> float:
        """Return the bearing of a point, in [-π, π), positive to the right of this pose's heading."""
        return normalise_bearing_rad(heading_towards_rad(self.x_m, self.y_m, x_m, y_m) - self.heading_rad)

    def ahead(self, distance_m: float, *, bearing_rad: float = 0.0) -> "Pose":
        """Return the pose that lies ``distance_m`` away in a bearing, facing on in that direction."""
        heading_rad = normalise_heading_rad(self.heading_rad + bearing_rad)
        return Pose(
            self.x_m + distance_m * math.sin(heading_rad),
            self.y_m + distance_m * math.cos(heading_rad),
            self.z_m,
            heading_rad,
        )

    def facing(self, heading_rad: float) -> "Pose":
        """Return the same position with another heading (any angle; it is normalised)."""
        return Pose(self.x_m, self.y_m, self.z_m, normalise_heading_rad(heading_rad))
