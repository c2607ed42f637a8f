"""Where the fronts of places are: on walls, side by side, none beyond a corner; or before booths of their own.

A world says where one enters a place, on a wall or a step before it; how wide its front may be depends on the wall and
on what else is there.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import shapely
from numpy.typing import NDArray

from reasoned_explorer.rendering.footprints import Bools, Floats, Footprints, Ints
from reasoned_explorer.rendering.material import Material
from reasoned_explorer.rendering.mesh import Mesh, Model
from reasoned_explorer.rendering.mesh_builder import FAR, MeshBuilder, Surface
from reasoned_explorer.world.world import Building, World, WorldObject

#: A place farther than this from every wall stands for itself, metres.
_FAR_M = 1.5
#: Before a front may be moved aside, it may be narrowed to this share of its class's width.
_NARROWEST = 0.62
#: A front never gets narrower than this, metres, unless its wall is.
_LEAST_M = 1.0
#: How far from the corners of buildings fronts end, metres.
_MARGIN_M = 0.06
#: Into how many steps a front is cut to see whether another building stands right before it, and how far before.
_STEPS, _BEFORE_M = 12, 0.3
#: Fronts are at most this share of their building's height; of a church's, whose nave is lower than its tower.
_HIGHEST, _HIGHEST_OF_NAVE, _LOWEST_SCALE = 0.92, 0.42, 0.6
_BOOTH_M = 2.4
_BOOTH_WALL = Surface(Material.PLASTER, (0.80, 0.78, 0.72))
_BOOTH_ROOF = Surface(Material.METAL, (0.42, 0.44, 0.46))


@dataclass(frozen=True, slots=True)
class Front:
    """The front of one place.

    Attributes:
        x_m: Middle of its foot, on the wall.
        y_m: Likewise.
        heading_rad: Away from the wall.
        width_m: Across.
        scale: Of its class's model, along that model's axes.
        free: Whether it stands away from all walls.
    """

    x_m: float
    y_m: float
    heading_rad: float
    width_m: float
    scale: tuple[float, float, float]
    free: bool = False

    def dressed(self, model: Model) -> Model:
        """Return the model of the place: with a booth behind its front, where there is no building."""
        return _with_booth(model) if self.free else model


def fronts_of(world: World) -> dict[int, Front]:
    """Return the front of every place of a world by the id of the object.

    Fronts are as wide as their class's, narrower where walls are short or neighbours near, and moved aside no farther
    than that needs. The sizes that a world gives places are those of the whole premises and say nothing of fronts.
    """
    places = [item for item in world.objects if item.object_class.kind == "place"]
    if not places:
        return {}
    standing = [one for one in world.buildings if one.min_height_m < 0.5]
    prints = Footprints.of(standing)
    wall, distance = _walls_of(places, prints)
    natural = np.array([item.object_class.size_m[0] for item in places])
    middle, width = distance.copy(), natural.copy()
    begin, end = _open_stretches(prints, wall, distance, natural)
    for rows in _rows_by_wall(wall, distance):
        ends_m = float(begin[rows[0]]), float(end[rows[-1]])
        middle[rows], width[rows] = _side_by_side(distance[rows], natural[rows], ends_m)
    found = {}
    for row, item in enumerate(places):
        if wall[row] < 0:
            whole = (1.0, 1.0, 1.0)
            found[item.id] = Front(item.x_m, item.y_m, item.heading_rad, float(natural[row]), whole, free=True)
            continue
        edge = int(wall[row])
        x, y = (prints.corners[edge] + middle[row] * prints.along[edge]).tolist()
        east, north = prints.outwards[edge].tolist()
        upward = _upward(item, standing[int(prints.owners[edge])])
        share = float(width[row] / natural[row])
        found[item.id] = Front(x, y, math.atan2(east, north), float(width[row]), (share, 1.0, upward))
    return found


def walls_taken(fronts: Sequence[Front]) -> Floats:
    """Return which stretches of walls fronts cover: their middles and widths, shape (n, 3), metres."""
    return np.array([(one.x_m, one.y_m, one.width_m) for one in fronts if not one.free], np.float64).reshape(-1, 3)


def _upward(item: WorldObject, building: Building) -> float:
    """Return the share of its class's height that a front has on a building."""
    most = _HIGHEST_OF_NAVE if item.class_name == "church" else _HIGHEST
    share = most * building.height_m / item.object_class.size_m[2]
    return min(max(share, _LOWEST_SCALE), 1.0)


