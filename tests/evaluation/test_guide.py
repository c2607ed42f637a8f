"""The guide: the shortest compliant way, gone by the simulated machine."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from reasoned_explorer.evaluation.guide import MAX_TRIES, Guide
from reasoned_explorer.evaluation.mission import Mission, MissionSettings, run_mission, traveller_of
from reasoned_explorer.evaluation.record_file import read_record
from reasoned_explorer.exploration.settings import ExplorerSettings
from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import LegOutcome
from reasoned_explorer.model.record import MissionEnd
from reasoned_explorer.simulation.eyes import Eyes
from reasoned_explorer.simulation.vehicle import SimulatedVehicle
from reasoned_explorer.task.sampling import SamplingSettings, sample_episodes
from reasoned_explorer.vehicles import PROFILES
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.generator import generate_world
from reasoned_explorer.world.opening import open_world
from reasoned_explorer.world.taxonomy import Ground
from reasoned_explorer.world.world import Building, Region
from tests.world.worlds import box, courtyard, field

GUIDE = MissionSettings(agent="guide")


def test_over_open_ground_it_goes_straight_and_stops_just_inside_the_radius() -> None:
    world = field(("post_box", 150.0, 50.0), size_m=200.0)
    result = run_mission("Find me a mailbox", world, GUIDE, start=Pose(30.0, 50.0, 0.0, 0.0))
    summary = result.summary
    assert summary.success
    assert summary.end is MissionEnd.FOUND
    assert len(result.record.steps) == 1
    assert 13.5 <= summary.distance_to_goal_m <= 14.8
    assert summary.spl > 0.98
    assert summary.calls == {}
    assert summary.ct_s == 0.0
    # 105 m at 3 m/s, and what it takes to speed up, slow down and settle.
    assert 35.0 < summary.tt_s < 42.0
    assert summary.casr == pytest.approx(1.0 - summary.tt_s / 1800.0, abs=1e-5)


def test_it_says_that_it_is_a_bound_and_asks_nobody() -> None:
    header = Mission("Find me a bench", courtyard(), GUIDE, start=Pose(90.0, 45.0)).header
    assert "a bound" in header.planner
    assert (header.minds, header.captioner) == ("no minds", "no captions")
    assert header.settings["agent"] == "guide"


def test_where_it_stands_in_place_it_declares_at_once() -> None:
    result = run_mission("Find me a bench", courtyard(), GUIDE, start=Pose(74.0, 44.0))
    assert result.summary.success
    assert result.summary.path_length_m == 0.0
    assert len(result.record.steps) == 1


def test_it_walks_around_what_it_cannot_pass() -> None:
    wall = Building(box(48.0, 10.0, 52.0, 95.0), 8.0)
    result = run_mission(
        "Find me a mailbox", field(("post_box", 85.0, 80.0), buildings=[wall]), GUIDE, start=Pose(20.0, 80.0)
    )
    assert result.summary.success
    assert not result.summary.collisions
    assert result.summary.spl > 0.95


def test_it_keeps_off_ground_that_the_goal_shuns_even_where_its_edge_is_the_shortest_way() -> None:
    lawn = Region(Ground.GRASS, box(20.0, 0.0, 80.0, 60.0))
    world = field(("post_box", 95.0, 10.0), ground=Ground.PLAZA, regions=[lawn])
    straight = run_mission("Find me a mailbox", world, GUIDE, start=Pose(5.0, 10.0))
    around = run_mission("Find me a mailbox and keep off the grass", world, GUIDE, start=Pose(5.0, 10.0))
    assert straight.summary.success
    assert around.summary.success
    assert around.summary.compliant
    assert around.summary.path_length_m > straight.summary.path_length_m + 20.0
    assert around.summary.spl > 0.93


def test_where_there_is_no_way_it_says_so() -> None:
    walls = [
        Building(box(60.0, 60.0, 95.0, 62.0), 8.0),
        Building(box(60.0, 93.0, 95.0, 95.0), 8.0),
        Building(box(60.0, 60.0, 62.0, 95.0), 8.0),
        Building(box(93.0, 60.0, 95.0, 95.0), 8.0),
    ]
    world = field(("post_box", 78.0, 78.0), buildings=walls)
    summary = run_mission(
        "Find me a mailbox", world, replace(GUIDE, success_radius_m=5.0), start=Pose(20.0, 20.0)
    ).summary
    assert summary.end is MissionEnd.NOTHING_LEFT
    assert "no compliant way" in summary.reason


@pytest.mark.parametrize("vehicle", ["drone", "go1", "drone-authors"])
def test_it_finds_everything_that_can_be_reached(vehicle: str) -> None:
    _all_found(Atlas(generate_world("park", seed=21, size_m=300.0)), vehicle, count=8)


def test_the_same_in_a_real_place(osm_folder: Path) -> None:
    world = open_world(str(osm_folder / "monaco-2025.osm.pbf"), bbox=(7.4140, 43.7290, 7.4250, 43.7365))
    # Of these eight one makes a detour of 60 m: its shortest way leads along the very edge of what the judge allows.
    _all_found(Atlas(world), "drone", count=8, least_spl=0.9)


def _all_found(atlas: Atlas, vehicle: str, *, count: int, least_spl: float = 0.95) -> None:
    profile = PROFILES[vehicle]
    sampling = SamplingSettings(camera_height_m=profile.camera_height_m)
    episodes = sample_episodes(atlas, count=count, seed=5, traveller=traveller_of(profile), settings=sampling)
    spl = []
    for episode in episodes:
        settings = replace(GUIDE, vehicle=vehicle, seed=episode.seed)
        summary = run_mission(episode.spec.text, atlas, settings, start=episode.start).summary
        assert summary.success, (episode.spec.text, episode.start, summary.judge)
        spl.append(summary.spl)
    assert np.mean(spl) > least_spl


def test_time_is_over_for_it_too() -> None:
    world = field(("post_box", 150.0, 50.0), size_m=200.0)
    settings = replace(GUIDE, explorer=ExplorerSettings(t_max_s=10.0))
    summary = run_mission("Find me a mailbox", world, settings, start=Pose(30.0, 50.0)).summary
    assert summary.end is MissionEnd.TIME_OVER
    assert not summary.success


def test_a_leg_that_fails_is_tried_again_and_not_for_ever() -> None:
    def run(*failing: int):
        mission = Mission("Find me a bench", courtyard(), GUIDE, start=Pose(10.0, 45.0))
        faults = dict.fromkeys(failing, "no link")
        vehicle = SimulatedVehicle(
            mission.atlas,
            mission.profile,
            mission.start,
            clock=mission.clock,
            eyes=Eyes(mission.atlas),
            seed=0,
            faults=faults,
        )
        mission.explorer = Guide(mission.explorer.truth, vehicle, mission.clock)
        return mission.run()

    once = run(0)
    assert once.summary.success
    assert "fault: vehicle: no link" in once.record.steps[0].notes
    never = run(*range(100))
    assert never.summary.end is MissionEnd.NOTHING_LEFT
    assert len(never.record.steps) == 1 + MAX_TRIES
    assert "no link" in never.summary.reason


def test_its_record_is_kept_and_drawn_like_any_other(tmp_path: Path) -> None:
    result = run_mission("Find me a bench", courtyard(), GUIDE, start=Pose(10.0, 45.0), folder=tmp_path / "run")
    assert read_record(tmp_path / "run") == result.record
    result.draw_map(tmp_path / "map.png")
    assert (tmp_path / "map.png").read_bytes().startswith(b"\x89PNG")
    last = result.record.steps[-1]
    assert last.tt_s == pytest.approx(last.ended_s)
    assert all(leg.outcome is LegOutcome.ARRIVED for step in result.record.steps for leg in step.legs)
    gone_m = math.fsum(leg.length_m for step in result.record.steps for leg in step.legs)
    assert result.summary.path_length_m == pytest.approx(gone_m, abs=0.5)


def test_the_same_seed_goes_the_same_way() -> None:
    first, again = (run_mission("Find me a bench", courtyard(), GUIDE, start=Pose(10.0, 45.0)) for _ in range(2))
    assert first.record == again.record
