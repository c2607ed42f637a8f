"""Where one kind of ground ends at another without a kerb: thin strips that follow the border exactly.

The map of the ground has cells; what is nearest wins, and so borders wave by a decimetre. Strips of both kinds, laid
along the true border, hide that.
"""

from collections.abc import Sequence

import numpy as np

from reasoned_explorer.rendering.crossings import Crossings
from reasoned_explorer.rendering.ground_map import ground_colours, ground_materials
from reasoned_explorer.rendering.kerbs import (
    KERBED,
    Borders,
    Floats,
    Ints,
    around,
    at_crossings,
    mitre,
    unfolded,
)
from reasoned_explorer.rendering.patches import Patch, lifted, plan_uvs, quads
from reasoned_explorer.rendering.wall_spots import runs
from reasoned_explorer.world.raster import GroundRaster
from reasoned_explorer.world.taxonomy import Ground
from reasoned_explorer.world.world import Region, Way, World

#: Half the width of a pair of strips: the map's border is nowhere farther off, metres.
_HALF_M = 0.22
#: How far from the border it is looked which ground lies there, and how often along it, metres.
_SIDE_M, _STEP_M = 0.45, 0.4
#: How many steps a strip has at most.
_LONGEST = 25
#: Height of the lowest strips, and how much higher those of the next kind lie: no two kinds in one plane, metres.
_LOWEST_M, _LAYER_M = 0.002, 0.0004
#: What has no edge of its own: water has shores, buildings walls, beyond the world there is nothing.
_EDGELESS = (Ground.UNKNOWN, Ground.WATER, Ground.BUILDING)


def edges(world: World, ground: GroundRaster, crossings: Crossings) -> list[Patch]:
    """Return strips along the borders of ways and regions where nothing else hides how rough the map is.

    Args:
        world: The world.
        ground: Its ground as it is drawn (`reasoned_explorer.rendering.ground_map.ground_map_of`).
        crossings: Of the world.
    """
    border, kinds, halves = _borders_of(
        [way for way in world.ways if way.level == 0 and way.ground not in _EDGELESS],
        [region for region in world.regions if region.ground not in _EDGELESS and len(region.outer) >= 3],
    )
    if not len(kinds):
        return []
    border, kinds, beyond = _seen_stretches(border, kinds, halves, ground, crossings)
    return [_strips(border, kinds, -_HALF_M), _strips(border, beyond, _HALF_M)]


def _borders_of(ways: Sequence[Way], regions: Sequence[Region]) -> tuple[Borders, Ints, Floats]:
    """Return both borders of ways and those of regions, what lies on their left, and half the width of that."""
    rings = [(ring, hole, at) for at, one in enumerate(regions) for ring, hole in _rings_of(one)]
    lines = [way.line for way in ways]
    chains = [*lines, *(line[::-1] for line in lines), *(_closed(ring, hole=hole) for ring, hole, _ in rings)]
    if not chains:
        nothing = np.empty((0, 2))
        return Borders(nothing, nothing, nothing, nothing), np.empty(0, np.int64), np.empty(0)
    wide = [way.width_m / 2.0 for way in ways]
    half = np.array([*wide, *wide, *([0.0] * len(rings))])
    kind = np.array(
        [*[int(way.ground) for way in ways] * 2, *(int(regions[at].ground) for _, _, at in rings)], np.int64
    )
    chain = np.repeat(np.arange(len(chains)), [len(line) for line in chains])
    points = np.concatenate(chains)
    new = np.append(True, (chain[1:] != chain[:-1]) | (np.hypot(*np.diff(points, axis=0).T) > 1e-3))
    points, chain = points[new], chain[new]
    same = chain[1:] == chain[:-1]
    begins, ends, whose = points[:-1][same], points[1:][same], chain[:-1][same]
    step = ends - begins
    normal = np.column_stack([step[:, 1], -step[:, 0]]) / np.hypot(*step.T)[:, None]
    before, after = around(whose)
    place = np.arange(len(whose))
    is_open = whose < 2 * len(lines)
    # A way's ends have no neighbours.
    before, after = (
        np.where(is_open & (before > place), place, before),
        np.where(is_open & (after < place), place, after),
    )
    begin_out, end_out = mitre(normal[before], normal), mitre(normal, normal[after])
    off = half[whose][:, None]
    moved = step + off * (end_out - begin_out)
    kept = np.sum(step * moved, axis=1) > 0.0
    border = Borders(begins + off * begin_out, ends + off * end_out, begin_out, end_out).where(kept)
    reach = np.where(is_open, half[whose], np.inf)
    return border, kind[whose][kept], reach[kept]


