"""Shadow tiles: what is known of a tile's blocks is true of every look-up that begins in them."""

import numpy as np

from reasoned_explorer.rendering.shadow_kernels import BLOCKS, MARGIN, SIDE
from reasoned_explorer.rendering.shadows import ShadowTiles
from tests.rendering.things import box, scene_of

#: Texels along the side of what one look-up takes.
TAPS = 4


def test_no_look_up_finds_less_or_more_than_the_limits_of_its_block() -> None:
    scene = scene_of([(box((3.0, 2.0, 5.0)), (1.0, 2.0, 0.0)), (box((0.2, 0.2, 3.0)), (-4.0, -1.0, 0.0))])
    shadows = ShadowTiles(scene, np.array([0.48, 0.36, 0.8]))
    wanted = np.ones(shadows.wanted_size, np.uint8)
    shadows.make(wanted)
    maps = shadows.maps
    assert maps.fine_limits.shape == (len(maps.fine), BLOCKS, BLOCKS, 2)
    assert (maps.fine > 0).any()
    for tiles, limits in ((maps.fine, maps.fine_limits), (maps.coarse, maps.coarse_limits)):
        windows = np.lib.stride_tricks.sliding_window_view(tiles, (TAPS, TAPS), axis=(1, 2))
        assert windows.shape[1] == SIDE + 2 * MARGIN - TAPS + 1
        block = np.arange(windows.shape[1]) >> 3
        found = limits[:, block[:, None], block]
        assert (found[..., 0] <= windows.min(axis=(3, 4))).all()
        assert (found[..., 1] >= windows.max(axis=(3, 4))).all()


def test_limits_are_as_narrow_as_what_a_block_holds() -> None:
    shadows = ShadowTiles(scene_of([(box((3.0, 2.0, 5.0)), (1.0, 2.0, 0.0))]), np.array([0.48, 0.36, 0.8]))
    shadows.make(np.ones(shadows.wanted_size, np.uint8))
    tile, limits = shadows.maps.coarse[0], shadows.maps.coarse_limits[0]
    for j, i in ((0, 0), (5, 7), (BLOCKS - 1, BLOCKS - 1)):
        block = tile[8 * j : 8 * j + 8 + TAPS - 1, 8 * i : 8 * i + 8 + TAPS - 1]
        assert limits[j, i].tolist() == [block.min(), block.max()]
