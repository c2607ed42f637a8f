"""Any-angle shortest ways on a grid of free cells, at machine speed.

The search is Lazy Theta* (Nash, Koenig, Tovey: "Lazy Theta*: any-angle path planning and path length analysis in 3D",
AAAI 2010): every cell remembers the last corner that its way turns at, a line of sight to that corner is assumed while
the cell waits and is checked when its turn comes. Two things are ours: a cell whose line of sight fails asks for the
corners of its finished neighbours, too, before it turns at a neighbour itself, and the queue is one of buckets.

Coordinates are in cells: x grows with the column, y with the row, the centre of cell (row, col) is at
(col + 0.5, row + 0.5). Clearance is 0 in blocked cells, else the chessboard distance to the nearest blocked one.
"""

import math

import numpy as np
from numba import njit
from numpy.typing import NDArray

Codes = NDArray[np.uint8]
Floats = NDArray[np.float64]
Lengths = NDArray[np.float32]
Links = NDArray[np.int32]
Cells = NDArray[np.int64]

_TINY = 1e-6
# Ways that are shorter by less are not told apart: lengths are kept in single precision.
_GAIN = 1e-3
_BUCKETS = 2048
_BUCKET_WIDTH = 0.25
# States of a cell; a goal cell has _GOAL added.
_WAITING, _CHECKED, _DONE, _GOAL = 1, 2, 3, 4
_DY = np.asarray([-1, -1, -1, 0, 0, 1, 1, 1])
_DX = np.asarray([-1, 0, 1, -1, 1, -1, 0, 1])


@njit(cache=True)
def _visible_along(clearance: Codes, a0: float, b0: float, a1: float, b1: float) -> bool:
    """Answer `visible` for lines that run more along columns (a) than along rows (b)."""
    if a0 > a1:
        a0, b0, a1, b1 = a1, b1, a0, b0
    slope = (b1 - b0) / (a1 - a0) if a1 > a0 else 0.0
    col, last = int(a0), int(a1)
    while col <= last:
        left, right = max(a0, float(col)), min(a1, col + 1.0)
        b_left, b_right = b0 + slope * (left - a0), b0 + slope * (right - a0)
        low = int(min(b_left, b_right) + _TINY)
        high = max(low, int(max(b_left, b_right) - _TINY))
        depth = int(clearance[low, col])
        if depth == 0 or (high != low and clearance[high, col] == 0):
            return False
        if depth == 1 and col < last and slope != 0.0:
            # A line through a corner must not slip between two blocked cells.
            row = high if slope > 0.0 else low
            beyond = int(b_right + _TINY) if slope > 0.0 else int(b_right - _TINY)
            if beyond != row and clearance[beyond, col] == 0 and clearance[row, col + 1] == 0:
                return False
        # All cells nearer than the clearance are free: the next columns need no look.
        col += max(1, depth - 1)
    return True


@njit(cache=True)
def visible(clearance: Codes, x0: float, y0: float, x1: float, y1: float) -> bool:
    """Return whether the straight line between two points of the grid touches free cells only.

    Both points must lie inside the grid, not on its border.
    """
    if abs(x1 - x0) >= abs(y1 - y0):
        return _visible_along(clearance, x0, y0, x1, y1)
    return _visible_along(clearance.T, y0, x0, y1, x1)


@njit(cache=True)
def _corner_of(link: int, cols: int, sources: Floats) -> tuple[float, float]:
    """Return where a link leads: a cell's centre (link > 0) or a source (link < 0)."""
    if link > 0:
        return (link - 1) % cols + 0.5, (link - 1) // cols + 0.5
    return sources[-link - 1, 0], sources[-link - 1, 1]


@njit(cache=True)
def _length_at(link: int, lengths: Lengths, sources: Floats) -> float:
    return float(lengths[link - 1]) if link > 0 else sources[-link - 1, 2]


@njit(cache=True)
def _rest(box: Floats, x: float, y: float) -> float:
    """Return a lower bound of what is left to go: the distance to the box around all goals."""
    dx = max(0.0, box[0] - x, x - box[2])
    dy = max(0.0, box[1] - y, y - box[3])
    return math.sqrt(dx * dx + dy * dy)


@njit(cache=True)
def _push(heads: Links, nexts: Links, items: Links, marks: Cells, cell: int, key: float) -> None:
    """Put a cell in its bucket. ``marks``: current bucket, first spare node, cells waiting, most ever touched."""
    bucket = max(marks[0], int(key / _BUCKET_WIDTH)) % _BUCKETS
    node = marks[1]
    marks[1] = nexts[node]
    items[node] = cell
    nexts[node] = heads[bucket]
    heads[bucket] = node
    marks[2] += 1


