"""Buildings stand on their footprints and reach their heights; windows are whole, doors are where one goes in."""

from dataclasses import replace

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from reasoned_explorer.rendering.buildings import mesh_of_building, models_of_buildings
from reasoned_explorer.rendering.material import Material
from reasoned_explorer.rendering.mesh import Mesh, Model
from reasoned_explorer.world.generator import generate_world
from reasoned_explorer.world.taxonomy import Ground
from reasoned_explorer.world.world import Building, Way
from tests.rendering.meshes import fighting
from tests.world.worlds import box

Floats = NDArray[np.float64]

OFFICE = Building(outer=box(0, 0, 30, 20), height_m=18.0, kind="office", entrances=np.array([(15.0, 0.0)]))
HOUSE = Building(outer=box(0, 0, 12, 8), height_m=8.0, kind="detached", entrances=np.array([(12.0, 4.0)]))
BLOCK = Building(outer=box(0, 0, 40, 30), holes=(box(12, 10, 28, 20),), height_m=16.0, kind="apartments")
CHURCH = Building(
    outer=np.array([(-6, -20), (6, -20), (6, -4), (14, -4), (14, 4), (6, 4), (6, 20), (-6, 20), (-6, 4), (-14, 4),
                    (-14, -4), (-6, -4)], float), height_m=30.0, kind="church",
)  # fmt: skip
CANOPY = Building(outer=box(0, 0, 24, 9), height_m=5.2, min_height_m=4.2, kind="roof")
ALL = {"office": OFFICE, "house": HOUSE, "block": BLOCK, "church": CHURCH, "canopy": CANOPY}


def corners_of(mesh: Mesh) -> Floats:
    return mesh.vertices.astype(np.float64)[mesh.triangles]


def middles_of(mesh: Mesh) -> Floats:
    return corners_of(mesh).mean(axis=1)


def flat_normals_of(mesh: Mesh) -> Floats:
    corners = corners_of(mesh)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return normal / np.maximum(np.linalg.norm(normal, axis=1), 1e-12)[:, None]


def volume_of(mesh: Mesh) -> float:
    """What the faces enclose above the ground, cubic metres: the divergence theorem with the field (0, 0, z)."""
    corners = corners_of(mesh)
    double = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2]
    return float((double / 2.0 * corners[..., 2].mean(axis=1)).sum())


def bytes_of(model: Model) -> list[bytes]:
    names = ("vertices", "triangles", "normals", "uvs", "colours", "materials")
    return [getattr(level, name).tobytes() for level in model.levels for name in names]


@pytest.mark.parametrize("name", ALL)
@pytest.mark.parametrize("seed", range(6))
def test_meshes_are_sound(name: str, seed: int) -> None:
    for mesh in mesh_of_building(ALL[name], seed=seed).levels:
        assert mesh.triangles.min() >= 0
        assert mesh.triangles.max() < len(mesh.vertices)
        np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=2), 1.0, atol=1e-5)
        # The normal that light sees is the side that is drawn.
        assert (np.sum(mesh.normals[:, 0] * flat_normals_of(mesh), axis=1) > 0.9).all()
        assert np.isfinite(mesh.uvs).all()
        assert mesh.colours.min() >= 0.0
        assert mesh.colours.max() <= 1.0


@pytest.mark.parametrize("name", ALL)
@pytest.mark.parametrize("seed", range(6))
def test_buildings_reach_their_height_and_stand_on_the_ground(name: str, seed: int) -> None:
    building = ALL[name]
    for level, mesh in enumerate(mesh_of_building(building, seed=seed).levels):
        heights = mesh.vertices[:, 2]
        # Chimneys and lift huts rise above the roof.
        assert building.height_m - 0.01 <= heights.max() <= building.height_m + (2.5 if level < 2 else 0.01)
        assert heights.min() == pytest.approx(building.min_height_m if (name, level) == ("canopy", 2) else 0.0)
        low, high = mesh.vertices[:, :2].min(axis=0), mesh.vertices[:, :2].max(axis=0)
        assert (low > building.outer.min(axis=0) - 1.3).all()
        assert (high < building.outer.max(axis=0) + 1.3).all()


