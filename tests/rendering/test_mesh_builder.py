"""Shapes of the mesh builder: closed, outward, of the size that was asked for."""

import math

import numpy as np
import pytest

from reasoned_explorer.rendering.lettering import disc, facing_back, facing_front, facing_side, width_m, write
from reasoned_explorer.rendering.material import Material
from reasoned_explorer.rendering.mesh_builder import FAR, MeshBuilder, Surface
from reasoned_explorer.rendering.polygons import triangulated
from tests.rendering.meshes import faces, is_closed, signed_volume, welded

GREY = Surface(Material.PLAIN, (0.5, 0.5, 0.5))


def built(draw, detail=0):
    builder = MeshBuilder(detail=detail)
    draw(builder)
    return builder.mesh()


SOLIDS = {
    "box": (lambda b: b.box(GREY, (-1, -2, 0), (1, 2, 3)), 24.0, (2, 4, 3)),
    "bevelled box": (lambda b: b.box(GREY, (-1, -2, 0), (1, 2, 3), bevel=0.01), 24.0, (2, 4, 3)),
    "beam": (lambda b: b.beam(GREY, (0, 0, 1), (0, 4, 1), 0.5, 0.2), 0.4, (0.5, 4, 0.2)),
    "cylinder": (lambda b: b.cylinder(GREY, (0, 0, 0), (0, 0, 2), 1, sides=48), 2 * math.pi, (2, 2, 2)),
    "cylinder downward": (lambda b: b.cylinder(GREY, (0, 0, 2), (0, 0, 0), 1, sides=48), 2 * math.pi, (2, 2, 2)),
    "frustum": (
        lambda b: b.cylinder(GREY, (0, 0, 0), (3, 0, 0), 1, 0.5, sides=48),
        math.pi * (1 + 0.5 + 0.25),
        (3, 2, 2),
    ),
    "cone": (lambda b: b.cylinder(GREY, (0, 0, 0), (0, 0, 3), 1, 0.0, sides=48), math.pi, (2, 2, 3)),
    "sphere": (lambda b: b.sphere(GREY, (1, 2, 3), 1, sides=48, rings=32), 4 / 3 * math.pi, (2, 2, 2)),
    "ellipsoid": (lambda b: b.sphere(GREY, (0, 0, 0), (1, 2, 3), sides=48, rings=32), 8 * math.pi, (2, 4, 6)),
    "torus": (lambda b: b.torus(GREY, (0, 0, 0), 2, 0.5, around=64, sides=32), math.pi**2, (5, 5, 1)),
    "upright torus": (
        lambda b: b.torus(GREY, (0, 0, 0), 2, 0.5, (1, 0, 0), around=64, sides=32),
        math.pi**2,
        (1, 5, 5),
    ),
    "tube": (lambda b: b.tube(GREY, [(0, 0, 0), (0, 0, 1), (0, 0, 2)], 0.5, sides=48), math.pi / 2, (1, 1, 2)),
    "lathe": (lambda b: b.lathe(GREY, [(1, 0), (1, 1), (0, 2)], sides=48), math.pi * 4 / 3, (2, 2, 2)),
    "lathe from above": (lambda b: b.lathe(GREY, [(0, 2), (1, 1), (1, 0)], sides=48), math.pi * 4 / 3, (2, 2, 2)),
    "concave prism": (
        lambda b: b.extrude(GREY, [(0, 0), (3, 0), (3, 1), (1, 1), (1, 3), (0, 3)], "y", -1, 1),
        10.0,
        (3, 2, 3),
    ),
    "prism turned the other way": (
        lambda b: b.extrude(GREY, [(0, 3), (1, 3), (1, 1), (3, 1), (3, 0), (0, 0)], "x", 1, -1),
        10.0,
        (2, 3, 3),
    ),
}


@pytest.mark.parametrize("name", SOLIDS)
def test_solids_are_closed_outward_and_of_their_size(name):
    draw, volume, size = SOLIDS[name]
    mesh = built(draw)
    assert is_closed(welded(mesh))
    assert signed_volume(mesh, np.ones(len(mesh.triangles), bool)) == pytest.approx(volume, rel=0.03)
    assert mesh.size_m == pytest.approx(size, rel=0.01)


@pytest.mark.parametrize("name", SOLIDS)
@pytest.mark.parametrize("detail", range(FAR + 1))
def test_normals_and_uvs(name, detail):
    mesh = built(SOLIDS[name][0], detail)
    normals, areas = faces(mesh)
    assert areas.min() > 1e-9
    assert np.linalg.norm(mesh.normals, axis=2) == pytest.approx(1.0, abs=1e-5)
    assert np.einsum("mck,mk->mc", mesh.normals, normals).min() > 0.3
    assert np.isfinite(mesh.uvs).all()


@pytest.mark.parametrize("name", SOLIDS)
def test_each_place_is_one_vertex(name):
    mesh = built(SOLIDS[name][0])
    assert len(np.unique(mesh.vertices, axis=0)) == len(mesh.vertices)
    assert set(mesh.triangles.ravel()) == set(range(len(mesh.vertices)))


def test_flat_faces_have_flat_normals_and_round_ones_shared_normals():
    box = built(SOLIDS["box"][0])
    assert np.ptp(box.normals, axis=1).max() < 1e-6
    ball = built(SOLIDS["sphere"][0])
    places = ball.vertices[ball.triangles].astype(np.float64) - np.array([1, 2, 3])
    assert np.einsum("mck,mck->mc", places, ball.normals).min() > 0.999


