"""Talks to one autopilot: heartbeats, commands and their answers, modes, setpoints, and who is in control.

Everything here runs in the process's live loop, whatever clock the mission is on. What the mission reads are values
that are replaced as a whole.
"""

import asyncio
import math
from collections.abc import Callable
from typing import Any

from reasoned_explorer.model.errors import PartError
from reasoned_explorer.vehicles.mavlink.address import Address
from reasoned_explorer.vehicles.mavlink.dialect import dialect
from reasoned_explorer.vehicles.mavlink.flavours import GCS_TYPE, NO_AUTOPILOT, Flavour
from reasoned_explorer.vehicles.mavlink.link import MavLink
from reasoned_explorer.vehicles.mavlink.lockstep import ANSWER_TYPE, REQUEST_TYPE, Ask, Report, Request
from reasoned_explorer.vehicles.mavlink.setpoints import Setpoint, standing
from reasoned_explorer.vehicles.mavlink.settings import DriverSettings
from reasoned_explorer.vehicles.mavlink.telemetry import Heartbeat, Telemetry

PART = "MAVLink"
_TRIES = 3
_HEARTBEAT_S, _LOOK_S = 1.0, 0.02
#: PX4 takes its guided mode only where setpoints came for longer than a second.
_STREAM_FIRST_S = 1.2
_STREAM_PX4_HZ, _STREAM_HZ = 10.0, 4.0
_MAV_RESULTS = {
    1: "temporarily rejected",
    2: "denied",
    3: "not supported",
    4: "failed",
    6: "cancelled",
}
_ACCEPTED, _IN_PROGRESS = 0, 5
_ARM, _SET_MODE, _MESSAGE_INTERVAL = 400, 176, 511
_CUSTOM_MODE = 1
#: How long it may take until anything is heard of an autopilot that is asked for positions all the time, seconds.
_HEAR_S = 1.0
#: Messages asked for at the rate of positions, and once a second, by their numbers.
_OFTEN = (24, 30, 32, 33, 132)
_SELDOM = (1, 147, 193, 230, 245)
_REAL32 = 9