def _rings_of(region: Region) -> list[tuple[Floats, bool]]:
    return [(region.outer, False), *((ring, True) for ring in region.holes if len(ring) >= 3)]


def _closed(ring: Floats, *, hole: bool) -> Floats:
    """Return a ring with its first point repeated, the area on its left."""
    x, y = ring.T
    area = float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))
    ring = ring[::-1] if (area < 0.0) != hole else ring
    return np.concatenate([ring, ring[:1]])


def _seen_stretches(
    border: Borders, kinds: Ints, halves: Floats, ground: GroundRaster, crossings: Crossings
) -> tuple[Borders, Ints, Ints]:
    """Return the stretches on whose left is what should be there and on whose right is something else, and both."""
    length = np.hypot(*(border.ends - border.begins).T)
    count = np.maximum(np.ceil(length / _STEP_M), 1.0).astype(np.int64)
    row, place = runs(count)
    share = ((place + 0.5) / count[row])[:, None]
    point = border.begins[row] + share * (border.ends - border.begins)[row]
    out = border.begin_out[row] + share * (border.end_out - border.begin_out)[row]
    within = point - np.minimum(_SIDE_M, 0.6 * halves)[row][:, None] * out
    beyond_point = point + _SIDE_M * out
    inner = ground.at_many(within[:, 0], within[:, 1])
    beyond = ground.at_many(beyond_point[:, 0], beyond_point[:, 1]).astype(np.int64)
    kept = (inner == kinds[row]) & (beyond != kinds[row]) & ~np.isin(beyond, _EDGELESS)
    # Kerbs hide what lies at carriageways, but for crossings, where they are sunk.
    kerbed = (kinds[row] == Ground.ROAD) & np.isin(beyond, KERBED)
    kerbed |= (beyond == Ground.ROAD) & np.isin(kinds[row], KERBED)
    hidden = np.flatnonzero(kept & kerbed)
    kept[hidden[~at_crossings(point[hidden], crossings)]] = False
    goes_on = kept[1:] & kept[:-1] & (row[1:] == row[:-1]) & (beyond[1:] == beyond[:-1])
    goes_on &= place[1:] % _LONGEST != 0
    first, last = kept & ~np.append(False, goes_on), kept & ~np.append(goes_on, False)
    begin, end = place[first] / count[row[first]], (place[last] + 1.0) / count[row[last]]
    whole = row[first]
    return _parts(border, whole, begin[:, None], end[:, None]), kinds[whole], beyond[first]


def _parts(border: Borders, row: Ints, begin: Floats, end: Floats) -> Borders:
    """Return parts of stretches, between two shares of their lengths."""
    step, turn = (border.ends - border.begins)[row], (border.end_out - border.begin_out)[row]
    return Borders(
        border.begins[row] + begin * step,
        border.begins[row] + end * step,
        border.begin_out[row] + begin * turn,
        border.begin_out[row] + end * turn,
    )


def _strips(border: Borders, kinds: Ints, off_m: float) -> Patch:
    """Return strips of the kinds of ground from a border to its left (below zero) or right."""
    kept = unfolded(border, off_m)
    border, kinds = border.where(kept), kinds[kept]
    high: Floats = _LOWEST_M + _LAYER_M * kinds.astype(np.float64)
    near, far = min(0.0, off_m), max(0.0, off_m)
    inner = [lifted(point + near * out, high) for point, out in border.both]
    outer = [lifted(point + far * out, high) for point, out in border.both]
    corners = quads(inner[1], inner[0], outer[0], outer[1])
    colours = ground_colours().astype(np.float64)
    owners = np.zeros(len(corners), np.int64)
    return Patch.of(
        corners, plan_uvs(corners), colours=colours[kinds], materials=ground_materials()[kinds], owners=owners
    )
