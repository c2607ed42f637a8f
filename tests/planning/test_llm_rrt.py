"""LLM-RRT against trees worked out by hand, with scripted minds."""

import asyncio
from typing import Any

import pytest

from reasoned_explorer.calls.ledger import Ledger
from reasoned_explorer.clock import VirtualClock
from reasoned_explorer.geometry import Pose
from reasoned_explorer.minds.context import MindContext, Minds
from reasoned_explorer.minds.latency import LatencyProfile, RoleLatency
from reasoned_explorer.minds.scripted import Fail, Scripts, make_minds
from reasoned_explorer.model import Assessment, Goal, Scene, SettingsError, likert_from_score
from reasoned_explorer.planning import Plan
from reasoned_explorer.planning.llm_rrt import LlmRrt, LlmRrtSettings
from reasoned_explorer.planning.registry import make_planner

GOAL = Goal("Find me a bench", 1)
ONE_SECOND = LatencyProfile("test", "1 s a call", *(RoleLatency(1.0, 0.0) for _ in range(4)))


def _scenes(*texts: str) -> list[Scene]:
    return [Scene(text, (0, 0, index), Pose(0.0, 0.0)) for index, text in enumerate(texts)]


def _run(scripts: Scripts, scenes: list[Scene], **settings: Any) -> tuple[Plan, Ledger, float]:
    clock, ledger = VirtualClock(), Ledger()
    minds: Minds = make_minds(MindContext(clock, ONE_SECOND, ledger), scripts)

    async def mission() -> tuple[Plan, float]:
        plan = await LlmRrt(minds, LlmRrtSettings(**settings)).plan(GOAL, scenes)
        return plan, clock.now_s()

    plan, seconds = clock.run(mission())
    return plan, ledger, seconds


def _by_depth(scores: dict[int, float]) -> Scripts:
    return Scripts(evaluator=lambda goal, scene: scores[scene.depth])


def test_three_views_to_depth_two_take_eighteen_calls_of_each_kind_and_three_calls_time() -> None:
    plan, ledger, seconds = _run(Scripts(), _scenes("a", "b", "c"))
    totals = ledger.totals()
    assert (totals["visionary"].calls, totals["evaluator"].calls) == (18, 18)
    assert seconds == pytest.approx(3.0)  # L visionary calls and one evaluator call, whatever N is
    assert len(plan.tree) == 18


def test_q_is_the_unweighted_mean_of_the_imagined_nodes() -> None:
    plan, *_ = _run(_by_depth({1: 2.0, 2: 5.0}), _scenes("a"))
    assert plan.scores[0].q == pytest.approx(3.5)


def test_depth_zero_is_llm_as_eval() -> None:
    plan, ledger, seconds = _run(_by_depth({0: 4.0}), _scenes("a", "b"), depth=0)
    assert [score.q for score in plan.scores] == pytest.approx([4.0, 4.0])
    assert "visionary" not in ledger.totals()
    assert seconds == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("settings", "q"),
    [
        ({"include_own_score": True, "children": 1}, (1.0 + 2.0 + 5.0) / 3),
        ({"depth_weight": 0.5, "children": 1}, (2.0 + 0.5 * 5.0) / 1.5),
        ({"children": 2}, (2.0 + 2.0 + 5.0 + 5.0) / 4),
        (
            {"restart": True, "depth": 3},
            (2.0 + 5.0 + 5.0) / 3,
        ),  # both rollouts begin at the child: none is deeper than 2
    ],
)
def test_the_papers_other_readings_are_settings(settings: dict[str, Any], q: float) -> None:
    plan, *_ = _run(_by_depth({0: 1.0, 1: 2.0, 2: 5.0}), _scenes("a"), **settings)
    assert plan.scores[0].q == pytest.approx(q)


