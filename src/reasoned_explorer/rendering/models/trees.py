"""Trees of several kinds, bushes and planters."""

import math
from dataclasses import dataclass

import numpy as np

from reasoned_explorer.model.draws import key_of
from reasoned_explorer.rendering.mesh_builder import FAR, MeshBuilder, Surface
from reasoned_explorer.rendering.models.foliage import (
    Crown,
    FloatArray,
    add_cores,
    add_far_crown,
    add_leaves,
    add_tufts,
    crown_of,
)
from reasoned_explorer.rendering.models.maker import Maker
from reasoned_explorer.rendering.models.palette import BARK, CONCRETE, DARK_WOOD, LEAVES, SOIL, plain

_BIRCH_BARK = Surface(BARK.material, (0.88, 0.87, 0.83))
_PINE_BARK = Surface(BARK.material, (0.50, 0.33, 0.22))
_GREENS = (
    (0.33, 0.47, 0.17),
    (0.27, 0.43, 0.18),
    (0.38, 0.50, 0.20),
    (0.30, 0.42, 0.15),
    (0.42, 0.52, 0.20),
    (0.24, 0.39, 0.20),
)


@dataclass(frozen=True, slots=True)
class _Kind:
    """A kind of broad-leaved tree, 9 m high.

    Attributes:
        seed: Of its irregularity.
        clumps: How many there are.
        middle_m: Height of the middle of its crown.
        reach_m: Half axes of its crown.
        clump_m: Usual radius of a clump.
        narrow: As of `crown_of`.
        trunk_m: Radius of the trunk at its foot.
        bark: Of the trunk.
        leaves: Of the crown.
        airy: Share of the core that is left out: the sky shows through.
    """

    seed: int
    clumps: int
    middle_m: float
    reach_m: tuple[float, float, float]
    clump_m: float
    narrow: float
    trunk_m: float
    bark: Surface = BARK
    leaves: Surface = LEAVES
    airy: float = 0.0


_LIME = Surface(LEAVES.material, (0.94, 0.97, 0.92))
_OAK = Surface(LEAVES.material, (0.84, 0.88, 0.78))
_BIRCH = Surface(LEAVES.material, (1.0, 1.0, 0.86))
_SPRUCE = Surface(LEAVES.material, (0.58, 0.74, 0.80))
_PINE = Surface(LEAVES.material, (0.70, 0.82, 0.78))

_KINDS = (
    _Kind(1, 15, 5.6, (2.6, 2.6, 3.35), 1.25, 0.12, 0.22, leaves=_LIME),
    _Kind(2, 17, 6.1, (2.7, 2.7, 2.85), 1.15, -0.12, 0.28, leaves=_OAK),
    _Kind(3, 16, 5.35, (2.55, 2.55, 3.6), 1.05, 0.2, 0.2, leaves=_LIME),
    _Kind(4, 13, 5.9, (2.55, 2.55, 3.0), 1.3, 0.0, 0.25, leaves=_OAK),
    _Kind(5, 18, 5.4, (2.35, 2.35, 3.55), 0.8, 0.22, 0.14, _BIRCH_BARK, _BIRCH, 0.3),
    _Kind(6, 16, 5.6, (2.5, 2.5, 3.4), 0.85, 0.1, 0.13, _BIRCH_BARK, _BIRCH, 0.35),
)
#: Variants after the broad-leaved ones: two spruces and a pine.
_SPRUCES = (11, 12)


def _tree(builder: MeshBuilder, variant: int) -> None:
    if variant < len(_KINDS):
        _broadleaf(builder, _KINDS[variant])
    elif variant < len(_KINDS) + len(_SPRUCES):
        _spruce(builder, _SPRUCES[variant - len(_KINDS)])
    else:
        _pine(builder)


def _rng(*keys: int | str) -> np.random.Generator:
    return np.random.default_rng(key_of(0, "leaves", *keys))