def test_texture_coordinates_are_metres():
    mesh = built(lambda b: b.box(GREY, (0, 0, 0), (4, 2, 3)))
    corners, uvs = mesh.vertices[mesh.triangles], mesh.uvs
    for a, b in ((0, 1), (1, 2), (2, 0)):
        along = np.linalg.norm(corners[:, a] - corners[:, b], axis=1)
        assert np.linalg.norm(uvs[:, a] - uvs[:, b], axis=1) == pytest.approx(along, abs=1e-5)


def test_coarse_levels_have_fewer_sides_and_no_bevels():
    counts = [len(built(SOLIDS["cylinder"][0], detail).triangles) for detail in range(FAR + 1)]
    assert counts == sorted(counts, reverse=True)
    assert counts[0] > 2 * counts[-1]
    assert len(built(SOLIDS["bevelled box"][0], 0).triangles) == 44
    assert len(built(SOLIDS["bevelled box"][0], 1).triangles) == 12


def test_sheets_are_seen_from_both_sides_and_decals_from_one():
    square = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
    up = faces(built(lambda b: b.sheet(GREY, square)))[0][:, 2]
    assert sorted(up.tolist()) == [-1, -1, 1, 1]
    assert faces(built(lambda b: b.decal(GREY, square)))[0][:, 2].tolist() == [1, 1]


@pytest.mark.parametrize(("heading_deg", "way"), [(0, (0, 1)), (90, (1, 0)), (180, (0, -1))])
def test_cards_face_their_heading(heading_deg, way):
    mesh = built(lambda b: b.card(GREY, (0, 0, 0), 1, 2, math.radians(heading_deg)))
    assert faces(mesh)[0][0, :2] == pytest.approx(way, abs=1e-6)
    assert mesh.size_m[2] == 2


def test_parts_of_another_builder_turn_clockwise_and_stay_outward_when_mirrored():
    arm = MeshBuilder()
    arm.box(GREY, (-0.1, 0, 0), (0.1, 2, 1))
    east = built(lambda b: b.add(arm, (5, 0, 0), heading_rad=math.pi / 2))
    assert east.vertices[:, 0].max() == pytest.approx(7)
    mirrored = built(lambda b: b.add(arm, scale=(1, -1, 1)))
    assert mirrored.vertices[:, 1].min() == -2
    assert signed_volume(mirrored, np.ones(12, bool)) == pytest.approx(0.4)


def test_nothing_makes_an_empty_mesh():
    mesh = MeshBuilder().mesh()
    assert mesh.triangles.shape == (0, 3)
    assert mesh.size_m == (0, 0, 0)


def test_triangles_of_a_polygon_cover_it():
    star = np.array(
        [[math.sin(a) * r, math.cos(a) * r, 0] for a, r in ((k * math.pi / 5, 2 - k % 2) for k in range(10))]
    )
    triangles = triangulated(star)
    a, b, c = (star[triangles[:, k]] for k in range(3))
    areas = np.cross(b - a, c - a)[:, 2] / 2
    whole = np.cross(star, np.roll(star, -1, axis=0))[:, 2].sum() / 2
    assert len(triangles) == 8
    assert areas.max() < 0  # clockwise, as the star is
    assert areas.sum() == pytest.approx(whole)


def test_letters_are_read_from_ahead():
    # The stem of an L is on the reader's left: seen from ahead, that is at +x.
    front = built(lambda b: write(b, GREY, "L", facing_front(1.0), centre=(0, 2), height_m=1))
    corners = front.vertices[front.triangles].astype(float)
    tall = np.ptp(corners[:, :, 2], axis=1) > 0.8
    assert corners[tall][:, :, 0].mean() > 0.1
    assert faces(front)[0] == pytest.approx(np.tile([0, 1, 0], (len(front.triangles), 1)), abs=1e-6)
    assert front.vertices[:, 2].min() == pytest.approx(1.5)
    assert front.vertices[:, 2].max() == pytest.approx(2.5)


@pytest.mark.parametrize(
    ("plane", "way"),
    [(facing_back(-1.0), (0, -1, 0)), (facing_side(1.0), (1, 0, 0)), (facing_side(-1.0), (-1, 0, 0))],
)
def test_planes_face_their_reader(plane, way):
    mesh = built(lambda b: b.decal(GREY, plane.points(disc(0, 1, 0.5))))
    assert faces(mesh)[0] == pytest.approx(np.tile(way, (len(mesh.triangles), 1)), abs=1e-6)


def test_every_letter_has_strokes_and_words_their_width():
    for letter in "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789!":
        assert len(built(lambda b, s=letter: write(b, GREY, s, facing_front(0), centre=(0, 0), height_m=1)).triangles)
    word = built(lambda b: write(b, GREY, "HOTEL", facing_front(0), centre=(0, 0), height_m=0.5))
    assert word.size_m[0] == pytest.approx(width_m("HOTEL", 0.5), rel=0.02)
    assert len(built(lambda b: write(b, GREY, "   ", facing_front(0), centre=(0, 0), height_m=1)).triangles) == 0


def test_far_words_are_bars():
    bar = built(lambda b: write(b, GREY, "HOTEL", facing_front(0), centre=(0, 0), height_m=0.5), detail=2)
    assert len(bar.triangles) == 2
