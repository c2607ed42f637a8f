"""What ground is where, as a raster of codes."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reasoned_explorer.model import Fault, WorldError
from reasoned_explorer.world.raster_kernels import fill_polygons, paint_lines
from reasoned_explorer.world.taxonomy import Ground
from reasoned_explorer.world.world import Bounds, Ring, World

#: A building whose underside is higher than this is a roof that one can go under, metres.
ROOF_CLEARANCE_M = 2.0
_MAX_CELLS = 200_000_000
Floats = NDArray[np.float64]
Ints = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class GroundRaster:
    """What ground is where.

    Later shapes lie on earlier ones: regions, then ways on the ground (with round ends and joins), then buildings
    (without roofs that one can go under, `ROOF_CLEARANCE_M`). A cell is what lies at its centre.

    Attributes:
        codes: Values of `Ground`, shape (rows, cols), uint8; rows from south to north, columns from west to east.
        min_x_m: West edge of the first column, ENU metres.
        min_y_m: South edge of the first row, ENU metres.
        cell_m: Edge of a cell, metres.
        bounds: Of the world; cells of the last row and column may reach beyond it.
    """

    codes: NDArray[np.uint8]
    min_x_m: float
    min_y_m: float
    cell_m: float
    bounds: Bounds

    @classmethod
    def of(cls, world: World, *, cell_m: float = 0.5) -> "GroundRaster":
        """Paint a world.

        Args:
            world: The world.
            cell_m: Edge of a cell, metres; one byte is kept for each cell.

        Raises:
            WorldError: If the cell is not positive or so small that the raster would have over 200 million cells.
        """
        bounds = world.bounds
        if not (math.isfinite(cell_m) and cell_m > 0.0):
            raise WorldError("ground raster", [Fault(f"a cell of {cell_m} m", "a positive number of metres")])
        cols = max(1, math.ceil(bounds.width_m / cell_m - 1e-9))
        rows = max(1, math.ceil(bounds.height_m / cell_m - 1e-9))
        if rows * cols > _MAX_CELLS:
            what = f"{rows} × {cols} cells of {cell_m} m"
            raise WorldError("ground raster", [Fault(what, f"at most {_MAX_CELLS} cells", "use larger cells")])
        codes = np.zeros((rows, cols), np.uint8)
        canvas = Canvas(codes, bounds.min_x_m, bounds.min_y_m, cell_m)
        canvas.fill(((r.outer, *r.holes) for r in world.regions), [int(r.ground) for r in world.regions])
        ways = [way for way in world.ways if way.level == 0]
        canvas.draw([w.line for w in ways], [w.width_m / 2.0 for w in ways], [int(w.ground) for w in ways])
        canvas.fill(walls_of(world), int(Ground.BUILDING))
        return cls(codes, bounds.min_x_m, bounds.min_y_m, cell_m, bounds)

    def at(self, x_m: float, y_m: float) -> Ground:
        """Return the ground at a point; ``UNKNOWN`` outside the world's bounds."""
        if not self.bounds.contains(x_m, y_m):
            return Ground.UNKNOWN
        rows, cols = self.codes.shape
        row = min(int((y_m - self.min_y_m) / self.cell_m), rows - 1)
        col = min(int((x_m - self.min_x_m) / self.cell_m), cols - 1)
        return Ground(int(self.codes[row, col]))

    def at_many(self, xs_m: ArrayLike, ys_m: ArrayLike) -> NDArray[np.uint8]:
        """Return the codes of the ground at points.

        Args:
            xs_m: East, metres, any shape.
            ys_m: North, metres, the same shape.

        Returns:
            Values of `Ground`, the same shape; ``UNKNOWN`` outside the world's bounds.
        """
        x, y = np.asarray(xs_m, dtype=np.float64), np.asarray(ys_m, dtype=np.float64)
        rows, columns = self.codes.shape
        across, up = (x - self.min_x_m) / self.cell_m, (y - self.min_y_m) / self.cell_m
        within = (across >= 0.0) & (across <= columns) & (x <= self.bounds.max_x_m)
        within &= (up >= 0.0) & (up <= rows) & (y <= self.bounds.max_y_m)
        # The outer border belongs to the grid.
        row = np.minimum(up[within].astype(np.int64), rows - 1)
        column = np.minimum(across[within].astype(np.int64), columns - 1)
        found = np.full(x.shape, Ground.UNKNOWN, np.uint8)
        found[within] = self.codes[row, column]
        return found

    def share(self, ground: Ground) -> float:
        """Return the share of all cells that are this ground, in [0, 1]."""
        return self.shares[ground]

    @cached_property
    def shares(self) -> dict[Ground, float]:
        """The share of every kind of ground, summing to 1."""
        counts = np.bincount(self.codes.ravel(), minlength=len(Ground))
        return {ground: float(counts[ground]) / self.codes.size for ground in Ground}

    @property
    def unknown_share(self) -> float:
        """Unknown cells among those that are not building, in [0, 1]; 0 where all is building."""
        open_share = 1.0 - self.shares[Ground.BUILDING]
        return self.shares[Ground.UNKNOWN] / open_share if open_share > 0.0 else 0.0


