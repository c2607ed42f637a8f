"""A drone in AirSim, Colosseum or Cosys-AirSim, or in whatever answers as they do."""

import asyncio
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.clock import Clock
from reasoned_explorer.geometry import Pose, bearing_between_rad, normalise_heading_rad
from reasoned_explorer.geometry.frames import is_finite
from reasoned_explorer.model import Fault, Leg, LegOutcome, PartError, SettingsError, View
from reasoned_explorer.vehicles.airsim.api import AirSimApi, Moment
from reasoned_explorer.vehicles.airsim.conventions import HomeFrame
from reasoned_explorer.vehicles.airsim.pace import Pace, pace_of
from reasoned_explorer.vehicles.airsim.rpc import Pending, RpcClient
from reasoned_explorer.vehicles.airsim.senses import Senses
from reasoned_explorer.vehicles.airsim.settings import DriverSettings
from reasoned_explorer.vehicles.control.legs import LegWatch
from reasoned_explorer.vehicles.looking import Content, turning_order
from reasoned_explorer.vehicles.profile import VehicleProfile
from reasoned_explorer.vehicles.safety.telemetry import Telemetry
from reasoned_explorer.vehicles.standing import check_stands
from reasoned_explorer.vehicles.vehicle import Vehicle

#: How long taking off and climbing may take on the server's time, seconds.
_START_LIMIT_S = 60.0
_CLIMB_MPS = 1.0
#: A leg may take so many times as long as it should, and some seconds.
_PATIENCE, _PATIENCE_S = 3.0, 10.0
#: Angles nearer than this are one.
_SAME_RAD = 1e-6


@dataclass(frozen=True, slots=True, eq=False)
class _Seen:
    """What one camera showed: where it really was, and its picture."""

    pose: Pose
    image: NDArray[np.uint8] | None
    heading_rad: float
    believed: Pose


