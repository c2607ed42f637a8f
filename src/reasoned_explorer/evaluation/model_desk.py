"""The models that missions call by name: made once, looked into once, and what all their calls have in common."""

import math
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any
from weakref import WeakSet

from reasoned_explorer.calls.abilities import Abilities, abilities_from_json, probe
from reasoned_explorer.calls.budget import Budget, faults_of_budget
from reasoned_explorer.calls.cache import AnswerCache
from reasoned_explorer.calls.caller import Caller
from reasoned_explorer.calls.chat import ChatAnswer, ChatModel, ChatRequest, is_model_name
from reasoned_explorer.calls.endpoint import AskingSettings
from reasoned_explorer.calls.ledger import Ledger
from reasoned_explorer.calls.openai_model import OpenAIModel, openai_model
from reasoned_explorer.calls.prices import OWN_MACHINE, Price, PriceTable
from reasoned_explorer.calls.tape import TapePlayer, TapeRecorder
from reasoned_explorer.clock import Clock, run_live
from reasoned_explorer.model import Fault, PartError, RecordError, SettingsError
from reasoned_explorer.model.checks import is_there
from reasoned_explorer.perception.prompted import PromptedCaptioner, captioner_for

#: Of models on this machine.
LOCAL_PREFIX = "hf:"
#: So many calls are made at once to see how many go on at once; a server is taken to have no limit from this share on.
_TOGETHER, _UNLIMITED_SHARE = 8, 0.75


@dataclass(frozen=True, slots=True)
class KnownModel:
    """A model, and what it can do.

    Attributes:
        model: Answers.
        abilities: What it was found to be able to.
    """

    model: ChatModel
    abilities: Abilities

    @property
    def price(self) -> Price | None:
        """Of its tokens, or None where it is not known."""
        return getattr(self.model, "price", OWN_MACHINE if self.model.is_local else None)


class _Taped:
    """Stands for the model whose answers are on a tape; there is nobody to ask."""

    def __init__(self, name: str, fingerprint: str, family: str) -> None:
        self.name, self.fingerprint, self.is_local, self.family = name, fingerprint, True, family

    async def ask(self, request: ChatRequest) -> ChatAnswer:  # noqa: ARG002 - the protocol's
        """Answer with a fault: whatever is not on the tape is not known."""
        return ChatAnswer(fault=f"{self.name} is replayed: nobody is asked")


