import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.evaluation.scoring import Look, ndtw_of, outcome_of, score, soft_spl_of, spl_of
from reasoned_explorer.evaluation.scoring_kernels import dtw
from reasoned_explorer.model import InputError, TrackPoint
from reasoned_explorer.world.taxonomy import Ground
from tests.evaluation.scores import FAILED, outcome, scored
from tests.task.scenes import box, house, judge_of, patch, world_of

NORTH, EAST, SOUTH = 0.0, math.pi / 2.0, math.pi


def track(*points):
    return [TrackPoint(float(i), x, y, 1.0, 0.0) for i, (x, y) in enumerate(points)]


def came_of(points, judge, **more):
    values = {"mission_id": "a", "vehicle": "go1", "declared": True, "computing_s": 30.0, "travelling_s": 60.0}
    return outcome_of(track(*points), judge, **{**values, **more})


# By hand.


def test_a_success_by_hand():
    found = scored()
    assert found.success
    assert found.spl == 0.5  # 100/max(200, 100)
    assert found.soft_spl == 0.5  # nothing is left to go
    assert found.time_factor == 0.5  # 1 - 900 s of 1800 s
    assert found.planner_time_factor == pytest.approx(0.6)  # 1 - (120 + 600)/1800
    assert found.casr == 0.5


def test_without_a_declaration_there_is_no_success_but_an_oracle_one():
    found = scored(declared=False)
    assert not found.success
    assert found.oracle_success
    assert (found.spl, found.casr) == (0.0, 0.0)
    assert found.success_at == ((5.0, False), (20.0, False))


def test_over_time_is_failure():
    found = scored(computing_s=1200.1)
    assert found.over_time
    assert not found.success
    assert (found.time_factor, found.planner_time_factor, found.spl) == (0.0, 0.0, 0.0)


def test_exactly_in_time_is_success_without_a_bonus():
    found = scored(computing_s=1200.0)
    assert found.success
    assert (found.time_factor, found.casr) == (0.0, 0.0)


@pytest.mark.parametrize(
    ("success", "path_m", "reference_m", "spl"),
    [
        (True, 100.0, 100.0, 1.0),
        (True, 80.0, 100.0, 1.0),
        (True, 400.0, 100.0, 0.25),
        (False, 100.0, 100.0, 0.0),
        # Started in place: declared at once, and only after a walk.
        (True, 0.0, 0.0, 1.0),
        (True, 10.0, 0.0, 0.0),
        (True, 0.0, 10.0, 1.0),
        # The judge knows no way.
        (True, 10.0, math.inf, 0.0),
        (False, 0.0, math.inf, 0.0),
    ],
)
def test_spl_and_its_corners(success, path_m, reference_m, spl):
    assert spl_of(success=success, path_length_m=path_m, reference_length_m=reference_m) == spl


@pytest.mark.parametrize(
    ("remaining_m", "path_m", "reference_m", "soft_spl"),
    [
        (25.0, 100.0, 100.0, 0.75),  # (1 - 25/100) · 100/100
        (25.0, 200.0, 100.0, 0.375),  # (1 - 25/100) · 100/200
        (0.0, 200.0, 100.0, 0.5),
        (100.0, 50.0, 100.0, 0.0),
        (150.0, 50.0, 100.0, 0.0),  # further off than at the start: max(0, 1 - 1.5)
        (100.0, 0.0, 100.0, 0.0),  # never moved
        # Started in place: stayed, walked about and came back, went away.
        (0.0, 0.0, 0.0, 1.0),
        (0.0, 30.0, 0.0, 0.0),
        (20.0, 30.0, 0.0, 0.0),
        # No way from the end, or none at all.
        (math.inf, 50.0, 100.0, 0.0),
        (math.inf, 50.0, math.inf, 0.0),
        (0.0, 50.0, math.inf, 0.0),
    ],
)
def test_soft_spl_and_its_corners(remaining_m, path_m, reference_m, soft_spl):
    got = soft_spl_of(remaining_m=remaining_m, path_length_m=path_m, reference_length_m=reference_m)
    assert got == pytest.approx(soft_spl)


def test_soft_spl_asks_neither_for_a_declaration_nor_for_time_but_for_compliance():
    near = {**FAILED, "path_length_m": 100.0}
    assert scored(**near).soft_spl == pytest.approx(0.97)  # (1 - 3/100) · 100/100
    assert scored(**near, declared=False, computing_s=1800.0).soft_spl == pytest.approx(0.97)
    assert scored(**near, compliant=False).soft_spl == 0.0


