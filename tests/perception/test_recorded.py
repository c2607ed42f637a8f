"""A model on this machine behind a caller: a view is a call, a look a batch, and a tape gives the same again."""

import asyncio
from collections.abc import Callable, Sequence
from pathlib import Path

from reasoned_explorer.calls.caller import CANCELLED, Caller
from reasoned_explorer.calls.chat import ChatAnswer, ChatRequest
from reasoned_explorer.calls.ledger import Ledger
from reasoned_explorer.calls.local import LocalModel, LocalSettings
from reasoned_explorer.calls.tape import TapePlayer, TapeRecorder
from reasoned_explorer.clock import MixedClock
from reasoned_explorer.model import Undescribed
from reasoned_explorer.perception.caption_prompt import caption_prompt
from reasoned_explorer.perception.prompted import PromptedCaptioner
from tests.perception.test_prompted import GOAL, view

Told = Sequence[str | Undescribed]


class NeverAsked:
    """Stands for a model that a tape is played instead of."""

    is_local = True

    def __init__(self, model: LocalModel) -> None:
        self.name, self.fingerprint = model.name, model.fingerprint

    async def ask(self, request: ChatRequest) -> ChatAnswer:
        raise AssertionError(request)


def test_a_look_is_one_batch_three_calls_and_the_same_again_from_a_tape(
    local: Callable[..., LocalModel], tmp_path: Path
) -> None:
    model = local("kosmos-2", LocalSettings(most=3, linger_s=1.0))
    ledgers: list[Ledger] = []

    def mission(model: LocalModel | NeverAsked, tape: TapeRecorder | TapePlayer) -> tuple[Told, float]:
        clock = MixedClock()
        ledgers.append(Ledger())
        caller = Caller(model, clock=clock, ledger=ledgers[-1], tape=tape)
        captioner = PromptedCaptioner(caller, name=model.name, prompt=caption_prompt("kosmos-2"), lossless=True)

        async def look() -> tuple[Told, float]:
            told = await captioner.describe(GOAL, [view(number) for number in range(3)])
            return told, clock.now_s()

        return clock.run(look())

    before = len(model.batches)
    with TapeRecorder(tmp_path / "tape") as tape:
        recorded = mission(model, tape)
    assert model.batches[before:] == [3]
    assert mission(NeverAsked(model), TapePlayer(tmp_path / "tape")) == recorded
    for ledger in ledgers:
        assert sorted(call.key for call in ledger.calls) == [(7, 0, 0), (7, 0, 1), (7, 0, 2)]
        assert all(call.role == "caption" and call.fault is None and call.tokens_in > 60 for call in ledger.calls)
    assert 0.0 < recorded[1] == max(call.latency_s for call in ledgers[0].calls)


def test_a_look_that_is_given_up_is_written_down_and_the_model_is_free_again(local: Callable[..., LocalModel]) -> None:
    model = local("llama")
    clock, ledger = MixedClock(), Ledger()
    caller = Caller(model, clock=clock, ledger=ledger)
    long, short = (
        ChatRequest("visionary", (0,), "", "What is there?", "test/1", max_tokens=tokens) for tokens in (3000, 2)
    )

    async def mission() -> ChatAnswer:
        task = asyncio.ensure_future(caller.ask(long))
        await clock.act(0.05)
        task.cancel()
        await asyncio.wait([task])
        return await caller.ask(short)

    assert clock.run(mission()).fault is None
    assert [call.fault for call in ledger.calls] == [CANCELLED, None]
