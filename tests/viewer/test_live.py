"""Watching a mission while it is written, over a real server: whole lines only, each once, whatever the file does."""

import http.client
import json
import os
import socket
import time
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

import pytest

from reasoned_explorer.viewer.live import LiveFeed
from reasoned_explorer.viewer.serving import Server
from tests.viewer.asking import ask, showing

HEADER, STEP, SUMMARY = b'{"header":{"goal":"one"}}\n', b'{"step":{"step":%d}}\n', b'{"summary":{"end":"found"}}\n'


class Watcher:
    """Reads events as a browser does."""

    def __init__(self, server: Server, *, last: int | None = None) -> None:
        self.connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=20)
        headers = {"Accept-Encoding": "gzip"} | ({} if last is None else {"Last-Event-ID": str(last)})
        self.connection.request("GET", "/api/live", headers=headers)
        self.response = self.connection.getresponse()

    def events(self, *, heartbeats: bool = False) -> Iterator[tuple[str, int | None, Any]]:
        kind, number, data = "", None, ""
        for raw in self.response:
            line = raw.decode().rstrip("\n")
            name, _, value = line.partition(": ")
            if name == "event":
                kind = value
            elif name == "id":
                number = int(value)
            elif name == "data":
                data = value
            elif not line and kind:
                if heartbeats or kind != "alive":
                    yield kind, number, json.loads(data)
                kind, number, data = "", None, ""

    def first(self, count: int) -> list[tuple[str, int | None, Any]]:
        events = self.events()
        return [next(events) for _ in range(count)]

    def close(self) -> None:
        self.response.close()
        self.connection.close()


@pytest.fixture
def file(tmp_path: Path) -> Path:
    (tmp_path / "mission").mkdir()
    return tmp_path / "mission" / "record.jsonl"


@pytest.fixture
def server(file: Path) -> Iterator[Server]:
    with showing(file.parent, live=LiveFeed(file)) as server:
        yield server


def _append(file: Path, data: bytes) -> None:
    with file.open("ab") as opened:
        opened.write(data)


def test_lines_come_as_they_are_written(file: Path, server: Server) -> None:
    with closing(Watcher(server)) as watcher:  # before there is a record
        assert watcher.response.headers["Content-Type"].startswith("text/event-stream")
        assert "Content-Encoding" not in watcher.response.headers  # a packer would keep lines back
        assert "default-src 'self'" in watcher.response.headers["Content-Security-Policy"]
        events = watcher.events()
        _append(file, HEADER)
        assert next(events) == ("header", 1, {"header": {"goal": "one"}})
        for number in range(3):
            _append(file, STEP % number)
            assert next(events) == ("step", 2 + number, {"step": {"step": number}})
        _append(file, SUMMARY)
        assert next(events) == ("summary", 5, {"summary": {"end": "found"}})


def test_half_a_line_waits_until_it_is_whole(file: Path, server: Server) -> None:
    _append(file, HEADER + (STEP % 0)[:9])
    with closing(Watcher(server)) as watcher:
        events = watcher.events()
        assert next(events)[0] == "header"
        time.sleep(0.6)
        _append(file, (STEP % 0)[9:])
        assert next(events) == ("step", 2, {"step": {"step": 0}})


def test_what_was_cut_off_again_was_never_shown(file: Path, server: Server) -> None:
    """As when the disk ran full in the middle of a step, and there was room again."""
    _append(file, HEADER + STEP % 0)
    whole = file.stat().st_size
    _append(file, b'{"step":{"step":1,"half')
    with closing(Watcher(server)) as watcher:
        events = watcher.events()
        assert [next(events)[1] for _ in range(2)] == [1, 2]
        time.sleep(0.6)
        os.truncate(file, whole)
        time.sleep(0.6)
        _append(file, STEP % 1)
        assert next(events) == ("step", 3, {"step": {"step": 1}})


def test_a_record_that_begins_anew_is_told_from_its_beginning(file: Path, server: Server) -> None:
    _append(file, HEADER + STEP % 0 + STEP % 1)
    with closing(Watcher(server)) as watcher:
        events = watcher.events()
        assert [next(events)[1] for _ in range(3)] == [1, 2, 3]
        file.write_bytes(b'{"header":{"goal":"two"}}\n')
        assert next(events) == ("header", 1, {"header": {"goal": "two"}})
        other = file.with_name("other")
        other.write_bytes(b'{"header":{"goal":"a third, which is longer"}}\n' + STEP % 7)
        other.replace(file)
        assert next(events)[2] == {"header": {"goal": "a third, which is longer"}}
        assert next(events)[1] == 2


