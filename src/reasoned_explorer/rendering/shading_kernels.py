"""What light comes from every pixel: one evaluation for each surface that a pixel shows, after it is known which.

All colours are linear light; `develop` makes bytes of them.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.rendering.ground_kernels import GroundLooks, ground_light, mirror_image
from reasoned_explorer.rendering.kernel_types import Codes, Floats, Ints, Packed, Pages, Rgb, Texels, Tiles
from reasoned_explorer.rendering.material import Material
from reasoned_explorer.rendering.projection import Projection
from reasoned_explorer.rendering.raster_kernels import GROUND, SKY, Canvas
from reasoned_explorer.rendering.shadow_kernels import ShadowMaps, sunlight_at
from reasoned_explorer.rendering.sky_kernels import (
    BOUNCE,
    SKYLIGHT,
    SUN,
    SUNLIGHT,
    Light,
    haze_of,
    hazed,
    mirrored,
    sky_light,
)
from reasoned_explorer.rendering.texture_kernels import Textures, texel_at
from reasoned_explorer.world.compiling import inlined, kernel

_FOLIAGE, _PAINT, _LIT = int(Material.FOLIAGE), int(Material.PAINT), int(Material.GLOW)
#: Bits of materials, since numba takes long over ``in``: which things tint, and which mirror.
_OWN_COLOUR = 1 << Material.PAINT | 1 << Material.FOLIAGE
_SHINY = 1 << Material.GLASS | 1 << Material.FACADE_GLASS | 1 << Material.WATER | 1 << Material.PAINT


class Surfaces(NamedTuple):
    """What the shader needs to know of triangles and of where they stand, each in one line of memory.

    Attributes:
        faces: Of each triangle of the library: first corner, how the weights of the second and of the third corner
            grow from it on, normals and texture coordinates at the corners, colour in linear light, material; shape
            (t, 28), float32.
        stands: Of each instance: place, sine and cosine of its heading, 1 / scale, tint; shape (n, 11), float64.
    """

    faces: NDArray[np.float32]
    stands: NDArray[np.float64]


@inlined
def _surface(
    faces: Texels,
    stands: Floats,
    texels: Packed,
    starts: Ints,
    per_metre: Floats,
    size: int,
    tones: Floats,
    clouds: Texels,
    shadow: float,
    soft: bool,
    lamps: float,
    frame: Floats,
    fine_pages: Pages,
    fine: Tiles,
    fine_limits: Tiles,
    coarse_pages: Pages,
    coarse: Tiles,
    coarse_limits: Tiles,
    wanted: Codes,
    i: int,
    t: int,
    px: float,
    py: float,
    pz: float,
    distance: float,
    haze: float,
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
    w1 = min(max(qx * faces[t, 3] + qy * faces[t, 4] + qz * faces[t, 5], 0.0), 1.0)
    w2 = min(max(qx * faces[t, 6] + qy * faces[t, 7] + qz * faces[t, 8], 0.0), 1.0)
    w0 = 1.0 - w1 - w2
    mx = (w0 * faces[t, 9] + w1 * faces[t, 12] + w2 * faces[t, 15]) * sx
    my = (w0 * faces[t, 10] + w1 * faces[t, 13] + w2 * faces[t, 16]) * sy
    nz = (w0 * faces[t, 11] + w1 * faces[t, 14] + w2 * faces[t, 17]) * sz
    nx, ny = mx * cosine + my * sine, my * cosine - mx * sine
    square = nx * nx + ny * ny + nz * nz
    if abs(square - 1.0) > 1e-4:  # flat faces of things that are not stretched need none of this
        length = 1.0 / math.sqrt(square + 1e-20)
        nx, ny, nz = nx * length, ny * length, nz * length
    facing = -(nx * dx + ny * dy + nz * dz)
    u = w0 * faces[t, 18] + w1 * faces[t, 20] + w2 * faces[t, 22]
    w = w0 * faces[t, 19] + w1 * faces[t, 21] + w2 * faces[t, 23]
    material = int(faces[t, 27])
    across = distance * pixel
    footprint_m2 = across * across / max(facing, 0.05)
    red, green, blue = texel_at(texels, starts, per_metre, size, material, u, w, footprint_m2)
    red *= faces[t, 24]
    green *= faces[t, 25]
    blue *= faces[t, 26]
    if _OWN_COLOUR >> material & 1:
        red *= stands[i, 8]
        green *= stands[i, 9]
        blue *= stands[i, 10]
    if material == _LIT:
        return hazed(tones, haze, (red * lamps, green * lamps, blue * lamps), dx, dy, dz)
    slant = nx * tones[SUN, 0] + ny * tones[SUN, 1] + nz * tones[SUN, 2]
    if material == _FOLIAGE:  # leaves let some light through
        slant = max(0.3 + 0.7 * slant, -0.45 * slant)
    lit = 0.0
    if slant > 0.0:
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
            px,
            py,
            pz,
            nx,
            ny,
            nz,
            distance,
            pixel,
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
    if _SHINY >> material & 1:
        graze = 1.0 - max(facing, 0.0)
        graze *= graze
        graze *= graze
        share = 0.03 + 0.4 * graze if material == _PAINT else 0.15 + 0.65 * graze
        colour = mirrored(
            tones, clouds, colour, share, dx + 2.0 * facing * nx, dy + 2.0 * facing * ny, dz + 2.0 * facing * nz
        )
    return hazed(tones, haze, colour, dx, dy, dz)


@inlined
def _measure(view: Projection, canvas: Canvas, y: int, pixel: float, per_haze: float, line: Floats) -> None:
    """Set what follows from where the pixels of a row are and how near what they show is, all samples taken together.

    Loops of one thing each, without branches: the processor does four pixels at once.

    Args:
        view: How it is looked.
        canvas: What is seen.
        y: The row.
        pixel: Angle of a pixel, radians.
        per_haze: Of haze, 1 / metres.
        line: Set, shape (4, width): 1 / length of the way to where the depth is 1, distance in metres, share of haze,
            and the square of the pixel's footprint on the ground in metres.
    """
    axes, samples, nearness = view.axes, view.samples, canvas.nearness
    per_length, distance, haze, footprint = line[0], line[1], line[2], line[3]
    per_focal = 1.0 / view.focal
    down = (y * samples + 0.5 * samples - view.centre_y) * per_focal
    first = (0.5 * samples - view.centre_x) * per_focal
    stride = samples * per_focal
    width = line.shape[1]
    level, per_row = 1.0 + down * down, axes[2, 2] + down * axes[1, 2]
    slope = axes[0, 2]
    for x in range(width):
        across = first + stride * x
        per_length[x] = 1.0 / math.sqrt(level + across * across)
    if samples == 1:
        for x in range(width):
            distance[x] = nearness[y, x]
    else:
        for x in range(width):
            distance[x] = 0.25 * (
                nearness[2 * y, 2 * x]
                + nearness[2 * y, 2 * x + 1]
                + nearness[2 * y + 1, 2 * x]
                + nearness[2 * y + 1, 2 * x + 1]
            )
    for x in range(width):
        distance[x] = 1.0 / (per_length[x] * distance[x])
    for x in range(width):
        haze[x] = haze_of(distance[x] * per_haze)
    for x in range(width):
        lift = -(per_row + (first + stride * x) * slope) * per_length[x]
        across = distance[x] * pixel
        footprint[x] = across * across / max(lift, 1e-4)


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
    line: Floats,
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
    per_haze, shadow, soft, wetness, lamps = 1.0 / light.haze_m, light.shadow, light.soft, light.wetness, light.lamps
    frame, fine_pages, fine, fine_limits = maps.frame, maps.fine_pages, maps.fine, maps.fine_limits
    coarse_pages, coarse, coarse_limits = maps.coarse_pages, maps.coarse, maps.coarse_limits
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
        _measure(view, canvas, y, pixel, per_haze, line)
        down = (y * samples + 0.5 * samples - centre_y) * per_focal
        for x in range(0, picture.shape[1], step):
            owner, triangle = seen_owners[y * samples, x * samples], seen_triangles[y * samples, x * samples]
            even = True
            for k in range(1, count):
                row, column = y * samples + (k >> 1), x * samples + (k & 1)
                owners[k], triangles[k] = seen_owners[row, column], seen_triangles[row, column]
                even = even and owners[k] == owner and triangles[k] == triangle
            owners[0], triangles[0] = owner, triangle
            red, green, blue = 0.0, 0.0, 0.0
            done = 0
            for k in range(1 if even else count):
                if even:
                    same = float(count)
                    across = (x * samples + 0.5 * samples - centre_x) * per_focal
                    dx = ahead_x + across * axes[0, 0] + down * axes[1, 0]
                    dy = ahead_y + across * axes[0, 1] + down * axes[1, 1]
                    dz = ahead_z + across * axes[0, 2] + down * axes[1, 2]
                    per_length = line[0, x]
                    dx, dy, dz = dx * per_length, dy * per_length, dz * per_length
                    distance, haze, footprint_m2 = line[1, x], line[2, x], line[3, x]
                else:
                    if done & (1 << k):
                        continue
                    owner, triangle = owners[k], triangles[k]
                    # All samples of this pixel that show what sample k shows.
                    middle_x, middle_y, nearness, same = 0.0, 0.0, 0.0, 0.0
                    for j in range(k, count):
                        if owners[j] == owner and triangles[j] == triangle:
                            row, column = y * samples + (j >> 1), x * samples + (j & 1)
                            done |= 1 << j
                            middle_x += column
                            middle_y += row
                            nearness += seen_nearness[row, column]
                            same += 1.0
                    per_same = 1.0 / same
                    across = (middle_x * per_same + 0.5 - centre_x) * per_focal
                    lower = (middle_y * per_same + 0.5 - centre_y) * per_focal
                    dx = ahead_x + across * axes[0, 0] + lower * axes[1, 0]
                    dy = ahead_y + across * axes[0, 1] + lower * axes[1, 1]
                    dz = ahead_z + across * axes[0, 2] + lower * axes[1, 2]
                    length = math.sqrt(1.0 + across * across + lower * lower)
                    per_length = 1.0 / length
                    dx, dy, dz = dx * per_length, dy * per_length, dz * per_length
                    distance = length * same / nearness
                    haze = haze_of(distance * per_haze)
                    footprint_m2 = distance * distance * pixel * pixel / max(-dz, 1e-4)
                if owner == SKY:
                    colour = sky_light(tones, clouds, dx, dy, dz)
                else:
                    px = eye[0] + dx * distance
                    py = eye[1] + dy * distance
                    pz = eye[2] + dz * distance
                    if owner == GROUND:
                        mirror = (0.0, 0.0, 0.0, 0.0)
                        if wetness > 0.0:
                            mirror = mirror_image(
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
                        colour = ground_light(
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
                            shadow,
                            soft,
                            wetness,
                            frame,
                            fine_pages,
                            fine,
                            fine_limits,
                            coarse_pages,
                            coarse,
                            coarse_limits,
                            wanted,
                            mirror,
                            px,
                            py,
                            distance,
                            haze,
                            dx,
                            dy,
                            dz,
                            pixel,
                            footprint_m2,
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
                            shadow,
                            soft,
                            lamps,
                            frame,
                            fine_pages,
                            fine,
                            fine_limits,
                            coarse_pages,
                            coarse,
                            coarse_limits,
                            wanted,
                            owner,
                            triangle,
                            px,
                            py,
                            pz,
                            distance,
                            haze,
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
