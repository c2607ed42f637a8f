"""Where one can stand: from ground codes to clearances and connected stretches, at machine speed."""

import numpy as np
from numba import njit
from numpy.typing import NDArray

Codes = NDArray[np.uint8]
Labels = NDArray[np.int32]
Flags = NDArray[np.bool_]
Floats = NDArray[np.float64]

#: Clearances are capped here, cells.
MAX_CLEARANCE = 255


@njit(cache=True)
def coarsen(codes: Codes, factor: int, passable: Flags, shunned: Flags, blocked: Codes, marked: Codes) -> None:
    """Look at ``factor`` × ``factor`` codes at a time.

    Args:
        codes: Ground codes, shape (r, c).
        factor: Codes along the edge of a cell.
        passable: Whether a code can be stood on, by code.
        shunned: Whether a code is shunned, by code.
        blocked: Set to 1 where less than half of a cell is passable; shape (⌈r / factor⌉, ⌈c / factor⌉).
        marked: Set to 1 where more than half of a cell is shunned; the same shape.
    """
    rows, cols = codes.shape
    for r in range(blocked.shape[0]):
        for c in range(blocked.shape[1]):
            count = good = bad = 0
            for i in range(r * factor, min(rows, (r + 1) * factor)):
                for j in range(c * factor, min(cols, (c + 1) * factor)):
                    count += 1
                    good += passable[codes[i, j]]
                    bad += shunned[codes[i, j]]
            if 2 * good < count:
                blocked[r, c] = 1
            if 2 * bad > count:
                marked[r, c] = 1


@njit(cache=True)
def _has_compliant_near(blocked: Codes, marked: Codes, r: int, c: int, reach: float) -> bool:
    rows, cols = blocked.shape
    span = int(reach + 0.5)
    for i in range(max(0, r - span), min(rows, r + span + 1)):
        for j in range(max(0, c - span), min(cols, c + span + 1)):
            # From this cell's centre to the nearest edge of the other cell.
            dy, dx = max(0.0, abs(i - r) - 0.5), max(0.0, abs(j - c) - 0.5)
            if dx * dx + dy * dy <= reach * reach and blocked[i, j] == 0 and marked[i, j] == 0:
                return True
    return False


@njit(cache=True)
def close_shunned(blocked: Codes, marked: Codes, reach: float) -> Codes:
    """Return ``blocked`` with the marked cells added that are further than ``reach`` cells from compliant ground."""
    closed = blocked.copy()
    for r in range(blocked.shape[0]):
        for c in range(blocked.shape[1]):
            if marked[r, c] == 1 and not _has_compliant_near(blocked, marked, r, c, reach):
                closed[r, c] = 1
    return closed


@njit(cache=True)
def block_rectangles(blocked: Codes, rectangles: Floats, radius: float) -> None:
    """Block the cells whose centre is within a radius of a turned rectangle.

    Args:
        blocked: Grid, set to 1 in place.
        rectangles: Centre x and y, sine and cosine of the heading, half length, half width; shape (n, 6), in cells.
        radius: Cells.
    """
    rows, cols = blocked.shape
    for k in range(rectangles.shape[0]):
        x, y, sin, cos, half_length, half_width = rectangles[k]
        reach = np.hypot(half_length, half_width) + radius
        for r in range(max(0, int(y - reach)), min(rows, int(y + reach) + 1)):
            for c in range(max(0, int(x - reach)), min(cols, int(x + reach) + 1)):
                dx, dy = c + 0.5 - x, r + 0.5 - y
                across = max(0.0, abs(dx * cos - dy * sin) - half_length)
                deep = max(0.0, abs(dx * sin + dy * cos) - half_width)
                if across * across + deep * deep <= radius * radius:
                    blocked[r, c] = 1


