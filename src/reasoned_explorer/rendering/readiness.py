"""Whether the renderer's compiled code is there already, and how it gets there.

numba compiles a kernel when it is first called, one at a time, and keeps it on disk. For all kernels of the renderer
that takes about as long as a person waits for anything. So, the first time, helpers (processes of their own) compile
while the scene is made, one part after the other; then this process takes what is left from the other end, and reads
from disk what they have left there.
"""

import os
import queue
import subprocess
import sys
import threading
from collections.abc import Callable, Sequence
from contextlib import suppress

from reasoned_explorer.model.stopping import stop_if_asked
from reasoned_explorer.rendering.keeping import compile_missing, is_kept, telling
from reasoned_explorer.rendering.progress import Progress

#: What can be compiled by itself; what takes longest first.
PARTS: tuple[str, ...] = ("shading", "drawing", "gathering", "shadows", "reading")
#: Roughly how many functions there are; only for people who wait.
FUNCTIONS = 56
_FIRST_TIME = "compiling the renderer, the first time only"


def is_ready() -> bool:
    """Return whether the renderer's code is compiled already, for this machine and as it is now."""
    return all(is_kept(part) for part in PARTS)


def begin() -> None:
    """Have what is missing compiled beside whatever this process does next; returns at once."""
    with _work.lock:
        _work.begin()


def make_ready(on_progress: Progress | None = None) -> None:
    """Return when the renderer's code is compiled.

    Args:
        on_progress: Told how far it is.

    Raises:
        KeyboardInterrupt: If a person asked to stop (see `reasoned_explorer.model.stopping`).
    """
    with _work.lock:
        _work.begin()
        _work.finish(on_progress or _nobody)


def cores() -> int:
    """Return how many processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class Work:
    """What one process does about it, once.

    Args:
        parts: What there is to compile.
        compile_part: Compiles a part in this process.
        command_for: The command line of a helper that compiles parts, and says a line for each function.
        helpers: How many there may be.

    Attributes:
        lock: To be held while anything is called.
    """

    def __init__(
        self,
        parts: Sequence[str],
        compile_part: Callable[[str], None],
        command_for: Callable[[Sequence[str]], Sequence[str]],
        helpers: int,
    ) -> None:
        self.lock = threading.Lock()
        self._parts, self._compile_part, self._command_for = parts, compile_part, command_for
        self._most = helpers
        self._lines: queue.SimpleQueue[str] = queue.SimpleQueue()
        self._is_begun = self._is_done = False
        self._functions = 0
        self._told = ""

    def begin(self) -> None:
        """Start helpers for what is missing, unless that was done before."""
        if self._is_begun:
            return
        self._is_begun = True
        missing = [part for part in self._parts if not is_kept(part)]
        for place in range(min(self._most, len(missing))):
            hand_on_lines(self._command_for([*missing[place:], *missing[:place]]), self._lines.put)

    def finish(self, on_progress: Progress) -> None:
        """Return when everything is compiled; what no helper is at is compiled here, from the other end."""
        if self._is_done:
            return

        def one_more(_: str) -> None:
            self._functions += 1
            self._listen(on_progress)

        left = self._parts[::-1]
        with telling(one_more):
            while left := [part for part in left if not is_kept(part)]:
                done = compile_missing(left, self._compile_part)
                left = [part for part in left if part not in done]
                self._listen(on_progress, wait_s=0.0 if done else 0.1)
        self._is_done = True

    def _listen(self, on_progress: Progress, wait_s: float = 0.0) -> None:
        """Take in what helpers have said, tell how far all is, and stop here if a person asked for it."""
        with suppress(queue.Empty):
            while True:
                self._lines.get(timeout=wait_s) if wait_s else self._lines.get_nowait()
                self._functions += 1
        told = f"{_FIRST_TIME}: about {min(90, 100 * self._functions // FUNCTIONS // 10 * 10)} %"
        if told != self._told:
            self._told = told
            on_progress(told)
        stop_if_asked()


def hand_on_lines(command: Sequence[str], hand_on: Callable[[str], None]) -> threading.Thread | None:
    """Start a process with the modules of this one, and a thread that hands on what it says.

    Args:
        command: Its command line.
        hand_on: Called with each line.

    Returns:
        The thread, which ends with the process; None where the process cannot be started.
    """
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
    try:
        process = subprocess.Popen(  # noqa: S603 - this very interpreter, with names of our own
            command,
            env=environment,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
    except OSError:
        return None

    def listen() -> None:
        with process:
            for line in process.stdout or ():
                hand_on(line.strip())

    thread = threading.Thread(target=listen, daemon=True)
    thread.start()
    return thread


def _compile(part: str) -> None:
    from reasoned_explorer.rendering.compilation import compile_part

    compile_part(part)


def _command_for(parts: Sequence[str]) -> list[str]:
    return [sys.executable, "-m", "reasoned_explorer.rendering.compilation", *parts]


def _nobody(_: str) -> None:
    pass


#: This process compiles, too.
_work = Work(PARTS, _compile, _command_for, min(cores(), len(PARTS)) - 1 if sys.executable else 0)
