"""Shapes on paper: smooth lines, blobs, footprints, points along a line. Plain geometry, metres, no world."""

import math
from collections.abc import Sequence

import numpy as np
import shapely
from numpy.random import Generator
from numpy.typing import NDArray
from shapely import Polygon

Points = NDArray[np.float64]


def smooth(points: Points, *, closed: bool = False, per_segment: int = 6) -> Points:
    """Return a uniform Catmull-Rom curve through points.

    Args:
        points: Shape (n, 2); n ≥ 2, or n ≥ 3 if closed.
        closed: Whether the last point joins the first (the closing point is not repeated).
        per_segment: Points per stretch between two given ones.

    Returns:
        Shape (m, 2); an open curve keeps both of its ends.
    """
    given = np.asarray(points, float)
    if closed:
        before, start, end, after = np.roll(given, 1, 0), given, np.roll(given, -1, 0), np.roll(given, -2, 0)
    else:
        if len(given) == 2:
            return given
        padded = np.vstack([2 * given[0] - given[1], given, 2 * given[-1] - given[-2]])
        before, start, end, after = padded[:-3], padded[1:-2], padded[2:-1], padded[3:]
    t = (np.arange(per_segment) / per_segment)[None, :, None]
    before, start, end, after = before[:, None], start[:, None], end[:, None], after[:, None]
    curve = 0.5 * (
        2 * start
        + (end - before) * t
        + (2 * before - 5 * start + 4 * end - after) * t**2
        + (3 * start - before - 3 * end + after) * t**3
    )
    flat: Points = curve.reshape(-1, 2)
    return flat if closed else np.vstack([flat, given[-1]])


def blob(
    rng: Generator, x_m: float, y_m: float, radius_m: float, *, roughness: float = 0.22, knots: int = 9
) -> Polygon:
    """Return a smooth closed shape about a point, longer than wide, of about the given mean radius."""
    turn = rng.uniform(0, 2 * math.pi)
    angles = np.arange(knots) * (2 * math.pi / knots)
    radii = radius_m * (1 + roughness * rng.uniform(-1, 1, knots))
    stretch = rng.uniform(1.0, 1.35)
    ring = np.column_stack([radii * np.cos(angles) * stretch, radii * np.sin(angles) / stretch])
    polygon: Polygon = shapely.make_valid(Polygon(smooth(turned(ring, turn) + np.array([x_m, y_m]), closed=True)))
    return polygon


def turned(points: Points, angle_rad: float) -> Points:
    """Return points turned anticlockwise about the origin."""
    cosine, sine = math.cos(angle_rad), math.sin(angle_rad)
    result: Points = np.asarray(points, float) @ np.array([[cosine, sine], [-sine, cosine]])
    return result


def footprint(kind: str, width_m: float, depth_m: float, wing_m: float) -> Points:
    """Return a footprint about the origin with its front on the side of negative y.

    Args:
        kind: ``rect``, ``l``, ``u``, ``t`` or ``h``.
        width_m: Along the front.
        depth_m: Away from the front.
        wing_m: Thickness of the wings; at most half of either extent is used.

    Returns:
        Ring, shape (n, 2), anticlockwise.
    """
    w, d = width_m / 2, depth_m / 2
    k = min(wing_m, 0.45 * width_m, 0.45 * depth_m)
    rings = {
        "rect": [(-w, -d), (w, -d), (w, d), (-w, d)],
        "l": [(-w, -d), (w, -d), (w, -d + k), (-w + k, -d + k), (-w + k, d), (-w, d)],
        "u": [(-w, -d), (w, -d), (w, d), (w - k, d), (w - k, -d + k), (-w + k, -d + k), (-w + k, d), (-w, d)],
        "t": [(-w, -d), (w, -d), (w, -d + k), (k / 2, -d + k), (k / 2, d), (-k / 2, d), (-k / 2, -d + k), (-w, -d + k)],
        "h": [(-w, -d), (-w + k, -d), (-w + k, -k / 2), (w - k, -k / 2), (w - k, -d), (w, -d), (w, d), (w - k, d),
              (w - k, k / 2), (-w + k, k / 2), (-w + k, d), (-w, d)],
    }  # fmt: skip
    return np.array(rings[kind], float)


def placed(ring: Points, x_m: float, y_m: float, heading_rad: float) -> Polygon:
    """Return a footprint moved to a point, its front facing a compass heading (clockwise from north)."""
    # The front looks along -y, which is a heading of pi; compass headings turn clockwise, `turned` anticlockwise.
    return Polygon(turned(ring, math.pi - heading_rad) + np.array([x_m, y_m]))


