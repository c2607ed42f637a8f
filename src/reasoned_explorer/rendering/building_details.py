"""What is put on buildings: doors, dormers, balconies, posts below canopies, church towers and church windows."""

from collections.abc import Sequence

import numpy as np
import shapely

from reasoned_explorer.rendering.building_roofs import RoofKind, Roofs
from reasoned_explorer.rendering.building_styles import Family, Styles, mixed_draw
from reasoned_explorer.rendering.footprints import Floats, Footprints, Ints
from reasoned_explorer.rendering.material import Material
from reasoned_explorer.rendering.patches import Patch, boxes, lifted, quads, rectangle_uvs
from reasoned_explorer.world.world import Building

_FAR_M = 1.5
_POST_SPACING_M = 6.0


def doors(buildings: Sequence[Building], prints: Footprints, styles: Styles, roofs: Roofs, *, fine: bool) -> list[Patch]:
    """Return a door at every entrance, and one where none is known; ``fine``: with frames and a step."""
    places, edges = _door_places(buildings, prints)
    if not len(edges):
        return []
    owner = prints.owners[edges]
    tall = roofs.eaves_m[owner] - styles.base_m[owner]
    stands = (styles.base_m[owner] < 0.5) & (tall > 2.1) & (styles.family[owner] != Family.CANOPY)
    places, edges, owner, tall = places[stands], edges[stands], owner[stands], tall[stands]
    family = styles.family[owner]
    grand = np.isin(family, [Family.OFFICE, Family.CHURCH, Family.SHOP, Family.HALL])
    wide = np.minimum(np.where(grand, 1.9, 1.15), 0.85 * prints.lengths[edges])
    high = np.minimum(np.select([family == Family.CHURCH, grand], [3.1, 2.5], 2.15), tall - 0.1)
    along, out = prints.along[edges], prints.outwards[edges]
    leaf = styles.door_colour[owner]
    parts = [
        _panel(places, along, out, wide, 0.0, high, 0.07, leaf, int(Material.WOOD), owner),
    ]
    if not fine:
        return parts
    frame = styles.trim_colour[owner]
    for side in (-1.0, 1.0):
        jamb = places + side * along * (wide / 2.0 + 0.08)[:, None] + 0.06 * out
        parts.append(boxes(jamb, along, length_m=0.16, width_m=0.2, low_m=0.0, high_m=high + 0.16, colours=frame,
                           materials=int(Material.PLASTER), owners=owner))  # fmt: skip
    parts.append(boxes(places + 0.06 * out, along, length_m=wide, width_m=0.2, low_m=high, high_m=high + 0.16,
                       colours=frame, materials=int(Material.PLASTER), owners=owner, bottom=True))  # fmt: skip
    shelter = ~grand | (family == Family.OFFICE)
    parts.append(boxes((places + 0.45 * out)[shelter], along[shelter], length_m=(wide + 0.7)[shelter], width_m=0.9,
                       low_m=(high + 0.3)[shelter], high_m=(high + 0.42)[shelter], colours=(frame * 0.8)[shelter],
                       materials=int(Material.METAL), owners=owner[shelter], bottom=True).where(
                           np.tile((high + 0.5 < tall)[shelter], 6)))  # fmt: skip
    parts.append(boxes(places + 0.2 * out, along, length_m=wide + 0.5, width_m=0.5, low_m=0.0, high_m=0.12,
                       colours=np.array((0.66, 0.65, 0.62)), materials=int(Material.STONE), owners=owner))  # fmt: skip
    # A pane in the leaf, and a handle.
    glass = np.where(grand, 0.78, 0.45)
    parts.append(_panel(places, along, out, wide * np.where(grand, 0.8, 0.5), high * (0.92 - glass), high * 0.92, 0.09,
                        np.array((0.24, 0.30, 0.36)), int(Material.GLASS), owner))  # fmt: skip
    handle = places + along * (0.36 * wide)[:, None] + 0.1 * out
    parts.append(boxes(handle, along, length_m=0.05, width_m=0.06, low_m=0.95, high_m=1.15,
                       colours=np.array((0.75, 0.72, 0.65)), materials=int(Material.METAL), owners=owner))  # fmt: skip
    return parts


