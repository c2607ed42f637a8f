"""Finds the runs and missions in a folder, and opens what is asked for by its id.

A client names what it wants by ids that are made here; a path never comes from outside. What lies in the folder is
followed only as far as it stays in it: a link that leads elsewhere is as good as not there.
"""

import os
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from threading import Lock

from reasoned_explorer.evaluation.bench.store import STORE_NAME
from reasoned_explorer.evaluation.record_file import RECORD_NAME
from reasoned_explorer.model import Fault, InputError, PartError, RecordError
from reasoned_explorer.model.checks import is_there
from reasoned_explorer.viewer.bench_runs import BenchRun
from reasoned_explorer.viewer.listing import opaque_id
from reasoned_explorer.viewer.mission_runs import MissionsRun
from reasoned_explorer.viewer.runs import Run, UnknownIdError
from reasoned_explorer.viewer.security import within

#: How many folders deep runs are looked for.
DEPTH = 3
#: A folder that holds more than this is not what somebody means to look through.
_MOST_FOLDERS = 20_000
#: Runs whose missions are read before they are asked for; a large one takes a third of a second.
_MOST_AHEAD = 3


@dataclass(frozen=True, slots=True)
class _Found:
    """Where runs lie: folders of benches, and folders of missions by the folder that they lie in."""

    benches: tuple[Path, ...]
    missions: tuple[tuple[Path, tuple[Path, ...]], ...]


class Library:
    """The runs and missions in a folder; safe to use from several threads.

    Args:
        root: A run of ``rex bench``, the folder of a mission, or a folder that holds such folders at most `DEPTH` deep.
        is_awaited: Whether the folder may not be there yet: a mission is about to make it.

    Raises:
        RecordError: If there is no such folder.
    """

    def __init__(self, root: Path, *, is_awaited: bool = False) -> None:
        if (is_there(root) or not is_awaited) and not root.is_dir():
            fault = Fault(f"{root} is no folder", "a folder with runs, as rex run and rex bench leave them")
            raise RecordError("runs", [fault])
        self.root = root.resolve()
        self.name = root.name or self.root.name or str(root)
        self._runs: dict[str, Run] = {}
        self._lock = Lock()

    def runs(self) -> list[Run]:
        """Return the runs that are there now, by name. What was read of one is kept while it stays the same."""
        found = self._found()
        with self._lock:
            runs: dict[str, Run] = {}
            for folder in found.benches:
                key = self._id("bench", folder)
                kept = self._runs.get(key)
                runs[key] = kept or BenchRun(key, self._name(folder), folder, root=self.root)
            for parent, folders in found.missions:
                key = self._id("missions", parent)
                kept = self._runs.get(key)
                made = kept if isinstance(kept, MissionsRun) else MissionsRun(key, self._name(parent), parent)
                made.hold(folders, root=self.root)
                runs[key] = made
            self._runs = runs
            return sorted(runs.values(), key=lambda run: (run.name, run.id))

    def run(self, run_id: str) -> Run:
        """Return a run by its id.

        Raises:
            UnknownIdError: If there is none.
        """
        with self._lock:
            run = self._runs.get(run_id)
        if run is None:
            run = {each.id: each for each in self.runs()}.get(run_id)
        if run is None:
            raise UnknownIdError("run", [Fault("there is no such run", "one that is listed")])
        return run

    def check(self) -> None:
        """Check that there is something to show.

        Raises:
            RecordError: If there is no run and no mission.
        """
        if not self.runs():
            expected = f"a {STORE_NAME} or a {RECORD_NAME}, at most {DEPTH} folders deep"
            fault = Fault(f"{self.root} holds no run", expected, "rex run and rex bench leave some")
            raise RecordError("runs", [fault])

    def read_ahead(self) -> None:
        """Read what the page asks for first: the runs, and the missions of those that changed last."""
        with suppress(InputError, PartError):
            runs = self.runs()
            for run in runs:
                run.about()
            for run in sorted(runs, key=lambda run: _changed_s(run.folder), reverse=True)[:_MOST_AHEAD]:
                # One that cannot be read says so when it is asked for.
                with suppress(InputError, PartError):
                    run.listing_json()

    def mission_ids(self, folder: Path) -> tuple[str, str]:
        """Return by which run and mission ids the mission in a folder is listed, whether it is there yet or not."""
        parent = self._parent(folder)
        return self._id("missions", parent), MissionsRun.mission_id(folder, parent)

    def _parent(self, folder: Path) -> Path:
        return folder if folder == self.root else folder.parent

    def _id(self, kind: str, folder: Path) -> str:
        return opaque_id(kind, folder.relative_to(self.root).as_posix())

    def _name(self, folder: Path) -> str:
        place = folder.relative_to(self.root).as_posix()
        return self.name if place == "." else place

    def _found(self) -> _Found:
        benches: list[Path] = []
        missions: dict[Path, list[Path]] = {}
        for folder in self._folders(self.root, DEPTH, [_MOST_FOLDERS]):
            if within(self.root, folder / STORE_NAME):
                benches.append(folder)
            elif within(self.root, folder / RECORD_NAME):
                missions.setdefault(self._parent(folder), []).append(folder)
        return _Found(tuple(benches), tuple((parent, tuple(folders)) for parent, folders in missions.items()))

    def _folders(self, folder: Path, depth: int, left: list[int]) -> Iterator[Path]:
        """Go through a folder and those in it; what is inside of a run is its own."""
        yield folder
        if depth == 0 or is_there(folder / STORE_NAME) or is_there(folder / RECORD_NAME):
            return
        try:
            with os.scandir(folder) as entries:
                inner = sorted(
                    entry.name
                    for entry in entries
                    if not entry.name.startswith(".") and entry.is_dir(follow_symlinks=False)
                )
        except OSError:
            return  # what may not be read is not shown
        for name in inner:
            left[0] -= 1
            if left[0] < 0:
                return
            yield from self._folders(folder / name, depth - 1, left)


def _changed_s(folder: Path) -> float:
    """Return when a run last changed, as its disk tells the time; 0 where that cannot be told."""
    for path in (folder / STORE_NAME, folder):
        with suppress(OSError):
            return path.stat().st_mtime
    return 0.0
