"""Boxes that stand for what has no model yet."""

import numpy as np

from reasoned_explorer.rendering.material import Material
from reasoned_explorer.rendering.mesh import Mesh, Model


def flat_mesh(corners: object, colour: tuple[float, float, float], material: Material, uvs: object = None) -> Mesh:
    """Return a mesh of flat triangles given by their corners, shape (n, 3, 3), metres."""
    points = np.asarray(corners, np.float64).reshape(-1, 3, 3)
    normals = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    count = len(points)
    uv = points[:, :, :2] if uvs is None else np.asarray(uvs).reshape(-1, 3, 2)
    return Mesh(
        points.reshape(-1, 3).astype(np.float32),
        np.arange(3 * count, dtype=np.int32).reshape(-1, 3),
        np.repeat(normals[:, None], 3, axis=1).astype(np.float32),
        uv.astype(np.float32),
        np.tile(np.float32(colour), (count, 1)),
        np.full(count, int(material), np.uint8),
    )


def box_model(
    size_m: tuple[float, float, float], colour: tuple[float, float, float], material: Material = Material.PAINT
) -> Model:
    """Return a box that stands on the ground."""
    x, y, z = size_m[0] / 2, size_m[1] / 2, size_m[2]
    c = np.array([[(-x, x)[i & 1], (-y, y)[i >> 1 & 1], (0.0, z)[i >> 2]] for i in range(8)])
    quads = [(0, 1, 5, 4), (1, 3, 7, 5), (3, 2, 6, 7), (2, 0, 4, 6), (4, 5, 7, 6), (2, 3, 1, 0)]
    corners = [c[[q[i], q[j], q[k]]] for q in quads for i, j, k in ((0, 1, 2), (0, 2, 3))]
    return Model((flat_mesh(corners, colour, material),), size_m)
