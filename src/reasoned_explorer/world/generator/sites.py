"""Where furniture could stand: candidate sites, each with a role, a facing and the ground under it."""

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
import shapely
from numpy.typing import NDArray

from reasoned_explorer.world.generator import planar
from reasoned_explorer.world.generator.ground import Codes, GroundPlan
from reasoned_explorer.world.generator.shapes import Points, along, along_many, heading_of, left_of, spread
from reasoned_explorer.world.generator.sketch import Sketch
from reasoned_explorer.world.generator.streets import Crossing
from reasoned_explorer.world.taxonomy import Ground


class Role(IntEnum):
    """What a site is to the place around it."""

    KERB = 0  #: on a pavement, by the carriageway
    FRONT = 1  #: on a pavement or square, before a wall
    VERGE = 2  #: beside a path
    OPEN = 3  #: on a square
    GREEN = 4  #: on grass, in a wood, garden or yard
    PLAY = 5  #: on a playground
    LOT = 6  #: at the edge of a car park
    CORNER = 7  #: at a crossing
    DOOR = 8  #: a door or shop front in an outer wall


@dataclass(frozen=True, slots=True, eq=False)
class Sites:
    """Candidate sites, all arrays of the same length.

    Attributes:
        points: Shape (n, 2).
        headings: What stands here faces this compass heading, radians.
        roles: Codes of `Role`.
        grounds: Codes of `Ground`.
        zones: Place in the sketch's list of zones.
        buildings: For doors the building, else -1.
    """

    points: Points
    headings: NDArray[np.float64]
    roles: NDArray[np.int8]
    grounds: Codes
    zones: NDArray[np.intp]
    buildings: NDArray[np.intp]


_HARD = (Ground.PAVEMENT, Ground.PLAZA)
_SOFT = (Ground.GRASS, Ground.WOOD, Ground.GARDEN, Ground.YARD, Ground.SAND)
#: On which ground a site of a role may lie; elsewhere it is dropped.
_ALLOWED: dict[Role, tuple[Ground, ...]] = {
    Role.KERB: (*_HARD, Ground.GRASS),
    Role.FRONT: _HARD,
    Role.VERGE: (Ground.PLAZA, *_SOFT, Ground.PLAYGROUND),
    Role.OPEN: (Ground.PLAZA,),
    Role.GREEN: _SOFT,
    Role.PLAY: (Ground.PLAYGROUND,),
    Role.LOT: (Ground.PLAZA, *_SOFT),
    Role.CORNER: _HARD,
    Role.DOOR: (Ground.BUILDING,),
}


class _Collector:
    def __init__(self) -> None:
        self.points: list[Points] = []
        self.facing: list[NDArray[np.float64]] = []
        self.roles: list[NDArray[np.int8]] = []

    def add(self, points: Points, headings: NDArray[np.float64], role: Role) -> None:
        self.points.append(points)
        self.facing.append(headings)
        self.roles.append(np.full(len(points), role, np.int8))


def find_sites(sketch: Sketch, plan: GroundPlan, crossings: list[Crossing]) -> Sites:
    """Return the sites of a sketch, those on unfit ground or too near a wall left out."""
    rng = sketch.rng("sites")
    found = _Collector()
    streets = sketch.streets
    at, tangents, line = along_many(
        [street.line for street in streets], 3.4, start_m=rng.uniform(1, 3, len(streets)), end_m=1.0
    )
    roads = np.array([street.road_m for street in streets], float)[line]
    offset = np.where(roads > 0, roads / 2 + 0.55, 2.2)[:, None]
    for side in (1.0, -1.0):
        aside = side * left_of(tangents)
        # Looks away from the carriageway; in a pedestrian street towards its middle.
        found.add(at + offset * aside, heading_of(aside * np.where(roads > 0, 1.0, -1.0)[:, None]), Role.KERB)
    trails = [
        trail
        for trail in sketch.trails
        if trail.ground in (Ground.PATH, Ground.PLAZA, Ground.PAVEMENT) and trail.width_m >= 2.0
    ]
    at, tangents, line = along_many(
        [trail.line for trail in trails], 4.2, start_m=rng.uniform(0.5, 3, len(trails)), end_m=1.0
    )
    beyond = (np.array([trail.width_m for trail in trails], float)[line] / 2 + 0.75)[:, None]
    for side in (1.0, -1.0):
        aside = side * left_of(tangents)
        found.add(at + beyond * aside, heading_of(-aside), Role.VERGE)
    _area_sites(sketch, found)
    for middle, ahead, half in crossings:
        across = left_of(ahead[None])[0]
        spots = np.array([middle + ahead * 2.0 + side * (half + 0.55) * across for side in (1.0, -1.0)])
        found.add(spots, heading_of(np.vstack([ahead, ahead])), Role.CORNER)
    return _checked(sketch, plan, found)


