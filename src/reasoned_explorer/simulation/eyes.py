"""What a camera sees of a world: which objects, how large in the picture, how far hidden, and what the ground is."""

import math
from typing import TYPE_CHECKING

import numpy as np

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Camera, Fault, SettingsError
from reasoned_explorer.simulation.sighting import GroundStretch, Sighting, ViewContent
from reasoned_explorer.simulation.things import things_of
from reasoned_explorer.world.taxonomy import Ground

if TYPE_CHECKING:
    from reasoned_explorer.world.atlas import Atlas

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
        self._things = things_of(atlas)

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
