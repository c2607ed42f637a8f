"""Spots on walls, and what is fixed to them."""

import numpy as np
import pytest

from reasoned_explorer.rendering.footprints import Footprints
from reasoned_explorer.rendering.wall_spots import Finish, Spots, panels, pointed_panels, runs
from reasoned_explorer.world.world import Building
from tests.world.worlds import box

PRINTS = Footprints.of([Building(outer=box(0, 0, 12, 8), height_m=6.0)])
WOOD = Finish(np.array((0.4, 0.3, 0.2)), 3)


def test_spots_lie_on_their_walls_and_look_out() -> None:
    spots = Spots.on(PRINTS, np.array([0, 1]), np.array([3.0, 2.0]))
    np.testing.assert_allclose(spots.places, [(3, 0), (12, 2)])
    np.testing.assert_allclose(spots.out, [(0, -1), (1, 0)])
    moved = spots.moved(aside_m=np.array([1.0, -1.0]), out_m=0.5)
    np.testing.assert_allclose(moved.places, [(4, -0.5), (12.5, 1)])


@pytest.mark.parametrize(("every_m", "count"), [(2.0, 5), (4.9, 2), (100.0, 1)])
def test_spots_are_spread_evenly_clear_of_the_corners(every_m: float, count: int) -> None:
    spots = Spots.spaced(PRINTS, np.array([0]), every_m=every_m, margin_m=1.0)
    assert len(spots.places) == count
    assert spots.places[:, 0].mean() == pytest.approx(6.0)
    assert spots.places[:, 0].min() > 1.0


def test_panels_face_away_from_the_wall_with_their_grain_upright() -> None:
    spots = Spots.on(PRINTS, np.arange(4), np.full(4, 4.0)).moved(out_m=0.1)
    patch = panels(spots, WOOD, wide_m=1.0, low_m=0.5, high_m=2.5)
    normals = np.cross(patch.corners[:, 1] - patch.corners[:, 0], patch.corners[:, 2] - patch.corners[:, 0])
    np.testing.assert_allclose(normals[:, :2] / 2.0, spots.out, atol=1e-12)
    assert np.ptp(patch.uvs[..., 0], axis=1).tolist() == [2.0] * 4
    assert (patch.corners[..., 2].min(), patch.corners[..., 2].max()) == (0.5, 2.5)


def test_pointed_panels_end_in_a_point_above_their_middle() -> None:
    spots = Spots.on(PRINTS, np.array([0]), np.array([6.0]))
    (corners,) = pointed_panels(
        spots, WOOD, wide_m=np.array([1.0]), low_m=np.array([2.0]), high_m=np.array([5.0])
    ).corners
    np.testing.assert_allclose(corners[corners[:, 2].argmax()], (6.0, 0.0, 5.0))
    assert (corners[:, 2] == 5.0).sum() == 1


def test_runs_count_within_each() -> None:
    row, place = runs(np.array([2, 0, 3]))
    assert row.tolist() == [0, 0, 2, 2, 2]
    assert place.tolist() == [0, 1, 0, 1, 2]
