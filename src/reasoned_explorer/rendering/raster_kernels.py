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
from numba import njit
from numpy.typing import NDArray

from reasoned_explorer.rendering.library import Library
from reasoned_explorer.rendering.projection import NEAR_M, Projection
from reasoned_explorer.rendering.scene import Cells, Instances

#: Owners of samples that no instance has.
SKY, GROUND = -1, -2
#: Edge of the blocks whose farthest sample is kept to find out what is hidden, samples.
SHIFT = 3
BLOCK = 1 << SHIFT
#: The ground ends here, metres along the view's axis.
GROUND_REACH_M = 10_000.0
_BUCKETS = 512
_SLACK = 1e-6
_LEAST_NEARNESS = 1.0 / GROUND_REACH_M
_MOST_NEARNESS = 1.0 / NEAR_M
#: Things that fill less than this across are left out, pixels.
_LEAST_SIZE = 0.7


class Canvas(NamedTuple):
    """What is seen in every sample.

    Attributes:
        nearness: 1 / depth, shape (height, width), float32; 0 is the sky.
        owners: The instance, `SKY` or `GROUND`, shape (height, width), int32.
        triangles: Its triangle in the library, shape (height, width), int32.
        farthest: The least nearness in each block, shape (⌈height / BLOCK⌉, ⌈width / BLOCK⌉), float32.
        stale: Whether a block's ``farthest`` may be too small, likewise, uint8.
    """

    nearness: NDArray[np.float32]
    owners: NDArray[np.int32]
    triangles: NDArray[np.int32]
    farthest: NDArray[np.float32]
    stale: NDArray[np.uint8]


class Scratch(NamedTuple):
    """Room for what is worked out on the way.

    Attributes:
        corners: Projected vertices of one thing: homogeneous x, y and z, and the picture's x and y, shape (v, 5).
        candidates: Instances in view, shape (n,), int32.
        ordered: The same from near to far, shape (n,), int32.
        nearest: Greatest nearness of each candidate, shape (n,), float64.
        rectangles: First and last column and row of each candidate, shape (n, 4), int32.
        levels: Level at which each instance was drawn, or -1, shape (n,), int8.
    """

    corners: NDArray[np.float64]
    candidates: NDArray[np.int32]
    ordered: NDArray[np.int32]
    nearest: NDArray[np.float64]
    rectangles: NDArray[np.int32]
    levels: NDArray[np.int8]


@njit(nogil=True, cache=True, fastmath=False, error_model="numpy")
def _fill_background(view: Projection, canvas: Canvas) -> None:
    """The plane z = 0 where it is seen, else the sky; the view has no roll, so that it is the same along a row."""
    for y in range(view.height):
        slope = view.axes[2, 2] + view.axes[1, 2] * (y + 0.5 - view.centre_y) / view.focal
        nearness = 0.0
        if view.eye[2] > 0.0 and slope < 0.0:
            nearness = -slope / view.eye[2]
        owner = GROUND
        if nearness < _LEAST_NEARNESS or nearness > _MOST_NEARNESS:
            owner, nearness = SKY, 0.0
        for x in range(view.width):
            canvas.nearness[y, x] = nearness
            canvas.owners[y, x] = owner
            canvas.triangles[y, x] = -1
    canvas.farthest[:] = 0.0
    canvas.stale[:] = 1