class Autopilot:
    """One autopilot behind a link.

    Args:
        address: Where it is reached.
        settings: How it is talked to.
    """

    def __init__(self, address: Address, settings: DriverSettings) -> None:
        self.settings, self.telemetry = settings, Telemetry()
        self._dialect = dialect()
        self.link = MavLink(address, system=settings.system, component=settings.component, take=self._take)
        self._target: tuple[int, int] | None = None
        self._tasks: list[asyncio.Task[None]] = []
        self._loop: asyncio.AbstractEventLoop | None = None
        self._acks: dict[int, asyncio.Future[int]] = {}
        self._values: dict[str, asyncio.Future[float]] = {}
        self._steps: dict[int, asyncio.Future[Report]] = {}
        self._step_count = 0
        #: Whether a simulator that can be held did not answer: then it is not asked as patiently the next time.
        self._is_deaf = False
        self._setpoint: Setpoint | None = None
        self._modes: frozenset[str] | None = None
        #: Why the autopilot does not listen to this program any more; empty while it does.
        self.taken = ""

    @property
    def flavour(self) -> Flavour:
        """Which autopilot it is, on which kind of machine."""
        heard = self.telemetry.heartbeat
        if heard is None or heard.flavour is None:
            raise AssertionError
        return heard.flavour

    @property
    def is_armed(self) -> bool:
        """Whether its motors are on."""
        heard = self.telemetry.heartbeat
        return heard is not None and heard.armed

    async def connect(self) -> None:
        """Open the link, wait for the autopilot, ask for what it is to tell.

        Raises:
            PartError: If nobody is there, or an autopilot that this package does not know.
        """
        self.taken, self._modes, self._target, self._setpoint = "", None, None, None
        self.telemetry, self._loop = Telemetry(), asyncio.get_running_loop()
        await self.link.open(self.settings.ready_s)
        self._tasks = [asyncio.create_task(self._beat()), asyncio.create_task(self._stream())]
        where = self.link.address
        await self.wait_for(
            lambda: self._target is not None, self.settings.ready_s, f"no autopilot is heard on {where}"
        )
        heard = self.telemetry.heartbeat
        if heard is None or heard.flavour is None:
            raise PartError(PART, "what is heard is no ArduPilot or PX4 of a drone or a rover")
        often_us, seldom_us = round(1e6 / self.settings.rate_hz), 1_000_000
        for number in (*_OFTEN, *_SELDOM):
            # Those that an autopilot does not have it refuses; what is needed is waited for below.
            self._send_command(_MESSAGE_INTERVAL, number, often_us if number in _OFTEN else seldom_us)
        told = self.telemetry
        await self.wait_for(
            lambda: (
                told.yaw_rad is not None and (told.local if self.settings.origin is None else told.globe) is not None
            ),
            self.settings.ready_s,
            "the autopilot does not tell its position",
        )

    async def close(self) -> None:
        """Send nothing more. Safe to call twice."""
        tasks, self._tasks = self._tasks, []
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        await self.link.close()

    # Being in control.

    def check(self) -> None:
        """See that the link lives and that the autopilot listens.

        Raises:
            PartError: If either is not so.
        """
        if lost := self.lost():
            raise PartError(PART, lost)
        if self.taken:
            raise PartError(PART, self.taken)

    def lost(self) -> str:
        """Return why the link is lost, or nothing."""
        heard = self.telemetry.heartbeat
        if self.link.broken:
            return f"the link to {self.link.address} is lost: {self.link.broken}"
        silent_s = math.inf if heard is None else self.now_s() - heard.at_s
        if silent_s > self.settings.lost_s:
            return f"the link to {self.link.address} is lost: no heartbeat for {silent_s:.0f} s"
        return ""

    @property
    def silent_s(self) -> float:
        """For how long nothing has been heard, seconds."""
        return max(0.0, self.now_s() - self.telemetry.heard_at_s)

    async def hear_again(self) -> None:
        """Wait until anything is heard.

        Raises:
            PartError: If nothing is for a second.
        """
        before_s = self.telemetry.heard_at_s
        why_not = f"nothing is heard on {self.link.address}"
        await self.wait_for(lambda: self.telemetry.heard_at_s > before_s, _HEAR_S, why_not)

    async def take_control(self) -> None:
        """Take the guided mode and switch the motors on, or wait for a person who does.

        Raises:
            PartError: If that does not come about.
        """
        flavour = self.flavour
        if flavour.is_px4:
            self.aim(self.here())
            await asyncio.sleep(_STREAM_FIRST_S)
        await self.set_mode(flavour.guided)
        if not self.is_armed and self.settings.arms:
            await self.command(_ARM, 1.0)
        waiting = "the motors stay off" if self.settings.arms else "nobody switches the motors on (`arms` is off)"
        await self.wait_for(lambda: self.is_armed, self.settings.ready_s, waiting)
        self._modes = frozenset({flavour.guided})

    def allow(self, *modes: str) -> None:
        """Take other modes for ours too: those that a command of ours brings about."""
        if self._modes is not None:
            self._modes |= set(modes)

    async def set_mode(self, mode: str) -> None:
        """Change the mode; return when the autopilot says that it has it.

        Raises:
            PartError: If it does not.
        """
        number = self.flavour.modes[mode]
        numbers = (number >> 16 & 0xFF, number >> 24) if self.flavour.is_px4 else (number,)
        await self.command(_SET_MODE, _CUSTOM_MODE, *numbers)
        limit_s = _TRIES * self.settings.reply_s
        await self.wait_for(lambda: self._mode() == mode, limit_s, f"the autopilot does not change to {mode}")

    async def disarm(self) -> None:
        """Switch the motors off.

        Raises:
            PartError: If they stay on.
        """
        self._modes = None
        if self.is_armed:
            await self.command(_ARM, 0.0)

    # Talking.

    def aim(self, setpoint: Setpoint) -> None:
        """Have the autopilot go somewhere: sent at once, and again at a steady rate."""
        self._setpoint = setpoint
        self._send_setpoint()

    def here(self) -> Setpoint:
        """Return the setpoint that stays: PX4 holds a place, ArduPilot is told to stand."""
        local = self.telemetry.local
        if not self.flavour.is_px4 or local is None:
            return standing(flies=self.flavour.flies)
        return Setpoint(local.north_m, local.east_m, local.down_m)

    async def command(self, number: int, *parameters: float) -> None:
        """Give a command, again where nobody answers.

        Raises:
            PartError: If it is refused, with what the autopilot says, or never answered.
        """
        texts = self.telemetry.texts_seen
        for tried in range(_TRIES):
            answer = self._acks[number] = asyncio.get_running_loop().create_future()
            self._send_command(number, *parameters, confirmation=tried)
            try:
                async with asyncio.timeout(self.settings.reply_s):
                    result = await answer
            except TimeoutError:
                continue
            if result == _ACCEPTED:
                return
            await asyncio.sleep(_LOOK_S)
            fresh = self.telemetry.texts[-1:] if self.telemetry.texts_seen > texts else ()
            said = _MAV_RESULTS.get(result, f"result {result}")
            raise PartError(PART, f"command {number} is {said}" + "".join(f": {text}" for text in fresh))
        raise PartError(PART, f"command {number} is not answered")

    async def parameter(self, name: str) -> float:
        """Return a parameter's value.

        Raises:
            PartError: If nobody answers.
        """
        make = self._dialect.MAVLink_param_request_read_message
        return await self._parameter(name, lambda: make(*self._to, name.encode(), -1))

    async def set_parameter(self, name: str, value: float) -> None:
        """Set a parameter.

        Raises:
            PartError: If nobody answers.
        """
        make = self._dialect.MAVLink_param_set_message
        await self._parameter(name, lambda: make(*self._to, name.encode(), value, _REAL32))

    async def step(self, ask: Ask, seconds: float = 0.0, *, until_idle: bool = False) -> Report:
        """Ask a simulator that can be held for something.

        Raises:
            PartError: If it does not answer: it may be none.
        """
        self._step_count += 1
        number = self._step_count
        answer = self._steps[number] = asyncio.get_running_loop().create_future()
        payload = Request(ask, number, seconds, until_idle).pack()
        size = len(payload)
        try:
            for _ in range(1 if self._is_deaf else _TRIES):
                self.link.send(self._dialect.MAVLink_tunnel_message(*self._to, REQUEST_TYPE, size, payload))
                try:
                    async with asyncio.timeout(self.settings.reply_s):
                        report: Report = await asyncio.shield(answer)
                except TimeoutError:
                    continue
                self._is_deaf = False
                return report
        finally:
            del self._steps[number]
        self._is_deaf = True
        raise PartError(PART, "no link to a simulator that can be held: it does not answer")

    async def wait_for(self, holds: Callable[[], object], limit_s: float, why_not: str) -> None:
        """Wait until something holds.

        Raises:
            PartError: If it does not come to, with the reason that is given.
        """
        until_s = self.now_s() + limit_s
        while not holds():
            if self.now_s() > until_s:
                texts = "".join(f"; it says: {text}" for text in self.telemetry.texts[-1:])
                raise PartError(PART, f"{why_not} within {limit_s:g} s{texts}")
            if self.link.broken:
                raise PartError(PART, self.lost())
            await asyncio.sleep(_LOOK_S)

    @property
    def _to(self) -> tuple[int, int]:
        return self._target or (0, 0)

    @property
    def range_ahead_m(self) -> float | None:
        """How far it is to what stands ahead, by a distance sensor of the machine; None where there is none."""
        return self.telemetry.range_ahead_m(self.now_s())

    def now_s(self) -> float:
        """Return the time by which it is judged whether anybody is heard, seconds; safe from any thread."""
        return 0.0 if self._loop is None else self._loop.time()

    def _mode(self) -> str:
        return "" if self.telemetry.heartbeat is None else self.telemetry.heartbeat.mode

    def _send_command(self, number: int, *parameters: float, confirmation: int = 0) -> None:
        seven = (*parameters, *(0.0,) * (7 - len(parameters)))
        self.link.send(self._dialect.MAVLink_command_long_message(*self._to, number, confirmation, *seven))

    def _send_setpoint(self) -> None:
        setpoint = self._setpoint
        if setpoint is None or self.taken or self._target is None or self.lost():
            return
        boot_ms, origin = round(self.now_s() * 1000.0) % 2**32, self.settings.origin
        self.link.send(setpoint.message(self._dialect, self._to, boot_ms=boot_ms, origin=origin))

    async def _parameter(self, name: str, message: Callable[[], Any]) -> float:
        for _ in range(_TRIES):
            answer: asyncio.Future[float] = asyncio.get_running_loop().create_future()
            self._values[name] = answer
            self.link.send(message())
            try:
                async with asyncio.timeout(self.settings.reply_s):
                    return await answer
            except TimeoutError:
                continue
        raise PartError(PART, f"parameter {name} is not told")

    async def _beat(self) -> None:
        beat = self._dialect.MAVLink_heartbeat_message(GCS_TYPE, NO_AUTOPILOT, 0, 0, 4, 3)
        while True:
            self.link.send(beat)
            await asyncio.sleep(_HEARTBEAT_S)

    async def _stream(self) -> None:
        while True:
            heard = self.telemetry.heartbeat
            is_px4 = heard is not None and heard.flavour is not None and heard.flavour.is_px4
            await asyncio.sleep(1.0 / (self.settings.stream_hz or (_STREAM_PX4_HZ if is_px4 else _STREAM_HZ)))
            if self._setpoint is not None and self._setpoint.velocity_mps is None:  # whoever leads it says that anew
                self._send_setpoint()

    # Hearing.

    def _take(self, message: Any) -> None:
        kind, system, component = message.get_type(), message.get_srcSystem(), message.get_srcComponent()
        if self._target is None:
            wanted = self.settings.autopilot_system
            is_autopilot = kind == "HEARTBEAT" and message.autopilot != NO_AUTOPILOT and message.type != GCS_TYPE
            if not is_autopilot or (wanted and system != wanted):
                return
            self._target = system, component
        if (system, component) != self._target:
            return
        if kind == "HEARTBEAT":
            self.link.choose_sender()
        self.telemetry.take(message, self.now_s())
        if kind == "HEARTBEAT" and self.telemetry.heartbeat is not None:
            self._see_who_steers(self.telemetry.heartbeat)
        elif kind == "COMMAND_ACK":
            self._take_answer(message)
        elif kind == "PARAM_VALUE":
            self._take_value(message)
        elif kind == "TUNNEL" and message.payload_type == ANSWER_TYPE:
            report = Report.read(message.payload)
            answer = None if report is None else self._steps.get(report.number)
            if report is not None and answer is not None and not answer.done():
                answer.set_result(report)

    def _see_who_steers(self, heard: Heartbeat) -> None:
        """Notice that the autopilot, or a pilot, has taken over: it is not fought."""
        if self._modes is None or self.taken:
            return
        if heard.mode not in self._modes:
            said = "".join(f": {text}" for text in self.telemetry.texts[-1:])
            self.taken = f"the autopilot has changed to {heard.mode}{said}"
        elif not heard.armed and self._modes == {self.flavour.guided}:
            self.taken = "the motors were switched off"

    def _take_answer(self, message: Any) -> None:
        answer = self._acks.get(message.command)
        if answer is not None and not answer.done() and message.result != _IN_PROGRESS:
            answer.set_result(message.result)

    def _take_value(self, message: Any) -> None:
        answer = self._values.pop(str(message.param_id), None)
        if answer is not None and not answer.done() and math.isfinite(message.param_value):
            answer.set_result(float(message.param_value))
