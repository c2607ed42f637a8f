"""What is found in a folder, what it is called, and what stays unread."""

import shutil
import sqlite3
import zlib
from dataclasses import replace
from pathlib import Path

import pytest

from reasoned_explorer.evaluation.bench.store import RunStore
from reasoned_explorer.model import InputError, RecordError
from reasoned_explorer.model.record import EpisodeRecord
from reasoned_explorer.viewer.bench_runs import BenchRun
from reasoned_explorer.viewer.library import Library
from reasoned_explorer.viewer.runs import Run, UnknownIdError
from tests.viewer.small_runs import MISSIONS, write_record


def _broken(run: Run) -> int:
    """Return how many missions of a run cannot be opened."""
    broken = 0
    for row in run.listing().rows:
        try:
            run.mission(row[0])
        except RecordError:
            broken += 1
    return broken


def test_a_run_of_the_benchmark_is_a_run(bench: Path) -> None:
    (run,) = Library(bench).runs()
    about = run.about()
    assert (about["kind"], about["missions"], about["name"]) == ("bench", MISSIONS, "small")
    assert about["methods"] == ["llm-rrt", "nearest-frontier"]
    assert len(run.listing().rows) == MISSIONS


def test_a_mission_is_a_run_of_one(tmp_path: Path, record: EpisodeRecord) -> None:
    write_record(tmp_path / "m", record)
    (run,) = Library(tmp_path / "m").runs()
    about = run.about()
    assert (about["kind"], about["missions"], about["methods"]) == ("mission", 1, ["llm-rrt"])


def test_a_folder_of_folders_is_looked_through_three_deep(tmp_path: Path, bench: Path, record: EpisodeRecord) -> None:
    shutil.copytree(bench, tmp_path / "benches" / "one")
    for name in ("a", "b", "deep/er/c", "deep/er/too/d", ".hidden/e"):
        write_record(tmp_path / name, record)
    found = {run.name: (run.kind, run.about()["missions"]) for run in Library(tmp_path).runs()}
    assert found == {
        tmp_path.name: ("missions", 2),
        "benches/one": ("bench", MISSIONS),
        "deep/er": ("missions", 1),
    }


def test_what_comes_later_is_found_and_what_goes_is_gone(tmp_path: Path, record: EpisodeRecord) -> None:
    library = Library(tmp_path)
    with pytest.raises(RecordError, match="holds no run"):
        library.check()
    write_record(tmp_path / "a", record)
    library.check()
    first = library.runs()[0]
    write_record(tmp_path / "b", record)
    assert library.runs()[0].about()["missions"] == 2
    assert library.runs()[0].id == first.id
    shutil.rmtree(tmp_path / "a")
    assert library.runs()[0].about()["missions"] == 1


def test_ids_tell_nothing_and_stay_the_same(tmp_path: Path, record: EpisodeRecord) -> None:
    write_record(tmp_path / "a secret name", record)
    one, other = Library(tmp_path).runs()[0], Library(tmp_path).runs()[0]
    assert one.id == other.id
    mission_id = one.listing().rows[0][0]
    assert set(one.id + mission_id) <= set("0123456789abcdef")
    assert Library(tmp_path).mission_ids(tmp_path.resolve() / "a secret name") == (one.id, mission_id)
    assert one.mission(mission_id).record == (tmp_path / "a secret name" / "record.jsonl").read_bytes()


def test_what_is_not_listed_is_not_there(bench: Path) -> None:
    library = Library(bench)
    for name in ("", "..", "0" * 16, "../../etc/passwd"):
        with pytest.raises(UnknownIdError):
            library.run(name)
        with pytest.raises(UnknownIdError):
            library.runs()[0].mission(name)


def test_links_that_lead_out_of_the_folder_are_not_followed(tmp_path: Path, bench: Path, record: EpisodeRecord) -> None:
    outside = tmp_path / "outside"
    write_record(outside, record)
    (outside / "pictures").mkdir()
    root = tmp_path / "root"
    (root / "linked record").mkdir(parents=True)
    (root / "linked record" / "record.jsonl").symlink_to(outside / "record.jsonl")
    (root / "linked folder").symlink_to(outside)
    (root / "linked run").mkdir()
    (root / "linked run" / "run.sqlite").symlink_to(bench / "run.sqlite")
    assert Library(root).runs() == []
    write_record(root / "real", record)
    (root / "real" / "pictures").symlink_to(outside / "pictures")
    (root / "real" / "world.rexworld").symlink_to(outside / "record.jsonl")
    (run,) = Library(root).runs()
    files = run.mission(run.listing().rows[0][0])
    assert files.pictures is None
    assert files.world is None


def test_a_linked_record_of_a_benchmark_is_not_followed(tmp_path: Path, bench: Path) -> None:
    shutil.copytree(bench, tmp_path / "run")
    victim = next((tmp_path / "run" / "traces").rglob("*.z"))
    shutil.move(victim, tmp_path / "moved")
    victim.symlink_to(tmp_path / "moved")
    (run,) = Library(tmp_path / "run").runs()
    assert _broken(run) == 1


