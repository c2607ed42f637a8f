"""Pictures of a scene: colour, depth and which thing is seen in every pixel."""

import threading
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Camera, Fault, SettingsError
from reasoned_explorer.rendering.conditions import Conditions
from reasoned_explorer.rendering.light import developing_curve, light_of, sun_direction
from reasoned_explorer.rendering.mipmaps import ground_looks_of, material_textures, surfaces_of
from reasoned_explorer.rendering.progress import Progress
from reasoned_explorer.rendering.projection import Projection, projection_of
from reasoned_explorer.rendering.raster_kernels import Canvas, draw, gather, read_out
from reasoned_explorer.rendering.readiness import make_ready
from reasoned_explorer.rendering.room import Room, new_canvas
from reasoned_explorer.rendering.scene import Scene
from reasoned_explorer.rendering.shading_kernels import shade
from reasoned_explorer.rendering.shadows import ShadowTiles

#: Triangles for each pixel that a thing may fill, at most, where its model has coarser levels.
DENSITY = 1.5
#: A scene's first picture is looked at in so many pixels apart before it is drawn.
_QUICK_STEP = 8
#: Rows that one thread shades before it is another's turn: sky is quickly done, and all of it is above.
_BAND = 8


@dataclass(frozen=True, slots=True, eq=False)
class Sighted:
    """What stands where in a view.

    Attributes:
        depth_m: Distance along the camera's axis, shape (height, width), float32; infinite in the sky.
        instances: Instance ids, shape (height, width), int32: 0 the sky, 1 the ground, 2 + k building k of the world,
            2 + buildings + k object k.
    """

    depth_m: NDArray[np.float32]
    instances: NDArray[np.int32]


@dataclass(frozen=True, slots=True, eq=False)
class Picture(Sighted):
    """What a camera sees.

    Attributes:
        colour: sRGB, shape (height, width, 3), uint8.
    """

    colour: NDArray[np.uint8]


