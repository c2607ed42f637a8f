"""The link to a Go1: commands out at a steady rate, states in, and what became of either."""

import asyncio
import math
from collections.abc import Callable
from dataclasses import dataclass, fields
from types import TracebackType
from typing import Self

from reasoned_explorer.model import Fault, PartError, SettingsError
from reasoned_explorer.vehicles.unitree.codec import PacketError, decode_state, encode_command
from reasoned_explorer.vehicles.unitree.limits import CommandLimits
from reasoned_explorer.vehicles.unitree.messages import HighCommand, HighState

#: Where the robot listens to high-level commands, on its own network.
ROBOT_HOST = "192.168.123.161"
ROBOT_PORT = 8082
_PART = "link"
# What is said on closing is said more than once: a datagram may get lost.
_FAREWELLS = 3


@dataclass(frozen=True, slots=True)
class LinkSettings:
    """How the link is kept.

    Attributes:
        rate_hz: Commands a second, 10 to 500.
        command_lifetime_s: A command to walk that is not given anew for so long becomes one to stand, seconds, > 0.
        lost_after_s: Nothing having been heard for so long, the robot is told to stand whatever is asked, seconds, > 0.
        local_port: Where states are received; 0 takes any that is free. The vendor's examples use 8090.

    Raises:
        SettingsError: If a value is out of its range, with all that are.
    """

    rate_hz: float = 100.0
    command_lifetime_s: float = 0.3
    lost_after_s: float = 0.5
    local_port: int = 8090

    def __post_init__(self) -> None:
        checks = (
            (10.0 <= self.rate_hz <= 500.0, f"rate_hz = {self.rate_hz}", "10 to 500"),
            (0 <= self.local_port <= 65535, f"local_port = {self.local_port}", "a port, or 0"),
            *(
                (
                    math.isfinite(getattr(self, name)) and getattr(self, name) > 0.0,
                    f"{name} = {getattr(self, name)}",
                    "> 0",
                )
                for name in ("command_lifetime_s", "lost_after_s")
            ),
        )
        faults = [Fault(what, expected) for sound, what, expected in checks if not sound]
        if faults:
            raise SettingsError("link to a Go1", faults)


@dataclass(slots=True)
class LinkCounts:
    """What happened on the link so far.

    Attributes:
        sent: Commands sent.
        received: States understood.
        malformed: Packets that were none, and were passed over.
        expired: How often a command to walk ran out because it was not given anew.
        silenced: How often a command to walk was held back because nothing was heard of the robot.
        refused: Datagrams that the network gave back (nobody listens there).
    """

    sent: int = 0
    received: int = 0
    malformed: int = 0
    expired: int = 0
    silenced: int = 0
    refused: int = 0

    def as_text(self) -> str:
        """Return the counts in one line, for people."""
        return ", ".join(f"{getattr(self, item.name)} {item.name}" for item in fields(self))


