"""How an ArduPilot is led to a target: by velocities that it must hear anew, or it stands by itself.

A position that it was told it goes to, whoever is heard on the way; its failsafe for a lost ground station waits for
two seconds at least. A velocity it gives up `GUID_TIMEOUT` after it last heard one: a parameter of drones from
ArduCopter 4.1 on (3 s unless set, 0.1 to 5 s; ArduCopter/mode_guided.cpp), of rovers since August 2026 (ArduPilot's
pull request 34085; before, 3 s that cannot be set). So a machine is told its velocity ten times a second, and near its
target the target itself.
"""

import math

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import PartError
from reasoned_explorer.vehicles.control.follower import FollowerSettings
from reasoned_explorer.vehicles.mavlink.autopilot import Autopilot
from reasoned_explorer.vehicles.mavlink.setpoints import Setpoint
from reasoned_explorer.vehicles.profile import VehicleProfile

#: So long a velocity counts, and how often it is told, seconds.
LAPSE_S, RENEW_S = 0.5, 0.1
#: So near the target it is told the target, metres.
_NEAR_M = 0.25
#: No faster up or down, metres a second.
_CLIMB_MPS = 1.0
_PARAMETER = "GUID_TIMEOUT"


class Lapse:
    """Has an ArduPilot give up velocities soon while the driver steers.

    Args:
        autopilot: Whose.
    """

    def __init__(self, autopilot: Autopilot) -> None:
        self._autopilot = autopilot
        self._old: float | None = None

    @property
    def is_on(self) -> bool:
        """Whether it does."""
        return self._old is not None

    async def take(self) -> None:
        """Set it, where the autopilot has such a parameter."""
        if self._autopilot.flavour.is_px4:
            return
        try:
            old = await self._autopilot.parameter(_PARAMETER)
            await self._autopilot.set_parameter(_PARAMETER, LAPSE_S)
        except PartError:
            self._autopilot.check()  # it is there, and does not know it
        else:
            self._old = old

    async def give_back(self) -> None:
        """Have it be as it was.

        Raises:
            PartError: If the autopilot does not answer.
        """
        old, self._old = self._old, None
        if old is not None and not self._autopilot.lost():
            await self._autopilot.set_parameter(_PARAMETER, old)


class Approach:
    """Leads one machine to one target, along the straight line to it.

    Each velocity is such that the machine, hearing nothing more, would stop on that line, and not behind the target.

    Args:
        start: Where it sets off.
        target: Where to.
        profile: What the machine can do.
    """

    def __init__(self, start: Pose, target: Pose, profile: VehicleProfile) -> None:
        self.start, self.target, self._profile = start, target, profile
        self._braking_mps2 = FollowerSettings.of(profile).braking_mps2
        #: Whether it was told the target itself.
        self.is_over = False

    def setpoint(self, here: Pose) -> Setpoint | None:
        """Return what to tell a machine that is here; None where it is to be told the target."""
        target, flies = self.target, self._profile.flies
        if here.distance_to_m(target.x_m, target.y_m) <= _NEAR_M:
            self.is_over = True
            return None
        east_m, north_m = self._ahead_m(here)
        way_m = math.hypot(east_m, north_m)
        # It goes on for as long as the velocity counts, then brakes.
        speed_mps = self._braking_mps2 * (math.sqrt(LAPSE_S**2 + 2.0 * way_m / self._braking_mps2) - LAPSE_S)
        rise_mps = max(-_CLIMB_MPS, min(_CLIMB_MPS, (target.z_m - here.z_m) / LAPSE_S)) if flies else 0.0
        velocity = north_m * speed_mps / way_m, east_m * speed_mps / way_m, 0.0 - rise_mps
        return Setpoint(yaw_rad=target.heading_rad if flies else math.nan, velocity_mps=velocity)

    def _ahead_m(self, here: Pose) -> tuple[float, float]:
        """Return the way, east and north, to where it would stop at full speed; at most to the target."""
        target, cruise_mps = self.target, self._profile.speed_mps
        left = target.x_m - here.x_m, target.y_m - here.y_m
        reach_m = cruise_mps * LAPSE_S + cruise_mps**2 / (2.0 * self._braking_mps2)
        line = target.x_m - self.start.x_m, target.y_m - self.start.y_m
        length_m = math.hypot(*line)
        if math.hypot(*left) <= reach_m or length_m == 0.0:
            share = min(1.0, reach_m / math.hypot(*left))
            return left[0] * share, left[1] * share
        along = line[0] / length_m, line[1] / length_m
        left_m = left[0] * along[0] + left[1] * along[1]
        aside_m = left[0] * along[1] - left[1] * along[0]  # how far the line is to the right
        # As far ahead on the line as it can reach; straight towards the line where it cannot.
        on_m = math.sqrt(max(0.0, reach_m**2 - aside_m**2))
        aside_m = max(-reach_m, min(reach_m, aside_m))
        on_m = min(on_m, left_m)
        return along[0] * on_m + along[1] * aside_m, along[1] * on_m - along[0] * aside_m
