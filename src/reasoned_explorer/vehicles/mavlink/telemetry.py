"""What an autopilot says of itself, kept as it comes. What makes no sense is not kept."""

import math
from dataclasses import dataclass
from typing import Any

from reasoned_explorer.geometry.frames import is_finite
from reasoned_explorer.vehicles.mavlink.dialect import text_of
from reasoned_explorer.vehicles.mavlink.flavours import Flavour, flavour_of

#: Texts that say that something is wrong: from "emergency" to "error".
_WORST, _ERROR = 0, 3
_ARMED = 128
#: Flags of EKF_STATUS_REPORT (ArduPilot) and ESTIMATOR_STATUS (PX4), which are the same: attitude, horizontal velocity
#: and position are good; the filter assumes that nothing moves since it knows no position.
_NEEDED_FLAGS, _NO_POSITION = 0b1_0011, 0b1000_0000
_NO_VALUE_16, _NO_VALUE_32 = 0xFFFF, 0xFFFFFFFF
#: EXTENDED_SYS_STATE.
_ON_GROUND = 1
#: From which GPS_FIX_TYPE on there is a fix.
_2D_FIX = 2
#: Messages that tell the autopilot's own time.
_TIMED = frozenset({"ATTITUDE", "LOCAL_POSITION_NED", "GLOBAL_POSITION_INT"})
#: DISTANCE_SENSOR: one that looks ahead; what it told counts for so long, seconds.
_AHEAD, _RANGE_AGE_S = 0, 1.0


@dataclass(frozen=True, slots=True)
class Heartbeat:
    """What a heartbeat says.

    Attributes:
        at_s: When it came, seconds of the loop's time.
        flavour: Which autopilot on which machine; None for one that this package does not know.
        custom_mode: Its mode.
        armed: Whether its motors are on.
    """

    at_s: float
    flavour: Flavour | None
    custom_mode: int
    armed: bool

    @property
    def mode(self) -> str:
        """The mode's name."""
        return f"mode {self.custom_mode}" if self.flavour is None else self.flavour.mode_name(self.custom_mode)


@dataclass(frozen=True, slots=True)
class Kinematics:
    """Where the autopilot takes the machine to be, north, east and down of its origin, metres and metres a second."""

    at_s: float
    north_m: float
    east_m: float
    down_m: float
    north_mps: float
    east_mps: float
    down_mps: float


@dataclass(frozen=True, slots=True)
class GlobalPosition:
    """Likewise on earth: degrees, and metres above home."""

    at_s: float
    lat_deg: float
    lon_deg: float
    above_home_m: float
    north_mps: float
    east_mps: float


@dataclass(frozen=True, slots=True)
class Battery:
    """What is left.

    Attributes:
        voltage_v: Volts, or None where it is not measured.
        remaining: Its share, 0 to 1, or None.
    """

    voltage_v: float | None
    remaining: float | None


@dataclass(frozen=True, slots=True)
class PositionQuality:
    """How good the autopilot's position is.

    Attributes:
        fix_type: As GPS_RAW_INT has it: 0 and 1 none, 2 and 3 by satellites alone, 4 DGPS, 5 RTK float, 6 RTK fixed.
        satellites: How many are used, or None.
        horizontal_error_m: As the receiver has it, metres, or None.
        filter_is_good: Whether the autopilot's filter says that attitude, velocity and position are good; None where it
            says nothing.
    """

    fix_type: int = 0
    satellites: int | None = None
    horizontal_error_m: float | None = None
    filter_is_good: bool | None = None


