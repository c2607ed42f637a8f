"""Asking for real, from the cache and from the tape: the same mission each time, charged the same seconds."""

import asyncio
import json
import subprocess
import sys
import threading
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

import pytest

from reasoned_explorer.calls.budget import Budget
from reasoned_explorer.calls.cache import AnswerCache
from reasoned_explorer.calls.caller import CANCELLED, Caller, end_of
from reasoned_explorer.calls.chat import ChatAnswer, ChatRequest, TokenChoice
from reasoned_explorer.calls.ledger import CallRecord, Ledger
from reasoned_explorer.calls.tape import TapePlayer, TapeRecorder
from reasoned_explorer.clock import Clock, MixedClock, RealClock, VirtualClock
from reasoned_explorer.clock.live_thread import run_live
from reasoned_explorer.model import SettingsError
from reasoned_explorer.model.record import MissionEnd
from tests.calls.fakes import FakeModel, question

Mission = Callable[[Caller, Clock], Awaitable[Any]]


def run(model: FakeModel, mission: Mission, *, clock: Clock | None = None, **stores: Any) -> tuple[Any, Ledger, Caller]:
    """Run a mission that asks a model; return what it returns, its ledger and its caller."""
    on, ledger = clock or MixedClock(), Ledger()
    caller = Caller(model, clock=on, ledger=ledger, **stores)

    async def whole() -> Any:
        return await mission(caller, on)

    return on.run(whole()), ledger, caller


def ask(*requests: ChatRequest) -> Mission:
    """Return a mission that asks all at once."""

    async def mission(caller: Caller, _: Clock) -> list[ChatAnswer]:
        return list(await asyncio.gather(*map(caller.ask, requests)))

    return mission


@pytest.mark.parametrize("clock", [MixedClock(), RealClock()], ids=["mixed", "real"])
def test_an_answer_comes_with_its_line_in_the_ledger(clock: Clock) -> None:
    (answer,), ledger, _ = run(FakeModel(), ask(question(3, 0, 1)), clock=clock)
    assert answer.text == "evaluator says scene (3, 0, 1)"
    (call,) = ledger.calls
    assert (call.role, call.model, call.key) == ("evaluator", "fake:model", (3, 0, 1))
    assert (call.tokens_in, call.tokens_out, call.usd, call.retries, call.cached, call.fault) == (
        *(10, 3, 0.01, 1),
        *(False, None),
    )
    assert call.latency_s >= 0.0019


def test_calls_of_a_batch_overlap() -> None:
    class Gathering(FakeModel):
        """Answers nobody before all nine have asked."""

        async def ask(self, request: ChatRequest) -> ChatAnswer:
            self.asked.append(request)
            if len(self.asked) == 1:
                self.all_here = asyncio.Event()
            if len(self.asked) == 9:
                self.all_here.set()
            async with asyncio.timeout(30.0):
                await self.all_here.wait()
            return ChatAnswer("4")

    async def mission(caller: Caller, clock: Clock) -> tuple[list[ChatAnswer], float]:
        answers = await asyncio.gather(*(caller.ask(question(0, 0, index)) for index in range(9)))
        return answers, clock.now_s()

    (answers, ended_s), ledger, _ = run(Gathering(), mission)
    assert [answer.fault for answer in answers] == [None] * 9
    assert ended_s == pytest.approx(max(call.latency_s for call in ledger.calls), abs=1e-9)


def test_whatever_a_model_throws_is_a_fault() -> None:
    def rule(request: ChatRequest) -> Any:
        if request.key[2] == 0:
            raise ValueError("no JSON")
        return "a text" if request.key[2] == 1 else ChatAnswer(fault="429 too many requests", usd=None)

    answers, ledger, _ = run(FakeModel(rule), ask(*(question(0, 0, index) for index in range(3))))
    assert [answer.fault for answer in answers] == [
        "the model failed: ValueError: no JSON",
        "the model failed: it returned a str",
        "429 too many requests",
    ]
    assert sorted(call.fault or "" for call in ledger.calls) == sorted(answer.fault for answer in answers)
    assert ledger.totals()["evaluator"].unpriced == 3


