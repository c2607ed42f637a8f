"""What people say of missions: their answers, kept in the database of the run.

The table ``ratings`` lies in ``run.sqlite`` beside the missions; it is made where it is not there, so that any run can
be rated, and nobody who knows nothing of it is disturbed. It only grows: whoever changes an answer adds one, the latest
counts, and the earlier ones stay. Each answer is a transaction of its own that is on the disk, down to the metal,
before `RatingStore.add` returns.

Several raters, ``rex bench --resume`` and ``rex report`` may work on one run at the same time: SQLite's write-ahead
log keeps them apart, and whoever closes last makes a plain file of it again.
"""

import sqlite3
import threading
import unicodedata
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from datetime import datetime, timedelta
from enum import StrEnum
from pathlib import Path
from types import TracebackType
from typing import Self

from reasoned_explorer.evaluation.bench.store import STORE_NAME, RunStore, read_error, store_path, words_of_error
from reasoned_explorer.model import Fault, InputError, RecordWriteError

#: Which question it is: when its words or what is shown beside it change in a way that answers may hang on, it grows.
QUESTION = 1
#: The question itself.
QUESTION_TEXT = "Did it do what was asked?"
#: The least and the most that "how well" can be.
WORST, BEST = 1, 5
#: The longest name of a rater, characters.
LONGEST_NAME = 64
#: The longest comment, characters.
LONGEST_COMMENT = 2000
#: A mission of a run: vehicle, method, mission id.
MissionKey = tuple[str, str, str]

_COLUMNS = "rater, vehicle, method, mission_id, answer, how_well, comment, at, version, question"
_SCHEMA = f"""
CREATE TABLE IF NOT EXISTS ratings (
    number INTEGER PRIMARY KEY,
    rater TEXT NOT NULL, vehicle TEXT NOT NULL, method TEXT NOT NULL, mission_id TEXT NOT NULL,
    answer TEXT NOT NULL CHECK (answer IN ('yes', 'partly', 'no')),
    how_well INTEGER NOT NULL CHECK (how_well BETWEEN {WORST} AND {BEST}),
    comment TEXT NOT NULL, at TEXT NOT NULL, version TEXT NOT NULL, question INTEGER NOT NULL
)"""
# Waits for others who write: a mission or an answer takes them milliseconds.
_PATIENCE_S = 30.0


class Answer(StrEnum):
    """What a person says to the question."""

    YES = "yes"
    PARTLY = "partly"
    NO = "no"


@dataclass(frozen=True, slots=True)
class Rating:
    """What one person said of one mission, once.

    Attributes:
        rater: Whose it is: a name that a person gave, data and nothing else.
        vehicle: Of the mission.
        method: Of the mission.
        mission_id: Of the mission.
        answer: To the question.
        how_well: 1 (badly) to 5 (perfectly).
        comment: In the person's own words; may be empty.
        at: When, UTC.
        version: Of this package, when it was asked.
        question: Number of the question, see `QUESTION`.

    Raises:
        InputError: With everything that is wrong.
    """

    rater: str
    vehicle: str
    method: str
    mission_id: str
    answer: Answer
    how_well: int
    comment: str
    at: datetime
    version: str
    question: int = QUESTION

    def __post_init__(self) -> None:
        faults = [*_name_faults(self.rater), *_comment_faults(self.comment)]
        if self.answer not in set(Answer):
            faults.append(Fault(f"answer is {self.answer!r}", ", ".join(Answer)))
        # True is an int for Python, and none for people.
        if isinstance(self.how_well, bool) or not WORST <= self.how_well <= BEST:
            faults.append(Fault(f"how well is {self.how_well!r}", f"{WORST} to {BEST}"))
        if self.at.utcoffset() != timedelta(0):
            faults.append(Fault(f"time is {self.at.isoformat()}", "a time in UTC"))
        if faults:
            raise InputError("rating", faults)

    @property
    def key(self) -> MissionKey:
        """The mission: vehicle, method, mission id."""
        return self.vehicle, self.method, self.mission_id

    def says_the_same(self, other: "Rating | None") -> bool:
        """Return whether another rating gives the same answer to the same question, whenever that was."""
        return other is not None and (self.answer, self.how_well, self.comment, self.question) == (
            other.answer,
            other.how_well,
            other.comment,
            other.question,
        )


