"""What travels: addresses, envelopes, setpoints, and bytes that are no MAVLink."""

import contextlib
import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reasoned_explorer.geometry import GeoOrigin, Pose
from reasoned_explorer.model import SettingsError
from reasoned_explorer.vehicles.mavlink.address import Address, Wire
from reasoned_explorer.vehicles.mavlink.autopilot import Autopilot
from reasoned_explorer.vehicles.mavlink.dialect import Packer, Parser, dialect, text_of
from reasoned_explorer.vehicles.mavlink.flavours import ARDUROVER, FLAVOURS, PX4_COPTER, flavour_of
from reasoned_explorer.vehicles.mavlink.lockstep import Ask, Report, Request
from reasoned_explorer.vehicles.mavlink.news import news
from reasoned_explorer.vehicles.mavlink.pace import Moment
from reasoned_explorer.vehicles.mavlink.setpoints import Setpoint
from reasoned_explorer.vehicles.mavlink.settings import DriverSettings
from reasoned_explorer.vehicles.mavlink.telemetry import Telemetry

pytest.importorskip("pymavlink")

finite = st.floats(allow_nan=False, allow_infinity=False)
heading = st.floats(0.0, 6.28)
poses = st.builds(Pose, finite, finite, finite, heading)


@pytest.mark.parametrize(
    ("text", "address"),
    [
        ("udpin:0.0.0.0:14550", Address(Wire.UDP_IN, "0.0.0.0", 14550)),  # noqa: S104
        ("udp:127.0.0.1:14550", Address(Wire.UDP_IN, "127.0.0.1", 14550)),
        ("udpout:drone.local:14555", Address(Wire.UDP_OUT, "drone.local", 14555)),
        ("tcp:[::1]:5760", Address(Wire.TCP, "::1", 5760)),
        ("/dev/ttyACM0", Address(Wire.SERIAL, "/dev/ttyACM0", 115_200)),
        ("/dev/ttyUSB0:57600", Address(Wire.SERIAL, "/dev/ttyUSB0", 57_600)),
        ("serial:/dev/ttyUSB0,921600", Address(Wire.SERIAL, "/dev/ttyUSB0", 921_600)),
        ("COM3:57600", Address(Wire.SERIAL, "COM3", 57_600)),
    ],
)
def test_addresses_are_read_as_pymavlinks_tools_take_them(text, address):
    assert Address.read(text) == address


@pytest.mark.parametrize("text", ["", "udpin:", "udpin:host", "tcp:host:0", "tcp:host:70000", "ttyACM0", "http://x:1"])
def test_what_is_no_address_is_refused(text):
    with pytest.raises(SettingsError, match="expected udpin"):
        Address.read(text)


@given(st.text())
def test_no_text_breaks_the_reading_of_addresses(text):
    with contextlib.suppress(SettingsError):
        Address.read(text)


@given(st.sampled_from(Ask), st.integers(0, 2**32 - 1), st.floats(0.0, 86_400.0), st.booleans())
def test_a_request_comes_as_it_was_sent(ask, number, seconds, until_idle):
    request = Request(ask, number, seconds, until_idle)
    assert Request.read(request.pack()) == request


@given(poses, poses, finite, st.booleans(), st.integers(0, 65535))
def test_a_report_comes_with_all_digits(true, believed, t_s, is_busy, hits):
    report = Report(7, t_s, true, believed, 1.25, -0.5, is_busy, not is_busy, hits, "building_0")
    assert Report.read(report.pack()) == report


@given(st.lists(st.integers(0, 255), max_size=128))
def test_any_envelope_is_read_or_thrown_away(payload):
    request, report = Request.read(payload), Report.read(payload)
    assert request is None or 0.0 <= request.seconds <= 86_400.0
    assert report is None or math.isfinite(report.t_s)


def test_masks_say_what_counts():
    assert Setpoint(1.0, 2.0, -3.0, 0.5).mask == 2552  # ArduPilot's documentation: position and yaw
    assert Setpoint(1.0, 2.0, -3.0).mask == 3576  # position
    assert Setpoint().mask == 3527  # velocity
    assert Setpoint(velocity_mps=(1.0, 0.0, 0.0)).mask == 3527
    assert Setpoint(yaw_rad=0.5, velocity_mps=(1.0, 0.0, 0.0)).mask == 3527 - 1024  # and yaw
    assert Setpoint(yaw_rad=0.5).mask == 2559  # yaw


