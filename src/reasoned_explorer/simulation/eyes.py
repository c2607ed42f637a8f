"""What a camera sees of a world: which objects, how large in the picture, how far hidden, and what the ground is."""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import numpy as np

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Camera, Fault, SettingsError
from reasoned_explorer.simulation.sighting import GroundStretch, Sighting, ViewContent
from reasoned_explorer.world.sight import make_grid
from reasoned_explorer.world.taxonomy import Ground

if TYPE_CHECKING:
    from reasoned_explorer.world.atlas import Atlas
    from reasoned_explorer.world.sight import SightLines
    from reasoned_explorer.world.sight_kernels import Grid
    from reasoned_explorer.world.world import World

_SEAT_CELL_M = 12.0
_COVERS = frozenset({"tree", "shelter", "outdoor_seating"})
_UNCOVERED_KINDS = frozenset({"plant", "place", "area"})
_GROUNDS = tuple(Ground)


class Eyes:
    """Looks at a world, without pictures.

    An object's size in the picture is that of a pinhole camera, f = width / (2 tan(fov / 2)), on level ground. What is
    hidden by walls, crowns or large things, or covers less than about one pixel, is not seen. Areas count by their
    outline; places by their front, from before it only.

    Args:
        atlas: Of the world.
        max_range_m: Nothing farther is seen, metres, in [1, 1000].
        min_px: Least side of a square of the same visible size, pixels, in [0, 1000].

    Raises:
        SettingsError: If a setting is out of its range; all faults at once.
    """

    def __init__(self, atlas: "Atlas", *, max_range_m: float = 60.0, min_px: float = 1.0) -> None:
        faults = []
        if not 1.0 <= max_range_m <= 1000.0:
            faults.append(Fault(f"max_range_m = {max_range_m}", "a number in [1, 1000]"))
        if not 0.0 <= min_px <= 1000.0:
            faults.append(Fault(f"min_px = {min_px}", "a number in [0, 1000]"))
        if faults:
            raise SettingsError("eyes", faults)
        self.max_range_m = float(max_range_m)
        self.min_px = float(min_px)
        self._world = atlas.world
        self._sight = atlas.sight
        self._raster = atlas.ground
        self._frame = np.array([self._raster.min_x_m, self._raster.min_y_m, self._raster.cell_m])
        if self._sight not in _THINGS:
            _THINGS[self._sight] = _things_of(atlas.world)
        self._things = _THINGS[self._sight]

    def look(self, pose: Pose, camera: Camera) -> ViewContent:
        """Return what a camera sees.

        Args:
            pose: Of the camera: its height is ``z_m``; it looks along its heading, level.
            camera: Its picture and field of view.
        """
        from reasoned_explorer.simulation import eyes_kernels as kernels

        at = (float(pose.x_m), float(pose.y_m), float(pose.z_m), float(pose.heading_rad))
        half_fov = 0.5 * float(camera.horizontal_fov_rad)
        size = (float(camera.width_px), float(camera.height_px))
        hiding, solid = self._sight.hiding, self._sight.solid
        seen = kernels.see_objects(
            hiding, self._things.seats, self._sight.targets, *at, half_fov, *size, self.max_range_m, self.min_px
        )
        walls = kernels.see_walls(hiding, *at, half_fov, self.max_range_m)
        told = kernels.see_ground(
            solid, self._raster.codes, self._frame, *at, self.max_range_m, int(Ground.UNKNOWN), int(Ground.BUILDING)
        )
        classes, under, names = self._things.classes, self._things.under, self._things.names
        sightings = tuple(
            [
                Sighting(place := int(k), classes[place], bearing, near, wide, tall, share, under[place], names[place])
                for k, bearing, near, wide, tall, share in seen.tolist()
            ]
        )
        hits = sorted((distance_m, int(place)) for distance_m, place in walls.tolist() if place >= 0)
        return ViewContent(
            sightings,
            tuple(self._stretch(k, row) for k, row in enumerate(told.tolist())),
            len(hits) / kernels.WALL_RAYS,
            hits[0][0] if hits else math.inf,
            self._kinds([place for _, place in hits]),
        )

    def _kinds(self, places: list[int]) -> tuple[str, ...]:
        kinds = dict.fromkeys(self._world.buildings[place].kind for place in dict.fromkeys(places))
        return tuple(kinds)[:3]

    def _stretch(self, place: int, row: list[float]) -> GroundStretch:
        from reasoned_explorer.simulation.eyes_kernels import GROUND_BEARINGS

        near, middle, far, free_m, kind, owner = row
        ends_at = "" if kind == 0 else ("building" if kind == 1 else self._things.classes[int(owner)])
        grounds = (_GROUNDS[int(near)], _GROUNDS[int(middle)], _GROUNDS[int(far)])
        return GroundStretch(GROUND_BEARINGS[place], *grounds, free_m, ends_at)


