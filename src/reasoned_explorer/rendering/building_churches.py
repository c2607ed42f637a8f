"""What makes churches and towers: tall windows, shafts with spires."""

import numpy as np
import shapely

from reasoned_explorer.rendering.building_roofs import Roofs
from reasoned_explorer.rendering.building_styles import Family, Styles
from reasoned_explorer.rendering.footprints import Floats, Footprints
from reasoned_explorer.rendering.material import Material
from reasoned_explorer.rendering.patches import Patch, boxes, lifted, quads, rectangle_uvs
from reasoned_explorer.rendering.wall_spots import Finish, Spots, pointed_panels

_DARK_GLASS, _LOUVRES, _COPPER = (
    np.array((0.20, 0.24, 0.34)),
    np.array((0.16, 0.15, 0.14)),
    np.array((0.35, 0.47, 0.42)),
)
#: Of a tower's height, where its spire begins.
_SHAFT = 0.7
_WIDTHS_M = (3.2, 8.0)


def church_windows(prints: Footprints, styles: Styles, roofs: Roofs) -> list[Patch]:
    """Return tall windows along the walls of churches, and slits in towers."""
    tall = roofs.eaves_m - styles.base_m
    slim = styles.family == Family.TOWER
    wanted = ((styles.family == Family.CHURCH) | slim) & (tall > 4.0)
    edges = np.flatnonzero(wanted[prints.owners] & (prints.lengths > 2.4))
    spots = Spots.spaced(prints, edges, every_m=4.2, margin_m=0.8)
    owner = spots.owners
    low = styles.base_m[owner] + np.where(slim[owner], 0.55, 0.28) * tall[owner]
    high = styles.base_m[owner] + 0.84 * tall[owner]
    wide = np.where(slim[owner], 0.7, np.minimum(1.3, 0.35 * (high - low) + 0.3))
    frame, pane = Finish(styles.trim_colour[owner], int(Material.STONE)), Finish(_DARK_GLASS, int(Material.GLASS))
    return [
        pointed_panels(spots.moved(out_m=0.03), frame, wide_m=wide + 0.4, low_m=low - 0.2, high_m=high + 0.25),
        pointed_panels(spots.moved(out_m=0.06), pane, wide_m=wide, low_m=low, high_m=high),
    ]


def towers(prints: Footprints, styles: Styles, roofs: Roofs) -> list[Patch]:
    """Return church towers at one end of the nave: a square shaft, a ledge, openings for the bells, a spire."""
    spots, wide = _tower_places(prints, roofs)
    owner = spots.owners
    base, top = styles.base_m[owner], styles.top_m[owner]
    shaft = base + _SHAFT * (top - base)
    wall = Finish(styles.plain_colour[owner], styles.plain[owner])
    ledge = Finish(styles.trim_colour[owner], int(Material.STONE))
    parts = [
        _shafts(spots, wide, base, shaft, wall),
        _shafts(spots, wide + 0.5, shaft - 0.4, shaft + 0.1, ledge),
    ]
    spire = Finish(_COPPER * (0.85 + 0.3 * styles.draw(41)[owner])[:, None], int(Material.ROOF_TILES))
    for side in _sides(spots, wide):
        left, right = (side.moved(aside_m=way * wide / 2.0).places for way in (-1.0, 1.0))
        face = quads(lifted(left, shaft + 0.1), lifted(right, shaft + 0.1), lifted(spots.places, top))
        uvs = rectangle_uvs(0.0, 0.0, wide, top - shaft, len(owner))[:, :3]
        parts.append(Patch.of(face, uvs, colours=spire.colours, materials=spire.materials, owners=owner))
        parts.append(
            pointed_panels(
                side.moved(out_m=0.05),
                Finish(_LOUVRES, int(Material.PLAIN)),
                wide_m=0.32 * wide,
                low_m=shaft - 0.36 * (shaft - base),
                high_m=shaft - 0.14 * (shaft - base),
            )
        )
    return parts


def _shafts(spots: Spots, wide: Floats, low: Floats, high: Floats, finish: Finish) -> Patch:
    return boxes(
        spots.places,
        spots.along,
        length_m=wide,
        width_m=wide,
        low_m=low,
        high_m=high,
        colours=finish.colours,
        materials=finish.materials,
        owners=spots.owners,
        bottom=True,
    )


def _sides(spots: Spots, wide: Floats) -> list[Spots]:
    """Return the middles of the four walls of square towers."""
    found, along, out = [], spots.along, spots.out
    for _ in range(4):
        found.append(Spots(spots.places + out * (wide / 2.0)[:, None], along, out, spots.owners))
        # Turned by a quarter.
        along, out = out * -1.0, along
    return found


def _tower_places(prints: Footprints, roofs: Roofs) -> tuple[Spots, Floats]:
    """Return the middles of towers along their naves, and how wide they are, metres."""
    owners: list[int] = []
    rows: list[list[float]] = []
    for owner in np.flatnonzero(roofs.tower).tolist():
        plan = shapely.Polygon(prints.corners[(prints.owners == owner) & ~prints.in_court])
        box = np.asarray(shapely.minimum_rotated_rectangle(plan).exterior.coords)[:4]
        if np.hypot(*(box[1] - box[0])) < np.hypot(*(box[2] - box[1])):
            box = np.roll(box, -1, axis=0)
        long, short = box[1] - box[0], box[2] - box[1]
        length = float(np.hypot(*long))
        wide = float(np.clip(0.34 * float(np.hypot(*short)), *_WIDTHS_M))
        # At one end of the long axis, else further in, until it stands on the church.
        for share in (0.5 * wide / length + 0.01, 0.12, 0.2, 0.3, 0.5):
            middle = box[0] + share * long + 0.5 * short
            if shapely.contains(plan.buffer(0.3), shapely.Point(middle).buffer(wide / 2.0)):
                owners.append(owner)
                rows.append([*middle.tolist(), *(long / length).tolist(), wide])
                break
    table = np.array(rows, dtype=np.float64).reshape(-1, 5)
    along = table[:, 2:4]
    out = np.column_stack([along[:, 1], -along[:, 0]])
    return Spots(table[:, :2], along, out, np.array(owners, dtype=np.int64)), table[:, 4]
