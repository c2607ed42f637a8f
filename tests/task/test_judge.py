import math

import numpy as np
import pytest

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import InputError, SettingsError, TrackPoint
from reasoned_explorer.task.judge import Judge
from reasoned_explorer.task.reading import read_goal
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.generator import generate_world
from reasoned_explorer.world.geodesic import Traveller
from reasoned_explorer.world.taxonomy import Ground
from tests.task.scenes import box, house, judge_of, patch, world_of


def track(*points):
    return [TrackPoint(float(i), x, y, 1.0, 0.0) for i, (x, y) in enumerate(points)]


def test_success_is_within_the_radius_of_the_footprint():
    judge = judge_of(world_of(("bench", 50, 50)), "Find me a bench")
    assert judge.success(50, 65.2).success  # 14.9 m from the bench's side
    assert not judge.success(50, 65.4).success


def test_success_is_told_at_all_radii():
    report = judge_of(world_of(("bench", 50, 50)), "Find me a bench").success(50, 58)
    assert report.at_radius == ((5.0, False), (10.0, True), (15.0, True), (20.0, True))
    assert (report.object_id, report.grade) == (0, 2)
    assert report.distance_m == pytest.approx(7.7)


def test_a_wall_hides():
    wall = house(40, 54, 60, 56)
    judge = judge_of(world_of(("bench", 50, 50), buildings=[wall]), "Find me a bench")
    behind = judge.success(50, 60)
    assert not behind.success
    assert behind.nearest_m == pytest.approx(9.7)
    assert math.isinf(behind.distance_m)
    assert judge.success(50, 42).success


def test_over_a_low_wall_one_sees_from_higher_up():
    low = house(40, 54, 60, 56)
    low = type(low)(low.outer, height_m=1.5)
    judge = judge_of(world_of(("bench", 50, 50), buildings=[low]), "Find me a bench")
    assert not judge.success(50, 60, 1.0).success
    assert judge.success(50, 60, 8.0).success


def test_what_is_hidden_does_not_hide_what_is_behind_one_in_the_open():
    atlas = world_of(("bench", 50, 50), ("bench", 50, 72), buildings=[house(40, 54, 60, 56)])
    assert judge_of(atlas, "Find me a bench").success(50, 60).object_id == 1


def test_a_place_is_seen_from_before_its_front():
    atlas = world_of(("cafe", 50, 40), buildings=[house(40, 40, 60, 60)])
    judge = judge_of(atlas, "Find me a cafe")
    assert judge.success(50, 30).success
    assert not judge_of(atlas, "Find me a cafe", success_radius_m=30).success(50, 62).success


def test_a_lawn_counts_from_its_rim():
    atlas = world_of(("lawn", 25, 25, {"outline": box(10, 10, 40, 40)}))
    judge = judge_of(atlas, "Find me a lawn")
    assert judge.success(54, 25).success
    assert not judge.success(56, 25).success
    assert judge.success(25, 25).distance_m == 0.0


def test_nothing_satisfies_in_an_empty_world():
    judge = judge_of(world_of(), "Find me a bench")
    assert judge.satisfying == ()
    assert not judge.success(50, 50).success
    assert math.isinf(judge.reference_length_m((50, 50)))
    assert judge.reference_path((50, 50)) is None
    assert judge.blind_success_rate([(50, 50)]) == 0.0


def test_the_reference_way_ends_at_the_edge_of_the_success_region():
    judge = judge_of(world_of(("bench", 50, 50)), "Find me a bench")
    # 40 m to the bench's side (0.3 m from its middle) less the radius of 15 m, to the metre of a cell.
    assert judge.reference_length_m((50, 9.7)) == pytest.approx(25.0, abs=1.0)
    path = judge.reference_path(Pose(50, 9.7))
    assert np.hypot(*np.diff(path, axis=0).T).sum() == pytest.approx(25.0, abs=1.0)
    assert judge.success(*path[-1]).success


def test_at_the_goal_there_is_no_way_to_go():
    judge = judge_of(world_of(("bench", 50, 50)), "Find me a bench")
    assert judge.reference_length_m((50, 45)) == 0.0
    assert judge.reference_path((50, 45)).tolist() == [[50, 45], [50, 45]]


def test_the_reference_way_goes_round_walls_until_it_sees():
    wall = house(20, 60, 80, 62)
    atlas = world_of(("bench", 50, 58), buildings=[wall])
    length_m = judge_of(atlas, "Find me a bench").reference_length_m((50, 70))
    # It has to pass an end of the wall, 30 m to the side.
    assert length_m > 25.0


def test_a_limit_on_the_reference_way_does_not_change_later_answers():
    judge = judge_of(world_of(("bench", 50, 50)), "Find me a bench")
    assert math.isinf(judge.reference_length_m((50, 9.7), max_m=10.0))
    assert judge.reference_length_m((50, 9.7)) == pytest.approx(25.0, abs=1.0)
    assert math.isinf(judge.reference_length_m((50, 9.7), max_m=10.0))


