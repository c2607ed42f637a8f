"""Roofs of many buildings: flat with a parapet, gabled, or sloping up all around (mansards, hips, spires)."""

from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from reasoned_explorer.rendering.building_styles import Family, Styles
from reasoned_explorer.rendering.footprints import Bools, Floats, Footprints, Ints
from reasoned_explorer.rendering.material import Material
from reasoned_explorer.rendering.patches import Patch, lifted, plan_uvs, quads, rectangle_uvs

#: How high parapets are and how thick, metres.
PARAPET_M, _PARAPET_WIDTH_M = 0.55, 0.25
#: How far gabled roofs reach beyond their walls, and how thick they are, metres.
_EAVES_M, _VERGE_M, _THICK_M = 0.4, 0.25, 0.16
#: Of a church's height, how much its nave has where it has a tower. A map's height is that of the highest point, and
#: a nave as high as its spire looks like no church. Lines of sight take the whole footprint to be as high as the map
#: says: what they call hidden behind the upper part of a church may show above the nave, which matters to flyers alone.
_NAVE = 0.56


class RoofKind(IntEnum):
    """Kinds of roofs."""

    FLAT = 0
    GABLE = 1
    MANSARD = 2


@dataclass(frozen=True, slots=True, eq=False)
class Roofs:
    """The shape of each building's roof.

    Attributes:
        kinds: Values of `RoofKind`, shape (count,).
        eaves_m: Height of the top of the walls.
        ridge_m: Height of the top of the roof.
        depths: How far in from the walls a mansard's slope ends, metres.
        parapet: Whether a flat roof lies behind a parapet.
        tower: Whether a tower with a spire reaches the building's full height.
        first: Of a gabled building, the corner at which one of its two eaves begins, shape (count,); else 0.
    """

    kinds: Ints
    eaves_m: Floats
    ridge_m: Floats
    depths: Floats
    parapet: Bools
    tower: Bools
    first: Ints


def roofs_of(prints: Footprints, styles: Styles) -> Roofs:
    """Choose the roof of each building by what its footprint allows."""
    family, tall = styles.family, styles.top_m - styles.base_m
    church = family == Family.CHURCH
    tower = church & (prints.areas > 90.0) & (tall > 9.0) & (styles.base_m < 0.5) & (prints.sizes <= 40)
    ridge = np.where(tower, styles.base_m + _NAVE * tall, styles.top_m)
    first, span = _gable_spans(prints)
    gable = styles.pitched & prints.four_square & (span < 17.0) & ((styles.draw(21) < 0.8) | church)
    gable &= family != Family.TOWER
    steep = np.select([family == Family.HOUSE, church], [0.55 + 0.3 * styles.draw(22), 1.15], 0.75)
    gable_rise = np.minimum(0.5 * span * steep, 0.45 * (ridge - styles.base_m))
    # A mansard's slope: steep on town houses, a low hip on houses, a spire on towers.
    slope = np.select([family == Family.HOUSE, family == Family.TOWER, church], [0.6, 1.9, 1.0], 1.25)
    most = np.select([family == Family.HOUSE, church, family == Family.TOWER], [0.42, 0.5, 0.4], 0.3)
    most_rise = most * (ridge - styles.base_m)
    tallest = np.where((family == Family.HOUSE) | church | (family == Family.TOWER), 30.0, 4.6)
    depth = prints.depth_within(np.minimum(most_rise, tallest) / slope)
    mansard = styles.pitched & ~gable & (depth > 0.5)
    rise = np.select([gable, mansard], [gable_rise, np.minimum(depth * slope, most_rise)], 0.0)
    kinds = np.select([gable, mansard], [RoofKind.GABLE, RoofKind.MANSARD], RoofKind.FLAT)
    parapet = (kinds == RoofKind.FLAT) & (tall > 5.0) & prints.blunt & (family != Family.CANOPY)
    parapet &= prints.deepest > 0.35
    return Roofs(kinds, ridge - rise, ridge, np.where(mansard, depth, 0.0), parapet, tower, first)


