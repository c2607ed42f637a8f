"""What light comes from every pixel: one evaluation for each surface that a pixel shows, after it is known which.

All colours are linear light; `develop` makes bytes of them.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

from reasoned_explorer.rendering.library import Library
from reasoned_explorer.rendering.material import Material
from reasoned_explorer.rendering.projection import Projection
from reasoned_explorer.rendering.raster_kernels import GROUND, SKY, Canvas
from reasoned_explorer.rendering.scene import Instances
from reasoned_explorer.rendering.shadow_kernels import ShadowMaps, sunlight_at

Rgb = tuple[float, float, float]
_WATER, _FOLIAGE, _PAINT, _GLOW = int(Material.WATER), int(Material.FOLIAGE), int(Material.PAINT), int(Material.GLOW)
_GLASS, _FACADE_GLASS = int(Material.GLASS), int(Material.FACADE_GLASS)
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


class GroundLooks(NamedTuple):
    """The plane z = 0.

    Attributes:
        codes: Kinds of ground, shape (rows, columns), uint8, rows from south to north.
        corner: West edge, south edge and edge of a cell, metres.
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
        sun: Direction to the sun, ENU, of length 1.
        sun_rgb: What a surface that faces the sun gets of it.
        sky_rgb: What a surface that faces up gets of the sky.
        bounce_rgb: What a surface that faces down gets of the ground.
        zenith_rgb: The sky above.
        horizon_rgb: The sky at the horizon, and the colour of haze.
        glow_rgb: Added to the sky around the sun.
        cloud_rgb: Clouds.
        clouds: How dense clouds are, tileable, shape (n, n), float32, in [0, 1].
        haze_m: Distance at which haze takes the share 1 - 1/e.
        shadow: How much of the sunlight shadows take, in [0, 1].
        soft: Whether shadows are drawn from coarse tiles alone.
        wetness: How wet level ground is, in [0, 1].
        lamps: How bright glowing things are.
    """

    sun: NDArray[np.float64]
    sun_rgb: NDArray[np.float64]
    sky_rgb: NDArray[np.float64]
    bounce_rgb: NDArray[np.float64]
    zenith_rgb: NDArray[np.float64]
    horizon_rgb: NDArray[np.float64]
    glow_rgb: NDArray[np.float64]
    cloud_rgb: NDArray[np.float64]
    clouds: NDArray[np.float32]
    haze_m: float
    shadow: float
    soft: bool
    wetness: float
    lamps: float


@njit(nogil=True, cache=True, fastmath=False, error_model="numpy")
def _level_texel(textures: Textures, material: int, u: float, v: float, level: int) -> Rgb:
    """A texture's colour, bilinear in one level; u and v count repetitions."""
    side = textures.side >> level
    x = (u - math.floor(u)) * side - 0.5
    y = (1.0 - (v - math.floor(v))) * side - 0.5
    left, top = math.floor(x), math.floor(y)
    fx, fy = x - left, y - top
    mask = side - 1
    start = textures.starts[level] + material * side * side
    row0, row1 = start + (top & mask) * side, start + ((top + 1) & mask) * side
    column0, column1 = left & mask, (left + 1) & mask
    w00, w01, w10, w11 = (1.0 - fx) * (1.0 - fy), fx * (1.0 - fy), (1.0 - fx) * fy, fx * fy
    t = textures.texels
    a, b, c, d = row0 + column0, row0 + column1, row1 + column0, row1 + column1
    return (
        w00 * t[a, 0] + w01 * t[b, 0] + w10 * t[c, 0] + w11 * t[d, 0],
        w00 * t[a, 1] + w01 * t[b, 1] + w10 * t[c, 1] + w11 * t[d, 1],
        w00 * t[a, 2] + w01 * t[b, 2] + w10 * t[c, 2] + w11 * t[d, 2],
    )


@njit(nogil=True, cache=True, fastmath=False, error_model="numpy")
def _texel(textures: Textures, material: int, u_m: float, v_m: float, footprint_m: float) -> Rgb:
    """A texture's colour at a place on a surface, blurred to the pixel's footprint there."""
    scale = textures.per_metre[material]
    detail = math.log2(max(footprint_m * scale * textures.side, 1.0))
    last = textures.starts.shape[0] - 1
    level = min(int(detail), last)
    red, green, blue = _level_texel(textures, material, u_m * scale, v_m * scale, level)
    part = detail - level
    if part > 0.02 and level < last:
        other = _level_texel(textures, material, u_m * scale, v_m * scale, level + 1)
        red += part * (other[0] - red)
        green += part * (other[1] - green)
        blue += part * (other[2] - blue)
    return red, green, blue


