"""Which mission is meant, and what is there of it."""

from dataclasses import replace
from pathlib import Path

import pytest

from reasoned_explorer.evaluation.bench.plan import BenchPlan
from reasoned_explorer.evaluation.bench.store import RunStore
from reasoned_explorer.evaluation.bench.worker import run_task
from reasoned_explorer.evaluation.mission import MissionSettings
from reasoned_explorer.exploration.settings import ExplorerSettings
from reasoned_explorer.model import RecordError
from reasoned_explorer.task.splitting import Dealing, Share, make_split, places_of_worlds
from reasoned_explorer.viewer.exports.mission import Choice, find_mission
from reasoned_explorer.world.files import save_world
from reasoned_explorer.world.opening import open_world
from tests.viewer.exports.missions import NOWHERE, RECORD, STEPS, keep, png

SHORT = MissionSettings(explorer=ExplorerSettings(t_max_s=40.0))


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, BenchPlan]:
    """A run of one mission with each of two planners."""
    split = make_split("tiny", places_of_worlds(["plaza:5@200"]), share=Share(), dealing=Dealing(1, time_limit_s=40.0))
    plan = BenchPlan(replace(split, episodes=split.episodes[:1]), ("nearest-frontier", "random"), base=SHORT)
    folder = tmp_path_factory.mktemp("bench") / "run"
    with RunStore.create(folder, plan, {}) as store:
        for task in plan.tasks():
            done = run_task(plan, task)
            store.add(task, done.row, trace=done.trace, wall_s=done.wall_s)
    return folder, plan


def test_a_folder_of_rex_run_is_a_mission_with_its_world(run_mission: Path) -> None:
    found = find_mission(run_mission)
    assert found.name == "mission"
    assert found.world is not None
    assert found.world.name == "plaza:3@200"
    assert found.pictures is None
    assert find_mission(run_mission / "record.jsonl").record == found.record


def test_a_generated_world_that_was_not_kept_is_made_again(run_mission: Path, tmp_path: Path) -> None:
    moved = keep(tmp_path / "moved", find_mission(run_mission).record)
    assert find_mission(moved).world is not None


def test_another_world_beside_the_record_is_not_taken_for_it(run_mission: Path, tmp_path: Path) -> None:
    record = find_mission(run_mission).record
    lost = replace(record, header=replace(record.header, world="a town that is gone"))
    folder = keep(tmp_path / "lost", lost, world=open_world("plaza:4@200"))
    assert find_mission(folder).world is None
    with pytest.raises(RecordError, match="not the world of the mission"):
        find_mission(folder, world="plaza:4@200")
    found = find_mission(folder, world="plaza:3@200")
    assert found.world is not None
    save_world(found.world, tmp_path / "kept.rexworld")
    assert find_mission(folder, world=str(tmp_path / "kept.rexworld")).world is not None


def test_where_no_world_was_known_none_can_be_named(tmp_path: Path) -> None:
    folder = keep(tmp_path / "outdoors", NOWHERE)
    assert find_mission(folder).world is None
    with pytest.raises(RecordError, match="knew no world"):
        find_mission(folder, world="plaza:3@200")


def test_pictures_are_found_by_the_keys_of_their_views(by_hand: Path) -> None:
    found = find_mission(by_hand)
    first, second = STEPS[0].views
    assert found.picture(first) == png("red")
    assert found.picture(second) == png("green")
    assert found.picture(STEPS[1].views[0]) is None
    assert find_mission(by_hand).record == RECORD


def test_a_mission_of_a_benchmark_is_named_as_far_as_needed(bench: tuple[Path, BenchPlan]) -> None:
    folder, plan = bench
    name = plan.mission_id(0, 0)
    found = find_mission(folder, Choice(method="random"))
    assert found.name == f"drone/random/{name}"
    assert found.world is not None
    assert found.record.header.goal == plan.split.episodes[0].episode.spec.text
    assert find_mission(folder, Choice(name, "random", "drone")).name == found.name
    with pytest.raises(RecordError, match=r"2 missions are meant; .* --planner nearest-frontier"):
        find_mission(folder, Choice(name))


def test_what_a_benchmark_has_not_is_told_with_what_is_near(bench: tuple[Path, BenchPlan]) -> None:
    with pytest.raises(RecordError, match="did you mean random") as caught:
        find_mission(bench[0], Choice("plaza:5", "randm"))
    assert len(caught.value.faults) == 2
    assert bench[1].mission_id(0, 0) in str(caught.value)


def test_a_single_mission_has_nothing_to_choose_from(run_mission: Path) -> None:
    with pytest.raises(RecordError, match=r"--planner for .* a run of rex bench"):
        find_mission(run_mission, Choice(method="random"))


def test_no_mission_is_no_mission(tmp_path: Path) -> None:
    with pytest.raises(RecordError, match="the folder of a run"):
        find_mission(tmp_path)
