"""A picture of a world, as one would hang it on a wall: map, names, legend, scale and thanks."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from matplotlib.patches import Circle, Patch, Rectangle

from reasoned_explorer.model.checks import kind_faults, path_of
from reasoned_explorer.model.errors import Fault, WorldError
from reasoned_explorer.model.stopping import stop_if_asked
from reasoned_explorer.world.drawing_style import Palette, mix, printable, width_pt, wrapped
from reasoned_explorer.world.lettering import Room, letter_places, letter_streets, place_badges
from reasoned_explorer.world.painting import Board, paint_world
from reasoned_explorer.world.sheet import (
    WIDTH_PT,
    Sheet,
    check_target,
    draw_north_arrow,
    draw_scale_bar,
    plain_settings,
    save,
    swatch,
)
from reasoned_explorer.world.symbols import FAMILY_ORDER, symbol_of
from reasoned_explorer.world.taxonomy import CLASS_NAMES, OBJECT_CLASSES, Ground
from reasoned_explorer.world.world import Bounds, World

MARGIN_PT = 30.0
#: No map is narrower than this many metres; closer than that there is nothing to see.
LEAST_EXTENT_M = 20.0
#: Height over width of the map's frame; a world of another shape gets a wider or higher view.
_SHAPES = (0.42, 1.5)
#: Less unknown ground than this, as a share, goes without saying.
_LEAST_SHARE = 0.001
_LEGEND_ROW_PT = 14.5
_LEGEND_COLUMNS = 5
_PAINTED = frozenset({"tree", "shrub", "car", "lawn"})


@dataclass(frozen=True, slots=True)
class LegendEntry:
    """A line of the legend: a ground or a class of objects."""

    text: str
    ground: Ground | None = None
    class_name: str = ""


def draw_world(
    world: World,
    path: Path | str,
    *,
    bounds: Bounds | None = None,
    width_px: int = 2400,
    labels: bool = True,
    title: str | None = None,
) -> None:
    """Draw a map of a world into a file.

    The same world and options always give the same bytes (with the same version of matplotlib).

    Args:
        world: The world.
        path: PNG, SVG or PDF by its suffix; the folder must exist. A file that is there is replaced, but only by a
            whole one.
        bounds: What to show, ENU metres; all of the world if None. It is widened to a shape that makes a good sheet.
        width_px: Width of a PNG, 300 to 12000; an SVG or PDF is 12 inches wide.
        labels: Whether names are written on the map.
        title: Headline; the world's name if None.

    Raises:
        WorldError: If the bounds or the width are no good or the file cannot be written there; with all the reasons.
        PartError: If the disk fails, e.g. because it is full.
    """
    target = path_of(path, "map picture", WorldError)
    if kinds := kind_faults("the world", world, World, "a World") + kind_faults(
        "bounds", bounds, (Bounds, type(None)), "Bounds, or None for all"
    ):
        raise WorldError("map picture", kinds)
    shown = world.bounds if bounds is None else bounds
    faults = [*check_target(target, width_px), *_bounds_faults(shown)]
    if faults:
        raise WorldError("map picture", faults)
    headline = printable(title if title is not None else world.name, limit=300)
    with plain_settings():
        sheet = compose(world, bounds=shown, labels=labels, title=headline)
        save(sheet, target, width_px=width_px, title=headline, thanks=world.attribution, error=WorldError)


def _bounds_faults(bounds: Bounds) -> list[Fault]:
    edges = (bounds.min_x_m, bounds.min_y_m, bounds.max_x_m, bounds.max_y_m)
    shown = f"bounds {', '.join(f'{edge:g}' for edge in edges)}"
    if not all(math.isfinite(edge) and abs(edge) <= 1e7 for edge in edges):
        return [Fault(shown, "finite metres east and north of the origin, at most 10,000 km away")]
    if bounds.width_m < 0 or bounds.height_m < 0:
        return [Fault(shown, "west below east and south below north, in metres: west, south, east, north")]
    return []


def fitted_bounds(bounds: Bounds, *, shapes: tuple[float, float], least_m: float) -> Bounds:
    """Return bounds about the same middle that hold the given ones, at least ``least_m`` wide and high.

    Args:
        bounds: What must be seen.
        shapes: The least and the greatest height over width.
        least_m: Least extent, metres.
    """
    width, height = max(bounds.width_m, least_m), max(bounds.height_m, least_m)
    width = max(width, height / shapes[1])
    height = max(height, width * shapes[0])
    middle_x, middle_y = 0.5 * (bounds.min_x_m + bounds.max_x_m), 0.5 * (bounds.min_y_m + bounds.max_y_m)
    return Bounds(middle_x - width / 2, middle_y - height / 2, middle_x + width / 2, middle_y + height / 2)


def compose(world: World, *, bounds: Bounds, labels: bool, title: str) -> Sheet:
    """Return the sheet with everything on it; to be called with plain settings of matplotlib."""
    shown = fitted_bounds(bounds, shapes=_SHAPES, least_m=LEAST_EXTENT_M)
    map_width = WIDTH_PT - 2 * MARGIN_PT
    map_height = map_width * shown.height_m / shown.width_m
    share = unknown_share(world)
    entries = legend_entries(world, shown, unknown=share is None or share >= _LEAST_SHARE)
    rows = math.ceil(len(entries) / _LEGEND_COLUMNS)
    small = [(line, "sans") for line in wrapped(_caption(world, share), "sans", 8.0, map_width, 3)]
    small += [(line, "sans-bold") for line in wrapped(world.attribution, "sans-bold", 8.0, map_width, 3)]
    headline = wrapped(title, "serif-bold", 27.0, map_width - 10.0, 2)
    head = 34.0 + 30.0 * max(len(headline), 1) + 14.0
    foot = 54.0 + rows * _LEGEND_ROW_PT + 12.0 + 11.0 * len(small) + 22.0
    sheet = Sheet(map_height + head + foot, Palette())
    axes = sheet.map_axes(MARGIN_PT, foot, map_width, map_height, shown)
    board = Board(axes, shown, shown.width_m / map_width, sheet.palette)
    paint_world(board, world)
    stop_if_asked()
    room = Room(board)
    if labels:
        letter_streets(board, world.ways, room, colour="#4a4f57")
    stop_if_asked()
    place_badges(board, world.objects, room)
    stop_if_asked()
    if labels:
        letter_places(board, world, room)
    _write_head(sheet, headline, _summary(world))
    _write_foot(sheet, entries, small, foot, board.metres_per_point)
    return sheet


def legend_entries(world: World, shown: Bounds, *, unknown: bool = True) -> list[LegendEntry]:
    """Return what a map's legend must explain: the grounds and the classes that occur on it.

    Args:
        world: The world.
        shown: What the map shows.
        unknown: Whether any of its ground is unknown.
    """
    probe = Board.__new__(Board)
    object.__setattr__(probe, "bounds", shown)
    grounds = {region.ground for region in world.regions if probe.shows(region.outer)}
    grounds |= {way.ground for way in world.ways if way.level >= 0 and probe.shows(way.line)}
    if any(probe.shows(building.outer) for building in world.buildings):
        grounds.add(Ground.BUILDING)
    classes = {item.class_name for item in world.objects if probe.shows_point(item.x_m, item.y_m)}
    entries = [LegendEntry(ground.noun, ground=ground) for ground in Ground if ground in grounds and ground.value]
    if unknown:
        entries.append(LegendEntry(Ground.UNKNOWN.noun, ground=Ground.UNKNOWN))
    order = {name: (FAMILY_ORDER.index(symbol_of(name).family), CLASS_NAMES.index(name)) for name in classes}
    entries.extend(
        LegendEntry(OBJECT_CLASSES[name].noun, class_name=name) for name in sorted(classes, key=order.__getitem__)
    )
    return entries


def unknown_share(world: World) -> float | None:
    """Return the share of what is not built on whose ground is unknown, 0 to 1; None where a world is nil or vast."""
    if not (world.bounds.width_m >= 1.0 and world.bounds.height_m >= 1.0 and world.bounds.area_km2 <= 100.0):
        return None
    from reasoned_explorer.world.raster import GroundRaster  # here, since a machine-code compiler comes with it

    return float(GroundRaster.of(world, cell_m=1.0).unknown_share)


def _summary(world: World) -> str:
    extent = f"{_metres(world.bounds.width_m)} × {_metres(world.bounds.height_m)}"
    return " · ".join(
        [extent, _count(len(world.buildings), "building", "buildings"), _count(len(world.objects), "object", "objects")]
    )


def _metres(length_m: float) -> str:
    return f"{length_m / 1000.0:.2f} km" if length_m >= 1000.0 else f"{length_m:.0f} m"


def _count(number: int, one: str, many: str) -> str:
    return f"{number:,} {one if number == 1 else many}"


def _caption(world: World, share: float | None) -> str:
    parts = [world.source or "World without a stated source"]
    if world.origin is not None:
        north = "N" if world.origin.lat_deg >= 0 else "S"
        east = "E" if world.origin.lon_deg >= 0 else "W"
        parts.append(f"about {abs(world.origin.lat_deg):.4f}° {north}, {abs(world.origin.lon_deg):.4f}° {east}")
    if share is not None and share < _LEAST_SHARE:
        parts.append("all ground known")
    elif share is not None:
        parts.append(f"ground unknown on {max(share, 0.01):.0%} of what is not built on")
    if any(region.ground is Ground.WOOD for region in world.regions):
        parts.append("light crowns inside woods are a pattern, not single trees")
    return ". ".join(part[0].upper() + part[1:] for part in parts if part) + "."


def _write_head(sheet: Sheet, headline: Sequence[str], summary: str) -> None:
    y = sheet.height_pt - 34.0
    for line in headline:
        y -= 20.0 if line is headline[0] else 30.0
        sheet.write(MARGIN_PT - 1.0, y, line, size_pt=27.0, face="serif-bold")
    room = WIDTH_PT - 2 * MARGIN_PT
    last = width_pt(headline[-1], "serif-bold", 27.0) if headline else 0.0
    if last + width_pt(summary, "sans", 9.0) + 30.0 < room:
        sheet.write(WIDTH_PT - MARGIN_PT, y, summary, size_pt=9.0, colour=sheet.palette.soft_ink, align="right")


def _write_foot(
    sheet: Sheet,
    entries: Sequence[LegendEntry],
    small: Sequence[tuple[str, str]],
    foot_pt: float,
    metres_per_point: float,
) -> None:
    top = foot_pt - 26.0
    draw_scale_bar(sheet, MARGIN_PT + 2.0, top, metres_per_point)
    draw_north_arrow(sheet, WIDTH_PT - MARGIN_PT - 10.0, top - 2.0)
    y = top - 28.0
    rows = math.ceil(len(entries) / _LEGEND_COLUMNS)
    wide = (WIDTH_PT - 2 * MARGIN_PT) / _LEGEND_COLUMNS
    for place, entry in enumerate(entries):
        column, row = divmod(place, rows)
        draw_entry(sheet, MARGIN_PT + column * wide, y - row * _LEGEND_ROW_PT, entry, room_pt=wide - 30.0)
    y -= rows * _LEGEND_ROW_PT + 2.0
    sheet.rule(MARGIN_PT, WIDTH_PT - MARGIN_PT, y + 4.0)
    for line, face in small:
        y -= 11.0
        sheet.write(MARGIN_PT, y, line, size_pt=8.0, face=face, colour=sheet.palette.soft_ink)


def draw_entry(sheet: Sheet, x_pt: float, y_pt: float, entry: LegendEntry, *, room_pt: float) -> None:
    """Draw one line of a legend, its text's baseline at ``y_pt``."""
    palette = sheet.palette
    if entry.ground is not None:
        colour = palette.roof[0] if entry.ground is Ground.BUILDING else palette.ground[entry.ground]
        hatch = mix(palette.hatch, palette.soft_ink, 0.15) if entry.ground is Ground.UNKNOWN else None
        swatch(sheet, x_pt, y_pt - 1.5, colour, hatch=hatch)
    elif entry.class_name in _PAINTED:
        _draw_painted(sheet, x_pt + 7.5, y_pt + 3.0, entry.class_name)
    else:
        sheet.badge(x_pt + 7.5, y_pt + 3.0, symbol_of(entry.class_name), 5.6)
    sheet.write(x_pt + 21.0, y_pt, entry.text, size_pt=8.5, room_pt=room_pt)


