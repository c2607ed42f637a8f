"""`rex bench`, `rex compare`, `rex export`, `rex report` and `rex ablate`, as a person types them."""

import csv
import shutil
import sqlite3
import subprocess
import sys
import time
from pathlib import Path

import pytest
from typer.testing import CliRunner

from reasoned_explorer.cli.app import app
from reasoned_explorer.evaluation.bench.store import RunStore
from reasoned_explorer.task.split import SPLIT_VERSION
from tests.cli.full_disk import rex_with_files_up_to

TINY = ["--world", "park:5@300", "--per-cell", "1", "--levels", "1", "--t-max", "2", "--workers", "1"]
TWO = ["--planners", "nearest-frontier,llm-as-eval"]
ONE = ["--planners", "nearest-frontier"]


def _rex(*arguments: str) -> tuple[int, str]:
    # Wide enough that no line of a table is broken.
    result = CliRunner().invoke(app, list(arguments), env={"COLUMNS": "400"})
    return result.exit_code, result.output + (result.stderr if result.stderr_bytes else "")


@pytest.fixture(autouse=True)
def _in_an_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")


def _made(folder: Path, *arguments: str) -> tuple[Path, str]:
    code, shown = _rex("bench", *arguments, "--out", str(folder), "-q")
    assert code == 0, shown
    return folder, shown


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, str]:
    """A run of three missions for each of two planners, and what was printed."""
    return _made(tmp_path_factory.mktemp("bench") / "run", *TINY, *TWO)


