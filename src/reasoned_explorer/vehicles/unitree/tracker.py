"""Walks a robot along straight legs: moment by moment, from where it believes to be to the next velocity."""

import asyncio
import math
from contextlib import aclosing, suppress
from dataclasses import dataclass, replace

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import LegOutcome, PartError
from reasoned_explorer.vehicles.control.follower import Command, FollowerSettings, Phase, PidFollower
from reasoned_explorer.vehicles.control.readiness import make_ready
from reasoned_explorer.vehicles.positioning.fix import Fix
from reasoned_explorer.vehicles.profile import VehicleProfile
from reasoned_explorer.vehicles.unitree.legs import LegLog
from reasoned_explorer.vehicles.unitree.robot import BodyReading, Robot, Velocity
from reasoned_explorer.vehicles.unitree.settings import WalkSettings
from reasoned_explorer.vehicles.unitree.whereabouts import Here, PositionSource, Whereabouts

#: Moments of standing after a leg or turn, until which it has come to rest.
_REST_MOMENTS = 6
#: A leg may take so many times as long as it should, and some seconds.
_PATIENCE, _PATIENCE_S = 3.0, 10.0
#: A receiver that went away is asked again after so long.
_RECEIVER_AGAIN_S = 1.0
#: How long a receiver may take to say anything before the robot is told to get up without it, real seconds.
_RECEIVER_S = 5.0
#: How long a fix that a stepped robot says was sent may be on its way, real seconds.
_FIX_DEADLINE_S = 10.0

#: Told to walk at least so fast, and having done so, a robot whose legs make less than this share of it for so long is
#: held up.
_HELD_MPS, _HELD_SHARE, _HELD_S = 0.1, 0.25, 0.35
_GOING_SHARE = 0.5
#: It then steps back a hand's breadth, over ground that it has just walked, so that it is free to turn.
_BACK = Velocity(-0.2)
_BACK_S = 0.6

Ended = tuple[LegOutcome, str]


@dataclass(slots=True)
class _Way:
    """A leg or turn that is being walked.

    Attributes:
        began_s: When it began, on the robot's time.
        limit_s: How long it may take.
        log: Of a leg; None of a turn.
        outcome: How it ended, where it has; the robot then still has to come to rest.
        rested: For how many moments it has stood since.
        is_going: Whether its legs have made the speed that is asked for.
        held_s: For how long they have not since.
        back_s: For how long it still steps back.
    """

    began_s: float
    limit_s: float
    log: LegLog | None
    outcome: Ended | None = None
    rested: int = 0
    is_going: bool = False
    held_s: float = 0.0
    back_s: float = 0.0


