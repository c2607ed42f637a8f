"""How kernels are compiled that make no arrays."""

from collections.abc import Callable
from typing import Any, TypeVar

from numba import njit
from numba.core.caching import FunctionCache

F = TypeVar("F", bound=Callable[..., Any])

# Without numba's own memory management, because it counts, with locked instructions, each reference to an array that
# is taken from a tuple or handed to a function: a third of the time of a picture, and more with two threads. Such a
# kernel cannot make arrays (it is an error to try); it is given all the room that it needs.
_OPTIONS: dict[str, Any] = {
    "nogil": True, "cache": True, "fastmath": False, "error_model": "numpy", "_nrt": False,
}  # fmt: skip


class _Store(FunctionCache):  # type: ignore[misc]
    """Where a kernel is kept on disk; reads it without getting numba ready to compile, which takes half a second.

    That is needed for what kernels do not have: memory management, and other objects than arrays and numbers.
    """

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return the compiled kernel for types of arguments, or None where it is not kept; as numba's own."""
        with self._guard_against_spurious_io_errors():
            return self._load_overload(sig, target_context)


def kernel(function: F) -> F:
    """Return a function compiled for plain arrays and numbers; it makes no arrays and lets other threads run."""
    compiled: Any = njit(**_OPTIONS, no_cfunc_wrapper=True)(function)
    if isinstance(getattr(compiled, "_cache", None), FunctionCache):
        compiled._cache = _Store(function)
    kept: F = compiled
    return kept


def part(function: F) -> F:
    """Return a function that kernels call and Python cannot, which saves a third of the time to compile it."""
    compiled: F = njit(**_OPTIONS, no_cfunc_wrapper=True, no_cpython_wrapper=True)(function)
    return compiled


def inlined(function: F) -> F:
    """Return a `part` that becomes a piece of each of its callers: for those that take many arrays."""
    compiled: F = njit(**_OPTIONS, no_cfunc_wrapper=True, no_cpython_wrapper=True, forceinline=True)(function)
    return compiled
