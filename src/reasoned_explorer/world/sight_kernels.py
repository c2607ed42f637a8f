"""Sight lines at machine speed: a uniform grid over walls and discs, walked ray by ray.

The traversal is Amanatides and Woo's ("A fast voxel traversal algorithm for ray tracing", Eurographics 1987), in two
dimensions: what a ray costs depends on what stands along it, not on how large the world is.

What kernels are given is built by `reasoned_explorer.world.sight`.
"""

import math
from typing import NamedTuple

import numpy as np
from numba import njit
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

BUILDING, OBJECT = 1, 2
# Columns of ``targets``.
X, Y, HALF_LENGTH, HALF_WIDTH, HEIGHT, SIN, COS, SHAPE, NORMAL_X, NORMAL_Y, FIRST, LAST, CENTRE_X, CENTRE_Y = range(14)
# Shapes: round, an oblong box, a front on a wall (seen from before it only), a flat area with an outline.
ROUND, BOX, FRONT, AREA = 0.0, 1.0, 2.0, 3.0


class Grid(NamedTuple):
    """Walls and discs, and a grid over them.

    Attributes:
        header: Shape (5,): west edge, south edge, cell side (metres), columns, rows.
        starts: Items of cell ``row * columns + column`` are ``members[starts[cell]:starts[cell + 1]]``.
        members: Rows of ``items``.
        items: Shape (n, 8): 0 a wall / 1 a disc / 2 the square around a disc; x0, y0, x1, y1 / x, y, radius, unused;
            underside and top (metres); the share of light that passes.
        owners: Shape (n, 3): 1 a building / 2 an object; its place in the world's list; whether it blocks clear sight.
    """

    header: FloatArray
    starts: IntArray
    members: IntArray
    items: FloatArray
    owners: IntArray


class Targets(NamedTuple):
    """What can be looked for.

    Attributes:
        table: Shape (n, 14), one row per object of the world; its columns are this module's constants.
        corners: Shape (k, 2): outlines of the objects that are areas.
    """

    table: FloatArray
    corners: FloatArray


_PAD_M = 0.01
_DARK = 0.02
#: Half of the angle that a round thing fills for one who is in it.
_WITHIN = 0.6
#: What is less far ahead than this is not before the axis.
_BEFORE_M = 0.05
_FAR = 1e18
#: What stands within the last quarter of a metre hides nothing: targets stand on walls.
END_M = 0.25


@njit(cache=True)
def _meets_cell(item: FloatArray, x0: float, y0: float, x1: float, y1: float) -> bool:
    """Whether an item touches a cell (already widened by the pad)."""
    if item[0] == 2.0:
        return True
    if item[0] == 1.0:
        near_x = min(max(item[1], x0), x1) - item[1]
        near_y = min(max(item[2], y0), y1) - item[2]
        return bool(near_x * near_x + near_y * near_y <= item[3] * item[3])
    if max(item[1], item[3]) < x0 or min(item[1], item[3]) > x1:
        return False
    if max(item[2], item[4]) < y0 or min(item[2], item[4]) > y1:
        return False
    # Separating axis: the wall's normal.
    normal_x, normal_y = item[4] - item[2], item[1] - item[3]
    offset = normal_x * (0.5 * (x0 + x1) - item[1]) + normal_y * (0.5 * (y0 + y1) - item[2])
    return bool(abs(offset) <= 0.5 * (abs(normal_x) * (x1 - x0) + abs(normal_y) * (y1 - y0)))


@njit(cache=True)
def _cell_range(item: FloatArray, grid: FloatArray) -> tuple[int, int, int, int]:
    """First and last column and row that an item's rectangle covers."""
    if item[0] >= 1.0:
        x0, x1, y0, y1 = item[1] - item[3], item[1] + item[3], item[2] - item[3], item[2] + item[3]
    else:
        x0, x1 = min(item[1], item[3]), max(item[1], item[3])
        y0, y1 = min(item[2], item[4]), max(item[2], item[4])
    columns, rows = int(grid[3]), int(grid[4])
    i0 = min(max(math.floor((x0 - _PAD_M - grid[0]) / grid[2]), 0), columns - 1)
    i1 = min(max(math.floor((x1 + _PAD_M - grid[0]) / grid[2]), 0), columns - 1)
    j0 = min(max(math.floor((y0 - _PAD_M - grid[1]) / grid[2]), 0), rows - 1)
    j1 = min(max(math.floor((y1 + _PAD_M - grid[1]) / grid[2]), 0), rows - 1)
    return i0, i1, j0, j1


