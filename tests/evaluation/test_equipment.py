"""What a machine has beside its wire, as a person writes it."""

import asyncio
import math
import os
import re
import socket
from contextlib import aclosing

import pytest

from reasoned_explorer.evaluation.equipment import Equipment, read_equipment
from reasoned_explorer.evaluation.vehicle_address import AirSimAddress, Go1Address, MavlinkAddress, equipped
from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Gathering, SettingsError
from reasoned_explorer.vehicles.cameras import RtspSource
from reasoned_explorer.vehicles.mavlink.address import Address, Wire
from reasoned_explorer.vehicles.positioning import Fix, GpsdSource, NtripSource, SerialSource
from tests.vehicles.positioning.sentences import ORIGIN, epoch

GO1 = Go1Address("127.0.0.1")
ROVER = MavlinkAddress(Address(Wire.TCP, "127.0.0.1", 5760), "go1")
CAMERA = RtspSource("camera", "/ahead")


def read(**words: object) -> tuple[Equipment, str]:
    found = Gathering()
    equipment = read_equipment(found, **words)
    return equipment, "\n".join(map(str, found.errors))


def test_what_is_written_is_read():
    words = {"gps": "serial:socket://rover:9", "ntrip": "ntrip://caster/A", "camera": "rtsp://camera/ahead"}
    equipment, wrong = read(**words, camera_fov_deg=120.0)
    assert not wrong
    assert equipment.positions == SerialSource("socket://rover:9")
    assert equipment.corrections == NtripSource("caster", "A")
    assert equipment.camera == CAMERA
    assert equipment.fov_rad == pytest.approx(math.radians(120.0))


@pytest.mark.parametrize(
    ("words", "why"),
    [
        ({"gps": "usb"}, "gpsd://HOST"),
        ({"gps": "serial:/dev/ttyNONE3"}, "there is no /dev/ttyNONE3"),
        ({"camera": "/dev/video93"}, "there is no /dev/video93"),
        ({"camera": "front"}, "rtsp://HOST"),
        ({"ntrip": "ntrip://caster/A"}, "corrections without a receiver"),
        ({"gps": "gpsd://here", "ntrip": "ntrip://caster/A"}, "to gpsd itself"),
        ({"gps": "serial:socket://h:9", "ntrip": "ntrip://me:secret@caster/A"}, "NTRIP_PASSWORD"),
        ({"camera_fov_deg": 90.0}, "of the --camera that is given"),
        ({"camera": "rtsp://camera", "camera_fov_deg": 200.0}, r"degrees in \[10, 170\]"),
    ],
)
def test_what_is_wrong_is_told(words, why):
    _, wrong = read(**words)
    assert re.search(why, wrong)
    assert "secret" not in wrong


def test_all_of_it_is_told_at_once():
    found = Gathering()
    read_equipment(found, gps="usb", ntrip="x", camera="y", camera_fov_deg=0.0)
    assert len(found.errors) == 4


def test_a_go1_needs_a_receiver():
    with pytest.raises(SettingsError, match="--gps gpsd://HOST"):
        equipped(GO1, Equipment())
    equipment = Equipment(positions=GpsdSource("here"), camera=CAMERA)
    assert equipped(GO1, equipment) == Go1Address("127.0.0.1", equipment=equipment)
    assert equipped(GO1, equipment).has_camera


def test_what_a_wire_brings_itself_is_refused_beside_it():
    with pytest.raises(SettingsError, match="over its own wire"):
        equipped(ROVER, Equipment(positions=GpsdSource("here")))
    with pytest.raises(SettingsError, match="pictures come over"):
        equipped(AirSimAddress("127.0.0.1"), Equipment(camera=CAMERA))
    assert not ROVER.has_camera
    assert equipped(ROVER, Equipment(camera=CAMERA)).has_camera
    assert equipped(AirSimAddress("127.0.0.1"), Equipment()) == AirSimAddress("127.0.0.1")


def test_a_caster_that_cannot_be_reached_is_said_once_and_positions_go_on(monkeypatch):
    pytest.importorskip("serial", reason="pyserial is not installed (the extra `vehicles`)")
    pytest.importorskip("pynmea2", reason="pynmea2 is not installed (the extra `vehicles`)")
    monkeypatch.setenv("NTRIP_PASSWORD", "open-sesame")
    near, far = os.openpty()
    said: list[str] = []
    with socket.socket() as unused:
        unused.bind(("127.0.0.1", 0))
        caster = f"ntrip://127.0.0.1:{unused.getsockname()[1]}/A"
        equipment, wrong = read(gps=f"serial:{os.ttyname(far)}:38400", ntrip=caster, say=said.append)
        assert not wrong

        async def run() -> Fix:
            receiver = equipment.receiver(Pose(5.0, 0.0), ORIGIN, lambda: 0.0)
            assert receiver is not None
            async with asyncio.timeout(30.0), aclosing(receiver.fixes()) as fixes:
                first = asyncio.ensure_future(anext(fixes))
                while not said:
                    await asyncio.sleep(0.02)
                os.write(near, epoch(43_201.0, 5.0, 0.0))
                os.write(near, epoch(43_202.0, 6.0, 0.0))
                return await first

        try:
            fix = asyncio.run(run())
        finally:
            os.close(near)
            os.close(far)
    assert fix.x_m == pytest.approx(5.0, abs=0.01)
    assert len(said) == 1
    assert "cannot be reached" in said[0]
    assert "positions go on" in said[0]
    assert "sesame" not in said[0]
