"""What ground is where, checked against shapely."""

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from reasoned_explorer.model import WorldError
from reasoned_explorer.world.raster import GroundRaster
from reasoned_explorer.world.taxonomy import Ground
from reasoned_explorer.world.world import Bounds, Region, Way, World
from tests.world.worlds import box, courtyard, field

coordinate = st.integers(-1200, 4200).map(lambda hundredths: hundredths / 100.0)
point = st.tuples(coordinate, coordinate)


def world_of(regions=(), ways=(), size_m=30.0):
    return World("test", Bounds(0.0, 0.0, size_m, size_m), tuple(regions), tuple(ways), (), ())


def centres(raster):
    rows, cols = raster.codes.shape
    x = raster.min_x_m + (np.arange(cols) + 0.5) * raster.cell_m
    y = raster.min_y_m + (np.arange(rows) + 0.5) * raster.cell_m
    return np.meshgrid(x, y)


@pytest.mark.parametrize(
    ("x_m", "y_m", "ground"),
    [
        (2.0, 10.0, Ground.UNKNOWN),
        (50.0, 10.0, Ground.GRASS),
        (2.0, 35.0, Ground.ROAD),
        (50.0, 38.9, Ground.ROAD),
        (50.0, 39.1, Ground.PLAZA),
        (50.0, 45.0, Ground.PAVEMENT),
        (80.0, 60.0, Ground.WATER),
        (12.0, 60.0, Ground.BUILDING),
        (35.0, 60.0, Ground.PLAZA),  # the court of the north house
        (85.0, 15.0, Ground.GRASS),  # under the roof
        (100.0, 20.0, Ground.GRASS),  # the border belongs to the world
        (100.1, 20.0, Ground.UNKNOWN),
        (float("nan"), 20.0, Ground.UNKNOWN),
    ],
)
def test_courtyard(x_m, y_m, ground):
    raster = GroundRaster.of(courtyard())
    assert raster.at(x_m, y_m) is ground
    assert raster.at_many([x_m], [y_m]).tolist() == [ground]


def test_shares():
    raster = GroundRaster.of(courtyard())
    assert raster.share(Ground.ROAD) == pytest.approx(0.1)
    assert raster.share(Ground.WATER) == pytest.approx(400 / 8000)
    assert raster.share(Ground.BUILDING) == pytest.approx((1000 - 200 + 300) / 8000)
    assert sum(raster.shares.values()) == pytest.approx(1.0)
    assert raster.unknown_share == pytest.approx(raster.share(Ground.UNKNOWN) / (1 - raster.share(Ground.BUILDING)))


def test_rows_run_from_south_to_north():
    raster = GroundRaster.of(field(regions=[Region(Ground.SAND, box(0.0, 90.0, 10.0, 100.0))]))
    assert raster.codes[-1, 0] == Ground.SAND
    assert raster.codes[0, 0] == raster.codes[-1, -1] == Ground.GRASS


def test_later_lies_on_earlier_and_bridges_make_no_ground():
    square, line = box(5.0, 5.0, 25.0, 25.0), np.asarray([(0.0, 15.0), (30.0, 15.0)])
    regions = [Region(Ground.GRASS, square), Region(Ground.SAND, square)]
    ways = [
        Way("a", Ground.ROAD, line, 4.0),
        Way("b", Ground.PATH, line, 2.0),
        Way("c", Ground.STEPS, line, 2.0, level=1),
    ]
    raster = GroundRaster.of(world_of(regions, ways))
    assert [raster.at(10.0, y) for y in (10.0, 13.5, 15.0)] == [Ground.SAND, Ground.ROAD, Ground.PATH]


@settings(deadline=None, max_examples=100)
@given(outer=st.lists(point, min_size=3, max_size=12), hole=st.lists(point, min_size=3, max_size=6))
def test_polygons_as_shapely_sees_them(outer, hole):
    raster = GroundRaster.of(world_of([Region(Ground.WATER, np.asarray(outer), (np.asarray(hole),))]), cell_m=1.0)
    xs, ys = centres(raster)
    inside = np.zeros(xs.shape, int)
    borders = []
    for ring in (outer, hole):
        # Even-odd, by triangles against a fixed point: needs no valid polygon.
        previous = ring[-1]
        for vertex in ring:
            inside += (shapely.contains_xy(shapely.Polygon([(-50.0, -60.0), previous, vertex]), xs, ys)).astype(int)
            previous = vertex
            borders.append(shapely.LineString([(-50.0, -60.0), vertex]))
        borders.append(shapely.LinearRing(ring))
    # Centres on a border may fall either way.
    clear = shapely.distance(shapely.union_all(shapely.GeometryCollection(borders)), shapely.points(xs, ys)) > 1e-6
    painted = raster.codes == Ground.WATER
    np.testing.assert_array_equal(painted[clear], (inside % 2 == 1)[clear])


@settings(deadline=None, max_examples=100)
@given(line=st.lists(point, min_size=2, max_size=6), width_m=st.floats(0.2, 15.0))
def test_ways_are_buffered_lines(line, width_m):
    raster = GroundRaster.of(world_of(ways=[Way("path", Ground.PATH, np.asarray(line), width_m)]))
    distance = shapely.distance(shapely.LineString(line), shapely.points(*centres(raster)))
    painted = raster.codes == Ground.PATH
    assert painted[distance < width_m / 2 - 1e-6].all()
    assert not painted[distance > width_m / 2 + 1e-6].any()


def test_neighbours_leave_no_gap():
    shared = [(3.3, 0.0), (7.7, 9.1), (5.25, 20.25), (11.0, 30.0)]
    west, east = [(0.0, 0.0), *shared, (0.0, 30.0)], [(30.0, 0.0), *shared, (30.0, 30.0)]
    raster = GroundRaster.of(world_of([Region(Ground.SAND, np.asarray(west)), Region(Ground.WOOD, np.asarray(east))]))
    assert raster.unknown_share == 0.0


@pytest.mark.parametrize("cell_m", [0.0, -1.0, float("nan"), 1e-6])
def test_bad_cells_are_refused(cell_m):
    with pytest.raises(WorldError, match="ground raster"):
        GroundRaster.of(courtyard(), cell_m=cell_m)
