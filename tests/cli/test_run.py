"""`rex run` and `rex show`, as a person types them."""

import importlib
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from typer.testing import CliRunner

from reasoned_explorer.cli.app import app
from reasoned_explorer.evaluation.record_file import read_record
from tests.cli.full_disk import rex_with_files_up_to

FAST = ["--world", "plaza:3@200", "--seed", "6", "--no-map"]


def _rex(*arguments: str) -> tuple[int, str]:
    result = CliRunner().invoke(app, list(arguments))
    return result.exit_code, result.output + (result.stderr if result.stderr_bytes else "")


@pytest.fixture(autouse=True)
def _in_an_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def test_a_mission_shows_its_steps_and_its_summary_and_keeps_its_record(tmp_path: Path) -> None:
    code, shown = _rex("run", "Find me a bench", *FAST[:-1], "--minds", "oracle", "--out", "run")
    assert code == 0, shown
    assert "Q " in shown
    assert "σ(d)" in shown
    assert "Found Goal" in shown
    for name in ("SR 1", "OSR 1", "SPL", "CASR", "CT", "TT"):
        assert name in shown
    assert {path.name for path in (tmp_path / "run").iterdir()} == {"record.jsonl", "map.png", "world.rexworld"}


def test_a_mission_is_shown_again_from_its_record_alone(tmp_path: Path) -> None:
    _, shown = _rex("run", "Find me a bench", *FAST, "--out", "run")
    (tmp_path / "run" / "world.rexworld").unlink()
    code, again = _rex("show", "run")
    assert code == 0
    assert again.strip().splitlines() == [line for line in shown.strip().splitlines() if not line.startswith("kept in")]


def test_one_step_is_shown_with_its_imagined_tree() -> None:
    _rex("run", "Find me a bench", *FAST, "--out", "run")
    code, shown = _rex("show", "run", "--step", "0")
    assert code == 0
    assert "view (0, 0, 0)" in shown
    assert shown.count("[") >= 6
    assert _rex("show", "run", "--step", "9999")[0] == 2


def test_the_same_seed_writes_the_same_bytes_in_another_process() -> None:
    command = [sys.executable, "-m", "reasoned_explorer", "run", "Find me a bench", *FAST, "-q"]
    for folder, hash_seed in (("a", "1"), ("b", "2")):
        environment = {**os.environ, "PYTHONHASHSEED": hash_seed}
        subprocess.run([*command, "--out", folder], env=environment, check=False, capture_output=True)
    assert Path("a/record.jsonl").read_bytes() == Path("b/record.jsonl").read_bytes()
    assert Path("a/world.rexworld").read_bytes() == Path("b/world.rexworld").read_bytes()


BAD = {
    "an empty goal": ["run", ""],
    "a goal of blanks": ["run", "   "],
    "a goal that asks for nothing": ["run", "hello there"],
    "a goal that nothing here satisfies": ["run", "Find me a museum", "--world", "meadowless"],
    "an unknown district": ["run", "Find me a bench", "--world", "prak:7"],
    "an unknown planner": ["run", "Find me a bench", "--planner", "llm-rtt"],
    "unknown minds": ["run", "Find me a bench", "--minds", "embeded"],
    "an unknown evaluator": ["run", "Find me a bench", "--evaluator", "gpt"],
    "an unknown captioner": ["run", "Find me a bench", "--captioner", "nosy"],
    "an unknown vehicle": ["run", "Find me a bench", "--vehicle", "dron"],
    "an unknown latency": ["run", "Find me a bench", "--latency", "gpt-2024"],
    "an unknown clock": ["run", "Find me a bench", "--clock", "virtul"],
    "an unknown setting": ["run", "Find me a bench", "--set", "dept=2"],
    "a setting out of range": ["run", "Find me a bench", "--set", "depth=-1"],
    "a setting of the wrong kind": ["run", "Find me a bench", "--set", "depth=two"],
    "a setting without a value": ["run", "Find me a bench", "--set", "depth"],
    "no views": ["run", "Find me a bench", "--views", "0"],
    "a sweep of NaN": ["run", "Find me a bench", "--sweep", "nan"],
    "no time": ["run", "Find me a bench", "--t-max", "0"],
    "a time of NaN": ["run", "Find me a bench", "--t-max", "nan"],
    "a radius of NaN": ["run", "Find me a bench", "--radius", "nan"],
    "a negative seed": ["run", "Find me a bench", "--seed", "-1"],
    "a start off the map": ["run", "Find me a bench", "--start", "9999,0,0"],
    "a start of NaN": ["run", "Find me a bench", "--start", "nan,0,0"],
    "a start that is no place": ["run", "Find me a bench", "--start", "here"],
    "a world too large": ["run", "Find me a bench", "--world", "park:7@5000"],
    "a file that is not there": ["run", "Find me a bench", "--world", "nowhere.osm.pbf"],
    "a bounding box for a generated world": ["run", "Find me a bench", "--bbox", "1,2,3,4"],
    "a record that is not there": ["show", "nothing"],
    "a world to inspect that is not there": ["worlds", "inspect", "nowhere.osm"],
    "a picture of an unknown kind": ["worlds", "draw", "park:7@150", "park.bmp"],
    "a district to generate that is unknown": ["worlds", "generate", "village"],
}


