"""Names and symbols on a map, placed so that none lies on another.

Names of streets run along them. What finds no room is left out, a symbol shrinks to a dot; the order of placing is the
order of importance, so what is left out is what matters least.
"""

import math
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import shapely
from matplotlib.collections import PathCollection
from matplotlib.path import Path as MarkPath
from matplotlib.textpath import TextPath
from numpy.typing import NDArray

from reasoned_explorer.world.drawing_style import FAMILY_COLOURS, font, mix, printable, set_in, shortened, width_pt
from reasoned_explorer.world.painting import Board
from reasoned_explorer.world.sheet import draw_badges, put_text
from reasoned_explorer.world.symbols import symbol_of
from reasoned_explorer.world.taxonomy import Ground
from reasoned_explorer.world.textures import lines_of, polygon_of
from reasoned_explorer.world.world import Way, World, WorldObject

FloatArray = NDArray[np.float64]

_CELL_PT = 2.0


class Room:
    """Which parts of a map are taken, as a raster of cells two points wide.

    Args:
        board: The map.
    """

    def __init__(self, board: Board) -> None:
        self._bounds = board.bounds
        self._scale = board.metres_per_point
        self._rows = max(1, math.ceil(board.points(board.bounds.height_m) / _CELL_PT))
        self._columns = max(1, math.ceil(board.points(board.bounds.width_m) / _CELL_PT))
        self._taken = np.zeros((self._rows, self._columns), dtype=np.bool_)

    def take(self, places: FloatArray, radius_pt: float, *, whole: bool = True) -> bool:
        """Take the discs around places, shape (n, 2) in ENU metres, if all of them are free.

        Args:
            places: Centres.
            radius_pt: Radius of each disc, points.
            whole: Whether all of it must lie on the map.

        Returns:
            Whether they were free, and now are taken.
        """
        cells = self._cells(places, radius_pt, whole=whole)
        if cells is None:
            return False
        rows, columns = cells
        if self._taken[rows, columns].any():
            return False
        self._taken[rows, columns] = True
        return True

    def block(self, places: FloatArray, radius_pt: float) -> None:
        """Take the discs around places whether or not they are free."""
        cells = self._cells(places, radius_pt, whole=False)
        if cells is not None:
            self._taken[cells] = True

    def _cells(
        self, places: FloatArray, radius_pt: float, *, whole: bool
    ) -> tuple[NDArray[np.int64], NDArray[np.int64]] | None:
        x = (np.asarray(places)[:, 0] - self._bounds.min_x_m) / self._scale / _CELL_PT
        y = (np.asarray(places)[:, 1] - self._bounds.min_y_m) / self._scale / _CELL_PT
        radius = radius_pt / _CELL_PT
        span = np.arange(-math.ceil(radius), math.ceil(radius) + 1)
        offset_x, offset_y = (grid.ravel() for grid in np.meshgrid(span, span))
        disc = np.hypot(offset_x, offset_y) <= max(radius, 0.7)
        columns = (np.floor(x)[:, None] + offset_x[disc]).astype(np.int64).ravel()
        rows = (np.floor(y)[:, None] + offset_y[disc]).astype(np.int64).ravel()
        inside = (rows >= 0) & (rows < self._rows) & (columns >= 0) & (columns < self._columns)
        if not inside.all():
            if whole or not inside.any():
                return None
            rows, columns = rows[inside], columns[inside]
        return rows, columns


#: A street's name is written again after so many points, and its copies are never closer than so many.
_REPEAT_PT, _APART_PT = 330.0, 190.0


@dataclass(frozen=True, slots=True)
class _Line:
    """A line of letters: the text and the size of its letters in points."""

    text: str
    size_pt: float


@dataclass(frozen=True, slots=True, eq=False)
class _Course:
    """A street's middle line with rounded corners, and how far along it each point lies, metres."""

    points: FloatArray
    at_m: FloatArray


def badge_radius_pt(board: Board, rank: int) -> float:
    """Return how large the symbols of a rank are on a map, points: larger the closer one looks."""
    closeness = min(max(math.sqrt(0.55 / board.metres_per_point), 0.62), 1.7)
    return (0.0, 3.3, 5.1, 6.3)[rank] * closeness


