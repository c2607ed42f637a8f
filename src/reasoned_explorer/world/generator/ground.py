"""What ground is where, while a world is still on the drawing board."""

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely import LineString, Polygon

from reasoned_explorer.world.generator.shapes import Points
from reasoned_explorer.world.taxonomy import Ground
from reasoned_explorer.world.world import Building, Region, Way

Codes = NDArray[np.int8]
_CELL_M = 0.5
#: Cells of the coarse picture that `GroundPlan.near` looks at.
_COARSE_M = 5.0


class GroundPlan:
    """A picture of the ground with cells of half a metre, painted in drawing order.

    Args:
        regions: In drawing order.
        ways: In drawing order, above the regions.
        buildings: Above all; roofs that one can walk under among them.
        box: The world, a square.
    """

    def __init__(
        self, regions: tuple[Region, ...], ways: tuple[Way, ...], buildings: tuple[Building, ...], box: Polygon
    ) -> None:
        areas = [Polygon(region.outer, region.holes) for region in regions]
        lines = np.array([LineString(way.line) for way in ways], dtype=object)
        widths = np.array([way.width_m for way in ways], float)
        beds = shapely.buffer(lines, widths / 2, quad_segs=3, cap_style="flat") if len(ways) else []
        walls = [Polygon(building.outer, building.holes) for building in buildings]
        codes = [region.ground for region in regions] + [way.ground for way in ways]
        codes += [Ground.BUILDING] * len(walls)
        self._origin = (float(box.bounds[0]), float(box.bounds[1]))
        self._cells = round((box.bounds[2] - box.bounds[0]) / _CELL_M)
        self._picture = _painted([*areas, *beds, *walls], codes, self._origin, self._cells)
        self.walls = shapely.STRtree(walls) if walls else None
        self._near: NDArray[np.bool_] | None = None

    def at(self, points: Points) -> Codes:
        """Return the ground codes at points, shape (n,), true to half a cell; `Ground.UNKNOWN` outside the world."""
        rows = np.floor((points[:, 1] - self._origin[1]) / _CELL_M).astype(int)
        columns = np.floor((points[:, 0] - self._origin[0]) / _CELL_M).astype(int)
        last = self._cells - 1
        inside = (rows >= 0) & (columns >= 0) & (rows <= last) & (columns <= last)
        codes = self._picture[np.clip(rows, 0, last), np.clip(columns, 0, last)]
        return np.where(inside, codes, np.int8(Ground.UNKNOWN))

    def building_at(self, points: Points) -> NDArray[np.intp]:
        """Return for each point the place of a building that it is in or on, or -1."""
        result = np.full(len(points), -1)
        if self.walls is not None and len(points):
            point, wall = self.walls.query(shapely.points(points), predicate="dwithin", distance=1e-6)
            result[point] = wall
        return result

    def near(self, points: Points) -> NDArray[np.bool_]:
        """Return which grounds lie within about 20 m of points: shape (n, number of grounds)."""
        if self._near is None:
            self._near = self._spread_out()
        rows = np.clip(((points[:, 1] - self._origin[1]) / _COARSE_M).astype(int), 0, self._near.shape[1] - 1)
        columns = np.clip(((points[:, 0] - self._origin[0]) / _COARSE_M).astype(int), 0, self._near.shape[2] - 1)
        found: NDArray[np.bool_] = self._near[:, rows, columns].T
        return found

    def _spread_out(self) -> NDArray[np.bool_]:
        step = round(_COARSE_M / _CELL_M)
        picture = self._picture[step // 2 :: step, step // 2 :: step]
        rows, columns = picture.shape
        reach = int(20.0 / _COARSE_M)
        near = np.zeros((len(Ground), rows, columns), bool)
        for code in np.unique(picture).tolist():
            padded = np.pad(picture == code, reach)
            for down in range(-reach, reach + 1):
                for right in range(-reach, reach + 1):
                    if down * down + right * right <= reach * reach:
                        near[code] |= padded[
                            reach + down : reach + down + rows, reach + right : reach + right + columns
                        ]
        return near


def _painted(areas: list[shapely.Geometry], codes: list[Ground], origin: tuple[float, float], cells: int) -> Codes:
    """Paint polygons one over the other (even-odd fill at the middles of cells), shape (cells, cells)."""
    rings, area_of_ring = shapely.get_rings(np.array(areas, dtype=object), return_index=True)
    # `get_rings` looks at one level only: multi-part areas are taken apart first.
    if any(not isinstance(area, Polygon) for area in areas):
        parts, area_of_part = shapely.get_parts(np.array(areas, dtype=object), return_index=True)
        rings, part_of_ring = shapely.get_rings(parts, return_index=True)
        area_of_ring = area_of_part[part_of_ring]
    corners, ring = shapely.get_coordinates(rings, return_index=True)
    corners = (corners - origin) / _CELL_M
    joined = np.flatnonzero(ring[1:] == ring[:-1])
    (x0, y0), (x1, y1) = corners[joined].T, corners[joined + 1].T
    first = np.maximum(np.ceil(np.minimum(y0, y1) - 0.5), 0).astype(int)
    beyond = np.minimum(np.ceil(np.maximum(y0, y1) - 0.5), cells).astype(int)
    count = np.maximum(beyond - first, 0)
    edge = np.repeat(np.arange(len(joined)), count)
    row = first[edge] + np.arange(len(edge)) - np.repeat(np.cumsum(count) - count, count)
    x = x0[edge] + (row + 0.5 - y0[edge]) * (x1[edge] - x0[edge]) / (y1[edge] - y0[edge])
    area = area_of_ring[ring[joined]][edge]
    order = np.argsort((area * cells + row) * 1.0 * (4 * cells) + np.clip(x, -cells, 2 * cells) + cells, kind="stable")
    columns = np.clip(np.ceil(x[order] - 0.5), 0, cells).astype(int)
    row, area = row[order][::2], area[order][::2]
    starts, ends = row * cells + columns[::2], row * cells + columns[1::2]
    filled = ends > starts
    picture = np.zeros(cells * cells, np.int8)
    paint = np.array([int(code) for code in codes], np.int8)[area]
    for start, end, code in zip(starts[filled].tolist(), ends[filled].tolist(), paint[filled].tolist(), strict=True):
        picture[start:end] = code
    return picture.reshape(cells, cells)
