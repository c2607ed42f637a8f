"""A mission over the wire: the served body is the embedded one, so the agent decides as it does in-process."""

from dataclasses import replace

import pytest

from reasoned_explorer.clock import run_live
from reasoned_explorer.evaluation.mission import Mission, MissionSettings
from reasoned_explorer.exploration.settings import ExplorerSettings
from reasoned_explorer.model.record import EpisodeRecord
from reasoned_explorer.serving.go1.server import Go1Server
from reasoned_explorer.serving.go1.walker import Walker
from reasoned_explorer.simulation.eyes import Eyes
from reasoned_explorer.simulation.vehicle import SimulatedVehicle
from reasoned_explorer.vehicles.unitree.vehicle import Go1Vehicle
from reasoned_explorer.vehicles.vehicle import Vehicle
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.opening import open_world

SETTINGS = MissionSettings(seed=6, eyes="lines", vehicle="go1", explorer=ExplorerSettings(max_steps=3))


@pytest.fixture(scope="module")
def mission() -> Mission:
    return Mission("Find me a fire hydrant", Atlas(open_world("residential:3")), SETTINGS)


def run(vehicle: Vehicle, mission: Mission) -> EpisodeRecord:
    mission.explorer.parts = replace(mission.explorer.parts, vehicle=vehicle)
    return mission.run().record


def test_the_same_seed_chooses_the_same_frontiers_as_in_process(mission: Mission) -> None:
    atlas, profile, start, seed = mission.atlas, mission.profile, mission.start, SETTINGS.seed
    again = Mission(mission.goal.text, atlas, SETTINGS, judge=mission.judge)
    # Of one noise, none: a driver's filter is not the embedded one's, and legs would differ by centimetres.
    embedded = SimulatedVehicle(atlas, profile, start, clock=again.clock, eyes=Eyes(atlas), seed=seed, noise="none")
    reference = run(embedded, again)
    server = Go1Server(Walker(atlas, profile, start, noise="none", seed=seed), lockstep=True)
    port = run_live(server.start)
    try:
        vehicle = Go1Vehicle(
            profile, clock=mission.clock, host="127.0.0.1", port=port, home=start, content=Eyes(atlas).look
        )
        record = run(vehicle, mission)
    finally:
        run_live(server.close)
    assert len(record.steps) == 3
    for step, expected in zip(record.steps, reference.steps, strict=True):
        assert step.choice is not None
        assert expected.choice is not None
        assert step.choice.frontier == expected.choice.frontier
        assert step.pose == pytest.approx(expected.pose, abs=0.005)
        assert [view.caption for view in step.views] == [view.caption for view in expected.views]
        assert [leg.outcome for leg in step.legs] == [leg.outcome for leg in expected.legs]
        assert [leg.duration_s for leg in step.legs] == pytest.approx(
            [leg.duration_s for leg in expected.legs], abs=0.01
        )
    assert record.summary is not None
    assert reference.summary is not None
    assert record.summary.tt_s == pytest.approx(reference.summary.tt_s, abs=0.1)