def place_badges(
    board: Board,
    objects: Sequence[WorldObject],
    room: Room,
    *,
    share: float = 1.0,
    alpha: float = 1.0,
    dots: bool = True,
) -> set[str]:
    """Draw symbols for objects, those that matter most and are rarest first, and return the classes that were drawn.

    Args:
        board: The map.
        objects: What is marked; trees, bushes, cars and lawns are not, since they are painted themselves.
        room: What is free.
        share: Size against the usual one.
        alpha: Opacity.
        dots: Whether what finds no room is marked with a dot.
    """
    by_class: dict[str, list[WorldObject]] = defaultdict(list)
    for item in objects:
        painted = item.object_class.kind == "plant" or item.class_name in {"car", "lawn"}
        if not painted and board.shows_point(item.x_m, item.y_m):
            by_class[item.class_name].append(item)
    order = sorted(by_class, key=lambda name: (-symbol_of(name).rank, len(by_class[name]), name))
    for name in order:
        symbol = symbol_of(name)
        # What stands everywhere need not shout everywhere.
        modest = min(max((60.0 / len(by_class[name])) ** 0.2, 0.72), 1.0)
        radius_pt = badge_radius_pt(board, symbol.rank) * share * modest
        shown: list[tuple[float, float]] = []
        crowded: list[tuple[float, float]] = []
        for item in by_class[name]:
            free = room.take(np.array([[item.x_m, item.y_m]]), radius_pt * 1.02, whole=False)
            (shown if free else crowded).append((item.x_m, item.y_m))
        layer = 6.0 + 0.05 * symbol.rank
        if crowded and dots:
            draw_badges(board.axes, np.array(crowded), symbol, 1.15 * share, zorder=layer - 0.5, alpha=0.8 * alpha)
        if shown:
            draw_badges(board.axes, np.array(shown), symbol, radius_pt, zorder=layer, alpha=alpha)
    return set(by_class)


def letter_streets(board: Board, ways: Sequence[Way], room: Room, *, colour: str, limit: int = 90) -> None:
    """Write the names of streets along them, the widest and longest first."""
    by_name: dict[str, list[Way]] = defaultdict(list)
    for way in ways:
        if way.name and way.level >= 0 and len(way.line) >= 2 and board.shows(way.line):
            by_name[printable(way.name, limit=60)].append(way)
    bounds = board.bounds
    frame = shapely.box(bounds.min_x_m, bounds.min_y_m, bounds.max_x_m, bounds.max_y_m)
    streets = []
    for name, parts in by_name.items():
        merged = shapely.line_merge(shapely.MultiLineString([way.line for way in parts])).intersection(frame)
        lines = sorted(lines_of(merged), key=lambda line: -_length(line))
        if lines and name:
            streets.append((max(way.width_m for way in parts), _length(lines[0]), name, lines))
    streets.sort(key=lambda street: (-round(street[0]), -street[1], street[2]))
    halos: list[MarkPath] = []
    for width_m, _, name, lines in streets:
        size_pt = 7.6 if width_m >= 7.5 else 6.6 if width_m >= 4.0 else 5.6
        spines: list[FloatArray] = []
        for line in lines[:6]:
            spines += _along(board, line, room, _Line(name, size_pt), spines)
        halos += [_bent(spine, _Line(name, size_pt), board.metres_per_point) for spine in spines]
        if len(halos) >= limit:
            break
    background = mix(board.palette.ground[Ground.ROAD], "#ffffff", 0.75)
    for face, edge, width, zorder in ((background, background, 2.4, 7.0), (colour, "none", 0.0, 7.1)):
        board.axes.add_collection(
            PathCollection(halos, facecolors=face, edgecolors=edge, linewidths=width, zorder=zorder, joinstyle="round"),
            autolim=False,
        )


def _length(line: FloatArray) -> float:
    return float(np.hypot(*np.diff(line, axis=0).T).sum())


