"""A camera that is read all the time, so that its newest frame is at hand and old ones are thrown away."""

import math
import threading
from collections.abc import Callable
from dataclasses import dataclass
from importlib.util import find_spec
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.model import Fault, MissingDependencyError, PartError, SettingsError
from reasoned_explorer.model.checks import is_within
from reasoned_explorer.vehicles.cameras.source import CameraSource, DeviceSource
from reasoned_explorer.vehicles.cameras.stamping import Stamper

INSTALL = "pip install 'reasoned-explorer[cameras]'"
_PART = "camera"
#: So often a reader that waits looks whether it is to end, or a person who waits whether there is a frame, seconds.
_CHECK_S = 0.1
#: So long whoever closes it waits for its reader, seconds.
_LEAVE_S = 1.0


@dataclass(frozen=True, slots=True)
class CameraSettings:
    """How a camera is read.

    Attributes:
        latency_s: How old what it shows is at least when it comes here: network cameras take some tenths of a second.
            Only a frame that came so long after it was asked for is given.
        patience_s: How long to wait for such a frame, opening the camera included.
        silence_s: A camera that sends nothing for so long is opened anew.
        again_s: How long after it failed.

    Raises:
        SettingsError: If one is out of range.
    """

    latency_s: float = 0.3
    patience_s: float = 10.0
    silence_s: float = 2.0
    again_s: float = 1.0

    def __post_init__(self) -> None:
        ranges = {
            "latency_s": (0.0, 10.0),
            "patience_s": (0.1, 600.0),
            "silence_s": (0.1, 60.0),
            "again_s": (0.05, 60.0),
        }
        faults = [
            Fault(f"{name} = {getattr(self, name)!r:.40}", f"a number in [{low:g}, {high:g}]")
            for name, (low, high) in ranges.items()
            if not is_within(getattr(self, name), low, high)
        ]
        if faults:
            raise SettingsError("camera", faults)


class LiveCamera:
    """A camera. A thread reads it from `open` to `close`, whatever happens to it, and keeps the newest frame alone.

    Args:
        source: Where it is.
        now_s: The time, seconds; `Clock.now_s` of a real clock, whatever clock the mission has.
        settings: How it is read.

    Raises:
        MissingDependencyError: If PyAV is not installed.
    """

    def __init__(
        self, source: CameraSource, *, now_s: Callable[[], float], settings: CameraSettings | None = None
    ) -> None:
        if find_spec("av") is None:
            raise MissingDependencyError(f"the camera {source}", "av", INSTALL)
        self.source, self.settings = source, settings or CameraSettings()
        self._now_s = now_s
        self._fresh = threading.Condition()
        self._frame: Any = None
        self._taken_s = -math.inf
        self._fault = ""
        self._reading: tuple[threading.Thread, threading.Event] | None = None

    @property
    def age_s(self) -> float:
        """Seconds since its newest frame was taken, as far as that is known; infinite before the first."""
        return self._now_s() - self._taken_s

    def open(self) -> None:
        """Begin to read it. Safe to call twice."""
        if self._reading is None:
            is_over = threading.Event()
            thread = threading.Thread(target=self._read_on, args=(is_over,), name="camera", daemon=True)
            self._reading = thread, is_over
            thread.start()

    def close(self) -> None:
        """Let it go. Safe to call twice."""
        reading, self._reading = self._reading, None
        if reading is not None:
            reading[1].set()
            # One that hears nothing ends by itself when it has been silent for long enough, and keeps nothing more.
            reading[0].join(_LEAVE_S)
        with self._fresh:
            self._frame, self._taken_s = None, -math.inf

    def picture(self) -> NDArray[np.uint8]:
        """Return what it shows now, RGB, shape (height, width, 3); never what it showed before it was asked.

        It may wait: call it in a thread of its own.

        Raises:
            PartError: If no such frame comes in time.
        """
        asked_s = self._now_s()
        self.open()
        with self._fresh:
            while self._taken_s < asked_s + self.settings.latency_s:
                if self._now_s() - asked_s > self.settings.patience_s:
                    raise PartError(_PART, self._silence())
                self._fresh.wait(_CHECK_S)
            frame = self._frame
        image: NDArray[np.uint8] = frame.to_ndarray(format="rgb24")
        return image

    def _silence(self) -> str:
        age_s = self.age_s
        since = "" if math.isinf(age_s) else f", the last one is {age_s:.1f} s old"
        why = f": {self._fault}" if self._fault else ""
        return f"no new picture from {self.source} within {self.settings.patience_s:g} s{since}{why}"

    # In the thread.

    def _read_on(self, is_over: threading.Event) -> None:
        import av

        while not is_over.is_set():
            try:
                self._fault = self._read(is_over)
            except (av.FFmpegError, OSError, ValueError, LookupError) as error:
                # The whole text of FFmpeg's errors holds the address, with the password.
                self._fault = str(getattr(error, "strerror", None) or type(error).__name__)
            is_over.wait(self.settings.again_s)

    def _read(self, is_over: threading.Event) -> str:
        """Read it until it ends; return why it did."""
        import av

        options = {} if isinstance(self.source, DeviceSource) else {"rtsp_transport": "tcp"}
        limits_s = self.settings.silence_s + 3.0, self.settings.silence_s
        with av.open(
            self.source.url(), format=self.source.format, options={**options, "fflags": "nobuffer"}, timeout=limits_s
        ) as container:
            if not container.streams.video:
                return "there is no video in it"
            stream, stamper = container.streams.video[0], Stamper()
            stream.thread_type = "SLICE"  # threads for whole frames would hold back as many
            for packet in container.demux(stream):
                if is_over.is_set():
                    return ""
                try:
                    frames = packet.decode()
                except av.InvalidDataError:
                    continue  # a part was lost on the way; the next whole picture is not far
                for frame in frames:
                    self._keep(frame, stamper.taken_s(frame.time, self._now_s()), is_over)
        return "the stream has ended"

    def _keep(self, frame: Any, taken_s: float, is_over: threading.Event) -> None:
        with self._fresh:
            if is_over.is_set():
                return
            self._frame, self._taken_s = frame, taken_s
            self._fault = ""
            self._fresh.notify_all()
