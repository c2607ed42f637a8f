"""The agent's loop, step by step, with fake parts on an empty plane."""

import math

import pytest

from reasoned_explorer.exploration.settings import ExplorerSettings
from reasoned_explorer.model import Scene
from reasoned_explorer.model.record import MissionEnd
from reasoned_explorer.planning import FrontierScore
from tests.exploration.fakes import Plane


def test_a_mission_ends_when_time_is_over_and_every_second_is_accounted_for() -> None:
    plane = Plane()
    ended = plane.run()
    assert ended.end is MissionEnd.TIME_OVER
    assert ended.ct_s + ended.tt_s == pytest.approx(plane.steps[-1].ended_s)
    assert plane.vehicle.closed


def test_planning_and_checking_run_at_the_same_time() -> None:
    plane = Plane()
    plane.run()
    first = plane.steps[0]
    assert first.look_s == pytest.approx(1.0)
    assert first.think_s == pytest.approx(2.0 + 10.0)  # captions, then max(plan 10, check 3)
    assert first.plan_s == pytest.approx(10.0)


def test_the_goal_is_declared_after_two_looks_and_planning_is_cut_short() -> None:
    plane = Plane()
    plane.checker.rule = lambda scene: True
    ended = plane.run()
    assert ended.end is MissionEnd.FOUND
    assert ended.reason == "a bench"
    assert plane.vehicle.looks == 2
    assert plane.planner.finished == 0
    # Captions 2, check 3, a look of 1 that is acting, captions 2, check 3: the plan of 10 s was cancelled at 9.
    assert ended.ct_s == pytest.approx(2.0 + 3.0 + 2.0 + 3.0)
    assert ended.tt_s == pytest.approx(1.0 + 1.0)
    assert ended.plan_s == pytest.approx(9.0)


def test_a_goal_that_the_second_look_does_not_confirm_is_not_declared() -> None:
    plane = Plane()
    plane.checker.rule = lambda scene: scene.key[1] == 0
    ended = plane.run()
    assert ended.end is MissionEnd.TIME_OVER
    assert any("second look" in note for step in plane.steps for note in step.notes)


def test_the_best_frontier_is_gone_to() -> None:
    plane = Plane()
    plane.planner.rule = lambda scene: FrontierScore(4.0 if scene.key[2] == 2 else 2.0)
    plane.run()
    choice = plane.steps[0].choice
    assert choice is not None
    assert choice.frontier == 2
    assert plane.steps[0].legs[0].target[0] > 0  # the third view looks 60° to the right of north


def test_where_all_views_are_blocked_the_agent_goes_back_to_the_best_remembered_frontier() -> None:
    plane = Plane()
    plane.planner.rule = lambda scene: FrontierScore(3.0, blocked=scene.key[0] > 0)
    plane.run()
    second = plane.steps[1].choice
    assert second is not None
    assert second.frontier in (1, 2)  # seen in the first step, left over
    assert len(plane.steps[1].legs) == 2  # back to the first path point, then on


def test_with_nothing_left_it_looks_elsewhere_before_it_gives_up() -> None:
    plane = Plane()
    plane.planner.rule = lambda scene: FrontierScore(3.0, blocked=True)
    ended = plane.run()
    assert ended.end is MissionEnd.NOTHING_LEFT
    assert plane.vehicle.looks == 4
    headings = {round(view.heading_rad, 3) for step in plane.steps for view in step.views}
    assert len(headings) > 6


def test_a_frontier_that_cannot_be_reached_is_given_up_with_its_reason() -> None:
    plane = Plane()
    plane.vehicle.wall = lambda pose: pose.y_m > 4.0 and abs(pose.x_m) < 1.0
    plane.run()
    given_up = [f for step in plane.steps for f in step.frontiers if f.state == "given up"]
    assert any(frontier.reason == "collision: a wall" for frontier in given_up)


def test_forbidden_ground_is_gone_to_last() -> None:
    plane = Plane()
    plane.planner.rule = lambda scene: FrontierScore(5.0 if scene.key[2] == 1 else 2.0, forbidden=scene.key[2] == 1)
    plane.run()
    choice = plane.steps[0].choice
    assert choice is not None
    assert choice.frontier != 0


@pytest.mark.parametrize("part", ["camera", "link"])
def test_a_vehicle_that_keeps_failing_ends_the_mission_as_a_fault(part: str) -> None:
    plane = Plane()
    plane.vehicle.broken = {part}
    ended = plane.run()
    assert ended.end is MissionEnd.FAULT
    assert part in ended.reason
    assert plane.vehicle.closed


