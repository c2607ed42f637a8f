"""How much each class is drawn to each spot by what lies and stands around it.

Kept on a coarse picture of the world: for a cell, which grounds lie and which classes stand within about 20 m. What a
class makes of that is the sum of its log lifts over the picture. Log lifts are rounded to multiples of 2⁻¹², whose sums
are exact in single precision: the answer is the same on every processor. They are added up row by row and not by a
matrix product, whose threads would cost more than they bring.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.world.generator.ground import COARSE_M, NEAR_M, GroundPlan
from reasoned_explorer.world.generator.shapes import Points
from reasoned_explorer.world.taxonomy import CLASS_NAMES, Ground

Logs = NDArray[np.float32]
_EXACT = 4096.0
_REACH = int(NEAR_M / COARSE_M)


class Statistics(Protocol):
    """What is known of real places; see `reasoned_explorer.knowledge`."""

    @property
    def density_per_km2(self) -> Mapping[str, float]:
        """How many of each class stand on a square kilometre."""
        ...

    def lift(self, given: str, wanted: str) -> float:
        """Return how much likelier a class is met within 20 m of another one; 1 where nothing is known."""
        ...

    def ground_lift(self, ground: str, class_name: str) -> float:
        """Return how much likelier a class is met within 20 m of a ground; 1 where nothing is known."""
        ...


@dataclass(frozen=True, slots=True)
class Pull:
    """How strongly the statistics bend the draws.

    Attributes:
        pairs: Exponent of the lifts between classes.
        grounds: Exponent of the lifts near grounds.
        cap: Largest absolute log lift of one pair that counts.
    """

    pairs: float = 0.8
    grounds: float = 0.5
    cap: float = 3.5


def lift_matrix(statistics: Statistics) -> NDArray[np.float64]:
    """Return the symmetric log lifts between all classes, shape (classes, classes)."""
    lifts = np.array([[statistics.lift(a, b) for b in CLASS_NAMES] for a in CLASS_NAMES], float)
    logs = np.log(np.maximum(lifts, 1e-3))
    symmetric: NDArray[np.float64] = (logs + logs.T) / 2
    return symmetric


class Affinity:
    """Log affinities of classes to places, which change as things are placed.

    Args:
        plan: What ground is where.
        statistics: Of real places.
        pull: How strongly they act.
    """

    def __init__(self, plan: GroundPlan, statistics: Statistics, pull: Pull) -> None:
        self._pairs = _exact(np.clip(lift_matrix(statistics), -pull.cap, pull.cap) * pull.pairs)
        grounds = [[statistics.ground_lift(g.name.lower(), c) for g in Ground] for c in CLASS_NAMES]
        logs = np.clip(np.log(np.maximum(grounds, 1e-2)), -pull.cap, pull.cap)
        near = plan.spread_out()
        # A rim all around takes what reaches over the border.
        rim = ((0, 0), (_REACH, _REACH), (_REACH, _REACH))
        self._near = np.pad(near, rim).reshape(len(Ground), -1).astype(np.float32)
        self._grounds = _exact(logs * pull.grounds)
        self._columns = near.shape[2] + 2 * _REACH
        self._rows = near.shape[1] + 2 * _REACH
        self._origin = plan.origin
        self._present = np.zeros((len(CLASS_NAMES), self._near.shape[1]), np.float32)
        self._on_the_map, self._standing = near.any(axis=(1, 2)), np.zeros(len(CLASS_NAMES), bool)
        steps = np.arange(-_REACH, _REACH + 1)
        down, right = np.meshgrid(steps, steps, indexing="ij")
        self._disc = (down * self._columns + right)[down**2 + right**2 <= _REACH**2]
        #: Classes of which nothing is known move nothing.
        self._felt = (self._pairs != 0).any(axis=1)

    def cells_of(self, points: Points) -> NDArray[np.intp]:
        """Return the cells that points lie in, shape (n,)."""
        place = np.floor((points - self._origin) / COARSE_M).astype(np.intp) + _REACH
        rows = np.clip(place[:, 1], _REACH, self._rows - 1 - _REACH)
        columns = np.clip(place[:, 0], _REACH, self._columns - 1 - _REACH)
        cells: NDArray[np.intp] = rows * self._columns + columns
        return cells

    def feel(self, code: int, points: Points) -> None:
        """Take note that things of a class stand at points, shape (n, 2)."""
        if self._felt[code] and len(points):
            self._present[code, self.cells_of(points)[:, None] + self._disc] = 1.0
            self._standing[code] = True

    def of(self, code: int, cells: NDArray[np.intp]) -> Logs:
        """Return a class's log affinity to cells, its own kind left out."""
        others = self._pairs[code].copy()
        others[code] = 0.0
        whole = np.zeros(self._near.shape[1], np.float32)
        for logs, rows, there in (
            (self._grounds[code], self._near, self._on_the_map),
            (others, self._present, self._standing),
        ):
            for row in np.flatnonzero((logs != 0) & there).tolist():
                whole += logs[row] * rows[row]
        found: Logs = whole[cells]
        return found

    def of_its_own(self, code: int, cells: NDArray[np.intp]) -> Logs | None:
        """Return what its own kind adds to a class's log affinity to cells, or None where that is nothing."""
        pull = self._pairs[code, code]
        return None if pull == 0.0 else pull * self._present[code, cells]


def _exact(logs: NDArray[np.float64]) -> Logs:
    rounded: Logs = (np.round(logs * _EXACT) / _EXACT).astype(np.float32)
    return rounded
