"""Where ways for walkers cross carriageways."""

from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from reasoned_explorer.world.taxonomy import Ground
from reasoned_explorer.world.world import Way, World

Floats = NDArray[np.float64]

_FOOT = frozenset({Ground.PAVEMENT, Ground.PATH, Ground.CYCLEWAY})
#: Wider than this, it is a street's pavements drawn as one strip.
_WIDEST_FOOTWAY_M = 6.0
_QUIET = frozenset({"service", "track", "driveway", "living_street"})
#: Narrower carriageways are crossed without markings, metres.
_NARROWEST_MARKED_M = 5.0
#: A way at a smaller angle to the road runs along it, sine.
_LEAST_SINE = 0.45
#: Stripes nearer to each other than this would overlap, metres.
_APART_M = 3.6


@dataclass(frozen=True, slots=True, eq=False)
class Crossings:
    """Where ways for walkers cross carriageways, one row each.

    Attributes:
        middles: On the road's centre line, shape (n, 2), ENU metres.
        along: Unit directions of the road there, shape (n, 2).
        walks: Unit directions of the way that crosses, shape (n, 2).
        road_m: Widths of the carriageway, shape (n,).
        walk_m: Widths of the way, shape (n,).
        marked: Whether there are stripes, shape (n,).
    """

    middles: Floats
    along: Floats
    walks: Floats
    road_m: Floats
    walk_m: Floats
    marked: NDArray[np.bool_]

    def cover(self, points: Floats, owners: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Return which points lie on the stripes of a crossing that comes before their own, shape (n,).

        Args:
            points: Shape (n, 2), metres.
            owners: The crossing that each belongs to; the number of crossings for those that belong to none.
        """
        found = np.zeros(len(points), np.bool_)
        chosen = np.flatnonzero(self.marked)
        if not len(points) or not len(chosen):
            return found
        tree = shapely.STRtree(shapely.points(self.middles[chosen]))
        reach = float((self.road_m[chosen] + self.walk_m[chosen]).max()) / 2.0 + 1.0
        at, row = tree.query(shapely.points(points), predicate="dwithin", distance=reach)
        crossing = chosen[row]
        off, along = points[at] - self.middles[crossing], self.along[crossing]
        ahead, aside = np.abs(np.sum(off * along, axis=1)), np.abs(_cross(off, along))
        on = (ahead < self.walk_m[crossing] / 2.0 + 0.4) & (aside < self.road_m[crossing] / 2.0 + 0.2)
        found[at[on & (crossing < owners[at])]] = True
        return found

    def road_surfaces(self) -> list[Floats]:
        """Return what of the carriageway the crossing ways were painted over, as rings of four corners."""
        sine = np.abs(_cross(self.along, self.walks))
        across = np.column_stack([-self.along[:, 1], self.along[:, 0]])
        ahead = self.along * (self.walk_m / 2.0 / sine + 0.3)[:, None]
        slanting = self.walks * (self.road_m / 2.0 / sine)[:, None]
        straight = across * (self.road_m / 2.0)[:, None]
        rings = [
            np.stack(
                [middle + side + ahead, middle - side + ahead, middle - side - ahead, middle + side - ahead], axis=1
            )
            for middle in (self.middles,)
            for side in (slanting, straight)
        ]
        return list(np.concatenate(rings))


def crossings_of(world: World) -> Crossings:
    """Return where later ways for walkers lie across the centre lines of carriageways on the ground."""
    ways = [way for way in world.ways if way.level == 0]
    roads = [(at, way) for at, way in enumerate(ways) if is_carriageway(way)]
    walks = [
        (at, way)
        for at, way in enumerate(ways)
        if way.ground in _FOOT and way.width_m <= _WIDEST_FOOTWAY_M and way.kind != "sidewalk"
    ]
    pairs = _segments_that_cross([way for _, way in roads], [way for _, way in walks])
    order = np.array([at for at, _ in roads], dtype=np.int64)[pairs.road]
    later = np.array([at for at, _ in walks], dtype=np.int64)[pairs.walk] > order
    sine = np.abs(_cross(pairs.along, pairs.walks))
    keep = later & (sine > _LEAST_SINE)
    road_m = np.array([way.width_m for _, way in roads])[pairs.road]
    walk_m = np.array([way.width_m for _, way in walks])[pairs.walk]
    busy = np.array([way.kind not in _QUIET or way.width_m > 7.0 for _, way in roads], dtype=bool)[pairs.road]
    paved = np.array([way.ground == Ground.PAVEMENT for _, way in walks], dtype=bool)[pairs.walk]
    marked = keep & paved & busy & (road_m >= _NARROWEST_MARKED_M) & (sine > 0.8)
    marked &= ~_beside_another(pairs.middles, marked)
    return Crossings(
        pairs.middles[keep], pairs.along[keep], pairs.walks[keep], road_m[keep], walk_m[keep], marked[keep]
    )


def _beside_another(middles: Floats, marked: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return which marked crossings lie on an earlier one that stays: two ways over one crossing, say."""
    dropped = np.zeros(len(middles), np.bool_)
    places = np.flatnonzero(marked)
    if len(places) < 2:
        return dropped
    points = shapely.points(middles[places])
    pairs = shapely.STRtree(points).query(points, predicate="dwithin", distance=_APART_M)
    for one, other in sorted(zip(*pairs.tolist(), strict=True)):
        if one < other and not dropped[places[one]]:
            dropped[places[other]] = True
    return dropped


def is_carriageway(way: Way) -> bool:
    """Return whether cars drive there, on the ground."""
    return way.level == 0 and way.ground == Ground.ROAD and way.kind not in {"footway", "path", "steps", "cycleway"}


@dataclass(frozen=True, slots=True, eq=False)
class _Pairs:
    """Segments of roads and of walks that cross: where, which road and walk, and their unit directions."""

    middles: Floats
    road: NDArray[np.int64]
    walk: NDArray[np.int64]
    along: Floats
    walks: Floats


def _segments_that_cross(roads: list[Way], walks: list[Way]) -> _Pairs:
    nothing = np.empty(0, np.int64)
    if not roads or not walks:
        return _Pairs(np.empty((0, 2)), nothing, nothing, np.empty((0, 2)), np.empty((0, 2)))
    road_from, road_to, road_of = segments_of(roads)
    walk_from, walk_to, walk_of = segments_of(walks)
    lines = shapely.linestrings(np.stack([road_from, road_to], axis=1))
    others = shapely.linestrings(np.stack([walk_from, walk_to], axis=1))
    walk, road = shapely.STRtree(lines).query(others, predicate="intersects")
    order = np.lexsort((road, walk))
    walk, road = walk[order], road[order]
    step, other = road_to[road] - road_from[road], walk_to[walk] - walk_from[walk]
    area = _cross(step, other)
    crossing = np.abs(area) > 1e-9 * np.hypot(*step.T) * np.hypot(*other.T)
    walk, road, step, other, area = walk[crossing], road[crossing], step[crossing], other[crossing], area[crossing]
    share = _cross(walk_from[walk] - road_from[road], other) / area
    middles = road_from[road] + share[:, None] * step
    # A crossing at a bend of either line is found on both segments.
    place = np.round(middles, 1)
    keys = np.column_stack([road_of[road], walk_of[walk], place * 10.0]).astype(np.int64)
    first = np.sort(np.unique(keys, axis=0, return_index=True)[1])
    walk, road = walk[first], road[first]
    return _Pairs(
        middles[first],
        road_of[road],
        walk_of[walk],
        step[first] / np.hypot(*step[first].T)[:, None],
        other[first] / np.hypot(*other[first].T)[:, None],
    )


def segments_of(ways: list[Way]) -> tuple[Floats, Floats, NDArray[np.int64]]:
    """Return the segments of lines that are longer than a millimetre: beginnings, ends, shape (n, 2); and whose."""
    counts = [len(way.line) - 1 for way in ways]
    begins = np.concatenate([way.line[:-1] for way in ways])
    ends = np.concatenate([way.line[1:] for way in ways])
    owner = np.repeat(np.arange(len(ways)), counts)
    real = np.hypot(*(ends - begins).T) > 1e-3
    return begins[real], ends[real], owner[real]


def _cross(one: Floats, other: Floats) -> Floats:
    area: Floats = one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]
    return area
