"""What is painted on the ground or lies flat on it: lanes, crossings, parking bays, pitches, rails."""

import math

import numpy as np
import shapely
from numpy.typing import NDArray

from reasoned_explorer.rendering.crossings import Crossings, crossings_of, is_carriageway
from reasoned_explorer.rendering.edges import edges
from reasoned_explorer.rendering.kerbs import kerbs, shores
from reasoned_explorer.rendering.material import Material
from reasoned_explorer.rendering.mesh import Model
from reasoned_explorer.rendering.patches import Patch, lifted, meshes_of, plan_uvs, quads
from reasoned_explorer.rendering.road_lines import Clearings, Lines, clearings_of
from reasoned_explorer.world.raster import GroundRaster
from reasoned_explorer.world.taxonomy import Ground
from reasoned_explorer.world.textures import pitch_lines
from reasoned_explorer.world.world import Way, World

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
#: Where a model's origin stands, ENU metres.
Place = tuple[float, float, float]

#: Edge of the squares into which everything is cut, so that what is not seen is not drawn, metres.
CHUNK_M = 32.0
_PAINT_Z_M, _SLEEPER_Z_M, _RAIL_Z_M = 0.012, 0.02, 0.06
_WHITE = np.array((0.90, 0.90, 0.88))
_TREAD = np.array((0.52, 0.51, 0.49))
_STEEL, _SLEEPER = np.array((0.62, 0.60, 0.58)), np.array((0.42, 0.37, 0.33))
_UNMARKED = frozenset({"service", "track", "living_street", "driveway", "pedestrian", "alley"})
_MAIN = frozenset({"motorway", "trunk", "primary", "secondary", "tertiary"})
#: Carriageways at least this wide have four lanes, or lines along their edges, metres.
_FOUR_LANES_M, _EDGED_M = 12.5, 10.0
_BAY_M = (2.6, 5.2)
_AISLE_M, _BACK_TO_BACK_M = 6.2, 0.3
_GAUGE_M = 1.435


def markings_of(world: World, ground: GroundRaster, *, crossings: Crossings | None = None) -> list[tuple[Model, Place]]:
    """Return everything that is painted on the ground or lies flat on it, and kerbs, in squares of `CHUNK_M`.

    Args:
        world: The world.
        ground: Its ground as it is drawn (`reasoned_explorer.rendering.ground_map.ground_map_of`).
        crossings: Of the world, where they are known already.

    Returns:
        For each square in which there is anything its model, about a place of its own, and that place.
    """
    crossed = crossings_of(world) if crossings is None else crossings
    roads = [way for way in world.ways if is_carriageway(way)]
    on_roads = [*lane_lines(roads, clearings_of(roads, crossed)), zebras(crossed), stop_lines(crossed)]
    patches = [
        *(lying_on(patch, ground, Ground.ROAD) for patch in on_roads),
        parking_bays(world, ground),
        lying_on(pitches(world), ground, Ground.PITCH),
        *rails(world.ways),
        lying_on(stairs(world.ways), ground, Ground.STEPS),
        *kerbs(roads, ground, crossed),
        *shores(world, ground),
        *edges(world, ground, crossed),
    ]
    return chunked(patches)


def strips(
    begins: Floats,
    ends: Floats,
    *,
    width_m: Floats | float,
    colour: Floats = _WHITE,
    z_m: float = _PAINT_Z_M,
    material: int = int(Material.CONCRETE),
) -> Patch:
    """Return flat strips on the ground from points to points, each of shape (n, 2), metres."""
    step = ends - begins
    length = np.maximum(np.hypot(*step.T), 1e-9)
    side = np.column_stack([-step[:, 1], step[:, 0]]) / length[:, None] * (np.asarray(width_m) / 2.0).reshape(-1, 1)
    corners = quads(*(lifted(point, z_m) for point in (begins - side, ends - side, ends + side, begins + side)))
    return Patch.of(
        corners, plan_uvs(corners), colours=colour, materials=material, owners=np.zeros(len(begins), np.int64)
    )


def lying_on(patch: Patch, ground: GroundRaster, kind: Ground) -> Patch:
    """Return the faces whose middle lies on a kind of ground: what lies above hides the others."""
    middles = patch.corners[..., :2].mean(axis=1)
    return patch.where(ground.at_many(middles[:, 0], middles[:, 1]) == kind)


