"""Ratings in a run's database: kept at once, never lost, and beside others who use the same file."""

import shutil
import sqlite3
import subprocess
import sys
import threading
from contextlib import closing
from dataclasses import replace
from datetime import UTC, datetime, timedelta, timezone
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.evaluation.bench.plan import BenchPlan
from reasoned_explorer.evaluation.bench.runner import Workers, run_bench
from reasoned_explorer.evaluation.bench.store import STORE_NAME, RunStore
from reasoned_explorer.evaluation.ratings import (
    LONGEST_COMMENT,
    LONGEST_NAME,
    Answer,
    MissionKey,
    Rating,
    RatingStore,
    latest,
    rater_name,
    ratings_of,
)
from reasoned_explorer.evaluation.row import MissionRow
from reasoned_explorer.model import InputError, RecordError
from tests.evaluation.bench.conftest import small_plan, small_split

__all__ = ["small_plan", "small_split"]  # fixtures
NOON = datetime(2026, 3, 1, 12, tzinfo=UTC)


@pytest.fixture(scope="module")
def whole_run(tmp_path_factory: pytest.TempPathFactory, small_plan: BenchPlan) -> Path:
    folder = tmp_path_factory.mktemp("ratings") / "run"
    with RunStore.create(folder, small_plan, {"command": "rex bench"}) as store:
        run_bench(store, Workers())
    return folder


@pytest.fixture
def run(whole_run: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(whole_run, tmp_path / "run"))


def keys_of(run: Path) -> list[MissionKey]:
    with RunStore.read(run) as store:
        return sorted(store.finished())


def rows_of(run: Path) -> list[MissionRow]:
    with RunStore.read(run) as store:
        return list(store.rows())


def kept_in(run: Path) -> tuple[Rating, ...]:
    with RunStore.read(run) as store:
        return ratings_of(store)


def rating(key: MissionKey, rater: str = "Ann", answer: Answer = Answer.YES, **changes: object) -> Rating:
    return replace(Rating(rater, *key, answer, 4, "", NOON, "0.1.0"), **changes)  # type: ignore[arg-type]


def test_a_rating_is_there_for_whoever_opens_the_run_next(run: Path) -> None:
    said = rating(keys_of(run)[0], comment="It stands beside it.\nNice – 👍", answer=Answer.PARTLY)
    with RatingStore(run) as store:
        assert store.add(said)
        assert store.latest_of("Ann", said.key) == said
    assert kept_in(run) == (said,)


def test_a_run_that_was_never_rated_has_no_ratings_and_stays_as_it_is(run: Path) -> None:
    before = (run / STORE_NAME).read_bytes()
    assert kept_in(run) == ()
    assert (run / STORE_NAME).read_bytes() == before


def test_rating_leaves_the_missions_as_they_were(run: Path) -> None:
    before = rows_of(run)
    with RatingStore(run) as store:
        store.add(rating(keys_of(run)[0]))
    assert rows_of(run) == before
    assert [path.name for path in run.glob("run.sqlite*")] == [STORE_NAME], "a plain file again"


def test_a_changed_rating_keeps_the_earlier_ones_and_the_latest_counts(run: Path) -> None:
    key = keys_of(run)[0]
    first, second = rating(key), rating(key, answer=Answer.NO, how_well=1, at=NOON + timedelta(minutes=3))
    with RatingStore(run) as store:
        store.add(first)
        store.add(second)
        assert store.latest_of("Ann", key) == second
    assert kept_in(run) == (first, second)
    assert latest(kept_in(run)) == (second,)


def test_an_answer_that_is_sent_twice_is_kept_once(run: Path) -> None:
    said = rating(keys_of(run)[0])
    with RatingStore(run) as store:
        assert store.add(said)
        assert not store.add(replace(said, at=NOON + timedelta(seconds=5)))
        assert store.add(replace(said, comment="on second thoughts"))
        assert store.add(said), "back to what was said first: that is a change"
    assert len(kept_in(run)) == 3


