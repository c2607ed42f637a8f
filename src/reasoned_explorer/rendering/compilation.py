"""Compiles parts of the renderer: ``python -m reasoned_explorer.rendering.compilation shading``.

Kernels are called as `Renderer` calls them, on next to nothing, so that numba compiles them for the same types.
"""

import sys
from collections.abc import Callable, Mapping

import numpy as np

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Camera
from reasoned_explorer.rendering.conditions import Conditions
from reasoned_explorer.rendering.ground import GroundMap
from reasoned_explorer.rendering.keeping import compile_missing, telling
from reasoned_explorer.rendering.light import developing_curve, light_of, sun_direction
from reasoned_explorer.rendering.material import Material
from reasoned_explorer.rendering.mesh import Mesh, Model
from reasoned_explorer.rendering.mipmaps import ground_looks_of, surfaces_of, textures_of
from reasoned_explorer.rendering.projection import projection_of
from reasoned_explorer.rendering.raster_kernels import SKY, draw, gather, read_out
from reasoned_explorer.rendering.room import Room, new_canvas
from reasoned_explorer.rendering.scene import FIRST_BUILDING_ID, Placed, Scene
from reasoned_explorer.rendering.shading_kernels import shade
from reasoned_explorer.rendering.shadows import ShadowTiles

_SIDE = 8
_VIEW = projection_of(Pose(0.0, 0.0, 500.0), Camera(_SIDE, _SIDE))


def compile_part(part: str) -> None:
    """Compile a part (see `reasoned_explorer.rendering.readiness.PARTS`), or read it from disk if it is there."""
    _PARTS[part](_scene())


def _scene() -> Scene:
    """Return a scene of one triangle."""
    triangle = Mesh(
        np.array([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 1.0)], np.float32),
        np.array([(0, 1, 2)], np.int32),
        np.full((1, 3, 3), 3.0**-0.5, np.float32),
        np.zeros((1, 3, 2), np.float32),
        np.ones((1, 3), np.float32),
        np.zeros(1, np.uint8),
    )
    ground = GroundMap(
        np.zeros((_SIDE, _SIDE), np.uint8),
        np.array([0.0, 0.0, 1.0]),
        np.zeros(1, np.uint8),
        np.ones((1, 3), np.float32),
    )
    thing = Placed(Model((triangle,), (1.0, 1.0, 1.0)), FIRST_BUILDING_ID, (0.0, 0.0, 0.0))
    return Scene.of_things([thing], ground, np.array([0, 1, 2], np.uint8))


def _compile_gathering(scene: Scene) -> None:
    gather(scene.library, scene.instances, scene.cells, _VIEW, False, Room(scene, 1).scratch)  # noqa: FBT003 - a kernel


def _compile_drawing(scene: Scene) -> None:
    canvas, room = new_canvas(_SIDE, _SIDE), Room(scene, 1)
    draw(scene.library, scene.instances, 0, _VIEW, 1.0, False, canvas, room.scratch)  # noqa: FBT003 - a kernel


def _compile_reading(scene: Scene) -> None:
    canvas = new_canvas(_SIDE, _SIDE)
    canvas.owners[:], canvas.triangles[:], canvas.nearness[:] = SKY, -1, 0.0
    depth_m, instances = np.empty((_SIDE, _SIDE), np.float32), np.empty((_SIDE, _SIDE), np.int32)
    read_out(canvas, scene.instances.ids, _VIEW, depth_m, instances)


def _compile_shading(scene: Scene) -> None:
    shadows = ShadowTiles(scene, sun_direction(Conditions()))
    room = Room(scene, shadows.wanted_size)
    canvas = new_canvas(_SIDE, _SIDE)
    canvas.owners[:], canvas.triangles[:], canvas.nearness[:] = SKY, -1, 0.0
    textures = textures_of(np.ones((len(Material), 2, 2, 3), np.float32), np.ones(len(Material), np.float32))
    shade(
        surfaces_of(scene.library, scene.instances),
        ground_looks_of(scene.ground, textures),
        textures,
        light_of(Conditions()),
        shadows.maps,
        _VIEW,
        canvas,
        developing_curve(),
        room.wanted,
        np.empty(4, np.int32),
        np.empty(4, np.int32),
        np.empty((4, _SIDE)),
        1,
        np.ones(_SIDE, np.uint8),
        np.empty((_SIDE, _SIDE, 3), np.uint8),
    )


def _compile_shadows(scene: Scene) -> None:
    shadows = ShadowTiles(scene, sun_direction(Conditions()))
    wanted = np.zeros(shadows.wanted_size, np.uint8)
    wanted[:2] = 1
    shadows.make(wanted)


_PARTS: Mapping[str, Callable[[Scene], None]] = {
    "drawing": _compile_drawing,
    "gathering": _compile_gathering,
    "reading": _compile_reading,
    "shading": _compile_shading,
    "shadows": _compile_shadows,
}


def main() -> None:
    """Compile the parts that the command line names and that are not there yet; say a line for each function."""
    with telling(lambda name: print(name, flush=True)):
        compile_missing(sys.argv[1:], compile_part)


if __name__ == "__main__":
    main()