def test_ndtw_beside_the_reference():
    # Three pairs, each 1 m apart: exp(-3/(3 · 15)).
    assert ndtw_of([(0, 1), (2, 1)], [(0, 0), (2, 0)], threshold_m=15.0) == pytest.approx(math.exp(-1 / 15))
    assert ndtw_of([(0, 0), (2, 0)], [(0, 0), (1, 0), (2, 0)], threshold_m=15.0) == 1.0


def test_ndtw_of_who_stays_at_the_start():
    # The only point of the track is paired with the reference's points at 0, 1 and 2 m: exp(-(0 + 1 + 2)/(3 · 15)).
    assert ndtw_of([(0, 0)], [(0, 0), (2, 0)], threshold_m=15.0) == pytest.approx(math.exp(-3 / 45))


def test_ndtw_of_who_leaves_the_goal_at_which_it_started():
    # The reference is one point; the track's points lie 0, 1 and 2 m from it: exp(-3/(1 · 15)).
    assert ndtw_of([(0, 0), (2, 0)], [(0, 0), (0, 0)], threshold_m=15.0) == pytest.approx(math.exp(-3 / 15))
    assert ndtw_of([(0, 0)], [(0, 0), (0, 0)], threshold_m=15.0) == 1.0


def test_ndtw_does_not_depend_on_how_densely_a_track_is_logged():
    dense = [(x / 100, 3.0) for x in range(2001)]
    sparse = [(0.0, 3.0), (20.0, 3.0)]
    reference = [(0.0, 0.0), (20.0, 0.0)]
    got = [ndtw_of(way, reference, threshold_m=15.0) for way in (dense, sparse)]
    assert got == pytest.approx([math.exp(-3 / 15)] * 2, rel=0.02)


def test_without_a_reference_there_is_no_ndtw():
    assert ndtw_of([(0, 0)], [], threshold_m=15.0) is None


@pytest.mark.parametrize(
    ("gone", "wanted", "threshold_m"),
    [([], [(0, 0)], 15.0), ([(0, math.nan)], [(0, 0)], 15.0), ([(0, 0)], [(0, math.inf)], 15.0), ([(0, 0)], [], 0.0)],
)
def test_ndtw_refuses_what_is_no_way(gone, wanted, threshold_m):
    with pytest.raises(InputError):
        ndtw_of(gone, wanted, threshold_m=threshold_m)


def test_warping_by_hand():
    # 0-0, 1-2, 3-3 costs 0 + 1 + 0; no warping costs less.
    first, second = np.array([(0.0, 0.0), (1.0, 0.0), (3.0, 0.0)]), np.array([(0.0, 0.0), (2.0, 0.0), (3.0, 0.0)])
    assert dtw(first, second) == 1.0


@pytest.mark.parametrize(("n", "m"), [(1, 1), (1, 7), (9, 1), (12, 30), (40, 17)])
def test_warping_is_that_of_the_whole_matrix(n, m):
    # As the reference implementations write it: the full (n + 1) × (m + 1) matrix.
    places = np.random.Generator(np.random.PCG64(n * 100 + m))
    first, second = places.random((n, 2)), places.random((m, 2))
    sums = np.full((n + 1, m + 1), np.inf)
    sums[0, 0] = 0.0
    for i in range(1, n + 1):
        for j in range(1, m + 1):
            cost = math.dist(first[i - 1], second[j - 1])
            sums[i, j] = cost + min(sums[i - 1, j], sums[i, j - 1], sums[i - 1, j - 1])
    assert dtw(first, second) == pytest.approx(sums[n, m], rel=1e-12)


# From a track.


def test_a_track_is_judged_and_scored():
    judge = judge_of(world_of(("bench", 50, 50)), "Find me a bench")
    came = came_of([(50, 9.7), (50, 39.7)], judge)
    assert came.in_place
    assert came.in_place_at == ((5.0, False), (10.0, True), (15.0, True), (20.0, True))
    assert came.distance_to_goal_m == pytest.approx(10.0)
    assert score(came).spl == pytest.approx(25.0 / 30.0, abs=0.04)
    assert score(came_of([(50, 9.7), (50, 39.7)], judge, reference_length_m=15.0)).spl == pytest.approx(0.5)


def test_what_is_left_to_go_is_measured_along_the_compliant_way():
    # 40 m before the bench's side, 25 of them to the edge of the success region; 10 m short of that edge.
    judge = judge_of(world_of(("bench", 50, 50)), "Find me a bench")
    came = came_of([(50, 9.7), (50, 24.7)], judge)
    assert came.remaining_m == pytest.approx(10.0, abs=1.0)
    assert score(came).soft_spl == pytest.approx((1 - 10 / 25) * 1.0, abs=0.04)
    # Off the way, as far from success as at the start or further: no progress, and nobody asks how far.
    assert math.isinf(came_of([(50, 9.7), (50, 2.0)], judge).remaining_m)
    assert came_of([(50, 9.7), (50, 9.7)], judge).remaining_m == came.reference_length_m


