"""How each object of a world stands there: which models, where, how large.

Most are one model drawn to the object's size. What a map knows as a line or an area is made of things of usual size: a
line of bollards is many bollards, a playground is what there is room for between what else stands on it.
"""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
import shapely
from numpy.typing import NDArray

from reasoned_explorer.model.draws import choice, key_of, uniform
from reasoned_explorer.rendering.fronts import Front
from reasoned_explorer.rendering.mesh import Model
from reasoned_explorer.rendering.models import model_of, tints_of, variants_of
from reasoned_explorer.rendering.models.play import pitch_end, playground_pieces
from reasoned_explorer.rendering.models.waterworks import hydrant_lid
from reasoned_explorer.world.world import World, WorldObject

Rgb = tuple[float, float, float]
#: A thing is never drawn smaller or larger than its model by more than this factor.
_MOST_SCALE = 12.0
#: What stands in rows when it is long: how far apart, metres; None is side by side.
_IN_ROWS: Mapping[str, float | None] = {"bicycle_parking": None, "recycling": None, "bollard": 1.6}
#: Longer than so many of its kind, it is a row; and a row has at most so many.
_ROW_FROM, _LONGEST_ROW = 1.7, 80
#: A hydrant that is lower than this is one below a lid in the ground, metres.
_LID_M = 0.2
#: A pitch that is longer or wider than its model by more than this has goals of usual size; its lines are the ground's.
_MOST_STRETCHED_PITCH = 1.3
#: How far from each other places on playgrounds are that are tried, metres; and how many at most.
_PLAY_STEP_M, _MOST_PLACES = 1.4, 400


@dataclass(frozen=True, slots=True, eq=False)
class Stand:
    """A model that stands somewhere.

    Attributes:
        item: Id of the object that it is, or a part of.
        model: What it looks like.
        x_m: Of its origin.
        y_m: Likewise.
        heading_rad: Its front faces this way.
        scale: Along its model's axes.
        tint: sRGB in [0, 1].
    """

    item: int
    model: Model
    x_m: float
    y_m: float
    heading_rad: float
    scale: tuple[float, float, float]
    tint: Rgb


def stands_of(world: World, fronts: Mapping[int, Front], *, seed: int) -> Iterator[Stand]:
    """Return what stands for every object of a world, in the order of the objects.

    Args:
        world: The world.
        fronts: Of its places (`reasoned_explorer.rendering.fronts.fronts_of`).
        seed: Of looks (which of its class's models a thing has, its colour).
    """
    others = _Others(world)
    for item in world.objects:
        variant = key_of(seed, "variant", item.id) % variants_of(item.class_name)
        tint = choice(tints_of(item.class_name), seed, "tint", item.id)
        model = model_of(item.class_name, variant)
        scale = _scale(model, item)
        if item.id in fronts:
            front = fronts[item.id]
            yield Stand(item.id, front.dressed(model), front.x_m, front.y_m, front.heading_rad, front.scale, tint)
        elif item.class_name == "playground":
            yield from _playground(item, variant, others, seed)
        elif item.class_name == "pitch" and max(scale[:2]) > _MOST_STRETCHED_PITCH:
            yield from _pitch(item, variant)
        elif item.class_name in _IN_ROWS and item.size_m[0] > _ROW_FROM * model.size_m[0]:
            yield from _row(item, model, scale, tint)
        elif item.class_name == "fire_hydrant" and 0.0 < item.size_m[2] < _LID_M:
            yield Stand(item.id, hydrant_lid(), item.x_m, item.y_m, item.heading_rad, (1.0, 1.0, 1.0), tint)
        else:
            yield Stand(item.id, model, item.x_m, item.y_m, item.heading_rad, scale, tint)


def _scale(model: Model, item: WorldObject) -> tuple[float, float, float]:
    size_m = item.size_m
    if item.object_class.kind == "vehicle":  # its length lies ahead, whichever way round the size was given
        size_m = (min(size_m[:2]), max(size_m[:2]), size_m[2])

    def ratio(axis: int) -> float:
        natural, wanted = model.size_m[axis], size_m[axis]
        if natural <= 0.0 or wanted <= 0.0:
            return 1.0
        return min(max(wanted / natural, 1.0 / _MOST_SCALE), _MOST_SCALE)

    if model.scaling == "axes":
        return (ratio(0), ratio(1), ratio(2))
    if model.scaling == "uniform":
        by_height = ratio(2)
        return (by_height, by_height, by_height)
    return (1.0, 1.0, 1.0)


