"""The embedded simulator as a program that AirSim's clients can talk to."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Self

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Fault, SettingsError
from reasoned_explorer.serving.airsim.drifting import Drift, Yaw
from reasoned_explorer.serving.airsim.drone import Drone
from reasoned_explorer.serving.airsim.flight_methods import FlightMethods
from reasoned_explorer.serving.airsim.scene_methods import SceneMethods
from reasoned_explorer.serving.airsim.settings import AUTHORS_RIG, AirSimSettings
from reasoned_explorer.serving.airsim.simulator import Simulator
from reasoned_explorer.serving.airsim.state_methods import StateMethods
from reasoned_explorer.serving.msgpack_rpc import Method, MethodError, RpcServer
from reasoned_explorer.simulation.mishaps import Mishap, MishapKind, Mishaps
from reasoned_explorer.simulation.sensors import SensorNoise
from reasoned_explorer.vehicles.profile import PROFILES, VehicleProfile

if TYPE_CHECKING:
    from reasoned_explorer.world.atlas import Atlas

#: What a server can say of its version: AirSim and Colosseum, or Cosys-AirSim.
GENERATIONS = (1, 4)
#: As fast as asked: time jumps to whatever is waited for.
AS_FAST_AS_ASKED = math.inf


class AirSimServer:
    """A drone in a world, served on TCP as AirSim serves it.

    Used as an asynchronous context manager, or by `start` and `close`. It believes whoever reaches its port: it listens
    on this machine alone unless told otherwise.

    Args:
        atlas: Of the world.
        start: Where the drone stands at first: home.
        profile: What it can do; a flyer.
        settings: AirSim's settings; by default the paper's rig, three cameras of 224 × 224 pixels.
        speed: Simulated seconds in a real one, or `AS_FAST_AS_ASKED`; by default the settings' clock speed.
        noise: How the sensors err by which the drone steers: what it takes for its position is off by that.
        seed: Of all draws.
        generation: What the server says of its version; all clients are answered whatever it says.
        conditions: Time of day and weather of pictures.
        mishaps: What befalls the drone, on the server's seconds, which begin with 0. Its link lost, it hovers, as
            autopilots with a failsafe do (AirSim's own goes on with what it was told).

    Raises:
        SettingsError: If a setting is out of range.
        StartError: If the drone cannot stand at the start.
        UnknownNameError: If there is no such preset of noise.
        MissingDependencyError: If the library of the wire is not installed.
    """

    def __init__(
        self,
        atlas: "Atlas",
        start: Pose,
        *,
        profile: VehicleProfile | None = None,
        settings: AirSimSettings | None = None,
        speed: float | None = None,
        noise: SensorNoise | str = "none",
        seed: int = 0,
        generation: int = 1,
        conditions: str = "clear",
        mishaps: Sequence[Mishap] = (),
    ) -> None:
        from reasoned_explorer.rendering.conditions import PRESETS

        profile = profile or PROFILES["drone"]
        faults = []
        if not profile.flies:
            faults.append(Fault(f"{profile.name} does not fly", "the profile of a flyer"))
        if generation not in GENERATIONS:
            faults.append(Fault(f"generation {generation!r:.40}", f"one of {GENERATIONS}"))
        if conditions not in PRESETS:
            faults.append(Fault(f"conditions are {conditions!r:.60}", f"one of {', '.join(PRESETS)}"))
        if faults:
            raise SettingsError("served AirSim", faults)
        self.settings = settings or AirSimSettings.of(AUTHORS_RIG)
        self.simulator = Simulator(
            atlas,
            profile,
            start,
            settings=self.settings,
            speed=self.settings.ClockSpeed if speed is None else speed,
            noise=noise,
            seed=seed,
            conditions=conditions,
            mishaps=Mishaps(tuple(mishaps)),
        )
        tables = (
            StateMethods(self.simulator, generation).table(),
            FlightMethods(self.simulator).table(),
            SceneMethods(self.simulator).table(),
        )
        methods = {name: method for table in tables for name, method in table.items()}
        if mishaps:
            methods = {name: self._cut_off(method) for name, method in methods.items()}
        self._rpc = RpcServer(methods)
        #: Where it listens; None before `start`.
        self.port: int | None = None

    def _cut_off(self, method: Method) -> Method:
        """Return a method that is not reached while the link is lost."""

        def through(*arguments: Any) -> Any:
            sim = self.simulator
            if sim.mishaps.at(MishapKind.LINK_LOSS, sim.now_s):
                sim.end_command()
                self._rpc.hang_up()
                raise MethodError("the link is lost")
            return method(*arguments)

        return through

    async def start(self, host: str = "127.0.0.1", port: int | None = None) -> int:
        """Listen; return the port.

        Args:
            host: On which address.
            port: On which port: 0 for a free one, None for the settings'.

        Raises:
            OSError: If that cannot be listened on.
        """
        self.port = await self._rpc.start(host, self.settings.ApiServerPort if port is None else port)
        return self.port

    def warm_up(self) -> None:
        """Make the scene, and have compiled what flies and draws, so that the first call does not wait for that.

        On a fresh installation this takes a minute or two, else a few seconds.
        """
        drone = self.simulator.drone
        trial = Drone(drone.atlas, drone.profile, drone.start)
        here = drone.start
        trial.fly(0.0, [Pose(here.x_m, here.y_m + 0.5, 1.0, 1.0)], speed_mps=drone.profile.speed_mps, face=True)
        trial.turn(60.0, 2.0)
        trial.drift(120.0, Drift(0.1, 0.0, 0.0, 0.1, Yaw()))
        self.simulator.studio.warm_up()

    async def close(self) -> None:
        """Hang up on everybody and stop. Safe to call twice."""
        await self._rpc.close()
        self.simulator.studio.close()

    async def __aenter__(self) -> Self:
        await self.start(port=0)
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.close()
