"""Kerbs along carriageways, and what edges water: quays and banks."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import shapely
from numpy.typing import NDArray

from reasoned_explorer.rendering.crossings import Crossings
from reasoned_explorer.rendering.ground_map import GUESSED_GREEN, GUESSED_PAVED
from reasoned_explorer.rendering.material import Material
from reasoned_explorer.rendering.patches import Patch, lifted, plan_uvs, quads, rectangle_uvs
from reasoned_explorer.world.raster import GroundRaster
from reasoned_explorer.world.taxonomy import Ground
from reasoned_explorer.world.textures import polygon_of
from reasoned_explorer.world.world import Way, World

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]

_KERB_HIGH_M, _KERB_WIDE_M = 0.08, 0.26
_QUAY_HIGH_M, _QUAY_WIDE_M = 0.16, 0.45
#: Stones reach this far into the area that they edge, metres: the drawn ground's border is only that exact.
_INTO_M = 0.13
_LONGEST_M = 12.0
_SIDE_M = 0.45
_GRANITE = np.array((0.80, 0.79, 0.77))
_BANK, _WET_SAND = np.array((0.55, 0.47, 0.34)), np.array((0.74, 0.65, 0.47))
KERBED = (Ground.PAVEMENT, Ground.PLAZA, Ground.PATH, Ground.GRASS, Ground.GARDEN, Ground.YARD, Ground.WOOD,
           GUESSED_PAVED, GUESSED_GREEN, Ground.PLAYGROUND)  # fmt: skip
_PAVED = (Ground.PAVEMENT, Ground.PLAZA, Ground.PATH, Ground.YARD, Ground.ROAD, GUESSED_PAVED, Ground.PARKING,
          Ground.CYCLEWAY)  # fmt: skip
_SOFT = (Ground.GRASS, Ground.WOOD, Ground.GARDEN, GUESSED_GREEN)


@dataclass(frozen=True, slots=True, eq=False)
class Borders:
    """Stretches of the borders of areas, the area on their left.

    Attributes:
        begins: Shape (n, 2), metres.
        ends: Likewise.
        begin_out: Where the border moved out by a metre begins, less ``begins``.
        end_out: Where it ends, less ``ends``.
    """

    begins: Floats
    ends: Floats
    begin_out: Floats
    end_out: Floats

    @property
    def middles(self) -> Floats:
        """Shape (n, 2), metres."""
        return np.asarray((self.begins + self.ends) / 2.0)

    @property
    def outwards(self) -> Floats:
        """Unit directions away from the area, shape (n, 2)."""
        out = self.begin_out + self.end_out
        return np.asarray(out / np.maximum(np.hypot(*out.T), 1e-9)[:, None])

    @property
    def both(self) -> tuple[tuple[Floats, Floats], tuple[Floats, Floats]]:
        """Begins and ends, each with its way out."""
        return (self.begins, self.begin_out), (self.ends, self.end_out)

    def where(self, chosen: Bools) -> "Borders":
        """Return some of the stretches."""
        return Borders(self.begins[chosen], self.ends[chosen], self.begin_out[chosen], self.end_out[chosen])


def kerbs(roads: Sequence[Way], ground: GroundRaster, crossings: Crossings) -> list[Patch]:
    """Return kerbs where a carriageway ends at ground for walkers or plants; they are sunk at crossings."""
    if not roads:
        return []
    lines = np.array([shapely.LineString(road.line) for road in roads], dtype=object)
    halves = np.array([road.width_m / 2.0 for road in roads])
    surface = shapely.union_all(shapely.buffer(lines, halves, quad_segs=4))
    border = _borders_of(surface)
    beyond = _ground_beside(border, ground, _SIDE_M)
    within = _ground_beside(border, ground, -_SIDE_M)
    kept = np.isin(beyond, KERBED) & (within == Ground.ROAD) & ~at_crossings(border.middles, crossings)
    return _edging(border.where(kept), high_m=_KERB_HIGH_M, wide_m=_KERB_WIDE_M)


def shores(world: World, ground: GroundRaster) -> list[Patch]:
    """Return quays where water meets paving, and banks where it meets green."""
    water = [polygon_of(one.outer, one.holes) for one in world.regions if one.ground == Ground.WATER]
    if not water:
        return []
    border = _borders_of(shapely.union_all(water))
    beyond = _ground_beside(border, ground, _SIDE_M)
    wet = _ground_beside(border, ground, -_SIDE_M) == Ground.WATER
    quay = _edging(border.where(wet & np.isin(beyond, _PAVED)), high_m=_QUAY_HIGH_M, wide_m=_QUAY_WIDE_M)
    banks = [
        _bank(border.where(wet & np.isin(beyond, kinds)), colour)
        for kinds, colour in ((_SOFT, _BANK), ((Ground.SAND,), _WET_SAND))
    ]
    return [*quay, *banks]


def _borders_of(area: Any) -> Borders:
    """Return the borders of an area, in stretches of at most `_LONGEST_M`."""
    polygons = [part for part in shapely.get_parts(area) if part.geom_type == "Polygon"]
    rings, owner = shapely.get_rings(np.array(polygons, dtype=object), return_index=True)
    if not len(rings):
        nothing = np.empty((0, 2))
        return Borders(nothing, nothing, nothing, nothing)
    is_hole = np.append(False, owner[1:] == owner[:-1])
    turned = shapely.is_ccw(rings) == is_hole
    rings = np.where(turned, shapely.reverse(rings), rings)
    rings = shapely.segmentize(shapely.simplify(rings, 0.02), _LONGEST_M)
    points, ring = shapely.get_coordinates(rings, return_index=True)
    same = ring[1:] == ring[:-1]
    begins, ends, whose = points[:-1][same], points[1:][same], ring[:-1][same]
    step = ends - begins
    normal = np.column_stack([step[:, 1], -step[:, 0]]) / np.maximum(np.hypot(*step.T), 1e-9)[:, None]
    before, after = around(whose)
    return Borders(begins, ends, mitre(normal[before], normal), mitre(normal, normal[after]))


def around(whose: Ints) -> tuple[Ints, Ints]:
    """Return the stretch before and after each on its ring."""
    count = len(whose)
    place = np.arange(count)
    first = np.searchsorted(whose, whose, side="left")
    beyond = np.searchsorted(whose, whose, side="right")
    before: Ints = np.where(place == first, beyond - 1, place - 1)
    after: Ints = np.where(place == beyond - 1, first, place + 1)
    return before, after


def mitre(one: Floats, other: Floats) -> Floats:
    """Return how far a corner moves out for each metre that its two edges do, from their unit normals, shape (n, 2)."""
    total = one + other
    mitre: Floats = total / np.maximum(1.0 + np.sum(one * other, axis=1), 0.5)[:, None]
    return mitre


def _ground_beside(border: Borders, ground: GroundRaster, off_m: float) -> NDArray[np.uint8]:
    point = border.middles + off_m * border.outwards
    return ground.at_many(point[:, 0], point[:, 1])


def at_crossings(points: Floats, crossings: Crossings) -> Bools:
    """Return which points are where people step off the pavement."""
    found = np.zeros(len(points), np.bool_)
    if not len(points) or not len(crossings.middles):
        return found
    reach = float((crossings.road_m / 2.0 + crossings.walk_m).max()) + 2.0
    # Most points are nowhere near one: squares as wide as the reach say which.
    square, crossed = (np.floor(each / reach).astype(np.int64) for each in (points, crossings.middles))
    steps = np.array([-1, 0, 1])
    around = _keys(crossed[:, :1, None] + steps[:, None], crossed[:, 1:, None] + steps)
    candidates = np.flatnonzero(np.isin(_keys(square[:, 0], square[:, 1]), np.unique(around)))
    tree = shapely.STRtree(shapely.points(crossings.middles))
    at, crossing = tree.query(shapely.points(points[candidates]), predicate="dwithin", distance=reach)
    at = candidates[at]
    off = points[at] - crossings.middles[crossing]
    walk = crossings.walks[crossing]
    aside = np.abs(off[:, 0] * walk[:, 1] - off[:, 1] * walk[:, 0])
    ahead = np.abs(np.sum(off * walk, axis=1))
    near = (aside < crossings.walk_m[crossing] / 2.0 + 0.3) & (ahead < crossings.road_m[crossing] / 2.0 + 3.0)
    found[at[near]] = True
    return found


def _keys(column: Ints, row: Ints) -> Ints:
    """Return one number for each square."""
    return np.asarray(column * 1_000_003 + row)


def _edging(border: Borders, *, high_m: float, wide_m: float) -> list[Patch]:
    """Return stones along a border: upright towards the area, level for half their width, then down."""
    border = _unfolded(_unfolded(border, wide_m), -_INTO_M)
    owners = np.zeros(len(border.begins), np.int64)
    length = np.hypot(*(border.ends - border.begins).T)
    inner = [lifted(point - _INTO_M * out, 0.0) for point, out in border.both]
    edge = [lifted(point - _INTO_M * out, high_m) for point, out in border.both]
    crest = [lifted(point + 0.5 * wide_m * out, high_m) for point, out in border.both]
    foot = [lifted(point + wide_m * out, 0.0) for point, out in border.both]
    faces = [
        (quads(inner[1], inner[0], edge[0], edge[1]), high_m),
        (quads(edge[1], edge[0], crest[0], crest[1]), _INTO_M + 0.5 * wide_m),
        (quads(crest[1], crest[0], foot[0], foot[1]), 0.5 * wide_m),
    ]
    return [
        Patch.of(
            face,
            rectangle_uvs(0.0, 0.0, length, tall, len(owners)),
            colours=_GRANITE,
            materials=int(Material.STONE),
            owners=owners,
        )
        for face, tall in faces
    ]


def _bank(border: Borders, colour: Floats) -> Patch:
    """Return a strip of bare ground along a border, on both its sides."""
    border = _unfolded(_unfolded(border, 0.5), -0.25)
    near = [lifted(point - 0.25 * out, 0.014) for point, out in border.both]
    far = [lifted(point + 0.5 * out, 0.014) for point, out in border.both]
    corners = quads(near[1], near[0], far[0], far[1])
    return Patch.of(
        corners,
        plan_uvs(corners),
        colours=colour,
        materials=int(Material.EARTH),
        owners=np.zeros(len(corners), np.int64),
    )


def unfolded(border: Borders, off_m: float) -> Bools:
    """Return which stretches still run the same way when moved out, shape (n,)."""
    step = border.ends - border.begins
    moved = step + off_m * (border.end_out - border.begin_out)
    return np.asarray(np.sum(step * moved, axis=1) > 0.0)


def _unfolded(border: Borders, off_m: float) -> Borders:
    return border.where(unfolded(border, off_m))
