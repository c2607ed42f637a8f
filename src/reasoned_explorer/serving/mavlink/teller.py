"""What the served autopilot tells of itself, message by message."""

import math
from collections.abc import Callable
from typing import Any

from reasoned_explorer.geometry import normalise_bearing_rad
from reasoned_explorer.geometry.frames import NOWHERE
from reasoned_explorer.serving.airsim.flight import State
from reasoned_explorer.serving.mavlink.pilot import Pilot
from reasoned_explorer.simulation.mishaps import MishapKind
from reasoned_explorer.vehicles.airsim.conventions import HomeFrame
from reasoned_explorer.vehicles.mavlink.flavours import ARDUCOPTER

#: What the filter says of itself: ArduPilot's message and PX4's.
FILTERS = ("EKF_STATUS_REPORT", "ESTIMATOR_STATUS")
#: How often each message is sent until somebody asks otherwise, times a second; those that are not here, when asked.
RATES_HZ = {
    "HEARTBEAT": 1.0,
    "SYS_STATUS": 1.0,
    "SYSTEM_TIME": 1.0,
    "GPS_RAW_INT": 2.0,
    "ATTITUDE": 4.0,
    "LOCAL_POSITION_NED": 4.0,
    "GLOBAL_POSITION_INT": 4.0,
    "VFR_HUD": 2.0,
    "BATTERY_STATUS": 0.5,
    "HOME_POSITION": 0.5,
    "EXTENDED_SYS_STATE": 1.0,
}
#: What whoever holds time is told with each report, where it stands; those with the time since the start come first.
FRESH = ("ATTITUDE", "LOCAL_POSITION_NED", "GLOBAL_POSITION_INT", "GPS_RAW_INT", "SYS_STATUS", *FILTERS)
#: The height of the ground above the sea, millimetres; worlds are flat.
GROUND_MM = 122_000
_FULL_V, _EMPTY_V = 12.6, 10.5
_CUSTOM, _GUIDED, _STABILISED, _ARMED = 1, 8, 16, 128
_STANDBY, _ACTIVE = 3, 4
_MAVLINK_VERSION = 3
#: Gyro, accelerometer, compass, barometer, GPS, battery, and that nothing speaks against arming.
_SENSORS = 0x1 | 0x2 | 0x4 | 0x8 | 0x20 | 0x200_0000 | 0x1000_0000
#: Attitude, velocities and positions are good, heights above the ground too.
_FILTER_FLAGS = 0b11_1111
#: What is spoken: whole numbers for places, setpoints local and global, MAVLink 2; and how parameters travel, which is
#: as bytes in the place of a float's (PX4) or as floats.
_CAPABILITIES, _AS_BYTES, _AS_FLOATS = 0x8 | 0x80 | 0x100 | 0x2000, 0x10, 0x2
_VERSIONS = {True: 0x0405_06FF, False: 0x010E_00FF}
_FIXES = {"single": 3, "rtk-float": 5}
_RTK_FIXED = 6
_BATTERY_GONE = 65535
_NO_FIX, _UNKNOWN = 1, 65535
#: So long the filter goes on without satellites, seconds; then it says that it knows no position.
_ALONE_S = 5.0
#: The bits of the horizontal positions, and the one that says that it assumes to stand.
_PLACE_FLAGS, _ASSUMES_TO_STAND = 0b1_1000, 0b1000_0000


