"""What a camera sees of a world, taken from a picture of it: what counts as visible is what has pixels."""

import math
import threading
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import numpy as np

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Camera, Fault, SettingsError
from reasoned_explorer.model.checks import is_within
from reasoned_explorer.simulation.renderers import renderer_of
from reasoned_explorer.simulation.sighting import GroundStretch, Sighting, ViewContent
from reasoned_explorer.simulation.things import things_of
from reasoned_explorer.world.sight_kernels import AREA, FIRST, LAST, SHAPE
from reasoned_explorer.world.taxonomy import Ground

if TYPE_CHECKING:
    from reasoned_explorer.rendering.scene import Scene
    from reasoned_explorer.rendering.silhouette_kernels import Sheet
    from reasoned_explorer.simulation.pixel_eyes_kernels import Stage, Tally
    from reasoned_explorer.world.atlas import Atlas

_GROUNDS = tuple(Ground)
_MOST_KINDS = 3
#: The picture in which the way ahead is looked at.
_AHEAD_CAMERA = Camera(112, 112)


class PixelEyes:
    """Looks at a world through the renderer; in all else as `simulation.eyes.Eyes`.

    A view is drawn as depth and ids alone, coarser than the camera's picture. A thing is seen if at least ``min_px`` of
    the camera's own pixels show it: large things are counted in the coarse picture, small ones are drawn once more
    alone, at the camera's resolution, and held against its depth. Its visible share is its visible pixels by those of
    its silhouette, drawn alone in the same way. A stretch of ground counts by the ground's pixels inside its outline.
    Width and height are those of `Eyes`; distance and bearing are those of the pixels.

    Args:
        atlas: Of the world; its scene is made once, and shared with those who take pictures of it.
        max_range_m: Nothing farther is seen, metres, in [1, 1000].
        min_px: Visible pixels from which on something is seen, and least side of a square of the size that it would
            have if nothing hid it, in [0, 1000].
        coarseness: Pixels of the camera along the side of one that is drawn, in [1, 8]; of 224 pixels 96 are left.

    Raises:
        SettingsError: If a setting is out of its range; all faults at once.
    """

    def __init__(
        self, atlas: "Atlas", *, max_range_m: float = 60.0, min_px: float = 1.0, coarseness: float = 7.0 / 3.0
    ) -> None:
        ranges = {"max_range_m": (1.0, 1000.0), "min_px": (0.0, 1000.0), "coarseness": (1.0, 8.0)}
        values = {"max_range_m": max_range_m, "min_px": min_px, "coarseness": coarseness}
        faults = [
            Fault(f"{name} = {value}", f"a number in [{ranges[name][0]:g}, {ranges[name][1]:g}]")
            for name, value in values.items()
            if not is_within(value, *ranges[name])
        ]
        if faults:
            raise SettingsError("pixel eyes", faults)
        self.max_range_m, self.min_px, self.coarseness = float(max_range_m), float(min_px), float(coarseness)
        self._world, self._things = atlas.world, things_of(atlas)
        self._renderer = renderer_of(atlas)
        self._stage = _stage_of(atlas, self._renderer.scene)
        self._rooms = threading.local()

    def look(self, pose: Pose, camera: Camera) -> ViewContent:
        """Return what a camera sees.

        Args:
            pose: Of the camera: its height is ``z_m``; it looks along its heading, level.
            camera: Its picture and field of view.

        Raises:
            SettingsError: If the camera or the pose is none that can be drawn.
        """
        seen, told, share, walls = self._see(pose, camera)
        classes, under, names = self._things.classes, self._things.under, self._things.names
        sightings = tuple(
            [
                Sighting(place := int(k), classes[place], bearing, near, wide, tall, shown, under[place], names[place])
                for k, bearing, near, wide, tall, shown, _ in seen
            ]
        )
        hits = sorted((distance_m, int(place)) for distance_m, place in walls)
        kinds = dict.fromkeys(self._world.buildings[place].kind for _, place in hits)
        return ViewContent(
            sightings,
            tuple(self._stretch(k, row) for k, row in enumerate(told)),
            share,
            hits[0][0] if hits else math.inf,
            tuple(kinds)[:_MOST_KINDS],
        )

    def pixels(self, pose: Pose, camera: Camera) -> dict[int, float]:
        """Return how many of the camera's pixels show each object that is seen, by the object's id; see `look`."""
        return {int(row[0]): row[6] for row in self._see(pose, camera)[0]}

    def range_ahead_m(
        self,
        pose: Pose,
        *,
        half_width_m: float = 0.4,
        lowest_m: float = 0.1,
        highest_m: float = 2.0,
        max_range_m: float | None = None,
    ) -> float:
        """Return how far ahead the first thing is that a body would meet which went straight on, metres.

        It is the least depth in the body's corridor, in a picture of 112 × 112 pixels and a right angle of view: what
        is thinner than a pixel (at 6 m a tenth of a metre) may be missed.

        Args:
            pose: Of the camera; the body goes along its heading.
            half_width_m: Half of the body's width, metres.
            lowest_m: What is lower than this is stepped or flown over, metres above the ground.
            highest_m: What is higher than this is passed under.
            max_range_m: Returned where nothing is nearer; None for the range of these eyes.
        """
        from reasoned_explorer.rendering.projection import projection_of
        from reasoned_explorer.simulation.pixel_eyes_kernels import range_ahead

        limit_m = self.max_range_m if max_range_m is None else float(max_range_m)
        view = projection_of(pose, _AHEAD_CAMERA)
        drawn = self._renderer.ids_in(view)
        corridor = float(half_width_m), float(lowest_m), float(highest_m)
        return min(limit_m, float(range_ahead(view, drawn.depth_m, drawn.instances, *corridor)))

    def _see(self, pose: Pose, camera: Camera) -> tuple[list[list[float]], list[list[float]], float, list[list[float]]]:
        """As the kernel returns it: objects, ground, share of buildings, buildings."""
        from reasoned_explorer.rendering.projection import projection_of, resized
        from reasoned_explorer.rendering.renderer import DENSITY
        from reasoned_explorer.simulation.eyes_kernels import in_view
        from reasoned_explorer.simulation.pixel_eyes_kernels import see

        plain = Pose(float(pose.x_m), float(pose.y_m), float(pose.z_m), float(pose.heading_rad))
        fine = projection_of(plain, camera)
        coarse = resized(fine, _coarse(camera, self.coarseness))
        scene, room = self._renderer.scene, self._room(camera)
        drawn = self._renderer.ids_in(coarse)
        half_fov = 0.5 * float(camera.horizontal_fov_rad)
        size = float(camera.width_px), float(camera.height_px)
        at = plain.x_m, plain.y_m, plain.z_m, plain.heading_rad
        targets = self._stage.targets
        shown = in_view(self._things.seats, targets, *at, half_fov, *size, self.max_range_m, self.min_px)
        seen, share, walls = see(
            self._stage,
            scene.library,
            scene.instances,
            coarse,
            fine,
            drawn.depth_m,
            drawn.instances,
            DENSITY,
            shown,
            plain.heading_rad,
            half_fov,
            self.max_range_m,
            self.min_px,
            2 + len(self._world.buildings),
            int(Ground.UNKNOWN),
            int(Ground.BUILDING),
            room.tally,
            room.sheet,
        )
        tally = room.tally
        return tally.seen[:seen].tolist(), tally.told.tolist(), float(share), tally.walls[:walls].tolist()

    def _stretch(self, place: int, row: list[float]) -> GroundStretch:
        from reasoned_explorer.simulation.eyes_kernels import GROUND_BEARINGS

        near, middle, far, free_m, kind, owner = row
        ends_at = "" if kind == 0 else ("building" if kind == 1 else self._things.classes[int(owner)])
        grounds = (_GROUNDS[int(near)], _GROUNDS[int(middle)], _GROUNDS[int(far)])
        return GroundStretch(GROUND_BEARINGS[place], *grounds, free_m, ends_at)

    def _room(self, camera: Camera) -> "_Room":
        size = camera.height_px, camera.width_px
        if getattr(self._rooms, "size", None) != size:
            self._rooms.size, self._rooms.room = size, self._new_room(camera)
        room: _Room = self._rooms.room
        return room

    def _new_room(self, camera: Camera) -> "_Room":
        from reasoned_explorer.rendering.raster_kernels import Canvas
        from reasoned_explorer.rendering.silhouette_kernels import Sheet
        from reasoned_explorer.simulation.pixel_eyes_kernels import Tally

        size, scene = (camera.height_px, camera.width_px), self._renderer.scene
        ids, corners = 2 + len(self._world.buildings) + len(self._world.objects), _most_corners(self._stage) + 1
        canvas = Canvas(
            np.empty(size, np.float32),
            np.empty(size, np.int32),
            np.empty(size, np.int32),
            np.empty((1, 1), np.float32),
        )
        vertices = int(scene.library.levels[:, 1].max(initial=1))
        return _Room(
            Tally(
                np.zeros(ids, np.int64),
                *(np.empty(shape) for shape in (ids, ids, (camera.width_px, 2), (corners, 2), corners, 4)),
                *(
                    np.empty(shape)
                    for shape in ((len(self._world.objects), 7), (3, 6), (len(self._world.buildings), 2))
                ),
            ),
            Sheet(canvas, np.empty((vertices, 5)), np.empty((3, 4)), np.empty((1, 4), np.int32)),
        )


