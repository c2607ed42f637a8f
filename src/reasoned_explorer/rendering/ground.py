"""What the ground looks like where, for the shader."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.rendering.library import linear_from_srgb
from reasoned_explorer.rendering.mesh import Model
from reasoned_explorer.world.world import World


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
    from reasoned_explorer.rendering.crossings import crossings_of
    from reasoned_explorer.rendering.ground_map import ground_colours, ground_map_of, ground_materials
    from reasoned_explorer.rendering.markings import markings_of

    crossings = crossings_of(world)
    raster = ground_map_of(world, crossings=crossings)
    markings = tuple(markings_of(world, raster, crossings=crossings))
    corner = np.array([raster.min_x_m, raster.min_y_m, raster.cell_m])
    return GroundMap(raster.codes, corner, ground_materials(), linear_from_srgb(ground_colours()), markings)