class Tracker:
    """Has a robot walk. Its coroutines run in one event loop; while none runs, the robot stands.

    Args:
        robot: The link to it.
        profile: How fast it is to walk and turn.
        settings: How.
        whereabouts: Makes a position of what is sensed.
        source: Of fixes; None for none.
    """

    def __init__(
        self,
        robot: Robot,
        profile: VehicleProfile,
        settings: WalkSettings,
        whereabouts: Whereabouts,
        source: PositionSource | None,
    ) -> None:
        make_ready()
        self.robot, self.settings, self.whereabouts = robot, settings, whereabouts
        most = robot.cut(Velocity(profile.speed_mps)).forward_mps
        fastest = robot.cut(Velocity(0.0, 0.0, profile.turn_rate_radps)).turn_radps
        self._profile = replace(profile, speed_mps=most, turn_rate_radps=fastest)
        self._follower = PidFollower(FollowerSettings.of(self._profile))
        self._source = source
        self._fixes: asyncio.Queue[Fix] = asyncio.Queue()
        self._fixes_taken = 0
        self._way: _Way | None = None
        #: For how many moments it has been told to stand.
        self._stood = 0
        self._listening: asyncio.Task[None] | None = None
        self._idling: asyncio.Task[None] | None = None
        self.reading: BodyReading | None = None
        self.here: Here = whereabouts.at(-math.inf)
        #: What is wrong with the receiver at present, for people; empty where nothing is known to be.
        self.receiver_fault = ""

    # Its life.

    async def connect(self) -> None:
        """Open the link, have the robot stay as it is, begin to listen to the receiver.

        Raises:
            PartError: If the robot is not heard, or its receiver cannot be reached.
        """
        if self._source is not None:
            self._listening = asyncio.create_task(self._listen(self._source))
        try:
            await self._hear_receiver()
            if self.robot.is_stepped and self._source is not None:
                # A served receiver greets with a fix: from then on all that it sends are counted.
                await self._take_fixes(self.robot.now_s(), due=1)
            await self.robot.start()
            await self._moment(None)
        except BaseException:
            await self.close(lies=False)
            raise
        self.idle()

    async def rise(self) -> None:
        """Have the robot stand.

        Raises:
            PartError: If it lies and is not to get up, or does not.
        """
        await self.stop_idling()
        try:
            if self.reading is not None and self.reading.lies:
                if not self.settings.gets_up:
                    raise PartError(self.robot.name, "it lies on the ground, and is not to be told to get up")
                await self.robot.get_up()
                await self._moment(None)
        except BaseException:
            await self.close(lies=False)
            raise
        self.idle()

    async def close(self, *, lies: bool) -> None:
        """Leave the robot standing, or have it lie down, and hang up. Safe to call twice."""
        await self.stop_idling()
        listening, self._listening = self._listening, None
        if listening is not None:
            listening.cancel()
            await asyncio.gather(listening, return_exceptions=True)
        await self.robot.close(lies=lies)

    def idle(self) -> None:
        """Go on listening while the robot stands; a stepped robot's time stands, too."""
        if not self.robot.is_stepped and self._idling is None:
            self._idling = asyncio.create_task(self._idle())

    async def stop_idling(self) -> None:
        """Have nobody else command the robot."""
        idling, self._idling = self._idling, None
        if idling is not None:
            idling.cancel()
            await asyncio.gather(idling, return_exceptions=True)

    # What it does.

    async def prepare(self) -> None:
        """Be ready to walk: wait for a robot that is not heard at present.

        Raises:
            PartError: If it is not heard for long.
        """
        if self.robot.is_stepped:
            return
        await self.stop_idling()
        until_s = self.robot.now_s() + self.settings.lost_patience_s
        while True:
            try:
                await self._moment(None)
            except PartError:
                if self.robot.now_s() > until_s:
                    self.idle()
                    raise
            else:
                return

    async def stand_for(self, seconds: float) -> None:
        """Stand for some seconds of the robot's time, to the nearest moment."""
        until_s = self.robot.now_s() + seconds - 0.5 * self.robot.period_s
        while (left_s := until_s - self.robot.now_s()) > 0.0:
            # A filter wants every moment's turn rate; legs that stand are reckoned in one go.
            moments = 1 if self._source is not None else math.ceil(left_s / self.robot.period_s)
            await self._take(await self.robot.stand(moments))

    async def wait_for_position(self) -> str:
        """Stand until the position is good; return why it is not where that takes too long, else nothing."""
        until_s = self.robot.now_s() + self.settings.position_patience_s
        while not self.here.verdict.is_good:
            if self.robot.now_s() >= until_s:
                return self._position_fault()
            await self._moment(None)
        return ""

    def set_off(self, target: Pose, log: LegLog) -> None:
        """Begin a leg; `advance` walks it."""
        pose = self.here.pose
        self._follower.start(pose, target)
        due_s = pose.distance_to_m(target.x_m, target.y_m) / self._profile.speed_mps
        self._begin(due_s, log)
        log.see(0.0, pose)

    def face(self, heading_rad: float) -> None:
        """Begin a turn in place; `advance` makes it."""
        self._follower.face(self.here.pose, heading_rad)
        self._begin(0.0, None)

    async def advance(self, seconds: float) -> Ended | None:
        """Walk on for some seconds; return how the leg or turn ended once the robot stands, else None.

        Whatever ends it, the robot stands. Where it is cancelled, it stands after `halt`, or when its last command
        has run out.
        """
        way = self._way
        if way is None:
            raise AssertionError
        try:
            for _ in range(max(1, round(seconds / self.robot.period_s))):
                if way.outcome is None:
                    await self._walk(way)
                if way.outcome is not None:
                    if way.rested >= _REST_MOMENTS:
                        self._way = None
                        return way.outcome
                    if way.back_s > 0.0:
                        way.back_s -= self.robot.period_s
                        await self._moment(_BACK)
                    else:
                        way.rested += 1
                        await self._moment(None)
                self._note(way)
        except PartError as error:
            self._way = None
            return way.outcome or (LegOutcome.STOPPED, f"the link is lost: {error.reason}")
        return None

    async def halt(self) -> None:
        """Stand, whatever it was at."""
        with suppress(PartError):
            await self.stop()

    async def stop(self) -> None:
        """Likewise.

        Raises:
            PartError: If the robot is not heard: it has then been told to stand, and stands by itself before long.
        """
        await self.stop_idling()
        self._way = None
        while True:
            await self._moment(None)
            if self._stood >= _REST_MOMENTS:
                return

    # Inside.

    def _begin(self, due_s: float, log: LegLog | None) -> None:
        due_s += 2.0 * math.pi / self._profile.turn_rate_radps
        self._way = _Way(self.robot.now_s(), _PATIENCE * due_s + _PATIENCE_S, log)

    async def _walk(self, way: _Way) -> None:
        """Take one step of the follower, and a moment of it; or find that the way is over."""
        reading = self.reading
        if way.log is not None and not self.here.verdict.is_good:
            way.outcome = LegOutcome.STOPPED, self._position_fault()
            return
        rate = 0.0 if reading is None else reading.turn_radps - self.here.gyro_bias_radps
        command = self._follower.step(self.here.pose, yaw_rate_radps=rate, dt_s=self.robot.period_s)
        if command.phase is Phase.ARRIVED:
            way.outcome = LegOutcome.ARRIVED, ""
        elif command.phase is Phase.STUCK:
            way.outcome = LegOutcome.STUCK, "no progress"
        elif self.robot.now_s() - way.began_s > way.limit_s:
            way.outcome = LegOutcome.STUCK, "not there in three times the time that it should take"
        if way.outcome is None:
            await self._moment(_velocity(command))
            self._feel(way, command.forward_mps)

    def _feel(self, way: _Way, told_mps: float) -> None:
        """Find out from its legs whether something holds it up."""
        if self.reading is None or told_mps < _HELD_MPS:
            way.is_going, way.held_s = False, 0.0
            return
        share = self.reading.forward_mps / told_mps
        way.is_going |= share >= _GOING_SHARE
        way.held_s = way.held_s + self.robot.period_s if way.is_going and share < _HELD_SHARE else 0.0
        if way.held_s >= _HELD_S:
            way.outcome, way.back_s = (LegOutcome.COLLISION, "something held it up"), _BACK_S

    def _note(self, way: _Way) -> None:
        if way.log is not None:
            drives = way.outcome is None and self._follower.phase is Phase.DRIVE
            across_m = self._follower.cross_track_m if drives else None
            way.log.see(self.robot.now_s() - way.began_s, self.here.pose, across_m=across_m)

    async def _moment(self, velocity: Velocity | None) -> None:
        self._stood = self._stood + 1 if velocity is None else 0
        await self._take(await self.robot.moment(velocity))

    async def _take(self, reading: BodyReading) -> None:
        self.reading = reading
        await self._take_fixes(reading.time_s, due=self.robot.fixes_due)
        self.whereabouts.take(reading)
        self.here = self.whereabouts.at(reading.time_s)

    async def _take_fixes(self, now_s: float, *, due: int) -> None:
        if not self.robot.is_stepped or self._source is None:
            while not self._fixes.empty():
                self.whereabouts.take_fix(self._fixes.get_nowait())
            return
        # What a stepped robot says was sent is waited for, and counts for the moment at which it was.
        while self._fixes_taken < due:
            try:
                fix = await asyncio.wait_for(self._fixes.get(), _FIX_DEADLINE_S)
            except TimeoutError:
                raise PartError("positioning", f"a fix is missing {self.receiver_fault}".rstrip()) from None
            self._fixes_taken += 1
            self.whereabouts.take_fix(replace(fix, time_s=now_s))

    async def _hear_receiver(self) -> None:
        """Find out before anything moves whether there is a receiver at all; its first fix may come later."""
        until_s = asyncio.get_running_loop().time() + (0.0 if self._source is None else _RECEIVER_S)
        while self._fixes.empty() and asyncio.get_running_loop().time() < until_s:
            if self.receiver_fault:
                raise PartError("positioning", self.receiver_fault)
            await asyncio.sleep(0.02)

    def _position_fault(self) -> str:
        fault = f" ({self.receiver_fault})" if self.receiver_fault else ""
        return f"the position is {self.here.verdict.grade}: {self.here.verdict.reason}{fault}"

    async def _idle(self) -> None:
        while True:
            # What is not heard now is told to whoever wants to walk.
            with suppress(PartError):
                await self._moment(None)

    async def _listen(self, source: PositionSource) -> None:
        """Keep the fixes coming, whatever the receiver does."""
        while True:
            try:
                async with aclosing(source.fixes()) as fixes:
                    async for fix in fixes:
                        self.receiver_fault = ""
                        self._fixes.put_nowait(fix)
                self.receiver_fault = "the receiver has ended"
            except PartError as error:
                self.receiver_fault = error.reason
            await asyncio.sleep(_RECEIVER_AGAIN_S)


def _velocity(command: Command) -> Velocity:
    return Velocity(command.forward_mps, command.right_mps, command.yaw_rate_radps)