class Telemetry:
    """Takes in messages of one autopilot."""

    def __init__(self) -> None:
        self.heartbeat: Heartbeat | None = None
        self.local: Kinematics | None = None
        self.globe: GlobalPosition | None = None
        self.yaw_rad: float | None = None
        self.yaw_at_s = -math.inf
        self.yaw_rate_radps: float | None = None
        #: When anything was last heard, seconds of the loop's time.
        self.heard_at_s = -math.inf
        #: The autopilot's own time, seconds since it was switched on, and when that was heard.
        self.boot_s, self.boot_at_s = 0.0, -math.inf
        #: When it last knew its place, and last had a fix, on its own time; None before it first did.
        self.place_boot_s: float | None = None
        self.fix_boot_s: float | None = None
        self._fix_us = -1
        self.battery = Battery(None, None)
        self.position = PositionQuality()
        self.is_landed: bool | None = None
        #: To what stands ahead, metres, infinite for nothing in reach, and when that was told; None where nobody tells.
        self.ahead: tuple[float, float] | None = None
        #: The last texts that say that something is wrong, oldest first.
        self.texts: tuple[str, ...] = ()
        self.texts_seen = 0

    def take(self, message: Any, now_s: float) -> None:
        """Take in a message."""
        kind = message.get_type()
        self.heard_at_s = now_s
        if kind in _TIMED:
            self.boot_s, self.boot_at_s = message.time_boot_ms / 1000.0, now_s
        reader = _READERS.get(kind)
        if reader is not None:
            reader(self, message, now_s)

    def _heartbeat(self, message: Any, now_s: float) -> None:
        flavour = flavour_of(message.autopilot, message.type)
        self.heartbeat = Heartbeat(now_s, flavour, message.custom_mode, bool(message.base_mode & _ARMED))

    def _local(self, message: Any, now_s: float) -> None:
        numbers = message.x, message.y, message.z, message.vx, message.vy, message.vz
        if is_finite(*numbers):
            self.local = Kinematics(now_s, *numbers)
            self.place_boot_s = self.boot_s

    def _globe(self, message: Any, now_s: float) -> None:
        lat_deg, lon_deg = message.lat / 1e7, message.lon / 1e7
        if (message.lat, message.lon) != (0, 0) and abs(lat_deg) <= 90.0 and abs(lon_deg) <= 180.0:
            speeds = message.vx / 100.0, message.vy / 100.0
            self.globe = GlobalPosition(now_s, lat_deg, lon_deg, message.relative_alt / 1000.0, *speeds)
            self.place_boot_s = self.boot_s

    def _attitude(self, message: Any, now_s: float) -> None:
        if is_finite(message.yaw):
            self.yaw_rad, self.yaw_at_s = message.yaw % (2.0 * math.pi), now_s
            self.yaw_rate_radps = message.yawspeed if is_finite(message.yawspeed) else None

    def _power(self, message: Any, _: float) -> None:
        millivolts = message.voltage_battery
        voltage_v = None if millivolts in {0, _NO_VALUE_16} else millivolts / 1000.0
        self.battery = Battery(voltage_v, _share(message.battery_remaining))

    def _battery(self, message: Any, _: float) -> None:
        if message.id == 0:
            cells = [one for one in message.voltages if one != _NO_VALUE_16]
            voltage_v = sum(cells) / 1000.0 if cells else self.battery.voltage_v
            remaining = _share(message.battery_remaining)
            self.battery = Battery(voltage_v, self.battery.remaining if remaining is None else remaining)

    def _gps(self, message: Any, _: float) -> None:
        satellites = None if message.satellites_visible == 255 else message.satellites_visible
        error_m = None if message.h_acc in {0, _NO_VALUE_32} else message.h_acc / 1000.0
        self.position = PositionQuality(message.fix_type, satellites, error_m, self.position.filter_is_good)
        if math.isinf(self.boot_at_s):
            return  # its own time was not heard yet: the fix would be taken to be as old as the machine has been on
        # The same fix told again is no newer; who tells no time tells it anew.
        if message.fix_type >= _2D_FIX and (message.time_usec != self._fix_us or message.time_usec == 0):
            self._fix_us, self.fix_boot_s = message.time_usec, self.boot_s

    def _filter(self, message: Any, _: float) -> None:
        is_good = message.flags & _NEEDED_FLAGS == _NEEDED_FLAGS and not message.flags & _NO_POSITION
        old = self.position
        self.position = PositionQuality(old.fix_type, old.satellites, old.horizontal_error_m, is_good)

    def _landed(self, message: Any, _: float) -> None:
        if message.landed_state != 0:
            self.is_landed = message.landed_state == _ON_GROUND

    def _distance(self, message: Any, now_s: float) -> None:
        if message.orientation != _AHEAD:
            return
        is_free = message.current_distance >= message.max_distance
        self.ahead = math.inf if is_free else message.current_distance / 100.0, now_s

    def range_ahead_m(self, now_s: float) -> float | None:
        """Return how far it is to what stands ahead, metres; None where that is not told, or was long ago."""
        if self.ahead is None or now_s - self.ahead[1] > _RANGE_AGE_S:
            return None
        return self.ahead[0]

    def _text(self, message: Any, _: float) -> None:
        if _WORST <= message.severity <= _ERROR:
            self.texts = (*self.texts[-19:], text_of(message.text))
            self.texts_seen += 1


_READERS = {
    "HEARTBEAT": Telemetry._heartbeat,
    "LOCAL_POSITION_NED": Telemetry._local,
    "GLOBAL_POSITION_INT": Telemetry._globe,
    "ATTITUDE": Telemetry._attitude,
    "SYS_STATUS": Telemetry._power,
    "BATTERY_STATUS": Telemetry._battery,
    "GPS_RAW_INT": Telemetry._gps,
    "EKF_STATUS_REPORT": Telemetry._filter,
    "ESTIMATOR_STATUS": Telemetry._filter,
    "EXTENDED_SYS_STATE": Telemetry._landed,
    "STATUSTEXT": Telemetry._text,
    "DISTANCE_SENSOR": Telemetry._distance,
}


def _share(percent: int) -> float | None:
    return percent / 100.0 if 0 <= percent <= 100 else None
