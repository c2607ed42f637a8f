"""What light comes from every pixel: one evaluation for each surface that a pixel shows, after it is known which.

All colours are linear light; `develop` makes bytes of them.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.rendering.material import Material
from reasoned_explorer.rendering.projection import Projection
from reasoned_explorer.rendering.raster_kernels import GROUND, SKY, Canvas
from reasoned_explorer.rendering.shadow_kernels import ShadowMaps, sunlight_at
from reasoned_explorer.world.compiling import inlined, kernel, part

Rgb = tuple[float, float, float]
Codes = NDArray[np.uint8]
Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Texels = NDArray[np.float32]
Pages = NDArray[np.int32]
Tiles = NDArray[np.uint16]
_WATER, _FOLIAGE, _PAINT, _LIT = int(Material.WATER), int(Material.FOLIAGE), int(Material.PAINT), int(Material.GLOW)
_GLASS, _FACADE_GLASS = int(Material.GLASS), int(Material.FACADE_GLASS)
_ASPHALT, _PAVING = int(Material.ASPHALT), int(Material.PAVING)
_COBBLES, _CONCRETE = int(Material.COBBLES), int(Material.CONCRETE)
#: Beyond this footprint of a pixel the ground is drawn from averages of its colours, in cells of the ground map.
_FINE_CELLS, _COARSE_CELLS = 2.0, 5.0


class Textures(NamedTuple):
    """A stack of tileable textures with their mip maps.

    Attributes:
        texels: Linear light, all levels one after the other, in each all materials, shape (n, 3), float32.
        starts: First texel of each level, int64.
        side: Texels along the side of the finest level, a power of two.
        per_metre: Repetitions a metre of each material, float64.
    """

    texels: NDArray[np.float32]
    starts: NDArray[np.int64]
    side: int
    per_metre: NDArray[np.float64]


class Surfaces(NamedTuple):
    """What the shader needs to know of triangles and of where they stand, each in one line of memory.

    Attributes:
        faces: Of each triangle of the library: first corner, the edges from it to the second and to the third, normals
            and texture coordinates at the corners, colour in linear light, material; shape (t, 28), float32.
        stands: Of each instance: place, sine and cosine of its heading, 1 / scale, tint; shape (n, 11), float64.
    """

    faces: NDArray[np.float32]
    stands: NDArray[np.float64]


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


class Light(NamedTuple):
    """Sun, sky and air.

    Attributes:
        tones: Linear-light colours and a direction, shape (8, 3), float64; the rows are this module's constants.
        clouds: How dense clouds are, tileable, shape (n, n), n a power of two, float32, in [0, 1].
        haze_m: Distance at which haze takes the share 1 - 1/e.
        shadow: How much of the sunlight shadows take, in [0, 1].
        soft: Whether shadows are drawn from coarse tiles alone.
        wetness: How wet level ground is, in [0, 1].
        lamps: How bright glowing things are.
    """

    tones: NDArray[np.float64]
    clouds: NDArray[np.float32]
    haze_m: float
    shadow: float
    soft: bool
    wetness: float
    lamps: float


#: Rows of `Light.tones`: the direction to the sun (ENU, of length 1); what a surface gets of the sun that faces it, of
#: the sky above, of the ground below; the sky above and at the horizon; what is added around the sun; clouds.
SUN, SUNLIGHT, SKYLIGHT, BOUNCE, ZENITH, HORIZON, GLOW, CLOUD = range(8)


@part
def _halvings(size: float, most: int) -> tuple[int, float]:
    """How often a size can be halved until it is below 2, at most ``most`` times, and what is left, at least 1."""
    count = 0
    while size >= 2.0 and count < most:
        size *= 0.5
        count += 1
    return count, min(max(size, 1.0), 2.0)


@part
def _level_texel(t: Texels, starts: Ints, size: int, material: int, u: float, v: float, level: int) -> Rgb:
    """A texture's colour, bilinear in one level; u and v count repetitions."""
    side = size >> level
    x = (u - math.floor(u)) * side - 0.5
    y = (1.0 - (v - math.floor(v))) * side - 0.5
    left, top = math.floor(x), math.floor(y)
    fx, fy = x - left, y - top
    mask = side - 1
    start = starts[level] + material * side * side
    row0, row1 = start + (top & mask) * side, start + ((top + 1) & mask) * side
    column0, column1 = left & mask, (left + 1) & mask
    w00, w01, w10, w11 = (1.0 - fx) * (1.0 - fy), fx * (1.0 - fy), (1.0 - fx) * fy, fx * fy
    a, b, c, d = row0 + column0, row0 + column1, row1 + column0, row1 + column1
    return (
        w00 * t[a, 0] + w01 * t[b, 0] + w10 * t[c, 0] + w11 * t[d, 0],
        w00 * t[a, 1] + w01 * t[b, 1] + w10 * t[c, 1] + w11 * t[d, 1],
        w00 * t[a, 2] + w01 * t[b, 2] + w10 * t[c, 2] + w11 * t[d, 2],
    )


