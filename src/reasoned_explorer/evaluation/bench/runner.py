"""Running a benchmark: what is not finished yet is run, what is finished stays."""

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial

from reasoned_explorer.evaluation.bench.plan import BenchPlan, Task
from reasoned_explorer.evaluation.bench.pools import map_in_processes, run_here, run_in_processes
from reasoned_explorer.evaluation.bench.store import RunStore
from reasoned_explorer.evaluation.bench.worker import Done
from reasoned_explorer.evaluation.model_access import PLAIN_ACCESS, ModelAccess
from reasoned_explorer.task.split import Place, Split
from reasoned_explorer.task.splitting import Dealing, Share, make_split


@dataclass(slots=True)
class BenchProgress:
    """How far a run is.

    Attributes:
        total: Missions of the run.
        finished: Of these, so many are finished, those of an earlier sitting included.
        here: Finished in this sitting.
        failed: Of these, so many with a part that failed.
        usd: Spent in this sitting, US dollars.
        denied: Why it ends early, or None: the budget is spent, or a model is gone.
        started_s: When this sitting began, seconds of a monotonic clock.
    """

    total: int
    finished: int
    here: int = 0
    failed: int = 0
    usd: float = 0.0
    denied: str | None = None
    started_s: float = 0.0

    @property
    def a_second(self) -> float:
        """Missions a second in this sitting; 0 before the first."""
        spent_s = time.monotonic() - self.started_s
        return self.here / spent_s if spent_s > 0.0 else 0.0

    @property
    def left_s(self) -> float | None:
        """Seconds until the run is over at this rate, or None before the first mission."""
        return (self.total - self.finished) / self.a_second if self.here else None


@dataclass(frozen=True, slots=True)
class Workers:
    """Who runs the missions.

    Attributes:
        count: Processes on this machine; 1 runs them in this process.
        ray: ``auto`` or the address of a Ray cluster; None for this machine only.
    """

    count: int = 1
    ray: str | None = None

    def run(self, plan: BenchPlan, tasks: list[Task], access: ModelAccess) -> Iterator[Done]:
        """Run missions; they come in the order in which they end."""
        if self.ray is not None:
            from reasoned_explorer.evaluation.bench.ray_pool import run_on_ray

            return run_on_ray(plan, tasks, access, address=self.ray, workers=self.count)
        if self.count == 1:
            return run_here(plan, tasks, access)
        return run_in_processes(plan, tasks, access, workers=self.count)


def split_of(name: str, places: tuple[Place, ...], *, share: Share, dealing: Dealing, workers: int) -> Split:
    """Return the split of places, dealt by several processes; the same split whatever their number.

    Raises:
        InputError: As `make_split`.
    """
    if workers == 1 or len(places) == 1:
        return make_split(name, places, share=share, dealing=dealing)
    map_places = partial(map_in_processes, workers=min(workers, len(places)))
    return make_split(name, places, share=share, dealing=dealing, map_places=map_places)


def run_bench(
    store: RunStore,
    workers: Workers,
    on_done: Callable[[BenchProgress], None] | None = None,
    *,
    access: ModelAccess = PLAIN_ACCESS,
) -> str | None:
    """Run what is not finished yet; each mission is in the store as soon as it is over.

    Args:
        store: Of the run.
        workers: Who runs the missions.
        on_done: Called once before the first mission and after each.
        access: How models are reached and what they may cost.

    Returns:
        Why not all missions were run, or None where they were: the budget is spent, or a model is gone; the run can be
        gone on with.

    Raises:
        WorldError: If the world of a mission is gone or is another one now; what is finished stays.
        RecordWriteError: If the store cannot be written; what was written stays, and the run can be gone on with.
        KeyboardInterrupt: If a person stops it; likewise.
        MissingDependencyError: If workers need what is not installed.
    """
    plan, finished = store.plan, store.finished()
    tasks = [task for task in plan.tasks() if task.key not in finished]
    progress = BenchProgress(plan.count, plan.count - len(tasks), started_s=time.monotonic())
    if on_done is not None:
        on_done(progress)
    if not tasks:
        return None
    for done in workers.run(plan, tasks, access):
        if done.row is None:
            progress.denied = progress.denied or done.denied
            continue
        store.add(done.task, done.row, trace=done.trace, wall_s=done.wall_s)
        access.forget(done.task.key)
        progress.finished += 1
        progress.here += 1
        progress.failed += done.failed
        progress.usd += done.usd
        if on_done is not None:
            on_done(progress)
    return progress.denied
