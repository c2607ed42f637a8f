"""Leaves: masses of them in clumps, with tufts that stick out so that no outline is smooth.

A crown is a set of clumps. Each is drawn as a rough dark core and as many loose leaf tufts (two-sided triangles) around
it, whose normals point away from the crown, so that light falls on it as on a rounded mass.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.rendering.mesh_builder import MeshBuilder, Surface

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Crown:
    """Where leaves are.

    Attributes:
        centres: Of the clumps, shape (n, 3), metres.
        radii: Of the clumps, shape (n,), metres.
        middle: Of the whole.
        reach: Half the extent of the whole along each axis, metres.
        flat: Height of a clump as a share of its width.
    """

    centres: FloatArray
    radii: FloatArray
    middle: FloatArray
    reach: FloatArray
    flat: float = 1.0

    def light(self, points: FloatArray) -> FloatArray:
        """Return how light it is at points, about 0.5 deep inside and below, 1 outside and at the top, shape (n,)."""
        away = (points - self.middle) / self.reach
        outside = np.clip(np.linalg.norm(away, axis=1), 0.0, 1.0)
        return np.asarray(0.52 + 0.3 * outside**2 + 0.2 * np.clip(0.5 + 0.5 * away[:, 2], 0.0, 1.0))

    def outward(self, points: FloatArray) -> FloatArray:
        """Return unit vectors away from the middle of the crown, shape (n, 3)."""
        return _unit((points - self.middle) / self.reach**2)


def crown_of(
    rng: np.random.Generator,
    count: int,
    middle: tuple[float, float, float],
    reach: tuple[float, float, float],
    clump: float,
    *,
    narrow: float = 0.0,
) -> Crown:
    """Return a crown of clumps spread over an egg.

    Args:
        rng: For irregularity.
        count: Of clumps.
        middle: Of the egg, metres.
        reach: Its half axes, metres.
        clump: Usual radius of a clump, metres.
        narrow: How much narrower it is at the top than at the bottom (0 not at all; negative: wider at the top).
    """
    # A spiral from pole to pole spreads points evenly over a sphere.
    height = 1.0 - 2.0 * (np.arange(count) + 0.5) / count
    turn = np.arange(count) * math.pi * (3.0 - math.sqrt(5.0)) + rng.uniform(0.0, 2.0 * math.pi)
    wide = np.sqrt(1.0 - height**2)
    unit = np.column_stack([wide * np.cos(turn), wide * np.sin(turn), height])
    unit = unit * rng.uniform(0.78, 1.08, (count, 1)) + rng.normal(0.0, 0.09, (count, 3))
    inner = np.asarray(reach) - 0.75 * clump
    places = unit * inner
    places[:, :2] *= (1.0 - narrow * unit[:, 2:3]).clip(0.3)
    radii = clump * rng.uniform(0.72, 1.25, count)
    return Crown(places + np.asarray(middle), radii, np.asarray(middle, np.float64), np.asarray(reach, np.float64))


def add_cores(builder: MeshBuilder, surface: Surface, crown: Crown, rng: np.random.Generator, *, fine: bool) -> None:
    """Add the dark insides of the clumps: rough bodies of 20 triangles (fine) or 8."""
    corners, faces = _ICOSAHEDRON if fine else _OCTAHEDRON
    count = len(crown.centres)
    rough = rng.uniform(0.7, 1.15, (count, len(corners), 1))
    vertices = crown.centres[:, None] + crown.radii[:, None, None] * rough * corners[None] * (1.0, 1.0, crown.flat)
    triangles = faces[None] + (len(corners) * np.arange(count))[:, None, None]
    flat, places = vertices.reshape(-1, 3), triangles.reshape(-1, 3)
    shades = 0.8 * crown.light(flat[places].mean(axis=1))
    builder.part(surface, flat, places, smooth=True, shades=shades)


def add_tufts(
    builder: MeshBuilder,
    surface: Surface,
    crown: Crown,
    rng: np.random.Generator,
    *,
    count: int,
    size_m: float,
    spread: float = 1.0,
    slim: float = 0.0,
) -> None:
    """Add tufts of leaves around the clumps.

    Args:
        builder: Where to.
        surface: Of the leaves.
        crown: Where the clumps are.
        rng: For irregularity.
        count: Of tufts; each is one triangle, seen from both sides.
        size_m: From a tuft's middle to its tips.
        spread: How far from the clump's middle they sit, in its radii.
        slim: From 0 (as wide as long) to 1 (sprays with one long tip).
    """
    share = crown.radii**2 / (crown.radii**2).sum()
    clump = np.searchsorted(np.cumsum(share), (np.arange(count) + 0.5) / count).clip(max=len(share) - 1)
    towards = _unit(rng.normal(size=(count, 3)))
    centres = crown.centres[clump]
    towards = _unit(towards + 0.8 * crown.outward(centres))
    reach = crown.radii[clump, None] * rng.uniform(0.68, 1.15, (count, 1)) * spread
    places = centres + towards * reach * (1.0, 1.0, crown.flat)
    facing = _unit(towards + 0.75 * _unit(rng.normal(size=(count, 3))))
    first, second = _frames(facing)
    angles = rng.uniform(0.0, 2.0 * math.pi, (count, 1)) + np.array([0.0, 2.1, 4.2]) + rng.normal(0.0, 0.3, (count, 3))
    tips = size_m * rng.uniform(0.65, 1.2, (count, 3)) * (1.0 + slim * np.array([0.5, -0.45, -0.45]))
    corners = (
        places[:, None]
        + (tips * np.cos(angles))[..., None] * first[:, None]
        + (tips * np.sin(angles))[..., None] * second[:, None]
    )
    lit = _unit(0.9 * crown.outward(places) + 0.5 * towards + 0.25 * facing)
    shades = crown.light(places) * rng.uniform(0.84, 1.16, count)
    add_leaves(builder, surface, corners, lit, shades)


def add_far_crown(builder: MeshBuilder, surface: Surface, profile: list[tuple[float, float]]) -> None:
    """Add a crown for afar: four sides, with their edges where the crown reaches farthest.

    Args:
        builder: Where to.
        surface: Of the leaves.
        profile: Radius and height of its rings, metres.
    """
    crown = MeshBuilder(detail=builder.detail)
    crown.lathe(surface, profile, sides=13)
    builder.add(crown, heading_rad=math.pi / 4.0)


def add_leaves(
    builder: MeshBuilder, surface: Surface, corners: FloatArray, lit: FloatArray, shades: FloatArray
) -> None:
    """Add two-sided triangles with normals of their own.

    Args:
        builder: Where to.
        surface: Of the leaves.
        corners: Shape (n, 3, 3), metres.
        lit: Unit vectors, shape (n, 3): the normals for light; mirrored in the triangle on its other side.
        shades: Factors of the colour, shape (n,).
    """
    faces = _unit(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]))
    flipped = np.einsum("nk,nk->n", faces, lit) < 0.0
    corners = np.where(flipped[:, None, None], corners[:, ::-1], corners)
    faces = np.where(flipped[:, None], -faces, faces)
    # A normal may lean far, but never to the other side of its triangle.
    lean = np.einsum("nk,nk->n", faces, lit)[:, None]
    front = _unit(lit + faces * np.maximum(0.0, 0.25 - lean))
    back = front - 2.0 * np.einsum("nk,nk->n", faces, front)[:, None] * faces
    count = len(corners)
    places = np.arange(3 * count).reshape(count, 3)
    normals = np.repeat(np.concatenate([front, back])[:, None], 3, axis=1)
    builder.part(
        surface,
        np.concatenate([corners, corners]).reshape(-1, 3),
        np.concatenate([places, places[:, ::-1] + 3 * count]),
        shades=np.concatenate([shades, 0.9 * shades]),
        normals=normals,
    )


def _unit(vectors: FloatArray) -> FloatArray:
    return np.asarray(vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-12))


def _frames(normals: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return two unit vectors across each normal."""
    helper = np.where(np.abs(normals[:, :1]) < 0.9, np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0]))
    first = _unit(np.cross(normals, helper))
    return first, np.cross(normals, first)


