"""Methods that fly. Each is answered when its flight is over, with whether it came about.

A flight that the world stops is over then, and answered with false: the drone stands where it ran into something. A new
command ends the one before, which is answered with false.
"""

import asyncio
import math
from collections.abc import Callable
from typing import Annotated, Any

from pydantic import Field

from reasoned_explorer.geometry import Pose, heading_towards_rad
from reasoned_explorer.serving.airsim.arguments import (
    Degrees,
    Drivetrain,
    Duration,
    Metres,
    Name,
    Speed,
    Unused,
    Vector,
    Velocity,
    YawMode,
    checked,
)
from reasoned_explorer.serving.airsim.drifting import Drift, Yaw
from reasoned_explorer.serving.airsim.drone import TAKEOFF_M, TAKEOFF_MPS
from reasoned_explorer.serving.airsim.flight import State
from reasoned_explorer.serving.airsim.simulator import Simulator
from reasoned_explorer.serving.msgpack_rpc import Method, MethodError
from reasoned_explorer.vehicles.airsim.conventions import heading_of_yaw_rad

Answer = asyncio.Future[bool]
_FORWARD_ONLY = 1
#: No flight to points is longer, metres and seconds.
_LONGEST_M, _LONGEST_S = 20_000.0, 7200.0
_STILL = YawMode()
_Path = Annotated[list[Vector], Field(min_length=1, max_length=1000)]


