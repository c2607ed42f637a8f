import errno
import os
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reasoned_explorer.evaluation.record_file import RECORD_NAME, RecordWriter, read_record
from reasoned_explorer.model import LegOutcome, RecordError, RecordWriteError, TrackPoint
from reasoned_explorer.model.record import (
    ChoiceRecord,
    FrontierRecord,
    InterventionRecord,
    LegRecord,
    MissionEnd,
    MissionHeader,
    MissionSummary,
    NodeRecord,
    StepRecord,
    ViewRecord,
)

HEADER = MissionHeader(
    goal="Find me a bench",
    level=1,
    world="park:7",
    world_digest="0" * 64,
    attribution="",
    start=(1.0, 2.0, 1.5, 0.5),
    planner="llm-rrt [scripted]",
    minds="scripted",
    captioner="perfect",
    vehicle="drone",
    clock="virtual",
    ct_label="modelled (gpt-2023)",
    settings={"views": 3, "planner_settings": {}, "visionary": None},
    seed=7,
    versions={"numpy": "2"},
    goal_objects=((3, "bench", 10.0, 20.0, 2),),
    reference_length_m=120.0,
    reference_way=((1.0, 2.0), (10.0, 20.0)),
)
STEP = StepRecord(
    step=0,
    started_s=0.0,
    ended_s=20.0,
    pose=(1.0, 2.0, 1.5, 0.5),
    point=0,
    views=(ViewRecord((0, 0, 0), 0.5, "A path.", q=3.25, frontier=0),),
    tree=(NodeRecord((0, 0, 0, 1), 1, "A bench.", 4.0, (0.0, 0.0, 0.0, 1.0, 0.0)),),
    choice=ChoiceRecord(0, 3.25, 10.0, 0.0, 3.25),
    legs=(
        LegRecord((1.0, 12.0), LegOutcome.ARRIVED, 5.0, 10.0, "", 0.1, 0.02, (TrackPoint(5.0, 1.0, 12.0, 1.5, 0.5),)),
    ),
    frontiers=(FrontierRecord(0, 0, 1.0, 12.0, 0.5, 3.25, False, "visited"),),
)
SUMMARY = MissionSummary(
    end=MissionEnd.FOUND,
    reason="a bench",
    declared=True,
    success=True,
    oracle_success=True,
    compliant=None,
    spl=0.8,
    casr=0.7,
    path_length_m=150.0,
    reference_length_m=120.0,
    distance_to_goal_m=3.0,
    ct_s=100.0,
    tt_s=50.0,
    plan_s=80.0,
    steps=1,
    calls={"visionary": 18},
)


def _write(folder: Path, *, steps: int = 1, end: bool = True) -> Path:
    with RecordWriter(folder) as writer:
        writer.header(HEADER)
        for number in range(steps):
            writer.step(replace(STEP, step=number))
        if end:
            writer.summary(SUMMARY)
    return folder / RECORD_NAME


def test_what_was_written_is_read_again(tmp_path: Path) -> None:
    _write(tmp_path)
    record = read_record(tmp_path)
    assert (record.header, record.steps, record.summary) == (HEADER, (STEP,), SUMMARY)
    assert record.complete


@settings(deadline=None, max_examples=30)
@given(st.data())
def test_a_record_cut_off_anywhere_ends_at_its_last_whole_step(data: st.DataObject) -> None:
    import tempfile

    with tempfile.TemporaryDirectory() as name:
        path = _write(Path(name), steps=4)
        whole = path.read_bytes()
        cut = data.draw(st.integers(len(whole.split(b"\n")[0]) + 1, len(whole) - 1))
        path.write_bytes(whole[:cut])
        record = read_record(Path(name))
        assert not record.complete
        assert len(record.steps) == max(0, whole[:cut].count(b"\n") - 1)


def test_a_broken_line_in_the_middle_is_an_error_that_names_it(tmp_path: Path) -> None:
    path = _write(tmp_path, steps=2)
    lines = path.read_bytes().split(b"\n")
    lines[1] = lines[1][:50]
    path.write_bytes(b"\n".join(lines))
    with pytest.raises(RecordError, match="line 2"):
        read_record(tmp_path)


@pytest.mark.parametrize(
    "content", [b"", b"{", b"[]\n", b'{"header": {"schema": 99}}\n', b'{"step": {}}\n', b"\xff\xfe\n"]
)
def test_what_is_no_record_is_refused(tmp_path: Path, content: bytes) -> None:
    (tmp_path / RECORD_NAME).write_bytes(content)
    with pytest.raises(RecordError):
        read_record(tmp_path)


