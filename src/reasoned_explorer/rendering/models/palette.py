"""Surfaces that many models share."""

from reasoned_explorer.rendering.material import Material
from reasoned_explorer.rendering.mesh_builder import Colour, Surface

#: White in tinted surfaces: the tint alone decides.
WHITE: Colour = (1.0, 1.0, 1.0)

PAINT = Surface(Material.PAINT, WHITE)
LEAVES = Surface(Material.FOLIAGE, WHITE)

IRON = Surface(Material.METAL, (0.16, 0.17, 0.18))
DARK_STEEL = Surface(Material.METAL, (0.30, 0.32, 0.34))
STEEL = Surface(Material.METAL, (0.62, 0.64, 0.66))
CHROME = Surface(Material.METAL, (0.80, 0.81, 0.83))
BRASS = Surface(Material.METAL, (0.78, 0.62, 0.25))
BRONZE = Surface(Material.METAL, (0.36, 0.42, 0.36))
RUBBER = Surface(Material.PLAIN, (0.07, 0.07, 0.08))
BLACK = Surface(Material.PLAIN, (0.06, 0.06, 0.07))
SIGN_WHITE = Surface(Material.PLAIN, (0.95, 0.95, 0.94))
SIGN_RED = Surface(Material.PLAIN, (0.80, 0.07, 0.09))
SIGN_BLUE = Surface(Material.PLAIN, (0.05, 0.25, 0.62))
SIGN_YELLOW = Surface(Material.PLAIN, (0.98, 0.80, 0.08))
SIGN_GREEN = Surface(Material.PLAIN, (0.02, 0.50, 0.24))
OAK = Surface(Material.WOOD, (0.60, 0.40, 0.22))
DARK_WOOD = Surface(Material.WOOD, (0.38, 0.23, 0.13))
PALE_WOOD = Surface(Material.WOOD, (0.72, 0.56, 0.37))
LIMESTONE = Surface(Material.STONE, (0.74, 0.71, 0.64))
GRANITE = Surface(Material.STONE, (0.56, 0.55, 0.54))
CONCRETE = Surface(Material.CONCRETE, (0.66, 0.65, 0.63))
GLASS = Surface(Material.GLASS, (0.22, 0.29, 0.34))
PALE_GLASS = Surface(Material.GLASS, (0.60, 0.72, 0.76))
WATER = Surface(Material.WATER, (0.28, 0.55, 0.68))
SPRAY = Surface(Material.PLAIN, (0.86, 0.93, 0.98))
LIGHT = Surface(Material.GLOW, (1.0, 0.95, 0.82))
SOIL = Surface(Material.EARTH, (0.27, 0.19, 0.13))
BARK = Surface(Material.BARK, (0.36, 0.27, 0.20))


def plain(red: float, green: float, blue: float) -> Surface:
    """Return a smooth matt surface of an sRGB colour in [0, 1]."""
    return Surface(Material.PLAIN, (red, green, blue))


def fabric(red: float, green: float, blue: float) -> Surface:
    """Return cloth of an sRGB colour in [0, 1]."""
    return Surface(Material.FABRIC, (red, green, blue))