def _icosahedron() -> tuple[FloatArray, NDArray[np.int64]]:
    golden = (1.0 + math.sqrt(5.0)) / 2.0
    pairs = [(a, golden * b) for a in (-1.0, 1.0) for b in (-1.0, 1.0)]
    corners = _unit(
        np.array([(0.0, a, b) for a, b in pairs] + [(a, b, 0.0) for a, b in pairs] + [(b, 0.0, a) for a, b in pairs])
    )
    return corners, _hull(corners, 1.1)


def _hull(corners: FloatArray, edge: float) -> NDArray[np.int64]:
    """Return the triangles between corners that are an edge apart, turned outward."""
    near = np.linalg.norm(corners[:, None] - corners[None], axis=2) < edge
    count = len(corners)
    found = []
    for a in range(count):
        for b in range(a + 1, count):
            for c in range(b + 1, count):
                if near[a, b] and near[b, c] and near[a, c]:
                    turned = np.cross(corners[b] - corners[a], corners[c] - corners[a]) @ corners[a] > 0.0
                    found.append((a, b, c) if turned else (a, c, b))
    return np.array(found)


_ICOSAHEDRON = _icosahedron()
_OCTAHEDRON = (np.concatenate([np.eye(3), -np.eye(3)]), _hull(np.concatenate([np.eye(3), -np.eye(3)]), 1.5))
