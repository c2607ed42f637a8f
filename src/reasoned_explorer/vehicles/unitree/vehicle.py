"""Unitree's quadrupeds as vehicles: they turn to look, walk straight legs, and stand at the end of each."""

import asyncio
from collections.abc import Callable, Coroutine, Sequence
from typing import Any, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.clock import Clock
from reasoned_explorer.clock.live_thread import Stopwatch, begin_live
from reasoned_explorer.geometry import Pose, normalise_heading_rad
from reasoned_explorer.geometry.frames import is_finite
from reasoned_explorer.model import Fault, Leg, LegOutcome, PartError, SettingsError, View
from reasoned_explorer.vehicles.looking import Content, close_camera, open_camera, picture_age_s, turning_order
from reasoned_explorer.vehicles.profile import VehicleProfile
from reasoned_explorer.vehicles.safety.telemetry import Telemetry
from reasoned_explorer.vehicles.unitree.go1_robot import Go1Robot
from reasoned_explorer.vehicles.unitree.legs import LegLog
from reasoned_explorer.vehicles.unitree.limits import CommandLimits
from reasoned_explorer.vehicles.unitree.link import ROBOT_HOST, ROBOT_PORT, Go1Link, LinkSettings
from reasoned_explorer.vehicles.unitree.lockstep import LockstepGo1
from reasoned_explorer.vehicles.unitree.robot import BodyReading, Robot
from reasoned_explorer.vehicles.unitree.settings import WalkSettings
from reasoned_explorer.vehicles.unitree.tracker import Ended, Tracker
from reasoned_explorer.vehicles.unitree.whereabouts import PositionSource, Reckoned, Surveyed, Whereabouts
from reasoned_explorer.vehicles.vehicle import Vehicle

T = TypeVar("T")


class Photographer(Protocol):
    """The robot's camera, which looks ahead."""

    def __call__(self) -> NDArray[np.uint8]:
        """Take a picture, RGB, shape (height, width, 3); called in a thread of its own, so that it may wait.

        Raises:
            PartError: If there is none to be had.
        """
        ...


