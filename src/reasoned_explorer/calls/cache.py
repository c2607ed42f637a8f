"""Answers that were paid for once: an SQLite file that several processes of one machine may use at the same time."""

import json
import os
import sqlite3
import threading
import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from reasoned_explorer.calls.chat import ChatAnswer, ChatRequest
from reasoned_explorer.calls.stored import answer_as_json, answer_from_json
from reasoned_explorer.model.checks import path_of
from reasoned_explorer.model.errors import Fault, SettingsError

#: Version of the tables; a file of another one is refused.
CACHE_SCHEMA = 1
#: So long one process waits for another one to finish writing, seconds.
_PATIENCE_S = 30.0

_TABLES = """
CREATE TABLE IF NOT EXISTS answers (
    digest TEXT PRIMARY KEY,
    answer TEXT NOT NULL,
    seconds REAL NOT NULL,
    model TEXT NOT NULL,
    prompt TEXT NOT NULL
) WITHOUT ROWID
"""


@dataclass(frozen=True, slots=True)
class StoredAnswer:
    """An answer as it came, and the seconds that it took then."""

    answer: ChatAnswer
    seconds: float


class AnswerCache:
    """Keeps good answers by all that decides them (`stored.RequestParts`); never a fault, a question or a key.

    The first answer stays: processes that ask the same at the same time agree from then on. What the disk does wrong
    while a mission runs costs a call and nothing else; `trouble` says what it was.

    Args:
        path: Of the file; made where it is not there.
        sampled: Whether answers of sampling (temperature above 0) are used again, too, so that a repeated run costs
            nothing. Without, they are drawn anew.

    Attributes:
        path: Of the file.
        trouble: What went wrong last, or None.

    Raises:
        SettingsError: If the file cannot be made or is something else.
    """

    def __init__(self, path: Path | str, *, sampled: bool = True) -> None:
        self.sampled = sampled
        self.trouble: str | None = None
        self._lock = threading.Lock()
        self._pid = 0
        self._open: sqlite3.Connection | None = None
        self.path = path_of(path, "cache", SettingsError)
        try:
            version = _version(self._connection())
        except sqlite3.DatabaseError as error:
            self.close()
            expected = "a cache of answers, or a name in a folder that exists and may be written to"
            fault = Fault(f"{self.path} cannot be used: {error}", expected, "choose another file, or delete this one")
            raise SettingsError("cache", [fault]) from error
        if version != CACHE_SCHEMA:
            self.close()
            what = f"{self.path} has version {version}"
            expected = f"version {CACHE_SCHEMA}"
            raise SettingsError("cache", [Fault(what, expected, "choose another file, or delete this one")])

    def takes(self, request: ChatRequest) -> bool:
        """Return whether the answer to a request is kept: it is not drawn, or drawn answers are wanted again."""
        return self.sampled or request.temperature == 0.0

    def get(self, digest: str) -> StoredAnswer | None:
        """Return a kept answer, or None."""
        try:
            with self._lock:
                query = "SELECT answer, seconds FROM answers WHERE digest = ?"
                row = self._connection().execute(query, (digest,)).fetchone()
            return None if row is None else StoredAnswer(answer_from_json(json.loads(row[0])), row[1])
        except (sqlite3.Error, ValueError) as error:
            self.trouble = f"{self.path}: {error}"
            return None

    def put(self, digest: str, stored: StoredAnswer, *, model: str = "", prompt: str = "") -> None:
        """Keep an answer, unless there is one already.

        Args:
            digest: Of all that decides it.
            stored: The answer and its seconds.
            model: Who answered, for people who look into the file.
            prompt: Version of the prompt, likewise.

        Raises:
            ValueError: If it is a fault: none may be kept.
        """
        if stored.answer.fault is not None:
            raise ValueError(stored.answer.fault)
        row = (digest, json.dumps(answer_as_json(stored.answer)), stored.seconds, model, prompt)
        try:
            with self._lock, self._connection() as connection:
                connection.execute("INSERT OR IGNORE INTO answers VALUES (?, ?, ?, ?, ?)", row)
        except sqlite3.Error as error:
            self.trouble = f"{self.path}: {error}"

    def __len__(self) -> int:
        with self._lock:
            count: int = self._connection().execute("SELECT count(*) FROM answers").fetchone()[0]
        return count

    def close(self) -> None:
        """Close the file; it is opened again when it is needed, and closed by itself when nobody has it any more."""
        with self._lock:
            if self._open is None:
                return
            if self._pid == os.getpid():
                with suppress(sqlite3.Error):
                    self._open.close()
            else:
                _inherited.append(self._open)
            self._open = None

    def __del__(self) -> None:
        self.close()

    def __getstate__(self) -> tuple[str, bool]:
        return str(self.path), self.sampled

    def __setstate__(self, state: tuple[str, bool]) -> None:
        # A worker process opens the file for itself.
        self.__init__(state[0], sampled=state[1])  # type: ignore[misc]

    def _connection(self) -> sqlite3.Connection:
        """Return the connection of this process: none may be used on the other side of a fork."""
        if self._open is None or self._pid != os.getpid():
            if self._open is not None:
                _inherited.append(self._open)
            self._open, self._pid = _connect(self.path), os.getpid()
        return self._open


#: Connections of the process that this one was forked from: closing them here could take locks away from it.
_inherited: list[sqlite3.Connection] = []


def _connect(path: Path) -> sqlite3.Connection:
    connection = sqlite3.connect(path, timeout=_PATIENCE_S, check_same_thread=False)
    try:
        # Readers and a writer at the same time; a crash of the machine may cost the last answers, never the file.
        _turn_to_wal(connection)
        connection.execute("PRAGMA synchronous = NORMAL")
        if _version(connection) == 0:
            with connection:
                connection.execute("BEGIN IMMEDIATE")
                # Another process may have made them in between, and another program's file is not ours to fill.
                if connection.execute("SELECT count(*) FROM sqlite_master").fetchone()[0] == 0:
                    connection.execute(_TABLES)
                    connection.execute(f"PRAGMA user_version = {CACHE_SCHEMA}")
    except BaseException:
        connection.close()
        raise
    return connection


def _version(connection: sqlite3.Connection) -> int:
    version: int = connection.execute("PRAGMA user_version").fetchone()[0]
    return version


def _turn_to_wal(connection: sqlite3.Connection) -> None:
    """Turn a file to WAL; where two processes do it at the same time SQLite refuses one of them without waiting."""
    ends_s = time.monotonic() + _PATIENCE_S
    while True:
        try:
            connection.execute("PRAGMA journal_mode = WAL")
        except sqlite3.OperationalError as error:
            if "locked" not in str(error) or time.monotonic() > ends_s:
                raise
            time.sleep(0.01)
        else:
            return
