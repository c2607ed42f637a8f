"""The footprints of many buildings as flat arrays: tidied rings, edges, triangles."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely
from numpy.typing import NDArray

from reasoned_explorer.rendering.triangulation import starts_of, tidy_rings, triangulate_all
from reasoned_explorer.world.rounding import millimetres
from reasoned_explorer.world.world import Building

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

#: A corner this little off the line between its neighbours shapes nothing, millimetres.
_SLACK_MM = 20
_LEAST_AREA_MM2 = 250_000
#: Sharper corners than this have no sensible mitre: one plus the cosine between the normals of their edges.
_SHARPEST = 0.12


@dataclass(frozen=True, eq=False)
class Footprints:
    """Footprints of buildings. Edge k runs from corner k to the corner after it, the building on its left.

    Attributes:
        count: How many buildings there are; some may have lost all their corners.
        corners: Shape (n, 2), ENU metres; outlines counter-clockwise, courtyards clockwise.
        after: The corner after each on its ring, shape (n,).
        before: The corner before, shape (n,).
        owners: The building of each corner, shape (n,).
        in_court: Whether each corner is of a courtyard, shape (n,).
        triangles: Of all footprints, places in ``corners``, counter-clockwise, shape (m, 3).
    """

    count: int
    corners: Floats
    after: Ints
    before: Ints
    owners: Ints
    in_court: Bools
    triangles: Ints

    @classmethod
    def of(cls, buildings: Sequence[Building]) -> "Footprints":
        """Tidy and triangulate the footprints of buildings."""
        rings = [
            (at, ring, hole)
            for at, one in enumerate(buildings)
            for ring, hole in ((one.outer, False), *((ring, True) for ring in one.holes))
        ]
        points = np.concatenate([np.empty((0, 2)), *(ring for _, ring, _ in rings)])
        whole = millimetres(points).astype(np.int64)
        starts = starts_of([len(ring) for _, ring, _ in rings])
        is_hole = np.array([hole for _, _, hole in rings], dtype=np.bool_)
        kept, ends = tidy_rings(whole, starts, is_hole, _SLACK_MM, _LEAST_AREA_MM2)
        owner = np.array([at for at, _, _ in rings], dtype=np.int64)
        sizes = np.diff(ends)
        # A courtyard without a building around it is none.
        lost = np.zeros(len(buildings), dtype=np.bool_)
        lost[owner[~is_hole & (sizes == 0)]] = True
        stays = np.repeat(~lost[owner], sizes)
        kept, sizes = kept[stays], np.where(lost[owner], 0, sizes)
        used = sizes > 0
        ring_starts = starts_of(sizes[used])
        per_building = np.bincount(owner[used], minlength=len(buildings))
        corners = whole[kept]
        triangles = triangulate_all(corners, ring_starts, starts_of(per_building))
        after, before = _neighbours(ring_starts)
        return cls(
            len(buildings),
            corners / 1000.0,
            after,
            before,
            np.repeat(owner[used], sizes[used]),
            np.repeat(is_hole[used], sizes[used]),
            triangles,
        )

    @cached_property
    def lengths(self) -> Floats:
        """Of the edges, shape (n,), metres."""
        return np.asarray(np.hypot(*(self.corners[self.after] - self.corners).T))

    @cached_property
    def along(self) -> Floats:
        """Unit directions of the edges, shape (n, 2)."""
        return np.asarray((self.corners[self.after] - self.corners) / self.lengths[:, None])

    @cached_property
    def outwards(self) -> Floats:
        """Unit normals of the edges, away from the building, shape (n, 2)."""
        return np.column_stack([self.along[:, 1], -self.along[:, 0]])

    @cached_property
    def mitres(self) -> Floats:
        """How far each corner moves into the building for each metre that its edges do, shape (n, 2)."""
        one, other = -self.outwards[self.before], -self.outwards
        denominator = 1.0 + np.sum(one * other, axis=1)
        return np.asarray((one + other) / np.maximum(denominator, _SHARPEST)[:, None])

    @cached_property
    def blunt(self) -> Bools:
        """Of each building, whether all its corners can be mitred, shape (count,)."""
        dot = np.sum(self.outwards[self.before] * self.outwards, axis=1)
        return np.asarray(np.bincount(self.owners[1.0 + dot < _SHARPEST], minlength=self.count) == 0)

    def cover(self, points: Floats) -> Bools:
        """Return which points, shape (n, 2), lie in a footprint."""
        found = np.zeros(len(points), np.bool_)
        tree = shapely.STRtree(shapely.polygons(self.corners[self.triangles]))
        found[tree.query(shapely.points(points), predicate="intersects")[0]] = True
        return found

    @cached_property
    def triangle_owners(self) -> Ints:
        """The building of each triangle, shape (m,)."""
        return np.asarray(self.owners[self.triangles[:, 0]])

    @cached_property
    def sizes(self) -> Ints:
        """How many corners each building has, courtyards included, shape (count,)."""
        return np.bincount(self.owners, minlength=self.count)

    @cached_property
    def places(self) -> Ints:
        """The place of each corner among its own building's, shape (n,)."""
        return np.asarray(np.arange(len(self.owners)) - (np.cumsum(self.sizes) - self.sizes)[self.owners])

    @cached_property
    def areas(self) -> Floats:
        """Of each building, shape (count,), square metres."""
        areas = self.triangle_areas(self.corners)
        return np.asarray(np.bincount(self.triangle_owners, weights=areas, minlength=self.count), dtype=np.float64)

    def triangle_areas(self, corners: Floats) -> Floats:
        """Return the signed areas of the triangles with their corners moved, shape (m,)."""
        a, b, c = (corners[self.triangles[:, at]] for at in range(3))
        return np.asarray(((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]) / 2.0)

    def inset(self, depths: Floats) -> Floats:
        """Return the corners moved into the building, shape (n, 2).

        Args:
            depths: Of each building, shape (count,), metres; below zero they move out.
        """
        return np.asarray(self.corners + depths[self.owners][:, None] * self.mitres)

    @cached_property
    def deepest(self) -> Floats:
        """How far each building's edges can move in before one of them has no length, shape (count,), metres."""
        rate = np.sum((self.mitres[self.after] - self.mitres) * self.along, axis=1)
        reach = np.where(rate < -1e-6, self.lengths / np.maximum(-rate, 1e-6), np.inf)
        depth = np.full(self.count, np.inf)
        np.minimum.at(depth, self.owners, reach)
        return np.where(np.isfinite(depth), depth, 0.0)

    def depth_within(self, wanted: Floats) -> Floats:
        """Return how far edges can move in, at most as wanted, without a roof folding over itself; 0 for not at all.

        Args:
            wanted: Of each building, shape (count,), metres.
        """
        depth = np.zeros(self.count)
        for share in (0.25, 0.45, 0.7, 1.0):
            tried = np.minimum(wanted, 0.96 * self.deepest) * share
            areas = self.triangle_areas(self.inset(tried))
            folds = np.bincount(self.triangle_owners[areas < -0.05], minlength=self.count) > 0
            depth = np.where(~folds & self.blunt, tried, depth)
        return depth

    @cached_property
    def four_square(self) -> Bools:
        """Of each building, whether its footprint is nearly a rectangle of four corners, shape (count,)."""
        cosine = np.abs(np.sum(self.along[self.before] * self.along, axis=1))
        shorter = np.minimum(self.lengths, self.lengths[self.after[self.after]])
        longer = np.maximum(self.lengths, self.lengths[self.after[self.after]])
        skewed = (cosine > 0.3) | (shorter < 0.72 * longer) | self.in_court
        straight = np.bincount(self.owners[skewed], minlength=self.count) == 0
        return np.asarray((self.sizes == 4) & straight)


def _neighbours(ring_starts: Ints) -> tuple[Ints, Ints]:
    """Return the place after and before each corner on its ring."""
    count = int(ring_starts[-1])
    after, before = np.arange(1, count + 1), np.arange(-1, count - 1)
    begins, ends = ring_starts[:-1], ring_starts[1:] - 1
    after[ends], before[begins] = begins, ends
    return after, before