@pytest.mark.parametrize("case", BAD)
def test_bad_input_is_answered_in_words_with_code_two_and_leaves_nothing(case: str, tmp_path: Path) -> None:
    code, shown = _rex(*BAD[case])
    assert code == 2, shown
    assert shown.strip()
    assert "Traceback" not in shown
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    "content", [b"", b"not a map", b"<osm version='0.6'><node id='1'", b"\x00\x00\x00\x0d\x0a\x09OSMHeader"]
)
@pytest.mark.parametrize("suffix", [".osm", ".osm.pbf", ".osm.gz", ".rexworld"])
def test_a_broken_world_file_is_answered_in_words(content: bytes, suffix: str, tmp_path: Path) -> None:
    path = tmp_path / f"broken{suffix}"
    path.write_bytes(content)
    code, shown = _rex("run", "Find me a bench", "--world", str(path))
    assert code == 2, shown
    assert "broken" in shown
    assert [item.name for item in tmp_path.iterdir()] == [path.name]


def test_everything_that_is_wrong_is_told_at_once_and_before_a_world_is_made(monkeypatch: pytest.MonkeyPatch) -> None:
    def expensive(*_: object, **__: object) -> None:
        raise AssertionError("a world was made")

    monkeypatch.setattr("reasoned_explorer.cli.run.open_world_with_notes", expensive)
    people = ["--planner", "llm-rtt", "--minds", "embeded", "--evaluator", "gpt", "--captioner", "nosy", "--vehicle"]
    numbers = ["--views", "0", "--t-max", "nan", "--radius", "0", "--seed", "-1", "--start", "1,x", "--bbox", "1,2"]
    code, shown = _rex("run", "", "--world", "prak:7", *people, "dron", "--latency", "x", "--clock", "y", *numbers)
    assert code == 2
    for word in ("the sentence is empty", "prak", "llm-rtt", "embeded", "'gpt'", "nosy", "dron", "latency", "clock",
                 "views is 0", "t_max is", "success_radius_m is 0", "seed is -1", "'x'", "2 values"):  # fmt: skip
        assert word in shown
    code, shown = _rex("run", "Find me a bench", "--set", "depth=-1", "--set", "width", "--world", "nowhere.osm")
    for word in ("depth is -1", "width", "nowhere.osm"):
        assert word in shown


def test_where_a_goal_is_everywhere_the_farthest_start_is_taken_and_said(tmp_path: Path) -> None:
    goal = ["run", "Find me a tree", "--world", "park:7@200", "--planner", "nearest-frontier", "--no-map"]
    code, shown = _rex(*goal, "--out", "run")
    assert code in {0, 1}, shown
    assert "this is the farthest found" in " ".join(shown.split())
    assert "note" in _rex("show", "run")[1]
    _, quiet = _rex(*goal, "--out", "quiet", "-q")
    assert "this is the farthest found" in " ".join(quiet.split())


def test_near_misses_are_named() -> None:
    assert "did you mean llm-rrt" in _rex("run", "Find me a bench", "--planner", "llm-rtt")[1]
    assert "park" in _rex("run", "Find me a bench", "--world", "prak:7")[1]


