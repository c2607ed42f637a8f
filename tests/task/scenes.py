"""Small worlds to judge in."""

from collections.abc import Iterable

import numpy as np

from reasoned_explorer.task.judge import Judge
from reasoned_explorer.task.reading import read_goal
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.geodesic import Traveller
from reasoned_explorer.world.taxonomy import OBJECT_CLASSES, Ground
from reasoned_explorer.world.world import Bounds, Building, Region, World, WorldObject

WALKER = Traveller(flies=False, radius_m=0.3)


def box(min_x, min_y, max_x, max_y):
    return np.asarray([(min_x, min_y), (max_x, min_y), (max_x, max_y), (min_x, max_y)], dtype=np.float64)


def house(min_x, min_y, max_x, max_y, **more):
    return Building(box(min_x, min_y, max_x, max_y), height_m=10.0, **more)


def patch(ground: Ground, *corners) -> Region:
    return Region(ground, box(*corners))


def world_of(
    *things: tuple,
    size_m: float = 100.0,
    ground: Ground = Ground.PLAZA,
    regions: Iterable[Region] = (),
    buildings: Iterable[Building] = (),
) -> Atlas:
    """A square of one ground, with things: (class, x, y) or (class, x, y, {field: value})."""
    objects = tuple(
        WorldObject(i, name, x, y, **{"size_m": OBJECT_CLASSES[name].size_m, **(more[0] if more else {})})
        for i, (name, x, y, *more) in enumerate(things)
    )
    base = (Region(ground, box(0.0, 0.0, size_m, size_m)),)
    return Atlas(World("square", Bounds(0.0, 0.0, size_m, size_m), (*base, *regions), (), tuple(buildings), objects))


def judge_of(atlas: Atlas, sentence: str, **options) -> Judge:
    return Judge(atlas, read_goal(sentence), traveller=WALKER, **options)


def passing(atlas: Atlas, sentence: str) -> list[int]:
    """Ids of what satisfies a sentence."""
    return [object_id for object_id, _ in judge_of(atlas, sentence).satisfying]
