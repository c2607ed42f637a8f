"""A machine that stops at a wall between two readings of its legs, or is off at once."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from reasoned_explorer.vehicles.positioning.fix import Fix, FixQuality
from reasoned_explorer.vehicles.positioning.localizer import Localization, Localizer, LocalizerSettings
from reasoned_explorer.vehicles.positioning.measurements import CompassReading, ImuSample, OdometryReading

SPEED = 0.8
STOP_S, END_S = 20.0, 30.0


def _stops(t: float) -> float:
    return SPEED if t < STOP_S else 0.0


def _sets_off(t: float) -> float:
    return 0.0 if t < STOP_S else SPEED


def _drive(
    true_mps: Callable[[float], float],
    *,
    legs_mps: Callable[[float], float] | None = None,
    legs_hz: int = 10,
    stuck_fix: bool = False,
) -> tuple[Localizer, list[Localization], list[float]]:
    """Go east at a speed by time; return the localizer, where it was at each fix, and how far it was off there."""
    localizer, rng = Localizer(LocalizerSettings(lag_s=0.0)), np.random.Generator(np.random.PCG64(1))
    told, off_m, x_m, fix_m = [], [], 0.0, 0.0
    for tick in range(round(END_S * 50.0)):
        t = tick / 50.0
        x_m += true_mps(t) / 50.0
        localizer.take(ImuSample(t, 0.0))
        if tick % (50 // legs_hz) == 0:
            forward_mps = (legs_mps or true_mps)(t) + rng.normal() * 0.02
            localizer.take(OdometryReading(t, forward_mps, rng.normal() * 0.02))
        if tick % 5 == 0:
            localizer.take(CompassReading(t, math.pi / 2.0))
        if tick % 10 == 0:
            fix_m = fix_m if stuck_fix and t >= STOP_S else x_m
            east_m, north_m = fix_m + rng.normal() * 0.005, rng.normal() * 0.005
            localizer.take(Fix(t, FixQuality.FIXED, 0.0, 0.0, east_m, north_m, sigma_m=0.014))
            there = localizer.at(t)
            if t > 3.0 and there.estimate is not None:
                told.append(there)
                off_m.append(there.estimate.pose.distance_to_m(x_m, 0.0))
    return localizer, told, off_m


@pytest.mark.parametrize("legs_hz", [10, 25, 50])
@pytest.mark.parametrize("speed", [_stops, _sets_off])
def test_a_sudden_change_that_the_legs_tell_is_believed_and_no_fix_refused(
    speed: Callable[[float], float], legs_hz: int
) -> None:
    localizer, told, off_m = _drive(speed, legs_hz=legs_hz)
    assert localizer.counts.fixes_refused == localizer.counts.restarts == 0
    assert all(there.verdict.is_good for there in told)
    assert max(off_m) < 0.15
    assert max(off_m[-20:]) < 0.03
    assert told[-1].estimate is not None
    assert told[-1].estimate.speed_mps == pytest.approx(speed(END_S), abs=0.05)


def test_one_reading_that_is_wrong_is_not_believed() -> None:
    _, told, off_m = _drive(lambda t: SPEED, legs_mps=lambda t: -3.0 if abs(t - STOP_S) < 0.01 else SPEED)
    speeds = [there.estimate.speed_mps for there in told if there.estimate is not None]
    assert min(speeds) > SPEED - 0.1
    assert max(off_m) < 0.05


def test_legs_that_walk_on_the_spot_contradict_the_fixes_and_that_is_told() -> None:
    _, told, _ = _drive(_stops, legs_mps=lambda t: SPEED)
    assert any("fixes have been" in there.verdict.reason for there in told)


def test_so_do_fixes_that_stick_while_the_legs_walk() -> None:
    _, told, _ = _drive(lambda t: SPEED, stuck_fix=True)
    assert any("fixes have been" in there.verdict.reason for there in told)
