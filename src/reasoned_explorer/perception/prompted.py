"""A captioner that shows pictures to a model: at an endpoint or on this machine."""

import asyncio
import io
import re
from collections.abc import Sequence
from typing import Protocol

import numpy as np
from PIL import Image

from reasoned_explorer.calls.chat import ChatAnswer, ChatModel, ChatRequest
from reasoned_explorer.model import Fault, Goal, PartError, SettingsError, Undescribed, View
from reasoned_explorer.perception.caption_prompt import CaptionPrompt, caption_prompt

_PART = "captioner"
_JPEG_QUALITY = 92
# Said instead of a description. Only what begins so: a sign may say sorry, too.
_REFUSAL = re.compile(
    r"(?:i['’]?m|i am) (?:sorry|unable|not able)\b|sorry, (?:but )?i\b"
    r"|(?:i|as an ai[^.]*) (?:can ?not|can['’]t|won['’]t|don['’]t see (?:an|any) (?:image|picture))\b",
    re.IGNORECASE,
)


class Asker(Protocol):
    """Asks a model and sees to time, money and records: a `Caller`."""

    async def ask(self, request: ChatRequest) -> ChatAnswer:
        """Return the answer; whatever goes wrong is a fault in it."""
        ...


class PromptedCaptioner:
    """Describes views by asking a model that reads pictures, all views of a look at once.

    Each view is a call of its own in the ledger. A view whose call fails is `Undescribed`; the others are described all
    the same.

    Args:
        asker: Asks the model, on the mission's clock.
        name: Of the model as typed, e.g. ``"openai:gpt-4o-mini"`` or ``"hf:microsoft/kosmos-2-patch14-224"``.
        prompt: What is asked; None for the general one.
        lossless: Pictures go as they are, as PNG, about twelve times larger: for models on this machine. Else as JPEG.
        temperature: Of sampling; with 0 a model takes the likeliest words.
        seed: Of sampling.
    """

    def __init__(
        self,
        asker: Asker,
        *,
        name: str,
        prompt: CaptionPrompt | None = None,
        lossless: bool = False,
        temperature: float = 0.0,
        seed: int = 0,
    ) -> None:
        self.name = name
        self.prompt = prompt or caption_prompt()
        self.label = f"{name} (prompt {self.prompt.id})"
        self._asker, self._lossless = asker, lossless
        self._temperature, self._seed = temperature, seed

    async def describe(self, goal: Goal, views: Sequence[View]) -> Sequence[str | Undescribed]:
        """Return one description per view, or why it has none, in the views' order.

        Raises:
            PartError: If a view has no picture, or none can be described.
        """
        del goal  # a description says what is there, whatever is sought
        requests = [self._request(view) for view in views]
        answers = await asyncio.gather(*(self._asker.ask(request) for request in requests))
        told = [_told(answer) for answer in answers]
        faults = [one.fault for one in told if isinstance(one, Undescribed)]
        if faults and len(faults) == len(told):
            raise PartError(_PART, f"no view is described: {'; '.join(dict.fromkeys(faults))}")
        return told

    def _request(self, view: View) -> ChatRequest:
        prompt = self.prompt
        return ChatRequest(
            role="caption",
            key=view.key,
            system=prompt.system,
            user=prompt.question,
            prompt=prompt.id,
            images=(encoded(view, lossless=self._lossless),),
            max_tokens=prompt.max_tokens,
            temperature=self._temperature,
            seed=self._seed,
        )


def captioner_for(model: ChatModel, asker: Asker, *, temperature: float = 0.0, seed: int = 0) -> PromptedCaptioner:
    """Return the captioner that shows pictures to a model, in the way that suits it.

    Args:
        model: At an endpoint, on this machine, or what stands for it where a tape is replayed. One on this machine says
            its ``family`` and whether it ``sees``.
        asker: Asks it: a `Caller` of it.
        temperature: Of sampling.
        seed: Of sampling.

    Raises:
        SettingsError: If the model is known to read no pictures.
    """
    family: str = getattr(model, "family", "")
    if not getattr(model, "sees", True):
        what = f"{model.name} reads text only"
        raise SettingsError(
            _PART, [Fault(what, "a model that reads pictures", "e.g. hf:HuggingFaceTB/SmolVLM-256M-Instruct")]
        )
    return PromptedCaptioner(
        asker,
        name=model.name,
        prompt=caption_prompt(family),
        lossless=bool(family),
        temperature=temperature,
        seed=seed,
    )


def encoded(view: View, *, lossless: bool) -> bytes:
    """Return a view's picture as a PNG or a JPEG.

    Raises:
        PartError: If it has none, or what it has is none.
    """
    if view.image is None:
        raise PartError(
            _PART, f"view {view.key} has no picture; the vehicle must take some, or use a simulated captioner"
        )
    pixels = np.asarray(view.image)
    if pixels.dtype != np.uint8 or pixels.ndim != 3 or pixels.shape[2] != 3 or 0 in pixels.shape:
        reason = f"has a picture of shape {pixels.shape} and {pixels.dtype}, not (height, width, 3) and uint8"
        raise PartError(_PART, f"view {view.key} {reason}")
    file = io.BytesIO()
    if lossless:
        Image.fromarray(pixels).save(file, "PNG", compress_level=0)  # it goes nowhere: packing it would take the time
    else:
        Image.fromarray(pixels).save(file, "JPEG", quality=_JPEG_QUALITY)
    return file.getvalue()


def _told(answer: ChatAnswer) -> str | Undescribed:
    if answer.fault is not None:
        return Undescribed(answer.fault)
    text = " ".join(answer.text.split())
    if not text:
        return Undescribed("the model said nothing")
    if _REFUSAL.match(text):
        return Undescribed(f"the model refused: {text[:80]}")
    return text