def walls_of(world: World) -> list[tuple[Ring, ...]]:
    """Return the rings (outline, then courtyards) of every building that stands in the way on the ground."""
    return [(b.outer, *b.holes) for b in world.buildings if b.min_height_m <= ROOF_CLEARANCE_M]


@dataclass(frozen=True, slots=True, eq=False)
class Canvas:
    """A grid of codes to paint on, in world coordinates.

    Attributes:
        codes: Shape (rows, cols), uint8; painted in place.
        min_x_m: West edge, metres.
        min_y_m: South edge, metres.
        cell_m: Edge of a cell, metres.
    """

    codes: NDArray[np.uint8]
    min_x_m: float
    min_y_m: float
    cell_m: float

    def fill(self, polygons: Iterable[Sequence[Ring]], values: Sequence[int] | int) -> None:
        """Fill polygons in order, each given by its rings (even-odd), with one value or one value each."""
        rings: list[Ring] = []
        polygon_ends: list[int] = []
        for polygon in polygons:
            rings.extend(polygon)
            polygon_ends.append(len(rings))
        if rings:
            points, ring_ends, ends = self._cells(rings), _ends(rings), np.asarray(polygon_ends, dtype=np.int64)
            rows = len(self.codes)
            room = np.empty(_most_crossings(points, ring_ends, ends, rows))
            counts = np.zeros(rows, np.int64)
            fill_polygons(self.codes, points, ring_ends, ends, _values(values, len(ends)), counts, room)

    def draw(self, lines: Sequence[Ring], radii_m: Sequence[float], values: Sequence[int] | int) -> None:
        """Draw lines in order, each with its half width, with round ends and joins."""
        if lines:
            radii = np.asarray(radii_m, dtype=np.float64) / self.cell_m
            paint_lines(self.codes, self._cells(lines), _ends(lines), radii, _values(values, len(lines)))

    def outline(self, rings: Sequence[Ring], radius_m: float, value: int) -> None:
        """Draw closed rings with a half width."""
        self.draw([np.concatenate((ring, ring[:1])) for ring in rings], [radius_m] * len(rings), value)

    def _cells(self, rings: Sequence[Ring]) -> NDArray[np.float64]:
        points = np.concatenate(rings).astype(np.float64, copy=False)
        return np.ascontiguousarray((points - (self.min_x_m, self.min_y_m)) / self.cell_m)


def _most_crossings(points: Floats, ring_ends: Ints, polygon_ends: Ints, rows: int) -> int:
    """Return how often the edges of a polygon cross the middles of rows, at most."""
    row = np.clip(np.ceil(points[:, 1] - 0.5), 0.0, rows)
    before = np.arange(len(points)) - 1
    begins = np.append(0, ring_ends[:-1])
    before[begins[begins < ring_ends]] = ring_ends[begins < ring_ends] - 1
    so_far = np.append(0.0, np.cumsum(np.abs(row - row[before])))
    ends = np.append(0, ring_ends)[np.append(0, polygon_ends)]
    return int(np.diff(so_far[ends]).max(initial=0.0))


def _ends(rings: Sequence[Ring]) -> NDArray[np.int64]:
    return np.cumsum([len(ring) for ring in rings], dtype=np.int64)


def _values(values: Sequence[int] | int, count: int) -> NDArray[np.uint8]:
    return np.full(count, values, np.uint8) if isinstance(values, int) else np.asarray(values, dtype=np.uint8)