class ModelDesk:
    """Makes callers of models for a mission; its calls share a cache, a budget and a tape.

    Args:
        base_url: Where models of ``openai:…`` are; None for ``OPENAI_BASE_URL`` or OpenAI's own.
        key_variable: Environment variable of their key; None for ``OPENAI_API_KEY``.
        prices: What they cost; None for the table that comes with this package.
        cache: Of answers that may be used again.
        budget: Of all calls.
        replay: A tape to take every answer from; no model is needed then.
        past: The tape of a mission that ended early and is gone on with: what was answered then is not asked again.
        asking: How endpoints are asked.
        abilities: What models are known to be able to; they are not tried again.
        pictures_may_leave: Whether pictures of real places may be sent to other machines: a person has said so.
    """

    def __init__(
        self,
        *,
        base_url: str | None = None,
        key_variable: str | None = None,
        prices: PriceTable | None = None,
        cache: AnswerCache | None = None,
        budget: Budget | None = None,
        replay: TapePlayer | None = None,
        past: TapePlayer | None = None,
        asking: AskingSettings | None = None,
        abilities: Mapping[str, Abilities] | None = None,
        pictures_may_leave: bool = False,
    ) -> None:
        self.pictures_may_leave = pictures_may_leave
        self._key_variable, self._prices = key_variable, prices
        self._base_url, self._cache, self._budget, self._player = base_url, cache, budget, replay
        self._recorder: TapeRecorder | None = None
        self._past = past
        self._asking = asking
        self._abilities = {**_taped_abilities(past), **(abilities or {})}
        self._known: dict[str, KnownModel] = {}
        # Weakly: a desk outlives many missions, and a tape is begun right after the callers of one were made.
        self._callers: WeakSet[Caller] = WeakSet()

    def prepare(self, names: Iterable[str]) -> tuple[KnownModel, ...]:
        """Make the models among some names and find out, in a few short calls, what each can do.

        A mission is not charged for these calls.

        Raises:
            SettingsError: If a name, an address or a key is wrong, or prices that a budget needs are not known.
            RecordError: If a tape that is to be replayed holds no calls of a model.
            MissingDependencyError: If an endpoint needs what is not installed.
            PartError: If a model does not answer at all.
        """
        wanted = list(dict.fromkeys(name for name in names if is_model_name(name)))
        self._check_priced([name for name in wanted if name not in self._known])
        for name in wanted:
            if name not in self._known:
                self._known[name] = self._look_into(name) if self._player is None else _taped(name, self._player)
        return tuple(self._known[name] for name in wanted)

    def _check_priced(self, names: Iterable[str]) -> None:
        """Check that the prices that a budget needs are known, before any call may cost something."""
        if self._player is not None or self._budget is None or self._budget.usd is None:
            return
        asked = [name for name in names if not name.startswith(LOCAL_PREFIX)]
        unpriced = [name for name in asked if self._behind_an_endpoint(name).price is None]
        if faults := faults_of_budget(self._budget.usd, self._budget.minutes, unpriced):
            raise SettingsError("budget", faults)

    def other_machine(self, name: str) -> str | None:
        """Return who on another machine is sent what a model is asked, or None where it stays here. Nobody is asked.

        Args:
            name: Of the model, which need not be ready.

        Raises:
            SettingsError: If the name, the address or a key is wrong.
            MissingDependencyError: If an endpoint needs what is not installed.
        """
        if self._player is not None or name.startswith(LOCAL_PREFIX):
            return None
        model = self._behind_an_endpoint(name)
        return None if model.is_local else f"{model.name} at {model.endpoint.base_url}"

    def _behind_an_endpoint(self, name: str) -> OpenAIModel:
        return openai_model(
            name,
            base_url=self._base_url,
            key_variable=self._key_variable,
            settings=self._asking,
            prices=self._prices,
        )

    def _look_into(self, name: str) -> KnownModel:
        if name.startswith(LOCAL_PREFIX):
            from reasoned_explorer.calls.local import load_local

            local = load_local(name)
            return KnownModel(local, self._abilities.get(name) or _found_out(local, together=2))
        model = self._behind_an_endpoint(name)
        abilities = self._abilities.get(name) or _found_out(model)
        at_once = _most_at_once(abilities) if model.is_local else None
        asked = model.asking(abilities.structure, most_at_once=at_once)
        return KnownModel(asked, abilities)

    def caller(self, name: str, clock: Clock, ledger: Ledger) -> Caller:
        """Return who asks a model for a mission.

        Raises:
            InputError, PartError: As `prepare`.
        """
        (known,) = self.prepare([name])
        tape = self._player or self._recorder
        caller = Caller(
            known.model,
            clock=clock,
            ledger=ledger,
            cache=self._cache,
            tape=tape,
            past=self._past,
            budget=self._budget,
        )
        self._callers.add(caller)
        return caller

    def check_minds(self, names: Iterable[str]) -> None:
        """Check that models can be minds, before any weights are read and anybody is asked.

        Raises:
            SettingsError: With all that describe pictures and do nothing else, or if one on this machine is none.
            MissingDependencyError: If one needs what is not installed.
        """
        expected, remedy = "a model that answers questions", "it may be a captioner"
        faults = [
            Fault(f"{name} describes pictures only", expected, remedy)
            for name in dict.fromkeys(names)
            if self._only_describes(name)
        ]
        if faults:
            raise SettingsError("minds", faults)

    def _only_describes(self, name: str) -> bool:
        if name in self._known:
            return getattr(self._known[name].model, "only_describes", False)
        if self._player is not None or not name.startswith(LOCAL_PREFIX):
            return False
        from reasoned_explorer.calls.local import only_describes

        return only_describes(name)

    def captioner(self, name: str, caller: Caller, *, seed: int, place: str | None) -> PromptedCaptioner:
        """Return the captioner that shows pictures to a model.

        Args:
            name: Of the model, which is ready.
            caller: Of it.
            seed: Of the mission.
            place: The real place that the pictures are of, or None for one that is nowhere on earth.

        Raises:
            SettingsError: If the model reads no pictures, or they would leave this machine and may not.
        """
        model = self._known[name].model
        if place is not None and not model.is_local and not self.pictures_may_leave:
            what = f"pictures of {place} would be sent to another machine, for {name}"
            remedy = "say --yes, or ModelDesk(pictures_may_leave=True)"
            raise SettingsError("captioner", [Fault(what, "a person's consent", remedy)])
        return captioner_for(model, caller, seed=seed)

    def abilities(self, name: str) -> Abilities:
        """Return what a model that is ready can do."""
        return self._known[name].abilities

    def record(self, path: Path, mission: Mapping[str, Any]) -> TapeRecorder:
        """Write every call of the callers made so far to a tape from now on.

        Args:
            path: Of the tape.
            mission: What the mission is: a replay is refused where it differs.

        Raises:
            RecordError: If there is such a file, or it cannot be made.
        """
        models = {
            name: {
                "fingerprint": known.model.fingerprint,
                "abilities": asdict(known.abilities),
                "family": getattr(known.model, "family", ""),
            }
            for name, known in self._known.items()
        }
        return self._record_to(TapeRecorder(path, about={"mission": dict(mission), "models": models}))

    def go_on(self, path: Path) -> TapeRecorder:
        """Write what callers ask from now on to the tape that the mission is gone on with from.

        Raises:
            RecordError: If it is no tape, or cannot be written.
        """
        return self._record_to(TapeRecorder.going_on(path))

    def _record_to(self, recorder: TapeRecorder) -> TapeRecorder:
        self._recorder = recorder
        for caller in self._callers:
            caller.record_to(recorder)
        return recorder

    @contextmanager
    def under_way(self, tape: Path | None, mission: Mapping[str, Any]) -> Iterator[None]:
        """Keep the calls of one mission of many on a tape while it runs, or go on from what is there.

        The callers are to be made inside. A tape of another mission, or that cannot be read, is begun anew.

        Args:
            tape: Where, in a folder that is there; None keeps none.
            mission: What the mission is.

        Raises:
            RecordError, RecordWriteError: If the tape cannot be written.
        """
        if tape is None:
            yield
            return
        self._past = _past_of(tape, mission)
        self._callers = WeakSet()
        if self._past is None:
            tape.unlink(missing_ok=True)
        recorder = self.record(tape, mission) if self._past is None else self.go_on(tape)
        try:
            with recorder:
                yield
        finally:
            self._past = self._recorder = None

    @property
    def denied(self) -> str | None:
        """Why a call might not begin: the budget is spent; None while it is not."""
        return None if self._budget is None else self._budget.denied

    @property
    def broken_off(self) -> str | None:
        """Why the last mission could not go on: the budget is spent, or a model is gone; None where it could."""
        gone = (caller.end[1] for caller in self._callers if caller.is_gone and caller.end is not None)
        return self.denied or next(gone, None)

    def check_taped(self, mission: Mapping[str, Any]) -> None:
        """Check that a mission is the one that is on the tape which is replayed or gone on with.

        Raises:
            RecordError: With everything that is another.
        """
        tape = self._player or self._past
        if tape is None:
            return
        taped = tape.about.get("mission", {})
        if not isinstance(taped, Mapping):
            raise RecordError("replay", [Fault(f"{tape.path} says of no mission", "a tape that --record wrote")])
        faults = [
            Fault(f"{name} is {here!r:.80}", f"{there!r:.80}, as on the tape")
            for name, here, there in _differences(mission, taped)
        ]
        if faults:
            raise RecordError("replay", faults)


