"""Many flat faces at once, and their way into one mesh for each owner."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.rendering.mesh import Mesh

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, slots=True, eq=False)
class Patch:
    """Flat convex faces, all with as many corners, counter-clockwise seen from outside.

    Attributes:
        corners: Shape (n, corners, 3), metres.
        uvs: Texture coordinates, metres, shape (n, corners, 2).
        colours: sRGB in [0, 1], shape (n, 3).
        materials: Values of `Material`, shape (n,), uint8.
        owners: Whose mesh each face belongs to, shape (n,).
    """

    corners: Floats
    uvs: Floats
    colours: Floats
    materials: NDArray[np.uint8]
    owners: Ints

    @classmethod
    def of(
        cls, corners: Floats, uvs: Floats, *, colours: Floats, materials: NDArray[np.uint8] | int, owners: Ints
    ) -> "Patch":
        """Return a patch; one colour or material stands for all faces."""
        count = len(corners)
        return cls(
            corners,
            uvs,
            np.broadcast_to(np.asarray(colours, dtype=np.float64), (count, 3)),
            np.broadcast_to(np.asarray(materials, dtype=np.uint8), (count,)),
            owners,
        )

    def where(self, chosen: NDArray[np.bool_]) -> "Patch":
        """Return some of the faces."""
        return Patch(
            self.corners[chosen], self.uvs[chosen], self.colours[chosen], self.materials[chosen], self.owners[chosen]
        )


def quads(*corners: Floats) -> Floats:
    """Return faces from their corners, each of shape (n, 3), in order; shape (n, corners, 3)."""
    return np.stack(corners, axis=1)


def lifted(points: Floats, z_m: Floats | float) -> Floats:
    """Return points of the plane, shape (n, 2), at a height: shape (n, 3)."""
    return np.column_stack([points, np.broadcast_to(np.asarray(z_m, dtype=np.float64), (len(points),))])


def rectangle_uvs(
    left: Floats | float, low: Floats | float, right: Floats | float, high: Floats | float, count: int
) -> Floats:
    """Return texture coordinates of faces with the corners low left, low right, high right, high left."""
    u0, v0, u1, v1 = (
        np.broadcast_to(np.asarray(value, dtype=np.float64), (count,)) for value in (left, low, right, high)
    )
    return np.stack([np.stack(pair, axis=1) for pair in ((u0, v0), (u1, v0), (u1, v1), (u0, v1))], axis=1)


def plan_uvs(corners: Floats) -> Floats:
    """Return texture coordinates of faces seen from above: their place east and north, metres."""
    uvs: Floats = corners[..., :2].copy()
    return uvs


def boxes(
    middles: Floats,
    along: Floats,
    *,
    length_m: Floats | float,
    width_m: Floats | float,
    low_m: Floats | float,
    high_m: Floats | float,
    colours: Floats,
    materials: NDArray[np.uint8] | int,
    owners: Ints,
    bottom: bool = False,
) -> Patch:
    """Return upright boxes.

    Args:
        middles: Of each box, shape (n, 2), metres.
        along: Unit directions of their lengths, shape (n, 2).
        length_m: Along that direction.
        width_m: Across it.
        low_m: Of the underside.
        high_m: Of the top.
        colours: One for all, or shape (n, 3).
        materials: One for all, or shape (n,).
        owners: Shape (n,).
        bottom: Whether the underside is seen.
    """
    count = len(middles)
    across = np.column_stack([-along[:, 1], along[:, 0]])
    half, side = (np.broadcast_to(np.asarray(size) / 2.0, (count,))[:, None] for size in (length_m, width_m))
    foot = [middles + one * half * along + other * side * across for one, other in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    below, above = [lifted(point, low_m) for point in foot], [lifted(point, high_m) for point in foot]
    faces = [quads(below[i], below[(i + 1) % 4], above[(i + 1) % 4], above[i]) for i in range(4)]
    long, wide, tall = 2.0 * half[:, 0], 2.0 * side[:, 0], np.asarray(high_m) - np.asarray(low_m)
    uvs = [rectangle_uvs(0.0, 0.0, (long, wide)[i % 2], tall, count) for i in range(4)]
    faces.append(quads(*above))
    uvs.append(rectangle_uvs(0.0, 0.0, long, wide, count))
    if bottom:
        faces.append(quads(*below[::-1]))
        uvs.append(rectangle_uvs(0.0, 0.0, long, wide, count))
    times = len(faces)
    return Patch.of(
        np.concatenate(faces),
        np.concatenate(uvs),
        colours=np.tile(np.broadcast_to(colours, (count, 3)), (times, 1)),
        materials=np.tile(np.broadcast_to(np.asarray(materials, np.uint8), (count,)), times),
        owners=np.tile(owners, times),
    )


def meshes_of(patches: Sequence[Patch], count: int, *, origins: Floats) -> list[Mesh]:
    """Return the mesh of each of ``count`` owners, its faces in the order of the patches.

    Args:
        patches: Faces; those with more than three corners are cut into fans.
        count: How many owners there are.
        origins: Where each mesh has its origin, shape (count, 2), metres.
    """
    patches = [patch for patch in patches if len(patch.corners)]
    if not patches:
        return [empty_mesh() for _ in range(count)]
    owners = np.concatenate([patch.owners for patch in patches])
    sizes = np.repeat([patch.corners.shape[1] for patch in patches], [len(patch.corners) for patch in patches])
    order = np.argsort(owners, kind="stable")
    owners, ordered = owners[order], sizes[order]
    corner = _spread((np.cumsum(sizes) - sizes)[order], ordered)
    # Single precision before everything is put in order: half as much to move.
    vertices = np.concatenate([_about(patch, origins) for patch in patches])[corner]
    uvs = np.concatenate([patch.uvs.astype(np.float32).reshape(-1, 2) for patch in patches])[corner]
    first = np.cumsum(ordered) - ordered
    face = np.repeat(np.arange(len(order)), ordered - 2)
    second = _spread(np.ones_like(ordered), ordered - 2)
    triangles = first[face][:, None] + np.column_stack([np.zeros_like(second), second, second + 1])
    row = order[face]
    normals = np.concatenate([_normals(patch.corners).astype(np.float32) for patch in patches])[row]
    colours = np.concatenate([patch.colours.astype(np.float32) for patch in patches])[row]
    materials = np.concatenate([patch.materials for patch in patches])[row]
    corner_uvs = uvs[triangles]
    face_ends = np.searchsorted(owners, np.arange(count + 1))
    vertex_ends = np.append(first, len(vertices))[face_ends]
    triangle_ends = np.searchsorted(face, face_ends)
    local = (triangles - np.repeat(vertex_ends[:-1], np.diff(triangle_ends))[:, None]).astype(np.int32)
    corner_normals = np.repeat(normals[:, None, :], 3, axis=1)
    found = []
    for at in range(count):
        v, t = slice(vertex_ends[at], vertex_ends[at + 1]), slice(triangle_ends[at], triangle_ends[at + 1])
        found.append(Mesh(vertices[v], local[t], corner_normals[t], corner_uvs[t], colours[t], materials[t]))
    return found


def extents_of(meshes: Sequence[Mesh]) -> list[tuple[float, float, float]]:
    """Return the extent of each mesh along x, y and z, metres, as `Mesh.size_m` does, for all at once."""
    sizes = np.zeros((len(meshes), 3))
    full = [at for at, mesh in enumerate(meshes) if len(mesh.vertices)]
    if full:
        starts = np.cumsum([0, *(len(meshes[at].vertices) for at in full[:-1])])
        vertices = np.concatenate([meshes[at].vertices for at in full])
        sizes[full] = np.maximum.reduceat(vertices, starts) - np.minimum.reduceat(vertices, starts)
    return [(x, y, z) for x, y, z in sizes.tolist()]


def _about(patch: Patch, origins: Floats) -> NDArray[np.float32]:
    """Return the corners of all faces of a patch, one after the other, each about its owner's origin."""
    moved = np.empty(patch.corners.shape, np.float32)
    moved[..., :2] = patch.corners[..., :2] - origins[patch.owners][:, None, :]
    moved[..., 2] = patch.corners[..., 2]
    return moved.reshape(-1, 3)


def empty_mesh() -> Mesh:
    """Return a mesh without triangles."""
    return Mesh(
        np.empty((0, 3), np.float32),
        np.empty((0, 3), np.int32),
        np.empty((0, 3, 3), np.float32),
        np.empty((0, 3, 2), np.float32),
        np.empty((0, 3), np.float32),
        np.empty(0, np.uint8),
    )


def _spread(starts: Ints, sizes: Ints) -> Ints:
    """Return start, start + 1 … of each run, one after the other."""
    ends = np.cumsum(sizes)
    runs: Ints = np.repeat(starts - (ends - sizes), sizes) + np.arange(ends[-1])
    return runs


def _normals(corners: Floats) -> Floats:
    """Return the unit normal of each face (of its diagonals, so that a needle at one corner does no harm)."""
    if corners.shape[1] > 3:
        normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, -1] - corners[:, 1])
    else:
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=1)
    flat = length < 1e-12
    normal[flat], length[flat] = (0.0, 0.0, 1.0), 1.0
    unit: Floats = normal / length[:, None]
    return unit
