"""A model on this machine, asked like any other."""

from collections.abc import Hashable, Sequence

from reasoned_explorer.calls.chat import ChatAnswer, ChatRequest
from reasoned_explorer.calls.local.batching import Batcher, Job
from reasoned_explorer.calls.local.generating import Generator


class LocalModel:
    """A `ChatModel` of weights on this machine; nothing that it is asked leaves it.

    Questions that arrive together are answered in one batch: all views of a look, all scenes of a decision. Which
    questions share a batch can change the last digits of what a model computes, and so, rarely, a word; whoever wants
    the same mission twice records it.

    It cannot be made to keep to a JSON schema: it is asked for plain text, or tries.

    Args:
        generator: Holds the model.
        name: As typed, e.g. ``"hf:microsoft/kosmos-2-patch14-224"``.
        fingerprint: Of the weights and how they are run.
        family: What transformers calls the kind of model, e.g. ``"kosmos-2"``.
        sees: It reads pictures.
        only_describes: It describes pictures and does nothing else: no question without one, no instructions.
        most: Questions in a batch, at most.
        linger_s: Nothing more having arrived for so long, seconds, a batch is complete.
    """

    is_local = True

    def __init__(
        self,
        generator: Generator,
        *,
        name: str,
        fingerprint: str,
        family: str,
        sees: bool,
        only_describes: bool = False,
        most: int = 16,
        linger_s: float = 0.01,
    ) -> None:
        self.name, self.fingerprint, self.family, self.sees = name, fingerprint, family, sees
        self.only_describes = only_describes
        self.device = str(generator.model.device)
        #: How many questions each batch held so far.
        self.batches: list[int] = []
        self._generator = generator
        self._batcher = Batcher(self._answer, alike=alike, most=most, linger_s=linger_s)

    async def ask(self, request: ChatRequest) -> ChatAnswer:
        """Return the answer. Whatever goes wrong is a fault in it; cancelling it ends the call."""
        return await self._batcher.ask(request)

    def close(self) -> None:
        """Answer what waits, then nothing more."""
        self._batcher.close()

    def _answer(self, batch: Sequence[Job]) -> list[ChatAnswer]:
        self.batches.append(len(batch))
        return self._generator.answer(batch)


def alike(request: ChatRequest) -> Hashable | None:
    """Return what questions of one batch have in common; None for a question that is answered alone.

    Where answers are sampled, one question's draws would depend on the others beside it.
    """
    return None if request.temperature > 0.0 else ("pictures", len(request.images) > 0)
