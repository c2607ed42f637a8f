"""An immutable outdoor world: what stands where.

All coordinates are ENU metres about the world's origin (`reasoned_explorer.geometry`). Polygons are closed rings
without the closing point repeated, shape (n, 2), float64; holes likewise.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.geometry import GeoOrigin
from reasoned_explorer.world.taxonomy import OBJECT_CLASSES, Ground, ObjectClass

Ring = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Bounds:
    """An axis-parallel rectangle, ENU metres."""

    min_x_m: float
    min_y_m: float
    max_x_m: float
    max_y_m: float

    @property
    def width_m(self) -> float:
        """East-west extent, metres."""
        return self.max_x_m - self.min_x_m

    @property
    def height_m(self) -> float:
        """North-south extent, metres."""
        return self.max_y_m - self.min_y_m

    @property
    def area_km2(self) -> float:
        """Area, square kilometres."""
        return self.width_m * self.height_m / 1e6

    def contains(self, x_m: float, y_m: float) -> bool:
        """Return whether a point lies in the rectangle, its border included."""
        return self.min_x_m <= x_m <= self.max_x_m and self.min_y_m <= y_m <= self.max_y_m


@dataclass(frozen=True, slots=True, eq=False)
class Region:
    """A stretch of one kind of ground. Later regions of a world lie on top of earlier ones."""

    ground: Ground
    outer: Ring
    holes: tuple[Ring, ...] = ()
    name: str = ""


@dataclass(frozen=True, slots=True, eq=False)
class Way:
    """A road, footway, path …: a line with a width. Ways lie on top of regions, later ways on top of earlier ones.

    Attributes:
        kind: OpenStreetMap's highway value (``residential``, ``footway``, ``cycleway``, ``steps`` …).
        ground: What one stands on there.
        line: Shape (n, 2), n ≥ 2, ENU metres.
        width_m: Full width, metres.
        name: Its name, or empty.
        level: 0 on the ground, above it for bridges, below it for tunnels; only ways at 0 make ground.
    """

    kind: str
    ground: Ground
    line: Ring
    width_m: float
    name: str = ""
    level: int = 0


@dataclass(frozen=True, slots=True, eq=False)
class Building:
    """A building.

    Attributes:
        outer: Footprint.
        holes: Courtyards.
        height_m: Height of the roof above the ground, metres.
        kind: OpenStreetMap's building value (``yes``, ``apartments``, ``church``, ``roof`` …).
        name: Its name, or empty.
        entrances: Points on the outline, shape (n, 2), n ≥ 0.
        min_height_m: Height of its underside: greater than 2 for a roof that one can walk under.
        height_source: ``"height"``, ``"levels"`` or ``"default"``.
    """

    outer: Ring
    height_m: float
    holes: tuple[Ring, ...] = ()
    kind: str = "yes"
    name: str = ""
    entrances: Ring = field(default_factory=lambda: np.empty((0, 2)))
    min_height_m: float = 0.0
    height_source: str = "default"


@dataclass(frozen=True, slots=True, eq=False)
class WorldObject:
    """A thing that stands somewhere.

    Attributes:
        id: Its place in the world's list of objects.
        class_name: A name of `OBJECT_CLASSES`.
        x_m: Of its centre (for a place: of its entrance).
        y_m: Likewise.
        heading_rad: Its front faces this way.
        size_m: Length (across its front), width (depth), height, metres.
        attributes: What else is known, e.g. ``{"name": "Fischbrunnen", "backrest": "yes"}``.
        outline: For objects that are areas or lines on the map: their ring, else None.
        building: Place in the world's list of buildings of the building it is in, or -1.
    """

    id: int
    class_name: str
    x_m: float
    y_m: float
    heading_rad: float = 0.0
    size_m: tuple[float, float, float] = (1.0, 1.0, 1.0)
    attributes: Mapping[str, str] = field(default_factory=dict)
    outline: Ring | None = None
    building: int = -1

    @property
    def object_class(self) -> ObjectClass:
        """Its class."""
        return OBJECT_CLASSES[self.class_name]


@dataclass(frozen=True, eq=False)
class World:
    """What stands where: plain data. Questions about it are answered by an `Atlas`.

    Attributes:
        name: For people and records, e.g. ``"park:7"`` or ``"munich-centre"``.
        bounds: Nothing outside is part of the world.
        regions: Ground, in drawing order.
        ways: Lines, in drawing order.
        buildings: Buildings.
        objects: Objects; ``objects[i].id == i``.
        origin: Where the ENU origin lies on earth; None for a generated world.
        source: How it came about, e.g. ``"generated park seed=7 size=400"``.
        attribution: Whom to thank wherever a picture or figure of it is shown; may be empty.
        seed: Of generation or of seeded defaults.
    """

    name: str
    bounds: Bounds
    regions: tuple[Region, ...]
    ways: tuple[Way, ...]
    buildings: tuple[Building, ...]
    objects: tuple[WorldObject, ...]
    origin: GeoOrigin | None = None
    source: str = ""
    attribution: str = ""
    seed: int = 0