def test_a_setpoint_is_local_or_on_earth():
    mavlink = dialect()
    local = Setpoint(10.0, 20.0, -3.0, 4.0).message(mavlink, (1, 1), boot_ms=5, origin=None)
    assert (local.x, local.y, local.z, local.coordinate_frame) == (10.0, 20.0, -3.0, 1)
    assert local.yaw == pytest.approx(4.0 - 2.0 * math.pi)
    origin = GeoOrigin(48.0, 11.0)
    earth = Setpoint(10.0, 20.0, -3.0).message(mavlink, (1, 1), boot_ms=5, origin=origin)
    x_m, y_m = origin.enu_from_geodetic_m(earth.lat_int / 1e7, earth.lon_int / 1e7)
    assert (float(x_m), float(y_m)) == pytest.approx((20.0, 10.0), abs=0.02)
    assert (earth.alt, earth.coordinate_frame) == (3.0, 6)


def test_flavours_are_known_by_their_heartbeats():
    assert {flavour_of(one.autopilot, one.vehicle_type) for one in FLAVOURS.values()} == set(FLAVOURS.values())
    assert flavour_of(3, 11) is ARDUROVER  # a boat
    assert flavour_of(3, 1) is None  # a plane
    assert flavour_of(4, 2) is None  # neither ArduPilot nor PX4
    assert PX4_COPTER.modes["OFFBOARD"] == 6 << 16
    assert PX4_COPTER.mode_name(PX4_COPTER.modes["RTL"]) == "RTL"


@given(st.binary(max_size=600), st.booleans())
def test_bytes_that_are_no_messages_are_counted_and_never_raised(data, datagrams):
    parser = Parser(datagrams=datagrams)
    for message in parser.feed(data):
        Telemetry().take(message, 0.0)


@given(st.binary(min_size=1, max_size=200))
def test_a_bad_datagram_does_not_spoil_the_next(data):
    parser, mavlink = Parser(datagrams=True), dialect()
    parser.feed(data)
    sound = Packer(1, 1).pack(mavlink.MAVLink_heartbeat_message(2, 3, 81, 4, 4, 3))
    assert [one.get_type() for one in parser.feed(sound)] == ["HEARTBEAT"]


def test_a_distance_sensor_tells_what_stands_ahead_as_long_as_it_tells():
    mavlink, told = dialect(), Telemetry()

    def sensed(cm, *, orientation=0):
        return mavlink.MAVLink_distance_sensor_message(0, 20, 1000, cm, 0, 1, orientation, 255)

    assert told.range_ahead_m(0.0) is None
    told.take(sensed(430), 5.0)
    told.take(sensed(90, orientation=25), 5.5)  # one that looks down
    assert told.range_ahead_m(5.5) == pytest.approx(4.3)
    assert told.range_ahead_m(6.5) is None
    told.take(sensed(1000), 7.0)
    assert told.range_ahead_m(7.0) == float("inf")


@given(st.data())
def test_telemetry_takes_whatever_a_message_holds(data):
    """Messages with any contents, under a right checksum: nothing is raised and nothing kept that is not finite."""
    mavlink, told, parser = dialect(), Telemetry(), Parser(datagrams=True)
    names = ("HEARTBEAT", "LOCAL_POSITION_NED", "GLOBAL_POSITION_INT", "ATTITUDE", "SYS_STATUS", "BATTERY_STATUS")
    names += ("GPS_RAW_INT", "EKF_STATUS_REPORT", "ESTIMATOR_STATUS", "EXTENDED_SYS_STATE", "STATUSTEXT")
    names += ("DISTANCE_SENSOR",)
    for _ in range(3):
        name = data.draw(st.sampled_from(names))
        kind = getattr(mavlink, f"MAVLink_{name.lower()}_message")
        size = kind.unpacker.size
        payload = data.draw(st.binary(min_size=size, max_size=size))
        for message in parser.feed(framed(mavlink, kind, payload)):
            told.take(message, 1.0)
    if told.local is not None:
        assert all(math.isfinite(getattr(told.local, one)) for one in ("north_m", "east_m", "down_m", "north_mps"))
    assert told.yaw_rad is None or 0.0 <= told.yaw_rad <= 2.0 * math.pi
    assert told.battery.remaining is None or 0.0 <= told.battery.remaining <= 1.0
    assert all(text.isprintable() for text in told.texts)


