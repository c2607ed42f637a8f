import asyncio
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.clock import SteppedClock, VirtualClock
from reasoned_explorer.exploration.explorer import Explorer, Parts
from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import Goal, Leg, LegOutcome, PartError, SettingsError, TrackPoint
from reasoned_explorer.model.record import MissionEnd, StepRecord
from reasoned_explorer.vehicles import PROFILES
from reasoned_explorer.vehicles.safety import (
    Circle,
    GuardedVehicle,
    SafetyLimits,
    Telemetry,
    guarded,
    limited_profile,
    telemetry_of,
)
from reasoned_explorer.vehicles.safety.limits import stopping_m
from tests.exploration.fakes import FakeVehicle, Plane

EAST = Pose(10.0, 0.0, 1.5, math.pi / 2)


class Mover(FakeVehicle):
    """A fake that tells where it is on the way, and keeps the convention of cancelled legs."""

    def __init__(self, clock, **told):
        super().__init__(clock)
        self.told = told
        self.last_leg = None
        self.connected = False
        self.image = None
        self._going = None
        self._pose = Pose(0.0, 0.0, 1.5, math.pi / 2)

    async def connect(self):
        self.connected = True

    def telemetry(self):
        if self._going is None:
            return Telemetry(self._pose, **self.told)
        here, target, begun_s = self._going
        whole_m = max(1e-9, here.distance_to_m(target.x_m, target.y_m))
        share = min(1.0, (self.clock.now_s() - begun_s) / whole_m)
        x, y = here.x_m + share * (target.x_m - here.x_m), here.y_m + share * (target.y_m - here.y_m)
        return Telemetry(Pose(x, y, here.z_m, here.heading_rad), **{"speed_mps": 1.0, **self.told})

    async def look(self, headings_rad):
        views = await super().look(headings_rad)
        return [replace(view, image=self.image) for view in views]

    async def go_to(self, target):
        here, begun_s = self._pose, self.clock.now_s()
        self._going = here, target, begun_s
        try:
            self.last_leg = await super().go_to(target)
        except asyncio.CancelledError:
            self._pose = self.telemetry().pose
            length_m = here.distance_to_m(self._pose.x_m, self._pose.y_m)
            point = TrackPoint(self.clock.now_s(), self._pose.x_m, self._pose.y_m, 1.5, 0.0)
            spent_s = self.clock.now_s() - begun_s
            self.last_leg = Leg(target.x_m, target.y_m, LegOutcome.STOPPED, spent_s, length_m, (point,), "cancelled")
            raise
        finally:
            self._going = None
        return self.last_leg


def with_guard(script, *, limits=None, told=None, **more):
    """Run a script with a guarded mover; return what it returns, the guard and the mover."""
    clock = VirtualClock()
    mover = Mover(clock, **(told or {}))
    guard = GuardedVehicle(mover, limits or SafetyLimits(patience_s=3.0), clock=clock, **more)

    async def run():
        async with guard:
            return await script(guard, mover)

    return clock.run(run()), guard, mover


def test_nothing_wrong_nothing_changed():
    async def script(guard, mover):
        return await guard.go_to(EAST)

    leg, guard, _ = with_guard(script)
    assert (leg.outcome, leg.length_m, leg.duration_s) == (LegOutcome.ARRIVED, 10.0, 10.0)
    assert guard.events == []


def test_a_leg_out_of_the_fence_is_refused_or_shortened():
    async def script(guard, mover):
        return await guard.go_to(EAST)

    refused, _, mover = with_guard(script, limits=SafetyLimits(fence=Circle(0.0, 0.0, 6.0)))
    assert (refused.outcome, mover.legs) == (LegOutcome.STOPPED, 0)
    shortened, guard, mover = with_guard(script, limits=SafetyLimits(fence=Circle(0.0, 0.0, 6.0), outside="shorten"))
    assert (shortened.target_x_m, mover.pose.x_m) == pytest.approx((5.0, 5.0), abs=0.05)
    assert (shortened.outcome, shortened.detail[:5]) == (LegOutcome.STOPPED, "fence")
    assert guard.events[0].done == "shortened to (5.0, 0.0)"


def test_a_machine_outside_of_the_fence_is_not_started():
    async def script(guard, mover):
        raise AssertionError

    with pytest.raises(PartError, match="outside the geofence"):
        with_guard(script, limits=SafetyLimits(fence=Circle(50.0, 0.0, 6.0)))


@pytest.mark.parametrize("z_m", [3.0, 0.5])
def test_heights_out_of_the_band_are_refused(z_m):
    async def script(guard, mover):
        return await guard.go_to(replace(EAST, z_m=z_m))

    leg, _, mover = with_guard(script, limits=SafetyLimits(lowest_m=1.0, highest_m=2.0))
    assert (leg.detail[:6], mover.legs) == ("height", 0)