@njit(nogil=True, cache=True, fastmath=False, error_model="numpy")
def _matrix_of(instances: Instances, i: int, view: Projection, matrix: NDArray[np.float64]) -> None:
    """Set a (3, 4) matrix from an instance's own frame to homogeneous picture coordinates."""
    sine, cosine = instances.turns[i, 0], instances.turns[i, 1]
    scale_x, scale_y, scale_z = instances.scales[i, 0], instances.scales[i, 1], instances.scales[i, 2]
    x = instances.places[i, 0] - view.eye[0]
    y = instances.places[i, 1] - view.eye[1]
    z = instances.places[i, 2] - view.eye[2]
    for row in range(3):
        a, b, c = view.axes[2, 0], view.axes[2, 1], view.axes[2, 2]
        if row == 0:
            a = view.focal * view.axes[0, 0] + view.centre_x * a
            b = view.focal * view.axes[0, 1] + view.centre_x * b
            c = view.focal * view.axes[0, 2] + view.centre_x * c
        elif row == 1:
            a = view.focal * view.axes[1, 0] + view.centre_y * a
            b = view.focal * view.axes[1, 1] + view.centre_y * b
            c = view.focal * view.axes[1, 2] + view.centre_y * c
        matrix[row, 0] = (a * cosine - b * sine) * scale_x
        matrix[row, 1] = (a * sine + b * cosine) * scale_y
        matrix[row, 2] = c * scale_z
        matrix[row, 3] = a * x + b * y + c * z


@njit(nogil=True, cache=True, fastmath=False, error_model="numpy")
def _ball_in_view(ball: NDArray[np.float64], view: Projection) -> bool:
    """Whether a sphere may reach into the view."""
    x, y, z = ball[0] - view.eye[0], ball[1] - view.eye[1], ball[2] - view.eye[2]
    ahead = view.axes[2, 0] * x + view.axes[2, 1] * y + view.axes[2, 2] * z
    radius = ball[3]
    if ahead < NEAR_M - radius:
        return False
    right = abs(view.axes[0, 0] * x + view.axes[0, 1] * y + view.axes[0, 2] * z)
    slope = view.centre_x / view.focal
    if right > ahead * slope + radius * math.sqrt(1.0 + slope * slope):
        return False
    down = abs(view.axes[1, 0] * x + view.axes[1, 1] * y + view.axes[1, 2] * z)
    slope = view.centre_y / view.focal
    return down <= ahead * slope + radius * math.sqrt(1.0 + slope * slope)


@njit(nogil=True, cache=True, fastmath=False, error_model="numpy")
def _bound(
    box: NDArray[np.float64], matrix: NDArray[np.float64], view: Projection, rectangle: NDArray[np.int32]
) -> float:
    """Set the rectangle that a box may cover; return its greatest nearness, or 0 if it is not in the picture."""
    least_x, most_x, least_y, most_y = 1e30, -1e30, 1e30, -1e30
    least_z, most_z = 1e30, -1e30
    for corner in range(8):
        a, b, c = box[corner & 1, 0], box[(corner >> 1) & 1, 1], box[corner >> 2, 2]
        z = matrix[2, 0] * a + matrix[2, 1] * b + matrix[2, 2] * c + matrix[2, 3]
        least_z, most_z = min(least_z, z), max(most_z, z)
        if z > NEAR_M:
            x = (matrix[0, 0] * a + matrix[0, 1] * b + matrix[0, 2] * c + matrix[0, 3]) / z
            y = (matrix[1, 0] * a + matrix[1, 1] * b + matrix[1, 2] * c + matrix[1, 3]) / z
            least_x, most_x = min(least_x, x), max(most_x, x)
            least_y, most_y = min(least_y, y), max(most_y, y)
    if most_z < NEAR_M:
        return 0.0
    if least_z <= NEAR_M:  # around the eye: it may cover all
        least_x, most_x, least_y, most_y = 0.0, float(view.width), 0.0, float(view.height)
    first_x = math.ceil(max(least_x, 0.0) - 0.5 - _SLACK)
    last_x = math.floor(min(most_x, float(view.width)) - 0.5 + _SLACK)
    first_y = math.ceil(max(least_y, 0.0) - 0.5 - _SLACK)
    last_y = math.floor(min(most_y, float(view.height)) - 0.5 + _SLACK)
    rectangle[0], rectangle[1] = max(first_x, 0), min(last_x, view.width - 1)
    rectangle[2], rectangle[3] = max(first_y, 0), min(last_y, view.height - 1)
    if rectangle[0] > rectangle[1] or rectangle[2] > rectangle[3]:
        return 0.0
    return 1.0 / max(least_z, NEAR_M)