def _broadleaf(builder: MeshBuilder, kind: _Kind) -> None:
    """A trunk with boughs and a crown of clumps with tufts all around."""
    crown = crown_of(
        _rng("crown", kind.seed), kind.clumps, (0, 0, kind.middle_m), kind.reach_m, kind.clump_m, narrow=kind.narrow
    )
    if builder.detail == FAR:
        _far_crown(builder, kind)
        return
    _trunk(builder, kind, crown)
    rng = _rng("tufts", kind.seed)
    cores = Crown(crown.centres, crown.radii * (0.88 - kind.airy), crown.middle, crown.reach)
    if builder.detail == 2:
        keep = np.arange(0, kind.clumps, 2)
        cores = Crown(cores.centres[keep], cores.radii[keep] * (2.2 if kind.airy else 1.75), crown.middle, crown.reach)
    add_cores(builder, kind.leaves, cores, rng, fine=False)
    count, size = ((270, 0.45), (115, 0.66), (22, 0.9))[builder.detail]
    thin = 0.9 if kind.airy else 1.0
    add_tufts(builder, kind.leaves, crown, rng, count=count, size_m=size * thin)
    if builder.detail == 0:
        # Sprays around the masses: seen from below, they are what the outline is made of.
        add_tufts(builder, kind.leaves, crown, rng, count=300, size_m=0.29 * thin, spread=1.06, slim=0.75)


def _far_crown(builder: MeshBuilder, kind: _Kind) -> None:
    """A stem and an egg, two dozen triangles."""
    reach_x, _, reach_z = kind.reach_m
    bands = [(0.0, -1.0), (1.0 + 0.5 * kind.narrow, -0.3), (0.9 - 0.5 * kind.narrow, 0.4), (0.0, 1.0)]
    profile = [(reach_x * r, kind.middle_m + reach_z * z) for r, z in bands]
    builder.cylinder(kind.bark, (0, 0, 0), (0, 0, kind.middle_m - 0.5 * reach_z), kind.trunk_m, capped=False)
    add_far_crown(builder, kind.leaves.shaded(0.78), profile)


def _trunk(builder: MeshBuilder, kind: _Kind, crown: Crown) -> None:
    rng = _rng("trunk", kind.seed)
    top = kind.middle_m + 0.45 * kind.reach_m[2]
    heights = np.array([0.0, 0.25, 1.6, kind.middle_m - 0.6 * kind.reach_m[2], top])
    lean = rng.normal(0.0, 0.09, (5, 2)) * np.minimum(heights, 3.0)[:, None] / 3.0
    radii = kind.trunk_m * np.array([1.45, 1.0, 0.85, 0.75, 0.25])
    path = np.column_stack([lean, heights])
    keep = ([0, 1, 2, 3, 4], [0, 2, 4], [0, 3])[builder.detail]
    builder.tube(kind.bark, path[keep], radii[keep], sides=8)
    if builder.detail > 1:
        return
    if kind.bark is _BIRCH_BARK and builder.detail == 0:
        _birch_marks(builder, path, radii, rng)
    boughs = np.argsort(crown.centres[:, 2])[: (5, 3)[builder.detail]]
    for place in boughs:
        end = crown.centres[place]
        start = np.array([*lean[3], heights[3] - 0.2 + 0.22 * (place % 4)])
        middle = 0.5 * (start + end) + np.array([0, 0, -0.25])
        builder.tube(kind.bark, [start, middle, end][:: 1 if builder.detail == 0 else 2], 0.3 * kind.trunk_m, sides=4)


def _birch_marks(builder: MeshBuilder, path: FloatArray, radii: FloatArray, rng: np.random.Generator) -> None:
    """Dark scars across the white bark."""
    for _ in range(14):
        height, angle = rng.uniform(0.3, 2.6), rng.uniform(0, 2 * math.pi)
        radius = 1.03 * float(np.interp(height, path[:, 2], radii))
        centre = np.array([np.interp(height, path[:, 2], path[:, axis]) for axis in range(2)] + [height])
        out = np.array([math.cos(angle), math.sin(angle), 0.0])
        side = np.array([-out[1], out[0], 0.0]) * rng.uniform(0.25, 0.5) * radius
        at, up = centre + out * radius, np.array([0, 0, rng.uniform(0.02, 0.05)])
        builder.decal(plain(0.16, 0.15, 0.14), [at - side - up, at + side - up, at + side + up, at - side + up])


