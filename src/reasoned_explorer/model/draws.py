"""Random draws that depend on what they are for and never on their order.

A draw is keyed by a seed and by what it decides (mission, step, heading, object …), so that runs are the same from
process to process and from machine to machine, and so that one more draw elsewhere changes nothing here. The mixing
function is the finaliser of SplitMix64 (Steele, Lea, Flood: "Fast splittable pseudorandom number generators", 2014).
"""

import math
from collections.abc import Iterable, Sequence
from functools import lru_cache
from hashlib import blake2b
from typing import TypeVar

T = TypeVar("T")
_MASK = (1 << 64) - 1
_GOLDEN = 0x9E3779B97F4A7C15


def _mix(state: int) -> int:
    state = ((state ^ (state >> 30)) * 0xBF58476D1CE4E5B9) & _MASK
    state = ((state ^ (state >> 27)) * 0x94D049BB133111EB) & _MASK
    return state ^ (state >> 31)


@lru_cache(maxsize=65536)
def _word_key(word: str) -> int:
    return int.from_bytes(blake2b(word.encode(), digest_size=8).digest(), "little")


def key_of(seed: int, *keys: int | str) -> int:
    """Return a 64-bit key for a seed and what is decided with it.

    Order matters: ``key_of(1, 2, 3)`` and ``key_of(1, 3, 2)`` differ.
    """
    state = _mix((seed + _GOLDEN) & _MASK)
    for key in keys:
        state = further(state, key)
    return state


def further(key: int, part: int | str) -> int:
    """Return ``key_of(seed, *keys, part)`` for ``key = key_of(seed, *keys)``."""
    number = _word_key(part) if isinstance(part, str) else part
    return _mix((key + _GOLDEN + number * 0xD1342543DE82EF95) & _MASK)


def uniform(seed: int, *keys: int | str) -> float:
    """Return a number in [0, 1) for a seed and keys."""
    return (key_of(seed, *keys) >> 11) * (1.0 / (1 << 53))


def normal(seed: int, *keys: int | str) -> float:
    """Return a standard normal number for a seed and keys (Box-Muller)."""
    return _normal(key_of(seed, *keys))


def normals(seed: int, keys: Iterable[tuple[int | str, ...]]) -> list[float]:
    """Return ``normal(seed, *key)`` for each key, in order: in less time for those that differ in the last place."""
    found: list[float] = []
    shared: tuple[int | str, ...] = ()
    state = key_of(seed)
    for key in keys:
        if key[:-1] != shared:
            shared = key[:-1]
            state = key_of(seed, *shared)
        found.append(_normal(further(state, key[-1]) if key else state))
    return found


def _normal(key: int) -> float:
    radius = math.sqrt(-2.0 * math.log(1.0 - (key >> 11) * (1.0 / (1 << 53))))
    return radius * math.cos(2.0 * math.pi * (_mix((key + _GOLDEN) & _MASK) >> 11) * (1.0 / (1 << 53)))


def choice(options: Sequence[T], seed: int, *keys: int | str) -> T:
    """Return one of the options (at least one) for a seed and keys."""
    return options[int(uniform(seed, *keys) * len(options))]