def test_a_cancelled_call_is_ended_and_kept_as_cancelled_with_its_seconds_so_far(tmp_path: Path) -> None:
    model = FakeModel(delay_s=lambda request: 3600.0 if request.role == "visionary" else 0.005)
    with TapeRecorder(tmp_path / "tape") as tape:
        _, ledger, _ = run(model, _found_while_imagining, tape=tape)
    assert model.was_cancelled.wait(10.0)
    checked, imagined = ledger.calls
    assert (checked.role, checked.fault) == ("checker", None)
    assert (imagined.role, imagined.fault, imagined.usd) == ("visionary", CANCELLED, None)
    assert imagined.latency_s == pytest.approx(checked.latency_s, abs=1e-9)
    lines = [json.loads(line) for line in (tmp_path / "tape").read_text().splitlines()]
    assert [line["call"]["outcome"] for line in lines[1:-1]] == ["answered", "cancelled"]


def test_a_call_that_had_really_ended_before_it_was_cancelled_is_kept_with_its_cost(tmp_path: Path) -> None:
    answered = threading.Event()

    def rule(_: ChatRequest) -> ChatAnswer:
        answered.set()
        return ChatAnswer("too late", tokens_in=7, usd=0.02)

    async def mission(caller: Caller, clock: Clock) -> float:
        asking = asyncio.ensure_future(caller.ask(question()))
        await clock.act(0.001)
        # This program is busy until the answer is there, 0.02 s after the asking, and the live loop is at other things.
        answered.wait(30.0)
        run_live(lambda: asyncio.sleep(0))
        asking.cancel()
        await asyncio.gather(asking, return_exceptions=True)
        return clock.now_s()

    budget = Budget(usd=1.0)
    with TapeRecorder(tmp_path / "tape") as tape:
        ended_s, ledger, _ = run(FakeModel(rule, delay_s=lambda _: 0.02), mission, tape=tape, budget=budget)
    assert ledger.calls == (
        CallRecord("evaluator", "fake:model", (0, 0, 0), 0.0, 0.001, tokens_in=7, usd=0.02, fault=CANCELLED),
    )
    assert budget.spent_usd == 0.02
    answered.set()
    again_s, ledger_again, _ = run(FakeModel(), mission, tape=TapePlayer(tmp_path / "tape"))
    assert (again_s, ledger_again.calls) == (ended_s, ledger.calls)


async def _found_while_imagining(caller: Caller, clock: Clock) -> float:
    imagining = asyncio.ensure_future(caller.ask(question(0, 0, 0, role="visionary")))
    await caller.ask(question(0, 0, 0, role="checker"))
    imagining.cancel()
    with pytest.raises(asyncio.CancelledError):
        await imagining
    return clock.now_s()


# Replay.


async def _explore(caller: Caller, clock: Clock) -> list[tuple[str, float]]:
    """Make steps like an explorer's: captions, then imagining and scoring while checks go on, then travel."""
    seen: list[tuple[str, float]] = []

    async def one(request: ChatRequest) -> str:
        answer = await caller.ask(request)
        seen.append((answer.text or answer.fault or "", clock.now_s()))
        return answer.text

    async def plan(step: int) -> None:
        await asyncio.gather(
            *(one(question(step, 0, view, child, role="visionary")) for view in range(3) for child in range(2))
        )
        await asyncio.gather(*(one(question(step, 0, view, role="evaluator")) for view in range(3)))

    for step in range(5):
        await clock.act(0.7)
        await asyncio.gather(*(one(question(step, view, role="caption")) for view in range(3)))
        planning = asyncio.ensure_future(plan(step))
        await asyncio.gather(*(one(question(step, 0, view, role="checker")) for view in range(3)))
        if step % 2:
            await planning
        else:
            planning.cancel()
            await asyncio.gather(planning, return_exceptions=True)
        seen.append(("step", clock.now_s()))
    return seen


def _moody() -> FakeModel:
    def rule(request: ChatRequest) -> ChatAnswer:
        if hash(request.key) % 5 == 0:
            return ChatAnswer(fault="timed out", usd=None, retries=2)
        places = (TokenChoice("4", (("4", -0.1), ("5", float("-inf")))),)
        return ChatAnswer(f"{request.role} {request.key} é \ud83d", tokens_in=5, usd=0.001, tokens=places)

    return FakeModel(rule, delay_s=lambda request: 0.001 + 0.001 * (hash((request.role, request.key)) % 7))


