"""Lines, footprints and spots that the generator draws with."""

import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from reasoned_explorer.world.generator.occupancy import Occupancy
from reasoned_explorer.world.generator.park import neighbours
from reasoned_explorer.world.generator.shapes import (
    along,
    along_many,
    blob,
    bow,
    bows,
    footprint,
    placed,
    smooth,
    spread,
    thin,
)

coordinate = st.floats(-50, 50)
heading = st.floats(0, 2 * math.pi)
side = st.floats(0.3, 8.0)


@settings(deadline=None, max_examples=100)
@given(st.lists(st.tuples(coordinate, coordinate), min_size=2, max_size=8, unique=True))
def test_a_smooth_curve_runs_through_its_knots(knots: list[tuple[float, float]]) -> None:
    curve = smooth(np.array(knots))
    gaps = np.hypot(*(np.array(knots)[:, None] - curve[None]).transpose(2, 0, 1)).min(axis=1)
    assert gaps.max() < 1e-6


@settings(deadline=None, max_examples=50)
@given(
    st.sampled_from(["rect", "l", "u", "t", "h"]), st.floats(6, 40), st.floats(6, 40), coordinate, coordinate, heading
)
def test_a_footprint_is_valid_and_its_front_looks_where_it_should(
    kind: str, width: float, depth: float, x: float, y: float, looks: float
) -> None:
    area = placed(footprint(kind, width, depth, 5.0), x, y, looks)
    assert area.is_valid
    assert area.exterior.is_ccw
    front = shapely.Point(x + math.sin(looks) * depth / 2, y + math.cos(looks) * depth / 2)
    if kind in ("rect", "l", "u", "t"):
        assert area.exterior.distance(front) < 1e-6


@settings(deadline=None, max_examples=100)
@given(*[st.tuples(coordinate, coordinate, heading, side, side)] * 2)
def test_spots_are_taken_exactly_where_rectangles_overlap(one: tuple[float, ...], other: tuple[float, ...]) -> None:
    def polygon(x: float, y: float, looks: float, length: float, depth: float) -> shapely.Polygon:
        return placed(footprint("rect", length, depth, 1.0), x, y, looks)

    other = (one[0] + other[0] / 8, one[1] + other[1] / 8, *other[2:])
    taken = Occupancy()
    taken.take(*one)
    overlap = polygon(*one).intersection(polygon(*other)).area
    if overlap > 1e-6:
        assert not taken.free(*other, gap_m=0.0)
    elif polygon(*one).distance(polygon(*other)) > 1e-6:
        assert taken.free(*other, gap_m=0.0)


@settings(deadline=None, max_examples=50)
@given(st.lists(st.tuples(coordinate, coordinate), min_size=1, max_size=40), st.floats(0.5, 20))
def test_thinned_points_keep_apart_and_leave_no_gap(points: list[tuple[float, float]], spacing: float) -> None:
    given_points = np.array(points)
    kept = given_points[thin(given_points, spacing)]
    gaps = np.hypot(*(kept[:, None] - kept[None]).transpose(2, 0, 1))
    assert (gaps[~np.eye(len(kept), dtype=bool)] > spacing).all()
    nearest = np.hypot(*(given_points[:, None] - kept[None]).transpose(2, 0, 1)).min(axis=1)
    assert (nearest <= spacing + 1e-9).all()


def test_points_along_a_bent_line_are_evenly_spaced() -> None:
    line = np.array([(0.0, 0.0), (10.0, 0.0), (10.0, 10.0)])
    at, tangents = along(line, 4.0)
    assert at.tolist() == [[2, 0], [6, 0], [10, 0], [10, 4], [10, 8]]
    assert tangents[-1].tolist() == [0, 1]


@settings(deadline=None, max_examples=50)
@given(
    st.lists(st.lists(st.tuples(coordinate, coordinate), min_size=2, max_size=5), min_size=1, max_size=4),
    st.floats(1.0, 9.0),
    st.floats(0.0, 5.0),
)
def test_many_lines_at_once_are_as_one_after_the_other(
    lines: list[list[tuple[float, float]]], spacing: float, start: float
) -> None:
    arrays = [np.array(line) for line in lines]
    at, tangents, owner = along_many(arrays, spacing, start_m=start, end_m=1.0)
    for index, line in enumerate(arrays):
        own, directions = along(line, spacing, start_m=start, end_m=1.0)
        # Where a point would lie on the very end, rounding decides whether it does.
        assert abs(len(own) - (owner == index).sum()) <= 1
        number = min(len(own), int((owner == index).sum()))
        np.testing.assert_allclose(at[owner == index][:number], own[:number], atol=1e-6)
        assert (np.abs(np.hypot(*tangents[owner == index].T) - 1) < 1e-9).all()
        assert directions.shape == own.shape


def test_many_curves_are_as_one_after_the_other() -> None:
    starts, ends, sags = np.array([(0, 0), (1, 2)]), np.array([(9, 3), (-4, 8)]), np.array([0.1, -0.2])
    for curve, start, end, sag in zip(bows(starts, ends, sags), starts, ends, sags, strict=True):
        np.testing.assert_allclose(curve, bow(start, end, sag))


def test_nothing_may_stand_on_a_strip_that_is_kept_open_but_strips_may_overlap() -> None:
    taken = Occupancy()
    taken.keep_open(0.0, 0.0, 0.0, 2.0, 1.5)
    assert not taken.free(0.5, 0.0, 0.0, 0.5, 0.5)
    assert taken.free(0.0, 2.0, 0.0, 0.5, 0.5)
    assert taken.passable(0.5, 0.0, 0.0, 2.0, 1.5)
    taken.take(0.0, 2.0, 0.0, 0.5, 0.5)
    assert not taken.passable(0.0, 1.5, 0.0, 2.0, 1.5)


def test_a_line_too_short_has_no_points() -> None:
    at, tangents = along(np.array([(0.0, 0.0), (1.0, 0.0)]), 4.0)
    assert at.shape == tangents.shape == (0, 2)


@pytest.mark.parametrize("seed", range(5))
def test_blobs_are_valid_and_points_fill_them(seed: int) -> None:
    rng = np.random.default_rng(seed)
    area = blob(rng, 3.0, 4.0, 20.0)
    assert area.is_valid
    points = spread(rng, area, 3.0)
    assert len(points) == pytest.approx(area.area / 9.0, rel=0.25)
    assert all(area.contains(shapely.points(points)))


def test_paths_join_near_neighbours_only() -> None:
    row = np.array([(0.0, 0.0), (10.0, 0.5), (20.0, 0.0)])
    assert neighbours(row, longest_m=50.0) == [(0, 1), (1, 2)]
    assert neighbours(row, longest_m=5.0) == []