@dataclass(frozen=True, slots=True, eq=False)
class _Things:
    """What eyes need to know of a world's objects, in their order.

    Attributes:
        seats: A grid over the squares that enclose their footprints.
        classes: Their classes.
        names: Their names; empty where they have none.
        under: The class of what stands over each, or None.
    """

    seats: "Grid"
    classes: tuple[str, ...]
    names: tuple[str, ...]
    under: tuple[str | None, ...]


#: Worked out once for each world (its sight lines stand for it), since many missions share one.
_THINGS: "WeakKeyDictionary[SightLines, _Things]" = WeakKeyDictionary()


def _things_of(world: "World") -> _Things:
    classes = tuple(item.class_name for item in world.objects)
    names = tuple(str(item.attributes.get("name", "")) for item in world.objects)
    return _Things(_seats(world), classes, names, tuple(_cover_classes(world)))


def _seats(world: "World") -> "Grid":
    """A grid over the squares that enclose the objects' footprints."""
    items = np.zeros((len(world.objects), 8))
    items[:, 0] = 2.0
    for item in world.objects:
        x_m, y_m = item.x_m, item.y_m
        # A place's front is moved onto its wall, at most a little.
        reach_m = 0.5 * math.hypot(item.size_m[0], item.size_m[1]) + 1.0
        if item.outline is not None and len(item.outline) >= 3 and item.object_class.kind == "area":
            (west, south), (east, north) = item.outline.min(axis=0), item.outline.max(axis=0)
            x_m, y_m = 0.5 * (west + east), 0.5 * (south + north)
            reach_m = 0.5 * math.hypot(east - west, north - south) + 0.1
        items[item.id, 1:4] = x_m, y_m, reach_m
    return make_grid(items, np.zeros((len(items), 3), dtype=np.int64), cell_m=_SEAT_CELL_M)


def _cover_classes(world: "World") -> list[str | None]:
    """For each object the class of what stands over it, or None."""
    from reasoned_explorer.simulation.eyes_kernels import covered_by

    covers = [item for item in world.objects if item.class_name in _COVERS]
    under: list[str | None] = [None] * len(world.objects)
    if not covers:
        return under
    items = np.zeros((len(covers), 8))
    items[:, 0] = 1.0
    for row, item in zip(items, covers, strict=True):
        row[1:7] = item.x_m, item.y_m, 0.25 * (item.size_m[0] + item.size_m[1]), 0.0, 0.0, item.size_m[2]
    grid = make_grid(items, np.zeros((len(items), 3), dtype=np.int64), cell_m=_SEAT_CELL_M)
    below = [item for item in world.objects if item.object_class.kind not in _UNCOVERED_KINDS]
    columns = np.array([(item.x_m, item.y_m, item.size_m[2]) for item in below]).reshape(-1, 3).T.copy()
    for item, row in zip(below, covered_by(grid, *columns).tolist(), strict=True):
        if row >= 0 and covers[row].id != item.id:
            under[item.id] = covers[row].class_name
    return under