def test_a_missing_record_says_what_leaves_one(tmp_path: Path) -> None:
    with pytest.raises(RecordError, match="rex run"):
        read_record(tmp_path / "nothing")


def test_a_record_is_never_written_over(tmp_path: Path) -> None:
    _write(tmp_path)
    with pytest.raises(RecordError, match="another folder"):
        RecordWriter(tmp_path)


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full here")
def test_a_full_disk_is_an_error_in_words(tmp_path: Path) -> None:
    with RecordWriter(tmp_path) as writer, Path("/dev/full").open("wb", buffering=0) as full:
        writer._file.close()
        writer._file = full
        with pytest.raises(RecordWriteError, match="No space left"):
            writer.header(HEADER)


def _disk_that_fills(writer: RecordWriter, after: int) -> None:
    """Have the disk take so many bytes more and then be full, in the middle of a line if need be."""
    whole, room = writer._file, [after]

    class Filling:
        def write(self, data: memoryview) -> int:
            if room[0] == 0:
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
            taken = whole.write(data[: room[0]])
            room[0] -= taken
            return taken

        def __getattr__(self, name: str) -> object:
            return getattr(whole, name)

    writer._file = Filling()


def _write_on_a_disk_with_room(folder: Path, *, for_header: int, for_steps: int) -> None:
    """Write a header and three steps where so many bytes are left for the header, and then for the steps."""
    with RecordWriter(folder) as writer:
        whole = writer._file
        _disk_that_fills(writer, for_header)
        writer.header(HEADER)
        writer._file = whole
        _disk_that_fills(writer, for_steps)
        for number in range(3):
            writer.step(replace(STEP, step=number))


@pytest.mark.parametrize("more", [0, 1, 100, 500])
def test_a_disk_that_fills_leaves_whole_steps_only(tmp_path: Path, more: int) -> None:
    one_step = len(_write(tmp_path / "whole").read_bytes().splitlines(keepends=True)[1])
    with pytest.raises(RecordWriteError, match="make room"):
        _write_on_a_disk_with_room(tmp_path / "run", for_header=10_000, for_steps=one_step + more)
    data = (tmp_path / "run" / RECORD_NAME).read_bytes()
    assert data.endswith(b"}\n")
    assert data.count(b"\n") == 2
    assert len(read_record(tmp_path / "run").steps) == 1


def test_what_has_room_where_a_step_had_none_comes_right_behind_the_last_whole_step(tmp_path: Path) -> None:
    with RecordWriter(tmp_path) as writer:
        writer.header(HEADER)
        writer.step(STEP)
        whole = writer._file
        _disk_that_fills(writer, 10)
        with pytest.raises(RecordWriteError):
            writer.step(replace(STEP, step=1))
        writer._file = whole
        writer.summary(SUMMARY)
    record = read_record(tmp_path)
    assert (len(record.steps), record.summary) == (1, SUMMARY)


@pytest.mark.parametrize("room", [(0, 0), (100, 0), (10_000, 0), (10_000, 5)])
def test_a_record_that_fails_before_its_first_whole_step_leaves_nothing(tmp_path: Path, room: tuple[int, int]) -> None:
    with pytest.raises(RecordWriteError):
        _write_on_a_disk_with_room(tmp_path / "runs" / "run", for_header=room[0], for_steps=room[1])
    assert list(tmp_path.iterdir()) == []


def test_what_was_there_before_a_record_that_fails_stays(tmp_path: Path) -> None:
    (tmp_path / "run").mkdir()
    with pytest.raises(RecordWriteError):
        _write_on_a_disk_with_room(tmp_path / "run", for_header=3, for_steps=0)
    assert list(tmp_path.iterdir()) == [tmp_path / "run"]
    assert list((tmp_path / "run").iterdir()) == []


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_a_folder_that_cannot_be_written_to_is_an_error_in_words(tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    with pytest.raises(RecordError, match="cannot be written"):
        RecordWriter(tmp_path / "run")


def test_interventions_are_kept_and_records_without_any_stay_as_they_were(tmp_path: Path) -> None:
    event = InterventionRecord(4.5, "link", "nothing heard of the machine for 0.7 s", "stopped")
    with RecordWriter(tmp_path) as writer:
        writer.header(HEADER)
        writer.step(STEP)
        writer.step(replace(STEP, step=1, interventions=(event,)))
    lines = (tmp_path / RECORD_NAME).read_bytes().splitlines()
    assert [b"interventions" in line for line in lines] == [False, False, True]
    assert [step.interventions for step in read_record(tmp_path).steps] == [(), (event,)]
