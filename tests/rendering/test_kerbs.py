"""Kerbs where carriageways end, sunk where people cross; quays and banks along water."""

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.rendering.crossings import crossings_of
from reasoned_explorer.rendering.ground_map import ground_map_of
from reasoned_explorer.rendering.kerbs import kerbs, shores
from reasoned_explorer.rendering.patches import Patch
from reasoned_explorer.world.taxonomy import Ground
from reasoned_explorer.world.world import Region, Way, World
from tests.world.worlds import box, field

Floats = NDArray[np.float64]
STREET = Way("residential", Ground.ROAD, np.array([(0.0, 50.0), (100.0, 50.0)]), 8.0)
SIDE = Way("residential", Ground.ROAD, np.array([(20.0, 50.0), (20.0, 100.0)]), 8.0)
WALK = Way("footway", Ground.PAVEMENT, np.array([(60.0, 40.0), (60.0, 60.0)]), 3.0)


def kerbs_of(world: World) -> list[Patch]:
    roads = [way for way in world.ways if way.ground == Ground.ROAD]
    return kerbs(roads, ground_map_of(world), crossings_of(world))


def normals_of(patch: Patch) -> Floats:
    return np.cross(patch.corners[:, 1] - patch.corners[:, 0], patch.corners[:, 2] - patch.corners[:, 0])


def test_kerbs_stand_at_the_edge_and_face_the_road() -> None:
    upright, top, back = kerbs_of(field(ways=[STREET], ground=Ground.PAVEMENT))
    y = upright.corners[..., 1]
    np.testing.assert_allclose(np.abs(y - 50.0), 3.87, atol=0.03)
    assert (normals_of(upright)[:, 1] * (y.mean(axis=1) - 50.0) < 0.0).all()
    assert (normals_of(top)[:, 2] > 0.0).all()
    assert (normals_of(back)[:, 2] > 0.0).all()
    assert upright.corners[..., 2].max() == 0.08


def test_there_is_no_kerb_across_a_side_street_or_a_crossing() -> None:
    upright = kerbs_of(field(ways=[STREET, SIDE, WALK], ground=Ground.PAVEMENT))[0]
    middle = upright.corners[..., :2].mean(axis=1)
    south = np.abs(middle[:, 1] - 46.0) < 0.2
    north = np.abs(middle[:, 1] - 54.0) < 0.2
    assert not (north & (np.abs(middle[:, 0] - 20.0) < 3.8)).any()
    assert (south & (np.abs(middle[:, 0] - 20.0) < 12.0)).any()
    assert not ((south | north) & (np.abs(middle[:, 0] - 60.0) < 1.7)).any()


def test_car_parks_are_driven_into_without_a_kerb() -> None:
    lot = Region(Ground.PARKING, box(30, 54, 50, 70))
    upright = kerbs_of(field(ways=[STREET], regions=[lot], ground=Ground.PAVEMENT))[0]
    middle = upright.corners[..., :2].mean(axis=1)
    assert not ((np.abs(middle[:, 1] - 54.0) < 0.2) & (middle[:, 0] > 31.0) & (middle[:, 0] < 49.0)).any()


def test_water_has_quays_on_paving_and_banks_in_the_green() -> None:
    pond = Region(Ground.WATER, box(30, 30, 70, 60), holes=(box(45, 40, 55, 50),))
    paved = shores(
        field(ground=Ground.PLAZA, regions=[pond]), ground_map_of(field(ground=Ground.PLAZA, regions=[pond]))
    )
    green = shores(field(regions=[pond]), ground_map_of(field(regions=[pond])))
    assert [len(part.corners) > 0 for part in paved] == [True, True, True, False, False]
    assert [len(part.corners) > 0 for part in green] == [False, False, False, True, False]
    assert max(part.corners[..., 2].max() for part in paved[:3]) < 0.2
    beach = field(ground=Ground.SAND, regions=[pond])
    assert [len(part.corners) > 0 for part in shores(beach, ground_map_of(beach))] == [False] * 4 + [True]


def test_no_water_has_no_shores_and_no_roads_have_no_kerbs() -> None:
    assert shores(field(), ground_map_of(field())) == []
    assert kerbs_of(field()) == []
