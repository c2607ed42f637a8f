"""Textures as the shader reads them: three channels in one number, halved from level to level."""

import numpy as np

from reasoned_explorer.rendering.library import linear_from_srgb
from reasoned_explorer.rendering.mipmaps import textures_of
from reasoned_explorer.rendering.texture_kernels import LANE, TEXEL_BITS

FULL = (1 << TEXEL_BITS) - 1


def channels(texels: np.ndarray) -> np.ndarray:
    return np.stack([texels >> k * LANE & FULL for k in range(3)], axis=-1) / FULL


def test_a_texel_keeps_its_colour_to_half_a_unit() -> None:
    stack = np.random.default_rng(0).random((2, 8, 8, 3), np.float32)
    textures = textures_of(stack, np.array([1.0, 2.0], np.float32))
    finest = channels(textures.texels[: 2 * 64]).reshape(stack.shape)
    np.testing.assert_allclose(finest, linear_from_srgb(stack), atol=0.5 / FULL + 1e-7)


def test_each_level_is_the_mean_of_the_finer_one_and_the_last_is_one_texel() -> None:
    stack = np.random.default_rng(1).random((1, 4, 4, 3), np.float32)
    textures = textures_of(stack, np.ones(1, np.float32))
    assert textures.starts.tolist() == [0, 16, 20]
    assert len(textures.texels) == 21
    finest, last = channels(textures.texels[:16]), channels(textures.texels[20:])
    np.testing.assert_allclose(last[0], finest.mean(axis=0), atol=1.0 / FULL)


def test_a_weighted_channel_stays_in_its_lane() -> None:
    # The greatest channel times the greatest weight, rounded: the next lane must not be touched.
    assert FULL * 256 + 128 < 1 << LANE
    white = textures_of(np.ones((1, 2, 2, 3), np.float32), np.ones(1, np.float32)).texels[0]
    assert int(white) * 256 < 1 << 63
