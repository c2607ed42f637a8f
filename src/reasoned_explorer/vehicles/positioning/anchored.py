"""Fixes that are only believed where they begin near to where a person says that the machine stands."""

import math
from collections.abc import AsyncGenerator
from contextlib import aclosing
from dataclasses import replace

from reasoned_explorer.geometry import Pose
from reasoned_explorer.geometry.frames import GeoOrigin
from reasoned_explorer.model import PartError
from reasoned_explorer.vehicles.positioning.fix import Fix, FixQuality
from reasoned_explorer.vehicles.positioning.receiver import Receiver
from reasoned_explorer.vehicles.standing import WITHIN_M


class AnchoredReceiver:
    """A receiver whose first fix must fit the start: a wrong world, a wrong start or another's receiver are found out.

    Args:
        receiver: The receiver.
        start: Where the machine stands in the world's frame.
        is_placed: Whether the receiver's origin is where the world's frame lies on earth. Otherwise that is not known,
            and the frame is laid so that the first fix is at the start.
        within_m: How far the first fix may be from the start, metres.
    """

    def __init__(self, receiver: Receiver, start: Pose, *, is_placed: bool = True, within_m: float = WITHIN_M) -> None:
        self._receiver, self._start, self._within_m = receiver, start, within_m
        self._is_placed, self._has_begun = is_placed, False
        self._origin: GeoOrigin | None = None

    async def fixes(self) -> AsyncGenerator[Fix, None]:
        """Yield fixes as they come.

        Raises:
            PartError: If the first one is too far from the start, the receiver cannot be reached, or it goes away.
            MissingDependencyError: See `Receiver.fixes`.
        """
        async with aclosing(self._receiver.fixes()) as fixes:
            async for fix in fixes:
                yield fix if fix.quality is FixQuality.NONE else self._anchored(fix)

    def _anchored(self, fix: Fix) -> Fix:
        if not self._has_begun:
            self._begin(fix)
        if self._origin is None:
            return fix
        east_m, north_m = self._origin.enu_from_geodetic_m(fix.lat_deg, fix.lon_deg)
        return replace(fix, x_m=self._start.x_m + float(east_m), y_m=self._start.y_m + float(north_m))

    def _begin(self, fix: Fix) -> None:
        if not self._is_placed:
            self._origin = GeoOrigin(fix.lat_deg, fix.lon_deg)
        else:
            off_m = math.hypot(fix.x_m - self._start.x_m, fix.y_m - self._start.y_m)
            if not off_m <= self._within_m:
                where = f"{fix.lat_deg:.6f},{fix.lon_deg:.6f}"
                far = f"{off_m:.0f} m" if off_m < 1e4 else f"{off_m / 1e3:.0f} km"
                raise PartError(
                    "positioning",
                    f"the receiver is at {where}, {far} from the start: see to --start, --world and --gps",
                )
        self._has_begun = True
