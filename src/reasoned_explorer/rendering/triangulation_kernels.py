"""Polygons into triangles, exactly: holes are tied in by bridges, then ears are cut off one by one.

Coordinates are whole numbers (millimetres), less than 2^30 in size, so that every question is answered exactly. That a
simple polygon has two ears, and that a hole's rightmost corner sees a corner to its right, are old truths (Meisters,
1975; Eberly, "Triangulation by ear clipping", 1998).
"""

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.world.compiling import kernel, part

Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


@part
def _turn(points: Ints, a: int, b: int, c: int) -> int:
    """Return twice the area of a triangle: positive if counter-clockwise."""
    return (points[b, 0] - points[a, 0]) * (points[c, 1] - points[a, 1]) - (points[b, 1] - points[a, 1]) * (
        points[c, 0] - points[a, 0]
    )


@part
def _same(points: Ints, a: int, b: int) -> bool:
    return points[a, 0] == points[b, 0] and points[a, 1] == points[b, 1]


@part
def _between(points: Ints, p: int, a: int, b: int) -> bool:
    """Return whether a point that is in line with a segment lies on it, ends included."""
    return min(points[a, 0], points[b, 0]) <= points[p, 0] <= max(points[a, 0], points[b, 0]) and min(
        points[a, 1], points[b, 1]
    ) <= points[p, 1] <= max(points[a, 1], points[b, 1])


@part
def _meet(points: Ints, a: int, b: int, c: int, d: int) -> bool:
    """Return whether two segments share a point that is no end of the first."""
    abc, abd = _turn(points, a, b, c), _turn(points, a, b, d)
    cda, cdb = _turn(points, c, d, a), _turn(points, c, d, b)
    if ((abc > 0 > abd) or (abc < 0 < abd)) and ((cda > 0 > cdb) or (cda < 0 < cdb)):
        return True
    for p, turn in ((c, abc), (d, abd)):
        if turn == 0 and _between(points, p, a, b) and not _same(points, p, a) and not _same(points, p, b):
            return True
    return False


@part
def _lie_along(points: Ints, a: int, b: int, c: int, d: int) -> bool:
    """Return whether the first segment lies on the second."""
    if _turn(points, c, d, a) != 0 or _turn(points, c, d, b) != 0:
        return False
    return _between(points, a, c, d) and _between(points, b, c, d)


@part
def _looks_inside(points: Ints, before: int, at: int, after: int, towards: int, least: int) -> bool:
    """Return whether a direction leads from a corner into the polygon on its left; with ``least`` 0 along its edge."""
    if _turn(points, before, at, after) > 0:
        return _turn(points, at, towards, before) >= least and _turn(points, towards, at, after) >= least
    return not (_turn(points, at, towards, after) >= 0 and _turn(points, towards, at, before) >= 0)


@part
def _bridge(
    points: Ints, corner: Ints, after: Ints, before: Ints, size: int, hole: int, least: int, tried: Bools
) -> int:
    """Return the loop's node that is nearest to a hole's corner and sees it, or -1.

    Where a hole touches the outline, it may only be seen along an edge: with ``least`` 0.

    Args:
        points: Shape (n, 2).
        corner: The point of each node.
        after: The next node on its ring, of all rings.
        before: The one before.
        size: How many nodes there are, on all rings.
        hole: The node of the hole that looks.
        least: 1, or 0 if it may look along an edge.
        tried: Room, shape (n,).
    """
    for node in range(size):
        tried[node] = False
    eye = corner[hole]
    while True:
        nearest, gap = -1, np.int64(0)
        node = 0
        while True:
            p = corner[node]
            if not tried[node] and points[p, 0] >= points[eye, 0]:
                far = (points[p, 0] - points[eye, 0]) ** 2 + (points[p, 1] - points[eye, 1]) ** 2
                if nearest < 0 or far < gap:
                    nearest, gap = node, far
            node = after[node]
            if node == 0:
                break
        if nearest < 0:
            return -1
        tried[nearest] = True
        p = corner[nearest]
        if not _looks_inside(points, corner[before[nearest]], p, corner[after[nearest]], eye, least):
            continue
        blocked = False
        for other in range(size):
            one, two = corner[other], corner[after[other]]
            if _meet(points, p, eye, one, two) or (least > 0 and _lie_along(points, p, eye, one, two)):
                blocked = True
                break
        if not blocked:
            return nearest


