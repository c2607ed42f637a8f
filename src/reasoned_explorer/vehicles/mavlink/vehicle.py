"""A drone or a rover behind MAVLink, steered by ArduPilot or PX4."""

import asyncio
import contextlib
import math
from collections.abc import Sequence
from dataclasses import replace

from reasoned_explorer.clock import Clock
from reasoned_explorer.geometry import Pose, bearing_between_rad, normalise_heading_rad
from reasoned_explorer.geometry.frames import is_finite
from reasoned_explorer.model import Fault, Leg, LegOutcome, PartError, SettingsError, View
from reasoned_explorer.vehicles.airsim.conventions import HomeFrame
from reasoned_explorer.vehicles.control.legs import LegWatch
from reasoned_explorer.vehicles.looking import Content, close_camera, open_camera, picture_age_s, turning_order
from reasoned_explorer.vehicles.mavlink.address import Address
from reasoned_explorer.vehicles.mavlink.approach import RENEW_S, Approach, Lapse
from reasoned_explorer.vehicles.mavlink.autopilot import PART, Autopilot
from reasoned_explorer.vehicles.mavlink.endings import crash_told, ending
from reasoned_explorer.vehicles.mavlink.manoeuvres import Manoeuvres
from reasoned_explorer.vehicles.mavlink.news import news
from reasoned_explorer.vehicles.mavlink.pace import Pace, pace_of
from reasoned_explorer.vehicles.mavlink.settings import DriverSettings
from reasoned_explorer.vehicles.mavlink.speed import Speed
from reasoned_explorer.vehicles.mavlink.telemetry import Battery, PositionQuality
from reasoned_explorer.vehicles.mavlink.views import PictureSource
from reasoned_explorer.vehicles.profile import VehicleProfile
from reasoned_explorer.vehicles.safety.telemetry import Telemetry
from reasoned_explorer.vehicles.standing import check_stands
from reasoned_explorer.vehicles.vehicle import Vehicle

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
        stands: Where it is to be when it is started; None for anywhere.
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
        stands: Pose | None = None,
        settings: DriverSettings | None = None,
        camera: PictureSource | None = None,
        content: Content | None = None,
    ) -> None:
        self.profile, self.settings, self._stands = profile, settings or DriverSettings(), stands
        start = home or Pose(0.0, 0.0)
        is_local = self.settings.origin is None
        self._frame = HomeFrame(start.x_m, start.y_m, start.z_m) if is_local else HomeFrame()
        self._clock, self._camera, self._content = clock, camera, content
        self.autopilot = Autopilot(Address.read(address), self.settings)
        self._pace: Pace = pace_of(clock, self.autopilot, self._frame)
        self._body = Manoeuvres(
            self.autopilot, self._pace, self._frame, profile=profile, settings=self.settings, start=start
        )
        self._legs = self._looks = 0
        self._is_connected = self._is_up = self._is_paced = False
        self._speed, self._lapse = Speed(self.autopilot), Lapse(self.autopilot)
        #: The last leg; after a cancelled or failed `go_to` the part of it that was travelled.
        self.last_leg: Leg | None = None

    # What it says of itself, for lists before a start and for whoever watches over it.

    @property
    def pose(self) -> Pose:
        """Where the autopilot believed it to be when it last moved or looked; a rover's height is its camera's."""
        return self._at_height(self._body.pose)

    def _at_height(self, pose: Pose) -> Pose:
        return pose if self.profile.flies else replace(pose, z_m=self.profile.camera_height_m)

    @property
    def battery(self) -> Battery:
        """What is left of its battery, as last told."""
        return self.autopilot.telemetry.battery

    def telemetry(self) -> Telemetry:
        """Return what a guard is told: what is known now, also on the way."""
        moment = self._pace.moment() if self._has_moment else self._body.moment
        told = news(self.autopilot, moment, lived=self._pace.is_lived)
        return replace(told, pose=self._at_height(told.pose), picture_age_s=picture_age_s(self._camera))

    @property
    def _has_moment(self) -> bool:
        if self._pace.is_lived:
            return self._is_connected and self.autopilot.telemetry.place_boot_s is not None
        return self._is_paced

    async def refresh(self) -> None:
        """Find out where the vehicle is, and that it is heard.

        Raises:
            PartError: If it is not.
        """
        if not self._is_connected:
            raise PartError(PART, "the vehicle is not connected")
        if lost := self.autopilot.lost():
            raise PartError(PART, lost)
        if self._pace.is_lived:
            await self._pace.talk(self.autopilot.hear_again)
        await self._catch_up()

    async def halt(self) -> None:
        """Stand, whatever it was doing. What somebody else has taken over is left to them.

        Raises:
            PartError: If the vehicle is not heard afterwards: what it does is then up to its own failsafe.
        """
        if self._is_up and not self.autopilot.taken:
            self._body.catch()
            await self._body.stand()
            await self.refresh()

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
            is_what, other = ("flies", "drone") if self.autopilot.flavour.flies else ("drives", "go1")
            reason = f"the autopilot's machine {is_what}, and {self.profile.name} does not"
            raise PartError(PART, f"{reason}; name a profile that does before the address: {other}@mavlink:…")
        await self._begin_pace()
        self._body.catch()
        check_stands(PART, self.pose, self._stands)
        self._is_up = True
        await self._pace.talk(self.autopilot.take_control)
        await self._pace.talk(lambda: self._speed.take(self.profile.speed_mps))
        await self._pace.talk(self._lapse.take)
        if self.profile.flies:
            await self._body.rise()

    async def _catch_up(self, *, looks: bool = False) -> None:
        """Have as much time passed for the autopilot as on the mission's clock, and find out where the vehicle is."""
        if not self._is_paced:
            await self._begin_pace()
        await self._pace.catch_up(looks=looks)
        self._body.catch()

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
                await self._body.leave_safe()
            if was_up:
                await self._pace.talk(self._speed.give_back)
                await self._pace.talk(self._lapse.give_back)
            if self._is_paced:
                self._is_paced = False
                await self._pace.end()
        finally:
            close_camera(self._camera)
            await self._pace.talk(self.autopilot.close)

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
        await self._catch_up(looks=True)
        looks, self._looks = self._looks, self._looks + 1
        taken: dict[int, View] = {}
        for index in self._order(headings_rad):
            heading_rad = normalise_heading_rad(headings_rad[index])
            if self.profile.turns_to_look and self._is_up:
                await self._body.turn_to(heading_rad)
            if self.profile.turns_to_look:
                heading_rad = self.pose.heading_rad
            taken[index] = await self._view((self._legs, looks, index), heading_rad)
        if self.profile.look_s > 0.0:
            await self._pace.wait(self.profile.look_s)
            await self._body.see()
        return [taken[index] for index in range(len(headings_rad))]

    async def _view(self, key: tuple[int, int, int], heading_rad: float) -> View:
        believed, true, source = self.pose, self._body.moment.true, self._camera
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
        await self._catch_up()
        aim = replace(target, z_m=self.profile.camera_height_m if self.profile.flies else self._body.pose.z_m)
        watch = LegWatch(
            aim, self.settings, max(self.profile.settle_s, self._settle_s), self._clock.now_s(), self._body.moment
        )
        self._note(watch)
        try:
            outcome, detail = await self._travel(aim, watch)
        except asyncio.CancelledError:
            # As it is now, not as when it was last looked after: a place that is held must be where it is.
            self._body.catch()
            self._note(watch)
            with contextlib.suppress(PartError):
                await asyncio.shield(self._body.stand())
            self.last_leg = watch.leg(LegOutcome.STOPPED, "cancelled")
            raise
        except PartError as error:
            self.last_leg = watch.leg(LegOutcome.STOPPED, error.reason)
            raise
        self.last_leg = watch.leg(outcome, detail)
        return self.last_leg

    async def _travel(self, aim: Pose, watch: LegWatch) -> tuple[LegOutcome, str]:
        texts = self.autopilot.telemetry.texts_seen
        approach = Approach(self._body.pose, aim, self.profile) if self._lapse.is_on else None
        if approach is None:
            await self._body.go(aim, turns=self.profile.flies)
        else:
            await self._body.lead(approach)
        outcome, detail = await self._follow(watch, texts, approach)
        if self.autopilot.taken:
            return LegOutcome.STOPPED, self.autopilot.taken
        await self._body.stand()
        if outcome is not LegOutcome.ARRIVED:
            return outcome, detail
        if not self.profile.flies:
            await self._body.turn_to(aim.heading_rad)
            self._note(watch)
        if self._settle_s > 0.0:
            await self._pace.wait(self._settle_s)
            await self._body.see()
            self._note(watch)
        return outcome, detail

    def _note(self, watch: LegWatch) -> None:
        watch.see(self._body.moment, self._body.moment.true)

    async def _follow(self, watch: LegWatch, texts: int, approach: Approach | None) -> tuple[LegOutcome, str]:
        """Watch a leg to its end, and lead a machine that is led.

        Raises:
            PartError: If the link is lost on the way.
        """
        due_s = watch.left_m / self.profile.speed_mps + 2.0 * math.pi / self.profile.turn_rate_radps
        limit_s = _PATIENCE * due_s + _PATIENCE_S + watch.settle_s
        hits, autopilot = self._body.moment.hits, self.autopilot
        while True:
            await self._pace.until_idle(
                self.settings.poll_s if approach is None else min(self.settings.poll_s, RENEW_S)
            )
            await self._body.see()
            self._note(watch)
            moment = self._body.moment
            if moment.hits != hits:
                return LegOutcome.COLLISION, moment.hit
            if crash := crash_told(autopilot.telemetry, texts):
                return LegOutcome.COLLISION, crash
            if autopilot.taken:
                return LegOutcome.STOPPED, autopilot.taken
            if lost := autopilot.lost():
                raise PartError(PART, lost)
            if approach is not None and not approach.is_over:
                await self._body.lead(approach)
                moment = replace(moment, is_busy=None)  # where it stops unless it is told more is not the end
            if ended := ending(watch, moment, limit_s=limit_s, turns_later=not self.profile.flies):
                return ended

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
