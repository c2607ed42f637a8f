"""The sea: ``natural=coastline`` has the land on its left as it runs and the water on its right."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely

from reasoned_explorer.world.osm.shapes import box_of, lines_of
from reasoned_explorer.world.world import Bounds

_PROBE_M = 0.05
_MARGIN_M = 50.0
_CERTAIN = 0.8


@dataclass(frozen=True, slots=True)
class Sea:
    """The sea within bounds.

    Attributes:
        polygons: Shapely polygons; where there is no coastline there is no sea.
        unclear: How many stretches lay on both the land's and the water's side of broken coastline; they count as what
            most of their coast says.
        loose_ends: How many ends of coastline lay inside the bounds and were led to their nearest edge.
    """

    polygons: tuple[Any, ...]
    unclear: int = 0
    loose_ends: int = 0


def sea_of(coast: Sequence[Any], bounds: Bounds) -> Sea:
    """Return where the sea is.

    The coastline and the frame of the bounds cut the plane into faces; the coast's pieces along a face say, by their
    length, on which of their sides it lies. Nothing has to be stitched together, so it also works where pieces of
    coastline are missing.

    Args:
        coast: Lines as they run on the map, ENU metres.
        bounds: What to cover.
    """
    frame = box_of(bounds)
    wide = shapely.box(*shapely.buffer(frame, _MARGIN_M).bounds)
    known = [line for whole in coast for line in lines_of(whole)]
    leads = _leads_to_the_edge(known, bounds)
    lines = [line for line in (*known, *leads) if line.intersects(wide)]
    if not lines:
        return Sea(())
    network = shapely.node(shapely.geometrycollections([*lines, wide.exterior]))
    faces = shapely.get_parts(shapely.polygonize([network]))
    if not len(faces):
        return Sea(())
    left, right, weight = _probes(lines, wide)
    if not len(weight):
        return Sea(())
    tree = shapely.STRtree(faces)
    votes = np.zeros((2, len(faces)))
    for side, points in ((0, left), (1, right)):
        point, face = tree.query(points, predicate="within")
        np.add.at(votes[side], face, weight[point])
    is_sea = votes[1] > votes[0]
    total = votes.sum(axis=0)
    certain = np.maximum(votes[0], votes[1]) >= _CERTAIN * np.maximum(total, 1e-9)
    polygons = [shapely.intersection(face, frame) for face in faces[is_sea]]
    return Sea(tuple(polygon for polygon in polygons if not polygon.is_empty),
               int((~certain & (total > 0.0)).sum()), len(leads))  # fmt: skip


def _probes(lines: Sequence[Any], area: Any) -> tuple[Any, Any, Any]:
    """Return points just left and just right of each piece of coast in an area, and the pieces' lengths."""
    starts, ends = [], []
    for line in lines:
        points = shapely.get_coordinates(line)
        starts.append(points[:-1])
        ends.append(points[1:])
    start, end = np.concatenate(starts), np.concatenate(ends)
    along = end - start
    length = np.hypot(along[:, 0], along[:, 1])
    kept = length > 1e-6
    start, along, length = start[kept], along[kept], length[kept]
    middle = start + along / 2.0
    to_left = np.column_stack([-along[:, 1], along[:, 0]]) / length[:, None] * _PROBE_M
    min_x, min_y, max_x, max_y = area.bounds
    inside = (middle[:, 0] > min_x) & (middle[:, 0] < max_x) & (middle[:, 1] > min_y) & (middle[:, 1] < max_y)
    middle, to_left, length = middle[inside], to_left[inside], length[inside]
    return shapely.points(middle + to_left), shapely.points(middle - to_left), length


def _leads_to_the_edge(pieces: Sequence[Any], bounds: Bounds) -> list[Any]:
    """Return lines that lead the coast's loose ends inside the bounds straight on to beyond the nearest edge.

    Clipped files cut the coast a little inside of what they cover.
    """
    ends: dict[tuple[float, float], int] = {}
    for line in pieces:
        points = shapely.get_coordinates(line)
        for point in (points[0], points[-1]):
            key = (round(float(point[0]), 2), round(float(point[1]), 2))
            ends[key] = ends.get(key, 0) + 1
    leads = []
    for line in pieces:
        points = shapely.get_coordinates(line)
        for at_start, (x, y) in ((True, points[0]), (False, points[-1])):
            key = (round(float(x), 2), round(float(y), 2))
            if ends[key] == 1 and bounds.contains(float(x), float(y)):
                beyond = _beyond_the_edge(float(x), float(y), bounds)
                leads.append(shapely.LineString([beyond, (x, y)] if at_start else [(x, y), beyond]))
    return leads


def _beyond_the_edge(x_m: float, y_m: float, bounds: Bounds) -> tuple[float, float]:
    far_m = 2.0 * _MARGIN_M
    options = [
        (x_m - bounds.min_x_m, (bounds.min_x_m - far_m, y_m)),
        (bounds.max_x_m - x_m, (bounds.max_x_m + far_m, y_m)),
        (y_m - bounds.min_y_m, (x_m, bounds.min_y_m - far_m)),
        (bounds.max_y_m - y_m, (x_m, bounds.max_y_m + far_m)),
    ]
    return min(options)[1]
