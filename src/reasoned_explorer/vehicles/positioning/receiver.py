"""A receiver as a person names it, with its corrections, as one stream of fixes."""

import asyncio
from collections.abc import AsyncGenerator, Callable
from contextlib import aclosing

from reasoned_explorer.geometry.frames import GeoOrigin
from reasoned_explorer.model import Fault, PartError, SettingsError
from reasoned_explorer.vehicles.positioning.fix import Fix
from reasoned_explorer.vehicles.positioning.gpsd import gpsd_fixes
from reasoned_explorer.vehicles.positioning.nmea import NmeaReader
from reasoned_explorer.vehicles.positioning.ntrip import NtripClient
from reasoned_explorer.vehicles.positioning.serial_port import SerialPort
from reasoned_explorer.vehicles.positioning.source import GpsdSource, NtripSource, SerialSource

# A caster is asked again after so long, and after twice as long each time that it fails, up to the last.
_FIRST_PAUSE_S = 2.0
_LAST_PAUSE_S = 60.0


class Receiver:
    """A satellite receiver.

    Args:
        source: Where it is.
        origin: Of the world's frame.
        now_s: The time, seconds; `Clock.now_s` of a real clock.
        corrections: A caster that it is fed from; only on a serial line, gpsd feeds its receivers itself.
        on_fault: Told what goes wrong with the corrections. Fixes go on without them, of a lower quality.
        first_pause_s: So long after a caster has failed it is asked again the first time.

    Raises:
        SettingsError: If there are corrections for a receiver behind gpsd.
    """

    def __init__(
        self,
        source: GpsdSource | SerialSource,
        *,
        origin: GeoOrigin,
        now_s: Callable[[], float],
        corrections: NtripSource | None = None,
        on_fault: Callable[[PartError], object] | None = None,
        first_pause_s: float = _FIRST_PAUSE_S,
    ) -> None:
        if isinstance(source, GpsdSource) and corrections is not None:
            fault = Fault(
                "corrections for a receiver behind gpsd",
                "corrections for one on a serial line",
                "give the caster's address to gpsd itself: it takes ntrip:// as a source beside the receiver",
            )
            raise SettingsError("source of positions", [fault])
        self._source, self._origin, self._now_s = source, origin, now_s
        self._corrections, self._on_fault = corrections, on_fault
        self._first_pause_s = first_pause_s

    async def fixes(self) -> AsyncGenerator[Fix, None]:
        """Yield fixes as they come. Close it (`contextlib.aclosing`) where it is left before its end.

        Raises:
            PartError: If the receiver cannot be reached, or goes away.
            MissingDependencyError: If pyserial or pynmea2 is needed and not installed.
        """
        if isinstance(self._source, GpsdSource):
            stream = gpsd_fixes(self._source.host, self._source.port, origin=self._origin, now_s=self._now_s)
            async with aclosing(stream):
                async for fix in stream:
                    yield fix
            return
        reader = NmeaReader(self._origin)
        async with SerialPort(self._source.device, baud=self._source.baud) as port:
            feeding = asyncio.create_task(self._feed(port, reader))
            try:
                async for data in port.chunks():
                    for fix in reader.feed(data, time_s=self._now_s()):
                        yield fix
            finally:
                feeding.cancel()
                await asyncio.gather(feeding, return_exceptions=True)

    async def _feed(self, port: SerialPort, reader: NmeaReader) -> None:
        """Keep the receiver fed with corrections, whatever the caster does."""
        if self._corrections is None:
            return
        pause_s = self._first_pause_s
        while True:
            client = NtripClient(self._corrections, port.write, gga=lambda: reader.last_gga)
            try:
                await client.run()
            except PartError as error:
                if self._on_fault is not None:
                    self._on_fault(error)
            pause_s = self._first_pause_s if client.counts.received_bytes else min(_LAST_PAUSE_S, 2.0 * pause_s)
            await asyncio.sleep(pause_s)
