"""The layers of a map picture, from the ground up: regions, ways, shadows, buildings, crowns, symbols.

Everything of one layer goes into few collections, so that a town with thousands of buildings is drawn in seconds. The
light comes from the north-west, as on most maps, though the sun never shines from there.
"""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PathCollection, PolyCollection
from matplotlib.path import Path as MarkPath
from numpy.typing import NDArray

from reasoned_explorer.model.draws import key_of, uniform
from reasoned_explorer.world.drawing_style import Palette, mix
from reasoned_explorer.world.symbols import compound_path, oriented
from reasoned_explorer.world.taxonomy import Ground
from reasoned_explorer.world.textures import pitch_lines, shore_lines, wood_crowns
from reasoned_explorer.world.world import Bounds, Building, Region, Way, World, WorldObject

FloatArray = NDArray[np.float64]

#: Which way shadows fall, as a unit vector, and their length for each metre of height (a high summer sun).
SHADOW_DIRECTION = (0.76, -0.65)
SHADOW_PER_METRE = 0.45
#: Taller buildings throw no longer shadow than this, so that a tower does not hide a quarter.
LONGEST_SHADOW_M = 22.0

_QUAD_CODES = (MarkPath.MOVETO, MarkPath.LINETO, MarkPath.LINETO, MarkPath.LINETO, MarkPath.CLOSEPOLY)
_EDGED = frozenset(
    {
        Ground.GRASS,
        Ground.WOOD,
        Ground.GARDEN,
        Ground.PITCH,
        Ground.PLAYGROUND,
        Ground.PARKING,
        Ground.PLAZA,
        Ground.SAND,
    }
)
#: The least widths at which ways are drawn, points, so that a footpath does not vanish on a map of a town.
_LEAST_WIDTH_PT = {Ground.ROAD: 1.3, Ground.RAILWAY: 0.8}
_CAR_COLOURS = ("#f4f4f2", "#c9ccd0", "#8d949c", "#5a6069", "#3f454d", "#a4483f", "#3f5f8a", "#d8d2c4")


@dataclass(frozen=True, slots=True)
class Board:
    """What a map is painted on.

    Attributes:
        axes: Equal scales east and north, limits as in ``bounds``.
        bounds: What it shows, ENU metres.
        metres_per_point: Its scale: metres in the world for each typographic point on the sheet.
        palette: Colours.
    """

    axes: Axes
    bounds: Bounds
    metres_per_point: float
    palette: Palette

    def points(self, length_m: float) -> float:
        """Return a length of the world as points on the sheet."""
        return length_m / self.metres_per_point

    def shows(self, points: FloatArray, *, margin_m: float = 0.0) -> bool:
        """Return whether the rectangle around points, shape (n, 2), touches what the map shows."""
        if len(points) == 0:
            return False
        (low_x, low_y), (high_x, high_y) = points.min(axis=0), points.max(axis=0)
        bounds = self.bounds
        return bool(
            high_x >= bounds.min_x_m - margin_m
            and low_x <= bounds.max_x_m + margin_m
            and high_y >= bounds.min_y_m - margin_m
            and low_y <= bounds.max_y_m + margin_m
        )

    def shows_point(self, x_m: float, y_m: float, *, margin_m: float = 0.0) -> bool:
        """Return whether a point lies in what the map shows, or within a margin of it."""
        bounds = self.bounds
        return (
            bounds.min_x_m - margin_m <= x_m <= bounds.max_x_m + margin_m
            and bounds.min_y_m - margin_m <= y_m <= bounds.max_y_m + margin_m
        )


def paint_world(board: Board, world: World) -> None:
    """Paint everything of a world but its symbols and names."""
    regions = [region for region in world.regions if len(region.outer) >= 3 and board.shows(region.outer)]
    ways = [way for way in world.ways if len(way.line) >= 2 and board.shows(way.line, margin_m=way.width_m)]
    buildings = [
        building
        for building in world.buildings
        if len(building.outer) >= 3 and board.shows(building.outer, margin_m=LONGEST_SHADOW_M)
    ]
    objects = [item for item in world.objects if board.shows_point(item.x_m, item.y_m, margin_m=8.0)]
    _paint_unknown(board, world.bounds)
    _paint_regions(board, regions)
    _paint_textures(board, regions, world.bounds)
    _paint_ways(board, ways)
    _paint_areas(board, objects)
    _paint_shadows(board, buildings)
    _paint_vehicles(board, objects)
    _paint_buildings(board, buildings)
    _paint_crowns(board, objects, world.seed)


