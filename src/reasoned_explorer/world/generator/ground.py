"""What ground is where, while a world is still on the drawing board."""

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely import LineString, Polygon

from reasoned_explorer.world.generator.shapes import Points
from reasoned_explorer.world.taxonomy import Ground
from reasoned_explorer.world.world import Building, Region, Way

Codes = NDArray[np.int8]
_CELL_M = 5.0


class GroundPlan:
    """Exact answers for points, and a coarse picture of which grounds are near.

    Args:
        regions: In drawing order.
        ways: In drawing order, above the regions.
        buildings: Above all.
        box: The world.
    """

    def __init__(
        self, regions: tuple[Region, ...], ways: tuple[Way, ...], buildings: tuple[Building, ...], box: Polygon
    ) -> None:
        areas = [Polygon(region.outer, region.holes) for region in regions]
        lines = np.array([LineString(way.line) for way in ways], dtype=object)
        widths = np.array([way.width_m for way in ways], float)
        beds = shapely.buffer(lines, widths / 2, quad_segs=3, cap_style="flat") if len(ways) else []
        walls = [Polygon(building.outer, building.holes) for building in buildings]
        self._tree = shapely.STRtree([*areas, *beds, *walls])
        codes = [region.ground for region in regions] + [way.ground for way in ways]
        self._codes: Codes = np.array([*codes, *([Ground.BUILDING] * len(walls))], np.int8)
        self.walls = shapely.STRtree(walls) if walls else None
        self._box = box
        self._near: NDArray[np.bool_] | None = None

    def at(self, points: Points) -> Codes:
        """Return the ground codes at points, shape (n,); `Ground.UNKNOWN` outside the world."""
        if not len(points):
            return np.zeros(0, np.int8)
        point, area = self._tree.query(shapely.points(points), predicate="intersects")
        top = np.full(len(points), -1)
        np.maximum.at(top, point, area)
        return np.where(top >= 0, self._codes[top], np.int8(Ground.UNKNOWN))

    def building_at(self, points: Points) -> NDArray[np.intp]:
        """Return for each point the place of a building that it is in, or -1."""
        result = np.full(len(points), -1)
        if self.walls is not None and len(points):
            point, wall = self.walls.query(shapely.points(points), predicate="intersects")
            result[point] = wall
        return result

    def near(self, points: Points) -> NDArray[np.bool_]:
        """Return which grounds lie within 20 m of points: shape (n, number of grounds)."""
        min_x, min_y, max_x, max_y = self._box.bounds
        if self._near is None:
            self._near = self._spread_out()
        rows = np.clip(((points[:, 1] - min_y) / _CELL_M).astype(int), 0, self._near.shape[1] - 1)
        columns = np.clip(((points[:, 0] - min_x) / _CELL_M).astype(int), 0, self._near.shape[2] - 1)
        del max_x, max_y
        found: NDArray[np.bool_] = self._near[:, rows, columns].T
        return found

    def picture(self) -> Codes:
        """Return the ground at the middle of each cell of 5 m, rows from the south, shape (rows, columns)."""
        min_x, min_y, max_x, max_y = self._box.bounds
        xs = np.arange(min_x + _CELL_M / 2, max_x, _CELL_M)
        ys = np.arange(min_y + _CELL_M / 2, max_y, _CELL_M)
        grid = np.stack(np.meshgrid(xs, ys), axis=-1)
        return self.at(grid.reshape(-1, 2)).reshape(grid.shape[:2])

    def _spread_out(self) -> NDArray[np.bool_]:
        picture = self.picture()
        rows, columns = picture.shape
        reach = int(20.0 / _CELL_M)
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
