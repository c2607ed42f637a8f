"""Bytes to and from an autopilot, without ever waiting on the event loop."""

import asyncio
import contextlib
from collections.abc import Callable
from typing import Any

from reasoned_explorer.model.errors import PartError
from reasoned_explorer.vehicles.mavlink.address import Address, Wire
from reasoned_explorer.vehicles.mavlink.dialect import Packer, Parser
from reasoned_explorer.vehicles.positioning.serial_port import SerialPort

_PART = "MAVLink"
#: So many bytes of a stream are read at once.
_CHUNK = 4096
#: So many senders of datagrams are told apart.
_MOST_SENDERS = 8
#: What could not be sent yet of a stream; beyond it, messages are dropped rather than sent late.
_MOST_UNSENT = 65_536


class MavLink:
    """A link to one autopilot.

    Args:
        address: Where it is.
        system: Who this program is on the wire.
        component: Likewise.
        take: Called with each message, in the loop that opened the link.
    """

    def __init__(self, address: Address, *, system: int, component: int, take: Callable[[Any], None]) -> None:
        self.address, self._take = address, take
        self._packer = Packer(system, component)
        self._parser = Parser(datagrams=False)
        self._senders: dict[object, Parser] = {}
        #: To whom datagrams are sent where this end listens; None before anybody is chosen.
        self._peer: Any = None
        #: From whom the message came that is being taken.
        self.sender: Any = None
        self._udp: asyncio.DatagramTransport | None = None
        self._writer: asyncio.StreamWriter | None = None
        self._serial: SerialPort | None = None
        self._tasks: set[asyncio.Task[None]] = set()
        self._malformed = 0
        #: Why the link broke; empty while it has not.
        self.broken = ""

    @property
    def malformed(self) -> int:
        """How often something came that is no message."""
        return self._malformed + self._parser.malformed + sum(one.malformed for one in self._senders.values())

    async def open(self, limit_s: float) -> None:
        """Open the link; that somebody is at the other end is not yet known.

        Raises:
            PartError: If it cannot be opened.
            MissingDependencyError: If a library that it needs is not installed.
        """
        where = self.address
        try:
            async with asyncio.timeout(limit_s):
                if where.wire is Wire.SERIAL:
                    self._serial = SerialPort(where.host, baud=where.number)
                    await self._serial.open()
                    self._begin(self._read_serial(self._serial))
                elif where.wire is Wire.TCP:
                    reader, self._writer = await asyncio.open_connection(where.host, where.number)
                    self._begin(self._read_stream(reader))
                else:
                    end = (where.host, where.number)
                    at = {"local_addr": end} if where.wire is Wire.UDP_IN else {"remote_addr": end}
                    loop = asyncio.get_running_loop()
                    self._udp, _ = await loop.create_datagram_endpoint(lambda: _Datagrams(self), **at)  # type: ignore[arg-type]
        except (OSError, TimeoutError) as error:
            await self.close()
            raise PartError(_PART, f"no link to {where}: {error or 'no answer'}") from error

    async def close(self) -> None:
        """Close the link. Safe to call twice."""
        tasks, self._tasks = self._tasks, set()
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        udp, self._udp = self._udp, None
        if udp is not None:
            udp.close()
        writer, self._writer = self._writer, None
        if writer is not None:
            writer.close()
            with contextlib.suppress(OSError):
                await writer.wait_closed()
        serial, self._serial = self._serial, None
        if serial is not None:
            await serial.close()

    def choose_sender(self) -> None:
        """Send to whoever sent the message that is being taken."""
        self._peer = self.sender

    def send(self, message: Any) -> None:
        """Send a message; one that cannot be sent now is lost, as any message on a link may be."""
        data = self._packer.pack(message)
        if self._udp is not None:
            if self.address.wire is Wire.UDP_OUT:
                self._udp.sendto(data)
            elif self._peer is not None:
                self._udp.sendto(data, self._peer)
        elif self._writer is not None:
            if self._writer.transport.get_write_buffer_size() < _MOST_UNSENT:
                self._writer.write(data)
        elif self._serial is not None:
            self._begin(self._write_serial(self._serial, data))

    def take(self, data: bytes, sender: object = None) -> None:
        """Take in bytes that came."""
        parser = self._parser
        if self._udp is not None:
            known = self._senders.get(sender)
            if known is None:
                if len(self._senders) >= _MOST_SENDERS:
                    self._malformed += self._senders.pop(next(iter(self._senders))).malformed
                known = self._senders[sender] = Parser(datagrams=True)
            parser = known
        for message in parser.feed(data):
            self.sender = sender
            self._take(message)

    def _begin(self, work: Any) -> None:
        task: asyncio.Task[None] = asyncio.get_running_loop().create_task(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    async def _read_stream(self, reader: asyncio.StreamReader) -> None:
        try:
            while data := await reader.read(_CHUNK):
                self.take(data)
            self.broken = "the other end hung up"
        except OSError as error:
            self.broken = str(error)

    async def _read_serial(self, port: SerialPort) -> None:
        try:
            async for data in port.chunks():
                self.take(data)
        except PartError as error:
            self.broken = error.reason

    async def _write_serial(self, port: SerialPort, data: bytes) -> None:
        try:
            await port.write(data)
        except PartError as error:
            self.broken = error.reason


class _Datagrams(asyncio.DatagramProtocol):
    def __init__(self, link: MavLink) -> None:
        self._link = link

    def datagram_received(self, data: bytes, addr: object) -> None:
        self._link.take(data, addr)

    def error_received(self, exc: Exception) -> None:
        """Nobody listens there: that is no end of the link, somebody may begin to."""
