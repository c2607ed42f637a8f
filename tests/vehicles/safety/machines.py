"""The vehicles that a guard is tried with, each in the same meadow, with the same faults.

One more vehicle is one more entry in `MACHINES`.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass

from reasoned_explorer.clock import Clock, VirtualClock
from reasoned_explorer.geometry import Pose
from reasoned_explorer.serving.airsim.server import AS_FAST_AS_ASKED, AirSimServer
from reasoned_explorer.serving.background import BackgroundServer
from reasoned_explorer.simulation.mishaps import Mishap, MishapKind
from reasoned_explorer.simulation.sighting import ViewContent
from reasoned_explorer.simulation.vehicle import SimulatedVehicle
from reasoned_explorer.vehicles import PROFILES, Vehicle, VehicleProfile
from reasoned_explorer.vehicles.airsim.settings import DriverSettings
from reasoned_explorer.vehicles.airsim.vehicle import AirSimVehicle
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.world import Building
from tests.world.worlds import box, field

#: A meadow of 100 m with a house in the north.
HOUSE = box(40.0, 62.0, 60.0, 75.0)
START = Pose(50.0, 50.0, 0.0, 0.0)


def meadow() -> Atlas:
    return Atlas(field(buildings=[Building(HOUSE, 8.0)]))


class NoEyes:
    def look(self, pose, camera):
        return ViewContent((), (), 0.0, math.inf)


@dataclass
class Ready:
    """A vehicle to try a guard with.

    Attributes:
        make: Makes the driver for a profile.
        profile: Of the machine.
        clock: The mission's.
        true_pose: Where the machine really is now.
        simulated_s: The simulator's own time.
        range_ahead_m: What a guard is given to see obstacles; None where the vehicle tells itself.
    """

    make: Callable[[VehicleProfile], Vehicle]
    profile: VehicleProfile
    clock: Clock
    true_pose: Callable[[], Pose]
    simulated_s: Callable[[], float]
    range_ahead_m: Callable[[Pose], float | None] | None = None


@contextmanager
def embedded(atlas: Atlas, profile: str, mishaps: Sequence[Mishap]) -> Iterator[Ready]:
    clock = VirtualClock()
    made: list[SimulatedVehicle] = []

    def make(limited: VehicleProfile) -> Vehicle:
        made.append(
            SimulatedVehicle(atlas, limited, START, clock=clock, eyes=NoEyes(), seed=3, noise="none", mishaps=mishaps)
        )
        return made[-1]

    def ahead_m(pose: Pose) -> float | None:
        return atlas.sight.cast(pose.x_m, pose.y_m, pose.z_m, pose.heading_rad, 40.0)[0]

    def true_pose() -> Pose:
        now = made[-1].telemetry().pose
        jump = [one for one in mishaps if one.kind is MishapKind.POSITION_JUMP and one.from_s <= clock.now_s()]
        return Pose(now.x_m - sum(one.amount for one in jump), now.y_m, now.z_m, now.heading_rad)

    yield Ready(make, PROFILES[profile], clock, true_pose, clock.now_s, ahead_m)


@contextmanager
def airsim(atlas: Atlas, profile: str, mishaps: Sequence[Mishap]) -> Iterator[Ready]:
    clock = VirtualClock()

    def serve() -> AirSimServer:
        return AirSimServer(atlas, START, profile=PROFILES[profile], speed=AS_FAST_AS_ASKED, mishaps=mishaps)

    with BackgroundServer(serve) as served:
        is_seen = all(one.kind is not MishapKind.CAMERA_SILENCE for one in mishaps)
        settings = DriverSettings(pictures=not is_seen, range_sensor="", deadline_s=30.0)

        def make(limited: VehicleProfile) -> Vehicle:
            content = NoEyes().look
            return AirSimVehicle(limited, clock=clock, port=served.port, home=START, settings=settings, content=content)

        def true_pose() -> Pose:
            sim = served.server.simulator
            state = sim.drone.state(sim.now_s)
            return Pose(state.x_m, state.y_m, state.z_m, state.heading_rad)

        yield Ready(make, PROFILES[profile], clock, true_pose, lambda: served.server.simulator.now_s)


@dataclass
class Machine:
    """An entry of the table.

    Attributes:
        make: Makes it ready for a world, a profile and what befalls it.
        profile: By name.
        lacks: The faults that do not exist for it, each with the reason.
    """

    make: Callable[[Atlas, str, Sequence[Mishap]], AbstractContextManager[Ready]]
    profile: str
    lacks: dict[str, str]


MACHINES = {
    "embedded drone": Machine(embedded, "drone", {}),
    "embedded walker": Machine(embedded, "go1", {}),
    "AirSim drone": Machine(airsim, "drone", {"battery low": "AirSim's drones have no battery"}),
}
