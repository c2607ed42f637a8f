"""A fake Go2 behind the fake of its SDK, whose body the embedded simulator walks, in step; no robot, no DDS."""

import asyncio
import time
from types import SimpleNamespace
from typing import Any

from reasoned_explorer.serving.go1.gnss import GnssServer
from reasoned_explorer.serving.go1.walker import Walker
from reasoned_explorer.simulation.mishaps import MishapKind
from reasoned_explorer.simulation.motion import TICK_S
from reasoned_explorer.vehicles.unitree.go2 import Go2Robot
from reasoned_explorer.vehicles.unitree.messages import HighCommand
from tests.vehicles.unitree.fake_unitree_sdk2py import FakeGo2

#: The robot ends a `Move` that is not said anew for so long, seconds: assumed. Of real ones it is only reported that
#: they walk on "for just a second or two".
UNHEARD_S = 0.5
#: So long, in real time, the fake SDK waits for a robot that does not answer, and what it then says.
TIMEOUT_S, TIMED_OUT = 0.5, 3104


class WalkedGo2(FakeGo2):
    """A Go2 in a world, with a receiver beside it that speaks gpsd's protocol. Its time goes on where it is told to.

    Args:
        walker: Its body, and what befalls it.
        gnss: Its receiver.
    """

    def __init__(self, walker: Walker, gnss: GnssServer) -> None:
        super().__init__()
        self.walker, self.gnss, self.gnss_port = walker, gnss, 0
        #: When its body last moved, its own seconds.
        self.moved_s = 0.0
        self._told_s = 0.0
        self._loop: asyncio.AbstractEventLoop | None = None

    @property
    def is_cut_off(self) -> bool:
        """Whether nothing comes to it or from it; its receiver is on another link."""
        return self.walker.mishaps.at(MishapKind.LINK_LOSS, self.walker.time_s) is not None

    def move(self, vx: float, vy: float, vyaw: float) -> int:
        """See `FakeGo2`; lost on the way where the link is."""
        if not self.is_cut_off:
            self._told_s = self.walker.time_s
            super().move(vx, vy, vyaw)
        return 0

    def posture(self, mode: int | None) -> int:
        """See `FakeGo2`; not answered where the link is lost."""
        if self.is_cut_off:
            time.sleep(TIMEOUT_S)
            return TIMED_OUT
        return super().posture(mode)

    async def start(self, host: str = "127.0.0.1", port: int = 0) -> int:
        """Have the receiver listen."""
        self._loop = asyncio.get_running_loop()
        self.gnss.tell(self.walker.time_s, self.walker.fix)
        self.gnss_port = await self.gnss.start(host, port)
        return self.gnss_port

    async def close(self) -> None:
        """Stop."""
        await self.gnss.close()

    async def go_on(self, seconds: float) -> None:
        """Have its time go on, from any thread; where nobody is heard any more, until it stands."""
        assert self._loop is not None
        await asyncio.wrap_future(asyncio.run_coroutine_threadsafe(self._go_on(seconds), self._loop))

    async def _go_on(self, seconds: float) -> None:
        for _ in range(max(1, round(seconds / TICK_S))):
            self._tick()
            while self.is_cut_off and not self.walker.body.is_resting:
                self._tick()
            if not self.is_cut_off:
                for topic, handler in tuple(self.handlers.items()):
                    handler(self._sport_state() if topic == "rt/sportmodestate" else self._low_state())

    def _tick(self) -> None:
        walker = self.walker
        if walker.time_s - self._told_s > UNHEARD_S:
            self.velocity = (0.0, 0.0, 0.0)
        forward, left, turn_left = self.velocity
        walking = HighCommand.walking(forward_mps=forward, right_mps=-left, turn_radps=-turn_left)
        walker.obey(walking if any(self.velocity) else HighCommand.standing())
        was = walker.body.true_pose
        fix = walker.tick()
        if walker.body.true_pose != was:
            self.moved_s = walker.time_s
        if fix is not None:
            self.gnss.tell(walker.time_s, fix)

    def _sport_state(self) -> Any:
        state = self.walker.state()
        imu = SimpleNamespace(rpy=list(state.imu.rpy_rad), gyroscope=list(state.imu.gyroscope_radps))
        return SimpleNamespace(position=list(state.odometry_m), imu_state=imu, mode=self.mode)

    def _low_state(self) -> Any:
        state = self.walker.state()
        motors = [SimpleNamespace(temperature=motor.temperature_c) for motor in state.motors]
        return SimpleNamespace(bms_state=SimpleNamespace(soc=state.battery.charge_percent), motor_state=motors)


class SteppedGo2(Go2Robot):
    """What drives a Go2, but that its waiting has a fake robot's time go on.

    Args:
        robot: The fake, which stands in for the SDK already.
    """

    is_stepped = True

    def __init__(self, robot: WalkedGo2) -> None:
        super().__init__(now_s=lambda: robot.walker.time_s)
        self._robot = robot

    @property
    def fixes_due(self) -> int:
        """How many fixes its receiver has sent."""
        return self._robot.gnss.sent

    async def _pass(self, seconds: float) -> None:
        if seconds > 0.0:
            await self._robot.go_on(seconds)
