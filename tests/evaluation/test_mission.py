"""Whole missions in small worlds, from a sentence to a score."""

from dataclasses import replace
from pathlib import Path

import pytest

from reasoned_explorer.evaluation.mission import (
    Mission,
    MissionSettings,
    run_mission,
    traveller_of,
)
from reasoned_explorer.evaluation.record_file import read_record, record_bytes
from reasoned_explorer.evaluation.track import looks_of, track_of
from reasoned_explorer.exploration.settings import ExplorerSettings
from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import GoalError, RecordError, SettingsError, StartError, UnknownNameError
from reasoned_explorer.model.record import MissionEnd
from reasoned_explorer.planning.without_models import NearestFrontier
from reasoned_explorer.task.sampling import SamplingSettings, sample_episodes
from reasoned_explorer.vehicles import PROFILES
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.files import load_world, save_world
from reasoned_explorer.world.generator import generate_world
from reasoned_explorer.world.opening import open_world
from tests.world.worlds import courtyard

ORACLE = MissionSettings(minds="oracle", captioner="perfect")
#: Headings all around and short steps: what is not found then was lost by the agent, not by its looks.
ALL_AROUND = ExplorerSettings(views=24, sweep_rad=6.283, step_min_m=2.0, step_max_m=12.0)


@pytest.fixture(scope="module")
def plaza() -> Atlas:
    return Atlas(generate_world("plaza", seed=3, size_m=220.0))


def test_a_mission_is_found_judged_and_scored(plaza: Atlas) -> None:
    result = run_mission("Find me a bench", plaza, replace(ORACLE, seed=2))
    summary = result.summary
    assert summary.end is MissionEnd.FOUND
    assert summary.success
    assert summary.oracle_success
    assert 0.0 < summary.spl <= 1.0
    assert summary.casr == pytest.approx(1.0 - (summary.ct_s + summary.tt_s) / 1800.0, abs=1e-5)
    assert summary.path_length_m >= (summary.reference_length_m or 0.0) * 0.9
    assert result.record.header.goal_objects


def test_a_mission_through_pixels_finds_its_goal_and_says_so(plaza: Atlas) -> None:
    results = [run_mission("Find me a bench", plaza, replace(ORACLE, seed=2)) for _ in range(2)]
    header = results[0].record.header
    assert results[0].summary.success
    assert (header.captioner, header.settings["eyes"]) == ("simulated captioner (perfect) through pixels", "pixels")
    assert record_bytes(results[0].record) == record_bytes(results[1].record)
    by_lines = run_mission("Find me a bench", plaza, replace(ORACLE, seed=2, eyes="lines")).record.header
    assert (by_lines.captioner, by_lines.settings["eyes"]) == ("simulated captioner (perfect)", "lines")


def test_ct_and_tt_fill_the_whole_mission(plaza: Atlas) -> None:
    result = run_mission("Find me a bench", plaza, MissionSettings(seed=4))
    last = result.record.steps[-1]
    assert result.summary.ct_s + result.summary.tt_s == pytest.approx(last.ended_s, abs=0.01)
    for step in result.record.steps:
        assert step.look_s + step.think_s + step.travel_s == pytest.approx(step.ended_s - step.started_s, abs=0.01)
        assert step.plan_s <= step.think_s + 1e-6


def test_a_full_step_asks_as_often_as_the_paper_says(plaza: Atlas) -> None:
    result = run_mission("Find me a public toilet", plaza, MissionSettings(seed=4))
    first = result.record.steps[0]
    counted = {role: sum(call.role == role for call in first.calls) for role in ("visionary", "evaluator", "checker")}
    assert counted == {"visionary": 18, "evaluator": 18, "checker": 3}
    assert len(first.tree) == 18


def test_the_same_seed_gives_the_same_record_and_another_one_does_not(plaza: Atlas) -> None:
    first, again, other = (run_mission("Find me a tree", plaza, MissionSettings(seed=seed)) for seed in (5, 5, 6))
    assert first.record == again.record
    assert first.record.steps != other.record.steps


