"""Stretches along lines, and the places where roads meet."""

import numpy as np
import pytest

from reasoned_explorer.rendering.crossings import crossings_of
from reasoned_explorer.rendering.road_lines import Clearings, Lines, clearings_of
from reasoned_explorer.world.taxonomy import Ground
from reasoned_explorer.world.world import Way
from tests.world.worlds import field


def road(*points: tuple[float, float], width_m: float = 6.0) -> Way:
    return Way("residential", Ground.ROAD, np.array(points, float), width_m)


def meetings(*roads: Way) -> list[tuple[float, float]]:
    return [(x, y) for x, y in clearings_of(roads, crossings_of(field(ways=roads))).middles.tolist()]


def test_points_are_found_by_their_distance_along_a_line() -> None:
    lines = Lines([np.array([(0, 0), (3, 0), (3, 4)], float), np.array([(10, 0), (10, 2)], float)])
    assert lines.lengths.tolist() == [7.0, 2.0]
    found = lines.at(np.array([0, 0, 1, 1, 0]), np.array([2.0, 5.0, 1.0, 99.0, -1.0]))
    np.testing.assert_allclose(found, [(2, 0), (3, 2), (10, 1), (10, 2), (0, 0)])


def test_stretches_are_evenly_spaced_and_centred() -> None:
    lines = Lines([np.array([(0, 0), (20, 0)], float), np.array([(0, 5), (2, 5)], float)])
    which, begin, end = lines.stretches(np.array([0, 1]), every_m=6.0, long_m=3.0)
    assert which.tolist() == [0, 0, 0]
    np.testing.assert_allclose(begin[:, 0], [2.5, 8.5, 14.5])
    np.testing.assert_allclose(end - begin, np.tile((3.0, 0.0), (3, 1)))


def test_no_lines_have_no_stretches() -> None:
    which, begin, _ = Lines([]).stretches(np.empty(0, np.int64), every_m=1.0, long_m=1.0)
    assert len(which) == 0
    assert begin.shape == (0, 2)


def test_roads_meet_where_three_arms_or_more_lead_away() -> None:
    street = road((0, 50), (100, 50))
    assert meetings(street, road((50, 0), (50, 100))) == [(50.0, 50.0)]
    assert meetings(street, road((50, 50), (50, 100))) == [(50.0, 50.0)]
    assert meetings(road((0, 50), (50, 50)), road((50, 50), (100, 50)), road((50, 50), (50, 99))) == [(50.0, 50.0)]


def test_a_street_in_two_pieces_a_bend_and_a_lone_street_meet_nothing() -> None:
    assert meetings(road((0, 50), (50, 50)), road((50, 50), (100, 50))) == []
    assert meetings(road((0, 50), (50, 50)), road((50, 50), (50, 100))) == []
    assert meetings(road((0, 50), (100, 50))) == []
    assert meetings() == []


def test_clearings_keep_their_distance() -> None:
    clearings = Clearings(np.array([(0.0, 0.0), (50.0, 0.0)]), np.array([3.0, 10.0]))
    points = np.array([(4.5, 0.0), (5.5, 0.0), (39.0, 0.0), (37.0, 0.0), (25.0, 0.0)])
    assert clearings.clear_of(points, 2.0).tolist() == [False, True, False, True, True]
    assert clearings.clear_of(np.empty((0, 2)), 2.0).shape == (0,)


@pytest.mark.parametrize("width_m", [4.0, 12.0])
def test_wide_roads_clear_more(width_m: float) -> None:
    found = clearings_of([road((0, 50), (100, 50), width_m=width_m), road((50, 0), (50, 100), width_m=4.0)],
                         crossings_of(field()))  # fmt: skip
    assert found.radii.tolist() == [width_m / 2.0 + 0.5]
