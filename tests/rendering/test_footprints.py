"""Footprints as flat arrays: tidy rings, edges that know their outside, moves inwards that do not fold."""

import numpy as np
import pytest
import shapely

from reasoned_explorer.rendering.footprints import Footprints
from reasoned_explorer.world.world import Building
from tests.world.worlds import box

HOUSE = Building(outer=box(0, 0, 12, 8), height_m=6.0)
BLOCK = Building(outer=box(100, 0, 140, 30)[::-1], holes=(box(110, 10, 130, 20),), height_m=15.0)
L_SHAPE = np.array([(0, 0), (20, 0), (20, 8), (8, 8), (8, 20), (0, 20)], float)


def test_areas_leave_courtyards_out() -> None:
    prints = Footprints.of([HOUSE, BLOCK])
    np.testing.assert_allclose(prints.areas, [96.0, 1200.0 - 200.0])
    assert prints.sizes.tolist() == [4, 8]
    assert prints.in_court.tolist() == [False] * 8 + [True] * 4


def test_every_edge_has_its_building_on_the_left() -> None:
    prints = Footprints.of([HOUSE, BLOCK])
    plans = [shapely.Polygon(one.outer, one.holes) for one in (HOUSE, BLOCK)]
    for edge, owner in enumerate(prints.owners):
        middle = (prints.corners[edge] + prints.corners[prints.after[edge]]) / 2.0
        assert not plans[owner].contains(shapely.Point(middle + 0.1 * prints.outwards[edge]))
        assert plans[owner].contains(shapely.Point(middle - 0.1 * prints.outwards[edge]))
    assert (prints.after[prints.before] == np.arange(12)).all()


def test_what_shapes_nothing_goes() -> None:
    messy = np.array([(0, 0), (0, 0), (6, 0.005), (12, 0), (12.004, 0.004), (12, 8), (0, 8), (0, 3)], float)
    prints = Footprints.of([Building(outer=messy, height_m=6.0)])
    np.testing.assert_allclose(prints.corners, [(0, 0), (12, 0), (12, 8), (0, 8)], atol=0.01)


@pytest.mark.parametrize("outer", [box(0, 0, 0, 0), box(0, 0, 9, 0), box(0, 0, 0.3, 0.3), np.empty((0, 2))])
def test_a_footprint_without_area_has_no_corners_and_harms_no_neighbour(outer: np.ndarray) -> None:
    lost = Building(outer=outer, holes=(box(1, 1, 5, 5),), height_m=6.0)
    prints = Footprints.of([lost, HOUSE, lost])
    assert prints.sizes.tolist() == [0, 4, 0]
    np.testing.assert_allclose(prints.areas, [0.0, 96.0, 0.0])


def test_edges_move_in_evenly() -> None:
    prints = Footprints.of([HOUSE, BLOCK])
    moved = prints.inset(np.array([1.0, 2.0]))
    np.testing.assert_allclose(moved[:4], box(1, 1, 11, 7))
    areas = np.bincount(prints.triangle_owners, weights=prints.triangle_areas(moved))
    np.testing.assert_allclose(areas, [60.0, 36.0 * 26.0 - 24.0 * 14.0])


def test_no_roof_folds_over_itself() -> None:
    prints = Footprints.of([HOUSE, Building(outer=L_SHAPE, height_m=6.0), BLOCK])
    # The block's edges would last for 15 m, but its walls meet after 5 m.
    np.testing.assert_allclose(prints.deepest, [4.0, 4.0, 15.0])
    depth = prints.depth_within(np.full(3, 30.0))
    assert (depth > [3.0, 3.0, 3.0]).all()
    assert (depth < [4.0, 4.0, 5.0]).all()
    assert prints.triangle_areas(prints.inset(depth)).min() > -0.05


def test_rectangles_are_known_even_when_a_little_askew() -> None:
    askew = np.array([(0, 0), (12, 1), (11.5, 8.6), (-0.4, 8)], float)
    kite = np.array([(0, 0), (12, 6), (24, 0), (12, -2)], float)
    buildings = [HOUSE, BLOCK, *(Building(outer=ring, height_m=6.0) for ring in (askew, kite, L_SHAPE))]
    assert Footprints.of(buildings).four_square.tolist() == [True, False, True, False, False]