@pytest.mark.parametrize("seed", range(8))
def test_levels_get_simpler_and_keep_the_silhouette(seed: int) -> None:
    for building in (OFFICE, HOUSE, BLOCK):
        fine, middle, coarse = mesh_of_building(building, seed=seed).levels
        assert len(fine.triangles) > len(middle.triangles) > len(coarse.triangles)
        assert len(coarse.triangles) <= 8 * (len(building.outer) + 4 * len(building.holes))
        area = shapely.Polygon(building.outer, building.holes).area
        assert 0.5 * area * building.height_m < volume_of(coarse) <= 1.05 * area * building.height_m


def test_a_flat_building_encloses_its_block_exactly() -> None:
    shed = Building(outer=box(0, 0, 30, 20), holes=(box(5, 5, 10, 10),), height_m=40.0, kind="office")
    coarse = mesh_of_building(shed, seed=1).levels[-1]
    assert volume_of(coarse) == pytest.approx((600.0 - 25.0) * 40.0)


@pytest.mark.parametrize("name", ["office", "block"])
def test_walls_face_outwards_and_into_courtyards(name: str) -> None:
    building = ALL[name]
    mesh = mesh_of_building(building, seed=2).levels[-1]
    plan = shapely.Polygon(building.outer, building.holes)
    upright = np.abs(mesh.normals[:, 0, 2]) < 1e-6
    outside = middles_of(mesh)[upright, :2] + 0.01 * mesh.normals[upright, 0, :2]
    assert not shapely.contains_xy(plan, outside).any()


@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize("width_m", [3.0, 7.3, 10.0, 31.7])
def test_windows_and_storeys_come_out_whole(width_m: float, seed: int) -> None:
    building = Building(outer=box(0, 0, width_m, 11.4), height_m=17.3, kind="yes")
    for mesh in mesh_of_building(building, seed=seed).levels:
        for material, bay in ((Material.FACADE, 3.0), (Material.FACADE_BRICK, 3.0), (Material.FACADE_GLASS, 1.5)):
            walls = (mesh.materials == material) & (np.abs(mesh.normals[:, 0, 2]) < 1e-6)
            corners = corners_of(mesh)[walls]
            # Windows of dormers are one cut-out each.
            wide = np.ptp(corners[..., :2], axis=1).max(axis=1) > 1.6
            spans = np.ptp(mesh.uvs[walls][wide], axis=1)
            np.testing.assert_allclose(spans / [bay, 3.0], np.rint(spans / [bay, 3.0]), atol=1e-4)
            tall = np.ptp(corners[wide][..., 2], axis=1)
            assert ((tall > 1.9) & (tall / (spans[:, 1] / 3.0) < 5.0)).all()


@pytest.mark.parametrize("building", [OFFICE, HOUSE])
def test_there_is_a_door_at_the_entrance(building: Building) -> None:
    for mesh in mesh_of_building(building, seed=3).levels[:2]:
        leaf = (mesh.materials == Material.WOOD) & (corners_of(mesh)[..., 2].max(axis=1) < 3.2)
        gap = np.hypot(*(middles_of(mesh)[leaf][:, :2] - building.entrances[0]).T)
        assert gap.min() < 0.7
        assert gap.max() < 1.2
        outwards = building.entrances[0] - building.outer.mean(axis=0)
        assert (mesh.normals[leaf, 0, :2] @ outwards > 0.0).all()


def test_an_entrance_far_from_the_walls_is_ignored() -> None:
    lost = replace(OFFICE, entrances=np.array([(500.0, 500.0)]))
    mesh = mesh_of_building(lost, seed=3).levels[0]
    assert mesh.vertices[:, :2].max() < 32.0


