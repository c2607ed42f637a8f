"""The drawing board: what a district draws before it becomes an immutable world."""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
import shapely
from numpy.random import PCG64, Generator
from shapely import LineString, Polygon

from reasoned_explorer.model.draws import key_of
from reasoned_explorer.world.generator import planar
from reasoned_explorer.world.generator.shapes import Points, polygons_of
from reasoned_explorer.world.taxonomy import Ground

Zone = Literal["downtown", "plaza", "park", "campus", "residential", "waterfront"]


@dataclass(slots=True)
class Street:
    """A carriageway with a pavement on either side.

    Attributes:
        line: Centre line, shape (n, 2).
        kind: OpenStreetMap's highway value.
        road_m: Width of the carriageway, kerb to kerb; 0 for a pedestrian street.
        pavement_m: Width of each pavement; of half the street where there is no carriageway.
        parking: Whether cars park along the kerbs.
        trees: Distance between street trees, or 0 for none.
        name: Its name.
    """

    line: Points
    kind: str
    road_m: float
    pavement_m: float
    parking: bool = False
    trees: float = 0.0
    name: str = ""

    @property
    def half_m(self) -> float:
        """From the centre line to the property line."""
        return self.road_m / 2 + self.pavement_m


@dataclass(slots=True)
class Trail:
    """A way for walkers that is not a street's pavement: path, promenade, alley, crossing, driveway."""

    line: Points
    width_m: float
    ground: Ground = Ground.PATH
    kind: str = "footway"


@dataclass(slots=True)
class Patch:
    """A stretch of ground.

    Attributes:
        ground: What it is.
        area: Where it is.
        role: What it is for: ``lawn``, ``pond``, ``playground``, ``pitch``, ``plaza``, ``carpark`` … or empty.
        name: Its name, or empty.
    """

    ground: Ground
    area: Polygon
    role: str = ""
    name: str = ""


@dataclass(slots=True)
class Footprint:
    """A building to be.

    Attributes:
        area: Its outline, courtyards as holes.
        height_m: Of its roof.
        zone: District it belongs to.
        kind: OpenStreetMap's building value.
        entrance: Where its main entrance is, or None: then it is looked for on the side of the street.
        name: Its name, or empty.
        hosts: Places that are certainly in it, e.g. ``("museum",)``.
        min_height_m: Of its underside.
    """

    area: Polygon
    height_m: float
    zone: Zone
    kind: str = "yes"
    entrance: tuple[float, float] | None = None
    name: str = ""
    hosts: tuple[str, ...] = ()
    min_height_m: float = 0.0


@dataclass(slots=True)
class Fixture:
    """An object that belongs to a design, e.g. the fountain in the middle of a square."""

    class_name: str
    x_m: float
    y_m: float
    heading_rad: float = 0.0
    size_m: tuple[float, float, float] | None = None
    attributes: dict[str, str] = field(default_factory=dict)


@dataclass(slots=True)
class Sketch:
    """Everything that is drawn for one world.

    Attributes:
        box: The square world.
        seed: Of all its draws.
        streets: Streets, in drawing order.
        trails: Trails, drawn over the streets' pavements and below their carriageways, but for crossings.
        crossings: Crossings, drawn last.
        patches: Ground, in drawing order, below everything else.
        footprints: Buildings.
        fixtures: Designed objects.
        zones: Which district is where.
    """

    box: Polygon
    seed: int
    streets: list[Street] = field(default_factory=list)
    trails: list[Trail] = field(default_factory=list)
    crossings: list[Trail] = field(default_factory=list)
    patches: list[Patch] = field(default_factory=list)
    footprints: list[Footprint] = field(default_factory=list)
    fixtures: list[Fixture] = field(default_factory=list)
    zones: list[tuple[Zone, Polygon]] = field(default_factory=list)

    def rng(self, *keys: int | str) -> Generator:
        """Return a generator of draws for a purpose; the same keys give the same draws."""
        return Generator(PCG64(key_of(self.seed, "generator", *keys)))

    def lay(self, ground: Ground, area: shapely.Geometry, role: str = "", *, name: str = "") -> None:
        """Lay ground over what was laid before."""
        self.patches.extend(Patch(ground, part, role, name) for part in polygons_of(area) if part.area > 1.0)

    def pave(self, line: Points, width_m: float, ground: Ground = Ground.PATH, kind: str = "footway") -> None:
        """Draw a trail, cut at the border of the world."""
        low_x, low_y, high_x, high_y = self.box.bounds
        (min_x, min_y), (max_x, max_y) = line.min(axis=0).tolist(), line.max(axis=0).tolist()
        if min_x > low_x and min_y > low_y and max_x < high_x and max_y < high_y:
            if float(np.hypot(*np.diff(line, axis=0).T).sum()) > 1.0:
                self.trails.append(Trail(np.array(line, float), width_m, ground, kind))
            return
        for part in planar.lines_within(line, self.box):
            self.trails.append(Trail(part, width_m, ground, kind))

    def build(self, footprint: Footprint) -> None:
        """Draw a building, cut at the border of the world; slivers are left out."""
        low_x, low_y, high_x, high_y = self.box.bounds
        min_x, min_y, max_x, max_y = footprint.area.bounds
        if min_x > low_x and min_y > low_y and max_x < high_x and max_y < high_y:
            footprint.area = planar.simplify(footprint.area, 0.05)
            self.footprints.append(footprint)
            return
        inside = planar.intersection(footprint.area, self.box)
        for part in polygons_of(inside):
            if part.area >= 0.55 * footprint.area.area or part.area > 80.0:
                footprint.area = planar.simplify(part, 0.05)
                self.footprints.append(footprint)
                return

    def put(self, class_name: str, x_m: float, y_m: float, heading_rad: float = 0.0, **attributes: str) -> None:
        """Place a designed object."""
        self.fixtures.append(Fixture(class_name, float(x_m), float(y_m), float(heading_rad), None, attributes))

    def beds(self, streets: list[Street] | None = None) -> shapely.Geometry:
        """Return the ground that streets take, property line to property line."""
        chosen = self.streets if streets is None else streets
        if not chosen:
            return Polygon()
        lines = [LineString(street.line) for street in chosen]
        halves = np.array([street.half_m for street in chosen])
        return planar.union_all(planar.buffer(lines, halves, quad_segs=3, cap_style="flat", join_style="round"))