@njit(nogil=True, cache=True, fastmath=False, error_model="numpy")
def _refresh(canvas: Canvas, row: int, column: int) -> None:
    least = np.float32(1e30)
    height, width = canvas.nearness.shape
    for y in range(row * BLOCK, min(height, row * BLOCK + BLOCK)):
        for x in range(column * BLOCK, min(width, column * BLOCK + BLOCK)):
            least = min(least, canvas.nearness[y, x])
    canvas.farthest[row, column] = least
    canvas.stale[row, column] = 0


@njit(nogil=True, cache=True, fastmath=False, error_model="numpy")
def _hidden(canvas: Canvas, rectangle: NDArray[np.int32], nearest: float) -> bool:
    """Whether all that a rectangle covers is nearer than ``nearest`` already."""
    for row in range(rectangle[2] >> SHIFT, (rectangle[3] >> SHIFT) + 1):
        for column in range(rectangle[0] >> SHIFT, (rectangle[1] >> SHIFT) + 1):
            if canvas.farthest[row, column] < nearest:
                if not canvas.stale[row, column]:
                    return False
                _refresh(canvas, row, column)
                if canvas.farthest[row, column] < nearest:
                    return False
    return True


@njit(nogil=True, cache=True, fastmath=False, error_model="numpy")
def _mark_stale(canvas: Canvas, rectangle: NDArray[np.int32]) -> None:
    for row in range(rectangle[2] >> SHIFT, (rectangle[3] >> SHIFT) + 1):
        for column in range(rectangle[0] >> SHIFT, (rectangle[1] >> SHIFT) + 1):
            canvas.stale[row, column] = 1


@njit(nogil=True, cache=True, fastmath=False, error_model="numpy")
def _level_of(library: Library, instances: Instances, i: int, distance: float, pixels: float, density: float) -> int:
    """Which level of detail: the finest with at most ``density`` triangles for each pixel that the thing may fill."""
    radius = instances.balls[i, 3] * pixels / max(distance, 0.25)
    wanted = density * math.pi * radius * radius + 12.0
    first = library.prototypes[instances.prototypes[i], 0]
    count = library.prototypes[instances.prototypes[i], 1]
    for level in range(count - 1):
        if library.levels[first + level, 3] <= wanted:
            return level
    return count - 1


@njit(nogil=True, cache=True, fastmath=False, error_model="numpy")
def _cross_near(
    corners: NDArray[np.float64], a: int, b: int, bounds: tuple[float, float, float, float]
) -> tuple[float, float, float, float]:
    """Widen bounds by where an edge goes through the near plane, if it does."""
    za, zb = corners[a, 2], corners[b, 2]
    if (za > NEAR_M) == (zb > NEAR_M):
        return bounds
    t = (NEAR_M - za) / (zb - za)
    x = (corners[a, 0] + t * (corners[b, 0] - corners[a, 0])) / NEAR_M
    y = (corners[a, 1] + t * (corners[b, 1] - corners[a, 1])) / NEAR_M
    return min(bounds[0], x - 0.5), max(bounds[1], x + 0.5), min(bounds[2], y - 0.5), max(bounds[3], y + 0.5)


@njit(nogil=True, cache=True, fastmath=False, error_model="numpy")
def _bounds_across_near(corners: NDArray[np.float64], a: int, b: int, c: int) -> tuple[float, float, float, float]:
    """What a triangle that goes through the near plane covers at most."""
    bounds = (1e30, -1e30, 1e30, -1e30)
    for k in (a, b, c):
        if corners[k, 2] > NEAR_M:
            x, y = corners[k, 3], corners[k, 4]
            bounds = (min(bounds[0], x), max(bounds[1], x), min(bounds[2], y), max(bounds[3], y))
    bounds = _cross_near(corners, a, b, bounds)
    bounds = _cross_near(corners, b, c, bounds)
    return _cross_near(corners, c, a, bounds)


