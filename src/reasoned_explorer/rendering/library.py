"""Models packed for the kernels: all their triangles, one after the other, and where each level of detail begins."""

from collections.abc import Sequence
from typing import Any, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.rendering.mesh import Model

T = TypeVar("T", bound=np.generic)


class Library(NamedTuple):
    """Prototypes, each with its levels of detail.

    Attributes:
        vertices: Shape (v, 3), float32, metres in the model's frame.
        triangles: Places in ``vertices``, shape (t, 3), int32.
        normals: Shape (t, 3, 3), float32.
        uvs: Shape (t, 3, 2), float32, metres.
        colours: Reflectance in linear light, shape (t, 3), float32.
        materials: Shape (t,), uint8.
        levels: First vertex, vertices, first triangle, triangles of each level, shape (k, 4), int32.
        prototypes: First level and number of levels of each prototype, shape (p, 2), int32.
        boxes: Least and greatest corner of each prototype over all its levels, shape (p, 2, 3), float64.
    """

    vertices: NDArray[np.float32]
    triangles: NDArray[np.int32]
    normals: NDArray[np.float32]
    uvs: NDArray[np.float32]
    colours: NDArray[np.float32]
    materials: NDArray[np.uint8]
    levels: NDArray[np.int32]
    prototypes: NDArray[np.int32]
    boxes: NDArray[np.float64]


def pack(models: Sequence[Model]) -> Library:
    """Return a library with one prototype for each model, in their order; levels without triangles are left out."""
    kept = [[level for level in model.levels if len(level.triangles)] for model in models]
    counts = np.array([len(levels) for levels in kept], np.int32)
    meshes = [level for levels in kept for level in levels]
    sizes = np.array([(len(mesh.vertices), len(mesh.triangles)) for mesh in meshes], np.int64).reshape(-1, 2)
    firsts = np.cumsum(sizes, axis=0) - sizes
    levels = np.stack([firsts[:, 0], sizes[:, 0], firsts[:, 1], sizes[:, 1]], axis=1).astype(np.int32)
    triangles = [mesh.triangles + first for mesh, first in zip(meshes, firsts[:, 0], strict=True)]
    vertices = _joined([mesh.vertices for mesh in meshes], (3,), np.float32)
    return Library(
        vertices,
        _joined(triangles, (3,), np.int32),
        _joined([mesh.normals for mesh in meshes], (3, 3), np.float32),
        _joined([mesh.uvs for mesh in meshes], (3, 2), np.float32),
        linear_from_srgb(_joined([mesh.colours for mesh in meshes], (3,), np.float32)),
        _joined([mesh.materials for mesh in meshes], (), np.uint8),
        np.ascontiguousarray(levels),
        np.stack([np.cumsum(counts, dtype=np.int32) - counts, counts], axis=1).reshape(-1, 2).astype(np.int32),
        _boxes(vertices, sizes[:, 0], counts),
    )


def linear_from_srgb(colours: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return colours in linear light (IEC 61966-2-1); 1 stays 1 and what is above it goes on as a power."""
    straight = colours / 12.92
    curved = ((np.maximum(colours, 0.0) + 0.055) / 1.055) ** 2.4
    return np.where(colours <= 0.04045, straight, curved).astype(np.float32)


def _joined(parts: Sequence[NDArray[Any]], tail: tuple[int, ...], dtype: type[T]) -> NDArray[T]:
    if not parts:
        return np.zeros((0, *tail), dtype)
    return np.ascontiguousarray(np.concatenate(parts).reshape(-1, *tail), dtype)


def _boxes(vertices: NDArray[np.float32], sizes: NDArray[np.int64], counts: NDArray[np.int32]) -> NDArray[np.float64]:
    """Return the least and greatest corner of each prototype; zeros for one without levels."""
    ends = np.append(0, np.cumsum(sizes))[np.append(0, np.cumsum(counts))]
    found = np.zeros((len(counts), 2, 3))
    filled = np.flatnonzero(ends[1:] > ends[:-1])
    if len(filled):
        # What lies between two filled ones is empty.
        found[filled, 0] = np.minimum.reduceat(vertices, ends[filled], axis=0)
        found[filled, 1] = np.maximum.reduceat(vertices, ends[filled], axis=0)
    return found