def test_raters_do_not_disturb_each_other(run: Path) -> None:
    key, other = keys_of(run)[:2]
    with RatingStore(run) as ann, RatingStore(run) as bob:
        ann.add(rating(key))
        bob.add(rating(key, "Bob", Answer.NO))
        bob.add(rating(other, "Bob"))
        assert ann.rated_by("Ann") == {key}
        assert ann.rated_by("Bob") == {key, other}
    assert [(said.rater, said.key) for said in latest(kept_in(run))] == [("Ann", key), ("Bob", key), ("Bob", other)]


def test_many_threads_lose_nothing(run: Path) -> None:
    keys = keys_of(run)
    with RatingStore(run) as mine, RatingStore(run) as other:

        def rate(name: str, store: RatingStore) -> None:
            for key in keys:
                store.add(rating(key, name))

        threads = [threading.Thread(target=rate, args=(f"rater {at}", (mine, other)[at % 2])) for at in range(6)]
        for each in threads:
            each.start()
        for each in threads:
            each.join()
    assert len(kept_in(run)) == 6 * len(keys)


_KILLED = """
import os, signal, sys
from datetime import UTC, datetime
from pathlib import Path
from reasoned_explorer.evaluation.ratings import Answer, Rating, RatingStore
store = RatingStore(Path(sys.argv[1]))
for how_well in (1, 2, 3):
    store.add(Rating("Ann", *sys.argv[2:5], Answer.YES, how_well, "", datetime(2026, 3, 1, tzinfo=UTC), "0.1.0"))
    print(how_well, flush=True)
os.kill(os.getpid(), signal.SIGKILL)
"""


def test_what_was_acknowledged_survives_a_kill(run: Path) -> None:
    key = keys_of(run)[0]
    ran = subprocess.run(
        [sys.executable, "-c", _KILLED, str(run), *key], check=False, capture_output=True, text=True, timeout=120
    )
    assert ran.returncode == -9
    assert ran.stdout.split() == ["1", "2", "3"]
    assert [said.how_well for said in kept_in(run)] == [1, 2, 3]
    with RatingStore(run) as store:  # and one can go on
        store.add(rating(key, how_well=5))
    assert latest(kept_in(run))[0].how_well == 5


def test_a_benchmark_goes_on_while_its_missions_are_rated(tmp_path: Path, small_plan: BenchPlan, run: Path) -> None:
    """As `rex rate` beside `rex bench --resume` and `rex report`: all three have the file open."""
    with sqlite3.connect(run / STORE_NAME) as connection:
        connection.execute("DELETE FROM missions WHERE method = 'llm-as-eval'")
    key = keys_of(run)[0]
    with RatingStore(run) as rates:
        rates.add(rating(key))
        with RunStore.open(run) as benches:
            rates.add(rating(key, "Bob"))
            run_bench(benches, Workers())
            with RunStore.read(run) as reads:
                assert len(list(reads.rows())) == 12
                rates.add(rating(key, "Cyd"))
                assert len(ratings_of(reads)) == 3
        new = next(key for key in keys_of(run) if key[1] == "llm-as-eval")
        rates.add(rating(new))
    assert len(kept_in(run)) == 4
    assert [path.name for path in run.glob("run.sqlite*")] == [STORE_NAME]


def test_somebody_who_reads_does_not_keep_a_rater_out(run: Path) -> None:
    with closing(sqlite3.connect(run / STORE_NAME)) as reader:
        cursor = reader.execute("SELECT row FROM missions")
        cursor.fetchone()  # holds its lock until it is through
        keeps: list[bool] = []

        def rate() -> None:
            with RatingStore(run) as store:
                keeps.append(store.add(rating(keys_of(run)[0])))

        thread = threading.Thread(target=rate)
        thread.start()
        cursor.fetchall()
        thread.join(60)
    assert keeps == [True]