@njit(cache=True)
def _pop(heads: Links, nexts: Links, items: Links, marks: Cells) -> int:
    while heads[marks[0] % _BUCKETS] < 0:
        marks[0] += 1
    bucket = marks[0] % _BUCKETS
    node = heads[bucket]
    heads[bucket] = nexts[node]
    nexts[node] = marks[1]
    marks[1] = node
    marks[2] -= 1
    return int(items[node])


@njit(cache=True)
def _spare_nodes(nexts: Links, items: Links, marks: Cells) -> tuple[Links, Links]:
    """Return a queue's nodes, twice as many if fewer than the neighbours of a cell may be left."""
    if marks[2] + 16 < nexts.size:
        return nexts, items
    size = nexts.size
    more_nexts, more_items = np.empty(2 * size, np.int32), np.empty(2 * size, np.int32)
    more_nexts[:size], more_items[:size] = nexts, items
    for k in range(size, 2 * size):
        more_nexts[k] = k + 1
    more_nexts[2 * size - 1] = marks[1]
    marks[1] = size
    return more_nexts, more_items


@njit(cache=True)
def _open_way(clearance: Codes, row: int, col: int, k: int) -> bool:
    """Return whether one can step from a cell to its neighbour ``k``; never between two blocked cells."""
    r, c = row + _DY[k], col + _DX[k]
    if r < 0 or c < 0 or r >= clearance.shape[0] or c >= clearance.shape[1] or clearance[r, c] == 0:
        return False
    return clearance[r, col] != 0 or clearance[row, c] != 0


@njit(cache=True)
def _best_link(
    clearance: Codes, lengths: Lengths, links: Links, states: Codes, sources: Floats, cell: int
) -> tuple[int, float]:
    """Return the corner that a cell sees and through which its way is shortest, asking its finished neighbours."""
    cols = clearance.shape[1]
    row, col = cell // cols, cell % cols
    x, y = col + 0.5, row + 0.5
    best, best_link = math.inf, 0
    for k in range(8):
        if not _open_way(clearance, row, col, k):
            continue
        other = (row + _DY[k]) * cols + col + _DX[k]
        if states[other] & 3 != _DONE:
            continue
        length = lengths[other] + math.sqrt(float(_DY[k] * _DY[k] + _DX[k] * _DX[k]))
        if length < best:
            best, best_link = length, other + 1
        link = links[other]
        if link != best_link and link != links[cell]:
            cx, cy = _corner_of(link, cols, sources)
            length = _length_at(link, lengths, sources) + math.hypot(cx - x, cy - y)
            if length < best and visible(clearance, cx, cy, x, y):
                best, best_link = length, link
    return best_link, best


@njit(cache=True)
def _follows(links: Links, states: Codes, cols: int, cell: int, dx: float, dy: float) -> bool:
    """Return whether the neighbours towards a cell's corner see that corner, and so the cell does, too.

    The line to the corner runs between two neighbours whose own lines lie at most one cell apart, so that a blocked
    cell in between would block one of them.

    Args:
        links: Last corners.
        states: Of the cells.
        cols: Columns of the grid.
        cell: The cell, with the corner at (dx, dy) from its centre.
        dx: Cells.
        dy: Cells.
    """
    step_x, step_y = (1 if dx > 0.0 else -1), (cols if dy > 0.0 else -cols)
    near = cell + (step_x if abs(dx) >= abs(dy) else step_y)
    if states[near] & 3 != _DONE or links[near] != links[cell]:
        return False
    if min(abs(dx), abs(dy)) < 0.5:
        return True
    far = cell + step_x + step_y
    return states[far] & 3 == _DONE and links[far] == links[cell]