@part
def _texel(
    texels: Texels,
    starts: Ints,
    per_metre: Floats,
    size: int,
    material: int,
    u_m: float,
    v_m: float,
    footprint_m: float,
) -> Rgb:
    """A texture's colour at a place on a surface, blurred to the pixel's footprint there."""
    scale = per_metre[material]
    last = starts.shape[0] - 1
    level, wide = _halvings(footprint_m * scale * size, last)
    u, v = u_m * scale, v_m * scale
    red, green, blue = _level_texel(texels, starts, size, material, u, v, level)
    # Two levels are mixed in the middle of the way from one to the next: elsewhere one is near enough.
    part = 2.5 * wide - 3.25
    if part > 0.0 and level < last:
        part = min(part, 1.0)
        other = _level_texel(texels, starts, size, material, u, v, level + 1)
        red += part * (other[0] - red)
        green += part * (other[1] - green)
        blue += part * (other[2] - blue)
    return red, green, blue


@part
def _sky(tones: Floats, clouds: Texels, x: float, y: float, z: float) -> Rgb:
    """The sky in a direction of length 1."""
    up = max(z, 0.0)
    low = (1.0 - up) * (1.0 - up)
    low *= low
    red = tones[ZENITH, 0] + low * (tones[HORIZON, 0] - tones[ZENITH, 0])
    green = tones[ZENITH, 1] + low * (tones[HORIZON, 1] - tones[ZENITH, 1])
    blue = tones[ZENITH, 2] + low * (tones[HORIZON, 2] - tones[ZENITH, 2])
    near = max(0.0, x * tones[SUN, 0] + y * tones[SUN, 1] + z * tones[SUN, 2])
    glow = near * near
    glow *= glow
    glow = 0.35 * glow + 0.65 * glow * glow * glow * glow
    red += glow * tones[GLOW, 0]
    green += glow * tones[GLOW, 1]
    blue += glow * tones[GLOW, 2]
    if z > 0.01:
        side = clouds.shape[0]
        mask = side - 1
        spread = 0.35 * side / (z + 0.12)
        u, v = x * spread, y * spread
        left, top = math.floor(u), math.floor(v)
        fu, fv = u - left, v - top
        i0, i1, j0, j1 = left & mask, (left + 1) & mask, top & mask, (top + 1) & mask
        c = clouds
        cover = (1.0 - fv) * ((1.0 - fu) * c[j0, i0] + fu * c[j0, i1]) + fv * ((1.0 - fu) * c[j1, i0] + fu * c[j1, i1])
        cover *= min(1.0, (z - 0.01) * 6.0)
        red += cover * (tones[CLOUD, 0] - red)
        green += cover * (tones[CLOUD, 1] - green)
        blue += cover * (tones[CLOUD, 2] - blue)
    return red, green, blue


