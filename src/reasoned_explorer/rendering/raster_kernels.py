"""Which thing is seen in every sample of a picture: triangles are projected, tested and kept where they are nearest.

Inside or outside is decided with two-dimensional homogeneous coordinates (Olano and Greer, "Triangle scan conversion
using 2D homogeneous coordinates", 1997): an edge's function is the cross product of its ends, so that nothing needs to
be clipped, and the same edge seen from its other side gives exactly the opposite number: of two triangles that share
an edge exactly one covers a sample on it.

Nearness is 1 / depth: it is linear across a triangle on the screen.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.rendering.library import Library
from reasoned_explorer.rendering.projection import NEAR_M, Projection
from reasoned_explorer.rendering.scene import Cells, Instances
from reasoned_explorer.world.compiling import inlined, kernel, part

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]

#: Owners of samples that no instance has.
SKY, GROUND = -1, -2
#: Edge of the blocks whose farthest sample is kept to find out what is hidden, samples.
SHIFT = 3
BLOCK = 1 << SHIFT
#: The ground ends here, metres along the view's axis.
GROUND_REACH_M = 10_000.0
BUCKETS = 512
#: Buckets of distance: a step is a tenth of a metre near the eye, and grows.
_BUCKET_M, _BUCKET_STEPS = 50.0, 512.0
_SLACK = 1e-6
#: What is in one place with what was drawn before it, up to rounding, stays behind it: no speckles.
_NEARER = 1.0 + 1e-6
#: The least number that is more than 0.
_ABOVE_NOTHING = 5e-324
_LEAST_NEARNESS = 1.0 / GROUND_REACH_M
_MOST_NEARNESS = 1.0 / NEAR_M
#: Things that fill less than this across are left out, pixels.
LEAST_SIZE = 0.7


class Canvas(NamedTuple):
    """What is seen in every sample.

    Attributes:
        nearness: 1 / depth, shape (height, width), float32; 0 is the sky.
        owners: The instance, `SKY` or `GROUND`, shape (height, width), int32.
        triangles: Its triangle in the library, shape (height, width), int32.
        farthest: No more than the least nearness in each block, shape (⌈height / BLOCK⌉, ⌈width / BLOCK⌉), float32.
    """

    nearness: NDArray[np.float32]
    owners: NDArray[np.int32]
    triangles: NDArray[np.int32]
    farthest: NDArray[np.float32]


class Scratch(NamedTuple):
    """Room for what is worked out on the way.

    Attributes:
        corners: Projected vertices of one thing: homogeneous x, y and z, and the picture's x and y, shape (v, 5).
        candidates: Instances in view, shape (n,), int32.
        ordered: The same from near to far, shape (n,), int32.
        nearest: Greatest nearness of each candidate, shape (n,), float64.
        rectangles: First and last column and row of each candidate, shape (n, 4), int32.
        levels: Level at which each instance was drawn, or -1, shape (n,), int8.
        keys: For sorting, shape (n,), int32.
        buckets: Likewise, shape (BUCKETS + 1,), int32.
        matrix: Shape (3, 4).
    """

    corners: NDArray[np.float64]
    candidates: NDArray[np.int32]
    ordered: NDArray[np.int32]
    nearest: NDArray[np.float64]
    rectangles: NDArray[np.int32]
    levels: NDArray[np.int8]
    keys: NDArray[np.int32]
    buckets: NDArray[np.int32]
    matrix: NDArray[np.float64]


@part
def _fill_background(view: Projection, canvas: Canvas) -> None:
    """The plane z = 0 where it is seen, else the sky; the view has no roll, so that it is the same along a row."""
    height, tilt, fall, focal, centre = view.eye[2], view.axes[2, 2], view.axes[1, 2], view.focal, view.centre_y
    nearness, owners, triangles = canvas.nearness, canvas.owners, canvas.triangles
    for y in range(nearness.shape[0]):
        slope = tilt + fall * (y + 0.5 - centre) / focal
        near = 0.0
        if height > 0.0 and slope < 0.0:
            near = -slope / height
        owner = GROUND
        if near < _LEAST_NEARNESS or near > _MOST_NEARNESS:
            owner, near = SKY, 0.0
        for x in range(nearness.shape[1]):
            nearness[y, x] = near
            owners[y, x] = owner
            triangles[y, x] = -1


@part
def _matrix_of(instances: Instances, i: int, view: Projection, matrix: Floats) -> None:
    """Set a (3, 4) matrix from an instance's own frame to homogeneous picture coordinates."""
    places, turns, scales, eye, axes = instances.places, instances.turns, instances.scales, view.eye, view.axes
    sine, cosine = turns[i, 0], turns[i, 1]
    x, y, z = places[i, 0] - eye[0], places[i, 1] - eye[1], places[i, 2] - eye[2]
    for row in range(3):
        a, b, c = axes[2, 0], axes[2, 1], axes[2, 2]
        if row < 2:
            centre = view.centre_x if row == 0 else view.centre_y
            a = view.focal * axes[row, 0] + centre * a
            b = view.focal * axes[row, 1] + centre * b
            c = view.focal * axes[row, 2] + centre * c
        matrix[row, 0] = (a * cosine - b * sine) * scales[i, 0]
        matrix[row, 1] = (a * sine + b * cosine) * scales[i, 1]
        matrix[row, 2] = c * scales[i, 2]
        matrix[row, 3] = a * x + b * y + c * z


