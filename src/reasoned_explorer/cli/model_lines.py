"""``rex minds check``, and what a benchmark with models will take: in words, before anything is spent."""

import math
from collections.abc import Iterable
from typing import Any

from reasoned_explorer.calls.abilities import Abilities
from reasoned_explorer.calls.chat import MODEL_FORMS, is_model_name
from reasoned_explorer.calls.prices import Price
from reasoned_explorer.cli.console import Output
from reasoned_explorer.cli.models import ModelOptions
from reasoned_explorer.evaluation.bench.plan import BenchPlan
from reasoned_explorer.evaluation.forecast import Forecast, ModelFacts, Sample, forecast
from reasoned_explorer.evaluation.methods import method
from reasoned_explorer.evaluation.mission_settings import MissionSettings, models_of
from reasoned_explorer.evaluation.model_desk import KnownModel
from reasoned_explorer.model import Fault, SettingsError
from reasoned_explorer.task.splitting import open_place
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.opening import open_world


def check_model(name: str, options: ModelOptions) -> None:
    """Print what a model can do and what a mission with it takes.

    Args:
        name: Of the model.
        options: Where it is and what it costs.

    Raises:
        InputError: If the name, the address or a key is wrong.
        PartError: If it does not answer.
    """
    if not is_model_name(name):
        raise SettingsError("model", [Fault(f"{name!r}", f"{MODEL_FORMS}, e.g. openai:gpt-4o-mini")])
    (known,) = options.desk().prepare([name])
    console = Output()
    for lines in (lines_about, lines_of_costs):
        for line in lines(known):
            console.print(line, markup=False, soft_wrap=True)


#: Where a mission is counted in for ``rex minds check``, and what is sought there.
_SAMPLE_WORLD, _SAMPLE_GOALS = "park:7", ("Find me a fire hydrant, but stay on the road", "Find me a bench")
#: Missions of a row of the split ``mini``.
_MINI = 56


def lines_about(known: KnownModel) -> list[str]:
    """Return in words what a model can do."""
    able = known.abilities
    return [
        f"{known.model.name}: answers as {able.model or 'it does not say what'}",
        f"on this machine      {'yes' if known.model.is_local else 'no'}",
        f"structured output    {_structure(able)}",
        f"typed decisions      {'yes' if able.decisions else 'no'}",
        f"log-probabilities    {f'{able.top_logprobs} a place' if able.top_logprobs else 'no'}",
        f"pictures             {'yes' if able.vision else 'no'}",
        f"calls at once        {able.parallel:.1f}, as far as could be seen",
        f"median latency       {'-' if able.latency_s is None else f'{able.latency_s:.2f} s'}",
        f"price                {_price(known.price)}",
        f"this check           {able.calls} calls, {able.tokens} tokens, {_money(able.usd)}",
        *(f"answered with        {fault}" for fault in able.faults),
        *(f"leaves out           {what}" for what in sorted(getattr(known.model, "left_out", ()))),
    ]


def lines_of_costs(known: KnownModel) -> list[str]:
    """Return in words what a mission with a model takes, as far as can be told."""
    able = known.abilities
    if able.latency_s is None:
        return []
    only_sees = getattr(known.model, "only_describes", False)
    who: dict[str, Any] = {"captioner" if only_sees else "minds": known.model.name}
    settings = MissionSettings(clock="mixed", **who)
    world = Atlas(open_world(_SAMPLE_WORLD))
    samples = [Sample(goal, world) for goal in _SAMPLE_GOALS]
    one = forecast(samples, settings, {known.model.name: ModelFacts(able, known.price)})
    row_usd = None if one.usd is None else one.usd * _MINI
    return [
        f"a mission of llm-rrt, about {one.calls:,.0f} calls: {_minutes(one.minutes)}, {_money(one.usd)}",
        f"a row of the split mini, {_MINI} missions: {_minutes(_MINI * one.minutes)}, {_money(row_usd)}",
        f"({ASSUMED})",
    ]


#: What has to be said under a forecast.
ASSUMED = (
    "counted in missions with embedded minds, by the latency of short calls and assumed lengths: try one mission with "
    "--budget-minutes first"
)


def lines_of_forecast(plan: BenchPlan, known: Iterable[KnownModel], *, workers: int) -> list[str]:
    """Return in words what those rows of a benchmark take that call models, before any of their calls is paid.

    Args:
        plan: Of the run.
        known: The models that it calls.
        workers: How many processes run missions; they share an endpoint, so that it may well take longer.
    """
    facts = {each.model.name: ModelFacts(each.abilities, each.price) for each in known}
    samples = _samples_of(plan)
    count = len(plan.split.episodes) * len(plan.vehicles) * len(plan.seeds)
    lines: list[str] = []
    each_row: list[Forecast] = []
    for name in plan.methods:
        settings = method(name).settings(plan.base)
        if settings.agent == "guide" or not models_of(settings):
            continue
        one = forecast(samples, settings, facts)
        each_row.append(one)
        took = f"about {one.calls:,.0f} calls, {_minutes(one.minutes)}, {_money(one.usd)} a mission"
        lines.append(f"forecast: {name}: {took}; {count} missions")
    prices = [one.usd for one in each_row if one.usd is not None]
    usd = math.fsum(prices) * count if len(prices) == len(each_row) else None
    minutes = math.fsum(one.minutes for one in each_row) * count / workers
    in_all = f"in all about {_minutes(minutes)} with {workers} at once, {_money(usd)}"
    return [*lines, f"forecast: {in_all}", f"({ASSUMED})"] if lines else []


def _samples_of(plan: BenchPlan) -> list[Sample]:
    """Return a few episodes of the first place, of several levels: opening a world takes a second."""
    place = plan.split.place(plan.split.episodes[0].place)
    episodes = [item.episode for item in plan.split.episodes if item.place == place.name]
    chosen = {episode.spec.level: episode for episode in episodes}
    atlas = open_place(place)
    return [Sample(episode.spec.text, atlas, episode.start) for episode in chosen.values()]


def _minutes(minutes: float) -> str:
    if minutes < 1.0:
        return f"{60.0 * minutes:.0f} s"
    return f"{minutes / 60.0:.1f} h" if minutes >= 90.0 else f"{minutes:.1f} min"


def _structure(able: Abilities) -> str:
    words = {"json_schema": "JSON schema", "json_object": "JSON objects", "none": "no: plain text is read"}
    return words[able.structure]


def _price(price: Price | None) -> str:
    if price is None:
        return "not known"
    if price.is_free:
        return f"nothing ({price.source})"
    as_of = "" if price.as_of is None else f", {price.as_of.isoformat()}"
    return (
        f"${price.usd_per_million_in:g} in, ${price.usd_per_million_out:g} out a million tokens ({price.source}{as_of})"
    )


def _money(usd: float | None) -> str:
    return "price not known" if usd is None else f"${usd:.2f}"
