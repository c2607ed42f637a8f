"""Splits: episodes that a benchmark poses, the same on every machine, with a version and a hash."""

import hashlib
import json
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

from reasoned_explorer.model import Fault, InputError
from reasoned_explorer.task.episode import Episode

#: How far it is to the goal, on the shortest compliant way of a walker, metres: at least, at most.
BANDS_M: Mapping[str, tuple[float, float]] = {"near": (30.0, 100.0), "middle": (100.0, 180.0), "far": (180.0, 320.0)}
LEVELS = (1, 2, 3, 4)
#: Changes whenever the way in which splits are made does: other episodes come out of the same seed.
SPLIT_VERSION = 2


#: What a generated place is part of.
GENERATED = "generated"


@dataclass(frozen=True, slots=True)
class Place:
    """Where episodes of a split take place: a generated world, or a neighbourhood of a real place.

    Attributes:
        name: Unique in the split, e.g. ``"park:7@500"`` or ``"monaco#3"``.
        source: What `open_world` takes.
        bbox: lon0, lat0, lon1, lat1 in degrees that a file is cropped to, or None.
        city: What it is part of, e.g. ``"generated"`` or ``"monaco"``.
        district: Kind of a generated place; empty for real ones.
    """

    name: str
    source: str
    bbox: tuple[float, float, float, float] | None = None
    city: str = GENERATED
    district: str = ""


@dataclass(frozen=True, slots=True)
class SplitEpisode:
    """An episode in a split.

    Attributes:
        episode: The mission.
        place: Name of its place.
        band: How far it is to the goal, a key of `BANDS_M`.
        blind_rate: How often a declaration at a random spot of the place would satisfy the goal, in [0, 1].
    """

    episode: Episode
    place: str
    band: str
    blind_rate: float


@dataclass(frozen=True, slots=True)
class Split:
    """Episodes, and where they take place.

    Attributes:
        name: ``"mini"``, ``"full"``, or what a person called theirs.
        seed: Of every draw.
        places: Where, in order.
        episodes: In order of places.
        world_digests: Fingerprint of each place's world, by name.
        attributions: Whom to thank for the data, sorted.
        version: `SPLIT_VERSION` that it was made by.
    """

    name: str
    seed: int
    places: tuple[Place, ...]
    episodes: tuple[SplitEpisode, ...]
    world_digests: Mapping[str, str]
    attributions: tuple[str, ...] = ()
    version: int = SPLIT_VERSION

    def place(self, name: str) -> Place:
        """Return a place by its name.

        Raises:
            KeyError: If there is none.
        """
        return next((place for place in self.places if place.name == name), None) or _no(name)

    def only(self, *, levels: Sequence[int]) -> "Split":
        """Return the part of it that has these levels.

        Raises:
            InputError: If nothing is left.
        """
        episodes = tuple(item for item in self.episodes if item.episode.spec.level in levels)
        if not episodes:
            fault = Fault(
                f"levels {', '.join(map(str, levels))} of split {self.name}", "levels that it has episodes of"
            )
            raise InputError("split", [fault])
        return replace(self, name=f"{self.name}/L{''.join(map(str, levels))}", episodes=episodes)

    @property
    def digest(self) -> str:
        """SHA-256 over all that decides the missions, hexadecimal: worlds, goals, starts, seeds, limits."""
        plain = self.as_dict()
        # Where a file lies on a machine says nothing about what is in it; its digest does.
        for place in plain["places"]:
            place.pop("source")
        # What is measured is the same from machine to machine to the millimetre, not to the last bit.
        for item in plain["episodes"]:
            item["reference_length_m"] = round(item["reference_length_m"] or 0.0, 3)
        return hashlib.sha256(json.dumps(plain, sort_keys=True, allow_nan=False).encode()).hexdigest()

    @property
    def label(self) -> str:
        """Name, version and the beginning of the hash, as tables show them."""
        return f"{self.name} v{self.version} [{self.digest[:12]}]"

    def lines(self) -> list[str]:
        """Return in words what is in it."""
        lengths = sorted(item.episode.reference_length_m for item in self.episodes)
        levels = Counter(item.episode.spec.level for item in self.episodes)
        bands = Counter(item.band for item in self.episodes)
        blind = sum(item.blind_rate for item in self.episodes) / max(1, len(self.episodes))
        highest = max((item.blind_rate for item in self.episodes), default=0.0)
        goals = len({item.episode.spec.text for item in self.episodes})
        return [
            f"split {self.label}: {len(self.episodes)} episodes, {goals} goal sentences, {len(self.places)} places",
            "levels: " + ", ".join(f"L{level} {levels[level]}" for level in sorted(levels)),
            "distances: "
            + ", ".join(f"{band} ({low:g}-{high:g} m) {bands[band]}" for band, (low, high) in BANDS_M.items()),
            "shortest compliant way (a walker's), metres: "
            + ", ".join(f"{name} {_quantile(lengths, share):.0f}" for name, share in _QUANTILES),
            f"success of a blind declaration at a random spot: {blind:.3f} (highest of a goal {highest:.3f})",
        ]

    def as_dict(self) -> dict[str, Any]:
        """Return plain data for a file."""
        return {
            "name": self.name,
            "version": self.version,
            "seed": self.seed,
            "places": [{**asdict(place), "bbox": place.bbox and list(place.bbox)} for place in self.places],
            "world_digests": dict(sorted(self.world_digests.items())),
            "attributions": list(self.attributions),
            "episodes": [
                {"place": item.place, "band": item.band, "blind_rate": item.blind_rate, **item.episode.as_dict()}
                for item in self.episodes
            ],
        }

    @classmethod
    def from_dict(cls, data: Mapping[str, Any]) -> "Split":
        """Return the split of `as_dict`.

        Raises:
            InputError: If an entry is missing or of the wrong type.
            GoalError: If a goal cannot be read.
        """
        try:
            return cls(
                name=str(data["name"]),
                seed=int(data["seed"]),
                places=tuple(
                    Place(**{**place, "bbox": None if place["bbox"] is None else tuple(place["bbox"])})
                    for place in data["places"]
                ),
                episodes=tuple(
                    SplitEpisode(Episode.from_dict(dict(item)), item["place"], item["band"], item["blind_rate"])
                    for item in data["episodes"]
                ),
                world_digests=dict(data["world_digests"]),
                attributions=tuple(data["attributions"]),
                version=int(data["version"]),
            )
        except (KeyError, TypeError, ValueError) as error:
            fault = Fault(f"{type(error).__name__}: {error}", "a split as Split.as_dict writes it")
            raise InputError("split", [fault]) from error


_QUANTILES = (("shortest", 0.0), ("quarter", 0.25), ("median", 0.5), ("three quarters", 0.75), ("longest", 1.0))


def _quantile(ordered: Sequence[float], share: float) -> float:
    return ordered[min(len(ordered) - 1, int(share * len(ordered)))] if ordered else 0.0


def _no(name: str) -> Place:
    raise KeyError(name)
