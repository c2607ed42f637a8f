"""How the models of many missions are reached, and what they may cost: plain data that every worker is given."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from hashlib import blake2b
from pathlib import Path

from reasoned_explorer.calls.abilities import Abilities
from reasoned_explorer.calls.budget import Budget
from reasoned_explorer.calls.cache import AnswerCache
from reasoned_explorer.calls.prices import read_prices
from reasoned_explorer.evaluation.model_desk import ModelDesk


@dataclass(frozen=True, slots=True)
class ModelAccess:
    """How the models of a run are reached. Nothing in it decides what they answer but where they are.

    Attributes:
        base_url: Where models of ``openai:…`` are; None for ``OPENAI_BASE_URL`` or OpenAI's own.
        key_variable: Environment variable of their key; None for ``OPENAI_API_KEY``.
        prices: File with what they cost, over what comes with this package, or None.
        cache: File of answers that may be used again, or None.
        sample_anew: Whether what is sampled is asked again all the same.
        budget_usd: US dollars for this sitting, all workers together, or None for no limit.
        budget_minutes: Real time for this sitting, or None for no limit.
        since_s: When the minutes began, seconds of this machine's monotonic clock; None for when a worker begins.
        spent: File in which the workers of this machine add up what they spend, or None for one worker.
        workers: How many there are.
        tapes: Folder of the tapes of missions that are under way, so that one that was broken off goes on without
            paying twice; None for none.
        pictures_may_leave: Whether pictures of real places may be sent to other machines.
        abilities: What models were found to be able to, by name: every worker asks in the same way.
    """

    base_url: str | None = None
    key_variable: str | None = None
    prices: Path | None = None
    cache: Path | None = None
    sample_anew: bool = False
    budget_usd: float | None = None
    budget_minutes: float | None = None
    since_s: float | None = None
    spent: Path | None = None
    workers: int = 1
    tapes: Path | None = None
    pictures_may_leave: bool = False
    abilities: tuple[tuple[str, Abilities], ...] = ()

    @property
    def is_limited(self) -> bool:
        """Whether there is a budget."""
        return self.budget_usd is not None or self.budget_minutes is not None

    def desk(self) -> ModelDesk:
        """Return the desk of one process.

        Raises:
            InputError: If a budget is none, or a file cannot be used.
        """
        budget = None
        if self.is_limited:
            budget = Budget(
                usd=self.budget_usd,
                minutes=self.budget_minutes,
                path=self.spent,
                sharers=self.workers,
                since_s=self.since_s,
            )
        return ModelDesk(
            base_url=self.base_url,
            key_variable=self.key_variable,
            prices=None if self.prices is None else read_prices(self.prices),
            cache=None if self.cache is None else AnswerCache(self.cache, sampled=not self.sample_anew),
            budget=budget,
            abilities=dict(self.abilities),
            pictures_may_leave=self.pictures_may_leave,
        )

    def tape_of(self, key: tuple[str, ...]) -> Path | None:
        """Return where the tape of a mission lies while it is under way."""
        if self.tapes is None:
            return None
        name = blake2b("\0".join(key).encode(), digest_size=12).hexdigest()
        return self.tapes / f"{name}.tape"

    def forget(self, key: tuple[str, ...]) -> None:
        """Take away the tape of a mission that is over and kept."""
        tape = self.tape_of(key)
        if tape is not None:
            tape.unlink(missing_ok=True)

    def knowing(self, abilities: Mapping[str, Abilities]) -> "ModelAccess":
        """Return it with what models were found to be able to."""
        return replace(self, abilities=tuple(sorted(abilities.items())))


#: OpenAI's own, or what ``OPENAI_BASE_URL`` says; no cache, no budget, no tapes.
PLAIN_ACCESS = ModelAccess()
