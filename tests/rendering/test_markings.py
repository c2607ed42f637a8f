"""What is painted on the ground lies where it belongs, flat, face up and in squares."""

import numpy as np
import pytest
import shapely
from numpy.typing import NDArray

from reasoned_explorer.rendering.crossings import crossings_of
from reasoned_explorer.rendering.ground_map import ground_map_of
from reasoned_explorer.rendering.markings import (
    CHUNK_M,
    chunked,
    lane_lines,
    lying_on,
    markings_of,
    parking_bays,
    pitches,
    rails,
    stairs,
    stop_lines,
    zebras,
)
from reasoned_explorer.rendering.material import Material
from reasoned_explorer.rendering.patches import Patch
from reasoned_explorer.rendering.road_lines import clearings_of
from reasoned_explorer.world.generator import generate_world
from reasoned_explorer.world.taxonomy import Ground
from reasoned_explorer.world.world import Region, Way, World
from tests.world.worlds import box, field

Floats = NDArray[np.float64]


def road(*points: tuple[float, float], kind: str = "residential", width_m: float = 8.0) -> Way:
    return Way(kind, Ground.ROAD, np.array(points), width_m)


def walk(x_m: float) -> Way:
    return Way("footway", Ground.PAVEMENT, np.array([(x_m, 40.0), (x_m, 60.0)]), 3.0)


def middles_of(patches: list[Patch]) -> Floats:
    return np.concatenate([np.empty((0, 2)), *(patch.corners[..., :2].mean(axis=1) for patch in patches)])


def lanes_of(world: World) -> Floats:
    roads = [way for way in world.ways if way.ground == Ground.ROAD]
    return middles_of(lane_lines(roads, clearings_of(roads, crossings_of(world))))


def test_dashes_run_along_the_middle_of_a_wide_road_only() -> None:
    dashes = lanes_of(field(ways=[road((0, 50), (100, 50))]))
    np.testing.assert_allclose(dashes[:, 1], 50.0)
    np.testing.assert_allclose(np.diff(np.sort(dashes[:, 0])), 6.0)
    assert len(lanes_of(field(ways=[road((0, 50), (100, 50), width_m=5.0)]))) == 0
    assert len(lanes_of(field(ways=[road((0, 50), (100, 50), kind="service")]))) == 0


def test_a_wide_main_road_has_four_lanes_and_lines_along_its_edges() -> None:
    lines = lanes_of(field(ways=[road((0, 50), (100, 50), kind="primary", width_m=13.0)]))
    offsets = sorted({round(float(value) - 50.0, 2) for value in lines[:, 1]})
    assert offsets == [-6.15, -3.25, -0.12, 0.12, 3.25, 6.15]


def test_nothing_is_painted_on_junctions_and_crossings() -> None:
    world = field(ways=[road((0, 50), (100, 50)), road((20, 0), (20, 100)), walk(60.0)])
    dashes = lanes_of(world)
    for centre, reach in (((20.0, 50.0), 4.0), ((60.0, 50.0), 2.0)):
        assert (np.hypot(*(dashes - centre).T) > reach).all()


def test_a_street_drawn_in_two_parts_is_marked_as_one() -> None:
    parts = lanes_of(field(ways=[road((0, 50), (50, 50)), road((50, 50), (100, 50))]))
    assert (np.abs(parts[:, 0] - 50.0) < 6.0).any()


def test_stripes_fill_the_crossing_along_the_road() -> None:
    found = crossings_of(field(ways=[road((0, 50), (100, 50)), walk(60.0)]))
    stripes = zebras(found).corners
    assert len(stripes) == 7
    assert stripes[..., 0].min() == pytest.approx(58.5)
    assert stripes[..., 0].max() == pytest.approx(61.5)
    assert 46.0 <= stripes[..., 1].min() <= 47.0
    np.testing.assert_allclose(np.diff(np.sort(stripes[..., 1].mean(axis=1))), 1.0)


def test_crossings_of_roads_that_meet_sharply_do_not_lie_on_each_other() -> None:
    sharp = road((50, 50), (100, 60))
    walks = [walk(62.0), Way("footway", Ground.PAVEMENT, np.array([(66.0, 46.0), (63.0, 60.0)]), 3.0)]
    found = crossings_of(field(ways=[road((0, 50), (100, 50)), sharp, *walks]))
    assert found.marked.sum() > 1
    stripes = zebras(found).corners
    shapes = shapely.polygons(stripes[..., :2])
    at, other = shapely.STRtree(shapes).query(shapes, predicate="overlaps")
    assert shapely.area(shapely.intersection(shapes[at], shapes[other])).sum() < 0.5


