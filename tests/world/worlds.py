"""Tiny hand-made worlds whose every metre is known."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.world.taxonomy import OBJECT_CLASSES, Ground
from reasoned_explorer.world.world import Bounds, Building, Region, Way, World, WorldObject


def box(min_x: float, min_y: float, max_x: float, max_y: float) -> NDArray[np.float64]:
    """Return a rectangle as a ring."""
    return np.asarray([(min_x, min_y), (max_x, min_y), (max_x, max_y), (min_x, max_y)], dtype=np.float64)


def thing(id_: int, class_name: str, x_m: float, y_m: float, **more) -> WorldObject:
    """Return an object of its class's typical size."""
    more.setdefault("size_m", OBJECT_CLASSES[class_name].size_m)
    return WorldObject(id_, class_name, x_m, y_m, **more)


def field(
    *things: tuple[str, float, float],
    size_m: float = 100.0,
    ground: Ground = Ground.GRASS,
    buildings: Iterable[Building] = (),
    regions: Iterable[Region] = (),
    ways: Iterable[Way] = (),
) -> World:
    """Return a square world, (0, 0) in its south-west corner, all of one ground, with things and buildings on it."""
    return World(
        name="field",
        bounds=Bounds(0.0, 0.0, size_m, size_m),
        regions=(Region(ground, box(0.0, 0.0, size_m, size_m)), *regions),
        ways=tuple(ways),
        buildings=tuple(buildings),
        objects=tuple(thing(i, *item) for i, item in enumerate(things)),
    )


def courtyard() -> World:
    """Return a world of 100 m × 80 m, x from 0 to 100, y from 0 to 80.

    ::

        80 ┌──────────────────────────────────────────┐
           │  unknown ground (x < 5 or y > 75)         │
        70 │  ┌ north house (10..60, 50..70), 12 m     │   pond (70..90, 50..70)
           │  │ with a court (25..45, 55..65)          │
        45 │ ── pavement, 4 m wide, y = 43..47 ─────── │
        35 │ ══ road, 8 m wide, y = 31..39 ═══════════ │
        25 │  grass (5..100, 0..31)                    │   roof (80..90, 10..20), one can go under
        20 │  south house (10..30, 5..20), 6 m, cafe   │
         0 └──────────────────────────────────────────┘

    Objects: 0 bench (50, 28) facing north, 1 tree (60, 25), 2 fire hydrant (40, 42.5), 3 fountain (70, 25),
    4 cafe with its entrance at (30, 12), 5 bollard (20, 42), 6 playground with the outline (40..55, 5..20),
    7 bench (75, 47) facing east.
    """
    return World(
        name="courtyard",
        bounds=Bounds(0.0, 0.0, 100.0, 80.0),
        regions=(
            Region(Ground.GRASS, box(5.0, 0.0, 100.0, 31.0), name="meadow"),
            Region(Ground.PLAZA, box(5.0, 31.0, 100.0, 75.0)),
            Region(Ground.WATER, box(70.0, 50.0, 90.0, 70.0), name="pond"),
        ),
        ways=(
            Way("residential", Ground.ROAD, np.asarray([(0.0, 35.0), (100.0, 35.0)]), 8.0, name="Court Street"),
            Way("footway", Ground.PAVEMENT, np.asarray([(0.0, 45.0), (100.0, 45.0)]), 4.0),
            Way("footway", Ground.PATH, np.asarray([(70.0, 48.0), (90.0, 75.0)]), 3.0, name="bridge", level=1),
        ),
        buildings=(
            Building(
                box(10.0, 50.0, 60.0, 70.0),
                12.0,
                holes=(box(25.0, 55.0, 45.0, 65.0),),
                kind="apartments",
                entrances=np.asarray([(35.0, 50.0)]),
                height_source="levels",
            ),
            Building(
                box(10.0, 5.0, 30.0, 20.0),
                6.0,
                kind="retail",
                name="Corner House",
                entrances=np.asarray([(30.0, 12.0)]),
                height_source="height",
            ),
            Building(box(80.0, 10.0, 90.0, 20.0), 4.0, kind="roof", min_height_m=3.0),
        ),
        objects=(
            thing(0, "bench", 50.0, 28.0, attributes={"backrest": "yes"}),
            thing(1, "tree", 60.0, 25.0),
            thing(2, "fire_hydrant", 40.0, 42.5),
            thing(3, "fountain", 70.0, 25.0),
            thing(4, "cafe", 30.0, 12.0, heading_rad=np.pi / 2, building=1, attributes={"name": "Corner Café"}),
            thing(5, "bollard", 20.0, 42.0),
            thing(6, "playground", 47.5, 12.5, outline=box(40.0, 5.0, 55.0, 20.0)),
            thing(7, "bench", 75.0, 47.0, heading_rad=np.pi / 2),
        ),
        source="made by hand for tests",
    )
