"""Furniture, places and people: a sequential point process fitted to what stands near what in real places.

Objects are drawn one small batch after the other. The chance that a class takes a site grows with its liking for the
site's role, with how often the class is met near the grounds around, and with the product of the lifts between it and
the classes that stand within 20 m already. This is sequential sampling from a pairwise-interaction point process with
saturated counts (a class counts once, however many of it are near; compare Geyer's saturation process, 1999).
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Protocol

import numpy as np
import shapely
from numpy.typing import NDArray

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

_RADIUS_M = 20.0
_CODE = {name: code for code, name in enumerate(CLASS_NAMES)}
#: What nothing that stands may reach into.
_NEVER = np.isin(np.arange(len(Ground)), [Ground.ROAD, Ground.WATER, Ground.BUILDING, Ground.PATH, Ground.CYCLEWAY,
                                          Ground.STEPS, Ground.UNKNOWN])  # fmt: skip


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


def standing_size(name: str) -> tuple[float, float, float]:
    """Return a class's usual size as extent across its front, depth and height, metres; vehicles face ahead."""
    length, depth, height = OBJECT_CLASSES[name].size_m
    return (depth, length, height) if OBJECT_CLASSES[name].kind == "vehicle" else (length, depth, height)


def lift_matrix(statistics: Statistics) -> NDArray[np.float64]:
    """Return the symmetric log lifts between all classes, shape (classes, classes)."""
    lifts = np.array([[statistics.lift(a, b) for b in CLASS_NAMES] for a in CLASS_NAMES], float)
    logs = np.log(np.maximum(lifts, 1e-3))
    symmetric: NDArray[np.float64] = (logs + logs.T) / 2
    return symmetric


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
        self._pull = pull
        self._pairs = np.clip(lift_matrix(statistics), -pull.cap, pull.cap) * pull.pairs
        #: Classes of which nothing is known move nothing.
        self._felt = (self._pairs != 0).any(axis=1)
        self._moved = [np.flatnonzero(row) for row in self._pairs]
        count = len(sites.points)
        grounds = np.log(
            np.maximum([[statistics.ground_lift(g.name.lower(), c) for c in CLASS_NAMES] for g in Ground], 1e-2)
        )
        near = plan.near(sites.points).astype(float)
        # One row a class: a class is drawn from its own row.
        self._field = np.ascontiguousarray((near @ np.clip(grounds, -pull.cap, pull.cap) * pull.grounds).T)
        self._present = np.zeros((len(CLASS_NAMES), count), bool)
        self._used = np.zeros(count, bool)
        self.things: list[Thing] = []
        self._landmarks: dict[tuple[str, int, int], list[tuple[float, float]]] = {}
        self._counts = np.zeros((len(CLASS_NAMES), len(sketch.zones)))
        self._tree = shapely.STRtree(shapely.points(sites.points))
        #: What has been placed, by class, and is not yet felt.
        self._unfelt: dict[int, list[tuple[float, float]]] = {}

    def stand(self, thing: Thing, *, zone: int) -> None:
        """Take note of an object: where it stands nothing else can, and what is near it feels it."""
        self._note(thing, zone)
        code = _CODE[thing.class_name]
        if self._felt[code]:
            self._unfelt.setdefault(code, []).append((thing.x_m, thing.y_m))

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
            points = shapely.points(np.array(spots))
            if len(spots) > 200:
                # So many of a kind: each site asks for its nearest one.
                _, gaps = shapely.STRtree(points).query_nearest(
                    self._tree.geometries, return_distance=True, all_matches=False
                )
                near = np.flatnonzero(gaps < _RADIUS_M)
            else:
                near = np.unique(self._tree.query(points, predicate="dwithin", distance=_RADIUS_M)[1])
            fresh = near[~self._present[code, near]]
            self._present[code, fresh] = True
            for row in self._moved[code].tolist():
                self._field[row, fresh] += self._pairs[code, row]
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
        affinity = np.log(liking[sites.roles[chosen]])
        zones = sites.zones[chosen]
        # Few large batches for common classes, single draws for rare ones, so that like finds like.
        for _ in range(12):
            batch = np.ceil(missing / 2.5).astype(int)
            if not batch.any():
                return
            self._feel()
            logits = affinity + self._field[code, chosen]
            open_sites = ~self._used[chosen] & (missing[zones] > 0)
            # Gumbel keys: the largest of a zone are a draw without replacement by weight.
            keys = np.where(open_sites, logits + rng.gumbel(size=len(chosen)), -np.inf)
            for zone in np.flatnonzero(batch).tolist():
                low, high = int(stretches[zone]), int(stretches[zone + 1])
                best = low + _largest(keys[low:high], 2 * int(batch[zone]) + 2)
                best = best[np.isfinite(keys[best])]
                missing[zone] -= self._place(name, chosen[best], rng, int(batch[zone]), zone)
                if not len(best):
                    missing[zone] = 0

    def _place(self, name: str, candidates: NDArray[np.intp], rng: np.random.Generator, most: int, zone: int) -> int:
        """Place at most so many objects on the first candidates that have room; return how many."""
        if not len(candidates):
            return 0
        cls = OBJECT_CLASSES[name]
        sites = self._sites
        spread = SIZE_SPREAD.get(name, 0.0)
        scales = 1 + spread * rng.uniform(-1, 1, len(candidates))
        headings = sites.headings[candidates].copy()
        if name in ("traffic_sign", "traffic_signals", "bus_stop"):
            headings = headings + np.where(sites.roles[candidates] == Role.CORNER, 0.0, math.pi)
        elif name == "person":
            headings = rng.uniform(0, 2 * math.pi, len(candidates))
        sizes = np.array(standing_size(name))[None, :] * scales[:, None]
        front = np.column_stack([np.sin(headings), np.cos(headings)])
        looks = np.column_stack([np.sin(sites.headings[candidates]), np.cos(sites.headings[candidates])])
        # Deep things stand back from the line that they stand on.
        back = np.maximum(sizes[:, 1] / 2 - 0.35, 0.0)
        back = back * np.select(
            [np.isin(sites.roles[candidates], [Role.KERB, Role.FRONT]), sites.roles[candidates] == Role.VERGE],
            [1, -1],
            0,
        )
        points = sites.points[candidates] + looks * back[:, None]
        good: NDArray[np.bool_] = np.ones(len(candidates), bool)
        if cls.kind != "place":
            right = np.column_stack([front[:, 1], -front[:, 0]])
            corners = [
                points + right * (sizes[:, :1] / 2 * a) + front * (sizes[:, 1:2] / 2 * b)
                for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1), (0, 0))
            ]
            grounds = self._plan.at(np.vstack(corners)).reshape(5, -1)
            good = ~np.any(_NEVER[grounds], axis=0)
        placed = 0
        for index in np.flatnonzero(good).tolist():
            if placed >= most:
                break
            x, y = float(points[index, 0]), float(points[index, 1])
            heading = float(headings[index] % (2 * math.pi))
            size = (float(sizes[index, 0]), float(sizes[index, 1]), float(sizes[index, 2]))
            if cls.kind != "place" and not self._taken.free(x, y, heading, size[0], size[1]):
                continue
            if name in SPACING_M and self._crowded(name, x, y):
                continue
            site = int(candidates[index])
            self._used[site] = True
            rounded = (round(size[0], 2), round(size[1], 2), round(size[2], 2))
            self.stand(Thing(name, x, y, heading, rounded, int(sites.buildings[site])), zone=zone)
            placed += 1
        return placed


def _largest(keys: NDArray[np.float64], count: int) -> NDArray[np.intp]:
    """Return the places of the largest keys, the largest first."""
    if count < len(keys):
        top = np.argpartition(-keys, count)[:count]
        return top[np.argsort(-keys[top], kind="stable")]
    return np.argsort(-keys, kind="stable")