def test_the_folder_itself_may_be_a_link(tmp_path: Path, record: EpisodeRecord) -> None:
    write_record(tmp_path / "real" / "a", record)
    (tmp_path / "link").symlink_to(tmp_path / "real")
    (run,) = Library(tmp_path / "link").runs()
    assert run.name == "link"
    assert run.mission(run.listing().rows[0][0]).record


@pytest.mark.parametrize(
    "content", [b"", b"no json\n", b"[]\n", b'{"header":5}\n', b'{"header":{}}\n', b'{"header":{"goal"']
)
def test_a_broken_mission_among_sound_ones_is_listed_with_what_is_wrong(
    tmp_path: Path, record: EpisodeRecord, content: bytes
) -> None:
    write_record(tmp_path / "sound", record)
    (tmp_path / "broken").mkdir()
    (tmp_path / "broken" / "record.jsonl").write_bytes(content)
    (run,) = Library(tmp_path).runs()
    listing = run.listing()
    broken, sound = ({"id": row[0], "fault": row[-1]} for row in sorted(listing.rows, key=lambda row: row[-1] is None))
    assert sound["fault"] is None
    assert "cannot be read" in listing.words[broken["fault"]]
    assert run.mission(sound["id"]).record


def test_a_mission_that_was_cut_off_is_listed_as_not_finished(tmp_path: Path, record: EpisodeRecord) -> None:
    write_record(tmp_path / "m", replace(record, summary=None))
    with (tmp_path / "m" / "record.jsonl").open("ab") as file:
        file.write(b'{"step":{"step":9')
    (run,) = Library(tmp_path).runs()
    listing = run.listing()
    (row,) = listing.rows
    words = {listing.words[cell] for cell in (row[5], row[6])}
    assert words == {"not judged", "not finished"}
    assert row[12] == len(record.steps)


def test_a_broken_store_is_listed_with_what_is_wrong(tmp_path: Path, bench: Path) -> None:
    shutil.copytree(bench, tmp_path / "run")
    (tmp_path / "run" / "run.sqlite").write_bytes(b"no database at all" * 100)
    (run,) = Library(tmp_path).runs()
    assert "cannot be read" in run.about()["fault"]
    with pytest.raises(InputError):
        run.listing()


def test_a_broken_row_and_a_broken_record_do_not_hide_the_others(tmp_path: Path, bench: Path) -> None:
    folder = tmp_path / "run"
    shutil.copytree(bench, folder)
    with sqlite3.connect(folder / "run.sqlite") as connection:
        connection.execute(
            "UPDATE missions SET row = '{half' "
            "WHERE method = 'llm-rrt' AND mission_id = (SELECT min(mission_id) FROM missions)"
        )
    connection.close()
    traces = sorted((folder / "traces" / "drone" / "nearest-frontier").glob("*.z"))
    traces[0].write_bytes(b"not compressed")
    traces[1].write_bytes(zlib.compress(b"no record\n"))
    (run,) = Library(folder).runs()
    rows = run.listing().rows
    assert len(rows) == MISSIONS
    assert [run.listing().words[row[-1]] for row in rows if row[-1] is not None] == [
        "its row in the run cannot be read"
    ]
    assert _broken(run) == 1  # what is inside of a record is found when it is opened


def test_a_run_that_goes_on_shows_what_is_new(tmp_path: Path, bench: Path) -> None:
    folder = tmp_path / "run"
    shutil.copytree(bench, folder)
    (run,) = Library(folder).runs()
    assert len(run.listing().rows) == MISSIONS
    with RunStore.open(folder) as store:
        task = next(store.plan.tasks())
        row = next(store.rows()).as_json()
        store.add(replace(task, mission_id="another"), row, trace=None, wall_s=1.0)
        assert len(run.listing().rows) == MISSIONS + 1
        assert run.about()["missions"] == MISSIONS + 1


def test_looking_leaves_nothing_behind(tmp_path: Path, bench: Path) -> None:
    folder = tmp_path / "run"
    shutil.copytree(bench, folder)
    before = {path: path.stat().st_mtime_ns for path in folder.rglob("*")}
    (run,) = Library(folder).runs()
    run.mission(run.listing().rows[0][0])
    assert {path: path.stat().st_mtime_ns for path in folder.rglob("*")} == before


def test_reading_ahead_fails_on_nothing(tmp_path: Path, bench: Path) -> None:
    library = Library(bench)
    library.read_ahead()
    assert len(library.runs()[0].listing().rows) == MISSIONS
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "run.sqlite").write_bytes(b"broken")
    Library(tmp_path / "run").read_ahead()
    shutil.copytree(bench, tmp_path / "good")
    several = Library(tmp_path)
    several.read_ahead()
    good, broken = several.runs()
    assert (good.name, broken.name) == ("good", "run")
    assert isinstance(good, BenchRun)
    assert good._kept is not None  # nobody has asked for it yet
    assert "fault" in broken.about()
