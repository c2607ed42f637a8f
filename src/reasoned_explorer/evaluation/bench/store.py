"""A run on disk: one SQLite file, and the records of its missions beside it.

Each mission is written in a transaction of its own, after its record: what the store says is finished is finished
whole, whenever the process is killed. Rows are read in one order, whatever the order in which they came in.

``run.sqlite`` has the table ``run`` (what the run is: its plan, its versions, as JSON) and the table ``missions``: a
mission's key, its row as JSON, and the seconds that it took on this machine, which no table of results reads. The view
``results`` has the row's figures as columns, for whoever asks with SQL.

While it is written it is in SQLite's WAL mode; whoever closes it makes a plain file of it again, so that a run can be
read where nothing can be written.
"""

import json
import sqlite3
import zlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import closing, suppress
from dataclasses import fields
from hashlib import blake2b
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from reasoned_explorer.evaluation.bench.plan import BenchPlan, Task, longer
from reasoned_explorer.evaluation.record_file import parse_record
from reasoned_explorer.evaluation.row import MissionRow
from reasoned_explorer.evaluation.scoring import MissionScore
from reasoned_explorer.model import Fault, InputError, PartError, RecordError, RecordWriteError
from reasoned_explorer.model.checks import is_there
from reasoned_explorer.model.disk import disk_error, in_words
from reasoned_explorer.model.record import EpisodeRecord, MissionEnd

STORE_NAME = "run.sqlite"
TRACES_NAME = "traces"
#: What is wrong with a run of which nothing can be shown yet.
NOTHING_FINISHED = Fault("no mission is finished", "at least one", "go on with rex bench --resume")
_STORE_VERSION = 1
_KEY = ("vehicle", "method", "mission_id")
#: Columns of the view, from a row's JSON.
_COLUMNS = tuple(item.name for item in fields(MissionRow) if item.name not in {*_KEY, "score"})
_SCORES = tuple(item.name for item in fields(MissionScore) if item.name not in {*_KEY, "success_at"})
_FIGURES = ", ".join(
    [f"json_extract(row, '$.{name}') AS {name}" for name in _COLUMNS]
    + [f"json_extract(row, '$.score.{name}') AS {name}" for name in _SCORES]
)
# The names in these queries are those of our own fields, never what somebody typed.
_SCHEMA = (
    """
CREATE TABLE run (name TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE missions (
    vehicle TEXT NOT NULL, method TEXT NOT NULL, mission_id TEXT NOT NULL,
    row TEXT NOT NULL, wall_s REAL NOT NULL,
    PRIMARY KEY (vehicle, method, mission_id)
) WITHOUT ROWID;
CREATE VIEW results AS SELECT vehicle, method, mission_id, """  # noqa: S608
    + _FIGURES
    + ", wall_s FROM missions;"
)


