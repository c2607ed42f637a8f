"""A receiver's first fix against where a person says that the machine stands; the receiver is a served one."""

import asyncio
from contextlib import aclosing

import pytest

from reasoned_explorer.geometry import GeoOrigin, Pose
from reasoned_explorer.model import PartError
from reasoned_explorer.serving.go1.gnss import GnssServer
from reasoned_explorer.simulation.sensors import sensor_noise
from reasoned_explorer.simulation.walking import SatelliteFix
from reasoned_explorer.vehicles.positioning import Fix, FixQuality, GpsdSource, Receiver
from reasoned_explorer.vehicles.positioning.anchored import AnchoredReceiver

ORIGIN = GeoOrigin(48.1, 11.6)


def fixes_of(told: list[SatelliteFix], start: Pose, *, origin: GeoOrigin = ORIGIN, **more: object) -> list[Fix]:
    """Return what comes of what a receiver says."""

    async def run() -> list[Fix]:
        server = GnssServer(sensor_noise("none"), origin=ORIGIN)
        server.tell(0.0, told[0])
        port, got = await server.start(), []
        receiver = Receiver(GpsdSource("127.0.0.1", port), origin=origin, now_s=lambda: 0.0)
        try:
            async with asyncio.timeout(20.0), aclosing(AnchoredReceiver(receiver, start, **more).fixes()) as fixes:
                async for fix in fixes:
                    got.append(fix)
                    if len(got) == len(told):
                        break
                    server.tell(float(len(got)), told[len(got)])
        finally:
            await server.close()
        return got

    return asyncio.run(run())


def test_fixes_that_begin_near_the_start_pass_as_they_are():
    told = [SatelliteFix(False), SatelliteFix(True, 103.0, 50.0), SatelliteFix(True, 400.0, 50.0)]
    first, second, third = fixes_of(told, Pose(100.0, 50.0))
    assert first.quality is FixQuality.NONE
    assert (second.x_m, second.y_m) == pytest.approx((103.0, 50.0), abs=1e-3)
    assert third.x_m == pytest.approx(400.0, abs=1e-3)  # it went there: only the first one is held against the start


def test_a_start_that_is_elsewhere_is_a_fault():
    with pytest.raises(PartError, match=r"the receiver is at 48\.1.*300 m from the start: see to --start"):
        fixes_of([SatelliteFix(True, 400.0, 50.0)], Pose(100.0, 50.0))


def test_a_world_that_is_elsewhere_is_a_fault():
    with pytest.raises(PartError, match=r"\d{3} km from the start"):
        fixes_of([SatelliteFix(True, 0.0, 0.0)], Pose(0.0, 0.0), origin=GeoOrigin(47.0, 8.0))


def test_where_nothing_is_known_of_the_place_the_first_fix_is_the_start():
    told = [SatelliteFix(True, 400.0, 50.0), SatelliteFix(True, 405.0, 48.0)]
    fixes = fixes_of(told, Pose(10.0, 20.0), origin=GeoOrigin(0.0, 0.0), is_placed=False)
    assert [(fix.x_m, fix.y_m) for fix in fixes] == [
        pytest.approx((10.0, 20.0), abs=1e-3),
        pytest.approx((15.0, 18.0), abs=1e-3),
    ]
