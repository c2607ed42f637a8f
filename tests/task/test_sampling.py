import math

import numpy as np
import pytest

from reasoned_explorer.model import SettingsError, StartError
from reasoned_explorer.task.reading import read_goal
from reasoned_explorer.task.sampling import (
    EDGE_M,
    OutOfRangeError,
    SamplingSettings,
    free_places,
    sample_episodes,
    sample_start,
    settle_for_a_start,
)
from reasoned_explorer.world.taxonomy import Ground
from tests.task.scenes import WALKER, box, house, judge_of, patch, world_of

GRASS = patch(Ground.GRASS, 0, 0, 200, 90)


def town():
    return world_of(
        ("bench", 50, 150),
        ("tree", 52, 150),
        ("bench", 20, 20),
        ("waste_basket", 150, 150),
        ("fountain", 180, 20),
        ("cafe", 110, 120),
        ("playground", 150, 60, {"outline": box(140, 50, 160, 70)}),
        size_m=200,
        regions=[GRASS],
        buildings=[house(100, 120, 130, 140)],
    )


def test_starts_are_free_and_walkable():
    atlas = world_of(regions=[patch(Ground.WATER, 0, 0, 50, 100)], buildings=[house(60, 60, 90, 90)])
    places = free_places(atlas, traveller=WALKER, count=200, seed=1)
    assert places.shape == (200, 2)
    assert set(atlas.ground.at_many(places[:, 0], places[:, 1])) == {Ground.PLAZA}


def test_rare_free_ground_is_found_too():
    atlas = world_of(size_m=400, regions=[patch(Ground.WATER, 0, 0, 400, 400), patch(Ground.PLAZA, 10, 10, 13, 13)])
    places = free_places(atlas, traveller=WALKER, count=5, seed=1)
    assert len(places) == 5
    assert places.max() < 13


def test_unknown_ground_is_taken_where_there_is_no_other():
    assert len(free_places(world_of(ground=Ground.UNKNOWN), traveller=WALKER, count=3, seed=1)) == 3


def test_places_keep_off_the_edge_where_they_can():
    def rim_m(atlas, seed):
        places = free_places(atlas, traveller=WALKER, count=100, seed=seed, edge_m=25.0)
        bounds = atlas.world.bounds
        low, high = (bounds.min_x_m, bounds.min_y_m), (bounds.max_x_m, bounds.max_y_m)
        return min((places - low).min(), (high - places).min())

    assert rim_m(world_of(size_m=200), 1) >= 25.0
    assert 0.0 < rim_m(world_of(size_m=40), 1) < 20.0
    # Known ground at the edge is better than unknown ground inside.
    rim = world_of(size_m=200, ground=Ground.UNKNOWN, regions=[patch(Ground.PLAZA, 0, 0, 5, 200)])
    assert rim_m(rim, 1) < 5.0


@pytest.mark.parametrize("seed", range(12))
def test_a_start_is_not_at_the_edge_of_the_world(seed):
    atlas = world_of(("bench", 100, 100), size_m=200)
    start, _ = sample_start(
        atlas, read_goal("Find me a bench"), WALKER, seed=seed, settings=SamplingSettings(min_m=20, max_m=200)
    )
    bounds = atlas.world.bounds
    assert bounds.min_x_m + EDGE_M <= start.x_m <= bounds.max_x_m - EDGE_M
    assert bounds.min_y_m + EDGE_M <= start.y_m <= bounds.max_y_m - EDGE_M


def test_a_start_is_within_the_range_and_on_allowed_ground():
    atlas, spec = town(), read_goal("Find me a bench, but avoid the grass")
    settings = SamplingSettings(min_m=20, max_m=80)
    start, length_m = sample_start(atlas, spec, WALKER, seed=5, settings=settings)
    assert 20 <= length_m <= 80
    assert atlas.ground.at(start.x_m, start.y_m) is not Ground.GRASS
    assert 0 <= start.heading_rad < 2 * math.pi
    assert judge_of(atlas, spec.text).reference_length_m(start) == pytest.approx(length_m)


def test_the_same_seed_gives_the_same_start():
    atlas, spec = town(), read_goal("Find me a fountain")
    assert sample_start(atlas, spec, WALKER, seed=5) == sample_start(town(), spec, WALKER, seed=5)
    assert sample_start(atlas, spec, WALKER, seed=5) != sample_start(atlas, spec, WALKER, seed=6)


def test_why_there_is_no_start_is_told():
    with pytest.raises(StartError, match="nothing in 'square' satisfies"):
        sample_start(town(), read_goal("Find me a hotel"), WALKER, seed=1)
    with pytest.raises(StartError, match=r"too near, \d+ too far"):
        sample_start(
            town(), read_goal("Find me a fountain"), WALKER, seed=1, settings=SamplingSettings(min_m=900, max_m=999)
        )
    flooded = world_of(("bench", 50, 50), ground=Ground.WATER)
    with pytest.raises(StartError, match="no place to start"):
        sample_start(flooded, read_goal("Find me a bench"), WALKER, seed=1)


