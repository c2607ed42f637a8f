"""The operator's stop: a switch that anything may press at any moment, and a keyboard that presses it."""

import os
import select
import sys
import threading
from collections.abc import Callable
from contextlib import suppress
from types import TracebackType
from typing import Any, Self

from reasoned_explorer.model import Fault, SettingsError

#: Space, Escape, q and s.
STOP_KEYS = " \x1bqs"


class OperatorStop:
    """A switch that stays pressed until a person releases it. Safe to press from any thread or signal handler."""

    def __init__(self) -> None:
        self._why: str | None = None
        #: Whether something listens that a person can reach: a keyboard, a button.
        self.is_reachable = False

    @property
    def pressed(self) -> bool:
        """Whether the machine must stand."""
        return self._why is not None

    @property
    def why(self) -> str:
        """Who pressed it, or what for; empty where it is not pressed."""
        return self._why or ""

    def press(self, why: str = "stopped by the operator") -> None:
        """Have the machine stop now. The first reason is kept."""
        if self._why is None:
            self._why = why

    def release(self) -> None:
        """Let the machine go on."""
        self._why = None


class KeyboardListener:
    """Presses a stop where a key is pressed on a terminal; a context manager.

    The terminal gives single keys meanwhile, unshown, and is as before afterwards; Ctrl-C stays what it is. A terminal
    that goes away counts as a press: nobody could press any more.

    Args:
        stop: What is pressed.
        keys: Which keys do it.
        on_key: Told every other key, in the listening thread: answers to questions, say.
        fd: The terminal; standard input by default.

    Raises:
        SettingsError: On entering, if that is no terminal, or this system has none of this kind.
    """

    def __init__(
        self,
        stop: OperatorStop,
        *,
        keys: str = STOP_KEYS,
        on_key: Callable[[str], None] | None = None,
        fd: int | None = None,
    ) -> None:
        self._stop, self._keys, self._on_key, self._fd = stop, keys, on_key, fd
        self._thread: threading.Thread | None = None
        self._wake: tuple[int, int] | None = None
        self._before: list[Any] | None = None

    def __enter__(self) -> Self:
        fd = self._terminal()
        import termios
        import tty

        self._before = termios.tcgetattr(fd)
        tty.setcbreak(fd, termios.TCSANOW)
        self._wake = os.pipe()
        self._thread = threading.Thread(
            target=self._listen, args=(fd, self._wake[0]), name="operator stop", daemon=True
        )
        self._thread.start()
        self._stop.is_reachable = True
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        import termios

        self._stop.is_reachable = False
        if self._wake is None or self._thread is None or self._before is None:
            return
        os.write(self._wake[1], b".")
        self._thread.join()
        for end in self._wake:
            os.close(end)
        with suppress(termios.error, OSError, SettingsError):  # a terminal that is gone: there is nothing to set back
            termios.tcsetattr(self._terminal(), termios.TCSANOW, self._before)
        self._wake = self._thread = self._before = None

    def _terminal(self) -> int:
        remedy = "run it in a terminal, or press the stop from elsewhere (OperatorStop.press)"
        try:
            import termios  # noqa: F401 - absent on Windows
        except ModuleNotFoundError as error:
            raise SettingsError("operator stop", [Fault("this system has no POSIX terminal", "one", remedy)]) from error
        try:
            fd = sys.stdin.fileno() if self._fd is None else self._fd
            is_terminal = os.isatty(fd)
        except (OSError, ValueError, AttributeError):
            is_terminal = False
        if not is_terminal:
            raise SettingsError("operator stop", [Fault("there is no keyboard to listen to", "a terminal", remedy)])
        return fd

    def _listen(self, fd: int, wake: int) -> None:
        while True:
            ready, _, _ = select.select([fd, wake], [], [])
            if wake in ready:
                return
            try:
                keys = os.read(fd, 64).decode("utf-8", "replace")
            except OSError:
                keys = ""
            if not keys:
                self._stop.press("the operator's terminal is gone")
                return
            for key in keys:
                if key in self._keys:
                    self._stop.press()
                elif self._on_key is not None:
                    self._on_key(key)
