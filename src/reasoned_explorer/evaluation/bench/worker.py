"""One mission of a run, wherever it is run: in this process, in another, on another machine."""

import gc
import math
import time
import zlib
from dataclasses import dataclass, fields, replace
from functools import lru_cache
from typing import Any

from reasoned_explorer.calls.ledger import lost_calls
from reasoned_explorer.evaluation.bench.plan import BenchPlan, Task
from reasoned_explorer.evaluation.mission import Mission, MissionResult, judge_of
from reasoned_explorer.evaluation.mission_settings import models_of
from reasoned_explorer.evaluation.model_access import PLAIN_ACCESS, ModelAccess
from reasoned_explorer.evaluation.model_desk import ModelDesk
from reasoned_explorer.evaluation.record_file import record_bytes
from reasoned_explorer.evaluation.row import MissionRow
from reasoned_explorer.evaluation.scoring import MissionOutcome, MissionScore, score
from reasoned_explorer.model import Fault, ReasonedExplorerError, WorldError
from reasoned_explorer.model.record import MissionEnd, StepRecord
from reasoned_explorer.task.judge import Judge
from reasoned_explorer.task.split import Place, SplitEpisode
from reasoned_explorer.task.splitting import open_place
from reasoned_explorer.world.atlas import Atlas
from reasoned_explorer.world.taxonomy import CLASS_NAMES, OBJECT_CLASSES

#: What is at least this long is a large obstacle, metres; a plant's trunk is small.
LARGE_M = 3.0
_SMALL = frozenset(
    OBJECT_CLASSES[name].noun
    for name in CLASS_NAMES
    if OBJECT_CLASSES[name].kind == "plant" or max(OBJECT_CLASSES[name].size_m[:2]) < LARGE_M
)


@dataclass(frozen=True, slots=True)
class Done:
    """A mission that is over.

    Attributes:
        task: Which.
        row: Its row, as `MissionRow.as_json` gives it; None for one that was broken off and is to go on.
        trace: Its record, compressed, or None.
        wall_s: Seconds that it took on the machine that ran it.
        failed: A part failed.
        usd: What it cost, US dollars, as far as that is known.
        denied: Why no more missions are to begin, or None: the run's budget is spent, or a model is gone.
    """

    task: Task
    row: str | None
    trace: bytes | None
    wall_s: float
    failed: bool
    usd: float
    denied: str | None = None


@lru_cache(maxsize=2)
def _atlas_of(place: Place, digest: str) -> Atlas:
    """Open a place's world. Missions of a place come together; the second is for the moment of changing over.

    Raises:
        WorldError: If it cannot be opened, or is not the world that the split was made of.
    """
    gc.unfreeze()
    # Judges hold on to their worlds, and the missions of a place are over once another is opened.
    _judge_of.cache_clear()
    atlas = open_place(place)
    if atlas.digest != digest:
        what = f"{place.source} is another world than the one that the run's missions are of"
        expected = f"the world with the digest {digest[:12]}…; this one has {atlas.digest[:12]}…"
        raise WorldError(f"place {place.name}", [Fault(what, expected, "put it back, or start a new run")])
    gc.collect()
    # A world has hundreds of thousands of parts and no garbage: looking through it after each mission takes 20 ms.
    gc.freeze()
    return atlas


@lru_cache(maxsize=64)
def _judge_of(
    world: tuple[Place, str],
    episode: str,  # noqa: ARG001 - a key
    goal: str,
    vehicle: str,
    radius_m: float,
) -> Judge:
    """Return the judge of an episode: all methods share what it has found out about ways and sights."""
    return judge_of(goal, _atlas_of(*world), vehicle, radius_m)


@lru_cache(maxsize=1)
def _desk_of(access: ModelAccess) -> ModelDesk:
    """Make models once a process: what they can do is found out once, and their connections stay."""
    return access.desk()


