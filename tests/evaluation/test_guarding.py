"""A mission's vehicle at an address, as `rex run` makes it: what stands in its way stops it before it is run into."""

import math
from collections.abc import Iterator

import pytest

from reasoned_explorer.evaluation.guarding import Guarding
from reasoned_explorer.evaluation.mission import Mission, MissionSettings
from reasoned_explorer.evaluation.vehicle_address import AirSimAddress, VehicleAddress, vehicle_address
from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Leg, LegOutcome
from reasoned_explorer.serving.airsim.server import AS_FAST_AS_ASKED, AirSimServer
from reasoned_explorer.serving.background import BackgroundServer
from reasoned_explorer.serving.mavlink.server import MavlinkServer
from reasoned_explorer.vehicles import PROFILES
from reasoned_explorer.vehicles.safety.guard import GuardedVehicle
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.world import Building
from tests.world.worlds import box, field

pytest.importorskip("msgpack")

HOME, WALL_M = Pose(50.0, 50.0), 20.0


@pytest.fixture(scope="module")
def atlas() -> Atlas:
    """A meadow with a bench, and a house 20 m north of home."""
    return Atlas(field(("bench", 70.0, 50.0), buildings=[Building(box(40.0, 70.0, 60.0, 80.0), 8.0)]))


def _north(atlas: Atlas, address: VehicleAddress, how_far_m: float) -> tuple[Leg, GuardedVehicle, Pose]:
    """Go north with the vehicle of a mission; return the leg, the vehicle and where it stood in the end."""
    guarding = Guarding(address, may_move=True)
    mission = Mission("Find me a bench", atlas, MissionSettings(), start=HOME, guarding=guarding)
    vehicle = mission.explorer.parts.vehicle  # type: ignore[union-attr]
    assert isinstance(vehicle, GuardedVehicle)

    async def go() -> tuple[Leg, Pose]:
        async with vehicle:
            return await vehicle.go_to(Pose(HOME.x_m, HOME.y_m + how_far_m)), vehicle.pose

    leg, there = mission.clock.run(go())
    return leg, vehicle, there


def _stands_before_the_wall(leg: Leg, vehicle: GuardedVehicle, there: Pose) -> None:
    assert leg.outcome is LegOutcome.STOPPED
    assert leg.detail.startswith("obstacle")
    assert [event.cause for event in vehicle.events] == ["obstacle"]
    left_m = HOME.y_m + WALL_M - there.y_m - PROFILES["drone"].radius_m
    assert vehicle.limits.clearance_m <= left_m < 8.0


@pytest.fixture
def airsim(atlas: Atlas) -> Iterator[VehicleAddress]:
    with BackgroundServer(lambda: AirSimServer(atlas, HOME, speed=AS_FAST_AS_ASKED)) as served:
        yield AirSimAddress("127.0.0.1", served.port)


def test_a_wall_on_the_way_is_seen_over_airsims_wire_in_depth_pictures(atlas: Atlas, airsim: VehicleAddress) -> None:
    _stands_before_the_wall(*_north(atlas, airsim, 30.0))


def test_what_stands_beyond_the_target_does_not_stop_it(atlas: Atlas, airsim: VehicleAddress) -> None:
    leg, vehicle, there = _north(atlas, airsim, 15.0)
    assert leg.outcome is LegOutcome.ARRIVED
    assert not vehicle.events
    assert math.hypot(there.x_m - 50.0, there.y_m - 65.0) < 1.0


def test_where_the_machine_does_not_look_ahead_a_simulators_world_does(atlas: Atlas) -> None:
    drone = PROFILES["drone"]
    with BackgroundServer(lambda: MavlinkServer(atlas, HOME, profile=drone, speed=AS_FAST_AS_ASKED)) as served:
        address = vehicle_address(f"mavlink:udpout:127.0.0.1:{served.port}")
        assert address is not None
        _stands_before_the_wall(*_north(atlas, address, 30.0))


def test_what_looking_compiles_and_loads_is_there_before_the_machine_is_connected_to(
    atlas: Atlas, monkeypatch: pytest.MonkeyPatch
) -> None:
    looked: list[Pose] = []
    content_of = Mission.content

    def counting(mission: Mission):
        content = content_of(mission)

        def counted(pose, camera):
            looked.append(pose)
            return content(pose, camera)

        return counted

    monkeypatch.setattr(Mission, "content", counting)
    # Nobody answers there: had it connected, it would have failed.
    address = vehicle_address("mavlink:udpout:127.0.0.1:9")
    assert address is not None
    Mission("Find me a bench", atlas, MissionSettings(), start=HOME, guarding=Guarding(address, may_move=True))
    assert [(pose.x_m, pose.y_m) for pose in looked] == [(HOME.x_m, HOME.y_m)]