def _paint_unknown(board: Board, bounds: Bounds) -> None:
    """Where the world says nothing: a neutral tone under fine slanting lines, within the world's bounds only."""
    palette, shown = board.palette, board.bounds
    west, east = max(bounds.min_x_m, shown.min_x_m), min(bounds.max_x_m, shown.max_x_m)
    south, north = max(bounds.min_y_m, shown.min_y_m), min(bounds.max_y_m, shown.max_y_m)
    if west >= east or south >= north:
        return
    ground = PolyCollection(
        [[(west, south), (east, south), (east, north), (west, north)]],
        facecolors=palette.ground[Ground.UNKNOWN],
        edgecolors="none",
        zorder=0.0,
    )
    board.axes.add_collection(ground, autolim=False)
    step_m = 3.2 * board.metres_per_point
    height = north - south
    # A line x - y = c crosses the rectangle between these two corners; each is cut to it exactly.
    offsets = np.arange(math.floor((west - north) / step_m), math.ceil((east - south) / step_m) + 1) * step_m
    low = np.maximum(west, offsets + south)
    high = np.minimum(east, offsets + south + height)
    keep = low < high
    lines = np.stack(
        [np.column_stack([low, low - offsets])[keep], np.column_stack([high, high - offsets])[keep]], axis=1
    )
    board.axes.add_collection(
        LineCollection(list(lines), colors=palette.hatch, linewidths=0.55, zorder=0.1, capstyle="butt"), autolim=False
    )


def _paint_regions(board: Board, regions: Sequence[Region]) -> None:
    palette = board.palette
    fills = [palette.ground[region.ground] for region in regions]
    edges = [
        mix(fill, "#5d6b48", 0.22) if region.ground in _EDGED else fill
        for region, fill in zip(regions, fills, strict=True)
    ]
    paths = [_ringed_path(region.outer, region.holes) for region in regions]
    board.axes.add_collection(
        PathCollection(paths, facecolors=fills, edgecolors=edges, linewidths=0.35, zorder=1.0), autolim=False
    )


def _ringed_path(outer: FloatArray, holes: Iterable[FloatArray]) -> MarkPath:
    rings = [oriented(outer, anticlockwise=True)]
    rings.extend(oriented(hole, anticlockwise=False) for hole in holes if len(hole) >= 3)
    return compound_path(rings)


def _paint_textures(board: Board, regions: Sequence[Region], bounds: Bounds) -> None:
    palette, axes = board.palette, board.axes
    water = [region for region in regions if region.ground is Ground.WATER]
    for step, distance_pt in enumerate((0.0, 1.8, 4.0, 6.8)):
        lines = shore_lines(water, distance_pt * board.metres_per_point, bounds)
        colour = mix(palette.shore, palette.ground[Ground.WATER], (0.0, 0.45, 0.66, 0.82)[step])
        axes.add_collection(
            LineCollection(lines, colors=colour, linewidths=0.8 if step == 0 else 0.5, zorder=1.1), autolim=False
        )
    woods = [region for region in regions if region.ground is Ground.WOOD]
    spacing_m = max(6.5, 4.2 * board.metres_per_point)
    for tone, share in (("#6d9a55", 0.20), ("#8dbb70", 0.45)):
        outlines = wood_crowns(woods, spacing_m, board.bounds, shift=0.0 if tone == "#6d9a55" else -0.08)
        colour = mix(palette.ground[Ground.WOOD], mix(tone, palette.paper, _paleness(palette)), share)
        axes.add_collection(
            PolyCollection(list(outlines), facecolors=colour, edgecolors="none", zorder=1.2), autolim=False
        )
    markings = [line for region in regions if region.ground is Ground.PITCH for line in pitch_lines(region.outer)]
    width = min(max(board.points(0.25), 0.35), 1.2)
    axes.add_collection(
        LineCollection(markings, colors=palette.lane, linewidths=width, alpha=0.9, zorder=1.3), autolim=False
    )
    sites = [_ringed_path(item.outer, item.holes) for item in regions if item.ground is Ground.CONSTRUCTION]
    axes.add_collection(
        PathCollection(
            sites,
            facecolors="none",
            edgecolors=mix(palette.ground[Ground.CONSTRUCTION], "#7a4d12", 0.55),
            linewidths=0.9,
            linestyles=(0, (3.0, 1.6)),
            zorder=1.4,
        ),
        autolim=False,
    )


def _paleness(palette: Palette) -> float:
    """Return how far a palette has gone to its paper: 0 for the plain one."""
    plain = int(Palette().shadow[1:3], 16)
    paper = int(palette.paper[1:3], 16)
    return (int(palette.shadow[1:3], 16) - plain) / (paper - plain)


