import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from reasoned_explorer.evaluation.bench.plan import BenchPlan
from reasoned_explorer.evaluation.bench.runner import Workers, run_bench
from reasoned_explorer.evaluation.bench.store import STORE_NAME, RunStore
from reasoned_explorer.evaluation.bench.worker import run_task
from reasoned_explorer.model import InputError, PartError, RecordError
from reasoned_explorer.model.record import MissionEnd


@pytest.fixture
def store(tmp_path: Path, small_plan: BenchPlan) -> RunStore:
    return RunStore.create(tmp_path / "run", small_plan, {"command": "rex bench"})


def test_a_new_run_knows_what_it_runs(store: RunStore, small_plan: BenchPlan) -> None:
    assert store.plan == small_plan
    assert store.about == {"command": "rex bench"}
    assert store.finished() == set()


def test_a_finished_mission_is_kept_whole(store: RunStore, small_plan: BenchPlan) -> None:
    task = next(small_plan.tasks())
    done = run_task(small_plan, task)
    store.add(task, done.row, trace=done.trace, wall_s=done.wall_s)
    with RunStore.open(store.folder) as again:
        (row,) = again.rows()
        assert again.finished() == {task.key}
        assert row.as_json() == done.row
        record = again.record(row)
    assert record is not None
    assert record.summary is not None
    assert record.summary.steps == row.steps
    assert record.header.goal == row.goal


def test_a_mission_that_comes_twice_counts_once(store: RunStore, small_plan: BenchPlan) -> None:
    task = next(small_plan.tasks())
    done = run_task(small_plan, task)
    for _ in range(2):
        store.add(task, done.row, trace=None, wall_s=1.0)
    assert len(list(store.rows())) == 1
    assert store.wall_s() == 1.0


def test_rows_come_in_one_order_whatever_order_they_were_written_in(tmp_path: Path, small_plan: BenchPlan) -> None:
    done = [run_task(small_plan, task) for task in list(small_plan.tasks())[:4]]
    made = []
    for name, order in (("a", done), ("b", done[::-1])):
        with RunStore.create(tmp_path / name, small_plan, {}) as one:
            for each in order:
                one.add(each.task, each.row, trace=None, wall_s=0.0)
            made.append([row.as_json() for row in one.rows()])
    assert made[0] == made[1]


def test_figures_can_be_asked_for_with_sql(store: RunStore) -> None:
    run_bench(store, Workers())
    with sqlite3.connect(store.folder / STORE_NAME) as connection:
        found = connection.execute(
            "SELECT method, count(*), sum(success), avg(computing_s) FROM results GROUP BY method ORDER BY method"
        ).fetchall()
    assert [(name, count) for name, count, _, _ in found] == [("llm-as-eval", 6), ("nearest-frontier", 6)]
    assert all(seconds > 0.0 for *_, seconds in found)


def test_a_run_is_not_written_over(store: RunStore, small_plan: BenchPlan) -> None:
    with pytest.raises(RecordError, match="--resume"):
        RunStore.create(store.folder, small_plan, {})


def test_what_holds_no_run_is_refused(tmp_path: Path) -> None:
    with pytest.raises(RecordError, match=r"holds no run\.sqlite"):
        RunStore.open(tmp_path)
    (tmp_path / STORE_NAME).write_bytes(b"no database at all, but long enough to be looked at" * 20)
    with pytest.raises(RecordError, match="cannot be read"):
        RunStore.open(tmp_path)


def test_a_store_of_another_version_is_refused(store: RunStore) -> None:
    with sqlite3.connect(store.folder / STORE_NAME) as connection:
        connection.execute("UPDATE run SET value = '99' WHERE name = 'store_version'")
    with pytest.raises(RecordError, match="of version 99"):
        RunStore.open(store.folder)


def test_a_folder_that_cannot_be_written_leaves_nothing(tmp_path: Path, small_plan: BenchPlan) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(RecordError, match="cannot be written"):
        RunStore.create(tmp_path / "file" / "run", small_plan, {})


def test_names_become_safe_names_of_files(store: RunStore) -> None:
    path = store.trace_path("drone", "llm-rrt:depth=1@a/b", "../../etc/passwd")
    assert path.parent.parent.parent == store.folder / "traces"
    assert ".." not in str(path.relative_to(store.folder))


def test_a_part_that_fails_is_a_row_and_no_exception(
    store: RunStore, small_plan: BenchPlan, monkeypatch: pytest.MonkeyPatch
) -> None:
    def failing(*_: object, **__: object) -> None:
        raise PartError("captioner", "it answers nothing")

    monkeypatch.setattr("reasoned_explorer.evaluation.bench.worker.Mission", failing)
    task = next(small_plan.tasks())
    done = run_task(small_plan, task)
    assert done.failed
    assert f'"end": "{MissionEnd.FAULT.value}"' in done.row
    assert "it answers nothing" in done.row
    store.add(task, done.row, trace=None, wall_s=0.0)
    assert store.failed() == 1


def test_more_planners_can_be_run_on_the_missions_of_a_run(store: RunStore) -> None:
    run_bench(store, Workers())
    before = [row.as_json() for row in store.rows()]
    store.extend(["nearest-frontier", "random"])
    assert store.plan.methods == ("nearest-frontier", "llm-as-eval", "random")
    run_bench(store, Workers())
    after = list(store.rows())
    assert [row.as_json() for row in after if row.method != "random"] == before
    assert sum(row.method == "random" for row in after) == 6
    with pytest.raises(InputError, match="did you mean random"):
        store.extend(["randon"])
    assert store.plan.methods[-1] == "random"


def test_a_run_is_read_beside_who_writes_it_and_leaves_nothing(store: RunStore, small_plan: BenchPlan) -> None:
    tasks = list(small_plan.tasks())
    for task in tasks[:2]:
        store.add(task, run_task(small_plan, task).row, trace=None, wall_s=0.0)
    with RunStore.read(store.folder) as again:
        assert again.finished() == {task.key for task in tasks[:2]}, "what is in the log is read, too"
    store.close()
    assert [path.name for path in store.folder.iterdir()] == [STORE_NAME]
    before = (store.folder / STORE_NAME).read_bytes()
    with RunStore.read(store.folder) as again:
        assert len(list(again.rows())) == 2
        assert [path.name for path in store.folder.iterdir()] == [STORE_NAME]
    assert (store.folder / STORE_NAME).read_bytes() == before


def test_a_run_left_in_wal_mode_is_read_without_a_trace(store: RunStore) -> None:
    store.close()
    with closing(sqlite3.connect(store.folder / STORE_NAME)) as connection:
        connection.execute("PRAGMA journal_mode = WAL")
    with RunStore.read(store.folder) as again:
        assert again.finished() == set()
    assert [path.name for path in store.folder.iterdir()] == [STORE_NAME]
