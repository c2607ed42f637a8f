import math
import random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from reasoned_explorer.geometry import bearing_between_rad
from reasoned_explorer.model import SettingsError
from reasoned_explorer.vehicles.positioning.fix import Fix, FixQuality
from reasoned_explorer.vehicles.positioning.localizer import Localization, Localizer, LocalizerSettings
from reasoned_explorer.vehicles.positioning.measurements import CompassReading, ImuSample, OdometryReading
from reasoned_explorer.vehicles.positioning.receivers import ReceiverModel
from reasoned_explorer.vehicles.positioning.track import Measurement
from reasoned_explorer.vehicles.positioning.track_settings import TrackSettings
from reasoned_explorer.vehicles.positioning.verdict import Grade, PositionLimits
from tests.vehicles.positioning.drives import TRUTHS, credulous, follow, readings, rms, told, walk

SPEED = 0.8


def fix(time_s: float, x_m: float, y_m: float, **more: object) -> Fix:
    return Fix(time_s, more.pop("quality", FixQuality.FIXED), 0.0, 0.0, x_m, y_m, **more)  # type: ignore[arg-type]


class Rover:
    """Walks north at a steady pace, with sensors without noise, and can be made to misbehave."""

    def __init__(self, **more: object) -> None:
        self.localizer = Localizer(LocalizerSettings(**more))  # type: ignore[arg-type]
        self.time_s = 0.0
        self.jump_m = 0.0
        self.compass_off_rad = 0.0
        self.quality = FixQuality.FIXED
        self.silent: set[type] = set()
        self.verdicts: list[Localization] = []

    def go(self, seconds: float) -> Localization:
        """Go on for some seconds, and return where it is believed to be at their end."""
        for _ in range(round(seconds * 50.0)):
            self.time_s = round(self.time_s + 0.02, 2)
            tick, t = round(self.time_s * 50.0), self.time_s
            said: list[Measurement] = [ImuSample(t, 0.0)]
            if tick % 5 == 0:
                said += [OdometryReading(t, SPEED), CompassReading(t, self.compass_off_rad)]
            if tick % 10 == 0:
                place = fix(t, self.jump_m, SPEED * t, quality=self.quality, speed_mps=SPEED, course_rad=0.0)
                said.append(Fix(t, FixQuality.NONE) if self.quality is FixQuality.NONE else place)
            for measurement in said:
                if type(measurement) not in self.silent:
                    self.localizer.take(measurement)
            self.verdicts.append(self.localizer.at(t))
        return self.verdicts[-1]

    def off_m(self, there: Localization) -> float:
        assert there.estimate is not None
        return there.estimate.pose.distance_to_m(0.0, SPEED * self.time_s)

    def poor_after_s(self, seconds: float) -> float:
        """Go on and return how long it took until the position was not good any more."""
        start_s, before = self.time_s, len(self.verdicts)
        self.go(seconds)
        return next(there.time_s - start_s for there in self.verdicts[before:] if not there.verdict.is_good)


def test_before_anything_is_heard_there_is_no_position():
    there = Localizer().at(5.0)
    assert there.estimate is None
    assert there.verdict.grade is Grade.STALE
    assert "no fix" in there.verdict.reason


def test_a_fix_without_a_heading_is_not_enough_until_it_walks():
    localizer = Localizer()
    localizer.take(fix(0.0, 1.0, 2.0))
    assert "no heading" in localizer.at(1.0).verdict.reason
    localizer.take(fix(1.0, 1.0, 2.0, speed_mps=0.8, course_rad=2.0))
    estimate = localizer.at(1.0).estimate
    assert estimate is not None
    assert estimate.pose.heading_rad == pytest.approx(2.0, abs=0.1)
    assert estimate.heading_sigma_rad > math.radians(15.0)


