"""Evaluator, visionary and goal checker by asking a language model.

Each scene is a question of its own, and all questions of a batch are asked at once. An answer that cannot be understood
is asked for once more, and the question says so; then it is missing, with a fault. No score, scene or "found" is ever
made up.
"""

import asyncio
from collections.abc import Callable, Coroutine, Iterable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Protocol, TypeVar

from reasoned_explorer.calls.abilities import Abilities
from reasoned_explorer.calls.chat import ANY_OBJECT, ChatAnswer, ChatRequest
from reasoned_explorer.minds.context import Minds
from reasoned_explorer.minds.prompted.chances import level_chances, yes_chance
from reasoned_explorer.minds.prompted.decisions import Decisions, load_decisions
from reasoned_explorer.minds.prompted.prompt import ROLES, Form, Prompt, load_prompt
from reasoned_explorer.minds.prompted.reading import (
    CUT_OFF,
    Finding,
    Judgement,
    Unreadable,
    read_finding,
    read_judgement,
    read_scene,
)
from reasoned_explorer.model import Assessment, Fault, Goal, Scene, SettingsError, Verdict
from reasoned_explorer.model.draws import key_of

T = TypeVar("T")
Said = TypeVar("Said", Judgement, Finding, str)

#: So many entries of a scene's key say which view it belongs to: step, look, index.
_VIEW_KEY = 3
_LARGEST_SEED = 2**31 - 1
#: A fault that begins with this is about the length of the answer: asked again, it may be twice as long.
_CUT_OFF = "cut off"
NO_DESCRIPTION = "the scene has no description"


class Asker(Protocol):
    """Asks a model and sees to time, money and records: a `Caller`."""

    async def ask(self, request: ChatRequest) -> ChatAnswer:
        """Return the answer; whatever goes wrong is a fault in it."""
        ...


@dataclass(frozen=True, slots=True)
class PromptedSettings:
    """How a language model is asked.

    Attributes:
        visionary_temperature: Of sampling, in [0, 2]; above 0 a scene's children differ the more. The other roles are
            asked at 0.
        halt_from: A goal that is said to be found counts as found from this confidence on, in [0, 1].
        spare_tokens: So many more tokens an answer may take than it needs, for models that think aloud before.
        prompts: Folder with ``visionary.toml``, ``evaluator.toml`` and ``checker.toml``; None for those of the package.
    """

    visionary_temperature: float = 0.7
    halt_from: float = 0.5
    spare_tokens: int = 0
    prompts: Path | None = None

    def __post_init__(self) -> None:
        faults = []
        if not 0.0 <= self.visionary_temperature <= 2.0:
            faults.append(Fault(f"visionary_temperature is {self.visionary_temperature!r}", "a number from 0 to 2"))
        if not 0.0 <= self.halt_from <= 1.0:
            faults.append(Fault(f"halt_from is {self.halt_from!r}", "a number from 0 to 1"))
        if not 0 <= self.spare_tokens <= 100_000:
            faults.append(Fault(f"spare_tokens is {self.spare_tokens!r}", "a whole number from 0 to 100000"))
        if faults:
            raise SettingsError("settings of prompted minds", faults)


@dataclass(slots=True)
class Tally:
    """How the answers of one role were.

    Attributes:
        asked: Scenes that were asked about.
        asked_again: Of these, how many were asked about once more since the first answer was not understood.
        missing: Of these, how many got no answer that could be understood.
    """

    asked: int = 0
    asked_again: int = 0
    missing: int = 0


