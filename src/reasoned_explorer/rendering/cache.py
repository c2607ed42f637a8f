"""Where compiled code is kept between processes, and what for."""

from functools import lru_cache
from pathlib import Path
from typing import Any

from numba import njit
from numba.core.registry import cpu_target


@lru_cache(maxsize=1)
def cache_folder() -> Path | None:
    """Return where the renderer's compiled code is kept, or None where nothing is compiled."""
    compiled: Any = njit(cache=True)(_anything)
    return Path(compiled.stats.cache_path) if hasattr(compiled, "stats") else None


@lru_cache(maxsize=1)
def processor() -> str:
    """Return what code is compiled for: another processor may also round sines otherwise."""
    return str(cpu_target.target_context.codegen().magic_tuple())


def _anything() -> None:
    """Stands for all functions of this folder: they are kept in one place."""
