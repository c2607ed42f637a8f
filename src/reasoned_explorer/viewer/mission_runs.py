"""Missions of ``rex run`` that lie in one folder, as the page shows them."""

import json
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from threading import Lock
from typing import Any

from reasoned_explorer.evaluation.picture_folder import PICTURES_NAME
from reasoned_explorer.evaluation.record_file import RECORD_NAME
from reasoned_explorer.evaluation.report.causes import cause_among
from reasoned_explorer.model import Fault, RecordError
from reasoned_explorer.viewer.listing import NOT_JUDGED, Listing, opaque_id, outcome_word
from reasoned_explorer.viewer.runs import MissionFiles, UnknownIdError
from reasoned_explorer.viewer.security import within
from reasoned_explorer.world.opening import KEPT_SUFFIX

#: As `rex run` keeps it beside the record.
WORLD_NAME = f"world{KEPT_SUFFIX}"
#: What became of a mission whose record has no summary: it is still going on, or was cut off.
UNFINISHED = "not finished"
_BLOCK = 1 << 16
#: A line of a record is not longer than this; what is longer is none. Bytes.
_LONGEST_LINE = 1 << 26


@dataclass(frozen=True, slots=True)
class _Row:
    state: tuple[int, int, int]
    cells: Mapping[str, Any]


class MissionsRun:
    """Missions in one folder; safe to use from several threads.

    Args:
        run_id: Made by the library.
        name: For people.
        folder: That holds the missions' folders, or is the only mission's own.
    """

    def __init__(self, run_id: str, name: str, folder: Path) -> None:
        self.id, self.name, self.folder = run_id, name, folder
        self._lock = Lock()
        self._missions: dict[str, Path] = {}
        self._root = folder
        self._rows: dict[str, _Row] = {}

    @staticmethod
    def mission_id(folder: Path, parent: Path) -> str:
        """Return by which id the mission in a folder is listed."""
        return opaque_id("mission", folder.relative_to(parent).as_posix())

    @property
    def kind(self) -> str:
        """``mission`` where the folder is a mission's own, else ``missions``."""
        return "mission" if list(self._missions.values()) == [self.folder] else "missions"

    def hold(self, folders: Sequence[Path], *, root: Path) -> None:
        """Take note of which missions are there now.

        Args:
            folders: Of the missions.
            root: What nothing may lead out of, resolved.
        """
        with self._lock:
            self._root = root
            self._missions = {self.mission_id(folder, self.folder): folder for folder in folders}

    def about(self) -> Mapping[str, Any]:
        """Return what the list of runs says of it."""
        rows = self._all_rows()
        return {
            "id": self.id,
            "name": self.name,
            "kind": self.kind,
            "missions": len(rows),
            "methods": sorted({row["method"] for row in rows if row.get("method")}),
            "made_by": ", ".join(sorted({row["made_by"] for row in rows if row.get("made_by")})),
        }

    def listing(self) -> Listing:
        """Return its missions; one whose record cannot be read is listed with what is wrong with it."""
        return Listing.of(self._all_rows())

    def listing_json(self) -> bytes:
        """Return the listing as the page reads it."""
        return self.listing().as_json({"id": self.id, "name": self.name, "kind": self.kind})

    def mission(self, mission_id: str) -> MissionFiles:
        """Return a mission.

        Raises:
            UnknownIdError: If there is none.
            RecordError: If its record cannot be read.
        """
        with self._lock:
            folder = self._missions.get(mission_id)
        path = within(self._root, folder / RECORD_NAME) if folder else None
        if folder is None or path is None:
            raise UnknownIdError("mission", [Fault("there is no such mission in this run", "one that is listed")])
        try:
            data = path.read_bytes()
        except OSError as error:
            raise RecordError("record", [Fault(f"{RECORD_NAME}: {error.strerror or error}", "a record")]) from error
        pictures = within(self._root, folder / PICTURES_NAME)
        return MissionFiles(
            id=mission_id,
            name=self.name if folder == self.folder else folder.name,
            record=data,
            pictures=pictures if pictures and pictures.is_dir() else None,
            world=within(self._root, folder / WORLD_NAME),
            method=str(self._row(mission_id, folder).get("method") or ""),
            pair_key=str(self._row(mission_id, folder).get("pair_key") or ""),
        )

    def _all_rows(self) -> list[Mapping[str, Any]]:
        with self._lock:
            missions = dict(self._missions)
        return [self._row(mission_id, folder) for mission_id, folder in missions.items()]

    def _row(self, mission_id: str, folder: Path) -> Mapping[str, Any]:
        path = within(self._root, folder / RECORD_NAME)
        state = (0, 0, 0)
        with suppress(OSError):
            if path is not None:
                found = path.stat()
                state = (found.st_mtime_ns, found.st_size, found.st_ino)
        kept = self._rows.get(mission_id)
        if kept is None or kept.state != state:
            kept = self._rows[mission_id] = _Row(state, _read_row(mission_id, folder, path))
        return kept.cells