@dataclass(frozen=True, slots=True, eq=False)
class _Room:
    """What one thread works in."""

    tally: "Tally"
    sheet: "Sheet"


@lru_cache(maxsize=16)
def _coarse(camera: Camera, coarseness: float) -> Camera:
    width, height = (max(1, round(side / coarseness)) for side in (camera.width_px, camera.height_px))
    return replace(camera, width_px=width, height_px=height)


#: Worked out once for each world, by its scene, since many missions share one.
_STAGES: "WeakKeyDictionary[Scene, Stage]" = WeakKeyDictionary()


def _stage_of(atlas: "Atlas", scene: "Scene") -> "Stage":
    from reasoned_explorer.simulation.pixel_eyes_kernels import Stage

    if scene in _STAGES:
        return _STAGES[scene]
    world, raster, ids = atlas.world, atlas.ground, scene.instances.ids
    first_object = 2 + len(world.buildings)
    stands = np.full(len(world.objects), -1, np.int32)
    drawn = np.flatnonzero(ids >= first_object)
    stands[ids[drawn] - first_object] = drawn
    walls = [item.building + 2 if 0 <= item.building < len(world.buildings) else -1 for item in world.objects]
    _STAGES[scene] = Stage(
        atlas.sight.targets,
        stands,
        np.array(walls, np.int32),
        np.array([item.object_class.solid for item in world.objects], np.uint8),
        np.ascontiguousarray(raster.codes),
        np.array([raster.min_x_m, raster.min_y_m, raster.cell_m]),
    )
    return _STAGES[scene]


def _most_corners(stage: "Stage") -> int:
    table = stage.targets.table
    areas = table[table[:, SHAPE] == AREA]
    return int((areas[:, LAST] - areas[:, FIRST]).max(initial=1.0))
