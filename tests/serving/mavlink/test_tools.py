"""pymavlink's own tools, which are not ours, talk to the served autopilot over sockets."""

import time

import pytest

from reasoned_explorer.geometry import Pose
from reasoned_explorer.serving.background import BackgroundServer
from reasoned_explorer.serving.mavlink.server import MavlinkServer
from reasoned_explorer.world.atlas import Atlas
from tests.world.worlds import field

pytest.importorskip("pymavlink")
# The package has no types and no tests of ours: its warnings are its own.
pytestmark = [
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
]

HOME = Pose(50.0, 50.0)
PATIENCE_S = 60.0


@pytest.fixture(scope="module")
def atlas():
    return Atlas(field(("tree", 70.0, 50.0)))


def connected(served, wire):
    from pymavlink import mavutil

    made = mavutil.mavlink_connection(f"{wire}:127.0.0.1:{served.port}", source_system=255)
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline:
        made.mav.heartbeat_send(mavutil.mavlink.MAV_TYPE_GCS, mavutil.mavlink.MAV_AUTOPILOT_INVALID, 0, 0, 0)
        if made.wait_heartbeat(timeout=1.0) is not None:
            return made, mavutil.mavlink
    raise AssertionError("no heartbeat")


def until(made, holds, kind=None):
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline:
        message = made.recv_match(type=kind, blocking=True, timeout=1.0)
        if message is not None and holds(message):
            return message
    raise AssertionError("it does not come")


def served_as(atlas, flavour, **more):
    return BackgroundServer(lambda: MavlinkServer(atlas, HOME, flavour=flavour, **more))


@pytest.mark.parametrize(("wire", "to"), [("udp", "udpout"), ("tcp", "tcp")])
def test_mavutil_arms_takes_off_flies_and_lands(atlas, wire, to):
    with served_as(atlas, "arducopter", wire=wire, speed=20.0) as served:
        made, mavlink = connected(served, to)
        made.set_mode("GUIDED")
        until(made, lambda _: made.flightmode == "GUIDED", "HEARTBEAT")
        made.arducopter_arm()
        until(made, lambda _: made.motors_armed(), "HEARTBEAT")
        made.mav.command_long_send(1, 1, mavlink.MAV_CMD_NAV_TAKEOFF, 0, 0, 0, 0, 0, 0, 0, 3.0)
        ack = until(made, lambda m: m.command == mavlink.MAV_CMD_NAV_TAKEOFF, "COMMAND_ACK")
        assert ack.result == mavlink.MAV_RESULT_ACCEPTED
        until(made, lambda m: m.relative_alt > 2900, "GLOBAL_POSITION_INT")
        frame, mask = mavlink.MAV_FRAME_LOCAL_NED, 0b110111111000
        made.mav.set_position_target_local_ned_send(0, 1, 1, frame, mask, 5.0, 2.0, -3.0, *(0.0,) * 8)
        until(made, lambda m: abs(m.x - 5.0) < 0.6 and abs(m.y - 2.0) < 0.6, "LOCAL_POSITION_NED")
        made.set_mode("LAND")
        until(made, lambda _: not made.motors_armed(), "HEARTBEAT")
        made.close()


def test_mavutil_reads_and_sets_parameters(atlas):
    from pymavlink import mavparm

    with served_as(atlas, "arducopter") as served:
        made, _ = connected(served, "udpout")
        made.param_fetch_all()
        until(made, lambda _: len(made.params) == len(served.server.pilot.parameters), "PARAM_VALUE")
        assert set(made.params) == set(served.server.pilot.parameters.names)
        assert mavparm.MAVParmDict().mavset(made, "WPNAV_SPEED", 250.0)
        assert served.server.pilot.parameters["WPNAV_SPEED"].value == 250.0
        made.close()


@pytest.mark.parametrize(("flavour", "mode"), [("ardurover", "GUIDED"), ("ardurover", "HOLD"), ("px4", "LOITER")])
def test_mavutil_changes_modes_by_their_names(atlas, flavour, mode):
    with served_as(atlas, flavour) as served:
        made, _ = connected(served, "udpout")
        made.set_mode(mode)
        until(made, lambda _: made.flightmode == mode, "HEARTBEAT")
        made.close()


def test_a_ground_station_finds_what_it_asks_for(atlas):
    with served_as(atlas, "arducopter") as served:
        made, mavlink = connected(served, "tcp" if served.server._wire == "tcp" else "udpout")
        wanted = {"SYS_STATUS", "ATTITUDE", "LOCAL_POSITION_NED", "GLOBAL_POSITION_INT", "GPS_RAW_INT", "HOME_POSITION"}
        wanted |= {"BATTERY_STATUS", "EKF_STATUS_REPORT", "VFR_HUD", "SYSTEM_TIME", "EXTENDED_SYS_STATE"}
        seen = {}
        deadline = time.monotonic() + PATIENCE_S
        while wanted - set(seen) and time.monotonic() < deadline:
            message = made.recv_match(blocking=True, timeout=1.0)
            if message is not None:
                seen[message.get_type()] = message
        assert wanted <= set(seen)
        version = mavlink.MAVLINK_MSG_ID_AUTOPILOT_VERSION
        made.mav.command_long_send(1, 1, mavlink.MAV_CMD_REQUEST_MESSAGE, 0, version, 0, 0, 0, 0, 0, 0)
        until(made, lambda _: True, "AUTOPILOT_VERSION")
        made.mav.mission_request_list_send(1, 1)
        assert until(made, lambda _: True, "MISSION_COUNT").count == 0
        made.mav.command_long_send(1, 1, 31_999, 0, *(0.0,) * 7)
        assert until(made, lambda m: m.command == 31_999, "COMMAND_ACK").result == mavlink.MAV_RESULT_UNSUPPORTED
        made.close()
