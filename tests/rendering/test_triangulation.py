"""Polygons with holes become triangles that cover them exactly."""

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from reasoned_explorer.rendering import triangulation
from reasoned_explorer.rendering.triangulation import triangles_of

Floats = NDArray[np.float64]

SQUARE = np.array([(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)])


def _areas(triangles: Floats) -> Floats:
    one, other = triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0]
    return (one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]) / 2.0


def _assert_covers(triangles: Floats, polygon: shapely.Polygon) -> None:
    """Areas add up, all are inside: then nothing overlaps and nothing is missing."""
    areas = _areas(triangles)
    assert (areas > 0.0).all()
    assert areas.sum() == pytest.approx(polygon.area, rel=1e-12)
    shapes = shapely.polygons(triangles)
    assert shapely.area(shapely.difference(shapes, polygon)).max() < 1e-9 * max(polygon.area, 1.0)


def _rings(polygon: shapely.Polygon) -> tuple[Floats, list[Floats]]:
    return np.asarray(polygon.exterior.coords)[:-1], [np.asarray(ring.coords)[:-1] for ring in polygon.interiors]


@st.composite
def block_plans(draw: st.DrawFn) -> shapely.Polygon:
    """Buildings on a grid of cells: rectangles put together, with courtyards where they leave some."""
    cells = draw(st.sets(st.tuples(st.integers(0, 6), st.integers(0, 6)), min_size=1, max_size=40))
    shape = shapely.union_all([shapely.box(x, y, x + 1, y + 1) for x, y in sorted(cells)])
    largest = max(shapely.get_parts(shape), key=lambda part: part.area)
    turn = draw(st.sampled_from([0.0, 0.3, 1.1]))
    turned = shapely.affinity.rotate(largest, turn, use_radians=True)
    plan = shapely.set_precision(turned, 0.001)
    return plan if isinstance(plan, shapely.Polygon) else max(shapely.get_parts(plan), key=lambda part: part.area)


@st.composite
def stars(draw: st.DrawFn) -> shapely.Polygon:
    """Spiky outlines with spiky holes about the same middle."""
    count = draw(st.integers(5, 24))
    angles = np.arange(count) * 2.0 * np.pi / count
    around = np.column_stack([np.cos(angles), np.sin(angles)])
    reach = np.array(draw(st.lists(st.floats(12.0, 40.0), min_size=count, max_size=count)))
    holes = []
    for middle in draw(st.lists(st.sampled_from([(-3.0, 0.0), (3.0, 0.0), (0.0, 3.5), (0.0, -3.5)]), unique=True)):
        inner = np.array(draw(st.lists(st.floats(0.3, 1.9), min_size=count, max_size=count)))
        holes.append(np.round(around * inner[:, None] + middle, 3))
    polygon = shapely.Polygon(np.round(around * reach[:, None], 3), holes)
    return polygon if polygon.is_valid else shapely.Polygon(np.round(around * reach[:, None], 3))


@settings(deadline=None, max_examples=150)
@given(block_plans() | stars())
def test_triangles_cover_the_polygon_and_nothing_else(polygon: shapely.Polygon) -> None:
    outer, holes = _rings(polygon)
    _assert_covers(triangles_of(outer, holes), polygon)


@pytest.mark.parametrize("holes", [1, 4, 9, 25])
def test_any_number_of_courtyards(holes: int) -> None:
    across = int(np.sqrt(holes))
    outer = SQUARE * (0.4 * across)
    squares = [SQUARE * 0.2 + (4.0 * i + 1.0, 4.0 * j + 1.0) for i in range(across) for j in range(across)]
    triangles = triangles_of(outer, squares)
    _assert_covers(triangles, shapely.Polygon(outer, squares))
    assert len(triangles) == 4 + 4 * holes + 2 * holes - 2


def test_rings_may_run_either_way() -> None:
    hole = SQUARE * 0.3 + 2.0
    polygon = shapely.Polygon(SQUARE, [hole])
    for outer in (SQUARE, SQUARE[::-1]):
        for inner in (hole, hole[::-1]):
            _assert_covers(triangles_of(outer, [inner]), polygon)


def test_corners_that_shape_nothing_make_no_triangles() -> None:
    messy = np.array([(0, 0), (0, 0), (5, 0), (10, 0), (10, 10), (10, 10), (4, 10), (0, 10), (0, 10), (0, 3)], float)
    assert len(triangles_of(messy)) == 2
    _assert_covers(triangles_of(messy), shapely.Polygon(SQUARE))


@pytest.mark.parametrize(
    "ring", [SQUARE[:0], SQUARE[:1], SQUARE[:2], SQUARE[[0, 1, 0, 1]], SQUARE[[0, 1, 1, 0]] * 1e-5]
)
def test_what_has_no_area_has_no_triangles(ring: Floats) -> None:
    assert triangles_of(ring).shape == (0, 3, 2)


def test_a_ring_that_crosses_itself_still_ends() -> None:
    bow_tie = np.array([(0.0, 0.0), (10.0, 10.0), (10.0, 0.0), (0.0, 7.0)])
    assert len(triangles_of(bow_tie)) <= 2


def test_a_hole_that_touches_the_outline_in_one_corner() -> None:
    hole = np.array([(10.0, 5.0), (6.0, 7.0), (6.0, 3.0)])
    _assert_covers(triangles_of(SQUARE, [hole]), shapely.Polygon(SQUARE, [hole]))


@pytest.mark.parametrize("turns", range(4))
@pytest.mark.parametrize("start", range(4))
def test_a_hole_that_touches_the_outline_corner_to_corner(turns: int, start: int) -> None:
    outer = np.array([(0, 0), (2, 0), (2, 1), (3, 1), (3, 3), (0, 3)], float)
    hole = np.roll(np.array([(1, 1), (2, 1), (2, 2), (1, 2)], float), start, axis=0)
    quarter = np.linalg.matrix_power(np.array([(0.0, -1.0), (1.0, 0.0)]), turns)
    for first in range(6):
        ring = np.roll(outer, first, axis=0) @ quarter
        _assert_covers(triangles_of(ring, [hole @ quarter]), shapely.Polygon(ring, [hole @ quarter]))


def test_places_far_from_the_origin_are_as_exact() -> None:
    far = SQUARE + 250_000.0
    np.testing.assert_allclose(triangles_of(far) - 250_000.0, triangles_of(SQUARE), atol=1e-9)


@settings(deadline=None, max_examples=60)
@given(block_plans() | stars())
def test_little_work_and_much_are_done_alike_one_in_python_and_one_compiled(polygon: shapely.Polygon) -> None:
    outer, holes = _rings(polygon)
    in_python = triangles_of(outer, holes)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(triangulation, "_FEW_CORNERS", -1)
        patch.setattr(triangulation, "_FEW_PAIRS", -1)
        np.testing.assert_array_equal(triangles_of(outer, holes), in_python)
