import csv
import json
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from reasoned_explorer.evaluation.bench.export import export
from reasoned_explorer.evaluation.bench.plan import BenchPlan
from reasoned_explorer.evaluation.bench.runner import Workers, run_bench
from reasoned_explorer.evaluation.bench.store import RunStore
from reasoned_explorer.model import InputError, MissingDependencyError


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory, small_plan: BenchPlan) -> RunStore:
    store = RunStore.create(tmp_path_factory.mktemp("export") / "run", small_plan, {})
    run_bench(store, Workers())
    return store


def test_csv_holds_every_mission(store: RunStore, tmp_path: Path) -> None:
    assert export(store, tmp_path / "results.csv") == 12
    with (tmp_path / "results.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    for line, row in zip(rows, store.rows(), strict=True):
        assert (line["method"], line["mission_id"], line["goal"]) == (row.method, row.mission_id, row.goal)
        assert float(line["spl"]) == row.score.spl
        assert float(line["computing_s"]) == row.score.computing_s
    assert "wall_s" not in rows[0]


def test_lost_calls_are_exported_and_not_known_of_rows_of_older_versions(
    tmp_path: Path, store: RunStore, small_plan: BenchPlan
) -> None:
    tasks, rows = list(small_plan.tasks()), list(store.rows())
    old = json.loads(rows[0].as_json())
    del old["lost_calls"]
    with RunStore.create(tmp_path / "run", small_plan, {}) as mixed:
        mixed.add(tasks[0], json.dumps(old), trace=None, wall_s=0.0)
        mixed.add(tasks[1], replace(rows[1], lost_calls=7).as_json(), trace=None, wall_s=0.0)
        assert [row.lost_calls for row in mixed.rows()] == [None, 7]
        assert export(mixed, tmp_path / "results.csv") == 2
    with (tmp_path / "results.csv").open(newline="", encoding="utf-8") as file:
        head, *lines = csv.reader(file)
    column = head.index("lost_calls")
    assert head[column - 1] == "unpriced"
    assert [line[column] for line in lines] == ["", "7"]


def test_parquet_holds_the_same(store: RunStore, tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    assert export(store, tmp_path / "results.parquet") == 12
    table = parquet.read_table(tmp_path / "results.parquet")
    assert table.column("spl").to_pylist() == [row.score.spl for row in store.rows()]
    assert table.column("goal").to_pylist() == [row.goal for row in store.rows()]


def test_what_cannot_be_written_leaves_nothing(
    store: RunStore, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(InputError, match=r"\.csv or \.parquet"):
        export(store, tmp_path / "results.xls")
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="choose another place"):
        export(store, tmp_path / "file" / "results.csv")
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(MissingDependencyError, match=r"reasoned-explorer\[parquet\]"):
        export(store, tmp_path / "results.parquet")
    assert [path.name for path in tmp_path.iterdir()] == ["file"]