@part
def _ball_in_view(balls: Floats, i: int, view: Projection) -> bool:
    """Whether a sphere may reach into the view."""
    eye, axes, focal = view.eye, view.axes, view.focal
    x, y, z, radius = balls[i, 0] - eye[0], balls[i, 1] - eye[1], balls[i, 2] - eye[2], balls[i, 3]
    ahead = axes[2, 0] * x + axes[2, 1] * y + axes[2, 2] * z
    if ahead < NEAR_M - radius:
        return False
    right = abs(axes[0, 0] * x + axes[0, 1] * y + axes[0, 2] * z)
    slope = view.centre_x / focal
    if right > ahead * slope + radius * math.sqrt(1.0 + slope * slope):
        return False
    down = abs(axes[1, 0] * x + axes[1, 1] * y + axes[1, 2] * z)
    slope = view.centre_y / focal
    return down <= ahead * slope + radius * math.sqrt(1.0 + slope * slope)


@part
def _bound(boxes: Floats, prototype: int, matrix: Floats, width: int, height: int) -> tuple[float, int, int, int, int]:
    """A box's greatest nearness, or 0 if it is not in the picture; first and last column and row that it may cover."""
    least_x, most_x, least_y, most_y = math.inf, -math.inf, math.inf, -math.inf
    least_z, most_z = math.inf, -math.inf
    for corner in range(8):
        a, b, c = (
            boxes[prototype, corner & 1, 0],
            boxes[prototype, (corner >> 1) & 1, 1],
            boxes[prototype, corner >> 2, 2],
        )
        z = matrix[2, 0] * a + matrix[2, 1] * b + matrix[2, 2] * c + matrix[2, 3]
        x = (matrix[0, 0] * a + matrix[0, 1] * b + matrix[0, 2] * c + matrix[0, 3]) / z
        y = (matrix[1, 0] * a + matrix[1, 1] * b + matrix[1, 2] * c + matrix[1, 3]) / z
        least_z, most_z = min(least_z, z), max(most_z, z)
        least_x, most_x = min(least_x, x), max(most_x, x)
        least_y, most_y = min(least_y, y), max(most_y, y)
    if most_z < NEAR_M:
        return 0.0, 0, 0, 0, 0
    if least_z <= NEAR_M:  # around the eye: it may cover all
        least_x, most_x, least_y, most_y = 0.0, float(width), 0.0, float(height)
    first_x, last_x = _first_sample(least_x), _last_sample(most_x, width)
    first_y, last_y = _first_sample(least_y), _last_sample(most_y, height)
    if first_x > last_x or first_y > last_y:
        return 0.0, 0, 0, 0, 0
    return 1.0 / max(least_z, NEAR_M), first_x, last_x, first_y, last_y


@part
def _first_sample(position: float) -> int:
    """The first sample whose middle is not before a position, a little generously; at least 0."""
    return max(math.ceil(max(position, 0.0) - 0.5 - _SLACK), 0)


