"""Faces of many owners become one sound mesh for each."""

import numpy as np
import pytest

from reasoned_explorer.rendering.patches import Patch, boxes, extents_of, lifted, meshes_of, quads, rectangle_uvs

GREY = np.array((0.5, 0.5, 0.5))
EAST = np.array([(1.0, 0.0)])


def floor(x_m: float, owner: int, corners: int = 4) -> Patch:
    """Return a square, or a regular polygon, on the ground."""
    angles = 2.0 * np.pi * np.arange(corners) / corners
    ring = np.column_stack([x_m + np.cos(angles), np.sin(angles)])
    face = lifted(ring, 0.0)[None]
    return Patch.of(face, face[..., :2], colours=GREY, materials=3, owners=np.array([owner]))


def test_faces_go_to_their_owners_in_the_order_of_the_patches() -> None:
    meshes = meshes_of([floor(0, 2), floor(5, 0), floor(9, 2, corners=3)], 4, origins=np.zeros((4, 2)))
    assert [len(mesh.triangles) for mesh in meshes] == [2, 0, 3, 0]
    assert [len(mesh.vertices) for mesh in meshes] == [4, 0, 7, 0]
    assert meshes[2].vertices[meshes[2].triangles[:2], 0].max() == pytest.approx(1.0)
    assert meshes[2].vertices[meshes[2].triangles[2], 0].min() > 8.0
    assert (meshes[2].materials == 3).all()


@pytest.mark.parametrize("corners", [3, 4, 5, 9])
def test_faces_of_any_number_of_corners_are_cut_into_fans(corners: int) -> None:
    (mesh,) = meshes_of([floor(0, 0, corners)], 1, origins=np.zeros((1, 2)))
    assert len(mesh.triangles) == corners - 2
    points = mesh.vertices[mesh.triangles].astype(np.float64)
    area = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])[:, 2] / 2.0
    assert (area > 0.0).all()
    assert area.sum() == pytest.approx(corners / 2.0 * np.sin(2.0 * np.pi / corners), rel=1e-6)
    np.testing.assert_allclose(mesh.normals, np.broadcast_to((0.0, 0.0, 1.0), mesh.normals.shape), atol=1e-6)
    np.testing.assert_allclose(mesh.uvs, points[..., :2], atol=1e-6)


def test_each_mesh_is_about_its_own_origin() -> None:
    far = 123_456.0
    meshes = meshes_of([floor(far, 0), floor(far + 5.0, 1)], 2, origins=np.array([(far, 0.0), (far + 4.0, 1.0)]))
    np.testing.assert_allclose(meshes[0].vertices.mean(axis=0), (0.0, 0.0, 0.0), atol=1e-6)
    np.testing.assert_allclose(meshes[1].vertices.mean(axis=0), (1.0, -1.0, 0.0), atol=1e-6)


@pytest.mark.parametrize("bottom", [False, True])
def test_a_box_is_closed_and_faces_outwards(bottom: bool) -> None:
    turned = np.array([(0.6, 0.8)])
    box = boxes(np.array([(3.0, 4.0)]), turned, length_m=4.0, width_m=2.0, low_m=1.0, high_m=4.0, colours=GREY,
                materials=1, owners=np.array([0]), bottom=bottom)  # fmt: skip
    (mesh,) = meshes_of([box], 1, origins=np.zeros((1, 2)))
    assert len(mesh.triangles) == (12 if bottom else 10)
    points = mesh.vertices[mesh.triangles].astype(np.float64)
    away = points.mean(axis=1) - (3.0, 4.0, 2.5)
    assert (np.sum(mesh.normals[:, 0] * away, axis=1) > 0.0).all()
    six = np.sum(points[:, 0] * np.cross(points[:, 1], points[:, 2]), axis=1)
    if bottom:
        assert six.sum() / 6.0 == pytest.approx(24.0, rel=1e-6)


def test_extents_are_those_of_each_mesh() -> None:
    meshes = meshes_of([floor(0, 0), floor(5, 2, corners=3)], 3, origins=np.zeros((3, 2)))
    for extent, mesh in zip(extents_of(meshes), meshes, strict=True):
        assert extent == pytest.approx(mesh.size_m)


def test_no_faces_make_empty_meshes() -> None:
    nothing = floor(0, 0).where(np.array([False]))
    for patches in ([], [nothing]):
        meshes = meshes_of(patches, 2, origins=np.zeros((2, 2)))
        assert [len(mesh.triangles) for mesh in meshes] == [0, 0]
        assert extents_of(meshes) == [(0.0, 0.0, 0.0)] * 2


def test_a_rectangle_is_textured_from_its_lower_left_corner() -> None:
    uvs = rectangle_uvs(1.0, np.array([2.0, 3.0]), 5.0, 7.0, 2)
    np.testing.assert_allclose(uvs[1], [(1, 3), (5, 3), (5, 7), (1, 7)])
    assert quads(*(np.zeros((6, 3)) for _ in range(4))).shape == (6, 4, 3)
