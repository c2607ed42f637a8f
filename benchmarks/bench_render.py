"""How fast pictures are drawn, beside Embree casting rays at the same triangles, in one run.

Run it with ``python benchmarks/bench_render.py``; with ``--world munich.osm.pbf`` (or any other) on another world. Each
line says whether its bar is met; bars are for one core of a machine that does nothing else:

- pictures of 224 × 224 with depth and ids: 80 a second, with 2 × 2 samples a pixel 35 a second;
- depth and ids alone at 96 × 96: 600 a second;
- two threads: 1.7 times as many pictures as one;
- with ``--cold``, ``rex look`` at a world of 200 m: 15 s with nothing compiled, 2 s with compiled code kept; the same
  for a new process's first picture of the world, but for opening it;
- ids that agree with Embree: 99.99 % of pixels.
"""

import argparse
import hashlib
import math
import os
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Camera
from reasoned_explorer.rendering.projection import projection_of
from reasoned_explorer.rendering.renderer import Renderer
from reasoned_explorer.rendering.scene import Scene
from reasoned_explorer.world.opening import open_world
from reasoned_explorer.world.world import World

ROOT = Path(__file__).resolve().parents[1]
VIEW, SMALL = Camera(224, 224), Camera(96, 96)
_PLAZA = ("look", "--world", "plaza:3@200", "--at", "0,0,1.6,40")
_FIRST = """
import time
begin = time.perf_counter()
from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Camera
from reasoned_explorer.rendering.readiness import begin as start_compiling
from reasoned_explorer.rendering.renderer import Renderer
from reasoned_explorer.rendering.scene import Scene
from reasoned_explorer.world.opening import open_world
imported = time.perf_counter()
world = open_world({world!r})
opened = time.perf_counter()
start_compiling()
scene = Scene.of(world)
made = time.perf_counter()
Renderer(scene).picture(Pose(0.0, 0.0, 1.6), Camera())
end = time.perf_counter()
print(imported - begin, opened - imported, made - opened, end - made)
"""


def poses(world: World, count: int) -> list[Pose]:
    """Random places on ways at eye height, in random directions."""
    rng = np.random.default_rng(11)
    ways = [way for way in world.ways if way.level == 0]
    found = []
    for _ in range(count):
        line = ways[rng.integers(len(ways))].line
        at = rng.integers(len(line) - 1)
        x, y = line[at] + rng.random() * (line[at + 1] - line[at])
        found.append(Pose(float(x), float(y), 1.6, rng.uniform(0.0, 2.0 * math.pi)))
    return found


def rate(work: Callable[[Pose], object], places: list[Pose], *, rounds: int = 3) -> float:
    """How often a second of this thread's time the work is done, the median of rounds."""
    found = []
    for _ in range(rounds):
        begin = time.thread_time()
        for place in places:
            work(place)
        found.append(len(places) / (time.thread_time() - begin))
    return statistics.median(found)


def threads_gain(work: Callable[[Pose], object], places: list[Pose]) -> float:
    """How many times as often a second two threads do the work as one."""

    def wall(workers: int) -> float:
        with ThreadPoolExecutor(workers) as pool:
            begin = time.perf_counter()
            list(pool.map(work, places))
            return time.perf_counter() - begin

    wall(2)
    return statistics.median(wall(1) / wall(2) for _ in range(5))


def busy(_: Pose) -> None:
    """About as much work as a picture is, without a shared thing: what two threads can gain on this machine now."""
    hashlib.sha256(bytes(8_000_000)).digest()


def seconds_to_look(cache: str) -> float:
    """Seconds from typing ``rex look`` to a picture of a small world."""
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "reasoned_explorer", *_PLAZA, "--out", f"{folder}/look.png"]
        begin = time.perf_counter()
        subprocess.run(command, env={**os.environ, "NUMBA_CACHE_DIR": cache}, stdout=subprocess.DEVNULL, check=True)
        return time.perf_counter() - begin


