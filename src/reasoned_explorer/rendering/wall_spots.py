"""Spots on walls, and flat things fixed to them: door leaves, panes, church windows."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.rendering.footprints import Bools, Floats, Footprints, Ints
from reasoned_explorer.rendering.patches import Patch, lifted, quads, rectangle_uvs


@dataclass(frozen=True, slots=True, eq=False)
class Spots:
    """Spots at the foot of walls.

    Attributes:
        places: Shape (n, 2), metres.
        along: Unit directions of the walls, the building on their left, shape (n, 2).
        out: Unit directions away from the building, shape (n, 2).
        owners: The buildings, shape (n,).
    """

    places: Floats
    along: Floats
    out: Floats
    owners: Ints

    @classmethod
    def on(cls, prints: Footprints, edges: Ints, distances_m: Floats) -> "Spots":
        """Return spots on edges of footprints, so far from where each edge begins."""
        along = prints.along[edges]
        places = prints.corners[edges] + along * distances_m[:, None]
        return cls(places, along, prints.outwards[edges], prints.owners[edges])

    @classmethod
    def spaced(cls, prints: Footprints, edges: Ints, *, every_m: float, margin_m: float) -> "Spots":
        """Return spots about ``every_m`` apart on each edge, at least one, clear of its ends."""
        room = np.maximum(prints.lengths[edges] - 2.0 * margin_m, 0.0)
        count = np.maximum(np.round(room / every_m), 1.0).astype(np.int64)
        row, place = runs(count)
        return cls.on(prints, edges[row], margin_m + (place + 0.5) / count[row] * room[row])

    def where(self, chosen: Bools) -> "Spots":
        """Return some of the spots."""
        return Spots(self.places[chosen], self.along[chosen], self.out[chosen], self.owners[chosen])

    def moved(self, *, aside_m: Floats | float = 0.0, out_m: Floats | float = 0.0) -> "Spots":
        """Return the spots moved along their walls and away from them."""
        aside, off = (np.asarray(value, dtype=np.float64).reshape(-1, 1) for value in (aside_m, out_m))
        return Spots(self.places + aside * self.along + off * self.out, self.along, self.out, self.owners)


@dataclass(frozen=True, slots=True, eq=False)
class Finish:
    """How faces look: colours, one or shape (n, 3); materials, one or shape (n,)."""

    colours: Floats
    materials: NDArray[np.uint8] | int


def runs(counts: Ints) -> tuple[Ints, Ints]:
    """Return for each of ``counts[k]`` items of every run k: k, and its place in the run."""
    row = np.repeat(np.arange(len(counts)), counts)
    place: Ints = np.arange(len(row)) - np.repeat(np.cumsum(counts) - counts, counts)
    return row, place


def panels(
    spots: Spots, finish: Finish, *, wide_m: Floats | float, low_m: Floats | float, high_m: Floats | float
) -> Patch:
    """Return upright rectangles that face away from the walls, their texture on its side: grain runs upwards."""
    half = np.broadcast_to(np.asarray(wide_m) / 2.0, (len(spots.owners),))
    left, right = spots.moved(aside_m=-half).places, spots.moved(aside_m=half).places
    corners = quads(lifted(left, low_m), lifted(right, low_m), lifted(right, high_m), lifted(left, high_m))
    uvs = rectangle_uvs(0.0, 0.0, 2.0 * half, np.asarray(high_m) - np.asarray(low_m), len(half))[..., ::-1]
    return Patch.of(corners, uvs, colours=finish.colours, materials=finish.materials, owners=spots.owners)


def pointed_panels(spots: Spots, finish: Finish, *, wide_m: Floats, low_m: Floats, high_m: Floats) -> Patch:
    """Return upright panels that end in a point, as old church windows do."""
    half = wide_m / 2.0
    left, right = spots.moved(aside_m=-half).places, spots.moved(aside_m=half).places
    spring = high_m - 0.7 * wide_m
    corners = quads(
        lifted(left, low_m),
        lifted(right, low_m),
        lifted(right, spring),
        lifted(spots.places, high_m),
        lifted(left, spring),
    )
    u = np.array([-0.5, 0.5, 0.5, 0.0, -0.5]) * wide_m[:, None]
    uvs = np.stack([u, corners[..., 2]], axis=2)
    return Patch.of(corners, uvs, colours=finish.colours, materials=finish.materials, owners=spots.owners)
