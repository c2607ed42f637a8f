import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import pytest

from reasoned_explorer.evaluation.bench.plan import BenchPlan, Task
from reasoned_explorer.evaluation.bench.pools import MAX_TRIES, Queues, run_in_processes
from reasoned_explorer.evaluation.bench.runner import BenchProgress, Workers, run_bench, split_of
from reasoned_explorer.evaluation.bench.store import RunStore
from reasoned_explorer.task.split import Split
from reasoned_explorer.task.splitting import Dealing, Share


def rows_of(folder: Path) -> list[str]:
    with RunStore.open(folder) as store:
        return [row.as_json() for row in store.rows()]


@pytest.fixture(scope="module")
def alone(tmp_path_factory: pytest.TempPathFactory, small_plan: BenchPlan) -> list[str]:
    """The rows of the small plan, run in this process."""
    folder = tmp_path_factory.mktemp("alone") / "run"
    with RunStore.create(folder, small_plan, {}) as store:
        run_bench(store, Workers())
    return rows_of(folder)


def test_several_processes_make_the_same_rows(tmp_path: Path, small_plan: BenchPlan, alone: list[str]) -> None:
    with RunStore.create(tmp_path / "run", small_plan, {}) as store:
        run_bench(store, Workers(2))
    assert rows_of(tmp_path / "run") == alone


def test_a_run_goes_on_where_it_stopped(tmp_path: Path, small_plan: BenchPlan, alone: list[str]) -> None:
    class EnoughError(Exception):
        pass

    def stop(progress: BenchProgress) -> None:
        if progress.here == 5:
            raise EnoughError

    seen: list[tuple[int, int]] = []
    with RunStore.create(tmp_path / "run", small_plan, {}) as store:
        with pytest.raises(EnoughError):
            run_bench(store, Workers(), stop)
        run_bench(store, Workers(), lambda progress: seen.append((progress.finished, progress.total)))
        run_bench(store, Workers())
    assert seen[0] == (5, 12)
    assert seen[-1] == (12, 12)
    assert rows_of(tmp_path / "run") == alone


def test_progress_knows_pace_and_what_is_left() -> None:
    progress = BenchProgress(total=10, finished=4, here=2, started_s=time.monotonic() - 1.0)
    assert progress.a_second == pytest.approx(2.0, rel=0.2)
    assert progress.left_s == pytest.approx(3.0, rel=0.2)
    assert BenchProgress(total=10, finished=0, started_s=time.monotonic()).left_s is None


def test_a_split_is_the_same_whoever_deals_it(small_split: Split) -> None:
    dealing = Dealing(3, time_limit_s=120.0)
    assert split_of("small", small_split.places, share=Share(), dealing=dealing, workers=2) == small_split


_KILLED = """
import sys
from pathlib import Path
from reasoned_explorer.evaluation.bench.runner import Workers, run_bench
from reasoned_explorer.evaluation.bench.store import RunStore

if __name__ == "__main__":
    with RunStore.open(Path(sys.argv[1])) as store:
        run_bench(store, Workers(2), lambda progress: print(progress.finished, flush=True))
"""


def test_a_run_that_is_killed_again_and_again_ends_in_the_same_rows(
    tmp_path: Path, small_plan: BenchPlan, alone: list[str]
) -> None:
    folder, script = tmp_path / "run", tmp_path / "run.py"
    script.write_text(_KILLED)
    RunStore.create(folder, small_plan, {}).close()
    for kill_after in (1, 3):
        process = subprocess.Popen([sys.executable, str(script), str(folder)], stdout=subprocess.PIPE, text=True)
        assert process.stdout is not None
        for _ in range(kill_after + 1):
            process.stdout.readline()
        os.kill(process.pid, signal.SIGKILL)
        process.wait()
        process.stdout.close()
    before = len(rows_of(folder))
    assert 0 < before < len(alone)
    with RunStore.open(folder) as store:
        run_bench(store, Workers())
    assert rows_of(folder) == alone


