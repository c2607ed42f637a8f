"""The vehicles that a guard is tried with, each in the same meadow, with the same faults.

One more vehicle is one more entry in `MACHINES`.
"""

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, field

import pytest

from reasoned_explorer.clock import Clock, VirtualClock
from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import PartError
from reasoned_explorer.serving.airsim.server import AS_FAST_AS_ASKED, AirSimServer
from reasoned_explorer.serving.background import BackgroundServer
from reasoned_explorer.serving.go1.gnss import GnssServer
from reasoned_explorer.serving.go1.server import Go1Server
from reasoned_explorer.serving.go1.walker import Walker
from reasoned_explorer.serving.mavlink.server import MavlinkServer
from reasoned_explorer.simulation.mishaps import Mishap, MishapKind
from reasoned_explorer.simulation.sighting import ViewContent
from reasoned_explorer.simulation.vehicle import SimulatedVehicle
from reasoned_explorer.vehicles import PROFILES, Vehicle, VehicleProfile
from reasoned_explorer.vehicles.airsim.settings import DriverSettings
from reasoned_explorer.vehicles.airsim.vehicle import AirSimVehicle
from reasoned_explorer.vehicles.mavlink.settings import DriverSettings as MavlinkSettings
from reasoned_explorer.vehicles.mavlink.vehicle import MavlinkVehicle
from reasoned_explorer.vehicles.positioning import Receiver, parse_source
from reasoned_explorer.vehicles.unitree.lockstep import LockstepGo1
from reasoned_explorer.vehicles.unitree.settings import WalkSettings
from reasoned_explorer.vehicles.unitree.vehicle import UnitreeVehicle
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.world import Building
from tests.vehicles.unitree.walked_go2 import SteppedGo2, WalkedGo2
from tests.world.worlds import box
from tests.world.worlds import field as meadow_of

#: A meadow of 100 m with a house in the north.
HOUSE = box(40.0, 62.0, 60.0, 75.0)
START = Pose(50.0, 50.0, 0.0, 0.0)


def meadow() -> Atlas:
    return Atlas(meadow_of(buildings=[Building(HOUSE, 8.0)]))


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


class Silent:
    """A fake of a camera that gives nothing: a machine behind MAVLink or a Go1 is looked from by another wire."""

    async def take(self, bearing_rad):
        raise PartError("camera", "no picture comes")

    def __call__(self):
        raise PartError("camera", "no picture comes")


def camera_for(mishaps: Sequence[Mishap]) -> Silent | None:
    return Silent() if any(one.kind is MishapKind.CAMERA_SILENCE for one in mishaps) else None


def sight_of(atlas: Atlas) -> Callable[[Pose], float | None]:
    return lambda pose: atlas.sight.cast(pose.x_m, pose.y_m, max(0.3, pose.z_m), pose.heading_rad, 40.0)[0]


#: What an autopilot is set to, so that it stays where it stands where nobody is heard. ArduPilot's failsafe comes after
#: two seconds at least, its rovers' after three: until then they must have come to stand without it.
SOONEST = {"FS_GCS_ENABLE": 7.0, "FS_GCS_TIMEOUT": 2.0, "FS_TIMEOUT": 1.0, "FS_ACTION": 2.0, "COM_OF_LOSS_T": 0.5}


def mavlink(flavour: str) -> Callable[[Atlas, str, Sequence[Mishap]], AbstractContextManager[Ready]]:
    @contextmanager
    def ready(atlas: Atlas, profile: str, mishaps: Sequence[Mishap]) -> Iterator[Ready]:
        clock = VirtualClock()

        def serve() -> MavlinkServer:
            server = MavlinkServer(
                atlas, START, flavour=flavour, profile=PROFILES[profile], speed=AS_FAST_AS_ASKED, mishaps=mishaps
            )
            server.warm_up()
            for name in set(SOONEST) & set(server.pilot.parameters.names):
                assert server.pilot.parameters.set(name, SOONEST[name])
            return server

        with BackgroundServer(serve) as served:
            # Three times a second and a half without an answer is a lost link, three hundred without a heartbeat none.
            settings = MavlinkSettings(arms=True, lost_s=300.0, reply_s=1.5)

            def make(limited: VehicleProfile) -> Vehicle:
                return MavlinkVehicle(
                    limited,
                    clock=clock,
                    address=f"udpout:127.0.0.1:{served.port}",
                    home=START,
                    settings=settings,
                    camera=camera_for(mishaps),
                    content=NoEyes().look,
                )

            def true_pose() -> Pose:
                pilot = served.server.pilot
                state = pilot.drone.state(pilot.now_s)
                return Pose(state.x_m, state.y_m, state.z_m, state.heading_rad)

            def simulated_s() -> float:
                # Nobody lets its time go on where its link is lost: it runs on to its failsafe.
                pilot = served.server.pilot
                return pilot.now_s if pilot.is_busy else pilot.rests_since_s

            yield Ready(make, PROFILES[profile], clock, true_pose, simulated_s, sight_of(atlas))

    return ready