def rater_name(text: str) -> str:
    """Return a name as it is kept: in Unicode's composed form, without spaces around it and with single ones inside.

    Raises:
        InputError: If there is none left, it is too long, or it holds what cannot be seen.
    """
    name = " ".join(part for part in unicodedata.normalize("NFC", text).strip().split(" ") if part)
    faults = _name_faults(name)
    if faults:
        raise InputError("rater", faults)
    return name


class RatingStore:
    """The ratings of a run, to be read and to be added to; a context manager. Threads may share one.

    Args:
        folder: Of the run.

    Raises:
        RecordError: If it holds no run of ours, or one that cannot be written to.
        PartError: If the disk fails, e.g. because it is full.
    """

    def __init__(self, folder: Path) -> None:
        with RunStore.read(folder):  # says what is wrong with a run that is none
            pass
        self.folder, path = folder, store_path(folder)
        self._lock = threading.Lock()
        try:
            self._connection = sqlite3.connect(path, isolation_level=None, timeout=_PATIENCE_S, check_same_thread=False)
        except sqlite3.Error as error:
            raise read_error(path, error) from error
        try:
            # Somebody who reads at this moment keeps it from changing: then it is as safe, and others wait a little.
            with suppress(sqlite3.OperationalError):
                self._connection.execute("PRAGMA journal_mode = WAL")
            # A mission can be run again; what a person said cannot. So it is on the disk before it is acknowledged.
            self._connection.execute("PRAGMA synchronous = FULL")
            self._connection.execute(_SCHEMA)
        except sqlite3.Error as error:
            self._connection.close()
            raise read_error(path, error) from error

    def add(self, rating: Rating) -> bool:
        """Keep a rating; when this returns, it is on the disk.

        Args:
            rating: Of a mission of this run.

        Returns:
            False where the same rater's latest one says the same already, so that nothing had to be kept: an answer
            that is sent twice is one.

        Raises:
            InputError: If the run has no such mission.
            RecordWriteError: If the store cannot be written.
        """
        with self._lock:
            try:
                with self._connection:
                    self._connection.execute("BEGIN IMMEDIATE")
                    found = self._connection.execute(
                        "SELECT 1 FROM missions WHERE vehicle = ? AND method = ? AND mission_id = ?", rating.key
                    ).fetchone()
                    if found is None:
                        fault = Fault(f"there is no mission {rating.key}", "a mission of this run that is finished")
                        raise InputError("rating", [fault])
                    if rating.says_the_same(self._latest_of(rating.rater, rating.key)):
                        return False
                    self._connection.execute(
                        f"INSERT INTO ratings ({_COLUMNS}) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",  # noqa: S608 - ours
                        _as_line(rating),
                    )
            except sqlite3.Error as error:
                raise RecordWriteError(f"rating: {words_of_error(self.folder / STORE_NAME, error)}") from error
        return True

    def latest_of(self, rater: str, key: MissionKey) -> Rating | None:
        """Return what a rater says of a mission now; None for nothing yet."""
        with self._lock:
            return self._latest_of(rater, key)

    def rated_by(self, rater: str) -> set[MissionKey]:
        """Return the missions that a rater has said something of."""
        query = "SELECT DISTINCT vehicle, method, mission_id FROM ratings WHERE rater = ?"
        with self._lock:
            return set(self._connection.execute(query, (rater,)))

    def secret(self, name: str, made: bytes) -> bytes:
        """Return bytes that the run keeps under a name: the first that were ever given, and the same from then on.

        Args:
            name: What they are for.
            made: What is kept where there is nothing yet, e.g. from `secrets.token_bytes`.

        Raises:
            RecordWriteError: If the store cannot be written.
        """
        with self._lock:
            try:
                # As JSON, like all that a run says of itself.
                self._connection.execute("INSERT OR IGNORE INTO run VALUES (?, ?)", (name, f'"{made.hex()}"'))
                (text,) = self._connection.execute("SELECT value FROM run WHERE name = ?", (name,)).fetchone()
            except sqlite3.Error as error:
                raise RecordWriteError(f"rating: {words_of_error(self.folder / STORE_NAME, error)}") from error
        return bytes.fromhex(text.strip('"'))

    def close(self) -> None:
        """Close the file, a plain one again if nobody else has it open; safe to call twice."""
        with self._lock, suppress(sqlite3.Error):
            self._connection.execute("PRAGMA busy_timeout = 0")
            self._connection.execute("PRAGMA journal_mode = DELETE")
        self._connection.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _latest_of(self, rater: str, key: MissionKey) -> Rating | None:
        query = (
            f"SELECT {_COLUMNS} FROM ratings WHERE rater = ? AND vehicle = ? AND method = ? AND mission_id = ? "  # noqa: S608
            "ORDER BY number DESC LIMIT 1"
        )
        line = self._connection.execute(query, (rater, *key)).fetchone()
        return None if line is None else _from_line(line)


