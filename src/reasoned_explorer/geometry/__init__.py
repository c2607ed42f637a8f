"""Positions, headings and frames.

**The convention, stated once.** Positions are in metres in a local East-North-Up frame (ENU): ``x_m`` to the east,
``y_m`` to the north, ``z_m`` up, zero at the ground. Headings are compass headings in radians: 0 is north, growing
clockwise, π/2 is east, always in [0, 2π). A *bearing* is relative to a heading: positive to the right, in [-π, π).
Degrees appear only where people read or type them, in names that end in ``_deg``.
"""

from reasoned_explorer.geometry.angles import (
    bearing_between_rad,
    heading_towards_rad,
    normalise_bearing_rad,
    normalise_heading_rad,
)
from reasoned_explorer.geometry.frames import GeoOrigin, enu_from_ned, ned_from_enu
from reasoned_explorer.geometry.pose import Pose

__all__ = [
    "GeoOrigin",
    "Pose",
    "bearing_between_rad",
    "enu_from_ned",
    "heading_towards_rad",
    "ned_from_enu",
    "normalise_bearing_rad",
    "normalise_heading_rad",
]
