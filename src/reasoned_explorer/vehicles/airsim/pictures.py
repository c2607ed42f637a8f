"""Pictures as AirSim sends them."""

import io
from collections.abc import Mapping
from enum import IntEnum
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.vehicles.airsim.codec import as_bytes

#: What stands for "nothing there" in a depth picture, metres: the largest half-precision number.
NOTHING_M = 65504.0


class ImageType(IntEnum):
    """What a picture shows."""

    SCENE = 0
    DEPTH_PLANAR = 1
    DEPTH_PERSPECTIVE = 2
    DEPTH_VIS = 3
    SEGMENTATION = 5


def colour_of(answer: Mapping[str, Any]) -> NDArray[np.uint8]:
    """Return the RGB picture, shape (height, width, 3), of an answer: a PNG, or rows of blue, green, red.

    Raises:
        ValueError: If it holds none.
    """
    data = as_bytes(answer.get("image_data_uint8", b""))
    if answer.get("compress"):
        return _unpacked(data)
    height, width = _size(answer)
    pixels = np.frombuffer(data, np.uint8)
    for channels in (3, 4):
        if pixels.size == height * width * channels and pixels.size:
            turned = pixels.reshape(height, width, channels)[:, :, 2::-1]
            return np.ascontiguousarray(turned)
    raise ValueError(f"{pixels.size} bytes for a picture of {width} x {height}")


def depth_of(answer: Mapping[str, Any]) -> NDArray[np.float32]:
    """Return depths, metres, shape (height, width); infinite where there is nothing.

    Raises:
        ValueError: If the answer holds none.
    """
    height, width = _size(answer)
    depth_m = np.asarray(answer.get("image_data_float", ()), np.float32)
    if depth_m.shape != (height * width,):
        raise ValueError(f"{depth_m.size} depths for a picture of {width} x {height}")
    depth_m = depth_m.reshape(height, width)
    return np.where(depth_m >= NOTHING_M, np.float32(np.inf), depth_m)


def _size(answer: Mapping[str, Any]) -> tuple[int, int]:
    height, width = answer.get("height"), answer.get("width")
    if type(height) is not int or type(width) is not int or not (0 < height <= 8192 and 0 < width <= 8192):
        raise ValueError(f"a picture of {width!r:.20} x {height!r:.20}")
    return height, width


def _unpacked(data: bytes) -> NDArray[np.uint8]:
    from PIL import Image, UnidentifiedImageError

    try:
        with Image.open(io.BytesIO(data), formats=["PNG"]) as picture:
            return np.asarray(picture.convert("RGB"), np.uint8).copy()
    except (OSError, SyntaxError, UnidentifiedImageError, Image.DecompressionBombError) as error:
        raise ValueError(f"{len(data)} bytes that are no PNG: {error}") from error