def along(line: Points, spacing_m: float, *, start_m: float = 0.0, end_m: float = 0.0) -> tuple[Points, Points]:
    """Return evenly spaced points on a line with the directions there.

    Args:
        line: Shape (n, 2).
        spacing_m: Between neighbours, positive.
        start_m: Left free at the beginning.
        end_m: Left free at the end.

    Returns:
        Points, shape (k, 2), and unit tangents, shape (k, 2); k may be 0.
    """
    steps = np.diff(line, axis=0)
    lengths = np.hypot(steps[:, 0], steps[:, 1])
    real = lengths > 1e-9
    steps, lengths, starts = steps[real], lengths[real], line[:-1][real]
    total = float(lengths.sum())
    wanted = np.arange(start_m + spacing_m / 2, total - end_m, spacing_m)
    if not len(wanted):
        return np.empty((0, 2)), np.empty((0, 2))
    ends = np.cumsum(lengths)
    segment = np.minimum(np.searchsorted(ends, wanted), len(lengths) - 1)
    tangents = steps[segment] / lengths[segment, None]
    return starts[segment] + tangents * (wanted - (ends - lengths)[segment])[:, None], tangents


def along_many(
    lines: Sequence[Points],
    spacing_m: NDArray[np.float64] | float,
    *,
    start_m: NDArray[np.float64] | float = 0.0,
    end_m: NDArray[np.float64] | float = 0.0,
) -> tuple[Points, Points, NDArray[np.intp]]:
    """Return evenly spaced points on many lines at once, as `along` does on one.

    Args:
        lines: Each of shape (n, 2).
        spacing_m: Between neighbours, positive; for all lines or for each.
        start_m: Left free at the beginning, likewise.
        end_m: Left free at the end, likewise.

    Returns:
        Points, shape (k, 2), unit tangents, shape (k, 2), and which line each lies on, shape (k,).
    """
    if not len(lines):
        return np.empty((0, 2)), np.empty((0, 2)), np.empty(0, np.intp)
    number = len(lines)
    spacing, start, end = (np.broadcast_to(np.asarray(x, float), number) for x in (spacing_m, start_m, end_m))
    corners = np.vstack(lines)
    owner = np.repeat(np.arange(number), [len(line) for line in lines])
    steps = np.diff(corners, axis=0)
    lengths = np.hypot(steps[:, 0], steps[:, 1])
    real = (owner[1:] == owner[:-1]) & (lengths > 1e-9)
    steps, lengths, starts, owner = steps[real], lengths[real], corners[:-1][real], owner[:-1][real]
    ends = np.cumsum(lengths)
    totals = np.bincount(owner, weights=lengths, minlength=number)
    count = np.maximum(np.ceil((totals - end - start - spacing / 2) / spacing), 0).astype(int)
    line = np.repeat(np.arange(number), count)
    if not len(line):
        return np.empty((0, 2)), np.empty((0, 2)), np.empty(0, np.intp)
    first, beyond = np.searchsorted(owner, line), np.searchsorted(owner, line, side="right")
    place = np.arange(len(line)) - np.repeat(np.cumsum(count) - count, count)
    wanted = start[line] + spacing[line] * (place + 0.5) + (ends - lengths)[first]
    segment = np.clip(np.searchsorted(ends, wanted), first, beyond - 1)
    tangents = steps[segment] / lengths[segment, None]
    return starts[segment] + tangents * (wanted - (ends - lengths)[segment])[:, None], tangents, line


def heading_of(directions: Points) -> NDArray[np.float64]:
    """Return compass headings, radians clockwise from north, of direction vectors, shape (n, 2)."""
    headings: NDArray[np.float64] = np.arctan2(directions[:, 0], directions[:, 1]) % (2 * math.pi)
    return headings


def left_of(tangents: Points) -> Points:
    """Return the unit normals to the left of unit tangents."""
    return np.column_stack([-tangents[:, 1], tangents[:, 0]])


def bow(start: Sequence[float], end: Sequence[float], sag: float, *, count: int = 8) -> Points:
    """Return a quadratic Bézier curve between two points whose middle bulges to the left by a share of its length."""
    a, b = np.asarray(start, float), np.asarray(end, float)
    middle = (a + b) / 2 + 2 * sag * np.array([a[1] - b[1], b[0] - a[0]])
    t = np.linspace(0, 1, count)[:, None]
    curve: Points = (1 - t) ** 2 * a + 2 * t * (1 - t) * middle + t**2 * b
    return curve


