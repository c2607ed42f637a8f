"""How any mission runs, whoever judges it: the agent is put together, runs, and its record is written as it happens."""

import gc
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

from reasoned_explorer.calls.caller import Caller, end_of
from reasoned_explorer.calls.chat import is_model_name
from reasoned_explorer.calls.ledger import CallRecord, Ledger
from reasoned_explorer.clock import Clock
from reasoned_explorer.evaluation.guide import Guide
from reasoned_explorer.evaluation.mission_settings import THROUGH_PIXELS, MissionSettings, with_overrides
from reasoned_explorer.evaluation.model_desk import ModelDesk
from reasoned_explorer.evaluation.picture_folder import KeepingCaptioner
from reasoned_explorer.evaluation.record_file import RecordWriter
from reasoned_explorer.evaluation.scoring import MissionScore
from reasoned_explorer.exploration.explorer import Exploration, Explorer, Parts
from reasoned_explorer.geometry import GeoOrigin, Pose
from reasoned_explorer.minds.context import MindContext, Minds
from reasoned_explorer.minds.latency import latency_profile
from reasoned_explorer.minds.prompted import prompted_minds
from reasoned_explorer.minds.registry import make_minds
from reasoned_explorer.model import Goal, RecordWriteError
from reasoned_explorer.model.garbage import RARELY
from reasoned_explorer.model.record import EpisodeRecord, MissionEnd, MissionHeader, MissionSummary, StepRecord
from reasoned_explorer.perception import Captioner
from reasoned_explorer.perception.context import CaptionerContext
from reasoned_explorer.perception.registry import CAPTIONERS
from reasoned_explorer.planning.registry import make_planner
from reasoned_explorer.task.goal_spec import GoalSpec
from reasoned_explorer.vehicles import VehicleProfile
from reasoned_explorer.vehicles.looking import Content
from reasoned_explorer.vehicles.safety.guard import GuardedVehicle
from reasoned_explorer.vehicles.safety.watch import RangeAhead
from reasoned_explorer.vehicles.vehicle import Vehicle


