"""Who runs the missions of a run on this machine: this process, or several."""

import gc
import os
import signal
import threading
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from multiprocessing import active_children, get_context, parent_process
from typing import Any, TypeVar

from reasoned_explorer.evaluation.bench.plan import BenchPlan, Task
from reasoned_explorer.evaluation.bench.worker import Done, failed_row, run_task
from reasoned_explorer.evaluation.model_access import PLAIN_ACCESS, ModelAccess
from reasoned_explorer.model.garbage import RARELY
from reasoned_explorer.model.stopping import stop_if_asked

T = TypeVar("T")

#: Missions handed out ahead, a worker: enough that none waits, few enough that memory does not grow with the run.
_AHEAD = 2
#: A mission whose process died is tried so often; then it has failed.
MAX_TRIES = 3
#: While this process waits for others, it looks so often whether a person asks it to stop, seconds.
_LOOK_EVERY_S = 0.1
_BLAS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")

_plan: BenchPlan | None = None
_access = PLAIN_ACCESS


def run_here(plan: BenchPlan, tasks: Sequence[Task], access: ModelAccess = PLAIN_ACCESS) -> Iterator[Done]:
    """Run missions one after the other in this process, as long as calls of models may begin."""
    for task in tasks:
        stop_if_asked()
        done = run_task(plan, task, access)
        yield done
        if done.denied is not None:
            return


def run_in_processes(
    plan: BenchPlan, tasks: Sequence[Task], access: ModelAccess = PLAIN_ACCESS, *, workers: int
) -> Iterator[Done]:
    """Run missions in several processes; they come in the order in which they end.

    A process that dies takes nothing with it but the missions that it was in: these are tried again. Processes whose
    parent is gone end by themselves. Once a mission was broken off, its budget spent or its model gone, no other is
    begun.
    """
    with _one_thread_each():
        while suspects := (yield from _run_pool(plan, tasks, access, workers)):
            # Which of them it was cannot be known: each is tried alone, so that none fails for another.
            for task in suspects.under_way:
                yield from _run_alone(plan, task, access)
            tasks = suspects.left


def _run_alone(plan: BenchPlan, task: Task, access: ModelAccess) -> Generator[Done, None, None]:
    for _ in range(1, MAX_TRIES):
        if (yield from _run_pool(plan, [task], access, 1)) is None:
            return
    yield lost(plan, task, f"its process died {MAX_TRIES} times")


def lost(plan: BenchPlan, task: Task, reason: str) -> Done:
    """Return the outcome of a mission whose worker was lost for good."""
    return Done(task, failed_row(plan, task, reason).as_json(), None, 0.0, failed=True, usd=0.0)


@dataclass(frozen=True, slots=True)
class _Broken:
    """Where a run stood when a process died: the missions that its processes were in, and those to come."""

    under_way: list[Task]
    left: list[Task]


def _run_pool(
    plan: BenchPlan, tasks: Sequence[Task], access: ModelAccess, workers: int
) -> Generator[Done, None, _Broken | None]:
    """Run missions until they are done or one is broken off (returns None), or a process dies."""
    queues = Queues(plan, tasks, workers)
    under_way: dict[Future[Done], tuple[int, Task]] = {}
    with ExitStack() as stack:
        # A pool of one for each worker: a mission can then be given to the one that has its world open.
        pools = [stack.enter_context(_pool(1, _begin, plan, access)) for _ in range(workers)]
        busy = [0] * workers
        while True:
            died = False
            for worker, pool in enumerate(pools):
                while busy[worker] < _AHEAD and (task := queues.take(worker)) is not None:
                    try:
                        with _deaf():
                            under_way[pool.submit(_run, task)] = worker, task
                    except BrokenProcessPool:
                        queues.put_back(worker, task)
                        died = True
                        break
                    busy[worker] += 1
            if not under_way and not died:
                return None
            while not (done := wait(under_way, timeout=_LOOK_EVERY_S, return_when=FIRST_COMPLETED).done):
                stop_if_asked()
            stop_if_asked()
            broken = []
            for future in done:
                worker, task = under_way.pop(future)
                busy[worker] -= 1
                try:
                    ended = future.result()
                except BrokenProcessPool:
                    broken.append(task)
                    continue
                queues.heed(ended)
                yield ended
            if broken or died:
                return _Broken([*broken, *(task for _, task in under_way.values())], queues.left())


