"""How kernels are compiled that make no arrays.

Half of what numba does by itself is for what such kernels do not have, or is done again for whoever calls them; a
person waits for all of it once. So here they are compiled by a shorter way, to the same machine code.
"""

from collections.abc import Callable
from copy import copy
from functools import lru_cache
from pathlib import Path
from types import FunctionType
from typing import Any, TypeVar

from numba import njit
from numba.core import types
from numba.core.caching import FunctionCache, IndexDataCacheFile
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase, DefaultPassBuilder

F = TypeVar("F", bound=Callable[..., Any])

#: What numba does for closures, array expressions, and functions that are inlined before types are known.
_NEEDLESS_PASSES = frozenset(
    {
        "WithLifting",
        "InlineClosureLikes",
        "MakeFunctionToJitFunction",
        "InlineInlinables",
        "FindLiterallyCalls",
        "LiteralUnroll",
        "LiteralPropagationSubPipelinePass",
        "InlineOverloads",
        "NopythonRewrites",
    }
)


def kernel(function: F) -> F:
    """Return a function compiled for plain arrays and numbers; it makes no arrays and lets other threads run."""
    compiled: Any = njit(**_OPTIONS, cache=True, pipeline_class=_Compiler)(function)
    if isinstance(getattr(compiled, "_cache", None), FunctionCache):
        compiled._cache = _Store(function)
    kept: F = compiled
    return kept


def part(function: F) -> F:
    """Return a function that kernels call and Python cannot, which takes half the time to compile."""
    compiled: F = njit(**_OPTIONS, no_cpython_wrapper=True, pipeline_class=_PartCompiler)(function)
    return compiled


def inlined(function: F) -> F:
    """Return a `part` that becomes a piece of each of its callers: for those that take many arrays."""
    compiled: F = njit(**_OPTIONS, no_cpython_wrapper=True, pipeline_class=_PartCompiler, forceinline=True)(function)
    return compiled


@lru_cache
def interpreted(compiled: F) -> F:
    """Return a `kernel` as the Python that it is written in, its parts from the same file likewise.

    It computes the same, as long as whole numbers do not overflow, and a hundred times as slowly: right for so little
    work that compiling it, or only reading what was compiled, takes longer.
    """
    function: Any = getattr(compiled, "py_func", compiled)
    names: dict[str, Any] = {}
    for name, value in function.__globals__.items():
        plain = getattr(value, "py_func", None)
        names[name] = value if plain is None else FunctionType(plain.__code__, names, name, plain.__defaults__)
    python: F = names[function.__name__]
    return python


class _Compiler(CompilerBase):  # type: ignore[misc]
    """numba's own, without what is not needed, and with a memory for types."""

    def __init__(self, typing_context: Any, *others: Any) -> None:
        super().__init__(_remembering(typing_context), *others)

    def define_pipelines(self) -> list[Any]:
        """Return numba's passes but for `_NEEDLESS_PASSES`."""
        passes = DefaultPassBuilder.define_nopython_pipeline(self.state)
        passes.passes = [one for one in passes.passes if one[0].__name__ not in _NEEDLESS_PASSES]
        passes.finalize()
        return [passes]


class _PartCompiler(_Compiler):
    """Leaves it to the callers of a function to optimise it, together with themselves."""

    def compile_extra(self, function: Any) -> Any:
        """Compile a function; as numba's own."""
        self.state.library = _Draft(self.state.targetctx.codegen(), function.__qualname__)
        return super().compile_extra(function)


class _Draft(JITCodeLibrary):  # type: ignore[misc]
    """Code that is neither optimised nor made machine code of: it is only there to be linked to others."""

    def _optimize_functions(self, module: Any) -> None:
        module.data_layout = self._codegen._data_layout

    def _optimize_final_module(self) -> None:
        pass

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """Return 0, which says that there is none."""
        del name
        return 0

    @property
    def codegen(self) -> Any:
        """What makes code; there is no place in memory yet that an environment could be written to."""
        codegen = copy(self._codegen)
        codegen.set_env = lambda *_: None
        return codegen


class _Store(FunctionCache):  # type: ignore[misc]
    """Where a kernel is kept on disk; reads it without getting numba ready to compile, which takes half a second.

    That is needed for what kernels do not have: memory management, and other objects than arrays and numbers.
    """

    def __init__(self, function: Any) -> None:
        super().__init__(function)
        # Pieces of other files are in it too: numba itself looks only at the file of the function.
        stamp = _sources(Path(function.__code__.co_filename).parent)
        self._cache_file = IndexDataCacheFile(self._cache_path, self._impl.filename_base, stamp)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return the compiled kernel for types of arguments, or None where it is not kept; as numba's own."""
        with self._guard_against_spurious_io_errors():
            return self._load_overload(sig, target_context)


@lru_cache
def _sources(folder: Path) -> tuple[tuple[str, int, int], ...]:
    """Return the state of a room's files and of this one: what is kept of any kernel holds as long as none changes."""
    states = [(file.name, file.stat()) for file in (*sorted(folder.glob("*.py")), Path(__file__))]
    return tuple((name, state.st_size, state.st_mtime_ns) for name, state in states)


@lru_cache(maxsize=1)
def _remembering(typing_context: Any) -> Any:
    """Return a typing context that finds out only once what type a sum of two numbers has, say."""
    context = copy(typing_context)
    resolve = context.resolve_function_type
    known: dict[Any, Any] = {}

    def resolved(function: Any, arguments: Any, named: Any) -> Any:
        if named or not isinstance(function, types.Function):
            return resolve(function, arguments, named)
        key = function, tuple(arguments)
        if key not in known:
            known[key] = resolve(function, arguments, named)
        return known[key]

    context.resolve_function_type = resolved
    return context


# Without numba's own memory management, because it counts, with locked instructions, each reference to an array that
# is taken from a tuple or handed to a function: a third of the time of a picture, and more with two threads. Such a
# kernel cannot make arrays (it is an error to try); it is given all the room that it needs.
_OPTIONS: dict[str, Any] = {
    "nogil": True, "fastmath": False, "error_model": "numpy", "no_cfunc_wrapper": True, "_nrt": False,
}  # fmt: skip