@njit(nogil=True, cache=True, fastmath=False, error_model="numpy")
def _narrow(slope: float, rest: float, low: float, high: float) -> tuple[float, float]:
    """Where slope · x + rest ≥ 0, between low and high, a little too wide."""
    if slope > 0.0:
        return max(low, -rest / slope - 1.0), high
    if slope < 0.0:
        return low, min(high, -rest / slope + 1.0)
    return low, high


@njit(nogil=True, cache=True, fastmath=False, error_model="numpy")
def _fill_triangle(
    corners: NDArray[np.float64], a: int, b: int, c: int, owner: int, triangle: int, view: Projection, canvas: Canvas
) -> None:
    """Keep a triangle wherever it is nearest and faces the eye."""
    if corners[a, 2] > NEAR_M and corners[b, 2] > NEAR_M and corners[c, 2] > NEAR_M:
        xa, xb, xc = corners[a, 3], corners[b, 3], corners[c, 3]
        ya, yb, yc = corners[a, 4], corners[b, 4], corners[c, 4]
        least_x, most_x = min(xa, min(xb, xc)), max(xa, max(xb, xc))
        least_y, most_y = min(ya, min(yb, yc)), max(ya, max(yb, yc))
    elif corners[a, 2] > NEAR_M or corners[b, 2] > NEAR_M or corners[c, 2] > NEAR_M:
        least_x, most_x, least_y, most_y = _bounds_across_near(corners, a, b, c)
    else:
        return
    first_x = math.ceil(max(least_x, 0.0) - 0.5 - _SLACK)
    last_x = math.floor(min(most_x, float(view.width)) - 0.5 + _SLACK)
    if first_x > last_x:
        return
    first_y = math.ceil(max(least_y, 0.0) - 0.5 - _SLACK)
    last_y = math.floor(min(most_y, float(view.height)) - 0.5 + _SLACK)
    if first_y > last_y:
        return
    x0, y0, z0 = corners[a, 0], corners[a, 1], corners[a, 2]
    x1, y1, z1 = corners[c, 0], corners[c, 1], corners[c, 2]  # what faces the eye turns the other way on the screen
    x2, y2, z2 = corners[b, 0], corners[b, 1], corners[b, 2]
    # Each edge function is slope_x · x + slope_y · y + rest: positive within, and exactly opposite for a neighbour.
    ax0, ay0, ar0 = y1 * z2 - z1 * y2, z1 * x2 - x1 * z2, x1 * y2 - y1 * x2
    determinant = x0 * ax0 + y0 * ay0 + z0 * ar0
    if not determinant > 0.0:
        return
    ax1, ay1, ar1 = y2 * z0 - z2 * y0, z2 * x0 - x2 * z0, x2 * y0 - y2 * x0
    ax2, ay2, ar2 = y0 * z1 - z0 * y1, z0 * x1 - x0 * z1, x0 * y1 - y0 * x1
    inverse = 1.0 / determinant
    first_x, last_x = max(first_x, 0), min(last_x, view.width - 1)
    first_y, last_y = max(first_y, 0), min(last_y, view.height - 1)
    owns0 = ax0 > 0.0 or (ax0 == 0.0 and ay0 > 0.0)
    owns1 = ax1 > 0.0 or (ax1 == 0.0 and ay1 > 0.0)
    owns2 = ax2 > 0.0 or (ax2 == 0.0 and ay2 > 0.0)
    wide = last_x - first_x > 12
    for y in range(first_y, last_y + 1):
        middle = y + 0.5
        rest0, rest1, rest2 = ay0 * middle + ar0, ay1 * middle + ar1, ay2 * middle + ar2
        low, high = first_x, last_x
        if wide:
            span = float(first_x), float(last_x)
            span = _narrow(ax0, rest0, span[0], span[1])
            span = _narrow(ax1, rest1, span[0], span[1])
            span = _narrow(ax2, rest2, span[0], span[1])
            if span[0] > span[1] + 1.0:
                continue
            low, high = max(first_x, math.floor(span[0])), min(last_x, math.ceil(span[1]))
        for x in range(low, high + 1):
            across = x + 0.5
            edge0 = ax0 * across + rest0
            edge1 = ax1 * across + rest1
            edge2 = ax2 * across + rest2
            if edge0 < 0.0 or edge1 < 0.0 or edge2 < 0.0:
                continue
            if (edge0 == 0.0 and not owns0) or (edge1 == 0.0 and not owns1) or (edge2 == 0.0 and not owns2):
                continue
            nearness = np.float32((edge0 + edge1 + edge2) * inverse)
            if nearness > canvas.nearness[y, x] and nearness <= _MOST_NEARNESS:
                canvas.nearness[y, x] = nearness
                canvas.owners[y, x] = owner
                canvas.triangles[y, x] = triangle


