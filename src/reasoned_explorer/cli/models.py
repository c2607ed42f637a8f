"""What a person says about models that are called, and ``rex minds check``."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from reasoned_explorer.calls.abilities import Abilities
from reasoned_explorer.calls.budget import Budget, faults_of_budget
from reasoned_explorer.calls.cache import AnswerCache
from reasoned_explorer.calls.chat import is_model_name
from reasoned_explorer.calls.tape import TapePlayer
from reasoned_explorer.cli.console import Output
from reasoned_explorer.evaluation.mission import Mission
from reasoned_explorer.evaluation.mission_settings import MissionSettings, models_of
from reasoned_explorer.evaluation.model_desk import KnownModel, ModelDesk, recording_faults
from reasoned_explorer.model import Fault, Gathering, SettingsError

#: Two missions whose headers agree in these are the same mission.
_IDENTITY = ("goal", "world_digest", "start", "settings")


@dataclass(frozen=True, slots=True)
class ModelOptions:
    """What a person typed; see ``rex run --help``."""

    base_url: str | None = None
    record: Path | None = None
    replay: Path | None = None
    cache: Path | None = None
    budget_usd: float | None = None
    budget_minutes: float | None = None

    def check(self, settings: MissionSettings, found: Gathering) -> None:
        """Keep what is wrong with it, as far as can be told before a model is asked."""
        faults = [*recording_faults(self.record, self.replay), *faults_of_budget(self.budget_usd, self.budget_minutes)]
        if not models_of(settings):
            faults += [
                Fault(f"{name} without a model that is called", "minds such as openai:gpt-4o-mini", "or leave it out")
                for name, value in self._named()
                if value is not None
            ]
        if faults:
            found.add(SettingsError("models", faults))

    def _named(self) -> list[tuple[str, object]]:
        return [(f"--{name.replace('_', '-')}", value) for name, value in asdict(self).items()]

    def desk(self) -> ModelDesk:
        """Return the desk that makes what a mission calls.

        Raises:
            InputError: If a tape or a cache cannot be read, or a budget is none.
        """
        limited = self.budget_usd is not None or self.budget_minutes is not None
        return ModelDesk(
            base_url=self.base_url,
            cache=None if self.cache is None else AnswerCache(self.cache),
            budget=Budget(usd=self.budget_usd, minutes=self.budget_minutes) if limited else None,
            replay=None if self.replay is None else TapePlayer(self.replay),
        )

    @contextmanager
    def taping(self, desk: ModelDesk, mission: Mission) -> Iterator[None]:
        """Write what a mission calls to a tape, or see that it is the one on the tape.

        Raises:
            RecordError: If it is another mission, or no tape can be begun.
        """
        header = mission.header
        about: dict[str, Any] = json.loads(json.dumps({name: getattr(header, name) for name in _IDENTITY}))
        desk.check_replay(about)
        if self.record is None:
            yield
            return
        with desk.record(self.record, about):
            yield


def check_model(name: str, *, base_url: str | None) -> None:
    """Print what a model can do and what a mission with it takes.

    Raises:
        InputError: If the name, the address or a key is wrong.
        PartError: If it does not answer.
    """
    if not is_model_name(name):
        raise SettingsError("model", [Fault(f"{name!r}", "openai:MODEL, e.g. openai:gpt-4o-mini")])
    (known,) = ModelDesk(base_url=base_url).prepare([name])
    console = Output()
    for line in lines_about(known):
        console.print(line, markup=False, soft_wrap=True)


#: Calls of a step of LLM-RRT with N = 3, C = 3, L = 2, by role, and about how many tokens each takes in and gives out:
#: assumed from the prompts and the lengths of simulated captions.
_STEP_CALLS = {"visionary": (18, 420, 70), "evaluator": (18, 480, 30), "checker": (3, 460, 40)}
#: Steps of a mission that lasts its thirty minutes.
_STEPS = 70
#: Rounds of calls in a step that wait for each other: two of the visionary, one of the evaluator.
_ROUNDS = 3
#: Missions of a row of the split ``mini``.
_MINI = 56


def lines_about(known: KnownModel) -> list[str]:
    """Return in words what a model can do and what a mission with it takes, as far as can be told."""
    able = known.abilities
    lines = [
        f"{known.model.name}: answers as {able.model or 'it does not say what'}",
        f"on this machine      {'yes' if known.model.is_local else 'no'}",
        f"structured output    {_structure(able)}",
        f"log-probabilities    {f'{able.top_logprobs} a place' if able.top_logprobs else 'no'}",
        f"pictures             {'yes' if able.vision else 'no'}",
        f"calls at once        {able.parallel:.1f}, as far as could be seen",
        f"median latency       {'-' if able.latency_s is None else f'{able.latency_s:.2f} s'}",
        f"this check           {able.calls} calls, {able.tokens} tokens, {_money(able.usd)}",
        *(f"answered with        {fault}" for fault in able.faults),
    ]
    if able.latency_s is None:
        return lines
    calls = sum(count for count, _, _ in _STEP_CALLS.values())
    minutes = _STEPS * max(_ROUNDS, calls / able.parallel) * able.latency_s / 60.0
    price = getattr(known.model, "price", None)
    usd = 0.0 if known.model.is_local else None
    if price is not None:
        usd = _STEPS * sum(count * price.usd(sent, got) for count, sent, got in _STEP_CALLS.values())
    row_usd = None if usd is None else usd * _MINI
    return [
        *lines,
        f"a mission of llm-rrt, {_STEPS} steps, {_STEPS * calls:,} calls: about {minutes:.0f} min, {_money(usd)}",
        f"a row of the split mini, {_MINI} missions: about {_MINI * minutes / 60.0:.1f} h, {_money(row_usd)}",
        "(by the latency of short calls and assumed lengths: try one mission with --budget-minutes first)",
    ]


def _structure(able: Abilities) -> str:
    words = {"json_schema": "JSON schema", "json_object": "JSON objects", "none": "no: plain text is read"}
    return words[able.structure]


def _money(usd: float | None) -> str:
    return "price not known" if usd is None else f"${usd:.2f}"
