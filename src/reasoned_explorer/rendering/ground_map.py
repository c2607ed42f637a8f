"""What ground is where for the eye, and what each kind of ground looks like."""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.rendering.crossings import Crossings, crossings_of
from reasoned_explorer.rendering.material import Material
from reasoned_explorer.world.raster import Canvas, GroundRaster, walls_of
from reasoned_explorer.world.taxonomy import Ground
from reasoned_explorer.world.world import World

_CELL_M = 0.25
#: Larger worlds get larger cells: one byte is kept for each.
_MAX_CELLS = 160_000_000


#: What no map knows is drawn as what lies around it: the codes of paved and of green ground that is a guess.
GUESSED_PAVED, GUESSED_GREEN = len(Ground), len(Ground) + 1
#: Where more than this share of dry land within about `_AROUND_M` is built over or paved, it is taken to be paved.
_PAVED_SHARE, _AROUND_M = 0.46, 45.0
#: Edge of the cells in which that is looked at, in cells of the map.
_COARSE = 8
_HARD = (Ground.ROAD, Ground.PAVEMENT, Ground.PLAZA, Ground.CYCLEWAY, Ground.STEPS, Ground.PARKING, Ground.RAILWAY,
         Ground.YARD, Ground.BUILDING)  # fmt: skip
Floats = NDArray[np.float64]


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
    # Only what lies beyond the world: it fades into the haze.
    Ground.UNKNOWN: GroundLook(Material.GRASS, (0.48, 0.51, 0.40)),
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


_GUESSED_LOOKS = (
    GroundLook(Material.COBBLES, (0.70, 0.69, 0.67)),
    GroundLook(Material.GRASS, (0.45, 0.49, 0.31)),
)
#: Of every code of a ground map.
LOOKS: tuple[GroundLook, ...] = (*(GROUND_LOOKS[ground] for ground in Ground), *_GUESSED_LOOKS)


def ground_materials() -> NDArray[np.uint8]:
    """Return the `Material` of every kind of ground by its code, the guessed ones last, shape (kinds,), uint8."""
    return np.array([look.material for look in LOOKS], dtype=np.uint8)


def ground_colours() -> NDArray[np.float32]:
    """Return the colour of every kind of ground by its code, sRGB in [0, 1], shape (kinds, 3), float32."""
    return np.array([look.colour for look in LOOKS], dtype=np.float32)


def ground_map_of(world: World, *, crossings: Crossings | None = None) -> GroundRaster:
    """Return what ground is where, as it is drawn.

    It is finer than the raster that vehicles go by, has no buildings (which stand on it), and the carriageway runs on
    below crossings, whose stripes are meshes. What is unknown in the world is `GUESSED_PAVED` or `GUESSED_GREEN`.

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
    _guess(world, ground)
    return ground


def _guess(world: World, ground: GroundRaster) -> None:
    """Set what is unknown to paved or green, whichever prevails around."""
    rows, columns = ground.codes.shape
    if ground.codes.min() > Ground.UNKNOWN:
        return
    share = _paved_share(world, ground)
    # Between the middles of coarse cells the share changes evenly, so that borders are smooth.
    across = (np.arange(columns) + 0.5) / _COARSE - 0.5
    fine = np.array([np.interp(across, np.arange(share.shape[1]), row) for row in share], np.float32)
    up = np.clip((np.arange(rows) + 0.5) / _COARSE - 0.5, 0.0, len(share) - 1.0)
    kinds = np.array([GUESSED_GREEN, GUESSED_PAVED], np.uint8)
    for line, height in zip(ground.codes, up.tolist(), strict=True):
        low = int(height)
        high = min(low + 1, len(share) - 1)
        level = fine[low] + np.float32(height - low) * (fine[high] - fine[low])
        np.copyto(line, kinds[(level > _PAVED_SHARE).view(np.uint8)], where=line == Ground.UNKNOWN)


def _paved_share(world: World, ground: GroundRaster) -> Floats:
    """Return in coarse cells which share of the dry land around is built over or paved, in [0, 1]."""
    sample = np.ascontiguousarray(ground.codes[_COARSE // 2 :: _COARSE, _COARSE // 2 :: _COARSE])
    if not sample.size:
        return np.zeros((1, 1))
    Canvas(sample, ground.min_x_m, ground.min_y_m, ground.cell_m * _COARSE).fill(walls_of(world), int(Ground.BUILDING))
    reach = max(1, round(_AROUND_M / 2.0 / (ground.cell_m * _COARSE)))
    hard, dry = np.isin(sample, _HARD).astype(np.float64), (sample != Ground.WATER).astype(np.float64)
    for _ in range(2):
        hard, dry = _blurred(hard, reach), _blurred(dry, reach)
    share: Floats = hard / np.maximum(dry, 1e-9)
    return share


def _blurred(values: Floats, reach: int) -> Floats:
    """Return the sums over squares of 2 · reach + 1 cells."""
    for axis in (0, 1):
        padded = np.pad(values, [(reach + 1, reach) if at == axis else (0, 0) for at in (0, 1)])
        total = np.cumsum(padded, axis=axis)
        wide = 2 * reach + 1
        count = values.shape[axis]
        values = np.take(total, np.arange(wide, wide + count), axis=axis) - np.take(total, np.arange(count), axis=axis)
    return values