def test_a_wall_makes_the_way_that_is_left_longer():
    wall = house(20, 30, 80, 31)
    judge = judge_of(world_of(("bench", 50, 50), buildings=[wall]), "Find me a bench", success_radius_m=5.0)
    came = came_of([(50, 5), (50, 29)], judge)
    assert came.distance_to_goal_m < 21.0
    assert came.remaining_m > 40.0


def test_an_oracle_success_is_seen_where_a_view_of_a_look_holds_the_thing():
    judge = judge_of(world_of(("bench", 50, 50)), "Find me a bench")
    way = [(50, 20), (50, 40), (50, 60)]
    assert not came_of(way, judge).oracle_seen  # never looked
    assert not came_of(way, judge, looks=[Look(0, (NORTH,))]).oracle_seen  # looked from afar only
    assert came_of(way, judge, looks=[Look(1, (NORTH,))]).oracle_seen
    assert not came_of(way, judge, looks=[Look(1, (SOUTH,))]).oracle_seen  # looked away
    assert came_of(way, judge, looks=[Look(1, (SOUTH, EAST, NORTH))]).oracle_seen
    assert came_of(way, judge, looks=[Look(0, (SOUTH,)), Look(2, (SOUTH,))]).oracle_seen


def test_the_field_of_view_decides_what_is_seen():
    judge = judge_of(world_of(("bench", 50, 50)), "Find me a bench")
    ahead = math.radians(40.0)  # the bench, 1.6 m wide, lies 40° to the left of it
    look = {"looks": [Look(0, (ahead,))]}
    assert came_of([(50, 40)], judge, **look, fov_rad=math.radians(90.0)).oracle_seen
    assert not came_of([(50, 40)], judge, **look, fov_rad=math.radians(60.0)).oracle_seen


def test_any_thing_in_place_may_be_the_one_that_is_seen():
    # The nearest bench is behind, another one ahead.
    judge = judge_of(world_of(("bench", 50, 36), ("bench", 50, 50)), "Find me a bench")
    assert judge.success(50, 40).object_id == 0
    assert came_of([(50, 40)], judge, looks=[Look(0, (NORTH,))]).oracle_seen


def test_what_a_wall_hides_is_not_seen():
    atlas = world_of(("bench", 50, 50), ("bench", 50, 30), buildings=[house(40, 44, 60, 45)])
    judge = judge_of(atlas, "Find me a bench")
    assert judge.success(50, 40).success
    assert not came_of([(50, 40)], judge, looks=[Look(0, (NORTH,))]).oracle_seen
    assert came_of([(50, 40)], judge, looks=[Look(0, (SOUTH,))]).oracle_seen


def test_who_stands_on_a_lawn_has_it_in_view():
    atlas = world_of(("lawn", 50, 50, {"outline": box(40, 40, 60, 60)}))
    judge = judge_of(atlas, "Find me a lawn")
    assert came_of([(50, 50)], judge, looks=[Look(0, (NORTH,))]).oracle_seen
    # From beside it, a part of it is in a view that does not hold its nearest point.
    assert came_of([(38, 42)], judge, looks=[Look(0, (math.radians(20.0),))], fov_rad=1.0).oracle_seen
    assert not came_of([(38, 42)], judge, looks=[Look(0, (SOUTH,))], fov_rad=1.0).oracle_seen


def test_a_look_from_no_point_of_the_track_is_refused():
    judge = judge_of(world_of(("bench", 50, 50)), "Find me a bench")
    with pytest.raises(InputError, match="from point 1"):
        came_of([(50, 40)], judge, looks=[Look(1, (NORTH,))])
    with pytest.raises(InputError, match="fov_rad"):
        came_of([(50, 40)], judge, looks=[Look(0, (NORTH,))], fov_rad=4.0)


def test_what_is_seen_after_a_violation_does_not_count():
    atlas = world_of(("bench", 50, 80), regions=[patch(Ground.GRASS, 20, 30, 80, 50)])
    judge = judge_of(atlas, "Find me a bench, but avoid the grass")
    across = came_of([(50, 10), (50, 70)], judge, looks=[Look(1, (NORTH,))])
    around = came_of([(50, 10), (10, 20), (10, 60), (50, 70)], judge, looks=[Look(3, (NORTH,))])
    assert (across.oracle_seen, across.compliant, score(across).soft_spl) == (False, False, 0.0)
    assert (around.oracle_seen, around.compliant) == (True, True)
    # Level 3 asks for the way, too: round the lawn is nearer to the reference than across it.
    assert 0.0 < across.ndtw < around.ndtw < 1.0
    reference = judge.reference_path((50.0, 10.0))
    assert came_of(reference.tolist(), judge).ndtw == pytest.approx(1.0, abs=1e-6)
    assert came_of([(50, 10), (50, 70)], judge, reference_way=[]).ndtw is None


