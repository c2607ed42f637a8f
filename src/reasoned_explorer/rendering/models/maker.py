"""How the model of a class is made: one function for all levels of detail and all variants."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.rendering.mesh import Mesh, Model
from reasoned_explorer.rendering.mesh_builder import FAR, Colour, MeshBuilder

UNTINTED: tuple[Colour, ...] = ((1.0, 1.0, 1.0),)


@dataclass(frozen=True, slots=True)
class Maker:
    """Makes the models of one class.

    Attributes:
        make: Builds a variant (the number given) at the builder's level of detail. At `FAR` it builds at most 24
            triangles.
        variants: How many there are.
        tints: Plausible tints, sRGB.
        scaling: As of `Model`.
        fits: ``"all"``: every level is drawn out to exactly the class's size. ``"height"``: only upward; it may reach
            beyond on the sides (a lamp's arm above people's heads). ``"none"``: it keeps its own size (a child, a
            climbing frame on a playground). Coarse levels always have the extent of the finest.
        relief_m: For fronts, which begin at a wall at y = 0: how much thicker they are made, so that they cover door
            frames and sills of the wall. It differs from class to class, so that no two fronts that overlap lie in one
            plane. 0 for what stands free, about x = y = 0.
    """

    make: Callable[[MeshBuilder, int], None]
    variants: int = 1
    tints: tuple[Colour, ...] = UNTINTED
    scaling: str = "axes"
    fits: str = "all"
    relief_m: float = 0.0

    def model(self, variant: int, size_m: tuple[float, float, float]) -> Model:
        """Return a variant, counted round, for the class's natural size (across, ahead, up), metres."""
        levels: list[Mesh] = []
        for detail in range(FAR + 1):
            builder = MeshBuilder(detail=detail)
            self.make(builder, variant % self.variants)
            mesh = builder.mesh()
            if self.relief_m > 0.0:
                mesh = _thickened(mesh, self.relief_m + 0.001 * (variant % self.variants))
            # Where a coarser level saves nothing, the one before serves again.
            levels.append(mesh if not levels or len(mesh.triangles) < len(levels[-1].triangles) else levels[-1])
        low, high = self._extent(levels[0], size_m)
        return Model(tuple(drawn_out(mesh, low, high) for mesh in levels), size_m, self.scaling)

    def _extent(
        self, finest: Mesh, size_m: tuple[float, float, float]
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        size = np.asarray(size_m)
        if self.fits != "all" and len(finest.vertices):
            vertices = finest.vertices.astype(np.float64)
            low, high = vertices.min(axis=0), vertices.max(axis=0)
            high[2] = size[2] if self.fits == "height" else high[2] - low[2]
            low[2] = 0.0
            return low, high
        low = np.array([-size[0] / 2.0, 0.0 if self.relief_m > 0.0 else -size[1] / 2.0, 0.0])
        return low, low + size


def _thickened(mesh: Mesh, relief_m: float) -> Mesh:
    """Return a front, 0.5 m deep, with its back where it was and all else farther from the wall."""
    vertices = mesh.vertices.copy()
    before = vertices[:, 1] > 1e-6
    vertices[before, 1] = relief_m + (1.0 - relief_m / 0.5) * vertices[before, 1]
    return replace(mesh, vertices=vertices)


def drawn_out(mesh: Mesh, low: NDArray[np.float64], high: NDArray[np.float64]) -> Mesh:
    """Return a mesh scaled along the axes and moved so that it fills a box exactly.

    Args:
        mesh: Any; along an axis on which it has no extent it is only moved.
        low: The box's corner with the least coordinates.
        high: The opposite corner.
    """
    if not len(mesh.vertices):
        return mesh
    vertices = mesh.vertices.astype(np.float64)
    first, last = vertices.min(axis=0), vertices.max(axis=0)
    extent = last - first
    factor = np.where(extent > 0.0, (high - low) / np.where(extent > 0.0, extent, 1.0), 1.0)
    normals = mesh.normals / factor
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    return replace(
        mesh,
        vertices=((vertices - first) * factor + low).astype(np.float32),
        normals=normals.astype(np.float32),
    )