@pytest.mark.parametrize("again", [MixedClock, VirtualClock])
def test_a_replayed_mission_is_the_same_bit_for_bit_and_asks_no_model(
    again: Callable[[], Clock], tmp_path: Path
) -> None:
    with TapeRecorder(tmp_path / "tape") as tape:
        seen, ledger, _ = run(_moody(), _explore, tape=tape)
    assert any(call.fault == CANCELLED for call in ledger.calls)
    assert any(call.fault == "timed out" for call in ledger.calls)
    silent = FakeModel()
    seen_again, ledger_again, caller = run(silent, _explore, clock=again(), tape=TapePlayer(tmp_path / "tape"))
    assert seen_again == seen
    assert ledger_again.calls == ledger.calls
    assert silent.asked == []
    assert caller.end is None


def test_what_came_from_the_cache_then_is_replayed_as_such(tmp_path: Path) -> None:
    cache = AnswerCache(tmp_path / "cache")
    run(_moody(), _explore, cache=cache)
    with TapeRecorder(tmp_path / "tape") as tape:
        seen, ledger, _ = run(_moody(), _explore, cache=cache, tape=tape)
    assert {call.cached for call in ledger.calls} == {True, False}  # faults were asked again
    seen_again, ledger_again, _ = run(FakeModel(), _explore, tape=TapePlayer(tmp_path / "tape"))
    assert (seen_again, ledger_again.calls) == (seen, ledger.calls)


def test_the_same_question_asked_twice_at_once_gets_the_answers_in_the_order_of_asking(tmp_path: Path) -> None:
    class SecondFirst(FakeModel):
        """Answers who asked second before who asked first."""

        async def ask(self, request: ChatRequest) -> ChatAnswer:
            self.asked.append(request)
            if len(self.asked) == 1:
                self.second = asyncio.Event()
                await self.second.wait()
                await asyncio.sleep(0.01)
                return ChatAnswer("to the first")
            self.second.set()
            return ChatAnswer("to the second")

    with TapeRecorder(tmp_path / "tape") as tape:
        answers, ledger, _ = run(SecondFirst(), ask(question(), question()), tape=tape)
    assert [answer.text for answer in answers] == ["to the first", "to the second"]
    again, ledger_again, _ = run(FakeModel(), ask(question(), question()), tape=TapePlayer(tmp_path / "tape"))
    assert (again, ledger_again.calls) == (answers, ledger.calls)


@pytest.mark.parametrize(
    ("changed", "fingerprint", "said"),
    [
        (
            {"prompt": "evaluator/2", "system": "You rate."},
            "fake:model at home",
            "else: prompt evaluator/1 on the tape, evaluator/2 now",
        ),
        ({"temperature": 0.7}, "fake:model at home", "temperature 0.0 on the tape, 0.7 now"),
        ({"seed": 3}, "fake:model at home", "seed 0 on the tape, 3 now"),
        ({}, "fake:other", "model fake:model at home on the tape, fake:other now"),
        ({"system": "You rate."}, "fake:model at home", "instructions differ under the same version"),
        ({"user": "a wall"}, "fake:model at home", "text of the question differs"),
        ({"images": (b"png",)}, "fake:model at home", "pictures differ"),
        ({"key": (9, 9)}, "fake:model at home", "the evaluator about scene 9/9 was not asked anything"),
        ({"role": "checker"}, "fake:model at home", "the checker about scene 1/0/0 was not asked anything"),
    ],
)
def test_what_misses_the_tape_says_what_differs_and_asks_no_model(
    changed: dict[str, Any], fingerprint: str, said: str, tmp_path: Path
) -> None:
    with TapeRecorder(tmp_path / "tape") as tape:
        run(FakeModel(), ask(question(1, 0, 0)), tape=tape)
    other = FakeModel(fingerprint=fingerprint)
    mission = ask(question(1, 0, 0, **changed))
    (answer,), ledger, caller = run(other, mission, tape=TapePlayer(tmp_path / "tape"))
    assert answer.fault is not None
    assert said in answer.fault
    assert other.asked == []
    assert caller.end == (MissionEnd.FAULT, answer.fault)
    assert [call.fault for call in ledger.calls] == [answer.fault]


