"""What the ground looks like where, for the shader."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.rendering.library import linear_from_srgb
from reasoned_explorer.rendering.material import Material
from reasoned_explorer.rendering.mesh import Model
from reasoned_explorer.world.raster import GroundRaster
from reasoned_explorer.world.taxonomy import Ground
from reasoned_explorer.world.world import World

#: Edge of a cell, metres; where the raster would be very large, cells grow.
CELL_M = 0.25
_MOST_CELLS = 60_000_000


@dataclass(frozen=True, eq=False)
class GroundMap:
    """The plane z = 0.

    Attributes:
        codes: Values of `Ground`, shape (rows, columns), uint8, rows from south to north.
        corner: West edge, south edge and edge of a cell, metres, shape (3,), float64.
        materials: `Material` of each kind, shape (kinds,), uint8.
        colours: Of each kind, linear light, shape (kinds, 3), float32.
        markings: Meshes that lie on it, each with its place.
    """

    codes: NDArray[np.uint8]
    corner: NDArray[np.float64]
    materials: NDArray[np.uint8]
    colours: NDArray[np.float32]
    markings: tuple[tuple[Model, tuple[float, float, float]], ...] = ()


def ground_of(world: World) -> GroundMap:
    """Return a world's ground."""
    cell = max(CELL_M, (world.bounds.width_m * world.bounds.height_m / _MOST_CELLS) ** 0.5)
    raster = GroundRaster.of(world, cell_m=cell)
    materials, colours = ground_looks()
    corner = np.array([raster.min_x_m, raster.min_y_m, raster.cell_m])
    return GroundMap(raster.codes, corner, materials, colours)


def ground_looks() -> tuple[NDArray[np.uint8], NDArray[np.float32]]:
    """Return what each kind of ground is made of and its colour (linear light)."""
    looks = _stand_in_looks()
    materials = np.array([int(looks[kind][0]) for kind in Ground], np.uint8)
    return materials, linear_from_srgb(np.array([looks[kind][1] for kind in Ground], np.float32))


def _stand_in_looks() -> dict[Ground, tuple[Material, tuple[float, float, float]]]:
    plain = (Material.EARTH, (0.55, 0.53, 0.47))
    return dict.fromkeys(Ground, plain) | {
        Ground.ROAD: (Material.ASPHALT, (0.33, 0.33, 0.34)),
        Ground.PAVEMENT: (Material.PAVING, (0.66, 0.64, 0.6)),
        Ground.PLAZA: (Material.PAVING, (0.72, 0.69, 0.63)),
        Ground.CYCLEWAY: (Material.ASPHALT, (0.52, 0.33, 0.28)),
        Ground.PATH: (Material.GRAVEL, (0.64, 0.58, 0.47)),
        Ground.GRASS: (Material.GRASS, (0.36, 0.5, 0.22)),
        Ground.WOOD: (Material.GRASS, (0.27, 0.38, 0.18)),
        Ground.GARDEN: (Material.GRASS, (0.38, 0.5, 0.25)),
        Ground.SAND: (Material.SAND, (0.8, 0.72, 0.55)),
        Ground.WATER: (Material.WATER, (0.2, 0.35, 0.42)),
        Ground.PARKING: (Material.ASPHALT, (0.4, 0.4, 0.41)),
    }
