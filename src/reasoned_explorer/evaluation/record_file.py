"""A mission's record on disk: one JSON line for the header, one for each step as it ends, one for the summary.

A record whose disk ran full is cut back to its last whole step and, where there is room for that, says what happened;
one whose process was killed is read to its last whole step and has no summary. Nothing in a record depends on wall time
or on where it is kept, so that the same mission writes the same bytes.
"""

import json
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from pydantic import TypeAdapter, ValidationError

from reasoned_explorer.model import Fault, RecordError, RecordWriteError
from reasoned_explorer.model.checks import path_of
from reasoned_explorer.model.disk import append_line, disk_error, in_words
from reasoned_explorer.model.record import RECORD_SCHEMA, EpisodeRecord, MissionHeader, MissionSummary, StepRecord

RECORD_NAME = "record.jsonl"

_HEADER = TypeAdapter(MissionHeader)
_STEP = TypeAdapter(StepRecord)
_SUMMARY = TypeAdapter(MissionSummary)


class RecordWriter:
    """Writes a record while the mission runs; a context manager.

    What cannot be written whole is cut off again. A record that fails before its first whole step is taken away, and
    the folders that were made for it with it.

    Args:
        folder: Of the record; made where it is not there. It must not hold a record already.

    Raises:
        RecordError: If the folder cannot be made or holds a record.
        PartError: If the disk fails.
        RecordWriteError: From each line that cannot be written: the disk is full, say.
    """

    def __init__(self, folder: Path) -> None:
        self.path = folder / RECORD_NAME
        self._whole_bytes = self._whole_steps = 0
        self._made: list[Path] = []
        try:
            self._made = [each for each in (folder, *folder.parents) if not each.exists()]
            folder.mkdir(parents=True, exist_ok=True)
            # Unbuffered: a killed process loses the step that it was in and no other.
            self._file = self.path.open("xb", buffering=0)
        except FileExistsError as error:
            fault = Fault(f"{self.path} is there already", "a folder without a record", "give another folder")
            raise RecordError("record", [fault]) from error
        except OSError as error:
            self._take_away()
            raise disk_error("record", self.path, error, kind=RecordError) from error

    def header(self, header: MissionHeader) -> None:
        """Write the first line."""
        self._line(b"header", _HEADER.dump_json(header))

    def step(self, step: StepRecord) -> None:
        """Write one step."""
        self._line(b"step", _step_bytes(step))
        self._whole_steps += 1

    def summary(self, summary: MissionSummary) -> None:
        """Write the last line."""
        self._line(b"summary", _SUMMARY.dump_json(summary))

    def close(self) -> None:
        """Close the file; safe to call twice."""
        self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
        if isinstance(error, RecordWriteError) and self._whole_steps == 0:
            self._take_away()

    def _take_away(self) -> None:
        with suppress(OSError):
            self.path.unlink(missing_ok=True)
        with suppress(OSError):
            for folder in self._made:
                folder.rmdir()

    def _line(self, kind: bytes, payload: bytes) -> None:
        line = b'{"' + kind + b'":' + payload + b"}\n"
        try:
            self._whole_bytes = append_line(self._file, line, self._whole_bytes)
        except OSError as error:
            raise RecordWriteError(f"record: {in_words(self.path, error)}") from error


def read_record(folder: Path | str) -> EpisodeRecord:
    """Return the record in a folder (or the record file itself).

    A last line that was cut off is left out.

    Raises:
        RecordError: If there is no record, it is of another version, or a line other than the last is broken.
    """
    path = path_of(folder, "record", RecordError)
    try:
        if path.is_dir():
            path /= RECORD_NAME
        data = path.read_bytes()
    except OSError as error:
        fault = Fault(f"{path}: {error.strerror}", "the folder of a run", "rex run leaves one")
        raise RecordError("record", [fault]) from error
    return parse_record(data, path)


def record_bytes(record: EpisodeRecord) -> bytes:
    """Return a record as `RecordWriter` writes it, to the byte."""
    lines = [b'{"header":' + _HEADER.dump_json(record.header) + b"}\n"]
    lines += [b'{"step":' + _step_bytes(step) + b"}\n" for step in record.steps]
    if record.summary is not None:
        lines.append(b'{"summary":' + _SUMMARY.dump_json(record.summary) + b"}\n")
    return b"".join(lines)


def _step_bytes(step: StepRecord) -> bytes:
    # Left out where there are none: missions without a guard write what they always wrote.
    return _STEP.dump_json(step, exclude=None if step.interventions else {"interventions"})


def parse_record(data: bytes, path: Path) -> EpisodeRecord:
    """Return the record that a file holds.

    Args:
        data: What is in the file.
        path: Where it lies, for messages.

    Raises:
        RecordError: As `read_record`.
    """
    lines = data.split(b"\n")
    # After a whole last line comes an empty rest; anything else was cut off.
    whole = lines[:-1]
    if not whole:
        raise RecordError("record", [Fault(f"{path} is empty or cut off in its first line", "a header line")])
    header: MissionHeader | None = None
    summary: MissionSummary | None = None
    steps: list[StepRecord] = []
    for number, line in enumerate(whole, start=1):
        kind, payload = _parsed(path, number, line)
        try:
            if number == 1:
                header = _read_header(path, kind, payload)
            elif kind == "step" and summary is None:
                steps.append(_STEP.validate_python(payload))
            elif kind == "summary" and summary is None:
                summary = _SUMMARY.validate_python(payload)
            else:
                raise _line_error(path, number, f"holds {kind!r}", "a step, then one summary at the end")
        except ValidationError as error:
            raise _line_error(
                path, number, f"{error.error_count()} faults, {error.errors()[0]['msg']}", kind
            ) from error
    if header is None:
        raise _line_error(path, 1, "holds no header", "a header")
    return EpisodeRecord(header, tuple(steps), summary)


def _parsed(path: Path, number: int, line: bytes) -> tuple[str, Any]:
    try:
        entry = json.loads(line)
    except ValueError as error:
        raise _line_error(path, number, f"is not JSON ({error})", "one JSON object a line") from error
    if not isinstance(entry, dict) or len(entry) != 1:
        raise _line_error(path, number, "is not an object with one key", '{"step": …}')
    return next(iter(entry.items()))


def _read_header(path: Path, kind: str, payload: Any) -> MissionHeader:
    schema = payload.get("schema") if kind == "header" and isinstance(payload, dict) else None
    if schema != RECORD_SCHEMA:
        raise _line_error(path, 1, f"is {kind!r} of version {schema}", f"a header of version {RECORD_SCHEMA}")
    return _HEADER.validate_python(payload)


def _line_error(path: Path, number: int, what: str, expected: str) -> RecordError:
    return RecordError("record", [Fault(f"{path}, line {number} {what}", expected)])