@njit(nogil=True, cache=True, fastmath=False, error_model="numpy")
def _sky(light: Light, x: float, y: float, z: float) -> Rgb:
    """The sky in a direction of length 1."""
    up = max(z, 0.0)
    low = (1.0 - up) * (1.0 - up)
    low *= low
    red = light.zenith_rgb[0] + low * (light.horizon_rgb[0] - light.zenith_rgb[0])
    green = light.zenith_rgb[1] + low * (light.horizon_rgb[1] - light.zenith_rgb[1])
    blue = light.zenith_rgb[2] + low * (light.horizon_rgb[2] - light.zenith_rgb[2])
    near = max(0.0, x * light.sun[0] + y * light.sun[1] + z * light.sun[2])
    glow = near * near
    glow *= glow
    glow = 0.35 * glow + 0.65 * glow * glow * glow * glow
    red += glow * light.glow_rgb[0]
    green += glow * light.glow_rgb[1]
    blue += glow * light.glow_rgb[2]
    if z > 0.01:
        side = light.clouds.shape[0]
        u, v = x / (z + 0.12) * side * 0.35, y / (z + 0.12) * side * 0.35
        left, top = math.floor(u), math.floor(v)
        fu, fv = u - left, v - top
        i0, i1, j0, j1 = left % side, (left + 1) % side, top % side, (top + 1) % side
        c = light.clouds
        cover = (1.0 - fv) * ((1.0 - fu) * c[j0, i0] + fu * c[j0, i1]) + fv * ((1.0 - fu) * c[j1, i0] + fu * c[j1, i1])
        cover *= min(1.0, (z - 0.01) * 6.0)
        red += cover * (light.cloud_rgb[0] - red)
        green += cover * (light.cloud_rgb[1] - green)
        blue += cover * (light.cloud_rgb[2] - blue)
    return red, green, blue


@njit(nogil=True, cache=True, fastmath=False, error_model="numpy")
def _hazed(light: Light, colour: Rgb, distance: float, x: float, y: float, z: float) -> Rgb:
    """What is left of a colour after the air before it; the direction is of length 1."""
    share = 1.0 - math.exp(-distance / light.haze_m)
    near = max(0.0, x * light.sun[0] + y * light.sun[1] + z * light.sun[2])
    glow = 0.5 * near * near * near * near
    return (
        colour[0] + share * (light.horizon_rgb[0] + glow * light.glow_rgb[0] - colour[0]),
        colour[1] + share * (light.horizon_rgb[1] + glow * light.glow_rgb[1] - colour[1]),
        colour[2] + share * (light.horizon_rgb[2] + glow * light.glow_rgb[2] - colour[2]),
    )


@njit(nogil=True, cache=True, fastmath=False, error_model="numpy")
def _mirrored(light: Light, colour: Rgb, share: float, x: float, y: float, z: float) -> Rgb:
    """A colour with a share of what is seen of the surroundings in a mirrored direction."""
    seen = _sky(light, x, y, abs(z))
    if z < 0.0:
        dim = 0.35
        seen = (seen[0] * dim, seen[1] * dim, seen[2] * dim)
    return (
        colour[0] + share * (seen[0] - colour[0]),
        colour[1] + share * (seen[1] - colour[1]),
        colour[2] + share * (seen[2] - colour[2]),
    )


@njit(nogil=True, cache=True, fastmath=False, error_model="numpy")
def _kind_at(looks: GroundLooks, x: float, y: float) -> int:
    """The kind of ground at a point: the one with most weight among the four nearest cells."""
    rows, columns = looks.codes.shape
    u = (x - looks.corner[0]) / looks.corner[2] - 0.5
    v = (y - looks.corner[1]) / looks.corner[2] - 0.5
    if not (-0.5 <= u <= columns - 0.5 and -0.5 <= v <= rows - 0.5):
        return 0
    left, low = math.floor(u), math.floor(v)
    i0, i1 = max(left, 0), min(left + 1, columns - 1)
    j0, j1 = max(low, 0), min(low + 1, rows - 1)
    a, b, c, d = looks.codes[j0, i0], looks.codes[j0, i1], looks.codes[j1, i0], looks.codes[j1, i1]
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


