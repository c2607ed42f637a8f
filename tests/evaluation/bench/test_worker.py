import json
from dataclasses import replace
from pathlib import Path

import pytest

from reasoned_explorer.evaluation.bench import worker
from reasoned_explorer.evaluation.bench.plan import BenchPlan
from reasoned_explorer.evaluation.bench.worker import run_task
from reasoned_explorer.evaluation.mission import Mission
from reasoned_explorer.evaluation.record_file import parse_record, record_bytes
from reasoned_explorer.evaluation.row import MissionRow
from reasoned_explorer.model import InputError, WorldError


def test_what_missions_share_changes_no_result(small_plan: BenchPlan) -> None:
    every = replace(small_plan, methods=("oracle", "foresight-30m", "llm-rrt+perfect-halt", "nearest-frontier"))
    tasks = list(every.tasks())
    together = {task.key: run_task(every, task).row for task in tasks}
    for task in tasks[::3]:
        for cached in (worker._atlas_of, worker._judge_of):
            cached.cache_clear()
        assert run_task(every, task).row == together[task.key]


def test_a_row_says_what_its_record_says(small_plan: BenchPlan) -> None:
    task = list(small_plan.tasks())[-1]
    item = small_plan.episode_of(task)
    mission = Mission(
        item.episode.spec.text,
        worker.open_place(small_plan.split.place(item.place)),
        small_plan.settings_of(task),
        start=item.episode.start,
    )
    result = mission.run()
    row = MissionRow.from_json(run_task(small_plan, task).row)
    assert (row.end, row.steps, row.declared) == (result.summary.end, result.summary.steps, result.summary.declared)
    assert row.calls == sum(result.summary.calls.values())
    assert row.small_collisions + row.large_collisions == len(result.summary.collisions)
    assert row.score.spl == pytest.approx(result.score.spl, abs=1e-6)
    assert 1.0 <= row.evaluator_sum / row.evaluator_count <= 5.0
    assert record_bytes(parse_record(record_bytes(result.record), Path("-"))) == record_bytes(result.record)


def test_a_row_is_the_same_after_it_was_written_down(small_plan: BenchPlan) -> None:
    line = run_task(small_plan, next(small_plan.tasks())).row
    assert MissionRow.from_json(line).as_json() == line


@pytest.mark.parametrize("line", ["", "{}", "[]", "null", '{"score": {}}'])
def test_what_is_no_row_is_refused(line: str) -> None:
    with pytest.raises(InputError, match=r"a row as MissionRow\.as_json"):
        MissionRow.from_json(line)


def test_infinite_lengths_survive(small_plan: BenchPlan) -> None:
    row = MissionRow.from_json(run_task(small_plan, next(small_plan.tasks())).row)
    far = replace(row, score=replace(row.score, reference_length_m=float("inf"), distance_to_goal_m=float("inf")))
    assert json.loads(far.as_json())["score"]["reference_length_m"] is None
    assert MissionRow.from_json(far.as_json()) == far


def test_a_world_that_is_gone_or_another_one_ends_the_run_and_is_no_mission_s_fault(small_plan: BenchPlan) -> None:
    task = next(small_plan.tasks())
    split = small_plan.split
    gone = replace(split, places=tuple(replace(place, source="gone.osm.pbf") for place in split.places))
    with pytest.raises(WorldError, match=r"gone\.osm\.pbf"):
        run_task(replace(small_plan, split=gone), task)
    other = replace(split, places=tuple(replace(place, source="park:99@300") for place in split.places))
    with pytest.raises(WorldError, match="another world than the one that the run's missions are of"):
        run_task(replace(small_plan, split=other), task)
