"""A web server in a thread of its own: for a command that waits for Ctrl-C, beside a mission, and in tests."""

import socket
import threading
from collections.abc import Callable
from types import TracebackType
from typing import Any, Self

from reasoned_explorer.model import Fault, MissingDependencyError, SettingsError

_INSTALL = "pip install 'reasoned-explorer[view]'"
#: Answers that are under way when it ends get this long, seconds.
_GRACE_S = 1
_START_S = 30.0


class Server:
    """Serves an application from `start` (or the beginning of a ``with`` block) to `stop`.

    Args:
        app: An ASGI application.
        host: Address that it listens on.
        port: 0 for any that is free; `port` tells which.
        before_stop: Called before it ends: lets those go who wait for what never ends.
    """

    def __init__(
        self, app: Any, *, host: str = "127.0.0.1", port: int = 0, before_stop: Callable[[], object] = lambda: None
    ) -> None:
        self._before_stop = before_stop
        self._app, self.host, self.port = app, host, port
        self._thread: threading.Thread | None = None
        self._server: Any = None

    @property
    def url(self) -> str:
        """What a browser on this machine opens."""
        host = self.host.strip("[]")
        host = {"0.0.0.0": "127.0.0.1", "::": "::1"}.get(host, host)  # noqa: S104 - it is compared
        return f"http://[{host}]:{self.port}/" if ":" in host else f"http://{host}:{self.port}/"

    def start(self) -> None:
        """Listen and serve.

        Raises:
            SettingsError: If the address cannot be listened on.
            MissingDependencyError: If the web server is not installed.
        """
        uvicorn = import_web("uvicorn")
        listener = _listener(self.host, self.port)
        self.port = listener.getsockname()[1]
        config = uvicorn.Config(
            self._app,
            # What goes wrong in an answer is noted by the guard; what clients send wrong is theirs.
            log_config=None,
            log_level="critical",
            access_log=False,
            server_header=False,
            date_header=False,
            lifespan="off",
            ws="none",
            timeout_graceful_shutdown=_GRACE_S,
        )
        server = self._server = uvicorn.Server(config)
        thread = threading.Thread(target=lambda: server.run(sockets=[listener]), name="page of missions", daemon=True)
        self._thread = thread
        thread.start()
        # It listens already: whoever asks before the loop runs waits in the queue of the socket.

    def stop(self) -> None:
        """End; safe to call twice."""
        self._before_stop()
        if self._server is not None and self._thread is not None:
            self._server.should_exit = True
            self._thread.join(_START_S)

    def __enter__(self) -> Self:
        self.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.stop()


def import_web(name: str) -> Any:
    """Return a package of the extra ``view``.

    Raises:
        MissingDependencyError: If it is not installed.
    """
    import importlib

    try:
        return importlib.import_module(name)
    except ImportError as error:
        raise MissingDependencyError("the page of missions", name, _INSTALL) from error


def _listener(host: str, port: int) -> socket.socket:
    """Return a socket that listens.

    Raises:
        SettingsError: If the address cannot be listened on.
    """
    name = host.strip("[]")
    made: socket.socket | None = None
    try:
        family, kind, protocol, _, address = socket.getaddrinfo(name, port, type=socket.SOCK_STREAM)[0]
        made = socket.socket(family, kind, protocol)
        # A server that ended a moment ago leaves its port in TIME_WAIT; one that listens keeps it.
        made.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        made.bind(address)
        made.listen(128)
    except (OSError, OverflowError, UnicodeError) as error:
        if made is not None:
            made.close()
        said = getattr(error, "strerror", None) or str(error)
        shown = f"[{name}]" if ":" in name else name
        fault = Fault(
            f"{shown}:{port} cannot be listened on ({said})",
            "a free port of this machine",
            "give another --port, or --port 0 for any that is free",
        )
        raise SettingsError("address", [fault]) from error
    return made
