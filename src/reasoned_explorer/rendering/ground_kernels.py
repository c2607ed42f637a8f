"""The light from the ground: the plane z = 0."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.rendering.kernel_types import Codes, Floats, Ints, Packed, Pages, Rgb, Texels, Tiles
from reasoned_explorer.rendering.material import Material
from reasoned_explorer.rendering.shadow_kernels import sunlight_at
from reasoned_explorer.rendering.sky_kernels import SKYLIGHT, SUN, SUNLIGHT, hazed, mirrored
from reasoned_explorer.rendering.texture_kernels import halvings, texel_at
from reasoned_explorer.world.compiling import inlined, part

_WATER = int(Material.WATER)
#: Bits of materials, as in `shading_kernels`: on which rain stands.
_HARD = 1 << Material.ASPHALT | 1 << Material.PAVING | 1 << Material.COBBLES | 1 << Material.CONCRETE
#: Beyond this footprint of a pixel, squared, the ground is drawn from averages of its colours; cells of the ground map.
_FINE_CELLS, _COARSE_CELLS = 2.0**2, 5.0**2


class GroundLooks(NamedTuple):
    """The plane z = 0.

    Attributes:
        codes: Kinds of ground, shape (rows, columns), uint8, rows from south to north.
        corner: West edge, south edge, edge of a cell, metres, and cells a metre, shape (4,).
        materials: Of each kind, uint8.
        colours: Of each kind, linear light, shape (kinds, 3), float32.
        averages: Mean colours in cells of 4, 8, 16 … cells, all levels one after the other, shape (n, 3), float32.
        layout: First cell, rows and columns of each of these levels, shape (levels, 3), int64.
    """

    codes: NDArray[np.uint8]
    corner: NDArray[np.float64]
    materials: NDArray[np.uint8]
    colours: NDArray[np.float32]
    averages: NDArray[np.float32]
    layout: NDArray[np.int64]


@part
def mirror_image(
    nearness: Texels,
    owners: Pages,
    picture: Codes,
    below: int,
    samples: int,
    eye: Floats,
    axes: Floats,
    focal: float,
    centre_x: float,
    centre_y: float,
    x: float,
    y: float,
    rx: float,
    ry: float,
    rz: float,
) -> tuple[float, float, float, float]:
    """What is seen from a point (x, y) of the ground in a direction, as far as it is in the picture and drawn already.

    Returns:
        Linear light, and 1, or 0 where nothing was found. What is mirrored lies above in the picture, whose rows
        before ``below`` are there already.
    """
    step = 0.15
    reach = 0.0
    for _ in range(24):
        reach += step
        step *= 1.22
        qx, qy, qz = x + reach * rx - eye[0], y + reach * ry - eye[1], reach * rz - eye[2]
        depth = qx * axes[2, 0] + qy * axes[2, 1] + qz * axes[2, 2]
        if depth < 0.1:
            break
        scale = focal / depth
        column = math.floor(centre_x + scale * (qx * axes[0, 0] + qy * axes[0, 1] + qz * axes[0, 2]))
        row = math.floor(centre_y + scale * (qx * axes[1, 0] + qy * axes[1, 1] + qz * axes[1, 2]))
        if not (0 <= row < nearness.shape[0] and 0 <= column < nearness.shape[1]):
            break
        seen = nearness[row, column]
        if owners[row, column] >= 0 and seen * depth > 1.0 and (depth - step * 1.5 - 0.2) * seen < 1.0:
            row, column = (row >> 1, column >> 1) if samples == 2 else (row, column)
            if row >= below:
                break
            red, green, blue = picture[row, column, 0], picture[row, column, 1], picture[row, column, 2]
            return red * red / 65025.0, green * green / 65025.0, blue * blue / 65025.0, 1.0
    return 0.0, 0.0, 0.0, 0.0


@part
def _kind_at(codes: Codes, corner: Floats, x: float, y: float) -> int:
    """The kind of ground at a point: the one with most weight among the four nearest cells."""
    rows, columns = codes.shape
    u = (x - corner[0]) * corner[3] - 0.5
    v = (y - corner[1]) * corner[3] - 0.5
    if not (-0.5 <= u <= columns - 0.5 and -0.5 <= v <= rows - 0.5):
        return 0
    left, low = math.floor(u), math.floor(v)
    i0, i1 = max(left, 0), min(left + 1, columns - 1)
    j0, j1 = max(low, 0), min(low + 1, rows - 1)
    a, b, c, d = codes[j0, i0], codes[j0, i1], codes[j1, i0], codes[j1, i1]
    if a == b and a == c and a == d:
        return a
    fu, fv = u - left, v - low
    wa, wb, wc, wd = (1.0 - fu) * (1.0 - fv), fu * (1.0 - fv), (1.0 - fu) * fv, fu * fv
    sum_a = wa + (wb if b == a else 0.0) + (wc if c == a else 0.0) + (wd if d == a else 0.0)
    sum_b = wb + (wa if a == b else 0.0) + (wc if c == b else 0.0) + (wd if d == b else 0.0)
    sum_c = wc + (wa if a == c else 0.0) + (wb if b == c else 0.0) + (wd if d == c else 0.0)
    sum_d = wd + (wa if a == d else 0.0) + (wb if b == d else 0.0) + (wc if c == d else 0.0)
    kind, most = a, sum_a
    if sum_b > most:
        kind, most = b, sum_b
    if sum_c > most:
        kind, most = c, sum_c
    return d if sum_d > most else kind


@part
def _average_at(corner: Floats, averages: Texels, layout: Ints, x: float, y: float, cells: float) -> Rgb:
    """The mean colour of the ground around a point, over about so many cells across, squared."""
    level = halvings(cells * 0.35**2, layout.shape[0] - 1)[0]
    start, rows, columns = layout[level, 0], layout[level, 1], layout[level, 2]
    edge = corner[2] * (4 << level)
    u = min(max((x - corner[0]) / edge - 0.5, 0.0), columns - 1.0)
    v = min(max((y - corner[1]) / edge - 0.5, 0.0), rows - 1.0)
    left, low = int(u), int(v)
    i1, j1 = min(left + 1, columns - 1), min(low + 1, rows - 1)
    fu, fv = u - left, v - low
    a, b = start + low * columns + left, start + low * columns + i1
    c, d = start + j1 * columns + left, start + j1 * columns + i1
    wa, wb, wc, wd = (1.0 - fu) * (1.0 - fv), fu * (1.0 - fv), (1.0 - fu) * fv, fu * fv
    t = averages
    return (
        wa * t[a, 0] + wb * t[b, 0] + wc * t[c, 0] + wd * t[d, 0],
        wa * t[a, 1] + wb * t[b, 1] + wc * t[c, 1] + wd * t[d, 1],
        wa * t[a, 2] + wb * t[b, 2] + wc * t[c, 2] + wd * t[d, 2],
    )


@inlined
def ground_light(
    codes: Codes,
    corner: Floats,
    materials: Codes,
    colours: Texels,
    averages: Texels,
    layout: Ints,
    texels: Packed,
    starts: Ints,
    per_metre: Floats,
    size: int,
    tones: Floats,
    clouds: Texels,
    shadow: float,
    soft: bool,
    wetness: float,
    frame: Floats,
    fine_pages: Pages,
    fine: Tiles,
    fine_limits: Tiles,
    coarse_pages: Pages,
    coarse: Tiles,
    coarse_limits: Tiles,
    wanted: Codes,
    mirror: tuple[float, float, float, float],
    x: float,
    y: float,
    distance: float,
    haze: float,
    dx: float,
    dy: float,
    dz: float,
    pixel: float,
    footprint_m2: float,
) -> Rgb:
    """The light from a point of the ground; (dx, dy, dz) is where the eye looks, of length 1."""
    lift = max(-dz, 1e-4)
    cells = footprint_m2 * corner[3] * corner[3]
    kind = _kind_at(codes, corner, x, y)
    material = materials[kind] + 0  # a wide number, as in `_surface`: numba compiles a function once for each type
    red, green, blue = float(colours[kind, 0]), float(colours[kind, 1]), float(colours[kind, 2])
    if cells < _COARSE_CELLS:
        texel = texel_at(texels, starts, per_metre, size, material, x, y, footprint_m2)
        red, green, blue = red * texel[0], green * texel[1], blue * texel[2]
    inside = kind != 0
    if cells > _FINE_CELLS and inside:
        share = min(1.0, (cells - _FINE_CELLS) / (_COARSE_CELLS - _FINE_CELLS))
        mean = _average_at(corner, averages, layout, x, y, cells)
        red += share * (mean[0] - red)
        green += share * (mean[1] - green)
        blue += share * (mean[2] - blue)
    lit = sunlight_at(
        frame,
        fine_pages,
        fine,
        fine_limits,
        coarse_pages,
        coarse,
        coarse_limits,
        soft,
        wanted,
        x,
        y,
        0.0,
        0.0,
        0.0,
        1.0,
        distance,
        pixel,
    )
    lit = tones[SUN, 2] * (1.0 - shadow * (1.0 - lit))
    wet = 0.0
    if wetness > 0.0 and material != _WATER:
        wet = wetness if _HARD >> material & 1 else 0.25 * wetness
        dark = 1.0 - 0.4 * wet
        red, green, blue = red * dark, green * dark, blue * dark
    colour = (
        red * (tones[SKYLIGHT, 0] + lit * tones[SUNLIGHT, 0]),
        green * (tones[SKYLIGHT, 1] + lit * tones[SUNLIGHT, 1]),
        blue * (tones[SKYLIGHT, 2] + lit * tones[SUNLIGHT, 2]),
    )
    if material == _WATER or wet > 0.0:
        graze = 1.0 - lift
        graze *= graze
        share = 0.06 + 0.75 * graze * graze if material == _WATER else wet * (0.04 + 0.6 * graze * graze)
        if mirror[3] > 0.0:
            colour = (
                colour[0] + share * (mirror[0] - colour[0]),
                colour[1] + share * (mirror[1] - colour[1]),
                colour[2] + share * (mirror[2] - colour[2]),
            )
        else:
            colour = mirrored(tones, clouds, colour, share, dx, dy, -dz)
    return hazed(tones, haze, colour, dx, dy, dz)
