"""What ground is where, while a world is still on the drawing board."""

from collections.abc import Sequence

import numpy as np
import shapely
from numpy.typing import NDArray
from shapely import LineString, Polygon

from reasoned_explorer.world.generator import planar
from reasoned_explorer.world.generator.shapes import Points
from reasoned_explorer.world.raster import Canvas
from reasoned_explorer.world.taxonomy import Ground
from reasoned_explorer.world.world import Way

Codes = NDArray[np.uint8]
_CELL_M = 0.5
#: Cells of the coarse picture that `GroundPlan.spread_out` returns.
COARSE_M = 5.0
#: How far "near" reaches.
NEAR_M = 20.0
_TURNS = np.arange(8) * (np.pi / 4)


class GroundPlan:
    """A picture of the ground with cells of half a metre, painted in drawing order.

    Args:
        areas: Regions in drawing order.
        grounds: What each of them is.
        ways: In drawing order, above the regions.
        walls: Footprints of buildings, above all; of roofs that one can walk under, too.
        box: The world, a square.
    """

    def __init__(
        self,
        areas: Sequence[Polygon],
        grounds: Sequence[Ground],
        ways: Sequence[Way],
        walls: Sequence[Polygon],
        box: Polygon,
    ) -> None:
        lines = np.array([LineString(way.line) for way in ways], dtype=object)
        widths = np.array([way.width_m for way in ways], float)
        beds = planar.buffer(lines, widths / 2, quad_segs=3, cap_style="flat") if len(ways) else []
        codes = [*grounds, *(way.ground for way in ways), *([Ground.BUILDING] * len(walls))]
        #: South-west corner, metres.
        self.origin = (float(box.bounds[0]), float(box.bounds[1]))
        self._cells = round((box.bounds[2] - box.bounds[0]) / _CELL_M)
        self._picture = np.zeros((self._cells, self._cells), np.uint8)
        canvas = Canvas(self._picture, *self.origin, _CELL_M)
        canvas.fill(_rings_of([*areas, *beds, *walls]), [int(code) for code in codes])

    def at(self, points: Points) -> Codes:
        """Return the ground codes at points, shape (n,), true to half a cell; `Ground.UNKNOWN` outside the world."""
        rows = np.floor((points[:, 1] - self.origin[1]) / _CELL_M).astype(int)
        columns = np.floor((points[:, 0] - self.origin[0]) / _CELL_M).astype(int)
        last = self._cells - 1
        inside = (rows >= 0) & (columns >= 0) & (rows <= last) & (columns <= last)
        codes = self._picture[np.clip(rows, 0, last), np.clip(columns, 0, last)]
        return np.where(inside, codes, np.uint8(Ground.UNKNOWN))

    def by_a_wall(self, points: Points, reach_m: float) -> NDArray[np.bool_]:
        """Return which points have a building within a short reach (metres), in one of eight directions."""
        found = np.zeros(len(points), bool)
        for share in (1.0, 0.5) if reach_m > 1.0 else (1.0,):
            for turn in _TURNS.tolist():
                aside = share * reach_m * np.array([np.cos(turn), np.sin(turn)])
                found |= self.at(points + aside) == Ground.BUILDING
        return found

    def spread_out(self) -> NDArray[np.bool_]:
        """Return which grounds lie within about 20 m: shape (grounds, rows, columns), cells of `COARSE_M`."""
        step = round(COARSE_M / _CELL_M)
        picture = self._picture[step // 2 :: step, step // 2 :: step]
        rows, columns = picture.shape
        reach = int(NEAR_M / COARSE_M)
        near = np.zeros((len(Ground), rows, columns), bool)
        for code in np.unique(picture).tolist():
            padded = np.pad(picture == code, reach)
            for down in range(-reach, reach + 1):
                half = int((reach * reach - down * down) ** 0.5)
                line = padded[reach + down : reach + down + rows]
                for right in range(-half, half + 1):
                    near[code] |= line[:, reach + right : reach + right + columns]
        return near


def _rings_of(areas: Sequence[shapely.Geometry]) -> list[list[Points]]:
    """Return the coordinates of all rings of each area, those of its parts one after the other."""
    parts, area_of_part = shapely.get_parts(np.array(areas, dtype=object), return_index=True)
    rings, part_of_ring = shapely.get_rings(parts, return_index=True)
    corners, ring_of_corner = shapely.get_coordinates(rings, return_index=True)
    found: list[list[Points]] = [[] for _ in areas]
    ends = np.searchsorted(ring_of_corner, np.arange(len(rings)), side="right").tolist()
    start = 0
    for end, area in zip(ends, area_of_part[part_of_ring].tolist(), strict=True):
        found[area].append(corners[start:end])
        start = end
    return found
