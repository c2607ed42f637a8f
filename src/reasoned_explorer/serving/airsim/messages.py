"""What AirSim answers with, as maps."""

import math
from typing import Any

from reasoned_explorer.geometry import bearing_between_rad, ned_from_enu
from reasoned_explorer.serving.airsim.flight import Hit, State
from reasoned_explorer.vehicles.airsim.conventions import HomeFrame, Wire, quaternion, vector

#: What the body feels at rest in forward, right, down: it is held against gravity.
GRAVITY_MPS2 = 9.80665
#: A magnetic field of middle latitudes, gauss north and down (without declination).
_FIELD_NORTH, _FIELD_DOWN = 0.21, 0.42
#: The standard atmosphere's pressure, pascals at sea level; its fall with height (ICAO, below 11 km).
_SEA_LEVEL_PA, _FALL_PER_M, _FALL_POWER = 101_325.0, 2.25577e-5, 5.25588
_QNH_HPA = 1013.25
NOWHERE: Wire = {"position": vector(math.nan, math.nan, math.nan), "orientation": quaternion(0.0, 0.0, math.nan)}


def nanoseconds(seconds: float) -> int:
    """Return a time of the server as it travels; it begins with one second, since 0 stands for none."""
    return round((1.0 + seconds) * 1e9)


def pose(home: HomeFrame, state: State) -> Wire:
    """Return where the body is."""
    ned = home.ned_m(state.x_m, state.y_m, state.z_m)
    return {"position": vector(*ned), "orientation": quaternion(0.0, 0.0, state.heading_rad)}


def kinematics(home: HomeFrame, state: State) -> Wire:
    """Return where the body is and how it moves."""
    return {
        **pose(home, state),
        "linear_velocity": vector(*ned_from_enu(state.vx_mps, state.vy_mps, state.vz_mps)),
        "angular_velocity": vector(0.0, 0.0, state.yaw_rate_radps),
        "linear_acceleration": vector(0.0, 0.0, 0.0),
        "angular_acceleration": vector(0.0, 0.0, 0.0),
    }


def collision(home: HomeFrame, last: tuple[float, Hit] | None, *, fresh: bool, radius_m: float) -> Wire:
    """Return what the body last ran into."""
    if last is None:
        zero = vector(0.0, 0.0, 0.0)
        still = {"penetration_depth": 0.0, "time_stamp": 0, "object_name": "", "object_id": -1}
        return {"has_collided": False, "normal": zero, "impact_point": zero, "position": zero, **still}
    at_s, hit = last
    east, north = math.sin(hit.heading_rad), math.cos(hit.heading_rad)
    touched = home.ned_m(hit.x_m + radius_m * east, hit.y_m + radius_m * north, hit.z_m)
    return {
        "has_collided": fresh,
        "normal": vector(-north, -east, 0.0),
        "impact_point": vector(*touched),
        "position": vector(*home.ned_m(hit.x_m, hit.y_m, hit.z_m)),
        "penetration_depth": 0.0,
        "time_stamp": nanoseconds(at_s),
        "object_name": hit.name,
        "object_id": -1,
    }


def no_remote_control() -> Wire:
    """Return what a remote control says that is not there."""
    axes = dict.fromkeys(("pitch", "roll", "throttle", "yaw"), 0.0)
    switches = {f"switch{number}": 0 for number in range(1, 9)}
    return {"timestamp": 0, **axes, **switches, "is_initialized": False, "is_valid": False}


def imu(state: State, now_s: float) -> Wire:
    """Return what the inertial sensor measures."""
    return {
        "time_stamp": nanoseconds(now_s),
        "orientation": quaternion(0.0, 0.0, state.heading_rad),
        "angular_velocity": vector(0.0, 0.0, state.yaw_rate_radps),
        "linear_acceleration": vector(0.0, 0.0, -GRAVITY_MPS2),
    }


def magnetometer(state: State, now_s: float) -> Wire:
    """Return the magnetic field in the body's frame, gauss."""
    north_rad = bearing_between_rad(state.heading_rad, 0.0)
    field = vector(_FIELD_NORTH * math.cos(north_rad), _FIELD_NORTH * math.sin(north_rad), _FIELD_DOWN)
    return {"time_stamp": nanoseconds(now_s), "magnetic_field_body": field, "magnetic_field_covariance": []}


def barometer(altitude_m: float, now_s: float) -> Wire:
    """Return the pressure at a height above the sea."""
    pressure = _SEA_LEVEL_PA * (1.0 - _FALL_PER_M * altitude_m) ** _FALL_POWER
    return {"time_stamp": nanoseconds(now_s), "altitude": altitude_m, "pressure": pressure, "qnh": _QNH_HPA}


def gps(geo_point: Wire, state: State, now_s: float) -> Wire:
    """Return what a satellite receiver says."""
    at = nanoseconds(now_s)
    report = {
        "geo_point": geo_point,
        "eph": 0.1,
        "epv": 0.1,
        "velocity": vector(*ned_from_enu(state.vx_mps, state.vy_mps, state.vz_mps)),
        "fix_type": 3,
        "time_utc": at // 1000,
    }
    return {"time_stamp": at, "gnss": report, "is_valid": True}


def projection(fov_rad: float, aspect: float) -> dict[str, Any]:
    """Return the projection matrix of a camera, rows for x, y, depth and scale, as Unreal has it (depth reversed)."""
    focal = 1.0 / math.tan(0.5 * fov_rad)
    near_m = 0.1
    rows = [[focal, 0.0, 0.0, 0.0], [0.0, focal * aspect, 0.0, 0.0], [0.0, 0.0, 0.0, near_m], [0.0, 0.0, 1.0, 0.0]]
    return {"matrix": rows}
