"""How each building is built: its family, its walls and colours, its storeys. Chosen by a draw of its own."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.model.draws import key_of
from reasoned_explorer.rendering.footprints import Footprints
from reasoned_explorer.rendering.material import Material
from reasoned_explorer.world.world import Building

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Bools = NDArray[np.bool_]


class Family(IntEnum):
    """Buildings that are built alike."""

    HOUSE = 0
    HUT = 1
    FLATS = 2
    OFFICE = 3
    SHOP = 4
    HALL = 5
    CHURCH = 6
    CANOPY = 7
    TOWER = 8
    GLASSHOUSE = 9


_KINDS: dict[Family, str] = {
    Family.HOUSE: "house detached semidetached_house terrace bungalow cabin farm villa pavilion barn allotment_house",
    Family.HUT: "garage garages shed hut kiosk service toilets container elevator bunker utility entrance",
    Family.FLATS: "apartments residential hotel dormitory block",
    Family.OFFICE: "office government public civic hospital university college school kindergarten museum "
    "train_station castle palace",
    Family.SHOP: "retail supermarket commercial restaurant",
    Family.HALL: "industrial warehouse hangar sports_hall stadium",
    Family.CHURCH: "church chapel cathedral synagogue temple mosque monastery",
    Family.CANOPY: "roof carport canopy",
    Family.TOWER: "tower bell_tower water_tower gate",
    Family.GLASSHOUSE: "greenhouse glasshouse atrium",
}
_FAMILY_OF = {kind: family for family, kinds in _KINDS.items() for kind in kinds.split()}
#: A thin slab this far up or less stands on posts, metres.
_CANOPY_UNDERSIDE_M, _CANOPY_THICKNESS_M = (2.0, 9.0), 1.3

# Colours, sRGB in [0, 1], as they are seen on many streets (assumed).
_PLASTER = np.array(
    [(0.93, 0.88, 0.76), (0.90, 0.82, 0.62), (0.88, 0.74, 0.60), (0.86, 0.86, 0.84), (0.95, 0.93, 0.88),
     (0.80, 0.62, 0.50), (0.76, 0.80, 0.76), (0.84, 0.78, 0.70), (0.92, 0.80, 0.70), (0.74, 0.76, 0.80)]
)  # fmt: skip
_STONE = np.array([(0.80, 0.75, 0.66), (0.74, 0.72, 0.68), (0.85, 0.80, 0.70), (0.70, 0.66, 0.60)])
_CONCRETE = np.array([(0.74, 0.74, 0.73), (0.66, 0.67, 0.68), (0.80, 0.78, 0.74), (0.58, 0.60, 0.62)])
_METAL = np.array([(0.62, 0.66, 0.70), (0.74, 0.74, 0.72), (0.52, 0.60, 0.56), (0.70, 0.60, 0.52)])
_BRICK_TINT = np.array([(1.0, 1.0, 1.0), (0.88, 0.86, 0.86), (1.0, 0.94, 0.86), (0.80, 0.86, 0.90)])
_GLASS_TINT = np.array([(0.90, 0.96, 1.0), (0.78, 0.86, 0.92), (0.84, 0.96, 0.94), (0.72, 0.76, 0.80)])
_TILES = np.array([(0.70, 0.36, 0.26), (0.62, 0.31, 0.24), (0.56, 0.33, 0.27), (0.42, 0.40, 0.41), (0.36, 0.37, 0.40)])
_FELT = np.array([(0.50, 0.50, 0.50), (0.42, 0.42, 0.43), (0.60, 0.59, 0.56)])
_TRIM = np.array([(0.93, 0.92, 0.88), (0.86, 0.84, 0.79), (0.74, 0.72, 0.68)])
_DOOR = np.array([(0.36, 0.24, 0.15), (0.18, 0.28, 0.22), (0.45, 0.14, 0.12), (0.16, 0.22, 0.36), (0.24, 0.24, 0.25)])
#: What the brick facade's own red is, for the walls beside it.
BRICK_RED = np.array((0.72, 0.42, 0.33))


@dataclass(frozen=True, slots=True, eq=False)
class Styles:
    """How each building is built: arrays with one row for each.

    Attributes:
        keys: Of the draws, uint64.
        family: Values of `Family`.
        windows: The `Material` of walls with windows, uint8.
        plain: The `Material` of walls without.
        windows_colour: Shape (n, 3).
        plain_colour: Shape (n, 3), of a wall without windows that looks the same.
        trim_colour: Of cornices and frames.
        roof_colour: Of what is laid on the roof.
        door_colour: Of the doors.
        pitched: Whether it has a roof of tiles, where its footprint allows.
        base_m: Height of the underside, 0 on the ground.
        top_m: Height of the highest point.
        ground_m: Where the ground floor ends; equal to ``base_m`` where it is like the others.
        shops: Whether the ground floor is shop fronts.
        storey_m: About how high a storey is.
    """

    keys: NDArray[np.uint64]
    family: Ints
    windows: NDArray[np.uint8]
    plain: NDArray[np.uint8]
    windows_colour: Floats
    plain_colour: Floats
    trim_colour: Floats
    roof_colour: Floats
    door_colour: Floats
    pitched: Bools
    base_m: Floats
    top_m: Floats
    ground_m: Floats
    shops: Bools
    storey_m: Floats

    def draw(self, purpose: int) -> Floats:
        """Return a number in [0, 1) for each building; the same purpose gives the same ones."""
        return mixed_draw(self.keys, purpose)


def mixed_draw(keys: NDArray[np.uint64], purpose: int) -> Floats:
    """Return a number in [0, 1) for each key (the finaliser of SplitMix64, as in `reasoned_explorer.model.draws`)."""
    state = keys + np.uint64((purpose * 0x9E3779B97F4A7C15 + 0xD1342543DE82EF95) % (1 << 64))
    state = (state ^ (state >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    state = (state ^ (state >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    mixed: Floats = ((state ^ (state >> np.uint64(31))) >> np.uint64(11)).astype(np.float64) / float(1 << 53)
    return mixed


def styles_of(buildings: Sequence[Building], footprints: Footprints, *, seed: int) -> Styles:
    """Choose how buildings are built; what is chosen for one does not depend on the others."""
    keys = np.array([_key(one, seed) for one in buildings], dtype=np.uint64)
    top = np.array([one.height_m for one in buildings], dtype=np.float64)
    base = np.array([min(max(one.min_height_m, 0.0), one.height_m - 0.05) for one in buildings], dtype=np.float64)
    family = _families(buildings, footprints, keys, base, top)
    windows, plain = _walls(family, keys, top)
    colour, plain_colour = _wall_colours(windows, plain, keys)
    pitched = _pitched(family, keys, top, base)
    roof = _picked(_TILES, keys, 5)
    roof[~pitched] = _picked(_FELT, keys, 5)[~pitched]
    shops = _shops(family, keys, top - base)
    ground = np.select(
        [shops, family == Family.OFFICE, family == Family.FLATS], [base + 4.0, base + 3.8, base + 3.3], base
    )
    ground = np.where(top - ground < 3.0, base, ground)
    return Styles(
        keys,
        family,
        windows,
        plain,
        colour,
        plain_colour,
        _picked(_TRIM, keys, 6),
        roof,
        _picked(_DOOR, keys, 7),
        pitched,
        base,
        top,
        ground,
        shops & (ground > base),
        np.where(family == Family.HOUSE, 2.75, 3.1),
    )


def _key(building: Building, seed: int) -> int:
    """Return what tells a building from others: where it is and how high."""
    x, y = (round(1000.0 * float(value)) for value in (building.outer[0] if len(building.outer) else (0.0, 0.0)))
    return key_of(seed, "building", x, y, round(1000.0 * building.height_m))


def _picked(palette: Floats, keys: NDArray[np.uint64], purpose: int) -> Floats:
    """Return a colour of a palette for each building, a little lighter or darker by another draw."""
    colour = palette[(mixed_draw(keys, purpose) * len(palette)).astype(np.int64)]
    shade = 0.94 + 0.1 * mixed_draw(keys, purpose + 100)
    picked: Floats = np.clip(colour * shade[:, None], 0.0, 1.0)
    return picked


def _families(
    buildings: Sequence[Building], footprints: Footprints, keys: NDArray[np.uint64], base: Floats, top: Floats
) -> Ints:
    """Return the family of each building: by its kind, else by its size and a draw."""
    known = np.array([_FAMILY_OF.get(one.kind, -1) for one in buildings], dtype=np.int64)
    draw, areas, tall = mixed_draw(keys, 1), footprints.areas, top - base
    other = np.select([draw < 0.5, draw < 0.75], [Family.FLATS, Family.OFFICE], Family.SHOP)
    guess = np.select(
        [(tall < 4.6) & (areas < 400.0), (areas < 220.0) & (tall < 9.6), areas > 3500.0],
        [Family.HUT, Family.HOUSE, Family.OFFICE],
        other,
    )
    thin = (base >= _CANOPY_UNDERSIDE_M[0]) & (base <= _CANOPY_UNDERSIDE_M[1]) & (tall <= _CANOPY_THICKNESS_M)
    family = np.where(known >= 0, known, guess)
    # A roof that stands on the ground is a hut; so is anything else that is very low.
    family = np.where((family == Family.CANOPY) & (base < _CANOPY_UNDERSIDE_M[0]), Family.HUT, family)
    family = np.where((tall < 3.2) & (family != Family.CANOPY) & (family != Family.GLASSHOUSE), Family.HUT, family)
    found: Ints = np.where(thin, Family.CANOPY, family).astype(np.int64)
    return found


def _walls(family: Ints, keys: NDArray[np.uint64], top: Floats) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    """Return the materials of walls with and without windows."""
    draw = mixed_draw(keys, 2)
    glass = ((family == Family.OFFICE) & (draw > np.where(top > 30.0, 0.25, 0.62))) | (family == Family.GLASSHOUSE)
    glass |= (family == Family.SHOP) & (draw > 0.9)
    brick_share = np.select(
        [family == Family.HOUSE, family == Family.HALL, family == Family.FLATS, family == Family.TOWER],
        [0.34, 0.6, 0.24, 0.4],
        0.18,
    )
    brick = ~glass & (draw < brick_share) & (family != Family.HUT) & (family != Family.CHURCH)
    brick |= (family == Family.CHURCH) & (draw < 0.3)
    stony = (family == Family.CHURCH) | (family == Family.TOWER)
    windows = np.select([glass, brick], [Material.FACADE_GLASS, Material.FACADE_BRICK], Material.FACADE)
    plain = np.select(
        [glass, brick, stony, (family == Family.HALL) | (family == Family.CANOPY)],
        [Material.CONCRETE, Material.BRICK, Material.STONE, Material.METAL],
        Material.PLASTER,
    )
    return windows.astype(np.uint8), plain.astype(np.uint8)


def _wall_colours(
    windows: NDArray[np.uint8], plain: NDArray[np.uint8], keys: NDArray[np.uint64]
) -> tuple[Floats, Floats]:
    """Return the colours of walls with and without windows."""
    colour = _picked(_PLASTER, keys, 4)
    for material, palette in ((Material.STONE, _STONE), (Material.CONCRETE, _CONCRETE), (Material.METAL, _METAL)):
        colour = np.where((plain == material)[:, None], _picked(palette, keys, 4), colour)
    tint = _picked(_BRICK_TINT, keys, 4)
    brick = (plain == Material.BRICK)[:, None]
    glass = (windows == Material.FACADE_GLASS)[:, None]
    with_windows = np.where(glass, _picked(_GLASS_TINT, keys, 4), np.where(brick, tint, colour))
    return with_windows, np.where(brick, tint * BRICK_RED, colour)


def _pitched(family: Ints, keys: NDArray[np.uint64], top: Floats, base: Floats) -> Bools:
    """Return which buildings are to have a roof of tiles."""
    draw = mixed_draw(keys, 3)
    share = np.select(
        [family == Family.HOUSE, (family == Family.CHURCH) | (family == Family.TOWER), family == Family.FLATS,
         family == Family.HALL, family == Family.OFFICE, family == Family.SHOP],
        [0.94, 1.0, 0.5, 0.4, 0.22, 0.25],
        0.0,
    )  # fmt: skip
    tall = top - base
    low_enough = (top < 27.0) | (family == Family.CHURCH) | (family == Family.TOWER)
    pitched: Bools = (draw < share) & (tall > 4.0) & low_enough
    return pitched


def _shops(family: Ints, keys: NDArray[np.uint64], tall: Floats) -> Bools:
    """Return which buildings have shop fronts along their ground floors."""
    draw = mixed_draw(keys, 8)
    share = np.select([family == Family.SHOP, family == Family.FLATS, family == Family.OFFICE], [1.0, 0.3, 0.18], 0.0)
    shops: Bools = (draw < share) & (tall > 7.0)
    return shops