class RunStore:
    """A run's store; a context manager. Make one with `create`, `open` (to go on with it) or `read`."""

    def __init__(self, folder: Path, connection: sqlite3.Connection, *, writes: bool) -> None:
        self.folder = folder
        self._connection = connection
        self._writes = writes

    @classmethod
    def create(cls, folder: Path, plan: BenchPlan, about: dict[str, Any]) -> "RunStore":
        """Make the store of a new run.

        Args:
            folder: Of the run; made where it is not there. It must not hold a run already.
            plan: What is to be run.
            about: What else is to be known of it: versions, the command.

        Raises:
            RecordError: If the folder holds a run, or cannot be written to.
            PartError: If the disk fails, e.g. because it is full.
        """
        path = folder / STORE_NAME
        if is_there(path):
            fault = Fault(
                f"{path} is there already", "a folder without a run", "go on with it (--resume) or name another"
            )
            raise RecordError("run", [fault])
        half = path.with_suffix(".half")
        made = [each for each in (folder, *folder.parents) if not is_there(each)]
        try:
            folder.mkdir(parents=True, exist_ok=True)
            half.unlink(missing_ok=True)
            # Made beside and renamed: there is never a store without a plan.
            with closing(sqlite3.connect(half)) as connection, connection:
                connection.executescript(_SCHEMA)
                facts = {"store_version": _STORE_VERSION, "plan": plan.as_dict(), "about": about}
                connection.executemany(
                    "INSERT INTO run VALUES (?, ?)",
                    [(name, json.dumps(value, sort_keys=True, ensure_ascii=False)) for name, value in facts.items()],
                )
            half.replace(path)
            return cls.open(folder)
        except (OSError, sqlite3.Error, PartError) as error:
            for each in (half, half.with_name(f"{half.name}-journal"), path):
                with suppress(OSError):
                    each.unlink(missing_ok=True)
            for each in made:
                with suppress(OSError):
                    each.rmdir()
            if isinstance(error, PartError):
                raise
            raise _write_error(path, error) from error

    @classmethod
    def open(cls, folder: Path) -> "RunStore":
        """Open the store of a run to go on with it.

        Raises:
            RecordError: If there is none, or it is none of ours, or of another version.
            PartError: If the disk fails, e.g. because it is full.
        """
        path = store_path(folder)
        try:
            connection = sqlite3.connect(path, isolation_level=None, timeout=60.0)
        except sqlite3.Error as error:
            raise read_error(path, error) from error
        try:
            connection.execute("PRAGMA journal_mode = WAL")
            # A killed process loses nothing; only a machine that loses its power may lose the last missions.
            connection.execute("PRAGMA synchronous = NORMAL")
        except sqlite3.Error as error:
            connection.close()
            raise read_error(path, error) from error
        return cls(folder, connection, writes=True)._checked()

    @classmethod
    def read(cls, folder: Path) -> "RunStore":
        """Open the store of a run, finished or not, to read it: nothing is written, neither in the file nor beside it.

        Only a run that was killed, or that still goes on, may need room for the list of what its write-ahead log holds.

        Raises:
            RecordError: If there is none, or it is none of ours, or of another version.
            PartError: If the disk fails, e.g. because it is full.
        """
        path = store_path(folder)
        # Without a log nobody writes: SQLite need not look for one, nor make one where it may not.
        still = "" if path.with_name(f"{path.name}-wal").is_file() or not _was_in_wal_mode(path) else "&immutable=1"
        try:
            connection = sqlite3.connect(
                f"{path.absolute().as_uri()}?mode=ro{still}", uri=True, isolation_level=None, timeout=60.0
            )
        except sqlite3.Error as error:
            raise read_error(path, error) from error
        return cls(folder, connection, writes=False)._checked()

    def _checked(self) -> "RunStore":
        """Return the store, or close it where it is none of ours."""
        path = self.folder / STORE_NAME
        try:
            version = self._fact("store_version")
        except (sqlite3.Error, KeyError, ValueError) as error:
            self.close()
            raise read_error(path, error) from error
        if version != _STORE_VERSION:
            self.close()
            fault = Fault(
                f"{path} is of version {version}", f"version {_STORE_VERSION}", "run it again with this version"
            )
            raise RecordError("run", [fault])
        return self

    @property
    def connection(self) -> sqlite3.Connection:
        """The open file, for what is kept in it beside missions."""
        return self._connection

    @property
    def plan(self) -> BenchPlan:
        """What the run runs.

        Raises:
            InputError: If the plan was written by a version that runs it differently.
        """
        return BenchPlan.from_dict(self._fact("plan"))

    @property
    def about(self) -> dict[str, Any]:
        """What else is known of the run."""
        about: dict[str, Any] = self._fact("about")
        return about

    @property
    def models(self) -> dict[str, Any]:
        """What is known of the models that the run calls; empty where nothing was kept."""
        try:
            models: dict[str, Any] = self._fact("models")
        except KeyError:
            return {}
        return models

    def keep_models(self, models: Mapping[str, Any]) -> None:
        """Keep what is known of the models that the run calls.

        Raises:
            RecordWriteError: If the store cannot be written.
        """
        text = json.dumps(models, sort_keys=True, ensure_ascii=False)
        try:
            self._connection.execute("INSERT OR REPLACE INTO run VALUES ('models', ?)", (text,))
        except sqlite3.Error as error:
            raise RecordWriteError(f"run: {self.folder} cannot be written: {error}") from error

    def extend(self, methods: Sequence[str]) -> None:
        """Have the run run more methods on its missions, after those that it has; what it has already is left alone.

        Raises:
            InputError: If a method cannot be run.
            RecordWriteError: If the store cannot be written.
        """
        text = json.dumps(longer(self.plan, methods).as_dict(), sort_keys=True, ensure_ascii=False)
        try:
            self._connection.execute("UPDATE run SET value = ? WHERE name = 'plan'", (text,))
        except sqlite3.Error as error:
            raise RecordWriteError(f"run: {self.folder} cannot be written: {error}") from error

    def finished(self) -> set[tuple[str, str, str]]:
        """Return the keys of the missions that are finished: vehicle, method, mission id."""
        return set(self._connection.execute("SELECT vehicle, method, mission_id FROM missions"))

    def add(self, task: Task, row: str, *, trace: bytes | None, wall_s: float) -> None:
        """Write a finished mission: its record first, then its row, whole or not at all. Twice is once.

        Raises:
            RecordWriteError: If the disk is full, or the store cannot be written for another reason.
        """
        try:
            if trace is not None:
                path = self.trace_path(*task.key)
                path.parent.mkdir(parents=True, exist_ok=True)
                half = path.with_suffix(".half")
                half.write_bytes(trace)
                half.replace(path)
            self._connection.execute("INSERT OR IGNORE INTO missions VALUES (?, ?, ?, ?, ?)", (*task.key, row, wall_s))
        except (OSError, sqlite3.Error) as error:
            raise RecordWriteError(f"run: {words_of_error(self.folder, error)}") from error

    def rows(self, *, vehicle: str | None = None, method: str | None = None) -> Iterator[MissionRow]:
        """Return the rows, sorted by vehicle, method and mission id."""
        query = "SELECT row FROM missions WHERE (?1 IS NULL OR vehicle = ?1) AND (?2 IS NULL OR method = ?2)"
        for (line,) in self._connection.execute(query + " ORDER BY vehicle, method, mission_id", (vehicle, method)):
            yield MissionRow.from_json(line)

    def figures(self, names: Sequence[str]) -> list[tuple[str, str, str, list[Any] | None]]:
        """Return some figures of all rows, much faster than `rows`: vehicle, method, mission id, and the figures.

        Args:
            names: Of a row's own, or ``score.`` and a name of its score's.

        Returns:
            Sorted as `rows`; None instead of figures where a row is no JSON.
        """
        known = {*_COLUMNS, *(f"score.{name}" for name in _SCORES)}
        if unknown := sorted(set(names) - known):
            raise InputError("figures of a run", [Fault(f"{name!r}", f"one of {', '.join(known)}") for name in unknown])
        paths = ", ".join(f"'$.{name}'" for name in names)
        # One call reads a row once; one for each figure would read it as often.
        query = (
            f"SELECT vehicle, method, mission_id, CASE WHEN json_valid(row) THEN json_extract(row, {paths}) END "  # noqa: S608
            "FROM missions ORDER BY 1, 2, 3"
        )
        found = self._connection.execute(query).fetchall()
        # Likewise one text of all, with the numbers as they were written.
        read = json.loads(f"[{','.join(figures or 'null' for *_, figures in found)}]")
        return [(*key, figures) for (*key, _), figures in zip(found, read, strict=True)]

    def failed(self) -> int:
        """Return in how many missions a part failed."""
        query = "SELECT count(*) FROM missions WHERE json_extract(row, '$.end') = ?"
        count: int = self._connection.execute(query, (MissionEnd.FAULT.value,)).fetchone()[0]
        return count

    def wall_s(self) -> float:
        """Return the seconds that all missions took on the machines that ran them, added up."""
        total: float = self._connection.execute("SELECT coalesce(sum(wall_s), 0) FROM missions").fetchone()[0]
        return total

    def trace_path(self, vehicle: str, method: str, mission_id: str) -> Path:
        """Return where the record of a mission is kept. Names are hashed: they may hold what no file name may."""
        name = blake2b(mission_id.encode(), digest_size=12).hexdigest()
        return self.folder / TRACES_NAME / vehicle / _plain(method) / f"{name}.jsonl.z"

    def record(self, row: MissionRow) -> EpisodeRecord | None:
        """Return the record of a mission, or None where it was not kept.

        Raises:
            RecordError: If what is there is no record.
        """
        path = self.trace_path(row.score.vehicle, row.method, row.mission_id)
        if not path.is_file():
            return None
        try:
            return parse_record(zlib.decompress(path.read_bytes()), path)
        except zlib.error as error:
            raise RecordError("record", [Fault(f"{path} cannot be read: {error}", "a compressed record")]) from error

    def results(self) -> tuple[list[str], Iterable[tuple[Any, ...]]]:
        """Return the view ``results`` without the machine's seconds: names of the columns, and the rows in order."""
        query = (
            "SELECT vehicle, method, mission_id, " + _FIGURES + " FROM missions ORDER BY 1, 2, 3"  # noqa: S608
        )
        return [*_KEY, *_COLUMNS, *_SCORES], self._connection.execute(query)

    def close(self) -> None:
        """Close the file, a plain one again if nobody else has it open; safe to call twice."""
        if self._writes:
            # Somebody reads it, or the disk is full: it stays as it is, and is whole.
            with suppress(sqlite3.Error):
                self._connection.execute("PRAGMA busy_timeout = 0")
                self._connection.execute("PRAGMA journal_mode = DELETE")
        self._connection.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _fact(self, name: str) -> Any:
        found = self._connection.execute("SELECT value FROM run WHERE name = ?", (name,)).fetchone()
        if found is None:
            raise KeyError(name)
        return json.loads(found[0])


