"""What the sun does not reach.

A shadow map that lies on the ground: for a point of the ground it keeps how high the highest thing is that takes the
sun from it. Whatever else is on the same sunbeam (a wall, a branch) is dark where it is lower than that. Seen this
way shadows are equally sharp whatever the sun's height, level surfaces need no bias, and heights are small integers.
The map is cut into square tiles of two sizes; what a tile holds depends on the scene and the sun alone.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.rendering.library import Library
from reasoned_explorer.rendering.scene import Instances
from reasoned_explorer.world.compiling import inlined, kernel

#: Texels along the side of a tile; around them `MARGIN` more, so that a look-up needs no second tile.
_SHIFT = 8
SIDE, MARGIN = 1 << _SHIFT, 2
#: Edge of a texel of a fine and of a coarse tile, metres.
FINE_M, COARSE_M = 0.0625, 0.25
_PER_FINE, _PER_COARSE = 16.0, 4.0
#: No shadow is drawn farther from the eye than this; they fade out before.
REACH_M, FADE_M = 420.0, 320.0
#: Fine tiles are used up to this distance at most.
_FINE_REACH_M = 48.0
_PER_METRE = 100.0  # heights are kept in centimetres, plus 1; 0 is nothing
_BIAS_M = 0.025
#: Texels along the side of a tile's block, of which the lowest and the highest are known; a look-up takes so many.
_BLOCK_SHIFT, _TAPS = 3, 4
BLOCKS = (SIDE >> _BLOCK_SHIFT) + 1


class ShadowMaps(NamedTuple):
    """Tiles and where they lie.

    Attributes:
        frame: South-west corner of both page tables on the ground, metres, and how far a shadow falls to the east and
            to the north for each metre of height, shape (4,).
        fine_pages: Place of each fine tile in ``fine``, or -1, shape (rows, columns), int32.
        fine: Heights, shape (tiles, SIDE + 2 · MARGIN, likewise), uint16.
        fine_limits: The lowest and the highest that any look-up finds which begins in a block of 8 × 8 texels, shape
            (tiles, BLOCKS, BLOCKS, 2), uint16: most places are all in the sun or all in the shade.
        coarse_pages: Likewise.
        coarse: Likewise.
        coarse_limits: Likewise.
    """

    frame: NDArray[np.float64]
    fine_pages: NDArray[np.int32]
    fine: NDArray[np.uint16]
    fine_limits: NDArray[np.uint16]
    coarse_pages: NDArray[np.int32]
    coarse: NDArray[np.uint16]
    coarse_limits: NDArray[np.uint16]


@inlined
def _filtered(
    tiles: NDArray[np.uint16], limits: NDArray[np.uint16], page: int, u: float, v: float, height: int
) -> float:
    """The share of 3 × 3 texels around a point (in texels) that nothing higher than ``height`` darkens, smoothly."""
    left, low = math.floor(u), math.floor(v)
    first, row = left + MARGIN - 1, low + MARGIN - 1
    if limits[page, row >> _BLOCK_SHIFT, first >> _BLOCK_SHIFT, 1] <= height:
        return 1.0
    if limits[page, row >> _BLOCK_SHIFT, first >> _BLOCK_SHIFT, 0] > height:
        return 0.0
    lit = 0
    fu, fv = u - left, v - low
    total = 0.0
    for j in range(4):
        outer_left = 1 if tiles[page, row + j, first] <= height else 0
        inner = 1 if tiles[page, row + j, first + 1] <= height else 0
        inner += 1 if tiles[page, row + j, first + 2] <= height else 0
        outer_right = 1 if tiles[page, row + j, first + 3] <= height else 0
        lit += outer_left + inner + outer_right
        weight = 1.0 - fv if j == 0 else (fv if j == 3 else 1.0)
        total += weight * (outer_left * (1.0 - fu) + inner + outer_right * fu)
    if lit == 16:
        return 1.0
    return total * (1.0 / 9.0)


@inlined
def sunlight_at(
    frame: NDArray[np.float64],
    fine_pages: NDArray[np.int32],
    fine_tiles: NDArray[np.uint16],
    fine_limits: NDArray[np.uint16],
    coarse_pages: NDArray[np.int32],
    coarse_tiles: NDArray[np.uint16],
    coarse_limits: NDArray[np.uint16],
    soft: bool,
    wanted: NDArray[np.uint8],
    x: float,
    y: float,
    z: float,
    nx: float,
    ny: float,
    nz: float,
    distance: float,
    pixel: float,
) -> float:
    """The share of the sun's light that reaches a point, in [0, 1].

    Args:
        frame: This and the next six are those of `ShadowMaps`.
        fine_pages: Likewise.
        fine_tiles: Likewise.
        fine_limits: Likewise.
        coarse_pages: Likewise.
        coarse_tiles: Likewise.
        coarse_limits: Likewise.
        soft: Whether coarse tiles do everywhere.
        wanted: Byte 0 is set where a tile is missing, and the byte of the tile: 1 + its place in the fine page table,
            then in the coarse one.
        x: East, metres.
        y: North.
        z: Height.
        nx: The surface's direction; the point is moved off the surface so that it does not darken itself.
        ny: Likewise.
        nz: Likewise.
        distance: From the eye, metres.
        pixel: Angle of a pixel, radians.
    """
    if distance > REACH_M:
        return 1.0
    fine = not soft and distance < _FINE_REACH_M and distance * pixel < 0.22
    texel = FINE_M if fine else COARSE_M
    # For a plane this is exactly what the widest texel of the filter needs, whatever the angle of the sun.
    offset = 0.01 + 2.0 * texel * (abs(nx) + abs(ny))
    x += offset * nx
    y += offset * ny
    z += offset * nz
    ground_x = x + z * frame[2] - frame[0]
    ground_y = y + z * frame[3] - frame[1]
    per_texel = _PER_FINE if fine else _PER_COARSE
    u, v = ground_x * per_texel, ground_y * per_texel
    column, row = math.floor(u) >> _SHIFT, math.floor(v) >> _SHIFT
    rows, columns = fine_pages.shape if fine else coarse_pages.shape
    if not (0 <= row < rows and 0 <= column < columns):
        return 1.0
    page = fine_pages[row, column] if fine else coarse_pages[row, column]
    if page < 0:
        wanted[0] = 1
        wanted[1 + row * columns + column + (0 if fine else fine_pages.size)] = 1
        return 1.0
    u -= column * SIDE + 0.5
    v -= row * SIDE + 0.5
    height = int((z + _BIAS_M) * _PER_METRE) + 1
    if fine:
        share = _filtered(fine_tiles, fine_limits, page, u, v, height)
    else:
        share = _filtered(coarse_tiles, coarse_limits, page, u, v, height)
    if distance > FADE_M:
        share += (1.0 - share) * (distance - FADE_M) / (REACH_M - FADE_M)
    return share


@inlined
def _cast_triangle(corners: NDArray[np.float64], a: int, b: int, c: int, tile: NDArray[np.uint16]) -> None:
    """Raise a tile's heights by a triangle, half a texel wider than it is so that thin things have shadows too."""
    xa, ya, za = corners[a, 0], corners[a, 1], corners[a, 2]
    xb, yb, zb = corners[b, 0], corners[b, 1], corners[b, 2]
    xc, yc, zc = corners[c, 0], corners[c, 1], corners[c, 2]
    side = tile.shape[0]
    first_x, last_x = math.ceil(min(xa, min(xb, xc)) - 1.0), math.floor(max(xa, max(xb, xc)))
    first_y, last_y = math.ceil(min(ya, min(yb, yc)) - 1.0), math.floor(max(ya, max(yb, yc)))
    if first_x >= side or last_x < 0 or first_y >= side or last_y < 0:
        return
    area = (xb - xa) * (yc - ya) - (xc - xa) * (yb - ya)
    if area < 0.0:
        xb, yb, zb, xc, yc, zc = xc, yc, zc, xb, yb, zb
        area = -area
    first_x, last_x, first_y, last_y = max(first_x, 0), min(last_x, side - 1), max(first_y, 0), min(last_y, side - 1)
    low, high = min(za, min(zb, zc)), max(za, max(zb, zc))
    if area < 1e-9:  # seen from its edge: a line
        slope_x, slope_y = 0.0, 0.0
        za = high
    else:
        slope_x = ((zb - za) * (yc - ya) - (zc - za) * (yb - ya)) / area
        slope_y = ((zc - za) * (xb - xa) - (zb - za) * (xc - xa)) / area
    ab = 0.5 * (abs(xb - xa) + abs(yb - ya))
    bc = 0.5 * (abs(xc - xb) + abs(yc - yb))
    ca = 0.5 * (abs(xa - xc) + abs(ya - yc))
    for row in range(first_y, last_y + 1):
        y = row + 0.5
        for column in range(first_x, last_x + 1):
            x = column + 0.5
            if (xb - xa) * (y - ya) - (yb - ya) * (x - xa) < -ab:
                continue
            if (xc - xb) * (y - yb) - (yc - yb) * (x - xb) < -bc:
                continue
            if (xa - xc) * (y - yc) - (ya - yc) * (x - xc) < -ca:
                continue
            z = min(max(za + slope_x * (x - xa) + slope_y * (y - ya), low), high)
            height = int(min(z, 650.0) * _PER_METRE) + 1 if z > 0.0 else 0
            tile[row, column] = max(tile[row, column], height)


