"""When a frame was taken, by a clock of this computer."""

#: What a camera's clock may run apart from this computer's, as a share of the time.
_DRIFT = 1e-3
#: Times that jump by more than this, seconds, are of another stream.
_JUMP_S = 5.0


class Stamper:
    """Tells frames that come late from fresh ones.

    A frame that waited somewhere on its way (a slow network, a busy machine) arrives now and shows what was. So the
    least time that any frame was seen to take is taken for the way, and what another takes beyond it was waiting. The
    least time itself is not known: what is told is as late as the fastest frame.
    """

    def __init__(self) -> None:
        self._least_s: float | None = None
        self._last: tuple[float, float] | None = None

    def taken_s(self, told_s: float | None, arrived_s: float) -> float:
        """Return when a frame was taken.

        Args:
            told_s: When the camera says so, on a clock of its own; None where it does not.
            arrived_s: When it came here.
        """
        if told_s is None:
            return arrived_s
        way_s, last = arrived_s - told_s, self._last
        self._last = told_s, arrived_s
        if self._least_s is None or last is None or not -0.001 <= told_s - last[0] <= _JUMP_S:
            self._least_s = way_s
        else:
            self._least_s = min(way_s, self._least_s + _DRIFT * max(0.0, arrived_s - last[1]))
        return told_s + self._least_s
