"""How fast the main job is: a symbolic 30-minute mission, where its time goes, how it grows, and what starting costs.

Run it with ``make bench`` or ``python benchmarks/bench_main_job.py``; nothing is asserted. Times are of the processor
(medians of several repeats), so that a busy machine counts little. Real places are measured where extracts are found:
``../shared/osm`` beside this repository, or what ``--places`` names.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

from packaging.requirements import Requirement
from rooms_profile import RoomsProfile

from reasoned_explorer.evaluation.mission import Mission, MissionResult, MissionSettings
from reasoned_explorer.exploration.settings import ExplorerSettings
from reasoned_explorer.model import GoalError, StartError
from reasoned_explorer.model.record import MissionEnd
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.generator import DISTRICTS
from reasoned_explorer.world.opening import open_world

PLACES = Path(__file__).resolve().parents[1] / ".." / "shared" / "osm"
MAIN_WORLD = "town:7@600"
#: Things that are easily missed; the first that a mission does not find in its thirty minutes is taken.
GOALS = ("Find me an atm", "Find me a telephone", "Find me a fountain", "Find me a bench near a fountain")
SEEDS = range(8)
MAIN = MissionSettings(planner_settings={"depth": 2}, vehicle="drone", captioner="noisy", latency="gpt-2023")

Job = tuple[str, MissionSettings]


def row(figure: str, value: str, target: str = "") -> None:
    print(f"{figure:<58} {value:>22}  {target}")


def headline(text: str) -> None:
    print(f"\n{text}\n{'-' * len(text)}")


def cpu_s(work: Callable[[], object], repeats: int) -> float:
    """Return the median of the processor's seconds."""
    seconds = []
    for _ in range(repeats):
        start_s = time.process_time()
        work()
        seconds.append(time.process_time() - start_s)
    return statistics.median(seconds)


# The mission.


def run_once(atlas: Atlas, job: Job) -> tuple[MissionResult, float, float]:
    """Return the result of a mission, the seconds that making it ready took, and those from start to judged record."""
    goal, settings = job
    with tempfile.TemporaryDirectory() as folder:
        start_s = time.process_time()
        mission = Mission(goal, atlas, settings)
        ready_s = time.process_time()
        result = mission.run(folder=Path(folder) / "run")
        return result, ready_s - start_s, time.process_time() - ready_s


def long_job(atlas: Atlas, settings: MissionSettings = MAIN) -> Job | None:
    """Return the first goal and seed of which a mission uses up its thirty minutes; None where all are found."""
    for goal in GOALS:
        for seed in SEEDS:
            job = goal, replace(settings, seed=seed)
            with suppress(GoalError, StartError):
                if run_once(atlas, job)[0].summary.end is MissionEnd.TIME_OVER:
                    return job
    return None


def time_mission(atlas: Atlas, job: Job, repeats: int) -> tuple[MissionResult, float, float]:
    result, *_ = run_once(atlas, job)
    ready_s, run_s = zip(*(run_once(atlas, job)[1:] for _ in range(repeats)), strict=True)
    return result, statistics.median(ready_s), statistics.median(run_s)


def main_mission(atlas: Atlas, repeats: int) -> None:
    headline(f"A 30-minute mission ({MAIN_WORLD}, drone, N = 3, L = 2, noisy captions, embedded minds, gpt-2023)")
    job = long_job(atlas)
    if job is None:
        print("every goal was found sooner: not measured")
        return
    result, ready_s, run_s = time_mission(atlas, job, repeats)
    calls = sum(result.summary.calls.values())
    row(f"{job[0]!r}, seed {job[1].seed}", f"{result.summary.steps} steps, {calls} calls")
    row("start to judged and written record", f"{run_s:.3f} s", "<= 0.25 s")
    row("making it ready on a known world (goal, judge, start)", f"{ready_s:.3f} s")
    profile = RoomsProfile()
    with profile:
        spent_s = sum(run_once(atlas, job)[2] for _ in range(2 * repeats)) / (2 * repeats)
    if not profile.samples:
        print("where the time goes: not measured here (no interval timer)")
    for room, share in profile.shares(leave_out="making ready"):
        row(f"  {room}", f"{1e3 * share * spent_s:6.1f} ms {100 * share:5.1f} %")