def test_houses_have_pitched_roofs_and_towers_of_offices_flat_ones() -> None:
    def sloping(building: Building, seed: int) -> bool:
        mesh = mesh_of_building(building, seed=seed).levels[-1]
        return bool(((mesh.normals[:, 0, 2] > 0.1) & (mesh.normals[:, 0, 2] < 0.95)).any())

    tall = replace(OFFICE, height_m=60.0)
    assert sum(sloping(HOUSE, seed) for seed in range(20)) >= 16
    assert not any(sloping(tall, seed) for seed in range(20))
    assert all(sloping(CHURCH, seed) for seed in range(20))


def test_a_church_has_a_spire_over_a_lower_nave() -> None:
    mesh = mesh_of_building(CHURCH, seed=1).levels[-1]
    high = mesh.vertices[mesh.vertices[:, 2] > 0.75 * CHURCH.height_m]
    assert len(high)
    assert np.ptp(high[:, :2], axis=0).max() < 9.0


def test_one_can_walk_under_a_canopy_between_its_posts() -> None:
    mesh = mesh_of_building(CANOPY, seed=1).levels[0]
    low = corners_of(mesh)[..., 2].min(axis=1) < CANOPY.min_height_m - 0.01
    posts = corners_of(mesh)[low]
    assert len(posts)
    assert np.ptp(posts[..., :2], axis=1).max() < 0.3
    under = (mesh.normals[:, 0, 2] < -0.99) & (corners_of(mesh)[..., 2] > 4.0).all(axis=1)
    double = np.cross(*(corners_of(mesh)[under][:, at] - corners_of(mesh)[under][:, 0] for at in (1, 2)))[:, 2]
    assert -double.sum() / 2.0 == pytest.approx(24.0 * 9.0)


def test_the_way_a_ring_is_drawn_does_not_matter() -> None:
    messy = np.array([(30, 20), (30, 20), (30, 0), (12, 0), (0, 0), (0, 0), (0, 7), (0, 20)], float)
    tall = replace(OFFICE, height_m=50.0)
    drawn = [mesh_of_building(replace(tall, outer=ring), seed=1).levels[-1] for ring in (tall.outer, messy)]
    assert volume_of(drawn[0]) == pytest.approx(volume_of(drawn[1]))
    assert len(drawn[0].triangles) == len(drawn[1].triangles)


@pytest.mark.parametrize("outer", [np.empty((0, 2)), box(0, 0, 5, 0), box(0, 0, 0.1, 0.1)])
def test_what_has_no_area_has_no_triangles(outer: Floats) -> None:
    model = mesh_of_building(Building(outer=outer, height_m=9.0), seed=0)
    assert all(len(level.triangles) == 0 for level in model.levels)
    assert model.size_m == (0.0, 0.0, 0.0)


@pytest.mark.parametrize("height_m", [0.05, 1.0, 2.2, 3.0, 4.1, 900.0])
@pytest.mark.parametrize("kind", ["house", "garage", "church", "roof", "tower", "retail", "kiosk", "no such kind"])
def test_any_height_will_do(kind: str, height_m: float) -> None:
    mesh = mesh_of_building(Building(outer=box(0, 0, 9, 6), height_m=height_m, kind=kind), seed=4).levels[0]
    assert height_m - 0.01 <= mesh.vertices[:, 2].max() <= height_m + 2.5
    assert mesh.vertices[:, 2].min() >= -1e-6


@settings(deadline=None, max_examples=80)
@given(
    st.lists(st.tuples(st.integers(-30, 30), st.integers(-30, 30)), min_size=0, max_size=14),
    st.sampled_from(["house", "yes", "church", "roof", "office", "apartments"]),
    st.integers(0, 9),
)
def test_any_ring_at_all_makes_a_sound_mesh(ring: list[tuple[int, int]], kind: str, seed: int) -> None:
    """Rings that cross themselves, turn back or have no area come from maps, too."""
    outer = np.array(ring, dtype=np.float64).reshape(-1, 2)
    for mesh in mesh_of_building(Building(outer=outer, height_m=12.0, kind=kind), seed=seed).levels:
        assert np.isfinite(mesh.vertices).all()
        assert np.isfinite(mesh.uvs).all()
        np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=2), 1.0, atol=1e-5)
        assert len(mesh.vertices) == 0 or np.abs(mesh.vertices[:, :2]).max() < 100.0


