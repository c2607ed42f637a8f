"""What of the renderer's code is compiled already, for this machine and as it is now, and who compiles what is not."""

import hashlib
import os
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from functools import lru_cache
from pathlib import Path
from typing import IO

import numba
import numba.core.event

from reasoned_explorer.rendering.cache import cache_folder, processor


def is_kept(part: str) -> bool:
    """Return whether a part is compiled already."""
    folder = cache_folder()
    if folder is None:
        return True
    try:
        return _note_of(folder, part).read_text(encoding="utf-8") == _fingerprint()
    except (OSError, UnicodeDecodeError):
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
            with suppress(OSError):
                beside.unlink(missing_ok=True)


def compile_missing(parts: Iterable[str], compile_part: Callable[[str], None]) -> list[str]:
    """Compile those parts that are neither kept yet nor what another process is at.

    Args:
        parts: Which, in this order.
        compile_part: Does it.

    Returns:
        What was compiled here.
    """
    done = []
    for part in parts:
        if not is_kept(part):
            with _alone(part) as is_free:
                if is_free and not is_kept(part):
                    compile_part(part)
                    keep(part)
                    done.append(part)
    return done


@contextmanager
def telling(on_function: Callable[[str], None]) -> Iterator[None]:
    """Have something told the name of each function that numba has compiled within a ``with`` block."""
    teller = _Teller(on_function)
    numba.core.event.register("numba:compile", teller)
    try:
        yield
    finally:
        numba.core.event.unregister("numba:compile", teller)


class _Teller(numba.core.event.Listener):  # type: ignore[misc]
    def __init__(self, on_function: Callable[[str], None]) -> None:
        self._on_function = on_function

    def on_start(self, event: numba.core.event.Event) -> None:
        pass

    def on_end(self, event: numba.core.event.Event) -> None:
        self._on_function(event.data["dispatcher"].py_func.__name__)


@contextmanager
def _alone(part: str) -> Iterator[bool]:
    """Yield whether no other process is at a part, which is then this one's. Where that cannot be known, none is."""
    folder = cache_folder()
    try:
        import fcntl
    except ImportError:
        folder = None
    lock = None if folder is None else _opened(folder / f"renderer-{part}.lock")
    if lock is None:
        yield True
        return
    with lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            yield False
            return
        yield True


def _opened(path: Path) -> IO[str] | None:
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        return path.open("w", encoding="utf-8")
    except OSError:
        return None


def _note_of(folder: Path, part: str) -> Path:
    return folder / f"renderer-{part}.ready"


@lru_cache(maxsize=1)
def _fingerprint() -> str:
    """Of all that decides whether numba can use again what it keeps: itself, the processor, the sources."""
    found = hashlib.sha256()
    found.update(f"{sys.version}\n{numba.__version__}\n{processor()}\n".encode())
    for source in sorted(Path(__file__).parent.glob("*.py")):
        state = source.stat()
        found.update(f"{source.name} {state.st_size} {state.st_mtime_ns}\n".encode())
    return found.hexdigest()
