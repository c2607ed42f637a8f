"""The served receiver over real sockets, read by the drivers of real ones."""

import asyncio
import math
from contextlib import aclosing

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reasoned_explorer.geometry.frames import NOWHERE
from reasoned_explorer.model import SettingsError
from reasoned_explorer.serving.go1.gnss import GnssServer
from reasoned_explorer.simulation.sensors import sensor_noise
from reasoned_explorer.simulation.walking import SatelliteFix
from reasoned_explorer.vehicles.positioning import FixQuality, Receiver, parse_source
from reasoned_explorer.vehicles.positioning.gpsd import GpsdReader
from reasoned_explorer.vehicles.positioning.nmea import NmeaReader

FIX = SatelliteFix(True, 12.345, -67.891, 0.5, -0.25)


def read(server: GnssServer, fix: SatelliteFix):
    """Return what the drivers make of a fix."""
    first, second = server._message(1.0, fix), server._message(1.2, fix)
    if server.dialect == "nmea":
        pytest.importorskip("pynmea2")
        reader = NmeaReader(server.origin)
        return (reader.feed(first, time_s=1.0) + reader.feed(second, time_s=1.2))[0]
    gpsd = GpsdReader(server.origin)
    return next(fix for line in first.splitlines() if (fix := gpsd.take(line, time_s=1.0)) is not None)


@pytest.mark.parametrize("dialect", ["gpsd", "nmea"])
@given(
    x_m=st.floats(-3000.0, 3000.0),
    y_m=st.floats(-3000.0, 3000.0),
    vx_mps=st.floats(-3.0, 3.0),
    vy_mps=st.floats(-3.0, 3.0),
)
@settings(max_examples=40, deadline=None)
def test_any_place_comes_through_to_the_millimetre(dialect, x_m, y_m, vx_mps, vy_mps):
    server = GnssServer(sensor_noise("rtk-fixed"), dialect=dialect)
    fix = read(server, SatelliteFix(True, x_m, y_m, vx_mps, vy_mps))
    assert (fix.x_m, fix.y_m) == pytest.approx((x_m, y_m), abs=0.002)
    assert fix.speed_mps == pytest.approx(math.hypot(vx_mps, vy_mps), abs=1e-3)
    assert fix.quality is FixQuality.FIXED
    assert fix.sigma_m == pytest.approx(0.0172, abs=1e-3)


@pytest.mark.parametrize("dialect", ["gpsd", "nmea"])
@pytest.mark.parametrize(
    ("noise", "quality"), [("rtk-float", FixQuality.FLOAT), ("single", FixQuality.SINGLE), ("none", FixQuality.FIXED)]
)
def test_quality_is_that_of_the_noise(dialect, noise, quality):
    assert read(GnssServer(sensor_noise(noise), dialect=dialect), FIX).quality is quality


@pytest.mark.parametrize("dialect", ["gpsd", "nmea"])
def test_no_fix_is_told_as_none(dialect):
    server = GnssServer(sensor_noise("single"), dialect=dialect)
    assert read(server, SatelliteFix(has_fix=False)).quality is FixQuality.NONE


def test_whoever_connects_is_greeted_with_the_last_fix_and_counted_from_there():
    async def run():
        server = GnssServer(sensor_noise("none"))
        server.tell(0.0, FIX)
        port = await server.start()
        assert server.sent == 0
        receiver = Receiver(parse_source(f"gpsd://127.0.0.1:{port}"), origin=NOWHERE, now_s=lambda: 7.0)
        async with aclosing(receiver.fixes()) as fixes:
            first = await anext(fixes)
            assert server.sent == 1
            server.tell(0.2, SatelliteFix(True, 1.0, 2.0))
            second = await anext(fixes)
            assert server.sent == 2
        await server.close()
        return first, second

    first, second = asyncio.run(run())
    assert (first.x_m, first.y_m) == pytest.approx((12.345, -67.891), abs=0.002)
    assert (second.x_m, second.y_m) == pytest.approx((1.0, 2.0), abs=0.002)


@given(request=st.binary(max_size=6000))
@settings(max_examples=25, deadline=None)
def test_any_request_is_answered_or_ends_its_connection_and_others_go_on(request):
    async def run():
        server = GnssServer(sensor_noise("none"))
        server.tell(0.0, FIX)
        port = await server.start()
        _, writer = await asyncio.open_connection("127.0.0.1", port)
        writer.write(request)
        writer.write(b"\n")
        writer.write_eof()
        receiver = Receiver(parse_source(f"gpsd://127.0.0.1:{port}"), origin=NOWHERE, now_s=lambda: 7.0)
        async with asyncio.timeout(60.0), aclosing(receiver.fixes()) as fixes:
            assert (await anext(fixes)).quality is FixQuality.FIXED
        writer.close()
        await server.close()

    asyncio.run(run())


def test_another_dialect_is_refused():
    with pytest.raises(SettingsError, match="nmea or gpsd"):
        GnssServer(sensor_noise("none"), dialect="morse")