@njit(cache=True)
def search(
    clearance: Codes,
    lengths: Lengths,
    links: Links,
    states: Codes,
    starts: Cells,
    sources: Floats,
    box: Floats,
    limit: float,
) -> tuple[int, Links]:
    """Spread from sources until a goal cell is reached, or everywhere.

    Args:
        clearance: Shape (rows, cols).
        lengths: Shortest lengths found, flat, cells; read only where ``links`` is set.
        links: Last corners, flat: 0 unset, k + 1 for the centre of cell k, −(s + 1) for source s. All 0 at first.
        states: Flat; all 0 at first but for goal cells, which are 4.
        starts: The cell of each source.
        sources: x, y and length at the start of each source, shape (n, 3), cells.
        box: x and y of the box around all goals (low, low, high, high), or empty where there is no goal.
        limit: Nothing longer than this is followed, cells.

    Returns:
        The goal cell that was reached, or −1; and all cells that were touched.
    """
    rows, cols = clearance.shape
    heads = np.full(_BUCKETS, -1, np.int32)
    nexts, items = np.arange(1, 4097).astype(np.int32), np.empty(4096, np.int32)
    marks = np.zeros(4, np.int64)
    touched = np.empty(4096, np.int32)
    guided = box.size > 0
    lowest = math.inf
    for s in range(starts.size):
        rest = _rest(box, sources[s, 0], sources[s, 1]) if guided else 0.0
        lowest = min(lowest, sources[s, 2] + rest)
    marks[0] = int(lowest / _BUCKET_WIDTH) if starts.size > 0 else 0
    for s in range(starts.size):
        cell = starts[s]
        x, y = cell % cols + 0.5, cell // cols + 0.5
        length = sources[s, 2] + math.hypot(x - sources[s, 0], y - sources[s, 1])
        if links[cell] != 0 and length >= lengths[cell]:
            continue
        if links[cell] == 0:
            if marks[3] == touched.size:
                touched = np.append(touched, np.empty(touched.size, np.int32))
            touched[marks[3]] = cell
            marks[3] += 1
        lengths[cell], links[cell] = length, -(s + 1)
        states[cell] = (states[cell] & _GOAL) | _CHECKED
        nexts, items = _spare_nodes(nexts, items, marks)
        _push(heads, nexts, items, marks, cell, length + (_rest(box, x, y) if guided else 0.0))
    while marks[2] > 0:
        cell = _pop(heads, nexts, items, marks)
        if states[cell] & 3 == _DONE:
            continue
        nexts, items = _spare_nodes(nexts, items, marks)
        row, col = cell // cols, cell % cols
        x, y = col + 0.5, row + 0.5
        cx, cy = _corner_of(links[cell], cols, sources)
        if (
            states[cell] & 3 == _WAITING
            and not _follows(links, states, cols, cell, cx - x, cy - y)
            and not visible(clearance, cx, cy, x, y)
        ):
            links[cell], lengths[cell] = _best_link(clearance, lengths, links, states, sources, cell)
            states[cell] = (states[cell] & _GOAL) | _CHECKED
            _push(heads, nexts, items, marks, cell, lengths[cell] + (_rest(box, x, y) if guided else 0.0))
            continue
        if states[cell] & _GOAL:
            states[cell] |= _DONE
            return cell, touched[: marks[3]]
        states[cell] = (states[cell] & _GOAL) | _DONE
        link, so_far = links[cell], _length_at(links[cell], lengths, sources)
        if touched.size < marks[3] + 8:
            touched = np.append(touched, np.empty(touched.size, np.int32))
        # Where nothing is near, the neighbours need no look.
        roomy = clearance[row, col] > 1 and 0 < row < rows - 1 and 0 < col < cols - 1
        for k in range(8):
            if not roomy and not _open_way(clearance, row, col, k):
                continue
            other = cell + _DY[k] * cols + _DX[k]
            state = states[other]
            if state & 3 == _DONE:
                continue
            other_x, other_y = x + _DX[k], y + _DY[k]
            dx, dy = other_x - cx, other_y - cy
            length = so_far + math.sqrt(dx * dx + dy * dy)
            if length > limit or (state & 3 != 0 and length > lengths[other] - _GAIN):
                continue
            if state & 3 == 0:
                touched[marks[3]] = other
                marks[3] += 1
            lengths[other], links[other] = length, link
            states[other] = (state & _GOAL) | _WAITING
            key = length + (_rest(box, other_x, other_y) if guided else 0.0)
            _push(heads, nexts, items, marks, other, key)
    return -1, touched[: marks[3]]


@njit(cache=True)
def trace(links: Links, cols: int, sources: Floats, cell: int) -> Floats:
    """Return the corners of a cell's way, from the cell's centre back to its source, shape (n, 2)."""
    count, link = 2, links[cell]
    while link > 0:
        count += 1
        link = links[link - 1]
    points = np.empty((count, 2), np.float64)
    points[0, 0], points[0, 1] = cell % cols + 0.5, cell // cols + 0.5
    link = links[cell]
    for k in range(1, count):
        points[k, 0], points[k, 1] = _corner_of(link, cols, sources)
        if link > 0:
            link = links[link - 1]
    return points


@njit(cache=True)
def _pull(clearance: Codes, points: Floats) -> Floats:
    """Leave out every corner that the one before it can see past."""
    kept = np.empty(points.shape[0], np.int64)
    kept[0] = 0
    count, at = 1, 0
    while at < points.shape[0] - 1:
        ahead = min(at + 8, points.shape[0] - 1)
        while ahead > at + 1 and not visible(
            clearance, points[at, 0], points[at, 1], points[ahead, 0], points[ahead, 1]
        ):
            ahead -= 1
        at = ahead
        kept[count] = at
        count += 1
    return points[kept[:count]]


