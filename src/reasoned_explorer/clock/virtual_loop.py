"""An asyncio event loop whose time jumps to the next thing that is due instead of waiting for it.

It hands the standard loop a selector that never waits: where nothing is ready, it moves the loop's own time on by as
long as the loop would have slept. Sleeps, time-outs and cancellation therefore work as in real time, in the order of
their times. Made here since the libraries that do it patch private parts of the loop or come with pytest plugins that
interfere with their users' tests.
"""

import asyncio
import selectors
from collections.abc import Mapping
from typing import Any


class NeverWaiting(selectors.BaseSelector):
    """A selector that moves the time ``now_s`` on instead of waiting."""

    def __init__(self) -> None:
        self.now_s = 0.0
        self._real = selectors.DefaultSelector()

    def select(self, timeout: float | None = None) -> list[tuple[selectors.SelectorKey, int]]:
        """Return what is ready; where nothing is, let the time be as much later as the loop would have slept."""
        if timeout is None:
            # Nothing is scheduled: only a thread or a signal can bring something, and for that one has to wait.
            return self.wait(None)
        if timeout <= 0.0:
            return []  # something is ready to run: the system need not be asked
        ready = self._real.select(0)
        if not ready:
            self.now_s += max(0.0, timeout)
        return ready

    def wait(self, real_s: float | None) -> list[tuple[selectors.SelectorKey, int]]:
        """Wait for something to be ready, at most so many real seconds."""
        return self._real.select(real_s)

    def register(self, fileobj: Any, events: int, data: Any = None) -> selectors.SelectorKey:
        """Watch a file."""
        return self._real.register(fileobj, events, data)

    def unregister(self, fileobj: Any) -> selectors.SelectorKey:
        """Watch a file no longer."""
        return self._real.unregister(fileobj)

    def modify(self, fileobj: Any, events: int, data: Any = None) -> selectors.SelectorKey:
        """Watch for something else."""
        return self._real.modify(fileobj, events, data)

    def close(self) -> None:
        """Release what the system holds."""
        self._real.close()

    def get_map(self) -> Mapping[Any, selectors.SelectorKey]:
        """Return what is watched."""
        return self._real.get_map()


class VirtualEventLoop(asyncio.SelectorEventLoop):
    """The standard loop in virtual time, which starts at 0. Real sockets and threads must not be awaited in it.

    Args:
        selector: What moves the time on.
    """

    def __init__(self, selector: NeverWaiting | None = None) -> None:
        self._virtual = NeverWaiting() if selector is None else selector
        super().__init__(self._virtual)

    def time(self) -> float:
        """Return the virtual time, seconds."""
        return self._virtual.now_s