@pytest.fixture(scope="module")
def elsewhere(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run in another place, without records."""
    tiny = ["--world", "plaza:5@200", *TINY[2:]]
    return _made(tmp_path_factory.mktemp("bench") / "elsewhere", *tiny, *ONE, "--no-traces")[0]


def _contents(folder: Path) -> dict[str, bytes]:
    # The file beside a store that SQLite makes and takes away is none of a run's.
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and not path.name.endswith(("-wal", "-shm"))
    }


def _half(run: Path, target: Path) -> Path:
    """Return a copy of a run that was stopped after four of its six missions."""
    shutil.copytree(run, target)
    with sqlite3.connect(target / "run.sqlite") as connection:
        connection.execute("DELETE FROM missions WHERE method = 'llm-as-eval' AND mission_id NOT LIKE '%/near/%'")
    connection.close()
    return target


def test_a_bench_prints_one_table_and_what_it_is(run: tuple[Path, str]) -> None:
    folder, shown = run
    lines = [line for line in shown.splitlines() if line.startswith("| all | ")]
    assert lines[0].startswith("| all | nearest-frontier [no model], CT modelled (gpt-2023) | 3 |")
    assert lines[1].startswith("| all | llm-as-eval [embedded minds, no language model")
    for table in ("Other metrics", "Paired differences to nearest-frontier", "The paper's Table I"):
        assert f"**{table}" in shown
    ours = shown[: shown.index("**The paper's Table I")]
    assert ours.count("do not agree with GPT-4’s scores") == ours.count("\n**") + ours.startswith("**")
    assert "not this run’s" in shown
    assert f"rex report {folder}" in shown


def test_what_a_split_poses_is_said_before_it_is_run() -> None:
    code, shown = _rex("bench", *TINY, *ONE, "--out", "run")
    assert code == 0, shown
    for said in ("3 episodes", "shortest compliant way", "blind declaration", "CASR ceiling of the oracle, drone"):
        assert said in shown


def test_a_run_that_was_stopped_goes_on_to_the_same_table(run: tuple[Path, str], tmp_path: Path) -> None:
    half = _half(run[0], tmp_path / "half")
    code, shown = _rex("bench", "--resume", str(half), "-q", "--workers", "1")
    assert code == 0, shown
    assert shown.replace(str(half), str(run[0])) == run[1]
    with RunStore.open(half) as ours, RunStore.open(run[0]) as theirs:
        assert [row.as_json() for row in ours.rows()] == [row.as_json() for row in theirs.rows()]


def test_planners_are_added_to_a_run(run: tuple[Path, str], tmp_path: Path) -> None:
    longer = shutil.copytree(run[0], tmp_path / "longer")
    code, shown = _rex("bench", "--resume", str(longer), "--add", "random", "-q", "--workers", "1")
    assert code == 0, shown
    lines = [line for line in shown.splitlines() if line.startswith("| all | ")]
    assert lines[:2] == [line for line in run[1].splitlines() if line.startswith("| all | ")][:2]
    assert lines[2].startswith("| all | random [no model]")


def test_a_run_does_not_differ_from_itself(run: tuple[Path, str]) -> None:
    code, shown = _rex("compare", str(run[0]), str(run[0]))
    assert code == 0, shown
    lines = [line for line in shown.splitlines() if line.startswith(("| nearest-frontier |", "| llm-as-eval |"))]
    assert len(lines) == 2
    for line in lines:
        assert line.count(".00 [.00, .00]") == 5
        assert line.endswith("| 1.000 | 1.000 |")


def test_two_planners_of_a_run_are_compared_on_the_same_missions(run: tuple[Path, str]) -> None:
    one, other = (f"{run[0]}::{name}" for name in ("llm-as-eval", "nearest-frontier"))
    code, shown = _rex("compare", one, other)
    assert code == 0, shown
    assert "| llm-as-eval − nearest-frontier | 3 |" in shown


def test_a_run_is_exported(run: tuple[Path, str]) -> None:
    code, shown = _rex("export", str(run[0]), "results.csv")
    assert code == 0, shown
    with Path("results.csv").open(newline="", encoding="utf-8") as file:
        assert len(list(csv.DictReader(file))) == 6


def test_a_report_is_made_of_a_run_and_made_again(run: tuple[Path, str], tmp_path: Path) -> None:
    code, shown = _rex("report", str(run[0]))
    assert code == 0, shown
    folder = run[0] / "report"
    page = (folder / "index.html").read_text(encoding="utf-8")
    for said in ("2 planners on split own/L1", "agree with GPT-4’s", "CASR of who knows the way", "f-trajectories"):
        assert said in page
    assert "Not finished" not in page
    before = _contents(folder)
    assert {"missions.csv", "tables/main.csv", "figures/sr-osr.png", "figures/trajectories-level-1.png"} <= set(before)
    assert _rex("report", str(run[0]), "--out", str(tmp_path / "again"))[0] == 0
    assert _contents(tmp_path / "again") == before
    assert _rex("report", str(run[0]))[0] == 0, "an old report is replaced"
    shutil.rmtree(folder)


def test_a_report_of_a_run_that_is_not_finished_says_so(run: tuple[Path, str], tmp_path: Path) -> None:
    half = _half(run[0], tmp_path / "half")
    assert _rex("report", str(half))[0] == 0
    page = (half / "report" / "index.html").read_text(encoding="utf-8")
    assert page.count("Not finished: 4 of 6 missions.") > 3, "at the top and under every table"


def test_a_report_without_records_says_so(elsewhere: Path) -> None:
    assert _rex("report", str(elsewhere), "--out", "report")[0] == 0
    assert "It takes two methods" in Path("report/index.html").read_text(encoding="utf-8")
    assert not (elsewhere / "traces").exists()


def test_a_report_does_without_a_world_that_is_gone() -> None:
    assert _rex("worlds", "generate", "plaza:5@200", "--out", "plaza.rexworld")[0] == 0
    folder = _made(Path("run"), "--world", "plaza.rexworld", *TINY[2:], *TWO)[0]
    # Another world under the old name is as good as none.
    assert _rex("worlds", "generate", "park:1@200", "--out", "plaza.rexworld")[0] == 0
    assert _rex("report", str(folder))[0] == 0
    assert "No mission has the records of both methods and its world." in Path("run/report/index.html").read_text()
    Path("plaza.rexworld").unlink()
    assert _rex("report", str(folder))[0] == 0
    assert "No mission has the records of both methods and its world." in Path("run/report/index.html").read_text()


def test_vehicles_have_tables_of_their_own_and_one_in_the_papers_form() -> None:
    folder, shown = _made(Path("run"), *TINY, *ONE, "--vehicle", "drone-authors,go1-authors")
    assert shown.count(f"own/L1 v{SPLIT_VERSION} [") == 2
    assert "SR drone-authors | OSR drone-authors | CASR drone-authors | SR go1-authors" in shown
    assert "The paper's Table II" in shown
    assert _rex("report", str(folder))[0] == 0
    assert "nearest-frontier · go1-authors" in Path("run/report/index.html").read_text(encoding="utf-8")


def test_the_ablation_of_depth_has_the_form_of_table_three() -> None:
    tiny = ["--world", "plaza:5@200", "--per-cell", "1", "--workers", "1", "--no-traces", "-q"]
    code, shown = _rex("ablate", "depth", "--depths", "0,2", *tiny, "--out", "run")
    assert code == 0, shown
    assert "T_max 15 min, captions without error" in shown
    assert [line.split(" | ")[0] for line in shown.splitlines() if line.startswith("| L =")] == ["| L = 0", "| L = 2"]
    assert ".732 (.05)" in shown
    assert "GPT-4’s scores" in shown
    assert "without error" in shown
    assert "assumed" not in shown[: shown.index("σ is")] + shown[shown.index("GPT-4’s scores") :]
    assert _rex("bench", "--resume", "run", "--add", "random", "-q", "--workers", "1")[0] == 0
    code, again = _rex("ablate", "depth", "--resume", "run", "-q")
    assert (code, again) == (0, shown), "a planner that was added is none of this table's"
    code, shown = _rex("ablate", "minds", "--resume", "run", "-q")
    assert code == 2
    assert "this ablation" in shown


def test_a_bench_under_other_conditions_is_no_ablation() -> None:
    _made(Path("run"), *TINY, "--planners", "llm-rrt:depth=1", "--no-traces")
    code, shown = _rex("ablate", "depth", "--resume", "run")
    assert code == 2, shown
    assert "captioner noisy" in shown


@pytest.mark.skipif(sys.platform == "win32", reason="signals are POSIX's here")
def test_who_ends_a_bench_is_told_how_to_go_on() -> None:
    bench = [sys.executable, "-m", "reasoned_explorer", "bench", *TINY[:2], "--per-cell", "20", "--workers", "1"]
    with subprocess.Popen([*bench, *TWO, "--out", "run", "-q"], stderr=subprocess.PIPE, text=True) as process:
        while not list(Path().glob("run/traces/**/*.z")):
            assert process.poll() is None
            time.sleep(0.05)
        process.terminate()
        said = process.communicate()[1]
    assert process.returncode == 130, said
    assert "go on with --resume run" in said


def test_who_has_read_enough_does_not_end_a_bench() -> None:
    bench = [sys.executable, "-m", "reasoned_explorer", "bench", *TINY, *ONE, "--out", "run"]
    with subprocess.Popen(bench, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:
        if process.stdout is None or process.stderr is None:
            raise AssertionError
        process.stdout.close()
        said = process.stderr.read()
    assert process.returncode == 0, said
    assert b"Broken" not in said
    with RunStore.read(Path("run")) as store:
        assert len(store.finished()) == 3


def test_the_ablation_of_minds_has_the_form_of_table_four() -> None:
    tiny = ["--world", "plaza:5@200", "--per-cell", "1", "--workers", "1", "--no-traces", "-q"]
    minds = ["--visionaries", "embedded", "--evaluators", "embedded,embedded-unknowing"]
    code, shown = _rex("ablate", "minds", *minds, *tiny, "--out", "run")
    assert code == 0, shown
    assert "| embedded | embedded-unknowing | " in shown
    assert "– (left out)" in shown


def test_everything_that_is_wrong_is_said_at_once(tmp_path: Path) -> None:
    wrong = {
        "--planners": "llm-rtt", "--split": "mni", "--levels": "1,7", "--seeds": "0,-1", "--per-cell": "0",
        "--workers": "0", "--radius": "nan", "--t-max": "nan", "--vehicle": "dron", "--captioner": "nosy",
        "--minds": "embeded", "--latency": "gpt-2024", "--clock": "virtul",
    }  # fmt: skip
    code, shown = _rex("bench", *(part for pair in wrong.items() for part in pair))
    assert code == 2, shown
    for said in (
        "did you mean llm-rrt", "did you mean mini", "'7'", "'-1'", "--per-cell: 0", "--workers: 0",
        "radius_m is nan", "t_max is nan", "did you mean drone", "did you mean noisy", "did you mean embedded",
        "did you mean gpt-2023", "did you mean virtual",
    ):  # fmt: skip
        assert said in shown, said
    assert list((tmp_path / "here").iterdir()) == []


def test_everything_that_is_wrong_is_said_at_once_however_it_is_wrong() -> None:
    bad = ["--world", "nope", "--bbox", "1,2", "--split-seed", "-1", "--vehicle", "zz", "--workers", "0", "--ray", "x"]
    always = ("--split-seed: -1", "bounding box", "'zz'", "--workers: 0", "'x'", "'nope'")
    code, shown = _rex("bench", "--levels", "7", "--planners", "llm-rrt:depth=x,random,zy,llm-rrt:depth", *bad)
    assert code == 2, shown
    for said in (*always, "depth is 'x'", "'zy'", "llm-rrt:depth: 'depth'", "level '7'"):
        assert said in shown, said
    code, shown = _rex("ablate", "depth", "--depths", "1,99,-2", "--minds", "nope", *bad)
    assert code == 2, shown
    for said in (*always, "'-2'", "1, 99", "mind: 'nope'"):
        assert said in shown, said
    code, shown = _rex("ablate", "minds", "--visionaries", "", "--evaluators", "nobody", *bad)
    assert code == 2, shown
    for said in (*always, "no visionary or no evaluator", "'nobody'"):
        assert said in shown, said


#: RUN is a run, ELSEWHERE one without a mission in common, FULL a folder with something else in it.
BAD = {
    "an unknown planner": (["bench", "--planners", "llm-rtt"], "did you mean llm-rrt"),
    "no planner": (["bench", "--planners", ","], "no planner"),
    "a setting of a planner out of range": (["bench", "--planners", "llm-rrt:depth=-1"], "depth"),
    "an unknown split": (["bench", "--split", "huge"], "one of full, mini"),
    "an unknown world": (["bench", "--world", "prak:7"], "park"),
    "two unknown worlds": (["bench", "--world", "prak:7", "--world", "plazza"], "plaza"),
    "a world twice": (["bench", "--world", "park:7", "--world", "park:7"], "each world once"),
    "a bounding box for no file": (["bench", "--bbox", "1,2,3,4"], "without --world"),
    "a bounding box of two": (["bench", "--world", "park:7", "--bbox", "1,2"], "lon0,lat0"),
    "a level that there is not": (["bench", "--levels", "5"], "1, 2, 3 or 4"),
    "a seed that is none": (["bench", "--seeds", "1,x"], "whole numbers"),
    "a seed twice": (["bench", "--seeds", "1,1"], "each once"),
    "no episode a cell": (["bench", "--per-cell", "0"], "1 to 1,000"),
    "no workers": (["bench", "--workers", "0"], "1 to 1,024"),
    "a radius of nothing": (["bench", "--radius", "0"], "radius_m is 0"),
    "a radius of NaN": (["bench", "--radius", "nan"], "radius_m is nan"),
    "no time": (["bench", "--t-max", "0"], "t_max"),
    "a time of NaN": (["bench", "--t-max", "nan"], "t_max"),
    "a negative seed of the split": (["bench", "--split-seed", "-1"], "split-seed"),
    "a folder with a run": ([*("bench", *TINY, *ONE), "--out", "RUN"], "new or empty folder"),
    "a folder that is in use": ([*("bench", *TINY, *ONE), "--out", "FULL"], "new or empty folder"),
    "a file for a folder": ([*("bench", *TINY, *ONE), "--out", "FULL/notes.txt"], "new or empty folder"),
    "no run to go on with": (["bench", "--resume", "nothing"], "holds no run.sqlite"),
    "a folder without a run to go on with": (["bench", "--resume", "FULL"], "holds no run.sqlite"),
    "other settings beside a run": (["bench", "--resume", "RUN", "--planners", "random"], "knows its own"),
    "planners to add to no run": (["bench", "--add", "random"], "without --resume"),
    "unknown planners to add": (["bench", "--resume", "RUN", "--add", "randm"], "did you mean random"),
    "no workers to go on with": (["bench", "--resume", "RUN", "--workers", "-2"], "1 to 1,024"),
    "runs without a common mission": (["compare", "RUN", "ELSEWHERE"], "no mission in common"),
    "a planner that a run has not": (["compare", "RUN::random", "RUN::llm-as-eval"], "has no missions of 'random'"),
    "a run to compare that is not there": (["compare", "RUN", "nothing"], "holds no run.sqlite"),
    "a format that is unknown": (["export", "RUN", "results.xls"], ".csv or .parquet"),
    "no name to export to": (["export", "RUN", "."], ".; expected a name that ends in .csv"),
    "no folder to export to": (["export", "RUN", "nowhere/results.csv"], "a folder that exists"),
    "a name that is too long": ([*("bench", *TINY, *ONE), "--out", "n" * 300], "a name that is not too long"),
    "a split beside worlds": (["bench", *TINY, *ONE, "--split", "full"], "worlds make a split of their own"),
    "a checker that is to imagine": (["bench", "--minds", "perfect-halt"], "perfect-halt as visionary"),
    "a checker to ablate": (["ablate", "minds", "--visionaries", "perfect-halt"], "perfect-halt as visionary"),
    "no address of a cluster": (["bench", "--ray", "x"], "ray://"),
    "an address where nobody is": ([*("bench", *TINY, *ONE), "--ray", "127.0.0.1:1"], "cannot be reached"),
    "no run to export": (["export", "nothing", "results.csv"], "holds no run.sqlite"),
    "no run to report": (["report", "nothing"], "holds no run.sqlite"),
    "a folder without a run to report": (["report", "FULL"], "holds no run.sqlite"),
    "a report into a folder in use": (["report", "RUN", "--out", "FULL"], "is no report"),
    "a report below a file": (["report", "RUN", "--out", "FULL/notes.txt/report"], "cannot be made"),
    "a depth that is none": (["ablate", "depth", "--depths", "0,two"], "whole numbers"),
    "a depth out of range": (["ablate", "depth", "--depths", "17"], "0 to 16"),
    "no minds": (["ablate", "minds", "--evaluators", ""], "at least one of each"),
    "unknown minds": (["ablate", "minds", "--visionaries", "embeded"], "did you mean embedded"),
    "no episode a cell of an ablation": (["ablate", "depth", "--per-cell", "0"], "1 to 1,000"),
    "a run that is no ablation": (["ablate", "depth", "--resume", "RUN"], "this ablation"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_input_is_answered_in_words_with_code_two_and_leaves_nothing(
    case: str, run: tuple[Path, str], elsewhere: Path, tmp_path: Path
) -> None:
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "notes.txt").write_text("mine")
    arguments, said = BAD[case]
    places = {"RUN": str(run[0]), "ELSEWHERE": str(elsewhere), "FULL": str(tmp_path / "full")}
    for name, place in places.items():
        arguments = [part.replace(name, place) for part in arguments]
    before = _contents(run[0])
    code, shown = _rex(*arguments)
    assert code == 2, shown
    assert said in shown
    assert "Traceback" not in shown
    assert list((tmp_path / "here").iterdir()) == []
    assert _contents(tmp_path / "full") == {"notes.txt": b"mine"}
    assert _contents(run[0]) == before


def test_somebodys_web_site_is_not_replaced_by_a_report(run: tuple[Path, str], tmp_path: Path) -> None:
    site = tmp_path / "site"
    site.mkdir()
    (site / "index.html").write_text("<title>mine</title>")
    code, shown = _rex("report", str(run[0]), "--out", str(site))
    assert code == 2
    assert "is no report" in shown
    assert (site / "index.html").read_text() == "<title>mine</title>"


@pytest.mark.parametrize("most_bytes", [0, 1024])
def test_a_run_that_finds_its_disk_full_leaves_nothing(most_bytes: int, tmp_path: Path) -> None:
    ended = rex_with_files_up_to(most_bytes, "bench", *TINY, *ONE, "--out", "runs/run", "-q")
    assert ended.returncode == 3, ended.stdout + ended.stderr
    assert "ulimit -f" in ended.stderr
    assert list((tmp_path / "here").iterdir()) == []


def test_a_disk_that_gets_full_says_how_to_go_on(tmp_path: Path) -> None:
    ended = rex_with_files_up_to(60_000, "bench", *TINY, *TWO, "--out", "run", "-q")
    assert ended.returncode == 3, ended.stdout + ended.stderr
    assert "go on with --resume run" in ended.stderr
    assert "ulimit -f" in ended.stderr
    assert _rex("bench", "--resume", "run", "-q", "--workers", "1")[0] == 0


def test_a_run_is_read_where_nothing_can_be_written(run: tuple[Path, str], tmp_path: Path) -> None:
    before = sorted(path.name for path in run[0].iterdir())
    ended = rex_with_files_up_to(0, "compare", str(run[0]), str(run[0]))
    # Its output is a pipe, which is never full.
    assert ended.returncode == 0, ended.stderr
    ended = rex_with_files_up_to(1024, "export", str(run[0]), str(tmp_path / "results.csv"))
    assert ended.returncode == 3, ended.stderr
    assert "results.csv cannot be written" in ended.stderr
    ended = rex_with_files_up_to(1024, "bench", "--resume", str(run[0]))
    assert ended.returncode == 3, ended.stderr
    assert "ulimit -f" in ended.stderr
    assert sorted(path.name for path in run[0].iterdir()) == before
