"""Pictures of a real camera as those of a profile's."""

import math

import numpy as np
import pytest

from reasoned_explorer.model import Camera
from reasoned_explorer.vehicles.cameras import fitted

WIDE = np.zeros((180, 320, 3), np.uint8)
WIDE[:, 70:250] = 200  # the middle square
WIDE[:, 155:165] = 255


def test_a_wide_picture_is_cut_to_the_square_in_its_middle():
    picture = fitted(WIDE, Camera(224, 224))
    assert picture.shape == (224, 224, 3)
    assert picture.dtype == np.uint8
    assert picture[:, 5:-5].min() >= 195
    assert picture[100, 112, 0] > 240


def test_what_the_profiles_camera_does_not_see_is_cut_off():
    fov_rad = math.radians(120.0)
    picture = fitted(WIDE, Camera(224, 224, math.radians(60.0)), fov_rad=fov_rad)
    kept_px = 320.0 * math.tan(math.radians(30.0)) / math.tan(math.radians(60.0))
    bright_px = (picture[100, :, 0] > 240).sum()
    assert bright_px == pytest.approx(224.0 * 10.0 / kept_px, abs=3.0)


def test_where_a_camera_sees_less_nothing_is_made_up():
    narrow = fitted(WIDE, Camera(224, 224), fov_rad=math.radians(40.0))
    assert np.array_equal(narrow, fitted(WIDE, Camera(224, 224)))


def test_it_is_as_large_as_it_is_wanted():
    assert fitted(WIDE, Camera(224, 112), least_px=448).shape == (224, 448, 3)
