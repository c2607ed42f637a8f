"""A guard on a real clock, over a real wire: the machine stands within a second of the fault."""

import asyncio
import math
import time

import pytest

from reasoned_explorer.clock import RealClock
from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import LegOutcome, PartError
from reasoned_explorer.serving.background import BackgroundServer
from reasoned_explorer.serving.mavlink.server import MavlinkServer
from reasoned_explorer.simulation.mishaps import Mishap, MishapKind, Mishaps
from reasoned_explorer.vehicles import PROFILES
from reasoned_explorer.vehicles.safety import Cause, SafetyLimits, guarded
from tests.vehicles.safety.machines import START, meadow

pytest.importorskip("pymavlink")

from reasoned_explorer.vehicles.mavlink.settings import DriverSettings
from reasoned_explorer.vehicles.mavlink.vehicle import MavlinkVehicle

WEST = Pose(20.0, 50.0, 0.0, 1.5 * math.pi)
#: From the fault on the machine has so long to stand, wall seconds; then it is watched for a while.
SOON_S, WATCHED_S = 1.0, 0.5


def lose_the_link(guard, server):
    server.pilot.mishaps = Mishaps((Mishap(MishapKind.LINK_LOSS, server.pilot.now_s),))


def press_the_stop(guard, server):
    guard.stop.press()


@pytest.mark.parametrize(
    ("befall", "cause"), [(lose_the_link, Cause.LINK), (press_the_stop, Cause.OPERATOR)], ids=["link loss", "stop"]
)
def test_it_stands_within_a_second_of_wall_time(befall, cause):
    clock, atlas = RealClock(), meadow()

    def serve():
        server = MavlinkServer(atlas, START, flavour="px4-rover", speed=1.0)
        server.warm_up()
        # Where nothing is heard any more, the autopilot alone can stop it.
        assert server.pilot.parameters.set("COM_OF_LOSS_T", 0.5)
        return server

    with BackgroundServer(serve) as served:
        pilot = served.server.pilot

        def make(profile):
            settings = DriverSettings(arms=True, rate_hz=20.0, poll_s=0.1, reply_s=1.0)
            return MavlinkVehicle(
                profile, clock=clock, address=f"udpout:127.0.0.1:{served.port}", home=START, settings=settings
            )

        def place():
            state = pilot.drone.state(pilot.now_s)
            return state.x_m, state.y_m

        async def script():
            guard = guarded(make, PROFILES["go1"], SafetyLimits(), clock=clock)
            await guard.start()
            going = asyncio.ensure_future(guard.go_to(WEST))
            await asyncio.sleep(3.5)  # it has turned and walks
            before = place()
            await asyncio.sleep(0.2)
            assert math.dist(before, place()) > 0.05
            befell_s = time.monotonic()
            befall(guard, served.server)
            await asyncio.sleep(SOON_S - (time.monotonic() - befell_s))
            soon = place()
            await asyncio.sleep(WATCHED_S)
            assert math.dist(soon, place()) < 0.01
            leg = await going
            try:
                await guard.close()
            except PartError:
                assert cause is Cause.LINK
            return guard, leg

        guard, leg = clock.run(script())
    assert guard.events[0].cause == cause.value
    assert leg.outcome is LegOutcome.STOPPED
    assert leg.detail.startswith(cause.value)
