"""Kernels are compiled once: by helpers, by this process, or by another one that is at it."""

import subprocess
import sys
import textwrap
import threading
import time
from collections.abc import Sequence
from pathlib import Path

import pytest

from reasoned_explorer.model import stopping
from reasoned_explorer.rendering import keeping
from reasoned_explorer.rendering.keeping import compile_missing, is_kept, keep
from reasoned_explorer.rendering.readiness import Work, hand_on_lines

PARTS = ("one", "two", "three")
#: Says a line for each part that it "compiles", which takes it a while; a file for each says who did it.
COMPILER = """
import sys, time
from pathlib import Path
from reasoned_explorer.rendering import keeping

folder, me = Path(sys.argv[1]), sys.argv[2]
keeping.cache_folder = lambda: folder

def compile_part(part):
    print(part, flush=True)
    time.sleep(0.2)
    with (folder / f"{part}.by").open("a") as file:
        file.write(me)

keeping.compile_missing(sys.argv[3:], compile_part)
"""


class Compiler:
    """Stands for numba: notes what it is asked to compile."""

    def __init__(self) -> None:
        self.compiled: list[str] = []

    def __call__(self, part: str) -> None:
        self.compiled.append(part)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(keeping, "cache_folder", lambda: tmp_path)
    return tmp_path


def python(code: str, *arguments: str) -> list[str]:
    return [sys.executable, "-c", textwrap.dedent(code), *arguments]


def said_by(command: Sequence[str]) -> list[str]:
    lines: list[str] = []
    thread = hand_on_lines(command, lines.append)
    if thread is not None:
        thread.join()
    return lines


def test_a_part_is_kept_once_it_is_noted(folder: Path) -> None:
    assert not is_kept("one")
    keep("one")
    assert is_kept("one")
    assert not is_kept("two")
    assert len(list(folder.iterdir())) == 1


