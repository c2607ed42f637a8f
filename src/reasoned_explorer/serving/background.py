"""A served machine in a thread of its own, for programs that are its clients at the same time."""

import asyncio
import threading
from collections.abc import Callable
from typing import Generic, Protocol, Self, TypeVar


class Served(Protocol):
    """A server that listens from `start` to `close`."""

    async def start(self, host: str = ..., port: int = ...) -> int:
        """Listen; return the port."""
        ...

    async def close(self) -> None:
        """Hang up on everybody and stop."""


S = TypeVar("S", bound=Served)


class BackgroundServer(Generic[S]):
    """Serves while the `with` block runs.

    Args:
        make: Makes the server; called in the thread, where the server's event loop runs.
        host: On which address it listens.
        port: On which port; 0 for a free one, which `port` then tells.
    """

    def __init__(self, make: Callable[[], S], *, host: str = "127.0.0.1", port: int = 0) -> None:
        self._make, self._host, self.port = make, host, port
        self._thread = threading.Thread(target=self._run, name="served machine", daemon=True)
        self._up = threading.Event()
        self._error: BaseException | None = None
        self._loop: asyncio.AbstractEventLoop | None = None
        self._stop: asyncio.Event | None = None
        self._server: S | None = None

    @property
    def server(self) -> S:
        """The server; only its own thread may change anything about it."""
        if self._server is None:
            raise AssertionError
        return self._server

    def __enter__(self) -> Self:
        self._thread.start()
        self._up.wait()
        if self._error is not None:
            raise self._error
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    def stop(self) -> None:
        """Hang up on everybody and stop. Safe to call twice."""
        if self._loop is not None and self._stop is not None and self._thread.is_alive():
            self._loop.call_soon_threadsafe(self._stop.set)
            self._thread.join()

    def _run(self) -> None:
        try:
            asyncio.run(self._serve())
        except BaseException as error:  # noqa: BLE001 - it belongs to whoever entered
            self._error = error
        finally:
            self._up.set()

    async def _serve(self) -> None:
        self._loop, self._stop = asyncio.get_running_loop(), asyncio.Event()
        self._server = self._make()
        self.port = await self._server.start(self._host, self.port)
        self._up.set()
        try:
            await self._stop.wait()
        finally:
            await self._server.close()