def _differences(here: Mapping[str, Any], there: Mapping[str, Any], of: str = "") -> Iterator[tuple[str, Any, Any]]:
    """Return what two missions have differently: its name, with what it is part of, and both values."""
    for name in dict.fromkeys([*there, *here]):
        one, other = here.get(name), there.get(name)
        if isinstance(one, Mapping) and isinstance(other, Mapping):
            yield from _differences(one, other, f"{of}{name}.")
        elif one != other:
            yield f"{of}{name}", one, other


def _found_out(model: ChatModel, *, together: int = _TOGETHER) -> Abilities:
    abilities = run_live(lambda: probe(model, together=together))
    if not abilities.answers:
        raise PartError(model.name, f"it does not answer: {'; '.join(abilities.faults) or 'no reason given'}")
    return abilities


def _taped_abilities(tape: TapePlayer | None) -> dict[str, Abilities]:
    """Return what the models on a tape were able to, as far as it says: a mission goes on asking as it began."""
    models = {} if tape is None else tape.about.get("models", {})
    with suppress(TypeError, KeyError, AttributeError):
        return {name: abilities_from_json(about["abilities"]) for name, about in models.items()}
    return {}


def _past_of(tape: Path, mission: Mapping[str, Any]) -> TapePlayer | None:
    """Return the tape of an earlier part of a mission, or None where there is none of it."""
    try:
        past = TapePlayer(tape, unfinished=True) if is_there(tape) else None
    except RecordError:
        return None
    return past if past is not None and past.about.get("mission") == mission else None


def _most_at_once(abilities: Abilities) -> int | None:
    """Return how many calls at once a server on this machine bears; None where it was not seen to have a limit.

    Most of them answer one or a few calls at a time, and what waits in their line runs out of time there, is given up
    and is worked on all the same. Twice as many as go on at once keep such a server busy; the others wait here, where
    waiting costs no try. Elsewhere the measure says too little: a network's delays look like a limit.
    """
    limited = abilities.parallel < _UNLIMITED_SHARE * _TOGETHER
    return math.ceil(2.0 * abilities.parallel) if limited else None


def _taped(name: str, player: TapePlayer) -> KnownModel:
    about = player.about.get("models", {}).get(name)
    try:
        model = _Taped(name, about["fingerprint"], about.get("family", ""))
        return KnownModel(model, abilities_from_json(about["abilities"]))
    except (TypeError, KeyError) as error:
        held = ", ".join(player.about.get("models", {})) or "none"
        fault = Fault(f"no calls of {name} on the tape", f"one of those on it: {held}")
        raise RecordError("replay", [fault]) from error
