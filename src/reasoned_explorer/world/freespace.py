"""Where a traveller can stand."""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.model import Fault, InputError
from reasoned_explorer.world.freespace_kernels import (
    block_rectangles,
    clearance_of,
    close_shunned,
    coarsen,
    free_near,
    label_stretches,
)
from reasoned_explorer.world.raster import Canvas, GroundRaster, walls_of
from reasoned_explorer.world.taxonomy import IMPASSABLE_IN_FLIGHT, IMPASSABLE_ON_FOOT, Ground
from reasoned_explorer.world.world import World, WorldObject

#: Radius of a tree's trunk, metres (assumed; its size is that of the crown, which one can go under).
TRUNK_RADIUS_M = 0.3
#: Shunned ground this near to compliant ground is tolerated, metres.
SHUNNED_TOLERANCE_M = 2.0
#: A start or target in a blocked cell is moved to a free one within this distance, metres.
SNAP_M = 3.0
_CELL_M = 1.0
_MAX_RADIUS_M = 5.0


@dataclass(frozen=True, slots=True)
class Traveller:
    """What it takes to get through.

    Attributes:
        flies: Low above the ground: over water and rails, but not through buildings and what stands about.
        radius_m: Of its body, metres, in [0, 5].
        collides: Whether anything stops it at all.
        strays_m: So far from ground that is not shunned it goes on shunned ground, metres, in [0, 2]; a judge
            tolerates 2 m, and who errs by a little on its way had better keep to less.
    """

    flies: bool
    radius_m: float
    collides: bool = True
    strays_m: float = SHUNNED_TOLERANCE_M

    def __post_init__(self) -> None:
        limits = {"radius_m": (self.radius_m, _MAX_RADIUS_M), "strays_m": (self.strays_m, SHUNNED_TOLERANCE_M)}
        faults = [
            Fault(f"{name} = {value}", f"a number in [0, {most:g}]")
            for name, (value, most) in limits.items()
            if not 0.0 <= value <= most
        ]
        if faults:
            raise InputError("traveller", faults)

    @property
    def impassable(self) -> frozenset[Ground]:
        """Ground that it cannot be on."""
        if not self.collides:
            return frozenset()
        return IMPASSABLE_IN_FLIGHT if self.flies else IMPASSABLE_ON_FOOT