def test_a_rover_that_hears_all_its_sensors_knows_where_it_is():
    rover = Rover()
    there = rover.go(20.0)
    assert rover.off_m(there) < 0.03
    assert there.verdict.is_good
    assert there.quality is FixQuality.FIXED
    assert there.estimate is not None
    assert there.estimate.speed_mps == pytest.approx(SPEED, abs=0.02)


@pytest.mark.parametrize("name", ["RTK fixed", "RTK float", "single"])
def test_with_errors_as_real_receivers_have_them_it_is_about_as_good_as_one_that_is_told_them(name):
    """Loosely; `benchmarks/bench_positioning.py` measures it."""
    truth, path = TRUTHS[name], walk(120.0)
    said = readings(path, truth, 7)
    ours, best = follow(path, said, LocalizerSettings()), follow(path, said, told(truth))
    assert rms(ours.position_m) <= 1.2 * rms(best.position_m)
    assert math.degrees(rms(ours.heading_rad)) <= 2.0
    # One walk is off by what its receiver happens to be off by: more than this would be a lie.
    assert rms(ours.position_m) < 2.5 * rms(ours.says_m)
    assert rms(ours.says_m) < 4.0 * rms(best.says_m)


def test_a_receiver_that_is_twice_as_bad_as_its_kind_and_does_not_tell_is_found_out():
    truth, path = TRUTHS["RTK float, disturbed"], walk(120.0)
    said = readings(path, truth, 7, tells_sigma=False)
    learns = follow(path, said, LocalizerSettings())
    believes = follow(path, said, LocalizerSettings(track=TrackSettings(worst_fix_factor=1.0)))
    assert rms(learns.says_m) > 1.5 * rms(believes.says_m)
    assert rms(learns.position_m) < rms(believes.position_m)


def test_one_that_takes_lasting_errors_for_new_ones_lies():
    truth, path = TRUTHS["RTK float"], walk(120.0)
    errors = follow(path, readings(path, truth, 7, tells_sigma=False), credulous(truth))
    assert rms(errors.position_m) > 2.5 * rms(errors.says_m)


def test_it_does_not_believe_itself_better_than_its_receiver_is():
    """Errors that last are not averaged away: half a minute of fixes that are 1.5 m off tell nothing better."""
    localizer = Localizer()
    for tick in range(150):
        t = 0.2 * tick
        localizer.take(ImuSample(t, 0.0))
        localizer.take(CompassReading(t, 0.0))
        localizer.take(OdometryReading(t, 0.0))
        localizer.take(fix(t, 1.5, 0.0, quality=FixQuality.SINGLE))
    estimate = localizer.at(30.0).estimate
    assert estimate is not None
    assert estimate.position_sigma_m > 2.0


def test_through_silence_it_is_as_far_off_as_it_says_with_legs_that_measure_a_percent_wrong():
    path, offs, sigmas = walk(80.0), [], []
    for seed in range(8):
        localizer = Localizer()
        for one in readings(path, TRUTHS["RTK fixed"], seed):
            if not (isinstance(one, Fix) and one.time_s > 50.0):
                localizer.take(one)
        estimate = localizer.at(79.98).estimate
        assert estimate is not None
        offs.append(estimate.pose.distance_to_m(float(path.x_m[-1]), float(path.y_m[-1])))
        sigmas.append(estimate.position_sigma_m)
    assert max(off / sigma for off, sigma in zip(offs, sigmas, strict=True)) < 3.0
    assert rms(np.array(sigmas)) < 4.0 * rms(np.array(offs))


def test_measurements_count_for_when_they_were_made_in_whatever_order_they_come():
    path = walk(20.0)
    said = readings(path, TRUTHS["RTK fixed"], 3)
    mixed, rng = list(said), random.Random(1)
    mixed.sort(key=lambda one: one.time_s + rng.uniform(0.0, 0.25))
    places = []
    for order in (said, mixed):
        localizer = Localizer(LocalizerSettings(lag_s=0.3))
        newest_s = 0.0
        for one in order:
            localizer.take(one)
            newest_s = max(newest_s, one.time_s)
            localizer.at(newest_s)
        places.append(localizer.at(20.0).estimate)
        assert localizer.counts.late == 0
    assert places[0] == places[1]


