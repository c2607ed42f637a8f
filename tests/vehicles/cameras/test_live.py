"""A camera on the network: GStreamer's RTSP server, in a process of its own."""

import socket
import subprocess
import sys
import time

import numpy as np
import pytest

from reasoned_explorer.clock import RealClock
from reasoned_explorer.model import PartError, SettingsError
from reasoned_explorer.vehicles.cameras import CameraSettings, LiveCamera, parse_camera
from tests.vehicles.cameras.served import BLUE, RED, served_camera

SECRET = "open-sesame"  # noqa: S105 - of a server of the tests
#: A busy machine is no silent camera.
PATIENT = CameraSettings(patience_s=60.0, silence_s=20.0)


def camera(address: str, **settings: float) -> LiveCamera:
    pytest.importorskip("av", reason="PyAV is not installed (the extra `cameras`)")
    return LiveCamera(
        parse_camera(address), now_s=RealClock().now_s, settings=CameraSettings(**settings) if settings else PATIENT
    )


def is_near(picture, colour) -> bool:
    return bool(np.abs(picture.mean(axis=(0, 1)) - colour).max() < 40.0)


@pytest.mark.parametrize("codec", ["jpeg", "vp8", "h264"])
def test_it_gives_what_is_shown_now_and_never_what_was_shown_before(codec):
    with served_camera(codec) as served:
        live = camera(served.address)
        try:
            for colour in (RED, BLUE, RED):
                served.show(colour)
                time.sleep(0.1)  # until the server has heard of it
                picture = live.picture()
                assert picture.dtype == np.uint8
                assert picture.shape[1:] == (320, 3)
                assert is_near(picture, colour)
                assert live.age_s < PATIENT.silence_s
        finally:
            live.close()
    assert live.age_s == float("inf")


def test_a_camera_that_falls_silent_is_a_fault_and_comes_back():
    with served_camera() as served:
        served.show(RED)
        live = camera(served.address, patience_s=30.0)
        try:
            assert is_near(live.picture(), RED)
            served.hang()
            live.settings = CameraSettings(patience_s=1.5)
            time.sleep(0.5)  # what is on its way has come
            with pytest.raises(PartError, match=r"no new picture from rtsp://127.*the last one is \d") as silent:
                live.picture()
            assert silent.value.part == "camera"
            served.go_on()
            served.show(BLUE)
            time.sleep(0.5)
            live.settings = PATIENT
            assert is_near(live.picture(), BLUE)
        finally:
            live.close()


def test_a_password_opens_it_and_is_not_in_what_goes_wrong(monkeypatch):
    with served_camera(password=SECRET) as served:
        served.show(RED)
        monkeypatch.setenv("CAMERA_USER", "user")
        monkeypatch.setenv("CAMERA_PASSWORD", "wrong-one")
        live = camera(served.address, patience_s=4.0)
        with pytest.raises(PartError) as refused:
            live.picture()
        live.close()
        assert "authorization" in str(refused.value).lower()
        assert "wrong-one" not in str(refused.value)
        monkeypatch.setenv("CAMERA_PASSWORD", SECRET)
        live = camera(served.address)
        try:
            assert is_near(live.picture(), RED)
        finally:
            live.close()


@pytest.mark.parametrize(("address", "why"), [("rtsp://127.0.0.1:{port}/x", "refused"), ("/dev/video93", "No such")])
def test_a_camera_that_is_not_there_is_a_fault(address, why):
    with socket.socket() as unused:
        unused.bind(("127.0.0.1", 0))
        live = camera(address.format(port=unused.getsockname()[1]), patience_s=1.0)
        with pytest.raises(PartError, match=why):
            live.picture()
        live.close()
        live.close()


def test_without_its_library_it_says_how_to_get_it():
    code = (
        "import sys; sys.modules['av'] = None\n"
        "from reasoned_explorer.vehicles.cameras import LiveCamera, parse_camera\n"
        "from reasoned_explorer.model import MissingDependencyError\n"
        "try: LiveCamera(parse_camera('/dev/video0'), now_s=lambda: 0.0)\n"
        "except MissingDependencyError as error: print(error)\n"
    )
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "pip install 'reasoned-explorer[cameras]'" in shown.stdout


def test_settings_out_of_range_are_told_all_at_once():
    with pytest.raises(SettingsError) as told:
        CameraSettings(latency_s=-1.0, silence_s=float("nan"))
    assert len(told.value.faults) == 2