@part
def _last_sample(position: float, count: int) -> int:
    """The last of ``count`` samples whose middle is not beyond a position, a little generously."""
    return min(math.floor(min(position, float(count)) - 0.5 + _SLACK), count - 1)


@part
def _hidden(canvas: Canvas, rectangles: Ints, k: int, nearest: float) -> bool:
    """Whether all that a rectangle covers is nearer than ``nearest`` already."""
    farthest, nearness = canvas.farthest, canvas.nearness
    first_x, last_x, first_y, last_y = rectangles[k, 0], rectangles[k, 1], rectangles[k, 2], rectangles[k, 3]
    for row in range(first_y >> SHIFT, (last_y >> SHIFT) + 1):
        for column in range(first_x >> SHIFT, (last_x >> SHIFT) + 1):
            if farthest[row, column] >= nearest:
                continue
            # Of a block that is covered in part only that part counts: it is sooner hidden than the whole.
            left, right = max(first_x, column * BLOCK), min(last_x, column * BLOCK + BLOCK - 1)
            top, bottom = max(first_y, row * BLOCK), min(last_y, row * BLOCK + BLOCK - 1)
            least = np.float32(math.inf)
            for y in range(top, bottom + 1):
                for x in range(left, right + 1):
                    least = min(least, nearness[y, x])
                if least < nearest:
                    return False
            if right - left == BLOCK - 1 and bottom - top == BLOCK - 1:
                farthest[row, column] = least
    return True


@part
def _level_of(library: Library, prototype: int, radius: float, density: float) -> int:
    """Which level of detail: the finest with at most ``density`` triangles for each pixel that the thing may fill."""
    wanted = density * math.pi * radius * radius + 12.0
    levels, prototypes = library.levels, library.prototypes
    first, count = prototypes[prototype, 0], prototypes[prototype, 1]
    for level in range(count - 1):
        if levels[first + level, 3] <= wanted:
            return level
    return count - 1


@part
def _bounds_across_near(corners: Floats, a: int, b: int, c: int) -> tuple[float, float, float, float]:
    """What a triangle that goes through the near plane covers at most."""
    least_x, most_x, least_y, most_y = math.inf, -math.inf, math.inf, -math.inf
    one = c
    for other in (a, b, c):
        z_one, z_other = corners[one, 2], corners[other, 2]
        if z_other > NEAR_M:
            x, y = corners[other, 3], corners[other, 4]
            least_x, most_x, least_y, most_y = min(least_x, x), max(most_x, x), min(least_y, y), max(most_y, y)
        if (z_one > NEAR_M) != (z_other > NEAR_M):
            t = (NEAR_M - z_one) / (z_other - z_one)
            x = (corners[one, 0] + t * (corners[other, 0] - corners[one, 0])) / NEAR_M
            y = (corners[one, 1] + t * (corners[other, 1] - corners[one, 1])) / NEAR_M
            least_x, most_x = min(least_x, x - 0.5), max(most_x, x + 0.5)
            least_y, most_y = min(least_y, y - 0.5), max(most_y, y + 0.5)
        one = other
    return least_x, most_x, least_y, most_y


@part
def _narrow(slope: float, rest: float, low: float, high: float) -> tuple[float, float]:
    """Where slope · x + rest ≥ 0, between low and high, a little too wide."""
    if slope > 0.0:
        return max(low, -rest / slope - 1.0), high
    if slope < 0.0:
        return low, min(high, -rest / slope + 1.0)
    return low, high


@part
def _least_of(across: float, down: float) -> float:
    """What an edge's function must be at least: 0 where samples on the edge belong to the triangle, else above it."""
    return 0.0 if across > 0.0 or (across == 0.0 and down > 0.0) else _ABOVE_NOTHING


