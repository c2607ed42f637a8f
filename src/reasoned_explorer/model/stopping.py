"""Stopping when a person (Ctrl-C) or a machine that ends programs (SIGTERM) asks for it, where stopping is safe.

Python raises `KeyboardInterrupt` between any two instructions, also between those that compiled code calls back for;
there it comes out as another error, or is lost. While a program listens (`listening`), the first request is therefore
only noted, and work that takes long asks at its safe places (`stop_if_asked`) or is called back (`on_stop`). The
second request stops at once, wherever the work is. Where nobody listens, nothing here changes what Python does.
"""

import signal
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any


class _Requests:
    def __init__(self) -> None:
        self.count = 0
        self.waiting = False
        self.callbacks: list[Callable[[], object]] = []


_requests = _Requests()
#: What asks to stop, and what it does in a program that does not listen.
_SIGNALS: Mapping[signal.Signals, Any] = {signal.SIGINT: signal.default_int_handler, signal.SIGTERM: signal.SIG_DFL}


def listen() -> None:
    """Listen until the process ends.

    Nothing happens in threads other than the main one, and where a signal means something else already.
    """
    if threading.current_thread() is not threading.main_thread():
        return
    for number, default in _SIGNALS.items():
        if signal.getsignal(number) is default:
            signal.signal(number, _note)


def end_listening() -> None:
    """Have requests ignored from here on: all is done, and the process is about to end by itself."""
    for number in _SIGNALS:
        if signal.getsignal(number) is _note:
            signal.signal(number, signal.SIG_IGN)


@contextmanager
def listening() -> Iterator[None]:
    """Listen within a ``with`` block, and begin it without earlier requests unless somebody listened already."""
    if signal.getsignal(signal.SIGINT) is _note:
        yield
        return
    _requests.count, _requests.waiting = 0, False
    listen()
    try:
        yield
    finally:
        for number, default in _SIGNALS.items():
            if signal.getsignal(number) is _note:
                signal.signal(number, default)


def stop_if_asked() -> None:
    """Stop here if a person asked for it: a safe place. Each request stops once, so that what is begun can be ended.

    Raises:
        KeyboardInterrupt: If stopping was asked for.
    """
    if _requests.waiting:
        _requests.waiting = False
        raise KeyboardInterrupt


def stop_was_asked() -> bool:
    """Return whether a person has asked to stop since listening began."""
    return _requests.count > 0


@contextmanager
def on_stop(callback: Callable[[], object]) -> Iterator[None]:
    """Have a request within a ``with`` block, or one that waits already, call something that brings the work to an end.

    Args:
        callback: Called between any two instructions of the main thread; it must neither wait nor raise.
    """
    _requests.callbacks.append(callback)
    try:
        if _requests.waiting:
            callback()
        yield
    finally:
        _requests.callbacks.remove(callback)


def _note(_number: int, _frame: object) -> None:
    _requests.count += 1
    if _requests.count > 1:
        raise KeyboardInterrupt
    _requests.waiting = True
    for callback in tuple(_requests.callbacks):
        callback()