@pytest.mark.parametrize("part", ["captioner", "checker", "planner"])
def test_a_model_that_fails_once_costs_a_step_and_not_the_mission(part: str) -> None:
    plane = Plane()
    getattr(plane, part).broken = True
    plane.on_step = lambda step: setattr(getattr(plane, part), "broken", False)
    ended = plane.run()
    assert ended.end is MissionEnd.TIME_OVER
    assert plane.vehicle.legs > 3
    assert any("no answer" in note for note in plane.steps[0].notes)


def test_missing_answers_never_become_scores() -> None:
    plane = Plane()
    plane.planner.broken = True
    ended = plane.run()
    assert ended.end is MissionEnd.FAULT
    assert all(view.q is None for step in plane.steps for view in step.views)
    assert all("no answer" in (view.plan_fault or "") for step in plane.steps for view in step.views)


def test_a_view_that_is_not_described_is_left_out_and_the_step_goes_on_with_the_others() -> None:
    plane = Plane()
    plane.captioner.lost = frozenset({1})
    asked: list[int] = []
    plane.checker.rule = lambda scene: asked.append(scene.key[2]) is not None
    plane.planner.rule = lambda scene: FrontierScore(None if scene.fault else 3.0, fault=scene.fault)
    ended = plane.run()
    assert ended.end is MissionEnd.TIME_OVER  # it is no fault of the step, though each step has one
    views = plane.steps[0].views
    assert [view.caption_fault for view in views] == [None, "refused", None]
    assert [view.q for view in views] == [3.0, None, 3.0]
    assert 1 not in asked
    assert "view 1 is not described: refused" in plane.steps[0].notes


def test_the_step_budget_ends_a_mission() -> None:
    plane = Plane(ExplorerSettings(max_steps=3))
    ended = plane.run()
    assert (ended.end, ended.steps) == (MissionEnd.BUDGET_SPENT, 3)


def test_checks_after_planning_are_made_one_by_one_and_all_of_it_is_waited_for() -> None:
    plane = Plane(ExplorerSettings(t_max_s=300.0, check_after_planning=True))
    plane.run()
    first = plane.steps[0]
    assert first.think_s == pytest.approx(2.0 + 10.0 + 3 * 3.0)  # captions, then the plan, then three checks
    assert first.plan_s == pytest.approx(10.0)


def test_checks_one_by_one_stop_at_the_first_that_finds_the_goal() -> None:
    plane = Plane(ExplorerSettings(check_after_planning=True))
    asked: list[int] = []

    def rule(scene: Scene) -> bool:
        asked.append(scene.key[2])
        return scene.key[1] == 1 or scene.key[2] == 1

    plane.checker.rule = rule
    ended = plane.run()
    assert ended.end is MissionEnd.FOUND
    assert asked == [0, 1, 0]  # the third view is not asked about; the last is the one that makes sure
    assert ended.ct_s == pytest.approx(2.0 + 10.0 + 2 * 3.0 + 2.0 + 3.0)
    assert plane.planner.finished == 1
    assert [view.q for view in plane.steps[0].views[:3]] == [3.0] * 3  # the plan was made, and is kept


def test_a_checker_that_fails_after_planning_costs_a_step_and_not_the_plan() -> None:
    plane = Plane(ExplorerSettings(t_max_s=300.0, check_after_planning=True))
    plane.checker.broken = True
    plane.on_step = lambda step: setattr(plane.checker, "broken", False)
    assert plane.run().end is MissionEnd.TIME_OVER
    assert plane.steps[0].choice is not None


@pytest.mark.parametrize(("straight", "legs"), [(False, 2), (True, 1)])
def test_a_remote_frontier_is_flown_to_straight_or_gone_to_along_known_edges(straight: bool, legs: int) -> None:
    plane = Plane(ExplorerSettings(t_max_s=300.0, straight_legs=straight))
    plane.planner.rule = lambda scene: FrontierScore(3.0, blocked=scene.key[0] > 0)
    plane.run()
    second = plane.steps[1]
    assert second.choice is not None
    assert second.choice.frontier in (1, 2)  # seen in the first step, left over
    assert len(second.legs) == legs
    straight_m = math.dist(second.legs[-1].target, (plane.steps[1].pose[0], plane.steps[1].pose[1]))
    assert (second.choice.distance_m == pytest.approx(straight_m, abs=0.01)) is straight