@inlined
def _fill_triangle(
    corners: Floats,
    a: int,
    b: int,
    c: int,
    owner: int,
    triangle: int,
    nearness: NDArray[np.float32],
    owners: Ints,
    triangles: Ints,
) -> None:
    """See `fill_triangle`."""
    height, width = nearness.shape
    za, zb, zc = corners[a, 2], corners[b, 2], corners[c, 2]
    if za > NEAR_M and zb > NEAR_M and zc > NEAR_M:
        xa, xb, xc = corners[a, 3], corners[b, 3], corners[c, 3]
        ya, yb, yc = corners[a, 4], corners[b, 4], corners[c, 4]
        least_x, most_x = min(xa, min(xb, xc)), max(xa, max(xb, xc))
        least_y, most_y = min(ya, min(yb, yc)), max(ya, max(yb, yc))
    elif za > NEAR_M or zb > NEAR_M or zc > NEAR_M:
        least_x, most_x, least_y, most_y = _bounds_across_near(corners, a, b, c)
    else:
        return
    first_x, last_x = _first_sample(least_x), _last_sample(most_x, width)
    first_y, last_y = _first_sample(least_y), _last_sample(most_y, height)
    if first_x > last_x or first_y > last_y:
        return
    x0, y0, z0 = corners[a, 0], corners[a, 1], za
    x1, y1, z1 = corners[c, 0], corners[c, 1], zc  # what faces the eye turns the other way on the screen
    x2, y2, z2 = corners[b, 0], corners[b, 1], zb
    # Each edge function is ax · x + ay · y + ar: positive within, and exactly opposite for a neighbour.
    ax0, ay0, ar0 = y1 * z2 - z1 * y2, z1 * x2 - x1 * z2, x1 * y2 - y1 * x2
    determinant = x0 * ax0 + y0 * ay0 + z0 * ar0
    if not determinant > 0.0:
        return
    ax1, ay1, ar1 = y2 * z0 - z2 * y0, z2 * x0 - x2 * z0, x2 * y0 - y2 * x0
    ax2, ay2, ar2 = y0 * z1 - z0 * y1, z0 * x1 - x0 * z1, x0 * y1 - y0 * x1
    inverse = 1.0 / determinant
    least0, least1, least2 = _least_of(ax0, ay0), _least_of(ax1, ay1), _least_of(ax2, ay2)
    wide = last_x - first_x > 12
    for y in range(first_y, last_y + 1):
        middle = y + 0.5
        rest0, rest1, rest2 = ay0 * middle + ar0, ay1 * middle + ar1, ay2 * middle + ar2
        low, high = first_x, last_x
        if wide:
            left, right = float(first_x), float(last_x)
            left, right = _narrow(ax0, rest0, left, right)
            left, right = _narrow(ax1, rest1, left, right)
            left, right = _narrow(ax2, rest2, left, right)
            if left > right + 1.0:
                continue
            low, high = max(first_x, math.floor(left)), min(last_x, math.ceil(right))
        for x in range(low, high + 1):
            across = x + 0.5
            edge0 = ax0 * across + rest0
            edge1 = ax1 * across + rest1
            edge2 = ax2 * across + rest2
            near = np.float32((edge0 + edge1 + edge2) * inverse)
            # No branch: whether a sample is covered is anyone's guess, for the processor too.
            before = nearness[y, x]
            covered = (
                (edge0 >= least0)
                & (edge1 >= least1)
                & (edge2 >= least2)
                & (near > before * _NEARER)
                & (near <= _MOST_NEARNESS)
            )
            nearness[y, x] = near if covered else before
            owners[y, x] = owner if covered else owners[y, x]
            triangles[y, x] = triangle if covered else triangles[y, x]


@kernel
def fill_triangle(
    corners: Floats,
    a: int,
    b: int,
    c: int,
    owner: int,
    triangle: int,
    nearness: NDArray[np.float32],
    owners: Ints,
    triangles: Ints,
) -> None:
    """Keep a triangle wherever it is nearest and faces the eye.

    Triangles that share an edge cover every sample along it exactly once. Around a corner that hits the middle of a
    sample to the last digit, rounding decides: the sample may be left out, or covered twice.

    Args:
        corners: As in `Scratch`.
        a: Its first corner; counter-clockwise seen from outside.
        b: Its second.
        c: Its third.
        owner: What is kept in ``owners``.
        triangle: What is kept in ``triangles``.
        nearness: As in `Canvas`.
        owners: Likewise.
        triangles: Likewise.
    """
    _fill_triangle(corners, a, b, c, owner, triangle, nearness, owners, triangles)