@njit(nogil=True, cache=True, fastmath=False, error_model="numpy")
def _draw_level(
    library: Library,
    level: int,
    matrix: NDArray[np.float64],
    owner: int,
    view: Projection,
    canvas: Canvas,
    corners: NDArray[np.float64],
) -> None:
    first, count = library.levels[level, 0], library.levels[level, 1]
    for k in range(count):
        a, b, c = library.vertices[first + k, 0], library.vertices[first + k, 1], library.vertices[first + k, 2]
        x = matrix[0, 0] * a + matrix[0, 1] * b + matrix[0, 2] * c + matrix[0, 3]
        y = matrix[1, 0] * a + matrix[1, 1] * b + matrix[1, 2] * c + matrix[1, 3]
        z = matrix[2, 0] * a + matrix[2, 1] * b + matrix[2, 2] * c + matrix[2, 3]
        corners[k, 0], corners[k, 1], corners[k, 2] = x, y, z
        inverse = 1.0 / z
        corners[k, 3], corners[k, 4] = x * inverse, y * inverse
    for triangle in range(library.levels[level, 2], library.levels[level, 2] + library.levels[level, 3]):
        _fill_triangle(
            corners,
            library.triangles[triangle, 0] - first,
            library.triangles[triangle, 1] - first,
            library.triangles[triangle, 2] - first,
            owner,
            triangle,
            view,
            canvas,
        )


@njit(nogil=True, cache=True, fastmath=False, error_model="numpy")
def _collect(
    library: Library,
    instances: Instances,
    cells: Cells,
    view: Projection,
    everything: bool,
    scratch: Scratch,
    matrix: NDArray[np.float64],
) -> int:
    """Set the candidates: what may be in the picture. Returns how many."""
    count = 0
    pixels = view.focal / view.samples
    for cell in range(cells.balls.shape[0]):
        if not everything and not _ball_in_view(cells.balls[cell], view):
            continue
        for k in range(cells.starts[cell], cells.starts[cell + 1]):
            i = cells.members[k]
            ball = instances.balls[i]
            if not everything:
                if not _ball_in_view(ball, view):
                    continue
                x, y, z = ball[0] - view.eye[0], ball[1] - view.eye[1], ball[2] - view.eye[2]
                size = 2.0 * ball[3] * pixels
                if size * size < _LEAST_SIZE * _LEAST_SIZE * (x * x + y * y + z * z):
                    continue
            _matrix_of(instances, i, view, matrix)
            nearest = _bound(library.boxes[instances.prototypes[i]], matrix, view, scratch.rectangles[count])
            if nearest > 0.0:
                scratch.candidates[count] = i
                scratch.nearest[count] = nearest
                count += 1
    return count


