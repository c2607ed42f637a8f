"""GStreamer's RTSP server in a process of its own."""

import os
import shutil
import signal
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import TextIO

import pytest

SCRIPT = Path(__file__).with_name("rtsp_server.py")
RED, BLUE = (255, 0, 0), (0, 0, 255)
#: Debian's Python has the bindings; the tests' own need not.
_PYTHON = "/usr/bin/python3"


@cache
def _can_serve() -> bool:
    if shutil.which(_PYTHON) is None:
        return False
    code = "import gi; gi.require_version('GstRtspServer', '1.0'); from gi.repository import GstRtspServer"
    return subprocess.run([_PYTHON, "-c", code], capture_output=True, check=False, env=_environment()).returncode == 0


def _environment() -> dict[str, str]:
    return {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}


class Camera:
    """A served camera, all of one colour."""

    def __init__(self, process: "subprocess.Popen[str]", told: TextIO, address: str) -> None:
        self._process, self._told, self.address = process, told, address

    def show(self, colour: tuple[int, int, int]) -> None:
        self._told.write("FF{:02X}{:02X}{:02X}\n".format(*colour))
        self._told.flush()

    def hang(self) -> None:
        """Say nothing any more, the connection still open."""
        self._process.send_signal(signal.SIGSTOP)

    def go_on(self) -> None:
        self._process.send_signal(signal.SIGCONT)


@contextmanager
def served_camera(codec: str = "jpeg", *, password: str = "") -> Iterator[Camera]:
    """Serve a camera until the block ends; skips where there is no server."""
    pytest.importorskip("av", reason="PyAV is not installed (the extra `cameras`)")
    if not _can_serve():
        pytest.skip(
            "GStreamer's RTSP server is not here (gir1.2-gst-rtsp-server-1.0, python3-gi, gstreamer1.0-plugins-*)"
        )
    command = [_PYTHON, str(SCRIPT), codec, *([password] if password else [])]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=_environment()
    ) as process:
        assert process.stdin is not None
        assert process.stdout is not None
        port = process.stdout.readline().strip()
        if not port:
            pytest.skip(f"GStreamer cannot encode {codec} here")
        try:
            yield Camera(process, process.stdin, f"rtsp://127.0.0.1:{port}/ahead")
        finally:
            process.kill()  # it may hang, as it was told to
