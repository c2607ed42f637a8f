"""How long real places take to import, where the time goes, and how much memory it takes.

    python benchmarks/bench_import.py [--memory] FILE.osm.pbf [lon0,lat0,lon1,lat1] ...

Every file may be followed by its bbox. With ``--memory`` each import runs in a process of its own, whose peak memory
and whole time (interpreter, imports, everything) are printed; aims for 2 km² of Munich: 3 s and 400 MB.
"""

import argparse
import cProfile
import pstats
import resource
import subprocess
import sys
import time
from pathlib import Path

from reasoned_explorer.world.osm.importer import import_osm_with_report

_STAGES = {
    "read_extract": "reading the file",
    "features_of": "frame and multipolygons",
    "buildings_of": "buildings",
    "ways_of": "ways",
    "regions_of": "ground and sea",
    "objects_of": "objects",
}


def main() -> None:
    arguments = _arguments()
    for file, bbox in _pairs(arguments.what):
        if arguments.memory:
            _in_a_process(file, bbox)
        else:
            _here(file, bbox, arguments.repeats)


def _here(file: Path, bbox: tuple[float, float, float, float] | None, repeats: int) -> None:
    times = []
    for _ in range(repeats):
        began = time.perf_counter()
        world, report = import_osm_with_report(file, bbox=bbox)
        times.append(time.perf_counter() - began)
    print(f"\n{file.name}: {world.bounds.area_km2:.2f} km², {min(times):.2f} s (best of {repeats})")
    profile = cProfile.Profile()
    profile.runcall(import_osm_with_report, file, bbox=bbox)
    for (path, _, name), (_, _, _, spent_s, _) in pstats.Stats(profile).stats.items():  # type: ignore[attr-defined]
        if name in _STAGES and "osm" in Path(path).parts:
            print(f"  {_STAGES[name]:<26}{spent_s:>7.2f} s with profiling")
    for what, count in report.counts.items():
        print(f"  {what:<40}{count:>7}")


def _in_a_process(file: Path, bbox: tuple[float, float, float, float] | None) -> None:
    code = (
        "from reasoned_explorer.world.osm.importer import import_osm\n"
        f"print(len(import_osm({str(file)!r}, bbox={bbox!r}).objects), 'objects')"
    )
    began = time.perf_counter()
    done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    spent_s = time.perf_counter() - began
    peak_mb = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss / 1024.0
    print(f"{file.name}: {done.stdout.strip()}, {spent_s:.2f} s, peak {peak_mb:.0f} MB (largest process so far)")


def _pairs(words: list[str]) -> list[tuple[Path, tuple[float, float, float, float] | None]]:
    found: list[tuple[Path, tuple[float, float, float, float] | None]] = []
    for word in words:
        sides = word.split(",")
        if len(sides) == 4 and found:
            lon0, lat0, lon1, lat1 = map(float, sides)
            found[-1] = (found[-1][0], (lon0, lat0, lon1, lat1))
        else:
            found.append((Path(word), None))
    return found


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="Time the import of OpenStreetMap files.")
    parser.add_argument("what", nargs="+", metavar="FILE [BBOX]")
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--memory", action="store_true")
    return parser.parse_args()


if __name__ == "__main__":
    main()