def _gable_spans(prints: Footprints) -> tuple[Ints, Floats]:
    """Return for each four-cornered building the first corner of its longer side, and how wide it is across."""
    first, span = np.zeros(prints.count, np.int64), np.full(prints.count, np.inf)
    corner = np.flatnonzero(prints.four_square[prints.owners])
    begins = corner[np.searchsorted(prints.owners[corner], np.flatnonzero(prints.four_square))]
    second = prints.after[begins]
    one = prints.lengths[begins] + prints.lengths[prints.after[second]]
    other = prints.lengths[second] + prints.lengths[prints.before[begins]]
    owner = prints.owners[begins]
    first[owner] = np.where(one >= other, begins, second)
    span[owner] = np.minimum(one, other) / 2.0
    return first, span


def flat_roofs(prints: Footprints, styles: Styles, roofs: Roofs, *, parapets: bool) -> list[Patch]:
    """Return flat roofs, and the tops of mansards; behind their parapets or level with the top."""
    sunk = roofs.parapet & parapets
    high = roofs.ridge_m - np.where(sunk, PARAPET_M, 0.0)
    tiled = roofs.kinds == RoofKind.MANSARD
    inset = prints.inset(roofs.depths)
    seen = roofs.kinds[prints.triangle_owners] != RoofKind.GABLE
    triangles, owners = prints.triangles[seen], prints.triangle_owners[seen]
    corners = np.concatenate(
        [inset[triangles], np.broadcast_to(high[owners][:, None, None], (len(owners), 3, 1))], axis=2
    )
    metal = np.where(tiled, Material.ROOF_TILES, Material.ROOF_FLAT).astype(np.uint8)
    top = Patch.of(
        corners, plan_uvs(corners), colours=styles.roof_colour[owners], materials=metal[owners], owners=owners
    )
    # What a roof folded over itself would show its underside.
    up = prints.triangle_areas(inset)[seen] > 0.0
    return [top.where(up), *(_parapets(prints, styles, roofs) if parapets else [])]


def _parapets(prints: Footprints, styles: Styles, roofs: Roofs) -> list[Patch]:
    edges = np.flatnonzero(roofs.parapet[prints.owners])
    owner, after = prints.owners[edges], prints.after[edges]
    inner = prints.inset(np.where(roofs.parapet, np.minimum(_PARAPET_WIDTH_M, 0.4 * prints.deepest), 0.0))
    high, low = roofs.ridge_m[owner], roofs.ridge_m[owner] - PARAPET_M
    length = prints.lengths[edges]
    top = quads(
        lifted(prints.corners[edges], high),
        lifted(prints.corners[after], high),
        lifted(inner[after], high),
        lifted(inner[edges], high),
    )
    back = quads(
        lifted(inner[after], low), lifted(inner[edges], low), lifted(inner[edges], high), lifted(inner[after], high)
    )
    return [
        Patch.of(
            face,
            rectangle_uvs(0.0, 0.0, length, tall, len(edges)),
            colours=colours,
            materials=int(Material.PLASTER),
            owners=owner,
        )
        for face, tall, colours in (
            (top, _PARAPET_WIDTH_M, styles.trim_colour[owner] * 0.9),
            (back, PARAPET_M, styles.plain_colour[owner] * 0.9),
        )
    ]


def slopes(prints: Footprints, styles: Styles, roofs: Roofs) -> Patch:
    """Return the slopes of mansards, hips and spires."""
    edges = np.flatnonzero((roofs.kinds == RoofKind.MANSARD)[prints.owners])
    owner, after = prints.owners[edges], prints.after[edges]
    inner = prints.inset(roofs.depths)
    low, high = roofs.eaves_m[owner], roofs.ridge_m[owner]
    corners = quads(
        lifted(prints.corners[edges], low),
        lifted(prints.corners[after], low),
        lifted(inner[after], high),
        lifted(inner[edges], high),
    )
    up = np.hypot(high - low, roofs.depths[owner])
    along = prints.along[edges]
    left = np.sum((inner[edges] - prints.corners[edges]) * along, axis=1)
    right = np.sum((inner[after] - prints.corners[edges]) * along, axis=1)
    uvs = rectangle_uvs(0.0, 0.0, prints.lengths[edges], up, len(edges))
    uvs[:, 2, 0], uvs[:, 3, 0] = right, left
    return Patch.of(corners, uvs, colours=styles.roof_colour[owner], materials=int(Material.ROOF_TILES), owners=owner)