@njit(nogil=True, cache=True, fastmath=False, error_model="numpy")
def _average_at(looks: GroundLooks, x: float, y: float, cells: float) -> Rgb:
    """The mean colour of the ground around a point, over about so many cells across."""
    level = min(max(int(math.log2(cells) - 1.5), 0), looks.layout.shape[0] - 1)
    start, rows, columns = looks.layout[level, 0], looks.layout[level, 1], looks.layout[level, 2]
    edge = looks.corner[2] * (4 << level)
    u = min(max((x - looks.corner[0]) / edge - 0.5, 0.0), columns - 1.0)
    v = min(max((y - looks.corner[1]) / edge - 0.5, 0.0), rows - 1.0)
    left, low = int(u), int(v)
    i1, j1 = min(left + 1, columns - 1), min(low + 1, rows - 1)
    fu, fv = u - left, v - low
    a, b = start + low * columns + left, start + low * columns + i1
    c, d = start + j1 * columns + left, start + j1 * columns + i1
    wa, wb, wc, wd = (1.0 - fu) * (1.0 - fv), fu * (1.0 - fv), (1.0 - fu) * fv, fu * fv
    t = looks.averages
    return (
        wa * t[a, 0] + wb * t[b, 0] + wc * t[c, 0] + wd * t[d, 0],
        wa * t[a, 1] + wb * t[b, 1] + wc * t[c, 1] + wd * t[d, 1],
        wa * t[a, 2] + wb * t[b, 2] + wc * t[c, 2] + wd * t[d, 2],
    )


@njit(nogil=True, cache=True, fastmath=False, error_model="numpy")
def _ground(
    looks: GroundLooks, textures: Textures, light: Light, maps: ShadowMaps, view: Projection, wanted: NDArray[np.uint8],
    x: float, y: float, distance: float, dx: float, dy: float, dz: float, pixel: float,
) -> Rgb:
    """The light from a point of the ground; (dx, dy, dz) is where the eye looks, of length 1."""
    lift = max(-dz, 1e-4)
    footprint = distance * pixel / math.sqrt(lift)
    cells = footprint / looks.corner[2]
    kind = _kind_at(looks, x, y)
    material = looks.materials[kind]
    red, green, blue = float(looks.colours[kind, 0]), float(looks.colours[kind, 1]), float(looks.colours[kind, 2])
    if cells < _COARSE_CELLS:
        texel = _texel(textures, material, x, y, footprint)
        red, green, blue = red * texel[0], green * texel[1], blue * texel[2]
    inside = kind != 0
    if cells > _FINE_CELLS and inside:
        share = min(1.0, (cells - _FINE_CELLS) / (_COARSE_CELLS - _FINE_CELLS))
        mean = _average_at(looks, x, y, cells)
        red += share * (mean[0] - red)
        green += share * (mean[1] - green)
        blue += share * (mean[2] - blue)
    lit = sunlight_at(maps, light.soft, view, wanted, x, y, 0.0, 0.0, 0.0, 1.0, distance, pixel)
    lit = light.sun[2] * (1.0 - light.shadow * (1.0 - lit))
    wet = 0.0
    if light.wetness > 0.0 and material != _WATER:
        wet = light.wetness
        dark = 1.0 - 0.4 * wet
        red, green, blue = red * dark, green * dark, blue * dark
    colour = (
        red * (light.sky_rgb[0] + lit * light.sun_rgb[0]),
        green * (light.sky_rgb[1] + lit * light.sun_rgb[1]),
        blue * (light.sky_rgb[2] + lit * light.sun_rgb[2]),
    )
    if material == _WATER or wet > 0.0:
        graze = 1.0 - lift
        graze *= graze
        share = 0.06 + 0.75 * graze * graze if material == _WATER else wet * (0.03 + 0.55 * graze * graze)
        colour = _mirrored(light, colour, share, dx, dy, -dz)
    return _hazed(light, colour, distance, dx, dy, dz)