def _draw_painted(sheet: Sheet, x_pt: float, y_pt: float, class_name: str) -> None:
    """Draw what stands on the map as itself and not as a symbol: a crown, a car, the outline of a lawn."""
    crown = sheet.palette.crowns[0]
    shapes: list[Patch]
    if class_name == "car":
        car = Rectangle((x_pt - 6.0, y_pt - 2.6), 12.0, 5.2, facecolor="#8d949c", edgecolor="#4b5058", linewidth=0.5)
        window = Rectangle((x_pt + 1.2, y_pt - 2.0), 2.2, 4.0, facecolor="#4b5058")
        shapes = [car, window]
    elif class_name == "lawn":
        outline = Rectangle((x_pt - 7.0, y_pt - 4.0), 14.0, 8.0, facecolor=sheet.palette.ground[Ground.GRASS])
        outline.set(edgecolor="#7fa35f", linewidth=0.6, linestyle=(0, (2.5, 1.8)))
        shapes = [outline]
    else:
        radius = 6.2 if class_name == "tree" else 3.6
        shapes = [
            Circle((x_pt - shift * radius, y_pt + shift * radius), size * radius, facecolor=mix(crown, "#f4f7d4", pale))
            for shift, size, pale in ((0.0, 1.0, 0.0), (0.14, 0.68, 0.2), (0.24, 0.36, 0.4))
        ]
    for shape in shapes:
        sheet.page.add_patch(shape)