def test_processes_end_with_their_parent(tmp_path: Path, small_plan: BenchPlan) -> None:
    folder, script = tmp_path / "run", tmp_path / "run.py"
    script.write_text(_KILLED)
    RunStore.create(folder, replace(small_plan, seeds=tuple(range(50))), {}).close()
    process = subprocess.Popen([sys.executable, str(script), str(folder)], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    for _ in range(3):
        process.stdout.readline()
    children = [int(pid) for pid in Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()]
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    process.stdout.close()
    assert children
    until = time.monotonic() + 20.0
    while any(_lives(pid) for pid in children) and time.monotonic() < until:
        time.sleep(0.05)
    assert not any(_lives(pid) for pid in children)


_STOPPED = """
import sys
from pathlib import Path
from reasoned_explorer.evaluation.bench.runner import Workers, run_bench
from reasoned_explorer.evaluation.bench.store import RunStore
from reasoned_explorer.model.stopping import listening

if __name__ == "__main__":
    with listening(), RunStore.open(Path(sys.argv[1])) as store:
        try:
            run_bench(store, Workers(2), lambda progress: print(progress.finished, flush=True))
        except KeyboardInterrupt:
            print("stopped", flush=True)
"""


@pytest.mark.parametrize("finished", [0, 3])
@pytest.mark.parametrize("to_all", [True, False], ids=["a terminal", "kill"])
def test_ctrl_c_stops_a_run_and_its_processes_without_a_word(
    finished: int, to_all: bool, tmp_path: Path, small_plan: BenchPlan
) -> None:
    folder, script = tmp_path / "run", tmp_path / "run.py"
    script.write_text(_STOPPED)
    RunStore.create(folder, replace(small_plan, seeds=tuple(range(50))), {}).close()
    command = [sys.executable, str(script), str(folder)]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True
    ) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        for _ in range(finished + 1):
            process.stdout.readline()
        (os.killpg if to_all else os.kill)(process.pid, signal.SIGINT)
        # Not communicate(): it would miss lines that were read ahead.
        shown, errors = process.stdout.read(), process.stderr.read()
        process.wait(timeout=60)
    assert shown.splitlines()[-1] == "stopped"
    assert errors == ""
    assert process.returncode == 0
    assert len(rows_of(folder)) == len(shown.splitlines()) - 1 + finished


def _lives(pid: int) -> bool:
    try:
        return "State:\tZ" not in Path(f"/proc/{pid}/status").read_text()
    except (FileNotFoundError, ProcessLookupError):
        return False


def test_a_mission_that_kills_its_process_has_failed_and_the_others_go_on(
    small_plan: BenchPlan, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    # Nothing that a mission may do kills its process: the child is told by its environment to take its own life.
    tasks = list(small_plan.tasks())[:3]
    monkeypatch.setenv("REX_TEST_CRASH", tasks[0].mission_id)
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(tmp_path), *sys.path]))
    (tmp_path / "sitecustomize.py").write_text(
        "import os, signal, sys\n"
        "if 'REX_TEST_CRASH' in os.environ and '--multiprocessing-fork' in sys.argv:\n"
        "    import reasoned_explorer.evaluation.bench.worker as worker\n"
        "    whole = worker.run_task\n"
        "    def run_task(plan, task, access):\n"
        "        if task.mission_id == os.environ['REX_TEST_CRASH']:\n"
        "            os.kill(os.getpid(), signal.SIGKILL)\n"
        "        return whole(plan, task, access)\n"
        "    worker.run_task = run_task\n"
    )
    done = {each.task.mission_id: each for each in run_in_processes(small_plan, tasks, workers=1)}
    assert len(done) == 3
    assert done[tasks[0].mission_id].failed
    assert f"its process died {MAX_TRIES} times" in done[tasks[0].mission_id].row
    assert [done[task.mission_id].failed for task in tasks[1:]] == [False, False]


def test_a_worker_keeps_its_place_and_takes_from_others_at_the_end(small_plan: BenchPlan) -> None:
    tasks = list(small_plan.tasks())
    queues = Queues(small_plan, tasks, 2)
    taken: dict[int, list[Task]] = {0: [], 1: []}
    for _ in range(5):
        for worker, mine in taken.items():
            task = queues.take(worker)
            assert task is not None
            mine.append(task)
    places = {worker: {small_plan.episode_of(task).place for task in mine} for worker, mine in taken.items()}
    assert places[0].isdisjoint(places[1])
    # Worker 1 is done with everything of its own; what worker 0 has left is shared.
    rest = [task for _ in range(3) if (task := queues.take(1)) is not None]
    assert len(rest) == 2
    everything = [*taken[0], *taken[1], *rest, *queues.left()]
    assert sorted(task.key for task in everything) == sorted(task.key for task in tasks)
    assert queues.take(0) is None
