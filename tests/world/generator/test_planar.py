import numpy as np
import pytest
import shapely
from shapely import LineString, Polygon

from reasoned_explorer.world.generator import planar
from reasoned_explorer.world.generator.shapes import inner_circle

SQUARE = Polygon([(0, 0), (10, 0), (10, 10), (0, 10)])


def _corners_are_on_the_grid(shape: shapely.Geometry) -> bool:
    steps = shapely.get_coordinates(shape) / planar.GRID_M
    return bool((steps == np.round(steps)).all())


def test_every_corner_of_what_is_made_lies_on_the_grid() -> None:
    ring = planar.buffer(shapely.points(1 / 3, 1 / 7), 2.0)
    assert _corners_are_on_the_grid(ring)
    assert _corners_are_on_the_grid(planar.difference(SQUARE, ring))
    assert _corners_are_on_the_grid(planar.intersection(SQUARE, Polygon([(-1, 0.3), (5.1, 11.7), (9.9, -3.3)])))


def test_last_digits_and_where_a_ring_begins_make_no_difference() -> None:
    corners = np.array([(0.1, 0.2), (9.7, 0.4), (8.3, 7.9)])
    nearly = np.roll(corners * (1.0 + 1e-15), 1, axis=0)
    assert planar.union_all([Polygon(corners)]).wkb == planar.union_all([Polygon(nearly)]).wkb


def test_pieces_of_a_line_keep_its_order_and_its_direction() -> None:
    two_fields = shapely.union_all([shapely.box(6, -1, 9, 1), shapely.box(1, -1, 4, 1)])
    line = np.array([(10.0, 0.0), (0.0, 0.0)])
    assert [piece.tolist() for piece in planar.lines_within(line, two_fields)] == [[[9, 0], [6, 0]], [[4, 0], [1, 0]]]


def test_a_loop_is_not_cut_where_it_happens_to_begin() -> None:
    loop = np.array([(5.0, 5.0), (15.0, 5.0), (15.0, 8.0), (5.0, 8.0), (5.0, 5.0)])
    (piece,) = planar.lines_within(loop, SQUARE)
    assert piece.tolist() == [[10, 8], [5, 8], [5, 5], [10, 5]]


def test_what_is_left_of_a_line_that_lies_outside_is_nothing() -> None:
    assert planar.lines_within(np.array([(20.0, 0.0), (30.0, 0.0)]), SQUARE) == []


@pytest.mark.parametrize(
    ("area", "radius_m"),
    [
        (SQUARE, 5.0),
        (shapely.box(0, 0, 100, 8), 4.0),
        (shapely.points(3, 4).buffer(20.0), 20.0),
        (shapely.union_all([shapely.box(0, 0, 60, 6), shapely.box(20, 0, 44, 24)]), 12.0),
        (shapely.box(0, 0, 30, 30).difference(shapely.box(10, 10, 20, 20)), 5.86),
    ],
)
def test_the_inner_circle_is_the_largest_one_up_to_a_metre(area: Polygon, radius_m: float) -> None:
    x_m, y_m, found_m = inner_circle(area)
    assert radius_m - 1.0 <= found_m <= radius_m + 0.01
    assert area.buffer(1e-3).contains(shapely.points(x_m, y_m).buffer(found_m * 0.999))


def test_the_inner_circle_of_a_sliver_has_hardly_a_radius() -> None:
    assert inner_circle(Polygon([(0, 0), (50, 0.1), (100, 0)]))[2] < 0.1


def test_shapes_of_an_array_come_back_as_an_array() -> None:
    wide = planar.buffer(np.array([LineString([(0, 0), (1, 1)]), SQUARE], dtype=object), 1.0)
    assert wide.shape == (2,)