def growth(atlas: Atlas, repeats: int, places: Path) -> None:
    headline("How a mission's cost grows")
    for depth in range(5):
        grown("L", depth, atlas, replace(MAIN, planner_settings={"depth": depth}), repeats)
    for views in (3, 5, 8):
        grown("N", views, atlas, replace(MAIN, explorer=ExplorerSettings(views=views)), repeats)
    for size_m in (200, 400, 700, 1000):
        grown("world of metres", size_m, Atlas(open_world(f"town:7@{size_m}")), MAIN, repeats)
    for file in sorted(places.glob("munich*.osm.pbf")):
        grown("world", file.name, Atlas(open_world(str(file))), MAIN, repeats)


def grown(what: str, value: object, atlas: Atlas, settings: MissionSettings, repeats: int) -> None:
    job = long_job(atlas, settings)
    if job is None:
        row(f"{what} = {value}", "all found sooner")
        return
    result, ready_s, run_s = time_mission(atlas, job, repeats)
    steps = result.summary.steps
    row(
        f"{what} = {value}: {steps} steps, {1e3 * run_s / steps:.1f} ms a step",
        f"{run_s:.3f} s",
        f"ready {ready_s:.3f} s",
    )


# Worlds.


def worlds(repeats: int, places: Path) -> None:
    headline("Worlds")
    open_world("town:7@200")
    for name in DISTRICTS:
        spent_s = cpu_s(lambda name=name: open_world(f"{name}:7@1000"), repeats)  # type: ignore[misc]
        row(f"generate {name}, 1 km²", f"{spent_s:.2f} s", "<= 1 s")
    for file in sorted(places.glob("*.osm.pbf")):
        spent_s = cpu_s(lambda file=file: open_world(str(file)), 1)  # type: ignore[misc]
        peak_mb = child("open", str(file))["peak_mb"]
        is_munich = file.name.startswith("munich")
        row(f"import {file.name}", f"{spent_s:.2f} s, {peak_mb:.0f} MB", "<= 3 s, <= 400 MB" if is_munich else "")


# Starting, memory and size.


def starting(repeats: int) -> None:
    headline("Starting")
    python = [sys.executable]
    row("a bare interpreter", f"{process_s([*python, '-c', 'pass'], repeats):.3f} s")
    row(
        "import reasoned_explorer",
        f"{process_s([*python, '-c', 'import reasoned_explorer'], repeats):.3f} s",
        "<= 0.3 s",
    )
    rex = [*python, "-m", "reasoned_explorer", "--help"]
    row("rex --help", f"{process_s(rex, repeats):.3f} s", "<= 0.5 s")
    report = child("mission", MAIN_WORLD)
    row("first mission of a process, kernels compiled before", f"{report['run_s']:.2f} s")
    row("peak memory of a process that runs a mission", f"{report['peak_mb']:.0f} MB")


def compiling() -> None:
    headline("The very first mission: every kernel is compiled (then kept on disk)")
    with tempfile.TemporaryDirectory() as folder:
        report = child("mission", MAIN_WORLD, NUMBA_CACHE_DIR=folder)
    row("opening the world and running, nothing compiled before", f"{report['whole_s']:.1f} s")


def process_s(command: Sequence[str], repeats: int) -> float:
    """Return the median of the processor's seconds of a whole process, its interpreter included."""
    seconds = []
    for _ in range(repeats + 1):
        before = os.times()
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        after = os.times()
        spent_s = after.children_user + after.children_system - before.children_user - before.children_system
        seconds.append(spent_s)
    return statistics.median(seconds[1:])


