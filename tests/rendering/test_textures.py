"""Every material has a texture: it tiles, it is the same on every call, and colours show through it."""

import numpy as np
import pytest

from reasoned_explorer.rendering.material import Material
from reasoned_explorer.rendering.textures import TEXTURE_METRES, texture_stack

#: Those that bring colours of their own, to be tinted only a little.
COLOURED = {Material.FACADE_BRICK, Material.FACADE_GLASS, Material.FACADE_SHOP, Material.FLOWERS}


def test_the_stack_has_one_square_for_each_material() -> None:
    stack = texture_stack()
    assert stack.shape == (len(Material), 128, 128, 3)
    assert stack.dtype == np.float32
    assert stack.min() >= 0.0
    assert stack.max() <= 1.0
    assert TEXTURE_METRES.shape == (len(Material),)
    assert (TEXTURE_METRES >= 0.5).all()


def test_the_stack_is_the_same_whenever_it_is_made() -> None:
    assert texture_stack.__wrapped__().tobytes() == texture_stack().tobytes()
    np.testing.assert_allclose(texture_stack() * 255.0, np.rint(texture_stack() * 255.0), atol=1e-4)


def test_nobody_can_change_what_others_get() -> None:
    with pytest.raises(ValueError, match="read-only"):
        texture_stack()[0, 0, 0, 0] = 0.5
    with pytest.raises(ValueError, match="read-only"):
        TEXTURE_METRES[0] = 2.0


@pytest.mark.parametrize("material", Material)
@pytest.mark.parametrize("axis", [0, 1])
def test_no_seam_shows_where_textures_meet(material: Material, axis: int) -> None:
    picture = texture_stack()[material].astype(np.float64)
    steps = np.abs(picture - np.roll(picture, 1, axis=axis)).mean(axis=(1 - axis, 2))
    # The first step is the one over the seam.
    assert steps[0] <= 1.25 * steps[1:].max() + 0.01


@pytest.mark.parametrize("material", sorted(set(Material) - COLOURED))
def test_a_colour_shows_through(material: Material) -> None:
    mean = texture_stack()[material].mean(axis=(0, 1))
    assert mean.min() > 0.55
    assert mean.max() - mean.min() < 0.2


def test_materials_can_be_told_apart() -> None:
    plain = {Material.PLAIN, Material.GLOW}
    looks = {texture_stack()[material].tobytes() for material in Material if material not in plain}
    assert len(looks) == len(Material) - len(plain)


def test_facades_have_windows_darker_than_their_walls() -> None:
    for material in (Material.FACADE, Material.FACADE_BRICK):
        picture = texture_stack()[material].mean(axis=2)
        # Four bays of 64 texels: the middle of each is a window, its border is wall.
        for row in (0, 64):
            for column in (0, 64):
                bay = picture[row : row + 64, column : column + 64]
                assert np.median(bay[20:46, 20:44]) < 0.75 * bay[:, :8].mean()