class Teller:
    """Makes messages.

    Args:
        pilot: Of whom they tell.
        dialect: The module of messages.
        noise: The name of how the sensors err; it decides which kind of fix is told.
    """

    def __init__(self, pilot: Pilot, dialect: Any, *, noise: str) -> None:
        self._pilot, self._dialect, self._fix = pilot, dialect, _FIXES.get(noise, _RTK_FIXED)
        start = pilot.drone.start
        self.home = HomeFrame(start.x_m, start.y_m, 0.0)
        origin = pilot.drone.atlas.world.origin
        self._shift_m = (0.0, 0.0) if origin is not None else (start.x_m, start.y_m)
        self._origin = origin or NOWHERE
        filter_name = FILTERS[pilot.flavour.is_px4]
        self.rates_hz = {**RATES_HZ, filter_name: 1.0}
        self._makers: dict[str, Callable[[State], Any]] = {
            "HEARTBEAT": self._heartbeat,
            "SYS_STATUS": self._status,
            "SYSTEM_TIME": self._time,
            "GPS_RAW_INT": self._gps,
            "ATTITUDE": self._attitude,
            "LOCAL_POSITION_NED": self._local,
            "GLOBAL_POSITION_INT": self._globe,
            "VFR_HUD": self._hud,
            "BATTERY_STATUS": self._battery,
            "HOME_POSITION": self._home_position,
            "EXTENDED_SYS_STATE": self._landed,
            filter_name: self._estimator if pilot.flavour.is_px4 else self._filter,
            "AUTOPILOT_VERSION": self._version,
            "GPS_GLOBAL_ORIGIN": self._global_origin,
        }
        self._names = {getattr(dialect, f"MAVLINK_MSG_ID_{name}"): name for name in self._makers}

    def name_of(self, number: int) -> str | None:
        """Return which message has a number; None for one that is not made here."""
        return self._names.get(number)

    def make(self, name: str) -> Any:
        """Return a message."""
        return self._makers[name](self._pilot.belief())

    def enu_m(self, lat_deg: float, lon_deg: float) -> tuple[float, float]:
        """Return a place on earth in the world's frame, metres east and north."""
        east_m, north_m = self._origin.enu_from_geodetic_m(lat_deg, lon_deg)
        return float(east_m) + self._shift_m[0], float(north_m) + self._shift_m[1]

    def _geo(self, x_m: float, y_m: float) -> tuple[int, int]:
        lat_deg, lon_deg = self._origin.geodetic_from_enu_deg(x_m - self._shift_m[0], y_m - self._shift_m[1])
        return round(lat_deg * 1e7), round(lon_deg * 1e7)

    @property
    def _silent_s(self) -> float:
        """For how long the satellites have been silent."""
        return self._pilot.mishaps.silent_s(MishapKind.POSITION_SILENCE, self._pilot.now_s)

    @property
    def _flags(self) -> int:
        """What the filter says of itself."""
        return _FILTER_FLAGS if self._silent_s <= _ALONE_S else (_FILTER_FLAGS & ~_PLACE_FLAGS) | _ASSUMES_TO_STAND

    @property
    def _boot_ms(self) -> int:
        return round(self._pilot.now_s * 1000.0) % 2**32

    @property
    def _boot_us(self) -> int:
        return round(self._pilot.now_s * 1e6)

    def _heartbeat(self, _: State) -> Any:
        pilot, flavour = self._pilot, self._pilot.flavour
        flags = _CUSTOM | _STABILISED | _ARMED * pilot.is_armed | _GUIDED * pilot.is_guided
        state = _ACTIVE if pilot.is_armed else _STANDBY
        mode = flavour.modes[pilot.mode]
        kind = self._dialect.MAVLink_heartbeat_message
        return kind(flavour.vehicle_type, flavour.autopilot, flags, mode, state, _MAVLINK_VERSION)

    def _status(self, _: State) -> Any:
        millivolts, percent = self._charge()
        kind = self._dialect.MAVLink_sys_status_message
        return kind(_SENSORS, _SENSORS, _SENSORS, 250, millivolts, -1, percent, 0, 0, 0, 0, 0, 0)

    def _time(self, _: State) -> Any:
        return self._dialect.MAVLink_system_time_message(0, self._boot_ms)

    def _gps(self, here: State) -> Any:
        if self._silent_s > 0.0:
            nowhere = self._dialect.MAVLink_gps_raw_int_message
            return nowhere(self._boot_us, _NO_FIX, 0, 0, 0, _UNKNOWN, _UNKNOWN, _UNKNOWN, _UNKNOWN, 0)
        lat, lon = self._geo(here.x_m, here.y_m)
        speed = min(65534, round(100.0 * math.hypot(here.vx_mps, here.vy_mps)))
        course = round(math.degrees(math.atan2(here.vx_mps, here.vy_mps)) * 100.0) % 36000
        height_mm = GROUND_MM + round(1000.0 * here.z_m)
        error_mm = {3: 2500, 5: 300}.get(self._fix, 15)
        accuracies = (error_mm, 2 * error_mm, 100, 0)
        kind = self._dialect.MAVLink_gps_raw_int_message
        return kind(self._boot_us, self._fix, lat, lon, height_mm, 70, 120, speed, course, 18, height_mm, *accuracies)

    def _attitude(self, here: State) -> Any:
        yaw_rad = normalise_bearing_rad(here.heading_rad)
        kind = self._dialect.MAVLink_attitude_message
        return kind(self._boot_ms, 0.0, 0.0, yaw_rad, 0.0, 0.0, here.yaw_rate_radps)

    def _local(self, here: State) -> Any:
        ned_m = self.home.ned_m(here.x_m, here.y_m, here.z_m)
        velocity = here.vy_mps, here.vx_mps, -here.vz_mps
        return self._dialect.MAVLink_local_position_ned_message(self._boot_ms, *ned_m, *velocity)

    def _globe(self, here: State) -> Any:
        above_mm = round(1000.0 * here.z_m)
        velocity = (round(max(-300.0, min(300.0, one)) * 100.0) for one in (here.vy_mps, here.vx_mps, -here.vz_mps))
        heading = round(math.degrees(here.heading_rad) * 100.0) % 36000
        place = self._geo(here.x_m, here.y_m)
        kind = self._dialect.MAVLink_global_position_int_message
        return kind(self._boot_ms, *place, GROUND_MM + above_mm, above_mm, *velocity, heading)

    def _hud(self, here: State) -> Any:
        speed, heading = math.hypot(here.vx_mps, here.vy_mps), round(math.degrees(here.heading_rad)) % 360
        throttle = 50 if self._pilot.is_armed else 0
        height_m = GROUND_MM / 1000.0 + here.z_m
        return self._dialect.MAVLink_vfr_hud_message(speed, speed, heading, throttle, height_m, here.vz_mps)

    def _battery(self, _: State) -> Any:
        millivolts, percent = self._charge()
        cells = [millivolts, *[_BATTERY_GONE] * 9]
        return self._dialect.MAVLink_battery_status_message(0, 0, 1, 2500, cells, -1, -1, -1, percent)

    def _home_position(self, _: State) -> Any:
        start = self._pilot.drone.start
        level = [1.0, 0.0, 0.0, 0.0]
        kind = self._dialect.MAVLink_home_position_message
        return kind(*self._geo(start.x_m, start.y_m), GROUND_MM, 0.0, 0.0, 0.0, level, 0.0, 0.0, 0.0, self._boot_us)

    def _global_origin(self, _: State) -> Any:
        start = self._pilot.drone.start
        kind = self._dialect.MAVLink_gps_global_origin_message
        return kind(*self._geo(start.x_m, start.y_m), GROUND_MM, self._boot_us)

    def _landed(self, _: State) -> Any:
        return self._dialect.MAVLink_extended_sys_state_message(0, 1 if self._pilot.is_landed else 2)

    def _filter(self, _: State) -> Any:
        return self._dialect.MAVLink_ekf_status_report_message(self._flags, 0.05, 0.05, 0.05, 0.05, 0.0)

    def _estimator(self, _: State) -> Any:
        ratios = (0.05,) * 6
        return self._dialect.MAVLink_estimator_status_message(self._boot_us, self._flags, *ratios, 0.1, 0.1)

    def _version(self, _: State) -> Any:
        flown = _VERSIONS[self._pilot.flavour.name == ARDUCOPTER.name]
        nothing = [0] * 8
        kind = self._dialect.MAVLink_autopilot_version_message
        spoken = _CAPABILITIES | (_AS_BYTES if self._pilot.flavour.is_px4 else _AS_FLOATS)
        return kind(spoken, flown, 0, 0, 0, nothing, nothing, nothing, 0, 0, 0)

    def _charge(self) -> tuple[int, int]:
        share = self._pilot.battery
        return round(1000.0 * (_EMPTY_V + share * (_FULL_V - _EMPTY_V))), round(100.0 * share)