def test_a_building_looks_the_same_alone_and_among_others_in_any_order() -> None:
    world = generate_world("town", seed=2, size_m=250.0)
    some = world.buildings[:40]
    there = models_of_buildings(some, seed=7)
    back = models_of_buildings(some[::-1], seed=7)[::-1]
    for building, (model, place), (other, _) in zip(some, there, back, strict=True):
        assert bytes_of(model) == bytes_of(other)
        if not len(building.entrances):  # its door is on a wall that no neighbour stands before
            continue
        alone = mesh_of_building(building, seed=7)
        # The finest level has awnings, which keep clear of the neighbours' doors.
        moved = model.levels[1].vertices + np.float32(place)
        np.testing.assert_allclose(moved, alone.levels[1].vertices, atol=1e-3)


def test_the_same_seed_gives_the_same_bytes_and_others_other_looks() -> None:
    assert bytes_of(mesh_of_building(BLOCK, seed=1)) == bytes_of(mesh_of_building(BLOCK, seed=1))
    looks = {tuple(bytes_of(mesh_of_building(BLOCK, seed=seed))) for seed in range(8)}
    assert len(looks) == 8


def doors_of(model: Model) -> Floats:
    """The middles of the leaves of doors."""
    mesh = model.levels[1]
    middles = middles_of(mesh)
    found: Floats = middles[(mesh.materials == Material.WOOD) & (middles[:, 2] < 2.6)]
    return found


def test_there_is_no_door_where_the_front_of_a_place_is() -> None:
    building = replace(OFFICE, entrances=np.array([(15.0, 0.0), (5.0, 0.0)]))
    both, _ = models_of_buildings([building], seed=1)[0]
    one, place = models_of_buildings([building], seed=1, fronts=np.array([(14.0, 0.0, 6.0)]))[0]
    assert len(doors_of(both)) == 4
    assert len(doors_of(one)) == 2
    assert np.abs(doors_of(one)[:, 0] + place[0] - 5.0).max() < 1.0


def test_doors_at_one_place_are_one() -> None:
    building = replace(OFFICE, entrances=np.array([(15.0, 0.0), (15.8, 0.0)]))
    assert len(doors_of(mesh_of_building(building, seed=1))) == 2


def test_a_door_that_no_map_knows_leads_to_a_way_and_not_into_the_neighbour() -> None:
    long, next_door = Building(outer=box(0, 0, 30, 9), height_m=9.0), Building(outer=box(0, 9.2, 30, 20), height_m=9.0)
    way = Way("residential", Ground.ROAD, np.array([(-9.0, -30.0), (-9.0, 30.0)]), 6.0)
    (model, (x, y, _)), _ = models_of_buildings([long, next_door], seed=3)
    assert (doors_of(model)[:, 1] + y < 1.0).all()
    (model, (x, y, _)), _ = models_of_buildings([long, next_door], seed=3, ways=[way])
    assert (doors_of(model)[:, 0] + x < 0.0).all()


def test_no_buildings_are_no_trouble() -> None:
    assert models_of_buildings([], seed=0) == []


def test_no_two_colours_of_a_building_lie_in_one_plane_and_nothing_lies_below_the_ground() -> None:
    world = generate_world("town", seed=6, size_m=300.0)
    for model, _ in models_of_buildings(world.buildings, seed=6, ways=world.ways):
        for mesh in model.levels[:2]:
            assert not len(fighting(mesh))
            assert mesh.vertices[:, 2].min() >= 0.0
