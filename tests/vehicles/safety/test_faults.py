"""Every vehicle, every fault: it stands or is safe within a second of simulated time, and the record says why."""

import asyncio
import contextlib
import math
from collections.abc import Callable
from dataclasses import dataclass, field

import pytest

from reasoned_explorer.exploration.draft import StepDraft
from reasoned_explorer.geometry import Pose
from reasoned_explorer.model import LegOutcome, PartError
from reasoned_explorer.model.record import StepRecord
from reasoned_explorer.simulation.mishaps import Mishap, MishapKind
from reasoned_explorer.vehicles.safety import Cause, Circle, GuardedVehicle, SafetyLimits, guarded
from tests.vehicles.safety.machines import HOUSE, MACHINES, START, Ready, meadow

pytest.importorskip("msgpack")
pytest.importorskip("pymavlink")

#: When things go wrong, mission and simulator seconds: a drone is up by then and has set off.
FAULT_S = 6.5
WEST = Pose(20.0, 50.0, 0.0, 1.5 * math.pi)
TO_THE_HOUSE = Pose(50.0, 80.0, 0.0, 0.0)
#: A standing machine moves less than this between two glances, metres.
STILL_M = 0.05


@dataclass
class Trial:
    """A fault, and what is expected to come of it.

    Attributes:
        cause: What the record says.
        mishaps: What befalls the machine.
        target: Where it is sent.
        later: What happens at `FAULT_S` beside the machine.
        limits: What it may do.
        at_s: When the fault begins; None where it has no moment of its own.
    """

    cause: Cause
    mishaps: tuple[Mishap, ...] = ()
    target: Pose = WEST
    later: Callable[[GuardedVehicle], None] = lambda guard: None
    limits: dict[str, object] = field(default_factory=dict)
    at_s: float | None = FAULT_S


def befalls(kind: MishapKind, amount: float = 0.0, lasts_s: float = math.inf) -> tuple[Mishap, ...]:
    return (Mishap(kind, FAULT_S, FAULT_S + lasts_s, amount),)


def lose_models(guard: GuardedVehicle) -> None:
    for _ in range(3):
        guard.note_model_call(answered=False, why="no answer within 60 s")


TRIALS = {
    "link loss": Trial(Cause.LINK, befalls(MishapKind.LINK_LOSS)),
    "GPS jump of 30 m": Trial(Cause.POSITION, befalls(MishapKind.POSITION_JUMP, 30.0)),
    "GPS silence of 10 s": Trial(Cause.POSITION, befalls(MishapKind.POSITION_SILENCE, lasts_s=10.0)),
    "compass off by 40°": Trial(Cause.COMPASS, befalls(MishapKind.COMPASS_OFF, math.radians(40.0))),
    "camera silence": Trial(Cause.CAMERA, (Mishap(MishapKind.CAMERA_SILENCE),), at_s=None),
    "obstacle on the way": Trial(Cause.OBSTACLE, target=TO_THE_HOUSE, at_s=None),
    "operator stop": Trial(Cause.OPERATOR, later=lambda guard: guard.stop.press()),
    "geofence reached": Trial(
        Cause.FENCE, limits={"fence": Circle(START.x_m, START.y_m, 6.0), "outside": "shorten"}, at_s=None
    ),
    "models failing": Trial(Cause.MODELS, later=lose_models),
    "battery low": Trial(Cause.BATTERY, befalls(MishapKind.BATTERY_LOW, 0.1), limits={"when_low": "land"}),
}


@pytest.fixture(scope="module")
def atlas():
    return meadow()


@dataclass
class Tried:
    step: StepRecord
    ended_s: float
    standing: Pose
    later: Pose


async def tried(trial: Trial, ready: Ready, guard: GuardedVehicle) -> Tried:
    """Look where that is to fail, go, and see whether the machine then stands; return what a record would hold."""
    draft = StepDraft(0, 0.0, START, 0)
    await guard.start()
    try:
        asyncio.get_running_loop().call_later(max(0.0, FAULT_S - ready.clock.now_s()), trial.later, guard)
        if trial.cause is Cause.CAMERA:
            with pytest.raises(PartError):
                await guard.look([guard.pose.heading_rad])
        else:
            await guard.look([guard.pose.heading_rad])  # as a mission begins; a filter knows by then where it is
        draft.legs.append(await guard.go_to(trial.target))
        ended_s, standing = ready.simulated_s(), ready.true_pose()
        await ready.clock.act(2.0)
        with contextlib.suppress(PartError):
            await guard.look([guard.pose.heading_rad])  # has the simulator's time go on, where it can be reached
        later = ready.true_pose()
    finally:
        try:
            await guard.close()
        except PartError:
            assert trial.cause is Cause.LINK
    step = draft.freeze(ended_s=ended_s, ct_s=0.0, tt_s=0.0, calls=(), interventions=guard.take_interventions())
    return Tried(step, ended_s, standing, later)


