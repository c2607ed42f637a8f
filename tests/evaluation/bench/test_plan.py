from dataclasses import replace

import pytest

from reasoned_explorer.evaluation.bench.plan import BenchPlan
from reasoned_explorer.evaluation.mission import MissionSettings
from reasoned_explorer.model import InputError, SettingsError


def test_a_plan_is_the_same_after_it_was_written_down(small_plan: BenchPlan) -> None:
    again = BenchPlan.from_dict(small_plan.as_dict())
    assert again == small_plan
    assert again.digest == small_plan.digest


def test_every_planner_gets_every_mission_once(small_plan: BenchPlan) -> None:
    tasks = list(small_plan.tasks())
    assert len({task.key for task in tasks}) == len(tasks) == small_plan.count == 12
    for name in small_plan.methods:
        assert {task.mission_id for task in tasks if task.method == name} == {
            item.episode.id for item in small_plan.split.episodes
        }


def test_missions_of_a_place_come_together(small_plan: BenchPlan) -> None:
    places = [small_plan.episode_of(task).place for task in small_plan.tasks()]
    assert places == sorted(places, key=places.index)


def test_planners_share_seeds_and_other_seeds_are_other_missions(small_plan: BenchPlan) -> None:
    twice = replace(small_plan, seeds=(0, 7))
    seeds: dict[str, set[int]] = {}
    for task in twice.tasks():
        seeds.setdefault(task.mission_id, set()).add(twice.settings_of(task).seed)
    assert len(seeds) == 12
    assert all(len(each) == 1 for each in seeds.values())
    assert len(set.union(*seeds.values())) == 12


def test_who_keeps_traces_decides_no_result(small_plan: BenchPlan) -> None:
    assert replace(small_plan, keep_traces=False).digest == small_plan.digest
    assert replace(small_plan, seeds=(1,)).digest != small_plan.digest


def test_everything_that_is_wrong_is_told_at_once(small_plan: BenchPlan) -> None:
    with pytest.raises(SettingsError) as raised:
        replace(
            small_plan,
            methods=("llm-rtt",),
            vehicles=("drone", "drone"),
            base=MissionSettings(minds="nobody", captioner="blind", latency="never", clock="sundial"),
            seeds=(),
        )
    text = str(raised.value)
    for word in ("llm-rtt", "did you mean llm-rrt", "drone, drone", "nobody", "blind", "never", "sundial", "seeds"):
        assert word in text


def test_the_settings_of_a_method_and_the_numbers_of_the_base_are_checked(small_plan: BenchPlan) -> None:
    with pytest.raises(SettingsError) as raised:
        replace(
            small_plan,
            methods=("llm-rrt:depth=-1", "llm-rrt@nobody/embedded", "llm-as-eval:depth=1"),
            base=MissionSettings(success_radius_m=0.0),
        )
    text = str(raised.value)
    for word in ("depth is -1", "nobody", "no setting 'depth'", "success_radius_m is 0"):
        assert text.count(word) == 1


@pytest.mark.parametrize("data", [{}, {"version": 99}, {"version": 1, "split": None}])
def test_what_is_no_plan_is_refused(data: dict[str, object]) -> None:
    with pytest.raises(InputError):
        BenchPlan.from_dict(data)


def test_the_same_mission_is_known_by_all_that_decides_it(small_plan: BenchPlan) -> None:
    mine = small_plan.fingerprints()
    assert len(mine) == len(set(mine.values())) == 6
    other = replace(small_plan, methods=("random",), base=replace(small_plan.base, captioner="perfect"))
    assert other.fingerprints() == mine
    assert small_plan.differences(other) == ["captioner: noisy / perfect"]
    name = small_plan.split.places[0].name
    elsewhere = replace(small_plan.split, world_digests={**small_plan.split.world_digests, name: "another world"})
    its = replace(small_plan, split=elsewhere).fingerprints()
    assert {key for key in mine if mine[key] != its[key]} == {
        item.episode.id for item in small_plan.split.episodes if item.place == name
    }
