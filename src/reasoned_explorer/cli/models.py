"""What a person says about models that are called."""

import json
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any

from reasoned_explorer.calls.budget import Budget, faults_of_budget
from reasoned_explorer.calls.cache import AnswerCache
from reasoned_explorer.calls.chat import is_model_name
from reasoned_explorer.calls.endpoint import endpoint_at
from reasoned_explorer.calls.prices import read_prices
from reasoned_explorer.calls.tape import TapePlayer
from reasoned_explorer.cli.answers import complain
from reasoned_explorer.cli.consent import agree_to_send
from reasoned_explorer.evaluation.mission_course import MissionCourse
from reasoned_explorer.evaluation.mission_settings import MissionSettings, models_of
from reasoned_explorer.evaluation.model_desk import ModelDesk
from reasoned_explorer.model import Fault, Gathering, RecordError, SettingsError
from reasoned_explorer.model.checks import is_there
from reasoned_explorer.model.disk import disk_error

#: Of the calls of a mission, in its folder.
TAPE_NAME = "calls.tape"
#: Two missions whose headers agree in these are the same mission.
_IDENTITY = ("goal", "world_digest", "start", "settings")


@dataclass(frozen=True, slots=True)
class ModelOptions:
    """What a person typed; see ``rex run --help`` and ``rex bench --help``."""

    base_url: str | None = None
    key_variable: str | None = None
    prices: Path | None = None
    record: Path | None = None
    replay: Path | None = None
    resume: Path | None = None
    cache: Path | None = None
    sample_anew: bool = False
    budget_usd: float | None = None
    budget_minutes: float | None = None
    yes: bool = False

    def faults(self, called: Sequence[str]) -> list[Fault]:
        """Return what is wrong with it, as far as can be told before a model is asked.

        Args:
            called: The models that are to be called.
        """
        faults = [
            *_recording_faults(self.record, self.replay, self.resume),
            *faults_of_budget(self.budget_usd, self.budget_minutes),
        ]
        found = Gathering()
        if self.prices is not None and called:
            found.check(partial(read_prices, self.prices))
        if self.base_url is not None and called and self.replay is None:
            found.check(partial(endpoint_at, self.base_url, key_variable=self.key_variable))
        faults += found.faults
        if self.sample_anew and self.cache is None:
            faults.append(Fault("--sample-anew without --cache", "a cache to leave aside", "name one, or leave it out"))
        if not called:
            faults += [
                Fault(f"{name} without a model that is called", "minds such as openai:gpt-4o-mini", "or leave it out")
                for name, value in self._named()
                if value is not None
            ]
        return faults

    def _named(self) -> list[tuple[str, object]]:
        plain = asdict(self)
        del plain["yes"]
        return [(f"--{name.replace('_', '-')}", value) for name, value in plain.items() if value is not False]

    def check(self, settings: MissionSettings, found: Gathering) -> None:
        """Keep what is wrong with it for one mission."""
        if faults := self.faults(models_of(settings)):
            found.add(SettingsError("models", faults))

    def desk(self) -> ModelDesk:
        """Return the desk that makes what a mission calls.

        Raises:
            InputError: If a tape or a cache cannot be read, or a budget is none.
        """
        limited = self.budget_usd is not None or self.budget_minutes is not None
        return ModelDesk(
            base_url=self.base_url,
            key_variable=self.key_variable,
            prices=None if self.prices is None else read_prices(self.prices),
            cache=None if self.cache is None else AnswerCache(self.cache, sampled=not self.sample_anew),
            budget=Budget(usd=self.budget_usd, minutes=self.budget_minutes) if limited else None,
            replay=None if self.replay is None else TapePlayer(self.replay),
            past=None if self.resume is None else TapePlayer(self.resume, unfinished=True),
        )

    def tape_in(self, folder: Path, settings: MissionSettings) -> Path | None:
        """Return where the calls of a mission are kept, or None where there are none, or all come from a tape."""
        if not models_of(settings) or self.replay is not None:
            return None
        return self.resume or self.record or folder / TAPE_NAME

    def agree(self, desk: ModelDesk, captioner: str, places: Sequence[str]) -> bool:
        """Return whether pictures may leave this machine; where they would, a person is asked once, before any call.

        Args:
            desk: Knows where the captioner is.
            captioner: Name of the captioner.
            places: The real places that pictures would be of.

        Raises:
            SettingsError: If a person does not agree, or cannot be asked; or as `ModelDesk.other_machine`.
            MissingDependencyError: As `ModelDesk.other_machine`.
        """
        who = desk.other_machine(captioner) if is_model_name(captioner) and places else None
        if who is None:
            return False
        agree_to_send(who, places, yes=self.yes)
        desk.pictures_may_leave = True
        return True

    def say_how_to_go_on(self, desk: ModelDesk, folder: Path) -> None:
        """Say how a mission goes on that the budget or a lost model has ended; nothing for any other."""
        if desk.broken_off is not None:
            tape = self.resume or self.record or folder / TAPE_NAME
            more = "" if desk.denied is None else " and another budget"
            complain(f"go on with it: the same command with --resume {tape}, a new --out{more}")

    @contextmanager
    def taping(self, desk: ModelDesk, mission: MissionCourse, folder: Path) -> Iterator[None]:
        """Write what a mission calls to a tape, or see that it is the one on the tape.

        Args:
            desk: Of the mission.
            mission: The mission.
            folder: Of its record; made if the tape lies in it, and taken away again if nothing comes of the mission.

        Raises:
            RecordError: If it is another mission, or no tape can be begun.
        """
        header = mission.header
        about: dict[str, Any] = json.loads(json.dumps({name: getattr(header, name) for name in _IDENTITY}))
        desk.check_taped(about)
        tape = self.tape_in(folder, mission.settings)
        if tape is None:
            yield
        elif self.resume is not None:
            with desk.go_on(tape):
                yield
        elif self.record is not None:
            with desk.record(tape, about):
                yield
        else:
            with made_for(tape), desk.record(tape, about):
                try:
                    yield
                except KeyboardInterrupt:
                    complain(f"its calls are kept: the same command with --resume {tape} and a new --out goes on")
                    raise


@contextmanager
def made_for(tape: Path) -> Iterator[None]:
    """Make the folder of a tape; if nothing else came into it when something goes wrong, leave nothing behind.

    Raises:
        RecordError: If it cannot be made.
        PartError: If the disk fails.
    """
    folder = tape.parent
    made = [each for each in (folder, *folder.parents) if not each.exists()]
    try:
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise disk_error("tape", tape, error, kind=RecordError) from error
        yield
    except BaseException:
        if not any(each != tape for each in folder.glob("*")):
            with suppress(OSError):
                tape.unlink(missing_ok=True)
                for each in made:
                    each.rmdir()
        raise


def _recording_faults(record: Path | None, replay: Path | None, resume: Path | None = None) -> list[Fault]:
    """Return what is wrong with the tapes that were asked for, as far as can be told without opening them."""
    faults = []
    given = {"--record": record, "--replay": replay, "--resume": resume}
    named = [name for name, path in given.items() if path is not None]
    if len(named) > 1:
        faults.append(Fault(" beside ".join(named), "one of them"))
    if record is not None and is_there(record):
        faults.append(Fault(f"{record} is there already", "a name without a file", "give another name, or delete it"))
    faults += [
        Fault(f"there is no file {path}", "a tape that --record wrote")
        for path in (replay, resume)
        if path is not None and not path.is_file()
    ]
    return faults
