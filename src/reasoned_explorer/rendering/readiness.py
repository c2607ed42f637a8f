"""Whether the renderer's compiled code is there already, and how it gets there.

numba compiles a kernel when it is first called, one at a time, and keeps it on disk. For all kernels of the renderer
that takes about as long as a person waits for anything. So, the first time, helpers (processes of their own) compile
a share each while the scene is made, and this process reads from disk what they leave there.
"""

import hashlib
import os
import queue
import subprocess
import sys
import threading
from collections.abc import Callable, Sequence
from functools import lru_cache
from pathlib import Path

import numba
from numba.core.registry import cpu_target

from reasoned_explorer.model.stopping import stop_if_asked
from reasoned_explorer.rendering.compiling import cache_folder

#: Told, now and then, what takes long.
Progress = Callable[[str], None]
#: What can be compiled by itself; one helper's share after the other, about equally much in each.
SHARES: tuple[tuple[str, ...], ...] = (("shading",), ("raster", "shadows"))
#: Roughly how many functions there are; only for people who wait.
FUNCTIONS = 66
_FIRST_TIME = "compiling the renderer, the first time only"


def is_ready() -> bool:
    """Return whether the renderer's code is compiled already, for this machine and as it is now."""
    return all(is_kept(part) for share in SHARES for part in share)


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


def is_kept(part: str) -> bool:
    """Return whether a part is compiled already."""
    folder = cache_folder()
    if folder is None:
        return True
    try:
        return _note_of(folder, part).read_text(encoding="utf-8") == _fingerprint()
    except OSError:
        return False


def keep(part: str) -> None:
    """Note that a part is compiled, which `is_kept` then finds."""
    folder = cache_folder()
    if folder is not None:
        note = _note_of(folder, part)
        beside = note.with_suffix(f".{os.getpid()}")
        try:
            beside.write_text(_fingerprint(), encoding="utf-8")
            beside.replace(note)
        except OSError:
            beside.unlink(missing_ok=True)


class _Work:
    """What this process has done about it."""

    def __init__(self) -> None:
        self.lock = threading.Lock()
        self._helpers: list[_Helper] = []
        self._lines: queue.SimpleQueue[str | None] = queue.SimpleQueue()
        self._is_begun = self._is_done = False

    def begin(self) -> None:
        if self._is_begun:
            return
        self._is_begun = True
        if sys.executable and _cores() > 1:
            missing = [tuple(part for part in share if not is_kept(part)) for share in SHARES]
            self._helpers = [_Helper(share, self._lines) for share in missing if share]

    def finish(self, on_progress: Progress) -> None:
        if self._is_done:
            return
        ended = functions = 0
        while ended < len(self._helpers):
            stop_if_asked()
            try:
                line = self._lines.get(timeout=0.1)
            except queue.Empty:
                continue
            ended += line is None
            functions += line is not None
            on_progress(f"{_FIRST_TIME}: about {min(99, 100 * functions // FUNCTIONS)} %")
        # What no helper could compile, or what is kept no longer.
        for part in (part for share in SHARES for part in share):
            if not is_kept(part):
                from reasoned_explorer.rendering.compilation import compile_part

                on_progress(f"{_FIRST_TIME}: {part}")
                compile_part(part)
                keep(part)
                stop_if_asked()
        self._is_done = True


class _Helper:
    """A process that compiles parts and says a line for each function; a thread hands them on, and None at the end."""

    def __init__(self, parts: Sequence[str], lines: "queue.SimpleQueue[str | None]") -> None:
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(path for path in sys.path if path)}
        command = [sys.executable, "-m", "reasoned_explorer.rendering.compilation", *parts]
        self._lines = lines
        try:
            self._process = subprocess.Popen(  # noqa: S603 - this very interpreter, with names of our own
                command,
                env=environment,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
                text=True,
            )
        except OSError:
            lines.put(None)
            return
        threading.Thread(target=self._hand_on, daemon=True).start()

    def _hand_on(self) -> None:
        with self._process as process:
            for line in process.stdout or ():
                self._lines.put(line.strip())
        self._lines.put(None)


_work = _Work()


def _nobody(_: str) -> None:
    pass


def _note_of(folder: Path, part: str) -> Path:
    return folder / f"renderer-{part}.ready"


@lru_cache(maxsize=1)
def _fingerprint() -> str:
    """Of all that decides whether numba can use again what it keeps: itself, the processor, the sources."""
    found = hashlib.sha256()
    processor = cpu_target.target_context.codegen().magic_tuple()
    found.update(f"{sys.version}\n{numba.__version__}\n{processor}\n".encode())
    for source in sorted(Path(__file__).parent.glob("*.py")):
        state = source.stat()
        found.update(f"{source.name} {state.st_size} {state.st_mtime_ns}\n".encode())
    return found.hexdigest()


def _cores() -> int:
    """How many processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