@part
def _hazed(tones: Floats, haze_m: float, colour: Rgb, distance: float, x: float, y: float, z: float) -> Rgb:
    """What is left of a colour after the air before it; the direction is of length 1."""
    thick = distance / haze_m
    # The first terms of an exponential: the same to the last bit on every processor.
    share = 1.0 - 1.0 / (1.0 + thick * (1.0 + thick * (0.5 + thick * (1.0 / 6.0 + thick * (1.0 / 24.0)))))
    near = max(0.0, x * tones[SUN, 0] + y * tones[SUN, 1] + z * tones[SUN, 2])
    glow = 0.5 * near * near * near * near
    return (
        colour[0] + share * (tones[HORIZON, 0] + glow * tones[GLOW, 0] - colour[0]),
        colour[1] + share * (tones[HORIZON, 1] + glow * tones[GLOW, 1] - colour[1]),
        colour[2] + share * (tones[HORIZON, 2] + glow * tones[GLOW, 2] - colour[2]),
    )


@part
def _mirrored(tones: Floats, clouds: Texels, colour: Rgb, share: float, x: float, y: float, z: float) -> Rgb:
    """A colour with a share of what is seen of the surroundings in a mirrored direction."""
    seen = _sky(tones, clouds, x, y, abs(z))
    if z < 0.0:
        dim = 0.35
        seen = (seen[0] * dim, seen[1] * dim, seen[2] * dim)
    return (
        colour[0] + share * (seen[0] - colour[0]),
        colour[1] + share * (seen[1] - colour[1]),
        colour[2] + share * (seen[2] - colour[2]),
    )


