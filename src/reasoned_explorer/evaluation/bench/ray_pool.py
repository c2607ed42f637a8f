"""Missions of a run on a Ray cluster: the same missions, the same rows, whichever machine runs which."""

import re
import socket
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib.util import find_spec
from typing import Any

from reasoned_explorer.evaluation.bench.plan import BenchPlan, Task
from reasoned_explorer.evaluation.bench.pools import MAX_TRIES, lost
from reasoned_explorer.evaluation.bench.worker import Done, run_task
from reasoned_explorer.evaluation.model_access import PLAIN_ACCESS, ModelAccess
from reasoned_explorer.model import Fault, MissingDependencyError, SettingsError
from reasoned_explorer.model.stopping import stop_if_asked

#: Missions handed out ahead for each processor of the cluster.
_AHEAD = 2
#: So often it is looked whether a person asks to stop, seconds.
_LOOK_EVERY_S = 0.5
#: So long a cluster may take to answer, seconds.
_ANSWER_S = 5.0
_ADDRESS = re.compile(r"(?:ray://)?(?P<host>[\w.-]+|\[[0-9A-Fa-f:.]+\]):(?P<port>\d{1,5})", re.ASCII)


def run_on_ray(
    plan: BenchPlan,
    tasks: Sequence[Task],
    access: ModelAccess = PLAIN_ACCESS,
    *,
    address: str,
    workers: int | None = None,
) -> Iterator[Done]:
    """Run missions on a Ray cluster; they come in the order in which they end.

    A mission whose worker or node is lost is tried again elsewhere.

    Args:
        plan: Of the run.
        tasks: Its missions.
        access: How models are reached; without budget and tapes, which are files of one machine.
        address: ``auto`` joins the cluster that this machine belongs to, or starts one here where there is none;
            otherwise the address of a cluster.
        workers: Processors that a cluster started here has; None takes those of this machine.

    Raises:
        MissingDependencyError: If Ray is not installed.
        SettingsError: If the cluster cannot be reached.
    """
    ray = _ray()
    with joined(address, workers):
        # Read once by every node, not sent along with every mission.
        shared = ray.put(plan)
        remote = ray.remote(num_cpus=1, max_retries=MAX_TRIES - 1)(run_task)
        left = iter(tasks)
        under_way: dict[Any, Task] = {}
        most = _AHEAD * max(1, int(ray.cluster_resources().get("CPU", 1)))
        while True:
            for task in left:
                under_way[remote.remote(shared, task, access)] = task
                if len(under_way) >= most:
                    break
            if not under_way:
                return
            ready: list[Any] = []
            while not ready:
                stop_if_asked()
                ready, _ = ray.wait(list(under_way), num_returns=1, timeout=_LOOK_EVERY_S)
            for reference in ready:
                task = under_way.pop(reference)
                try:
                    yield ray.get(reference)
                except ray.exceptions.RayTaskError as error:
                    # What the mission's code raised, not what became of its worker.
                    raise error.cause from None
                except ray.exceptions.RayError as error:
                    yield lost(plan, task, f"its worker was lost {MAX_TRIES} times: {type(error).__name__}")


@contextmanager
def joined(address: str, workers: int | None = None) -> Iterator[None]:
    """Be part of a cluster for as long as a ``with`` block lasts; see `run_on_ray`.

    Raises:
        MissingDependencyError: If Ray is not installed.
        SettingsError: If the cluster cannot be reached.
    """
    ray = _ray()
    started = _join(ray, address, workers)
    try:
        yield
    finally:
        if started:
            ray.shutdown()


def check_address(address: str) -> None:
    """Check that an address is one, and that somebody answers there; Ray itself takes long to find that out.

    Raises:
        SettingsError: If it is none, or nobody answers.
    """
    expected = "auto, or the address of a running Ray cluster, e.g. 10.0.0.5:6379 or ray://10.0.0.5:10001"
    if address == "auto":
        return
    found = _ADDRESS.fullmatch(address)
    if found is None or not 0 < int(found["port"]) < 1 << 16:
        raise SettingsError("--ray", [Fault(f"{address!r}", expected)])
    try:
        socket.create_connection((found["host"].strip("[]"), int(found["port"])), timeout=_ANSWER_S).close()
    except OSError as error:
        what = f"the cluster at {address!r} cannot be reached: {error}"
        raise SettingsError("--ray", [Fault(what, expected)]) from error


def require_ray() -> None:
    """Say whether Ray is there, without the seconds that loading it takes.

    Raises:
        MissingDependencyError: If Ray is not installed.
    """
    if find_spec("ray") is None:
        raise _missing()


def _missing() -> MissingDependencyError:
    return MissingDependencyError("--ray", "ray", "pip install 'reasoned-explorer[ray]'")


def _ray() -> Any:
    try:
        import ray
    except ImportError as error:
        raise _missing() from error
    return ray


def _join(ray: Any, address: str, workers: int | None) -> bool:
    """Join a cluster; return whether it was done here and has to be undone here."""
    if ray.is_initialized():
        return False
    quiet = {"log_to_driver": False, "include_dashboard": False, "logging_level": "ERROR"}
    try:
        if address != "auto":
            ray.init(address=address, **quiet)
            return True
        try:
            ray.init(address="auto", **quiet)
        except ConnectionError:
            ray.init(address="local", num_cpus=workers, **quiet)
    except (ConnectionError, ValueError, RuntimeError) as error:
        what = f"the cluster at {address!r} cannot be reached: {error}"
        raise SettingsError("--ray", [Fault(what, "auto, or the address of a running Ray cluster")]) from error
    return True