def test_a_question_asked_more_often_than_on_the_tape_misses_it(tmp_path: Path) -> None:
    with TapeRecorder(tmp_path / "tape") as tape:
        run(FakeModel(), ask(question()), tape=tape)
    answers, _, _ = run(FakeModel(), ask(question(), question()), tape=TapePlayer(tmp_path / "tape"))
    assert answers[0].fault is None
    assert "less often" in (answers[1].fault or "")


def test_a_call_that_was_cancelled_then_and_is_waited_for_now_misses_the_tape(tmp_path: Path) -> None:
    model = FakeModel(delay_s=lambda request: 3600.0 if request.role == "visionary" else 0.005)
    with TapeRecorder(tmp_path / "tape") as tape:
        run(model, _found_while_imagining, tape=tape)
    (answer,), _, caller = run(model, ask(question(0, 0, 0, role="visionary")), tape=TapePlayer(tmp_path / "tape"))
    assert "was cancelled after" in (answer.fault or "")
    assert caller.end is not None


def test_a_process_that_was_killed_leaves_a_tape_that_can_be_replayed(tmp_path: Path) -> None:
    program = f"""
import asyncio, sys
from reasoned_explorer.calls.caller import Caller
from reasoned_explorer.calls.ledger import Ledger
from reasoned_explorer.calls.tape import TapeRecorder
from reasoned_explorer.clock import MixedClock
from tests.calls.fakes import FakeModel, question
clock = MixedClock()
model = FakeModel(delay_s=lambda request: 3600.0 if request.key == (3,) else 0.001)
async def mission():
    for step in range(9):
        await caller.ask(question(step))
        print(step, flush=True)
caller = Caller(model, clock=clock, ledger=Ledger(), tape=TapeRecorder({str(tmp_path / "tape")!r}))
clock.run(mission())
"""
    with subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert [process.stdout.readline() for _ in range(3)] == ["0\n", "1\n", "2\n"]
        process.kill()
    with (tmp_path / "tape").open("ab") as file:
        file.write(b'{"call":{"asked":3,"ro')  # as if it had been killed while it wrote
    player = TapePlayer(tmp_path / "tape")
    assert not player.complete
    answers, _, _ = run(FakeModel(), ask(*(question(step) for step in range(4))), tape=player)
    assert [answer.text for answer in answers[:3]] == [f"evaluator says scene ({step},)" for step in range(3)]
    assert "the tape was cut off" in (answers[3].fault or "")


# Cache.


def test_a_cached_answer_costs_nothing_and_is_charged_its_original_seconds(tmp_path: Path) -> None:
    model, cache = FakeModel(), AnswerCache(tmp_path / "cache")
    first, paid, _ = run(model, ask(question(1, 0, 0)), cache=cache)
    # The same text about another scene, asked by another role, is the same question.
    second, free, _ = run(model, ask(question(2, 0, 0, role="checker", text="scene (1, 0, 0)")), cache=cache)
    assert second[0].text == first[0].text
    assert len(model.asked) == 1
    (one,), (other,) = paid.calls, free.calls
    assert other == CallRecord("checker", "fake:model", (2, 0, 0), 0.0, one.latency_s, cached=True)


def test_another_prompt_setting_or_model_is_another_question(tmp_path: Path) -> None:
    cache = AnswerCache(tmp_path / "cache")
    variants = [
        question(),
        question(prompt="evaluator/2"),
        question(seed=1),
        question(max_tokens=9),
        question(system="Be strict."),
        question(images=(b"png",)),
        question(images=(b"p", b"ng")),
        question(schema={"type": "object"}),
        question(top_logprobs=5),
    ]
    model, other = FakeModel(), FakeModel(fingerprint="fake:other")
    run(model, ask(*variants), cache=cache)
    run(other, ask(question()), cache=cache)
    assert len(cache) == len(variants) + 1
    run(model, ask(*variants), cache=cache)
    assert len(model.asked) == len(variants)


