"""A Go1 on a real clock: commands go out at the link's rate, and the robot's last state is what it senses."""

import asyncio
from collections.abc import Callable

from reasoned_explorer.model import PartError
from reasoned_explorer.vehicles.unitree.limits import CommandLimits
from reasoned_explorer.vehicles.unitree.link import Go1Link
from reasoned_explorer.vehicles.unitree.messages import HighCommand, Mode
from reasoned_explorer.vehicles.unitree.robot import BodyReading, Robot, Velocity

#: Getting up and lying down take a real one about two seconds each.
_POSTURE_S = 3.0
_FIRST_STATE_S = 3.0


def command_of(velocity: Velocity | None) -> HighCommand:
    """Return the command for a velocity, or to stand."""
    if velocity is None:
        return HighCommand.standing()
    return HighCommand.walking(
        forward_mps=velocity.forward_mps, right_mps=velocity.right_mps, turn_radps=velocity.turn_radps
    )


def velocity_within(limits: CommandLimits, velocity: Velocity) -> Velocity:
    """Return a velocity cut to limits."""
    sent = limits.cut(command_of(velocity))
    return Velocity(sent.forward_mps, 0.0 - sent.left_mps, 0.0 - sent.yaw_rate_left_radps)


class Go1Robot(Robot):
    """A Go1 over its UDP protocol.

    Args:
        link: To the robot; not yet open.
        now_s: The time, seconds; `Clock.now_s` of the real clock that the link has, too.
        period_s: How often the tracker steers, seconds.
        first_state_s: How long to wait for the first state.
        posture_s: How long getting up or lying down takes.
    """

    name = "Go1"

    def __init__(
        self,
        link: Go1Link,
        *,
        now_s: Callable[[], float],
        period_s: float = 0.05,
        first_state_s: float = _FIRST_STATE_S,
        posture_s: float = _POSTURE_S,
    ) -> None:
        self.link, self.period_s = link, period_s
        self._now_s, self._first_state_s, self._posture_s = now_s, first_state_s, posture_s
        self._due_s = 0.0
        self._is_open = False

    def now_s(self) -> float:
        """Return the clock's time."""
        return self._now_s()

    @property
    def silent_s(self) -> float:
        """For how long no state has come in."""
        return self.link.state_age_s

    async def start(self) -> None:
        """Open the link and wait for the robot's first word."""
        await self.link.start()
        self._is_open = True
        try:
            await self.link.wait_for_state(self._first_state_s)
        except PartError:
            await self.close(lies=False)
            raise
        self._due_s = self._now_s()

    async def close(self, *, lies: bool) -> None:
        """Leave it standing, or have it lie down first, and hang up."""
        if not self._is_open:
            return
        self._is_open = False
        self.link.command(HighCommand.standing())
        if lies and self.link.state_age_s <= self.link.settings.lost_after_s:
            await self._wait_until_it_stands()
            self.link.command(HighCommand(Mode.LIE_DOWN))
            await asyncio.sleep(self._posture_s)
            await self.link.close(farewell=HighCommand(Mode.LIE_DOWN))
            return
        await self.link.close()

    async def moment(self, velocity: Velocity | None) -> BodyReading:
        """Command it, wait for the next moment, and return its last state, which must be a fresh one."""
        self.link.command(command_of(velocity))
        # Who comes late catches up with nothing.
        self._due_s = max(self._due_s + self.period_s, self._now_s())
        await asyncio.sleep(self._due_s - self._now_s())
        try:
            state = self.link.fresh_state(max_age_s=self.link.settings.lost_after_s)
        except PartError:
            self.link.command(HighCommand.standing())
            raise
        return BodyReading.of(state, self._now_s())

    async def get_up(self) -> None:
        """Have it rise, and wait until it stands."""
        self.link.command(HighCommand(Mode.GET_UP))
        await asyncio.sleep(self._posture_s)
        self.link.command(HighCommand.standing())
        reading = await self.moment(None)
        if reading.lies:
            raise PartError(self.name, "it does not get up")

    def cut(self, velocity: Velocity) -> Velocity:
        """Return what the link's limits leave of a velocity."""
        return velocity_within(self.link.limits, velocity)

    async def _wait_until_it_stands(self) -> None:
        """Let it come to rest, for a second at most."""
        for _ in range(20):
            await asyncio.sleep(0.05)
            state = self.link.state
            if state is None or abs(state.forward_mps) + abs(state.right_mps) < 0.05:
                return
