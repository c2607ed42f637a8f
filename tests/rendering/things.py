"""Small scenes made by hand."""

from collections.abc import Sequence

import numpy as np

from reasoned_explorer.rendering.ground import GroundMap
from reasoned_explorer.rendering.ground_map import ground_colours, ground_materials
from reasoned_explorer.rendering.library import linear_from_srgb
from reasoned_explorer.rendering.material import Material
from reasoned_explorer.rendering.mesh import Mesh, Model
from reasoned_explorer.rendering.scene import FIRST_BUILDING_ID, Placed, Scene
from reasoned_explorer.world.taxonomy import Ground

#: The first id that things of `scene_of` have.
FIRST = FIRST_BUILDING_ID


def flat_mesh(corners, colour=(0.8, 0.8, 0.8), material: Material = Material.PLAIN) -> Mesh:
    """Flat triangles by their corners, shape (n, 3, 3)."""
    points = np.asarray(corners, np.float64).reshape(-1, 3, 3)
    normals = np.cross(points[:, 1] - points[:, 0], points[:, 2] - points[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return Mesh(
        points.reshape(-1, 3).astype(np.float32),
        np.arange(3 * len(points), dtype=np.int32).reshape(-1, 3),
        np.repeat(normals[:, None], 3, axis=1).astype(np.float32),
        points[:, :, :2].astype(np.float32),
        np.tile(np.float32(colour), (len(points), 1)),
        np.full(len(points), int(material), np.uint8),
    )


def box(size_m=(1.0, 1.0, 1.0), colour=(0.8, 0.8, 0.8), material: Material = Material.PLAIN) -> Model:
    """A box that stands on the ground."""
    x, y, z = size_m[0] / 2, size_m[1] / 2, size_m[2]
    c = np.array([[(-x, x)[i & 1], (-y, y)[i >> 1 & 1], (0.0, z)[i >> 2]] for i in range(8)])
    quads = [(0, 1, 5, 4), (1, 3, 7, 5), (3, 2, 6, 7), (2, 0, 4, 6), (4, 5, 7, 6), (2, 3, 1, 0)]
    corners = [c[[q[i], q[j], q[k]]] for q in quads for i, j, k in ((0, 1, 2), (0, 2, 3))]
    return Model((flat_mesh(corners, colour, material),), size_m)


def scene_of(
    things: Sequence[tuple[Model, tuple[float, float, float]]],
    *,
    ground: Ground = Ground.PAVEMENT,
    size_m: float = 60.0,
) -> Scene:
    """Models at places about (0, 0) on one kind of ground; thing k has the id `FIRST` + k."""
    cells = int(size_m * 4)
    codes = np.full((cells, cells), int(ground), np.uint8)
    corner = np.array([-size_m / 2, -size_m / 2, 0.25])
    plane = GroundMap(codes, corner, ground_materials(), linear_from_srgb(ground_colours()))
    placed = [Placed(model, FIRST + k, place) for k, (model, place) in enumerate(things)]
    return Scene.of_things(placed, plane, np.array([0, 1] + [2] * len(placed), np.uint8))