class Queues:
    """Which worker runs which mission: all of a place one worker's, until there are no places left to take.

    A world that is open, and what a judge found out in it, then serve all missions of the place. At the end, who has
    nothing left takes half of what the one with most has.

    Args:
        plan: Of the run.
        tasks: Its missions, those of a place together.
        workers: How many workers there are.
    """

    def __init__(self, plan: BenchPlan, tasks: Sequence[Task], workers: int) -> None:
        self._places: deque[deque[Task]] = deque()
        before = None
        for task in tasks:
            place = plan.episode_of(task).place
            if place != before:
                self._places.append(deque())
                before = place
            self._places[-1].append(task)
        self._own: list[deque[Task]] = [deque() for _ in range(workers)]

    def take(self, worker: int) -> Task | None:
        """Return a worker's next mission, or None where nothing is left."""
        own = self._own[worker]
        if not own and self._places:
            own = self._own[worker] = self._places.popleft()
        elif not own:
            richest = max(self._own, key=len)
            for _ in range((len(richest) + 1) // 2):
                own.appendleft(richest.pop())
        return own.popleft() if own else None

    def put_back(self, worker: int, task: Task) -> None:
        """Give a mission back that could not be begun."""
        self._own[worker].appendleft(task)

    def heed(self, done: Done) -> None:
        """Hand out nothing more once a mission was broken off: the budget is spent, or a model is gone."""
        if done.denied is not None:
            self._places.clear()
            for queue in self._own:
                queue.clear()

    def left(self) -> list[Task]:
        """Return all missions that nobody has taken, those of a place together."""
        return [task for queue in (*self._own, *self._places) for task in queue]


def map_in_processes(work: Callable[..., T], *columns: Iterable[Any], workers: int) -> list[T]:
    """Return what `map` returns, worked out by several processes.

    Raises:
        KeyboardInterrupt: If a person asks to stop.
    """
    with _pool(workers) as pool:
        with _deaf():
            futures = [pool.submit(work, *row) for row in zip(*columns, strict=True)]
        while wait(futures, timeout=_LOOK_EVERY_S).not_done:
            stop_if_asked()
        return [future.result() for future in futures]


@contextmanager
def _pool(workers: int, begin: Callable[..., None] | None = None, *arguments: Any) -> Iterator[ProcessPoolExecutor]:
    """Have processes for a while; where the work is given up, they are ended in the middle of theirs."""
    others = set(active_children())
    pool = ProcessPoolExecutor(workers, mp_context=get_context("spawn"), initializer=begin, initargs=arguments)
    try:
        yield pool
    except BaseException:
        for process in set(active_children()) - others:
            process.terminate()
        raise
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


@contextmanager
def _deaf() -> Iterator[None]:
    """Have processes that start now hear no Ctrl-C, which a terminal sends to all: this one ends them."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _begin(plan: BenchPlan, access: ModelAccess) -> None:
    global _plan, _access
    _plan, _access = plan, access
    gc.set_threshold(*RARELY)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _run(task: Task) -> Done:
    if _plan is None:
        raise AssertionError
    return run_task(_plan, task, _access)


@contextmanager
def _one_thread_each() -> Iterator[None]:
    """Have processes that start now count with one thread each: they are side by side already."""
    before = {name: os.environ.get(name) for name in _BLAS}
    os.environ.update(dict.fromkeys(_BLAS, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value