def run_task(plan: BenchPlan, task: Task, access: ModelAccess = PLAIN_ACCESS) -> Done:
    """Run a mission. What goes wrong in it is its outcome, never an exception.

    Args:
        plan: Of the run.
        task: Which mission.
        access: How models are reached.

    Raises:
        WorldError: If its world is gone or is another one now: no mission of the run can be trusted then.
    """
    started_s = time.perf_counter()
    item = plan.episode_of(task)
    trace = None
    place, goal = plan.split.place(item.place), item.episode.spec.text
    world = place, plan.split.world_digests[place.name]
    atlas = _atlas_of(*world)
    try:
        settings = plan.settings_of(task)
        judge = _judge_of(world, item.episode.id, goal, settings.vehicle, settings.success_radius_m)
        desk = _desk_of(access)
        tape = access.tape_of(task.key) if models_of(settings) else None
        with desk.under_way(tape, {} if tape is None else {"mission": plan.digest_of(task)}):
            mission = Mission(goal, atlas, settings, start=item.episode.start, judge=judge, desk=desk)
            result = mission.run()
    except ReasonedExplorerError as error:
        row = failed_row(plan, task, str(error))
    else:
        # A call may have been denied and the mission have ended otherwise: without the budget it would be another.
        if (denied := desk.broken_off) is not None and models_of(settings):
            return Done(task, None, None, time.perf_counter() - started_s, failed=False, usd=0.0, denied=denied)
        row = _row_of(plan, task, item, result)
        if plan.keep_traces:
            trace = zlib.compress(record_bytes(result.record), 4)
    failed = row.end == MissionEnd.FAULT.value
    return Done(task, row.as_json(), trace, time.perf_counter() - started_s, failed, row.usd)


def failed_row(plan: BenchPlan, task: Task, reason: str) -> MissionRow:
    """Return the row of a mission that could not be run: a failure, with its reason; nothing is invented about it."""
    item = plan.episode_of(task)
    place = plan.split.place(item.place)
    outcome = MissionOutcome(
        mission_id=task.mission_id,
        level=item.episode.spec.level,
        vehicle=task.vehicle,
        declared=False,
        in_place=False,
        oracle_success=False,
        path_length_m=0.0,
        reference_length_m=item.episode.reference_length_m,
        computing_s=0.0,
        travelling_s=0.0,
        time_limit_s=plan.base.explorer.t_max_s,
        distance_to_goal_m=math.inf,
    )
    return MissionRow(
        method=task.method,
        mission_id=task.mission_id,
        place=place.name,
        city=place.city,
        district=place.district,
        band=item.band,
        goal=item.episode.spec.text,
        seed=item.episode.seed,
        planner=task.method,
        minds=plan.base.minds,
        captioner=plan.base.captioner,
        ct_label="",
        attribution="",
        end=MissionEnd.FAULT.value,
        reason=reason,
        judge="",
        declared=False,
        compliant=None,
        steps=0,
        calls=0,
        tokens_in=0,
        tokens_out=0,
        usd=0.0,
        lost_calls=0,
        evaluator_sum=0.0,
        evaluator_count=0,
        small_collisions=0,
        large_collisions=0,
        score=score(outcome),
    )


def _row_of(plan: BenchPlan, task: Task, item: SplitEpisode, result: MissionResult) -> MissionRow:
    header, summary, steps = result.record.header, result.summary, result.record.steps
    place = plan.split.place(item.place)
    calls = [call for step in steps for call in step.calls]
    scores = _evaluator_scores(steps)
    small = sum(what in _SMALL for what in summary.collisions)
    return MissionRow(
        method=task.method,
        mission_id=task.mission_id,
        place=place.name,
        city=place.city,
        district=place.district,
        band=item.band,
        goal=header.goal,
        seed=header.seed,
        planner=header.planner,
        minds=header.minds,
        captioner=header.captioner,
        ct_label=header.ct_label,
        attribution=header.attribution,
        end=summary.end.value,
        reason=summary.reason,
        judge=summary.judge,
        declared=summary.declared,
        compliant=summary.compliant,
        steps=summary.steps,
        calls=len(calls),
        tokens_in=sum(call.tokens_in for call in calls),
        tokens_out=sum(call.tokens_out for call in calls),
        usd=round(math.fsum(call.usd or 0.0 for call in calls), 9),
        unpriced=sum(call.usd is None for call in calls),
        lost_calls=len(lost_calls(calls)),
        evaluator_sum=round(math.fsum(scores), 4),
        evaluator_count=len(scores),
        small_collisions=small,
        large_collisions=len(summary.collisions) - small,
        score=_rounded(replace(result.score, mission_id=task.mission_id)),
    )


def _evaluator_scores(steps: tuple[StepRecord, ...]) -> list[float]:
    return [node.score for step in steps for node in step.tree if node.score is not None]


def _rounded(scored: MissionScore) -> MissionScore:
    """Round what is measured to the micro: floats of the last digit are no result."""
    plain: dict[str, Any] = {
        item.name: round(value, 6)
        for item in fields(scored)
        if isinstance(value := getattr(scored, item.name), float) and math.isfinite(value)
    }
    return replace(scored, **plain)
