"""Virtual time that goes on from one run to the next."""

from collections.abc import Callable, Coroutine
from typing import Any, TypeVar

from reasoned_explorer.model.errors import Fault, SettingsError

T = TypeVar("T")


class SteppedClock:
    """A virtual clock for programs that act step by step and do other things in between, where no time passes.

    Each `run` goes on where the last one ended. It needs no event loop, so that it also works where one runs already,
    as in a notebook; in return one thing happens after the other: what runs on it cannot wait for two at once.
    """

    name = "virtual"

    def __init__(self) -> None:
        self._now_s = 0.0

    def now_s(self) -> float:
        """Return the mission time, seconds."""
        return self._now_s

    async def act(self, duration_s: float) -> None:
        """Jump over the seconds that a simulated body needs."""
        self._now_s += max(0.0, duration_s)

    async def think(self, duration_s: float) -> None:
        """Jump over the seconds that a decision takes."""
        self._now_s += max(0.0, duration_s)

    async def live(self, call: Callable[[], Coroutine[Any, Any, T]]) -> tuple[T, float]:  # noqa: ARG002 - the protocol's
        """Refuse: how long a real call takes cannot be jumped over.

        Raises:
            SettingsError: Always.
        """
        raise _refusal("a model is to be called")

    def run(self, mission: Coroutine[Any, Any, T]) -> T:
        """Run a part of a mission in virtual time.

        Raises:
            SettingsError: If it waits for anything but this clock.
        """
        try:
            mission.send(None)
        except StopIteration as ended:
            result: T = ended.value
            return result
        mission.close()
        raise _refusal("something real is waited for")


def _refusal(what: str) -> SettingsError:
    return SettingsError("clock", [Fault(f"{what} while the clock is virtual", "a mixed or a real clock")])