class Go1Link(asyncio.DatagramProtocol):
    """Talks to the robot while it is open; use it as an asynchronous context manager.

    From the start on it sends, at a steady rate, the last command that was given; at first and at last that is to
    stand. A robot is only kept walking by an owner that goes on giving commands and by states that go on coming in.

    Args:
        host: The robot's address.
        port: Where it listens.
        now_s: The time, seconds; `Clock.now_s` of a real clock.
        settings: How the link is kept.
        limits: What commands are cut down to.
    """

    def __init__(
        self,
        host: str = ROBOT_HOST,
        port: int = ROBOT_PORT,
        *,
        now_s: Callable[[], float],
        settings: LinkSettings | None = None,
        limits: CommandLimits | None = None,
    ) -> None:
        self.host, self.port = host, port
        self.settings = settings or LinkSettings()
        self.limits = limits or CommandLimits()
        self.counts = LinkCounts()
        self.state: HighState | None = None
        self.last_fault = ""
        self._now_s = now_s
        self._heard_s = -math.inf
        self._stand = encode_command(HighCommand.standing())
        self._command, self._packet, self._given_s = HighCommand.standing(), self._stand, -math.inf
        self._transport: asyncio.DatagramTransport | None = None
        self._sender: asyncio.Task[None] | None = None
        self._fresh = asyncio.Event()

    async def start(self) -> None:
        """Open the link and begin to send that the robot is to stand.

        Raises:
            PartError: If the address or the local port cannot be used.
        """
        loop = asyncio.get_running_loop()
        try:
            # A connected socket: only what comes from the robot's own address is ever read.
            self._transport, _ = await loop.create_datagram_endpoint(
                lambda: self,
                local_addr=("0.0.0.0", self.settings.local_port),  # noqa: S104 - datagrams of the robot come in here
                remote_addr=(self.host, self.port),
            )
        except OSError as error:
            raise PartError(_PART, f"no link to {self.host}:{self.port}: {error}") from error
        self._sender = asyncio.create_task(self._keep_sending())

    async def close(self, *, farewell: HighCommand | None = None) -> None:
        """Say that the robot is to stand, or what else it is to be left at, and close the link. Safe to call twice."""
        last = self._stand if farewell is None else encode_command(self.limits.cut(farewell))
        if self._sender is not None:
            self._sender.cancel()
            await asyncio.gather(self._sender, return_exceptions=True)
            self._sender = None
        if self._transport is not None:
            for _ in range(_FAREWELLS):
                self._transport.sendto(last)
            self._transport.close()
            self._transport = None

    def command(self, command: HighCommand) -> HighCommand:
        """Send a command from now on, and return it as it is really sent, cut to the limits.

        Raises:
            PacketError: If it cannot be made into a packet; what was sent so far goes on until it runs out.
        """
        executed = self.limits.cut(command)
        self._packet = encode_command(executed)
        self._command, self._given_s = executed, self._now_s()
        return executed

    @property
    def state_age_s(self) -> float:
        """Seconds since the last state came in; infinite where none did."""
        return self._now_s() - self._heard_s

    def fresh_state(self, *, max_age_s: float) -> HighState:
        """Return the last state.

        Raises:
            PartError: If it is older than so many seconds, or there is none.
        """
        age_s = self.state_age_s
        if self.state is None or age_s > max_age_s:
            heard = "nothing was ever heard" if self.state is None else f"nothing was heard for {age_s:.1f} s"
            raise PartError(_PART, f"{heard} of the robot at {self.host}:{self.port} ({self.counts.as_text()})")
        return self.state

    async def wait_for_state(self, timeout_s: float) -> HighState:
        """Wait for the next state.

        Raises:
            PartError: If none comes in so many seconds.
        """
        self._fresh.clear()
        try:
            await asyncio.wait_for(self._fresh.wait(), timeout_s)
        except TimeoutError:
            fault = f"; the last packet was none: {self.last_fault}" if self.last_fault else ""
            raise PartError(
                _PART, f"no state from {self.host}:{self.port} in {timeout_s:g} s ({self.counts.as_text()}){fault}"
            ) from None
        return self.fresh_state(max_age_s=math.inf)

    async def _keep_sending(self) -> None:
        period_s = 1.0 / self.settings.rate_hz
        due_s = self._now_s()
        while True:
            self._send()
            # A machine that was busy for a while catches up with nothing: old commands are worth nothing.
            due_s = max(due_s + period_s, self._now_s())
            await asyncio.sleep(due_s - self._now_s())

    def _send(self) -> None:
        if self._transport is None or self._transport.is_closing():
            return
        if self._command.moves:
            if self._now_s() - self._given_s > self.settings.command_lifetime_s:
                self.counts.expired += 1
                self._command, self._packet = HighCommand.standing(), self._stand
            elif self.state_age_s > self.settings.lost_after_s:
                self.counts.silenced += 1
                self._command, self._packet = HighCommand.standing(), self._stand
        self._transport.sendto(self._packet)
        self.counts.sent += 1

    # --- what the event loop calls --------------------------------------------------------------------------------

    def datagram_received(self, data: bytes, addr: object) -> None:  # noqa: ARG002 - the protocol's signature
        """Take in a packet; one that is none is counted and passed over."""
        try:
            state = decode_state(data)
        except PacketError as error:
            self.counts.malformed += 1
            self.last_fault = "; ".join(map(str, error.faults))
            return
        self.state, self._heard_s = state, self._now_s()
        self.counts.received += 1
        self._fresh.set()

    def error_received(self, exc: Exception) -> None:
        """Count what the network gave back."""
        self.counts.refused += 1
        self.last_fault = str(exc)

    # --- as a context manager -------------------------------------------------------------------------------------

    async def __aenter__(self) -> Self:
        await self.start()
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self.close()
