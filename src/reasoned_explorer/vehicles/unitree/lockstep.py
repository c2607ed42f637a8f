"""A Go1 whose time is stepped: the served one, for clocks whose seconds jump. Never a real one.

Each command is numbered (``reserve`` of HighCmd) and has one moment pass, or as many as it says (``band_width``); the
state that answers it bears the same number. A command that is not answered is said again, and one that was carried out
already has no more time pass. A real robot does not answer so, and has then only ever been told to stand.
"""

import asyncio
from dataclasses import replace

from reasoned_explorer.model import PartError
from reasoned_explorer.vehicles.unitree.codec import PacketError, decode_state, encode_command
from reasoned_explorer.vehicles.unitree.go1_robot import command_of, velocity_within
from reasoned_explorer.vehicles.unitree.limits import CommandLimits
from reasoned_explorer.vehicles.unitree.messages import HighCommand, HighState, Mode
from reasoned_explorer.vehicles.unitree.robot import BodyReading, Robot, Velocity

#: So many moments a command lets pass at most.
MOST_MOMENTS = 1000
_AGAIN_S = 0.25
#: Moments in which it gets up or lies down.
_POSTURE_MOMENTS = 60


class LockstepGo1(Robot, asyncio.DatagramProtocol):
    """A served Go1 in lockstep.

    Args:
        host: Where it is served.
        port: Likewise.
        limits: What commands are cut down to.
        deadline_s: How long an answer may take, real seconds.
        period_s: How long the moment is that a command lets pass.
    """

    name = "served Go1"
    is_stepped = True

    def __init__(
        self,
        host: str,
        port: int,
        *,
        limits: CommandLimits | None = None,
        deadline_s: float = 10.0,
        period_s: float = 0.05,
    ) -> None:
        self.host, self.port, self.period_s = host, port, period_s
        self.limits = limits or CommandLimits()
        self.malformed = 0
        self._deadline_s = deadline_s
        self._number = self._moments = 0
        self._state: HighState | None = None
        self._answer: asyncio.Future[HighState] | None = None
        self._transport: asyncio.DatagramTransport | None = None
        self._silent_s = 0.0

    @property
    def silent_s(self) -> float:
        """How long an answer was waited for in vain, real seconds; 0 where the last command was answered."""
        return self._silent_s

    def now_s(self) -> float:
        """Return how long the robot's time has gone on since the start."""
        return self._moments * self.period_s

    @property
    def fixes_due(self) -> int:
        """How many fixes its receiver has sent so far, as its states say."""
        return 0 if self._state is None else self._state.serial_number[0]

    async def start(self) -> None:
        """Open the link and have it stand for a moment."""
        loop = asyncio.get_running_loop()
        try:
            self._transport, _ = await loop.create_datagram_endpoint(lambda: self, remote_addr=(self.host, self.port))
        except OSError as error:
            raise PartError(self.name, f"no link to {self.host}:{self.port}: {error}") from error
        try:
            await self.moment(None)
        except PartError:
            await self._hang_up()
            raise

    async def close(self, *, lies: bool) -> None:
        """Leave it standing or lying, and hang up."""
        if self._transport is None:
            return
        try:
            await self.moment(None)
            if lies:
                for _ in range(_POSTURE_MOMENTS):
                    await self._exchange(HighCommand(Mode.LIE_DOWN))
        finally:
            await self._hang_up()

    async def moment(self, velocity: Velocity | None) -> BodyReading:
        """Have one moment pass."""
        state = await self._exchange(self.limits.cut(command_of(velocity)))
        return BodyReading.of(state, self.now_s())

    async def stand(self, moments: int) -> BodyReading:
        """Have it stand for some moments in one go, at least one and at most `MOST_MOMENTS`."""
        state = await self._exchange(HighCommand.standing(), max(1, min(moments, MOST_MOMENTS)))
        return BodyReading.of(state, self.now_s())

    async def get_up(self) -> None:
        """Have it rise."""
        for _ in range(_POSTURE_MOMENTS):
            await self._exchange(HighCommand(Mode.GET_UP))
        if (await self.moment(None)).lies:
            raise PartError(self.name, "it does not get up")

    def cut(self, velocity: Velocity) -> Velocity:
        """Return what the limits leave of a velocity."""
        return velocity_within(self.limits, velocity)

    async def _exchange(self, command: HighCommand, moments: int = 1) -> HighState:
        if self._transport is None:
            raise PartError(self.name, "the link is not open")
        packet = encode_command(replace(command, reserve=self._number + 1, band_width=moments))
        self._answer = asyncio.get_running_loop().create_future()
        try:
            async with asyncio.timeout(self._deadline_s):
                while not self._answer.done():
                    self._transport.sendto(packet)
                    await asyncio.wait({self._answer}, timeout=_AGAIN_S)
        except TimeoutError:
            self._silent_s = self._deadline_s
            fault = "a real robot is driven on the real clock" if self._number == 0 else "the link is lost"
            raise PartError(
                self.name, f"no answer in step from {self.host}:{self.port} in {self._deadline_s:g} s: {fault}"
            ) from None
        self._state, self._silent_s = self._answer.result(), 0.0
        self._number += 1
        self._moments += moments
        return self._state

    async def _hang_up(self) -> None:
        if self._transport is not None:
            self._transport.close()
            self._transport = None

    def datagram_received(self, data: bytes, addr: object) -> None:  # noqa: ARG002 - the protocol's signature
        """Take in a state, if it answers what was said last; packets that are none are counted and passed over."""
        try:
            state = decode_state(data)
        except PacketError:
            self.malformed += 1
            return
        if state.reserve == self._number + 1 and self._answer is not None and not self._answer.done():
            self._answer.set_result(state)

    def error_received(self, exc: Exception) -> None:
        """Nothing: what is not answered is said again."""