class MissionCourse(ABC):
    """A mission that is ready to run: every input has been checked, nothing has been written.

    Attributes:
        settings: Who does what; once the explorer is made, with what its planner brings.
        spec: What the goal asks for.
        goal: The goal.
        profile: Of the vehicle.
        clock: Mission time.
        start: Where it begins.
        explorer: Who explores.
    """

    settings: MissionSettings
    spec: GoalSpec
    goal: Goal
    profile: VehicleProfile
    clock: Clock
    start: Pose
    explorer: Explorer | Guide
    _desk: ModelDesk | None
    _pictures: Path | None
    _labels: tuple[str, str, str]

    @property
    @abstractmethod
    def header(self) -> MissionHeader:
        """What the mission starts with."""

    @property
    @abstractmethod
    def home(self) -> Pose:
        """Where the frame in which the vehicle tells its position begins, in the mission's."""

    @property
    def keeps_pictures(self) -> bool:
        """Whether the pictures of all views are kept."""
        return self._pictures is not None

    @property
    def origin(self) -> GeoOrigin | None:
        """Where on earth the origin of the mission's frame lies; None where nobody knows."""
        return None

    def content(self) -> Content | None:
        """Return what says what a camera of the world shows; None where no world is known."""
        return None

    def range_ahead(self) -> RangeAhead | None:
        """Return what says how far something of the world stands before a pose; None where no world is known."""
        return None

    @abstractmethod
    def _vehicle(self) -> Vehicle:
        """Return the mission's vehicle."""

    @abstractmethod
    def _summary(
        self, header: MissionHeader, ended: Exploration, steps: list[StepRecord]
    ) -> tuple[MissionSummary, MissionScore | None]:
        """Return how it ended, and what it scored where somebody judges it."""

    def _place(self) -> str | None:
        """Return the real place that pictures are of; None for one that is nowhere on earth."""
        return None

    def _record(
        self, folder: Path | None, on_step: Callable[[StepRecord], None] | None
    ) -> tuple[EpisodeRecord, MissionScore | None, Path | None]:
        """Run the mission to its end; return its record, what it scored and the folder of the record."""
        header = self.header
        steps: list[StepRecord] = []
        if folder is None:
            return self._carry_out(header, steps, None, on_step)
        with RecordWriter(folder) as writer:
            writer.header(header)
            return self._carry_out(header, steps, writer, on_step)

    def _carry_out(
        self,
        header: MissionHeader,
        steps: list[StepRecord],
        writer: RecordWriter | None,
        on_step: Callable[[StepRecord], None] | None,
    ) -> tuple[EpisodeRecord, MissionScore | None, Path | None]:
        def keep(step: StepRecord) -> None:
            steps.append(step)
            if writer is not None:
                writer.step(step)
            if on_step is not None:
                on_step(step)

        self.explorer.on_step = keep
        try:
            with _rare_collections():
                exploration = self.clock.run(self.explorer.run(self.goal))
        except KeyboardInterrupt:
            self._break_off("stopped by a person", header, steps, writer)
            raise
        except RecordWriteError as error:
            # A summary is short: often there is room for it where there was none for a step.
            with suppress(RecordWriteError):
                self._break_off(str(error), header, steps, writer)
            raise
        summary, score = self._summary(header, exploration, steps)
        if writer is not None:
            writer.summary(summary)
        folder = writer.path.parent if writer is not None else None
        return EpisodeRecord(header, tuple(steps), summary), score, folder

    def _break_off(
        self, reason: str, header: MissionHeader, steps: list[StepRecord], writer: RecordWriter | None
    ) -> None:
        """Have the record say why it ends here."""
        if writer is not None:
            stopped = self._exploration_so_far(steps, reason)
            writer.summary(self._summary(header, stopped, steps)[0])

    def _explorer(self, truth: Any) -> Explorer:
        """Return the agent; privileged minds alone read the truth, None where nobody knows it."""
        settings, ledger = self.settings, Ledger()
        latency = latency_profile(settings.latency)
        callers: list[Caller] = []

        def desk_for_all() -> ModelDesk:
            self._desk = self._desk or ModelDesk()
            return self._desk

        def caller_of(name: str) -> tuple[ModelDesk, Caller]:
            desk = desk_for_all()
            callers.append(desk.caller(name, self.clock, ledger))
            return desk, callers[-1]

        def model_minds(name: str) -> Minds:
            desk_for_all().check_minds([name])
            desk, caller = caller_of(name)
            return prompted_minds(caller, name=name, abilities=desk.abilities(name), seed=settings.seed)

        def model_captioner(name: str) -> Captioner:
            desk, caller = caller_of(name)
            return desk.captioner(name, caller, seed=settings.seed, place=self._place())

        minds = make_minds(
            MindContext(self.clock, latency, ledger, settings.seed, truth, model_minds),
            settings.minds,
            visionary=settings.visionary,
            evaluator=settings.evaluator,
            checker=settings.checker,
        )

        async def charge_captions(_role: str, key: tuple[int, ...], count: int) -> None:
            started_s = round(self.clock.now_s(), 6)
            spent_s = [latency.duration_s("caption", settings.seed, *key, index) for index in range(count)]
            await self.clock.think(max(spent_s, default=0.0))
            ledger.add_all(
                CallRecord("caption", settings.captioner, (*key, index), started_s, round(seconds, 6))
                for index, seconds in enumerate(spent_s)
            )

        captioner: Captioner
        if is_model_name(settings.captioner):
            captioner = model_captioner(settings.captioner)
        else:
            context = CaptionerContext(self.clock, settings.seed, charge_captions)
            captioner = CAPTIONERS.load(settings.captioner)(context)
        if self._pictures is not None:
            captioner = KeepingCaptioner(captioner, self._pictures)
        planner = make_planner(settings.planner, minds, settings.planner_settings)
        through = THROUGH_PIXELS if settings.eyes == "pixels" and not is_model_name(settings.captioner) else ""
        self._labels = (planner.label, minds.label, captioner.label + through)
        explorer = with_overrides(settings.explorer, planner)
        self.settings = replace(settings, explorer=explorer)
        vehicle, models_end = self._vehicle(), end_of(callers)
        parts = Parts(vehicle, captioner, planner, minds.checker, self.clock, ledger, models_end)
        if isinstance(vehicle, GuardedVehicle):
            guard = vehicle
            _listen_for_lost_calls(guard, ledger)
            parts = replace(
                parts,
                must_end=lambda: models_end() or guard.must_end(),
                take_interventions=guard.take_interventions,
            )
        return Explorer(parts, explorer)

    def _ct_label(self) -> str:
        measured = {"virtual": "modelled", "mixed": "measured, modelled where embedded", "real": "measured"}
        return f"{measured[self.settings.clock]} ({self.settings.latency})"

    def _exploration_so_far(self, steps: list[StepRecord], reason: str) -> Exploration:
        last = steps[-1] if steps else None
        plan_s = sum(step.plan_s for step in steps)
        ct_s, tt_s = (last.ct_s, last.tt_s) if last else (0.0, 0.0)
        return Exploration(MissionEnd.INTERRUPTED, reason, ct_s, tt_s, plan_s, len(steps))


def calls_by_role(steps: list[StepRecord]) -> dict[str, int]:
    """Return how many calls of models there were, by role."""
    calls: dict[str, int] = {}
    for step in steps:
        for call in step.calls:
            calls[call.role] = calls.get(call.role, 0) + 1
    return dict(sorted(calls.items()))


@cache
def versions() -> tuple[tuple[str, str], ...]:
    """Return the versions of this package and of those that decide results."""
    return tuple((name, version(name)) for name in ("reasoned-explorer", "numpy", "numba", "shapely"))


@contextmanager
def _rare_collections() -> Iterator[None]:
    """Look for garbage cycles rarely: a mission makes few, and looking goes through the whole world each time."""
    before = gc.get_threshold()
    gc.set_threshold(*RARELY)
    try:
        yield
    finally:
        gc.set_threshold(*before)


def _listen_for_lost_calls(guard: GuardedVehicle, ledger: Ledger) -> None:
    """Have a guard told what comes of each call of a model."""

    def hear(call: CallRecord) -> None:
        if is_model_name(call.model):
            guard.note_model_call(answered=call.fault is None, why=call.fault or "")

    ledger.on_call = hear
