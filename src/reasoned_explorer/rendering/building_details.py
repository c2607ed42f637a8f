"""What stands out of buildings: dormers, balconies, chimneys and lift huts; and the posts below canopies."""

import numpy as np

from reasoned_explorer.rendering.building_roofs import PARAPET_M, RoofKind, Roofs
from reasoned_explorer.rendering.building_styles import Family, Styles, mixed_draw
from reasoned_explorer.rendering.footprints import Floats, Footprints, Ints
from reasoned_explorer.rendering.fronts import clear_of
from reasoned_explorer.rendering.material import Material
from reasoned_explorer.rendering.patches import Patch, boxes, lifted, quads, rectangle_uvs
from reasoned_explorer.rendering.wall_spots import Spots, runs

_POST_SPACING_M = 6.0
_DORMER_M = (1.5, 1.5)
#: How far a dormer's front stands back from the wall below it, metres.
_DORMER_BACK_M = 0.3
_BALCONY_M = (2.5, 1.1)
#: Fronts of places reach no higher than this, metres; a church's has no balconies above it.
_HIGHEST_FRONT_M = 5.3
_CHIMNEY, _POST = np.array((0.62, 0.38, 0.31)), np.array((0.45, 0.46, 0.48))


def dormers(prints: Footprints, styles: Styles, roofs: Roofs) -> list[Patch]:
    """Return windows that stand out of the slopes of mansards."""
    rise = roofs.ridge_m - roofs.eaves_m
    town = np.isin(styles.family, [Family.FLATS, Family.OFFICE, Family.SHOP])
    fits = (roofs.kinds == RoofKind.MANSARD) & (rise > 2.4) & town
    edges = np.flatnonzero(fits[prints.owners] & (prints.lengths > 5.0))
    spots = Spots.spaced(prints, edges, every_m=3.4, margin_m=1.0).moved(out_m=-_DORMER_BACK_M)
    owner = spots.owners
    slope = rise[owner] / np.maximum(roofs.depths[owner], 0.1)
    low = roofs.eaves_m[owner] + _DORMER_BACK_M * slope
    high = np.minimum(low + _DORMER_M[1], roofs.ridge_m[owner] - 0.15)
    deep = (high - low) / slope + 0.05
    box = boxes(
        spots.moved(out_m=-deep / 2.0).places,
        spots.along,
        length_m=_DORMER_M[0],
        width_m=deep,
        low_m=low,
        high_m=high,
        colours=styles.plain_colour[owner],
        materials=styles.plain[owner],
        owners=owner,
    )
    front = spots.moved(out_m=0.02)
    left, right = (front.moved(aside_m=side * _DORMER_M[0] / 2.0).places for side in (-1.0, 1.0))
    # The part of the facade's texture that shows one window.
    window = Patch.of(
        quads(lifted(left, low), lifted(right, low), lifted(right, high), lifted(left, high)),
        rectangle_uvs(0.62, 0.66, 2.38, 2.74, len(owner)),
        colours=styles.trim_colour[owner],
        materials=int(Material.FACADE),
        owners=owner,
    )
    return [box, window]


def balconies(prints: Footprints, styles: Styles, roofs: Roofs, fronts: Floats) -> list[Patch]:
    """Return balconies on some walls of blocks of flats: before every third bay, on every storey but the lowest.

    There are none right above fronts of places, shape (n, 3) as `reasoned_explorer.rendering.fronts.clear_of` has it.
    """
    wanted = (styles.family == Family.FLATS) & (styles.draw(31) < 0.45) & (roofs.eaves_m > 8.0) & (styles.base_m < 0.5)
    chosen = mixed_draw(styles.keys[prints.owners] + prints.places.astype(np.uint64), 32) < 0.6
    edges = np.flatnonzero(wanted[prints.owners] & ~prints.in_court & (prints.lengths >= 8.0) & chosen)
    owner = prints.owners[edges]
    low = np.minimum(styles.ground_m, roofs.eaves_m)[owner]
    storeys = np.maximum(np.round((roofs.eaves_m[owner] - low) / styles.storey_m[owner]), 1.0)
    bays = np.maximum(np.round(prints.lengths[edges] / 3.0), 1.0)
    columns = np.maximum(np.floor((bays - 1.0) / 3.0), 1.0)
    row, place = runs((columns * storeys).astype(np.int64))
    column, storey = place % columns[row], place // columns[row]
    distance = (1.5 + 3.0 * column) * (prints.lengths[edges] / bays)[row]
    floor = low[row] + storey * ((roofs.eaves_m[owner] - low) / storeys)[row]
    keep = (floor > 3.0) & (distance + _BALCONY_M[0] / 2.0 < prints.lengths[edges][row])
    spots, floor = Spots.on(prints, edges[row][keep], distance[keep]), floor[keep]
    clear = (floor > _HIGHEST_FRONT_M) | clear_of(spots.places, fronts, _BALCONY_M[0] / 2.0)
    spots, floor = spots.where(clear), floor[clear]
    return _balcony_faces(spots, floor, styles.trim_colour[spots.owners] * 0.88)


