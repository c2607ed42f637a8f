"""Against a real Ray, started on this machine by the test."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from reasoned_explorer.evaluation.bench.plan import BenchPlan
from reasoned_explorer.evaluation.bench.runner import Workers, run_bench
from reasoned_explorer.evaluation.bench.store import RunStore
from reasoned_explorer.evaluation.bench.worker import run_task
from reasoned_explorer.model import MissingDependencyError, SettingsError

# Ray's own client code warns of what other packages will drop.
pytestmark = pytest.mark.filterwarnings("ignore")


@pytest.fixture(scope="module")
def ray() -> Iterator[Any]:
    module = pytest.importorskip("ray", reason="Ray is not installed: pip install 'reasoned-explorer[ray]'")
    module.init(address="local", num_cpus=2, log_to_driver=False, include_dashboard=False, logging_level="ERROR")
    yield module
    module.shutdown()


def test_ray_makes_the_same_rows(ray: Any, tmp_path: Path, small_plan: BenchPlan) -> None:
    with RunStore.create(tmp_path / "run", small_plan, {}) as store:
        run_bench(store, Workers(2, ray="auto"))
        rows = [row.as_json() for row in store.rows()]
        kept = [store.record(row) is not None for row in store.rows()]
    alone = {task.key: run_task(small_plan, task).row for task in small_plan.tasks()}
    assert rows == [alone[key] for key in sorted(alone)]
    assert all(kept)


def test_a_lost_worker_loses_no_mission(
    ray: Any, tmp_path: Path, small_plan: BenchPlan, monkeypatch: pytest.MonkeyPatch
) -> None:
    from reasoned_explorer.evaluation.bench import ray_pool

    marker = str(tmp_path / "died")

    def dies_once(plan: BenchPlan, task: Any, access: Any) -> Any:
        import os
        import signal

        try:
            os.close(os.open(marker, os.O_CREAT | os.O_EXCL))
        except FileExistsError:
            return run_task(plan, task, access)
        os.kill(os.getpid(), signal.SIGKILL)
        return None

    monkeypatch.setattr(ray_pool, "run_task", dies_once)
    tasks = list(small_plan.tasks())[:3]
    done = list(ray_pool.run_on_ray(small_plan, tasks, address="auto"))
    assert Path(marker).exists()
    assert {each.task.key: each.row for each in done} == {task.key: run_task(small_plan, task).row for task in tasks}


def test_a_cluster_that_is_not_there_is_bad_input(small_plan: BenchPlan, monkeypatch: pytest.MonkeyPatch) -> None:
    ray = pytest.importorskip("ray")
    from reasoned_explorer.evaluation.bench.ray_pool import run_on_ray

    monkeypatch.setattr(ray, "is_initialized", lambda: False)
    monkeypatch.setattr(ray, "init", lambda **_: (_ for _ in ()).throw(ConnectionError("nobody answers")))
    with pytest.raises(SettingsError, match="nobody answers"):
        list(run_on_ray(small_plan, [], address="127.0.0.1:1"))


def test_without_ray_its_install_command_is_told(small_plan: BenchPlan, monkeypatch: pytest.MonkeyPatch) -> None:
    import sys

    from reasoned_explorer.evaluation.bench.ray_pool import run_on_ray

    monkeypatch.setitem(sys.modules, "ray", None)
    with pytest.raises(MissingDependencyError, match=r"reasoned-explorer\[ray\]"):
        list(run_on_ray(small_plan, [], address="auto"))