def test_only_level_3_has_an_ndtw():
    judge = judge_of(world_of(("bench", 50, 50)), "Find me a bench")
    assert came_of([(50, 40)], judge).ndtw is None


def test_a_start_in_place():
    judge = judge_of(world_of(("bench", 50, 50)), "Find me a bench")
    at_once = score(came_of([(50, 40)], judge, computing_s=0.0, travelling_s=0.0))
    assert (at_once.spl, at_once.soft_spl, at_once.casr, at_once.path_length_m) == (1.0, 1.0, 1.0, 0.0)
    left = score(came_of([(50, 40), (50, 10)], judge))
    assert (left.success, left.oracle_success, left.spl, left.soft_spl) == (False, True, 0.0, 0.0)


def test_a_goal_that_cannot_be_reached():
    # Houses all around the bench.
    walls = [house(30, 30, 70, 31), house(30, 69, 70, 70), house(30, 30, 31, 70), house(69, 30, 70, 70)]
    judge = judge_of(world_of(("bench", 50, 50), buildings=walls), "Find me a bench", success_radius_m=10.0)
    lost = score(came_of([(50, 10), (50, 28)], judge))
    assert math.isinf(lost.reference_length_m)
    assert (lost.success, lost.spl, lost.soft_spl) == (False, 0.0, 0.0)
    assert lost.distance_to_goal_m == pytest.approx(21.7)


# What cannot be.


@pytest.mark.parametrize(
    "values",
    [
        {"path_length_m": math.nan},
        {"path_length_m": -1.0},
        {"reference_length_m": math.nan},
        {"remaining_m": -1.0},
        {"computing_s": math.inf},
        {"travelling_s": math.nan},
        {"time_limit_s": 0.0},
        {"distance_to_goal_m": math.nan},
        {"planner_computing_s": 301.0},
        {"level": 0},
        {"compliant": False},
        {"ndtw": 0.5},
        {"level": 3, "ndtw": 1.5},
        {"level": 3, "ndtw": math.nan},
    ],
)
def test_numbers_out_of_range_are_refused(values):
    with pytest.raises(InputError):
        outcome(**values)


# What always holds.

OUTCOMES = st.builds(
    outcome,
    level=st.sampled_from([1, 2, 3, 4]),
    declared=st.booleans(),
    in_place=st.booleans(),
    oracle_success=st.booleans(),
    oracle_seen=st.booleans(),
    path_length_m=st.floats(0, 1e4),
    reference_length_m=st.floats(0, 1e4) | st.just(math.inf),
    remaining_m=st.floats(0, 1e4) | st.just(math.inf),
    computing_s=st.floats(0, 3000),
    travelling_s=st.floats(0, 3000),
    planner_computing_s=st.just(0.0),
    distance_to_goal_m=st.floats(0, 1e4) | st.just(math.inf),
)


@given(OUTCOMES)
def test_a_score_is_bounded_by_success(came):
    got = score(came)
    assert 0.0 <= got.spl <= got.success
    assert got.spl <= got.soft_spl <= 1.0
    assert 0.0 <= got.casr <= got.success
    assert 0.0 <= got.time_factor <= got.planner_time_factor <= 1.0
    assert got.oracle_success >= got.success
    assert got.oracle_success >= got.oracle_seen


@given(OUTCOMES, st.floats(0, 2000))
def test_more_time_never_helps(came, more_s):
    values = {name: getattr(came, name) for name in came.__slots__ if name != "mission_id"}
    later = score(outcome(**{**values, "computing_s": came.computing_s + more_s}))
    assert later.time_factor <= score(came).time_factor
    assert later.casr <= score(came).casr


WAYS = st.lists(st.tuples(st.floats(-50, 50), st.floats(-50, 50)), min_size=1, max_size=6)


@given(WAYS, WAYS)
def test_ndtw_is_a_share_and_1_only_on_the_reference_itself(gone, wanted):
    got = ndtw_of(gone, wanted, threshold_m=15.0)
    assert 0.0 <= got <= 1.0
    assert ndtw_of(wanted, wanted, threshold_m=15.0) == 1.0
