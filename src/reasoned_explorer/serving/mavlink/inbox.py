"""What the served autopilot does with a message that came. What is not understood, or not finite, does nothing."""

import math
from collections.abc import Callable
from typing import Any

from reasoned_explorer.geometry import normalise_heading_rad
from reasoned_explorer.geometry.frames import is_finite
from reasoned_explorer.serving.mavlink.pilot import ACCEPTED, DENIED, FARTHEST_M, UNSUPPORTED, Pilot, Target
from reasoned_explorer.serving.mavlink.teller import GROUND_MM, Teller
from reasoned_explorer.vehicles.mavlink.flavours import GCS_TYPE
from reasoned_explorer.vehicles.mavlink.setpoints import (
    LOCAL_NED,
    NO_POSITION,
    NO_VELOCITY,
    NO_YAW,
    NO_YAW_RATE,
)

Reply = Callable[[Any], None]
_FORCED = 21196
_GLOBAL_FRAMES, _RELATIVE_FRAMES = {0, 5}, {3, 6}
_SLOWEST_HZ, _FASTEST_HZ = 0.01, 50.0
#: Streams of the old kind and what they hold; 0 is all.
_STREAMS = {
    1: ("GPS_RAW_INT",),
    2: ("SYS_STATUS",),
    6: ("LOCAL_POSITION_NED", "GLOBAL_POSITION_INT"),
    10: ("ATTITUDE",),
    11: ("VFR_HUD",),
    12: ("BATTERY_STATUS", "SYSTEM_TIME"),
}


