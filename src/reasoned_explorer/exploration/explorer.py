"""The agent's loop: look, describe, imagine and check at the same time, remember, choose, travel."""

import asyncio
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise

from reasoned_explorer.calls.ledger import Ledger
from reasoned_explorer.clock import Clock
from reasoned_explorer.exploration.draft import LookDraft, StepDraft
from reasoned_explorer.exploration.graph import Choice, Frontier, FrontierState, TopologicalGraph
from reasoned_explorer.exploration.settings import ExplorerSettings
from reasoned_explorer.geometry import Pose, normalise_heading_rad
from reasoned_explorer.minds.mind import GoalChecker
from reasoned_explorer.model import Goal, LegOutcome, PartError, Scene, Undescribed, Verdict, View
from reasoned_explorer.model.record import InterventionRecord, MissionEnd, StepRecord
from reasoned_explorer.perception import Captioner
from reasoned_explorer.planning import FrontierScore, Plan, Planner
from reasoned_explorer.vehicles import Vehicle

#: A leg that came less far than this ended where it began: looking again from there would show the same.
_NOWHERE_M = 1.0


@dataclass(frozen=True, slots=True)
class Parts:
    """What an explorer is made of.

    Attributes:
        vehicle: Looks and moves.
        captioner: Says what views show.
        planner: Scores frontiers.
        checker: Notices the goal.
        clock: Mission time.
        ledger: Where the parts write their calls.
        must_end: Tells how the mission must end now, and why, where no model can be asked any more or the vehicle's
            guard lets it go nowhere: the run's budget is spent, say. Asked after each look and after each travel.
        take_interventions: Returns what the vehicle's guard did since it was last asked.
    """

    vehicle: Vehicle
    captioner: Captioner
    planner: Planner
    checker: GoalChecker
    clock: Clock
    ledger: Ledger
    must_end: Callable[[], tuple[MissionEnd, str] | None] = lambda: None
    take_interventions: Callable[[], Sequence[InterventionRecord]] = lambda: ()


@dataclass(slots=True)
class Exploration:
    """How an exploration ended.

    Attributes:
        end: How.
        reason: In words.
        ct_s: Every second of waiting for a decision.
        tt_s: Every second of looking and travelling.
        plan_s: The planner's share of CT.
        steps: Steps made.
    """

    end: MissionEnd
    reason: str
    ct_s: float
    tt_s: float
    plan_s: float
    steps: int


