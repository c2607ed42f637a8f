"""How kernels are compiled that make no arrays."""

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
    compiled: F = njit(**_OPTIONS, no_cfunc_wrapper=True)(function)
    return compiled


def part(function: F) -> F:
    """Return a function that kernels call and Python cannot, which saves a third of the time to compile it."""
    compiled: F = njit(**_OPTIONS, no_cfunc_wrapper=True, no_cpython_wrapper=True)(function)
    return compiled


def inlined(function: F) -> F:
    """Return a `part` that becomes a piece of each of its callers: for those that take many arrays."""
    compiled: F = njit(**_OPTIONS, no_cfunc_wrapper=True, no_cpython_wrapper=True, forceinline=True)(function)
    return compiled