@part
def _is_ear(points: Ints, corner: Ints, after: Ints, before: Ints, node: int, strict: bool) -> bool:
    """Return whether no corner of the loop lies in the triangle at a node, or on its border unless ``strict``."""
    a, b, c = corner[before[node]], corner[node], corner[after[node]]
    if _turn(points, a, b, c) <= 0:
        return False
    low_x, high_x = min(points[a, 0], points[b, 0], points[c, 0]), max(points[a, 0], points[b, 0], points[c, 0])
    low_y, high_y = min(points[a, 1], points[b, 1], points[c, 1]), max(points[a, 1], points[b, 1], points[c, 1])
    other = after[after[node]]
    while other != before[node]:
        p = corner[other]
        if low_x <= points[p, 0] <= high_x and low_y <= points[p, 1] <= high_y:
            one, two, three = _turn(points, a, b, p), _turn(points, b, c, p), _turn(points, c, a, p)
            if one > 0 and two > 0 and three > 0:
                return False
            if one >= 0 and two >= 0 and three >= 0 and not strict:
                if _same(points, p, b):
                    # A ring that touches here must not run into the triangle, and out across the cut.
                    for q in (corner[before[other]], corner[after[other]]):
                        if _turn(points, a, b, q) > 0 and _turn(points, b, c, q) > 0:
                            return False
                elif not _same(points, p, a) and not _same(points, p, c):
                    return False
        other = after[other]
    return True


@part
def _without_spikes(points: Ints, corner: Ints, after: Ints, before: Ints, node: int, left: int) -> tuple[int, int]:
    """Take a node out where the loop turns back on itself or stands still, and those before it where that makes more.

    Returns:
        A node that stays, and how many nodes are left.
    """
    while left > 2:
        a, b, c = corner[before[node]], corner[node], corner[after[node]]
        back = (points[a, 0] - points[b, 0]) * (points[c, 0] - points[b, 0]) + (points[a, 1] - points[b, 1]) * (
            points[c, 1] - points[b, 1]
        )
        if back < 0 or _turn(points, a, b, c) != 0:
            break
        after[before[node]], before[after[node]] = after[node], before[node]
        node = before[node]
        left -= 1
    return node, left


@part
def _cut_ears(points: Ints, corner: Ints, after: Ints, before: Ints, left: int, triangles: Ints, made: int) -> int:
    """Cut the loop of ``left`` nodes into triangles behind those that are ``made``; return how many there are then.

    Where no ear is found, which a proper polygon does not let happen, ever worse ones are taken: it always ends.
    """
    node, idle, patience = before[0], 0, 0
    for _ in range(left):
        node, left = _without_spikes(points, corner, after, before, node, left)
        node = after[node]
    while left > 2:
        a, b, c = corner[before[node]], corner[node], corner[after[node]]
        if patience < 2:
            cuts = _is_ear(points, corner, after, before, node, patience == 1)
        else:
            cuts = patience == 3 or _turn(points, a, b, c) >= 0
        if not cuts:
            node = after[node]
            idle += 1
            if idle > left:
                idle, patience = 0, patience + 1
            continue
        if _turn(points, a, b, c) > 0:
            triangles[made, 0], triangles[made, 1], triangles[made, 2] = a, b, c
            made += 1
        after[before[node]], before[after[node]] = after[node], before[node]
        left -= 1
        node, left = _without_spikes(points, corner, after, before, before[node], left)
        # On to the node after the next: fewer needles than cutting fans.
        node, left = _without_spikes(points, corner, after, before, after[node], left)
        node = after[node]
        idle = patience = 0
    return made


@part
def _link_rings(ring_starts: Ints, first: int, beyond: int, corner: Ints, after: Ints, before: Ints) -> int:
    """Make a node for every corner of rings and return how many there are."""
    size = 0
    for ring in range(first, beyond):
        begin = size
        for point in range(ring_starts[ring], ring_starts[ring + 1]):
            corner[size] = point
            after[size], before[size] = size + 1, size - 1
            size += 1
        if size > begin:
            after[size - 1], before[begin] = begin, size - 1
    return size


@part
def _next_eye(points: Ints, ring_starts: Ints, first: int, beyond: int, corner: Ints, merged: Bools) -> tuple[int, int]:
    """Return the rightmost node of all holes that are not merged yet, and its ring."""
    eye, found = -1, -1
    for ring in range(first + 1, beyond):
        if not merged[ring - first]:
            for node in range(ring_starts[ring] - ring_starts[first], ring_starts[ring + 1] - ring_starts[first]):
                if eye < 0 or points[corner[node], 0] > points[corner[eye], 0]:
                    eye, found = node, ring
    return eye, found


