"""Boxes that stand for what has no model yet."""

from itertools import pairwise

import numpy as np
import shapely

from reasoned_explorer.rendering.material import Material
from reasoned_explorer.rendering.mesh import Mesh, Model
from reasoned_explorer.world.world import Building


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


def block_model(building: Building) -> Model:
    """Return a building's outline drawn up to its height, in ENU metres."""
    low, high = building.min_height_m, building.height_m
    corners, uvs = [], []
    polygon = shapely.orient_polygons(shapely.Polygon(building.outer, building.holes))
    for ring in (polygon.exterior, *polygon.interiors):
        along = 0.0
        for a, b in pairwise(np.asarray(ring.coords)):
            length = float(np.hypot(*(b - a)))
            p = [(*a, low), (*b, low), (*b, high), (*a, high)]
            t = [(along, low), (along + length, low), (along + length, high), (along, high)]
            corners += [[p[0], p[1], p[2]], [p[0], p[2], p[3]]]
            uvs += [[t[0], t[1], t[2]], [t[0], t[2], t[3]]]
            along += length
    for triangle in shapely.constrained_delaunay_triangles(polygon).geoms:
        a, b, c = np.asarray(shapely.orient_polygons(triangle).exterior.coords)[:3]
        corners.append([(*a, high), (*b, high), (*c, high)])
        uvs.append([tuple(a), tuple(b), tuple(c)])
    mesh = flat_mesh(corners, (0.75, 0.7, 0.62), Material.PLASTER, uvs)
    return Model((mesh,), mesh.size_m, "none")
