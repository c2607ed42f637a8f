"""The one way to a model: from the tape, from the cache, or for real; each call charged, counted and kept."""

import asyncio
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace

from reasoned_explorer.calls.budget import Budget
from reasoned_explorer.calls.cache import AnswerCache, StoredAnswer
from reasoned_explorer.calls.chat import ChatAnswer, ChatModel, ChatRequest
from reasoned_explorer.calls.ledger import CallRecord, Ledger
from reasoned_explorer.calls.prices import Price
from reasoned_explorer.calls.secrets import scrubbed
from reasoned_explorer.calls.stored import RequestParts, parts_of
from reasoned_explorer.calls.tape import Miss, Outcome, TapedCall, TapePlayer, TapeRecorder
from reasoned_explorer.clock import Clock
from reasoned_explorer.model.errors import PartError
from reasoned_explorer.model.record import MissionEnd

#: Kinds of faults that are of the way to a model and not of an answer (`openai_model`).
_ON_THE_WAY = frozenset({"connection", "timeout", "server error", "no access", "quota", "rate limit"})
#: After so many lost in a row, each of them tried several times, a model is gone.
_GONE = 20
#: What a picture may well take.
_TOKENS_A_PICTURE = 1000
#: The fault of a call that nobody waited for.
CANCELLED = "cancelled"
#: A replayed call that was cancelled then is cancelled at the same time now. If it is not by so much later, seconds,
#: this is another run.
_GRACE_S = 1.0


@dataclass(frozen=True, slots=True)
class _Asked:
    """A call that is under way."""

    request: ChatRequest
    parts: RequestParts
    number: int
    started_s: float


