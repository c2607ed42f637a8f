"""What running many missions costs: throughput by workers, memory by missions, a run that is killed again and again.

Run::

    python benchmarks/bench_runner.py [--only throughput|memory|kills] [--kills 50]

Throughput is missions a second of the same missions with one worker and with two, in turn, so that the ratio holds when
the machine's speed drifts. Memory is the highest resident size of the whole family of processes, with 100 missions and
with 10,000 (of one minute each: what is kept of a mission does not depend on how long it lasts). Kills end a run with
SIGKILL at random moments, go on with it, and compare its rows with those of a run that was left alone.
"""

import argparse
import hashlib
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

from reasoned_explorer.evaluation.bench.plan import BenchPlan
from reasoned_explorer.evaluation.bench.runner import Workers, run_bench
from reasoned_explorer.evaluation.bench.store import RunStore
from reasoned_explorer.evaluation.mission import MissionSettings
from reasoned_explorer.exploration.settings import ExplorerSettings
from reasoned_explorer.task.splitting import Dealing, Share, make_split, places_of_worlds

PLANNERS = ("llm-rrt", "llm-as-eval", "nearest-frontier")


def plan_of(t_max_s: float, *, seeds: int = 1, planners: tuple[str, ...] = PLANNERS) -> BenchPlan:
    """Return a plan over four small worlds."""
    worlds = ["park:31@400", "plaza:32@400", "downtown:33@400", "campus:34@400"]
    split = make_split("runner", places_of_worlds(worlds), share=Share(), dealing=Dealing(5))
    base = MissionSettings(explorer=ExplorerSettings(t_max_s=t_max_s))
    return BenchPlan(split, planners, base=base, seeds=tuple(range(seeds)), keep_traces=seeds == 1)


def start(folder: Path, workers: int) -> subprocess.Popen[bytes]:
    """Start going on with a run in a process of its own."""
    return subprocess.Popen([sys.executable, __file__, "--go-on", str(folder), "--workers", str(workers)])


def go_on(folder: Path, workers: int) -> None:
    with RunStore.open(folder) as store:
        run_bench(store, Workers(workers))


def rows_hash(folder: Path) -> str:
    """Return a hash of all rows of a run, in order."""
    with RunStore.open(folder) as store:
        return hashlib.sha256("\n".join(row.as_json() for row in store.rows()).encode()).hexdigest()[:16]


def family_mb(pid: int) -> float:
    """Return the resident size of a process and its children, MB."""
    total = 0
    for one in (pid, *_children(pid)):
        try:
            status = Path(f"/proc/{one}/status").read_text()
        except (FileNotFoundError, ProcessLookupError):
            continue
        total += next((int(line.split()[1]) for line in status.splitlines() if line.startswith("VmRSS")), 0)
    return total / 1024.0


def _children(pid: int) -> list[int]:
    try:
        return [int(child) for child in Path(f"/proc/{pid}/task/{pid}/children").read_text().split()]
    except (FileNotFoundError, ProcessLookupError):
        return []


def throughput(scratch: Path) -> None:
    plan = plan_of(1800.0)
    print(f"throughput, {plan.count} missions of up to 30 minutes, workers' start included")
    ratios = []
    for round_ in range(2):
        pace = {}
        for workers in (1, 2):
            folder = scratch / f"t{round_}-{workers}"
            RunStore.create(folder, plan, {}).close()
            started_s = time.perf_counter()
            start(folder, workers).wait()
            pace[workers] = plan.count / (time.perf_counter() - started_s)
            print(f"  {workers} worker(s): {pace[workers]:.2f} missions a second")
        ratios.append(pace[2] / pace[1])
    print("  two workers against one: " + ", ".join(f"{ratio:.2f}" for ratio in ratios))


def memory(scratch: Path) -> None:
    print("memory, missions of one minute, two workers")
    one = plan_of(60.0, planners=("nearest-frontier",))
    for missions in (100, 10_000):
        plan = replace(one, seeds=tuple(range(-(-missions // len(one.split.episodes)))), keep_traces=False)
        folder = scratch / f"m{missions}"
        RunStore.create(folder, plan, {}).close()
        process, peak_mb = start(folder, 2), 0.0
        while process.poll() is None:
            peak_mb = max(peak_mb, family_mb(process.pid))
            time.sleep(0.05)
        print(f"  {plan.count} missions: {peak_mb:.0f} MB at most, all processes together")


def kills(scratch: Path, count: int) -> None:
    plan = plan_of(600.0)
    alone, killed = scratch / "alone", scratch / "killed"
    RunStore.create(alone, plan, {}).close()
    started_s = time.perf_counter()
    start(alone, 2).wait()
    whole_s = time.perf_counter() - started_s
    RunStore.create(killed, plan, {}).close()
    chance, killed_times = random.Random(7), 0
    for _ in range(count):
        process = start(killed, 2)
        try:
            # Starting takes seconds; so that the run is not over after a few kills, each sitting is a short one.
            process.wait(2.0 + chance.random() * 4.0)
            break
        except subprocess.TimeoutExpired:
            os.kill(process.pid, signal.SIGKILL)
            process.wait()
            killed_times += 1
    with RunStore.open(killed) as store:
        finished = len(store.finished())
    start(killed, 2).wait()
    same = rows_hash(alone) == rows_hash(killed)
    print(f"kills: {plan.count} missions, {whole_s:.0f} s when left alone; killed {killed_times} times, then")
    print(f"  {finished} finished, run to the end: rows {'identical' if same else 'DIFFERENT'} ({rows_hash(killed)})")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", choices=("throughput", "memory", "kills"))
    parser.add_argument("--kills", type=int, default=50)
    parser.add_argument("--go-on", type=Path, help=argparse.SUPPRESS)
    parser.add_argument("--workers", type=int, default=2, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.go_on:
        go_on(options.go_on, options.workers)
        return
    with tempfile.TemporaryDirectory() as scratch:
        for name, measure in (("throughput", throughput), ("memory", memory)):
            if options.only in {None, name}:
                measure(Path(scratch))
        if options.only in {None, "kills"}:
            kills(Path(scratch), options.kills)


if __name__ == "__main__":
    main()
