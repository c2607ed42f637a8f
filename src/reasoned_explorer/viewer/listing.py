"""The missions of a run as the page lists them: columns, rows, and words that stand for what is said often."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from hashlib import blake2b
from math import isfinite
from typing import Any

from pydantic_core import to_json

#: What is known of each mission, in this order.
COLUMNS = (
    "id",
    "method",
    "level",
    "place",
    "goal",
    "outcome",
    "cause",
    "end",
    "spl",
    "casr",
    "ct_s",
    "tt_s",
    "steps",
    "path_length_m",
    "has_record",
    "vehicle",
    "mission_id",
    "seed",
    "fault",
)
#: Columns whose cells are places in the list of words. Seeds are among them since they are larger than a script counts.
CODED = ("method", "place", "goal", "outcome", "cause", "end", "vehicle", "mission_id", "seed", "fault")
_DIGITS = {"spl": 4, "casr": 4, "ct_s": 1, "tt_s": 1, "path_length_m": 1}

#: What a mission is where it was not said whether it succeeded.
NOT_JUDGED = "not judged"


def opaque_id(*parts: str) -> str:
    """Return a name that says nothing of what it stands for, and is the same each time."""
    return blake2b("\0".join(parts).encode("utf-8", "surrogatepass"), digest_size=8).hexdigest()


def outcome_word(success: bool | None) -> str:  # noqa: FBT001 - it is what is put into words
    """Return whether a mission succeeded, in words."""
    return NOT_JUDGED if success is None else "success" if success else "failure"


@dataclass(frozen=True, slots=True)
class Listing:
    """The missions of a run.

    Attributes:
        words: What the cells of coded columns stand for.
        rows: A list of cells each, as `COLUMNS`.
    """

    words: Sequence[str]
    rows: Sequence[Sequence[Any]]

    @classmethod
    def of(cls, missions: Iterable[Mapping[str, Any]]) -> "Listing":
        """Return a listing of missions that are given by their columns' names; what is missing becomes null."""
        missions = list(missions)
        return cls.of_columns({name: [mission.get(name) for mission in missions] for name in COLUMNS})

    @classmethod
    def of_columns(cls, columns: Mapping[str, Sequence[Any]]) -> "Listing":
        """Return a listing of missions that are given as whole columns, one for each name in `COLUMNS`."""
        places: dict[str, int] = {}
        made = dict(columns)
        for name in CODED:
            kinds = {
                value: places.setdefault(str(value), len(places))
                for value in dict.fromkeys(made[name])
                if value is not None
            }
            made[name] = [kinds.get(value) for value in made[name]]
        for name, digits in _DIGITS.items():
            made[name] = [
                round(value, digits) if value is not None and isfinite(value) else None for value in made[name]
            ]
        return cls(list(places), list(zip(*(made[name] for name in COLUMNS), strict=True)))

    def as_json(self, about: Mapping[str, Any]) -> bytes:
        """Return it as the page reads it, with what else there is to say of the run."""
        return to_json({**about, "words": self.words, "columns": COLUMNS, "coded": CODED, "rows": self.rows})
