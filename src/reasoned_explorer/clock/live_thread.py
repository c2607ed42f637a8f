"""The one real event loop of the process, in a thread of its own, where calls to the outside run.

It lives as long as the process, so that an HTTP client made in it keeps its connections from mission to mission,
whatever clock a mission runs on. How long a call took is measured in it, so that what else the process is at, between
the call's being wanted and its being begun or between its end and its being noticed, is not counted.
"""

import asyncio
import atexit
import os
import threading
import time
from collections.abc import Callable, Coroutine
from concurrent.futures import CancelledError, Future
from typing import Any, TypeVar

from reasoned_explorer.model.errors import PartError
from reasoned_explorer.model.stopping import on_stop, stop_if_asked

T = TypeVar("T")

#: The shortest time that a call is charged, seconds: a call that took no time could not be told from no call.
SHORTEST_S = 1e-6
#: How long the end of the process waits for calls to end when they are told to, seconds.
_PATIENCE_S = 2.0


class Stopwatch:
    """When a call began and ended, safe to read from another thread while the call runs.

    A reader that finds the call running knows that it will be charged at least as much as was found: both the end and
    the look at a running call are taken under one lock.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._began_s: float | None = None
        self._took_s: float | None = None

    def begin(self) -> None:
        """Start to count; what was waited before is not counted."""
        with self._lock:
            self._began_s = time.monotonic()

    def end(self) -> None:
        """Stop to count."""
        with self._lock:
            began_s = self._began_s
            self._took_s = SHORTEST_S if began_s is None else max(SHORTEST_S, time.monotonic() - began_s)

    def at_least_s(self) -> float:
        """Return the seconds that the call will at least be charged, by what is known now."""
        with self._lock:
            if self._took_s is not None:
                return self._took_s
            return 0.0 if self._began_s is None else time.monotonic() - self._began_s

    @property
    def took_s(self) -> float:
        """The seconds of a call that has ended."""
        with self._lock:
            if self._took_s is None:
                raise AssertionError
            return self._took_s

    @property
    def has_ended(self) -> bool:
        """Whether the call has ended."""
        with self._lock:
            return self._took_s is not None


class _LiveThread:
    def __init__(self) -> None:
        self._up = threading.Event()
        self._loop: asyncio.AbstractEventLoop | None = None
        self._stop: asyncio.Event | None = None
        self._thread = threading.Thread(target=lambda: asyncio.run(self._serve()), name="live calls", daemon=True)
        self._thread.start()
        self._up.wait()

    async def _serve(self) -> None:
        self._loop, self._stop = asyncio.get_running_loop(), asyncio.Event()
        self._up.set()
        await self._stop.wait()

    @property
    def loop(self) -> asyncio.AbstractEventLoop:
        if self._loop is None:
            raise AssertionError
        return self._loop

    def end(self) -> None:
        """Cancel what still runs and let it tidy up."""
        if self._stop is not None and self._thread.is_alive():
            self.loop.call_soon_threadsafe(self._stop.set)
            self._thread.join(_PATIENCE_S)


class _Process:
    """The thread of this process: a process that is forked has none of its parent's threads."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._thread: _LiveThread | None = None

    def thread(self) -> _LiveThread:
        with self._lock:
            if self._thread is None:
                self._thread = _LiveThread()
            return self._thread

    def end(self) -> None:
        with self._lock:
            if self._thread is not None:
                self._thread.end()
                self._thread = None

    def forget(self) -> None:
        self._lock, self._thread = threading.Lock(), None


_process = _Process()
atexit.register(_process.end)
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_process.forget)


def begin_live(call: Callable[[], Coroutine[Any, Any, T]], watch: Stopwatch) -> "Future[T]":
    """Begin a call in the live loop; cancelling what is returned cancels it there.

    Args:
        call: Makes the coroutine; called in the live loop.
        watch: Of this call alone; it has ended before the future is done, unless the call was cancelled.
    """

    async def timed() -> T:
        watch.begin()
        try:
            return await call()
        except asyncio.CancelledError as error:
            task = asyncio.current_task()
            if task is None or task.cancelling():
                raise
            # Nobody here cancelled it: to whoever waits it must not look as if the mission were to end.
            raise PartError("live call", "it was cancelled from inside") from error
        finally:
            watch.end()

    return asyncio.run_coroutine_threadsafe(timed(), _process.thread().loop)


def run_live(call: Callable[[], Coroutine[Any, Any, T]]) -> T:
    """Run something in the live loop and wait for it: to try an endpoint or to close its client outside missions.

    Raises:
        KeyboardInterrupt: If a person stops it; it is cancelled.
    """
    future = begin_live(call, Stopwatch())
    try:
        with on_stop(future.cancel):
            return future.result()
    except CancelledError:
        stop_if_asked()
        raise
    finally:
        future.cancel()
