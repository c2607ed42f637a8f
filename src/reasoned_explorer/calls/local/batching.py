"""Questions that arrive together are answered together.

A model on a graphics card takes hardly longer for eight pictures than for one, but whoever asks does so call by call,
so that each call is written down, stored and replayed by itself. So one thread takes what has arrived, waits a moment
for what comes with it, and hands the model one batch.
"""

import contextlib
import queue
import threading
import time
from asyncio import CancelledError, wrap_future
from collections.abc import Callable, Hashable, Sequence
from concurrent.futures import Future, InvalidStateError
from dataclasses import dataclass, field

from reasoned_explorer.calls.chat import ChatAnswer, ChatRequest


@dataclass(frozen=True, slots=True, eq=False)
class Job:
    """One question that waits for its answer.

    Attributes:
        request: The question.
        gone: Set when nobody waits for the answer any more.
    """

    request: ChatRequest
    gone: threading.Event = field(default_factory=threading.Event)
    _answer: Future[ChatAnswer] = field(default_factory=Future)

    async def wait(self) -> ChatAnswer:
        """Return the answer; being cancelled tells whoever works on it."""
        try:
            return await wrap_future(self._answer)
        except CancelledError:
            self.gone.set()
            raise

    def settle(self, answer: ChatAnswer) -> None:
        """Give the answer, which nobody may want any more."""
        with contextlib.suppress(InvalidStateError):
            self._answer.set_result(answer)


class Batcher:
    """Gathers questions into batches, for one thread that answers them.

    It may be asked from any event loop. The thread starts with the first question, so that a process can be forked
    before.

    Args:
        answer: Answers a batch, one answer for each job, in order. Called in the thread; it should stop early where
            jobs are gone.
        alike: Questions with equal values may be answered in one batch; None is answered alone.
        most: At most so many in a batch.
        linger_s: Nothing having arrived for so long, seconds, what has is complete.
    """

    def __init__(
        self,
        answer: Callable[[Sequence[Job]], Sequence[ChatAnswer]],
        *,
        alike: Callable[[ChatRequest], Hashable | None],
        most: int = 16,
        linger_s: float = 0.01,
    ) -> None:
        self._answer, self._alike, self._most, self._linger_s = answer, alike, most, linger_s
        self._jobs: queue.SimpleQueue[Job | None] = queue.SimpleQueue()
        self._thread: threading.Thread | None = None
        self._lock = threading.Lock()
        self._closed = False

    async def ask(self, request: ChatRequest) -> ChatAnswer:
        """Return the answer to a question; cancelling it takes it out of its batch."""
        job = Job(request)
        if not self._accept(job):
            return ChatAnswer(fault="the model on this machine was closed")
        return await job.wait()

    def close(self) -> None:
        """End the thread; what waits still is answered first."""
        with self._lock:
            self._closed = True
            thread = self._thread
            if thread is not None:
                self._jobs.put(None)
        if thread is not None:
            thread.join()

    def _accept(self, job: Job) -> bool:
        with self._lock:
            if self._closed:
                return False
            if self._thread is None:
                self._thread = threading.Thread(target=self._work, name="local model", daemon=True)
                self._thread.start()
            self._jobs.put(job)
            return True

    def _work(self) -> None:
        waiting: list[Job] = []
        closing = False
        while not closing or waiting:
            closing = self._gather(waiting, closing=closing)
            waiting = [job for job in waiting if not job.gone.is_set()]
            if waiting:
                batch = self._first_batch(waiting)
                self._settle(batch)
                waiting = [job for job in waiting if job not in batch]

    def _gather(self, waiting: list[Job], *, closing: bool) -> bool:
        """Take what arrives until there is a full batch or a pause; return whether the thread shall end."""
        # Whatever waits already had its moment: it is not held up any further.
        until_s = 0.0
        while not closing and len(waiting) < self._most:
            try:
                job = self._jobs.get(timeout=max(0.0, until_s - time.monotonic()) if waiting else None)
            except queue.Empty:
                break
            closing = job is None
            if job is not None:
                waiting.append(job)
                until_s = time.monotonic() + self._linger_s
        return closing

    def _first_batch(self, waiting: Sequence[Job]) -> list[Job]:
        kind = self._alike(waiting[0].request)
        if kind is None:
            return [waiting[0]]
        return [job for job in waiting if self._alike(job.request) == kind][: self._most]

    def _settle(self, batch: Sequence[Job]) -> None:
        try:
            for job, answer in zip(batch, self._answer(batch), strict=True):
                job.settle(answer)
        except Exception as error:  # noqa: BLE001 - whatever a model does is an answer with a fault, never a lost call
            fault = f"the model on this machine failed: {type(error).__name__}: {error}"
            for job in batch:
                job.settle(ChatAnswer(fault=fault))
