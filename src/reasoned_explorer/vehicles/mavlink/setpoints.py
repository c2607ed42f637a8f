"""Where an autopilot is told to go: setpoints, and the masks that say which of their numbers count.

A bit of the mask that is set means that the number is *not* to be used: 0 to 2 position, 3 to 5 velocity, 6 to 8
acceleration, 10 yaw, 11 yaw rate.
"""

import math
from dataclasses import dataclass
from typing import Any

from reasoned_explorer.geometry import GeoOrigin

#: Frames of the enumeration MAV_FRAME: north, east, down of the origin; on earth, with heights above home.
LOCAL_NED, GLOBAL_RELATIVE_ALT = 1, 6
NO_POSITION, NO_VELOCITY, NO_ACCELERATION, NO_YAW, NO_YAW_RATE = 0b111, 0b111000, 0b111000000, 1 << 10, 1 << 11


@dataclass(frozen=True, slots=True)
class Setpoint:
    """What is streamed.

    Attributes:
        north_m: Of the origin, metres; NaN where the position does not count. Then the machine is to stand.
        east_m: Likewise.
        down_m: Likewise.
        yaw_rad: The heading to take, or NaN for any.
        by_turn_rate: Whether one that is to stand is told a turn rate of nothing rather than a velocity of nothing.
        velocity_mps: How fast to go north, east and down where no position counts; ArduPilot gives it up where it does
            not hear it anew.
    """

    north_m: float = math.nan
    east_m: float = math.nan
    down_m: float = math.nan
    yaw_rad: float = math.nan
    by_turn_rate: bool = False
    velocity_mps: tuple[float, float, float] | None = None

    @property
    def mask(self) -> int:
        """The mask that says what counts."""
        mask = NO_ACCELERATION | NO_YAW_RATE
        if math.isnan(self.yaw_rad):
            mask |= NO_YAW
        if not math.isnan(self.north_m):
            return mask | NO_VELOCITY
        if self.velocity_mps is not None:
            return mask | NO_POSITION
        if not math.isnan(self.yaw_rad):
            return mask | NO_POSITION | NO_VELOCITY  # turns in place
        if self.by_turn_rate:
            return (mask & ~NO_YAW_RATE) | NO_POSITION | NO_VELOCITY
        return mask | NO_POSITION

    def message(self, dialect: Any, to: tuple[int, int], *, boot_ms: int, origin: GeoOrigin | None) -> Any:
        """Return the message that says so.

        Args:
            dialect: The module of messages.
            to: Which system and component.
            boot_ms: The sender's time, milliseconds.
            origin: Of the local frame, where the setpoint is to be sent as a position on earth.
        """
        place = [0.0 if math.isnan(one) else one for one in (self.north_m, self.east_m, self.down_m)]
        velocity = self.velocity_mps or (0.0, 0.0, 0.0)
        rest = (*velocity, *(0.0,) * 3, 0.0 if math.isnan(self.yaw_rad) else _wrapped(self.yaw_rad), 0.0)
        if origin is None or math.isnan(self.north_m):
            return dialect.MAVLink_set_position_target_local_ned_message(
                boot_ms, *to, LOCAL_NED, self.mask, *place, *rest
            )
        lat_deg, lon_deg = origin.geodetic_from_enu_deg(place[1], place[0])
        earth = round(lat_deg * 1e7), round(lon_deg * 1e7), -place[2]
        frame = GLOBAL_RELATIVE_ALT
        return dialect.MAVLink_set_position_target_global_int_message(boot_ms, *to, frame, self.mask, *earth, *rest)


def standing(*, flies: bool) -> Setpoint:
    """Return what has a machine of ArduPilot stand.

    A drone is told a velocity of nothing. A rover takes the direction of a velocity for the heading to turn to, and
    nothing's direction is north: it is told not to turn, which has it stand, too.

    Args:
        flies: Whether it is a drone.
    """
    return Setpoint(by_turn_rate=not flies)


def _wrapped(yaw_rad: float) -> float:
    """Return a yaw in [-π, π), as autopilots tell it."""
    return (yaw_rad + math.pi) % (2.0 * math.pi) - math.pi
