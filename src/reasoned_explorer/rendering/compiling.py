"""How the renderer's kernels are compiled."""

from collections.abc import Callable
from typing import Any, TypeVar

from numba import njit

F = TypeVar("F", bound=Callable[..., Any])

# Without numba's own memory management, because it counts, with locked instructions, each reference to an array that
# is taken from a tuple or handed to a function: a third of the time of a picture, and more with two threads. Such a
# kernel cannot make arrays (it is an error to try); it is given all the room that it needs.
_OPTIONS: dict[str, Any] = {
    "nogil": True, "cache": True, "fastmath": False, "error_model": "numpy", "_nrt": False,
}  # fmt: skip


def kernel(function: F) -> F:
    """Return a function compiled for plain arrays and numbers; it makes no arrays and lets other threads run."""
    compiled: F = njit(**_OPTIONS)(function)
    return compiled


def inlined(function: F) -> F:
    """Return a function compiled as `kernel` does, as a part of what calls it."""
    compiled: F = njit(**_OPTIONS, forceinline=True)(function)
    return compiled
