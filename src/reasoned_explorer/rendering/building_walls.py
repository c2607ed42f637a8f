"""Walls of many buildings: storeys with whole windows, ground floors, undersides, cornices."""

import numpy as np

from reasoned_explorer.rendering.building_roofs import RoofKind, Roofs
from reasoned_explorer.rendering.building_shops import is_shop_wall
from reasoned_explorer.rendering.building_styles import Family, Styles, mixed_draw
from reasoned_explorer.rendering.footprints import Floats, Footprints, Ints
from reasoned_explorer.rendering.material import Material
from reasoned_explorer.rendering.patches import Patch, lifted, plan_uvs, quads, rectangle_uvs

#: What the facade textures show of a bay and of a storey, metres.
_BAY_M = 3.0
_GLASS_BAY_M = 1.5
#: Shorter walls, and lower bands, have no windows, metres.
_LEAST_WALL_M, _LEAST_BAND_M = 1.9, 1.9


def walls(prints: Footprints, styles: Styles, roofs: Roofs, *, bands: bool) -> list[Patch]:
    """Return all walls: with ``bands`` the ground floor is apart, without it windows run from the bottom up.

    Where shops are (`reasoned_explorer.rendering.building_shops`), walls with ``bands`` begin above them.
    """
    every = np.arange(len(prints.corners))
    owner = prints.owners
    low, high = styles.base_m[owner], roofs.eaves_m[owner]
    if not bands:
        return _storeys(prints, styles, every, low, high)
    ground = np.minimum(styles.ground_m[owner], high)
    shop = is_shop_wall(prints, styles)
    base = (ground > low) & ~shop
    parts = _storeys(prints, styles, every, ground, high)
    parts += _storeys(prints, styles, every[base], low[base], ground[base], shade=0.86)
    return parts


def _storeys(
    prints: Footprints, styles: Styles, edges: Ints, low: Floats, high: Floats, *, shade: float = 1.0
) -> list[Patch]:
    """Return walls between two heights, with whole bays and storeys where there is room for windows."""
    owner, length = prints.owners[edges], prints.lengths[edges]
    tall = high - low
    storeys = np.maximum(np.round(tall / styles.storey_m[owner]), 1.0)
    glass = styles.windows[owner] == Material.FACADE_GLASS
    bay = np.where(glass, _GLASS_BAY_M, _BAY_M)
    bays = np.maximum(np.round(length / bay), 1.0) * np.where(glass, 0.5, 1.0)
    blind = np.isin(styles.family[owner], [Family.CHURCH, Family.CANOPY, Family.TOWER]) | (
        (styles.family[owner] == Family.HUT) & (length < 4.0)
    )
    has_windows = (length >= np.where(glass, 0.5, _LEAST_WALL_M)) & (tall >= _LEAST_BAND_M) & ~blind
    parity = (mixed_draw(styles.keys[owner], 11) * 2.0).astype(np.int64) + prints.places[edges]
    left: Floats = _BAY_M * (parity % 2).astype(np.float64)
    floor = _BAY_M * np.round(low / 3.1)
    window_uvs = rectangle_uvs(left, floor, left + _BAY_M * bays, floor + _BAY_M * storeys, len(edges))
    plain_uvs = rectangle_uvs(0.0, low, length, high, len(edges))
    faces = _upright(prints, edges, low, high)
    windowed = Patch.of(
        faces, window_uvs, colours=styles.windows_colour[owner] * shade, materials=styles.windows[owner], owners=owner
    )
    solid = Patch.of(
        faces, plain_uvs, colours=styles.plain_colour[owner] * shade, materials=styles.plain[owner], owners=owner
    )
    real = tall > 0.02
    return [windowed.where(has_windows & real), solid.where(~has_windows & real)]


def _upright(prints: Footprints, edges: Ints, low: Floats, high: Floats) -> Floats:
    begin, end = prints.corners[edges], prints.corners[prints.after[edges]]
    return quads(lifted(begin, low), lifted(end, low), lifted(end, high), lifted(begin, high))


def undersides(prints: Footprints, styles: Styles) -> Patch:
    """Return the undersides of what does not stand on the ground."""
    seen = styles.base_m[prints.triangle_owners] > 0.0
    triangles, owners = prints.triangles[seen][:, ::-1], prints.triangle_owners[seen]
    flat = prints.corners[triangles]
    corners = np.concatenate(
        [flat, np.broadcast_to(styles.base_m[owners][:, None, None], (*flat.shape[:2], 1))], axis=2
    )
    return Patch.of(
        corners,
        plan_uvs(corners),
        colours=styles.plain_colour[owners] * 0.9,
        materials=styles.plain[owners],
        owners=owners,
    )


def cornices(prints: Footprints, styles: Styles, roofs: Roofs) -> list[Patch]:
    """Return the cornices: a ledge around the top of the walls of buildings that are not low."""
    tall = roofs.eaves_m - styles.base_m
    ledge = np.select([roofs.kinds == RoofKind.MANSARD, styles.windows == Material.FACADE_GLASS], [0.32, 0.0], 0.16) * (
        tall > 5.5
    )
    ledge = ledge * prints.blunt * (roofs.kinds != RoofKind.GABLE) * (0.9 + 0.2 * styles.draw(13))
    edges = np.flatnonzero((ledge > 0.0)[prints.owners])
    owner = prints.owners[edges]
    out = prints.inset(-ledge)
    inner, outer = prints.corners, out
    begin, end = edges, prints.after[edges]
    high = roofs.eaves_m[owner] + 0.01 * (roofs.kinds[owner] == RoofKind.MANSARD)
    low = high - 0.32
    length = prints.lengths[edges]
    faces = [
        quads(lifted(outer[begin], low), lifted(outer[end], low), lifted(outer[end], high), lifted(outer[begin], high)),
        quads(lifted(inner[begin], low), lifted(inner[end], low), lifted(outer[end], low), lifted(outer[begin], low)),
        quads(
            lifted(outer[begin], high), lifted(outer[end], high), lifted(inner[end], high), lifted(inner[begin], high)
        ),
    ]
    uvs = rectangle_uvs(0.0, 0.0, length, 0.3, len(edges))
    return [
        Patch.of(face, uvs, colours=styles.trim_colour[owner], materials=int(Material.PLASTER), owners=owner)
        for face in faces
    ]
