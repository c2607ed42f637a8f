"""The questions of evaluator and checker as typed decisions, from their own versioned file."""

import tomllib
from collections.abc import Mapping
from functools import lru_cache
from importlib.resources import files
from pathlib import Path
from types import MappingProxyType

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from reasoned_explorer.calls.chat import DecisionQuestion
from reasoned_explorer.model import Fault, SettingsError

_NAME = "decisions.toml"
#: The answers that a role's reader needs, and how many levels each has.
_WANTED = {"evaluator": {"blocked": 0, "forbidden": 0, "level": 5}, "checker": {"found": 0}}


class _Question(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)
    name: str = Field(min_length=1)
    instructions: str = Field(min_length=1)
    levels: tuple[str, ...] = ()


class _File(BaseModel):
    model_config = ConfigDict(extra="forbid", frozen=True)
    version: int = Field(ge=1)
    evaluator: tuple[_Question, ...]
    checker: tuple[_Question, ...]


class Decisions:
    """Questions with typed answers.

    Attributes:
        id: Name and version, e.g. ``"decisions/1"``.
        by_role: The questions of each role that has some.
    """

    def __init__(self, version: int, by_role: Mapping[str, tuple[DecisionQuestion, ...]]) -> None:
        self.id = f"decisions/{version}"
        self.by_role = MappingProxyType(dict(by_role))


@lru_cache(maxsize=16)
def load_decisions(folder: Path | None = None) -> Decisions:
    """Return the questions.

    Args:
        folder: Where ``decisions.toml`` may be; where it is not, and for None, those that come with the package.

    Raises:
        SettingsError: If the file cannot be read or holds other questions than the roles need.
    """
    own = None if folder is None else folder / _NAME
    packaged = files("reasoned_explorer.minds.prompted") / "prompts" / _NAME
    place = own if own is not None and own.is_file() else packaged
    try:
        found = _File.model_validate(tomllib.loads(place.read_text(encoding="utf-8")))
    except (OSError, tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise SettingsError(f"prompt {place}", [Fault(str(error), "a TOML file in UTF-8")]) from None
    except ValidationError as error:
        faults = [
            Fault(f"{'.'.join(map(str, each['loc'])) or 'the file'}: {each['msg']}", "as in the packaged file")
            for each in error.errors(include_url=False, include_input=False)
        ]
        raise SettingsError(f"prompt {place}", faults) from None
    faults = [
        Fault(f"{role} asks {_shown(asked)}", _shown(_WANTED[role]))
        for role in _WANTED
        if (asked := {each.name: len(set(each.levels)) for each in getattr(found, role)}) != _WANTED[role]
    ]
    if faults:
        raise SettingsError(f"prompt {place}", faults)
    return Decisions(
        found.version,
        {
            role: tuple(
                DecisionQuestion(each.name, each.instructions.strip(), each.levels) for each in getattr(found, role)
            )
            for role in _WANTED
        },
    )


def _shown(asked: Mapping[str, int]) -> str:
    return ", ".join(f"{name} ({levels} levels)" if levels else name for name, levels in asked.items())