def test_a_folder_that_is_in_use_is_not_written_into(tmp_path: Path) -> None:
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "notes.txt").write_text("mine")
    code, shown = _rex("run", "Find me a bench", *FAST, "--out", "run")
    assert code == 2
    assert "empty folder" in shown


def test_without_a_folder_each_run_gets_one_of_its_own(tmp_path: Path) -> None:
    for _ in range(2):
        _rex("run", "Find me a bench", *FAST, "-q")
    assert len(list((tmp_path / "runs").iterdir())) == 2


def _start_slow_mission(folder: Path) -> "subprocess.Popen[bytes]":
    command = [sys.executable, "-m", "reasoned_explorer", "run", "Find me a museum", "--world", "town:1@500"]
    slow = ["--clock", "real", "--latency", "instant", "--out", "run", "--no-map"]
    process = subprocess.Popen([*command, *slow], cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    deadline = time.monotonic() + 120.0
    record = folder / "run" / "record.jsonl"
    while time.monotonic() < deadline and process.poll() is None:
        if record.exists() and record.read_bytes().count(b"\n") >= 3:
            return process
        time.sleep(0.1)
    process.kill()
    raise AssertionError(f"no mission under way; exit code {process.wait()}")


def test_a_person_may_stop_a_mission_and_its_record_says_so(tmp_path: Path) -> None:
    process = _start_slow_mission(tmp_path)
    process.send_signal(signal.SIGINT)
    assert process.wait(timeout=30) == 130
    record = read_record(tmp_path / "run")
    assert record.summary is not None
    assert record.summary.end == "interrupted"
    assert not record.complete
    assert "interrupted" in _rex("show", "run")[1]


def _pressed_in_compiled_code(monkeypatch: pytest.MonkeyPatch, where: str, *, times: int = 1) -> None:
    """Have Ctrl-C come in the middle of something compiled, which makes another error of `KeyboardInterrupt`."""
    module, _, name = where.rpartition(".")
    whole = getattr(importlib.import_module(module), name)
    presses = iter(range(times))

    def pressed(*args: object, **kwargs: object) -> object:
        try:
            for _ in presses:
                os.kill(os.getpid(), signal.SIGINT)
            return whole(*args, **kwargs)
        except KeyboardInterrupt:
            raise SystemError(f"{name} returned a result with an exception set") from None

    monkeypatch.setattr(f"{module}.{name}", pressed)


ROOT = "reasoned_explorer"
MOMENTS = {
    "while the world is made": (f"{ROOT}.world.generator.generate.find_sites", None),
    "while the mission is set up": (f"{ROOT}.world.geodesic.search", None),
    "while the agent looks": (f"{ROOT}.simulation.pixel_eyes_kernels.see", "interrupted"),
    "while it travels": (f"{ROOT}.exploration.explorer._facing_onwards", "interrupted"),
    "while the map is drawn": (f"{ROOT}.evaluation.mission_map.paint_world", "found"),
}


@pytest.mark.parametrize("times", [1, 2])
@pytest.mark.parametrize("moment", MOMENTS)
def test_ctrl_c_is_clean_whatever_it_comes_in_the_middle_of(
    moment: str, times: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    where, end = MOMENTS[moment]
    _pressed_in_compiled_code(monkeypatch, where, times=times)
    code, shown = _rex("run", "Find me a bench", *FAST[:-1], "--minds", "oracle", "--out", "run")
    assert code == 130, shown
    assert "rex: stopped" in shown
    assert "Traceback" not in shown
    if end is None:
        assert list(tmp_path.iterdir()) == []
    elif times == 1:
        summary = read_record(tmp_path / "run").summary
        assert summary is not None
        assert summary.end == end


def test_a_mistake_in_a_part_is_no_mission_without_success(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*args: object) -> None:
        raise ZeroDivisionError("a mistake")

    monkeypatch.setattr("reasoned_explorer.simulation.pixel_eyes_kernels.see", broken)
    code, shown = _rex("run", "Find me a bench", *FAST)
    assert code == 3
    assert "rex: a part failed: ZeroDivisionError: a mistake" in shown


def test_a_killed_mission_leaves_whole_steps_marked_incomplete(tmp_path: Path) -> None:
    process = _start_slow_mission(tmp_path)
    process.kill()
    process.wait(timeout=30)
    record = read_record(tmp_path / "run")
    assert record.summary is None
    assert len(record.steps) >= 2
    assert "INCOMPLETE" in _rex("show", "run")[1]


@pytest.mark.parametrize("most_bytes", [0, 1024])
def test_a_disk_that_is_full_before_the_first_step_leaves_nothing(most_bytes: int, tmp_path: Path) -> None:
    ended = rex_with_files_up_to(most_bytes, "run", "Find me a bench", *FAST, "--out", "runs/run")
    assert ended.returncode == 3, ended.stdout + ended.stderr
    assert "ulimit -f" in ended.stderr
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full here")
@pytest.mark.parametrize("command", [["show", "run"], ["worlds", "inspect", "plaza:1@150"], ["names"]])
def test_output_that_cannot_be_written_is_answered_in_words(command: list[str]) -> None:
    if command[0] == "show":
        _rex("run", "Find me a bench", *FAST, "--minds", "oracle", "--out", "run")
    with Path("/dev/full").open("w") as full:
        whole = [sys.executable, "-m", "reasoned_explorer", *command]
        ended = subprocess.run(whole, stdout=full, stderr=subprocess.PIPE, text=True, check=False)
    assert ended.returncode == 3, ended.stderr
    assert ended.stderr.startswith("rex: the output cannot be written: No space left on device")
    assert len(ended.stderr.splitlines()) == 1


def test_a_name_that_is_too_long_is_bad_input(tmp_path: Path) -> None:
    long = "n" * 300
    for more in (
        ["--out", long],
        ["--out", f"{long}/run"],
        ["--world", f"{long}.osm"],
        ["--world", f"{long}.rexworld"],
    ):
        code, shown = _rex("run", "Find me a bench", *FAST, *more)
        assert code == 2, shown
        assert "Traceback" not in shown
    assert _rex("worlds", "draw", "plaza:1@150", f"{long}.png")[0] == 2
    assert _rex("show", long)[0] == 2
    assert list(tmp_path.iterdir()) == []


FULL = {
    "a map of a world": (3, ["worlds", "draw", "plaza:1@150", "plaza.png"]),
    "a world": (3, ["worlds", "generate", "plaza:1@150", "--out", "plaza.rexworld"]),
    "a place that is not there": (2, ["worlds", "generate", "plaza:1@150", "--out", "nowhere/plaza.rexworld"]),
}


@pytest.mark.parametrize("what", FULL)
def test_a_full_disk_is_no_bad_input_whatever_is_written(what: str, tmp_path: Path) -> None:
    code, arguments = FULL[what]
    ended = rex_with_files_up_to(2048, *arguments)
    assert ended.returncode == code, ended.stdout + ended.stderr
    assert ("ulimit -f" in ended.stderr) == (code == 3)
    assert list(tmp_path.iterdir()) == []


def test_a_disk_that_is_full_when_the_map_is_drawn_leaves_the_whole_record() -> None:
    arguments = ["run", "Find me a bench", *FAST[:-1], "--minds", "oracle", "--max-steps", "3", "--out", "run"]
    ended = rex_with_files_up_to(150_000, *arguments)
    assert ended.returncode == 3, ended.stdout + ended.stderr
    assert "disk: run/map.png cannot be written" in ended.stderr
    assert {path.name for path in Path("run").iterdir()} == {"record.jsonl", "world.rexworld"}
    assert read_record(Path("run")).complete


def test_a_full_disk_ends_a_mission_in_words() -> None:
    goal = ["run", "Find me a museum", "--world", "town:1@500", "--out", "run", "--no-map"]
    ended = rex_with_files_up_to(60_000, *goal)
    assert ended.returncode == 3, ended.stdout + ended.stderr
    assert "cannot be written" in ended.stderr
    assert Path("run/record.jsonl").read_bytes().endswith(b"}\n")
    record = read_record(Path("run"))
    assert record.steps
    assert not record.complete
    assert "File too large" in _rex("show", "run")[1]