def test_where_a_goal_is_everywhere_one_may_settle_for_the_farthest_start():
    atlas = world_of(*[("tree", x, y) for x in range(10, 200, 36) for y in range(10, 200, 36)], size_m=200)
    spec, settings = read_goal("Find me a tree"), SamplingSettings(min_m=60, max_m=400)
    judge = judge_of(atlas, spec.text)
    with pytest.raises(OutOfRangeError, match="60 too near"):
        sample_start(atlas, spec, WALKER, seed=1, settings=settings, judge=judge)
    start, length_m = settle_for_a_start(atlas, spec, WALKER, seed=1, settings=settings, judge=judge)
    assert length_m == pytest.approx(judge.reference_length_m(start))
    others = free_places(atlas, traveller=WALKER, count=60, seed=1, edge_m=EDGE_M)
    assert length_m >= max(judge.reference_length_m((float(x), float(y))) for x, y in others) > 0.0


def test_where_a_goal_is_far_one_may_settle_for_the_nearest_start():
    atlas, spec = town(), read_goal("Find me a fountain")
    settings, judge = SamplingSettings(min_m=1, max_m=2), judge_of(town(), "Find me a fountain")
    start, length_m = settle_for_a_start(atlas, spec, WALKER, seed=3, settings=settings, judge=judge)
    assert length_m == pytest.approx(judge.reference_length_m(start))
    assert 0.0 < length_m < 60.0


def test_there_must_be_something_left_to_look_for():
    atlas = world_of(*[("tree", x, y) for x in range(5, 100, 10) for y in range(5, 100, 10)])
    spec = read_goal("Find me a tree")
    with pytest.raises(StartError, match="name a start"):
        settle_for_a_start(atlas, spec, WALKER, seed=1, settings=SamplingSettings(), judge=judge_of(atlas, spec.text))


def test_episodes_take_levels_in_turn_and_can_be_reached():
    episodes = sample_episodes(town(), levels=(1, 4), count=8, seed=3, traveller=WALKER)
    assert [episode.spec.level for episode in episodes] == [1, 4] * 4
    assert all(30 <= episode.reference_length_m <= 300 for episode in episodes)
    assert len({episode.id for episode in episodes}) == 8


def test_episodes_do_not_depend_on_what_was_asked_before():
    atlas = town()
    few = sample_episodes(atlas, levels=(1,), count=2, seed=3, traveller=WALKER)
    many = sample_episodes(town(), levels=(1,), count=5, seed=3, traveller=WALKER)
    assert many[:2] == few


def test_goals_that_are_everywhere_are_left_out():
    atlas = world_of(
        *[("tree", x, y) for x in range(5, 200, 20) for y in range(5, 200, 20)], ("bench", 100, 100), size_m=200
    )
    settings = SamplingSettings(min_m=5, max_m=300)
    episodes = sample_episodes(atlas, levels=(1,), count=6, seed=3, traveller=WALKER, settings=settings)
    assert {name for episode in episodes for name in episode.spec.class_names} == {"bench"}


def test_a_level_without_goals_is_told():
    with pytest.raises(StartError, match="level 2 has no goal left"):
        sample_episodes(world_of(("hotel", 50, 50)), levels=(2,), count=1, seed=1, traveller=WALKER)


@pytest.mark.parametrize(
    "values", [{"min_m": 0.0}, {"min_m": 50.0, "max_m": 50.0}, {"max_m": math.nan}, {"max_blind_rate": 1.5}]
)
def test_settings_out_of_range_are_refused(values):
    with pytest.raises(SettingsError):
        SamplingSettings(**values)


def test_no_episodes_is_no_request():
    with pytest.raises(SettingsError, match="at least one of each"):
        sample_episodes(town(), count=0, seed=1, traveller=WALKER)


def test_a_real_place_gives_episodes_of_all_levels(osm_folder):
    from reasoned_explorer.world.atlas import Atlas
    from reasoned_explorer.world.opening import open_world

    atlas = Atlas(open_world(str(osm_folder / "uvic-campus.osm.pbf")))
    episodes = sample_episodes(atlas, count=4, seed=1, traveller=WALKER)
    assert [episode.spec.level for episode in episodes] == [1, 2, 3, 4]
    for episode in episodes:
        path = judge_of(atlas, episode.spec.text).reference_path(episode.start)
        assert np.hypot(*np.diff(path, axis=0).T).sum() == pytest.approx(episode.reference_length_m, rel=0.03, abs=1.0)


def test_one_settles_for_the_rim_only_where_nothing_farther_in_is_in_range():
    # Only from the outer half of the world is the way long enough, and few places of the first draw lie there.
    atlas, spec = world_of(("bench", 100, 100), size_m=200), read_goal("Find me a bench")
    judge = judge_of(atlas, spec.text)
    inner = SamplingSettings(min_m=80, max_m=400)
    start, length_m = settle_for_a_start(atlas, spec, WALKER, seed=2, settings=inner, judge=judge)
    assert length_m >= 80
    assert min(start.x_m, start.y_m) >= 25
    assert max(start.x_m, start.y_m) <= 175
    start, length_m = settle_for_a_start(
        atlas, spec, WALKER, seed=2, settings=SamplingSettings(min_m=97, max_m=400), judge=judge
    )
    assert length_m >= 97
