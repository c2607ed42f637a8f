"""Furniture, places and people: a sequential point process fitted to what stands near what in real places.

Objects are drawn one small batch after the other. The chance that a class takes a site grows with its liking for the
site's role, with how often the class is met near the grounds around, and with the product of the lifts between it and
the classes that stand within 20 m already. This is sequential sampling from a pairwise-interaction point process with
saturated counts (a class counts once, however many of it are near; compare Geyer's saturation process, 1999).
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.world.generator.affinity import Affinity, Pull, Statistics
from reasoned_explorer.world.generator.ground import GroundPlan
from reasoned_explorer.world.generator.habits import (
    ASSUMED_PER_KM2,
    LEAST_PER_KM2,
    MOST_PER_KM2,
    ROLE_LIKING,
    SIZE_SPREAD,
    SPACING_M,
    ZONE_FACTORS,
)
from reasoned_explorer.world.generator.occupancy import Occupancy
from reasoned_explorer.world.generator.shapes import Points
from reasoned_explorer.world.generator.sites import Role, Sites
from reasoned_explorer.world.generator.sketch import Sketch
from reasoned_explorer.world.taxonomy import CLASS_NAMES, OBJECT_CLASSES, Ground

_CODE = {name: code for code, name in enumerate(CLASS_NAMES)}
#: Of its sites, a class looks at this many for each thing wanted, the best ones: exp(0.8 · 3.5), see `Pull`.
_PASSED = 16
_FEWEST = 400
#: Beside what stands on a pavement this much stays free to pass.
_PASSAGE_M = 1.5
#: Roles whose sites lie along an edge: deep things stand away from it; on a pavement people pass on the other side.
_CLINGS = np.isin(np.arange(len(Role)), [Role.KERB, Role.FRONT])
_BACK = np.where(_CLINGS, 1.0, np.where(np.arange(len(Role)) == Role.VERGE, -1.0, 0.0))
#: Who passes on a pavement is not sent over grass or onto the road.
_NO_WAY = ~np.isin(np.arange(len(Ground)), [Ground.PAVEMENT, Ground.PLAZA, Ground.PATH, Ground.PARKING])
#: What nothing that stands may reach into.
_NEVER = np.isin(np.arange(len(Ground)), [Ground.ROAD, Ground.WATER, Ground.BUILDING, Ground.PATH, Ground.CYCLEWAY,
                                          Ground.STEPS, Ground.UNKNOWN])  # fmt: skip


@dataclass(frozen=True, slots=True)
class Thing:
    """An object that has its place.

    Attributes:
        class_name: Its class.
        x_m: Of its centre.
        y_m: Likewise.
        heading_rad: Its front faces this way.
        size_m: Length, depth, height.
        building: Place of its building, or -1.
        attributes: What else is known.
        outline: For areas.
    """

    class_name: str
    x_m: float
    y_m: float
    heading_rad: float
    size_m: tuple[float, float, float]
    building: int = -1
    attributes: Mapping[str, str] | None = None
    outline: Points | None = None


def standing_size(name: str) -> tuple[float, float, float]:
    """Return a class's usual size as extent across its front, depth and height, metres; vehicles face ahead."""
    length, depth, height = OBJECT_CLASSES[name].size_m
    return (depth, length, height) if OBJECT_CLASSES[name].kind == "vehicle" else (length, depth, height)