def _row(item: WorldObject, model: Model, scale: tuple[float, float, float], tint: Rgb) -> Iterator[Stand]:
    """Return things in a row across the front of what they are together."""
    apart = _IN_ROWS[item.class_name]
    length, wide = item.size_m[0], model.size_m[0]
    count = min(max(2, round(length / (wide if apart is None else apart))), _LONGEST_ROW)
    # Side by side they fill the length; else the outermost stand at its ends.
    step = length / count if apart is None else (length - wide) / (count - 1)
    across = step / wide if apart is None else 1.0
    east, north = math.cos(item.heading_rad), -math.sin(item.heading_rad)
    for place in range(count):
        off = (place - 0.5 * (count - 1)) * step
        at = item.x_m + off * east, item.y_m + off * north
        yield Stand(item.id, model, *at, item.heading_rad, (across, scale[1], scale[2]), tint)


def _pitch(item: WorldObject, variant: int) -> Iterator[Stand]:
    """Return a goal or a hoop at either end of a pitch."""
    east, north = math.cos(item.heading_rad), -math.sin(item.heading_rad)
    long_ahead = item.size_m[1] > item.size_m[0]
    if long_ahead:
        east, north = math.sin(item.heading_rad), math.cos(item.heading_rad)
    for side in (-1.0, 1.0):
        off = side * (0.5 * max(item.size_m[:2]) - 0.3)
        heading = math.atan2(side * east, side * north)
        yield Stand(
            item.id, pitch_end(variant), item.x_m + off * east, item.y_m + off * north, heading, (1.0, 1.0, 1.0),
            (1.0, 1.0, 1.0),
        )  # fmt: skip


class _Others:
    """Where things stand, as discs.

    Args:
        world: The world.
    """

    def __init__(self, world: World) -> None:
        solid = [item for item in world.objects if item.object_class.kind not in {"area", "place"}]
        self.middles: NDArray[np.float64] = np.array([(one.x_m, one.y_m) for one in solid], np.float64).reshape(-1, 2)
        self.radii: NDArray[np.float64] = np.array([0.5 * max(one.size_m[:2]) for one in solid], np.float64)
        # Crowns are above people's heads.
        trees = np.array([one.class_name == "tree" for one in solid], np.bool_)
        self.radii = np.where(trees, 0.4, self.radii)


def _playground(item: WorldObject, variant: int, others: _Others, seed: int) -> Iterator[Stand]:
    """Return the pieces of a playground for which there is room within its outline and between what stands there."""
    area = shapely.Polygon(_outline(item)).buffer(0.0)
    places = _places_in(area, seed, item.id)
    near = np.hypot(*(others.middles - (item.x_m, item.y_m)).T) < max(item.size_m[:2]) + 10.0
    middles, radii = others.middles[near], others.radii[near]
    for piece in playground_pieces(variant):
        inside = shapely.distance(shapely.points(places), area.boundary) > 0.8 * piece.radius_m
        gaps = np.hypot(*np.moveaxis(places[:, None] - middles[None], -1, 0)) - radii
        free = np.flatnonzero(inside & (gaps.min(axis=1, initial=np.inf) > piece.radius_m + 0.4))
        if not len(free):
            continue
        x, y = places[free[0]].tolist()
        middles, radii = np.concatenate([middles, [(x, y)]]), np.append(radii, piece.radius_m)
        heading = item.heading_rad + 0.5 * math.pi * int(4.0 * uniform(seed, "turn", item.id, len(radii)))
        yield Stand(item.id, piece.model, x, y, heading, (1.0, 1.0, 1.0), (1.0, 1.0, 1.0))


def _outline(item: WorldObject) -> NDArray[np.float64]:
    if item.outline is not None and len(item.outline) >= 3:
        return item.outline
    half_x, half_y = 0.5 * item.size_m[0], 0.5 * item.size_m[1]
    sine, cosine = math.sin(item.heading_rad), math.cos(item.heading_rad)
    corners = np.array([(-half_x, -half_y), (half_x, -half_y), (half_x, half_y), (-half_x, half_y)])
    turned: NDArray[np.float64] = corners @ np.array([(cosine, -sine), (sine, cosine)]) + (item.x_m, item.y_m)
    return turned


def _places_in(area: shapely.Polygon, seed: int, item: int) -> NDArray[np.float64]:
    """Return places in an area, in an order drawn by chance, shape (n, 2)."""
    if area.is_empty:
        return np.empty((0, 2))
    left, low, right, high = area.bounds
    step = max(_PLAY_STEP_M, math.sqrt((right - left) * (high - low) / _MOST_PLACES))
    x, y = (np.arange(begin + 0.5 * step, end, step) for begin, end in ((left, right), (low, high)))
    grid = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    grid = grid[shapely.contains_xy(area, grid)]
    found: NDArray[np.float64] = grid[np.random.default_rng(key_of(seed, "play", item)).permutation(len(grid))]
    return found