def test_restarted_rollouts_have_keys_of_their_own() -> None:
    plan, *_ = _run(Scripts(), _scenes("a"), restart=True, depth=4)
    keys = [node.scene.key for node in plan.tree]
    assert len(set(keys)) == len(keys) == 3 + 3 * 3


def test_restarted_rollouts_are_imagined_from_the_child_and_not_from_each_other() -> None:
    scripts = Scripts(visionary=lambda goal, scene: f"beyond {scene.text}")
    plan, *_ = _run(scripts, _scenes("a"), restart=True, depth=4, children=1)
    assert [node.scene.text for node in plan.tree] == ["beyond a"] + ["beyond beyond a"] * 3


def test_up_to_depth_two_there_is_nothing_to_restart() -> None:
    (plan, _, seconds), (restarted, _, again) = (_run(Scripts(), _scenes("a"), restart=each) for each in (False, True))
    assert (plan, seconds) == (restarted, again)


def test_a_blocked_node_counts_as_the_lowest_score() -> None:
    blocked = Assessment(likert_from_score(5.0), blocked=True)
    scripts = Scripts(evaluator=lambda goal, scene: blocked if scene.depth == 2 else 3.0)
    plan, *_ = _run(scripts, _scenes("a"))
    assert plan.scores[0].q == pytest.approx((3.0 + 1.0) / 2)
    assert not plan.scores[0].blocked  # only what lies right ahead blocks the frontier itself


def test_a_frontier_is_blocked_where_all_that_lies_right_behind_it_is() -> None:
    blocked = Assessment(likert_from_score(2.0), blocked=True)
    plan, *_ = _run(
        Scripts(evaluator={"a wall": blocked}, visionary=lambda goal, scene: scene.text), _scenes("a wall", "a park")
    )
    assert [score.blocked for score in plan.scores] == [True, False]


def test_a_missing_answer_is_left_out_and_never_a_number() -> None:
    scripts = Scripts(evaluator=lambda goal, scene: Fail("no answer") if scene.key[-1] == 0 else 4.0)
    plan, *_ = _run(scripts, _scenes("a"), depth=1)
    assert plan.scores[0].q == pytest.approx(4.0)
    plan, *_ = _run(Scripts(evaluator=Fail("no answer")), _scenes("a"))
    assert plan.scores[0].q is None
    assert plan.scores[0].fault == "no answer"


def test_a_branch_that_cannot_be_imagined_is_not_continued() -> None:
    plan, ledger, _ = _run(Scripts(visionary=Fail("no answer")), _scenes("a"))
    assert plan.scores[0].q is None
    assert ledger.totals()["visionary"].calls == 3
    assert "evaluator" not in ledger.totals()


def test_a_view_without_a_description_has_no_score() -> None:
    scenes = [*_scenes("a"), Scene("", (0, 0, 1), Pose(0.0, 0.0), fault="camera")]
    plan, *_ = _run(Scripts(), scenes)
    assert [score.q is None for score in plan.scores] == [False, True]


def test_planning_can_be_cancelled() -> None:
    clock = VirtualClock()
    minds = make_minds(MindContext(clock, ONE_SECOND, Ledger()), Scripts())

    async def mission() -> float:
        with pytest.raises(TimeoutError):
            async with asyncio.timeout(1.5):
                await LlmRrt(minds).plan(GOAL, _scenes("a"))
        return clock.now_s()

    assert clock.run(mission()) == pytest.approx(1.5)


def test_all_faults_of_settings_are_told_at_once() -> None:
    with pytest.raises(SettingsError) as raised:
        LlmRrtSettings(children=0, depth=-1, depth_weight=float("nan"))
    assert len(raised.value.faults) == 3


def test_an_unknown_setting_names_those_that_there_are() -> None:
    minds = make_minds(MindContext(VirtualClock(), ONE_SECOND, Ledger()), Scripts())
    with pytest.raises(SettingsError, match="children, depth"):
        make_planner("llm-rrt", minds, {"dept": 1})
