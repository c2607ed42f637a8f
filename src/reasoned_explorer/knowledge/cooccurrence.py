"""What stands near what in real places, as numbers.

The numbers were counted in two town centres on the map (`scripts/compute_cooccurrence.py` says how); they are
© OpenStreetMap contributors, Open Database License 1.0. What a map leaves out they leave out too.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from types import MappingProxyType
from typing import Any

SCHEMA = 1
_Table = Mapping[str, Mapping[str, float]]


@dataclass(frozen=True, slots=True, eq=False)
class Cooccurrence:
    """Statistics of real places.

    A *lift* says how many times likelier something is given something else than anywhere outdoors; 1 means that the one
    says nothing about the other, and is also the answer where there is no evidence.

    Attributes:
        attribution: Whom to thank wherever a figure made from this is shown.
        sources: Where it was counted: name of the file, number of objects, area in km², day of the newest edit.
        radius_m: What "near" means.
        ahead_m: From where to where "a bit further on" reaches.
        density_per_km2: Objects of a class per km² of open ground: all that is not built on, water included.
        ground_share: Share of a kind of ground in the open ground; they sum to 1.
        same_class_spacing_m: Median distance to the next object of the same class.
        distance_to: For a class, the median distance to the next ``building``, ``road`` and ``footway``.
    """

    attribution: str
    sources: tuple[Mapping[str, str | int | float], ...]
    radius_m: float
    ahead_m: tuple[float, float]
    density_per_km2: Mapping[str, float]
    ground_share: Mapping[str, float]
    same_class_spacing_m: Mapping[str, float]
    distance_to: _Table
    _near: _Table
    _ahead: _Table
    _near_ground: _Table
    _on_ground: _Table

    def lift(self, given: str, wanted: str) -> float:
        """Return how much likelier a class is within `radius_m` of another class than anywhere outdoors."""
        return self._near.get(given, {}).get(wanted, 1.0)

    def lift_ahead(self, given: str, wanted: str) -> float:
        """Return the same for what is a bit further on, `ahead_m` away."""
        return self._ahead.get(given, {}).get(wanted, 1.0)

    def ground_lift(self, ground_name: str, class_name: str) -> float:
        """Return how much likelier a kind of ground is within `radius_m` of a class than of any point outdoors.

        By Bayes' rule this is also how much denser the class is where that ground is near.
        """
        return self._near_ground.get(ground_name, {}).get(class_name, 1.0)

    def on_ground_lift(self, ground_name: str, class_name: str) -> float:
        """Return how much denser a class stands on a kind of ground than anywhere outdoors."""
        return self._on_ground.get(ground_name, {}).get(class_name, 1.0)

    def neighbours(self, given: str) -> Mapping[str, float]:
        """Return all classes whose lift near a class is known."""
        return self._near.get(given, MappingProxyType({}))


@cache
def load_cooccurrence() -> Cooccurrence:
    """Return the statistics that come with this package."""
    text = files("reasoned_explorer.knowledge").joinpath("cooccurrence.json").read_text(encoding="utf-8")
    return cooccurrence_from(json.loads(text))


def cooccurrence_from(data: Mapping[str, Any]) -> Cooccurrence:
    """Return the statistics that the parsed JSON of `scripts/compute_cooccurrence.py` holds.

    Raises:
        ValueError: It has another schema than this reader.
    """
    if data.get("schema") != SCHEMA:
        raise ValueError(f"co-occurrence schema is {data.get('schema')!r}; this version reads {SCHEMA}")
    low_m, high_m = data["ahead_m"]
    return Cooccurrence(
        attribution=data["attribution"],
        sources=tuple(MappingProxyType(source) for source in data["sources"]),
        radius_m=float(data["radius_m"]),
        ahead_m=(float(low_m), float(high_m)),
        density_per_km2=MappingProxyType(data["density_per_km2"]),
        ground_share=MappingProxyType(data["ground_share"]),
        same_class_spacing_m=MappingProxyType(data["same_class_spacing_m"]),
        distance_to=_frozen(data["distance_to"]),
        _near=_frozen(data["class_given_class"]),
        _ahead=_frozen(data["class_given_class_ahead"]),
        _near_ground=_frozen(data["class_near_ground"]),
        _on_ground=_frozen(data["class_on_ground"]),
    )


def _frozen(table: Mapping[str, Mapping[str, float]]) -> _Table:
    return MappingProxyType({key: MappingProxyType(dict(row)) for key, row in table.items()})
