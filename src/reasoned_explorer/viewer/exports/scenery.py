"""The ground, the buildings and the things around a mission, as triangles and boxes; ENU metres, z up."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

import numpy as np
import shapely
from numpy.typing import NDArray

from reasoned_explorer.viewer.exports.mission import ExportedMission
from reasoned_explorer.world.drawing_style import Palette
from reasoned_explorer.world.symbols import symbol_of
from reasoned_explorer.world.taxonomy import Ground
from reasoned_explorer.world.world import Building, World, WorldObject

#: So far around all that happened the world is written, metres.
NEAR_M = 150.0
#: Areas, and places inside of buildings, are marked where they are: their outline is the ground's or the building's.
_MARK_M = (0.6, 0.6, 0.6)
_MARKED = frozenset({"area", "place"})

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
_Shape: TypeAlias = shapely.geometry.base.BaseGeometry


@dataclass(frozen=True, slots=True, eq=False)
class Mesh:
    """Triangles of one colour.

    Attributes:
        name: What it is, e.g. ``"ground/grass"``.
        colour: ``"#rrggbb"``.
        vertices: Shape (n, 3).
        triangles: Places of vertices, shape (m, 3), counter-clockwise from outside.
    """

    name: str
    colour: str
    vertices: FloatArray
    triangles: IntArray


@dataclass(frozen=True, slots=True)
class Thing:
    """A thing that stands somewhere, as a box.

    Attributes:
        kind: Of its class: ``furniture``, ``plant`` …
        label: Its name, or what it is.
        colour: ``"#rrggbb"``.
        centre: x, y and z of the middle of the box.
        size: Along its own x (across its front), y and z axes, metres.
        yaw_rad: Turn of these axes, counter-clockwise from east.
    """

    kind: str
    label: str
    colour: str
    centre: tuple[float, float, float]
    size: tuple[float, float, float]
    yaw_rad: float


@dataclass(frozen=True, slots=True, eq=False)
class Scenery:
    """What stands around a mission.

    Attributes:
        meshes: Ground and buildings.
        things: Things, in the order of the world.
        names: Names of buildings: text, and where it hangs.
    """

    meshes: tuple[Mesh, ...] = ()
    things: tuple[Thing, ...] = ()
    names: tuple[tuple[str, tuple[float, float, float]], ...] = field(default=())


def scenery_of(mission: ExportedMission) -> Scenery:
    """Return what stands within `NEAR_M` of all that happened; nothing where no world is known."""
    world = mission.world
    if world is None:
        return Scenery()
    area = _area(mission)
    buildings = [
        each for each in world.buildings if len(each.outer) > 2 and area.intersects(shapely.Polygon(each.outer))
    ]
    meshes = [*_ground(world, area), *_buildings(buildings)]
    things = tuple(_thing(each) for each in world.objects if area.covers(shapely.Point(each.x_m, each.y_m)))
    names = tuple((each.name, _top_of(each)) for each in buildings if each.name)
    return Scenery(tuple(meshes), things, names)


def _area(mission: ExportedMission) -> _Shape:
    header, steps = mission.record.header, mission.record.steps
    places = [header.start[:2], *header.reference_way]
    places += [(point.x_m, point.y_m) for step in steps for leg in step.legs for point in leg.track]
    places += [(each.x_m, each.y_m) for step in steps for each in step.frontiers]
    low, high = np.min(places, axis=0) - NEAR_M, np.max(places, axis=0) + NEAR_M
    return shapely.box(low[0], low[1], high[0], high[1])


def _ground(world: World, area: _Shape) -> Iterable[Mesh]:
    """Yield the ground that is seen from above, each kind as one flat mesh: what lies below another is cut away."""
    kinds: list[Ground] = []
    shapes: list[_Shape] = []
    for region in world.regions:
        kinds.append(region.ground)
        shapes.append(shapely.Polygon(region.outer, region.holes))
    for way in world.ways:
        if way.level == 0:
            kinds.append(way.ground)
            shapes.append(shapely.LineString(way.line).buffer(way.width_m / 2.0, quad_segs=2))
    clipped = shapely.intersection(shapely.make_valid(np.array(shapes, dtype=object)), area)
    tree = shapely.STRtree(clipped)
    seen: dict[Ground, list[_Shape]] = {}
    for place, (kind, shape) in enumerate(zip(kinds, clipped, strict=True)):
        above = [clipped[other] for other in tree.query(shape, predicate="intersects") if other > place]
        seen.setdefault(kind, []).append(shape.difference(shapely.union_all(above)) if above else shape)
    colours = Palette().ground
    for kind in sorted(seen):
        corners = _triangles(seen[kind])
        if len(corners):
            yield _mesh(f"ground/{kind.noun}", colours[kind], [np.dstack([corners, np.zeros(corners.shape[:2])])])


def _buildings(buildings: Sequence[Building]) -> Iterable[Mesh]:
    palette = Palette()
    walls: list[FloatArray] = []
    roofs: list[FloatArray] = []
    for each in buildings:
        walls += [
            _walls(ring, each.min_height_m, each.height_m, inside=ring is not each.outer)
            for ring in (each.outer, *each.holes)
        ]
        corners = _triangles([shapely.make_valid(shapely.Polygon(each.outer, each.holes))])
        roofs.append(np.dstack([corners, np.full(corners.shape[:2], each.height_m)]))
    for name, colour, parts in (("walls", palette.roof_edge, walls), ("roofs", palette.roof[1], roofs)):
        if any(len(part) for part in parts):
            yield _mesh(f"buildings/{name}", colour, parts)


def _walls(ring: FloatArray, low_m: float, high_m: float, *, inside: bool) -> FloatArray:
    """Return two triangles for each edge of a ring, shape (2n, 3, 3), seen from outside of the building."""
    if shapely.is_ccw(shapely.LinearRing(ring)) == inside:
        ring = ring[::-1]
    following = np.roll(ring, -1, axis=0)
    low, high = np.full(len(ring), low_m), np.full(len(ring), high_m)
    a, b = np.column_stack([ring, low]), np.column_stack([following, low])
    c, d = np.column_stack([following, high]), np.column_stack([ring, high])
    return np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])


def _triangles(shapes: Sequence[_Shape]) -> FloatArray:
    """Return triangles that cover shapes, shape (m, 3, 2), counter-clockwise; their lines and points are left out."""
    parts = shapely.get_parts(shapely.get_parts(np.array(shapes, dtype=object)))
    flat = parts[(shapely.get_dimensions(parts) == 2) & ~shapely.is_empty(parts)]
    cut = shapely.get_parts(shapely.constrained_delaunay_triangles(flat))
    corners: FloatArray = shapely.get_coordinates(cut).reshape(-1, 4, 2)[:, :3]
    first, second = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    turns_right = first[:, 0] * second[:, 1] < first[:, 1] * second[:, 0]
    corners[turns_right] = corners[turns_right][:, ::-1]
    return corners


def _mesh(name: str, colour: str, parts: Sequence[FloatArray]) -> Mesh:
    # To the millimetre, as worlds are kept; corners that triangles share stand once.
    corners = np.round(np.concatenate(parts).reshape(-1, 3), 3)
    vertices, places = np.unique(corners, axis=0, return_inverse=True)
    return Mesh(name, colour, vertices, places.reshape(-1, 3).astype(np.int64))


def _thing(each: WorldObject) -> Thing:
    what = each.object_class
    length_m, width_m, height_m = _MARK_M if what.kind in _MARKED else each.size_m
    return Thing(
        what.kind,
        each.attributes.get("name") or what.noun,
        symbol_of(each.class_name).colour,
        (each.x_m, each.y_m, height_m / 2.0),
        (length_m, width_m, height_m),
        -each.heading_rad,
    )


def _top_of(building: Building) -> tuple[float, float, float]:
    place = shapely.Polygon(building.outer).representative_point()
    return round(place.x, 3), round(place.y, 3), building.height_m + 2.0