@pytest.mark.parametrize("name", ["town:5@400", "waterfront:3@200"])
def test_a_kept_world_gives_the_same_record_to_the_byte(name: str, tmp_path: Path) -> None:
    world = open_world(name)
    save_world(world, tmp_path / "kept.rexworld")
    settings = MissionSettings(planner="nearest-frontier", explorer=ExplorerSettings(max_steps=40))
    records = [
        record_bytes(run_mission("Find me a fountain", each, settings).record)
        for each in (world, load_world(tmp_path / "kept.rexworld"))
    ]
    assert records[0] == records[1]


def test_the_record_is_written_as_it_happens_and_can_be_read(plaza: Atlas, tmp_path: Path) -> None:
    kept: list[int] = []

    def on_step(step: object) -> None:
        kept.append(len(read_record(tmp_path / "run").steps))

    result = run_mission("Find me a bench", plaza, replace(ORACLE, seed=2), folder=tmp_path / "run", on_step=on_step)
    assert kept == list(range(1, len(kept) + 1))
    assert read_record(tmp_path / "run") == result.record


def test_the_map_of_a_mission_can_be_drawn(plaza: Atlas, tmp_path: Path) -> None:
    result = run_mission("Find me a bench", plaza, replace(ORACLE, seed=2))
    result.draw_map(tmp_path / "map.png")
    assert (tmp_path / "map.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("vehicle", sorted(PROFILES))
def test_every_vehicle_flies_or_walks_the_mission(vehicle: str) -> None:
    settings = replace(ORACLE, vehicle=vehicle, latency="instant")
    result = run_mission("Find me a fountain", courtyard(), settings, start=Pose(50.0, 45.0, 0.0, 1.5))
    assert result.summary.success, result.summary


@pytest.mark.parametrize("planner", ["llm-rrt", "llm-rrt-authors", "llm-mcts", "llm-as-eval", "follow-paths", "random"])
@pytest.mark.parametrize("captioner", ["perfect", "noisy"])
def test_every_planner_ends_its_mission_in_time(planner: str, captioner: str, plaza: Atlas) -> None:
    settings = MissionSettings(planner=planner, captioner=captioner, seed=3)
    summary = run_mission("Find me somewhere to sit", plaza, settings).summary
    assert summary.end in set(MissionEnd) - {MissionEnd.FAULT, MissionEnd.INTERRUPTED}
    assert summary.ct_s + summary.tt_s < 1800.0 + 240.0


def test_the_settings_of_the_agent_that_belong_to_a_planner_are_in_force_and_in_the_header(plaza: Atlas) -> None:
    result = run_mission("Find me a public toilet", plaza, MissionSettings(planner="llm-rrt-authors", seed=4))
    kept = result.record.header.settings["explorer"]
    assert (kept["check_after_planning"], kept["straight_legs"], kept["views"]) == (True, True, 3)
    first = result.record.steps[0]
    checks = [call.started_s for call in first.calls if call.role == "checker"]
    assert len(set(checks)) == 3  # one after the other
    planned_s = max(call.started_s + call.latency_s for call in first.calls if call.role == "evaluator")
    assert min(checks) == pytest.approx(planned_s, abs=1e-3)
    assert run_mission("Find me a bench", plaza, ORACLE).record.header.settings["explorer"]["straight_legs"] is False


def test_a_planner_that_overrides_what_the_agent_does_not_have_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(NearestFrontier, "explorer", {"straight_leg": True}, raising=False)
    with pytest.raises(SettingsError, match="straight_leg"):
        Mission("Find me a bench", courtyard(), MissionSettings(planner="nearest-frontier"), start=Pose(50.0, 45.0))


@pytest.mark.parametrize("district", ["park", "residential", "waterfront"])
def test_with_perfect_eyes_and_the_oracle_every_reachable_goal_is_found(district: str) -> None:
    _all_found(Atlas(generate_world(district, seed=21, size_m=300.0)), count=4)


def test_the_same_in_a_real_place(osm_folder: Path) -> None:
    world = open_world(str(osm_folder / "uvic-campus.osm.pbf"))
    _all_found(Atlas(world), count=4)


def _all_found(atlas: Atlas, *, count: int) -> None:
    traveller = traveller_of(PROFILES["drone"])
    sampling = SamplingSettings(camera_height_m=PROFILES["drone"].camera_height_m)
    episodes = sample_episodes(atlas, count=count, seed=5, traveller=traveller, settings=sampling)
    assert len(episodes) == count
    for episode in episodes:
        settings = replace(ORACLE, seed=episode.seed, explorer=ALL_AROUND)
        summary = run_mission(episode.spec.text, atlas, settings, start=episode.start).summary
        assert summary.success, (episode.spec.text, episode.start, summary.judge)


@pytest.mark.parametrize(
    ("goal", "error"), [("", GoalError), ("hello", GoalError), ("Find me", GoalError), ("Find me a zebra", GoalError)]
)
def test_goals_that_ask_for_nothing_are_refused(goal: str, error: type[Exception]) -> None:
    with pytest.raises(error):
        Mission(goal, courtyard())


@pytest.mark.parametrize(
    "start",
    [
        Pose(15.0, 60.0),  # inside the north house
        Pose(500.0, 0.0),  # off the map
        Pose(float("nan"), 0.0),
        Pose(50.0, 20.0, float("inf")),
    ],
)
def test_starts_where_no_mission_can_begin_are_refused(start: Pose) -> None:
    with pytest.raises(StartError):
        Mission("Find me a bench", courtyard(), start=start)


def test_a_walker_cannot_start_in_water_but_a_drone_can_start_over_it() -> None:
    pond = Pose(80.0, 60.0)
    with pytest.raises(StartError, match="water"):
        Mission("Find me a bench", courtyard(), MissionSettings(vehicle="go1"), start=pond)
    assert Mission("Find me a bench", courtyard(), MissionSettings(vehicle="drone"), start=pond).start.x_m == 80.0


def test_a_goal_that_nothing_here_satisfies_is_refused_before_the_start() -> None:
    with pytest.raises(StartError, match="nothing in"):
        Mission("Find me a museum", courtyard())


def test_unknown_names_are_refused_before_anything_is_written(tmp_path: Path) -> None:
    with pytest.raises(UnknownNameError, match="did you mean virtual"):
        Mission("Find me a bench", courtyard(), MissionSettings(clock="virtul"), start=Pose(50.0, 45.0))
    with pytest.raises(UnknownNameError, match="did you mean guide"):
        Mission("Find me a bench", courtyard(), MissionSettings(agent="giude"), start=Pose(50.0, 45.0))


def test_a_record_is_not_written_over(tmp_path: Path) -> None:
    settings = replace(ORACLE, latency="instant")
    run_mission("Find me a bench", courtyard(), settings, start=Pose(90.0, 45.0), folder=tmp_path)
    with pytest.raises(RecordError):
        run_mission("Find me a bench", courtyard(), settings, start=Pose(90.0, 45.0), folder=tmp_path)


def test_looks_lie_on_the_track_where_the_agent_looked(plaza: Atlas) -> None:
    record = run_mission("Find me a public toilet", plaza, MissionSettings(seed=4)).record
    start = Pose(*record.header.start)
    track = track_of(start, list(record.steps))
    looks = looks_of(list(record.steps))
    looked = [step for step in record.steps if step.views]
    assert len(looks) == len(looked) > 3
    for look, step in zip(looks, looked, strict=True):
        at = track[look.point]
        # The filter knows where it is to decimetres.
        assert at.x_m == pytest.approx(step.pose[0], abs=0.5)
        assert at.y_m == pytest.approx(step.pose[1], abs=0.5)
        assert look.headings_rad == tuple(view.heading_rad for view in step.views)


def test_a_mission_that_is_found_by_sight_was_seen(plaza: Atlas) -> None:
    score = run_mission("Find me a bench", plaza, replace(ORACLE, seed=2, explorer=ALL_AROUND)).score
    assert score.success
    assert score.oracle_seen
    assert score.soft_spl == score.spl > 0.0
    assert score.ndtw is None
