"""Shortest ways for walkers and low flyers."""

import math
from collections import OrderedDict
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.geometry.angles import heading_towards_rad
from reasoned_explorer.model import Fault, InputError
from reasoned_explorer.world.freespace import SNAP_M, FreeSpace, FreeSpaceMaker, Grid, Traveller
from reasoned_explorer.world.geodesic_kernels import lengths_at, search, tighten, trace, visible
from reasoned_explorer.world.raster import GroundRaster
from reasoned_explorer.world.taxonomy import Ground
from reasoned_explorer.world.world import World

__all__ = ["DistanceField", "Geodesics", "NextPoint", "Targets", "Traveller"]

#: Where a way may end: points, shape (n, 2), ENU metres; discs (x, y, radius), shape (n, 3), metres; or a mask of the
#: cells of `Geodesics.grid`, shape (rows, cols), bool. One point or one disc may be given as a plain tuple.
Targets = NDArray[Any] | Sequence[Sequence[float]] | Sequence[float]
FloatArray = NDArray[np.float64]
_NOWHERE: frozenset[Ground] = frozenset()
_CACHE_BYTES = 400_000_000
_GOAL = 4


@dataclass(frozen=True, slots=True)
class NextPoint:
    """Where to go next on a shortest way.

    Attributes:
        x_m: The next corner, or the target itself: straight ahead and free all the way; ENU metres.
        y_m: Likewise.
        heading_rad: Towards it, compass, in [0, 2π).
        distance_m: What is left of the whole way, metres.
    """

    x_m: float
    y_m: float
    heading_rad: float
    distance_m: float


@dataclass(frozen=True, eq=False)
class DistanceField:
    """How far it is from everywhere to the nearest target.

    Attributes:
        space: Where the traveller can stand.
        lengths: Shortest lengths, cells, flat; meaningful where ``links`` is not 0.
        links: Next corners, flat, as `geodesic_kernels.search` leaves them.
        sources: The targets, shape (n, 3), in cells.
    """

    space: FreeSpace
    lengths: NDArray[np.float32]
    links: NDArray[np.int32]
    sources: FloatArray

    def at(self, x_m: float, y_m: float) -> float:
        """Return the distance from a point to the nearest target, metres; infinite where there is no way.

        A point in a blocked cell is first moved to the nearest cell with a way within 3 m; the move counts.
        """
        return float(self.at_many(np.asarray([x_m]), np.asarray([y_m]))[0])

    def at_many(self, xs_m: FloatArray, ys_m: FloatArray) -> FloatArray:
        """Return the distances from points, metres, shape (n,)."""
        return self._look_up(np.stack((xs_m, ys_m), axis=1).astype(np.float64))[0]

    def descend(self, x_m: float, y_m: float) -> NextPoint | None:
        """Return where to go next from a point, or None where there is no way."""
        lengths, corners = self._look_up(np.asarray([[x_m, y_m]], dtype=np.float64))
        if math.isinf(lengths[0]):
            return None
        next_x_m, next_y_m = (float(value) for value in corners[0])
        return NextPoint(next_x_m, next_y_m, heading_towards_rad(x_m, y_m, next_x_m, next_y_m), float(lengths[0]))

    def lengths_m(self) -> FloatArray:
        """Return the distance of every cell, metres, shape (rows, cols); infinite where there is no way."""
        reached = self.links != 0
        lengths = np.full(self.links.shape, np.inf)
        lengths[reached] = self.lengths[reached].astype(np.float64) * self.space.grid.cell_m
        return lengths.reshape(self.space.grid.shape)

    def _look_up(self, points_m: FloatArray) -> tuple[FloatArray, FloatArray]:
        grid = self.space.grid
        cells = grid.cells_of(points_m)
        lengths, corners = lengths_at(
            self.space.clearance,
            self.lengths,
            self.links,
            self.sources,
            np.ascontiguousarray(cells[:, 0]),
            np.ascontiguousarray(cells[:, 1]),
            SNAP_M / grid.cell_m,
        )
        return lengths * grid.cell_m, grid.points_of(corners)