def test_cars_stop_before_the_crossing_on_their_right_lane() -> None:
    lines = middles_of([stop_lines(crossings_of(field(ways=[road((0, 50), (100, 50)), walk(60.0)])))])
    by_x = lines[np.argsort(lines[:, 0])]
    # Who drives east keeps south of the middle, and comes from the west.
    assert by_x[0, 0] < 58.5
    assert by_x[0, 1] < 50.0
    assert by_x[1, 0] > 61.5
    assert by_x[1, 1] > 50.0


def test_bays_lie_on_the_car_park() -> None:
    world = field(regions=[Region(Ground.PARKING, box(20, 20, 60, 40))], ways=[road((30, 0), (30, 100))])
    lines = parking_bays(world, ground_map_of(world)).corners
    assert len(lines) > 15
    assert lines[..., 0].min() > 19.9
    assert lines[..., 1].max() < 40.1
    # None on the road through it.
    assert (np.abs(lines[..., 0].mean(axis=1) - 30.0) > 3.9).all()


def test_pitches_and_railways_have_their_lines() -> None:
    world = field(
        regions=[Region(Ground.PITCH, box(10, 10, 70, 50))],
        ways=[Way("rail", Ground.RAILWAY, np.array([(0.0, 80.0), (100.0, 80.0)]), 3.0)],
    )
    assert len(pitches(world).corners) > 40
    steel = [part for part in rails(world.ways) if part.materials[0] == Material.METAL]
    assert sorted({round(float(y), 4) for y in middles_of(steel)[:, 1]}) == [79.2825, 80.7175]


def test_stairs_have_steps_across() -> None:
    flight = Way("steps", Ground.STEPS, np.array([(10.0, 10.0), (10.0, 19.0)]), 3.0)
    edges = stairs((flight, road((0, 50), (100, 50)))).corners
    assert len(edges) == 20
    np.testing.assert_allclose(np.ptp(edges[..., 0], axis=1), 3.0)
    np.testing.assert_allclose(np.diff(np.sort(edges[..., 1].mean(axis=1))), 0.45)


def test_what_another_ground_covers_is_not_painted() -> None:
    square = Way("pedestrian", Ground.PLAZA, np.array([(30.0, 50.0), (60.0, 50.0)]), 20.0)
    world = field(ways=[road((0, 50), (100, 50)), square])
    roads = [way for way in world.ways if way.ground == Ground.ROAD]
    (dashes, *_) = lane_lines(roads, clearings_of(roads, crossings_of(world)))
    shown = lying_on(dashes, ground_map_of(world), Ground.ROAD).corners[..., 0].mean(axis=1)
    assert 0 < len(shown) < len(dashes.corners)
    assert ((shown < 21.0) | (shown > 69.0)).all()


def test_everything_is_low_faces_up_and_comes_in_squares() -> None:
    world = generate_world("town", seed=4, size_m=300.0)
    made = markings_of(world, ground_map_of(world))
    assert len(made) > 30
    for model, place in made:
        (mesh,) = model.levels
        assert len(mesh.triangles) > 0
        assert mesh.vertices[:, 2].min() >= 0.0
        assert mesh.vertices[:, 2].max() < 0.2
        assert mesh.normals[..., 2].min() > -1e-6
        assert np.abs(mesh.vertices[:, :2]).max() < CHUNK_M / 2.0 + 7.0
        assert place[0] % CHUNK_M == CHUNK_M / 2.0


def test_it_is_the_same_whenever_it_is_made() -> None:
    world = generate_world("downtown", seed=4, size_m=200.0)
    one, other = (markings_of(world, ground_map_of(world)) for _ in range(2))
    assert [place for _, place in one] == [place for _, place in other]
    for (model, _), (again, _) in zip(one, other, strict=True):
        assert model.levels[0].vertices.tobytes() == again.levels[0].vertices.tobytes()
        assert model.levels[0].uvs.tobytes() == again.levels[0].uvs.tobytes()


def test_a_world_with_nothing_to_paint_has_no_markings() -> None:
    world = field()
    assert markings_of(world, ground_map_of(world)) == []
    assert chunked([]) == []