class Caller:
    """Asks a model on a mission's clock, whatever the answer comes from.

    A question goes to the tape that is replayed, and if there is one nowhere else; then to the tape of an earlier part
    of the same mission; then to the cache; then, if the budget allows, to the model. The mission is charged the seconds
    that the answer took when it came from the model. Every call has its line in the ledger, cancelled ones, too, in the
    order in which they end.

    Args:
        model: Who answers.
        clock: The mission's.
        ledger: The mission's.
        cache: Of answers that are to be used again; faults are never kept.
        tape: To write calls to, or to take all answers from.
        past: The calls of an earlier part of this mission, which ended early: what was answered then is paid and
            written down already.
        budget: Of the run.

    Attributes:
        model: Who answers.
        is_gone: So many calls in a row were lost that the model must be gone.
        end: How the mission must end, and why, or None: the budget is spent, or the tape is of another mission. Answers
            from then on are faults, so that whoever asks comes to an end (`end_of`).
    """

    def __init__(
        self,
        model: ChatModel,
        *,
        clock: Clock,
        ledger: Ledger,
        cache: AnswerCache | None = None,
        tape: TapeRecorder | TapePlayer | None = None,
        past: TapePlayer | None = None,
        budget: Budget | None = None,
    ) -> None:
        self.model = model
        self.is_gone = False
        self.end: tuple[MissionEnd, str] | None = None
        self._clock, self._ledger = clock, ledger
        self._cache, self._budget = cache, budget
        self._player = tape if isinstance(tape, TapePlayer) else None
        self._recorder = tape if isinstance(tape, TapeRecorder) else None
        self._past = past
        self._lost_in_a_row = 0

    def record_to(self, recorder: TapeRecorder) -> None:
        """Write every call to a tape from now on."""
        self._recorder = recorder

    async def ask(self, request: ChatRequest) -> ChatAnswer:
        """Return the answer, at the mission time when it is there. What goes wrong is a fault in it.

        Raises:
            SettingsError: If the model would have to be asked on a virtual clock.
            RecordWriteError: If the tape cannot be written.
        """
        if self._player is not None:
            return await self._replayed(self._player, request)
        if self._past is not None:
            played = self._past.play(self.model.fingerprint, request)
            if isinstance(played, TapedCall) and played.outcome is Outcome.ANSWERED:
                return await self._repeated(played, request)
        number = 0 if self._recorder is None else self._recorder.next_number()
        asked = _Asked(request, parts_of(self.model.fingerprint, request), number, self._clock.now_s())
        cache = self._cache if self._cache is not None and self._cache.takes(request) else None
        stored = None if cache is None else cache.get(asked.parts.digest)
        if stored is not None:
            return await self._cached(asked, stored)
        refusal = None if self._budget is None else self._budget.begin(self._most_usd(request))
        if refusal is not None:
            self._must_end(MissionEnd.BUDGET_SPENT, refusal)
            return self._close(asked, ChatAnswer(fault=refusal), 0.0, outcome=Outcome.DENIED)
        answer, seconds = await self._live(asked)
        self._see_whether_it_is_gone(answer)
        if cache is not None and answer.fault is None:
            cache.put(asked.parts.digest, StoredAnswer(answer, seconds), model=self.model.name, prompt=request.prompt)
        return self._close(asked, answer, seconds)

    def _see_whether_it_is_gone(self, answer: ChatAnswer) -> None:
        """End the mission once so many calls in a row were lost on the way that nobody can be there any more."""
        is_lost = answer.fault is not None and answer.fault.partition(":")[0] in _ON_THE_WAY
        self._lost_in_a_row = self._lost_in_a_row + 1 if is_lost else 0
        if self._lost_in_a_row >= _GONE:
            self.is_gone = True
            self._must_end(MissionEnd.FAULT, f"{self.model.name} does not answer any more: {answer.fault}")

    def _most_usd(self, request: ChatRequest) -> float:
        """Return what a call may well cost: three letters a token, and an answer of full length."""
        price: Price | None = getattr(self.model, "price", None)
        if price is None:
            return 0.0
        letters = len(request.system) + len(request.user)
        return price.usd(letters // 3 + _TOKENS_A_PICTURE * len(request.images), request.max_tokens)

    async def _live(self, asked: _Asked) -> tuple[ChatAnswer, float]:
        come: list[ChatAnswer] = []

        async def call() -> ChatAnswer:
            come.append(await self._asked(asked.request))
            return come[0]

        ended, answered = ChatAnswer(usd=None), False
        try:
            ended, seconds = await self._clock.live(call)
            answered = ended.fault is None
        except asyncio.CancelledError:
            # The model may have answered by now, later on the mission's clock: then its cost is known.
            ended = come[0] if come else ended
            self._close(asked, ended, self._since(asked), outcome=Outcome.CANCELLED)
            raise
        except PartError as error:
            ended, seconds = scrubbed(ChatAnswer(fault=str(error), usd=None)), self._since(asked)
        finally:
            if self._budget is not None:
                self._budget.end(ended.usd, model=self.model.name, answered=answered)
        return ended, seconds

    async def _asked(self, request: ChatRequest) -> ChatAnswer:
        """Ask the model; it runs in the live loop."""
        try:
            answer = await self.model.ask(request)
        except Exception as error:  # noqa: BLE001 - whatever a model and its libraries throw, the mission goes on
            answer = ChatAnswer(fault=f"the model failed: {type(error).__name__}: {error}", usd=None)
        if not isinstance(answer, ChatAnswer):
            answer = ChatAnswer(fault=f"the model failed: it returned a {type(answer).__name__}", usd=None)
        return scrubbed(answer)

    async def _cached(self, asked: _Asked, stored: StoredAnswer) -> ChatAnswer:
        # Nothing was sent and nothing is to be paid.
        answer = replace(stored.answer, usd=0.0, tokens_in=0, tokens_out=0, retries=0)
        try:
            await self._clock.think(stored.seconds)
        except asyncio.CancelledError:
            self._close(asked, answer, self._since(asked), outcome=Outcome.CANCELLED, cached=True)
            raise
        return self._close(asked, answer, stored.seconds, cached=True)

    async def _repeated(self, played: TapedCall, request: ChatRequest) -> ChatAnswer:
        """Answer as in the part of the mission that came before; it costs the same time and is the same expense."""
        asked = _Asked(request, played.parts, played.asked, self._clock.now_s())
        try:
            await self._clock.think(played.seconds)
        except asyncio.CancelledError:
            self._close(
                asked,
                played.answer,
                self._since(asked),
                outcome=Outcome.CANCELLED,
                cached=played.cached,
                is_taped=True,
            )
            raise
        return self._close(asked, played.answer, played.seconds, cached=played.cached, is_taped=True)

    async def _replayed(self, player: TapePlayer, request: ChatRequest) -> ChatAnswer:
        played = player.play(self.model.fingerprint, request)
        asked = _Asked(request, parts_of(self.model.fingerprint, request), 0, self._clock.now_s())
        if isinstance(played, Miss):
            return self._not_replayed(asked, played.reason)
        if played.outcome is Outcome.DENIED:
            self._must_end(MissionEnd.BUDGET_SPENT, played.answer.fault or "")
            return self._close(asked, played.answer, 0.0, outcome=Outcome.DENIED)
        cancelled = played.outcome is Outcome.CANCELLED
        try:
            await self._clock.think(played.seconds + (_GRACE_S if cancelled else 0.0))
        except asyncio.CancelledError:
            self._close(asked, played.answer, self._since(asked), outcome=Outcome.CANCELLED, cached=played.cached)
            raise
        if cancelled:
            return self._not_replayed(
                asked, f"{player.path} holds no answer to this: the call was cancelled after {played.seconds:.3f} s"
            )
        return self._close(asked, played.answer, played.seconds, cached=played.cached)

    def _not_replayed(self, asked: _Asked, reason: str) -> ChatAnswer:
        answer = scrubbed(ChatAnswer(fault=f"replay: {reason}"))
        self._must_end(MissionEnd.FAULT, answer.fault or "")
        return self._close(asked, answer, self._since(asked))

    def _must_end(self, end: MissionEnd, reason: str) -> None:
        if self.end is None:
            self.end = end, reason

    def _since(self, asked: _Asked) -> float:
        return self._clock.now_s() - asked.started_s

    def _close(
        self,
        asked: _Asked,
        answer: ChatAnswer,
        seconds: float,
        *,
        outcome: Outcome = Outcome.ANSWERED,
        cached: bool = False,
        is_taped: bool = False,
    ) -> ChatAnswer:
        """Write a call that has ended to the ledger and, unless it is there already, to the tape."""
        request = asked.request
        self._ledger.add(
            CallRecord(
                request.role,
                self.model.name,
                tuple(request.key),
                asked.started_s,
                seconds,
                answer.tokens_in,
                answer.tokens_out,
                answer.usd,
                cached,
                answer.retries,
                CANCELLED if outcome is Outcome.CANCELLED else answer.fault,
            )
        )
        if self._recorder is not None and not is_taped:
            call = TapedCall(
                asked.number,
                request.role,
                tuple(request.key),
                asked.parts.digest,
                asked.parts,
                outcome,
                seconds,
                answer,
                cached,
            )
            self._recorder.add(call)
        return answer


def end_of(callers: Iterable[Caller]) -> Callable[[], tuple[MissionEnd, str] | None]:
    """Return what tells whether a mission must end, by any of its callers: for `exploration.explorer.Parts`."""
    all_callers = tuple(callers)
    return lambda: next((caller.end for caller in all_callers if caller.end is not None), None)
