"""Which room a mission's processor time goes to, by sampling the stack at an interval: nothing is slowed down by it."""

import signal
from collections import Counter
from types import FrameType, TracebackType
from typing import Self

_INTERVAL_S = 0.001
_PACKAGE = "reasoned_explorer/"
#: The first entry that a frame's file (and function) starts with; what has none is charged to its caller.
_ROOMS = (
    ("exploration/draft.py", "record"),
    ("exploration/explorer.py:Explorer._close_step", "record"),
    ("evaluation/record_file.py", "record"),
    ("evaluation/mission.py:Mission.header", "record"),
    ("evaluation/mission.py:Mission._summary", "judging"),
    ("evaluation/mission.py:Mission.__init__", "making ready"),
    ("evaluation/scoring", "judging"),
    ("evaluation/oracle.py", "minds"),
    ("task/", "judging"),
    ("simulation/eyes", "eyes"),
    ("simulation/caption", "captions"),
    ("perception/", "captions"),
    ("simulation/", "travel"),
    ("vehicles/", "travel"),
    ("minds/", "minds"),
    ("planning/", "planning"),
    ("exploration/", "exploration"),
    ("clock/", "event loop"),
)


class RoomsProfile:
    """Samples while it is entered; does nothing where there is no interval timer (Windows)."""

    def __init__(self) -> None:
        self.samples: Counter[str] = Counter()

    def shares(self, *, leave_out: str) -> list[tuple[str, float]]:
        """Return each room with its share of the samples, largest first, one room left out."""
        kept = {room: count for room, count in self.samples.items() if room != leave_out}
        return [(room, count / sum(kept.values())) for room, count in sorted(kept.items(), key=lambda item: -item[1])]

    def __enter__(self) -> Self:
        if hasattr(signal, "setitimer"):
            signal.signal(signal.SIGPROF, self._sample)
            signal.setitimer(signal.ITIMER_PROF, _INTERVAL_S, _INTERVAL_S)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if hasattr(signal, "setitimer"):
            signal.setitimer(signal.ITIMER_PROF, 0.0)
            signal.signal(signal.SIGPROF, signal.SIG_IGN)

    def _sample(self, _signal: int, frame: FrameType | None) -> None:
        room, inner = "other", frame
        ready = False
        while inner is not None:
            found = _room_of(inner)
            if found is not None and room == "other":
                room = found
            ready |= found == "making ready"
            inner = inner.f_back
        self.samples["making ready" if ready else room] += 1


def _room_of(frame: FrameType) -> str | None:
    file = frame.f_code.co_filename.replace("\\", "/")
    if "/asyncio/" in file:
        return "event loop"
    if _PACKAGE not in file:
        return None
    place = f"{file.rpartition(_PACKAGE)[2]}:{frame.f_code.co_qualname}"
    return next((room for start, room in _ROOMS if place.startswith(start)), None)