def _paint_ways(board: Board, ways: Sequence[Way]) -> None:
    """Tunnels faintly, then the ground's casings and fills, then bridges; each in the world's order."""
    _paint_deck(board, [way for way in ways if way.level < 0], 2.0, tunnel=True)
    _paint_deck(board, [way for way in ways if way.level == 0], 2.1)
    for level in sorted({way.level for way in ways if way.level > 0}):
        _paint_deck(board, [way for way in ways if way.level == level], 2.3 + 0.05 * min(level, 5), bridge=True)


def _paint_deck(
    board: Board, ways: Sequence[Way], zorder: float, *, tunnel: bool = False, bridge: bool = False
) -> None:
    if not ways:
        return
    palette, axes = board.palette, board.axes
    lines = [way.line for way in ways]
    fills = [palette.ground[way.ground] for way in ways]
    widths = [max(board.points(way.width_m), _LEAST_WIDTH_PT.get(way.ground, 0.7)) for way in ways]
    if tunnel:
        axes.add_collection(
            LineCollection(lines, colors=fills, linewidths=widths, alpha=0.35, capstyle="butt", zorder=zorder),
            autolim=False,
        )
        return
    dark = 0.55 if bridge else 0.28
    casings = [mix(fill, "#6a6459", dark) for fill in fills]
    rim = 1.5 if bridge else min(max(board.points(0.5), 0.55), 1.0)
    ends = "butt" if bridge else "round"
    for colours, extra, layer in ((casings, rim, 0.0), (fills, 0.0, 0.01)):
        collection = LineCollection(
            lines,
            colors=colours,
            linewidths=[width + extra for width in widths],
            capstyle=ends,
            joinstyle="round",
            zorder=zorder + layer,
        )
        axes.add_collection(collection, autolim=False)
    _paint_markings(board, ways, widths, zorder + 0.02)


def _paint_markings(board: Board, ways: Sequence[Way], widths: Sequence[float], zorder: float) -> None:
    """Steps get their treads, rails their sleepers, wide roads a broken line in the middle."""
    palette, axes = board.palette, board.axes
    ticks = [
        (way, width, tread)
        for way, width in zip(ways, widths, strict=True)
        for tread in ((0.9, 1.1) if way.ground is Ground.STEPS else (0.7, 2.6) if way.ground is Ground.RAILWAY else (),)
        if tread
    ]
    # Dashes are counted in line widths, hence the division.
    axes.add_collection(
        LineCollection(
            [way.line for way, _, _ in ticks],
            colors=[mix(palette.ground[way.ground], "#55453a", 0.45) for way, _, _ in ticks],
            linewidths=[width for _, width, _ in ticks],
            linestyles=[(0, (tread[0] / width, tread[1] / width)) for _, width, tread in ticks] or "solid",
            capstyle="butt",
            zorder=zorder,
        ),
        autolim=False,
    )
    wide = [
        way.line for way in ways if way.ground is Ground.ROAD and way.width_m >= 6.0 and board.points(way.width_m) > 5
    ]
    axes.add_collection(
        LineCollection(
            wide,
            colors=palette.lane,
            linewidths=min(max(board.points(0.3), 0.5), 1.6),
            linestyles=(0, (7.0, 5.0)),
            capstyle="butt",
            zorder=zorder + 0.01,
        ),
        autolim=False,
    )


def _paint_areas(board: Board, objects: Sequence[WorldObject]) -> None:
    """Objects that have an outline of their own: basins as water, the rest as a fine broken line."""
    palette, axes = board.palette, board.axes
    basins = [outline for item, outline in _outlined(objects) if item.class_name == "fountain"]
    axes.add_collection(
        PolyCollection(
            basins, facecolors=palette.ground[Ground.WATER], edgecolors=palette.shore, linewidths=0.8, zorder=2.6
        ),
        autolim=False,
    )
    areas = [(item, outline) for item, outline in _outlined(objects) if item.object_class.kind == "area"]
    colours = {"playground": "#ad3f73", "pitch": "#3d8a63", "lawn": "#7fa35f"}
    axes.add_collection(
        PolyCollection(
            [outline for _, outline in areas],
            facecolors="none",
            edgecolors=[mix(colours.get(item.class_name, palette.soft_ink), palette.paper, 0.3) for item, _ in areas],
            linewidths=[0.9 if item.class_name == "playground" else 0.45 for item, _ in areas],
            linestyles=[(0, (2.5, 1.8)) for _ in areas] or "solid",
            zorder=2.7,
        ),
        autolim=False,
    )


def _outlined(objects: Sequence[WorldObject]) -> list[tuple[WorldObject, FloatArray]]:
    return [(item, item.outline) for item in objects if item.outline is not None and len(item.outline) >= 3]