def test_a_mission_that_the_run_does_not_have_is_refused(run: Path) -> None:
    with RatingStore(run) as store, pytest.raises(InputError, match="there is no mission"):
        store.add(rating(("drone", "llm-as-eval", "nowhere|1")))
    assert kept_in(run) == ()


def test_what_is_no_run_is_refused(tmp_path: Path) -> None:
    with pytest.raises(RecordError, match=r"holds no run\.sqlite"):
        RatingStore(tmp_path)


def test_a_secret_stays_the_same(run: Path) -> None:
    with RatingStore(run) as store:
        assert store.secret("rating_key", b"first") == b"first"
        assert store.secret("rating_key", b"second") == b"first"
    with RatingStore(run) as store:
        assert store.secret("rating_key", b"third") == b"first"


def test_all_that_is_wrong_with_a_rating_is_said_at_once(run: Path) -> None:
    with pytest.raises(InputError) as refused:
        Rating("", "drone", "a", "b", "maybe", 6, "x" * (LONGEST_COMMENT + 1), NOON, "0.1.0")  # type: ignore[arg-type]
    assert len(refused.value.faults) == 4
    with pytest.raises(InputError, match="UTC"):
        rating(("a", "b", "c"), at=NOON.astimezone(timezone(timedelta(hours=2))))
    for bad in (True, 0, 6):
        with pytest.raises(InputError, match="how well"):
            rating(("a", "b", "c"), how_well=bad)


@pytest.mark.parametrize(
    "name", ["", "   ", "\n", "a\x00b", "a\x1b[31m", "x" * (LONGEST_NAME + 1), "\u202eevil", "a\u2028b"]
)
def test_names_that_are_none_are_refused(name: str) -> None:
    with pytest.raises(InputError):
        rater_name(name)


@pytest.mark.parametrize("name", ["Ann", "Zoë Ó Briain", "山田 太郎", "../../etc/passwd", "<script>alert(1)</script>"])
def test_a_name_is_text_and_nothing_else(run: Path, name: str) -> None:
    with RatingStore(run) as store:
        store.add(rating(keys_of(run)[0], rater_name(name)))
    assert [said.rater for said in kept_in(run)] == [name]


@given(st.text(max_size=80))
def test_a_name_that_was_tidied_stays_as_it_is(text: str) -> None:
    try:
        name = rater_name(text)
    except InputError:
        return
    assert rater_name(name) == name
    assert name == name.strip()
    assert 1 <= len(name) <= LONGEST_NAME


@pytest.fixture(scope="module")
def shared(whole_run: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[MissionKey]]:
    folder = Path(shutil.copytree(whole_run, tmp_path_factory.mktemp("shared") / "run"))
    return folder, keys_of(folder)


_SAID = st.tuples(
    st.sampled_from(["Ann", "Bob", "Çağla"]),
    st.integers(0, 3),
    st.sampled_from(Answer),
    st.integers(1, 5),
    st.text(st.characters(exclude_categories=("Cs", "Cc")), max_size=30),
)


@given(st.lists(_SAID, max_size=12))
def test_the_store_holds_what_was_said_last(
    shared: tuple[Path, list[MissionKey]], said: list[tuple[str, int, Answer, int, str]]
) -> None:
    """Against a dictionary that does the same in the plainest way."""
    run, keys = shared
    with sqlite3.connect(run / STORE_NAME) as connection:
        connection.execute("DROP TABLE IF EXISTS ratings")
    expected: dict[tuple[str, MissionKey], Rating] = {}
    with RatingStore(run) as store:
        for at, (rater, place, answer, how_well, comment) in enumerate(said):
            one = rating(
                keys[place], rater, answer, how_well=how_well, comment=comment, at=NOON + timedelta(seconds=at)
            )
            before = expected.get((rater, one.key))
            changed = store.add(one)
            assert changed == (not one.says_the_same(before))
            if changed:
                expected[rater, one.key] = one
        assert all(store.latest_of(rater, key) == one for (rater, key), one in expected.items())
    found = {(one.rater, one.key): one for one in latest(kept_in(run))}
    assert found == expected
