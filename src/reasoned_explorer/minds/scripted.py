"""Minds that answer what they are told to: a provider like any other, for tests and for taking the agent apart.

A role's script is a callable that gets the goal and the scene, or a mapping, or one answer for every scene. A mapping's
key is a scene's key or a part of its text; keys win over texts, and of several texts the first that fits. What comes
out may be the answer itself, a plain number or bool or text, a `Fail` (an answer that is missing) or an exception that
is raised.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, cast

from reasoned_explorer.calls.ledger import CallRecord
from reasoned_explorer.minds.context import MindContext, Minds
from reasoned_explorer.model import (
    Assessment,
    Fault,
    Goal,
    PartError,
    Scene,
    SettingsError,
    Verdict,
    likert_from_score,
)

#: A callable, a mapping from scene keys or parts of texts, or one answer for all.
Script = Callable[[Goal, Scene], Any] | Mapping[tuple[int, ...] | str, Any] | Any


@dataclass(frozen=True, slots=True)
class Fail:
    """An answer that is missing: the scene, assessment or verdict carries this fault."""

    fault: str


@dataclass(frozen=True, slots=True)
class Delayed:
    """An answer that takes its own time instead of the profile's.

    Attributes:
        answer: As in a script.
        seconds: How long it takes.
    """

    answer: Any
    seconds: float


@dataclass(frozen=True, slots=True)
class Scripts:
    """What the three roles answer.

    Attributes:
        evaluator: `Assessment`, or a score from 1 to 5.
        visionary: For each child a text: one text (every child gets it, numbered), or a sequence of texts that is gone
            through child by child and starts again at its end.
        checker: `Verdict`, or a bool.
        default_score: Where no rule fits.
        default_text: Where no rule fits.
        default_found: Where no rule fits.
    """

    evaluator: Script = None
    visionary: Script = None
    checker: Script = None
    default_score: float = 3.0
    default_text: str = "The image shows a path."
    default_found: bool = False


def _answer(script: Script, goal: Goal, scene: Scene, default: Any) -> Any:
    if script is None:
        return default
    if callable(script):
        return script(goal, scene)
    if isinstance(script, Mapping):
        if scene.key in script:
            return script[scene.key]
        for part, answer in script.items():
            if isinstance(part, str) and part in scene.text:
                return answer
        return default
    return script


class ScriptedMinds:
    """All three roles, from scripts.

    Args:
        context: Clock, latency and ledger are used as a model would.
        scripts: What to answer.
    """

    def __init__(self, context: MindContext, scripts: Scripts) -> None:
        self._context = context
        self._scripts = scripts

    async def evaluate(self, goal: Goal, scenes: Sequence[Scene]) -> Sequence[Assessment]:
        """Return what the script says of each scene.

        Raises:
            PartError: If the script says so.
            SettingsError: If the script answers something that is no assessment.
        """
        answers = await self._ask(
            "evaluator", self._scripts.evaluator, goal, scenes, default=self._scripts.default_score
        )
        return tuple(self._assessment(answer) for answer in answers)

    async def imagine(self, goal: Goal, scenes: Sequence[Scene], *, count: int) -> Sequence[Sequence[Scene]]:
        """Return ``count`` scripted scenes for each scene.

        Raises:
            PartError: If the script says so.
            SettingsError: If the script answers something that is no text.
        """
        answers = await self._ask(
            "visionary", self._scripts.visionary, goal, scenes, default=self._scripts.default_text, times=count
        )
        return tuple(
            tuple(self._child(scene, child, answer) for child in range(count))
            for scene, answer in zip(scenes, answers, strict=True)
        )

    async def check(self, goal: Goal, scenes: Sequence[Scene]) -> Sequence[Verdict]:
        """Return what the script says of each scene.

        Raises:
            PartError: If the script says so.
            SettingsError: If the script answers something that is no verdict.
        """
        answers = await self._ask("checker", self._scripts.checker, goal, scenes, default=self._scripts.default_found)
        return tuple(self._verdict(answer) for answer in answers)

    async def _ask(
        self, role: str, script: Script, goal: Goal, scenes: Sequence[Scene], *, default: Any, times: int = 1
    ) -> list[Any]:
        context = self._context
        answers, slowest_s = [], 0.0
        started_s = context.clock.now_s()
        errors: list[BaseException] = []
        for scene in scenes:
            answer = _answer(script, goal, scene, default)
            seconds = [context.latency.duration_s(role, context.seed, *scene.key, child) for child in range(times)]
            if isinstance(answer, Delayed):
                seconds, answer = [answer.seconds] * times, answer.answer
            fault = answer.fault if isinstance(answer, Fail) else None
            if isinstance(answer, BaseException):
                errors.append(answer)
                fault = str(answer)
            slowest_s = max([slowest_s, *seconds])
            context.ledger.add_all(
                CallRecord(role, "scripted", scene.key, started_s, second, fault=fault) for second in seconds
            )
            answers.append(answer)
        await context.clock.think(slowest_s)
        if errors:
            raise errors[0]
        return answers

    @staticmethod
    def _assessment(answer: Any) -> Assessment:
        if isinstance(answer, Assessment):
            return answer
        if isinstance(answer, Fail):
            return Assessment(None, fault=answer.fault)
        if isinstance(answer, int | float) and 1.0 <= answer <= 5.0:
            return Assessment(likert_from_score(float(answer)))
        raise _misfit("evaluator", answer, "an Assessment, a score from 1 to 5, a Fail or an exception")

    @staticmethod
    def _verdict(answer: Any) -> Verdict:
        if isinstance(answer, Verdict):
            return answer
        if isinstance(answer, Fail):
            return Verdict(found=False, confidence=0.0, fault=answer.fault)
        if isinstance(answer, bool):
            return Verdict(found=answer, confidence=1.0, evidence="scripted")
        raise _misfit("checker", answer, "a Verdict, a bool, a Fail or an exception")

    @staticmethod
    def _child(scene: Scene, child: int, answer: Any) -> Scene:
        key, depth = (*scene.key, child), scene.depth + 1
        if isinstance(answer, Fail):
            return Scene("", key, scene.waypoint, depth, fault=answer.fault)
        if isinstance(answer, str):
            return Scene(answer, key, scene.waypoint, depth)
        if isinstance(answer, Sequence) and answer and all(isinstance(text, str) for text in answer):
            return Scene(cast("Sequence[str]", answer)[child % len(answer)], key, scene.waypoint, depth)
        raise _misfit("visionary", answer, "a text, a sequence of texts, a Fail or an exception")


def _misfit(role: str, answer: Any, expected: str) -> SettingsError:
    return SettingsError(f"script of the {role}", [Fault(f"it answered {answer!r}", expected)])


def broken(part: str, reason: str) -> PartError:
    """Return an answer that makes a role fail as a part: put it into a script."""
    return PartError(part, reason)


def make_minds(context: MindContext, scripts: Scripts | None = None) -> Minds:
    """Return scripted minds; without scripts they answer the defaults."""
    minds = ScriptedMinds(context, scripts or Scripts())
    return Minds(label="scripted minds", evaluator=minds, visionary=minds, checker=minds)
