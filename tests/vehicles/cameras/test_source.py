"""Cameras as people write them."""

from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.model import SettingsError
from reasoned_explorer.vehicles.cameras import DeviceSource, RtspSource, parse_camera


@pytest.mark.parametrize(
    ("text", "source"),
    [
        ("/dev/video0", DeviceSource("/dev/video0")),
        ("/dev/v4l/by-id/usb-A_B-video-index0", DeviceSource("/dev/v4l/by-id/usb-A_B-video-index0")),
        ("rtsp://camera.lan", RtspSource("camera.lan")),
        ("rtsp://192.168.1.9:8554/cam/live?channel=1", RtspSource("192.168.1.9", "/cam/live?channel=1", 8554)),
        ("rtsp://[fe80::1]:8554/x", RtspSource("fe80::1", "/x", 8554)),
    ],
)
def test_a_camera_is_read_and_written(text, source):
    assert parse_camera(text) == source
    assert parse_camera(str(source)) == source


@pytest.mark.parametrize(
    "text",
    [
        "",
        "0",
        "/etc/passwd",
        "/dev/video 0",
        "http://camera/x",
        "rtsp://",
        "rtsp://h:0/",
        "rtsp://h:x/",
        "rtsp://h/a b",
    ],
)
def test_what_is_no_camera_is_refused(text):
    with pytest.raises(SettingsError, match="rtsp://HOST"):
        parse_camera(text)


def test_a_password_is_taken_from_the_environment_alone_and_never_shown():
    with pytest.raises(SettingsError, match="CAMERA_PASSWORD") as refused:
        parse_camera("rtsp://me:secret@camera/x:y")
    assert "secret" not in str(refused.value)
    source = parse_camera("rtsp://camera/x")
    assert source.url({"CAMERA_USER": "me", "CAMERA_PASSWORD": "se:c/ret"}) == "rtsp://me:se%3Ac%2Fret@camera/x"
    assert source.url({}) == str(source) == "rtsp://camera/x"


@given(st.text(max_size=40))
def test_any_text_is_a_camera_or_refused(text):
    for tried in (text, f"rtsp://{text}", f"/dev/{text}"):
        with suppress(SettingsError):
            source = parse_camera(tried)
            assert parse_camera(str(source)) == source
