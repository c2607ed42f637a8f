"""LLM-MCTS against searches worked out by hand, and what holds for every search."""

import asyncio
from functools import partial
from itertools import permutations
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.clock import VirtualClock
from reasoned_explorer.minds import Ledger, MindContext, Minds
from reasoned_explorer.minds.embedded import make_words_minds
from reasoned_explorer.minds.scripted import Fail, Scripts
from reasoned_explorer.model import Assessment, Goal, Scene, SettingsError, likert_from_score
from reasoned_explorer.model.draws import uniform
from reasoned_explorer.planning import FrontierScore, Plan
from reasoned_explorer.planning.llm_mcts import LlmMcts, LlmMctsSettings
from reasoned_explorer.planning.llm_rrt import worth
from reasoned_explorer.planning.registry import make_planner
from tests.planning.helpers import GARDEN, GOAL, ONE_SECOND, PARK, STREET, Planned, planned, scenes_of

BLOCKED = Assessment(likert_from_score(5.0), blocked=True)


def _make(minds: Minds, **settings: Any) -> LlmMcts:
    return LlmMcts(minds, LlmMctsSettings(**settings))


def _search(scripts: Scripts | None, scenes: list[Scene], **settings: Any) -> Planned:
    return planned(partial(_make, **settings), scenes, scripts)


def _keyed(seed: int) -> Scripts:
    """Return minds whose scores are drawn by scene, some of them missing or blocked."""

    def score(_goal: Goal, scene: Scene) -> Any:
        draw = uniform(seed, "score", *scene.key)
        if draw < 0.1:
            return Fail("no answer")
        return BLOCKED if draw < 0.2 else 1.0 + 4.0 * uniform(seed, "level", *scene.key)

    def text(_goal: Goal, scene: Scene) -> Any:
        return Fail("no vision") if uniform(seed, "text", *scene.key) < 0.1 else "further on"

    return Scripts(evaluator=score, visionary=text)


def test_ten_iterations_take_thirty_one_calls_one_after_the_other() -> None:
    done = _search(Scripts(), scenes_of("a", "b", "c"))
    assert done.seconds == pytest.approx(3 * 10 + 1)
    totals = done.ledger.totals()
    assert (totals["visionary"].calls, totals["evaluator"].calls) == (2 * 10, 3 + 2 * 10)


@given(st.integers(0, 12), st.integers(1, 5))
def test_every_iteration_adds_three_calls_whatever_the_number_of_views(iterations: int, views: int) -> None:
    done = _search(Scripts(), scenes_of(*"abcde"[:views]), iterations=iterations)
    assert done.seconds == pytest.approx(3 * iterations + 1)
    assert len(done.plan.tree) == views + 2 * iterations


def test_without_iterations_a_frontier_has_its_own_value() -> None:
    done = _search(Scripts(evaluator={"a": 4.0, "b": 2.0}), scenes_of("a", "b"), iterations=0)
    assert [score.q for score in done.plan.scores] == pytest.approx([4.0, 2.0])


def test_one_iteration_rewards_the_best_view_with_the_mean_of_child_and_simulation() -> None:
    scripts = Scripts(evaluator=lambda goal, scene: {0: 4.0 if scene.text == "b" else 3.0, 1: 2.0, 2: 5.0}[scene.depth])
    done = _search(scripts, scenes_of("a", "b"), iterations=1)
    assert [score.q for score in done.plan.scores] == pytest.approx([3.0, 3.5])  # a has its V still
    assert [node.scene.key for node in done.plan.tree] == [(0, 0, 0), (0, 0, 1), (0, 0, 1, 0), (0, 0, 1, 0, 3)]


def test_of_equal_views_the_first_is_searched_first_and_then_each_gets_its_turn() -> None:
    done = _search(Scripts(), scenes_of("a", "b", "c"), iterations=3)
    assert [node.scene.key[2] for node in done.plan.tree[3::2]] == [0, 1, 2]


