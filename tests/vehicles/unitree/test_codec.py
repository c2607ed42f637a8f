import math
import struct
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.vehicles.unitree import (
    COMMAND_BYTES,
    STATE_BYTES,
    BatteryReading,
    Gait,
    HighCommand,
    HighState,
    ImuReading,
    Mode,
    MotorReading,
    PacketError,
    decode_command,
    decode_state,
    encode_command,
    encode_state,
)
from reasoned_explorer.vehicles.unitree.checksum import packet_crc, scrambled

# Sent by the vendor's library over the loopback: mode 2, velocity (0.3, -0.1), yaw rate 0.5, nothing else.
VENDOR_WALK = bytes.fromhex(
    "feefee" + "00" * 19 + "02" + "00" * 30 + "9a99993ecdccccbd0000003f" + "00" * 60 + "a15ddb2a"
)

floats = st.floats(width=32, allow_nan=False, allow_infinity=False)
bytes_ = st.integers(0, 255)
words = st.integers(0, 2**32 - 1)
short_ints = st.integers(-(2**15), 2**15 - 1)


def several(kind: st.SearchStrategy, count: int) -> st.SearchStrategy:
    return st.tuples(*[kind] * count)


COMMANDS = st.builds(
    HighCommand,
    mode=st.sampled_from(Mode),
    gait=st.sampled_from(Gait),
    speed_level=bytes_,
    foot_raise_m=floats,
    body_height_m=floats,
    position_m=several(floats, 2),
    euler_rad=several(floats, 3),
    forward_mps=floats,
    left_mps=floats,
    yaw_rate_left_radps=floats,
    battery_off=bytes_,
    led_rgb=several(bytes_, 12),
    wireless_remote=st.binary(min_size=40, max_size=40),
    serial_number=several(words, 2),
    version=several(words, 2),
    band_width=st.integers(0, 2**16 - 1),
    frame_reserve=bytes_,
    reserve=words,
)
IMUS = st.builds(
    ImuReading,
    quaternion=several(floats, 4),
    gyroscope_radps=several(floats, 3),
    accelerometer_mps2=several(floats, 3),
    rpy_rad=several(floats, 3),
    temperature_c=st.integers(-128, 127),
)
MOTORS = st.builds(MotorReading, bytes_, *[floats] * 7, st.integers(-128, 127), several(words, 2))
BATTERIES = st.builds(
    BatteryReading,
    several(bytes_, 2),
    bytes_,
    bytes_,
    st.integers(-(2**31), 2**31 - 1),
    st.integers(0, 2**16 - 1),
    several(st.integers(-128, 127), 2),
    several(st.integers(-128, 127), 2),
    several(st.integers(0, 2**16 - 1), 10),
)
STATES = st.builds(
    HighState,
    imu=IMUS,
    motors=MOTORS.map(lambda motor: (motor, *[MotorReading(mode=n) for n in range(19)])),
    battery=BATTERIES,
    foot_force=several(short_ints, 4),
    foot_force_estimate=several(short_ints, 4),
    mode=bytes_,
    progress=floats,
    gait=bytes_,
    odometry_m=several(floats, 3),
    velocity_mps=several(floats, 3),
    yaw_rate_left_radps=floats,
    range_obstacle_m=several(floats, 4),
    foot_position_m=several(several(floats, 3), 4),
    foot_velocity_mps=several(several(floats, 3), 4),
    wireless_remote=st.binary(min_size=40, max_size=40),
    band_width=st.integers(0, 2**16 - 1),
    reserve=words,
)


def resealed(packet: bytes) -> bytes:
    crc = packet_crc(packet)
    return packet[:-4] + struct.pack("<I", scrambled(crc) if len(packet) == STATE_BYTES else crc)


def test_the_packets_are_as_long_as_the_vendor_s():
    assert (COMMAND_BYTES, STATE_BYTES) == (129, 1087)


def test_walking_ahead_to_the_right_and_turning_left_is_what_the_vendor_s_library_sends():
    command = replace(
        HighCommand.walking(forward_mps=0.3, right_mps=0.1, turn_radps=-0.5), gait=Gait.IDLE
    )  # the library was asked for no gait
    assert encode_command(command) == VENDOR_WALK


def test_what_the_vendor_s_library_sends_is_understood():
    command = decode_command(VENDOR_WALK)
    assert command.mode is Mode.WALK
    assert (command.forward_mps, command.left_mps) == pytest.approx((0.3, -0.1))
    assert command.yaw_rate_left_radps == 0.5


@given(COMMANDS)
def test_commands_go_there_and_back(command):
    assert decode_command(encode_command(command)) == command


@given(STATES)
def test_states_go_there_and_back(state):
    assert decode_state(encode_state(state)) == state


def test_ours_turns_right_where_the_robot_s_turns_left():
    state = HighState(imu=ImuReading(gyroscope_radps=(0.0, 0.0, 0.4)), velocity_mps=(0.5, 0.2, 0.0))
    assert (state.forward_mps, state.right_mps, state.turn_radps) == (0.5, -0.2, -0.4)


