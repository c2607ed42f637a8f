"""``rex view``, and the page beside a mission of ``rex run --view``."""

import os
import threading
import webbrowser
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from reasoned_explorer.cli.answers import complain
from reasoned_explorer.cli.console import Output
from reasoned_explorer.evaluation.record_file import RECORD_NAME
from reasoned_explorer.model import Fault, Gathering, SettingsError
from reasoned_explorer.model.stopping import on_stop, stop_if_asked
from reasoned_explorer.viewer.library import Library
from reasoned_explorer.viewer.live import LiveFeed
from reasoned_explorer.viewer.security import Guard
from reasoned_explorer.viewer.serving import Server, import_web

#: What is listened on unless somebody else does already.
USUAL_PORT = 8470


@dataclass(frozen=True, slots=True)
class PageOptions:
    """What a person typed of where a page is served; see ``rex view --help``."""

    host: str = "127.0.0.1"
    port: int | None = None
    opens: bool = False

    def guard(self) -> Guard:
        """Return the guard of the page, once all has been checked.

        Raises:
            SettingsError: With everything that is wrong.
        """
        found = Gathering()
        if self.port is not None and not 0 <= self.port <= 65535:
            found.add(SettingsError("--port", [Fault(str(self.port), "a port, 0 to 65535")]))
        guard = found.take(lambda: Guard.of(self.host, os.environ), Guard())
        found.finish("page")
        return guard

    def started(self, app: Any, *, before_stop: Callable[[], object] = lambda: None) -> Server:
        """Return a server that serves an application.

        Raises:
            SettingsError: If the address cannot be listened on.
            MissingDependencyError: If the web server is not installed.
        """
        port = USUAL_PORT if self.port is None else self.port
        server = Server(app, host=self.host, port=port, before_stop=before_stop)
        try:
            server.start()
        except SettingsError:
            if self.port is not None:
                raise
            server = Server(app, host=self.host, before_stop=before_stop)
            server.start()
        return server


def view_folder(folder: Path, options: PageOptions) -> None:
    """Show what is in a folder until a person ends it.

    Raises:
        InputError: If an option is wrong, or there is nothing to show.
        MissingDependencyError: If the extra ``view`` is not installed.
        KeyboardInterrupt: When a person ends it.
    """
    guard = options.guard()
    library = Library(folder)
    library.check()
    import_web("fastapi")
    from reasoned_explorer.viewer.app import create_app, guarded

    # A large run is read while the person reaches for the browser.
    threading.Thread(target=library.read_ahead, name="reading ahead", daemon=True).start()
    serve_until_stopped(
        guarded(create_app(library, guard=guard), guard),
        guard,
        options,
        lambda url: f"{library.name} is shown at {url}",
    )


@contextmanager
def page_beside(folder: Path, options: PageOptions) -> Iterator[Callable[[], None]]:
    """Show a mission while it writes its record; gives what waits, when the mission is over, until a person ends it.

    Args:
        folder: That the record will be in; it need not be there yet.
        options: Where the page is served.

    Raises:
        InputError: If an option is wrong, or the address cannot be listened on.
        MissingDependencyError: If the extra ``view`` is not installed.
    """
    guard = options.guard()
    import_web("fastapi")
    from reasoned_explorer.viewer.app import create_app, guarded

    feed = LiveFeed(folder.resolve() / RECORD_NAME)
    library = Library(folder, is_awaited=True)
    app = guarded(create_app(library, guard=guard, live=feed), guard)
    server = options.started(app, before_stop=feed.close)

    def wait() -> None:
        Output().print(f"still shown at {server.url}; Ctrl-C ends it", markup=False, soft_wrap=True)
        wait_for_stop()

    try:
        tell(server, guard, options, lambda url: f"watch it at {url}", ending="")
        yield wait
    finally:
        server.stop()


def serve_until_stopped(app: Any, guard: Guard, options: PageOptions, said: Callable[[str], str]) -> None:
    """Serve an application until a person ends it.

    Args:
        app: Guarded already.
        guard: Its guard.
        options: Where it is served.
        said: Makes of the address what is told.

    Raises:
        InputError: If the address cannot be listened on.
        KeyboardInterrupt: When a person ends it.
    """
    server = options.started(app)
    try:
        tell(server, guard, options, said)
        wait_for_stop()
    finally:
        server.stop()
    stop_if_asked()


def tell(
    server: Server, guard: Guard, options: PageOptions, said: Callable[[str], str], *, ending: str = "; Ctrl-C ends it"
) -> None:
    """Say where a page is served, and open it where that was asked for."""
    url = server.url + (f"?token={guard.token}" if guard.token is not None else "")
    Output().print(f"{said(url)}{ending}", markup=False, soft_wrap=True)
    if guard.token is not None:
        complain("note: whoever has that address and its token sees the missions; what is sent is not encrypted")
    if options.opens and not webbrowser.open(url):
        complain("note: no browser could be opened")


def wait_for_stop() -> None:
    """Wait until a person asks to stop."""
    over = threading.Event()
    with on_stop(over.set):
        # In turns: where nobody listens for requests, Ctrl-C must come through.
        while not over.wait(0.5):
            pass
