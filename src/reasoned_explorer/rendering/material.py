"""What surfaces are made of: what decides a surface's texture and how it takes light."""

from enum import IntEnum


class Material(IntEnum):
    """What a surface is made of. Its number is its place in the stack of textures; append, never insert.

    A triangle's colour multiplies the material's texture. Surfaces of `TINTED` materials are also multiplied by the
    tint of the thing that they belong to (a car's paint, a tree's leaves).
    """

    PLAIN = 0
    PAINT = 1
    METAL = 2
    WOOD = 3
    STONE = 4
    CONCRETE = 5
    BRICK = 6
    PLASTER = 7
    GLASS = 8
    WATER = 9
    FOLIAGE = 10
    BARK = 11
    FABRIC = 12
    ROOF_TILES = 13
    ROOF_FLAT = 14
    FACADE = 15  # plaster with windows: u is metres along the wall, v metres above the ground
    FACADE_BRICK = 16
    FACADE_GLASS = 17
    FACADE_SHOP = 18
    ASPHALT = 19
    PAVING = 20
    COBBLES = 21
    GRASS = 22
    EARTH = 23
    SAND = 24
    GRAVEL = 25
    PLANKS = 26
    FLOWERS = 27
    GLOW = 28  # lit signs and lamps: takes no shadow


#: Multiplied by the tint of the thing that they belong to.
TINTED = frozenset({Material.PAINT, Material.FOLIAGE})
#: Reflects the sky.
SHINY = frozenset({Material.GLASS, Material.WATER, Material.FACADE_GLASS})