@pytest.mark.parametrize(("roll", "pitch"), [(0.0, 0.0), (0.2, 0.0), (0.0, -0.3), (0.1, 0.25)])
def test_a_leaning_body_at_rest_is_not_accelerated(roll, pitch):
    g = 9.81
    felt = (-g * math.sin(pitch), g * math.sin(roll) * math.cos(pitch), g * math.cos(roll) * math.cos(pitch))
    state = HighState(imu=ImuReading(accelerometer_mps2=felt, rpy_rad=(roll, pitch, 1.0)))
    assert state.horizontal_acceleration_mps2 == pytest.approx((0.0, 0.0), abs=1e-9)


def test_an_accelerating_body_is_felt_ahead_and_to_the_right():
    state = HighState(imu=ImuReading(accelerometer_mps2=(0.5, -0.25, 9.81)))
    assert state.horizontal_acceleration_mps2 == (0.5, 0.25)


@pytest.mark.parametrize("spoil", [lambda p: p[:-1], lambda p: p + b"\0", lambda _: b"", lambda p: p[:2]])
def test_another_length_is_refused(spoil):
    with pytest.raises(PacketError, match="1087 bytes"):
        decode_state(spoil(encode_state(HighState())))


def test_a_wrong_head_and_a_wrong_checksum_are_both_told():
    packet = bytearray(encode_state(HighState()))
    packet[0] = 0
    packet[-1] ^= 1
    with pytest.raises(PacketError) as caught:
        decode_state(bytes(packet))
    assert len(caught.value.faults) == 2


def test_a_low_level_packet_is_refused():
    packet = bytearray(encode_command(HighCommand()))
    packet[2] = 0xFF
    with pytest.raises(PacketError, match="begins with"):
        decode_command(resealed(bytes(packet)))


@pytest.mark.parametrize("at", [22, 80, 500, 890, 1000])
def test_one_flipped_bit_is_found(at):
    packet = bytearray(encode_state(HighState()))
    packet[at] ^= 0x10
    with pytest.raises(PacketError, match="checksum"):
        decode_state(bytes(packet))


@pytest.mark.parametrize("wrong", [math.nan, math.inf, -math.inf])
def test_numbers_that_are_not_finite_are_refused_on_both_sides(wrong):
    state = HighState(velocity_mps=(0.0, wrong, 0.0))
    with pytest.raises(PacketError, match="not finite"):
        encode_state(state)
    packet = bytearray(encode_state(HighState()))
    packet[911:915] = struct.pack("<f", wrong)  # the speed ahead
    with pytest.raises(PacketError, match="not finite"):
        decode_state(resealed(bytes(packet)))
    with pytest.raises(PacketError, match="not finite"):
        encode_command(HighCommand(forward_mps=wrong))


def test_dancing_is_not_understood():
    packet = bytearray(encode_command(HighCommand()))
    packet[22], packet[23] = 9, 7
    with pytest.raises(PacketError) as caught:
        decode_command(resealed(bytes(packet)))
    assert [fault.what for fault in caught.value.faults] == ["mode 9", "gait 7"]


@pytest.mark.parametrize(
    "wrong",
    [
        HighCommand(led_rgb=(0,)),
        HighCommand(led_rgb=(256,) * 12),
        HighCommand(wireless_remote=b"short"),
        HighCommand(forward_mps=1e300),
        HighCommand(serial_number=(-1, 0)),
    ],
)
def test_what_does_not_fit_into_a_command_is_refused(wrong):
    with pytest.raises(PacketError):
        encode_command(wrong)


def test_a_robot_with_another_number_of_motors_is_refused():
    with pytest.raises(PacketError):
        encode_state(HighState(motors=()))


@given(st.binary(max_size=1200) | st.binary(min_size=STATE_BYTES, max_size=STATE_BYTES))
def test_garbage_is_never_a_state_and_never_an_accident(packet):
    with pytest.raises(PacketError):
        decode_state(packet)


@given(st.binary(min_size=STATE_BYTES - 7, max_size=STATE_BYTES - 7), st.booleans())
def test_garbage_with_a_right_head_and_checksum_is_finite_or_refused(body, with_crc):
    packet = b"\xfe\xef\xee" + body + bytes(4)
    try:
        state = decode_state(resealed(packet) if with_crc else packet)
    except PacketError:
        return
    assert with_crc
    numbers = (*state.velocity_mps, *state.imu.gyroscope_radps, *state.odometry_m, state.yaw_rate_left_radps)
    assert all(map(math.isfinite, numbers))


@given(st.binary(max_size=200) | st.binary(min_size=COMMAND_BYTES, max_size=COMMAND_BYTES))
def test_garbage_is_never_a_command(packet):
    with pytest.raises(PacketError):
        decode_command(packet)
