import json
import os
import signal
import threading
from pathlib import Path
from typing import Any

import pytest

from reasoned_explorer.calls.caller import CANCELLED, Caller
from reasoned_explorer.calls.chat import ChatAnswer
from reasoned_explorer.calls.ledger import Ledger
from reasoned_explorer.calls.stored import parts_of
from reasoned_explorer.calls.tape import Outcome, TapedCall, TapePlayer, TapeRecorder
from reasoned_explorer.clock import MixedClock
from reasoned_explorer.model import RecordError, RecordWriteError
from reasoned_explorer.model.stopping import listening
from tests.calls.fakes import FakeModel, question


def _call(number: int, **changes: Any) -> TapedCall:
    parts = parts_of("fake", question(number))
    values = {
        "digest": parts.digest,
        "parts": parts,
        "outcome": Outcome.ANSWERED,
        "seconds": 0.1 + 0.2,
        "answer": ChatAnswer(f"answer {number}"),
    }
    return TapedCall(number, "evaluator", (number,), **{**values, **changes})


def _tape(path: Path, count: int) -> Path:
    with TapeRecorder(path, about={"goal": "Find a bench."}) as tape:
        for number in range(count):
            tape.add(_call(number))
    return path


def test_a_call_comes_back_as_it_was_written(tmp_path: Path) -> None:
    player = TapePlayer(_tape(tmp_path / "tape", 3))
    assert player.about == {"goal": "Find a bench."}
    assert player.complete
    assert player.play("fake", question(1)) == _call(1)


def test_questions_and_pictures_are_not_on_a_tape(tmp_path: Path) -> None:
    request = question(0, text="the secret garden", system="You are kind.", images=(b"PNG picture",))
    with TapeRecorder(tmp_path / "tape") as tape:
        clock, model = MixedClock(), FakeModel(lambda _: ChatAnswer("4"))
        clock.run(Caller(model, clock=clock, ledger=Ledger(), tape=tape).ask(request))
    written = (tmp_path / "tape").read_text()
    assert '"text":"4"' in written
    assert not any(word in written for word in ("garden", "kind", "picture\\"))
    assert "PNG" not in written


def test_a_tape_is_not_written_over(tmp_path: Path) -> None:
    path = _tape(tmp_path / "tape", 1)
    with pytest.raises(RecordError, match="is there already"):
        TapeRecorder(path)
    with pytest.raises(RecordError, match="choose another place"):
        TapeRecorder(tmp_path / "no folder" / "tape")


@pytest.mark.parametrize("cut_bytes", [1, 40, 500])
def test_a_tape_that_was_cut_off_holds_its_whole_lines(cut_bytes: int, tmp_path: Path) -> None:
    path = _tape(tmp_path / "tape", 3)
    content = path.read_bytes()
    calls_end = content.rindex(b'{"end"')
    path.write_bytes(content[: calls_end - cut_bytes])
    player = TapePlayer(path)
    assert not player.complete
    assert isinstance(player.play("fake", question(1)), TapedCall)
    assert not isinstance(player.play("fake", question(2)), TapedCall)


def test_every_broken_line_is_told(tmp_path: Path) -> None:
    path = _tape(tmp_path / "tape", 4)
    lines = path.read_text().splitlines()
    lines[2] = lines[2][:30]
    lines[3] = lines[3].replace('"seconds":0.30', '"seconds":-0.30')
    path.write_text("\n".join(lines) + "\n")
    with pytest.raises(RecordError) as caught:
        TapePlayer(path)
    assert [fault.what.partition(" of ")[0] for fault in caught.value.faults] == ["line 3", "line 4"]


