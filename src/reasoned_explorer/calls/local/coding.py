"""How a question becomes what a kind of model reads, and how what it writes becomes an answer.

Two kinds: models that converse, by the template that they bring, and Kosmos-2, which goes on with a text that begins
with a picture and marks in it where things are.
"""

import io
import re
from collections.abc import Mapping, Sequence
from typing import Any, Protocol

from reasoned_explorer.calls.chat import ChatRequest

#: What Kosmos-2 writes between its words: where a phrase begins and ends, where in the picture it is, and pieces of its
#: vocabulary that stand for no words.
_MARKS = re.compile(
    r"</?(?:image|phrase|object|grounding|chunk|line|doc|delimiter_of_multi_objects|unk|pad|mask|s)/?>"
    r"|<(?:patch_index|image)_\d+>"
)


class Coder(Protocol):
    """Between questions and what a model reads and writes."""

    tokenizer: Any

    def refusal(self, request: ChatRequest) -> str | None:
        """Return why such a question cannot be asked of this model, or None."""

    def encode(self, requests: Sequence[ChatRequest]) -> Mapping[str, Any]:
        """Return what the model reads: tensors by name, one row for each question, filled up on the left."""

    def clean(self, text: str) -> str:
        """Return what was written, without marks that are no words."""


class ConversationCoder:
    """For models that converse.

    Args:
        tokenizer: Of the model.
        processor: Reads pictures, too; None for models of text.
    """

    def __init__(self, tokenizer: Any, processor: Any = None) -> None:
        self.tokenizer, self._processor = tokenizer, processor
        fill_on_the_left(tokenizer)

    def refusal(self, request: ChatRequest) -> str | None:
        """Return why such a question cannot be asked of this model, or None."""
        return "this model reads no pictures" if request.images and self._processor is None else None

    def encode(self, requests: Sequence[ChatRequest]) -> Mapping[str, Any]:
        """Return what the model reads; all questions have pictures or none has."""
        texts = [self._text(request) for request in requests]
        # A template writes the marks for the beginning itself.
        marks = not self._has_template
        if self._processor is not None and requests[0].images:
            pictures = [[picture(image) for image in request.images] for request in requests]
            found = self._processor(
                text=texts,
                images=pictures,
                padding=True,
                return_tensors="pt",
                add_special_tokens=marks,
                **self._splitting([each for row in pictures for each in row]),
            )
        else:
            found = self.tokenizer(texts, padding=True, return_tensors="pt", add_special_tokens=marks)
            found.pop("token_type_ids", None)
        return dict(found)

    def clean(self, text: str) -> str:
        """Return what was written as it is."""
        return text.strip()

    def _splitting(self, pictures: Sequence[Any]) -> Mapping[str, Any]:
        """Have pictures that fit into one tile read as one, where a processor cuts pictures into tiles.

        SmolVLM would enlarge a picture of 224 pixels to 2048 and read it as 17 tiles: 17 times the work, nothing more
        to see.
        """
        reader = self._processor.image_processor
        if not getattr(reader, "do_image_splitting", False):
            return {}
        tile_px = reader.max_image_size["longest_edge"]
        return {"do_image_splitting": any(max(each.size) > tile_px for each in pictures)}

    @property
    def _has_template(self) -> bool:
        return bool(getattr(self._templates, "chat_template", None))

    @property
    def _templates(self) -> Any:
        return self.tokenizer if self._processor is None else self._processor

    def _text(self, request: ChatRequest) -> str:
        if not self._has_template:
            return f"{request.system}\n\n{request.user}\n".lstrip()
        from jinja2.exceptions import TemplateError

        pictures = len(request.images)
        if not request.system:
            return self._written(self._turn("user", request.user, pictures))
        try:
            return self._written(self._turn("system", request.system), self._turn("user", request.user, pictures))
        except TemplateError:
            # Some models know no one but the user and themselves.
            return self._written(self._turn("user", f"{request.system}\n\n{request.user}", pictures))

    def _written(self, *turns: Mapping[str, Any]) -> str:
        # Models of text that can think aloud first are asked not to: a step waits for the answer.
        options = {"enable_thinking": False} if self._processor is None else {}
        written: str = self._templates.apply_chat_template(
            list(turns), tokenize=False, add_generation_prompt=True, **options
        )
        return written

    def _turn(self, role: str, text: str, pictures: int = 0) -> Mapping[str, Any]:
        if self._processor is None:
            return {"role": role, "content": text}
        return {"role": role, "content": [{"type": "image"}] * pictures + [{"type": "text", "text": text}]}


class GroundingCoder:
    """For Kosmos-2: one picture, then a text that it goes on with, e.g. ``<grounding> Describe this image in detail:``.

    Args:
        processor: A ``Kosmos2Processor``.
    """

    def __init__(self, processor: Any) -> None:
        self._processor, self.tokenizer = processor, processor.tokenizer
        fill_on_the_left(self.tokenizer)

    def refusal(self, request: ChatRequest) -> str | None:
        """Return why such a question cannot be asked of this model, or None."""
        return None if len(request.images) == 1 else f"this model reads one picture a call, not {len(request.images)}"

    def encode(self, requests: Sequence[ChatRequest]) -> Mapping[str, Any]:
        """Return what the model reads. What ``system`` says is left out: it follows no instructions."""
        pictures = [picture(request.images[0]) for request in requests]
        texts = [request.user for request in requests]
        return dict(self._processor(text=texts, images=pictures, padding=True, return_tensors="pt"))

    def clean(self, text: str) -> str:
        """Return the words alone."""
        return without_marks(text)


def without_marks(text: str) -> str:
    """Return a text of Kosmos-2 without its marks.

    >>> without_marks("<phrase> a bench</phrase><object><patch_index_0044><patch_index_0863></object> by a path.")
    'a bench by a path.'
    """
    return re.sub(r"\s+([.,;:!?])", r"\1", " ".join(_MARKS.sub(" ", text).split()))


def picture(image: bytes) -> Any:
    """Return a picture of a question, as RGB."""
    from PIL import Image

    with Image.open(io.BytesIO(image)) as opened:
        return opened.convert("RGB")


def fill_on_the_left(tokenizer: Any) -> None:
    """Fill shorter questions of a batch up before their beginning: what is written goes on where each ends."""
    tokenizer.padding_side = "left"
    if tokenizer.pad_token is None:
        tokenizer.pad_token = tokenizer.eos_token