def test_an_island_cannot_be_reached_on_foot_but_in_flight():
    moat = [patch(Ground.WATER, 20, 20, 80, 80), patch(Ground.PLAZA, 45, 45, 55, 55)]
    atlas = world_of(("bench", 50, 50), regions=moat, size_m=100)
    walker = judge_of(atlas, "Find me a bench")
    assert math.isinf(walker.reference_length_m((5, 5)))
    flyer = type(walker)(atlas, walker.spec, traveller=Traveller(flies=True, radius_m=0.3))
    assert flyer.reference_length_m((5, 5)) == pytest.approx(math.hypot(45, 45) - 15.0, abs=2.0)


def test_the_reference_way_is_compliant():
    # A bench beyond grass that reaches from side to side but for a paved way along the east.
    grass = [patch(Ground.GRASS, 0, 40, 92, 60)]
    atlas = world_of(("bench", 10, 90), regions=grass)
    free = judge_of(atlas, "Find me a bench").reference_length_m((10, 10))
    compliant = judge_of(atlas, "Find me a bench, but avoid the grass")
    assert free == pytest.approx(80 - 15.3, abs=1.0)
    assert compliant.reference_length_m((10, 10)) > 150
    report = compliant.review(track(*compliant.reference_path((10, 10))))
    assert report.success
    assert report.compliance.compliant
    straight = compliant.review(track((10, 10), (10, 80)))
    assert straight.end.success
    assert not straight.success
    assert not straight.success_at(15.0)


def test_who_starts_on_shunned_ground_leaves_it_first():
    atlas = world_of(("bench", 90, 90), regions=[patch(Ground.GRASS, 0, 0, 30, 30)])
    judge = judge_of(atlas, "Find me a bench, but avoid the grass")
    length_m = judge.reference_length_m((15, 15))
    assert length_m == pytest.approx(math.hypot(75, 75) - 15.0, rel=0.1)
    path = judge.reference_path((15, 15))
    assert np.hypot(*np.diff(path, axis=0).T).sum() == pytest.approx(length_m, abs=1.0)
    assert judge.review(track(*path)).success


def test_oracle_success_is_at_any_moment_of_the_track():
    judge = judge_of(world_of(("bench", 50, 50)), "Find me a bench")
    report = judge.review(track((50, 10), (50, 90)))
    assert report.oracle_success
    assert not report.success
    assert report.oracle_at_m == pytest.approx(25.0, abs=1.0)
    assert report.length_m == pytest.approx(80.0)


def test_oracle_success_after_a_violation_does_not_count():
    atlas = world_of(("bench", 90, 50), regions=[patch(Ground.GRASS, 20, 0, 60, 100)])
    judge = judge_of(atlas, "Find me a bench, but avoid the grass")
    assert not judge.review(track((5, 50), (88, 50))).oracle_success


def test_blind_success_is_a_share():
    judge = judge_of(world_of(("bench", 50, 50)), "Find me a bench")
    assert judge.blind_success_rate([(50, 45), (5, 5), (95, 95), (50, 55)]) == 0.5
    assert judge.blind_success_rate([]) == 0.0


@pytest.mark.parametrize(
    "options", [{"success_radius_m": math.nan}, {"success_radius_m": 0.0}, {"camera_height_m": -1}]
)
def test_settings_out_of_range_are_refused(options):
    with pytest.raises(SettingsError):
        judge_of(world_of(), "Find me a bench", **options)


def test_numbers_that_are_none_are_refused():
    judge = judge_of(world_of(("bench", 50, 50)), "Find me a bench")
    with pytest.raises(InputError, match="x_m is nan"):
        judge.success(math.nan, 1.0)
    with pytest.raises(InputError, match="y_m is inf"):
        judge.reference_length_m((1.0, math.inf))
    with pytest.raises(InputError, match="finite metres"):
        judge.review(track((0, 0), (math.nan, 1)))
    with pytest.raises(InputError, match="empty"):
        judge.review([])


@pytest.mark.parametrize("sentence", ["Find me a bench, but avoid the grass", "Find me a bench, but stay on the path"])
def test_every_reference_way_complies(sentence):
    stripes = [patch(Ground.GRASS, 0, y, 100 - 20 * (y % 3), y + 9) for y in range(10, 90, 20)]
    paths = [patch(Ground.PATH, x, 0, x + 2.3, 100) for x in (7.2, 55.1)] + [patch(Ground.PATH, 0, 50, 100, 51.4)]
    atlas = world_of(("bench", 80, 92), regions=[*stripes, *paths])
    judge = judge_of(atlas, sentence)
    for x in (8, 30, 56, 90):
        way = judge.reference_path((x, 50.5))
        report = judge.review(track(*way))
        assert report.success, (x, report)


@pytest.mark.parametrize("goal", ["Find me a bench", "Find me a lawn", "Find me a cafe", "Find me a fountain"])
def test_the_picture_of_success_says_what_the_judge_says_at_each_place(goal: str) -> None:
    atlas = Atlas(generate_world("plaza", seed=4, size_m=160))
    judge = Judge(atlas, read_goal(goal), traveller=Traveller(flies=True, radius_m=0.3, collides=True))
    mask, grid = judge.success_mask(), atlas.geodesics.grid
    for row in range(0, grid.rows, 3):
        for col in range(0, grid.cols, 3):
            at = grid.min_x_m + (col + 0.5) * grid.cell_m, grid.min_y_m + (row + 0.5) * grid.cell_m
            assert mask[row, col] == judge.success(*at).success, at