@njit(nogil=True, cache=True, fastmath=False, error_model="numpy")
def _order(scratch: Scratch, count: int) -> None:
    """Order candidates roughly from near to far."""
    starts = np.zeros(_BUCKETS + 1, np.int32)
    keys = np.empty(count, np.int32)
    for k in range(count):
        keys[k] = min(_BUCKETS - 1, int(40.0 * math.log2(1.0 + 1.0 / scratch.nearest[k])))
        starts[keys[k] + 1] += 1
    for bucket in range(_BUCKETS):
        starts[bucket + 1] += starts[bucket]
    for k in range(count):
        scratch.ordered[starts[keys[k]]] = k
        starts[keys[k]] += 1


@njit(nogil=True, cache=True, fastmath=False, error_model="numpy")
def draw(
    library: Library,
    instances: Instances,
    cells: Cells,
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
        cells: A grid over them.
        view: The camera.
        density: Triangles for each pixel at most, where a model has levels to choose from.
        everything: Draw all, at full detail, whether it is hidden or not: a reference that is slow.
        canvas: Set.
        scratch: Room; its ``levels`` say what was drawn.
    """
    _fill_background(view, canvas)
    matrix = np.empty((3, 4))
    scratch.levels[:] = -1
    count = _collect(library, instances, cells, view, everything, scratch, matrix)
    _order(scratch, count)
    pixels = view.focal / view.samples
    for turn in range(count):
        k = scratch.ordered[turn]
        rectangle = scratch.rectangles[k]
        if not everything and _hidden(canvas, rectangle, scratch.nearest[k]):
            continue
        i = scratch.candidates[k]
        level = 0
        if not everything:
            x = instances.balls[i, 0] - view.eye[0]
            y = instances.balls[i, 1] - view.eye[1]
            z = instances.balls[i, 2] - view.eye[2]
            level = _level_of(library, instances, i, math.sqrt(x * x + y * y + z * z), pixels, density)
        scratch.levels[i] = level
        _matrix_of(instances, i, view, matrix)
        first = library.prototypes[instances.prototypes[i], 0]
        _draw_level(library, first + level, matrix, i, view, canvas, scratch.corners)
        _mark_stale(canvas, rectangle)


@njit(nogil=True, cache=True, fastmath=False, error_model="numpy")
def read_out(
    canvas: Canvas, ids: NDArray[np.int32], view: Projection, depth: NDArray[np.float32], found: NDArray[np.int32]
) -> None:
    """Set depth (infinite in the sky) and instance ids of every pixel.

    Of a pixel with several samples it is the instance that most of them show, and of equals the nearest; the depth is
    that of its nearest sample.
    """
    samples = view.samples
    for y in range(depth.shape[0]):
        for x in range(depth.shape[1]):
            row, column = y * samples, x * samples
            owner, nearness = canvas.owners[row, column], canvas.nearness[row, column]
            if samples == 2:
                nearness = max(
                    max(nearness, canvas.nearness[row, column + 1]),
                    max(canvas.nearness[row + 1, column], canvas.nearness[row + 1, column + 1]),
                )
                others = (
                    canvas.owners[row, column + 1],
                    canvas.owners[row + 1, column],
                    canvas.owners[row + 1, column + 1],
                )
                if others[0] != owner or others[1] != owner or others[2] != owner:
                    owner, nearness = _most_seen(canvas, ids, row, column)
            found[y, x] = _id_of(owner, ids)
            depth[y, x] = np.float32(1.0) / nearness if nearness > 0.0 else np.float32(np.inf)


@njit(nogil=True, cache=True, fastmath=False, error_model="numpy")
def _most_seen(canvas: Canvas, ids: NDArray[np.int32], row: int, column: int) -> tuple[int, float]:
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


@njit(nogil=True, cache=True, fastmath=False, error_model="numpy")
def _id_of(owner: int, ids: NDArray[np.int32]) -> int:
    if owner >= 0:
        return ids[owner]
    return 1 if owner == GROUND else 0
