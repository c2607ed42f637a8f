"""Against the vendor's own library, where it installs (x86-64): what it sends we read, what we send it reads."""

import asyncio
import socket
from dataclasses import replace
from typing import Any

import pytest

from reasoned_explorer.vehicles.unitree import (
    BatteryReading,
    Gait,
    HighCommand,
    HighState,
    ImuReading,
    Mode,
    MotorReading,
    decode_command,
    encode_command,
    encode_state,
)

pytest.importorskip("unitree_legged_sdk", reason="the vendor's library unitree_legged_sdk is not installed")
try:
    from unitree_legged_sdk import robot_interface as sdk
except ImportError as error:  # another processor or Python
    pytest.skip(f"the vendor's library does not load here: {error}", allow_module_level=True)

COMMAND = HighCommand(
    Mode.WALK,
    Gait.TROT_RUNNING,
    speed_level=2,
    foot_raise_m=0.03,
    body_height_m=-0.05,
    position_m=(1.5, -2.5),
    euler_rad=(0.1, -0.2, 0.3),
    forward_mps=0.75,
    left_mps=-0.25,
    yaw_rate_left_radps=1.25,
    battery_off=0x12,
    led_rgb=tuple(range(1, 13)),
    wireless_remote=bytes(range(100, 140)),
    serial_number=(0x01020304, 0x05060708),
    version=(0x11121314, 0x15161718),
    band_width=0x2122,
    reserve=0x31323334,
    frame_reserve=0x41,
)


def numbered(start: float, count: int) -> tuple[float, ...]:
    """Return so many different numbers that single precision holds exactly."""
    return tuple(start + 0.25 * number for number in range(count))


STATE = HighState(
    imu=ImuReading((0.5, -0.5, 0.25, 0.75), (0.125, -0.25, 0.375), (1.0, -2.0, 9.75), (0.25, -0.125, 3.0), -7),
    motors=tuple(
        MotorReading(number, *numbered(10.0 * number, 7), 20 + number, (number, 1000 + number)) for number in range(20)
    ),
    battery=BatteryReading((1, 2), 3, 87, -1234, 56, (21, -22), (23, 24), tuple(range(4000, 4010))),
    foot_force=(1, -2, 3, -4),
    foot_force_estimate=(5, -6, 7, -8),
    mode=2,
    progress=0.5,
    gait=3,
    foot_raise_m=0.0625,
    odometry_m=(1.5, -2.5, 0.25),
    body_height_m=0.28125,
    velocity_mps=(0.75, -0.25, 0.125),
    yaw_rate_left_radps=-0.5,
    range_obstacle_m=(1.0, 2.0, 3.0, 4.0),
    foot_position_m=((0.25, 0.5, -0.25), (1.25, 1.5, 1.75), (2.25, 2.5, 2.75), (3.25, 3.5, 3.75)),
    foot_velocity_mps=((4.25, 4.5, 4.75), (5.25, 5.5, 5.75), (6.25, 6.5, 6.75), (7.25, 7.5, 7.75)),
    wireless_remote=bytes(range(60, 100)),
    serial_number=(9, 10),
    version=(11, 12),
    band_width=13,
    frame_reserve=14,
    reserve=15,
)