class Inbox:
    """Obeys and answers.

    Args:
        pilot: Who obeys.
        teller: Who tells.
        dialect: The module of messages.
        system: Who is meant.
    """

    def __init__(self, pilot: Pilot, teller: Teller, dialect: Any, *, system: int) -> None:
        self._pilot, self._teller, self._dialect, self._system = pilot, teller, dialect, system
        self._takers: dict[str, Callable[[Any, Reply], None]] = {
            "HEARTBEAT": self._heartbeat,
            "COMMAND_LONG": self._command_long,
            "COMMAND_INT": self._command_int,
            "SET_MODE": self._set_mode,
            "SET_POSITION_TARGET_LOCAL_NED": self._local_target,
            "SET_POSITION_TARGET_GLOBAL_INT": self._global_target,
            "PARAM_REQUEST_LIST": self._list_parameters,
            "PARAM_REQUEST_READ": self._read_parameter,
            "PARAM_SET": self._set_parameter,
            "MISSION_REQUEST_LIST": self._list_mission,
            "MISSION_CLEAR_ALL": self._clear_mission,
            "REQUEST_DATA_STREAM": self._stream,
            "PING": self._ping,
            "TIMESYNC": self._synchronise,
        }
        self._commands: dict[int, Callable[[tuple[float, ...], Reply], int]] = {
            16: lambda _, __: UNSUPPORTED,
            17: lambda _, __: pilot.change_mode(pilot.flavour.hold),
            20: lambda _, __: pilot.change_mode("RTL"),
            21: lambda _, __: pilot.change_mode("LAND") if pilot.flavour.flies else UNSUPPORTED,
            22: self._take_off,
            115: self._yaw,
            176: self._mode_command,
            178: lambda p, _: pilot.change_speed(p[1]),
            192: self._reposition,
            400: lambda p, _: self._arm(p),
            511: self._interval,
            512: self._request,
            520: lambda _, reply: self._tell("AUTOPILOT_VERSION", reply),
        }

    def take(self, message: Any, reply: Reply) -> None:
        """Take a message in."""
        taker = self._takers.get(message.get_type())
        if taker is not None and getattr(message, "target_system", 0) in {0, self._system}:
            taker(message, reply)

    # Who is there, and what is told to them.

    def _heartbeat(self, message: Any, _: Reply) -> None:
        if message.type == GCS_TYPE:
            self._pilot.hear_station()

    def _ping(self, message: Any, reply: Reply) -> None:
        if message.target_system == 0:
            to = message.get_srcSystem(), message.get_srcComponent()
            reply(self._dialect.MAVLink_ping_message(message.time_usec, message.seq, *to))

    def _synchronise(self, message: Any, reply: Reply) -> None:
        if message.tc1 == 0:
            reply(self._dialect.MAVLink_timesync_message(round(self._pilot.now_s * 1e9), message.ts1))

    def _stream(self, message: Any, _: Reply) -> None:
        wanted = _STREAMS.get(message.req_stream_id, ())
        names = [name for many in _STREAMS.values() for name in many] if message.req_stream_id == 0 else wanted
        for name in names:
            self._teller.rates_hz[name] = min(_FASTEST_HZ, float(message.req_message_rate * message.start_stop))

    def _tell(self, name: str, reply: Reply) -> int:
        reply(self._teller.make(name))
        return ACCEPTED

    def _interval(self, p: tuple[float, ...], _: Reply) -> int:
        name = self._teller.name_of(round(p[0]))
        if name is None:
            return UNSUPPORTED
        if p[1] < 0.0 and name != "HEARTBEAT":
            self._teller.rates_hz.pop(name, None)
        elif p[1] > 0.0:
            self._teller.rates_hz[name] = max(_SLOWEST_HZ, min(_FASTEST_HZ, 1e6 / p[1]))
        return ACCEPTED

    def _request(self, p: tuple[float, ...], reply: Reply) -> int:
        name = self._teller.name_of(round(p[0]))
        return UNSUPPORTED if name is None else self._tell(name, reply)

    # Parameters and missions.

    def _list_parameters(self, _: Any, reply: Reply) -> None:
        for name in self._pilot.parameters.names:
            self._tell_parameter(name, reply)

    def _read_parameter(self, message: Any, reply: Reply) -> None:
        name = self._pilot.parameters.name_of(_name(message.param_id), message.param_index)
        if name is not None:
            self._tell_parameter(name, reply)

    def _set_parameter(self, message: Any, reply: Reply) -> None:
        name = self._pilot.parameters.name_of(_name(message.param_id), -1)
        if name is not None:
            self._pilot.parameters.set(name, message.param_value)
            self._tell_parameter(name, reply)

    def _tell_parameter(self, name: str, reply: Reply) -> None:
        parameters = self._pilot.parameters
        value, kind = parameters.wire_value(name), parameters[name].kind
        place = len(parameters), parameters.names.index(name)
        reply(self._dialect.MAVLink_param_value_message(name.encode(), value, kind, *place))

    def _list_mission(self, message: Any, reply: Reply) -> None:
        to = message.get_srcSystem(), message.get_srcComponent()
        reply(self._dialect.MAVLink_mission_count_message(*to, 0, message.mission_type))

    def _clear_mission(self, message: Any, reply: Reply) -> None:
        to = message.get_srcSystem(), message.get_srcComponent()
        reply(self._dialect.MAVLink_mission_ack_message(*to, 0, message.mission_type))

    # Commands.

    def _command_long(self, message: Any, reply: Reply) -> None:
        self._command(message, (message.param5, message.param6, message.param7), reply)

    def _command_int(self, message: Any, reply: Reply) -> None:
        self._command(message, (message.x / 1e7, message.y / 1e7, message.z), reply)

    def _command(self, message: Any, rest: tuple[float, ...], reply: Reply) -> None:
        p = (message.param1, message.param2, message.param3, message.param4, *rest)
        obey = self._commands.get(message.command)
        # NaN stands for "as usual" in what commands do not need; what they need they check.
        result = UNSUPPORTED if obey is None else DENIED
        if obey is not None and not any(math.isinf(one) for one in p):
            try:
                result = obey(p, reply)
            except ValueError:  # rounding NaN
                result = DENIED
        to = message.get_srcSystem(), message.get_srcComponent()
        reply(self._dialect.MAVLink_command_ack_message(message.command, result, 0, 0, *to))
        if message.command in {17, 20, 21, 22, 176, 400} and result == ACCEPTED:
            self._tell("HEARTBEAT", reply)

    def _arm(self, p: tuple[float, ...]) -> int:
        forced = p[1] == _FORCED
        if p[0] not in {0.0, 1.0}:
            return DENIED
        return self._pilot.arm(forced=forced) if p[0] else self._pilot.disarm(forced=forced)

    def _take_off(self, p: tuple[float, ...], _: Reply) -> int:
        # PX4 takes heights above the sea.
        height_m = p[6] - GROUND_MM / 1000.0 if self._pilot.flavour.is_px4 else p[6]
        return self._pilot.take_off(height_m)

    def _yaw(self, p: tuple[float, ...], _: Reply) -> int:
        if not is_finite(p[0]):
            return DENIED
        here = self._pilot.belief()
        heading_rad = math.radians(p[0])
        if p[3] == 1.0:
            heading_rad = here.heading_rad + math.copysign(heading_rad, p[2] if p[2] else 1.0)
        return ACCEPTED if self._pilot.go(Target(heading_rad=normalise_heading_rad(heading_rad))) else DENIED

    def _mode_command(self, p: tuple[float, ...], _: Reply) -> int:
        number = round(p[1])
        return self._mode(number << 16 | round(p[2]) << 24 if self._pilot.flavour.is_px4 else number)

    def _set_mode(self, message: Any, reply: Reply) -> None:
        if self._mode(message.custom_mode) == ACCEPTED:
            self._tell("HEARTBEAT", reply)

    def _mode(self, number: int) -> int:
        pilot = self._pilot
        name = next((name for name, one in pilot.flavour.modes.items() if one == number), None)
        return DENIED if name is None else pilot.change_mode(name)

    def _reposition(self, p: tuple[float, ...], _: Reply) -> int:
        z_m = p[6] if is_finite(p[6]) else self._pilot.belief().z_m
        target = self._on_earth(p[4], p[5], z_m, math.nan)
        return ACCEPTED if target is not None and self._pilot.go(target) else DENIED

    # Setpoints.

    def _local_target(self, message: Any, _: Reply) -> None:
        if message.coordinate_frame != LOCAL_NED:
            return
        x_m, y_m, z_m = self._teller.home.enu_m(message.x, message.y, message.z)
        self._go(message, Target(x_m, y_m, z_m, message.yaw))

    def _global_target(self, message: Any, _: Reply) -> None:
        frame = message.coordinate_frame
        if frame in _GLOBAL_FRAMES | _RELATIVE_FRAMES:
            z_m = message.alt - (GROUND_MM / 1000.0 if frame in _GLOBAL_FRAMES else 0.0)
            target = self._on_earth(message.lat_int / 1e7, message.lon_int / 1e7, z_m, message.yaw)
            if target is not None:
                self._go(message, target)

    def _go(self, message: Any, target: Target) -> None:
        """Go where a message says, by what of it counts: a place, a heading, or a velocity of nothing."""
        mask = message.type_mask
        has_place, has_velocity, has_yaw = not mask & NO_POSITION, not mask & NO_VELOCITY, not mask & NO_YAW
        if has_place and not self._is_near(target):
            return
        if has_yaw and not is_finite(target.heading_rad):
            return
        if not has_place and has_velocity and any((message.vx, message.vy, message.vz)):
            if is_finite(message.vx, message.vy, message.vz):
                heading_rad = target.heading_rad if has_yaw else math.nan
                self._pilot.go_at(message.vy, message.vx, -message.vz, heading_rad)
            return
        if not (has_place or has_velocity or has_yaw):
            # What is left is a turn rate: nothing's stands; turning on and on is not served.
            if mask & NO_YAW_RATE or message.yaw_rate != 0.0:
                return
        elif self._turns_north(
            has_place=has_place, has_velocity=has_velocity, has_yaw=has_yaw, is_free=bool(mask & NO_YAW_RATE)
        ):
            target = target._replace(heading_rad=0.0)
            has_yaw = True
        place = target[:3] if has_place else (math.nan,) * 3
        self._pilot.go(Target(*place, target.heading_rad if has_yaw else math.nan))

    def _turns_north(self, *, has_place: bool, has_velocity: bool, has_yaw: bool, is_free: bool) -> bool:
        """Whether a velocity of nothing, whose direction is north, is taken for a heading: ArduPilot's rovers do so."""
        flavour = self._pilot.flavour
        return has_velocity and is_free and not (has_place or has_yaw or flavour.flies or flavour.is_px4)

    def _is_near(self, target: Target) -> bool:
        home = self._pilot.drone.start
        ways = target.x_m - home.x_m, target.y_m - home.y_m, target.z_m
        return is_finite(*ways) and all(abs(one) <= FARTHEST_M for one in ways)

    def _on_earth(self, lat_deg: float, lon_deg: float, z_m: float, heading_rad: float) -> Target | None:
        if not (is_finite(lat_deg, lon_deg) and abs(lat_deg) <= 90.0 and abs(lon_deg) <= 180.0):
            return None
        target = Target(*self._teller.enu_m(lat_deg, lon_deg), z_m, heading_rad)
        return target if self._is_near(target) else None


def _name(value: object) -> str:
    return value.decode("ascii", "replace") if isinstance(value, bytes) else str(value)
