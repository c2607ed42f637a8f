"""A camera that shows the same from elsewhere gives no pictures any more."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import View

#: A camera must show something else after so much way, metres.
_MOVED_M = 1.0


class FrozenPicture:
    """Compares each look with the one before."""

    def __init__(self) -> None:
        self._pose: Pose | None = None
        self._image: Any = None

    def see(self, views: Sequence[View], pose: Pose) -> bool:
        """Take in a look from a pose; return whether its first picture is the one from elsewhere."""
        image = views[0].image if views else None
        if image is None:
            return False
        before, old = self._pose, self._image
        if before is None or before.distance_to_m(pose.x_m, pose.y_m) <= _MOVED_M:
            self._pose, self._image = pose, image
            return False
        if np.array_equal(old, image):
            return True
        self._pose, self._image = pose, image
        return False