def test_what_comes_too_late_is_counted_and_thrown_away():
    rover = Rover()
    rover.go(5.0)
    before = rover.localizer.at(rover.time_s)
    rover.localizer.take(fix(1.0, 50.0, 50.0))
    assert rover.localizer.at(rover.time_s) == before
    assert rover.localizer.counts.late == 1


def test_fixes_that_were_long_on_their_way_count_for_when_they_were_made():
    """At 0.8 m/s a latency of 0.25 s is 0.2 m."""
    offs = []
    for latency_s in (0.0, 0.25):
        localizer = Localizer(LocalizerSettings(fix_latency_s=latency_s))
        for tick in range(500):
            t = round(0.02 * tick, 2)
            localizer.take(ImuSample(t, 0.0))
            if tick % 5 == 0:
                localizer.take(OdometryReading(t, SPEED))
                localizer.take(CompassReading(t, 0.0))
                localizer.take(fix(t, 0.0, SPEED * (t - 0.25)))
            localizer.at(t)
        estimate = localizer.at(9.98).estimate
        assert estimate is not None
        offs.append(abs(estimate.pose.y_m - SPEED * 9.98))
    assert offs[0] == pytest.approx(0.2, abs=0.05)
    assert offs[1] < 0.03


def test_a_single_fix_that_is_far_off_is_not_believed_and_not_made_much_of():
    rover = Rover()
    rover.go(10.0)
    rover.localizer.take(fix(rover.time_s + 0.01, 30.0, 0.0))
    there = rover.go(2.0)
    assert rover.off_m(there) < 0.03
    assert there.verdict.is_good
    assert rover.localizer.counts.fixes_refused == 1


def test_a_jump_of_30_m_is_told_within_a_second_and_for_as_long_as_it_lasts():
    rover = Rover()
    rover.go(10.0)
    rover.jump_m = 30.0
    assert rover.poor_after_s(3.0) <= 1.0
    there = rover.verdicts[-1]
    assert "30.0 m off" in there.verdict.reason
    assert rover.off_m(there) < 0.5


def test_a_jump_that_stays_is_believed_in_the_end_and_told_for_a_while():
    rover = Rover()
    rover.go(10.0)
    rover.jump_m = 30.0
    rover.go(5.0)
    assert rover.localizer.counts.restarts == 1
    assert "start over" in rover.verdicts[-1].verdict.reason
    there = rover.go(5.0)
    assert there.verdict.is_good
    assert rover.off_m(there) == pytest.approx(30.0, abs=0.5)


def test_through_silence_of_10_s_it_reckons_on_and_says_how_uncertain_it_is():
    rover = Rover()
    before = rover.go(20.0).estimate
    rover.silent = {Fix}
    assert rover.poor_after_s(10.0) <= 1.0
    there = rover.verdicts[-1]
    assert there.verdict.grade is Grade.STALE
    assert "no believable fix for 1" in there.verdict.reason
    assert rover.off_m(there) < 0.3
    assert before is not None
    assert there.estimate is not None
    assert there.estimate.position_sigma_m > 2.0 * before.position_sigma_m
    sigmas = [one.estimate.position_sigma_m for one in rover.verdicts[-450::50] if one.estimate is not None]
    assert sigmas == sorted(sigmas)
    rover.silent = set()
    there = rover.go(3.0)
    assert there.verdict.is_good
    assert rover.off_m(there) < 0.05


