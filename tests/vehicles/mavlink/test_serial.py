"""An autopilot on a serial line: a pseudo terminal, whose far end is the driver's."""

import os
import select
import socket
import threading
from contextlib import contextmanager

import pytest

from reasoned_explorer.clock import VirtualClock
from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import LegOutcome
from reasoned_explorer.serving.background import BackgroundServer
from reasoned_explorer.serving.mavlink.server import AS_FAST_AS_ASKED, MavlinkServer
from reasoned_explorer.vehicles import PROFILES
from reasoned_explorer.vehicles.mavlink.settings import DriverSettings
from reasoned_explorer.vehicles.mavlink.vehicle import MavlinkVehicle
from reasoned_explorer.world.atlas import Atlas
from tests.world.worlds import field

pytest.importorskip("pymavlink")
pytest.importorskip("serial", reason="pyserial is not installed (the extra `vehicles`)")
if not hasattr(os, "openpty"):
    pytest.skip("no pseudo terminals here", allow_module_level=True)

HOME = Pose(50.0, 50.0)


@contextmanager
def line_to(port):
    """Yield the name of a serial device behind which whatever is served on a TCP port answers."""
    near, far = os.openpty()
    wire = socket.create_connection(("127.0.0.1", port))
    over = threading.Event()

    def carry():
        while not over.is_set():
            ready, _, _ = select.select([near, wire], [], [], 0.05)
            if near in ready:
                wire.sendall(os.read(near, 4096))
            if wire in ready:
                data = wire.recv(4096)
                if not data:
                    return
                while data:
                    data = data[os.write(near, data) :]

    carrying = threading.Thread(target=carry, daemon=True)
    try:
        name = os.ttyname(far)
        carrying.start()
        yield name
    finally:
        over.set()
        carrying.join(5.0)
        wire.close()
        os.close(near)
        os.close(far)


def test_a_drone_on_a_serial_line_flies():
    atlas, clock = Atlas(field(("tree", 70.0, 50.0))), VirtualClock()
    settings = DriverSettings(arms=True, lost_s=300.0, reply_s=100.0)

    def serve():
        return MavlinkServer(atlas, HOME, wire="tcp", speed=AS_FAST_AS_ASKED)

    async def fly(device):
        vehicle = MavlinkVehicle(
            PROFILES["drone"], clock=clock, address=f"{device},57600", home=HOME, settings=settings
        )
        async with vehicle:
            return await vehicle.go_to(Pose(54.0, 50.0)), vehicle.autopilot.link.malformed

    with BackgroundServer(serve) as served, line_to(served.port) as device:
        leg, _ = clock.run(fly(device))
        assert not served.server.pilot.is_armed
    assert leg.outcome is LegOutcome.ARRIVED