@njit(cache=True)
def fill_grid(items: FloatArray, grid: FloatArray) -> tuple[IntArray, IntArray]:
    """Return (starts, members) of a grid over items."""
    columns, cells = int(grid[3]), int(grid[3]) * int(grid[4])
    starts = np.zeros(cells + 1, np.int64)
    members = np.empty(0, np.int64)
    for turn in range(2):  # first count, then fill
        if turn == 1:
            for cell in range(cells):
                starts[cell + 1] += starts[cell]
            members = np.empty(starts[cells], np.int64)
            cursor = starts[:cells].copy()
        for k in range(items.shape[0]):
            i0, i1, j0, j1 = _cell_range(items[k], grid)
            for j in range(j0, j1 + 1):
                y0 = grid[1] + j * grid[2] - _PAD_M
                for i in range(i0, i1 + 1):
                    x0 = grid[0] + i * grid[2] - _PAD_M
                    if _meets_cell(items[k], x0, y0, x0 + grid[2] + 2 * _PAD_M, y0 + grid[2] + 2 * _PAD_M):
                        if turn == 0:
                            starts[j * columns + i + 1] += 1
                        else:
                            members[cursor[j * columns + i]] = k
                            cursor[j * columns + i] += 1
    return starts, members


@njit(cache=True)
def _clip_to_grid(grid: FloatArray, x0: float, y0: float, dx: float, dy: float) -> tuple[float, float]:
    """The stretch [t0, t1] of a ray x0 + t dx, t in [0, 1], that lies over the grid; t0 > t1 where none does."""
    t0, t1 = 0.0, 1.0
    for axis in range(2):
        origin, step = (x0, dx) if axis == 0 else (y0, dy)
        low, high = grid[axis], grid[axis] + grid[2] * grid[3 + axis]
        if step == 0.0:
            if origin < low or origin > high:
                return 1.0, 0.0
        else:
            ta, tb = (low - origin) / step, (high - origin) / step
            t0, t1 = max(t0, min(ta, tb)), min(t1, max(ta, tb))
    return t0, t1


@njit(cache=True)
def _first_step(
    origin: float, step: float, low: float, side: float, count: int, t: float
) -> tuple[int, int, float, float]:
    """Where a walk along one axis begins: cell, direction, t of the next border, t from border to border."""
    cell = min(max(math.floor((origin + t * step - low) / side), 0), count - 1)
    if step > 0.0:
        return cell, 1, (low + (cell + 1) * side - origin) / step, side / step
    if step < 0.0:
        return cell, -1, (low + cell * side - origin) / step, -side / step
    return cell, 0, _FAR, _FAR


@njit(cache=True)
def _meets_ray(item: FloatArray, x0: float, y0: float, dx: float, dy: float) -> tuple[float, float]:
    """Where a ray enters and leaves an item, as (t in, t out); t in is negative where it does not meet it."""
    if item[0] == 0.0:
        wall_x, wall_y = item[3] - item[1], item[4] - item[2]
        across = dx * wall_y - dy * wall_x
        if across == 0.0:
            return -1.0, -1.0
        to_x, to_y = item[1] - x0, item[2] - y0
        u = (to_x * dy - to_y * dx) / across
        if u < 0.0 or u > 1.0:
            return -1.0, -1.0
        t = (to_x * wall_y - to_y * wall_x) / across
        return t, t
    to_x, to_y = x0 - item[1], y0 - item[2]
    a = dx * dx + dy * dy
    b = to_x * dx + to_y * dy
    c = to_x * to_x + to_y * to_y - item[3] * item[3]
    under_root = b * b - a * c
    if under_root <= 0.0:
        return -1.0, -1.0
    root = math.sqrt(under_root)
    t_out = (-b + root) / a
    if t_out < 0.0:
        return -1.0, -1.0
    return max(0.0, (-b - root) / a), t_out


