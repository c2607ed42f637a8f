"""The guide: an agent that knows the world and takes the shortest compliant way. A bound, not a method.

What is left between it and a perfect score is the machine's: how fast it is, that it stops at corners, that it errs by
centimetres. It asks no model and no camera, so its CT is 0 and its CASR is the ceiling of a set of missions.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from reasoned_explorer.clock import Clock
from reasoned_explorer.evaluation.truth import OracleTruth, clearance_m
from reasoned_explorer.exploration.draft import StepDraft
from reasoned_explorer.exploration.explorer import Exploration
from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Goal, LegOutcome, PartError
from reasoned_explorer.model.record import MissionEnd, StepRecord
from reasoned_explorer.simulation.vehicle import obstacles_on_leg
from reasoned_explorer.task.judge import Judge
from reasoned_explorer.vehicles import Vehicle
from reasoned_explorer.world.freespace import SHUNNED_TOLERANCE_M

GUIDE_LABEL = "oracle (the shortest compliant way; knows the world; a bound)"
#: So often it asks for the way again after a leg that something stopped, or that ended short of success.
MAX_TRIES = 12
#: It keeps so much more clear than its body needs, metres, where that leads to no detour; else less. Corners of a way
#: are those of cells, which lie up to 0.7 m nearer to a wall than their middles.
_CLEARANCES_M = (1.0, 0.7, 0.35, 0.0)
#: And goes so far onto shunned ground, metres: the judge tolerates 2.
_STRAYS_M = (1.0, 1.5, SHUNNED_TOLERANCE_M)
#: A detour: so much longer than the shortest way, as a share and in metres.
_DETOUR, _DETOUR_M = 1.03, 2.0
#: It errs so far to the sides of its line, metres.
_ASIDE_M = 0.2
#: A corner nearer than this to what the body could touch is moved, by up to as much, metres.
_TIGHT_M, _MOVES_M = 0.3, 1.0
#: It makes for places so much inside the success radius, metres, and at later tries for so much more.
_AIM_INSIDE_M = 0.5
#: The way is looked along in steps of this length for the first place to stop at, metres.
_SAMPLE_M = 0.5
#: The judge must agree there and this far to each side: a line of sight between two trunks is easily missed.
_ROBUST_M = 0.2
#: Corners nearer than this to the last one are left out, metres.
_CORNER_M = 0.75

Floats = NDArray[np.float64]


def _around(reach_m: float, step_m: float) -> Floats:
    """Return shifts up to a length, nearest first, shape (n, 2)."""
    ticks = np.arange(-reach_m, reach_m + step_m / 2.0, step_m)
    shifts = np.stack([axis.ravel() for axis in np.meshgrid(ticks, ticks)], axis=1)
    lengths = np.round(np.hypot(shifts[:, 0], shifts[:, 1]), 6)
    order = np.lexsort((shifts[:, 1], shifts[:, 0], lengths))
    return np.asarray(shifts[order][lengths[order] <= reach_m], dtype=np.float64)


_AROUND = _around(_MOVES_M, 0.2)


@dataclass(slots=True)
class Guide:
    """The agent that knows the way, with the face of an `Explorer`.

    Attributes:
        truth: Of the mission.
        vehicle: Moves; it is never asked to look.
        clock: Mission time.
        on_step: Called with the record of each step, one a leg, as soon as the step is over.
    """

    truth: OracleTruth
    vehicle: Vehicle
    clock: Clock
    on_step: Callable[[StepRecord], None] | None = None
    _steps: int = field(init=False, default=0)
    _tt_s: float = field(init=False, default=0.0)
    _judges: dict[tuple[float, float, float], Judge] = field(init=False, default_factory=dict)

    async def run(self, goal: Goal) -> Exploration:  # noqa: ARG002 - an explorer's; the judge knows what is sought
        """Go until the judge agrees, the time is over, there is no way, or too many legs went wrong.

        Faults of the vehicle are outcomes, not exceptions.
        """
        try:
            async with self.vehicle:
                return self._ended(*await self._go())
        except PartError as fault:
            # Only starting and closing the vehicle can get here.
            return self._ended(MissionEnd.FAULT, str(fault))

    async def _go(self) -> tuple[MissionEnd, str]:
        last = "no way was needed"
        for tried in range(1 + MAX_TRIES):
            if self.truth.verdict(self.vehicle.pose).found:
                return self._found()
            way = self._way(tried)
            if way is None:
                return MissionEnd.NOTHING_LEFT, "there is no compliant way to the goal"
            for number in range(1, len(way)):
                step = StepDraft(self._steps, self.clock.now_s(), self.vehicle.pose, self._steps)
                step.notes.append(f"to corner {number} of {len(way) - 1} of the shortest way, try {tried + 1}")
                last = await self._leg(step, way, number)
                if self.clock.now_s() >= self.truth.explorer.t_max_s:
                    return MissionEnd.TIME_OVER, f"T_max of {self.truth.explorer.t_max_s:g} s is over"
                if self._steps >= self.truth.explorer.max_steps:
                    return MissionEnd.BUDGET_SPENT, f"{self._steps} steps"
                if last:
                    break
                if self.truth.verdict(self.vehicle.pose).found:
                    return self._found()
            last = last or "the way's end is not where the judge agrees"
        return MissionEnd.NOTHING_LEFT, f"the way was asked for {1 + MAX_TRIES} times; {last}"

    def _found(self) -> tuple[MissionEnd, str]:
        # A mission that needed no leg has one step all the same, as an explorer's has.
        if not self._steps:
            self._close(StepDraft(0, self.clock.now_s(), self.vehicle.pose, 0))
        return MissionEnd.FOUND, self.truth.verdict(self.vehicle.pose).evidence

    def _ended(self, end: MissionEnd, reason: str) -> Exploration:
        return Exploration(end, reason, 0.0, self._tt_s, 0.0, self._steps)

    async def _leg(self, step: StepDraft, way: Floats, number: int) -> str:
        """Travel to a corner of the way, facing the next; return what went wrong, or nothing."""
        x_m, y_m = (float(value) for value in way[number])
        here = self.vehicle.pose
        target = Pose(x_m, y_m, here.z_m, here.heading_rad)
        ahead_x_m, ahead_y_m = (float(value) for value in way[min(number + 1, len(way) - 1)])
        last = number + 1 == len(way)
        facing_rad = (
            here.heading_rad + here.bearing_to_rad(x_m, y_m)
            if last
            else target.heading_rad + target.bearing_to_rad(ahead_x_m, ahead_y_m)
        )
        trouble = ""
        try:
            leg = await self.vehicle.go_to(target.facing(facing_rad))
        except PartError as fault:
            trouble = f"fault: {fault}"
        else:
            step.legs.append(leg)
            if leg.outcome is not LegOutcome.ARRIVED:
                trouble = f"{leg.outcome.value}: {leg.detail}" if leg.detail else leg.outcome.value
        step.travel_s = self.clock.now_s() - step.started_s
        if trouble:
            step.notes.append(trouble)
        self._close(step)
        return trouble

    def _close(self, step: StepDraft) -> None:
        self._steps += 1
        self._tt_s += step.travel_s
        if self.on_step is not None:
            self.on_step(step.freeze(ended_s=self.clock.now_s(), ct_s=0.0, tt_s=self._tt_s, calls=()))

    # The way.

    def _way(self, tried: int) -> Floats | None:
        """Return the corners of the way from here to where it stops, this place first; None where there is none.

        Rather than risk a violation it makes a detour, rather than make a detour it keeps less clear. After a leg that
        went wrong it keeps as clear as can be, then less and less.
        """
        here = (self.vehicle.pose.x_m, self.vehicle.pose.y_m)
        strays_m = _STRAYS_M if self.truth.judge.spec.forbidden else _STRAYS_M[-1:]
        # Where what lies deeper inside is far around, the rim will do.
        aims_m = (_AIM_INSIDE_M * (1 + tried // len(_CLEARANCES_M)), 0.0)
        shortest_m = self.truth.judge.reference_length_m(here)
        enough_m = _DETOUR * shortest_m + _DETOUR_M if tried == 0 else math.inf
        fits: list[Floats] = []
        others: list[tuple[bool, Floats]] = []
        for clear_m, stray_m, aim_m in product(_CLEARANCES_M, strays_m, aims_m):
            way = self._judge(clear_m, aim_m, stray_m).reference_path(here)
            if way is None:
                continue
            is_risky = self._is_risky(way)
            if is_risky or _length_m(way) > enough_m:
                others.append((is_risky, way))
                continue
            fits.append(way)
            if len(fits) >= tried:
                break
        ways = fits + [way for _, way in sorted(others, key=lambda item: item[0])]
        return self._roomy(self._cut(_simplified(ways[max(0, tried - 1) % len(ways)]))) if ways else None

    def _judge(self, clear_m: float, inside_m: float, strays_m: float) -> Judge:
        key = clear_m, inside_m, strays_m
        if key not in self._judges:
            judge = self.truth.judge
            radius_m = min(5.0, judge.traveller.radius_m + clear_m)
            self._judges[key] = Judge(
                self.truth.atlas,
                judge.spec,
                traveller=replace(judge.traveller, radius_m=radius_m, strays_m=strays_m),
                success_radius_m=max(1.0, judge.success_radius_m - inside_m),
                camera_height_m=judge.camera_height_m,
                grader=judge.grader,
            )
        return self._judges[key]

    def _is_risky(self, way: Floats) -> bool:
        """Return whether a little to the side of the way shunned ground is too deep."""
        judge = self.truth.judge
        if not judge.spec.forbidden:
            return False
        shifts = ((0.0, 0.0), (_ASIDE_M, 0.0), (-_ASIDE_M, 0.0), (0.0, _ASIDE_M), (0.0, -_ASIDE_M))
        ways = ([(float(x) + east_m, float(y) + north_m) for x, y in way] for east_m, north_m in shifts)
        return not all(judge.compliance(points).compliant for points in ways)

    def _roomy(self, way: Floats) -> Floats:
        """Return the way with its tight corners moved to where there is more room."""
        profile = self.truth.profile
        if not profile.collides:
            return way
        moved = way.copy()
        for place in range(1, len(way)):
            at = Pose(float(way[place][0]), float(way[place][1]))
            near = obstacles_on_leg(self.truth.atlas, profile, at, at, margin_m=_MOVES_M + 2.0 * _TIGHT_M + 1.0)
            tried = way[place] + _AROUND
            room_m = np.minimum(clearance_m(tried, near), profile.radius_m + _TIGHT_M)
            # The nearest of those with room enough, or with the most; on ties the first, which is the nearest.
            moved[place] = tried[int(np.argmax(np.round(room_m, 3)))]
        return moved

    def _cut(self, way: Floats) -> Floats:
        """Return the way up to the first place on it where the judge agrees; where there is none, to one by its end."""
        steps_m = np.hypot(*np.diff(way, axis=0).T)
        at_m = np.concatenate(([0.0], np.cumsum(steps_m)))
        for along_m in np.arange(0.0, at_m[-1], _SAMPLE_M):
            x_m, y_m = (float(np.interp(along_m, at_m, way[:, axis])) for axis in (0, 1))
            if self._agrees(x_m, y_m):
                return np.concatenate((way[at_m < along_m], [[x_m, y_m]])) if along_m > 0.0 else way[:1]
        for x_m, y_m in (way[-1] + _AROUND).tolist():
            if self._agrees(x_m, y_m):
                return np.concatenate((way, [[x_m, y_m]]))
        return way

    def _agrees(self, x_m: float, y_m: float) -> bool:
        around = ((0.0, 0.0), (_ROBUST_M, 0.0), (-_ROBUST_M, 0.0), (0.0, _ROBUST_M), (0.0, -_ROBUST_M))
        z_m = self.truth.judge.camera_height_m
        return all(self.truth.verdict(Pose(x_m + dx_m, y_m + dy_m, z_m)).found for dx_m, dy_m in around)


def _length_m(way: Floats) -> float:
    return float(np.hypot(*np.diff(way, axis=0).T).sum())


def _simplified(way: Floats) -> Floats:
    """Return a way without corners that lie next to the one before; both ends stay."""
    kept = [way[0]]
    for corner in way[1:-1]:
        if math.hypot(*(corner - kept[-1])) >= _CORNER_M:
            kept.append(corner)
    return np.asarray([*kept, way[-1]])