class Geodesics:
    """Shortest ways on a grid of 1 m cells.

    A cell is blocked for a traveller that collides

    - where less than half of its ground is passable: walkers cannot stand on water, rails, building sites and in
      buildings, low flyers not in buildings;
    - where its centre is within the traveller's radius of a wall or of a solid thing that stands about (of a tree only
      the trunk counts, `freespace.TRUNK_RADIUS_M`).

    *Compliant* ways: ``shunned`` ground, and with ``allowed`` all known ground that is not in it, is blocked, too, but
    for cells whose centre is within 2 m of passable ground that is not shunned. Unknown ground is neither wanted nor
    shunned: always open. A stretch on shunned ground is thus never longer than a crossing of about 4 m; ways
    that cross wider shunned ground are not looked for, even where a judge would let them pass.

    Ways bend anywhere (any-angle), so lengths come near to true Euclidean ones: within 2 % and one cell
    of the visibility graph's in the tests. Starts and targets that stand in blocked cells are moved to the nearest
    free cell within 3 m, and the move counts; of several targets the nearest is meant.

    Attributes:
        grid: The cells.
    """

    def __init__(self, world: World, ground: GroundRaster) -> None:
        self._maker = FreeSpaceMaker(world, ground)
        self.grid: Grid = self._maker.grid
        self._spaces: OrderedDict[tuple[Traveller, frozenset[Ground]], FreeSpace] = OrderedDict()
        self._desks: list[_Desk] = []

    @classmethod
    def of(cls, world: World, ground: GroundRaster) -> "Geodesics":
        """Prepare the ways of a world; the work is done when a traveller first asks."""
        return cls(world, ground)

    def space(
        self, traveller: Traveller, *, shunned: frozenset[Ground] = _NOWHERE, allowed: frozenset[Ground] | None = None
    ) -> FreeSpace:
        """Return where a traveller can stand; kept for the next question."""
        if not traveller.collides:
            traveller = Traveller(flies=True, radius_m=0.0, collides=False, strays_m=traveller.strays_m)
        key = (traveller, _shunned(shunned, allowed) - traveller.impassable)
        if key in self._spaces:
            self._spaces.move_to_end(key)
            return self._spaces[key]
        space = self._maker.make(*key)
        self._spaces[key] = space
        # Clearance and labels take five bytes a cell.
        while len(self._spaces) > max(2, _CACHE_BYTES // (5 * self.grid.rows * self.grid.cols)):
            self._spaces.popitem(last=False)
        return space

    def distance_m(
        self,
        from_xy: tuple[float, float],
        targets: Targets,
        *,
        traveller: Traveller,
        shunned: frozenset[Ground] = _NOWHERE,
        allowed: frozenset[Ground] | None = None,
    ) -> float:
        """Return the length of the shortest way to the nearest target, metres; infinite where there is none.

        The arguments are those of `path`.
        """
        way = self.path(from_xy, targets, traveller=traveller, shunned=shunned, allowed=allowed)
        return math.inf if way is None else float(np.hypot(*np.diff(way, axis=0).T).sum())

    def path(
        self,
        from_xy: tuple[float, float],
        targets: Targets,
        *,
        traveller: Traveller,
        shunned: frozenset[Ground] = _NOWHERE,
        allowed: frozenset[Ground] | None = None,
    ) -> FloatArray | None:
        """Return the shortest way to the nearest target.

        Args:
            from_xy: Where it starts, ENU metres.
            targets: Where it may end; a way to a disc ends at its edge.
            traveller: Who goes.
            shunned: Ground to keep off.
            allowed: Ground to keep to, or None for any.

        Returns:
            Its corners, both ends included, shape (n, 2), ENU metres, n ≥ 2; or None where there is no way.

        Raises:
            InputError: If a coordinate is not finite, a radius is negative or a mask has the wrong shape.
        """
        space = self.space(traveller, shunned=shunned, allowed=allowed)
        start, wanted = _points([from_xy], "start", 2)[0], _Targets.read(targets, self.grid)
        if wanted.covers(start[0], start[1]):
            return np.stack((start, start))
        for cell, _ in space.places_near(start[0], start[1]):
            ends = wanted.places(space, int(space.stretches.flat[cell]))
            if ends.cells.size:
                return self._aim(space, wanted.cut(self._way(space, start, cell, ends)), wanted.discs)
        return None

    def field_m(
        self,
        targets: Targets,
        *,
        traveller: Traveller,
        shunned: frozenset[Ground] = _NOWHERE,
        allowed: frozenset[Ground] | None = None,
        max_m: float = math.inf,
    ) -> DistanceField:
        """Return how far it is from everywhere to the nearest target.

        Args:
            targets: The targets; of a disc the cells whose centre is in it.
            traveller: Who goes.
            shunned: Ground to keep off.
            allowed: Ground to keep to, or None for any.
            max_m: Nothing further than this is looked at, metres.

        Raises:
            InputError: If a coordinate is not finite, a radius is negative, a mask has the wrong shape or ``max_m`` is
                negative or not a number.
        """
        if not max_m >= 0.0:
            raise InputError("distance field", [Fault(f"max_m = {max_m}", "a number of metres, 0 or more")])
        space = self.space(traveller, shunned=shunned, allowed=allowed)
        ends = _Targets.read(targets, self.grid).places(space, None)
        cells = self.grid.rows * self.grid.cols
        lengths, links, states = np.empty(cells, np.float32), np.zeros(cells, np.int32), np.zeros(cells, np.uint8)
        box = np.empty(0)
        search(space.clearance, lengths, links, states, ends.cells, ends.sources, box, max_m / self.grid.cell_m)
        return DistanceField(space, lengths, links, ends.sources)

    def reachable_component(
        self,
        x_m: float,
        y_m: float,
        *,
        traveller: Traveller,
        shunned: frozenset[Ground] = _NOWHERE,
        allowed: frozenset[Ground] | None = None,
    ) -> int:
        """Return which connected stretch a point is in, from 1; 0 where there is no free cell within 3 m.

        There is a way between two points if (in blocked cells: nearly only if) their stretches are the same.
        """
        space = self.space(traveller, shunned=shunned, allowed=allowed)
        places = space.places_near(*_points([(x_m, y_m)], "point", 2)[0])
        return int(space.stretches.flat[places[0][0]]) if places else 0

    def _aim(self, space: FreeSpace, way: FloatArray, discs: FloatArray) -> FloatArray:
        """Return a way whose last leg goes straight for the nearest rim of a disc, where that is shorter and free."""
        if not len(discs):
            return way
        away = discs[:, :2] - way[-2]
        rims = np.hypot(away[:, 0], away[:, 1]) - discs[:, 2]
        best = int(np.argmin(rims))
        if not 0.0 < rims[best] < math.dist(way[-2], way[-1]):
            return way
        rim = way[-2] + away[best] * (rims[best] / (rims[best] + discs[best, 2]))
        (x0, y0), (x1, y1) = self.grid.cells_of(np.stack((way[-2], rim)))
        if not self.grid.holds(x0, y0) or not self.grid.holds(x1, y1) or not visible(space.clearance, x0, y0, x1, y1):
            return way
        return np.concatenate((way[:-1], rim[None]))

    def _way(self, space: FreeSpace, start: FloatArray, cell: int, ends: "_Ends") -> FloatArray:
        grid, cols = self.grid, self.grid.cols
        begin = grid.cells_of(start[None])[0]
        stays = grid.holds(*begin) and int(begin[1]) * cols + int(begin[0]) == cell
        first = begin if stays else np.asarray([cell % cols + 0.5, cell // cols + 0.5])
        sources = np.asarray([[first[0], first[1], 0.0]])
        at = ends.sources
        box = np.asarray([at[:, 0].min(), at[:, 1].min(), at[:, 0].max(), at[:, 1].max()])
        desk = self._desks.pop() if self._desks else _Desk.of(grid)
        desk.states[ends.cells] = _GOAL
        reached, touched = search(
            space.clearance,
            desk.lengths,
            desk.links,
            desk.states,
            np.asarray([cell]),
            sources,
            box,
            math.inf,
        )
        if reached < 0:
            message = "a connected stretch without a way through it"
            raise AssertionError(message)
        corners = trace(desk.links, cols, sources, reached)
        desk.links[touched], desk.states[touched], desk.states[ends.cells] = 0, 0, 0
        self._desks.append(desk)
        mine = np.flatnonzero(ends.cells == reached)
        end = int(mine[np.argmin(at[mine, 2])])
        corners = np.concatenate((at[end : end + 1, :2], corners))
        way = grid.points_of(tighten(space.clearance, corners)[::-1])
        # What a blocked start or target was moved by is part of the way.
        head = [] if stays else [start[None]]
        tail = [ends.points[end : end + 1]] if at[end, 2] > 0.0 else []
        return np.concatenate([*head, way, *tail])


@dataclass(frozen=True, slots=True, eq=False)
class _Desk:
    """Arrays that one search after the other works on; links and states are all 0 in between."""

    lengths: NDArray[np.float32]
    links: NDArray[np.int32]
    states: NDArray[np.uint8]

    @classmethod
    def of(cls, grid: Grid) -> "_Desk":
        cells = grid.rows * grid.cols
        return cls(np.empty(cells, np.float32), np.zeros(cells, np.int32), np.zeros(cells, np.uint8))


@dataclass(frozen=True, slots=True, eq=False)
class _Ends:
    """Targets in one free space: their cells, their places and moves (n, 3) in cells, and their true points (n, 2)."""

    cells: NDArray[np.int64]
    sources: FloatArray
    points: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class _Targets:
    """Targets as they were given: points, discs (x, y, radius), and cells of a mask."""

    grid: Grid
    points: FloatArray
    discs: FloatArray
    cells: NDArray[np.int64]

    @classmethod
    def read(cls, targets: Targets, grid: Grid) -> "_Targets":
        array = np.asarray(targets)
        points, discs, cells = np.empty((0, 2)), np.empty((0, 3)), np.empty(0, np.int64)
        if array.dtype == np.bool_:
            if array.shape != grid.shape:
                what = f"a mask of shape {array.shape}"
                raise InputError("targets", [Fault(what, f"the shape of the grid, {grid.shape}")])
            cells = np.flatnonzero(array)
        elif array.size and array.shape[-1] == 3:
            discs = _points(array, "targets", 3)
            if (discs[:, 2] < 0.0).any():
                raise InputError("targets", [Fault(f"a radius of {discs[:, 2].min()} m", "0 or more")])
        elif array.size:
            points = _points(array, "targets", 2)
        return cls(grid, points, discs, cells)

    def covers(self, x_m: float, y_m: float) -> bool:
        """Return whether a point is in a disc: there is no way to go."""
        return bool((np.hypot(self.discs[:, 0] - x_m, self.discs[:, 1] - y_m) <= self.discs[:, 2]).any())

    def places(self, space: FreeSpace, stretch: int | None) -> _Ends:
        """Return the targets that lie in one connected stretch of a free space, or in any."""
        cells = np.concatenate([self.cells, *(self.grid.disc(*disc) for disc in self.discs)]).astype(np.int64)
        labels = space.stretches.ravel()[cells]
        cells = np.unique(cells[labels == stretch if stretch is not None else labels > 0])
        rows, cols = np.divmod(cells, self.grid.cols)
        sources = [np.stack((cols + 0.5, rows + 0.5, np.zeros(cells.size)), axis=1)]
        found, truths = [cells], [self.grid.points_of(sources[0][:, :2])]
        # A disc too small to hold a cell's centre counts as its middle.
        small = self.discs[self.discs[:, 2] < self.grid.cell_m, :2]
        for x_m, y_m in np.concatenate((self.points, small)):
            for cell, moved_m in space.places_near(x_m, y_m):
                if stretch is not None and space.stretches.flat[cell] != stretch:
                    continue
                place = self.grid.cells_of(np.asarray([[x_m, y_m]]))[0]
                if moved_m > 0.0:
                    place = np.asarray([cell % self.grid.cols + 0.5, cell // self.grid.cols + 0.5])
                found.append(np.asarray([cell]))
                sources.append(np.asarray([[place[0], place[1], moved_m / self.grid.cell_m]]))
                truths.append(np.asarray([[x_m, y_m]]))
        return _Ends(np.concatenate(found), np.concatenate(sources), np.concatenate(truths))

    def cut(self, way: FloatArray) -> FloatArray:
        """Return a way cut off where it first enters a disc."""
        for k in range(len(way) - 1):
            shares = [_entry(way[k], way[k + 1], disc) for disc in self.discs]
            share = min(shares, default=math.inf)
            if share <= 1.0:
                return np.concatenate((way[: k + 1], (way[k] + share * (way[k + 1] - way[k]))[None]))
        return way


def _entry(start: FloatArray, end: FloatArray, disc: FloatArray) -> float:
    """Return at which share of a segment it enters a disc; infinite where it does not."""
    along, apart = end - start, start - disc[:2]
    a, b, c = float(along @ along), float(along @ apart), float(apart @ apart - disc[2] ** 2)
    if c <= 0.0:
        return 0.0
    root = b * b - a * c
    if a == 0.0 or root < 0.0 or b > 0.0:
        return math.inf
    return (-b - math.sqrt(root)) / a


def _points(values: Any, subject: str, columns: int) -> FloatArray:
    array = np.asarray(values, dtype=np.float64)
    array = array[None] if array.ndim == 1 else array
    faults = []
    if array.ndim != 2 or array.shape[1] != columns:
        faults.append(Fault(f"an array of shape {array.shape}", f"shape (n, {columns})"))
    if not np.isfinite(array).all():
        faults.append(Fault("a coordinate that is not a finite number", "ENU metres"))
    if faults:
        raise InputError(subject, faults)
    return array


def _shunned(shunned: frozenset[Ground], allowed: frozenset[Ground] | None) -> frozenset[Ground]:
    others = frozenset() if allowed is None else frozenset(Ground) - allowed
    return (shunned | others) - {Ground.UNKNOWN, Ground.BUILDING}
