"""What a machine behind MAVLink is told and asked while the driver steers: aims, turns, rising and coming to rest."""

import math
from collections.abc import Callable
from dataclasses import replace

from reasoned_explorer.geometry import Pose, bearing_between_rad
from reasoned_explorer.model import PartError
from reasoned_explorer.vehicles.airsim.conventions import HomeFrame
from reasoned_explorer.vehicles.mavlink.approach import Approach
from reasoned_explorer.vehicles.mavlink.autopilot import PART, Autopilot
from reasoned_explorer.vehicles.mavlink.pace import Moment, Pace
from reasoned_explorer.vehicles.mavlink.setpoints import Setpoint, standing
from reasoned_explorer.vehicles.mavlink.settings import DriverSettings
from reasoned_explorer.vehicles.profile import VehicleProfile

_TAKEOFF = 22
#: How long rising, landing and turning may take, seconds.
_RISE_S, _LAND_S, _TURN_S = 60.0, 120.0, 30.0
#: So near its height it has risen; so near the ground it stands on it, where nobody says, metres.
_HEIGHT_M, _GROUND_M = 0.2, 0.3


class Manoeuvres:
    """Has one machine move and stand, and knows where it last was.

    Args:
        autopilot: Whom to tell.
        pace: How time passes.
        frame: Where positions on the wire count from.
        profile: What the machine can do.
        settings: How it moves.
        start: Where it is taken to be before anything is heard.
    """

    def __init__(
        self,
        autopilot: Autopilot,
        pace: Pace,
        frame: HomeFrame,
        *,
        profile: VehicleProfile,
        settings: DriverSettings,
        start: Pose,
    ) -> None:
        self._autopilot, self._pace, self._frame = autopilot, pace, frame
        self._profile, self._settings = profile, settings
        #: Where it was when it last moved or looked.
        self.moment = Moment(0.0, start, start, 0.0)

    @property
    def pose(self) -> Pose:
        """Where the autopilot believed the vehicle to be then."""
        return self.moment.believed

    @property
    def stands_on_ground(self) -> bool:
        """Whether it stands on the ground."""
        if self.moment.is_busy is None and self._autopilot.telemetry.is_landed is not None:
            return self._autopilot.telemetry.is_landed
        return self.pose.z_m - self._frame.z_m < _GROUND_M and not self.moment.is_busy

    def catch(self) -> None:
        """Take in where the vehicle is, as it was last told."""
        self.moment = self._pace.moment()

    async def see(self) -> None:
        """Find out where the vehicle is; charge the time since this was last done."""
        before_s = self.moment.t_s
        self.catch()
        if self.moment.t_s > before_s:
            await self._pace.charge(self.moment.t_s - before_s)

    async def aim(self, setpoint: Setpoint) -> None:
        """Have the autopilot go somewhere."""

        async def send() -> None:
            self._autopilot.aim(setpoint)

        await self._pace.talk(send)

    async def go(self, pose: Pose, *, turns: bool) -> None:
        """Have the machine go to a pose, or to its place alone."""
        await self.aim(self._setpoint(pose, turns=turns))

    async def lead(self, approach: Approach) -> None:
        """Have the machine go on towards a target for a moment, or near it to the target."""
        if not approach.is_over:
            setpoint = approach.setpoint(self.pose)
            await self.aim(setpoint or self._setpoint(approach.target, turns=self._profile.flies))

    async def stand(self) -> None:
        """Have it stay where it is: PX4 holds a place, ArduPilot is told to stand."""
        is_px4 = self._autopilot.flavour.is_px4
        await self.aim(self._setpoint(self.pose, turns=False) if is_px4 else standing(flies=self._profile.flies))

    async def rise(self) -> None:
        """Rise to where the camera is to be.

        Raises:
            PartError: If that does not come about.
        """
        height_m, autopilot = self._profile.camera_height_m, self._autopilot
        if self.stands_on_ground and not autopilot.flavour.is_px4:
            above_home_m = height_m - self._frame.z_m
            await self._pace.talk(lambda: autopilot.command(_TAKEOFF, *(0.0,) * 6, above_home_m))
        else:
            await self.go(replace(self.pose, z_m=height_m), turns=False)
        await self._until(
            lambda: abs(self.pose.z_m - height_m) < _HEIGHT_M, _RISE_S, f"reach a height of {height_m:g} m"
        )
        await self.stand()

    async def turn_to(self, heading_rad: float) -> None:
        """Turn in place.

        Raises:
            PartError: If it does not come about.
        """
        if abs(bearing_between_rad(self.pose.heading_rad, heading_rad)) <= 0.5 * self._settings.facing_rad:
            return
        here = self._setpoint(self.pose.facing(heading_rad), turns=True)
        await self.aim(here if self._profile.flies else Setpoint(yaw_rad=heading_rad))

        def faces() -> bool:
            off_rad = abs(bearing_between_rad(self.pose.heading_rad, heading_rad))
            return off_rad <= self._settings.facing_rad

        await self._until(faces, _TURN_S, "turn")
        await self.stand()

    async def leave_safe(self) -> None:
        """Stand, land if that is wanted, switch the motors off.

        Raises:
            PartError: If the vehicle may still be moving.
        """
        autopilot = self._autopilot
        await self.stand()
        if not self._profile.flies:
            await self._pace.talk(autopilot.disarm)
        elif self._settings.lands:
            autopilot.allow("LAND")
            await self._pace.talk(lambda: autopilot.set_mode("LAND"))
            await self._until(lambda: self.stands_on_ground or not autopilot.is_armed, _LAND_S, "land")
            await self._pace.talk(autopilot.disarm)
        elif autopilot.flavour.is_px4:
            # Its guided mode ends with the setpoints.
            hold = autopilot.flavour.hold
            autopilot.allow(hold)
            await self._pace.talk(lambda: autopilot.set_mode(hold))

    async def _until(self, holds: Callable[[], bool], limit_s: float, what: str) -> None:
        """Let time pass until something holds, or a simulator says that the motion is over.

        Raises:
            PartError: If that does not come about, the link is lost or somebody else has taken over.
        """
        begun_s = self._pace.moment().t_s  # what was last heard may be from before a long thought
        while True:
            await self._pace.until_idle(self._settings.poll_s)
            await self.see()
            if holds() and not self.moment.is_busy:
                return
            self._autopilot.check()
            if self.moment.t_s - begun_s > limit_s:
                raise PartError(PART, f"the vehicle does not {what} within {limit_s:g} s")

    def _setpoint(self, pose: Pose, *, turns: bool) -> Setpoint:
        ned_m = self._frame.ned_m(pose.x_m, pose.y_m, pose.z_m)
        return Setpoint(*ned_m, pose.heading_rad if turns else math.nan)
