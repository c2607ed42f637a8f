"""How fast an autopilot goes to its setpoints."""

from reasoned_explorer.vehicles.mavlink.autopilot import Autopilot

_CHANGE_SPEED, _GROUND_SPEED, _THROTTLE_AS_IS = 178, 1, -1.0
#: The greatest speed of PX4's drones, by which setpoints are flown to.
_PX4_SPEED = "MPC_XY_VEL_MAX"


class Speed:
    """Takes the speed in hand while the driver steers.

    Args:
        autopilot: Whose.
    """

    def __init__(self, autopilot: Autopilot) -> None:
        self._autopilot = autopilot
        self._old: float | None = None

    async def take(self, speed_mps: float) -> None:
        """Have the machine go so fast.

        Raises:
            PartError: If the autopilot refuses or does not answer.
        """
        autopilot = self._autopilot
        if not autopilot.flavour.is_px4:
            await autopilot.command(_CHANGE_SPEED, _GROUND_SPEED, speed_mps, _THROTTLE_AS_IS)
        elif autopilot.settings.takes_speed and autopilot.flavour.flies:
            self._old = await autopilot.parameter(_PX4_SPEED)
            await autopilot.set_parameter(_PX4_SPEED, speed_mps)

    async def give_back(self) -> None:
        """Have it be as fast as before, where a parameter was changed.

        Raises:
            PartError: If the autopilot does not answer.
        """
        old, self._old = self._old, None
        if old is not None and not self._autopilot.lost():
            await self._autopilot.set_parameter(_PX4_SPEED, old)