def _panel(places: Floats, along: Floats, out: Floats, wide: Floats, low: Floats | float, high: Floats | float, off_m: float,
           colours: Floats, material: int, owner: Ints) -> Patch:  # fmt: skip
    """Return upright rectangles before walls."""
    left = places - along * (wide / 2.0)[:, None] + off_m * out
    right = places + along * (wide / 2.0)[:, None] + off_m * out
    corners = quads(lifted(left, low), lifted(right, low), lifted(right, high), lifted(left, high))
    tall = np.asarray(high) - np.asarray(low)
    # Upright grain: texture coordinates lie on their side.
    uvs = rectangle_uvs(0.0, 0.0, wide, tall, len(places))[..., ::-1]
    return Patch.of(corners, uvs, colours=colours, materials=material, owners=owner)


def _door_places(buildings: Sequence[Building], prints: Footprints) -> tuple[Floats, Ints]:
    """Return where doors are, shape (n, 2), and the edges they are in."""
    counts = np.array([len(one.entrances) for one in buildings], dtype=np.int64)
    points = np.concatenate([np.empty((0, 2)), *(one.entrances for one in buildings if len(one.entrances))])
    owner = np.repeat(np.arange(len(buildings)), counts)
    edges, places = _nearest_edges(prints, points, owner)
    near = np.hypot(*(places - points).T) < _FAR_M
    # A building with no known entrance gets one in the middle of its longest wall.
    outer = np.where(prints.in_court, -1.0, prints.lengths)
    order = np.lexsort((outer, prints.owners))
    owners = prints.owners[order]
    last = np.append(owners[1:] != owners[:-1], True) if len(owners) else np.empty(0, np.bool_)
    longest = order[last]
    longest = longest[(counts[prints.owners[longest]] == 0) & (prints.lengths[longest] > 2.0)]
    middle = (prints.corners[longest] + prints.corners[prints.after[longest]]) / 2.0
    return np.concatenate([places[near], middle]), np.concatenate([edges[near], longest])


def _nearest_edges(prints: Footprints, points: Floats, owner: Ints) -> tuple[Ints, Floats]:
    """Return for each point the nearest edge of its building, and the point on it, clear of its ends."""
    sizes = prints.sizes[owner]
    starts = (np.cumsum(prints.sizes) - prints.sizes)[owner]
    ends = np.cumsum(sizes)
    row = np.repeat(np.arange(len(points)), sizes)
    edge = np.arange(int(ends[-1]) if len(ends) else 0) - np.repeat(ends - sizes - starts, sizes)
    begin, along, length = prints.corners[edge], prints.along[edge], prints.lengths[edge]
    place = np.sum((points[row] - begin) * along, axis=1)
    clear = np.minimum(0.75, length / 2.0)
    on = begin + np.clip(place, clear, length - clear)[:, None] * along
    gap = np.hypot(*(points[row] - (begin + np.clip(place, 0.0, length)[:, None] * along)).T)
    order = np.lexsort((edge, gap, row))
    first = order[np.unique(row[order], return_index=True)[1]]
    found, places = np.zeros(len(points), np.int64), np.full((len(points), 2), np.inf)
    found[row[first]], places[row[first]] = edge[first], on[first]
    return found, places