@dataclass(slots=True)
class PromptedMinds:
    """All three roles, by asking one model.

    Attributes:
        caller: Asks it.
        abilities: What it can do; the best of it is used.
        settings: How it is asked.
        seed: Of the mission; what the visionary samples is keyed by it.
        tallies: How the answers were, by role.
    """

    caller: Asker
    abilities: Abilities = field(default_factory=Abilities)
    settings: PromptedSettings = field(default_factory=PromptedSettings)
    seed: int = 0
    tallies: dict[str, Tally] = field(default_factory=lambda: {role: Tally() for role in ROLES})
    _prompts: dict[str, Prompt] = field(init=False)
    _told: dict[str, str] = field(init=False)
    _decisions: Decisions = field(init=False)

    def __post_init__(self) -> None:
        self._decisions = load_decisions(self.settings.prompts)
        self._prompts = {role: load_prompt(role, self.settings.prompts) for role in ROLES}
        self._told = {role: prompt.told(self._form(role)) for role, prompt in self._prompts.items()}

    async def evaluate(self, goal: Goal, scenes: Sequence[Scene]) -> Sequence[Assessment]:
        """Return one assessment per scene, in order; a missing one carries a fault."""
        return await _at_once(self._assess(goal, scene) for scene in scenes)

    async def imagine(
        self,
        goal: Goal,  # noqa: ARG002 - the paper's visionary does not know it
        scenes: Sequence[Scene],
        *,
        count: int,
    ) -> Sequence[Sequence[Scene]]:
        """Return ``count`` imagined scenes for each scene, in order, whatever the goal is."""
        children = await _at_once(
            self._imagine(scene, child, count=count) for scene in scenes for child in range(count)
        )
        return [children[place * count : (place + 1) * count] for place in range(len(scenes))]

    async def check(self, goal: Goal, scenes: Sequence[Scene]) -> Sequence[Verdict]:
        """Return one verdict per scene, in order; a missing one carries a fault and is never "found"."""
        return await _at_once(self._check(goal, scene) for scene in scenes)

    async def _assess(self, goal: Goal, scene: Scene) -> Assessment:
        fault = _fault_of(scene)
        if fault is not None:
            return Assessment(None, fault=fault)
        data = {"goal": goal.text, "scene": scene.text}
        said, answer = await self._ask("evaluator", scene.key, data, read_judgement, max_tokens=60)
        if said is None:
            return Assessment(None, fault=answer.fault)
        return Assessment(level_chances(said.level, answer.tokens), said.blocked, said.forbidden)

    async def _check(self, goal: Goal, scene: Scene) -> Verdict:
        fault = _fault_of(scene)
        if fault is not None:
            return Verdict(found=False, confidence=0.0, fault=fault)
        data = {"goal": goal.text, "scene": scene.text}
        said, answer = await self._ask("checker", scene.key, data, read_finding, max_tokens=120)
        if said is None:
            return Verdict(found=False, confidence=0.0, fault=answer.fault)
        chance = yes_chance(said.found, answer.tokens)
        if chance is None:
            # Who says yes or no and nothing of doubt is taken at his word, as an evaluator's plain level is.
            certainty = 1.0 if said.certainty is None else said.certainty
            chance = certainty if said.found else 1.0 - certainty
        return Verdict(said.found and chance >= self.settings.halt_from, round(chance, 6), said.evidence)

    async def _imagine(self, scene: Scene, child: int, *, count: int) -> Scene:
        imagined = Scene("", (*scene.key, child), scene.waypoint, scene.depth + 1, _fault_of(scene))
        if imagined.fault is not None:
            return imagined
        which = f"Several things are plausible; describe number {child + 1} of {count}." if count > 1 else ""
        # All views of a mission are imagined on with the same draws, as the embedded visionary's are: scores then
        # differ by what is seen, not by luck.
        seed = key_of(self.seed, "visionary", scene.depth, *imagined.key[_VIEW_KEY:]) & _LARGEST_SEED
        said, answer = await self._ask(
            "visionary", imagined.key, {"scene": scene.text, "which": which}, read_scene, max_tokens=200, seed=seed
        )
        return replace(imagined, fault=answer.fault) if said is None else replace(imagined, text=said)

    async def _ask(
        self,
        role: str,
        key: tuple[int, ...],
        data: dict[str, str],
        read: Callable[[str, Sequence[str]], Said | Unreadable],
        *,
        max_tokens: int,
        seed: int = 0,
    ) -> tuple[Said | None, ChatAnswer]:
        """Return what is said and the answer that says it; None, and an answer with a fault, where nothing is."""
        tally, shown = self.tallies[role], [data[name] for name in ("goal", "scene") if name in data]
        tally.asked += 1
        request = self._request(role, key, data, max_tokens=max_tokens, seed=seed)
        said, answer = _understood(await self.caller.ask(request), read, shown)
        if isinstance(said, Unreadable):
            tally.asked_again += 1
            room = 2 if said.reason == CUT_OFF else 1
            again = replace(
                request,
                user=self._prompts[role].asked(data, self._form(role), again=said.reason),
                max_tokens=room * request.max_tokens,
            )
            said, answer = _understood(await self.caller.ask(again), read, shown)
        if said is None or isinstance(said, Unreadable):
            tally.missing += 1
            return None, answer
        return said, answer

    def _form(self, role: str) -> Form:
        if self.abilities.decisions and role in self._decisions.by_role:
            return Form.DECISION
        # A description needs no form of its own unless the server holds the model to it; a decision is better held.
        can = self.abilities
        return Form.JSON if can.json_schema or (can.json_object and role != "visionary") else Form.TEXT

    def _request(
        self, role: str, key: tuple[int, ...], data: dict[str, str], *, max_tokens: int, seed: int
    ) -> ChatRequest:
        prompt, can = self._prompts[role], self.abilities
        form = self._form(role)
        if form is Form.DECISION:
            return ChatRequest(
                role=role,
                key=key,
                system=self._told[role],
                user=prompt.asked(data, form),
                prompt=f"{prompt.id} {self._decisions.id}",
                questions=self._decisions.by_role[role],
            )
        schema = None if form is Form.TEXT else prompt.answer_schema if can.json_schema else ANY_OBJECT
        return ChatRequest(
            role=role,
            key=key,
            system=self._told[role],
            user=prompt.asked(data, form),
            prompt=prompt.id,
            schema=schema,
            max_tokens=max_tokens + self.settings.spare_tokens,
            temperature=self.settings.visionary_temperature if role == "visionary" else 0.0,
            seed=seed,
            top_logprobs=0 if role == "visionary" else can.top_logprobs,
        )


