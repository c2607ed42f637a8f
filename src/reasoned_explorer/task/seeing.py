"""Whether a thing that satisfies a goal is in sight: which points of it are looked at, and from where they are seen."""

from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from reasoned_explorer.task.targets import Target
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.world import World


def marks_of(
    world: World, target: Target, shape: Any, field: Any = None
) -> tuple[list[tuple[float, float]], tuple[float, ...]]:
    """Return the points of a thing that are looked at beside its nearest one, and their heights, metres.

    Args:
        world: Where it stands.
        target: The thing.
        shape: What of it is looked at (shapely), not empty.
        field: Only points in here are looked at (shapely); None for no limit.
    """
    item = world.objects[target.object_id]
    height_m = item.size_m[2]
    points: list[tuple[float, float]] = []
    if item.object_class.kind not in {"area", "place"}:
        if field is None or shapely.intersects_xy(field, item.x_m, item.y_m):
            points.append((item.x_m, item.y_m))
        corners = shapely.get_coordinates(shape)
        points += [(float(x), float(y)) for x, y in corners[:: max(1, len(corners) // 4)]]
    return points, (0.5 * height_m, 0.9 * height_m) if height_m > 1.0 else (0.5 * height_m,)


def sees_many(
    atlas: Atlas, target: Target, xs_m: NDArray[np.float64], ys_m: NDArray[np.float64], *, eye_m: float
) -> NDArray[np.bool_]:
    """Return from which places there is a line of sight to a thing, as the judge asks it for one.

    Args:
        atlas: The world.
        target: The thing.
        xs_m: East, metres, shape (n,).
        ys_m: North, metres, likewise.
        eye_m: Height of the eye, metres.
    """
    seen = np.zeros(len(xs_m), dtype=np.bool_)
    if not len(xs_m):
        return seen
    lines = shapely.shortest_line(shapely.points(xs_m, ys_m), target.shape)
    nearest = shapely.get_coordinates(lines).reshape(-1, 2, 2)[:, 1]
    fixed, heights = marks_of(atlas.world, target, target.shape)
    eyes = np.column_stack((xs_m, ys_m, np.full(len(xs_m), eye_m)))
    for mark in (None, *fixed):
        for height_m in heights:
            left = np.flatnonzero(~seen)
            ends = nearest[left] if mark is None else np.broadcast_to(np.asarray(mark), (len(left), 2))
            points = np.column_stack((ends, np.full(len(left), height_m)))
            seen[left] = atlas.sight.clear_many(eyes[left], points, ignore_object=target.object_id)
    return seen
