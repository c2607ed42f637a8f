"""What looks for a machine behind MAVLink: its pictures do not come over that wire."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray


class PictureSource(Protocol):
    """What takes pictures."""

    async def take(self, bearing_rad: float) -> NDArray[np.uint8]:
        """Return a picture, RGB, of what lies at a bearing from straight ahead; called in the live loop.

        Raises:
            PartError: If there is none.
        """
        ...
