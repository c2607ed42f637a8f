"""Textures with their mip maps, the ground with its averages, and surfaces, packed for the shader."""

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.rendering.ground import GroundMap
from reasoned_explorer.rendering.ground_kernels import GroundLooks
from reasoned_explorer.rendering.library import Library, linear_from_srgb
from reasoned_explorer.rendering.scene import Instances
from reasoned_explorer.rendering.shading_kernels import Surfaces
from reasoned_explorer.rendering.shelf import Arrays, kept_arrays
from reasoned_explorer.rendering.texture_kernels import LANE, TEXEL_BITS, Textures
from reasoned_explorer.rendering.textures import TEXTURE_METRES, texture_stack

_FIRST_BLOCK = 4


def textures_of(stack: NDArray[np.float32], metres: NDArray[np.float32]) -> Textures:
    """Return textures with all their levels.

    Args:
        stack: One tileable texture for each material, sRGB in [0, 1], shape (materials, side, side, 3), the side a
            power of two; row 0 is the top.
        metres: How far one repetition reaches, shape (materials,).
    """
    level = linear_from_srgb(np.asarray(stack, np.float32))
    levels, starts, start = [], [], 0
    while True:
        levels.append(level.reshape(-1, 3))
        starts.append(start)
        start += len(levels[-1])
        if level.shape[1] == 1:
            break
        pairs = level.reshape(level.shape[0], level.shape[1] // 2, 2, level.shape[2] // 2, 2, 3)
        level = pairs.mean(axis=(2, 4), dtype=np.float32)
    return Textures(
        _packed(np.concatenate(levels)),
        np.array(starts, np.int64),
        stack.shape[1],
        1.0 / np.asarray(metres, np.float64),
    )


def material_textures() -> Textures:
    """Return the textures of all materials."""

    def made() -> Arrays:
        textures = textures_of(texture_stack(), TEXTURE_METRES)
        return textures.texels, textures.starts, np.array(textures.side), textures.per_metre

    texels, starts, side, per_metre = kept_arrays("textures", made)
    return Textures(texels, starts, int(side), per_metre)


def _packed(colours: NDArray[np.float32]) -> NDArray[np.int64]:
    """Return linear light, shape (n, 3), as the shader reads it: see `Textures`."""
    whole = np.rint(np.clip(colours, 0.0, 1.0) * ((1 << TEXEL_BITS) - 1)).astype(np.int64)
    packed: NDArray[np.int64] = whole[:, 0] | whole[:, 1] << LANE | whole[:, 2] << 2 * LANE
    return packed


def _unpacked(texels: NDArray[np.int64]) -> NDArray[np.float32]:
    """Return what was packed, to half a unit."""
    full = (1 << TEXEL_BITS) - 1
    return np.stack([texels >> k * LANE & full for k in range(3)], axis=-1).astype(np.float32) / np.float32(full)


def ground_looks_of(ground: GroundMap, textures: Textures) -> GroundLooks:
    """Return the ground with averages of its colours over 4, 8, 16 … cells."""
    means = _unpacked(textures.texels[textures.starts[-1] :])
    colours = ground.colours * means[ground.materials]
    level = _block_means(ground.codes, colours)
    levels, layout, start = [], [], 0
    while True:
        rows, columns = level.shape[:2]
        levels.append(level.reshape(-1, 3))
        layout.append((start, rows, columns))
        start += rows * columns
        if min(rows, columns) < 2 * _FIRST_BLOCK:
            break
        even = level[: rows // 2 * 2, : columns // 2 * 2]
        level = even.reshape(rows // 2, 2, columns // 2, 2, 3).mean(axis=(1, 3), dtype=np.float32)
    averages = np.ascontiguousarray(np.concatenate(levels), np.float32)
    return GroundLooks(
        ground.codes,
        np.append(ground.corner, 1.0 / ground.corner[2]),
        ground.materials,
        ground.colours,
        averages,
        np.array(layout, np.int64),
    )


def _block_means(codes: NDArray[np.uint8], colours: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return mean colours of blocks of 4 × 4 cells, of which every other is looked at; edges pad the last ones."""
    rows, columns = (-(-side // _FIRST_BLOCK) for side in codes.shape)
    padded = np.pad(
        codes, ((0, rows * _FIRST_BLOCK - codes.shape[0]), (0, columns * _FIRST_BLOCK - codes.shape[1])), mode="edge"
    )
    total = np.zeros((rows, columns, 3), np.float32)
    for j in range(0, _FIRST_BLOCK, 2):
        for i in range(0, _FIRST_BLOCK, 2):
            total += colours[padded[j::_FIRST_BLOCK, i::_FIRST_BLOCK]]
    total /= np.float32(_FIRST_BLOCK**2 // 4)
    return total


def surfaces_of(library: Library, instances: Instances) -> Surfaces:
    """Return triangles and instances in lines for the shader."""
    corners = library.vertices[library.triangles]
    count = len(corners)
    faces = np.concatenate(
        [
            corners[:, 0],
            *_weight_slopes(corners),
            library.normals.reshape(count, 9),
            library.uvs.reshape(count, 6),
            library.colours,
            library.materials[:, None],
        ],
        axis=1,
        dtype=np.float32,
    )
    stands = np.column_stack([instances.places, instances.turns, 1.0 / instances.scales, instances.tints])
    return Surfaces(np.ascontiguousarray(faces), np.ascontiguousarray(stands, np.float64))


def _weight_slopes(corners: NDArray[np.float32]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return how the weights of triangles' second and third corners grow along each axis, shape (n, 3) each.

    Args:
        corners: Of the triangles, metres, shape (n, 3, 3).
    """
    e, f = (corners[:, k].astype(np.float64) - corners[:, 0] for k in (1, 2))
    ee, ff, ef = (np.einsum("ij,ij->i", a, b)[:, None] for a, b in ((e, e), (f, f), (e, f)))
    inverse = 1.0 / np.maximum(ee * ff - ef * ef, 1e-18)
    return (ff * e - ef * f) * inverse, (ee * f - ef * e) * inverse