def _along(
    board: Board, line: FloatArray, room: Room, letters: _Line, others: Sequence[FloatArray]
) -> list[FloatArray]:
    """Return the stretches of a line where there is room for a name, away from the others that bear it already."""
    long_m = width_pt(letters.text, "sans", letters.size_pt) * board.metres_per_point
    if long_m <= 0.0 or _length(line) < long_m * 1.08:
        return []
    course = _course(line, board.metres_per_point * 2.0)
    length_m = float(course.at_m[-1])
    copies = max(1, int(length_m / (_REPEAT_PT * board.metres_per_point)))
    placed: list[FloatArray] = []
    for copy in range(copies):
        low, high = length_m * copy / copies, length_m * (copy + 1) / copies
        best = 0.5 * (low + high - long_m)
        step = max(long_m * 0.2, 3.0 * board.metres_per_point, (high - low) / 60.0)
        starts = np.arange(low, max(high - long_m, low + 1e-6), step)
        for start in starts[np.argsort(np.abs(starts - best), kind="stable")].tolist():
            spine = _spine(course, start, long_m, board.metres_per_point)
            if spine is None or _closest_m(spine, [*others, *placed]) < _APART_PT * board.metres_per_point:
                continue
            if room.take(spine, letters.size_pt * 0.62):
                placed.append(spine)
                break
    return placed


def _closest_m(spine: FloatArray, others: Sequence[FloatArray]) -> float:
    middle = spine[len(spine) // 2]
    return min((float(np.hypot(*(middle - other[len(other) // 2]))) for other in others), default=math.inf)


def _course(line: FloatArray, step_m: float) -> _Course:
    steps = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
    count = min(max(int(steps[-1] / max(step_m, 1e-9)), 8), 4000)
    at_m = np.linspace(0.0, steps[-1], count)
    points = np.column_stack([np.interp(at_m, steps, line[:, 0]), np.interp(at_m, steps, line[:, 1])])
    for _ in range(6):
        points[1:-1] = 0.25 * points[:-2] + 0.5 * points[1:-1] + 0.25 * points[2:]
    return _Course(points, np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))]))


def _spine(course: _Course, start_m: float, long_m: float, metres_per_point: float) -> FloatArray | None:
    """Return the stretch that a name would stand on, left to right, or None where it turns too sharply to read."""
    stops = np.linspace(start_m, start_m + long_m, max(6, int(long_m / metres_per_point / 4.0)))
    if stops[-1] > course.at_m[-1]:
        return None
    line = course.points
    spine = np.column_stack([np.interp(stops, course.at_m, line[:, 0]), np.interp(stops, course.at_m, line[:, 1])])
    if spine[-1, 0] < spine[0, 0]:
        spine = spine[::-1]
    turns = _directions(spine)
    if np.ptp(turns) > 0.7 or np.abs(np.diff(turns)).max() > 0.22:
        return None
    return spine


def _directions(spine: FloatArray) -> FloatArray:
    return np.unwrap(np.arctan2(np.diff(spine[:, 1]), np.diff(spine[:, 0])))


def _bent(spine: FloatArray, letters: _Line, metres_per_point: float) -> MarkPath:
    """Return a name's outlines, bent along a stretch of street."""
    face, text = set_in("sans", letters.text)
    flat = TextPath((0.0, 0.0), text, size=letters.size_pt, prop=font(face))
    along = flat.vertices[:, 0] * metres_per_point
    above = (flat.vertices[:, 1] - 0.36 * letters.size_pt) * metres_per_point
    travelled = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(spine, axis=0).T))])
    angle = np.interp(along, 0.5 * (travelled[1:] + travelled[:-1]), _directions(spine))
    x = np.interp(along, travelled, spine[:, 0]) - above * np.sin(angle)
    y = np.interp(along, travelled, spine[:, 1]) + above * np.cos(angle)
    return MarkPath(np.column_stack([x, y]), flat.codes)


@dataclass(frozen=True, slots=True)
class _Name:
    """A name that could stand on the map: the lower its order, the sooner it is placed."""

    order: tuple[float, ...]
    text: str
    x_m: float
    y_m: float
    size_pt: float
    face: str
    colour: str
    beside_pt: float  # 0: centred on the point; else how far beside it


def letter_places(board: Board, world: World, room: Room, *, limit: int | None = None) -> None:
    """Write the names of parks, waters, squares, buildings and of the objects that have one, sparsely."""
    area_pt = board.points(board.bounds.width_m) * board.points(board.bounds.height_m)
    limit = limit if limit is not None else int(area_pt / 9000.0)
    written: set[str] = set()
    names = sorted(
        [*_region_names(board, world), *_object_names(board, world)], key=lambda name: (name.order, name.text)
    )
    for name in names:
        if len(written) >= limit:
            return
        if name.text and name.text not in written and _write_name(board, room, name):
            written.add(name.text)