@part
def _mirror_image(
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
    """The mean colour of the ground around a point, over about so many cells across."""
    level = _halvings(cells * 0.35, layout.shape[0] - 1)[0]
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
def _ground(
    codes: Codes,
    corner: Floats,
    materials: Codes,
    colours: Texels,
    averages: Texels,
    layout: Ints,
    texels: Texels,
    starts: Ints,
    per_metre: Floats,
    size: int,
    tones: Floats,
    clouds: Texels,
    haze_m: float,
    shadow: float,
    soft: bool,
    wetness: float,
    frame: Floats,
    fine_pages: Pages,
    fine: Tiles,
    coarse_pages: Pages,
    coarse: Tiles,
    wanted: Codes,
    mirror: tuple[float, float, float, float],
    x: float,
    y: float,
    distance: float,
    dx: float,
    dy: float,
    dz: float,
    pixel: float,
) -> Rgb:
    """The light from a point of the ground; (dx, dy, dz) is where the eye looks, of length 1."""
    lift = max(-dz, 1e-4)
    footprint = distance * pixel / math.sqrt(lift)
    cells = footprint * corner[3]
    kind = _kind_at(codes, corner, x, y)
    material = materials[kind] + 0  # a wide number, as in `_surface`: numba compiles a function once for each type
    red, green, blue = float(colours[kind, 0]), float(colours[kind, 1]), float(colours[kind, 2])
    if cells < _COARSE_CELLS:
        texel = _texel(texels, starts, per_metre, size, material, x, y, footprint)
        red, green, blue = red * texel[0], green * texel[1], blue * texel[2]
    inside = kind != 0
    if cells > _FINE_CELLS and inside:
        share = min(1.0, (cells - _FINE_CELLS) / (_COARSE_CELLS - _FINE_CELLS))
        mean = _average_at(corner, averages, layout, x, y, cells)
        red += share * (mean[0] - red)
        green += share * (mean[1] - green)
        blue += share * (mean[2] - blue)
    lit = sunlight_at(
        frame, fine_pages, fine, coarse_pages, coarse, soft, wanted, x, y, 0.0, 0.0, 0.0, 1.0, distance, pixel
    )
    lit = tones[SUN, 2] * (1.0 - shadow * (1.0 - lit))
    wet = 0.0
    if wetness > 0.0 and material != _WATER:
        wet = wetness if material in (_ASPHALT, _PAVING, _COBBLES, _CONCRETE) else 0.25 * wetness
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
            colour = _mirrored(tones, clouds, colour, share, dx, dy, -dz)
    return _hazed(tones, haze_m, colour, distance, dx, dy, dz)


@inlined
def _surface(
    faces: Texels,
    stands: Floats,
    texels: Texels,
    starts: Ints,
    per_metre: Floats,
    size: int,
    tones: Floats,
    clouds: Texels,
    haze_m: float,
    shadow: float,
    soft: bool,
    lamps: float,
    frame: Floats,
    fine_pages: Pages,
    fine: Tiles,
    coarse_pages: Pages,
    coarse: Tiles,
    wanted: Codes,
    i: int,
    t: int,
    px: float,
    py: float,
    pz: float,
    distance: float,
    dx: float,
    dy: float,
    dz: float,
    pixel: float,
) -> Rgb:
    """The light from a point of a thing's triangle; (dx, dy, dz) is where the eye looks, of length 1."""
    sine, cosine = stands[i, 3], stands[i, 4]
    sx, sy, sz = stands[i, 5], stands[i, 6], stands[i, 7]  # reciprocals
    ox, oy, oz = px - stands[i, 0], py - stands[i, 1], pz - stands[i, 2]
    # Where the point lies in the triangle: the weights of its corners.
    qx, qy, qz = (ox * cosine - oy * sine) * sx - faces[t, 0], (ox * sine + oy * cosine) * sy - faces[t, 1], oz * sz
    qz -= faces[t, 2]
    ex, ey, ez = faces[t, 3], faces[t, 4], faces[t, 5]
    fx, fy, fz = faces[t, 6], faces[t, 7], faces[t, 8]
    ee, ff, ef = ex * ex + ey * ey + ez * ez, fx * fx + fy * fy + fz * fz, ex * fx + ey * fy + ez * fz
    qe, qf = qx * ex + qy * ey + qz * ez, qx * fx + qy * fy + qz * fz
    inverse = 1.0 / max(ee * ff - ef * ef, 1e-18)
    w1 = min(max((ff * qe - ef * qf) * inverse, 0.0), 1.0)
    w2 = min(max((ee * qf - ef * qe) * inverse, 0.0), 1.0)
    w0 = 1.0 - w1 - w2
    mx = (w0 * faces[t, 9] + w1 * faces[t, 12] + w2 * faces[t, 15]) * sx
    my = (w0 * faces[t, 10] + w1 * faces[t, 13] + w2 * faces[t, 16]) * sy
    nz = (w0 * faces[t, 11] + w1 * faces[t, 14] + w2 * faces[t, 17]) * sz
    nx, ny = mx * cosine + my * sine, my * cosine - mx * sine
    length = 1.0 / math.sqrt(nx * nx + ny * ny + nz * nz + 1e-20)
    nx, ny, nz = nx * length, ny * length, nz * length
    facing = -(nx * dx + ny * dy + nz * dz)
    u = w0 * faces[t, 18] + w1 * faces[t, 20] + w2 * faces[t, 22]
    w = w0 * faces[t, 19] + w1 * faces[t, 21] + w2 * faces[t, 23]
    material = int(faces[t, 27])
    footprint = distance * pixel / math.sqrt(max(facing, 0.05))
    red, green, blue = _texel(texels, starts, per_metre, size, material, u, w, footprint)
    red *= faces[t, 24]
    green *= faces[t, 25]
    blue *= faces[t, 26]
    if material in (_PAINT, _FOLIAGE):
        red *= stands[i, 8]
        green *= stands[i, 9]
        blue *= stands[i, 10]
    if material == _LIT:
        return _hazed(tones, haze_m, (red * lamps, green * lamps, blue * lamps), distance, dx, dy, dz)
    slant = nx * tones[SUN, 0] + ny * tones[SUN, 1] + nz * tones[SUN, 2]
    if material == _FOLIAGE:  # leaves let some light through
        slant = max(0.3 + 0.7 * slant, -0.45 * slant)
    lit = 0.0
    if slant > 0.0:
        lit = sunlight_at(
            frame, fine_pages, fine, coarse_pages, coarse, soft, wanted, px, py, pz, nx, ny, nz, distance, pixel
        )
        lit = slant * (1.0 - shadow * (1.0 - lit))
    up = 0.5 + 0.5 * nz
    near_ground = 0.72 + 0.28 * min(1.0, pz / 1.2)  # less of the sky is seen close to the ground
    colour = (
        red
        * (near_ground * (tones[BOUNCE, 0] + up * (tones[SKYLIGHT, 0] - tones[BOUNCE, 0])) + lit * tones[SUNLIGHT, 0]),
        green
        * (near_ground * (tones[BOUNCE, 1] + up * (tones[SKYLIGHT, 1] - tones[BOUNCE, 1])) + lit * tones[SUNLIGHT, 1]),
        blue
        * (near_ground * (tones[BOUNCE, 2] + up * (tones[SKYLIGHT, 2] - tones[BOUNCE, 2])) + lit * tones[SUNLIGHT, 2]),
    )
    if material in (_GLASS, _FACADE_GLASS, _WATER, _PAINT):
        graze = 1.0 - max(facing, 0.0)
        graze *= graze
        graze *= graze
        share = 0.03 + 0.4 * graze if material == _PAINT else 0.15 + 0.65 * graze
        colour = _mirrored(
            tones, clouds, colour, share, dx + 2.0 * facing * nx, dy + 2.0 * facing * ny, dz + 2.0 * facing * nz
        )
    return _hazed(tones, haze_m, colour, distance, dx, dy, dz)


@kernel
def shade(
    surfaces: Surfaces,
    looks: GroundLooks,
    textures: Textures,
    light: Light,
    maps: ShadowMaps,
    view: Projection,
    canvas: Canvas,
    curve: NDArray[np.uint8],
    wanted: NDArray[np.uint8],
    owners: NDArray[np.int32],
    triangles: NDArray[np.int32],
    step: int,
    rows: NDArray[np.uint8],
    picture: NDArray[np.uint8],
) -> bool:
    """Set the picture, shape (height, width, 3); return whether all shadow tiles that it needs were there.

    The samples of a pixel that show the same triangle are shaded together, in their middle. With a ``step`` above 1
    only every so many columns of every so many rows are set: a quick look at which tiles will be needed.

    Only rows that are marked in ``rows``, shape (height,), are set; those that lacked a tile stay marked.
    """
    faces, stands = surfaces.faces, surfaces.stands
    codes, corner, materials, colours = looks.codes, looks.corner, looks.materials, looks.colours
    averages, layout = looks.averages, looks.layout
    texels, starts, per_metre, size = textures.texels, textures.starts, textures.per_metre, textures.side
    tones, clouds = light.tones, light.clouds
    haze_m, shadow, soft, wetness, lamps = light.haze_m, light.shadow, light.soft, light.wetness, light.lamps
    frame, fine_pages, fine = maps.frame, maps.fine_pages, maps.fine
    coarse_pages, coarse = maps.coarse_pages, maps.coarse
    seen_nearness, seen_owners, seen_triangles = canvas.nearness, canvas.owners, canvas.triangles
    eye, axes = view.eye, view.axes
    samples, focal, centre_x, centre_y = view.samples, view.focal, view.centre_x, view.centre_y
    count = samples * samples
    pixel = samples / focal
    ahead_x, ahead_y, ahead_z = axes[2, 0], axes[2, 1], axes[2, 2]
    scale = (curve.shape[0] - 1) / (4.0 * count)
    per_focal = 1.0 / focal
    last = curve.shape[0] - 1
    complete = True
    for y in range(0, picture.shape[0], step):
        if rows[y] == 0:
            continue
        wanted[0] = 0
        for x in range(0, picture.shape[1], step):
            for k in range(count):
                row, column = y * samples + (k >> 1), x * samples + (k & 1)
                owners[k], triangles[k] = seen_owners[row, column], seen_triangles[row, column]
            red, green, blue = 0.0, 0.0, 0.0
            done = 0
            for k in range(count):
                if done & (1 << k):
                    continue
                # All samples of this pixel that show what sample k shows.
                middle_x, middle_y, nearness, same = 0.0, 0.0, 0.0, 0.0
                for j in range(k, count):
                    if owners[j] == owners[k] and triangles[j] == triangles[k]:
                        row, column = y * samples + (j >> 1), x * samples + (j & 1)
                        done |= 1 << j
                        middle_x += column
                        middle_y += row
                        nearness += seen_nearness[row, column]
                        same += 1.0
                per_same = 1.0 / same
                across = (middle_x * per_same + 0.5 - centre_x) * per_focal
                down = (middle_y * per_same + 0.5 - centre_y) * per_focal
                dx = ahead_x + across * axes[0, 0] + down * axes[1, 0]
                dy = ahead_y + across * axes[0, 1] + down * axes[1, 1]
                dz = ahead_z + across * axes[0, 2] + down * axes[1, 2]
                length = math.sqrt(dx * dx + dy * dy + dz * dz)
                per_length = 1.0 / length
                dx, dy, dz = dx * per_length, dy * per_length, dz * per_length
                if owners[k] == SKY:
                    colour = _sky(tones, clouds, dx, dy, dz)
                else:
                    distance = length * same / nearness
                    px = eye[0] + dx * distance
                    py = eye[1] + dy * distance
                    pz = eye[2] + dz * distance
                    if owners[k] == GROUND:
                        mirror = (0.0, 0.0, 0.0, 0.0)
                        if wetness > 0.0:
                            mirror = _mirror_image(
                                seen_nearness,
                                seen_owners,
                                picture,
                                y,
                                samples,
                                eye,
                                axes,
                                focal,
                                centre_x,
                                centre_y,
                                px,
                                py,
                                dx,
                                dy,
                                -dz,
                            )
                        colour = _ground(
                            codes,
                            corner,
                            materials,
                            colours,
                            averages,
                            layout,
                            texels,
                            starts,
                            per_metre,
                            size,
                            tones,
                            clouds,
                            haze_m,
                            shadow,
                            soft,
                            wetness,
                            frame,
                            fine_pages,
                            fine,
                            coarse_pages,
                            coarse,
                            wanted,
                            mirror,
                            px,
                            py,
                            distance,
                            dx,
                            dy,
                            dz,
                            pixel,
                        )
                    else:
                        colour = _surface(
                            faces,
                            stands,
                            texels,
                            starts,
                            per_metre,
                            size,
                            tones,
                            clouds,
                            haze_m,
                            shadow,
                            soft,
                            lamps,
                            frame,
                            fine_pages,
                            fine,
                            coarse_pages,
                            coarse,
                            wanted,
                            owners[k],
                            triangles[k],
                            px,
                            py,
                            pz,
                            distance,
                            dx,
                            dy,
                            dz,
                            pixel,
                        )
                red += same * colour[0]
                green += same * colour[1]
                blue += same * colour[2]
            picture[y, x, 0] = curve[min(last, int(scale * max(red, 0.0)))]
            picture[y, x, 1] = curve[min(last, int(scale * max(green, 0.0)))]
            picture[y, x, 2] = curve[min(last, int(scale * max(blue, 0.0)))]
        rows[y] = wanted[0]
        if wanted[0] != 0:
            complete = False
    return complete
