"""Whether what a program hands in is of the kind that is asked for, before anything is done with it."""

import math
from collections.abc import Iterable
from numbers import Integral, Real
from os import PathLike
from pathlib import Path

from reasoned_explorer.model.errors import Fault, InputError


def is_within(value: object, low: float = -math.inf, high: float = math.inf, *, whole: bool = False) -> bool:
    """Return whether a value is a finite number (or only a whole one) in a range, its ends included."""
    if isinstance(value, bool):
        return False
    if isinstance(value, Integral):
        return low <= int(value) <= high
    return not whole and isinstance(value, Real) and math.isfinite(value) and low <= float(value) <= high


def number_faults(numbers: Iterable[tuple[str, object]]) -> list[Fault]:
    """Return a fault for each named value that is no finite number."""
    return [Fault(f"{name} is {value!r}", "a finite number") for name, value in numbers if not is_within(value)]


def positive_faults(numbers: Iterable[tuple[str, object]]) -> list[Fault]:
    """Return a fault for each named value that is no finite number above 0."""
    return [
        Fault(f"{name} = {value}", "a finite number > 0")
        for name, value in numbers
        if not (is_within(value, 0.0) and value)
    ]


def seed_faults(seed: object) -> list[Fault]:
    """Return a fault where a seed is none."""
    return [] if is_within(seed, 0, whole=True) else [Fault(f"seed is {seed!r}", "a whole number from 0 on")]


def kind_faults(
    name: str, value: object, kind: type | tuple[type, ...], expected: str, remedy: str = ""
) -> list[Fault]:
    """Return a fault where a value is of none of the kinds asked for."""
    if isinstance(value, kind):
        return []
    shown = repr(value)
    return [Fault(f"{name} is {shown if len(shown) <= 60 else shown[:60] + '…'}", expected, remedy)]


def path_of(path: str | PathLike[str], subject: str, kind: type[InputError]) -> Path:
    """Return a path.

    Raises:
        InputError: Of the kind that is named, if it is none.
    """
    if not isinstance(path, str | PathLike) or "\0" in str(path) or not str(path):
        raise kind(subject, [Fault(f"the path is {path!r}", "a path, as text or as a pathlib.Path")])
    return Path(path)


def is_there(path: Path) -> bool:
    """Return whether there is something at a path; nothing can be where a name is longer than a disk takes."""
    try:
        return path.exists()
    except OSError:
        return False