def dormers(prints: Footprints, styles: Styles, roofs: Roofs) -> list[Patch]:
    """Return windows that stand out of the slopes of mansards."""
    rise = roofs.ridge_m - roofs.eaves_m
    fits = (roofs.kinds == RoofKind.MANSARD) & (rise > 2.4) & np.isin(styles.family, [Family.FLATS, Family.OFFICE,
                                                                                     Family.SHOP])  # fmt: skip
    edges = np.flatnonzero(fits[prints.owners] & (prints.lengths > 5.0))
    if not len(edges):
        return []
    row, share = _spaced(prints.lengths[edges] - 2.0, 3.4)
    edge = edges[row]
    owner = prints.owners[edge]
    along, out = prints.along[edge], prints.outwards[edge]
    slope = rise[owner] / roofs.depths[owner]
    back, low = 0.3, roofs.eaves_m[owner] + 0.3 * slope
    high = np.minimum(low + 1.5, roofs.ridge_m[owner] - 0.15)
    deep = (high - low) / slope + 0.05
    front = prints.corners[edge] + along * (1.0 + share * (prints.lengths[edge] - 2.0))[:, None] - back * out
    box = boxes(front - out * (deep / 2.0)[:, None], along, length_m=1.5, width_m=deep, low_m=low, high_m=high,
                colours=styles.plain_colour[owner], materials=styles.plain[owner], owners=owner)  # fmt: skip
    left, right = front - 0.75 * along + 0.02 * out, front + 0.75 * along + 0.02 * out
    window = Patch.of(
        quads(lifted(left, low), lifted(right, low), lifted(right, high), lifted(left, high)),
        rectangle_uvs(0.72, 0.78, 2.28, 2.66, len(owner)),
        colours=styles.trim_colour[owner],
        materials=int(Material.FACADE),
        owners=owner,
    )
    return [box, window]


def balconies(prints: Footprints, styles: Styles, roofs: Roofs) -> list[Patch]:
    """Return balconies on some walls of blocks of flats: a slab and a parapet for every storey but the lowest."""
    wanted = (styles.family == Family.FLATS) & (styles.draw(31) < 0.45) & (roofs.eaves_m > 8.0)
    fits = wanted[prints.owners] & ~prints.in_court & (prints.lengths >= 8.0) & (styles.base_m[prints.owners] < 0.5)
    edges = np.flatnonzero(fits & (mixed_draw(styles.keys[prints.owners] + np.arange(len(fits)).astype(np.uint64), 32) < 0.6))
    if not len(edges):
        return []
    owner = prints.owners[edges]
    low = np.minimum(styles.ground_m[owner], roofs.eaves_m[owner])
    storeys = np.maximum(np.round((roofs.eaves_m[owner] - low) / styles.storey_m[owner]), 1.0)
    step = (roofs.eaves_m[owner] - low) / storeys
    bays = np.maximum(np.round(prints.lengths[edges] / 3.0), 1.0)
    columns = np.maximum(np.floor((bays - 1.0) / 3.0), 1.0)
    each = (columns * storeys).astype(np.int64)
    row = np.repeat(np.arange(len(edges)), each)
    place = np.arange(len(row)) - np.repeat(np.cumsum(each) - each, each)
    column, storey = place % columns[row], place // columns[row]
    edge, owner = edges[row], owner[row]
    along, out = prints.along[edge], prints.outwards[edge]
    bay = prints.lengths[edge] / bays[row]
    middle = prints.corners[edge] + along * ((1.5 + 3.0 * column) * bay)[:, None]
    floor = low[row] + storey * step[row]
    keep = (floor > 3.0) & ((1.5 + 3.0 * column) * bay + 1.3 < prints.lengths[edge])
    middle, along, out, floor, owner = middle[keep], along[keep], out[keep], floor[keep], owner[keep]
    slab = boxes(middle + 0.55 * out, along, length_m=2.5, width_m=1.1, low_m=floor - 0.12, high_m=floor + 0.03,
                 colours=np.array((0.8, 0.79, 0.76)), materials=int(Material.CONCRETE), owners=owner, bottom=True)  # fmt: skip
    rail = boxes(middle + 1.07 * out, along, length_m=2.5, width_m=0.06, low_m=floor + 0.03, high_m=floor + 1.0,
                 colours=styles.trim_colour[owner] * 0.85, materials=int(Material.METAL), owners=owner)  # fmt: skip
    sides = [
        boxes(middle + 0.52 * out + side * 1.22 * along, along, length_m=0.06, width_m=1.04, low_m=floor + 0.03,
              high_m=floor + 1.0, colours=styles.trim_colour[owner] * 0.85, materials=int(Material.METAL), owners=owner)
        for side in (-1.0, 1.0)
    ]  # fmt: skip
    return [slab, rail, *sides]