def test_a_full_node_is_left_to_its_best_child() -> None:
    def score(_goal: Goal, scene: Scene) -> float:
        return 5.0 if scene.key[3:4] == (1,) else 2.0

    done = _search(Scripts(evaluator=score), scenes_of("a"), iterations=4)
    assert [node.scene.key for node in done.plan.tree[1::2]] == [
        (0, 0, 0, 0),
        (0, 0, 0, 1),
        (0, 0, 0, 2),
        (0, 0, 0, 1, 0),
    ]


def test_nothing_grows_below_the_depth_and_the_search_ends_where_nothing_can() -> None:
    done = _search(Scripts(), scenes_of("a"), children=2, depth=2, iterations=50)
    assert max(node.scene.depth for node in done.plan.tree) == 3  # a simulation looks one step beyond
    assert len(done.plan.tree) == 1 + 2 * (2 + 4)
    assert done.seconds == pytest.approx(3 * (2 + 4) + 1)


def test_children_of_a_node_have_keys_and_draws_of_their_own() -> None:
    done = _search(None, scenes_of(GARDEN), iterations=3)
    children = [node.scene for node in done.plan.tree if node.scene.depth == 1]
    assert [child.key for child in children] == [(0, 0, 0, 0), (0, 0, 0, 1), (0, 0, 0, 2)]
    assert len({child.text for child in children}) == 3


def test_a_views_own_value_draws_the_search_less_with_every_visit() -> None:
    # The first view promises 4 and gives 2, the second promises 3 and gives 3. With Q + V/(1 + n^3):
    # 4 + 4 against 3 + 3; 2 + 4/2 against 3 + 3; 4 against 3 + 3/2; 4 against 3 + 3/9; 2 + 4/9 against 3.33.
    def score(_goal: Goal, scene: Scene) -> float:
        return 3.0 if scene.key[2] == 1 else 4.0 if scene.depth == 0 else 2.0

    def searched(**settings: Any) -> list[int]:
        tree = _search(Scripts(evaluator=score), scenes_of("a", "b"), iterations=5, **settings).plan.tree
        return [node.scene.key[2] for node in tree[2::2]]

    assert searched() == [0, 1, 1, 0, 1]
    assert searched(exploration=0.0) == [0, 1, 1, 1, 1]
    assert searched(visit_power=0.0) == [0, 1, 1, 1, 1]  # 2 + 4/2 against 3 + 3/2, for ever


def test_a_blocked_view_counts_as_the_lowest_score_and_blocks_its_frontier() -> None:
    done = _search(Scripts(evaluator={"wall": BLOCKED}), scenes_of("wall", "park"), iterations=2)
    assert [score.blocked for score in done.plan.scores] == [True, False]
    assert done.plan.scores[0].q == pytest.approx(1.0)
    assert all(node.scene.key[2] == 1 for node in done.plan.tree[2:])


def test_forbidden_ground_is_told_from_the_view_itself() -> None:
    forbidden = Assessment(likert_from_score(4.0), forbidden=True)
    done = _search(Scripts(evaluator={"road": forbidden}), scenes_of("road", "park"))
    assert [score.forbidden for score in done.plan.scores] == [True, False]


def test_a_view_whose_score_is_missing_is_imagined_from_and_never_given_one() -> None:
    scripts = Scripts(evaluator=lambda goal, scene: Fail("no answer") if scene.key == (0, 0, 1) else 4.0)
    assert _search(scripts, scenes_of("a", "b"), iterations=0).plan.scores[1] == FrontierScore(None, fault="no answer")
    assert _search(scripts, scenes_of("a", "b"), iterations=1).plan.scores[1].q == pytest.approx(4.0)


def test_a_simulation_that_is_missing_leaves_the_child_as_the_reward() -> None:
    scripts = Scripts(
        evaluator=lambda goal, scene: 2.0 if scene.depth == 1 else 4.0,
        visionary=lambda goal, scene: Fail("no vision") if scene.depth == 1 else "further on",
    )
    done = _search(scripts, scenes_of("a"), iterations=1)
    assert done.plan.scores[0].q == pytest.approx(2.0)
    assert done.plan.tree[-1].scene.fault == "no vision"


