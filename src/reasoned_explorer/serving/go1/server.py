"""Answers as a Go1 does: commands in, states out, on UDP; with a satellite receiver beside it."""

import asyncio

from reasoned_explorer.model import Fault, SettingsError
from reasoned_explorer.model.checks import is_within
from reasoned_explorer.serving.go1.gnss import GnssServer
from reasoned_explorer.serving.go1.walker import Walker, numbered
from reasoned_explorer.simulation.mishaps import MishapKind
from reasoned_explorer.simulation.motion import TICK_S
from reasoned_explorer.vehicles.unitree.codec import PacketError, decode_command, encode_state
from reasoned_explorer.vehicles.unitree.lockstep import MOST_MOMENTS
from reasoned_explorer.vehicles.unitree.messages import HighCommand

#: A robot that was busy for longer makes up for no more than this, seconds.
_LATE_S = 1.0


class Go1Server(asyncio.DatagramProtocol):
    """A served Go1, for the event loop that it is started in.

    On real time it walks as long as commands to walk go on coming, and stands where none came for `silence_s`. States
    go to whoever sent the last command. In lockstep its time goes on by one tick for each new number that a command
    bears in ``reserve`` (by as many as it says in ``band_width``, where that is more); the state that answers it bears
    the number, too, and in ``serial_number`` how many fixes the receiver has sent.

    Args:
        walker: The robot.
        gnss: Its receiver; None for none.
        lockstep: Whether its time goes on by commands alone.
        rate_hz: States a second on real time, 1 to 500.
        silence_s: See above, seconds.
        gnss_port: Where the receiver is served; 0 for any that is free, which `gnss_port` then tells.

    Raises:
        SettingsError: If a value is out of range.
    """

    def __init__(
        self,
        walker: Walker,
        *,
        gnss: GnssServer | None = None,
        lockstep: bool = False,
        rate_hz: float = 100.0,
        silence_s: float = 0.5,
        gnss_port: int = 0,
    ) -> None:
        faults = []
        if not is_within(rate_hz, 1.0, 500.0):
            faults.append(Fault(f"rate_hz = {rate_hz!r:.40}", "1 to 500"))
        if not is_within(silence_s, 0.01, 60.0):
            faults.append(Fault(f"silence_s = {silence_s!r:.40}", "0.01 to 60 seconds"))
        if faults:
            raise SettingsError("served Go1", faults)
        self.walker, self.gnss, self.is_lockstep = walker, gnss, lockstep
        self.gnss_port = gnss_port
        self.commands = self.malformed = 0
        #: For tests: takes no command and says nothing while it is set.
        self.is_dumb = False
        self._rate_hz, self._silence_s = rate_hz, silence_s
        self._transport: asyncio.DatagramTransport | None = None
        self._running: asyncio.Task[None] | None = None
        self._peer: tuple[str, int] | None = None
        self._heard_s = 0.0
        self._number = 0
        self._answer = b""

    @property
    def has_link(self) -> bool:
        """Whether it listens to commands; its receiver is served after that."""
        return self._transport is not None

    async def start(self, host: str = "127.0.0.1", port: int = 0) -> int:
        """Listen; return the port."""
        loop = asyncio.get_running_loop()
        self._transport, _ = await loop.create_datagram_endpoint(lambda: self, local_addr=(host, port))
        if self.gnss is not None:
            self.gnss.tell(self.walker.time_s, self.walker.fix)
            self.gnss_port = await self.gnss.start(host, self.gnss_port)
        if not self.is_lockstep:
            self._running = asyncio.create_task(self._run())
        found: int = self._transport.get_extra_info("sockname")[1]
        return found

    async def close(self) -> None:
        """Stop. Safe to call twice."""
        running, self._running = self._running, None
        if running is not None:
            running.cancel()
            await asyncio.gather(running, return_exceptions=True)
        if self._transport is not None:
            self._transport.close()
            self._transport = None
        if self.gnss is not None:
            await self.gnss.close()

    def datagram_received(self, data: bytes, addr: tuple[str, int]) -> None:
        """Take a command; a packet that is none is counted and does nothing."""
        if self.is_dumb or self._is_cut_off:
            return
        try:
            command = decode_command(data)
        except PacketError:
            self.malformed += 1
            return
        self.commands += 1
        self._peer, self._heard_s = addr, asyncio.get_running_loop().time()
        if not self.is_lockstep:
            self.walker.obey(command)
            return
        if command.reserve != self._number or not self._answer:
            self._number = command.reserve
            self.walker.obey(command)
            for _ in range(min(max(1, command.band_width), MOST_MOMENTS)):
                self._tick()
                if self._is_cut_off:
                    self._go_on_alone()
                    return
            fixes = 0 if self.gnss is None else self.gnss.sent
            self._answer = encode_state(numbered(self.walker.state(), self._number, fixes))
        self._send(self._answer)

    def error_received(self, exc: Exception) -> None:
        """Nothing: who went away hears nothing."""

    @property
    def _is_cut_off(self) -> bool:
        """Whether its link is lost; its receiver is on another one."""
        return self.walker.mishaps.at(MishapKind.LINK_LOSS, self.walker.time_s) is not None

    def _go_on_alone(self) -> None:
        """Do in step what it does by itself on real time: walk on for a while, and stand since nobody is heard."""
        for _ in range(round(self._silence_s / TICK_S)):
            self._tick()
        self.walker.obey(HighCommand.standing())
        while not self.walker.body.is_resting:
            self._tick()

    def _send(self, packet: bytes) -> None:
        if self._transport is not None and self._peer is not None and not self._transport.is_closing():
            self._transport.sendto(packet, self._peer)

    def _tick(self) -> None:
        fix = self.walker.tick()
        if fix is not None and self.gnss is not None:
            self.gnss.tell(self.walker.time_s, fix)

    async def _run(self) -> None:
        """Carry the robot on as real time passes, and say what it senses."""
        loop = asyncio.get_running_loop()
        ticked_s = loop.time()
        while True:
            now_s = loop.time()
            ticked_s = max(ticked_s, now_s - _LATE_S)
            while now_s - ticked_s >= TICK_S:
                if now_s - self._heard_s > self._silence_s:
                    self.walker.obey(HighCommand.standing())
                self._tick()
                ticked_s += TICK_S
            if self._peer is not None and not self.is_dumb and not self._is_cut_off:
                self._send(encode_state(self.walker.state()))
            await asyncio.sleep(1.0 / self._rate_hz)