@njit(cache=True)
def pass_share(
    grid: Grid,
    x0: float,
    y0: float,
    z0: float,
    x1: float,
    y1: float,
    z1: float,
    ignore: int,
    end_m: float,
    blocks_only: bool,
) -> float:
    """Return the share of light that gets from one point to another, in [0, 1].

    ``ignore`` is an object that hides nothing; what stands within the last ``end_m`` metres hides nothing either (a
    target on a wall). With ``blocks_only`` only items whose owner blocks sight count.
    """
    header, starts, members, items = grid.header, grid.starts, grid.members, grid.items
    dx, dy = x1 - x0, y1 - y0
    length = math.sqrt(dx * dx + dy * dy)
    if length <= end_m or length < 1e-9:
        return 1.0
    t_here, t_end = _clip_to_grid(header, x0, y0, dx, dy)
    t_end = min(t_end, 1.0 - end_m / length)
    if t_here >= t_end:
        return 1.0
    columns, rows = int(header[3]), int(header[4])
    i, step_i, t_i, delta_i = _first_step(x0, dx, header[0], header[2], columns, t_here)
    j, step_j, t_j, delta_j = _first_step(y0, dy, header[1], header[2], rows, t_here)
    passed = 1.0
    while True:
        t_out = min(t_i, t_j, t_end)
        for place in range(starts[j * columns + i], starts[j * columns + i + 1]):
            k = members[place]
            if blocks_only and grid.owners[k, 2] == 0:
                continue
            if grid.owners[k, 0] == OBJECT and grid.owners[k, 1] == ignore:
                continue
            t_in, t_leave = _meets_ray(items[k], x0, y0, dx, dy)
            # An item in many cells counts in the one where the ray enters it.
            if t_in < t_here or t_in >= t_out:
                continue
            z_in, z_leave = z0 + t_in * (z1 - z0), z0 + min(t_leave, 1.0) * (z1 - z0)
            if max(z_in, z_leave) < items[k, 5] or min(z_in, z_leave) > items[k, 6]:
                continue
            passed *= items[k, 7]
            if passed < _DARK:
                return 0.0
        if t_out >= t_end:
            return passed
        t_here = t_out
        if t_i < t_j:
            i += step_i
            t_i += delta_i
        else:
            j += step_j
            t_j += delta_j
        if i < 0 or j < 0 or i >= columns or j >= rows:
            return passed


@njit(cache=True)
def clear_many(grid: Grid, eyes: FloatArray, points: FloatArray, ignore: int) -> NDArray[np.bool_]:
    """Return which lines from eyes to points, both of shape (n, 3), nothing that blocks sight cuts."""
    clear = np.empty(eyes.shape[0], np.bool_)
    for k in range(eyes.shape[0]):
        x0, y0, z0 = eyes[k, 0], eyes[k, 1], eyes[k, 2]
        x1, y1, z1 = points[k, 0], points[k, 1], points[k, 2]
        clear[k] = pass_share(grid, x0, y0, z0, x1, y1, z1, ignore, END_M, True) > 0.0
    return clear


@njit(cache=True)
def first_hit(
    grid: Grid, x0: float, y0: float, z: float, sin_h: float, cos_h: float, max_m: float, kind: int
) -> tuple[float, int]:
    """Return (distance, item) of the first thing on a level ray, (max_m, -1) where there is none.

    ``kind`` is 0 for anything, or the kind of owner that counts.
    """
    header, starts, members, items = grid.header, grid.starts, grid.members, grid.items
    dx, dy = sin_h * max_m, cos_h * max_m
    t_here, t_end = _clip_to_grid(header, x0, y0, dx, dy)
    if t_here >= t_end:
        return max_m, -1
    columns, rows = int(header[3]), int(header[4])
    i, step_i, t_i, delta_i = _first_step(x0, dx, header[0], header[2], columns, t_here)
    j, step_j, t_j, delta_j = _first_step(y0, dy, header[1], header[2], rows, t_here)
    best, best_item = 1.0, -1
    while True:
        t_out = min(t_i, t_j, t_end)
        for place in range(starts[j * columns + i], starts[j * columns + i + 1]):
            k = members[place]
            if (kind != 0 and grid.owners[k, 0] != kind) or z < items[k, 5] or z > items[k, 6]:
                continue
            t_in, _ = _meets_ray(items[k], x0, y0, dx, dy)
            if t_in >= 0.0 and (t_in < best or (t_in == best and k < best_item)):
                best, best_item = t_in, k
        if (best_item >= 0 and best <= t_out) or t_out >= t_end:
            return (best * max_m, best_item) if best_item >= 0 else (max_m, -1)
        t_here = t_out
        if t_i < t_j:
            i += step_i
            t_i += delta_i
        else:
            j += step_j
            t_j += delta_j
        if i < 0 or j < 0 or i >= columns or j >= rows:
            return (best * max_m, best_item) if best_item >= 0 else (max_m, -1)


