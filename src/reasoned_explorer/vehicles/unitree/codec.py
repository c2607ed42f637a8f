"""The packets of a Go1 as bytes: HighCmd, 129 of them, and HighState, 1,087; little-endian and without gaps."""

import math
import struct
from collections.abc import Callable, Iterable
from typing import Any

from reasoned_explorer.model import Fault, InputError
from reasoned_explorer.vehicles.unitree.checksum import packet_crc, scrambled
from reasoned_explorer.vehicles.unitree.messages import (
    HEAD,
    HIGH_LEVEL,
    BatteryReading,
    Gait,
    HighCommand,
    HighState,
    ImuReading,
    Mode,
    MotorReading,
)

# head, level flag, frame reserve, serial number, version, band width
_HEADER = "2B B B 2I 2I H"
_TAIL = "40s I I"  # the remote control, reserve, checksum

#: mode, gait, speed level; foot raise, body height, position, euler, velocity, yaw rate; battery; LEDs
_COMMAND = struct.Struct(f"<{_HEADER} 3B 10f B3x 12B {_TAIL}")
_IMU = struct.Struct("<13f b")
_MOTOR = struct.Struct("<B 7f b 2I")
_BATTERY = struct.Struct("<4B i H 2b 2b 10H")
_MOTORS = 20
_REMOTE_BYTES = 40
_STATE_HEAD = struct.Struct(f"<{_HEADER}")
#: feet; mode, progress; gait, foot raise, odometry, body height, velocity, yaw rate, ranges; feet; tail
_STATE_TAIL = struct.Struct(f"<4h 4h B f B 13f 24f {_TAIL}")

COMMAND_BYTES = _COMMAND.size
STATE_BYTES = _STATE_HEAD.size + _IMU.size + _MOTORS * _MOTOR.size + _BATTERY.size + _STATE_TAIL.size
_CRC = struct.Struct("<I")


class PacketError(InputError):
    """A packet that is none of the protocol, or a message that cannot be made into one."""


def encode_command(command: HighCommand) -> bytes:
    """Return the 129 bytes of a command, its checksum included.

    Raises:
        PacketError: If a number is not finite or does not fit its field.
    """
    floats = (
        command.foot_raise_m,
        command.body_height_m,
        *command.position_m,
        *command.euler_rad,
        command.forward_mps,
        command.left_mps,
        command.yaw_rate_left_radps,
    )
    _finite("HighCmd", floats)
    return _sealed(
        "HighCmd",
        lambda: _COMMAND.pack(
            *_header(command),
            command.mode,
            command.gait,
            command.speed_level,
            *floats,
            command.battery_off,
            *command.led_rgb,
            *_tail(command),
        ),
        COMMAND_BYTES,
        _plain_crc,
    )


def decode_command(packet: bytes) -> HighCommand:
    """Return the command that a packet holds.

    Raises:
        PacketError: If its length, head, checksum, mode or gait is wrong, or a number is not finite; with all faults.
    """
    _check("HighCmd", packet, COMMAND_BYTES, _plain_crc)
    values = _COMMAND.unpack(packet)
    mode, gait, speed_level = values[9:12]
    floats = values[12:22]
    faults = _not_finite(floats)
    if mode not in _MODES:
        faults.append(Fault(f"mode {mode}", "a mode from 0 to 8"))
    if gait not in _GAITS:
        faults.append(Fault(f"gait {gait}", "a gait from 0 to 4"))
    if faults:
        raise PacketError("HighCmd", faults)
    return HighCommand(
        Mode(mode),
        Gait(gait),
        speed_level,
        foot_raise_m=floats[0],
        body_height_m=floats[1],
        position_m=floats[2:4],
        euler_rad=floats[4:7],
        forward_mps=floats[7],
        left_mps=floats[8],
        yaw_rate_left_radps=floats[9],
        battery_off=values[22],
        led_rgb=values[23:35],
        wireless_remote=values[35],
        serial_number=values[4:6],
        version=values[6:8],
        band_width=values[8],
        frame_reserve=values[3],
        reserve=values[36],
    )


def encode_state(state: HighState) -> bytes:
    """Return the 1,087 bytes of a state, its checksum included.

    Raises:
        PacketError: If a number is not finite or does not fit its field.
    """
    imu, battery = state.imu, state.battery
    inertial = (*imu.quaternion, *imu.gyroscope_radps, *imu.accelerometer_mps2, *imu.rpy_rad)
    motion = (
        state.foot_raise_m,
        *state.odometry_m,
        state.body_height_m,
        *state.velocity_mps,
        state.yaw_rate_left_radps,
        *state.range_obstacle_m,
    )
    feet = [value for triple in (*state.foot_position_m, *state.foot_velocity_mps) for value in triple]
    _finite("HighState", (*inertial, state.progress, *motion, *feet))
    _finite("HighState", [value for motor in state.motors for value in _motor_floats(motor)])
    return _sealed(
        "HighState",
        lambda: b"".join(
            (
                _STATE_HEAD.pack(*_header(state)),
                _IMU.pack(*inertial, imu.temperature_c),
                *(
                    _MOTOR.pack(motor.mode, *_motor_floats(motor), motor.temperature_c, *motor.reserve)
                    for motor in state.motors
                ),
                _BATTERY.pack(
                    *battery.version,
                    battery.status,
                    battery.charge_percent,
                    battery.current_ma,
                    battery.cycles,
                    *battery.battery_temperature_c,
                    *battery.board_temperature_c,
                    *battery.cell_voltage_mv,
                ),
                _STATE_TAIL.pack(
                    *state.foot_force,
                    *state.foot_force_estimate,
                    state.mode,
                    state.progress,
                    state.gait,
                    *motion,
                    *feet,
                    *_tail(state),
                ),
            )
        ),
        STATE_BYTES,
        _state_crc,
    )


