"""Every call of a run on a tape, and the same run again from the tape, without a model.

A tape is a file of JSON lines: a header, one line a call as it ends, and a last line where the run ended by itself. It
holds answers, seconds and SHA-256 of what was asked; neither the questions, nor pictures, nor keys. A process that is
killed leaves the calls that had ended; a last line that was cut off is left out when the tape is read.
"""

import json
import math
from collections import defaultdict, deque
from collections.abc import Mapping
from dataclasses import asdict, dataclass, fields
from enum import StrEnum
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from pydantic import TypeAdapter, ValidationError

from reasoned_explorer.calls.chat import ChatAnswer, ChatRequest
from reasoned_explorer.calls.secrets import scrub
from reasoned_explorer.calls.stored import RequestParts, answer_as_json, parts_of
from reasoned_explorer.model.checks import path_of
from reasoned_explorer.model.disk import append_line, disk_error, in_words
from reasoned_explorer.model.errors import Fault, RecordError, RecordWriteError

#: Version of the format; a tape of another one is refused.
TAPE_SCHEMA = 1


class Outcome(StrEnum):
    """How a call ended."""

    ANSWERED = "answered"
    """With an answer or with a fault of the model."""
    CANCELLED = "cancelled"
    """Whoever asked did not wait for the end."""
    DENIED = "denied"
    """It did not begin: the budget was spent."""


@dataclass(frozen=True, slots=True)
class TapedCall:
    """One call on a tape.

    Attributes:
        asked: Running number, from 0, in the order of asking; lines stand in the order of ending.
        role: Of the request.
        key: Likewise.
        digest: Of all that decides the answer.
        parts: That, one by one, so that a miss can say what differs.
        outcome: How it ended.
        seconds: That were charged; those so far for a cancelled call.
        answer: What came back; for a cancelled call what had come by then, or nothing.
        cached: Whether it came from a store of answers.
    """

    asked: int
    role: str
    key: tuple[int, ...]
    digest: str
    parts: RequestParts
    outcome: Outcome
    seconds: float
    answer: ChatAnswer
    cached: bool = False


@dataclass(frozen=True, slots=True)
class Miss:
    """What is not on the tape, and why, for people."""

    reason: str


_CALL = TypeAdapter(TapedCall)


class TapeRecorder:
    """Writes a tape; a context manager. Several callers of one process may share it.

    Args:
        path: Of the tape; there must be no such file.
        about: What the run was started with, for people and for whoever replays it.

    Raises:
        RecordError: If the file is there already or cannot be made there.
        PartError: If the disk fails.
        RecordWriteError: From each call that cannot be written: the disk is full, say. What was written stays.
    """

    def __init__(self, path: Path | str, *, about: Mapping[str, Any] | None = None) -> None:
        self.path = path_of(path, "tape", RecordError)
        self._asked = self._calls = self._whole_bytes = 0
        try:
            # Unbuffered: a killed process loses no call that had ended.
            self._file = self.path.open("xb", buffering=0)
        except FileExistsError as error:
            fault = Fault(f"{self.path} is there already", "a name without a file", "give another name, or delete it")
            raise RecordError("tape", [fault]) from error
        except OSError as error:
            raise disk_error("tape", self.path, error, kind=RecordError) from error
        self._line({"tape": TAPE_SCHEMA, "about": dict(about or {})})

    @classmethod
    def going_on(cls, path: Path | str) -> "TapeRecorder":
        """Write on, on the tape of a run that ended early.

        Calls that were cancelled or denied at the end of that run are taken off: they are to be made anew.

        Args:
            path: Of the tape; it is written anew beside itself and then put in its place.

        Raises:
            RecordError, RecordWriteError: As when a tape is read and when one is begun.
        """
        past = TapePlayer(path, unfinished=True)
        half = past.path.with_name(f"{past.path.name}.half")
        half.unlink(missing_ok=True)
        recorder = cls(half, about=past.about)
        try:
            for call in past.calls:
                recorder.add(call)
            half.replace(past.path)
        except BaseException as error:
            recorder._file.close()
            half.unlink(missing_ok=True)
            if isinstance(error, OSError):
                raise disk_error("tape", past.path, error, kind=RecordError) from error
            raise
        recorder.path = past.path
        recorder._asked = max((call.asked for call in past.calls), default=-1) + 1
        return recorder

    def next_number(self) -> int:
        """Return the number of a call that is asked now."""
        self._asked += 1
        return self._asked - 1

    def add(self, call: TapedCall) -> None:
        """Write a call down."""
        content = {each.name: getattr(call, each.name) for each in fields(call)}
        self._line({"call": content | {"parts": asdict(call.parts), "answer": answer_as_json(call.answer)}})
        self._calls += 1

    def close(self) -> None:
        """Say that the tape is whole, and close it; safe to call twice."""
        if not self._file.closed:
            try:
                self._line({"end": {"calls": self._calls}})
            finally:
                self._file.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if error is None:
            self.close()
        else:
            self._file.close()

    def _line(self, content: Mapping[str, Any]) -> None:
        line = scrub(json.dumps(content, separators=(",", ":"))).encode() + b"\n"
        try:
            self._whole_bytes = append_line(self._file, line, self._whole_bytes)
        except OSError as error:
            raise RecordWriteError(f"tape: {in_words(self.path, error)}") from error