@part
def _draw_level(library: Library, level: int, matrix: Floats, owner: int, canvas: Canvas, corners: Floats) -> None:
    vertices, places, levels = library.vertices, library.triangles, library.levels
    nearness, owners, triangles = canvas.nearness, canvas.owners, canvas.triangles
    first = levels[level, 0]
    for k in range(levels[level, 1]):
        a, b, c = vertices[first + k, 0], vertices[first + k, 1], vertices[first + k, 2]
        x = matrix[0, 0] * a + matrix[0, 1] * b + matrix[0, 2] * c + matrix[0, 3]
        y = matrix[1, 0] * a + matrix[1, 1] * b + matrix[1, 2] * c + matrix[1, 3]
        z = matrix[2, 0] * a + matrix[2, 1] * b + matrix[2, 2] * c + matrix[2, 3]
        inverse = 1.0 / z
        corners[k, 0], corners[k, 1], corners[k, 2] = x, y, z
        corners[k, 3], corners[k, 4] = x * inverse, y * inverse
    for t in range(levels[level, 2], levels[level, 2] + levels[level, 3]):
        a, b, c = places[t, 0] - first, places[t, 1] - first, places[t, 2] - first
        _fill_triangle(corners, a, b, c, owner, t, nearness, owners, triangles)


@part
def _distance(balls: Floats, i: int, eye: Floats) -> float:
    x, y, z = balls[i, 0] - eye[0], balls[i, 1] - eye[1], balls[i, 2] - eye[2]
    return math.sqrt(x * x + y * y + z * z)


@kernel
def gather(
    library: Library, instances: Instances, cells: Cells, view: Projection, everything: bool, scratch: Scratch
) -> int:
    """Set the candidates: what may be in the picture, roughly from near to far. Returns how many.

    Args:
        library: Models.
        instances: Where they stand.
        cells: A grid over them.
        view: The camera.
        everything: Whether all counts that is in the picture, however small.
        scratch: Set: ``candidates``, ``nearest``, ``rectangles`` and ``ordered``.
    """
    balls, prototypes, boxes = instances.balls, instances.prototypes, library.boxes
    starts, members, cell_balls = cells.starts, cells.members, cells.balls
    candidates, nearest, rectangles, matrix = scratch.candidates, scratch.nearest, scratch.rectangles, scratch.matrix
    count = 0
    pixels = 2.0 * view.focal / view.samples
    for cell in range(cell_balls.shape[0]):
        if not everything and not _ball_in_view(cell_balls, cell, view):
            continue
        for k in range(starts[cell], starts[cell + 1]):
            i = members[k] + 0  # a wide number, as cells are: numba compiles a function once for each type
            if not everything:
                if not _ball_in_view(balls, i, view):
                    continue
                if balls[i, 3] * pixels < LEAST_SIZE * _distance(balls, i, view.eye):
                    continue
            _matrix_of(instances, i, view, matrix)
            near, first_x, last_x, first_y, last_y = _bound(boxes, prototypes[i], matrix, view.width, view.height)
            if near > 0.0:
                rectangles[count, 0], rectangles[count, 1] = first_x, last_x
                rectangles[count, 2], rectangles[count, 3] = first_y, last_y
                candidates[count] = i
                nearest[count] = near
                count += 1
    _order(scratch, count)
    return count


@part
def _order(scratch: Scratch, count: int) -> None:
    """Order candidates roughly from near to far."""
    starts, keys, nearest, ordered = scratch.buckets, scratch.keys, scratch.nearest, scratch.ordered
    for bucket in range(BUCKETS + 1):
        starts[bucket] = 0
    for k in range(count):
        distance = 1.0 / nearest[k]
        keys[k] = min(BUCKETS - 1, int(_BUCKET_STEPS * distance / (distance + _BUCKET_M)))
        starts[keys[k] + 1] += 1
    for bucket in range(BUCKETS):
        starts[bucket + 1] += starts[bucket]
    for k in range(count):
        ordered[starts[keys[k]]] = k
        starts[keys[k]] += 1


