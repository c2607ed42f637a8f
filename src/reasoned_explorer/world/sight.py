"""What can be seen from where, what is hit on the way, and what stands in it.

A world is taken as two and a half dimensions: building walls are segments that reach from their underside to their
roof, crowns and trunks of trees are discs with a height band, large things are discs or boxes with their height. A line
of sight is hidden where it crosses one of these within its band.

What hides how much (assumed; leafy crowns in summer let roughly a third of the light of a horizontal line through):
walls all of it, tree crowns 70 %, bushes 90 %, and half-open things (shelters, umbrella tables, fountains, play
equipment) the shares of `_PASS_SHARE`. Things lower than a person's waist hide nothing.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING

import numpy as np
import shapely
from numpy.typing import NDArray

from reasoned_explorer.model import Fault, WorldError

if TYPE_CHECKING:
    from reasoned_explorer.world.sight_kernels import Grid, Targets
    from reasoned_explorer.world.world import Building, World, WorldObject

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

_CELL_M = 8.0
_MAX_CELLS = 2_000_000
_CROWN_BASE_SHARE = 0.35
_CROWN_PASS = 0.3
_BUSH_PASS = 0.1
#: The share of sight that half-open things let through; what is not named here lets none through.
_PASS_SHARE = {
    "shelter": 0.4,
    "outdoor_seating": 0.5,
    "fountain": 0.5,
    "swing": 0.85,
    "slide": 0.6,
    "bicycle_rental": 0.6,
    "bus_stop": 0.7,
}
#: Things from this height and mean width on hide what is behind them.
_HIDES_FROM_HEIGHT_M, _HIDES_FROM_WIDTH_M = 1.2, 0.45
#: Opaque things from this height and mean width on cut the judge's line of sight.
_BLOCKS_FROM_HEIGHT_M, _BLOCKS_FROM_WIDTH_M = 1.4, 0.9
#: Footprints longer than this many times their width collide as boxes, rounder and smaller ones as discs.
_OBLONG, _OBLONG_FROM_M = 1.6, 0.8
_SIMPLE_CORNERS, _BEND_M = 8, 0.5


class HitKind(IntEnum):
    """What ended a ray."""

    NOTHING = 0
    BUILDING = 1
    OBJECT = 2


@dataclass(frozen=True, slots=True, eq=False)
class Obstacles:
    """What is solid at one height somewhere.

    Attributes:
        walls: Shape (n, 4): x0, y0, x1, y1, ENU metres.
        wall_building: Shape (n,), int64: place in the world's list of buildings, or -1.
        wall_object: Shape (n,), int64: place in the world's list of objects, or -1.
        discs: Shape (m, 3): x, y, radius, metres.
        disc_object: Shape (m,), int64: place in the world's list of objects.
    """

    walls: FloatArray
    wall_building: IntArray
    wall_object: IntArray
    discs: FloatArray
    disc_object: IntArray


class SightLines:
    """Sight lines of one world; made with `SightLines.of`.

    Attributes:
        hiding: Grid over what hides: walls, crowns, trunks, large things.
        solid: Grid over what one collides with: walls, trunks, all solid things.
        targets: What can be looked for, one row per object of the world.
    """

    def __init__(self, hiding: "Grid", solid: "Grid", targets: "Targets") -> None:
        self.hiding = hiding
        self.solid = solid
        self.targets = targets

    @classmethod
    def of(cls, world: "World") -> "SightLines":
        """Build the grids of a world.

        Raises:
            WorldError: If a coordinate, size or height is NaN or infinite; all such buildings and objects are named.
        """
        _refuse_non_finite(world)
        hiding, solid = _Items(), _Items()
        for place, building in enumerate(world.buildings):
            for ring in (building.outer, *building.holes):
                for items in (hiding, solid):
                    items.add_ring(ring, (building.min_height_m, building.height_m), HitKind.BUILDING, place)
        for item in world.objects:
            _add_object(item, hiding, solid)
        return cls(hiding.grid(), solid.grid(), _targets(world))

    def clear(  # noqa: PLR0917 - two points
        self,
        from_x_m: float,
        from_y_m: float,
        from_z_m: float,
        to_x_m: float,
        to_y_m: float,
        to_z_m: float,
        *,
        ignore_object: int = -1,
    ) -> bool:
        """Return whether nothing cuts the line between two points.

        Building walls and large opaque things cut it; crowns, trunks, half-open and small things do not. What stands
        within 0.25 m of the second point does not either, since entrances and letter boxes are on walls.

        Args:
            from_x_m: Of the eye, ENU.
            from_y_m: Likewise.
            from_z_m: Its height, metres.
            to_x_m: Of what is looked at, ENU.
            to_y_m: Likewise.
            to_z_m: Its height, metres.
            ignore_object: An object that cuts nothing: the one that is looked at.
        """
        from reasoned_explorer.world.sight_kernels import END_M, pass_share

        eye, point = (from_x_m, from_y_m, from_z_m), (to_x_m, to_y_m, to_z_m)
        passed = pass_share(self.hiding, *_floats(*eye, *point), ignore_object, END_M, blocks_only=True)
        return bool(passed > 0.0)

    def clear_many(
        self, eyes_m: NDArray[np.float64], points_m: NDArray[np.float64], *, ignore_object: int = -1
    ) -> NDArray[np.bool_]:
        """Return what `clear` returns for many lines at once.

        Args:
            eyes_m: Where they begin, x, y and height, shape (n, 3).
            points_m: Where they end, likewise.
            ignore_object: An object that cuts nothing.
        """
        from reasoned_explorer.world.sight_kernels import clear_many

        eyes, points = (np.ascontiguousarray(side, dtype=np.float64) for side in (eyes_m, points_m))
        clear: NDArray[np.bool_] = clear_many(self.hiding, eyes, points, ignore_object)
        return clear

    def visible_share(self, x_m: float, y_m: float, z_m: float, object_id: int) -> float:
        """Return the share of an object that is seen from a point, in [0, 1].

        A fan of five directions over its width and three heights is cast (for an area: three depths). A place is seen
        from before its front only.

        Raises:
            IndexError: If there is no such object.
        """
        from reasoned_explorer.world import sight_kernels as kernels

        if not 0 <= object_id < len(self.targets.table):
            raise IndexError(f"object {object_id} of {len(self.targets.table)}")
        x, y, z = _floats(x_m, y_m, z_m)
        target = self.targets.table[object_id]
        heading = math.atan2(target[kernels.CENTRE_X] - x, target[kernels.CENTRE_Y] - y)
        axis = math.sin(heading), math.cos(heading)
        low, high, near, _ = kernels.extent(target, self.targets.corners, x, y, *axis)
        if high < low:
            return 0.0
        return float(
            kernels.target_share(self.hiding, self.targets, object_id, x, y, z, heading, low, high, near, 5, 3)
        )

    def cast(self, x_m: float, y_m: float, z_m: float, heading_rad: float, max_m: float) -> tuple[float, HitKind, int]:
        """Return (distance, kind, place in the world's list) of the first solid thing on a level ray.

        The distance is ``max_m``, the kind `HitKind.NOTHING` and the place -1 where the ray meets nothing. A ray that
        starts inside a thing meets it at 0.
        """
        from reasoned_explorer.world.sight_kernels import first_hit

        sine, cosine = math.sin(heading_rad), math.cos(heading_rad)
        distance_m, item = first_hit(self.solid, *_floats(x_m, y_m, z_m, sine, cosine, max_m), 0)
        if item < 0:
            return float(distance_m), HitKind.NOTHING, -1
        kind, place, _ = self.solid.owners[item]
        return float(distance_m), HitKind(int(kind)), int(place)

    def obstacles_near(
        self, x0_m: float, y0_m: float, x1_m: float, y1_m: float, *, z_m: float, margin_m: float
    ) -> Obstacles:
        """Return what is solid at a height in the rectangle around two points, widened by a margin.

        Places and areas are never solid; a tree is its trunk.
        """
        from reasoned_explorer.world.sight_kernels import gather, split

        west, east = sorted(_floats(x0_m, x1_m))
        south, north = sorted(_floats(y0_m, y1_m))
        found = gather(self.solid, west - margin_m, south - margin_m, east + margin_m, north + margin_m, float(z_m))
        return Obstacles(*split(self.solid, found))


def _floats(*values: float) -> tuple[float, ...]:
    # One type for all arguments: a kernel is compiled once for each combination of types.
    return tuple(float(value) for value in values)


def _refuse_non_finite(world: "World") -> None:
    faults = []
    for place, building in enumerate(world.buildings):
        values = [building.height_m, building.min_height_m]
        rings = (building.outer, *building.holes)
        if not (np.isfinite(values).all() and all(np.isfinite(ring).all() for ring in rings)):
            faults.append(Fault(f"building {place} has a coordinate or height that is no number", "finite metres"))
    for item in world.objects:
        # A sum is finite only if all its terms are (none is near the largest number there is).
        finite = math.isfinite(item.x_m + item.y_m + item.heading_rad + sum(item.size_m))
        if not finite or (item.outline is not None and not np.isfinite(item.outline).all()):
            faults.append(Fault(f"object {item.id} ({item.class_name}) has a value that is no number", "finite metres"))
    if faults:
        raise WorldError(f"world {world.name!r}", faults)


class _Items:
    """Walls and discs that are being collected."""

    def __init__(self) -> None:
        self._rows: list[tuple[float, ...]] = []
        self._owners: list[tuple[int, int, bool]] = []

    def add_ring(
        self,
        ring: FloatArray,
        band_m: tuple[float, float],
        kind: HitKind,
        place: int,
        *,
        passes: float = 0.0,
        blocks: bool = True,
    ) -> None:
        """Add a closed ring of walls; a ray crosses two of them, so each lets the root of the share through."""
        passes = math.sqrt(passes)
        self._rows.extend((0.0, *a, *b, *band_m, passes) for a, b in _edges(ring))
        self._owners.extend([(kind, place, blocks)] * len(ring))

    def add_disc(
        self, item: "WorldObject", radius_m: float, band_m: tuple[float, float], *, passes: float, blocks: bool
    ) -> None:
        """Add a disc of an object."""
        self._rows.append((1.0, item.x_m, item.y_m, radius_m, 0.0, *band_m, passes))
        self._owners.append((HitKind.OBJECT, item.id, blocks))

    def grid(self) -> "Grid":
        """Build the grid."""
        items = np.array(self._rows, dtype=np.float64).reshape(-1, 8)
        return make_grid(items, np.array(self._owners, dtype=np.int64).reshape(-1, 3), cell_m=_CELL_M)


def make_grid(items: FloatArray, owners: IntArray, *, cell_m: float) -> "Grid":
    """Return a grid over walls and discs (the tables are those of `sight_kernels.Grid`).

    Cells are made larger than ``cell_m`` where there would be more than two million of them.
    """
    from reasoned_explorer.world.sight_kernels import Grid, fill_grid

    if len(items):
        discs = items[:, 0] >= 1.0
        reach = np.where(discs, items[:, 3], 0.0)
        end_x, end_y = np.where(discs, items[:, 1], items[:, 3]), np.where(discs, items[:, 2], items[:, 4])
        west, east = (np.minimum(items[:, 1], end_x) - reach).min(), (np.maximum(items[:, 1], end_x) + reach).max()
        south, north = (np.minimum(items[:, 2], end_y) - reach).min(), (np.maximum(items[:, 2], end_y) + reach).max()
    else:
        west = east = south = north = 0.0
    width, depth = east - west + 2.0, north - south + 2.0
    cell_m = max(cell_m, math.sqrt(width * depth / _MAX_CELLS), max(width, depth) / 100_000)
    header = np.array([west - 1.0, south - 1.0, cell_m, math.ceil(width / cell_m), math.ceil(depth / cell_m)])
    starts, members = fill_grid(items, header)
    return Grid(header, starts, members, items, owners)


def _add_object(item: "WorldObject", hiding: _Items, solid: _Items) -> None:
    length_m, width_m, height_m = item.size_m
    radius_m = 0.25 * (length_m + width_m)
    if item.class_name == "tree":
        trunk_m = min(max(0.12 + 0.02 * height_m, 0.15), 0.4)
        hiding.add_disc(item, radius_m, (_CROWN_BASE_SHARE * height_m, height_m), passes=_CROWN_PASS, blocks=False)
        # Below the crown only: within it the trunk is hidden and hides no more than the leaves.
        hiding.add_disc(item, trunk_m, (0.0, _CROWN_BASE_SHARE * height_m), passes=0.0, blocks=False)
        solid.add_disc(item, trunk_m, (0.0, height_m), passes=0.0, blocks=False)
        return
    if not item.object_class.solid:
        return
    passes = _BUSH_PASS if item.class_name == "shrub" else _PASS_SHARE.get(item.class_name, 0.0)
    large = height_m >= _HIDES_FROM_HEIGHT_M and 2.0 * radius_m >= _HIDES_FROM_WIDTH_M
    blocks = passes == 0.0 and height_m >= _BLOCKS_FROM_HEIGHT_M and 2.0 * radius_m >= _BLOCKS_FROM_WIDTH_M
    for items in (hiding, solid) if large else (solid,):
        ring = _walls_of(item)
        if ring is None:
            items.add_disc(item, radius_m, (0.0, height_m), passes=passes, blocks=blocks)
        else:
            items.add_ring(ring, (0.0, height_m), HitKind.OBJECT, item.id, passes=passes, blocks=blocks)


def _walls_of(item: "WorldObject") -> FloatArray | None:
    """The outline of what is not round: its own on the map, or the box of its size; None for what is taken as round."""
    if item.outline is not None and len(item.outline) >= 3 and _area_m2(item.outline) > 0.25:
        return np.asarray(item.outline, dtype=np.float64)
    return _box(item) if _is_oblong(item) else None


def _is_oblong(item: "WorldObject") -> bool:
    short_m, long_m = sorted(item.size_m[:2])
    return long_m >= _OBLONG_FROM_M and long_m > _OBLONG * short_m


def _box(item: "WorldObject") -> FloatArray:
    sine, cosine = math.sin(item.heading_rad), math.cos(item.heading_rad)
    # From the centre to the right hand side (cos, -sin) and to the front (sin, cos).
    right_x, right_y = 0.5 * item.size_m[0] * cosine, -0.5 * item.size_m[0] * sine
    front_x, front_y = 0.5 * item.size_m[1] * sine, 0.5 * item.size_m[1] * cosine
    sides = ((1, 1), (1, -1), (-1, -1), (-1, 1))
    return np.array([(item.x_m + u * right_x + v * front_x, item.y_m + u * right_y + v * front_y) for u, v in sides])


def _area_m2(ring: FloatArray) -> float:
    x, y = ring[:, 0] - ring[0, 0], ring[:, 1] - ring[0, 1]
    return 0.5 * abs(float(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1))))


def _targets(world: "World") -> "Targets":
    from reasoned_explorer.world import sight_kernels as kernels

    rows: list[tuple[float, ...]] = []
    corners: list[FloatArray] = []
    placed = 0
    for item in world.objects:
        length_m, width_m, height_m = item.size_m
        x_m, y_m, normal, first, centre = item.x_m, item.y_m, (0.0, 0.0), placed, (item.x_m, item.y_m)
        kind = item.object_class.kind
        if kind == "area":
            shape = kernels.AREA
            ring = _simplified(item.outline) if item.outline is not None and len(item.outline) >= 3 else _box(item)
            (west, south), (east, north) = ring.min(axis=0), ring.max(axis=0)
            centre = 0.5 * (west + east), 0.5 * (south + north)
            corners.append(np.asarray(ring, dtype=np.float64))
            placed += len(ring)
        elif kind == "place" and 0 <= item.building < len(world.buildings):
            shape = kernels.FRONT
            x_m, y_m, normal_x, normal_y = _front(item, world.buildings[item.building])
            normal = normal_x, normal_y
        elif _is_oblong(item):
            shape = kernels.BOX
        else:
            shape = kernels.ROUND
            length_m = width_m = 0.5 * (length_m + width_m)
        turned = math.sin(item.heading_rad), math.cos(item.heading_rad)
        halves = 0.5 * length_m, 0.5 * width_m
        rows.append((x_m, y_m, *halves, height_m, *turned, shape, *normal, first, placed, *centre))
    table = np.array(rows, dtype=np.float64).reshape(-1, 14)
    return kernels.Targets(table, np.concatenate(corners) if corners else np.empty((0, 2)))


def _simplified(ring: FloatArray) -> FloatArray:
    """A ring with its bends of less than half a metre left out: a lawn's edge is not sharper than that."""
    if len(ring) <= _SIMPLE_CORNERS:
        return ring
    outline = shapely.simplify(shapely.Polygon(ring), _BEND_M, preserve_topology=True)
    return np.asarray(shapely.get_coordinates(outline)[:-1], dtype=np.float64)


def _front(item: "WorldObject", building: "Building") -> tuple[float, float, float, float]:
    """A point a hand's breadth before a place's wall and the wall's outward normal."""
    best = (math.inf, item.x_m, item.y_m, math.sin(item.heading_rad), math.cos(item.heading_rad))
    for ring in (building.outer, *building.holes):
        for (ax, ay), (bx, by) in _edges(ring):
            dx, dy = bx - ax, by - ay
            length = math.hypot(dx, dy)
            if length < 1e-6:
                continue
            share = min(max(((item.x_m - ax) * dx + (item.y_m - ay) * dy) / length**2, 0.0), 1.0)
            x, y = ax + share * dx, ay + share * dy
            distance = math.hypot(item.x_m - x, item.y_m - y)
            # Of two walls that meet at the entrance take the one that faces the way that the place does.
            facing = (dy * math.sin(item.heading_rad) - dx * math.cos(item.heading_rad)) / length
            if distance - 1e-3 * abs(facing) < best[0]:
                best = (distance - 1e-3 * abs(facing), x, y, dy / length, -dx / length)
    _, x, y, normal_x, normal_y = best
    middle_x, middle_y = x + 0.05 * normal_x, y + 0.05 * normal_y
    if _inside(building, middle_x, middle_y):
        normal_x, normal_y = -normal_x, -normal_y
    return x + 0.1 * normal_x, y + 0.1 * normal_y, normal_x, normal_y


def _edges(ring: FloatArray) -> Iterator[tuple[tuple[float, float], tuple[float, float]]]:
    points: list[tuple[float, float]] = ring.tolist()
    return zip(points, points[1:] + points[:1], strict=True)


def _inside(building: "Building", x: float, y: float) -> bool:
    inside = False
    for ring in (building.outer, *building.holes):
        for (ax, ay), (bx, by) in _edges(ring):
            if (ay > y) != (by > y) and x < (bx - ax) * (y - ay) / (by - ay) + ax:
                inside = not inside
    return inside