def test_a_visionary_that_never_answers_leaves_the_views_their_own_values() -> None:
    done = _search(Scripts(evaluator=4.0, visionary=Fail("no vision")), scenes_of("a", "b"))
    assert [score.q for score in done.plan.scores] == pytest.approx([4.0, 4.0])
    assert done.ledger.totals()["visionary"].calls == 2 * 3  # each place for a child was tried once


def test_where_nobody_answers_there_is_no_score() -> None:
    done = _search(Scripts(evaluator=Fail("no answer")), scenes_of("a"))
    assert done.plan.scores == (FrontierScore(None, fault="no answer"),)


@given(st.integers(0, 10_000), st.integers(1, 4), st.integers(0, 25), st.integers(1, 4), st.integers(1, 4))
def test_q_is_the_mean_of_the_rewards_below_it(
    seed: int, views: int, iterations: int, children: int, depth: int
) -> None:
    scenes = scenes_of(*"abcd"[:views])
    plan = _search(_keyed(seed), scenes, iterations=iterations, children=children, depth=depth).plan
    keys = [node.scene.key for node in plan.tree]
    assert len(set(keys)) == len(keys)
    for scene, score in zip(scenes, plan.scores, strict=True):
        rewards = _rewards(plan, scene)
        own = worth(next(node.assessment for node in plan.tree if node.scene.key == scene.key))
        expected = sum(rewards) / len(rewards) if rewards else own
        assert score.q == (expected if expected is None else pytest.approx(expected))
        assert (score.q is None) == (score.fault is not None)
        assert score.q is None or 1.0 - 1e-9 <= score.q <= 5.0 + 1e-9


def _rewards(plan: Plan, scene: Scene) -> list[float]:
    """Work the rewards out from the tree: an iteration leaves a child and, behind it, what was simulated from it."""
    grown = [node for node in plan.tree if node.scene.depth > 0]
    rewards = []
    while grown:
        made = [grown.pop(0)]
        if made[0].scene.fault is None:
            made.append(grown.pop(0))
        scores = [score for score in (worth(node.assessment) for node in made) if score is not None]
        if scores and made[0].scene.key[:3] == scene.key:
            rewards.append(sum(scores) / len(scores))
    return rewards


@given(st.integers(0, 10_000))
def test_the_answer_does_not_hang_on_the_order_of_the_views(seed: int) -> None:
    scenes = scenes_of("a", "b", "c")
    in_order = _search(_keyed(seed), scenes).plan.scores
    for order in permutations(range(3)):
        scores = _search(_keyed(seed), [scenes[index] for index in order]).plan.scores
        assert scores == tuple(in_order[index] for index in order)


def test_a_search_can_be_cancelled_at_any_moment_and_leaves_nothing_behind() -> None:
    clock = VirtualClock()
    planner = LlmMcts(make_words_minds(MindContext(clock, ONE_SECOND, Ledger(), 7)), LlmMctsSettings(iterations=3))
    scenes = scenes_of(PARK, STREET, GARDEN)

    async def mission() -> None:
        whole = await planner.plan(GOAL, scenes)
        for calls in range(3 * 3 + 1):
            with pytest.raises(TimeoutError):
                async with asyncio.timeout(calls + 0.5):
                    await planner.plan(GOAL, scenes)
            assert len(asyncio.all_tasks()) == 1
        assert await planner.plan(GOAL, scenes) == whole

    clock.run(mission())


def test_all_faults_of_settings_are_told_at_once() -> None:
    with pytest.raises(SettingsError) as raised:
        LlmMctsSettings(iterations=-1, children=0, depth=True, exploration=float("nan"), visit_power=11)
    assert len(raised.value.faults) == 5


def test_settings_are_given_by_name() -> None:
    done = planned(lambda minds: make_planner("llm-mcts", minds, {"iterations": 2}), scenes_of("a"), Scripts())
    assert done.seconds == pytest.approx(7.0)
