"""Street networks: warped grids, avenues, dead ends, junctions and crossings."""

import math
from collections.abc import Callable

import numpy as np
import shapely
from numpy.random import Generator
from numpy.typing import NDArray
from shapely import LineString, Polygon

from reasoned_explorer.world.generator import planar
from reasoned_explorer.world.generator.shapes import Points, bow, smooth
from reasoned_explorer.world.generator.sketch import Sketch, Street, Trail
from reasoned_explorer.world.taxonomy import Ground

#: Maps grid coordinates, shape (n, 2), to the ground, shape (n, 2).
Warp = Callable[[Points], Points]

#: A crossing: its middle, the unit direction of the street away from the junction, half the carriageway, metres.
Crossing = tuple[Points, Points, float]

_FIRST = (
    *("Linden", "Harbour", "Mill", "Station", "Chapel", "Market", "Orchard", "Queen", "Bishop", "Forge", "River"),
    *("Garden", "School", "Castle", "Maple", "Quarry", "Abbey", "Tanner", "Weaver", "Bridge", "North", "South"),
    *("Alder", "Beacon", "Cooper", "Dove", "Elm", "Ferry", "Granary", "Hazel", "Ivy", "Juniper", "Kiln", "Lark"),
)
_LAST = ("Street", "Street", "Street", "Road", "Lane", "Row")

#: Widths by kind: carriageway and each pavement, metres; typical of European towns (assumed).
WIDTHS_M: dict[str, tuple[float, float]] = {
    "primary": (13.0, 4.5),
    "secondary": (11.0, 4.0),
    "residential": (9.0, 3.2),
    "living_street": (7.5, 2.6),
    "service": (5.5, 2.5),
    "pedestrian": (0.0, 4.5),
}


def street_name(rng: Generator) -> str:
    """Return a made-up street name."""
    return f"{_FIRST[int(rng.integers(len(_FIRST)))]} {_LAST[int(rng.integers(len(_LAST)))]}"


def add_street(
    sketch: Sketch,
    rng: Generator,
    line: Points,
    kind: str,
    *,
    within: Polygon | None = None,
    trees: float | None = None,
) -> list[Street]:
    """Draw a street, cut to an area, and return its pieces."""
    road, pavement = WIDTHS_M[kind]
    name = street_name(rng)
    parking = kind in ("residential", "secondary", "living_street") and rng.random() < 0.85
    lined = {"primary": 0.9, "secondary": 0.7, "residential": 0.45, "living_street": 0.5, "pedestrian": 0.5}
    spacing = float(rng.uniform(10.0, 16.0)) if rng.random() < lined.get(kind, 0.0) else 0.0
    pieces = [
        Street(part, kind, road, pavement, parking, spacing if trees is None else trees, name)
        for part in planar.lines_within(line, sketch.box if within is None else within)
    ]
    sketch.streets.extend(pieces)
    return pieces


def ticks(rng: Generator, start: float, end: float, spacing: tuple[float, float]) -> NDArray[np.float64]:
    """Return irregular positions from start to end or a little beyond."""
    values = [start]
    while values[-1] < end:
        values.append(values[-1] + float(rng.uniform(*spacing)))
    return np.array(values)


def even_ticks(rng: Generator, length: float, spacing: float, *, jitter: float = 0.12) -> NDArray[np.float64]:
    """Return positions that divide 0 … length into about equal stretches, both ends included."""
    count = max(1, round(length / spacing))
    values = np.linspace(0.0, length, count + 1)
    values[1:-1] += rng.uniform(-jitter, jitter, count - 1) * length / count
    return values


def rotation(centre: tuple[float, float], angle_rad: float) -> Warp:
    """Return a warp that turns a plane grid about a point."""
    cosine, sine = math.cos(angle_rad), math.sin(angle_rad)
    matrix = np.array([[cosine, sine], [-sine, cosine]])

    def warp(points: Points) -> Points:
        result: Points = points @ matrix + centre
        return result

    return warp


def quad_warp(quad: Polygon, width_m: float, height_m: float) -> Warp:
    """Return the bilinear warp of ``[0, width] × [0, height]`` onto a four-cornered cell."""
    a, b, c, d = np.asarray(quad.exterior.coords)[:4]

    def warp(points: Points) -> Points:
        u, v = points[:, :1] / width_m, points[:, 1:] / height_m
        result: Points = (1 - u) * (1 - v) * a + u * (1 - v) * b + u * v * c + (1 - u) * v * d
        return result

    return warp


def grid_nodes(rng: Generator, us: Points, vs: Points, warp: Warp, jitter_m: float, *, frame: bool = False) -> Points:
    """Return the nodes of a warped and jittered grid.

    Args:
        rng: Draws.
        us: Positions of the columns.
        vs: Positions of the rows.
        warp: From grid to ground.
        jitter_m: Largest displacement along either axis.
        frame: Whether the outermost rows and columns stay where they are.

    Returns:
        Shape (len(us), len(vs), 2).
    """
    grid = np.stack(np.meshgrid(us, vs, indexing="ij"), axis=-1)
    shift = rng.uniform(-jitter_m, jitter_m, grid.shape)
    if frame:
        shift[[0, -1]] = 0.0
        shift[:, [0, -1]] = 0.0
    return warp((grid + shift).reshape(-1, 2)).reshape(grid.shape)


