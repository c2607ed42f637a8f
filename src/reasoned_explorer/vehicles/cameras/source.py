"""Where pictures come from, as a person writes it: ``/dev/video0`` or ``rtsp://HOST/PATH``."""

import os
import re
from collections.abc import Mapping
from dataclasses import dataclass
from urllib.parse import quote, urlsplit

from reasoned_explorer.model import Fault, SettingsError

RTSP_PORT = 554
USER_VARIABLE = "CAMERA_USER"
PASSWORD_VARIABLE = "CAMERA_PASSWORD"  # noqa: S105 - a variable's name
_FORMS = "/dev/videoN or rtsp://HOST[:554]/PATH"
_DEVICE = re.compile(r"/dev/[A-Za-z0-9_./-]+")


@dataclass(frozen=True, slots=True)
class DeviceSource:
    """A camera of this computer, by Video4Linux.

    Attributes:
        device: Its file.
    """

    device: str

    def __str__(self) -> str:
        return self.device

    @property
    def format(self) -> str:
        """FFmpeg's name of how it is read."""
        return "v4l2"

    def url(self, environment: Mapping[str, str] = os.environ) -> str:
        """Return what FFmpeg opens."""
        del environment
        return self.device


@dataclass(frozen=True, slots=True)
class RtspSource:
    """A camera on the network. As text it never holds a user's name or password.

    Attributes:
        host: The camera.
        path: Which of its streams, with the slash before it and the query behind it.
        port: Its port.
    """

    host: str
    path: str = "/"
    port: int = RTSP_PORT

    def __str__(self) -> str:
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"rtsp://{host}{'' if self.port == RTSP_PORT else f':{self.port}'}{self.path}"

    @property
    def format(self) -> str:
        """FFmpeg's name of how it is read."""
        return "rtsp"

    def url(self, environment: Mapping[str, str] = os.environ) -> str:
        """Return what FFmpeg opens, with the user's name and password of the environment; never to be shown."""
        user, password = environment.get(USER_VARIABLE, ""), environment.get(PASSWORD_VARIABLE, "")
        secret = f"{quote(user, safe='')}:{quote(password, safe='')}@" if user or password else ""
        return str(self).replace("rtsp://", f"rtsp://{secret}", 1)


CameraSource = DeviceSource | RtspSource


def parse_camera(text: str) -> CameraSource:
    """Return where pictures come from.

    >>> parse_camera("/dev/video0")
    DeviceSource(device='/dev/video0')
    >>> parse_camera("rtsp://192.168.1.9/front")
    RtspSource(host='192.168.1.9', path='/front', port=554)

    Raises:
        SettingsError: If it is written wrongly, with all faults.
    """
    if text.startswith("/"):
        if not _DEVICE.fullmatch(text):
            raise SettingsError("camera", [Fault(f"{text!r:.80}", _FORMS)])
        return DeviceSource(text)
    faults = []
    # What may be a password is not shown.
    shown = text if "@" not in text else f"rtsp://…@{text.rpartition('@')[2]}"
    if "@" in text:
        hint = f"put them into the environment: {USER_VARIABLE} and {PASSWORD_VARIABLE}"
        faults.append(Fault("the address holds a user's name or password", _FORMS, hint))
    host, port, path = "", RTSP_PORT, "/"
    try:
        parts = urlsplit(text)
        host, path = parts.hostname or "", parts.path or "/"
        path += f"?{parts.query}" if parts.query else ""
        port = RTSP_PORT if parts.port is None else parts.port
        is_one = parts.scheme == "rtsp" and bool(host) and not parts.fragment
    except ValueError:  # a port that is none, or brackets that do not match
        is_one = False
    if not is_one or port == 0 or any(letter.isspace() or not letter.isprintable() for letter in text):
        faults.append(Fault(f"{shown!r:.80}", _FORMS))
    if faults:
        raise SettingsError("camera", faults)
    return RtspSource(host, path, port)