@pytest.mark.parametrize(
    ("content", "said"),
    [("", "no tape"), ("hello\n", "no tape"), ("[]\n", "no tape"), ('{"tape":99,"about":{}}\n', "has version 99")],
)
def test_what_is_no_tape_is_refused(content: str, said: str, tmp_path: Path) -> None:
    (tmp_path / "tape").write_text(content)
    with pytest.raises(RecordError, match=said):
        TapePlayer(tmp_path / "tape")
    with pytest.raises(RecordError, match="cannot be read"):
        TapePlayer(tmp_path / "none")


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full")
def test_a_disk_that_is_full_ends_the_run_and_keeps_what_was_written(tmp_path: Path) -> None:
    tape = TapeRecorder(tmp_path / "tape")
    tape.add(_call(0))
    whole = (tmp_path / "tape").read_bytes()
    full = os.open("/dev/full", os.O_WRONLY)
    kept = os.dup(tape._file.fileno())
    os.dup2(full, tape._file.fileno())
    with pytest.raises(RecordWriteError, match="make room"):
        tape.add(_call(1))
    os.dup2(kept, tape._file.fileno())
    os.close(full)
    os.close(kept)
    tape.close()
    assert (tmp_path / "tape").read_bytes() == whole + b'{"end":{"calls":1}}\n'


def test_a_person_who_stops_a_mission_leaves_its_calls_cancelled_on_the_tape(tmp_path: Path) -> None:
    clock, ledger = MixedClock(), Ledger()
    model = FakeModel(delay_s=lambda _: 3600.0)
    tape = TapeRecorder(tmp_path / "tape")
    stopper = threading.Timer(0.05, os.kill, (os.getpid(), signal.SIGINT))

    async def mission() -> None:
        stopper.start()
        await Caller(model, clock=clock, ledger=ledger, tape=tape).ask(question(0))

    with listening(), pytest.raises(KeyboardInterrupt), tape:
        clock.run(mission())
    stopper.join()
    assert [call.fault for call in ledger.calls] == [CANCELLED]
    lines = [json.loads(line) for line in (tmp_path / "tape").read_text().splitlines()]
    assert [line["call"]["outcome"] for line in lines[1:]] == ["cancelled"]
    assert not TapePlayer(tmp_path / "tape").complete


def test_a_mission_that_was_broken_off_goes_on_where_it_was_and_asks_nothing_twice(tmp_path: Path) -> None:
    def ask_all(model: FakeModel, tape: TapeRecorder, past: TapePlayer | None) -> tuple[list[ChatAnswer], Ledger]:
        clock, ledger = MixedClock(), Ledger()
        caller = Caller(model, clock=clock, ledger=ledger, tape=tape, past=past)

        async def mission() -> list[ChatAnswer]:
            return [await caller.ask(question(number)) for number in range(6)]

        with tape:
            return clock.run(mission()), ledger

    path = tmp_path / "tape"
    with TapeRecorder(path, about={"goal": "a bench"}) as tape:
        for number in range(3):
            parts = parts_of(FakeModel().fingerprint, question(number))
            tape.add(_call(number, digest=parts.digest, parts=parts, seconds=100.0, answer=ChatAnswer("then", usd=0.5)))
        parts = parts_of(FakeModel().fingerprint, question(3))
        tape.add(_call(3, digest=parts.digest, parts=parts, outcome=Outcome.DENIED, answer=ChatAnswer(fault="spent")))
    model, past = FakeModel(), TapePlayer(path)
    answers, ledger = ask_all(model, TapeRecorder.going_on(path), past)
    assert [answer.text for answer in answers[:3]] == ["then"] * 3
    assert [request.key for request in model.asked] == [(3,), (4,), (5,)]
    # They cost this mission what they cost then: time, and money that was paid once.
    assert ledger.calls[3].started_s == pytest.approx(300.0)
    assert [call.usd for call in ledger.calls] == [0.5, 0.5, 0.5, 0.01, 0.01, 0.01]
    whole = TapePlayer(path)
    assert whole.about == {"goal": "a bench"}
    assert whole.complete
    assert [(call.asked, call.outcome) for call in whole.calls] == [(n, Outcome.ANSWERED) for n in range(6)]
    assert not list(tmp_path.glob("*.half"))


def test_what_is_no_tape_is_not_gone_on_with(tmp_path: Path) -> None:
    (tmp_path / "tape").write_text("no tape\n")
    with pytest.raises(RecordError, match="is no tape"):
        TapeRecorder.going_on(tmp_path / "tape")
    assert [path.name for path in tmp_path.iterdir()] == ["tape"]