def draw_grid(
    sketch: Sketch,
    rng: Generator,
    nodes: Points,
    *,
    within: Polygon,
    kind_of: Callable[[int, int], str],
    missing: float = 0.0,
    curved: bool = False,
    frame: bool = False,
) -> list[Street]:
    """Draw the rows and columns of a grid as streets.

    Args:
        sketch: Where to draw.
        rng: Draws.
        nodes: Shape (n, m, 2).
        within: Streets are cut to it.
        kind_of: From axis (0: along the first index) and place of the line to the street's kind.
        missing: Share of stretches of the second axis that are left out, which merges blocks.
        curved: Whether streets run smoothly through the nodes.
        frame: Whether the outermost lines exist already and are not drawn.
    """
    drawn: list[Street] = []
    skip = 1 if frame else 0
    for row in range(skip, nodes.shape[1] - skip):
        line = nodes[:, row]
        drawn += add_street(sketch, rng, smooth(line) if curved else line, kind_of(0, row), within=within)
    for column in range(skip, nodes.shape[0] - skip):
        kind = kind_of(1, column)
        line = nodes[column]
        present = rng.random(len(line) - 1) >= (0.0 if kind in ("primary", "secondary") else missing)
        first = 0
        while first < len(present):
            if not present[first]:
                first += 1
                continue
            last = first
            while last < len(present) and present[last]:
                last += 1
            piece = line[first : last + 1]
            drawn += add_street(sketch, rng, smooth(piece) if curved else piece, kind, within=within)
            first = last
    return drawn


def junctions(streets: list[Street]) -> list[tuple[Points, int, int]]:
    """Return where two streets meet: the point and the places of the two streets, each pair once."""
    lines = np.array([LineString(street.line) for street in streets])
    if len(lines) < 2:
        return []
    tree = shapely.STRtree(lines)
    first, second = tree.query(lines, predicate="dwithin", distance=0.5)
    keep = first < second
    first, second = first[keep], second[keep]
    order = np.lexsort((second, first))
    found: list[tuple[Points, int, int]] = []
    for one, other in zip(first[order].tolist(), second[order].tolist(), strict=True):
        meeting = planar.intersection(lines[one], lines[other])
        if meeting.is_empty:
            meeting = shapely.get_point(shapely.shortest_line(lines[one], lines[other]), 0)
        found.extend((point, one, other) for point in shapely.get_coordinates(meeting)[:2])
    return found


def add_crossings(sketch: Sketch) -> list[Crossing]:
    """Draw crossings at the junctions of streets with carriageways.

    Returns:
        For each crossing the point in its middle, the unit direction of the street that it crosses, pointing away
        from the junction, and half the width of the carriageway, metres.
    """
    streets = sketch.streets
    lines = [LineString(street.line) for street in streets]
    made: list[Crossing] = []
    inner = planar.buffer(sketch.box, -3.0)
    for point, one, other in junctions(streets):
        for mine, theirs in ((one, other), (other, one)):
            if streets[mine].road_m <= 0:
                continue
            at = lines[mine].project(shapely.points(point))
            beyond = streets[theirs].road_m / 2 + 2.8
            for side in (-1.0, 1.0):
                where = at + side * beyond
                if not 2.0 < where < lines[mine].length - 2.0:
                    continue
                middle = np.array(lines[mine].interpolate(where).coords[0])
                ahead = np.array(lines[mine].interpolate(where + side * 1.0).coords[0]) - middle
                length = float(np.hypot(*ahead))
                if length < 0.2 or not inner.contains(shapely.points(middle)):
                    continue
                ahead /= length
                if any(np.hypot(*(middle - other_middle)) < 5.0 for other_middle, _, _ in made[-12:]):
                    continue
                across = np.array([-ahead[1], ahead[0]]) * (streets[mine].road_m / 2 + 0.6)
                ends = np.array([middle - across, middle + across])
                sketch.crossings.append(Trail(ends, 3.0, Ground.PAVEMENT, "footway"))
                made.append((middle, ahead, streets[mine].road_m / 2))
    return made


def avenue_across(sketch: Sketch, rng: Generator, area: Polygon) -> list[Street]:
    """Draw a diagonal avenue, slightly bent, through an area."""
    min_x, min_y, max_x, max_y = area.bounds
    centre = np.array([(min_x + max_x) / 2, (min_y + max_y) / 2]) + rng.uniform(-0.12, 0.12, 2) * (max_x - min_x)
    angle = rng.choice([-1.0, 1.0]) * rng.uniform(0.55, 1.0)
    reach = (max_x - min_x) * 0.9
    step = np.array([math.cos(angle), math.sin(angle)]) * reach
    return add_street(
        sketch, rng, bow(centre - step, centre + step, rng.uniform(-0.03, 0.03)), "primary", within=area, trees=9.0
    )
