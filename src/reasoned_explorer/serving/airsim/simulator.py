"""What the methods of the served AirSim share: the drone, its time, its cameras, and which command it is at."""

import asyncio
from collections.abc import Callable
from typing import TYPE_CHECKING

from reasoned_explorer.geometry import GeoOrigin, Pose
from reasoned_explorer.serving.airsim.drone import Drone
from reasoned_explorer.serving.airsim.flight import Flight, State
from reasoned_explorer.serving.airsim.scenery import Scenery
from reasoned_explorer.serving.airsim.settings import AirSimSettings
from reasoned_explorer.serving.airsim.studio import Studio
from reasoned_explorer.serving.airsim.timeline import Alarm, Timeline
from reasoned_explorer.serving.msgpack_rpc import MethodError
from reasoned_explorer.simulation.mishaps import Mishaps
from reasoned_explorer.simulation.sensors import SensorNoise
from reasoned_explorer.vehicles.airsim.conventions import HomeFrame, Wire
from reasoned_explorer.vehicles.profile import VehicleProfile

if TYPE_CHECKING:
    from reasoned_explorer.world.atlas import Atlas


class Simulator:
    """One drone in one world, with its time.

    Args:
        atlas: Of the world.
        profile: What the drone can do.
        start: Where it stands at the start: home, where positions on the wire count from.
        settings: AirSim's settings.
        speed: Simulated seconds in a real one, or infinite for as fast as asked.
        noise: How the sensors err by which it steers.
        seed: Of all draws.
        conditions: Time of day and weather of pictures.
        mishaps: What befalls the drone, on its own time.

    Raises:
        StartError: If the drone cannot stand at the start.
        SettingsError: If the speed is out of range.
        UnknownNameError: If there is no such preset of noise.
    """

    def __init__(
        self,
        atlas: "Atlas",
        profile: VehicleProfile,
        start: Pose,
        *,
        settings: AirSimSettings,
        speed: float,
        noise: SensorNoise | str,
        seed: int,
        conditions: str,
        mishaps: Mishaps,
    ) -> None:
        self.atlas, self.settings = atlas, settings
        self.drone = Drone(atlas, profile, start, noise=noise, seed=seed)
        self.home = HomeFrame(start.x_m, start.y_m, 0.0)
        self.timeline = Timeline(speed)
        self.scenery = Scenery(atlas)
        self.studio = Studio(atlas, self.scenery, settings, conditions)
        self.mishaps = mishaps
        self.is_controlled = self.is_armed = False
        #: Up to when collisions have been asked about, the server's seconds.
        self.hits_told_s = -1.0
        self._command: tuple[asyncio.Future[bool], Alarm] | None = None

    @property
    def now_s(self) -> float:
        """The time, seconds."""
        return self.timeline.now_s

    def belief(self) -> State:
        """Return where the drone says that it is."""
        now_s = self.now_s
        state = self.drone.belief(now_s)
        told = self.mishaps.told(Pose(state.x_m, state.y_m, state.z_m, state.heading_rad), now_s)
        return state._replace(x_m=told.x_m, heading_rad=told.heading_rad)

    def reset(self) -> None:
        """Begin anew; time goes on."""
        self.end_command()
        self.drone.reset()
        self.scenery.reset()
        self.studio.reset()
        self.is_controlled = self.is_armed = False
        self.hits_told_s = -1.0

    def check_name(self, vehicle_name: str) -> None:
        """Check that there is such a vehicle.

        Raises:
            MethodError: If there is none.
        """
        if vehicle_name not in {"", self.settings.vehicle_name}:
            known = self.settings.vehicle_name
            raise MethodError(f"there is no vehicle {vehicle_name!r:.60}; there is {known}")

    def check_flies(self, vehicle_name: str) -> None:
        """Check that commands are obeyed.

        Raises:
            MethodError: If they are not: the vehicle is not given to programs, or not armed.
        """
        self.check_name(vehicle_name)
        if not self.is_controlled:
            raise MethodError("API control is not enabled: call enableApiControl(True) first")
        if not self.is_armed:
            raise MethodError("the vehicle is not armed: call armDisarm(True) first")

    def obey(self, begin: Callable[[float], Flight]) -> "asyncio.Future[bool]":
        """Begin a flight, which ends what the drone was doing; return a future of whether it came about."""
        self._drop_command()
        flight = begin(self.now_s)
        answer: asyncio.Future[bool] = asyncio.get_running_loop().create_future()

        def over() -> None:
            self._command = None
            if not answer.done():
                answer.set_result(flight.succeeded)

        alarm = self.timeline.at(flight.start_s + flight.answer_s, over)
        self._command = answer, alarm
        return answer

    def at_once(self, *, succeeded: bool = True) -> "asyncio.Future[bool]":
        """Return the answer of a command that takes no time."""
        answer: asyncio.Future[bool] = asyncio.get_running_loop().create_future()
        answer.set_result(succeeded)
        return answer

    def end_command(self) -> None:
        """Have the drone stand still where it is; what it was doing is answered with false."""
        self._drop_command()
        self.drone.stop(self.now_s)

    def geo_point(self, x_m: float, y_m: float, z_m: float) -> Wire:
        """Return where on earth a point is: of a world that lies nowhere, about AirSim's own origin."""
        base, origin = self.settings.OriginGeopoint, self.atlas.world.origin
        if origin is None:
            origin = GeoOrigin(base.Latitude, base.Longitude)
            x_m, y_m = x_m - self.home.x_m, y_m - self.home.y_m
        lat_deg, lon_deg = origin.geodetic_from_enu_deg(x_m, y_m)
        return {"latitude": lat_deg, "longitude": lon_deg, "altitude": base.Altitude + z_m}

    def _drop_command(self) -> None:
        command, self._command = self._command, None
        if command is not None:
            answer, alarm = command
            self.timeline.cancel(alarm)
            if not answer.done():
                answer.set_result(False)