@pytest.mark.parametrize("fault", TRIALS)
@pytest.mark.parametrize("name", MACHINES)
def test_it_stands_within_a_second_and_the_record_says_why(atlas, name, fault):
    machine, trial = MACHINES[name], TRIALS[fault]
    with machine.make(atlas, machine.profile, trial.mishaps) as ready:
        limits = SafetyLimits(patience_s=2.0, **trial.limits)
        guard = guarded(ready.make, ready.profile, limits, clock=ready.clock, range_ahead_m=ready.range_ahead_m)
        if fault in machine.lacks:
            assert ready.make(ready.profile).telemetry().battery is None, machine.lacks[fault]
            return
        came = ready.clock.run(tried(trial, ready, guard))
    (leg,) = came.step.legs
    first = came.step.interventions[0]
    assert first.cause == trial.cause.value
    assert leg.outcome in {LegOutcome.STOPPED, LegOutcome.FAULT}
    assert leg.detail.startswith(trial.cause.value)
    assert first.done
    if trial.at_s is not None:
        assert trial.at_s - machine.ahead_s <= first.t_s <= trial.at_s + 1.0
        assert leg.length_m > 0.3  # it was under way
        if trial.cause is not Cause.BATTERY:
            assert came.ended_s <= trial.at_s + 1.0
    assert came.standing.distance_to_m(came.later.x_m, came.later.y_m) < STILL_M
    assert came.later.y_m < HOUSE[0][1] - ready.profile.radius_m
    assert START.distance_to_m(came.later.x_m, came.later.y_m) < 6.0 or trial.cause is not Cause.FENCE


def test_silence_that_ends_is_waited_for(atlas):
    machine = MACHINES["embedded drone"]
    with machine.make(atlas, machine.profile, TRIALS["GPS silence of 10 s"].mishaps) as ready:
        guard = guarded(ready.make, ready.profile, SafetyLimits(), clock=ready.clock)

        async def script():
            async with guard:
                return await guard.go_to(WEST), await guard.go_to(WEST), ready.clock.now_s()

        stopped, arrived, now_s = ready.clock.run(script())
    assert (stopped.outcome, arrived.outcome) == (LegOutcome.STOPPED, LegOutcome.ARRIVED)
    assert now_s > FAULT_S + 10.0
    assert [event.done for event in guard.events] == ["stopped", "stands and waits"]
    assert guard.must_end() is None


def test_a_jump_that_stays_ends_the_mission_until_a_person_has_looked(atlas):
    machine = MACHINES["embedded drone"]
    with machine.make(atlas, machine.profile, TRIALS["GPS jump of 30 m"].mishaps) as ready:
        guard = guarded(ready.make, ready.profile, SafetyLimits(), clock=ready.clock)

        async def script():
            async with guard:
                await guard.go_to(WEST)
                refused = await guard.go_to(WEST)
                ending = guard.must_end()
                guard.trust_position()
                return refused, ending, await guard.go_to(guard.pose.ahead(5.0))

        refused, ending, again = ready.clock.run(script())
    assert (refused.outcome, refused.length_m) == (LegOutcome.STOPPED, 0.0)
    assert ending is not None
    assert "jumped" in ending[1]
    assert again.outcome is LegOutcome.ARRIVED


def test_with_little_battery_left_it_comes_home_and_stays(atlas):
    machine = MACHINES["embedded walker"]
    with machine.make(atlas, machine.profile, TRIALS["battery low"].mishaps) as ready:
        guard = guarded(ready.make, ready.profile, SafetyLimits(), clock=ready.clock)

        async def script():
            async with guard:
                return await guard.go_to(WEST), await guard.go_to(WEST)

        home, refused = ready.clock.run(script())
        assert ready.true_pose().distance_to_m(START.x_m, START.y_m) < 0.5
    assert home.track[-1].t_s > FAULT_S + 1.0
    assert refused.length_m == 0.0
    assert [event.done for event in guard.events] == ["stopped", "came home", "refused"]
