"""The shadow tiles of a scene under one sun: made when a picture first needs them, kept while there is room."""

import threading
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.rendering.scene import GROUND_ID, Scene
from reasoned_explorer.rendering.shadow_kernels import BLOCKS, COARSE_M, FINE_M, MARGIN, SIDE, ShadowMaps, cast

#: Tiles that are kept at most, of each size. One takes 135 kB.
FINE_TILES, COARSE_TILES = 768, 512


class ShadowTiles:
    """Makes and keeps the shadow tiles of a scene.

    Pictures may be drawn in several threads: tiles are made by one of them at a time, and what is thrown away to make
    room is thrown away when no picture is being shaded.

    Args:
        scene: The scene.
        sun: Direction to the sun, ENU, of length 1, above the horizon.
    """

    def __init__(self, scene: Scene, sun: NDArray[np.float64]) -> None:
        self._scene = scene
        shear = -sun[:2] / sun[2]
        self._footprints = _footprints(scene, shear)
        corner, columns, rows = _extent(self._footprints)
        self._fine = _Pages(rows * 4, columns * 4, FINE_M, 0, FINE_TILES)
        self._coarse = _Pages(rows, columns, COARSE_M, 1, COARSE_TILES)
        self._corners = np.empty((_most_vertices(scene), 3))
        self._gate = _Gate()
        self._making = threading.Lock()
        self.maps = ShadowMaps(
            np.concatenate([corner, shear]),
            self._fine.table,
            self._fine.tiles,
            self._fine.limits,
            self._coarse.table,
            self._coarse.tiles,
            self._coarse.limits,
        )

    @property
    def wanted_size(self) -> int:
        """Length of the array in which the shader notes what it misses."""
        return 1 + self._fine.table.size + self._coarse.table.size

    @property
    def are_begun(self) -> bool:
        """Whether there is a tile."""
        return self._fine.free < len(self._fine.tiles) or self._coarse.free < len(self._coarse.tiles)

    def shading(self) -> AbstractContextManager[None]:
        """Return a context in which no tile is thrown away."""
        return self._gate.shared()

    def make(self, wanted: NDArray[np.uint8]) -> None:
        """Make the tiles that the shader missed (see `sunlight_at`)."""
        with self._making:
            split = 1 + self._fine.table.size
            for pages, marks in ((self._fine, wanted[1:split]), (self._coarse, wanted[split:])):
                missing = [int(k) for k in np.flatnonzero(marks) if pages.table.flat[k] < 0]
                if len(missing) > pages.free:
                    with self._gate.alone():
                        pages.forget()
                for place in missing:
                    self._make(pages, place)

    def _make(self, pages: "_Pages", place: int) -> None:
        row, column = divmod(place, pages.table.shape[1])
        slot = pages.take()
        edge = pages.texel_m * SIDE
        frame = self.maps.frame
        cast(
            self._scene.library,
            self._scene.instances,
            self._footprints,
            frame[2:],
            float(frame[0] + column * edge),
            float(frame[1] + row * edge),
            pages.texel_m,
            pages.coarser,
            self._corners,
            pages.tiles[slot],
            pages.limits[slot],
        )
        pages.table[row, column] = slot  # last: other threads read it


class _Pages:
    """Tiles of one size and the table that says where each lies."""

    def __init__(self, rows: int, columns: int, texel_m: float, coarser: int, most: int) -> None:
        self.table = np.full((rows, columns), -1, np.int32)
        self.texel_m = texel_m
        self.coarser = coarser
        side = SIDE + 2 * MARGIN
        self.tiles = np.empty((min(most, rows * columns), side, side), np.uint16)
        self.limits = np.empty((len(self.tiles), BLOCKS, BLOCKS, 2), np.uint16)
        self._used = 0

    @property
    def free(self) -> int:
        return len(self.tiles) - self._used

    def take(self) -> int:
        self._used += 1
        return self._used - 1

    def forget(self) -> None:
        """Throw all tiles away: what is still needed is made again, to the byte."""
        self.table[:] = -1
        self._used = 0


class _Gate:
    """Many may pass together, or one alone."""

    def __init__(self) -> None:
        self._condition = threading.Condition()
        self._inside = 0

    @contextmanager
    def shared(self) -> Iterator[None]:
        with self._condition:
            self._inside += 1
        try:
            yield
        finally:
            with self._condition:
                self._inside -= 1
                self._condition.notify_all()

    @contextmanager
    def alone(self) -> Iterator[None]:
        with self._condition:
            self._condition.wait_for(lambda: self._inside == 0)
            yield


def _footprints(scene: Scene, shear: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return west, south, east and north end of each instance's shadow; what lies on the ground casts none."""
    instances = scene.instances
    boxes = scene.library.boxes[instances.prototypes] * instances.scales[:, None, :]
    corners = np.stack([boxes[:, [k & 1, k >> 1 & 1, k >> 2], [0, 1, 2]] for k in range(8)], axis=1)
    sine, cosine = instances.turns[:, :1], instances.turns[:, 1:]
    z = corners[:, :, 2] + instances.places[:, 2:]
    x = corners[:, :, 0] * cosine + corners[:, :, 1] * sine + instances.places[:, :1] + z * shear[0]
    y = corners[:, :, 1] * cosine - corners[:, :, 0] * sine + instances.places[:, 1:2] + z * shear[1]
    ends = np.stack([x.min(axis=1), y.min(axis=1), x.max(axis=1), y.max(axis=1)], axis=1)
    ends[instances.ids == GROUND_ID] = (np.inf, np.inf, -np.inf, -np.inf)
    return ends


def _extent(footprints: NDArray[np.float64]) -> tuple[NDArray[np.float64], int, int]:
    edge = COARSE_M * SIDE
    real = footprints[np.isfinite(footprints[:, 0])]
    if not len(real):
        return np.zeros(2), 1, 1
    low = np.floor(real[:, :2].min(axis=0) / edge - 0.01)
    high = np.ceil(real[:, 2:].max(axis=0) / edge + 0.01)
    columns, rows = (high - low).astype(int).tolist()
    return low * edge, columns, rows


def _most_vertices(scene: Scene) -> int:
    return int(scene.library.levels[:, 1].max(initial=1))