@kernel
def triangulate(
    points: Ints,
    ring_starts: Ints,
    polygon_starts: Ints,
    corner: Ints,
    after: Ints,
    before: Ints,
    merged: Bools,
    tried: Bools,
    triangles: Ints,
) -> int:
    """Cut polygons into triangles and return how many there are.

    Args:
        points: Corners of all rings, shape (n, 2), whole numbers; outlines counter-clockwise, holes clockwise.
        ring_starts: Where each ring begins in ``points``, and where the last ends.
        polygon_starts: Where each polygon's rings begin, its outline first, and where the last ends.
        corner: Room for two more than the corners and twice the rings of the largest polygon.
        after: Likewise.
        before: Likewise.
        merged: Likewise.
        tried: Likewise.
        triangles: Set: places in ``points``, counter-clockwise, shape (m, 3).
    """
    made = ring_starts[0]  # 0, but no constant: numba compiles a function once more for each
    for polygon in range(len(polygon_starts) - 1):
        first, beyond = polygon_starts[polygon], polygon_starts[polygon + 1]
        if first == beyond:
            continue
        size = _link_rings(ring_starts, first, beyond, corner, after, before)
        left = ring_starts[first + 1] - ring_starts[first]
        for ring in range(beyond - first):
            merged[ring] = False
        for _ in range(first + 1, beyond):
            eye, ring = _next_eye(points, ring_starts, first, beyond, corner, merged)
            merged[ring - first] = True
            seen = -1
            # A loop, since numba compiles a function once more for every constant that it is given.
            for least in (1, 0):
                if seen < 0:
                    seen = _bridge(points, corner, after, before, size, eye, least, tried)
            if seen < 0:
                continue
            # Out along the bridge, around the hole, and back on doubles of both ends.
            corner[size], corner[size + 1] = corner[eye], corner[seen]
            after[before[eye]], before[size] = size, before[eye]
            after[size], before[size + 1] = size + 1, size
            after[size + 1], before[after[seen]] = after[seen], size + 1
            after[seen], before[eye] = eye, seen
            size += 2
            left += ring_starts[ring + 1] - ring_starts[ring] + 2
        made = _cut_ears(points, corner, after, before, left, triangles, made)
    return made


@part
def _tidy(points: Ints, begin: int, end: int, slack: int, kept: Ints) -> int:
    """Write the corners that shape a ring into ``kept`` and return how many there are.

    A corner goes that is within ``slack`` of the one before, or of the line between its neighbours, until none does.
    """
    count = 0
    for point in range(begin, end):
        kept[count] = point
        count += 1
    at, calm = 0, 0
    while count > 2 and calm < count:
        a, b, c = kept[(at - 1) % count], kept[at % count], kept[(at + 1) % count]
        span = (points[c, 0] - points[a, 0]) ** 2 + (points[c, 1] - points[a, 1]) ** 2
        step = (points[b, 0] - points[a, 0]) ** 2 + (points[b, 1] - points[a, 1]) ** 2
        turn = float(_turn(points, a, b, c))
        if step <= slack * slack or turn * turn <= float(slack * slack) * span:
            for later in range(at % count, count - 1):
                kept[later] = kept[later + 1]
            count -= 1
            at, calm = max(at - 1, 0), 0
        else:
            at, calm = (at + 1) % count, calm + 1
    return count


@kernel
def tidy(
    points: Ints, ring_starts: Ints, is_hole: Bools, slack: int, least_area: int, found: Ints, starts: Ints
) -> None:
    """Take corners out of rings that shape nothing; turn outlines counter-clockwise and holes clockwise.

    Args:
        points: Shape (n, 2), whole numbers.
        ring_starts: Where each ring begins in ``points``, and where the last ends.
        is_hole: Of each ring.
        slack: How far a corner may be off the line and still go.
        least_area: Rings of less than this lose all their corners.
        found: Set: places in ``points`` of the corners that stay, shape (n,).
        starts: Set: where each ring begins in them, and the last ends.
    """
    size = 0
    starts[0] = 0
    for ring in range(len(ring_starts) - 1):
        kept = found[size:]
        count = _tidy(points, ring_starts[ring], ring_starts[ring + 1], slack, kept)
        twice = np.int64(0)
        for at in range(1, count - 1):
            twice += _turn(points, kept[0], kept[at], kept[at + 1])
        if count < 3 or abs(twice) < 2 * least_area:
            count = 0
        elif (twice > 0) == is_hole[ring]:
            for at in range(count // 2):
                kept[at], kept[count - 1 - at] = kept[count - 1 - at], kept[at]
        size += count
        starts[ring + 1] = size