def _paint_shadows(board: Board, buildings: Sequence[Building]) -> None:
    """Each wall swept along the shadow's direction; all in one path, so that overlaps do not darken.

    Three lengths on top of each other make the shadow's end soft.
    """
    casting = [building for building in buildings if building.height_m > 0.5]
    rings = [oriented(building.outer, anticlockwise=True) for building in casting]
    direction = np.array(SHADOW_DIRECTION)
    for share, alpha in ((1.0, 0.06), (0.86, 0.07), (0.7, 0.08)) if casting else ():
        outlines: list[FloatArray] = []
        walls: list[FloatArray] = []
        for building, ring in zip(casting, rings, strict=True):
            reach = min(building.height_m * SHADOW_PER_METRE, LONGEST_SHADOW_M) * share
            low = ring + direction * min(building.min_height_m * SHADOW_PER_METRE, reach)
            high = ring + direction * reach
            outlines += [low, high]
            walls.append(np.stack([low, _after(low), _after(high), high], axis=1))
        quads = np.concatenate(walls)
        # With one sense of turning for all, filling by winding number gives their union.
        along, across = quads[:, 1] - quads[:, 0], quads[:, 3] - quads[:, 0]
        clockwise = along[:, 0] * across[:, 1] - along[:, 1] * across[:, 0] < 0.0
        quads[clockwise] = quads[clockwise][:, ::-1]
        closed = np.concatenate([quads, quads[:, :1]], axis=1).reshape(-1, 2)
        codes = np.tile(np.array(_QUAD_CODES, dtype=np.uint8), len(quads))
        roofs = compound_path(outlines)
        path = MarkPath(np.concatenate([roofs.vertices, closed]), np.concatenate([np.asarray(roofs.codes), codes]))
        board.axes.add_collection(
            PathCollection([path], facecolors=board.palette.shadow, edgecolors="none", alpha=alpha, zorder=3.0),
            autolim=False,
        )


def _after(ring: FloatArray) -> FloatArray:
    """Return each point's successor in a ring."""
    return np.concatenate([ring[1:], ring[:1]])


def _paint_buildings(board: Board, buildings: Sequence[Building]) -> None:
    palette, axes = board.palette, board.axes
    solid = [building for building in buildings if building.min_height_m <= 2.0]
    open_roofs = [building for building in buildings if building.min_height_m > 2.0]
    for group, alpha, zorder in ((solid, 1.0, 4.0), (open_roofs, 0.6, 4.2)):
        fills = [mix(*palette.roof, min(max((building.height_m - 4.0) / 30.0, 0.0), 1.0)) for building in group]
        axes.add_collection(
            PathCollection(
                [_ringed_path(building.outer, building.holes) for building in group],
                facecolors=fills,
                edgecolors=palette.roof_edge,
                linewidths=0.45,
                linestyles="solid" if alpha == 1.0 else (0, (2.0, 1.4)),
                alpha=alpha,
                zorder=zorder,
            ),
            autolim=False,
        )
    _paint_eaves(board, solid)


def _paint_eaves(board: Board, buildings: Sequence[Building]) -> None:
    """Roof edges towards the light are light and those away from it dark: the roofs stand up a little."""
    starts, ends = [], []
    for building in buildings:
        ring = oriented(building.outer, anticlockwise=True)
        starts.append(ring)
        ends.append(_after(ring))
    if not starts:
        return
    first, second = np.concatenate(starts), np.concatenate(ends)
    along = second - first
    length = np.hypot(along[:, 0], along[:, 1])
    keep = length > 0.3
    first, second, along, length = first[keep], second[keep], along[keep], length[keep]
    # Outlines turn anticlockwise, so the outside lies to the right of an edge.
    outward = np.column_stack([along[:, 1], -along[:, 0]]) / length[:, None]
    away = outward @ np.array(SHADOW_DIRECTION)
    inset = -outward * 0.45 * board.metres_per_point
    lines = np.stack([first + inset, second + inset], axis=1)
    palette = board.palette
    for chosen, colour, alpha in ((away < -0.2, "#ffffff", 0.8), (away > 0.2, palette.roof_edge, 0.55)):
        axes_lines = LineCollection(
            lines[chosen], colors=colour, linewidths=0.6, alpha=alpha, capstyle="butt", zorder=4.1
        )
        board.axes.add_collection(axes_lines, autolim=False)


