"""A drone or a rover behind MAVLink, steered by ArduPilot or PX4."""

import asyncio
import contextlib
import math
from collections.abc import Callable, Sequence
from dataclasses import replace

from reasoned_explorer.clock import Clock
from reasoned_explorer.geometry import Pose, bearing_between_rad, normalise_heading_rad
from reasoned_explorer.geometry.frames import is_finite
from reasoned_explorer.model import Fault, Leg, LegOutcome, PartError, SettingsError, View
from reasoned_explorer.vehicles.airsim.conventions import HomeFrame
from reasoned_explorer.vehicles.control.legs import LegWatch
from reasoned_explorer.vehicles.looking import Content, close_camera, open_camera, picture_age_s, turning_order
from reasoned_explorer.vehicles.mavlink.address import Address
from reasoned_explorer.vehicles.mavlink.autopilot import PART, Autopilot
from reasoned_explorer.vehicles.mavlink.endings import crash_told, ending
from reasoned_explorer.vehicles.mavlink.pace import Moment, Pace, pace_of
from reasoned_explorer.vehicles.mavlink.setpoints import Setpoint
from reasoned_explorer.vehicles.mavlink.settings import DriverSettings
from reasoned_explorer.vehicles.mavlink.speed import Speed
from reasoned_explorer.vehicles.mavlink.telemetry import Battery, PositionQuality
from reasoned_explorer.vehicles.mavlink.views import PictureSource
from reasoned_explorer.vehicles.profile import VehicleProfile
from reasoned_explorer.vehicles.safety.telemetry import Telemetry
from reasoned_explorer.vehicles.vehicle import Vehicle

_TAKEOFF = 22
#: How long rising, landing and turning may take, seconds.
_RISE_S, _LAND_S, _TURN_S = 60.0, 120.0, 30.0
#: So near its height it has risen; so near the ground it stands on it, where nobody says, metres.
_HEIGHT_M, _GROUND_M = 0.2, 0.3
#: A leg may take so many times as long as it should, and some seconds.
_PATIENCE, _PATIENCE_S = 3.0, 10.0


