import asyncio
import math
import os
import shutil
import signal
import socket
import subprocess
from contextlib import aclosing, suppress
from pathlib import Path

import pytest

from reasoned_explorer.clock import RealClock
from reasoned_explorer.geometry import bearing_between_rad
from reasoned_explorer.model import PartError, SettingsError
from reasoned_explorer.vehicles.positioning.fix import Fix, FixQuality
from reasoned_explorer.vehicles.positioning.localizer import Localizer
from reasoned_explorer.vehicles.positioning.measurements import CompassReading, ImuSample, OdometryReading
from reasoned_explorer.vehicles.positioning.receiver import Receiver
from reasoned_explorer.vehicles.positioning.source import GpsdSource, NtripSource, SerialSource
from tests.vehicles.positioning.drives import TICK_HZ, TRUTHS, readings, walk
from tests.vehicles.positioning.sentences import ORIGIN, epoch
from tests.vehicles.positioning.test_ntrip import RTCM, FakeCaster

#: What gpsfake waits between two sentences, seconds; gpsd is busy with each.
PAUSE_S = 0.01
NOON_S = 12.0 * 3600.0


def test_a_receiver_behind_gpsd_is_not_fed_with_corrections():
    with pytest.raises(SettingsError, match="give the caster's address to gpsd"):
        Receiver(GpsdSource("here"), origin=ORIGIN, now_s=lambda: 0.0, corrections=NtripSource("caster", "A"))


def test_a_receiver_on_a_line_gives_fixes_and_is_fed_with_corrections(monkeypatch):
    pytest.importorskip("serial", reason="pyserial is not installed (the extra `vehicles`)")
    pytest.importorskip("pynmea2", reason="pynmea2 is not installed (the extra `vehicles`)")
    monkeypatch.delenv("NTRIP_USER", raising=False)
    near, far = os.openpty()
    device = os.ttyname(far)
    clock, caster, faults = RealClock(), FakeCaster(b"ICY 200 OK\r\n", RTCM), []

    async def run() -> list[Fix]:
        async with asyncio.timeout(30.0), caster.serving() as caster_source:
            receiver = Receiver(
                SerialSource(device),
                origin=ORIGIN,
                now_s=clock.now_s,
                corrections=caster_source,
                on_fault=faults.append,
                first_pause_s=30.0,
            )
            async with aclosing(receiver.fixes()) as stream:
                first = asyncio.ensure_future(anext(stream))
                assert await asyncio.to_thread(os.read, near, 100) == RTCM
                for second in range(1, 4):
                    os.write(near, epoch(NOON_S + second, 5.0 * second, 0.0))
                return [await first, await anext(stream), await anext(stream)]

    try:
        fixes = clock.run(run())
    finally:
        os.close(near)
        os.close(far)
    assert [round(fix.x_m) for fix in fixes] == [5, 10, 15]
    assert [fix.quality for fix in fixes] == [FixQuality.FIXED] * 3
    assert faults == []


def test_fixes_go_on_when_the_caster_fails_and_it_is_asked_again(monkeypatch):
    pytest.importorskip("serial", reason="pyserial is not installed (the extra `vehicles`)")
    pytest.importorskip("pynmea2", reason="pynmea2 is not installed (the extra `vehicles`)")
    near, far = os.openpty()
    device = os.ttyname(far)
    clock, faults = RealClock(), []

    async def run() -> None:
        async with asyncio.timeout(30.0):
            server = await asyncio.start_server(lambda *_: None, "127.0.0.1", 0)
            port = server.sockets[0].getsockname()[1]
            server.close()
            await server.wait_closed()
            receiver = Receiver(
                SerialSource(device),
                origin=ORIGIN,
                now_s=clock.now_s,
                corrections=NtripSource("127.0.0.1", "A", port),
                on_fault=faults.append,
                first_pause_s=0.01,
            )
            async with aclosing(receiver.fixes()) as stream:
                waiting = asyncio.ensure_future(anext(stream))
                while len(faults) < 2:
                    await asyncio.sleep(0.01)
                os.write(near, epoch(NOON_S, 1.0, 0.0) + epoch(NOON_S + 1.0, 2.0, 0.0))
                assert round((await waiting).x_m) == 1

    try:
        clock.run(run())
    finally:
        os.close(near)
        os.close(far)
    assert all(isinstance(fault, PartError) for fault in faults)


