import math
from typing import Any

from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.exploration.graph import FrontierState, TopologicalGraph
from reasoned_explorer.geometry import Pose


def _graph(**settings: Any) -> TopologicalGraph:
    graph = TopologicalGraph(**settings)
    graph.add_point(Pose(0.0, 0.0))
    return graph


def test_the_choice_is_the_highest_score_less_the_penalty_of_distance() -> None:
    graph = _graph()
    graph.add_frontier(0, Pose(0.0, 10.0), 3.0)
    far = graph.add_frontier(0, Pose(0.0, 100.0), 3.9)
    near = graph.add_frontier(0, Pose(10.0, 0.0), 3.1)
    choice = graph.choose(0)
    assert choice is not None
    assert choice.frontier is near  # 3.1 - 0 beats 3.9 - 1
    graph.take(near)
    again = graph.choose(0)
    assert again is not None
    assert again.frontier is not far
    assert near.state is FrontierState.VISITED


def test_ties_go_to_the_nearer_and_then_to_the_older() -> None:
    graph = _graph()
    graph.add_frontier(0, Pose(0.0, 12.0), 3.0)
    older = graph.add_frontier(0, Pose(0.0, 10.0), 3.00001)
    graph.add_frontier(0, Pose(10.0, 0.0), 3.00004)
    choice = graph.choose(0)
    assert choice is not None
    assert choice.frontier is older


def test_shunned_ground_comes_last_and_missing_scores_before_it() -> None:
    graph = _graph()
    shunned = graph.add_frontier(0, Pose(0.0, 10.0), 5.0, forbidden=True)
    missing = graph.add_frontier(0, Pose(10.0, 0.0), None)
    poor = graph.add_frontier(0, Pose(0.0, -10.0), 1.0)
    order = []
    while (choice := graph.choose(0)) is not None:
        order.append(choice.frontier)
        graph.take(choice.frontier)
    assert order == [poor, missing, shunned]


def test_a_blocked_frontier_is_remembered_with_its_reason_and_never_chosen() -> None:
    graph = _graph()
    blocked = graph.add_frontier(0, Pose(0.0, 10.0), 1.0, blocked_by="a wall")
    assert graph.choose(0) is None
    assert (blocked.state, blocked.reason) == (FrontierState.BLOCKED, "a wall")


def test_the_way_to_a_remote_frontier_leads_along_known_edges() -> None:
    graph = _graph()
    corner = graph.add_point(Pose(0.0, 50.0), previous=0)
    end = graph.add_point(Pose(50.0, 50.0), previous=corner)
    frontier = graph.add_frontier(0, Pose(10.0, 0.0), 3.0)
    route = graph.route(end, frontier)
    assert [(pose.x_m, pose.y_m) for pose in route] == [(0.0, 50.0), (0.0, 0.0), (10.0, 0.0)]


def test_a_path_point_found_again_closes_the_loop() -> None:
    graph = _graph()
    away = graph.add_point(Pose(0.0, 20.0), previous=0)
    assert graph.add_point(Pose(1.0, 0.0), previous=away) == 0
    assert len(graph.points) == 2


@given(st.lists(st.tuples(st.floats(-200, 200), st.floats(-200, 200), st.floats(1, 5)), min_size=1, max_size=30))
def test_no_open_frontier_is_worth_more_than_the_chosen_one(frontiers: list[tuple[float, float, float]]) -> None:
    graph = _graph()
    for x_m, y_m, q in frontiers:
        graph.add_frontier(0, Pose(x_m, y_m), q)
    choice = graph.choose(0)
    assert choice is not None
    assert choice.value is not None
    for frontier in graph.open_frontiers():
        distance_m = math.hypot(frontier.pose.x_m, frontier.pose.y_m)
        worth = (frontier.q or 0.0) - 1.0 / (1.0 + math.exp(-0.5 * (distance_m - 60.0)))
        assert worth <= choice.value + 1e-4


def test_distance_is_that_of_the_way_not_of_the_straight_line() -> None:
    graph = _graph()
    graph.add_point(Pose(0.0, 50.0), previous=0)
    last = graph.add_point(Pose(8.0, 0.0), previous=1)  # 8 m from where it began, 100 m on the way there
    behind_the_wall = graph.add_frontier(0, Pose(0.0, -5.0), 3.0)
    ahead = graph.add_frontier(last, Pose(20.0, 0.0), 3.0)
    choice = graph.choose(last)
    assert choice is not None
    assert choice.frontier is ahead
    graph.take(ahead)
    choice = graph.choose(last)
    assert choice is not None
    assert choice.frontier is behind_the_wall
    assert math.isclose(choice.distance_m, math.hypot(8.0, 50.0) + 50.0 + 5.0)
    assert choice.penalty > 0.99


def test_a_frontier_that_was_passed_close_by_costs_at_least_the_half_distance() -> None:
    graph = _graph(known_radius_m=5.0)
    passed = graph.add_frontier(0, Pose(11.0, 0.0), 3.0)
    fresh = graph.add_frontier(0, Pose(-12.0, 0.0), 2.6)
    north = graph.add_point(Pose(0.0, 11.0), previous=0)
    east = graph.add_point(Pose(15.0, 11.0), previous=north)
    assert not passed.known
    south = graph.add_point(Pose(15.0, -11.0), previous=east)  # this leg passes 4 m from it
    assert passed.known
    graph.add_point(Pose(0.0, 0.5), previous=south)
    choice = graph.choose(0)
    assert choice is not None
    assert choice.frontier is fresh  # 2.6 beats 3.0 - 0.5
    graph.take(fresh)
    choice = graph.choose(0)
    assert choice is not None
    assert (choice.frontier, choice.penalty, choice.value) == (passed, 0.5, 2.5)


def test_legs_from_its_own_path_point_make_no_frontier_known() -> None:
    graph = _graph(known_radius_m=5.0)
    graph.add_point(Pose(0.0, 5.0), previous=0)
    aside = graph.add_frontier(0, Pose(2.0, 4.0), 3.0)
    assert not aside.known


def test_the_distance_may_be_the_straight_one() -> None:
    graph = _graph(straight=True)
    around = graph.add_point(Pose(0.0, 50.0), previous=0)
    last = graph.add_point(Pose(8.0, 5.0), previous=around)
    graph.add_frontier(0, Pose(5.0, 5.0), 3.0)
    choice = graph.choose(last)
    assert choice is not None
    assert math.isclose(choice.distance_m, 3.0)


def test_without_a_known_radius_nothing_is_known() -> None:
    graph = _graph()
    frontier = graph.add_frontier(0, Pose(5.0, 5.0), 3.0)
    one = graph.add_point(Pose(4.0, 0.0), previous=0)
    graph.add_point(Pose(6.0, 10.0), previous=one)
    assert not frontier.known
