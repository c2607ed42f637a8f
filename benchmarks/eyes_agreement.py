"""Do both kinds of eyes see the same, and who is right where they do not? `python benchmarks/eyes_agreement.py`.

Views at eye height on ways of generated districts (and of maps, where they lie beside this checkout): which things are
seen by sight lines, by pixels or by both, by distance and by class; and how many of the camera's own pixels show them,
counted in a picture of its full size.

    python benchmarks/eyes_agreement.py --views 60
"""

import argparse
import math
from collections import Counter
from pathlib import Path

import numpy as np

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Camera
from reasoned_explorer.simulation.eyes import Eyes
from reasoned_explorer.simulation.pixel_eyes import PixelEyes
from reasoned_explorer.simulation.renderers import renderer_of
from reasoned_explorer.simulation.sighting import ViewContent
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.opening import open_world
from reasoned_explorer.world.taxonomy import Ground

Box = tuple[float, float, float, float]
GENERATED = ("park:11", "downtown:12", "plaza:16", "residential:13")
MAPS: dict[str, Box] = {
    "munich-centre.osm.pbf": (11.5700, 48.1330, 11.5830, 48.1420),
    "monaco-2025.osm.pbf": (7.4150, 43.7300, 7.4270, 43.7390),
}
CAMERA = Camera()
#: Upper ends of the bands of distance, metres, and of pixels.
DISTANCES_M, COUNTS_PX = (8.0, 20.0, 40.0, math.inf), (0, 1, 3, 9, math.inf)
WHO = ("both", "lines", "pixels")


def poses(atlas: Atlas, count: int) -> list[Pose]:
    """Places on ways and in no building, at eye height, in random directions."""
    draw = np.random.default_rng(11)
    ways = [way for way in atlas.world.ways if way.level == 0]
    found: list[Pose] = []
    while len(found) < count:
        line = ways[draw.integers(len(ways))].line
        at = draw.integers(len(line) - 1)
        x, y = line[at] + draw.random() * (line[at + 1] - line[at])
        if atlas.ground.at(float(x), float(y)) != Ground.BUILDING:
            found.append(Pose(float(x), float(y), 1.5, float(draw.uniform(0.0, 2.0 * math.pi))))
    return found


class Tally:
    """What was counted over all views."""

    def __init__(self) -> None:
        self.bands: Counter[tuple[int, str]] = Counter()
        self.classes: Counter[tuple[str, str]] = Counter()
        self.pixels: Counter[tuple[int, str]] = Counter()
        self.shares: list[float] = []
        self.ways: list[tuple[float, float]] = []
        self.grounds: list[bool] = []

    def add(self, atlas: Atlas, pose: Pose, lines: ViewContent, pixels: ViewContent) -> Counter[str]:
        """Add a view; returns who saw how many things in it."""
        told = [{seen.object_id: seen for seen in view.sightings} for view in (lines, pixels)]
        first, here = 2 + len(atlas.world.buildings), Counter[str]()
        picture = renderer_of(atlas).ids(pose, CAMERA).instances
        true = np.bincount(picture.ravel(), minlength=first + len(atlas.world.objects))[first:].tolist()
        for thing in told[0].keys() | told[1].keys():
            seen = told[0].get(thing) or told[1][thing]
            who = "both" if thing in told[0] and thing in told[1] else WHO[1 if thing in told[0] else 2]
            here[who] += 1
            self.bands[sum(seen.distance_m >= edge for edge in DISTANCES_M), who] += 1
            self.classes[seen.class_name, who] += 1
            if atlas.world.objects[thing].object_class.kind != "area":
                self.pixels[sum(true[thing] > edge for edge in COUNTS_PX), who] += 1
            if who == "both":
                self.shares.append(told[1][thing].visible_share - told[0][thing].visible_share)
        for one, other in zip(lines.stretches, pixels.stretches, strict=True):
            self.ways.append((one.free_m, other.free_m))
            self.grounds += [one.near == other.near, one.middle == other.middle, one.far == other.far]
        return here

    def print(self) -> None:
        """Print it."""
        for band, edge in enumerate(DISTANCES_M):
            print(f"below {edge:g} m:", *(f"{who} {self.bands[band, who]}" for who in WHO))
        for band, edge in enumerate(COUNTS_PX):
            print(f"up to {edge:g} px in a full picture:", *(f"{who} {self.pixels[band, who]}" for who in WHO))
        by_doubt = sorted({name for name, _ in self.classes}, key=lambda n: -self._doubts(n))
        for name in by_doubt[:15]:
            print(f"{name}:", *(f"{who} {self.classes[name, who]}" for who in WHO))
        print("visible share, pixels less lines, percentiles 5 25 50 75 95:", end=" ")
        print(np.percentile(self.shares, [5, 25, 50, 75, 95]).round(2))
        ways = np.array(self.ways)
        apart = np.abs(ways[:, 0] - ways[:, 1]) >= 0.05 * np.maximum(ways.min(axis=1), 1.0)
        shorter = ways[:, 1] < ways[:, 0]
        print(
            f"free distance: the same in {np.mean(~apart):.2f}, by pixels shorter in {np.mean(apart & shorter):.2f}, "
            f"longer in {np.mean(apart & ~shorter):.2f}; ground the same in {np.mean(self.grounds):.2f}"
        )

    def _doubts(self, name: str) -> int:
        return self.classes[name, "lines"] + self.classes[name, "pixels"]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--views", type=int, default=60, help="views of each place")
    parser.add_argument("--maps", type=Path, default=Path(__file__).resolve().parents[2] / "shared" / "osm")
    options = parser.parse_args()
    places: list[tuple[str, Box | None]] = [(name, None) for name in GENERATED]
    places += [(str(options.maps / name), box) for name, box in MAPS.items() if (options.maps / name).exists()]
    tally = Tally()
    for name, box in places:
        atlas = Atlas(open_world(name, bbox=box))
        lines, pixels = Eyes(atlas), PixelEyes(atlas)
        here = Counter[str]()
        for pose in poses(atlas, options.views):
            here += tally.add(atlas, pose, lines.look(pose, CAMERA), pixels.look(pose, CAMERA))
        print(f"{atlas.world.name}:", *(f"{who} {here[who]}" for who in WHO), flush=True)
    tally.print()


if __name__ == "__main__":
    main()
