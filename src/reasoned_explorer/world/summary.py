"""A world in figures, for people."""

from collections import Counter
from dataclasses import dataclass

import numpy as np

from reasoned_explorer.model.checks import kind_faults
from reasoned_explorer.model.errors import WorldError
from reasoned_explorer.world.raster import GroundRaster
from reasoned_explorer.world.taxonomy import OBJECT_CLASSES, Ground
from reasoned_explorer.world.validation import HEIGHT_SOURCES
from reasoned_explorer.world.world import World


@dataclass(frozen=True, slots=True)
class WorldSummary:
    """A world in figures.

    Attributes:
        name: Of the world.
        source: How it came about.
        attribution: Whom to thank; may be empty.
        width_m: East-west extent, metres.
        height_m: North-south extent, metres.
        objects: Number of objects of each class that there are any of, most frequent first, then by name.
        buildings: Number of buildings.
        height_sources: Share of buildings by where their height comes from (``height``, ``levels``, ``default``), in
            [0, 1]; all 0 where there is no building.
        entrances: Number of entrances.
        ground: Share of the area of each kind of ground that there is any of, largest first, summing to 1.
        unknown_share: Unknown ground among what is not building, in [0, 1].
        ways_m: Length of the ways of each kind, longest first, metres.
    """

    name: str
    source: str
    attribution: str
    width_m: float
    height_m: float
    objects: dict[str, int]
    buildings: int
    height_sources: dict[str, float]
    entrances: int
    ground: dict[Ground, float]
    unknown_share: float
    ways_m: dict[str, float]

    @property
    def area_km2(self) -> float:
        """Area, square kilometres."""
        return self.width_m * self.height_m / 1e6

    def lines(self) -> list[str]:
        """Return the figures as lines of text."""
        total = sum(self.objects.values())
        lines = [
            f"{self.name}: {self.width_m:,.0f} m × {self.height_m:,.0f} m, {self.area_km2:.2f} km²",
            *([f"source: {self.source}"] if self.source else []),
            *([f"attribution: {self.attribution}"] if self.attribution else []),
            f"ground: {', '.join(f'{ground.noun} {_percent(share)}' for ground, share in self.ground.items())}",
            f"unknown ground (of what is not building): {_percent(self.unknown_share)}",
            f"ways: {_listed({kind: f'{length_m / 1000.0:.2f} km' for kind, length_m in self.ways_m.items()})}",
            f"buildings: {self.buildings:,}, entrances: {self.entrances:,}",
        ]
        if self.buildings:
            said = {"height": "measured", "levels": "from storeys", "default": "assumed"}
            lines.append(
                f"building heights: {', '.join(f'{said[k]} {_percent(v)}' for k, v in self.height_sources.items())}"
            )
        lines.append(f"objects: {total:,} of {len(self.objects)} classes")
        for name, count in self.objects.items():
            item = OBJECT_CLASSES[name]
            lines.append(f"  {count:>6,}  {item.noun if count == 1 else item.plural}")
        return lines


def summarise(world: World, ground: GroundRaster | None = None) -> WorldSummary:
    """Return a world in figures.

    Args:
        world: The world.
        ground: Its ground where it is at hand; else it is painted.

    Raises:
        WorldError: If it is no world.
    """
    if faults := kind_faults("the world", world, World, "a World"):
        raise WorldError("summary", faults)
    raster = GroundRaster.of(world) if ground is None else ground
    sources = Counter(building.height_source for building in world.buildings)
    lengths_m: dict[str, float] = {}
    for way in world.ways:
        lengths_m[way.kind] = lengths_m.get(way.kind, 0.0) + float(np.hypot(*np.diff(way.line, axis=0).T).sum())
    counts = Counter(item.class_name for item in world.objects)
    return WorldSummary(
        name=world.name,
        source=world.source,
        attribution=world.attribution,
        width_m=world.bounds.width_m,
        height_m=world.bounds.height_m,
        objects=dict(sorted(counts.items(), key=lambda item: (-item[1], item[0]))),
        buildings=len(world.buildings),
        height_sources={name: sources[name] / max(1, len(world.buildings)) for name in HEIGHT_SOURCES},
        entrances=sum(len(building.entrances) for building in world.buildings),
        ground={
            kind: share for kind, share in sorted(raster.shares.items(), key=lambda item: (-item[1], item[0])) if share
        },
        unknown_share=raster.unknown_share,
        ways_m=dict(sorted(lengths_m.items(), key=lambda item: (-item[1], item[0]))),
    )


def _percent(share: float) -> str:
    return f"{100.0 * share:.1f} %"


def _listed(values: dict[str, str]) -> str:
    return ", ".join(f"{name} {value}" for name, value in values.items()) or "none"