@inlined
def _limit(tile: NDArray[np.uint16], limits: NDArray[np.uint16]) -> None:
    """Set the lowest and the highest of each block and of as much after it as a look-up takes."""
    for j in range(BLOCKS):
        for i in range(BLOCKS):
            lowest, highest = tile[j << _BLOCK_SHIFT, i << _BLOCK_SHIFT], tile[j << _BLOCK_SHIFT, i << _BLOCK_SHIFT]
            for row in range(j << _BLOCK_SHIFT, min((j + 1 << _BLOCK_SHIFT) + _TAPS - 1, tile.shape[0])):
                for column in range(i << _BLOCK_SHIFT, min((i + 1 << _BLOCK_SHIFT) + _TAPS - 1, tile.shape[1])):
                    lowest, highest = min(lowest, tile[row, column]), max(highest, tile[row, column])
            limits[j, i, 0], limits[j, i, 1] = lowest, highest


@kernel
def cast(
    library: Library,
    instances: Instances,
    footprints: NDArray[np.float64],
    shear: NDArray[np.float64],
    west: float,
    south: float,
    texel: float,
    coarser: int,
    corners: NDArray[np.float64],
    tile: NDArray[np.uint16],
    limits: NDArray[np.uint16],
) -> None:
    """Set a tile.

    Args:
        library: Models.
        instances: Where they stand.
        footprints: West, south, east and north end of each instance's shadow, shape (n, 4), metres; one that casts
            none ends before it begins.
        shear: Of the shadow maps.
        west: West edge of the tile without its margin, metres.
        south: South edge, likewise.
        texel: Edge of a texel, metres.
        coarser: How many levels coarser than the finest things are drawn, where they have so many.
        corners: Room, shape (v, 3).
        tile: Set, shape (SIDE + 2 · MARGIN, likewise).
        limits: Set, shape (BLOCKS, BLOCKS, 2); see `ShadowMaps`.
    """
    tile[:] = 0
    edge = (SIDE + MARGIN + 1) * texel
    pad = (MARGIN + 1) * texel
    for i in range(footprints.shape[0]):
        if footprints[i, 2] < west - pad or footprints[i, 0] > west + edge:
            continue
        if footprints[i, 3] < south - pad or footprints[i, 1] > south + edge:
            continue
        prototype = instances.prototypes[i]
        level = library.prototypes[prototype, 0] + min(coarser, library.prototypes[prototype, 1] - 1)
        sine, cosine = instances.turns[i, 0], instances.turns[i, 1]
        first = library.levels[level, 0]
        for k in range(library.levels[level, 1]):
            a = library.vertices[first + k, 0] * instances.scales[i, 0]
            b = library.vertices[first + k, 1] * instances.scales[i, 1]
            z = library.vertices[first + k, 2] * instances.scales[i, 2] + instances.places[i, 2]
            x = a * cosine + b * sine + instances.places[i, 0]
            y = b * cosine - a * sine + instances.places[i, 1]
            corners[k, 0] = (x + z * shear[0] - west) / texel + MARGIN
            corners[k, 1] = (y + z * shear[1] - south) / texel + MARGIN
            corners[k, 2] = z
        for triangle in range(library.levels[level, 2], library.levels[level, 2] + library.levels[level, 3]):
            _cast_triangle(
                corners,
                library.triangles[triangle, 0] - first,
                library.triangles[triangle, 1] - first,
                library.triangles[triangle, 2] - first,
                tile,
            )
    _limit(tile, limits)