def _spruce(builder: MeshBuilder, seed: int) -> None:
    """A straight stem with fronds that droop, longer from tier to tier downward."""
    rng = _rng("spruce", seed)
    wide, low = 1.95, 0.7
    builder.cylinder(BARK, (0, 0, 0), (0, 0, 2.0), 0.19, 0.16, sides=8, capped=False)
    if builder.detail == FAR:
        add_far_crown(builder, _SPRUCE.shaded(0.75), [(wide, low), (0.5 * wide, 4.0), (0.0, 9.0)])
        return
    full = 0.68 if builder.detail < 2 else 0.85
    core = [(0.2, low), (full * wide, low + 0.45), (0.62 * full * wide, 4.0), (0.25 * full * wide, 7.0), (0.0, 8.75)]
    builder.lathe(_SPRUCE.shaded(0.5), core, sides=9)
    tiers = (23, 11, 6)[builder.detail]
    corners: list[FloatArray] = []
    shades: list[float] = []
    for tier in range(tiers):
        share = (tier + 0.3) / tiers
        height = low + 0.35 + (8.55 - low) * share
        length = wide * (1.0 - share) ** 0.85 + 0.22
        fronds = max(5, round((20, 9, 6)[builder.detail] * (1.0 - 0.6 * share)))
        for frond in range(fronds):
            angle = 2 * math.pi * (frond + 0.5 * (tier % 2) + rng.uniform(-0.3, 0.3)) / fronds
            _frond(corners, angle, height + rng.uniform(-0.12, 0.12), length * rng.uniform(0.78, 1.08), fronds)
            shades.extend([0.92 * rng.uniform(0.8, 1.15)] * 2)
    lone = np.array([[(-0.12, 0, 8.3), (0.12, 0, 8.3), (0, 0, 9.0)], [(0, -0.12, 8.3), (0, 0.12, 8.3), (0, 0, 9.0)]])
    triangles = np.concatenate([np.array(corners), lone])
    middles = triangles.mean(axis=1)
    away = middles / np.maximum(np.linalg.norm(middles[:, :2], axis=1, keepdims=True), 0.3)
    lit = np.column_stack([away[:, :2], np.full(len(away), 0.75)])
    lit /= np.linalg.norm(lit, axis=1, keepdims=True)
    add_leaves(builder, _SPRUCE, triangles, lit, np.array([*shades, 1.0, 1.0]))


def _frond(corners: list[FloatArray], angle: float, height: float, length: float, fronds: int) -> None:
    """A branch with needles: two triangles that meet in a spine, their edges lower than it."""
    out = np.array([math.cos(angle), math.sin(angle), 0.0])
    side = np.array([-out[1], out[0], 0.0]) * length * math.tan(math.pi / max(fronds, 6)) * 0.66
    root = np.array([0, 0, height]) + 0.1 * out
    tip = np.array([0, 0, height - 0.42 * length - 0.08]) + length * out
    hand = np.array([0, 0, height - 0.36 * length - 0.12]) + 0.62 * length * out
    corners.extend([np.array([root, hand + side, tip]), np.array([root, tip, hand - side])])


def _pine(builder: MeshBuilder) -> None:
    """A tall bare stem of reddish bark with flat clouds of needles at its top."""
    rng = _rng("pine")
    clouds = np.array(
        [
            (-1.5, 0.4, 5.6, 1.0),
            (1.4, -0.7, 6.0, 1.05),
            (0.3, 1.5, 6.5, 1.0),
            (-0.6, -1.4, 6.9, 1.0),
            (1.1, 0.8, 7.5, 0.95),
            (-0.9, 0.5, 7.8, 0.9),
            (0.1, -0.3, 8.35, 0.85),
        ]
    )
    crown = Crown(clouds[:, :3], clouds[:, 3], np.array([0, 0, 6.6]), np.array([2.7, 2.7, 2.4]), flat=0.55)
    if builder.detail == FAR:
        builder.cylinder(_PINE_BARK, (0, 0, 0), (0, 0, 5.6), 0.18, 0.12, sides=10, capped=False)
        add_far_crown(builder, _PINE.shaded(0.75), [(0, 4.8), (2.4, 5.8), (1.5, 7.6), (0.0, 9.0)])
        return
    stem = [(0, 0, 0), (0.08, 0, 2.5), (-0.05, 0.1, 5.0), (0.05, 0, 8.2)]
    builder.tube(
        _PINE_BARK,
        stem[:: 1 if builder.detail == 0 else 3],
        [0.24, 0.18, 0.15, 0.05][:: 1 if builder.detail == 0 else 3],
        sides=8,
    )
    for cloud in clouds if builder.detail < 2 else ():
        builder.tube(_PINE_BARK, [(0, 0, cloud[2] - 0.9), cloud[:3] * np.array([0.8, 0.8, 1.0])], 0.06, sides=4)
    add_cores(builder, _PINE, crown, rng, fine=builder.detail == 0)
    count, size = ((480, 0.34), (90, 0.55), (16, 0.9))[builder.detail]
    add_tufts(builder, _PINE, crown, rng, count=count, size_m=size)