@kernel
def draw(
    library: Library,
    instances: Instances,
    count: int,
    view: Projection,
    density: float,
    everything: bool,
    canvas: Canvas,
    scratch: Scratch,
) -> None:
    """Find out what is seen in every sample.

    Args:
        library: Models.
        instances: Where they stand.
        count: Of the candidates, as `gather` returns it.
        view: The camera.
        density: Triangles for each pixel at most, where a model has levels to choose from.
        everything: Draw all, at full detail, whether it is hidden or not: a reference that is slow.
        canvas: Set.
        scratch: As `gather` leaves it; its ``levels`` say afterwards what was drawn.
    """
    _fill_background(view, canvas)
    farthest, rectangles, levels, matrix = canvas.farthest, scratch.rectangles, scratch.levels, scratch.matrix
    for row in range(farthest.shape[0]):
        for column in range(farthest.shape[1]):
            farthest[row, column] = 0.0
    for i in range(levels.shape[0]):
        levels[i] = -1
    pixels = view.focal / view.samples
    for turn in range(count):
        k = scratch.ordered[turn]
        if not everything and _hidden(canvas, rectangles, k, scratch.nearest[k]):
            continue
        i = scratch.candidates[k] + 0
        prototype = instances.prototypes[i]
        level = 0
        if not everything:
            distance = max(_distance(instances.balls, i, view.eye), 0.25)
            level = _level_of(library, prototype, instances.balls[i, 3] * pixels / distance, density)
        levels[i] = level
        _matrix_of(instances, i, view, matrix)
        _draw_level(library, library.prototypes[prototype, 0] + level, matrix, i, canvas, scratch.corners)


@kernel
def read_out(
    canvas: Canvas, ids: NDArray[np.int32], view: Projection, depth: NDArray[np.float32], found: NDArray[np.int32]
) -> None:
    """Set depth (infinite in the sky) and instance ids of every pixel.

    Of a pixel with several samples it is the instance that most of them show, and of equals the nearest; the depth is
    that of its nearest sample.
    """
    if view.samples == 1:
        _read_samples(canvas, ids, depth, found)
        return
    for y in range(depth.shape[0]):
        for x in range(depth.shape[1]):
            row, column = y * 2, x * 2
            owner, nearness = canvas.owners[row, column], canvas.nearness[row, column]
            nearness = max(nearness, canvas.nearness[row, column + 1])
            nearness = max(nearness, canvas.nearness[row + 1, column])
            nearness = max(nearness, canvas.nearness[row + 1, column + 1])
            others = (
                canvas.owners[row, column + 1],
                canvas.owners[row + 1, column],
                canvas.owners[row + 1, column + 1],
            )
            if others[0] != owner or others[1] != owner or others[2] != owner:
                owner, nearness = _most_seen(canvas, ids, row, column)
            found[y, x] = _id_of(owner, ids)
            depth[y, x] = np.float32(1.0) / nearness if nearness > 0.0 else np.float32(np.inf)


@part
def _read_samples(canvas: Canvas, ids: NDArray[np.int32], depth: NDArray[np.float32], found: NDArray[np.int32]) -> None:
    """The same where a pixel is one sample: several depths are worked out at once."""
    nearness, owners = canvas.nearness, canvas.owners
    for y in range(depth.shape[0]):
        for x in range(depth.shape[1]):
            depth[y, x] = np.float32(1.0) / nearness[y, x]  # the sky's nearness is 0, and its depth infinite
        for x in range(depth.shape[1]):
            found[y, x] = _id_of(owners[y, x], ids)


@part
def _most_seen(canvas: Canvas, ids: NDArray[np.int32], row: int, column: int) -> tuple[int, np.float32]:
    """The owner of most of a pixel's four samples, the nearest of equals, and its greatest nearness."""
    best, most, nearest = SKY, 0, np.float32(-1.0)
    for k in range(4):
        owner = canvas.owners[row + (k >> 1), column + (k & 1)]
        count, nearness = 0, np.float32(0.0)
        for j in range(4):
            if _id_of(canvas.owners[row + (j >> 1), column + (j & 1)], ids) == _id_of(owner, ids):
                count += 1
                nearness = max(nearness, canvas.nearness[row + (j >> 1), column + (j & 1)])
        if count > most or (count == most and nearness > nearest):
            best, most, nearest = owner, count, nearness
    return best, nearest


@part
def _id_of(owner: int, ids: NDArray[np.int32]) -> int:
    if owner >= 0:
        return ids[owner]
    return 1 if owner == GROUND else 0
