import asyncio
import json
import math
from collections.abc import Awaitable, Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.clock import RealClock
from reasoned_explorer.model import PartError
from reasoned_explorer.vehicles.positioning.fix import Fix, FixQuality
from reasoned_explorer.vehicles.positioning.gpsd import GpsdReader, gpsd_fixes
from tests.vehicles.positioning.sentences import ORIGIN

# As gpsd 3.22 sent it.
TPV = {
    "class": "TPV",
    "device": "/dev/pts/1",
    "status": 3,
    "mode": 3,
    "time": "2026-11-27T10:00:05.400Z",
    "ept": 0.005,
    "lat": 48.460026978,
    "lon": -123.309941590,
    "track": 90.0,
    "speed": 0.8,
    "eph": 13.3,
}
GST = {"class": "GST", "device": "/dev/pts/1", "rms": 1.0, "lat": 0.02, "lon": 0.02, "alt": 0.03}
SKY = {"class": "SKY", "hdop": 0.7, "satellites": [{"PRN": 1, "used": True}, {"PRN": 2, "used": False}]}


def read(*reports: object) -> list[Fix]:
    reader = GpsdReader(ORIGIN)
    fixes = (reader.take(json.dumps(report).encode(), time_s=0.1 * number) for number, report in enumerate(reports))
    return [fix for fix in fixes if fix is not None]


def test_a_report_is_a_fix():
    (fix,) = read(SKY, GST, TPV)
    assert (fix.lat_deg, fix.lon_deg) == (48.460026978, -123.30994159)
    assert (fix.x_m, fix.y_m) == pytest.approx((4.32, 3.0), abs=0.01)
    assert fix.quality is FixQuality.FIXED
    assert (fix.speed_mps, fix.course_rad) == (0.8, pytest.approx(math.pi / 2))
    assert (fix.sigma_m, fix.hdop, fix.satellites) == (pytest.approx(0.02), 0.7, 1)
    assert fix.utc_of_day_s == pytest.approx(36005.4)
    assert fix.time_s == pytest.approx(0.2)


@pytest.mark.parametrize(
    ("status", "quality"),
    [
        (None, FixQuality.SINGLE),
        (1, FixQuality.SINGLE),
        (2, FixQuality.DGPS),
        (3, FixQuality.FIXED),
        (4, FixQuality.FLOAT),
        (5, FixQuality.NONE),
        (8, FixQuality.NONE),
        ("3", FixQuality.NONE),
    ],
)
def test_the_quality_is_the_status(status, quality):
    report = {name: value for name, value in TPV.items() if name != "status"}
    (fix,) = read(report if status is None else {**report, "status": status})
    assert fix.quality is quality


@pytest.mark.parametrize("mode", [0, 1, None, "3"])
def test_without_a_mode_of_two_or_three_there_is_no_fix(mode):
    (fix,) = read({**TPV, "mode": mode})
    assert fix.quality is FixQuality.NONE


def test_gpsd_s_own_guess_of_the_error_is_not_taken_for_the_receiver_s():
    (fix,) = read(TPV)
    assert fix.sigma_m is None


def test_error_figures_that_are_old_are_not_used():
    reader = GpsdReader(ORIGIN)
    reader.take(json.dumps(GST).encode(), time_s=0.0)
    fix = reader.take(json.dumps(TPV).encode(), time_s=60.0)
    assert fix is not None
    assert fix.sigma_m is None


@given(st.binary(max_size=200))
def test_garbage_never_raises_and_is_never_a_fix(line):
    assert GpsdReader(ORIGIN).take(line, time_s=0.0) is None


ANY = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=6,
)


@given(
    st.lists(
        st.tuples(st.sampled_from([TPV, GST, SKY]), st.dictionaries(st.sampled_from([*TPV, *GST, *SKY]), ANY)),
        max_size=5,
    )
)
def test_reports_with_wrong_values_never_raise_and_never_give_a_place_that_cannot_be(reports):
    reader = GpsdReader(ORIGIN)
    for whole, spoilt in reports:
        fix = reader.take(json.dumps({**whole, **spoilt}).encode(), time_s=0.0)
        if fix is not None and fix.quality is not FixQuality.NONE:
            assert math.isfinite(fix.x_m + fix.y_m)
            assert abs(fix.lat_deg) <= 90.0


class FakeGpsd:
    """A fake gpsd: waits for a watcher, sends it what a test gives, and goes away."""

    def __init__(self, *pieces: bytes) -> None:
        self.pieces, self.asked = pieces, b""
        self.done = asyncio.Event()

    async def answer(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self.asked = await reader.readline()
        for piece in self.pieces:
            writer.write(piece)
            await writer.drain()
        writer.close()
        await writer.wait_closed()
        self.done.set()


def with_fake(fake: FakeGpsd, test: Callable[[int, Callable[[], float]], Awaitable[None]]) -> None:
    clock = RealClock()

    async def run() -> None:
        server = await asyncio.start_server(fake.answer, "127.0.0.1", 0)
        async with server:
            await test(server.sockets[0].getsockname()[1], clock.now_s)
            await fake.done.wait()

    clock.run(run())


def test_fixes_come_over_the_wire_until_gpsd_goes_away():
    line = json.dumps(TPV).encode() + b"\r\n"
    fake = FakeGpsd(b'{"class":"VERSION"}\r\nno json\r\n' + line[:40], line[40:], b"x" * 200_000 + b"\r\n", line)
    fixes = []

    async def test(port: int, now_s: Callable[[], float]) -> None:
        stream = gpsd_fixes("127.0.0.1", port, origin=ORIGIN, now_s=now_s)
        fixes.extend([await anext(stream), await anext(stream)])
        with pytest.raises(PartError, match="closed the connection"):
            await anext(stream)

    with_fake(fake, test)
    assert [fix.quality for fix in fixes] == [FixQuality.FIXED] * 2
    assert b'"json":true' in fake.asked


def test_a_gpsd_that_is_not_there_is_told_in_words():
    async def run() -> None:
        server = await asyncio.start_server(lambda *_: None, "127.0.0.1", 0)
        port = server.sockets[0].getsockname()[1]
        server.close()
        await server.wait_closed()
        with pytest.raises(PartError, match="cannot be reached"):
            await anext(gpsd_fixes("127.0.0.1", port, origin=ORIGIN, now_s=lambda: 0.0))

    asyncio.run(run())