@njit(nogil=True, cache=True, fastmath=False, error_model="numpy")
def _surface(
    library: Library, instances: Instances, textures: Textures, light: Light, maps: ShadowMaps, view: Projection,
    wanted: NDArray[np.uint8], i: int, t: int, px: float, py: float, pz: float, distance: float, dx: float, dy: float,
    dz: float, pixel: float,
) -> Rgb:
    """The light from a point of a thing's triangle; (dx, dy, dz) is where the eye looks, of length 1."""
    sine, cosine = instances.turns[i, 0], instances.turns[i, 1]
    sx, sy, sz = instances.scales[i, 0], instances.scales[i, 1], instances.scales[i, 2]
    ox, oy, oz = px - instances.places[i, 0], py - instances.places[i, 1], pz - instances.places[i, 2]
    lx, ly, lz = (ox * cosine - oy * sine) / sx, (ox * sine + oy * cosine) / sy, oz / sz
    a, b, c = library.triangles[t, 0], library.triangles[t, 1], library.triangles[t, 2]
    v = library.vertices
    x0, y0, z0 = float(v[a, 0]), float(v[a, 1]), float(v[a, 2])
    ex, ey, ez = v[b, 0] - x0, v[b, 1] - y0, v[b, 2] - z0
    fx, fy, fz = v[c, 0] - x0, v[c, 1] - y0, v[c, 2] - z0
    qx, qy, qz = lx - x0, ly - y0, lz - z0
    ee, ff, ef = ex * ex + ey * ey + ez * ez, fx * fx + fy * fy + fz * fz, ex * fx + ey * fy + ez * fz
    qe, qf = qx * ex + qy * ey + qz * ez, qx * fx + qy * fy + qz * fz
    inverse = 1.0 / max(ee * ff - ef * ef, 1e-18)
    w1 = min(max((ff * qe - ef * qf) * inverse, 0.0), 1.0)
    w2 = min(max((ee * qf - ef * qe) * inverse, 0.0), 1.0)
    w0 = 1.0 - w1 - w2
    n = library.normals
    mx = (w0 * n[t, 0, 0] + w1 * n[t, 1, 0] + w2 * n[t, 2, 0]) / sx
    my = (w0 * n[t, 0, 1] + w1 * n[t, 1, 1] + w2 * n[t, 2, 1]) / sy
    nz = (w0 * n[t, 0, 2] + w1 * n[t, 1, 2] + w2 * n[t, 2, 2]) / sz
    nx, ny = mx * cosine + my * sine, my * cosine - mx * sine
    length = 1.0 / math.sqrt(nx * nx + ny * ny + nz * nz + 1e-20)
    nx, ny, nz = nx * length, ny * length, nz * length
    facing = -(nx * dx + ny * dy + nz * dz)
    uvs = library.uvs
    u = w0 * uvs[t, 0, 0] + w1 * uvs[t, 1, 0] + w2 * uvs[t, 2, 0]
    w = w0 * uvs[t, 0, 1] + w1 * uvs[t, 1, 1] + w2 * uvs[t, 2, 1]
    material = library.materials[t]
    footprint = distance * pixel / math.sqrt(max(facing, 0.05))
    red, green, blue = _texel(textures, material, u, w, footprint)
    red *= library.colours[t, 0]
    green *= library.colours[t, 1]
    blue *= library.colours[t, 2]
    if material == _PAINT or material == _FOLIAGE:
        red *= instances.tints[i, 0]
        green *= instances.tints[i, 1]
        blue *= instances.tints[i, 2]
    if material == _GLOW:
        return _hazed(light, (red * light.lamps, green * light.lamps, blue * light.lamps), distance, dx, dy, dz)
    slant = nx * light.sun[0] + ny * light.sun[1] + nz * light.sun[2]
    if material == _FOLIAGE:  # leaves let some light through
        slant = 0.3 + 0.7 * slant
    lit = 0.0
    if slant > 0.0:
        lit = sunlight_at(maps, light.soft, view, wanted, px, py, pz, nx, ny, nz, distance, pixel)
        lit = slant * (1.0 - light.shadow * (1.0 - lit))
    up = 0.5 + 0.5 * nz
    near_ground = 0.72 + 0.28 * min(1.0, pz / 1.2)  # less of the sky is seen close to the ground
    colour = (
        red * (near_ground * (light.bounce_rgb[0] + up * (light.sky_rgb[0] - light.bounce_rgb[0])) + lit * light.sun_rgb[0]),
        green * (near_ground * (light.bounce_rgb[1] + up * (light.sky_rgb[1] - light.bounce_rgb[1])) + lit * light.sun_rgb[1]),
        blue * (near_ground * (light.bounce_rgb[2] + up * (light.sky_rgb[2] - light.bounce_rgb[2])) + lit * light.sun_rgb[2]),
    )
    if material == _GLASS or material == _FACADE_GLASS or material == _WATER or material == _PAINT:
        graze = 1.0 - max(facing, 0.0)
        graze *= graze
        graze *= graze
        share = 0.03 + 0.4 * graze if material == _PAINT else 0.15 + 0.65 * graze
        colour = _mirrored(light, colour, share, dx + 2.0 * facing * nx, dy + 2.0 * facing * ny, dz + 2.0 * facing * nz)
    return _hazed(light, colour, distance, dx, dy, dz)