@njit(cache=True)
def gather(grid: Grid, x0: float, y0: float, x1: float, y1: float, z: float) -> IntArray:
    """Return the sorted places of all items that stand at height z and whose rectangle meets a given one."""
    header, starts, members, items = grid.header, grid.starts, grid.members, grid.items
    columns, rows = int(header[3]), int(header[4])
    i0 = max(math.floor((x0 - header[0]) / header[2]), 0)
    i1 = min(math.floor((x1 - header[0]) / header[2]), columns - 1)
    j0 = max(math.floor((y0 - header[1]) / header[2]), 0)
    j1 = min(math.floor((y1 - header[1]) / header[2]), rows - 1)
    count = 0
    for j in range(j0, j1 + 1):
        for i in range(i0, i1 + 1):
            count += starts[j * columns + i + 1] - starts[j * columns + i]
    found = np.empty(max(count, 0), np.int64)
    count = 0
    for j in range(j0, j1 + 1):
        for i in range(i0, i1 + 1):
            for place in range(starts[j * columns + i], starts[j * columns + i + 1]):
                k = members[place]
                if z < items[k, 5] or z > items[k, 6] or not _meets_cell(items[k], x0, y0, x1, y1):
                    continue
                found[count] = k
                count += 1
    found = np.sort(found[:count])
    kept = 0
    for place in range(count):
        if place == 0 or found[place] != found[place - 1]:
            found[kept] = found[place]
            kept += 1
    return found[:kept]


@njit(cache=True)
def split(grid: Grid, places: IntArray) -> tuple[FloatArray, IntArray, IntArray, FloatArray, IntArray]:
    """Return the items at some places as walls with their buildings and objects, and discs with their objects."""
    items, owners = grid.items, grid.owners
    discs_kept = 0
    for k in places:
        if items[k, 0] == 1.0:
            discs_kept += 1
    walls_kept = len(places) - discs_kept
    walls, wall_building = np.empty((walls_kept, 4)), np.empty(walls_kept, np.int64)
    wall_object = np.empty(walls_kept, np.int64)
    discs, disc_object = np.empty((discs_kept, 3)), np.empty(discs_kept, np.int64)
    walls_kept = discs_kept = 0
    for k in places:
        if items[k, 0] == 1.0:
            discs[discs_kept] = items[k, 1:4]
            disc_object[discs_kept] = owners[k, 1]
            discs_kept += 1
        else:
            walls[walls_kept] = items[k, 1:5]
            wall_building[walls_kept] = owners[k, 1] if owners[k, 0] == BUILDING else -1
            wall_object[walls_kept] = owners[k, 1] if owners[k, 0] == OBJECT else -1
            walls_kept += 1
    return walls, wall_building, wall_object, discs, disc_object


@njit(cache=True)
def bearing(dx: float, dy: float, sin_h: float, cos_h: float) -> float:
    """Return the bearing of an offset from an axis (its sine and cosine are given), positive to the right."""
    return math.atan2(dx * cos_h - dy * sin_h, dx * sin_h + dy * cos_h)


@njit(cache=True)
def _turn(angle: float) -> float:
    """The same turn in [-π, π]."""
    if angle > math.pi:
        return angle - 2.0 * math.pi
    if angle < -math.pi:
        return angle + 2.0 * math.pi
    return angle