@contextmanager
def go1(atlas: Atlas, profile: str, mishaps: Sequence[Mishap]) -> Iterator[Ready]:
    clock = VirtualClock()

    def serve() -> Go1Server:
        walker = Walker(atlas, PROFILES[profile], START, mishaps=mishaps)
        return Go1Server(walker, gnss=GnssServer(walker.noise), lockstep=True)

    with BackgroundServer(serve) as served:
        walker, gnss = served.server.walker, served.server.gnss

        def make(limited: VehicleProfile) -> Vehicle:
            source = parse_source(f"gpsd://127.0.0.1:{served.server.gnss_port}")
            return UnitreeVehicle(
                limited,
                LockstepGo1("127.0.0.1", served.port, deadline_s=1.5),
                clock=clock,
                home=START,
                positions=Receiver(source, origin=gnss.origin, now_s=clock.now_s),
                camera=camera_for(mishaps),
                settings=WalkSettings(poll_s=0.1),
                content=NoEyes().look,
            )

        yield Ready(
            make, PROFILES[profile], clock, lambda: walker.body.true_pose, lambda: walker.time_s, sight_of(atlas)
        )


@contextmanager
def go2(atlas: Atlas, profile: str, mishaps: Sequence[Mishap]) -> Iterator[Ready]:
    """The driver of a Go2 with a fake of its vendor's SDK, which is nowhere here."""
    clock = VirtualClock()

    def serve() -> WalkedGo2:
        walker = Walker(atlas, PROFILES[profile], START, mishaps=mishaps)
        return WalkedGo2(walker, GnssServer(walker.noise))

    with BackgroundServer(serve) as served, pytest.MonkeyPatch.context() as patch:
        robot = served.server
        robot.install(patch)

        def make(limited: VehicleProfile) -> Vehicle:
            source = parse_source(f"gpsd://127.0.0.1:{robot.gnss_port}")
            return UnitreeVehicle(
                limited,
                SteppedGo2(robot),
                clock=clock,
                home=START,
                positions=Receiver(source, origin=robot.gnss.origin, now_s=clock.now_s),
                camera=camera_for(mishaps),
                settings=WalkSettings(poll_s=0.1),
                content=NoEyes().look,
            )

        def true_pose() -> Pose:
            return robot.walker.body.true_pose

        yield Ready(make, PROFILES[profile], clock, true_pose, lambda: robot.moved_s, sight_of(atlas))


@dataclass
class Machine:
    """An entry of the table.

    Attributes:
        make: Makes it ready for a world, a profile and what befalls it.
        profile: By name.
        lacks: The faults that do not exist for it, each with the reason.
        ahead_s: So far its simulator, stepped, may be ahead of the mission's clock: one poll of its driver.
    """

    make: Callable[[Atlas, str, Sequence[Mishap]], AbstractContextManager[Ready]]
    profile: str
    lacks: dict[str, str] = field(default_factory=dict)
    ahead_s: float = 0.0


MACHINES = {
    "embedded drone": Machine(embedded, "drone"),
    "embedded walker": Machine(embedded, "go1"),
    "AirSim drone": Machine(airsim, "drone", {"battery low": "AirSim's drones have no battery"}),
    "MAVLink drone, ArduPilot": Machine(mavlink("arducopter"), "drone", ahead_s=0.25),
    "MAVLink drone, PX4": Machine(mavlink("px4"), "drone", ahead_s=0.25),
    "MAVLink rover, ArduPilot": Machine(mavlink("ardurover"), "go1", ahead_s=0.25),
    "Unitree Go1": Machine(go1, "go1", ahead_s=0.1),
    "Unitree Go2, fake SDK": Machine(go2, "go1", ahead_s=0.1),
}
