"""In which order a rater sees missions, and under which names.

The order comes in blocks. Which missions stand in a block is the same for all raters: each block has of every method,
vehicle and level one mission after the other, so that who stops early has seen of all alike, and has seen the same
missions as others who stopped early: agreement needs missions that two have rated. Within a block each rater has an
order of their own, so that nobody's growing tired falls on the same missions as everybody's.

All of it is drawn by hashes of a seed and of what is ordered (and of the rater), never by the order of rows.
"""

import hmac
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from hashlib import blake2b

from reasoned_explorer.evaluation.ratings import MissionKey

#: A block has at least as many missions as this, where there are so many: enough for orders that differ.
BLOCK = 20


@dataclass(frozen=True, slots=True)
class Rateable:
    """A mission that can be rated.

    Attributes:
        key: Vehicle, method, mission id.
        level: OUTDOOR's level of its goal.
    """

    key: MissionKey
    level: int

    @property
    def stratum(self) -> tuple[str, str, int]:
        """Of what as many are to be seen as of others: vehicle, method, level."""
        vehicle, method, _ = self.key
        return vehicle, method, self.level


def dealt(missions: Iterable[Rateable], *, seed: int) -> list[Rateable]:
    """Return missions in the order that all raters share: rounds in which each stratum has one, as long as it lasts."""
    places: dict[tuple[str, str, int], int] = {}
    ranked = []
    for mission in sorted(missions, key=lambda one: _draw(seed, "deal", *one.key)):
        place = places.get(mission.stratum, 0)
        places[mission.stratum] = place + 1
        ranked.append((place, _draw(seed, "round", *mission.key), mission))
    return [mission for *_, mission in sorted(ranked, key=lambda one: one[:2])]


def order_for(rater: str, missions: Iterable[Rateable], *, seed: int, count: int | None = None) -> list[Rateable]:
    """Return missions in the order in which a rater sees them; each once.

    Args:
        rater: Whose order it is.
        missions: In any order.
        seed: The same for all raters of a run.
        count: How many are to be rated; the same ones by all. None for all of them.
    """
    shared = dealt(missions, seed=seed)[:count]
    # Whole rounds: a block with a part of one would have more of some strata.
    strata = max(1, len({mission.stratum for mission in shared}))
    size = strata * -(-BLOCK // strata)
    ordered: list[Rateable] = []
    for start in range(0, len(shared), size):
        block = shared[start : start + size]
        ordered += sorted(block, key=lambda one: _draw(seed, "rater", rater, *one.key))
    return ordered


def item_ids(keys: Sequence[MissionKey], secret: bytes) -> dict[str, MissionKey]:
    """Return names that missions have on the page: keyed hashes, of which nobody without the key learns the method."""
    return {hmac.digest(secret, "\0".join(key).encode(), "sha256").hex()[:32]: key for key in keys}


def _draw(seed: int, *words: str) -> bytes:
    # The length before each word: no two lists of words make the same text.
    text = b"".join(b"%d:%b" % (len(word.encode()), word.encode()) for word in (f"{seed}", *words))
    return blake2b(text, digest_size=16).digest()
