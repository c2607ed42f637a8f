"""A whole mission over the wire: the served body is the embedded one, so the agent decides as it does in-process."""

from dataclasses import replace

import pytest

from reasoned_explorer.evaluation.mission import Mission, MissionSettings
from reasoned_explorer.exploration.settings import ExplorerSettings
from reasoned_explorer.model.record import EpisodeRecord
from reasoned_explorer.serving.background import BackgroundServer
from reasoned_explorer.serving.mavlink.server import AS_FAST_AS_ASKED, MavlinkServer
from reasoned_explorer.simulation.eyes import Eyes
from reasoned_explorer.vehicles.mavlink.settings import DriverSettings
from reasoned_explorer.vehicles.mavlink.vehicle import MavlinkVehicle
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.opening import open_world

pytest.importorskip("pymavlink")

#: The body settles by itself, as the embedded one does.
AS_EMBEDDED = DriverSettings(arms=True, settle_s=0.0, lost_s=300.0, reply_s=100.0)


@pytest.fixture(scope="module")
def atlas() -> Atlas:
    return Atlas(open_world("residential:3"))


def over_the_wire(goal: str, atlas: Atlas, settings: MissionSettings, *, flavour: str) -> EpisodeRecord:
    """Run a mission whose vehicle is reached over a socket; the captioner knows the world that is served."""
    mission = Mission(goal, atlas, settings)

    def make() -> MavlinkServer:
        return MavlinkServer(
            atlas,
            mission.start,
            flavour=flavour,
            profile=mission.profile,
            speed=AS_FAST_AS_ASKED,
            noise="rtk-fixed",
            seed=settings.seed,
        )

    with BackgroundServer(make) as served:
        vehicle = MavlinkVehicle(
            mission.profile,
            clock=mission.clock,
            address=f"udpout:127.0.0.1:{served.port}",
            home=replace(mission.start, z_m=0.0),
            settings=AS_EMBEDDED,
            content=Eyes(atlas).look,
        )
        mission.explorer.parts = replace(mission.explorer.parts, vehicle=vehicle)
        return mission.run().record


@pytest.mark.parametrize(("flavour", "seed", "steps"), [("arducopter", 5, 12), ("px4", 6, 4)])
def test_the_same_seed_chooses_the_same_frontiers_as_in_process(
    atlas: Atlas, flavour: str, seed: int, steps: int
) -> None:
    goal = "Find me a fire hydrant"
    settings = MissionSettings(seed=seed, eyes="lines", explorer=ExplorerSettings(max_steps=steps))
    reference = Mission(goal, atlas, settings).run().record
    record = over_the_wire(goal, atlas, settings, flavour=flavour)
    assert [step.choice for step in record.steps] == [step.choice for step in reference.steps]
    assert [[view.caption for view in step.views] for step in record.steps] == [
        [view.caption for view in step.views] for step in reference.steps
    ]
    # Targets travel with seven digits: places agree to a fraction of a millimetre.
    for step, expected in zip(record.steps, reference.steps, strict=True):
        assert step.pose == pytest.approx(expected.pose, abs=1e-3)
    legs = [leg for step in record.steps for leg in step.legs]
    expected_legs = [leg for step in reference.steps for leg in step.legs]
    assert [leg.outcome for leg in legs] == [leg.outcome for leg in expected_legs]
    assert [leg.duration_s for leg in legs] == pytest.approx([leg.duration_s for leg in expected_legs], abs=0.051)


@pytest.mark.parametrize("flavour", ["ardurover", "px4-rover"])
def test_a_rovers_mission_chooses_the_same_frontiers_as_in_process(atlas: Atlas, flavour: str) -> None:
    """A rover turns by a command of its own when it is there, with noise drawn anew: places differ by centimetres."""
    goal = "Find me a fire hydrant"
    settings = MissionSettings(seed=6, eyes="lines", vehicle="go1", explorer=ExplorerSettings(max_steps=4))
    reference = Mission(goal, atlas, settings).run().record
    record = over_the_wire(goal, atlas, settings, flavour=flavour)
    assert len(record.steps) == 4
    for step, expected in zip(record.steps, reference.steps, strict=True):
        assert step.choice is not None
        assert expected.choice is not None
        assert step.choice.frontier == expected.choice.frontier
        assert step.pose == pytest.approx(expected.pose, abs=0.3)
        assert [leg.outcome for leg in step.legs] == [leg.outcome for leg in expected.legs]
