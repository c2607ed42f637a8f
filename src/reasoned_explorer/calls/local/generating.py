"""One batch of questions through a model, word by word.

Whoever gives up is let go: a row whose asker is gone, or whose answer is as long as it may be, ends by itself, and the
batch ends with its last row.
"""

from collections.abc import Mapping, Sequence
from typing import Any

from reasoned_explorer.calls.chat import ChatAnswer, TokenChoice
from reasoned_explorer.calls.local.batching import Job
from reasoned_explorer.calls.local.coding import Coder


class Generator:
    """Answers batches with a model of transformers.

    Args:
        model: With ``generate``; on its device.
        coder: Of its kind.
        name: What answers are said to come from.
    """

    def __init__(self, model: Any, coder: Coder, *, name: str) -> None:
        self.model, self.coder, self._name = model, coder, name
        text_config = model.config.get_text_config()
        positions = getattr(text_config, "max_position_embeddings", None)
        #: Tokens of a question and its answer together, at most; None where the model does not say.
        self.most_tokens: int | None = positions if isinstance(positions, int) and positions > 0 else None
        self._ends = _ends_of(model, coder.tokenizer)

    def answer(self, batch: Sequence[Job]) -> list[ChatAnswer]:
        """Return the answers to questions that are alike (see `alike`), in order."""
        refusals = [self.coder.refusal(job.request) for job in batch]
        asked = [job for job, refusal in zip(batch, refusals, strict=True) if refusal is None]
        told = iter(self._answered(asked) if asked else [])
        return [next(told) if refusal is None else self._fault(refusal) for refusal in refusals]

    def _answered(self, asked: Sequence[Job]) -> list[ChatAnswer]:
        try:
            return self._generate(asked)
        except Exception as error:  # noqa: BLE001 - whatever a model does is an answer with a fault
            fault = f"{type(error).__name__}: {' '.join(str(error).split())[:200]}"
        # Out here the error is gone, and with it what it held of the device's memory.
        if len(asked) == 1:
            return [self._fault(fault)]
        # Too much for the memory together, or one broken picture that must not cost the others their answers.
        middle = len(asked) // 2
        return self._answered(asked[:middle]) + self._answered(asked[middle:])

    def _fault(self, fault: str) -> ChatAnswer:
        return ChatAnswer(fault=fault, model=self._name)

    def _generate(self, asked: Sequence[Job]) -> list[ChatAnswer]:
        import torch
        from transformers import LogitsProcessorList, StoppingCriteriaList

        inputs = self._moved(self.coder.encode([job.request for job in asked]))
        lengths = inputs["attention_mask"].sum(dim=1).tolist()
        width = inputs["input_ids"].shape[1]
        room = [self._room(job, int(length)) for job, length in zip(asked, lengths, strict=True)]
        if any(fault is not None for fault in room):
            fitting = [job for job, fault in zip(asked, room, strict=True) if fault is None]
            told = iter(self._generate(fitting) if fitting else [])
            return [next(told) if fault is None else self._fault(fault) for fault in room]
        request = asked[0].request
        choices = _Choices(max(job.request.top_logprobs for job in asked))
        limits = [job.request.max_tokens for job in asked]
        sampling = {"temperature": request.temperature} if request.temperature > 0.0 else {"temperature": None}
        device = self.model.device
        with torch.inference_mode(), torch.random.fork_rng([device] if device.type == "cuda" else []):
            torch.manual_seed(request.seed)
            sequences = self.model.generate(
                **inputs,
                **sampling,
                do_sample=request.temperature > 0.0,
                top_p=None,
                top_k=None,
                num_beams=1,
                max_new_tokens=max(limits),
                pad_token_id=self.coder.tokenizer.pad_token_id,
                logits_processor=LogitsProcessorList([choices] if choices.count else []),
                stopping_criteria=StoppingCriteriaList([_ends_rows(asked, width)]),
            )
        rows = sequences[:, width:].tolist()
        return [
            self._told(job, row[:limit], int(length), choices.of(index))
            for index, (job, row, limit, length) in enumerate(zip(asked, rows, limits, lengths, strict=True))
        ]

    def _room(self, job: Job, length: int) -> str | None:
        longest = job.request.max_tokens
        if self.most_tokens is None or length + longest <= self.most_tokens:
            return None
        return (
            f"the question is too long: {length} tokens and up to {longest} of the answer, where the model takes "
            f"{self.most_tokens} together"
        )

    def _moved(self, inputs: Mapping[str, Any]) -> dict[str, Any]:
        import torch

        moved = dict(inputs)
        for name, value in inputs.items():
            if isinstance(value, torch.Tensor):
                moved[name] = value.to(self.model.device, self.model.dtype if value.is_floating_point() else None)
        return moved

    def _told(
        self, job: Job, row: list[int], tokens_in: int, choices: Sequence[Sequence[tuple[int, float]]]
    ) -> ChatAnswer:
        tokenizer = self.coder.tokenizer
        end = next((place for place, token in enumerate(row) if token in self._ends), None)
        words = row if end is None else row[:end]
        text = self.coder.clean(tokenizer.decode(words, skip_special_tokens=True))
        count = job.request.top_logprobs
        return ChatAnswer(
            text=text,
            fault=None if text else "empty answer",
            tokens_in=tokens_in,
            tokens_out=len(words) + (end is not None),
            model=self._name,
            tokens=tuple(
                TokenChoice(
                    tokenizer.decode([word]),
                    tuple((tokenizer.decode([token]), logprob) for token, logprob in likeliest[:count]),
                )
                for word, likeliest in zip(words, choices, strict=False)
            )
            if count
            else (),
        )


class _Choices:
    """Keeps the likeliest tokens of each place: all logits of a long answer would fill the memory."""

    def __init__(self, count: int) -> None:
        self.count = count
        self._places: list[list[list[tuple[int, float]]]] = []

    def __call__(self, input_ids: Any, scores: Any) -> Any:
        del input_ids
        found = scores.float().log_softmax(dim=-1).topk(min(self.count, scores.shape[-1]), dim=-1)
        rows = zip(found.indices.tolist(), found.values.tolist(), strict=True)
        self._places.append([list(zip(tokens, logprobs, strict=True)) for tokens, logprobs in rows])
        return scores

    def of(self, row: int) -> list[list[tuple[int, float]]]:
        return [place[row] for place in self._places]


def _ends_rows(asked: Sequence[Job], width: int) -> Any:
    import torch

    def ended(input_ids: Any, scores: Any, **_: Any) -> Any:
        del scores
        written = input_ids.shape[1] - width
        done = [job.gone.is_set() or written >= job.request.max_tokens for job in asked]
        return torch.tensor(done, dtype=torch.bool, device=input_ids.device)

    return ended


def _ends_of(model: Any, tokenizer: Any) -> frozenset[int]:
    ends = getattr(model.generation_config, "eos_token_id", None)
    listed = ends if isinstance(ends, list) else [ends]
    return frozenset(end for end in (*listed, tokenizer.eos_token_id) if end is not None)