@dataclass(frozen=True, slots=True)
class Grid:
    """Square cells over a world.

    Attributes:
        min_x_m: West edge, ENU metres.
        min_y_m: South edge, ENU metres.
        cell_m: Edge of a cell, metres.
        rows: From south to north.
        cols: From west to east.
    """

    min_x_m: float
    min_y_m: float
    cell_m: float
    rows: int
    cols: int

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return self.rows, self.cols

    def cells_of(self, points_m: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return ENU points, shape (n, 2), in cells: (column + share, row + share)."""
        cells: NDArray[np.float64] = (points_m - (self.min_x_m, self.min_y_m)) / self.cell_m
        # The outer border belongs to the grid; searches want points truly inside.
        far = (self.cols, self.rows)
        near = np.clip(cells, 1e-4, np.asarray(far) - 1e-4)
        return np.where(np.abs(cells - near) <= 2e-4, near, cells)

    def holds(self, x: float, y: float) -> bool:
        """Return whether a point that is given in cells lies in the grid."""
        return 0.0 <= x < self.cols and 0.0 <= y < self.rows

    def points_of(self, cells: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return points that are given in cells, shape (n, 2), in ENU metres."""
        return cells * self.cell_m + (self.min_x_m, self.min_y_m)

    def centres_of(self, mask: NDArray[np.bool_]) -> NDArray[np.float64]:
        """Return the centres of the cells that a mask of this grid's shape picks, shape (n, 2), ENU metres."""
        return self.points_of(np.argwhere(mask)[:, ::-1].astype(np.float64) + 0.5)

    def disc(self, x_m: float, y_m: float, radius_m: float) -> NDArray[np.int64]:
        """Return the flat indices of the cells whose centre is within a radius of a point, rising."""
        x, y = (x_m - self.min_x_m) / self.cell_m, (y_m - self.min_y_m) / self.cell_m
        reach = radius_m / self.cell_m
        rows = np.arange(max(0, math.floor(y - reach)), min(self.rows, math.ceil(y + reach)))
        cols = np.arange(max(0, math.floor(x - reach)), min(self.cols, math.ceil(x + reach)))
        inside = (rows[:, None] + 0.5 - y) ** 2 + (cols[None, :] + 0.5 - x) ** 2 <= reach * reach
        picked_rows, picked_cols = np.nonzero(inside)
        return np.asarray(rows[picked_rows] * self.cols + cols[picked_cols], dtype=np.int64)


@dataclass(frozen=True, eq=False)
class FreeSpace:
    """Where one traveller can stand.

    Attributes:
        grid: The cells.
        clearance: 0 in blocked cells, else the chessboard distance in cells to the nearest blocked one, at most 255;
            shape (rows, cols), uint8.
    """

    grid: Grid
    clearance: NDArray[np.uint8]

    @property
    def free(self) -> NDArray[np.bool_]:
        """Whether one can stand in a cell, shape (rows, cols)."""
        return self.clearance > 0

    @property
    def stretches(self) -> NDArray[np.int32]:
        """Which connected stretch a cell belongs to, from 1; 0 is blocked; shape (rows, cols)."""
        return self._labels[0]

    @property
    def stretch_sizes(self) -> NDArray[np.int64]:
        """Cells of every stretch, by its number; of 0 the blocked cells."""
        return self._labels[1]

    @cached_property
    def _labels(self) -> tuple[NDArray[np.int32], NDArray[np.int64]]:
        labels, sizes = label_stretches(self.clearance)
        return labels, sizes

    def places_near(self, x_m: float, y_m: float) -> list[tuple[int, float]]:
        """Return the free cells that a point stands for: flat index and metres that the point is moved.

        A point in a free cell stands for that cell. Another is moved to the nearest free cell within `SNAP_M`; where
        several connected stretches are that near, there is one cell of each (up to 8), nearest first.
        """
        point = self.grid.cells_of(np.asarray([[x_m, y_m]]))[0]
        cells, moved = free_near(self.clearance, self.stretches, point[0], point[1], SNAP_M / self.grid.cell_m)
        return [(int(cell), float(way) * self.grid.cell_m) for cell, way in zip(cells, moved, strict=True)]


class FreeSpaceMaker:
    """Makes free spaces of a world for travellers.

    Args:
        world: The world.
        ground: Its ground.
    """

    def __init__(self, world: World, ground: GroundRaster) -> None:
        self._world, self._ground = world, ground
        self._factor = max(1, round(_CELL_M / ground.cell_m))
        rows, cols = (math.ceil(count / self._factor) for count in ground.codes.shape)
        self.grid = Grid(ground.min_x_m, ground.min_y_m, self._factor * ground.cell_m, rows, cols)

    def make(self, traveller: Traveller, shunned: frozenset[Ground]) -> FreeSpace:
        """Return where a traveller can stand (`Geodesics` says what is blocked)."""
        blocked = np.zeros(self.grid.shape, np.uint8)
        marked = np.zeros(self.grid.shape, np.uint8)
        passable, shunned_codes = ~_flags(traveller.impassable), _flags(shunned - traveller.impassable)
        coarsen(self._ground.codes, self._factor, passable, shunned_codes, blocked, marked)
        if shunned:
            blocked = close_shunned(blocked, marked, traveller.strays_m / self.grid.cell_m)
        if traveller.collides:
            self._block_solids(blocked, traveller.radius_m)
        return FreeSpace(self.grid, clearance_of(blocked))

    def _block_solids(self, blocked: NDArray[np.uint8], radius_m: float) -> None:
        solids = [item for item in self._world.objects if item.object_class.solid]
        outlined = [np.asarray(item.outline) for item in solids if _has_outline(item)]
        rectangles = [_rectangle(item) for item in solids if not _has_outline(item)]
        rings = [ring for polygon in walls_of(self._world) for ring in polygon]
        canvas = Canvas(blocked, self.grid.min_x_m, self.grid.min_y_m, self.grid.cell_m)
        canvas.fill([(ring,) for ring in outlined], 1)
        canvas.outline([*rings, *outlined], radius_m, 1)
        if rectangles:
            table = np.asarray(rectangles, dtype=np.float64)
            table[:, :2] -= (self.grid.min_x_m, self.grid.min_y_m)
            table[:, (0, 1, 4, 5)] /= self.grid.cell_m
            trunks = np.asarray(
                [o.object_class.kind == "plant" and o.class_name == "tree" for o in solids if not _has_outline(o)]
            )
            block_rectangles(blocked, table[~trunks], radius_m / self.grid.cell_m)
            block_rectangles(blocked, table[trunks], (radius_m + TRUNK_RADIUS_M) / self.grid.cell_m)


def _has_outline(item: WorldObject) -> bool:
    return item.outline is not None and item.class_name != "tree"


def _rectangle(item: WorldObject) -> tuple[float, ...]:
    """Return centre, sine and cosine of the heading, half length and half width; a tree's trunk is a point."""
    half_length, half_width = (0.0, 0.0) if item.class_name == "tree" else (item.size_m[0] / 2, item.size_m[1] / 2)
    heading = item.heading_rad
    return item.x_m, item.y_m, math.sin(heading), math.cos(heading), half_length, half_width


def _flags(grounds: frozenset[Ground]) -> NDArray[np.bool_]:
    flags = np.zeros(256, np.bool_)
    flags[[int(ground) for ground in grounds]] = True
    return flags
