"""The planners that ask no model."""

import asyncio

import pytest

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Goal, Scene
from reasoned_explorer.planning.without_models import EVEN_SCORE, FollowPaths, NearestFrontier

GOAL = Goal("Find me a bench", 1)
FOOTPATH = "The image shows a footpath. A footpath leads straight ahead; there is grass on both sides."
GRASS = "The image shows a grassy area. Grass lies straight ahead; there is a footpath to the left."
ROAD = "The image shows a street. A road leads straight ahead."
WALL = "The image shows a sidewalk. The wall of a building fills most of the view and blocks the way ahead."


def scenes(*texts: str) -> list[Scene]:
    return [Scene(text, (0, 0, index), Pose(0.0, 10.0, 1.0, 0.0)) for index, text in enumerate(texts)]


def test_the_nearest_frontier_planner_finds_all_ways_equally_good_unless_they_are_blocked() -> None:
    plan = asyncio.run(NearestFrontier().plan(GOAL, scenes(FOOTPATH, WALL, GRASS)))
    assert [score.q for score in plan.scores] == [EVEN_SCORE] * 3
    assert [score.blocked for score in plan.scores] == [False, True, False]


def test_paths_come_before_roads_and_roads_before_grass() -> None:
    plan = asyncio.run(FollowPaths().plan(GOAL, scenes(GRASS, FOOTPATH, ROAD)))
    grass, path, road = (score.q or 0.0 for score in plan.scores)
    assert path > road > grass


def test_a_path_to_the_side_is_none_ahead() -> None:
    plan = asyncio.run(FollowPaths().plan(GOAL, scenes(GRASS, "The image shows an outdoor area.")))
    assert plan.scores[0].q == plan.scores[1].q


@pytest.mark.parametrize("planner", [NearestFrontier(), FollowPaths()])
def test_a_view_that_nobody_could_describe_has_no_score(planner: NearestFrontier | FollowPaths) -> None:
    faulty = Scene("", (0, 0, 0), Pose(0.0, 10.0, 1.0, 0.0), fault="the captioner is away")
    plan = asyncio.run(planner.plan(GOAL, [faulty]))
    assert plan.scores[0].q is None
    assert plan.scores[0].fault == "the captioner is away"