def ratings_of(store: RunStore) -> tuple[Rating, ...]:
    """Return every rating of a run, earlier ones too, in the order in which they were given; nothing is written.

    Raises:
        RecordError: If they cannot be read.
        PartError: If the disk fails.
    """
    try:
        if not store.connection.execute("SELECT 1 FROM sqlite_master WHERE name = 'ratings'").fetchone():
            return ()
        lines = store.connection.execute(f"SELECT {_COLUMNS} FROM ratings ORDER BY number")  # noqa: S608 - ours
        return tuple(map(_from_line, lines))
    except (sqlite3.Error, ValueError) as error:
        raise read_error(store.folder / STORE_NAME, error) from error


def latest(ratings: Iterable[Rating]) -> tuple[Rating, ...]:
    """Return of each rater and mission the last rating, sorted by mission, then rater."""
    kept = {(rating.key, rating.rater): rating for rating in ratings}
    return tuple(kept[place] for place in sorted(kept))


def _as_line(rating: Rating) -> tuple[str | int, ...]:
    return (
        rating.rater,
        *rating.key,
        rating.answer.value,
        rating.how_well,
        rating.comment,
        rating.at.isoformat(timespec="milliseconds"),
        rating.version,
        rating.question,
    )


def _from_line(line: tuple[str, str, str, str, str, int, str, str, str, int]) -> Rating:
    rater, vehicle, method, mission_id, answer, how_well, comment, at, version, question = line
    when = datetime.fromisoformat(at)
    return Rating(rater, vehicle, method, mission_id, Answer(answer), how_well, comment, when, version, question)


def _name_faults(name: str) -> list[Fault]:
    faults = []
    if not name or name != name.strip():
        faults.append(Fault(f"name is {name!r}", "a name, without spaces around it"))
    if len(name) > LONGEST_NAME:
        faults.append(Fault(f"name has {len(name)} characters", f"at most {LONGEST_NAME}"))
    if any(unicodedata.category(char)[0] == "C" or unicodedata.category(char) in {"Zl", "Zp"} for char in name):
        faults.append(Fault(f"name is {name[:LONGEST_NAME]!r}", "characters that can be seen"))
    return faults


def _comment_faults(comment: str) -> list[Fault]:
    faults = []
    if len(comment) > LONGEST_COMMENT:
        faults.append(Fault(f"comment has {len(comment)} characters", f"at most {LONGEST_COMMENT}"))
    if any(unicodedata.category(char) in {"Cc", "Cs"} and char not in "\n\t" for char in comment):
        faults.append(Fault("comment holds control characters", "text, with line breaks and tabs at most"))
    return faults