def framed(mavlink, kind, payload):
    """Return a MAVLink 2 frame around any payload, with the checksum that its kind needs."""
    header = bytes([len(payload), 0, 0, 0, 1, 1]) + kind.id.to_bytes(3, "little")
    crc = mavlink.x25crc(header + payload)
    crc.accumulate(bytes([kind.crc_extra]))
    return b"\xfd" + header + payload + crc.crc.to_bytes(2, "little")


def test_texts_keep_to_what_can_be_printed():
    assert text_of(b"PreArm: \x00\x1b[31mhot") == "PreArm: [31mhot"
    assert len(text_of("a" * 500)) == 50


@given(st.data())
@settings(max_examples=60, deadline=None)
def test_whatever_an_autopilot_says_the_driver_moves_nothing_and_tells_only_numbers(data):
    """Any message with any contents, from the autopilot that is listened to, and bytes that are none in between."""
    mavlink = dialect()
    autopilot = Autopilot(Address.read("udpin:127.0.0.1:14550"), DriverSettings())
    autopilot.link.take(Packer(1, 1).pack(mavlink.MAVLink_heartbeat_message(2, 3, 81, 4, 4, 3)))
    sent = []
    autopilot.link.send = sent.append
    for _ in range(4):
        kind = mavlink.mavlink_map[data.draw(st.sampled_from(sorted(mavlink.mavlink_map)))]
        payload = data.draw(st.binary(min_size=kind.unpacker.size, max_size=kind.unpacker.size))
        autopilot.link.take(framed(mavlink, kind, payload))
        autopilot.link.take(data.draw(st.binary(max_size=40)))
    assert sent == []
    told = news(autopilot, Moment(0.0, Pose(0.0, 0.0), Pose(0.0, 0.0), 0.0), lived=True)
    ages = told.link_age_s, told.position_age_s, told.t_s
    assert all(age is None or (math.isfinite(age) and age >= 0.0) for age in ages)
    assert told.battery is None or 0.0 <= told.battery <= 1.0


def test_a_fix_that_comes_before_the_machine_s_own_time_is_not_as_old_as_the_machine():
    mavlink, told = dialect(), Telemetry()
    told.take(mavlink.MAVLink_gps_raw_int_message(3_600_000_000, 3, 1, 1, 0, 70, 120, 0, 0, 18), 0.0)
    told.take(mavlink.MAVLink_attitude_message(3_600_100, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1), 0.0)
    assert told.fix_boot_s is None
    told.take(mavlink.MAVLink_gps_raw_int_message(3_600_000_000, 3, 1, 1, 0, 70, 120, 0, 0, 18), 0.0)
    assert told.fix_boot_s == 3600.1


def test_the_same_fix_told_again_grows_old():
    mavlink, told = dialect(), Telemetry()

    def fix(time_us, kind):
        return mavlink.MAVLink_gps_raw_int_message(time_us, kind, 1, 1, 0, 70, 120, 0, 0, 18)

    def at(boot_ms):
        return mavlink.MAVLink_attitude_message(boot_ms, 0.0, 0.0, 0.0, 0.0, 0.0, 0.1)

    for message in (at(1000), fix(1_000_000, 3), at(2000), fix(1_000_000, 3)):
        told.take(message, 0.0)
    assert (told.fix_boot_s, told.yaw_rate_radps) == (1.0, pytest.approx(0.1))
    told.take(fix(2_000_000, 1), 0.0)  # no fix
    assert told.fix_boot_s == 1.0
    told.take(fix(2_100_000, 3), 0.0)
    assert told.fix_boot_s == 2.0