@njit(cache=True)
def _area_extent(
    target: FloatArray, corners: FloatArray, x: float, y: float, sin_h: float, cos_h: float
) -> tuple[float, float, float, float]:
    """As `extent`; only what lies before the axis counts (no camera sees half of the horizon)."""
    first, last = int(target[FIRST]), int(target[LAST])
    inside, near, far, lowest, highest = False, _FAR, 0.0, _FAR, -_FAR
    ax, ay = corners[last - 1, 0] - x, corners[last - 1, 1] - y
    ahead, right = ax * sin_h + ay * cos_h, ax * cos_h - ay * sin_h
    for k in range(first, last):
        bx, by = corners[k, 0] - x, corners[k, 1] - y
        next_ahead, next_right = bx * sin_h + by * cos_h, bx * cos_h - by * sin_h
        far = max(far, bx * bx + by * by)
        dx, dy = bx - ax, by - ay
        square = dx * dx + dy * dy
        t = min(max(-(ax * dx + ay * dy) / square, 0.0), 1.0) if square > 0.0 else 0.0
        near = min(near, (ax + t * dx) ** 2 + (ay + t * dy) ** 2)
        if (ay > 0.0) != (by > 0.0) and ax - dx * ay / dy > 0.0:
            inside = not inside
        if next_ahead > _BEFORE_M:
            lowest, highest = min(lowest, next_right / next_ahead), max(highest, next_right / next_ahead)
        if (ahead > _BEFORE_M) != (next_ahead > _BEFORE_M):
            cut = right + (next_right - right) * (_BEFORE_M - ahead) / (next_ahead - ahead)
            lowest, highest = min(lowest, cut / _BEFORE_M), max(highest, cut / _BEFORE_M)
        ax, ay, ahead, right = bx, by, next_ahead, next_right
    if inside:
        return -math.pi, math.pi, 0.0, math.sqrt(far)
    if highest < lowest:
        return 1.0, -1.0, math.sqrt(near), math.sqrt(far)
    return math.atan(lowest), math.atan(highest), math.sqrt(near), math.sqrt(far)


@njit(cache=True)
def extent(
    target: FloatArray, corners: FloatArray, x: float, y: float, sin_h: float, cos_h: float
) -> tuple[float, float, float, float]:
    """Return how a target is seen from a point: (leftmost, rightmost bearing, nearest, farthest distance).

    Bearings are from the axis whose sine and cosine are given, and may pass ±π. What cannot be seen from there at all
    (a front, from behind) has its rightmost bearing left of its leftmost.
    """
    shape = target[SHAPE]
    if shape == AREA:
        of_area: tuple[float, float, float, float] = _area_extent(target, corners, x, y, sin_h, cos_h)
        return of_area
    dx, dy = target[X] - x, target[Y] - y
    distance = math.sqrt(dx * dx + dy * dy)
    middle = bearing(dx, dy, sin_h, cos_h)
    if shape == ROUND:
        radius = target[HALF_LENGTH]
        if distance <= radius:  # under a crown, in a basin: the middle of it is what one looks at
            return middle - _WITHIN, middle + _WITHIN, 0.0, distance + radius
        half = math.asin(radius / distance)
        return middle - half, middle + half, distance - radius, distance + radius
    # The object's right hand (cos, -sin) and its front (sin, cos).
    right_x, right_y, front_x, front_y = target[COS], -target[SIN], target[SIN], target[COS]
    half_length, half_width = target[HALF_LENGTH], target[HALF_WIDTH]
    if shape == FRONT:
        right_x, right_y = target[NORMAL_Y], -target[NORMAL_X]
        if -dx * target[NORMAL_X] - dy * target[NORMAL_Y] <= 0.0:
            return 1.0, -1.0, distance, distance
        half_width = 0.0
    along, across = -dx * right_x - dy * right_y, -dx * front_x - dy * front_y
    if shape == FRONT:
        across = -dx * target[NORMAL_X] - dy * target[NORMAL_Y]
    near = math.hypot(max(abs(along) - half_length, 0.0), max(abs(across) - half_width, 0.0))
    if near == 0.0:
        return -math.pi, math.pi, 0.0, half_length
    lowest, highest = _FAR, -_FAR
    for side in range(4):
        u = half_length if side & 1 else -half_length
        v = half_width if side & 2 else -half_width
        turn = _turn(bearing(dx + u * right_x + v * front_x, dy + u * right_y + v * front_y, sin_h, cos_h) - middle)
        lowest, highest = min(lowest, turn), max(highest, turn)
    return middle + lowest, middle + highest, near, distance + half_length