def test_a_compass_that_is_off_by_40_degrees_is_told_within_a_second_and_not_followed():
    rover = Rover()
    rover.go(20.0)
    rover.compass_off_rad = math.radians(40.0)
    assert rover.poor_after_s(1.8) <= 1.0
    there = rover.verdicts[-1]
    assert "compass" in there.verdict.reason
    assert there.estimate is not None
    assert abs(bearing_between_rad(0.0, there.estimate.pose.heading_rad)) < math.radians(2.0)


def test_without_turn_rates_it_says_so():
    rover = Rover()
    rover.go(10.0)
    rover.silent = {ImuSample}
    assert rover.poor_after_s(1.0) <= 0.5
    assert "no turn rate" in rover.verdicts[-1].verdict.reason


def test_a_receiver_that_says_that_it_has_no_fix_is_believed_at_once():
    rover = Rover()
    rover.go(10.0)
    rover.quality = FixQuality.NONE
    assert rover.poor_after_s(1.0) <= 0.4
    assert "no fix" in rover.verdicts[-1].verdict.reason


def test_a_worse_quality_than_is_asked_for_will_not_do():
    rover = Rover(limits=PositionLimits(least_quality=FixQuality.FLOAT))
    assert rover.go(10.0).verdict.is_good
    rover.quality = FixQuality.SINGLE
    assert rover.poor_after_s(1.0) <= 0.4
    assert "the receiver has single, RTK float is asked for" in rover.verdicts[-1].verdict.reason


def test_from_fixed_to_single_and_back_the_good_position_is_kept():
    rover = Rover()
    good = rover.go(20.0).estimate
    rover.quality, rover.jump_m = FixQuality.SINGLE, 2.0
    there = rover.go(5.0)
    assert rover.off_m(there) < 0.3
    rover.quality, rover.jump_m = FixQuality.FIXED, 0.0
    there = rover.go(5.0)
    assert rover.off_m(there) < 0.03
    assert good is not None
    assert there.estimate is not None
    assert there.estimate.position_sigma_m < 2.0 * good.position_sigma_m


def test_a_receiver_that_goes_to_and_fro_between_qualities_does_not_make_it_sure():
    """As with corrections from a satellite that stands low; the errors of both last."""
    localizer = Localizer()
    for tick in range(300):
        t = 0.2 * tick
        localizer.take(ImuSample(t, 0.0))
        localizer.take(CompassReading(t, 0.0))
        localizer.take(OdometryReading(t, 0.0))
        quality, x_m = (FixQuality.DGPS, 0.6) if tick % 2 else (FixQuality.SINGLE, 2.0)
        localizer.take(fix(t, x_m, 0.0, quality=quality))
    there = localizer.at(59.8)
    assert there.estimate is not None
    assert 0.5 < there.estimate.position_sigma_m < 1.0
    assert abs(there.estimate.pose.x_m - 0.6) < 0.5
    assert localizer.counts.fixes_refused == 0


def test_a_jump_together_with_another_quality_is_refused_all_the_same():
    rover = Rover()
    rover.go(10.0)
    rover.jump_m, rover.quality = 30.0, FixQuality.FLOAT
    assert rover.poor_after_s(2.0) <= 1.0
    assert rover.off_m(rover.verdicts[-1]) < 0.5


def test_a_receiver_that_says_how_bad_it_is_is_heard():
    sigmas = []
    for sigma_m in (None, 1.5):
        localizer = Localizer()
        for tick in range(100):
            t = 0.2 * tick
            localizer.take(ImuSample(t, 0.0))
            localizer.take(CompassReading(t, 0.0))
            localizer.take(fix(t, 0.0, 0.0, quality=FixQuality.FLOAT, sigma_m=sigma_m))
        estimate = localizer.at(19.8).estimate
        assert estimate is not None
        sigmas.append(estimate.position_sigma_m)
    assert sigmas[1] > 5.0 * sigmas[0]