def test_what_was_compiled_from_other_sources_is_not_kept(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    keep("one")
    monkeypatch.setattr(keeping, "_fingerprint", lambda: "of other sources")
    assert not is_kept("one")
    keep("one")
    assert is_kept("one")
    assert len(list(folder.iterdir())) == 1


@pytest.mark.parametrize("content", [b"", b"\xff\xfe", b"something else"])
def test_a_damaged_note_is_none(folder: Path, content: bytes) -> None:
    keep("one")
    next(folder.iterdir()).write_bytes(content)
    assert not is_kept("one")


def test_where_nothing_can_be_noted_nothing_is_kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(keeping, "cache_folder", lambda: tmp_path / "nowhere")
    keep("one")
    assert not is_kept("one")


def test_where_numba_compiles_nothing_all_is_ready(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(keeping, "cache_folder", lambda: None)
    compiler = Compiler()
    assert compile_missing(PARTS, compiler) == []
    assert compiler.compiled == []


def test_what_is_kept_is_not_compiled_again(folder: Path) -> None:
    keep("two")
    compiler = Compiler()
    assert compile_missing(PARTS, compiler) == ["one", "three"]
    assert compile_missing(PARTS, compiler) == []
    assert compiler.compiled == ["one", "three"]


def test_what_plus_two_process_is_at_is_left_to_it(folder: Path) -> None:
    said: list[str] = []
    begun = threading.Event()

    def hand_on(line: str) -> None:
        said.append(line)
        begun.set()

    thread = hand_on_lines(python(COMPILER, str(folder), "a", "one"), hand_on)
    assert thread is not None
    assert begun.wait(60.0)
    compiler = Compiler()
    assert compile_missing(("one", "two"), compiler) == ["two"]
    thread.join()
    assert is_kept("one")
    assert said == ["one"]


def test_what_a_process_had_begun_when_it_died_is_free_again(folder: Path) -> None:
    dying = python(COMPILER.replace("time.sleep(0.2)", "raise SystemExit(3)"), str(folder), "a", "one")
    assert said_by(dying) == ["one"]
    compiler = Compiler()
    assert compile_missing(("one",), compiler) == ["one"]


def test_two_processes_share_the_parts(folder: Path) -> None:
    orders = {"a": PARTS, "b": PARTS[::-1]}
    both = [subprocess.Popen(python(COMPILER, str(folder), me, *order)) for me, order in orders.items()]
    assert [process.wait() for process in both] == [0, 0]
    assert all(len((folder / f"{part}.by").read_text()) == 1 for part in PARTS)
    assert all(is_kept(part) for part in PARTS)


def test_lines_of_a_process_are_handed_on() -> None:
    assert said_by(python("print('one'); print(' two ')")) == ["one", "two"]


def test_a_process_that_fails_has_said_what_it_has_said() -> None:
    assert said_by(python("print('one', flush=True); raise SystemExit(3)")) == ["one"]


def test_a_process_that_cannot_be_started_says_nothing(tmp_path: Path) -> None:
    assert hand_on_lines([str(tmp_path / "nothing")], print) is None


def test_a_helper_finds_the_modules_of_this_process(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "a_module_of_this_test.py").write_text("print('found')")
    monkeypatch.syspath_prepend(tmp_path)
    assert said_by(python("import a_module_of_this_test")) == ["found"]


def test_what_no_helper_compiles_this_process_does(folder: Path, tmp_path: Path) -> None:
    for command in ([str(tmp_path / "nothing")], python("raise SystemExit(3)")):
        compiler = Compiler()
        for part in PARTS:
            (folder / f"renderer-{part}.ready").unlink(missing_ok=True)
        work = Work(PARTS, compiler, lambda _, command=command: command, 2)
        work.begin()
        work.finish(lambda _: None)
        assert compiler.compiled == ["three", "two", "one"]
        assert all(is_kept(part) for part in PARTS)


def test_helpers_and_this_process_meet(folder: Path) -> None:
    def slowly(part: str) -> None:
        time.sleep(0.2)
        compiler(part)

    compiler = Compiler()
    parts = [f"part {k}" for k in range(8)]
    told: list[str] = []
    work = Work(parts, slowly, lambda order: python(COMPILER, str(folder), "a", *order), 1)
    work.begin()
    while not list(folder.glob("*.lock")):
        time.sleep(0.01)
    work.finish(told.append)
    by_helper = {path.stem for path in folder.glob("*.by")}
    assert by_helper | set(compiler.compiled) == set(parts)
    assert not by_helper & set(compiler.compiled)
    assert by_helper
    assert compiler.compiled[0] == parts[-1]
    assert told
    assert all("the first time only" in line and line.endswith(" %") for line in told)


def test_work_is_done_once(folder: Path) -> None:
    compiler = Compiler()
    work = Work(PARTS, compiler, lambda _: python("pass"), 0)
    for _ in range(2):
        work.begin()
        work.finish(lambda _: None)
    assert compiler.compiled == ["three", "two", "one"]


def test_where_nothing_can_be_noted_each_part_is_compiled_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setattr(keeping, "cache_folder", lambda: tmp_path / "file" / "folder")
    compiler = Compiler()
    work = Work(PARTS, compiler, lambda _: python("pass"), 1)
    work.begin()
    work.finish(lambda _: None)
    assert compiler.compiled == ["three", "two", "one"]


def test_a_person_can_stop_while_plus_two_process_compiles(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    slow = python(COMPILER.replace("time.sleep(0.2)", "time.sleep(60)"), str(folder), "a", "one")
    process = subprocess.Popen(slow, stdout=subprocess.PIPE)
    try:
        assert process.stdout is not None
        assert process.stdout.readline() == b"one\n"
        work = Work(("one",), Compiler(), lambda _: python("pass"), 0)
        work.begin()
        with stopping.listening():
            threading.Timer(0.3, lambda: stopping._note(2, None)).start()
            with pytest.raises(KeyboardInterrupt):
                work.finish(lambda _: None)
    finally:
        process.kill()
        process.communicate()


def test_what_numba_compiles_is_told() -> None:
    import numba

    names: list[str] = []
    with keeping.telling(names.append):
        numba.njit(_plus_one)(2)
    numba.njit(_plus_two)(2)
    assert names == ["_plus_one"]


def _plus_one(x):
    return x + 1


def _plus_two(x):
    return x + 2