def _region_names(board: Board, world: World) -> list[_Name]:
    names = []
    bounds = board.bounds
    frame = shapely.box(bounds.min_x_m, bounds.min_y_m, bounds.max_x_m, bounds.max_y_m)
    tints = {Ground.WATER: "#2a6591", Ground.PLAZA: "#7a5a24", Ground.RAILWAY: "#5b5350"}
    for region in world.regions:
        if not region.name or len(region.outer) < 3 or not board.shows(region.outer):
            continue
        shown = polygon_of(region.outer, region.holes).intersection(frame)
        if shown.is_empty or shown.area <= 0.0:
            continue
        middle = shown.representative_point()
        extent_pt = board.points(math.sqrt(shown.area))
        if extent_pt < 24.0:
            continue
        size_pt = min(max(5.5 + extent_pt / 45.0, 6.5), 13.0)
        colour = tints.get(region.ground, "#3f6b2d")
        names.append(
            _Name((0.0, -shown.area), printable(region.name), middle.x, middle.y, size_pt, "serif-italic", colour, 0.0)
        )
    for building in world.buildings:
        if building.name and len(building.outer) >= 3 and board.shows(building.outer):
            shape = polygon_of(building.outer)
            if shape.is_empty or board.points(math.sqrt(shape.area)) < 30.0:
                continue
            middle = shape.representative_point()
            names.append(
                _Name((2.0, -shape.area), printable(building.name), middle.x, middle.y, 6.0, "sans", "#6b5846", 0.0)
            )
    return names


def _object_names(board: Board, world: World) -> list[_Name]:
    names = []
    for item in world.objects:
        text = printable(item.attributes.get("name", ""))
        symbol = symbol_of(item.class_name)
        if not text or symbol.rank < 2 or not board.shows_point(item.x_m, item.y_m):
            continue
        landmark = symbol.family == "culture" or item.class_name in {"fountain", "playground", "library"}
        order = (1.0 if landmark and symbol.rank == 3 else 3.0 if landmark else 4.0, -float(symbol.rank))
        colour = mix(FAMILY_COLOURS[symbol.family], "#22272e", 0.25)
        beside = badge_radius_pt(board, symbol.rank) + 2.0
        names.append(_Name(order, text, item.x_m, item.y_m, 6.2 if landmark else 5.5, "sans", colour, beside))
    return names


def _write_name(board: Board, room: Room, name: _Name) -> bool:
    """Write a name in one or two lines where there is room: in the middle, or right, left, below or above its point."""
    lines = _broken(shortened(name.text, 44))
    face = name.face
    widest = max(width_pt(line, face, name.size_pt) for line in lines)
    leading = name.size_pt * 1.12
    high = leading * len(lines)
    gap = name.beside_pt
    spots: list[tuple[float, float]] = [(0.0, 0.0)]
    if gap > 0.0:
        aside, above = gap + widest / 2, gap + high / 2
        spots = [(aside, 0.0), (-aside, 0.0), (0.0, -above), (0.0, above)]
    scale = board.metres_per_point
    for shift_x, shift_y in spots:
        x, y = name.x_m + shift_x * scale, name.y_m + shift_y * scale
        rows = [y + (high / 2 - leading * (row + 0.5)) * scale for row in range(len(lines))]
        reach = np.linspace(-widest / 2, widest / 2, max(2, int(widest / 4.0))) * scale
        cover = np.array([(x + dx, row) for row in rows for dx in reach])
        if room.take(cover, name.size_pt * 0.6):
            for line, row in zip(lines, rows, strict=True):
                put_text(
                    board.axes,
                    x,
                    row - 0.35 * name.size_pt * scale,
                    line,
                    size_pt=name.size_pt,
                    face=face,
                    colour=name.colour,
                    align="center",
                    halo=board.palette.paper,
                    halo_pt=1.1,
                )
            return True
    return False


def _broken(text: str) -> list[str]:
    """Return a name in one line, or in two of about the same length where it is long."""
    if len(text) <= 16 or " " not in text:
        return [text]
    gaps = [place for place, character in enumerate(text) if character == " "]
    best = min(gaps, key=lambda place: abs(place - len(text) / 2))
    return [text[:best], text[best + 1 :]]
