"""The planners that ask no model."""

import asyncio
import statistics
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.clock import VirtualClock
from reasoned_explorer.geometry import Pose
from reasoned_explorer.minds import Ledger, MindContext, Minds, latency_profile
from reasoned_explorer.minds.scripted import make_minds
from reasoned_explorer.model import Goal, Scene
from reasoned_explorer.planning import Planner
from reasoned_explorer.planning.without_models import (
    EVEN_SCORE,
    FollowPaths,
    NearestFrontier,
    ObjectDensity,
    RandomFrontier,
)

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


CROWDED = "In the foreground, on the left, there is a bench, a tree and a fountain. In the distance, there is a car."
SPREAD = "Close by, on the left, there is a bench. On the right, there is a tree. In the distance, there is a car."
TREES = "A little further on, on the left, there are five trees. In the background there are many houses."


def _scores(planner: Planner, *texts: str) -> list[float | None]:
    return [score.q for score in asyncio.run(planner.plan(GOAL, scenes(*texts))).scores]


def test_density_counts_what_is_named_at_the_same_distance_on_the_same_side() -> None:
    crowded, spread, trees, empty = _scores(ObjectDensity(), CROWDED, SPREAD, TREES, GRASS)
    assert crowded == pytest.approx(3.1)
    assert spread == trees == pytest.approx(2.9)  # many of a kind are one mention, and the background is far away
    assert empty == pytest.approx(2.8)


def test_density_counts_nothing_that_is_said_not_to_be_there() -> None:
    assert _scores(ObjectDensity(), "There is no bench, no tree and no fountain.") == pytest.approx([2.8])


def test_density_has_a_highest_score() -> None:
    crowd = "Close by, there is a bench, a tree, a car, a fountain, a person, a mailbox, a lamp and a shrub."
    assert _scores(ObjectDensity(), crowd) == pytest.approx([3.4])


def _minds(seed: int) -> Minds:
    made = make_minds(MindContext(VirtualClock(), latency_profile("instant"), Ledger(), seed))
    return replace(made, seed=seed)


def test_chance_is_keyed_by_the_mission_and_the_view() -> None:
    once, again, other = (_scores(RandomFrontier(_minds(seed)), *[GRASS] * 5) for seed in (1, 1, 2))
    assert once == again != other
    assert len(set(once)) == 5


@given(st.integers(0, 2**32), st.integers(0, 500))
def test_chance_stays_near_the_even_score(seed: int, step: int) -> None:
    scene = Scene(GRASS, (step, 0, 1), Pose(0.0, 10.0, 1.0, 0.0))
    (score,) = asyncio.run(RandomFrontier(_minds(seed)).plan(GOAL, [scene])).scores
    assert score.q == pytest.approx(EVEN_SCORE, abs=0.3)


def test_chance_takes_steps_as_long_as_the_nearest_frontiers_on_average() -> None:
    planner = RandomFrontier(_minds(3))
    drawn = _scores(planner, *[GRASS] * 2000)
    assert statistics.fmean(q or 0.0 for q in drawn) == pytest.approx(EVEN_SCORE, abs=0.02)


@pytest.mark.parametrize("planner", [NearestFrontier(), FollowPaths(), ObjectDensity(), RandomFrontier(_minds(0))])
def test_a_wall_blocks_whatever_the_planner(planner: Planner) -> None:
    (score,) = asyncio.run(planner.plan(GOAL, scenes(WALL))).scores
    assert score.blocked


@pytest.mark.parametrize("planner", [NearestFrontier(), FollowPaths(), ObjectDensity(), RandomFrontier(_minds(0))])
def test_a_view_that_nobody_could_describe_has_no_score(planner: Planner) -> None:
    faulty = Scene("", (0, 0, 0), Pose(0.0, 10.0, 1.0, 0.0), fault="the captioner is away")
    plan = asyncio.run(planner.plan(GOAL, [faulty]))
    assert plan.scores[0].q is None
    assert plan.scores[0].fault == "the captioner is away"