def bows(starts: Points, ends: Points, sags: NDArray[np.float64], *, count: int = 8) -> Points:
    """Return many curves as `bow` does one: from points of shape (n, 2) curves of shape (n, count, 2)."""
    a, b = starts[:, None], ends[:, None]
    aside = np.stack([starts[:, 1] - ends[:, 1], ends[:, 0] - starts[:, 0]], axis=-1)[:, None]
    middle = (a + b) / 2 + 2 * sags[:, None, None] * aside
    t = np.linspace(0, 1, count)[None, :, None]
    curves: Points = (1 - t) ** 2 * a + 2 * t * (1 - t) * middle + t**2 * b
    return curves


def spread(rng: Generator, area: Polygon, spacing_m: float, *, jitter: float = 0.4) -> Points:
    """Return points that fill a polygon: a turned grid with each point jittered by a share of the spacing."""
    if area.is_empty:
        return np.empty((0, 2))
    min_x, min_y, max_x, max_y = area.bounds
    centre = np.array([(min_x + max_x) / 2, (min_y + max_y) / 2])
    reach = math.hypot(max_x - min_x, max_y - min_y) / 2
    ticks = np.arange(-reach, reach + spacing_m, spacing_m)
    grid = np.stack(np.meshgrid(ticks, ticks), axis=-1).reshape(-1, 2)
    grid = grid + rng.uniform(-jitter, jitter, grid.shape) * spacing_m
    points = turned(grid, rng.uniform(0, math.pi)) + centre
    shapely.prepare(area)
    inside: Points = points[shapely.contains_xy(area, points)]
    return inside


def thin(points: Points, spacing_m: float) -> NDArray[np.intp]:
    """Return the indices of points kept so that no two of them are nearer than a spacing; earlier ones win."""
    if len(points) < 2:
        return np.arange(len(points))
    tree = shapely.STRtree(shapely.points(points))
    first, second = tree.query(shapely.points(points), predicate="dwithin", distance=spacing_m)
    later = second > first
    order = np.argsort(first[later], kind="stable")
    dropped = np.zeros(len(points), bool)
    for one, other in zip(first[later][order].tolist(), second[later][order].tolist(), strict=True):
        if not dropped[one]:
            dropped[other] = True
    return np.flatnonzero(~dropped)


def inner_circle(area: Polygon, *, tolerance_m: float = 1.0) -> tuple[float, float, float]:
    """Return centre and radius of about the largest circle that fits into a polygon: x, y, radius, metres.

    Squares that may hold a better centre are cut in four until none may be better by more than the tolerance. GEOS'
    own search for such a circle finds another one in each of its versions.
    """
    min_x, min_y, max_x, max_y = area.bounds
    half = max(min(max_x - min_x, max_y - min_y) / 2, tolerance_m)
    columns, rows = (max(1, math.ceil((high - low) / (2 * half))) for low, high in ((min_x, max_x), (min_y, max_y)))
    shifts = np.stack(np.meshgrid(np.arange(columns), np.arange(rows)), axis=-1).reshape(-1, 2)
    centres = np.array([min_x, min_y]) + (2 * shifts + 1) * half
    quarters = np.array([(-1, -1), (1, -1), (-1, 1), (1, 1)], float)
    edge = area.boundary
    shapely.prepare(area)
    shapely.prepare(edge)
    best_m, best = 0.0, centres[0]
    while True:
        # Rounded, so that of two that are as good the first is taken and not the one with the greater last digit.
        radii = np.round(shapely.distance(edge, shapely.points(centres)), 6)
        radii = np.where(shapely.contains_xy(area, centres), radii, -radii)
        first = int(np.argmax(radii))
        if radii[first] > best_m:
            best_m, best = float(radii[first]), centres[first]
        promising = centres[radii + half * math.sqrt(2.0) > best_m + tolerance_m]
        if not len(promising):
            return float(best[0]), float(best[1]), best_m
        half /= 2
        centres = (promising[:, None] + half * quarters).reshape(-1, 2)


def polygons_of(geometry: shapely.Geometry) -> list[Polygon]:
    """Return the polygons in a geometry, in its order; lines and points are left out."""
    parts = shapely.get_parts(geometry) if not isinstance(geometry, Polygon) else [geometry]
    found: list[Polygon] = []
    for part in parts:
        if isinstance(part, Polygon):
            if not part.is_empty:
                found.append(part)
        elif hasattr(part, "geoms"):
            found.extend(polygons_of(part))
    return found