@njit(cache=True)
def _shift(clearance: Codes, before: Floats, corner: Floats, after: Floats) -> bool:
    """Move a corner to where the way around it is shorter, among places in its cell and the eight around it."""
    rows, cols = clearance.shape
    row, col = int(corner[1]), int(corner[0])
    best = np.hypot(corner[0] - before[0], corner[1] - before[1]) + np.hypot(after[0] - corner[0], after[1] - corner[1])
    moved = False
    for r in range(max(0, row - 1), min(rows, row + 2)):
        for c in range(max(0, col - 1), min(cols, col + 2)):
            if clearance[r, c] == 0:
                continue
            for place in range(9):
                x, y = c + 0.5 + 0.49 * (place % 3 - 1), r + 0.5 + 0.49 * (place // 3 - 1)
                length = np.hypot(x - before[0], y - before[1]) + np.hypot(after[0] - x, after[1] - y)
                if (
                    length < best - 1e-9
                    and visible(clearance, before[0], before[1], x, y)
                    and visible(clearance, x, y, after[0], after[1])
                ):
                    best = length
                    corner[0], corner[1] = x, y
                    moved = True
    return moved


@njit(cache=True)
def _merge(clearance: Codes, points: Floats) -> Floats:
    """Make one of two corners that stand at the same corner of a blocked cell, where both neighbours see it."""
    kept = np.ones(points.shape[0], np.bool_)
    for k in range(1, points.shape[0] - 2):
        a, b = points[k], points[k + 1]
        if not kept[k] or abs(a[0] - b[0]) > 0.1 or abs(a[1] - b[1]) > 0.1:
            continue
        before, after = points[k - 1], points[k + 2]
        for x, y in ((a[0], b[1]), (b[0], a[1])):
            if visible(clearance, before[0], before[1], x, y) and visible(clearance, x, y, after[0], after[1]):
                points[k, 0], points[k, 1] = x, y
                points[k + 1, 0], points[k + 1, 1] = x, y
                kept[k + 1] = False
                break
    return points[kept]


@njit(cache=True)
def tighten(clearance: Codes, points: Floats) -> Floats:
    """Return a way pulled taut: needless corners left out, the others moved to where the way is shortest.

    Args:
        clearance: Of the grid.
        points: Shape (n, 2), cells, each in sight of the next. The ends stay where they are.
    """
    points = _pull(clearance, points.copy())
    for _ in range(8):
        moved = False
        for k in range(1, points.shape[0] - 1):
            moved |= _shift(clearance, points[k - 1], points[k], points[k + 1])
        if not moved:
            break
        points = _pull(clearance, points)
    return _merge(clearance, points)


@njit(cache=True)
def lengths_at(
    clearance: Codes, lengths: Lengths, links: Links, sources: Floats, xs: Floats, ys: Floats, reach: float
) -> tuple[Floats, Floats]:
    """Return how long the way from each point is and the next corner on it.

    Args:
        clearance: Of the grid.
        lengths: Of a finished search.
        links: Of a finished search.
        sources: Of a finished search.
        xs: In cells; points in blocked cells are moved to the nearest cell with a way.
        ys: Likewise.
        reach: How far a point may be moved, cells.

    Returns:
        Lengths in cells (infinite where there is no way), shape (n,), and next corners, shape (n, 2).
    """
    rows, cols = clearance.shape
    found = np.full(xs.size, np.inf)
    corners = np.empty((xs.size, 2), np.float64)
    for i in range(xs.size):
        x, y = xs[i], ys[i]
        corners[i, 0], corners[i, 1] = x, y
        if 0.0 < x < cols and 0.0 < y < rows and clearance[int(y), int(x)] != 0:
            cell = int(y) * cols + int(x)
            if links[cell] == 0:
                continue
            cx, cy = _corner_of(links[cell], cols, sources)
            if visible(clearance, x, y, cx, cy):
                found[i] = _length_at(links[cell], lengths, sources) + math.hypot(cx - x, cy - y)
            else:
                cx, cy = cell % cols + 0.5, cell // cols + 0.5
                found[i] = lengths[cell] + math.hypot(cx - x, cy - y)
            corners[i, 0], corners[i, 1] = cx, cy
            continue
        nearest = reach
        for r in range(max(0, math.floor(y - reach)), min(rows, math.floor(y + reach) + 1)):
            for c in range(max(0, math.floor(x - reach)), min(cols, math.floor(x + reach) + 1)):
                distance = math.hypot(c + 0.5 - x, r + 0.5 - y)
                if links[r * cols + c] != 0 and distance < nearest:
                    nearest = distance
                    found[i] = lengths[r * cols + c] + distance
                    corners[i, 0], corners[i, 1] = c + 0.5, r + 0.5
    return found, corners