class UnitreeVehicle(Vehicle):
    """A walking robot. It stands while the agent thinks and at the end of each leg, whatever ended it.

    A leg ends as stopped, with the reason, where the position is not good any more or the robot is not heard; once
    both are back the next leg is walked. On a clock whose seconds jump only a robot that is stepped can be driven.

    Args:
        profile: What the machine can do: how fast it is told to walk and turn.
        robot: The link to it.
        clock: The mission's.
        home: Where it stands at the start and which way it faces; the origin, facing north, where nothing is known.
        positions: Its receiver; None for none, it then reckons by its legs alone, and says so (`position_note`).
        camera: Takes its pictures; None for views without.
        settings: How it walks and looks.
        content: Says what a camera's view contains, for the simulated captioner of a world that both ends know; it is
            given the pose that the robot believes in.
    """

    def __init__(
        self,
        profile: VehicleProfile,
        robot: Robot,
        *,
        clock: Clock,
        home: Pose | None = None,
        positions: PositionSource | None = None,
        camera: Photographer | None = None,
        settings: WalkSettings | None = None,
        content: Content | None = None,
    ) -> None:
        if not profile.turns_to_look or profile.flies:
            what = f"the vehicle profile {profile.name!r}"
            raise SettingsError(robot.name, [Fault(what, "one of a machine that walks and turns to look")])
        self.profile, self.settings = profile, settings or WalkSettings()
        self._clock, self._camera, self._content = clock, camera, content
        start = home or Pose(0.0, 0.0)
        whereabouts: Whereabouts
        if positions is None:
            whereabouts = Reckoned(start, reckon_m=self.settings.reckon_m)
        else:
            whereabouts = Surveyed(start, settings=self.settings.localizer)
        self._robot, self._is_real = robot, clock.name == "real"
        self._tracker = Tracker(robot, profile, self.settings, whereabouts, positions)
        self._legs = self._looks = 0
        self._is_linked = self._is_up = False
        self._known_s = self._robot_known_s = 0.0
        #: The last leg; after a cancelled `go_to` the part of it that was walked.
        self.last_leg: Leg | None = None

    # What it says of itself.

    @property
    def pose(self) -> Pose:
        """Where it believes to be; the height is its camera's."""
        pose = self._tracker.here.pose
        return Pose(pose.x_m, pose.y_m, self.profile.camera_height_m, pose.heading_rad)

    @property
    def position_note(self) -> str:
        """How its position comes about, and what is wrong with it now."""
        verdict = self._tracker.here.verdict
        return self._tracker.whereabouts.note + ("" if verdict.is_good else f"; {verdict.grade}: {verdict.reason}")

    @property
    def has_good_position(self) -> bool:
        """Whether it may walk by its position."""
        return self._tracker.here.verdict.is_good

    @property
    def reading(self) -> BodyReading | None:
        """What the robot last said; None before the start."""
        return self._tracker.reading

    @property
    def reading_age_s(self) -> float:
        """Seconds since that, on the robot's time; infinite before the start."""
        reading = self._tracker.reading
        return float("inf") if reading is None else self._robot.now_s() - reading.time_s

    @property
    def battery_percent(self) -> float | None:
        """Charge, 0 to 100; None where it is not known."""
        return None if self.reading is None else self.reading.battery_percent

    @property
    def hottest_motor_c(self) -> float | None:
        """The hottest motor, degrees centigrade; None where it is not known."""
        return None if self.reading is None else self.reading.hottest_motor_c

    # What it does.

    def telemetry(self) -> Telemetry:
        """Return what a guard is told: what is known now, also on the way; in step, what was at the end of a poll."""
        here, reading = self._tracker.here, self._tracker.reading
        battery = self.battery_percent
        return Telemetry(
            pose=self.pose,
            t_s=None if reading is None else reading.time_s,
            speed_mps=None if reading is None else reading.speed_mps,
            yaw_rate_radps=None if reading is None else reading.turn_radps - here.gyro_bias_radps,
            link_age_s=self._robot.silent_s if self._is_linked else None,
            position_age_s=here.fix_age_s,
            position=here.verdict,
            battery=None if battery is None else battery / 100.0,
            compass_rad=here.compass_rad,
            picture_age_s=picture_age_s(self._camera),
        )

    async def refresh(self) -> None:
        """Find out where the robot is, and that it is heard.

        Raises:
            PartError: If it is not.
        """
        await self._begin()
        if self._robot.is_stepped and self._robot.silent_s > 0.0:
            await self._talk(lambda: self._tracker.stand_for(self._robot.period_s))
            await self._charge()
        await self._leave()

    async def halt(self) -> None:
        """Stand, whatever it was doing.

        Raises:
            PartError: If it is not heard; it then stands by itself before long.
        """
        if self._is_up:
            try:
                await self._talk(self._tracker.stop)
            finally:
                await self._leave()

    async def connect(self) -> None:
        """Open the link and listen: to the robot, which stays as it is, standing or lying, and to its receiver.

        Raises:
            PartError: If it is not heard.
        """
        if self._is_linked:
            return
        await self._talk(self._tracker.connect)
        open_camera(self._camera)
        self._is_linked = True
        self._known_s, self._robot_known_s = self._clock.now_s(), 0.0
        await self._charge()

    async def start(self) -> None:
        """Connect; the robot stands, having got up where it lay.

        Raises:
            PartError: If it is not heard or does not get up.
        """
        await self.connect()
        try:
            await self._talk(self._tracker.rise)
        except BaseException:
            self._is_linked = False
            close_camera(self._camera)
            raise
        self._is_up = True
        await self._charge()

    async def close(self) -> None:
        """Leave it standing, or lying, and hang up; one that was not started stays as it is. Safe to call twice."""
        if not self._is_linked:
            return
        lies, self._is_up, self._is_linked = self._is_up and self.settings.lies, False, False
        try:
            await self._talk(lambda: self._tracker.close(lies=lies))
        finally:
            close_camera(self._camera)

    async def look(self, headings_rad: Sequence[float]) -> Sequence[View]:
        """Turn to each heading and take a view; keys are (legs so far, looks since the last leg, index).

        It begins at the end of the list that is nearer to where it faces. Only connected, it does not turn.

        Raises:
            SettingsError: If a heading is not finite.
            PartError: If the link or the camera fails.
        """
        faults = [Fault(f"heading {heading}", "finite radians") for heading in headings_rad if not is_finite(heading)]
        if faults:
            raise SettingsError("look", faults)
        await self._begin()
        taken: dict[int, View] = {}
        try:
            for index in turning_order(self.pose.heading_rad, dict(enumerate(headings_rad))):
                if self._is_up:
                    await self._turn(normalise_heading_rad(headings_rad[index]))
                image = await self._picture()
                pose = self.pose
                content = None if self._content is None else self._content(pose, self.profile.camera)
                key = (self._legs, self._looks, index)
                taken[index] = View(key, pose, self.profile.camera, image, content)
            await self._talk(lambda: self._tracker.stand_for(self.profile.look_s))
            await self._charge()
        finally:
            await self._leave()
        self._looks += 1
        return [taken[index] for index in range(len(headings_rad))]

    async def go_to(self, target: Pose) -> Leg:
        """Walk straight to a point and face the target's heading, then stand.

        Cancelled on the way, it stands where it is then; `last_leg` tells what it walked.

        Raises:
            SettingsError: If the target is not finite.
            PartError: If the robot is not heard at the start, or was not started.
        """
        if not is_finite(target.x_m, target.y_m, target.heading_rad):
            raise SettingsError("go_to", [Fault(f"target {target}", "finite coordinates and heading")])
        if not self._is_up:
            raise PartError(self._robot.name, "the vehicle is not started")
        self._legs, self._looks = self._legs + 1, 0
        await self._begin()
        log = LegLog(target, self._clock.now_s(), self.profile.camera_height_m)
        try:
            ended = await self._walk(target, log)
            if ended[0] is LegOutcome.ARRIVED and self.profile.settle_s > 0.0:
                await self._talk(lambda: self._tracker.stand_for(self.profile.settle_s))
                await self._charge()
        except asyncio.CancelledError:
            await asyncio.shield(self._talk(self._tracker.halt))
            self.last_leg = log.leg(LegOutcome.STOPPED, "cancelled")
            raise
        finally:
            await self._leave()
        self.last_leg = log.leg(*ended)
        return self.last_leg

    async def _walk(self, target: Pose, log: LegLog) -> Ended:
        fault = await self._talk(self._wait_for_position)
        await self._charge()
        log.started_s = self._clock.now_s()
        if fault:
            log.see(0.0, self.pose)
            return LegOutcome.STOPPED, fault
        self._tracker.set_off(target, log)
        return await self._advance()

    async def _wait_for_position(self) -> str:
        try:
            return await self._tracker.wait_for_position()
        except PartError as error:
            return f"the link is lost: {error.reason}"

    async def _advance(self) -> Ended:
        while True:
            ended = await self._talk(lambda: self._tracker.advance(self.settings.poll_s))
            await self._charge()
            if ended is not None:
                return ended

    async def _turn(self, heading_rad: float) -> None:
        self._tracker.face(heading_rad)
        try:
            outcome, detail = await self._advance()
        except asyncio.CancelledError:
            await asyncio.shield(self._talk(self._tracker.halt))
            raise
        if outcome is LegOutcome.STOPPED:
            raise PartError(self._robot.name, detail)

    async def _picture(self) -> NDArray[np.uint8] | None:
        camera = self._camera
        if camera is None:
            return None
        return await self._talk(lambda: asyncio.to_thread(camera))

    # Time. A real robot is driven in the process's live loop, so that it is steered steadily whatever the mission
    # computes; a stepped one stands still while nobody talks to it.

    async def _talk(self, call: Callable[[], Coroutine[Any, Any, T]]) -> T:
        future = begin_live(call, Stopwatch())
        return await asyncio.wrap_future(future) if self._is_real else future.result()

    async def _begin(self) -> None:
        """Have passed for a stepped robot what has passed on the mission's clock; have a real one heard."""
        await self._talk(self._tracker.prepare)
        if not self._is_real:
            idle_s = self._clock.now_s() - self._known_s - (self._robot.now_s() - self._robot_known_s)
            if idle_s > 0.0:
                await self._talk(lambda: self._tracker.stand_for(idle_s))
            self._known_s, self._robot_known_s = self._clock.now_s(), self._robot.now_s()

    async def _charge(self) -> None:
        """Have passed on the mission's clock what has passed for a stepped robot."""
        if self._is_real:
            return
        elapsed_s = self._robot.now_s() - self._robot_known_s
        self._known_s, self._robot_known_s = self._clock.now_s() + elapsed_s, self._robot.now_s()
        await self._clock.act(elapsed_s)

    async def _leave(self) -> None:
        """Have a real robot listened to while it stands."""

        async def idle() -> None:
            self._tracker.idle()

        if self._is_linked:
            await self._talk(idle)


