"""Corrections from a caster by NTRIP, version 2 or 1: RTCM goes to a receiver, its place goes to the caster.

The user's name and password stand in the environment (``NTRIP_USER``, ``NTRIP_PASSWORD``) and nowhere else; no message
and no error repeats them.
"""

import asyncio
import base64
import os
from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass

from reasoned_explorer.model import PartError
from reasoned_explorer.vehicles.positioning.source import NtripSource

USER_VARIABLE = "NTRIP_USER"
PASSWORD_VARIABLE = "NTRIP_PASSWORD"  # noqa: S105 - a variable's name
_PART = "corrections"
_AGENT = "NTRIP reasoned-explorer"
_CHUNK_BYTES = 4096
_HEAD_BYTES = 16384


@dataclass(slots=True)
class NtripCounts:
    """What went through so far.

    Attributes:
        received_bytes: Of corrections.
        places_sent: How often the receiver's place was sent to the caster.
    """

    received_bytes: int = 0
    places_sent: int = 0


class NtripClient:
    """Feeds a receiver with the corrections of a caster until it is cancelled or the stream ends.

    Args:
        source: Which stream of which caster.
        write: Takes bytes of RTCM to the receiver, e.g. `SerialPort.write`.
        gga: Returns the receiver's last GGA sentence with its end of line, or empty bytes where there is none yet;
            casters that compute corrections for the place ask for it.
        gga_every_s: How often it is sent, seconds.
        silence_s: A stream that brings nothing for so long counts as broken, seconds.
        environment: Where name and password are looked up.
    """

    def __init__(
        self,
        source: NtripSource,
        write: Callable[[bytes], Awaitable[None]],
        *,
        gga: Callable[[], bytes] = bytes,
        gga_every_s: float = 10.0,
        silence_s: float = 60.0,
        environment: Mapping[str, str] | None = None,
    ) -> None:
        self.source, self.counts = source, NtripCounts()
        self._write, self._gga = write, gga
        self._gga_every_s, self._silence_s = gga_every_s, silence_s
        self._environment = os.environ if environment is None else environment

    async def run(self) -> None:
        """Connect and feed the receiver; end when the caster ends the stream.

        Raises:
            PartError: If the caster cannot be reached, refuses, or falls silent, or the receiver cannot be written to.
        """
        where = f"{self.source.host}:{self.source.port}/{self.source.mountpoint}"
        try:
            async with asyncio.timeout(self._silence_s):
                reader, writer = await asyncio.open_connection(self.source.host, self.source.port, limit=_HEAD_BYTES)
        except (OSError, TimeoutError) as error:
            raise PartError(_PART, f"the caster {where} cannot be reached: {error or 'no answer'}") from error
        try:
            await self._feed(reader, writer, where)
        except TimeoutError:
            raise PartError(_PART, f"the caster {where} has sent nothing for {self._silence_s:g} s") from None
        except (OSError, EOFError, ValueError) as error:
            raise PartError(_PART, f"the caster {where}: {error or type(error).__name__}") from error
        finally:
            writer.close()

    async def _feed(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter, where: str) -> None:
        writer.write(self._request())
        is_chunked = await self._answer(reader, where)
        places = asyncio.create_task(self._send_places(writer))
        try:
            while True:
                async with asyncio.timeout(self._silence_s):
                    data = await (_chunk(reader) if is_chunked else reader.read(_CHUNK_BYTES))
                if not data:
                    return
                self.counts.received_bytes += len(data)
                await self._write(data)
        finally:
            places.cancel()
            await asyncio.gather(places, return_exceptions=True)

    def _request(self) -> bytes:
        lines = [
            f"GET /{self.source.mountpoint} HTTP/1.1",
            f"Host: {self.source.host}:{self.source.port}",
            "Ntrip-Version: Ntrip/2.0",
            f"User-Agent: {_AGENT}",
            "Connection: close",
        ]
        user, password = self._secrets()
        if user or password:
            lines.append(f"Authorization: Basic {_token(user, password)}")
        gga = self._gga().split()
        if gga:
            lines.append(f"Ntrip-GGA: {gga[0].decode('ascii', 'replace')}")
            self.counts.places_sent += 1
        return "\r\n".join([*lines, "", ""]).encode("utf-8")

    def _secrets(self) -> tuple[str, str]:
        return self._environment.get(USER_VARIABLE, ""), self._environment.get(PASSWORD_VARIABLE, "")

    def _scrubbed(self, text: str) -> str:
        """Return what a caster said without what it was told."""
        user, password = self._secrets()
        for secret in (_token(user, password), password, user):
            text = text.replace(secret, "…") if secret else text
        return text

    async def _answer(self, reader: asyncio.StreamReader, where: str) -> bool:
        """Read the caster's answer and return whether the stream comes in chunks.

        Raises:
            PartError: If it is no stream of corrections.
        """
        async with asyncio.timeout(self._silence_s):
            status = (await reader.readline()).decode("latin-1").strip()
            if status.startswith("ICY 200"):
                # Version 1: some casters put an empty line after it, others begin at once.
                return False
            headers = await _headers(reader)
        kind, _, words = status.partition(" ")
        code = words.split(" ")[0]
        if code == "401" or "Bad Password" in status:
            hint = f"set {USER_VARIABLE} and {PASSWORD_VARIABLE} in the environment"
            raise PartError(_PART, f"the caster {where} refuses the user's name or password; {hint}")
        if kind == "SOURCETABLE" or headers.get("content-type", "").startswith("gnss/sourcetable") or code == "404":
            raise PartError(_PART, f"the caster {where} has no stream of that name")
        if not kind.startswith("HTTP/") or code != "200":
            raise PartError(_PART, f"the caster {where} answers {self._scrubbed(status)[:80]!r}")
        return headers.get("transfer-encoding", "").lower() == "chunked"

    async def _send_places(self, writer: asyncio.StreamWriter) -> None:
        while True:
            await asyncio.sleep(self._gga_every_s)
            gga = self._gga()
            if gga:
                writer.write(gga)
                await writer.drain()
                self.counts.places_sent += 1


def _token(user: str, password: str) -> str:
    return base64.b64encode(f"{user}:{password}".encode()).decode("ascii")


async def _headers(reader: asyncio.StreamReader) -> dict[str, str]:
    headers: dict[str, str] = {}
    size = 0
    while line := (await reader.readline()).decode("latin-1").strip():
        size += len(line)
        if size > _HEAD_BYTES:
            raise ValueError("its answer has no end")
        name, _, value = line.partition(":")
        headers[name.strip().lower()] = value.strip()
    return headers


async def _chunk(reader: asyncio.StreamReader) -> bytes:
    """Return the next chunk of a stream, empty at its end."""
    head = (await reader.readline()).split(b";")[0].strip()
    if not head:
        return b""
    size = int(head, 16)
    if not 0 <= size <= 1 << 20:
        raise ValueError(f"a chunk of {size} bytes")
    data = await reader.readexactly(size)
    await reader.readline()
    return data