def posts(prints: Footprints, styles: Styles) -> Patch:
    """Return the posts on which canopies stand, along their edges and a little inside."""
    edges = np.flatnonzero(((styles.family == Family.CANOPY) & (styles.base_m > 0.5))[prints.owners] & ~prints.in_court)
    edges = edges[prints.lengths[edges] > 0.8]
    count = np.maximum(np.ceil(prints.lengths[edges] / _POST_SPACING_M), 1.0).astype(np.int64)
    row = np.repeat(np.arange(len(edges)), count)
    place = np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count)
    edge = edges[row]
    owner = prints.owners[edge]
    inner = prints.inset(np.minimum(0.35, 0.4 * prints.deepest))
    step = (inner[prints.after[edge]] - inner[edge]) / count[row][:, None]
    return boxes(inner[edge] + step * place[:, None], prints.along[edge], length_m=0.18, width_m=0.18, low_m=0.0,
                 high_m=styles.base_m[owner], colours=np.array((0.45, 0.46, 0.48)), materials=int(Material.METAL),
                 owners=owner)  # fmt: skip


def church_windows(prints: Footprints, styles: Styles, roofs: Roofs) -> list[Patch]:
    """Return tall windows along the walls of churches, and slits in towers."""
    tall = roofs.eaves_m - styles.base_m
    slim = styles.family == Family.TOWER
    wanted = ((styles.family == Family.CHURCH) | slim) & (tall > 4.0)
    edges = np.flatnonzero(wanted[prints.owners] & (prints.lengths > 2.4))
    row, share = _spaced(prints.lengths[edges] - 1.6, 4.2)
    edge = edges[row]
    owner = prints.owners[edge]
    places = prints.corners[edge] + prints.along[edge] * (0.8 + share * (prints.lengths[edge] - 1.6))[:, None]
    low = styles.base_m[owner] + np.where(slim[owner], 0.55, 0.28) * tall[owner]
    high = styles.base_m[owner] + 0.84 * tall[owner]
    wide = np.where(slim[owner], 0.7, np.minimum(1.3, 0.35 * (high - low) + 0.3))
    frame = styles.trim_colour[owner]
    along, out = prints.along[edge], prints.outwards[edge]
    return [
        _arched(places, along, out, wide + 0.4, low - 0.2, high + 0.25, 0.03, frame, int(Material.STONE), owner),
        _arched(places, along, out, wide, low, high, 0.06, np.array((0.20, 0.24, 0.34)), int(Material.GLASS), owner),
    ]


def _arched(places: Floats, along: Floats, out: Floats, wide: Floats, low: Floats, high: Floats, off_m: float, colours: Floats,
            material: int, owner: Ints) -> Patch:  # fmt: skip
    """Return panels that end in a point."""
    left, right = (places + side * along * (wide / 2.0)[:, None] + off_m * out for side in (-1.0, 1.0))
    spring = high - wide * 0.7
    tip = places + off_m * out
    corners = quads(lifted(left, low), lifted(right, low), lifted(right, spring), lifted(tip, high), lifted(left, spring))
    u, v = np.array([-0.5, 0.5, 0.5, 0.0, -0.5]) * wide[:, None], corners[..., 2]
    return Patch.of(corners, np.stack([u, v], axis=2), colours=colours, materials=material, owners=owner)


