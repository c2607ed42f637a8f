"""A served Go1 for the tests, and a script that is run with a driver of it."""

from collections.abc import Awaitable, Callable
from typing import Any, Self

from reasoned_explorer.clock import Clock, VirtualClock, run_live
from reasoned_explorer.geometry import Pose
from reasoned_explorer.serving.go1.gnss import GnssServer
from reasoned_explorer.serving.go1.server import Go1Server
from reasoned_explorer.serving.go1.walker import Walker
from reasoned_explorer.vehicles import PROFILES, VehicleProfile
from reasoned_explorer.vehicles.positioning import Receiver, parse_source
from reasoned_explorer.vehicles.unitree import LinkSettings
from reasoned_explorer.vehicles.unitree.vehicle import Go1Vehicle
from reasoned_explorer.world.atlas import Atlas

HOME = Pose(50.0, 50.0)
GO1 = PROFILES["go1"]
#: A busy machine is no lost link: the tests on real time are patient, and walk slowly.
LOST_S = 5.0
SLOW = PROFILES["go1-authors"]


class Served:
    """A server that runs while a `with` block does, in the driver's own event loop."""

    def __init__(self, server: Go1Server) -> None:
        self.server, self.port = server, 0

    def __enter__(self) -> Self:
        self.port = run_live(self.server.start)
        return self

    def __exit__(self, *error: object) -> None:
        run_live(self.server.close)

    @property
    def walker(self) -> Walker:
        return self.server.walker


def served(
    atlas: Atlas,
    *,
    lockstep: bool = True,
    dialect: str = "",
    noise: str = "none",
    seed: int = 0,
    start: Pose = HOME,
    **more: Any,
) -> Served:
    """Return a served robot; with a receiver where a dialect is named."""
    walker = Walker(atlas, GO1, start, noise=noise, seed=seed)
    gnss = GnssServer(walker.noise, dialect=dialect) if dialect else None
    return Served(Go1Server(walker, gnss=gnss, lockstep=lockstep, **more))


def receiver(server: Served, clock: Clock) -> Receiver:
    """Return the receiver that is served beside the robot, as a person would name it."""
    gnss = server.server.gnss
    assert gnss is not None
    port = server.server.gnss_port
    text = f"gpsd://127.0.0.1:{port}" if gnss.dialect == "gpsd" else f"serial:socket://127.0.0.1:{port}"
    return Receiver(parse_source(text), origin=gnss.origin, now_s=clock.now_s)


def walked(
    server: Served,
    script: Callable[[Go1Vehicle], Awaitable[Any]],
    *,
    clock: Clock | None = None,
    home: Pose = HOME,
    by_receiver: bool = False,
    profile: VehicleProfile = GO1,
    lost_s: float = LOST_S,
    **more: Any,
) -> Any:
    """Run a script with a driver of the served robot, from its start to its close."""
    clock = clock or VirtualClock()

    async def run() -> Any:
        positions = receiver(server, clock) if by_receiver else None
        link = LinkSettings(local_port=0, command_lifetime_s=lost_s, lost_after_s=lost_s)
        vehicle = Go1Vehicle(
            profile, clock=clock, host="127.0.0.1", port=server.port, home=home, link=link, positions=positions, **more
        )
        async with vehicle:
            return await script(vehicle)

    return clock.run(run())
