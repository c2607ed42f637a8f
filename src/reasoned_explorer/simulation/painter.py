"""Takes the pictures of the simulated vehicle's cameras."""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Camera, Fault, SettingsError
from reasoned_explorer.model.checks import is_within
from reasoned_explorer.simulation.renderers import renderer_of

if TYPE_CHECKING:
    from reasoned_explorer.rendering.renderer import Picture
    from reasoned_explorer.world.atlas import Atlas

#: Sides of pictures that can be taken, pixels.
SIDE_RANGE_PX = (16, 4096)
#: Samples along the side of a pixel.
_ANTIALIAS = 2


def faults_of_pictures(side_px: object, conditions: object) -> list[Fault]:
    """Return what is wrong with how pictures are to be taken."""
    from reasoned_explorer.rendering.conditions import PRESETS

    low, high = SIDE_RANGE_PX
    faults = []
    if not isinstance(side_px, int) or isinstance(side_px, bool) or not is_within(side_px, low, high):
        faults.append(Fault(f"picture_px is {side_px!r:.60}", f"a whole number from {low} to {high:,}"))
    if conditions not in PRESETS:
        faults.append(Fault(f"conditions are {conditions!r:.60}", f"one of {', '.join(PRESETS)}"))
    return faults


class Painter:
    """Takes square pictures in a world; the same picture for the same pose, whoever asks and whatever came before.

    Args:
        atlas: Of the world; scenes are made once for each.
        side_px: Of a picture, pixels, whatever the camera's own: models want larger ones than symbols need.
        conditions: Time of day and weather, a name of `rendering.conditions.PRESETS`.

    Raises:
        SettingsError: If a setting is out of its range.
    """

    def __init__(self, atlas: "Atlas", *, side_px: int = 448, conditions: str = "clear") -> None:
        if faults := faults_of_pictures(side_px, conditions):
            raise SettingsError("pictures", faults)
        self._renderer = renderer_of(atlas, conditions)
        self._side_px = side_px

    def paint(self, pose: Pose, camera: Camera) -> NDArray[np.uint8]:
        """Return what a camera sees, RGB, shape (side, side, 3); see `picture`."""
        return self.picture(pose, camera).colour

    def picture(self, pose: Pose, camera: Camera) -> "Picture":
        """Return what a camera sees, with depth and ids.

        Args:
            pose: Of the camera: its height is ``z_m``; it looks along its heading, level.
            camera: Its field of view counts.
        """
        square = replace(camera, width_px=self._side_px, height_px=self._side_px)
        return self._renderer.picture(pose, square, antialias=_ANTIALIAS)