class TapePlayer:
    """Answers from a tape, and from nothing else.

    The same request for the same scene gets its answer; where it was asked several times, the answers come in the
    order of asking.

    Args:
        path: Of the tape.
        unfinished: It is of a run that ended early and is to be gone on with: calls that were cancelled or denied, and
            those at the end that were lost, are left out, since they are to be made anew.

    Attributes:
        path: Of the tape.
        calls: All that is on it, in the order of ending.
        about: What the run was started with.
        complete: Whether the run ended by itself; if not, the tape may end before the run that is replayed.

    Raises:
        RecordError: If there is no tape, it is of another version, or a line other than the last is broken.
    """

    def __init__(self, path: Path | str, *, unfinished: bool = False) -> None:
        self.path = path_of(path, "tape", RecordError)
        self.calls, self.about, self.complete = _read(self.path)
        if unfinished:
            self.calls = [call for call in self.calls if call.outcome is Outcome.ANSWERED]
            while self.calls and self.calls[-1].answer.fault is not None:
                self.calls.pop()
        self._left: dict[tuple[str, tuple[int, ...], str], deque[TapedCall]] = defaultdict(deque)
        self._of_scene: dict[tuple[str, tuple[int, ...]], list[TapedCall]] = defaultdict(list)
        for call in sorted(self.calls, key=lambda call: call.asked):
            self._left[call.role, call.key, call.digest].append(call)
            self._of_scene[call.role, call.key].append(call)

    def play(self, fingerprint: str, request: ChatRequest) -> TapedCall | Miss:
        """Return what a request to a model got then, or what differs from all that was asked then."""
        parts = parts_of(fingerprint, request)
        left = self._left.get((request.role, tuple(request.key), parts.digest))
        if left:
            return left.popleft()
        return Miss(f"{self.path} holds no answer to this: {self._why(request, parts, known=left is not None)}")

    def _why(self, request: ChatRequest, parts: RequestParts, *, known: bool) -> str:
        scene = f"the {request.role} about scene {'/'.join(map(str, request.key))}"
        cut = "" if self.complete else "; the tape was cut off, its run did not end by itself"
        if known:
            return f"{scene} was asked the same less often{cut}"
        others = [
            _differences(call.parts, parts) for call in self._of_scene.get((request.role, tuple(request.key)), ())
        ]
        others.sort(key=len)
        if not others:
            return f"{scene} was not asked anything{cut or ': the run went another way before, under other settings'}"
        return f"{scene} was asked something else: {'; '.join(others[0])}"


#: What a difference in a part is called that is kept as a digest only.
_HASHED = {
    "system": "the instructions differ under the same version of the prompt",
    "question": "the text of the question differs (another goal, world, seed or setting, or an answer before it)",
    "pictures": "the pictures differ",
    "schema": "the schema of the answer differs",
}


def _differences(then: RequestParts, now: RequestParts) -> list[str]:
    """Return how two requests differ, in words, what explains most first."""
    names = [each.name for each in fields(RequestParts)]
    different = [name for name in names if getattr(then, name) != getattr(now, name)]
    if "prompt" in different:
        # Another version of a prompt has other words and perhaps another schema: that needs no saying.
        different = [name for name in different if name not in {"system", "question", "schema"}]
    return [
        _HASHED.get(name) or f"{name} {getattr(then, name)} on the tape, {scrub(str(getattr(now, name)))} now"
        for name in different
    ]


def _read(path: Path) -> tuple[list[TapedCall], Mapping[str, Any], bool]:
    try:
        content = path.read_bytes()
    except OSError as error:
        fault = Fault(f"{path} cannot be read: {error.strerror or error}", "a tape that --record wrote")
        raise RecordError("tape", [fault]) from error
    lines = content.split(b"\n")
    # After the last whole line there is nothing, or what a killed process was writing.
    whole = lines[:-1]
    about = _header(path, whole[0] if whole else b"")
    calls: list[TapedCall] = []
    faults: list[Fault] = []
    complete = False
    for number, line in enumerate(whole[1:], start=2):
        try:
            content_of = json.loads(line)
            if "end" in content_of:
                complete = True
                continue
            call = _CALL.validate_python(content_of["call"])
            if not (math.isfinite(call.seconds) and call.seconds >= 0.0):
                raise ValueError("seconds")
            calls.append(call)
        except (ValueError, KeyError, TypeError, ValidationError):
            faults.append(Fault(f"line {number} of {path} is broken", "a call as it was written", "record it anew"))
    if faults:
        raise RecordError("tape", faults)
    return calls, about, complete


def _header(path: Path, line: bytes) -> Mapping[str, Any]:
    try:
        header = json.loads(line)
        version, about = header["tape"], header["about"]
    except (ValueError, KeyError, TypeError):
        raise RecordError("tape", [Fault(f"{path} is no tape", "a tape that --record wrote")]) from None
    if version != TAPE_SCHEMA or not isinstance(about, dict):
        fault = Fault(f"{path} has version {version!r}", f"version {TAPE_SCHEMA}", "record it anew")
        raise RecordError("tape", [fault])
    return about