def lane_lines(roads: list[Way], clearings: Clearings) -> list[Patch]:
    """Return the dashes between lanes, lines between directions on wide roads, and lines along edges."""
    lines = Lines([road.line for road in roads])
    width = np.array([road.width_m for road in roads])
    main = np.array([road.kind in _MAIN for road in roads], dtype=np.bool_)
    marked = np.array([road.kind not in _UNMARKED for road in roads], dtype=np.bool_)
    marked &= np.where(main, width >= 5.8, width >= 7.0)
    four = marked & (width >= _FOUR_LANES_M)
    edged = marked & main & (width >= _EDGED_M)
    parts = [_beside(lines, np.flatnonzero(marked & ~four), width * 0.0, clearings, every_m=6.0, long_m=3.0)]
    for side in (-1.0, 1.0):
        parts += [
            _beside(lines, np.flatnonzero(four), side * width / 4.0, clearings, every_m=6.0, long_m=3.0),
            _beside(lines, np.flatnonzero(four), np.full_like(width, 0.12 * side), clearings, every_m=4.0, long_m=4.0),
            _beside(lines, np.flatnonzero(edged), side * (width / 2.0 - 0.35), clearings, every_m=4.0, long_m=4.0),
        ]
    return parts


def _beside(lines: Lines, chosen: Ints, off_m: Floats, clearings: Clearings, *, every_m: float, long_m: float) -> Patch:
    """Return strips along lines, to their left by ``off_m`` of each."""
    which, begin, end = lines.stretches(chosen, every_m=every_m, long_m=long_m)
    good = clearings.clear_of((begin + end) / 2.0, long_m / 2.0)
    which, begin, end = which[good], begin[good], end[good]
    step = end - begin
    left = np.column_stack([-step[:, 1], step[:, 0]]) / np.maximum(np.hypot(*step.T), 1e-9)[:, None]
    aside = left * off_m[which][:, None]
    return strips(begin + aside, end + aside, width_m=0.14)


def zebras(crossings: Crossings) -> Patch:
    """Return the stripes of marked crossings: half a metre wide, half a metre apart, along the road."""
    marked = np.flatnonzero(crossings.marked)
    count = np.maximum(np.floor(crossings.road_m[marked] - 0.3), 1.0).astype(np.int64)
    row = np.repeat(marked, count)
    place = np.arange(len(row)) - np.repeat(np.cumsum(count) - count, count)
    along = crossings.along[row]
    across = np.column_stack([-along[:, 1], along[:, 0]])
    off = (place + 0.5 - np.repeat(count, count) / 2.0)[:, None]
    middle = crossings.middles[row] + off * across
    half = (crossings.walk_m[row] / 2.0)[:, None] * along
    # Where roads meet at a sharp angle, crossings would lie on each other.
    free = ~_covered(crossings, middle - half, middle + half, row)
    return strips((middle - half)[free], (middle + half)[free], width_m=0.5)


def _covered(crossings: Crossings, begins: Floats, ends: Floats, owners: Ints) -> NDArray[np.bool_]:
    """Return which strips touch the stripes of a crossing that comes before their own."""
    found = np.zeros(len(begins), np.bool_)
    for share in (0.0, 0.25, 0.5, 0.75, 1.0):
        found |= crossings.cover(begins + share * (ends - begins), owners)
    return found


def stop_lines(crossings: Crossings) -> Patch:
    """Return the lines at which cars wait before marked crossings of wide roads, each on its right lane."""
    begins, ends = [np.empty((0, 2))], [np.empty((0, 2))]
    wide = crossings.marked & (crossings.road_m >= 8.0)
    for heading in (-1.0, 1.0):
        ahead = heading * crossings.along[wide]
        right = np.column_stack([ahead[:, 1], -ahead[:, 0]])
        before = crossings.middles[wide] - ahead * (crossings.walk_m[wide] / 2.0 + 1.2)[:, None]
        begins.append(before + 0.2 * right)
        ends.append(before + right * (crossings.road_m[wide] / 2.0 - 0.4)[:, None])
    begin, end = np.concatenate(begins), np.concatenate(ends)
    free = ~_covered(crossings, begin, end, np.full(len(begin), len(crossings.middles)))
    return strips(begin[free], end[free], width_m=0.35)


def parking_bays(world: World, ground: GroundRaster) -> Patch:
    """Return the lines between the bays of car parks: rows along their longer side, an aisle after every other."""
    begins, ends = [np.empty((0, 2))], [np.empty((0, 2))]
    for region in world.regions:
        if region.ground == Ground.PARKING and len(region.outer) >= 3:
            begin, end = _bay_lines(region.outer)
            begins.append(begin)
            ends.append(end)
    begin, end = np.concatenate(begins), np.concatenate(ends)
    on = np.ones(len(begin), np.bool_)
    for share in (0.0, 0.5, 1.0):
        point = begin + share * (end - begin)
        on &= ground.at_many(point[:, 0], point[:, 1]) == Ground.PARKING
    return strips(begin[on], end[on], width_m=0.12)