def prompted_minds(
    caller: Asker,
    *,
    name: str,
    abilities: Abilities | None = None,
    settings: PromptedSettings | None = None,
    seed: int = 0,
) -> Minds:
    """Return minds whose three roles ask one model.

    Args:
        caller: Asks it.
        name: Of the model, as typed; results are labelled with it.
        abilities: What it can do; None for plain text.
        settings: How it is asked; None for the defaults.
        seed: Of the mission.

    Raises:
        SettingsError: If a prompt cannot be read.
    """
    minds = PromptedMinds(caller, abilities or Abilities(), settings or PromptedSettings(), seed)
    return Minds(label=name, evaluator=minds, visionary=minds, checker=minds, seed=seed)


def _fault_of(scene: Scene) -> str | None:
    return scene.fault if scene.fault is not None else None if scene.text.strip() else NO_DESCRIPTION


def _understood(
    answer: ChatAnswer, read: Callable[[str, Sequence[str]], Said | Unreadable], shown: Sequence[str]
) -> tuple[Said | Unreadable | None, ChatAnswer]:
    """Return what an answer says, `Unreadable` where asking again may help, None where it would not."""
    if answer.fault is not None:
        # All others are about the way there, where they were tried again already, or stay what they are.
        return Unreadable(CUT_OFF) if answer.fault.startswith(_CUT_OFF) else None, answer
    said = read(answer.text, shown)
    if isinstance(said, Unreadable):
        return said, replace(answer, fault=f"not understood: {said.reason}")
    return said, answer


async def _at_once(calls: Iterable[Coroutine[Any, Any, T]]) -> list[T]:
    """Return what calls that start together return, in order; where one raises, the others end before it comes out."""
    tasks = [asyncio.ensure_future(call) for call in calls]
    try:
        return list(await asyncio.gather(*tasks))
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
