import asyncio
import os
from collections.abc import Awaitable, Callable

import pytest

from reasoned_explorer.model import MissingDependencyError, PartError
from reasoned_explorer.vehicles.positioning import serial_port
from reasoned_explorer.vehicles.positioning.nmea import NmeaReader
from reasoned_explorer.vehicles.positioning.serial_port import SerialPort
from tests.vehicles.positioning.sentences import ORIGIN, epoch

pytest.importorskip("serial", reason="pyserial is not installed (the extra `vehicles`)")
pytest.importorskip("pynmea2", reason="pynmea2 is not installed (the extra `vehicles`)")


def with_line(test: Callable[[int, SerialPort], Awaitable[None]]) -> None:
    """Run a test with a pseudo terminal, whose near end is the receiver."""
    if not hasattr(os, "openpty"):
        pytest.skip("no pseudo terminals here")
    near, far = os.openpty()

    async def run() -> None:
        async with asyncio.timeout(30.0), SerialPort(os.ttyname(far), baud=38400) as port:
            await test(near, port)

    try:
        asyncio.run(run())
    finally:
        os.close(near)
        os.close(far)


def test_a_receiver_on_a_line_is_read():
    async def test(near: int, port: SerialPort) -> None:
        reader, fixes = NmeaReader(ORIGIN), []
        for second in range(1, 4):
            os.write(near, epoch(float(second), float(second), 0.0))
        async for chunk in port.chunks():
            fixes += reader.feed(chunk, time_s=0.0)
            if len(fixes) == 3:
                break
        assert [round(fix.x_m) for fix in fixes] == [1, 2, 3]

    with_line(test)


def test_corrections_go_out_while_a_read_waits():
    async def test(near: int, port: SerialPort) -> None:
        chunks = port.chunks()
        waiting = asyncio.ensure_future(anext(chunks))
        await asyncio.sleep(0.01)
        await port.write(b"\xd3\x00\x13")
        assert await asyncio.to_thread(os.read, near, 3) == b"\xd3\x00\x13"
        os.write(near, b"$\n")
        assert await waiting in (b"$", b"$\n")
        await chunks.aclose()

    with_line(test)


def test_closing_twice_is_safe_and_a_closed_line_takes_nothing():
    async def test(near: int, port: SerialPort) -> None:
        await port.close()
        await port.close()
        assert [chunk async for chunk in port.chunks()] == []
        with pytest.raises(PartError, match="not open"):
            await port.write(b"x")

    with_line(test)


def test_a_device_that_is_not_there_is_told_in_words():
    async def run() -> None:
        with pytest.raises(PartError, match="ttyNOWHERE"):
            await SerialPort("/dev/ttyNOWHERE", baud=38400).open()

    asyncio.run(run())


def test_a_line_that_breaks_is_told_in_words():
    near, far = os.openpty()
    name = os.ttyname(far)

    async def run() -> None:
        async with asyncio.timeout(30.0), SerialPort(name, baud=38400) as port:
            os.close(far)
            os.close(near)
            with pytest.raises(PartError, match="serial line"):
                async for _ in port.chunks():
                    pass

    asyncio.run(run())


def test_without_the_library_the_command_that_installs_it_is_said(monkeypatch):
    monkeypatch.setattr(serial_port, "find_spec", lambda _: None)

    async def run() -> None:
        with pytest.raises(MissingDependencyError, match=r"reasoned-explorer\[vehicles\]"):
            await SerialPort("/dev/ttyUSB1", baud=38400).open()

    asyncio.run(run())
