"""Textures of every material, made in code."""

from collections.abc import Callable
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.rendering import ground_textures as ground
from reasoned_explorer.rendering import wall_textures as walls
from reasoned_explorer.rendering.material import Material
from reasoned_explorer.rendering.texture_patterns import SIZE, Field

#: Of each material: what paints it, and how many metres one repetition covers.
_MADE: dict[Material, tuple[Callable[[], Field], float]] = {
    Material.PLAIN: (walls.plain, 1.0),
    Material.PAINT: (walls.paint, 1.0),
    Material.METAL: (walls.metal, 1.0),
    Material.WOOD: (walls.wood, 1.0),
    Material.STONE: (walls.stone, 4.0),
    Material.CONCRETE: (walls.concrete, 4.0),
    Material.BRICK: (walls.brick, 1.25),
    Material.PLASTER: (walls.plaster, 2.0),
    Material.GLASS: (walls.glass, 2.0),
    Material.WATER: (ground.water, 8.0),
    Material.FOLIAGE: (ground.foliage, 1.5),
    Material.BARK: (walls.bark, 1.0),
    Material.FABRIC: (walls.fabric, 0.5),
    Material.ROOF_TILES: (walls.roof_tiles, 2.0),
    Material.ROOF_FLAT: (walls.roof_flat, 4.0),
    Material.FACADE: (walls.facade, 6.0),
    Material.FACADE_BRICK: (walls.facade_brick, 6.0),
    Material.FACADE_GLASS: (walls.facade_glass, 6.0),
    Material.FACADE_SHOP: (walls.facade_shop, 4.0),
    Material.ASPHALT: (ground.asphalt, 4.0),
    Material.PAVING: (ground.paving, 2.0),
    Material.COBBLES: (ground.cobbles, 2.0),
    Material.GRASS: (ground.grass, 4.0),
    Material.EARTH: (ground.earth, 3.0),
    Material.SAND: (ground.sand, 3.0),
    Material.GRAVEL: (ground.gravel, 2.0),
    Material.PLANKS: (ground.planks, 1.2),
    Material.FLOWERS: (ground.flowers, 1.5),
    Material.GLOW: (walls.plain, 1.0),
}

#: How many metres of a surface one repetition of each material's texture covers, shape (len(Material),), float32.
TEXTURE_METRES: NDArray[np.float32] = np.array([_MADE[material][1] for material in Material], dtype=np.float32)
TEXTURE_METRES.flags.writeable = False


@lru_cache(maxsize=1)
def texture_stack() -> NDArray[np.float32]:
    """Return the texture of every material.

    Texture coordinates in metres, divided by `TEXTURE_METRES`, count repetitions: the first runs to the right, the
    second upwards.

    Returns:
        Shape (len(Material), 128, 128, 3), float32, read-only; sRGB in [0, 1] in steps of 1/255, to be multiplied with
        a surface's colour. Row 0 is the top. Every texture tiles.
    """
    stack = np.empty((len(Material), SIZE, SIZE, 3), np.float32)
    for material in Material:
        picture = np.clip(_MADE[material][0](), 0.0, 1.0)
        # Whole steps hide that the last bit of a sine is not the same on every processor.
        stack[material] = np.rint(picture * 255.0) / 255.0
    stack.flags.writeable = False
    return stack