def first_picture(world: str, cache: str) -> tuple[float, ...]:
    """Seconds in which a new process loads the package, opens a world, makes its scene, and draws its first picture."""
    environment = {**os.environ, "NUMBA_CACHE_DIR": cache}
    command = [sys.executable, "-c", _FIRST.format(world=world)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    return tuple(map(float, done.stdout.split()))


def report(name: str, value: float, bar: float, *, unit: str = "/s", most: bool = False) -> None:
    """Print a figure and whether it meets its bar."""
    met = value <= bar if most else value >= bar
    print(f"{name:<52} {value:9.2f} {unit:<4} bar {bar:7.2f}  {'met' if met else 'MISSED'}", flush=True)


def beside_embree(renderer: Renderer, places: list[Pose]) -> None:
    """Compare with ray casting at the triangles that were drawn for each view."""
    sys.path.insert(0, str(ROOT))
    try:
        from tests.rendering import oracle
    except ImportError:
        print("embreex is not there: pip install embreex")
        return
    casts, draws, wrong = [], [], []
    for place in places:
        view = projection_of(place, VIEW)
        begin = time.thread_time()
        renderer.ids(place, VIEW)
        draws.append(time.thread_time() - begin)
        wrong.append(oracle.compared(renderer, place, VIEW).wrong_share)
        casts.append(oracle.cast_seconds(renderer.scene, renderer._room().scratch.levels, view))
    print(f"{'ids and depth at 224 × 224':<52} {1 / np.mean(draws):9.2f} /s")
    print(f"{'  Embree at the same triangles, rays alone':<52} {1 / np.mean(casts):9.2f} /s")
    report("ids that agree with Embree", 100.0 * (1.0 - float(np.mean(wrong))), 99.99, unit="%")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--world", default="downtown:3@1000", help="any world (default: %(default)s)")
    parser.add_argument("--views", type=int, default=50, help="how many (default: %(default)s)")
    parser.add_argument("--cold", action="store_true", help="time first pictures in new processes, too")
    chosen = parser.parse_args()
    world = open_world(chosen.world)
    scene = Scene.of(world)
    renderer = Renderer(scene)
    places = poses(world, chosen.views)
    print(f"{chosen.world}: {len(scene.instances.ids)} instances, {scene.triangle_count} triangles at full detail")
    renderer.picture(Pose(0.0, 0.0, 500.0), VIEW)  # compiles
    begin = time.perf_counter()
    for place in places:
        renderer.picture(place, VIEW)
    fresh = (time.perf_counter() - begin) / len(places)
    print(f"{'pictures where no shadow tile is there yet':<52} {1 / fresh:9.2f} /s")
    report("pictures", rate(lambda place: renderer.picture(place, VIEW), places), 80.0)
    report("pictures, 2 × 2 samples", rate(lambda place: renderer.picture(place, VIEW, antialias=2), places), 35.0)
    report("depth and ids at 96 × 96", rate(lambda place: renderer.ids(place, SMALL), places), 600.0)
    gain = threads_gain(lambda place: renderer.picture(place, VIEW), places)
    report("two threads over one", gain, 1.7, unit="×")
    print(f"{'  of work that shares nothing, now':<52} {threads_gain(busy, places):9.2f} ×")
    beside_embree(renderer, places)
    if chosen.cold:
        with tempfile.TemporaryDirectory() as cache:
            for name, bar in (("rex look, nothing compiled", 15.0), ("rex look, compiled code kept", 2.0)):
                report(name, seconds_to_look(cache), bar, unit="s", most=True)
        with tempfile.TemporaryDirectory() as cache:
            for name, bar in (("first picture, nothing compiled", 15.0), ("first picture, compiled code kept", 2.0)):
                loading, opening, making, picture = first_picture(chosen.world, cache)
                report(name, loading + making + picture, bar, unit="s", most=True)
                print(f"  loading {loading:.2f} s, scene {making:.2f} s, renderer and picture {picture:.2f} s", end="")
                print(f" (and {opening:.2f} s to open the world)")


if __name__ == "__main__":
    main()