def store_path(folder: Path) -> Path:
    """Return where a run's store is.

    Raises:
        RecordError: If there is none.
    """
    path = folder / STORE_NAME
    if not is_there(path) or not path.is_file():
        fault = Fault(f"{folder} holds no {STORE_NAME}", "the folder of a run of rex bench")
        raise RecordError("run", [fault])
    return path


def _was_in_wal_mode(path: Path) -> bool:
    """Return whether a file was left in WAL mode: two bytes of SQLite's header say so (file format, 1.3.3)."""
    try:
        with path.open("rb") as file:
            return file.read(20)[18:] == b"\x02\x02"
    except OSError:
        return False  # why it cannot be read is SQLite's to say


def _is_of_the_disk(error: Exception) -> bool:
    # Extended codes have the plain one in their last byte; what is no answer of SQLite's has none.
    code = getattr(error, "sqlite_errorcode", None)
    return code is not None and code & 0xFF in {sqlite3.SQLITE_FULL, sqlite3.SQLITE_IOERR}


def read_error(path: Path, error: Exception) -> InputError | PartError:
    """Return the error to raise when a store cannot be opened."""
    if _is_of_the_disk(error):
        what = f"{path} cannot be opened: {error}"
        return PartError("disk", f"{what}; make room on that disk, or allow larger files (ulimit -f)")
    if getattr(error, "sqlite_errorcode", 0) & 0xFF in {sqlite3.SQLITE_CANTOPEN, sqlite3.SQLITE_READONLY}:
        fault = Fault(f"{path} cannot be opened: {error}", "a file and a folder that may be written to", "copy the run")
        return RecordError("run", [fault])
    return RecordError("run", [Fault(f"{path} cannot be read: {error}", "a run's store")])


def _write_error(path: Path, error: OSError | sqlite3.Error) -> InputError | PartError:
    """Return the error to raise when a store cannot be made."""
    if isinstance(error, OSError):
        return disk_error("run", path, error, kind=RecordError)
    if _is_of_the_disk(error):
        return PartError("disk", words_of_error(path, error))
    return RecordError("run", [Fault(f"{path} cannot be written: {error}", "a folder that can be written to")])


def words_of_error(path: Path, error: OSError | sqlite3.Error) -> str:
    """Return in one line what happened when a store was written, and what to do about it."""
    if isinstance(error, OSError):
        return in_words(path, error)
    return f"{path} cannot be written: {error}; make room on that disk, or allow larger files (ulimit -f)"


def _plain(name: str) -> str:
    """Return a name that is safe as the name of a folder, and still unlike others."""
    plain = "".join(char if char.isalnum() or char in "-_" else "_" for char in name)
    return plain if plain == name else f"{plain}-{blake2b(name.encode(), digest_size=4).hexdigest()}"