@dataclass(slots=True)
class Explorer:
    """The agent, written once against a vehicle and a clock.

    Attributes:
        parts: What it is made of.
        settings: How it explores.
        on_step: Called with the record of each step as soon as the step is over.
        graph: What it remembers.
    """

    parts: Parts
    settings: ExplorerSettings = field(default_factory=ExplorerSettings)
    on_step: Callable[[StepRecord], None] | None = None
    graph: TopologicalGraph = field(init=False)
    _point: int = field(init=False, default=0)
    _look_heading_rad: float | None = field(init=False, default=None)
    _looks_around: dict[int, int] = field(init=False, default_factory=dict)
    _look_next: bool = field(init=False, default=True)
    _stopped: bool = field(init=False, default=False)
    _faults_in_a_row: int = field(init=False, default=0)
    _ct_s: float = field(init=False, default=0.0)
    _tt_s: float = field(init=False, default=0.0)
    _plan_s: float = field(init=False, default=0.0)
    _calls_kept: int = field(init=False, default=0)

    def __post_init__(self) -> None:
        self.graph = TopologicalGraph(
            self.settings.merge_radius_m,
            self.settings.sharpness_per_m,
            self.settings.half_distance_m,
            self.settings.known_radius_m,
            self.settings.straight_distance or self.settings.straight_legs,
        )

    async def run(self, goal: Goal) -> Exploration:
        """Explore until the goal is declared found, the time or budget is over, nothing is left, or a part fails.

        Faults of parts are outcomes, not exceptions; only cancellation and programming errors come out.
        """
        try:
            async with self.parts.vehicle:
                self._point = self.graph.add_point(self.parts.vehicle.pose)
                return await self._loop(goal)
        except PartError as fault:
            # Only starting and closing the vehicle can get here.
            return self._ended(MissionEnd.FAULT, str(fault), steps=0)

    async def _loop(self, goal: Goal) -> Exploration:
        for number in range(self.settings.max_steps):
            step = StepDraft(number, self.parts.clock.now_s(), self.parts.vehicle.pose, self._point)
            ended = await self._advance(goal, step)
            self._close_step(step)
            if ended is None and self._faults_in_a_row >= self.settings.max_faults_in_a_row:
                ended = MissionEnd.FAULT, step.notes[-1]
            if ended is not None:
                return self._ended(*ended, steps=number + 1)
        return self._ended(MissionEnd.BUDGET_SPENT, f"{self.settings.max_steps} steps", steps=self.settings.max_steps)

    def _ended(self, end: MissionEnd, reason: str, *, steps: int) -> Exploration:
        return Exploration(end, reason, self._ct_s, self._tt_s, self._plan_s, steps)

    def _close_step(self, step: StepDraft) -> None:
        self._faults_in_a_row = self._faults_in_a_row + 1 if step.faults else 0
        self._ct_s += step.think_s
        self._tt_s += step.look_s + step.travel_s
        self._plan_s += step.plan_s
        calls = self.parts.ledger.since(self._calls_kept)
        self._calls_kept += len(calls)
        kept = [call.rounded() for call in calls]
        record = step.freeze(
            ended_s=self.parts.clock.now_s(),
            ct_s=self._ct_s,
            tt_s=self._tt_s,
            calls=kept,
            interventions=self.parts.take_interventions(),
        )
        if self.on_step is not None:
            self.on_step(record)

    async def _advance(self, goal: Goal, step: StepDraft) -> tuple[MissionEnd, str] | None:
        """Make one step; return how the mission ended if it did."""
        if self._look_next:
            ended = await self._look_and_think(goal, step) or self.parts.must_end()
            if ended is not None:
                return ended
        self._look_next = True
        if self._time_is_over():
            return self._time_over()
        step.choice = self.graph.choose(self._point)
        if step.choice is None:
            return await self._look_elsewhere(step)
        await self._travel(step, step.choice)
        return self._time_over() if self._time_is_over() else self.parts.must_end()

    def _time_is_over(self) -> bool:
        return self.parts.clock.now_s() >= self.settings.t_max_s

    def _time_over(self) -> tuple[MissionEnd, str]:
        return MissionEnd.TIME_OVER, f"T_max of {self.settings.t_max_s:g} s is over"

    # Look, describe, imagine, check.

    async def _look_and_think(self, goal: Goal, step: StepDraft) -> tuple[MissionEnd, str] | None:
        ahead_rad = self.parts.vehicle.pose.heading_rad
        heading_rad = ahead_rad if self._look_heading_rad is None else self._look_heading_rad
        turns = self.settings.bearings_rad()
        if self._stopped and self.settings.look_back_after_stop:
            turns += [math.pi + turn for turn in turns]
        self._stopped = False
        look = await self._look(goal, step, [heading_rad + turn for turn in turns])
        if look is None:
            return None
        started_s, looked_s = self.parts.clock.now_s(), step.look_s
        planning = asyncio.ensure_future(self._plan(goal, look.scenes, step))
        try:
            if self.settings.check_after_planning:
                step.plan = await planning
                look.scores = step.plan.scores
            evidence = await self._check(goal, look, step)
            if evidence is not None:
                # The robot is there; what is still being imagined is no longer needed.
                await _cancel(planning)
                if self._time_is_over():
                    return self._time_over()
                return MissionEnd.FOUND, evidence
            step.plan = await planning
        finally:
            await _cancel(planning)
            # Looking once more to make sure is acting, not thinking.
            step.think_s += self.parts.clock.now_s() - started_s - (step.look_s - looked_s)
            step.plan_s = min(step.plan_s, step.think_s)
        look.scores = step.plan.scores
        self._expand(goal, look, step)
        return None

    async def _look(self, goal: Goal, step: StepDraft, headings_rad: Sequence[float]) -> LookDraft | None:
        """Look in some headings and describe what is seen; None, with a note, where the camera gave nothing."""
        headings = [normalise_heading_rad(heading_rad) for heading_rad in headings_rad]
        started_s = self.parts.clock.now_s()
        try:
            views = await self.parts.vehicle.look(headings)
        except PartError as fault:
            self._note_fault(step, fault)
            return None
        finally:
            step.look_s += self.parts.clock.now_s() - started_s
        started_s = self.parts.clock.now_s()
        scenes = await self._describe(goal, views, step)
        step.think_s += self.parts.clock.now_s() - started_s
        look = LookDraft(scenes)
        step.looks.append(look)
        return look

    async def _describe(self, goal: Goal, views: Sequence[View], step: StepDraft) -> list[Scene]:
        told: Sequence[str | Undescribed]
        try:
            told = await self.parts.captioner.describe(goal, views)
            # The step is sound: it goes on with the views that are described.
            missing = [(index, one) for index, one in enumerate(told) if isinstance(one, Undescribed)]
            step.notes.extend(f"view {index} is not described: {one.fault}" for index, one in missing)
        except PartError as fault:
            self._note_fault(step, fault)
            told = [Undescribed(str(fault))] * len(views)
        nominal_m = self.settings.step_range_m(goal.level)[0]
        number = len(step.looks)
        return [
            Scene(
                "" if isinstance(one, Undescribed) else one,
                (step.step, number, index),
                view.pose.ahead(nominal_m),
                0,
                one.fault if isinstance(one, Undescribed) else None,
                view.pose,
            )
            for index, (view, one) in enumerate(zip(views, told, strict=True))
        ]

    async def _plan(self, goal: Goal, scenes: Sequence[Scene], step: StepDraft) -> Plan:
        started_s = self.parts.clock.now_s()
        try:
            return await self.parts.planner.plan(goal, scenes)
        except PartError as fault:
            self._note_fault(step, fault)
            return Plan(tuple(FrontierScore(None, fault=str(fault)) for _ in scenes))
        finally:
            step.plan_s += self.parts.clock.now_s() - started_s

    async def _check(self, goal: Goal, look: LookDraft, step: StepDraft) -> str | None:
        """Return the evidence where the goal is seen within reach, look after look; None where it is not."""
        best = await self._verdict(goal, look, step)
        for _ in range(self.settings.looks_to_confirm - 1):
            if best is None:
                return None
            index, _verdict = best
            viewpoint = look.scenes[index].viewpoint or look.scenes[index].waypoint
            thought_s = step.think_s
            again = await self._look(goal, step, [viewpoint.heading_rad])
            # Describing it ran while the caller's own clock of thinking did: count it once.
            step.think_s = thought_s
            if again is None:
                return None
            look = again
            best = await self._verdict(goal, look, step)
            if best is None:
                step.notes.append("goal seen, but not in the second look")
        return best[1].evidence or "seen within reach" if best else None

    async def _verdict(self, goal: Goal, look: LookDraft, step: StepDraft) -> tuple[int, Verdict] | None:
        asked = [index for index, scene in enumerate(look.scenes) if scene.fault is None]
        verdicts = [Verdict(found=False, confidence=0.0, fault=scene.fault) for scene in look.scenes]
        look.verdicts = verdicts
        for batch in [[index] for index in asked] if self.settings.check_after_planning else [asked]:
            try:
                answers = await self.parts.checker.check(goal, [look.scenes[index] for index in batch])
            except PartError as fault:
                self._note_fault(step, fault)
                return None
            for index, verdict in zip(batch, answers, strict=True):
                verdicts[index] = verdict
            if any(verdict.found for verdict in answers):
                break
        found = [(-verdict.confidence, index) for index, verdict in enumerate(verdicts) if verdict.found]
        return (min(found)[1], verdicts[min(found)[1]]) if found else None

    # Remember, choose, travel.

    def _expand(self, goal: Goal, look: LookDraft, step: StepDraft) -> None:
        for index in look.from_the_middle():
            scene, score = look.scenes[index], look.scores[index]
            viewpoint = scene.viewpoint or scene.waypoint
            pose = viewpoint.ahead(self.settings.step_m(score.q, goal.level))
            blocked_by = "the way ahead is blocked" if score.blocked else ""
            frontier = self.graph.add_frontier(
                self._point, pose, score.q, forbidden=score.forbidden, blocked_by=blocked_by
            )
            visited = self.graph.nearest_point(pose.x_m, pose.y_m, self.settings.revisit_radius_m)
            if frontier.state is FrontierState.OPEN and visited not in (None, self._point):
                self.graph.give_up(frontier, "already visited")
            look.frontiers[index] = frontier.id
            step.touched[frontier.id] = frontier

    async def _look_elsewhere(self, step: StepDraft) -> tuple[MissionEnd, str] | None:
        """With nothing in the buffer: look in other headings, here or at the nearest path point that has some left."""
        if step.faults:
            return None  # nothing was seen; the next step looks again
        turns = self.settings.other_turns_rad()
        left = [point for point in self.graph.by_distance(self._point) if self._looks_around.get(point, 0) < len(turns)]
        for point in left:
            tried = self._looks_around.get(point, 0)
            self._looks_around[point] = tried + 1
            step.notes.append(f"nothing left in the buffer: looking elsewhere from path point {point}")
            if not await self._go_back(step, point):
                return None
            self._look_heading_rad = self.graph.points[point].heading_rad + turns[tried]
            return None
        return MissionEnd.NOTHING_LEFT, "every frontier is visited, blocked or given up"

    async def _go_back(self, step: StepDraft, point: int) -> bool:
        """Travel along known edges to an earlier path point; return whether it was reached."""
        for target in _facing_onwards(self.graph.way(self._point, point)):
            if not await self._leg(step, None, target):
                return False
            self._point = self.graph.add_point(self.parts.vehicle.pose, previous=self._point)
        return True

    async def _travel(self, step: StepDraft, choice: Choice) -> None:
        frontier = choice.frontier
        self.graph.take(frontier)
        step.touched[frontier.id] = frontier
        route = [frontier.pose] if self.settings.straight_legs else self.graph.route(self._point, frontier)
        self._look_heading_rad = None
        for target in _facing_onwards(route):
            if not await self._leg(step, frontier, target):
                break
            self._point = self.graph.add_point(self.parts.vehicle.pose, previous=self._point)

    async def _leg(self, step: StepDraft, frontier: Frontier | None, target: Pose) -> bool:
        """Travel one leg; return whether it arrived. If not, the frontier that it led to is given up with a reason."""
        started_s = self.parts.clock.now_s()
        try:
            leg = await self.parts.vehicle.go_to(target)
        except PartError as fault:
            self._note_fault(step, fault)
            if frontier is not None:
                self.graph.give_up(frontier, str(fault))
            return False
        finally:
            step.travel_s += self.parts.clock.now_s() - started_s
        step.legs.append(leg)
        if leg.outcome is LegOutcome.ARRIVED:
            return True
        reason = f"{leg.outcome.value}: {leg.detail}" if leg.detail else leg.outcome.value
        if frontier is not None:
            self.graph.give_up(frontier, reason)
            step.notes.append(f"frontier {frontier.id} given up: {reason}")
        self._look_next = leg.length_m >= _NOWHERE_M
        self._stopped = True
        if self._look_next:
            self._point = self.graph.add_point(self.parts.vehicle.pose, previous=self._point)
        return False

    def _note_fault(self, step: StepDraft, fault: PartError) -> None:
        step.faults += 1
        step.notes.append(f"fault: {fault}")


def _facing_onwards(route: list[Pose]) -> list[Pose]:
    """Return the route's waypoints, each but the last facing the next."""
    turned = []
    for here, there in pairwise(route):
        turned.append(here.facing(here.heading_rad + here.bearing_to_rad(there.x_m, there.y_m)))
    return [*turned, route[-1]] if route else []


async def _cancel(task: "asyncio.Future[Plan]") -> None:
    if not task.done():
        task.cancel()
        try:
            await task
        except asyncio.CancelledError:
            # Which of the two was cancelled: the task, or, while it ends, the mission itself?
            mission = asyncio.current_task()
            if mission is not None and mission.cancelling():
                raise