@njit(cache=True)
def clearance_of(blocked: Codes) -> Codes:
    """Return the chessboard distance of every cell to the nearest blocked one: 0 there, at most `MAX_CLEARANCE`.

    The outside of the grid does not count as blocked.
    """
    rows, cols = blocked.shape
    depth = np.empty((rows, cols), np.uint8)
    for r in range(rows):
        for c in range(cols):
            if blocked[r, c] != 0:
                depth[r, c] = 0
                continue
            near = MAX_CLEARANCE - 1
            if c > 0:
                near = min(near, depth[r, c - 1])
            if r > 0:
                for j in range(max(0, c - 1), min(cols, c + 2)):
                    near = min(near, depth[r - 1, j])
            depth[r, c] = near + 1
    for r in range(rows - 1, -1, -1):
        for c in range(cols - 1, -1, -1):
            near = int(depth[r, c])
            if c < cols - 1:
                near = min(near, depth[r, c + 1] + 1)
            if r < rows - 1:
                for j in range(max(0, c - 1), min(cols, c + 2)):
                    near = min(near, depth[r + 1, j] + 1)
            depth[r, c] = near
    return depth


@njit(cache=True)
def _root(parents: Labels, label: int) -> int:
    while parents[label] != label:
        parents[label] = parents[parents[label]]
        label = parents[label]
    return label


@njit(cache=True)
def label_stretches(clearance: Codes) -> tuple[Labels, NDArray[np.int64]]:
    """Return for every cell which connected stretch it belongs to, and the size of each stretch.

    Cells are connected across their edges. Labels count from 1 in the order of a stretch's first cell; 0 is blocked,
    and the size of label 0 is the number of blocked cells.
    """
    rows, cols = clearance.shape
    labels = np.zeros((rows, cols), np.int32)
    parents = np.empty(rows * cols // 2 + 2, np.int32)
    parents[0] = 0
    used = 1
    for r in range(rows):
        for c in range(cols):
            if clearance[r, c] == 0:
                continue
            left = labels[r, c - 1] if c > 0 else 0
            below = labels[r - 1, c] if r > 0 else 0
            if left == 0 and below == 0:
                parents[used] = used
                labels[r, c] = used
                used += 1
            elif left == 0 or below in (0, left):
                labels[r, c] = max(left, below)
            else:
                a, b = _root(parents, left), _root(parents, below)
                parents[max(a, b)] = min(a, b)
                labels[r, c] = min(a, b)
    final = np.zeros(used, np.int32)
    count = 1
    for label in range(1, used):
        root = _root(parents, label)
        # A root has the lowest label of its stretch, so it has been numbered already.
        if root == label:
            final[label] = count
            count += 1
        else:
            final[label] = final[root]
    sizes = np.zeros(count, np.int64)
    for r in range(rows):
        for c in range(cols):
            label = final[labels[r, c]]
            labels[r, c] = label
            sizes[label] += 1
    return labels, sizes


@njit(cache=True)
def free_near(clearance: Codes, labels: Labels, x: float, y: float, reach: float) -> tuple[NDArray[np.int64], Floats]:
    """Return the free cells that a point can be moved to: the nearest of each connected stretch, nearest first.

    Args:
        clearance: Of the grid.
        labels: Connected stretches of the grid.
        x: In cells; the point may be outside the grid.
        y: Likewise.
        reach: Only cells whose centre is within this of the point, cells.

    Returns:
        Flat indices of cells and how far the point is moved, cells. A point in a free cell stays where it is.
    """
    rows, cols = clearance.shape
    cells, moved = np.empty(8, np.int64), np.empty(8, np.float64)
    if 0.0 <= x < cols and 0.0 <= y < rows and clearance[int(y), int(x)] != 0:
        cells[0], moved[0] = int(y) * cols + int(x), 0.0
        return cells[:1], moved[:1]
    found = 0
    for r in range(max(0, int(np.floor(y - reach))), min(rows, int(np.floor(y + reach)) + 1)):
        for c in range(max(0, int(np.floor(x - reach))), min(cols, int(np.floor(x + reach)) + 1)):
            if clearance[r, c] == 0:
                continue
            distance = np.hypot(c + 0.5 - x, r + 0.5 - y)
            if distance > reach:
                continue
            place = 0
            while place < found and labels[cells[place] // cols, cells[place] % cols] != labels[r, c]:
                place += 1
            if place == found:
                if found == cells.size:
                    continue
                found += 1
                cells[place], moved[place] = r * cols + c, distance
            elif distance < moved[place] - 1e-9:
                cells[place], moved[place] = r * cols + c, distance
    order = np.argsort(moved[:found], kind="mergesort")
    return cells[:found][order], moved[:found][order]
