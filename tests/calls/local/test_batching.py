"""What is asked together is answered together, and nobody waits for ever."""

import asyncio
import threading
from collections.abc import Sequence

from reasoned_explorer.calls.chat import ChatAnswer, ChatRequest
from reasoned_explorer.calls.local.batching import Batcher, Job


def question(text: str) -> ChatRequest:
    return ChatRequest("caption", (0, 0, 0), "", text, "test/1")


class Echo:
    """Answers with the question and keeps the batches; holds the first one up until it is let go."""

    def __init__(self) -> None:
        self.batches: list[list[str]] = []
        self.started, self.let_go = threading.Event(), threading.Event()

    def __call__(self, batch: Sequence[Job]) -> Sequence[ChatAnswer]:
        self.batches.append([job.request.user for job in batch])
        self.started.set()
        assert self.let_go.wait(30.0)
        return [ChatAnswer(job.request.user) for job in batch]


def same(_request: ChatRequest) -> str:
    return "same"


def first_letter(request: ChatRequest) -> str | None:
    return None if request.user.startswith("alone") else request.user[0]


async def asked_while_busy(echo: Echo, batcher: Batcher, texts: Sequence[str]) -> list[asyncio.Task[ChatAnswer]]:
    """Ask one question, and the others while it is being answered."""
    first = asyncio.ensure_future(batcher.ask(question("first")))
    await asyncio.to_thread(echo.started.wait, 30.0)
    others = [asyncio.ensure_future(batcher.ask(question(text))) for text in texts]
    await asyncio.sleep(0)  # each has asked by now
    return [first, *others]


def test_questions_that_arrive_together_are_one_batch() -> None:
    echo = Echo()
    echo.let_go.set()
    # The three of a batch make it full, so that it is not waited for any more, however long one would.
    batcher = Batcher(echo, alike=same, most=3, linger_s=60.0)

    async def ask() -> list[ChatAnswer]:
        return await asyncio.gather(*(batcher.ask(question(text)) for text in ("a", "b", "c")))

    assert [answer.text for answer in asyncio.run(ask())] == ["a", "b", "c"]
    assert echo.batches == [["a", "b", "c"]]


def test_what_arrives_while_the_model_is_busy_waits_for_the_next_batch() -> None:
    echo = Echo()
    batcher = Batcher(echo, alike=same, linger_s=0.0)

    async def ask() -> list[ChatAnswer]:
        tasks = await asked_while_busy(echo, batcher, ["a", "b"])
        echo.let_go.set()
        return await asyncio.gather(*tasks)

    assert [answer.text for answer in asyncio.run(ask())] == ["first", "a", "b"]
    assert echo.batches == [["first"], ["a", "b"]]


def test_questions_of_different_kinds_share_no_batch() -> None:
    echo = Echo()
    batcher = Batcher(echo, alike=first_letter, linger_s=0.0)

    async def ask() -> list[ChatAnswer]:
        tasks = await asked_while_busy(echo, batcher, ["x1", "y1", "x2", "alone 1", "alone 2"])
        echo.let_go.set()
        return await asyncio.gather(*tasks)

    asyncio.run(ask())
    assert echo.batches == [["first"], ["x1", "x2"], ["y1"], ["alone 1"], ["alone 2"]]


def test_a_cancelled_question_is_not_answered_and_one_under_way_is_told() -> None:
    echo = Echo()
    running: list[Job] = []

    def answer(batch: Sequence[Job]) -> Sequence[ChatAnswer]:
        running.extend(batch)
        return echo(batch)

    batcher = Batcher(answer, alike=same, linger_s=0.0)

    async def ask() -> list[ChatAnswer | BaseException]:
        tasks = await asked_while_busy(echo, batcher, ["a", "b"])
        tasks[0].cancel()
        tasks[1].cancel()
        await asyncio.wait(tasks[:2])
        assert running[0].gone.is_set()
        echo.let_go.set()
        return await asyncio.gather(*tasks, return_exceptions=True)

    first, cancelled, answered = asyncio.run(ask())
    assert isinstance(first, asyncio.CancelledError)
    assert isinstance(cancelled, asyncio.CancelledError)
    assert answered == ChatAnswer("b")
    assert echo.batches == [["first"], ["b"]]


def test_a_model_that_breaks_is_a_fault_and_is_asked_again() -> None:
    def answer(batch: Sequence[Job]) -> Sequence[ChatAnswer]:
        if batch[0].request.user == "bad":
            raise RuntimeError("device lost")
        return [ChatAnswer("well")] * (2 if batch[0].request.user == "too many" else 1)

    batcher = Batcher(answer, alike=same, linger_s=0.0)

    async def ask(text: str) -> ChatAnswer:
        return await asyncio.wait_for(batcher.ask(question(text)), 30.0)

    assert "device lost" in str(asyncio.run(ask("bad")).fault)
    assert asyncio.run(ask("too many")).text == "well"
    assert asyncio.run(ask("good")) == ChatAnswer("well")


def test_a_closed_model_answers_what_waits_and_then_nothing_more() -> None:
    echo = Echo()
    batcher = Batcher(echo, alike=same, linger_s=0.0)

    async def ask() -> list[ChatAnswer]:
        tasks = await asked_while_busy(echo, batcher, ["a"])
        closing = asyncio.ensure_future(asyncio.to_thread(batcher.close))
        echo.let_go.set()
        await closing
        return [*await asyncio.gather(*tasks), await batcher.ask(question("late"))]

    first, waiting, late = asyncio.run(ask())
    assert (first.text, waiting.text) == ("first", "a")
    assert late.fault == "the model on this machine was closed"
