"""The models of a benchmark: looked into before anything is made, and how its workers reach them."""

import time
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from reasoned_explorer.calls.abilities import abilities_from_json
from reasoned_explorer.calls.budget import Budget
from reasoned_explorer.calls.prices import read_prices
from reasoned_explorer.cli.models import ModelOptions
from reasoned_explorer.evaluation.bench.plan import BenchPlan
from reasoned_explorer.evaluation.bench.store import RunStore
from reasoned_explorer.evaluation.methods import minds_called
from reasoned_explorer.evaluation.model_access import PLAIN_ACCESS, ModelAccess
from reasoned_explorer.evaluation.model_desk import KnownModel, ModelDesk
from reasoned_explorer.model import RecordError
from reasoned_explorer.model.disk import disk_error
from reasoned_explorer.task.split import GENERATED

#: In the folder of a run: what its workers spend in a sitting, and tapes of missions that are under way.
SPENT_NAME, UNDER_WAY_NAME = "spent.txt", "under-way"


@dataclass(frozen=True, slots=True)
class ReadyModels:
    """Models that are there and answer.

    Attributes:
        base_url: Where those of ``openai:…`` are, or None.
        known: Each with what it can do.
        pictures_may_leave: Whether pictures of real places may be sent to other machines.
    """

    base_url: str | None
    known: tuple[KnownModel, ...]
    pictures_may_leave: bool = False

    def access(self, store: RunStore, options: ModelOptions, *, workers: int, here: bool) -> ModelAccess:
        """Return how workers reach them; what the run has to remember is put into its store.

        Args:
            store: Of the run.
            options: What was typed.
            workers: How many there are.
            here: Whether all workers are on this machine.

        Raises:
            RecordError: If a file cannot be made in the run's folder.
            RecordWriteError: If the store cannot be written.
            PartError: If the disk fails.
        """
        if not self.known:
            return PLAIN_ACCESS
        abilities = {each.model.name: each.abilities for each in self.known}
        store.keep_models(
            {"base_url": self.base_url, "abilities": {name: asdict(able) for name, able in abilities.items()}}
        )
        spent, tapes = store.folder / SPENT_NAME, store.folder / UNDER_WAY_NAME
        try:
            spent.unlink(missing_ok=True)  # a budget is a sitting's
            tapes.mkdir(exist_ok=True)
        except OSError as error:
            raise disk_error("run", store.folder, error, kind=RecordError) from error
        return ModelAccess(
            base_url=self.base_url,
            key_variable=options.key_variable,
            prices=options.prices,
            cache=options.cache,
            sample_anew=options.sample_anew,
            budget_usd=options.budget_usd,
            budget_minutes=options.budget_minutes,
            since_s=time.monotonic(),
            spent=spent if options.budget_usd is not None else None,
            workers=workers,
            tapes=tapes if here else None,
            pictures_may_leave=self.pictures_may_leave,
        ).knowing(abilities)


def models_ready(options: ModelOptions, plan: BenchPlan, kept: Mapping[str, Any]) -> ReadyModels:
    """Return the models of a run, once each has answered.

    Args:
        options: What was typed.
        plan: What is to be run.
        kept: What an earlier sitting kept of them (`RunStore.models`).

    Raises:
        InputError: If a name, an address or a key is wrong, a mind can only describe, or a price that a budget needs is
            not known.
        SettingsError: If pictures of real places would be sent away and a person does not agree.
        PartError: If a model does not answer.
        MissingDependencyError: If it needs what is not installed.
    """
    if not plan.models:
        return ReadyModels(None, ())
    base_url = options.base_url or kept.get("base_url")
    budget = None if options.budget_usd is None else Budget(usd=options.budget_usd)
    desk = ModelDesk(
        base_url=base_url,
        key_variable=options.key_variable,
        prices=None if options.prices is None else read_prices(options.prices),
        budget=budget,
        abilities={name: abilities_from_json(said) for name, said in kept.get("abilities", {}).items()},
    )
    desk.check_minds(minds_called(plan.methods, plan.base))
    real = [place.name for place in plan.split.places if place.city != GENERATED]
    may_leave = options.agree(desk, plan.base.captioner, real)
    return ReadyModels(base_url, desk.prepare(plan.models), may_leave)


def tidy(folder: Path) -> None:
    """Take away from the folder of a run that is whole what only an unfinished one needs."""
    with suppress(OSError):
        (folder / SPENT_NAME).unlink(missing_ok=True)
        (folder / UNDER_WAY_NAME).rmdir()