@njit(nogil=True, cache=True, fastmath=False, error_model="numpy")
def shade(
    library: Library, instances: Instances, looks: GroundLooks, textures: Textures, light: Light, maps: ShadowMaps,
    view: Projection, canvas: Canvas, curve: NDArray[np.uint8], wanted: NDArray[np.uint8], picture: NDArray[np.uint8],
) -> bool:
    """Set the picture, shape (height, width, 3); return whether all shadow tiles that it needs were there.

    The samples of a pixel that show the same triangle are shaded together, in their middle.
    """
    samples = view.samples
    count = samples * samples
    pixel = samples / view.focal
    ahead_x, ahead_y, ahead_z = view.axes[2, 0], view.axes[2, 1], view.axes[2, 2]
    owners = np.empty(4, np.int64)
    triangles = np.empty(4, np.int64)
    scale = (curve.shape[0] - 1) / 4.0
    for y in range(picture.shape[0]):
        for x in range(picture.shape[1]):
            for k in range(count):
                row, column = y * samples + k // samples, x * samples + k % samples
                owners[k], triangles[k] = canvas.owners[row, column], canvas.triangles[row, column]
            red, green, blue = 0.0, 0.0, 0.0
            done = 0
            for k in range(count):
                if done & (1 << k):
                    continue
                # All samples of this pixel that show what sample k shows.
                middle_x, middle_y, nearness, same = 0.0, 0.0, 0.0, 0.0
                for j in range(k, count):
                    if owners[j] == owners[k] and triangles[j] == triangles[k]:
                        row, column = y * samples + j // samples, x * samples + j % samples
                        done |= 1 << j
                        middle_x += column
                        middle_y += row
                        nearness += canvas.nearness[row, column]
                        same += 1.0
                across = (middle_x / same + 0.5 - view.centre_x) / view.focal
                down = (middle_y / same + 0.5 - view.centre_y) / view.focal
                dx = ahead_x + across * view.axes[0, 0] + down * view.axes[1, 0]
                dy = ahead_y + across * view.axes[0, 1] + down * view.axes[1, 1]
                dz = ahead_z + across * view.axes[0, 2] + down * view.axes[1, 2]
                length = math.sqrt(dx * dx + dy * dy + dz * dz)
                dx, dy, dz = dx / length, dy / length, dz / length
                if owners[k] == SKY:
                    colour = _sky(light, dx, dy, dz)
                else:
                    distance = length * same / nearness
                    px = view.eye[0] + dx * distance
                    py = view.eye[1] + dy * distance
                    pz = view.eye[2] + dz * distance
                    if owners[k] == GROUND:
                        colour = _ground(
                            looks, textures, light, maps, view, wanted, px, py, distance, dx, dy, dz, pixel
                        )
                    else:
                        colour = _surface(
                            library, instances, textures, light, maps, view, wanted, owners[k], triangles[k],
                            px, py, pz, distance, dx, dy, dz, pixel,
                        )
                red += same * colour[0]
                green += same * colour[1]
                blue += same * colour[2]
            last = curve.shape[0] - 1
            picture[y, x, 0] = curve[min(last, int(scale * max(red, 0.0) / count))]
            picture[y, x, 1] = curve[min(last, int(scale * max(green, 0.0) / count))]
            picture[y, x, 2] = curve[min(last, int(scale * max(blue, 0.0) / count))]
    return wanted[0] == 0
