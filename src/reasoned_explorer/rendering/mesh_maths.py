"""The arithmetic of meshes: faces, normals, texture coordinates, circles, boxes."""

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

#: Edges that are sharper than this stay edges on rounded bodies (cosine between a face and the mean of its neighbours).
_CREASE_COSINE = 0.55


def cross(one: FloatArray, other: FloatArray) -> FloatArray:
    """Return the cross products of vectors, shape (…, 3): much faster for few of them than numpy's own."""
    a, b, c = one[..., 0], one[..., 1], one[..., 2]
    d, e, f = other[..., 0], other[..., 1], other[..., 2]
    return np.stack([b * f - c * e, c * d - a * f, a * e - b * d], axis=-1)


def faces_of(vertices: FloatArray, triangles: IntArray) -> tuple[FloatArray, FloatArray]:
    """Return unit normals and areas of triangles."""
    a, b, c = (vertices[triangles[:, corner]] for corner in range(3))
    product = cross(b - a, c - a)
    length = np.linalg.norm(product, axis=1)
    return product / np.maximum(length, 1e-300)[:, None], length / 2.0


def corner_normals(
    vertices: FloatArray, triangles: IntArray, weighted: FloatArray, smooth: NDArray[np.bool_]
) -> FloatArray:
    """Return normals at the corners: of the face, or of all faces at a vertex where the skin is round."""
    faces = weighted / np.maximum(np.linalg.norm(weighted, axis=1), 1e-300)[:, None]
    normals = np.repeat(faces[:, None], 3, axis=1)
    round_ones = triangles[smooth]
    summed = np.stack(
        [np.bincount(round_ones.ravel(), np.repeat(weighted[smooth, k], 3), len(vertices)) for k in range(3)], axis=1
    )
    shared = summed / np.maximum(np.linalg.norm(summed, axis=1), 1e-300)[:, None]
    candidates = shared[round_ones]
    agrees = np.einsum("mck,mk->mc", candidates, faces[smooth]) > _CREASE_COSINE
    normals[smooth] = np.where(agrees[..., None], candidates, normals[smooth])
    return normals


def box_uvs(corners: FloatArray, faces: FloatArray) -> FloatArray:
    """Return texture coordinates, metres: each face is seen along the axis that it faces most, v upward."""
    towards = np.abs(faces).argmax(axis=1)
    sign = np.where(np.take_along_axis(faces, towards[:, None], axis=1) < 0.0, -1.0, 1.0)
    x, y, z = corners[..., 0], corners[..., 1], corners[..., 2]
    along = (towards[:, None] == np.arange(3))[:, :, None]
    u = np.select([along[:, 0], along[:, 1]], [sign * y, -sign * x], sign * x)
    v = np.select([along[:, 0], along[:, 1]], [z, z], y)
    return np.stack([u, v], axis=-1)


def signed_volume(vertices: FloatArray, triangles: IntArray) -> float:
    """Return six times the volume that triangles enclose, positive when they face outward."""
    a, b, c = (vertices[triangles[:, corner]] - vertices[0] for corner in range(3))
    return float(np.einsum("mk,mk->", a, cross(b, c)))


def circle_points(count: int, first: FloatArray, second: FloatArray) -> FloatArray:
    """Return points of a circle in the plane of two axes, half a side away from the first, shape (count, 3)."""
    angles = (np.arange(count) + 0.5) * 2.0 * math.pi / count
    return np.cos(angles)[:, None] * first + np.sin(angles)[:, None] * second


def two_across(axis: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return two unit vectors across an axis, at right angles."""
    along = axis / np.linalg.norm(axis)
    helper = np.array([1.0, 0.0, 0.0]) if abs(along[0]) < 0.9 else np.array([0.0, 1.0, 0.0])
    first = helper - (helper @ along) * along
    first /= np.linalg.norm(first)
    return first, cross(along, first)


def tangents_of(path: FloatArray, *, closed: bool) -> FloatArray:
    """Return the direction of a line at each of its points."""
    steps = np.roll(path, -1, axis=0) - np.roll(path, 1, axis=0) if closed else np.gradient(path, axis=0)
    return np.asarray(steps / np.linalg.norm(steps, axis=1)[:, None])


@lru_cache(maxsize=1)
def unit_box() -> tuple[FloatArray, IntArray]:
    """Return the corners of the box from -1 to 1 and its 12 triangles."""
    signs = _signs()
    quads: list[IntArray] = []
    for axis in range(3):
        quads.extend(np.flatnonzero(signs[:, axis] == sign)[[0, 1, 3, 2]] for sign in (-1.0, 1.0))
    return signs, _outward(signs, np.concatenate([[quad[[0, 1, 2]], quad[[0, 2, 3]]] for quad in quads]))


@lru_cache(maxsize=1)
def bevelled_box() -> tuple[FloatArray, IntArray]:
    """Return signs of the corners and triangles over vertices ``3 × corner + axis of the face it lies on``."""
    signs = _signs()
    quads: list[IntArray] = []
    for axis in range(3):
        quads.extend(3 * np.flatnonzero(signs[:, axis] == sign)[[0, 1, 3, 2]] + axis for sign in (-1.0, 1.0))
        one, two = (axis + 1) % 3, (axis + 2) % 3
        for start in np.flatnonzero(signs[:, axis] < 0.0).tolist():
            end = start + (4, 2, 1)[axis]
            quads.append(np.array([3 * start + one, 3 * end + one, 3 * end + two, 3 * start + two]))
    corners = [np.arange(3) + 3 * corner for corner in range(8)]
    places = np.concatenate([*([quad[[0, 1, 2]], quad[[0, 2, 3]]] for quad in quads), corners])
    vertices = (signs[:, None, :] * (1.0 - 0.2 * (1.0 - np.eye(3))[None])).reshape(-1, 3)
    return signs, _outward(vertices, places)


def _signs() -> FloatArray:
    """Return the corners of the cube from -1 to 1, z running fastest, shape (8, 3)."""
    return np.stack(np.meshgrid([-1.0, 1.0], [-1.0, 1.0], [-1.0, 1.0], indexing="ij"), axis=-1).reshape(8, 3)


def _outward(vertices: FloatArray, triangles: IntArray) -> IntArray:
    """Return the triangles of a convex body about the origin, turned outward."""
    a, b, c = (vertices[triangles[:, corner]] for corner in range(3))
    inward = np.einsum("mk,mk->m", cross(b - a, c - a), a + b + c) < 0.0
    return np.where(inward[:, None], triangles[:, ::-1], triangles)