class FlightMethods:
    """Flies; see the official client for what each method means.

    Args:
        simulator: What flies.
    """

    def __init__(self, simulator: Simulator) -> None:
        self._sim = simulator

    def table(self) -> dict[str, Method]:
        """Return the methods by name."""
        flown: dict[str, Callable[..., Any]] = {
            "takeoff": self.take_off,
            "land": self.land,
            "hover": self.hover,
            "goHome": self.go_home,
            "cancelLastTask": self.cancel,
            "moveToPosition": self.move_to_position,
            "moveOnPath": self.move_on_path,
            "moveToZ": self.move_to_z,
            "moveByVelocity": self.move_by_velocity,
            "moveByVelocityZ": self.move_by_velocity_z,
            "moveByVelocityBodyFrame": self.move_by_velocity_in_body,
            "rotateToYaw": self.rotate_to_yaw,
            "rotateByYawRate": self.rotate_by_yaw_rate,
        }
        return {name: checked(name, method) for name, method in flown.items()}

    def take_off(self, timeout_sec: Unused = 20.0, vehicle_name: Name = "") -> Answer:
        """Rise a few metres, from the ground; in the air it is done already."""
        del timeout_sec
        sim = self._sim
        sim.check_flies(vehicle_name)
        if not sim.drone.is_landed(sim.now_s):
            return sim.at_once()
        return sim.obey(lambda now_s: sim.drone.climb(now_s, TAKEOFF_M, speed_mps=TAKEOFF_MPS))

    def land(self, timeout_sec: Unused = 60.0, vehicle_name: Name = "") -> Answer:
        """Sink to the ground."""
        del timeout_sec
        self._sim.check_flies(vehicle_name)
        return self._sim.obey(lambda now_s: self._sim.drone.climb(now_s, 0.0))

    def hover(self, vehicle_name: Name = "") -> Answer:
        """Stand still in the air."""
        self._sim.check_flies(vehicle_name)
        self._sim.end_command()
        return self._sim.at_once()

    def go_home(self, timeout_sec: Unused = 3e38, vehicle_name: Name = "") -> Answer:
        """Fly to where it started, down to the ground, as slowly as AirSim does."""
        del timeout_sec
        sim = self._sim
        sim.check_flies(vehicle_name)
        home = Pose(sim.home.x_m, sim.home.y_m, sim.home.z_m)
        return sim.obey(lambda now_s: sim.drone.fly(now_s, [home], speed_mps=TAKEOFF_MPS, face=False))

    def cancel(self, vehicle_name: Name = "") -> None:
        """End what it is doing; it stands still."""
        self._sim.check_name(vehicle_name)
        self._sim.end_command()

    def move_to_position(
        self,
        x: Metres,
        y: Metres,
        z: Metres,
        velocity: Speed,
        timeout_sec: Unused = 3e38,
        drivetrain: Drivetrain = 0,
        yaw_mode: YawMode = _STILL,
        lookahead: Unused = -1,
        adaptive_lookahead: Unused = 1,
        vehicle_name: Name = "",
    ) -> Answer:
        """Fly straight to a point."""
        del timeout_sec, lookahead, adaptive_lookahead
        point = Vector(x_val=x, y_val=y, z_val=z)
        return self._along([point], velocity, drivetrain, yaw_mode, vehicle_name)

    def move_on_path(
        self,
        path: _Path,
        velocity: Speed,
        timeout_sec: Unused = 3e38,
        drivetrain: Drivetrain = 0,
        yaw_mode: YawMode = _STILL,
        lookahead: Unused = -1,
        adaptive_lookahead: Unused = 1,
        vehicle_name: Name = "",
    ) -> Answer:
        """Fly from point to point."""
        del timeout_sec, lookahead, adaptive_lookahead
        return self._along(path, velocity, drivetrain, yaw_mode, vehicle_name)

    def move_to_z(
        self,
        z: Metres,
        velocity: Speed,
        timeout_sec: Unused = 3e38,
        yaw_mode: YawMode = _STILL,
        lookahead: Unused = -1,
        adaptive_lookahead: Unused = 1,
        vehicle_name: Name = "",
    ) -> Answer:
        """Rise or sink to a height."""
        del timeout_sec, yaw_mode, lookahead, adaptive_lookahead
        sim = self._sim
        sim.check_flies(vehicle_name)
        z_m = sim.home.enu_m(0.0, 0.0, z)[2]
        return sim.obey(lambda now_s: sim.drone.climb(now_s, z_m, speed_mps=velocity))

    def move_by_velocity(
        self,
        vx: Velocity,
        vy: Velocity,
        vz: Velocity,
        duration: Duration,
        drivetrain: Drivetrain = 0,
        yaw_mode: YawMode = _STILL,
        vehicle_name: Name = "",
    ) -> Answer:
        """Fly north, east and down at some speeds for a while."""
        drift = Drift(vy, vx, -vz, duration, _yaw(drivetrain, yaw_mode))
        return self._drift(drift, vehicle_name)

    def move_by_velocity_z(
        self,
        vx: Velocity,
        vy: Velocity,
        z: Metres,
        duration: Duration,
        drivetrain: Drivetrain = 0,
        yaw_mode: YawMode = _STILL,
        vehicle_name: Name = "",
    ) -> Answer:
        """Likewise, at a height."""
        z_m = max(0.0, self._sim.home.enu_m(0.0, 0.0, z)[2])
        drift = Drift(vy, vx, 0.0, duration, _yaw(drivetrain, yaw_mode), z_m)
        return self._drift(drift, vehicle_name)

    def move_by_velocity_in_body(
        self,
        vx: Velocity,
        vy: Velocity,
        vz: Velocity,
        duration: Duration,
        drivetrain: Drivetrain = 0,
        yaw_mode: YawMode = _STILL,
        vehicle_name: Name = "",
    ) -> Answer:
        """Fly forward, right and down of where it faces now."""
        heading_rad = self._sim.drone.state(self._sim.now_s).heading_rad
        sine, cosine = math.sin(heading_rad), math.cos(heading_rad)
        east, north = vx * sine + vy * cosine, vx * cosine - vy * sine
        return self._drift(Drift(east, north, -vz, duration, _yaw(drivetrain, yaw_mode)), vehicle_name)

    def rotate_to_yaw(
        self, yaw: Degrees, timeout_sec: Unused = 3e38, margin: Degrees = 5.0, vehicle_name: Name = ""
    ) -> Answer:
        """Turn in place to a heading."""
        del timeout_sec, margin
        self._sim.check_flies(vehicle_name)
        return self._sim.obey(lambda now_s: self._sim.drone.turn(now_s, heading_of_yaw_rad(yaw)))

    def rotate_by_yaw_rate(self, yaw_rate: Degrees, duration: Duration, vehicle_name: Name = "") -> Answer:
        """Turn in place at a rate for a while."""
        return self._drift(Drift(0.0, 0.0, 0.0, duration, Yaw(math.radians(yaw_rate))), vehicle_name)

    def _along(
        self, path: list[Vector], velocity: float, drivetrain: int, yaw_mode: YawMode, vehicle_name: str
    ) -> Answer:
        sim = self._sim
        sim.check_flies(vehicle_name)
        points = [sim.home.enu_m(one.x_val, one.y_val, one.z_val) for one in path]
        here = sim.drone.belief(sim.now_s)
        targets = []
        before_x_m, before_y_m = here.x_m, here.y_m
        for x_m, y_m, z_m in points:
            heading_rad = heading_of_yaw_rad(yaw_mode.yaw_or_rate)
            if drivetrain == _FORWARD_ONLY:
                heading_rad = heading_towards_rad(before_x_m, before_y_m, x_m, y_m)
            targets.append(Pose(x_m, y_m, max(0.0, z_m), heading_rad))
            before_x_m, before_y_m = x_m, y_m
        _check_length(here, targets, velocity)
        face = drivetrain == _FORWARD_ONLY or not yaw_mode.is_rate
        return sim.obey(lambda now_s: sim.drone.fly(now_s, targets, speed_mps=velocity, face=face))

    def _drift(self, drift: Drift, vehicle_name: str) -> Answer:
        self._sim.check_flies(vehicle_name)
        return self._sim.obey(lambda now_s: self._sim.drone.drift(now_s, drift))


def _check_length(here: State, path: list[Pose], speed_mps: float) -> None:
    """Check that a flight is not so long that working it out would hold up everybody else.

    Raises:
        MethodError: If it is.
    """
    length_m, at = 0.0, Pose(here.x_m, here.y_m)
    for target in path:
        length_m, at = length_m + at.distance_to_m(target.x_m, target.y_m), target
    if length_m > _LONGEST_M or length_m > speed_mps * _LONGEST_S:
        raise MethodError(f"a flight of {length_m:.0f} m at {speed_mps:g} m/s is longer than is flown here")


def _yaw(drivetrain: int, mode: YawMode) -> Yaw:
    if drivetrain == _FORWARD_ONLY:
        return Yaw(along=True)
    if mode.is_rate:
        return Yaw(math.radians(mode.yaw_or_rate))
    return Yaw(heading_rad=heading_of_yaw_rad(mode.yaw_or_rate))
