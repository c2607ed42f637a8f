"""A run of ``rex bench`` as the page shows it. Nothing is written, neither in its store nor beside it."""

import sqlite3
import zlib
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from threading import Lock
from typing import Any, NamedTuple

from reasoned_explorer.evaluation.bench.store import STORE_NAME, RunStore
from reasoned_explorer.model import Fault, InputError, PartError, RecordError
from reasoned_explorer.task.split import Split
from reasoned_explorer.viewer.bench_columns import Key, read_columns
from reasoned_explorer.viewer.listing import Listing, opaque_id
from reasoned_explorer.viewer.runs import MissionFiles, UnknownIdError
from reasoned_explorer.viewer.security import within

#: A record is not larger than this once it is unpacked; what says otherwise is no record. Bytes.
_LARGEST_RECORD = 1 << 28
_State = tuple[tuple[int, int, int], ...]


class _Mission(NamedTuple):
    key: Key
    place: str | None


@dataclass(frozen=True, slots=True)
class _Read:
    """What was read of a run, and in which state of its store."""

    state: _State
    listing: Listing
    missions: Mapping[str, _Mission]
    json: bytes


class BenchRun:
    """A run that `rex bench` made, finished or not; safe to use from several threads.

    Args:
        run_id: Made by the library.
        name: For people.
        folder: That holds its store.
        root: What nothing may lead out of, resolved.
    """

    kind = "bench"

    def __init__(self, run_id: str, name: str, folder: Path, *, root: Path) -> None:
        self.id, self.name, self.folder = run_id, name, folder
        self._root = root
        self._lock = Lock()
        self._about: tuple[_State, dict[str, Any]] | None = None
        self._kept: _Read | None = None
        self._split: tuple[_State, Split | None] | None = None

    def about(self) -> Mapping[str, Any]:
        """Return what the list of runs says of it; with ``fault`` where it cannot be read."""
        state = self._state()
        if self._about is None or self._about[0] != state:
            self._about = (state, self._read_about())
        return self._about[1]

    def _read_about(self) -> dict[str, Any]:
        said: dict[str, Any] = {"id": self.id, "name": self.name, "kind": self.kind}
        said |= {"missions": 0, "methods": [], "made_by": ""}
        try:
            with RunStore.read(self.folder) as store:
                versions = store.about.get("versions", {})
                said["made_by"] = str(versions.get("reasoned-explorer", ""))
                said["missions"] = len(store.finished())
                said["methods"] = list(store.plan.methods)
        except (InputError, PartError, sqlite3.Error) as error:
            said["fault"] = str(error).replace(str(self.folder), self.name)
        return said

    def listing(self) -> Listing:
        """Return its missions; they are read again when the store has changed.

        Raises:
            InputError: If the store cannot be read.
            PartError: If the disk fails.
        """
        return self._read().listing

    def listing_json(self) -> bytes:
        """Return the listing as the page reads it.

        Raises:
            InputError: If the store cannot be read.
            PartError: If the disk fails.
        """
        return self._read().json

    def mission(self, mission_id: str) -> MissionFiles:
        """Return a mission.

        Raises:
            UnknownIdError: If there is no such mission.
            RecordError: If its record was not kept, or cannot be read.
        """
        found = self._read().missions.get(mission_id)
        if found is None:
            raise UnknownIdError("mission", [Fault("there is no such mission in this run", "one that is listed")])
        vehicle, method, name = found.key
        with RunStore.read(self.folder) as store:
            path = within(self._root, store.trace_path(*found.key))
            split = self._split_of(store)
        if path is None:
            raise RecordError("record", [Fault(f"no record of {name} by {method} was kept", "a run with records")])
        return MissionFiles(
            id=mission_id,
            name=f"{name} · {method}",
            record=unpacked(path),
            method=method,
            pair_key=opaque_id(vehicle, name),
            place=split.place(found.place) if split and found.place and found.place in split.world_digests else None,
        )

    def _split_of(self, store: RunStore) -> Split | None:
        """Return the episodes of the run; None where another version wrote them: missions are shown without worlds."""
        state = self._state()
        kept = self._split
        if kept is None or kept[0] != state:
            split = None
            with suppress(InputError, KeyError, ValueError):
                split = store.plan.split
            kept = self._split = (state, split)
        return kept[1]

    def _read(self) -> _Read:
        with self._lock:
            state = self._state()
            if self._kept is None or self._kept.state != state:
                self._kept = self._read_store(state)
            return self._kept

    def _read_store(self, state: _State) -> _Read:
        try:
            with RunStore.read(self.folder) as store:
                columns, keys = read_columns(store, self._root)
        except sqlite3.Error as error:
            what = f"{self.name} cannot be read: {error}"
            raise RecordError("run", [Fault(what, "a run as rex bench leaves it")]) from error
        listing = Listing.of_columns(columns)
        missions = dict(zip(columns["id"], map(_Mission, keys, columns["place"]), strict=True))
        about = {"id": self.id, "name": self.name, "kind": self.kind}
        return _Read(state, listing, missions, listing.as_json(about))

    def _state(self) -> _State:
        """Return what changes when the store does."""
        state = []
        for name in (STORE_NAME, f"{STORE_NAME}-wal"):
            with suppress(OSError):
                found = (self.folder / name).stat()
                state.append((found.st_mtime_ns, found.st_size, found.st_ino))
        return tuple(state)


def unpacked(path: Path) -> bytes:
    """Return a record.

    Raises:
        RecordError: If it cannot be read, or is larger than any record is.
    """
    try:
        unpacker = zlib.decompressobj()
        data = unpacker.decompress(path.read_bytes(), _LARGEST_RECORD)
    except (OSError, zlib.error) as error:
        raise RecordError("record", [Fault(f"{path.name} cannot be read: {error}", "a compressed record")]) from error
    if unpacker.unconsumed_tail:
        raise RecordError(
            "record", [Fault(f"{path.name} is too large for a record", f"at most {_LARGEST_RECORD} bytes")]
        )
    return data
