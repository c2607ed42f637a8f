"""What missions with models will take in time and money, told before any is spent.

A few missions are run with the embedded minds in the models' stead, each call taking the seconds that the model was
seen to take, and their calls are counted. How many tokens a call has is assumed: from the lengths of the prompts and of
simulated captions. A model that finds goals sooner, or says more, makes it another sum.
"""

import math
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from statistics import fmean
from typing import Any

from reasoned_explorer.calls.abilities import Abilities
from reasoned_explorer.calls.chat import is_model_name
from reasoned_explorer.calls.prices import Price
from reasoned_explorer.evaluation.mission import Mission
from reasoned_explorer.evaluation.mission_settings import MissionSettings, minds_of, models_of
from reasoned_explorer.geometry import Pose
from reasoned_explorer.model.record import StepRecord
from reasoned_explorer.task.judge import Judge
from reasoned_explorer.world.atlas import Atlas

#: Tokens that a call of a role sends and gets back: assumed. A caption's are those of a small picture and a paragraph.
TOKENS = {"caption": (400, 80), "visionary": (420, 70), "evaluator": (480, 30), "checker": (460, 40)}
_EMBEDDED, _SIMULATED = "embedded", "noisy"


@dataclass(frozen=True, slots=True)
class Sample:
    """A mission to count calls in.

    Attributes:
        goal: The sentence.
        atlas: Of its world.
        start: Where it begins, or None for a seeded one.
        judge: Of the goal in this world, or None.
    """

    goal: str
    atlas: Atlas
    start: Pose | None = None
    judge: Judge | None = None


@dataclass(frozen=True, slots=True)
class ModelFacts:
    """What a forecast needs to know of a model.

    Attributes:
        abilities: How long its calls take and how many go on at once.
        price: Of its tokens, or None where it is not known.
    """

    abilities: Abilities
    price: Price | None


@dataclass(frozen=True, slots=True)
class Forecast:
    """What one mission takes, on average.

    Attributes:
        calls: Of models.
        minutes: Of real time, in its calls.
        usd: US dollars, or None where a price is not known.
    """

    calls: float
    minutes: float
    usd: float | None


def forecast(samples: Iterable[Sample], settings: MissionSettings, models: Mapping[str, ModelFacts]) -> Forecast:
    """Return what a mission of some settings takes.

    Args:
        samples: At least one mission to count in; more cost a fraction of a second each.
        settings: Of the missions, with models in some roles.
        models: Every model among them.

    Raises:
        InputError: As `Mission`.
    """
    facts = [models[name] for name in models_of(settings)]
    alone_s = max(fact.abilities.latency_s or 0.0 for fact in facts)
    parallel = min(fact.abilities.parallel for fact in facts)
    roles = _roles_of(settings)
    missions = list(samples)
    first = _calls_of(missions[0], settings, alone_s)
    # Calls that wait for each other make a step longer, and a mission then has fewer of them.
    busy_s = _seconds(first, roles, alone_s, parallel)
    free_s = _seconds(first, roles, alone_s, math.inf)
    each_s = alone_s * (busy_s / free_s if free_s > 0.0 else 1.0)
    counted = [_calls_of(each, settings, each_s) for each in missions]
    by_role = Counter(call.role for steps in counted for step in steps for call in step.calls)
    called = {role: count / len(missions) for role, count in by_role.items() if role in roles}
    prices = {role: models[roles[role]].price for role in called}
    usd = None
    if None not in prices.values():
        usd = math.fsum(
            count * price.usd(*TOKENS[role]) for role, count in called.items() if (price := prices[role]) is not None
        )
    minutes = fmean(_seconds(steps, roles, alone_s, parallel) for steps in counted) / 60.0
    return Forecast(math.fsum(called.values()), minutes, usd)


def _roles_of(settings: MissionSettings) -> dict[str, str]:
    """Return the model of each role that a model has."""
    return {
        role: name
        for role, name in {**minds_of(settings), "caption": settings.captioner}.items()
        if is_model_name(name)
    }


def _calls_of(sample: Sample, settings: MissionSettings, call_s: float) -> tuple[StepRecord, ...]:
    embedded: dict[str, Any] = {
        role: _EMBEDDED
        for role in ("minds", "visionary", "evaluator", "checker")
        if (name := getattr(settings, role)) is not None and is_model_name(name)
    }
    captioner = _SIMULATED if is_model_name(settings.captioner) else settings.captioner
    stead = replace(settings, **embedded, captioner=captioner, clock="virtual", latency=f"{min(call_s, 9999.0):.3f}s")
    mission = Mission(sample.goal, sample.atlas, stead, start=sample.start, judge=sample.judge)
    return mission.run().record.steps


def _seconds(steps: Iterable[StepRecord], roles: Mapping[str, str], call_s: float, parallel: float) -> float:
    """Return the real seconds of the models' calls, so many of which go on at once."""
    together: Counter[tuple[int, float]] = Counter()
    for step in steps:
        for call in step.calls:
            if call.role in roles:
                together[step.step, call.started_s] += 1
    return math.fsum(max(1.0, count / parallel) * call_s for count in together.values())
