import asyncio
import base64
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager

import pytest

from reasoned_explorer.model import PartError
from reasoned_explorer.vehicles.positioning.ntrip import NtripClient
from reasoned_explorer.vehicles.positioning.source import NtripSource

RTCM = bytes.fromhex("d300133ed7d30202980edeef34b4bd62ac0941986f33360b98")
GGA = b"$GNGGA,000001.00,4827.6,N,12318.6,W,4,18,0.7,30.0,M,-18.0,M,1.0,0000*5E\r\n"
SECRETS = {"NTRIP_USER": "somebody", "NTRIP_PASSWORD": "open-sesame-17"}


class FakeCaster:
    """A fake caster: it keeps what it is asked and sends what a test gives."""

    def __init__(self, *pieces: bytes, waits_for_gga: bool = False, holds: bool = False) -> None:
        self.pieces, self.waits_for_gga, self.holds = pieces, waits_for_gga, holds
        self.request, self.places = b"", b""

    async def answer(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        try:
            await self.feed(reader, writer)
            writer.close()
            await writer.wait_closed()
        except ConnectionError:  # the client had enough
            writer.transport.abort()
        self.done.set()

    async def feed(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self.request = await reader.readuntil(b"\r\n\r\n")
        first, *rest = self.pieces
        writer.write(first)
        if self.waits_for_gga:
            self.places = await reader.readline()
        for piece in rest:
            writer.write(piece)
            await writer.drain()
        if self.holds:
            await reader.read()

    @asynccontextmanager
    async def serving(self) -> AsyncIterator[NtripSource]:
        self.done = asyncio.Event()
        async with await asyncio.start_server(self.answer, "127.0.0.1", 0) as server:
            yield NtripSource("127.0.0.1", "NEAREST", server.sockets[0].getsockname()[1])
            await self.done.wait()


def fed(caster: FakeCaster, **more: float) -> bytes:
    received = bytearray()

    async def write(data: bytes) -> None:
        received.extend(data)

    async def run() -> None:
        async with asyncio.timeout(30.0), caster.serving() as source:
            try:
                await NtripClient(source, write, environment=SECRETS, gga=lambda: GGA, **more).run()
            except PartError as error:
                faults.append(error)

    faults: list[PartError] = []
    asyncio.run(run())
    if faults:
        raise faults[0]
    return bytes(received)


def test_a_caster_of_version_1_feeds_the_receiver():
    caster = FakeCaster(b"ICY 200 OK\r\n", RTCM, RTCM)
    assert fed(caster) == RTCM * 2
    assert caster.request.startswith(b"GET /NEAREST HTTP/1.1\r\n")


def test_a_caster_of_version_2_feeds_the_receiver():
    head = b"HTTP/1.1 200 OK\r\nNtrip-Version: Ntrip/2.0\r\nContent-Type: gnss/data\r\n"
    assert fed(FakeCaster(head + b"\r\n", RTCM)) == RTCM


def test_chunks_are_put_together():
    head = b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n"
    size = f"{len(RTCM):x};note=1\r\n".encode()
    assert fed(FakeCaster(head, size + RTCM + b"\r\n", size + RTCM + b"\r\n0\r\n\r\n")) == RTCM * 2


def test_name_and_password_are_sent_from_the_environment():
    caster = FakeCaster(b"ICY 200 OK\r\n", RTCM)
    fed(caster)
    token = base64.b64encode(b"somebody:open-sesame-17")
    assert b"Authorization: Basic " + token in caster.request
    assert b"Ntrip-Version: Ntrip/2.0" in caster.request


def test_the_receiver_s_place_is_sent_at_once_and_again():
    caster = FakeCaster(b"ICY 200 OK\r\n", RTCM, waits_for_gga=True)
    fed(caster, gga_every_s=0.02)
    assert b"Ntrip-GGA: " + GGA.strip() in caster.request
    assert caster.places == GGA


@pytest.mark.parametrize(
    ("answer", "says"),
    [
        (b"HTTP/1.1 401 Unauthorized\r\n\r\n", "NTRIP_USER and NTRIP_PASSWORD"),
        (b"ERROR - Bad Password\r\n\r\n", "refuses"),
        (b"SOURCETABLE 200 OK\r\n\r\nSTR;A;B", "no stream of that name"),
        (b"HTTP/1.1 200 OK\r\nContent-Type: gnss/sourcetable\r\n\r\n", "no stream of that name"),
        (b"HTTP/1.1 404 Not Found\r\n\r\n", "no stream of that name"),
        (b"HTTP/1.1 503 Busy\r\n\r\n", "503 Busy"),
        (b"\r\n\r\n", "answers ''"),
        (b"x" * 100_000, "caster"),
        (b"HTTP/1.1 200 OK\r\n" + b"a: b\r\n" * 10_000, "no end"),
        (b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\nzz\r\n", "caster"),
        (b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\nffffffff\r\n", "chunk"),
        (b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n10\r\nabc", "caster"),
    ],
)
def test_what_a_caster_refuses_is_told_in_words(answer, says):
    with pytest.raises(PartError) as caught:
        fed(FakeCaster(answer))
    assert says in str(caught.value)


def test_a_caster_that_repeats_the_password_does_not_get_it_into_an_error():
    token = base64.b64encode(b"somebody:open-sesame-17")
    with pytest.raises(PartError) as caught:
        fed(FakeCaster(b"HTTP/1.1 500 no open-sesame-17 " + token + b" for somebody\r\n\r\n"))
    for secret in ("open-sesame-17", token.decode(), "somebody"):
        assert secret not in str(caught.value)


def test_a_caster_that_falls_silent_is_told_of():
    with pytest.raises(PartError, match=r"nothing for 0\.5 s"):
        fed(FakeCaster(b"ICY 200 OK\r\n", RTCM, holds=True), silence_s=0.5)


def test_a_receiver_that_cannot_be_written_to_ends_the_stream():
    caster = FakeCaster(b"ICY 200 OK\r\n", RTCM)

    async def broken(data: bytes) -> None:
        raise PartError("positioning", "the line broke")

    async def run() -> None:
        async with asyncio.timeout(30.0), caster.serving() as source:
            with pytest.raises(PartError, match="the line broke"):
                await NtripClient(source, broken, environment={}).run()

    asyncio.run(run())
    assert b"Authorization" not in caster.request


def test_a_caster_that_is_not_there_is_told_in_words():
    async def write(data: bytes) -> None:
        pass

    async def run() -> None:
        server = await asyncio.start_server(lambda *_: None, "127.0.0.1", 0)
        port = server.sockets[0].getsockname()[1]
        server.close()
        await server.wait_closed()
        with pytest.raises(PartError, match="cannot be reached"):
            await NtripClient(NtripSource("127.0.0.1", "A", port), write, environment={}).run()

    asyncio.run(run())