def towers(prints: Footprints, styles: Styles, roofs: Roofs) -> list[Patch]:
    """Return church towers: a square shaft at one end of the nave, a clock, a louvred opening, a spire."""
    owner, middle, along, wide = _tower_places(prints, roofs)
    if not len(owner):
        return []
    base, top = styles.base_m[owner], styles.top_m[owner]
    shaft = base + 0.8 * (top - base)
    colour, material = styles.plain_colour[owner], styles.plain[owner]
    parts = [boxes(middle, along, length_m=wide, width_m=wide, low_m=base, high_m=shaft, colours=colour,
                   materials=material, owners=owner),
             boxes(middle, along, length_m=wide + 0.5, width_m=wide + 0.5, low_m=shaft - 0.4, high_m=shaft + 0.1,
                   colours=styles.trim_colour[owner], materials=int(Material.STONE), owners=owner, bottom=True)]  # fmt: skip
    across = np.column_stack([-along[:, 1], along[:, 0]])
    half = (wide / 2.0)[:, None]
    foot = [middle + one * half * along + other * half * across for one, other in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    spire = np.array((0.35, 0.47, 0.42)) * (0.85 + 0.3 * styles.draw(41)[owner])[:, None]
    for at in range(4):
        one, other = foot[at], foot[(at + 1) % 4]
        parts.append(
            Patch.of(quads(lifted(one, shaft + 0.1), lifted(other, shaft + 0.1), lifted(middle, top)),
                     rectangle_uvs(0.0, 0.0, wide, top - shaft, len(owner))[:, :3], colours=spire,
                     materials=int(Material.ROOF_TILES), owners=owner)
        )  # fmt: skip
        side, out = (one + other) / 2.0, ((one + other) / 2.0 - middle) / half
        right = np.column_stack([-out[:, 1], out[:, 0]])
        parts.append(_arched(side, right, out, wide * 0.32, shaft - 0.36 * (shaft - base), shaft - 0.14 * (shaft - base),
                             0.05, np.array((0.16, 0.15, 0.14)), int(Material.PLAIN), owner))  # fmt: skip
    return parts


def _tower_places(prints: Footprints, roofs: Roofs) -> tuple[Ints, Floats, Floats, Floats]:
    """Return the buildings that get a tower; where, along which direction and how wide it is."""
    found: list[tuple[int, tuple[float, float], tuple[float, float], float]] = []
    for owner in np.flatnonzero(roofs.tower).tolist():
        ring = prints.corners[(prints.owners == owner) & ~prints.in_court]
        plan = shapely.Polygon(ring)
        box = np.asarray(shapely.minimum_rotated_rectangle(plan).exterior.coords)[:4]
        if np.hypot(*(box[1] - box[0])) < np.hypot(*(box[2] - box[1])):
            box = np.roll(box, -1, axis=0)
        long, short = box[1] - box[0], box[2] - box[1]
        length, width = float(np.hypot(*long)), float(np.hypot(*short))
        wide = float(np.clip(0.34 * width, 3.2, 8.0))
        # At the end of the long axis that comes first, else further in, until it stands on the church.
        for share in (0.5 * wide / length + 0.01, 0.12, 0.2, 0.3, 0.5):
            middle = box[0] + share * long + 0.5 * short
            if shapely.contains(plan.buffer(0.3), shapely.Point(middle).buffer(wide / 2.0)):
                found.append((owner, tuple(middle), tuple(long / length), wide))
                break
    owners = np.array([row[0] for row in found], dtype=np.int64)
    middles, along = (np.array([row[at] for row in found], dtype=np.float64).reshape(-1, 2) for at in (1, 2))
    return owners, middles, along, np.array([row[3] for row in found], dtype=np.float64)


def _spaced(lengths: Floats, spacing_m: float) -> tuple[Ints, Floats]:
    """Return for each length the middles of about equal parts: whose they are, and shares of the length."""
    count = np.maximum(np.round(np.maximum(lengths, 0.0) / spacing_m), 1.0).astype(np.int64)
    row = np.repeat(np.arange(len(lengths)), count)
    place = np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count)
    return row, (place + 0.5) / count[row]
