import io

import numpy as np
import pytest
from PIL import Image

from reasoned_explorer.vehicles.airsim.pictures import colour_of, depth_of

RGB = np.arange(2 * 3 * 3, dtype=np.uint8).reshape(2, 3, 3)


def answer(**more):
    return {"width": 3, "height": 2, "compress": False, "image_data_uint8": b"", "image_data_float": []} | more


def test_raw_pictures_are_blue_green_red():
    raw = np.ascontiguousarray(RGB[:, :, ::-1]).tobytes()
    assert np.array_equal(colour_of(answer(image_data_uint8=raw)), RGB)


def test_some_servers_add_a_fourth_channel():
    raw = np.concatenate([RGB[:, :, ::-1], np.full((2, 3, 1), 255, np.uint8)], axis=2).tobytes()
    assert np.array_equal(colour_of(answer(image_data_uint8=raw)), RGB)


@pytest.mark.parametrize("mode", ["RGB", "RGBA"])
def test_packed_pictures_are_pngs_with_or_without_transparency(mode):
    held = io.BytesIO()
    Image.fromarray(RGB).convert(mode).save(held, "PNG")
    assert np.array_equal(colour_of(answer(compress=True, image_data_uint8=held.getvalue())), RGB)


def test_depths_are_infinite_where_nothing_is():
    depth_m = depth_of(answer(image_data_float=[1.0, 2.0, 3.0, 4.0, 5.0, 65504.0]))
    assert depth_m.tolist() == [[1.0, 2.0, 3.0], [4.0, 5.0, np.inf]]


@pytest.mark.parametrize(
    "more",
    [
        {"image_data_uint8": b"1234"},
        {"compress": True, "image_data_uint8": b"no PNG"},
        {"width": "3"},
        {"width": 0},
        {"image_data_uint8": 7},
    ],
)
def test_what_is_no_picture_is_refused(more):
    with pytest.raises(ValueError, match=r"picture|PNG|bytes"):
        colour_of(answer(**more))
