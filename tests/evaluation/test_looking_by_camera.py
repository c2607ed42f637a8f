"""A machine whose one camera looks ahead turns its body to look; the camera and the autopilot are served ones."""

import numpy as np
import pytest

from reasoned_explorer.clock import VirtualClock
from reasoned_explorer.evaluation.equipment import Equipment
from reasoned_explorer.evaluation.vehicle_address import Errand, MavlinkAddress
from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import View
from reasoned_explorer.serving.background import BackgroundServer
from reasoned_explorer.serving.mavlink.server import AS_FAST_AS_ASKED, MavlinkServer
from reasoned_explorer.vehicles import PROFILES
from reasoned_explorer.vehicles.cameras import parse_camera
from reasoned_explorer.vehicles.mavlink.address import Address, Wire
from reasoned_explorer.world.atlas import Atlas
from tests.vehicles.cameras.served import RED, served_camera
from tests.world.worlds import field

pytest.importorskip("pymavlink", reason="what MAVLink is spoken with is not installed")
START = Pose(50.0, 50.0)
DRONE = PROFILES["drone"]


def looked(errand: Errand, equipment: Equipment, headings_rad: list[float]) -> tuple[list[View], float, bool]:
    """Return a drone's views, where it faces then, and how old its newest picture is told to be."""
    clock = errand.clock

    def autopilot() -> MavlinkServer:
        return MavlinkServer(Atlas(field()), START, profile=DRONE, speed=AS_FAST_AS_ASKED)

    async def run(port: int) -> tuple[list[View], float, bool]:
        address = MavlinkAddress(Address(Wire.UDP_OUT, "127.0.0.1", port), equipment=equipment)
        vehicle = address.vehicle(DRONE, errand)
        async with vehicle:
            views = await vehicle.look(headings_rad)
            age_s = vehicle.telemetry().picture_age_s  # type: ignore[attr-defined]
            return list(views), vehicle.pose.heading_rad, age_s is not None

    with BackgroundServer(autopilot) as served:
        return clock.run(run(served.port))


def test_a_drone_whose_camera_looks_ahead_turns_to_each_heading() -> None:
    errand = Errand(VirtualClock(), START, may_move=True, picture_px=64)
    with served_camera() as camera:
        camera.show(RED)
        views, heading_rad, tells = looked(errand, Equipment(camera=parse_camera(camera.address)), [0.0, 1.0, 2.0])
    assert tells
    assert [view.pose.heading_rad for view in views] == pytest.approx([0.0, 1.0, 2.0], abs=0.1)
    assert heading_rad == pytest.approx(2.0, abs=0.1)
    for view in views:
        assert view.image.shape == (DRONE.camera.height_px, DRONE.camera.width_px, 3)
        assert np.abs(view.image.mean(axis=(0, 1)) - RED).max() < 40.0


def test_where_no_pictures_are_wanted_it_does_not_turn_and_no_camera_is_opened() -> None:
    errand = Errand(VirtualClock(), START, pictures=False, may_move=True)
    views, heading_rad, tells = looked(errand, Equipment(camera=parse_camera("rtsp://127.0.0.1:9/x")), [0.0, 1.0, 2.0])
    assert not tells
    assert heading_rad == pytest.approx(0.0, abs=0.05)
    assert [view.image for view in views] == [None] * 3
