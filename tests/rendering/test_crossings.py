"""Where walkers cross carriageways, and which of these places have stripes."""

import numpy as np
import pytest

from reasoned_explorer.rendering.crossings import crossings_of
from reasoned_explorer.world.taxonomy import Ground
from reasoned_explorer.world.world import Way
from tests.world.worlds import field

ROAD = Way("residential", Ground.ROAD, np.array([(0.0, 50.0), (100.0, 50.0)]), 8.0)


def walk(x_m: float, *, ground: Ground = Ground.PAVEMENT, lean_m: float = 0.0, width_m: float = 3.0) -> Way:
    return Way("footway", ground, np.array([(x_m - lean_m, 40.0), (x_m + lean_m, 60.0)]), width_m)


def test_a_crossing_knows_road_and_way() -> None:
    found = crossings_of(field(ways=[ROAD, walk(30.0)]))
    np.testing.assert_allclose(found.middles, [(30.0, 50.0)])
    np.testing.assert_allclose(found.along, [(1.0, 0.0)])
    np.testing.assert_allclose(found.walks, [(0.0, 1.0)])
    assert (found.road_m.tolist(), found.walk_m.tolist(), found.marked.tolist()) == ([8.0], [3.0], [True])


@pytest.mark.parametrize(
    "ways",
    [
        [walk(30.0), ROAD],
        [ROAD, walk(30.0, width_m=15.0)],
        [ROAD, Way("footway", Ground.PAVEMENT, np.array([(0.0, 49.0), (100.0, 51.0)]), 2.0)],
        [ROAD, Way("footway", Ground.PAVEMENT, np.array([(30.0, 40.0), (30.0, 60.0)]), 3.0, level=1)],
        [walk(30.0)],
        [ROAD],
    ],
    ids=["road on top", "a street's pavements", "along the road", "a bridge", "no road", "no walk"],
)
def test_what_is_no_crossing(ways: list[Way]) -> None:
    assert len(crossings_of(field(ways=ways)).middles) == 0


def test_paths_and_narrow_roads_are_crossed_without_stripes() -> None:
    lane = Way("residential", Ground.ROAD, np.array([(0.0, 45.0), (100.0, 45.0)]), 3.5)
    drive = Way("service", Ground.ROAD, np.array([(0.0, 55.0), (100.0, 55.0)]), 6.0)
    found = crossings_of(field(ways=[ROAD, lane, drive, walk(30.0), walk(60.0, ground=Ground.PATH)]))
    assert len(found.middles) == 6
    np.testing.assert_allclose(found.middles[found.marked], [(30.0, 50.0)])


def test_two_ways_over_one_crossing_make_one_set_of_stripes() -> None:
    found = crossings_of(field(ways=[ROAD, walk(30.0), walk(31.0, lean_m=1.0), walk(60.0)]))
    assert len(found.middles) == 3
    assert sorted(found.middles[found.marked][:, 0].tolist()) == pytest.approx([30.0, 60.0])


def test_a_crossing_at_a_bend_counts_once() -> None:
    bent = Way("footway", Ground.PAVEMENT, np.array([(30.0, 40.0), (30.0, 50.0), (31.0, 60.0)]), 3.0)
    assert len(crossings_of(field(ways=[ROAD, bent])).middles) == 1