def gables(prints: Footprints, styles: Styles, roofs: Roofs, *, thick: bool) -> list[Patch]:
    """Return gabled roofs with eaves, and the walls below them; ``thick``: with undersides and edges."""
    owner = np.flatnonzero(roofs.kinds == RoofKind.GABLE)
    if not len(owner):
        return []
    a = roofs.first[owner]
    b = prints.after[a]
    c = prints.after[b]
    d = prints.after[c]
    low, high = roofs.eaves_m[owner], roofs.ridge_m[owner]
    points = [prints.corners[place] for place in (a, b, c, d)]
    ends = [(points[1] + points[2]) / 2.0, (points[3] + points[0]) / 2.0]
    parts = [
        Patch.of(
            quads(lifted(one, low), lifted(other, low), lifted(ridge, high)),
            rectangle_uvs(0.0, low, np.hypot(*(other - one).T), high, len(owner))[:, :3],
            colours=styles.plain_colour[owner],
            materials=styles.plain[owner],
            owners=owner,
        )
        for one, other, ridge in ((points[1], points[2], ends[0]), (points[3], points[0], ends[1]))
    ]
    for slope in (_Slope(points[0], points[1], ends[0], ends[1]), _Slope(points[2], points[3], ends[1], ends[0])):
        parts += _gable_slope(slope, low, high, styles, owner, thick=thick)
    return parts


@dataclass(frozen=True, slots=True, eq=False)
class _Slope:
    """One side of gabled roofs: the corners below its eaves, and the ends of the ridge, the one near the first last."""

    first: Floats
    second: Floats
    far: Floats
    near: Floats


def _gable_slope(slope: _Slope, low: Floats, high: Floats, styles: Styles, owner: Ints, *, thick: bool) -> list[Patch]:
    """Return one side of gabled roofs, with their eaves and verges."""
    along = _unit(slope.second - slope.first)
    out = np.column_stack([along[:, 1], -along[:, 0]])
    reach = np.maximum(np.abs(np.sum((slope.near - slope.first) * out, axis=1)), 0.3)
    eaves = low - (high - low) / reach * _EAVES_M
    begin = slope.first + _EAVES_M * out - _VERGE_M * along
    end = slope.second + _EAVES_M * out + _VERGE_M * along
    ridge_begin, ridge_end = slope.near - _VERGE_M * along, slope.far + _VERGE_M * along
    length, up = np.hypot(*(end - begin).T), np.hypot(reach + _EAVES_M, high - eaves)

    def sheet(lift: float) -> list[Floats]:
        return [
            lifted(begin, eaves + lift),
            lifted(end, eaves + lift),
            lifted(ridge_end, high + lift),
            lifted(ridge_begin, high + lift),
        ]

    top, under = sheet(0.0), sheet(-_THICK_M)
    uvs = rectangle_uvs(0.0, 0.0, length, up, len(owner))
    tiles = Patch.of(
        quads(*top), uvs, colours=styles.roof_colour[owner], materials=int(Material.ROOF_TILES), owners=owner
    )
    if not thick:
        return [tiles]
    edges = [
        Patch.of(
            quads(under[i], under[j], top[j], top[i]),
            rectangle_uvs(0.0, 0.0, up, _THICK_M, len(owner)),
            colours=styles.trim_colour[owner],
            materials=int(Material.WOOD),
            owners=owner,
        )
        for i, j in ((0, 1), (1, 2), (3, 0))
    ]
    soffit = Patch.of(
        quads(*under[::-1]), uvs, colours=styles.trim_colour[owner] * 0.9, materials=int(Material.PLAIN), owners=owner
    )
    return [tiles, *edges, soffit]


def _unit(steps: Floats) -> Floats:
    unit: Floats = steps / np.maximum(np.hypot(*steps.T), 1e-9)[:, None]
    return unit
