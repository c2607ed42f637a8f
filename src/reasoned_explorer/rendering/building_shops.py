"""Ground floors of shops: fronts side by side, their windows, awnings before some."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.rendering.building_doors import Doors
from reasoned_explorer.rendering.building_roofs import Roofs
from reasoned_explorer.rendering.building_styles import Styles, mixed_draw
from reasoned_explorer.rendering.footprints import Bools, Floats, Footprints
from reasoned_explorer.rendering.fronts import clear_of
from reasoned_explorer.rendering.material import Material
from reasoned_explorer.rendering.patches import Patch, lifted, quads, rectangle_uvs
from reasoned_explorer.rendering.wall_spots import Spots, runs

#: How wide a shop is about, and what its texture shows: the whole, and its window (left, low, right, high), metres.
_USUAL_M, _SHOP_M = 4.6, 4.0
_WINDOW_M = (0.38, 0.60, 3.62, 2.80)
#: Shorter walls have no shops, metres.
_LEAST_WALL_M = 2.5
_PANE_OUT_M = 0.02
#: Of shops: how many have their shutters down, and how many an awning.
_SHUT, _SHADED = 0.12, 0.3
#: Of an awning: how high it begins, as a share of the front; how far it reaches and falls, metres.
_AWNING_HIGH, _AWNING_OUT_M, _AWNING_FALL_M = 0.70, 1.0, 0.42
_SHUTTER = np.array((0.66, 0.67, 0.68))
_PANES = np.array([(1.0, 1.0, 1.0), (1.0, 0.96, 0.86), (0.86, 0.92, 1.0), (0.78, 0.78, 0.80)])
_FRONTS = np.array(
    [
        (0.82, 0.80, 0.76),
        (0.30, 0.42, 0.38),
        (0.62, 0.22, 0.20),
        (0.24, 0.32, 0.52),
        (0.86, 0.66, 0.30),
        (0.34, 0.34, 0.36),
        (0.72, 0.72, 0.74),
        (0.40, 0.52, 0.30),
        (0.78, 0.44, 0.26),
        (0.52, 0.42, 0.34),
        (0.88, 0.87, 0.83),
        (0.56, 0.60, 0.62),
    ]
)
_CLOTHS = np.array(
    [
        (0.70, 0.20, 0.18),
        (0.20, 0.42, 0.30),
        (0.22, 0.32, 0.52),
        (0.90, 0.86, 0.76),
        (0.85, 0.55, 0.22),
        (0.4, 0.4, 0.42),
    ]
)


@dataclass(frozen=True, slots=True, eq=False)
class Shops:
    """Shops, one row each.

    Attributes:
        spots: The middles of their feet.
        wide_m: Across, shape (n,).
        low_m: Where they begin.
        high_m: Where they end.
        keys: Of the draws, uint64.
    """

    spots: Spots
    wide_m: Floats
    low_m: Floats
    high_m: Floats
    keys: NDArray[np.uint64]

    def draw(self, purpose: int) -> Floats:
        """Return a number in [0, 1) for each."""
        return mixed_draw(self.keys, purpose)

    def where(self, chosen: Bools) -> "Shops":
        """Return some of them."""
        return Shops(
            self.spots.where(chosen), self.wide_m[chosen], self.low_m[chosen], self.high_m[chosen], self.keys[chosen]
        )


def is_shop_wall(prints: Footprints, styles: Styles) -> Bools:
    """Return which walls have shops along their ground floors, shape (n,)."""
    return styles.shops[prints.owners] & ~prints.in_court & (prints.lengths >= _LEAST_WALL_M)


def shops_of(prints: Footprints, styles: Styles, roofs: Roofs) -> Shops:
    """Divide the walls with shops into shops side by side."""
    edges = np.flatnonzero(is_shop_wall(prints, styles))
    count = np.maximum(np.round(prints.lengths[edges] / _USUAL_M), 1.0).astype(np.int64)
    row, place = runs(count)
    wall = edges[row]
    wide = (prints.lengths[edges] / count)[row]
    owner = prints.owners[wall]
    keys = styles.keys[owner] + (prints.places[wall] * 64 + place).astype(np.uint64)
    high = np.minimum(styles.ground_m, roofs.eaves_m)[owner]
    return Shops(Spots.on(prints, wall, (place + 0.5) * wide), wide, styles.base_m[owner], high, keys)


def shop_fronts(shops: Shops) -> list[Patch]:
    """Return the fronts, each in a colour of its own, and what is in them: windows, or shutters."""
    spots, owners = shops.spots, shops.spots.owners
    whole = _upright(spots, -shops.wide_m / 2.0, shops.wide_m / 2.0, shops.low_m, shops.high_m)
    front = Patch.of(
        whole,
        rectangle_uvs(0.0, 0.0, _SHOP_M, _SHOP_M, len(owners)),
        colours=_picked(_FRONTS, shops.draw(12)),
        materials=int(Material.FACADE_SHOP),
        owners=owners,
    )
    left, low, right, high = _WINDOW_M
    scale, up = shops.wide_m / _SHOP_M, (shops.high_m - shops.low_m) / _SHOP_M
    begin, end = (left - _SHOP_M / 2.0) * scale, (right - _SHOP_M / 2.0) * scale
    bottom, top = shops.low_m + low * up, shops.low_m + high * up
    face = _upright(spots.moved(out_m=_PANE_OUT_M), begin, end, bottom, top)
    # Half of them the other way round.
    turned = shops.draw(13) < 0.5
    panes = Patch.of(
        face,
        rectangle_uvs(np.where(turned, right, left), low, np.where(turned, left, right), high, len(owners)),
        colours=_picked(_PANES, shops.draw(14)),
        materials=int(Material.FACADE_SHOP),
        owners=owners,
    )
    shutters = Patch.of(
        face,
        rectangle_uvs(0.0, 0.0, end - begin, top - bottom, len(owners)),
        colours=_SHUTTER,
        materials=int(Material.PLANKS),
        owners=owners,
    )
    shut = shops.draw(15) < _SHUT
    return [front, panes.where(~shut), shutters.where(shut)]


def awnings(shops: Shops, found: Doors, fronts: Floats) -> list[Patch]:
    """Return awnings before some shops: sloping sheets with a hanging edge, seen from above and below."""
    high = shops.low_m + _AWNING_HIGH * (shops.high_m - shops.low_m)
    wanted = (shops.draw(16) < _SHADED) & (shops.draw(15) >= _SHUT) & (high - shops.low_m > 2.6)
    doors = np.column_stack([found.spots.places, found.wide_m])
    wanted &= clear_of(shops.spots.places, fronts, shops.wide_m / 2.0)
    wanted &= clear_of(shops.spots.places, doors, shops.wide_m / 2.0 + 0.4)
    chosen, high = shops.where(wanted), high[wanted]
    half = 0.46 * chosen.wide_m
    near, far = chosen.spots.moved(out_m=0.03), chosen.spots.moved(out_m=_AWNING_OUT_M)
    ends = [(near.moved(aside_m=side * half).places, far.moved(aside_m=side * half).places) for side in (-1.0, 1.0)]
    (left, left_out), (right, right_out) = ends
    low = high - _AWNING_FALL_M
    slope = [lifted(left_out, low), lifted(right_out, low), lifted(right, high), lifted(left, high)]
    hem = [lifted(left_out, low - 0.16), lifted(right_out, low - 0.16), lifted(right_out, low), lifted(left_out, low)]
    colours = _picked(_CLOTHS, chosen.draw(17))
    return [
        Patch.of(
            quads(*(sheet if seen > 0 else sheet[::-1])),
            rectangle_uvs(0.0, 0.0, 2.0 * half, tall, len(half)),
            colours=colours * (1.0 if seen > 0 else 0.85),
            materials=int(Material.FABRIC),
            owners=chosen.spots.owners,
        )
        for sheet, tall in ((slope, 1.1), (hem, 0.16))
        for seen in (1, -1)
    ]


def _picked(palette: Floats, draw: Floats) -> Floats:
    picked: Floats = palette[(draw * len(palette)).astype(np.int64)]
    return picked


def _upright(spots: Spots, left_m: Floats, right_m: Floats, low_m: Floats, high_m: Floats) -> Floats:
    left, right = spots.moved(aside_m=left_m).places, spots.moved(aside_m=right_m).places
    return quads(lifted(left, low_m), lifted(right, low_m), lifted(right, high_m), lifted(left, high_m))
