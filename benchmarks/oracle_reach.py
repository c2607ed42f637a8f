"""Does the agent find every goal that can be reached, when its eyes are perfect and its mind knows the world?

With the oracle mind and `perfect` captions nothing is left to perception or judgement: what is not found then is lost
by the rest of the agent (frontiers, graph, halting, travel, control). Prints a table by level and world, and every
mission that was not a success.

    python benchmarks/oracle_reach.py --count 20 --views 24
"""

import argparse
import math
import time
from pathlib import Path

from reasoned_explorer.evaluation.mission import Mission, MissionSettings, traveller_of
from reasoned_explorer.exploration.settings import ExplorerSettings
from reasoned_explorer.task.sampling import SamplingSettings, sample_episodes
from reasoned_explorer.vehicles.registry import vehicle_profile
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.opening import open_world

GENERATED = ("park:11", "downtown:12", "residential:13", "campus:14", "waterfront:15", "plaza:16")
REAL = Path(__file__).resolve().parents[2] / "shared" / "osm"
#: One square kilometre or less of each, lon0, lat0, lon1, lat1.
BOXES = {
    "helsinki-centre.osm.pbf": (24.9352, 60.1642, 24.9490, 60.1735),
    "munich-centre.osm.pbf": (11.5700, 48.1330, 11.5830, 48.1420),
    "monaco-2025.osm.pbf": (7.4150, 43.7300, 7.4270, 43.7390),
    "uvic-campus.osm.pbf": (-123.3165, 48.4602, -123.3077, 48.4661),
}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=10, help="missions a world, levels 1 to 4 in turn")
    parser.add_argument("--views", type=int, default=24, help="headings a look, over a full circle above 3")
    parser.add_argument("--step-min", type=float, default=2.0, help="shortest step, metres")
    parser.add_argument("--step-max", type=float, default=9.0, help="longest step, metres")
    parser.add_argument("--vehicle", default="drone")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--eyes", default="lines", help="what captions go by: lines or pixels")
    parser.add_argument("--worlds", default="", help="only worlds whose names have this in them")
    options = parser.parse_args()

    sweep_rad = math.radians(120.0) if options.views <= 3 else 2.0 * math.pi
    explorer = ExplorerSettings(
        views=options.views, sweep_rad=sweep_rad, step_min_m=options.step_min, step_max_m=options.step_max
    )
    profile = vehicle_profile(options.vehicle)
    sampling = SamplingSettings(camera_height_m=profile.camera_height_m, max_m=400.0)
    worlds: list[tuple[str, tuple[float, float, float, float] | None]] = [(name, None) for name in GENERATED]
    worlds += [(str(REAL / name), box) for name, box in BOXES.items() if (REAL / name).exists()]
    worlds = [(name, box) for name, box in worlds if options.worlds in name]
    found: dict[int, int] = {}
    tried: dict[int, int] = {}
    for name, box in worlds:
        atlas = Atlas(open_world(name, bbox=box))
        episodes = sample_episodes(
            atlas,
            levels=(1, 2, 3, 4),
            count=options.count,
            seed=options.seed,
            traveller=traveller_of(profile),
            settings=sampling,
        )
        started_s, here = time.perf_counter(), 0
        for episode in episodes:
            settings = MissionSettings(
                minds="oracle",
                captioner="perfect",
                eyes=options.eyes,
                vehicle=options.vehicle,
                explorer=explorer,
                seed=episode.seed,
            )
            summary = Mission(episode.spec.text, atlas, settings, start=episode.start).run().summary
            level = episode.spec.level
            tried[level] = tried.get(level, 0) + 1
            found[level] = found.get(level, 0) + bool(summary.success)
            here += bool(summary.success)
            if not summary.success:
                print(
                    f"  not found: L{level} {episode.spec.text!r} from {episode.start}: {summary.end}, {summary.judge}"
                )
        print(f"{atlas.world.name}: {here} of {len(episodes)} in {time.perf_counter() - started_s:.0f} s", flush=True)
    for level in sorted(tried):
        print(f"L{level}: {found[level]} of {tried[level]}")
    print(f"all: {sum(found.values())} of {sum(tried.values())}")


if __name__ == "__main__":
    main()
