"""What ground is where for the eye, and what each kind of ground looks like."""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.rendering.crossings import Crossings, crossings_of
from reasoned_explorer.rendering.material import Material
from reasoned_explorer.world.raster import Canvas, GroundRaster
from reasoned_explorer.world.taxonomy import Ground
from reasoned_explorer.world.world import World

_CELL_M = 0.25
#: Larger worlds get larger cells: one byte is kept for each.
_MAX_CELLS = 160_000_000


@dataclass(frozen=True, slots=True)
class GroundLook:
    """What a kind of ground looks like.

    Attributes:
        material: Its texture, and how it takes light.
        colour: sRGB in [0, 1]; multiplies the texture.
    """

    material: Material
    colour: tuple[float, float, float]


GROUND_LOOKS: dict[Ground, GroundLook] = {
    Ground.UNKNOWN: GroundLook(Material.CONCRETE, (0.62, 0.60, 0.56)),
    Ground.ROAD: GroundLook(Material.ASPHALT, (0.43, 0.43, 0.44)),
    Ground.PAVEMENT: GroundLook(Material.PAVING, (0.71, 0.69, 0.66)),
    Ground.PLAZA: GroundLook(Material.COBBLES, (0.84, 0.79, 0.71)),
    Ground.CYCLEWAY: GroundLook(Material.ASPHALT, (0.66, 0.38, 0.33)),
    Ground.PATH: GroundLook(Material.GRAVEL, (0.77, 0.71, 0.60)),
    Ground.STEPS: GroundLook(Material.STONE, (0.74, 0.72, 0.69)),
    Ground.GRASS: GroundLook(Material.GRASS, (0.41, 0.50, 0.28)),
    Ground.WOOD: GroundLook(Material.GRASS, (0.42, 0.39, 0.27)),
    Ground.GARDEN: GroundLook(Material.GRASS, (0.45, 0.55, 0.32)),
    Ground.SAND: GroundLook(Material.SAND, (0.90, 0.81, 0.62)),
    Ground.WATER: GroundLook(Material.WATER, (0.26, 0.44, 0.52)),
    Ground.PARKING: GroundLook(Material.ASPHALT, (0.53, 0.53, 0.54)),
    Ground.PITCH: GroundLook(Material.GRASS, (0.32, 0.55, 0.30)),
    Ground.PLAYGROUND: GroundLook(Material.SAND, (0.84, 0.66, 0.44)),
    Ground.RAILWAY: GroundLook(Material.GRAVEL, (0.56, 0.51, 0.47)),
    Ground.CONSTRUCTION: GroundLook(Material.EARTH, (0.70, 0.55, 0.39)),
    Ground.YARD: GroundLook(Material.CONCRETE, (0.68, 0.66, 0.62)),
    Ground.BUILDING: GroundLook(Material.CONCRETE, (0.62, 0.60, 0.56)),
}


def ground_materials() -> NDArray[np.uint8]:
    """Return the `Material` of every kind of ground by its code, shape (len(Ground),), uint8."""
    return np.array([GROUND_LOOKS[ground].material for ground in Ground], dtype=np.uint8)


def ground_colours() -> NDArray[np.float32]:
    """Return the colour of every kind of ground by its code, sRGB in [0, 1], shape (len(Ground), 3), float32."""
    return np.array([GROUND_LOOKS[ground].colour for ground in Ground], dtype=np.float32)


def ground_map_of(world: World, *, crossings: Crossings | None = None) -> GroundRaster:
    """Return what ground is where, as it is drawn.

    It is finer than the raster that vehicles go by, has no buildings (which stand on it), and the carriageway runs on
    below crossings, whose stripes are meshes.

    Args:
        world: The world.
        crossings: Of the world, where they are known already.

    Raises:
        WorldError: If the world is so large that it cannot be painted.
    """
    area_m2 = world.bounds.width_m * world.bounds.height_m
    cell_m = max(_CELL_M, math.sqrt(area_m2 / _MAX_CELLS) * 1.001)
    ground = GroundRaster.of(replace(world, buildings=()), cell_m=cell_m)
    crossed = crossings_of(world) if crossings is None else crossings
    canvas = Canvas(ground.codes, ground.min_x_m, ground.min_y_m, ground.cell_m)
    canvas.fill(((ring,) for ring in crossed.road_surfaces()), int(Ground.ROAD))
    return ground