def _area_sites(sketch: Sketch, found: _Collector) -> None:
    """Add sites in and along areas."""
    for index, patch in enumerate(sketch.patches):
        rng = sketch.rng("sites", index)
        if patch.ground == Ground.PLAZA:
            role, spacing = Role.OPEN, 4.6
        elif patch.ground in (Ground.GRASS, Ground.GARDEN):
            role, spacing = Role.GREEN, 9.0
        elif patch.ground in (Ground.WOOD, Ground.YARD, Ground.SAND):
            role, spacing = Role.GREEN, 11.0
        elif patch.ground == Ground.PLAYGROUND:
            role, spacing = Role.PLAY, 3.4
        elif patch.ground == Ground.PARKING:
            role, spacing = Role.LOT, 5.0
        else:
            continue
        if role is Role.LOT:
            at, tangents = along(np.asarray(patch.area.exterior.coords), spacing)
            outward = left_of(tangents) * (1.0 if not patch.area.exterior.is_ccw else -1.0)
            found.add(at + 0.8 * outward, heading_of(-outward), role)
            continue
        at = spread(rng, planar.buffer(patch.area, -1.2), spacing)
        found.add(at, rng.uniform(0, 2 * np.pi, len(at)), role)
        if role is Role.PLAY:
            at, tangents = along(np.asarray(patch.area.exterior.coords), 3.5)
            outward = left_of(tangents) * (1.0 if not patch.area.exterior.is_ccw else -1.0)
            found.add(at + 0.9 * outward, heading_of(-outward), Role.VERGE)


def _wall_sites(
    sketch: Sketch, plan: GroundPlan, found: _Collector
) -> tuple[Points, NDArray[np.float64], NDArray[np.intp]]:
    """Return doors: points on outer walls with a street or square before them, where they look, and whose they are."""
    homes = np.array([at for at, item in enumerate(sketch.footprints) if item.min_height_m == 0], np.intp)
    if not len(homes):
        return np.empty((0, 2)), np.empty(0), homes
    walls = np.array([sketch.footprints[at].area.exterior for at in homes.tolist()])
    corners, ring = shapely.get_coordinates(walls, return_index=True)
    rings = np.split(corners, np.searchsorted(ring, np.arange(1, len(walls))))
    at, tangents, wall = along_many(rings, 5.5)
    outward = left_of(tangents) * np.where(shapely.is_ccw(walls), -1.0, 1.0)[wall][:, None]
    # Houses whose front door a path leads to.
    fronts = [at for at in homes.tolist() if sketch.footprints[at].entrance is not None]
    if fronts:
        front = np.array([sketch.footprints[at].entrance for at in fronts], float)
        middle = shapely.get_coordinates(shapely.centroid([sketch.footprints[at].area for at in fronts]))
        away = front - middle
        away /= np.maximum(np.hypot(away[:, 0], away[:, 1]), 1e-6)[:, None]
        at, outward = np.vstack([at, front]), np.vstack([outward, away])
        wall = np.concatenate([wall, np.searchsorted(homes, fronts)])
    good = np.isin(plan.at(at + 1.4 * outward), [Ground.PAVEMENT, Ground.PLAZA, Ground.PATH])
    at, outward = at[good], outward[good]
    looks = heading_of(outward)
    found.add(at + 0.6 * outward, looks, Role.FRONT)
    return at, looks, homes[wall[good]]


def _checked(sketch: Sketch, plan: GroundPlan, found: _Collector) -> Sites:
    doors, looks, homes = _wall_sites(sketch, plan, found)
    points = np.vstack(found.points) if found.points else np.empty((0, 2))
    headings, roles = np.concatenate(found.facing), np.concatenate(found.roles)
    inside = shapely.contains_xy(planar.buffer(sketch.box, -0.8), points)
    points, headings, roles = points[inside], headings[inside], roles[inside]
    grounds = plan.at(points)
    table = np.zeros((len(Role), len(Ground)), bool)
    for role, allowed in _ALLOWED.items():
        table[role, list(allowed)] = True
    keep = table[roles, grounds]
    keep[keep] = ~plan.by_a_wall(points[keep], 0.45)
    # The interior sites of a square or lawn that is crossed by paths lie on grass; they keep their role.
    points, headings, roles, grounds = points[keep], headings[keep], roles[keep], grounds[keep]
    points, headings = np.vstack([points, doors]), np.concatenate([headings, looks])
    roles = np.concatenate([roles, np.full(len(doors), Role.DOOR, np.int8)])
    grounds = np.concatenate([grounds, np.full(len(doors), Ground.BUILDING, np.int8)])
    buildings = np.concatenate([np.full(int(keep.sum()), -1), homes])
    return Sites(points, headings, roles, grounds, zone_of(sketch, points), buildings)


def zone_of(sketch: Sketch, points: Points) -> NDArray[np.intp]:
    """Return for each point the place of its zone in the sketch's list (0 where none is)."""
    zones = np.zeros(len(points), np.intp)
    if len(sketch.zones) > 1 and len(points):
        tree = shapely.STRtree([area for _, area in sketch.zones])
        point, zone = tree.query(shapely.points(points), predicate="intersects")
        zones[point] = zone
    return zones
