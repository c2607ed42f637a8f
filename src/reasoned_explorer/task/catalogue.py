"""The catalogue of goals, by level: sentences as people say them, with paraphrases (data: ``goals.toml``)."""

import tomllib
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

from reasoned_explorer.model import Fault, InputError
from reasoned_explorer.task.goal_spec import GoalSpec
from reasoned_explorer.task.reading import read_goal

LEVELS = (1, 2, 3, 4)


@dataclass(frozen=True, slots=True)
class CatalogueGoal:
    """One goal and the ways to say it.

    Attributes:
        name: Identifier within its level, e.g. ``"bench-under-tree"``.
        level: 1 to 4.
        sentences: At least one; all ask for the same.
    """

    name: str
    level: int
    sentences: tuple[str, ...]

    def spec(self, paraphrase: int = 0) -> GoalSpec:
        """Return what the goal asks for, said in one of its ways (any number; it wraps around)."""
        return _spec(self.sentences[paraphrase % len(self.sentences)])


@cache
def goals(level: int | None = None) -> tuple[CatalogueGoal, ...]:
    """Return the goals of one level, or of all, in the order of the file.

    Raises:
        InputError: If there is no such level.
    """
    if level is None:
        return tuple(goal for each in LEVELS for goal in goals(each))
    if level not in LEVELS:
        raise InputError("catalogue of goals", [Fault(f"level {level}", "1, 2, 3 or 4")])
    return tuple(CatalogueGoal(name, level, tuple(said)) for name, said in _data()[f"level{level}"].items())


@cache
def _data() -> dict[str, dict[str, list[str]]]:
    text = files("reasoned_explorer.task").joinpath("goals.toml").read_text(encoding="utf-8")
    return {key: value for key, value in tomllib.loads(text).items() if isinstance(value, dict)}


@cache
def _spec(sentence: str) -> GoalSpec:
    return read_goal(sentence)