def _walls_of(places: Sequence[WorldObject], prints: Footprints) -> tuple[Ints, Floats]:
    """Return the wall of each place, -1 where there is none, and how far along it the place is, shape (n,)."""
    wall = np.full(len(places), -1, np.int64)
    distance = np.zeros(len(places))
    if not len(prints.corners):
        return wall, distance
    points = np.array([(item.x_m, item.y_m) for item in places])
    headings = np.array([item.heading_rad for item in places])
    wanted = np.array([item.object_class.size_m[0] for item in places])
    lines = shapely.linestrings(np.stack([prints.corners, prints.corners[prints.after]], axis=1))
    place, edge = shapely.STRtree(lines).query(shapely.points(points), predicate="dwithin", distance=_FAR_M)
    away = points[place] - prints.corners[edge]
    along = np.clip(np.sum(away * prints.along[edge], axis=1), 0.0, prints.lengths[edge])
    out = np.sum(away * prints.outwards[edge], axis=1)
    gap = np.hypot(*(away - along[:, None] * prints.along[edge]).T)
    ahead = np.column_stack([np.sin(headings), np.cos(headings)])[place]
    # The wall that is near, that the place looks away from, and that has room.
    cost = gap + (1.0 - np.sum(ahead * prints.outwards[edge], axis=1))
    cost += 0.4 * np.maximum(_NARROWEST * wanted[place] - prints.lengths[edge], 0.0)
    cost[out < -0.1] = np.inf
    order = np.lexsort((edge, cost, place))
    order = order[np.isfinite(cost[order])]
    first = order[np.unique(place[order], return_index=True)[1]]
    wall[place[first]], distance[place[first]] = edge[first], along[first]
    return wall, distance


def _open_stretches(prints: Footprints, wall: Ints, distance: Floats, natural: Floats) -> tuple[Floats, Floats]:
    """Return between which distances along its wall each place has no other building right before it, shape (n,)."""
    length = np.where(wall >= 0, prints.lengths[wall], 0.0) if len(prints.corners) else np.zeros(len(wall))
    begin, end = np.zeros(len(wall)), length.copy()
    on = np.flatnonzero(wall >= 0)
    if not len(on):
        return begin, end
    steps = np.linspace(-0.5, 0.5, _STEPS + 1)
    at = np.clip(distance[on, None] + steps * natural[on, None], 0.0, length[on, None])
    edge = wall[on]
    points = prints.corners[edge][:, None] + at[..., None] * prints.along[edge][:, None]
    points += _BEFORE_M * prints.outwards[edge][:, None]
    built = prints.cover(points.reshape(-1, 2)).reshape(at.shape)
    # What is seen at the ends of walls may be a neighbour that stands round the corner.
    built &= (at > _MARGIN_M) & (at < length[on, None] - _MARGIN_M)
    begin[on] = np.where(built & (steps < 0.0), at, 0.0).max(axis=1)
    end[on] = np.where(built & (steps > 0.0), at, length[on, None]).min(axis=1)
    return begin, end


def _rows_by_wall(wall: Ints, distance: Floats) -> list[Ints]:
    """Return the places of each wall that has any, in their order along it."""
    order = np.lexsort((distance, wall))
    order = order[wall[order] >= 0]
    return np.split(order, np.flatnonzero(np.diff(wall[order])) + 1) if len(order) else []