class Go1Vehicle(UnitreeVehicle):
    """A Go1 over its high-level UDP protocol; on a clock whose seconds jump, a served one in lockstep.

    Args:
        profile: See `UnitreeVehicle`, as all that is not told here.
        clock: The mission's.
        host: The robot's address.
        port: Where it listens.
        link: How the link to a real one is kept.
        limits: What commands are cut down to.
        home: Where it stands at the start.
        positions: Its receiver.
        camera: Takes its pictures.
        settings: How it walks and looks.
        content: For simulated captioners.
    """

    def __init__(
        self,
        profile: VehicleProfile,
        *,
        clock: Clock,
        host: str = ROBOT_HOST,
        port: int = ROBOT_PORT,
        link: LinkSettings | None = None,
        limits: CommandLimits | None = None,
        home: Pose | None = None,
        positions: PositionSource | None = None,
        camera: Photographer | None = None,
        settings: WalkSettings | None = None,
        content: Content | None = None,
    ) -> None:
        robot: Robot
        if clock.name == "real":
            opened = Go1Link(host, port, now_s=clock.now_s, settings=link, limits=limits)
            robot = Go1Robot(opened, now_s=clock.now_s)
        else:
            robot = LockstepGo1(host, port, limits=limits)
        super().__init__(
            profile,
            robot,
            clock=clock,
            home=home,
            positions=positions,
            camera=camera,
            settings=settings,
            content=content,
        )
