"""A mission's record while it is being written: its whole lines, as they come.

Everybody who watches reads the file for themselves, from the line that they had last. Nothing is queued for anybody,
and the mission does not know of them: who is slow, or gone, slows nobody.
"""

import os
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from threading import Event
from typing import BinaryIO

#: Read at once, bytes; what is longer comes in the next turn.
_BLOCK = 1 << 22
#: A line of a record is not longer than this; what is longer is none. Bytes.
_LONGEST_LINE = 1 << 26
_KINDS = ("header", "step", "summary")


@dataclass(frozen=True, slots=True)
class LiveLine:
    """A whole line of a record.

    Attributes:
        number: From 1.
        kind: ``header``, ``step`` or ``summary``.
        text: The line, without its line break.
    """

    number: int
    kind: str
    text: str


class LiveFeed:
    """A record that grows; safe to use from several threads.

    Args:
        path: Of the record; it need not be there yet.
        now: Tells the time as the disk's own times do, seconds.
    """

    def __init__(self, path: Path, *, now: Callable[[], float] = time.time) -> None:
        self.path = path
        self._now = now
        self._closed = Event()

    @property
    def is_closed(self) -> bool:
        """Whether nobody is to be told anything any more."""
        return self._closed.is_set()

    def close(self) -> None:
        """Let everybody who watches go."""
        self._closed.set()

    def age_s(self) -> float | None:
        """Return how long ago the record grew, seconds; None where it is not there yet."""
        try:
            return max(0.0, self._now() - self.path.stat().st_mtime)
        except OSError:
            return None

    def reader(self, *, after: int = 0) -> "LiveReader":
        """Return who reads it for somebody who watches.

        Args:
            after: The number of the last line that they have.
        """
        return LiveReader(self.path, after=after)


class LiveReader:
    """Reads a record that grows, for one who watches.

    A line that is only half there is left until it is whole. A record that has become shorter than what was read of it,
    or another file by the same name, is read from its beginning again.

    Args:
        path: Of the record.
        after: The number of the last line that is not wanted again.
    """

    def __init__(self, path: Path, *, after: int = 0) -> None:
        self._path = path
        self._after = after
        self._offset = self._number = 0
        self._inode = 0

    def lines(self) -> list[LiveLine]:
        """Return the whole lines that have come since the last time; none where the file is not there."""
        try:
            with self._path.open("rb") as file:
                state = os.fstat(file.fileno())
                if state.st_size < self._offset or (self._inode and state.st_ino != self._inode):
                    self._offset = self._number = self._after = 0
                self._inode = state.st_ino
                file.seek(self._offset)
                return list(self._split(_read_lines(file)))
        except OSError:
            return []

    def _split(self, data: bytes) -> Iterator[LiveLine]:
        whole = data[: data.rfind(b"\n") + 1]
        self._offset += len(whole)
        for line in whole.split(b"\n")[:-1]:
            self._number += 1
            kind = next((kind for kind in _KINDS if line.startswith(b'{"%s":' % kind.encode())), None)
            if self._number <= self._after or kind is None:
                continue
            # An event ends at a line break of any kind; JSON has none of its own.
            yield LiveLine(self._number, kind, line.decode("utf-8", "replace").replace("\r", " "))


def _read_lines(file: BinaryIO) -> bytes:
    """Return a block, or as much more as the first line in it takes."""
    data = file.read(_BLOCK)
    while b"\n" not in data and len(data) < _LONGEST_LINE:
        more = file.read(_BLOCK)
        if not more:
            break
        data += more
    return data
