"""Triangles and what they are made of.

A model's frame: x to its right, y ahead (its front faces +y), z up, metres, with its foot at z = 0 and its centre at
x = y = 0. A thing with heading 0 faces north, so that this frame is then ENU moved to the thing's place.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
    """Triangles, counter-clockwise seen from outside. Thin sheets are given both ways round.

    Attributes:
        vertices: Shape (n, 3), float32, metres.
        triangles: Places of their corners in ``vertices``, shape (m, 3), int32.
        normals: At each corner, of length 1, shape (m, 3, 3), float32: equal on flat faces, shared on rounded ones.
        uvs: Texture coordinates at each corner, metres on the surface, shape (m, 3, 2), float32.
        colours: Reflectance, sRGB in [0, 1], shape (m, 3), float32.
        materials: Values of `Material`, shape (m,), uint8.
    """

    vertices: NDArray[np.float32]
    triangles: NDArray[np.int32]
    normals: NDArray[np.float32]
    uvs: NDArray[np.float32]
    colours: NDArray[np.float32]
    materials: NDArray[np.uint8]

    @property
    def size_m(self) -> tuple[float, float, float]:
        """Extent along x, y and z, metres; zeros for a mesh without triangles."""
        if not len(self.vertices):
            return (0.0, 0.0, 0.0)
        extent = (self.vertices.max(axis=0) - self.vertices.min(axis=0)).tolist()
        return (extent[0], extent[1], extent[2])


@dataclass(frozen=True, slots=True, eq=False)
class Model:
    """What a thing looks like, in several levels of detail.

    Attributes:
        levels: Meshes, the finest first; each about a quarter of the triangles of the one before, the last at most 12
            or so. All have the same extent and colours, so that changing from one to the next is not seen.
        size_m: Natural extent, metres: what a thing's own size is compared with.
        scaling: ``"axes"`` (each axis by itself), ``"uniform"`` (by height) or ``"none"``.
    """

    levels: tuple[Mesh, ...]
    size_m: tuple[float, float, float]
    scaling: str = "axes"
