"""Fresh-Ground: what scores count for, what is asked, and how the agent is told to look and walk."""

import math
from dataclasses import fields
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.exploration.graph import TopologicalGraph
from reasoned_explorer.exploration.settings import ExplorerSettings
from reasoned_explorer.geometry import Pose
from reasoned_explorer.minds.scripted import Fail, Scripts
from reasoned_explorer.model import Assessment, Scene, SettingsError, likert_from_score
from reasoned_explorer.planning.fresh_ground import FreshGround, FreshGroundSettings
from reasoned_explorer.planning.registry import make_planner
from tests.planning.helpers import Planned, planned, scenes_of


def _planned(scenes: list[Scene], scripts: Scripts, **settings: Any) -> Planned:
    return planned(lambda minds: make_planner("fresh-ground", minds, settings), scenes, scripts)


def _agent(**settings: Any) -> ExplorerSettings:
    made: list[FreshGround] = []
    planned(lambda minds: made.append(FreshGround(minds, FreshGroundSettings(**settings))) or made[0], [], Scripts())
    return ExplorerSettings(**made[0].explorer)


def test_guesses_are_drawn_together_and_what_is_seen_counts_in_full() -> None:
    scores = {"1": 1.0, "2": 2.0, "3": 3.0, "4": 4.0, "5": 5.0}
    done = _planned(scenes_of(*scores), Scripts(evaluator=scores))
    assert [score.q for score in done.plan.scores] == pytest.approx([1.6, 2.0, 2.4, 4.0, 5.0])
    # The tree keeps what the evaluator said.
    assert [node.assessment and node.assessment.score for node in done.plan.tree] == pytest.approx([*scores.values()])


@given(st.floats(1.0, 5.0), st.floats(1.0, 5.0), st.floats(0.0, 1.0))
def test_no_order_is_turned_round_and_no_step_is_in_the_way(one: float, other: float, hint: float) -> None:
    settings = FreshGroundSettings(hint=hint)
    low, high = sorted((one, other))
    assert 1.0 <= settings.weighed(low) <= settings.weighed(high) <= 5.0
    assert settings.weighed(high) - settings.weighed(low) <= 2.0 * (high - low) + 1e-9


@given(st.floats(1.0, 5.0))
def test_a_hint_of_one_leaves_scores_as_they_are(score: float) -> None:
    assert FreshGroundSettings(hint=1.0).weighed(score) == pytest.approx(score)


def test_no_guess_outweighs_that_ground_is_known_and_what_is_seen_does() -> None:
    settings = FreshGroundSettings()
    graph = TopologicalGraph(known_radius_m=settings.known_radius_m)
    # The robot walked north, then east; one frontier lies where it came from, one where it has not been.
    south, corner, east = (graph.add_point(Pose(x, y)) for x, y in ((0.0, 0.0), (0.0, 40.0), (40.0, 40.0)))
    graph.add_point(Pose(0.0, 40.0), previous=south)
    graph.add_point(Pose(40.0, 40.0), previous=corner)
    known = graph.add_frontier(east, Pose(20.0, 30.0), settings.weighed(3.0))
    fresh = graph.add_frontier(east, Pose(60.0, 40.0), settings.weighed(2.0))
    assert (known.known, fresh.known) == (True, False)
    assert graph.choose(east).frontier is fresh
    known.q = settings.weighed(3.5)
    assert graph.choose(east).frontier is known


def test_a_step_asks_the_evaluator_once_a_view_and_nobody_to_imagine() -> None:
    done = _planned(scenes_of("a", "b", "c", "d", "e"), Scripts())
    assert {role: total.calls for role, total in done.ledger.totals().items()} == {"evaluator": 5}
    assert done.seconds == pytest.approx(1.0)


def test_blocked_and_forbidden_are_passed_on() -> None:
    wall, lawn = Assessment(likert_from_score(5.0), blocked=True), Assessment(likert_from_score(3.0), forbidden=True)
    done = _planned(scenes_of("wall", "lawn"), Scripts(evaluator={"wall": wall, "lawn": lawn}))
    assert [(score.blocked, score.forbidden) for score in done.plan.scores] == [(True, False), (False, True)]
    assert done.plan.scores[0].q == pytest.approx(1.6)  # what is blocked counts as the lowest


def test_a_missing_answer_and_a_missing_description_are_never_numbers() -> None:
    scenes = [*scenes_of("a"), Scene("", (0, 0, 1), Pose(0.0, 0.0), fault="camera")]
    done = _planned(scenes, Scripts(evaluator=Fail("no answer")))
    assert [(score.q, score.fault) for score in done.plan.scores] == [(None, "no answer"), (None, "camera")]


def test_the_agent_looks_nearly_all_round_and_walks_far_where_nothing_is_in_sight() -> None:
    agent = _agent()
    assert [round(math.degrees(turn)) for turn in agent.bearings_rad()] == [-120, -60, 0, 60, 120]
    weighed = FreshGroundSettings().weighed
    assert agent.step_m(weighed(2.0), 1) == pytest.approx(20.0)
    assert agent.step_m(5.0, 1) == pytest.approx(5.0)


def test_each_change_can_be_switched_off_and_the_agent_is_the_papers_then() -> None:
    paper, ours = ExplorerSettings(), _agent(known_radius_m=0.0, step_max_m=20.0, views=3)
    assert ours.bearings_rad() == pytest.approx(paper.bearings_rad())
    assert ours.step_range_m(1) == paper.step_range_m(1)
    changed = [item.name for item in fields(paper) if getattr(paper, item.name) != getattr(ours, item.name)]
    assert set(changed) <= {"step_max_m", "sweep_rad"}


def test_all_faults_of_settings_are_told_at_once() -> None:
    with pytest.raises(SettingsError) as raised:
        FreshGroundSettings(hint=float("nan"), known_radius_m=-1.0, step_max_m=True, views=2.5)  # type: ignore[arg-type]
    assert len(raised.value.faults) == 4
