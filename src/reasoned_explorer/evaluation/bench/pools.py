"""Who runs the missions of a run on this machine: this process, or several."""

import os
import signal
import threading
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing import active_children, get_context, parent_process
from typing import Any, TypeVar

from reasoned_explorer.evaluation.bench.plan import BenchPlan, Task
from reasoned_explorer.evaluation.bench.worker import Done, failed_row, run_task
from reasoned_explorer.model.stopping import stop_if_asked

T = TypeVar("T")

#: Missions handed out ahead, a worker: enough that none waits, few enough that memory does not grow with the run.
_AHEAD = 3
#: A mission whose process died is tried so often; then it has failed.
MAX_TRIES = 3
#: While this process waits for others, it looks so often whether a person asks it to stop, seconds.
_LOOK_EVERY_S = 0.1
_BLAS = ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS")

_plan: BenchPlan | None = None


def run_here(plan: BenchPlan, tasks: Sequence[Task]) -> Iterator[Done]:
    """Run missions one after the other in this process."""
    for task in tasks:
        stop_if_asked()
        yield run_task(plan, task)


def run_in_processes(plan: BenchPlan, tasks: Sequence[Task], *, workers: int) -> Iterator[Done]:
    """Run missions in several processes; they come in the order in which they end.

    A process that dies takes nothing with it but the missions that it was in: these are tried again. Processes whose
    parent is gone end by themselves.
    """
    left = iter(tasks)
    with _one_thread_each():
        while suspects := (yield from _run_pool(plan, left, workers)):
            # Which of them it was cannot be known: each is tried alone, so that none fails for another.
            for task in suspects:
                yield from _run_alone(plan, task)


def _run_alone(plan: BenchPlan, task: Task) -> Generator[Done, None, None]:
    for _ in range(1, MAX_TRIES):
        suspects = yield from _run_pool(plan, iter([task]), 1)
        if not suspects:
            return
    yield lost(plan, task, f"its process died {MAX_TRIES} times")


def lost(plan: BenchPlan, task: Task, reason: str) -> Done:
    """Return the outcome of a mission whose worker was lost for good."""
    return Done(task, failed_row(plan, task, reason).as_json(), None, 0.0, failed=True, usd=0.0)


def _run_pool(plan: BenchPlan, tasks: Iterator[Task], workers: int) -> Generator[Done, None, list[Task]]:
    """Run missions until they are done or a process dies; return the missions that were under way when it did."""
    under_way: dict[Future[Done], Task] = {}
    broken: list[Task] = []
    with _pool(workers, _begin, plan) as pool:
        while True:
            for task in tasks:
                try:
                    with _deaf():
                        under_way[pool.submit(_run, task)] = task
                except BrokenProcessPool:
                    broken.append(task)
                if broken or len(under_way) >= _AHEAD * workers:
                    break
            if not under_way:
                return broken
            while not (done := wait(under_way, timeout=_LOOK_EVERY_S, return_when=FIRST_COMPLETED).done):
                stop_if_asked()
            stop_if_asked()
            for future in done:
                task = under_way.pop(future)
                try:
                    yield future.result()
                except BrokenProcessPool:
                    broken.append(task)
            if broken:
                broken += under_way.values()
                return broken


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


def _begin(plan: BenchPlan) -> None:
    global _plan  # noqa: PLW0603 - what a worker process is for
    _plan = plan
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _run(task: Task) -> Done:
    if _plan is None:
        raise AssertionError
    return run_task(_plan, task)


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