@pytest.fixture
def robot() -> Any:
    """A socket on the loopback that stands for the robot's."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as ours:
        ours.bind(("127.0.0.1", 0))
        ours.settimeout(10.0)
        yield ours


def vendor_udp(robot: socket.socket) -> Any:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
        free.bind(("127.0.0.1", 0))
        local_port = free.getsockname()[1]
    return sdk.UDP(0xEE, local_port, "127.0.0.1", robot.getsockname()[1])


def vendor_command(udp: Any, command: HighCommand) -> Any:
    theirs = sdk.HighCmd()
    udp.InitCmdData(theirs)
    theirs.mode, theirs.gaitType, theirs.speedLevel = int(command.mode), int(command.gait), command.speed_level
    theirs.footRaiseHeight, theirs.bodyHeight = command.foot_raise_m, command.body_height_m
    theirs.position, theirs.euler = list(command.position_m), list(command.euler_rad)
    theirs.velocity = [command.forward_mps, command.left_mps]
    theirs.yawSpeed = command.yaw_rate_left_radps
    battery = sdk.BmsCmd()
    battery.off, battery.reserve = command.battery_off, [0, 0, 0]
    theirs.bms = battery
    lights = []
    for foot in range(4):
        light = sdk.LED()
        light.r, light.g, light.b = command.led_rgb[3 * foot : 3 * foot + 3]
        lights.append(light)
    theirs.led = lights
    theirs.wirelessRemote = list(command.wireless_remote)
    theirs.SN, theirs.version = list(command.serial_number), list(command.version)
    theirs.bandWidth, theirs.reserve, theirs.frameReserve = (
        command.band_width,
        command.reserve,
        command.frame_reserve,
    )
    return theirs


@pytest.mark.parametrize(
    "command",
    [COMMAND, HighCommand.standing(), HighCommand.damping(), HighCommand.walking(forward_mps=0.3, turn_radps=1.0)],
    ids=["everything", "standing", "damping", "walking"],
)
def test_the_library_sends_the_very_bytes_that_we_do(robot: socket.socket, command: HighCommand) -> None:
    udp = vendor_udp(robot)
    udp.SetSend(vendor_command(udp, command))
    assert udp.Send() == 129
    packet = robot.recv(4096)
    assert packet == encode_command(command)


def test_what_the_library_sends_is_read(robot: socket.socket) -> None:
    udp = vendor_udp(robot)
    udp.SetSend(vendor_command(udp, COMMAND))
    udp.Send()
    command = decode_command(robot.recv(4096))
    assert replace(command, foot_raise_m=0, body_height_m=0, euler_rad=()) == replace(
        COMMAND, foot_raise_m=0, body_height_m=0, euler_rad=()
    )
    assert (command.foot_raise_m, command.body_height_m, *command.euler_rad) == pytest.approx(
        (0.03, -0.05, 0.1, -0.2, 0.3)
    )


def received(robot: socket.socket, packet: bytes) -> tuple[Any, Any]:
    """Return the state and the counters of the vendor's library after a packet was sent to it."""
    udp = vendor_udp(robot)
    udp.SetSend(vendor_command(udp, HighCommand.standing()))
    udp.Send()
    _, address = robot.recvfrom(4096)
    robot.sendto(packet, address)
    asyncio.run(asyncio.sleep(0.05))
    udp.Recv()
    state = sdk.HighState()
    udp.GetRecv(state)
    return state, udp


def test_the_library_reads_what_we_send(robot: socket.socket) -> None:
    state, _ = received(robot, encode_state(STATE))
    imu, battery = STATE.imu, STATE.battery
    assert list(state.head) == [0xFE, 0xEF]
    assert state.levelFlag == 0xEE
    assert tuple(state.SN) == STATE.serial_number
    assert tuple(state.version) == STATE.version
    assert (state.bandWidth, state.frameReserve, state.reserve) == (13, 14, 15)
    assert tuple(state.imu.quaternion) == imu.quaternion
    assert tuple(state.imu.gyroscope) == imu.gyroscope_radps
    assert tuple(state.imu.accelerometer) == imu.accelerometer_mps2
    assert tuple(state.imu.rpy) == imu.rpy_rad
    assert state.imu.temperature == imu.temperature_c
    for theirs, ours in zip(state.motorState, STATE.motors, strict=True):
        assert (theirs.mode, theirs.q, theirs.dq, theirs.ddq) == (
            ours.mode,
            ours.angle_rad,
            ours.rate_radps,
            ours.acceleration_radps2,
        )
        assert (theirs.tauEst, theirs.q_raw, theirs.dq_raw, theirs.ddq_raw) == (
            ours.torque_nm,
            ours.raw_angle_rad,
            ours.raw_rate_radps,
            ours.raw_acceleration_radps2,
        )
        assert (theirs.temperature, tuple(theirs.reserve)) == (ours.temperature_c, ours.reserve)
    assert (state.bms.version_h, state.bms.version_l, state.bms.bms_status) == (1, 2, 3)
    assert (state.bms.SOC, state.bms.current, state.bms.cycle) == (87, -1234, 56)
    assert tuple(state.bms.BQ_NTC) == battery.battery_temperature_c
    assert tuple(state.bms.MCU_NTC) == battery.board_temperature_c
    assert tuple(state.bms.cell_vol) == battery.cell_voltage_mv
    assert tuple(state.footForce) == STATE.foot_force
    assert tuple(state.footForceEst) == STATE.foot_force_estimate
    assert (state.mode, state.progress, state.gaitType) == (2, 0.5, 3)
    assert (state.footRaiseHeight, state.bodyHeight, state.yawSpeed) == (0.0625, 0.28125, -0.5)
    assert tuple(state.position) == STATE.odometry_m
    assert tuple(state.velocity) == STATE.velocity_mps
    assert tuple(state.rangeObstacle) == STATE.range_obstacle_m
    assert tuple((foot.x, foot.y, foot.z) for foot in state.footPosition2Body) == STATE.foot_position_m
    assert tuple((foot.x, foot.y, foot.z) for foot in state.footSpeed2Body) == STATE.foot_velocity_mps
    assert bytes(state.wirelessRemote) == STATE.wireless_remote


def test_the_library_refuses_a_checksum_that_we_refuse(robot: socket.socket) -> None:
    packet = bytearray(encode_state(STATE))
    packet[600] ^= 1
    state, _ = received(robot, bytes(packet))
    assert state.mode == 0