class Renderer:
    """Draws pictures of a scene. It may be used from several threads at once, which then really run at once.

    A picture depends on the scene, the conditions, the pose and the camera alone: it is the same, byte for byte, in
    every process and thread and whatever was drawn before.

    Args:
        scene: What there is.
        conditions: Time of day and weather.
        threads: How many shade each picture, from 1 on: more is faster where a person waits for a large picture, and
            nothing where many pictures are drawn at once.
        on_progress: Told what takes long, now and then, where the kernels have to be compiled first.

    Raises:
        SettingsError: If there are fewer threads than one.
    """

    def __init__(
        self,
        scene: Scene,
        conditions: Conditions | None = None,
        *,
        threads: int = 1,
        on_progress: Progress | None = None,
    ) -> None:
        if threads < 1:
            raise SettingsError("renderer", [Fault(f"{threads} threads", "1 or more")])
        self._threads = threads
        self.scene = scene
        self.conditions = conditions or Conditions()
        self._light = light_of(self.conditions)
        self._textures = material_textures()
        self._surfaces = surfaces_of(scene.library, scene.instances)
        self._looks = ground_looks_of(scene.ground, self._textures)
        self._shadows = ShadowTiles(scene, sun_direction(self.conditions))
        self._curve = developing_curve()
        self._rooms = threading.local()
        make_ready(on_progress)

    def picture(self, pose: Pose, camera: Camera, *, pitch_rad: float = 0.0, antialias: int = 1) -> Picture:
        """Return what a camera sees.

        Args:
            pose: Where the camera is and its compass heading.
            camera: Size and field of view.
            pitch_rad: How far it looks up (positive) or down, radians.
            antialias: Samples along the side of a pixel: 1 or 2. With 2 the id of a pixel is the one that most of its
                samples show.

        Raises:
            SettingsError: If any of them is out of range.
        """
        view = projection_of(pose, camera, pitch_rad=pitch_rad, antialias=antialias)
        canvas = self._drawn(view)
        colour = self._shaded(view, canvas, camera)
        depth_m, instances = self._read(view, canvas)
        return Picture(depth_m, instances, colour)

    def ids(self, pose: Pose, camera: Camera, *, pitch_rad: float = 0.0) -> Sighted:
        """Return depth and instance ids alone, which is much faster; see `picture`."""
        return self.ids_in(projection_of(pose, camera, pitch_rad=pitch_rad))

    def ids_in(self, view: Projection) -> Sighted:
        """Return depth and instance ids in a view that was projected before; see `ids`."""
        return Sighted(*self._read(view, self._drawn(view)))

    def classes(self, instances: NDArray[np.int32]) -> NDArray[np.uint8]:
        """Return the classes of instance ids, as places in `PICTURE_CLASSES`, in the same shape."""
        found: NDArray[np.uint8] = self.scene.classes[instances]
        return found

    def _drawn(self, view: Projection, *, everything: bool = False) -> Canvas:
        scene = self.scene
        canvas, scratch = self._canvas(view), self._room().scratch
        count = gather(scene.library, scene.instances, scene.cells, view, everything, scratch)
        draw(scene.library, scene.instances, count, view, DENSITY, everything, canvas, scratch)
        return canvas

    def _read(self, view: Projection, canvas: Canvas) -> tuple[NDArray[np.float32], NDArray[np.int32]]:
        size = view.height // view.samples, view.width // view.samples
        depth_m, instances = np.empty(size, np.float32), np.empty(size, np.int32)
        read_out(canvas, self.scene.instances.ids, view, depth_m, instances)
        return depth_m, instances

    def _shaded(self, view: Projection, canvas: Canvas, camera: Camera) -> NDArray[np.uint8]:
        colour = np.empty((camera.height_px, camera.width_px, 3), np.uint8)
        wanted, rows = self._room().wanted, np.ones(camera.height_px, np.uint8)
        # Where there is no tile yet, nearly all that are needed are found out with few pixels.
        step = 1 if self._shadows.are_begun else _QUICK_STEP
        while True:
            wanted[:] = 0
            with self._shadows.shading():
                done = self._shade(view, canvas, step, rows, colour)
            if done and step == 1:
                return colour
            # Wet ground mirrors rows above it, which may have been wrong.
            if step > 1 or self._light.wetness > 0.0:
                rows[:] = 1
            step = 1
            self._shadows.make(wanted)

    def _shade(
        self, view: Projection, canvas: Canvas, step: int, rows: NDArray[np.uint8], colour: NDArray[np.uint8]
    ) -> bool:
        """Shade the rows that are marked, and note which shadow tiles are wanted; see `shade`."""
        wanted = self._room().wanted

        def shade_some(rows: NDArray[np.uint8], wanted: NDArray[np.uint8]) -> bool:
            return shade(
                self._surfaces,
                self._looks,
                self._textures,
                self._light,
                self._shadows.maps,
                view,
                canvas,
                self._curve,
                wanted,
                np.empty(4, np.int32),
                np.empty(4, np.int32),
                np.empty((4, colour.shape[1])),
                step,
                rows,
                colour,
            )

        # A quick look is not worth threads, and what wet ground mirrors has to be there first.
        if self._threads == 1 or step > 1 or self._light.wetness > 0.0:
            return shade_some(rows, wanted)
        turns = np.arange(len(rows)) // _BAND % self._threads
        shares = [rows * (turns == k) for k in range(self._threads)]
        missing = [np.zeros_like(wanted) for _ in shares]
        with ThreadPoolExecutor(self._threads) as pool:
            done = all(list(pool.map(shade_some, shares, missing)))
        rows[:] = np.maximum.reduce(shares)
        wanted[:] = np.maximum.reduce(missing)
        return done

    def _room(self) -> Room:
        if not hasattr(self._rooms, "room"):
            self._rooms.room = Room(self.scene, self._shadows.wanted_size)
        room: Room = self._rooms.room
        return room

    def _canvas(self, view: Projection) -> Canvas:
        canvases = self._room().canvases
        key = (view.height, view.width)
        if key not in canvases:
            canvases.clear()
            canvases[key] = new_canvas(*key)
        return canvases[key]
