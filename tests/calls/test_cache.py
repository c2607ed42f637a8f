import multiprocessing
import pickle
import sqlite3
import subprocess
import sys
from pathlib import Path

import pytest

from reasoned_explorer.calls.cache import AnswerCache, StoredAnswer
from reasoned_explorer.calls.chat import ChatAnswer, TokenChoice
from reasoned_explorer.model import SettingsError


def test_an_answer_comes_back_as_it_was_kept(tmp_path: Path) -> None:
    places = (TokenChoice("4", (("4", -0.25), ("5", float("-inf")))), TokenChoice("."))
    stored = StoredAnswer(ChatAnswer("4. é \ud83d", None, 12, 3, None, 2, "served-model", places), 0.1 + 0.2)
    cache = AnswerCache(tmp_path / "cache")
    cache.put("d", stored)
    cache.close()
    assert AnswerCache(tmp_path / "cache").get("d") == stored
    assert cache.get("e") is None


def test_the_first_answer_stays(tmp_path: Path) -> None:
    cache = AnswerCache(tmp_path / "cache")
    cache.put("d", StoredAnswer(ChatAnswer("first"), 1.0))
    cache.put("d", StoredAnswer(ChatAnswer("second"), 2.0))
    assert cache.get("d") == StoredAnswer(ChatAnswer("first"), 1.0)


def test_a_fault_is_not_taken(tmp_path: Path) -> None:
    cache = AnswerCache(tmp_path / "cache")
    with pytest.raises(ValueError, match="timed out"):
        cache.put("d", StoredAnswer(ChatAnswer(fault="timed out"), 1.0))
    assert len(cache) == 0


def test_several_processes_make_fill_and_read_one_file_at_the_same_time(tmp_path: Path) -> None:
    program = """
import sys
from reasoned_explorer.calls.cache import AnswerCache, StoredAnswer
from reasoned_explorer.calls.chat import ChatAnswer
me, path = sys.argv[1:]
print("ready", flush=True)
sys.stdin.readline()
cache = AnswerCache(path)
for number in range(150):
    cache.put(f"shared {number}", StoredAnswer(ChatAnswer(me), 1.0))
    cache.put(f"{me} {number}", StoredAnswer(ChatAnswer(me * 500), 1.0))
    got = cache.get(f"shared {number}")
    assert got is not None, cache.trouble
    print(number, got.answer.text)
assert cache.trouble is None, cache.trouble
"""
    processes = [
        subprocess.Popen(
            [sys.executable, "-c", program, name, str(tmp_path / "cache")],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        for name in "abc"
    ]
    for process in processes:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
    for process in processes:  # all are up: the file is made by all of them at once
        assert process.stdin is not None
        process.stdin.write("go\n")
        process.stdin.flush()
    heard = [process.communicate(timeout=60)[0] for process in processes]
    assert [process.returncode for process in processes] == [0, 0, 0]
    assert heard[0] == heard[1] == heard[2]  # they agree on every shared answer, whoever was first
    assert len(AnswerCache(tmp_path / "cache")) == 150 * 4


def _put_from_child(cache: AnswerCache, digest: str) -> None:
    cache.put(digest, StoredAnswer(ChatAnswer("from the child"), 1.0))
    raise SystemExit(0 if cache.trouble is None else 1)


@pytest.mark.parametrize("method", multiprocessing.get_all_start_methods())
@pytest.mark.filterwarnings("ignore:.*multi-threaded.*fork:DeprecationWarning")
def test_a_worker_process_may_be_handed_the_cache(method: str, tmp_path: Path) -> None:
    cache = AnswerCache(tmp_path / "cache")
    cache.put("before", StoredAnswer(ChatAnswer("x"), 1.0))
    child = multiprocessing.get_context(method).Process(target=_put_from_child, args=(cache, "d"))
    child.start()
    child.join(60)
    assert child.exitcode == 0
    cache.put("after", StoredAnswer(ChatAnswer("y"), 1.0))
    assert [cache.get(digest) is not None for digest in ("before", "d", "after")] == [True] * 3
    assert cache.trouble is None


def test_a_copy_keeps_what_it_was_made_with(tmp_path: Path) -> None:
    copy = pickle.loads(pickle.dumps(AnswerCache(tmp_path / "cache", sampled=False)))  # noqa: S301 - our own
    assert (copy.path, copy.sampled) == (tmp_path / "cache", False)


def test_a_file_that_is_something_else_is_refused_and_left_alone(tmp_path: Path) -> None:
    (tmp_path / "text").write_text("a diary, " * 1000)
    with sqlite3.connect(tmp_path / "other") as other:
        other.execute("CREATE TABLE mine (x)")
    other.close()
    for name in ("text", "other"):
        before = (tmp_path / name).read_bytes()
        with pytest.raises(SettingsError, match="choose another file"):
            AnswerCache(tmp_path / name)
        assert (tmp_path / name).read_bytes()[100:] == before[100:]
    with pytest.raises(SettingsError, match="unable to open"):
        AnswerCache(tmp_path / "no folder" / "cache")


def test_a_cache_that_breaks_while_it_is_used_costs_a_call_and_nothing_else(tmp_path: Path) -> None:
    cache = AnswerCache(tmp_path / "cache")
    cache.put("d", StoredAnswer(ChatAnswer("x"), 1.0))
    with sqlite3.connect(tmp_path / "cache") as other:
        other.execute("UPDATE answers SET answer = '{'")
    other.close()
    assert cache.get("d") is None
    assert "cache" in (cache.trouble or "")
    with sqlite3.connect(tmp_path / "cache") as other:
        other.execute("DROP TABLE answers")
    other.close()
    cache.put("e", StoredAnswer(ChatAnswer("x"), 1.0))
    assert cache.get("e") is None
    assert "no such table" in (cache.trouble or "")