def _read_row(mission_id: str, folder: Path, path: Path | None) -> Mapping[str, Any]:
    """Return the cells of a mission by their names, from the first line of its record and its last."""
    row: dict[str, Any] = {"id": mission_id, "mission_id": folder.name, "has_record": 0}
    try:
        if path is None:
            raise ValueError("it leads out of the folder")
        header, last = _ends_of(path)
        row |= {"has_record": 1, **_of_header(header), **_of_end(header, last)}
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        said = error.strerror if isinstance(error, OSError) else str(error)
        row["fault"] = f"its record cannot be read: {said or type(error).__name__}"
    return row


def _of_header(header: Mapping[str, Any]) -> dict[str, Any]:
    settings = header.get("settings") or {}
    # Missions are of one episode where goal, world, start and vehicle are the same.
    episode = (header["goal"], header["world"], header["world_digest"], header["start"], header["vehicle"])
    return {
        "method": settings.get("planner") or header["planner"],
        "level": header["level"],
        "place": header["world"],
        "goal": header["goal"],
        "vehicle": header["vehicle"],
        "seed": header["seed"],
        "made_by": str(header["versions"].get("reasoned-explorer", "")),
        "pair_key": opaque_id("episode", json.dumps(episode)),
        "mission_id": opaque_id("episode", json.dumps(episode)),
    }


def _of_end(header: Mapping[str, Any], last: Mapping[str, Any]) -> dict[str, Any]:
    summary = last.get("summary")
    if summary is None:
        step = last.get("step") or {}
        tried = {"ct_s": step.get("ct_s"), "tt_s": step.get("tt_s"), "steps": step["step"] + 1 if step else 0}
        return {"outcome": NOT_JUDGED, "cause": UNFINISHED, **tried}
    limit_s = float(((header.get("settings") or {}).get("explorer") or {}).get("t_max_s", float("inf")))
    cause: str = summary["end"]
    if summary["success"] is not None:
        cause = cause_among(
            summary["end"],
            success=bool(summary["success"]),
            declared=bool(summary["declared"]),
            over_time=summary["ct_s"] + summary["tt_s"] > limit_s,
            compliant=summary["compliant"],
            oracle_success=bool(summary["oracle_success"]),
        ).value
    names = ("end", "spl", "casr", "ct_s", "tt_s", "steps", "path_length_m")
    return {"outcome": outcome_word(summary["success"]), "cause": cause, **{name: summary[name] for name in names}}


def _ends_of(path: Path) -> tuple[Mapping[str, Any], Mapping[str, Any]]:
    """Return the header of a record and its last whole line, without reading what is between.

    Raises:
        ValueError: If there is no header, or either is no JSON.
    """
    with path.open("rb") as file:
        first = file.readline(_LONGEST_LINE)
        if not first.endswith(b"\n"):
            raise ValueError("it is empty or cut off in its first line")
        header = json.loads(first)["header"]
        if not isinstance(header, dict):
            raise ValueError("its first line is no header")  # noqa: TRY004 - of a file
        size = file.seek(0, 2)
        tail = b""
        while size > len(first) and len(tail) < _LONGEST_LINE:
            begin = max(len(first), size - _BLOCK)
            file.seek(begin)
            tail = file.read(size - begin) + tail
            size = begin
            # After the last line break comes what was cut off; before it, back to the one before, the last whole line.
            if tail.count(b"\n") > 1:
                break
        lines = tail.split(b"\n")[:-1]
        last = json.loads(lines[-1]) if lines else {}
        if not isinstance(last, dict):
            raise ValueError("its last line is neither a step nor a summary")  # noqa: TRY004
        return header, last
