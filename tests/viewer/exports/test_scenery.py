"""Ground, buildings and things as triangles and boxes."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import shapely

from reasoned_explorer.evaluation.record_file import read_record
from reasoned_explorer.viewer.exports.mission import ExportedMission, find_mission
from reasoned_explorer.viewer.exports.scenery import Mesh, scenery_of
from reasoned_explorer.world.digest import world_digest
from reasoned_explorer.world.opening import open_world
from reasoned_explorer.world.taxonomy import Ground
from reasoned_explorer.world.world import Bounds, Building, Region, Way, World, WorldObject
from tests.viewer.exports.missions import RECORD

SQUARE = np.array([(0.0, 0.0), (20.0, 0.0), (20.0, 20.0), (0.0, 20.0)])
WORLD = World(
    "by hand",
    Bounds(-50.0, -50.0, 50.0, 50.0),
    (
        Region(Ground.GRASS, SQUARE * 2.0 - 20.0),
        Region(Ground.PLAZA, SQUARE, holes=(SQUARE * 0.5 + 5.0,)),
    ),
    (Way("footway", Ground.PATH, np.array([(-20.0, -10.0), (20.0, -10.0)]), 4.0),),
    (Building(SQUARE[::-1] - 20.0, 9.0, holes=(SQUARE * 0.2 - 12.0,), name="Town hall", min_height_m=0.0),),
    (WorldObject(0, "bench", 5.0, 6.0, math.pi / 2.0, (1.8, 0.6, 0.85), {"name": "Old bench"}),),
)


def _area_m2(mesh: Mesh) -> float:
    corners = mesh.vertices[mesh.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return float(np.linalg.norm(normals, axis=1).sum() / 2.0)


def test_ground_is_cut_where_other_ground_lies_on_it_and_looks_up() -> None:
    meshes = {mesh.name: mesh for mesh in scenery_of(ExportedMission(RECORD, "x", WORLD)).meshes}
    plaza, path, grass = (meshes[f"ground/{name}"] for name in ("plaza", "path", "grass"))
    assert _area_m2(plaza) == pytest.approx(400.0 - 100.0, abs=0.01)
    # The ends of the path are round and lie outside of the grass.
    assert 160.0 < _area_m2(path) < 160.0 + 4.0 * math.pi
    assert _area_m2(grass) == pytest.approx(1600.0 - 300.0 - 160.0, abs=0.01)
    for mesh in (plaza, path, grass):
        corners = mesh.vertices[mesh.triangles]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        assert (normals[:, 2] > 0.0).all()


def test_walls_look_out_of_a_building_whichever_way_its_rings_turn() -> None:
    scenery = scenery_of(ExportedMission(RECORD, "x", WORLD))
    meshes = {mesh.name: mesh for mesh in scenery.meshes}
    walls = meshes["buildings/walls"]
    assert _area_m2(walls) == pytest.approx(9.0 * (80.0 + 16.0))
    solid = shapely.Polygon(SQUARE - 20.0, [SQUARE * 0.2 - 12.0])
    for corners in walls.vertices[walls.triangles]:
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        outside = corners.mean(axis=0)[:2] + 0.1 * normal[:2] / np.linalg.norm(normal)
        assert not solid.covers(shapely.Point(outside))
    assert _area_m2(meshes["buildings/roofs"]) == pytest.approx(400.0 - 16.0, abs=0.01)
    assert set(meshes["buildings/roofs"].vertices[:, 2]) == {9.0}
    assert [name for name, _ in scenery.names] == ["Town hall"]


def test_a_thing_is_a_box_that_faces_where_it_faces() -> None:
    (bench,) = scenery_of(ExportedMission(RECORD, "x", WORLD)).things
    assert (bench.label, bench.kind) == ("Old bench", "furniture")
    assert bench.centre == (5.0, 6.0, 0.425)
    # It faces east, so that its length runs from north to south.
    along = (math.cos(bench.yaw_rad) * bench.size[0], math.sin(bench.yaw_rad) * bench.size[0])
    assert along == pytest.approx((0.0, -1.8))


def test_what_is_far_from_all_that_happened_is_left_out() -> None:
    far = replace(WORLD.objects[0], id=1, x_m=900.0)
    scenery = scenery_of(ExportedMission(RECORD, "x", replace(WORLD, objects=(*WORLD.objects, far))))
    assert len(scenery.things) == 1


def test_a_generated_place_is_covered_by_its_ground(run_mission: Path) -> None:
    found = find_mission(run_mission)
    names = {mesh.name for mesh in scenery_of(found).meshes}
    assert {"ground/plaza", "ground/road", "buildings/walls", "buildings/roofs"} <= names


def test_a_real_place_has_its_ground_buildings_and_things(osm_folder: Path) -> None:
    world = open_world(str(osm_folder / "uvic-campus.osm.pbf"))
    header = replace(RECORD.header, world=world.name, world_digest=world_digest(world))
    scenery = scenery_of(ExportedMission(replace(RECORD, header=header), "x", world))
    assert len(scenery.meshes) > 4
    assert scenery.things
    for mesh in scenery.meshes:
        assert np.isfinite(mesh.vertices).all()
        assert mesh.triangles.max() < len(mesh.vertices)


def test_where_no_world_is_there_is_none(by_hand: Path) -> None:
    assert scenery_of(ExportedMission(read_record(by_hand), "x")).meshes == ()