@lru_cache(maxsize=1)
def _crown_outlines() -> FloatArray:
    """Eight crowns of radius about 1, shape (8, 36, 2): circles with soft lobes."""
    angles = np.linspace(0.0, 2.0 * np.pi, 36, endpoint=False)
    outlines = []
    for kind in range(8):
        lobes, phase = 7 + kind % 4, uniform(0, "crown", kind) * 6.28
        radius = 0.95 + 0.04 * np.cos(lobes * angles + phase) + 0.03 * np.cos(3 * angles + 2 * phase)
        outlines.append(np.column_stack([radius * np.cos(angles), radius * np.sin(angles)]))
    return np.array(outlines)


def _paint_crowns(board: Board, objects: Sequence[WorldObject], seed: int) -> None:
    palette, axes = board.palette, board.axes
    plants = [item for item in objects if item.object_class.kind == "plant"]
    if not plants:
        return
    places = np.array([(item.x_m, item.y_m) for item in plants])
    radii = np.array([max(item.size_m[0], item.size_m[1]) / 2.0 for item in plants])
    radii = np.maximum(radii, 1.1 * board.metres_per_point)
    heights = np.array([item.size_m[2] for item in plants])
    keys = [key_of(seed, "crown", item.id) for item in plants]
    outlines = _crown_outlines()[[key % 8 for key in keys]] * radii[:, None, None]
    colours = np.array([palette.crowns[(key >> 8) % len(palette.crowns)] for key in keys])
    light = np.array(SHADOW_DIRECTION)
    ground_shadow = np.minimum(heights * 0.28, radii * 0.9)[:, None] * light
    axes.add_collection(
        PolyCollection(
            outlines + (places + ground_shadow)[:, None, :],
            facecolors=palette.shadow,
            edgecolors="none",
            alpha=0.13,
            zorder=3.2,
        ),
        autolim=False,
    )
    rims = [mix(colour, "#2f4a22", 0.30 * (1.0 - _paleness(palette))) for colour in colours]
    for shift, scale, brighter, alpha, rim in (
        (0.0, 1.0, 0.0, 0.93, 0.3),
        (0.18, 0.68, 0.22, 0.6, 0.0),
        (0.3, 0.36, 0.4, 0.6, 0.0),
    ):
        axes.add_collection(
            PolyCollection(
                outlines * scale + (places - light * (shift * radii)[:, None])[:, None, :],
                facecolors=[mix(colour, "#f4f7d4", brighter) for colour in colours],
                edgecolors=rims if rim else "none",
                linewidths=rim,
                alpha=alpha,
                zorder=5.0 + shift,
            ),
            autolim=False,
        )


def _paint_vehicles(board: Board, objects: Sequence[WorldObject]) -> None:
    """Parked cars at their true size, with their windows."""
    cars = [item for item in objects if item.class_name == "car"]
    palette = board.palette
    body = np.array(
        [(-0.5, -0.36), (-0.42, -0.5), (0.42, -0.5), (0.5, -0.36), (0.5, 0.38), (0.36, 0.5), (-0.36, 0.5), (-0.5, 0.38)]
    )
    glass = np.array([(-0.36, 0.12), (0.36, 0.12), (0.28, 0.26), (-0.28, 0.26)])
    rear = np.array([(-0.34, -0.36), (0.34, -0.36), (0.36, -0.24), (-0.36, -0.24)])
    fills = [
        mix(_CAR_COLOURS[key_of(0, "car", item.id) % len(_CAR_COLOURS)], palette.paper, _paleness(palette))
        for item in cars
    ]
    for outline, colours, edge, zorder in (
        (body, fills, 0.3, 3.4),
        (glass, [mix(fill, "#27313d", 0.6 * (1.0 - _paleness(palette))) for fill in fills], 0.0, 3.5),
        (rear, [mix(fill, "#27313d", 0.4 * (1.0 - _paleness(palette))) for fill in fills], 0.0, 3.5),
    ):
        board.axes.add_collection(
            PolyCollection(
                [_placed(outline, item) for item in cars],
                facecolors=colours,
                edgecolors=mix("#4b5058", palette.paper, _paleness(palette)) if edge else "none",
                linewidths=edge,
                zorder=zorder,
            ),
            autolim=False,
        )


def _placed(outline: FloatArray, item: WorldObject) -> FloatArray:
    """Return an outline (x across the front, y to the front) where an object stands; a car is longer than wide."""
    length, width = max(item.size_m[:2]), min(item.size_m[:2])
    local = outline * np.array([width, length])
    sine, cosine = math.sin(item.heading_rad), math.cos(item.heading_rad)
    east = local[:, 0] * cosine + local[:, 1] * sine
    north = -local[:, 0] * sine + local[:, 1] * cosine
    return np.column_stack([item.x_m + east, item.y_m + north])
