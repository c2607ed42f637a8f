"""What captioners ask: prompts in files of their own, each with a version."""

import tomllib
from functools import cache
from importlib.resources import files

from pydantic import BaseModel, ConfigDict, Field

#: Kinds of models on this machine that need to be asked in their own way, and the file that says how.
_OF_FAMILY = {"kosmos-2": "caption-kosmos-2"}
_GENERAL = "caption"


class CaptionPrompt(BaseModel):
    """How a description of a picture is asked for.

    Attributes:
        name: Of the prompt.
        version: Counts up with every change.
        system: Who the model is to be; empty for models that follow no instructions.
        question: What it is asked beside the picture.
        max_tokens: At most so long an answer, tokens.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)
    name: str = Field(min_length=1)
    version: int = Field(ge=1)
    system: str
    question: str = Field(min_length=1)
    max_tokens: int = Field(ge=16)

    @property
    def id(self) -> str:
        """Name and version, e.g. ``"caption/1"``."""
        return f"{self.name}/{self.version}"


@cache
def caption_prompt(family: str = "") -> CaptionPrompt:
    """Return the prompt for a kind of model.

    Args:
        family: What transformers calls the kind (`LocalModel.family`), e.g. ``"kosmos-2"``; empty for an endpoint.
    """
    name = _OF_FAMILY.get(family, _GENERAL)
    file = files("reasoned_explorer.perception") / "prompts" / f"{name}.toml"
    told = CaptionPrompt.model_validate(tomllib.loads(file.read_text(encoding="utf-8")))
    return told.model_copy(update={"system": told.system.strip(), "question": told.question.strip()})