class MavlinkVehicle(Vehicle):
    """A drone or a rover whose autopilot is told where to go.

    The autopilot flies; this driver never fights it. Where it leaves the guided mode (a failsafe, a pilot), or its
    motors are switched off, a leg ends as stopped, no setpoint is sent any more, and further commands are refused.

    Args:
        profile: What the machine can do: how fast and how high it is told to go.
        clock: The mission's. One that is not real needs a simulator that can be held: the served autopilot.
        address: Where the autopilot is reached (`Address.read`).
        home: Where in the world the origin of the autopilot's local frame lies: where it was switched on. Not read
            where positions are geodetic.
        settings: How it moves and looks.
        camera: Takes the pictures; None for views without.
        content: Says what a view contains, for the simulated captioner of a world that both ends know.
    """

    def __init__(
        self,
        profile: VehicleProfile,
        *,
        clock: Clock,
        address: str = "udpin:127.0.0.1:14550",
        home: Pose | None = None,
        settings: DriverSettings | None = None,
        camera: PictureSource | None = None,
        content: Content | None = None,
    ) -> None:
        self.profile, self.settings = profile, settings or DriverSettings()
        start = home or Pose(0.0, 0.0)
        is_local = self.settings.origin is None
        self._frame = HomeFrame(start.x_m, start.y_m, start.z_m) if is_local else HomeFrame()
        self._clock, self._camera, self._content = clock, camera, content
        self.autopilot = Autopilot(Address.read(address), self.settings)
        self._pace: Pace = pace_of(clock, self.autopilot, self._frame)
        self._moment = Moment(0.0, start, start, 0.0)
        self._legs = self._looks = 0
        self._is_connected = self._is_up = self._is_paced = False
        self._speed = Speed(self.autopilot)
        #: The last leg; after a cancelled or failed `go_to` the part of it that was travelled.
        self.last_leg: Leg | None = None

    # What it says of itself, for lists before a start and for whoever watches over it.

    @property
    def pose(self) -> Pose:
        """Where the autopilot believed the vehicle to be when it last moved or looked."""
        return self._moment.believed

    @property
    def battery(self) -> Battery:
        """What is left of its battery, as last told."""
        return self.autopilot.telemetry.battery

    def telemetry(self) -> Telemetry:
        """Return what a guard is told; a lost link and a poor position are seen to by driver and autopilot."""
        age_s = picture_age_s(self._camera)
        return Telemetry(self.pose, t_s=self._moment.t_s, battery=self.battery.remaining, picture_age_s=age_s)

    @property
    def position_quality(self) -> PositionQuality:
        """How good the autopilot's position is, as last told."""
        return self.autopilot.telemetry.position

    @property
    def mode(self) -> str:
        """The autopilot's mode, as last told; empty before anything was."""
        heard = self.autopilot.telemetry.heartbeat
        return "" if heard is None else heard.mode

    @property
    def is_armed(self) -> bool:
        """Whether its motors are on."""
        return self.autopilot.is_armed

    @property
    def texts(self) -> tuple[str, ...]:
        """What the autopilot last said to be wrong, oldest first."""
        return self.autopilot.telemetry.texts

    # Start and end.

    async def connect(self) -> None:
        """Only listen: wait for the autopilot and its position. Nothing moves.

        Raises:
            PartError: If nobody is there.
        """
        if not self._is_connected:
            self._is_connected = True
            open_camera(self._camera)
            await self._pace.talk(self.autopilot.connect)

    async def start(self) -> None:
        """Connect, take the guided mode, arm (or wait for a person who does), rise to where the camera is to be.

        Raises:
            PartError: If any of that does not come about.
        """
        try:
            await self._start()
        except BaseException:
            # Heartbeats that went on would keep the autopilot's failsafe from acting.
            with contextlib.suppress(PartError):
                await self.close()
            raise

    async def _start(self) -> None:
        await self.connect()
        if self.autopilot.flavour.flies != self.profile.flies:
            is_what = "flies" if self.autopilot.flavour.flies else "drives"
            raise PartError(PART, f"the autopilot's machine {is_what}, and {self.profile.name} does not")
        await self._begin_pace()
        self._moment = await self._pace.moment()
        self._is_up = True
        await self._pace.talk(self.autopilot.take_control)
        await self._pace.talk(lambda: self._speed.take(self.profile.speed_mps))
        if self.profile.flies:
            await self._rise()

    async def _begin_pace(self) -> None:
        await self._pace.begin()
        self._is_paced = True

    async def close(self) -> None:
        """Stand, land if that is wanted, switch the motors off, hang up. Safe to call twice.

        What somebody else has taken over is left to them.

        Raises:
            PartError: If the vehicle may still be moving: the link is lost, or it does not land.
        """
        if not self._is_connected:
            return
        was_up, self._is_up, self._is_connected = self._is_up, False, False
        try:
            if was_up and self.autopilot.is_armed and not self.autopilot.taken:
                self.autopilot.check()
                await self._leave_safe()
            if was_up:
                await self._pace.talk(self._speed.give_back)
            if self._is_paced:
                self._is_paced = False
                await self._pace.end()
        finally:
            close_camera(self._camera)
            await self._pace.talk(self.autopilot.close)

    async def _leave_safe(self) -> None:
        autopilot = self.autopilot
        await self._aim(self._here())
        if not self.profile.flies:
            await self._pace.talk(autopilot.disarm)
        elif self.settings.lands:
            autopilot.allow("LAND")
            await self._pace.talk(lambda: autopilot.set_mode("LAND"))
            await self._until(lambda: self._stands_on_ground() or not autopilot.is_armed, _LAND_S, "land")
            await self._pace.talk(autopilot.disarm)
        elif autopilot.flavour.is_px4:
            # Its guided mode ends with the setpoints.
            hold = autopilot.flavour.hold
            autopilot.allow(hold)
            await self._pace.talk(lambda: autopilot.set_mode(hold))

    async def _rise(self) -> None:
        height_m, autopilot = self.profile.camera_height_m, self.autopilot
        if self._stands_on_ground() and not autopilot.flavour.is_px4:
            above_home_m = height_m - self._frame.z_m
            await self._pace.talk(lambda: autopilot.command(_TAKEOFF, *(0.0,) * 6, above_home_m))
        else:
            await self._aim(self._setpoint(replace(self.pose, z_m=height_m), turns=False))
        await self._until(
            lambda: abs(self.pose.z_m - height_m) < _HEIGHT_M, _RISE_S, f"reach a height of {height_m:g} m"
        )
        await self._aim(self._here())

    def _stands_on_ground(self) -> bool:
        if self._moment.is_busy is None and self.autopilot.telemetry.is_landed is not None:
            return self.autopilot.telemetry.is_landed
        return self.pose.z_m - self._frame.z_m < _GROUND_M and not self._moment.is_busy

    # Looking.

    async def look(self, headings_rad: Sequence[float]) -> Sequence[View]:
        """Take one view in each heading, in that order; keys are (legs so far, looks since the last leg, index).

        Only connected, it does not move: one that turns to look sees what is ahead.

        Raises:
            SettingsError: If a heading is not finite.
            PartError: If the link or the camera fails, or the autopilot does not listen any more.
        """
        faults = [Fault(f"heading {heading}", "finite radians") for heading in headings_rad if not is_finite(heading)]
        if faults:
            raise SettingsError("look", faults)
        if self._is_up or not self._is_connected:
            self._check()
        if not self._is_paced:
            await self._begin_pace()
        await self._pace.catch_up(looks=True)
        self._moment = await self._pace.moment()
        looks, self._looks = self._looks, self._looks + 1
        taken: dict[int, View] = {}
        for index in self._order(headings_rad):
            heading_rad = normalise_heading_rad(headings_rad[index])
            if self.profile.turns_to_look and self._is_up:
                await self._turn_to(heading_rad)
            if self.profile.turns_to_look:
                heading_rad = self.pose.heading_rad
            taken[index] = await self._view((self._legs, looks, index), heading_rad)
        if self.profile.look_s > 0.0:
            await self._pace.wait(self.profile.look_s)
            await self._see()
        return [taken[index] for index in range(len(headings_rad))]

    async def _view(self, key: tuple[int, int, int], heading_rad: float) -> View:
        believed, true, source = self.pose, self._moment.true, self._camera
        bearing_rad = bearing_between_rad(believed.heading_rad, heading_rad)
        image = None if source is None else await self._pace.talk(lambda: source.take(bearing_rad))
        height_m = self.profile.camera_height_m
        content = None
        if self._content is not None:
            sees_from = replace(true, z_m=height_m).facing(true.heading_rad + bearing_rad)
            content = self._content(sees_from, self.profile.camera)
        return View(key, replace(believed, z_m=height_m).facing(heading_rad), self.profile.camera, image, content)

    def _order(self, headings_rad: Sequence[float]) -> list[int]:
        if self.profile.turns_to_look:
            return turning_order(self.pose.heading_rad, dict(enumerate(headings_rad)))
        return list(range(len(headings_rad)))

    # Moving.

    async def go_to(self, target: Pose) -> Leg:
        """Go straight to a point, at the height of the camera, and face the target's heading.

        Cancelled on the way, the vehicle stands where it is; `last_leg` tells what it travelled.

        Raises:
            SettingsError: If the target is not finite.
            PartError: If the link is lost, or the autopilot does not listen any more.
        """
        if not is_finite(target.x_m, target.y_m, target.heading_rad):
            raise SettingsError("go_to", [Fault(f"target {target}", "finite coordinates and heading")])
        self._check()
        self._legs, self._looks = self._legs + 1, 0
        await self._pace.catch_up()
        self._moment = await self._pace.moment()
        aim = replace(target, z_m=self.profile.camera_height_m if self.profile.flies else self.pose.z_m)
        watch = LegWatch(
            aim, self.settings, max(self.profile.settle_s, self._settle_s), self._clock.now_s(), self._moment
        )
        watch.see(self._moment, self._moment.true)
        try:
            outcome, detail = await self._travel(aim, watch)
        except asyncio.CancelledError:
            with contextlib.suppress(PartError):
                await asyncio.shield(self._aim(self._here()))
            self.last_leg = watch.leg(LegOutcome.STOPPED, "cancelled")
            raise
        except PartError as error:
            self.last_leg = watch.leg(LegOutcome.STOPPED, error.reason)
            raise
        self.last_leg = watch.leg(outcome, detail)
        return self.last_leg

    async def _travel(self, aim: Pose, watch: LegWatch) -> tuple[LegOutcome, str]:
        texts = self.autopilot.telemetry.texts_seen
        await self._aim(self._setpoint(aim, turns=self.profile.flies))
        outcome, detail = await self._follow(watch, texts)
        if self.autopilot.taken:
            return LegOutcome.STOPPED, self.autopilot.taken
        await self._aim(self._here())
        if outcome is not LegOutcome.ARRIVED:
            return outcome, detail
        if not self.profile.flies:
            await self._turn_to(aim.heading_rad)
            watch.see(self._moment, self._moment.true)
        if self._settle_s > 0.0:
            await self._pace.wait(self._settle_s)
            await self._see()
            watch.see(self._moment, self._moment.true)
        return outcome, detail

    async def _follow(self, watch: LegWatch, texts: int) -> tuple[LegOutcome, str]:
        """Watch a leg to its end.

        Raises:
            PartError: If the link is lost on the way.
        """
        due_s = watch.left_m / self.profile.speed_mps + 2.0 * math.pi / self.profile.turn_rate_radps
        limit_s = _PATIENCE * due_s + _PATIENCE_S + watch.settle_s
        hits, autopilot = self._moment.hits, self.autopilot
        while True:
            await self._pace.until_idle(self.settings.poll_s)
            await self._see()
            moment = self._moment
            watch.see(moment, moment.true)
            if moment.hits != hits:
                return LegOutcome.COLLISION, moment.hit
            if crash := crash_told(autopilot.telemetry, texts):
                return LegOutcome.COLLISION, crash
            if autopilot.taken:
                return LegOutcome.STOPPED, autopilot.taken
            if lost := autopilot.lost():
                raise PartError(PART, lost)
            if ended := ending(watch, moment, limit_s=limit_s, turns_later=not self.profile.flies):
                return ended

    async def _turn_to(self, heading_rad: float) -> None:
        """Turn in place.

        Raises:
            PartError: If it does not come about.
        """
        if abs(bearing_between_rad(self.pose.heading_rad, heading_rad)) <= 0.5 * self.settings.facing_rad:
            return
        here = self._setpoint(self.pose.facing(heading_rad), turns=True)
        await self._aim(here if self.profile.flies else Setpoint(yaw_rad=heading_rad))

        def faces() -> bool:
            off_rad = abs(bearing_between_rad(self.pose.heading_rad, heading_rad))
            return off_rad <= self.settings.facing_rad

        await self._until(faces, _TURN_S, "turn")
        await self._aim(self._here())

    async def _until(self, holds: Callable[[], bool], limit_s: float, what: str) -> None:
        """Let time pass until something holds, or a simulator says that the motion is over.

        Raises:
            PartError: If that does not come about, the link is lost or somebody else has taken over.
        """
        begun_s = self._moment.t_s
        while True:
            await self._pace.until_idle(self.settings.poll_s)
            await self._see()
            if holds() and not self._moment.is_busy:
                return
            self.autopilot.check()
            if self._moment.t_s - begun_s > limit_s:
                raise PartError(PART, f"the vehicle does not {what} within {limit_s:g} s")

    async def _see(self) -> None:
        """Find out where the vehicle is; charge the time since this was last done."""
        before_s, self._moment = self._moment.t_s, await self._pace.moment()
        if self._moment.t_s > before_s:
            await self._pace.charge(self._moment.t_s - before_s)

    async def _aim(self, setpoint: Setpoint) -> None:
        async def send() -> None:
            self.autopilot.aim(setpoint)

        await self._pace.talk(send)

    def _setpoint(self, pose: Pose, *, turns: bool) -> Setpoint:
        ned_m = self._frame.ned_m(pose.x_m, pose.y_m, pose.z_m)
        return Setpoint(*ned_m, pose.heading_rad if turns else math.nan)

    def _here(self) -> Setpoint:
        """Return the setpoint that stays: PX4 holds a place, ArduPilot a velocity of nothing."""
        return self._setpoint(self.pose, turns=False) if self.autopilot.flavour.is_px4 else Setpoint()

    def _check(self) -> None:
        """See that there is somebody to command.

        Raises:
            PartError: If the vehicle was not started, the link is lost or the autopilot does not listen any more.
        """
        if not self._is_up:
            raise PartError(PART, "the vehicle is not started")
        self.autopilot.check()

    @property
    def _settle_s(self) -> float:
        return self.profile.settle_s if self.settings.settle_s is None else self.settings.settle_s