class Furnisher:
    """Draws objects onto sites.

    Args:
        sketch: For zones and draws.
        plan: What ground is where.
        sites: Where things could stand.
        statistics: Of real places.
        pull: How strongly the statistics act.
    """

    def __init__(self, sketch: Sketch, plan: GroundPlan, sites: Sites, *, statistics: Statistics, pull: Pull) -> None:
        self._sketch, self._plan, self._sites, self._taken = sketch, plan, sites, Occupancy()
        self._density = statistics.density_per_km2
        self._affinity = Affinity(plan, statistics, pull)
        self._cells = self._affinity.cells_of(sites.points)
        self._used = np.zeros(len(sites.points), bool)
        self.things: list[Thing] = []
        self._landmarks: dict[tuple[str, int, int], list[tuple[float, float]]] = {}
        self._counts = np.zeros((len(CLASS_NAMES), len(sketch.zones)))
        #: What has been placed, by class, and is not yet felt.
        self._unfelt: dict[int, list[tuple[float, float]]] = {}

    def stand(self, thing: Thing, *, zone: int) -> None:
        """Take note of an object: where it stands nothing else can, and what is near it feels it."""
        self._note(thing, zone)
        self._unfelt.setdefault(_CODE[thing.class_name], []).append((thing.x_m, thing.y_m))

    def stand_many(self, things: list[Thing], zones: list[int]) -> None:
        """Stand many objects, those left out for which there is no room."""
        for thing, zone in zip(things, zones, strict=True):
            if self.room(thing.class_name, thing.x_m, thing.y_m, thing.heading_rad, thing.size_m):
                self.stand(thing, zone=zone)

    def _note(self, thing: Thing, zone: int) -> None:
        self.things.append(thing)
        code = _CODE[thing.class_name]
        self._counts[code, zone] += 1
        if thing.class_name in SPACING_M:
            apart = SPACING_M[thing.class_name]
            cell = (thing.class_name, math.floor(thing.x_m / apart), math.floor(thing.y_m / apart))
            self._landmarks.setdefault(cell, []).append((thing.x_m, thing.y_m))
        if OBJECT_CLASSES[thing.class_name].kind not in ("place", "area"):
            length, depth = (0.5, 0.5) if thing.class_name == "tree" else thing.size_m[:2]
            self._taken.take(thing.x_m, thing.y_m, thing.heading_rad, length, depth)

    def room(
        self, class_name: str, x_m: float, y_m: float, heading_rad: float, size_m: tuple[float, float, float]
    ) -> bool:
        """Return whether nothing stands where an object would; of a tree only the trunk counts."""
        length, depth = (0.5, 0.5) if class_name == "tree" else size_m[:2]
        return self._taken.free(x_m, y_m, heading_rad, length, depth)

    def _crowded(self, class_name: str, x: float, y: float) -> bool:
        """Return whether another of a class that keeps its distance is too near."""
        apart = SPACING_M[class_name]
        column, row = math.floor(x / apart), math.floor(y / apart)
        return any(
            math.hypot(x - other_x, y - other_y) < apart
            for i in (column - 1, column, column + 1)
            for j in (row - 1, row, row + 1)
            for other_x, other_y in self._landmarks.get((class_name, i, j), ())
        )

    def _feel(self) -> None:
        """Let the sites feel what was placed since the last time."""
        for code, spots in self._unfelt.items():
            self._affinity.feel(code, np.array(spots))
        self._unfelt.clear()

    def targets(self) -> NDArray[np.float64]:
        """Return how many of each class each zone should hold, shape (classes, zones)."""
        areas = np.array([area.area for _, area in self._sketch.zones]) / 1e6
        wanted = np.zeros((len(CLASS_NAMES), len(areas)))
        for name in ROLE_LIKING:
            base = ASSUMED_PER_KM2.get(name, float(self._density.get(name, 0.0)))
            base = min(max(base, LEAST_PER_KM2.get(name, 0.0)), MOST_PER_KM2.get(name, math.inf))
            for column, (zone, _) in enumerate(self._sketch.zones):
                wanted[_CODE[name], column] = base * ZONE_FACTORS[zone][name] * areas[column]
        return wanted

    def furnish(self) -> None:
        """Draw all classes, places first, then from the commonest to the rarest, people last."""
        wanted = self.targets()
        late = ("person", "bicycle")
        names = sorted(
            ROLE_LIKING,
            key=lambda n: (n in late, OBJECT_CLASSES[n].kind != "place", -wanted[_CODE[n]].sum(), n),
        )
        for name in names:
            self._draw_class(name, wanted[_CODE[name]])

    def _draw_class(self, name: str, wanted: NDArray[np.float64]) -> None:
        rng = self._sketch.rng("furniture", name)
        code = _CODE[name]
        sites = self._sites
        liking = np.zeros(len(Role))
        for role, value in ROLE_LIKING[name].items():
            liking[role] = value
        # One draw of the number of each zone, less what its design put there.
        missing = np.maximum(rng.poisson(wanted) - self._counts[code], 0).astype(int)
        chosen = np.flatnonzero((liking[sites.roles] > 0) & (missing[sites.zones] > 0))
        if not len(chosen):
            return
        # Sites by zone, so that each zone is drawn from its own stretch.
        chosen = chosen[np.argsort(sites.zones[chosen], kind="stable")]
        stretches = np.searchsorted(sites.zones[chosen], np.arange(len(wanted) + 1))
        self._feel()
        # Gumbel keys: the largest of a zone are a draw without replacement by weight.
        keys = np.log(liking[sites.roles[chosen]]) + self._affinity.of(code, self._cells[chosen])
        keys = np.where(self._used[chosen], -np.inf, keys + rng.gumbel(size=len(chosen)))
        # Its own kind lifts a site past at most so many others: those further back need no further thought.
        kept = np.concatenate(
            [
                low + _largest(keys[low:high], max(_FEWEST, _PASSED * int(number)))
                for low, high, number in zip(stretches[:-1].tolist(), stretches[1:].tolist(), missing, strict=True)
            ]
        )
        chosen, keys = chosen[kept], keys[kept]
        zones, cells = sites.zones[chosen], self._cells[chosen]
        stretches = np.searchsorted(zones, np.arange(len(wanted) + 1))
        # Few large batches for common classes, single draws for rare ones, so that like finds like.
        for _ in range(12):
            batch = np.ceil(missing / 2.5).astype(int)
            if not batch.any():
                return
            self._feel()
            own = self._affinity.of_its_own(code, cells)
            closed = self._used[chosen] | (missing[zones] <= 0)
            now = np.where(closed, -np.inf, keys if own is None else keys + own)
            found: list[NDArray[np.intp]] = []
            for zone in np.flatnonzero(batch).tolist():
                low, high = int(stretches[zone]), int(stretches[zone + 1])
                best = low + _largest(now[low:high], 2 * int(batch[zone]) + 2)
                found.append(best[np.isfinite(now[best])])
                if not len(found[-1]):
                    missing[zone] = 0
            best = np.concatenate(found)
            placed, tried = self._place(name, chosen[best], rng, batch)
            missing -= placed
            # What found no room once finds none later.
            keys[best[tried]] = -np.inf

    def _place(
        self, name: str, candidates: NDArray[np.intp], rng: np.random.Generator, most: NDArray[np.intp]
    ) -> tuple[NDArray[np.intp], list[int]]:
        """Place at most so many objects in each zone on the first candidates that have room.

        Returns:
            How many were placed in each zone, and which of the candidates were looked at.
        """
        if not len(candidates):
            return np.zeros_like(most), []
        sites, left = self._sites, most.tolist()
        indoors = OBJECT_CLASSES[name].kind == "place"
        stands = self._stands(name, candidates, rng)
        tried = np.flatnonzero(~stands.fits).tolist()
        zones, homes = sites.zones[candidates].tolist(), sites.buildings[candidates].tolist()
        for index in np.flatnonzero(stands.fits).tolist():
            zone = zones[index]
            if left[zone] <= 0:
                continue
            tried.append(index)
            x, y = stands.points[index].tolist()
            heading, (length, depth, height) = float(stands.headings[index]), stands.sizes[index].tolist()
            if not indoors and not self._taken.free(x, y, heading, length, depth):
                continue
            if name in SPACING_M and self._crowded(name, x, y):
                continue
            if stands.narrow[index] and not self._keep_passable(stands.strips[index].tolist()):
                continue
            self._used[candidates[index]] = True
            size = (round(length, 2), round(depth, 2), round(height, 2))
            self.stand(Thing(name, x, y, heading, size, homes[index]), zone=zone)
            left[zone] -= 1
        return most - np.array(left, most.dtype), tried

    def _keep_passable(self, strip: list[float]) -> bool:
        """Keep a strip (x, y, heading, width) open for people to pass; return whether that can be."""
        x, y, heading, width = strip
        if not self._taken.passable(x, y, heading, width, _PASSAGE_M):
            return False
        self._taken.keep_open(x, y, heading, width, _PASSAGE_M)
        return True

    def _stands(self, name: str, candidates: NDArray[np.intp], rng: np.random.Generator) -> "_Stands":
        """Return how objects of a class would stand on sites."""
        sites, indoors = self._sites, OBJECT_CLASSES[name].kind == "place"
        headings, roles = sites.headings[candidates].copy(), sites.roles[candidates]
        looks = np.column_stack([np.sin(headings), np.cos(headings)])
        scales = 1 + SIZE_SPREAD.get(name, 0.0) * rng.uniform(-1, 1, len(candidates))
        if name in ("traffic_sign", "traffic_signals", "bus_stop"):
            headings = headings + np.where(roles == Role.CORNER, 0.0, math.pi)
        elif name == "person":
            headings = rng.uniform(0, 2 * math.pi, len(candidates))
        sizes = np.array(standing_size(name))[None, :] * scales[:, None]
        # Deep things stand back from the line that they stand on.
        back = np.maximum(sizes[:, 1] / 2 - 0.35, 0.0) * _BACK[roles]
        points = sites.points[candidates] + looks * back[:, None]
        fits: NDArray[np.bool_] = np.ones(len(candidates), bool)
        narrow = _CLINGS[roles] & (sites.grounds[candidates] == Ground.PAVEMENT) & (not indoors)
        if not indoors:
            front = np.column_stack([np.sin(headings), np.cos(headings)])
            right = np.column_stack([front[:, 1], -front[:, 0]])
            corners = [
                points + right * (sizes[:, :1] / 2 * a) + front * (sizes[:, 1:2] / 2 * b)
                for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1), (0, 0))
            ]
            fits = ~np.any(_NEVER[self._plan.at(np.vstack(corners))].reshape(5, -1), axis=0)
        # The strip on its open side that people pass on.
        strip_at = points + looks * (sizes[:, 1:2] / 2 + _PASSAGE_M / 2)
        wide = sizes[:, :2].max(axis=1)
        if narrow.any():
            far, aside = looks * _PASSAGE_M / 2, np.column_stack([looks[:, 1], -looks[:, 0]]) * wide[:, None] / 2
            spots = np.vstack([strip_at, strip_at + far, strip_at + far + aside, strip_at + far - aside])
            fits &= ~(narrow & np.any(_NO_WAY[self._plan.at(spots)].reshape(4, -1), axis=0))
        strips = np.column_stack([strip_at, sites.headings[candidates], wide])
        return _Stands(points, headings % (2 * math.pi), sizes, fits, narrow, strips)


@dataclass(frozen=True, slots=True, eq=False)
class _Stands:
    """How objects would stand on sites, all arrays of the same length.

    Attributes:
        points: Shape (n, 2).
        headings: Compass radians.
        sizes: Shape (n, 3).
        fits: Whether the ground below is fit.
        narrow: Whether beside it a strip must stay open to pass.
        strips: Shape (n, 4): middle x and y, heading and width of that strip.
    """

    points: Points
    headings: NDArray[np.float64]
    sizes: NDArray[np.float64]
    fits: NDArray[np.bool_]
    narrow: NDArray[np.bool_]
    strips: NDArray[np.float64]


def _largest(keys: NDArray[np.floating[Any]], count: int) -> NDArray[np.intp]:
    """Return the places of the largest keys, the largest first."""
    if count < len(keys):
        top = np.argpartition(-keys, count)[:count]
        return top[np.argsort(-keys[top], kind="stable")]
    return np.argsort(-keys, kind="stable")