def test_faults_are_never_cached_and_samples_only_if_wanted(tmp_path: Path) -> None:
    cache, samples = AnswerCache(tmp_path / "cache", sampled=False), AnswerCache(tmp_path / "samples")
    run(FakeModel(lambda _: ChatAnswer(fault="500")), ask(question()), cache=cache)
    drawn = question(temperature=0.7)
    run(FakeModel(), ask(drawn), cache=cache)
    assert len(cache) == 0
    run(FakeModel(), ask(drawn), cache=samples)
    assert len(samples) == 1


# Budget.


def test_when_the_budget_is_spent_no_new_call_begins_and_the_mission_is_told_to_end(tmp_path: Path) -> None:
    model, budget = FakeModel(), Budget(usd=0.045)

    async def one_by_one(caller: Caller, _: Clock) -> list[str | None]:
        return [(await caller.ask(question(step))).fault for step in range(6)]

    with TapeRecorder(tmp_path / "tape") as tape:
        faults, ledger, caller = run(model, one_by_one, budget=budget, tape=tape)
    assert len(model.asked) == 4  # 0.01 each: a fifth would be too much
    assert faults[:4] == [None] * 4
    assert faults[4] == faults[5] == "the budget of 0.045 US dollars is spent (0.0400, a call may cost 0.0100)"
    assert caller.end == (MissionEnd.BUDGET_SPENT, faults[4])
    assert end_of([Caller(model, clock=MixedClock(), ledger=Ledger()), caller])() == caller.end
    assert [call.latency_s for call in ledger.calls[4:]] == [0.0, 0.0]
    # It ends in the same way from the tape, whatever budget there is.
    again, ledger_again, replayed = run(FakeModel(), one_by_one, tape=TapePlayer(tmp_path / "tape"))
    assert (again, ledger_again.calls, replayed.end) == (faults, ledger.calls, caller.end)


def test_a_mission_that_ran_out_of_money_goes_on_from_the_cache(tmp_path: Path) -> None:
    cache = AnswerCache(tmp_path / "cache")
    model = FakeModel()
    requests = [question(step) for step in range(6)]
    run(model, ask(*requests[:4]), budget=Budget(usd=1.0), cache=cache)
    answers, _, caller = run(model, ask(*requests), budget=Budget(usd=0.025), cache=cache)
    assert caller.end is None
    assert all(answer.fault is None for answer in answers)
    assert len(model.asked) == 6


def test_a_call_on_a_virtual_clock_is_refused_but_not_what_is_cached(tmp_path: Path) -> None:
    cache = AnswerCache(tmp_path / "cache")
    run(FakeModel(), ask(question()), cache=cache)
    answers, _, _ = run(FakeModel(), ask(question()), cache=cache, clock=VirtualClock())
    assert answers[0].fault is None
    with pytest.raises(SettingsError, match="mixed or a real clock"):
        run(FakeModel(), ask(question()), clock=VirtualClock())


# Keys.


def test_a_key_is_written_nowhere(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    key = "sk-planted-0123456789"
    monkeypatch.setenv("SOME_VENDOR_API_KEY", key)

    def leaky(request: ChatRequest) -> ChatAnswer:
        if request.key == (0,):
            return ChatAnswer(fault=f"401: wrong key {key}", model=f"m-{key}")
        if request.key == (1,):
            raise ConnectionError(f"https://user:{key}@host refused")
        return ChatAnswer(f"You sent {key}.", tokens=(TokenChoice(key, ((key, -0.1),)),))

    requests = [question(step, text=f"{step}: what is {key}?") for step in range(3)]
    cache, model = AnswerCache(tmp_path / "cache"), FakeModel(leaky, fingerprint=f"fake at {key}")
    with TapeRecorder(tmp_path / "tape", about={"goal": f"find {key}"}) as tape:
        answers, ledger, caller = run(model, ask(*requests), cache=cache, tape=tape)
    replayed, _, _ = run(model, ask(*requests, question(7)), tape=TapePlayer(tmp_path / "tape"))
    assert [answer.fault is None for answer in replayed] == [False, False, True, False]
    shown = repr([answers, replayed, ledger.calls, ledger.totals(), vars(caller)["end"]])
    files = [path for path in tmp_path.iterdir() if path.is_file()]
    assert {path.name for path in files} >= {"cache", "tape"}
    for written in (shown, *capfd.readouterr(), *(path.read_bytes().decode("latin1") for path in files)):
        assert key not in written
    assert "[key hidden]" in shown