def decode_state(packet: bytes) -> HighState:
    """Return the state that a packet holds.

    Raises:
        PacketError: If its length, head or checksum is wrong, or a number is not finite; with all faults.
    """
    _check("HighState", packet, STATE_BYTES, _state_crc)
    at = 0
    head = _STATE_HEAD.unpack_from(packet, at)
    at += _STATE_HEAD.size
    inertial = _IMU.unpack_from(packet, at)
    at += _IMU.size
    motors = [_MOTOR.unpack_from(packet, at + number * _MOTOR.size) for number in range(_MOTORS)]
    at += _MOTORS * _MOTOR.size
    battery = _BATTERY.unpack_from(packet, at)
    at += _BATTERY.size
    tail = _STATE_TAIL.unpack_from(packet, at)
    motion, feet = tail[11:24], tail[24:48]
    faults = _not_finite((*inertial[:13], tail[9], *motion, *feet, *(x for motor in motors for x in motor[1:8])))
    if faults:
        raise PacketError("HighState", faults)
    return HighState(
        imu=ImuReading(inertial[0:4], inertial[4:7], inertial[7:10], inertial[10:13], inertial[13]),
        motors=tuple(_motor(values) for values in motors),
        battery=BatteryReading(
            version=battery[0:2],
            status=battery[2],
            charge_percent=battery[3],
            current_ma=battery[4],
            cycles=battery[5],
            battery_temperature_c=battery[6:8],
            board_temperature_c=battery[8:10],
            cell_voltage_mv=battery[10:20],
        ),
        foot_force=tail[0:4],
        foot_force_estimate=tail[4:8],
        mode=tail[8],
        progress=tail[9],
        gait=tail[10],
        foot_raise_m=motion[0],
        odometry_m=motion[1:4],
        body_height_m=motion[4],
        velocity_mps=motion[5:8],
        yaw_rate_left_radps=motion[8],
        range_obstacle_m=motion[9:13],
        foot_position_m=_triples(feet[:12]),
        foot_velocity_mps=_triples(feet[12:]),
        wireless_remote=tail[48],
        serial_number=head[4:6],
        version=head[6:8],
        band_width=head[8],
        frame_reserve=head[3],
        reserve=tail[49],
    )


def _motor(values: tuple[Any, ...]) -> MotorReading:
    mode, angle, rate, acceleration, torque, raw_angle, raw_rate, raw_acceleration, temperature, *reserve = values
    return MotorReading(
        mode,
        angle,
        rate,
        acceleration,
        torque,
        raw_angle,
        raw_rate,
        raw_acceleration,
        temperature,
        (reserve[0], reserve[1]),
    )


def _triples(values: tuple[float, ...]) -> tuple[tuple[float, float, float], ...]:
    return tuple((values[at], values[at + 1], values[at + 2]) for at in range(0, len(values), 3))


_MODES = frozenset(Mode)
_GAITS = frozenset(Gait)


def _header(message: HighCommand | HighState) -> tuple[int, ...]:
    return (
        *HEAD,
        HIGH_LEVEL,
        message.frame_reserve,
        *message.serial_number,
        *message.version,
        message.band_width,
    )


def _tail(message: HighCommand | HighState) -> tuple[bytes, int, int]:
    if len(message.wireless_remote) != _REMOTE_BYTES:  # struct would fill it up or cut it
        raise struct.error(f"wireless_remote has {len(message.wireless_remote)} bytes")
    return message.wireless_remote, message.reserve, 0


def _motor_floats(motor: MotorReading) -> tuple[float, ...]:
    return (
        motor.angle_rad,
        motor.rate_radps,
        motor.acceleration_radps2,
        motor.torque_nm,
        motor.raw_angle_rad,
        motor.raw_rate_radps,
        motor.raw_acceleration_radps2,
    )


def _plain_crc(packet: bytes) -> int:
    return packet_crc(packet)


def _state_crc(packet: bytes) -> int:
    return scrambled(packet_crc(packet))


def _check(name: str, packet: bytes, size: int, crc: Callable[[bytes], int]) -> None:
    """Refuse what is no packet of a kind, by its length first: of another length nothing else can be read."""
    if len(packet) != size:
        raise PacketError(name, [Fault(f"{len(packet)} bytes", f"{size} bytes")])
    faults = []
    if tuple(packet[:2]) != HEAD or packet[2] != HIGH_LEVEL:
        faults.append(Fault(f"it begins with {packet[:3].hex()}", f"{bytes((*HEAD, HIGH_LEVEL)).hex()}"))
    told, right = _CRC.unpack(packet[-4:])[0], crc(packet)
    if told != right:
        faults.append(Fault(f"checksum {told:08x}", f"{right:08x}"))
    if faults:
        raise PacketError(name, faults)


def _not_finite(values: Iterable[float]) -> list[Fault]:
    wrong = [value for value in values if not math.isfinite(value)]
    return [Fault(f"{len(wrong)} numbers are not finite, {wrong[0]} first", "finite numbers")] if wrong else []


def _finite(name: str, values: Iterable[float]) -> None:
    faults = _not_finite(values)
    if faults:
        raise PacketError(name, faults)


def _sealed(name: str, pack: Callable[[], bytes], size: int, crc: Callable[[bytes], int]) -> bytes:
    """Return a packet with its checksum."""
    try:
        packet = pack()
    except (struct.error, OverflowError) as error:
        raise PacketError(name, [Fault(f"a value does not fit: {error}", "values that fit their fields")]) from error
    if len(packet) != size:
        raise PacketError(name, [Fault(f"{len(packet)} bytes", f"{size} bytes; 20 motors")])
    return packet[:-4] + _CRC.pack(crc(packet))