def _free_port() -> int:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        return int(free.getsockname()[1])


@pytest.fixture
def gpsfake() -> str:
    found = shutil.which("gpsfake")
    if found is None or not (shutil.which("gpsd") or Path("/usr/sbin/gpsd").exists()):
        pytest.skip("no gpsd here (Debian: gpsd and gpsd-clients)")
    return found


async def _replayed(gpsfake: str, log: Path, until_s: float) -> list[Fix]:
    """Return the fixes of a real gpsd that is fed with a log, up to a time of day."""
    port = _free_port()
    environment = {**os.environ, "PATH": f"{os.environ.get('PATH', '')}:/usr/sbin"}
    process = await asyncio.create_subprocess_exec(
        *(gpsfake, "-1", "-q", "-c", str(PAUSE_S), "-P", str(port), str(log)),
        env=environment,
        start_new_session=True,  # its gpsd ends with it
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    fixes: list[Fix] = []
    try:
        async with asyncio.timeout(120.0):
            while not fixes:
                receiver = Receiver(GpsdSource("127.0.0.1", port), origin=ORIGIN, now_s=lambda: 0.0)
                try:
                    async with aclosing(receiver.fixes()) as stream:
                        async for fix in stream:
                            fixes.append(fix)
                            if (fix.utc_of_day_s or 0.0) >= until_s:
                                break
                except PartError:  # not there yet, or gone after the last sentence
                    await asyncio.sleep(0.1)
    finally:
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGTERM)
        await process.wait()
    return fixes


def test_the_filter_follows_what_a_real_gpsd_makes_of_a_receiver_s_sentences(gpsfake: str, tmp_path: Path):
    """First single, then float, then fixed, as a receiver gets its corrections; half of the time it walks."""
    path, step = walk(60.0), 10
    said: dict[int, Fix] = {}
    for number, name in enumerate(("single", "RTK float", "RTK fixed")):
        for one in readings(path, TRUTHS[name], number):
            if isinstance(one, Fix) and 20.0 * number <= one.time_s < 20.0 * (number + 1):
                said[round(one.time_s * TICK_HZ)] = one
    told = {FixQuality.SINGLE: 1, FixQuality.FLOAT: 5, FixQuality.FIXED: 4}
    log = tmp_path / "walk.nmea"
    log.write_bytes(
        b"".join(
            epoch(
                NOON_S + fix.time_s,
                fix.x_m,
                fix.y_m,
                speed_mps=fix.speed_mps or 0.0,
                course_rad=fix.course_rad or 0.0,
                quality=told[fix.quality],
                sigma_m=fix.sigma_m or 0.0,
            )
            for fix in said.values()
        )
    )
    fixes = asyncio.run(_replayed(gpsfake, log, NOON_S + 59.5))
    # gpsd needs some sentences to know what it hears; the rest comes through.
    assert len(fixes) > 0.8 * len(said)
    assert {fix.quality for fix in fixes} >= {FixQuality.SINGLE, FixQuality.FLOAT, FixQuality.FIXED}

    localizer, heard = Localizer(), {}
    for fix in fixes:
        if fix.utc_of_day_s is not None:  # gpsd does not know the time at first
            heard[round((fix.utc_of_day_s - NOON_S) * TICK_HZ)] = fix
    offs, headings = [], []
    for tick in range(len(path.x_m)):
        t = tick / TICK_HZ
        localizer.take(ImuSample(t, float(path.rate_radps[tick])))
        if tick % step == 0:
            localizer.take(OdometryReading(t, float(path.forward_mps[tick])))
            localizer.take(CompassReading(t, float(path.heading_rad[tick])))
        if tick in heard:
            # Replayed faster than it happened: it counts for when it was made.
            values = {name: getattr(heard[tick], name) for name in Fix.__slots__}
            localizer.take(Fix(**{**values, "time_s": t}))
        if t > 45.0 and tick % step == 0:
            there = localizer.at(t)
            assert there.estimate is not None
            offs.append(there.estimate.pose.distance_to_m(float(path.x_m[tick]), float(path.y_m[tick])))
            headings.append(bearing_between_rad(float(path.heading_rad[tick]), there.estimate.pose.heading_rad))
    assert there.verdict.is_good
    assert there.quality is FixQuality.FIXED
    assert max(offs) < 0.1
    assert max(map(abs, headings)) < math.radians(3.0)
    assert localizer.counts.fixes_refused <= 3