class AirSimVehicle(Vehicle):
    """A drone that is flown over AirSim's wire.

    It takes off and rises to its profile's camera height, looks with the cameras that are there (or turns), flies
    straight legs, stops where something comes in between, and lands in the end. On a clock that is not real, the
    simulator's time is held while the agent thinks (`pace`).

    Args:
        profile: What the machine can do: how fast and how high it is told to fly.
        clock: The mission's.
        host: Of the simulator.
        port: Likewise.
        vehicle_name: As the simulator's settings have it; empty for its only one.
        home: Where in the world the vehicle started; the origin where no world is known.
        stands: Where it is to be when this starts it; None for anywhere.
        settings: How it flies and looks.
        content: Says what a camera's view really contains, for the simulated captioner of a world that both ends know.
    """

    def __init__(
        self,
        profile: VehicleProfile,
        *,
        clock: Clock,
        host: str = "127.0.0.1",
        port: int = 41451,
        vehicle_name: str = "",
        home: Pose | None = None,
        stands: Pose | None = None,
        settings: DriverSettings | None = None,
        content: Content | None = None,
    ) -> None:
        self._stands = stands
        self.profile, self.settings = profile, settings or DriverSettings()
        start = home or Pose(0.0, 0.0)
        self._clock, self._content = clock, content
        self._client = RpcClient(host, port, deadline_s=self.settings.deadline_s)
        self.api = AirSimApi(self._client, vehicle_name=vehicle_name, home=HomeFrame(start.x_m, start.y_m, start.z_m))
        self._pace: Pace = pace_of(clock, self.api)
        self._moment = Moment(0.0, start, 0.0, 0.0, landed=True)
        #: Which way each camera looks from straight ahead, radians, and its field of view.
        self._cameras: dict[str, tuple[float, float]] = {}
        self._legs = self._looks = 0
        self._is_up = self._is_linked = False
        self._senses = Senses(self.api, self.settings, clock)
        #: The last leg; after a cancelled `go_to` the part of it that was travelled.
        self.last_leg: Leg | None = None

    @property
    def pose(self) -> Pose:
        """Where the vehicle believed to be when it last moved or looked."""
        return self._moment.believed

    def telemetry(self) -> Telemetry:
        """Return what was told when the vehicle last moved, looked or was refreshed."""
        return self._senses.telemetry(self._moment)

    async def refresh(self) -> None:
        """Ask where the vehicle is, and what it knows of itself."""
        await self._catch_up(ranges=True)

    async def halt(self) -> None:
        """Hover, whatever it was doing."""
        if self._is_up:
            await self._pace.talk(self.api.hover)

    async def connect(self) -> None:
        """Find out where it is and which way the cameras look; take no control."""
        await self._pace.talk(self.api.confirm)
        self._is_linked = True
        await self._pace.begin()
        await self._catch_up()
        await self._pace.talk(self._find_cameras)

    async def start(self) -> None:
        """Connect, take control, arm, take off and rise to where the cameras are to be.

        Raises:
            PartError: If any of that does not come about.
        """
        api = self.api
        await self._pace.talk(api.confirm)
        await self._pace.talk(api.take_control)
        self._is_up = True
        await self._pace.begin()
        self._moment = await self._pace.talk(api.moment)
        check_stands("AirSim", self.pose, self._stands)
        if self._moment.landed:
            await self._finish(await self._pace.talk(api.take_off), "take off")
        height_m = self.profile.camera_height_m
        if abs(self.pose.z_m - height_m) > 0.01:
            climbing = await self._pace.talk(lambda: api.move_to_height(height_m, speed_mps=_CLIMB_MPS))
            await self._finish(climbing, f"reach a height of {height_m:g} m")
        await self._pace.talk(self._find_cameras)

    async def close(self) -> None:
        """Hover, land if that is wanted, give control back, hang up. Safe to call twice.

        Raises:
            PartError: If the vehicle may still be flying: the link is lost, or it does not land.
        """
        if self._is_linked and not self._is_up:
            self._is_linked = False
            await self._pace.end()
            await self._pace.talk(self._client.close)
        if not self._is_up:
            return
        self._is_up = False
        try:
            await self._pace.talk(self.api.hover)
            if self.settings.lands:
                await self._finish(await self._pace.talk(self.api.land), "land")
                await self._pace.talk(self.api.release)
            await self._pace.end()
        finally:
            await self._pace.talk(self._client.close)

    async def look(self, headings_rad: Sequence[float]) -> Sequence[View]:
        """Take one view in each heading, in that order; keys are (legs so far, looks since the last leg, index).

        Raises:
            SettingsError: If a heading is not finite.
            PartError: If the link fails or the cameras give nothing.
        """
        faults = [Fault(f"heading {heading}", "finite radians") for heading in headings_rad if not is_finite(heading)]
        if faults:
            raise SettingsError("look", faults)
        await self._catch_up()
        wanted = {index: normalise_heading_rad(heading) for index, heading in enumerate(headings_rad)}
        seen: dict[int, tuple[str, _Seen]] = {}
        turns = self._is_up and (not self.settings.aims or self.profile.turns_to_look)
        fitting = {index: name for index, heading in wanted.items() if (name := self._camera_towards(heading))}
        if fitting:
            shots = await self._pace.talk(lambda: self._shoot(tuple(fitting.values())))
            for index, shot in zip(fitting, shots, strict=True):
                seen[index] = fitting[index], shot
        first = self.settings.cameras[0]
        for index in turning_order(self.pose.heading_rad, {k: v for k, v in wanted.items() if k not in fitting}):
            if turns:
                await self._turn_to(wanted[index])
            seen[index] = first, await self._aimed(first, wanted[index])
        if self.profile.look_s > 0.0:
            await self._pace.until(None, self.profile.look_s)
            await self._see()
        looks, self._looks = self._looks, self._looks + 1
        return [self._view((self._legs, looks, index), *seen[index], wanted[index]) for index in sorted(seen)]

    async def go_to(self, target: Pose) -> Leg:
        """Fly straight to a point, at the height of the cameras, and face the target's heading.

        Cancelled on the way, the vehicle hovers where it is; `last_leg` tells what it travelled.

        Raises:
            SettingsError: If the target is not finite.
            PartError: If the link fails.
        """
        if not is_finite(target.x_m, target.y_m, target.heading_rad):
            raise SettingsError("go_to", [Fault(f"target {target}", "finite coordinates and heading")])
        self._legs, self._looks = self._legs + 1, 0
        true = await self._catch_up()
        aim = replace(target, z_m=self.profile.camera_height_m)
        # Asking makes the server forget what was run into before.
        await self._pace.talk(self.api.collision)
        settles_s = max(self.profile.settle_s, self._settle_s)
        watch = LegWatch(aim, self.settings, settles_s, self._clock.now_s(), self._moment)
        watch.see(self._moment, true)
        speed_mps = self.profile.speed_mps
        try:
            moving = await self._pace.talk(lambda: self.api.move_to(aim, speed_mps=speed_mps))
            self._senses.hear(listening=True)
            outcome, detail = await self._follow(moving, watch)
            self._senses.hear(listening=False)
            if outcome is LegOutcome.ARRIVED and self._settle_s > 0.0:
                await self._pace.until(None, self._settle_s)
                true = await self._see()
                watch.see(self._moment, true)
        except asyncio.CancelledError:
            await asyncio.shield(self._pace.talk(self.api.hover))
            self.last_leg = watch.leg(LegOutcome.STOPPED, "cancelled")
            raise
        except PartError as fault:
            self.last_leg = watch.leg(LegOutcome.FAULT, str(fault))
            raise
        finally:
            self._senses.hear(listening=False)
        self.last_leg = watch.leg(outcome, detail)
        return self.last_leg

    async def _follow(self, moving: Pending, watch: LegWatch) -> tuple[LegOutcome, str]:
        """Watch a leg to its end; whatever ends it, the vehicle hovers then."""
        due_s = watch.left_m / self.profile.speed_mps + 2.0 * math.pi / self.profile.turn_rate_radps
        limit_s = _PATIENCE * due_s + _PATIENCE_S + watch.settle_s
        while True:
            await self._pace.until(moving, self.settings.poll_s)
            true = await self._see()
            watch.see(self._moment, true)
            hit = await self._pace.talk(self.api.collision)
            ended: tuple[LegOutcome, str] | None = None
            if hit.collided and hit.t_s > watch.first.t_s:
                ended = LegOutcome.COLLISION, hit.name
            elif moving.answered:
                came_about = await self._pace.talk(lambda: self._client.outcome(moving))
                if watch.is_there(self._moment):
                    return LegOutcome.ARRIVED, ""
                how = "" if came_about is True else ", ended by the simulator"
                return LegOutcome.STUCK, f"{watch.left_m:.1f} m short of the target{how}"
            elif watch.has_stood_there:
                ended = LegOutcome.ARRIVED, ""
            elif watch.is_stuck:
                ended = LegOutcome.STUCK, "no progress"
            elif watch.elapsed_s > limit_s:
                ended = LegOutcome.STUCK, "not there in three times the time that it should take"
            if ended is not None:
                await self._pace.talk(self.api.hover)
                return ended

    @property
    def _settle_s(self) -> float:
        return self.profile.settle_s if self.settings.settle_s is None else self.settings.settle_s

    async def _catch_up(self, *, ranges: bool = False) -> Pose:
        """Have passed in the simulator what has passed on the mission's clock; return where the vehicle truly is."""
        await self._pace.catch_up()
        self._moment, true = await self._pace.talk(lambda: self._both(ranges=ranges))
        self._senses.hear(listening=False)
        return true

    async def _see(self) -> Pose:
        """Find out where the vehicle believes to be, charge the time since this was last done; return the truth."""
        moment, true = await self._pace.talk(lambda: self._both(ranges=self._senses.is_listening))
        elapsed_s = moment.t_s - self._moment.t_s if self._moment.t_s > 0.0 else 0.0
        self._moment = moment
        self._senses.hear(listening=self._senses.is_listening)
        if elapsed_s > 0.0:
            await self._pace.charge(elapsed_s)
        return true

    async def _both(self, *, ranges: bool) -> tuple[Moment, Pose]:
        await self._senses.read(ranges=ranges)
        return await self.api.moment(), await self.api.true_pose()

    async def _finish(self, pending: Pending, what: str) -> None:
        """Wait for a flight that must come about.

        Raises:
            PartError: If it does not.
        """
        # What was last heard may be from before a long thought.
        begun_s = (await self._pace.talk(self.api.moment)).t_s
        while not pending.answered:
            await self._pace.until(pending, self.settings.poll_s)
            await self._see()
            if self._moment.t_s - begun_s > _START_LIMIT_S:
                await self._pace.talk(self.api.hover)
                raise PartError("AirSim", f"the vehicle does not {what} within {_START_LIMIT_S:g} s")
        if await self._pace.talk(lambda: self._client.outcome(pending)) is not True:
            raise PartError("AirSim", f"the vehicle does not {what}")
        await self._see()

    # Looking.

    async def _find_cameras(self) -> None:
        body = await self.api.true_pose()
        for name in self.settings.cameras:
            camera = await self.api.camera(name)
            bearing_rad = bearing_between_rad(body.heading_rad, camera.pose.heading_rad)
            self._cameras[name] = bearing_rad, camera.fov_rad

    def _camera_towards(self, heading_rad: float) -> str | None:
        """Return the camera that looks in a heading; None where there is none, or the machine turns to look."""
        if self.profile.turns_to_look:
            return None
        wanted_rad = bearing_between_rad(self.pose.heading_rad, heading_rad)
        off = {name: abs(bearing_between_rad(wanted_rad, at_rad)) for name, (at_rad, _) in self._cameras.items()}
        nearest = min(off, key=off.__getitem__)
        return nearest if off[nearest] <= self.settings.fits_rad else None

    async def _turn_to(self, heading_rad: float) -> None:
        bearing_rad, _ = self._cameras[self.settings.cameras[0]]
        body_rad = normalise_heading_rad(heading_rad - bearing_rad)
        await self._finish(await self._pace.talk(lambda: self.api.turn_to(body_rad)), "turn to look")

    async def _aimed(self, name: str, heading_rad: float) -> _Seen:
        """Look with one camera, aimed at a heading where it may be, and ahead again afterwards."""
        if not self.settings.aims or self.profile.turns_to_look:
            return (await self._pace.talk(lambda: self._shoot((name,))))[0]
        wanted_rad = bearing_between_rad(self.pose.heading_rad, heading_rad)

        async def aim_and_shoot() -> _Seen:
            await self.api.aim(name, wanted_rad)
            try:
                return (await self._shoot((name,)))[0]
            finally:
                await self.api.aim(name, self._cameras[name][0])

        return replace(await self._pace.talk(aim_and_shoot), heading_rad=heading_rad)

    async def _shoot(self, names: Sequence[str]) -> list[_Seen]:
        """Take pictures, or only find out where they would be taken."""
        taken: list[tuple[Pose, NDArray[np.uint8] | None]]
        if self.settings.pictures:
            taken = [(shot.pose, shot.image) for shot in await self.api.shots(names)]
        else:
            taken = [((await self.api.camera(name)).pose, None) for name in names]
        moment = await self.api.moment()
        self._moment = replace(moment, t_s=self._moment.t_s)
        believed = moment.believed
        return [
            _Seen(pose, image, normalise_heading_rad(believed.heading_rad + self._cameras[name][0]), believed)
            for name, (pose, image) in zip(names, taken, strict=True)
        ]

    def _view(self, key: tuple[int, int, int], name: str, seen: _Seen, wanted_rad: float) -> View:
        camera = self.profile.camera
        fov_rad = self._cameras[name][1]
        if abs(fov_rad - camera.horizontal_fov_rad) > _SAME_RAD:
            camera = replace(camera, horizontal_fov_rad=fov_rad)
        content = None if self._content is None else self._content(seen.pose, camera)
        # A camera that looks where it should looks there exactly: angles on the wire are rounded.
        exact = abs(bearing_between_rad(seen.heading_rad, wanted_rad)) <= _SAME_RAD
        heading_rad = wanted_rad if exact else seen.heading_rad
        return View(key, seen.believed.facing(heading_rad), camera, seen.image, content)