def child(task: str, argument: str, **environment: str) -> dict[str, float]:
    """Do something in a process of its own and return what it measured of itself."""
    command = [sys.executable, __file__, "--child", task, argument]
    done = subprocess.run(command, check=True, stdout=subprocess.PIPE, env={**os.environ, **environment})
    report: dict[str, float] = json.loads(done.stdout.splitlines()[-1])
    return report


def in_child(task: str, argument: str) -> None:
    atlas = Atlas(open_world(argument))
    report = {}
    if task == "mission":
        report["run_s"] = run_once(atlas, (GOALS[0], MAIN))[2]
    report["whole_s"] = time.process_time()
    report["peak_mb"] = peak_mb()
    print(json.dumps(report))


def peak_mb() -> float:
    """Return the most memory that this process has held, megabytes; NaN where nobody tells."""
    status = Path("/proc/self/status")
    if status.is_file():
        # Not getrusage: on Linux a process inherits its peak from the one that started it.
        kilobytes = next(
            (line.split()[1] for line in status.read_text().splitlines() if line.startswith("VmHWM")), "nan"
        )
        return float(kilobytes) / 1e3
    try:
        import resource
    except ImportError:  # not on Windows
        return float("nan")
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak / 1e6 if sys.platform == "darwin" else peak / 1e3


def sizes() -> None:
    headline("Installed size of the core (this package and all that it cannot do without)")
    found = {name: installed_mb(name) for name in closure("reasoned-explorer")}
    found["reasoned-explorer"] = package_mb()
    for name, size_mb in sorted(found.items(), key=lambda item: -item[1])[:6]:
        row(f"  {name}", f"{size_mb:.1f} MB")
    row(f"all {len(found)} packages", f"{sum(found.values()):.0f} MB", "<= 500 MB")


def closure(root: str) -> set[str]:
    """Return the names of the packages that one needs, itself included; extras are left out."""
    names: set[str] = set()
    waiting = [root]
    while waiting:
        name = waiting.pop()
        if name in names:
            continue
        names.add(name)
        with suppress(PackageNotFoundError):
            requirements = distribution(name).requires
        for text in requirements or ():
            needed = Requirement(text)
            if needed.marker is None or needed.marker.evaluate({"extra": ""}):
                waiting.append(needed.name.lower().replace("_", "-"))
    return names


def installed_mb(name: str) -> float:
    try:
        files = distribution(name).files or ()
    except PackageNotFoundError:
        return 0.0
    paths = [Path(str(file.locate())) for file in files]
    return sum(path.stat().st_size for path in paths if path.is_file()) / 1e6


def package_mb() -> float:
    import reasoned_explorer

    folder = Path(reasoned_explorer.__file__).parent
    files = [path for path in folder.rglob("*") if path.is_file() and path.parent.name != "__pycache__"]
    return sum(path.stat().st_size for path in files) / 1e6


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeats", type=int, default=5, help="of every figure (default 5)")
    parser.add_argument("--places", type=Path, default=PLACES, help="folder of OpenStreetMap extracts")
    parser.add_argument("--only", choices=("mission", "growth", "worlds", "starting", "size"), help="one part")
    parser.add_argument("--compile", action="store_true", help="also time a first run that compiles all kernels")
    parser.add_argument("--child", nargs=2, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.child:
        in_child(*options.child)
        return
    repeats, wanted = max(1, options.repeats), options.only
    row("figure", "measured", "target")
    if wanted in (None, "mission", "growth"):
        atlas = Atlas(open_world(MAIN_WORLD))
        if wanted != "growth":
            main_mission(atlas, 2 * repeats)
        if wanted != "mission":
            growth(atlas, max(1, repeats // 2), options.places)
    if wanted in (None, "worlds"):
        worlds(max(1, repeats // 2), options.places)
    if wanted in (None, "starting"):
        starting(repeats)
    if wanted in (None, "size"):
        sizes()
    if options.compile:
        compiling()


if __name__ == "__main__":
    main()