def test_who_comes_back_gets_what_they_missed_and_no_more(file: Path, server: Server) -> None:
    _append(file, HEADER + b"".join(STEP % number for number in range(4)))
    with closing(Watcher(server)) as watcher:
        seen = watcher.first(3)
    assert [number for _, number, _ in seen] == [1, 2, 3]
    with closing(Watcher(server, last=3)) as watcher:
        assert [number for _, number, _ in watcher.first(2)] == [4, 5]


@pytest.mark.parametrize("last", ["x", "-1", "99999999999999999999", "1; drop", "١"])
def test_a_strange_last_event_is_no_harm(file: Path, server: Server, last: str) -> None:
    _append(file, HEADER)
    with closing(http.client.HTTPConnection("127.0.0.1", server.port, timeout=20)) as connection:
        connection.request("GET", "/api/live", headers={"Last-Event-ID": last.encode()})
        response = connection.getresponse()
        assert response.status == 200
        lines = iter(response)
        assert any(line.startswith(b"id: 1") for line in lines)


def test_who_watches_hears_that_the_record_has_not_grown(file: Path) -> None:
    _append(file, HEADER)
    written_s = file.stat().st_mtime
    with (
        showing(file.parent, live=LiveFeed(file, now=lambda: written_s + 42.0)) as server,
        closing(Watcher(server)) as one,
    ):
        alive = (event for event in one.events(heartbeats=True) if event[0] == "alive")
        begun_s = time.monotonic()
        assert next(alive)[2] == {"age_s": 42.0}
        assert next(alive)[2] == {"age_s": 42.0}
        assert time.monotonic() - begun_s < 10.0


def test_before_there_is_a_record_it_has_no_age(server: Server) -> None:
    with closing(Watcher(server)) as watcher:
        assert next(watcher.events(heartbeats=True)) == ("alive", None, {"age_s": None})


def test_who_reads_nothing_slows_nobody(file: Path, server: Server) -> None:
    """A client that asks and never reads: megabytes wait for it in the file, and everybody else goes on."""
    _append(file, HEADER)
    with closing(socket.create_connection(("127.0.0.1", server.port))) as deaf:
        deaf.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        deaf.sendall(f"GET /api/live HTTP/1.1\r\nHost: 127.0.0.1:{server.port}\r\n\r\n".encode())
        long = b'{"step":{"step":%d,"text":"' + b"x" * 500_000 + b'"}}\n'
        with closing(Watcher(server)) as watcher:
            events = watcher.events()
            next(events)
            for number in range(40):
                _append(file, long % number)
                assert next(events)[2]["step"]["step"] == number
        assert ask(server, "/api/about").json["live"] is True
    # And who then leaves is not missed.
    _append(file, STEP % 99)
    with closing(Watcher(server, last=41)) as watcher:
        assert watcher.first(1)[0][2] == {"step": {"step": 99}}


def test_more_watchers_than_there_is_room_for_are_told_so(file: Path, server: Server) -> None:
    _append(file, HEADER)
    watchers = [Watcher(server) for _ in range(32)]
    try:
        for watcher in watchers:
            watcher.first(1)
        refused = ask(server, "/api/live")
        assert refused.status == 503
        assert "32" in refused.json["error"]
    finally:
        for watcher in watchers:
            watcher.close()


def test_lines_that_are_none_of_a_record_are_left_out(file: Path, server: Server) -> None:
    _append(file, HEADER + b"no json\n" + b'{"other":1}\n' + STEP % 0)
    with closing(Watcher(server)) as watcher:
        assert [number for _, number, _ in watcher.first(2)] == [1, 4]


def test_a_server_that_ends_lets_its_watchers_go_at_once(file: Path) -> None:
    _append(file, HEADER)
    feed = LiveFeed(file)
    with showing(file.parent, live=feed) as server:
        watcher = Watcher(server)
        watcher.first(1)
        begun_s = time.monotonic()
    assert time.monotonic() - begun_s < 10.0
    assert list(watcher.events()) == []
    watcher.close()


def test_the_page_knows_which_mission_is_live(file: Path, server: Server) -> None:
    about = ask(server, "/api/about").json
    assert about["live"] is True
    assert ask(server, "/api/runs").json == []  # nothing is written yet
    _append(
        file,
        b'{"header":{"goal":"g","level":1,"world":"none","world_digest":"","start":[0,0,0,0],"planner":"p","vehicle":"drone","seed":0,"versions":{},"settings":{}}}\n',
    )
    (run,) = ask(server, "/api/runs").json
    assert run["id"] == about["live_mission"]["run"]
    listing = ask(server, f"/api/runs/{run['id']}").json
    assert listing["rows"][0][0] == about["live_mission"]["mission"]
