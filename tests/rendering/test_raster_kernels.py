"""Triangles that share edges cover every sample exactly once."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.rendering.raster_kernels import fill_triangle
from reasoned_explorer.rendering.room import new_canvas

SIDE = 24
#: On sample centres, between them and anywhere: ties are what goes wrong.
coordinates = st.one_of(st.integers(-4, SIDE + 4).map(lambda n: n + 0.5), st.floats(-20.0, SIDE + 20.0))
depths = st.floats(0.2, 50.0)


def covered(points: np.ndarray, depth: np.ndarray, triangle: tuple[int, int, int]) -> np.ndarray:
    """Which samples a triangle covers, drawn by itself, whichever way round it is."""
    found = np.zeros((SIDE, SIDE), bool)
    corners = np.column_stack([points * depth[:, None], depth, points])
    for a, b, c in (triangle, triangle[::-1]):
        canvas = new_canvas(SIDE, SIDE)
        canvas.nearness[:] = 0.0
        canvas.owners[:] = -1
        fill_triangle(corners, a, b, c, 5, 0, canvas.nearness, canvas.owners, canvas.triangles)
        assert not (found & (canvas.owners == 5)).any()
        found |= canvas.owners == 5
    return found


def winding(points: np.ndarray, triangle: tuple[int, int, int]) -> float:
    (ax, ay), (bx, by), (cx, cy) = points[list(triangle)]
    return float((bx - ax) * (cy - ay) - (cx - ax) * (by - ay))


@given(st.lists(st.tuples(coordinates, coordinates), min_size=4, max_size=4), st.lists(depths, min_size=4, max_size=4))
def test_two_triangles_on_either_side_of_an_edge_share_no_sample(points, distances) -> None:
    points, depth = np.array(points), np.array(distances)
    one, other = (0, 1, 2), (1, 0, 3)
    if winding(points, one) * winding(points, other) > 0.0:  # they lie on opposite sides of the edge 0-1
        assert not (covered(points, depth, one) & covered(points, depth, other)).any()


@given(coordinates, coordinates, st.lists(depths, min_size=5, max_size=5))
def test_a_fan_over_the_picture_leaves_no_hole(x, y, distances) -> None:
    x, y = min(max(x, 0.0), float(SIDE)), min(max(y, 0.0), float(SIDE))
    far = 3.0 * SIDE
    points = np.array([(x, y), (-far, -far), (far, -far), (far, far), (-far, far)])
    total = sum(covered(points, np.array(distances), (0, k, k % 4 + 1)).astype(int) for k in range(1, 5))
    # Along edges it is exact; a sample that a corner hits to the last digit may be anybody's (`fill_triangle`).
    rows, columns = np.mgrid[:SIDE, :SIDE] + 0.5
    at_corner = np.hypot(columns - x, rows - y) < 1e-9
    assert (total[~at_corner] == 1).all()


@given(st.floats(-3.0, 3.0), st.floats(0.3, 5.0))
def test_a_floor_that_passes_below_the_eye_is_whole(x, height) -> None:
    # Four corners around the eye, two of them behind it.
    ends = np.array([(-400.0, -20.0), (400.0, -20.0), (400.0, 60.0), (-400.0, 60.0)])
    homogeneous = np.column_stack([(ends[:, 0] + x) * SIDE / 2, np.full(4, height) * SIDE / 2, ends[:, 1]])
    homogeneous[:, :2] += SIDE / 2 * homogeneous[:, 2:]
    corners = np.column_stack([homogeneous, homogeneous[:, :2] / homogeneous[:, 2:]])
    hits = np.zeros((SIDE, SIDE), int)
    for triangle in ((0, 1, 2), (0, 2, 3)):
        for a, b, c in (triangle, triangle[::-1]):
            canvas = new_canvas(SIDE, SIDE)
            canvas.nearness[:] = 0.0
            canvas.owners[:] = -1
            fill_triangle(corners, a, b, c, 5, 0, canvas.nearness, canvas.owners, canvas.triangles)
            hits += canvas.owners == 5
    rows = np.arange(SIDE) + 0.5 - SIDE / 2
    depth = np.where(rows > 0, height * SIDE / 2 / np.maximum(rows, 1e-9), np.inf)
    below = (depth < 59.9) & (depth > 0.06)
    assert (hits[below] == 1).all()
    assert (hits[depth > 60.1] == 0).all()
