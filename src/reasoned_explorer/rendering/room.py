"""What one thread works in while it draws."""

import numpy as np

from reasoned_explorer.rendering.raster_kernels import BLOCK, BUCKETS, Canvas, Scratch
from reasoned_explorer.rendering.scene import Scene


class Room:
    """Arrays for the kernels, made once for a thread.

    Attributes:
        scratch: What is worked out on the way.
        wanted: For the shader: which shadow tiles are missing.
        canvases: Those of pictures of one size.
    """

    def __init__(self, scene: Scene, wanted_size: int) -> None:
        count = len(scene.instances.ids)
        self.scratch = Scratch(
            np.empty((int(scene.library.levels[:, 1].max(initial=1)), 5)),
            np.empty(count, np.int32),
            np.empty(count, np.int32),
            np.empty(count),
            np.empty((count + 1, 4), np.int32),
            np.empty(count, np.int8),
            np.empty(count, np.int32),
            np.empty(BUCKETS + 1, np.int32),
            np.empty((3, 4)),
        )
        self.wanted = np.zeros(wanted_size, np.uint8)
        self.canvases: dict[tuple[int, int], Canvas] = {}


def new_canvas(height: int, width: int) -> Canvas:
    """Return a canvas of so many samples with nothing on it yet."""
    blocks = (-(-height // BLOCK), -(-width // BLOCK))
    return Canvas(
        np.empty((height, width), np.float32),
        np.empty((height, width), np.int32),
        np.empty((height, width), np.int32),
        np.empty(blocks, np.float32),
    )