def test_the_operator_stops_it_on_the_way_and_it_stays():
    async def script(guard, mover):
        asyncio.get_running_loop().call_later(3.0, guard.stop.press, "the red button")
        return await guard.go_to(EAST), await guard.go_to(EAST)

    (stopped, refused), guard, mover = with_guard(script)
    assert stopped.length_m == pytest.approx(3.0, abs=0.2)
    assert (stopped.detail, refused.length_m, mover.legs) == ("operator: the red button", 0.0, 1)
    assert guard.must_end() == (MissionEnd.INTERRUPTED, "the red button")


def test_the_operator_also_stops_a_look():
    async def script(guard, mover):
        asyncio.get_running_loop().call_later(0.5, guard.stop.press)
        with pytest.raises(PartError, match="operator"):
            await guard.look([0.0])

    with_guard(script)


def test_cancelled_it_stops_the_machine_and_says_what_was_travelled():
    async def script(guard, mover):
        going = asyncio.ensure_future(guard.go_to(EAST))
        await asyncio.sleep(4.0)
        going.cancel()
        with pytest.raises(asyncio.CancelledError):
            await going
        return guard.last_leg

    leg, _, mover = with_guard(script)
    assert (leg.outcome, leg.detail) == (LegOutcome.STOPPED, "cancelled")
    assert mover.pose.x_m == pytest.approx(4.0, abs=0.2)


@pytest.mark.parametrize(
    ("told", "limits", "cause"),
    [
        ({"link_age_s": 5.0}, {}, "link"),
        ({"speed_mps": 9.0}, {"speed_mps": 3.0}, "speed"),
        ({"picture_age_s": 5.0}, {"picture_age_s": 0.5}, "camera"),
        ({"range_ahead_m": 1.0}, {}, "obstacle"),
    ],
)
def test_what_the_machine_tells_stops_it(told, limits, cause):
    async def script(guard, mover):
        return await guard.go_to(EAST)

    leg, guard, _ = with_guard(script, told=told, limits=SafetyLimits(**limits))
    assert (leg.outcome, guard.events[0].cause) == (LegOutcome.STOPPED, cause)
    assert leg.length_m <= 1.0


def test_a_person_may_decline_a_leg():
    asked = []

    async def confirm(here, there):
        asked.append((here.x_m, there.x_m))
        return False

    async def script(guard, mover):
        return await guard.go_to(EAST)

    leg, _, mover = with_guard(script, confirm=confirm)
    assert (leg.detail, mover.legs, asked) == ("declined: a person declined the leg", 0, [(0.0, 10.0)])


def test_a_stop_while_a_person_is_asked_counts():
    async def script(guard, mover):
        async def confirm(here, there):
            guard.stop.press()
            return True

        guard._confirm = confirm
        return await guard.go_to(EAST)

    leg, _, mover = with_guard(script)
    assert (leg.detail[:8], mover.legs) == ("operator", 0)


def test_a_dry_run_connects_plans_and_never_moves():
    async def script(guard, mover):
        return await guard.go_to(EAST)

    leg, guard, mover = with_guard(script, dry_run=True)
    assert (leg.outcome, leg.length_m, mover.legs, mover.connected) == (LegOutcome.STOPPED, 0.0, 0, True)
    assert guard.planned == [EAST]
    assert leg.detail == "dry run: not travelled, 10.0 m to (10.0, 0.0)"


def test_a_dry_run_of_a_machine_that_cannot_only_connect_is_refused():
    clock = VirtualClock()
    guard = GuardedVehicle(FakeVehicle(clock), SafetyLimits(), clock=clock, dry_run=True)
    with pytest.raises(PartError, match="no dry run"):
        clock.run(guard.start())


def test_a_frozen_picture_is_noticed_once_it_has_moved():
    async def script(guard, mover):
        mover.image = np.full((64, 64, 3), 7, np.uint8)
        await guard.look([0.0])
        await guard.look([0.0])  # from the same place the same may be seen
        await guard.go_to(EAST)
        with pytest.raises(PartError, match="frozen"):
            await guard.look([0.0])
        return await guard.go_to(Pose(0.0, 0.0, 1.5))

    with_guard(script)


def test_lost_model_calls_count_in_a_row():
    async def script(guard, mover):
        for answered in (False, False, True, False, False):
            guard.note_model_call(answered=answered)
        first = await guard.go_to(EAST)
        guard.note_model_call(answered=False, why="no answer")
        return first, await guard.go_to(Pose(0.0, 0.0, 1.5))

    (first, second), guard, _ = with_guard(script)
    assert (first.outcome, second.outcome) == (LegOutcome.ARRIVED, LegOutcome.STOPPED)
    assert second.detail == "models: 3 model calls in a row were lost: no answer"
    assert guard.must_end() is not None