@njit(cache=True)
def clip_bearings(low: float, high: float, half_fov: float) -> tuple[float, float]:
    """The part of [low, high] that lies in [-half_fov, half_fov], turning by 2π where that brings it into view."""
    best_low, best_high = 1.0, -1.0
    for turn in range(-1, 2):
        a = max(low + turn * 2.0 * math.pi, -half_fov)
        b = min(high + turn * 2.0 * math.pi, half_fov)
        if b > a and b - a > best_high - best_low:
            best_low, best_high = a, b
    return best_low, best_high


@njit(cache=True)
def _reach(
    target: FloatArray, corners: FloatArray, x: float, y: float, sin_r: float, cos_r: float, near: float
) -> tuple[float, float]:
    """Where a ray (sin_r, cos_r) enters and leaves a target; ``near`` for both where it slips past an edge."""
    shape = target[SHAPE]
    dx, dy = target[X] - x, target[Y] - y
    if shape == ROUND:
        middle = dx * sin_r + dy * cos_r
        under_root = middle * middle - (dx * dx + dy * dy) + target[HALF_LENGTH] * target[HALF_LENGTH]
        root = math.sqrt(max(under_root, 0.0))
        return max(middle - root, 0.0), middle + root
    if shape == FRONT:
        towards = sin_r * target[NORMAL_X] + cos_r * target[NORMAL_Y]
        if towards >= -1e-6:
            return near, near
        distance = (dx * target[NORMAL_X] + dy * target[NORMAL_Y]) / towards
        return distance, distance
    if shape == BOX:
        t_in, t_out = -_FAR, _FAR
        for axis in range(2):
            ax, ay = (target[COS], -target[SIN]) if axis == 0 else (target[SIN], target[COS])
            half = target[HALF_LENGTH] if axis == 0 else target[HALF_WIDTH]
            offset, step = dx * ax + dy * ay, sin_r * ax + cos_r * ay
            if abs(step) > 1e-9:
                ta, tb = (offset - half) / step, (offset + half) / step
                t_in, t_out = max(t_in, min(ta, tb)), min(t_out, max(ta, tb))
        return (max(t_in, 0.0), t_out) if t_in <= t_out and t_out > 0.0 else (near, near)
    t_in, t_out, crossings = _FAR, -_FAR, 0
    first, last = int(target[FIRST]), int(target[LAST])
    ax, ay = corners[last - 1, 0] - x, corners[last - 1, 1] - y
    right = ax * cos_r - ay * sin_r
    for k in range(first, last):
        bx, by = corners[k, 0] - x, corners[k, 1] - y
        next_right = bx * cos_r - by * sin_r
        if (right > 0.0) != (next_right > 0.0):
            share = right / (right - next_right)
            t = (ax + share * (bx - ax)) * sin_r + (ay + share * (by - ay)) * cos_r
            if t > 0.0:
                t_in, t_out, crossings = min(t_in, t), max(t_out, t), crossings + 1
        ax, ay, right = bx, by, next_right
    if crossings == 0:
        return near, near
    return (0.0, t_out) if near == 0.0 else (t_in, t_out)


@njit(cache=True)
def target_share(
    grid: Grid,
    targets: Targets,
    index: int,
    x: float,
    y: float,
    z: float,
    heading: float,
    low: float,
    high: float,
    near: float,
    rays: int,
    levels: int,
) -> float:
    """Return the share of a target between two bearings from ``heading`` that is seen from a point, in [0, 1].

    A fan of ``rays`` directions and ``levels`` heights (for a flat area: depths) is cast.
    """
    target, corners = targets.table[index], targets.corners
    total = 0.0
    for k in range(rays):
        direction = heading + low + (high - low) * (k + 0.5) / rays
        sin_r, cos_r = math.sin(direction), math.cos(direction)
        t_in, t_out = _reach(target, corners, x, y, sin_r, cos_r, near)
        for level in range(levels):
            share = (level + 0.6) / (levels + 0.2)
            if target[SHAPE] == AREA:
                length, goal_z = t_in + share * max(t_out - t_in, 0.0), 0.05
            else:
                length, goal_z = t_in, target[HEIGHT] * share
            goal_x, goal_y = x + length * sin_r, y + length * cos_r
            total += pass_share(grid, x, y, z, goal_x, goal_y, goal_z, index, END_M, blocks_only=False)
    return total / (rays * levels)