def _shrub(builder: MeshBuilder, variant: int) -> None:
    """Leaves down to the ground; one variant in flower."""
    crown = crown_of(_rng("shrub", variant), 9, (0, 0, 0.62), (0.72, 0.72, 0.6), 0.34)
    if builder.detail == FAR:
        add_far_crown(builder, _LIME.shaded(0.75), [(0.5, 0.0), (0.75, 0.5), (0.4, 1.1), (0.0, 1.3)])
        return
    rng = _rng("shrub tufts", variant)
    builder.lathe(_OAK.shaded(0.55), [(0.42, 0.0), (0.6, 0.4), (0.4, 0.8), (0.0, 0.95)], sides=8)
    add_cores(builder, (_LIME, _OAK, _LIME)[variant], crown, rng, fine=False)
    count, size = ((250, 0.15), (60, 0.24), (12, 0.3))[builder.detail]
    add_tufts(builder, (_LIME, _OAK, _LIME)[variant], crown, rng, count=count, size_m=size)
    if variant == 2:
        bloom = plain(0.92, 0.55, 0.72)
        add_tufts(
            builder, bloom, crown, rng, count=(50, 22, 8)[builder.detail], size_m=(0.07, 0.1, 0.16)[builder.detail]
        )


_BLOOMS = (plain(0.90, 0.12, 0.20), plain(0.98, 0.80, 0.15), plain(0.95, 0.92, 0.94), plain(0.72, 0.25, 0.65))


def _planter(builder: MeshBuilder, variant: int) -> None:
    """A tub of concrete, a box of planks or a round pot, full of leaves and flowers."""
    tub = (CONCRETE, DARK_WOOD, plain(0.66, 0.36, 0.24))[variant]
    if builder.detail == FAR:
        builder.cylinder(tub, (0, 0, 0), (0, 0, 0.52), 0.68, 0.7, sides=13, capped=False)
        builder.cylinder(LEAVES.shaded(0.75), (0, 0, 0.5), (0, 0, 0.9), 0.62, 0.3, sides=13)
        return
    if variant == 2:
        builder.lathe(tub, [(0.36, 0.0), (0.46, 0.4), (0.5, 0.42), (0.5, 0.5), (0.44, 0.5), (0.42, 0.44)], sides=16)
    else:
        rings = [[(x * k, y * k, z) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))] for k, z in _TUB]
        builder.loft(tub, rings, smooth=False)
    if variant == 1 and builder.detail <= 1:
        for z in (0.14, 0.36):
            builder.box(DARK_WOOD.shaded(0.7), (-0.495, -0.495, z), (0.495, 0.495, z + 0.03))
    builder.box(SOIL, (-0.36, -0.36, 0.4), (0.36, 0.36, 0.49))
    rng = _rng("planter", variant)
    crown = crown_of(rng, 7, (0, 0, 0.6), (0.44, 0.44, 0.24), 0.19)
    add_cores(builder, LEAVES.shaded(0.95), crown, rng, fine=builder.detail == 0)
    count, size = ((110, 0.11), (30, 0.17), (8, 0.2))[builder.detail]
    add_tufts(builder, LEAVES, crown, rng, count=count, size_m=size)
    for surface in _BLOOMS:
        blooms, bloom = ((26, 0.075), (10, 0.1), (3, 0.15))[builder.detail]
        add_tufts(builder, surface, crown, rng, count=blooms, size_m=bloom, spread=1.25)


_TUB = ((0.44, 0.0), (0.5, 0.44), (0.5, 0.5), (0.42, 0.5), (0.42, 0.46))

MAKERS = {
    "tree": Maker(_tree, variants=len(_KINDS) + len(_SPRUCES) + 1, tints=_GREENS, fits="height"),
    "shrub": Maker(_shrub, variants=3, tints=_GREENS),
    "planter": Maker(_planter, variants=3, tints=_GREENS),
}
