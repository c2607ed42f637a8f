"""Methods that ask: for the server, the vehicle, its time and its sensors."""

import asyncio
import math
from collections.abc import Callable
from typing import Any

from reasoned_explorer.geometry import Pose
from reasoned_explorer.serving.airsim import messages
from reasoned_explorer.serving.airsim.arguments import LoosePose, Name, Step, checked
from reasoned_explorer.serving.airsim.simulator import Simulator
from reasoned_explorer.serving.msgpack_rpc import Method, MethodError
from reasoned_explorer.simulation.mishaps import MishapKind
from reasoned_explorer.vehicles.airsim.conventions import Wire, attitude
from reasoned_explorer.vehicles.airsim.place import PLACE_METHOD

#: What the distance sensor can measure, metres (AirSim's defaults).
_NEAREST_M, _FARTHEST_M = 0.2, 40.0


class StateMethods:
    """Answers questions; see the official client for what each means.

    Args:
        simulator: What is asked about.
        generation: What the server says of its version: 1 for AirSim and Colosseum, 4 for Cosys-AirSim.
    """

    def __init__(self, simulator: Simulator, generation: int) -> None:
        self._sim, self._generation = simulator, generation

    def table(self) -> dict[str, Method]:
        """Return the methods by name."""
        sim = self._sim
        asked: dict[str, Callable[..., Any]] = {
            "ping": lambda: True,
            "getServerVersion": lambda: self._generation,
            # Both generations are answered: neither client is too old.
            "getMinRequiredClientVersion": lambda: 1,
            "reset": sim.reset,
            "simPause": self.pause,
            "simIsPaused": lambda: sim.timeline.is_held,
            "simContinueForTime": self.go_on_for,
            "enableApiControl": self.enable_api_control,
            "isApiControlEnabled": self.is_api_control_enabled,
            "armDisarm": self.arm,
            "listVehicles": lambda: [sim.settings.vehicle_name],
            "simListVehicles": lambda: [sim.settings.vehicle_name],
            "getSettingsString": lambda: sim.settings.model_dump_json(),  # noqa: PLW0108 - takes no arguments
            "getHomeGeoPoint": self.home_geo_point,
            PLACE_METHOD: self.place,
            "simSetVehiclePose": self.set_vehicle_pose,
            "simGetVehiclePose": self.vehicle_pose,
            "simGetGroundTruthKinematics": self.true_kinematics,
            "simGetGroundTruthEnvironment": self.environment,
            "simGetCollisionInfo": self.collision_info,
            "getMultirotorState": self.multirotor_state,
            "getImuData": self.imu,
            "getMagnetometerData": self.magnetometer,
            "getBarometerData": self.barometer,
            "getGpsData": self.gps,
            "getDistanceSensorData": self.distance,
        }
        return {name: checked(name, method) for name, method in asked.items()}

    def place(self) -> dict[str, object]:
        """Return which world this is, where the drone stands and where it stood at first: no other simulator tells."""
        sim = self._sim
        home, here, atlas = sim.drone.start, sim.drone.state(sim.now_s), sim.atlas
        return {
            "world": atlas.world.name,
            "digest": atlas.digest,
            "x_m": here.x_m,
            "y_m": here.y_m,
            "heading_rad": here.heading_rad,
            "home_x_m": home.x_m,
            "home_y_m": home.y_m,
        }

    def pause(self, is_paused: bool) -> None:
        """Hold time, or let it go."""
        if is_paused:
            self._sim.timeline.hold()
        else:
            self._sim.timeline.let_go()

    def go_on_for(self, seconds: Step) -> "asyncio.Future[None]":
        """Let time pass for a while, then hold it."""
        return self._sim.timeline.go_on_for(seconds)

    def enable_api_control(self, is_enabled: bool, vehicle_name: Name = "") -> None:
        """Give the vehicle to programs, or take it back: then it stands still."""
        self._sim.check_name(vehicle_name)
        if not is_enabled:
            self._sim.end_command()
        self._sim.is_controlled = is_enabled

    def is_api_control_enabled(self, vehicle_name: Name = "") -> bool:
        """Whether the vehicle obeys programs."""
        self._sim.check_name(vehicle_name)
        return self._sim.is_controlled

    def arm(self, arm: bool, vehicle_name: Name = "") -> bool:
        """Motors on or off; in the air they stay on."""
        self._sim.check_name(vehicle_name)
        if not self._sim.is_controlled:
            raise MethodError("API control is not enabled: call enableApiControl(True) first")
        if not arm and not self._sim.drone.is_landed(self._sim.now_s):
            return False
        self._sim.is_armed = arm
        return True

    def home_geo_point(self, vehicle_name: Name = "") -> Wire:
        """Return where on earth home is."""
        self._sim.check_name(vehicle_name)
        home = self._sim.home
        return self._sim.geo_point(home.x_m, home.y_m, home.z_m)

    def set_vehicle_pose(self, pose: LoosePose, ignore_collision: bool, vehicle_name: Name = "") -> None:
        """Put the vehicle somewhere else; it stays within the world and above the ground."""
        del ignore_collision
        sim = self._sim
        sim.check_name(vehicle_name)
        state = sim.drone.state(sim.now_s)
        old = sim.home.ned_m(state.x_m, state.y_m, state.z_m)
        given = (pose.position.x_val, pose.position.y_val, pose.position.z_val)
        if any(map(math.isinf, given)):
            raise MethodError("simSetVehiclePose takes finite numbers, or NaN for what is to stay")
        new = [now if math.isnan(value) else value for now, value in zip(old, given, strict=True)]
        x_m, y_m, z_m = sim.home.enu_m(*new)
        heading_rad = state.heading_rad
        turned = pose.orientation.model_dump()
        if not any(map(math.isnan, turned.values())):
            try:
                heading_rad = attitude(turned).yaw_rad
            except ValueError as error:
                raise MethodError(f"simSetVehiclePose: {error}") from error
        if not sim.atlas.world.bounds.contains(x_m, y_m) or z_m > 10_000.0:
            raise MethodError("simSetVehiclePose: that is off the world")
        sim.end_command()
        sim.drone.place(sim.now_s, Pose(x_m, y_m, z_m, heading_rad))

    def vehicle_pose(self, vehicle_name: Name = "") -> Wire:
        """Return where the vehicle really is."""
        self._sim.check_name(vehicle_name)
        return messages.pose(self._sim.home, self._sim.drone.state(self._sim.now_s))

    def true_kinematics(self, vehicle_name: Name = "") -> Wire:
        """Return where the vehicle really is and how it moves."""
        self._sim.check_name(vehicle_name)
        return messages.kinematics(self._sim.home, self._sim.drone.state(self._sim.now_s))

    def environment(self, vehicle_name: Name = "") -> Wire:
        """Return what is around the vehicle."""
        self._sim.check_name(vehicle_name)
        now_s = self._sim.now_s
        state, geo_point = self._sim.drone.state(now_s), self._geo_point(now_s)
        air = messages.barometer(geo_point["altitude"], now_s)
        return {
            "position": messages.pose(self._sim.home, state)["position"],
            "geo_point": geo_point,
            "gravity": {"x_val": 0.0, "y_val": 0.0, "z_val": messages.GRAVITY_MPS2},
            "air_pressure": air["pressure"],
            "temperature": 288.15 - 0.0065 * geo_point["altitude"],
            "air_density": 1.225 * air["pressure"] / 101_325.0,
        }

    def collision_info(self, vehicle_name: Name = "") -> Wire:
        """Return what the vehicle last ran into; asking makes it forget that it did, as with AirSim."""
        told = self._collision(vehicle_name)
        self._sim.hits_told_s = self._sim.now_s
        return told

    def multirotor_state(self, vehicle_name: Name = "") -> Wire:
        """Return what the vehicle knows of itself."""
        sim, now_s = self._sim, self._sim.now_s
        collision = self._collision(vehicle_name)
        return {
            "collision": collision,
            "kinematics_estimated": messages.kinematics(sim.home, sim.belief()),
            "gps_location": self._geo_point(now_s),
            "timestamp": messages.nanoseconds(now_s),
            "landed_state": 0 if sim.drone.is_landed(now_s) else 1,
            "rc_data": messages.no_remote_control(),
            "ready": True,
            "ready_message": "",
            "can_arm": True,
        }

    def imu(self, imu_name: Name = "", vehicle_name: Name = "") -> Wire:
        """Return what the inertial sensor measures, without error."""
        del imu_name
        self._sim.check_name(vehicle_name)
        return messages.imu(self._sim.drone.state(self._sim.now_s), self._sim.now_s)

    def magnetometer(self, magnetometer_name: Name = "", vehicle_name: Name = "") -> Wire:
        """Return the magnetic field, without error."""
        del magnetometer_name
        self._sim.check_name(vehicle_name)
        return messages.magnetometer(self._sim.drone.state(self._sim.now_s), self._sim.now_s)

    def barometer(self, barometer_name: Name = "", vehicle_name: Name = "") -> Wire:
        """Return the pressure, without error."""
        del barometer_name
        self._sim.check_name(vehicle_name)
        now_s = self._sim.now_s
        return messages.barometer(self._geo_point(now_s)["altitude"], now_s)

    def gps(self, gps_name: Name = "", vehicle_name: Name = "") -> Wire:
        """Return what the satellite receiver says, without error."""
        del gps_name
        self._sim.check_name(vehicle_name)
        now_s = self._sim.now_s
        heard_s = now_s - self._sim.mishaps.silent_s(MishapKind.POSITION_SILENCE, now_s)
        return messages.gps(self._geo_point(now_s), self._sim.drone.state(now_s), heard_s)

    def distance(self, distance_sensor_name: Name = "", vehicle_name: Name = "") -> Wire:
        """Return how far it is straight ahead to something solid, without error."""
        del distance_sensor_name
        sim, now_s = self._sim, self._sim.now_s
        sim.check_name(vehicle_name)
        at = sim.drone.state(now_s)
        ahead_m, _, _ = sim.atlas.sight.cast(at.x_m, at.y_m, at.z_m, at.heading_rad, _FARTHEST_M)
        zero: dict[str, Any] = {"x_val": 0.0, "y_val": 0.0, "z_val": 0.0}
        return {
            "time_stamp": messages.nanoseconds(now_s),
            "distance": max(_NEAREST_M, ahead_m),
            "min_distance": _NEAREST_M,
            "max_distance": _FARTHEST_M,
            "relative_pose": {"position": zero, "orientation": {**zero, "w_val": 1.0}},
        }

    def _collision(self, vehicle_name: str) -> Wire:
        sim = self._sim
        sim.check_name(vehicle_name)
        sim.drone.state(sim.now_s)
        last = sim.drone.last_hit
        fresh = last is not None and last[0] > sim.hits_told_s
        return messages.collision(sim.home, last, fresh=fresh, radius_m=sim.drone.profile.radius_m)

    def _geo_point(self, now_s: float) -> Wire:
        state = self._sim.drone.state(now_s)
        return self._sim.geo_point(state.x_m, state.y_m, state.z_m)