def _side_by_side(wanted: Floats, natural: Floats, ends_m: tuple[float, float]) -> tuple[Floats, Floats]:
    """Return middles and widths of fronts on one wall so that none overlap, as near as can be to where they are wanted.

    Args:
        wanted: Where along the wall each is wanted, rising, shape (n,), metres.
        natural: How wide each would be, shape (n,), metres.
        ends_m: Between which distances along the wall they may lie.
    """
    length = max(ends_m[1] - ends_m[0], 0.1)
    room = max(length - 2.0 * _MARGIN_M, 0.5 * length)
    begin = 0.5 * (ends_m[0] + ends_m[1] - room)
    # Half the way to each neighbour, or all the way to the end of the wall.
    between = 0.5 * (wanted[1:] + wanted[:-1])
    left = wanted - np.concatenate([[begin], between])
    right = np.concatenate([between, [begin + room]]) - wanted
    least = np.maximum(_NARROWEST * natural, np.minimum(natural, _LEAST_M))
    width = np.clip(2.0 * np.minimum(left, right), least, natural)
    width *= min(1.0, room / float(width.sum()))
    offset = np.cumsum(width) - 0.5 * width
    moved = np.clip(_rising(wanted - offset), begin, begin + room - float(width.sum()))
    return moved + offset, width


def _rising(values: Floats) -> Floats:
    """Return the rising sequence that is nearest to values (pooling those that fall), shape (n,)."""
    means: list[float] = []
    counts: list[int] = []
    for value in values.tolist():
        means.append(value)
        counts.append(1)
        while len(means) > 1 and means[-2] > means[-1]:
            count = counts[-2] + counts[-1]
            mean = (means[-2] * counts[-2] + means[-1] * counts[-1]) / count
            means[-2:], counts[-2:] = [mean], [count]
    return np.repeat(np.array(means), counts)


@lru_cache(maxsize=256)
def _with_booth(model: Model) -> Model:
    """Return a front with a booth behind it."""
    wide, _, high = model.size_m
    deep = min(_BOOTH_M, 0.8 * wide)
    levels = []
    for level, mesh in enumerate(model.levels):
        builder = MeshBuilder(detail=min(level, FAR))
        half, top = 0.5 * wide - 0.02, 0.94 * min(high, 4.0)
        builder.box(_BOOTH_WALL, (-half, -deep, 0.0), (half, 0.0, top))
        if level < FAR:
            builder.box(_BOOTH_ROOF, (-half - 0.12, -deep - 0.12, top), (half + 0.12, -0.01, top + 0.1))
        levels.append(_joined(mesh, builder.mesh()))
    return Model(tuple(levels), model.size_m, model.scaling)


def _joined(one: Mesh, other: Mesh) -> Mesh:
    return Mesh(
        np.concatenate([one.vertices, other.vertices]),
        np.concatenate([one.triangles, other.triangles + np.int32(len(one.vertices))]),
        np.concatenate([one.normals, other.normals]),
        np.concatenate([one.uvs, other.uvs]),
        np.concatenate([one.colours, other.colours]),
        np.concatenate([one.materials, other.materials]),
    )


def clear_of(points: Floats, taken: Floats, beside_m: Floats | float) -> Bools:
    """Return which points on walls are clear of fronts, shape (n,).

    Args:
        points: Shape (n, 2), metres.
        taken: As `walls_taken` gives it.
        beside_m: How far from the end of a front they must be, metres.
    """
    clear = np.ones(len(points), np.bool_)
    if len(points) and len(taken):
        reach = np.broadcast_to(np.asarray(beside_m, dtype=np.float64), (len(points),))
        most = float(taken[:, 2].max()) / 2.0 + float(reach.max())
        tree = shapely.STRtree(shapely.points(taken[:, :2]))
        at, front = tree.query(shapely.points(points), predicate="dwithin", distance=most)
        gap = np.hypot(*(points[at] - taken[front, :2]).T)
        clear[at[gap < taken[front, 2] / 2.0 + reach[at]]] = False
    return clear


NO_FRONTS: NDArray[np.float64] = np.empty((0, 3))
