"""The numbers of the wire that are written down here, against those that pymavlink was made with."""

import pytest

from reasoned_explorer.serving.mavlink import inbox, pilot, teller
from reasoned_explorer.vehicles.mavlink import autopilot, flavours, setpoints, telemetry
from reasoned_explorer.vehicles.mavlink.dialect import dialect

pytest.importorskip("pymavlink")

MAVLINK = dialect()


def bits(prefix, *names):
    return sum(getattr(MAVLINK, f"{prefix}_{name}") for name in names)


def test_masks_of_setpoints():
    mask = "POSITION_TARGET_TYPEMASK"
    assert bits(mask, "X_IGNORE", "Y_IGNORE", "Z_IGNORE") == setpoints.NO_POSITION
    assert bits(mask, "VX_IGNORE", "VY_IGNORE", "VZ_IGNORE") == setpoints.NO_VELOCITY
    assert bits(mask, "AX_IGNORE", "AY_IGNORE", "AZ_IGNORE") == setpoints.NO_ACCELERATION
    assert bits(mask, "YAW_IGNORE") == setpoints.NO_YAW
    assert bits(mask, "YAW_RATE_IGNORE") == setpoints.NO_YAW_RATE
    assert bits("MAV_FRAME", "LOCAL_NED") == setpoints.LOCAL_NED
    assert bits("MAV_FRAME", "GLOBAL_RELATIVE_ALT_INT") == setpoints.GLOBAL_RELATIVE_ALT


def test_a_rover_of_ardupilot_is_not_told_a_velocity_of_nothing():
    # Its direction would be north. 1535 is "use yaw rate" of ArduPilot's documentation for rovers.
    assert setpoints.standing(flies=False).mask == 1535
    assert setpoints.standing(flies=True).mask == 3527


@pytest.mark.parametrize(("flavour", "prefix"), [("arducopter", "COPTER_MODE"), ("ardurover", "ROVER_MODE")])
def test_modes_of_ardupilot(flavour, prefix):
    modes = flavours.FLAVOURS[flavour].modes
    assert modes == {name: getattr(MAVLINK, f"{prefix}_{name}") for name in modes}


def test_modes_of_px4_as_pymavlink_reads_them():
    from pymavlink import mavutil

    for name in ("LOITER", "RTL", "LAND", "OFFBOARD", "TAKEOFF", "MISSION", "POSCTL", "MANUAL"):
        number = flavours.FLAVOURS["px4"].modes[name]
        base_mode = MAVLINK.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED | MAVLINK.MAV_MODE_FLAG_MANUAL_INPUT_ENABLED
        read = mavutil.interpret_px4_mode(
            base_mode | (MAVLINK.MAV_MODE_FLAG_AUTO_ENABLED if number >> 16 & 0xFF in {4, 6} else 0), number
        )
        assert read == name


def test_kinds_of_machines_and_autopilots():
    flying = ("QUADROTOR", "COAXIAL", "HELICOPTER", "HEXAROTOR", "OCTOROTOR", "TRICOPTER", "DODECAROTOR", "DECAROTOR")
    assert {bits("MAV_TYPE", name) for name in flying} == flavours.FLYING_TYPES
    assert {bits("MAV_TYPE", name) for name in ("GROUND_ROVER", "SURFACE_BOAT")} == flavours.DRIVING_TYPES
    assert bits("MAV_TYPE", "GCS") == flavours.GCS_TYPE
    known = flavours.ARDUPILOT, flavours.PX4, flavours.NO_AUTOPILOT
    assert known == tuple(bits("MAV_AUTOPILOT", name) for name in ("ARDUPILOTMEGA", "PX4", "INVALID"))


def test_what_is_asked_for_and_answered():
    asked = [MAVLINK.mavlink_map[number].msgname for number in (*autopilot._OFTEN, *autopilot._SELDOM)]
    assert asked[:4] == ["GPS_RAW_INT", "ATTITUDE", "LOCAL_POSITION_NED", "GLOBAL_POSITION_INT"]
    assert set(asked[4:]) <= {"DISTANCE_SENSOR", "SYS_STATUS", "BATTERY_STATUS", *teller.FILTERS, "EXTENDED_SYS_STATE"}
    commands = autopilot._ARM, autopilot._SET_MODE, autopilot._MESSAGE_INTERVAL
    assert commands == (
        MAVLINK.MAV_CMD_COMPONENT_ARM_DISARM,
        MAVLINK.MAV_CMD_DO_SET_MODE,
        MAVLINK.MAV_CMD_SET_MESSAGE_INTERVAL,
    )
    results = ("ACCEPTED", "TEMPORARILY_REJECTED", "DENIED", "UNSUPPORTED", "FAILED")
    served = pilot.ACCEPTED, pilot.REJECTED_NOW, pilot.DENIED, pilot.UNSUPPORTED, pilot.FAILED
    assert served == tuple(bits("MAV_RESULT", name) for name in results)
    severities = pilot.CRITICAL, pilot.ERROR, pilot.INFO
    assert severities == tuple(bits("MAV_SEVERITY", name) for name in ("CRITICAL", "ERROR", "INFO"))


@pytest.mark.parametrize("prefix", ["EKF", "ESTIMATOR"])
def test_flags_of_filters(prefix):
    assert bits(prefix, "ATTITUDE", "VELOCITY_HORIZ", "POS_HORIZ_ABS") == telemetry._NEEDED_FLAGS
    assert bits(prefix, "CONST_POS_MODE") == telemetry._NO_POSITION == teller._ASSUMES_TO_STAND
    assert bits(prefix, "POS_HORIZ_REL", "POS_HORIZ_ABS") == teller._PLACE_FLAGS


def test_what_is_said_of_parameters_and_sensors():
    spoken = "COMMAND_INT", "SET_POSITION_TARGET_LOCAL_NED", "SET_POSITION_TARGET_GLOBAL_INT", "MAVLINK2"
    assert bits("MAV_PROTOCOL_CAPABILITY", *spoken) == teller._CAPABILITIES
    assert bits("MAV_PROTOCOL_CAPABILITY", "PARAM_ENCODE_BYTEWISE") == teller._AS_BYTES
    assert bits("MAV_PROTOCOL_CAPABILITY", "PARAM_FLOAT") == teller._AS_FLOATS
    sensors = "3D_GYRO", "3D_ACCEL", "3D_MAG", "ABSOLUTE_PRESSURE", "GPS", "BATTERY"
    assert bits("MAV_SYS_STATUS_SENSOR", *sensors) | MAVLINK.MAV_SYS_STATUS_PREARM_CHECK == teller._SENSORS
    streams = "RAW_SENSORS", "EXTENDED_STATUS", "POSITION", "EXTRA1", "EXTRA2", "EXTRA3"
    assert {bits("MAV_DATA_STREAM", name) for name in streams} == set(inbox._STREAMS)
