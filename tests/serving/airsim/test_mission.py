"""A whole mission over the wire: the served body is the embedded one, so the agent decides as it does in-process."""

from dataclasses import replace

import pytest

from reasoned_explorer.evaluation.mission import Mission, MissionSettings
from reasoned_explorer.exploration.settings import ExplorerSettings
from reasoned_explorer.model import LegOutcome
from reasoned_explorer.model.record import EpisodeRecord, MissionEnd
from reasoned_explorer.serving.airsim.server import AS_FAST_AS_ASKED, AirSimServer
from reasoned_explorer.serving.background import BackgroundServer
from reasoned_explorer.simulation.eyes import Eyes
from reasoned_explorer.vehicles.airsim.settings import DriverSettings
from reasoned_explorer.vehicles.airsim.vehicle import AirSimVehicle
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.opening import open_world

pytest.importorskip("msgpack")

#: A camera for each heading, as the embedded simulator has it; there the body settles by itself.
AS_EMBEDDED = DriverSettings(aims=True, pictures=False, settle_s=0.0, deadline_s=60.0)


@pytest.fixture(scope="module")
def atlas() -> Atlas:
    return Atlas(open_world("residential:3"))


def over_the_wire(goal: str, atlas: Atlas, settings: MissionSettings, *, generation: int) -> EpisodeRecord:
    """Run a mission whose vehicle is reached over a socket; the captioner knows the world that is served."""
    mission = Mission(goal, atlas, settings)

    def make() -> AirSimServer:
        return AirSimServer(
            atlas,
            mission.start,
            profile=mission.profile,
            speed=AS_FAST_AS_ASKED,
            noise="rtk-fixed",
            seed=settings.seed,
            generation=generation,
        )

    with BackgroundServer(make) as served:
        vehicle = AirSimVehicle(
            mission.profile,
            clock=mission.clock,
            port=served.port,
            home=replace(mission.start, z_m=0.0),
            settings=AS_EMBEDDED,
            content=Eyes(atlas).look,
        )
        mission.explorer.parts = replace(mission.explorer.parts, vehicle=vehicle)
        return mission.run().record


@pytest.mark.parametrize(("generation", "seed", "steps"), [(1, 5, 12), (4, 6, 6)])
def test_the_same_seed_chooses_the_same_frontiers_as_in_process(
    atlas: Atlas, generation: int, seed: int, steps: int
) -> None:
    goal = "Find me a fire hydrant"
    settings = MissionSettings(seed=seed, eyes="lines", explorer=ExplorerSettings(max_steps=steps))
    reference = Mission(goal, atlas, settings).run().record
    record = over_the_wire(goal, atlas, settings, generation=generation)
    assert [step.choice for step in record.steps] == [step.choice for step in reference.steps]
    assert [step.pose for step in record.steps] == [step.pose for step in reference.steps]
    assert [[view.caption for view in step.views] for step in record.steps] == [
        [view.caption for view in step.views] for step in reference.steps
    ]
    legs = [leg for step in record.steps for leg in step.legs]
    expected = [leg for step in reference.steps for leg in step.legs]
    assert [(leg.outcome, leg.duration_s) for leg in legs] == [(leg.outcome, leg.duration_s) for leg in expected]
    assert record.summary is not None
    assert reference.summary is not None
    assert (record.summary.ct_s, record.summary.tt_s) == (reference.summary.ct_s, reference.summary.tt_s)


def test_it_also_runs_into_the_same_things(atlas: Atlas) -> None:
    goal, settings = (
        "Find me a fire hydrant",
        MissionSettings(seed=5, eyes="lines", explorer=ExplorerSettings(max_steps=2)),
    )
    record = over_the_wire(goal, atlas, settings, generation=1)
    hits = [leg.detail for step in record.steps for leg in step.legs if leg.outcome is LegOutcome.COLLISION]
    assert hits == ["building_159"]


def test_it_finds_what_it_seeks_and_lands(atlas: Atlas) -> None:
    settings = MissionSettings(seed=1, eyes="lines", captioner="perfect")
    record = over_the_wire("Find me a car", atlas, settings, generation=1)
    assert record.summary is not None
    assert (record.summary.end, record.summary.success) == (MissionEnd.FOUND, True)
