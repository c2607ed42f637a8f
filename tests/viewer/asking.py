"""Asking a real server as anybody on the net could: with headers that no library would send."""

import http.client
import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from reasoned_explorer.viewer.app import create_app, guarded
from reasoned_explorer.viewer.library import Library
from reasoned_explorer.viewer.live import LiveFeed
from reasoned_explorer.viewer.security import Guard
from reasoned_explorer.viewer.serving import Server


@dataclass(frozen=True)
class Answer:
    status: int
    headers: Mapping[str, str]
    body: bytes

    @property
    def json(self) -> Any:
        return json.loads(self.body)


def ask(
    server: Server, path: str, *, method: str = "GET", headers: Mapping[str, str] | None = None, body: bytes = b""
) -> Answer:
    connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=120)
    try:
        given = {"Host": f"127.0.0.1:{server.port}", **(headers or {})}
        connection.putrequest(method, path, skip_host=True, skip_accept_encoding=True)
        for name, value in {**given, "Content-Length": str(len(body))}.items():
            connection.putheader(name, value)
        connection.endheaders(body)
        response = connection.getresponse()
        return Answer(response.status, {k.lower(): v for k, v in response.getheaders()}, response.read())
    finally:
        connection.close()


@contextmanager
def showing(folder: Path, *, guard: Guard | None = None, live: LiveFeed | None = None) -> Iterator[Server]:
    """Show a folder on a free port until the block ends."""
    guard = guard or Guard()
    app = create_app(Library(folder, is_awaited=live is not None), guard=guard, live=live)
    with Server(guarded(app, guard), before_stop=live.close if live else lambda: None) as server:
        yield server


def rows_of(server: Server, run: str) -> list[dict[str, Any]]:
    """Return the rows of a run, coded cells in words."""
    listing = ask(server, f"/api/runs/{run}").json
    words, coded = listing["words"], set(listing["coded"])
    return [
        {
            name: words[cell] if name in coded and cell is not None else cell
            for name, cell in zip(listing["columns"], row, strict=True)
        }
        for row in listing["rows"]
    ]