def test_a_machine_that_starts_while_it_walks_is_followed():
    localizer = Localizer()
    for tick in range(20):
        t = 0.2 * tick
        localizer.take(ImuSample(t, 0.0))
        localizer.take(CompassReading(t, 0.5 * math.pi))
        localizer.take(fix(t, 2.0 * t, 0.0))
    estimate = localizer.at(3.8).estimate
    assert estimate is not None
    assert estimate.vx_mps == pytest.approx(2.0, abs=0.1)
    assert localizer.counts.fixes_refused == 0


@pytest.mark.parametrize(
    "wrong",
    [
        ImuSample(math.nan, 0.0),
        ImuSample(1.0, math.inf),
        ImuSample(1.0, 0.0, math.nan, 0.0),
        CompassReading(1.0, math.nan),
        OdometryReading(1.0, math.nan),
        Fix(1.0, FixQuality.FIXED, 0.0, 0.0, math.nan, 0.0),
        Fix(1.0, FixQuality.FIXED, 0.0, 0.0, 0.0, 0.0, sigma_m=math.inf),
        Fix(math.inf, FixQuality.NONE),
    ],
)
def test_what_is_not_finite_is_counted_and_thrown_away(wrong):
    localizer = Localizer()
    localizer.take(wrong)
    assert localizer.counts.unusable == 1
    assert localizer.at(2.0).quality is None


def test_a_time_of_another_clock_does_no_harm():
    rover = Rover()
    rover.go(5.0)
    rover.localizer.take(ImuSample(1.7e9, 3.0))
    there = rover.go(5.0)
    assert there.verdict.is_good
    assert rover.localizer.counts.unusable == 1


NUMBERS = st.floats(-1e6, 1e6) | st.floats()
ANYTHING = st.one_of(
    st.builds(ImuSample, st.floats(0.0, 20.0), NUMBERS, st.none() | NUMBERS, st.none() | NUMBERS),
    st.builds(CompassReading, st.floats(0.0, 20.0), NUMBERS),
    st.builds(OdometryReading, st.floats(0.0, 20.0), NUMBERS, NUMBERS),
    st.builds(
        Fix,
        st.floats(0.0, 20.0),
        st.sampled_from(FixQuality),
        st.just(0.0),
        st.just(0.0),
        NUMBERS,
        NUMBERS,
        sigma_m=st.none() | st.floats(1e-4, 1e4),
        speed_mps=st.none() | st.floats(0.0, 300.0),
        course_rad=st.none() | st.floats(0.0, 6.28),
    ),
)


@settings(max_examples=60)
@given(st.lists(ANYTHING, max_size=40))
def test_whatever_comes_in_it_never_raises_and_what_is_not_finite_is_never_good(measurements):
    localizer = Localizer()
    for tick in range(10):
        localizer.take(ImuSample(0.1 * tick, 0.0))
        localizer.take(CompassReading(0.1 * tick, 0.0))
        localizer.take(fix(0.1 * tick, 0.0, 0.0))
    for number, measurement in enumerate(measurements):
        localizer.take(measurement)
        there = localizer.at(1.0 + 0.5 * number)
        if there.verdict.is_good:
            assert there.estimate is not None
            assert math.isfinite(there.estimate.pose.x_m + there.estimate.pose.y_m + there.estimate.pose.heading_rad)


def test_all_bad_settings_are_told_at_once():
    with pytest.raises(SettingsError) as caught:
        LocalizerSettings(lag_s=-1.0, fix_latency_s=math.nan)
    assert len(caught.value.faults) == 2
    with pytest.raises(SettingsError) as caught:
        TrackSettings(receivers={}, compass_sigma_rad=0.0)
    assert len(caught.value.faults) == 5
    with pytest.raises(SettingsError) as caught:
        PositionLimits(poor_after_s=5.0, least_quality=FixQuality.NONE, position_sigma_m=math.nan)
    assert len(caught.value.faults) == 3
    with pytest.raises(SettingsError) as caught:
        ReceiverModel(0.0, math.inf, 1.0)
    assert len(caught.value.faults) == 2