def _bay_lines(outer: Floats) -> tuple[Floats, Floats]:
    box = np.asarray(shapely.minimum_rotated_rectangle(shapely.Polygon(outer)).exterior.coords)[:4, :2]
    if len(box) < 4:
        return np.empty((0, 2)), np.empty((0, 2))
    if np.hypot(*(box[1] - box[0])) < np.hypot(*(box[2] - box[1])):
        box = np.roll(box, -1, axis=0)
    angle = math.atan2(*(box[1] - box[0])[::-1])
    along, across = np.array([math.cos(angle), math.sin(angle)]), np.array([-math.sin(angle), math.cos(angle)])
    middle = box.mean(axis=0)
    half_length = float(np.hypot(*(box[1] - box[0]))) / 2.0
    half_width = float(np.hypot(*(box[2] - box[1]))) / 2.0
    rows: list[float] = []
    y, facing = -half_width + 0.4 + _BAY_M[1] / 2.0, True
    while y < half_width - _BAY_M[1] / 2.0 - 0.2:
        rows.append(y)
        y += _BAY_M[1] + (_AISLE_M if facing else _BACK_TO_BACK_M)
        facing = not facing
    places = np.arange(-half_length + 0.4, half_length, _BAY_M[0])
    x, row = (grid.ravel() for grid in np.meshgrid(places, np.array(rows, dtype=np.float64)))
    on = middle + x[:, None] * along
    reach = _BAY_M[1] / 2.0 - 0.15
    return on + (row - reach)[:, None] * across, on + (row + reach)[:, None] * across


def pitches(world: World) -> Patch:
    """Return the lines of pitches."""
    drawn = [line for region in world.regions if region.ground == Ground.PITCH for line in pitch_lines(region.outer)]
    begins = np.concatenate([np.empty((0, 2)), *(line[:-1] for line in drawn)])
    ends = np.concatenate([np.empty((0, 2)), *(line[1:] for line in drawn)])
    return strips(begins, ends, width_m=0.12)


def rails(ways: tuple[Way, ...]) -> list[Patch]:
    """Return rails on sleepers along railways on the ground."""
    tracks = [way for way in ways if way.level == 0 and way.ground == Ground.RAILWAY and way.kind != "platform"]
    if not tracks:
        return []
    lines = Lines([way.line for way in tracks])
    every = np.arange(len(tracks))
    _, begin, end = lines.stretches(every, every_m=6.0, long_m=6.0)
    step = end - begin
    unit = step / np.maximum(np.hypot(*step.T), 1e-9)[:, None]
    left = np.column_stack([-unit[:, 1], unit[:, 0]])
    parts = [
        strips(
            begin + side * left,
            end + side * left,
            width_m=0.08,
            colour=_STEEL,
            z_m=_RAIL_Z_M,
            material=int(Material.METAL),
        )
        for side in (-_GAUGE_M / 2.0, _GAUGE_M / 2.0)
    ]
    trams = np.array([way.kind == "tram" for way in tracks], dtype=np.bool_)
    _, begin, end = lines.stretches(every[~trams], every_m=0.9, long_m=0.26)
    parts.append(strips(begin, end, width_m=2.5, colour=_SLEEPER, z_m=_SLEEPER_Z_M, material=int(Material.CONCRETE)))
    return parts


def stairs(ways: tuple[Way, ...]) -> Patch:
    """Return the edges of steps, across ways that are stairs."""
    flights = [way for way in ways if way.level == 0 and way.ground == Ground.STEPS]
    lines = Lines([way.line for way in flights])
    which, begin, end = lines.stretches(np.arange(len(flights)), every_m=0.45, long_m=0.1)
    half = np.array([way.width_m / 2.0 for way in flights])[which]
    step = end - begin
    left = np.column_stack([-step[:, 1], step[:, 0]]) / np.maximum(np.hypot(*step.T), 1e-9)[:, None]
    middle, aside = (begin + end) / 2.0, left * half[:, None]
    return strips(middle - aside, middle + aside, width_m=0.1, colour=_TREAD, material=int(Material.STONE))


def chunked(patches: list[Patch]) -> list[tuple[Model, Place]]:
    """Return faces as one model for each square of `CHUNK_M` that has any, by where their middles are."""
    patches = [patch for patch in patches if len(patch.corners)]
    if not patches:
        return []
    squares = [np.floor(patch.corners[..., :2].mean(axis=1) / CHUNK_M).astype(np.int64) for patch in patches]
    keys, owner = np.unique(np.concatenate(squares), axis=0, return_inverse=True)
    owners = np.split(owner.reshape(-1), np.cumsum([len(square) for square in squares])[:-1])
    places = (keys + 0.5) * CHUNK_M
    owned = [
        Patch(patch.corners, patch.uvs, patch.colours, patch.materials, own)
        for patch, own in zip(patches, owners, strict=True)
    ]
    meshes = meshes_of(owned, len(keys), origins=places)
    return [
        (Model((mesh,), mesh.size_m, "none"), (x, y, 0.0)) for mesh, (x, y) in zip(meshes, places.tolist(), strict=True)
    ]
