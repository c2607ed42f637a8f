"""Kernels are compiled by a shorter way than numba's own, and read from disk by one; they compute what Python does."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from numba.core.errors import NumbaError

from reasoned_explorer.world.compiling import inlined, interpreted, kernel, part

#: Two kernels that share a part, as a module of its own: numba keeps nothing of what is typed in.
MODULE = """
import math
from reasoned_explorer.world.compiling import inlined, interpreted, kernel, part

@part
def _length(points, k):
    return math.hypot(points[k, 0], points[k, 1])

@inlined
def _share(points, k, whole):
    return _length(points, k) / whole

@kernel
def longest(points):
    found = 0.0
    for k in range(points.shape[0]):
        found = max(found, _length(points, k))
    return found

@kernel
def shares(points, found):
    whole = 0.0
    for k in range(points.shape[0]):
        whole += _length(points, k)
    for k in range(points.shape[0]):
        found[k] = _share(points, k, whole)
"""
USER = """
import sys
import numpy as np
import kernels_of_a_test as module

points, found = np.array([(3.0, 4.0), (0.0, 5.0), (6.0, 8.0)]), np.empty(3)
module.shares(points, found)
print(module.longest(points), *found, "numba.np.linalg" in sys.modules)
"""


@part
def _clipped(value: float, low: float, high: float) -> float:
    return min(max(value, low), high)


@inlined
def _scaled(values: np.ndarray, k: int, factor: float) -> float:
    return _clipped(values[k] * factor, -2.0, 2.0)


@kernel
def scale(values: np.ndarray, factor: float) -> int:
    changed = 0
    for k in range(values.shape[0]):
        new = _scaled(values, k, factor)
        changed += new != values[k]
        values[k] = new
    return changed


@kernel
def make_zeros(count: int) -> np.ndarray:
    return np.zeros(count)


def test_a_kernel_with_its_parts_computes_what_python_does() -> None:
    values = np.array([0.5, -3.0, 1.0, np.nan, 0.0, 7.0])
    in_python = np.array([min(max(value * 1.5, -2.0), 2.0) for value in values])
    changed = scale(values, 1.5)
    np.testing.assert_array_equal(values[[0, 1, 2, 4, 5]], in_python[[0, 1, 2, 4, 5]])
    assert changed == 5


def test_a_kernel_can_be_done_in_the_python_that_it_is_written_in() -> None:
    compiled, in_python = np.array([0.5, -3.0, 1.0, 7.0]), np.array([0.5, -3.0, 1.0, 7.0])
    assert interpreted(scale)(in_python, 1.5) == scale(compiled, 1.5) == 4
    np.testing.assert_array_equal(in_python, compiled)
    # What only numba refuses shows that it is not asked.
    assert interpreted(make_zeros)(3).tolist() == [0.0, 0.0, 0.0]


def test_a_kernel_is_compiled_for_every_kind_of_numbers_that_it_is_given() -> None:
    values = np.array([0.5, -3.0], np.float32)
    assert scale(values, 2.0) == 2
    assert values.tolist() == [1.0, -2.0]


def test_division_by_zero_is_what_it_is_in_numpy() -> None:
    assert _inverse(0.0) == np.inf


@kernel
def _inverse(value: float) -> float:
    return 1.0 / value


def test_a_kernel_cannot_make_arrays() -> None:
    with pytest.raises((NumbaError, RuntimeError)):
        make_zeros(3)


def _use(folder: Path) -> list[str]:
    environment = {**os.environ, "NUMBA_CACHE_DIR": str(folder / "cache")}
    environment["PYTHONPATH"] = os.pathsep.join([str(folder), *filter(None, sys.path)])
    done = subprocess.run([sys.executable, "-c", USER], env=environment, capture_output=True, text=True, check=True)
    return done.stdout.split()


def test_what_one_process_has_compiled_the_next_reads_without_getting_ready_to_compile(tmp_path: Path) -> None:
    (tmp_path / "kernels_of_a_test.py").write_text(MODULE)
    *compiled, was_ready = _use(tmp_path)
    assert compiled == ["10.0", "0.25", "0.25", "0.5"]
    assert was_ready == "True"
    assert _use(tmp_path) == [*compiled, "False"]
    # Parts are pieces of kernels: they have no files.
    kept = {path.name.split("-")[0] for path in (tmp_path / "cache").rglob("*.nbc")}
    assert kept == {"kernels_of_a_test.longest", "kernels_of_a_test.shares"}


def test_a_kernel_is_compiled_anew_when_a_file_beside_it_changes_that_a_piece_of_it_is_from(tmp_path: Path) -> None:
    parts, rest = MODULE.split("@inlined")
    (tmp_path / "lengths.py").write_text(parts)
    header = "from reasoned_explorer.world.compiling import inlined, kernel\nfrom lengths import _length\n"
    (tmp_path / "kernels_of_a_test.py").write_text(f"{header}\n@inlined{rest}")
    assert _use(tmp_path)[0] == "10.0"
    (tmp_path / "lengths.py").write_text(parts.replace("math.hypot(points[k, 0]", "math.hypot(4.0 * points[k, 0]"))
    assert float(_use(tmp_path)[0]) == pytest.approx(np.hypot(24.0, 8.0))
