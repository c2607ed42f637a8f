"""A serial line as an asynchronous source of bytes, and as a sink for corrections."""

import asyncio
from collections.abc import AsyncIterator
from concurrent.futures import ThreadPoolExecutor
from importlib.util import find_spec
from types import TracebackType
from typing import Any, Self

from reasoned_explorer.model import MissingDependencyError, PartError
from reasoned_explorer.vehicles.positioning.nmea import INSTALL

_PART = "positioning"
# So long a read waits for a first byte; that is how late a closing line may notice it.
_WAIT_S = 0.2


class SerialPort:
    """A serial line, used as an asynchronous context manager.

    pyserial waits in threads of its own: one that reads and one that writes, so that corrections go out while a read
    waits.

    Args:
        device: A device such as ``/dev/ttyUSB1`` or ``COM3``, or a URL that pyserial knows, such as ``socket://HOST:PORT``.
        baud: Bits a second.
    """

    def __init__(self, device: str, *, baud: int) -> None:
        self.device, self.baud = device, baud
        self._port: Any = None
        self._reading: ThreadPoolExecutor | None = None
        self._writing: ThreadPoolExecutor | None = None

    async def open(self) -> None:
        """Open the line.

        Raises:
            MissingDependencyError: If pyserial is not installed.
            PartError: If the device cannot be opened.
        """
        if find_spec("serial") is None:
            raise MissingDependencyError(f"serial:{self.device}", "pyserial", INSTALL)
        import serial

        self._reading = ThreadPoolExecutor(1, thread_name_prefix="serial-read")
        self._writing = ThreadPoolExecutor(1, thread_name_prefix="serial-write")
        try:
            self._port = await self._in(
                self._reading,
                lambda: serial.serial_for_url(self.device, self.baud, timeout=_WAIT_S, write_timeout=2.0),
            )
        except PartError:
            await self.close()
            raise

    async def close(self) -> None:
        """Close the line. Safe to call twice."""
        port, self._port = self._port, None
        for pool in (self._reading, self._writing):
            if pool is not None:
                # What still waits for a byte ends by itself before long.
                await asyncio.to_thread(pool.shutdown, cancel_futures=True)
        self._reading = self._writing = None
        if port is not None:
            await asyncio.to_thread(port.close)

    async def chunks(self) -> AsyncIterator[bytes]:
        """Yield bytes as they come in; never empty ones.

        Raises:
            PartError: If the line breaks.
        """
        while self._port is not None and self._reading is not None:
            port = self._port
            data = await self._in(self._reading, lambda: port.read(max(1, port.in_waiting)))  # noqa: B023 - runs at once
            if data:
                yield data

    async def write(self, data: bytes) -> None:
        """Send bytes.

        Raises:
            PartError: If the line breaks or takes nothing.
        """
        if self._port is None or self._writing is None:
            raise PartError(_PART, f"the serial line {self.device} is not open")
        port = self._port
        await self._in(self._writing, lambda: port.write(data))

    async def _in(self, pool: ThreadPoolExecutor, call: Any) -> Any:
        try:
            return await asyncio.get_running_loop().run_in_executor(pool, call)
        except (OSError, ValueError, TypeError, AttributeError) as error:
            # pyserial's own errors are OSErrors; a device that is unplugged gives any of the others.
            raise PartError(_PART, f"serial line {self.device}: {error}") from error

    async def __aenter__(self) -> Self:
        await self.open()
        return self

    async def __aexit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        await self.close()
