"""The controls: alike in all that is spent, and without what they take away."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.minds.scripted import Fail, Scripts
from reasoned_explorer.model import Assessment, Goal, Scene, likert_from_score
from reasoned_explorer.planning.registry import make_planner
from tests.planning.helpers import GARDEN, PARK, STREET, Planned, planned, scenes_of

BEYOND = Scripts(visionary=lambda goal, scene: [f"{scene.text}{child}" for child in range(3)])


def _planned(
    name: str, scenes: list[Scene], scripts: Scripts | None = None, *, seed: int = 7, **settings: int
) -> Planned:
    return planned(lambda minds: make_planner(name, minds, settings), scenes, scripts, seed=seed)


def _texts(done: Planned) -> dict[tuple[int, ...], str]:
    return {node.scene.key: node.scene.text for node in done.plan.tree}


@pytest.mark.parametrize("name", ["llm-rrt-echo", "llm-rrt-shuffled"])
def test_a_control_spends_what_llm_rrt_spends_and_grows_the_same_tree(name: str) -> None:
    scenes = scenes_of(PARK, STREET, GARDEN)
    real, control = _planned("llm-rrt", scenes), _planned(name, scenes)
    assert control.seconds == real.seconds
    assert [(c.role, c.key, c.latency_s) for c in control.ledger.calls] == [
        (c.role, c.key, c.latency_s) for c in real.ledger.calls
    ]
    for theirs, ours in zip(real.plan.tree, control.plan.tree, strict=True):
        assert (ours.scene.key, ours.scene.depth, ours.scene.waypoint) == (
            theirs.scene.key,
            theirs.scene.depth,
            theirs.scene.waypoint,
        )


def test_an_echo_imagines_what_is_seen() -> None:
    assert set(_texts(_planned("llm-rrt-echo", scenes_of("a", "b"), BEYOND)).values()) == {"a", "b"}


def test_an_echo_scores_as_llm_as_eval_does() -> None:
    scenes = scenes_of(PARK, STREET, GARDEN)
    echo, own = _planned("llm-rrt-echo", scenes), _planned("llm-as-eval", scenes)
    assert [score.q for score in echo.plan.scores] == pytest.approx([score.q for score in own.plan.scores])


def test_an_echo_of_a_missing_answer_is_missing() -> None:
    done = _planned("llm-rrt-echo", scenes_of("a"), Scripts(visionary=Fail("no vision")))
    assert done.plan.scores[0].q is None
    assert done.plan.scores[0].fault == "no vision"


@given(st.integers(0, 2**40), st.integers(2, 7), st.integers(0, 300), st.integers(1, 4))
def test_no_view_keeps_what_was_imagined_from_it_and_none_is_lost(seed: int, views: int, step: int, depth: int) -> None:
    scenes = scenes_of(*"abcdefg"[:views], step=step)
    done = _planned("llm-rrt-shuffled", scenes, BEYOND, seed=seed, depth=depth)
    texts = _texts(done)
    for scene in scenes:
        sources = {text[0] for key, text in texts.items() if key[:3] == scene.key}
        assert len(sources) == 1  # one other view, at every depth
        assert sources != {scene.text}
    real = _planned("llm-rrt", scenes, BEYOND, seed=seed, depth=depth)
    assert sorted(texts.values()) == sorted(_texts(real).values())


def test_views_are_shuffled_anew_at_every_look_and_by_the_missions_seed() -> None:
    def dealt(seed: int, step: int) -> str:
        texts = _texts(_planned("llm-rrt-shuffled", scenes_of(*"abc", step=step), BEYOND, seed=seed, depth=1))
        return "".join(texts[step, 0, view, 0][0] for view in range(3))

    assert {dealt(7, step) for step in range(20)} == {"bca", "cab"}
    assert {dealt(seed, 0) for seed in range(20)} == {"bca", "cab"}
    assert dealt(7, 3) == dealt(7, 3)


def test_the_shuffle_does_not_hang_on_the_order_of_the_views() -> None:
    scenes = scenes_of("a", "b", "c", "d")
    forwards, backwards = (_texts(_planned("llm-rrt-shuffled", each, BEYOND)) for each in (scenes, scenes[::-1]))
    assert forwards == backwards


def test_with_one_view_nothing_can_be_shuffled() -> None:
    scenes = scenes_of("a")
    assert _texts(_planned("llm-rrt-shuffled", scenes, BEYOND)) == _texts(_planned("llm-rrt", scenes, BEYOND))


def test_a_missing_answer_is_dealt_out_like_any_other() -> None:
    scripts = Scripts(visionary=lambda goal, scene: Fail("no vision") if scene.text == "a" else "further on")
    done = _planned("llm-rrt-shuffled", scenes_of("a", "b"), scripts)
    assert [score.q is None for score in done.plan.scores] == [False, True]


def test_matched_llm_as_eval_asks_as_often_as_llm_rrt() -> None:
    scenes = scenes_of("a", "b", "c")
    matched, real = _planned("llm-as-eval-matched", scenes, Scripts()), _planned("llm-rrt", scenes, Scripts())
    assert matched.ledger.totals()["evaluator"].calls == real.ledger.totals()["evaluator"].calls == 18
    assert "visionary" not in matched.ledger.totals()
    assert len({call.key for call in matched.ledger.calls}) == 18
    assert matched.seconds == pytest.approx(1.0)
    assert len(_planned("llm-as-eval-matched", scenes, Scripts(), children=2, depth=4).plan.tree) == 3 * 8


def test_matched_llm_as_eval_takes_the_mean_of_what_was_answered() -> None:
    def score(_goal: Goal, scene: Scene) -> object:
        return Fail("no answer") if scene.key[-1] == 5 else 1.0 + scene.key[-1]

    done = _planned("llm-as-eval-matched", scenes_of("a"), Scripts(evaluator=score))
    assert done.plan.scores[0].q == pytest.approx((1.0 + 2.0 + 3.0 + 4.0 + 5.0) / 5)


def test_matched_llm_as_eval_calls_a_view_blocked_where_every_answer_does() -> None:
    blocked = Assessment(likert_from_score(3.0), blocked=True)
    done = _planned(
        "llm-as-eval-matched",
        scenes_of("wall", "fence"),
        Scripts(evaluator=lambda goal, scene: blocked if scene.text == "wall" or scene.key[-1] else 3.0),
    )
    assert [score.blocked for score in done.plan.scores] == [True, False]
    assert done.plan.scores[1].q == pytest.approx((3.0 + 5 * 1.0) / 6)