def _balcony_faces(spots: Spots, floor: Floats, colours: Floats) -> list[Patch]:
    """Return the parapet, a sheet with two sides, the floor and the underside of balconies."""
    wide, deep = _BALCONY_M
    left, right = (spots.moved(aside_m=side * wide / 2.0).places for side in (-1.0, 1.0))
    far_left, far_right = left + deep * spots.out, right + deep * spots.out
    low, high = floor - 0.14, floor + 1.0

    def upright(one: Floats, other: Floats) -> Floats:
        return quads(lifted(one, low), lifted(other, low), lifted(other, high), lifted(one, high))

    faces = [
        *(
            (upright(*ends), length, 1.14)
            for one, other, length in ((far_left, far_right, wide), (left, far_left, deep), (far_right, right, deep))
            for ends in ((one, other), (other, one))
        ),
        (quads(*(lifted(point, floor) for point in (far_left, far_right, right, left))), wide, deep),
        (quads(*(lifted(point, low) for point in (left, right, far_right, far_left))), wide, deep),
    ]
    return [
        Patch.of(
            face,
            rectangle_uvs(0.0, 0.0, length, tall, len(floor)),
            colours=colours,
            materials=int(Material.CONCRETE),
            owners=spots.owners,
        )
        for face, length, tall in faces
    ]


def roof_things(prints: Footprints, styles: Styles, roofs: Roofs) -> list[Patch]:
    """Return chimneys on roofs of tiles, and huts of lifts and machines on flat ones."""
    largest = _largest_triangles(prints)
    area = prints.triangle_areas(prints.corners)[largest]
    middle = prints.corners[prints.triangles[largest]].mean(axis=1)
    owner = prints.triangle_owners[largest]
    along = prints.along[prints.triangles[largest][:, 0]]
    draw, ridge = styles.draw(24)[owner], roofs.ridge_m[owner]
    flat = (roofs.kinds[owner] == RoofKind.FLAT) & (styles.top_m[owner] > 9.0) & (area > 25.0) & (draw < 0.75)
    flat &= styles.family[owner] != Family.CANOPY
    tiled = (roofs.kinds[owner] != RoofKind.FLAT) & np.isin(styles.family[owner], [Family.HOUSE, Family.FLATS])
    tiled &= draw < 0.8
    size = np.clip(0.28 * np.sqrt(area), 1.4, 4.5)
    return [
        boxes(
            middle[flat],
            along[flat],
            length_m=(size * 1.4)[flat],
            width_m=size[flat],
            low_m=ridge[flat] - PARAPET_M,
            high_m=ridge[flat] + 0.6 + 1.6 * draw[flat],
            colours=styles.plain_colour[owner][flat] * 0.92,
            materials=int(Material.CONCRETE),
            owners=owner[flat],
        ),
        boxes(
            middle[tiled],
            along[tiled],
            length_m=0.9,
            width_m=0.55,
            low_m=roofs.eaves_m[owner][tiled] - 0.3,
            high_m=ridge[tiled] + 0.8,
            colours=_CHIMNEY,
            materials=int(Material.BRICK),
            owners=owner[tiled],
        ),
    ]


def _largest_triangles(prints: Footprints) -> Ints:
    """Return the largest triangle of each building that has one."""
    order = np.lexsort((prints.triangle_areas(prints.corners), prints.triangle_owners))
    # The last of each building's triangles in that order.
    ends = np.searchsorted(prints.triangle_owners[order], np.unique(prints.triangle_owners), side="right")
    chosen: Ints = order[ends - 1]
    return chosen


def posts(prints: Footprints, styles: Styles) -> Patch:
    """Return the posts on which canopies stand, along their edges and a little inside."""
    raised = (styles.family == Family.CANOPY) & (styles.base_m > 0.5)
    edges = np.flatnonzero(raised[prints.owners] & ~prints.in_court & (prints.lengths > 0.8))
    count = np.maximum(np.ceil(prints.lengths[edges] / _POST_SPACING_M), 1.0).astype(np.int64)
    row, place = runs(count)
    edge = edges[row]
    inner = prints.inset(np.minimum(0.35, 0.4 * prints.deepest))
    step = (inner[prints.after[edge]] - inner[edge]) / count[row][:, None]
    return boxes(
        inner[edge] + step * place[:, None],
        prints.along[edge],
        length_m=0.18,
        width_m=0.18,
        low_m=0.0,
        high_m=styles.base_m[prints.owners[edge]],
        colours=_POST,
        materials=int(Material.METAL),
        owners=prints.owners[edge],
    )
