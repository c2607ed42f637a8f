"""A few small pictures are what they were when somebody last looked at them.

When they are meant to change: ``python -m tests.rendering.test_goldens``, look at them, and commit them.
"""

import math
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Camera
from reasoned_explorer.rendering.conditions import PRESETS
from reasoned_explorer.rendering.material import Material
from reasoned_explorer.rendering.renderer import Renderer
from tests.rendering.things import box, scene_of

FOLDER = Path(__file__).parent / "goldens"
#: Bytes may differ by this much in one pixel of a hundred: sines differ in the last bit from processor to processor.
STEP, SHARE = 2, 0.01


def drawn(name: str) -> np.ndarray:
    things = [
        (box((6.0, 4.0, 5.0), (0.8, 0.5, 0.4), Material.BRICK), (-4.0, 5.0, 0.0)),
        (box((4.0, 4.0, 7.0), (0.6, 0.7, 0.8), Material.GLASS), (4.0, 7.0, 0.0)),
        (box((0.1, 0.1, 3.0), (0.3, 0.3, 0.3), Material.METAL), (1.0, 0.0, 0.0)),
        (box((0.6, 0.6, 0.4), (1.0, 0.9, 0.6), Material.GLOW), (1.0, 0.0, 3.0)),
        (box((1.2, 1.2, 1.2), (0.4, 0.6, 0.3), Material.FOLIAGE), (-1.0, -1.0, 0.0)),
    ]
    renderer = Renderer(scene_of(things), PRESETS[name])
    return renderer.picture(Pose(0.5, -8.0, 1.6, 6.2), Camera(72, 54, math.radians(80.0)), antialias=2).colour


@pytest.mark.parametrize("name", sorted(PRESETS))
def test_pictures_are_what_they_were(name: str) -> None:
    kept = np.asarray(Image.open(FOLDER / f"{name}.png")).astype(int)
    far = np.abs(drawn(name).astype(int) - kept).max(axis=2) > STEP
    assert far.mean() <= SHARE


if __name__ == "__main__":
    FOLDER.mkdir(exist_ok=True)
    for preset in PRESETS:
        Image.fromarray(drawn(preset)).save(FOLDER / f"{preset}.png", optimize=True)