def explored(**more):
    plane = Plane()
    mover = Mover(plane.clock)
    guard = GuardedVehicle(mover, SafetyLimits(fence=Circle(0.0, 0.0, 300.0)), clock=plane.clock, **more)
    steps: list[StepRecord] = []
    parts = Parts(
        guard, plane.captioner, plane.planner, plane.checker, plane.clock, plane.ledger, guard.must_end,
        guard.take_interventions,
    )  # fmt: skip
    return plane, guard, steps, Explorer(parts, plane.settings, on_step=steps.append)


def test_a_mission_ends_where_the_operator_stops_it_and_the_record_says_why():
    plane, guard, steps, explorer = explored()

    async def mission():
        asyncio.get_running_loop().call_later(20.0, guard.stop.press)
        return await explorer.run(Goal("Find me a bench", 1))

    ended = plane.clock.run(mission())
    assert (ended.end, ended.reason) == (MissionEnd.INTERRUPTED, "stopped by the operator")
    (event,) = steps[-1].interventions
    assert (event.cause, event.done) == ("operator", "stopped")
    assert event.t_s == pytest.approx(20.0, abs=0.2)
    assert steps[-1].legs[-1].detail == "operator: stopped by the operator"


def test_a_dry_run_of_a_mission_ends_by_itself():
    plane, guard, steps, explorer = explored(dry_run=True)
    ended = plane.clock.run(explorer.run(Goal("Find me a bench", 1)))
    assert ended.end in {MissionEnd.NOTHING_LEFT, MissionEnd.TIME_OVER}
    assert guard.planned
    assert all(leg.length_m == 0.0 for step in steps for leg in step.legs)


def test_a_clock_on_which_nothing_can_be_watched_is_refused_with_all_else():
    clock = SteppedClock()
    with pytest.raises(SettingsError, match="2 faults"):
        GuardedVehicle(FakeVehicle(clock), SafetyLimits(speed_mps=1.0), clock=clock)


def test_the_driver_is_made_with_what_is_allowed():
    clock = VirtualClock()

    def make(profile):
        vehicle = FakeVehicle(clock)
        vehicle.profile = profile
        return vehicle

    guard = guarded(make, PROFILES["drone"], SafetyLimits(speed_mps=1.0, turn_rate_radps=0.5), clock=clock)
    assert (guard.profile.speed_mps, guard.profile.turn_rate_radps) == (1.0, 0.5)


def test_plain_attributes_are_read_and_nonsense_is_not():
    vehicle = FakeVehicle(VirtualClock())
    vehicle.battery, vehicle.speed_mps, vehicle.link_age_s = 0.5, math.nan, "long"
    assert telemetry_of(vehicle) == Telemetry(vehicle.pose, battery=0.5)


def test_all_that_is_wrong_with_limits_is_told_at_once():
    with pytest.raises(SettingsError, match="6 faults"):
        SafetyLimits(
            margin_m=-1.0, outside="perhaps", fence="the garden", speed_mps=0.0, model_failures=0, battery_low=math.nan
        )
    with pytest.raises(SettingsError, match="not higher"):
        SafetyLimits(lowest_m=5.0, highest_m=2.0)
    with pytest.raises(SettingsError, match="above the ground"):
        limited_profile(PROFILES["drone"], SafetyLimits(lowest_m=5.0))


@given(st.floats(0.0, 20.0), st.floats(1.0, 10.0), st.floats(0.0, 2.0), st.floats(0.02, 0.05))
def test_braking_in_steps_ends_within_the_stopping_distance(speed_mps, braking_mps2, reaction_s, tick_s):
    limit_m = stopping_m(speed_mps, braking_mps2=braking_mps2, reaction_s=reaction_s)
    way_m, now_mps = speed_mps * reaction_s, speed_mps
    while now_mps > 0.0:
        after_mps = max(0.0, now_mps - braking_mps2 * tick_s)
        way_m += 0.5 * (now_mps + after_mps) * min(tick_s, now_mps / braking_mps2)
        now_mps = after_mps
    assert way_m == pytest.approx(limit_m, abs=1e-6)
    assert stopping_m(speed_mps + 1.0, braking_mps2=braking_mps2, reaction_s=reaction_s) > limit_m


@given(st.floats(-30.0, 30.0), st.floats(-30.0, 30.0), st.sampled_from(["refuse", "shorten"]))
def test_wherever_it_is_sent_it_stays_inside(x_m, y_m, outside):
    async def script(guard, mover):
        return await guard.go_to(Pose(x_m, y_m, 1.5))

    fence = Circle(3.0, 0.0, 12.0)
    _, _, mover = with_guard(script, limits=SafetyLimits(fence=fence, outside=outside))
    assert fence.inside_by_m(mover.pose.x_m, mover.pose.y_m) >= 0.99
